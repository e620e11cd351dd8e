/* Difficult paths of computed wires: strands that become slack within a row, arcs past limit
 * points, ends that make full turns in one row, loads near round-off. */
#include "tests/fe/trial/computed_wires.h"

#include "base/units.h"
#include "fe/solid/solid.h"
#include "fe/solid/solid_tip.h"
#include "fe/trial/wire1d.h"

/* The same model as a rod. */
static void compute_rod(const struct wb_wire_model *model, struct wb_wire_run *run)
{
    struct wb_wire1d *rod;
    assert_int_equal(wb_wire1d_create(&rod, model, NULL), WB_OK);
    assert_int_equal(wb_wire_run_init(run, model, 7), WB_OK);
    assert_int_equal(wb_wire1d_run(rod, run, NULL), WB_OK);
    wb_wire1d_destroy(rod);
}

static struct wb_wire_step to_deflection(double deflection, int rows, bool unloads)
{
    return (struct wb_wire_step){.name = "move",
                                 .kind = WB_WIRE_STEP_DEFLECTION,
                                 .deflection = deflection,
                                 .rows = rows,
                                 .unloads = unloads};
}

/* Compares rows of the solid with those of the rod: deflection, tension, phase. */
static void assert_rows_alike(const struct computed *c, double most_apart)
{
    struct wb_wire_run rod;
    compute_rod(&c->model, &rod);
    assert_true(c->run.converged && rod.converged);
    assert_int_equal(c->run.n_rows, rod.n_rows);
    double largest = 0.0;
    for (int i = 0; i < rod.n_rows; i++)
        largest = fmax(largest, rod.rows[i].tension);
    for (int i = 0; i < rod.n_rows; i++) {
        assert_close(c->run.rows[i].tip[1], rod.rows[i].tip[1], most_apart);
        assert_close(c->run.rows[i].tension, rod.rows[i].tension, 0.005 * largest);
        assert_int_equal(c->run.rows[i].phase, rod.rows[i].phase);
    }
    wb_wire_run_release(&rod);
}

/* The strand is released where its tension becomes zero, for any length of the row: if the wire
 * were pushed down and then released, its residual deflection would be smaller. Pulled up again,
 * the strand becomes taut at the same position. */
static void strand_goes_slack_within_a_long_row(void **state)
{
    (void)state;
    struct computed *c = begin_rod(85e-3, 1.4e-3, type3, 20);

    c->model.strand_length = 0.2;
    c->model.n_steps = 3;
    c->model.step[0] = to_deflection(50e-3, 5, false);
    c->model.step[1] = to_deflection(0.0, 1, true);
    c->model.step[2] = to_deflection(52e-3, 4, false);
    compute(c, NULL);
    print_message("released at %.3f mm\n", c->run.rows[6].tip[1] / WB_MM);
    assert_int_equal(c->run.rows[6].phase, WB_PHASE_SLACK);
    assert_int_equal(c->run.rows[8].phase, WB_PHASE_SLACK);
    assert_int_equal(c->run.rows[9].phase, WB_PHASE_LOAD);
    assert_close(c->run.rows[9].tip[1], 39e-3, 1e-9);
    assert_rows_alike(c, 0.02e-3);
    end(c);
}

static void upward_weight_makes_the_strand_slack(void **state)
{
    (void)state;
    struct computed *c = begin_rod(85e-3, 1.4e-3, type3, 20);

    c->model.strand_length = 0.2;
    c->model.part[0].density = 4970.0;
    c->model.gravity[1] = 9.81;
    c->model.n_steps = 2;
    c->model.step[0] = to_deflection(5e-3, 5, false);
    c->model.step[1] = (struct wb_wire_step){
        .name = "released", .kind = WB_WIRE_STEP_RELEASE, .rows = 1, .unloads = true};
    compute(c, NULL);
    assert_int_equal(c->run.rows[0].phase, WB_PHASE_SLACK);
    assert_true(c->run.rows[0].tip[1] > 0.5e-3);
    assert_true(c->run.zero_force == 0.0);
    assert_rows_alike(c, 0.003e-3);
    end(c);
}

