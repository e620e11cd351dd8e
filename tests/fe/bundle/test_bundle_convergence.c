/* Convergence of explicit bundles with the mesh, along and over the section, and with the duration;
 * prints forces and orders. */
#include "tests/fe/bundle/bundles.h"

enum {
    MAX_ROWS = 16
};

/* The model with its own mesh, to `deflection`. */
static void set_mesh(int core, int rings, int along)
{
    struct wb_bundle_mesh *mesh = &model.mesh[0];
    assert_string_equal(mesh->name, model.run.mesh);
    mesh->core_quads = core;
    mesh->rings = rings;
    mesh->elements_along = along;
}

static void get_forces(double force[MAX_ROWS])
{
    run_model(NULL);
    assert_true(result.converged && result.n_rows <= MAX_ROWS);
    assert_true(result.largest.imbalance < 0.01);
    for (int i = 0; i < result.n_rows; i++)
        force[i] = result.rows[i].force;
}

/* Order of convergence from three results, each with half the size (or twice the duration) of the
 * one before. */
static double order_of(double a, double b, double c)
{
    return log2((a - b) / (b - c));
}

/* --- one wire --- */

/* Elastic, so that only the mesh along the wire matters. Poisson's ratio is 0, because finer
 * elements would also resolve the effect of the clamp on the section. Elements with the shear of
 * their middle give F = 3 E I v / L^3 (1 + 1 / (4 n^2)). */
static void an_elastic_wire_converges_with_the_square_of_the_elements_length(void **unused)
{
    (void)unused;
    double force[4][MAX_ROWS];

    for (int m = 0; m < 4; m++) {
        read_model(ONE "run: {mesh: engineering, selective_mass_scaling: 100, deflection_mm: 4, "
                       "rows: 4, duration_s: 6}\nloads: {weight: false}\n");
        set_mesh(2, 1, 4 << m);
        model.type[0].material.poissons_ratio = 0.0;
        get_forces(force[m]);
    }
    print_message("elastic, elements along 4, 8, 16, over 32:");
    for (int m = 0; m < 3; m++)
        print_message(" %+.3f", 100.0 * (force[m][4] / force[3][4] - 1.0));
    print_message(" %% at 4 mm, orders");
    for (int m = 0; m < 2; m++) {
        const double order = order_of(force[m][4], force[m + 1][4], force[m + 2][4]);
        print_message(" %.2f", order);
        assert_true(order > 1.7 && order < 2.3);
    }
    print_message("\n");
}

/* Yielding: comparison with the fibre beam, with 4, 16 and 64 elements over the section. Up to 20
 * mm inertia has a similar effect. */
static void a_yielding_wire_converges_with_the_section(void **unused)
{
    (void)unused;
    static const int core[] = {2, 4, 8};
    double error[3] = {0.0};
    const struct test_wire wire = test_wire_type(3);
    struct wb_section section = test_section(&wire);
    const struct wb_cantilever_model beam = bundle_beam(&wire, &section);
    struct wb_cantilever *cantilever = test_cantilever(&beam);
    double exact[MAX_ROWS] = {0.0};

    for (int i = 1; i <= 5; i++) {
        struct wb_cantilever_point point;
        assert_int_equal(wb_cantilever_move(cantilever, WB_CONTROL_DEFLECTION, 10e-3 * i, &point),
                         WB_OK);
        exact[i] = point.tension;
    }
    for (int m = 0; m < 3; m++) {
        double force[MAX_ROWS];
        read_model(ONE "run: {mesh: engineering, selective_mass_scaling: 100, deflection_mm: 50, "
                       "rows: 5, duration_s: 4}\nloads: {weight: false}\n");
        set_mesh(core[m], 0, 40);
        get_forces(force);
        for (int i = 2; i <= 5; i++)
            error[m] = fmax(error[m], fabs(force[i] / exact[i] - 1.0));
        print_message("%d elements a section:", core[m] * core[m]);
        for (int i = 1; i <= 5; i++)
            print_message(" %+.2f", 100.0 * (force[i] / exact[i] - 1.0));
        print_message(" %% at 10 to 50 mm\n");
    }
    print_message("largest from 20 mm on: %.2f, %.2f, %.2f %%; orders %.2f, %.2f\n",
                  100.0 * error[0], 100.0 * error[1], 100.0 * error[2], log2(error[0] / error[1]),
                  log2(error[1] / error[2]));
    assert_true(error[0] < 0.035 && error[1] < 0.5 * error[0]);
    assert_true(error[2] < 0.005);
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
}

/* The force of inertia, and its energy, are proportional to the inverse square of the duration. The
 * first rows are elastic; where the wire begins to yield the sign changes, and the order cannot be
 * determined. */
static void inertia_decreases_with_the_square_of_the_duration(void **unused)
{
    (void)unused;
    static const double duration[] = {1.0, 2.0, 4.0, 8.0};
    double force[4][MAX_ROWS], kinetic[4];

    for (int m = 0; m < 4; m++) {
        read_model(ONE "run: {mesh: twelve, selective_mass_scaling: 100, deflection_mm: 20, "
                       "rows: 10}\nloads: {weight: false}\n");
        model.run.duration = duration[m];
        get_forces(force[m]);
        kinetic[m] = result.largest.kinetic;
        print_message("%g s: kinetic over internal energy %.4f; N:", duration[m], kinetic[m]);
        for (int i = 1; i <= 10; i++)
            print_message(" %.5f", force[m][i]);
        print_message("\n");
    }
    for (int m = 0; m < 2; m++) {
        print_message("orders at 2, 4, 6 mm, and of the kinetic energy:");
        for (int i = 1; i <= 3; i++) {
            const double order = order_of(force[m][i], force[m + 1][i], force[m + 2][i]);
            print_message(" %.2f", order);
            assert_true(order > 1.85 && order < 2.15);
        }
        print_message(", %.2f\n", log2(kinetic[m + 1] / kinetic[m + 2]));
    }
    assert_close(log2(kinetic[2] / kinetic[3]), 2.0, 0.1);
}

/* --- touching wires in a tape --- */

static void three_taped_wires_converge_along(void **unused)
{
    (void)unused;
    static const int along[] = {10, 20, 40, 80};
    double force[4][MAX_ROWS];

    for (int m = 0; m < 4; m++) {
        read_model("wires: [{wire: type3, count: 3}]\npacking: triangle\ntape: tape\n"
                   "run: {mesh: engineering, selective_mass_scaling: 100, deflection_mm: 24, rows: "
                   "6, duration_s: 1}\nloads: {weight: false}\n");
        set_mesh(2, 1, along[m]);
        get_forces(force[m]);
        print_message("%d along, N:", along[m]);
        for (int i = 1; i <= 6; i++)
            print_message(" %.5f", force[m][i]);
        print_message("\n");
    }
    double change[3] = {0.0}; /* largest change, relative to the force at the end */
    for (int m = 0; m < 3; m++) {
        for (int i = 1; i <= 6; i++)
            change[m] = fmax(change[m], fabs(force[m][i] - force[m + 1][i]) / force[3][6]);
        print_message("%s%.2f", m == 0 ? "changes: " : ", ", 100.0 * change[m]);
    }
    print_message(" %% of the force at 24 mm\n");
    assert_true(change[0] < 0.01 && change[2] < 0.003);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(an_elastic_wire_converges_with_the_square_of_the_elements_length,
                                  release),
        cmocka_unit_test_teardown(a_yielding_wire_converges_with_the_section, release),
        cmocka_unit_test_teardown(inertia_decreases_with_the_square_of_the_duration, release),
        cmocka_unit_test_teardown(three_taped_wires_converge_along, release),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
