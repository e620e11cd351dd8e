/* The capped tip: a frame in closed form, and conservation laws. */
#include "fe/bundle/bundle_part.h"
#include "tests/fe/bundle/bundles_lead.h"

/* Two wires, one above the other, that do not touch: the cap makes them a frame. With the slope t
 * of the tip, one is E A t h / (2 L) in tension, the other in compression, and each gets the moment
 * -E A t h^2 / (4 L): F L^3 / (E I d) = 1 / (1/6 - k / (8 (1 + k))), k = A h^2 / (4 I); 6 without
 * the cap. */
static void cap_makes_two_wires_a_frame(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(3);
    const double h = 1.6e-3, d = wire.diameter, L = 0.114, k = 4.0 * h * h / (d * d);
    const double EI = wire.material.youngs_modulus * M_PI / 64.0 * pow(d, 4.0);
    const double expected[2] = {6.0, 1.0 / (1.0 / 6.0 - k / (8.0 * (1.0 + k)))};
    static const char *const tip[2] = {"free", "capped"};

    for (int i = 0; i < 2; i++) {
        char text[512];
        snprintf(text, sizeof text,
                 "wires: [{wire: type3, count: 2}]\npacking: places\n"
                 "places_mm: [[-0.8, 0], [0.8, 0]]\nends: {tip: %s}\n" RUN(
                     "deflection_mm: 0.4, rows: 2, duration_s: 1") "loads: {weight: false}\n",
                 tip[i]);
        read_model(text);
        run_model(NULL);
        const struct wb_bundle_row *row = &result.rows[2];
        assert_close_relative(row->force * pow(L, 3.0) / (EI * row->deflection), expected[i], 0.01);
        assert_true(result.largest.imbalance < 0.01);
    }
}

static void capped_bundle_conserves_energy_and_momentum(void **unused)
{
    (void)unused;
    const struct wb_bundle_settings settings = {.duration = 0.1};
    struct wb_bundle *bundle;

    read_model(SEVEN "ends: {tip: capped}\n"
                     "run: {mesh: four, selective_mass_scaling: 100, deflection_mm: 15}\n"
                     "loads: {strand_mm: 760, weight: true}\n");
    assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
    move_and_check(bundle, 15e-3, settings.duration, 0.003);
    wb_bundle_destroy(bundle);
}

/* --- cap without tape or loads --- */

/* Sums over the wires' nodes at the end, independent of the rigid-body code. */
struct sums {
    double momentum[3], angular[3], kinetic; /* angular: about the origin */
};

static size_t end_of(const struct wb_bundle_body *body, int node, int component)
{
    return (size_t)(3 * node + component) * (size_t)body->layout.stride +
           (size_t)body->layout.n_stations - 1;
}

static struct sums sum_up(const struct wb_bundle_bodies *bodies)
{
    struct sums sums = {{0.0}, {0.0}, 0.0};
    for (int w = 0; w < bodies->n_wires; w++) {
        const struct wb_bundle_body *body = &bodies->wire[w];
        for (int k = 0; k < body->layout.n_nodes; k++) {
            const double m = 0.5 * bodies->spacing * model.run.mass_scaling * body->node_mass[k];
            double x[3], v[3];
            for (int c = 0; c < 3; c++) {
                x[c] = body->position[end_of(body, k, c)];
                v[c] = body->velocity[end_of(body, k, c)];
                sums.momentum[c] += m * v[c];
                sums.kinetic += 0.5 * m * v[c] * v[c];
            }
            for (int c = 0; c < 3; c++)
                sums.angular[c] +=
                    m * (x[(c + 1) % 3] * v[(c + 2) % 3] - x[(c + 2) % 3] * v[(c + 1) % 3]);
        }
    }
    return sums;
}

static void move_end(struct wb_bundle_bodies *bodies)
{
    for (int w = 0; w < bodies->n_wires; w++) {
        struct wb_bundle_body *body = &bodies->wire[w];
        for (int i = 0; i < 3 * body->layout.n_nodes; i++)
            body->position[end_of(body, 0, i)] +=
                bodies->time_step * body->velocity[end_of(body, 0, i)];
    }
}

/* After an impulse at one node the end translates and rotates: impulse and angular impulse are
 * conserved, the energy to a thousandth in steps of at most 0.01 rad, and nodes keep their
 * distances. */
static void an_impulse_moves_the_end_as_a_rigid_body(void **unused)
{
    (void)unused;
    const double force[3] = {3000.0, -200.0, 400.0};
    struct wb_bundle_part *part;
    double energy = 0.0, last = 0.0, before = 0.0, along = 1.0;

    read_model("wires: [{wire: type3, count: 2}]\npacking: places\n"
               "places_mm: [[-0.8, 0.3], [0.8, 0]]\nends: {tip: capped}\n"
               "run: {mesh: twelve, deflection_mm: 1, selective_mass_scaling: 1}\n"
               "loads: {weight: false}\n");
    const struct wb_bundle_mesh *mesh = wb_bundle_model_mesh(&model, model.run.mesh);
    assert_int_equal(wb_bundle_part_create_whole(&part, &model, mesh, 0.9), WB_OK);
    struct wb_bundle_bodies *bodies = &part->bodies;
    struct wb_bundle_body *body = &bodies->wire[1];
    const int struck = body->layout.n_nodes - 1;
    double arm[3], impulse[3], moment[3];
    for (int c = 0; c < 3; c++) {
        wb_bundle_body_add_force(body, end_of(body, struck, c), force[c]);
        arm[c] = body->position[end_of(body, struck, c)];
        impulse[c] = 0.5 * bodies->time_step * force[c];
    }
    for (int c = 0; c < 3; c++)
        moment[c] =
            arm[(c + 1) % 3] * impulse[(c + 2) % 3] - arm[(c + 2) % 3] * impulse[(c + 1) % 3];
    const double size =
        sqrt(impulse[0] * impulse[0] + impulse[1] * impulse[1] + impulse[2] * impulse[2]);
    for (int i = 0; i < 5000; i++) {
        wb_bundle_cap_advance(part->cap, i == 0 ? 0.5 : 1.0);
        const struct sums sums = sum_up(bodies);
        for (int c = 0; c < 3; c++) {
            assert_close(sums.momentum[c], impulse[c], 1e-9 * size);
            assert_close(sums.angular[c], moment[c], 1e-9 * size * arm[0]);
            wb_bundle_body_add_force(body, end_of(body, struck, c),
                                     -wb_bundle_body_force(body, end_of(body, struck, c)));
        }
        energy = i == 0 ? sums.kinetic : energy;
        assert_close_relative(sums.kinetic, energy, 1e-3);
        if (i > 0)
            assert_close_relative(wb_bundle_cap_kinetic(part->cap), energy, 1e-3);
        move_end(bodies);
        double square = 0.0, x[2];
        for (int c = 0; c < 3; c++) {
            for (int w = 0; w < 2; w++)
                x[w] = bodies->wire[w].position[end_of(&bodies->wire[w], w ? struck : 0, c)];
            square += (x[1] - x[0]) * (x[1] - x[0]);
            last = c == 1 ? (x[1] - x[0]) : last;
        }
        along = fmin(along, last / sqrt(square));
        before = i == 0 ? square : before;
        assert_close_relative(square, before, 1e-9);
    }
    assert_true(along < -0.5);
    wb_bundle_part_destroy(part);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(cap_makes_two_wires_a_frame, release),
        cmocka_unit_test(capped_bundle_conserves_energy_and_momentum),
        cmocka_unit_test(an_impulse_moves_the_end_as_a_rigid_body),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
