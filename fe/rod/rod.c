#include "fe/rod/rod.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fe/linear/larger.h"
#include "fe/linear/rod_chain.h"
#include "fe/linear/signature.h"
#include "fe/rod/rod_private.h"

#define WB_LOG_DOMAIN "rod"

enum {
    MAX_ELEMENTS = 100000,
    POINTS = WB_ROD_ELEMENT_POINTS,
    NODES = WB_ROD_ELEMENT_NODES,
    U = WB_ROD_ELEMENT_UNKNOWNS
};

/* Elimination of an element's middle node from its end nodes: d2 = -w - W1 d1 - W3 d3. */
struct middle {
    double w[U], W1[U * U], W3[U * U];
};

struct wb_rod {
    const struct wb_rod_section *section;
    int n_elements, n_nodes, n_points;
    double length;
    struct wb_rod_shape shape;
    size_t row, history_size; /* doubles of one point, of all points */
    double load[3];

    /* Strains of the points, (n_points) each: `natural` of the reference, the others relative to
     * it. `earlier` is the state committed before `committed`. */
    struct wb_rod_strain *natural, *trial, *committed, *earlier;
    double *history, *trial_history;

    struct wb_rod_node *nodes;       /* (n_nodes) of the trial state */
    double (*committed_rotation)[4]; /* (n_nodes) */
    struct wb_rod_point *points;     /* (n_points) */
    double (*residual)[U];           /* (n_nodes) */
    struct middle *middles;          /* (n_elements) */
    struct wb_rod_chain chain;       /* stiffness of the elements' end nodes, without the clamp */
    int negative;                    /* negative eigenvalues of the middle nodes' blocks */
    struct wb_memory memory;         /* of all arrays */
};

/* Total strains of an element's points, including those of the reference. */
static void total_strain(const struct wb_rod *rod, int e, struct wb_rod_strain *total)
{
    for (int g = 0; g < POINTS; g++) {
        const struct wb_rod_strain *at = &rod->trial[e * POINTS + g];
        total[g] = rod->natural[e * POINTS + g];
        for (int k = 0; k < 3; k++) {
            total[g].stretch[k] += at->stretch[k];
            total[g].curvature[k] += at->curvature[k];
        }
    }
}

static void place(struct wb_rod *rod)
{
    for (int e = 0; e < rod->n_elements; e++) {
        struct wb_rod_strain total[POINTS];
        total_strain(rod, e, total);
        wb_rod_element_place(&rod->shape, total, rod->nodes + 2 * e, rod->points + e * POINTS);
    }
}

static double place_of(const struct wb_rod *rod, int g)
{
    const double z = (g % POINTS == 0 ? -1.0 : 1.0) / sqrt(3.0);
    return rod->shape.length * (g / POINTS + 0.5 + 0.5 * z);
}

static bool set_reference_shape(struct wb_rod *rod, const struct wb_rod_model *model)
{
    for (int g = 0; g < rod->n_points; g++) {
        double *k = rod->natural[g].curvature;
        rod->natural[g].stretch[0] = 1.0;
        if (model->natural_curvature)
            model->natural_curvature(model->curvature_context, place_of(rod, g), k);
        if (!(isfinite(k[0]) && isfinite(k[1]) && isfinite(k[2])))
            return false;
        rod->points[g].shear_stiffness = wb_rod_section_shear_stiffness(rod->section);
    }
    return true;
}

static enum wb_status check_model(const struct wb_rod_model *model)
{
    if (!model->section)
        return wb_fail(WB_ERR_ARGUMENT, "the rod has no section");
    if (!(isfinite(model->length) && model->length > 0.0))
        return wb_fail(WB_ERR_ARGUMENT, "length %g m: expected a number above 0", model->length);
    if (model->n_elements < 1 || model->n_elements > MAX_ELEMENTS)
        return wb_fail(WB_ERR_ARGUMENT, "%d elements: expected 1 to %d", model->n_elements,
                       MAX_ELEMENTS);
    const double *q = model->load;
    if (!(isfinite(q[0]) && isfinite(q[1]) && isfinite(q[2])))
        return wb_fail(WB_ERR_ARGUMENT, "load (%g, %g, %g) N/m is not finite", q[0], q[1], q[2]);
    return WB_OK;
}

