#include "fe/bundle/bundle.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fe/bundle/bundle_part.h"
#include "fe/bundle/bundle_parts.h"
#include "fe/bundle/bundle_private.h"
#include "fe/team/team.h"

#define WB_LOG_DOMAIN "bundle"

enum {
    LANES = WB_SWEPT_LANES,
    MAX_PARTS = 1024,
    LEAST_HALO = 8,
    BEYOND_SLIP = 3,      /* stations that contact needs in addition to the slip */
    SETTLE_BLOCK = 20,    /* steps between checks of the kinetic energy */
    SETTLE_WATCH = 200,   /* steps between calls of the caller's watch */
    SETTLE_MOST = 400000, /* steps */
    SETTLE_QUIET = 10     /* consecutive stops with little motion that count as rest */
};

/* At rest: kinetic energy over the weight's work. */
static const double rest_ratio = 1e-7;

/* Default time step over the stable one of the straight, stress-free bundle. */
static const double default_safety = 0.9;

/* A part computed by this process. */
struct member {
    struct wb_bundle_part *part;
    enum wb_status status;
    double plastic_work;
};

struct wb_bundle {
    struct wb_bundle_part *whole; /* all stations */
    struct wb_team *team;
    /* Number of parts in all ranks; in this rank; number of this rank's first part. */
    int count, n_here, first;
    int halo;            /* stations */
    int *border;         /* (count + 1): first stations, and the end */
    struct member *here; /* (n_here) */
    int steps;           /* of the current advance */
    bool is_stale;       /* the complete bundle's fields are out of date */
    double weight_zero;  /* J: potential of the weight at the start */
};

double wb_bundle_internal(const struct wb_bundle_energies *e)
{
    return e->stored + e->plastic + e->contact + e->cohesive;
}

double wb_bundle_imbalance(const struct wb_bundle_energies *e)
{
    return e->external - e->kinetic - wb_bundle_internal(e) - e->artificial - e->friction;
}

/* --- borders of parts --- */

/* The slip between adjacent wires is their distance times their angle. The halo's width and the
 * position of the first border keep the vectors of the kernels aligned as in the complete
 * bundle. */
static int halo_of(const struct wb_bundle_model *model, const struct wb_bundle_mesh *mesh)
{
    const double turn = fmin(0.5 * M_PI, 2.0 * model->run.deflection / model->length);
    double diameter = 0.0;

    for (int t = 0; t < model->n_types; t++)
        diameter = fmax(diameter, model->type[t].outer_diameter);
    const double slip = diameter * turn * mesh->elements_along / model->length;
    const int needed = (int)ceil(slip) + BEYOND_SLIP;
    return LEAST_HALO * ((needed + LEAST_HALO - 1) / LEAST_HALO);
}

/* The border nearest to a fraction of the stations; -1 if there is none. */
static int border_at(int halo, int n_stations, double share)
{
    const int phase = halo % LANES;
    int at = phase + LANES * (int)lround((share * n_stations - phase) / LANES);

    while (at < halo)
        at += LANES;
    while (at > n_stations - halo)
        at -= LANES;
    return at >= halo ? at : -1;
}

/* Sets border (count + 1); false if parts would be too small. */
static bool find_borders(int halo, int n_stations, int count, int *border)
{
    border[0] = 0;
    border[count] = n_stations;
    for (int i = 1; i < count; i++) {
        border[i] = border_at(halo, n_stations, (double)i / count);
        if (border[i] < 0 || border[i] - border[i - 1] < halo)
            return false;
    }
    return n_stations - border[count - 1] >= halo;
}

int wb_bundle_parts_of(const struct wb_bundle_model *model, const char *name, int threads)
{
    const struct wb_bundle_mesh *mesh = wb_bundle_model_mesh(model, name ? name : model->run.mesh);
    const int ranks = wb_team_ranks();
    int border[MAX_PARTS + 1];

    if (!mesh)
        return ranks;
    const int halo = halo_of(model, mesh);
    int each = threads < 1 ? 1 : threads;
    while (each > 1 && (each * ranks > MAX_PARTS ||
                        !find_borders(halo, mesh->elements_along + 1, each * ranks, border)))
        each--;
    return each * ranks;
}

