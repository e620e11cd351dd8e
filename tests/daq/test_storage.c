/* Recordings on failing storage: a power cut, a killed recorder, a full, slow or failing disk.
 * Flushed data are present, data received meanwhile are kept, and only written data are ever read.
 *
 * `test_storage [KILLS] [CUTS]` kills so many recorders and cuts the power so many times. */
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/mman.h>
#include <sys/wait.h>

#include "base/timing.h"
#include "base/units.h"
#include "daq/recording/recording_private.h"
#include "daq/recording/writer_private.h"
#include "fixtures/virtual/virtual_time.h"
#include "tests/daq/fault_vfs.h"
#include "tests/daq/gate.h"
#include "tests/daq/recording_fixture.h"
#include "tests/trials.h"

static uint64_t n_kills = 50, n_cuts = 1500;

static uint64_t random_state = 88172645463325252u;

static uint64_t random_below(uint64_t bound)
{
    random_state ^= random_state >> 12;
    random_state ^= random_state << 25;
    random_state ^= random_state >> 27;
    return (random_state * UINT64_C(2685821657736338717)) % bound;
}

/* --- power cut --- */

enum {
    FLUSHES = 60
};

/* Data flushed after this number of operations. */
struct flushed {
    size_t operations;
    int64_t chunks;
};

