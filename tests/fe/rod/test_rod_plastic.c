/* The elastoplastic rod compared with the planar beam and the project's reference; energy balance
 * and limit loads. */
#include <stdlib.h>

#include "base/json.h"
#include "fe/rod/rod_element.h"
#include "fe/rod/rod_private.h"
#include "tests/fe/rod/rod_energy.h"
#include "tests/fe/rod/rods.h"

static const struct wb_material copper = {
    WB_HARDENING_ISOTROPIC_POWER, 68.2e9, 0.34, 182e6, 292e6, 0.31};
static const struct wb_material pvc = {WB_HARDENING_NONE_ELASTIC, 41e6, 0.43, 0.0, 0.0, 0.0};

/* Its default fibres. */
static struct test_rod make_type3(double strand, double weight, int n_rings, int n_around)
{
    const struct test_wire wire = test_wire_type(3);
    return test_rod_make(&(struct test_rod_plan){
        .diameter = wire.diameter,
        .length = 0.085,
        .material = wire.material,
        .strand_length = strand,
        .load = {0.0, weight * test_wire_mass(&wire) * WB_STANDARD_GRAVITY, 0.0},
        .n_rings = n_rings,
        .n_around = n_around,
    });
}

static double number(const struct wb_json *object, const char *key)
{
    double value = 0.0;
    assert_true(wb_json_get_number(object, key, &value));
    return value;
}

static void type_3_gives_the_reference_force(void **unused)
{
    (void)unused;
    struct wb_json *root = NULL;
    char path[4096];
    const char *source = getenv("WIREBENCH_SOURCE_ROOT");
    snprintf(path, sizeof path, "%s/tests/data/cantilever_reference.json", source ? source : ".");
    assert_int_equal(wb_json_read(&root, path), WB_OK);
    const struct wb_json *rows = wb_json_get(root, "type3_L85_ep");
    struct test_rod t = make_type3(0.0, 0.0, 0, 0);
    double force = 0.0, place = 0.0, moment = 0.0, angle = 0.0;

    for (size_t i = 0; i < wb_json_length(rows); i++) {
        const struct wb_json *row = wb_json_item(rows, i);
        struct wb_rod_balance balance;
        double along[3];
        test_rod_raise(&t, number(row, "deflection_mm") * WB_MM);
        wb_rod_evaluate(t.rod, 1.0, &balance);
        const struct wb_rod_node *tip = wb_rod_tip(t.rod);
        test_rod_axis(tip, 0, along);
        const double F = wb_rod_solver_loads(t.solver)->tension;
        force = fmax(force, fabs(F / number(row, "tension_N") - 1.0));
        moment =
            fmax(moment, fabs(-balance.clamp[5] / (number(row, "root_moment_Nmm") * WB_NMM) - 1.0));
        place = fmax(place, fabs(tip->position[0] - number(row, "tip_x_mm") * WB_MM));
        angle = fmax(angle, fabs(atan2(along[1], along[0]) - number(row, "tip_angle_rad")));
    }
    print_message("type 3: force %.3f %%, root moment %.3f %%, tip x %.4f mm, angle %.5f rad\n",
                  100.0 * force, 100.0 * moment, place / WB_MM, angle);
    assert_int_equal(wb_json_length(rows), 14);
    assert_true(force < 1e-3);
    assert_true(moment < 1e-3);
    assert_true(place < 0.02 * WB_MM);
    assert_true(angle < 5e-4);

    /* After release it has the residual deflection of the reference. */
    const struct wb_rod_move release = {.control = WB_ROD_LOADS, .target = {.weight = 1.0}};
    struct wb_rod_result result;
    assert_int_equal(wb_rod_solver_move(t.solver, &release, &result), WB_OK);
    assert_int_equal(result.end, WB_ROD_CONVERGED);
    assert_close(wb_rod_tip(t.rod)->position[1],
                 number(wb_json_item(rows, 13), "residual_deflection_no_weight_mm") * WB_MM,
                 0.03 * WB_MM);
    wb_json_destroy(root);
    test_rod_release(&t);
}

/* Raised by a strand under its weight, to slack and up again; compared with the planar cantilever
 * with many fibres. */
