#include "fe/bundle/bundle_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "fe/bundle/bundle_private.h"
#include "fe/team/team.h"

#define WB_LOG_DOMAIN "bundle"

enum {
    LANES = WB_SWEPT_LANES,
    LEAST_HALO = 8,
    BEYOND_SLIP = 3 /* stations that contact needs beyond the slip */
};

/* A part in this process. */
struct part {
    struct wb_bundle *bundle;
    enum wb_status status;
    char problem[320];
    double plastic_work;
};

struct wb_bundle_parts {
    struct wb_bundle *whole; /* borrowed */
    struct wb_team *team;
    int count, n_here, first; /* of all ranks; in this one, the first of which */
    int halo;                 /* stations */
    int *border;              /* (count + 1): first stations, and the end */
    struct part *part;        /* (n_here) */
    int steps;                /* of the present advance */
    bool is_stale;            /* the whole's fields */
};

/* --- where to cut --- */

/* Wires beside each other slip by their distance times the angle by which they turn; the halo's
 * width and the first border after it make vectors begin where they do in the whole. */
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

/* The border that is nearest to a share of the stations; -1 where there is none. */
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

/* Fills border (count + 1); false when parts were too small. */
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
    int border[WB_BUNDLE_MOST_PARTS + 1];

    if (!mesh)
        return ranks;
    const int halo = halo_of(model, mesh);
    int each = threads < 1 ? 1 : threads;
    while (each > 1 && (each * ranks > WB_BUNDLE_MOST_PARTS ||
                        !find_borders(halo, mesh->elements_along + 1, each * ranks, border)))
        each--;
    return each * ranks;
}

