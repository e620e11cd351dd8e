/* The section model compared with closed forms, single wires and itself. */
#include "fe/section/section_solver.h"

#include <stdlib.h>

#include "fe/section/section_beam_private.h"
#include "fe/trial/cantilever.h"
#include "tests/fe/bundle/static_reference.h"
#include "tests/fe/section/section_fixture.h"

static const double small = 1e-6; /* m */

/* Three times E I of an elastic cantilever, from its force at a small deflection. */
static double rigidity(const struct wb_section_solver_settings *settings, double length)
{
    model.length = length;
    create(settings);
    const double force = move(small).vertical;
    wb_section_solver_destroy(solver);
    solver = NULL;
    return force * length * length * length / (3.0 * small);
}

/* --- limits --- */

/* With the law of the wires in `model`. */
static void compare_with_single_wires(void)
{
    static const double path[] = {5e-3, 20e-3, 40e-3, 53e-3, 40e-3, 20e-3};
    struct wb_section section;
    struct wb_cantilever *one;
    struct wb_cantilever_model beam;

    create(&(struct wb_section_solver_settings){.friction = 0.4, .beam.n_elements = 48});
    wb_cantilever_default_model(&beam);
    assert_int_equal(
        wb_section_init_law(&section, model.type[0].outer_diameter, &model.type[0].law, 0), WB_OK);
    beam.section = &section;
    beam.length = model.length;
    beam.gravity_y = 0.0;
    assert_int_equal(wb_cantilever_create(&one, &beam, NULL), WB_OK);
    for (int i = 0; i < 6; i++) {
        struct wb_cantilever_point expected;
        const struct wb_section_solver_point point = load(i > 0 ? path[i - 1] : 0.0, path[i], 10);
        assert_int_equal(wb_cantilever_move(one, WB_CONTROL_DEFLECTION, path[i], &expected), WB_OK);
        assert_close(point.vertical, 7.0 * expected.tension, 0.006 * 0.42);
        assert_close(point.tip_x, expected.tip_x, 2e-5);
    }
    wb_cantilever_destroy(one);
    wb_section_release(&section);
}

static void wires_without_tape_bend_like_single_wires(void **unused)
{
    (void)unused;
    read_bundle("7-type3");
    model.has_tape = false;
    compare_with_single_wires();
}

/* Parallel parts with kinematic hardening, which the explicit model does not support. */
static void wires_use_the_law_of_their_file(void **unused)
{
    (void)unused;
    static const struct wb_law_part parts[] = {
        {3000e6, 0.001}, {1000e6, 0.004}, {528e6, (double)INFINITY}};
    read_bundle("7-type3");
    model.has_tape = false;
    wb_law_init_parallel(&model.type[0].law, parts, 3, 0.3, 0.39);
    compare_with_single_wires();
}

static void a_strand_becomes_slack_as_for_single_wires(void **unused)
{
    (void)unused;
    static const double path[] = {0.0, 10e-3, 30e-3, 50e-3, 40e-3, 20e-3, 10e-3, 30e-3};
    struct wb_section section;
    struct wb_cantilever *one;
    struct wb_cantilever_model beam;
    int slack = 0;

    read_bundle("7-type3");
    model.has_tape = false;
    model.loads.weight = true;
    model.loads.strand_length = 0.76;
    create(&(struct wb_section_solver_settings){.beam = {.n_elements = 48, .n_fibres = 20}});
    wb_cantilever_default_model(&beam);
    assert_int_equal(
        wb_section_init_law(&section, model.type[0].outer_diameter, &model.type[0].law, 0), WB_OK);
    beam.section = &section;
    beam.length = model.length;
    beam.strand_length = 0.76;
    beam.mass_per_length = wb_bundle_model_wire_mass(&model) / 7.0;
    assert_int_equal(wb_cantilever_create(&one, &beam, NULL), WB_OK);
    for (int i = 0; i < 8; i++) {
        struct wb_cantilever_point expected;
        const struct wb_section_solver_point point = load(i > 0 ? path[i - 1] : 0.0, path[i], 10);
        assert_int_equal(wb_cantilever_move(one, WB_CONTROL_DEFLECTION, path[i], &expected), WB_OK);
        assert_int_equal(point.slack, expected.slack);
        assert_close(point.deflection, expected.deflection, 1e-4);
        assert_close(point.tension, expected.slack ? 0.0 : 7.0 * expected.tension, 0.006 * 0.45);
        assert_close(point.vertical, expected.slack ? 0.0 : 7.0 * expected.vertical_force,
                     0.006 * 0.45);
        slack += point.slack;
    }
    assert_true(slack > 0 && slack < 7);
    wb_cantilever_destroy(one);
    wb_section_release(&section);
}

