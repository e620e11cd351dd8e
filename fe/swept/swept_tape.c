#include "fe/swept/swept_tape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vec3.h"
#include "fe/swept/swept_hardening.h"
#include "fe/swept/swept_tape_private.h"

#define WB_LOG_DOMAIN "swept"

enum {
    LANES = WB_SWEPT_LANES,
    MOST_NODES = 1 << 16
};

static const double default_hourglass = 0.1;
static const double shear_correction = 5.0 / 6.0;

static const struct wb_swept_tape_kernel *const kernels[][2] =
    WB_SWEPT_KERNEL_VERSIONS(wb_swept_tape_kernel);

struct wb_swept_tape_state {
    const struct wb_swept_tape *tape;
    void *history, *carry;
    size_t history_size; /* numbers */
};

/* Gauss points from -1 to 1 and weights whose sum is 1, of 2 to 5 points. */
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

static double shear_modulus(const struct wb_material *m)
{
    return m->youngs_modulus / (2.0 * (1.0 + m->poissons_ratio));
}

static size_t real_size(const struct wb_swept_tape *tape)
{
    return tape->model.double_precision ? sizeof(double) : sizeof(float);
}

/* Numbers in the kernel's type. */
static void put(const struct wb_swept_tape *tape, void *numbers, size_t at, double value)
{
    if (tape->model.double_precision)
        ((double *)numbers)[at] = value;
    else
        ((float *)numbers)[at] = (float)value;
}

static double get(const struct wb_swept_tape *tape, const void *numbers, size_t at)
{
    return tape->model.double_precision ? ((const double *)numbers)[at]
                                        : (double)((const float *)numbers)[at];
}

/* --- the reference state --- */

