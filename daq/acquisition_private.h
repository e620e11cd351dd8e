/* What the parts of the acquisition share: acquisition.c (loop and receiving) and
 * acquisition_stop.c (sending, and stopping the stage). For nobody else. */
#ifndef WB_DAQ_ACQUISITION_PRIVATE_H
#define WB_DAQ_ACQUISITION_PRIVATE_H

#include "daq/acquisition.h"
#include "daq/remark_gate.h"
#include "daq/stream.h"

/* One open stream with its driver. */
struct wb_acquisition_line {
    struct wb_acquisition *owner;
    enum wb_role role;
    const struct wb_driver *driver;
    void *state;
    struct wb_stream *stream;
    int id; /* in the recording */
    bool reported_lost;
    int64_t write_again_ns; /* after a port that took no bytes: not before */
    uint64_t counted;       /* valid samples so far */
    uint64_t rate_from;     /* counted at rate_ns */
    int64_t rate_ns;
    bool has_rate;
    struct wb_remark_gate gate;
    uint64_t kernel_drops; /* datagrams the kernel lost, as far as told */
};

struct wb_acquisition {
    struct wb_rig rig;
    struct wb_sink user;
    struct wb_writer *writer;
    int n_lines;
    struct wb_acquisition_line lines[WB_INTERLOCK_ROLES];
    struct wb_acquisition_line *by_role[WB_INTERLOCK_ROLES];
    struct wb_interlock interlock;
    struct wb_stop stop;
    bool moving, started, hold_sent;
    enum wb_stop_state reported_stop;
    struct wb_acquisition_latest latest;
    int64_t next_tick_ns;
    int64_t woken_ns; /* end of the last wait for bytes */
    int64_t deaf_ns;  /* of all time since the start: nobody listened */
    struct wb_outbox outbox;
    uint8_t buffer[WB_STREAM_READ_MAX];
};

/* An event for the recording, if there is one. */
void wb_acquisition_push_event(struct wb_acquisition *a, int64_t t_ns, const char *kind,
                               const char *text);

/* A device that went away is not asked again; its silence is then known, not waited for. */
void wb_acquisition_lose_device(struct wb_acquisition_line *line);

/* Writes what a driver put into the outbox, and empties it. A port that takes no bytes is left
 * alone for a second, so that waiting for it cannot hold up the others; urgent bytes are always
 * tried. */
WB_MUST_CHECK enum wb_status wb_acquisition_send(struct wb_acquisition_line *line, bool urgent);

/* The interlock has just tripped: the hold byte goes out before anything else. */
void wb_acquisition_hold_now(struct wb_acquisition *a);

/* What is due of a stop that is under way. */
void wb_acquisition_follow_stop(struct wb_acquisition *a, int64_t now_ns);

#endif
