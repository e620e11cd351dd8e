/* The bending test of the paper as a sequence: connect, start check, tare, N cycles of loading and
 * unloading, end. Everything is recorded from the first byte to the last.
 *
 *     WB_TRY(wb_bend_test_open(&test, &request));
 *     while (wb_bend_test_step(test, timeout_ns) == WB_SEQUENCE_RUNNING) ...display, keys...
 *     status = wb_bend_test_close(test, &result);
 *
 * However the test ends (a limit, Ctrl-C, a full disk, a silent instrument), the stage is stopped
 * first and then the recording is closed. A limit is a result, not an error. Used by one thread.
 */
#ifndef WB_DAQ_TEST_BEND_TEST_H
#define WB_DAQ_TEST_BEND_TEST_H

#include <stdbool.h>
#include <stdint.h>

#include "base/reason.h"
#include "base/setting.h"
#include "daq/acquire/acquisition.h"
#include "daq/acquire/sequence.h"
#include "daq/protocol/specimen.h"
#include "daq/test/first_force.h"

struct wb_bend_test; /* opaque */

enum {
    WB_BEND_TEST_SPEEDS = 64, /* bytes of the text of speeds */
    WB_BEND_TEST_MOST_SPEEDS = 8
};

struct wb_bend_test_request {
    const char *rig_path, *specimen_path; /* YAML files */
    const char *rig_text;                 /* used instead of the rig file's text, for a virtual copy
                                             of a bench; the log of checks beside the file is then
                                             ignored; NULL: the file */
    const char *specimen_text;            /* used instead of the specimen file's text; the path then
                                             only locates the wire file; NULL: the file */
    const char *output_path;              /* the recording; must not exist */
    const char *operator_name, *notes;    /* may be NULL */
    int cycles;
    double travel;                    /* m down from the start position */
    double dwell_time;                /* s of rig time at the largest deflection of a cycle */
    char speeds[WB_BEND_TEST_SPEEDS]; /* mm/s, separated by commas, used by the cycles in turn;
                                         "": the rig file's speed */
    const struct wb_writer_settings *writer; /* NULL: the defaults */
    struct wb_sink sink;                     /* receives every live sample; members may be NULL */
    double connect_timeout;                  /* s of host time for all instruments to answer */
    double check_time;                       /* s of rig time of the start check */
    double tare_time;                        /* s of rig time over which the tare averages */
    double rest_time;                        /* s of rig time unloaded at the end of each cycle */
    double hold_most;                        /* s of host time, longest hold by the operator */
    struct wb_first_force_bounds stiffness;  /* of this wire at this length; all 0: unknown */
};

/* Settings of the request: cycles, travel, dwell, speeds and longest hold. */
extern const struct wb_setting_table wb_bend_test_table;

/* Defaults: 1 cycle, travel 53 mm, dwell 2 s, the rig's speed, connect_timeout 6 s, check_time 1 s,
 * tare_time 2 s, rest_time 2 s, hold_most 600 s; paths NULL. */
void wb_bend_test_default_request(struct wb_bend_test_request *request);

/* Duration of a cycle (counted from 1) with dwell and rest, s of rig time, for a request that
 * passed wb_bend_test_check_request(). */
double wb_bend_test_cycle_time(const struct wb_bend_test_request *request, const struct wb_rig *rig,
                               int cycle);

/* Read the rig and the specimen of the request. */
WB_MUST_CHECK enum wb_status wb_bend_test_rig(const struct wb_bend_test_request *request,
                                              struct wb_rig *rig);
WB_MUST_CHECK enum wb_status wb_bend_test_specimen(const struct wb_bend_test_request *request,
                                                   struct wb_specimen *specimen);

/* Checks cycles, speeds and travel of the request against the rig file, without opening a port.
 * `why` holds the message; NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_bend_test_check_request(const struct wb_bend_test_request *request,
                                                        const struct wb_rig *rig,
                                                        struct wb_reason *why);

/* Reads the files, rejects a request that the rig does not allow, opens the ports, creates the
 * recording with its meta values and starts the instruments. On failure no file is left behind. */
WB_MUST_CHECK enum wb_status wb_bend_test_open(struct wb_bend_test **out,
                                               const struct wb_bend_test_request *request);

