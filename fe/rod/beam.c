#include "fe/rod/beam.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fe/linear/banded.h"
#include "fe/linear/larger.h"
#include "fe/rod/beam_private.h"
#include "fe/rod/fibres.h"

#define WB_LOG_DOMAIN "beam"

enum {
    MAX_ELEMENTS = 100000,
    POINTS = WB_BEAM_ELEMENT_POINTS
};

/* Elimination of an element's middle node from its end nodes: d2 = -w - W1 d1 - W3 d3, with w =
 * inverse times the residual of the middle node. */
struct middle {
    double inverse[9], W1[9], W3[9];
};

/* Strains of a Gauss point. They are unknowns in addition to the positions, which follow from them.
 * Strains taken from differences of positions would carry round-off of epsilon L over an element's
 * length, and the axial stiffness would turn that into forces. */
struct strain {
    double eps, gamma;
};

/* The shape of the beam. */
struct state {
    struct wb_beam_node *nodes; /* (n_nodes) */
    struct strain *strains;     /* (n_elements x POINTS) */
};

struct resultants {
    double N, Q, M, k; /* N, N, N m; t', 1/m */
};

struct wb_beam {
    int n_elements, n_nodes;
    double length, element_length;
    struct wb_rod_shape shape;
    struct wb_fibres *fibres;
    size_t history_size; /* of all Gauss points */
    double load_x, load_y;

    struct wb_beam_node *reference; /* (n_nodes) positions without stress */
    /* `earlier` was committed before `committed`. */
    struct state trial, committed, earlier, saved, saved_earlier;
    double *history, *trial_history, *saved_history;
    /* Resultants of the committed state, for the work of a step. */
    struct resultants *committed_resultants, *saved_resultants; /* (n_elements x POINTS) each */

    struct wb_beam_point *points; /* (n_elements x POINTS) */
    bool has_turns;         /* the points' cosines and sines are up to date with the trial state */
    double (*residual)[3];  /* (n_nodes) */
    struct middle *middles; /* (n_elements) */
    double (*right_middles)[3]; /* (n_elements): w of struct middle */
    struct wb_banded banded;    /* stiffness of the elements' end nodes, without the clamp */
    struct wb_memory memory;    /* owns all arrays */
};

/* Integrates the natural curvature from the clamp into rotations and positions of the nodes, with
 * Simpson's rule on several intervals between neighbouring nodes. */
static void set_reference_shape(struct wb_beam *beam, double (*natural_curvature)(void *, double),
                                void *context)
{
    enum {
        INTERVALS = 8
    };
    const double step = beam->element_length / (2 * INTERVALS);
    struct wb_beam_node at = {0.0, 0.0, 0.0};

    beam->reference[0] = at;
    for (int i = 1; i < beam->n_nodes; i++) {
        if (!natural_curvature) {
            beam->reference[i] = (struct wb_beam_node){0.5 * beam->element_length * i, 0.0, 0.0};
            continue;
        }
        for (int j = 0; j < INTERVALS; j++) {
            const double s = 0.5 * beam->element_length * (i - 1) + j * step;
            const double k0 = natural_curvature(context, s);
            const double k1 = natural_curvature(context, s + 0.5 * step);
            const double k2 = natural_curvature(context, s + step);
            /* The rotation at half the step from the parabola through the three curvatures. */
            const double t1 = at.t + step * (5.0 * k0 + 8.0 * k1 - k2) / 24.0;
            const double t2 = at.t + step * (k0 + 4.0 * k1 + k2) / 6.0;
            at.x += step * (cos(at.t) + 4.0 * cos(t1) + cos(t2)) / 6.0;
            at.y += step * (sin(at.t) + 4.0 * sin(t1) + sin(t2)) / 6.0;
            at.t = t2;
        }
        beam->reference[i] = at;
    }
}

/* Stores the strains of the reference configuration, computed by the element's own formulas:
 * subtracting them makes the reference exactly free of stress. */
