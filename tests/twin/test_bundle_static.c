/* The static bundle against beams and closed forms. */
#include "tests/fe/bundle/bundles.h"
#include "tests/twin/bundle_static.h"
#include "tests/twin/bundle_static_private.h"

#define OVER_EACH_OTHER                                                                            \
    "wires: [{wire: type3, count: 2}]\npacking: places\nplaces_mm: [[-0.7, 0], [0.7, 0]]\n"
#define NO_WEIGHT "loads: {weight: false}\n"

static struct wb_bundle_static *bundle;

static void create(const struct wb_bundle_static_settings *settings)
{
    wb_bundle_static_destroy(bundle);
    bundle = NULL;
    assert_int_equal(wb_bundle_static_create(&bundle, &model, settings), WB_OK);
}

static int destroy(void **state)
{
    (void)state;
    wb_bundle_static_destroy(bundle);
    bundle = NULL;
    return 0;
}

/* Moves and insists on convergence. */
static struct wb_bundle_static_point move(double deflection)
{
    struct wb_bundle_static_point point;
    assert_int_equal(wb_bundle_static_move(bundle, deflection, &point), WB_OK);
    assert_string_equal(point.problem, "");
    assert_int_equal(point.end, WB_BUNDLE_STATIC_CONVERGED);
    return point;
}

static void make_elastic(void)
{
    model.type[0].material.yield_stress = 1e15;
    model.tape.material.material.yield_stress = 1e15;
}

static double imbalance(void)
{
    struct wb_bundle_static_energies e;
    wb_bundle_static_get_energies(bundle, &e);
    return e.wires + e.contact + e.friction + e.tape + e.bonds - e.external;
}

/* --- wires alone --- */

static void free_wires_are_so_many_times_one_wire(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(3);
    struct wb_section section = test_section(&wire);
    const struct wb_cantilever_model beam = bundle_beam(&wire, &section);
    struct wb_cantilever *cantilever = test_cantilever(&beam);
    const struct wb_bundle_static_settings settings = {.contact = WB_BUNDLE_STATIC_APART,
                                                       .no_tape = true};
    read_model(SEVEN NO_WEIGHT);
    create(&settings);
    for (int i = 1; i <= 7; i++) {
        /* Up to 53 mm, and back. */
        const double deflection = (i < 6 ? 10.6 * i : 53.0 - 16.0 * (i - 5)) * 1e-3;
        const struct wb_bundle_static_point point = move(deflection);
        const struct wb_cantilever_point one =
            test_move(cantilever, WB_CONTROL_DEFLECTION, deflection);
        assert_close_relative(point.vertical, 7.0 * one.tension, 1e-3);
        assert_close(point.tip_x, one.tip_x, 1e-5);
    }
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
}

static void one_wire_on_a_strand_is_the_cantilever_with_its_slack(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(3);
    struct wb_section section = test_section(&wire);
    struct wb_cantilever_model beam = bundle_beam(&wire, &section);
    beam.strand_length = 0.76;
    beam.gravity_y = -WB_STANDARD_GRAVITY;
    struct wb_cantilever *cantilever = test_cantilever(&beam);
    static const double path[] = {0e-3, 10e-3, 30e-3, 50e-3, 40e-3, 20e-3, 10e-3, 30e-3};
    int slack = 0;

    read_model(ONE "loads: {strand_mm: 760, weight: true}\n");
    create(NULL);
    for (int i = 0; i < 8; i++) {
        const struct wb_bundle_static_point point = move(path[i]);
        const struct wb_cantilever_point one =
            test_move(cantilever, WB_CONTROL_DEFLECTION, path[i]);
        assert_int_equal(point.slack, one.slack);
        assert_close(point.deflection, one.deflection, 2e-5);
        assert_close(point.tension, one.slack ? 0.0 : one.tension, 2e-3 * 0.08);
        assert_close(point.vertical, one.slack ? 0.0 : one.vertical_force, 2e-3 * 0.08);
        slack += point.slack;
    }
    assert_true(slack > 0 && slack < 7);
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
}

/* --- limits --- */