static void slack_lasts_until_there_is_tension_again(void **state)
{
    (void)state;
    struct computed *c = begin_rod(85e-3, 1.4e-3, type3, 20);

    c->model.strand_length = 0.3;
    c->model.part[0].density = 4970.0;
    c->model.gravity[1] = -9.81;
    c->model.n_steps = 3;
    c->model.step[0] = to_deflection(40e-3, 4, false);
    c->model.step[1] = to_deflection(5e-3, 3, true);
    c->model.step[2] = (struct wb_wire_step){
        .name = "released", .kind = WB_WIRE_STEP_RELEASE, .rows = 2, .unloads = true};
    compute(c, NULL);
    assert_int_equal(last_row(c)->phase, WB_PHASE_SLACK);
    assert_rows_alike(c, 0.02e-3);
    end(c);
}

/* Beyond the strand's reach its direction is NaN, never a plausible value. */
static void strand_has_no_direction_beyond_its_reach(void **state)
{
    (void)state;
    const struct wb_tip_loads none = {{0}};
    const struct wb_solid_tip_strand strand = {.length = 0.02, .x = 0.085};
    const double z[WB_SOLID_TIP_UNKNOWNS] = {0.0601, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    double inside[WB_SOLID_TIP_UNKNOWNS], phi[WB_SOLID_TIP_UNKNOWNS];

    memcpy(inside, z, sizeof inside);
    inside[0] = 0.0651;
    wb_solid_tip_forces(inside, &none, &strand, 1.0, phi, NULL);
    assert_close(phi[0] * phi[0] + phi[1] * phi[1], 1.0, 1e-14);
    wb_solid_tip_forces(z, &none, &strand, 1.0, phi, NULL);
    assert_true(isnan(phi[1]));
}

static void tip_angle_counts_whole_turns_within_a_row(void **state)
{
    (void)state;
    const double length = 0.1, diameter = 1e-3, EI = flexural_rigidity(1e9, diameter);
    struct computed *c = begin_rod(length, diameter, soft, 30);
    struct wb_wire_run rod;

    c->model.n_steps = 1;
    c->model.step[0] = (struct wb_wire_step){
        .name = "roll", .loads.moment = {0.0, 0.0, -2.0 * M_PI * EI / length}, .rows = 1};
    compute(c, NULL);
    assert_true(c->run.converged);
    assert_close(last_row(c)->tip_angle, -2.0 * M_PI, 0.02 * 2.0 * M_PI);
    compute_rod(&c->model, &rod);
    assert_true(rod.converged);
    assert_close(rod.rows[1].tip_angle, -2.0 * M_PI, 1e-3);
    wb_wire_run_release(&rod);
    end(c);
}

/* Its deflection is 5 nm: added to positions, it would lose its digits. */
static void weight_of_a_short_stiff_wire_is_carried(void **state)
{
    (void)state;
    const double length = 15e-3, diameter = 1e-3;
    struct wb_material stiff = soft;
    stiff.youngs_modulus = 200e9;
    struct computed *c = begin_rod(length, diameter, stiff, 12);

    c->model.part[0].density = 1000.0;
    c->model.gravity[1] = -9.81;
    c->model.n_steps = 1;
    c->model.step[0] = (struct wb_wire_step){.name = "nothing", .rows = 1};
    compute(c, NULL);
    assert_true(c->run.converged);
    assert_int_equal(c->run.cutbacks, 0);
    const double q = 1000.0 * 9.81 * M_PI * diameter * diameter / 4.0;
    const double beam = -q * pow(length, 4.0) / (8.0 * flexural_rigidity(200e9, diameter));
    print_message("weight bends it by %.3f nm\n", 1e9 * last_row(c)->tip[1]);
    assert_close_relative(last_row(c)->tip[1], beam, 0.03); /* shear: 1.3 % */
    end(c);
}

/* A load distributed over a section is below the tolerance at each of its nodes long before it is
 * negligible. It must still be carried. */
static void small_loads_after_large_ones_are_carried(void **state)
{
    (void)state;
    struct computed *c = begin_rod(0.1, 1e-3, soft, 20);
    const double force = 1e-3 * flexural_rigidity(1e9, 1e-3) / 0.01;

    c->model.n_steps = 2;
    c->model.step[0] =
        (struct wb_wire_step){.name = "up", .loads.force = {0.0, force, 0.0}, .rows = 1};
    c->model.step[1] = (struct wb_wire_step){
        .name = "aside", .loads.force = {0.0, force, 1e-5 * force}, .rows = 1};
    compute(c, NULL);
    assert_true(c->run.converged);
    print_message("a force of 1e-5 aside: %.4g of the deflection\n",
                  last_row(c)->tip[2] / last_row(c)->tip[1]);
    assert_close_relative(last_row(c)->tip[2] / last_row(c)->tip[1], 1e-5, 0.001);
    end(c);
}

static bool count_increments(void *context, double fraction, int iterations)
{
    (void)fraction, (void)iterations;
    ++*(int *)context;
    return true;
}

/* Near a critical load the remaining residual divided by almost zero stiffness is arbitrary. The
 * arc must start along the path, with its given length. */
static void arc_starts_along_the_path_near_buckling(void **state)
{
    (void)state;
    const double length = 0.03, diameter = 1e-3;
    const double euler = M_PI * M_PI * flexural_rigidity(1e9, diameter) / (4.0 * length * length);
    const struct wb_solid_mesh_wire shape = {.length = length,
                                             .n_parts = 1,
                                             .outer_diameter = {diameter},
                                             .elements_along = 8,
                                             .section_density = 1};
    const struct wb_solid_part part = {.material = soft};
    const struct wb_solid_settings coarse = {.force_tolerance = 1e-3};
    struct wb_solid_support supports[3 * 64];
    struct wb_solid_mesh mesh;
    struct wb_solid *solid;
    struct wb_solid_point point;
    struct wb_solid_tip before, after;
    int arcs = 0;

    assert_int_equal(wb_solid_mesh_sweep(&mesh, &shape), WB_OK);
    for (int i = 0; i < 3 * mesh.n_clamp; i++)
        supports[i] = (struct wb_solid_support){.node = mesh.clamp[i / 3], .axis = i % 3};
    const struct wb_solid_model model = {
        .mesh = &mesh, .parts = &part, .n_supports = 3 * mesh.n_clamp, .supports = supports};
    assert_int_equal(wb_solid_create(&solid, &model, &coarse), WB_OK);

    struct wb_solid_move move = {.control = WB_SOLID_LOADS,
                                 .target.tip.force = {-0.995 * euler, 1e-5 * euler, 0.0}};
    assert_int_equal(wb_solid_move(solid, &move, &point), WB_OK);
    assert_int_equal(point.end, WB_SOLID_CONVERGED);
    wb_solid_tip(solid, &before);

    move.control = WB_SOLID_ARC;
    move.target.tip.force[0] = -2.0 * euler;
    move.target.tip.force[1] = 2e-5 * euler;
    move.arc_length = 1e-3 * length;
    move.observer = count_increments;
    move.context = &arcs;
    assert_int_equal(wb_solid_move(solid, &move, &point), WB_OK);
    wb_solid_tip(solid, &after);
    double way = 0.0;
    for (int i = 0; i < 3; i++)
        way = hypot(way, after.position[i] - before.position[i]);
    print_message("an arc of %.2f um: the end moves by %.2f um, %d cutbacks\n",
                  1e6 * move.arc_length, 1e6 * way, point.cutbacks);
    assert_int_equal(point.end, WB_SOLID_CONVERGED);
    assert_int_equal(point.cutbacks, 0);
    assert_int_equal(arcs, 1);
    assert_close_relative(way, move.arc_length, 0.02);
    assert_true(after.position[1] > before.position[1]);
    wb_solid_destroy(solid);
    wb_solid_mesh_release(&mesh);
}

static void a_second_run_starts_from_the_virgin_state(void **state)
{
    (void)state;
    struct computed *c = begin_rod(0.02, 1.4e-3, type3, 4);
    struct wb_wire_run again;

    c->model.n_steps = 1;
    c->model.step[0] = to_deflection(6e-3, 2, false);
    compute(c, NULL);
    assert_int_equal(wb_wire_run_init(&again, &c->model, 7), WB_OK);
    assert_int_equal(wb_wire3d_run(c->wire, &again, NULL), WB_OK);
    assert_int_equal(again.n_rows, c->run.n_rows);
    for (int i = 0; i < again.n_rows; i++) {
        assert_true(again.rows[i].tension == c->run.rows[i].tension);
        assert_true(again.rows[i].tip[0] == c->run.rows[i].tip[0]);
    }
    wb_wire_run_release(&again);
    end(c);
}

/* The core of a pulled wire yields, its jacket, half as stiff, does not: the core slides out at the
 * end, by the difference of both strains over the length, without friction. */
static void sliding_beyond_the_limit_of_contact_is_reported(void **state)
{
    (void)state;
    static const double strains[2] = {0.002, 0.05};
    for (int k = 0; k < 2; k++) {
        struct computed *c = begin_rod(10e-3, 1e-3, soft, 5);
        struct wb_wire_model *m = &c->model;
        struct wb_wire3d_balance balance;
        m->part[0].material.hardening = WB_HARDENING_KINEMATIC_LINEAR;
        m->part[0].material.yield_stress = 1e6;
        m->part[0].material.strength_coefficient = 50e6;
        m->n_parts = 2;
        m->part[1] = m->part[0];
        m->part[1].inner_diameter = 1e-3;
        m->part[1].outer_diameter = m->wire.outer_diameter = 1.4e-3;
        m->part[1].material = soft;
        m->has_contact = true;
        wb_trial_default_jacket_contact(&m->jacket_contact, 1e9, 0.3, 0.2e-3, 0.0);
        /* Each part carries a share of the force as large as its share of sum E A. */
        const double area = M_PI * 1.96e-6 / 4.0;
        const double stress = 1e6 + 50e6 * strains[k];
        m->n_steps = 1;
        m->step[0] = (struct wb_wire_step){
            .name = "pull", .loads.force = {stress * area, 0.0, 0.0}, .rows = 4};
        compute(c, NULL);
        assert_true(c->run.converged);
        wb_wire3d_balance(c->wire, &balance);
        print_message("strain %.3f: sliding of %.1f um, good up to %.1f um\n", strains[k],
                      1e6 * balance.sliding, 1e6 * balance.slip_limit);
        assert_close_relative(balance.sliding, strains[k] * m->length,
                              k == 0 ? 0.03 : 0.12); /* the core becomes thinner */
        ;
        assert_true((balance.sliding > balance.slip_limit) == (k == 1));
        assert_close_relative(balance.slip_limit, 0.25 * M_PI * 1e-3 / 8.0, 1e-12);
        end(c);
    }
}

/* Non-finite input is rejected; NaN in every second unknown would be hidden by finite ones. */
static void invalid_solids_are_rejected(void **state)
{
    (void)state;
    static const double none[] = {(double)NAN, (double)INFINITY};
    wb_log_set_sink(discard_message, NULL);
    for (int k = 0; k < 10; k++) {
        struct computed *c = begin_rod(0.02, 1.4e-3, type3, 2);
        struct wb_material *m = &c->model.part[0].material;
        double *const values[] = {&c->model.gravity[1], &c->model.part[0].density, &m->yield_stress,
                                  &m->strength_coefficient, &m->hardening_exponent};
        *values[k / 2] = none[k % 2];
        c->model.n_steps = 1;
        assert_int_equal(wb_wire3d_create(&c->wire, &c->model), WB_ERR_ARGUMENT);
        assert_null(c->wire);
        end(c);
    }
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strand_goes_slack_within_a_long_row),
        cmocka_unit_test(upward_weight_makes_the_strand_slack),
        cmocka_unit_test(slack_lasts_until_there_is_tension_again),
        cmocka_unit_test(strand_has_no_direction_beyond_its_reach),
        cmocka_unit_test(tip_angle_counts_whole_turns_within_a_row),
        cmocka_unit_test(weight_of_a_short_stiff_wire_is_carried),
        cmocka_unit_test(small_loads_after_large_ones_are_carried),
        cmocka_unit_test(arc_starts_along_the_path_near_buckling),
        cmocka_unit_test(a_second_run_starts_from_the_virgin_state),
        cmocka_unit_test(sliding_beyond_the_limit_of_contact_is_reported),
        cmocka_unit_test(invalid_solids_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
