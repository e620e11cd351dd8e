/* A cantilever bent beyond yield and released, compared with a shooting solution: the inextensible
 * elastica under a vertical dead force, whose curvature follows from the moment by the closed form
 * of parallel parts and Masing's rule, at each point of the wire. */
#include <stdlib.h>

#include "fe/material/law.h"
#include "fe/trial/cantilever.h"
#include "tests/fe/rod/wires.h"

#define DIAMETER 1.25e-3
#define LENGTH 0.085

enum {
    FINE = 800, /* steps of the loading; unloading needs its moments at half of its own steps */
    COARSE = FINE / 2
};

static const struct wb_law_part parts[] = {
    {2.5e9, 2e-4}, {1.5e9, 8e-4}, {0.8e9, 3e-3}, {0.5e9, 9e-3}, {0.3e9, (double)INFINITY}};

/* Moment of a monotonic loading and its slope. */
static double moment(double kappa, double *slope)
{
    const double R = 0.5 * DIAMETER;
    double M = 0.0;
    *slope = 0.0;
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        const double u = fmin(1.0, parts[i].yield_strain / (kappa * R));
        const double core =
            R * R * R * R / 8.0 * (asin(u) - u * sqrt(1.0 - u * u) * (1.0 - 2.0 * u * u));
        M += 4.0 * parts[i].modulus * kappa * core;
        if (u < 1.0)
            M += 4.0 / 3.0 * R * R * R * parts[i].modulus * parts[i].yield_strain *
                 pow(1.0 - u * u, 1.5);
        *slope += 4.0 * parts[i].modulus * core;
    }
    return M;
}

/* Curvature of a monotonic loading, of either sign. */
static double curvature(double M)
{
    double slope, kappa = 1.0;
    if (M == 0.0)
        return 0.0;
    for (int i = 0; i < 60; i++) {
        const double step = (moment(kappa, &slope) - fabs(M)) / slope;
        kappa = fmax(kappa - step, 0.01 * kappa);
        if (fabs(step) < 1e-13 * kappa)
            break;
    }
    return copysign(kappa, M);
}

/* The wire at a force; `largest` NULL: monotonic loading. */
struct shot {
    int n;
    const double *largest; /* (2 n + 1) moments at the reversal */
    double force, tip;     /* N; m: x of the tip to find */
    double x[FINE + 1], y[FINE + 1], moment[FINE + 1];
};

static double curvature_at(const struct shot *shot, int half, double x)
{
    const double M = shot->force * (shot->tip - x);
    if (!shot->largest)
        return curvature(M);
    const double top = shot->largest[half];
    return curvature(top) - 2.0 * curvature(0.5 * (top - M));
}

