#include "fe/trial/cantilever.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/units.h"
#include "fe/linear/banded.h"
#include "fe/rod/beam.h"

#define WB_LOG_DOMAIN "cantilever"

/* Active unilateral constraints. Without a strand the vertical force counts as always taut. */
enum {
    TAUT = 1,
    RESTING = 2,
    ALL_MODES = 4
};

enum {
    MAX_UNKNOWNS = 5, /* tip x, y, t, tension, reaction of the rest */
};

/* Newton iterations are scaled down so that no node rotates by more than this, rad. */
static const double max_iteration_rotation = 0.5;

/* A step fails after this many iterations, or this many scaled-down ones. */
static const int max_iterations = 25, max_scaled_down = 3;

/* Smallest sub-step as a fraction of the move. */
static const double smallest_step = 1e-4;

static const double default_force_tolerance = 1e-12;

/* Loads applied at the tip. */
struct loads {
    double tension;  /* of the strand, or vertical force, N */
    double reaction; /* of the rest, N */
    double follower; /* N */
    double moment;   /* N m */
    double weight;   /* factor on weight and counterweight, 0 to 1 */
};

/* State after a converged step, except for the beam. */
struct state {
    struct loads loads, earlier; /* `earlier`: one step before */
    int mode;
    bool has_control; /* false until the first move */
    enum wb_cantilever_control control;
    double value;     /* of the control */
    double last_step; /* the last increment of the control; 0: no extrapolation */
    double fraction;  /* size of the last step as a fraction of its move */
};

struct wb_cantilever {
    /* Section and curvature are cleared: they are borrowed during creation. */
    struct wb_cantilever_model model;
    double force_tolerance; /* largest residual over the largest internal force */
    struct wb_beam *beam;
    struct state state, saved;
    int n_materials;

    struct wb_cantilever *const *followers; /* (n_followers), borrowed */
    const double *offsets; /* of the followers' controls, (n_followers), borrowed */
    int n_followers;

    /* The trial step. */
    struct loads loads;
    struct wb_beam_balance balance;
    double ratio;         /* of the extrapolation at the start of the step */
    double residual;      /* relative, last */
    double duration;      /* s, of a move */
    double step_duration; /* s, of the step */
    double tolerance;     /* absolute force tolerance of the last check, N */
    int iterations;
};

/* One equilibrium to solve for. */
struct step {
    enum wb_cantilever_control control;
    double value;
    double weight;
    int mode;
};

void wb_cantilever_default_model(struct wb_cantilever_model *model)
{
    *model = (struct wb_cantilever_model){.gravity_y = -WB_STANDARD_GRAVITY};
}

static enum wb_status check_model(const struct wb_cantilever_model *m)
{
    if (!m->section)
        return wb_fail(WB_ERR_ARGUMENT, "the model has no section");
    if (!(isfinite(m->strand_length) && m->strand_length >= 0.0))
        return wb_fail(WB_ERR_ARGUMENT, "strand_length %g m: expected 0 or more", m->strand_length);
    if (!(isfinite(m->counterweight) && m->counterweight >= 0.0 && isfinite(m->mass_per_length) &&
          m->mass_per_length >= 0.0))
        return wb_fail(WB_ERR_ARGUMENT,
                       "counterweight %g kg, mass per length %g kg/m: expected 0 or more",
                       m->counterweight, m->mass_per_length);
    if (!(isfinite(m->gravity_x) && isfinite(m->gravity_y)))
        return wb_fail(WB_ERR_ARGUMENT, "gravity (%g, %g) is not finite", m->gravity_x,
                       m->gravity_y);
    if (m->has_rest && !(isfinite(m->rest_level) && m->strand_length > 0.0))
        return wb_fail(
            WB_ERR_ARGUMENT,
            "rest_level %g m, strand_length %g m: a rest needs a finite level and a strand",
            m->rest_level, m->strand_length);
    return WB_OK;
}