static void strand_and_weight_as_the_planar_cantilever(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(3);
    struct wb_section section;
    struct wb_cantilever_model model;
    assert_int_equal(wb_section_init_circle(&section, wire.diameter, &wire.material, 400), WB_OK);
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = 0.085;
    model.strand_length = 0.3;
    model.mass_per_length = test_wire_mass(&wire);
    struct wb_cantilever *cantilever = test_cantilever(&model);
    struct test_rod t = make_type3(0.3, -1.0, 12, 48);
    double worst = 0.0, shape = 0.0;
    int slack = 0;

    for (int i = 0; i <= 120; i++) {
        const double y = 0.053 * (i <= 40 ? i : i <= 80 ? 80 - i : i - 80) / 40.0;
        const struct wb_cantilever_point p = test_move(cantilever, WB_CONTROL_DEFLECTION, y);
        test_rod_raise(&t, y);
        const struct wb_rod_node *tip = wb_rod_tip(t.rod);
        assert_true(wb_rod_solver_is_slack(t.solver) == p.slack);
        worst = fmax(worst, fabs(wb_rod_solver_loads(t.solver)->tension - p.tension));
        worst = fmax(worst, fabs(wb_rod_solver_vertical_force(t.solver) - p.vertical_force));
        shape = fmax(shape, hypot(tip->position[0] - p.tip_x, tip->position[1] - p.deflection));
        assert_close(tip->position[2], 0.0, 1e-9);
        slack += p.slack;
    }
    print_message("strand: force %.2g N, tip %.2g mm, %d rows slack\n", worst, shape / WB_MM,
                  slack);
    assert_true(worst < 1e-4 * 0.15);
    assert_true(shape < 2e-3 * WB_MM);
    assert_in_range(slack, 5, 100);
    test_rod_release(&t);
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
}

/* Copper core and PVC ring, 8 AWG, with its own number of fibres. */
static struct test_rod make_8awg(int n_rings, int n_around)
{
    struct test_rod t;
    const struct wb_rod_section_part parts[2] = {{0.0, 3.26e-3, copper}, {3.26e-3, 4.86e-3, pvc}};
    const struct wb_rod_section_layout layout = {n_rings, n_around};
    assert_int_equal(wb_rod_section_create(&t.section, 2, parts, &layout), WB_OK);
    const struct wb_rod_model model = {.section = t.section, .length = 0.1, .n_elements = 50};
    assert_int_equal(wb_rod_create(&t.rod, &model), WB_OK);
    const struct wb_rod_solver_model solver = {.rod = t.rod, .length = 0.1};
    assert_int_equal(wb_rod_solver_create(&t.solver, &solver), WB_OK);
    return t;
}

static void follower_of_the_mixed_section_as_the_planar_cantilever(void **unused)
{
    (void)unused;
    struct wb_section section;
    struct wb_cantilever_model model;
    wb_section_init_empty(&section);
    assert_int_equal(wb_section_add_ring(&section, 0.0, 3.26e-3, &copper, 1.0, 400), WB_OK);
    assert_int_equal(wb_section_add_ring(&section, 3.26e-3, 4.86e-3, &pvc, 1.0, 400), WB_OK);
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = 0.1;
    model.gravity_y = 0.0;
    struct wb_cantilever *cantilever = test_cantilever(&model);
    struct test_rod fine = make_8awg(12, 48), t = make_8awg(0, 0);
    double worst = 0.0, own = 0.0, highest = 0.0, at = 0.0;

    for (int i = 1; i <= 48; i++) {
        const double F = 0.5 * i;
        const struct wb_cantilever_point p = test_move(cantilever, WB_CONTROL_FOLLOWER_FORCE, F);
        const struct wb_tip_loads loads = {.follower = {0.0, F, 0.0}};
        test_rod_load(&fine, &loads);
        test_rod_load(&t, &loads);
        const double *a = wb_rod_tip(fine.rod)->position, *b = wb_rod_tip(t.rod)->position;
        worst = fmax(worst, hypot(a[0] - p.tip_x, a[1] - p.deflection));
        own = fmax(own, hypot(b[0] - p.tip_x, b[1] - p.deflection));
        if (p.deflection > highest) {
            highest = p.deflection;
            at = F;
        }
        if (i == 48)
            print_message("24 N: planar %.3f, %.3f mm, %.3f degrees; rod %.3f, %.3f mm\n",
                          p.tip_x / WB_MM, p.deflection / WB_MM, p.tip_angle * 180.0 / M_PI,
                          a[0] / WB_MM, a[1] / WB_MM);
    }
    print_message(
        "highest %.2f mm at %.2f N; rod off by %.4f mm, with its default fibres %.3f mm\n",
        highest / WB_MM, at, worst / WB_MM, own / WB_MM);
    assert_true(worst < 5e-4 * 0.1);
    assert_true(own < 4e-3 * 0.1);
    test_rod_release(&fine);
    test_rod_release(&t);
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
}

