/* The tool itself: `wirebench solve bundle`, of one bare wire on a coarse mesh so that it is fast.
 * WIREBENCH_BINARY names it. */
#include <stdlib.h>
#include <sys/wait.h>

#include "analysis/dataset.h"
#include "base/json.h"
#include "tests/check.h"

static char folder[] = "/tmp/wirebench-solve-XXXXXX";
static char out[65536], err[16384];

static const char model[] =
    "name: one\nwires: [{wire: type3}]\npacking: hexagon\nlength_mm: 114\n"
    "interface: {cohesive_stiffness_N_mm3: 30, friction: 0.4}\n"
    "meshes: [{name: coarse, core_quads: 2, rings: 0, elements_along: 15}]\n"
    "run: {mesh: coarse, deflection_mm: 10, rows: 5, selective_mass_scaling: 100}\n"
    "loads: {weight: true, strand_mm: 760}\n";

static int make_folder(void **state)
{
    char path[128];
    (void)state;
    if (!mkdtemp(folder))
        return -1;
    snprintf(path, sizeof path, "%s/one.yaml", folder);
    FILE *file = fopen(path, "w");
    return file && fputs(model, file) >= 0 && fclose(file) == 0 ? 0 : -1;
}

static int remove_folder(void **state)
{
    char command[128];
    (void)state;
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    return system(command);
}

static void read_all(const char *name, char *text, size_t size)
{
    char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    text[fread(text, 1, size - 1, file)] = '\0';
    fclose(file);
}

static int tool(const char *arguments)
{
    const char *binary = getenv("WIREBENCH_BINARY");
    char command[1024];
    if (!binary)
        fail_msg("WIREBENCH_BINARY is not set: run this test through meson");
    snprintf(command, sizeof command, "cd %s && %s solve bundle one.yaml %s > out 2> err", folder,
             binary, arguments);
    const int status = system(command);
    assert_true(WIFEXITED(status));
    read_all("out", out, sizeof out);
    read_all("err", err, sizeof err);
    return WEXITSTATUS(status);
}

static double number(const struct wb_json *object, const char *key)
{
    double value = (double)NAN;
    if (!wb_json_get_number(object, key, &value))
        fail_msg("no number '%s' in %s", key, out);
    return value;
}

/* 3 E I d / L^3 of the wire, which hardly yields. */
static void json_has_the_curve_and_what_it_took(void **unused)
{
    (void)unused;
    struct wb_json *root = NULL;
    bool chosen = true;
    assert_int_equal(tool("--json --dead-force --no-weight --duration-s 1.5"), 0);
    assert_int_equal(wb_json_parse(&root, out, "output"), WB_OK);
    assert_close(number(root, "elements"), 60.0, 0.0);
    assert_close(number(root, "shells"), 0.0, 0.0);
    assert_close(number(root, "duration_s"), 1.5, 0.0);
    assert_true(wb_json_get_boolean(root, "duration_chosen", &chosen) && !chosen);
    assert_close_relative(number(root, "steps") * number(root, "time_step_s"), 1.5, 1e-3);
    const struct wb_json *points = wb_json_get(root, "points");
    assert_int_equal(wb_json_length(points), 6);
    const struct wb_json *point = wb_json_item(points, 2);
    const double stiffness = 3.0 * 4528e6 * M_PI / 64.0 * pow(1.4e-3, 4.0) / pow(0.114, 3.0);
    assert_close_relative(number(point, "force_N"),
                          stiffness * number(point, "deflection_mm") * 1e-3, 0.05);
    const struct wb_json *largest = wb_json_get(root, "largest");
    assert_true(number(largest, "imbalance_over_external") < 0.01);
    assert_true(number(wb_json_get(root, "energy"), "external_J") > 0.0);
    wb_json_destroy(root);
}