/* Waits at most timeout_ns (and 20 ms) for the instruments and takes the next step. Does nothing
 * once the test has ended. */
enum wb_sequence_end wb_bend_test_step(struct wb_bend_test *test, int64_t timeout_ns);

/* Record the operator's mark; stop the test at the operator's command. */
void wb_bend_test_mark(struct wb_bend_test *test, const char *text);
void wb_bend_test_stop(struct wb_bend_test *test);

/* Puts the test on hold: stops the stage, in motion or at rest, while recording and limits stay
 * active. Returns false without effect before the first cycle, during a hold, and once the test
 * ends. A hold longer than `hold_most` ends the test as wb_bend_test_stop() does. */
bool wb_bend_test_hold(struct wb_bend_test *test);
/* Resumes the interrupted phase. Returns false without effect unless the test is on hold and the
 * stage has stopped. */
bool wb_bend_test_resume(struct wb_bend_test *test);

struct wb_bend_test_status {
    const char *phase; /* "connecting", "check", "tare", "down", "up", "rest", "held",
                          "stopping", "end" */
    int cycle, cycles; /* cycle from 1; 0 before the first */
    bool has_tension, has_travel, has_deflection;
    double tension;    /* N, strand tension; the raw reading until the tare is known */
    double travel;     /* m, reported by the stage, down from the start positive */
    double deflection; /* m, of the tip relative to the clamp, approximately, by the cameras */
    double elapsed;    /* s of host time since the start */
    double gravity;    /* m/s2, of the rig */
    int markers_expected;
    bool is_virtual;
    bool is_connected;        /* all instruments have replied */
    bool is_standing;         /* false after a stop that the stage did not confirm */
    enum wb_sequence_end end; /* RUNNING until the test is stopped or done */
    const char *end_text;     /* reason of the end; "" while it runs; owned by the test */
    double peak_tension;      /* N, largest strand tension of the cycles so far */
    double time_left; /* s of host time to the end of the last cycle, at the commanded speed; NaN
                         before the start position is known, 0 once the test ends */
    double held;      /* s of host time since the command to hold; NaN: not on hold */
    double hold_left; /* s of host time until the hold ends the test; NaN: not on hold */
    bool hold_stands; /* the stage has stopped: the test can be resumed */
    const struct wb_acquisition_latest *latest; /* owned by the test */
};
void wb_bend_test_status(const struct wb_bend_test *test, struct wb_bend_test_status *status);

struct wb_bend_test_result {
    enum wb_sequence_end end;
    char text[WB_INTERLOCK_TEXT]; /* reason of the end, for the operator */
    bool is_virtual;
    bool recorded;  /* the recording was kept: all instruments had replied */
    bool started;   /* the first cycle had begun */
    bool standing;  /* false: the stop was not confirmed, the stage may be moving */
    bool displaced; /* the stage is not at the start position: the specimen may be loaded */
    int cycles_done;
    double tare;         /* N, mean reading during the tare */
    double unloaded;     /* N, reading without strand tension: the tare less the counterweight's
                            weight if it was attached; 0 before the tare */
    double peak_tension; /* N, largest strand tension of the cycles */
    int holds;           /* number of holds by the operator */
    double held;         /* s of host time on hold in total */
    double travel;       /* m, last position of the stage, down from the start positive */
    double duration;     /* s of host time */
    uint64_t samples[WB_INTERLOCK_ROLES], bytes, drops;
    struct wb_loss_counts loss[WB_INTERLOCK_ROLES]; /* samples sent but not received */
    bool is_losing[WB_INTERLOCK_ROLES];             /* the loss exceeds chance */
    bool soft_reset;
    double hold_latency, confirm_latency; /* s; NaN when no hold was sent */
};

/* Stops the test if it still runs, closes ports and recording, and frees the test; `result` may be
 * NULL. The recording is removed if not all instruments had replied (result.recorded is false).
 * Returns the recording's first error, already logged. Accepts NULL. */
WB_MUST_CHECK enum wb_status wb_bend_test_close(struct wb_bend_test *test,
                                                struct wb_bend_test_result *result);

#endif
