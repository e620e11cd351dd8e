/* Messages on stderr, redirected to a file. */
#include "base/log.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/check.h"

#include <cmocka.h>

#define WB_LOG_DOMAIN "test"

/* Captures stderr between start() and finish(). */
static int saved;
static FILE *file;

static void start(void)
{
    file = tmpfile();
    assert_non_null(file);
    fflush(stderr);
    saved = dup(STDERR_FILENO);
    assert_true(saved >= 0);
    assert_int_equal(dup2(fileno(file), STDERR_FILENO), STDERR_FILENO);
}

static void finish(char *text, size_t size)
{
    fflush(stderr);
    assert_int_equal(dup2(saved, STDERR_FILENO), STDERR_FILENO);
    close(saved);
    rewind(file);
    const size_t n = fread(text, 1, size - 1, file);
    text[n] = '\0';
    fclose(file);
}

static void a_message_erases_a_progress_line_once(void **state)
{
    char text[200];
    (void)state;
    start();
    fprintf(stderr, "progress: 1 of 3");
    wb_log_note_line(true);
    wb_warn("one");
    wb_warn("two");
    finish(text, sizeof text);
    assert_string_equal(text, "progress: 1 of 3\r\033[Kwirebench: warning: one\n"
                              "wirebench: warning: two\n");
}

static void a_message_after_a_finished_line_erases_nothing(void **state)
{
    char text[200];
    (void)state;
    start();
    wb_log_note_line(true);
    wb_log_note_line(false);
    wb_error("one");
    finish(text, sizeof text);
    assert_string_equal(text, "wirebench: error: one\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_message_erases_a_progress_line_once),
        cmocka_unit_test(a_message_after_a_finished_line_erases_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