static void datasets_are_those_of_the_homogenised_beam(void **unused)
{
    (void)unused;
    struct wb_dataset dataset;
    char path[128];
    assert_int_equal(tool("--duration-s 1.5 -o ds"), 0);
    snprintf(path, sizeof path, "%s/ds", folder);
    assert_int_equal(wb_dataset_read(&dataset, path), WB_OK);
    assert_int_equal(dataset.n_rows, 6);
    assert_int_equal(dataset.n_shape_rows, 6 * 26);
    assert_close(dataset.info.outer_diameter, 1.4e-3, 1e-12);
    assert_close(dataset.info.poissons_ratio, 0.3, 0.0);
    assert_close(dataset.info.strand_length, 0.76, 1e-12);
    assert_close(dataset.info.gravity, 9.80665, 1e-9);
    assert_true(dataset.info.is_simulation);
    assert_close(dataset.rows[5].deflection, 10e-3, 1e-6);
    wb_dataset_release(&dataset);

    read_all("ds/energies.csv", out, sizeof out);
    int lines = 0;
    for (const char *c = out; *c; c++)
        lines += *c == '\n';
    assert_int_equal(lines, 7);
    assert_non_null(strstr(out, "kinetic_over_internal"));
}

static void what_was_overridden_is_told(void **unused)
{
    (void)unused;
    struct wb_json *root = NULL;
    bool flag = false;
    assert_int_equal(tool("--duration-s 0.5 --friction 0.3,0.2,1.5 --cohesive-stiffness 60 "
                          "--dead-force --mass-scaling 100 -o over"),
                     0);
    read_all("over/dataset.json", out, sizeof out);
    assert_int_equal(wb_json_parse(&root, out, "dataset.json"), WB_OK);
    const struct wb_json *simulation = wb_json_get(root, "simulation");
    const struct wb_json *over = wb_json_get(simulation, "overridden");
    assert_non_null(over);
    assert_close(number(over, "duration_s"), 0.5, 0.0);
    assert_close(number(over, "mass_scaling"), 100.0, 0.0);
    assert_close_relative(number(over, "cohesive_stiffness_N_mm3"), 60.0, 1e-15);
    assert_close(number(wb_json_get(over, "friction"), "static"), 0.3, 0.0);
    assert_close(number(wb_json_get(over, "friction"), "kinetic"), 0.2, 0.0);
    assert_close_relative(number(wb_json_get(over, "friction"), "decay_s_mm"), 1.5, 1e-15);
    assert_close(number(wb_json_get(simulation, "friction"), "kinetic"), 0.2, 0.0);
    assert_true(wb_json_get_boolean(over, "dead_force", &flag) && flag);
    assert_null(wb_json_get(over, "no_weight"));
    assert_null(wb_json_get(over, "mesh"));
    wb_json_destroy(root);

    assert_int_equal(tool("--duration-s 0.5 --friction 0.25 -o constant"), 0);
    read_all("constant/dataset.json", out, sizeof out);
    assert_int_equal(wb_json_parse(&root, out, "dataset.json"), WB_OK);
    const struct wb_json *friction = wb_json_get(wb_json_get(root, "simulation"), "friction");
    assert_close(number(friction, "static"), 0.25, 0.0);
    assert_close(number(friction, "kinetic"), 0.25, 0.0);
    assert_close(number(friction, "decay_s_mm"), 0.0, 0.0);
    wb_json_destroy(root);
}

static void options_of_others_are_refused(void **unused)
{
    (void)unused;
    assert_int_not_equal(tool("--points 5"), 0);
    assert_non_null(strstr(err, "--points"));
    assert_int_not_equal(tool("--mesh none"), 0);
    assert_non_null(strstr(err, "there is no mesh 'none'"));
    assert_int_not_equal(tool("--mass-scaling 0.5"), 0);
    assert_int_not_equal(tool("--cohesive-stiffness 0"), 0);
    assert_int_not_equal(tool("--friction 0.3,0.2"), 0);
    assert_non_null(strstr(err, "expected S or S,K,D"));
    assert_int_not_equal(tool("--friction 0.3,0.2,1,4"), 0);
    assert_int_not_equal(tool("--friction 0.3,,1"), 0);
    assert_int_not_equal(tool("--friction 0.2,0.3,1"), 0);
    assert_non_null(strstr(err, "more than the static one"));
    assert_int_not_equal(tool("--friction 11"), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(json_has_the_curve_and_what_it_took),
        cmocka_unit_test(datasets_are_those_of_the_homogenised_beam),
        cmocka_unit_test(what_was_overridden_is_told),
        cmocka_unit_test(options_of_others_are_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
