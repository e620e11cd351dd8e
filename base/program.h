/* Programs that this one runs: started, waited for, and what they print kept. */
#ifndef WB_BASE_PROGRAM_H
#define WB_BASE_PROGRAM_H

#include "base/status.h"
#include "base/text.h"

/* What it printed. */
struct wb_program_answer {
    struct wb_text out, err;
    int code; /* exit code; 128 + signal */
};

/* Runs a program of PATH and waits for it, through an interrupt as well. `words` is its command
 * line, NULL-terminated. WB_ERR_NOT_FOUND without a message when there is no such program,
 * WB_ERR_TIMEOUT with one when it did not end within `timeout` (s) and was killed. */
WB_MUST_CHECK enum wb_status wb_program_run(struct wb_program_answer *answer,
                                            const char *const *words, double timeout);
void wb_program_answer_release(struct wb_program_answer *answer);

#endif
