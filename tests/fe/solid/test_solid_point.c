#include "fe/solid/solid_point.h"

#include <stdlib.h>

#include "tests/check.h"
#include "tests/fe/solid/solid_point_twin.h"
#include "tests/twin/material_stress.h"

static const struct wb_material elastic = {WB_HARDENING_NONE_ELASTIC, 70e9, 0.34, 0.0, 0.0, 0.0};
static const struct wb_material power = {
    WB_HARDENING_ISOTROPIC_POWER, 70e9, 0.34, 100e6, 600e6, 0.4};
static const struct wb_material steep = {WB_HARDENING_ISOTROPIC_POWER, 70e9, 0.34, 100e6, 9e9, 1.5};
static const struct wb_material prager = {
    WB_HARDENING_KINEMATIC_LINEAR, 70e9, 0.34, 100e6, 9e9, 0.0};
static const struct wb_material *const materials[] = {&elastic, &power, &steep, &prager};
enum {
    N_MATERIALS = 4
};

static double random_number(void) /* -1 to 1 */
{
    return 2.0 * rand() / RAND_MAX - 1.0;
}

/* The deviatoric response for F = I + H, H row by row. */
static void respond(const struct wb_material *material, const double h[9],
                    const struct wb_solid_point_state *before, struct wb_solid_point_state *after,
                    struct wb_solid_point_response *response)
{
    struct wb_solid_point_law law;
    struct wb_solid_point_motion motion;
    wb_solid_point_law_init(&law, material);
    assert_true(wb_solid_point_motion_init(&motion, h));
    wb_solid_point_diagonalise(&motion, 1);
    wb_solid_point_deviatoric(&law, &motion, before, after, true, response);
}

/* --- Deformations to try --- */

static void rotation(double angle, double R[3][3])
{
    double axis[3] = {random_number(), random_number(), random_number()};
    const double norm = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    const double c = cos(angle), s = sin(angle);
    for (int i = 0; i < 3; i++)
        axis[i] /= norm;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            R[i][j] = (i == j ? c : 0.0) + (1.0 - c) * axis[i] * axis[j];
    }
    for (int i = 0; i < 3; i++) {
        R[i][(i + 1) % 3] -= s * axis[(i + 2) % 3];
        R[(i + 1) % 3][i] += s * axis[(i + 2) % 3];
    }
}

/* H of F = Q diag(stretch) R. */
static void deform(const double stretch[3], double h[9])
{
    double Q[3][3], R[3][3];
    rotation(2.0, Q);
    rotation(0.7, R);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            h[3 * i + j] = i == j ? -1.0 : 0.0;
            for (int k = 0; k < 3; k++)
                h[3 * i + j] += Q[i][k] * stretch[k] * R[k][j];
        }
    }
}

static const double stretches[][3] = {
    {1.2, 0.85, 1.01},          {1.1, 1.1, 0.9},          {1.1, 1.1 + 1e-9, 0.9},
    {1.03, 1.03 + 1e-4, 1.029}, {1.2, 1.2, 1.2},          {1.2, 1.2 + 1e-7, 1.2 - 2e-8},
    {1.001, 1.0, 0.9991},       {1.0, 1.0, 1.0 + 2e-3},   {1.02, 0.98, 1.05},
    {1.25, 0.8, 0.9},           {1.004, 1.004001, 0.996}, {1.9, 0.2, 1.0},
};
enum {
    N_STRETCHES = sizeof stretches / sizeof stretches[0]
};

/* A history whose axes differ from those of the deformation. */
static void some_history(struct wb_solid_point_state *state, double size)
{
    memset(state, 0, sizeof *state);
    for (int a = 0; a < 6; a++)
        state->plastic_strain[a] = size * random_number();
    state->plastic_strain[2] = -state->plastic_strain[0] - state->plastic_strain[1];
    state->accumulated = 5e-3;
}