static void measure_reference(struct wb_beam *beam)
{
    for (int e = 0; e < beam->n_elements; e++) {
        for (int g = 0; g < POINTS; g++) {
            struct wb_beam_point *p = &beam->points[e * POINTS + g];
            wb_beam_element_kinematics(&beam->shape, g, beam->reference + 2 * e, p);
            p->reference_a = p->a;
            p->reference_b = p->b;
            p->reference_k = p->k;
        }
    }
}

/* The section's shear stiffness at the points. */
static void take_shear_stiffness(struct wb_beam *beam)
{
    for (int g = 0; g < beam->n_elements * POINTS; g++)
        beam->points[g].G = wb_fibres_shear_stiffness(beam->fibres);
}

static enum wb_status check_model(const struct wb_beam_model *model)
{
    if (!(isfinite(model->length) && model->length > 0.0))
        return wb_fail(WB_ERR_ARGUMENT, "length %g m: expected a number above 0", model->length);
    if (model->n_elements < 1 || model->n_elements > MAX_ELEMENTS)
        return wb_fail(WB_ERR_ARGUMENT, "%d elements: expected 1 to %d", model->n_elements,
                       MAX_ELEMENTS);
    if (!(model->section->shear_stiffness > 0.0))
        return wb_fail(WB_ERR_ARGUMENT, "shear stiffness %g N: expected a number above 0",
                       model->section->shear_stiffness);
    if (!(isfinite(model->load_x) && isfinite(model->load_y)))
        return wb_fail(WB_ERR_ARGUMENT, "load (%g, %g) N/m is not finite", model->load_x,
                       model->load_y);
    return WB_OK;
}

static void take_memory(struct wb_beam *beam)
{
    const size_t nodes = (size_t)beam->n_nodes, elements = (size_t)beam->n_elements;
    const size_t points = elements * POINTS;
    struct state *const states[] = {&beam->trial, &beam->committed, &beam->earlier, &beam->saved,
                                    &beam->saved_earlier};
    double **const histories[] = {&beam->history, &beam->trial_history, &beam->saved_history};

    for (size_t i = 0; i < sizeof states / sizeof states[0]; i++) {
        states[i]->nodes = wb_memory_take(&beam->memory, nodes, sizeof *beam->reference);
        states[i]->strains = wb_memory_take(&beam->memory, points, sizeof(struct strain));
    }
    for (size_t i = 0; i < sizeof histories / sizeof histories[0]; i++)
        *histories[i] = wb_memory_take(&beam->memory, beam->history_size, sizeof(double));
    beam->reference = wb_memory_take(&beam->memory, nodes, sizeof *beam->reference);
    beam->committed_resultants =
        wb_memory_take(&beam->memory, points, sizeof *beam->committed_resultants);
    beam->saved_resultants = wb_memory_take(&beam->memory, points, sizeof *beam->saved_resultants);
    beam->points = wb_memory_take(&beam->memory, points, sizeof *beam->points);
    beam->residual = wb_memory_take(&beam->memory, nodes, sizeof *beam->residual);
    beam->middles = wb_memory_take(&beam->memory, elements, sizeof *beam->middles);
    beam->right_middles = wb_memory_take(&beam->memory, elements, sizeof *beam->right_middles);
    beam->banded.n = beam->n_elements;
    beam->banded.diagonal = wb_memory_take(&beam->memory, elements, sizeof *beam->banded.diagonal);
    beam->banded.upper = wb_memory_take(&beam->memory, elements, sizeof *beam->banded.upper);
    beam->banded.right = wb_memory_take(&beam->memory, elements, sizeof *beam->banded.right);
}

enum wb_status wb_beam_create(struct wb_beam **out, const struct wb_beam_model *model)
{
    *out = NULL;
    WB_TRY(check_model(model));

