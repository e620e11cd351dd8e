/* Drawings of bent bundles: what is in them, colours, the same bytes. */
#include "analysis/report/draw/figures_surface.h"

#include <stdlib.h>

#include "analysis/plot/figure_private.h"
#include "tests/check.h"

enum {
    WIRES = 3,
    AROUND = 8,
    ALONG = 12
};

static struct wb_surface surface;

/* Three wires of 100 mm bent to a circle of 100 mm, within a tape; stress falls to the tip. */
static int make_surface(void **state)
{
    (void)state;
    surface.n = WIRES + 1;
    surface.bodies = calloc(WIRES + 1, sizeof *surface.bodies);
    assert_non_null(surface.bodies);
    for (int b = 0; b <= WIRES; b++) {
        struct wb_surface_body *body = &surface.bodies[b];
        const bool is_tape = b == WIRES;
        *body = (struct wb_surface_body){is_tape, true, AROUND, ALONG, NULL};
        body->nodes = calloc(AROUND * ALONG, sizeof *body->nodes);
        assert_non_null(body->nodes);
        for (int i = 0; i < AROUND * ALONG; i++) {
            const double angle = 2.0 * M_PI * (i % AROUND) / AROUND,
                         turn = (double)(i / AROUND) / (ALONG - 1);
            const double place = 2.0 * M_PI * b / WIRES, r = is_tape ? 1.6e-3 : 0.7e-3;
            const double y = r * cos(angle) + (is_tape ? 0.0 : 0.81e-3 * cos(place));
            const double z = r * sin(angle) + (is_tape ? 0.0 : 0.81e-3 * sin(place));
            struct wb_surface_node *node = &body->nodes[i];
            node->position[0] = (0.1 - y) * sin(turn);
            node->position[1] = 0.1 - (0.1 - y) * cos(turn);
            node->position[2] = z;
            node->von_mises = is_tape ? 90e6 : 17.3e6 * (1.0 - turn);
        }
    }
    return 0;
}

static int release_surface(void **state)
{
    (void)state;
    wb_surface_release(&surface);
    return 0;
}

static struct wb_figure *draw(const struct wb_figures_surface_style *style)
{
    struct wb_figure *figure;
    assert_int_equal(wb_figures_surface_draw(&figure, "bent", &surface, style), WB_OK);
    assert_false(figure->failed);
    return figure;
}

static const struct wb_series *image_of(const struct wb_panel *panel)
{
    for (int i = 0; i < panel->n_series; i++)
        if (panel->series[i].kind == WB_SERIES_IMAGE)
            return &panel->series[i];
    fail_msg("there is no image");
    return NULL;
}

/* Pixels on an image's outermost lines that are not empty. */
static int on_edge(const struct wb_series *image)
{
    int n = 0;
    for (int y = 0; y < image->pixels_down; y++)
        for (int x = 0; x < image->pixels_across; x++) {
            const bool edge =
                x == 0 || y == 0 || x == image->pixels_across - 1 || y == image->pixels_down - 1;
            n += edge && image->pixels[y * image->pixels_across + x] != 0;
        }
    return n;
}

static int seen(const struct wb_series *image)
{
    int n = 0;
    for (int i = 0; i < image->pixels_across * image->pixels_down; i++)
        n += image->pixels[i] != 0;
    return n;
}

static void a_figure_has_the_whole_both_ends_and_the_scale(void **unused)
{
    (void)unused;
    struct wb_figure *figure = draw(&(struct wb_figures_surface_style){.title = "three"});
    assert_int_equal(figure->n_panels, 4);
    assert_string_equal(figure->panels[0]->title, "three");
    for (int i = 0; i < 3; i++) {
        const struct wb_series *image = image_of(figure->panels[i]);
        const double width = image->x[1] - image->x[0], height = image->y[1] - image->y[0];
        assert_true(seen(image) > 1000);
        /* Pixels are squares. */
        assert_close_relative(width / image->pixels_across, height / image->pixels_down, 0.01);
        assert_true(i == 0 ? width > 80.0 : width < 30.0);
    }
    /* All of the bundle is within the first. */
    assert_int_equal(on_edge(image_of(figure->panels[0])), 0);
    assert_true(figure->panels[3]->is_bar);
    assert_close(figure->panels[3]->colours.low, 0.0, 0.0);
    wb_figure_destroy(figure);
}