enum wb_status wb_cantilever_create(struct wb_cantilever **out,
                                    const struct wb_cantilever_model *model,
                                    const struct wb_cantilever_settings *settings)
{
    *out = NULL;
    WB_TRY(check_model(model));

    const struct wb_beam_model beam = {
        .section = model->section,
        .length = model->length,
        .n_elements = model->n_elements == 0 ? 50 : model->n_elements,
        .natural_curvature = model->natural_curvature,
        .curvature_context = model->curvature_context,
        .load_x = model->mass_per_length * model->gravity_x,
        .load_y = model->mass_per_length * model->gravity_y,
    };
    struct wb_beam *created;
    WB_TRY(wb_beam_create(&created, &beam));
    struct wb_cantilever *const c = wb_memory_new(1, sizeof *c);
    c->model = *model;
    c->force_tolerance = settings ? settings->force_tolerance : default_force_tolerance;
    c->beam = created;
    c->model.section = NULL;
    c->duration = (double)INFINITY;
    wb_cantilever_reset(c);
    *out = c;
    return WB_OK;
}

void wb_cantilever_destroy(struct wb_cantilever *cantilever)
{
    if (!cantilever)
        return;
    wb_beam_destroy(cantilever->beam);
    free(cantilever);
}

void wb_cantilever_reset(struct wb_cantilever *cantilever)
{
    wb_beam_reset(cantilever->beam);
    cantilever->state = (struct state){.mode = TAUT, .fraction = 1.0};
    cantilever->loads = cantilever->state.loads;
}

enum wb_status wb_cantilever_set_law(struct wb_cantilever *cantilever, const struct wb_law *law)
{
    return wb_beam_set_law(cantilever->beam, law);
}

void wb_cantilever_lead(struct wb_cantilever *leader, int n, struct wb_cantilever *const *followers,
                        const double *offsets)
{
    leader->n_followers = n;
    leader->followers = followers;
    leader->offsets = offsets;
}

double wb_cantilever_tension(const struct wb_cantilever *cantilever)
{
    return cantilever->state.loads.tension;
}

void wb_cantilever_set_duration(struct wb_cantilever *cantilever, double duration)
{
    cantilever->duration = duration;
}

enum wb_status wb_cantilever_set_curvature(struct wb_cantilever *cantilever,
                                           double (*natural_curvature)(void *, double),
                                           void *context)
{
    WB_TRY(wb_beam_set_curvature(cantilever->beam, natural_curvature, context));
    wb_cantilever_reset(cantilever);
    return WB_OK;
}

void wb_cantilever_set_materials(struct wb_cantilever *cantilever,
                                 const struct wb_material *materials)
{
    wb_beam_set_materials(cantilever->beam, materials);
}

void wb_cantilever_save(struct wb_cantilever *cantilever)
{
    wb_beam_save(cantilever->beam);
    cantilever->saved = cantilever->state;
}

void wb_cantilever_restore(struct wb_cantilever *cantilever)
{
    wb_beam_restore(cantilever->beam);
    cantilever->state = cantilever->saved;
    cantilever->loads = cantilever->state.loads;
}

/* Direction of the strand's tension and its derivative with respect to the tip's x. */
struct strand {
    double x, y;   /* sin p, cos p */
    double dx, dy; /* d/dx */
};

/* Not finite if the tip's lateral distance exceeds the strand's length. */
static struct strand strand_direction(const struct wb_cantilever *c, double tip_x)
{
    const double S = c->model.strand_length;
    if (S == 0.0)
        return (struct strand){0.0, 1.0, 0.0, 0.0};
    const double sine = (c->model.length - tip_x) / S;
    const double cosine = sqrt(1.0 - sine * sine);
    return (struct strand){sine, cosine, -1.0 / S, sine / (S * cosine)};
}

/* The stage's travel at which the strand just becomes taut. */
static double stage_travel(const struct wb_cantilever *c, const struct wb_beam_node *tip)
{
    const double sine = (c->model.length - tip->x) / c->model.strand_length;
    /* S (1 - cos p) without cancellation */
    const double lean = c->model.strand_length * sine * sine / (1.0 + sqrt(1.0 - sine * sine));
    return tip->y - lean;
}

static bool is_unilateral(const struct wb_cantilever *c)
{
    return c->model.strand_length > 0.0;
}

