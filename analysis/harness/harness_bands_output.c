#include "analysis/harness/harness_bands_output.h"

#include <math.h>
#include <stdio.h>

#include "analysis/dataset/csv_table.h"
#include "analysis/keys/row.h"
#include "base/units.h"

enum {
    NAMED = 5 /* runs that a message names */
};

static const struct wb_harness_plan *plan_of(const struct wb_harness_bands *bands)
{
    return bands->nominal->plan;
}

/* The values of an item, with the names of their columns and keys. */
static const struct value {
    const char *key;
    size_t offset; /* in struct wb_harness_force_bands */
    int shift;     /* decimal digits from SI units to those of the key */
} values[] = {
    {"force_N", offsetof(struct wb_harness_force_bands, force), 0},
    {"moment_N_mm", offsetof(struct wb_harness_force_bands, moment), 3},
    {"largest_force_N", offsetof(struct wb_harness_force_bands, largest_force), 0},
    {"largest_moment_N_mm", offsetof(struct wb_harness_force_bands, largest_moment), 3},
};

static const struct wb_fit_band *band_of(const struct wb_harness_force_bands *force,
                                         const struct value *value)
{
    return (const struct wb_fit_band *)(const void *)((const char *)force + value->offset);
}

/* --- JSON --- */

#define BAND_OF(member) WB_AT(struct wb_fit_band, member)
#define FORCE(member) WB_AT(struct wb_harness_force_bands, member)
#define SHAPE(member) WB_AT(struct wb_harness_shape_band, member)
#define STEP(member) WB_AT(struct wb_harness_step_bands, member)
#define DEVIANT(member) WB_AT(struct wb_harness_deviant, member)
#define SETTING(member) WB_AT(struct wb_harness_bands_settings, member)

static const struct wb_key band_rows[] = {
    {"median", BAND_OF(median) | UNKNOWN,
     "median of the runs; null: fewer than 95 % of the runs found an equilibrium"},
    {"low", BAND_OF(low) | UNKNOWN, "2.5 % quantile of the runs"},
    {"high", BAND_OF(high) | UNKNOWN, "97.5 % quantile of the runs"},
};
static WB_KEYS(band, "harness_band", "A band of 95 %, in the unit of its key.");

static const struct wb_key force_rows[] = {
    {"name", TEXT, "root, connector or clip"},
    {"force_N", FORCE(force), "force on the wire at the end of the step", &band_keys},
    {"moment_N_mm", FORCE(moment), "moment on the wire", &band_keys},
    {"largest_force_N", FORCE(largest_force), "largest force during the step", &band_keys},
    {"largest_moment_N_mm", FORCE(largest_moment), "largest moment during the step", &band_keys},
};
static WB_KEYS(force, "harness_force_bands", "Bands of what holds the wire at a mounted item.");

static const struct wb_key shape_rows[] = {
    {"name", TEXT, "branch"},
    {"median_distance_mm", SHAPE(median) | UNKNOWN,
     "largest distance along the branch from its nominal shape, median of the runs"},
    {"distance_mm", SHAPE(distance) | UNKNOWN, "distance that 95 % of the runs do not exceed"},
    {"at_mm", SHAPE(at) | UNKNOWN, "place on the branch where the run at 95 % has it"},
};
static WB_KEYS(shape, "harness_shape_band", "How far a branch is from its nominal shape.");

static const struct wb_key step_rows[] = {
    {"name", TEXT, "step"},
    {"runs", STEP(n), "runs with an equilibrium at the end of the step"},
    {"runs_not_converged", STEP(n_lost), "runs that found none in this step"},
    {"runs_with_other_snaps", STEP(n_other),
     "runs of the bands with other snaps up to here than the nominal harness"},
    {"forces", OBJECT | LIST, "mounted items", &force_keys},
    {"branches", OBJECT | LIST, "branches", &shape_keys},
};
static WB_KEYS(step, "harness_step_bands", "Bands of a step.");

