#include "daq/acquire/release.h"

#include <math.h>
#include <string.h>

#include "base/units.h"

/* The reading is level if it falls by less than LEVEL_SHARE of the capacity over LEVEL_OVER. */
#define LEVEL_SHARE 1e-3
#define LEVEL_OVER (0.5 * WB_MM)
#define LOOSE_SHARE 0.25 /* of the capacity: largest reading of a slack strand, zero unknown */
#define ZERO_SHARE 0.02  /* of the capacity: largest drift of a known zero */
#define CERTAINTY 3.0    /* standard errors */

/* Length of a step up. */
#define STEP (1.0 * WB_MM)
#define LOADED_STEP (2.0 * WB_MM) /* while the reading is not near zero */

/* The readings of a rest are averaged in groups until two consecutive groups agree: thus readings
 * delayed from before the standstill do not count. */
#define GROUP_READINGS 4
#define GROUP_NS (150 * WB_NS_PER_MS)
#define GROUPS_MAX 16 /* after this many groups an unstable reading is accepted */

void wb_release_init(struct wb_release *release, const struct wb_rig *rig, double zero)
{
    memset(release, 0, sizeof *release);
    const double scale = rig->time_scale > 0.0 ? rig->time_scale : 1.0;
    release->noise = rig->load_cell.noise;
    release->capacity = rig->load_cell.capacity;
    release->zero = zero;
    release->settle_ns = wb_ns_from_seconds(2.0 * rig->load_cell.filter_delay / scale);
    release->group_ns = (int64_t)((double)GROUP_NS / scale);
}

void wb_release_rest(struct wb_release *release, double travel, int64_t t_ns)
{
    release->travel = travel;
    release->rest_ns = t_ns;
    release->resting = true;
    release->groups = 0;
    memset(&release->now, 0, sizeof release->now);
    memset(&release->before, 0, sizeof release->before);
    memset(&release->overloaded, 0, sizeof release->overloaded);
}

static double mean_of(const struct wb_release_group *group)
{
    return group->sum / group->n;
}

/* N2, variance of one reading: from the scatter, but at least the noise of the rig file. */
static double variance(const struct wb_release *release)
{
    const struct wb_release_group *const groups[] = {&release->before, &release->now};
    double squares = 0.0;
    int n = 0;
    for (int i = 0; i < 2; i++) {
        squares += groups[i]->squares - groups[i]->n * pow(mean_of(groups[i]), 2);
        n += groups[i]->n - 1;
    }
    return fmax(squares / n, release->noise * release->noise);
}

/* Whether the means of both groups (which must be full) agree. */
static bool groups_agree(const struct wb_release *release)
{
    const double apart = fabs(mean_of(&release->now) - mean_of(&release->before));
    const double error = sqrt(variance(release) * (1.0 / release->now.n + 1.0 / release->before.n));
    return apart <= 0.5 * LEVEL_SHARE * release->capacity + CERTAINTY * error;
}

static void push_place(struct wb_release *release, double force, double error)
{
    memmove(&release->places[1], &release->places[0],
            (WB_RELEASE_RESTS - 1) * sizeof release->places[0]);
    release->places[0] =
        (struct wb_release_place){.travel = release->travel, .force = force, .error = error};
    if (release->n_places < WB_RELEASE_RESTS)
        release->n_places++;
    release->resting = false;
}

/* N, standard error of the mean of both groups. */
static double error_of_mean(const struct wb_release *release)
{
    return sqrt(variance(release) / (release->now.n + release->before.n));
}

/* Whether the standard error is small enough to recognise level readings at two such rests that are
 * WB_RELEASE_LEVEL_WAY apart. */
static bool is_sharp(const struct wb_release *release)
{
    const double slope = LEVEL_SHARE * release->capacity / LEVEL_OVER;
    return M_SQRT2 * CERTAINTY * error_of_mean(release) <= 0.75 * slope * WB_RELEASE_LEVEL_WAY;
}

