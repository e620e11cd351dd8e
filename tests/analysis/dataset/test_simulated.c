/* Computed wires as datasets. */
#include "tests/schemas.h"

#include <stdlib.h>

#include "analysis/dataset/simulated.h"
#include "base/file.h"
#include "base/units.h"
#include "fe/trial/wire_run_private.h"

static struct wb_wire_model model;
static struct wb_wire_run run;

static void read_model(const char *name)
{
    char path[WB_PATH];
    assert_int_equal(wb_file_find_fixture(path, "models", name, NULL), WB_OK);
    assert_int_equal(wb_wire_model_read(&model, path), WB_OK);
    assert_int_equal(wb_wire_run_init(&run, &model, 3), WB_OK);
}

/* A row whose tip stands at (x, y, z) in mm. */
static void add(int step, double fraction, double x, double y, double z)
{
    const struct wb_wire_row row = {
        .step = step,
        .fraction = fraction,
        .loads = model.step[step].loads,
        .tip = {x * WB_MM, y * WB_MM, z * WB_MM},
        .tangent = {0.8, 0.6, 0.0},
        .tension = 3.0 + y,
        .vertical_force = 2.0 + y,
    };
    const double shape[3][3] = {
        {0}, {0.05, 0.5 * y * WB_MM, 0.5 * z * WB_MM}, {x * WB_MM, y * WB_MM, z * WB_MM}};
    wb_wire_run_add(&run, &model, &row, false, shape);
}

static void write_and_read(const struct wb_simulated_wire *wire, const char *name,
                           struct wb_dataset *read)
{
    struct wb_dataset dataset;
    char path[WB_PATH];
    assert_int_equal(wb_file_join(path, folder, name), WB_OK);
    wb_dataset_init(&dataset);
    wb_simulated_fill_wire(&dataset, wire);
    /* -0 is nothing to print. */
    assert_true(dataset.info.gravity != 0.0 || !signbit(dataset.info.gravity));
    assert_int_equal(wb_dataset_write(&dataset, path, false), WB_OK);
    wb_dataset_release(&dataset);
    assert_int_equal(wb_dataset_read(read, path, NULL), WB_OK);
}

static double number(const struct wb_json *object, const char *key)
{
    double value = (double)NAN;
    if (!wb_json_get_number(object, key, &value))
        fail_msg("no number '%s'", key);
    return value;
}

static void assert_text(const struct wb_json *object, const char *key, const char *expected)
{
    const char *text = NULL;
    if (!wb_json_get_text(object, key, &text))
        fail_msg("no text '%s'", key);
    assert_string_equal(text, expected);
}

static bool flag(const struct wb_json *object, const char *key)
{
    bool value = false;
    if (!wb_json_get_boolean(object, key, &value))
        fail_msg("no flag '%s'", key);
    return value;
}

static void follower_test_is_a_dataset_of_its_force(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    read_model("follower-8awg-elastic");
    add(0, 0.0, 100.0, 0.0, 0.0);
    add(0, 0.5, 97.0, 4.0, 0.0);
    add(0, 1.0, 97.0, 4.0, 0.0);
    const struct wb_wire3d_balance balance = {.work = 1.5, .elastic = 1.25};
    const struct wb_simulated_wire wire = {.solver = "wire3d",
                                           .model = &model,
                                           .run = &run,
                                           .balance = &balance,
                                           .wall = 2.0,
                                           .cpu = 1.0,
                                           .peak_memory = 5e7};
    write_and_read(&wire, "follower", &dataset);
    assert_true(dataset.info.is_simulation && dataset.info.is_follower);
    assert_false(dataset.info.is_virtual);
    assert_string_equal(dataset.info.wire, "8awg");
    assert_close_relative(dataset.info.length, 0.1, 1e-12);
    assert_close_relative(dataset.info.outer_diameter, 4.86e-3, 1e-12);
    assert_close_relative(dataset.info.mass_per_length, wb_wire_model_mass_per_length(&model),
                          1e-12);
    assert_close(dataset.info.poissons_ratio, 0.39, 0.005);
    assert_close(dataset.info.gravity, 0.0, 0.0);

    assert_int_equal(dataset.n_rows, 3);
    assert_close(dataset.rows[1].force, 24.0, 0.0);
    assert_close(dataset.rows[1].tension, 7.0, 0.0);
    assert_close(dataset.rows[1].deflection, 4e-3, 1e-15);
    assert_close(dataset.rows[1].tip_x, 97e-3, 1e-15);
    assert_close(dataset.rows[1].tip_angle, atan2(0.6, 0.8), 1e-12);
    /* The tip's way at 1 mm/s, and on. */
    assert_close(dataset.rows[0].t, 0.0, 0.0);
    assert_close(dataset.rows[1].t, 5.0, 1e-9);
    assert_close(dataset.rows[2].t, 5.001, 1e-9);
    assert_int_equal(dataset.n_shape_rows, 9);
    assert_true(isnan(dataset.shape_rows[4].z));
    assert_close(dataset.shape_rows[4].s, 0.05, 1e-15);
    assert_close(dataset.shape_rows[4].y, 2e-3, 1e-15);

    const struct wb_json *const simulation = wb_json_get(dataset.document, "simulation");
    assert_text(dataset.document, "name", "follower-8awg-elastic, simulated wire3d");
    assert_true(flag(dataset.document, "complete"));
    assert_text(simulation, "model", "wire3d");
    assert_text(simulation, "file", "follower-8awg-elastic.yaml");
    const struct wb_json *const inputs = wb_json_get(simulation, "inputs");
    assert_text(inputs, "solver", "wire3d");
    assert_close(number(inputs, "version"), WB_WIRE3D_VERSION, 0.0);
    assert_close(number(inputs, "length_mm"), 100.0, 1e-9);
    assert_text(simulation, "law", "elastic");
    assert_true(flag(simulation, "substitutes"));
    assert_close(number(simulation, "cpu_s"), 1.0, 0.0);
    assert_close(number(simulation, "wall_s"), 2.0, 0.0);
    assert_close(number(simulation, "peak_memory_MB"), 50.0, 1e-12);
    assert_close(number(wb_json_get(simulation, "energy"), "work_J"), 1.5, 0.0);
    assert_text(wb_json_get(simulation, "interface"), "kind", "bonded");
    assert_close(number(wb_json_get(simulation, "mesh"), "elements_along"), 60.0, 0.0);
    assert_close_relative(number(wb_json_get(simulation, "homogenised"), "youngs_modulus_MPa"),
                          13840.0, 1e-3);
    const struct wb_json *const parts = wb_json_get(simulation, "parts");
    assert_int_equal(wb_json_length(parts), 2);
    assert_text(wb_json_item(parts, 1), "material", "pvc");
    assert_true(flag(wb_json_item(parts, 1), "substitute"));
    assert_close(number(wb_json_item(parts, 0), "youngs_modulus_MPa"), 68200.0, 1e-9);
    double yield;
    assert_false(wb_json_get_number(wb_json_item(parts, 0), "yield_stress_MPa", &yield));
    wb_dataset_release(&dataset);
    wb_wire_run_release(&run);
}