int wb_bundle_parts_largest(const struct wb_bundle_model *model, const char *name, int count)
{
    const struct wb_bundle_mesh *mesh = wb_bundle_model_mesh(model, name);
    int border[MAX_PARTS + 1], largest = 0;

    if (!mesh || count < 1 || count > MAX_PARTS)
        return 0;
    const int halo = halo_of(model, mesh);
    if (count > 1 && !find_borders(halo, mesh->elements_along + 1, count, border))
        return 0;
    for (int i = 0; i < count && count > 1; i++) {
        const int halos = (i > 0) + (i < count - 1);
        const int n = border[i + 1] - border[i] + halos * halo;
        largest = n > largest ? n : largest;
    }
    return count == 1 ? mesh->elements_along + 1 : largest;
}

/* --- columns of stations --- */

/* Serialised columns of stations, on their way to a neighbour or to the complete bundle. */
struct column_buffer {
    unsigned char *bytes; /* NULL: only count the size */
    size_t size;
    bool unloads;
};

static void load_column(struct column_buffer *buffer, void *data, size_t size)
{
    if (buffer->bytes && buffer->unloads)
        memcpy(data, buffer->bytes + buffer->size, size);
    else if (buffer->bytes)
        memcpy(buffer->bytes + buffer->size, data, size);
    buffer->size += size;
}

static void load_field(struct column_buffer *buffer, void *field, size_t size,
                       const struct wb_swept_layout *layout, struct wb_swept_range range)
{
    for (int row = 0; row < 3 * layout->n_nodes; row++) {
        const size_t at = (size_t)row * (size_t)layout->stride + (size_t)range.first;
        load_column(buffer, (unsigned char *)field + at * size,
                    (size_t)(range.end - range.first) * size);
    }
}

/* --- one part --- */

/* Copies the positions of `n` stations from `from` on into a packet, or from it. NULL packet: no
 * neighbour. */
static void copy_positions(struct wb_bundle_bodies *bodies, int from, int n, void *packet,
                           bool unloads)
{
    struct wb_bundle_body *body[WB_BUNDLE_MOST_BODIES];
    const int n_bodies = wb_bundle_bodies_list(bodies, body);
    struct column_buffer buffer = {.bytes = packet, .unloads = unloads};

    for (int b = 0; packet && b < n_bodies; b++)
        load_field(&buffer, body[b]->position, sizeof(double), &body[b]->layout,
                   (struct wb_swept_range){from, from + n});
}

/* Number of values in a packet: positions of wires, ring and directors. */
static size_t packet_size(const struct wb_bundle_bodies *bodies, int halo)
{
    size_t nodes = 2 * (size_t)bodies->ring.layout.n_nodes;

    for (int w = 0; w < bodies->n_wires; w++)
        nodes += (size_t)bodies->wire[w].layout.n_nodes;
    return 3 * nodes * (size_t)halo;
}

size_t wb_bundle_parts_bytes(const struct wb_bundle_part *whole)
{
    const struct wb_bundle_bodies *bodies = &whole->bodies;
    return packet_size(bodies, halo_of(bodies->model, bodies->mesh)) * sizeof(double);
}

static struct member *member_of(const struct wb_bundle *bundle, int number)
{
    const bool is_here = number >= bundle->first && number < bundle->first + bundle->n_here;
    return is_here ? &bundle->here[number - bundle->first] : NULL;
}

/* Exchanges halos with the neighbours; a single part has none. */
static void exchange_halos(struct wb_bundle *bundle, int number)
{
    struct wb_bundle_bodies *bodies = &member_of(bundle, number)->part->bodies;
    const struct wb_swept_range own = bodies->extent.own;
    struct wb_team *team = bundle->team;
    const int n = bundle->halo;

    if (bundle->count == 1)
        return;
    copy_positions(bodies, own.first, n, wb_team_packet(team, number, WB_TEAM_BEFORE), false);
    copy_positions(bodies, own.end - n, n, wb_team_packet(team, number, WB_TEAM_AFTER), false);
    wb_team_post(team, number);
    copy_positions(bodies, own.first - n, n, (void *)wb_team_await(team, number, WB_TEAM_BEFORE),
                   true);
    copy_positions(bodies, own.end, n, (void *)wb_team_await(team, number, WB_TEAM_AFTER), true);
}

/* Checks the slip at the borders only, because it varies slowly along wires. */
static enum wb_status check_slip(struct wb_bundle_part *part, int halo)
{
    const struct wb_swept_range own = part->bodies.extent.own;
    double most = 0.0;

