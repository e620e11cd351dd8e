#include "fe/swept/swept_hex.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/circle.h"
#include "base/memory.h"
#include "fe/material/hardening.h"
#include "fe/swept/swept_hex_kernel.h"
#include "fe/swept/swept_private.h"

#define WB_LOG_DOMAIN "swept"

enum {
    CONSTANTS = WB_SWEPT_HEX_KERNEL_CONSTANTS,
    TERMS = WB_SWEPT_HEX_KERNEL_TERMS,
    MAX_ELEMENTS = 1 << 20
};

static const double default_hourglass = 0.05;

static const struct wb_swept_hex_kernel *const kernels[][2] =
    WB_SWEPT_KERNEL_VERSIONS(wb_swept_hex_kernel);

struct wb_swept_hex {
    struct wb_swept_hex_model model;
    const struct wb_swept_hex_kernel *kernel;
    struct wb_swept_hex_kernel_model numbers;
    double *rows;    /* constants (n_quads x CONSTANTS) */
    void *constants; /* the same in the kernel's type */
    void *table;
    int n_points;
    struct wb_memory memory; /* of all arrays */
};

struct wb_swept_hex_state {
    const struct wb_swept_hex *hex;
    void *history, *workspace;
    size_t history_size;     /* numbers */
    struct wb_memory memory; /* of both */
};

static size_t real_size(const struct wb_swept_hex *hex)
{
    return wb_swept_kernel_real_size(hex->model.double_precision);
}

static enum wb_status make_table(struct wb_swept_hex *hex)
{
    double table[TERMS][WB_HARDENING_TABLE_OCTAVES];
    struct wb_material radial = hex->model.material;

    radial.youngs_modulus = 3.0 * wb_material_shear_modulus(&radial);
    WB_TRY(wb_hardening_tabulate_octaves(&radial, TERMS, &table[0][0]));
    hex->table = wb_swept_kernel_convert(&hex->memory, hex->model.double_precision, &table[0][0],
                                         sizeof table / sizeof table[0][0]);
    return WB_OK;
}

static void fill_row(const struct wb_swept_hex_model *m, const struct wb_swept_quad *quad,
                     double *row)
{
    const double mu = wb_material_shear_modulus(&m->material), h = m->element_length,
                 volume = quad->area * h;
    const double kappa =
        m->material.youngs_modulus / (3.0 * (1.0 - 2.0 * m->material.poissons_ratio));
    const double along = m->hourglass * m->material.youngs_modulus * quad->area / h;
    const double(*const at)[2] = quad->corner;

    for (int i = 0; i < 2; i++) {
        row[WB_SWEPT_HEX_B + 2 * i] = 0.5 * quad->gradient[i][2];
        row[WB_SWEPT_HEX_B + 2 * i + 1] = 0.5 * quad->gradient[i][3];
        row[WB_SWEPT_HEX_GAMMA + i] = 2.0 * (at[0][i] - at[1][i] + at[2][i] - at[3][i]);
    }
    row[WB_SWEPT_HEX_K_PLANE] = m->hourglass * mu * quad->hourglass_slope * h / 64.0;
    row[WB_SWEPT_HEX_K_VOLUME] = kappa * volume;
    for (int a = 0; a < 4; a++)
        row[WB_SWEPT_HEX_MEAN + a] = quad->mean[a] / h;
    if (m->formulation == WB_SWEPT_HEX_ONE_POINT) {
        row[WB_SWEPT_HEX_K_ALONG] = row[WB_SWEPT_HEX_K_ALONG + 1] = along / 3.0;
        row[WB_SWEPT_HEX_K_ALONG + 2] = along / 9.0;
        row[WB_SWEPT_HEX_STIFFNESS] = 2.0 * mu * volume;
        return;
    }
    for (int q = 0; q < 4; q++) {
        double *point = row + WB_SWEPT_HEX_POINT + q * WB_SWEPT_HEX_POINT_STRIDE;
        for (int a = 0; a < 4; a++)
            point[a] = quad->value[q][a] / h;
        point[4] = 2.0 * mu * volume * quad->weight[q];
    }
}

