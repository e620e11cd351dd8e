#include "cli/solve_harness_follow.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/harness/harness_follow.h"
#include "base/interrupt.h"

#define WB_LOG_DOMAIN "solve"

static bool watch(void *context, double fraction)
{
    (void)context, (void)fraction;
    return !wb_interrupted();
}

static enum wb_status print(struct wb_text *answer)
{
    const bool is_printed = fputs(wb_text_string(answer), stdout) >= 0 && fflush(stdout) == 0;
    wb_text_release(answer);
    return is_printed
               ? WB_OK
               : wb_fail(WB_ERR_IO, "standard output cannot be written: %s", strerror(errno));
}

enum wb_status wb_solve_harness_follow(const struct wb_harness_plan *plan,
                                       const struct wb_harness_settings *settings)
{
    struct wb_harness_session *session;
    char *line = NULL;
    size_t room = 0;
    ssize_t length;
    WB_TRY(wb_harness_session_create(&session, plan, settings));
    enum wb_status status = WB_OK;
    bool goes_on = true;
    while (status == WB_OK && goes_on && !wb_interrupted() &&
           (length = getline(&line, &room, stdin)) >= 0) {
        struct wb_text answer = {0};
        /* What follows a NUL would be left out: no such line is valid with this in its place. */
        for (ssize_t i = 0; i < length; i++)
            line[i] = line[i] ? line[i] : '\1';
        goes_on = wb_harness_follow_answer(session, line, watch, NULL, &answer);
        status = print(&answer);
    }
    free(line);
    wb_harness_session_destroy(session);
    return status;
}
