#include "fe/rod/rod_solver.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/interpolate.h"
#include "base/memory.h"
#include "fe/linear/banded.h"
#include "fe/linear/signature.h"

#define WB_LOG_DOMAIN "rod solver"

enum {
    TIP = 6,
    MAX_UNKNOWNS = 7, /* six of the tip, and the tension */
    N_CONTROLS = 12
};

/* Newton iterations are scaled down so that no node rotates by more than this, rad. */
static const double max_iteration_rotation = 0.5;

/* An increment fails after this many iterations, or this many scaled-down ones. */
static const int max_iterations = 25, max_scaled_down = 3;

/* Largest residual over the largest internal force. */
static const double force_tolerance = 1e-9;

/* Smallest increment as a fraction of the move. */
static const double smallest_increment = 1e-5;

/* Why an increment failed. */
enum failure {
    NONE,
    ITERATIONS,
    NOT_FINITE,
    TURNED,  /* a section rotated farther than an increment may */
    CRITICAL /* the equilibrium is unstable */
};

/* Diagnostics of the last evaluation with finite values. */
struct found {
    double residual; /* relative */
    double place;    /* arc length of the largest residual, m */
    int yielding;    /* number of fibres */
};

/* One equilibrium to solve for. */
struct step {
    enum wb_rod_control control;
    struct wb_rod_loads loads; /* the tension is an unknown for WB_ROD_DEFLECTION */
    double deflection;
    bool slack;
};

struct wb_rod_solver {
    struct wb_rod_solver_model model;
    double scale_force;

    /* The last equilibrium. */
    struct wb_rod_loads loads;
    double deflection; /* the controlled value, also while the strand is slack */
    bool slack;
    double change[N_CONTROLS]; /* change in the last increment; see control_change() */
    double turn;               /* largest rotation of a section in the last increment, rad */
    double fraction;           /* size of the last increment as a fraction of its move */

    /* The trial state. */
    struct wb_rod_loads trial;
    struct wb_rod_balance balance;
    double trial_turn; /* largest rotation of a section, rad */
    double residual;   /* relative, of the last check */
    double tolerance;  /* absolute, of the last check, N */
    int iterations;
    enum failure failure;
    struct found found;
};

enum wb_status wb_rod_solver_create(struct wb_rod_solver **out,
                                    const struct wb_rod_solver_model *model)
{
    *out = NULL;
    if (!(isfinite(model->length) && model->length > 0.0))
        return wb_fail(WB_ERR_ARGUMENT, "length %g m: expected a number above 0", model->length);
    if (!(isfinite(model->strand_length) && model->strand_length >= 0.0 &&
          isfinite(model->strand_x)))
        return wb_fail(WB_ERR_ARGUMENT,
                       "the strand is %g m long at x = %g m: expected a length of 0 or more",
                       model->strand_length, model->strand_x);

    struct wb_rod_solver *const solver = wb_memory_new(1, sizeof *solver);
    solver->model = *model;
    if (model->most_rotation == 0.0)
        solver->model.most_rotation = 0.25;
    solver->scale_force = wb_rod_scale_force(model->rod);
    solver->fraction = 1.0;
    *out = solver;
    return WB_OK;
}

void wb_rod_solver_destroy(struct wb_rod_solver *solver)
{
    free(solver);
}

void wb_rod_solver_reset(struct wb_rod_solver *solver)
{
    wb_rod_reset(solver->model.rod);
    solver->loads = solver->trial = (struct wb_rod_loads){0};
    memset(solver->change, 0, sizeof solver->change);
    solver->turn = 0.0;
    solver->deflection = 0.0;
    solver->slack = false;
    solver->fraction = 1.0;
}

/* Direction of the tension and its derivatives with respect to the tip's x and z. */
struct strand {
    double direction[3], by_x[3], by_z[3];
};

/* Not finite if the tip's lateral distance exceeds the strand's length. */
static struct strand strand_at(const struct wb_rod_solver *s)
{
    const double S = s->model.strand_length;
    if (S == 0.0)
        return (struct strand){.direction = {0.0, 1.0, 0.0}};
    const double *tip = wb_rod_tip(s->model.rod)->position;
    const double p = (s->model.strand_x - tip[0]) / S, q = -tip[2] / S;
    const double up = sqrt(1.0 - p * p - q * q);
    return (struct strand){
        .direction = {p, up, q},
        .by_x = {-1.0 / S, p / (S * up), 0.0},
        .by_z = {0.0, q / (S * up), -1.0 / S},
    };
}