/* Vertical force at a small deflection of an elastic cantilever. */
static double beam_force(double rigidity, double shear_stiffness, double deflection)
{
    const double length = model.length;
    return deflection / (length * length * length / (3.0 * rigidity) + length / shear_stiffness);
}

static double shear_stiffness_of_a_wire(void)
{
    const double radius = 0.5 * model.type[0].outer_diameter;
    return wb_section_shear_modulus(&model.type[0].material) * M_PI * radius * radius;
}

static void glued_wires_are_a_beam_whose_sections_stay_plane(void **unused)
{
    (void)unused;
    const struct wb_bundle_static_settings settings = {
        .contact = WB_BUNDLE_STATIC_GLUED, .no_tape = true, .stiffness = 100.0};
    static const char *const bundles[] = {OVER_EACH_OTHER NO_WEIGHT, SEVEN NO_WEIGHT};

    for (int i = 0; i < 2; i++) {
        read_model(bundles[i]);
        make_elastic();
        const int n = model.packing.n;
        const double E = model.type[0].material.youngs_modulus;
        const double d = model.type[0].outer_diameter, A = M_PI_4 * d * d;
        double second = n * A * d * d / 16.0;
        for (int w = 0; w < n; w++)
            second += A * model.packing.wire[w].y * model.packing.wire[w].y;
        create(&settings);
        const struct wb_bundle_static_point point = move(0.1e-3);
        assert_close_relative(
            point.vertical, beam_force(E * second, n * shear_stiffness_of_a_wire(), 0.1e-3), 3e-3);
    }
}

/* With the tape as a tube; its own shear and the bonds are made stiff. */
static void a_bonded_tape_is_a_tube_round_the_beam(void **unused)
{
    (void)unused;
    const struct wb_bundle_static_settings settings = {.contact = WB_BUNDLE_STATIC_GLUED,
                                                       .stiffness = 100.0};
    read_model(SEVEN NO_WEIGHT);
    make_elastic();
    model.tape.material.material.youngs_modulus *= 20.0;
    model.tape.material.material.poissons_ratio = 0.0; /* wires keep their diameter */
    model.interface.normal_stiffness *= 1e4;
    model.interface.shear_stiffness *= 1e4;
    const struct wb_bundle_rigidity rigidity = wb_bundle_model_rigidity(&model);

    assert_true(rigidity.tape[0] > 0.2 * rigidity.bonded[0]);
    create(&settings);
    const struct wb_bundle_static_point point = move(0.1e-3);
    assert_close_relative(point.vertical,
                          beam_force(rigidity.bonded[0], 7.0 * shear_stiffness_of_a_wire(), 0.1e-3),
                          0.01);
}

/* Two wires pressed together by q per length slip all along as soon as the shear flow of the
 * undivided beam, F A d / 2 / I, reaches mu q; then the friction takes F_mu = mu q d of the force,
 * and the rest bends two single wires. On the way back twice as much is needed. */
static void laminated_beam_slips_at_its_friction(void **unused)
{
    (void)unused;
    const double mu = 0.3, q = 30.0;
    const struct wb_bundle_static_settings settings = {
        .contact = WB_BUNDLE_STATIC_HELD,
        .no_tape = true,
        .stiffness = 100.0,
        .has_friction = true,
        .friction = mu,
        .squeeze = q,
        .largest_increment = 0.2e-3,
    };
    read_model(OVER_EACH_OTHER NO_WEIGHT);
    make_elastic();
    create(&settings);
    const double E = model.type[0].material.youngs_modulus, L = model.length;
    const double d = model.type[0].outer_diameter, A = M_PI_4 * d * d, I = A * d * d / 16.0;
    const double whole = 2.0 * I + 0.5 * A * d * d, slip_force = mu * q * whole / (0.5 * A * d);
    const double stick = 3.0 * E * whole / (L * L * L), slide = 3.0 * E * 2.0 * I / (L * L * L);
    const double first = slip_force / stick;
    assert_true(first > 0.5e-3 && first < 2e-3);

    struct wb_bundle_static_point point = move(0.7 * first);
    assert_close_relative(point.vertical, 0.7 * slip_force, 0.01);
    assert_true(point.slipping < 0.1);
    const double far = 3.0 * first;
    point = move(far);
    assert_true(point.slipping > 0.95);
    assert_close_relative(point.vertical, mu * q * d + slide * far, 0.01);
    /* Sticks, and then slips the other way. */
    point = move(2.0 * first);
    assert_true(point.slipping < 0.05);
    assert_close_relative(point.vertical, mu * q * d + slide * far - stick * first, 0.02);
    point = move(-first);
    assert_true(point.slipping > 0.95);
    assert_close_relative(point.vertical, -mu * q * d - slide * first, 0.02);

    struct wb_bundle_static_energies e;
    wb_bundle_static_get_energies(bundle, &e);
    assert_true(e.friction > 0.5 * e.external);
    assert_true(fabs(imbalance()) < 0.02 * e.external);
}

