#include "daq/protocol/natnet_watch.h"

#include <inttypes.h>
#include <math.h>

#include "base/units.h"
#include "daq/protocol/driver.h"

#define PROMISE_NS (3 * WB_NS_PER_S)

void wb_natnet_watch_promise(struct wb_natnet_watch *watch, int64_t t_ns)
{
    watch->waits_for_take = true;
    watch->promised_ns = t_ns;
}

/* Reports begin and end of the server's own take, and a take that was promised but did not begin.
 */
static void watch_take(struct wb_natnet_watch *watch, const struct wb_mocap_frame *frame,
                       const struct wb_sink *sink)
{
    const bool records = frame->params & WB_FRAME_RECORDING;
    const bool recorded = watch->has_frame && (watch->params & WB_FRAME_RECORDING);
    if (records)
        watch->waits_for_take = false;
    if (records != recorded)
        wb_driver_remark(sink, WB_LOG_INFO, frame->t_ns, "take",
                         records ? "the server records its own take from its frame %" PRId32
                                 : "the server's own take ended before its frame %" PRId32,
                         frame->frame_number);
    if (!watch->waits_for_take || frame->t_ns - watch->promised_ns < PROMISE_NS)
        return;
    watch->waits_for_take = false;
    wb_driver_remark(sink, WB_LOG_WARNING, frame->t_ns, "take",
                     "the server agreed to record its own take, but its frames are not flagged as "
                     "recorded: check that Motive is in live mode and its disk has space");
}

/* Whether a bit is set that was not set in the previous frame. */
static bool rises(const struct wb_natnet_watch *watch, const struct wb_mocap_frame *frame, int bit)
{
    return watch->has_frame && (frame->params & bit) && !(watch->params & bit);
}

bool wb_natnet_watch_frame(struct wb_natnet_watch *watch, const struct wb_mocap_frame *frame,
                           double back, const struct wb_sink *sink)
{
    const bool restarted = watch->has_frame && frame->t_device < watch->newest - back;
    if (restarted) {
        watch->segment++;
        if (wb_driver_is_report_due(++watch->n_restarts))
            wb_driver_remark(sink, WB_LOG_WARNING, frame->t_ns, "restart",
                             "the server's clock went back by %.3f s, to its frame %" PRId32
                             ": it was restarted; segment %d begins (%" PRIu64 " so far)",
                             watch->newest - frame->t_device, frame->frame_number, watch->segment,
                             watch->n_restarts);
        watch->newest = frame->t_device;
    } else if (rises(watch, frame, WB_FRAME_MODELS_CHANGED) ||
               rises(watch, frame, WB_FRAME_BITSTREAM_CHANGED)) {
        watch->segment++;
        if (wb_driver_is_report_due(++watch->n_changes))
            wb_driver_remark(sink, WB_LOG_WARNING, frame->t_ns, "models",
                             "the tracked models or the stream of the server were changed at its "
                             "frame %" PRId32 ": segment %d begins (%" PRIu64 " so far)",
                             frame->frame_number, watch->segment, watch->n_changes);
    }
    watch_take(watch, frame, sink);
    if (!watch->has_frame || !(frame->t_device <= watch->newest))
        watch->newest = frame->t_device;
    watch->params = frame->params;
    watch->has_frame = true;
    return restarted;
}