/* Writes a recording and notes the flushed data after each flush; closes it at the end. */
static void record_in_steps(const char *path, struct flushed flushed[FLUSHES + 1])
{
    struct wb_recording *recording = NULL;
    int64_t seq = 0;
    assert_int_equal(wb_recording_create(&recording, path), WB_OK);
    bench_fill(recording, 0);
    flushed[0] = (struct flushed){fault_vfs_operations(), 0};
    for (int i = 1; i <= FLUSHES; i++) {
        for (int k = 0; k < 1 + i % 4; k++, seq++) {
            for (int stream = 0; stream < 3; stream++) {
                uint8_t bytes[300];
                const size_t n = bench_bytes(stream, seq, bytes);
                assert_int_equal(wb_recording_append_chunk(recording, stream, seq,
                                                           bench_time(stream, seq), bytes, n),
                                 WB_OK);
            }
        }
        /* Occasional checkpoints, like those once a second. */
        if (i % 7 == 0)
            recording->checkpoint_ns -= 2 * WB_NS_PER_S;
        assert_int_equal(wb_recording_flush(recording), WB_OK);
        flushed[i] = (struct flushed){fault_vfs_operations(), 3 * seq};
    }
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

static void power_that_goes_leaves_what_was_flushed(void **state)
{
    struct bench *const bench = *state;
    struct flushed flushed[FLUSHES + 1];
    char after[96], path[128], index[136];
    fault_vfs_begin();
    record_in_steps(bench->path, flushed);
    fault_vfs_end();
    const size_t first = flushed[0].operations, last = fault_vfs_operations();
    snprintf(after, sizeof after, "%s/after", bench->folder);
    snprintf(path, sizeof path, "%s/test.wbr", after);
    snprintf(index, sizeof index, "%s-shm", path);
    assert_int_equal(mkdir(after, 0700), 0);
    uint64_t n_more = 0, n_complete = 0;
    for (uint64_t i = 0; i < n_cuts; i++) {
        struct wb_recording *recording = NULL;
        struct bench_tally tally;
        const size_t cut = first + random_below(last - first + 1);
        int64_t wanted = 0;
        for (int k = 0; k <= FLUSHES && flushed[k].operations <= cut; k++)
            wanted = flushed[k].chunks;
        unlink(index);
        fault_vfs_rebuild(after, cut, i + 1);
        if (wb_recording_open(&recording, path) != WB_OK)
            fail_msg("cut %zu: cannot be opened: %s", cut, bench->message);
        if (bench_walk(recording, &tally) != WB_OK || !tally.exact || tally.damaged > 0)
            fail_msg("cut %zu: it holds what was not written: %s", cut, bench->message);
        if (tally.chunks < wanted || tally.missing > 0)
            fail_msg("cut %zu: %lld of %lld chunks are there", cut, (long long)tally.chunks,
                     (long long)wanted);
        n_more += tally.chunks > wanted;
        n_complete += wb_recording_is_complete(recording);
        assert_int_equal(wb_recording_close(recording), WB_OK);
    }
    count_trials("A power cut while a recording is written", n_cuts,
                 "moments: all flushed data present, no other data than were written");
    /* All kinds of moments occurred. */
    assert_true(n_more > 0 && n_complete > 0 && n_complete < n_cuts);
}

/* --- killed recorder --- */

enum {
    RING = 4096
};

struct shared {
    atomic_int_least64_t pushed; /* chunks of stream 0 */
    atomic_int_least64_t safe;   /* of them on the disk according to the writer */
    atomic_int_least64_t worst_ns;
};

/* Writes a byte to `progress` whenever more chunks are on the disk. */
static void record_until_killed(const char *path, struct shared *shared, int progress)
{
    static int64_t pushed_ns[RING];
    struct wb_recording *recording = NULL;
    struct wb_writer *writer = NULL;
    struct wb_writer_settings settings;
    wb_writer_default_settings(&settings);
    settings.flush_interval_ns = 2 * WB_NS_PER_MS;
    if (wb_recording_create(&recording, path) != WB_OK)
        _exit(1);
    bench_fill(recording, 0);
    if (wb_writer_start(&writer, recording, &settings) != WB_OK)
        _exit(1);
    int64_t safe = 0, known_safe = 0;
    for (int64_t seq = 0;; seq++) {
        uint8_t bytes[300];
        struct wb_writer_state lag;
        const size_t n = bench_bytes(0, seq, bytes);
        pushed_ns[seq % RING] = wb_time_now_ns();
        if (!wb_writer_push_chunk(writer, 0, bench_time(0, seq), bytes, n))
            _exit(1);
        atomic_store(&shared->pushed, seq + 1);
        wb_writer_state(writer, &lag);
        const int64_t now_ns = wb_time_now_ns();
        /* Entries pushed before the oldest waiting one are on the disk. */
        while (safe < seq && safe + RING > seq && pushed_ns[safe % RING] < now_ns - lag.lag_ns &&
               lag.lag_ns > 0 && pushed_ns[(safe + 1) % RING] < now_ns - lag.lag_ns)
            safe++;
        atomic_store(&shared->safe, safe);
        if (safe > known_safe && write(progress, "", 1) != 1)
            _exit(1);
        known_safe = safe;
        if (lag.lag_ns > atomic_load(&shared->worst_ns))
            atomic_store(&shared->worst_ns, lag.lag_ns);
        usleep(50); /* between two chunks, as instruments send them */
    }
}

static void killed_recorders_leave_what_the_writer_called_safe(void **state)
{
    struct bench *const bench = *state;
    static const char *const endings[] = {"", "-wal", "-shm"};
    struct shared *const shared =
        mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    assert_true(shared != MAP_FAILED);
    uint64_t n_safe = 0, n_lost = 0;
    int64_t worst_ns = 0;
    for (uint64_t i = 0; i < n_kills; i++) {
        struct wb_recording *recording = NULL;
        struct bench_tally tally;
        int status, progress[2];
        char byte;
        atomic_store(&shared->pushed, 0);
        atomic_store(&shared->safe, 0);
        atomic_store(&shared->worst_ns, 0);
        fflush(NULL);
        assert_int_equal(pipe(progress), 0);
        const pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0)
            record_until_killed(bench->path, shared, progress[1]);
        close(progress[1]);
        const int64_t wanted = 11 + (int64_t)random_below(100);
        while (atomic_load(&shared->safe) < wanted)
            assert_int_equal(read(progress[0], &byte, 1), 1);
        /* Not only right after a flush. */
        const int64_t more = atomic_load(&shared->pushed) + (int64_t)random_below(60);
        while (atomic_load(&shared->pushed) < more && waitpid(child, &status, WNOHANG) == 0)
            sched_yield();
        close(progress[0]);
        assert_int_equal(kill(child, SIGKILL), 0);
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_true(WIFSIGNALED(status));
        const int64_t safe = atomic_load(&shared->safe), pushed = atomic_load(&shared->pushed);
        assert_int_equal(wb_recording_open(&recording, bench->path), WB_OK);
        assert_int_equal(bench_walk(recording, &tally), WB_OK);
        assert_true(tally.exact && tally.missing == 0 && tally.damaged == 0);
        /* One more may have been pushed and not counted yet. */
        assert_in_range(tally.chunks, safe, pushed + 1);
        n_safe += (uint64_t)safe;
        n_lost += (uint64_t)(pushed > tally.chunks ? pushed - tally.chunks : 0);
        worst_ns =
            atomic_load(&shared->worst_ns) > worst_ns ? atomic_load(&shared->worst_ns) : worst_ns;
        assert_int_equal(wb_recording_close(recording), WB_OK);
        for (size_t k = 0; k < 3; k++) {
            char path[128];
            snprintf(path, sizeof path, "%s%s", bench->path, endings[k]);
            unlink(path);
        }
    }
    munmap(shared, sizeof *shared);
    count_trials("A recorder is killed (SIGKILL)", n_kills,
                 "kills: of %llu chunks confirmed by the writer none is missing or wrong",
                 (unsigned long long)n_safe);
    print_message("%llu chunks that were not yet safe are gone; the disk was %.1f ms behind at "
                  "most\n",
                  (unsigned long long)n_lost, (double)worst_ns * 1e-6);
    assert_true(n_safe >= 11 * n_kills);
}

