#include "fe/solid/solid.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fe/solid/solid_private.h"

#define WB_LOG_DOMAIN "solid"

/* Iterations that an increment should take: it grows below, shrinks above. */
static const double wanted_iterations = 6.0;

/* Share of the largest force at any node below which a strand's tension is none. */
static const double no_tension = 1e-6;

/* Arcs shorter than this share of the wanted length lead nowhere. */
static const double shortest_arc = 1.0 / 256.0;

/* Share of a move that an arc may go beyond its end. */
static const double most_overshoot = 1e-3;

/* Arc increments allowed in a move that names no number. */
static const int usual_arc_increments = 1;

static struct wb_solid_settings complete_settings(const struct wb_solid_settings *given)
{
    struct wb_solid_settings s = {0};
    if (given)
        s = *given;
    s.force_tolerance = s.force_tolerance == 0.0 ? 1e-6 : s.force_tolerance;
    s.first_increment = s.first_increment == 0.0 ? 1.0 : s.first_increment;
    s.smallest_increment = s.smallest_increment == 0.0 ? 1e-5 : s.smallest_increment;
    s.largest_increment = s.largest_increment == 0.0 ? 1.0 : s.largest_increment;
    s.most_rotation = s.most_rotation == 0.0 ? 0.25 : s.most_rotation;
    s.max_iterations = s.max_iterations == 0 ? 12 : s.max_iterations;
    return s;
}

static enum wb_status copy_model(struct wb_solid *solid, const struct wb_solid_model *model)
{
    const size_t n = 3 * (size_t)model->mesh->n_nodes;

    solid->strand = (struct wb_solid_tip_strand){model->strand_length, model->strand_x};
    solid->n_supports = model->n_supports;
    solid->supports = calloc((size_t)model->n_supports + 1, sizeof *solid->supports);
    if (model->nodal_force)
        solid->nodal_force = calloc(n, sizeof *solid->nodal_force);
    if (!solid->supports || (model->nodal_force && !solid->nodal_force))
        return wb_fail(WB_ERR_MEMORY, "out of memory for supports and loads");
    memcpy(solid->supports, model->supports, (size_t)model->n_supports * sizeof *solid->supports);
    if (model->nodal_force)
        memcpy(solid->nodal_force, model->nodal_force, n * sizeof *solid->nodal_force);
    return WB_OK;
}

static enum wb_status take_memory(struct wb_solid *solid)
{
    const size_t n = 3 * (size_t)solid->body.mesh->n_nodes;
    double **const vectors[] = {&solid->u,    &solid->committed, &solid->before,
                                &solid->step, &solid->base,      &solid->committed_force,
                                &solid->held, &solid->held_force};

    for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++) {
        *vectors[i] = calloc(n, sizeof(double));
        if (!*vectors[i])
            return wb_fail(WB_ERR_MEMORY, "out of memory for %zu displacements", n);
    }
    solid->right = calloc((size_t)solid->body.n_equations * WB_SOLID_COLUMNS, sizeof *solid->right);
    return solid->right
               ? WB_OK
               : wb_fail(WB_ERR_MEMORY, "out of memory for %d equations", solid->body.n_equations);
}

enum wb_status wb_solid_create(struct wb_solid **out, const struct wb_solid_model *model,
                               const struct wb_solid_settings *settings)
{
    *out = NULL;
    if (!(isfinite(model->strand_length) && model->strand_length >= 0.0 &&
          isfinite(model->strand_x)))
        return wb_fail(WB_ERR_ARGUMENT, "strand of %g m above x = %g m: expected 0 or more",
                       model->strand_length, model->strand_x);

    struct wb_solid *solid = calloc(1, sizeof *solid);
    if (!solid)
        return wb_fail(WB_ERR_MEMORY, "out of memory for a solid");
    solid->settings = complete_settings(settings);
    solid->pace = solid->settings.first_increment;

    enum wb_status status = wb_solid_body_init(&solid->body, model);
    if (status == WB_OK)
        status = wb_solid_tip_init(&solid->tip, model->mesh, model->parts);
    if (status == WB_OK)
        status = wb_solid_update_init(&solid->update, model->mesh);
    if (status == WB_OK)
        status = copy_model(solid, model);
    if (status == WB_OK)
        status = take_memory(solid);
    if (status != WB_OK)
        wb_solid_destroy(solid);
    else
        *out = solid;
    return status;
}

void wb_solid_destroy(struct wb_solid *solid)
{
    if (!solid)
        return;
    wb_solid_body_release(&solid->body);
    wb_solid_tip_release(&solid->tip);
    wb_solid_update_release(&solid->update);
    free(solid->supports);
    free(solid->nodal_force);
    free(solid->u);
    free(solid->committed);
    free(solid->before);
    free(solid->committed_force);
    free(solid->right);
    free(solid->step);
    free(solid->base);
    free(solid->held);
    free(solid->held_force);
    free(solid);
}

static size_t vector_bytes(const struct wb_solid *solid)
{
    return 3 * (size_t)solid->body.mesh->n_nodes * sizeof(double);
}