int wb_bundle_parts_largest(const struct wb_bundle_model *model, const char *name, int count)
{
    const struct wb_bundle_mesh *mesh = wb_bundle_model_mesh(model, name);
    int border[WB_BUNDLE_MOST_PARTS + 1], largest = 0;

    if (!mesh || count < 1 || count > WB_BUNDLE_MOST_PARTS)
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

/* --- one part --- */

static int bodies_of(struct wb_bundle *bundle, struct wb_bundle_body *body[WB_PACKING_MOST + 2])
{
    int n = 0;

    for (int w = 0; w < bundle->n_wires; w++)
        body[n++] = &bundle->wire[w];
    if (bundle->has_tape) {
        body[n++] = &bundle->ring;
        body[n++] = &bundle->directors;
    }
    return n;
}

/* Positions of a halo's width of stations into a packet, or from there. */
static void pack(struct wb_bundle *bundle, int from, int n, double *packet)
{
    struct wb_bundle_body *body[WB_PACKING_MOST + 2];
    const int n_bodies = bodies_of(bundle, body);

    for (int b = 0; packet && b < n_bodies; b++)
        for (int row = 0; row < 3 * body[b]->layout.n_nodes; row++, packet += n)
            memcpy(packet, body[b]->position + (ptrdiff_t)row * body[b]->layout.stride + from,
                   (size_t)n * sizeof *packet);
}

static void unpack(struct wb_bundle *bundle, int to, int n, const double *packet)
{
    struct wb_bundle_body *body[WB_PACKING_MOST + 2];
    const int n_bodies = bodies_of(bundle, body);

    for (int b = 0; packet && b < n_bodies; b++)
        for (int row = 0; row < 3 * body[b]->layout.n_nodes; row++, packet += n)
            memcpy(body[b]->position + (ptrdiff_t)row * body[b]->layout.stride + to, packet,
                   (size_t)n * sizeof *packet);
}

static size_t packet_size(struct wb_bundle *bundle, int halo)
{
    struct wb_bundle_body *body[WB_PACKING_MOST + 2];
    const int n_bodies = bodies_of(bundle, body);
    size_t rows = 0;

    for (int b = 0; b < n_bodies; b++)
        rows += 3 * (size_t)body[b]->layout.n_nodes;
    return rows * (size_t)halo;
}

size_t wb_bundle_parts_bytes(const struct wb_bundle *whole)
{
    struct wb_bundle *changeable;

    memcpy(&changeable, &whole, sizeof changeable);
    return packet_size(changeable, halo_of(whole->model, whole->mesh)) * sizeof(double);
}

static void swap(struct wb_bundle_parts *parts, int member)
{
    struct wb_bundle *b = parts->part[member - parts->first].bundle;
    const int n = parts->halo;

    pack(b, b->own.first, n, wb_team_packet(parts->team, member, WB_TEAM_BEFORE));
    pack(b, b->own.end - n, n, wb_team_packet(parts->team, member, WB_TEAM_AFTER));
    wb_team_post(parts->team, member);
    unpack(b, b->own.first - n, n, wb_team_await(parts->team, member, WB_TEAM_BEFORE));
    unpack(b, b->own.end, n, wb_team_await(parts->team, member, WB_TEAM_AFTER));
}

/* Slip at the borders, which varies slowly along wires. */
static enum wb_status check_slip(const struct wb_bundle *b, int halo)
{
    double most = 0.0;

    for (int p = 0; b->contact && p < wb_swept_contact_pairs(b->contact); p++) {
        for (int side = 0; side < 2; side++) {
            struct wb_swept_contact_point point;
            wb_swept_contact_get_point(b->contact, p, side == 0 ? b->own.first : b->own.end - 1,
                                       &point);
            most = fmax(most, fabs(point.shift));
        }
    }
    if (most <= halo - BEYOND_SLIP)
        return WB_OK;
    return wb_fail(WB_ERR_DATA,
                   "%s: wires slip past each other by %.1f stations, more than the %d that parts "
                   "of the bundle know of their neighbours; compute it with one thread",
                   b->model->path, most, halo - BEYOND_SLIP);
}

static void keep_problem(void *context, enum wb_log_level level, const char *domain,
                         const char *message)
{
    struct part *part = context;
    (void)level, (void)domain;
    snprintf(part->problem, sizeof part->problem, "%s", message);
}

/* A part that is lost goes on swapping: the others count on it. */
static void advance_part(void *context, int member)
{
    struct wb_bundle_parts *parts = context;
    struct part *part = &parts->part[member - parts->first];
    void *outer_context;
    wb_log_sink *const outer = wb_log_get_tap(&outer_context);
    const enum wb_log_level before = wb_log_set_gravest(WB_LOG_DEBUG);

    wb_log_set_tap(keep_problem, part);
    part->status = WB_OK;
    for (int i = 0; i < parts->steps; i++) {
        if (part->status == WB_OK)
            part->status = wb_bundle_step(part->bundle, i == parts->steps - 1);
        swap(parts, member);
    }
    if (part->status == WB_OK)
        part->status = check_slip(part->bundle, parts->halo);
    wb_log_set_tap(outer, outer_context);
    wb_log_set_gravest(before);
}

/* --- what the whole learns --- */

/* Sums of the last step, and the tip's forces, of which all parts but the last have zeros. */
enum {
    KINETIC,
    STORED,
    ARTIFICIAL,
    BEYOND,
    SHELL_STORED,
    SHELL_ARTIFICIAL,
    SHELL_BEYOND,
    NORMAL,
    TANGENTIAL,
    FRICTION,
    BOND_STORED,
    BOND_DISSIPATED,
    BOND_CONTACT,
    BOND_FRICTION,
    FRICTION_WORK,
    DAMAGE_WORK,
    TIP_WORK,
    TENSION,
    VERTICAL,
    PULL,
    SLACK = PULL + 3,
    N_SUMS
};

enum {
    STRAIN,
    SHELL_STRAIN,
    DEEPEST,
    BOND_DEEPEST,
    N_MOST
};

static void add_part(const struct wb_bundle *b, double sum[N_SUMS], double most[N_MOST])
{
    const double own[N_SUMS] = {
        [KINETIC] = b->kinetic,
        [STORED] = b->wires.stored,
        [ARTIFICIAL] = b->wires.artificial,
        [BEYOND] = (double)b->wires.beyond_limit,
        [SHELL_STORED] = b->shells.stored,
        [SHELL_ARTIFICIAL] = b->shells.artificial,
        [SHELL_BEYOND] = (double)b->shells.beyond_limit,
        [NORMAL] = b->touching.normal,
        [TANGENTIAL] = b->touching.tangential,
        [FRICTION] = b->touching.friction,
        [BOND_STORED] = b->bonded.stored,
        [BOND_DISSIPATED] = b->bonded.dissipated,
        [BOND_CONTACT] = b->bonded.contact,
        [BOND_FRICTION] = b->bonded.friction,
        [FRICTION_WORK] = b->friction_work,
        [DAMAGE_WORK] = b->damage_work,
        [TIP_WORK] = b->tip_work,
        [TENSION] = b->tension,
        [VERTICAL] = b->vertical,
        [PULL] = b->pull[0],
        [PULL + 1] = b->pull[1],
        [PULL + 2] = b->pull[2],
        [SLACK] = b->slack ? 1.0 : 0.0,
    };

    for (int i = 0; i < N_SUMS; i++)
        sum[i] += own[i];
    most[STRAIN] = fmax(most[STRAIN], b->wires.largest_strain);
    most[SHELL_STRAIN] = fmax(most[SHELL_STRAIN], b->shells.largest_strain);
    most[DEEPEST] = fmax(most[DEEPEST], b->touching.deepest);
    most[BOND_DEEPEST] = fmax(most[BOND_DEEPEST], b->bonded.deepest);
}

static void take_sums(struct wb_bundle *whole, const double sum[N_SUMS], const double most[N_MOST])
{
    whole->kinetic = sum[KINETIC];
    whole->wires = (struct wb_swept_hex_sums){
        .stored = sum[STORED],
        .artificial = sum[ARTIFICIAL],
        .largest_strain = most[STRAIN],
        .beyond_limit = llround(sum[BEYOND]),
    };
    whole->shells = (struct wb_swept_tape_sums){
        .stored = sum[SHELL_STORED],
        .artificial = sum[SHELL_ARTIFICIAL],
        .largest_strain = most[SHELL_STRAIN],
        .beyond_limit = llround(sum[SHELL_BEYOND]),
    };
    whole->touching = (struct wb_swept_contact_energies){
        .normal = sum[NORMAL],
        .tangential = sum[TANGENTIAL],
        .friction = sum[FRICTION],
        .deepest = most[DEEPEST],
    };
    whole->bonded = (struct wb_bundle_bond_energies){
        .stored = sum[BOND_STORED],
        .dissipated = sum[BOND_DISSIPATED],
        .contact = sum[BOND_CONTACT],
        .friction = sum[BOND_FRICTION],
        .deepest = most[BOND_DEEPEST],
    };
    whole->friction_work += sum[FRICTION_WORK];
    whole->damage_work += sum[DAMAGE_WORK];
    whole->tip_work += sum[TIP_WORK];
    whole->tension = sum[TENSION];
    whole->vertical = sum[VERTICAL];
    for (int c = 0; c < 3; c++)
        whole->pull[c] = sum[PULL + c];
    whole->slack = sum[SLACK] > 0.0;
}

/* --- fields and histories --- */

/* Stations' columns on their way to the whole. */
struct cargo {
    unsigned char *bytes; /* NULL: they are only counted */
    size_t size;
    bool unloads;
};

static void load_column(struct cargo *cargo, void *data, size_t size)
{
    if (cargo->bytes && cargo->unloads)
        memcpy(data, cargo->bytes + cargo->size, size);
    else if (cargo->bytes)
        memcpy(cargo->bytes + cargo->size, data, size);
    cargo->size += size;
}

static void load_field(struct cargo *cargo, void *field, size_t size,
                       const struct wb_swept_layout *layout, struct wb_swept_range range)
{
    for (int row = 0; row < 3 * layout->n_nodes; row++) {
        const size_t at = (size_t)row * (size_t)layout->stride + (size_t)range.first;
        load_column(cargo, (unsigned char *)field + at * size,
                    (size_t)(range.end - range.first) * size);
    }
}

/* Histories are in rows of as many elements as a block has stations, block by block. */
static void load_history(struct cargo *cargo, void *history, size_t bytes,
                         const struct wb_bundle_body *body, struct wb_swept_range range)
{
    const size_t size = wb_bundle_force_size(body), row = LANES * size;
    const size_t per_block = bytes / (size_t)(body->layout.stride / LANES);

    for (int j = range.first; j < range.end;) {
        const int block = j / LANES, left = LANES - j % LANES;
        const int n = range.end - j < left ? range.end - j : left;
        unsigned char *at = (unsigned char *)history + (size_t)block * per_block;
        for (size_t i = 0; i < per_block; i += row)
            load_column(cargo, at + i + (size_t)(j % LANES) * size, (size_t)n * size);
        j += n;
    }
}

/* Columns of all fields, and of histories where they are asked for. */
static void load(struct wb_bundle *bundle, struct wb_swept_range range, bool histories,
                 struct cargo *cargo)
{
    struct wb_bundle_body *body[WB_PACKING_MOST + 2];
    const int n_bodies = bodies_of(bundle, body);
    size_t bytes;

    for (int b = 0; b < n_bodies; b++) {
        const struct wb_swept_layout *layout = &body[b]->layout;
        load_field(cargo, body[b]->position, sizeof(double), layout, range);
        load_field(cargo, body[b]->velocity, sizeof(double), layout, range);
        load_field(cargo, body[b]->force, wb_bundle_force_size(body[b]), layout, range);
    }
    for (int w = 0; histories && w < bundle->n_wires; w++) {
        void *history = wb_swept_hex_state_data(bundle->history[w], &bytes);
        load_history(cargo, history, bytes, &bundle->wire[w], range);
    }
    if (histories && bundle->has_tape) {
        void *history = wb_swept_tape_state_data(bundle->tape_history, &bytes);
        load_history(cargo, history, bytes, &bundle->ring, range);
    }
}

static struct part *part_here(struct wb_bundle_parts *parts, int member)
{
    const bool is_here = member >= parts->first && member < parts->first + parts->n_here;
    return is_here ? &parts->part[member - parts->first] : NULL;
}

/* Own stations `from` to `end` - 1 (of the whole) of a part into the whole of every rank. */
static void bring(struct wb_bundle_parts *parts, int member, int from, int end, bool histories)
{
    struct part *part = part_here(parts, member);
    const struct wb_swept_range there = {from, end};
    struct cargo cargo = {.bytes = NULL};

    load(parts->whole, there, histories, &cargo);
    const size_t size = cargo.size;
    cargo = (struct cargo){.bytes = malloc(size)};
    if (!cargo.bytes) {
        wb_error("no memory to gather a bundle of %zu bytes", size);
        wb_team_abort(1);
    }
    if (part) {
        const struct wb_swept_range here = {from - part->bundle->first, end - part->bundle->first};
        load(part->bundle, here, histories, &cargo);
    }
    wb_team_share(cargo.bytes, size, member / parts->n_here);
    cargo.size = 0;
    cargo.unloads = true;
    load(parts->whole, there, histories, &cargo);
    free(cargo.bytes);
}

static void bring_tip(struct wb_bundle_parts *parts)
{
    const int end = parts->whole->n_stations;
    bring(parts, parts->count - 1, end - 1, end, false);
}

void wb_bundle_parts_gather(struct wb_bundle_parts *parts)
{
    for (int i = 0; parts->is_stale && i < parts->count; i++)
        bring(parts, i, parts->border[i], parts->border[i + 1], true);
    parts->is_stale = false;
}

/* --- all parts --- */

static void hand_down(struct wb_bundle_parts *parts)
{
    const struct wb_bundle *whole = parts->whole;

    for (int i = 0; i < parts->n_here; i++) {
        struct wb_bundle *b = parts->part[i].bundle;
        b->time_step = whole->time_step;
        b->from = whole->from;
        b->to = whole->to;
        b->way_start = whole->way_start;
        b->way_duration = whole->way_duration;
        b->let_go = whole->let_go;
        b->time = whole->time;
        b->steps = whole->steps;
        b->has_moved = whole->has_moved;
        b->friction_work = b->damage_work = b->tip_work = 0.0;
    }
}

/* The first failure along the bundle; its reason is told on all ranks. */
static enum wb_status agree(struct wb_bundle_parts *parts)
{
    const struct part *lost = NULL;
    double first = parts->count;
    char problem[sizeof lost->problem] = "";

    for (int i = parts->n_here - 1; i >= 0; i--) {
        if (parts->part[i].status != WB_OK) {
            lost = &parts->part[i];
            first = parts->first + i;
        }
    }
    const enum wb_status status = wb_team_agree(lost ? lost->status : WB_OK);
    if (status == WB_OK)
        return WB_OK;
    first = -first;
    wb_team_greatest(&first, 1);
    if (lost)
        memcpy(problem, lost->problem, sizeof problem);
    wb_team_share(problem, sizeof problem, (int)-first / parts->n_here);
    return wb_fail(status, "%s", problem);
}

enum wb_status wb_bundle_parts_advance(struct wb_bundle_parts *parts, int n)
{
    struct wb_bundle *whole = parts->whole;
    double sum[N_SUMS] = {0.0}, most[N_MOST] = {0.0};

    if (n < 1)
        return WB_OK;
    hand_down(parts);
    parts->steps = n;
    wb_team_run(parts->team, advance_part, parts);
    parts->is_stale = true;
    WB_TRY(agree(parts));
    for (int i = 0; i < parts->n_here; i++)
        add_part(parts->part[i].bundle, sum, most);
    wb_team_sum(sum, N_SUMS);
    wb_team_greatest(most, N_MOST);
    take_sums(whole, sum, most);
    whole->time = parts->part[0].bundle->time;
    whole->steps = parts->part[0].bundle->steps;
    whole->has_moved = true;
    bring_tip(parts);
    return WB_OK;
}

void wb_bundle_parts_stop(struct wb_bundle_parts *parts)
{
    for (int i = 0; i < parts->n_here; i++)
        wb_bundle_stop(parts->part[i].bundle);
    parts->is_stale = true;
}

double wb_bundle_parts_potential(struct wb_bundle_parts *parts)
{
    double sum = 0.0;

    for (int i = 0; i < parts->n_here; i++)
        sum += wb_bundle_potential(parts->part[i].bundle);
    wb_team_sum(&sum, 1);
    return sum;
}

static void find_plastic_work(void *context, int member)
{
    struct wb_bundle_parts *parts = context;
    struct part *part = &parts->part[member - parts->first];

    part->plastic_work = wb_bundle_plastic_work(part->bundle);
}

void wb_bundle_parts_add_bonds(struct wb_bundle_parts *parts, double area[2])
{
    double sum[2] = {0.0, 0.0};

    for (int i = 0; i < parts->n_here; i++)
        wb_bundle_bond_add_areas(parts->part[i].bundle->bond, sum);
    wb_team_sum(sum, 2);
    area[0] += sum[0];
    area[1] += sum[1];
}

double wb_bundle_parts_plastic_work(struct wb_bundle_parts *parts)
{
    double sum = 0.0;

    wb_team_run(parts->team, find_plastic_work, parts);
    for (int i = 0; i < parts->n_here; i++)
        sum += parts->part[i].plastic_work;
    wb_team_sum(&sum, 1);
    return sum;
}

int wb_bundle_parts_count(const struct wb_bundle_parts *parts)
{
    return parts->count;
}

/* A part's state, from its rank to all. */
static void save_part(struct wb_bundle_parts *parts, int member, struct wb_checkpoint *out)
{
    struct part *part = part_here(parts, member);
    struct wb_checkpoint own;

    wb_checkpoint_init(&own);
    wb_checkpoint_enter(&own, "part %d", member + 1);
    if (part)
        wb_bundle_visit_fields(part->bundle, &own);
    size_t size = own.size;
    wb_team_share(&size, sizeof size, member / parts->n_here);
    unsigned char *bytes = part ? own.bytes : malloc(size);
    if (!bytes) {
        wb_error("no memory for a checkpoint of %zu bytes", size);
        wb_team_abort(1);
    }
    wb_team_share(bytes, size, member / parts->n_here);
    wb_checkpoint_append(out, bytes, size);
    if (!part)
        free(bytes);
    wb_checkpoint_release(&own);
}

/* A rank passes over the parts of others. */
static void restore_part(struct wb_bundle_parts *parts, int member, struct wb_checkpoint *in)
{
    struct part *part = part_here(parts, member);

    wb_checkpoint_enter(in, "part %d", member + 1);
    if (part)
        wb_bundle_visit_fields(part->bundle, in);
    else
        wb_checkpoint_skip(in);
    wb_checkpoint_leave(in);
}

void wb_bundle_parts_visit(struct wb_bundle_parts *parts, struct wb_checkpoint *checkpoint)
{
    for (int i = 0; i < parts->count; i++) {
        if (checkpoint->restores)
            restore_part(parts, i, checkpoint);
        else
            save_part(parts, i, checkpoint);
    }
    if (!checkpoint->restores)
        return;
    parts->is_stale = true;
    bring_tip(parts);
}

/* --- memory --- */

static enum wb_status make_parts(struct wb_bundle_parts *parts)
{
    const struct wb_bundle *whole = parts->whole;

    if (!find_borders(parts->halo, whole->n_stations, parts->count, parts->border))
        return wb_fail(WB_ERR_ARGUMENT,
                       "%s: mesh %s has too few stations (%d) for %d parts; use fewer ranks",
                       whole->model->path, whole->mesh->name, whole->n_stations, parts->count);
    for (int i = 0; i < parts->n_here; i++) {
        const int member = parts->first + i, begin = parts->border[member];
        const int end = parts->border[member + 1];
        const int before = member > 0 ? parts->halo : 0;
        const int after = member < parts->count - 1 ? parts->halo : 0;
        WB_TRY(wb_bundle_create_part(&parts->part[i].bundle, whole, begin - before,
                                     before + end - begin + after,
                                     (struct wb_swept_range){before, before + end - begin}));
    }
    return WB_OK;
}

enum wb_status wb_bundle_parts_create(struct wb_bundle_parts **out, struct wb_bundle *whole,
                                      int count)
{
    *out = NULL;
    struct wb_bundle_parts *parts = calloc(1, sizeof *parts);
    if (!parts)
        return wb_fail(WB_ERR_MEMORY, "out of memory for parts of a bundle");
    parts->whole = whole;
    parts->count = count;
    parts->n_here = count / wb_team_ranks();
    parts->halo = halo_of(whole->model, whole->mesh);
    parts->border = calloc((size_t)count + 1, sizeof *parts->border);
    parts->part = calloc((size_t)parts->n_here, sizeof *parts->part);
    enum wb_status status = WB_OK;
    if (!parts->border || !parts->part)
        status = wb_fail(WB_ERR_MEMORY, "out of memory for parts of a bundle");
    if (status == WB_OK)
        status = wb_team_create(&parts->team, parts->n_here, packet_size(whole, parts->halo));
    if (status == WB_OK) {
        parts->first = wb_team_first(parts->team);
        status = make_parts(parts);
    }
    status = wb_team_agree(status);
    if (status != WB_OK)
        wb_bundle_parts_destroy(parts);
    else
        *out = parts;
    return status;
}

void wb_bundle_parts_destroy(struct wb_bundle_parts *parts)
{
    if (!parts)
        return;
    wb_team_destroy(parts->team);
    for (int i = 0; parts->part && i < parts->n_here; i++)
        wb_bundle_destroy(parts->part[i].bundle);
    free(parts->border);
    free(parts->part);
    free(parts);
}