static void glued_wires_bend_as_one_section_that_stays_plane(void **unused)
{
    (void)unused;
    const struct wb_section_solver_settings settings = {
        .beam = {.is_elastic = true, .is_glued = true, .slip_stiffness = 1e16, .n_elements = 48}};

    read_bundle("7-type3");
    model.has_tape = false;
    assert_close_relative(rigidity(&settings, 0.114), wb_bundle_model_rigidity(&model).bonded[0],
                          5e-4);
}

static void wires_and_tape_without_bonds_or_friction_add_up(void **unused)
{
    (void)unused;
    const struct wb_section_solver_settings settings = {
        .beam = {.is_elastic = true, .n_elements = 48}};

    read_bundle("7-type3-circle");
    model.interface.shear_stiffness = 0.0;
    /* The tape's tube and the wires bend independently; the circle is a polygon here. */
    assert_close_relative(rigidity(&settings, 0.114), wb_bundle_model_rigidity(&model).sliding[0],
                          0.01);
}

/* Seven wires with tape on arcs of 60 degrees: Newmark's theory of partial interaction, with the
 * bond of an arc and the shear of the tape to the next wire in series. */
static void seven_wires_follow_newmarks_theory(void **unused)
{
    (void)unused;
    const struct wb_section_solver_settings settings = {
        .beam = {.is_elastic = true, .n_elements = 96}};

    read_bundle("7-type3");
    const struct wb_bundle_rigidity limit = wb_bundle_model_rigidity(&model);
    const double radius = model.packing.wire[0].radius;
    const double thickness = wb_taping_thickness(&model.tape.taping);
    const struct wb_material *const tape = &model.tape.material.material;
    const double shear = 0.5 * tape->youngs_modulus / (1.0 + tape->poissons_ratio);
    const double way = 2.0 * radius + (radius + 0.5 * thickness) * M_PI / 3.0;
    const double k = 1.0 / (1.0 / (model.interface.shear_stiffness * radius * M_PI / 3.0) +
                            way / (shear * thickness));
    const double axial = model.type[0].material.youngs_modulus * M_PI * radius * radius;
    static const double length[] = {0.057, 0.114, 0.228};
    double before = limit.sliding[0];

    for (int i = 0; i < 3; i++) {
        const double a = sqrt(k / axial * limit.bonded[0] / limit.sliding[0]) * length[i];
        const double expected =
            limit.bonded[0] / (1.0 + 3.0 * (limit.bonded[0] / limit.sliding[0] - 1.0) / (a * a) *
                                         (1.0 - tanh(a) / a));
        const double found = rigidity(&settings, length[i]);
        print_message("L %g mm: E I %g N mm2, Newmark %g\n", length[i] * 1e3, found * 1e6,
                      expected * 1e6);
        assert_close_relative(found, expected, 0.04);
        assert_true(found > before && found < limit.bonded[0]);
        before = found;
    }
}

