#include "analysis/dataset/simulated.h"

#include <math.h>
#include <stdio.h>

#include "analysis/dataset/csv_table.h"
#include "analysis/keys/common.h"
#include "base/units.h"
#include "fe/material/law_json.h"
#include "fe/model/model_inputs.h"

enum {
    MM_SHIFT = 3 /* from m, as force_deflection.csv has it */
};

static const double stage_speed = 1e-3;  /* m/s, of the paper's stage */
static const double shortest_row = 1e-3; /* s */

void wb_simulated_add_row(struct wb_dataset *dataset, struct wb_row row, const double *before,
                          const double *tip, const struct wb_simulated_shapes *shapes)
{
    double(*const places)[3] = shapes->places + dataset->n_rows * (size_t)shapes->n;
    row.t = 0.0;
    if (before) {
        const double way = hypot(hypot(tip[0] - before[0], tip[1] - before[1]), tip[2] - before[2]);
        row.t = dataset->rows[dataset->n_rows - 1].t + fmax(way / stage_speed, shortest_row);
    }
    row.stage = (double)NAN;
    row.tip_x = tip[0];
    wb_dataset_add_row(dataset, &row);
    for (int k = 0; k < shapes->n; k++) {
        const struct wb_shape_row marker = {
            .t = row.t,
            .deflection = row.deflection,
            .marker = k,
            .s = shapes->s[k],
            .x = places[k][0],
            .y = places[k][1],
            .z = places[k][2],
        };
        wb_dataset_add_shape_row(dataset, &marker);
    }
}

void wb_simulated_append_energies(struct wb_text *text, const double *columns, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        wb_text_append(text, "%s", i == 0 ? "" : ",");
        wb_csv_table_append_number(text, columns[i], i == 1 ? MM_SHIFT : 0);
    }
    wb_text_append(text, "\n");
}

static void add_rows(struct wb_dataset *dataset, const struct wb_loading_steps *loading,
                     const double *shape_s)
{
    double travelled = 0.0;

    for (int i = 0; i < loading->n_rows; i++) {
        const struct wb_loading_steps_row *row = &loading->rows[i];
        if (i > 0)
            travelled += fabs(row->point.control - loading->rows[i - 1].point.control);
        const struct wb_row out = {
            .t = travelled / stage_speed,
            .cycle = row->cycle,
            .phase = row->phase,
            .deflection = row->point.deflection,
            .tension = row->point.tension,
            .force = row->force,
            .stage = (double)NAN,
            .tip_x = row->point.tip_x,
            .tip_angle = row->point.tip_angle,
        };
        wb_dataset_add_row(dataset, &out);

        for (int k = 0; k < loading->n_shape; k++) {
            const size_t at = (size_t)i * (size_t)loading->n_shape + (size_t)k;
            const struct wb_shape_row shape = {
                .t = out.t,
                .deflection = out.deflection,
                .marker = k,
                .s = shape_s[k],
                .x = loading->shape_x[at],
                .y = loading->shape_y[at],
            };
            wb_dataset_add_shape_row(dataset, &shape);
        }
    }
}

/* Parameters of the law used in the computation. */
static void describe_law(struct wb_json *simulation, const struct wb_law *law)
{
    const struct wb_material *const material = &law->material;
    const bool is_ludwik = law->form == WB_LAW_LUDWIK;
    const bool is_elastic = is_ludwik && material->hardening == WB_HARDENING_NONE_ELASTIC;
    wb_json_set_text(simulation, "law", is_elastic ? "elastic" : "elastoplastic");
    wb_json_set_number(simulation, "youngs_modulus_MPa", material->youngs_modulus / WB_MPA);
    wb_json_set_number(simulation, "poissons_ratio", material->poissons_ratio);
    if (is_elastic)
        return;
    if (is_ludwik)
        wb_law_json_numbers(simulation, law, "MPa", WB_MPA);
    wb_json_set_text(simulation, "form", wb_law_form_name(law->form));
    wb_json_set_text(simulation, "hardening", wb_law_rule_name(law));
    wb_json_set_number(simulation, "isotropic_share", law->isotropic_share);
    if (!is_ludwik)
        wb_law_json_numbers(simulation, law, "MPa", WB_MPA);
}

void wb_simulated_cantilever_inputs(struct wb_json *object,
                                    const struct wb_simulated_cantilever *cantilever)
{
    wb_json_set_text(object, "solver", "cantilever");
    wb_json_set_integer(object, "version", WB_CANTILEVER_VERSION);
    wb_model_inputs_law(wb_json_set_object(object, "law"), cantilever->law);
    wb_json_set_number(object, "outer_diameter_mm", cantilever->outer_diameter / WB_MM);
    wb_json_set_number(object, "length_mm", cantilever->length / WB_MM);
    wb_json_set_number(object, "deflection_mm", cantilever->deflection / WB_MM);
    wb_json_set_number(object, "strand_mm", cantilever->strand_length / WB_MM);
    wb_json_set_number(object, "weight_kg_m", cantilever->mass_per_length);
    wb_json_set_integer(object, "points", cantilever->points);
    wb_json_set_integer(object, "cycles", cantilever->cycles);
}

/* `zero_force` (N) may be NaN: there is none. */
static void describe(struct wb_json *document, const struct wb_test_info *info, bool converged,
                     double zero_force, const struct wb_simulated_origin *origin)
{
    char name[128];
    snprintf(name, sizeof name, "%s, simulated %s", info->wire, origin->model);
    wb_json_set_text(document, "name", name);

    struct wb_json *simulation = wb_json_set_object(document, "simulation");
    wb_json_set_text(simulation, "model", origin->model);
    if (origin->cantilever)
        wb_simulated_cantilever_inputs(wb_json_set_object(simulation, "inputs"),
                                       origin->cantilever);
    describe_law(simulation, origin->law);
    wb_json_set_text(simulation, "properties_source", origin->source);
    wb_json_set_boolean(simulation, "converged", converged);
    if (isfinite(zero_force))
        wb_json_set_number(simulation, "zero_force_N", zero_force);
    wb_json_set_number(simulation, "wall_s", origin->wall);
    wb_json_set_number(simulation, "cpu_s", origin->cpu);

    wb_keys_put_tool(document, "wirebench");
}

void wb_simulated_fill(struct wb_dataset *dataset, const struct wb_test_info *info,
                       const struct wb_loading_steps *loading, const double *shape_s,
                       const struct wb_simulated_origin *origin)
{
    dataset->info = *info;
    dataset->info.is_simulation = true;
    add_rows(dataset, loading, shape_s);
    describe(dataset->document, info, loading->converged, loading->zero_force, origin);
}

void wb_simulated_fill_three_point(struct wb_dataset *dataset, const struct wb_test_info *info,
                                   const struct wb_simulated_bending *bending,
                                   const struct wb_simulated_origin *origin)
{
    double travelled = 0.0;

    dataset->info = *info;
    dataset->info.is_simulation = true;
    for (int i = 0; i < bending->n_rows; i++) {
        const struct wb_simulated_bending_row *const row = &bending->rows[i];
        if (i > 0)
            travelled += fabs(row->point.travel - bending->rows[i - 1].point.travel);
        const struct wb_row out = {
            .t = travelled / stage_speed,
            .cycle = row->cycle,
            .phase = row->phase,
            .deflection = row->point.travel,
            .tension = row->point.force,
            .force = row->point.force,
            .stage = (double)NAN,
            .tip_x = (double)NAN,
            .tip_angle = (double)NAN,
        };
        wb_dataset_add_row(dataset, &out);
    }
    describe(dataset->document, info, bending->converged, (double)NAN, origin);
}
