/* A taped bundle as one beam whose wires slide on each other: the section model.
 *
 * Each section along the bundle turns by one rotation theta and stays as it is in its plane. In it
 * every wire i slips along the axis by a_i and every node of the tape by b_k. The bundle bends in
 * one plane: it does not twist, nor leave the plane. y is up; kappa = theta' > 0 bends the tip
 * upwards.
 *
 *   wires    strain of a fibre a_i' - (y_i + eta) kappa, with the wire's own law
 *   tape     between two nodes, e = mean(b)' - y kappa and g = (b_2 - b_1) / length. Taut on wires
 *            its logarithmic strains are H11 = e - e^2/2 - g^2/4, H22 = g^2/4 - g^4/4 and
 *            2 H12 = g (1 - g^2/2), in plane stress; on a circle e and g, without hoop stress
 *   bonds    springs between b_k and a_i
 *   contact  friction between wires that touch, elastic up to mu p. p is what balances the wires in
 *            the plane (fe/section/section_pressure.h): N_i kappa of each wire less the mean, and
 *            the tape's hoop force. A force and a slip are stored for each contact: the friction
 *            has a history, through unloading, too
 *   tip      x and y of the axis by the sines and cosines of theta; a vertical force, or a strand
 *
 * Elements have two stations and one point. The pressure p follows from the state; for given p
 * there is a potential, along which the solver (fe/section/section_solver.h) can search.
 *
 * Unknowns are those of stations 1 to n_elements, station by station as fe/section/section_layout.h
 * orders them; station 0 is clamped. A capped tip has two: its rotation and one slip of all.
 */
#ifndef WB_FE_SECTION_SECTION_BEAM_H
#define WB_FE_SECTION_SECTION_BEAM_H

#include <stdbool.h>

#include "base/memory.h"
#include "base/status.h"
#include "fe/linear/layered.h"
#include "fe/model/bundle_model.h"
#include "fe/rod/fibres.h"
#include "fe/section/section_layout.h"
#include "fe/section/section_pressure.h"
#include "fe/section/section_sheet.h"

struct wb_section_beam_settings {
    int n_elements;        /* 0: 24 */
    int n_fibres;          /* of a wire, over its height; 0: 8 */
    double slip_stiffness; /* k_t, Pa: of a contact before it slips; 0: 30 N/mm2 */
    bool is_elastic;       /* nothing yields */
    bool is_whole;         /* images have unknowns of their own */
    bool is_glued;         /* contacts do not slip, whatever presses them */
};

/* Forces that hold the bundle. */
struct wb_section_beam_loads {
    double vertical; /* V, N: of the tip's force or of the strand's */
    double strand;   /* S, m; 0: the force is vertical */
    double weight;   /* N/m */
};

/* Since the bundle was straight, J: sums over the increments of mean forces times what moved; the
 * weight grows from nothing in the first. */
struct wb_section_beam_energies {
    double external;    /* of the tip's force and of the weight */
    double wires, tape; /* stored and plastic */
    double bonds;       /* stored */
    double friction;    /* spent, with the little that contacts store before they slip */
};

/* Strains of the tape's wall, and their derivatives by e and g. */
struct wb_section_beam_wall {
    double e, g;
    double strain[3];
    double by_e[3], by_g[3];
};

/* The tip, and what is lifted. */
struct wb_section_beam_tip {
    double x, y;     /* m */
    double slope;    /* tan psi of the strand */
    double vertical; /* N */
    double height;   /* m2: integral of y over the length */
    double weight;   /* N/m */
};

struct wb_section_beam {
    const struct wb_bundle_model *model; /* borrowed */
    struct wb_section_layout layout;
    struct wb_section_beam_settings settings;
    double friction; /* mu */
    double h;        /* m, of an element */
    int n_elements, n_unknowns, per_station;
    struct wb_fibres *fibres[WB_BUNDLE_MODEL_TYPES];
    struct wb_material tape_material;
    struct wb_section_sheet sheet;
    struct wb_section_pressure *pressure;
    struct wb_layered *matrix;

