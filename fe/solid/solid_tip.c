#include "fe/solid/solid_tip.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fe/solid/hex20.h"

enum {
    N = WB_SOLID_TIP_UNKNOWNS
};

/* Integrals over all end faces. */
struct sums {
    double one, yy, zz; /* of E, E y^2, E z^2 */
};

static void find_nodes(struct wb_solid_tip_section *tip, const struct wb_solid_mesh *mesh,
                       int *place)
{
    for (int i = 0; i < mesh->n_nodes; i++)
        place[i] = -1;
    for (int f = 0; f < mesh->n_tip_faces; f++)
        for (int k = 0; k < WB_SOLID_MESH_FACE; k++) {
            const int node = mesh->tip_face[f].node[k];
            if (place[node] < 0)
                place[node] = tip->n_nodes++;
        }
    tip->node = wb_memory_new((size_t)tip->n_nodes, sizeof *tip->node);
    tip->pattern = wb_memory_new((size_t)tip->n_nodes, sizeof *tip->pattern);
    for (int i = 0; i < mesh->n_nodes; i++)
        if (place[i] >= 0)
            tip->node[place[i]] = i;
}

static void add_faces(struct wb_solid_tip_section *tip, const struct wb_solid_mesh *mesh,
                      const struct wb_solid_part *parts, const int *place)
{
    struct sums sums = {0};

    for (int f = 0; f < mesh->n_tip_faces; f++) {
        const struct wb_solid_face *face = &mesh->tip_face[f];
        const double E = parts[mesh->part[face->element]].material.youngs_modulus;
        struct wb_hex20_face integrals;
        double position[WB_SOLID_MESH_FACE][3];

        for (int k = 0; k < WB_SOLID_MESH_FACE; k++)
            memcpy(position[k], mesh->node[face->node[k]], sizeof position[k]);
        wb_hex20_face_integrals((const double(*)[3])position, &integrals);
        for (int k = 0; k < WB_SOLID_MESH_FACE; k++) {
            double *pattern = tip->pattern[place[face->node[k]]];
            pattern[0] += E * integrals.one[k];
            pattern[1] += E * integrals.y[k];
            pattern[2] += E * integrals.z[k];
        }
        sums.one += E * integrals.area;
        sums.yy += E * integrals.yy;
        sums.zz += E * integrals.zz;
    }
    for (int a = 0; a < tip->n_nodes; a++) {
        tip->pattern[a][0] /= sums.one;
        tip->pattern[a][1] /= sums.yy;
        tip->pattern[a][2] /= sums.zz;
    }
    tip->radius = sqrt((sums.yy + sums.zz) / sums.one);
}

void wb_solid_tip_init(struct wb_solid_tip_section *tip, const struct wb_solid_mesh *mesh,
                       const struct wb_solid_part *parts)
{
    *tip = (struct wb_solid_tip_section){0};
    if (mesh->n_tip_faces == 0)
        return;

    int *const place = wb_memory_new((size_t)mesh->n_nodes, sizeof *place);
    find_nodes(tip, mesh, place);
    add_faces(tip, mesh, parts, place);
    free(place);
}

void wb_solid_tip_release(struct wb_solid_tip_section *tip)
{
    free(tip->node);
    free(tip->pattern);
    *tip = (struct wb_solid_tip_section){0};
}

void wb_solid_tip_motion(const struct wb_solid_tip_section *tip, const struct wb_solid_mesh *mesh,
                         const double *u, double z[WB_SOLID_TIP_UNKNOWNS])
{
    for (int i = 0; i < N; i++)
        z[i] = 0.0;
    for (int a = 0; a < tip->n_nodes; a++) {
        const int node = tip->node[a];
        for (int i = 0; i < 3; i++) {
            const double x = mesh->node[node][i] + u[3 * node + i];
            for (int k = 0; k < WB_SOLID_TIP_PATTERNS; k++)
                z[3 * k + i] += tip->pattern[a][k] * x;
        }
    }
}

void wb_solid_tip_frame(const double z[WB_SOLID_TIP_UNKNOWNS], double frame[3][3])
{
    const double *y = z + 3;
    double normal[3];

    wb_vec3_cross(y, z + 6, normal);
    const double size = wb_vec3_length(normal), length = wb_vec3_length(y);
    for (int i = 0; i < 3; i++) {
        frame[0][i] = normal[i] / size;
        frame[1][i] = y[i] / length;
    }
    wb_vec3_cross(frame[0], frame[1], frame[2]);
}