/* Controls that prescribe the position of the tip; the force is an unknown. */
static bool drives_tip(enum wb_cantilever_control control)
{
    return control == WB_CONTROL_DEFLECTION || control == WB_CONTROL_STAGE ||
           control == WB_CONTROL_FOLLOWER_DEFLECTION;
}

/* The unknown force of such a control. */
static double *driving_force(struct loads *loads, enum wb_cantilever_control control)
{
    return control == WB_CONTROL_FOLLOWER_DEFLECTION ? &loads->follower : &loads->tension;
}

/* Value of a control in the trial state. */
static double present_value(const struct wb_cantilever *c, enum wb_cantilever_control control)
{
    switch (control) {
    case WB_CONTROL_DEFLECTION:
    case WB_CONTROL_FOLLOWER_DEFLECTION:
        return wb_beam_tip(c->beam)->y;
    case WB_CONTROL_STAGE:
        return stage_travel(c, wb_beam_tip(c->beam));
    case WB_CONTROL_DEAD_FORCE:
        return c->loads.tension;
    case WB_CONTROL_FOLLOWER_FORCE:
        return c->loads.follower;
    case WB_CONTROL_TIP_MOMENT:
        return c->loads.moment;
    }
    return 0.0;
}

/* Unbalanced forces at the tip: internal minus applied. */
static void tip_balance(const struct wb_cantilever *c, const struct strand *strand, double *r)
{
    const struct loads *l = &c->loads;
    const double t = wb_beam_tip(c->beam)->t;
    const double hung = l->weight * c->model.counterweight;

    r[0] = c->balance.tip[0] - l->tension * strand->x - hung * c->model.gravity_x +
           l->follower * sin(t);
    r[1] = c->balance.tip[1] - l->tension * strand->y - hung * c->model.gravity_y -
           l->follower * cos(t) - l->reaction;
    r[2] = c->balance.tip[2] - l->moment;
}

/* Distances by which the constraints of the step are violated. */
struct misses {
    double control, rest;
};

static struct misses constraint_misses(const struct wb_cantilever *c, const struct step *step)
{
    const struct wb_beam_node *tip = wb_beam_tip(c->beam);
    struct misses miss = {0.0, 0.0};

    if (drives_tip(step->control) && (step->mode & TAUT))
        miss.control = step->value - present_value(c, step->control);
    if (step->mode & RESTING)
        miss.rest = c->model.rest_level - tip->y;
    return miss;
}

/* Evaluates the trial state; true if it is an equilibrium. `r` receives the tip's unbalanced
 * forces. */
static bool check_balance(struct wb_cantilever *c, const struct step *step, struct strand *strand,
                          double *r)
{
    const double lever = 1.0 / c->model.length;
    wb_beam_evaluate(c->beam, c->loads.weight, &c->balance);
    *strand = strand_direction(c, wb_beam_tip(c->beam)->x);
    tip_balance(c, strand, r);

    const double at_tip = fabs(r[0]) + fabs(r[1]) + lever * fabs(r[2]);
    const double unbalanced = c->balance.largest_residual + at_tip;
    const double scale = c->balance.largest_force + 1e-6 * wb_beam_scale_force(c->beam);
    const struct misses miss = constraint_misses(c, step);
    const double reach = 1e-11 * c->model.length;

    c->residual = unbalanced / scale;
    c->tolerance = c->force_tolerance * scale + wb_beam_noise(c->beam);
    return unbalanced <= c->tolerance && fabs(miss.control) <= reach && fabs(miss.rest) <= reach;
}

/* Matrix of the tip: condensed beam, stiffness of the loads, and a row and column for each unknown
 * force (driving force, reaction of the rest). Returns the number of unknowns. */
