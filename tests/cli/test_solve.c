/* `wirebench solve cantilever`: numbers, outputs, messages, exit codes. WIREBENCH_BINARY is the
 * path of the tool. */
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "analysis/dataset/dataset.h"
#include "base/file.h"
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
    /* Not the rows, but the last lines. */
    assert_non_null(strstr(o.out, "found   type2 (simulation, 107 rows)"));
    assert_non_null(strstr(o.out, "\nfigure  simulated.svg\n"));
    assert_null(strstr(o.out, "cycle,phase"));
    char path[128];
    struct wb_dataset dataset;
    snprintf(path, sizeof path, "%s/simulated.svg", folder);
    assert_true(wb_file_exists(path));
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

/* A wire whose file has that block beside the four numbers of type 2. */
static void write_wire(const char *name, const char *law)
{
    char path[128];
    snprintf(path, sizeof path, "%s/%s.yaml", folder, name);
    FILE *const file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file,
            "name: %s\nconductor_diameter_mm: 0.85\nouter_diameter_mm: 1.25\n"
            "density_g_cm3: 4.31\nproperties:\n  source: test\n  youngs_modulus_MPa: 5641\n"
            "  poissons_ratio: 0.39\n  yield_stress_MPa: 4.95\n"
            "  strength_coefficient_MPa: 850\n  hardening_exponent: 0.78\n%s",
            name, law);
    fclose(file);
}

/* Force at the last deflection of a way. */
static double force_at(const struct wb_dataset *dataset, int cycle, enum wb_phase phase,
                       double deflection)
{
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (row->cycle == cycle && row->phase == phase && fabs(row->deflection - deflection) < 1e-7)
            return row->force;
    }
    fail_msg("no row of cycle %d at %g m", cycle, deflection);
    return (double)NAN;
}

static void solve_wire(const char *name, const char *law, struct wb_dataset *dataset)
{
    char path[128], command[256];
    write_wire(name, law);
    snprintf(command, sizeof command,
             "solve cantilever --wire ./%s.yaml --length-mm 100 --deflection-mm 50 --points 50 "
             "--cycles 2 -o %s-test",
             name, name);
    tool(command);
    assert_int_equal(o.code, 0);
    snprintf(path, sizeof path, "%s/%s-test", folder, name);
    assert_int_equal(wb_dataset_read(dataset, path, NULL), WB_OK);
}

