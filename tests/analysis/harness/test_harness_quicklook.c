#include "analysis/harness/harness_quicklook.h"

#include "tests/analysis/harness/harness_set.h"
#include "tests/messages.h"

static struct wb_harness_result_set set;
static struct wb_harness_plan *plan;

static int begin(void **state)
{
    char path[64];
    keep_messages();
    if (make_folder(state) != 0)
        return -1;
    plan = make_plan();
    snprintf(path, sizeof path, "%s/h.yaml", folder);
    write_harness(path, 0, NULL);
    assert_int_equal(wb_harness_file_read(plan, path), WB_OK);
    assert_int_equal(wb_harness_quicklook_compute(&set, plan), WB_OK);
    return 0;
}

static int end(void **state)
{
    release_set(&set, plan);
    return remove_folder(state);
}

static void no_step_is_computed(void **unused)
{
    (void)unused;
    assert_int_equal(set.n_steps, 0);
    assert_int_equal(plan->n_steps, 5);
    /* The end of the trunk. */
    const struct wb_harness_place *place = set.natural;
    while (place[1].branch == 0)
        place++;
    assert_close(place->position[0], 0.3, 1e-12);
}

static void shape_is_that_of_the_whole_computation(void **unused)
{
    (void)unused;
    struct wb_harness_result_set whole;
    assert_int_equal(wb_harness_run_compute(&whole, plan, &yielding, NULL, NULL), WB_OK);
    assert_int_equal(whole.n_places, set.n_places);
    assert_memory_equal(whole.natural, set.natural, (size_t)set.n_places * sizeof *set.natural);
    wb_harness_run_release(&whole);
}

static void summary_states_what_the_file_has(void **unused)
{
    (void)unused;
    static const char *const parts[] = {
        "sample (harness file, stress-free shape)",
        "length       750 mm in 3 branches",
        "extent       x 0 to 550, y -100 to 0, z 0 to 0 mm",
        "trunk        bundle-7.yaml, 4.6 mm",
        "B2           J to K1, lead, 200 mm",
        "R            root\n",
        "K1           connector on B2 at 200 mm, 8 g\n",
        "C1           clip on B1 at 200 mm, holds axis\n",
        " 2  mount C1 at (190, 0, 30) mm\n",
        " 5  take_off\n",
    };
    struct wb_text text = {0};
    wb_harness_quicklook_summary(&set, &text);
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        if (!strstr(wb_text_string(&text), parts[i]))
            fail_msg("'%s' is not in '%s'", parts[i], wb_text_string(&text));
    }
    wb_text_release(&text);
}

static void object_has_the_same(void **unused)
{
    (void)unused;
    struct wb_json *const root = wb_json_create();
    double value;
    wb_harness_quicklook_describe(&set, root);
    assert_true(wb_json_get_number(root, "length_mm", &value));
    assert_close(value, 750.0, 1e-9);
    assert_int_equal(wb_json_length(wb_json_get(root, "branches")), 3);
    assert_int_equal(wb_json_length(wb_json_get(root, "items")), 4);
    assert_int_equal(wb_json_length(wb_json_get(root, "steps")), 5);
    wb_json_destroy(root);
}

static void folder_with_files_is_kept(void **unused)
{
    (void)unused;
    static const char *const names[] = {"shape.svg", "shape.png", "shape.pdf", "summary.txt"};
    char look[64], path[96];
    snprintf(look, sizeof look, "%s/look", folder);
    assert_int_equal(wb_harness_quicklook_write(&set, look, false), WB_OK);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        snprintf(path, sizeof path, "%s/%s", look, names[i]);
        assert_true(wb_file_exists(path));
    }
    assert_int_equal(wb_harness_quicklook_write(&set, look, false), WB_ERR_EXISTS);
    assert_int_equal(wb_harness_quicklook_write(&set, look, true), WB_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_step_is_computed),
        cmocka_unit_test(shape_is_that_of_the_whole_computation),
        cmocka_unit_test(summary_states_what_the_file_has),
        cmocka_unit_test(object_has_the_same),
        cmocka_unit_test(folder_with_files_is_kept),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
