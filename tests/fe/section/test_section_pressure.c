/* Contact forces between the wires of a section. */
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

/* The minimised function: imbalance squared and summed over all wires, plus a small multiple of the
 * sum of squared forces. */
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

/* Loads as in the model: no resultant, and no lateral load on wires in the plane of bending. */
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

static void forces_are_compressive_and_optimal(void **unused)
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

/* Wires loaded towards the centre: each of six presses on the centre and its neighbours. By
 * symmetry the forces with the smallest sum of squares are equal, p + 2 p cos 60 = the load. */
static void a_ring_pressed_inwards_shares_the_load_equally(void **unused)
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

static void tensile_load_gives_no_force_and_is_reported_as_imbalance(void **unused)
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
        cmocka_unit_test(forces_are_compressive_and_optimal),
        cmocka_unit_test(a_ring_pressed_inwards_shares_the_load_equally),
        cmocka_unit_test(tensile_load_gives_no_force_and_is_reported_as_imbalance),
    };
    return cmocka_run_group_tests(tests, create, release);
}
