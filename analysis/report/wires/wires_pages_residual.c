/* Residual stresses: pre-loads, what they leave, and what it does under the follower force. */
#include <math.h>
#include <stdio.h>

#include "analysis/report/pages_private.h"
#include "analysis/report/wires/wires_pages.h"
#include "base/text.h"
#include "base/units.h"

static bool is_zero(const double vector[3])
{
    return vector[0] == 0.0 && vector[1] == 0.0 && vector[2] == 0.0;
}

static void append_vector(struct wb_text *text, const char *what, const double vector[3],
                          const char *unit)
{
    if (!is_zero(vector))
        wb_text_append(text, "%s (%g, %g, %g) %s", what, vector[0], vector[1], vector[2], unit);
}

/* A step as what acts at its end. */
static void append_step(struct wb_text *text, const struct wb_tip_loads *loads)
{
    append_vector(text, " force", loads->force, "N");
    append_vector(text, !is_zero(loads->force) ? " and moment" : " moment", loads->moment, "N m");
    if (loads->follower[1] != 0.0)
        wb_text_append(text, " follower force %g N", loads->follower[1]);
    else if (is_zero(loads->force) && is_zero(loads->moment))
        wb_text_append(text, " nothing");
}

static void put_preloads(struct wb_document *document, const struct wb_wires *comparison)
{
    for (int i = 0; i < comparison->n_residual; i++) {
        const struct wb_wires_case *const item = &comparison->cases[WB_WIRES_RESIDUAL + i];
        char label[200];
        struct wb_text text = {0};
        wb_text_append(&text, "<b>%s.</b> At the tip act, step by step:",
                       wb_pages_escape(label, sizeof label, item->label));
        for (int k = 0; k < item->model->n_steps; k++) {
            wb_text_append(&text, "%s", k > 0 ? ";" : "");
            append_step(&text, &item->model->step[k].loads);
        }
        wb_text_append(&text, ".");
        wb_document_item(document, WB_TONE_PLAIN, wb_text_string(&text));
        document->failed |= text.failed;
        wb_text_release(&text);
    }
}

/* Largest and smallest axial stress of the core, Pa. */
static void find_axial(const struct wb_field *field, double range[2])
{
    range[0] = range[1] = (double)NAN;
    for (int i = 0; field && i < field->n_faces; i++) {
        for (int k = 0; k < 8 && field->faces[i].part == 0; k++) {
            range[0] = fmin(range[0], field->faces[i].node[k].axial);
            range[1] = fmax(range[1], field->faces[i].node[k].axial);
        }
    }
}

static void put_residual_row(struct wb_document *document, struct wb_document_table *table,
                             const struct wb_wires_results *results, int index,
                             enum wb_wires_solver solver)
{
    const struct wb_wires *const comparison = results->comparison;
    const struct wb_wires_run *const run = wb_wires_usable(results, index, solver);
    const struct wb_wires_run *const without =
        wb_wires_usable(results, WB_WIRES_ELASTOPLASTIC, solver);
    const struct wb_field *const field =
        run ? wb_fields_find(&run->fields, comparison->residual_state, comparison->section) : NULL;
    double axial[2];
    if (!run)
        return;
    find_axial(field, axial);
    struct wb_pages_row row = {.n = 0};
    wb_pages_cell_plain(&row, WB_TONE_PLAIN, comparison->cases[index].label);
    wb_pages_cell(&row, WB_TONE_PLAIN, solver == WB_WIRES_SOLID ? "3D" : "1D fibres");
    wb_pages_cell_number(&row, field ? field->x / WB_MM : (double)NAN, 2);
    wb_pages_cell_number(&row, axial[1] / WB_MPA, 1);
    wb_pages_cell_number(&row, axial[0] / WB_MPA, 1);
    wb_pages_cell_number(&row, wb_wires_find_peak(field, 0).stress / WB_MPA, 1);
    wb_pages_cell_number(&row, without ? wb_wires_effect(run, without) / WB_MM : (double)NAN, 3);
    wb_pages_cell_number(&row, without ? wb_wires_distance(without, run) / WB_MM : (double)NAN, 3);
    wb_pages_put_row(document, table, solver == WB_WIRES_SOLID, &row);
}

static void put_residual_stresses(struct wb_document *document,
                                  const struct wb_wires_results *results)
{
    static const struct wb_document_column columns[] = {
        {"Case"},
        {"Model"},
        {.heading = "Section at (mm)", .right = true, .wraps = true},
        {.heading = "Axial, largest (MPa)", .right = true, .wraps = true},
        {.heading = "Axial, smallest (MPa)", .right = true, .wraps = true},
        {.heading = "von Mises, largest (MPa)", .right = true, .wraps = true},
        {.heading = "Tip moved, at most (mm)", .right = true, .wraps = true},
        {.heading = "Axis moved at the end (mm)", .right = true, .wraps = true},
    };
    const struct wb_wires *const comparison = results->comparison;
    struct wb_document_table *const table = wb_document_table(
        document,
        "Stresses of the core on the section that is drawn, without load. Moved: distance from the "
        "same model without residual stress, of the tip at any force on the way and of the axis at "
        "the full one.",
        8, columns);
    for (int i = 0; i < comparison->n_residual; i++) {
        for (int k = 0; k < WB_WIRES_SOLVERS; k++)
            put_residual_row(document, table, results, WB_WIRES_RESIDUAL + i,
                             (enum wb_wires_solver)k);
    }
}

