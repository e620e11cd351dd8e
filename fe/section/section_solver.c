#include "fe/section/section_solver.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/units.h"

enum {
    DEFAULT_ITERATIONS = 40,
    MAX_CUTS = 8, /* of a line search */
    RIGHT_SIDES = 3
};

static const double default_tolerance = 1e-6;
static const double default_smallest_step = 1.0 / 256.0;
static const double jump =
    2e-3; /* relative force change in the unexpected direction that counts as a jump */
static const double least_part = 1.0 / 128.0; /* of the weight, in an increment */
static const double flat =
    0.05; /* a line search ends when the slope along the step is reduced to this fraction */

/* An equilibrium. */
struct equilibrium {
    double deflection, vertical, weight;
};

struct wb_section_solver {
    struct wb_section_beam *beam;
    struct wb_section_solver_settings settings;
    struct wb_section_beam_loads loads;
    struct equilibrium now, before;
    int n_committed;
    double weight;      /* N/m: all of it */
    double weight_part; /* maximum fraction of the weight in an increment */
    bool is_slack;      /* the strand is slack and the tip free under the weight */
    double *step;       /* (n_unknowns) */
    double *right;      /* (RIGHT_SIDES x n_unknowns) */
    struct wb_section_solver_point point;
    struct wb_memory memory;
};

/* --- one increment --- */

static double dot(int n, const double *a, const double *b)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* Relative residual: the larger of the largest unbalanced force (moments divided by the length)
 * over the largest force, and of the tip's distance to its target over the length (target NULL: no
 * target). */
static double find_residual(const struct wb_section_solver *s, const double *target)
{
    const struct wb_section_beam *const beam = s->beam;
    const double length = beam->model->length;
    const double scale = fmax(fmax(beam->axial, fabs(s->loads.vertical)), s->loads.weight * length);
    double largest = 0.0;

    for (int i = 0; i < beam->n_unknowns; i++) {
        const bool turns = i % beam->per_station == 0;
        const double force = beam->residual[i] / (turns ? length : 1.0);
        /* fmax() would drop a NaN. */
        if (isnan(force))
            return force;
        largest = fmax(largest, fabs(force));
    }
    const double gap = target ? fabs(*target - beam->tip.y) : 0.0;
    return fmax(gap / length, scale > 0.0 ? largest / scale : 0.0);
}

/* Computes Newton's step of all unknowns and of V. The constraint of the tip's height borders the
 * matrix. So does the rotation of a strand: the matrix lacks rho d d^T, with d the derivative of
 * the tip's x. Without a target V is constant. */
static bool find_step(struct wb_section_solver *s, const double *target, double *vertical)
{
    struct wb_section_beam *const beam = s->beam;
    const int n = beam->n_unknowns, sides = !target ? 1 : s->loads.strand > 0.0 ? 3 : 2;
    double *const free_part = s->right, *const by_force = s->right + n,
                  *const by_turn = s->right + 2 * (size_t)n;

    if (!wb_section_beam_factor(beam, &s->loads))
        return false;
    for (int i = 0; i < n; i++) {
        free_part[i] = -beam->residual[i];
        by_force[i] = beam->lever[i];
        by_turn[i] = beam->draw[i];
    }
    wb_layered_solve(beam->matrix, sides, s->right);
    /* The rise of the tip per unknown: the lever without the part from the strand's slope. */
    double rise[3] = {0.0, 0.0, 0.0}, turn[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k < sides; k++) {
        const double *const x = s->right + (size_t)k * (size_t)n;
        turn[k] = dot(n, beam->draw, x);
        rise[k] = dot(n, beam->lever, x) - beam->tip.slope * turn[k];
    }
    const double gap = target ? *target - beam->tip.y : 0.0;
    double rho = 0.0, turned = 0.0;
    if (sides == 3) {
        const double secant = sqrt(1.0 + beam->tip.slope * beam->tip.slope);
        rho = s->loads.vertical * secant * secant * secant / s->loads.strand;
        /* rise0 + dV rise1 - rho t rise2 = gap, turn0 + dV turn1 - rho t turn2 = t. */
        const double a = rise[1], b = -rho * rise[2], c = turn[1], d = -rho * turn[2] - 1.0;
        const double e = gap - rise[0], f = -turn[0];
        *vertical = (e * d - b * f) / (a * d - b * c);
        turned = (a * f - c * e) / (a * d - b * c);
    } else {
        *vertical = target ? (gap - rise[0]) / rise[1] : 0.0;
    }
    for (int i = 0; i < n; i++)
        s->step[i] = free_part[i] + (sides > 1 ? *vertical * by_force[i] : 0.0) -
                     (sides == 3 ? rho * turned * by_turn[i] : 0.0);
    return isfinite(*vertical) && isfinite(dot(n, s->step, s->step));
}

