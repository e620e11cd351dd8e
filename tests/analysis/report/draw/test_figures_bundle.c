/* Drawings of bundles' sections: what is in them, to scale. */
#include "tests/check.h"

#include <stdlib.h>

#include <cairo.h>

#include "analysis/plot/figure_private.h"
#include "analysis/plot/layout.h"
#include "analysis/report/draw/figures_bundle.h"
#include "base/file.h"

static struct wb_bundle_model models[3];
static const struct wb_bundle_model *const list[3] = {&models[0], &models[1], &models[2]};

static void read_shipped(struct wb_bundle_model *model, const char *name)
{
    char path[WB_PATH];
    assert_int_equal(wb_file_find_fixture(path, "bundles", name, NULL), WB_OK);
    assert_int_equal(wb_bundle_model_read(model, path), WB_OK);
}

static struct wb_figure *draw(int n, const char *mesh)
{
    struct wb_figure *figure;
    assert_int_equal(wb_figures_bundle_draw(&figure, "sections", n, list, mesh), WB_OK);
    assert_false(figure->failed);
    assert_int_equal(figure->n_panels, n);
    return figure;
}

static int read_models(void **state)
{
    (void)state;
    read_shipped(&models[0], "7-type3");
    read_shipped(&models[1], "12-type3");
    read_shipped(&models[2], "19-mixed");
    return 0;
}

static int count(const struct wb_panel *panel, enum wb_series_kind kind)
{
    int n = 0;
    for (int i = 0; i < panel->n_series; i++)
        n += panel->series[i].kind == kind;
    return n;
}

static bool says(const struct wb_panel *panel, const char *part)
{
    for (int i = 0; i < panel->n_series; i++) {
        const struct wb_series *const series = &panel->series[i];
        if (series->kind == WB_SERIES_TEXT && strstr(series->label, part))
            return true;
    }
    return false;
}

static void every_wire_and_the_tape_are_drawn(void **state)
{
    (void)state;
    struct wb_figure *const figure = draw(3, "engineering");
    for (int i = 0; i < 3; i++) {
        const struct wb_panel *const panel = figure->panels[i];
        /* The cylinder, the wires, the tape. */
        assert_int_equal(count(panel, WB_SERIES_AREA), 1 + models[i].packing.n + 1);
        assert_string_equal(panel->title, models[i].title);
    }
    assert_true(says(figure->panels[0], "= 4.60 mm") && says(figure->panels[0], "1 mm"));
    assert_true(says(figure->panels[0], "7 \xc3\x97 type3"));
    assert_true(says(figure->panels[1], "= 6.08 mm (printed: 5.80 mm)"));
    assert_true(says(figure->panels[2], "= 7.40 mm"));
    assert_true(says(figure->panels[2], "10 \xc3\x97 type3"));
    assert_true(says(figure->panels[2], "9 \xc3\x97 type2"));
    assert_false(says(figure->panels[2], "printed"));
    wb_figure_destroy(figure);
}

/* Areas are circles and rings where the model has them, in mm. */
static void wires_are_where_the_model_has_them(void **state)
{
    (void)state;
    struct wb_figure *const figure = draw(3, "engineering");
    const struct wb_panel *const panel = figure->panels[2];
    double drawn = 0.0, moment = 0.0, expected = 0.0, expected_moment = 0.0;
    int area = 0;
    for (int i = 0; i < panel->n_series; i++) {
        const struct wb_series *const s = &panel->series[i];
        if (s->kind != WB_SERIES_AREA || ++area == 1 || area == 21)
            continue;
        double y = 0.0, part = 0.0;
        for (size_t k = 0; k + 1 < s->n; k++) {
            part += 0.5 * (s->x[k] * s->y[k + 1] - s->x[k + 1] * s->y[k]);
            y += s->y[k] / (double)(s->n - 1);
        }
        drawn += part;
        moment += part * y * y;
    }
    for (int i = 0; i < models[2].packing.n; i++) {
        const struct wb_packing_circle *const wire = &models[2].packing.wire[i];
        expected += M_PI * wire->radius * wire->radius * 1e6;
        expected_moment += M_PI * wire->radius * wire->radius * wire->y * wire->y * 1e12;
    }
    assert_close_relative(drawn, expected, 2e-3);
    assert_close_relative(moment, expected_moment, 2e-3);
    wb_figure_destroy(figure);
}

