#include "analysis/quicklook.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/calibration/cycle/cycle_data.h"
#include "analysis/plot/figure.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "quicklook"

#define WIDTH 460.0 /* points */
#define HEIGHT 300.0
#define PNG_SCALE 2.5
/* So many shapes at the most are drawn, evenly over the first loading. */
#define MOST_SHAPES 8

/* --- summary --- */

static const char *text_or(const struct wb_json *object, const char *key, const char *otherwise)
{
    const char *text;
    return wb_json_get_text(object, key, &text) ? text : otherwise;
}

static const char *source_of(const struct wb_dataset *dataset)
{
    if (dataset->info.is_simulation)
        return "simulated";
    return dataset->info.is_virtual ? "measured on a virtual rig" : "measured";
}

/* What the rows span. */
struct range {
    double deflection, force, tension; /* m, N, N: the largest */
    double duration;                   /* s */
    int cycles;
    size_t n_slack;
};

static struct range find_range(const struct wb_dataset *dataset)
{
    struct range range = {.deflection = -HUGE_VAL, .force = -HUGE_VAL, .tension = -HUGE_VAL};
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        range.deflection = fmax(range.deflection, row->deflection);
        range.force = fmax(range.force, row->force);
        range.tension = fmax(range.tension, row->tension);
        range.duration = row->t;
        range.cycles = row->cycle > range.cycles ? row->cycle : range.cycles;
        range.n_slack += row->phase == WB_PHASE_SLACK;
    }
    return range;
}

static void append_range(const struct wb_dataset *dataset, struct wb_text *text)
{
    const struct wb_test_info *const info = &dataset->info;
    const struct range range = find_range(dataset);
    if (dataset->n_rows == 0)
        return;
    wb_text_append(text, "cycles              %d\n", range.cycles);
    wb_text_append(text, "rows                %zu over %.1f s, %zu of them slack\n",
                   dataset->n_rows, range.duration, range.n_slack);
    wb_text_append(text, "%-19s %.2f mm\n",
                   info->kind == WB_TEST_TENSILE ? "largest elongation" : "largest deflection",
                   range.deflection / WB_MM);
    if (info->kind == WB_TEST_CANTILEVER && info->strand_length > 0.0)
        wb_text_append(text,
                       "largest force       %.2f mN above its value at zero deflection (tension "
                       "%.2f mN)\n",
                       range.force / WB_MN, range.tension / WB_MN);
    else
        wb_text_append(text, "largest force       %.4g N%s\n", range.force,
                       info->is_follower ? ", normal to the wire at its end" : "");
}

static bool find_bow(const struct wb_json *document, double *bow_mm, double *uncertainty_mm)
{
    const struct wb_json *const natural =
        wb_json_get(wb_json_get(document, "checks"), "natural_shape");
    return wb_json_get_number(natural, "bow_mm", bow_mm) &&
           wb_json_get_number(natural, "bow_uncertainty_mm", uncertainty_mm);
}

/* Deflection at which the force on the first unloading is zero, m; NaN: there is none. */
static double find_residual(const struct wb_dataset *dataset)
{
    struct wb_cycle_data data;
    struct wb_reason why = {.text = ""};
    if (wb_cycle_data_take(&data, dataset, NULL, &why) != WB_OK)
        return (double)NAN;
    const double residual = data.residual_deflection;
    wb_cycle_data_release(&data);
    return residual;
}

static void append_residual(const struct wb_dataset *dataset, struct wb_text *text)
{
    const double residual = find_residual(dataset);
    if (!isfinite(residual))
        return;
    const double largest = find_range(dataset).deflection;
    wb_text_append(text, "residual deflection %.2f mm at zero force of the unloading (%.0f %%)\n",
                   residual / WB_MM, 100.0 * residual / largest);
}

