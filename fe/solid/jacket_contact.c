#include "fe/solid/jacket_contact.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/vec3.h"

enum {
    NODES = 8, /* of a face */
    LOCAL = 9  /* local variables of a point: distance, two base vectors */
};

/* Serendipity functions of a face with 8 nodes, and their derivatives. */
static void shape_functions(double r, double s, double N[NODES], double dr[NODES], double ds[NODES])
{
    static const double corner[4][2] = {{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}};
    for (int k = 0; k < 4; k++) {
        const double a = corner[k][0], b = corner[k][1];
        N[k] = 0.25 * (1.0 + a * r) * (1.0 + b * s) * (a * r + b * s - 1.0);
        dr[k] = 0.25 * a * (1.0 + b * s) * (2.0 * a * r + b * s);
        ds[k] = 0.25 * b * (1.0 + a * r) * (a * r + 2.0 * b * s);
    }
    for (int k = 0; k < 2; k++) {
        const double b = k == 0 ? -1.0 : 1.0, a = -b; /* nodes 4 and 6, 5 and 7 */
        N[4 + 2 * k] = 0.5 * (1.0 - r * r) * (1.0 + b * s);
        dr[4 + 2 * k] = -r * (1.0 + b * s);
        ds[4 + 2 * k] = 0.5 * (1.0 - r * r) * b;
        N[5 + 2 * k] = 0.5 * (1.0 + a * r) * (1.0 - s * s);
        dr[5 + 2 * k] = 0.5 * a * (1.0 - s * s);
        ds[5 + 2 * k] = -s * (1.0 + a * r);
    }
}

/* --- the frame ---
 * A point has the local variables q = (g, a1, a2): g = x_outer - x_inner, and the base vectors
 * a_i = dx_inner / dr_i. Its frame is the unit vectors along
 *     v_1 = a1,   v_2 = (a1 x a2) x a1 = (a1 . a1) a2 - (a1 . a2) a1,   v_3 = a1 x a2,
 * the last one the normal out of the inner part, and its gaps are g_i = g . v_i / |v_i|.
 */
struct frame {
    double gap[3];
    double direction[3][3]; /* e_i = v_i / |v_i| */
    double length[3];       /* |v_i| */
    double slope[3][3];     /* dg_i / dv_i */
    double gradient[3][LOCAL];
};

/* Jacobians dv_i / d(a1, a2), rows by component of v_i. */
static void base_jacobian(int i, const double *a1, const double *a2, double J[3][6])
{
    const double a11 = wb_vec3_dot(a1, a1), a12 = wb_vec3_dot(a1, a2);
    memset(J, 0, 3 * sizeof J[0]);
    switch (i) {
    case 0:
        for (int c = 0; c < 3; c++)
            J[c][c] = 1.0;
        break;
    case 1:
        for (int r = 0; r < 3; r++) {
            for (int c = 0; c < 3; c++) {
                J[r][c] = 2.0 * a2[r] * a1[c] - a1[r] * a2[c] - (r == c ? a12 : 0.0);
                J[r][3 + c] = (r == c ? a11 : 0.0) - a1[r] * a1[c];
            }
        }
        break;
    default:
        for (int r = 0; r < 3; r++) {
            const int p = (r + 1) % 3, q = (r + 2) % 3; /* v_r = a1_p a2_q - a1_q a2_p */
            J[r][p] = a2[q];
            J[r][q] = -a2[p];
            J[r][3 + q] = a1[p];
            J[r][3 + p] = -a1[q];
        }
    }
}

static void frame_init(struct frame *frame, const double q[LOCAL])
{
    const double *g = q, *a1 = q + 3, *a2 = q + 6;
    double v[3][3], J[3][6];
    memcpy(v[0], a1, sizeof v[0]);
    wb_vec3_cross(a1, a2, v[2]);
    wb_vec3_cross(v[2], a1, v[1]);
    for (int i = 0; i < 3; i++) {
        double *e = frame->direction[i], *slope = frame->slope[i];
        frame->length[i] = sqrt(wb_vec3_dot(v[i], v[i]));
        for (int c = 0; c < 3; c++)
            e[c] = v[i][c] / frame->length[i];
        frame->gap[i] = wb_vec3_dot(g, e);
        for (int c = 0; c < 3; c++)
            slope[c] = (g[c] - frame->gap[i] * e[c]) / frame->length[i];

        base_jacobian(i, a1, a2, J);
        memcpy(frame->gradient[i], e, 3 * sizeof *e);
        for (int c = 0; c < 6; c++)
            frame->gradient[i][3 + c] =
                slope[0] * J[0][c] + slope[1] * J[1][c] + slope[2] * J[2][c];
    }
}