static void stress_agrees_with_the_slow_twin(void **unused)
{
    (void)unused;
    double worst = 0.0;
    srand(1);
    for (int m = 0; m < N_MATERIALS; m++) {
        for (int k = 0; k < N_STRETCHES; k++) {
            struct wb_solid_point_state before, after;
            struct wb_solid_point_response response;
            double h[9], size = 0.0;
            real tau[3][3], computed[3][3];
            some_history(&before, k == N_STRETCHES - 1 ? 0.2 : 2e-3);
            deform(stretches[k], h);
            respond(materials[m], h, &before, &after, &response);
            twin_stress(materials[m], h, &before, tau);
            unpack(response.stress, computed);
            for (int i = 0; i < 9; i++)
                size = fmax(size, fabs(response.stress[i % 6]));
            for (int i = 0; i < 9; i++) {
                const real error = computed[i / 3][i % 3] - tau[i / 3][i % 3];
                worst = fmax(worst, fabs((double)error) / size);
            }
        }
    }
    print_message("largest error of a stress against the slow twin: %.2g\n", worst);
    assert_true(worst < 1e-11);
}

/* First Piola-Kirchhoff stress times a direction A: P:A = tau F^-T : A. */
static double power_of(const struct wb_material *m, const double h[9],
                       const struct wb_solid_point_state *before, const double A[9])
{
    struct wb_solid_point_response response;
    struct wb_solid_point_motion motion;
    struct wb_solid_point_state after;
    real tau[3][3];
    double sum = 0.0;
    respond(m, h, before, &after, &response);
    assert_true(wb_solid_point_motion_init(&motion, h));
    unpack(response.stress, tau);
    for (int i = 0; i < 27; i++) {
        const int a = i / 9, b = i / 3 % 3, c = i % 3;
        sum += (double)tau[a][b] * motion.inverse[c][b] * A[3 * a + c];
    }
    return sum;
}

/* The second variation for directions A and B: (A F^-1):c:(B F^-1) + tau : (A F^-1)(B F^-1)^T. */
static double second_variation(const struct wb_solid_point_motion *motion,
                               const struct wb_solid_point_response *response, const double A[9],
                               const double B[9])
{
    static const int row[6] = {0, 1, 2, 0, 1, 2}, column[6] = {0, 1, 2, 1, 2, 0};
    double a[3][3] = {{0.0}}, b[3][3] = {{0.0}}, sum = 0.0;
    real tau[3][3];
    for (int i = 0; i < 27; i++) {
        a[i / 9][i / 3 % 3] += A[3 * (i / 9) + i % 3] * motion->inverse[i % 3][i / 3 % 3];
        b[i / 9][i / 3 % 3] += B[3 * (i / 9) + i % 3] * motion->inverse[i % 3][i / 3 % 3];
    }
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 6; j++) {
            const double di = i < 3 ? a[i][i] : a[row[i]][column[i]] + a[column[i]][row[i]];
            const double dj = j < 3 ? b[j][j] : b[row[j]][column[j]] + b[column[j]][row[j]];
            sum += di * response->tangent[i][j] * dj;
        }
    }
    unpack(response->stress, tau);
    for (int i = 0; i < 27; i++) {
        const int k = i / 9, j = i / 3 % 3, l = i % 3;
        sum += a[k][j] * (double)tau[j][l] * b[k][l];
    }
    return sum;
}

static void check_tangent(const struct wb_material *m, const double h[9],
                          const struct wb_solid_point_state *before, double *worst)
{
    struct wb_solid_point_response response;
    struct wb_solid_point_motion motion;
    struct wb_solid_point_state after;
    double B[9], error = 0.0, size = m->youngs_modulus;

    respond(m, h, before, &after, &response);
    assert_true(wb_solid_point_motion_init(&motion, h));
    for (int i = 0; i < 9; i++)
        B[i] = random_number();
    for (int i = 0; i < 9; i++) {
        double A[9] = {0.0}, value[4];
        A[i] = 1.0;
        for (int k = 0; k < 4; k++) {
            static const int at[4] = {-2, -1, 1, 2};
            double moved[9];
            for (int j = 0; j < 9; j++)
                moved[j] = h[j] + at[k] * 8e-6 * B[j];
            value[k] = power_of(m, moved, before, A);
        }
        const double slope = (value[0] - 8.0 * value[1] + 8.0 * value[2] - value[3]) / 96e-6;
        error = fmax(error, fabs(slope - second_variation(&motion, &response, A, B)));
        size = fmax(size, fabs(slope));
    }
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 6; j++)
            assert_true(response.tangent[i][j] == response.tangent[j][i]);
    }
    *worst = fmax(*worst, error / size);
}

