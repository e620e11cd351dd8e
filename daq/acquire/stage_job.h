/* Single jobs of the stage: home, jog, unlock, and release of a specimen after a stop. The load is
 * watched during motion, and the stage is stopped however the job ends.
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
    WB_STAGE_JOB_UNLOCK, /* to idle without a motion, from any state: a reset, which also stops a
                            motion started by another program, then $X */
    /* Leaves hold or alarm, then moves up step by step at half the rig's speed until the reading at
     * standstill is level over 0.75 mm. The strand is slack if that reading is the cell's zero; if
     * the zero is unknown, the operator has to check the strand. */
    WB_STAGE_JOB_RELEASE
};

struct wb_stage_job_request {
    enum wb_stage_job_kind kind;
    double distance; /* m; of a jog, positive down; of a release the longest travel up, 0: the
                        longest travel of a test */
    double speed;    /* m/s; 0: the rig's speed, for a release half of it */
    double zero;     /* N, release: reading with a slack strand; NaN: unknown */
    bool without_load_cell; /* the cell is not connected: move without watching the force */
    double connect_timeout; /* s of host time; 0: 6 s */
};

WB_MUST_CHECK enum wb_status wb_stage_job_open(struct wb_stage_job **out, const struct wb_rig *rig,
                                               const struct wb_stage_job_request *request);

/* Waits at most timeout_ns (and 20 ms), then takes the next step. */
enum wb_sequence_end wb_stage_job_step(struct wb_stage_job *job, int64_t timeout_ns);

struct wb_stage_job_status {
    const char *phase; /* "connecting", "resetting", "unlocking", "moving", "reading", "stopping",
                          "end" */
    bool has_force, has_position;
    double force;    /* N, reading including tare */
    double position; /* m, machine */
    double moved;    /* m from the position at the beginning of the job, down positive */
    double gravity;  /* m/s2 */
    bool is_virtual;
};
void wb_stage_job_status(const struct wb_stage_job *job, struct wb_stage_job_status *status);

struct wb_stage_job_result {
    enum wb_sequence_end end;
    char text[WB_INTERLOCK_TEXT];
    bool standing;   /* false: the stop was not confirmed */
    double position; /* m, machine; NaN: unknown */
    double moved;    /* m, down positive; NaN: unknown */
    double force;    /* N, last reading; NaN: unknown */
    double change;   /* N, last reading minus the first; NaN: unknown */
};

/* Stops the job if it still runs, closes the ports and frees the job. `result` may be NULL; accepts
 * NULL. */
void wb_stage_job_close(struct wb_stage_job *job, struct wb_stage_job_result *result);

#endif
