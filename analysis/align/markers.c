#include "analysis/align/markers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/align/markers_private.h"
#include "base/memory.h"
#include "base/units.h"
#include "base/vec3.h"

#define WB_LOG_DOMAIN "markers"

#define DEFAULT_NOISE (0.1 * WB_MM)
#define DEFAULT_PERIOD (1.0 / 120.0)
/* Largest distance (m) of a marker from its prediction, at least, and in standard deviations of a
 * coordinate; speed (m/s, per second of the frame period's time scale) by which it grows in a gap.
 */
#define LEAST_GATE (2.0 * WB_MM)
#define GATE_NOISES 8.0
#define GATE_SPEED (5.0 * WB_MM)
/* Following starts at the cheapest complete chain among this number of frames. */
#define START_FRAMES 240
/* Number of frames, evenly over a long recording, that are searched for the start. */
#define LOOKED_AT 4000
/* Weight of a frame in which a marker is not seen but carried along, by seen neighbours on both
 * sides or on one. */
#define CARRIED_BY_TWO 0.02
#define CARRIED_BY_ONE 0.3
/* Cost above which a link belongs to a wrong marker: four tolerances, squared. */
#define BROKEN_LINK_COST 16.0
/* Cost of a missing marker: that of a link off by three tolerances. */
#define MISSING_COST 9.0
#define LARGEST_LINK_COST 16.0
/* Cosine of the largest turn (60 degrees) between two successive links. */
#define LEAST_COSINE 0.5
/* Limit of the search; without it a dense cloud of points would take exponential time. */
#define MOST_VISITS 20000
/* Standard uncertainty of a marker's placement on the wire, m, however well the cameras resolve. */
#define PLACEMENT (0.3 * WB_MM)
/* A bent wire's chord is shorter than its arc, by at most this part (and by what the marker's
 * offset towards the inside of the bend takes, PLACEMENT's order). */
#define CHORD_SHORTFALL 0.03

/* --- the cloud --- */

void wb_point_cloud_add(struct wb_point_cloud *cloud, const struct wb_mocap_frame *frame)
{
    cloud->frames = wb_memory_room(cloud->frames, &cloud->frames_capacity, cloud->n_frames + 1,
                                   sizeof *cloud->frames);
    cloud->points =
        wb_memory_room(cloud->points, &cloud->points_capacity,
                       cloud->n_points + (size_t)frame->n_markers, sizeof *cloud->points);
    struct wb_point_frame *const added = &cloud->frames[cloud->n_frames++];
    *added = (struct wb_point_frame){
        .t_ns = frame->t_ns,
        .t_device = frame->t_device,
        .t_clock = frame->t_clock,
        .first = cloud->n_points,
    };
    for (int i = 0; i < frame->n_markers; i++) {
        const struct wb_marker *const marker = &frame->markers[i];
        if (marker->params & WB_MARKER_OCCLUDED) {
            cloud->n_occluded++;
        } else if (marker->params & WB_MARKER_MODEL_FILLED) {
            cloud->n_filled++;
        } else if (isfinite(marker->position[0]) && isfinite(marker->position[1]) &&
                   isfinite(marker->position[2])) {
            for (int k = 0; k < 3; k++)
                cloud->points[cloud->n_points][k] = (double)marker->position[k];
            cloud->n_points++;
            added->n++;
        }
    }
}

void wb_point_cloud_release(struct wb_point_cloud *cloud)
{
    free(cloud->frames);
    free(cloud->points);
    memset(cloud, 0, sizeof *cloud);
}

/* --- the best chain of points: which are our markers, in order along the wire --- */

/* Cost of two points as markers `i` < `j`: the squared ratio of the distance's error to its
 * tolerance. */
static double link_cost(const struct wb_specimen *specimen, double noise, int i, int j,
                        const double *a, const double *b)
{
    const double arc = specimen->markers[j] - specimen->markers[i];
    const double error = wb_vec3_distance(a, b) - arc;
    double tolerance = sqrt(2.0 * (noise * noise + PLACEMENT * PLACEMENT));
    if (error < 0.0)
        tolerance += CHORD_SHORTFALL * arc;
    return error * error / (tolerance * tolerance);
}

/* Input and state of a search for a chain; the state starts as zeros. */
struct search {
    const double (*points)[3];
    int n;
    const struct wb_specimen *specimen;
    double noise;
    int least;      /* markers that must be in the chain, 2 in any case */
    bool need_ends; /* the first and the last marker must be in the chain */
    int visits;
    int chain[WB_SPECIMEN_MAX_MARKERS]; /* being built */
    int best[WB_SPECIMEN_MAX_MARKERS];
    int best_length;
    double best_cost;
};

