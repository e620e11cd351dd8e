#include "fe/solid/solid.h"

#include <lapacke.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/units.h"
#include "fe/solid/solid_body.h"
#include "fe/solid/solid_private.h"
#include "fe/solid/solid_tip.h"
#include "fe/solid/solid_update.h"

#define WB_LOG_DOMAIN "solid"

enum {
    Z = WB_SOLID_TIP_UNKNOWNS,
    TENSION = Z, /* unknowns and equations in addition to z */
    SHARE = Z + 1,
    ALL = Z + 2
};

/* Columns of the right-hand sides. */
enum {
    COLUMN_RESIDUAL,
    COLUMN_LOADS, /* derivative of the body's loads with respect to the share, for the arc length */
    COLUMN_TIP,
    COLUMNS = COLUMN_TIP + Z
};

/* Changes of loads in an increment, as one vector: used to detect that an increment continues the
 * one before. */
enum {
    DRIVES = 3 + 9 + 2 /* factors, tip loads, deflection, tension */
};

/* One equilibrium to solve for: a share of a move. */
struct increment {
    const struct wb_solid_move *move;
    struct wb_solid_loads start; /* of the move */
    double start_deflection;     /* m, of the move */
    double from, share; /* shares of the move: at the last equilibrium, and the one to reach */
    double arc_length;  /* m; for WB_SOLID_ARC */
    /* (9) change of z in the previous increment; NULL: no direction. */
    const double *last_direction;
    double change[Z]; /* out: of z */
};

struct wb_solid {
    struct wb_solid_settings settings;
    struct wb_solid_body body;
    struct wb_solid_tip_section tip;
    struct wb_solid_update update;
    struct wb_solid_tip_strand strand;
    int n_supports;
    struct wb_solid_support *supports;
    double *nodal_force; /* (3 n_nodes); NULL: no nodal forces */

    /* Displacements: trial state, last equilibrium, equilibrium before it. */
    double *u, *committed, *before;
    struct wb_solid_loads loads, committed_loads, before_loads;
    double *committed_force; /* (3 n_nodes) */
    double drive[DRIVES];
    bool can_continue;     /* `before` and `drive` belong to the last increment */
    double last_change[Z]; /* change of z in the last increment */
    bool on_arc;           /* the last increment was an arc towards arc_target */
    double arc_pace;       /* m: that increment's length */
    struct wb_solid_loads arc_target;
    double largest_force; /* largest at any node so far, N */
    double pace;          /* share of its move that the last increment took */
    struct wb_solid_balance balance;

    /* Workspace of Newton's method. */
    double *right; /* (n_equations x COLUMNS) */
    double *step;  /* (3 n_nodes) */
    double *base;  /* (3 n_nodes) u before the step */
    double *held;  /* (3 n_nodes) */
    double *held_force;
    double compliance[Z * Z];
    double tip_derivative[Z * Z];
    struct wb_solid_body_result found;
    double residual; /* relative */
    int worst_node;
    int iterations;
    int negative_pivots;
    bool unstable; /* the last equilibrium is unstable */
    char problem[240];
    struct wb_memory memory; /* of all arrays */
};

/* --- creation --- */

static struct wb_solid_settings complete_settings(const struct wb_solid_settings *given)
{
    struct wb_solid_settings s = {0};
    if (given)
        s = *given;
    s.force_tolerance = s.force_tolerance == 0.0 ? 1e-6 : s.force_tolerance;
    s.first_increment = s.first_increment == 0.0 ? 1.0 : s.first_increment;
    s.smallest_increment = s.smallest_increment == 0.0 ? 1e-5 : s.smallest_increment;
    s.largest_increment = s.largest_increment == 0.0 ? 1.0 : s.largest_increment;
    return s;
}

static void copy_model(struct wb_solid *solid, const struct wb_solid_model *model)
{
    const size_t n = 3 * (size_t)model->mesh->n_nodes;

    solid->strand = (struct wb_solid_tip_strand){model->strand_length, model->strand_x};
    solid->n_supports = model->n_supports;
    solid->supports =
        wb_memory_take(&solid->memory, (size_t)model->n_supports + 1, sizeof *solid->supports);
    memcpy(solid->supports, model->supports, (size_t)model->n_supports * sizeof *solid->supports);
    if (model->nodal_force) {
        solid->nodal_force = wb_memory_take(&solid->memory, n, sizeof *solid->nodal_force);
        memcpy(solid->nodal_force, model->nodal_force, n * sizeof *solid->nodal_force);
    }
}

static void take_memory(struct wb_solid *solid)
{
    const size_t n = 3 * (size_t)solid->body.mesh->n_nodes;
    double **const vectors[] = {&solid->u,    &solid->committed, &solid->before,
                                &solid->step, &solid->base,      &solid->committed_force,
                                &solid->held, &solid->held_force};

    for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++)
        *vectors[i] = wb_memory_take(&solid->memory, n, sizeof(double));
    solid->right = wb_memory_take(&solid->memory, (size_t)solid->body.n_equations * COLUMNS,
                                  sizeof *solid->right);
}