    struct wb_fibres *fibres;
    WB_TRY(wb_fibres_create(&fibres, model->section));
    struct wb_beam *const beam = wb_memory_new(1, sizeof *beam);
    beam->fibres = fibres;
    beam->n_elements = model->n_elements;
    beam->n_nodes = 2 * model->n_elements + 1;
    beam->length = model->length;
    beam->element_length = model->length / model->n_elements;
    beam->load_x = model->load_x;
    beam->load_y = model->load_y;
    beam->history_size = wb_fibres_history_size(beam->fibres) * (size_t)(beam->n_elements * POINTS);
    take_memory(beam);
    wb_rod_shape_init(&beam->shape, beam->element_length);
    const enum wb_status bent =
        wb_beam_set_curvature(beam, model->natural_curvature, model->curvature_context);
    if (bent != WB_OK) {
        wb_beam_destroy(beam);
        return bent;
    }
    *out = beam;
    return WB_OK;
}

void wb_beam_destroy(struct wb_beam *beam)
{
    if (!beam)
        return;
    wb_fibres_destroy(beam->fibres);
    wb_memory_release(&beam->memory);
    free(beam);
}

enum wb_status wb_beam_set_curvature(struct wb_beam *beam,
                                     double (*natural_curvature)(void *, double), void *context)
{
    set_reference_shape(beam, natural_curvature, context);
    measure_reference(beam);
    take_shear_stiffness(beam);
    wb_beam_reset(beam);
    if (!isfinite(beam->reference[beam->n_nodes - 1].x))
        return wb_fail(WB_ERR_ARGUMENT, "the natural curvature is not finite everywhere");
    return WB_OK;
}

static void copy_state(const struct wb_beam *beam, const struct state *to, const struct state *from)
{
    memcpy(to->nodes, from->nodes, (size_t)beam->n_nodes * sizeof *to->nodes);
    memcpy(to->strains, from->strains, (size_t)(beam->n_elements * POINTS) * sizeof *to->strains);
}

void wb_beam_reset(struct wb_beam *beam)
{
    const size_t points = (size_t)(beam->n_elements * POINTS);
    memset(beam->trial.strains, 0, points * sizeof *beam->trial.strains);
    memcpy(beam->trial.nodes, beam->reference, (size_t)beam->n_nodes * sizeof *beam->reference);
    beam->has_turns = false;
    copy_state(beam, &beam->committed, &beam->trial);
    copy_state(beam, &beam->earlier, &beam->trial);
    memset(beam->history, 0, beam->history_size * sizeof *beam->history);
    for (size_t i = 0; i < points; i++)
        beam->committed_resultants[i] = (struct resultants){.k = beam->points[i].reference_k};
}

void wb_beam_set_materials(struct wb_beam *beam, const struct wb_material *materials)
{
    wb_fibres_set_materials(beam->fibres, materials);
    take_shear_stiffness(beam);
}

enum wb_status wb_beam_set_law(struct wb_beam *beam, const struct wb_law *law)
{
    WB_TRY(wb_law_check(law, NULL));
    WB_TRY(wb_fibres_set_law(beam->fibres, law));
    take_shear_stiffness(beam);
    return WB_OK;
}

void wb_beam_set_duration(struct wb_beam *beam, double duration)
{
    wb_fibres_set_duration(beam->fibres, duration);
}

static void subtract_load(struct wb_beam *beam, double factor)
{
    /* Consistent with quadratic shape functions: 1/6, 4/6, 1/6 of an element's load. */
    const double share = factor * beam->element_length / 6.0;
    const double x = share * beam->load_x, y = share * beam->load_y;
    if (x == 0.0 && y == 0.0)
        return;

    for (int e = 0; e < beam->n_elements; e++) {
        static const double parts[WB_BEAM_ELEMENT_NODES] = {1.0, 4.0, 1.0};
        for (int i = 0; i < WB_BEAM_ELEMENT_NODES; i++) {
            beam->residual[2 * e + i][0] -= parts[i] * x;
            beam->residual[2 * e + i][1] -= parts[i] * y;
        }
    }
}

