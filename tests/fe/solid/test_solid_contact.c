/* Contact with friction in bodies: blocks pressed together and sheared, compared with Coulomb's
 * law; wires of a core and a jacket, compared with bonded ones and beam theory. */
#include "tests/check.h"
#include "tests/fe/solid/block_mesh.h"

#include <stdlib.h>

#include "fe/solid/solid.h"
#include "fe/solid/solid_private.h"
#include "fe/trial/wire3d.h"

/* --- two blocks --- */

enum {
    SIDE = 2 /* elements a block has along y and z; one through its height */
};

/* Two flat blocks of the same material, stacked along `up`. The lower one is fixed at its bottom.
 * Dead forces on the top. */
struct stack {
    struct wb_solid_mesh mesh;
    int n_lower;       /* nodes of the lower block */
    double axis[3][3]; /* up, and two perpendicular directions */
    struct wb_solid_part parts[2];
    struct wb_jacket_contact_law law;
    struct wb_solid_settings settings;
    int n_supports;
    struct wb_solid_support *supports;
    double (*force)[3];
    struct wb_solid *solid;
    struct wb_solid_point point; /* of the last move */
};

static const double side = 1e-3, height = 0.2e-3; /* m, of a block */
static const double young = 10e9, pressure = 1e6; /* Pa */
static const double shear = 10e9 / 2.6;
static const double area = 1e-6; /* m2, of the interface */

/* Adds the nodes and elements of a block to the stack's mesh, above or below the interface. */
static void add_block(struct stack *s, bool upper)
{
    struct wb_solid_mesh block = {0};
    test_block_mesh(&block, 1, SIDE, SIDE, NULL, NULL);
    if (!upper) {
        assert_int_equal(wb_solid_mesh_init(&s->mesh, 2 * block.n_nodes, 2 * block.n_elements),
                         WB_OK);
        s->mesh.n_parts = 2;
        s->n_lower = block.n_nodes;
    }
    const int nodes = upper ? block.n_nodes : 0, elements = upper ? block.n_elements : 0;
    for (int i = 0; i < block.n_nodes; i++) {
        const double unit[3] = {height * (block.node[i][0] - (upper ? 0.0 : 1.0)),
                                side * (block.node[i][1] - 0.5), side * (block.node[i][2] - 0.5)};
        for (int c = 0; c < 3; c++)
            s->mesh.node[nodes + i][c] =
                unit[0] * s->axis[0][c] + unit[1] * s->axis[1][c] + unit[2] * s->axis[2][c];
    }
    for (int e = 0; e < block.n_elements; e++) {
        s->mesh.part[elements + e] = upper;
        for (int k = 0; k < WB_SOLID_MESH_NODES; k++)
            s->mesh.element[elements + e][k] = nodes + block.element[e][k];
    }
    wb_solid_mesh_release(&block);
}

static bool is_at(const struct stack *s, int node, double level)
{
    const double *X = s->mesh.node[node], *up = s->axis[0];
    return fabs(X[0] * up[0] + X[1] * up[1] + X[2] * up[2] - level) < 1e-9;
}

