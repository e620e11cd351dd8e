#include "tests/analysis/fast_rig.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/align/align.h"
#include "analysis/align/align_private.h"
#include "analysis/dataset/fit.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/units.h"
#include "fe/rod/fibres.h"
#include "fixtures/virtual/live_wire.h"
#include "fixtures/virtual/sim_cell.h"
#include "fixtures/virtual/sim_mocap.h"

#define WB_LOG_DOMAIN "test"

static const double tare_time = 2.5, speed = 1.0 * WB_MM, end_pause = 2.0;
static const int strips = 12;
/* Steps between two curvatures of the truth: relaxation needs small ones. */
enum {
    TRUTH_STEPS = 40,
    RELEASE_STEPS = 100
};

void fast_rig_init(struct fast_rig *fast, int type, double length, uint64_t seed)
{
    char path[WB_PATH], name[128];
    memset(fast, 0, sizeof *fast);
    snprintf(name, sizeof name, "fixtures/specimens/type%d-L85-1.yaml", type);
    bool good = wb_file_find_data(path, "fixtures/rigs/paper.yaml") == WB_OK &&
                wb_rig_read(path, &fast->rig) == WB_OK && wb_file_find_data(path, name) == WB_OK &&
                wb_specimen_read(path, &fast->specimen) == WB_OK;
    snprintf(name, sizeof name, "fixtures/wires/type%d.yaml", type);
    good = good && wb_file_find_data(path, name) == WB_OK &&
           wb_wire_read(path, &fast->wire, NULL) == WB_OK &&
           wb_file_find_data(path, "fixtures/virtual/wires.yaml") == WB_OK &&
           wb_composite_read(path, fast->wire.name, &fast->composite) == WB_OK;
    if (!good) {
        fprintf(stderr, "the fixtures of type %d cannot be read\n", type);
        abort();
    }
    for (int i = 0; i < fast->specimen.n_markers; i++)
        fast->specimen.markers[i] *= length / fast->specimen.length;
    fast->specimen.length = length;
    fast->rig.is_virtual = true;
    fast->rig.stage.speed = speed;
    fast->cycles = 1;
    fast->dwell = 0.2;
    fast->travel = 53.0 * WB_MM;
    fast->every_frame = 6;
    fast->noise = 1.0;
    wb_truth_draw(&fast->truth, seed, &fast->rig, &fast->specimen);
}

/* Travel of the stage at a time, down and back in cycles from the end of the tare on. */
static double travel_at(const struct fast_rig *fast, double t)
{
    const double way = fast->travel / speed;
    const double period = 2.0 * way + fast->dwell + end_pause;
    const double since = t - tare_time;
    if (since < 0.0 || since >= fast->cycles * period)
        return 0.0;
    const double phase = fmod(since, period);
    if (phase < way)
        return phase * speed;
    if (phase < way + fast->dwell)
        return fast->travel;
    return fmax(0.0, fast->travel - (phase - way - fast->dwell) * speed);
}

struct bench {
    const struct fast_rig *fast;
    struct wb_truth truth;
    struct wb_live_wire *wire;
    struct wb_live_wire_view view;
    struct wb_sim_cell cell;
    struct wb_sim_mocap mocap;
    struct wb_natnet_frame frame;
    double tare_sum;
    long tare_n;
};

/* Stamps of the host: whole nanoseconds from an hour on. */
static int64_t stamp(double t)
{
    return INT64_C(3600000000000) + (int64_t)(t * 1e9);
}

static void read_cell(struct bench *bench, struct wb_align *align, uint64_t k, double t)
{
    wb_live_wire_set_time(bench->wire, t);
    wb_live_wire_move(bench->wire, travel_at(bench->fast, t), &bench->view);
    wb_sim_cell_read(&bench->cell, k, t, bench->view.tension);
    bench->cell.out.n = 0; /* the output is not used */
    const double force = bench->cell.reading * (1.0 + bench->fast->off.gain);
    const struct wb_align_reading reading = {.t_ns = stamp(t), .force = force};
    if (t > 0.5 && t < tare_time) {
        bench->tare_sum += reading.force;
        bench->tare_n++;
    }
    wb_align_list_add(&align->readings, &reading, sizeof reading);
}

