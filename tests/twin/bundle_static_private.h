/* What the parts of tests/twin/bundle_static.h share. */
#ifndef WB_TESTS_TWIN_BUNDLE_STATIC_PRIVATE_H
#define WB_TESTS_TWIN_BUNDLE_STATIC_PRIVATE_H

#include <stddef.h>

#include "fe/rod/fibres.h"
#include "tests/twin/bundle_static.h"
#include "tests/twin/bundle_static_sheet.h"

enum {
    WB_BUNDLE_STATIC_WIRE = 4, /* fields of a wire's node: x, y, z, rotation */
    WB_BUNDLE_STATIC_RING =
        3, /* of the tape's: opening along, up and across, in the wire's frame */
    WB_BUNDLE_STATIC_MOST = 32, /* unknowns of a contribution */
    WB_BUNDLE_STATIC_POINTS = 2 /* of a tape's element, round the ring */
};

struct wb_bundle_static_beam {
    double y, z;         /* m, of the straight wire */
    double radius, mass; /* m, kg/m */
    double youngs_modulus;
    double lateral; /* E I, N m2 */
    int type;
    int mirror;                         /* the wire at -z; itself where z = 0 */
    bool leads;                         /* its unknowns are those of the pair */
    int unknown[WB_BUNDLE_STATIC_WIRE]; /* in a station's block; -1: none */
    double sign;                        /* of z */
    double share;                       /* of the tip's force */
};

/* A line of the tape's nodes. */
struct wb_bundle_static_line {
    int wire;
    double y, z;      /* m, of the node from the wire's centre */
    double normal[2]; /* y, z: outwards */
    double bonded;    /* m, width that is tied to the wire */
    int mirror;
    bool leads;
    int unknown[WB_BUNDLE_STATIC_RING];
    double sign;
    double chord, width; /* m, to the next line: reference length, and as it counts */
};

/* A pair of wires at a station. */
struct wb_bundle_static_touch {
    bool active;
    int node[2];             /* the place on either wire lies between this node and the next, */
    double part[2];          /* at this part of the way */
    double shift;            /* in elements */
    double along, angle[2];  /* of the committed state: m, rad */
    double drag, trial_drag; /* N/m, friction on the second wire against its slip forwards */
    double normal;           /* N/m, trial */
    double pressure;         /* N/m, normal force that friction goes by where it is frozen */
    double depth;            /* m, trial */
    double slip, trial_slip; /* m, plastic, summed up */
    double work, trial_work; /* J/m dissipated */
    bool limit;
};

struct wb_bundle_static_pair {
    int wire[2];
    double reach;                         /* m, r_a + r_b */
    double normal, tangential;            /* stiffnesses, N/m2 */
    struct wb_bundle_static_touch *touch; /* (n_stations) */
};

struct wb_bundle_static_element {
    double strain[3], force[3]; /* axial, shear, curvature (1, 1, 1/m); N, N, N m */
};

struct wb_bundle_static_tape_point {
    struct wb_bundle_static_sheet_state history;
    double strain[3], stress[3]; /* 11, 22, twice 12 (logarithmic); 11, 22, 12, Pa */
};

/* Unknowns of one contribution; signs are of mirror images. */
struct wb_bundle_static_place {
    int n;
    int unknown[WB_BUNDLE_STATIC_MOST];
    double sign[WB_BUNDLE_STATIC_MOST];
};

struct wb_bundle_static {
    const struct wb_bundle_model *model;
    struct wb_bundle_static_settings settings;
    int n_elements, n_stations, held; /* held: the last station that is */
    double h;                         /* m, an element's length */
    double gravity;

    int n_wires;
    struct wb_bundle_static_beam *wire;
    struct wb_fibres *fibres[WB_BUNDLE_MODEL_TYPES];
    size_t row[WB_BUNDLE_MODEL_TYPES], *history_at; /* doubles of a point; (n_wires) its first */
    size_t history_size;
    double *history, *trial_history;

    int n_pairs;
    struct wb_bundle_static_pair *pair;

    bool has_tape;
    int n_lines;
    struct wb_bundle_static_line *line;
    double thickness, tape_mass; /* m, kg/m of all lines */
    struct wb_bundle_static_sheet sheet;
    struct wb_bundle_static_tape_point *point, *trial_point; /* (n_lines x n_elements x POINTS) */