/* `up` and a perpendicular direction, columns of any rotation; friction mu. */
static struct stack *stack_begin(const double up[3], const double across[3], double mu)
{
    static const int top[8] = {4, 5, 6, 7, 12, 13, 14, 15}, bottom[8] = {0, 1, 2, 3, 8, 9, 10, 11};
    struct stack *s = calloc(1, sizeof *s);
    assert_non_null(s);
    for (int c = 0; c < 3; c++) {
        s->axis[0][c] = up[c];
        s->axis[1][c] = across[c];
        s->axis[2][c] =
            up[(c + 1) % 3] * across[(c + 2) % 3] - up[(c + 2) % 3] * across[(c + 1) % 3];
    }
    add_block(s, false);
    add_block(s, true);
    const int n = s->mesh.n_elements / 2;
    s->mesh.n_pairs = n;
    s->mesh.pair = wb_memory_take(&s->mesh.memory, (size_t)n, sizeof *s->mesh.pair);
    s->supports = calloc(3 * (size_t)s->mesh.n_nodes, sizeof *s->supports);
    s->force = calloc((size_t)s->mesh.n_nodes, sizeof *s->force);
    assert_true(s->mesh.pair && s->supports && s->force);
    for (int e = 0; e < n; e++) {
        for (int k = 0; k < 8; k++) {
            s->mesh.pair[e].inner[k] = s->mesh.element[e][top[k]];
            s->mesh.pair[e].outer[k] = s->mesh.element[n + e][bottom[k]];
        }
    }
    for (int i = 0; i < s->n_lower; i++) {
        for (int c = 0; c < 3 && is_at(s, i, -height); c++)
            s->supports[s->n_supports++] = (struct wb_solid_support){i, c, 0.0};
    }
    for (int p = 0; p < 2; p++)
        s->parts[p].material =
            (struct wb_material){WB_HARDENING_NONE_ELASTIC, young, 0.3, 0.0, 0.0, 0.0};
    s->law = (struct wb_jacket_contact_law){1e13, 3e11, mu};
    s->settings = (struct wb_solid_settings){.force_tolerance = 1e-8};
    return s;
}

/* Distributes a force per area over the top: corners -1/12, midsides 1/3 of an element's area
 * each. */
static void load_top(struct stack *s, const double traction[3])
{
    const int n = s->mesh.n_elements / 2;
    for (int e = n; e < 2 * n; e++) {
        for (int k = 0; k < 8; k++) {
            const int node = s->mesh.element[e][k < 4 ? 4 + k : 8 + k];
            for (int c = 0; c < 3; c++)
                s->force[node][c] += traction[c] * area / n * (k < 4 ? -1.0 / 12.0 : 1.0 / 3.0);
        }
    }
}

static void hold_top(struct stack *s, int axis, double displacement)
{
    for (int i = s->n_lower; i < s->mesh.n_nodes; i++) {
        if (is_at(s, i, height))
            s->supports[s->n_supports++] = (struct wb_solid_support){i, axis, displacement};
    }
}

static void stack_create(struct stack *s)
{
    const struct wb_solid_model model = {
        .mesh = &s->mesh,
        .parts = s->parts,
        .integration = WB_INTEGRATION_SELECTIVE,
        .n_supports = s->n_supports,
        .supports = s->supports,
        .nodal_force = (const double(*)[3])s->force,
        .jacket_contact = &s->law,
    };
    assert_int_equal(wb_solid_create(&s->solid, &model, &s->settings), WB_OK);
}

static bool stack_try(struct stack *s, double supports, double nodal)
{
    const struct wb_solid_move move = {.control = WB_SOLID_LOADS,
                                       .target = {.supports = supports, .nodal = nodal}};
    assert_int_equal(wb_solid_move(s->solid, &move, &s->point), WB_OK);
    return s->point.end == WB_SOLID_CONVERGED;
}

static void stack_go(struct stack *s, double supports, double nodal)
{
    if (!stack_try(s, supports, nodal))
        fail_msg("%s", s->point.problem);
}

/* Force of the upper block on the lower one: the reversed reactions of the bottom. */
static void pushed(const struct stack *s, double force[3])
{
    const double *f = wb_solid_internal_force(s->solid);
    memset(force, 0, 3 * sizeof *force);
    for (int i = 0; i < s->n_lower; i++) {
        for (int c = 0; c < 3 && is_at(s, i, -height); c++)
            force[c] -= f[3 * i + c];
    }
}

static void stack_end(struct stack *s)
{
    wb_solid_destroy(s->solid);
    wb_solid_mesh_release(&s->mesh);
    free(s->supports);
    free(s->force);
    free(s);
}

static const double x_axis[3] = {1, 0, 0}, y_axis[3] = {0, 1, 0};

