#include "fe/solid/hex20_points.h"

#include "fe/linear/processor.h"

enum {
    NODES = WB_HEX20_NODES,
    LANES = 4,
    PARTS = NODES / LANES /* of a row of 20 */
};

typedef double lanes __attribute__((vector_size(LANES * sizeof(double)), aligned(8), may_alias));

static WB_ALWAYS_INLINE double dot(const lanes *a, const lanes *b)
{
    lanes sum = a[0] * b[0];
    for (int k = 1; k < PARTS; k++)
        sum += a[k] * b[k];
    return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

static WB_ALWAYS_INLINE void find_gradients(int n, const double *restrict gradient,
                                            const double *restrict u, double *restrict h)
{
    const lanes *along = (const lanes *)u;

    for (int p = 0; p < n; p++) {
        const lanes *g = (const lanes *)(gradient + p * 3 * NODES);
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++)
                h[9 * p + 3 * i + j] = dot(along + i * PARTS, g + j * PARTS);
        }
    }
}

static WB_ALWAYS_INLINE void find_forces(int n, const double *restrict gradient,
                                         const struct wb_hex20_points_load *restrict load,
                                         double *restrict spatial, double *restrict force)
{
    /* Index of component ij among the six. */
    static const int place[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    lanes sum[3][PARTS];

    for (int k = 0; k < 3 * PARTS; k++)
        sum[k / PARTS][k % PARTS] = ((const lanes *)force)[k];
    for (int p = 0; p < n; p++) {
        const lanes *g = (const lanes *)(gradient + p * 3 * NODES);
        lanes *out = (lanes *)(spatial + p * 3 * NODES);
        double f[3][3], t[6];
        for (int i = 0; i < 9; i++)
            f[i / 3][i % 3] = load[p].inverse[i / 3][i % 3];
        for (int i = 0; i < 6; i++)
            t[i] = load[p].stress[i];
        for (int k = 0; k < PARTS; k++) {
            const lanes a = g[k], b = g[PARTS + k], c = g[2 * PARTS + k];
            const lanes x = f[0][0] * a + f[1][0] * b + f[2][0] * c;
            const lanes y = f[0][1] * a + f[1][1] * b + f[2][1] * c;
            const lanes z = f[0][2] * a + f[1][2] * b + f[2][2] * c;
            out[k] = x;
            out[PARTS + k] = y;
            out[2 * PARTS + k] = z;
            for (int i = 0; i < 3; i++)
                sum[i][k] += t[place[i][0]] * x + t[place[i][1]] * y + t[place[i][2]] * z;
        }
    }
    for (int k = 0; k < 3 * PARTS; k++)
        ((lanes *)force)[k] = sum[k / PARTS][k % PARTS];
}

#ifdef WB_HAS_X86_VARIANTS
WB_AVX2 static void gradients_avx2(int n, const double *restrict gradient, const double *restrict u,
                                   double *restrict h)
{
    find_gradients(n, gradient, u, h);
}

WB_AVX512 static void gradients_avx512(int n, const double *restrict gradient,
                                       const double *restrict u, double *restrict h)
{
    find_gradients(n, gradient, u, h);
}

WB_AVX2 static void forces_avx2(int n, const double *restrict gradient,
                                const struct wb_hex20_points_load *restrict load,
                                double *restrict spatial, double *restrict force)
{
    find_forces(n, gradient, load, spatial, force);
}

WB_AVX512 static void forces_avx512(int n, const double *restrict gradient,
                                    const struct wb_hex20_points_load *restrict load,
                                    double *restrict spatial, double *restrict force)
{
    find_forces(n, gradient, load, spatial, force);
}

#endif

void wb_hex20_points_gradients(int n, const double *restrict gradient, const double *restrict u,
                               double *restrict h)
{
#ifdef WB_HAS_X86_VARIANTS
    if (wb_processor_has_avx512()) {
        gradients_avx512(n, gradient, u, h);
        return;
    }
    if (wb_processor_has_avx2()) {
        gradients_avx2(n, gradient, u, h);
        return;
    }
#endif
    find_gradients(n, gradient, u, h);
}

void wb_hex20_points_forces(int n, const double *restrict gradient,
                            const struct wb_hex20_points_load *restrict load,
                            double *restrict spatial, double *restrict force)
{
#ifdef WB_HAS_X86_VARIANTS
    if (wb_processor_has_avx512()) {
        forces_avx512(n, gradient, load, spatial, force);
        return;
    }
    if (wb_processor_has_avx2()) {
        forces_avx2(n, gradient, load, spatial, force);
        return;
    }
#endif
    find_forces(n, gradient, load, spatial, force);
}
