/* The paper's test as a sequence: connect, start check, tare, N times down and back, end; recorded
 * from the first byte to the last.
 *
 *     WB_TRY(wb_bend_test_open(&test, &request));
 *     while (wb_bend_test_step(test, timeout_ns) == WB_SEQUENCE_RUNNING) ...show, keys...
 *     status = wb_bend_test_close(test, &result);
 *
 * Every way out stops the stage first, then closes the recording: a limit, Ctrl-C, a full disk, an
 * instrument that fell silent. A limit is a result, not an error. Used by one thread.
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
    WB_BEND_TEST_SPEEDS = 64, /* bytes of the speeds' text */
    WB_BEND_TEST_MOST_SPEEDS = 8
};

struct wb_bend_test_request {
    const char *rig_path, *specimen_path; /* YAML files */
    const char *rig_text;                 /* of a bench that is not the rig file's own (a virtual
                                             one like it): in place of what the file holds, and the
                                             log of checks beside it is of another load cell;
                                             NULL: the file */
    const char *specimen_text;            /* in place of what the specimen's file holds, which then
                                             only says where its wire is looked for; NULL: the file */
    const char *output_path;              /* the recording; must not exist */
    const char *operator_name, *notes;    /* may be NULL */
    int cycles;
    double travel;                           /* m down from the start position */
    double dwell_time;                       /* s of rig time at the turn of each cycle */
    char speeds[WB_BEND_TEST_SPEEDS];        /* mm/s, of the cycles in turn, separated by commas;
                                                "": the rig file's */
    const struct wb_writer_settings *writer; /* NULL: the defaults */
    struct wb_sink sink;                     /* sees every live sample; members may be NULL */
    double connect_timeout;                  /* s of host time for all instruments to answer */
    double check_time;                       /* s of rig time the start check looks */
    double tare_time;                        /* s of rig time the tare averages */
    double rest_time;                        /* s of rig time at the end of each cycle: zero load */
    double hold_most;                        /* s of host time that the operator may hold it */
    struct wb_first_force_bounds stiffness;  /* of this wire at this length; all 0: not known */
};

/* Rows of its cycles, travel, dwell, speeds and longest hold. */
extern const struct wb_setting_table wb_bend_test_table;

/* 1 cycle, 53 mm, 2 s of dwell, the rig's speed, 6 s, 1 s, 2 s, 2 s, 600 s; paths NULL. */
void wb_bend_test_default_request(struct wb_bend_test_request *request);

/* How long a cycle, from 1, of a request that passed wb_bend_test_check_request() takes with dwell
 * and rest, s of rig time. */
double wb_bend_test_cycle_time(const struct wb_bend_test_request *request, const struct wb_rig *rig,
                               int cycle);

/* Reads the rig that the request names, and the specimen. */
WB_MUST_CHECK enum wb_status wb_bend_test_rig(const struct wb_bend_test_request *request,
                                              struct wb_rig *rig);
WB_MUST_CHECK enum wb_status wb_bend_test_specimen(const struct wb_bend_test_request *request,
                                                   struct wb_specimen *specimen);

/* Whether the rig file allows the request's travel and cycles, and its speeds are numbers. Needs no
 * port. `why` holds the message; NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_bend_test_check_request(const struct wb_bend_test_request *request,
                                                        const struct wb_rig *rig,
                                                        struct wb_reason *why);

/* Reads the files, refuses what the rig cannot do, opens the ports, creates the recording with its
 * meta values and starts the instruments. On failure nothing is left behind. */
WB_MUST_CHECK enum wb_status wb_bend_test_open(struct wb_bend_test **out,
                                               const struct wb_bend_test_request *request);

/* Waits at most timeout_ns (and 20 ms) for the instruments and does what is due. After it returned
 * anything but RUNNING it does nothing any more. */
enum wb_sequence_end wb_bend_test_step(struct wb_bend_test *test, int64_t timeout_ns);

/* The operator's mark, and the stop key. */
void wb_bend_test_mark(struct wb_bend_test *test, const char *text);
void wb_bend_test_stop(struct wb_bend_test *test);

/* Holds the test: brakes the stage where it is, on its way or at rest, and goes on recording, with
 * all limits watched. False, and nothing happens, before the first cycle, while it is held, and
 * once it ends. A test that is held for longer than the request allows ends as by
 * wb_bend_test_stop(). */
bool wb_bend_test_hold(struct wb_bend_test *test);
/* Goes on with the way that was held. False, and nothing happens, unless the stage stands held. */
bool wb_bend_test_resume(struct wb_bend_test *test);

struct wb_bend_test_status {
    const char *phase; /* "connecting", "check", "tare", "down", "up", "rest", "held",
                          "stopping", "end" */
    int cycle, cycles; /* cycle from 1; 0 before the first */
    bool has_tension, has_travel, has_deflection;
    double tension;    /* N, of the strand; the bare reading before the tare is known */
    double travel;     /* m, as commanded, down positive */
    double deflection; /* m, of the tip against the clamp as the cameras see it, roughly */
    double elapsed;    /* s of host time since the start */
    double gravity;    /* m/s2, of the rig */
    int markers_expected;
    bool is_virtual;
    bool is_connected;        /* all instruments have answered */
    bool is_standing;         /* false after a stop that the stage did not confirm */
    enum wb_sequence_end end; /* RUNNING until the test is stopped or done */
    const char *end_text;     /* why it ended; "" while it runs; owned by the test */
    double peak_tension;      /* N, largest of the cycles so far */
    double time_left; /* s of host time to the end of the last cycle, at the commanded speed; NaN
                         before the start position is known, 0 once the test ends */
    double held;      /* s of host time since it was asked to hold; NaN where it is not held, */
    double hold_left; /* and until it ends by itself */
    bool hold_stands; /* it can be resumed: the stage came to a stand */
    const struct wb_acquisition_latest *latest; /* owned by the test */
};
void wb_bend_test_status(const struct wb_bend_test *test, struct wb_bend_test_status *status);

struct wb_bend_test_result {
    enum wb_sequence_end end;
    char text[WB_INTERLOCK_TEXT]; /* why it ended, for people */
    bool is_virtual;
    bool recorded;  /* the recording was kept: all instruments had answered */
    bool started;   /* the first cycle had begun */
    bool standing;  /* false: the stop was not confirmed, the stage may be moving */
    bool displaced; /* the stage is not back at the start: the specimen may be loaded */
    int cycles_done;
    double tare;         /* N, mean reading while it was taken */
    double unloaded;     /* N, reading without tension: the tare less what hung on the cell then;
                            0 before the tare */
    double peak_tension; /* N, largest of the cycles */
    int holds;           /* by the operator, */
    double held;         /* s of host time in all */
    double travel;       /* m, where the stage stands */
    double duration;     /* s of host time */
    uint64_t samples[WB_INTERLOCK_ROLES], bytes, drops;
    struct wb_loss_counts loss[WB_INTERLOCK_ROLES]; /* what instruments sent and never came */
    bool is_losing[WB_INTERLOCK_ROLES];             /* more than chance */
    bool soft_reset;
    double hold_latency, confirm_latency; /* s; NaN when no hold was sent */
};

/* Closes ports and recording and frees; `result` may be NULL. Stops the stage first if it is still
 * moving. A recording in which no instrument but the failing one could have said anything is
 * removed again (result.recorded is false). Returns the recording's first error, already logged.
 * Accepts NULL. */
WB_MUST_CHECK enum wb_status wb_bend_test_close(struct wb_bend_test *test,
                                                struct wb_bend_test_result *result);

#endif