    for (int p = 0; part->contact && p < wb_swept_contact_pairs(part->contact); p++) {
        for (int side = 0; side < 2; side++) {
            struct wb_swept_contact_point point;
            wb_swept_contact_get_point(part->contact, p, side == 0 ? own.first : own.end - 1,
                                       &point);
            most = fmax(most, fabs(point.shift));
        }
    }
    if (most <= halo - BEYOND_SLIP)
        return WB_OK;
    return wb_fail_to(&part->reason, WB_ERR_DATA,
                      "%s: wires slip past each other by %.1f stations, more than the %d that "
                      "the halo between parts allows; use one thread",
                      part->bodies.model->path, most, halo - BEYOND_SLIP);
}

/* A part that failed keeps exchanging packets, because its neighbours wait for them. */
static void advance_part(void *context, int number)
{
    struct wb_bundle *bundle = context;
    struct member *member = member_of(bundle, number);

    member->status = WB_OK;
    member->part->reason.text[0] = '\0';
    for (int i = 0; i < bundle->steps; i++) {
        if (member->status == WB_OK)
            member->status = wb_bundle_part_step(member->part, i == bundle->steps - 1);
        exchange_halos(bundle, number);
    }
    if (member->status == WB_OK && bundle->count > 1)
        member->status = check_slip(member->part, bundle->halo);
}

/* --- results of all parts --- */

/* Numbers of an account that are summed over the parts: those of the last step, and the tip's
 * forces, which are zero in all parts but the last. The whole adds the first N_WORKS sums to its
 * own, because they are works since the beginning. */
#define AT(member) offsetof(struct wb_bundle_account, member)

static const size_t summed[] = {
    AT(friction_work),     AT(damage_work),      AT(tip_work),
    AT(kinetic),           AT(tension),          AT(vertical),
    AT(pull[0]),           AT(pull[1]),          AT(pull[2]),
    AT(wires.stored),      AT(wires.artificial), AT(shells.stored),
    AT(shells.artificial), AT(touching.normal),  AT(touching.tangential),
    AT(touching.friction), AT(bonded.stored),    AT(bonded.dissipated),
    AT(bonded.contact),    AT(bonded.friction),
};

/* Numbers of which the largest of all parts counts. */
static const size_t largest[] = {AT(wires.largest_strain), AT(shells.largest_strain),
                                 AT(touching.deepest), AT(bonded.deepest)};

enum {
    N_WORKS = 3,
    N_LARGEST = WB_COUNT(largest),
    /* Elements beyond the strain limit, in wires and shells, and a slack strand. */
    BEYOND = WB_COUNT(summed),
    SHELLS_BEYOND,
    SLACK,
    N_SUMS
};

static double *number_at(struct wb_bundle_account *account, size_t offset)
{
    return (double *)((char *)account + offset);
}

static void add_part(struct wb_bundle_account *part, double sum[N_SUMS], double most[N_LARGEST])
{
    for (int i = 0; i < BEYOND; i++)
        sum[i] += *number_at(part, summed[i]);
    sum[BEYOND] += (double)part->wires.beyond_limit;
    sum[SHELLS_BEYOND] += (double)part->shells.beyond_limit;
    sum[SLACK] += part->slack ? 1.0 : 0.0;
    for (int i = 0; i < N_LARGEST; i++)
        most[i] = fmax(most[i], *number_at(part, largest[i]));
}

static void take_sums(struct wb_bundle_account *whole, const double sum[N_SUMS],
                      const double most[N_LARGEST])
{
    for (int i = 0; i < BEYOND; i++) {
        double *const number = number_at(whole, summed[i]);
        *number = i < N_WORKS ? *number + sum[i] : sum[i];
    }
    whole->wires.beyond_limit = llround(sum[BEYOND]);
    whole->shells.beyond_limit = llround(sum[SHELLS_BEYOND]);
    whole->slack = sum[SLACK] > 0.0;
    for (int i = 0; i < N_LARGEST; i++)
        *number_at(whole, largest[i]) = most[i];
}

/* --- fields and material states --- */

