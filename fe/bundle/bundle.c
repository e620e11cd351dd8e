#include "fe/bundle/bundle.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

#include "base/memory.h"
#include "fe/bundle/bundle_part.h"
#include "fe/bundle/bundle_parts.h"
#include "fe/team/team.h"

#define WB_LOG_DOMAIN "bundle"

enum {
    SETTLE_BLOCK = 20,    /* steps between checks of the kinetic energy */
    SETTLE_WATCH = 200,   /* steps between calls of the caller's watch */
    SETTLE_MOST = 400000, /* steps */
    SETTLE_QUIET = 10     /* consecutive stops with little motion that count as rest */
};

/* At rest: kinetic energy over the weight's work. */
static const double rest_ratio = 1e-7;

/* Default time step over the stable one of the straight, stress-free bundle. */
static const double default_safety = 0.9;

struct wb_bundle {
    struct wb_bundle_part *whole;  /* all stations */
    struct wb_bundle_parts *parts; /* cut into parts for computation */
    double weight_zero;            /* J: potential of the weight at the start */
};

double wb_bundle_internal(const struct wb_bundle_energies *e)
{
    return e->stored + e->plastic + e->contact + e->cohesive;
}

double wb_bundle_imbalance(const struct wb_bundle_energies *e)
{
    return e->external - e->kinetic - wb_bundle_internal(e) - e->artificial - e->friction;
}

/* --- creation --- */

enum wb_status wb_bundle_create(struct wb_bundle **out, const struct wb_bundle_model *model,
                                const struct wb_bundle_settings *settings)
{
    const char *name = settings->mesh ? settings->mesh : model->run.mesh;
    const struct wb_bundle_mesh *mesh = wb_bundle_model_mesh(model, name);
    const double safety = settings->step_safety > 0.0 ? settings->step_safety : default_safety;

    *out = NULL;
    if (!mesh)
        return wb_fail(WB_ERR_NOT_FOUND, "%s: mesh '%s' does not exist", model->path, name);
    if (!(settings->duration > 0.0 && isfinite(settings->duration)))
        return wb_fail(WB_ERR_ARGUMENT, "duration %g s: expected a number above 0",
                       settings->duration);
    struct wb_bundle *const bundle = wb_memory_new(1, sizeof *bundle);
    enum wb_status status =
        wb_team_agree(wb_bundle_part_create_whole(&bundle->whole, model, mesh, safety));
    if (status == WB_OK) {
        bundle->whole->tip_path.duration = settings->duration;
        status = wb_bundle_parts_create(&bundle->parts, bundle->whole,
                                        wb_bundle_parts_of(model, name, settings->threads));
    }
    if (status != WB_OK)
        wb_bundle_destroy(bundle);
    else
        *out = bundle;
    return status;
}

void wb_bundle_destroy(struct wb_bundle *bundle)
{
    if (!bundle)
        return;
    wb_bundle_parts_destroy(bundle->parts);
    wb_bundle_part_destroy(bundle->whole);
    free(bundle);
}

void wb_bundle_visit(struct wb_bundle *bundle, struct wb_checkpoint *checkpoint)
{
    wb_checkpoint_visit_member(checkpoint, bundle, weight_zero);
    wb_bundle_parts_visit(bundle->parts, checkpoint);
}

double wb_bundle_time_step(const struct wb_bundle *bundle)
{
    return bundle->whole->bodies.time_step;
}

long wb_bundle_hexahedra(const struct wb_bundle *bundle)
{
    const struct wb_bundle_bodies *bodies = &bundle->whole->bodies;
    return wb_bundle_model_hexahedra(bodies->model, bodies->mesh);
}

int wb_bundle_shells(const struct wb_bundle *bundle)
{
    const struct wb_bundle_bodies *bodies = &bundle->whole->bodies;
    return bodies->has_tape ? wb_swept_tape_elements(bodies->tape) * (bodies->extent.n_stations - 1)
                            : 0;
}

int wb_bundle_parts(const struct wb_bundle *bundle)
{
    return wb_bundle_parts_count(bundle->parts);
}

const struct wb_bundle_part *wb_bundle_whole(const struct wb_bundle *bundle)
{
    wb_bundle_parts_gather(bundle->parts);
    return bundle->whole;
}

/* --- steps --- */

enum wb_status wb_bundle_advance(struct wb_bundle *bundle, int n, struct wb_reason *reason)
{
    return wb_bundle_parts_advance(bundle->parts, n, reason);
}

void wb_bundle_move_tip(struct wb_bundle *bundle, double deflection, double duration)
{
    const double now = bundle->whole->clock.time;

    bundle->whole->tip_path = (struct wb_bundle_tip_path){
        .from = wb_bundle_part_target(bundle->whole, now),
        .to = deflection,
        .start = now,
        .duration = duration,
    };
}

/* Kinetic damping: velocities are set to zero whenever the kinetic energy begins to decrease, until
 * its maxima are small compared with the work done. The energy removed counts as negative external
 * work. */
static enum wb_status damp_to_rest(struct wb_bundle *bundle, const struct wb_bundle_watch *watch,
                                   struct wb_reason *reason)
{
    struct wb_bundle_account *account = &bundle->whole->account;
    double last = 0.0;
    int quiet = 0;

