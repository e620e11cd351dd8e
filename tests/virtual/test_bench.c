/* The complete virtual rig with the real drivers in the real acquisition loop: in virtual time, and
 * several side by side through their ports in real time. */
#include "fixtures/virtual/bench_private.h"

#include <poll.h>
#include <pthread.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/file.h"
#include "base/interrupt.h"
#include "base/timing.h"
#include "base/units.h"
#include "daq/acquire/acquisition.h"
#include "fixtures/virtual/virtual_time.h"
#include "tests/check.h"

enum {
    MOST = 20000
};

/* Received samples, by sample number. */
struct receiver {
    int n_load, n_mocap, n_probe;
    double force[MOST];
    int64_t load_ns[MOST];
    int32_t frame[MOST];
    double position[MOST]; /* sum of the first marker's coordinates */
};

struct scene {
    char folder[64], rig_path[WB_PATH], paper[WB_PATH], specimen[WB_PATH];
    struct wb_bench *bench;
    bool has_ports; /* also with a thread that serves its ports, in real time */
    pthread_t thread;
    volatile bool stop;
    struct wb_rig rig;
    struct wb_acquisition *acquisition;
    struct receiver receiver;
};

static void hear_load(void *context, const struct wb_load_sample *sample)
{
    struct receiver *const receiver = context;
    if (receiver->n_load == MOST)
        return;
    receiver->force[receiver->n_load] = sample->force;
    receiver->load_ns[receiver->n_load++] = sample->t_ns;
}

static void hear_mocap(void *context, const struct wb_mocap_frame *frame)
{
    struct receiver *const receiver = context;
    if (receiver->n_mocap == MOST)
        return;
    receiver->frame[receiver->n_mocap] = frame->frame_number;
    receiver->position[receiver->n_mocap] = 0.0;
    for (int i = 0; i < 3 && frame->n_markers > 0; i++)
        receiver->position[receiver->n_mocap] += (double)frame->markers[0].position[i];
    receiver->n_mocap++;
}

static void hear_probe(void *context, const struct wb_clock_probe *probe)
{
    (void)probe;
    ((struct receiver *)context)->n_probe++;
}

static void *live(void *context)
{
    struct scene *const scene = context;
    wb_bench_run(scene->bench, &scene->stop);
    return NULL;
}

static void quiet(void *context, enum wb_log_level level, const char *domain, const char *message)
{
    (void)context;
    (void)domain;
    if (level == WB_LOG_ERROR)
        print_message("%s\n", message);
}

static void start_bench(struct scene *scene, struct wb_bench_settings settings, bool has_ports)
{
    memset(scene, 0, sizeof *scene);
    scene->has_ports = has_ports;
    if (!has_ports)
        wb_virtual_time_begin(WB_VIRTUAL_TIME_HOST_DATE);
    strcpy(scene->folder, "/tmp/wb-bench-XXXXXX");
    assert_non_null(mkdtemp(scene->folder));
    assert_int_equal(wb_file_join(scene->rig_path, scene->folder, "rig.yaml"), WB_OK);
    assert_int_equal(wb_file_find_data(scene->paper, "fixtures/rigs/paper.yaml"), WB_OK);
    assert_int_equal(wb_file_find_data(scene->specimen, "fixtures/specimens/type1-L85-1.yaml"),
                     WB_OK);
    settings.rig = scene->paper;
    settings.specimen = scene->specimen;
    wb_log_set_sink(quiet, NULL);
    assert_int_equal(wb_bench_open(&scene->bench, &settings), WB_OK);
    assert_int_equal(wb_bench_write_rig(scene->bench, scene->rig_path), WB_OK);
    assert_int_equal(wb_rig_read(scene->rig_path, &scene->rig), WB_OK);
    if (has_ports)
        assert_int_equal(pthread_create(&scene->thread, NULL, live, scene), 0);
}

