/* Kinematics, forces and stiffness of the rod's element. */
#include "base/vec3.h"
#include "fe/rod/rod_element.h"

#include "tests/fe/rod/wires.h"

enum {
    U = WB_ROD_ELEMENT_UNKNOWNS,
    NODES = WB_ROD_ELEMENT_NODES,
    POINTS = WB_ROD_ELEMENT_POINTS
};

static const double identity[4] = {1.0, 0.0, 0.0, 0.0};

static double difference(const double *a, const double *b, int n)
{
    double worst = 0.0;
    for (int i = 0; i < n; i++)
        worst = fmax(worst, fabs(a[i] - b[i]));
    return worst;
}

/* Strains of an element's points that vary linearly. */
static void linear_strain(const double *a, const double *b, double h, struct wb_rod_strain *total)
{
    for (int g = 0; g < POINTS; g++) {
        const double s = 0.5 * h * (1.0 + (g == 0 ? -1.0 : 1.0) / sqrt(3.0));
        total[g] = (struct wb_rod_strain){.stretch = {1.0, 0.0, 0.0}};
        for (int i = 0; i < 3; i++)
            total[g].curvature[i] = a[i] + b[i] * s;
    }
}

/* The rotation as a product of many small rotations. */
static void fine_rotation(const double *a, const double *b, double h, double *q)
{
    enum {
        FINE = 20000
    };
    memcpy(q, identity, sizeof identity);
    for (int i = 0; i < FINE; i++) {
        double turn[3], step[4];
        for (int k = 0; k < 3; k++)
            turn[k] = h / FINE * (a[k] + b[k] * h * (i + 0.5) / FINE);
        wb_rod_element_exponential(turn, step);
        wb_rod_element_compose(q, step, q);
    }
}

static void rotation_follows_a_linear_curvature_to_fourth_order(void **unused)
{
    (void)unused;
    const double a[3] = {0.8, -0.5, 1.1}, b[3] = {-0.9, 1.4, 0.6};
    double error[3];
    for (int k = 0; k < 3; k++) {
        const double h = 1.0 / (1 << k);
        struct wb_rod_shape shape;
        struct wb_rod_strain total[POINTS];
        double fine[4], q[4];
        wb_rod_shape_init(&shape, h);
        linear_strain(a, b, h, total);
        wb_rod_element_rotation(&shape, total, h, identity, q);
        fine_rotation(a, b, h, fine);
        error[k] = difference(q, fine, 4);
    }
    print_message("rotation over 1, 1/2, 1/4: error %.2g, %.2g, %.2g\n", error[0], error[1],
                  error[2]);
    assert_true(error[0] < 1e-2);
    assert_true(error[0] / error[1] > 24.0);
    assert_true(error[1] / error[2] > 28.0);
}

static void constant_curvature_is_a_helix(void **unused)
{
    (void)unused;
    /* Curvature k and torsion t: radius k / (k^2 + t^2), pitch 2 pi t / (k^2 + t^2). */
    const double k = 3.0, t = 2.0, square = k * k + t * t;
    const double a[3] = {t, 0.0, k}, b[3] = {0.0, 0.0, 0.0};
    const double h = 2.0 * M_PI / sqrt(square) / 40.0;
    struct wb_rod_shape shape;
    struct wb_rod_strain total[POINTS];
    struct wb_rod_node nodes[NODES] = {{.rotation = {1.0, 0.0, 0.0, 0.0}}};
    struct wb_rod_point points[POINTS];
    wb_rod_shape_init(&shape, h);
    linear_strain(a, b, h, total);
    for (int e = 0; e < 40; e++) {
        wb_rod_element_place(&shape, total, nodes, points);
        nodes[0] = nodes[2];
    }
    /* A full turn: the frame is the initial one again, and the axis has advanced by the pitch along
     * (t, 0, k). */
    assert_close(fabs(nodes[2].rotation[0]), 1.0, 1e-13);
    const double pitch = 2.0 * M_PI * t / square;
    const double end[3] = {pitch * t / sqrt(square), 0.0, pitch * k / sqrt(square)};
    assert_true(difference(nodes[2].position, end, 3) < 1e-6);
}

static struct wb_rod_point loaded_point(uint64_t *seed)
{
    struct wb_rod_point p = {.shear_stiffness = 3.0};
    double vector[3], q[4];
    for (int i = 0; i < 3; i++) {
        vector[i] = 2.0 * test_random(seed) - 1.0;
        p.slope[i] = 2.0 * test_random(seed) - 1.0;
    }
    wb_rod_element_exponential(vector, q);
    wb_rod_element_matrix(q, p.R);
    for (int i = 0; i < 4; i++) {
        p.section.force[i] = test_random(seed) - 0.5;
        for (int j = 0; j <= i; j++)
            p.section.tangent[i][j] = p.section.tangent[j][i] =
                test_random(seed) + (i == j ? 2.0 : 0.0);
    }
    const double shear[2] = {test_random(seed), test_random(seed)};
    wb_rod_element_turn_forces(&p, shear);
    return p;
}

