/* Shared by the tests of jobs: a folder, the logged messages, and a worker: a function, and the
 * same as the test's own binary, called as `worker MODE ... -o FOLDER` instead of wirebench. */
#ifndef WB_TESTS_ANALYSIS_JOBS_JOBS_FIXTURE_H
#define WB_TESTS_ANALYSIS_JOBS_JOBS_FIXTURE_H

#include <stdbool.h>

#include "analysis/jobs/jobs.h"

/* The worker, according to its arguments; for main(), if argv[1] is "worker". */
int jobs_fixture_worker(int argc, char **argv);

/* Creates a new empty folder with a space and a quote in its name, and makes it the current one;
 * removes it with its contents. For cmocka's setup and teardown. */
int jobs_fixture_make_folder(void **state);
int jobs_fixture_remove_folder(void **state);
extern char jobs_fixture_folder[];

/* Messages since the last call of this are in jobs_fixture_said, one per line. */
void jobs_fixture_listen(void);
extern char jobs_fixture_said[16384];

/* A run named as its output is: `worker WORDS...`, up to four of them, NULL-terminated. */
struct jobs_fixture_run {
    const char *name;
    const char *words[5];
    double cost;
    bool replace;
};

/* Runs up to 16 of them with wb_jobs_run() and asserts its status. */
struct wb_jobs_outcome jobs_fixture_run(const struct jobs_fixture_run *runs, int n,
                                        const struct wb_jobs_options *options,
                                        enum wb_status expected);

/* Asserts the counts of the outcome. */
void jobs_fixture_expect(const struct wb_jobs_outcome *outcome, int present, int done, int failed,
                         int left);

/* Tests that an outdated output stays if the run that replaces it fails, and is removed when it
 * succeeds. */
void jobs_fixture_replace(const struct wb_jobs_options *options);

/* The text of a file, "" if there is none; whether a path exists; number of occurrences of `part`
 * in `text`. */
const char *jobs_fixture_text(const char *path);
bool jobs_fixture_is_there(const char *path);
int jobs_fixture_count(const char *text, const char *part);
void jobs_fixture_write(const char *path, const char *text);

#endif
