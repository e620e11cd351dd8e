/* Counts missing, repeated and out-of-order samples of a stream from the samples alone.
 *
 * A streaming instrument has a constant period. Cameras stamp their frames: a step of two periods
 * is one lost frame, wherever it was lost. A load cell sends no time stamps, and its lines arrive
 * with varying delays. The stream is therefore divided into windows. The earliest line of a window,
 * relative to the period, has almost no delay, and between two such lines an integer number of
 * periods passes: one per line, received or lost. The period is chosen to minimise the fractions.
 * If arrivals have no period (lines in bundles, an instrument that is polled irregularly), no
 * samples are counted as missing.
 *
 * Pure functions: no memory, no clock.
 */
#ifndef WB_DAQ_PROTOCOL_LOSS_H
#define WB_DAQ_PROTOCOL_LOSS_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/protocol/sample.h"

#define WB_LOSS_LEARNT 64  /* intervals from which the period is determined */
#define WB_LOSS_RECENT 64  /* stamps stored to detect repeated ones */
#define WB_LOSS_WINDOWS 32 /* windows of arrivals; evaluated again when the period improves */
#define WB_LOSS_TAIL 4     /* last arrivals, of which the earliest is used */

struct wb_loss_counts {
    uint64_t received;  /* without repeated samples */
    uint64_t missing;   /* lower bound of the samples that were not received */
    uint64_t gaps;      /* number of gaps with missing samples */
    uint64_t repeated;  /* samples received again, with the same stamp */
    uint64_t overtaken; /* samples received after a later one */
    double longest_gap; /* s of the stream's clock, without one period */
    double period;      /* s; 0: no period, missing samples cannot be determined */
};

/* Recent gaps of stamps, which late samples may still close. */
struct wb_loss_open {
    uint64_t missing, gaps;
    double longest_gap; /* s */
};

/* An arrival: number in the stream, and time in s. */
struct wb_loss_arrival {
    double number, t;
};

/* The earliest arrival of a window, and its intervals that may contain lost samples. */
struct wb_loss_window {
    struct wb_loss_arrival earliest;
    double widest; /* s */
    int n_long;
};

struct wb_loss {
    struct wb_loss_counts counts;
    struct wb_loss_open young, old;   /* of stamps: the latest gaps, and those before */
    int n_passed;                     /* stamps in order since `young` began */
    bool stamped;                     /* times are stamps of the device, not arrivals */
    double times[WB_LOSS_LEARNT + 1]; /* s, until the period is known; then recent stamps */
    int n_times, next;
    double last; /* s, the latest */
    /* For arrivals. `counts` is final and covers the time before the first stored window. */
    struct wb_loss_arrival tail[WB_LOSS_TAIL];
    struct wb_loss_window window; /* the window being filled */
    int n_window;                 /* arrivals in it */
    double begun;                 /* s, its begin */
    double slope;                 /* s, mean time per received line */
    struct wb_loss_window windows[WB_LOSS_WINDOWS];
    int n_windows;
    struct wb_loss_open recent; /* missing in the stored windows */
    double learnt, doubt;       /* s, period from intervals; its relative uncertainty */
    bool is_fitted;             /* the period was fitted to the windows */
    bool has_last, has_begun;   /* has_begun: gaps between stamps are counted */
};

/* Initialises. `stamped`: times are stamps of the device's clock, otherwise arrivals. `period` (s):
 * the announced period; 0: it is determined from the samples. */
void wb_loss_init(struct wb_loss *loss, bool stamped, double period);

/* Adds a sample with its time in s; if the time is not finite, the sample only counts as received.
 */
void wb_loss_add(struct wb_loss *loss, double t);

/* The counts so far. Of arrivals, gaps at the end of the stream are included; of stamps, gaps near
 * the beginning and the end are not, because frames may still arrive late. */
struct wb_loss_counts wb_loss_counts(const struct wb_loss *loss);

/* Fraction of missing samples, 0 to 1; and whether it exceeds chance: one stamped sample does, of
 * arrivals more than 2 %. */
double wb_loss_share(const struct wb_loss_counts *counts);
bool wb_loss_is_significant(const struct wb_loss *loss);

#endif
