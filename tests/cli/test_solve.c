/* The tool itself: `wirebench solve cantilever`, its numbers, outputs, messages and exit codes.
 * WIREBENCH_BINARY names it. */
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "analysis/dataset.h"
#include "base/json.h"
#include "tests/cli/tool.h"

static void json_holds_the_reference_curve(void **unused)
{
    (void)unused;
    tool("solve cantilever --wire type1 --length-mm 85 --deflection-mm 53 --strand-mm 760 --weight "
         "--points 53 --json");
    assert_int_equal(o.code, 0);
    assert_string_equal(o.err, "");
    struct wb_json *root = parse_output();
    const struct wb_json *points = wb_json_get(root, "points");
    bool converged = false;
    assert_int_equal(wb_json_length(points), 54);
    assert_true(wb_json_get_boolean(root, "converged", &converged) && converged);
    assert_true(number(root, "wall_s") > 0.0 && number(root, "cpu_s") > 0.0);

    const struct wb_json *zero = wb_json_item(points, 0), *last = wb_json_item(points, 53);
    const char *phase = NULL;
    assert_true(wb_json_get_text(last, "phase", &phase));
    assert_string_equal(phase, "load");
    assert_close(number(zero, "force_N"), 0.0, 0.0);
    assert_close_relative(number(last, "deflection_mm"), 53.0, 1e-9);
    assert_close_relative(number(last, "tension_N"), 0.081669167, 2e-3);
    assert_close(number(last, "tip_x_mm"), 62.110495, 0.05);
    assert_close(number(last, "tip_angle_rad"), 0.97720887, 1e-3);
    /* Zeroed: the vertical part of the tension less that at zero. */
    assert_close(number(last, "force_N"),
                 number(last, "tension_N") *
                         sqrt(1.0 - pow((85.0 - number(last, "tip_x_mm")) / 760.0, 2)) -
                     number(zero, "tension_N"),
                 1e-9);
    wb_json_destroy(root);
}

static void law_and_cycles_are_obeyed(void **unused)
{
    (void)unused;
    tool("solve cantilever --wire type1 --length-mm 85 --deflection-mm 53 --law elastic --points 1 "
         "--json");
    assert_int_equal(o.code, 0);
    struct wb_json *root = parse_output();
    assert_close_relative(number(wb_json_item(wb_json_get(root, "points"), 1), "tension_N"),
                          0.162730891, 1e-3);
    wb_json_destroy(root);

    tool(
        "solve cantilever --wire type3 --length-mm 100 --deflection-mm 53 --strand-mm 760 --weight "
        "--cycles 2 --points 10");
    assert_int_equal(o.code, 0);
    int rows = -1, slack = 0;
    for (const char *line = o.out; *line; line = strchr(line, '\n') + 1) {
        rows++;
        slack += strncmp(line, "1,slack,", 8) == 0 || strncmp(line, "2,slack,", 8) == 0;
    }
    assert_int_equal(rows, 1 + 40);
    assert_true(slack > 4);
    assert_non_null(
        strstr(o.out, "cycle,phase,deflection_mm,tension_N,force_N,tip_x_mm,tip_angle_rad"));
    assert_non_null(strstr(o.out, "\n2,unload,"));
}