static void append_corrections(const struct wb_json *document, struct wb_text *text)
{
    static const char *const units[] = {"ms", "mN", "mm"};
    const struct wb_json *const list = wb_json_get(document, "corrections");
    if (wb_json_length(list) > 0)
        wb_text_append(text, "\ncorrections\n");
    for (size_t i = 0; i < wb_json_length(list); i++) {
        const struct wb_json *const entry = wb_json_item(list, i);
        wb_text_append(text, "  %-26s", text_or(entry, "name", "?"));
        for (size_t k = 0; k < sizeof units / sizeof units[0]; k++) {
            char key[32];
            double value, uncertainty;
            snprintf(key, sizeof key, "value_%s", units[k]);
            if (!wb_json_get_number(entry, key, &value))
                continue;
            wb_text_append(text, "%.4g", value);
            snprintf(key, sizeof key, "uncertainty_%s", units[k]);
            if (wb_json_get_number(entry, key, &uncertainty))
                wb_text_append(text, " +- %.2g", uncertainty);
            wb_text_append(text, " %s", units[k]);
        }
        wb_text_append(text, "\n");
    }
}

static void append_warnings(const struct wb_json *document, struct wb_text *text)
{
    const struct wb_json *const list = wb_json_get(document, "warnings");
    const char *warning;
    wb_text_append(text, wb_json_length(list) > 0 ? "\nwarnings\n" : "\nno warnings\n");
    for (size_t i = 0; i < wb_json_length(list); i++) {
        if (wb_json_text(wb_json_item(list, i), &warning))
            wb_text_append(text, "  - %s\n", warning);
    }
}

void wb_quicklook_summary(const struct wb_dataset *dataset, struct wb_text *text)
{
    const struct wb_test_info *const info = &dataset->info;
    const struct wb_json *const document = dataset->document;
    static const char *const lengths[WB_TEST_KINDS] = {
        [WB_TEST_CANTILEVER] = "free length",
        [WB_TEST_THREE_POINT] = "between the rollers",
        [WB_TEST_TENSILE] = "gauge length",
    };
    wb_text_append(text, "%s (%s)\n\n", text_or(document, "name", "dataset"), source_of(dataset));
    wb_text_append(text, "wire                %s", info->wire);
    if (info->sample > 0)
        wb_text_append(text, ", sample %d", info->sample);
    wb_text_append(text, ", %g mm %s\n", info->length / WB_MM, lengths[info->kind]);
    append_range(dataset, text);
    append_residual(dataset, text);
    double bow, bow_uncertainty;
    if (find_bow(document, &bow, &bow_uncertainty))
        wb_text_append(text, "bow                 %.2f +- %.2f mm\n", bow, bow_uncertainty);
    append_corrections(document, text);
    append_warnings(document, text);
}

void wb_quicklook_describe(const struct wb_dataset *dataset, struct wb_json *object)
{
    static const char *const copied[] = {"recordings", "complete", "corrections", "warnings"};
    const struct wb_test_info *const info = &dataset->info;
    const struct range range = find_range(dataset);
    double bow, bow_uncertainty;
    wb_json_set_text(object, "name", text_or(dataset->document, "name", "dataset"));
    wb_json_set_text(object, "data", source_of(dataset));
    wb_json_set_boolean(object, "virtual_rig", info->is_virtual);
    wb_json_set_text(object, "wire", info->wire);
    wb_json_set_integer(object, "sample", info->sample);
    wb_json_set_number(object, "length_mm", info->length / WB_MM);
    wb_json_set_integer(object, "cycles", range.cycles);
    wb_json_set_integer(object, "rows", (int64_t)dataset->n_rows);
    wb_json_set_integer(object, "slack_rows", (int64_t)range.n_slack);
    wb_json_set_number(object, "duration_s", range.duration);
    wb_json_set_number(object, "largest_deflection_mm", range.deflection / WB_MM);
    wb_json_set_number(object, "largest_force_N", range.force);
    wb_json_set_number(object, "largest_tension_N", range.tension);
    const double residual = find_residual(dataset);
    if (isfinite(residual))
        wb_json_set_number(object, "residual_deflection_mm", residual / WB_MM);
    if (find_bow(dataset->document, &bow, &bow_uncertainty)) {
        wb_json_set_number(object, "bow_mm", bow);
        wb_json_set_number(object, "bow_uncertainty_mm", bow_uncertainty);
    }
    for (size_t i = 0; i < sizeof copied / sizeof copied[0]; i++) {
        const struct wb_json *const value = wb_json_get(dataset->document, copied[i]);
        if (value)
            wb_json_set_copy(object, copied[i], value);
    }
}

/* --- the curve --- */

/* Columns of one line: a NaN breaks it where rows are slack or left out. */
struct line {
    size_t n;
    double *x, *y; /* one allocation, owned by x */
};

