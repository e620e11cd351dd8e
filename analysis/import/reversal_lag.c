#include "analysis/import/reversal_lag.h"

#include <math.h>

#include "analysis/dataset/least_squares.h"
#include "base/memory.h"

/* Windows on each side: s, or the time in which the signal moves by this number of standard
 * deviations of its noise; at most these parts of a branch and of a rest. */
#define MOTION_WINDOW 6.0
#define FORCE_WINDOW 3.0
#define WINDOW_NOISES 25.0
#define WINDOW_PART 0.4
#define REST_PART 0.9
#define SHORTER 0.6
/* s of the force left out before the turn, and delays of the filter left out after it. */
#define GUARD 0.05
#define FILTER_TIMES 3.0
/* Fewest samples of each signal on each side. */
#define LEAST 12
#define MOST_ITERATIONS 100
#define MOST_LAG 2.5 /* s: largest change of the lag; beyond, the search has diverged */
#define TIMES 10.0   /* free parameters are in units of 0.1 s */
/* Number of lengths of the rest that are tried, their spacing in s, and the smallest probability,
 * relative to the best one, of lengths that are used. */
#define N_RESTS 51
#define REST_STEP 0.02
#define LEAST_WEIGHT 0.01
/* s: longest rest of a reversal directly to the next branch */
#define LONG_REST 0.7

enum {
    P_REST_BEGINS,
    P_HEIGHT,
    P_SPEED_THERE,
    P_SPEED_BACK,
    N_MOTION,
    P_LAG = N_MOTION,
    P_FORCE,
    P_RISE,
    P_RISE_BENT,
    P_FALL,
    P_FALL_BENT,
    N_ALL
};

/* The samples of one signal in the window, the turn, and the signal's value there. */
struct part {
    const struct wb_signal *signal;
    size_t first, last;           /* last is one past the end */
    double skip_from, skip_until; /* s: range that is left out */
    double zero, scale;           /* of the values: scaled values have a noise of 1 */
};

struct problem {
    double turn, rest; /* s */
    struct part motion, force;
    bool with_force;
    enum wb_status status;
};

/* Length of the window between the turn and the other end of the branch, s. */
static double window_of(const struct wb_signal *signal, double at, double end, double least,
                        double most)
{
    const size_t a = wb_signal_index(signal, fmin(at, end)),
                 b = wb_signal_index(signal, fmax(at, end));
    const double way = b < signal->n ? fabs(signal->x[b] - signal->x[a]) : 0.0;
    const double needed =
        way > 0.0 ? WINDOW_NOISES * wb_signal_noise(signal) * fabs(end - at) / way : 0.0;
    return fmin(fmax(least, needed), most);
}

/* The part of a signal around a turn, in `window` of the full windows. */
static struct part take_part(const struct wb_signal *signal, const struct wb_reversal *reversal,
                             double window, double least)
{
    const double at = reversal->at, from = reversal->from, until = reversal->until;
    const enum wb_turn turn = reversal->turn;
    const double there = (turn == WB_TURN_FROM_REST ? REST_PART : WINDOW_PART) * (at - from);
    const double back = (turn == WB_TURN_TO_REST ? REST_PART : WINDOW_PART) * (until - at);
    const size_t middle = wb_signal_index(signal, at);
    struct part part = {
        .signal = signal,
        .first = wb_signal_index(signal, at - window * window_of(signal, at, from, least, there)),
        .last = wb_signal_index(signal, at + window * window_of(signal, at, until, least, back)),
        .skip_from = at,
        .skip_until = at,
        .scale = wb_signal_noise(signal),
    };
    part.zero = signal->n > 0 ? signal->x[middle < signal->n ? middle : signal->n - 1] : 0.0;
    return part;
}

static bool is_left_out(const struct part *part, double t)
{
    return t > part->skip_from && t < part->skip_until;
}

/* Whether both sides have enough samples. */
static bool is_enough(const struct part *part)
{
    size_t before = 0, behind = 0;
    for (size_t i = part->first; i < part->last; i++) {
        before += part->signal->t[i] <= part->skip_from;
        behind += part->signal->t[i] >= part->skip_until;
    }
    return part->scale > 0.0 && before >= LEAST && behind >= LEAST;
}

/* Times are free parameters in tenths of a second, so that all parameters are of similar size. */
static double seconds_of(double free_number)
{
    return free_number / TIMES;
}

static double seconds(const gsl_vector *x, int index)
{
    return seconds_of(gsl_vector_get(x, (size_t)index));
}

