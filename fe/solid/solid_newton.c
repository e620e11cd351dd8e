#include <lapacke.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "fe/solid/solid_private.h"

enum {
    Z = WB_SOLID_TIP_UNKNOWNS,
    TENSION = Z, /* unknowns and equations beside z */
    SHARE = Z + 1,
    ALL = Z + 2
};

/* A relative residual below which the last factorisation is used again, and what it must bring. */
static const double close_by = 1e-2;
static const double good_reduction = 0.2;

/* Share of the tolerance that a state is within before the first iteration. */
static const double at_start = 1e-3;

/* An iteration turns the tip by no more than this. */
static const double most_turn = 0.5;

/* Forces below this share of the largest ever met count as none. */
static const double small_force = 1e-3;

/* What a Newton step changes besides the displacements. */
struct step {
    double z[Z];
    double tension, share;
};

struct wb_solid_loads wb_solid_loads_at(const struct wb_solid_increment *increment, double share,
                                        double tension)
{
    const struct wb_solid_loads *a = &increment->start, *b = &increment->move->target;
    struct wb_solid_loads at = {
        .weight = a->weight + share * (b->weight - a->weight),
        .supports = a->supports + share * (b->supports - a->supports),
        .nodal = a->nodal + share * (b->nodal - a->nodal),
        .tension = a->tension + share * (b->tension - a->tension),
    };
    for (int i = 0; i < 3; i++) {
        at.tip.force[i] = a->tip.force[i] + share * (b->tip.force[i] - a->tip.force[i]);
        at.tip.moment[i] = a->tip.moment[i] + share * (b->tip.moment[i] - a->tip.moment[i]);
        at.tip.follower[i] = a->tip.follower[i] + share * (b->tip.follower[i] - a->tip.follower[i]);
    }
    if (increment->move->control == WB_SOLID_DEFLECTION)
        at.tension = tension;
    return at;
}

/* How the loads grow with the share. */
static struct wb_solid_loads rate_of_loads(const struct wb_solid_increment *increment)
{
    const struct wb_solid_loads a = wb_solid_loads_at(increment, 0.0, 0.0);
    struct wb_solid_loads rate = wb_solid_loads_at(increment, 1.0, 0.0);

    rate.weight -= a.weight;
    rate.supports -= a.supports;
    rate.nodal -= a.nodal;
    rate.tension -= a.tension;
    for (int i = 0; i < 3; i++) {
        rate.tip.force[i] -= a.tip.force[i];
        rate.tip.moment[i] -= a.tip.moment[i];
        rate.tip.follower[i] -= a.tip.follower[i];
    }
    return rate;
}

static double *column(const struct wb_solid *solid, int c)
{
    return solid->right + (size_t)c * (size_t)solid->body.n_equations;
}

/* Puts the forces of the body (weight, nodal forces) times factors into a column, or adds them. */
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

/* z's rate for a column of displacements (equations): the patterns' transpose. */
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

/* Loads less internal forces of the trial state into the first column; the relative residual. */
static void unbalance(struct wb_solid *solid)
{
    const struct wb_solid_body *body = &solid->body;
    double *right = column(solid, WB_SOLID_COLUMN_RESIDUAL);
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
        largest = fmax(largest, fabs(right[q])); /* a first step's loads, not yet carried */
        right[q] -= body->force[i];
        if (!(fabs(right[q]) <= worst) && !isnan(worst)) {
            worst = fabs(right[q]);
            solid->worst_node = i / 3;
        }
    }
    const double scale = fmax(largest, small_force * solid->largest_force);
    solid->residual = scale > 0.0 ? worst / scale : 0.0;
}

