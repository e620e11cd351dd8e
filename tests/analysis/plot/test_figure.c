/* Scales, room for legends, and figures as bytes. */
#include "tests/check.h"
#include "tests/folder.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

#include <cairo.h>

#include "analysis/plot/figure_private.h"
#include "analysis/plot/layout.h"
#include "analysis/plot/place.h"
#include "analysis/plot/scale.h"
#include "analysis/plot/typeset.h"
#include "base/file.h"

/* --- scales --- */

static void ticks_are_round_within_the_range_and_not_too_many(void **state)
{
    (void)state;
    static const double ranges[][2] = {{0.0, 53.0},      {-3.0, 1.5},   {0.0, 1e-4},
                                       {4900.0, 5100.0}, {0.0, 0.0365}, {-1e6, 2e6}};
    for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++) {
        for (int most = 2; most < 12; most++) {
            struct wb_scale scale;
            wb_scale_fit(&scale, ranges[i][0], ranges[i][1], false);
            wb_scale_place_ticks(&scale, most);
            assert_true(scale.n_ticks >= 2 && scale.n_ticks <= most + 1);
            for (int k = 0; k < scale.n_ticks; k++) {
                const double span = scale.high - scale.low;
                assert_true(scale.ticks[k] >= scale.low - 1e-9 * span);
                assert_true(scale.ticks[k] <= scale.high + 1e-9 * span);
            }
            for (int k = 2; k < scale.n_ticks; k++)
                assert_close_relative(scale.ticks[k] - scale.ticks[k - 1],
                                      scale.ticks[1] - scale.ticks[0], 1e-6);
            const double step = scale.ticks[1] - scale.ticks[0];
            const double digits = step / pow(10.0, floor(log10(step) + 1e-9));
            assert_true(fabs(digits - 1.0) < 1e-6 || fabs(digits - 2.0) < 1e-6 ||
                        fabs(digits - 2.5) < 1e-6 || fabs(digits - 5.0) < 1e-6);
        }
    }
}

static void logarithmic_axes_have_two_labels(void **state)
{
    (void)state;
    static const double ranges[][2] = {
        {0.9, 1.1}, {0.03, 0.2}, {2.0, 3.0}, {1e-6, 1e3}, {4.0, 60.0}};
    for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++) {
        for (int most = 2; most < 12; most++) {
            struct wb_scale scale;
            wb_scale_fit(&scale, ranges[i][0], ranges[i][1], true);
            wb_scale_place_ticks(&scale, most);
            if (scale.n_ticks < 2)
                fail_msg("%d labels from %g to %g", scale.n_ticks, ranges[i][0], ranges[i][1]);
        }
    }
}

static void tick_labels_tell_the_tick(void **state)
{
    (void)state;
    struct wb_scale scale;
    wb_scale_fit(&scale, -0.02, 0.055, false);
    wb_scale_place_ticks(&scale, 6);
    for (int i = 0; i < scale.n_ticks; i++) {
        const char *text = scale.labels[i];
        const bool negative = strncmp(text, "\xe2\x88\x92", 3) == 0;
        assert_close((negative ? -1.0 : 1.0) * strtod(negative ? text + 3 : text, NULL),
                     scale.ticks[i], 1e-12);
    }
}

static void zero_near_the_data_is_taken_in_and_noise_around_it_does_not_move_it(void **state)
{
    (void)state;
    struct wb_scale scale;
    wb_scale_fit(&scale, 1.0, 10.0, false);
    assert_true(scale.low == 0.0);
    assert_true(scale.high > 10.0 && scale.high < 11.0);
    wb_scale_fit(&scale, -0.01, 10.0, false);
    assert_true(scale.low < 0.0 && scale.low > -0.5);
    wb_scale_fit(&scale, 8.0, 10.0, false);
    assert_true(scale.low > 7.0);
}

