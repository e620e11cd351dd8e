/* The chart of the live view as lines of text. */
#include "live/live_print.h"

#include <string.h>

#include "base/units.h"
#include "tests/check.h"

static struct wb_live_frame_point points[] = {
    {0.0f, 0.0f, 1},
    {0.010f, 0.040f, 1}, /* of test 1: straight up to the right */
    {0.010f, 0.0f, 2},
    {0.0f, 0.0f, 2}, /* of test 2: along the axis */
};
static const struct wb_live_history history = {.n_points = 4, .points = points};
static struct wb_live_plan plan = {.length = 0.085};

static struct wb_text print(bool is_unicode, bool is_coloured)
{
    const struct wb_live_print settings = {is_coloured ? 49 : 50, 13, is_unicode, is_coloured};
    struct wb_text text = {0};
    wb_live_print_curve(&settings, &plan, &history, &text);
    return text;
}

/* The line of a number from 0; its length in *n. */
static const char *line_of(const struct wb_text *text, int number, size_t *n)
{
    const char *line = wb_text_string(text);
    for (int i = 0; i < number; i++)
        line = strchr(line, '\n') + 1;
    *n = strcspn(line, "\n");
    return line;
}

static void curve_is_drawn_between_its_axes(void **state)
{
    (void)state;
    size_t n;
    struct wb_text text = print(false, false);
    const char *line = line_of(&text, 0, &n);
    assert_memory_equal(line, "tension (mN) over deflection (mm)", n);
    /* Ten rows, the axis, its numbers. */
    line = line_of(&text, 1, &n);
    assert_int_equal(n, 50);
    assert_memory_equal(line, "     40|", 8);
    /* Test 1 ends above the 10 of the axis and has half its force at half of the way. */
    const size_t end = 8 + strspn(line + 8, " ");
    line = line_of(&text, 6, &n);
    assert_memory_equal(line, "     20|", 8);
    assert_in_range(8 + strspn(line + 8, " "), 8 + (end - 8) / 2 - 3, 8 + (end - 8) / 2 + 1);
    /* Test 2 lies on the axis. */
    line = line_of(&text, 10, &n);
    assert_memory_equal(line, "      0|", 8);
    assert_int_equal(strspn(line + 8, ".:"), end - 8 + 1);
    line = line_of(&text, 11, &n);
    assert_memory_equal(line, "       +----", 12);
    line = line_of(&text, 12, &n);
    assert_memory_equal(line, "        0", 9);
    assert_memory_equal(line + end - 1, "10", 2);
    assert_null(strchr(wb_text_string(&text), '\033'));
    wb_text_release(&text);
}

static void last_cycle_is_bright_and_colours_end_with_their_line(void **state)
{
    (void)state;
    size_t n;
    plan.force_limit = 0.041; /* its line goes from edge to edge */
    struct wb_text text = print(true, true);
    plan.force_limit = 0.0;
    const char *const first = line_of(&text, 1, &n);
    assert_non_null(memmem(first, n, "\033[31m", 5));
    assert_non_null(memmem(first, n, "\033[90m", 5));
    assert_null(memmem(first, n, "\033[1;36m", 7));
    const char *const axis = line_of(&text, 10, &n);
    assert_non_null(memmem(axis, n, "\033[1;36m", 7));
    for (int row = 1; row <= 10; row++) {
        const char *const line = line_of(&text, row, &n);
        const char *last = memrchr(line, '\033', n);
        if (last)
            assert_memory_equal(last, "\033[m", 3);
    }
    wb_text_release(&text);
}

/* Twice as high as what is measured: the axis reaches up to it, in the faint colour. */
static void earlier_tests_are_faint_and_within_the_axes(void **state)
{
    (void)state;
    static const struct wb_live_frame_point earlier[] = {
        {0.0f, 0.0f, 2}, {0.010f, 0.080f, 2}, {0.0f, 0.080f, 7}, {0.010f, 0.080f, 7}};
    size_t n;
    plan.earlier = earlier;
    plan.n_earlier = 4;
    struct wb_text text = print(true, true);
    plan.n_earlier = 0;
    const char *const first = line_of(&text, 1, &n);
    assert_memory_equal(first, "     80", 7);
    assert_non_null(memmem(first, n, "\033[90m", 5));
    assert_null(memmem(first, n, "\033[1;36m", 7));
    /* The last cycle of this test has the number of an earlier one, and is bright all the same. */
    const char *const axis = line_of(&text, 10, &n);
    assert_non_null(memmem(axis, n, "\033[1;36m", 7));
    wb_text_release(&text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(earlier_tests_are_faint_and_within_the_axes),
        cmocka_unit_test(curve_is_drawn_between_its_axes),
        cmocka_unit_test(last_cycle_is_bright_and_colours_end_with_their_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