    for (int done = 0; quiet < SETTLE_QUIET; done += SETTLE_BLOCK) {
        if (done > SETTLE_MOST)
            return wb_fail_to(reason, WB_ERR_CONVERGENCE,
                              "%s: the bundle does not come to rest within %d steps",
                              bundle->whole->bodies.model->path, SETTLE_MOST);
        if (watch && done % SETTLE_WATCH == 0 && !watch->should_continue(watch->context))
            return WB_OK;
        WB_TRY(wb_bundle_advance(bundle, SETTLE_BLOCK, reason));
        if (account->kinetic >= last) {
            last = account->kinetic;
            continue;
        }
        const double work = fabs(bundle->weight_zero - wb_bundle_parts_potential(bundle->parts)) +
                            fabs(account->tip_work);
        quiet = last < rest_ratio * work ? quiet + 1 : 0;
        wb_bundle_parts_stop(bundle->parts);
        account->tip_work -= account->kinetic;
        account->kinetic = last = 0.0;
    }
    return WB_OK;
}

enum wb_status wb_bundle_settle(struct wb_bundle *bundle, const struct wb_bundle_watch *watch,
                                struct wb_reason *reason)
{
    struct wb_bundle_part *whole = bundle->whole;
    struct wb_bundle_energies now;

    whole->tip_path = (struct wb_bundle_tip_path){.duration = 1.0};
    bundle->weight_zero = wb_bundle_parts_potential(bundle->parts);
    if (whole->bodies.gravity == 0.0)
        return WB_OK;
    WB_TRY(damp_to_rest(bundle, watch, reason));
    /* Energies are balanced from here on. */
    wb_bundle_get_energies(bundle, &now);
    whole->account.tip_work +=
        now.kinetic + wb_bundle_internal(&now) + now.artificial + now.friction - now.external;
    whole->clock.time = 0.0;
    return WB_OK;
}

enum wb_status wb_bundle_release_tip(struct wb_bundle *bundle, const struct wb_bundle_watch *watch,
                                     struct wb_reason *reason)
{
    struct wb_bundle_state state;

    bundle->whole->tip_path.tip_is_free = true;
    WB_TRY(damp_to_rest(bundle, watch, reason));
    wb_bundle_get_state(bundle, &state);
    bundle->whole->tip_path.from = bundle->whole->tip_path.to = state.deflection;
    return WB_OK;
}

/* --- results --- */

void wb_bundle_get_state(const struct wb_bundle *bundle, struct wb_bundle_state *state)
{
    const struct wb_bundle_part *whole = bundle->whole;
    const struct wb_bundle_account *account = &whole->account;
    double tip[3];

    wb_bundle_part_tip(whole, tip);
    *state = (struct wb_bundle_state){
        .time = whole->clock.time,
        .steps = whole->clock.steps,
        .deflection = tip[1],
        .target = wb_bundle_part_target(whole, whole->clock.time),
        .tip = {tip[0], tip[1], tip[2]},
        .tension = account->tension,
        .vertical = account->vertical,
        .slack = account->slack,
    };
}

void wb_bundle_get_energies(const struct wb_bundle *bundle, struct wb_bundle_energies *energies)
{
    const struct wb_bundle_account *account = &bundle->whole->account;

    *energies = (struct wb_bundle_energies){
        .kinetic = account->kinetic,
        .stored = account->wires.stored + account->shells.stored,
        .plastic = wb_bundle_parts_plastic_work(bundle->parts),
        .artificial = account->wires.artificial + account->shells.artificial,
        .contact =
            account->touching.normal + account->touching.tangential + account->bonded.contact,
        .friction = account->friction_work,
        .cohesive = account->bonded.stored + account->damage_work,
        .external =
            account->tip_work + bundle->weight_zero - wb_bundle_parts_potential(bundle->parts),
    };
}

void wb_bundle_shape(const struct wb_bundle *bundle, int n, const double *s, double (*shape)[3])
{
    const struct wb_bundle_bodies *bodies = &wb_bundle_whole(bundle)->bodies;
    const int n_stations = bodies->extent.n_stations;

    for (int i = 0; i < n; i++) {
        const double along = fmin(fmax(s[i] / bodies->spacing, 0.0), n_stations - 1.0);
        const int j = (int)fmin(floor(along), n_stations - 2.0);
        const double t = along - j;
        double mass = 0.0, height = 0.0;

        shape[i][0] = shape[i][1] = shape[i][2] = 0.0;
        for (int w = 0; w < bodies->n_wires; w++) {
            const struct wb_bundle_body *body = &bodies->wire[w];
            for (int k = 0; k < body->layout.n_nodes; k++)
                for (int c = 0; c < 3; c++) {
                    const double *x =
                        body->position + (ptrdiff_t)(3 * k + c) * body->layout.stride + j;
                    shape[i][c] += body->node_mass[k] * ((1.0 - t) * x[0] + t * x[1]);
                }
            mass += body->mass;
            height += body->mass * body->start;
        }
        for (int c = 0; c < 3; c++)
            shape[i][c] /= mass;
        shape[i][1] -= height / mass;
    }
}

void wb_bundle_get_limits(const struct wb_bundle *bundle, struct wb_bundle_limits *limits)
{
    const struct wb_bundle_account *account = &bundle->whole->account;

    *limits = (struct wb_bundle_limits){
        .beyond = account->wires.beyond_limit + account->shells.beyond_limit,
        .largest_strain = fmax(account->wires.largest_strain, account->shells.largest_strain),
        .deepest = account->touching.deepest,
        .tape_deepest = account->bonded.deepest,
        .debonded = wb_bundle_parts_debonded(bundle->parts),
    };
}
