#include "analysis/harness/harness_drawing.h"

#include "analysis/harness/harness_found.h"
#include "analysis/plot/figure_private.h"
#include "base/units.h"
#include "base/vec3.h"
#include "tests/analysis/harness/harness_set.h"

static struct wb_harness_result_set set;
static struct wb_harness_plan *plan;

static int begin(void **state)
{
    if (make_folder(state) != 0)
        return -1;
    plan = compute_set(&set, 0, NULL, &yielding);
    return 0;
}

static int end(void **state)
{
    release_set(&set, plan);
    return remove_folder(state);
}

static struct wb_figure *draw(const struct wb_harness_drawing *drawing)
{
    struct wb_figure *figure;
    assert_int_equal(wb_harness_drawing_create(drawing, "a simulation", &figure), WB_OK);
    assert_int_equal(figure->n_panels, 4);
    assert_false(figure->failed);
    return figure;
}

static bool has_text(const struct wb_panel *panel, const char *text)
{
    for (int i = 0; i < panel->n_series; i++) {
        if (panel->series[i].kind == WB_SERIES_TEXT && strcmp(panel->series[i].label, text) == 0)
            return true;
    }
    return false;
}

static const struct wb_series *labelled(const struct wb_panel *panel, const char *label)
{
    for (int i = 0; i < panel->n_series; i++) {
        if (panel->series[i].kind != WB_SERIES_TEXT && panel->series[i].label &&
            strcmp(panel->series[i].label, label) == 0)
            return &panel->series[i];
    }
    return NULL;
}

static void every_view_names_what_can_be_mounted(void **unused)
{
    (void)unused;
    static const char *const names[] = {"R", "K1", "K2", "C1"};
    struct wb_harness_drawing drawing;
    wb_harness_drawing_of_step(&drawing, &set, 1);
    struct wb_figure *const step = draw(&drawing);
    wb_harness_drawing_of_natural(&drawing, &set);
    struct wb_figure *const natural = draw(&drawing);
    for (int i = 0; i < 4; i++) {
        for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
            assert_true(has_text(step->panels[i], names[k]));
            assert_true(has_text(natural->panels[i], names[k]));
        }
        assert_true(has_text(natural->panels[i], "<i>B2</i>"));
        assert_false(has_text(step->panels[i], "<i>B2</i>"));
    }
    assert_string_equal(natural->footer, "a simulation");
    wb_figure_destroy(step);
    wb_figure_destroy(natural);
}

/* The first branch of the stress-free shape lies along x from the origin. */
static void views_show_their_axes(void **unused)
{
    (void)unused;
    static const double ends[3][2] = {{300.0, 0.0}, {300.0, 0.0}, {0.0, 0.0}};
    struct wb_harness_drawing drawing;
    wb_harness_drawing_of_natural(&drawing, &set);
    struct wb_figure *const figure = draw(&drawing);
    for (int i = 0; i < 3; i++) {
        const struct wb_series *const trunk = &figure->panels[i]->series[0];
        assert_close(trunk->x[0], 0.0, 1e-9);
        assert_close(trunk->x[trunk->n - 1], ends[i][0], 1e-9);
        assert_close(trunk->y[trunk->n - 1], ends[i][1], 1e-9);
        assert_true(figure->panels[i]->equal_aspect);
    }
    /* The trunk is thicker than the leads. */
    assert_close_relative(figure->panels[0]->series[0].style.width,
                          sqrt(plan->wires[0].diameter / plan->wires[1].diameter) *
                              figure->panels[0]->series[1].style.width,
                          1e-12);
    wb_figure_destroy(figure);
}

/* Of the lines of the floor along x, all as long in space, those farther away are shorter in the
 * picture. */
static void perspective_makes_far_things_smaller(void **unused)
{
    (void)unused;
    struct wb_harness_drawing drawing;
    wb_harness_drawing_of_natural(&drawing, &set);
    struct wb_figure *const figure = draw(&drawing);
    const struct wb_series *const floor = &figure->panels[3]->series[0];
    double first = 0.0, last = (double)INFINITY;
    int n = 0;
    for (size_t i = 0; i + 1 < floor->n; i += 3) {
        const double right = floor->x[i + 1] - floor->x[i], up = floor->y[i + 1] - floor->y[i];
        assert_true(isnan(floor->x[i + 2]));
        if (up > 0.0) /* along y, away from the eye */
            continue;
        assert_true(hypot(right, up) < last);
        last = hypot(right, up);
        first = n++ == 0 ? last : first;
    }
    assert_true(n >= 3 && first > 1.05 * last);
    assert_true(figure->panels[3]->hidden_axes);
    wb_figure_destroy(figure);
}