enum wb_status wb_solid_create(struct wb_solid **out, const struct wb_solid_model *model,
                               const struct wb_solid_settings *settings)
{
    *out = NULL;
    if (!(isfinite(model->strand_length) && model->strand_length >= 0.0 &&
          isfinite(model->strand_x)))
        return wb_fail(WB_ERR_ARGUMENT,
                       "strand_length %g m, strand_x %g m: expected a length of 0 or more",
                       model->strand_length, model->strand_x);

    struct wb_solid_body body;
    WB_TRY(wb_solid_body_init(&body, model));
    struct wb_solid *const solid = wb_memory_new(1, sizeof *solid);
    solid->settings = complete_settings(settings);
    solid->pace = solid->settings.first_increment;
    solid->body = body;
    wb_solid_tip_init(&solid->tip, model->mesh, model->parts);
    wb_solid_update_init(&solid->update, model->mesh);
    copy_model(solid, model);
    take_memory(solid);
    *out = solid;
    return WB_OK;
}

void wb_solid_destroy(struct wb_solid *solid)
{
    if (!solid)
        return;
    wb_solid_body_release(&solid->body);
    wb_solid_tip_release(&solid->tip);
    wb_solid_update_release(&solid->update);
    wb_memory_release(&solid->memory);
    free(solid);
}

static size_t vector_bytes(const struct wb_solid *solid)
{
    return 3 * (size_t)solid->body.mesh->n_nodes * sizeof(double);
}

/* --- one equilibrium, by Newton's method --- */

/* The last factorisation is reused below this relative residual, as long as the residual decreases
 * by this factor. */
static const double reuse_below = 1e-2;
static const double good_reduction = 0.2;

/* A state counts as equilibrium before the first iteration only below this fraction of the
 * tolerance. */
static const double initial_fraction = 1e-3;

static const int max_iterations = 12;

/* An iteration rotates the tip by at most this, rad. */
static const double max_iteration_rotation = 0.5;

/* The residual is relative to at least this fraction of the largest force so far, so that unloaded
 * states converge. */
static const double small_force = 1e-3;

/* Newton step of the unknowns other than displacements. */
struct step {
    double z[Z];
    double tension, share;
};

/* All loads as one vector. */
enum {
    LOADS = sizeof(struct wb_solid_loads) / sizeof(double)
};

union loads {
    struct wb_solid_loads all;
    double value[LOADS];
};

/* Loads at a share of a move; `tension` is used where the tension is an unknown. */
static struct wb_solid_loads loads_at(const struct increment *increment, double share,
                                      double tension)
{
    const union loads a = {increment->start}, b = {increment->move->target};
    union loads at;
    for (int i = 0; i < LOADS; i++)
        at.value[i] = a.value[i] + share * (b.value[i] - a.value[i]);
    if (increment->move->control == WB_SOLID_DEFLECTION)
        at.all.tension = tension;
    return at.all;
}

/* Derivative of the loads with respect to the share. */
static struct wb_solid_loads rate_of_loads(const struct increment *increment)
{
    const union loads a = {loads_at(increment, 0.0, 0.0)};
    union loads rate = {loads_at(increment, 1.0, 0.0)};
    for (int i = 0; i < LOADS; i++)
        rate.value[i] -= a.value[i];
    return rate.all;
}

static double *column(const struct wb_solid *solid, int c)
{
    return solid->right + (size_t)c * (size_t)solid->body.n_equations;
}

/* Adds the body's forces (weight, nodal forces) times factors to a column. */
static void add_body_loads(const struct wb_solid *solid, double weight, double nodal, double *right)
{
    for (int i = 0; i < 3 * solid->body.mesh->n_nodes; i++) {
        const int q = solid->body.equation[i];
        if (q >= 0)
            right[q] += weight * solid->body.weight[i] +
                        (solid->nodal_force ? nodal * solid->nodal_force[i] : 0.0);
    }
}

static void add_tip_loads(const struct wb_solid *solid, const double phi[Z], double *right)
{
    for (int a = 0; a < solid->tip.n_nodes; a++)
        for (int i = 0; i < 3; i++) {
            const int q = solid->body.equation[3 * solid->tip.node[a] + i];
            for (int k = 0; q >= 0 && k < WB_SOLID_TIP_PATTERNS; k++)
                right[q] += solid->tip.pattern[a][k] * phi[3 * k + i];
        }
}

/* Rate of z for a column of displacements (equations): the transpose of the patterns. */
static void tip_motion_of(const struct wb_solid *solid, const double *x, double z[Z])
{
    memset(z, 0, Z * sizeof *z);
    for (int a = 0; a < solid->tip.n_nodes; a++)
        for (int i = 0; i < 3; i++) {
            const int q = solid->body.equation[3 * solid->tip.node[a] + i];
            for (int k = 0; q >= 0 && k < WB_SOLID_TIP_PATTERNS; k++)
                z[3 * k + i] += solid->tip.pattern[a][k] * x[q];
        }
}

/* Computes loads minus internal forces of the trial state in the first column, and the relative
 * residual. */
static void compute_residual(struct wb_solid *solid)
{
    const struct wb_solid_body *body = &solid->body;
    double *right = column(solid, COLUMN_RESIDUAL);
    double z[Z], phi[Z];

    memset(right, 0, (size_t)body->n_equations * sizeof *right);
    add_body_loads(solid, solid->loads.weight, solid->loads.nodal, right);
    if (solid->tip.n_nodes > 0) {
        wb_solid_tip_motion(&solid->tip, body->mesh, solid->u, z);
        wb_solid_tip_forces(z, &solid->loads.tip, &solid->strand, solid->loads.tension, phi,
                            solid->tip_derivative);
        add_tip_loads(solid, phi, right);
    }

    double largest = 0.0, worst = 0.0;
    for (int i = 0; i < 3 * body->mesh->n_nodes; i++) {
        const int q = body->equation[i];
        largest = fmax(largest, fabs(body->force[i]));
        if (q < 0)
            continue;
        largest =
            fmax(largest, fabs(right[q])); /* external loads not yet balanced by internal forces */
        right[q] -= body->force[i];
        if (!(fabs(right[q]) <= worst) && !isnan(worst)) {
            worst = fabs(right[q]);
            solid->worst_node = i / 3;
        }
    }
    const double scale = fmax(largest, small_force * solid->largest_force);
    solid->residual = scale > 0.0 ? worst / scale : 0.0;
}