static void a_scale_without_data_or_extent_is_still_a_scale(void **state)
{
    (void)state;
    static const double ranges[][2] = {
        {(double)NAN, (double)NAN}, {5.0, 5.0}, {0.0, 0.0}, {-3.0, -3.0}, {2.0, 1.0}};
    for (size_t i = 0; i < 5; i++) {
        struct wb_scale scale;
        wb_scale_fit(&scale, ranges[i][0], ranges[i][1], false);
        assert_true(scale.low < scale.high);
        wb_scale_fit(&scale, ranges[i][0], ranges[i][1], true);
        assert_true(scale.low > 0.0 && scale.low < scale.high);
    }
}

static void a_logarithmic_scale_shows_powers_of_ten(void **state)
{
    (void)state;
    struct wb_scale scale;
    wb_scale_fit(&scale, 3e-5, 0.2, true);
    wb_scale_place_ticks(&scale, 5);
    assert_true(scale.n_ticks >= 3);
    for (int i = 0; i < scale.n_ticks; i++)
        assert_close(log10(scale.ticks[i]), round(log10(scale.ticks[i])), 1e-9);
    assert_close(wb_scale_position(&scale, sqrt(scale.low * scale.high)), 0.5, 1e-12);
    assert_true(isnan(wb_scale_position(&scale, 0.0)));
    /* Less than a power of ten still has labels. */
    wb_scale_fit(&scale, 0.013, 0.019, true);
    wb_scale_place_ticks(&scale, 6);
    assert_true(scale.n_ticks >= 1);
}

/* --- room --- */

static void a_box_is_placed_where_nothing_is_marked(void **state)
{
    (void)state;
    srand(7);
    for (int trial = 0; trial < 60; trial++) {
        struct wb_place *const place = wb_place_create(300.0, 200.0);
        double points[40][2];
        for (int i = 0; i < 40; i++) {
            points[i][0] = 300.0 * rand() / RAND_MAX;
            points[i][1] = 200.0 * rand() / RAND_MAX;
            wb_place_mark_segment(place, points[i][0], points[i][1], points[i][0], points[i][1],
                                  2.0);
        }
        struct wb_place_box box;
        if (wb_place_find(place, 50.0, 25.0, 3.0, &box)) {
            assert_close(box.width, 50.0, 1e-12);
            assert_true(box.x >= 0.0 && box.x + box.width <= 300.0);
            assert_true(box.y >= 0.0 && box.y + box.height <= 200.0);
            for (int i = 0; i < 40; i++)
                assert_false(points[i][0] > box.x - 1.0 && points[i][0] < box.x + box.width + 1.0 &&
                             points[i][1] > box.y - 1.0 && points[i][1] < box.y + box.height + 1.0);
        }
        wb_place_destroy(place);
    }
}

static void a_full_plot_has_no_room_and_an_empty_one_gives_a_corner(void **state)
{
    (void)state;
    struct wb_place *const place = wb_place_create(200.0, 100.0);
    struct wb_place_box box;
    assert_true(wb_place_find(place, 40.0, 20.0, 5.0, &box));
    assert_close(box.x, 5.0, 1e-9);
    assert_close(box.y, 5.0, 1e-9);
    assert_false(wb_place_find(place, 195.0, 20.0, 5.0, &box));
    for (int i = 0; i <= 100; i += 10)
        wb_place_mark_segment(place, 0.0, i, 200.0, i, 0.5);
    assert_false(wb_place_find(place, 40.0, 20.0, 5.0, &box));
    /* Far away and not a number: harmless. */
    wb_place_mark_segment(place, -1e300, (double)NAN, 1e300, 1e300, 1.0);
    wb_place_mark_segment(place, -1e12, 50.0, 1e12, 50.0, 1.0);
    wb_place_destroy(place);
}

/* --- figures --- */

#define POINTS 120