static double points_of_a_mm(const struct wb_layout_panel *panel, bool vertical)
{
    return vertical ? wb_layout_y(panel, 0.0) - wb_layout_y(panel, 1.0)
                    : wb_layout_x(panel, 1.0) - wb_layout_x(panel, 0.0);
}

static void all_panels_have_one_scale_and_hold_their_section(void **state)
{
    (void)state;
    struct wb_figure *const figure = draw(3, "engineering");
    cairo_surface_t *const surface = cairo_image_surface_create(CAIRO_FORMAT_A8, 8, 8);
    cairo_t *const cairo = cairo_create(surface);
    struct wb_layout layout;
    wb_layout_compute(&layout, figure, cairo);
    const double scale = points_of_a_mm(&layout.panels[0], false);
    double foot = 0.0;
    for (int i = 0; i < 3; i++) {
        const struct wb_layout_panel *const panel = &layout.panels[i];
        const double r = 0.5e3 * wb_bundle_model_diameter(&models[i]);
        assert_close_relative(points_of_a_mm(panel, false), scale, 1e-6);
        assert_close_relative(points_of_a_mm(panel, true), scale, 1e-6);
        const struct wb_place_box *const plot = &panel->plot;
        assert_true(wb_layout_x(panel, -r) > plot->x);
        assert_true(wb_layout_x(panel, r) < plot->x + plot->width);
        assert_true(wb_layout_y(panel, r) > plot->y);
        assert_true(wb_layout_y(panel, -r) < plot->y + plot->height - 30.0);
        if (i == 0)
            foot = wb_layout_y(panel, -r);
        assert_close(wb_layout_y(panel, -r), foot, 1e-6);
    }
    cairo_destroy(cairo);
    cairo_surface_destroy(surface);
    wb_figure_destroy(figure);
}

static size_t points_of_lines(const struct wb_figure *figure)
{
    size_t n = 0;
    for (int i = 0; i < figure->panels[0]->n_series; i++)
        n += figure->panels[0]->series[i].kind == WB_SERIES_LINE ? figure->panels[0]->series[i].n
                                                                 : 0;
    return n;
}

static void a_finer_mesh_has_more_lines(void **state)
{
    (void)state;
    struct wb_figure *const rough = draw(1, "engineering"), *const fine = draw(1, "paper");
    /* Edges of an O-grid: 2 (quads) and half of the outline's; three points a line and its break.
     */
    const size_t more = 7 * 3 * (2 * (84 - 12));
    assert_true(points_of_lines(fine) > points_of_lines(rough) + more);
    assert_non_null(strstr(fine->footer, "84 quadrilaterals"));
    assert_non_null(strstr(rough->footer, "12 quadrilaterals"));
    wb_figure_destroy(rough);
    wb_figure_destroy(fine);
}

static void the_same_sections_give_the_same_bytes(void **state)
{
    (void)state;
    struct wb_text svg[2] = {{0}};
    for (int i = 0; i < 2; i++) {
        struct wb_figure *const figure = draw(2, "engineering");
        assert_int_equal(wb_figure_svg(figure, &svg[i]), WB_OK);
        wb_figure_destroy(figure);
    }
    assert_int_equal(svg[0].length, svg[1].length);
    assert_memory_equal(svg[0].bytes, svg[1].bytes, svg[0].length);
    wb_text_release(&svg[0]);
    wb_text_release(&svg[1]);
}

static void what_cannot_be_drawn_is_refused(void **state)
{
    (void)state;
    struct wb_figure *figure = NULL;
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_figures_bundle_draw(&figure, "a", 1, list, "none"), WB_ERR_NOT_FOUND);
    assert_null(figure);
    assert_int_equal(wb_figures_bundle_draw(&figure, "a", 0, list, "paper"), WB_ERR_ARGUMENT);
    assert_int_equal(wb_figures_bundle_draw(&figure, "a", 4, list, "paper"), WB_ERR_ARGUMENT);
    assert_int_equal(wb_figures_bundle_draw(&figure, "a/b", 1, list, "paper"), WB_ERR_ARGUMENT);
    assert_null(figure);
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_wire_and_the_tape_are_drawn),
        cmocka_unit_test(wires_are_where_the_model_has_them),
        cmocka_unit_test(all_panels_have_one_scale_and_hold_their_section),
        cmocka_unit_test(a_finer_mesh_has_more_lines),
        cmocka_unit_test(the_same_sections_give_the_same_bytes),
        cmocka_unit_test(what_cannot_be_drawn_is_refused),
    };
    return cmocka_run_group_tests(tests, read_models, NULL);
}
