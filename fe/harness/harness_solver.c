#include "fe/harness/harness_solver.h"
#include "fe/harness/harness_contact.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"

#define WB_LOG_DOMAIN "harness solver"

/* Newton iterations are scaled down so that no joint rotates by more than this, rad. */
static const double max_iteration_rotation = 0.5;

/* An increment fails after this many iterations, or this many scaled-down ones. */
static const int max_iterations = 20, max_scaled_down = 4;

/* Wires begin to slide or stop in clips where the largest residual is below this part of the
 * largest internal force; an increment fails after this many such changes, each of which begins the
 * iterations anew. */
static const double decides = 1e-6;
static const int max_changes = 20;
/* The forces of places that touch are taken as known where the largest residual is below these
 * parts of the largest internal force and of the largest of those. */
static const double knows = 1e-3, knows_contact = 1e-2;
/* A force that shifts between two places beside each other does so slowly: after some such changes
 * a larger gap is accepted. */
static const int slow_changes = 10;
static const double slow_ratio = 100.0;

/* Largest residual over the largest internal force; distance and rotation from a hold's target over
 * the length of the harness, and in rad. */
static const double force_tolerance = 1e-10, hold_tolerance = 1e-11, contact_tolerance = 1e-9;
/* The same for states on the way of a motion. */
static const double passing_force = 1e-6, passing_hold = 1e-8, passing_contact = 1e-6;

/* Smallest increment as a fraction of the move. */
static const double smallest_increment = 1e-4;

/* Motion against the drag. In the first step the drag has the stiffness of an element. A step is
 * chosen so that the fastest joint turns by `turn_part` of what an increment may, and by
 * `curve_part` of it from the line through the last two states; it grows by at most this ratio. A
 * drag below this fraction of the stiffness of the whole harness is left out. */
static const int max_steps = 2000;
static const double turn_part = 0.6, curve_part = 0.1, max_growth = 2.2, max_shrinkage = 0.3;
static const double last_drag = 1e-4;
/* Where a step turns by less than `slow_turn`, the state without drag is tried: the motion ends
 * there if that is within `rest_turn`; otherwise it is tried again when steps are longer. */
static const double slow_turn = 3e-3, rest_turn = 0.1, next_trial_ratio = 100.0;
/* The shortest step, in units of the first; a motion that needs a shorter one has failed. */
static const double least_step = 1e-9;

enum outcome {
    EQUILIBRIUM,
    ITERATIONS,
    NOT_FINITE,
    TURNED,   /* a joint rotated farther than an increment may */
    PASSED,   /* a wire passed through an obstacle */
    UNSTABLE, /* the equilibrium is unstable */
    STOPPED   /* by the observer */
};

struct wb_harness_solver {
    struct wb_harness *harness;
    double most_rotation;
    double length;            /* of all branches, m */
    double stiffest, softest; /* stiffness of an element and of the whole harness, N/m2 */
    double weight;            /* of the last equilibrium */
    int iterations;           /* of the last increment, since it was changed what touches */
    struct wb_rod_node *from, *before, *start; /* (joints) */
    double (*from_load)[6];                    /* (joints) */
    void *rest;                                /* state of the harness where a stable path ends */
    struct wb_memory memory;
};

enum wb_status wb_harness_solver_create(struct wb_harness_solver **out,
                                        const struct wb_harness_solver_model *model)
{
    *out = NULL;
    if (!(isfinite(model->most_rotation) && model->most_rotation >= 0.0))
        return wb_fail(WB_ERR_ARGUMENT, "largest rotation %g rad: expected above 0",
                       model->most_rotation);
    struct wb_harness_solver *const s = wb_memory_new(1, sizeof *s);
    const size_t joints = (size_t)wb_harness_n_joints(model->harness);
    s->harness = model->harness;
    s->most_rotation = model->most_rotation == 0.0 ? 0.1 : model->most_rotation;
    s->length = wb_harness_length(model->harness);
    wb_harness_stiffness(model->harness, &s->stiffest, &s->softest);
    s->from = wb_memory_take(&s->memory, joints, sizeof *s->from);
    s->start = wb_memory_take(&s->memory, joints, sizeof *s->start);
    s->before = wb_memory_take(&s->memory, joints, sizeof *s->before);
    s->from_load = wb_memory_take(&s->memory, joints, sizeof *s->from_load);
    s->rest = wb_memory_take(&s->memory, wb_harness_state_size(model->harness), 1);
    *out = s;
    return WB_OK;
}