    /* Trial state, and the last two committed ones: (n_unknowns). */
    double *u, *committed, *before;
    /* Of the trial state, by wb_section_beam_evaluate(). */
    double *residual;     /* (n_unknowns): internal forces less loads */
    double *lever;        /* (n_unknowns): what V does per newton */
    double *draw;         /* (n_unknowns): derivative of x of the tip */
    double axial, moment; /* N, N m: largest of any wire, of any section: what forces scale with */
    struct wb_section_beam_tip tip;
    double missing; /* of the balance in the plane, over the loads: the largest of all elements */
    double tape_plastic; /* 1: largest accumulated plastic strain of the tape */
    double fold;         /* 1: largest curvature times half the depth of the wires */
    int n_slipping;      /* contacts at their limit, of all stations */

    /* The rest is the beam's own. */
    int history;                                             /* doubles of a wire at an element */
    double *wires_before, *wires_after;                      /* (n_elements x n_wires x history) */
    struct wb_fibres_response *response;                     /* (n_elements x n_wires) */
    struct wb_section_sheet_state *tape_before, *tape_after; /* (n_elements x n_segments) */
    struct wb_section_sheet_response *wall;                  /* (n_elements x n_segments) */
    struct wb_section_beam_wall *walls;                      /* (n_elements x n_segments) */
    /* Of the committed state, for energies. */
    struct wb_fibres_response *response_before;      /* (n_elements x n_wires) */
    double (*stress_before)[3], (*strain_before)[3]; /* (n_elements x n_segments) */
    struct wb_section_beam_tip tip_before;
    double *force;                          /* (n_elements x n_contacts) p */
    double *limit;                          /* (n_elements x n_contacts) N: of stations 1 on */
    double *friction_before, *friction_now; /* (n_elements x n_contacts) N */
    double *load;                           /* (2 n_wires) */
    struct wb_section_beam_energies energies;
    struct wb_memory memory;
};

/* Takes all memory; the bundle is straight and virgin. `mu` is the friction between wires. Refuses
 * what fe/section/section_layout.h refuses. */
WB_MUST_CHECK enum wb_status
wb_section_beam_create(struct wb_section_beam **out, const struct wb_bundle_model *model, double mu,
                       const struct wb_section_beam_settings *settings);
void wb_section_beam_destroy(struct wb_section_beam *beam); /* accepts NULL */

/* An unknown of a station (0 to n_elements): its index, or -1 where it is held. */
int wb_section_beam_index(const struct wb_section_beam *beam, int station, int unknown);

/* The value in a vector of unknowns; 0 where it is held. */
static inline double wb_section_beam_value(const struct wb_section_beam *beam, const double *u,
                                           int station, int unknown)
{
    const int index = wb_section_beam_index(beam, station, unknown);
    return index < 0 ? 0.0 : u[index];
}

/* What a station stands for along the bundle, m: half an element at the tip. */
static inline double wb_section_beam_share(const struct wb_section_beam *beam, int station)
{
    return station == beam->n_elements ? 0.5 * beam->h : beam->h;
}

/* Of the tape, m3: a segment at an element, with its image. */
static inline double wb_section_beam_volume(const struct wb_section_beam *beam,
                                            const struct wb_section_segment *segment)
{
    return segment->weight * segment->thickness * segment->length * beam->h;
}

/* Residual and what goes with it, of the trial state: with the limits of friction that follow from
 * it, or as they were (`press` false). */
void wb_section_beam_evaluate(struct wb_section_beam *beam,
                              const struct wb_section_beam_loads *loads, bool press);

/* Tangent of the state evaluated last, without what a strand's turn adds (a product of `draw` with
 * itself), factored. False: singular. */
bool wb_section_beam_factor(struct wb_section_beam *beam,
                            const struct wb_section_beam_loads *loads);

/* Committed = trial, which was evaluated last; trial = committed. */
void wb_section_beam_commit(struct wb_section_beam *beam);
void wb_section_beam_revert(struct wb_section_beam *beam);

/* x and y (m) of the axis and its rotation at the arc length s, of the trial state. */
void wb_section_beam_place(const struct wb_section_beam *beam, double s, double *x, double *y,
                           double *angle);

#endif