static void every_direction_gives_the_same_curve(void **unused)
{
    (void)unused;
    const double angles[] = {0.0, 0.25 * M_PI, 0.5 * M_PI, 1.0, 2.5};
    double first[3] = {0};
    for (size_t i = 0; i < sizeof angles / sizeof angles[0]; i++) {
        const double c = cos(angles[i]), s = sin(angles[i]);
        struct test_rod t = make_8awg(0, 0);
        for (int k = 1; k <= 5; k++)
            test_rod_load(&t, &(struct wb_tip_loads){.force = {0.0, 3.0 * k * c, 3.0 * k * s}});
        const double *r = wb_rod_tip(t.rod)->position;
        const double along = r[1] * c + r[2] * s, aside = r[2] * c - r[1] * s;
        if (i == 0) {
            first[0] = r[0];
            first[1] = along;
        }
        print_message("direction %.2f rad: %.4f along, %.4f mm aside\n", angles[i], along / WB_MM,
                      aside / WB_MM);
        const double tolerance = i < 3 ? 1e-9 : 1e-3 * along;
        assert_close(along, first[1], tolerance);
        assert_close(r[0], first[0], tolerance);
        assert_close(aside, 0.0, i < 3 ? 1e-9 : 2e-3 * along);
        assert_true(along > 0.02);
        test_rod_release(&t);
    }
}

/* Work of tip loads between two equilibria, by the trapezoidal rule. */
struct account {
    struct test_rod *t;
    struct wb_rod_loads loads;
    struct wb_rod_node tip;
    double work;
    struct test_rod_energy energy;
};

static bool add_work(void *context, double fraction, int iterations)
{
    struct account *a = context;
    (void)fraction, (void)iterations;
    const struct wb_rod_loads loads = *wb_rod_solver_loads(a->t->solver);
    const struct wb_rod_node tip = *wb_rod_tip(a->t->rod);
    const double back[4] = {a->tip.rotation[0], -a->tip.rotation[1], -a->tip.rotation[2],
                            -a->tip.rotation[3]};
    double q[4], before[9], after[9];
    wb_rod_element_compose(tip.rotation, back, q);
    wb_rod_element_matrix(a->tip.rotation, before);
    wb_rod_element_matrix(tip.rotation, after);
    for (int k = 0; k < 3; k++) {
        double force = a->loads.tip.force[k] + loads.tip.force[k];
        for (int j = 0; j < 3; j++)
            force += before[3 * k + j] * a->loads.tip.follower[j] +
                     after[3 * k + j] * loads.tip.follower[j];
        a->work += 0.5 * force * (tip.position[k] - a->tip.position[k]);
        a->work += 0.5 * (a->loads.tip.moment[k] + loads.tip.moment[k]) * 2.0 * q[k + 1];
    }
    a->loads = loads;
    a->tip = tip;
    test_rod_energy_add(&a->energy);
    return true;
}

