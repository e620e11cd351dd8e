#include "fe/swept/swept_step.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fe/swept/swept_private.h"

#define WB_LOG_DOMAIN "swept"

/* Warns about passing wide vectors to functions, which does not happen because they are inlined. */
#pragma GCC diagnostic ignored "-Wpsabi"

#define ALWAYS_INLINE inline __attribute__((always_inline))

enum {
    LANES = WB_SWEPT_LANES,
    WIDE = 8 /* lanes of a vector of double */
};

typedef double wide __attribute__((vector_size(WIDE * sizeof(double)), may_alias));
typedef float narrow __attribute__((vector_size(WIDE * sizeof(float)), may_alias));

struct wb_swept_step {
    struct wb_swept_step_model model;
    double *node_mass, *inverse_node; /* (n_nodes) */
    double total;                     /* of the section, kg/m */
    double *length;  /* (stride) of a station, m; extra, inverse and weight follow it */
    double *extra;   /* (stride) added mass, kg */
    bool *held;      /* (3 stride) */
    double *inverse; /* (3 stride): 1 / scaled length, 1/m; 0: fixed or padding */
    double *weight;  /* (3 stride): acceleration by gravity, m/s2 */
    void (*advance)(const struct wb_swept_step *step, const struct wb_swept_step_fields *fields,
                    const double times[2], const int range[2], struct wb_swept_step_sums *sums);
};

/* Contribution of one component to the sums at a vector of stations. */
struct partial {
    wide both, half; /* sum m v- v+, sum m v+ v+ */
    wide before, after;
};

static ALWAYS_INLINE wide read_force(const void *force, size_t at, bool is_double)
{
    if (is_double)
        return *(const wide *)((const double *)force + at);
    return __builtin_convertvector(*(const narrow *)((const float *)force + at), wide);
}

/* The acceleration common to all nodes of a station: gravity, and the mean acceleration that
 * selective scaling does not reduce. */
static ALWAYS_INLINE wide common_acceleration(const struct wb_swept_step *step, const void *force,
                                              size_t at, bool is_double)
{
    const size_t stride = 3 * (size_t)step->model.layout.stride;
    const double part = (1.0 - 1.0 / step->model.selective) / step->total;
    const wide weight = *(const wide *)(step->weight + at);
    wide sum = {0.0};

    if (part == 0.0)
        return weight;
    for (int k = 0; k < step->model.layout.n_nodes; k++)
        sum += read_force(force, (size_t)k * stride + at, is_double);
    return weight + part * sum * *(const wide *)(step->inverse + at);
}

/* v.M'v = beta v.M v - (beta - 1) (sum m v)^2 / sum m, per station; `at` is the first's index. */
static void add_sums(const struct wb_swept_step *step, const struct partial *p, size_t at,
                     double dt, struct wb_swept_step_sums *sums)
{
    const double beta = step->model.selective, mean = (beta - 1.0) / step->total;
    const size_t c = at / (size_t)step->model.layout.stride;

    for (int l = 0; l < WIDE; l++) {
        if (step->inverse[at + (size_t)l] == 0.0)
            continue;
        const double scaled = 1.0 / step->inverse[at + (size_t)l];
        sums->kinetic += 0.5 * scaled * (beta * p->both[l] - mean * p->before[l] * p->after[l]);
        sums->kinetic_half += 0.5 * scaled * (beta * p->half[l] - mean * p->after[l] * p->after[l]);
        sums->momentum[c] += scaled * p->after[l];
        sums->gravity_work += scaled * step->weight[at + (size_t)l] * p->after[l] * dt;
    }
}

static ALWAYS_INLINE void advance(const struct wb_swept_step *step,
                                  const struct wb_swept_step_fields *fields, const double times[2],
                                  const int range[2], bool is_double,
                                  struct wb_swept_step_sums *sums)
{
    const size_t stride = (size_t)step->model.layout.stride;
    const double own = 1.0 / step->model.selective, dv = times[0], dx = times[1];