/* Pressed by a dead force, then sheared by the top's displacement. */
static struct stack *pressed(double mu, double y, double z)
{
    struct stack *s = stack_begin(x_axis, y_axis, mu);
    load_top(s, (const double[3]){-pressure, 0.0, 0.0});
    hold_top(s, 1, y);
    hold_top(s, 2, z);
    stack_create(s);
    stack_go(s, 0.0, 1.0);
    return s;
}

static void pressed_blocks_stick_then_slip_at_mu_times_the_force(void **unused)
{
    (void)unused;
    const double mu = 0.2, full = 3e-6;
    struct stack *s = pressed(mu, full, 0.0);
    struct wb_solid_balance balance;
    double force[3];

    pushed(s, force);
    assert_close(force[0], -pressure * area, 1e-8);
    assert_close(force[1], 0.0, 1e-8);

    /* Sticking: the blocks and the interface are springs in series, the interface by far the
     * softest. */
    stack_go(s, 0.1, 1.0);
    wb_solid_balance(s->solid, &balance);
    pushed(s, force);
    const double compliance = 2.0 * height / shear + 1.0 / s->law.tangential_stiffness;
    assert_close_relative(force[1], area * 0.1 * full / compliance, 0.03);
    assert_true(force[1] < 0.7 * mu * pressure * area);
    assert_int_equal(balance.jacket_contact.slipping, 0);
    assert_true(balance.jacket_contact.slip == 0.0 && balance.friction == 0.0);

    /* Slipping everywhere. */
    stack_go(s, 1.0, 1.0);
    wb_solid_balance(s->solid, &balance);
    pushed(s, force);
    assert_close(force[0], -pressure * area, 1e-7);
    assert_close_relative(force[1], mu * pressure * area, 3e-4);
    assert_close(force[2], 0.0, 1e-4 * mu * pressure * area);
    assert_int_equal(balance.jacket_contact.slipping, 9 * SIDE * SIDE);
    /* The largest slip is at an edge where the pressure is below the mean. */
    assert_true(balance.jacket_contact.slip > full - mu * pressure * compliance);
    assert_true(balance.jacket_contact.slip < full);

    /* And in the reverse direction. */
    stack_go(s, -1.0, 1.0);
    pushed(s, force);
    assert_close_relative(force[1], -mu * pressure * area, 3e-4);
    stack_end(s);
}

static void slip_follows_the_pull_in_any_direction(void **unused)
{
    (void)unused;
    struct stack *s = pressed(0.3, 3.2e-6, -2.4e-6);
    double force[3];
    stack_go(s, 1.0, 1.0);
    pushed(s, force);
    assert_close_relative(force[1], 0.8 * 0.3 * pressure * area, 1e-3);
    assert_close_relative(force[2], -0.6 * 0.3 * pressure * area, 1e-3);
    stack_end(s);
}

/* Work of pressing and shearing back and forth is stored or dissipated by friction. */
static void work_is_stored_or_dissipated_by_friction(void **unused)
{
    (void)unused;
    const double mu = 0.2;
    struct stack *s = stack_begin(x_axis, y_axis, mu);
    struct wb_solid_balance before, after;
    s->settings.largest_increment = 0.02;
    load_top(s, (const double[3]){-pressure, 0.0, 0.0});
    hold_top(s, 1, 3e-6);
    hold_top(s, 2, 0.0);
    stack_create(s);
    stack_go(s, 0.0, 1.0);
    stack_go(s, 1.0, 1.0);
    wb_solid_balance(s->solid, &before);
    assert_close_relative(before.work, before.elastic + before.friction, 1e-2);
    stack_go(s, -1.0, 1.0);
    stack_go(s, 1.0, 1.0);
    wb_solid_balance(s->solid, &after);
    const double bound = mu * pressure * area;
    const double reversal =
        2.0 * mu * pressure * (2.0 * height / shear + 1.0 / s->law.tangential_stiffness);
    assert_close_relative(after.friction - before.friction, 2.0 * bound * (6e-6 - reversal), 1e-2);
    assert_close_relative(after.elastic, before.elastic, 1e-3);
    assert_close_relative(after.work - before.work, after.friction - before.friction, 1e-2);
    assert_true(after.dissipated == 0.0);
    stack_end(s);
}