static double size_of(const double *force, double lever)
{
    return wb_larger(wb_larger(fabs(force[0]), fabs(force[1])), fabs(force[2]) * lever);
}

void wb_beam_evaluate(struct wb_beam *beam, double load_factor, struct wb_beam_balance *balance)
{
    const double lever = 1.0 / beam->length;
    const size_t row = wb_fibres_history_size(beam->fibres);
    double largest = 0.0;

    memset(beam->residual, 0, (size_t)beam->n_nodes * sizeof *beam->residual);
    for (int e = 0; e < beam->n_elements; e++) {
        double f[3 * WB_BEAM_ELEMENT_NODES] = {0};
        for (int g = 0; g < POINTS; g++) {
            const int at = e * POINTS + g;
            struct wb_beam_point *p = &beam->points[at];
            struct wb_fibres_response r;

            if (!beam->has_turns)
                wb_beam_element_turn(&beam->shape, g, beam->trial.nodes + 2 * e, p);
            p->k = wb_beam_element_curvature(&beam->shape, g, beam->trial.nodes + 2 * e);
            p->a = p->reference_a + beam->trial.strains[at].eps;
            p->b = p->reference_b + beam->trial.strains[at].gamma;
            wb_fibres_respond(beam->fibres, beam->trial.strains[at].eps, p->k - p->reference_k,
                              beam->history + (size_t)at * row,
                              beam->trial_history + (size_t)at * row, &r);
            p->N = r.N;
            p->M = r.M;
            p->Q = p->G * beam->trial.strains[at].gamma;
            p->D11 = r.D11;
            p->D12 = r.D12;
            p->D22 = r.D22;
            wb_beam_element_add_forces(&beam->shape, g, p, f);
        }
        for (int i = 0; i < WB_BEAM_ELEMENT_NODES; i++) {
            largest = wb_larger(largest, size_of(f + 3 * i, lever));
            for (int k = 0; k < 3; k++)
                beam->residual[2 * e + i][k] += f[3 * i + k];
        }
    }
    beam->has_turns = true;
    subtract_load(beam, load_factor);

    balance->largest_force = largest;
    balance->largest_residual = 0.0;
    for (int i = 1; i < beam->n_nodes - 1; i++)
        balance->largest_residual =
            wb_larger(balance->largest_residual, size_of(beam->residual[i], lever));
    memcpy(balance->tip, beam->residual[beam->n_nodes - 1], sizeof balance->tip);
}

/* C += sign * A^T B for 3 x 3 blocks. */
static inline void add_transposed_product(double *restrict C, double sign, const double *A,
                                          const double *B)
{
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++)
            C[3 * r + c] += sign * (A[r] * B[c] + A[3 + r] * B[3 + c] + A[6 + r] * B[6 + c]);
    }
}

static inline void add_transposed_vector(double *restrict v, const double *A, const double *b)
{
    for (int r = 0; r < 3; r++)
        v[r] += A[r] * b[0] + A[3 + r] * b[1] + A[6 + r] * b[2];
}

/* Eliminates an element's middle node and adds the condensed stiffness to the chain of end
 * nodes. */
static void condense_element(struct wb_beam *beam, int e)
{
    struct wb_beam_element_stiffness K;
    struct middle *m = &beam->middles[e];
    double K21[9];

    wb_beam_element_stiffness(&beam->shape, &beam->points[e * POINTS], &K);
    wb_banded_invert(K.K22, m->inverse);
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++)
            K21[3 * r + c] = K.K12[3 * c + r];
    }
    /* The inverse is symmetric, so its transposed products are its products. */
    memset(m->W1, 0, sizeof m->W1);
    memset(m->W3, 0, sizeof m->W3);
    add_transposed_product(m->W1, 1.0, m->inverse, K21);
    add_transposed_product(m->W3, 1.0, m->inverse, K.K23);

    if (e > 0) {
        add_transposed_product(K.K11, -1.0, K21, m->W1);
        add_transposed_product(K.K13, -1.0, K21, m->W3);
        double *diagonal = beam->banded.diagonal[e - 1];
        double *upper = beam->banded.upper[e - 1];
        for (int k = 0; k < 9; k++) {
            diagonal[k] += K.K11[k];
            upper[k] = K.K13[k];
        }
    }
    add_transposed_product(K.K33, -1.0, K.K23, m->W3);
    memcpy(beam->banded.diagonal[e], K.K33, sizeof K.K33);
}