/* Elements, contact and the tape's wall are different in that reference. */
static void forces_are_those_of_the_static_reference(void **unused)
{
    (void)unused;
    static const struct {
        const char *bundle;
        const struct static_point *expected;
        bool no_tape, is_glued;
        double friction, limit;
    } curves[] = {
        {"7-type3", static_7, false, false, 0.4, 0.02},
        {"7-type3", static_7_frictionless, false, false, 0.0, 0.02},
        {"12-type3", static_12, false, false, 0.4, 0.02},
        {"7-type3", static_7_apart, true, false, 0.4, 0.01},
        {"7-type3", static_7_glued, true, true, 0.0, 0.01},
    };
    enum {
        POINTS = sizeof static_7 / sizeof static_7[0]
    };

    for (size_t c = 0; c < sizeof curves / sizeof curves[0]; c++) {
        const struct wb_section_solver_settings settings = {
            .friction = curves[c].friction,
            .beam = {.is_glued = curves[c].is_glued,
                     .slip_stiffness = curves[c].is_glued ? 1e16 : 0.0,
                     .n_elements = 48}};
        double from = 0.0, worst = 0.0;
        read_bundle(curves[c].bundle);
        model.has_tape = !curves[c].no_tape;
        create(&settings);
        for (int i = 0; i < POINTS; i++) {
            const struct static_point *const expected = &curves[c].expected[i];
            const double to = expected->deflection_mm * 1e-3;
            const struct wb_section_solver_point point = load(from, to, i == 0 ? 2 : 10);
            worst = fmax(worst, fabs(point.vertical / expected->force - 1.0));
            assert_close(point.tip_x, expected->tip_x_mm * 1e-3, 0.5e-3);
            from = to;
        }
        print_message("%s, mu = %g%s: largest difference %.2f %%\n", curves[c].bundle,
                      curves[c].friction, curves[c].no_tape ? ", no tape" : "", 100.0 * worst);
        assert_true(worst < curves[c].limit);
        destroy(NULL);
    }
}

/* --- friction, and general properties --- */

/* The dissipated energy differs from the work only by the summation rule. */
static double imbalance(int steps)
{
    read_bundle("7-type3");
    create(&(struct wb_section_solver_settings){.friction = 0.4});
    load(0.0, 53e-3, steps);
    load(53e-3, 20e-3, steps);
    const struct wb_section_beam_energies e = wb_section_solver_beam(solver)->energies;
    assert_true(e.wires > 0.0 && e.tape > 0.0 && e.bonds > 0.0 && e.friction > 0.0);
    const double lost = (e.external - e.wires - e.tape - e.bonds - e.friction) / e.external;
    wb_section_solver_destroy(solver);
    solver = NULL;
    return fabs(lost);
}

static void energies_balance_and_converge_with_the_steps(void **unused)
{
    (void)unused;
    const double coarse = imbalance(25), fine = imbalance(100);
    print_message("imbalance over external work: %.2g, of four times the steps %.2g\n", coarse,
                  fine);
    assert_true(coarse < 1e-3);
    assert_true(fine < 0.2 * coarse);
}

static double force_at_53_mm(const char *name, const struct wb_section_solver_settings *settings,
                             int steps)
{
    read_bundle(name);
    create(settings);
    const double force = load(0.0, 53e-3, steps).vertical;
    wb_section_solver_destroy(solver);
    solver = NULL;
    return force;
}

static void stiffness_increases_with_friction(void **unused)
{
    (void)unused;
    double before = 0.0;
    for (int i = 0; i < 4; i++) {
        const double force = force_at_53_mm(
            "12-type3", &(struct wb_section_solver_settings){.friction = 0.2 * i}, 20);
        assert_true(force > before * (i > 0 ? 1.01 : 1.0));
        before = force;
    }
}