static int residuals(const gsl_vector *x, void *context, gsl_vector *f)
{
    const struct problem *const p = context;
    const double begins = p->turn + seconds(x, P_REST_BEGINS), ends = begins + p->rest;
    size_t row = 0;
    for (size_t i = p->motion.first; i < p->motion.last; i++) {
        const double t = p->motion.signal->t[i];
        const double model = gsl_vector_get(x, P_HEIGHT) +
                             gsl_vector_get(x, P_SPEED_THERE) * fmin(0.0, t - begins) +
                             gsl_vector_get(x, P_SPEED_BACK) * fmax(0.0, t - ends);
        gsl_vector_set(f, row++,
                       (p->motion.signal->x[i] - p->motion.zero) / p->motion.scale - model);
    }
    const double lag = p->with_force ? seconds(x, P_LAG) : 0.0;
    for (size_t i = p->force.first; p->with_force && i < p->force.last; i++) {
        const double t = p->force.signal->t[i];
        const double there = fmin(0.0, t - begins - lag), back = fmax(0.0, t - ends - lag);
        const double model = gsl_vector_get(x, P_FORCE) + gsl_vector_get(x, P_RISE) * there +
                             gsl_vector_get(x, P_RISE_BENT) * there * there +
                             gsl_vector_get(x, P_FALL) * back +
                             gsl_vector_get(x, P_FALL_BENT) * back * back;
        const double residual = (p->force.signal->x[i] - p->force.zero) / p->force.scale - model;
        gsl_vector_set(f, row++, is_left_out(&p->force, t) ? 0.0 : residual);
    }
    return GSL_SUCCESS;
}

static size_t count(const struct problem *p)
{
    return p->motion.last - p->motion.first + (p->with_force ? p->force.last - p->force.first : 0);
}

/* Minimises the sum of squares, starting from the given free parameters; `deviations` receives
 * standard deviations (may be NULL). */
static bool solve(struct problem *p, double free_numbers[N_ALL], double *deviations,
                  double *squares)
{
    const size_t n_free = p->with_force ? N_ALL : N_MOTION, n = count(p);
    gsl_multifit_nlinear_workspace *const w = wb_least_squares_create((int)n, (int)n_free);
    gsl_matrix *const covariance = wb_memory_need(gsl_matrix_alloc(n_free, n_free));
    gsl_multifit_nlinear_fdf fdf = {.f = residuals, .n = n, .p = n_free, .params = p};
    const gsl_vector_const_view start = gsl_vector_const_view_array(free_numbers, n_free);
    const struct wb_least_squares_search search = {.max_iterations = MOST_ITERATIONS,
                                                   .smallest_step = 1e-5,
                                                   .smallest_gain = 1e-10,
                                                   .patience = 2,
                                                   .status = &p->status};
    *squares = 0.0;
    const bool found =
        gsl_multifit_nlinear_init(&start.vector, &fdf, w) == GSL_SUCCESS &&
        wb_least_squares_iterate(w, &search, NULL) &&
        gsl_multifit_nlinear_covar(gsl_multifit_nlinear_jac(w), 0.0, covariance) == GSL_SUCCESS;
    for (size_t i = 0; i < n; i++)
        *squares += pow(gsl_vector_get(gsl_multifit_nlinear_residual(w), i), 2);
    const double enlarged = fmax(1.0, *squares / (double)(n - n_free));
    for (size_t i = 0; found && i < n_free; i++) {
        free_numbers[i] = gsl_vector_get(gsl_multifit_nlinear_position(w), i);
        if (deviations)
            deviations[i] = sqrt(enlarged * gsl_matrix_get(covariance, i, i));
    }
    gsl_multifit_nlinear_free(w);
    gsl_matrix_free(covariance);
    return found;
}

/* Probability of each length of the rest from the motion alone, relative to the most probable one,
 * and the end of the first branch for it, in s after the turn. */
struct rests {
    double weight[N_RESTS], begins[N_RESTS];
};

static double rest_of(int index)
{
    return REST_STEP * index;
}

static bool find_rests(struct problem *p, int n_rests, struct rests *rests)
{
    double squares[N_RESTS], least = HUGE_VAL;
    for (int i = 0; i < n_rests; i++) {
        double x[N_ALL] = {0.0};
        p->rest = rest_of(i);
        x[P_SPEED_THERE] = 1e-3 / p->motion.scale;
        x[P_SPEED_BACK] = -x[P_SPEED_THERE];
        if (!solve(p, x, NULL, &squares[i]))
            squares[i] = HUGE_VAL;
        rests->begins[i] = seconds_of(x[P_REST_BEGINS]);
        least = fmin(least, squares[i]);
    }
    for (int i = 0; i < n_rests; i++)
        rests->weight[i] = exp(-0.5 * (squares[i] - least));
    return isfinite(least);
}