static void take_memory(struct wb_rod *rod)
{
    const size_t nodes = (size_t)rod->n_nodes, elements = (size_t)rod->n_elements;
    const size_t points = (size_t)rod->n_points;
    struct wb_rod_chain *chain = &rod->chain;

    rod->natural = wb_memory_take(&rod->memory, points, sizeof *rod->natural);
    rod->trial = wb_memory_take(&rod->memory, points, sizeof *rod->trial);
    rod->committed = wb_memory_take(&rod->memory, points, sizeof *rod->committed);
    rod->earlier = wb_memory_take(&rod->memory, points, sizeof *rod->earlier);
    rod->history = wb_memory_take(&rod->memory, rod->history_size, sizeof *rod->history);
    rod->trial_history =
        wb_memory_take(&rod->memory, rod->history_size, sizeof *rod->trial_history);
    rod->nodes = wb_memory_take(&rod->memory, nodes, sizeof *rod->nodes);
    rod->committed_rotation = wb_memory_take(&rod->memory, nodes, sizeof *rod->committed_rotation);
    rod->points = wb_memory_take(&rod->memory, points, sizeof *rod->points);
    rod->residual = wb_memory_take(&rod->memory, nodes, sizeof *rod->residual);
    rod->middles = wb_memory_take(&rod->memory, elements, sizeof *rod->middles);
    chain->n = rod->n_elements;
    chain->diagonal = wb_memory_take(&rod->memory, elements, sizeof *chain->diagonal);
    chain->upper = wb_memory_take(&rod->memory, elements, sizeof *chain->upper);
    chain->lower = wb_memory_take(&rod->memory, elements, sizeof *chain->lower);
    chain->right = wb_memory_take(&rod->memory, elements, sizeof *chain->right);
}

enum wb_status wb_rod_create(struct wb_rod **out, const struct wb_rod_model *model)
{
    *out = NULL;
    WB_TRY(check_model(model));

    struct wb_rod *const rod = wb_memory_new(1, sizeof *rod);
    rod->section = model->section;
    rod->n_elements = model->n_elements;
    rod->n_nodes = 2 * model->n_elements + 1;
    rod->n_points = POINTS * model->n_elements;
    rod->length = model->length;
    rod->row = wb_rod_section_history_size(model->section);
    rod->history_size = rod->row * (size_t)rod->n_points;
    memcpy(rod->load, model->load, sizeof rod->load);
    wb_rod_shape_init(&rod->shape, model->length / model->n_elements);
    take_memory(rod);
    if (!set_reference_shape(rod, model)) {
        wb_rod_destroy(rod);
        return wb_fail(WB_ERR_ARGUMENT, "the natural curvature is not finite everywhere");
    }
    rod->nodes[0].rotation[0] = 1.0;
    wb_rod_reset(rod);
    *out = rod;
    return WB_OK;
}

void wb_rod_destroy(struct wb_rod *rod)
{
    if (!rod)
        return;
    wb_memory_release(&rod->memory);
    free(rod);
}

static void copy_strains(const struct wb_rod *rod, struct wb_rod_strain *to,
                         const struct wb_rod_strain *from)
{
    memcpy(to, from, (size_t)rod->n_points * sizeof *to);
}

/* Stores the rotations of the committed state. */
static void remember_rotations(struct wb_rod *rod)
{
    for (int i = 0; i < rod->n_nodes; i++)
        memcpy(rod->committed_rotation[i], rod->nodes[i].rotation, sizeof rod->nodes[i].rotation);
}

void wb_rod_reset(struct wb_rod *rod)
{
    const size_t points = (size_t)rod->n_points;
    memset(rod->trial, 0, points * sizeof *rod->trial);
    memset(rod->committed, 0, points * sizeof *rod->committed);
    memset(rod->earlier, 0, points * sizeof *rod->earlier);
    memset(rod->history, 0, rod->history_size * sizeof *rod->history);
    place(rod);
    remember_rotations(rod);
}

void wb_rod_set_clamp(struct wb_rod *rod, const double rotation[4])
{
    memcpy(rod->nodes[0].rotation, rotation, 4 * sizeof *rotation);
    place(rod);
}

static void subtract_load(struct wb_rod *rod, double factor)
{
    /* Consistent with quadratic motions: 1/6, 4/6, 1/6 of an element's load. */
    static const double parts[NODES] = {1.0, 4.0, 1.0};
    const double share = factor * rod->shape.length / 6.0;
    for (int e = 0; e < rod->n_elements; e++) {
        for (int i = 0; i < NODES; i++) {
            for (int k = 0; k < 3; k++)
                rod->residual[2 * e + i][k] -= parts[i] * share * rod->load[k];
        }
    }
}

static void section_strain(const struct wb_rod_strain *at, double *strain)
{
    strain[0] = at->stretch[0];
    memcpy(strain + 1, at->curvature, sizeof at->curvature);
}

static int evaluate_point(struct wb_rod *rod, int g)
{
    const struct wb_rod_strain *at = &rod->trial[g];
    struct wb_rod_point *p = &rod->points[g];
    const size_t row = (size_t)g * rod->row;
    double strain[WB_ROD_SECTION_STRAINS];

    section_strain(at, strain);
    wb_rod_section_respond(rod->section, strain, rod->history + row, rod->trial_history + row,
                           &p->section);
    wb_rod_element_turn_forces(p, at->stretch + 1);
    return p->section.yielding;
}