static bool is_used(const struct search *search, int marker, int point)
{
    for (int i = 0; i < marker; i++) {
        if (search->chain[i] == point)
            return true;
    }
    return false;
}

/* Cosine of the turn between the links to the two markers last chosen; 1 is straight. */
static double cosine(const struct search *search, int second_last, int last, int point)
{
    const double *const a = search->points[second_last];
    const double *const b = search->points[last];
    const double *const c = search->points[point];
    double dot = 0.0;
    for (int k = 0; k < 3; k++)
        dot += (b[k] - a[k]) * (c[k] - b[k]);
    const double lengths = wb_vec3_distance(a, b) * wb_vec3_distance(b, c);
    return lengths > 0.0 ? dot / lengths : -1.0;
}

/* The last two markers before `marker` that have a point; -1 if there is none. */
static void find_last_two(const struct search *search, int marker, int *last, int *second_last)
{
    *last = *second_last = -1;
    for (int i = marker - 1; i >= 0; i--) {
        if (search->chain[i] < 0)
            continue;
        if (*last < 0) {
            *last = i;
        } else {
            *second_last = i;
            return;
        }
    }
}

/* Depth first over the markers; branches that already cost more than the best are cut. */
static void extend(struct search *search, int marker, int length, double cost)
{
    const int n_markers = search->specimen->n_markers;
    const int missing = marker - length;
    if (cost >= search->best_cost || missing > n_markers - search->least ||
        search->visits++ > MOST_VISITS)
        return;
    if (marker == n_markers) {
        search->best_cost = cost;
        search->best_length = length;
        memcpy(search->best, search->chain, sizeof search->best);
        return;
    }
    int last, second_last;
    find_last_two(search, marker, &last, &second_last);
    for (int point = 0; point < search->n; point++) {
        if (is_used(search, marker, point))
            continue;
        double link = 0.0;
        if (last >= 0)
            link = link_cost(search->specimen, search->noise, last, marker,
                             search->points[search->chain[last]], search->points[point]);
        if (!(link <= LARGEST_LINK_COST))
            continue;
        if (second_last >= 0) {
            const double straight =
                cosine(search, search->chain[second_last], search->chain[last], point);
            if (!(straight >= LEAST_COSINE))
                continue;
            link += 4.0 * (1.0 - straight);
        }
        search->chain[marker] = point;
        extend(search, marker + 1, length + 1, cost + link);
    }
    if (search->need_ends && (marker == 0 || marker == n_markers - 1))
        return;
    search->chain[marker] = -1;
    extend(search, marker + 1, length, cost + MISSING_COST);
}

/* Number of markers in the best chain (then search->best, with search->best_cost), or 0 if there is
 * no chain. */
static int find_chain(struct search *search)
{
    if (search->least < 2)
        search->least = 2;
    search->best_cost = HUGE_VAL;
    if (search->n >= search->least)
        extend(search, 0, 0, 0.0);
    return search->best_length;
}

int wb_markers_chain(const double (*points)[3], int n, const struct wb_specimen *specimen,
                     double noise, int least, int *chosen)
{
    struct search search = {
        .points = points, .n = n, .specimen = specimen, .noise = noise, .least = least};
    if (find_chain(&search) > 0)
        memcpy(chosen, search.best, (size_t)specimen->n_markers * sizeof *chosen);
    return search.best_length;
}

/* --- following --- */

struct tracker {
    struct wb_marker_tracks *tracks;
    const struct wb_point_cloud *cloud;
    const struct wb_specimen *specimen;
    struct wb_marker_settings settings;
    double smallest_spacing;
    double predicted[WB_SPECIMEN_MAX_MARKERS][3];
    /* frames since it was last seen, weighted by the uncertainty of its motion in each */
    double unseen[WB_SPECIMEN_MAX_MARKERS];
};

static int32_t *row_of(const struct wb_marker_tracks *tracks, size_t frame)
{
    return tracks->index + frame * (size_t)tracks->n_markers;
}

static const double (*points_of(const struct wb_point_cloud *cloud, size_t frame))[3]
{
    return (const double(*)[3])cloud->points + cloud->frames[frame].first;
}

/* Largest distance of a marker from its prediction: it grows in a gap, but stays below the distance
 * at which the neighbour could be taken instead. */