static void connect_to(struct scene *scene)
{
    const struct wb_sink sink = {
        .context = &scene->receiver, .load = hear_load, .mocap = hear_mocap, .probe = hear_probe};
    assert_int_equal(
        wb_acquisition_open(&scene->acquisition, &scene->rig, WB_ACQUISITION_ALL, &sink), WB_OK);
    wb_acquisition_start(scene->acquisition, NULL);
}

static void listen_for(struct scene *scene, double seconds)
{
    const int64_t end_ns = wb_time_now_ns() + wb_ns_from_seconds(seconds);
    for (int64_t left; (left = end_ns - wb_time_now_ns()) > 0;)
        assert_int_equal(wb_acquisition_step(scene->acquisition, left), WB_ACQUISITION_CONTINUE);
}

/* Listens until this number of samples was received. */
static void listen_until(struct scene *scene, int readings, int frames)
{
    const int64_t end_ns = wb_time_now_ns() + 120 * WB_NS_PER_S;
    while (scene->receiver.n_load < readings || scene->receiver.n_mocap < frames) {
        assert_true(wb_time_now_ns() < end_ns);
        assert_int_equal(wb_acquisition_step(scene->acquisition, 5 * WB_NS_PER_MS),
                         WB_ACQUISITION_CONTINUE);
    }
}

static void stop_bench(struct scene *scene)
{
    wb_acquisition_close(scene->acquisition);
    scene->stop = true;
    if (scene->has_ports)
        pthread_join(scene->thread, NULL);
    wb_bench_close(scene->bench);
    if (!scene->has_ports)
        wb_virtual_time_end();
    wb_log_set_sink(NULL, NULL);
    unlink(scene->rig_path);
    rmdir(scene->folder);
}

static struct scene *make_scene(void)
{
    struct scene *const scene = malloc(sizeof *scene);
    assert_non_null(scene);
    return scene;
}

static void rates_are_those_of_the_bench_times_the_scale(void **state)
{
    (void)state;
    static const double scales[] = {1.0, 20.0};
    struct scene *const scene = make_scene();
    for (int i = 0; i < 2; i++) {
        const struct wb_bench_settings settings = {.seed = 2, .time_scale = scales[i]};
        const double seconds = 60.0 / scales[i];
        start_bench(scene, settings, false);
        connect_to(scene);
        listen_for(scene, 0.1);
        memset(&scene->receiver, 0, sizeof scene->receiver);
        listen_for(scene, seconds);
        const struct wb_truth *const truth = &scene->bench->truth;
        assert_close(scene->receiver.n_load, truth->cell_rate * 60.0, 1.0);
        assert_close(scene->receiver.n_mocap, truth->frame_rate * (1.0 + truth->clock_drift) * 60.0,
                     1.0);
        assert_close_relative(truth->cell_rate, 80.0, 0.005);
        assert_close_relative(truth->frame_rate, 120.0, 0.005);
        assert_true(scene->receiver.n_probe > 0);
        /* No frame is missing. */
        for (int n = 1; n < scene->receiver.n_mocap; n++)
            assert_int_equal(scene->receiver.frame[n], scene->receiver.frame[n - 1] + 1);
        stop_bench(scene);
    }
    free(scene);
}

/* A rig is reproduced from its seed: frame n and reading n have the same numbers, independent of
 * the start of listening. */
