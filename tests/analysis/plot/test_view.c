/* Pictures of surfaces in space: where they lie, what hides what, light and glass. */
#include "analysis/plot/view.h"

#include <stdlib.h>

#include "tests/check.h"

enum {
    SIZE = 120,
    AROUND = 8,
    STATIONS = 5
};

static const struct wb_view_camera front = {{0.0, 0.0, 1.0}, {0.0, 1.0, 0.0}};
static uint32_t pixels[SIZE * SIZE];

struct tube {
    double position[STATIONS * AROUND][3], value[STATIONS * AROUND];
};

/* A tube from `from` on along an axis (0: x, 1: y), 10 long. */
static struct wb_view_sheet make_tube(struct tube *tube, int axis, const double from[3],
                                      double radius, double value)
{
    for (int i = 0; i < STATIONS * AROUND; i++) {
        const double angle = 2.0 * M_PI * (i % AROUND) / AROUND;
        double *at = tube->position[i];
        memcpy(at, from, sizeof tube->position[i]);
        at[axis] += 10.0 * (i / AROUND) / (STATIONS - 1);
        at[1 - axis] += radius * cos(angle);
        at[2] += radius * sin(angle);
        tube->value[i] = value;
    }
    return (struct wb_view_sheet){
        .n_along = STATIONS,
        .n_around = AROUND,
        .closed = true,
        .position = (const double(*)[3])tube->position,
        .value = tube->value,
        .opacity = 1.0,
    };
}

/* The window is 12 x 12 round the origin: 10 pixels for a unit. */
static enum wb_status draw(int n, const struct wb_view_sheet *sheets,
                           const struct wb_view_camera *camera)
{
    const struct wb_view_scene scene = {
        .camera = *camera,
        .n_sheets = n,
        .sheets = sheets,
        .colours = {.map = WB_PALETTE_DIVERGING, .low = 0.0, .high = 1.0},
        .low = {-6.0, -6.0},
        .high = {6.0, 6.0},
        .width = SIZE,
        .height = SIZE,
    };
    return wb_view_draw(&scene, pixels);
}

static uint32_t pixel(double x, double y)
{
    return pixels[(int)(10.0 * (6.0 - y)) * SIZE + (int)(10.0 * (6.0 + x))];
}

static int red(uint32_t p)
{
    return p >> 16 & 255;
}

static int blue(uint32_t p)
{
    return p & 255;
}

static double covered(void)
{
    double sum = 0.0;
    for (int i = 0; i < SIZE * SIZE; i++)
        sum += (pixels[i] >> 24) / 255.0;
    return sum / 100.0;
}

static void places_project_along_the_view(void **unused)
{
    (void)unused;
    const struct wb_view_camera oblique = {{2.0, 0.0, 2.0}, {0.0, 3.0, 0.0}};
    const double place[3] = {1.0, 2.0, 3.0};
    double out[3];
    wb_view_project(&front, place, out);
    for (int i = 0; i < 3; i++)
        assert_close(out[i], place[i], 1e-15);
    wb_view_project(&oblique, place, out);
    assert_close(out[0], (1.0 - 3.0) / sqrt(2.0), 1e-15);
    assert_close(out[1], 2.0, 1e-15);
    assert_close(out[2], (1.0 + 3.0) / sqrt(2.0), 1e-15);
}

/* Eight nodes make a round tube: its outline is that of the circle through them within 1 %. */
static void a_tube_covers_its_outline(void **unused)
{
    (void)unused;
    struct tube tube;
    const struct wb_view_sheet sheet =
        make_tube(&tube, 0, (const double[3]){-5.0, 0.0, 0.0}, 2.0, 0.9);
    assert_int_equal(draw(1, &sheet, &front), WB_OK);
    assert_close_relative(covered(), 10.0 * 4.0, 0.01);
    assert_int_equal(pixel(0.0, 0.0) >> 24, 255);
    assert_int_equal(pixel(0.0, 2.3), 0);
    assert_int_equal(pixel(5.3, 0.0), 0);
    assert_true(red(pixel(0.0, 0.0)) > blue(pixel(0.0, 0.0)));
    /* Light comes from above and the left. */
    assert_true(red(pixel(0.0, 1.0)) > red(pixel(0.0, -1.0)) + 20);
}

static void what_is_near_hides_what_is_far(void **unused)
{
    (void)unused;
    for (int order = 0; order < 2; order++) {
        struct tube near, far;
        struct wb_view_sheet sheets[2];
        sheets[order] = make_tube(&near, 0, (const double[3]){-5.0, 0.0, 3.0}, 1.0, 0.95);
        sheets[1 - order] = make_tube(&far, 1, (const double[3]){0.0, -5.0, 0.0}, 1.0, 0.05);
        assert_int_equal(draw(2, sheets, &front), WB_OK);
        assert_true(red(pixel(0.0, 0.0)) > blue(pixel(0.0, 0.0)) + 50);
        assert_true(blue(pixel(0.0, 3.0)) > red(pixel(0.0, 3.0)) + 50);
        const struct wb_view_camera back = {{0.0, 0.0, -1.0}, {0.0, 1.0, 0.0}};
        assert_int_equal(draw(2, sheets, &back), WB_OK);
        assert_true(blue(pixel(0.0, 0.0)) > red(pixel(0.0, 0.0)) + 50);
    }
}