static double gate_of(const struct tracker *tracker, int marker)
{
    const double gap = tracker->unseen[marker] * tracker->settings.frame_period;
    return fmin(fmax(LEAST_GATE, GATE_NOISES * tracker->settings.noise) + GATE_SPEED * gap,
                0.45 * tracker->smallest_spacing);
}

/* Pairs markers and points by distance, nearest first. */
static void assign_nearest(const struct tracker *tracker, size_t frame, int *chosen)
{
    const double(*const points)[3] = points_of(tracker->cloud, frame);
    const int n = tracker->cloud->frames[frame].n, n_markers = tracker->specimen->n_markers;
    for (int marker = 0; marker < n_markers; marker++)
        chosen[marker] = -1;
    bool taken[WB_MAX_MARKERS] = {false};
    for (;;) {
        double nearest = HUGE_VAL;
        int best_marker = -1, best_point = -1;
        for (int marker = 0; marker < n_markers; marker++) {
            if (chosen[marker] >= 0)
                continue;
            const double gate = gate_of(tracker, marker);
            for (int point = 0; point < n; point++) {
                const double distance = wb_vec3_distance(tracker->predicted[marker], points[point]);
                if (!taken[point] && distance < gate && distance < nearest) {
                    nearest = distance;
                    best_marker = marker;
                    best_point = point;
                }
            }
        }
        if (best_marker < 0)
            return;
        chosen[best_marker] = best_point;
        taken[best_point] = true;
    }
}

/* Drops markers whose distances to their neighbours do not fit: the one of a bad pair that is
 * farther from its prediction. */
static void drop_broken_links(const struct tracker *tracker, size_t frame, int *chosen)
{
    const double(*const points)[3] = points_of(tracker->cloud, frame);
    int last = -1;
    for (int marker = 0; marker < tracker->specimen->n_markers; marker++) {
        if (chosen[marker] < 0)
            continue;
        if (last >= 0) {
            const double *const a = points[chosen[last]], *const b = points[chosen[marker]];
            if (link_cost(tracker->specimen, tracker->settings.noise, last, marker, a, b) >
                BROKEN_LINK_COST) {
                const bool drop_last = wb_vec3_distance(tracker->predicted[last], a) >
                                       wb_vec3_distance(tracker->predicted[marker], b);
                chosen[drop_last ? last : marker] = -1;
                if (!drop_last)
                    continue;
            }
        }
        last = marker;
    }
}

static int count_chosen(const int *chosen, int n)
{
    int count = 0;
    for (int i = 0; i < n; i++)
        count += chosen[i] >= 0;
    return count;
}

/* Distance of a chain from the predictions, with the chain taken forwards or backwards. */
static double chain_distance(const struct tracker *tracker, size_t frame, const int *chosen,
                             bool reversed)
{
    const double(*const points)[3] = points_of(tracker->cloud, frame);
    const int n = tracker->specimen->n_markers;
    double sum = 0.0;
    for (int i = 0; i < n; i++) {
        const int point = chosen[reversed ? n - 1 - i : i];
        if (point >= 0)
            sum += wb_vec3_distance(tracker->predicted[i], points[point]);
    }
    return sum;
}

static void reverse(int32_t *list, int n)
{
    for (int i = 0; i < n / 2; i++) {
        const int32_t swapped = list[i];
        list[i] = list[n - 1 - i];
        list[n - 1 - i] = swapped;
    }
}

static struct search search_in(const struct tracker *tracker, size_t frame, int least,
                               bool need_ends)
{
    return (struct search){
        .points = points_of(tracker->cloud, frame),
        .n = tracker->cloud->frames[frame].n,
        .specimen = tracker->specimen,
        .noise = tracker->settings.noise,
        .least = least,
        .need_ends = need_ends,
    };
}

/* Searches for the chain again after most markers were lost, in the order that is nearer to the
 * last known one. */
static void search_again(struct tracker *tracker, size_t frame, int *chosen)
{
    const int n_markers = tracker->specimen->n_markers;
    const int n = tracker->cloud->frames[frame].n;
    const int least = n_markers > 4 ? n_markers - 2 : n_markers;
    const int seen = count_chosen(chosen, n_markers);
    if (n < least || seen >= least)
        return;
    tracker->tracks->n_searches++;
    struct search search = search_in(tracker, frame, least, false);
    if (find_chain(&search) <= seen)
        return;
    int *const found = search.best;
    if (tracker->tracks->symmetric &&
        chain_distance(tracker, frame, found, true) < chain_distance(tracker, frame, found, false))
        reverse(found, n_markers);
    memcpy(chosen, found, sizeof search.best);
}

