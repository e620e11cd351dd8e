/* Forces of contacts between the wires of a section. */
#include "fe/section/section_pressure.h"

#include <stdlib.h>

#include "base/file.h"
#include "tests/check.h"

enum {
    MOST = 16
};

static struct wb_bundle_model model;
static struct wb_section_layout layout;
static struct wb_section_pressure *pressure;

static int create(void **unused)
{
    (void)unused;
    char path[WB_PATH];
    assert_int_equal(wb_file_find_fixture(path, "bundles", "7-type3", NULL), WB_OK);
    assert_int_equal(wb_bundle_model_read(&model, path), WB_OK);
    assert_int_equal(wb_section_layout_create(&layout, &model, true), WB_OK);
    pressure = wb_section_pressure_create(&layout, 2);
    return 0;
}

static int release(void **unused)
{
    (void)unused;
    wb_section_pressure_destroy(pressure);
    wb_section_layout_release(&layout);
    return 0;
}

/* What is missing, squared and summed over all wires, plus a little of the forces' squares: what
 * the least of is looked for. */
static double cost(const double *load, const double *force, double little)
{
    double sum = 0.0;
    for (int e = 0; e < 2 * layout.n_wires; e++) {
        double value = load[e];
        for (int c = 0; c < layout.n_contacts; c++)
            value += layout.balance[e * layout.n_contacts + c] * force[c];
        sum += layout.wires[e / 2].weight * value * value;
    }
    for (int c = 0; c < layout.n_contacts; c++)
        sum += little * layout.contacts[c].weight * force[c] * force[c];
    return sum;
}

static double noise(void)
{
    return 2.0 * rand() / RAND_MAX - 1.0;
}

/* As the model loads the wires: no force on the whole, nothing across on wires in the plane. */
static void make_load(double *load)
{
    double mean = 0.0;
    for (int w = 0; w < layout.n_wires; w++) {
        load[2 * w] = noise();
        load[2 * w + 1] = layout.wires[w].weight > 1.0 ? noise() : 0.0;
        mean += layout.wires[w].weight * load[2 * w] / layout.n_packing;
    }
    for (int w = 0; w < layout.n_wires; w++)
        load[2 * w] -= mean;
}

static void forces_press_and_no_other_forces_that_press_balance_better(void **unused)
{
    (void)unused;
    srand(7);
    for (int trial = 0; trial < 200; trial++) {
        double load[2 * MOST], force[MOST], other[MOST];
        make_load(load);
        const double missing = wb_section_pressure_solve(pressure, trial % 2, load, force);
        for (int c = 0; c < layout.n_contacts; c++)
            assert_true(force[c] >= 0.0);
        const double least = cost(load, force, 0.0);
        assert_close(missing, sqrt(least), 1e-9);
        for (int c = 0; c < layout.n_contacts; c++)
            for (int sign = -1; sign <= 1; sign += 2)
                for (int size = 1; size < 6; size++) {
                    memcpy(other, force, sizeof other);
                    other[c] = fmax(other[c] + sign * pow(10.0, -size), 0.0);
                    assert_true(cost(load, other, 1e-7) >= cost(load, force, 1e-7) - 1e-12);
                }
    }
}

/* Wires pressed from all sides alike: each of six presses the centre and its neighbours. The forces
 * with the least sum of squares are equal by symmetry, p + 2 p cos 60 = the load. */
static void a_ring_of_wires_pressed_inwards_shares_the_load_alike(void **unused)
{
    (void)unused;
    double load[2 * MOST] = {0}, force[MOST];
    for (int w = 0; w < layout.n_wires; w++) {
        const double y = layout.wires[w].y, z = layout.wires[w].z, r = hypot(y, z);
        load[2 * w] = r > 1e-6 ? -y / r : 0.0;
        load[2 * w + 1] = r > 1e-6 ? -z / r : 0.0;
    }
    assert_close(wb_section_pressure_solve(pressure, 0, load, force), 0.0, 1e-6);
    for (int c = 0; c < layout.n_contacts; c++)
        assert_close(force[c], 0.5, 1e-6);
}

static void what_pulls_apart_presses_nothing_and_is_missing_whole(void **unused)
{
    (void)unused;
    double load[2 * MOST] = {0}, force[MOST], squares = 0.0;
    for (int w = 0; w < layout.n_wires; w++) {
        load[2 * w] = layout.wires[w].y;
        load[2 * w + 1] = layout.wires[w].z;
        squares += layout.wires[w].weight *
                   (load[2 * w] * load[2 * w] + load[2 * w + 1] * load[2 * w + 1]);
    }
    assert_close_relative(wb_section_pressure_solve(pressure, 1, load, force), sqrt(squares), 1e-9);
    for (int c = 0; c < layout.n_contacts; c++)
        assert_close(force[c], 0.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_press_and_no_other_forces_that_press_balance_better),
        cmocka_unit_test(a_ring_of_wires_pressed_inwards_shares_the_load_alike),
        cmocka_unit_test(what_pulls_apart_presses_nothing_and_is_missing_whole),
    };
    return cmocka_run_group_tests(tests, create, release);
}