static double deflection_of(const struct wb_solid *solid, const double *u)
{
    double z[WB_SOLID_TIP_UNKNOWNS];
    if (solid->tip.n_nodes == 0)
        return 0.0;
    wb_solid_tip_motion(&solid->tip, solid->body.mesh, u, z);
    return z[1];
}

/* What drives an increment, as one vector. */
static void drive_of(const struct wb_solid *solid, const struct wb_solid_increment *increment,
                     double drive[WB_SOLID_DRIVES])
{
    const struct wb_solid_loads a = wb_solid_loads_at(increment, increment->from, 0.0);
    const struct wb_solid_loads b = wb_solid_loads_at(increment, increment->share, 0.0);
    const bool deflection = increment->move->control == WB_SOLID_DEFLECTION;
    int n = 0;

    drive[n++] = b.weight - a.weight;
    drive[n++] = b.supports - a.supports;
    drive[n++] = b.nodal - a.nodal;
    for (int i = 0; i < 3; i++) {
        drive[n++] = b.tip.force[i] - a.tip.force[i];
        drive[n++] = b.tip.follower[i] - a.tip.follower[i];
        /* As forces, over a length of the section's size. */
        drive[n++] =
            solid->tip.n_nodes > 0 ? (b.tip.moment[i] - a.tip.moment[i]) / solid->tip.radius : 0.0;
    }
    drive[n++] = deflection ? (increment->share - increment->from) *
                                  (increment->move->deflection - increment->start_deflection)
                            : 0.0;
    drive[n] = deflection ? 0.0 : b.tension - a.tension;
}

/* How many times the last increment's drive this one's is; 0 where it is no multiple. */
static double ratio_of(const double *last, const double *now)
{
    double ll = 0.0, ln = 0.0, nn = 0.0;
    for (int i = 0; i < WB_SOLID_DRIVES; i++) {
        ll += last[i] * last[i];
        ln += last[i] * now[i];
        nn += now[i] * now[i];
    }
    const double ratio = ln / ll;
    const bool parallel = ll > 0.0 && ln > 0.0 && ln * ln > (1.0 - 1e-9) * ll * nn;
    return parallel && ratio <= 3.0 ? ratio : 0.0;
}

static void impose_supports(struct wb_solid *solid)
{
    for (int i = 0; i < solid->n_supports; i++) {
        const struct wb_solid_support *s = &solid->supports[i];
        solid->u[3 * s->node + s->axis] = solid->loads.supports * s->displacement;
    }
}

/* Sets the trial state of an increment; true where it is the last increment's continuation. */
static bool predict(struct wb_solid *solid, const struct wb_solid_increment *increment)
{
    double drive[WB_SOLID_DRIVES];
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
    solid->loads = wb_solid_loads_at(increment, increment->share, tension);
    if (ratio > 0.0)
        impose_supports(solid);
    return ratio > 0.0;
}

/* The trial state becomes the last equilibrium. */
static void accept(struct wb_solid *solid, const struct wb_solid_increment *increment)
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

/* A stable equilibrium has no business to become an unstable one by growing loads: the increment
 * stepped over a critical point, perhaps to another branch. */
static bool steps_over(struct wb_solid *solid, const struct wb_solid_increment *increment)
{
    const bool unstable = wb_solid_newton_unstable(solid, increment);

    if (!unstable || solid->unstable) {
        solid->unstable = unstable;
        return false;
    }
    snprintf(solid->problem, sizeof solid->problem,
             "a critical point (a limit load or buckling) lies between %.4g and %.4g of the way",
             increment->from, increment->share);
    return true;
}

static void revert(struct wb_solid *solid)
{
    memcpy(solid->u, solid->committed, vector_bytes(solid));
    solid->loads = solid->committed_loads;
}

static double turned(const struct wb_solid_increment *increment)
{
    double sum = 0.0;
    for (int i = 3; i < WB_SOLID_TIP_UNKNOWNS; i++)
        sum += increment->change[i] * increment->change[i];
    return sqrt(0.5 * sum);
}