static void history_in_space_keeps_its_z_and_its_steps(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    read_model("residual-1-8awg");
    add(0, 0.0, 100.0, 0.0, 0.0);
    add(0, 1.0, 99.0, 1.0, 1.0);
    add(1, 1.0, 98.0, 5.0, -2.0);
    add(2, 1.0, 99.0, 2.0, -1.0);
    add(3, 0.5, 95.0, 10.0, -1.5);
    run.converged = false;
    snprintf(run.problem, sizeof run.problem, "nowhere to go");
    const struct wb_simulated_wire wire = {
        .solver = "wire1d", .model = &model, .run = &run, .wall = 2.0, .cpu = 1.0};
    write_and_read(&wire, "space", &dataset);
    assert_true(dataset.info.is_general && !dataset.info.is_follower);
    assert_close(dataset.rows[2].force, 2.0 + 5.0, 0.0);
    assert_int_equal(dataset.rows[2].phase, WB_PHASE_LOAD);
    assert_int_equal(dataset.rows[3].phase, WB_PHASE_UNLOAD);
    assert_int_equal(dataset.rows[4].cycle, 2);
    assert_close(dataset.shape_rows[3 * 2 + 2].z, -2e-3, 1e-15);

    const struct wb_json *const simulation = wb_json_get(dataset.document, "simulation");
    assert_false(flag(dataset.document, "complete"));
    assert_false(flag(simulation, "converged"));
    assert_text(simulation, "problem", "nowhere to go");
    assert_null(wb_json_get(simulation, "interface"));
    const struct wb_json *const parts = wb_json_get(simulation, "parts");
    assert_close(number(wb_json_item(parts, 0), "yield_stress_MPa"), 182.0, 1e-9);
    assert_close(number(wb_json_item(parts, 0), "hardening_exponent"), 0.31, 0.0);
    const struct wb_json *const steps = wb_json_get(simulation, "steps");
    assert_int_equal(wb_json_length(steps), 4);
    assert_text(wb_json_item(steps, 2), "name", "unloaded");
    assert_text(wb_json_item(steps, 2), "kind", "loads");
    assert_close(number(wb_json_item(steps, 2), "last_row"), 4.0, 0.0);
    assert_close(number(wb_json_item(steps, 2), "t_s"), dataset.rows[3].t, 1e-12);
    assert_true(flag(wb_json_item(steps, 2), "complete"));
    assert_false(flag(wb_json_item(steps, 3), "complete"));
    wb_dataset_release(&dataset);
    wb_wire_run_release(&run);
}

static void raised_test_is_zeroed_and_weighs_upwards(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    read_model("solid-cylinder-type3");
    add(0, 0.0, 85.0, 0.0, 0.0);
    add(0, 1.0, 60.0, 53.0, 0.0);
    add(1, 1.0, 70.0, 33.0, 0.0);
    const struct wb_wire3d_balance balance = {0};
    const struct wb_simulated_wire wire = {
        .solver = "wire3d", .model = &model, .run = &run, .balance = &balance};
    write_and_read(&wire, "raised", &dataset);
    assert_close(dataset.info.gravity, -9.81, 1e-12);
    assert_false(dataset.info.is_follower || dataset.info.is_general);
    assert_close(dataset.rows[0].force, 0.0, 0.0);
    assert_close(dataset.rows[1].force, 53.0, 0.0);
    assert_close(dataset.rows[1].tension, 56.0, 0.0);
    assert_int_equal(dataset.rows[2].phase, WB_PHASE_UNLOAD);
    const struct wb_json *const simulation = wb_json_get(dataset.document, "simulation");
    assert_close(number(simulation, "zero_force_N"), 2.0, 0.0);
    assert_false(flag(simulation, "substitutes"));
    wb_dataset_release(&dataset);
    wb_wire_run_release(&run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(follower_test_is_a_dataset_of_its_force),
        cmocka_unit_test(history_in_space_keeps_its_z_and_its_steps),
        cmocka_unit_test(raised_test_is_zeroed_and_weighs_upwards),
    };
    return cmocka_run_group_tests(tests, make_folder, check_and_remove_folder);
}
