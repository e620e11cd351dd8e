/* Includes the source to test all its variants, of which the program uses one per processor. */
#include "fe/solid/solid_point_spectrum.c"

#include "tests/check.h"
#include "tests/fe/solid/hex20_cases.h"

enum {
    MOST = 27
};

/* Displacement gradients of very different sizes, some with equal eigenvalues, some zero. */
static void make_motions(struct wb_solid_point_motion *motion)
{
    srand(1);
    for (int p = 0; p < MOST; p++) {
        double h[9] = {0.0};
        const double size = pow(10.0, -(p % 9) * 2);
        for (int i = 0; i < 9; i++) {
            if (p % 3 == 0)
                h[i] = 0.3 * size * random_number();
            else if (p % 3 == 1)
                h[i] = i % 4 == 0 ? 0.3 * size * (i < 8) : 0.0; /* two equal */
            else
                h[i] = i == 1 || i == 3 ? size * 0.4 : 0.0; /* equal diagonal, shear only */
        }
        if (p == 26)
            memset(h, 0, sizeof h);
        assert_true(wb_solid_point_motion_init(&motion[p], h));
    }
}

static void spectrum_reproduces_its_tensor(void **unused)
{
    (void)unused;
    struct wb_solid_point_motion motion[MOST];
    make_motions(motion);
    wb_solid_point_diagonalise(motion, MOST);
    for (int p = 0; p < MOST; p++) {
        const struct wb_solid_point_spectrum *s = &motion[p].spectrum;
        double size = 0.0;
        for (int k = 0; k < 9; k++)
            size = fmax(size, fabs(motion[p].gradient[k / 3][k % 3]));
        for (int k = 0; k < 9; k++) {
            const int i = k / 3, j = k % 3;
            double C = motion[p].gradient[i][j] + motion[p].gradient[j][i], sum = 0.0, dot = 0.0;
            for (int n = 0; n < 3; n++) {
                C += motion[p].gradient[n][i] * motion[p].gradient[n][j];
                sum += s->excess[n] * s->vectors.row[n][i] * s->vectors.row[n][j];
                dot += s->vectors.row[i][n] * s->vectors.row[j][n];
            }
            assert_close(sum, C, 5e-15 * size);
            assert_close(dot, i == j, 4e-15);
        }
        for (int i = 0; i < 3; i++) {
            assert_close(s->stretch[i] * s->stretch[i] - 1.0, s->excess[i], 1e-15);
            assert_close_relative(expm1(2.0 * s->log_stretch[i]), s->excess[i], 1e-15);
        }
    }
}

/* For any number of points per call, and any neighbouring points. */
static void any_number_of_points_is_supported(void **unused)
{
    (void)unused;
    struct wb_solid_point_motion all[MOST], some[MOST];
    make_motions(all);
    wb_solid_point_diagonalise(all, MOST);
    for (int n = 1; n <= MOST; n++) {
        make_motions(some);
        memset(&some[MOST - 1].spectrum, 0, sizeof some->spectrum);
        wb_solid_point_diagonalise(some, n);
        for (int p = 0; p < n; p++) {
            for (int i = 0; i < 3; i++)
                assert_close(some[p].spectrum.log_stretch[i], all[p].spectrum.log_stretch[i],
                             1e-15 * fabs(all[p].gradient[0][0]) + 1e-18);
        }
        assert_true(n == MOST || some[MOST - 1].spectrum.stretch[0] == 0.0);
    }
}

static void all_processors_give_the_same_bits(void **unused)
{
    (void)unused;
#ifdef HAVE_X86_VARIANTS
    struct wb_solid_point_motion motion[MOST];
    struct batch portable, other;
    make_motions(motion);
    for (int first = 0; first + LANES <= MOST; first += LANES) {
        for (int lane = 0; lane < LANES; lane++)
            load(&portable, lane, &motion[first + lane]);
        other = portable;
        const struct batch start = portable;
        sweep_portably(&portable);
        if (__builtin_cpu_supports("avx2")) {
            sweep_avx2(&other);
            assert_memory_equal(&other, &portable, sizeof portable);
        }
        if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
            __builtin_cpu_supports("avx512vl")) {
            other = start;
            sweep_avx512(&other);
            assert_memory_equal(&other, &portable, sizeof portable);
        }
    }
#else
    skip();
#endif
}

static void non_finite_input_is_reported(void **unused)
{
    (void)unused;
    struct wb_solid_point_motion motion[2];
    memset(motion, 0, sizeof motion);
    motion[0].gradient[1][2] = (double)NAN;
    motion[1].gradient[1][2] = 1e300;
    wb_solid_point_diagonalise(motion, 2);
    for (int i = 0; i < 3; i++)
        assert_true(isnan(motion[0].spectrum.log_stretch[i]));
    assert_false(isfinite(motion[1].spectrum.log_stretch[0] + motion[1].spectrum.log_stretch[1] +
                          motion[1].spectrum.log_stretch[2]));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spectrum_reproduces_its_tensor),
        cmocka_unit_test(any_number_of_points_is_supported),
        cmocka_unit_test(all_processors_give_the_same_bits),
        cmocka_unit_test(non_finite_input_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