static int tip_matrix(struct wb_cantilever *c, const struct step *step, const struct strand *strand,
                      double A[MAX_UNKNOWNS * MAX_UNKNOWNS])
{
    enum {
        W = MAX_UNKNOWNS
    };
    const double T = c->loads.tension, F = c->loads.follower;
    const double t = wb_beam_tip(c->beam)->t;
    double K[9];
    int n = 3;

    wb_beam_condense(c->beam, K);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            A[i * W + j] = K[3 * i + j];
    }
    A[0] -= T * strand->dx;
    A[W] -= T * strand->dy;
    A[2] += F * cos(t);
    A[W + 2] += F * sin(t);

    if (drives_tip(step->control) && (step->mode & TAUT)) {
        for (int j = 0; j < W; j++)
            A[n * W + j] = A[j * W + n] = 0.0;
        const bool follows = step->control == WB_CONTROL_FOLLOWER_DEFLECTION;
        A[n] = follows ? sin(t) : -strand->x;
        A[W + n] = follows ? -cos(t) : -strand->y;
        A[n * W] = step->control == WB_CONTROL_STAGE ? strand->x / strand->y : 0.0;
        A[n * W + 1] = 1.0;
        n++;
    }
    if (step->mode & RESTING) {
        for (int j = 0; j < W; j++)
            A[n * W + j] = A[j * W + n] = 0.0;
        A[W + n] = -1.0;
        A[n * W + 1] = 1.0;
        n++;
    }
    return n;
}

/* Right-hand side of the tip's system, with the tangent of the beam `tangent`. `r`: the tip's
 * unbalanced forces. */
static void tip_right(struct wb_cantilever *c, const struct step *step,
                      const struct wb_beam *tangent, const double *r, double b[MAX_UNKNOWNS])
{
    const struct misses miss = constraint_misses(c, step);
    int n = 3;
    /* `b` receives only the beam's residual; subtract the tip's applied loads. */
    wb_beam_reduce(c->beam, tangent, b);
    for (int i = 0; i < 3; i++)
        b[i] -= r[i] - c->balance.tip[i];
    if (drives_tip(step->control) && (step->mode & TAUT))
        b[n++] = miss.control;
    if (step->mode & RESTING)
        b[n++] = miss.rest;
}

/* Moves the trial state by the solution `b` of the tip's system; returns the scale of the move. */
static double advance(struct wb_cantilever *c, const struct step *step,
                      const struct wb_beam *tangent, const double *b)
{
    const double scale = wb_beam_advance(c->beam, tangent, b, max_iteration_rotation);
    int next = 3;
    if (drives_tip(step->control) && (step->mode & TAUT))
        *driving_force(&c->loads, step->control) += scale * b[next++];
    if (step->mode & RESTING)
        c->loads.reaction += scale * b[next++];
    return scale;
}

/* True if follower force and deflection have increased together in this step and will increase in
 * the next. Beyond the maximum deflection they do not: the same deflection is then reached by a
 * more curled wire as well as by one that springs back, and Newton's method may converge to either.
 * A plastic hinge, which rotates at constant force, is accepted. */
static bool follower_force_rises(struct wb_cantilever *c, const struct step *step,
                                 const struct strand *strand)
{
    const double flat = 1e-6 * wb_beam_scale_force(c->beam) / c->model.length;
    const double raised = wb_beam_tip(c->beam)->y - wb_beam_position(c->beam, c->model.length).y;
    const double more = c->loads.follower - c->state.loads.follower;
    double A[MAX_UNKNOWNS * MAX_UNKNOWNS], b[MAX_UNKNOWNS];

    /* In the first step the weight moves the tip, too, so that step is not checked. */
    if (step->weight == c->state.loads.weight && more * raised < -flat * raised * raised)
        return false;
    const int n = tip_matrix(c, step, strand, A);
    for (int i = 0; i < n; i++)
        b[i] = i == n - 1 ? 1.0 : 0.0;
    wb_banded_solve_small(n, MAX_UNKNOWNS, A, b);
    return b[n - 1] > -flat;
}

/* Newton's method from the trial state; true if it converged. A scaled-down iteration indicates
 * that the step is too long: after a few of them give up, because a shorter step is cheaper. */
