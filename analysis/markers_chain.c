/* The best chain of points: which of a frame's points are our markers, in order along the wire. */
#include <math.h>
#include <string.h>

#include "analysis/markers_private.h"
#include "base/units.h"

/* What a chain may cost: a missing marker costs as much as a link at three tolerances. */
#define MISSING_COST 9.0
#define LARGEST_LINK_COST 16.0
/* Two links in a row turn by less than this (60 degrees). */
#define LEAST_COSINE 0.5
/* A hostile cloud must not take forever. */
#define MOST_VISITS 20000
/* Markers sit on the wire to this, m, whatever the cameras resolve. */
#define PLACEMENT (0.3 * WB_MM)
/* A bent wire's chord is shorter than its arc, by at most this part (and by what the marker's
 * offset towards the inside of the bend takes, PLACEMENT's order). */
#define CHORD_SHORTFALL 0.03

double wb_markers_distance(const double *a, const double *b)
{
    const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return sqrt(x * x + y * y + z * z);
}

double wb_markers_link_cost(const struct wb_specimen *specimen, double noise, int i, int j,
                            const double *a, const double *b)
{
    const double arc = specimen->markers[j] - specimen->markers[i];
    const double error = wb_markers_distance(a, b) - arc;
    double tolerance = sqrt(2.0 * (noise * noise + PLACEMENT * PLACEMENT));
    if (error < 0.0)
        tolerance += CHORD_SHORTFALL * arc;
    return error * error / (tolerance * tolerance);
}

struct search {
    const double (*points)[3];
    int n;
    const struct wb_specimen *specimen;
    double noise;
    int least;
    bool need_ends;
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

/* Bend between the links to the two markers last chosen; 1 is straight on. */
static double cosine(const struct search *search, int second_last, int last, int point)
{
    const double *const a = search->points[second_last];
    const double *const b = search->points[last];
    const double *const c = search->points[point];
    double dot = 0.0;
    for (int k = 0; k < 3; k++)
        dot += (b[k] - a[k]) * (c[k] - b[k]);
    const double lengths = wb_markers_distance(a, b) * wb_markers_distance(b, c);
    return lengths > 0.0 ? dot / lengths : -1.0;
}

/* The last two markers that have a point, before `marker`; -1 when there is none. */
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
            link = wb_markers_link_cost(search->specimen, search->noise, last, marker,
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

int wb_markers_find_chain(const struct wb_markers_search *wanted, int *chosen, double *cost)
{
    struct search search = {
        .points = wanted->points,
        .n = wanted->n,
        .specimen = wanted->specimen,
        .noise = wanted->noise,
        .least = wanted->least > 2 ? wanted->least : 2,
        .need_ends = wanted->need_ends,
        .best_cost = HUGE_VAL,
    };
    if (search.n >= search.least)
        extend(&search, 0, 0, 0.0);
    if (search.best_length > 0) {
        memcpy(chosen, search.best, (size_t)search.specimen->n_markers * sizeof *chosen);
        *cost = search.best_cost;
    }
    return search.best_length;
}

int wb_markers_chain(const double (*points)[3], int n, const struct wb_specimen *specimen,
                     double noise, int least, int *chosen)
{
    const struct wb_markers_search wanted = {points, n, specimen, noise, least, false};
    double cost;
    return wb_markers_find_chain(&wanted, chosen, &cost);
}