static void the_same_seed_gives_the_same_samples(void **state)
{
    (void)state;
    static double position[2][MOST], force[2][MOST];
    struct scene *const scene = make_scene();
    int least = MOST, from = 0;
    for (int run = 0; run < 2; run++) {
        const struct wb_bench_settings settings = {.seed = 5, .time_scale = 10.0};
        start_bench(scene, settings, false);
        wb_time_sleep(wb_time_now_ns() + run * 30 * WB_NS_PER_MS);
        connect_to(scene);
        listen_until(scene, run == 0 ? 600 : 50, run == 0 ? 900 : 300);
        const struct receiver *const receiver = &scene->receiver;
        for (int n = 0; n < receiver->n_mocap; n++)
            position[run][receiver->frame[n]] = receiver->position[n];
        from = receiver->frame[0] > from ? receiver->frame[0] : from;
        const int last = receiver->frame[receiver->n_mocap - 1];
        least = last < least ? last : least;
        memcpy(force[run], receiver->force, sizeof force[run]);
        stop_bench(scene);
    }
    assert_true(least - from > 100);
    for (int n = from; n <= least; n++)
        assert_close(position[0][n], position[1][n], 0.0);
    /* Readings have no number: the second run may have started later, so find its offset in the
     * first. */
    int shift = 0;
    while (shift < 580 && memcmp(force[0] + shift, force[1], 20 * sizeof force[0][0]) != 0)
        shift++;
    assert_true(shift < 580);
    free(scene);
}

static void other_seeds_give_other_noise(void **state)
{
    (void)state;
    struct scene *const scene = make_scene();
    double first[2][10];
    for (int run = 0; run < 2; run++) {
        const struct wb_bench_settings settings = {.seed = (uint64_t)run, .time_scale = 10.0};
        start_bench(scene, settings, false);
        connect_to(scene);
        listen_until(scene, 10, 0);
        memcpy(first[run], scene->receiver.force, sizeof first[run]);
        stop_bench(scene);
    }
    assert_memory_not_equal(first[0], first[1], sizeof first[0]);
    free(scene);
}

static void several_rigs_run_side_by_side(void **state)
{
    (void)state;
    enum {
        N = 4
    };
    struct scene *scenes[N];
    for (int i = 0; i < N; i++) {
        const struct wb_bench_settings settings = {.seed = (uint64_t)i};
        scenes[i] = make_scene();
        start_bench(scenes[i], settings, true);
        connect_to(scenes[i]);
    }
    for (int i = 0; i < N; i++) {
        listen_until(scenes[i], 20, 20);
        stop_bench(scenes[i]);
        free(scenes[i]);
    }
}

/* The stage is commanded to move down; the cell and the cameras measure it. */
static void a_jog_loads_the_wire(void **state)
{
    (void)state;
    struct scene *const scene = make_scene();
    const struct wb_bench_settings settings = {.seed = 3, .time_scale = 20.0};
    struct wb_bench_counts counts;
    start_bench(scene, settings, false);
    connect_to(scene);
    listen_until(scene, 20, 20);
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(scene->acquisition);
    while (!latest->stream[WB_ROLE_STAGE].ready)
        listen_for(scene, 0.02);
    assert_close(latest->settings.speed, 200.0 * WB_MM, 1e-9);
    const double zero = scene->receiver.force[scene->receiver.n_load - 1];
    assert_int_equal(wb_acquisition_command(scene->acquisition, WB_STAGE_COMMAND_JOG, 10.0 * WB_MM,
                                            20.0 * WB_MM),
                     WB_OK);
    const int64_t end_ns = wb_time_now_ns() + 20 * WB_NS_PER_S;
    while (!(latest->stage.position > -52.001 * WB_MM && latest->stage.state == WB_STAGE_IDLE)) {
        assert_true(wb_time_now_ns() < end_ns);
        listen_for(scene, 0.02);
    }
    listen_until(scene, scene->receiver.n_load + 100, 0);
    assert_close(latest->stage.position, -52.0 * WB_MM, 1e-6);
    assert_true(scene->receiver.force[scene->receiver.n_load - 1] - zero > 30.0 * WB_MN);
    wb_acquisition_motion_ended(scene->acquisition);
    wb_bench_count(scene->bench, &counts);
    assert_close(counts.travel, 10.0 * WB_MM, 1e-6);
    assert_true(counts.failures == 0 && counts.tension > 30.0 * WB_MN);
    stop_bench(scene);
    free(scene);
}

/* A clock set by a test. */
static int64_t moved_ns;