/* Sum of the displacements of the top along a direction, per node. */
static double top_moves(const struct stack *s, const double direction[3])
{
    const double *u = wb_solid_displacement(s->solid);
    double sum = 0.0;
    int n = 0;
    for (int i = s->n_lower; i < s->mesh.n_nodes; i++) {
        for (int c = 0; c < 3; c++)
            sum += is_at(s, i, height) ? u[3 * i + c] * direction[c] : 0.0;
        n += is_at(s, i, height);
    }
    return sum / n;
}

/* A block on a slope under dead forces (its weight): in equilibrium while the slope is below the
 * angle of friction, for any orientation in space; no equilibrium is found above. */
static void block_rests_on_a_slope_below_the_angle_of_friction(void **unused)
{
    (void)unused;
    const double mu = 0.2;
    const double up[2][3] = {{1, 0, 0}, {2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0}};
    const double across[2][3] = {{0, 1, 0}, {1.0 / 3.0, -2.0 / 3.0, -2.0 / 3.0}};
    double moved[2];
    for (int k = 0; k < 4; k++) {
        const int lie = k % 2;
        const double share = k < 2 ? 0.9 : 1.02; /* of the angle's tangent */
        struct stack *s = stack_begin(up[lie], across[lie], mu);
        double traction[3];
        for (int c = 0; c < 3; c++)
            traction[c] = pressure * (share * mu * across[lie][c] - up[lie][c]);
        load_top(s, traction);
        s->settings.smallest_increment = 1e-2;
        stack_create(s);
        assert_int_equal(stack_try(s, 0.0, 1.0), k < 2);
        if (k < 2) {
            double force[3];
            pushed(s, force);
            for (int c = 0; c < 3; c++)
                assert_close(force[c], area * traction[c], 1e-6);
            moved[lie] = top_moves(s, across[lie]);
        } else {
            assert_true(s->point.problem[0] != '\0' && s->point.fraction == 0.0);
        }
        stack_end(s);
    }
    assert_true(moved[0] > 0.0);
    assert_close_relative(moved[1], moved[0], 1e-6);
}

static void lifted_block_separates_and_comes_back(void **unused)
{
    (void)unused;
    struct stack *s = stack_begin(x_axis, y_axis, 0.2);
    struct wb_solid_balance balance;
    double force[3], stress[20][6], plastic[20];
    hold_top(s, 0, 1e-6);
    hold_top(s, 1, 0.5e-6);
    hold_top(s, 2, 0.0);
    stack_create(s);
    stack_go(s, -1.0, 0.0);
    pushed(s, force);
    assert_true(force[0] < -1e-3);
    assert_true(force[1] < 0.0);
    const double first = force[0];

    stack_go(s, 1.0, 0.0);
    wb_solid_balance(s->solid, &balance);
    pushed(s, force);
    for (int c = 0; c < 3; c++)
        assert_close(force[c], 0.0, 1e-12);
    assert_int_equal(balance.jacket_contact.touching, 0);
    assert_close_relative(balance.jacket_contact.opening, 1e-6, 1e-3);
    for (int e = 0; e < s->mesh.n_elements; e++) {
        wb_solid_nodal_stress(s->solid, e, stress, plastic);
        for (int a = 0; a < 20; a++)
            assert_close(stress[a][0], 0.0, 1e-6 * pressure);
    }

    stack_go(s, -1.0, 0.0);
    pushed(s, force);
    assert_close_relative(force[0], first, 2e-2); /* it slips by less where it lands */
    stack_end(s);
}