/* Moves a marker that is not seen along with its seen neighbours. */
static void carry_along(struct tracker *tracker, const int *chosen, double (*moved)[3])
{
    const int n = tracker->specimen->n_markers;
    const double *const s = tracker->specimen->markers;
    for (int marker = 0; marker < n; marker++) {
        if (chosen[marker] >= 0)
            continue;
        int left = marker, right = marker;
        while (left >= 0 && chosen[left] < 0)
            left--;
        while (right < n && chosen[right] < 0)
            right++;
        tracker->unseen[marker] += left >= 0 && right < n   ? CARRIED_BY_TWO
                                   : left >= 0 || right < n ? CARRIED_BY_ONE
                                                            : 1.0;
        double part = left < 0 ? 1.0 : 0.0;
        if (left >= 0 && right < n)
            part = (s[marker] - s[left]) / (s[right] - s[left]);
        for (int k = 0; k < 3; k++) {
            const double from_left = left >= 0 ? moved[left][k] : 0.0;
            const double from_right = right < n ? moved[right][k] : 0.0;
            moved[marker][k] = (1.0 - part) * from_left + part * from_right;
        }
    }
}

static void update(struct tracker *tracker, size_t frame, const int *chosen)
{
    const double(*const points)[3] = points_of(tracker->cloud, frame);
    const int n = tracker->specimen->n_markers;
    double moved[WB_SPECIMEN_MAX_MARKERS][3] = {{0.0}};
    for (int marker = 0; marker < n; marker++) {
        for (int k = 0; k < 3 && chosen[marker] >= 0; k++)
            moved[marker][k] = points[chosen[marker]][k] - tracker->predicted[marker][k];
    }
    carry_along(tracker, chosen, moved);
    for (int marker = 0; marker < n; marker++) {
        for (int k = 0; k < 3; k++)
            tracker->predicted[marker][k] += moved[marker][k];
        if (chosen[marker] >= 0)
            tracker->unseen[marker] = 0.0;
        row_of(tracker->tracks, frame)[marker] =
            chosen[marker] >= 0
                ? (int32_t)(tracker->cloud->frames[frame].first + (size_t)chosen[marker])
                : -1;
    }
}

static void follow(struct tracker *tracker, size_t frame)
{
    int chosen[WB_SPECIMEN_MAX_MARKERS];
    assign_nearest(tracker, frame, chosen);
    drop_broken_links(tracker, frame, chosen);
    search_again(tracker, frame, chosen);
    update(tracker, frame, chosen);
}

/* --- the start --- */

static bool is_symmetric(const struct wb_specimen *specimen)
{
    const int n = specimen->n_markers;
    for (int i = 0; i < n; i++) {
        if (fabs(specimen->markers[i] + specimen->markers[n - 1 - i] - specimen->markers[n - 1]) >
            1.0 * WB_MM)
            return false;
    }
    return true;
}

/* The cheapest chain of at least `least` markers among the first START_FRAMES frames that have
 * one. */
static bool find_start(const struct tracker *tracker, int least, size_t *start, int *chosen)
{
    const struct wb_point_cloud *const cloud = tracker->cloud;
    double best = HUGE_VAL;
    int n_found = 0;
    const size_t stride = 1 + cloud->n_frames / LOOKED_AT;
    for (size_t frame = 0; frame < cloud->n_frames && n_found < START_FRAMES; frame += stride) {
        struct search search = search_in(tracker, frame, least, true);
        if (search.n < least || find_chain(&search) == 0)
            continue;
        n_found++;
        if (search.best_cost < best) {
            best = search.best_cost;
            *start = frame;
            memcpy(chosen, search.best, sizeof search.best);
        }
    }
    return n_found > 0;
}

static enum wb_status fail_without_start(const struct tracker *tracker, struct wb_reason *why)
{
    const struct wb_point_cloud *const cloud = tracker->cloud;
    int most = 0;
    for (size_t i = 0; i < cloud->n_frames; i++)
        most = cloud->frames[i].n > most ? cloud->frames[i].n : most;
    return wb_fail_to(
        why, WB_ERR_DATA,
        "markers not found: no frame of %zu shows at least %d of the %d markers, with the first "
        "and the last, at the distances of markers_mm (a frame has at most %d measured points)",
        cloud->n_frames, tracker->specimen->n_markers - 2, tracker->specimen->n_markers, most);
}