static void forces_do_the_work_of_the_strains(void **unused)
{
    (void)unused;
    uint64_t seed = 2;
    struct wb_rod_shape shape;
    wb_rod_shape_init(&shape, 0.7);
    for (int trial = 0; trial < 20; trial++) {
        double d[NODES * U], f[NODES * U] = {0}, work = 0.0, done = 0.0;
        for (int i = 0; i < NODES * U; i++)
            d[i] = test_random(&seed) - 0.5;
        for (int g = 0; g < POINTS; g++) {
            const struct wb_rod_point p = loaded_point(&seed);
            struct wb_rod_strain change;
            double n[3], m[3];
            wb_rod_element_add_forces(&shape, g, &p, f);
            wb_rod_element_strain_increment(&shape, g, &p, d, &change);
            for (int i = 0; i < 3; i++) {
                n[i] = p.R[i] * p.n[0] + p.R[3 + i] * p.n[1] + p.R[6 + i] * p.n[2];
                m[i] = p.R[i] * p.m[0] + p.R[3 + i] * p.m[1] + p.R[6 + i] * p.m[2];
                work += shape.weight * (n[i] * change.stretch[i] + m[i] * change.curvature[i]);
            }
            assert_close(n[0], p.section.force[0], 1e-14);
        }
        for (int i = 0; i < NODES * U; i++)
            done += f[i] * d[i];
        assert_close(done, work, 1e-13);
    }
}

static void forces_and_moments_balance(void **unused)
{
    (void)unused;
    uint64_t seed = 4;
    const double a[3] = {0.8, -0.5, 1.1}, b[3] = {-0.9, 1.4, 0.6}, h = 0.9;
    struct wb_rod_shape shape;
    struct wb_rod_strain total[POINTS];
    struct wb_rod_node nodes[NODES] = {{.position = {0.3, 0.2, -0.4}}};
    struct wb_rod_point points[POINTS];
    double f[NODES * U] = {0}, force[3] = {0}, moment[3] = {0};
    const double first[3] = {0.4, -1.0, 0.7};
    wb_rod_element_exponential(first, nodes[0].rotation);
    wb_rod_shape_init(&shape, h);
    linear_strain(a, b, h, total);
    for (int g = 0; g < POINTS; g++) {
        points[g] = loaded_point(&seed);
        total[g].stretch[1] = 0.1 * (g + 1);
    }
    wb_rod_element_place(&shape, total, nodes, points);
    for (int g = 0; g < POINTS; g++)
        wb_rod_element_add_forces(&shape, g, &points[g], f);
    for (int i = 0; i < NODES; i++) {
        double arm[3];
        wb_vec3_cross(nodes[i].position, f + U * i, arm);
        for (int k = 0; k < 3; k++) {
            force[k] += f[U * i + k];
            moment[k] += f[U * i + 3 + k] + arm[k];
        }
    }
    for (int k = 0; k < 3; k++) {
        assert_close(force[k], 0.0, 1e-14);
        assert_close(moment[k], 0.0, 1e-14);
    }
}

/* Rotates and stretches a point by quadratic motions, to first order, and evaluates its forces. */
static void move_point(const struct wb_rod_shape *shape, int g, const struct wb_rod_point *p,
                       const double *d, struct wb_rod_point *moved)
{
    struct wb_rod_strain change;
    double spin[3] = {0}, slope[3] = {0}, turn[4], R[9], shear[2];
    *moved = *p;
    wb_rod_element_strain_increment(shape, g, p, d, &change);
    for (int i = 0; i < NODES; i++) {
        for (int k = 0; k < 3; k++) {
            slope[k] += shape->dN[g][i] * d[U * i + k];
            spin[k] += shape->N[g][i] * d[U * i + 3 + k];
        }
    }
    wb_rod_element_exponential(spin, turn);
    wb_rod_element_matrix(turn, R);
    for (int i = 0; i < 3; i++) {
        moved->slope[i] += slope[i];
        for (int j = 0; j < 3; j++)
            moved->R[3 * i + j] =
                R[3 * i] * p->R[j] + R[3 * i + 1] * p->R[3 + j] + R[3 * i + 2] * p->R[6 + j];
    }
    const double strain[4] = {change.stretch[0], change.curvature[0], change.curvature[1],
                              change.curvature[2]};
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++)
            moved->section.force[i] += p->section.tangent[i][j] * strain[j];
    }
    for (int i = 0; i < 2; i++) {
        /* Shear forces before the move, in the section's frame. */
        const double *c = p->R + i + 1;
        const double Q = c[0] * p->n[0] + c[3] * p->n[1] + c[6] * p->n[2];
        shear[i] = Q / p->shear_stiffness + change.stretch[i + 1];
    }
    wb_rod_element_turn_forces(moved, shear);
}

