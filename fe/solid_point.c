#include "fe/solid_point.h"

#include <math.h>
#include <string.h>

#include "fe/hardening.h"

/* Place of component ij among the six. */
static const int place[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
static const int row_of[6] = {0, 1, 2, 0, 1, 2};
static const int column_of[6] = {0, 1, 2, 1, 2, 0};

/* See fe/material.c. */
static const double on_surface = 1e-12;

/* Three vectors, in the rows. */
struct basis {
    double row[3][3];
};

/* C = sum (1 + excess_i) N_i N_i. */
struct spectrum {
    double excess[3];
    struct basis vectors; /* N_i */
    double stretch[3];    /* lambda_i */
    double log_strain[3]; /* ln lambda_i */
};

/* A step of plastic flow: T = trial - 2 mu sqrt(3/2) increment n, and its tangent
 * 2 mu (shrink Idev - along n n). */
struct flow {
    double direction[6]; /* n, of unit norm */
    double increment;    /* of the equivalent plastic strain */
    double shrink, along;
    double dissipated; /* J/m3 */
};

void wb_solid_point_law_init(struct wb_solid_point_law *law, const struct wb_material *material)
{
    const double E = material->youngs_modulus, nu = material->poissons_ratio;

    law->shear_modulus = E / (2.0 * (1.0 + nu));
    law->bulk_modulus = E / (3.0 * (1.0 - 2.0 * nu));
    law->radial = *material;
    law->radial.youngs_modulus = 3.0 * law->shear_modulus;
}

bool wb_solid_point_motion_init(struct wb_solid_point_motion *motion, const double gradient[9])
{
    double(*h)[3] = motion->gradient;
    double f[3][3], cofactor[3][3];

    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            h[i][j] = gradient[3 * i + j];
            f[i][j] = h[i][j] + (i == j);
        }
    }
    for (int i = 0; i < 3; i++) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (int j = 0; j < 3; j++) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            cofactor[i][j] = f[i1][j1] * f[i2][j2] - f[i1][j2] * f[i2][j1];
        }
    }

    /* J - 1 from the invariants of H, so that small strains keep their digits. */
    const double first = h[0][0] + h[1][1] + h[2][2];
    const double second = (h[0][0] * h[1][1] - h[0][1] * h[1][0]) +
                          (h[1][1] * h[2][2] - h[1][2] * h[2][1]) +
                          (h[2][2] * h[0][0] - h[2][0] * h[0][2]);
    const double third = h[0][0] * (h[1][1] * h[2][2] - h[1][2] * h[2][1]) +
                         h[0][1] * (h[1][2] * h[2][0] - h[1][0] * h[2][2]) +
                         h[0][2] * (h[1][0] * h[2][1] - h[1][1] * h[2][0]);
    const double excess = first + second + third;
    motion->jacobian = 1.0 + excess;
    if (!(motion->jacobian > 0.0) || !isfinite(motion->jacobian))
        return false;

    motion->log_jacobian = log1p(excess);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            motion->inverse[j][i] = cofactor[i][j] / motion->jacobian;
    }
    return true;
}

void wb_solid_point_volumetric(const struct wb_solid_point_law *law,
                               const struct wb_solid_point_motion *motion, bool tangent,
                               struct wb_solid_point_response *response)
{
    const double kappa = law->bulk_modulus;
    const double pressure = kappa * motion->log_jacobian;

    memset(response, 0, sizeof *response);
    response->energy = 0.5 * pressure * motion->log_jacobian;
    for (int a = 0; a < 3; a++)
        response->stress[a] = pressure;
    if (!tangent)
        return;
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++)
            response->tangent[a][b] = kappa;
        response->tangent[a][a] -= 2.0 * pressure;
        response->tangent[3 + a][3 + a] = -pressure;
    }
}

/* One rotation of Jacobi's method, which makes a[p][q] vanish; r is the third index. */
static void rotate(double a[3][3], double v[3][3], int p, int q)
{
    const int r = 3 - p - q;
    const double x = a[p][q];
    if (fabs(x) < 1e-150) {
        a[p][q] = 0.0;
        return;
    }

    const double gap = a[q][q] - a[p][p];
    const double root = sqrt(gap * gap + 4.0 * x * x);
    const double t = 2.0 * x / (gap < 0.0 ? gap - root : gap + root);
    const double c = 1.0 / sqrt(1.0 + t * t), s = t * c;
    double *rp = r < p ? &a[r][p] : &a[p][r];
    double *rq = r < q ? &a[r][q] : &a[q][r];
    const double old_p = *rp, old_q = *rq;

    a[p][p] -= t * x;
    a[q][q] += t * x;
    a[p][q] = 0.0;
    *rp = c * old_p - s * old_q;
    *rq = s * old_p + c * old_q;
    for (int k = 0; k < 3; k++) {
        const double vp = v[p][k], vq = v[q][k];
        v[p][k] = c * vp - s * vq;
        v[q][k] = s * vp + c * vq;
    }
}

