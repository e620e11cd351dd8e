#include "fe/swept/swept_tape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fe/material/hardening.h"
#include "fe/swept/swept_frequency.h"
#include "fe/swept/swept_private.h"
#include "fe/swept/swept_tape_kernel.h"

#define WB_LOG_DOMAIN "swept"

enum {
    LANES = WB_SWEPT_LANES,
    MAX_NODES = 1 << 16,
    UNKNOWNS = 24, /* of an element: 4 positions, then 4 directors */
    LENGTHS = WB_SWEPT_TAPE_N_MEASURES,
    ALL_MEASURES = LENGTHS + 4
};

_Static_assert((int)WB_SWEPT_TAPE_STRESS_MOST == (int)WB_SWEPT_TAPE_MOST_POINTS,
               "room for the points");

static const double default_hourglass = 0.1;
static const double shear_correction = 5.0 / 6.0;

static const struct wb_swept_tape_kernel *const kernels[][2] =
    WB_SWEPT_KERNEL_VERSIONS(wb_swept_tape_kernel);

/* An element of the reference state. */
struct element {
    double node[4][3], director[4][3]; /* (k, j), (k, j + 1), (k + 1, j), (k + 1, j + 1) */
    double area;                       /* of the plane through the middle, m2 */
    double B[3];                       /* 11, 21, 22 */
    double hourglass[2];               /* in the frame, m */
    double normal[3];
};

struct wb_swept_tape {
    struct wb_swept_tape_model model;
    const struct wb_swept_tape_kernel *kernel;
    struct wb_swept_tape_kernel_model numbers;
    void *reference, *length_stiffness;
    double *position, *director; /* fields */
    double *area;                /* (n_nodes x stride) */
    double *mass, *inertia;      /* (n_nodes), per length */
    struct wb_memory memory;     /* of all arrays */
};

struct wb_swept_tape_state {
    const struct wb_swept_tape *tape;
    void *history, *carry;
    size_t history_size;     /* numbers */
    struct wb_memory memory; /* of both */
};

/* Gauss points from -1 to 1 and weights whose sum is 1, for 2 to 5 points. */
static const double gauss_point[4][WB_SWEPT_TAPE_MOST_POINTS] = {
    {-0.57735026918962576, 0.57735026918962576},
    {-0.77459666924148338, 0.0, 0.77459666924148338},
    {-0.86113631159405258, -0.33998104358485626, 0.33998104358485626, 0.86113631159405258},
    {-0.90617984593866399, -0.53846931010568309, 0.0, 0.53846931010568309, 0.90617984593866399},
};
static const double gauss_weight[4][WB_SWEPT_TAPE_MOST_POINTS] = {
    {0.5, 0.5},
    {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0},
    {0.17392742256872693, 0.32607257743127307, 0.32607257743127307, 0.17392742256872693},
    {0.11846344252809454, 0.23931433524968324, 0.28444444444444444, 0.23931433524968324,
     0.11846344252809454},
};

/* Writes a value in the kernel's type. */
static void put(const struct wb_swept_tape *tape, void *numbers, size_t at, double value)
{
    wb_swept_kernel_put(tape->model.double_precision, numbers, (ptrdiff_t)at, value);
}

static double get(const struct wb_swept_tape *tape, const void *numbers, size_t at)
{
    return wb_swept_kernel_get(tape->model.double_precision, numbers, (ptrdiff_t)at);
}

/* Index of a constant of an element (between nodes `element` and the next, stations `along` and the
 * next) in the reference state. */
static size_t reference_at(const struct wb_swept_tape *tape, int element, int along, int which)
{
    const size_t place =
        (size_t)(along / LANES) * (size_t)tape->numbers.n_elements + (size_t)element;

    return (place * WB_SWEPT_TAPE_REFERENCE + (size_t)which) * LANES + (size_t)(along % LANES);
}

static double constant(const struct wb_swept_tape *tape, int element, int along, int which)
{
    return get(tape, tape->reference, reference_at(tape, element, along, which));
}

/* A component of an element's history. */
static double kept(const struct wb_swept_tape_state *state, int element, int along, int point,
                   int component)
{
    const struct wb_swept_tape_kernel_model *m = &state->tape->numbers;
    const size_t place =
        ((size_t)(along / LANES) * (size_t)m->n_elements + (size_t)element) * (size_t)m->n_points +
        (size_t)point;

    return get(state->tape, state->history,
               (place * WB_SWEPT_TAPE_HISTORY + (size_t)component) * LANES +
                   (size_t)(along % LANES));
}

/* --- the reference state --- */

