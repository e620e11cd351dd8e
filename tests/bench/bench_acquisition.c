/* CPU cost of recording at ten times the data rates of a bench, and latency of the hold byte, on
 * real ports in real time.
 *
 * Cost: a separate process runs the virtual rig ten times as fast (800 readings and 1200 marker
 * frames per second, and a stage that is polled). Measured are the CPU time of the whole recorder
 * (loop, decoders, writer) and the growth of its memory. The baseline in the same run waits for the
 * same bytes with poll(), reads them and writes them to a file with fdatasync() every 100 ms.
 * `bench_acquisition SECONDS` sets the duration, default 20.
 *
 * Latency: a separate process simulates a load cell and a GRBL stage on pseudo-terminals and
 * measures the time from sending an overload reading to receiving the hold byte. The baseline waits
 * with poll(), reads, and writes that byte itself. */
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "base/timing.h"
#include "base/units.h"
#include "daq/acquire/acquisition.h"
#include "daq/acquire/acquisition_private.h"
#include "daq/protocol/natnet.h"
#include "daq/stream/stream.h"
#include "fixtures/virtual/bench.h"
#include "fixtures/virtual/pty_port.h"
#include "fixtures/virtual/sim_stage.h"
#include "tests/check.h"
#include "tests/folder.h"
#include "tests/trials.h"

#define GOAL 0.3 /* of one core */
#define HOLDS 100
#define READING_NS (WB_NS_PER_MS * 5 / 4)

/* --- processes --- */

static void end_process(pid_t process)
{
    kill(process, SIGKILL);
    waitpid(process, NULL, 0);
}

/* The virtual rig, ten times as fast; its rig file is there when this returns. */
static pid_t start_rig(const char *folder, const char *rig_path)
{
    char paper[WB_PATH], specimen[WB_PATH], byte = 0;
    int ends[2];
    assert_int_equal(wb_file_find_fixture(paper, "rigs", "paper", NULL), WB_OK);
    assert_int_equal(wb_file_find_fixture(specimen, "specimens", "type1-L100-1", NULL), WB_OK);
    assert_int_equal(pipe(ends), 0);
    const pid_t process = fork();
    assert_true(process >= 0);
    if (process == 0) {
        const struct wb_bench_settings settings = {
            .rig = paper, .specimen = specimen, .folder = folder, .seed = 1, .time_scale = 10.0};
        const volatile bool stop = false;
        struct wb_bench *bench;
        if (wb_bench_open(&bench, &settings) != WB_OK ||
            wb_bench_write_rig(bench, rig_path) != WB_OK || write(ends[1], &byte, 1) != 1)
            _exit(1);
        for (;;)
            wb_bench_run(bench, &stop);
    }
    close(ends[1]);
    assert_int_equal(read(ends[0], &byte, 1), 1);
    close(ends[0]);
    return process;
}

