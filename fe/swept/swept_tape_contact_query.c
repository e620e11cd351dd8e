#include <math.h>
#include <string.h>

#include "fe/swept/swept_tape_contact_private.h"

enum {
    LANES = WB_SWEPT_LANES,
    ROWS = WB_SWEPT_TAPE_CONTACT_ROWS,
    HISTORY = WB_SWEPT_TAPE_CONTACT_HISTORY
};

static const struct wb_swept_layout *layout_of(const struct wb_swept_tape_contact *c)
{
    return &c->tape->model.layout;
}

static size_t real_size(const struct wb_swept_tape_contact *c)
{
    return c->tape->model.double_precision ? sizeof(double) : sizeof(float);
}

/* --- checkpoints --- */

struct piece {
    void *data;
    size_t size;
};

enum {
    PIECES = 8
};

/* All there is room for, so that the size is fixed. */
static void list_pieces(const struct wb_swept_tape_contact *c, struct piece out[PIECES])
{
    struct wb_swept_tape_contact *changeable;
    const struct wb_swept_layout *layout = layout_of(c);
    const size_t places = (size_t)layout->n_nodes * (size_t)layout->n_stations;
    const size_t blocks = (size_t)layout->stride / LANES;

    memcpy(&changeable, &c, sizeof changeable);
    const struct piece pieces[PIECES] = {
        {&changeable->steps, sizeof c->steps},
        {&changeable->n_strips, sizeof c->n_strips},
        {&changeable->n_near, sizeof c->n_near},
        {c->first, (blocks + 1) * sizeof *c->first},
        {c->strip, places * sizeof *c->strip},
        {c->near, places * sizeof *c->near},
        {c->rows, places * ROWS * LANES * real_size(c)},
        {c->history, (size_t)layout->n_nodes * HISTORY * (size_t)layout->stride * real_size(c)},
    };
    memcpy(out, pieces, sizeof pieces);
}

size_t wb_swept_tape_contact_state_size(const struct wb_swept_tape_contact *contact)
{
    struct piece pieces[PIECES];
    size_t size = 0;

    list_pieces(contact, pieces);
    for (int i = 0; i < PIECES; i++)
        size += pieces[i].size;
    return size;
}

void wb_swept_tape_contact_save(const struct wb_swept_tape_contact *contact, void *state)
{
    struct piece pieces[PIECES];
    unsigned char *at = state;

    list_pieces(contact, pieces);
    for (int i = 0; i < PIECES; i++) {
        memcpy(at, pieces[i].data, pieces[i].size);
        at += pieces[i].size;
    }
}

void wb_swept_tape_contact_restore(struct wb_swept_tape_contact *contact, const void *state)
{
    struct piece pieces[PIECES];
    const unsigned char *at = state;

    list_pieces(contact, pieces);
    for (int i = 0; i < PIECES; i++) {
        memcpy(pieces[i].data, at, pieces[i].size);
        at += pieces[i].size;
    }
}

/* --- stable step --- */

static double largest_stiffness(const struct wb_swept_tape_contact *c)
{
    return fmax(c->settings.normal_stiffness, c->settings.shear_stiffness);
}

/* See fe/swept/swept_cohesion.c. */
static const double both_sides = 2.0;

static double largest_area(const struct wb_swept_tape_contact *c)
{
    const struct wb_swept_layout *layout = layout_of(c);
    double area = 0.0;

    for (int k = 0; k < layout->n_nodes; k++) {
        for (int j = 1; j < layout->n_stations - 1; j++)
            area = fmax(area, wb_swept_tape_area(c->tape, k, j));
        for (int j = 0; j < layout->n_stations; j += layout->n_stations - 1)
            area = fmax(area, 2.0 * wb_swept_tape_area(c->tape, k, j));
    }
    return area;
}

double wb_swept_tape_contact_stiffness_per_mass(const struct wb_swept_tape_contact *contact,
                                                const double *mass, const double *inertia)
{
    double most = 0.0;

    for (int w = 0; w < contact->n_wires; w++) {
        /* The place lies on a chord, at most so far below the circle. */
        const double below = contact->surface[w].radius * (1.0 - cos(M_PI / contact->surface[w].n));
        const double o = 0.5 * contact->tape->model.thickness + below;
        for (int k = 0; k < layout_of(contact)->n_nodes; k++)
            most = fmax(most, 1.0 / mass[k] + o * o / inertia[k]);
    }
    return both_sides * largest_stiffness(contact) * largest_area(contact) * most;
}

double wb_swept_tape_contact_wire_stiffness_per_mass(const struct wb_swept_tape_contact *contact,
                                                     int wire, const double *mass)
{
    const struct wb_swept_tape_contact_surface *surface = &contact->surface[wire];
    const double spacing = contact->tape->model.spacing, area = largest_area(contact);
    /* A surface node has the tape's nodes on the two chords beside it, by weights from 0 to 1: at
     * most one more than those of a chord. */
    const double chord = 2.0 * surface->radius * sin(M_PI / surface->n);
    const double nodes = chord * spacing / area + 1.0;
    double least = (double)INFINITY;

    for (int s = 0; s < surface->n; s++)
        least = fmin(least, mass[surface->node[s]]);
    return both_sides * largest_stiffness(contact) * area * nodes / least;
}