/* The history of the paper's section 2.4 with larger loads: force, moment, unloading, follower. */
static void work_is_stored_or_dissipated(void **unused)
{
    (void)unused;
    static const struct wb_tip_loads path[] = {
        {.force = {6.0, 7.0, 7.0}},
        {.force = {6.0, 7.0, 7.0}, .moment = {0.6, 0.3, 0.5}},
        {.moment = {0.0, 0.0, 0.0}},
        {.follower = {0.0, 16.0, 0.0}},
    };
    double error[2];
    for (int fine = 0; fine < 2; fine++) {
        const int parts = fine ? 40 : 20;
        struct test_rod t = make_8awg(6, 16);
        const struct wb_material materials[] = {copper, pvc};
        struct account account = {
            .t = &t,
            .tip = *wb_rod_tip(t.rod),
            .energy = test_rod_energy_make(t.rod, t.section, materials, 0.1, 50),
        };
        struct wb_tip_loads from = {0};
        double aside = 0.0;
        for (size_t i = 0; i < sizeof path / sizeof path[0]; i++) {
            for (int k = 1; k <= parts; k++) {
                struct wb_rod_move move = {.observer = add_work, .context = &account};
                struct wb_rod_result result;
                for (int j = 0; j < 3; j++) {
                    const double share = (double)k / parts;
                    struct wb_tip_loads *to = &move.target.tip;
                    to->force[j] = from.force[j] + share * (path[i].force[j] - from.force[j]);
                    to->moment[j] = from.moment[j] + share * (path[i].moment[j] - from.moment[j]);
                    to->follower[j] =
                        from.follower[j] + share * (path[i].follower[j] - from.follower[j]);
                }
                assert_int_equal(wb_rod_solver_move(t.solver, &move, &result), WB_OK);
                assert_int_equal(result.end, WB_ROD_CONVERGED);
                aside = fmax(aside, fabs(wb_rod_tip(t.rod)->position[2]));
            }
            from = path[i];
        }
        const double stored = account.energy.stored, dissipated = account.energy.dissipated;
        free(account.energy.history);
        error[fine] = (stored + dissipated - account.work) / account.work;
        print_message("work %.6f J, stored %.6f, dissipated %.6f: missing %.2g\n", account.work,
                      stored, dissipated, error[fine]);
        assert_true(dissipated > 0.3 * account.work);
        assert_true(aside > 2e-3);
        test_rod_release(&t);
    }
    /* Backward Euler dissipates too much in long increments; the error is of first order. */
    assert_true(error[1] > 0.0 && error[1] < 8e-3);
    assert_close(2.0 * error[1], error[0], 1e-3);
}

/* A short elastic rod, in which shear stores a part of the energy: the stored energy equals the
 * work, with an error of second order in the increments. */
static void elastic_work_is_stored(void **unused)
{
    (void)unused;
    struct wb_material m = copper;
    m.hardening = WB_HARDENING_NONE_ELASTIC;
    double error[2];
    for (int fine = 0; fine < 2; fine++) {
        const int parts = fine ? 80 : 40;
        struct test_rod t = test_rod_make(&(struct test_rod_plan){
            .diameter = 2e-3, .length = 6e-3, .material = m, .n_elements = 20});
        struct account account = {
            .t = &t,
            .tip = *wb_rod_tip(t.rod),
            .energy = test_rod_energy_make(t.rod, t.section, &m, 6e-3, 20),
        };
        for (int k = 1; k <= parts; k++) {
            const double share = (double)k / parts;
            struct wb_rod_result result;
            const struct wb_rod_move move = {
                .target.tip = {.force = {500.0 * share, 600.0 * share, 2500.0 * share},
                               .moment = {2.0 * share, 0.0, 1.0 * share}},
                .observer = add_work,
                .context = &account,
            };
            assert_int_equal(wb_rod_solver_move(t.solver, &move, &result), WB_OK);
            assert_int_equal(result.end, WB_ROD_CONVERGED);
        }
        const double stored = account.energy.stored, dissipated = account.energy.dissipated;
        free(account.energy.history);
        error[fine] = fabs(stored / account.work - 1.0);
        print_message("elastic: work %.6f J, stored %.6f: missing %.2g\n", account.work, stored,
                      error[fine]);
        assert_close(dissipated, 0.0, 0.0);
        test_rod_release(&t);
    }
    assert_true(error[1] < 2e-4);
    assert_true(error[1] < 0.3 * error[0] || error[1] < 1e-7);
}