static void default_elements_and_increments_are_fine_enough(void **unused)
{
    (void)unused;
    const double as_is =
        force_at_53_mm("12-type3", &(struct wb_section_solver_settings){.friction = 0.4}, 53);
    const double finer = force_at_53_mm(
        "12-type3", &(struct wb_section_solver_settings){.friction = 0.4, .beam.n_elements = 96},
        53);
    const double oftener =
        force_at_53_mm("12-type3", &(struct wb_section_solver_settings){.friction = 0.4}, 212);
    const double tighter = force_at_53_mm(
        "12-type3", &(struct wb_section_solver_settings){.friction = 0.4, .tolerance = 1e-10}, 53);
    print_message("F(53 mm) %.5f N; 96 elements %.5f, 212 increments %.5f, tolerance 1e-10 %.6f\n",
                  as_is, finer, oftener, tighter);
    assert_close_relative(as_is, finer, 1e-3);
    assert_close_relative(as_is, oftener, 1e-3);
    assert_close_relative(as_is, tighter, 1e-5);
}

static void sharing_unknowns_of_images_changes_nothing(void **unused)
{
    (void)unused;
    static const char *const bundles[] = {"7-type3", "7-type3-turned", "12-type3",
                                          "7-type3-circle"};

    for (int i = 0; i < 4; i++) {
        const double half =
            force_at_53_mm(bundles[i], &(struct wb_section_solver_settings){.friction = 0.4}, 20);
        const double whole = force_at_53_mm(
            bundles[i],
            &(struct wb_section_solver_settings){.friction = 0.4, .beam.is_whole = true}, 20);
        assert_close_relative(half, whole, 1e-4);
    }
}

/* A hexagon has the same second moment about every axis, and nearly the same slips. */
static void rotation_that_breaks_symmetry_changes_little(void **unused)
{
    (void)unused;
    const struct wb_section_solver_settings settings = {.friction = 0.4};

    read_bundle("7-type3");
    for (int i = 0; i < model.packing.n; i++) {
        struct wb_packing_circle *const wire = &model.packing.wire[i];
        const double y = wire->y, z = wire->z, angle = 0.2;
        wire->y = y * cos(angle) + z * sin(angle);
        wire->z = z * cos(angle) - y * sin(angle);
    }
    assert_int_equal(wb_hull_find(&model.tape.hull, &model.packing, 1e-9), WB_OK);
    create(&settings);
    assert_false(wb_section_solver_beam(solver)->layout.is_mirrored);
    const double turned = load(0.0, 53e-3, 53).vertical;
    destroy(NULL);
    assert_close_relative(turned, force_at_53_mm("7-type3", &settings, 53), 0.03);
}

static void a_capped_tip_has_no_slip_and_is_stiffer(void **unused)
{
    (void)unused;
    const struct wb_section_solver_settings settings = {.friction = 0.2};
    const double free_tip = force_at_53_mm("7-type3", &settings, 53);
    const double capped = force_at_53_mm("7-type3-capped", &settings, 53);

    assert_true(capped > 1.01 * free_tip && capped < 1.1 * free_tip);
    read_bundle("7-type3-capped");
    create(&settings);
    load(0.0, 20e-3, 20);
    const struct wb_section_beam *const beam = wb_section_solver_beam(solver);
    const int last = beam->n_elements, first = wb_section_beam_index(beam, last, 1);
    for (int i = 2; i < beam->per_station; i++)
        assert_int_equal(wb_section_beam_index(beam, last, i), first);
    /* A free cap has no axial force: the axial forces of its parts cancel. */
    assert_close(beam->residual[first], 0.0, 1e-5 * beam->axial);
}

/* --- Newton's method --- */

/* Increments and iterations of a loading to 53 mm in 53 rows. */
static struct wb_section_solver_point count(const struct wb_section_solver_settings *settings)
{
    struct wb_section_solver_point sum = {0};
    create(settings);
    for (int i = 0; i <= 53; i++) {
        const struct wb_section_solver_point point = move(i * 1e-3);
        sum.increments += point.increments;
        sum.iterations += point.iterations;
    }
    destroy(NULL);
    return sum;
}

/* Without a line search Newton's method alternates between sticking and slipping contacts in some
 * rows of this bundle. */