/* Condenses the residual of an element with a tangent that is already condensed. */
static void reduce_element(struct wb_beam *beam, const struct wb_beam *tangent, int e)
{
    const struct middle *m = &tangent->middles[e];
    const double *at_middle = beam->residual[2 * e + 1];

    memset(beam->right_middles[e], 0, sizeof beam->right_middles[e]);
    add_transposed_vector(beam->right_middles[e], m->inverse, at_middle);
    if (e > 0)
        add_transposed_vector(beam->banded.right[e - 1], m->W1, at_middle);
    for (int k = 0; k < 3; k++)
        beam->banded.right[e][k] = -beam->residual[2 * e + 2][k];
    add_transposed_vector(beam->banded.right[e], m->W3, at_middle);
}

/* The condensed tangent of `tangent` with the right-hand side of `beam`. */
static struct wb_banded chain_with_right_side(const struct wb_beam *beam,
                                              const struct wb_beam *tangent)
{
    struct wb_banded chain = tangent->banded;
    chain.right = beam->banded.right;
    return chain;
}

void wb_beam_condense(struct wb_beam *beam, double *stiffness)
{
    for (int e = 0; e < beam->n_elements; e++)
        condense_element(beam, e);
    wb_banded_factor(&beam->banded);
    memcpy(stiffness, beam->banded.diagonal[beam->n_elements - 1], 9 * sizeof *stiffness);
}

void wb_beam_reduce(struct wb_beam *beam, const struct wb_beam *tangent, double *right)
{
    const struct wb_banded chain = chain_with_right_side(beam, tangent);
    for (int e = 0; e < beam->n_elements; e++)
        reduce_element(beam, tangent, e);
    wb_banded_reduce(&chain);
    memcpy(right, chain.right[beam->n_elements - 1], 3 * sizeof *right);
}

static inline void add_product(double *restrict v, double sign, const double *A, const double *b)
{
    for (int r = 0; r < 3; r++)
        v[r] += sign * (A[3 * r] * b[0] + A[3 * r + 1] * b[1] + A[3 * r + 2] * b[2]);
}

/* Computes positions of an element's middle and last node from its first node, its rotations and
 * its strains: (x', y') = R(t) (a, b), and x' is linear within the element. Also updates the
 * cosines and sines of its points. */
static void place_nodes(struct wb_beam *beam, int e)
{
    const double h = beam->element_length;
    struct wb_beam_node *node = beam->trial.nodes + 2 * e;
    double x_[POINTS], y_[POINTS];

    for (int g = 0; g < POINTS; g++) {
        struct wb_beam_point *const p = &beam->points[e * POINTS + g];
        const struct strain *const strain = &beam->trial.strains[e * POINTS + g];
        wb_beam_element_turn(&beam->shape, g, node, p);
        const double a = p->reference_a + strain->eps, b = p->reference_b + strain->gamma;
        x_[g] = a * p->cosine - b * p->sine;
        y_[g] = a * p->sine + b * p->cosine;
    }
    const double mean_x = 0.5 * (x_[0] + x_[1]), mean_y = 0.5 * (y_[0] + y_[1]);
    const double slope_x = 0.5 * sqrt(3.0) * (x_[1] - x_[0]);
    const double slope_y = 0.5 * sqrt(3.0) * (y_[1] - y_[0]);
    node[1].x = node[0].x + 0.5 * h * (mean_x - 0.5 * slope_x);
    node[1].y = node[0].y + 0.5 * h * (mean_y - 0.5 * slope_y);
    node[2].x = node[0].x + h * mean_x;
    node[2].y = node[0].y + h * mean_y;
}

