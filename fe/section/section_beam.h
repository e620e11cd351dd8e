/* A taped bundle as one beam whose wires slip on each other: the section model.
 *
 * Each section along the bundle has one rotation theta and stays undeformed in its plane. Out of
 * its plane every wire i slips along the axis by a_i and every node of the tape by b_k. The bundle
 * bends in one plane, without twist. y is up; kappa = theta' > 0 bends the tip upwards.
 *
 *   wires    strain of a fibre a_i' - (y_i + eta) kappa, with the wire's own law
 *   tape     between two nodes, e = mean(b)' - y kappa and g = (b_2 - b_1) / length. Taut on wires
 *            its logarithmic strains are H11 = e - e^2/2 - g^2/4, H22 = g^2/4 - g^4/4 and
 *            2 H12 = g (1 - g^2/2), in plane stress; on a circle e and g, without hoop stress
 *   bonds    springs between b_k and a_i
 *   contact  friction between touching wires, elastic up to mu p. The contact forces p balance the
 *            transverse loads on the wires (fe/section/section_pressure.h): N_i kappa of each wire
 *            minus the mean, and the tape's hoop force. Each contact stores its friction force and
 *            slip, so friction has a history, also during unloading
 *   tip      x and y of the axis by the sines and cosines of theta; a vertical force, or a strand
 *
 * Elements have two stations and one integration point. The contact forces p follow from the state;
 * for constant p the equations have a potential, which the line search of the solver
 * (fe/section/section_solver.h) uses.
 *
 * Unknowns are those of stations 1 to n_elements, station by station in the order of
 * fe/section/section_layout.h; station 0 is clamped. A capped tip has two unknowns: its rotation
 * and one common slip.
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
    bool is_whole;         /* image wires have unknowns of their own */
    bool is_glued;         /* contacts never slip, whatever their force */
};

/* Loads on the bundle. */
struct wb_section_beam_loads {
    double vertical; /* V, N: vertical tip force, or vertical component of the strand's */
    double strand;   /* S, m; 0: vertical tip force */
    double weight;   /* N/m */
};

/* Energies since the bundle was straight, J: sums over the increments of mean force times
 * displacement; the weight grows from zero in the first increment. */
struct wb_section_beam_energies {
    double external;    /* work of the tip force and of the weight */
    double wires, tape; /* stored and plastic */
    double bonds;       /* stored */
    double friction;    /* dissipated, plus the small elastic energy of sticking contacts */
};

/* Strains of the tape's wall, and their derivatives with respect to e and g. */
struct wb_section_beam_wall {
    double e, g;
    double strain[3];
    double by_e[3], by_g[3];
};

/* Position of the tip, its force, and the weight. */
struct wb_section_beam_tip {
    double x, y;     /* m */
    double slope;    /* tan psi, psi: the strand's angle to the vertical */
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

    /* Trial state, and the last two committed states: (n_unknowns). */
    double *u, *committed, *before;
    /* Results of wb_section_beam_evaluate() for the trial state. */
    double *residual; /* (n_unknowns): internal forces minus loads */
    double *lever;    /* (n_unknowns): generalised force per newton of V */
    double *draw;     /* (n_unknowns): derivative of the tip's x */
    double axial;     /* N: largest of any wire: the scale of forces */
    struct wb_section_beam_tip tip;
    double missing;      /* largest imbalance of transverse loads, over the loads */
    double tape_plastic; /* 1: largest accumulated plastic strain of the tape */
    double fold;         /* 1: largest curvature times half the depth of the wires */
    int n_slipping;      /* number of slipping contacts, of all stations */

    /* Private to fe/section/section_beam*.c. */
    int history;                         /* doubles of a wire's history at an element */
    double *wires_before, *wires_after;  /* (n_elements x n_wires x history) */
    struct wb_fibres_response *response; /* (n_elements x n_wires) */
    struct wb_section_sheet_state *tape_before, *tape_after; /* (n_elements x n_segments) */
    struct wb_section_sheet_response *wall;                  /* (n_elements x n_segments) */
    struct wb_section_beam_wall *walls;                      /* (n_elements x n_segments) */
    /* The committed state, for energies. */
    struct wb_fibres_response *response_before;      /* (n_elements x n_wires) */
    double (*stress_before)[3], (*strain_before)[3]; /* (n_elements x n_segments) */
    struct wb_section_beam_tip tip_before;
    double *force; /* (n_elements x n_contacts) p */
    double *limit; /* (n_elements x n_contacts) N: of stations 1 and later */
    double *friction_before, *friction_now; /* (n_elements x n_contacts) N */
    double *load;                           /* (2 n_wires) */
    struct wb_section_beam_energies energies;
    struct wb_memory memory;
};

/* Allocates all memory; the bundle is straight and virgin. `mu` is the friction between wires.
 * Fails for bundles that wb_section_layout_check() rejects. */
WB_MUST_CHECK enum wb_status
wb_section_beam_create(struct wb_section_beam **out, const struct wb_bundle_model *model, double mu,
                       const struct wb_section_beam_settings *settings);
void wb_section_beam_destroy(struct wb_section_beam *beam); /* accepts NULL */

/* Computes the residual and the other results for the trial state. `press`: updates the friction
 * limits from that state; otherwise the last limits stay. */
void wb_section_beam_evaluate(struct wb_section_beam *beam,
                              const struct wb_section_beam_loads *loads, bool press);

/* Factors the tangent of the state last evaluated, without the stiffness from the rotation of a
 * strand (a multiple of draw draw^T). False: singular. */
bool wb_section_beam_factor(struct wb_section_beam *beam,
                            const struct wb_section_beam_loads *loads);

/* Commits the trial state, which must be the state last evaluated, and adds its increment to the
 * energies; or sets the trial state to the committed one. */
void wb_section_beam_commit(struct wb_section_beam *beam);
void wb_section_beam_revert(struct wb_section_beam *beam);

/* x and y (m) of the axis and its rotation at arc length s, in the trial state. */
void wb_section_beam_place(const struct wb_section_beam *beam, double s, double *x, double *y,
                           double *angle);

#endif