static bool solve(struct wb_cantilever *c, const struct step *step)
{
    struct strand strand;
    double r[3];
    int scaled_down = 0;

    for (int iteration = 0;; iteration++) {
        if (check_balance(c, step, &strand, r))
            return step->control != WB_CONTROL_FOLLOWER_DEFLECTION ||
                   follower_force_rises(c, step, &strand);
        if (iteration == max_iterations || scaled_down == max_scaled_down || !isfinite(c->residual))
            return false;

        double A[MAX_UNKNOWNS * MAX_UNKNOWNS], b[MAX_UNKNOWNS];
        const int n = tip_matrix(c, step, &strand, A);
        tip_right(c, step, c->beam, r, b);
        wb_banded_solve_small(n, MAX_UNKNOWNS, A, b);
        scaled_down += advance(c, step, c->beam, b) < 1.0;
        c->iterations++;
    }
}

/* Sets the initial loads of the trial state. */
static void start_loads(struct wb_cantilever *c, const struct step *step)
{
    c->loads = c->state.loads;
    c->loads.weight = step->weight;
    switch (step->control) {
    case WB_CONTROL_DEAD_FORCE:
        c->loads.tension = step->value;
        break;
    case WB_CONTROL_FOLLOWER_FORCE:
        c->loads.follower = step->value;
        break;
    case WB_CONTROL_TIP_MOMENT:
        c->loads.moment = step->value;
        break;
    case WB_CONTROL_DEFLECTION:
    case WB_CONTROL_STAGE:
        if (!(step->mode & TAUT))
            c->loads.tension = 0.0;
        break;
    case WB_CONTROL_FOLLOWER_DEFLECTION:
        break;
    }
    if (!(step->mode & RESTING))
        c->loads.reaction = 0.0;
}

/* Factor by which to extrapolate the last two states to the step; 0 if constraints change, the
 * direction reverses, or the step is much longer than the last one. */
static double extrapolation(const struct wb_cantilever *c, const struct step *step)
{
    const struct state *s = &c->state;
    if (!s->has_control || s->control != step->control || s->mode != step->mode ||
        s->last_step == 0.0 || s->loads.weight != step->weight)
        return 0.0;
    const double ratio = (step->value - s->value) / s->last_step;
    return ratio > 0.0 && ratio <= 2.0 ? ratio : 0.0;
}

/* Solves the step in its mode: first from the extrapolated state, then from the last
 * equilibrium. */
static bool solve_mode(struct wb_cantilever *c, const struct step *step)
{
    const double ratio = c->ratio = extrapolation(c, step);

    if (ratio > 0.0) {
        start_loads(c, step);
        wb_beam_extrapolate(c->beam, ratio);
        if (step->mode & TAUT && drives_tip(step->control))
            *driving_force(&c->loads, step->control) +=
                ratio * (*driving_force(&c->state.loads, step->control) -
                         *driving_force(&c->state.earlier, step->control));
        if (step->mode & RESTING)
            c->loads.reaction += ratio * (c->state.loads.reaction - c->state.earlier.reaction);
        if (solve(c, step))
            return true;
    }
    start_loads(c, step);
    wb_beam_revert(c->beam);
    return solve(c, step);
}

/* The mode required by the converged trial state; equals the step's mode if no constraint is
 * violated. */
static int wanted_mode(const struct wb_cantilever *c, const struct step *step)
{
    const struct wb_beam_node *tip = wb_beam_tip(c->beam);
    const double force = 10.0 * c->tolerance;
    const double distance = 1e-7 * c->model.length;
    int mode = step->mode;

    if (!drives_tip(step->control) || !is_unilateral(c))
        return mode;
    if (mode & TAUT ? c->loads.tension < -force
                    : present_value(c, step->control) < step->value - distance)
        mode ^= TAUT;
    if (!c->model.has_rest)
        return mode;
    if (mode & RESTING ? c->loads.reaction < -force : tip->y < c->model.rest_level - distance)
        mode ^= RESTING;
    /* A deflection cannot be prescribed both by the strand and by the rest: the rest is active if
     * the target is below its level. */
    if (step->control == WB_CONTROL_DEFLECTION && mode == (TAUT | RESTING))
        mode = step->value < c->model.rest_level ? RESTING : TAUT;
    return mode;
}