/* Material states are stored block by block, in rows with one element per station of a block. */
static void load_state(struct column_buffer *buffer, void *state, size_t bytes,
                       const struct wb_bundle_body *body, struct wb_swept_range range)
{
    const size_t size = wb_swept_kernel_real_size(body->is_double), row = LANES * size;
    const size_t per_block = bytes / (size_t)(body->layout.stride / LANES);

    for (int j = range.first; j < range.end;) {
        const int block = j / LANES, left = LANES - j % LANES;
        const int n = range.end - j < left ? range.end - j : left;
        unsigned char *at = (unsigned char *)state + (size_t)block * per_block;
        for (size_t i = 0; i < per_block; i += row)
            load_column(buffer, at + i + (size_t)(j % LANES) * size, (size_t)n * size);
        j += n;
    }
}

/* Serialises the columns of all fields, and of material states if `states`. */
static void load(struct wb_bundle_bodies *bodies, struct wb_swept_range range, bool states,
                 struct column_buffer *buffer)
{
    struct wb_bundle_body *body[WB_BUNDLE_MOST_BODIES];
    const int n_bodies = wb_bundle_bodies_list(bodies, body);
    size_t bytes;

    for (int b = 0; b < n_bodies; b++) {
        const struct wb_swept_layout *layout = &body[b]->layout;
        load_field(buffer, body[b]->position, sizeof(double), layout, range);
        load_field(buffer, body[b]->velocity, sizeof(double), layout, range);
        load_field(buffer, body[b]->force, wb_swept_kernel_real_size(body[b]->is_double), layout,
                   range);
    }
    for (int w = 0; states && w < bodies->n_wires; w++) {
        void *state = wb_swept_hex_state_data(bodies->wire_state[w], &bytes);
        load_state(buffer, state, bytes, &bodies->wire[w], range);
    }
    if (states && bodies->has_tape) {
        void *state = wb_swept_tape_state_data(bodies->tape_state, &bytes);
        load_state(buffer, state, bytes, &bodies->ring, range);
    }
}

/* Copies own stations `from` to `end` - 1 (numbers of the complete bundle) of a part into the
 * complete bundle of every rank. */
static void copy_to_whole(const struct wb_bundle *bundle, int number, int from, int end,
                          bool states)
{
    const struct member *member = member_of(bundle, number);
    struct wb_bundle_bodies *whole = &bundle->whole->bodies;
    const struct wb_swept_range there = {from, end};
    struct column_buffer buffer = {.bytes = NULL};

    load(whole, there, states, &buffer);
    const size_t size = buffer.size;
    buffer = (struct column_buffer){.bytes = wb_memory_resize(NULL, size, 1)};
    if (member) {
        struct wb_bundle_bodies *bodies = &member->part->bodies;
        const int first = bodies->extent.first;
        load(bodies, (struct wb_swept_range){from - first, end - first}, states, &buffer);
    }
    wb_team_share(buffer.bytes, size, number / bundle->n_here);
    buffer.size = 0;
    buffer.unloads = true;
    load(whole, there, states, &buffer);
    free(buffer.bytes);
}

static void copy_tip_to_whole(struct wb_bundle *bundle)
{
    const int end = bundle->whole->bodies.extent.n_stations;
    copy_to_whole(bundle, bundle->count - 1, end - 1, end, false);
}

/* The whole is a copy of the parts that is made when it is asked for. */
const struct wb_bundle_part *wb_bundle_whole(const struct wb_bundle *bundle)
{
    for (int i = 0; bundle->is_stale && i < bundle->count; i++)
        copy_to_whole(bundle, i, bundle->border[i], bundle->border[i + 1], true);
    ((struct wb_bundle *)bundle)->is_stale = false;
    return bundle->whole;
}

/* --- all parts --- */

/* Each part starts its own account for every advance. */
static void start_accounts(struct wb_bundle *bundle)
{
    for (int i = 0; i < bundle->n_here; i++) {
        struct wb_bundle_part *part = bundle->here[i].part;
        struct wb_bundle_account *account = &part->account;
        part->tip_path = bundle->whole->tip_path;
        part->clock = bundle->whole->clock;
        account->friction_work = account->damage_work = account->tip_work = 0.0;
    }
}

static void sum_accounts(struct wb_bundle *bundle)
{
    double sum[N_SUMS] = {0.0}, most[N_LARGEST] = {0.0};

    for (int i = 0; i < bundle->n_here; i++)
        add_part(&bundle->here[i].part->account, sum, most);
    wb_team_sum(sum, N_SUMS);
    wb_team_greatest(most, N_LARGEST);
    take_sums(&bundle->whole->account, sum, most);
    bundle->whole->clock = bundle->here[0].part->clock;
    copy_tip_to_whole(bundle);
}