static void dataset_is_one_like_any_other(void **unused)
{
    (void)unused;
    tool(
        "solve cantilever --wire type2 --length-mm 100 --deflection-mm 53 --strand-mm 760 --weight "
        "--cycles 1 -o simulated");
    assert_int_equal(o.code, 0);
    assert_string_equal(o.out, "");
    char path[128];
    struct wb_dataset dataset;
    snprintf(path, sizeof path, "%s/simulated", folder);
    assert_int_equal(wb_dataset_read(&dataset, path, NULL), WB_OK);
    assert_int_equal(dataset.n_rows, 107);
    assert_int_equal(dataset.n_shape_rows, 7 * 107);
    assert_true(dataset.info.is_simulation && !dataset.info.is_virtual);
    assert_string_equal(dataset.info.wire, "type2");
    assert_close_relative(dataset.info.length, 0.1, 1e-12);
    assert_close_relative(dataset.info.strand_length, 0.76, 1e-12);
    assert_close_relative(dataset.info.gravity, 9.80665, 1e-12);
    /* Marker 6 is the tip. */
    assert_close(dataset.shape_rows[7 * 53 + 6].y, dataset.rows[53].deflection, 1e-9);
    assert_close(dataset.rows[53].deflection, 0.053, 1e-9);
    assert_close(dataset.rows[53].t, 53.0, 1e-9);
    const struct wb_json *simulation = wb_json_get(dataset.document, "simulation");
    assert_non_null(simulation);
    assert_true(number(simulation, "cpu_s") > 0.0);
    wb_dataset_release(&dataset);

    /* It is overwritten only with --force. */
    tool(
        "solve cantilever --wire type2 --length-mm 100 --deflection-mm 10 --points 2 -o simulated");
    assert_int_equal(o.code, 1);
    assert_non_null(strstr(o.err, "--force"));
    tool("solve cantilever --wire type2 --length-mm 100 --deflection-mm 10 --points 2 -o simulated "
         "--force --json");
    assert_int_equal(o.code, 0);
    struct wb_json *root = parse_output();
    assert_int_equal(wb_json_length(wb_json_get(root, "points")), 3);
    wb_json_destroy(root);
}

static void curve_cut_short_exits_with_3(void **unused)
{
    (void)unused;
    char path[128];
    snprintf(path, sizeof path, "%s/soft.yaml", folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    /* The strand is shorter than the tip moves aside: there is no such equilibrium. */
    fputs("name: soft\nconductor_diameter_mm: 0.7\nouter_diameter_mm: 1.1\ndensity_g_cm3: 4.06\n"
          "properties:\n  source: test\n  youngs_modulus_MPa: 5021\n  poissons_ratio: 0.39\n"
          "  yield_stress_MPa: 3.9\n  strength_coefficient_MPa: 0\n  hardening_exponent: 1\n",
          file);
    fclose(file);
    tool("solve cantilever --wire ./soft.yaml --length-mm 85 --deflection-mm 80 --strand-mm 3 "
         "--points 20 --json");
    assert_int_equal(o.code, 3);
    assert_non_null(strstr(o.err, "did not converge"));
    struct wb_json *root = parse_output();
    bool converged = true;
    assert_true(wb_json_get_boolean(root, "converged", &converged));
    assert_false(converged);
    const size_t rows = wb_json_length(wb_json_get(root, "points"));
    assert_in_range(rows, 1, 20);
    wb_json_destroy(root);
}

static void bad_input_gives_one_message_and_its_exit_code(void **unused)
{
    (void)unused;
    static const struct refused cases[] = {
        {"solve", "name the model", 2},
        {"solve beam --wire type1 --length-mm 85 --deflection-mm 5", "no model 'beam'", 2},
        {"solve cantilever --wire type1 --length-mm 85", "--deflection-mm", 2},
        {"solve cantilever --wire type1 --length-mm 85mm --deflection-mm 5", "--length-mm", 2},
        {"solve cantilever --wire type1 --length-mm -85 --deflection-mm 5", "--length-mm", 2},
        {"solve cantilever --wire type1 --length-mm 85 --deflection-mm nan", "--deflection-mm", 2},
        {"solve cantilever --wire type1 --length-mm 85 --deflection-mm 5 --law rubber", "rubber",
         2},
        {"solve cantilever --wire type1 --length-mm 85 --deflection-mm 5 --points 0", "--points",
         2},
        {"solve cantilever --wire type9 --length-mm 85 --deflection-mm 5", "type9", 1},
        {"solve cantilever --wire ./none.yaml --length-mm 85 --deflection-mm 5", "none.yaml", 1},
        {"solve cantilever --wire type1 --length-mm 85 --deflection-mm 5 -o /proc/none", "/proc",
         1},
    };
    expect_refused(cases, sizeof cases / sizeof cases[0]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(json_holds_the_reference_curve),
        cmocka_unit_test(law_and_cycles_are_obeyed),
        cmocka_unit_test(dataset_is_one_like_any_other),
        cmocka_unit_test(curve_cut_short_exits_with_3),
        cmocka_unit_test(bad_input_gives_one_message_and_its_exit_code),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
