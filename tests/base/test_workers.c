#include "base/workers.h"

#include <pthread.h>

#include "base/memory.h"
#include "tests/check.h"

enum {
    JOBS = 200
};

struct record {
    int times[JOBS], n_done, stops_after;
    pthread_t caller;
    bool is_inside, overlaps; /* of `done` */
    bool only_caller;
};

static enum wb_status count(void *context, int index)
{
    struct record *const record = context;
    record->times[index]++;
    if (!pthread_equal(pthread_self(), record->caller))
        record->only_caller = false;
    return index == 1 ? WB_ERR_DATA : WB_OK;
}

static bool record_end(void *context, int index, enum wb_status status)
{
    struct record *const record = context;
    if ((status == WB_OK) == (index == 1))
        fail_msg("job %d ended with %d", index, status);
    record->overlaps = record->overlaps || record->is_inside;
    record->is_inside = true;
    record->n_done++;
    record->is_inside = false;
    return record->stops_after == 0 || record->n_done < record->stops_after;
}

static int run(struct record *record, int n_threads)
{
    const struct wb_workers workers = {
        .n = JOBS, .n_threads = n_threads, .job = count, .done = record_end, .context = record};
    record->caller = pthread_self();
    record->only_caller = true;
    return wb_workers_run(&workers);
}

static void every_job_is_done_once(void **unused)
{
    (void)unused;
    const int threads[] = {1, 2, 16, 1000, 0};
    for (size_t k = 0; k < sizeof threads / sizeof *threads; k++) {
        struct record record = {.stops_after = 0};
        assert_int_equal(run(&record, threads[k]), JOBS);
        assert_int_equal(record.n_done, JOBS);
        assert_false(record.overlaps);
        for (int i = 0; i < JOBS; i++)
            assert_int_equal(record.times[i], 1);
    }
}

static void one_thread_runs_in_the_caller(void **unused)
{
    (void)unused;
    struct record record = {.stops_after = 0};
    (void)run(&record, 1);
    assert_true(record.only_caller);
}

static void no_job_begins_after_a_stop(void **unused)
{
    (void)unused;
    struct record record = {.stops_after = 3};
    assert_int_equal(run(&record, 1), 3);
    assert_int_equal(record.times[2], 1);
    assert_int_equal(record.times[3], 0);
    /* Jobs that other threads have started are finished. */
    record = (struct record){.stops_after = 3};
    const int done = run(&record, 4);
    assert_true(done >= 3 && done <= 3 + 3);
    assert_int_equal(record.n_done, done);
}

static void nothing_is_done_without_jobs(void **unused)
{
    (void)unused;
    const struct wb_workers workers = {.n = 0, .n_threads = 4, .job = count};
    assert_int_equal(wb_workers_run(&workers), 0);
}

static enum wb_status need_memory(void *context, int index)
{
    (void)context;
    if (index % 3 == 0)
        (void)wb_memory_need(NULL);
    return WB_OK;
}

struct ends {
    int n_without, n_told;
    int fails_at; /* number of the reported job that fails */
};

static bool count_ends(void *context, int index, enum wb_status status)
{
    struct ends *const ends = context;
    assert_int_equal(status, index % 3 == 0 ? WB_ERR_MEMORY : WB_OK);
    ends->n_without += status == WB_ERR_MEMORY;
    if (++ends->n_told == ends->fails_at)
        (void)wb_memory_need(NULL);
    return true;
}

static enum wb_status run_without_memory(void *context)
{
    struct ends *const ends = context;
    const struct wb_workers workers = {
        .n = JOBS, .n_threads = 4, .job = need_memory, .done = count_ends, .context = ends};
    const int done = wb_workers_run(&workers);
    return done == JOBS ? WB_OK : WB_ERR_DATA;
}

static void discard(void *context, enum wb_log_level level, const char *domain, const char *text)
{
    (void)context, (void)level, (void)domain, (void)text;
}

static void only_the_job_without_memory_fails(void **unused)
{
    (void)unused;
    struct ends ends = {0}, cut = {.fails_at = 5};
    wb_log_set_sink(discard, NULL);
    assert_int_equal(wb_memory_try(run_without_memory, &ends), WB_OK);
    assert_int_equal(ends.n_told, JOBS);
    assert_int_equal(ends.n_without, (JOBS + 2) / 3);
    assert_int_equal(wb_memory_try(run_without_memory, &cut), WB_ERR_DATA);
    assert_true(cut.n_told >= 5 && cut.n_told <= 5 + 3);
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_job_is_done_once),
        cmocka_unit_test(one_thread_runs_in_the_caller),
        cmocka_unit_test(no_job_begins_after_a_stop),
        cmocka_unit_test(nothing_is_done_without_jobs),
        cmocka_unit_test(only_the_job_without_memory_fails),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