void wb_rod_evaluate(struct wb_rod *rod, double load_factor, struct wb_rod_balance *balance)
{
    const double lever = 1.0 / rod->length;
    *balance = (struct wb_rod_balance){0};

    memset(rod->residual, 0, (size_t)rod->n_nodes * sizeof *rod->residual);
    for (int e = 0; e < rod->n_elements; e++) {
        double f[U * NODES] = {0};
        for (int g = 0; g < POINTS; g++) {
            const int at = e * POINTS + g;
            balance->yielding += evaluate_point(rod, at);
            wb_rod_element_add_forces(&rod->shape, g, &rod->points[at], f);
        }
        for (int i = 0; i < NODES; i++) {
            balance->largest_force =
                wb_larger(balance->largest_force, wb_rod_element_force_size(f + U * i, lever));
            for (int k = 0; k < U; k++)
                rod->residual[2 * e + i][k] += f[U * i + k];
        }
    }
    subtract_load(rod, load_factor);

    for (int i = 1; i < rod->n_nodes - 1; i++) {
        const double size = wb_rod_element_force_size(rod->residual[i], lever);
        if (size > balance->largest_residual || size != size) {
            balance->largest_residual = size;
            balance->worst_place = 0.5 * rod->shape.length * i;
        }
    }
    memcpy(balance->tip, rod->residual[rod->n_nodes - 1], sizeof balance->tip);
    memcpy(balance->clamp, rod->residual[0], sizeof balance->clamp);
}

/* Eliminates an element's middle node and adds the condensed stiffness to the chain of end
 * nodes. */
static void condense_element(struct wb_rod *rod, int e)
{
    struct wb_rod_element_stiffness s;
    struct middle *m = &rod->middles[e];
    struct wb_rod_chain *chain = &rod->chain;
    double rows[U][WB_ROD_CHAIN_WIDTH] = {{0}};

    wb_rod_element_stiffness(&rod->shape, &rod->points[e * POINTS], &s);
    rod->negative += wb_signature_negative(U, U, s.K[1][1]);
    for (int r = 0; r < U; r++) {
        memcpy(rows[r], s.K[1][1] + U * r, U * sizeof(double));
        memcpy(rows[r] + U, s.K[1][2] + U * r, U * sizeof(double));
        rows[r][2 * U] = rod->residual[2 * e + 1][r];
        memcpy(rows[r] + 2 * U + 1, s.K[1][0] + U * r, U * sizeof(double));
    }
    wb_rod_chain_solve(rows, 2 * U + 1);
    for (int r = 0; r < U; r++) {
        memcpy(m->W3 + U * r, rows[r] + U, U * sizeof(double));
        m->w[r] = rows[r][2 * U];
        memcpy(m->W1 + U * r, rows[r] + 2 * U + 1, U * sizeof(double));
    }

    if (e > 0) {
        double *diagonal = chain->diagonal[e - 1];
        memcpy(chain->upper[e - 1], s.K[0][2], sizeof s.K[0][2]);
        memcpy(chain->lower[e - 1], s.K[2][0], sizeof s.K[2][0]);
        wb_rod_chain_multiply(chain->upper[e - 1], -1.0, s.K[0][1], m->W3);
        wb_rod_chain_multiply(chain->lower[e - 1], -1.0, s.K[2][1], m->W1);
        wb_rod_chain_multiply(s.K[0][0], -1.0, s.K[0][1], m->W1);
        for (int k = 0; k < U * U; k++)
            diagonal[k] += s.K[0][0][k];
        wb_rod_chain_apply(chain->right[e - 1], 1.0, s.K[0][1], m->w);
    }
    memcpy(chain->diagonal[e], s.K[2][2], sizeof s.K[2][2]);
    wb_rod_chain_multiply(chain->diagonal[e], -1.0, s.K[2][1], m->W3);
    for (int k = 0; k < U; k++)
        chain->right[e][k] = -rod->residual[2 * e + 2][k];
    wb_rod_chain_apply(chain->right[e], 1.0, s.K[2][1], m->w);
}

void wb_rod_condense(struct wb_rod *rod, double *stiffness, double *right)
{
    const int last = rod->n_elements - 1;
    rod->negative = 0;
    for (int e = 0; e <= last; e++)
        condense_element(rod, e);
    wb_rod_chain_condense(&rod->chain);
    memcpy(stiffness, rod->chain.diagonal[last], U * U * sizeof *stiffness);
    memcpy(right, rod->chain.right[last], U * sizeof *right);
}

int wb_rod_negative(const struct wb_rod *rod)
{
    return rod->negative + rod->chain.negative;
}

/* The increment changes strains; positions and rotations follow from them, for the reasons given in
 * beam.c. */