/* --- wires of a core and a jacket with equal Young's moduli --- */

static const double core = 3.26e-3, jacket = 4.86e-3, length = 40e-3, wire_young = 1e9;

struct bent {
    double deflection;
    struct wb_wire3d_balance balance;
};

/* Bends a wire by a transverse dead force at its tip, after pulling it by an axial one; mu < 0:
 * bonded; `stiffer`: than the default interface. */
static struct bent bend(double mu, const double poissons_ratio[2], double pull, double force,
                        double stiffer)
{
    struct wb_wire_model *model = calloc(1, sizeof *model);
    struct wb_wire3d *wire = NULL;
    struct wb_wire_run run = {0};
    struct bent bent = {0};
    assert_non_null(model);
    model->length = length;
    model->n_parts = 2;
    model->part[0].outer_diameter = model->part[1].inner_diameter = core;
    model->part[1].outer_diameter = model->wire.outer_diameter = jacket;
    for (int p = 0; p < 2; p++)
        model->part[p].material = (struct wb_material){
            WB_HARDENING_NONE_ELASTIC, wire_young, poissons_ratio[p], 0.0, 0.0, 0.0};
    model->has_contact = mu >= 0.0;
    wb_trial_default_jacket_contact(&model->jacket_contact, wire_young, poissons_ratio[1],
                                    0.5 * (jacket - core), mu);
    model->jacket_contact.normal_stiffness *= stiffer;
    model->jacket_contact.tangential_stiffness *= stiffer;
    model->elements_along = 12;
    model->section_density = 1;
    if (pull > 0.0)
        model->step[model->n_steps++] = (struct wb_wire_step){.loads.force[0] = pull, .rows = 1};
    model->step[model->n_steps++] = (struct wb_wire_step){.loads.force = {pull, force}, .rows = 1};

    assert_int_equal(wb_wire3d_create(&wire, model), WB_OK);
    assert_int_equal(wb_wire_run_init(&run, model, 3), WB_OK);
    assert_int_equal(wb_wire3d_run(wire, &run, NULL), WB_OK);
    if (!run.converged)
        fail_msg("%s", run.problem);
    bent.deflection = run.rows[run.n_rows - 1].tip[1];
    wb_wire3d_balance(wire, &bent.balance);
    wb_wire_run_release(&run);
    wb_wire3d_destroy(wire);
    free(model);
    return bent;
}

/* Timoshenko beam of two parts with the same deflection. Bonded parts have the same shear angle;
 * sliding parts each have their own, from their share of the force, which is proportional to the
 * flexural rigidity, and so different rotations. k by Cowper, for a circle and a ring. */
struct rod {
    double bending, bonded_shear, sliding_shear; /* m, deflections at the tip */
    double slip;                                 /* m, by the difference of the angles */
};

static struct rod rod_of(double force, double nu)
{
    const double G = wire_young / (2.0 * (1.0 + nu)), m2 = core * core / (jacket * jacket);
    const double q = (1.0 + m2) * (1.0 + m2);
    const double k = 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu);
    const double k_ring = 6.0 * (1.0 + nu) * q / ((7.0 + 6.0 * nu) * q + (20.0 + 12.0 * nu) * m2);
    const double A = 0.25 * M_PI * jacket * jacket, I = A * jacket * jacket / 16.0;
    const double share = m2 * m2; /* of the core */
    const double angle = share * force / (k * G * m2 * A);
    const double ring_angle = (1.0 - share) * force / (k_ring * G * (1.0 - m2) * A);
    return (struct rod){
        .bending = force * pow(length, 3.0) / (3.0 * wire_young * I),
        .bonded_shear = force * length / (k * G * A),
        .sliding_shear = length * (share * angle + (1.0 - share) * ring_angle),
        .slip = 0.5 * core * (ring_angle - angle),
    };
}

