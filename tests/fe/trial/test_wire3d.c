/* The 3D wire compared with the 1D beam, the exact rod and the reference tables. */
#include "tests/fe/trial/computed_wires.h"

#include "base/units.h"
#include "fe/trial/cantilever.h"

/* --- the solid cylinder of the reference --- */

/* Tension of the 1D beam of type 3 at a deflection, its weight upwards. */
struct rod {
    struct wb_section section;
    struct wb_cantilever *beam;
};

static void begin_beam(struct rod *rod, double density)
{
    struct wb_cantilever_model model;

    wb_cantilever_default_model(&model);
    assert_int_equal(wb_section_init_circle(&rod->section, 1.4e-3, &type3, 40), WB_OK);
    model.section = &rod->section;
    model.length = 85e-3;
    model.n_elements = 100;
    model.mass_per_length = density * M_PI * 1.4e-3 * 1.4e-3 / 4.0;
    model.gravity_y = 9.81;
    assert_int_equal(wb_cantilever_create(&rod->beam, &model, NULL), WB_OK);
}

static double beam_tension(struct rod *rod, double deflection)
{
    struct wb_cantilever_point point;
    assert_int_equal(wb_cantilever_move(rod->beam, WB_CONTROL_DEFLECTION, deflection, &point),
                     WB_OK);
    assert_int_equal(point.end, WB_CANTILEVER_CONVERGED);
    return point.tension;
}

static void solid_cylinder_agrees_with_the_rod_and_its_springback(void **state)
{
    (void)state;
    struct computed *c = begin_from_file("solid-cylinder-type3");
    struct rod rod;
    double worst = 0.0, at_53 = 0.0;

    c->model.step[0].rows = 18;
    c->model.step[1].rows = 4;
    compute(c, NULL);
    assert_true(c->run.converged);
    assert_int_equal(c->run.n_elements, 720);
    begin_beam(&rod, c->model.part[0].density);
    for (int i = 0; i < c->run.n_rows; i++) {
        const struct wb_wire_row *row = &c->run.rows[i];
        if (row->step != 0)
            break;
        const double tension = beam_tension(&rod, row->tip[1]);
        if (row->tip[1] >= 5e-3)
            worst = fmax(worst, fabs(row->tension / tension - 1.0));
        at_53 = row->tension;
    }
    print_message("from 5 mm on within %.3f %% of the rod; at 53 mm %.6f N, residual %.3f mm\n",
                  100.0 * worst, at_53, last_row(c)->tip[1] / WB_MM);
    assert_true(worst < 0.003);
    assert_close_relative(at_53, 0.155210, 0.003);
    assert_close(last_row(c)->tension, 0.0, 1e-9);
    assert_close(last_row(c)->tip[1], 33.474e-3, 0.1e-3);
    wb_cantilever_destroy(rod.beam);
    wb_section_release(&rod.section);
    end(c);
}

/* Plastic work by backward Euler is too large by half an increment's hardening: the difference
 * between work and energies decreases with the increments. */
static void energies_balance_as_the_increments_shrink(void **state)
{
    (void)state;
    double gap[3];
    struct computed *c;

    for (int k = 0; k < 3; k++) {
        struct wb_wire3d_balance balance;
        c = begin_rod(30e-3, 1.4e-3, type3, 15);
        c->model.n_steps = 1;
        c->model.step[0] = (struct wb_wire_step){
            .name = "raised", .kind = WB_WIRE_STEP_DEFLECTION, .deflection = 12e-3, .rows = 8 << k};
        compute(c, NULL);
        wb_wire3d_balance(c->wire, &balance);
        gap[k] = fabs(balance.elastic + balance.dissipated - balance.work) / balance.work;
        end(c);
    }
    print_message("gap of the energies with 8, 16, 32 increments: %.2f, %.2f, %.2f %%\n",
                  100.0 * gap[0], 100.0 * gap[1], 100.0 * gap[2]);
    assert_true(gap[1] < 0.7 * gap[0] && gap[2] < 0.7 * gap[1]);
    assert_true(gap[2] < 0.02);
}