    for (size_t j = (size_t)range[0] * LANES; j < (size_t)range[1] * LANES; j += WIDE) {
        for (size_t c = 0; c < 3; c++) {
            const size_t station = c * stride + j;
            const wide inverse = own * *(const wide *)(step->inverse + station);
            const wide common = common_acceleration(step, fields->force, station, is_double);
            struct partial partial = {{0.0}};
            for (int k = 0; k < step->model.layout.n_nodes; k++) {
                const size_t at = 3 * (size_t)k * stride + station;
                wide *v = (wide *)(fields->velocity + at), *x = (wide *)(fields->position + at);
                const wide f = read_force(fields->force, at, is_double);
                const wide before = *v;
                const wide after = before + dv * (step->inverse_node[k] * f * inverse + common);
                *v = after;
                *x += dx * after;
                if (sums) {
                    const wide momentum = step->node_mass[k] * after;
                    partial.both += before * momentum;
                    partial.half += after * momentum;
                    partial.before += step->node_mass[k] * before;
                    partial.after += momentum;
                }
            }
            if (sums)
                add_sums(step, &partial, station, dx, sums);
        }
    }
}

/* Inlined with compile-time constants. */
static ALWAYS_INLINE void advance_any(const struct wb_swept_step *step,
                                      const struct wb_swept_step_fields *fields,
                                      const double times[2], const int range[2],
                                      struct wb_swept_step_sums *sums)
{
    if (step->model.double_precision)
        advance(step, fields, times, range, true, sums);
    else if (sums)
        advance(step, fields, times, range, false, sums);
    else
        advance(step, fields, times, range, false, NULL);
}

static void advance_portably(const struct wb_swept_step *step,
                             const struct wb_swept_step_fields *fields, const double times[2],
                             const int range[2], struct wb_swept_step_sums *sums)
{
    advance_any(step, fields, times, range, sums);
}

#ifdef __x86_64__
__attribute__((target("avx2"))) static void advance_avx2(const struct wb_swept_step *step,
                                                         const struct wb_swept_step_fields *fields,
                                                         const double times[2], const int range[2],
                                                         struct wb_swept_step_sums *sums)
{
    advance_any(step, fields, times, range, sums);
}

__attribute__((target("avx512f,avx512dq,avx512vl"))) static void
advance_avx512(const struct wb_swept_step *step, const struct wb_swept_step_fields *fields,
               const double times[2], const int range[2], struct wb_swept_step_sums *sums)
{
    advance_any(step, fields, times, range, sums);
}
#endif

static void choose_way(struct wb_swept_step *step)
{
    step->advance = advance_portably;
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2"))
        step->advance = advance_avx2;
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl"))
        step->advance = advance_avx512;
#endif
}

void wb_swept_step_update(const struct wb_swept_step *step,
                          const struct wb_swept_step_fields *fields, const double times[2],
                          int first, int end, struct wb_swept_step_sums *sums)
{
    const int range[2] = {first, end};

    step->advance(step, fields, times, range, sums);
}

/* Updates the values of a station from its length, extra mass and fixed components. */
static void refresh(struct wb_swept_step *step, int station)
{
    const struct wb_swept_step_model *m = &step->model;
    const double extra = step->extra[station] / step->total;
    const double scaled = step->length[station] * m->mass_scaling + extra;

    for (int c = 0; c < 3; c++) {
        const size_t at = (size_t)(c * m->layout.stride + station);
        const bool held = step->held[at];
        step->inverse[at] = held ? 0.0 : 1.0 / scaled;
        step->weight[at] = held ? 0.0 : m->gravity[c] * (step->length[station] + extra) / scaled;
    }
}

void wb_swept_step_add_mass(struct wb_swept_step *step, int station, double mass)
{
    step->extra[station] += mass;
    refresh(step, station);
}