static const struct wb_key wire_rows[] = {
    {"name", TEXT, "name in the harness"},
    {"specimens", INTEGER, "specimens from which its law is drawn; 0: taken as exact"},
};
static WB_KEYS(wire, "harness_wire_draw", "How a wire is drawn.");

static const struct wb_key deviant_rows[] = {
    {"run", DEVIANT(run), "number of the run, from 1"},
    {"step", TEXT, "the first step that deviates"},
    {"converged", FLAG, "it has other snaps; else it finds no equilibrium"},
    {"branch", TEXT | OPTIONAL, "where it finds none; empty: the root"},
};
static WB_KEYS(deviant, "harness_deviant",
               "A run that finds no equilibrium, or that snaps otherwise than the nominal "
               "harness and may end on another arch.");

static const struct wb_key wb_harness_bands_output_rows[] = {
    {"confidence", NUMBER, "probability of the bands"},
    {"runs", SETTING(runs), "number of runs"},
    {"seed", SETTING(seed), "seed of the draws"},
    {"wires", OBJECT | LIST, "wires", &wire_keys},
    {"steps", OBJECT | LIST, "steps", &step_keys},
    {"residual_distance_mm", WB_AT(struct wb_harness_bands, residual) | OPTIONAL,
     "distance_mm of residual_shape", &band_keys},
    {"deviating_runs", OBJECT | LIST, "runs that deviate", &deviant_keys},
};
WB_KEYS(wb_harness_bands_output, "harness_uncertainty",
        "Bands of a harness from the scatter of the specimens of its wires.");

static void put_step(struct wb_json *object, const struct wb_harness_bands *bands, int index)
{
    const struct wb_harness_plan *const plan = plan_of(bands);
    const struct wb_harness_step_bands *const step = &bands->steps[index];
    wb_json_set_text(object, "name", plan->steps[index].name);
    WB_PUT(object, &step_keys, struct wb_harness_step_bands, step);
    struct wb_json *const forces = wb_json_set_array(object, "forces");
    for (int i = 0; i < plan->n_items; i++) {
        if (!bands->nominal->results[index].forces[i].is_mounted)
            continue;
        struct wb_json *const item = wb_json_append_object(forces);
        wb_json_set_text(item, "name", plan->items[i].name);
        WB_PUT(item, &force_keys, struct wb_harness_force_bands, &step->forces[i]);
    }
    struct wb_json *const branches = wb_json_set_array(object, "branches");
    for (int i = 0; i < plan->n_branches; i++) {
        struct wb_json *const item = wb_json_append_object(branches);
        wb_json_set_text(item, "name", plan->branches[i].name);
        WB_PUT(item, &shape_keys, struct wb_harness_shape_band, &step->branches[i]);
    }
}

static const char *branch_name(const struct wb_harness_plan *plan, int branch)
{
    return branch < 0 ? "" : plan->branches[branch].name;
}

void wb_harness_bands_output_put(struct wb_json *object, const struct wb_harness_bands *bands)
{
    const struct wb_harness_plan *const plan = plan_of(bands);
    wb_json_set_number(object, "confidence", WB_HARNESS_BANDS_CONFIDENCE);
    WB_PUT(object, &wb_harness_bands_output_keys, struct wb_harness_bands_settings,
           &bands->settings);
    struct wb_json *const wires = wb_json_set_array(object, "wires");
    for (int i = 0; i < plan->n_wires; i++) {
        struct wb_json *const item = wb_json_append_object(wires);
        wb_json_set_text(item, "name", plan->wires[i].name);
        wb_json_set_integer(item, "specimens", plan->wires[i].specimens.n);
    }
    struct wb_json *const steps = wb_json_set_array(object, "steps");
    for (int i = 0; i < bands->nominal->n_steps; i++)
        put_step(wb_json_append_object(steps), bands, i);
    if (bands->is_taken_off)
        WB_PUT(object, &wb_harness_bands_output_keys, struct wb_harness_bands, bands);
    struct wb_json *const deviants = wb_json_set_array(object, "deviating_runs");
    for (int i = 0; i < bands->n_deviants; i++) {
        const struct wb_harness_deviant *const deviant = &bands->deviants[i];
        struct wb_json *const item = wb_json_append_object(deviants);
        WB_PUT(item, &deviant_keys, struct wb_harness_deviant, deviant);
        wb_json_set_text(item, "step", plan->steps[deviant->step].name);
        wb_json_set_boolean(item, "converged", !deviant->is_lost);
        if (deviant->is_lost)
            wb_json_set_text(item, "branch", branch_name(plan, deviant->branch));
    }
}

