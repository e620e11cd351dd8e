/* One test of `wirebench record`, from the views' start to what is said at its end. */
#ifndef WB_CLI_RECORD_TEST_H
#define WB_CLI_RECORD_TEST_H

#include <stdio.h>

#include "base/status.h"
#include "cli/record_views.h"
#include "cli/virtual_test.h"
#include "daq/test/bend_test.h"

/* Runs the test with its views, on the terminal as well, or, where `virtual` is not NULL, on that
 * virtual bench in virtual time; sees that Ctrl-C stops the stage first.
 * The request receives what is known of the wire and what the views need. Says how the test
 * ended, and what was lost; *code receives the command's exit code for it. An error before the test
 * began was logged, and `result` is not set then. */
WB_MUST_CHECK enum wb_status wb_record_test_run(struct wb_bend_test_request *request,
                                                struct wb_record_views_options *options,
                                                struct wb_virtual_test *virtual,
                                                struct wb_bend_test_result *result, int *code);

/* Prints the outcome as one line. */
void wb_record_test_print(FILE *out, const struct wb_bend_test_result *result, const char *output);

#endif
