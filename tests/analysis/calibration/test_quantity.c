#include "analysis/calibration/properties/quantity.h"

#include "analysis/calibration/properties/properties_private.h"
#include "base/units.h"
#include "tests/check.h"

static const struct wb_estimate some = {
    .value = 2.0, .low = 1.0, .high = 3.0, .candidates_low = 0.5, .candidates_high = 4.0};

/* Properties that state every quantity, scaled so that its value is 2 in the unit of files. */
static struct wb_properties some_properties(void)
{
    static struct wb_properties p;
    wb_properties_make_unknown(&p);
    for (enum wb_quantity_id id = 0; id < WB_QUANTITIES; id++) {
        const struct wb_quantity *const row = &wb_quantity_rows[id];
        char *const base = (char *)&p;
        const int n = row->most > 0 ? 2 : 1;
        for (int k = 0; k < n; k++) {
            struct wb_estimate *const e = (struct wb_estimate *)(void *)(base + row->estimate) + k;
            *e = (struct wb_estimate){.value = some.value * row->scale,
                                      .low = some.low * row->scale,
                                      .high = some.high * row->scale,
                                      .candidates_low = some.candidates_low * row->scale,
                                      .candidates_high = some.candidates_high * row->scale};
            if (row->most > 0)
                ((double *)(void *)(base + row->curvature))[k] = 10.0 * (k + 1);
        }
        if (row->most > 0)
            *(int *)(void *)(base + row->n) = n;
        if (row->resolved > 0)
            *(double *)(void *)(base + row->resolved) = 1.5;
    }
    return p;
}

static void keys_names_and_meanings_differ(void **state)
{
    (void)state;
    for (int a = 0; a < WB_QUANTITIES; a++) {
        const struct wb_quantity *const row = &wb_quantity_rows[a];
        assert_true(row->key && row->value_key && row->name && row->unit && row->meaning);
        assert_true(row->scale > 0.0 && row->largest > 0.0);
        for (int b = a + 1; b < WB_QUANTITIES; b++) {
            assert_string_not_equal(row->key, wb_quantity_rows[b].key);
            assert_string_not_equal(row->name, wb_quantity_rows[b].name);
            assert_string_not_equal(row->meaning, wb_quantity_rows[b].meaning);
        }
    }
}

static void values_are_those_of_the_properties(void **state)
{
    (void)state;
    const struct wb_properties p = some_properties();
    const struct wb_quantity_values moment = wb_quantity_values(&p, WB_QUANTITY_MOMENT);
    assert_int_equal(moment.n, 2);
    assert_ptr_equal(moment.estimate, p.moment);
    assert_ptr_equal(moment.curvature, p.curvature);
    assert_true(isnan(moment.resolved));
    const struct wb_quantity_values secant = wb_quantity_values(&p, WB_QUANTITY_SECANT_STIFFNESS);
    assert_ptr_equal(secant.estimate, p.secant.estimate);
    assert_close(secant.resolved, 1.5, 0.0);
    const struct wb_quantity_values rigidity = wb_quantity_values(&p, WB_QUANTITY_RIGIDITY);
    assert_int_equal(rigidity.n, 1);
    assert_null(rigidity.curvature);
    assert_close(rigidity.estimate->value, 2.0 * WB_NMM2, 1e-20);
}

static void unknown_properties_have_no_quantity(void **state)
{
    (void)state;
    static struct wb_properties p;
    wb_properties_make_unknown(&p);
    for (enum wb_quantity_id id = 0; id < WB_QUANTITIES; id++) {
        const struct wb_quantity_values values = wb_quantity_values(&p, id);
        assert_true(values.n == 0 || !wb_quantity_is_known(values.estimate));
        assert_true(isnan(values.resolved));
    }
}

static void a_range_over_laws_alone_is_known(void **state)
{
    (void)state;
    struct wb_estimate e = wb_properties_unknown_estimate;
    assert_false(wb_quantity_is_known(&e));
    e.candidates_low = 1.0;
    assert_true(wb_quantity_is_known(&e));
}

static void labels_name_the_curvature_where_there_is_one(void **state)
{
    (void)state;
    char label[WB_QUANTITY_LABEL];
    assert_string_equal(wb_quantity_label(WB_QUANTITY_MOMENT, 1.41, label), "M at 1.41 /m");
    assert_string_equal(wb_quantity_label(WB_QUANTITY_RIGIDITY, 1.41, label),
                        "EI at zero curvature");
}

static double number(const struct wb_json *object, const char *key)
{
    double value;
    assert_true(wb_json_get_number(object, key, &value));
    return value;
}

static void json_has_every_quantity_in_its_unit(void **state)
{
    (void)state;
    const struct wb_properties p = some_properties();
    struct wb_json *const root = wb_json_create();
    wb_quantity_put(root, &p);
    for (enum wb_quantity_id id = 0; id < WB_QUANTITIES; id++) {
        const struct wb_quantity *const row = &wb_quantity_rows[id];
        const struct wb_json *item = wb_json_get(root, row->key);
        if (row->resolved > 0) {
            assert_close(number(item, "resolved_from_1_m"), 1.5, 0.0);
            item = wb_json_get(item, "at");
        }
        if (row->most > 0) {
            assert_int_equal(wb_json_length(item), 2);
            item = wb_json_item(item, 1);
            assert_close(number(item, "curvature_1_m"), 20.0, 0.0);
        }
        assert_close(number(item, row->value_key), some.value, 1e-12);
        assert_close(number(item, "low"), some.low, 1e-12);
        assert_close(number(item, "high"), some.high, 1e-12);
        assert_close(number(item, "candidates_low"), some.candidates_low, 1e-12);
        assert_close(number(item, "candidates_high"), some.candidates_high, 1e-12);
    }
    wb_json_destroy(root);
}

static void unknown_quantities_are_null_but_absent_in_three_point_bending(void **state)
{
    (void)state;
    static struct wb_properties p;
    double value;
    wb_properties_make_unknown(&p);
    struct wb_json *root = wb_json_create();
    wb_quantity_put(root, &p);
    const struct wb_json *const rigidity = wb_json_get(root, "flexural_rigidity_N_mm2");
    assert_non_null(rigidity);
    assert_false(wb_json_get_number(rigidity, "value", &value));
    wb_json_destroy(root);

    strcpy(p.method, "three-point");
    root = wb_json_create();
    wb_quantity_put(root, &p);
    for (int id = 0; id < WB_QUANTITIES; id++)
        assert_null(wb_json_get(root, wb_quantity_rows[id].key));
    wb_json_destroy(root);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keys_names_and_meanings_differ),
        cmocka_unit_test(values_are_those_of_the_properties),
        cmocka_unit_test(unknown_properties_have_no_quantity),
        cmocka_unit_test(a_range_over_laws_alone_is_known),
        cmocka_unit_test(labels_name_the_curvature_where_there_is_one),
        cmocka_unit_test(json_has_every_quantity_in_its_unit),
        cmocka_unit_test(unknown_quantities_are_null_but_absent_in_three_point_bending),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