/* Computes forces and, with `stiffness`, the factored tangent and its compliance for the tip's
 * loads. */
static bool evaluate(struct wb_solid *solid, const struct increment *increment, bool stiffness,
                     bool change_supports)
{
    struct wb_solid_body *body = &solid->body;

    if (change_supports)
        memset(solid->held_force, 0, vector_bytes(solid));
    wb_solid_body_evaluate(body, solid->u, stiffness, change_supports ? solid->held : NULL,
                           solid->held_force, &solid->found);
    if (!solid->found.possible)
        return false;
    compute_residual(solid);
    for (int i = 0; change_supports && i < 3 * body->mesh->n_nodes; i++)
        if (body->equation[i] >= 0)
            column(solid, COLUMN_RESIDUAL)[body->equation[i]] -= solid->held_force[i];
    if (!stiffness)
        return isfinite(solid->residual);

    struct wb_layered_pivots pivots;
    wb_layered_factor(body->tangent, &pivots);
    solid->negative_pivots = pivots.negative;
    if (pivots.singular)
        return false;
    if (increment->move->control == WB_SOLID_ARC) {
        const struct wb_solid_loads rate = rate_of_loads(increment);
        double *right = column(solid, COLUMN_LOADS);
        memset(right, 0, (size_t)body->n_equations * sizeof *right);
        add_body_loads(solid, rate.weight, rate.nodal, right);
        wb_layered_solve(body->tangent, 1, right);
    }
    if (solid->tip.n_nodes > 0) {
        double *right = column(solid, COLUMN_TIP);
        memset(right, 0, Z * (size_t)body->n_equations * sizeof *right);
        for (int k = 0; k < Z; k++) {
            double unit[Z] = {0};
            unit[k] = 1.0;
            add_tip_loads(solid, unit, column(solid, COLUMN_TIP + k));
        }
        wb_layered_solve_last(body->tangent, Z, right);
        for (int k = 0; k < Z; k++)
            tip_motion_of(solid, column(solid, COLUMN_TIP + k), solid->compliance + Z * k);
    }
    return isfinite(solid->residual);
}

/* Length of a change of z, m: translation of the tip and rotation of its frame. */
static double length_of(const struct wb_solid *solid, const double change[Z])
{
    double sum = 0.0;
    for (int i = 0; i < Z; i++) {
        const double part = i < 3 ? change[i] : solid->tip.radius * change[i];
        sum += part * part;
    }
    return sqrt(sum);
}

/* Sets up the linear system of z, tension and share. `A` is column-major. */
static void tip_equations(const struct wb_solid *solid, const struct increment *increment,
                          double *A, double *b)
{
    const double *C = solid->compliance; /* symmetric without friction; row k: response to load k */
    const enum wb_solid_control control = increment->move->control;
    double z[Z], along[Z], rate_phi[Z] = {0}, rate_body[Z] = {0};

    wb_solid_tip_motion(&solid->tip, solid->body.mesh, solid->u, z);
    wb_solid_tip_tension(z, &solid->strand, along);
    if (control == WB_SOLID_ARC) {
        const struct wb_solid_loads rate = rate_of_loads(increment);
        wb_solid_tip_forces(z, &rate.tip, &solid->strand, rate.tension, rate_phi, NULL);
        tip_motion_of(solid, column(solid, COLUMN_LOADS), rate_body);
    }
    tip_motion_of(solid, column(solid, COLUMN_RESIDUAL), b);
    memset(A, 0, ALL * ALL * sizeof *A);
    for (int i = 0; i < Z; i++) {
        A[ALL * i + i] = 1.0;
        for (int k = 0; k < Z; k++) {
            const double answer = C[Z * k + i];
            for (int j = 0; j < Z; j++)
                A[ALL * j + i] -= answer * solid->tip_derivative[Z * k + j];
            A[ALL * TENSION + i] -= answer * along[k];
            A[ALL * SHARE + i] -= answer * rate_phi[k];
        }
        A[ALL * SHARE + i] -= rate_body[i];
    }

    b[TENSION] = 0.0;
    A[ALL * TENSION + TENSION] = 1.0;
    if (control == WB_SOLID_DEFLECTION) {
        A[ALL * TENSION + TENSION] = 0.0;
        A[ALL * 1 + TENSION] = 1.0;
        b[TENSION] =
            increment->start_deflection +
            increment->share * (increment->move->deflection - increment->start_deflection) - z[1];
    }
    A[ALL * SHARE + SHARE] = 1.0;
    b[SHARE] = 0.0;
}

/* Equation of the arc: for the first step a share of 1, which is scaled later; then the linearised
 * arc length. */