static bool is_convex(const struct element *e)
{
    static const int next[4] = {1, 3, 0, 2}; /* around the element */
    static const int before[4] = {2, 0, 3, 1};

    for (int a = 0; a < 4; a++) {
        double one[3], other[3], normal[3];
        for (int i = 0; i < 3; i++) {
            one[i] = e->node[next[a]][i] - e->node[a][i];
            other[i] = e->node[before[a]][i] - e->node[a][i];
        }
        wb_vec3_cross(one, other, normal);
        if (!(wb_vec3_dot(normal, e->normal) > 0.0))
            return false;
    }
    return true;
}

/* Computes the positions of an element's nodes and its geometry; directors are zero before they
 * exist. False if it is not convex. */
static bool find_element(const struct wb_swept_tape *tape, int k, int j, struct element *element)
{
    const struct wb_swept_layout *layout = &tape->model.layout;
    double X1[3], X2[3], XH[3], e1[3], e2[3], area[3];

    for (int a = 0; a < 4; a++) {
        const int node = (k + a / 2) % layout->n_nodes;
        for (int i = 0; i < 3; i++) {
            const size_t at = (size_t)(3 * node + i) * (size_t)layout->stride + (size_t)(j + a % 2);
            element->node[a][i] = tape->position[at];
            element->director[a][i] = tape->director[at];
        }
    }
    for (int i = 0; i < 3; i++) {
        const double *x[4] = {element->node[0], element->node[1], element->node[2],
                              element->node[3]};
        X1[i] = 0.5 * (x[1][i] - x[0][i] + x[3][i] - x[2][i]);
        X2[i] = 0.5 * (x[2][i] - x[0][i] + x[3][i] - x[1][i]);
        XH[i] = 0.5 * (x[3][i] - x[2][i] - x[1][i] + x[0][i]);
    }
    wb_vec3_cross(X1, X2, area);
    element->area = sqrt(wb_vec3_dot(area, area));
    const double length = sqrt(wb_vec3_dot(X1, X1));
    if (!(wb_swept_is_positive(element->area) && length > 0.0))
        return false;
    for (int i = 0; i < 3; i++) {
        e1[i] = X1[i] / length;
        element->normal[i] = area[i] / element->area;
    }
    wb_vec3_cross(element->normal, e1, e2);
    const double across = wb_vec3_dot(X2, e2);
    element->B[0] = 1.0 / length;
    element->B[1] = -wb_vec3_dot(X2, e1) / (across * length);
    element->B[2] = 1.0 / across;
    element->hourglass[0] = wb_vec3_dot(XH, e1);
    element->hourglass[1] = wb_vec3_dot(XH, e2);
    return is_convex(element);
}

/* Squared radius of gyration for the inertia of an element's directors, m2. */
static double gyration(const struct wb_swept_tape *tape, const struct element *element)
{
    const double thickness = tape->model.thickness / tape->model.sheets;
    return element->area / 8.0 + thickness * thickness / 6.0;
}

/* Calls `use` for each element with its indices. */
static enum wb_status for_elements(struct wb_swept_tape *tape,
                                   void (*use)(struct wb_swept_tape *tape, int k, int j,
                                               const struct element *element))
{
    for (int k = 0; k < tape->numbers.n_elements; k++) {
        for (int j = 0; j < tape->numbers.n_along; j++) {
            struct element element;
            if (!find_element(tape, k, j, &element))
                return wb_fail(WB_ERR_ARGUMENT, "tape element at node %d, station %d is not convex",
                               k, j);
            use(tape, k, j, &element);
        }
    }
    return WB_OK;
}

/* Adds an element's area and masses to its nodes. */
static void lump(struct wb_swept_tape *tape, int k, int j, const struct element *element)
{
    const struct wb_swept_tape_model *m = &tape->model;
    const size_t stride = (size_t)m->layout.stride;
    const double share = 0.25 * element->area;
    const double mass = m->density * m->thickness * share;
    const double length = m->spacing * (m->layout.n_stations - 1);
    const double stiffness =
        shear_correction * wb_material_shear_modulus(&m->material) * m->thickness * share;

    for (int a = 0; a < 4; a++) {
        const int node = (k + a / 2) % m->layout.n_nodes;
        const size_t at = (size_t)node * stride + (size_t)(j + a % 2);
        for (int i = 0; i < 3; i++)
            tape->director[(size_t)(3 * node + i) * stride + (size_t)(j + a % 2)] +=
                element->normal[i];
        tape->area[at] += share;
        tape->mass[node] += mass / length;
        tape->inertia[node] += mass / length * gyration(tape, element);
        put(tape, tape->length_stiffness, at, get(tape, tape->length_stiffness, at) + stiffness);
    }
}

