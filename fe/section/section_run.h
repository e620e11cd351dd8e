/* A whole bending test of a bundle in the section model: rows in equal steps of the tip's
 * deflection up to the model's largest, and with cycles down to zero and so on, as
 * fe/bundle/bundle_run.h has them. Row 0 is at zero deflection with the weight on, and forces count
 * from there. Rows in which the strand is slack are where the tip hangs.
 *
 * Friction is one number here, because a static model has no rate: that of the file where it is
 * constant, otherwise the geometric mean of the static and the kinetic one.
 */
#ifndef WB_FE_SECTION_SECTION_RUN_H
#define WB_FE_SECTION_SECTION_RUN_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/linear/trial.h"
#include "fe/model/bundle_model.h"
#include "fe/section/section_homogenise.h"
#include "fe/section/section_solver.h"

/* Counted up whenever the same model comes to other numbers: datasets of before are outdated. */
enum {
    WB_SECTION_RUN_VERSION = 2
};

struct wb_section_run_row {
    int cycle; /* from 1 */
    enum wb_phase phase;
    double force; /* N: the vertical force less its value in row 0 */
    struct wb_section_solver_point point;
    struct wb_section_beam_energies energies;
};

/* The elastic bundle of some length, with the ends it has: a short one shears. */
struct wb_section_run_rigidity {
    double length;   /* m */
    double rigidity; /* E I = F L^3 / (3 d), N m2: of the homogenised beam of this length */
    double alpha; /* alpha L of Newmark's partial interaction that gives the same; NaN: none does,
                        or there is no tape */
};

enum {
    WB_SECTION_RUN_LENGTHS = 3 /* a half, one and two times the model's */
};

struct wb_section_run {
    int n_rows, capacity;
    struct wb_section_run_row *rows; /* (n_rows), owned; only those reached */
    int n_shape;
    double *shape_s;    /* (n_shape) m, owned */
    double (*shape)[3]; /* (n_rows x n_shape), m, owned */
    bool converged;     /* false: ends early, at `lost` */
    bool stopped;       /* by the caller */
    struct wb_section_solver_point lost;
    double zero_force; /* N: subtracted from `force` */
    double friction;   /* mu */
    bool is_mean;      /* of a friction that decays */
    bool is_mirrored;
    int elements, unknowns; /* along the bundle, of all stations */
    long iterations;        /* of Newton's method, in all */
    int increments;
    double residual, missing; /* largest of all rows */
    double imbalance;         /* largest, over the largest external work so far */
    double tape_plastic;      /* largest */
    /* Moment over curvature of the homogenised beam of this length and these ends, from a loading
     * without weight by a vertical force; (n_curve) owned. */
    int n_curve;
    struct wb_section_homogenise_point *curve;
    struct wb_section_run_rigidity rigidity[WB_SECTION_RUN_LENGTHS];
};

/* Room for a model's rows and n_shape (at least 2) equally spaced positions. */
WB_MUST_CHECK enum wb_status wb_section_run_init(struct wb_section_run *run,
                                                 const struct wb_bundle_model *model, int n_shape);
void wb_section_run_release(struct wb_section_run *run); /* accepts a zeroed one */

struct wb_section_run_settings {
    bool (*stop)(void *context); /* asked before every row, true ends the run; NULL: never */
    void *context;
    bool until_free;    /* the last unloading ends in the first row whose force is not above zero */
    bool no_rigidities; /* `rigidity` stays empty */
};

/* Computes the test, the curve and the rigidities. `settings` NULL: all zero. Refuses what
 * fe/section/section_layout.h refuses; not converging is a result. */
WB_MUST_CHECK enum wb_status wb_section_run(struct wb_section_run *run,
                                            const struct wb_bundle_model *model,
                                            const struct wb_section_run_settings *settings);

/* The part of the largest deflection that springs back when the force of the first loading is let
 * go, from 0 to 1: 1 - d_0 / d_max, with the deflection d_0 where the unloading reaches zero force.
 * NaN: there is no unloading, or it ends before. */
double wb_section_run_springback(const struct wb_section_run *run);

/* The deflection (m) from which on the section model is too stiff, by 14 to 35 % at the end of the
 * explicit runs: there the tape on its circle has a plastic strain beyond 0.010, and its outline
 * lets go of the wires. NaN: it stays below, or the tape lies taut on the wires. */
double wb_section_run_loosens(const struct wb_section_run *run,
                              const struct wb_bundle_model *model);

/* The deflection (m) from which on the bundle bends to a radius below its own depth: no beam's
 * strains mean much there. NaN: it does not. */
double wb_section_run_folds(const struct wb_section_run *run);

#endif
