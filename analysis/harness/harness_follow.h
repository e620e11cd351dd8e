/* The lines of `wirebench solve harness --follow`: each line of JSON is a step or a command, and is
 * answered with one line of JSON. */
#ifndef WB_ANALYSIS_HARNESS_HARNESS_FOLLOW_H
#define WB_ANALYSIS_HARNESS_HARNESS_FOLLOW_H

#include <stdbool.h>

#include "analysis/harness/harness_session.h"
#include "analysis/keys/keys.h"
#include "base/text.h"

extern const struct wb_keys wb_harness_follow_keys;

/* Does what a line asks for and appends the answer with a newline. A wrong line is answered with an
 * error, and the session continues. Returns false after `quit`. `watch` may be NULL; it returns
 * false to stop a step. */
bool wb_harness_follow_answer(struct wb_harness_session *session, const char *line,
                              bool (*watch)(void *context, double fraction), void *context,
                              struct wb_text *answer);

#endif