static void place_all(struct wb_beam *beam)
{
    for (int e = 0; e < beam->n_elements; e++)
        place_nodes(beam, e);
    beam->has_turns = true;
}

/* Moves an element whose first node has moved, by `scale` times the increments of its three nodes.
 * The increment changes rotations and strains; positions follow from them. Adding it to positions
 * would stretch a rotating element by half the square of its rotation, far beyond yield, and the
 * next tangent would be that of a wire failing in tension. */
static void advance_element(struct wb_beam *beam, int e, double scale,
                            const double *const increment[WB_BEAM_ELEMENT_NODES])
{
    const double *first = increment[0], *middle = increment[1], *last = increment[2];

    for (int g = 0; g < POINTS; g++) {
        const struct wb_beam_point *p = &beam->points[e * POINTS + g];
        struct strain *strain = &beam->trial.strains[e * POINTS + g];
        const double *N = beam->shape.N[g], *dN = beam->shape.dN[g];
        const double x_ = dN[0] * (first[0] - middle[0]) + dN[2] * (last[0] - middle[0]);
        const double y_ = dN[0] * (first[1] - middle[1]) + dN[2] * (last[1] - middle[1]);
        const double t = N[0] * first[2] + N[1] * middle[2] + N[2] * last[2];
        strain->eps += scale * (p->cosine * x_ + p->sine * y_ + p->b * t);
        strain->gamma += scale * (p->cosine * y_ - p->sine * x_ - p->a * t);
    }
    struct wb_beam_node *node = beam->trial.nodes + 2 * e;
    node[1].t += scale * middle[2];
    node[2].t += scale * last[2];
    place_nodes(beam, e);
}

double wb_beam_advance(struct wb_beam *beam, const struct wb_beam *tangent, const double *tip,
                       double most_rotation)
{
    static const double clamp[3] = {0.0, 0.0, 0.0};
    const struct wb_banded chain = chain_with_right_side(beam, tangent);
    double(*d)[3] = chain.right;

    memcpy(d[beam->n_elements - 1], tip, 3 * sizeof *tip);
    wb_banded_expand(&chain);

    double turn = 0.0;
    for (int e = 0; e < beam->n_elements; e++)
        turn = wb_larger(turn, fabs(d[e][2]));
    const double scale = turn > most_rotation ? most_rotation / turn : 1.0;

    for (int e = 0; e < beam->n_elements; e++) {
        const struct middle *m = &tangent->middles[e];
        const double *w = beam->right_middles[e];
        const double *first = e > 0 ? d[e - 1] : clamp;
        const double *last = d[e];
        double middle[3] = {-w[0], -w[1], -w[2]};
        add_product(middle, -1.0, m->W1, first);
        add_product(middle, -1.0, m->W3, last);
        advance_element(beam, e, scale, (const double *[]){first, middle, last});
    }
    return scale;
}

double wb_beam_advance_nodes(struct wb_beam *beam, const double (*increment)[3],
                             double most_rotation)
{
    double turn = 0.0;
    for (int i = 0; i < beam->n_nodes; i++)
        turn = wb_larger(turn, fabs(increment[i][2]));
    const double scale = turn > most_rotation ? most_rotation / turn : 1.0;

    beam->trial.nodes[0].x += scale * increment[0][0];
    beam->trial.nodes[0].y += scale * increment[0][1];
    beam->trial.nodes[0].t += scale * increment[0][2];
    for (int e = 0; e < beam->n_elements; e++) {
        const double(*d)[3] = increment + 2 * e;
        advance_element(beam, e, scale, (const double *[]){d[0], d[1], d[2]});
    }
    beam->has_turns = true;
    return scale;
}