static void arc_equation(const struct wb_solid *solid, const struct increment *increment,
                         bool first, double *A, double *b)
{
    if (first) {
        b[SHARE] = 1.0;
        return;
    }
    const double length = length_of(solid, increment->change);
    const double radius2 = solid->tip.radius * solid->tip.radius;
    A[ALL * SHARE + SHARE] = 0.0;
    for (int i = 0; i < Z; i++)
        A[ALL * i + SHARE] = 2.0 * (i < 3 ? 1.0 : radius2) * increment->change[i];
    b[SHARE] = increment->arc_length * increment->arc_length - length * length;
}

/* Scales the first step of an arc to its length, in the forward direction. */
static void scale_first(const struct wb_solid *solid, const struct increment *increment, double *x)
{
    double sign = 1.0;
    if (increment->last_direction) {
        double forwards = 0.0;
        for (int i = 0; i < Z; i++)
            forwards += x[i] * increment->last_direction[i] *
                        (i < 3 ? 1.0 : solid->tip.radius * solid->tip.radius);
        sign = forwards < 0.0 ? -1.0 : 1.0;
    }
    const double scale = sign * increment->arc_length / length_of(solid, x);
    for (int i = 0; i < ALL; i++)
        x[i] *= scale;
}

/* Computes the Newton step of the complete system; displacements go to solid->step. */
static bool solve_step(struct wb_solid *solid, const struct increment *increment, bool first,
                       struct step *step)
{
    const struct wb_solid_body *body = &solid->body;
    double *x = column(solid, COLUMN_RESIDUAL);
    double coefficient[COLUMNS] = {1.0};

    /* The first step of an arc ignores the residual: near a critical point the residual's step
     * would be very large, and it must not be scaled to the arc's length. */
    if (increment->move->control == WB_SOLID_ARC && first)
        memset(x, 0, (size_t)body->n_equations * sizeof *x);
    else
        wb_layered_solve(body->tangent, 1, x);
    *step = (struct step){0};
    if (solid->tip.n_nodes > 0) {
        double A[ALL * ALL], b[ALL];
        lapack_int pivot[ALL];
        tip_equations(solid, increment, A, b);
        if (increment->move->control == WB_SOLID_ARC)
            arc_equation(solid, increment, first, A, b);
        if (LAPACKE_dgesv(LAPACK_COL_MAJOR, ALL, 1, A, ALL, pivot, b, ALL) != 0)
            return false;
        if (increment->move->control == WB_SOLID_ARC && first)
            scale_first(solid, increment, b);
        memcpy(step->z, b, sizeof step->z);
        step->tension = b[TENSION];
        step->share = b[SHARE];

        double z[Z], along[Z], rate_phi[Z] = {0};
        wb_solid_tip_motion(&solid->tip, body->mesh, solid->u, z);
        wb_solid_tip_tension(z, &solid->strand, along);
        if (increment->move->control == WB_SOLID_ARC) {
            const struct wb_solid_loads rate = rate_of_loads(increment);
            wb_solid_tip_forces(z, &rate.tip, &solid->strand, rate.tension, rate_phi, NULL);
            coefficient[COLUMN_LOADS] = step->share;
        }
        for (int k = 0; k < Z; k++) {
            double *c = &coefficient[COLUMN_TIP + k];
            *c = along[k] * step->tension + rate_phi[k] * step->share;
            for (int j = 0; j < Z; j++)
                *c += solid->tip_derivative[Z * k + j] * step->z[j];
        }
    }

    memset(solid->step, 0, vector_bytes(solid));
    for (int c = 0; c < COLUMNS; c++) {
        const double *part = column(solid, c);
        for (int i = 0; coefficient[c] != 0.0 && i < 3 * body->mesh->n_nodes; i++)
            if (body->equation[i] >= 0)
                solid->step[i] += coefficient[c] * part[body->equation[i]];
    }
    return true;
}

static void set_supports(struct wb_solid *solid)
{
    for (int i = 0; i < solid->n_supports; i++) {
        const struct wb_solid_support *s = &solid->supports[i];
        solid->u[3 * s->node + s->axis] = solid->loads.supports * s->displacement;
    }
}

/* Sets the trial state to solid->base plus `scale` times the step. */
static void take_step(struct wb_solid *solid, struct increment *increment, const struct step *step,
                      const struct wb_solid_loads *loads, double share, double scale)
{
    memcpy(solid->u, solid->base, vector_bytes(solid));
    wb_solid_update_advance(&solid->update, solid->u, solid->step, scale);
    if (increment->move->control == WB_SOLID_ARC)
        increment->share = share + scale * step->share;
    solid->loads = loads_at(increment, increment->share, loads->tension + scale * step->tension);
    set_supports(solid);
    if (solid->tip.n_nodes > 0) {
        double before[Z], now[Z];
        wb_solid_tip_motion(&solid->tip, solid->body.mesh, solid->committed, before);
        wb_solid_tip_motion(&solid->tip, solid->body.mesh, solid->u, now);
        for (int i = 0; i < Z; i++)
            increment->change[i] = now[i] - before[i];
    }
}

/* True if the equilibrium is unstable under its control (for an arc: under its loads). Conservative
 * loads use the number of negative pivots. Loads that rotate with the tip, and contact, use the
 * sign of the determinant, which does not detect two critical points in one increment. */