static struct wb_figure *make_figure(const char *name, int shape)
{
    struct wb_figure *figure;
    assert_int_equal(wb_figure_create(&figure, name, 320.0, 200.0), WB_OK);
    wb_figure_set_footer(figure, "measured (virtual rig)");
    struct wb_panel *const panel = wb_figure_add_panel(figure);
    wb_figure_set_axes(panel, "Deflection <i>d</i> (mm)", "Force (mN)");
    double x[POINTS], y[POINTS], low[POINTS], high[POINTS];
    for (int i = 0; i < POINTS; i++) {
        const double u = (double)i / (POINTS - 1);
        x[i] = 53.0 * u;
        y[i] = shape == 0   ? 120.0 * tanh(2.0 * u)
               : shape == 1 ? 120.0 * (1.0 - u)
               : shape == 2 ? 60.0 + 60.0 * sin(12.0 * u)
                            : 120.0 * u * u;
        low[i] = 0.95 * y[i];
        high[i] = 1.05 * y[i];
    }
    y[40] = (double)NAN;
    const struct wb_figure_style style = {.colour = wb_palette_wire(0), .width = 1.2};
    const struct wb_figure_style dots = {
        .colour = wb_palette_wire(1), .marker = WB_MARKER_CIRCLE, .marker_size = 3.0};
    const double *const edges[2] = {low, high};
    wb_figure_add_band(panel, "range of the samples", POINTS, x, edges,
                       wb_palette_fade(wb_palette_wire(0), 0.2));
    wb_figure_add_line(panel, "mean of the samples", POINTS, x, y, &style);
    wb_figure_add_line(panel, "points", POINTS, x, y, &dots);
    return figure;
}

static bool within(const struct wb_place_box *box, double x, double y)
{
    return x > box->x && x < box->x + box->width && y > box->y && y < box->y + box->height;
}

static void legends_and_insets_cover_no_data(void **state)
{
    (void)state;
    cairo_surface_t *const surface = cairo_image_surface_create(CAIRO_FORMAT_A8, 8, 8);
    cairo_t *const cairo = cairo_create(surface);
    for (int shape = 0; shape < 4; shape++) {
        for (int inset = 0; inset < 2; inset++) {
            struct wb_figure *const figure = make_figure("legend", shape);
            if (inset) {
                const double line[] = {0.0, 1.0};
                const struct wb_figure_style style = {.colour = wb_palette_ink(), .width = 1.0};
                wb_figure_add_line(wb_figure_add_inset(figure->panels[0]), NULL, 2, line, line,
                                   &style);
            }
            struct wb_layout layout;
            wb_layout_compute(&layout, figure, cairo);
            const struct wb_layout_panel *const panel = &layout.panels[0];
            assert_true(panel->has_legend);
            for (int k = 0; k < figure->panels[0]->n_series; k++) {
                const struct wb_series *const series = &figure->panels[0]->series[k];
                for (size_t i = 0; i < series->n; i++) {
                    const double x = wb_layout_x(panel, series->x[i]);
                    const double y = wb_layout_y(panel, series->y[i]);
                    assert_false(within(&panel->legend, x, y));
                    assert_false(inset && within(&layout.insets[0].room, x, y));
                }
            }
            wb_figure_destroy(figure);
        }
    }
    cairo_destroy(cairo);
    cairo_surface_destroy(surface);
}

static void a_legend_without_room_stands_outside_of_the_axes(void **state)
{
    (void)state;
    struct wb_figure *figure;
    assert_int_equal(wb_figure_create(&figure, "full", 200.0, 120.0), WB_OK);
    struct wb_panel *const panel = wb_figure_add_panel(figure);
    double x[400], y[400];
    for (int i = 0; i < 400; i++) {
        x[i] = i % 20;
        y[i] = i / 20;
    }
    const struct wb_figure_style style = {.colour = wb_palette_ink(), .marker = WB_MARKER_CIRCLE};
    wb_figure_add_line(panel, "everywhere", 400, x, y, &style);
    cairo_surface_t *const surface = cairo_image_surface_create(CAIRO_FORMAT_A8, 8, 8);
    cairo_t *const cairo = cairo_create(surface);
    struct wb_layout layout;
    wb_layout_compute(&layout, figure, cairo);
    assert_true(layout.panels[0].legend_outside);
    assert_true(layout.panels[0].legend.y + layout.panels[0].legend.height <=
                layout.panels[0].plot.y);
    cairo_destroy(cairo);
    cairo_surface_destroy(surface);
    wb_figure_destroy(figure);
}

