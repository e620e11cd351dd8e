/* What is asked of a contact beside its forces: a bound for the stable step, the neighbours, and
 * checkpoints. */
#include <math.h>
#include <string.h>

#include "fe/swept/swept_contact_private.h"

#define WB_LOG_DOMAIN "contact"

enum {
    FEWEST_NEIGHBOURS = 6
};

/* The energy of a pair's springs is at most that of springs of twice the stiffness to either wire:
 * k (u_a - u_b)^2 <= 2 k u_a^2 + 2 k u_b^2. On a wire, a displacement u = sum w x has u^2 <= |w|^2
 * sum m x^2 with |w|^2 = sum w^2 / m; selective mass scaling makes it that below. Towards a
 * neighbour w = a; along the axis w = a + r (b cos + e sin); around it a, and of the turn about the
 * axis half the square of the slopes' at most. Of n neighbours all round, every direction in the
 * section takes n / 2. Stiffnesses and masses are per length. */
double wb_swept_contact_stiffness_per_mass(const struct wb_swept_contact *contact, int wire,
                                           const double *node_mass, double selective)
{
    const struct wb_swept_contact_frames *frames = &contact->model.wire[wire];
    const double r = contact->radius[wire];
    double G[3][3] = {{0.0}}, total = 0.0, normal = 0.0;
    int neighbours = 0;

    for (int k = 0; k < frames->n_nodes; k++) {
        if (!(node_mass[k] > 0.0))
            return (double)INFINITY;
        total += node_mass[k];
    }
    for (int k = 0; k < frames->n_surface; k++) {
        const double *w = frames->weight[k];
        for (int i = 0; i < 9; i++)
            G[i / 3][i % 3] += w[i / 3] * w[i % 3] / (selective * node_mass[frames->node[k]]);
    }
    G[0][0] += (1.0 - 1.0 / selective) / total;
    for (int p = 0; p < contact->model.n_pairs; p++) {
        const struct wb_swept_contact_pair_rows *pair = &contact->model.pair[p];
        if (pair->wire[0] == wire || pair->wire[1] == wire) {
            neighbours++;
            normal = fmax(normal, pair->normal);
        }
    }
    if (neighbours < FEWEST_NEIGHBOURS) {
        neighbours = FEWEST_NEIGHBOURS;
        for (int w = 0; w < contact->model.n_wires; w++)
            normal = fmax(normal, wb_swept_contact_stiffness(contact, wire, w));
    }
    const double tangential = contact->settings.tangential_ratio * normal;
    const double slopes = 0.5 * (G[1][1] + G[2][2]) + hypot(0.5 * (G[1][1] - G[2][2]), G[1][2]);
    const double cross = hypot(G[0][1], G[0][2]);
    const double along = tangential * (G[0][0] + 0.5 * r * r * slopes + r * cross);
    const double across =
        0.5 * (normal + tangential) * G[0][0] + 0.5 * tangential * (r * r * slopes + r * cross);
    return 2.0 * neighbours * fmax(along, across);
}

int wb_swept_contact_pairs(const struct wb_swept_contact *contact)
{
    return contact->model.n_pairs;
}

void wb_swept_contact_get_point(const struct wb_swept_contact *contact, int pair, int station,
                                struct wb_swept_contact_point *out)
{
    const struct wb_swept_contact_pair_rows *of = &contact->model.pair[pair];
    const ptrdiff_t row = contact->model.row;
    double place[2], between[3], square = 0.0;

    for (int side = 0; side < 2; side++)
        place[side] = station + wb_swept_contact_pair_row(contact, of,
                                                          WB_SWEPT_CONTACT_OFFSET + side)[station];
    for (int i = 0; i < 3; i++) {
        double at[2];
        for (int side = 0; side < 2; side++)
            at[side] = wb_swept_contact_between(
                contact, wb_swept_contact_centre_row(contact, of->wire[side], i), place[side]);
        between[i] = at[1] - at[0];
        square += between[i] * between[i];
    }
    const double distance = sqrt(square);
    *out = (struct wb_swept_contact_point){
        .gap = distance - of->reach,
        .length = wb_swept_contact_get(contact, of->load, WB_SWEPT_CONTACT_LENGTH * row + station),
        .shift = place[1] - place[0],
        .normal = of->normal * fmax(0.0, of->reach - distance),
    };
    for (int i = 0; i < 3; i++) {
        out->normal_direction[i] = distance > 0.0 ? between[i] / distance : 0.0;
        out->friction[i] =
            wb_swept_contact_get(contact, of->load, (WB_SWEPT_CONTACT_DRAG + i) * row + station);
    }
}

