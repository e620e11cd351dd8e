#include "analysis/harness/harness_labels.h"

#include "tests/check.h"

static struct wb_figure *figure;
static struct wb_panel *panel;
static struct wb_harness_labels labels;

static int begin(void **unused)
{
    (void)unused;
    if (wb_figure_create(&figure, "labels", 200.0, 200.0) != WB_OK)
        return -1;
    panel = wb_figure_add_panel(figure);
    labels = (struct wb_harness_labels){.scale = 1.0, .panel = {{0.0, 0.0}, {200.0, 200.0}}};
    return 0;
}

static int end(void **unused)
{
    (void)unused;
    wb_harness_labels_release(&labels);
    wb_figure_destroy(figure);
    return 0;
}

static const struct wb_harness_labels_box *last(void)
{
    return &labels.boxes[labels.n_boxes - 1];
}

static bool covers(const struct wb_harness_labels_box *box, double x, double y)
{
    return box->low[0] < x && x < box->high[0] && box->low[1] < y && y < box->high[1];
}

/* As many as have room; the others are left out. */
static void names_of_one_place_do_not_overlap(void **unused)
{
    (void)unused;
    size_t n = 0;
    for (int i = 0; i < 60; i++)
        n += wb_harness_labels_put(&labels, panel, 100.0, 100.0, "C1", false);
    assert_true(n >= 8 && n < 30);
    assert_int_equal(labels.n_boxes, n);
    for (size_t i = 0; i < labels.n_boxes; i++) {
        for (size_t k = 0; k < i; k++) {
            const struct wb_harness_labels_box *const a = &labels.boxes[i], *const b =
                                                                                &labels.boxes[k];
            assert_true(a->high[0] <= b->low[0] || b->high[0] <= a->low[0] ||
                        a->high[1] <= b->low[1] || b->high[1] <= a->low[1]);
        }
    }
}

/* A line that turns at the place: free is only the side to the lower left. */
static void name_does_not_cover_a_line(void **unused)
{
    (void)unused;
    for (int i = 0; i <= 100; i++) {
        wb_harness_labels_add_point(&labels, 100.0 + 0.5 * i, 100.0 + 0.25 * i);
        wb_harness_labels_add_point(&labels, 100.0 - 0.5 * i, 100.0 + 0.25 * i);
        wb_harness_labels_add_point(&labels, 100.0 + 0.5 * i, 100.0 - 0.2 * i);
    }
    wb_harness_labels_put(&labels, panel, 100.0, 100.0, "trunk", false);
    for (size_t i = 0; i < labels.n_points; i++)
        assert_false(covers(last(), labels.x[i], labels.y[i]));
}

static void name_does_not_cover_a_mark(void **unused)
{
    (void)unused;
    const double around[][2] = {{110.0, 104.0}, {90.0, 104.0}, {110.0, 96.0}};
    for (int i = 0; i < 3; i++)
        wb_harness_labels_add_mark(&labels, around[i][0], around[i][1]);
    wb_harness_labels_put(&labels, panel, 100.0, 100.0, "K1", false);
    for (int i = 0; i < 3; i++)
        assert_false(covers(last(), around[i][0], around[i][1]));
}

static void name_stays_in_its_panel(void **unused)
{
    (void)unused;
    static const double corners[][2] = {{199.0, 199.0}, {1.0, 1.0}, {199.0, 1.0}, {1.0, 199.0}};
    for (int i = 0; i < 4; i++) {
        wb_harness_labels_put(&labels, panel, corners[i][0], corners[i][1], "lamp", true);
        for (int k = 0; k < 2; k++)
            assert_true(last()->low[k] >= 0.0 && last()->high[k] <= 200.0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(names_of_one_place_do_not_overlap, begin, end),
        cmocka_unit_test_setup_teardown(name_does_not_cover_a_line, begin, end),
        cmocka_unit_test_setup_teardown(name_does_not_cover_a_mark, begin, end),
        cmocka_unit_test_setup_teardown(name_stays_in_its_panel, begin, end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