static void fill_reference(struct wb_swept_tape *tape, int k, int j, const struct element *element)
{
    const double constants[] = {
        [WB_SWEPT_TAPE_B11] = element->B[0],
        [WB_SWEPT_TAPE_B21] = element->B[1],
        [WB_SWEPT_TAPE_B22] = element->B[2],
        [WB_SWEPT_TAPE_C1] = element->hourglass[0],
        [WB_SWEPT_TAPE_C2] = element->hourglass[1],
        [WB_SWEPT_TAPE_VOLUME] = element->area * tape->model.thickness,
    };

    for (int i = 0; i <= WB_SWEPT_TAPE_VOLUME; i++)
        put(tape, tape->reference, reference_at(tape, k, j, i), constants[i]);
}

/* Directors are projected into the plane of their section, so that the surface they point to is in
 * the same section (fe/swept/swept_cohesion.h). */
static enum wb_status normalise_directors(struct wb_swept_tape *tape)
{
    const struct wb_swept_layout *layout = &tape->model.layout;
    const size_t stride = (size_t)layout->stride;

    for (int k = 0; k < layout->n_nodes; k++) {
        for (int j = 0; j < layout->n_stations; j++) {
            double *d = tape->director + 3 * (size_t)k * stride + (size_t)j;
            const double length = hypot(d[stride], d[2 * stride]);
            if (!(length > 0.1))
                return wb_fail(
                    WB_ERR_ARGUMENT,
                    "the tape is folded, or not aligned with the axis, at node %d, station %d", k,
                    j);
            d[0] = 0.0;
            d[stride] /= length;
            d[2 * stride] /= length;
        }
    }
    return WB_OK;
}

/* Geometry, masses, and the measures of the reference state as computed by the kernel, so that its
 * strains there are exactly zero. */
static enum wb_status make_reference(struct wb_swept_tape *tape)
{
    WB_TRY(for_elements(tape, lump));
    WB_TRY(normalise_directors(tape));
    WB_TRY(for_elements(tape, fill_reference));
    const struct wb_swept_tape_kernel_call call = {
        .model = &tape->numbers,
        .fields = {.position = tape->position, .director = tape->director}};
    tape->kernel->measure(&call);
    return WB_OK;
}

/* --- creation --- */

static enum wb_status check_material(const struct wb_material *m)
{
    char why[120];

    if (wb_hardening_law(m)->moves)
        return wb_fail(
            WB_ERR_UNSUPPORTED,
            "kinematic hardening is not supported by the tape; expected isotropic hardening");
    if (!wb_swept_is_positive(m->youngs_modulus) ||
        !(m->poissons_ratio > -1.0 && m->poissons_ratio <= 0.5))
        return wb_fail(WB_ERR_ARGUMENT,
                       "tape: Young's modulus %g Pa, Poisson's ratio %g: expected "
                       "a modulus above 0, and a ratio above -1 and at most 0.5",
                       m->youngs_modulus, m->poissons_ratio);
    if (!wb_hardening_is_possible(m, why, sizeof why))
        return wb_fail(WB_ERR_ARGUMENT, "tape: %s", why);
    return WB_OK;
}

static enum wb_status check(const struct wb_swept_tape_model *m)
{
    const struct wb_swept_layout *layout = &m->layout;

    WB_TRY(check_material(&m->material));
    if (layout->n_nodes < (m->closed ? 3 : 2) || layout->n_nodes > MAX_NODES ||
        layout->n_stations < 2 ||
        layout->stride != wb_swept_layout(layout->n_nodes, layout->n_stations).stride)
        return wb_fail(WB_ERR_ARGUMENT,
                       "tape: %d nodes, %d stations, stride %d: expected %d to %d "
                       "nodes, at least 2 stations and the stride of their layout",
                       layout->n_nodes, layout->n_stations, layout->stride, m->closed ? 3 : 2,
                       MAX_NODES);
    if (!wb_swept_is_positive(m->density) || !wb_swept_is_positive(m->thickness) ||
        !wb_swept_is_positive(m->spacing))
        return wb_fail(
            WB_ERR_ARGUMENT,
            "tape: density %g kg/m3, thickness %g m, station spacing %g m: expected numbers "
            "above 0",
            m->density, m->thickness, m->spacing);
    if (m->sheets < 1 || m->points < 2 || m->points > WB_SWEPT_TAPE_MOST_POINTS)
        return wb_fail(WB_ERR_ARGUMENT,
                       "tape: %d sheets, %d points through the thickness: expected at "
                       "least 1 sheet, and 2 to %d points",
                       m->sheets, m->points, WB_SWEPT_TAPE_MOST_POINTS);
    if (!(m->hourglass > 0.0 && m->hourglass <= 1.0))
        return wb_fail(WB_ERR_ARGUMENT,
                       "tape: hourglass coefficient %g: expected above 0, at most 1", m->hourglass);
    return WB_OK;
}