static void tangent_is_the_derivative_of_the_stress(void **unused)
{
    (void)unused;
    double worst = 0.0;
    int yielding = 0;
    srand(2);
    for (int m = 0; m < N_MATERIALS; m++) {
        for (int k = 0; k < N_STRETCHES; k++) {
            struct wb_solid_point_state before, after;
            struct wb_solid_point_response response;
            double h[9];
            some_history(&before, k == N_STRETCHES - 1 ? 0.2 : 2e-3);
            deform(stretches[k], h);
            respond(materials[m], h, &before, &after, &response);
            yielding += response.yields;
            check_tangent(materials[m], h, &before, &worst);
        }
    }
    print_message("largest error of a tangent: %.2g; %d of %d points yield\n", worst, yielding,
                  (N_MATERIALS - 1) * N_STRETCHES);
    assert_true(worst < 1e-9);
    assert_true(yielding >= 25);
}

static void volumetric_part_is_exact(void **unused)
{
    (void)unused;
    const double stretch[3] = {1.1, 0.7, 1.2};
    struct wb_solid_point_law law;
    struct wb_solid_point_motion motion;
    struct wb_solid_point_response response;
    double h[9], A[9], B[9];

    srand(3);
    deform(stretch, h);
    wb_solid_point_law_init(&law, &elastic);
    assert_true(wb_solid_point_motion_init(&motion, h));
    memset(&response, 0, sizeof response);
    wb_solid_point_add_volumetric(&law, &motion, true, &response);
    const double kappa = 70e9 / (3.0 * (1.0 - 0.68)), log_J = log(1.1 * 0.7 * 1.2);
    assert_close_relative(response.stress[0], kappa * log_J, 1e-14);
    assert_close_relative(response.energy, 0.5 * kappa * log_J * log_J, 1e-13);

    /* P : A = kappa ln J tr(A F^-1). */
    for (int i = 0; i < 9; i++) {
        A[i] = random_number();
        B[i] = random_number();
    }
    double value[4];
    for (int k = 0; k < 4; k++) {
        static const int at[4] = {-2, -1, 1, 2};
        double moved[9];
        for (int j = 0; j < 9; j++)
            moved[j] = h[j] + at[k] * 1e-4 * B[j];
        struct wb_solid_point_motion near;
        assert_true(wb_solid_point_motion_init(&near, moved));
        value[k] = 0.0;
        for (int i = 0; i < 9; i++)
            value[k] += kappa * near.log_jacobian * A[i] * near.inverse[i % 3][i / 3];
    }
    const double slope = (value[0] - 8.0 * value[1] + 8.0 * value[2] - value[3]) / 12e-4;
    assert_close_relative(second_variation(&motion, &response, A, B), slope, 1e-10);
}

/* --- Closed forms --- */

/* F = exp(diag(e)): prescribes the logarithmic strain. */
static void stretch_along_axes(const double e[3], double h[9])
{
    memset(h, 0, 9 * sizeof *h);
    for (int i = 0; i < 3; i++)
        h[4 * i] = expm1(e[i]);
}

/* Kirchhoff stresses along the axes at each corner of the path, with `steps` steps per side. */
static void run_path(const struct wb_material *m, int steps, double stress[8][3])
{
    static const double side[8][2] = {{1, 0},  {1, 0},  {0, 1},  {0, 1},
                                      {-1, 0}, {-1, 0}, {0, -1}, {0, -1}};
    const double R = 2.5e-5;
    struct wb_solid_point_law law;
    struct wb_solid_point_state state = {{0.0}};
    double start[3] = {0.0}, e[3] = {0.0}, h[9];

    wb_solid_point_law_init(&law, m);
    for (int corner = 0; corner < 8; corner++) {
        for (int k = 1; k <= steps; k++) {
            struct wb_solid_point_motion motion;
            struct wb_solid_point_response deviatoric, volumetric;
            for (int i = 0; i < 2; i++)
                e[i] = start[i] + R * side[corner][i] * k / steps;
            stretch_along_axes(e, h);
            assert_true(wb_solid_point_motion_init(&motion, h));
            memset(&volumetric, 0, sizeof volumetric);
            wb_solid_point_add_volumetric(&law, &motion, false, &volumetric);
            wb_solid_point_diagonalise(&motion, 1);
            wb_solid_point_deviatoric(&law, &motion, &state, &state, false, &deviatoric);
            for (int i = 0; i < 3; i++)
                stress[corner][i] = deviatoric.stress[i] + volumetric.stress[i];
        }
        start[0] = e[0];
        start[1] = e[1];
    }
}