static bool is_unstable(const struct wb_solid *solid, const struct increment *increment)
{
    const struct wb_tip_loads *tip = &solid->loads.tip;
    const bool odd = solid->negative_pivots % 2 != 0;
    double A[ALL * ALL], b[ALL], turning = 0.0;
    lapack_int pivot[ALL];

    if (solid->tip.n_nodes == 0)
        return solid->body.has_contact ? odd : solid->negative_pivots > 0;
    tip_equations(solid, increment, A, b);
    if (LAPACKE_dgetrf(LAPACK_COL_MAJOR, ALL, ALL, A, ALL, pivot) != 0)
        return true;
    bool negative = false;
    for (int i = 0; i < ALL; i++)
        negative ^= (A[ALL * i + i] < 0.0) ^ (pivot[i] != i + 1);
    for (int i = 0; i < 3; i++)
        turning += fabs(tip->follower[i]) + fabs(tip->moment[i]);
    if (solid->body.has_contact || turning > 0.0)
        return odd ^ negative;
    return solid->negative_pivots > (negative ? 1 : 0);
}

static double first_scale(const struct step *step)
{
    double turn = 0.0;
    for (int i = 3; i < Z; i++)
        turn += step->z[i] * step->z[i];
    turn = sqrt(turn);
    return turn > max_iteration_rotation ? max_iteration_rotation / turn : 1.0;
}

/* Takes the step; halves it while the state is impossible or, after the first iteration, the
 * residual grows much. */
static bool take_damped_step(struct wb_solid *solid, struct increment *increment,
                             const struct step *step, bool stiffness, bool guard)
{
    const struct wb_solid_loads loads = solid->loads;
    const double share = increment->share, before = solid->residual;
    double scale = first_scale(step);

    memcpy(solid->base, solid->u, vector_bytes(solid));
    for (int attempt = 0; attempt < 5; attempt++, scale *= 0.5) {
        take_step(solid, increment, step, &loads, share, scale);
        if (!evaluate(solid, increment, stiffness, false))
            continue;
        if (guard && attempt < 4 && solid->residual > 4.0 * before)
            continue;
        return true;
    }
    return false;
}

/* Writes the reason and the place of the largest residual to solid->problem; returns false. */
static bool fail(struct wb_solid *solid, const char *reason)
{
    const double *X = solid->body.mesh->node[solid->worst_node];

    if (!solid->found.possible && solid->found.worst_element >= 0) {
        const int node = solid->body.mesh->element[solid->found.worst_element][0];
        snprintf(solid->problem, sizeof solid->problem,
                 "element %d at %.4g mm along the wire is inverted (after %d iterations)",
                 solid->found.worst_element, solid->body.mesh->node[node][0] / WB_MM,
                 solid->iterations);
        return false;
    }
    snprintf(solid->problem, sizeof solid->problem,
             "%s: after %d iterations the relative residual is %.2g, largest at (%.4g, %.4g, %.4g) "
             "mm",
             reason, solid->iterations, solid->residual, X[0] / WB_MM, X[1] / WB_MM, X[2] / WB_MM);
    return false;
}

static bool has_converged(const struct wb_solid *solid, const struct increment *increment)
{
    if (!(solid->residual <= solid->settings.force_tolerance))
        return false;
    if (increment->move->control != WB_SOLID_DEFLECTION)
        return true;
    double z[Z];
    wb_solid_tip_motion(&solid->tip, solid->body.mesh, solid->u, z);
    const double wanted =
        increment->start_deflection +
        increment->share * (increment->move->deflection - increment->start_deflection);
    return fabs(z[1] - wanted) <=
           1e-4 * solid->settings.force_tolerance * solid->tip.radius + 1e-12 * fabs(wanted);
}

/* Computes the remaining motion of supports in solid->held; false if there is none. */
static bool supports_change(struct wb_solid *solid)
{
    bool any = false;

    memset(solid->held, 0, vector_bytes(solid));
    for (int i = 0; i < solid->n_supports; i++) {
        const struct wb_solid_support *s = &solid->supports[i];
        const int at = 3 * s->node + s->axis;
        solid->held[at] = solid->loads.supports * s->displacement - solid->u[at];
        any = any || solid->held[at] != 0.0;
    }
    return any;
}

/* Solves for equilibrium from the trial state in solid->u and solid->loads, which the caller has
 * set. `predicted`: the trial state already includes the new support displacements. True if it
 * converged: trial state, histories and solid->found are then those of the equilibrium, and
 * increment->share is the share reached. Otherwise solid->problem gives the reason. */
static bool find_equilibrium(struct wb_solid *solid, struct increment *increment, bool predicted)
{
    const bool arc = increment->move->control == WB_SOLID_ARC;
    bool fresh = true;

    solid->iterations = 0;
    memset(increment->change, 0, sizeof increment->change);
    const bool move_supports = !predicted && supports_change(solid);
    if (!evaluate(solid, increment, true, move_supports))
        return fail(solid, "the tangent stiffness is singular");
    /* Many small residuals of one sign are a load: accept the initial state only if its residual is
     * far below the tolerance; an iteration is cheap there. */
    const bool at_once = !arc && !move_supports &&
                         solid->residual <= initial_fraction * solid->settings.force_tolerance;
    while (!has_converged(solid, increment) || (solid->iterations == 0 && !at_once)) {
        struct step step;
        const double before = solid->residual;
        if (solid->iterations++ == max_iterations)
            return fail(solid, "no convergence");
        const bool first = solid->iterations == 1;
        if (!solve_step(solid, increment, first, &step))
            return fail(solid, "the tip's equations are singular");
        if (first && move_supports)
            for (int i = 0; i < 3 * solid->body.mesh->n_nodes; i++)
                solid->step[i] += solid->held[i];

        /* Near convergence evaluate only the forces and reuse the tangent. */
        const bool near = before < reuse_below && !first;
        if (!take_damped_step(solid, increment, &step, !near, !first))
            return fail(solid, "no convergence");
        if (has_converged(solid, increment))
            break;
        if (near && (!fresh || solid->residual > good_reduction * before)) {
            if (!evaluate(solid, increment, true, false))
                return fail(solid, "the tangent stiffness is singular");
            fresh = true;
        } else {
            fresh = !near;
        }
    }
    return true;
}