void wb_harness_solver_destroy(struct wb_harness_solver *solver)
{
    if (!solver)
        return;
    wb_memory_release(&solver->memory);
    free(solver);
}

/* Iterates the trial state to an equilibrium under `weight` times the weight. Of a state on the way
 * (`passing`) the tolerance is larger, and its stiffness that of the iteration before. */
static enum outcome iterate(struct wb_harness_solver *s, double weight, bool passing,
                            struct wb_harness_result *result)
{
    const double part = passing ? passing_force : force_tolerance;
    const double apart = passing ? passing_hold : hold_tolerance;
    const double gap = passing ? passing_contact : contact_tolerance;
    struct wb_harness *const h = s->harness;
    int scaled_down = 0, changes = 0;
    struct wb_harness_balance balance;
    wb_harness_evaluate(h, weight, &balance);
    for (int i = 0;; i++) {
        const double tolerance = fmax(part * balance.largest_force, wb_harness_noise(h));
        result->residual = balance.largest_force > 0.0
                               ? balance.largest_residual / balance.largest_force
                               : balance.largest_residual;
        result->worst_joint = balance.worst_joint;
        if (!(isfinite(balance.largest_force) && isfinite(balance.largest_residual)))
            return NOT_FINITE;
        if (balance.largest_residual <= fmax(decides * balance.largest_force, tolerance) &&
            wb_harness_adapt(h) > 0) {
            if (++changes > max_changes)
                return ITERATIONS;
            i = scaled_down = 0;
            wb_harness_evaluate(h, weight, &balance);
        }
        const bool touches = balance.farthest_contact <=
                             gap * s->length * (changes < slow_changes ? 1.0 : slow_ratio);
        if (!touches &&
            balance.largest_residual <=
                fmax(fmin(knows * balance.largest_force, knows_contact * balance.largest_contact),
                     tolerance)) {
            if (wb_harness_turn(h) > 2.0 * s->most_rotation)
                return TURNED;
            if (++changes > max_changes)
                return ITERATIONS;
            i = scaled_down = 0;
            wb_harness_adapt_contacts(h);
            wb_harness_evaluate(h, weight, &balance);
        }
        const bool done = touches && balance.largest_residual <= tolerance &&
                          balance.farthest_hold <= apart * s->length &&
                          balance.farthest_turn <= apart;
        if (!(done && passing && i > 0))
            wb_harness_solve(h);
        if (done && wb_harness_negative(h) > 0)
            return UNSTABLE;
        if (done)
            return wb_harness_turn(h) > s->most_rotation ? TURNED
                   : wb_harness_passes_through(h)        ? PASSED
                                                         : EQUILIBRIUM;
        s->iterations = i + 1;
        if (i == max_iterations)
            return ITERATIONS;
        result->iterations++;
        if (wb_harness_advance(h, max_iteration_rotation, &balance) < 1.0 &&
            ++scaled_down > max_scaled_down)
            return ITERATIONS;
    }
}

static void remember(const struct wb_harness_solver *s, struct wb_rod_node *nodes)
{
    for (int j = 0; j < wb_harness_n_joints(s->harness); j++)
        nodes[j] = *wb_harness_node(s->harness, j);
}

/* Largest rotation of a joint from `before`, rad. */
static double turn_from_remembered(const struct wb_harness_solver *s)
{
    double largest = 0.0;
    for (int j = 0; j < wb_harness_n_joints(s->harness); j++) {
        double turn[3];
        wb_rod_element_turn_between(s->before[j].rotation, wb_harness_node(s->harness, j)->rotation,
                                    turn);
        largest = fmax(largest, wb_vec3_length(turn));
    }
    return largest;
}

/* Ratio of the next step to this one, by how far the fastest joint turned, and by how far from the
 * line through the last two states, which are in `before`. */
static double next_size(const struct wb_harness_solver *s)
{
    const double turn = wb_harness_turn(s->harness) / s->most_rotation;
    const double curve = turn_from_remembered(s) / s->most_rotation;
    return fmax(fmin(fmin(turn_part / turn, sqrt(curve_part / curve)), max_growth), max_shrinkage);
}

/* The joint that moved farthest from where it was at `start`. */
static struct wb_harness_snap measure_snap(const struct wb_harness_solver *s, double fraction)
{
    struct wb_harness_snap snap = {.fraction = fraction};
    for (int j = 0; j < wb_harness_n_joints(s->harness); j++) {
        const double way =
            wb_vec3_distance(s->start[j].position, wb_harness_node(s->harness, j)->position);
        if (way > snap.distance) {
            snap.distance = way;
            snap.joint = j;
        }
    }
    return snap;
}