static struct line allocate_line(size_t most)
{
    double *const x = wb_memory_new(2 * most + 2, sizeof *x);
    return (struct line){.x = x, .y = x + most + 1};
}

static void add_curve(struct wb_panel *panel, const struct wb_dataset *dataset, int cycle,
                      int n_cycles, enum wb_phase phase, struct line *line)
{
    /* Not dashed: noise of the deflection would make dashes of all lengths. */
    const struct wb_figure_style style = {
        .colour = wb_palette_sequence(cycle - 1, n_cycles),
        .width = phase == WB_PHASE_LOAD ? 1.6 : 0.7,
    };
    char label[64];
    const double longest = wb_dataset_gap(dataset);
    double last = (double)NAN;
    size_t n_shown = 0;
    line->n = 0;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        /* A gap in time is a gap in the line. */
        const bool gap = row->t - last > longest;
        const bool shown = row->cycle == cycle && row->phase == phase && !gap;
        last = row->t;
        if (!shown && (line->n == 0 || isnan(line->x[line->n - 1])))
            continue;
        line->x[line->n] = shown ? row->deflection / WB_MM : (double)NAN;
        line->y[line->n++] = shown ? row->force / WB_MN : (double)NAN;
        n_shown += shown;
    }
    snprintf(label, sizeof label, "cycle %d, %sing", cycle, wb_trial_phase_name(phase));
    if (n_shown > 1)
        wb_figure_add_line(panel, label, line->n, line->x, line->y, &style);
}

/* Where the force is gone on the first unloading: a ring, with the number in the legend. */
static void add_residual(struct wb_panel *panel, const struct wb_dataset *dataset)
{
    const double residual = find_residual(dataset) / WB_MM, none = 0.0;
    const struct wb_figure_style style = {
        .colour = wb_palette_wire(1), .marker = WB_MARKER_RING, .marker_size = 6.0};
    char label[64];
    if (!isfinite(residual))
        return;
    snprintf(label, sizeof label, "residual deflection: %.1f mm", residual);
    wb_figure_add_line(panel, label, 1, &residual, &none, &style);
}

static void set_origin(struct wb_figure *figure, const struct wb_dataset *dataset)
{
    struct wb_text footer = {0};
    wb_text_append_escaped(&footer, text_or(dataset->document, "name", ""));
    wb_text_append(&footer, ", %s", source_of(dataset));
    wb_figure_set_footer(figure, wb_text_string(&footer));
    wb_text_release(&footer);
}

static void set_title(struct wb_panel *panel, const struct wb_dataset *dataset)
{
    struct wb_text title = {0};
    wb_text_append_escaped(&title, dataset->info.wire);
    wb_text_append(&title, ", <i>L</i> = %g mm", dataset->info.length / WB_MM);
    if (dataset->info.sample > 0)
        wb_text_append(&title, ", sample %d", dataset->info.sample);
    wb_figure_set_title(panel, wb_text_string(&title));
    wb_text_release(&title);
}

static enum wb_status draw_curve(struct wb_figure **out, const struct wb_dataset *dataset)
{
    int n_cycles = 1;
    for (size_t i = 0; i < dataset->n_rows; i++)
        n_cycles = dataset->rows[i].cycle > n_cycles ? dataset->rows[i].cycle : n_cycles;
    struct line line = allocate_line(dataset->n_rows);
    const enum wb_status status = wb_figure_create(out, "force-deflection", WIDTH, HEIGHT);
    if (status == WB_OK) {
        struct wb_panel *const panel = wb_figure_add_panel(*out);
        wb_figure_set_axes(panel, "Deflection (mm)",
                           "Force above its value at zero deflection (mN)");
        set_title(panel, dataset);
        for (int cycle = 1; cycle <= n_cycles; cycle++) {
            add_curve(panel, dataset, cycle, n_cycles, WB_PHASE_LOAD, &line);
            add_curve(panel, dataset, cycle, n_cycles, WB_PHASE_UNLOAD, &line);
        }
        add_residual(panel, dataset);
        set_origin(*out, dataset);
    }
    free(line.x);
    return status;
}

/* --- the shapes --- */

