#include "fe/rod/rod_element.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"
#include "fe/linear/larger.h"

enum {
    NODES = WB_ROD_ELEMENT_NODES,
    POINTS = WB_ROD_ELEMENT_POINTS,
    U = WB_ROD_ELEMENT_UNKNOWNS
};

double wb_rod_element_force_size(const double force[6], double lever)
{
    const double linear = wb_larger(wb_larger(fabs(force[0]), fabs(force[1])), fabs(force[2]));
    const double moment = wb_larger(wb_larger(fabs(force[3]), fabs(force[4])), fabs(force[5]));
    return wb_larger(linear, lever * moment);
}

void wb_rod_element_matrix(const double q[4], double R[9])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    R[0] = 1.0 - 2.0 * (y * y + z * z);
    R[1] = 2.0 * (x * y - w * z);
    R[2] = 2.0 * (x * z + w * y);
    R[3] = 2.0 * (x * y + w * z);
    R[4] = 1.0 - 2.0 * (x * x + z * z);
    R[5] = 2.0 * (y * z - w * x);
    R[6] = 2.0 * (x * z - w * y);
    R[7] = 2.0 * (y * z + w * x);
    R[8] = 1.0 - 2.0 * (x * x + y * y);
}

void wb_rod_element_compose(const double a[4], const double b[4], double c[4])
{
    double p[4];
    p[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    p[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    p[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
    p[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
    /* Round-off is the only reason for a norm other than 1, so one Newton step restores it. */
    const double scale = 1.5 - 0.5 * (p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3]);
    for (int i = 0; i < 4; i++)
        c[i] = scale * p[i];
}

void wb_rod_element_exponential(const double vector[3], double q[4])
{
    const double square = vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2];
    const double half = 0.5 * sqrt(square);
    /* sin(half) / half; the series' next term is below round-off. */
    const double ratio =
        half < 1e-3 ? 1.0 - half * half / 6.0 * (1.0 - half * half / 20.0) : sin(half) / half;
    q[0] = cos(half);
    for (int i = 0; i < 3; i++)
        q[i + 1] = 0.5 * ratio * vector[i];
}

void wb_rod_element_turn_between(const double from[4], const double to[4], double vector[3])
{
    const double back[4] = {from[0], -from[1], -from[2], -from[3]};
    double q[4];
    wb_rod_element_compose(to, back, q);
    const double sign = q[0] < 0.0 ? -1.0 : 1.0;
    const double size = wb_vec3_length(q + 1);
    /* 2 atan(size / q0) / size, with its limit. */
    const double ratio = size < 1e-9 ? 2.0 : 2.0 * atan2(size, sign * q[0]) / size;
    for (int i = 0; i < 3; i++)
        vector[i] = sign * ratio * q[i + 1];
}

void wb_rod_element_turn_axis(const double from[4], const double direction[3], double vector[3])
{
    double R[9];
    wb_rod_element_matrix(from, R);
    const double axis[3] = {R[0], R[3], R[6]};
    wb_vec3_cross(axis, direction, vector);
    const double sine = wb_vec3_length(vector), cosine = wb_vec3_dot(axis, direction);
    for (int k = 0; k < 3; k++) {
        if (sine > 1e-12)
            vector[k] *= atan2(sine, cosine) / sine;
        else
            vector[k] = cosine > 0.0 ? 0.0 : M_PI * R[3 * k + 1];
    }
}

/* The line k = a + b s through the curvatures of the points. */
static void curvature_line(const struct wb_rod_shape *shape, const struct wb_rod_strain *total,
                           double *a, double *b)
{
    const double h = shape->length, first = h * (0.5 - 0.5 / sqrt(3.0));
    for (int i = 0; i < 3; i++) {
        b[i] = (total[1].curvature[i] - total[0].curvature[i]) * sqrt(3.0) / h;
        a[i] = total[0].curvature[i] - b[i] * first;
    }
}

static void rotation_at(const double *a, const double *b, double s, const double *first,
                        double *rotation)
{
    double axb[3], p[3], q[4];
    wb_vec3_cross(a, b, axb);
    for (int i = 0; i < 3; i++)
        p[i] = s * (a[i] + s * (0.5 * b[i] + s / 12.0 * axb[i]));
    wb_rod_element_exponential(p, q);
    wb_rod_element_compose(first, q, rotation);
}

void wb_rod_element_rotation(const struct wb_rod_shape *shape, const struct wb_rod_strain *total,
                             double s, const double first[4], double rotation[4])
{
    double a[3], b[3];
    curvature_line(shape, total, a, b);
    rotation_at(a, b, s, first, rotation);
}

void wb_rod_element_place(const struct wb_rod_shape *shape, const struct wb_rod_strain *total,
                          struct wb_rod_node *nodes, struct wb_rod_point *points)
{
    const double h = shape->length;
    const double at[POINTS] = {h * (0.5 - 0.5 / sqrt(3.0)), h * (0.5 + 0.5 / sqrt(3.0))};
    double a[3], b[3], q[4];

    curvature_line(shape, total, a, b);
    for (int g = 0; g < POINTS; g++) {
        rotation_at(a, b, at[g], nodes[0].rotation, q);
        wb_rod_element_matrix(q, points[g].R);
        wb_vec3_turn(points[g].R, total[g].stretch, points[g].slope);
    }
    rotation_at(a, b, 0.5 * h, nodes[0].rotation, nodes[1].rotation);
    rotation_at(a, b, h, nodes[0].rotation, nodes[2].rotation);
    for (int i = 0; i < 3; i++) {
        const double mean = 0.5 * (points[0].slope[i] + points[1].slope[i]);
        const double rise = 0.5 * sqrt(3.0) * (points[1].slope[i] - points[0].slope[i]);
        nodes[1].position[i] = nodes[0].position[i] + 0.5 * h * (mean - 0.5 * rise);
        nodes[2].position[i] = nodes[0].position[i] + h * mean;
    }
}

void wb_rod_element_turn_forces(struct wb_rod_point *point, const double *shear)
{
    const double *force = point->section.force;
    const double N[3] = {force[0], point->shear_stiffness * shear[0],
                         point->shear_stiffness * shear[1]};
    wb_vec3_turn(point->R, N, point->n);
    wb_vec3_turn(point->R, force + 1, point->m);
}

void wb_rod_element_add_forces(const struct wb_rod_shape *shape, int g,
                               const struct wb_rod_point *p, double *restrict f)
{
    double arm[3];
    wb_vec3_cross(p->slope, p->n, arm);
    for (int i = 0; i < NODES; i++) {
        const double d = shape->weight * shape->dN[g][i], N = shape->weight * shape->N[g][i];
        for (int k = 0; k < 3; k++) {
            f[U * i + k] += d * p->n[k];
            f[U * i + 3 + k] += d * p->m[k] - N * arm[k];
        }
    }
}

/* C += sign A [b x], and C += sign [b x] A. */
static inline void add_times_skew(double *restrict C, double sign, const double *A, const double *b)
{
    for (int i = 0; i < 3; i++) {
        const double *a = A + 3 * i;
        C[3 * i] += sign * (a[1] * b[2] - a[2] * b[1]);
        C[3 * i + 1] += sign * (a[2] * b[0] - a[0] * b[2]);
        C[3 * i + 2] += sign * (a[0] * b[1] - a[1] * b[0]);
    }
}

static inline void add_skew_times(double *restrict C, double sign, const double *b, const double *A)
{
    for (int j = 0; j < 3; j++) {
        C[j] += sign * (b[1] * A[6 + j] - b[2] * A[3 + j]);
        C[3 + j] += sign * (b[2] * A[j] - b[0] * A[6 + j]);
        C[6 + j] += sign * (b[0] * A[3 + j] - b[1] * A[j]);
    }
}

static inline void add_skew(double *restrict C, double sign, const double *b)
{
    C[1] -= sign * b[2];
    C[2] += sign * b[1];
    C[3] += sign * b[2];
    C[5] -= sign * b[0];
    C[6] -= sign * b[1];
    C[7] += sign * b[0];
}

/* Derivatives of one point's (n, -r' x n, m) by (r', spin, spin'), 3 x 3 each; all moduli in
 * space. */
struct point_tangent {
    double fr[9], ft[9], fk[9];
    double ar[9], at[9], ak[9];
    double mr[9], mt[9], mk[9];
};

static void point_tangent(const struct wb_rod_point *p, struct point_tangent *k)
{
    const double(*D)[WB_ROD_SECTION_STRAINS] = p->section.tangent;
    const double GA = p->shear_stiffness;
    const double DN[9] = {D[0][0], 0.0, 0.0, 0.0, GA, 0.0, 0.0, 0.0, GA};
    const double DC[9] = {D[0][1], D[0][2], D[0][3], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    const double DM[9] = {D[1][1], D[1][2], D[1][3], D[2][1], D[2][2],
                          D[2][3], D[3][1], D[3][2], D[3][3]};
    const double *r = p->slope;

    *k = (struct point_tangent){0};
    /* dn = spin x n + Cn (dr' + r' x spin) + Cc spin' */
    wb_vec3_turn_matrix(p->R, DN, k->fr);
    wb_vec3_turn_matrix(p->R, DC, k->fk);
    add_times_skew(k->ft, 1.0, k->fr, r);
    add_skew(k->ft, -1.0, p->n);
    /* d(-r' x n) = n x dr' - r' x dn */
    add_skew(k->ar, 1.0, p->n);
    add_skew_times(k->ar, -1.0, r, k->fr);
    add_skew_times(k->at, -1.0, r, k->ft);
    add_skew_times(k->ak, -1.0, r, k->fk);
    /* dm = spin x m + Cc^T (dr' + r' x spin) + Cm spin' */
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            k->mr[3 * i + j] = k->fk[3 * j + i];
    }
    wb_vec3_turn_matrix(p->R, DM, k->mk);
    add_times_skew(k->mt, 1.0, k->mr, r);
    add_skew(k->mt, -1.0, p->m);
}

static inline void add_block(double *restrict K, const struct point_tangent *k,
                             const double functions[4])
{
    const double Ni = functions[0], dNi = functions[1], Nj = functions[2], dNj = functions[3];
    const double dd = dNi * dNj, dn = dNi * Nj, nd = Ni * dNj, nn = Ni * Nj;

    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++) {
            const int at = 3 * r + c;
            K[U * r + c] += dd * k->fr[at];
            K[U * r + 3 + c] += dn * k->ft[at] + dd * k->fk[at];
            K[U * (3 + r) + c] += nd * k->ar[at] + dd * k->mr[at];
            K[U * (3 + r) + 3 + c] +=
                nn * k->at[at] + nd * k->ak[at] + dn * k->mt[at] + dd * k->mk[at];
        }
    }
}

