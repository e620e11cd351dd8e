/* Messages that a test provokes: kept, so that it can ask what they say.
 *
 *     keep_messages();
 *     assert_int_equal(wb_wire_read(&wire, path), WB_ERR_FORMAT);
 *     assert_message("bad.yaml:3: ");
 *
 * Each test file has its own; messages go to stderr again with release_messages().
 */
#ifndef WB_TESTS_MESSAGES_H
#define WB_TESTS_MESSAGES_H

#include "tests/check.h"

static struct {
    char last[2048];         /* of any level */
    char error[2048];        /* the last error */
    int n;                   /* of any level */
    enum wb_log_level level; /* of the last */
    char domain[32];
} kept;

static inline void keep_message(void *context, enum wb_log_level level, const char *domain,
                                const char *message)
{
    (void)context;
    snprintf(kept.last, sizeof kept.last, "%s", message);
    if (level == WB_LOG_ERROR)
        snprintf(kept.error, sizeof kept.error, "%s", message);
    kept.n++;
    kept.level = level;
    snprintf(kept.domain, sizeof kept.domain, "%s", domain);
}

/* Forgets what was kept and keeps from now on. */
static inline void keep_messages(void)
{
    memset(&kept, 0, sizeof kept);
    wb_log_set_sink(keep_message, NULL);
}

static inline void release_messages(void)
{
    wb_log_set_sink(NULL, NULL);
}

/* Fails unless the last message holds `part`. */
#define assert_message(part)                                                                       \
    do {                                                                                           \
        if (!strstr(kept.last, (part)))                                                            \
            fail_msg("'%s' does not say '%s'", kept.last, (part));                                 \
    } while (0)

#endif