/* Eigenvalues on the diagonal of a (its upper triangle is used), eigenvectors in the rows of v. */
static void diagonalise(double a[3][3], double v[3][3])
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            v[i][j] = i == j;
    }
    for (int sweep = 0; sweep < 12; sweep++) {
        const double off = fabs(a[0][1]) + fabs(a[0][2]) + fabs(a[1][2]);
        const double size = fabs(a[0][0]) + fabs(a[1][1]) + fabs(a[2][2]);
        if (!(off > 1e-18 * size))
            break;
        rotate(a, v, 0, 1);
        rotate(a, v, 0, 2);
        rotate(a, v, 1, 2);
    }
}

static void find_spectrum(const struct wb_solid_point_motion *motion, struct spectrum *s)
{
    const double *h[3] = {motion->gradient[0], motion->gradient[1], motion->gradient[2]};
    double a[3][3];

    for (int i = 0; i < 3; i++) {
        for (int j = i; j < 3; j++) {
            const double product = h[0][i] * h[0][j] + h[1][i] * h[1][j] + h[2][i] * h[2][j];
            a[i][j] = h[i][j] + h[j][i] + product;
        }
    }
    diagonalise(a, s->vectors.row);
    for (int i = 0; i < 3; i++) {
        s->excess[i] = a[i][i];
        s->stretch[i] = sqrt(1.0 + a[i][i]);
        s->log_strain[i] = 0.5 * log1p(a[i][i]);
    }
}

/* Components of t in a basis: out_ij = r_i . t r_j. */
static void into_basis(const double t[6], const struct basis *basis, double out[6])
{
    const double *r[3] = {basis->row[0], basis->row[1], basis->row[2]};
    double half[3][3]; /* t r_j in row j */

    for (int j = 0; j < 3; j++) {
        for (int k = 0; k < 3; k++) {
            half[j][k] =
                t[place[k][0]] * r[j][0] + t[place[k][1]] * r[j][1] + t[place[k][2]] * r[j][2];
        }
    }
    for (int a = 0; a < 6; a++) {
        const double *x = r[row_of[a]], *y = half[column_of[a]];
        out[a] = x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
    }
}

/* The tensor with components t in a basis: out = sum t_ij r_i r_j. */
static void out_of_basis(const double t[6], const struct basis *basis, double out[6])
{
    struct basis transposed;

    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            transposed.row[i][j] = basis->row[j][i];
    }
    into_basis(t, &transposed, out);
}

static double squared_norm(const double t[6])
{
    return t[0] * t[0] + t[1] * t[1] + t[2] * t[2] +
           2.0 * (t[3] * t[3] + t[4] * t[4] + t[5] * t[5]);
}

/* From the trial value of T - X. False while elastic. */
static bool find_flow(const struct wb_solid_point_law *law, const double trial[6],
                      double accumulated, struct flow *flow)
{
    const struct wb_material *m = &law->radial;
    if (m->hardening == WB_HARDENING_NONE_ELASTIC)
        return false;

    const double three_mu = m->youngs_modulus, K = m->strength_coefficient;
    const bool isotropic = m->hardening == WB_HARDENING_ISOTROPIC_POWER;
    const double norm = sqrt(squared_norm(trial));
    const double q = sqrt(1.5) * norm, p0 = accumulated;
    double yield = m->yield_stress;
    if (isotropic && p0 > 0.0)
        yield += K * pow(p0, m->hardening_exponent);
    if (!(q - yield > on_surface * yield))
        return false;

    double slope; /* 3 mu / (3 mu + hardening modulus) */
    if (isotropic) {
        const double c = q - m->yield_stress + three_mu * p0;
        const double n = m->hardening_exponent;
        const double r = wb_hardening_ratio(m, c);
        flow->increment = fmax(0.0, r * c / three_mu - p0);
        flow->dissipated = (m->yield_stress + (1.0 - r) * c) * flow->increment;
        slope = r / (r + n * (1.0 - r));
    } else {
        flow->increment = (q - yield) / (three_mu + K);
        flow->dissipated = yield * flow->increment;
        slope = three_mu / (three_mu + K);
    }
    const double lost = three_mu * flow->increment / q;
    flow->shrink = 1.0 - lost;
    flow->along = slope - lost;
    for (int a = 0; a < 6; a++)
        flow->direction[a] = trial[a] / norm;
    return true;
}