/* --- moves, in increments --- */

/* Wanted number of iterations per increment: increments grow if fewer are needed and shrink if
 * more. */
static const double wanted_iterations = 6.0;

/* Largest rotation of the tip in an increment, rad. */
static const double most_rotation = 0.25;

/* A strand's tension above minus this fraction of the largest nodal force counts as zero. */
static const double tension_tolerance = 1e-6;

/* Smallest arc length, over the requested one. */
static const double shortest_arc = 1.0 / 256.0;

/* An arc may exceed the end of a move by this share. */
static const double max_overshoot = 1e-3;

/* Default number of arc increments in a move. */
static const int default_arc_increments = 1;

static double deflection_of(const struct wb_solid *solid, const double *u)
{
    double z[Z];
    if (solid->tip.n_nodes == 0)
        return 0.0;
    wb_solid_tip_motion(&solid->tip, solid->body.mesh, u, z);
    return z[1];
}

/* Changes of loads in an increment, as one vector. */
static void drive_of(const struct wb_solid *solid, const struct increment *increment,
                     double drive[DRIVES])
{
    const struct wb_solid_loads a = loads_at(increment, increment->from, 0.0);
    const struct wb_solid_loads b = loads_at(increment, increment->share, 0.0);
    const bool deflection = increment->move->control == WB_SOLID_DEFLECTION;
    int n = 0;

    drive[n++] = b.weight - a.weight;
    drive[n++] = b.supports - a.supports;
    drive[n++] = b.nodal - a.nodal;
    for (int i = 0; i < 3; i++) {
        drive[n++] = b.tip.force[i] - a.tip.force[i];
        drive[n++] = b.tip.follower[i] - a.tip.follower[i];
        /* Moments as forces, divided by the section's radius of gyration. */
        drive[n++] =
            solid->tip.n_nodes > 0 ? (b.tip.moment[i] - a.tip.moment[i]) / solid->tip.radius : 0.0;
    }
    drive[n++] = deflection ? (increment->share - increment->from) *
                                  (increment->move->deflection - increment->start_deflection)
                            : 0.0;
    drive[n] = deflection ? 0.0 : b.tension - a.tension;
}

/* Ratio of this increment's drive to the last one's; 0 if they are not parallel. */
static double ratio_of(const double *last, const double *now)
{
    double ll = 0.0, ln = 0.0, nn = 0.0;
    for (int i = 0; i < DRIVES; i++) {
        ll += last[i] * last[i];
        ln += last[i] * now[i];
        nn += now[i] * now[i];
    }
    const double ratio = ln / ll;
    const bool parallel = ll > 0.0 && ln > 0.0 && ln * ln > (1.0 - 1e-9) * ll * nn;
    return parallel && ratio <= 3.0 ? ratio : 0.0;
}

/* Sets the trial state of an increment; true if it was extrapolated from the last increment. */
static bool predict(struct wb_solid *solid, const struct increment *increment)
{
    double drive[DRIVES];
    double tension = solid->committed_loads.tension;

    drive_of(solid, increment, drive);
    const double ratio = solid->can_continue && increment->move->control != WB_SOLID_ARC
                             ? ratio_of(solid->drive, drive)
                             : 0.0;
    if (ratio > 0.0) {
        wb_solid_update_extrapolate(&solid->update, solid->before, solid->committed, ratio,
                                    solid->u);
        tension += ratio * (tension - solid->before_loads.tension);
    } else {
        memcpy(solid->u, solid->committed, vector_bytes(solid));
    }
    solid->loads = loads_at(increment, increment->share, tension);
    if (ratio > 0.0)
        set_supports(solid);
    return ratio > 0.0;
}

/* Makes the trial state the last equilibrium. */
static void accept(struct wb_solid *solid, const struct increment *increment)
{
    const struct wb_solid_body *body = &solid->body;

    for (int i = 0; i < 3 * body->mesh->n_nodes; i++) {
        solid->balance.work += 0.5 * (solid->committed_force[i] + body->force[i]) *
                               (solid->u[i] - solid->committed[i]);
        solid->largest_force = fmax(solid->largest_force, fabs(body->force[i]));
    }
    solid->balance.elastic = solid->found.elastic;
    solid->balance.dissipated += solid->found.dissipated;
    solid->balance.friction += solid->found.friction;
    solid->balance.jacket_contact = solid->found.jacket_contact;

    double *oldest = solid->before;
    solid->before = solid->committed;
    solid->committed = solid->u;
    solid->u = oldest;
    memcpy(solid->u, solid->committed, vector_bytes(solid));
    memcpy(solid->committed_force, body->force, vector_bytes(solid));
    solid->before_loads = solid->committed_loads;
    solid->committed_loads = solid->loads;
    drive_of(solid, increment, solid->drive);
    memcpy(solid->last_change, increment->change, sizeof solid->last_change);
    solid->can_continue = increment->move->control != WB_SOLID_ARC;
    solid->on_arc = false;
    wb_solid_body_commit(&solid->body);
}