void wb_swept_step_hold(struct wb_swept_step *step, int station, int component, bool held)
{
    step->held[component * step->model.layout.stride + station] = held;
    refresh(step, station);
}

double wb_swept_step_station_mass(const struct wb_swept_step *step, int station)
{
    return step->total * step->length[station] * step->model.mass_scaling + step->extra[station];
}

enum wb_status wb_swept_step_check_masses(int n, const double *node_mass, double selective)
{
    if (!(selective >= 1.0 && isfinite(selective)))
        return wb_fail(WB_ERR_ARGUMENT, "selective mass scaling %g: expected 1 or more", selective);
    for (int k = 0; k < n; k++) {
        if (!wb_swept_is_positive(node_mass[k]))
            return wb_fail(WB_ERR_ARGUMENT,
                           "node %d has a mass of %g kg/m: expected a number above 0", k,
                           node_mass[k]);
    }
    return WB_OK;
}

static enum wb_status check(const struct wb_swept_step_model *m)
{
    if (m->layout.n_nodes < 1 || m->layout.n_stations < 2 ||
        m->layout.stride != wb_swept_layout(m->layout.n_nodes, m->layout.n_stations).stride)
        return wb_fail(WB_ERR_ARGUMENT,
                       "the body has %d nodes, %d stations and a stride of %d: expected at least 1 "
                       "node, at least 2 stations and the stride that belongs to them",
                       m->layout.n_nodes, m->layout.n_stations, m->layout.stride);
    if (!wb_swept_is_positive(m->spacing))
        return wb_fail(WB_ERR_ARGUMENT, "station spacing %g m: expected a number above 0",
                       m->spacing);
    if (!wb_swept_is_positive(m->mass_scaling))
        return wb_fail(WB_ERR_ARGUMENT, "mass scaling %g: expected a number above 0",
                       m->mass_scaling);
    return wb_swept_step_check_masses(m->layout.n_nodes, m->node_mass, m->selective);
}

static void allocate(struct wb_swept_step *step)
{
    const size_t n = (size_t)step->model.layout.n_nodes;
    const size_t stride = (size_t)step->model.layout.stride;

    step->node_mass = wb_memory_new(2 * n, sizeof *step->node_mass);
    step->held = wb_memory_new(3 * stride, sizeof *step->held);
    step->length = wb_swept_allocate(8 * stride, sizeof *step->length);
    step->inverse_node = step->node_mass + n;
    step->extra = step->length + stride;
    step->inverse = step->extra + stride;
    step->weight = step->inverse + 3 * stride;
}

enum wb_status wb_swept_step_create(struct wb_swept_step **out,
                                    const struct wb_swept_step_model *model)
{
    struct wb_swept_step_model m = *model;

    *out = NULL;
    m.mass_scaling = m.mass_scaling == 0.0 ? 1.0 : m.mass_scaling;
    m.selective = m.selective == 0.0 ? 1.0 : m.selective;
    WB_TRY(check(&m));
    struct wb_swept_step *const step = wb_memory_new(1, sizeof *step);
    step->model = m;
    allocate(step);
    step->model.node_mass = step->node_mass;
    for (int k = 0; k < m.layout.n_nodes; k++) {
        step->node_mass[k] = model->node_mass[k];
        step->inverse_node[k] = 1.0 / model->node_mass[k];
        step->total += model->node_mass[k];
    }
    for (int j = 0; j < m.layout.n_stations; j++) {
        const bool is_end = j == 0 || j == m.layout.n_stations - 1;
        step->length[j] = (is_end ? 0.5 : 1.0) * m.spacing;
        refresh(step, j);
    }
    choose_way(step);
    *out = step;
    return WB_OK;
}

void wb_swept_step_destroy(struct wb_swept_step *step)
{
    if (!step)
        return;
    free(step->node_mass);
    free(step->length);
    free(step->held);
    free(step);
}
