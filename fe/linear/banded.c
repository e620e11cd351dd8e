#include "fe/linear/banded.h"

#include <math.h>

void wb_banded_invert(const double *restrict A, double *restrict inverse)
{
    const double c00 = A[4] * A[8] - A[5] * A[5];
    const double c01 = A[2] * A[5] - A[1] * A[8];
    const double c02 = A[1] * A[5] - A[2] * A[4];
    const double scale = 1.0 / (A[0] * c00 + A[1] * c01 + A[2] * c02);

    inverse[0] = scale * c00;
    inverse[1] = inverse[3] = scale * c01;
    inverse[2] = inverse[6] = scale * c02;
    inverse[4] = scale * (A[0] * A[8] - A[2] * A[2]);
    inverse[5] = inverse[7] = scale * (A[1] * A[2] - A[0] * A[5]);
    inverse[8] = scale * (A[0] * A[4] - A[1] * A[1]);
}

void wb_banded_factor(struct wb_banded *banded)
{
    for (int i = 0; i + 1 < banded->n; i++) {
        double inverse[9], W[9];
        double *restrict D = banded->diagonal[i];
        double *restrict U = banded->upper[i];
        double *restrict S = banded->diagonal[i + 1];

        /* W = S_i^-1 U_i */
        wb_banded_invert(D, inverse);
        for (int r = 0; r < 3; r++) {
            const double *row = inverse + 3 * r;
            for (int c = 0; c < 3; c++)
                W[3 * r + c] = row[0] * U[c] + row[1] * U[3 + c] + row[2] * U[6 + c];
        }
        /* S_i+1 -= U_i^T W */
        for (int r = 0; r < 3; r++) {
            for (int c = r; c < 3; c++) {
                S[3 * r + c] -= U[r] * W[c] + U[3 + r] * W[3 + c] + U[6 + r] * W[6 + c];
                S[3 * c + r] = S[3 * r + c];
            }
        }
        for (int k = 0; k < 9; k++) {
            D[k] = inverse[k];
            U[k] = W[k];
        }
    }
}

void wb_banded_reduce(const struct wb_banded *banded)
{
    for (int i = 0; i + 1 < banded->n; i++) {
        const double *restrict inverse = banded->diagonal[i];
        const double *restrict W = banded->upper[i];
        double *restrict g = banded->right[i];
        double *restrict next = banded->right[i + 1];
        double w[3];

        /* U_i^T S_i^-1 = W^T */
        for (int r = 0; r < 3; r++) {
            next[r] -= W[r] * g[0] + W[3 + r] * g[1] + W[6 + r] * g[2];
            w[r] = inverse[3 * r] * g[0] + inverse[3 * r + 1] * g[1] + inverse[3 * r + 2] * g[2];
        }
        for (int r = 0; r < 3; r++)
            g[r] = w[r];
    }
}

void wb_banded_expand(const struct wb_banded *banded)
{
    for (int i = banded->n - 2; i >= 0; i--) {
        const double *W = banded->upper[i];
        const double *d = banded->right[i + 1];
        double *g = banded->right[i];
        for (int r = 0; r < 3; r++)
            g[r] -= W[3 * r] * d[0] + W[3 * r + 1] * d[1] + W[3 * r + 2] * d[2];
    }
}

void wb_banded_solve_small(int n, int stride, double *restrict A, double *restrict b)
{
    enum {
        MOST = 8
    };
    double scale[MOST];
    int row[MOST];

    for (int i = 0; i < n; i++) {
        double largest = 0.0;
        for (int j = 0; j < n; j++)
            largest = fmax(largest, fabs(A[i * stride + j]));
        scale[i] = 1.0 / largest;
        row[i] = i;
    }
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++) {
            if (fabs(A[row[i] * stride + k]) * scale[row[i]] >
                fabs(A[row[pivot] * stride + k]) * scale[row[pivot]])
                pivot = i;
        }
        const int swap = row[k];
        row[k] = row[pivot];
        row[pivot] = swap;

        const double *P = A + row[k] * stride;
        for (int i = k + 1; i < n; i++) {
            double *Q = A + row[i] * stride;
            const double factor = Q[k] / P[k];
            for (int j = k + 1; j < n; j++)
                Q[j] -= factor * P[j];
            b[row[i]] -= factor * b[row[k]];
        }
    }

    double x[MOST];
    for (int k = n - 1; k >= 0; k--) {
        double sum = b[row[k]];
        for (int j = k + 1; j < n; j++)
            sum -= A[row[k] * stride + j] * x[j];
        x[k] = sum / A[row[k] * stride + k];
    }
    for (int k = 0; k < n; k++)
        b[k] = x[k];
}