/* Adds t d2(y . v_i) / d(a1, a2)2 for a fixed vector y. */
static void add_base_curvature(int i, const double *a1, const double *a2, const double *y, double t,
                               double H[LOCAL][LOCAL])
{
    const double y1 = wb_vec3_dot(y, a1), y2 = wb_vec3_dot(y, a2);
    if (i == 1) {
        for (int r = 0; r < 3; r++) {
            for (int c = 0; c < 3; c++) {
                const double one = r == c ? 1.0 : 0.0;
                const double mixed = 2.0 * a1[r] * y[c] - y[r] * a1[c] - one * y1;
                H[3 + r][3 + c] += t * (2.0 * one * y2 - y[r] * a2[c] - a2[r] * y[c]);
                H[3 + r][6 + c] += t * mixed;
                H[6 + c][3 + r] += t * mixed;
            }
        }
    } else if (i == 2) {
        for (int r = 0; r < 3; r++) {
            const int p = (r + 1) % 3, s = (r + 2) % 3; /* y_r (a1_p a2_s - a1_s a2_p) */
            H[3 + p][6 + s] += t * y[r];
            H[6 + s][3 + p] += t * y[r];
            H[3 + s][6 + p] -= t * y[r];
            H[6 + p][3 + s] -= t * y[r];
        }
    }
}

/* Adds t d2g_i / dq2. With e, l, s of the frame, P = 1 - e e^T and J = dv / d(a1, a2):
 * d2g_i / dg dv = P / l, d2g_i / dv2 = -(s e^T + e s^T + g_i P / l) / l. */
static void add_curvature(const struct frame *frame, int i, const double q[LOCAL], double t,
                          double H[LOCAL][LOCAL])
{
    const double *e = frame->direction[i], *slope = frame->slope[i], *a1 = q + 3, *a2 = q + 6;
    const double l = frame->length[i], gap = frame->gap[i];
    double J[3][6], mixed[3][3], second[3][3], product[3][6];
    base_jacobian(i, a1, a2, J);
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++) {
            mixed[r][c] = ((r == c ? 1.0 : 0.0) - e[r] * e[c]) / l;
            second[r][c] = -(slope[r] * e[c] + e[r] * slope[c] + gap * mixed[r][c]) / l;
        }
    }
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 6; c++) {
            double sum = 0.0;
            product[r][c] = 0.0;
            for (int k = 0; k < 3; k++) {
                sum += mixed[r][k] * J[k][c];
                product[r][c] += second[r][k] * J[k][c];
            }
            H[r][3 + c] += t * sum;
            H[3 + c][r] += t * sum;
        }
    }
    for (int r = 0; r < 6; r++) {
        for (int c = 0; c < 6; c++)
            H[3 + r][3 + c] +=
                t * (J[0][r] * product[0][c] + J[1][r] * product[1][c] + J[2][r] * product[2][c]);
    }
    add_base_curvature(i, a1, a2, slope, t, H);
}

/* --- the law --- */

/* Tractions work-conjugate to the gaps (the third one is minus the pressure), and their
 * derivatives. `touching` is also true for a gap that is not finite, so that the forces become NaN
 * and the error is detected. */
struct response {
    bool touching, slipping;
    double traction[3];
    double tangent[3][3];
    double dissipated, stored; /* J/m2 */
};

static void respond(const struct wb_jacket_contact_law *law, const double gap[3],
                    const struct wb_jacket_contact_state *before,
                    struct wb_jacket_contact_state *after, struct response *response)
{
    const double kn = law->normal_stiffness, kt = law->tangential_stiffness, mu = law->friction;
    const struct wb_jacket_contact_state old = *before;
    memset(response, 0, sizeof *response);
    *after = (struct wb_jacket_contact_state){.gap = {gap[0], gap[1]}, .slip = old.slip};
    if (gap[2] > 0.0 && isfinite(gap[0] + gap[1] + gap[2]))
        return; /* open: friction is reset */