static void friction_converges_in_every_row_without_smaller_increments(void **unused)
{
    (void)unused;
    read_bundle("12-type3");
    const struct wb_section_solver_point sum =
        count(&(struct wb_section_solver_settings){.friction = 0.2, .beam.n_elements = 30});
    print_message("%d iterations in %d increments\n", sum.iterations, sum.increments);
    assert_int_equal(sum.increments, 54);
    assert_true(sum.iterations < 4 * 54);
}

static void an_inclined_strand_needs_hardly_more_iterations_than_a_force(void **unused)
{
    (void)unused;
    read_bundle("7-type3");
    const struct wb_section_solver_settings settings = {.tolerance = 1e-10};
    const int by_force = count(&settings).iterations;
    model.loads.strand_length = 0.05;
    const int by_strand = count(&settings).iterations;
    print_message("%d iterations by a force, %d by a strand of 50 mm\n", by_force, by_strand);
    assert_true(by_strand < 1.2 * by_force);
}

/* Compares residuals on either side of a state, along a random direction, with the tangent: solving
 * the tangent for the difference of the residuals gives the direction. */
static void check_tangent(const char *name, bool is_slipping, double strand)
{
    const struct wb_section_beam_settings settings = {.n_elements = 6};
    const struct wb_section_beam_loads loads = {.vertical = 1.5, .strand = strand, .weight = 0.6};
    const double step = 1e-7;
    struct wb_section_beam *beam;

    read_bundle(name);
    assert_int_equal(wb_section_beam_create(&beam, &model, is_slipping ? 0.2 : 0.0, &settings),
                     WB_OK);
    const int n = beam->n_unknowns;
    double *const at = test_malloc((size_t)n * sizeof(double));
    double *const way = test_malloc((size_t)n * sizeof(double));
    double *const right = test_malloc((size_t)n * sizeof(double));
    srand(5);
    for (int i = 0; i < n; i++) {
        const bool turns = i % beam->per_station == 0;
        at[i] = (turns ? 0.3 : 2e-4) * (1.0 + i / beam->per_station) / 6 +
                (turns ? 0.0 : 2e-4 * rand() / RAND_MAX);
        way[i] = (turns ? 1.0 : 1e-2) * (2.0 * rand() / RAND_MAX - 1.0);
    }
    memcpy(beam->u, at, (size_t)n * sizeof(double));
    wb_section_beam_evaluate(beam, &loads, true);
    for (int side = -1; side <= 1; side += 2) {
        for (int i = 0; i < n; i++)
            beam->u[i] = at[i] + side * step * way[i];
        wb_section_beam_evaluate(beam, &loads, false);
        for (int i = 0; i < n; i++)
            right[i] = (side < 0 ? 0.0 : right[i]) + side * beam->residual[i] / (2.0 * step);
    }
    memcpy(beam->u, at, (size_t)n * sizeof(double));
    wb_section_beam_evaluate(beam, &loads, false);
    assert_true(beam->tape_plastic > 0.001);
    assert_int_equal(beam->n_slipping > 0, is_slipping);
    /* The matrix lacks the part from the strand's rotation: V / (S cos^3 psi) draw draw^T. */
    double drawn = 0.0;
    for (int i = 0; i < n; i++)
        drawn += beam->draw[i] * way[i];
    const double secant = sqrt(1.0 + beam->tip.slope * beam->tip.slope);
    for (int i = 0; i < n && strand > 0.0; i++)
        right[i] -= loads.vertical / strand * pow(secant, 3.0) * drawn * beam->draw[i];
    assert_true(wb_section_beam_factor(beam, &loads));
    wb_layered_solve(beam->matrix, 1, right);
    for (int i = 0; i < n; i++)
        assert_close(right[i], way[i], 1e-4 * (i % beam->per_station == 0 ? 1.0 : 1e-2));
    test_free(at);
    test_free(way);
    test_free(right);
    wb_section_beam_destroy(beam);
}