/* Solves one step in the mode that satisfies all inequalities. */
static bool solve_in_any_mode(struct wb_cantilever *c, struct step step)
{
    const bool one_mode = !drives_tip(step.control) || !is_unilateral(c);
    bool tried[ALL_MODES] = {false};

    step.mode = c->state.mode;
    for (;;) {
        const bool solved = solve_mode(c, &step);
        if (solved && wanted_mode(c, &step) == step.mode) {
            c->state.mode = step.mode;
            return true;
        }
        if (one_mode)
            return false;

        tried[step.mode] = true;
        if (!c->model.has_rest)
            tried[RESTING] = tried[TAUT | RESTING] = true;
        if (step.control == WB_CONTROL_DEFLECTION)
            tried[TAUT | RESTING] = true;
        int next = solved ? wanted_mode(c, &step) : 0;
        for (int i = 0; i < ALL_MODES && tried[next]; i++)
            next = i;
        if (tried[next])
            return false;
        step.mode = next;
    }
}

static void accept(struct wb_cantilever *c, const struct step *step, double from)
{
    struct state *s = &c->state;
    const bool grew = s->loads.weight != c->loads.weight;

    s->earlier = s->loads;
    s->loads = c->loads;
    s->last_step = grew ? 0.0 : step->value - from;
    s->has_control = true;
    s->control = step->control;
    s->value = step->value;
    wb_beam_commit(c->beam);
}

/* Predicted load of a follower: it changes like the leader's load, and the difference between the
 * two continues to change by `ratio` times its last change. */
static double follow_load(const double *state, const double *earlier, double leader,
                          const double *leader_state, const double *leader_earlier, double ratio)
{
    return *state + (leader - *leader_state) +
           ratio * ((*state - *earlier) - (*leader_state - *leader_earlier));
}

/* One step of a follower, with the leader's tangent matrix `A` of `n` unknowns at the leader's
 * converged state. */
static void move_follower(struct wb_cantilever *f, struct wb_cantilever *leader, struct step step,
                          const double *A, int n, double offset, double from)
{
    struct state *const now = &leader->state;
    struct strand strand;
    double r[3], matrix[MAX_UNKNOWNS * MAX_UNKNOWNS], b[MAX_UNKNOWNS];
    step.value += offset;
    start_loads(f, &step);
    if (step.mode & TAUT && drives_tip(step.control))
        *driving_force(&f->loads, step.control) = follow_load(
            driving_force(&f->state.loads, step.control),
            driving_force(&f->state.earlier, step.control),
            *driving_force(&leader->loads, step.control), driving_force(&now->loads, step.control),
            driving_force(&now->earlier, step.control), leader->ratio);
    if (step.mode & RESTING)
        f->loads.reaction = follow_load(&f->state.loads.reaction, &f->state.earlier.reaction,
                                        leader->loads.reaction, &now->loads.reaction,
                                        &now->earlier.reaction, leader->ratio);
    wb_beam_set_duration(f->beam, leader->step_duration);
    wb_beam_follow(f->beam, leader->beam, leader->ratio);
    check_balance(f, &step, &strand, r);
    memcpy(matrix, A, sizeof matrix);
    tip_right(f, &step, leader->beam, r, b);
    wb_banded_solve_small(n, MAX_UNKNOWNS, matrix, b);
    advance(f, &step, leader->beam, b);
    /* After an extrapolation the prediction was close enough for the plastic strains; otherwise
     * evaluate again so that they include the correction. */
    if (leader->ratio == 0.0)
        check_balance(f, &step, &strand, r);
    f->state.mode = step.mode;
    accept(f, &step, from + offset);
}

/* Moves all followers to the leader's trial state. */
static void move_followers(struct wb_cantilever *c, struct step step, double from)
{
    double A[MAX_UNKNOWNS * MAX_UNKNOWNS];
    if (c->n_followers == 0)
        return;
    step.mode = c->state.mode;
    const struct strand strand = strand_direction(c, wb_beam_tip(c->beam)->x);
    const int n = tip_matrix(c, &step, &strand, A);
    for (int i = 0; i < c->n_followers; i++)
        move_follower(c->followers[i], c, step, A, n, c->offsets[i], from);
}

