/* The cantilever compared with the project's reference: an inextensible rod with the exact
 * moment-curvature law, solved by shooting (tests/data/cantilever_reference.json). */
#include <stdlib.h>

#include "base/json.h"
#include "tests/fe/rod/wires.h"

enum {
    SHAPE = 11
};

struct reference_case {
    const char *name;
    int type;
    bool elastic, strand_and_weight;
};

static const struct reference_case cases[] = {
    {"type1_L85_elastic", 1, true, false},
    {"type1_L85_ep", 1, false, false},
    {"type1_L85_ep_string_weight", 1, false, true},
    {"type3_L85_ep", 3, false, false},
};

struct rig {
    struct wb_section section;
    struct wb_cantilever *cantilever;
};

static struct rig make_rig(const struct reference_case *c)
{
    struct rig rig;
    struct test_wire wire = test_wire_type(c->type);
    if (c->elastic)
        wire.material.hardening = WB_HARDENING_NONE_ELASTIC;
    rig.section = test_section(&wire);

    struct wb_cantilever_model model;
    wb_cantilever_default_model(&model);
    model.section = &rig.section;
    model.length = 0.085;
    if (c->strand_and_weight) {
        model.strand_length = 0.76;
        model.mass_per_length = test_wire_mass(&wire);
    }
    rig.cantilever = test_cantilever(&model);
    return rig;
}

static void release_rig(struct rig *rig)
{
    wb_cantilever_destroy(rig->cantilever);
    wb_section_release(&rig->section);
}

static struct wb_json *read_reference(void)
{
    struct wb_json *root = NULL;
    char path[4096];
    const char *source = getenv("WIREBENCH_SOURCE_ROOT");
    snprintf(path, sizeof path, "%s/tests/data/cantilever_reference.json", source ? source : ".");
    assert_int_equal(wb_json_read(&root, path), WB_OK);
    return root;
}

static double number(const struct wb_json *object, const char *key)
{
    double value = 0.0;
    assert_true(wb_json_get_number(object, key, &value));
    return value;
}

/* Largest distance between the computed and the reference shape, m. */
static double shape_error(const struct wb_cantilever *cantilever, const struct wb_json *shape)
{
    double s[SHAPE], x[SHAPE], y[SHAPE], worst = 0.0;
    assert_int_equal(wb_json_length(shape), SHAPE);
    for (int i = 0; i < SHAPE; i++)
        s[i] = 0.085 * i / (SHAPE - 1);
    wb_cantilever_shape(cantilever, SHAPE, s, x, y, NULL);
    for (int i = 0; i < SHAPE; i++) {
        const struct wb_json *at = wb_json_item(shape, (size_t)i);
        double x_mm = 0.0, y_mm = 0.0;
        assert_true(wb_json_number(wb_json_item(at, 0), &x_mm));
        assert_true(wb_json_number(wb_json_item(at, 1), &y_mm));
        worst = fmax(worst, hypot(x[i] - x_mm * WB_MM, y[i] - y_mm * WB_MM));
    }
    return worst;
}

static void every_listed_deflection_agrees(void **unused)
{
    (void)unused;
    struct wb_json *root = read_reference();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const struct wb_json *rows = wb_json_get(root, cases[i].name);
        struct rig rig = make_rig(&cases[i]);
        double force = 0.0, tip = 0.0, shape = 0.0, angle = 0.0, moment = 0.0;
        int next = 0;
        assert_int_equal(wb_json_length(rows), 14);

        for (size_t r = 0; r < wb_json_length(rows); r++) {
            const struct wb_json *row = wb_json_item(rows, r);
            struct wb_cantilever_point p = {0};
            for (; next <= (int)number(row, "deflection_mm"); next++)
                p = test_move(rig.cantilever, WB_CONTROL_DEFLECTION, next * WB_MM);
            assert_close(p.deflection, number(row, "deflection_mm") * WB_MM, 1e-9);
            force = fmax(force, fabs(p.tension / number(row, "tension_N") - 1.0));
            tip = fmax(tip, fabs(p.tip_x - number(row, "tip_x_mm") * WB_MM));
            angle = fmax(angle, fabs(p.tip_angle - number(row, "tip_angle_rad")));
            moment =
                fmax(moment, fabs(p.root_moment / (number(row, "root_moment_Nmm") * WB_NMM) - 1.0));
            shape = fmax(shape, shape_error(rig.cantilever, wb_json_get(row, "shape")));
        }
        print_message("%s: force %.3f %%, root moment %.3f %%, tip x %.4f mm, shape %.4f mm, tip "
                      "angle %.5f rad\n",
                      cases[i].name, 100.0 * force, 100.0 * moment, tip / WB_MM, shape / WB_MM,
                      angle);
        assert_true(force <= (cases[i].elastic ? 1e-3 : 2e-3));
        assert_true(moment <= (cases[i].elastic ? 1e-3 : 2e-3));
        assert_true(tip <= 0.05 * WB_MM);
        assert_true(shape <= 0.05 * WB_MM);
        assert_true(angle <= 1e-3);
        release_rig(&rig);
    }
    wb_json_destroy(root);
}