static void move_unknowns(struct wb_section_solver *s, double part, double vertical)
{
    for (int i = 0; i < s->beam->n_unknowns; i++)
        s->beam->u[i] += part * s->step[i];
    s->loads.vertical += part * vertical;
}

/* Line search after a step that did not reduce the residual. When contacts begin to slip or to
 * stick within a step, the tangent changes, and Newton's method may alternate between two states.
 * With constant friction limits there is a potential along the step, convex except for the tip's
 * rotation; the search reduces its slope by secants with a bracket. */
static void line_search(struct wb_section_solver *s, double slope_before, double vertical)
{
    const int n = s->beam->n_unknowns;
    double part = 1.0, low = 0.0, high = 1.0, slope_low = slope_before;

    wb_section_beam_evaluate(s->beam, &s->loads, false);
    double slope_high = dot(n, s->step, s->beam->residual);
    if (!(slope_before < 0.0) || !(slope_high > 0.0))
        return;
    for (int i = 0; i < MAX_CUTS; i++) {
        const double secant = (low * slope_high - high * slope_low) / (slope_high - slope_low);
        const double margin = 0.05 * (high - low);
        const double next = fmin(fmax(secant, low + margin), high - margin);
        move_unknowns(s, next - part, vertical);
        part = next;
        wb_section_beam_evaluate(s->beam, &s->loads, false);
        const double slope = dot(n, s->step, s->beam->residual);
        if (!(fabs(slope) > flat * fabs(slope_before)))
            return;
        *(slope > 0.0 ? &high : &low) = part;
        *(slope > 0.0 ? &slope_high : &slope_low) = slope;
    }
}

/* Newton's method for a target, from the trial state. */
static bool iterate(struct wb_section_solver *s, const double *target)
{
    struct wb_section_beam *const beam = s->beam;

    wb_section_beam_evaluate(beam, &s->loads, true);
    double residual = find_residual(s, target);
    for (int i = 0; i < s->settings.most_iterations; i++) {
        double vertical;
        s->point.residual = residual;
        if (residual <= s->settings.tolerance)
            return true;
        if (!isfinite(residual) || !find_step(s, target, &vertical))
            return false;
        const double slope = dot(beam->n_unknowns, s->step, beam->residual);
        s->point.iterations++;
        move_unknowns(s, 1.0, vertical);
        wb_section_beam_evaluate(beam, &s->loads, true);
        const double next = find_residual(s, target);
        if (i > 0 && !(next < residual)) {
            line_search(s, slope, vertical);
            wb_section_beam_evaluate(beam, &s->loads, true);
        }
        residual = find_residual(s, target);
    }
    return false;
}

/* Extrapolates the last two equilibria linearly to a target. */
static void extrapolate(struct wb_section_solver *s, double target)
{
    struct wb_section_beam *const beam = s->beam;
    const double change = s->now.deflection - s->before.deflection;

    wb_section_beam_revert(beam);
    s->loads.vertical = s->now.vertical;
    if (s->n_committed < 2 || change == 0.0)
        return;
    const double ratio = (target - s->now.deflection) / change;
    for (int i = 0; i < beam->n_unknowns; i++)
        beam->u[i] += ratio * (beam->committed[i] - beam->before[i]);
    s->loads.vertical += ratio * (s->now.vertical - s->before.vertical);
}

static void commit(struct wb_section_solver *s, double target)
{
    wb_section_beam_commit(s->beam);
    s->before = s->now;
    s->now = (struct equilibrium){target, s->loads.vertical, s->loads.weight};
    s->n_committed++;
}

/* --- moves --- */

static void describe(struct wb_section_solver *s)
{
    const struct wb_section_beam *const beam = s->beam;
    struct wb_section_solver_point *const p = &s->point;
    double x, y;

    wb_section_beam_place(beam, beam->model->length, &x, &y, &p->tip_angle);
    p->deflection = y;
    p->tip_x = x;
    p->vertical = s->loads.vertical;
    p->tension = s->loads.vertical * sqrt(1.0 + beam->tip.slope * beam->tip.slope);
    p->slack = s->is_slack;
    p->missing = beam->missing;
    p->tape_plastic = beam->tape_plastic;
    p->fold = beam->fold;
}

/* The strand would have to push: finds the equilibrium of the free tip with a slack strand. False
 * if that does not converge. */
static bool release_strand(struct wb_section_solver *s)
{
    wb_section_beam_revert(s->beam);
    s->loads.vertical = 0.0;
    if (!iterate(s, NULL))
        return false;
    s->is_slack = true;
    commit(s, s->beam->tip.y);
    return true;
}