static bool is_convex(const struct wb_swept_tape_element *e)
{
    static const int next[4] = {1, 3, 0, 2}; /* round the element */
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

bool wb_swept_tape_element_of(const struct wb_swept_tape *tape, int k, int j,
                              struct wb_swept_tape_element *element)
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
    if (!(element->area > 0.0 && isfinite(element->area) && length > 0.0))
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

double wb_swept_tape_gyration(const struct wb_swept_tape *tape,
                              const struct wb_swept_tape_element *element)
{
    const double thickness = tape->model.thickness / tape->model.sheets;
    return element->area / 8.0 + thickness * thickness / 6.0;
}

/* Walks over all elements; `use` gets each with its place. */
static enum wb_status for_elements(struct wb_swept_tape *tape,
                                   void (*use)(struct wb_swept_tape *tape, int k, int j,
                                               const struct wb_swept_tape_element *element))
{
    for (int k = 0; k < tape->numbers.n_elements; k++) {
        for (int j = 0; j < tape->numbers.n_along; j++) {
            struct wb_swept_tape_element element;
            if (!wb_swept_tape_element_of(tape, k, j, &element))
                return wb_fail(WB_ERR_ARGUMENT,
                               "the tape's element at node %d, station %d is not convex", k, j);
            use(tape, k, j, &element);
        }
    }
    return WB_OK;
}

/* Adds what an element gives to its nodes. */
static void lump(struct wb_swept_tape *tape, int k, int j,
                 const struct wb_swept_tape_element *element)
{
    const struct wb_swept_tape_model *m = &tape->model;
    const size_t stride = (size_t)m->layout.stride;
    const double share = 0.25 * element->area;
    const double mass = m->density * m->thickness * share;
    const double length = m->spacing * (m->layout.n_stations - 1);
    const double stiffness = shear_correction * shear_modulus(&m->material) * m->thickness * share;

    for (int a = 0; a < 4; a++) {
        const int node = (k + a / 2) % m->layout.n_nodes;
        const size_t at = (size_t)node * stride + (size_t)(j + a % 2);
        for (int i = 0; i < 3; i++)
            tape->director[(size_t)(3 * node + i) * stride + (size_t)(j + a % 2)] +=
                element->normal[i];
        tape->area[at] += share;
        tape->mass[node] += mass / length;
        tape->inertia[node] += mass / length * wb_swept_tape_gyration(tape, element);
        put(tape, tape->length_stiffness, at, get(tape, tape->length_stiffness, at) + stiffness);
    }
}

static void fill_reference(struct wb_swept_tape *tape, int k, int j,
                           const struct wb_swept_tape_element *element)
{
    const size_t place = (size_t)(j / LANES) * (size_t)tape->numbers.n_elements + (size_t)k;
    const size_t at = place * WB_SWEPT_TAPE_REFERENCE * LANES + (size_t)(j % LANES);

    for (int i = 0; i < 3; i++)
        put(tape, tape->reference, at + (size_t)(WB_SWEPT_TAPE_B11 + i) * LANES, element->B[i]);
    for (int i = 0; i < 2; i++)
        put(tape, tape->reference, at + (size_t)(WB_SWEPT_TAPE_C1 + i) * LANES,
            element->hourglass[i]);
    put(tape, tape->reference, at + (size_t)WB_SWEPT_TAPE_VOLUME * LANES,
        element->area * tape->model.thickness);
}

/* Directors lie in the plane of their section: so that what they face does
 * (fe/swept/swept_cohesion.h).
 */
static enum wb_status normalise_directors(struct wb_swept_tape *tape)
{
    const struct wb_swept_layout *layout = &tape->model.layout;
    const size_t stride = (size_t)layout->stride;

    for (int k = 0; k < layout->n_nodes; k++) {
        for (int j = 0; j < layout->n_stations; j++) {
            double *d = tape->director + 3 * (size_t)k * stride + (size_t)j;
            const double length = hypot(d[stride], d[2 * stride]);
            if (!(length > 0.1))
                return wb_fail(WB_ERR_ARGUMENT,
                               "the tape is folded, or not along the axis, at node %d, station %d",
                               k, j);
            d[0] = 0.0;
            d[stride] /= length;
            d[2 * stride] /= length;
        }
    }
    return WB_OK;
}

/* Geometry, masses, and the measures of the reference state as the kernel finds them, so that it
 * has no strain at all there. */
static enum wb_status make_reference(struct wb_swept_tape *tape)
{
    WB_TRY(for_elements(tape, lump));
    WB_TRY(normalise_directors(tape));
    WB_TRY(for_elements(tape, fill_reference));
    const struct wb_swept_tape_kernel_call call = {
        .model = &tape->numbers, .position = tape->position, .director = tape->director};
    tape->kernel->measure(&call);
    return WB_OK;
}

/* --- creation --- */

static enum wb_status check_material(const struct wb_material *m)
{
    const bool power = m->hardening == WB_HARDENING_ISOTROPIC_POWER;

    if (!power && m->hardening != WB_HARDENING_NONE_ELASTIC)
        return wb_fail(WB_ERR_UNSUPPORTED, "the tape does not harden kinematically");
    if (!(m->youngs_modulus > 0.0 && isfinite(m->youngs_modulus)) ||
        !(m->poissons_ratio > -1.0 && m->poissons_ratio <= 0.5))
        return wb_fail(WB_ERR_ARGUMENT, "tape: E = %g Pa, nu = %g", m->youngs_modulus,
                       m->poissons_ratio);
    if (power && !(m->yield_stress > 0.0 && isfinite(m->yield_stress) &&
                   m->strength_coefficient >= 0.0 && isfinite(m->strength_coefficient) &&
                   m->hardening_exponent > 0.0 && m->hardening_exponent <= 2.0))
        return wb_fail(WB_ERR_ARGUMENT, "tape: sigma_Y = %g Pa, K = %g Pa, n = %g", m->yield_stress,
                       m->strength_coefficient, m->hardening_exponent);
    return WB_OK;
}

static enum wb_status check(const struct wb_swept_tape_model *m)
{
    const struct wb_swept_layout *layout = &m->layout;

    WB_TRY(check_material(&m->material));
    if (layout->n_nodes < (m->closed ? 3 : 2) || layout->n_nodes > MOST_NODES ||
        layout->n_stations < 2 ||
        layout->stride != wb_swept_layout(layout->n_nodes, layout->n_stations).stride)
        return wb_fail(WB_ERR_ARGUMENT, "a tape of %d nodes and %d stations", layout->n_nodes,
                       layout->n_stations);
    if (!(m->density > 0.0 && isfinite(m->density)) ||
        !(m->thickness > 0.0 && isfinite(m->thickness)) ||
        !(m->spacing > 0.0 && isfinite(m->spacing)))
        return wb_fail(WB_ERR_ARGUMENT,
                       "tape: density %g kg/m3, thickness %g m, stations %g m apart", m->density,
                       m->thickness, m->spacing);
    if (m->sheets < 1 || m->points < 2 || m->points > WB_SWEPT_TAPE_MOST_POINTS)
        return wb_fail(WB_ERR_ARGUMENT, "a tape of %d sheets, %d points through the thickness",
                       m->sheets, m->points);
    if (!(m->hourglass > 0.0 && m->hourglass <= 1.0))
        return wb_fail(WB_ERR_ARGUMENT, "hourglass coefficient %g, not in (0, 1]", m->hourglass);
    return WB_OK;
}

static void set_numbers(struct wb_swept_tape *tape)
{
    const struct wb_swept_tape_model *m = &tape->model;
    const double E = m->material.youngs_modulus, nu = m->material.poissons_ratio;
    const double mu = shear_modulus(&m->material), bent = m->thickness / m->sheets;
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
        .yield_strain = m->material.hardening == WB_HARDENING_NONE_ELASTIC
                            ? (double)INFINITY
                            : m->material.yield_stress / (3.0 * mu),
        .exponent = m->material.hardening_exponent,
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

static enum wb_status allocate(struct wb_swept_tape *tape)
{
    const struct wb_swept_layout *layout = &tape->model.layout;
    const size_t nodes = (size_t)layout->n_nodes, stride = (size_t)layout->stride;
    const size_t size = real_size(tape);
    const size_t elements = (size_t)tape->numbers.n_elements * stride;
    void *fields[3] = {NULL};

    enum wb_status status =
        wb_swept_allocate(&tape->reference, elements * WB_SWEPT_TAPE_REFERENCE, size);
    if (status == WB_OK)
        status = wb_swept_allocate(&tape->table,
                                   WB_SWEPT_HARDENING_TERMS * WB_SWEPT_HARDENING_OCTAVES, size);
    if (status == WB_OK)
        status = wb_swept_allocate(&tape->length_stiffness, nodes * stride, size);
    for (int i = 0; i < 2 && status == WB_OK; i++)
        status = wb_swept_allocate(&fields[i], wb_swept_size(layout), sizeof(double));
    if (status == WB_OK)
        status = wb_swept_allocate(&fields[2], nodes * (stride + 2), sizeof(double));
    tape->position = fields[0];
    tape->director = fields[1];
    tape->area = fields[2];
    WB_TRY(status);
    tape->mass = tape->area + nodes * stride;
    tape->inertia = tape->mass + nodes;
    tape->numbers.reference = tape->reference;
    tape->numbers.table = tape->table;
    tape->numbers.length_stiffness = tape->length_stiffness;
    return WB_OK;
}

static enum wb_status fill(struct wb_swept_tape *tape)
{
    const struct wb_swept_tape_model *m = &tape->model;
    double table[WB_SWEPT_HARDENING_TERMS][WB_SWEPT_HARDENING_OCTAVES];

    WB_TRY(check(m));
    WB_TRY(wb_swept_choose_instructions(&tape->model.instructions, m->instructions));
    tape->kernel = kernels[m->instructions][m->double_precision];
    set_numbers(tape);
    WB_TRY(allocate(tape));
    WB_TRY(wb_swept_hardening_tabulate(&m->material, table));
    for (size_t i = 0; i < WB_SWEPT_HARDENING_TERMS * WB_SWEPT_HARDENING_OCTAVES; i++)
        put(tape, tape->table, i, (&table[0][0])[i]);
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
    struct wb_swept_tape *tape = calloc(1, sizeof *tape);
    if (!tape)
        return wb_fail(WB_ERR_MEMORY, "no memory for a tape");
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
    free(tape->reference);
    free(tape->table);
    free(tape->length_stiffness);
    free(tape->position);
    free(tape->director);
    free(tape->area);
    free(tape);
}

struct wb_swept_layout wb_swept_tape_layout(const struct wb_swept_tape *tape)
{
    return tape->model.layout;
}

int wb_swept_tape_blocks(const struct wb_swept_tape *tape)
{
    return tape->model.layout.stride / LANES;
}

int wb_swept_tape_elements(const struct wb_swept_tape *tape)
{
    return tape->numbers.n_elements;
}

const char *wb_swept_tape_instructions(const struct wb_swept_tape *tape)
{
    return wb_swept_instructions_name(tape->model.instructions);
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

enum wb_status wb_swept_tape_state_create(struct wb_swept_tape_state **out,
                                          const struct wb_swept_tape *tape)
{
    const struct wb_swept_layout *layout = &tape->model.layout;

    *out = NULL;
    struct wb_swept_tape_state *state = calloc(1, sizeof *state);
    if (!state)
        return wb_fail(WB_ERR_MEMORY, "no memory for a tape");
    state->tape = tape;
    state->history_size = (size_t)tape->numbers.n_elements * (size_t)layout->stride *
                          (size_t)tape->numbers.n_points * WB_SWEPT_TAPE_HISTORY;
    enum wb_status status =
        wb_swept_allocate(&state->history, state->history_size, real_size(tape));
    if (status == WB_OK)
        status = wb_swept_allocate(
            &state->carry, (size_t)layout->n_nodes * WB_SWEPT_TAPE_CARRY * LANES, real_size(tape));
    if (status != WB_OK) {
        wb_swept_tape_state_destroy(state);
        return status;
    }
    *out = state;
    return WB_OK;
}

void wb_swept_tape_state_destroy(struct wb_swept_tape_state *state)
{
    if (!state)
        return;
    free(state->history);
    free(state->carry);
    free(state);
}

void wb_swept_tape_state_reset(struct wb_swept_tape_state *state)
{
    memset(state->history, 0, state->history_size * real_size(state->tape));
}

void *wb_swept_tape_state_data(struct wb_swept_tape_state *state, size_t *bytes)
{
    *bytes = state->history_size * real_size(state->tape);
    return state->history;
}

void wb_swept_tape_forces(struct wb_swept_tape_state *state,
                          const struct wb_swept_tape_fields *fields, int first, int end,
                          struct wb_swept_tape_sums *sums)
{
    const struct wb_swept_tape *tape = state->tape;
    const struct wb_swept_tape_kernel_call call = {
        .model = &tape->numbers,
        .position = fields->position,
        .director = fields->director,
        .force = fields->force,
        .moment = fields->moment,
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
    const struct wb_swept_tape_kernel_model *m = &state->tape->numbers;
    const size_t place =
        ((size_t)(along / LANES) * (size_t)m->n_elements + (size_t)element) * (size_t)m->n_points +
        (size_t)point;

    return get(state->tape, state->history,
               (place * WB_SWEPT_TAPE_HISTORY + 3) * LANES + (size_t)(along % LANES));
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
            const size_t place = (size_t)(j / LANES) * (size_t)m->n_elements + (size_t)k;
            const size_t at = (place * WB_SWEPT_TAPE_REFERENCE + WB_SWEPT_TAPE_VOLUME) * LANES +
                              (size_t)(j % LANES);
            double density = 0.0;
            for (int q = 0; q < m->n_points; q++) {
                const double p = wb_swept_tape_plastic_strain(state, k, j, q);
                if (p > 0.0)
                    density += m->weight[q] * p *
                               (law->yield_stress + law->strength_coefficient *
                                                        pow(p, law->hardening_exponent) /
                                                        (law->hardening_exponent + 1.0));
            }
            work += density * get(tape, tape->reference, at);
        }
    }
    return work;
}
