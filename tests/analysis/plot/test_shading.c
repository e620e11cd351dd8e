/* Fields as pixels: the colours of the map where they belong, and no seams. */
#include "tests/check.h"

#include <stdlib.h>

#include <cairo.h>

#include "analysis/plot/figure_private.h"

enum {
    SCALE = 2,
    SIZE = 200 /* pt of a figure */
};

struct reader {
    const struct wb_text *text;
    size_t at;
};

static cairo_status_t read_bytes(void *closure, unsigned char *bytes, unsigned int n)
{
    struct reader *const reader = closure;
    if (reader->at + n > reader->text->length)
        return CAIRO_STATUS_READ_ERROR;
    memcpy(bytes, reader->text->bytes + reader->at, n);
    reader->at += n;
    return CAIRO_STATUS_SUCCESS;
}

static cairo_surface_t *pixels_of(const struct wb_figure *figure)
{
    struct wb_text png = {0};
    assert_int_equal(wb_figure_png(figure, SCALE, &png), WB_OK);
    struct reader reader = {&png, 0};
    cairo_surface_t *const surface =
        cairo_image_surface_create_from_png_stream(read_bytes, &reader);
    assert_int_equal(cairo_surface_status(surface), CAIRO_STATUS_SUCCESS);
    wb_text_release(&png);
    return surface;
}

/* Largest difference of a channel, 0 to 255, between a pixel at (x, y) points and a colour. */
static double distance(cairo_surface_t *surface, double x, double y, struct wb_colour colour)
{
    const unsigned char *const row = cairo_image_surface_get_data(surface) +
                                     (int)(SCALE * y) * cairo_image_surface_get_stride(surface);
    uint32_t pixel;
    memcpy(&pixel, row + 4 * (int)(SCALE * x), sizeof pixel);
    const double channels[3] = {colour.red, colour.green, colour.blue};
    double largest = 0.0;
    for (int i = 0; i < 3; i++)
        largest = fmax(largest, fabs((double)(pixel >> (16 - 8 * i) & 0xff) - 255.0 * channels[i]));
    return largest;
}

/* n x n faces over [-1, 1]^2, turned by 27 degrees, with the values of `value`. */
static void make_faces(struct wb_contour_face *faces, int n, double (*value)(int face, double x))
{
    static const double at[8][2] = {{0, 0},   {1, 0},   {1, 1},   {0, 1},
                                    {0.5, 0}, {1, 0.5}, {0.5, 1}, {0, 0.5}};
    for (int i = 0; i < n * n; i++) {
        for (int k = 0; k < 8; k++) {
            const double x = -1.0 + 2.0 * (i % n + at[k][0]) / n;
            const double y = -1.0 + 2.0 * (i / n + at[k][1]) / n;
            faces[i].x[k] = 0.891 * x - 0.454 * y;
            faces[i].y[k] = 0.454 * x + 0.891 * y;
            faces[i].value[k] = value(i, x);
        }
    }
}

static double one(int face, double x)
{
    (void)face, (void)x;
    return 1.0;
}

static double by_face(int face, double x)
{
    (void)x;
    return 0.5 + face % 4;
}

static struct wb_figure *draw(const struct wb_contour_face *faces, int n,
                              const struct wb_figure_colours *colours)
{
    struct wb_figure *figure;
    assert_int_equal(wb_figure_create(&figure, "field", SIZE, SIZE), WB_OK);
    struct wb_panel *const panel = wb_figure_add_panel(figure);
    wb_figure_hide_axes(panel);
    wb_figure_set_equal_aspect(panel);
    wb_figure_set_x_range(panel, -1.5, 1.5);
    wb_figure_set_y_range(panel, -1.5, 1.5);
    wb_figure_add_field(panel, n, faces, colours);
    return figure;
}

static const struct wb_figure_colours four = {WB_PALETTE_SEQUENTIAL, 0.0, 4.0, 4, WB_OUTLINE_INK};