static void set_numbers(struct wb_swept_tape *tape)
{
    const struct wb_swept_tape_model *m = &tape->model;
    const double E = m->material.youngs_modulus, nu = m->material.poissons_ratio;
    const double mu = wb_material_shear_modulus(&m->material), bent = m->thickness / m->sheets;
    const bool yields = wb_hardening_law(&m->material)->yields;
    const double yield_strain = yields ? m->material.yield_stress / (3.0 * mu) : (double)INFINITY;
    struct wb_swept_tape_kernel_model *k = &tape->numbers;

    *k = (struct wb_swept_tape_kernel_model){
        .layout = m->layout,
        .n_elements = m->layout.n_nodes - (m->closed ? 0 : 1),
        .n_along = m->layout.n_stations - 1,
        .closed = m->closed,
        .n_points = m->points,
        .sum_modulus = E / (1.0 - nu),
        .difference_modulus = 2.0 * mu,
        .shear = shear_correction * mu,
        .membrane_hourglass = m->hourglass * E / 3.0,
        .bending_hourglass = m->hourglass * E / 3.0 * bent * bent / 12.0,
        .yield_strain = yield_strain,
        .exponent = wb_hardening_exponent(&m->material, yield_strain),
        .mean_share = 2.0 * (1.0 + nu) / (3.0 * (1.0 - nu)),
        .mean_slope = (1.0 + nu) / (3.0 * (1.0 - nu)),
        .strain_limit = WB_SWEPT_TAPE_STRAIN_LIMIT,
        .counted = wb_swept_range_within(m->counted, m->layout.n_stations),
    };
    for (int i = 0; i < m->points; i++) {
        k->z[i] = 0.5 * bent * gauss_point[m->points - 2][i];
        k->weight[i] = gauss_weight[m->points - 2][i];
    }
}

static void allocate(struct wb_swept_tape *tape)
{
    const struct wb_swept_layout *layout = &tape->model.layout;
    const size_t nodes = (size_t)layout->n_nodes, stride = (size_t)layout->stride;
    const size_t size = wb_swept_kernel_real_size(tape->model.double_precision);
    const size_t elements = (size_t)tape->numbers.n_elements * stride;

    tape->reference = wb_swept_take(&tape->memory, elements * WB_SWEPT_TAPE_REFERENCE, size);
    tape->length_stiffness = wb_swept_take(&tape->memory, nodes * stride, size);
    tape->position = wb_swept_take(&tape->memory, wb_swept_size(layout), sizeof(double));
    tape->director = wb_swept_take(&tape->memory, wb_swept_size(layout), sizeof(double));
    tape->area = wb_swept_take(&tape->memory, nodes * (stride + 2), sizeof(double));
    tape->mass = tape->area + nodes * stride;
    tape->inertia = tape->mass + nodes;
    tape->numbers.reference = tape->reference;
    tape->numbers.length_stiffness = tape->length_stiffness;
}

static enum wb_status fill(struct wb_swept_tape *tape)
{
    const struct wb_swept_tape_model *m = &tape->model;
    struct wb_material radial = m->material;
    double table[WB_SWEPT_TAPE_TERMS][WB_HARDENING_TABLE_OCTAVES];

    WB_TRY(check(m));
    radial.youngs_modulus *= 1.5 / (1.0 + radial.poissons_ratio); /* 3 mu */
    WB_TRY(wb_swept_choose_instructions(&tape->model.instructions, m->instructions));
    tape->kernel = kernels[m->instructions][m->double_precision];
    set_numbers(tape);
    allocate(tape);
    WB_TRY(wb_hardening_tabulate_octaves(&radial, WB_SWEPT_TAPE_TERMS, &table[0][0]));
    tape->numbers.table = wb_swept_kernel_convert(&tape->memory, m->double_precision, &table[0][0],
                                                  sizeof table / sizeof table[0][0]);
    for (int row = 0; row < 3 * m->layout.n_nodes; row++) {
        const size_t at = (size_t)row * (size_t)m->layout.stride;
        memcpy(tape->position + at, m->position + at,
               (size_t)m->layout.n_stations * sizeof *tape->position);
    }
    tape->model.position = tape->position;
    return make_reference(tape);
}

enum wb_status wb_swept_tape_create(struct wb_swept_tape **out,
                                    const struct wb_swept_tape_model *model)
{
    *out = NULL;
    struct wb_swept_tape *const tape = wb_memory_new(1, sizeof *tape);
    tape->model = *model;
    if (tape->model.hourglass == 0.0)
        tape->model.hourglass = default_hourglass;
    if (tape->model.sheets == 0)
        tape->model.sheets = 1;
    if (tape->model.points == 0)
        tape->model.points = 3;
    const enum wb_status status = fill(tape);
    if (status != WB_OK) {
        wb_swept_tape_destroy(tape);
        return status;
    }
    *out = tape;
    return WB_OK;
}

