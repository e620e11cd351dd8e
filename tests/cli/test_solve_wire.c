/* `wirebench solve wire3d` and `wire1d` on coarse meshes, to keep the test fast. WIREBENCH_BINARY
 * is the path of the tool. */
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "analysis/dataset/dataset.h"
#include "analysis/dataset/fields.h"
#include "base/file.h"
#include "base/json.h"
#include "tests/cli/tool.h"

static void write_model(const char *name, const char *text)
{
    FILE *file = fopen(path_of(name), "w");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

#define HEAD(model, law)                                                                           \
    "name: " model "\ntitle: a test\nwire: type3\nlength_mm: 20\nlaw: " law                        \
    "\ngravity: [0, 0, 0]\nmesh:\n  elements_along: 6\n"

static bool flag(const struct wb_json *object, const char *key)
{
    bool value = false;
    assert_true(wb_json_get_boolean(object, key, &value));
    return value;
}

/* 3 E I d / L^3 of the 20 mm of type 3 at 0.1 mm. */
static void both_models_are_as_stiff_as_the_beam(void **unused)
{
    (void)unused;
    static const char *const solvers[] = {"solve wire3d raised.yaml --json",
                                          "solve wire1d raised.yaml --json"};
    write_model("raised.yaml", HEAD("raised", "elastic") "history:\n"
                                                         "  - name: raised\n"
                                                         "    deflection_mm: 0.1\n"
                                                         "    rows: 2\n"
                                                         "  - name: released\n"
                                                         "    release: true\n"
                                                         "    rows: 1\n");
    const double I = M_PI / 64.0 * pow(1.4e-3, 4.0), k = 3.0 * 4528e6 * I / pow(20e-3, 3.0);
    for (int i = 0; i < 2; i++) {
        tool(solvers[i]);
        assert_int_equal(o.code, 0);
        assert_string_equal(o.err, "");
        struct wb_json *const root = parse_output();
        const struct wb_json *const points = wb_json_get(root, "points");
        const char *text = NULL;
        assert_int_equal(wb_json_length(points), 4);
        assert_true(flag(root, "converged"));
        const struct wb_json *const last = wb_json_item(points, 2);
        assert_close_relative(number(last, "deflection_mm"), 0.1, 1e-6);
        assert_close_relative(number(last, "force_N"), k * 0.1e-3, 0.02);
        assert_close_relative(number(last, "tension_N"), number(last, "force_N"), 1e-6);
        assert_close(number(last, "tip_x_mm"), 20.0, 0.001);
        assert_close(number(last, "tip_z_mm"), 0.0, 1e-6);
        assert_close_relative(number(last, "tip_angle_rad"), 1.5 * 0.1 / 20.0, 0.02);
        assert_true(wb_json_get_text(last, "step", &text));
        assert_string_equal(text, "raised");
        assert_true(wb_json_get_text(wb_json_item(points, 3), "phase", &text));
        assert_string_equal(text, "unload");
        assert_close(number(wb_json_item(points, 3), "deflection_mm"), 0.0, 1e-5);
        if (i == 0)
            assert_close(number(root, "elements"), 72.0, 0.0);
        assert_true(number(root, "degrees_of_freedom") > 50.0);
        assert_true(number(root, "increments") >= 3.0 && number(root, "iterations") >= 3.0);
        assert_in_range((long)number(root, "peak_memory_MB"), 1, 1000);
        assert_true(number(root, "cpu_s") >= 0.0 && number(root, "wall_s") > 0.0);
        wb_json_destroy(root);
    }
}

static void table_has_the_columns_of_the_cantilever(void **unused)
{
    (void)unused;
    write_model("pushed.yaml", HEAD("pushed", "elastoplastic") "history:\n"
                                                               "  - name: pushed\n"
                                                               "    force_N: [0, 0.1, 0.05]\n"
                                                               "    rows: 3\n");
    static const char *const solvers[] = {"solve wire3d pushed.yaml", "solve wire1d pushed.yaml"};
    double y[2];
    for (int i = 0; i < 2; i++) {
        tool(solvers[i]);
        assert_int_equal(o.code, 0);
        static const char header[] =
            "cycle,phase,deflection_mm,tension_N,force_N,tip_x_mm,tip_angle_rad\n1,load,";
        assert_memory_equal(o.out, header, strlen(header));
        int rows = -1;
        const char *last = NULL;
        for (const char *line = o.out; *line; line = strchr(line, '\n') + 1) {
            rows++;
            last = line;
        }
        assert_int_equal(rows, 4);
        double tension, force;
        assert_int_equal(sscanf(last, "1,load,%lf,%lf,%lf,", &y[i], &tension, &force), 3);
        assert_close(tension, 0.1, 1e-9);
        assert_close(force, 0.1, 1e-9);
    }
    assert_true(y[0] > 0.05);
    assert_close_relative(y[0], y[1], 0.02);
}

static const char kept[] = HEAD("kept", "elastoplastic") "fields_at_mm: [5, 10]\n"
                                                         "history:\n"
                                                         "  - name: pushed\n"
                                                         "    force_N: [0, 0.2, 0.1]\n"
                                                         "    rows: 2\n"
                                                         "    fields: true\n"
                                                         "  - name: unloaded\n"
                                                         "    unload: true\n"
                                                         "    rows: 2\n"
                                                         "  - name: turned\n"
                                                         "    moment_Nm: [0.0001, 0, 0]\n"
                                                         "    rows: 1\n";

static void look_at_dataset(const char *name, const char *solver)
{
    struct wb_dataset dataset;
    struct wb_fields fields;
    const char *text = NULL;
    assert_int_equal(wb_dataset_read(&dataset, path_of(name), NULL), WB_OK);
    assert_int_equal(dataset.n_rows, 6);
    assert_int_equal(dataset.n_shape_rows, 26 * 6);
    assert_true(dataset.info.is_simulation && !dataset.info.is_follower);
    assert_string_equal(dataset.info.wire, "type3");
    assert_true(fabs(dataset.shape_rows[26 * 2 + 25].z) > 1e-5);
    /* The tip is the last position; the 3D tip is the mean of its section. */
    assert_close(dataset.shape_rows[26 * 2 + 25].y, dataset.rows[2].deflection, 1e-6);
    const struct wb_json *const simulation = wb_json_get(dataset.document, "simulation");
    assert_true(wb_json_get_text(simulation, "model", &text));
    assert_string_equal(text, solver);
    assert_int_equal(wb_json_length(wb_json_get(simulation, "steps")), 3);
    assert_true(number(simulation, "peak_memory_MB") > 1.0);
    wb_dataset_release(&dataset);

    /* Where the model asks for them, and at the end. */
    assert_int_equal(wb_fields_read(&fields, path_of(name), NULL), WB_OK);
    assert_int_equal(fields.n, 6);
    assert_non_null(wb_fields_find(&fields, "pushed", (double)NAN));
    assert_null(wb_fields_find(&fields, "unloaded", (double)NAN));
    assert_non_null(wb_fields_find(&fields, "turned", (double)NAN));
    const struct wb_field *const cross = wb_fields_find(&fields, "pushed", 5e-3);
    assert_non_null(cross);
    double highest = 0.0;
    for (int f = 0; f < cross->n_faces; f++)
        for (int k = 0; k < 8; k++)
            highest = fmax(highest, fabs(cross->faces[f].node[k].axial));
    /* Its moment over the section's modulus, less what yields. */
    const double force = hypot(0.2, 0.1), elastic = force * 15e-3 * 32.0 / M_PI / pow(1.4e-3, 3.0);
    assert_in_range((long)highest, (long)(0.5 * elastic), (long)(1.15 * elastic));
    wb_fields_release(&fields);
}

static void dataset_holds_rows_shapes_and_fields(void **unused)
{
    (void)unused;
    write_model("kept.yaml", kept);
    tool("solve wire3d ./kept.yaml -o kept-3d --no-figure");
    assert_int_equal(o.code, 0);
    assert_non_null(strstr(o.out, "found "));
    assert_null(strstr(o.out, "figure "));
    assert_false(wb_file_exists(path_of("kept-3d.svg")));
    look_at_dataset("kept-3d", "wire3d");
    tool("solve wire1d kept.yaml -o kept-1d");
    assert_int_equal(o.code, 0);
    look_at_dataset("kept-1d", "wire1d");
    assert_false(wb_file_exists(path_of("kept-1d/kept.pvd")));

    /* It is overwritten only with --force, and nothing is computed before that is clear. */
    tool("solve wire3d kept.yaml -o kept-1d");
    assert_int_equal(o.code, 1);
    assert_non_null(strstr(o.err, "--force"));
    look_at_dataset("kept-1d", "wire1d");
    tool("solve wire3d kept.yaml -o kept-1d --force");
    assert_int_equal(o.code, 0);
    look_at_dataset("kept-1d", "wire3d");
    /* A simulation without fields leaves none of another. */
    tool("solve cantilever --wire type3 --length-mm 20 --deflection-mm 1 --points 2 -o kept-1d "
         "--force");
    assert_int_equal(o.code, 0);
    assert_false(wb_file_exists(path_of("kept-1d/fields.csv")));
}

static void a_follower_test_is_named(void **unused)
{
    (void)unused;
    struct wb_dataset dataset;
    write_model("follower.yaml", HEAD("follower", "elastic") "history:\n"
                                                             "  - name: loaded\n"
                                                             "    follower_N: [0, 0.3, 0]\n"
                                                             "    rows: 3\n");
    tool("solve wire3d follower.yaml -o follower");
    assert_int_equal(o.code, 0);
    assert_int_equal(wb_dataset_read(&dataset, path_of("follower"), NULL), WB_OK);
    assert_true(dataset.info.is_follower);
    assert_close(dataset.rows[3].force, 0.3, 1e-12);
    assert_true(dataset.rows[3].tension < 0.3);
    wb_dataset_release(&dataset);
}

static void paraview_gets_a_file_a_row(void **unused)
{
    (void)unused;
    char text[4096];
    write_model("kept.yaml", kept);
    tool("solve wire3d kept.yaml --vtk pictures");
    assert_int_equal(o.code, 0);
    assert_memory_equal(o.out, "cycle,", 6);
    for (int i = 0; i < 6; i++) {
        char name[64];
        snprintf(name, sizeof name, "pictures/kept-%04d.vtu", i);
        assert_true(wb_file_exists(path_of(name)));
    }
    assert_false(wb_file_exists(path_of("pictures/kept-0006.vtu")));
    read_all("pictures/kept.pvd", text, sizeof text);
    assert_non_null(strstr(text, "kept-0005.vtu"));
    tool("solve wire3d kept.yaml --vtk pictures");
    assert_int_equal(o.code, 1);
    assert_non_null(strstr(o.err, "--force"));
}

static void results_before_a_convergence_failure_are_kept(void **unused)
{
    (void)unused;
    /* One element bends only so far. */
    write_model("far.yaml", "name: far\ntitle: a test\nwire: type3\nlength_mm: 20\nlaw: elastic\n"
                            "gravity: [0, 0, 0]\nmesh:\n  elements_along: 1\nhistory:\n"
                            "  - name: pushed\n    force_N: [0, 0.1, 0]\n    rows: 2\n"
                            "  - name: raised\n    deflection_mm: 19.99\n    rows: 2\n");
    /* No section bears twice the plastic moment. */
    write_model("soft.yaml", "name: soft\nconductor_diameter_mm: 1\nouter_diameter_mm: 1.4\n"
                             "density_g_cm3: 5\nproperties:\n  youngs_modulus_MPa: 4528\n"
                             "  poissons_ratio: 0.39\n  yield_stress_MPa: 4.52\n"
                             "  strength_coefficient_MPa: 0\n  hardening_exponent: 1\n");
    write_model("much.yaml", "name: much\ntitle: a test\nwire: ./soft.yaml\nlength_mm: 20\n"
                             "law: elastoplastic\ngravity: [0, 0, 0]\nhistory:\n"
                             "  - name: raised\n    moment_Nm: [0, 0, 0.004]\n    rows: 4\n");
    static const char *const models[][2] = {{"wire3d", "far"}, {"wire1d", "much"}};
    for (int i = 0; i < 2; i++) {
        char arguments[128], expected[64];
        struct wb_dataset dataset;
        snprintf(arguments, sizeof arguments, "solve %s %s.yaml -o far-%d --json", models[i][0],
                 models[i][1], i);
        snprintf(expected, sizeof expected, "%s: did not converge: step 'raised', row ",
                 models[i][1]);
        tool(arguments);
        assert_int_equal(o.code, 3);
        assert_non_null(strstr(o.err, expected));
        struct wb_json *const root = parse_output();
        const char *problem = NULL;
        assert_false(flag(root, "converged"));
        assert_true(wb_json_get_text(root, "problem", &problem) && strlen(problem) > 20);
        const size_t rows = wb_json_length(wb_json_get(root, "points"));
        assert_in_range(rows, 2, 4);
        wb_json_destroy(root);
        snprintf(arguments, sizeof arguments, "far-%d", i);
        assert_int_equal(wb_dataset_read(&dataset, path_of(arguments), NULL), WB_OK);
        assert_int_equal(dataset.n_rows, rows);
        assert_false(wb_dataset_is_complete(&dataset));
        wb_dataset_release(&dataset);
    }
}

static void interrupt_keeps_the_completed_rows(void **unused)
{
    (void)unused;
    struct wb_dataset dataset;
    /* Some minutes if it were left alone. */
    write_model("long.yaml", "name: long\ntitle: a test\nwire: type3\nlength_mm: 85\n"
                             "law: elastoplastic\ngravity: [0, 0, 0]\nmesh:\n"
                             "  elements_along: 60\nhistory:\n  - name: raised\n"
                             "    deflection_mm: 53\n    rows: 2000\n");
    run_tool("timeout --preserve-status -s INT 1.5", "solve wire3d long.yaml -o long --json");
    assert_int_equal(o.code, 3);
    assert_non_null(strstr(o.err, "stopped after "));
    struct wb_json *const root = parse_output();
    const size_t rows = wb_json_length(wb_json_get(root, "points"));
    assert_in_range(rows, 1, 2000);
    assert_true(flag(root, "converged"));
    wb_json_destroy(root);
    assert_int_equal(wb_dataset_read(&dataset, path_of("long"), NULL), WB_OK);
    assert_int_equal(dataset.n_rows, rows);
    assert_false(wb_dataset_is_complete(&dataset));
    wb_dataset_release(&dataset);
}

static void bad_input_gives_one_message_and_its_exit_code(void **unused)
{
    (void)unused;
    static const struct refused cases[] = {
        {"solve wire3d", "file is missing: wire3d MODEL.yaml", 2},
        {"solve wire1d", "file is missing: wire1d MODEL.yaml", 2},
        {"solve wire2d kept.yaml", "'wire2d'", 2},
        {"solve wire3d kept.yaml kept.yaml", "one model at a time", 2},
        {"solve wire3d kept.yaml --points 5", "--points applies to cantilever", 2},
        {"solve wire1d kept.yaml --wire type1", "--wire applies to cantilever", 2},
        {"solve wire1d kept.yaml --vtk here", "--vtk", 2},
        {"solve cantilever --vtk here", "--vtk", 2},
        {"solve wire3d none", "no 'none' among the shipped models", 1},
        {"solve wire3d ./none.yaml", "no file './none.yaml'", 1},
        {"solve wire3d bad.yaml -o bad", "bad.yaml:3: wire: no 'type9' among the shipped", 1},
        {"solve wire1d worse.yaml -o bad", "worse.yaml:11: a step has exactly one of", 1},
        {"solve wire3d kept.yaml -o /proc/none", "/proc", 1},
        {"solve wire3d kept.yaml --vtk /proc/none -o bad", "/proc", 1},
    };
    write_model("kept.yaml", kept);
    write_model("bad.yaml", "name: bad\ntitle: a test\nwire: type9\nlength_mm: 20\nlaw: elastic\n"
                            "gravity: [0, 0, 0]\nhistory:\n  - name: a\n    unload: true\n");
    write_model("worse.yaml", HEAD("worse", "elastic") "history:\n\n  - name: a\n    rows: 3\n");
    expect_refused(cases, sizeof cases / sizeof cases[0]);
    assert_false(wb_file_exists(path_of("bad")));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_models_are_as_stiff_as_the_beam),
        cmocka_unit_test(table_has_the_columns_of_the_cantilever),
        cmocka_unit_test(dataset_holds_rows_shapes_and_fields),
        cmocka_unit_test(a_follower_test_is_named),
        cmocka_unit_test(paraview_gets_a_file_a_row),
        cmocka_unit_test(results_before_a_convergence_failure_are_kept),
        cmocka_unit_test(interrupt_keeps_the_completed_rows),
        cmocka_unit_test(bad_input_gives_one_message_and_its_exit_code),
    };
    return cmocka_run_group_tests(tests, make_folder, check_and_remove_folder);
}