/* y / sinh y. */
static double over_sinh(double y)
{
    const double z = y * y;
    if (z > 0.25)
        return y / sinh(y);
    const double tail = 1.0 + z / 156.0 * (1.0 + z / 210.0);
    const double half = 1.0 + z / 42.0 * (1.0 + z / 72.0 * (1.0 + z / 110.0 * tail));
    return 1.0 / (1.0 + z / 6.0 * (1.0 + z / 20.0 * half));
}

/* Divided difference (ln(1 + b) - ln(1 + a)) / (b - a). */
static double log_difference(double a, double b)
{
    const double x = (b - a) / (1.0 + a);
    return (x == 0.0 ? 1.0 : log1p(x) / x) / (1.0 + a);
}

/* Second divided difference of ln at 1 + a, 1 + b, 1 + c. For close arguments by the power series
 * about their mean, whose terms are the complete homogeneous symmetric polynomials. */
static double log_difference2(double a, double b, double c)
{
    const double mean = (a + b + c) / 3.0, scale = 1.0 / (1.0 + mean);
    const double x = (a - mean) * scale, y = (b - mean) * scale, z = (c - mean) * scale;

    if (fabs(x) + fabs(y) + fabs(z) < 0.1) {
        const double e2 = x * y + y * z + z * x, e3 = x * y * z;
        double h[11] = {1.0, 0.0, -e2};
        double sum = -1.0 / 2.0 + e2 / 4.0;
        for (int k = 3; k < 11; k++) {
            h[k] = e3 * h[k - 3] - e2 * h[k - 2];
            sum += (k % 2 == 0 ? -1.0 : 1.0) / (k + 2) * h[k];
        }
        return sum * scale * scale;
    }
    const double low = fmin(a, fmin(b, c)), high = fmax(a, fmax(b, c));
    const double middle = fmax(fmin(a, b), fmin(fmax(a, b), c));
    return (log_difference(middle, high) - log_difference(low, middle)) / (high - low);
}

/* Adds sum_ijk T_ij G_ikj (d_ik d_kj + d_ik d_kj), G_ikj = 2 f3[c_i, c_k, c_j] l_i l_k^2 l_j with
 * f3 the second divided difference of ln: the curvature of E(C). */
static void add_curvature(const struct spectrum *s, const double T[6], double c[6][6])
{
    const double *e = s->excess, *l = s->stretch;
    const double all = log_difference2(e[0], e[1], e[2]);
    double twice[3][3]; /* f3[c_i, c_i, c_k] */

    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            twice[i][k] = log_difference2(e[i], e[i], e[k]);
    }
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            const int a = place[i][k];
            const double weight = i == k ? 1.0 : 0.25;
            c[a][a] += 4.0 * weight * T[i] * twice[i][k] * l[i] * l[i] * l[k] * l[k];
        }
        const int j = (i + 1) % 3;
        for (int k = 0; k < 3; k++) {
            const int a = place[i][k], b = place[k][j];
            const double f3 = k == i ? twice[i][j] : k == j ? twice[j][i] : all;
            const double weight = k == i || k == j ? 0.5 : 0.25;
            const double value = 4.0 * weight * T[place[i][j]] * f3 * l[i] * l[k] * l[k] * l[j];
            c[a][b] += value;
            c[b][a] += value;
        }
    }
}

/* c in the eigenvectors: (theta d):D:(theta d) and the curvature; D of the return mapping. */
static void find_tangent(const struct wb_solid_point_law *law, const struct spectrum *s,
                         const double theta[6], const double T[6], const struct flow *flow,
                         double c[6][6])
{
    const double two_mu = 2.0 * law->shear_modulus;
    const double isotropic = two_mu * (flow ? flow->shrink : 1.0);

    memset(c, 0, 36 * sizeof c[0][0]);
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++)
            c[a][b] = isotropic * ((a == b) - 1.0 / 3.0);
        c[3 + a][3 + a] = 0.5 * isotropic * theta[3 + a] * theta[3 + a];
    }
    if (flow) {
        for (int a = 0; a < 6; a++) {
            const double factor = two_mu * flow->along * flow->direction[a] * theta[a];
            for (int b = 0; b < 6; b++)
                c[a][b] -= factor * (flow->direction[b] * theta[b]);
        }
    }
    add_curvature(s, T, c);
}

