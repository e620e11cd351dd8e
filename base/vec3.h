/* Vectors with three components. Functions have no side effects; a result may be the same array as
 * an argument. */
#ifndef WB_BASE_VEC3_H
#define WB_BASE_VEC3_H

#include <math.h>

static inline double wb_vec3_dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double wb_vec3_length(const double *a)
{
    return sqrt(wb_vec3_dot(a, a));
}

/* out = a x b. */
static inline void wb_vec3_cross(const double *a, const double *b, double *out)
{
    const double x = a[1] * b[2] - a[2] * b[1];
    const double y = a[2] * b[0] - a[0] * b[2];
    const double z = a[0] * b[1] - a[1] * b[0];
    out[0] = x;
    out[1] = y;
    out[2] = z;
}

/* Scales to length 1 and returns the previous length; a vector of length 0 does not change. */
static inline double wb_vec3_normalise(double *a)
{
    const double length = wb_vec3_length(a);
    for (int k = 0; k < 3 && length > 0.0; k++)
        a[k] /= length;
    return length;
}

static inline double wb_vec3_distance(const double *a, const double *b)
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

/* c = A b and c = A^T b for a matrix of 3 x 3, row-major; c is another array than b. */
static inline void wb_vec3_turn(const double *A, const double *b, double *restrict c)
{
    for (int i = 0; i < 3; i++)
        c[i] = A[3 * i] * b[0] + A[3 * i + 1] * b[1] + A[3 * i + 2] * b[2];
}

static inline void wb_vec3_turn_back(const double *A, const double *b, double *restrict c)
{
    for (int i = 0; i < 3; i++)
        c[i] = A[i] * b[0] + A[3 + i] * b[1] + A[6 + i] * b[2];
}

/* C = A B A^T for matrices of 3 x 3, row-major; C is another array than B. */
static inline void wb_vec3_turn_matrix(const double *A, const double *B, double *restrict C)
{
    double AB[9];
    for (int i = 0; i < 3; i++)
        wb_vec3_turn_back(B, A + 3 * i, AB + 3 * i);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            C[3 * i + j] =
                AB[3 * i] * A[3 * j] + AB[3 * i + 1] * A[3 * j + 1] + AB[3 * i + 2] * A[3 * j + 2];
    }
}

#endif
