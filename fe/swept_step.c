#include "fe/swept_step.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WB_LOG_DOMAIN "swept"

#define ALWAYS_INLINE inline __attribute__((always_inline))

enum {
    LANES = WB_SWEPT_LANES
};

struct wb_swept_step {
    struct wb_swept_step_model model;
    double *node_mass, *inverse_node; /* (n_nodes) */
    double total;                     /* kg/m, of the section */
    double *length;                   /* (stride) of a station, m */
    double *extra;                    /* (stride) mass added, kg */
    bool *held;                       /* (3 stride) */
    double *inverse;                  /* (3 stride): 1 / scaled length, 1/m; 0: held or padding */
    double *weight;                   /* (3 stride): acceleration by gravity, m/s2 */
    void (*advance)(const struct wb_swept_step *step, const struct wb_swept_step_fields *fields,
                    const double times[2], int first, int end, struct wb_swept_step_sums *sums);
};

/* What one component of a block of stations adds to the sums. */
struct block_sums {
    double both[LANES], half[LANES]; /* sum m v- v+, sum m v+ v+ */
    double before[LANES], after[LANES], work[LANES];
};

static ALWAYS_INLINE void read_force(const struct wb_swept_step *step, const void *force, size_t at,
                                     double out[LANES])
{
    if (step->model.double_precision) {
        const double *from = (const double *)force + at;
        for (int l = 0; l < LANES; l++)
            out[l] = from[l];
    } else {
        const float *from = (const float *)force + at;
        for (int l = 0; l < LANES; l++)
            out[l] = (double)from[l];
    }
}

/* What all nodes of a station have in common: the weight, and the part of the mean acceleration
 * that selective scaling leaves. */
static ALWAYS_INLINE void common_acceleration(const struct wb_swept_step *step, const void *force,
                                              int c, int j, double out[LANES])
{
    const size_t stride = (size_t)step->model.layout.stride, at = (size_t)c * stride + (size_t)j;
    const double part = (1.0 - 1.0 / step->model.selective) / step->total;
    double sum[LANES] = {0.0};

    for (int k = 0; part > 0.0 && k < step->model.layout.n_nodes; k++) {
        double f[LANES];
        read_force(step, force, 3 * (size_t)k * stride + at, f);
        for (int l = 0; l < LANES; l++)
            sum[l] += f[l];
    }
    for (int l = 0; l < LANES; l++)
        out[l] = step->weight[at + (size_t)l] + part * sum[l] * step->inverse[at + (size_t)l];
}

static ALWAYS_INLINE void add_block(struct block_sums *b, double mass, const double *before,
                                    const double *after)
{
    for (int l = 0; l < LANES; l++) {
        b->both[l] += mass * before[l] * after[l];
        b->half[l] += mass * after[l] * after[l];
        b->before[l] += mass * before[l];
        b->after[l] += mass * after[l];
    }
}

/* v.M'v = beta v.M v - (beta - 1) (sum m v)^2 / sum m, per station. */
static void finish_block(const struct wb_swept_step *step, const struct block_sums *b, int c, int j,
                         double time, struct wb_swept_step_sums *sums)
{
    const double beta = step->model.selective;

    for (int l = 0; l < LANES; l++) {
        const size_t at = (size_t)(c * step->model.layout.stride + j + l);
        if (step->inverse[at] == 0.0)
            continue;
        const double scaled = 1.0 / step->inverse[at], mean = (beta - 1.0) / step->total;
        sums->kinetic += 0.5 * scaled * (beta * b->both[l] - mean * b->before[l] * b->after[l]);
        sums->kinetic_half += 0.5 * scaled * (beta * b->half[l] - mean * b->after[l] * b->after[l]);
        sums->momentum[c] += scaled * b->after[l];
        sums->gravity_work += scaled * step->weight[at] * b->after[l] * time;
    }
}

static ALWAYS_INLINE void advance(const struct wb_swept_step *step,
                                  const struct wb_swept_step_fields *fields, const double times[2],
                                  int first, int end, struct wb_swept_step_sums *sums)
{
    const size_t stride = (size_t)step->model.layout.stride;
    const double own = 1.0 / step->model.selective;

    for (int j = first * LANES; j < end * LANES; j += LANES) {
        for (int c = 0; c < 3; c++) {
            const double *inverse = step->inverse + (size_t)c * stride + j;
            struct block_sums b = {{0.0}};
            double common[LANES];
            common_acceleration(step, fields->force, c, j, common);
            for (int k = 0; k < step->model.layout.n_nodes; k++) {
                const size_t at = (size_t)(3 * k + c) * stride + (size_t)j;
                double *restrict v = fields->velocity + at, *restrict x = fields->position + at;
                double f[LANES], before[LANES];
                read_force(step, fields->force, at, f);
                if (sums)
                    memcpy(before, v, sizeof before);
                const double factor = own * step->inverse_node[k];
                for (int l = 0; l < LANES; l++) {
                    v[l] += times[0] * (factor * f[l] * inverse[l] + common[l]);
                    x[l] += times[1] * v[l];
                }
                if (sums)
                    add_block(&b, step->node_mass[k], before, v);
            }
            if (sums)
                finish_block(step, &b, c, j, times[1], sums);
        }
    }
}

