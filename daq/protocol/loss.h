/* What a stream did not bring, counted from its samples alone: missing, repeated and overtaken
 * ones.
 *
 * An instrument that streams keeps a rhythm. Cameras stamp their frames: a step of two periods is
 * one frame lost on the way, whoever lost it. A load cell stamps nothing; its lines arrive a little
 * late and then catch up, and a gap that nothing makes up for is a lost line. Where arrivals show
 * no rhythm (lines that come in bundles, an instrument that is asked now and then) nothing is said
 * of missing ones.
 *
 * Pure: samples in, counts out; no memory, no clock.
 */
#ifndef WB_DAQ_PROTOCOL_LOSS_H
#define WB_DAQ_PROTOCOL_LOSS_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/protocol/sample.h"

#define WB_LOSS_LEARNT 64 /* intervals that the period is learnt from */
#define WB_LOSS_RECENT 64 /* stamps that a repeated one is known by */

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

struct wb_loss {
    struct wb_loss_counts counts;
    struct wb_loss_open young, old;   /* of stamps: gaps of the latest ones, and of those before */
    int n_passed;                     /* stamps in order since the young ones began */
    bool stamped;                     /* times are the device's stamps, not arrivals */
    double times[WB_LOSS_LEARNT + 1]; /* s, until the period is known; then the recent stamps */
    int n_times, next;
    double last;      /* s, the latest */
    double debt;      /* s that arrivals are behind; what they do not make up for is missing */
    double widest;    /* s, longest interval of the debt */
    double elapsed;   /* s, of all arrivals, without stops of the stream */
    double on_time;   /* s, sum of the intervals without debt, */
    double n_on_time; /* and how many */
    int n_regular;    /* intervals in rhythm since the debt was made or paid */
    bool has_last, has_begun; /* begun: gaps between stamps count */
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
bool wb_loss_is_told(const struct wb_loss *loss);

#endif
