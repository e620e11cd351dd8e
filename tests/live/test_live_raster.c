/* Drawings of dots, and large digits, as text. */
#include <math.h>
#include <string.h>

#include "live/live_digits.h"
#include "live/live_raster.h"
#include "tests/check.h"

static struct wb_live_raster raster;
static char text[4];

static void set_dot(double x, double y)
{
    wb_live_raster_line(&raster, (double[]){x, y}, (double[]){x, y}, WB_LIVE_RASTER_NOW, 1);
}

static void each_dot_of_a_cell_is_its_bit_of_the_braille_pattern(void **state)
{
    (void)state;
    /* Names of the characters: BRAILLE PATTERN DOTS-1 to -8, left column 1 2 3 7 from the top. */
    static const char *const left[] = {"⠁", "⠂", "⠄", "⡀"}, *const right[] = {"⠈", "⠐", "⠠", "⢀"};
    for (int row = 0; row < 4; row++) {
        wb_live_raster_init(&raster, 2, 1, true);
        set_dot(0.5, 3.5 - row);
        set_dot(3.0, 3.0 - row);
        assert_string_equal(wb_live_raster_text(&raster, 0, 0, text), left[row]);
        assert_string_equal(wb_live_raster_text(&raster, 1, 0, text), right[row]);
    }
}

static void without_unicode_a_cell_has_two_dots(void **state)
{
    (void)state;
    wb_live_raster_init(&raster, 4, 1, false);
    for (int i = 1; i < 4; i++) {
        if (i & 1)
            set_dot(i, 1.0);
        if (i & 2)
            set_dot(i, 0.0);
    }
    assert_string_equal(wb_live_raster_text(&raster, 0, 0, text), "");
    assert_string_equal(wb_live_raster_text(&raster, 1, 0, text), "'");
    assert_string_equal(wb_live_raster_text(&raster, 2, 0, text), ".");
    assert_string_equal(wb_live_raster_text(&raster, 3, 0, text), ":");
}

static void points_outside_or_nan_are_not_drawn(void **state)
{
    (void)state;
    static const uint8_t none[WB_LIVE_RASTER_ROWS][WB_LIVE_RASTER_COLUMNS];
    const double places[][2] = {{-0.1, 0}, {0, -0.1},        {20, 0},
                                {0, 12},   {(double)NAN, 0}, {0, (double)INFINITY}};
    wb_live_raster_init(&raster, 10, 3, true);
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++)
        set_dot(places[i][0], places[i][1]);
    wb_live_raster_line(&raster, (double[]){0, (double)NAN}, (double[]){5, 5}, WB_LIVE_RASTER_NOW,
                        1);
    wb_live_raster_line(&raster, (double[]){0, 0}, (double[]){1e300, 0}, WB_LIVE_RASTER_NOW, 1);
    assert_memory_equal(raster.bits, none, sizeof none);
    wb_live_raster_init(&raster, 100000, 100000, true);
    assert_int_equal(raster.columns, WB_LIVE_RASTER_COLUMNS);
    assert_int_equal(raster.rows, WB_LIVE_RASTER_ROWS);
}

static void line_joins_its_ends_and_the_higher_layer_colours_a_cell(void **state)
{
    (void)state;
    wb_live_raster_init(&raster, 10, 5, true);
    wb_live_raster_line(&raster, (double[]){0, 0}, (double[]){19, 19}, WB_LIVE_RASTER_NOW, 1);
    for (int i = 0; i < 20; i++)
        assert_true(raster.bits[(19 - i) / 4][i / 2] != 0);
    wb_live_raster_line(&raster, (double[]){0, 0}, (double[]){19, 0}, WB_LIVE_RASTER_LIMIT, 1);
    assert_int_equal(raster.layer[4][0], WB_LIVE_RASTER_NOW);
    assert_int_equal(raster.layer[4][9], WB_LIVE_RASTER_LIMIT);
}

static void digits_are_three_rows_of_half_blocks(void **state)
{
    (void)state;
    static const char *const rows[] = {"▄█  ▀▀█   ", " █  █▀▀   ", "▀▀▀ ▀▀▀ ▀ "};
    char line[WB_LIVE_DIGITS_TEXT];
    for (int row = 0; row < WB_LIVE_DIGITS_ROWS; row++) {
        wb_live_digits_row("12.", row, line);
        assert_string_equal(line, rows[row]);
    }
    char many[400];
    memset(many, '8', sizeof many - 1);
    many[sizeof many - 1] = '\0';
    wb_live_digits_row(many, 0, line);
    assert_in_range(strlen(line), 100, WB_LIVE_DIGITS_TEXT - 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_dot_of_a_cell_is_its_bit_of_the_braille_pattern),
        cmocka_unit_test(without_unicode_a_cell_has_two_dots),
        cmocka_unit_test(points_outside_or_nan_are_not_drawn),
        cmocka_unit_test(line_joins_its_ends_and_the_higher_layer_colours_a_cell),
        cmocka_unit_test(digits_are_three_rows_of_half_blocks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