static void make_constants(struct wb_swept_hex *hex)
{
    const struct wb_swept_section *section = hex->model.section;
    const size_t count = (size_t)section->n_quads * CONSTANTS;

    hex->rows = wb_memory_take(&hex->memory, count, sizeof *hex->rows);
    for (int e = 0; e < section->n_quads; e++) {
        struct wb_swept_quad quad;
        wb_swept_section_quad(section, e, &quad);
        fill_row(&hex->model, &quad, hex->rows + e * CONSTANTS);
    }
    hex->constants =
        wb_swept_kernel_convert(&hex->memory, hex->model.double_precision, hex->rows, count);
}

static enum wb_status check(const struct wb_swept_hex_model *m)
{
    const struct wb_material *material = &m->material;
    char why[120];

    if (m->n_elements < 1 || m->n_elements > MAX_ELEMENTS)
        return wb_fail(WB_ERR_ARGUMENT, "elements along the wire: %d: expected 1 to %d",
                       m->n_elements, MAX_ELEMENTS);
    if (!wb_swept_is_positive(m->element_length))
        return wb_fail(WB_ERR_ARGUMENT, "element length %g m: expected a number above 0",
                       m->element_length);
    if (!(m->hourglass > 0.0 && m->hourglass <= 1.0))
        return wb_fail(WB_ERR_ARGUMENT,
                       "the hourglass coefficient is %g: expected above 0, at most 1",
                       m->hourglass);
    if (wb_hardening_law(material)->moves)
        return wb_fail(
            WB_ERR_UNSUPPORTED,
            "kinematic hardening is not supported by hexahedra; expected isotropic hardening");
    if (!wb_swept_is_positive(material->youngs_modulus) ||
        !(material->poissons_ratio > -1.0 && material->poissons_ratio < 0.5))
        return wb_fail(WB_ERR_ARGUMENT,
                       "wire: Young's modulus %g Pa, Poisson's ratio %g: expected "
                       "a modulus above 0, and a ratio above -1 and below 0.5",
                       material->youngs_modulus, material->poissons_ratio);
    if (!wb_hardening_is_possible(material, why, sizeof why))
        return wb_fail(WB_ERR_ARGUMENT, "%s", why);
    return WB_OK;
}

/* Node farthest from the central node. */
static int farthest_node(const struct wb_swept_section *section)
{
    const double *centre = section->node[section->centre];
    int farthest = section->centre;
    double distance = 0.0;

    for (int k = 0; k < section->n_nodes; k++) {
        const double off = hypot(section->node[k][0] - centre[0], section->node[k][1] - centre[1]);
        if (off > distance) {
            distance = off;
            farthest = k;
        }
    }
    return farthest;
}

static int find_first_added(const struct wb_swept_section *section)
{
    int first = section->n_outline > 0 ? section->n_nodes : 0;
    for (int i = 0; i < section->n_outline; i++)
        first = section->outline[i] < first ? section->outline[i] : first;
    return first;
}

static enum wb_status fill(struct wb_swept_hex *hex)
{
    const struct wb_swept_hex_model *m = &hex->model;
    const bool yields = wb_hardening_law(&m->material)->yields;

    WB_TRY(check(m));
    WB_TRY(wb_swept_choose_instructions(&hex->model.instructions, m->instructions));
    hex->kernel = kernels[m->instructions][m->double_precision];
    hex->n_points = m->formulation == WB_SWEPT_HEX_ONE_POINT ? 1 : 4;
    make_constants(hex);
    WB_TRY(make_table(hex));
    hex->numbers = (struct wb_swept_hex_kernel_model){
        .layout = wb_swept_layout(m->section->n_nodes, m->n_elements + 1),
        .n_quads = m->section->n_quads,
        .n_elements = m->n_elements,
        .counted = wb_swept_range_within(m->counted, m->n_elements),
        .centre = m->section->centre,
        .beside = farthest_node(m->section),
        .first_added = find_first_added(m->section),
        .quad = (const int(*)[4])m->section->quad,
        .node = (const double(*)[2])m->section->node,
        .length = m->element_length,
        .yield_strain =
            yields ? m->material.yield_stress / (3.0 * wb_material_shear_modulus(&m->material))
                   : (double)INFINITY,
        .strain_limit = WB_SWEPT_HEX_STRAIN_LIMIT,
        .constants = hex->constants,
        .table = hex->table};
    return WB_OK;
}

