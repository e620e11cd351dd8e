#include "analysis/dataset/simulated_section.h"

#include <string.h>

#include "analysis/dataset/csv_table.h"
#include "analysis/dataset/simulated.h"
#include "analysis/dataset/simulated_bundle.h"
#include "analysis/keys/common.h"
#include "analysis/keys/row.h"
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

#define RUN(member) WB_AT(struct wb_section_run, member)
#define RIGIDITY(member) WB_AT(struct wb_section_run_rigidity, member)
#define POINT(member) WB_AT(struct wb_section_homogenise_point, member)

static const struct wb_key section_energy_rows[] = {
    {"external_J", NUMBER, "work of the tip's force and of the weight"},
    {"wires_J", NUMBER, "stored and plastic work of the wires"},
    {"tape_J", NUMBER, "stored and plastic work of the tape"},
    {"cohesive_J", NUMBER, "energy stored in the bond"},
    {"friction_J", NUMBER,
     "energy dissipated by friction, with what contacts store before they slip"},
    {"imbalance_J", NUMBER, "external work less all other energies"},
};
static WB_KEYS(section_energy, "energy_of_section", "Energies at the last row.");

static const struct wb_key section_largest_rows[] = {
    {"residual", RUN(residual) | UNKNOWN, "residual over the largest force"},
    {"imbalance_over_external", RUN(imbalance) | UNKNOWN, "imbalance over the external work"},
    {"contact_balance_missing", RUN(missing) | UNKNOWN,
     "load in the plane that contact forces do not balance, over the largest load"},
    {"tape_plastic_strain", RUN(tape_plastic), "plastic strain of the tape"},
};
static WB_KEYS(section_largest, "largest_of_section", "Largest values of the run.");

static const struct wb_key elastic_rows[] = {
    {"length_mm", RIGIDITY(length), "length: half, once or twice the bundle's"},
    {"flexural_rigidity_N_mm2", RIGIDITY(rigidity), "flexural rigidity of the homogenised beam"},
    {"newmark_alpha_L", RIGIDITY(alpha) | UNKNOWN,
     "alpha L of Newmark's theory; null: no slip gives the rigidity"},
};
static WB_KEYS(elastic, "elastic_beam", "The elastic rigidity at one length.");

static const struct wb_key curve_rows[] = {
    {"curvature_1_m", POINT(curvature), "curvature"},
    {"moment_N_mm", POINT(moment), "moment"},
    {"secant_rigidity_N_mm2", NUMBER | UNKNOWN, "moment over curvature"},
};
static WB_KEYS(curve, "beam_moment", "A point of the moment curve.");

static const struct wb_key beam_rows[] = {
    {"elastic", OBJECT | LIST, "rigidity at half, once and twice the length", &elastic_keys},
    {"moment_curvature", OBJECT | LIST, "moment over curvature", &curve_keys},
};
static WB_KEYS(
    beam, "homogenised_beam",
    "The beam that bends like the bundle; it holds for this length and these ends only.");

static const struct wb_key wb_simulated_section_rows[] = {
    {"bending", TEXT, "kind of bending: planar, without twist"},
    {"friction_used", RUN(friction), "friction coefficient of the computation"},
    {"friction_is_mean_of_decay", RUN(is_mean),
     "it is the geometric mean of a static and a kinetic coefficient"},
    {"mirrored", RUN(is_mirrored), "mirror images share unknowns"},
    {"elements_along", RUN(elements), "elements along the bundle"},
    {"unknowns", RUN(unknowns), "unknowns of all stations"},
    {"increments", RUN(increments), "increments of the loading"},
    {"iterations", RUN(iterations), "iterations of the equilibrium"},
    {"energy", OBJECT | OPTIONAL, "energies at the last row", &section_energy_keys},
    {"largest", WB_HERE(struct wb_section_run), "largest values of the run", &section_largest_keys},
    {"homogenised_beam_of_this_length_and_these_ends", OBJECT, "beam that bends alike", &beam_keys},
    {"converged", RUN(converged), "the whole loading was computed"},
    {"stopped", RUN(stopped), "stopped by Ctrl-C"},
    {"zero_force_N", RUN(zero_force) | UNKNOWN, "vertical force that `force_N` is counted from"},
    {"wall_s", WB_AT(struct wb_simulated_section, wall), "time of the computation"},
    {"cpu_s", WB_AT(struct wb_simulated_section, cpu), "CPU time of the computation"},
};
WB_KEYS(wb_simulated_section, "section_keys", "");

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
    struct wb_json *const member =
        wb_json_set_object(object, "homogenised_beam_of_this_length_and_these_ends");
    struct wb_json *const lengths = wb_json_set_array(member, "elastic");
    struct wb_json *const points = wb_json_set_array(member, "moment_curvature");

    for (int i = 0; i < WB_SECTION_RUN_LENGTHS && run->rigidity[i].length > 0.0; i++) {
        const struct wb_section_run_rigidity *const r = &run->rigidity[i];
        WB_PUT(wb_json_append_object(lengths), &elastic_keys, struct wb_section_run_rigidity, r);
    }
    for (int i = 0; i < run->n_curve; i++) {
        const struct wb_section_homogenise_point *const p = &run->curve[i];
        struct wb_json *const item = wb_json_append_object(points);
        WB_PUT(item, &curve_keys, struct wb_section_homogenise_point, p);
        wb_json_set_number(item, "secant_rigidity_N_mm2", p->moment / p->curvature / WB_NMM2);
    }
}

void wb_simulated_section_describe(struct wb_json *object,
                                   const struct wb_simulated_section *section)
{
    const struct wb_section_run *const run = section->run;

    wb_json_set_text(object, "bending", "planar, without twist");
    WB_PUT(object, &wb_simulated_section_keys, struct wb_section_run, run);
    if (run->n_rows > 0)
        describe_energies(wb_json_set_object(object, "energy"),
                          &run->rows[run->n_rows - 1].energies);
    WB_PUT(object, &wb_simulated_section_keys, struct wb_section_run, run);
    describe_beam(object, run);
    WB_PUT(object, &wb_simulated_section_keys, struct wb_section_run, run);
    WB_PUT(object, &wb_simulated_section_keys, struct wb_simulated_section, section);
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
    wb_keys_put_tool(dataset->document, "wirebench");
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
