#include "fe/linear/rod_chain.h"

#include <math.h>
#include <string.h>

#include "fe/linear/signature.h"

enum {
    B = WB_ROD_CHAIN_BLOCK,
    W = WB_ROD_CHAIN_WIDTH
};

void wb_rod_chain_solve(double rows[WB_ROD_CHAIN_BLOCK][WB_ROD_CHAIN_WIDTH], int columns)
{
    const int end = B + columns;
    double scale[B];

    for (int i = 0; i < B; i++) {
        double largest = 0.0;
        for (int j = 0; j < B; j++)
            largest = fmax(largest, fabs(rows[i][j]));
        scale[i] = 1.0 / largest;
    }
    for (int k = 0; k < B; k++) {
        int pivot = k;
        for (int i = k + 1; i < B; i++) {
            if (fabs(rows[i][k]) * scale[i] > fabs(rows[pivot][k]) * scale[pivot])
                pivot = i;
        }
        if (pivot != k) {
            double swap[W];
            memcpy(swap, rows[k], sizeof swap);
            memcpy(rows[k], rows[pivot], sizeof swap);
            memcpy(rows[pivot], swap, sizeof swap);
            scale[pivot] = scale[k];
        }
        const double inverse = 1.0 / rows[k][k];
        for (int j = k + 1; j < end; j++)
            rows[k][j] *= inverse;
        for (int i = 0; i < B; i++) {
            const double factor = rows[i][k];
            if (i == k)
                continue;
            for (int j = k + 1; j < end; j++)
                rows[i][j] -= factor * rows[k][j];
        }
    }
    /* Gauss-Jordan: rows are now in the order of the unknowns. */
}

void wb_rod_chain_multiply(double *restrict c, double sign, const double *restrict a,
                           const double *restrict b)
{
    for (int i = 0; i < B; i++) {
        double sum[B] = {0};
        for (int k = 0; k < B; k++) {
            for (int j = 0; j < B; j++)
                sum[j] += a[B * i + k] * b[B * k + j];
        }
        for (int j = 0; j < B; j++)
            c[B * i + j] += sign * sum[j];
    }
}

void wb_rod_chain_apply(double *restrict c, double sign, const double *restrict a,
                        const double *restrict b)
{
    for (int i = 0; i < B; i++) {
        double sum = 0.0;
        for (int k = 0; k < B; k++)
            sum += a[B * i + k] * b[k];
        c[i] += sign * sum;
    }
}

void wb_rod_chain_condense(struct wb_rod_chain *chain)
{
    chain->negative = 0;
    for (int i = 0; i + 1 < chain->n; i++) {
        double rows[B][W] = {{0}};
        chain->negative += wb_signature_negative(B, B, chain->diagonal[i]);
        for (int r = 0; r < B; r++) {
            memcpy(rows[r], chain->diagonal[i] + B * r, B * sizeof(double));
            memcpy(rows[r] + B, chain->upper[i] + B * r, B * sizeof(double));
            rows[r][2 * B] = chain->right[i][r];
        }
        wb_rod_chain_solve(rows, B + 1);
        for (int r = 0; r < B; r++) {
            memcpy(chain->upper[i] + B * r, rows[r] + B, B * sizeof(double));
            chain->right[i][r] = rows[r][2 * B];
        }
        wb_rod_chain_multiply(chain->diagonal[i + 1], -1.0, chain->lower[i], chain->upper[i]);
        wb_rod_chain_apply(chain->right[i + 1], -1.0, chain->lower[i], chain->right[i]);
    }
}

void wb_rod_chain_expand(struct wb_rod_chain *chain)
{
    for (int i = chain->n - 2; i >= 0; i--)
        wb_rod_chain_apply(chain->right[i], -1.0, chain->upper[i], chain->right[i + 1]);
}
