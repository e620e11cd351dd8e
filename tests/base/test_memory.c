#include "base/memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/check.h"

static void arrays_are_zeroed_and_apart(void **unused)
{
    (void)unused;
    struct wb_memory memory = {0};
    unsigned char *arrays[40];
    for (int i = 0; i < 40; i++) {
        arrays[i] = wb_memory_take(&memory, (size_t)i, 3);
        for (int k = 0; k < 3 * i; k++)
            assert_int_equal(arrays[i][k], 0);
        memset(arrays[i], i, 3 * (size_t)i);
    }
    for (int i = 0; i < 40; i++)
        for (int k = 0; k < 3 * i; k++)
            assert_int_equal(arrays[i][k], i);
    wb_memory_release(&memory);
    assert_true(memory.blocks == NULL && memory.n == 0);
}

static void blocks_grow_and_texts_are_copied(void **unused)
{
    (void)unused;
    int *numbers = wb_memory_new(0, sizeof *numbers);
    assert_int_equal(*numbers, 0);
    *numbers = 7;
    numbers = wb_memory_resize(numbers, 1000, sizeof *numbers);
    assert_int_equal(*numbers, 7);
    free(numbers);
    const char *const text = "a wire";
    char *const copy = wb_memory_text(text);
    assert_true(copy != text);
    assert_string_equal(copy, text);
    free(copy);
}

static void room_doubles_and_keeps_its_contents(void **unused)
{
    (void)unused;
    size_t room = 0, last = 0;
    int *numbers = NULL, n_grown = 0;
    for (int i = 0; i < 5000; i++) {
        numbers = wb_memory_room(numbers, &room, (size_t)i + 1, sizeof *numbers);
        assert_true(room > (size_t)i && (room == last || room >= 2 * last));
        n_grown += room != last;
        last = room;
        numbers[i] = i;
    }
    assert_true(n_grown > 1 && n_grown < 15);
    numbers = wb_memory_room(numbers, &room, 100000, sizeof *numbers);
    assert_true(room >= 100000);
    for (int i = 0; i < 5000; i++)
        assert_int_equal(numbers[i], i);
    free(numbers);
}

/* The capacity is updated only after success: the owner of the block survives below
 * wb_memory_try(). */
static enum wb_status too_much_room(void *context)
{
    (void)wb_memory_room(NULL, context, SIZE_MAX / 2, 16);
    return WB_OK;
}

/* Larger than any memory: malloc() is not called. */
static enum wb_status too_much(void *context)
{
    (void)wb_memory_resize(NULL, SIZE_MAX / 2, 16);
    *(bool *)context = true;
    return WB_OK;
}

static enum wb_status need_nothing(void *context)
{
    wb_log_set_gravest(WB_LOG_DEBUG);
    (void)wb_memory_need(NULL);
    *(bool *)context = true;
    return WB_OK;
}

static enum wb_status try_within(void *context)
{
    assert_int_equal(wb_memory_try(too_much, context), WB_ERR_MEMORY);
    assert_true(wb_memory_is_guarded());
    return need_nothing(context);
}

static enum wb_status fail_otherwise(void *context)
{
    free(wb_memory_new(10, 10));
    *(bool *)context = true;
    return WB_ERR_DATA;
}

struct messages {
    int n;
    enum wb_log_level level;
};

static void count_messages(void *context, enum wb_log_level level, const char *domain,
                           const char *text)
{
    struct messages *const messages = context;
    (void)domain;
    assert_non_null(strstr(text, "out of memory"));
    messages->n++;
    messages->level = level;
}

static void tried_function_ends_at_the_allocation(void **unused)
{
    (void)unused;
    struct messages messages = {0};
    bool went_on = false;
    wb_log_set_sink(count_messages, &messages);
    assert_false(wb_memory_is_guarded());
    assert_int_equal(wb_memory_try(too_much, &went_on), WB_ERR_MEMORY);
    assert_int_equal(messages.n, 1);
    assert_int_equal(messages.level, WB_LOG_ERROR);
    assert_int_equal(wb_memory_try(need_nothing, &went_on), WB_ERR_MEMORY);
    assert_int_equal(messages.n, 2);
    assert_int_equal(messages.level, WB_LOG_ERROR);
    assert_int_equal(wb_log_set_gravest(WB_LOG_ERROR), WB_LOG_ERROR);
    assert_int_equal(wb_memory_try(try_within, &went_on), WB_ERR_MEMORY);
    assert_int_equal(messages.n, 4);
    size_t room = 3;
    assert_int_equal(wb_memory_try(too_much_room, &room), WB_ERR_MEMORY);
    assert_int_equal(room, 3);
    assert_false(went_on || wb_memory_is_guarded());
    wb_log_set_sink(NULL, NULL);
    assert_int_equal(wb_memory_try(fail_otherwise, &went_on), WB_ERR_DATA);
    assert_true(went_on && !wb_memory_is_guarded());
}

static void program_ends_with_one_message(void **unused)
{
    (void)unused;
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    const pid_t child = fork();
    if (child == 0) {
        bool went_on;
        dup2(ends[1], STDERR_FILENO);
        (void)too_much(&went_on);
        _exit(0);
    }
    close(ends[1]);
    char text[400];
    size_t n = 0;
    for (ssize_t got; (got = read(ends[0], text + n, sizeof text - 1 - n)) > 0;)
        n += (size_t)got;
    text[n] = '\0';
    close(ends[0]);
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == EXIT_FAILURE);
    const char *const newline = strchr(text, '\n');
    assert_non_null(strstr(text, "out of memory"));
    assert_true(newline && newline[1] == '\0');
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(arrays_are_zeroed_and_apart),
        cmocka_unit_test(blocks_grow_and_texts_are_copied),
        cmocka_unit_test(room_doubles_and_keeps_its_contents),
        cmocka_unit_test(tried_function_ends_at_the_allocation),
        cmocka_unit_test(program_ends_with_one_message),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
