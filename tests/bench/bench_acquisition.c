/* What recording costs at ten times a bench's rates: 800 readings, 1200 frames of 7 markers a
 * second, and a stage that is asked, from a bench in a process of its own. CPU time of the whole
 * recorder (loop, decoders, writer) and how its memory grows; the baseline in the same run waits
 * for the same bytes with poll(), reads them and writes them to a file with fdatasync() every 100
 * ms. `bench_acquisition SECONDS` runs for so long, default 20. */
#define FAKE_LOAD_PERIOD_NS (WB_NS_PER_MS * 5 / 4)
#define FAKE_FRAME_PERIOD_NS (WB_NS_PER_MS * 5 / 6)
#include "base/interrupt.h"
#include "base/timing.h"
#include "daq/stream/stream.h"
#include "tests/daq/fake_bench.h"
#include "tests/folder.h"
#include "tests/trials.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>

#define GOAL 0.3 /* of one core */

/* What the other process tells of its bench. */
struct addresses {
    char load_path[64], stage_path[64];
    int port;
};

static pid_t start_bench(struct addresses *addresses)
{
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    const pid_t process = fork();
    assert_true(process >= 0);
    if (process == 0) {
        struct fake_bench *const bench = fake_start();
        struct addresses own = {.port = bench->port};
        memcpy(own.load_path, bench->load_path, sizeof own.load_path);
        memcpy(own.stage_path, bench->stage_path, sizeof own.stage_path);
        if (write(ends[1], &own, sizeof own) != sizeof own)
            _exit(1);
        for (;;)
            pause();
    }
    assert_int_equal(read(ends[0], addresses, sizeof *addresses), sizeof *addresses);
    close(ends[0]);
    close(ends[1]);
    return process;
}

static void end_bench(pid_t process)
{
    kill(process, SIGKILL);
    waitpid(process, NULL, 0);
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
static double copy(const struct addresses *from, const char *path, double seconds)
{
    char address[96];
    struct wb_stream *streams[2];
    snprintf(address, sizeof address, "pty:%s", from->load_path);
    assert_int_equal(wb_stream_open(&streams[0], address), WB_OK);
    snprintf(address, sizeof address, "udp:127.0.0.1:%d", from->port);
    assert_int_equal(wb_stream_open(&streams[1], address), WB_OK);
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

int main(int argc, char **argv)
{
    const double seconds = argc > 1 ? atof(argv[1]) : 20.0;
    char folder[32], path[64], rig_path[64], raw[64];
    struct addresses addresses;
    struct cost cost = {0};
    struct wb_rig rig;
    assert_true(temporary_folder_make(folder));
    snprintf(path, sizeof path, "%s/test.wbr", folder);
    snprintf(rig_path, sizeof rig_path, "%s/rig.yaml", folder);
    snprintf(raw, sizeof raw, "%s/raw", folder);
    pid_t process = start_bench(&addresses);
    struct fake_bench bench = {.port = addresses.port};
    memcpy(bench.load_path, addresses.load_path, sizeof bench.load_path);
    memcpy(bench.stage_path, addresses.stage_path, sizeof bench.stage_path);
    fake_write_rig(&bench, rig_path, 1.0, 5.0);
    assert_int_equal(wb_rig_read(rig_path, &rig), WB_OK);
    record(&rig, path, seconds, &cost);
    end_bench(process);
    process = start_bench(&addresses);
    const double baseline = copy(&addresses, raw, fmin(seconds, 20.0));
    end_bench(process);
    printf("recorded for %g s: %.0f readings/s, %.0f frames/s, %.1f reports/s, %" PRIu64
           " lost or dropped\n",
           seconds, (double)cost.readings / seconds, (double)cost.frames / seconds,
           (double)cost.reports / seconds, cost.drops);
    printf("CPU time: %.1f %% of one core; goal %.0f %%\n", 100.0 * cost.share, 100.0 * GOAL);
    printf("  baseline poll, read, write, fdatasync every 100 ms: %.1f %%; ratio %.2f\n",
           100.0 * baseline, cost.share / baseline);
    printf("memory: %.1f MiB after 5 s, %.1f MiB at the end\n", cost.first_MiB, cost.last_MiB);
    count_trials("Ten times a bench's rates", cost.readings + cost.frames,
                 "samples in %.0f s: %.1f %% of one core, %" PRIu64
                 " lost or dropped, memory %+.1f MiB",
                 seconds, 100.0 * cost.share, cost.drops, cost.last_MiB - cost.first_MiB);
    return temporary_folder_remove(folder);
}