void wb_beam_revert(struct wb_beam *beam)
{
    copy_state(beam, &beam->trial, &beam->committed);
    beam->has_turns = false;
}

void wb_beam_extrapolate(struct wb_beam *beam, double ratio)
{
    for (int i = 0; i < beam->n_elements * POINTS; i++) {
        const struct strain now = beam->committed.strains[i], was = beam->earlier.strains[i];
        beam->trial.strains[i].eps = now.eps + ratio * (now.eps - was.eps);
        beam->trial.strains[i].gamma = now.gamma + ratio * (now.gamma - was.gamma);
    }
    const struct wb_beam_node now = beam->committed.nodes[0], was = beam->earlier.nodes[0];
    beam->trial.nodes[0].x = now.x + ratio * (now.x - was.x);
    beam->trial.nodes[0].y = now.y + ratio * (now.y - was.y);
    for (int i = 0; i < beam->n_nodes; i++)
        beam->trial.nodes[i].t = beam->committed.nodes[i].t +
                                 ratio * (beam->committed.nodes[i].t - beam->earlier.nodes[i].t);
    place_all(beam);
}

void wb_beam_follow(struct wb_beam *beam, const struct wb_beam *leader, double ratio)
{
    for (int i = 0; i < beam->n_elements * POINTS; i++) {
        const struct strain now = beam->committed.strains[i], was = beam->earlier.strains[i];
        const struct strain then = leader->committed.strains[i],
                            before = leader->earlier.strains[i];
        const struct strain there = leader->trial.strains[i];
        beam->trial.strains[i].eps = now.eps + (there.eps - then.eps) +
                                     ratio * ((now.eps - was.eps) - (then.eps - before.eps));
        beam->trial.strains[i].gamma =
            now.gamma + (there.gamma - then.gamma) +
            ratio * ((now.gamma - was.gamma) - (then.gamma - before.gamma));
    }
    for (int i = 0; i < beam->n_nodes; i++) {
        const double now = beam->committed.nodes[i].t, was = beam->earlier.nodes[i].t;
        const double then = leader->committed.nodes[i].t, before = leader->earlier.nodes[i].t;
        beam->trial.nodes[i].t =
            now + (leader->trial.nodes[i].t - then) + ratio * ((now - was) - (then - before));
    }
    place_all(beam);
}

void wb_beam_commit(struct wb_beam *beam)
{
    const struct state oldest = beam->earlier;
    double *old = beam->history;

    beam->earlier = beam->committed;
    beam->committed = oldest;
    copy_state(beam, &beam->committed, &beam->trial);
    beam->history = beam->trial_history;
    beam->trial_history = old;
    for (int i = 0; i < beam->n_elements * POINTS; i++) {
        const struct wb_beam_point *p = &beam->points[i];
        beam->committed_resultants[i] = (struct resultants){p->N, p->Q, p->M, p->k};
    }
}

void wb_beam_save(struct wb_beam *beam)
{
    copy_state(beam, &beam->saved, &beam->committed);
    copy_state(beam, &beam->saved_earlier, &beam->earlier);
    memcpy(beam->saved_history, beam->history, beam->history_size * sizeof *beam->history);
    memcpy(beam->saved_resultants, beam->committed_resultants,
           (size_t)(beam->n_elements * POINTS) * sizeof *beam->saved_resultants);
}

void wb_beam_restore(struct wb_beam *beam)
{
    copy_state(beam, &beam->committed, &beam->saved);
    copy_state(beam, &beam->earlier, &beam->saved_earlier);
    memcpy(beam->history, beam->saved_history, beam->history_size * sizeof *beam->history);
    memcpy(beam->committed_resultants, beam->saved_resultants,
           (size_t)(beam->n_elements * POINTS) * sizeof *beam->saved_resultants);
    wb_beam_revert(beam);
}

int wb_beam_count_nodes(const struct wb_beam *beam)
{
    return beam->n_nodes;
}