/* The follower force in space axes. */
static void follower(const struct wb_rod_solver *s, double force[3])
{
    const double *f = s->trial.tip.follower;
    double R[9];
    wb_rod_element_matrix(wb_rod_tip(s->model.rod)->rotation, R);
    for (int i = 0; i < 3; i++)
        force[i] = R[3 * i] * f[0] + R[3 * i + 1] * f[1] + R[3 * i + 2] * f[2];
}

/* Unbalanced forces at the tip: internal minus applied. */
static void tip_balance(const struct wb_rod_solver *s, const struct strand *strand, double r[TIP])
{
    double turned[3];
    follower(s, turned);
    for (int i = 0; i < 3; i++) {
        r[i] = s->balance.tip[i] - s->trial.tip.force[i] - turned[i] -
               s->trial.tension * strand->direction[i];
        r[3 + i] = s->balance.tip[3 + i] - s->trial.tip.moment[i];
    }
}

static bool is_held(const struct step *step)
{
    return step->control == WB_ROD_DEFLECTION && !step->slack;
}

/* Distance between the prescribed and the actual deflection; 0 if the tip is not prescribed. */
static double deflection_error(const struct wb_rod_solver *s, const struct step *step)
{
    return is_held(step) ? step->deflection - wb_rod_tip(s->model.rod)->position[1] : 0.0;
}

/* Evaluates the trial state; true if it is an equilibrium. `r` receives the tip's unbalanced
 * forces. */
static bool check_balance(struct wb_rod_solver *s, const struct step *step, struct strand *strand,
                          double r[TIP])
{
    const double lever = 1.0 / s->model.length;
    wb_rod_evaluate(s->model.rod, s->trial.weight, &s->balance);
    *strand = strand_at(s);
    tip_balance(s, strand, r);

    double at_tip = 0.0;
    for (int i = 0; i < 3; i++)
        at_tip += fabs(r[i]) + lever * fabs(r[3 + i]);
    const double unbalanced = s->balance.largest_residual + at_tip;
    const double scale = s->balance.largest_force + 1e-6 * s->scale_force;
    if (at_tip > s->balance.largest_residual)
        s->balance.worst_place = s->model.length;

    s->residual = unbalanced / scale;
    if (isfinite(s->residual))
        s->found = (struct found){s->residual, s->balance.worst_place, s->balance.yielding};
    s->tolerance = force_tolerance * scale + wb_rod_noise(s->model.rod);
    return unbalanced <= s->tolerance && fabs(deflection_error(s, step)) <= 1e-11 * s->model.length;
}

/* The tip's linear system: condensed rod, stiffness of the loads, and a row and column for an
 * unknown tension. Returns the number of unknowns. */
static int tip_system(struct wb_rod_solver *s, const struct step *step, const struct strand *strand,
                      double A[MAX_UNKNOWNS * MAX_UNKNOWNS], double b[MAX_UNKNOWNS])
{
    enum {
        W = MAX_UNKNOWNS
    };
    const double T = s->trial.tension;
    double K[TIP * TIP], right[TIP], r[TIP], f[3];

    wb_rod_condense(s->model.rod, K, right);
    /* `right` contains only the rod's residual; subtract the tip's applied loads. */
    tip_balance(s, strand, r);
    follower(s, f);
    for (int i = 0; i < TIP; i++) {
        for (int j = 0; j < TIP; j++)
            A[i * W + j] = K[TIP * i + j];
        b[i] = right[i] - (r[i] - s->balance.tip[i]);
    }
    for (int i = 0; i < 3; i++) {
        A[i * W] -= T * strand->by_x[i];
        A[i * W + 2] -= T * strand->by_z[i];
    }
    A[4] -= f[2];
    A[5] += f[1];
    A[W + 3] += f[2];
    A[W + 5] -= f[0];
    A[2 * W + 3] -= f[1];
    A[2 * W + 4] += f[0];
    if (!is_held(step))
        return TIP;

    for (int j = 0; j < W; j++)
        A[TIP * W + j] = A[j * W + TIP] = 0.0;
    for (int i = 0; i < 3; i++)
        A[i * W + TIP] = -strand->direction[i];
    A[TIP * W + 1] = 1.0;
    b[TIP] = deflection_error(s, step);
    return TIP + 1;
}

