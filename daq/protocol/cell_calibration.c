#include "daq/protocol/cell_calibration.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/number.h"
#include "base/units.h"
#include "daq/protocol/average.h"

/* kg; masses with a smaller difference count as equal. */
#define SAME (1e-3 * WB_MG)

struct wb_cell_deviation wb_cell_calibration_deviation(const struct wb_cell_point *zero,
                                                       const struct wb_cell_point *point,
                                                       double gravity)
{
    struct wb_cell_deviation result;
    result.mass = (point->reading - zero->reading) / gravity;
    result.deviation = result.mass - point->mass;
    result.relative = point->mass > 0.0 ? result.deviation / point->mass : (double)NAN;
    result.uncertainty =
        point == zero ? 0.0 : hypot(point->uncertainty, zero->uncertainty) / gravity;
    return result;
}

const char *wb_cell_calibration_name(enum wb_cell_quantity quantity)
{
    static const char *const names[WB_CELL_QUANTITIES] = {"span", "linearity", "hysteresis",
                                                          "repeatability", "zero return"};
    return names[quantity];
}

bool wb_cell_calibration_check(const double *masses, int n, char *problem, size_t size)
{
    double first = 0.0;
    bool differ = false;
    for (int i = 0; i < n; i++) {
        if (!(masses[i] >= 0.0)) {
            snprintf(problem, size, "expected masses of at least 0 g, not %g", masses[i] / WB_G);
            return false;
        }
        if (masses[i] > SAME && first > 0.0 && fabs(masses[i] - first) > SAME)
            differ = true;
        if (masses[i] > SAME && !(first > 0.0))
            first = masses[i];
    }
    if (n > WB_RIG_MASSES)
        snprintf(problem, size, "expected at most %d masses, not %d", WB_RIG_MASSES, n);
    else if (n < 1 || masses[0] > SAME)
        snprintf(problem, size, "expected 0 first, the cell's zero, such as 0,5,10,5,0");
    else if (!differ)
        snprintf(problem, size,
                 "expected at least two different masses besides 0, such as 0,5,10,5,0");
    else
        return true;
    return false;
}

int wb_cell_calibration_parse(const char *text, double masses[WB_RIG_MASSES], char *problem,
                              size_t size)
{
    int n = 0;
    for (const char *at = text; at;) {
        char field[48];
        double grams;
        const size_t length = strcspn(at, ",");
        if (n == WB_RIG_MASSES) {
            snprintf(problem, size, "expected at most %d masses", WB_RIG_MASSES);
            return 0;
        }
        snprintf(field, sizeof field, "%.*s", (int)length, at);
        if (length >= sizeof field || !wb_number_parse(field, &grams)) {
            snprintf(problem, size, "expected masses in grams separated by commas, not '%s'",
                     field);
            return 0;
        }
        masses[n++] = grams * WB_G;
        at = at[length] ? at + length + 1 : NULL;
    }
    return wb_cell_calibration_check(masses, n, problem, size) ? n : 0;
}

/* Fits the line through all points, and computes the residuals. */
static void fit_line(struct wb_cell_calibration *c, const struct wb_cell_point *points, int n,
                     double gravity)
{
    double mean_x = 0.0, mean_y = 0.0, xx = 0.0, xy = 0.0, squares = 0.0;
    double low = points[0].mass, high = points[0].mass;
    for (int i = 0; i < n; i++) {
        mean_x += points[i].mass / n;
        mean_y += points[i].reading / gravity / n;
        low = fmin(low, points[i].mass);
        high = fmax(high, points[i].mass);
    }
    for (int i = 0; i < n; i++) {
        xx += pow(points[i].mass - mean_x, 2);
        xy += (points[i].mass - mean_x) * (points[i].reading / gravity - mean_y);
    }
    c->slope = xy / xx;
    c->offset = mean_y - c->slope * mean_x;
    c->span = high - low;
    for (int i = 0; i < n; i++) {
        c->residuals[i] = points[i].reading / gravity - c->offset - c->slope * points[i].mass;
        c->is_down[i] = i > 0 && points[i].mass < points[i - 1].mass - SAME;
        squares += c->residuals[i] * c->residuals[i];
    }
    /* With at least three different masses, n - 2 is positive. */
    c->scatter = sqrt(squares / (n - 2));
    c->results[WB_CELL_SPAN] = (struct wb_cell_result){
        .known = true,
        .value = c->slope - 1.0,
        .uncertainty = c->scatter / sqrt(xx),
        .at = (double)NAN,
    };
}

