/* What the tests of many runs share: a folder to work in, messages that were said, and a worker:
 * a function, and the same as the test's own binary, called as `worker MODE ... -o FOLDER` in the
 * place of wirebench. */
#ifndef WB_TESTS_ANALYSIS_JOBS_JOBS_FIXTURE_H
#define WB_TESTS_ANALYSIS_JOBS_JOBS_FIXTURE_H

#include <stdbool.h>

#include "analysis/jobs/jobs.h"

/* The work of a worker, as its arguments say; for main(), when argv[1] is "worker". */
int jobs_fixture_worker(int argc, char **argv);

/* A new empty folder with a space and a quote in its name, which becomes the current one; its
 * removal with all in it. For cmocka's setup and teardown. */
int jobs_fixture_make_folder(void **state);
int jobs_fixture_remove_folder(void **state);
extern char jobs_fixture_folder[];

/* Messages since the last call of this are in jobs_fixture_said, a line each. */
void jobs_fixture_listen(void);
extern char jobs_fixture_said[16384];

/* A run named as its output is: `worker WORDS...`, up to four of them, NULL-terminated. */
struct jobs_fixture_run {
    const char *name;
    const char *words[5];
    double cost;
    bool replace;
};

/* Runs up to 16 of them by wb_jobs_run() and expects `expected`. */
struct wb_jobs_outcome jobs_fixture_run(const struct jobs_fixture_run *runs, int n,
                                        const struct wb_jobs_options *options,
                                        enum wb_status expected);

/* What became of the runs. */
void jobs_fixture_expect(const struct wb_jobs_outcome *outcome, int present, int done, int failed,
                         int left);

/* An outdated output stays when the run that replaces it fails, and goes when it is made. */
void jobs_fixture_replace(const struct wb_jobs_options *options);

/* The text of a file, "" when there is none; whether something is there; how often `part` is in
 * `text`. */
const char *jobs_fixture_text(const char *path);
bool jobs_fixture_is_there(const char *path);
int jobs_fixture_count(const char *text, const char *part);
void jobs_fixture_write(const char *path, const char *text);

#endif
