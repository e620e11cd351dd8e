/* A complete bending test of a bundle: it settles under its weight, is loaded to the model's
 * deflection along a smooth step, and is unloaded and reloaded if the model has cycles. The result
 * holds rows (force against deflection), shapes and energies.
 *
 * Rows: row 0 is at zero deflection with the weight applied. The others are run.rows equal steps of
 * the tip's target up to the deflection and, with cycles, down to zero again. Shape, energies and
 * position of the tip are those at the time at which the target is reached. The force is averaged
 * from half a row before to half a row after, to remove vibration: a straight line is fitted to
 * force over target, and evaluated at the row (at both ends of a branch only one half exists).
 * Samples with a slack strand are excluded. If the strand becomes slack during unloading, the tip
 * is damped to rest; it stays there in all slack rows, and the next loading begins there.
 *
 * Duration: if the model does not give it, it is chosen so that kinetic over internal energy stays
 * below run.kinetic_limit from 2 mm on (from half the deflection on, if that is less). This ratio
 * is proportional to duration^-2. If the ratio up to 3 mm shows that a run is too fast, or much too
 * slow, it is restarted with the duration that follows from the ratio; so is a run that is too fast
 * later. There are at most WB_BUNDLE_RUN_ATTEMPTS attempts.
 *
 * Checkpoints: at intervals everything that the run needs to continue is written to a file
 * (base/checkpoint.h). A later run of the same model and settings that finds the file continues
 * from there, with the same result bit for bit. A file of another model, mesh, number of parts or
 * program, or with other overrides, is rejected. A run stopped by its observer writes a last
 * checkpoint.
 *
 * With several ranks (fe/team/team.h) every rank calls these functions and gets the same result;
 * the observer of rank 0 decides.
 */
#ifndef WB_FE_BUNDLE_BUNDLE_RUN_H
#define WB_FE_BUNDLE_BUNDLE_RUN_H

#include <stdbool.h>

#include "base/reason.h"
#include "base/status.h"
#include "fe/bundle/bundle.h"
#include "fe/linear/trial.h"
#include "fe/model/bundle_model.h"

/* Increase whenever results for the same model change: older datasets are then outdated. */
enum {
    WB_BUNDLE_RUN_VERSION = 1
};

enum {
    WB_BUNDLE_RUN_ATTEMPTS = 5
};

struct wb_bundle_row {
    double time; /* s, of the model, since the loading began */
    int cycle;   /* from 1 */
    enum wb_phase phase;
    double deflection;         /* m */
    double tip[3];             /* end of the bundle's axis (mean of the wires' ends), m */
    double tip_angle;          /* of the axis' secant over the last 1 % of the length, rad */
    double tension;            /* N: of the strand, or the vertical force */
    double vertical_force;     /* N: its vertical part */
    double force;              /* N: vertical_force minus its value in row 0 */
    double standard_deviation; /* N, of the samples from their regression line */
    struct wb_bundle_energies energies;
};

/* Largest values of a run; ratios from 2 mm on (see above). */
struct wb_bundle_extremes {
    double kinetic, artificial; /* over internal energy */
    double imbalance;           /* |imbalance| over the largest external work so far */
    double strain;              /* of any element, from the beginning */
    double penetration;         /* m, of wires, from the beginning */
    bool beyond;                /* strains exceeded the range of the elements' logarithm */
};

struct wb_bundle_result {
    int capacity, n_shape;
    struct wb_bundle_row *rows; /* (n_rows), owned; only completed rows */
    double *shape_s;            /* (n_shape) m, reference arc lengths, owned */
    double (*shape)[3];         /* (n_rows x n_shape), m, owned */

    /* Everything from here on is saved in checkpoints. */
    int n_rows;
    bool converged;          /* false: ends early */
    bool stopped;            /* by the observer */
    bool kept;               /* stopped, and the checkpoint contains everything up to then */
    bool resumed;            /* from a checkpoint */
    struct wb_reason reason; /* where and why it failed */
    double zero_force;       /* N: subtracted from `force` */
    double duration;         /* s, of a loading */
    bool chosen;             /* the duration was chosen by the limit */
    bool exceeded;           /* the last attempt exceeds the limit */
    int attempts;            /* number of runs started; only the last one gave rows */
    double time_step;        /* s */
    long hexahedra;          /* in all wires */
    int shells;              /* of the tape */
    long long steps;         /* of the last attempt, including settling */
    long long all_steps;     /* of all attempts */
    struct wb_bundle_extremes largest;
    int parts; /* along the axis, one thread each (in all ranks) */
    /* s, of all attempts, including those before a checkpoint; cpu: of all ranks. */
    double wall, cpu;
};

/* Progress of a run. */
struct wb_bundle_progress {
    int attempt;     /* from 1 */
    long long steps; /* of this attempt */
    double done;     /* of this attempt, 0 to 1 */
    bool rests; /* the bundle is being damped to rest, under its weight or after the strand became
                   slack */
    double deflection;          /* m */
    double kinetic, artificial; /* over internal energy, at the last check; NaN before the first */
};

struct wb_bundle_observer {
    /* Called several times per row. False stops the run; completed rows stay. May be NULL. */
    bool (*progress)(void *context, const struct wb_bundle_progress *progress);
    /* Called when the bundle is at the target of a row, before the row's forces are known; the row
     * becomes number result->n_rows. A new attempt starts at 0 again. An error ends the run. May be
     * NULL. */
    enum wb_status (*place)(void *context, const struct wb_bundle_result *result,
                            const struct wb_bundle_row *row, const struct wb_bundle *bundle);
    /* Saves or restores the observer's own state in a checkpoint. May be NULL. */
    void (*visit)(void *context, struct wb_checkpoint *checkpoint);
    void *context;
};

/* Allocates memory for a model's rows and n_shape equally spaced positions from 0 to its length
 * (none, or 2 to 1000). */
WB_MUST_CHECK enum wb_status wb_bundle_result_init(struct wb_bundle_result *result,
                                                   const struct wb_bundle_model *model,
                                                   int n_shape);
void wb_bundle_result_release(struct wb_bundle_result *result); /* accepts a zeroed one */

struct wb_bundle_run_options {
    const char *mesh;                          /* NULL: the model's own */
    int threads;                               /* of each rank; 0: 1 */
    const char *checkpoint;                    /* file path; NULL: no checkpoints */
    double checkpoint_interval;                /* s of wall time; 0: 600 */
    const struct wb_bundle_observer *observer; /* may be NULL */
};

/* Runs the model's test; `options` may be NULL. A run that fails is a result: converged is false,
 * completed rows stay. The checkpoint's file also stays: the caller removes it after saving the
 * result of a run that was not stopped. */
WB_MUST_CHECK enum wb_status wb_bundle_run(struct wb_bundle_result *result,
                                           const struct wb_bundle_model *model,
                                           const struct wb_bundle_run_options *options);

#endif