static enum wb_status check_move(const struct wb_cantilever *c, enum wb_cantilever_control control,
                                 double target)
{
    if (!isfinite(target))
        return wb_fail(WB_ERR_ARGUMENT, "target %g is not a finite number", target);
    if (control == WB_CONTROL_STAGE && !is_unilateral(c))
        return wb_fail(WB_ERR_ARGUMENT, "the stage cannot control a model without a strand");
    if ((!drives_tip(control) || control == WB_CONTROL_FOLLOWER_DEFLECTION) && is_unilateral(c))
        return wb_fail(WB_ERR_ARGUMENT,
                       "a tip force or moment cannot control a model with a strand");
    return WB_OK;
}

static void describe(struct wb_cantilever *c, enum wb_cantilever_control control,
                     struct wb_cantilever_point *point)
{
    const struct wb_beam_node *tip = wb_beam_tip(c->beam);
    const struct strand strand = strand_direction(c, tip->x);

    point->control = c->state.has_control && c->state.control == control
                         ? c->state.value
                         : present_value(c, control);
    point->deflection = tip->y;
    point->tip_x = tip->x;
    point->tip_angle = tip->t;
    point->tension = c->loads.tension;
    point->vertical_force = c->loads.tension * strand.y;
    point->follower = c->loads.follower;
    point->root_moment = wb_beam_root_moment(c->beam);
    point->slack = is_unilateral(c) && !(c->state.mode & TAUT);
    point->resting = (c->state.mode & RESTING) != 0;
    point->iterations = c->iterations;
    point->residual = c->residual;
}

enum wb_status wb_cantilever_move(struct wb_cantilever *c, enum wb_cantilever_control control,
                                  double target, struct wb_cantilever_point *point)
{
    WB_TRY(check_move(c, control, target));

    wb_beam_revert(c->beam);
    c->loads = c->state.loads;
    c->iterations = 0;

    const bool continues = c->state.has_control && c->state.control == control;
    const double start = continues ? c->state.value : present_value(c, control);
    const double weight = c->state.loads.weight;
    double done = 0.0, fraction = fmin(1.0, 4.0 * c->state.fraction);
    bool failed = false;

    point->end = WB_CANTILEVER_CONVERGED;
    while (done < 1.0) {
        const double next = fmin(1.0, done + fraction);
        const double from =
            c->state.has_control && c->state.control == control ? c->state.value : start;
        const struct step step = {
            .control = control,
            .value = next == 1.0 ? target : start + next * (target - start),
            .weight = next == 1.0 ? 1.0 : weight + next * (1.0 - weight),
        };
        c->step_duration = (next - done) * c->duration;
        wb_beam_set_duration(c->beam, c->step_duration);
        if (solve_in_any_mode(c, step)) {
            move_followers(c, step, from);
            accept(c, &step, from);
            c->state.fraction = fraction;
            done = next;
            fraction = failed ? fraction : 2.0 * fraction;
            failed = false;
            continue;
        }
        failed = true;
        fraction *= 0.5;
        if (fraction < smallest_step) {
            point->end = WB_CANTILEVER_NOT_CONVERGED;
            break;
        }
    }

    if (point->end != WB_CANTILEVER_CONVERGED) {
        /* Return to the last equilibrium and evaluate its resultants for `point`. */
        struct strand strand;
        double r[3];
        const struct step last = {.control = control, .mode = c->state.mode};
        wb_beam_revert(c->beam);
        wb_beam_set_duration(c->beam, 0.0);
        c->loads = c->state.loads;
        check_balance(c, &last, &strand, r);
    }
    describe(c, control, point);
    return WB_OK;
}

void wb_cantilever_shape(const struct wb_cantilever *cantilever, int n, const double *s, double *x,
                         double *y, double *angle)
{
    for (int i = 0; i < n; i++) {
        const struct wb_beam_node at = wb_beam_position(cantilever->beam, s[i]);
        x[i] = at.x;
        y[i] = at.y;
        if (angle)
            angle[i] = at.t;
    }
}