/* --- elastic wires and closed forms --- */

static void no_node_is_stressed_beyond_its_flow_stress(void **state)
{
    (void)state;
    struct computed *c = begin_rod(30e-3, 1.4e-3, type3, 15);
    struct wb_wire3d_fields fields;
    double closest = 0.0;

    c->model.n_steps = 1;
    c->model.step[0] = (struct wb_wire_step){
        .name = "raised", .kind = WB_WIRE_STEP_DEFLECTION, .deflection = 12e-3, .rows = 8};
    compute(c, NULL);
    wb_wire3d_fields(c->wire, &fields);
    for (int e = 0; e < wb_wire3d_mesh(c->wire)->n_elements; e++)
        for (int k = 0; k < WB_SOLID_MESH_NODES; k++) {
            const double *s = fields.stress[e][k];
            const double mises =
                sqrt(0.5 * (pow(s[0] - s[1], 2.0) + pow(s[1] - s[2], 2.0) + pow(s[2] - s[0], 2.0)) +
                     3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
            closest = fmax(closest, mises / wb_material_flow_stress(&type3, fields.plastic[e][k]));
        }
    assert_close(closest, 1.0, 1e-12);
    wb_wire3d_fields_release(&fields);
    end(c);
}

static void elastic_wire_under_a_follower_force_is_the_exact_rod(void **state)
{
    (void)state;
    struct computed *c = begin_from_file("follower-8awg-elastic");

    c->model.step[0].rows = 4;
    c->model.elements_along = 40;
    compute(c, NULL);
    assert_true(c->run.converged);
    const struct wb_wire_row *row = last_row(c);
    print_message("tip at (%.4f, %.4f) mm, turned by %.3f degrees\n", row->tip[0] / WB_MM,
                  row->tip[1] / WB_MM, row->tip_angle / WB_DEGREE);
    assert_close_relative(row->tip[0], 97.3646e-3, 0.003);
    assert_close_relative(row->tip[1], 20.7793e-3, 0.003);
    assert_close_relative(row->tip_angle, 18.080 * WB_DEGREE, 0.003);
    assert_close(row->tip[2], 0.0, 1e-9);
    assert_close_relative(row->force, 24.0, 1e-12);
    end(c);
}

/* Von Mises stress of part 0 at a node's reference position. */
static double stress_at(const struct computed *c, double x, double y, double z)
{
    const struct wb_solid_mesh *mesh = wb_wire3d_mesh(c->wire);
    struct wb_wire3d_fields fields;
    double stress = (double)NAN;

    wb_wire3d_fields(c->wire, &fields);
    for (int e = 0; e < mesh->n_elements; e++)
        for (int a = 0; a < WB_SOLID_MESH_NODES; a++) {
            const double *X = mesh->node[mesh->element[e][a]];
            if (mesh->part[e] == 0 &&
                fabs(X[0] - x) + fabs(X[1] - y) + fabs(X[2] - z) < 1e-6 * c->model.length)
                stress = wb_material_von_mises(fields.stress[e][a]);
        }
    wb_wire3d_fields_release(&fields);
    return stress;
}

/* One core diameter from the clamp, whose corner is singular. The stress of the rod, E_Cu kappa r,
 * is 696.93 MPa at the root and 675.08 MPa there. With logarithmic strain and Cauchy stress it is
 * larger on the compressed side than on the tensile one. */
static void stress_in_the_coppers_outer_fibre_is_that_of_the_rod(void **state)
{
    (void)state;
    struct computed *c = begin_from_file("follower-8awg-elastic");
    const double radius = 0.5 * c->model.part[0].outer_diameter;

    assert_int_equal(c->model.section_density, 1);
    c->model.step[0].rows = 2;
    c->model.elements_along = 46; /* a node at 3.2609 mm */
    compute(c, NULL);
    assert_true(c->run.converged);
    const double x = 3.0 / 92.0 * c->model.length;
    const double low = stress_at(c, x, -radius, 0.0), high = stress_at(c, x, radius, 0.0);
    print_message("copper's outer fibre at %.3f mm: %.2f MPa pulled, %.2f MPa pressed, mean %.2f\n",
                  x / WB_MM, low / WB_MPA, high / WB_MPA, 0.5 * (low + high) / WB_MPA);
    assert_close_relative(0.5 * (low + high), 675.08e6, 0.01);
    assert_close_relative(low, high, 0.02);
    end(c);
}

static void contact_with_friction_hardly_changes_the_elastic_wire(void **state)
{
    (void)state;
    static const char *const names[2] = {"follower-8awg-elastic", "follower-8awg-elastic-contact"};
    struct computed *both[2];
    struct wb_wire3d_balance balance;

    for (int k = 0; k < 2; k++) {
        both[k] = begin_from_file(names[k]);
        both[k]->model.step[0].rows = 2;
        both[k]->model.elements_along = 25;
        compute(both[k], NULL);
        assert_true(both[k]->run.converged);
    }
    const struct wb_wire_run *bonded = &both[0]->run, *sliding = &both[1]->run;
    double apart = 0.0;
    for (int i = 0; i < bonded->n_rows * bonded->n_shape; i++)
        for (int k = 0; k < 3; k++)
            apart = fmax(apart, fabs(bonded->shape[i][k] - sliding->shape[i][k]));
    wb_wire3d_balance(both[1]->wire, &balance);
    print_message("bonded and with friction: shapes within %.5f mm, slip of %.2f um\n",
                  apart / WB_MM, 1e6 * balance.slip);
    assert_true(apart > 0.0 && apart < 1e-3 * last_row(both[0])->tip[1]);
    assert_true(balance.slip > 0.1e-6 && balance.slip < 0.1 * balance.slip_limit);
    end(both[0]);
    end(both[1]);
}

/* a = F L^2 / EI and x/L, y/L, angle: exact follower solution. */
static void strongly_curled_elastic_wire_agrees_with_the_exact_rod(void **state)
{
    (void)state;
    static const double exact[][4] = {{2.0, 0.767362, 0.573839, 0.968239},
                                      {6.0, 0.049502, 0.740274, 2.365547},
                                      {10.0, -0.092123, 0.546983, 2.992715}};
    const double length = 0.1, diameter = 1e-3, EI = flexural_rigidity(1e9, diameter);
    struct computed *c = begin_rod(length, diameter, soft, 50);

    c->model.n_steps = 3;
    for (int k = 0; k < 3; k++)
        c->model.step[k] = (struct wb_wire_step){
            .name = "curl",
            .loads.follower = {0.0, exact[k][0] * EI / (length * length), 0.0},
            .rows = 4};
    compute(c, NULL);
    assert_true(c->run.converged);
    for (int k = 0; k < 3; k++) {
        const struct wb_wire_row *row = &c->run.rows[4 * (k + 1)];
        assert_close(row->tip[0] / length, exact[k][1], 2e-3);
        assert_close(row->tip[1] / length, exact[k][2], 2e-3);
        assert_close(row->tip_angle, exact[k][3], 4e-3);
    }
    end(c);
}

static void end_moment_rolls_the_wire_up_into_a_circle(void **state)
{
    (void)state;
    const double length = 0.1, diameter = 1e-3, EI = flexural_rigidity(1e9, diameter);
    struct computed *c = begin_rod(length, diameter, soft, 60);

    c->model.n_steps = 1;
    c->model.step[0] = (struct wb_wire_step){
        .name = "roll", .loads.moment = {0.0, 0.0, 2.0 * M_PI * EI / length}, .rows = 12};
    compute(c, NULL);
    assert_true(c->run.converged);
    const struct wb_wire_row *row = last_row(c);
    print_message("rolled up: tip at (%.3f, %.3f) mm of a length of 100 mm, %d iterations\n",
                  row->tip[0] / WB_MM, row->tip[1] / WB_MM, c->run.iterations);
    assert_close(row->tip[0], 0.0, 0.005 * length);
    assert_close(row->tip[1], 0.0, 0.005 * length);
    assert_close(row->tip_angle, 2.0 * M_PI, 0.01 * 2.0 * M_PI);
    end(c);
}

static void tip_moment_twists_by_torsional_rigidity(void **state)
{
    (void)state;
    const double length = 0.05, diameter = 2e-3;
    const double GJ = 1e9 / 2.6 * M_PI * pow(diameter, 4.0) / 32.0;
    struct computed *c = begin_rod(length, diameter, soft, 20);

    c->model.n_steps = 1;
    c->model.step[0] = (struct wb_wire_step){
        .name = "twist", .loads.moment = {0.1 * GJ / length, 0.0, 0.0}, .rows = 1};
    compute(c, NULL);
    assert_true(c->run.converged);
    struct wb_wire3d_fields fields;
    wb_wire3d_fields(c->wire, &fields);
    const struct wb_solid_mesh *mesh = wb_wire3d_mesh(c->wire);
    double turn = 0.0;
    for (int i = 0; i < mesh->n_nodes; i++) {
        const double *X = mesh->node[i];
        if (fabs(X[0] - length) < 1e-9 && fabs(X[1] - 0.5 * diameter) < 1e-9)
            turn = atan2(fields.position[i][2], fields.position[i][1]);
    }
    assert_close_relative(turn, 0.1, 0.005);
    wb_wire3d_fields_release(&fields);
    end(c);
}

static void a_force_bends_equally_in_every_direction(void **state)
{
    (void)state;
    double way[3];

    for (int k = 0; k < 3; k++) {
        const double angle = k * 0.25 * M_PI;
        struct computed *c = begin_rod(0.03, 1.4e-3, type3, 10);
        c->model.n_steps = 1;
        c->model.step[0] = (struct wb_wire_step){
            .name = "push", .loads.force = {0.0, 0.2 * cos(angle), 0.2 * sin(angle)}, .rows = 3};
        compute(c, NULL);
        assert_true(c->run.converged);
        const double *tip = last_row(c)->tip;
        way[k] = hypot(tip[1], tip[2]);
        assert_close(atan2(tip[2], tip[1]), angle, 1e-4);
        end(c);
    }
    assert_close_relative(way[1], way[0], 2e-3);
    assert_close_relative(way[2], way[0], 1e-6);
}

static void weight_bends_the_wire_like_a_beam(void **state)
{
    (void)state;
    const double length = 0.05, diameter = 1e-3, EI = flexural_rigidity(1e9, diameter);
    struct computed *c = begin_rod(length, diameter, soft, 25);

    c->model.part[0].density = 2000.0;
    c->model.gravity[1] = -9.81;
    c->model.n_steps = 1;
    c->model.step[0] = (struct wb_wire_step){.name = "nothing", .rows = 1};
    compute(c, NULL);
    assert_true(c->run.converged);
    const double q = 2000.0 * 9.81 * M_PI * diameter * diameter / 4.0;
    assert_close_relative(c->run.rows[0].tip[1], -q * pow(length, 4.0) / (8.0 * EI), 0.005);
    assert_close(last_row(c)->tip[1], c->run.rows[0].tip[1], 1e-9);
    end(c);
}

static void strand_agrees_with_the_beam_and_becomes_slack(void **state)
{
    (void)state;
    struct computed *c = begin_rod(85e-3, 1.4e-3, type3, 40);
    struct wb_section section;
    struct wb_cantilever_model model;
    struct wb_cantilever *beam;
    struct wb_cantilever_point point;

    c->model.strand_length = 0.2;
    c->model.n_steps = 2;
    c->model.step[0] = (struct wb_wire_step){
        .name = "up", .kind = WB_WIRE_STEP_DEFLECTION, .deflection = 50e-3, .rows = 5};
    c->model.step[1] = (struct wb_wire_step){.name = "down",
                                             .kind = WB_WIRE_STEP_DEFLECTION,
                                             .deflection = 0.0,
                                             .rows = 5,
                                             .unloads = true};
    compute(c, NULL);
    assert_true(c->run.converged);

    wb_cantilever_default_model(&model);
    assert_int_equal(wb_section_init_circle(&section, 1.4e-3, &type3, 40), WB_OK);
    model.section = &section;
    model.length = 85e-3;
    model.strand_length = 0.2;
    assert_int_equal(wb_cantilever_create(&beam, &model, NULL), WB_OK);
    for (int i = 1; i < c->run.n_rows; i++) {
        const struct wb_wire_row *row = &c->run.rows[i];
        if (row->phase == WB_PHASE_SLACK) {
            assert_close(row->tension, 0.0, 1e-9);
            continue;
        }
        assert_int_equal(wb_cantilever_move(beam, WB_CONTROL_DEFLECTION, row->tip[1], &point),
                         WB_OK);
        assert_close_relative(row->tension, point.tension, 0.005);
        assert_close(row->vertical_force, point.vertical_force, 0.005 * point.tension);
    }
    assert_int_equal(last_row(c)->phase, WB_PHASE_SLACK);
    assert_true(last_row(c)->tip[1] > 20e-3);
    wb_cantilever_destroy(beam);
    wb_section_release(&section);
    end(c);
}

/* --- paths and their ends --- */

static struct computed *begin_column(double along)
{
    struct computed *c = begin_rod(0.04, 1.4e-3, type3, 10);
    c->model.n_steps = 1;
    c->model.step[0] =
        (struct wb_wire_step){.name = "push", .loads.force = {along, 0.005, 0.0}, .rows = 4};
    return c;
}

/* A plastic column carries less load after buckling. Beyond the largest load the arc continues,
 * with every point in equilibrium: at its tip's deflection the 1D beam under the same inclined
 * force has the same position. */
static void arc_follows_a_plastic_column_past_its_largest_load(void **state)
{
    (void)state;
    struct computed *c = begin_column(-3.0);
    double largest = 0.0, smallest_after = 1e9;

    compute(c, NULL);
    for (int i = 0; i < c->run.n_rows; i++) {
        const double load = -c->run.rows[i].loads.force[0];
        if (load > largest && i < 10)
            largest = load;
        if (c->run.rows[i].tip[1] > 5e-3)
            smallest_after = fmin(smallest_after, load);
        assert_close(c->run.rows[i].fraction, load / 3.0, 1.1e-6);
    }
    const double euler = M_PI * M_PI * flexural_rigidity(4528e6, 1.4e-3) / (4.0 * 0.04 * 0.04);
    print_message("largest load %.3f N (Euler's %.3f N), then down to %.3f N\n", largest, euler,
                  smallest_after);
    assert_true(largest < euler && largest > 0.5 * euler);
    assert_true(smallest_after < 0.7 * largest);
    assert_true(c->run.converged);
    assert_close_relative(last_row(c)->loads.force[0], -3.0, 1e-12);
    end(c);
}

/* Under 1.5 times its critical load an elastic column has a second, nearly straight equilibrium, to
 * which a large increment of Newton's method jumps. It must converge to the bent one. */
static void loads_do_not_jump_to_an_unstable_branch(void **state)
{
    (void)state;
    struct computed *c = begin_column(0.0);
    const double euler = M_PI * M_PI * flexural_rigidity(4528e6, 1.4e-3) / (4.0 * 0.04 * 0.04);

    c->model.part[0].material.hardening = WB_HARDENING_NONE_ELASTIC;
    c->model.step[0].loads.force[0] = -1.518 * euler;
    compute(c, NULL);
    assert_true(c->run.converged);
    /* Elastica: P / P_cr = 1.518 rotates the end by 100 degrees (Timoshenko & Gere, table 2-4), and
     * its deflection is 0.792 L, its height 0.349 L. */
    assert_close(last_row(c)->tip_angle / WB_DEGREE, 100.0, 1.0);
    assert_close(last_row(c)->tip[1] / 0.04, 0.792, 0.01);
    assert_close(last_row(c)->tip[0] / 0.04, 0.349, 0.01);
    end(c);
}

static void completed_rows_are_kept_when_it_does_not_converge(void **state)
{
    (void)state;
    struct computed *c = begin_rod(0.006, 1.4e-3, type3, 3);

    c->model.part[0].material.strength_coefficient = 0.0;
    c->model.n_steps = 1;
    c->model.step[0] =
        (struct wb_wire_step){.name = "pull", .loads.force = {40.0, 0.0, 0.0}, .rows = 20};
    compute(c, NULL);
    /* Perfectly plastic: it yields at 4.52 MPa times 1.539 mm2 = 6.96 N. */
    assert_false(c->run.converged);
    assert_true(c->run.n_rows >= 4);
    assert_true(c->run.rows[3].loads.force[0] == 6.0);
    assert_true(strstr(c->run.problem, "step 'pull', row 4") != NULL);
    /* Beyond its largest load it necks, on one of many paths: must not be followed for long. */
    assert_true(c->run.iterations < 1000);
    end(c);
}

static bool stop_after_three(void *context, const struct wb_wire_run *run, int step,
                             double fraction, int iterations, double done)
{
    (void)run, (void)step, (void)fraction, (void)iterations, (void)done;
    return ++*(int *)context < 3;
}

static void observer_stops_the_run(void **state)
{
    (void)state;
    int calls = 0;
    const struct wb_wire_observer observer = {.increment = stop_after_three, .context = &calls};
    struct computed *c = begin_rod(0.02, 1.4e-3, type3, 4);

    c->model.n_steps = 1;
    c->model.step[0] =
        (struct wb_wire_step){.name = "push", .loads.force = {0.0, 0.1, 0.0}, .rows = 20};
    compute(c, &observer);
    assert_true(c->run.stopped);
    assert_int_equal(calls, 3);
    assert_true(c->run.n_rows <= 3);
    end(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solid_cylinder_agrees_with_the_rod_and_its_springback),
        cmocka_unit_test(energies_balance_as_the_increments_shrink),
        cmocka_unit_test(no_node_is_stressed_beyond_its_flow_stress),
        cmocka_unit_test(elastic_wire_under_a_follower_force_is_the_exact_rod),
        cmocka_unit_test(stress_in_the_coppers_outer_fibre_is_that_of_the_rod),
        cmocka_unit_test(contact_with_friction_hardly_changes_the_elastic_wire),
        cmocka_unit_test(strongly_curled_elastic_wire_agrees_with_the_exact_rod),
        cmocka_unit_test(end_moment_rolls_the_wire_up_into_a_circle),
        cmocka_unit_test(tip_moment_twists_by_torsional_rigidity),
        cmocka_unit_test(a_force_bends_equally_in_every_direction),
        cmocka_unit_test(weight_bends_the_wire_like_a_beam),
        cmocka_unit_test(strand_agrees_with_the_beam_and_becomes_slack),
        cmocka_unit_test(arc_follows_a_plastic_column_past_its_largest_load),
        cmocka_unit_test(loads_do_not_jump_to_an_unstable_branch),
        cmocka_unit_test(completed_rows_are_kept_when_it_does_not_converge),
        cmocka_unit_test(observer_stops_the_run),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