static void an_inset_covers_no_data_when_the_legend_had_to_leave(void **state)
{
    (void)state;
    struct wb_figure *figure;
    assert_int_equal(wb_figure_create(&figure, "both", 300.0, 200.0), WB_OK);
    struct wb_panel *const panel = wb_figure_add_panel(figure);
    const struct wb_figure_style style = {.colour = wb_palette_ink(), .width = 1.0};
    /* Room in the upper left corner, but not for the inset and a long legend both. */
    double x[50], y[50];
    for (int i = 0; i < 50; i++) {
        x[i] = i;
        y[i] = i < 24 ? i % 2 : 20.0 * (i % 2) + 20.0;
    }
    wb_figure_add_line(panel, "a label so long that it takes a whole line of it", 50, x, y, &style);
    wb_figure_add_line(wb_figure_add_inset(panel), NULL, 50, x, y, &style);
    cairo_surface_t *const surface = cairo_image_surface_create(CAIRO_FORMAT_A8, 8, 8);
    cairo_t *const cairo = cairo_create(surface);
    struct wb_layout layout;
    wb_layout_compute(&layout, figure, cairo);
    assert_true(layout.panels[0].legend_outside);
    const struct wb_place_box *const room = &layout.insets[0].room;
    for (int i = 0; i < 50; i++)
        assert_false(within(room, wb_layout_x(&layout.panels[0], x[i]),
                            wb_layout_y(&layout.panels[0], y[i])));
    assert_true(room->y >= layout.panels[0].legend.y + layout.panels[0].legend.height);
    cairo_destroy(cairo);
    cairo_surface_destroy(surface);
    wb_figure_destroy(figure);
}

static void values_stand_where_the_scales_say(void **state)
{
    (void)state;
    struct wb_figure *const figure = make_figure("scales", 0);
    wb_figure_set_x_range(figure->panels[0], 0.0, 60.0);
    wb_figure_set_y_range(figure->panels[0], -10.0, 150.0);
    cairo_surface_t *const surface = cairo_image_surface_create(CAIRO_FORMAT_A8, 8, 8);
    cairo_t *const cairo = cairo_create(surface);
    struct wb_layout layout;
    wb_layout_compute(&layout, figure, cairo);
    const struct wb_layout_panel *const panel = &layout.panels[0];
    assert_close(wb_layout_x(panel, 0.0), panel->plot.x, 1e-9);
    assert_close(wb_layout_x(panel, 60.0), panel->plot.x + panel->plot.width, 1e-9);
    assert_close(wb_layout_y(panel, 150.0), panel->plot.y, 1e-9);
    assert_close(wb_layout_y(panel, -10.0), panel->plot.y + panel->plot.height, 1e-9);
    cairo_destroy(cairo);
    cairo_surface_destroy(surface);
    wb_figure_destroy(figure);
}