static void take_frame(struct bench *bench, struct wb_align *align, uint64_t k, double t)
{
    wb_live_wire_set_time(bench->wire, t);
    wb_live_wire_move(bench->wire, travel_at(bench->fast, t), &bench->view);
    wb_sim_mocap_frame(&bench->mocap, k, &bench->view, &bench->frame);
    bench->frame.mocap.t_ns = stamp(t);
    bench->frame.mocap.t_device = t;
    bench->frame.mocap.camera_mid_exposure = 0;
    wb_point_cloud_add(&align->cloud, &bench->frame.mocap);
}

static enum wb_status run_bench(struct bench *bench, struct wb_align *align)
{
    const struct fast_rig *const fast = bench->fast;
    const double way = fast->travel / speed;
    const double end = tare_time + fast->cycles * (2.0 * way + fast->dwell + end_pause) + 0.5;
    const uint64_t every = (uint64_t)fast->every_frame;
    uint64_t frame = every - 1, reading = 0, report = 0;
    for (;;) {
        const double t_frame = (double)(frame + 1) / bench->truth.frame_rate;
        const double t_reading = wb_sim_cell_time(&bench->cell, reading);
        const double t_report = 0.2 * (double)(report + 1);
        const double t = fmin(t_report, fmin(t_frame, t_reading));
        if (t > end)
            return WB_OK;
        if (t == t_reading) {
            read_cell(bench, align, reading++, t);
        } else if (t == t_frame) {
            take_frame(bench, align, frame, t);
            frame += every;
        } else {
            const struct wb_align_report_point point = {.t_ns = stamp(t),
                                                        .travel = travel_at(fast, t)};
            wb_align_list_add(&align->reports, &point, sizeof point);
            report++;
        }
    }
}

static void state_wrongly(struct wb_align *align, const struct wb_test_uncertainty *off)
{
    align->rig.strand.counterweight += off->counterweight;
    align->specimen.length += off->length;
    for (int i = 1; i < align->specimen.n_markers; i++)
        align->specimen.markers[i] += off->length;
    align->wire.outer_diameter += off->diameter;
    align->wire.density *= 1.0 + off->density;
}

static enum wb_status load(struct wb_align *align, const void *context)
{
    const struct fast_rig *const fast = context;
    const struct wb_natnet_version version = {3, 0};
    struct bench *const bench = calloc(1, sizeof *bench);
    if (!bench)
        return WB_ERR_MEMORY;
    bench->fast = fast;
    bench->truth = fast->truth;
    bench->truth.cell_noise *= fast->noise;
    bench->truth.marker_noise *= fast->noise;
    snprintf(align->name, sizeof align->name, "seed %llu", (unsigned long long)fast->truth.seed);
    align->rig = fast->rig;
    align->specimen = fast->specimen;
    align->wire = fast->wire;
    state_wrongly(align, &fast->off);
    align->is_virtual = true;
    align->gravity = fast->rig.gravity;
    wb_align_describe(align);
    const struct wb_live_wire_parts parts = {&bench->truth, &fast->composite, &fast->wire,
                                             &fast->rig, &fast->specimen};
    const struct wb_live_wire_settings settings = {.variant = fast->variant, .n_strips = strips};
    enum wb_status status = wb_live_wire_create(&bench->wire, &parts, &settings);
    if (status == WB_OK)
        status = wb_sim_cell_init(&bench->cell, &bench->truth, &fast->rig);
    if (status == WB_OK) {
        wb_sim_mocap_init(&bench->mocap, &bench->truth, fast->rig.mocap.up,
                          fast->specimen.n_markers, version);
        status = run_bench(bench, align);
    }
    if (status == WB_OK && wb_live_wire_failures(bench->wire) > 0)
        status = wb_fail(WB_ERR_CONVERGENCE, "%s: the wire of the fast rig did not converge",
                         align->name);
    align->has_tare = align->has_start = true;
    align->tare = bench->tare_sum / (double)bench->tare_n;
    align->tare_deviation = bench->truth.cell_noise;
    align->tare_samples = bench->tare_n;
    align->tare_ns = stamp(tare_time);
    align->start_ns = stamp(tare_time);
    align->n_cycle_starts = fast->cycles;
    wb_live_wire_destroy(bench->wire);
    free(bench);
    return status;
}

enum wb_status fast_rig_run(const struct fast_rig *fast, struct wb_dataset *dataset)
{
    struct wb_align_settings settings;
    wb_align_default_settings(&settings);
    return wb_align_run_from(dataset, NULL, &settings, load, fast, NULL);
}