static void sliding_parts_bend_like_bonded_ones_but_for_shear(void **unused)
{
    (void)unused;
    const double equal[2] = {0.3, 0.3}, force = 1.0;
    const struct rod rod = rod_of(force, 0.3);
    const struct bent bonded = bend(-1.0, equal, 0.0, force, 1.0);
    const struct bent sliding = bend(0.0, equal, 0.0, force, 1.0);
    const struct bent rubbing = bend(0.1, equal, 0.0, force, 1.0);

    assert_close_relative(bonded.deflection, rod.bending + rod.bonded_shear, 2e-3);
    assert_close_relative(sliding.deflection, rod.bending + rod.sliding_shear, 3e-3);
    assert_close_relative(sliding.deflection - bonded.deflection,
                          rod.sliding_shear - rod.bonded_shear, 0.1);
    assert_true(rubbing.deflection < sliding.deflection);
    assert_true(rubbing.deflection > bonded.deflection);

    print_message(
        "sliding parts: %.2f %% further than bonded ones, by beam theory %.2f %%; slip %.2g "
        "um\n",
        100.0 * (sliding.deflection / bonded.deflection - 1.0),
        100.0 * (rod.sliding_shear - rod.bonded_shear) / bonded.deflection,
        1e6 * sliding.balance.slip);

    /* Slip comes from the sections' different rotations and warping, far below the limit. */
    assert_in_range((int)(100.0 * sliding.balance.slip / rod.slip), 100, 250);
    assert_true(rubbing.balance.slip < sliding.balance.slip);
    assert_true(sliding.balance.slip < 0.01 * sliding.balance.slip_limit);
    assert_true(sliding.balance.friction == 0.0 && rubbing.balance.friction > 0.0);
    assert_true(bonded.balance.slip == 0.0 && bonded.balance.penetration == 0.0);
    assert_true(sliding.balance.penetration < 0.01 * 0.5 * (jacket - core));
}

/* A jacket that contracts more than the core when the wire is pulled presses on it everywhere; with
 * enough friction the wire behaves as if bonded, except for the interface's compliance. */
static void pressed_jacket_with_much_friction_is_as_if_bonded(void **unused)
{
    (void)unused;
    const double different[2] = {0.1, 0.45}, pull = 200.0, force = 1.0;
    const struct bent bonded = bend(-1.0, different, pull, force, 1.0);
    const struct bent sticking = bend(1.0, different, pull, force, 1.0);
    const struct bent stiffer = bend(1.0, different, pull, force, 10.0);
    const struct bent sliding = bend(0.0, different, pull, force, 1.0);
    const double error = sticking.deflection / bonded.deflection - 1.0;

    print_message("sticking parts: %.3f %% further than bonded ones, %.4f %% with ten times the "
                  "stiffness; sliding ones %.2f %%\n",
                  100.0 * error, 100.0 * (stiffer.deflection / bonded.deflection - 1.0),
                  100.0 * (sliding.deflection / bonded.deflection - 1.0));
    assert_true(sticking.balance.slip == 0.0 && sticking.balance.opening == 0.0);
    assert_true(error > 0.0 && error < 1e-3);
    assert_close_relative(stiffer.deflection / bonded.deflection - 1.0, 0.1 * error, 0.3);
    assert_true(sliding.deflection / bonded.deflection - 1.0 > 5e-3);
    assert_true(sliding.balance.slip > 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pressed_blocks_stick_then_slip_at_mu_times_the_force),
        cmocka_unit_test(slip_follows_the_pull_in_any_direction),
        cmocka_unit_test(work_is_stored_or_dissipated_by_friction),
        cmocka_unit_test(block_rests_on_a_slope_below_the_angle_of_friction),
        cmocka_unit_test(lifted_block_separates_and_comes_back),
        cmocka_unit_test(sliding_parts_bend_like_bonded_ones_but_for_shear),
        cmocka_unit_test(pressed_jacket_with_much_friction_is_as_if_bonded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
