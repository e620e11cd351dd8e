#include "daq/protocol/jog_feed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"

#define UM 1e-6
#define LEAST_TIME 0.02               /* s at the jog's speed: shortest block */
#define BLOCKS 12                     /* used of the firmware's planner, which has 15 */
#define LEAST_AHEAD (4.0 * UM)        /* m, lower bound of `ahead` */
#define BLIND_NS (400 * WB_NS_PER_MS) /* longest prediction without a report */

double wb_jog_feed_ahead(const struct wb_motion_limits *top)
{
    return fmax(top->speed * (0.5 * top->speed / top->acceleration + WB_JOG_FEED_AHEAD),
                LEAST_AHEAD);
}

void wb_jog_feed_begin(struct wb_jog_feed *feed, const struct wb_jog *jog)
{
    memset(feed, 0, sizeof *feed);
    feed->active = true;
    feed->jog = *jog;
    feed->direction = jog->distance < 0.0 ? -1 : 1;
    feed->way_um = llround(fabs(jog->distance) / UM);
    feed->ahead = wb_jog_feed_ahead(&jog->top);
    feed->least = fmax(fmax(LEAST_TIME * jog->top.speed, feed->ahead / BLOCKS), UM);
    feed->at_rest = true;
    feed->resumed_um = -1;
}

/* Predicts the motion from here to the end of the accepted blocks. */
static void predict(struct wb_jog_feed *feed, int64_t t_ns, double done, double speed)
{
    const double end = (double)feed->accepted_um * UM;
    wb_motion_plan(&feed->motion, wb_seconds_from_ns(t_ns), fmin(done, end),
                   fmin(speed, feed->jog.top.speed), end, &feed->jog.top);
    feed->at_rest = false;
    feed->seen_ns = t_ns;
}

static void stand(struct wb_jog_feed *feed, int64_t t_ns, double done)
{
    memset(&feed->motion, 0, sizeof feed->motion);
    feed->motion.from = feed->motion.end = done;
    feed->at_rest = true;
    feed->seen_ns = t_ns;
}

void wb_jog_feed_report(struct wb_jog_feed *feed, int64_t t_ns, double position, double speed,
                        bool is_idle, bool waits)
{
    const double done = (position - feed->jog.start) * feed->direction;
    if (!feed->active || !isfinite(done))
        return;
    feed->idle_reports = is_idle && !waits ? feed->idle_reports + 1 : 0;
    if (!is_idle) {
        predict(feed, t_ns, done, isfinite(speed) ? speed : feed->jog.top.speed);
        return;
    }
    stand(feed, t_ns, done);
    const int64_t done_um = llround(done / UM);
    const bool is_short = (double)(feed->sent_um - done_um) * UM > feed->jog.rounding;
    const bool goes_on = feed->sent_um < feed->way_um || feed->is_lost || is_short;
    if (!waits && !goes_on)
        feed->active = false;
    if (!feed->active || feed->idle_reports < 2)
        return;
    if (is_short && done_um == feed->resumed_um)
        feed->active = false; /* sending the missing blocks again had no effect: give up */
    if (is_short) {
        feed->sent_um = done_um;
        feed->resumed_um = done_um;
    }
    feed->accepted_um = feed->sent_um;
    feed->is_lost = false;
}

double wb_jog_feed_next(const struct wb_jog_feed *feed, int64_t now_ns)
{
    const int64_t left_um = feed->way_um - feed->sent_um;
    if (!feed->active || feed->is_lost || left_um <= 0)
        return 0.0;
    double done = feed->motion.end, speed;
    if (!feed->at_rest && now_ns - feed->seen_ns > BLIND_NS)
        return 0.0;
    if (!feed->at_rest)
        wb_motion_at(&feed->motion, wb_seconds_from_ns(now_ns), &done, &speed);
    done = fmin(done, (double)feed->accepted_um * UM);
    const int64_t room_um =
        (int64_t)floor((feed->ahead - ((double)feed->sent_um * UM - done)) / UM);
    if (room_um < left_um && (double)room_um * UM < feed->least)
        return 0.0;
    const int64_t block_um = left_um < room_um ? left_um : room_um;
    return (double)block_um * UM * feed->direction;
}

void wb_jog_feed_sent(struct wb_jog_feed *feed, double block)
{
    feed->sent_um += llround(block * feed->direction / UM);
    feed->idle_reports = 0;
}

void wb_jog_feed_accepted(struct wb_jog_feed *feed, int64_t t_ns)
{
    double done = feed->motion.end, speed = 0.0;
    if (!feed->at_rest)
        wb_motion_at(&feed->motion, wb_seconds_from_ns(t_ns), &done, &speed);
    const int64_t seen_ns = feed->at_rest ? t_ns : feed->seen_ns;
    feed->accepted_um = feed->sent_um;
    predict(feed, t_ns, done, fabs(speed));
    feed->seen_ns = seen_ns;
}

void wb_jog_feed_lose(struct wb_jog_feed *feed)
{
    feed->is_lost = true;
    feed->idle_reports = 0;
}