void wb_swept_tape_destroy(struct wb_swept_tape *tape)
{
    if (!tape)
        return;
    wb_memory_release(&tape->memory);
    free(tape);
}

const struct wb_swept_tape_model *wb_swept_tape_get_model(const struct wb_swept_tape *tape)
{
    return &tape->model;
}

int wb_swept_tape_blocks(const struct wb_swept_tape *tape)
{
    return tape->model.layout.stride / LANES;
}

int wb_swept_tape_elements(const struct wb_swept_tape *tape)
{
    return tape->numbers.n_elements;
}

const double *wb_swept_tape_directors(const struct wb_swept_tape *tape)
{
    return tape->director;
}

double wb_swept_tape_area(const struct wb_swept_tape *tape, int node, int station)
{
    return tape->area[(size_t)node * (size_t)tape->model.layout.stride + (size_t)station];
}

void wb_swept_tape_masses(const struct wb_swept_tape *tape, double *mass, double *inertia)
{
    const size_t size = (size_t)tape->model.layout.n_nodes * sizeof *mass;

    memcpy(mass, tape->mass, size);
    memcpy(inertia, tape->inertia, size);
}

/* --- states --- */

struct wb_swept_tape_state *wb_swept_tape_state_create(const struct wb_swept_tape *tape)
{
    const struct wb_swept_layout *layout = &tape->model.layout;
    const size_t real = wb_swept_kernel_real_size(tape->model.double_precision);

    struct wb_swept_tape_state *const state = wb_memory_new(1, sizeof *state);
    state->tape = tape;
    state->history_size = (size_t)tape->numbers.n_elements * (size_t)layout->stride *
                          (size_t)tape->numbers.n_points * WB_SWEPT_TAPE_HISTORY;
    state->history = wb_swept_take(&state->memory, state->history_size, real);
    state->carry =
        wb_swept_take(&state->memory, (size_t)layout->n_nodes * WB_SWEPT_TAPE_CARRY * LANES, real);
    return state;
}

void wb_swept_tape_state_destroy(struct wb_swept_tape_state *state)
{
    if (!state)
        return;
    wb_memory_release(&state->memory);
    free(state);
}

void *wb_swept_tape_state_data(struct wb_swept_tape_state *state, size_t *bytes)
{
    *bytes = state->history_size * wb_swept_kernel_real_size(state->tape->model.double_precision);
    return state->history;
}

void wb_swept_tape_forces(struct wb_swept_tape_state *state,
                          const struct wb_swept_tape_fields *fields, int first, int end,
                          struct wb_swept_tape_sums *sums)
{
    const struct wb_swept_tape *tape = state->tape;
    const struct wb_swept_tape_kernel_call call = {
        .model = &tape->numbers,
        .fields = *fields,
        .history = state->history,
        .carry = state->carry,
        .first_block = first,
        .end_block = end,
        .sums = sums,
    };

    tape->kernel->forces(&call);
}

double wb_swept_tape_plastic_strain(const struct wb_swept_tape_state *state, int element, int along,
                                    int point)
{
    return kept(state, element, along, point, 3);
}

double wb_swept_tape_plastic_work(const struct wb_swept_tape_state *state)
{
    const struct wb_swept_tape *tape = state->tape;
    const struct wb_swept_tape_kernel_model *m = &tape->numbers;
    const struct wb_material *law = &tape->model.material;
    const struct wb_swept_range counted = wb_swept_range_within(m->counted, m->n_along);
    double work = 0.0;

    for (int k = 0; k < m->n_elements; k++) {
        for (int j = counted.first; j < counted.end; j++) {
            double density = 0.0;
            for (int q = 0; q < m->n_points; q++) {
                const double p = wb_swept_tape_plastic_strain(state, k, j, q);
                if (p > 0.0)
                    density += m->weight[q] * p * wb_hardening_mean_stress(law, p);
            }
            work += density * constant(tape, k, j, WB_SWEPT_TAPE_VOLUME);
        }
    }
    return work;
}

/* --- stable step --- */

/* The measures of swept_tape_kernel.c and the directors' lengths, all quadratic in `u`: a simple
 * version of the kernel's computation. */