/* The paper's finding beside ours. */
static void put_finding(struct wb_document *document, const struct wb_wires_results *results)
{
    const struct wb_wires *const comparison = results->comparison;
    const struct wb_wires_run *const without =
        wb_wires_usable(results, WB_WIRES_ELASTOPLASTIC, WB_WIRES_SOLID);
    double moved = (double)NAN, stress = (double)NAN;
    char text[500];
    for (int i = 0; i < comparison->n_residual; i++) {
        const struct wb_wires_run *const run =
            wb_wires_usable(results, WB_WIRES_RESIDUAL + i, WB_WIRES_SOLID);
        if (!run || !without)
            continue;
        moved = fmax(moved, wb_wires_effect(run, without));
        stress =
            fmax(stress, wb_wires_find_peak(wb_fields_find(&run->fields, comparison->residual_state,
                                                           comparison->section),
                                            0)
                             .stress);
    }
    if (!isfinite(moved) || !isfinite(stress))
        return;
    snprintf(text, sizeof text,
             "%s pre-loads leave at most <b>%.0f MPa</b> in the solid's core on that section, "
             "and move its tip by at most <b>%.2f mm</b> while the follower force grows.",
             comparison->printed_source[0]
                 ? "The paper finds the shapes notably different. Here the"
                 : "The",
             stress / WB_MPA, moved / WB_MM);
    wb_document_paragraph(document, text);
}

void wb_wires_pages_residual(struct wb_document *document, const struct wb_wires_results *results,
                             const struct wb_wires_figures *figures)
{
    const struct wb_wires *const comparison = results->comparison;
    char caption[700], in[48];
    if (comparison->n_residual == 0)
        return;
    wb_document_heading(document, 1, "residual", "Residual stresses");
    wb_document_paragraph(document,
                          "Loads at the tip bend and twist the wire out of the plane, and are "
                          "taken off. What stays is the residual stress; with it the follower "
                          "force is applied. All of it is simulated.");
    put_preloads(document, comparison);
    wb_document_heading(document, 2, "residual-stresses", "Residual stress and its effect");
    for (int i = 0; i < comparison->n_residual; i++) {
        char label[200];
        if (!figures->residual[i])
            continue;
        snprintf(
            caption, sizeof caption,
            "%s%s: simulated residual stress in the core near the clamp, seen from it: axial "
            "stress, tension positive, and von Mises stress, of the solid and of the rod's "
            "fibres.",
            wb_pages_escape(label, sizeof label, comparison->cases[WB_WIRES_RESIDUAL + i].label),
            wb_wires_pages_figure(in, results, "5a"));
        wb_document_figures(document, figures->residual[i], caption, NULL, NULL);
    }
    put_residual_stresses(document, results);
    put_finding(document, results);
    if (figures->residual_stress) {
        snprintf(caption, sizeof caption,
                 "Von Mises stress at %g N without and with residual stresses%s, simulated: "
                 "longitudinal sections as they are deformed, seen from the side, with the largest "
                 "value of the core.",
                 wb_wires_pages_force(results), wb_wires_pages_figure(in, results, "5b"));
        wb_document_figures(document, figures->residual_stress, caption, NULL, NULL);
    }
    if (figures->residual_shapes)
        wb_document_figures(document, figures->residual_shapes,
                            "The same shapes of solid and rod as lines, and how far residual "
                            "stress moves the tip while the force grows.",
                            NULL, NULL);
    wb_document_heading(document, 2, "residual-shapes", "Shapes");
    struct wb_document_table *const table = wb_wires_pages_start_tips(document, NULL);
    for (int i = 0; i <= comparison->n_residual; i++) {
        const int index = WB_WIRES_ELASTOPLASTIC + i;
        const char *const name = i == 0 ? "None" : comparison->cases[index].label;
        const struct wb_wires_run *const solid = wb_wires_usable(results, index, WB_WIRES_SOLID);
        char label[100];
        snprintf(label, sizeof label, "%s, 3D", name);
        wb_wires_pages_put_tip(document, table, label, solid, solid);
        snprintf(label, sizeof label, "%s, 1D fibres", name);
        wb_wires_pages_put_tip(document, table, label,
                               wb_wires_usable(results, index, WB_WIRES_ROD), solid);
    }
}