static void find_linearity(struct wb_cell_calibration *c, const struct wb_cell_point *points, int n,
                           double gravity)
{
    int worst = 0;
    for (int i = 1; i < n; i++) {
        if (fabs(c->residuals[i]) > fabs(c->residuals[worst]))
            worst = i;
    }
    c->results[WB_CELL_LINEARITY] = (struct wb_cell_result){
        .known = true,
        .value = c->residuals[worst] / c->span,
        .uncertainty = points[worst].uncertainty / gravity / c->span,
        .at = points[worst].mass,
    };
}

/* Readings (kg) of one mass that was reached from one side. */
struct side {
    struct wb_average readings;
    double squares; /* sum of the squares of their standard uncertainties */
};

static struct side gather(const struct wb_cell_calibration *c, const struct wb_cell_point *points,
                          int n, double gravity, double mass, bool down)
{
    struct side side = {0};
    /* The first point has no side. At 0 it counts as loading, which has no other point there, so
     * that the zeros before and after can be compared. */
    for (int i = 0; i < n; i++) {
        if (fabs(points[i].mass - mass) > SAME || c->is_down[i] != down)
            continue;
        wb_average_add(&side.readings, points[i].reading / gravity);
        side.squares += pow(points[i].uncertainty / gravity, 2);
    }
    return side;
}

static double error_of(const struct side *side)
{
    return sqrt(side->squares) / (double)side->readings.n;
}

static bool is_first_of_its_mass(const struct wb_cell_point *points, int i)
{
    for (int k = 0; k < i; k++) {
        if (fabs(points[k].mass - points[i].mass) <= SAME)
            return false;
    }
    return true;
}

/* Hysteresis and repeatability, by mass and side. The zero is covered by the zero return. */
static void find_returns(struct wb_cell_calibration *c, const struct wb_cell_point *points, int n,
                         double gravity)
{
    struct wb_cell_result hysteresis = {.at = (double)NAN}, repeat = {.at = (double)NAN};
    double squares = 0.0;
    int64_t freedom = 0;
    for (int i = 0; i < n; i++) {
        if (!is_first_of_its_mass(points, i))
            continue;
        const double mass = points[i].mass;
        const struct side up = gather(c, points, n, gravity, mass, false);
        const struct side down = gather(c, points, n, gravity, mass, true);
        const double difference = (down.readings.mean - up.readings.mean) / c->span;
        squares += up.readings.squares + down.readings.squares;
        freedom += (up.readings.n > 0 ? up.readings.n - 1 : 0) +
                   (down.readings.n > 0 ? down.readings.n - 1 : 0);
        if (mass <= SAME || up.readings.n == 0 || down.readings.n == 0)
            continue;
        if (!hysteresis.known || fabs(difference) > fabs(hysteresis.value)) {
            hysteresis = (struct wb_cell_result){
                .known = true,
                .value = difference,
                .uncertainty = hypot(error_of(&up), error_of(&down)) / c->span,
                .at = mass,
            };
        }
    }
    if (freedom > 0) {
        repeat.known = true;
        repeat.value = sqrt(squares / (double)freedom) / c->span;
        repeat.uncertainty = repeat.value / sqrt(2.0 * (double)freedom);
    }
    c->results[WB_CELL_HYSTERESIS] = hysteresis;
    c->results[WB_CELL_REPEATABILITY] = repeat;
}

static void find_zero_return(struct wb_cell_calibration *c, const struct wb_cell_point *points,
                             int n, double gravity)
{
    struct wb_cell_result *const result = &c->results[WB_CELL_ZERO_RETURN];
    int last = 0;
    *result = (struct wb_cell_result){.at = (double)NAN};
    for (int i = 1; i < n; i++) {
        if (points[i].mass <= SAME)
            last = i;
    }
    if (last == 0)
        return;
    const struct wb_cell_deviation zero =
        wb_cell_calibration_deviation(&points[0], &points[last], gravity);
    result->known = true;
    result->value = zero.deviation / c->span;
    result->uncertainty = zero.uncertainty / c->span;
    result->at = 0.0;
}

void wb_cell_calibration_compute(struct wb_cell_calibration *calibration,
                                 const struct wb_cell_point *points, int n, double gravity,
                                 double tolerance)
{
    struct wb_cell_calibration *const c = calibration;
    fit_line(c, points, n, gravity);
    find_linearity(c, points, n, gravity);
    find_returns(c, points, n, gravity);
    find_zero_return(c, points, n, gravity);
    c->passed = true;
    for (int i = 0; i < WB_CELL_QUANTITIES; i++) {
        struct wb_cell_result *const result = &c->results[i];
        result->passed = result->known && fabs(result->value) <= tolerance;
        if (result->known && !result->passed)
            c->passed = false;
    }
}
