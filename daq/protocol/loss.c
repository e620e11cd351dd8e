#include "daq/protocol/loss.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* s: a stamp that goes back by more is a device that began anew. */
#define RESTART 0.5
/* s: a longer silence is a stop of the stream, which is told elsewhere. */
#define LONGEST 60.0
/* Shares of the period. */
#define SAME 0.25     /* stamps nearer than this are one */
#define LONG 1.6      /* an interval of arrivals that may hide a lost sample */
#define IN_RHYTHM 0.4 /* how far an interval may be off */
/* Share of intervals in rhythm without which arrivals have none. */
#define LEAST_RHYTHM 0.6
/* Arrivals that are nearer to each other than their mean by more than this factor come in bundles:
 * more than half of a stream that is watched is not lost. */
#define MOST_OFTEN 2.5
/* Stamps in order after which a gap grows old, and then is one: more than a network turns round. As
 * many at the beginning of a stream tell of none, because the first one may have been overtaken by
 * what was sent before this end listened. */
#define TURNED_ROUND 8
/* Regular intervals after which a late sample has nothing more to make up for. */
#define SETTLED 8
/* Share of arrivals that may seem to be missing on a busy computer. */
#define CHANCE 0.02

void wb_loss_init(struct wb_loss *loss, bool stamped, double period)
{
    memset(loss, 0, sizeof *loss);
    loss->stamped = stamped;
    loss->counts.period = period;
}

/* --- the period --- */

static int ascending(const void *a, const void *b)
{
    const double left = *(const double *)a, right = *(const double *)b;
    return (left > right) - (left < right);
}

/* The period of these times; 0 without one. A lost sample makes an interval longer, never shorter:
 * of stamps the lower quartile is the period while three quarters may be lost. Arrivals scatter,
 * and the median is taken. */
static double find_period(const struct wb_loss *loss)
{
    double intervals[WB_LOSS_LEARNT];
    int n = 0;
    for (int i = 1; i < loss->n_times; i++) {
        const double interval = loss->times[i] - loss->times[i - 1];
        if (interval >= 0.0 && (interval > 0.0 || !loss->stamped))
            intervals[n++] = interval;
    }
    if (n < WB_LOSS_LEARNT / 4)
        return 0.0;
    qsort(intervals, (size_t)n, sizeof *intervals, ascending);
    const double typical = intervals[loss->stamped ? n / 4 : n / 2];
    double sum = 0.0;
    int used = 0;
    for (int i = 0; i < n; i++) {
        if (fabs(intervals[i] - typical) > IN_RHYTHM * typical)
            continue;
        sum += intervals[i];
        used++;
    }
    const double least = loss->stamped ? 0.1 : LEAST_RHYTHM;
    const double mean = (loss->times[loss->n_times - 1] - loss->times[0]) / (loss->n_times - 1);
    if (!loss->stamped && mean > MOST_OFTEN * typical)
        return 0.0;
    return typical > 0.0 && used >= least * n ? sum / used : 0.0;
}

/* --- stamped --- */

static bool is_recent(const struct wb_loss *loss, double t)
{
    for (int i = 0; i < loss->n_times; i++) {
        if (fabs(t - loss->times[i]) < SAME * loss->counts.period)
            return true;
    }
    return false;
}

static void remember(struct wb_loss *loss, double t)
{
    loss->times[loss->next] = t;
    loss->next = (loss->next + 1) % WB_LOSS_RECENT;
    if (loss->n_times < WB_LOSS_RECENT)
        loss->n_times++;
}

static void open_gap(struct wb_loss *loss, double step)
{
    loss->young.missing += (uint64_t)(round(step / loss->counts.period) - 1.0);
    loss->young.gaps++;
    loss->young.longest_gap = fmax(loss->young.longest_gap, step - loss->counts.period);
}

/* What is passed over for long enough is missing. */
static void grow_old(struct wb_loss *loss)
{
    struct wb_loss_counts *const counts = &loss->counts;
    if (++loss->n_passed < TURNED_ROUND)
        return;
    loss->has_begun = true;
    counts->missing += loss->old.missing;
    counts->gaps += loss->old.gaps;
    counts->longest_gap = fmax(counts->longest_gap, loss->old.longest_gap);
    loss->old = loss->young;
    memset(&loss->young, 0, sizeof loss->young);
    loss->n_passed = 0;
}

/* An overtaken one makes up for a gap, most likely for one of the latest. */
static void make_up(struct wb_loss *loss)
{
    struct wb_loss_open *const open = loss->young.missing > 0 ? &loss->young : &loss->old;
    loss->counts.overtaken++;
    if (open->missing == 0)
        loss->counts.missing -= loss->counts.missing > 0;
    else if (--open->missing == 0)
        memset(open, 0, sizeof *open);
}