static bool is_stopped(const struct wb_harness_move *move, double fraction)
{
    return move->observer && !move->observer(move->context, fraction);
}

/* Moves against the drag until the harness rests: steps by the second backward difference (BDF2) of
 * variable length. The trial state is then committed; on failure it is that of the last step. */
static enum outcome settle(struct wb_harness_solver *s, double weight,
                           const struct wb_harness_move *move, double fraction,
                           struct wb_harness_result *result)
{
    struct wb_harness *const h = s->harness;
    enum outcome outcome = ITERATIONS;
    double size = 1.0 / s->stiffest, last_size = 0.0;
    double next_trial = 0.0; /* size from which on a state without drag is tried */
    bool rests = false, is_slow = false;
    for (int step = 0; step < max_steps && !rests && size * s->stiffest > least_step; step++) {
        const bool at_end = size * last_drag * s->softest >= 1.0;
        const bool last = at_end || (is_slow && size >= next_trial);
        const double ratio = last_size > 0.0 ? size / last_size : 0.0;
        const double own = (1.0 + 2.0 * ratio) / (1.0 + ratio);
        const double carried = ratio * ratio / (1.0 + ratio);
        wb_harness_set_drag(h, last ? 0.0 : own / size, last ? 0.0 : carried / size);
        if (last_size > 0.0)
            wb_harness_extrapolate(h, ratio);
        else
            wb_harness_revert(h);
        remember(s, s->before);
        outcome = iterate(s, weight, !last, result);
        const double turn = wb_harness_turn(h) / s->most_rotation;
        if (last && !at_end && (outcome != EQUILIBRIUM || turn > rest_turn)) {
            next_trial = next_trial_ratio * size;
            continue;
        }
        if (outcome == EQUILIBRIUM) {
            const double ratio_next = next_size(s);
            wb_harness_commit(h);
            result->increments++;
            rests = last;
            is_slow = turn < slow_turn;
            if (!rests && is_stopped(move, fraction)) {
                outcome = STOPPED;
                break;
            }
            last_size = size;
            size *= ratio_next;
        } else {
            result->cutbacks++;
            size *= outcome == TURNED ? fmax(turn_part / turn, 0.1) : 0.25;
        }
    }
    wb_harness_set_drag(h, 0.0, 0.0);
    if (!rests)
        wb_harness_revert(h);
    return rests || outcome != EQUILIBRIUM ? outcome : ITERATIONS;
}

/* Where the holds, loads and the weight are at a fraction of the move. */
static double aim(struct wb_harness_solver *s, const struct wb_harness_move *move, double fraction)
{
    for (int i = 0; i < move->n_aims; i++) {
        const struct wb_harness_aim *const to = &move->aims[i];
        const struct wb_rod_node *const from = &s->from[i];
        const enum wb_harness_hold hold = wb_harness_hold(s->harness, to->joint);
        struct wb_rod_node at;
        double turn[3], q[4];
        wb_harness_turn_to(s->harness, to->joint, from, &to->target, turn);
        for (int k = 0; k < 3; k++) {
            at.position[k] =
                fraction == 1.0
                    ? to->target.position[k]
                    : from->position[k] + fraction * (to->target.position[k] - from->position[k]);
            turn[k] *= fraction;
        }
        wb_rod_element_exponential(turn, q);
        wb_rod_element_compose(q, from->rotation, at.rotation);
        if (hold == WB_HARNESS_PLANE)
            memcpy(at.rotation, to->target.rotation, sizeof at.rotation);
        wb_harness_set_hold(s->harness, to->joint, hold, &at);
    }
    for (int i = 0; i < move->n_loads; i++) {
        double load[6];
        for (int k = 0; k < 6; k++)
            load[k] = s->from_load[i][k] + fraction * (move->loads[i].load[k] - s->from_load[i][k]);
        wb_harness_set_load(s->harness, move->loads[i].joint, load);
    }
    return s->weight + fraction * (move->weight - s->weight);
}

static const char *words_for(enum outcome outcome)
{
    switch (outcome) {
    case NOT_FINITE:
        return "a force is not finite";
    case UNSTABLE:
        return "the equilibrium is unstable";
    case TURNED:
        return "a joint turns too far in the smallest increment";
    case PASSED:
        return "a wire passes through an obstacle in the smallest increment";
    default:
        return "Newton's method does not converge";
    }
}