/* The tape's stress, of another material, is not looked at. */
static void colours_end_at_the_wires_largest_stress_or_as_asked_for(void **unused)
{
    (void)unused;
    assert_close(wb_figures_surface_most_stress(&surface), 17.3e6, 1.0);
    struct wb_figure *figure = draw(NULL);
    assert_close(figure->panels[3]->colours.high, 20.0, 1e-9);
    wb_figure_destroy(figure);
    figure = draw(&(struct wb_figures_surface_style){.most_stress = 35e6, .width = 400.0});
    assert_close(figure->panels[3]->colours.high, 35.0, 1e-9);
    assert_close(wb_figure_width(figure), 400.0, 0.0);
    wb_figure_destroy(figure);
}

static void the_same_surface_gives_the_same_files(void **unused)
{
    (void)unused;
    struct wb_text svg[2] = {{0}}, pdf[2] = {{0}}, png[2] = {{0}};
    for (int i = 0; i < 2; i++) {
        struct wb_figure *figure = draw(NULL);
        assert_int_equal(wb_figure_svg(figure, &svg[i]), WB_OK);
        assert_int_equal(wb_figure_pdf(figure, NULL, &pdf[i]), WB_OK);
        assert_int_equal(wb_figure_png(figure, 2.0, &png[i]), WB_OK);
        wb_figure_destroy(figure);
    }
    assert_non_null(strstr(wb_text_string(&svg[0]), "data:image/png;base64,"));
    const struct wb_text *const files[3] = {svg, pdf, png};
    for (int i = 0; i < 3; i++) {
        const struct wb_text *text = files[i];
        assert_true(text[0].length > 10000);
        assert_int_equal(text[0].length, text[1].length);
        assert_memory_equal(text[0].bytes, text[1].bytes, text[0].length);
    }
    for (int i = 0; i < 2; i++) {
        wb_text_release(&svg[i]);
        wb_text_release(&pdf[i]);
        wb_text_release(&png[i]);
    }
}

static void without_a_body_there_is_no_figure(void **unused)
{
    (void)unused;
    const struct wb_surface none = {0};
    struct wb_figure *figure;
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_figures_surface_draw(&figure, "none", &none, NULL), WB_ERR_ARGUMENT);
    assert_null(figure);
    assert_int_not_equal(wb_figures_surface_draw(&figure, "a b", &surface, NULL), WB_OK);
    assert_null(figure);
    wb_log_set_sink(NULL, NULL);
}

/* As a file that somebody changed may have them. */
static void what_has_no_size_is_refused(void **unused)
{
    (void)unused;
    struct wb_surface_node nodes[2 * 3] = {0};
    struct wb_surface_body body = {.closed = true, .n_around = 3, .n_along = 2, .nodes = nodes};
    const struct wb_surface point = {1, &body};
    struct wb_figure *figure;
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_figures_surface_draw(&figure, "point", &point, NULL), WB_ERR_DATA);
    assert_null(figure);
    for (int i = 0; i < 6; i++)
        nodes[i].position[1] = i % 2 ? 1e305 : -1e305;
    assert_int_equal(wb_figures_surface_draw(&figure, "huge", &point, NULL), WB_ERR_DATA);
    assert_null(figure);
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_figure_has_the_whole_both_ends_and_the_scale),
        cmocka_unit_test(colours_end_at_the_wires_largest_stress_or_as_asked_for),
        cmocka_unit_test(the_same_surface_gives_the_same_files),
        cmocka_unit_test(without_a_body_there_is_no_figure),
        cmocka_unit_test(what_has_no_size_is_refused),
    };
    return cmocka_run_group_tests(tests, make_surface, release_surface);
}