static void the_hardening_rule_of_the_wire_determines_unloading(void **unused)
{
    (void)unused;
    struct wb_dataset plain, kinematic, parallel;
    const char *text;
    solve_wire("plain", "", &plain);
    solve_wire("kinematic", "  law: {form: ludwik, hardening: kinematic}\n", &kinematic);
    solve_wire("parallel",
               "  law:\n    form: parallel\n    hardening: kinematic\n    parts:\n"
               "      - {modulus_MPa: 4000, yield_strain: 0.001}\n      - {modulus_MPa: 800}\n",
               &parallel);
    /* One virgin curve, two unloadings. */
    const double top = force_at(&plain, 1, WB_PHASE_LOAD, 0.05);
    assert_close(force_at(&kinematic, 1, WB_PHASE_LOAD, 0.05), top, 3e-3 * top);
    assert_close(force_at(&kinematic, 1, WB_PHASE_LOAD, 0.02),
                 force_at(&plain, 1, WB_PHASE_LOAD, 0.02), 3e-3 * top);
    assert_true(force_at(&kinematic, 1, WB_PHASE_UNLOAD, 0.03) >
                force_at(&plain, 1, WB_PHASE_UNLOAD, 0.03) + 0.05 * top);
    /* The memory of the turn: the second cycle comes back to it. */
    const double parallel_top = force_at(&parallel, 1, WB_PHASE_LOAD, 0.05);
    assert_close_relative(force_at(&parallel, 2, WB_PHASE_LOAD, 0.05), parallel_top, 1e-6);
    assert_true(force_at(&parallel, 2, WB_PHASE_LOAD, 0.03) <
                0.95 * force_at(&parallel, 1, WB_PHASE_LOAD, 0.03));

    /* dataset.json has the numbers of the law that was computed with. */
    struct wb_json *simulation = wb_json_get(parallel.document, "simulation");
    assert_close_relative(number(simulation, "youngs_modulus_MPa"), 4800.0, 1e-12);
    assert_null(wb_json_get(simulation, "yield_stress_MPa"));
    assert_true(wb_json_get_text(simulation, "form", &text));
    assert_string_equal(text, "parallel");
    const struct wb_json *const parts = wb_json_get(simulation, "parts");
    assert_int_equal(wb_json_length(parts), 2);
    assert_close_relative(number(wb_json_item(parts, 0), "yield_strain"), 0.001, 1e-12);
    double elastic;
    assert_false(wb_json_get_number(wb_json_item(parts, 1), "yield_strain", &elastic));
    simulation = wb_json_get(kinematic.document, "simulation");
    assert_true(wb_json_get_text(simulation, "hardening", &text));
    assert_string_equal(text, "kinematic");
    assert_close_relative(number(simulation, "hardening_exponent"), 0.78, 1e-12);
    wb_dataset_release(&plain);
    wb_dataset_release(&kinematic);
    wb_dataset_release(&parallel);
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
        {"solve", "model missing", 2},
        {"solve beam --wire type1 --length-mm 85 --deflection-mm 5", "'beam'", 2},
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

/* A wire on two rollers: a curve, its dataset as a testing machine's, and how it ends. */
static void three_point_bending_is_a_machine_test(void **unused)
{
    (void)unused;
    char arguments[512];
    snprintf(
        arguments, sizeof arguments,
        "solve bending3p type2 --span-mm 20 --deflection-mm 6 --roller-radius-mm 2 "
        "--nose-radius-mm 4.5 --roller-friction 0.3 --compliance-mm-n 0.1 --cycles 1 --points 12 "
        "--bow-mm 0.3 --json -o %s/three",
        folder);
    tool(arguments);
    assert_int_equal(o.code, 0);
    assert_string_equal(o.err, "");
    struct wb_json *root = parse_output();
    const struct wb_json *points = wb_json_get(root, "points");
    const struct wb_json *top = wb_json_item(points, 12);
    const size_t n = wb_json_length(points);
    const char *phase = NULL;
    assert_close_relative(number(top, "nose_mm"), 6.0, 1e-12);
    assert_close_relative(number(top, "deflection_mm"), 6.0 + 0.1 * number(top, "force_N"), 1e-12);
    assert_close_relative(number(top, "work_J"),
                          number(top, "internal_work_J") + number(top, "friction_work_J"), 5e-3);
    assert_true(n > 14 && n < 25);
    assert_true(wb_json_get_text(wb_json_item(points, n - 1), "phase", &phase));
    assert_string_equal(phase, "slack");
    assert_close(number(wb_json_item(points, n - 1), "force_N"), 0.0, 0.0);

    struct wb_dataset dataset;
    char three[256];
    snprintf(three, sizeof three, "%s/three", folder);
    assert_int_equal(wb_dataset_read_kinds(&dataset, three, WB_TEST_BIT(WB_TEST_THREE_POINT), NULL),
                     WB_OK);
    assert_int_equal(dataset.n_rows, n);
    assert_close(dataset.info.machine.span, 20e-3, 1e-12);
    assert_close(dataset.info.machine.nose_radius.value, 4.5e-3, 1e-12);
    assert_true(dataset.info.piece.natural_bow.known);
    assert_close(dataset.info.piece.natural_bow.value, 0.3e-3, 1e-12);
    assert_close_relative(dataset.rows[12].deflection, 1e-3 * number(top, "deflection_mm"), 1e-12);
    assert_close_relative(dataset.rows[12].force, number(top, "force_N"), 1e-12);
    wb_dataset_release(&dataset);
    wb_json_destroy(root);

    tool("solve bending3p type2 --span-mm 20 --deflection-mm 6 --overhang-mm 0.1");
    assert_int_equal(o.code, 3);
    assert_non_null(strstr(o.err, "roller"));
    tool("solve bending3p type2 --span-mm 20 --deflection-mm 12 --nose-radius-mm 9 "
         "--roller-radius-mm 5");
    assert_int_equal(o.code, 3);
    assert_non_null(strstr(o.err, "pinched"));
    tool("solve bending3p type2 --span-mm 20");
    assert_int_equal(o.code, 2);
    tool("solve bending3p type2 --span-mm 20 --deflection-mm 6 --bow-mm 50");
    assert_int_equal(o.code, 2);
    assert_non_null(strstr(o.err, "at most half"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(three_point_bending_is_a_machine_test),
        cmocka_unit_test(json_holds_the_reference_curve),
        cmocka_unit_test(law_and_cycles_are_obeyed),
        cmocka_unit_test(dataset_is_one_like_any_other),
        cmocka_unit_test(the_hardening_rule_of_the_wire_determines_unloading),
        cmocka_unit_test(curve_cut_short_exits_with_3),
        cmocka_unit_test(bad_input_gives_one_message_and_its_exit_code),
    };
    return cmocka_run_group_tests(tests, make_folder, check_and_remove_folder);
}