/* The next increment's share from how the last one went. */
static double next_pace(const struct wb_solid *solid, const struct wb_solid_increment *increment)
{
    const double pace = increment->share - increment->from;
    double growth = sqrt(wanted_iterations / fmax(1.0, solid->iterations));

    growth = fmin(2.0, fmax(0.5, growth));
    if (turned(increment) * growth > solid->settings.most_rotation)
        growth = fmax(0.5, solid->settings.most_rotation / turned(increment));
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

/* Whether a strand would have to push at the equilibrium just found. */
static bool pushes(const struct wb_solid *solid, const struct wb_solid_increment *increment)
{
    double largest = solid->largest_force;

    if (increment->move->control != WB_SOLID_DEFLECTION || solid->strand.length == 0.0 ||
        !(solid->loads.tension < 0.0))
        return false;
    for (int i = 0; i < 3 * solid->body.mesh->n_nodes; i++)
        largest = fmax(largest, fabs(solid->body.force[i]));
    return solid->loads.tension < -no_tension * largest;
}

/* The increment after which the strand would carry nothing, by the straight line through the
 * tensions of both ends. */
static double pace_to_slack(const struct wb_solid *solid,
                            const struct wb_solid_increment *increment)
{
    const double from = fmax(0.0, solid->committed_loads.tension), to = solid->loads.tension;
    return (increment->share - increment->from) * from / (from - to);
}

static void move_by_shares(struct wb_solid *solid, struct wb_solid_increment *increment,
                           struct wb_solid_point *point)
{
    const double smallest = solid->settings.smallest_increment;
    double pace = fmin(1.0, solid->pace);

    while (point->fraction < 1.0) {
        /* No crumb is left for a last increment. */
        const double rest = 1.0 - point->fraction;
        increment->from = point->fraction;
        increment->share = rest <= pace * 1.01 ? 1.0 : point->fraction + fmin(pace, 0.5 * rest);
        const bool predicted = predict(solid, increment);
        bool converged = wb_solid_newton(solid, increment, predicted);
        point->iterations += solid->iterations;
        if (!converged && predicted) {
            /* Once more from the equilibrium itself. */
            solid->can_continue = false;
            (void)predict(solid, increment);
            converged = wb_solid_newton(solid, increment, false);
            point->iterations += solid->iterations;
        }
        if (!converged || steps_over(solid, increment)) {
            revert(solid);
            point->cutbacks++;
            pace = 0.5 * (increment->share - increment->from);
            if (pace < smallest) {
                finish(solid, point, WB_SOLID_NOT_CONVERGED);
                return;
            }
            continue;
        }
        if (turned(increment) > 2.0 * solid->settings.most_rotation) {
            /* Too far for the path of a plastic material. */
            pace = (increment->share - increment->from) * solid->settings.most_rotation /
                   turned(increment);
            snprintf(solid->problem, sizeof solid->problem,
                     "the end turns by %.2g rad between %.6g and %.6g of the way: no equilibrium "
                     "is near",
                     turned(increment), increment->from, increment->share);
            revert(solid);
            point->cutbacks++;
            if (pace < smallest) {
                finish(solid, point, WB_SOLID_NOT_CONVERGED);
                return;
            }
            continue;
        }
        if (pushes(solid, increment)) {
            pace = pace_to_slack(solid, increment);
            revert(solid);
            if (pace < smallest) {
                finish(solid, point, WB_SOLID_SLACK);
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

static void move_by_arc(struct wb_solid *solid, struct wb_solid_increment *increment,
                        struct wb_solid_point *point)
{
    const struct wb_solid_move *move = increment->move;
    const int most = move->most_increments > 0 ? move->most_increments : usual_arc_increments;
    double length = move->arc_length;

    /* A path goes on as it went; towards new loads it begins with their growth. */
    if (solid->on_arc && memcmp(&solid->arc_target, &move->target, sizeof move->target) == 0) {
        increment->last_direction = solid->last_change;
        length = fmin(length, 2.0 * solid->arc_pace);
    }
    for (int done = 0; done < most && point->fraction < 1.0;) {
        increment->from = increment->share = point->fraction;
        increment->arc_length = length;
        memcpy(solid->u, solid->committed, vector_bytes(solid));
        solid->loads = solid->committed_loads;
        const bool converged = wb_solid_newton(solid, increment, true);
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
        const bool unstable = wb_solid_newton_unstable(solid, increment);
        if (!unstable && increment->share > 1.0 + most_overshoot &&
            length >= shortest_arc * move->arc_length) {
            /* Not past the loads that are wanted, from which a plastic body would return otherwise.
             */
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
    const struct wb_solid_loads *t = &move->target;
    double sum = t->weight + t->supports + t->nodal + t->tension + move->deflection;
    for (int i = 0; i < 3; i++)
        sum += t->tip.force[i] + t->tip.moment[i] + t->tip.follower[i];
    return isfinite(sum);
}

enum wb_status wb_solid_move(struct wb_solid *solid, const struct wb_solid_move *move,
                             struct wb_solid_point *point)
{
    if (!is_finite(move))
        return wb_fail(WB_ERR_ARGUMENT, "a load or deflection is not a finite number");
    if (move->control != WB_SOLID_LOADS && solid->tip.n_nodes == 0)
        return wb_fail(WB_ERR_ARGUMENT, "this mesh has no free end to control");
    if (move->control == WB_SOLID_ARC &&
        !(move->arc_length > 0.0 && move->target.supports == solid->committed_loads.supports))
        return wb_fail(WB_ERR_ARGUMENT, "an arc needs a length above 0 and supports at rest");

    struct wb_solid_increment increment = {
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

size_t wb_solid_memory(const struct wb_solid *solid)
{
    return wb_solid_body_memory(&solid->body) + 8 * vector_bytes(solid) +
           (size_t)solid->body.n_equations * WB_SOLID_COLUMNS * sizeof *solid->right;
}

const struct wb_solid_loads *wb_solid_loads(const struct wb_solid *solid)
{
    return &solid->committed_loads;
}

void wb_solid_tip(const struct wb_solid *solid, struct wb_solid_tip *tip)
{
    double z[WB_SOLID_TIP_UNKNOWNS];

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