static void find_measures(const struct element *element, const double *u, double *e)
{
    const double *B = element->B, *c = element->hourglass;
    double mode[8][3], a1[3], a2[3], d1[3], d2[3], hx[3], hd[3];

    for (int f = 0; f < 2; f++) {
        for (int i = 0; i < 3; i++) {
            const double *x = u + 12 * f + i;
            mode[4 * f][i] = 0.25 * (x[0] + x[3] + x[6] + x[9]);
            mode[4 * f + 1][i] = 0.5 * (x[3] - x[0] + x[9] - x[6]);
            mode[4 * f + 2][i] = 0.5 * (x[6] - x[0] + x[9] - x[3]);
            mode[4 * f + 3][i] = 0.5 * (x[9] - x[6] - x[3] + x[0]);
        }
    }
    const double *X1 = mode[1], *X2 = mode[2], *XH = mode[3];
    const double *D0 = mode[4], *D1 = mode[5], *D2 = mode[6], *DH = mode[7];
    for (int i = 0; i < 3; i++) {
        a1[i] = B[0] * X1[i];
        a2[i] = B[1] * X1[i] + B[2] * X2[i];
        d1[i] = B[0] * D1[i];
        d2[i] = B[1] * D1[i] + B[2] * D2[i];
        hx[i] = XH[i] - c[0] * a1[i] - c[1] * a2[i];
        hd[i] = DH[i] - c[0] * d1[i] - c[1] * d2[i];
    }
    const double shear[2] = {wb_vec3_dot(X1, D0) + 0.5 * wb_vec3_dot(XH, D2),
                             wb_vec3_dot(X2, D0) + 0.5 * wb_vec3_dot(XH, D1)};
    e[0] = 0.25 * (wb_vec3_dot(a1, a1) + wb_vec3_dot(a2, a2));
    e[1] = 0.25 * (wb_vec3_dot(a1, a1) - wb_vec3_dot(a2, a2));
    e[2] = 0.5 * wb_vec3_dot(a1, a2);
    e[3] = 0.5 * (wb_vec3_dot(a1, d1) + wb_vec3_dot(a2, d2));
    e[4] = 0.5 * (wb_vec3_dot(a1, d1) - wb_vec3_dot(a2, d2));
    e[5] = 0.5 * (wb_vec3_dot(a1, d2) + wb_vec3_dot(a2, d1));
    e[6] = B[0] * shear[0];
    e[7] = B[1] * shear[0] + B[2] * shear[1];
    e[8] = 0.5 * wb_vec3_dot(X1, D2) + wb_vec3_dot(XH, D0);
    e[9] = 0.5 * wb_vec3_dot(X2, D1) + wb_vec3_dot(XH, D0);
    e[10] = wb_vec3_dot(hx, a1);
    e[11] = wb_vec3_dot(hx, a2);
    e[12] = wb_vec3_dot(hd, a1);
    e[13] = wb_vec3_dot(hd, a2);
    for (int a = 0; a < 4; a++)
        e[LENGTHS + a] = 0.5 * wb_vec3_dot(u + 12 + 3 * a, u + 12 + 3 * a);
}

/* Stiffnesses of the measures. */
static void find_stiffnesses(const struct wb_swept_tape *tape, const struct element *element,
                             double *k)
{
    const struct wb_swept_tape_kernel_model *m = &tape->numbers;
    const double V = element->area * tape->model.thickness;
    const double bent = tape->model.thickness / tape->model.sheets;
    const double *B = element->B;
    const double plane[2] = {B[0] * B[0] + B[1] * B[1], B[2] * B[2]};

    for (int i = 0; i < 3; i++) {
        k[i] = 2.0 * V * (i == 0 ? m->sum_modulus : m->difference_modulus);
        k[3 + i] = k[i] * bent * bent / 12.0;
    }
    for (int i = 0; i < 2; i++) {
        k[6 + i] = V * m->shear;
        k[8 + i] = V * m->shear / 3.0 * plane[i];
        k[10 + i] = V * m->membrane_hourglass * plane[i];
        k[12 + i] = V * m->bending_hourglass * plane[i];
    }
    for (int a = 0; a < 4; a++)
        k[LENGTHS + a] = 0.25 * V * m->shear;
}

/* The largest eigenvalue of M^-1 K with masses `mass`, `inertia` at each node of the element. */
static enum wb_status element_eigenvalue(const struct wb_swept_tape *tape,
                                         const struct element *element, double mass, double inertia,
                                         double *value)
{
    double u[UNKNOWNS], row[ALL_MEASURES][UNKNOWNS], k[ALL_MEASURES];
    double K[UNKNOWNS * UNKNOWNS] = {0.0};
    const double length = sqrt(element->area);

    for (int a = 0; a < 4; a++) {
        memcpy(u + 3 * a, element->node[a], sizeof element->node[a]);
        memcpy(u + 12 + 3 * a, element->director[a], sizeof element->director[a]);
    }
    for (int b = 0; b < UNKNOWNS; b++) {
        /* Central differences are exact for quadratic functions, except for round-off. */
        const double step = b < 12 ? 0.1 * length : 0.1, saved = u[b];
        double above[ALL_MEASURES], below[ALL_MEASURES];
        u[b] = saved + step;
        find_measures(element, u, above);
        u[b] = saved - step;
        find_measures(element, u, below);
        u[b] = saved;
        for (int i = 0; i < ALL_MEASURES; i++)
            row[i][b] = (above[i] - below[i]) / (2.0 * step * sqrt(b < 12 ? mass : inertia));
    }
    find_stiffnesses(tape, element, k);
    for (int i = 0; i < ALL_MEASURES; i++) {
        for (int a = 0; a < UNKNOWNS; a++) {
            for (int b = a; b < UNKNOWNS; b++)
                K[a * UNKNOWNS + b] += k[i] * row[i][a] * row[i][b];
        }
    }
    WB_TRY(wb_swept_frequency_largest(K, UNKNOWNS, "an element of the tape", value));
    *value *= 1.0 + 1e-9;
    return WB_OK;
}