double wb_beam_element_length(const struct wb_beam *beam)
{
    return beam->element_length;
}

const struct wb_beam_point *wb_beam_section(const struct wb_beam *beam, double s)
{
    /* Each half of an element contains one of its two points. */
    const double halves = floor(2.0 * s / beam->element_length);
    return &beam->points[(int)fmin(fmax(halves, 0.0), beam->n_elements * POINTS - 1)];
}

void wb_beam_place(struct wb_beam *beam, const struct wb_beam_node *first)
{
    const double turn = first->t - beam->trial.nodes[0].t;

    beam->trial.nodes[0] = *first;
    for (int i = 1; i < beam->n_nodes; i++)
        beam->trial.nodes[i].t += turn;
    place_all(beam);
    copy_state(beam, &beam->committed, &beam->trial);
    copy_state(beam, &beam->earlier, &beam->trial);
}

const struct wb_beam_node *wb_beam_nodes(const struct wb_beam *beam)
{
    return beam->trial.nodes;
}

const double (*wb_beam_residuals(const struct wb_beam *beam))[3]
{
    return (const double(*)[3])beam->residual;
}

void wb_beam_element_tangent(const struct wb_beam *beam, int e,
                             struct wb_beam_element_stiffness *stiffness)
{
    wb_beam_element_stiffness(&beam->shape, &beam->points[e * POINTS], stiffness);
}

double wb_beam_step_work(const struct wb_beam *beam)
{
    double work = 0.0;
    for (int i = 0; i < beam->n_elements * POINTS; i++) {
        const struct wb_beam_point *p = &beam->points[i];
        const struct resultants *was = &beam->committed_resultants[i];
        const struct strain *to = &beam->trial.strains[i], *from = &beam->committed.strains[i];
        work += 0.5 * beam->shape.weight *
                ((p->N + was->N) * (to->eps - from->eps) +
                 (p->Q + was->Q) * (to->gamma - from->gamma) + (p->M + was->M) * (p->k - was->k));
    }
    return work;
}

const struct wb_beam_node *wb_beam_tip(const struct wb_beam *beam)
{
    return &beam->trial.nodes[beam->n_nodes - 1];
}

const struct wb_beam_node *wb_beam_reference_tip(const struct wb_beam *beam)
{
    return &beam->reference[beam->n_nodes - 1];
}

double wb_beam_root_moment(const struct wb_beam *beam)
{
    return -beam->residual[0][2];
}

double wb_beam_noise(const struct wb_beam *beam)
{
    /* Strains are about 1e-3 and carry a relative error of epsilon; 30 such errors add up. */
    const double stiffness =
        fmax(wb_fibres_axial_stiffness(beam->fibres), wb_fibres_shear_stiffness(beam->fibres));
    return 3e-2 * DBL_EPSILON * stiffness;
}

double wb_beam_scale_force(const struct wb_beam *beam)
{
    return wb_fibres_bending_stiffness(beam->fibres) / (beam->length * beam->length);
}

const struct wb_beam_point *wb_beam_point(const struct wb_beam *beam, int g)
{
    return &beam->points[g];
}

struct wb_beam_node wb_beam_position(const struct wb_beam *beam, double s)
{
    const double within = fmin(fmax(s, 0.0), beam->length) / beam->element_length;
    const int e = (int)fmin(floor(within), beam->n_elements - 1);
    const double z = 2.0 * (within - e) - 1.0;
    const double N[3] = {0.5 * z * (z - 1.0), 1.0 - z * z, 0.5 * z * (z + 1.0)};
    const struct wb_beam_node *node = beam->committed.nodes + 2 * e;
    return (struct wb_beam_node){
        N[0] * node[0].x + N[1] * node[1].x + N[2] * node[2].x,
        N[0] * node[0].y + N[1] * node[1].y + N[2] * node[2].y,
        N[0] * node[0].t + N[1] * node[1].t + N[2] * node[2].t,
    };
}