/* --- failing disk --- */

static int set_up_virtual_time(void **state)
{
    wb_virtual_time_begin(WB_VIRTUAL_TIME_HOST_DATE);
    return bench_set_up(state);
}

static int tear_down_virtual_time(void **state)
{
    wb_virtual_time_end();
    return bench_tear_down(state);
}

static struct wb_writer *start(const struct bench *bench, size_t capacity, int64_t patience_ns)
{
    struct wb_recording *recording = NULL;
    struct wb_writer *writer = NULL;
    struct wb_writer_settings settings;
    wb_writer_default_settings(&settings);
    settings.flush_interval_ns = WB_NS_PER_MS;
    settings.patience_ns = patience_ns;
    if (capacity > 0)
        settings.capacity_bytes = capacity;
    assert_int_equal(wb_recording_create(&recording, bench->path), WB_OK);
    bench_fill(recording, 0);
    assert_int_equal(wb_writer_start(&writer, recording, &settings), WB_OK);
    return writer;
}

static void push(struct wb_writer *writer, int64_t *seq, int64_t n)
{
    for (; n > 0; n--, ++*seq) {
        for (int stream = 0; stream < 3; stream++) {
            uint8_t bytes[300];
            const size_t size = bench_bytes(stream, *seq, bytes);
            (void)wb_writer_push_chunk(writer, stream, bench_time(stream, *seq), bytes, size);
        }
    }
}

/* In virtual time the writer has no thread: it writes when its flush is due. */
static void wait_until_failing(struct wb_writer *writer, bool failing)
{
    struct wb_writer_state now;
    do {
        wb_time_sleep(wb_time_now_ns() + WB_NS_PER_MS);
        wb_writer_tick(writer);
        wb_writer_state(writer, &now);
    } while (failing ? now.failing == WB_OK : now.failing != WB_OK || now.lag_ns > 0);
}

static const char *const fault_names[] = {[FAULT_FULL] = "a full disk",
                                          [FAULT_SHORT] = "short writes",
                                          [FAULT_IO] = "writes that fail",
                                          [FAULT_SYNC] = "syncs that fail"};