static int64_t moved_now(void)
{
    return moved_ns;
}

static int64_t moved_utc(void)
{
    return 0;
}

static int moved_wait(struct pollfd *descriptors, size_t n, int64_t deadline_ns)
{
    (void)deadline_ns;
    return poll(descriptors, (nfds_t)n, 0);
}

/* A delayed process produces all missed samples. */
static void delays_cause_no_gaps(void **state)
{
    (void)state;
    struct scene *const scene = make_scene();
    struct wb_bench_counts before, after;
    assert_int_equal(wb_file_find_data(scene->paper, "fixtures/rigs/paper.yaml"), WB_OK);
    assert_int_equal(wb_file_find_data(scene->specimen, "fixtures/specimens/type1-L85-1.yaml"),
                     WB_OK);
    const struct wb_bench_settings settings = {
        .rig = scene->paper, .specimen = scene->specimen, .seed = 3};
    assert_int_equal(wb_bench_open(&scene->bench, &settings), WB_OK);
    const struct wb_time_source source = {moved_now, moved_utc, moved_wait};
    moved_ns = scene->bench->start_ns;
    wb_time_replace(&source);
    wb_bench_step(scene->bench, 0);
    wb_bench_count(scene->bench, &before);
    assert_close(before.latest, 0.0, 1e-9);
    moved_ns += WB_NS_PER_S / 2;
    wb_bench_step(scene->bench, 0);
    wb_bench_count(scene->bench, &after);
    wb_time_replace(NULL);
    assert_in_range(after.readings - before.readings, 39, 41);
    assert_in_range(after.frames - before.frames, 59, 60); /* the last one is not sent yet */
    assert_close(after.latest, 0.5, 1.0 / 80.0);
    /* It has not moved by itself. */
    assert_close(after.travel, 0.0, 0.0);
    assert_close(after.tension, 0.0, 0.0);
    assert_int_equal(after.failures, 0);
    wb_bench_close(scene->bench);
    free(scene);
}

static int n_errors;

static void count_errors(void *context, enum wb_log_level level, const char *domain,
                         const char *message)
{
    (void)context;
    (void)domain;
    (void)message;
    n_errors += level == WB_LOG_ERROR;
}

static void invalid_settings_give_one_message(void **state)
{
    (void)state;
    char rig[WB_PATH], specimen[WB_PATH], wires[WB_PATH];
    struct wb_bench *bench;
    assert_int_equal(wb_file_find_data(rig, "fixtures/rigs/paper.yaml"), WB_OK);
    assert_int_equal(wb_file_find_data(specimen, "fixtures/specimens/type1-L85-1.yaml"), WB_OK);
    assert_int_equal(wb_file_find_data(wires, "fixtures/wires/type1.yaml"), WB_OK);
    const struct wb_bench_settings cases[] = {
        {.rig = "/nowhere.yaml", .specimen = specimen},
        {.rig = rig, .specimen = "/nowhere.yaml"},
        {.rig = specimen, .specimen = specimen},
        {.rig = rig, .specimen = rig},
        {.rig = rig, .specimen = specimen, .composites = wires},
        {.rig = rig, .specimen = specimen, .natnet = {4, 5}},
    };
    wb_log_set_sink(count_errors, NULL);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        n_errors = 0;
        assert_int_not_equal(wb_bench_open(&bench, &cases[i]), WB_OK);
        assert_null(bench);
        assert_int_equal(n_errors, 1);
    }
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rates_are_those_of_the_bench_times_the_scale),
        cmocka_unit_test(the_same_seed_gives_the_same_samples),
        cmocka_unit_test(other_seeds_give_other_noise),
        cmocka_unit_test(several_rigs_run_side_by_side),
        cmocka_unit_test(a_jog_loads_the_wire),
        cmocka_unit_test(delays_cause_no_gaps),
        cmocka_unit_test(invalid_settings_give_one_message),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