static void glass_lets_through_what_lies_behind_it_only(void **unused)
{
    (void)unused;
    struct tube tube, around;
    struct wb_view_sheet sheets[2] = {
        make_tube(&tube, 0, (const double[3]){-5.0, 0.0, 0.0}, 1.0, 0.95),
        make_tube(&around, 0, (const double[3]){-5.0, 0.0, 0.0}, 2.0, 0.0),
    };
    assert_int_equal(draw(1, sheets, &front), WB_OK);
    const uint32_t bare = pixel(0.0, 0.0);
    sheets[1].value = NULL;
    sheets[1].opacity = 0.3;
    sheets[1].tint = (struct wb_colour){0.0, 0.0, 1.0, 1.0};
    assert_int_equal(draw(2, sheets, &front), WB_OK);
    const uint32_t through = pixel(0.0, 0.0), beside = pixel(0.0, 1.5);
    assert_true(red(through) < red(bare) - 20 && red(through) > red(bare) / 2);
    assert_int_equal(through >> 24, 255);
    assert_in_range(beside >> 24, 40, 140);
    /* Colours are times alpha. */
    assert_true(blue(beside) <= (int)(beside >> 24));
    /* Behind the tube it is not seen. */
    for (int i = 0; i < STATIONS * AROUND; i++)
        around.position[i][2] -= 10.0;
    assert_int_equal(draw(2, sheets, &front), WB_OK);
    assert_int_equal(pixel(0.0, 0.0), bare);
}

static void ends_are_filled_where_it_is_asked_for(void **unused)
{
    (void)unused;
    const struct wb_view_camera along = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
    struct tube tube;
    struct wb_view_sheet sheet = make_tube(&tube, 0, (const double[3]){-5.0, 0.0, 0.0}, 2.0, 0.9);
    assert_int_equal(draw(1, &sheet, &along), WB_OK);
    assert_int_equal(pixel(0.0, 0.0), 0);
    sheet.capped = true;
    sheet.tint = (struct wb_colour){0.5, 0.5, 0.5, 1.0};
    assert_int_equal(draw(1, &sheet, &along), WB_OK);
    assert_int_equal(pixel(0.0, 0.0) >> 24, 255);
    assert_int_equal(red(pixel(0.0, 0.0)), blue(pixel(0.0, 0.0)));
    assert_close_relative(covered(), 4.0 * M_PI, 0.03);
}

static void the_same_scene_gives_the_same_pixels(void **unused)
{
    (void)unused;
    static uint32_t before[SIZE * SIZE];
    const struct wb_view_camera oblique = {{0.3, 0.4, 1.0}, {0.0, 1.0, 0.0}};
    struct tube tube;
    const struct wb_view_sheet sheet =
        make_tube(&tube, 1, (const double[3]){0.0, -5.0, 0.0}, 2.0, 0.4);
    assert_int_equal(draw(1, &sheet, &oblique), WB_OK);
    memcpy(before, pixels, sizeof before);
    assert_int_equal(draw(1, &sheet, &oblique), WB_OK);
    assert_memory_equal(before, pixels, sizeof before);
}

static void places_that_are_not_finite_leave_holes(void **unused)
{
    (void)unused;
    struct tube tube;
    const struct wb_view_sheet sheet =
        make_tube(&tube, 0, (const double[3]){-5.0, 0.0, 0.0}, 2.0, 0.9);
    tube.position[0][1] = (double)NAN;
    tube.position[9][2] = (double)INFINITY;
    tube.value[30] = (double)NAN;
    assert_int_equal(draw(1, &sheet, &front), WB_OK);
    assert_int_equal(pixel(4.5, 0.0) >> 24, 255);
    assert_true(covered() < 40.0);
}

static void impossible_scenes_are_refused(void **unused)
{
    (void)unused;
    struct tube tube;
    struct wb_view_sheet sheet = make_tube(&tube, 0, (const double[3]){0.0, 0.0, 0.0}, 2.0, 0.9);
    const struct wb_view_scene good = {
        .camera = front,
        .n_sheets = 1,
        .sheets = &sheet,
        .colours = {.low = 0.0, .high = 1.0},
        .low = {-6.0, -6.0},
        .high = {6.0, 6.0},
        .width = SIZE,
        .height = SIZE,
    };
    struct wb_view_scene bad[4] = {good, good, good, good};
    bad[0].width = 0;
    bad[1].height = 8001;
    bad[2].high[1] = -6.0;
    bad[3].colours.high = 0.0;
    wb_log_set_sink(discard_message, NULL);
    for (int i = 0; i < 4; i++)
        assert_int_equal(wb_view_draw(&bad[i], pixels), WB_ERR_ARGUMENT);
    sheet.n_along = 1;
    assert_int_equal(wb_view_draw(&good, pixels), WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places_project_along_the_view),
        cmocka_unit_test(a_tube_covers_its_outline),
        cmocka_unit_test(what_is_near_hides_what_is_far),
        cmocka_unit_test(glass_lets_through_what_lies_behind_it_only),
        cmocka_unit_test(ends_are_filled_where_it_is_asked_for),
        cmocka_unit_test(the_same_scene_gives_the_same_pixels),
        cmocka_unit_test(places_that_are_not_finite_leave_holes),
        cmocka_unit_test(impossible_scenes_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
