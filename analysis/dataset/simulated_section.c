#include "analysis/dataset/simulated_section.h"

#include <string.h>

#include "analysis/dataset/csv_table.h"
#include "analysis/dataset/simulated.h"
#include "analysis/dataset/simulated_bundle.h"
#include "base/text.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "dataset"

static void add_rows(struct wb_dataset *dataset, const struct wb_section_run *run)
{
    double before[3] = {0.0};
    const struct wb_simulated_shapes shapes = {run->n_shape, run->shape_s, run->shape};
    for (int i = 0; i < run->n_rows; i++) {
        const struct wb_section_run_row *const row = &run->rows[i];
        const double tip[3] = {row->point.tip_x, row->point.deflection, 0.0};
        const struct wb_row out = {
            .cycle = row->cycle,
            .phase = row->phase,
            .deflection = row->point.deflection,
            .tension = row->point.tension,
            .force = row->force,
            .tip_angle = row->point.tip_angle,
        };
        wb_simulated_add_row(dataset, out, i > 0 ? before : NULL, tip, &shapes);
        memcpy(before, tip, sizeof before);
    }
}

/* --- dataset.json --- */

enum {
    ENERGIES = 6
};

/* Of dataset.json and of energies.csv. */
static const char *const energy_names[ENERGIES] = {"external_J", "wires_J",    "tape_J",
                                                   "cohesive_J", "friction_J", "imbalance_J"};

static void list_energies(const struct wb_section_beam_energies *e, double list[ENERGIES])
{
    const double all[ENERGIES] = {
        e->external, e->wires,    e->tape,
        e->bonds,    e->friction, e->external - e->wires - e->tape - e->bonds - e->friction};
    memcpy(list, all, sizeof all);
}

static void describe_energies(struct wb_json *object, const struct wb_section_beam_energies *e)
{
    double list[ENERGIES];

    list_energies(e, list);
    for (int i = 0; i < ENERGIES; i++)
        wb_json_set_number(object, energy_names[i], list[i]);
}

/* EI and M over kappa depend on length and ends, not on the section alone: the key states this, and
 * three lengths show it. */
static void describe_beam(struct wb_json *object, const struct wb_section_run *run)
{
    struct wb_json *const beam =
        wb_json_set_object(object, "homogenised_beam_of_this_length_and_these_ends");
    struct wb_json *const lengths = wb_json_set_array(beam, "elastic");
    struct wb_json *const curve = wb_json_set_array(beam, "moment_curvature");

    for (int i = 0; i < WB_SECTION_RUN_LENGTHS && run->rigidity[i].length > 0.0; i++) {
        const struct wb_section_run_rigidity *const r = &run->rigidity[i];
        struct wb_json *const item = wb_json_append_object(lengths);
        wb_json_set_number(item, "length_mm", r->length / WB_MM);
        wb_json_set_number(item, "flexural_rigidity_N_mm2", r->rigidity / WB_NMM2);
        wb_json_set_number(item, "newmark_alpha_L", r->alpha);
    }
    for (int i = 0; i < run->n_curve; i++) {
        const struct wb_section_homogenise_point *const p = &run->curve[i];
        struct wb_json *const item = wb_json_append_object(curve);
        wb_json_set_number(item, "curvature_1_m", p->curvature);
        wb_json_set_number(item, "moment_N_mm", p->moment / WB_MM);
        wb_json_set_number(item, "secant_rigidity_N_mm2", p->moment / p->curvature / WB_NMM2);
    }
}

void wb_simulated_section_describe(struct wb_json *object,
                                   const struct wb_simulated_section *section)
{
    const struct wb_section_run *const run = section->run;

    wb_json_set_text(object, "bending", "planar, without twist");
    wb_json_set_number(object, "friction_used", run->friction);
    wb_json_set_boolean(object, "friction_is_mean_of_decay", run->is_mean);
    wb_json_set_boolean(object, "mirrored", run->is_mirrored);
    wb_json_set_integer(object, "elements_along", run->elements);
    wb_json_set_integer(object, "unknowns", run->unknowns);
    wb_json_set_integer(object, "increments", run->increments);
    wb_json_set_integer(object, "iterations", run->iterations);
    if (run->n_rows > 0)
        describe_energies(wb_json_set_object(object, "energy"),
                          &run->rows[run->n_rows - 1].energies);
    struct wb_json *const largest = wb_json_set_object(object, "largest");
    wb_json_set_number(largest, "residual", run->residual);
    wb_json_set_number(largest, "imbalance_over_external", run->imbalance);
    wb_json_set_number(largest, "contact_balance_missing", run->missing);
    wb_json_set_number(largest, "tape_plastic_strain", run->tape_plastic);
    describe_beam(object, run);
    wb_json_set_boolean(object, "converged", run->converged);
    wb_json_set_boolean(object, "stopped", run->stopped);
    wb_json_set_number(object, "zero_force_N", run->zero_force);
    wb_json_set_number(object, "wall_s", section->wall);
    wb_json_set_number(object, "cpu_s", section->cpu);
}

void wb_simulated_section_fill(struct wb_dataset *dataset,
                               const struct wb_simulated_section *section)
{
    const struct wb_simulated_bundle_head head = {
        .name = "simulated bundle, section model",
        .model = section->model,
        .override = section->override,
        .is_complete = section->run->converged && !section->run->stopped,
    };

    wb_simulated_section_describe(wb_simulated_bundle_begin(dataset, &head), section);
    wb_simulated_describe_tool(dataset->document);
    add_rows(dataset, section->run);
}

/* --- energies.csv --- */

enum wb_status wb_simulated_section_write_energies(const struct wb_dataset *dataset,
                                                   const struct wb_simulated_section *section,
                                                   const char *folder)
{
    const struct wb_section_run *const run = section->run;
    struct wb_text text = {0};

    if (dataset->n_rows != (size_t)run->n_rows)
        return wb_fail(WB_ERR_ARGUMENT, "%s: %d rows of energies for a dataset of %zu", folder,
                       run->n_rows, dataset->n_rows);
    wb_text_append(&text, "t_s,deflection_mm");
    for (int k = 0; k < ENERGIES; k++)
        wb_text_append(&text, ",%s", energy_names[k]);
    wb_text_append(&text, "\n");
    for (int i = 0; i < run->n_rows; i++) {
        double columns[2 + ENERGIES] = {dataset->rows[i].t, run->rows[i].point.deflection};
        list_energies(&run->rows[i].energies, columns + 2);
        wb_simulated_append_energies(&text, columns, WB_COUNT(columns));
    }
    const enum wb_status status = wb_csv_table_write(folder, "energies.csv", &text);
    wb_text_release(&text);
    return status;
}