/* The true section of a specimen. */
struct truth {
    struct wb_composite_laws laws;
    struct wb_section section;
    struct wb_fibres *fibres;
    double *before, *after, *memory; /* histories */
    double curvature;
};

static void open_truth(struct truth *truth, const struct fast_rig *fast)
{
    *truth = (struct truth){.curvature = 0.0};
    if (wb_composite_build_variant(&fast->composite, fast->variant, &fast->wire,
                                   fast->truth.stiffness_factor, fast->truth.yield_factor, strips,
                                   &truth->laws, &truth->section) != WB_OK ||
        wb_fibres_create(&truth->fibres, &truth->section) != WB_OK)
        abort();
    const size_t size = wb_fibres_history_size(truth->fibres);
    truth->before = truth->memory = calloc(2 * size, sizeof(double));
    if (!truth->memory)
        abort();
    truth->after = truth->memory + size;
}

static void close_truth(struct truth *truth)
{
    free(truth->memory);
    wb_fibres_destroy(truth->fibres);
    wb_section_release(&truth->section);
}

/* Bends it uniformly to a curvature within a time; returns the moment. */
static double bend_truth(struct truth *truth, double curvature, double time)
{
    struct wb_fibres_response response = {.M = 0.0};
    const double from = truth->curvature;
    truth->laws.time_step = time / TRUTH_STEPS;
    for (int k = 1; k <= TRUTH_STEPS; k++) {
        const double at = from + (curvature - from) * k / TRUTH_STEPS;
        wb_fibres_respond(truth->fibres, 0.0, at, truth->before, truth->after, &response);
        double *const old = truth->before;
        truth->before = truth->after;
        truth->after = old;
    }
    truth->curvature = curvature;
    return response.M;
}

/* The clamp's curvature grows nearly uniformly in time. */
static double time_of(const struct fast_rig *fast, double change, double largest)
{
    return fast->travel / speed * change / largest;
}

void fast_rig_truth(const struct fast_rig *fast, int n, const double *curvature, double *moment,
                    double *rigidity, double *residual_curvature)
{
    struct truth truth;
    open_truth(&truth, fast);
    if (rigidity)
        *rigidity = wb_fibres_bending_stiffness(truth.fibres);
    for (int i = 0; i < n; i++) {
        const double change = curvature[i] - truth.curvature;
        const double M = bend_truth(&truth, curvature[i], time_of(fast, change, curvature[n - 1]));
        if (moment)
            moment[i] = M;
    }
    if (residual_curvature) {
        const double top = truth.curvature, step = top / RELEASE_STEPS;
        double before = 0.0, M = 1.0;
        while (M > 0.0 && truth.curvature > 0.0) {
            before = M;
            M = bend_truth(&truth, truth.curvature - step, time_of(fast, step, top));
        }
        *residual_curvature = truth.curvature + step * -M / (before - M);
    }
    close_truth(&truth);
}

void fast_rig_unloading(const struct fast_rig *fast, double largest, int n, const double *change,
                        double *stiffness)
{
    struct truth truth;
    open_truth(&truth, fast);
    const double top = bend_truth(&truth, largest, time_of(fast, largest, largest));
    for (int i = 0; i < n; i++) {
        const double step = truth.curvature - (largest - change[i]);
        const double M = bend_truth(&truth, largest - change[i], time_of(fast, step, largest));
        stiffness[i] = (top - M) / change[i];
    }
    close_truth(&truth);
}

void fast_rig_shift_deflection(struct wb_dataset *dataset, double by)
{
    double *const x = wb_memory_new(2 * dataset->n_rows, sizeof *x), *const y = x + dataset->n_rows;
    struct wb_fit_line line = {.value = (double)NAN};
    size_t n = 0;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        struct wb_row *const row = &dataset->rows[i];
        row->deflection += by;
        if (row->cycle == 1 && row->phase == WB_PHASE_LOAD && row->deflection > 1.0 * WB_MM &&
            row->deflection < 3.0 * WB_MM) {
            x[n] = row->deflection;
            y[n++] = row->force;
        }
    }
    if (!wb_fit_line(x, y, n, &line))
        abort();
    free(x);
    for (size_t i = 0; i < dataset->n_rows; i++)
        dataset->rows[i].force -= line.value;
    for (size_t i = 0; i < dataset->n_shape_rows; i++)
        dataset->shape_rows[i].deflection += by;
}