/* Integrates from the clamp; returns the error of the tip's x. */
static double shoot(struct shot *shot, double tip)
{
    const double h = LENGTH / shot->n;
    double x = 0.0, y = 0.0, t = 0.0;
    shot->tip = tip;
    for (int i = 0; i <= shot->n; i++) {
        shot->x[i] = x;
        shot->y[i] = y;
        shot->moment[i] = shot->force * (tip - x);
        if (i == shot->n)
            break;
        const double k1 = curvature_at(shot, 2 * i, x);
        const double t2 = t + 0.5 * h * k1, x2 = x + 0.5 * h * cos(t);
        const double k2 = curvature_at(shot, 2 * i + 1, x2);
        const double t3 = t + 0.5 * h * k2, x3 = x + 0.5 * h * cos(t2);
        const double k3 = curvature_at(shot, 2 * i + 1, x3);
        const double t4 = t + h * k3, x4 = x + h * cos(t3);
        const double k4 = curvature_at(shot, 2 * i + 2, x4);
        x += h / 6.0 * (cos(t) + 2.0 * cos(t2) + 2.0 * cos(t3) + cos(t4));
        y += h / 6.0 * (sin(t) + 2.0 * sin(t2) + 2.0 * sin(t3) + sin(t4));
        t += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    return x - tip;
}

static void solve(struct shot *shot)
{
    /* An x that is too large gives too much moment, so that the computed tip is short of it. */
    double low = 0.2 * LENGTH, high = LENGTH;
    for (int i = 0; i < 50; i++) {
        const double middle = 0.5 * (low + high);
        if (shoot(shot, middle) > 0.0)
            low = middle;
        else
            high = middle;
    }
    assert_close(shoot(shot, 0.5 * (low + high)), 0.0, 1e-9);
}

static void loading_and_unloading_agree_with_shooting(void **unused)
{
    (void)unused;
    static struct shot up = {.n = FINE}, down = {.n = COARSE};
    struct wb_cantilever_model model;
    struct wb_cantilever_point point;
    struct wb_section section;
    struct wb_law law;
    wb_law_init_parallel(&law, parts, 5, 0.0, 0.39);
    assert_int_equal(wb_section_init_law(&section, DIAMETER, &law, 200), WB_OK);
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = LENGTH;
    model.gravity_y = 0.0;
    struct wb_cantilever *const cantilever = test_cantilever(&model);

    const double top = 0.12;
    const double forces[] = {0.04, 0.08, top, 0.09, 0.05, 0.02, 0.0, -0.02};
    for (size_t i = 0; i < sizeof forces / sizeof forces[0]; i++) {
        assert_int_equal(wb_cantilever_move(cantilever, WB_CONTROL_DEAD_FORCE, forces[i], &point),
                         WB_OK);
        assert_int_equal(point.end, WB_CANTILEVER_CONVERGED);
        struct shot *const shot = i < 3 ? &up : &down;
        shot->force = forces[i];
        down.largest = up.moment;
        solve(shot);
        print_message("    %5.2f N: y %.4f mm, by shooting %.4f mm\n", forces[i],
                      point.deflection / WB_MM, shot->y[shot->n] / WB_MM);
        assert_close(point.deflection, shot->y[shot->n], 3e-4 * 0.05);
        assert_close(point.tip_x, shot->x[shot->n], 3e-4 * 0.05);
    }
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
}

/* Strand, weight, natural shape and a law of either form: no step may need more iterations than
 * allowed. */
static void all_laws_converge_in_cycles_on_a_strand(void **unused)
{
    (void)unused;
    const struct wb_material ludwik = {
        WB_HARDENING_ISOTROPIC_POWER, 5641e6, 0.39, 4.95e6, 850e6, 0.78};
    for (int i = 0; i < 6; i++) {
        static const double shares[] = {0.0, 0.4, 1.0};
        struct wb_law law;
        struct wb_section section;
        struct wb_cantilever_model model;
        struct wb_cantilever_point point;
        if (i < 3) {
            wb_law_init_parallel(&law, parts, 5, shares[i], 0.39);
        } else {
            wb_law_init_ludwik(&law, &ludwik);
            law.isotropic_share = shares[i - 3];
        }
        assert_int_equal(wb_section_init_law(&section, DIAMETER, &law, 20), WB_OK);
        wb_cantilever_default_model(&model);
        model.section = &section;
        model.length = LENGTH;
        model.strand_length = 0.76;
        model.counterweight = 2.7e-3;
        model.mass_per_length = 5.3e-3;
        struct wb_cantilever *const cantilever = test_cantilever(&model);
        int iterations = 0, steps = 0;
        for (int cycle = 0; cycle < 2; cycle++) {
            for (int step = 1; step <= 100; step++) {
                const double y = (step <= 50 ? step : 100 - step) * 1.0 * WB_MM;
                assert_int_equal(wb_cantilever_move(cantilever, WB_CONTROL_DEFLECTION, y, &point),
                                 WB_OK);
                assert_int_equal(point.end, WB_CANTILEVER_CONVERGED);
                iterations += point.iterations;
                steps++;
            }
        }
        print_message("    law %d: %.2f iterations a step\n", i, (double)iterations / steps);
        assert_true(iterations < 6 * steps);
        wb_cantilever_destroy(cantilever);
        wb_section_release(&section);
    }
}

static void replaced_laws_and_shapes_act_like_new_ones(void **unused)
{
    (void)unused;
    struct wb_law first, second;
    struct wb_section section, fresh_section;
    struct wb_cantilever_model model;
    struct wb_cantilever_point a, b;
    wb_law_init_parallel(&first, parts, 5, 0.0, 0.39);
    wb_law_init_parallel(&second, parts, 5, 0.3, 0.39);
    for (int i = 0; i < 5; i++)
        second.parts[i].modulus *= 1.1;
    second.material.youngs_modulus *= 1.1;
    assert_int_equal(wb_section_init_law(&section, DIAMETER, &first, 20), WB_OK);
    assert_int_equal(wb_section_init_law(&fresh_section, DIAMETER, &second, 20), WB_OK);
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = LENGTH;
    struct wb_cantilever *const used = test_cantilever(&model);
    model.section = &fresh_section;
    struct wb_cantilever *const fresh = test_cantilever(&model);
    assert_int_equal(wb_cantilever_move(used, WB_CONTROL_DEFLECTION, 0.04, &a), WB_OK);
    assert_int_equal(wb_cantilever_set_curvature(used, NULL, NULL), WB_OK);
    assert_int_equal(wb_cantilever_set_law(used, &second), WB_OK);
    for (int step = 1; step <= 60; step++) {
        const double y = (step <= 40 ? step : 80 - step) * 1.0 * WB_MM;
        assert_int_equal(wb_cantilever_move(used, WB_CONTROL_DEFLECTION, y, &a), WB_OK);
        assert_int_equal(wb_cantilever_move(fresh, WB_CONTROL_DEFLECTION, y, &b), WB_OK);
        assert_close_relative(a.tension, b.tension, 1e-7);
    }
    struct wb_law plain = first;
    plain.form = WB_LAW_LUDWIK;
    plain.isotropic_share = 1.0;
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_cantilever_set_law(used, &plain), WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
    wb_cantilever_destroy(used);
    wb_cantilever_destroy(fresh);
    wb_section_release(&section);
    wb_section_release(&fresh_section);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(loading_and_unloading_agree_with_shooting),
        cmocka_unit_test(all_laws_converge_in_cycles_on_a_strand),
        cmocka_unit_test(replaced_laws_and_shapes_act_like_new_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