/* The shapes lie within the range of each panel. */
static void whole_harness_is_in_each_panel(void **unused)
{
    (void)unused;
    struct wb_harness_drawing drawing;
    wb_harness_drawing_of_steps(&drawing, &set);
    assert_int_equal(drawing.n_shapes, 3);
    struct wb_figure *const figure = draw(&drawing);
    for (int i = 0; i < 4; i++) {
        const struct wb_panel *const panel = figure->panels[i];
        for (int k = 0; k < panel->n_series; k++) {
            for (size_t j = 0; j < panel->series[k].n; j++) {
                if (isnan(panel->series[k].x[j]))
                    continue;
                assert_true(panel->series[k].x[j] >= panel->x_range[0] &&
                            panel->series[k].x[j] <= panel->x_range[1]);
                assert_true(panel->series[k].y[j] >= panel->y_range[0] &&
                            panel->series[k].y[j] <= panel->y_range[1]);
            }
        }
    }
    assert_non_null(labelled(figure->panels[3], "taken off"));
    assert_non_null(labelled(figure->panels[3], "release C1"));
    wb_figure_destroy(figure);
}

static void step_marks_what_is_mounted_and_what_exceeds(void **unused)
{
    (void)unused;
    struct wb_harness_drawing drawing;
    const struct wb_colour ink = wb_palette_ink(), warning = wb_palette_warning();
    int n_ink = 0, n_warning = 0, n_pale = 0;
    wb_harness_drawing_of_step(&drawing, &set, 1);
    set.results[1].forces[3].exceeds_force = true;
    struct wb_figure *const figure = draw(&drawing);
    set.results[1].forces[3].exceeds_force = false;
    const struct wb_panel *const panel = figure->panels[0];
    for (int k = 0; k < panel->n_series; k++) {
        const struct wb_figure_style *const style = &panel->series[k].style;
        if (style->marker == WB_MARKER_NONE)
            continue;
        n_ink += style->colour.red == ink.red;
        n_warning += style->colour.red == warning.red;
        n_pale += style->colour.alpha < 1.0;
    }
    /* The root; the clip; two connectors. */
    assert_int_equal(n_ink, 1);
    assert_int_equal(n_warning, 1);
    assert_int_equal(n_pale, 2);
    wb_figure_destroy(figure);
}

static void residual_shows_its_largest_distance(void **unused)
{
    (void)unused;
    struct wb_harness_drawing drawing;
    const int far = wb_harness_found_farthest(&set, 4);
    const double distance =
        wb_vec3_distance(set.natural[far].position, set.results[4].places[far].position) / WB_MM;
    char text[40];
    snprintf(text, sizeof text, "%.*f mm",
             distance < 10.0    ? 2
             : distance < 100.0 ? 1
                                : 0,
             distance);
    wb_harness_drawing_of_residual(&drawing, &set, 4);
    assert_int_equal(drawing.farthest, far);
    struct wb_figure *const figure = draw(&drawing);
    bool any = false;
    for (int i = 0; i < 4; i++)
        any = any || has_text(figure->panels[i], text);
    assert_true(any);
    wb_figure_destroy(figure);
}

static void places_of_mounts_are_shown_before_anything_is_computed(void **unused)
{
    (void)unused;
    struct wb_harness_drawing drawing;
    wb_harness_drawing_of_natural(&drawing, &set);
    struct wb_figure *const figure = draw(&drawing);
    const struct wb_series *const rings = labelled(figure->panels[3], "mounted at");
    assert_non_null(rings);
    assert_int_equal(rings->n, 1);
    assert_null(labelled(figure->panels[0], "mounted at"));
    const struct wb_panel *const side = figure->panels[0];
    bool any = false;
    for (int k = 0; k < side->n_series; k++)
        any = any || (side->series[k].style.marker == WB_MARKER_RING &&
                      fabs(side->series[k].x[0] - 190.0) < 1e-9 &&
                      fabs(side->series[k].y[0] - 30.0) < 1e-9);
    assert_true(any);
    wb_figure_destroy(figure);
}

static void drawing_is_reproducible(void **unused)
{
    (void)unused;
    char paths[2][64], *bytes[2];
    for (int i = 0; i < 2; i++) {
        snprintf(paths[i], sizeof paths[i], "%s/%d.svg", folder, i);
        assert_int_equal(wb_harness_drawing_write(&set, paths[i]), WB_OK);
        assert_int_equal(wb_file_read(paths[i], &bytes[i], NULL), WB_OK);
    }
    assert_string_equal(bytes[0], bytes[1]);
    assert_non_null(strstr(bytes[0], "sample: simulation, elastoplastic"));
    free(bytes[0]);
    free(bytes[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_view_names_what_can_be_mounted),
        cmocka_unit_test(views_show_their_axes),
        cmocka_unit_test(perspective_makes_far_things_smaller),
        cmocka_unit_test(whole_harness_is_in_each_panel),
        cmocka_unit_test(step_marks_what_is_mounted_and_what_exceeds),
        cmocka_unit_test(residual_shows_its_largest_distance),
        cmocka_unit_test(places_of_mounts_are_shown_before_anything_is_computed),
        cmocka_unit_test(drawing_is_reproducible),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