int wb_swept_hex_first_added(const struct wb_swept_hex *hex)
{
    return hex->numbers.first_added;
}

enum wb_status wb_swept_hex_create(struct wb_swept_hex **out,
                                   const struct wb_swept_hex_model *model)
{
    *out = NULL;
    struct wb_swept_hex *const hex = wb_memory_new(1, sizeof *hex);
    hex->model = *model;
    if (hex->model.hourglass == 0.0)
        hex->model.hourglass = default_hourglass;
    const enum wb_status status = fill(hex);
    if (status != WB_OK) {
        wb_swept_hex_destroy(hex);
        return status;
    }
    *out = hex;
    return WB_OK;
}

void wb_swept_hex_destroy(struct wb_swept_hex *hex)
{
    if (!hex)
        return;
    wb_memory_release(&hex->memory);
    free(hex);
}

const struct wb_swept_hex_model *wb_swept_hex_get_model(const struct wb_swept_hex *hex)
{
    return &hex->model;
}

struct wb_swept_layout wb_swept_hex_layout(const struct wb_swept_hex *hex)
{
    return hex->numbers.layout;
}

int wb_swept_hex_blocks(const struct wb_swept_hex *hex)
{
    return hex->numbers.layout.stride / WB_SWEPT_LANES;
}

void wb_swept_hex_hourglass(const struct wb_swept_hex *hex, int quad, double stiffness[4])
{
    const double *row = hex->rows + quad * CONSTANTS;

    stiffness[0] = 64.0 * row[WB_SWEPT_HEX_K_PLANE];
    for (int i = 0; i < 3; i++)
        stiffness[1 + i] = row[WB_SWEPT_HEX_K_ALONG + i];
}

struct wb_swept_hex_state *wb_swept_hex_state_create(const struct wb_swept_hex *hex)
{
    const struct wb_swept_layout *layout = &hex->numbers.layout;
    const size_t points = (size_t)layout->stride * (size_t)hex->numbers.n_quads * //
                          (size_t)hex->n_points;
    const size_t vectors =
        (size_t)(WB_SWEPT_HEX_KERNEL_NODE + WB_SWEPT_HEX_KERNEL_CARRY) * (size_t)layout->n_nodes;

    struct wb_swept_hex_state *const state = wb_memory_new(1, sizeof *state);
    state->hex = hex;
    state->history_size = points * WB_SWEPT_HEX_KERNEL_HISTORY;
    state->history = wb_swept_take(&state->memory, state->history_size, real_size(hex));
    state->workspace = wb_swept_take(&state->memory, vectors * WB_SWEPT_LANES, real_size(hex));
    return state;
}

void wb_swept_hex_state_destroy(struct wb_swept_hex_state *state)
{
    if (!state)
        return;
    wb_memory_release(&state->memory);
    free(state);
}

void *wb_swept_hex_state_data(struct wb_swept_hex_state *state, size_t *bytes)
{
    *bytes = state->history_size * real_size(state->hex);
    return state->history;
}

void wb_swept_hex_add_forces(struct wb_swept_hex_state *state,
                             const struct wb_swept_hex_fields *fields, int first, int end,
                             struct wb_swept_hex_sums *sums)
{
    const struct wb_swept_hex *hex = state->hex;
    const struct wb_swept_hex_kernel_call call = {
        .model = &hex->numbers,
        .fields = *fields,
        .history = state->history,
        .workspace = state->workspace,
        .first_block = first,
        .end_block = end,
        .sums = sums,
    };

    if (hex->model.formulation == WB_SWEPT_HEX_ONE_POINT)
        hex->kernel->one_point(&call);
    else
        hex->kernel->four_points(&call);
}