/* Largest deflection among the shapes of the way there: until it was first reached. */
static double largest_shape(const struct wb_dataset *dataset, size_t *last)
{
    double largest = -HUGE_VAL;
    *last = 0;
    for (size_t i = 0; i < dataset->n_shape_rows; i++) {
        if (dataset->shape_rows[i].deflection > largest) {
            largest = dataset->shape_rows[i].deflection;
            *last = i;
        }
    }
    while (*last < dataset->n_shape_rows && dataset->shape_rows[*last].deflection == largest)
        (*last)++;
    return largest;
}

static enum wb_status draw_shapes(struct wb_figure **out, const struct wb_dataset *dataset)
{
    size_t last;
    const double largest = largest_shape(dataset, &last);
    struct line line = allocate_line(dataset->n_shape_rows);
    const enum wb_status status = wb_figure_create(out, "shapes", WIDTH, HEIGHT);
    if (status == WB_OK) {
        struct wb_panel *const panel = wb_figure_add_panel(*out);
        wb_figure_set_axes(panel, "<i>x</i> (mm)", "<i>y</i> (mm)");
        wb_figure_set_equal_aspect(panel);
        set_title(panel, dataset);
        int drawn = 0;
        for (size_t i = 0; i < last && drawn < MOST_SHAPES;) {
            const struct wb_shape_row *const first = &dataset->shape_rows[i];
            for (line.n = 0; i < last && dataset->shape_rows[i].t == first->t; i++) {
                line.x[line.n] = dataset->shape_rows[i].x / WB_MM;
                line.y[line.n++] = dataset->shape_rows[i].y / WB_MM;
            }
            /* The first shape at or beyond each of equal steps of deflection. */
            if (first->deflection < largest * drawn / (MOST_SHAPES - 1) - 0.25 * WB_MM)
                continue;
            const struct wb_figure_style style = {
                .colour = wb_palette_sequence(drawn, MOST_SHAPES),
                .width = 1.0,
                .marker = WB_MARKER_CIRCLE,
            };
            char label[48];
            snprintf(label, sizeof label, "%.1f mm", first->deflection / WB_MM);
            wb_figure_add_line(panel, label, line.n, line.x, line.y, &style);
            drawn++;
        }
        set_origin(*out, dataset);
    }
    free(line.x);
    return status;
}

/* --- files --- */

static enum wb_status write_figure(const struct wb_figure *figure, const char *folder,
                                   const char *name, bool with_pdf)
{
    static const char *const endings[] = {"svg", "png", "pdf"};
    char file[64], path[WB_PATH];
    for (int i = 0; i < (with_pdf ? 3 : 2); i++) {
        snprintf(file, sizeof file, "%s.%s", name, endings[i]);
        WB_TRY(wb_file_join(path, folder, file));
        WB_TRY(wb_figure_write_file(figure, PNG_SCALE, path));
    }
    return WB_OK;
}

static enum wb_status write_drawing(const struct wb_dataset *dataset, const char *folder,
                                    enum wb_status (*draw)(struct wb_figure **out,
                                                           const struct wb_dataset *dataset),
                                    const char *name, bool with_pdf)
{
    struct wb_figure *figure = NULL;
    enum wb_status status = draw(&figure, dataset);
    if (status == WB_OK)
        status = write_figure(figure, folder, name, with_pdf);
    wb_figure_destroy(figure);
    return status;
}

enum wb_status wb_quicklook_draw(const struct wb_dataset *dataset, const char *path)
{
    struct wb_figure *figure = NULL;
    enum wb_status status = draw_curve(&figure, dataset);
    if (status == WB_OK)
        status = wb_figure_write_file(figure, PNG_SCALE, path);
    wb_figure_destroy(figure);
    return status;
}

static enum wb_status write_summary(const struct wb_dataset *dataset, const char *folder)
{
    struct wb_text text = {0};
    char path[WB_PATH];
    WB_TRY(wb_file_join(path, folder, "summary.txt"));
    wb_quicklook_summary(dataset, &text);
    const enum wb_status status = wb_file_write_text(path, &text);
    wb_text_release(&text);
    return status;
}

enum wb_status wb_quicklook_write(const struct wb_dataset *dataset, const char *folder, bool force)
{
    WB_TRY(wb_dataset_write(dataset, folder, force));
    WB_TRY(write_drawing(dataset, folder, draw_curve, "force_deflection", true));
    if (dataset->n_shape_rows > 0)
        WB_TRY(write_drawing(dataset, folder, draw_shapes, "shapes", false));
    return write_summary(dataset, folder);
}