/* Newton's method from the trial state; true if it converged. A scaled-down iteration indicates
 * that the increment is too long: after a few of them give up, because a shorter increment is
 * cheaper. */
static bool iterate(struct wb_rod_solver *s, const struct step *step)
{
    struct strand strand;
    double r[TIP];
    int scaled_down = 0;

    for (int iteration = 0;; iteration++) {
        if (check_balance(s, step, &strand, r))
            return true;
        s->failure = isfinite(s->residual) ? ITERATIONS : NOT_FINITE;
        if (iteration == max_iterations || scaled_down == max_scaled_down ||
            s->failure == NOT_FINITE)
            return false;

        double A[MAX_UNKNOWNS * MAX_UNKNOWNS], b[MAX_UNKNOWNS];
        const int n = tip_system(s, step, &strand, A, b);
        wb_banded_solve_small(n, MAX_UNKNOWNS, A, b);
        const double scale = wb_rod_advance(s->model.rod, b, max_iteration_rotation);
        scaled_down += scale < 1.0;
        if (is_held(step))
            s->trial.tension += scale * b[TIP];
        s->iterations++;
    }
}

/* The change of loads and deflection in a step, in comparable units. */
static void control_change(const struct wb_rod_solver *s, const struct step *step,
                           double change[N_CONTROLS])
{
    const struct wb_rod_loads *to = &step->loads, *from = &s->loads;
    const double scale = 1.0 / s->scale_force, lever = 1.0 / s->model.length;

    for (int i = 0; i < 3; i++) {
        change[i] = scale * (to->tip.force[i] - from->tip.force[i]);
        change[3 + i] = scale * lever * (to->tip.moment[i] - from->tip.moment[i]);
        change[6 + i] = scale * (to->tip.follower[i] - from->tip.follower[i]);
    }
    const bool driven = step->control == WB_ROD_DEFLECTION;
    change[9] = to->weight - from->weight;
    change[10] = driven ? 0.0 : scale * (to->tension - from->tension);
    change[11] = driven ? lever * (step->deflection - s->deflection) : 0.0;
}

/* Factor by which to extrapolate the last two states to the step; 0 if the step changes direction,
 * reverses, or is much longer than the last one. */
static double extrapolation(const struct wb_rod_solver *s, const struct step *step)
{
    double change[N_CONTROLS], along = 0.0, square = 0.0, aside = 0.0;

    control_change(s, step, change);
    for (int i = 0; i < N_CONTROLS; i++) {
        along += change[i] * s->change[i];
        square += s->change[i] * s->change[i];
    }
    if (square == 0.0 || step->slack != s->slack)
        return 0.0;
    const double ratio = along / square;
    for (int i = 0; i < N_CONTROLS; i++)
        aside += pow(change[i] - ratio * s->change[i], 2.0);
    return ratio > 0.0 && ratio <= 4.0 && aside <= 1e-12 * ratio * ratio * square ? ratio : 0.0;
}

static void start_loads(struct wb_rod_solver *s, const struct step *step)
{
    s->trial = step->loads;
    if (step->control == WB_ROD_DEFLECTION)
        s->trial.tension = step->slack ? 0.0 : s->loads.tension;
}

/* True if no section rotates farther in the converged step than an increment may. */
static bool rotation_is_allowed(struct wb_rod_solver *s)
{
    s->trial_turn = wb_rod_turn(s->model.rod);
    if (s->trial_turn <= s->model.most_rotation)
        return true;
    s->failure = TURNED;
    return false;
}

/* Solves the step for a given state of the strand: first from the extrapolated state, then from the
 * last equilibrium. */
static bool solve_mode(struct wb_rod_solver *s, const struct step *step)
{
    const double ratio = extrapolation(s, step);

    if (ratio > 0.0) {
        start_loads(s, step);
        wb_rod_extrapolate(s->model.rod, ratio);
        if (iterate(s, step))
            return rotation_is_allowed(s);
    }
    start_loads(s, step);
    wb_rod_revert(s->model.rod);
    return iterate(s, step) && rotation_is_allowed(s);
}

/* Solves the step and determines whether the strand is taut or slack: a taut strand cannot push,
 * and a slack strand cannot hold the tip below the prescribed deflection. */