/* --- CSV --- */

static void append_row(struct wb_text *text, const struct wb_harness_bands *bands, int step,
                       const char *name, const char *quantity)
{
    wb_text_append(text, "%d,%d,%s,%s", step + 1, bands->steps[step].n, name, quantity);
}

static void append_numbers(struct wb_text *text, const double *numbers, int n, int shift)
{
    for (int i = 0; i < n; i++) {
        wb_text_append(text, ",");
        wb_csv_table_append_number(text, numbers[i], shift);
    }
    wb_text_append(text, "\n");
}

static void append_band(struct wb_text *text, const struct wb_fit_band *band, int shift)
{
    const double numbers[] = {band->median, band->low, band->high, (double)NAN};
    append_numbers(text, numbers, 4, shift);
}

static void append_step(struct wb_text *text, const struct wb_harness_bands *bands, int step)
{
    const struct wb_harness_plan *const plan = plan_of(bands);
    for (int i = 0; i < plan->n_items; i++) {
        if (!bands->nominal->results[step].forces[i].is_mounted)
            continue;
        for (size_t k = 0; k < WB_COUNT(values); k++) {
            append_row(text, bands, step, plan->items[i].name, values[k].key);
            append_band(text, band_of(&bands->steps[step].forces[i], &values[k]), values[k].shift);
        }
    }
    for (int i = 0; i < plan->n_branches; i++) {
        const struct wb_harness_shape_band *const shape = &bands->steps[step].branches[i];
        const double numbers[] = {shape->median, (double)NAN, shape->distance, shape->at};
        append_row(text, bands, step, plan->branches[i].name, "distance_mm");
        append_numbers(text, numbers, 4, 3);
    }
}

enum wb_status wb_harness_bands_output_write(const struct wb_harness_bands *bands,
                                             const char *folder)
{
    static const char *const columns[] = {"step",   "runs", "name", "quantity",
                                          "median", "low",  "high", "at_mm"};
    struct wb_text text = {0};
    if (!bands)
        return wb_csv_table_write(folder, "bands.csv", NULL);
    wb_csv_table_append_header(&text, columns, WB_COUNT(columns));
    for (int i = 0; i < bands->nominal->n_steps; i++)
        append_step(&text, bands, i);
    if (bands->is_taken_off) {
        append_row(&text, bands, bands->nominal->n_steps - 1, "", "residual_distance_mm");
        append_band(&text, &bands->residual, 3);
    }
    const enum wb_status status = wb_csv_table_write(folder, "bands.csv", &text);
    wb_text_release(&text);
    return status;
}

/* --- the terminal --- */

/* Round-off is 0. */
static void append_interval(struct wb_text *text, const char *before,
                            const struct wb_fit_band *band, const char *unit, double factor)
{
    const double least = 1e-8;
    if (isfinite(band->median))
        wb_text_append(text, "%s%.4g %s (%.4g to %.4g)", before,
                       band->median < least ? 0.0 : band->median / factor, unit,
                       band->low < least ? 0.0 : band->low / factor,
                       band->high < least ? 0.0 : band->high / factor);
    else
        wb_text_append(text, "%s%s: no band", before, unit);
}

static void append_wires(struct wb_text *text, const struct wb_harness_plan *plan, bool drawn)
{
    const char *between = drawn ? "; drawn from specimens: " : "; taken as exact: ";
    for (int i = 0; i < plan->n_wires; i++) {
        const struct wb_harness_wire *const wire = &plan->wires[i];
        if (wb_harness_bands_is_drawn(wire) != drawn)
            continue;
        wb_text_append(text, "%s%s (", between, wire->name);
        if (drawn)
            wb_text_append(text, "%d of ", wire->specimens.n);
        wb_text_append(text, "%s)", wire->file);
        between = ", ";
    }
}

