/* One test of `wirebench record`, with its live views and its messages at the end. */
#ifndef WB_CLI_RECORD_TEST_H
#define WB_CLI_RECORD_TEST_H

#include <stdio.h>

#include "base/status.h"
#include "cli/record_views.h"
#include "cli/virtual_test.h"
#include "daq/test/bend_test.h"

/* Runs the test with its views or, if `virtual` is not NULL, on that virtual bench in virtual time.
 * Ctrl-C stops the stage before anything else. Sets the wire's stiffness and the sink of the views
 * in the request. Reports how the test ended and which data were lost; *code receives the exit
 * code. An error before the start of the test is logged, and `result` is not set. */
WB_MUST_CHECK enum wb_status wb_record_test_run(struct wb_bend_test_request *request,
                                                struct wb_record_views_options *options,
                                                struct wb_virtual_test *virtual,
                                                struct wb_bend_test_result *result, int *code);

/* Prints the outcome as one line. */
void wb_record_test_print(FILE *out, const struct wb_bend_test_result *result, const char *output);

#endif