static void equal_aspect_gives_both_axes_the_same_unit(void **state)
{
    (void)state;
    struct wb_figure *const figure = make_figure("aspect", 3);
    wb_figure_set_equal_aspect(figure->panels[0]);
    cairo_surface_t *const surface = cairo_image_surface_create(CAIRO_FORMAT_A8, 8, 8);
    cairo_t *const cairo = cairo_create(surface);
    struct wb_layout layout;
    wb_layout_compute(&layout, figure, cairo);
    const struct wb_layout_panel *const panel = &layout.panels[0];
    const double x_unit = wb_layout_x(panel, 10.0) - wb_layout_x(panel, 0.0);
    const double y_unit = wb_layout_y(panel, 0.0) - wb_layout_y(panel, 10.0);
    assert_close_relative(x_unit, y_unit, 1e-9);
    cairo_destroy(cairo);
    cairo_surface_destroy(surface);
    wb_figure_destroy(figure);
}

static void the_same_description_gives_the_same_bytes(void **state)
{
    (void)state;
    struct wb_text bytes[2][3] = {0};
    for (int i = 0; i < 2; i++) {
        struct wb_figure *const figure = make_figure("same", 0);
        assert_int_equal(wb_figure_svg(figure, &bytes[i][0]), WB_OK);
        assert_int_equal(wb_figure_png(figure, 2.0, &bytes[i][1]), WB_OK);
        assert_int_equal(wb_figure_pdf(figure, "2026-11-20T10:00:00Z", &bytes[i][2]), WB_OK);
        wb_figure_destroy(figure);
        /* Other surfaces in between change Cairo's own counters. */
        struct wb_figure *const other = make_figure("other", 1);
        struct wb_text ignored = {0};
        assert_int_equal(wb_figure_svg(other, &ignored), WB_OK);
        wb_text_release(&ignored);
        wb_figure_destroy(other);
    }
    for (int k = 0; k < 3; k++) {
        assert_true(bytes[0][k].length > 1000);
        assert_int_equal(bytes[0][k].length, bytes[1][k].length);
        assert_memory_equal(bytes[0][k].bytes, bytes[1][k].bytes, bytes[0][k].length);
        wb_text_release(&bytes[0][k]);
        wb_text_release(&bytes[1][k]);
    }
}

static void svg_ids_are_the_figures_own(void **state)
{
    (void)state;
    struct wb_figure *const figure = make_figure("type1-cycles", 0);
    struct wb_text svg = {0};
    assert_int_equal(wb_figure_svg(figure, &svg), WB_OK);
    static const char *const marks[] = {" id=\"", "href=\"#", "url(#"};
    int n = 0;
    for (int i = 0; i < 3; i++) {
        for (const char *c = svg.bytes; (c = strstr(c, marks[i])); n++) {
            c += strlen(marks[i]);
            assert_memory_equal(c, "type1-cycles-", 13);
        }
    }
    assert_true(n > 20);
    wb_text_release(&svg);
    wb_figure_destroy(figure);
}

static void bad_names_and_sizes_are_refused(void **state)
{
    (void)state;
    struct wb_figure *figure;
    assert_int_equal(wb_figure_create(&figure, "../evil", 300.0, 200.0), WB_ERR_ARGUMENT);
    assert_null(figure);
    assert_int_equal(wb_figure_create(&figure, "", 300.0, 200.0), WB_ERR_ARGUMENT);
    assert_int_equal(wb_figure_create(&figure, "a", 300.0, -1.0), WB_ERR_ARGUMENT);
}

static void an_empty_figure_and_one_of_nothing_but_nan_can_be_drawn(void **state)
{
    (void)state;
    struct wb_figure *figure;
    assert_int_equal(wb_figure_create(&figure, "empty", 200.0, 100.0), WB_OK);
    struct wb_text svg = {0};
    assert_int_equal(wb_figure_svg(figure, &svg), WB_OK);
    wb_text_release(&svg);
    struct wb_panel *const panel = wb_figure_add_panel(figure);
    const double nan[] = {(double)NAN, (double)NAN};
    const struct wb_figure_style style = {
        .colour = wb_palette_ink(), .width = 1.0, .marker = WB_MARKER_SQUARE};
    wb_figure_add_line(panel, "nothing & <b>", 2, nan, nan, &style);
    const double *const edges[2] = {nan, nan};
    wb_figure_add_band(panel, NULL, 2, nan, edges, wb_palette_ink());
    wb_figure_set_logarithmic_y(panel);
    assert_int_equal(wb_figure_svg(figure, &svg), WB_OK);
    wb_text_release(&svg);
    wb_figure_destroy(figure);
    wb_figure_destroy(NULL);
}

