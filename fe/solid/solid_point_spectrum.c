/* Eigenvalues and eigenvectors of C for eight points of an element at once: Jacobi's method is
 * limited by the latency of square roots and divisions, so eight points take as long as one.
 * Products and sums are not contracted: all processors give identical bits. */
#include <math.h>
#include <string.h>

#include "fe/linear/processor.h"
#include "fe/solid/solid_point.h"

enum {
    LANES = 8
};

typedef double lanes __attribute__((vector_size(LANES * sizeof(double))));
typedef long long masks __attribute__((vector_size(LANES * sizeof(long long))));

/* Symmetric matrices with components 11, 22, 33, 12, 23, 31, and orthogonal matrices whose rows
 * become the eigenvectors. */
struct batch {
    lanes a[6];
    lanes v[3][3];
};

static const long long sign_bit = (long long)0x8000000000000000ULL;

static WB_ALWAYS_INLINE void take_absolute(lanes *x)
{
    *x = (lanes)((masks)*x & ~sign_bit);
}

/* This file is compiled with -fno-math-errno, so that the loop becomes one instruction. */
static WB_ALWAYS_INLINE void take_root(lanes *x)
{
    double root[LANES];
    for (int i = 0; i < LANES; i++)
        root[i] = sqrt((*x)[i]);
    for (int i = 0; i < LANES; i++)
        (*x)[i] = root[i];
}

/* One Jacobi rotation, which zeroes component pq. */
static WB_ALWAYS_INLINE void rotate(struct batch *m, int p, int q)
{
    static const int place[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    const int r = 3 - p - q, rp = place[r][p], rq = place[r][q], pq = place[p][q];
    const lanes one = (lanes){0.0} + 1.0;
    lanes x = m->a[pq], size = x;

    take_absolute(&size);
    x = (lanes)((masks)x & (size > 1e-150)); /* smaller values would underflow when squared */

    /* t = tan of the angle = 2 x / (gap +- root), with the sign of gap. */
    const lanes gap = m->a[q] - m->a[p];
    lanes root = gap * gap + 4.0 * (x * x);
    take_root(&root);
    lanes sum = gap + (lanes)((masks)root | ((masks)gap & sign_bit));
    sum = (lanes)((masks)sum | ((masks)one & (sum == 0.0)));
    const lanes t = 2.0 * x / sum;
    lanes c = 1.0 + t * t;
    take_root(&c);
    c = 1.0 / c;
    const lanes s = t * c, old_p = m->a[rp], old_q = m->a[rq];

    m->a[p] -= t * x;
    m->a[q] += t * x;
    m->a[pq] = (lanes){0.0};
    m->a[rp] = c * old_p - s * old_q;
    m->a[rq] = s * old_p + c * old_q;
    for (int k = 0; k < 3; k++) {
        const lanes vp = m->v[p][k], vq = m->v[q][k];
        m->v[p][k] = c * vp - s * vq;
        m->v[q][k] = s * vp + c * vq;
    }
}

static WB_ALWAYS_INLINE bool is_diagonal(const struct batch *m)
{
    lanes a[6];
    for (int k = 0; k < 6; k++) {
        a[k] = m->a[k];
        take_absolute(&a[k]);
    }
    /* The comparison is false for NaN, which then spreads to all eigenvalues, where the caller
     * detects it. */
    const masks done = a[3] + a[4] + a[5] <= 1e-18 * (a[0] + a[1] + a[2]);
    long long all = -1;
    for (int i = 0; i < LANES; i++)
        all &= done[i];
    return all != 0;
}

static WB_ALWAYS_INLINE void sweep_batch(struct batch *batch)
{
    struct batch m = *batch;
    for (int sweep = 0; sweep < 12 && !is_diagonal(&m); sweep++) {
        rotate(&m, 0, 1);
        rotate(&m, 0, 2);
        rotate(&m, 1, 2);
    }
    *batch = m;
}

static void sweep_portably(struct batch *m)
{
    sweep_batch(m);
}

#ifdef WB_HAS_X86_VARIANTS
WB_AVX2 static void sweep_avx2(struct batch *m)
{
    sweep_batch(m);
}

WB_AVX512 static void sweep_avx512(struct batch *m)
{
    sweep_batch(m);
}
#endif

static void sweep(struct batch *m)
{
#ifdef WB_HAS_X86_VARIANTS
    if (wb_processor_has_avx512()) {
        sweep_avx512(m);
        return;
    }
    if (wb_processor_has_avx2()) {
        sweep_avx2(m);
        return;
    }
#endif
    sweep_portably(m);
}

/* C - I = H + H^T + H^T H, which keeps the digits of small strains. */
static void load(struct batch *m, int lane, const struct wb_solid_point_motion *motion)
{
    static const int row[6] = {0, 1, 2, 0, 1, 2}, column[6] = {0, 1, 2, 1, 2, 0};

    for (int k = 0; k < 6; k++) {
        const int i = row[k], j = column[k];
        double product = 0.0;
        for (int n = 0; n < 3; n++)
            product += motion->gradient[n][i] * motion->gradient[n][j];
        m->a[k][lane] = motion->gradient[i][j] + motion->gradient[j][i] + product;
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            m->v[i][j][lane] = i == j;
    }
}

void wb_solid_point_diagonalise(struct wb_solid_point_motion *motion, int n)
{
    for (int first = 0; first < n; first += LANES) {
        const int count = n - first < LANES ? n - first : LANES;
        struct batch m;
        memset(&m, 0, sizeof m);
        for (int lane = 0; lane < count; lane++)
            load(&m, lane, &motion[first + lane]);
        sweep(&m);
        for (int lane = 0; lane < count; lane++) {
            struct wb_solid_point_spectrum *s = &motion[first + lane].spectrum;
            for (int i = 0; i < 3; i++) {
                s->excess[i] = m.a[i][lane];
                s->stretch[i] = sqrt(1.0 + s->excess[i]);
                s->log_stretch[i] = 0.5 * log1p(s->excess[i]);
                for (int j = 0; j < 3; j++)
                    s->vectors.row[i][j] = m.v[i][j][lane];
            }
        }
    }
}
