/* Wires as rings of nodes for the tests of contact, with prescribed positions. */
#ifndef WB_TESTS_FE_SWEPT_CONTACTS_H
#define WB_TESTS_FE_SWEPT_CONTACTS_H

#include "tests/check.h"

#include <stdlib.h>

#include "fe/swept/swept_contact.h"

enum {
    CONTACTS_NODES = 8, /* of a section; the last one is a node in the middle, without contact */
    CONTACTS_SURFACE = 7,
    CONTACTS_MOST_WIRES = 8
};

struct contacts {
    int n_wires, n_stations;
    double spacing;
    double radius[CONTACTS_MOST_WIRES];
    bool is_double;
    struct wb_swept_layout layout;
    int surface[CONTACTS_SURFACE];
    double node[CONTACTS_MOST_WIRES][CONTACTS_NODES][2];
    double *position[CONTACTS_MOST_WIRES];
    void *force[CONTACTS_MOST_WIRES];
    struct wb_swept_contact *contact;
    struct wb_swept_contact_energies energies; /* of the last step */
    double friction, damping;                  /* dissipated so far */
};

/* Surface nodes are at uneven angles and slightly inside the contact radius. */
static inline void contacts_init(struct contacts *c,
                                 const struct wb_swept_contact_settings *settings, int n_wires,
                                 const double *radius, int n_stations, double spacing)
{
    struct wb_swept_wire wires[CONTACTS_MOST_WIRES];

    *c = (struct contacts){.n_wires = n_wires,
                           .n_stations = n_stations,
                           .spacing = spacing,
                           .is_double = settings->double_precision,
                           .layout = wb_swept_layout(CONTACTS_NODES, n_stations)};
    for (int w = 0; w < n_wires; w++) {
        c->radius[w] = radius[w];
        for (int k = 0; k < CONTACTS_SURFACE; k++) {
            const double angle = 2.0 * M_PI * k / CONTACTS_SURFACE + (k == 2 ? 0.2 : 0.0);
            c->surface[k] = k;
            c->node[w][k][0] = 0.97 * radius[w] * cos(angle);
            c->node[w][k][1] = 0.97 * radius[w] * sin(angle);
        }
        wires[w] = (struct wb_swept_wire){.n_nodes = CONTACTS_NODES,
                                          .n_surface = CONTACTS_SURFACE,
                                          .surface = c->surface,
                                          .node = (const double(*)[2])c->node[w],
                                          .radius = radius[w],
                                          .youngs_modulus = 1e9};
        c->position[w] = wb_swept_allocate(wb_swept_size(&c->layout), sizeof(double));
        c->force[w] = wb_swept_allocate(wb_swept_size(&c->layout),
                                        c->is_double ? sizeof(double) : sizeof(float));
    }
    assert_int_equal(
        wb_swept_contact_create(&c->contact, settings, n_wires, wires, n_stations, spacing), WB_OK);
}

struct contacts_pair {
    int wire[2];
    double stiffness; /* k, N/m2 */
    double normal;    /* sum over the stations, N */
    double smallest;  /* gap, m; negative: penetration */
};

static inline struct contacts_pair contacts_pair(const struct contacts *c, int pair)
{
    struct contacts_pair out = {.smallest = (double)INFINITY};
    for (int j = 0; j < c->n_stations; j++) {
        struct wb_swept_contact_point point;
        wb_swept_contact_get_point(c->contact, pair, j, &point);
        memcpy(out.wire, point.wire, sizeof out.wire);
        out.stiffness = point.stiffness;
        out.normal += point.length * point.normal;
        if (point.length > 0.0)
            out.smallest = fmin(out.smallest, point.gap);
    }
    return out;
}

static inline void contacts_release(struct contacts *c)
{
    wb_swept_contact_destroy(c->contact);
    for (int w = 0; w < c->n_wires; w++) {
        free(c->position[w]);
        free(c->force[w]);
    }
}

static inline struct wb_swept_contact_settings contacts_settings(void)
{
    struct wb_swept_contact_settings settings;
    wb_swept_contact_default_settings(&settings);
    settings.double_precision = true;
    return settings;
}

static inline ptrdiff_t contacts_index(const struct contacts *c, int node, int component,
                                       int station)
{
    return (ptrdiff_t)(3 * node + component) * c->layout.stride + station;
}

/* Columns of R are the directions of x, y, z of the section. */
static inline void contacts_place(struct contacts *c, int w, int station, const double centre[3],
                                  double R[3][3])
{
    for (int k = 0; k < CONTACTS_NODES; k++) {
        for (int i = 0; i < 3; i++)
            c->position[w][contacts_index(c, k, i, station)] =
                centre[i] + R[i][1] * c->node[w][k][0] + R[i][2] * c->node[w][k][1];
    }
}