/* Forces, and with `stiffness` the factored tangent with its answers to the tip's loads. */
static bool evaluate(struct wb_solid *solid, const struct wb_solid_increment *increment,
                     bool stiffness, bool change_supports)
{
    struct wb_solid_body *body = &solid->body;

    if (change_supports) {
        memset(solid->held_force, 0, 3 * (size_t)body->mesh->n_nodes * sizeof *solid->held_force);
        wb_solid_body_evaluate_held(body, solid->u, solid->held, solid->held_force, &solid->found);
    } else {
        wb_solid_body_evaluate(body, solid->u, stiffness, &solid->found);
    }
    if (!solid->found.possible)
        return false;
    unbalance(solid);
    for (int i = 0; change_supports && i < 3 * body->mesh->n_nodes; i++)
        if (body->equation[i] >= 0)
            column(solid, WB_SOLID_COLUMN_RESIDUAL)[body->equation[i]] -= solid->held_force[i];
    if (!stiffness)
        return isfinite(solid->residual);

    struct wb_layered_pivots pivots;
    wb_layered_factor(body->tangent, &pivots);
    solid->negative_pivots = pivots.negative;
    if (pivots.singular)
        return false;
    if (increment->move->control == WB_SOLID_ARC) {
        const struct wb_solid_loads rate = rate_of_loads(increment);
        double *right = column(solid, WB_SOLID_COLUMN_LOADS);
        memset(right, 0, (size_t)body->n_equations * sizeof *right);
        add_body_loads(solid, rate.weight, rate.nodal, right);
        wb_layered_solve(body->tangent, 1, right);
    }
    if (solid->tip.n_nodes > 0) {
        double *right = column(solid, WB_SOLID_COLUMN_TIP);
        memset(right, 0, Z * (size_t)body->n_equations * sizeof *right);
        for (int k = 0; k < Z; k++) {
            double unit[Z] = {0};
            unit[k] = 1.0;
            add_tip_loads(solid, unit, column(solid, WB_SOLID_COLUMN_TIP + k));
        }
        wb_layered_solve_last(body->tangent, Z, right);
        for (int k = 0; k < Z; k++)
            tip_motion_of(solid, column(solid, WB_SOLID_COLUMN_TIP + k), solid->compliance + Z * k);
    }
    return isfinite(solid->residual);
}

/* Length of a change of z, m: the way of the tip and the turning of its frame. */
static double length_of(const struct wb_solid *solid, const double change[Z])
{
    double sum = 0.0;
    for (int i = 0; i < Z; i++) {
        const double part = i < 3 ? change[i] : solid->tip.radius * change[i];
        sum += part * part;
    }
    return sqrt(sum);
}