/* --- the whole bundle --- */

static void work_goes_where_it_is_found(void **unused)
{
    (void)unused;
    const struct wb_bundle_static_settings settings = {.n_elements = 40,
                                                       .largest_increment = 0.25e-3};
    struct wb_bundle_static_energies e;

    read_model(SEVEN NO_WEIGHT);
    create(&settings);
    struct wb_bundle_static_point point = move(10e-3);
    wb_bundle_static_get_energies(bundle, &e);
    assert_true(e.wires > 0.0 && e.contact > 0.0 && e.friction > 0.0 && e.tape > 0.0 &&
                e.bonds > 0.0);
    assert_true(fabs(imbalance()) < 1e-3 * e.external);
    point = move(6e-3);
    assert_true(fabs(imbalance()) < 2e-3 * e.external);
    assert_true(point.pressed > 0.0 && point.deepest < 1e-6);
}

/* The force at the tip bends all wires and the tape at the clamp; what the wires carry there does
 * not exceed it, and without a tape's membrane it is all of it. */
static void moments_balance_about_the_clamp(void **unused)
{
    (void)unused;
    const struct wb_bundle_static_settings settings = {.contact = WB_BUNDLE_STATIC_HELD,
                                                       .no_tape = true};
    read_model(SEVEN NO_WEIGHT);
    create(&settings);
    const struct wb_bundle_static_point point = move(20e-3);
    double moment = 0.0, push = 0.0;
    for (int w = 0; w < 7; w++) {
        struct wb_bundle_static_wire wire;
        wb_bundle_static_get_wire(bundle, w, 0, &wire);
        /* The resultants act in the middle of the first element. */
        const double c = cos(0.5 * wire.curvature * model.length / 80.0);
        const double s = sin(0.5 * wire.curvature * model.length / 80.0);
        const double fx = wire.normal * c - wire.transverse * s;
        moment += wire.moment - fx * model.packing.wire[w].y;
        push += wire.normal * s + wire.transverse * c;
    }
    assert_close_relative(push, point.vertical, 1e-4);
    assert_close_relative(moment, point.vertical * (point.tip_x - 0.5 * model.length / 80.0), 2e-3);
}

static void more_bond_more_tape_and_more_friction_are_stiffer(void **unused)
{
    (void)unused;
    double force[4];

    for (int i = 0; i < 4; i++) {
        const struct wb_bundle_static_settings settings = {
            .n_elements = 40, .has_friction = true, .friction = i == 1 ? 0.8 : 0.2};
        read_model(SEVEN NO_WEIGHT);
        if (i == 2)
            model.interface.shear_stiffness *= 3.0;
        if (i == 3)
            model.tape.material.material.youngs_modulus *= 2.0;
        create(&settings);
        force[i] = move(5e-3).vertical;
    }
    for (int i = 1; i < 4; i++)
        assert_true(force[i] > 1.005 * force[0]);
}

static void elements_and_lines_are_enough(void **unused)
{
    (void)unused;
    double force[3];

    for (int i = 0; i < 3; i++) {
        const struct wb_bundle_static_settings settings = {.n_elements = i == 1 ? 80 : 40,
                                                           .arc_nodes = i == 2 ? 5 : 3};
        read_model(SEVEN NO_WEIGHT);
        create(&settings);
        force[i] = move(5e-3).vertical;
    }
    assert_close_relative(force[1], force[0], 2e-3);
    assert_close_relative(force[2], force[0], 5e-3);
}

