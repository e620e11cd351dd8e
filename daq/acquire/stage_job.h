/* Setting the bench by hand: home, jog, unlock, and releasing a specimen after a stop. The load is
 * watched on the way, and every way out stops the stage first.
 *
 *     WB_TRY(wb_stage_job_open(&job, &rig, &request));
 *     while (wb_stage_job_step(job, timeout_ns) == WB_SEQUENCE_RUNNING) ...
 *     wb_stage_job_close(job, &result);
 */
#ifndef WB_DAQ_ACQUIRE_STAGE_JOB_H
#define WB_DAQ_ACQUIRE_STAGE_JOB_H

#include <stdbool.h>

#include "base/status.h"
#include "daq/acquire/sequence.h"
#include "daq/protocol/rig.h"

struct wb_stage_job; /* opaque */

enum wb_stage_job_kind {
    WB_STAGE_JOB_HOME,   /* the controller's own homing cycle */
    WB_STAGE_JOB_JOG,    /* by `distance` */
    WB_STAGE_JOB_UNLOCK, /* to idle without a motion, whatever it does: a reset, which also stops a
                            motion of somebody else's, then $X */
    /* Out of hold or alarm, then slowly up (half the rig's speed), step by step, until the reading
     * of the standing stage stays level over 0.75 mm. The strand is slack where that is the cell's
     * zero; where the zero is not known, somebody has to look. */
    WB_STAGE_JOB_RELEASE
};

struct wb_stage_job_request {
    enum wb_stage_job_kind kind;
    double distance; /* m: of a jog, positive down; of a release the most it goes up, 0: the
                        longest way that a test may go down */
    double speed;    /* m/s; 0: the rig's, of a release half of it */
    double zero;     /* N, release: what the cell reads with a slack strand; NaN: not known */
    bool without_load_cell; /* move blindly: the cell is not connected */
    double connect_timeout; /* s of host time; 0: 6 s */
};

WB_MUST_CHECK enum wb_status wb_stage_job_open(struct wb_stage_job **out, const struct wb_rig *rig,
                                               const struct wb_stage_job_request *request);

/* Waits at most timeout_ns (and 20 ms) and does what is due. */
enum wb_sequence_end wb_stage_job_step(struct wb_stage_job *job, int64_t timeout_ns);

struct wb_stage_job_status {
    const char *phase; /* "connecting", "resetting", "unlocking", "moving", "reading", "stopping",
                          "end" */
    bool has_force, has_position;
    double force;    /* N, as read */
    double position; /* m, machine */
    double moved;    /* m from where the job found the stage, down positive */
    double gravity;  /* m/s2 */
    bool is_virtual;
};
void wb_stage_job_status(const struct wb_stage_job *job, struct wb_stage_job_status *status);

struct wb_stage_job_result {
    enum wb_sequence_end end;
    char text[WB_INTERLOCK_TEXT];
    bool standing;   /* false: the stop was not confirmed */
    double position; /* m, machine; NaN unknown */
    double moved;    /* m, down positive; NaN unknown */
    double force;    /* N, last reading; NaN unknown */
    double change;   /* N, last reading less the first; NaN unknown */
};

/* Closes the ports and frees; stops the stage first if it is still moving. `result` may be NULL;
 * accepts NULL. */
void wb_stage_job_close(struct wb_stage_job *job, struct wb_stage_job_result *result);

#endif