/* True if the force decreased although an increase was expected, or the reverse: Newton's method
 * may converge to an equilibrium on another branch. */
static bool has_jumped(const struct wb_section_solver *s, double expected)
{
    const double change = s->loads.vertical - s->now.vertical;
    return s->n_committed > 1 && change * expected < 0.0 &&
           fabs(change) > jump * fabs(s->now.vertical);
}

/* Makes an increment to a target, or to the free tip if the strand becomes slack. */
static bool advance(struct wb_section_solver *s, double target)
{
    extrapolate(s, target);
    s->point.increments++;
    const double expected = s->loads.vertical - s->now.vertical;
    if (!iterate(s, &target) || has_jumped(s, expected))
        return false;
    if (s->loads.strand > 0.0 && s->loads.vertical < 0.0)
        return release_strand(s);
    s->is_slack = false;
    commit(s, target);
    return true;
}

/* Returns to the last equilibrium. */
static void return_to_last(struct wb_section_solver *s)
{
    s->point.end = WB_SECTION_SOLVER_NOT_CONVERGED;
    wb_section_beam_revert(s->beam);
    s->loads.vertical = s->now.vertical;
    s->loads.weight = s->now.weight;
    wb_section_beam_evaluate(s->beam, &s->loads, true);
}

void wb_section_solver_move(struct wb_section_solver *s, double deflection,
                            struct wb_section_solver_point *point)
{
    const double from = s->now.deflection, change = deflection - from;
    const double weight = s->now.weight, added = s->weight - weight;
    const double most = added > 0.0 ? s->weight_part : 1.0;
    double done = 0.0, part = most;

    s->point = (struct wb_section_solver_point){.end = WB_SECTION_SOLVER_CONVERGED};
    /* A free tip stays where it is until the strand becomes taut. */
    while (!(s->is_slack && deflection <= s->now.deflection) &&
           (done < 1.0 || s->n_committed == 0)) {
        const double next = fmin(done + part, 1.0);
        s->loads.weight = next < 1.0 ? weight + next * added : s->weight;
        if (advance(s, next < 1.0 ? from + next * change : deflection)) {
            done = next;
            part = fmin(2.0 * part, most);
            continue;
        }
        part *= 0.5;
        if (part < s->settings.smallest_step * most) {
            return_to_last(s);
            break;
        }
    }
    describe(s);
    *point = s->point;
}

const struct wb_section_beam *wb_section_solver_beam(const struct wb_section_solver *solver)
{
    return solver->beam;
}

/* --- creation --- */

void wb_section_solver_destroy(struct wb_section_solver *s)
{
    if (!s)
        return;
    wb_section_beam_destroy(s->beam);
    wb_memory_release(&s->memory);
    free(s);
}

static void fill_settings(struct wb_section_solver *s,
                          const struct wb_section_solver_settings *settings)
{
    s->settings = *settings;
    if (!(s->settings.tolerance > 0.0))
        s->settings.tolerance = default_tolerance;
    if (s->settings.most_iterations == 0)
        s->settings.most_iterations = DEFAULT_ITERATIONS;
    if (!(s->settings.smallest_step > 0.0))
        s->settings.smallest_step = default_smallest_step;
}

/* The weight, and the number of increments in which it is applied: one if the wires alone, sliding
 * freely, would sag by at most an eighth of their length (q L^3 / (8 E I)). */
static void set_weight(struct wb_section_solver *s, const struct wb_bundle_model *model)
{
    s->weight =
        WB_STANDARD_GRAVITY * (wb_bundle_model_wire_mass(model) + wb_bundle_model_tape_mass(model));
    const double moment = s->weight * pow(model->length, 3.0);
    s->weight_part = fmax(fmin(wb_bundle_model_rigidity(model).wires / moment, 1.0), least_part);
}

enum wb_status wb_section_solver_create(struct wb_section_solver **out,
                                        const struct wb_bundle_model *model,
                                        const struct wb_section_solver_settings *settings)
{
    *out = NULL;
    struct wb_section_solver *const s = wb_memory_new(1, sizeof *s);
    fill_settings(s, settings);
    const enum wb_status status =
        wb_section_beam_create(&s->beam, model, settings->friction, &s->settings.beam);
    if (status != WB_OK) {
        wb_section_solver_destroy(s);
        return status;
    }
    const size_t n = (size_t)s->beam->n_unknowns;
    s->step = wb_memory_take(&s->memory, n, sizeof(double));
    s->right = wb_memory_take(&s->memory, RIGHT_SIDES * n, sizeof(double));
    if (model->loads.weight)
        set_weight(s, model);
    s->loads.strand = model->loads.strand_length;
    *out = s;
    return WB_OK;
}
