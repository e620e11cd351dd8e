/* `wirebench record --series`: one test after another, each with its specimen, file name and the
 * operator's decision to keep or exclude it. */
#ifndef WB_CLI_RECORD_SERIES_H
#define WB_CLI_RECORD_SERIES_H

#include <stdbool.h>

#include "cli/record_views.h"
#include "daq/test/bend_test.h"

struct wb_record_series {
    const char *path;                 /* of the series' file */
    struct wb_bend_test_request test; /* rig (NULL: the file names it), operator, notes */
    struct wb_record_views_options views;
    struct wb_virtual_test *virtual; /* each test on a virtual bench of its own; NULL: real */
    const char *folder;              /* of the recordings; NULL: that of the series' file */
    const char *figure;              /* of all curves; NULL: none */
    bool json;
};

/* Runs the series, with questions on stderr and answers from stdin. Returns the exit code: 0 when
 * all specimens are done, 3 when it was stopped before. */
int wb_record_series_run(const struct wb_record_series *request);

#endif