    /* States: positions, strains, openings, then the tip's vertical force and the weight's part. */
    size_t strain_at, ring_at, force_at, weight_at, state_size;
    double *trial, *committed, *earlier, *saved; /* saved: in an iteration */
    /* (n_wires x n_elements) of the wires that lead, trial and committed. */
    struct wb_bundle_static_element *element, *committed_element;

    /* The system. Column-major band of LAPACK. */
    int block, n_unknowns, band, most_band, rows;
    double *matrix, *residual, *push, *solution;
    double *per_unit; /* (block) 1, or 1 / length of moments, to compare residuals */
    int *pivot;
    double largest_force;  /* N, of the last evaluation */
    double smallest_force; /* N: below it residuals are round-off of positions */

    struct wb_bundle_static_point last;
    double last_step, target; /* m */
    bool slack;
    bool frozen; /* friction goes by the normal forces of an outer iteration */
    double external, wire_work, tape_work; /* J */
};

static inline double *wb_bundle_static_wire_field(const struct wb_bundle_static *b, double *state,
                                                  int wire, int field)
{
    return state + (size_t)(wire * WB_BUNDLE_STATIC_WIRE + field) * (size_t)b->n_stations;
}

/* 0: axial, 1: shear. */
static inline double *wb_bundle_static_strain(const struct wb_bundle_static *b, double *state,
                                              int wire, int field)
{
    return state + b->strain_at + (size_t)(wire * 2 + field) * (size_t)b->n_elements;
}

static inline double *wb_bundle_static_ring_field(const struct wb_bundle_static *b, double *state,
                                                  int line, int field)
{
    return state + b->ring_at +
           (size_t)(line * WB_BUNDLE_STATIC_RING + field) * (size_t)b->n_stations;
}

/* Length that a station stands for, m. */
static inline double wb_bundle_static_length(const struct wb_bundle_static *b, int station)
{
    return station == 0 || station == b->n_stations - 1 ? 0.5 * b->h : b->h;
}

/* Appends an unknown of a wire's or the tape's node. */
void wb_bundle_static_name_wire(const struct wb_bundle_static *bundle, int wire, int field,
                                int station, struct wb_bundle_static_place *place);
void wb_bundle_static_name_line(const struct wb_bundle_static *bundle, int line, int field,
                                int station, struct wb_bundle_static_place *place);

/* Adds internal forces (place->n) and a tangent (n x n, row-major). */
void wb_bundle_static_add(struct wb_bundle_static *bundle,
                          const struct wb_bundle_static_place *place, const double *force,
                          const double *tangent);

/* Parts of an evaluation of the trial state. */
void wb_bundle_static_add_wires(struct wb_bundle_static *bundle);
void wb_bundle_static_add_contact(struct wb_bundle_static *bundle);
void wb_bundle_static_add_tape(struct wb_bundle_static *bundle);

/* Positions of the wires' nodes from strains and rotations; mirror images from their originals. */
void wb_bundle_static_place_wires(struct wb_bundle_static *bundle, double *state);

/* Finds the places that face each other in the trial state, and what they were in the committed
 * one. */
void wb_bundle_static_face(struct wb_bundle_static *bundle);
/* Takes over the present normal forces for friction. */
void wb_bundle_static_freeze(struct wb_bundle_static *bundle);
void wb_bundle_static_commit_contact(struct wb_bundle_static *bundle);

WB_MUST_CHECK enum wb_status wb_bundle_static_make_contact(struct wb_bundle_static *bundle);
WB_MUST_CHECK enum wb_status wb_bundle_static_make_tape(struct wb_bundle_static *bundle);
/* The line at -z of each, and which of both leads. */
WB_MUST_CHECK enum wb_status wb_bundle_static_mirror_tape(struct wb_bundle_static *bundle);
/* Largest principal strain, in size, of the committed tape. */
double wb_bundle_static_tape_strain(const struct wb_bundle_static *bundle);

/* Work of the present increment on wires and on the tape, from committed to trial, J. */
double wb_bundle_static_wire_work(const struct wb_bundle_static *bundle);
double wb_bundle_static_tape_work(const struct wb_bundle_static *bundle);

/* Energies of the committed state, J. */
void wb_bundle_static_contact_energy(const struct wb_bundle_static *bundle, double *stored,
                                     double *dissipated);
double wb_bundle_static_bond_energy(const struct wb_bundle_static *bundle);

#endif
