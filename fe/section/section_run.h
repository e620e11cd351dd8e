/* A complete bending test of a bundle in the section model: rows in equal steps of the tip's
 * deflection up to the model's maximum, with cycles down to zero and so on, as in
 * fe/bundle/bundle_run.h. Row 0 is at zero deflection with the weight applied; forces are relative
 * to row 0. In rows with a slack strand the deflection is that of the free tip.
 *
 * Friction is one number, because a static model has no sliding velocity: the file's coefficient if
 * it is constant, otherwise the geometric mean of the static and the kinetic one.
 */
#ifndef WB_FE_SECTION_SECTION_RUN_H
#define WB_FE_SECTION_SECTION_RUN_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/linear/trial.h"
#include "fe/model/bundle_model.h"
#include "fe/section/section_homogenise.h"
#include "fe/section/section_solver.h"

/* Increase whenever results for the same model change: older datasets are then outdated. */
enum {
    WB_SECTION_RUN_VERSION = 2
};

struct wb_section_run_row {
    int cycle; /* from 1 */
    enum wb_phase phase;
    double force; /* N: the vertical force minus its value in row 0 */
    struct wb_section_solver_point point;
    struct wb_section_beam_energies energies;
};

/* Elastic rigidity of a bundle with these ends at one length: a shorter one has more shear. */
struct wb_section_run_rigidity {
    double length;   /* m */
    double rigidity; /* E I = F L^3 / (3 d), N m2: of the homogenised beam of this length */
    double alpha;    /* alpha L of Newmark's partial interaction with the same rigidity; NaN: out of
                        its range, or no tape */
};

enum {
    WB_SECTION_RUN_LENGTHS = 3 /* a half, one and two times the model's length */
};

struct wb_section_run {
    int n_rows, capacity;
    struct wb_section_run_row *rows; /* (n_rows), owned; only completed rows */
    int n_shape;
    double *shape_s;    /* (n_shape) m, owned */
    double (*shape)[3]; /* (n_rows x n_shape), m, owned */
    bool converged;     /* false: the run ended early, at `lost` */
    bool stopped;       /* by the caller */
    struct wb_section_solver_point lost;
    double zero_force; /* N: subtracted from `force` */
    double friction;   /* mu */
    bool is_mean;      /* friction is the mean of static and kinetic friction */
    bool is_mirrored;
    int elements, unknowns; /* along the bundle, of all stations */
    long iterations;        /* of Newton's method, total */
    int increments;
    double residual, missing; /* maximum over all rows */
    double imbalance;         /* largest energy imbalance, over the largest external work so far */
    double tape_plastic;      /* largest */
    /* Moment over curvature of the homogenised beam of this length and these ends, from a loading
     * without weight by a vertical force; (n_curve), owned. */
    int n_curve;
    struct wb_section_homogenise_point *curve;
    struct wb_section_run_rigidity rigidity[WB_SECTION_RUN_LENGTHS];
};

/* Allocates a model's rows and n_shape (at least 2) equally spaced positions. */
WB_MUST_CHECK enum wb_status wb_section_run_init(struct wb_section_run *run,
                                                 const struct wb_bundle_model *model, int n_shape);
void wb_section_run_release(struct wb_section_run *run); /* accepts a zeroed one */

struct wb_section_run_settings {
    bool (*stop)(void *context); /* called before each row, true stops the run; may be NULL */
    void *context;
    bool until_free;    /* end the last unloading at the first row whose force is not above zero */
    bool no_rigidities; /* `rigidity` stays empty */
};

/* Computes the test, the curve and the rigidities. `settings` NULL: all zero. Fails for bundles
 * that wb_section_layout_check() rejects. Not converging is a result, not an error. */
WB_MUST_CHECK enum wb_status wb_section_run(struct wb_section_run *run,
                                            const struct wb_bundle_model *model,
                                            const struct wb_section_run_settings *settings);

/* After the first unloading to zero force, from 0 to 1: springback of the deflection, 1 - d_0 /
 * d_max, and residual curvature ratio, largest curvature along the bundle over that at d_max. NaN:
 * there is no unloading, or it ends before zero force. */
double wb_section_run_springback(const struct wb_section_run *run);
double wb_section_run_residual_curvature(const struct wb_section_run *run);

/* The deflection (m) above which the section model is too stiff (by 14 to 35 % at the end of the
 * explicit runs), because the plastic strain of the tape on its circle exceeds 0.010 and its
 * outline no longer holds the wires. NaN: not reached, or the tape lies taut on the wires. */
double wb_section_run_loosens(const struct wb_section_run *run,
                              const struct wb_bundle_model *model);

/* The deflection (m) above which the bend radius is smaller than the bundle's depth, where beam
 * strains are no longer meaningful. NaN: not reached. */
double wb_section_run_folds(const struct wb_section_run *run);

#endif