/* True if one element is the other one moved and rotated, to 1e-9. */
static bool is_same(const struct element *a, const struct element *b)
{
    for (int p = 0; p < 4; p++) {
        for (int q = 0; q < 4; q++) {
            double of_a[3], of_b[3];
            for (int i = 0; i < 3; i++) {
                of_a[i] = a->node[q][i] - a->node[0][i];
                of_b[i] = b->node[q][i] - b->node[0][i];
            }
            const double size = sqrt(wb_vec3_dot(of_a, of_a));
            if (!(fabs(size - sqrt(wb_vec3_dot(of_b, of_b))) <= 1e-9 * size) ||
                !(fabs(wb_vec3_dot(a->director[p], of_a) - wb_vec3_dot(b->director[p], of_b)) <=
                  1e-9 * size) ||
                !(fabs(wb_vec3_dot(a->director[p], a->director[q]) -
                       wb_vec3_dot(b->director[p], b->director[q])) <= 1e-9))
                return false;
        }
    }
    return fabs(a->area - b->area) <= 1e-9 * a->area &&
           fabs(a->B[0] - b->B[0]) <= 1e-9 * fabs(a->B[0]) &&
           fabs(a->B[1] - b->B[1]) <= 1e-9 * fabs(a->B[0]) &&
           fabs(a->B[2] - b->B[2]) <= 1e-9 * fabs(a->B[2]);
}

/* Largest ratios of a node's share of the elements to the mean that it is given: masses are means
 * over the stations. */
static void largest_shares(const struct wb_swept_tape *tape, double *of_mass, double *of_inertia)
{
    const struct wb_swept_tape_model *m = &tape->model;
    const size_t stride = (size_t)m->layout.stride;
    double *const share = wb_memory_new((size_t)m->layout.n_nodes * stride, sizeof *share);

    *of_mass = *of_inertia = 0.0;
    for (int k = 0; k < tape->numbers.n_elements; k++) {
        for (int j = 0; j < tape->numbers.n_along; j++) {
            struct element e;
            (void)find_element(tape, k, j, &e);
            for (int a = 0; a < 4; a++)
                share[(size_t)((k + a / 2) % m->layout.n_nodes) * stride + (size_t)(j + a % 2)] +=
                    0.25 * e.area * gyration(tape, &e);
        }
    }
    for (int k = 0; k < m->layout.n_nodes; k++) {
        for (int j = 0; j < m->layout.n_stations; j++) {
            const size_t at = (size_t)k * stride + (size_t)j;
            const bool is_end = j == 0 || j == m->layout.n_stations - 1;
            const double factor = m->density * m->thickness / (m->spacing * (is_end ? 0.5 : 1.0));
            *of_mass = fmax(*of_mass, tape->area[at] * factor / tape->mass[k]);
            *of_inertia = fmax(*of_inertia, share[at] * factor / tape->inertia[k]);
        }
    }
    free(share);
}

enum wb_status wb_swept_tape_stiffness_per_mass(const struct wb_swept_tape *tape, double *largest)
{
    double of_mass = 0.0, of_inertia = 0.0, most = 0.0;

    largest_shares(tape, &of_mass, &of_inertia);
    for (int k = 0; k < tape->numbers.n_elements; k++) {
        struct element before;
        for (int j = 0; j < tape->numbers.n_along; j++) {
            struct element e;
            double value = 0.0;
            (void)find_element(tape, k, j, &e);
            if (j > 0 && is_same(&before, &e))
                continue;
            before = e;
            const double mass = tape->model.density * tape->model.thickness * 0.25 * e.area;
            WB_TRY(element_eigenvalue(tape, &e, mass / of_mass,
                                      mass * gyration(tape, &e) / of_inertia, &value));
            most = fmax(most, value);
        }
    }
    *largest = most;
    return WB_OK;
}

/* --- stresses --- */

/* A symmetric matrix in the plane: (11 + 22) / 2, (11 - 22) / 2, 12. */
struct symmetric {
    double mean, difference, both;
};