double wb_swept_hex_history(const struct wb_swept_hex_state *state, int quad, int element,
                            int point, int component)
{
    const struct wb_swept_hex *hex = state->hex;
    const size_t block = (size_t)(element / WB_SWEPT_LANES);
    const size_t place =
        (block * (size_t)hex->numbers.n_quads + (size_t)quad) * (size_t)hex->n_points +
        (size_t)point;
    const size_t at = (place * WB_SWEPT_HEX_KERNEL_HISTORY + (size_t)component) * WB_SWEPT_LANES +
                      (size_t)(element % WB_SWEPT_LANES);

    return wb_swept_kernel_get(hex->model.double_precision, state->history, (ptrdiff_t)at);
}

double wb_swept_hex_plastic_work(const struct wb_swept_hex_state *state)
{
    const struct wb_swept_hex *hex = state->hex;
    const struct wb_material *m = &hex->model.material;
    const double two_mu = 2.0 * wb_material_shear_modulus(m);
    double work = 0.0;

    for (int e = 0; e < hex->numbers.n_quads; e++) {
        const double *row = hex->rows + e * CONSTANTS;
        for (int q = 0; q < hex->n_points; q++) {
            const double volume =
                (hex->n_points == 1 ? row[WB_SWEPT_HEX_STIFFNESS]
                                    : row[WB_SWEPT_HEX_POINT + q * WB_SWEPT_HEX_POINT_STRIDE + 4]) /
                two_mu;
            double density = 0.0;
            for (int j = hex->numbers.counted.first; j < hex->numbers.counted.end; j++) {
                const double p = wb_swept_hex_history(state, e, j, q, WB_SWEPT_HEX_ACCUMULATED);
                if (p > 0.0)
                    density += p * wb_hardening_mean_stress(m, p);
            }
            work += density * volume;
        }
    }
    return work;
}

/* Sum of weight (y - mean)^2 over the points, and the corresponding moment of the three hourglass
 * fields for one point: the means of xi^2 and eta^2 are 1/3, that of (xi eta)^2 is 1/9. */
static double varying_moment(const struct wb_swept_quad *quad, double mean,
                             enum wb_swept_hex_formulation formulation)
{
    double points = 0.0, y[4];

    for (int a = 0; a < 4; a++) {
        points += quad->weight[a] * (quad->at[a][0] - mean) * (quad->at[a][0] - mean);
        y[a] = 0.25 * quad->corner[a][0];
    }
    if (formulation == WB_SWEPT_HEX_FOUR_POINTS)
        return points;
    const double xi = y[1] + y[2] - y[0] - y[3], eta = y[2] + y[3] - y[0] - y[1];
    const double both = y[0] + y[2] - y[1] - y[3];
    return (xi * xi + eta * eta) / 3.0 + both * both / 9.0;
}

/* The second moment of area about the z axis, m4, that the section's elements have in elastic
 * bending: from mean axial strains, sum A y^2 of the centres; from their variation within elements,
 * with four points 3 mu / E of it, with one point the hourglass stiffness with the default
 * coefficient. */
static double second_moment(const struct wb_swept_section *section,
                            enum wb_swept_hex_formulation formulation,
                            const struct wb_material *material)
{
    const double factor = formulation == WB_SWEPT_HEX_FOUR_POINTS
                              ? 3.0 * wb_material_shear_modulus(material) / material->youngs_modulus
                              : default_hourglass;
    double moment = 0.0;

    for (int e = 0; e < section->n_quads; e++) {
        struct wb_swept_quad quad;
        double mean = 0.0;
        wb_swept_section_quad(section, e, &quad);
        for (int q = 0; q < 4; q++)
            mean += quad.weight[q] * quad.at[q][0];
        moment += quad.area * (mean * mean + factor * varying_moment(&quad, mean, formulation));
    }
    return moment;
}

void wb_swept_hex_fit_circle(struct wb_swept_section *section, double diameter,
                             enum wb_swept_hex_formulation formulation,
                             const struct wb_material *material)
{
    const double wanted = wb_circle_second_moment(diameter);

    wb_swept_section_scale(section,
                           pow(wanted / second_moment(section, formulation, material), 0.25));
}
