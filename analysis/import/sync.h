/* Synchronization of two recordings of one test, each with its own clock, by an event in both: a
 * tap on the bench, or a reversal of the motion.
 *
 * A ramp that only rises fits itself at any lag, so no lag is found for it. A tap exceeds both
 * signals briefly. A reversal is a corner of both (analysis/import/reversal_lag.h); with a long
 * rest before the turn there are two. Events are paired by their pattern. A pattern that fits in
 * two ways, such as one missing of several equal cycles, gives no lag.
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
    int n_events;       /* paired events */
    double first_event; /* s, the first paired event on the motion's clock */
    char reason[256];   /* why there is no lag; "" otherwise */
};

struct wb_sync_settings {
    bool tap, reversal;  /* permitted methods; the result with the smaller uncertainty is used */
    double filter_delay; /* s, of the force */
};

/* Finds the lag of `force` (any unit and sign) behind `motion`. For taps `shake` is the fast part
 * of the motion, from wb_signal_shake() or zeros. The method is WB_SYNC_NONE if the lag is not
 * identifiable. */
void wb_sync_find(struct wb_sync *sync, const struct wb_signal *motion,
                  const struct wb_signal *shake, const struct wb_signal *force,
                  const struct wb_sync_settings *settings);

#endif