static void end_rest(struct wb_release *release)
{
    const int n = release->now.n + release->before.n;
    push_place(release, (release->now.sum + release->before.sum) / n, error_of_mean(release));
}

/* An overloaded cell gives no number, but the strand is certainly not slack. */
static void add_overload(struct wb_release *release, int64_t t_ns)
{
    struct wb_release_group *const group = &release->overloaded;
    if (group->n++ == 0)
        group->first_ns = t_ns;
    if (group->n >= GROUP_READINGS && t_ns - group->first_ns >= release->group_ns)
        push_place(release, (double)NAN, 0.0);
}

void wb_release_add(struct wb_release *release, const struct wb_load_sample *sample)
{
    if (!release->resting || sample->t_ns <= release->rest_ns + release->settle_ns)
        return;
    if (sample->overload)
        add_overload(release, sample->t_ns);
    if (!sample->valid || sample->overload)
        return;
    struct wb_release_group *const now = &release->now;
    if (now->n == 0)
        now->first_ns = sample->t_ns;
    now->last_ns = sample->t_ns;
    now->n++;
    now->sum += sample->force;
    now->squares += sample->force * sample->force;
    if (now->n < GROUP_READINGS || now->last_ns - now->first_ns < release->group_ns)
        return;
    release->groups++;
    const bool agrees = release->groups >= 2 && groups_agree(release);
    if (release->groups >= GROUPS_MAX || (agrees && is_sharp(release))) {
        end_rest(release);
        return;
    }
    if (agrees) {
        /* Averaging longer with a noisy cell detects a slack strand after a shorter travel. */
        release->before.n += now->n;
        release->before.sum += now->sum;
        release->before.squares += now->squares;
    } else {
        release->before = *now;
    }
    memset(now, 0, sizeof *now);
}

/* Whether a slack strand could cause this reading. The NaN of an overloaded cell compares false,
 * here and in is_level(). */
static bool near_zero(const struct wb_release *release, const struct wb_release_place *place)
{
    if (!isfinite(release->zero))
        return fabs(place->force) <= LOOSE_SHARE * release->capacity;
    return fabs(place->force - release->zero) <=
           ZERO_SHARE * release->capacity + CERTAINTY * place->error;
}

/* Whether the reading is level between two rests, even if noise hides a part of the change. */
static bool is_level(const struct wb_release *release, const struct wb_release_place *a,
                     const struct wb_release_place *b)
{
    const double slope = LEVEL_SHARE * release->capacity / LEVEL_OVER;
    const double change = fabs(a->force - b->force) + CERTAINTY * hypot(a->error, b->error);
    return change <= slope * fabs(a->travel - b->travel);
}

enum wb_release_verdict wb_release_judge(const struct wb_release *release)
{
    if (release->resting || release->n_places == 0)
        return WB_RELEASE_LISTEN;
    const struct wb_release_place *const here = &release->places[0];
    for (int i = 1; i < release->n_places; i++) {
        const struct wb_release_place *const there = &release->places[i];
        const double way = fabs(here->travel - there->travel);
        const bool both_near = near_zero(release, here) && near_zero(release, there);
        const double enough = both_near ? WB_RELEASE_LEVEL_WAY : WB_RELEASE_STUCK_WAY;
        if (way < enough || !is_level(release, here, there))
            continue;
        if (!both_near)
            return WB_RELEASE_STUCK;
        return isfinite(release->zero) ? WB_RELEASE_SLACK : WB_RELEASE_LEVEL;
    }
    return WB_RELEASE_GO_UP;
}

double wb_release_step(const struct wb_release *release)
{
    const bool loaded = release->n_places > 0 && !near_zero(release, &release->places[0]);
    return loaded ? LOADED_STEP : STEP;
}

double wb_release_force(const struct wb_release *release)
{
    return release->n_places > 0 ? release->places[0].force : (double)NAN;
}