static void begin(struct wb_harness_solver *s, const struct wb_harness_move *move,
                  struct wb_harness_result *result)
{
    *result = (struct wb_harness_result){.end = WB_HARNESS_NOT_CONVERGED};
    for (int i = 0; i < move->n_aims; i++)
        s->from[i] = wb_harness_held_node(s->harness, move->aims[i].joint);
    for (int i = 0; i < move->n_loads; i++)
        wb_harness_load(s->harness, move->loads[i].joint, s->from_load[i]);
}

/* Back to the last equilibrium, at a fraction of the move. */
static void go_back(struct wb_harness_solver *s, const struct wb_harness_move *move,
                    double fraction)
{
    struct wb_harness_balance balance;
    wb_harness_restore(s->harness, s->rest);
    wb_harness_evaluate(s->harness, aim(s, move, fraction), &balance);
}

void wb_harness_solver_move(struct wb_harness_solver *s, const struct wb_harness_move *move,
                            struct wb_harness_result *result)
{
    struct wb_harness *const h = s->harness;
    double done = 0.0, size = 0.25, last = 0.0;
    begin(s, move, result);
    while (done < 1.0) {
        const bool whole = size > (1.0 - done) * (1.0 - 1e-12);
        const double next = whole ? 1.0 : done + size;
        const double weight = aim(s, move, next);
        if (last > 0.0)
            wb_harness_extrapolate(h, (next - done) / last);
        else
            wb_harness_revert(h);
        double growth_now = max_growth;
        remember(s, s->before);
        enum outcome outcome = iterate(s, weight, false, result);
        if (outcome == ITERATIONS) {
            wb_harness_revert(h);
            if (wb_harness_soften_contacts(h))
                outcome = iterate(s, weight, false, result);
        }
        if (outcome == EQUILIBRIUM) {
            if (last > 0.0)
                growth_now = next_size(s);
            wb_harness_commit(h);
        } else if (0.5 * (next - done) >= smallest_increment) {
            wb_harness_revert(h);
            result->cutbacks++;
            size = 0.5 * (next - done);
            continue;
        } else {
            /* The stable path ends here. */
            wb_harness_revert(h);
            remember(s, s->start);
            wb_harness_save(h, s->rest);
            const enum outcome why = outcome;
            outcome = settle(s, weight, move, next, result);
            if (outcome != EQUILIBRIUM) {
                result->problem = outcome == STOPPED ? NULL : words_for(why);
                result->end = outcome == STOPPED ? WB_HARNESS_STOPPED : WB_HARNESS_NOT_CONVERGED;
                go_back(s, move, done);
                break;
            }
            if (result->n_snaps < WB_HARNESS_MOST_SNAPS)
                result->snaps[result->n_snaps++] = measure_snap(s, next);
            size = 0.01;
        }
        last = next - done;
        done = next;
        result->fraction = done;
        result->increments++;
        if (is_stopped(move, done)) {
            result->end = WB_HARNESS_STOPPED;
            break;
        }
        size = last * fmin(growth_now, s->iterations <= 6 ? max_growth : 1.0);
    }
    s->weight += result->fraction * (move->weight - s->weight);
    if (done >= 1.0 && result->end != WB_HARNESS_STOPPED)
        result->end = WB_HARNESS_CONVERGED;
}

void wb_harness_solver_settle(struct wb_harness_solver *s, double weight,
                              bool (*observer)(void *context, double fraction), void *context,
                              struct wb_harness_result *result)
{
    const struct wb_harness_move move = {
        .weight = weight, .observer = observer, .context = context};
    begin(s, &move, result);
    const enum outcome outcome = settle(s, weight, &move, 1.0, result);
    s->weight = weight;
    if (outcome == EQUILIBRIUM) {
        result->end = WB_HARNESS_CONVERGED;
        result->fraction = 1.0;
    } else if (outcome == STOPPED) {
        result->end = WB_HARNESS_STOPPED;
    } else {
        result->problem = words_for(outcome);
    }
}

size_t wb_harness_solver_state_size(const struct wb_harness_solver *solver)
{
    return sizeof solver->weight + wb_harness_state_size(solver->harness);
}

void wb_harness_solver_save(const struct wb_harness_solver *solver, void *state)
{
    memcpy(state, &solver->weight, sizeof solver->weight);
    wb_harness_save(solver->harness, (char *)state + sizeof solver->weight);
}

void wb_harness_solver_restore(struct wb_harness_solver *solver, const void *state)
{
    memcpy(&solver->weight, state, sizeof solver->weight);
    wb_harness_restore(solver->harness, (const char *)state + sizeof solver->weight);
}