static void take_stamp(struct wb_loss *loss, double t)
{
    const double period = loss->counts.period, step = loss->has_last ? t - loss->last : period;
    if (is_recent(loss, t)) {
        loss->counts.repeated++;
        return;
    }
    loss->counts.received++;
    remember(loss, t);
    if (step < 0.0 && step > -RESTART) {
        make_up(loss);
        return;
    }
    grow_old(loss);
    if (loss->has_begun && step > 1.5 * period && step < LONGEST)
        open_gap(loss, step);
    loss->last = t;
    loss->has_last = true;
}

/* --- arrivals --- */

/* What the debt leaves missing. */
static void settle(struct wb_loss_counts *counts, double debt, double widest)
{
    const double missing = round(debt / counts->period);
    if (!(missing >= 1.0))
        return;
    counts->missing += (uint64_t)missing;
    counts->gaps++;
    counts->longest_gap = fmax(counts->longest_gap, widest - counts->period);
}

/* The period that was learnt on a busy computer is too short: of a late sample and the next one,
 * which makes up for it, only the short interval looks regular. Their mean is the period. */
static void refine_period(struct wb_loss *loss, double interval)
{
    if (interval < 0.0)
        return;
    loss->on_time += interval;
    if (++loss->n_on_time >= WB_LOSS_LEARNT / 2.0)
        loss->counts.period = loss->on_time / loss->n_on_time;
}

static void take_arrival(struct wb_loss *loss, double t)
{
    const double period = loss->counts.period;
    const double off = loss->has_last ? t - loss->last - period : 0.0;
    loss->counts.received++;
    loss->elapsed += loss->has_last ? off + period : period;
    loss->last = t;
    loss->has_last = true;
    if (off > LONGEST) {
        loss->debt = 0.0;
        loss->elapsed -= off;
        return;
    }
    const bool is_long = off >= (LONG - 1.0) * period;
    if (!is_long && !(loss->debt > 0.0)) {
        refine_period(loss, off + period);
        return;
    }
    loss->debt = fmax(loss->debt + off, 0.0);
    if (is_long)
        loss->widest = fmax(loss->widest, off + period);
    loss->n_regular = fabs(off) <= IN_RHYTHM * period ? loss->n_regular + 1 : 0;
    if (loss->n_regular >= SETTLED) {
        settle(&loss->counts, loss->debt, loss->widest);
        loss->debt = loss->widest = 0.0;
        loss->n_regular = 0;
    }
}

/* --- both --- */

static void take(struct wb_loss *loss, double t)
{
    if (loss->stamped)
        take_stamp(loss, t);
    else
        take_arrival(loss, t);
}

/* Enough times are there: finds the period, and takes them. Without one the oldest half goes, and
 * later ones may show a rhythm. */
static void learn(struct wb_loss *loss)
{
    double times[WB_LOSS_LEARNT + 1];
    const int n = loss->n_times;
    const double period = find_period(loss);
    memcpy(times, loss->times, sizeof times);
    loss->n_times = loss->next = 0;
    if (period > 0.0) {
        loss->counts.period = period;
        for (int i = 0; i < n; i++)
            take(loss, times[i]);
        return;
    }
    loss->counts.received += (uint64_t)(n / 2);
    for (int i = n / 2; i < n; i++)
        loss->times[loss->n_times++] = times[i];
}

void wb_loss_add(struct wb_loss *loss, double t)
{
    if (!isfinite(t)) {
        loss->counts.received++;
    } else if (loss->counts.period > 0.0) {
        take(loss, t);
    } else {
        loss->times[loss->n_times++] = t;
        if (loss->n_times > WB_LOSS_LEARNT)
            learn(loss);
    }
}

/* No more can be missing than would have filled the time: while the period was not known well,
 * more were counted. */
static void cap(const struct wb_loss *loss, struct wb_loss_counts *counts)
{
    const double room = round(loss->elapsed / counts->period) - (double)counts->received;
    if (loss->stamped || !(counts->period > 0.0) || (double)counts->missing <= room)
        return;
    counts->missing = room >= 1.0 ? (uint64_t)room : 0;
    if (counts->missing == 0) {
        counts->gaps = 0;
        counts->longest_gap = 0.0;
    }
}

struct wb_loss_counts wb_loss_counts(const struct wb_loss *loss)
{
    struct wb_loss_counts counts = loss->counts;
    if (!(counts.period > 0.0))
        counts.received += (uint64_t)loss->n_times;
    else if (!loss->stamped)
        settle(&counts, loss->debt, loss->widest);
    cap(loss, &counts);
    return counts;
}

double wb_loss_share(const struct wb_loss_counts *counts)
{
    const double all = (double)counts->received + (double)counts->missing;
    return all > 0.0 ? (double)counts->missing / all : 0.0;
}

bool wb_loss_is_told(const struct wb_loss *loss)
{
    /* Not what late arrivals may still make up for: asked while the stream goes on, that told of
     * losses which were none a moment later. */
    struct wb_loss_counts counts = loss->counts;
    cap(loss, &counts);
    return counts.missing > 0 && (loss->stamped || wb_loss_share(&counts) > CHANCE);
}
