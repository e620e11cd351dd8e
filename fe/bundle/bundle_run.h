/* A whole bending test of a bundle: it settles under its weight, is loaded to the model's
 * deflection along a smooth step, and is unloaded and loaded again where the model asks for cycles.
 * The result holds rows (force against deflection), shapes and energies.
 *
 * Rows: row 0 is at zero deflection with the weight on. The others are run.rows equal steps of the
 * tip's target up to the deflection and, with cycles, down to zero again. The shape, the energies
 * and the place of the tip are those of the moment at which the target is reached. The force is a
 * mean over the time from half a row before to half a row after, so that vibration averages out: a
 * straight line is fitted through force against target, and its value at the row taken (at both
 * ends of a way only one half exists). Samples with a slack strand are left out. If the strand goes
 * slack while unloading, the tip comes to rest: it hangs there in all slack rows, and the next
 * loading begins there.
 *
 * Duration: if the model leaves it open, it is chosen so that kinetic over internal energy stays
 * below run.kinetic_limit from 2 mm on (from half the deflection on, if that is less). This ratio
 * goes as duration^-2. A run whose ratio up to 3 mm shows that it is too fast, or much too
 * slow, is started again with the duration that follows from the ratio; so is a run that is too
 * fast later. There are at most WB_BUNDLE_RUN_ATTEMPTS attempts.
 *
 * Checkpoints: at intervals everything that the run needs to continue is written to a file
 * (base/checkpoint.h). A later run of the same model and settings that finds the file continues
 * from there, with the same result bit for bit. A file of another model, mesh, number of parts or
 * program, or with other overrides, is refused. A run that its observer stops leaves a last
 * checkpoint.
 *
 * With several ranks (fe/team/team.h) every rank calls these functions and has the same result; the
 * observer of rank 0 decides.
 */
#ifndef WB_FE_BUNDLE_BUNDLE_RUN_H
#define WB_FE_BUNDLE_BUNDLE_RUN_H

#include <stdbool.h>

#include "base/reason.h"
#include "base/status.h"
#include "fe/bundle/bundle.h"
#include "fe/linear/trial.h"
#include "fe/model/bundle_model.h"

/* Counted up whenever the same model comes to other numbers: datasets of before are outdated. */
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
    double tip[3];             /* m, mean of the wires' ends, from the bundle's axis */
    double tip_angle;          /* rad, of the last elements' secant */
    double tension;            /* N: of the strand, or the vertical force */
    double vertical_force;     /* N: its vertical part */
    double force;              /* N: the latter less its value at zero deflection, row 0 */
    double standard_deviation; /* N, of the forces round their line */
    struct wb_bundle_energies energies;
};

/* Largest values of a run, ratios from 2 mm on (see above). */
struct wb_bundle_extremes {
    double kinetic, artificial; /* over internal energy */
    double imbalance;           /* |imbalance| over the largest external work so far */
    double strain;              /* of any element, from the beginning on */
    double penetration;         /* m, of wires, from the beginning on */
    bool beyond;                /* strain went beyond what the elements' logarithm is made for */
};

struct wb_bundle_result {
    int n_rows, capacity;
    struct wb_bundle_row *rows; /* (n_rows), owned; only those reached */
    int n_shape;
    double *shape_s;         /* (n_shape) m, reference arc lengths, owned */
    double (*shape)[3];      /* (n_rows x n_shape), m, owned */
    bool converged;          /* false: ends early */
    bool stopped;            /* by the observer */
    bool kept;               /* stopped, and the checkpoint holds all until then */
    bool resumed;            /* from a checkpoint */
    struct wb_reason reason; /* where and why it was lost */
    double zero_force;       /* N: subtracted from `force` */
    double duration;         /* s, of a loading */
    bool chosen;             /* the duration, by the limit */
    bool exceeded;           /* the limit, by the last attempt */
    int attempts;            /* the runs begun; those before the last gave no rows */
    double time_step;        /* s */
    long hexahedra;          /* in all wires */
    int shells;              /* of the tape */
    long long steps;         /* of the last attempt, with settling */
    long long all_steps;     /* of all attempts */
    struct wb_bundle_extremes largest;
    int parts;        /* along the axis, each with a thread of its own (of all ranks) */
    double wall, cpu; /* s, of all attempts, also before a checkpoint; cpu of all ranks */
};

/* Where a run stands. */
struct wb_bundle_progress {
    int attempt;                /* from 1 */
    long long steps;            /* of this attempt */
    double done;                /* of this attempt, 0 to 1 */
    bool rests;                 /* it comes to rest, under its weight or let go by the strand */
    double deflection;          /* m */
    double kinetic, artificial; /* over internal energy, as last looked at; NaN at first */
};

struct wb_bundle_observer {
    /* Called several times a row. False stops the run; completed rows stay. May be NULL. */
    bool (*progress)(void *context, const struct wb_bundle_progress *progress);
    /* Called when the bundle is at the place of a row, before the row's forces are known; it
     * becomes row number result->n_rows. A new attempt begins at 0 again. An error ends the run.
     * May be NULL.
     */
    enum wb_status (*place)(void *context, const struct wb_bundle_result *result,
                            const struct wb_bundle_row *row, const struct wb_bundle *bundle);
    /* Saves or restores what the observer itself keeps in a checkpoint. May be NULL. */
    void (*visit)(void *context, struct wb_checkpoint *checkpoint);
    void *context;
};

/* Takes memory for a model's rows and n_shape equally spaced positions from 0 to its length (none,
 * or 2 to 1000). */
WB_MUST_CHECK enum wb_status wb_bundle_result_init(struct wb_bundle_result *result,
                                                   const struct wb_bundle_model *model,
                                                   int n_shape);
void wb_bundle_result_release(struct wb_bundle_result *result); /* accepts a zeroed one */

struct wb_bundle_run_options {
    const char *mesh;                          /* NULL: the model's own */
    int threads;                               /* of each rank; 0: 1 */
    const char *checkpoint;                    /* its file; NULL: none */
    double checkpoint_interval;                /* s of wall time; 0: 600 */
    const struct wb_bundle_observer *observer; /* may be NULL */
};

/* Runs the model's test; `options` may be NULL. A run that is lost on the way is a result:
 * converged is false, completed rows stay. The checkpoint's file stays, too: the caller removes it
 * when a run that was not stopped is safe elsewhere. */
WB_MUST_CHECK enum wb_status wb_bundle_run(struct wb_bundle_result *result,
                                           const struct wb_bundle_model *model,
                                           const struct wb_bundle_run_options *options);

#endif