static void the_tangent_is_the_derivative_of_the_residual(void **unused)
{
    (void)unused;
    check_tangent("7-type3", false, 0.0);
    check_tangent("7-type3", false, 0.05);
    check_tangent("7-type3", true, 0.0);
    check_tangent("7-type3-capped", true, 0.0);
    check_tangent("7-type3-circle", true, 0.0);
}

static void failed_move_is_reported_and_keeps_the_state(void **unused)
{
    (void)unused;
    struct wb_section_solver_point point;

    read_bundle("12-type3");
    create(&(struct wb_section_solver_settings){
        .friction = 0.4, .most_iterations = 1, .smallest_step = 0.5});
    wb_section_solver_move(solver, 0.0, &point);
    assert_int_equal(point.end, WB_SECTION_SOLVER_CONVERGED);
    wb_section_solver_move(solver, 30e-3, &point);
    assert_int_equal(point.end, WB_SECTION_SOLVER_NOT_CONVERGED);
    assert_close(point.deflection, 0.0, 1e-12);
    assert_close(point.vertical, 0.0, 1e-12);
    assert_true(point.residual > 1e-6);
}

/* Near 53 mm 61 wires press on each other so much that a change of friction changes the contact
 * forces by as much. Beyond, Newton's method finds an equilibrium with a smaller force on another
 * branch. */
static void equilibrium_on_another_branch_is_rejected(void **unused)
{
    (void)unused;
    enum {
        WIRES = 61
    };
    double diameter[WIRES];
    struct wb_section_solver_point point = {0};
    double before = 0.0;

    read_bundle("7-type3");
    for (int i = 0; i < WIRES; i++) {
        diameter[i] = model.type[0].outer_diameter;
        model.type_of[i] = 0;
    }
    assert_int_equal(wb_packing_on_lattice(&model.packing, WIRES, diameter, WB_PACKING_HEXAGON),
                     WB_OK);
    assert_int_equal(wb_hull_find(&model.tape.hull, &model.packing, 1e-9), WB_OK);
    model.loads = (struct wb_bundle_loads){.strand_length = 0.76, .weight = true};
    create(&(struct wb_section_solver_settings){.friction = 0.4, .smallest_step = 1.0 / 8.0});
    for (int i = 0; i <= 53 && point.end == WB_SECTION_SOLVER_CONVERGED; i++) {
        wb_section_solver_move(solver, i * 1e-3, &point);
        assert_true(point.vertical >= before);
        before = point.vertical;
    }
    print_message("61 wires end at %.2f mm with %.3f N\n", point.deflection * 1e3, before);
    assert_int_equal(point.end, WB_SECTION_SOLVER_NOT_CONVERGED);
    assert_true(point.deflection > 50e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(wires_without_tape_bend_like_single_wires),
        TEST(wires_use_the_law_of_their_file),
        TEST(a_strand_becomes_slack_as_for_single_wires),
        TEST(glued_wires_bend_as_one_section_that_stays_plane),
        TEST(wires_and_tape_without_bonds_or_friction_add_up),
        TEST(seven_wires_follow_newmarks_theory),
        TEST(forces_are_those_of_the_static_reference),
        TEST(energies_balance_and_converge_with_the_steps),
        TEST(stiffness_increases_with_friction),
        TEST(default_elements_and_increments_are_fine_enough),
        TEST(sharing_unknowns_of_images_changes_nothing),
        TEST(rotation_that_breaks_symmetry_changes_little),
        TEST(a_capped_tip_has_no_slip_and_is_stiffer),
        TEST(friction_converges_in_every_row_without_smaller_increments),
        TEST(an_inclined_strand_needs_hardly_more_iterations_than_a_force),
        TEST(the_tangent_is_the_derivative_of_the_residual),
        TEST(equilibrium_on_another_branch_is_rejected),
        TEST(failed_move_is_reported_and_keeps_the_state),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
