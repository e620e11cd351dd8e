#include "fe/solid/solid_point.h"

#include <math.h>
#include <string.h>

#include "fe/material/hardening.h"

/* Index of component ij among the six. */
static const int place[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
static const int row_of[6] = {0, 1, 2, 0, 1, 2};
static const int column_of[6] = {0, 1, 2, 1, 2, 0};

/* Relative distance to the yield surface below which a point counts as elastic: a point that was
 * returned to the surface and did not move since must not see the plastic tangent by round-off. */
static const double on_surface = 1e-12;

/* Result of a return mapping: T = trial - 2 mu sqrt(3/2) increment n, and its tangent 2 mu (shrink
 * Idev - along n n). */
struct flow {
    double direction[6]; /* n, of unit norm */
    double increment;    /* of the equivalent plastic strain */
    double shrink, along;
    double dissipated; /* J/m3 */
};

double wb_solid_point_cofactors(const double matrix[3][3], double cofactor[3][3])
{
    for (int i = 0; i < 3; i++) {
        const double *u = matrix[(i + 1) % 3], *v = matrix[(i + 2) % 3];
        for (int j = 0; j < 3; j++) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            cofactor[i][j] = u[j1] * v[j2] - u[j2] * v[j1];
        }
    }
    return matrix[0][0] * cofactor[0][0] + matrix[0][1] * cofactor[0][1] +
           matrix[0][2] * cofactor[0][2];
}

void wb_solid_point_law_init(struct wb_solid_point_law *law, const struct wb_material *material)
{
    const double E = material->youngs_modulus, nu = material->poissons_ratio;

    law->shear_modulus = wb_material_shear_modulus(material);
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
    wb_solid_point_cofactors((const double(*)[3])f, cofactor);

    /* J - 1 from the invariants of H, which keeps the digits of small strains. */
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

void wb_solid_point_add_volumetric(const struct wb_solid_point_law *law,
                                   const struct wb_solid_point_motion *motion, bool tangent,
                                   struct wb_solid_point_response *response)
{
    const double kappa = law->bulk_modulus;
    const double pressure = kappa * motion->log_jacobian;

    response->energy += 0.5 * pressure * motion->log_jacobian;
    for (int a = 0; a < 3; a++)
        response->stress[a] += pressure;
    if (!tangent)
        return;
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++)
            response->tangent[a][b] += kappa;
        response->tangent[a][a] -= 2.0 * pressure;
        response->tangent[3 + a][3 + a] -= pressure;
    }
}