static void writing_goes_on_where_the_disk_stopped(void **state)
{
    struct bench *const bench = *state;
    uint64_t trials = 0;
    for (int fault = FAULT_FULL; fault < FAULT_KINDS; fault++) {
        fault_vfs_begin();
        struct wb_writer *const writer = start(bench, 0, 60 * WB_NS_PER_S);
        int64_t seq = 0;
        bench->messages = 0;
        for (int times = 0; times < 3; times++) {
            push(writer, &seq, 40);
            wait_until_failing(writer, false);
            fault_vfs_set((enum fault)fault);
            push(writer, &seq, 40);
            wait_until_failing(writer, true);
            push(writer, &seq, 300);
            assert_int_equal(wb_writer_status(writer), WB_OK);
            fault_vfs_set(FAULT_NONE);
            wait_until_failing(writer, false);
            trials++;
        }
        assert_int_equal(wb_writer_drops(writer, -1), 0);
        assert_int_equal(wb_writer_finish(writer), WB_OK);
        fault_vfs_end();
        if (bench->messages != 3)
            fail_msg("%s: %d messages, the last '%s'", fault_names[fault], bench->messages,
                     bench->message);
        struct wb_recording *const recording = bench_open(bench->path, true, 3 * seq);
        struct wb_recording_check check;
        assert_int_equal(wb_recording_check(recording, &check), WB_OK);
        assert_true(check.digest_fits && check.lost == 0 && check.displaced == 0);
        assert_int_equal(wb_recording_close(recording), WB_OK);
        assert_int_equal(unlink(bench->path), 0);
    }
    count_trials("A full disk, short writes, I/O errors, failing syncs", trials,
                 "failures: writing continues afterwards, nothing is lost");
}

/* A power cut after a failed sync and a successful one: the data of the failed sync must not count
 * as written before they are synced again. */
static void failed_sync_keeps_nothing(void **state)
{
    struct bench *const bench = *state;
    struct flushed before = {0}, after;
    struct wb_recording *recording = NULL;
    uint8_t bytes[300];
    fault_vfs_begin();
    assert_int_equal(wb_recording_create(&recording, bench->path), WB_OK);
    bench_fill(recording, 20);
    before.operations = fault_vfs_operations();
    fault_vfs_set(FAULT_SYNC);
    const size_t n = bench_bytes(0, 20, bytes);
    assert_int_equal(wb_recording_append_chunk(recording, 0, 20, bench_time(0, 20), bytes, n),
                     WB_OK);
    assert_int_not_equal(wb_recording_flush(recording), WB_OK);
    fault_vfs_set(FAULT_NONE);
    /* The same data again, without additions: now they are flushed. */
    assert_int_equal(wb_recording_append_chunk(recording, 0, 20, bench_time(0, 20), bytes, n),
                     WB_OK);
    assert_int_equal(wb_recording_flush(recording), WB_OK);
    after.operations = fault_vfs_operations();
    assert_int_equal(wb_recording_close(recording), WB_OK);
    fault_vfs_end();
    char folder[96], path[128], index[136];
    snprintf(folder, sizeof folder, "%s/after", bench->folder);
    snprintf(path, sizeof path, "%s/test.wbr", folder);
    snprintf(index, sizeof index, "%s-shm", path);
    assert_int_equal(mkdir(folder, 0700), 0);
    for (uint64_t i = 0; i < 40; i++) {
        for (size_t cut = before.operations; cut <= after.operations; cut++) {
            struct bench_tally tally;
            unlink(index);
            fault_vfs_rebuild(folder, cut, 100 * cut + i + 1);
            assert_int_equal(wb_recording_open(&recording, path), WB_OK);
            assert_int_equal(bench_walk(recording, &tally), WB_OK);
            assert_true(tally.exact);
            assert_in_range(tally.chunks, cut == after.operations ? 61 : 60, 61);
            assert_int_equal(wb_recording_close(recording), WB_OK);
        }
    }
}