static void stiffness_is_the_derivative_of_the_forces(void **unused)
{
    (void)unused;
    uint64_t seed = 9;
    struct wb_rod_shape shape;
    struct wb_rod_point points[POINTS];
    struct wb_rod_element_stiffness stiffness;
    double worst = 0.0;
    wb_rod_shape_init(&shape, 0.7);
    for (int g = 0; g < POINTS; g++)
        points[g] = loaded_point(&seed);
    wb_rod_element_stiffness(&shape, points, &stiffness);
    for (int j = 0; j < NODES * U; j++) {
        double side[2][NODES * U] = {{0}};
        const double step = 1e-6;
        for (int k = 0; k < 2; k++) {
            double d[NODES * U] = {0};
            d[j] = k == 0 ? step : -step;
            for (int g = 0; g < POINTS; g++) {
                struct wb_rod_point moved;
                move_point(&shape, g, &points[g], d, &moved);
                wb_rod_element_add_forces(&shape, g, &moved, side[k]);
            }
        }
        for (int i = 0; i < NODES * U; i++) {
            const double slope = 0.5 * (side[0][i] - side[1][i]) / step;
            const double K = stiffness.K[i / U][j / U][U * (i % U) + j % U];
            worst = fmax(worst, fabs(slope - K));
        }
    }
    print_message("stiffness against differences: %.2g\n", worst);
    assert_true(worst < 1e-8);
}

/* The tangent's approximation: distance between the nodes that follow from the strains of a
 * quadratic motion and that motion. */
static void quadratic_motions_approximate_those_of_the_strains(void **unused)
{
    (void)unused;
    const double a[3] = {0.8, -0.5, 1.1}, b[3] = {-0.9, 1.4, 0.6};
    double error[3];
    for (int level = 0; level < 3; level++) {
        const double h = 0.4 / (1 << level), size = 1e-5;
        struct wb_rod_shape shape;
        struct wb_rod_strain total[POINTS], moved[POINTS];
        struct wb_rod_node nodes[NODES] = {{.rotation = {1.0, 0.0, 0.0, 0.0}}};
        struct wb_rod_point points[POINTS];
        wb_rod_shape_init(&shape, h);
        linear_strain(a, b, h, total);
        wb_rod_element_place(&shape, total, nodes, points);
        /* A spin s (1, -2, 0.5) + s^2 (1, 1, -3) about the first node, which stays. */
        double d[NODES * U] = {0};
        for (int i = 1; i < NODES; i++) {
            const double s = 0.5 * i * h;
            const double spin[3] = {s + s * s, -2.0 * s + s * s, 0.5 * s - 3.0 * s * s};
            for (int k = 0; k < 3; k++)
                d[U * i + 3 + k] = size * spin[k];
        }
        for (int g = 0; g < POINTS; g++) {
            struct wb_rod_strain change;
            wb_rod_element_strain_increment(&shape, g, &points[g], d, &change);
            moved[g] = total[g];
            for (int k = 0; k < 3; k++)
                moved[g].curvature[k] += change.curvature[k];
        }
        struct wb_rod_node after[NODES] = {nodes[0]};
        wb_rod_element_place(&shape, moved, after, points);
        /* Spin of the last node: twice the vector part of q_after q_before^-1. */
        double back[4], q[4], spin[3];
        back[0] = nodes[2].rotation[0];
        for (int k = 1; k < 4; k++)
            back[k] = -nodes[2].rotation[k];
        wb_rod_element_compose(after[2].rotation, back, q);
        for (int k = 0; k < 3; k++)
            spin[k] = 2.0 * q[k + 1];
        error[level] = difference(spin, d + 2 * U + 3, 3) / (size * h);
    }
    print_message("motion of the last node, h = 0.4, 0.2, 0.1: off by %.2g, %.2g, %.2g\n", error[0],
                  error[1], error[2]);
    assert_true(error[0] < 1e-2);
    assert_true(error[0] / error[1] > 14.0);
    assert_true(error[1] / error[2] > 14.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rotation_follows_a_linear_curvature_to_fourth_order),
        cmocka_unit_test(constant_curvature_is_a_helix),
        cmocka_unit_test(forces_do_the_work_of_the_strains),
        cmocka_unit_test(forces_and_moments_balance),
        cmocka_unit_test(stiffness_is_the_derivative_of_the_forces),
        cmocka_unit_test(quadratic_motions_approximate_those_of_the_strains),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