/* The equations of z, tension and share in one small matrix. `A` is column-major. */
static void tip_equations(const struct wb_solid *solid, const struct wb_solid_increment *increment,
                          double *A, double *b)
{
    const double *C = solid->compliance; /* symmetric but for friction; row k: answer to load k */
    const enum wb_solid_control control = increment->move->control;
    double z[Z], along[Z], rate_phi[Z] = {0}, rate_body[Z] = {0};

    wb_solid_tip_motion(&solid->tip, solid->body.mesh, solid->u, z);
    wb_solid_tip_tension(z, &solid->strand, along);
    if (control == WB_SOLID_ARC) {
        const struct wb_solid_loads rate = rate_of_loads(increment);
        wb_solid_tip_forces(z, &rate.tip, &solid->strand, rate.tension, rate_phi, NULL);
        tip_motion_of(solid, column(solid, WB_SOLID_COLUMN_LOADS), rate_body);
    }
    tip_motion_of(solid, column(solid, WB_SOLID_COLUMN_RESIDUAL), b);
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

/* The arc's equation: a first step of unit share, to be scaled, then its linearised length. */
static void arc_equation(const struct wb_solid *solid, const struct wb_solid_increment *increment,
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

/* Scales the first step of an arc to its length, forwards. */
static void scale_first(const struct wb_solid *solid, const struct wb_solid_increment *increment,
                        double *x)
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

/* The Newton step of the whole system; the displacements' into solid->step. */
static bool solve_step(struct wb_solid *solid, const struct wb_solid_increment *increment,
                       bool first, struct step *step)
{
    const struct wb_solid_body *body = &solid->body;
    double *x = column(solid, WB_SOLID_COLUMN_RESIDUAL);
    double coefficient[WB_SOLID_COLUMNS] = {1.0};

    /* An arc sets out along the path alone: next to a critical point what is left of the residual
     * would lead far away, and it is not scaled to the arc's length. */
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
            coefficient[WB_SOLID_COLUMN_LOADS] = step->share;
        }
        for (int k = 0; k < Z; k++) {
            double *c = &coefficient[WB_SOLID_COLUMN_TIP + k];
            *c = along[k] * step->tension + rate_phi[k] * step->share;
            for (int j = 0; j < Z; j++)
                *c += solid->tip_derivative[Z * k + j] * step->z[j];
        }
    }

    memset(solid->step, 0, 3 * (size_t)body->mesh->n_nodes * sizeof *solid->step);
    for (int c = 0; c < WB_SOLID_COLUMNS; c++) {
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

/* The trial state at `scale` times the step from solid->base. */
static void take_step(struct wb_solid *solid, struct wb_solid_increment *increment,
                      const struct step *step, const struct wb_solid_loads *loads, double share,
                      double scale)
{
    const size_t bytes = 3 * (size_t)solid->body.mesh->n_nodes * sizeof *solid->u;

    memcpy(solid->u, solid->base, bytes);
    wb_solid_update_advance(&solid->update, solid->u, solid->step, scale);
    if (increment->move->control == WB_SOLID_ARC)
        increment->share = share + scale * step->share;
    solid->loads =
        wb_solid_loads_at(increment, increment->share, loads->tension + scale * step->tension);
    set_supports(solid);
    if (solid->tip.n_nodes > 0) {
        double before[Z], now[Z];
        wb_solid_tip_motion(&solid->tip, solid->body.mesh, solid->committed, before);
        wb_solid_tip_motion(&solid->tip, solid->body.mesh, solid->u, now);
        for (int i = 0; i < Z; i++)
            increment->change[i] = now[i] - before[i];
    }
}

bool wb_solid_newton_unstable(const struct wb_solid *solid,
                              const struct wb_solid_increment *increment)
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
    return turn > most_turn ? most_turn / turn : 1.0;
}

/* Takes the step, shortened where it leads to an impossible state or, past the first iteration, to
 * a much larger residual. */
static bool search_line(struct wb_solid *solid, struct wb_solid_increment *increment,
                        const struct step *step, bool stiffness, bool guard)
{
    const struct wb_solid_loads loads = solid->loads;
    const double share = increment->share, before = solid->residual;
    double scale = first_scale(step);

    memcpy(solid->base, solid->u, 3 * (size_t)solid->body.mesh->n_nodes * sizeof *solid->u);
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

/* Where the imbalance is largest, in words. */
static void describe(struct wb_solid *solid, const char *what)
{
    const double *X = solid->body.mesh->node[solid->worst_node];

    if (!solid->found.possible && solid->found.worst_element >= 0) {
        const int node = solid->body.mesh->element[solid->found.worst_element][0];
        snprintf(solid->problem, sizeof solid->problem,
                 "element %d at %.4g mm along the wire is turned inside out (after %d iterations)",
                 solid->found.worst_element, solid->body.mesh->node[node][0] / WB_MM,
                 solid->iterations);
        return;
    }
    snprintf(solid->problem, sizeof solid->problem,
             "%s: after %d iterations the relative residual is %.2g, largest at (%.4g, %.4g, %.4g) "
             "mm",
             what, solid->iterations, solid->residual, X[0] / WB_MM, X[1] / WB_MM, X[2] / WB_MM);
}

static bool has_converged(const struct wb_solid *solid, const struct wb_solid_increment *increment)
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

/* Prepares solid->held: how the held components must still move. */
static bool supports_change(struct wb_solid *solid)
{
    bool any = false;

    memset(solid->held, 0, 3 * (size_t)solid->body.mesh->n_nodes * sizeof *solid->held);
    for (int i = 0; i < solid->n_supports; i++) {
        const struct wb_solid_support *s = &solid->supports[i];
        const int at = 3 * s->node + s->axis;
        solid->held[at] = solid->loads.supports * s->displacement - solid->u[at];
        any = any || solid->held[at] != 0.0;
    }
    return any;
}

bool wb_solid_newton(struct wb_solid *solid, struct wb_solid_increment *increment, bool predicted)
{
    const bool arc = increment->move->control == WB_SOLID_ARC;
    bool fresh = true;

    solid->iterations = 0;
    memset(increment->change, 0, sizeof increment->change);
    const bool move_supports = !predicted && supports_change(solid);
    if (!evaluate(solid, increment, true, move_supports)) {
        describe(solid, "the tangent stiffness is singular");
        return false;
    }
    /* Many small imbalances of one sign are a load: a start is not taken for the end unless it is
     * far below the tolerance, as an iteration is cheap there. */
    const bool at_once =
        !arc && !move_supports && solid->residual <= at_start * solid->settings.force_tolerance;
    while (!has_converged(solid, increment) || (solid->iterations == 0 && !at_once)) {
        struct step step;
        const double before = solid->residual;
        if (solid->iterations++ == solid->settings.max_iterations) {
            describe(solid, "no convergence");
            return false;
        }
        const bool first = solid->iterations == 1;
        if (!solve_step(solid, increment, first, &step)) {
            describe(solid, "the tip's equations are singular");
            return false;
        }
        if (first && move_supports)
            for (int i = 0; i < 3 * solid->body.mesh->n_nodes; i++)
                solid->step[i] += solid->held[i];

        /* Near the end forces alone may show that it is there, and the old tangent still serves. */
        const bool near = before < close_by && !first;
        if (!search_line(solid, increment, &step, !near, !first)) {
            describe(solid, "no convergence");
            return false;
        }
        if (has_converged(solid, increment))
            break;
        if (near && (!fresh || solid->residual > good_reduction * before)) {
            if (!evaluate(solid, increment, true, false)) {
                describe(solid, "the tangent stiffness is singular");
                return false;
            }
            fresh = true;
        } else {
            fresh = !near;
        }
    }
    return true;
}