static void prescribed_strain_paths_reach_the_reference(void **unused)
{
    (void)unused;
    static const double perfect[8][3] = {{7.5, 2.5, 2.5},
                                         {11.6667, 6.6667, 6.6667},
                                         {14.1667, 14.1667, 9.1667},
                                         {16.3172, 19.7122, 13.9705},
                                         {9.8255, 15.5602, 12.1143},
                                         {5.0975, 10.6443, 9.2582},
                                         {2.5975, 3.1443, 6.7582},
                                         {0.2351, -2.9971, 2.7620}};
    static const double hardening[8][3] = {{7.5, 2.5, 2.5},
                                           {12.2414, 6.3793, 6.3793},
                                           {14.7414, 13.8793, 8.8793},
                                           {16.8604, 20.2387, 12.9009},
                                           {9.7447, 16.8746, 10.8807},
                                           {3.9672, 12.3953, 8.6375},
                                           {1.4672, 4.8953, 6.1375},
                                           {-1.0328, -2.6047, 3.6375}};
    struct wb_material m = {WB_HARDENING_ISOTROPIC_POWER, 250e3, 0.25, 5.0, 0.0, 1.0};
    double stress[8][3];

    run_path(&m, 4000, stress);
    for (int i = 0; i < 24; i++)
        assert_close(stress[i / 3][i % 3], perfect[i / 3][i % 3], 3e-4);
    m.strength_coefficient = 62.5e3;
    run_path(&m, 4000, stress);
    for (int i = 0; i < 24; i++)
        assert_close(stress[i / 3][i % 3], hardening[i / 3][i % 3], 3e-4);
}

static void one_step_a_side_is_the_radial_return(void **unused)
{
    (void)unused;
    const struct wb_material m = {WB_HARDENING_ISOTROPIC_POWER, 250e3, 0.25, 5.0, 0.0, 1.0};
    static const double expected[3] = {16.6667, 19.5534, 13.7799};
    double stress[8][3];
    run_path(&m, 1, stress);
    for (int i = 0; i < 3; i++)
        assert_close(stress[3][i], expected[i], 6e-5);
}

/* In uniaxial stress the logarithmic formulation gives the 1D law exactly, for any strain; its
 * plastic strain gives the lateral strain. */
static void uniaxial_stress_is_the_1d_law(void **unused)
{
    (void)unused;
    for (int k = 0; k < N_MATERIALS; k++) {
        const struct wb_material *m = materials[k];
        const double nu = m->poissons_ratio, E = m->youngs_modulus;
        struct wb_material_state line = {0.0};
        struct wb_solid_point_state state = {{0.0}};
        for (int step = 1; step <= 400; step++) {
            const double e = 0.15 * sin(0.03 * step) * step / 400.0;
            double sigma, slope, h[9];
            wb_material_stress(m, e, &line, &line, &sigma, &slope);
            const double plastic = line.plastic_strain;
            const double lateral = -nu * (e - plastic) - 0.5 * plastic;
            const double strain[3] = {lateral, e, lateral};
            struct wb_solid_point_law law;
            struct wb_solid_point_motion motion;
            struct wb_solid_point_response dev, vol;

            stretch_along_axes(strain, h);
            wb_solid_point_law_init(&law, m);
            assert_true(wb_solid_point_motion_init(&motion, h));
            memset(&vol, 0, sizeof vol);
            wb_solid_point_add_volumetric(&law, &motion, true, &vol);
            wb_solid_point_diagonalise(&motion, 1);
            wb_solid_point_deviatoric(&law, &motion, &state, &state, true, &dev);
            const double noise = 1e-14 * E * fabs(e) + 1e-12 * fabs(sigma);
            assert_close(dev.stress[1] + vol.stress[1], sigma, noise);
            assert_close(dev.stress[0] + vol.stress[0], 0.0, noise);
            assert_close(dev.stress[2] + vol.stress[2], 0.0, noise);
            assert_close(state.accumulated, line.accumulated_plastic_strain, 1e-13);

            /* d tau_i / d ln lambda_j = c_ij + 2 tau_i delta_ij, condensed to the axis. */
            double D[3][3];
            for (int i = 0; i < 9; i++)
                D[i / 3][i % 3] = dev.tangent[i / 3][i % 3] + vol.tangent[i / 3][i % 3];
            for (int i = 0; i < 3; i++)
                D[i][i] += 2.0 * (dev.stress[i] + vol.stress[i]);
            const double condensed = D[1][1] - 2.0 * D[1][0] * D[1][0] / (D[0][0] + D[0][2]);
            assert_close(condensed, slope, 1e-9 * E);
        }
    }
}