    const double pressure = -kn * gap[2], bound = mu * pressure;
    double *t = response->traction, trial[2];
    for (int i = 0; i < 2; i++)
        trial[i] = old.traction[i] + kt * (gap[i] - old.gap[i]);
    const double size = hypot(trial[0], trial[1]);
    response->touching = true;
    t[2] = -pressure;
    response->tangent[2][2] = kn;
    response->slipping = mu == 0.0 || size > bound;
    if (!response->slipping) {
        for (int i = 0; i < 2; i++) {
            t[i] = trial[i];
            response->tangent[i][i] = kt;
        }
    } else {
        /* t = mu p m with the direction m of the trial traction. */
        const double m[2] = {size > 0.0 ? trial[0] / size : 0.0,
                             size > 0.0 ? trial[1] / size : 0.0};
        const double slip = kt > 0.0 ? (size - bound) / kt : 0.0;
        const double side = size > 0.0 ? kt * bound / size : 0.0;
        for (int i = 0; i < 2; i++) {
            t[i] = bound * m[i];
            for (int j = 0; j < 2; j++)
                response->tangent[i][j] = side * ((i == j ? 1.0 : 0.0) - m[i] * m[j]);
            response->tangent[i][2] = -mu * kn * m[i];
        }
        response->dissipated = bound * slip;
        after->slip += slip;
    }
    after->traction[0] = t[0];
    after->traction[1] = t[1];
    response->stored = 0.5 * kn * gap[2] * gap[2];
    if (kt > 0.0)
        response->stored += 0.5 * (t[0] * t[0] + t[1] * t[1]) / kt;
}

/* --- the faces --- */

struct point {
    double N[NODES], dr[NODES], ds[NODES];
    double weight; /* m2, of the reference */
};