void wb_rod_element_stiffness(const struct wb_rod_shape *shape, const struct wb_rod_point *points,
                              struct wb_rod_element_stiffness *restrict K)
{
    memset(K, 0, sizeof *K);
    for (int g = 0; g < POINTS; g++) {
        const double *N = shape->N[g], *dN = shape->dN[g], w = shape->weight;
        struct point_tangent k;
        point_tangent(&points[g], &k);
        for (int i = 0; i < NODES; i++) {
            for (int j = 0; j < NODES; j++) {
                const double functions[4] = {w * N[i], w * dN[i], N[j], dN[j]};
                add_block(K->K[i][j], &k, functions);
            }
        }
    }
}

void wb_rod_element_strain_increment(const struct wb_rod_shape *shape, int g,
                                     const struct wb_rod_point *point, const double *d,
                                     struct wb_rod_strain *increment)
{
    double slope[3], spin[3], bend[3], sheared[3];
    for (int k = 0; k < 3; k++) {
        const double *N = shape->N[g], *dN = shape->dN[g];
        slope[k] = dN[0] * (d[k] - d[U + k]) + dN[2] * (d[2 * U + k] - d[U + k]);
        spin[k] = N[0] * d[3 + k] + N[1] * d[U + 3 + k] + N[2] * d[2 * U + 3 + k];
        bend[k] = dN[0] * (d[3 + k] - d[U + 3 + k]) + dN[2] * (d[2 * U + 3 + k] - d[U + 3 + k]);
    }
    wb_vec3_cross(point->slope, spin, sheared);
    for (int k = 0; k < 3; k++)
        sheared[k] += slope[k];
    wb_vec3_turn_back(point->R, sheared, increment->stretch);
    wb_vec3_turn_back(point->R, bend, increment->curvature);
}
