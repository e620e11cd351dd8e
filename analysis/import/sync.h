/* Two recordings of one test, each with a clock of its own, brought together by what both saw: a
 * tap on the bench, or that the motion was reversed.
 *
 * A ramp that only rises slides along itself: any lag fits, and none is given. A tap stands out of
 * both signals for a moment. A reversal is a corner of both (analysis/import/reversal_lag.h); where
 * the motion rests for long before it turns, there are two. Events of the two are paired by their
 * pattern; a pattern that fits in two ways, as one missing of several equal cycles makes it, gives
 * no lag.
 */
#ifndef WB_ANALYSIS_IMPORT_SYNC_H
#define WB_ANALYSIS_IMPORT_SYNC_H

#include <stdbool.h>

#include "analysis/import/signal.h"

enum wb_sync_method {
    WB_SYNC_NONE,
    WB_SYNC_TAP,
    WB_SYNC_REVERSAL,
    WB_SYNC_GIVEN, /* by the operator */
    WB_SYNC_SAME   /* one file, one clock */
};
const char *wb_sync_name(enum wb_sync_method method);

struct wb_sync {
    enum wb_sync_method method;
    double lag;         /* s: time of an event on the motion's clock less that on the force's */
    double uncertainty; /* s, standard; NaN: not known */
    int n_events;       /* that were paired */
    double first_event; /* s, the first of them on the motion's clock */
    char reason[256];   /* why there is no lag; "" otherwise */
};

struct wb_sync_settings {
    bool tap, reversal;  /* what to look for; the one with the smaller uncertainty is taken */
    double filter_delay; /* s, of the force */
};

/* Finds the lag of `force` (any unit and sign) behind `motion`. For taps `shake` is the fast part
 * of the motion, from wb_signal_shake() or zeros where there is none. The method is
 * WB_SYNC_NONE where the lag is not identifiable. */
void wb_sync_find(struct wb_sync *sync, const struct wb_signal *motion,
                  const struct wb_signal *shake, const struct wb_signal *force,
                  const struct wb_sync_settings *settings);

#endif