double wb_rod_advance(struct wb_rod *rod, const double *tip, double most_rotation)
{
    double(*d)[U] = rod->chain.right;

    memcpy(d[rod->n_elements - 1], tip, U * sizeof *tip);
    wb_rod_chain_expand(&rod->chain);

    double turn = 0.0;
    for (int e = 0; e < rod->n_elements; e++)
        turn = wb_larger(turn, sqrt(d[e][3] * d[e][3] + d[e][4] * d[e][4] + d[e][5] * d[e][5]));
    const double scale = turn > most_rotation ? most_rotation / turn : 1.0;

    for (int e = 0; e < rod->n_elements; e++) {
        const struct middle *m = &rod->middles[e];
        double own[NODES * U] = {0};
        if (e > 0)
            memcpy(own, d[e - 1], sizeof d[e - 1]);
        memcpy(own + 2 * U, d[e], sizeof d[e]);
        for (int k = 0; k < U; k++)
            own[U + k] = -m->w[k];
        wb_rod_chain_apply(own + U, -1.0, m->W1, own);
        wb_rod_chain_apply(own + U, -1.0, m->W3, own + 2 * U);

        for (int g = 0; g < POINTS; g++) {
            const int at = e * POINTS + g;
            struct wb_rod_strain change;
            wb_rod_element_strain_increment(&rod->shape, g, &rod->points[at], own, &change);
            for (int k = 0; k < 3; k++) {
                rod->trial[at].stretch[k] += scale * change.stretch[k];
                rod->trial[at].curvature[k] += scale * change.curvature[k];
            }
        }
    }
    place(rod);
    return scale;
}

void wb_rod_revert(struct wb_rod *rod)
{
    copy_strains(rod, rod->trial, rod->committed);
    place(rod);
}

void wb_rod_extrapolate(struct wb_rod *rod, double ratio)
{
    for (int g = 0; g < rod->n_points; g++) {
        const struct wb_rod_strain now = rod->committed[g], was = rod->earlier[g];
        for (int k = 0; k < 3; k++) {
            rod->trial[g].stretch[k] = now.stretch[k] + ratio * (now.stretch[k] - was.stretch[k]);
            rod->trial[g].curvature[k] =
                now.curvature[k] + ratio * (now.curvature[k] - was.curvature[k]);
        }
    }
    place(rod);
}

void wb_rod_commit(struct wb_rod *rod)
{
    struct wb_rod_strain *oldest = rod->earlier;
    double *old = rod->history;

    rod->earlier = rod->committed;
    rod->committed = oldest;
    copy_strains(rod, rod->committed, rod->trial);
    rod->history = rod->trial_history;
    rod->trial_history = old;
    remember_rotations(rod);
}

double wb_rod_turn(const struct wb_rod *rod)
{
    double least = 1.0;
    for (int i = 2; i < rod->n_nodes; i += 2) {
        const double *a = rod->committed_rotation[i], *b = rod->nodes[i].rotation;
        least = fmin(least, fabs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]));
    }
    return 2.0 * acos(least);
}

const struct wb_rod_node *wb_rod_tip(const struct wb_rod *rod)
{
    return &rod->nodes[rod->n_nodes - 1];
}

struct wb_rod_node wb_rod_position(const struct wb_rod *rod, double s)
{
    const double within = fmin(fmax(s, 0.0), rod->length) / rod->shape.length;
    const int e = (int)fmin(floor(within), rod->n_elements - 1);
    const double z = 2.0 * (within - e) - 1.0;
    const double N[NODES] = {0.5 * z * (z - 1.0), 1.0 - z * z, 0.5 * z * (z + 1.0)};
    const struct wb_rod_node *node = rod->nodes + 2 * e;
    struct wb_rod_strain total[POINTS];
    struct wb_rod_node at;

    for (int k = 0; k < 3; k++)
        at.position[k] =
            N[0] * node[0].position[k] + N[1] * node[1].position[k] + N[2] * node[2].position[k];
    total_strain(rod, e, total);
    wb_rod_element_rotation(&rod->shape, total, (within - e) * rod->shape.length, node[0].rotation,
                            at.rotation);
    return at;
}

double wb_rod_noise(const struct wb_rod *rod)
{
    /* See wb_beam_noise(). */
    return 3e-2 * DBL_EPSILON * wb_rod_section_axial_stiffness(rod->section);
}

double wb_rod_scale_force(const struct wb_rod *rod)
{
    return wb_rod_section_bending_stiffness(rod->section) / (rod->length * rod->length);
}

const struct wb_rod_point *wb_rod_point(const struct wb_rod *rod, int g)
{
    return &rod->points[g];
}

void wb_rod_point_state(const struct wb_rod *rod, int g, double *s, double *strain,
                        const double **history)
{
    *s = place_of(rod, g);
    section_strain(&rod->committed[g], strain);
    *history = rod->history + (size_t)g * rod->row;
}