void wb_swept_contact_get_pair(const struct wb_swept_contact *contact, int pair,
                               struct wb_swept_contact_pair *out)
{
    const struct wb_swept_contact_pair_rows *of = &contact->model.pair[pair];

    *out = (struct wb_swept_contact_pair){
        .wire = {of->wire[0], of->wire[1]},
        .stiffness = of->normal,
        .smallest = (double)INFINITY,
    };
    for (int j = 0; j < contact->model.n_stations; j++) {
        struct wb_swept_contact_point point;
        wb_swept_contact_get_point(contact, pair, j, &point);
        out->normal += point.length * point.normal;
        if (point.length > 0.0)
            out->smallest = fmin(out->smallest, point.gap);
    }
}

enum wb_transfer {
    TRANSFER_SIZE,
    TRANSFER_SAVE,
    TRANSFER_RESTORE
};

struct transfer {
    enum wb_transfer what;
    unsigned char *at;
    size_t size;
};

static void carry(struct transfer *t, void *data, size_t size)
{
    if (t->what == TRANSFER_SAVE)
        memcpy(t->at + t->size, data, size);
    if (t->what == TRANSFER_RESTORE)
        memcpy(data, t->at + t->size, size);
    t->size += size;
}

/* A checkpoint's numbers in their order; all pairs there is room for, so that its size is fixed. */
static void carry_all(struct wb_swept_contact *c, struct transfer *t)
{
    struct wb_swept_contact_model *m = &c->model;
    const size_t stations = sizeof(double) * (size_t)m->n_stations;
    const size_t loads = wb_swept_contact_real_size(c) *
                         (WB_SWEPT_CONTACT_LOAD * (size_t)m->row - 2 * (size_t)m->stride);

    carry(t, &c->step, sizeof c->step);
    carry(t, &m->started, sizeof m->started);
    carry(t, &m->n_pairs, sizeof m->n_pairs);
    carry(t, c->searched, 3 * stations * (size_t)m->n_wires);
    for (int w = 0; w < m->n_wires; w++) {
        for (int i = 0; i < 3; i++)
            carry(t, wb_swept_contact_centre_row(c, w, i), stations);
        for (int i = WB_SWEPT_CONTACT_P; i < WB_SWEPT_CONTACT_TANGENT; i++)
            carry(t, wb_swept_contact_fixed_row(c, w, i), stations);
    }
    for (int p = 0; p < c->most_pairs; p++) {
        struct wb_swept_contact_pair_rows *pair = &m->pair[p];
        carry(t, pair->wire, sizeof pair->wire);
        carry(t, pair->active, (size_t)m->n_blocks);
        for (int i = 0; i < WB_SWEPT_CONTACT_PAIR; i++)
            carry(t, wb_swept_contact_pair_row(c, pair, i), stations);
        carry(t, pair->load, loads);
    }
}

/* Sizing and saving change nothing, but share the walk with restoring. */
static struct wb_swept_contact *as_changeable(const struct wb_swept_contact *contact)
{
    struct wb_swept_contact *out;
    memcpy(&out, &contact, sizeof out);
    return out;
}

size_t wb_swept_contact_state_size(const struct wb_swept_contact *contact)
{
    struct transfer t = {TRANSFER_SIZE, NULL, 0};
    carry_all(as_changeable(contact), &t);
    return t.size;
}

void wb_swept_contact_save(const struct wb_swept_contact *contact, void *state)
{
    struct transfer t = {TRANSFER_SAVE, state, 0};
    carry_all(as_changeable(contact), &t);
}

void wb_swept_contact_restore(struct wb_swept_contact *contact, const void *state)
{
    struct transfer t = {TRANSFER_RESTORE, NULL, 0};

    memcpy(&t.at, &state, sizeof t.at);
    carry_all(contact, &t);
    for (int p = 0; p < contact->model.n_pairs; p++) {
        struct wb_swept_contact_pair_rows *pair = &contact->model.pair[p];
        wb_swept_contact_search_pair(contact, pair, pair->wire[0], pair->wire[1]);
        wb_swept_contact_search_windows(contact, pair);
    }
    wb_swept_contact_search_sides(contact);
}
