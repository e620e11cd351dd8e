/* What a stream did not bring, counted from its samples alone: missing, repeated and overtaken
 * ones.
 *
 * An instrument that streams keeps a rhythm. Cameras stamp their frames: a step of two periods is
 * one frame lost on the way, whoever lost it. A load cell stamps nothing, and its lines arrive
 * late, by times that vary. The stream is therefore cut into windows. The earliest line of each,
 * against the rhythm, is nearly prompt, and between two such lines whole periods pass: one for each
 * line, received or lost. The period is the one that leaves the smallest fractions. Where arrivals
 * show no rhythm (lines that come in bundles, an instrument that is asked now and then) none are
 * counted as missing.
 *
 * Pure: samples in, counts out; no memory, no clock.
 */
#ifndef WB_DAQ_PROTOCOL_LOSS_H
#define WB_DAQ_PROTOCOL_LOSS_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/protocol/sample.h"

#define WB_LOSS_LEARNT 64  /* intervals that the period is learnt from */
#define WB_LOSS_RECENT 64  /* stamps that a repeated one is known by */
#define WB_LOSS_WINDOWS 32 /* of arrivals; they are counted anew with every better period */
#define WB_LOSS_TAIL 4     /* arrivals at the end that one is the earliest of */

struct wb_loss_counts {
    uint64_t received;  /* repeated ones not among them */
    uint64_t missing;   /* at least so many never came */
    uint64_t gaps;      /* places where some are missing */
    uint64_t repeated;  /* came again, with the same stamp */
    uint64_t overtaken; /* came after a later one */
    double longest_gap; /* s, by the stream's own clock, without its period */
    double period;      /* s; 0: no rhythm, and nothing is known to be missing */
};

/* Stamps that were passed over a moment ago: overtaken ones may still come. */
struct wb_loss_open {
    uint64_t missing, gaps;
    double longest_gap; /* s */
};

/* An arrival: number in the stream, and s. */
struct wb_loss_arrival {
    double number, t;
};

/* The earliest arrival of a window, and intervals of the window that may hide lost ones. */
struct wb_loss_window {
    struct wb_loss_arrival earliest;
    double widest; /* s */
    int n_long;
};

struct wb_loss {
    struct wb_loss_counts counts;
    struct wb_loss_open young, old;   /* of stamps: gaps of the latest ones, and of those before */
    int n_passed;                     /* stamps in order since the young ones began */
    bool stamped;                     /* times are the device's stamps, not arrivals */
    double times[WB_LOSS_LEARNT + 1]; /* s, until the period is known; then the recent stamps */
    int n_times, next;
    double last; /* s, the latest */
    /* Of arrivals. Those of `counts` are settled: before the first of the windows kept. */
    struct wb_loss_arrival tail[WB_LOSS_TAIL];
    struct wb_loss_window window; /* being filled, */
    int n_window;                 /* with so many, */
    double begun;                 /* since then, s */
    double slope;                 /* s per arrival on average, lost ones or not */
    struct wb_loss_window windows[WB_LOSS_WINDOWS];
    int n_windows;
    struct wb_loss_open recent; /* missing in the windows kept */
    double learnt, doubt;       /* s, the period from intervals; its relative uncertainty */
    bool is_fitted;             /* the period fits the windows */
    bool has_last, has_begun;   /* begun: gaps between stamps count */
};

/* Begins to count. `stamped`: times are stamps of the device's clock; else arrivals. `period` (s):
 * the rhythm that is announced; 0: it is learnt. */
void wb_loss_init(struct wb_loss *loss, bool stamped, double period);

/* A sample came, with this time in s. Not finite: it counts as received. */
void wb_loss_add(struct wb_loss *loss, double t);

/* The counts so far. Of arrivals, a gap at the end of a stream counts; of stamps it does only
 * between some earlier and some later ones, because overtaken ones may be on their way. */
struct wb_loss_counts wb_loss_counts(const struct wb_loss *loss);

/* The share of samples that are missing, 0 to 1, and whether that is more than chance: one stamped
 * sample is, of arrivals it takes two percent. */
double wb_loss_share(const struct wb_loss_counts *counts);
bool wb_loss_is_significant(const struct wb_loss *loss);

#endif