/* True if the increment led from a stable equilibrium to an unstable one: it passed a critical
 * point, perhaps to another branch. */
static bool passes_critical_point(struct wb_solid *solid, const struct increment *increment)
{
    const bool unstable = is_unstable(solid, increment);

    if (!unstable || solid->unstable) {
        solid->unstable = unstable;
        return false;
    }
    snprintf(solid->problem, sizeof solid->problem,
             "a critical point (a limit load or buckling) lies between %.4g and %.4g of the move",
             increment->from, increment->share);
    return true;
}

static void revert(struct wb_solid *solid)
{
    memcpy(solid->u, solid->committed, vector_bytes(solid));
    solid->loads = solid->committed_loads;
}

static double tip_rotation(const struct increment *increment)
{
    double sum = 0.0;
    for (int i = 3; i < Z; i++)
        sum += increment->change[i] * increment->change[i];
    return sqrt(0.5 * sum);
}

/* The next increment's share, from iterations and rotation of the last one. */
static double next_pace(const struct wb_solid *solid, const struct increment *increment)
{
    const double pace = increment->share - increment->from;
    double growth = sqrt(wanted_iterations / fmax(1.0, solid->iterations));

    growth = fmin(2.0, fmax(0.5, growth));
    if (tip_rotation(increment) * growth > most_rotation)
        growth = fmax(0.5, most_rotation / tip_rotation(increment));
    return fmin(solid->settings.largest_increment, pace * growth);
}

static bool observe(const struct wb_solid_move *move, double share, int iterations)
{
    return !move->observer || move->observer(move->context, share, iterations);
}

static void finish(const struct wb_solid *solid, struct wb_solid_point *point,
                   enum wb_solid_end end)
{
    point->end = end;
    point->residual = solid->residual;
    point->negative_pivots = solid->negative_pivots;
    point->unstable = solid->unstable;
    if (end == WB_SOLID_NOT_CONVERGED)
        snprintf(point->problem, sizeof point->problem, "%s", solid->problem);
}

/* True if the strand would have to push at this equilibrium. */
static bool pushes(const struct wb_solid *solid, const struct increment *increment)
{
    double largest = solid->largest_force;

    if (increment->move->control != WB_SOLID_DEFLECTION || solid->strand.length == 0.0 ||
        !(solid->loads.tension < 0.0))
        return false;
    for (int i = 0; i < 3 * solid->body.mesh->n_nodes; i++)
        largest = fmax(largest, fabs(solid->body.force[i]));
    return solid->loads.tension < -tension_tolerance * largest;
}

/* The increment at which the tension becomes zero, by linear interpolation. */
static double increment_to_slack(const struct wb_solid *solid, const struct increment *increment)
{
    const double from = fmax(0.0, solid->committed_loads.tension), to = solid->loads.tension;
    return (increment->share - increment->from) * from / (from - to);
}

/* Whether the increment ends in an equilibrium that can be accepted; otherwise the end of the move
 * if no shorter increment can, and the pace of the next attempt. */
static enum wb_solid_end judge(struct wb_solid *solid, const struct increment *increment,
                               bool converged, double *pace)
{
    const double tried = increment->share - increment->from;
    const double rotation = tip_rotation(increment);

    if (!converged || passes_critical_point(solid, increment)) {
        *pace = 0.5 * tried;
        return WB_SOLID_NOT_CONVERGED;
    }
    if (rotation > 2.0 * most_rotation) {
        /* Rotation too large for path-dependent plasticity. */
        *pace = tried * most_rotation / rotation;
        snprintf(solid->problem, sizeof solid->problem,
                 "the tip rotates by %.2g rad between %.6g and %.6g of the move: no equilibrium "
                 "nearby",
                 rotation, increment->from, increment->share);
        return WB_SOLID_NOT_CONVERGED;
    }
    if (!pushes(solid, increment))
        return WB_SOLID_CONVERGED;
    *pace = increment_to_slack(solid, increment);
    return WB_SOLID_SLACK;
}

static void move_by_shares(struct wb_solid *solid, struct increment *increment,
                           struct wb_solid_point *point)
{
    double pace = fmin(1.0, solid->pace);

    while (point->fraction < 1.0) {
        /* Avoid a very small last increment. */
        const double rest = 1.0 - point->fraction;
        increment->from = point->fraction;
        increment->share = rest <= pace * 1.01 ? 1.0 : point->fraction + fmin(pace, 0.5 * rest);
        const bool predicted = predict(solid, increment);
        bool converged = find_equilibrium(solid, increment, predicted);
        point->iterations += solid->iterations;
        if (!converged && predicted) {
            /* Retry without extrapolation. */
            solid->can_continue = false;
            (void)predict(solid, increment);
            converged = find_equilibrium(solid, increment, false);
            point->iterations += solid->iterations;
        }
        const enum wb_solid_end end = judge(solid, increment, converged, &pace);
        if (end != WB_SOLID_CONVERGED) {
            revert(solid);
            point->cutbacks += end == WB_SOLID_NOT_CONVERGED;
            if (pace < solid->settings.smallest_increment) {
                finish(solid, point, end);
                return;
            }
            continue;
        }
        accept(solid, increment);
        point->fraction = increment->share;
        point->increments++;
        pace = next_pace(solid, increment);
        if (!observe(increment->move, point->fraction, solid->iterations)) {
            finish(solid, point, WB_SOLID_STOPPED);
            return;
        }
    }
    solid->pace = pace;
    finish(solid, point, WB_SOLID_CONVERGED);
}