/* The first failure along the bundle; its reason is the same on all ranks. */
static enum wb_status agree(struct wb_bundle *bundle, struct wb_reason *reason)
{
    const struct member *lost = NULL;
    double first = bundle->count;
    struct wb_reason of_first = {0};

    for (int i = bundle->n_here - 1; i >= 0; i--) {
        if (bundle->here[i].status != WB_OK) {
            lost = &bundle->here[i];
            first = bundle->first + i;
        }
    }
    const enum wb_status status = wb_team_agree(lost ? lost->status : WB_OK);
    if (status == WB_OK)
        return WB_OK;
    first = -first;
    wb_team_greatest(&first, 1);
    if (lost)
        of_first = lost->part->reason;
    wb_team_share(&of_first, sizeof of_first, (int)-first / bundle->n_here);
    /* Failures without a reason, e.g. lack of memory, are already logged. */
    return of_first.text[0] ? wb_fail_to(reason, status, "%s", of_first.text) : status;
}

enum wb_status wb_bundle_advance(struct wb_bundle *bundle, int n, struct wb_reason *reason)
{
    const bool is_one = bundle->count == 1;

    if (n < 1)
        return WB_OK;
    if (!is_one)
        start_accounts(bundle);
    bundle->steps = n;
    bundle->is_stale = !is_one;
    wb_team_run(bundle->team, advance_part, bundle);
    WB_TRY(agree(bundle, reason));
    if (!is_one)
        sum_accounts(bundle);
    return WB_OK;
}

static void stop(struct wb_bundle *bundle)
{
    wb_bundle_part_stop(bundle->whole);
    if (bundle->count == 1)
        return;
    for (int i = 0; i < bundle->n_here; i++)
        wb_bundle_part_stop(bundle->here[i].part);
    bundle->is_stale = true;
}

static double potential(const struct wb_bundle *bundle)
{
    double sum = 0.0;

    for (int i = 0; i < bundle->n_here; i++)
        sum += wb_bundle_bodies_potential(&bundle->here[i].part->bodies);
    wb_team_sum(&sum, 1);
    return sum;
}

static void find_plastic_work(void *context, int number)
{
    struct member *member = member_of(context, number);
    member->plastic_work = wb_bundle_bodies_plastic_work(&member->part->bodies);
}

static double plastic_work(const struct wb_bundle *bundle)
{
    double sum = 0.0;

    wb_team_run(bundle->team, find_plastic_work, (void *)bundle);
    for (int i = 0; i < bundle->n_here; i++)
        sum += bundle->here[i].plastic_work;
    wb_team_sum(&sum, 1);
    return sum;
}

static double debonded(const struct wb_bundle *bundle)
{
    double area[2] = {0.0, 0.0};

    if (!bundle->whole->bond)
        return 0.0;
    for (int i = 0; i < bundle->n_here; i++)
        wb_bundle_bond_add_areas(bundle->here[i].part->bond, area);
    wb_team_sum(area, 2);
    return area[0] > 0.0 ? area[1] / area[0] : 0.0;
}

/* --- creation --- */

/* A single part is the complete bundle itself. */
static enum wb_status make_parts(struct wb_bundle *bundle)
{
    struct wb_bundle_part *whole = bundle->whole;
    const struct wb_bundle_bodies *bodies = &whole->bodies;
    const int n = bodies->extent.n_stations;

    if (bundle->count == 1) {
        bundle->here[0].part = whole;
        bundle->border[1] = n;
        return WB_OK;
    }
    if (!find_borders(bundle->halo, n, bundle->count, bundle->border))
        return wb_fail(WB_ERR_ARGUMENT,
                       "%s: mesh %s has too few stations (%d) for %d parts; use fewer ranks",
                       bodies->model->path, bodies->mesh->name, n, bundle->count);
    for (int i = 0; i < bundle->n_here; i++) {
        const int number = bundle->first + i, begin = bundle->border[number];
        const int end = bundle->border[number + 1];
        const int before = number > 0 ? bundle->halo : 0;
        const int after = number < bundle->count - 1 ? bundle->halo : 0;
        WB_TRY(wb_bundle_part_create(&bundle->here[i].part, whole, begin - before,
                                     before + end - begin + after,
                                     (struct wb_swept_range){before, before + end - begin}));
    }
    return WB_OK;
}

