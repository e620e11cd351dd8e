#include "analysis/predict/sweep.h"

#include "tests/check.h"

static struct wb_bundle_variant variants[8];

static void all_combinations_with_the_last_key_fastest(void **state)
{
    (void)state;
    int n;
    assert_int_equal(wb_sweep_parse("layers=1,2:overlap=0,25,50:wires=7", 8, variants, &n), WB_OK);
    assert_int_equal(n, 6);
    for (int i = 0; i < 6; i++) {
        assert_int_equal(variants[i].layers, i < 3 ? 1 : 2);
        assert_close(variants[i].lap, 0.25 * (i % 3), 1e-15);
        assert_int_equal(variants[i].wires, 7);
        assert_false(variants[i].has_packing || variants[i].has_outline);
    }
    assert_string_equal(variants[4].name, "layers=2:overlap=25:wires=7");
}

static void one_key_alone(void **state)
{
    (void)state;
    int n;
    assert_int_equal(wb_sweep_parse("overlap=33.3", 8, variants, &n), WB_OK);
    assert_int_equal(n, 1);
    assert_close(variants[0].lap, 0.333, 1e-15);
    assert_int_equal(variants[0].layers, 0);
    assert_string_equal(variants[0].name, "overlap=33.3");
}

static void invalid_sweeps_are_rejected(void **state)
{
    (void)state;
    static const char *const wrong[] = {"",
                                        "layers",
                                        "layers=",
                                        "layers=1:",
                                        "layers=1,",
                                        "layers=0",
                                        "layers=21",
                                        "layers=1.5",
                                        "overlap=96",
                                        "overlap=-1",
                                        "wires=129",
                                        "pitch=1",
                                        "layers=1;2",
                                        "layers=1:layers=2",
                                        "layers= 1",
                                        "=1",
                                        "wires=7:layers=1,2,x",
                                        "layers=nan",
                                        "overlap=1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17",
                                        "overlap=1,2,3,4,5,6,7,8,9"};
    int n;
    wb_log_set_sink(discard_message, NULL);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        if (wb_sweep_parse(wrong[i], 8, variants, &n) != WB_ERR_ARGUMENT)
            fail_msg("'%s' is accepted", wrong[i]);
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_combinations_with_the_last_key_fastest),
        cmocka_unit_test(one_key_alone),
        cmocka_unit_test(invalid_sweeps_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