static void simple_shear_has_its_closed_form(void **unused)
{
    (void)unused;
    const double mu = 70e9 / (2.0 * 1.34);
    for (double gamma = 1e-9; gamma < 4.0; gamma *= 3.0) {
        const double h[9] = {0.0, gamma, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
        const struct wb_solid_point_state virgin = {{0.0}};
        struct wb_solid_point_state after;
        struct wb_solid_point_response response;
        respond(&elastic, h, &virgin, &after, &response);
        const double size = 2.0 * mu * asinh(0.5 * gamma) / sqrt(4.0 + gamma * gamma);
        assert_close_relative(response.stress[3], 2.0 * size, 2e-14);
        const double noise = 4e-15 * (1.0 + gamma) * size;
        assert_close(response.stress[0], gamma * size, noise);
        assert_close(response.stress[1], -gamma * size, noise);
        assert_close(response.stress[2], 0.0, noise);
        assert_close_relative(response.energy, 2.0 * mu * pow(asinh(0.5 * gamma), 2.0), 2e-14);
    }
}

/* --- Invariances --- */

static void a_rotation_of_any_size_gives_no_stress(void **unused)
{
    (void)unused;
    srand(4);
    for (int k = 0; k < 200; k++) {
        const struct wb_solid_point_state virgin = {{0.0}};
        struct wb_solid_point_response response;
        struct wb_solid_point_motion motion;
        struct wb_solid_point_state after;
        double R[3][3], h[9];
        rotation(6.4 * k / 200.0, R);
        for (int i = 0; i < 9; i++)
            h[i] = R[i / 3][i % 3] - (i % 4 == 0 ? 1.0 : 0.0);
        respond(&power, h, &virgin, &after, &response);
        assert_true(wb_solid_point_motion_init(&motion, h));
        for (int a = 0; a < 6; a++)
            assert_close(response.stress[a], 0.0, 2e-15 * 70e9);
        assert_close(motion.log_jacobian, 0.0, 2e-15);
    }
}

static void a_rotated_yielding_point_only_rotates(void **unused)
{
    (void)unused;
    srand(5);
    for (int m = 0; m < N_MATERIALS; m++) {
        struct wb_solid_point_state before, after, after_turned;
        struct wb_solid_point_response response, turned;
        double h[9], R[3][3], h_turned[9];
        real s[3][3], s_turned[3][3];
        some_history(&before, 2e-3);
        deform(stretches[8], h);
        rotation(2.9, R);
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) {
                h_turned[3 * i + j] = R[i][j] - (i == j);
                for (int k = 0; k < 3; k++)
                    h_turned[3 * i + j] += R[i][k] * h[3 * k + j];
            }
        }
        respond(materials[m], h, &before, &after, &response);
        respond(materials[m], h_turned, &before, &after_turned, &turned);
        assert_true(response.yields == (m > 0));
        for (int a = 0; a < 6; a++)
            assert_close(after_turned.plastic_strain[a], after.plastic_strain[a], 1e-15);
        assert_close(after_turned.accumulated, after.accumulated, 1e-15);
        assert_close_relative(turned.energy, response.energy, 1e-12);
        unpack(response.stress, s);
        unpack(turned.stress, s_turned);
        for (int i = 0; i < 9; i++) {
            double sum = 0.0;
            for (int k = 0; k < 9; k++)
                sum += R[i / 3][k / 3] * (double)s[k / 3][k % 3] * R[i % 3][k % 3];
            assert_close((double)s_turned[i / 3][i % 3], sum, 1e-13 * 70e9 * 0.05);
        }
    }
}