/* Starts threads last: no threads may run while an allocation can fail. */
static enum wb_status start(struct wb_bundle *bundle)
{
    WB_TRY(make_parts(bundle));
    return wb_team_create(&bundle->team, bundle->n_here,
                          packet_size(&bundle->whole->bodies, bundle->halo));
}

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
    bundle->count = wb_bundle_parts_of(model, name, settings->threads);
    bundle->n_here = bundle->count / wb_team_ranks();
    bundle->first = wb_team_rank() * bundle->n_here;
    bundle->halo = halo_of(model, mesh);
    bundle->border = wb_memory_new((size_t)bundle->count + 1, sizeof *bundle->border);
    bundle->here = wb_memory_new((size_t)bundle->n_here, sizeof *bundle->here);
    enum wb_status status =
        wb_team_agree(wb_bundle_part_create_whole(&bundle->whole, model, mesh, safety));
    if (status == WB_OK) {
        bundle->whole->tip_path.duration = settings->duration;
        status = wb_team_agree(start(bundle));
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
    wb_team_destroy(bundle->team);
    for (int i = 0; i < bundle->n_here; i++)
        if (bundle->here[i].part != bundle->whole)
            wb_bundle_part_destroy(bundle->here[i].part);
    free(bundle->border);
    free(bundle->here);
    wb_bundle_part_destroy(bundle->whole);
    free(bundle);
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
    return bundle->count;
}

/* --- steps --- */

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
        const double work = fabs(bundle->weight_zero - potential(bundle)) + fabs(account->tip_work);
        quiet = last < rest_ratio * work ? quiet + 1 : 0;
        stop(bundle);
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
    bundle->weight_zero = potential(bundle);
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
        .plastic = plastic_work(bundle),
        .artificial = account->wires.artificial + account->shells.artificial,
        .contact =
            account->touching.normal + account->touching.tangential + account->bonded.contact,
        .friction = account->friction_work,
        .cohesive = account->bonded.stored + account->damage_work,
        .external = account->tip_work + bundle->weight_zero - potential(bundle),
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
        .debonded = debonded(bundle),
    };
}

/* --- checkpoints --- */

/* Saves a part's state, from its rank to all ranks. */
static void save_part(struct wb_bundle *bundle, int number, struct wb_checkpoint *out)
{
    const struct member *member = member_of(bundle, number);
    struct wb_checkpoint own;

    wb_checkpoint_init(&own);
    wb_checkpoint_enter(&own, "part %d", number + 1);
    if (member)
        wb_bundle_part_visit_fields(member->part, &own);
    enum wb_status status = own.status;
    wb_team_share(&status, sizeof status, number / bundle->n_here);
    if (status != WB_OK) {
        /* An incomplete checkpoint must not replace the last complete one. */
        if (out->status == WB_OK)
            out->status = status;
        wb_checkpoint_release(&own);
        return;
    }
    size_t size = own.size;
    wb_team_share(&size, sizeof size, number / bundle->n_here);
    unsigned char *const bytes = member ? own.bytes : wb_memory_resize(NULL, size, 1);
    wb_team_share(bytes, size, number / bundle->n_here);
    wb_checkpoint_append(out, bytes, size);
    if (!member)
        free(bytes);
    wb_checkpoint_release(&own);
}

/* Each rank skips the parts of other ranks. */
static void restore_part(struct wb_bundle *bundle, int number, struct wb_checkpoint *in)
{
    const struct member *member = member_of(bundle, number);

    wb_checkpoint_enter(in, "part %d", number + 1);
    if (member)
        wb_bundle_part_visit_fields(member->part, in);
    else
        wb_checkpoint_skip(in);
    wb_checkpoint_leave(in);
}

void wb_bundle_visit(struct wb_bundle *bundle, struct wb_checkpoint *checkpoint)
{
    wb_checkpoint_visit_member(checkpoint, bundle, weight_zero);
    wb_checkpoint_visit_member(checkpoint, bundle->whole, tip_path);
    wb_checkpoint_visit_member(checkpoint, bundle->whole, clock);
    wb_checkpoint_visit_member(checkpoint, bundle->whole, account);
    for (int i = 0; i < bundle->count; i++) {
        if (checkpoint->restores)
            restore_part(bundle, i, checkpoint);
        else
            save_part(bundle, i, checkpoint);
    }
    if (!checkpoint->restores || bundle->count == 1)
        return;
    bundle->is_stale = true;
    copy_tip_to_whole(bundle);
}