static bool solve_with_strand(struct wb_rod_solver *s, struct step *step)
{
    const bool unilateral = s->model.strand_length > 0.0 && step->control == WB_ROD_DEFLECTION;
    step->slack = s->slack && (unilateral || step->loads.tension == 0.0);
    for (int attempt = 0; attempt < 2; attempt++) {
        if (!solve_mode(s, step)) {
            if (!unilateral || s->failure == TURNED)
                return false;
        } else if (!unilateral) {
            return true;
        } else if (step->slack) {
            const double y = wb_rod_tip(s->model.rod)->position[1];
            if (!(y < step->deflection - 1e-7 * s->model.length))
                return true;
        } else if (!(s->trial.tension < -10.0 * s->tolerance)) {
            return true;
        }
        step->slack = !step->slack;
    }
    return false;
}

/* Degrees of freedom of the tip, as columns: all six, or the five perpendicular to a tension that
 * prescribes the deflection. */
static int tip_freedoms(const struct step *step, const struct strand *strand,
                        double change[TIP][TIP])
{
    const double *d = strand->direction;
    int n = 0;

    memset(change, 0, TIP * sizeof change[0]);
    if (is_held(step)) {
        /* Two vectors perpendicular to d, whose y component dominates unless the strand is nearly
         * horizontal. */
        const double length = hypot(d[0], d[1]);
        const double first[3] = {d[1] / length, -d[0] / length, 0.0};
        for (int i = 0; i < 3; i++)
            change[i][0] = first[i];
        change[0][1] = d[1] * first[2] - d[2] * first[1];
        change[1][1] = d[2] * first[0] - d[0] * first[2];
        change[2][1] = d[0] * first[1] - d[1] * first[0];
        n = 2;
    } else {
        for (; n < 3; n++)
            change[n][n] = 1.0;
    }
    for (int i = 3; i < TIP; i++)
        change[i][n++] = 1.0;
    return n;
}

/* True if the loads have a potential. Follower forces, moments, and a given tension along an
 * inclined strand do not. */
static bool is_conservative(const struct wb_rod_solver *s, const struct step *step)
{
    double others = 0.0;
    for (int i = 0; i < 3; i++)
        others += fabs(s->trial.tip.follower[i]) + fabs(s->trial.tip.moment[i]);
    if (s->model.strand_length > 0.0 && !is_held(step))
        others += fabs(s->trial.tension);
    return others == 0.0;
}

/* True if the equilibrium is stable under its control. The tangent is computed at the state itself,
 * because equilibria of a straight strut need no iteration. */
static bool is_stable(struct wb_rod_solver *s, const struct step *step)
{
    const struct strand strand = strand_at(s);
    double A[MAX_UNKNOWNS * MAX_UNKNOWNS], b[MAX_UNKNOWNS], change[TIP][TIP], own[TIP][TIP] = {{0}};

    tip_system(s, step, &strand, A, b);
    const int n = tip_freedoms(step, &strand, change), inner = wb_rod_negative(s->model.rod);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            for (int k = 0; k < TIP * TIP; k++)
                own[i][j] +=
                    change[k / TIP][i] * A[k / TIP * MAX_UNKNOWNS + k % TIP] * change[k % TIP][j];
        }
    }
    const bool stable = is_conservative(s, step)
                            ? inner + wb_signature_negative(n, TIP, own[0]) == 0
                            : (inner % 2 != 0) == wb_signature_is_odd(n, TIP, own[0]);
    if (!stable)
        s->failure = CRITICAL;
    return stable;
}

static void accept(struct wb_rod_solver *s, const struct step *step)
{
    control_change(s, step, s->change);
    if (step->slack != s->slack)
        memset(s->change, 0, sizeof s->change);
    s->turn = s->trial_turn;
    s->loads = s->trial;
    s->slack = step->slack;
    s->deflection = step->control == WB_ROD_DEFLECTION ? step->deflection
                                                       : wb_rod_tip(s->model.rod)->position[1];
    wb_rod_commit(s->model.rod);
}

/* The increment from `done` that rotates sections by 80 % of the limit, assuming that rotation is
 * proportional to the change of the controls as in the last increment; the rest of the move is
 * divided into equal increments of about this size. */
static double choose_increment(const struct wb_rod_solver *s, const struct wb_rod_move *move,
                               double done)
{
    const struct step rest = {
        .control = move->control, .loads = move->target, .deflection = move->deflection};
    double change[N_CONTROLS], square = 0.0, last = 0.0;
    control_change(s, &rest, change);
    for (int i = 0; i < N_CONTROLS; i++) {
        square += change[i] * change[i];
        last += s->change[i] * s->change[i];
    }
    if (last == 0.0 || square == 0.0)
        return 1.0;
    const double turn = s->turn * sqrt(square / last);
    return (1.0 - done) / fmax(1.0, ceil(turn / (0.8 * s->model.most_rotation)));
}

