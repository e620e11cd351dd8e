#include "fe/solid/hex20_kernel.h"

#include <string.h>

#include "fe/linear/processor.h"
#include "fe/solid/hex20_kernel_private.h"

/* Contraction of products and sums is allowed here: the stiffness only determines the convergence
 * of Newton's method, while the equilibrium depends on the forces, which are computed without
 * contraction. Compared with a reference implementation in tests/fe/solid/test_hex20.c. */
#if defined(__clang__)
#pragma clang fp contract(fast)
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=fast")
#endif

enum {
    NODES = WB_HEX20_NODES,
    UNKNOWNS = WB_HEX20_UNKNOWNS,
    PAIRS = WB_HEX20_KERNEL_PAIRS,
    ROWS = 3 * WB_HEX20_KERNEL_POINTS,
    PANEL_PAIRS = 2, /* a panel holds the columns of two pairs, which fit into the L1 cache */
    COLUMNS = PANEL_PAIRS * NODES
};

/* The pairs ik, and the indices of components among the six. */
static const int pair_row[PAIRS] = {0, 1, 2, 0, 1, 2};
static const int pair_column[PAIRS] = {0, 1, 2, 1, 2, 0};
static const int place[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

void wb_hex20_kernel_add(struct wb_hex20_kernel *kernel, double weight,
                         const struct wb_solid_point_response *response)
{
    double(*A)[3][3] = kernel->A[kernel->points++];

    for (int pair = 0; pair < PAIRS; pair++) {
        const int i = pair_row[pair], k = pair_column[pair];
        for (int j = 0; j < 3; j++) {
            for (int l = 0; l < 3; l++) {
                const double geometric = i == k ? response->stress[place[j][l]] : 0.0;
                A[pair][j][l] = weight * (response->tangent[place[i][j]][place[k][l]] + geometric);
            }
        }
    }
}

typedef double wide __attribute__((vector_size(64), aligned(8), may_alias));
typedef double narrow __attribute__((vector_size(32), aligned(8), may_alias));

/* Computes the columns of a panel of Y. */
static WB_ALWAYS_INLINE void fill_panel(const struct wb_hex20_kernel *kernel, int panel,
                                        double y[ROWS][COLUMNS])
{
    for (int p = 0; p < kernel->points; p++) {
        const narrow *x = (const narrow *)kernel->g[p][0];
        for (int half = 0; half < PANEL_PAIRS; half++) {
            for (int j = 0; j < 3; j++) {
                const double *A = kernel->A[p][PANEL_PAIRS * panel + half][j];
                narrow *out = (narrow *)&y[3 * p + j][half * NODES];
                for (int b = 0; b < NODES / 4; b++)
                    out[b] = A[0] * x[b] + A[1] * x[NODES / 4 + b] + A[2] * x[NODES / 2 + b];
            }
        }
    }
}

/* block[a][column] = sum over rows of g[row][a] y[row][column] for four nodes a and all columns: 20
 * sums in registers of eight lanes. */
static WB_ALWAYS_INLINE void multiply_wide(const double *g, int rows, double y[ROWS][COLUMNS],
                                           double block[4][COLUMNS])
{
    wide sum[4][5] = {{{0.0}}};

    for (int row = 0; row < rows; row++) {
        const wide *right = (const wide *)y[row];
        const double *left = g + row * NODES;
        const wide y0 = right[0], y1 = right[1], y2 = right[2], y3 = right[3], y4 = right[4];
#pragma GCC unroll 4
        for (int a = 0; a < 4; a++) {
            const wide factor = left[a] - (wide){0.0};
            sum[a][0] += factor * y0;
            sum[a][1] += factor * y1;
            sum[a][2] += factor * y2;
            sum[a][3] += factor * y3;
            sum[a][4] += factor * y4;
        }
    }
    for (int a = 0; a < 4; a++)
        memcpy(block[a], sum[a], sizeof sum[a]);
}

/* As multiply_wide() for two nodes and half the columns, in registers of four lanes. */
static WB_ALWAYS_INLINE void multiply_narrow(const double *g, int rows, const double *y,
                                             double block[2][COLUMNS])
{
    narrow sum[2][5] = {{{0.0}}};

    for (int row = 0; row < rows; row++) {
        const narrow *right = (const narrow *)(y + row * COLUMNS);
        const double *left = g + row * NODES;
        const narrow y0 = right[0], y1 = right[1], y2 = right[2], y3 = right[3], y4 = right[4];
#pragma GCC unroll 2
        for (int a = 0; a < 2; a++) {
            const narrow factor = left[a] - (narrow){0.0};
            sum[a][0] += factor * y0;
            sum[a][1] += factor * y1;
            sum[a][2] += factor * y2;
            sum[a][3] += factor * y3;
            sum[a][4] += factor * y4;
        }
    }
    for (int a = 0; a < 2; a++)
        memcpy(block[a], sum[a], sizeof sum[a]);
}

static WB_ALWAYS_INLINE void multiply_panels(const struct wb_hex20_kernel *kernel, bool is_wide,
                                             double *restrict stiffness)
{
    const double *g = &kernel->g[0][0][0];
    const int rows = 3 * kernel->points;
    double(*K)[UNKNOWNS] = (double(*)[UNKNOWNS])stiffness;

    for (int panel = 0; panel < PAIRS / PANEL_PAIRS; panel++) {
        double y[ROWS][COLUMNS], block[NODES][COLUMNS];
        fill_panel(kernel, panel, y);
        if (is_wide) {
            for (int a = 0; a < NODES; a += 4)
                multiply_wide(g + a, rows, y, &block[a]);
        } else {
            for (int half = 0; half < PANEL_PAIRS; half++) {
                for (int a = 0; a < NODES; a += 2)
                    multiply_narrow(g + a, rows, &y[0][half * NODES],
                                    (double(*)[COLUMNS]) & block[a][half * NODES]);
            }
        }
        for (int half = 0; half < PANEL_PAIRS; half++) {
            const int pair = PANEL_PAIRS * panel + half, i = pair_row[pair], k = pair_column[pair];
            for (int a = 0; a < NODES; a++) {
                for (int b = i == k ? a : 0; b < NODES; b++)
                    K[3 * a + i][3 * b + k] = K[3 * b + k][3 * a + i] = block[a][half * NODES + b];
            }
        }
    }
}

static void multiply_portably(const struct wb_hex20_kernel *kernel, double *restrict stiffness)
{
    multiply_panels(kernel, false, stiffness);
}

#ifdef WB_HAS_X86_VARIANTS
__attribute__((target("avx2,fma"))) static void multiply_avx2(const struct wb_hex20_kernel *kernel,
                                                              double *restrict stiffness)
{
    multiply_panels(kernel, false, stiffness);
}

__attribute__((target("avx2,fma,avx512f,avx512dq,avx512vl"))) static void
multiply_avx512(const struct wb_hex20_kernel *kernel, double *restrict stiffness)
{
    multiply_panels(kernel, true, stiffness);
}
#endif

bool wb_hex20_kernel_multiply_by(enum wb_hex20_kernel_variant variant,
                                 const struct wb_hex20_kernel *kernel, double *restrict stiffness)
{
    switch (variant) {
    case WB_HEX20_KERNEL_PORTABLE:
        multiply_portably(kernel, stiffness);
        return true;
#ifdef WB_HAS_X86_VARIANTS
    case WB_HEX20_KERNEL_AVX2:
        if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma"))
            return false;
        multiply_avx2(kernel, stiffness);
        return true;
    case WB_HEX20_KERNEL_AVX512:
        if (!wb_processor_has_avx512())
            return false;
        multiply_avx512(kernel, stiffness);
        return true;
#endif
    default:
        return false;
    }
}

void wb_hex20_kernel_multiply(const struct wb_hex20_kernel *kernel, double *restrict stiffness)
{
    if (!wb_hex20_kernel_multiply_by(WB_HEX20_KERNEL_AVX512, kernel, stiffness) &&
        !wb_hex20_kernel_multiply_by(WB_HEX20_KERNEL_AVX2, kernel, stiffness))
        multiply_portably(kernel, stiffness);
}