static void files_are_written_whole_and_a_missing_folder_is_an_error(void **state)
{
    (void)state;
    char folder[32], path[WB_PATH];
    assert_true(temporary_folder_make(folder));
    struct wb_figure *const figure = make_figure("file", 0);
    assert_int_equal(wb_file_join(path, folder, "a.png"), WB_OK);
    assert_int_equal(wb_figure_write_file(figure, 1.0, path), WB_OK);
    char *bytes;
    size_t size;
    assert_int_equal(wb_file_read(path, &bytes, &size), WB_OK);
    assert_memory_equal(bytes, "\x89PNG", 4);
    free(bytes);
    unlink(path);
    assert_int_equal(wb_file_join(path, folder, "none/a.svg"), WB_OK);
    assert_int_not_equal(wb_figure_write_svg(figure, path), WB_OK);
    wb_figure_destroy(figure);
    rmdir(folder);
}

/* PNGs are drawn under a scale, and labels of y axes are turned. */
static void text_has_the_same_size_under_every_matrix(void **state)
{
    (void)state;
    cairo_surface_t *const surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, 100, 100);
    const struct wb_typeset_style style = {.size = 8.0};
    const char *const markup = "<i>F</i><sub>max</sub> 10<sup>3</sup>";
    struct wb_typeset_size sizes[3];
    for (int i = 0; i < 3; i++) {
        cairo_t *const cairo = cairo_create(surface);
        if (i == 1)
            cairo_scale(cairo, 3.0, 3.0);
        if (i == 2)
            cairo_rotate(cairo, -M_PI_2);
        sizes[i] = wb_typeset_measure(cairo, markup, &style);
        cairo_destroy(cairo);
    }
    assert_true(sizes[0].width > 10.0);
    for (int i = 1; i < 3; i++) {
        assert_close(sizes[i].width, sizes[0].width, 0.05);
        assert_close(sizes[i].height, sizes[0].height, 0.05);
    }
    cairo_surface_destroy(surface);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ticks_are_round_within_the_range_and_not_too_many),
        cmocka_unit_test(logarithmic_axes_have_two_labels),
        cmocka_unit_test(tick_labels_tell_the_tick),
        cmocka_unit_test(zero_near_the_data_is_taken_in_and_noise_around_it_does_not_move_it),
        cmocka_unit_test(a_scale_without_data_or_extent_is_still_a_scale),
        cmocka_unit_test(a_logarithmic_scale_shows_powers_of_ten),
        cmocka_unit_test(a_box_is_placed_where_nothing_is_marked),
        cmocka_unit_test(a_full_plot_has_no_room_and_an_empty_one_gives_a_corner),
        cmocka_unit_test(legends_and_insets_cover_no_data),
        cmocka_unit_test(a_legend_without_room_stands_outside_of_the_axes),
        cmocka_unit_test(an_inset_covers_no_data_when_the_legend_had_to_leave),
        cmocka_unit_test(text_has_the_same_size_under_every_matrix),
        cmocka_unit_test(values_stand_where_the_scales_say),
        cmocka_unit_test(equal_aspect_gives_both_axes_the_same_unit),
        cmocka_unit_test(the_same_description_gives_the_same_bytes),
        cmocka_unit_test(svg_ids_are_the_figures_own),
        cmocka_unit_test(bad_names_and_sizes_are_refused),
        cmocka_unit_test(an_empty_figure_and_one_of_nothing_but_nan_can_be_drawn),
        cmocka_unit_test(files_are_written_whole_and_a_missing_folder_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