static void an_even_field_has_one_colour_without_seams(void **state)
{
    (void)state;
    struct wb_contour_face faces[64];
    make_faces(faces, 8, one);
    struct wb_figure *const figure = draw(faces, 64, &four);
    cairo_surface_t *const surface = pixels_of(figure);
    const struct wb_colour colour = wb_palette_map(WB_PALETTE_SEQUENTIAL, 1.5 / 4.0);
    for (double x = 65.0; x < 135.0; x += 0.5) {
        for (double y = 65.0; y < 135.0; y += 0.5)
            assert_true(distance(surface, x, y, colour) < 1.5);
    }
    cairo_surface_destroy(surface);
    wb_figure_destroy(figure);
}

/* Between cells of different values stands a mixture of colours of the map, never the ground. */
static void cells_of_different_values_leave_no_gap(void **state)
{
    (void)state;
    struct wb_contour_face faces[64];
    make_faces(faces, 8, by_face);
    struct wb_figure *const figure = draw(faces, 64, &four);
    cairo_surface_t *const surface = pixels_of(figure);
    const struct wb_colour white = {1.0, 1.0, 1.0, 1.0};
    int seen[4] = {0};
    for (double x = 65.0; x < 135.0; x += 0.5) {
        for (double y = 65.0; y < 135.0; y += 0.5) {
            /* The map's blue never is above 0.6. */
            assert_true(distance(surface, x, y, white) > 90.0);
            for (int k = 0; k < 4; k++)
                seen[k] += distance(surface, x, y,
                                    wb_palette_map(WB_PALETTE_SEQUENTIAL, (k + 0.5) / 4.0)) < 1.5;
        }
    }
    for (int k = 0; k < 4; k++)
        assert_true(seen[k] > 1000);
    cairo_surface_destroy(surface);
    wb_figure_destroy(figure);
}

static void a_hole_and_what_lies_apart_from_it_stay_open(void **state)
{
    (void)state;
    struct wb_contour_face all[64], faces[64];
    int n = 0;
    make_faces(all, 8, one);
    /* Without the middle, and without one row and column but for a corner. */
    for (int i = 0; i < 64; i++) {
        const int column = i % 8, row = i / 8;
        if ((column < 3 || column > 4 || row < 3 || row > 4) && (row != 6 || column == 7))
            faces[n++] = all[i];
    }
    struct wb_figure *const figure = draw(faces, n, &four);
    cairo_surface_t *const surface = pixels_of(figure);
    const struct wb_colour white = {1.0, 1.0, 1.0, 1.0};
    const struct wb_colour colour = wb_palette_map(WB_PALETTE_SEQUENTIAL, 1.5 / 4.0);
    for (int i = 0; i < 64; i++) {
        const double x = (i % 8 - 3.5) / 4.0, y = (i / 8 - 3.5) / 4.0;
        const double at_x = 100.0 + 100.0 / 1.5 * (0.891 * x - 0.454 * y) * 0.96;
        const double at_y = 100.0 - 100.0 / 1.5 * (0.454 * x + 0.891 * y) * 0.96;
        bool filled = false;
        for (int k = 0; k < n; k++)
            filled |= memcmp(&faces[k], &all[i], sizeof all[i]) == 0;
        assert_true(distance(surface, at_x, at_y, filled ? colour : white) < 1.5);
    }
    cairo_surface_destroy(surface);
    wb_figure_destroy(figure);
}

static void a_bar_goes_from_the_lowest_colour_to_the_highest(void **state)
{
    (void)state;
    struct wb_figure *figure;
    assert_int_equal(wb_figure_create(&figure, "bar", 60.0, SIZE), WB_OK);
    wb_figure_add_colour_bar(figure, &four, "MPa");
    cairo_surface_t *const surface = pixels_of(figure);
    /* Below the label, above half a tick's label; three points from the left. */
    for (int k = 0; k < 4; k++)
        assert_true(distance(surface, 7.0, 195.0 - 180.0 * (k + 0.5) / 4.0,
                             wb_palette_map(WB_PALETTE_SEQUENTIAL, (k + 0.5) / 4.0)) < 1.5);
    cairo_surface_destroy(surface);
    wb_figure_destroy(figure);
}