static void memory_has_a_bound_and_what_it_cannot_keep_is_counted(void **state)
{
    struct bench *const bench = *state;
    fault_vfs_begin();
    struct wb_writer *const writer = start(bench, 20000, 60 * WB_NS_PER_S);
    struct wb_writer_counts counts;
    int64_t seq = 0;
    push(writer, &seq, 10);
    wait_until_failing(writer, false);
    fault_vfs_set(FAULT_FULL);
    push(writer, &seq, 1);
    wait_until_failing(writer, true);
    assert_int_equal(wb_writer_status(writer), WB_OK);
    push(writer, &seq, 200);
    /* The loop is notified while there is still some space. */
    assert_int_equal(wb_writer_status(writer), WB_ERR_IO);
    wb_writer_counts(writer, &counts);
    assert_true(counts.dropped_chunks > 0);
    assert_in_range(counts.most_waiting_bytes, 15000, 20000);
    fault_vfs_set(FAULT_NONE);
    wait_until_failing(writer, false);
    assert_int_equal(wb_writer_status(writer), WB_OK);
    push(writer, &seq, 10);
    const uint64_t drops = wb_writer_drops(writer, -1);
    assert_int_equal(wb_writer_finish(writer), WB_OK);
    fault_vfs_end();
    struct wb_recording *recording = NULL;
    struct bench_tally tally;
    assert_int_equal(wb_recording_open(&recording, bench->path), WB_OK);
    assert_int_equal(bench_walk(recording, &tally), WB_OK);
    assert_true(tally.exact);
    assert_int_equal((uint64_t)tally.chunks + drops, 3 * seq);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

static void failed_disk_keeps_flushed_data(void **state)
{
    struct bench *const bench = *state;
    fault_vfs_begin();
    struct wb_writer *const writer = start(bench, 0, 300 * WB_NS_PER_MS);
    int64_t seq = 0;
    push(writer, &seq, 50);
    wait_until_failing(writer, false);
    fault_vfs_set(FAULT_IO);
    push(writer, &seq, 50);
    wait_until_failing(writer, true);
    bench->messages = 0;
    assert_int_equal(wb_writer_finish(writer), WB_ERR_IO);
    /* First the amount in memory and how to save it, then the loss. */
    assert_int_equal(bench->messages, 2);
    assert_non_null(strstr(bench->message, "of the recording are lost"));
    fault_vfs_end();
    struct wb_recording *const recording = bench_open(bench->path, false, 150);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

/* --- hanging disk --- */

/* A push that waits for the disk would never return here. */
static void disk_that_hangs_never_holds_up_who_pushes(void **state)
{
    struct bench *const bench = *state;
    struct gate gate = GATE(false);
    fault_vfs_begin();
    struct wb_writer *const writer = start(bench, 0, 60 * WB_NS_PER_S);
    struct wb_writer_state now;
    int64_t seq = 0;
    gate_set(&gate, true);
    fault_vfs_on_sync(gate_pass, &gate);
    push(writer, &seq, 10);
    gate_await(&gate, 1);
    push(writer, &seq, 5000);
    /* The delay of the disk is visible while it hangs. */
    wb_writer_state(writer, &now);
    const int64_t lag_ns = now.lag_ns;
    assert_true(lag_ns > 0);
    do {
        wb_writer_state(writer, &now);
        assert_true(now.lag_ns >= lag_ns);
    } while (now.lag_ns < lag_ns + WB_NS_PER_MS);
    gate_set(&gate, false);
    assert_int_equal(wb_writer_drops(writer, -1), 0);
    assert_int_equal(wb_writer_finish(writer), WB_OK);
    fault_vfs_end();
    struct wb_recording *const recording = bench_open(bench->path, true, 3 * seq);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    count_trials("The disk hangs while chunks arrive", (uint64_t)(3 * seq),
                 "chunks: accepted without waiting, all recorded");
}

int main(int argc, char **argv)
{
    static const struct CMUnitTest tests[] = {
#define FACT(name) cmocka_unit_test_setup_teardown(name, bench_set_up, bench_tear_down)
#define IN_VIRTUAL_TIME(name)                                                                      \
    cmocka_unit_test_setup_teardown(name, set_up_virtual_time, tear_down_virtual_time)
        FACT(power_that_goes_leaves_what_was_flushed),
        FACT(killed_recorders_leave_what_the_writer_called_safe),
        IN_VIRTUAL_TIME(writing_goes_on_where_the_disk_stopped),
        FACT(failed_sync_keeps_nothing),
        IN_VIRTUAL_TIME(memory_has_a_bound_and_what_it_cannot_keep_is_counted),
        IN_VIRTUAL_TIME(failed_disk_keeps_flushed_data),
        FACT(disk_that_hangs_never_holds_up_who_pushes),
    };
    if (argc > 1)
        n_kills = strtoull(argv[1], NULL, 10);
    if (argc > 2)
        n_cuts = strtoull(argv[2], NULL, 10);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
