/* Runs other programs: starts them, waits for them, and stores their output. */
#ifndef WB_BASE_PROGRAM_H
#define WB_BASE_PROGRAM_H

#include "base/status.h"
#include "base/text.h"

/* Output and exit code. */
struct wb_program_answer {
    struct wb_text out, err;
    int code; /* exit code; 128 + signal */
};

/* Runs a program from PATH and waits for it, also through an interrupt. `words` is its command
 * line, NULL-terminated. WB_ERR_NOT_FOUND without a message if there is no such program;
 * WB_ERR_TIMEOUT with a message if it did not finish within `timeout` (s) and was killed. */
WB_MUST_CHECK enum wb_status wb_program_run(struct wb_program_answer *answer,
                                            const char *const *words, double timeout);
void wb_program_answer_release(struct wb_program_answer *answer);

#endif