static void one_long_step_gives_the_same_as_many(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct rig rig = make_rig(&cases[i]);
        struct wb_cantilever_point many = {0};
        for (int mm = 0; mm <= 53; mm++)
            many = test_move(rig.cantilever, WB_CONTROL_DEFLECTION, mm * WB_MM);
        wb_cantilever_reset(rig.cantilever);
        const struct wb_cantilever_point one =
            test_move(rig.cantilever, WB_CONTROL_DEFLECTION, 0.053);
        assert_close_relative(one.tension, many.tension, 1e-7);
        assert_close(one.tip_x, many.tip_x, 1e-9);
        assert_true(one.iterations <= 15);
        release_rig(&rig);
    }
}

static void unloaded_wire_keeps_the_residual_deflection(void **unused)
{
    (void)unused;
    struct wb_json *root = read_reference();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        if (cases[i].strand_and_weight)
            continue; /* in the reference strand and weight are removed */
        const struct wb_json *rows = wb_json_get(root, cases[i].name);
        struct rig rig = make_rig(&cases[i]);
        double worst = 0.0;
        for (size_t r = 0; r < wb_json_length(rows); r++) {
            const struct wb_json *row = wb_json_item(rows, r);
            const double deflection = number(row, "deflection_mm") * WB_MM;
            wb_cantilever_reset(rig.cantilever);
            test_move(rig.cantilever, WB_CONTROL_DEFLECTION, deflection);
            const struct wb_cantilever_point p =
                test_move(rig.cantilever, WB_CONTROL_DEAD_FORCE, 0.0);
            const double left = number(row, "residual_deflection_no_weight_mm") * WB_MM;
            worst = fmax(worst, fabs(p.deflection - left));
        }
        print_message("%s: residual deflection within %.4f mm\n", cases[i].name, worst / WB_MM);
        assert_true(worst <= 0.05 * WB_MM);
        release_rig(&rig);
    }
    wb_json_destroy(root);
}

static void published_bundle_curves_are_reproduced(void **unused)
{
    (void)unused;
    /* Rod solutions of the paper's five bundles as beams, L = 114 mm, vertical dead force, N. */
    static const double deflections[] = {2, 5.7, 10, 20, 30, 40, 53};
    static const struct {
        const char *name;
        double diameter, E, sigma_Y, K, n, force[7];
    } bundles[] = {
        {"7",
         4.6e-3,
         1114e6,
         2.70e6,
         544.9e6,
         0.92,
         {.0992, .2825, .4516, .7364, 1.0069, 1.3076, 1.8011}},
        {"12",
         5.8e-3,
         1022e6,
         3.12e6,
         75.1e6,
         0.50,
         {.2300, .6567, 1.1199, 1.9348, 2.5910, 3.2271, 4.1589}},
        {"19",
         7.4e-3,
         616e6,
         2.40e6,
         15.0e6,
         0.32,
         {.3673, 1.0492, 1.8024, 2.9528, 3.6709, 4.2797, 5.1090}},
        {"19 mixed",
         7.4e-3,
         442e6,
         1.72e6,
         7.8e6,
         0.26,
         {.2636, .7529, 1.3025, 2.1286, 2.5969, 2.9741, 3.4779}},
        {"27",
         9.2e-3,
         449e6,
         2.17e6,
         41.6e6,
         0.65,
         {.6397, 1.8233, 2.9153, 4.4515, 5.6603, 6.8731, 8.7198}},
    };
    for (size_t i = 0; i < 5; i++) {
        const struct wb_material m = {WB_HARDENING_ISOTROPIC_POWER, bundles[i].E, 0.3,
                                      bundles[i].sigma_Y,           bundles[i].K, bundles[i].n};
        struct wb_section s;
        assert_int_equal(wb_section_init_circle(&s, bundles[i].diameter, &m, 0), WB_OK);
        /* The reference rod neither extends nor shears; shear would change a bundle's beam by 0.5
         * %. */
        s.shear_stiffness *= 1e3;
        struct wb_cantilever_model model;
        wb_cantilever_default_model(&model);
        model.section = &s;
        model.length = 0.114;
        struct wb_cantilever *c = test_cantilever(&model);
        double worst = 0.0;
        for (int k = 0; k < 7; k++) {
            const struct wb_cantilever_point p =
                test_move(c, WB_CONTROL_DEFLECTION, deflections[k] * WB_MM);
            worst = fmax(worst, fabs(p.tension / bundles[i].force[k] - 1.0));
        }
        print_message("bundle of %s: force within %.3f %%\n", bundles[i].name, 100.0 * worst);
        assert_true(worst < 2.5e-3);
        wb_cantilever_destroy(c);
        wb_section_release(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_listed_deflection_agrees),
        cmocka_unit_test(one_long_step_gives_the_same_as_many),
        cmocka_unit_test(unloaded_wire_keeps_the_residual_deflection),
        cmocka_unit_test(published_bundle_curves_are_reproduced),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