/* Predictions at the start; a marker missing there is placed between its neighbours. */
static void place(struct tracker *tracker, size_t start, const int *chosen)
{
    const double(*const points)[3] = points_of(tracker->cloud, start);
    const double *const s = tracker->specimen->markers;
    int left = 0;
    for (int marker = 0; marker < tracker->specimen->n_markers; marker++) {
        tracker->unseen[marker] = 0.0;
        if (chosen[marker] >= 0) {
            left = marker;
            memcpy(tracker->predicted[marker], points[chosen[marker]],
                   sizeof tracker->predicted[marker]);
            continue;
        }
        int right = marker;
        while (chosen[right] < 0)
            right++;
        const double part = (s[marker] - s[left]) / (s[right] - s[left]);
        for (int k = 0; k < 3; k++)
            tracker->predicted[marker][k] =
                (1.0 - part) * points[chosen[left]][k] + part * points[chosen[right]][k];
    }
}

static void count_results(struct tracker *tracker)
{
    struct wb_marker_tracks *const tracks = tracker->tracks;
    for (size_t frame = 0; frame < tracks->n_frames; frame++) {
        int seen = 0;
        for (int marker = 0; marker < tracks->n_markers; marker++)
            seen += row_of(tracks, frame)[marker] >= 0;
        tracks->n_missing += (size_t)(tracks->n_markers - seen);
        tracks->n_strays += (size_t)(tracker->cloud->frames[frame].n - seen);
    }
}

static enum wb_status track(struct tracker *tracker, struct wb_reason *why)
{
    const int n_markers = tracker->specimen->n_markers;
    int chosen[WB_SPECIMEN_MAX_MARKERS];
    size_t start = 0;
    bool found = false;
    for (int least = n_markers; !found && least >= n_markers - 2 && least >= 2; least--)
        found = find_start(tracker, least, &start, chosen);
    if (!found)
        return fail_without_start(tracker, why);
    tracker->tracks->start_frame = start;
    place(tracker, start, chosen);
    update(tracker, start, chosen);
    for (size_t frame = start + 1; frame < tracker->cloud->n_frames; frame++)
        follow(tracker, frame);
    place(tracker, start, chosen);
    for (size_t frame = start; frame-- > 0;)
        follow(tracker, frame);
    count_results(tracker);
    return WB_OK;
}

enum wb_status wb_markers_track(struct wb_marker_tracks *tracks, const struct wb_point_cloud *cloud,
                                const struct wb_specimen *specimen,
                                const struct wb_marker_settings *settings, struct wb_reason *why)
{
    memset(tracks, 0, sizeof *tracks);
    struct wb_marker_tracks made = {
        .cloud = cloud,
        .n_markers = specimen->n_markers,
        .n_frames = cloud->n_frames,
        .symmetric = is_symmetric(specimen),
    };
    struct tracker tracker = {
        .tracks = &made, .cloud = cloud, .specimen = specimen, .settings = *settings};
    struct wb_marker_settings *const s = &tracker.settings;
    s->noise = s->noise > 0.0 ? s->noise : DEFAULT_NOISE;
    s->frame_period = s->frame_period > 0.0 ? s->frame_period : DEFAULT_PERIOD;
    tracker.smallest_spacing = specimen->length;
    for (int i = 1; i < specimen->n_markers; i++)
        tracker.smallest_spacing =
            fmin(tracker.smallest_spacing, specimen->markers[i] - specimen->markers[i - 1]);
    made.index = wb_memory_new(cloud->n_frames * (size_t)specimen->n_markers, sizeof *made.index);
    const enum wb_status status = track(&tracker, why);
    if (status != WB_OK) {
        free(made.index);
        return status;
    }
    *tracks = made;
    return WB_OK;
}

void wb_marker_tracks_release(struct wb_marker_tracks *tracks)
{
    free(tracks->index);
    memset(tracks, 0, sizeof *tracks);
}

void wb_markers_reverse(struct wb_marker_tracks *tracks)
{
    for (size_t frame = 0; frame < tracks->n_frames; frame++)
        reverse(row_of(tracks, frame), tracks->n_markers);
}

const double *wb_markers_position(const struct wb_marker_tracks *tracks, size_t frame, int marker)
{
    const int32_t index = row_of(tracks, frame)[marker];
    return index >= 0 ? tracks->cloud->points[index] : NULL;
}
