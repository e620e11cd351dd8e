/* A wire's axis from its markers. */
#include "analysis/align/axis_fit.h"

#include "tests/check.h"

#define N 6
#define LENGTH 0.085

static const double arcs[N] = {0.0142, 0.0283, 0.0425, 0.0567, 0.0708, 0.085};

/* Angle of a wire that is bent most at its root. */
static double angle_at(double bend, double s)
{
    const double u = s / LENGTH;
    return bend * (1.9 * u - 1.4 * u * u + 0.5 * u * u * u);
}

static void place(double bend, double offset, double s, double *x, double *y)
{
    enum {
        STEPS = 2000
    };
    *x = *y = 0.0;
    for (int i = 0; i < STEPS; i++) {
        const double angle = angle_at(bend, s * (i + 0.5) / STEPS);
        *x += cos(angle) * s / STEPS;
        *y += sin(angle) * s / STEPS;
    }
    *x -= offset * sin(angle_at(bend, s));
    *y += offset * cos(angle_at(bend, s));
}

static enum wb_status fit_markers(struct wb_axis_fit *fit, double offset, int n, const double *s,
                                  const double *x, const double *y)
{
    const struct wb_axis_fit_markers markers = {.n = n, .s = s, .x = x, .y = y, .offset = offset};
    return wb_axis_fit(fit, LENGTH, &markers);
}

static void offset_is_taken_off_along_the_normal(void **state)
{
    (void)state;
    for (double bend = -0.3; bend < 1.6; bend += 0.3) {
        struct wb_axis_fit fit;
        double x[N], y[N];
        for (int i = 0; i < N; i++)
            place(bend, 1e-3, arcs[i], &x[i], &y[i]);
        assert_int_equal(fit_markers(&fit, 1e-3, N, arcs, x, y), WB_OK);
        assert_close(fit.residual, 0.0, 1e-7);
        for (int i = 0; i < N; i++) {
            double axis_x, axis_y;
            place(bend, 0.0, arcs[i], &axis_x, &axis_y);
            wb_axis_fit_move(&fit, 1e-3, arcs[i], &x[i], &y[i]);
            assert_close(x[i], axis_x, 1e-6);
            assert_close(y[i], axis_y, 1e-6);
            assert_close(wb_axis_fit_angle(&fit, arcs[i]), angle_at(bend, arcs[i]), 1e-4);
        }
    }
}

static void missing_markers_do_not_disturb_the_fit(void **state)
{
    (void)state;
    for (int missing = 0; missing < N - 1; missing++) {
        struct wb_axis_fit fit;
        double s[N], x[N], y[N], tip_x, tip_y;
        int n = 0;
        for (int i = 0; i < N; i++) {
            if (i == missing)
                continue;
            s[n] = arcs[i];
            place(1.1, 1e-3, arcs[i], &x[n], &y[n]);
            n++;
        }
        assert_int_equal(fit_markers(&fit, 1e-3, n, s, x, y), WB_OK);
        place(1.1, 0.0, LENGTH, &tip_x, &tip_y);
        wb_axis_fit_move(&fit, 1e-3, LENGTH, &x[n - 1], &y[n - 1]);
        assert_close(y[n - 1], tip_y, 2e-6);
    }
}

static void a_single_marker_gives_an_arc(void **state)
{
    (void)state;
    struct wb_axis_fit fit;
    const double s = LENGTH, radius = 0.1;
    const double x = radius * sin(s / radius), y = radius * (1.0 - cos(s / radius));
    assert_int_equal(fit_markers(&fit, 0.0, 1, &s, &x, &y), WB_OK);
    assert_int_equal(fit.n_terms, 1);
    assert_close(wb_axis_fit_angle(&fit, s), s / radius, 1e-5);
}

static void missing_and_invalid_markers_are_rejected(void **state)
{
    (void)state;
    struct wb_axis_fit fit;
    const double s[2] = {0.04, 0.085}, x[2] = {(double)NAN, 0.08}, y[2] = {0.0, 0.0};
    assert_int_equal(fit_markers(&fit, 0.0, 0, s, x, y), WB_ERR_DATA);
    assert_int_equal(fit_markers(&fit, 0.0, 2, s, x, y), WB_ERR_DATA);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(offset_is_taken_off_along_the_normal),
        cmocka_unit_test(missing_markers_do_not_disturb_the_fit),
        cmocka_unit_test(a_single_marker_gives_an_arc),
        cmocka_unit_test(missing_and_invalid_markers_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