/* Complex numbers for complex-step differentiation: an imaginary step in z gives the derivative
 * without cancellation. */
typedef double complex number;

/* CMPLX() of C11, which clang lacks with this C library. */
static number with_step(double real, double imaginary)
{
    const union {
        double part[2];
        number value;
    } both = {.part = {real, imaginary}};
    return both.value;
}

static number inner(const number *a, const number *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const number *a, const number *b, number *c)
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static void turn_with_frame(const number *z, const double follower[3], number *phi)
{
    const number *gy = z + 3, *gz = z + 6;
    number normal[3], along[3], across[3], third[3];

    cross(gy, gz, normal);
    const number size = csqrt(inner(normal, normal)), length = csqrt(inner(gy, gy));
    for (int i = 0; i < 3; i++) {
        along[i] = normal[i] / size;
        across[i] = gy[i] / length;
    }
    cross(along, across, third);
    for (int i = 0; i < 3; i++)
        phi[i] += follower[0] * along[i] + follower[1] * across[i] + follower[2] * third[i];
}

/* Solves T m = moment by Cramer's rule; T is positive definite. */
static void turn_by_moment(const number *z, const double moment[3], number *phi)
{
    const number *gy = z + 3, *gz = z + 6;
    const number square = inner(gy, gy) + inner(gz, gz);
    number column[3][3], m[3], minor[3];

    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3; i++)
            column[j][i] = (i == j ? square : 0.0) - gy[i] * gy[j] - gz[i] * gz[j];
    cross(column[1], column[2], minor);
    const number determinant = inner(column[0], minor);
    for (int k = 0; k < 3; k++) {
        const number right[3] = {moment[0], moment[1], moment[2]};
        cross(column[(k + 1) % 3], column[(k + 2) % 3], minor);
        m[k] = inner(right, minor) / determinant;
    }
    number couple[3];
    cross(m, gy, couple);
    for (int i = 0; i < 3; i++)
        phi[3 + i] += couple[i];
    cross(m, gz, couple);
    for (int i = 0; i < 3; i++)
        phi[6 + i] += couple[i];
}

static void pull(const number *z, const struct wb_solid_tip_strand *strand, number tension,
                 number *phi)
{
    if (strand->length == 0.0) {
        phi[1] += tension;
        return;
    }
    const number x = (strand->x - z[0]) / strand->length, w = -z[2] / strand->length;
    const number up = 1.0 - x * x - w * w;
    phi[0] += tension * x;
    phi[1] +=
        creal(up) > 0.0 ? tension * csqrt(up) : (double)NAN; /* the strand cannot reach the tip */
    phi[2] += tension * w;
}

static void sum_forces(const number *z, const struct wb_tip_loads *loads,
                       const struct wb_solid_tip_strand *strand, double tension, number *phi)
{
    for (int i = 0; i < N; i++)
        phi[i] = i < 3 ? loads->force[i] : 0.0;
    turn_with_frame(z, loads->follower, phi);
    turn_by_moment(z, loads->moment, phi);
    pull(z, strand, tension, phi);
}

void wb_solid_tip_forces(const double z[WB_SOLID_TIP_UNKNOWNS], const struct wb_tip_loads *loads,
                         const struct wb_solid_tip_strand *strand, double tension,
                         double phi[WB_SOLID_TIP_UNKNOWNS], double *derivative)
{
    const double step = 1e-30;
    number at[N], value[N];

    for (int i = 0; i < N; i++)
        at[i] = z[i];
    sum_forces(at, loads, strand, tension, value);
    for (int i = 0; i < N; i++)
        phi[i] = creal(value[i]);
    for (int j = 0; derivative && j < N; j++) {
        at[j] = with_step(z[j], step);
        sum_forces(at, loads, strand, tension, value);
        at[j] = z[j];
        for (int i = 0; i < N; i++)
            derivative[N * i + j] = cimag(value[i]) / step;
    }
}

void wb_solid_tip_tension(const double z[WB_SOLID_TIP_UNKNOWNS],
                          const struct wb_solid_tip_strand *strand,
                          double direction[WB_SOLID_TIP_UNKNOWNS])
{
    number at[N], value[N] = {0};

    for (int i = 0; i < N; i++)
        at[i] = z[i];
    pull(at, strand, 1.0, value);
    for (int i = 0; i < N; i++)
        direction[i] = creal(value[i]);
}