int wb_swept_tape_stress_points(const struct wb_swept_tape *tape)
{
    return tape->numbers.n_points;
}

/* Derivatives of a field along the element's frame. */
static void find_gradient(const struct wb_swept_tape *tape, const double *field, int element,
                          int along, double by[2][3])
{
    const int n = tape->model.layout.n_nodes, stride = tape->model.layout.stride;
    const double B11 = constant(tape, element, along, WB_SWEPT_TAPE_B11);
    const double B21 = constant(tape, element, along, WB_SWEPT_TAPE_B21);
    const double B22 = constant(tape, element, along, WB_SWEPT_TAPE_B22);

    for (int i = 0; i < 3; i++) {
        const double *a = field + (ptrdiff_t)(3 * element + i) * stride + along;
        const double *b = field + (ptrdiff_t)(3 * ((element + 1) % n) + i) * stride + along;
        const double by_xi = 0.5 * (a[1] - a[0] + b[1] - b[0]);
        const double by_eta = 0.5 * (b[0] + b[1] - a[0] - a[1]);
        by[0][i] = B11 * by_xi;
        by[1][i] = B21 * by_xi + B22 * by_eta;
    }
}

/* 1/2 a_i.b_j, symmetrised, minus `reference`. */
static struct symmetric products(double a[2][3], double b[2][3], double factor,
                                 const double reference[3])
{
    const double first = wb_vec3_dot(a[0], b[0]), second = wb_vec3_dot(a[1], b[1]);

    return (struct symmetric){
        0.5 * factor * (first + second) - reference[0],
        0.5 * factor * (first - second) - reference[1],
        0.5 * factor * (wb_vec3_dot(a[0], b[1]) + wb_vec3_dot(a[1], b[0])) - reference[2],
    };
}

/* Membrane strain and curvature, Green's. */
static void find_strains(const struct wb_swept_tape *tape, const double *position,
                         const double *director, int element, int along, struct symmetric *E,
                         struct symmetric *K)
{
    double a[2][3], d[2][3], membrane[3], bending[3];

    for (int i = 0; i < 3; i++) {
        membrane[i] =
            constant(tape, element, along, WB_SWEPT_TAPE_MEASURES + WB_SWEPT_TAPE_MEMBRANE + i);
        bending[i] =
            constant(tape, element, along, WB_SWEPT_TAPE_MEASURES + WB_SWEPT_TAPE_BENDING + i);
    }
    find_gradient(tape, position, element, along, a);
    find_gradient(tape, director, element, along, d);
    *E = products(a, a, 0.5, membrane);
    *K = products(a, d, 1.0, bending);
}

/* f(E) by eigenvalues, f(e) = e - e^2 + 4/3 e^3 - 2 e^4. */
static struct symmetric logarithm(const struct symmetric *E)
{
    const double r = hypot(E->difference, E->both), e[2] = {E->mean + r, E->mean - r};
    double f[2];

    for (int i = 0; i < 2; i++)
        f[i] = e[i] * (1.0 - e[i] * (1.0 - e[i] * (4.0 / 3.0 - 2.0 * e[i])));
    const double turn = r > 0.0 ? 0.5 * (f[0] - f[1]) / r : 0.0;
    return (struct symmetric){0.5 * (f[0] + f[1]), turn * E->difference, turn * E->both};
}

void wb_swept_tape_stress_find(const struct wb_swept_tape *tape,
                               const struct wb_swept_tape_state *state, const double *position,
                               const double *director, int element, int along,
                               struct wb_swept_tape_stress out[WB_SWEPT_TAPE_STRESS_MOST])
{
    const struct wb_swept_tape_kernel_model *m = &tape->numbers;
    struct symmetric E, K;

    find_strains(tape, position, director, element, along, &E, &K);
    for (int q = 0; q < m->n_points; q++) {
        const double z = m->z[q];
        const struct symmetric here = {E.mean + z * K.mean, E.difference + z * K.difference,
                                       E.both + z * K.both};
        const struct symmetric all = logarithm(&here);
        const double mean = m->sum_modulus * (all.mean - kept(state, element, along, q, 0));
        const double difference =
            m->difference_modulus * (all.difference - kept(state, element, along, q, 1));
        out[q].stress[0] = mean + difference;
        out[q].stress[1] = mean - difference;
        out[q].stress[2] = m->difference_modulus * (all.both - kept(state, element, along, q, 2));
        out[q].plastic = kept(state, element, along, q, 3);
    }
}

double wb_swept_tape_stress_von_mises(const double s[3])
{
    return sqrt(s[0] * s[0] + s[1] * s[1] - s[0] * s[1] + 3.0 * s[2] * s[2]);
}
