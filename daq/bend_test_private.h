/* What the parts of the bend test share: bend_test.c (opening, the loop's step, closing),
 * bend_test_start.c (connecting and the start check), bend_test_motion.c (tare and cycles) and
 * bend_test_end.c (every way out). For nobody else. */
#ifndef WB_DAQ_BEND_TEST_PRIVATE_H
#define WB_DAQ_BEND_TEST_PRIVATE_H

#include "base/file.h"
#include "daq/bend_test.h"
#include "daq/start_check.h"
#include "daq/tip_watch.h"

/* The stage is where it should be within this, m. */
#define WB_BEND_POSITION_TOLERANCE 0.05e-3

enum wb_bend_phase {
    WB_BEND_PHASE_CONNECT,
    WB_BEND_PHASE_CHECK,
    WB_BEND_PHASE_TARE,
    WB_BEND_PHASE_DOWN,
    WB_BEND_PHASE_UP,
    WB_BEND_PHASE_REST,
    WB_BEND_PHASE_STOP,
    WB_BEND_PHASE_END
};

struct wb_bend_test {
    struct wb_bend_test_request request; /* its paths are not kept beyond open */
    char output_path[WB_PATH], rig_path[WB_PATH];
    struct wb_rig rig;
    struct wb_specimen specimen;
    struct wb_acquisition *acquisition;
    struct wb_writer *writer;
    enum wb_bend_phase phase;
    int64_t started_ns, phase_ns; /* begin of test and of phase */
    int64_t deadline_ns;          /* of the motion */
    int cycle;                    /* from 1 */
    double start_position;        /* m, machine */
    double target;                /* m travel of the motion under way */
    bool unsent;                  /* the stage has not taken its command yet */
    double turn_travel;           /* largest reached in this cycle */
    uint64_t reports_seen;        /* stage reports looked at */
    uint64_t stands_since;        /* reports in a row that show it standing elsewhere */
    struct wb_start_check check;
    struct wb_average zero; /* N, of the tare */
    struct wb_tip_watch tip;
    bool has_tare;
    double tare;     /* N, mean reading of the tare */
    double unloaded; /* N, reading without tension: the tare less what hung on the cell then */
    int64_t duration_ns;
    double hold_latency, confirm_latency; /* s; NaN without a hold */
    struct wb_bend_test_result result;
};

/* Rig time in s as host time: a virtual rig may run faster. */
int64_t wb_bend_test_host_ns(const struct wb_bend_test *test, double rig_seconds);
/* m down from the start position, of a machine position. */
double wb_bend_test_travel_of(const struct wb_bend_test *test, double position);

/* --- bend_test_start.c --- */

void wb_bend_test_step_connect(struct wb_bend_test *test, int64_t now_ns);
void wb_bend_test_step_check(struct wb_bend_test *test, int64_t now_ns);
/* Arms the interlock with what is known so far: start position, tare. */
void wb_bend_test_arm(struct wb_bend_test *test);

/* --- bend_test_motion.c --- */

void wb_bend_test_step_tare(struct wb_bend_test *test, int64_t now_ns);
void wb_bend_test_step_down(struct wb_bend_test *test, int64_t now_ns);
void wb_bend_test_step_up(struct wb_bend_test *test, int64_t now_ns);
void wb_bend_test_step_rest(struct wb_bend_test *test, int64_t now_ns);
/* Offers the motion under way to the stage; it counts from when it is taken. */
void wb_bend_test_try_to_move(struct wb_bend_test *test);

/* --- bend_test_end.c --- */

void wb_bend_test_enter(struct wb_bend_test *test, enum wb_bend_phase phase);
/* How it ended; the first end stays. */
void wb_bend_test_set_end(struct wb_bend_test *test, enum wb_bend_test_end end, const char *format,
                          ...) __attribute__((format(printf, 3, 4)));
/* The last events. Nothing moves any more, or nobody listens. */
void wb_bend_test_finish(struct wb_bend_test *test);
/* Ends the test: stops the stage if it may be moving, else ends right away. */
void wb_bend_test_give_up(struct wb_bend_test *test, enum wb_interlock_reason reason,
                          const char *format, ...) __attribute__((format(printf, 3, 4)));
/* The interlock tripped by itself; the hold byte has already left. */
void wb_bend_test_note_trip(struct wb_bend_test *test);
void wb_bend_test_step_stop(struct wb_bend_test *test);

#endif
