/* Includes the source to test all its variants, of which the program uses one per processor. */
#include "fe/solid/hex20_points.c"

#include "tests/check.h"
#include "tests/fe/solid/hex20_cases.h"

enum {
    POINTS = 27
};

struct sums {
    double h[POINTS][9], spatial[POINTS][3][20], force[3][20];
};

static double gradient[POINTS][3][20], u[3][20];
static struct wb_hex20_points_load load[POINTS];

static void make_input(void)
{
    srand(1);
    for (int p = 0; p < POINTS; p++) {
        for (int i = 0; i < 60; i++)
            gradient[p][i / 20][i % 20] = random_number();
        for (int i = 0; i < 9; i++)
            load[p].inverse[i / 3][i % 3] = random_number();
        for (int i = 0; i < 6; i++)
            load[p].stress[i] = random_number();
    }
    for (int i = 0; i < 60; i++)
        u[i / 20][i % 20] = random_number();
}

/* h_ij = sum u_ia g_ja; force_ia = 1 + sum t_ij (F^-T g)_ja. */
static void sums_agree_with_the_formulas(void **unused)
{
    (void)unused;
    static const int component[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    struct sums s;
    double expected[3][20];

    make_input();
    for (int i = 0; i < 60; i++)
        s.force[i / 20][i % 20] = expected[i / 20][i % 20] = 1.0;
    wb_hex20_points_gradients(POINTS, gradient[0][0], u[0], s.h[0]);
    wb_hex20_points_forces(POINTS, gradient[0][0], load, s.spatial[0][0], s.force[0]);
    for (int p = 0; p < POINTS; p++) {
        for (int k = 0; k < 9; k++) {
            double sum = 0.0;
            for (int a = 0; a < 20; a++)
                sum += u[k / 3][a] * gradient[p][k % 3][a];
            assert_close(s.h[p][k], sum, 1e-14);
        }
        for (int a = 0; a < 20; a++) {
            for (int i = 0; i < 3; i++) {
                double sum = 0.0;
                for (int j = 0; j < 3; j++)
                    sum += load[p].inverse[j][i] * gradient[p][j][a];
                assert_close(s.spatial[p][i][a], sum, 1e-14);
                for (int j = 0; j < 3; j++)
                    expected[j][a] += load[p].stress[component[j][i]] * sum;
            }
        }
    }
    for (int i = 0; i < 60; i++)
        assert_close(s.force[i / 20][i % 20], expected[i / 20][i % 20], 1e-13);
}

static void all_processors_give_the_same_bits(void **unused)
{
    (void)unused;
#ifdef HAVE_X86_VARIANTS
    static struct sums portable, avx2, avx512;
    make_input();
    find_gradients(POINTS, gradient[0][0], u[0], portable.h[0]);
    find_forces(POINTS, gradient[0][0], load, portable.spatial[0][0], portable.force[0]);
    if (__builtin_cpu_supports("avx2")) {
        gradients_avx2(POINTS, gradient[0][0], u[0], avx2.h[0]);
        forces_avx2(POINTS, gradient[0][0], load, avx2.spatial[0][0], avx2.force[0]);
        assert_memory_equal(&avx2, &portable, sizeof portable);
    }
    if (has_avx512()) {
        gradients_avx512(POINTS, gradient[0][0], u[0], avx512.h[0]);
        forces_avx512(POINTS, gradient[0][0], load, avx512.spatial[0][0], avx512.force[0]);
        assert_memory_equal(&avx512, &portable, sizeof portable);
    }
#else
    skip();
#endif
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sums_agree_with_the_formulas),
        cmocka_unit_test(all_processors_give_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