/* The lag for one length of the rest. */
static bool find_with_rest(struct problem *p, int index, const struct rests *rests,
                           double filter_delay, struct wb_reversal_lag *result)
{
    double x[N_ALL] = {0.0}, deviations[N_ALL], squares;
    const double begins = p->turn + rests->begins[index];
    p->rest = rest_of(index);
    p->force.skip_from = begins - GUARD;
    p->force.skip_until = begins + p->rest + GUARD + FILTER_TIMES * filter_delay;
    x[P_REST_BEGINS] = TIMES * rests->begins[index];
    x[P_SPEED_THERE] = 1e-3 / p->motion.scale;
    x[P_SPEED_BACK] = -x[P_SPEED_THERE];
    if (!is_enough(&p->force) || !solve(p, x, deviations, &squares))
        return false;
    result->lag = seconds_of(x[P_LAG]);
    result->uncertainty = seconds_of(deviations[P_LAG]);
    return fabs(result->lag) < MOST_LAG && result->uncertainty < MOST_LAG;
}

/* Fits both signals with windows of this part of the full ones: the mean over all lengths of the
 * rest, weighted by their probability. */
static bool find_with(struct wb_reversal_lag *result, const struct wb_signal *motion,
                      const struct wb_signal *force, const struct wb_reversal *reversal,
                      double filter_delay, double window)
{
    const int n_rests = reversal->turn == WB_TURN_BACK ? N_RESTS : 1;
    struct problem p = {
        .turn = reversal->at,
        .motion = take_part(motion, reversal, window, MOTION_WINDOW),
        .force = take_part(force, reversal, window, FORCE_WINDOW),
        .status = WB_OK,
    };
    struct rests rests;
    double weights = 0.0, lag = 0.0, squares = 0.0;
    if (!is_enough(&p.motion) || !find_rests(&p, n_rests, &rests))
        return false;
    p.with_force = true;
    for (int i = 0; i < n_rests; i++) {
        struct wb_reversal_lag one;
        if (rests.weight[i] < LEAST_WEIGHT || !find_with_rest(&p, i, &rests, filter_delay, &one))
            continue;
        weights += rests.weight[i];
        lag += rests.weight[i] * one.lag;
        squares += rests.weight[i] * (one.lag * one.lag + one.uncertainty * one.uncertainty);
    }
    if (!(weights > 0.0))
        return false;
    result->lag = lag / weights;
    result->uncertainty = sqrt(squares / weights - result->lag * result->lag);
    return true;
}

int wb_reversal_list(struct wb_reversal reversals[2], double from, double arrival, double departure,
                     double until)
{
    reversals[0] = (struct wb_reversal){from, arrival, until, WB_TURN_BACK};
    if (!(departure - arrival > LONG_REST))
        return 1;
    /* The force may decrease during a long rest, as a wire relaxes. */
    reversals[0] = (struct wb_reversal){from, arrival, departure, WB_TURN_TO_REST};
    reversals[1] = (struct wb_reversal){arrival, departure, until, WB_TURN_FROM_REST};
    return 2;
}

bool wb_reversal_lag_find(struct wb_reversal_lag *result, const struct wb_signal *motion,
                          const struct wb_signal *force, const struct wb_reversal *reversal,
                          double filter_delay)
{
    struct wb_reversal_lag shorter;
    if (!find_with(result, motion, force, reversal, filter_delay, 1.0) ||
        !find_with(&shorter, motion, force, reversal, filter_delay, SHORTER))
        return false;
    /* A shorter window also has more noise; the difference that this explains is not an error of
     * the model. */
    const double noise = sqrt(fmax(0.0, shorter.uncertainty * shorter.uncertainty -
                                            result->uncertainty * result->uncertainty));
    const double moved = fabs(shorter.lag - result->lag);
    result->uncertainty = hypot(result->uncertainty, fmax(0.0, moved - noise));
    return true;
}

void wb_reversal_mean_add(struct wb_reversal_mean *mean, double lag, double uncertainty)
{
    const double weight = 1.0 / (uncertainty * uncertainty);
    mean->n++;
    mean->weights += weight;
    mean->sum += weight * lag;
    mean->squares += weight * lag * lag;
}

void wb_reversal_mean_find(const struct wb_reversal_mean *mean, double *lag, double *uncertainty)
{
    *lag = mean->sum / mean->weights;
    const double chi = fmax(0.0, mean->squares - mean->weights * *lag * *lag);
    const double enlarged = mean->n > 1 ? fmax(1.0, chi / (mean->n - 1)) : 1.0;
    *uncertainty = sqrt(enlarged / mean->weights);
}