/* --- what it refuses --- */

static void sections_without_mirror_image_are_refused(void **unused)
{
    (void)unused;
    struct wb_bundle_static *none = NULL;

    read_model("wires: [{wire: type3, count: 2}]\npacking: places\n"
               "places_mm: [[-0.7, 0.1], [0.7, 0]]\n" NO_WEIGHT);
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_bundle_static_create(&none, &model, NULL), WB_ERR_UNSUPPORTED);
    assert_null(none);
    const struct wb_bundle_static_settings wrong = {.arc_nodes = 1};
    read_model(SEVEN NO_WEIGHT);
    assert_int_equal(wb_bundle_static_create(&none, &model, &wrong), WB_ERR_ARGUMENT);
    assert_null(none);
    wb_log_set_sink(NULL, NULL);
}

static void tape_on_a_circle_or_bonded_beside_is_refused(void **unused)
{
    (void)unused;
    static const struct wb_bundle_static_settings bare = {.no_tape = true};
    struct wb_bundle_static *none = NULL;

    read_model(
        SEVEN
        "taping: {layout: sleeve, layers: 2, outline: circle, bond_reach_mm: 0.01}\n" NO_WEIGHT);
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_bundle_static_create(&none, &model, NULL), WB_ERR_UNSUPPORTED);
    assert_null(none);
    read_model(SEVEN "taping: {layout: sleeve, layers: 2, bond_reach_mm: 0.01}\n" NO_WEIGHT);
    assert_int_equal(wb_bundle_static_create(&none, &model, NULL), WB_ERR_UNSUPPORTED);
    assert_null(none);
    wb_log_set_sink(NULL, NULL);
    create(&bare);
}

/* --- contact --- */

/* What faced each other beyond a wire's end faces each other again when both lie straight. */
static void places_off_a_wires_end_come_back(void **unused)
{
    (void)unused;
    read_model(SEVEN NO_WEIGHT);
    create(NULL);
    assert_true(bundle->n_pairs > 0);
    for (int p = 0; p < bundle->n_pairs; p++) {
        struct wb_bundle_static_touch *tip = &bundle->pair[p].touch[bundle->n_stations - 1];
        tip->shift = p % 2 ? 1.5 : -1.5;
        tip->active = false;
    }
    wb_bundle_static_face(bundle);
    for (int p = 0; p < bundle->n_pairs; p++) {
        assert_true(bundle->pair[p].touch[bundle->n_stations - 1].active);
        assert_close(bundle->pair[p].touch[bundle->n_stations - 1].shift, 0.0, 1e-9);
    }
}

static void what_does_not_converge_says_so_and_stays_in_equilibrium(void **unused)
{
    (void)unused;
    const struct wb_bundle_static_settings settings = {
        .n_elements = 40, .max_iterations = 1, .smallest_increment = 0.1e-3};
    struct wb_bundle_static_point point;

    read_model(SEVEN NO_WEIGHT);
    create(&settings);
    assert_int_equal(wb_bundle_static_move(bundle, 5e-3, &point), WB_OK);
    assert_int_equal(point.end, WB_BUNDLE_STATIC_NOT_CONVERGED);
    assert_true(strlen(point.problem) > 0);
    assert_true(point.deflection == 0.0 && point.vertical == 0.0);
}

#define TEST(name) cmocka_unit_test_teardown(name, destroy)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(free_wires_are_so_many_times_one_wire),
        TEST(one_wire_on_a_strand_is_the_cantilever_with_its_slack),
        TEST(glued_wires_are_a_beam_whose_sections_stay_plane),
        TEST(a_bonded_tape_is_a_tube_round_the_beam),
        TEST(laminated_beam_slips_at_its_friction),
        TEST(work_goes_where_it_is_found),
        TEST(moments_balance_about_the_clamp),
        TEST(more_bond_more_tape_and_more_friction_are_stiffer),
        TEST(elements_and_lines_are_enough),
        TEST(sections_without_mirror_image_are_refused),
        TEST(tape_on_a_circle_or_bonded_beside_is_refused),
        TEST(places_off_a_wires_end_come_back),
        TEST(what_does_not_converge_says_so_and_stays_in_equilibrium),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