static bool are_finite(const struct wb_rod_move *move)
{
    const struct wb_rod_loads *t = &move->target;
    double sum = t->weight + (move->control == WB_ROD_DEFLECTION ? move->deflection : t->tension);
    for (int i = 0; i < 3; i++)
        sum += t->tip.force[i] + t->tip.moment[i] + t->tip.follower[i];
    return isfinite(sum);
}

static void describe_problem(const struct wb_rod_solver *s, double fraction,
                             struct wb_rod_result *result)
{
    if (s->failure == TURNED) {
        snprintf(result->problem, sizeof result->problem,
                 "a section rotates by more than %.2g rad in an increment of %.1g of the move: no "
                 "equilibrium nearby",
                 s->model.most_rotation, fraction);
        return;
    }
    if (s->failure == CRITICAL) {
        snprintf(result->problem, sizeof result->problem,
                 "a critical point lies within %.1g of the move: a limit load or a buckling load, "
                 "beyond which no equilibrium is stable",
                 fraction);
        return;
    }
    snprintf(
        result->problem, sizeof result->problem,
        "the iteration %s with increments of %.1g of the move; unbalanced forces are %.1g of the "
        "largest force, with the maximum at s = %.1f mm; %d fibres yield",
        s->failure == NOT_FINITE ? "diverges" : "does not converge", fraction, s->found.residual,
        s->found.place * 1e3, s->found.yielding);
}

/* Returns to the last equilibrium and evaluates it. */
static void return_to_last(struct wb_rod_solver *s)
{
    wb_rod_revert(s->model.rod);
    s->trial = s->loads;
    wb_rod_evaluate(s->model.rod, s->loads.weight, &s->balance);
}

enum wb_status wb_rod_solver_move(struct wb_rod_solver *s, const struct wb_rod_move *move,
                                  struct wb_rod_result *result)
{
    *result = (struct wb_rod_result){.end = WB_ROD_CONVERGED};
    if (!are_finite(move))
        return wb_fail(WB_ERR_ARGUMENT, "a load or deflection is not a finite number");

    const struct wb_rod_loads from = s->loads;
    const double start = s->deflection;
    double fraction = fmin(1.0, 4.0 * s->fraction);
    bool failed = false;

    while (result->fraction < 1.0) {
        fraction = fmin(fraction, choose_increment(s, move, result->fraction));
        const double next =
            result->fraction + fraction > 1.0 - 1e-9 ? 1.0 : result->fraction + fraction;
        struct step step = {
            .control = move->control,
            .loads = {.weight = wb_interpolate(from.weight, move->target.weight, next),
                      .tip = wb_trial_loads_between(&from.tip, &move->target.tip, next),
                      .tension = wb_interpolate(from.tension, move->target.tension, next)},
            .deflection = wb_interpolate(start, move->deflection, next),
        };
        s->iterations = 0;
        const bool stable = solve_with_strand(s, &step) && is_stable(s, &step);
        result->iterations += s->iterations;
        result->residual = s->residual;
        if (stable) {
            accept(s, &step);
            s->fraction = fraction;
            result->fraction = next;
            result->increments++;
            fraction = fmin(1.0, failed ? fraction : 2.0 * fraction);
            failed = false;
            if (move->observer && !move->observer(move->context, next, s->iterations)) {
                result->end = WB_ROD_STOPPED;
                return WB_OK;
            }
            continue;
        }
        failed = true;
        result->cutbacks++;
        fraction *= 0.5;
        if (fraction < smallest_increment) {
            result->end = WB_ROD_NOT_CONVERGED;
            describe_problem(s, 2.0 * fraction, result);
            return_to_last(s);
            break;
        }
    }
    return WB_OK;
}

const struct wb_rod_loads *wb_rod_solver_loads(const struct wb_rod_solver *solver)
{
    return &solver->loads;
}

bool wb_rod_solver_is_slack(const struct wb_rod_solver *solver)
{
    return solver->slack;
}

double wb_rod_solver_deflection(const struct wb_rod_solver *solver)
{
    return solver->deflection;
}

double wb_rod_solver_vertical_force(const struct wb_rod_solver *solver)
{
    return solver->loads.tension * strand_at(solver).direction[1];
}