static double cpu_s(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (double)usage.ru_utime.tv_sec + (double)usage.ru_stime.tv_sec +
           1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

static double resident_MiB(void)
{
    long pages = 0;
    FILE *const file = fopen("/proc/self/statm", "r");
    assert_non_null(file);
    assert_int_equal(fscanf(file, "%*d %ld", &pages), 1);
    fclose(file);
    return (double)pages * (double)sysconf(_SC_PAGESIZE) / 1048576.0;
}

struct cost {
    double share; /* CPU time over the time it lasted */
    double first_MiB, last_MiB;
    uint64_t readings, frames, reports, drops;
};

static void record(const struct wb_rig *rig, const char *path, double seconds, struct cost *cost)
{
    struct wb_acquisition *acquisition;
    struct wb_recording *recording;
    struct wb_writer *writer;
    int id;
    static const char *const protocols[] = {"generic", "natnet", "grbl"};
    assert_int_equal(wb_acquisition_open(&acquisition, rig, WB_ACQUISITION_ALL, NULL), WB_OK);
    assert_int_equal(wb_recording_create(&recording, path), WB_OK);
    for (int role = 0; role < 3; role++)
        assert_int_equal(wb_recording_add_stream(recording, (enum wb_role)role, "bench",
                                                 protocols[role], "", &id),
                         WB_OK);
    assert_int_equal(wb_writer_start(&writer, recording, NULL), WB_OK);
    wb_acquisition_start(acquisition, writer);
    /* Buffers grow to their size in the first seconds. */
    const int64_t begin_ns = wb_time_now_ns(), settled_ns = begin_ns + 5 * WB_NS_PER_S;
    const int64_t end_ns = begin_ns + wb_ns_from_seconds(seconds);
    const double before_s = cpu_s();
    for (int64_t now_ns; (now_ns = wb_time_now_ns()) < end_ns;) {
        if (now_ns < settled_ns)
            cost->first_MiB = resident_MiB();
        assert_int_equal(wb_acquisition_step(acquisition, 20 * WB_NS_PER_MS),
                         WB_ACQUISITION_CONTINUE);
    }
    cost->last_MiB = resident_MiB();
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(acquisition);
    cost->readings = latest->stream[WB_ROLE_LOAD].samples;
    cost->frames = latest->stream[WB_ROLE_MOCAP].samples;
    cost->reports = latest->stream[WB_ROLE_STAGE].samples;
    for (int role = 0; role < 3; role++)
        cost->drops += latest->stream[role].drops + latest->stream[role].loss.missing;
    wb_acquisition_close(acquisition);
    assert_int_equal(wb_writer_finish(writer), WB_OK);
    cost->share = (cpu_s() - before_s) / seconds;
}

/* The same bytes, neither decoded nor kept apart. The cameras are asked by what the recorder sends
 * them first. */
static double copy(const struct wb_rig *rig, const char *path, double seconds)
{
    struct wb_stream *streams[2];
    assert_int_equal(wb_stream_open(&streams[0], rig->load_cell.address), WB_OK);
    assert_int_equal(wb_stream_open(&streams[1], rig->mocap.address), WB_OK);
    const uint8_t connect[4] = {WB_NATNET_CONNECT, 0, 0, 0};
    assert_int_equal(wb_stream_write(streams[1], connect, sizeof connect), WB_OK);
    const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    assert_true(file >= 0);
    static uint8_t bytes[WB_STREAM_READ_MAX];
    struct pollfd polled[2] = {{.events = POLLIN}, {.events = POLLIN}};
    for (int i = 0; i < 2; i++) {
        int descriptors[2];
        assert_int_equal(wb_stream_descriptors(streams[i], descriptors), 1);
        polled[i].fd = descriptors[0];
    }
    const double before_s = cpu_s();
    const int64_t end_ns = wb_time_now_ns() + wb_ns_from_seconds(seconds);
    int64_t synced_ns = 0;
    for (int64_t now_ns; (now_ns = wb_time_now_ns()) < end_ns;) {
        poll(polled, 2, 20);
        for (int i = 0; i < 2; i++) {
            size_t n = 1;
            while (n > 0) {
                assert_int_equal(wb_stream_read(streams[i], bytes, sizeof bytes, &n), WB_OK);
                assert_int_equal(write(file, bytes, n), n);
            }
        }
        if (now_ns - synced_ns > 100 * WB_NS_PER_MS) {
            assert_int_equal(fdatasync(file), 0);
            synced_ns = now_ns;
        }
    }
    const double share = (cpu_s() - before_s) / seconds;
    close(file);
    wb_stream_close(streams[0]);
    wb_stream_close(streams[1]);
    return share;
}

/* --- the hold byte --- */

/* Shared with the process that plays the instruments. */
struct instruments {
    char load[64], stage[64]; /* paths of their ports */
    volatile int asked;       /* by the parent: the number of an overload, from 1; 0: none */
    volatile int sent, held;  /* the numbers of the last ones */
    volatile int64_t sent_ns, held_ns;
};

/* A load cell of 800 readings a second and a stage. */
static void play(struct instruments *shared, struct wb_pty_port ports[2])
{
    static struct wb_sim_stage stage;
    const struct wb_sim_stage_settings settings = {.axis = 'X', .down = 1};
    const int64_t begun_ns = wb_time_now_ns();
    int64_t next_ns = begun_ns;
    wb_sim_stage_init(&stage, &settings);
    for (;;) {
        struct pollfd polled = {.fd = ports[1].descriptor, .events = POLLIN};
        char bytes[512];
        (void)wb_time_wait(&polled, 1, next_ns);
        const int64_t now_ns = wb_time_now_ns();
        const double t = wb_seconds_from_ns(now_ns - begun_ns);
        wb_sim_stage_advance(&stage, t);
        (void)wb_pty_port_update(&ports[0]);
        (void)wb_pty_port_update(&ports[1]);
        const size_t n = wb_pty_port_read(&ports[1], bytes, sizeof bytes);
        if (shared->held < shared->sent && memchr(bytes, '!', n)) {
            shared->held_ns = now_ns;
            shared->held = shared->sent;
        }
        wb_sim_stage_receive(&stage, t, bytes, n);
        char said[WB_REPLY_BYTES];
        wb_pty_port_write(&ports[1], said, wb_reply_take(&stage.out, said, sizeof said));
        if (now_ns < next_ns)
            continue;
        next_ns += READING_NS;
        const int asked = shared->asked;
        if (asked == 0) {
            wb_pty_port_write(&ports[0], "0.150 g\r\n", 9);
            continue;
        }
        if (shared->sent < asked) {
            shared->sent_ns = wb_time_now_ns();
            shared->sent = asked;
        }
        wb_pty_port_write(&ports[0], "OL\r\n", 4);
    }
}

static pid_t start_instruments(struct instruments *shared)
{
    struct wb_pty_port ports[2];
    for (int i = 0; i < 2; i++)
        assert_int_equal(wb_pty_port_open(&ports[i]), WB_OK);
    snprintf(shared->load, sizeof shared->load, "%s", ports[0].path);
    snprintf(shared->stage, sizeof shared->stage, "%s", ports[1].path);
    const pid_t process = fork();
    assert_true(process >= 0);
    if (process == 0)
        play(shared, ports);
    return process;
}

/* s from the overload that was asked for to the hold byte. */
static double end_overload(struct instruments *shared)
{
    while (shared->held < shared->asked)
        wb_time_sleep(wb_time_now_ns() + WB_NS_PER_MS / 10);
    shared->asked = 0;
    return wb_seconds_from_ns(shared->held_ns - shared->sent_ns);
}

static void step_for(struct wb_acquisition *a, int64_t duration_ns)
{
    const int64_t end_ns = wb_time_now_ns() + duration_ns;
    while (wb_time_now_ns() < end_ns)
        assert_int_equal(wb_acquisition_step(a, 20 * WB_NS_PER_MS), WB_ACQUISITION_CONTINUE);
}

static void hold(struct instruments *shared, const struct wb_rig *rig, double latencies[HOLDS])
{
    struct wb_acquisition *a;
    struct wb_interlock_settings settings;
    wb_interlock_default_settings(&settings, rig);
    assert_int_equal(wb_acquisition_open(&a, rig, WB_ACQUISITION_LOAD | WB_ACQUISITION_STAGE, NULL),
                     WB_OK);
    wb_acquisition_start(a, NULL);
    const struct wb_acquisition_stream_state *const stage =
        &wb_acquisition_latest(a)->stream[WB_ROLE_STAGE];
    while (!stage->ready)
        step_for(a, 20 * WB_NS_PER_MS);
    for (int i = 0; i < HOLDS; i++) {
        wb_acquisition_arm(a, &settings, (double)NAN);
        assert_int_equal(
            wb_acquisition_command(a, WB_STAGE_COMMAND_JOG, i % 2 ? -0.2e-3 : 0.2e-3, 1e-3), WB_OK);
        step_for(a, 20 * WB_NS_PER_MS + i % 10 * WB_NS_PER_MS);
        shared->asked = shared->sent + 1;
        while (!wb_stop_over(wb_acquisition_stop_state(a)))
            step_for(a, WB_NS_PER_MS);
        assert_int_equal(wb_acquisition_stop_state(a)->state, WB_STOP_STANDING);
        latencies[i] = end_overload(shared);
        wb_acquisition_clear_stop(a);
        assert_int_equal(wb_acquisition_command(a, WB_STAGE_COMMAND_SOFT_RESET, 0.0, 0.0), WB_OK);
        step_for(a, 20 * WB_NS_PER_MS);
    }
    wb_acquisition_close(a);
}

/* A loop that does nothing else. */
static void answer(struct instruments *shared, const struct wb_rig *rig, double latencies[HOLDS])
{
    struct wb_stream *load, *stage;
    struct pollfd polled = {.events = POLLIN};
    int descriptors[2];
    assert_int_equal(wb_stream_open(&load, rig->load_cell.address), WB_OK);
    assert_int_equal(wb_stream_open(&stage, rig->stage.address), WB_OK);
    assert_int_equal(wb_stream_descriptors(load, descriptors), 1);
    polled.fd = descriptors[0];
    for (int i = 0; i < HOLDS; i++) {
        char bytes[256];
        size_t n;
        shared->asked = shared->sent + 1;
        do {
            poll(&polled, 1, 20);
            assert_int_equal(wb_stream_read(load, bytes, sizeof bytes, &n), WB_OK);
        } while (!memchr(bytes, 'O', n));
        assert_int_equal(wb_stream_write(stage, "!", 1), WB_OK);
        latencies[i] = end_overload(shared);
        /* Overloads that are still under way. */
        for (const int64_t end_ns = wb_time_now_ns() + 10 * WB_NS_PER_MS;
             wb_time_now_ns() < end_ns;) {
            poll(&polled, 1, 2);
            assert_int_equal(wb_stream_read(load, bytes, sizeof bytes, &n), WB_OK);
        }
    }
    wb_stream_close(load);
    wb_stream_close(stage);
}

static int compare(const void *a, const void *b)
{
    const double *const x = a, *const y = b;
    return (*x > *y) - (*x < *y);
}

static void print_latencies(const char *what, double latencies[HOLDS])
{
    qsort(latencies, HOLDS, sizeof *latencies, compare);
    printf("%s: min %.3f ms, median %.3f ms, max %.3f ms of %d\n", what, 1e3 * latencies[0],
           1e3 * latencies[HOLDS / 2], 1e3 * latencies[HOLDS - 1], HOLDS);
}

static void measure_hold(const struct wb_rig *like)
{
    double latencies[HOLDS];
    struct wb_rig rig = *like;
    struct instruments *const shared =
        mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    assert_true(shared != MAP_FAILED);
    const pid_t process = start_instruments(shared);
    snprintf(rig.load_cell.address, sizeof rig.load_cell.address, "pty:%s", shared->load);
    snprintf(rig.stage.address, sizeof rig.stage.address, "pty:%s", shared->stage);
    rig.time_scale = 1.0;
    wb_log_set_sink(discard_message, NULL); /* each overload is a warning */
    hold(shared, &rig, latencies);
    print_latencies("hold byte after the overload", latencies);
    printf("  goal %g ms\n", (double)WB_STOP_HOLD_NS / WB_NS_PER_MS);
    answer(shared, &rig, latencies);
    print_latencies("  baseline poll, read, write", latencies);
    wb_log_set_sink(NULL, NULL);
    end_process(process);
    munmap(shared, sizeof *shared);
}

int main(int argc, char **argv)
{
    const double seconds = argc > 1 ? atof(argv[1]) : 20.0;
    char folder[32], path[64], rig_path[64], raw[64];
    struct cost cost = {0};
    struct wb_rig rig;
    assert_true(temporary_folder_make(folder));
    snprintf(path, sizeof path, "%s/test.wbr", folder);
    snprintf(rig_path, sizeof rig_path, "%s/rig.yaml", folder);
    snprintf(raw, sizeof raw, "%s/raw", folder);
    pid_t process = start_rig(folder, rig_path);
    assert_int_equal(wb_rig_read(rig_path, &rig), WB_OK);
    record(&rig, path, seconds, &cost);
    end_process(process);
    process = start_rig(folder, rig_path);
    assert_int_equal(wb_rig_read(rig_path, &rig), WB_OK);
    const double baseline = copy(&rig, raw, fmin(seconds, 20.0));
    end_process(process);
    printf("recorded for %g s: %.0f readings/s, %.0f frames/s, %.1f reports/s, %" PRIu64
           " lost or dropped\n",
           seconds, (double)cost.readings / seconds, (double)cost.frames / seconds,
           (double)cost.reports / seconds, cost.drops);
    printf("CPU time: %.1f %% of one core; goal %.0f %%\n", 100.0 * cost.share, 100.0 * GOAL);
    printf("  baseline poll, read, write, fdatasync every 100 ms: %.1f %%; ratio %.2f\n",
           100.0 * baseline, cost.share / baseline);
    printf("memory: %.1f MiB after 5 s, %.1f MiB at the end\n", cost.first_MiB, cost.last_MiB);
    measure_hold(&rig);
    count_trials("Ten times a bench's rates", cost.readings + cost.frames,
                 "samples in %.0f s: %.1f %% of one core, %" PRIu64
                 " lost or dropped, memory %+.1f MiB",
                 seconds, 100.0 * cost.share, cost.drops, cost.last_MiB - cost.first_MiB);
    return temporary_folder_remove(folder);
}