static void append_step_table(struct wb_text *text, const struct wb_harness_bands *bands, int index)
{
    const struct wb_harness_plan *const plan = plan_of(bands);
    const struct wb_harness_step_bands *const step = &bands->steps[index];
    wb_text_append(text, "%2d  %-20s", index + 1, plan->steps[index].name);
    if (step->n < bands->settings.runs)
        wb_text_append(text, "  %d of %d runs", step->n, bands->settings.runs);
    if (step->n_other > 0)
        wb_text_append(text, "  %d with other snaps", step->n_other);
    wb_text_append(text, "\n");
    for (int i = 0; i < plan->n_items; i++) {
        const struct wb_harness_force_bands *const f = &step->forces[i];
        if (!bands->nominal->results[index].forces[i].is_mounted)
            continue;
        wb_text_append(text, "      %-16s", plan->items[i].name);
        append_interval(text, " ", &f->force, "N", 1.0);
        append_interval(text, ", ", &f->moment, "N mm", WB_NMM);
        append_interval(text, "; at most ", &f->largest_force, "N", 1.0);
        append_interval(text, ", ", &f->largest_moment, "N mm", WB_NMM);
        wb_text_append(text, "\n");
    }
    for (int i = 0; i < plan->n_branches; i++) {
        const struct wb_harness_shape_band *const shape = &step->branches[i];
        wb_text_append(text, "      %-16s", plan->branches[i].name);
        if (isfinite(shape->distance))
            wb_text_append(text, " within %.3g mm of its nominal shape (at %.4g mm)\n",
                           shape->distance / WB_MM, shape->at / WB_MM);
        else
            wb_text_append(text, " no band of its shape\n");
    }
}

void wb_harness_bands_output_append_table(struct wb_text *text,
                                          const struct wb_harness_bands *bands)
{
    wb_text_append(text, "\nmedians and %g %% bands of %d runs",
                   WB_HARNESS_BANDS_CONFIDENCE / WB_PERCENT, bands->settings.runs);
    append_wires(text, plan_of(bands), true);
    append_wires(text, plan_of(bands), false);
    wb_text_append(text, "\n");
    for (int i = 0; i < bands->nominal->n_steps; i++)
        append_step_table(text, bands, i);
    if (bands->is_taken_off) {
        append_interval(text, "    residual shape: up to ", &bands->residual, "mm", WB_MM);
        wb_text_append(text, " from the stress-free one\n");
    }
}

void wb_harness_bands_output_append_deviants(struct wb_text *text,
                                             const struct wb_harness_bands *bands)
{
    const struct wb_harness_plan *const plan = plan_of(bands);
    int n_lost = 0;
    for (int i = 0; i < bands->n_deviants; i++)
        n_lost += bands->deviants[i].is_lost;
    if (bands->n_deviants == 0)
        return;
    wb_text_append(text,
                   "of %d runs %d found no equilibrium in a step, and %d snapped otherwise "
                   "than the nominal harness",
                   bands->settings.runs, n_lost, bands->n_deviants - n_lost);
    for (int i = 0; i < bands->n_deviants && i < NAMED; i++) {
        const struct wb_harness_deviant *const d = &bands->deviants[i];
        wb_text_append(text, "%s run %d in step %d, %s (%s%s%s)", i == 0 ? ":" : ",", d->run,
                       d->step + 1, plan->steps[d->step].name,
                       d->is_lost ? "no equilibrium" : "other snaps", d->is_lost ? ", branch " : "",
                       d->is_lost ? d->branch < 0 ? "(root)" : branch_name(plan, d->branch) : "");
    }
    if (bands->n_deviants > NAMED)
        wb_text_append(text, " and others, which harness.json lists");
}