/* out = M c M^T, where M takes the components of a stress in the basis n (rows) to the frame's. */
static void rotate_tangent(double c[6][6], const struct basis *basis, double out[6][6])
{
    const double *n[3] = {basis->row[0], basis->row[1], basis->row[2]};
    double M[6][6], half[6][6];

    for (int a = 0; a < 6; a++) {
        const int p = row_of[a], q = column_of[a];
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3;
            M[a][i] = n[i][p] * n[i][q];
            M[a][3 + i] = n[i][p] * n[j][q] + n[j][p] * n[i][q];
        }
    }
    for (int a = 0; a < 6; a++) {
        for (int b = 0; b < 6; b++) {
            double sum = 0.0;
            for (int k = 0; k < 6; k++)
                sum += M[a][k] * c[k][b];
            half[a][b] = sum;
        }
    }
    for (int a = 0; a < 6; a++) {
        for (int b = a; b < 6; b++) {
            double sum = 0.0;
            for (int k = 0; k < 6; k++)
                sum += half[a][k] * M[b][k];
            out[a][b] = out[b][a] = sum;
        }
    }
}

/* n_i = F N_i / lambda_i. */
static void push_vectors(const struct wb_solid_point_motion *motion, const struct spectrum *s,
                         struct basis *n)
{
    for (int i = 0; i < 3; i++) {
        const double *N = s->vectors.row[i];
        for (int k = 0; k < 3; k++) {
            const double *h = motion->gradient[k];
            n->row[i][k] = (N[k] + (h[0] * N[0] + h[1] * N[1] + h[2] * N[2])) / s->stretch[i];
        }
    }
}

void wb_solid_point_deviatoric(const struct wb_solid_point_law *law,
                               const struct wb_solid_point_motion *motion,
                               const struct wb_hex20_state *before, struct wb_hex20_state *after,
                               bool tangent, struct wb_solid_point_response *response)
{
    const double mu = law->shear_modulus;
    const bool kinematic = law->radial.hardening == WB_HARDENING_KINEMATIC_LINEAR;
    const double prager = kinematic ? 2.0 / 3.0 * law->radial.strength_coefficient : 0.0;
    struct spectrum s;
    struct flow flow;
    double plastic[6], T[6], relative[6], tau[6];

    find_spectrum(motion, &s);
    into_basis(before->plastic_strain, &s.vectors, plastic);
    *after = *before;

    const double mean = (s.log_strain[0] + s.log_strain[1] + s.log_strain[2]) / 3.0;
    for (int a = 0; a < 6; a++) {
        const double total = a < 3 ? s.log_strain[a] - mean : 0.0;
        T[a] = 2.0 * mu * (total - plastic[a]);
        relative[a] = T[a] - prager * plastic[a];
    }
    const bool yields = find_flow(law, relative, before->accumulated, &flow);
    if (yields) {
        double step[6], turned[6];
        for (int a = 0; a < 6; a++) {
            step[a] = sqrt(1.5) * flow.increment * flow.direction[a];
            T[a] -= 2.0 * mu * step[a];
        }
        out_of_basis(step, &s.vectors, turned);
        for (int a = 0; a < 6; a++)
            after->plastic_strain[a] += turned[a];
        after->accumulated += flow.increment;
    }
    response->yields = yields;
    response->dissipated = yields ? flow.dissipated : 0.0;
    response->energy =
        squared_norm(T) / (4.0 * mu) + 0.5 * prager * squared_norm(after->plastic_strain);

    double theta[6] = {1.0, 1.0, 1.0};
    struct basis n;
    for (int i = 0; i < 3; i++)
        theta[3 + i] = over_sinh(s.log_strain[i] - s.log_strain[(i + 1) % 3]);
    for (int a = 0; a < 6; a++)
        tau[a] = theta[a] * T[a];
    push_vectors(motion, &s, &n);
    out_of_basis(tau, &n, response->stress);
    if (tangent) {
        double c[6][6];
        find_tangent(law, &s, theta, T, yields ? &flow : NULL, c);
        rotate_tangent(c, &n, response->tangent);
    }
}