/* Components of t in a basis: out_ij = r_i . t r_j. */
static void into_basis(const double t[6], const struct wb_solid_point_basis *basis, double out[6])
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
static void out_of_basis(const double t[6], const struct wb_solid_point_basis *basis, double out[6])
{
    struct wb_solid_point_basis transposed;

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

/* The equivalent plastic strain increment from p0, which solves q - 3 mu (p - p0) = sigma_Y + H(p)
 * by Newton's method from the tangent at p0; `growth` is H(p), at p0 on entry, at p on return. If
 * that does not converge, or p0 = 0, where the law's slope may be infinite, wb_hardening_ratio()
 * solves the equation in logarithms. */
static double find_increment(const struct wb_material *m, double q, double p0, double *growth)
{
    const struct wb_hardening_law *law = wb_hardening_law(m);
    const double three_mu = m->youngs_modulus, over = q - m->yield_stress;

    if (p0 > 0.0) {
        double step = (over - *growth) / (three_mu + wb_hardening_exponent(m, p0) * *growth / p0);
        for (int iteration = 0; iteration < 6; iteration++) {
            const double p = p0 + step;
            *growth = law->growth(m, p);
            const double residual = over - *growth - three_mu * step;
            step += residual / (three_mu + wb_hardening_exponent(m, p) * *growth / p);
            if (fabs(residual) <= 4e-16 * q)
                return fmax(0.0, step);
        }
    }
    const double c = over + three_mu * p0, r = wb_hardening_ratio(m, c);
    *growth = (1.0 - r) * c;
    return fmax(0.0, r * c / three_mu - p0);
}

/* Return mapping from the trial value of T - X. False while elastic. */
static bool find_flow(const struct wb_solid_point_law *law, const double trial[6],
                      double accumulated, struct flow *flow)
{
    const struct wb_material *m = &law->radial;
    const struct wb_hardening_law *hardening = wb_hardening_law(m);
    if (!hardening->yields)
        return false;

    const double three_mu = m->youngs_modulus, p0 = accumulated;
    const double norm = sqrt(squared_norm(trial)), q = sqrt(1.5) * norm;
    double growth = hardening->growth && p0 > 0.0 ? hardening->growth(m, p0) : 0.0; /* H(p) */
    if (!(q - (m->yield_stress + growth) > on_surface * (m->yield_stress + growth)))
        return false;

    double slope = wb_hardening_back_modulus(m); /* of X, or of the yield stress, over p */
    if (hardening->growth) {
        flow->increment = find_increment(m, q, p0, &growth);
        const double p = p0 + flow->increment;
        slope = wb_hardening_exponent(m, p) * growth / p;
    } else {
        flow->increment = (q - m->yield_stress) / (three_mu + slope);
    }
    flow->dissipated = (m->yield_stress + growth) * flow->increment;

    const double lost = three_mu * flow->increment / q;
    flow->shrink = 1.0 - lost;
    flow->along = three_mu / (three_mu + slope) - lost;
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

/* Second divided difference of ln at 1 + a, 1 + b, 1 + c, which are not all close. */
static double log_difference2(double a, double b, double c)
{
    const double low = fmin(a, fmin(b, c)), high = fmax(a, fmax(b, c));
    const double middle = fmax(fmin(a, b), fmin(fmax(a, b), c));
    return (log_difference(middle, high) - log_difference(low, middle)) / (high - low);
}

enum {
    TRIPLES = 8 /* seven, and one to fill the vectors */
};

/* Second divided differences of ln at 1 + x[.][t]. For close arguments by the power series about
 * their mean, whose terms are the complete homogeneous symmetric polynomials h_k; about the mean
 * the first of these vanishes. The loops over triples are written for vectorisation. */
static void log_differences2(double x[3][TRIPLES], double f3[TRIPLES])
{
    enum {
        TERMS = 11
    };
    double spread[TRIPLES], e2[TRIPLES], e3[TRIPLES], h[TERMS][TRIPLES];

    for (int t = 0; t < TRIPLES; t++) {
        const double mean = (x[0][t] + x[1][t] + x[2][t]) / 3.0, scale = 1.0 / (1.0 + mean);
        const double a = (x[0][t] - mean) * scale, b = (x[1][t] - mean) * scale;
        const double c = (x[2][t] - mean) * scale;
        spread[t] = fabs(a) + fabs(b) + fabs(c);
        e2[t] = a * b + b * c + c * a;
        e3[t] = a * b * c;
        h[0][t] = scale * scale;
        h[1][t] = 0.0;
        h[2][t] = -e2[t] * h[0][t];
        f3[t] = -1.0 / 2.0 * h[0][t] - 1.0 / 4.0 * h[2][t];
    }
    for (int k = 3; k < TERMS; k++) {
        const double factor = (k % 2 == 0 ? -1.0 : 1.0) / (k + 2);
        for (int t = 0; t < TRIPLES; t++) {
            h[k][t] = e3[t] * h[k - 3][t] - e2[t] * h[k - 2][t];
            f3[t] += factor * h[k][t];
        }
    }
    for (int t = 0; t < TRIPLES; t++) {
        if (!(spread[t] < 0.1))
            f3[t] = log_difference2(x[0][t], x[1][t], x[2][t]);
    }
}

/* Adds sum_ijk T_ij G_ikj (d_ik d_kj + d_ik d_kj), G_ikj = 2 f3[c_i, c_k, c_j] l_i l_k^2 l_j with
 * f3 the second divided difference of ln: the curvature of E(C). */
static void add_curvature(const struct wb_solid_point_spectrum *s, const double T[6],
                          double c[6][6])
{
    /* Index of the triple c_i, c_i, c_k; 6 is the triple of all three. */
    static const int triple[3][3] = {{7, 0, 1}, {2, 7, 3}, {4, 5, 7}};
    const double *e = s->excess, *l = s->stretch;
    double x[3][TRIPLES], f3[TRIPLES];

    for (int i = 0; i < 3; i++) {
        x[i][6] = e[i];
        x[i][7] = 0.0;
        for (int k = 0; k < 3; k++) {
            if (k == i)
                continue;
            x[0][triple[i][k]] = x[1][triple[i][k]] = e[i];
            x[2][triple[i][k]] = e[k];
        }
    }
    log_differences2(x, f3);
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double ll = l[i] * l[i], kl = l[i] * l[j];
        const double shear = 2.0 * T[3 + i] * kl; /* T_ij with j = i + 1 */
        c[i][i] -= 2.0 * T[i];                    /* f3[c_i, c_i, c_i] = -1/2 c_i^-2 */
        c[3 + i][3 + i] += ll * l[j] * l[j] * (T[i] * f3[triple[i][j]] + T[j] * f3[triple[j][i]]);

        /* Pairs d_ii d_ij, d_ij d_jj and d_ik d_kj. */
        const double first = shear * ll * f3[triple[i][j]];
        const double second = shear * l[j] * l[j] * f3[triple[j][i]];
        const double third = 0.5 * shear * l[k] * l[k] * f3[6];
        c[i][3 + i] += first;
        c[3 + i][i] += first;
        c[3 + i][j] += second;
        c[j][3 + i] += second;
        c[3 + k][3 + j] += third;
        c[3 + j][3 + k] += third;
    }
}

/* c in the eigenvectors: (theta d):D:(theta d) and the curvature, with D of the return mapping. */
static void find_tangent(const struct wb_solid_point_law *law,
                         const struct wb_solid_point_spectrum *s, const double theta[6],
                         const double T[6], const struct flow *flow, double c[6][6])
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

/* out = M c M^T, where M transforms the components of a stress in the basis n (rows) to the
 * frame's. */
static void rotate_tangent(double c[6][6], const struct wb_solid_point_basis *basis,
                           double out[6][6])
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
static void push_vectors(const struct wb_solid_point_motion *motion, struct wb_solid_point_basis *n)
{
    const struct wb_solid_point_spectrum *s = &motion->spectrum;

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
                               const struct wb_solid_point_state *before,
                               struct wb_solid_point_state *after, bool tangent,
                               struct wb_solid_point_response *response)
{
    const double mu = law->shear_modulus;
    const double prager = 2.0 / 3.0 * wb_hardening_back_modulus(&law->radial);
    const struct wb_solid_point_spectrum *s = &motion->spectrum;
    struct flow flow;
    double plastic[6], T[6], relative[6], tau[6];

    into_basis(before->plastic_strain, &s->vectors, plastic);
    *after = *before;

    const double mean = (s->log_stretch[0] + s->log_stretch[1] + s->log_stretch[2]) / 3.0;
    for (int a = 0; a < 6; a++) {
        const double total = a < 3 ? s->log_stretch[a] - mean : 0.0;
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
        out_of_basis(step, &s->vectors, turned);
        for (int a = 0; a < 6; a++)
            after->plastic_strain[a] += turned[a];
        after->accumulated += flow.increment;
    }
    response->yields = yields;
    response->dissipated = yields ? flow.dissipated : 0.0;
    response->energy =
        squared_norm(T) / (4.0 * mu) + 0.5 * prager * squared_norm(after->plastic_strain);

    double theta[6] = {1.0, 1.0, 1.0};
    struct wb_solid_point_basis n;
    for (int i = 0; i < 3; i++)
        theta[3 + i] = over_sinh(s->log_stretch[i] - s->log_stretch[(i + 1) % 3]);
    for (int a = 0; a < 6; a++)
        tau[a] = theta[a] * T[a];
    push_vectors(motion, &n);
    out_of_basis(tau, &n, response->stress);
    if (tangent) {
        double c[6][6];
        find_tangent(law, s, theta, T, yields ? &flow : NULL, c);
        rotate_tangent(c, &n, response->tangent);
    }
}