/* A straight wire along x, its sections turned by `twist` about it. */
static inline void contacts_place_straight(struct contacts *c, int w, const double start[3],
                                           double twist)
{
    double R[3][3] = {
        {1.0, 0.0, 0.0}, {0.0, cos(twist), -sin(twist)}, {0.0, sin(twist), cos(twist)}};
    for (int j = 0; j < c->n_stations; j++)
        contacts_place(c, w, j, (double[3]){start[0] + c->spacing * j, start[1], start[2]}, R);
}

/* Two wires along x that penetrate by `depth`, the second at `angle` from +y and shifted along
 * x. */
static inline void contacts_make_pair(struct contacts *c,
                                      const struct wb_swept_contact_settings *settings,
                                      const double radius[2], double depth, double angle,
                                      double shift)
{
    contacts_init(c, settings, 2, radius, 21, 1e-3);
    const double distance = radius[0] + radius[1] - depth;
    contacts_place_straight(c, 0, (double[3]){0.0, 0.0, 0.0}, 0.3);
    contacts_place_straight(c, 1, (double[3]){shift, distance * cos(angle), distance * sin(angle)},
                            -1.1);
}

static inline enum wb_status contacts_try(struct contacts *c, double time_step)
{
    const size_t size = wb_swept_size(&c->layout) * (c->is_double ? sizeof(double) : sizeof(float));
    for (int w = 0; w < c->n_wires; w++)
        memset(c->force[w], 0, size);
    return wb_swept_contact_add_forces(c->contact, (const double *const *)c->position, c->force,
                                       time_step, &c->energies);
}

static inline void contacts_step(struct contacts *c, double time_step)
{
    assert_int_equal(contacts_try(c, time_step), WB_OK);
    c->friction += c->energies.friction;
    c->damping += c->energies.damping;
}

static inline double contacts_force(const struct contacts *c, int w, int node, int component,
                                    int station)
{
    const ptrdiff_t i = contacts_index(c, node, component, station);
    return c->is_double ? ((const double *)c->force[w])[i]
                        : (double)((const float *)c->force[w])[i];
}

/* Force on a wire at a station, and moment about `about`. */
static inline void contacts_wrench(const struct contacts *c, int w, int station,
                                   const double about[3], double force[3], double moment[3])
{
    for (int i = 0; i < 3; i++)
        force[i] = moment[i] = 0.0;
    for (int k = 0; k < CONTACTS_NODES; k++) {
        double f[3], r[3];
        for (int i = 0; i < 3; i++) {
            f[i] = contacts_force(c, w, k, i, station);
            r[i] = c->position[w][contacts_index(c, k, i, station)] - about[i];
            force[i] += f[i];
        }
        for (int i = 0; i < 3; i++)
            moment[i] += r[(i + 1) % 3] * f[(i + 2) % 3] - r[(i + 2) % 3] * f[(i + 1) % 3];
    }
}

static inline void contacts_total(const struct contacts *c, int w, const double about[3],
                                  double force[3], double moment[3])
{
    for (int i = 0; i < 3; i++)
        force[i] = moment[i] = 0.0;
    for (int j = 0; j < c->n_stations; j++) {
        double f[3], m[3];
        contacts_wrench(c, w, j, about, f, m);
        for (int i = 0; i < 3; i++) {
            force[i] += f[i];
            moment[i] += m[i];
        }
    }
}

/* Rotation by |v| about v. */
static inline void contacts_rotation(const double v[3], double R[3][3])
{
    const double angle = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const int k = 3 - i - j;
            const double sign = (j - i + 3) % 3 == 1 ? -1.0 : 1.0;
            const double n = angle > 0.0 ? v[i] * v[j] / (angle * angle) : 0.0;
            R[i][j] = i == j ? cos(angle) + (1.0 - cos(angle)) * n
                             : (1.0 - cos(angle)) * n +
                                   (angle > 0.0 ? sign * sin(angle) * v[k] / angle : 0.0);
        }
    }
}

/* Turns all nodes about the origin. */
static inline void contacts_turn(struct contacts *c, double R[3][3])
{
    for (int w = 0; w < c->n_wires; w++) {
        for (int n = 0; n < CONTACTS_NODES * c->n_stations; n++) {
            double x[3];
            for (int i = 0; i < 3; i++)
                x[i] = c->position[w][contacts_index(c, n / c->n_stations, i, n % c->n_stations)];
            for (int i = 0; i < 3; i++)
                c->position[w][contacts_index(c, n / c->n_stations, i, n % c->n_stations)] =
                    R[i][0] * x[0] + R[i][1] * x[1] + R[i][2] * x[2];
        }
    }
}

#endif
