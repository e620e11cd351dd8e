#include "fe/solid/hex20_kernel.h"

#include "fe/solid/hex20_kernel_private.h"
#include "tests/check.h"
#include "tests/fe/solid/hex20_cases.h"

/* sum over points, j and l of g_aj A_ijkl g_bl, with A from the response. */
static double entry(const struct wb_hex20_kernel *kernel,
                    const struct wb_solid_point_response *response, const double *weight, int row,
                    int column)
{
    static const int place[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    const int a = row / 3, i = row % 3, b = column / 3, k = column % 3;
    double sum = 0.0;
    for (int p = 0; p < kernel->points; p++) {
        for (int j = 0; j < 3; j++) {
            for (int l = 0; l < 3; l++) {
                double A = response[p].tangent[place[i][j]][place[k][l]];
                if (i == k)
                    A += response[p].stress[place[j][l]];
                sum += weight[p] * kernel->g[p][j][a] * A * kernel->g[p][l][b];
            }
        }
    }
    return sum;
}

static void check_variant(enum wb_hex20_kernel_variant variant, const char *name)
{
    static struct wb_hex20_kernel kernel;
    static double K[3600], by_default[3600];
    static const int counts[] = {1, 8, 16, 27, 35};
    struct wb_solid_point_response response[WB_HEX20_KERNEL_POINTS];
    double weight[WB_HEX20_KERNEL_POINTS];

    srand(1);
    for (int n = 0; n < 5; n++) {
        double worst = 0.0;
        kernel.points = 0;
        for (int p = 0; p < counts[n]; p++) {
            for (int i = 0; i < 60; i++)
                kernel.g[p][i / 20][i % 20] = random_number();
            for (int i = 0; i < 6; i++) {
                response[p].stress[i] = random_number();
                for (int j = 0; j <= i; j++)
                    response[p].tangent[i][j] = response[p].tangent[j][i] = random_number();
            }
            weight[p] = random_number();
            wb_hex20_kernel_add(&kernel, weight[p], &response[p]);
        }
        assert_int_equal(kernel.points, counts[n]);
        if (!wb_hex20_kernel_multiply_by(variant, &kernel, K)) {
            print_message("this processor does not have %s\n", name);
            return;
        }
        wb_hex20_kernel_multiply(&kernel, by_default);
        for (int i = 0; i < 3600; i++) {
            const double expected = entry(&kernel, response, weight, i / 60, i % 60);
            worst = fmax(worst, fabs(K[i] - expected));
            worst = fmax(worst, fabs(by_default[i] - expected));
            assert_true(K[i] == K[60 * (i % 60) + i / 60]);
        }
        assert_true(worst < 1e-13);
    }
}

static void portable_product_is_exact(void **unused)
{
    (void)unused;
    check_variant(WB_HEX20_KERNEL_PORTABLE, "");
}

static void product_with_avx2_is_exact(void **unused)
{
    (void)unused;
    check_variant(WB_HEX20_KERNEL_AVX2, "AVX2");
}

static void product_with_avx512_is_exact(void **unused)
{
    (void)unused;
    check_variant(WB_HEX20_KERNEL_AVX512, "AVX-512");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(portable_product_is_exact),
        cmocka_unit_test(product_with_avx2_is_exact),
        cmocka_unit_test(product_with_avx512_is_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
