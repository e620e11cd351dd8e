/* `wirebench record RIG --virtual`: a test on a virtual bench in virtual time, within the process.
 */
#ifndef WB_CLI_VIRTUAL_TEST_H
#define WB_CLI_VIRTUAL_TEST_H

#include <stdint.h>

#include "base/status.h"
#include "base/text.h"
#include "daq/test/bend_test.h"
#include "fixtures/virtual/bench.h"

struct wb_virtual_test {
    struct wb_bench_settings settings; /* rig and specimen come from the request */
    int64_t start; /* date of the test, s since 1970; WB_VIRTUAL_TIME_HOST_DATE: the host's */
    /* While it runs. */
    struct wb_bench *bench;
    struct wb_text rig; /* the virtual bench's rig file */
};

/* Starts virtual time, puts the request's specimen on a virtual bench like that of its rig file,
 * and makes the request use that bench. The request must remain valid until the end. */
WB_MUST_CHECK enum wb_status wb_virtual_test_begin(struct wb_virtual_test *test,
                                                   struct wb_bend_test_request *request);
/* Removes the bench and returns to the time of the host. */
void wb_virtual_test_end(struct wb_virtual_test *test, struct wb_bend_test_request *request);

#endif