static void move_by_arc(struct wb_solid *solid, struct increment *increment,
                        struct wb_solid_point *point)
{
    const struct wb_solid_move *move = increment->move;
    const int most = move->most_increments > 0 ? move->most_increments : default_arc_increments;
    double length = move->arc_length;

    /* A continued path keeps its direction; a path to new loads starts in the direction of
     * increasing loads. */
    if (solid->on_arc && memcmp(&solid->arc_target, &move->target, sizeof move->target) == 0) {
        increment->last_direction = solid->last_change;
        length = fmin(length, 2.0 * solid->arc_pace);
    }
    for (int done = 0; done < most && point->fraction < 1.0;) {
        increment->from = increment->share = point->fraction;
        increment->arc_length = length;
        memcpy(solid->u, solid->committed, vector_bytes(solid));
        solid->loads = solid->committed_loads;
        const bool converged = find_equilibrium(solid, increment, true);
        point->iterations += solid->iterations;
        if (!converged) {
            revert(solid);
            point->cutbacks++;
            length *= 0.5;
            if (length < shortest_arc * move->arc_length) {
                finish(solid, point, WB_SOLID_NOT_CONVERGED);
                return;
            }
            continue;
        }
        const bool unstable = is_unstable(solid, increment);
        if (!unstable && increment->share > 1.0 + max_overshoot &&
            length >= shortest_arc * move->arc_length) {
            /* Do not exceed the target loads: unloading from there would change the plastic
             * history. */
            length *= fmax(0.1, (1.0 - increment->from) / (increment->share - increment->from));
            revert(solid);
            continue;
        }
        solid->unstable = unstable;
        accept(solid, increment);
        increment->last_direction = solid->last_change;
        point->fraction = increment->share;
        point->increments++;
        done++;
        solid->arc_pace = length;
        length = fmin(move->arc_length, 2.0 * length);
        solid->on_arc = true;
        solid->arc_target = move->target;
        if (!observe(move, point->fraction, solid->iterations)) {
            finish(solid, point, WB_SOLID_STOPPED);
            return;
        }
    }
    finish(solid, point, WB_SOLID_CONVERGED);
}

static bool is_finite(const struct wb_solid_move *move)
{
    const union loads target = {move->target};
    double sum = move->deflection;
    for (int i = 0; i < LOADS; i++)
        sum += target.value[i];
    return isfinite(sum);
}

enum wb_status wb_solid_move(struct wb_solid *solid, const struct wb_solid_move *move,
                             struct wb_solid_point *point)
{
    if (!is_finite(move))
        return wb_fail(WB_ERR_ARGUMENT, "a load or deflection is not a finite number");
    if (move->control != WB_SOLID_LOADS && solid->tip.n_nodes == 0)
        return wb_fail(WB_ERR_ARGUMENT,
                       "a mesh without tip faces cannot have tip loads or controls");
    if (move->control == WB_SOLID_ARC &&
        !(move->arc_length > 0.0 && move->target.supports == solid->committed_loads.supports))
        return wb_fail(WB_ERR_ARGUMENT, "arc control needs an arc_length above 0, and "
                                        "supports that do not move");

    struct increment increment = {
        .move = move,
        .start = solid->committed_loads,
        .start_deflection = deflection_of(solid, solid->committed),
    };
    *point = (struct wb_solid_point){0};
    solid->problem[0] = '\0';
    if (move->control == WB_SOLID_ARC)
        move_by_arc(solid, &increment, point);
    else
        move_by_shares(solid, &increment, point);
    return WB_OK;
}

int wb_solid_unknowns(const struct wb_solid *solid)
{
    return solid->body.n_equations;
}

const struct wb_solid_loads *wb_solid_loads(const struct wb_solid *solid)
{
    return &solid->committed_loads;
}

void wb_solid_tip(const struct wb_solid *solid, struct wb_solid_tip *tip)
{
    double z[Z];

    *tip = (struct wb_solid_tip){0};
    if (solid->tip.n_nodes == 0)
        return;
    wb_solid_tip_motion(&solid->tip, solid->body.mesh, solid->committed, z);
    memcpy(tip->position, z, sizeof tip->position);
    wb_solid_tip_frame(z, tip->frame);
}

const double *wb_solid_displacement(const struct wb_solid *solid)
{
    return solid->committed;
}

const double *wb_solid_internal_force(const struct wb_solid *solid)
{
    return solid->committed_force;
}

void wb_solid_balance(const struct wb_solid *solid, struct wb_solid_balance *balance)
{
    *balance = solid->balance;
}

void wb_solid_nodal_stress(const struct wb_solid *solid, int e, double stress[20][6],
                           double plastic[20])
{
    const struct wb_solid_body *body = &solid->body;
    const struct wb_solid_mesh *mesh = body->mesh;
    double u[WB_HEX20_UNKNOWNS];

    for (int k = 0; k < WB_HEX20_NODES; k++)
        memcpy(u + 3 * k, solid->committed + 3 * mesh->element[e][k], 3 * sizeof *u);
    wb_hex20_nodal_stress(&body->geometry[e], body->integration,
                          &body->parts[mesh->part[e]].material, u,
                          body->committed + (size_t)e * (size_t)body->n_points, stress, plastic);
}