/* --- Precision, and invalid input --- */

static void tiny_strains_keep_their_digits(void **unused)
{
    (void)unused;
    srand(6);
    const double mu = 70e9 / (2.0 * 1.34);
    for (double size = 1e-14; size < 1e-8; size *= 10.0) {
        const struct wb_solid_point_state virgin = {{0.0}};
        struct wb_solid_point_state after;
        struct wb_solid_point_response response;
        struct wb_solid_point_motion motion;
        double h[9];
        for (int i = 0; i < 9; i++)
            h[i] = size * random_number();
        respond(&elastic, h, &virgin, &after, &response);
        assert_true(wb_solid_point_motion_init(&motion, h));
        const double trace = h[0] + h[4] + h[8];
        const double noise = 10.0 * size + 1e-15; /* what is not linear, and round-off */
        assert_close(motion.log_jacobian, trace, noise * size);
        assert_close(response.stress[0], 2.0 * mu * (h[0] - trace / 3.0), noise * mu * size);
        assert_close(response.stress[2], 2.0 * mu * (h[8] - trace / 3.0), noise * mu * size);
        assert_close(response.stress[3], mu * (h[1] + h[3]), noise * mu * size);
        assert_close(response.stress[4], mu * (h[5] + h[7]), noise * mu * size);
        assert_close(response.stress[5], mu * (h[2] + h[6]), noise * mu * size);
    }
}

/* At p = 0 the power law has an infinite slope: yielding begins gradually, and must be detected. */
static void yielding_ends_on_the_yield_surface(void **unused)
{
    (void)unused;
    for (double over = 1e-11; over < 100.0; over *= 4.0) {
        for (int m = 1; m < 3; m++) {
            const struct wb_material *law = materials[m];
            const double e = law->yield_stress * (1.0 + over) * 2.0 * 1.34 / (3.0 * 70e9);
            const double strain[3] = {-0.5 * e, e, -0.5 * e};
            const struct wb_solid_point_state virgin = {{0.0}};
            struct wb_solid_point_state after, again;
            struct wb_solid_point_response response;
            double h[9];
            stretch_along_axes(strain, h);
            respond(law, h, &virgin, &after, &response);
            const double q = 1.5 * response.stress[1], p = after.accumulated;
            const double limit =
                law->yield_stress + law->strength_coefficient * pow(p, law->hardening_exponent);
            assert_true(response.yields && p > 0.0);
            assert_close(q / limit, 1.0, 1e-13);
            assert_close(p, after.plastic_strain[1], 1e-15 * p + 1e-18);
            /* On the yield surface it does not yield again. */
            respond(law, h, &after, &again, &response);
            assert_false(response.yields);
            assert_memory_equal(&after, &again, sizeof after);
        }
    }
}

static void invalid_deformations_are_rejected(void **unused)
{
    (void)unused;
    struct wb_solid_point_motion motion;
    double h[9] = {0.0};
    h[4] = -1.0; /* flat */
    assert_false(wb_solid_point_motion_init(&motion, h));
    h[4] = -2.5; /* inside out */
    assert_false(wb_solid_point_motion_init(&motion, h));
    h[4] = (double)NAN;
    assert_false(wb_solid_point_motion_init(&motion, h));
    h[4] = (double)INFINITY;
    assert_false(wb_solid_point_motion_init(&motion, h));
    h[4] = 0.0;
    assert_true(wb_solid_point_motion_init(&motion, h));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stress_agrees_with_the_slow_twin),
        cmocka_unit_test(tangent_is_the_derivative_of_the_stress),
        cmocka_unit_test(volumetric_part_is_exact),
        cmocka_unit_test(prescribed_strain_paths_reach_the_reference),
        cmocka_unit_test(one_step_a_side_is_the_radial_return),
        cmocka_unit_test(uniaxial_stress_is_the_1d_law),
        cmocka_unit_test(simple_shear_has_its_closed_form),
        cmocka_unit_test(a_rotation_of_any_size_gives_no_stress),
        cmocka_unit_test(a_rotated_yielding_point_only_rotates),
        cmocka_unit_test(tiny_strains_keep_their_digits),
        cmocka_unit_test(yielding_ends_on_the_yield_surface),
        cmocka_unit_test(invalid_deformations_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
