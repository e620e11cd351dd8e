#include "fe/linear/signature.h"

#include <math.h>

enum {
    MOST = WB_SIGNATURE_MOST
};

/* A pivot below this fraction of the diagonal is round-off. */
static const double small_pivot = 1e-12;

int wb_signature_negative(int n, int stride, const double *matrix)
{
    double A[MOST][MOST], largest[MOST];
    int negative = 0;

    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++)
            A[i][j] = 0.5 * (matrix[i * stride + j] + matrix[j * stride + i]);
        largest[i] = fabs(A[i][i]);
    }
    for (int k = 0; k < n; k++) {
        negative += A[k][k] < -small_pivot * largest[k];
        for (int i = k + 1; i < n; i++) {
            const double factor = A[i][k] / A[k][k];
            for (int j = k + 1; j < n; j++)
                A[i][j] -= factor * A[k][j];
        }
    }
    return negative;
}

bool wb_signature_is_odd(int n, int stride, const double *matrix)
{
    double A[MOST][MOST];
    bool odd = false;

    for (int i = 0; i < n; i++) {
        double largest = 0.0;
        for (int j = 0; j < n; j++)
            largest = fmax(largest, fabs(matrix[i * stride + j]));
        /* Rows are forces and moments: scale them so that pivots are comparable. */
        for (int j = 0; j < n; j++)
            A[i][j] = matrix[i * stride + j] / largest;
    }
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++) {
            if (fabs(A[i][k]) > fabs(A[pivot][k]))
                pivot = i;
        }
        for (int j = k; j < n && pivot != k; j++) {
            const double swap = A[k][j];
            A[k][j] = A[pivot][j];
            A[pivot][j] = swap;
        }
        odd ^= (A[k][k] < 0.0) ^ (pivot != k);
        for (int i = k + 1; i < n; i++) {
            const double factor = A[i][k] / A[k][k];
            for (int j = k + 1; j < n; j++)
                A[i][j] -= factor * A[k][j];
        }
    }
    return odd;
}