static void advance_portably(const struct wb_swept_step *step,
                             const struct wb_swept_step_fields *fields, const double times[2],
                             int first, int end, struct wb_swept_step_sums *sums)
{
    if (sums)
        advance(step, fields, times, first, end, sums);
    else
        advance(step, fields, times, first, end, NULL);
}

#ifdef __x86_64__
__attribute__((target("avx2"))) static void advance_avx2(const struct wb_swept_step *step,
                                                         const struct wb_swept_step_fields *fields,
                                                         const double times[2], int first, int end,
                                                         struct wb_swept_step_sums *sums)
{
    if (sums)
        advance(step, fields, times, first, end, sums);
    else
        advance(step, fields, times, first, end, NULL);
}

__attribute__((target("avx512f,avx512dq,avx512vl"))) static void
advance_avx512(const struct wb_swept_step *step, const struct wb_swept_step_fields *fields,
               const double times[2], int first, int end, struct wb_swept_step_sums *sums)
{
    if (sums)
        advance(step, fields, times, first, end, sums);
    else
        advance(step, fields, times, first, end, NULL);
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
    step->advance(step, fields, times, first, end, sums);
}

/* The numbers of a station from its length, extra mass and what is held. */
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

static enum wb_status check(const struct wb_swept_step_model *m)
{
    if (m->layout.n_nodes < 1 || m->layout.n_stations < 2 ||
        m->layout.stride != wb_swept_layout(m->layout.n_nodes, m->layout.n_stations).stride)
        return wb_fail(WB_ERR_ARGUMENT, "a body of %d nodes and %d stations", m->layout.n_nodes,
                       m->layout.n_stations);
    if (!(m->spacing > 0.0 && isfinite(m->spacing)))
        return wb_fail(WB_ERR_ARGUMENT, "stations %g m apart", m->spacing);
    if (!(m->mass_scaling > 0.0 && isfinite(m->mass_scaling)))
        return wb_fail(WB_ERR_ARGUMENT, "mass scaling by %g", m->mass_scaling);
    if (!(m->selective >= 1.0 && isfinite(m->selective)))
        return wb_fail(WB_ERR_ARGUMENT, "selective mass scaling by %g", m->selective);
    for (int k = 0; k < m->layout.n_nodes; k++) {
        if (!(m->node_mass[k] > 0.0 && isfinite(m->node_mass[k])))
            return wb_fail(WB_ERR_ARGUMENT, "node %d has a mass of %g kg/m", k, m->node_mass[k]);
    }
    return WB_OK;
}

static enum wb_status allocate(struct wb_swept_step *step)
{
    const size_t n = (size_t)step->model.layout.n_nodes;
    const size_t stride = (size_t)step->model.layout.stride;

    step->node_mass = calloc(2 * n, sizeof *step->node_mass);
    step->length = calloc(8 * stride, sizeof *step->length);
    step->held = calloc(3 * stride, sizeof *step->held);
    if (!step->node_mass || !step->length || !step->held)
        return wb_fail(WB_ERR_MEMORY, "no memory for the masses of %zu stations", stride);
    step->inverse_node = step->node_mass + n;
    step->extra = step->length + stride;
    step->inverse = step->extra + stride;
    step->weight = step->inverse + 3 * stride;
    return WB_OK;
}

enum wb_status wb_swept_step_create(struct wb_swept_step **out,
                                    const struct wb_swept_step_model *model)
{
    struct wb_swept_step_model m = *model;

    *out = NULL;
    m.mass_scaling = m.mass_scaling == 0.0 ? 1.0 : m.mass_scaling;
    m.selective = m.selective == 0.0 ? 1.0 : m.selective;
    WB_TRY(check(&m));
    struct wb_swept_step *step = calloc(1, sizeof *step);
    if (!step)
        return wb_fail(WB_ERR_MEMORY, "no memory for a body");
    step->model = m;
    const enum wb_status status = allocate(step);
    if (status != WB_OK) {
        wb_swept_step_destroy(step);
        return status;
    }
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