/* A perfectly plastic cantilever carries Mp / L, before its lever becomes shorter. */
static void load_beyond_the_limit_does_not_converge(void **unused)
{
    (void)unused;
    const struct wb_material perfect = {
        WB_HARDENING_ISOTROPIC_POWER, 68.2e9, 0.34, 182e6, 0.0, 1.0};
    const double R = 1.63e-3, limit = 4.0 / 3.0 * 182e6 * R * R * R / 0.1;
    struct test_rod t = test_rod_make(&(struct test_rod_plan){
        .diameter = 2.0 * R, .length = 0.1, .material = perfect, .n_elements = 20});
    const struct wb_tip_loads twist = {
        .moment = {2.2 / 3.0 * M_PI * 182e6 / sqrt(3.0) * R * R * R, 0.0, 0.0}};
    const struct wb_rod_move move = {.control = WB_ROD_LOADS, .target = {.tip = twist}};
    struct wb_rod_result result;
    assert_int_equal(wb_rod_solver_move(t.solver, &move, &result), WB_OK);
    assert_int_equal(result.end, WB_ROD_NOT_CONVERGED);
    print_message("torsion: %.4f of the limit; %s\n", result.fraction * 1.1, result.problem);
    assert_close(result.fraction * 1.1, 1.0, 5e-3);
    assert_true(strlen(result.problem) > 20);
    assert_true(result.increments > 0 && result.cutbacks > 0);
    /* It stays at the last equilibrium. */
    struct wb_rod_balance balance;
    wb_rod_evaluate(t.rod, 0.0, &balance);
    assert_close(balance.tip[3], result.fraction * twist.moment[0], 1e-6);
    assert_close(wb_rod_solver_loads(t.solver)->tip.moment[0], balance.tip[3], 1e-6);
    assert_true(balance.largest_residual < 1e-6);

    /* In bending, the limit load is exceeded only because of the rod's rotation. */
    wb_rod_solver_reset(t.solver);
    double reached = 0.0;
    for (int i = 1; i <= 30; i++) {
        const struct wb_rod_move up = {.target.tip.force = {0.0, 0.05 * i * limit, 0.0}};
        assert_int_equal(wb_rod_solver_move(t.solver, &up, &result), WB_OK);
        if (result.end != WB_ROD_CONVERGED)
            break;
        reached = 0.05 * i;
        if (reached < 0.99)
            assert_true(wb_rod_tip(t.rod)->position[1] < 0.02);
    }
    print_message("bending: %.2f Mp / L, tip at %.1f mm\n", reached,
                  wb_rod_tip(t.rod)->position[1] / WB_MM);
    assert_true(reached >= 0.95);
    test_rod_release(&t);
}

static void non_finite_input_is_rejected(void **unused)
{
    (void)unused;
    struct test_rod t = make_type3(0.0, 0.0, 4, 8);
    struct wb_rod_result result;
    const struct wb_rod_move moves[] = {
        {.target.tip.force = {0.0, (double)NAN, 0.0}},
        {.target.tip.follower = {(double)INFINITY, 0.0, 0.0}},
        {.control = WB_ROD_DEFLECTION, .deflection = (double)NAN},
        {.target.weight = (double)INFINITY},
    };
    wb_log_set_sink(discard_message, NULL);
    for (size_t i = 0; i < sizeof moves / sizeof moves[0]; i++)
        assert_int_equal(wb_rod_solver_move(t.solver, &moves[i], &result), WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
    test_rod_release(&t);
}

static bool stop_at_once(void *context, double fraction, int iterations)
{
    (void)iterations;
    *(double *)context = fraction;
    return false;
}

static void the_observer_stops_it(void **unused)
{
    (void)unused;
    struct test_rod t = make_type3(0.0, 0.0, 4, 8);
    double fraction = 0.0;
    struct wb_rod_result result;
    const struct wb_rod_move move = {.control = WB_ROD_DEFLECTION,
                                     .deflection = 0.05,
                                     .observer = stop_at_once,
                                     .context = &fraction};
    assert_int_equal(wb_rod_solver_move(t.solver, &move, &result), WB_OK);
    assert_int_equal(result.end, WB_ROD_STOPPED);
    assert_int_equal(result.increments, 1);
    assert_true(fraction > 0.0 && fraction < 1.0);
    assert_close(wb_rod_tip(t.rod)->position[1], fraction * 0.05, 1e-9);
    test_rod_release(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(type_3_gives_the_reference_force),
        cmocka_unit_test(strand_and_weight_as_the_planar_cantilever),
        cmocka_unit_test(follower_of_the_mixed_section_as_the_planar_cantilever),
        cmocka_unit_test(every_direction_gives_the_same_curve),
        cmocka_unit_test(work_is_stored_or_dissipated),
        cmocka_unit_test(elastic_work_is_stored),
        cmocka_unit_test(load_beyond_the_limit_does_not_converge),
        cmocka_unit_test(non_finite_input_is_rejected),
        cmocka_unit_test(the_observer_stops_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