static void the_same_field_gives_the_same_bytes(void **state)
{
    (void)state;
    struct wb_contour_face faces[64];
    make_faces(faces, 8, by_face);
    struct wb_text svg[2] = {{0}, {0}};
    for (int i = 0; i < 2; i++) {
        struct wb_figure *const figure = draw(faces, 64, &four);
        assert_int_equal(wb_figure_svg(figure, &svg[i]), WB_OK);
        wb_figure_destroy(figure);
    }
    assert_int_equal(svg[0].length, svg[1].length);
    assert_memory_equal(svg[0].bytes, svg[1].bytes, svg[0].length);
    assert_true(svg[0].length < 60000);
    for (int i = 0; i < 2; i++)
        wb_text_release(&svg[i]);
}

static void colours_without_extent_fail_when_drawn(void **state)
{
    (void)state;
    struct wb_contour_face faces[64];
    make_faces(faces, 8, one);
    wb_log_set_sink(discard_message, NULL);
    const struct wb_figure_colours none = {WB_PALETTE_SEQUENTIAL, 1.0, 1.0, 4, WB_OUTLINE_INK};
    struct wb_figure *const figure = draw(faces, 64, &none);
    struct wb_text svg = {0};
    assert_true(wb_figure_svg(figure, &svg) != WB_OK);
    wb_log_set_sink(NULL, NULL);
    wb_text_release(&svg);
    wb_figure_destroy(figure);
}

/* A square with a square hole: filled between the two, and nowhere else. Lines are drawn on it. */
static void an_area_is_filled_up_to_its_hole(void **state)
{
    (void)state;
    static const double x[] = {-4, 4, 4, -4, (double)NAN, -2, 2, 2, -2};
    static const double y[] = {-4, -4, 4, 4, (double)NAN, -2, -2, 2, 2};
    static const double line_x[] = {-3, -3}, line_y[] = {-3, 3};
    const struct wb_colour blue = {0.0, 0.0, 1.0, 1.0}, red = {1.0, 0.0, 0.0, 1.0};
    const struct wb_colour white = {1.0, 1.0, 1.0, 1.0};
    const struct wb_figure_style style = {.colour = red, .width = 3.0};
    struct wb_figure *figure;
    assert_int_equal(wb_figure_create(&figure, "area", SIZE, SIZE), WB_OK);
    struct wb_panel *const panel = wb_figure_add_panel(figure);
    wb_figure_hide_axes(panel);
    wb_figure_set_equal_aspect(panel);
    wb_figure_set_x_range(panel, -5.0, 5.0);
    wb_figure_set_y_range(panel, -5.0, 5.0);
    wb_figure_add_line(panel, NULL, 2, line_x, line_y, &style);
    wb_figure_add_area(panel, NULL, 9, x, y, blue);
    cairo_surface_t *const surface = pixels_of(figure);
    const double middle = 0.5 * SIZE, unit = (SIZE - 5.0) / 10.0; /* with the margins */
    assert_close(distance(surface, middle, middle, white), 0.0, 1.0);
    assert_close(distance(surface, middle + 3.0 * unit, middle, blue), 0.0, 1.0);
    assert_close(distance(surface, middle, middle - 3.0 * unit, blue), 0.0, 1.0);
    assert_close(distance(surface, middle + 4.5 * unit, middle, white), 0.0, 1.0);
    assert_close(distance(surface, middle - 3.0 * unit, middle, red), 0.0, 1.0);
    cairo_surface_destroy(surface);
    wb_figure_destroy(figure);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_even_field_has_one_colour_without_seams),
        cmocka_unit_test(cells_of_different_values_leave_no_gap),
        cmocka_unit_test(a_hole_and_what_lies_apart_from_it_stay_open),
        cmocka_unit_test(a_bar_goes_from_the_lowest_colour_to_the_highest),
        cmocka_unit_test(the_same_field_gives_the_same_bytes),
        cmocka_unit_test(colours_without_extent_fail_when_drawn),
        cmocka_unit_test(an_area_is_filled_up_to_its_hole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