static void point_init(struct point *point, int number, const double X[2 * NODES][3])
{
    static const double place[3] = {-0.77459666924148337704, 0.0, 0.77459666924148337704};
    static const double weight[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
    const int i = number % 3, j = number / 3;
    double A1[3] = {0.0}, A2[3] = {0.0}, normal[3];
    shape_functions(place[i], place[j], point->N, point->dr, point->ds);
    for (int k = 0; k < NODES; k++) {
        for (int c = 0; c < 3; c++) {
            A1[c] += point->dr[k] * X[k][c];
            A2[c] += point->ds[k] * X[k][c];
        }
    }
    wb_vec3_cross(A1, A2, normal);
    point->weight = weight[i] * weight[j] * sqrt(wb_vec3_dot(normal, normal));
}

/* The distance is computed from displacements only, so that coinciding faces have distance zero
 * exactly. */
static void local_variables(const struct point *point, const double X[2 * NODES][3],
                            const double *u, double q[LOCAL])
{
    memset(q, 0, LOCAL * sizeof *q);
    for (int k = 0; k < NODES; k++) {
        for (int c = 0; c < 3; c++) {
            const double x = X[k][c] + u[3 * k + c];
            q[c] += point->N[k] * (u[3 * (NODES + k) + c] - u[3 * k + c]);
            q[3 + c] += point->dr[k] * x;
            q[6 + c] += point->ds[k] * x;
        }
    }
}

static void add_force(const struct point *point, const double slope[LOCAL], double *restrict force)
{
    for (int k = 0; k < NODES; k++) {
        for (int c = 0; c < 3; c++) {
            force[3 * k + c] +=
                point->dr[k] * slope[3 + c] + point->ds[k] * slope[6 + c] - point->N[k] * slope[c];
            force[3 * (NODES + k) + c] += point->N[k] * slope[c];
        }
    }
}

/* tangent += B^T H B with q = B u. */
static void add_tangent(const struct point *point, double H[LOCAL][LOCAL], double *restrict tangent)
{
    enum {
        ALL = WB_JACKET_CONTACT_UNKNOWNS,
        HALF = 3 * NODES
    };
    double HB[LOCAL][ALL];
    for (int r = 0; r < LOCAL; r++) {
        for (int k = 0; k < NODES; k++) {
            for (int c = 0; c < 3; c++) {
                const double outer = point->N[k] * H[r][c];
                HB[r][HALF + 3 * k + c] = outer;
                HB[r][3 * k + c] = point->dr[k] * H[r][3 + c] + point->ds[k] * H[r][6 + c] - outer;
            }
        }
    }
    for (int k = 0; k < NODES; k++) {
        const double N = point->N[k], dr = point->dr[k], ds = point->ds[k];
        for (int c = 0; c < 3; c++) {
            double *restrict inner = tangent + ALL * (3 * k + c);
            double *restrict outer = tangent + ALL * (HALF + 3 * k + c);
            const double *restrict g = HB[c], *restrict a1 = HB[3 + c], *restrict a2 = HB[6 + c];
            for (int j = 0; j < ALL; j++) {
                inner[j] += dr * a1[j] + ds * a2[j] - N * g[j];
                outer[j] += N * g[j];
            }
        }
    }
}

/* H = sum_ij grad g_i D_ij grad g_j + sum_i t_i d2g_i, times the point's weight. */
static void local_tangent(const struct frame *frame, const struct response *response,
                          const double q[LOCAL], double weight, double H[LOCAL][LOCAL])
{
    memset(H, 0, LOCAL * sizeof H[0]);
    for (int i = 0; i < 3; i++) {
        double row[LOCAL] = {0.0};
        for (int j = 0; j < 3; j++) {
            const double D = weight * response->tangent[i][j];
            for (int c = 0; c < LOCAL; c++)
                row[c] += D * frame->gradient[j][c];
        }
        for (int r = 0; r < LOCAL; r++) {
            for (int c = 0; c < LOCAL; c++)
                H[r][c] += frame->gradient[i][r] * row[c];
        }
        add_curvature(frame, i, q, weight * response->traction[i], H);
    }
}

static void keep_largest(double *largest, double value)
{
    if (!(value <= *largest) && !isnan(*largest))
        *largest = value;
}

static void collect(struct wb_jacket_contact_result *result, const struct frame *frame,
                    const struct response *response, double slip, double weight)
{
    keep_largest(&result->slip, slip);
    keep_largest(&result->sliding, hypot(frame->gap[0], frame->gap[1]));
    if (!response->touching) {
        keep_largest(&result->opening, frame->gap[2]);
        return;
    }
    keep_largest(&result->penetration, -frame->gap[2]);
    keep_largest(&result->pressure, -response->traction[2]);
    result->dissipated += weight * response->dissipated;
    result->stored += weight * response->stored;
    result->touching++;
    result->slipping += response->slipping;
}

void wb_jacket_contact_evaluate(
    const struct wb_jacket_contact_law *law, const double X[16][3], const double *restrict u,
    const struct wb_jacket_contact_state before[WB_JACKET_CONTACT_POINTS],
    struct wb_jacket_contact_state after[WB_JACKET_CONTACT_POINTS], double *restrict force,
    double *restrict tangent, struct wb_jacket_contact_result *result)
{
    memset(force, 0, WB_JACKET_CONTACT_UNKNOWNS * sizeof *force);
    if (tangent)
        memset(tangent, 0,
               WB_JACKET_CONTACT_UNKNOWNS * WB_JACKET_CONTACT_UNKNOWNS * sizeof *tangent);
    *result = (struct wb_jacket_contact_result){0};

    for (int p = 0; p < WB_JACKET_CONTACT_POINTS; p++) {
        struct point point;
        struct frame frame;
        struct response response;
        double q[LOCAL], slope[LOCAL], H[LOCAL][LOCAL];
        point_init(&point, p, X);
        local_variables(&point, X, u, q);
        frame_init(&frame, q);
        respond(law, frame.gap, &before[p], &after[p], &response);
        collect(result, &frame, &response, after[p].slip, point.weight);
        if (!response.touching)
            continue;

        for (int c = 0; c < LOCAL; c++)
            slope[c] = point.weight * (response.traction[0] * frame.gradient[0][c] +
                                       response.traction[1] * frame.gradient[1][c] +
                                       response.traction[2] * frame.gradient[2][c]);
        add_force(&point, slope, force);
        if (tangent) {
            local_tangent(&frame, &response, q, point.weight, H);
            add_tangent(&point, H, tangent);
        }
    }
}
