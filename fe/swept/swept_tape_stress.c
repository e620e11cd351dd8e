#include "fe/swept/swept_tape_stress.h"

#include <math.h>
#include <stddef.h>

#include "base/vec3.h"
#include "fe/swept/swept_tape_private.h"

enum {
    LANES = WB_SWEPT_LANES
};

_Static_assert((int)WB_SWEPT_TAPE_STRESS_MOST == (int)WB_SWEPT_TAPE_MOST_POINTS,
               "room for the points");

/* A symmetric matrix in the plane: (11 + 22) / 2, (11 - 22) / 2, 12. */
struct symmetric {
    double mean, difference, both;
};

int wb_swept_tape_stress_points(const struct wb_swept_tape *tape)
{
    return tape->numbers.n_points;
}

/* A number of the kernel's type. */
static double get(const struct wb_swept_tape *tape, const void *from, size_t at)
{
    return tape->model.double_precision ? ((const double *)from)[at]
                                        : (double)((const float *)from)[at];
}

static double constant(const struct wb_swept_tape *tape, int element, int along, int which)
{
    const size_t place =
        (size_t)(along / LANES) * (size_t)tape->numbers.n_elements + (size_t)element;

    return get(tape, tape->reference,
               (place * WB_SWEPT_TAPE_REFERENCE + (size_t)which) * LANES + (size_t)(along % LANES));
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

/* 1/2 a_i.b_j, symmetric, less `reference` of it. */
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

/* f(E), f(e) = e - e^2 + 4/3 e^3 - 2 e^4, by its eigenvalues. */
static struct symmetric logarithm(const struct symmetric *E)
{
    const double r = hypot(E->difference, E->both), e[2] = {E->mean + r, E->mean - r};
    double f[2];

    for (int i = 0; i < 2; i++)
        f[i] = e[i] * (1.0 - e[i] * (1.0 - e[i] * (4.0 / 3.0 - 2.0 * e[i])));
    const double turn = r > 0.0 ? 0.5 * (f[0] - f[1]) / r : 0.0;
    return (struct symmetric){0.5 * (f[0] + f[1]), turn * E->difference, turn * E->both};
}

void wb_swept_tape_stress_find(const struct wb_swept_tape *tape, struct wb_swept_tape_state *state,
                               const double *position, const double *director, int element,
                               int along,
                               struct wb_swept_tape_stress out[WB_SWEPT_TAPE_STRESS_MOST])
{
    const struct wb_swept_tape_kernel_model *m = &tape->numbers;
    const size_t place = (size_t)(along / LANES) * (size_t)m->n_elements + (size_t)element;
    size_t bytes;
    const void *history = wb_swept_tape_state_data(state, &bytes);
    struct symmetric E, K;

    find_strains(tape, position, director, element, along, &E, &K);
    for (int q = 0; q < m->n_points; q++) {
        const size_t at =
            (place * (size_t)m->n_points + (size_t)q) * WB_SWEPT_TAPE_HISTORY * LANES +
            (size_t)(along % LANES);
        const double z = m->z[q];
        const struct symmetric here = {E.mean + z * K.mean, E.difference + z * K.difference,
                                       E.both + z * K.both};
        const struct symmetric all = logarithm(&here);
        const double mean = m->sum_modulus * (all.mean - get(tape, history, at));
        const double difference =
            m->difference_modulus * (all.difference - get(tape, history, at + LANES));
        out[q].stress[0] = mean + difference;
        out[q].stress[1] = mean - difference;
        out[q].stress[2] = m->difference_modulus * (all.both - get(tape, history, at + 2 * LANES));
        out[q].plastic = get(tape, history, at + 3 * LANES);
    }
}

double wb_swept_tape_stress_von_mises(const double s[3])
{
    return sqrt(s[0] * s[0] + s[1] * s[1] - s[0] * s[1] + 3.0 * s[2] * s[2]);
}
