#include "fe/solid/jacket_contact.h"

#include "tests/check.h"
#include "tests/fe/rod/wires.h"

enum {
    NODES = 8,
    ALL = WB_JACKET_CONTACT_UNKNOWNS,
    POINTS = WB_JACKET_CONTACT_POINTS
};

static const struct wb_jacket_contact_law law = {4e11, 1.5e11, 0.3};

/* A face pair, its history and the results of an evaluation. */
struct contact {
    double X[2 * NODES][3], u[ALL];
    struct wb_jacket_contact_state before[POINTS], after[POINTS];
    double force[ALL], tangent[ALL * ALL];
    struct wb_jacket_contact_result result;
};

static const double corner[NODES][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1},
                                        {0, -1},  {1, 0},  {0, 1}, {-1, 0}};

/* Rectangle of 2 a x 2 b in the plane y, z, its normal along x. */
static void make_flat(struct contact *contact, double a, double b)
{
    memset(contact, 0, sizeof *contact);
    for (int k = 0; k < 2 * NODES; k++) {
        contact->X[k][1] = a * corner[k % NODES][0];
        contact->X[k][2] = b * corner[k % NODES][1];
    }
}

/* Sector of +-angle of a cylinder about z, 2 b long, normal outwards (along x in its middle); if
 * `distorted` with randomly moved nodes. */
static void make_curved(struct contact *contact, double radius, double angle, double b,
                        double distorted)
{
    uint64_t random = 99;
    memset(contact, 0, sizeof *contact);
    for (int k = 0; k < NODES; k++) {
        const double t = angle * corner[k][0];
        contact->X[k][0] = radius * cos(t);
        contact->X[k][1] = radius * sin(t);
        contact->X[k][2] = b * corner[k][1];
        for (int c = 0; c < 3; c++)
            contact->X[k][c] += distorted * (test_random(&random) - 0.5);
        memcpy(contact->X[NODES + k], contact->X[k], sizeof contact->X[k]);
    }
}

/* Rotation about an axis by an angle (Rodrigues). */
static void make_rotation(const double axis[3], double angle, double R[3][3])
{
    const double n = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    const double c = cos(angle), s = sin(angle);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            R[i][j] = (1.0 - c) * axis[i] * axis[j] / (n * n) + (i == j ? c : 0.0);
        R[i][(i + 2) % 3] += s * axis[(i + 1) % 3] / n;
        R[i][(i + 1) % 3] -= s * axis[(i + 2) % 3] / n;
    }
}

static void turn(const double R[3][3], const double *v, double *turned)
{
    for (int i = 0; i < 3; i++)
        turned[i] = R[i][0] * v[0] + R[i][1] * v[1] + R[i][2] * v[2];
}

/* Sets u to that of the deformed faces, rotated and translated as a rigid body. */
static void turn_faces(struct contact *contact, const double R[3][3], double moved)
{
    for (int k = 0; k < 2 * NODES; k++) {
        double x[3], turned[3];
        for (int c = 0; c < 3; c++)
            x[c] = contact->X[k][c] + contact->u[3 * k + c];
        turn(R, x, turned);
        for (int c = 0; c < 3; c++)
            contact->u[3 * k + c] = turned[c] + moved - contact->X[k][c];
    }
}

/* Moves the outer face along a vector. */
static void move_outer(struct contact *contact, double x, double y, double z)
{
    const double step[3] = {x, y, z};
    for (int i = 0; i < 3 * NODES; i++)
        contact->u[3 * NODES + i] += step[i % 3];
}

static void shake(struct contact *contact, double size, uint64_t seed)
{
    for (int i = 0; i < ALL; i++)
        contact->u[i] += size * (test_random(&seed) - 0.5);
}

static void evaluate_with(struct contact *contact, const struct wb_jacket_contact_law *its)
{
    wb_jacket_contact_evaluate(its, (const double(*)[3])contact->X, contact->u, contact->before,
                               contact->after, contact->force, contact->tangent, &contact->result);
}

static void evaluate(struct contact *contact)
{
    evaluate_with(contact, &law);
}

static void accept_step(struct contact *contact)
{
    memcpy(contact->before, contact->after, sizeof contact->before);
}

/* Sum of the forces on the outer face (or, from 0, on the inner one). */
static void sum_forces(const struct contact *contact, int from, double sum[3])
{
    memset(sum, 0, 3 * sizeof *sum);
    for (int i = 0; i < 3 * NODES; i++)
        sum[i % 3] += contact->force[3 * from + i];
}

/* --- pressure --- */

static void pressure_is_stiffness_times_penetration(void **unused)
{
    (void)unused;
    /* A flat face, inclined: exactly uniform pressure. */
    const double axis[3] = {0.3, -1.0, 0.4}, a = 0.4e-3, b = 0.7e-3, depth = 2e-6;
    struct contact contact;
    double R[3][3], normal[3], sum[3];
    make_flat(&contact, a, b);
    make_rotation(axis, 0.9, R);
    for (int k = 0; k < 2 * NODES; k++) {
        double turned[3];
        turn((const double(*)[3])R, contact.X[k], turned);
        memcpy(contact.X[k], turned, sizeof turned);
    }
    for (int c = 0; c < 3; c++)
        normal[c] = R[c][0];
    move_outer(&contact, -depth * normal[0], -depth * normal[1], -depth * normal[2]);
    evaluate(&contact);
    sum_forces(&contact, NODES, sum);
    for (int c = 0; c < 3; c++)
        assert_close(sum[c], -law.normal_stiffness * depth * 4.0 * a * b * normal[c], 1e-12);
    assert_close_relative(contact.result.pressure, law.normal_stiffness * depth, 1e-12);
    assert_close_relative(contact.result.penetration, depth, 1e-12);
    assert_close_relative(contact.result.stored,
                          0.5 * law.normal_stiffness * depth * depth * 4.0 * a * b, 1e-12);
    assert_int_equal(contact.result.touching, POINTS);
    assert_int_equal(contact.result.slipping, 0);
    assert_true(contact.result.opening == 0.0 && contact.result.dissipated == 0.0);
}

static void curved_face_carries_pressure_over_its_projection(void **unused)
{
    (void)unused;
    /* Radial penetration of a cylinder's sector: the force is the pressure times the projected
     * area, to the accuracy of quadratic interpolation. */
    const double radius = 1.63e-3, b = 0.8e-3, depth = 1e-6;
    double error[2];
    for (int half = 0; half < 2; half++) {
        const double angle = half ? 0.125 * M_PI : 0.25 * M_PI;
        struct contact contact;
        double sum[3];
        make_curved(&contact, radius, angle, b, 0.0);
        for (int k = 0; k < NODES; k++) {
            contact.u[3 * (NODES + k)] = -depth * contact.X[k][0] / radius;
            contact.u[3 * (NODES + k) + 1] = -depth * contact.X[k][1] / radius;
        }
        evaluate(&contact);
        sum_forces(&contact, NODES, sum);
        const double expected = -law.normal_stiffness * depth * 2.0 * radius * sin(angle) * 2.0 * b;
        error[half] = fabs(sum[0] / expected - 1.0);
        assert_close(sum[1], 0.0, 1e-12);
        assert_close(sum[2], 0.0, 1e-12);
    }
    assert_true(error[0] < 1e-2);
    assert_true(error[1] < error[0] / 12.0); /* fourth order: 16 */
}

static void opening_carries_nothing_and_resets_friction(void **unused)
{
    (void)unused;
    struct contact contact;
    make_flat(&contact, 0.5e-3, 0.5e-3);
    move_outer(&contact, -1e-6, 0.5e-6, 0.0);
    evaluate(&contact);
    assert_int_equal(contact.result.touching, POINTS);
    assert_true(contact.after[4].traction[0] > 0.0);
    accept_step(&contact);

    move_outer(&contact, 1.5e-6, 0.0, 0.0);
    evaluate(&contact);
    for (int i = 0; i < ALL; i++)
        assert_true(contact.force[i] == 0.0);
    for (int i = 0; i < ALL * ALL; i++)
        assert_true(contact.tangent[i] == 0.0);
    assert_int_equal(contact.result.touching, 0);
    assert_close(contact.result.opening, 0.5e-6, 1e-18);
    assert_true(contact.result.stored == 0.0);
    accept_step(&contact);

    /* Moved while open, and closed again: no shear, although far from the initial position. */
    move_outer(&contact, 0.0, 30e-6, -12e-6);
    evaluate(&contact);
    accept_step(&contact);
    move_outer(&contact, -2e-6, 0.0, 0.0);
    evaluate(&contact);
    for (int p = 0; p < POINTS; p++) {
        assert_close(contact.after[p].traction[0], 0.0, 1e-3);
        assert_close(contact.after[p].traction[1], 0.0, 1e-3);
        assert_true(contact.after[p].slip == 0.0);
    }
    assert_close_relative(contact.result.pressure, law.normal_stiffness * 1.5e-6, 1e-9);
}

static void nothing_adheres(void **unused)
{
    (void)unused;
    struct contact contact;
    double sum[3];
    make_flat(&contact, 0.5e-3, 0.5e-3);
    const double gaps[] = {-4e-6, -1e-9, -1e-15, 1e-15, 1e-9, 4e-6, -1e-12, 1e-12};
    for (size_t i = 0; i < sizeof gaps / sizeof gaps[0]; i++) {
        const double gap = gaps[i];
        memset(contact.u, 0, sizeof contact.u);
        move_outer(&contact, gap, 0.0, 0.0);
        evaluate(&contact);
        sum_forces(&contact, NODES, sum);
        assert_true(gap > 0.0 ? sum[0] == 0.0 : sum[0] < 0.0); /* pushed by the inner one */
        accept_step(&contact);
    }
}

/* --- friction --- */

static void shear_sticks_below_the_bound_and_slips_at_it(void **unused)
{
    (void)unused;
    const double area = 1e-6, depth = 2e-6, pressure = law.normal_stiffness * depth;
    const double limit = law.friction * pressure / law.tangential_stiffness;
    const double way[2] = {0.8, -0.6};
    struct contact contact;
    double sum[3];
    make_flat(&contact, 0.5e-3, 0.5e-3);
    move_outer(&contact, -depth, 0.0, 0.0);
    evaluate(&contact);
    accept_step(&contact);

    move_outer(&contact, 0.0, 0.99 * limit * way[0], 0.99 * limit * way[1]);
    evaluate(&contact);
    sum_forces(&contact, NODES, sum);
    for (int c = 0; c < 2; c++)
        assert_close(sum[1 + c], 0.99 * law.friction * pressure * area * way[c], 1e-12);
    assert_true(contact.result.slip == 0.0 && contact.result.dissipated == 0.0);
    assert_int_equal(contact.result.slipping, 0);

    move_outer(&contact, 0.0, 4.01 * limit * way[0], 4.01 * limit * way[1]);
    evaluate(&contact);
    sum_forces(&contact, NODES, sum);
    for (int c = 0; c < 2; c++)
        assert_close(sum[1 + c], law.friction * pressure * area * way[c], 1e-12);
    assert_int_equal(contact.result.slipping, POINTS);
    assert_close_relative(contact.result.slip, 4.0 * limit, 1e-9);
    assert_close_relative(contact.result.dissipated, law.friction * pressure * area * 4.0 * limit,
                          1e-9);

    /* With more pressure the same face sticks again. */
    accept_step(&contact);
    move_outer(&contact, -depth, 0.5 * limit * way[0], 0.5 * limit * way[1]);
    evaluate(&contact);
    assert_int_equal(contact.result.slipping, 0);
    sum_forces(&contact, NODES, sum);
    assert_close(hypot(sum[1], sum[2]), 1.5 * law.friction * pressure * area, 1e-12);
}

static void frictionless_face_carries_no_shear(void **unused)
{
    (void)unused;
    const struct wb_jacket_contact_law smooth = {4e11, 1.5e11, 0.0};
    struct contact contact;
    double sum[3];
    make_flat(&contact, 0.5e-3, 0.5e-3);
    move_outer(&contact, -1e-6, 3e-6, 4e-6);
    evaluate_with(&contact, &smooth);
    sum_forces(&contact, NODES, sum);
    assert_close(sum[0], -0.4, 1e-12);
    assert_close(sum[1], 0.0, 1e-12);
    assert_close(sum[2], 0.0, 1e-12);
    assert_close_relative(contact.result.slip, 5e-6, 1e-12);
    assert_true(contact.result.dissipated == 0.0);

    /* A face that just touches does not stick either. */
    make_flat(&contact, 0.5e-3, 0.5e-3);
    evaluate_with(&contact, &smooth);
    for (int i = 0; i < ALL; i++) {
        for (int j = 0; j < ALL; j++)
            assert_true(i % 3 == 0 || contact.tangent[ALL * i + j] == 0.0);
    }
    assert_int_equal(contact.result.touching, POINTS);
}

/* Work of the forces over a closed path with slip is the friction work. */
static void hysteresis_loop_encloses_the_dissipated_energy(void **unused)
{
    (void)unused;
    const double area = 1e-6, depth = 2e-6, amplitude = 10e-6;
    const double bound = law.friction * law.normal_stiffness * depth * area;
    const double limit = law.friction * law.normal_stiffness * depth / law.tangential_stiffness;
    enum {
        STEPS = 400
    };
    struct contact contact;
    double work = 0.0, dissipated = 0.0, last = 0.0, sum[3];
    int reversed = 0;
    make_flat(&contact, 0.5e-3, 0.5e-3);
    move_outer(&contact, -depth, amplitude, 0.0);
    evaluate(&contact);
    accept_step(&contact);
    sum_forces(&contact, NODES, sum);
    last = sum[1];
    assert_close_relative(last, bound, 1e-9);
    for (int i = 0; i < 2 * STEPS; i++) { /* to minus the amplitude and back */
        const double step = (i < STEPS ? -2.0 : 2.0) * amplitude / STEPS;
        move_outer(&contact, 0.0, step, 0.0);
        evaluate(&contact);
        sum_forces(&contact, NODES, sum);
        work += 0.5 * (sum[1] + last) * step;
        dissipated += contact.result.dissipated;
        last = sum[1];
        reversed += i < STEPS && contact.result.slipping == 0;
        accept_step(&contact);
    }
    /* Two slides at the limit, each over the stroke minus the elastic reversal. */
    const double expected = 2.0 * bound * (2.0 * amplitude - 2.0 * limit);
    assert_close_relative(dissipated, expected, 1e-9);
    assert_close_relative(work, expected, 1e-4);
    assert_close(reversed, 2.0 * limit / (2.0 * amplitude / STEPS), 1.0);
    assert_close_relative(contact.result.slip, (amplitude - limit) + 4.0 * (amplitude - limit),
                          1e-9);
}

/* A block on a slope, with the outer face moving as a rigid body: with the tangent summed over the
 * face Newton's method finds equilibrium only below the angle of friction. */
static void block_rests_on_a_slope_up_to_the_angle_of_friction(void **unused)
{
    (void)unused;
    const double weight = 0.5;
    for (int k = 0; k < 4; k++) {
        const double slope = atan(law.friction) * (k < 2 ? 0.5 + 0.49 * k : 1.01 + 0.3 * (k - 2));
        const double load[3] = {-weight * cos(slope), weight * sin(slope), 0.0};
        struct contact contact;
        bool rests = false;
        make_flat(&contact, 0.5e-3, 0.5e-3);
        for (int i = 0; i < 20 && !rests; i++) {
            double K[9] = {0.0}, r[3], scale = 0.0;
            evaluate(&contact);
            sum_forces(&contact, NODES, r);
            for (int c = 0; c < 3; c++) {
                r[c] = load[c] - r[c];
                scale = fmax(scale, fabs(r[c]));
            }
            rests = scale < 1e-10 * weight;
            for (int row = 0; row < 3 * NODES; row++) {
                for (int c = 0; c < 3 * NODES; c++)
                    K[3 * (row % 3) + c % 3] +=
                        contact.tangent[ALL * (3 * NODES + row) + 3 * NODES + c];
            }
            /* Unknown z stays; two equations. */
            const double det = K[0] * K[4] - K[1] * K[3];
            if (rests || det == 0.0)
                break;
            move_outer(&contact, (K[4] * r[0] - K[1] * r[1]) / det,
                       (K[0] * r[1] - K[3] * r[0]) / det, 0.0);
        }
        assert_int_equal(rests, k < 2);
        if (rests) {
            assert_true(contact.result.slip == 0.0);
            assert_close_relative(contact.result.pressure, weight * cos(slope) / 1e-6, 1e-9);
        }
    }
}

/* --- frames --- */

static void rigid_rotation_only_rotates_the_forces(void **unused)
{
    (void)unused;
    const double axes[3][3] = {{0, 0, 1}, {1, 0, 0}, {0.3, -0.8, 0.5}};
    for (int a = 0; a < 3; a++) {
        for (int by = 1; by < 4; by++) { /* 90, 180, 270 degrees */
            struct contact still, turned;
            double R[3][3];
            make_rotation(axes[a], 0.5 * M_PI * by, R);

            /* Virgin faces rotated together: no force. */
            make_curved(&turned, 1.63e-3, 0.4, 0.8e-3, 0.1e-3);
            turn_faces(&turned, (const double(*)[3])R, 3e-3);
            evaluate(&turned);
            for (int i = 0; i < ALL; i++)
                assert_close(turned.force[i], 0.0, 1e-12);

            /* A step with partial slip, then rotated: the same histories, rotated forces. */
            make_curved(&still, 1.63e-3, 0.4, 0.8e-3, 0.1e-3);
            move_outer(&still, -1.5e-6, 0.8e-6, 0.0);
            shake(&still, 0.5e-6, 7);
            evaluate(&still);
            accept_step(&still);
            shake(&still, 2e-6, 8);
            evaluate(&still);
            assert_in_range(still.result.slipping, 1, POINTS);
            turned = still;
            turn_faces(&turned, (const double(*)[3])R, -2e-3);
            evaluate(&turned);
            for (int p = 0; p < POINTS; p++) {
                for (int c = 0; c < 2; c++) {
                    assert_close(turned.after[p].traction[c], still.after[p].traction[c], 1e-2);
                    assert_close(turned.after[p].gap[c], still.after[p].gap[c], 1e-16);
                }
                assert_close(turned.after[p].slip, still.after[p].slip, 1e-16);
            }
            for (int k = 0; k < 2 * NODES; k++) {
                double expected[3];
                turn((const double(*)[3])R, still.force + 3 * k, expected);
                for (int c = 0; c < 3; c++)
                    assert_close(turned.force[3 * k + c], expected[c], 1e-8);
            }
        }
    }
}

/* Traction rotates with the face's frame: shear along the wire stays so after a rotation by 90
 * degrees, and further slip adds to it as without the rotation. */
static void friction_continues_in_the_rotated_frame(void **unused)
{
    (void)unused;
    const double z[3] = {0, 0, 1}, depth = 2e-6;
    const double limit = law.friction * law.normal_stiffness * depth / law.tangential_stiffness;
    struct contact contact;
    double R[3][3], sum[3];
    make_flat(&contact, 0.5e-3, 0.5e-3);
    move_outer(&contact, -depth, 0.6 * limit, 0.0);
    evaluate(&contact);
    accept_step(&contact);
    make_rotation(z, 0.5 * M_PI, R);
    turn_faces(&contact, (const double(*)[3])R, 0.0);
    evaluate(&contact);
    assert_int_equal(contact.result.slipping, 0);
    accept_step(&contact);
    move_outer(&contact, -0.3 * limit, 0.0, 0.0); /* y became -x, the normal x became y */
    evaluate(&contact);
    sum_forces(&contact, NODES, sum);
    assert_close(sum[0], -0.9 * law.tangential_stiffness * limit * 1e-6, 1e-10);
    assert_close(sum[1], -law.normal_stiffness * depth * 1e-6, 1e-10);
    assert_int_equal(contact.result.slipping, 0);
}

static void both_faces_have_equal_forces_and_moments(void **unused)
{
    (void)unused;
    struct contact contact;
    const double axis[3] = {0.3, -0.8, 0.5};
    double R[3][3], largest = 0.0;
    make_curved(&contact, 1.63e-3, 0.4, 0.8e-3, 0.1e-3);
    make_rotation(axis, 1.1, R);
    move_outer(&contact, -3e-6, 20e-6, -9e-6);
    shake(&contact, 2e-6, 4);
    turn_faces(&contact, (const double(*)[3])R, 1e-3);
    evaluate(&contact);
    assert_in_range(contact.result.slipping, 1, POINTS);

    double force[3] = {0.0}, moment[3] = {0.0};
    for (int k = 0; k < 2 * NODES; k++) {
        const double *f = contact.force + 3 * k;
        double x[3];
        for (int c = 0; c < 3; c++) {
            x[c] = contact.X[k][c] + contact.u[3 * k + c];
            force[c] += f[c];
            largest = fmax(largest, fabs(f[c]));
        }
        for (int c = 0; c < 3; c++)
            moment[c] += x[(c + 1) % 3] * f[(c + 2) % 3] - x[(c + 2) % 3] * f[(c + 1) % 3];
    }
    assert_true(largest > 0.1);
    for (int c = 0; c < 3; c++) {
        assert_close(force[c], 0.0, 1e-13 * largest);
        assert_close(moment[c], 0.0, 1e-13 * largest * 2e-3);
    }
}

/* --- tangent --- */

/* Comparison with central differences of the forces. */
static void check_tangent(struct contact *contact)
{
    const double step = 2e-10;
    static double tangent[ALL * ALL];
    double largest = 0.0;
    evaluate(contact);
    memcpy(tangent, contact->tangent, sizeof tangent);
    for (int i = 0; i < ALL * ALL; i++)
        largest = fmax(largest, fabs(tangent[i]));
    assert_true(largest > 0.0);
    for (int j = 0; j < ALL; j++) {
        double plus[ALL];
        struct wb_jacket_contact_state after[POINTS];
        struct wb_jacket_contact_result result;
        const double u = contact->u[j];
        contact->u[j] = u + step;
        wb_jacket_contact_evaluate(&law, (const double(*)[3])contact->X, contact->u,
                                   contact->before, after, plus, NULL, &result);
        contact->u[j] = u - step;
        wb_jacket_contact_evaluate(&law, (const double(*)[3])contact->X, contact->u,
                                   contact->before, after, contact->force, NULL, &result);
        contact->u[j] = u;
        for (int i = 0; i < ALL; i++)
            assert_close((plus[i] - contact->force[i]) / (2.0 * step), tangent[ALL * i + j],
                         3e-7 * largest);
    }
}

static double asymmetry(const struct contact *contact)
{
    double largest = 0.0, difference = 0.0;
    for (int i = 0; i < ALL; i++) {
        for (int j = 0; j < ALL; j++) {
            const double a = contact->tangent[ALL * i + j], b = contact->tangent[ALL * j + i];
            largest = fmax(largest, fabs(a));
            difference = fmax(difference, fabs(a - b));
        }
    }
    return difference / largest;
}

static void tangent_is_the_derivative_of_the_forces(void **unused)
{
    (void)unused;
    const double axis[3] = {0.3, -0.8, 0.5};
    for (int turned = 0; turned < 2; turned++) {
        struct contact contact;
        double R[3][3];
        make_curved(&contact, 1.63e-3, 0.4, 0.8e-3, 0.1e-3);
        make_rotation(axis, turned ? 2.2 : 0.0, R);
        turn_faces(&contact, (const double(*)[3])R, 0.0);
        shake(&contact, turned ? 100e-6 : 0.0, 3); /* large strains of the faces, together ... */
        for (int i = 0; i < 3 * NODES; i++)
            contact.u[3 * NODES + i] = contact.u[i];
        const double *n = (const double[3]){R[0][0], R[1][0], R[2][0]};

        /* sticking */
        move_outer(&contact, -4e-6 * n[0], -4e-6 * n[1], -4e-6 * n[2]);
        shake(&contact, 1e-6, 5);
        check_tangent(&contact);
        evaluate(&contact);
        assert_int_equal(contact.result.touching, POINTS);
        assert_int_equal(contact.result.slipping, 0);
        assert_true(asymmetry(&contact) < 1e-12); /* the springs have a potential */
        accept_step(&contact);

        /* slipping along the cylinder */
        move_outer(&contact, 20e-6 * R[0][2], 20e-6 * R[1][2], 20e-6 * R[2][2]);
        shake(&contact, 1e-6, 6);
        check_tangent(&contact);
        evaluate(&contact);
        assert_int_equal(contact.result.slipping, POINTS);
        assert_true(asymmetry(&contact) > 1e-3);
        accept_step(&contact);

        /* reversed: some stick, some slip, some open */
        for (int k = 0; k < NODES; k++) {
            for (int c = 0; c < 3; c++)
                contact.u[3 * (NODES + k) + c] +=
                    4.4e-6 * corner[k][1] * n[c] - 3e-6 * R[c][2] - 1e-6 * corner[k][0] * R[c][2];
        }
        check_tangent(&contact);
        evaluate(&contact);
        assert_in_range(contact.result.slipping, 1, POINTS - 1);
        assert_in_range(contact.result.touching, contact.result.slipping + 1, POINTS - 1);
    }
}

/* The forces of sticking and pressing are the derivative of the stored energy. */
static void sticking_forces_have_a_potential(void **unused)
{
    (void)unused;
    const double step = 1e-9;
    struct contact contact;
    make_curved(&contact, 1.63e-3, 0.4, 0.8e-3, 0.1e-3);
    move_outer(&contact, -4e-6, 0.5e-6, 0.3e-6);
    shake(&contact, 1e-6, 5);
    evaluate(&contact);
    assert_int_equal(contact.result.slipping, 0);
    double force[ALL], largest = 0.0;
    memcpy(force, contact.force, sizeof force);
    for (int i = 0; i < ALL; i++)
        largest = fmax(largest, fabs(force[i]));
    for (int i = 0; i < ALL; i++) {
        const double u = contact.u[i];
        contact.u[i] = u + step;
        evaluate(&contact);
        const double plus = contact.result.stored;
        contact.u[i] = u - step;
        evaluate(&contact);
        contact.u[i] = u;
        assert_close((plus - contact.result.stored) / (2.0 * step), force[i], 1e-7 * largest);
    }
}

/* --- invalid input and defaults --- */

static void nan_input_gives_nan_output(void **unused)
{
    (void)unused;
    const double bad[] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
    for (int b = 0; b < 3; b++) {
        for (int i = 0; i < ALL; i++) {
            struct contact contact;
            bool shows = false;
            make_flat(&contact, 0.5e-3, 0.5e-3);
            move_outer(&contact, 1e-6, 0.0, 0.0); /* open */
            contact.u[i] = bad[b];
            evaluate(&contact);
            for (int k = 0; k < ALL; k++)
                shows = shows || !isfinite(contact.force[k]);
            assert_true(shows && (b > 0 || isnan(contact.result.penetration)));
        }
    }
}

static void history_may_be_updated_in_place(void **unused)
{
    (void)unused;
    struct contact apart, in_place;
    make_curved(&apart, 1.63e-3, 0.4, 0.8e-3, 0.0);
    move_outer(&apart, -1.5e-6, 0.8e-6, 0.0);
    evaluate(&apart);
    accept_step(&apart);
    shake(&apart, 2e-6, 8);
    in_place = apart;
    evaluate(&apart);
    wb_jacket_contact_evaluate(&law, (const double(*)[3])in_place.X, in_place.u, in_place.before,
                               in_place.before, in_place.force, NULL, &in_place.result);
    assert_memory_equal(in_place.before, apart.after, sizeof apart.after);
    assert_memory_equal(in_place.force, apart.force, sizeof apart.force);
}

static void default_law_is_as_stiff_as_the_layer(void **unused)
{
    (void)unused;
    /* A laterally constrained layer of PVC, 0.8 mm thick: a pressure p compresses it by p h / M. */
    struct wb_jacket_contact_law its;
    wb_trial_default_jacket_contact(&its, 41e6, 0.43, 0.8e-3, 0.1);
    const double bulk = 41e6 / (3.0 * (1.0 - 0.86)), shear = 41e6 / (2.0 * 1.43);
    const double thinner = 0.8e-3 * 1e6 / (bulk + 4.0 * shear / 3.0);
    assert_close_relative(1e6 / its.normal_stiffness, thinner, 1e-12);
    assert_close_relative(its.tangential_stiffness, its.normal_stiffness / 3.0, 1e-12);
    assert_true(its.friction == 0.1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pressure_is_stiffness_times_penetration),
        cmocka_unit_test(curved_face_carries_pressure_over_its_projection),
        cmocka_unit_test(opening_carries_nothing_and_resets_friction),
        cmocka_unit_test(nothing_adheres),
        cmocka_unit_test(shear_sticks_below_the_bound_and_slips_at_it),
        cmocka_unit_test(frictionless_face_carries_no_shear),
        cmocka_unit_test(hysteresis_loop_encloses_the_dissipated_energy),
        cmocka_unit_test(block_rests_on_a_slope_up_to_the_angle_of_friction),
        cmocka_unit_test(rigid_rotation_only_rotates_the_forces),
        cmocka_unit_test(friction_continues_in_the_rotated_frame),
        cmocka_unit_test(both_faces_have_equal_forces_and_moments),
        cmocka_unit_test(tangent_is_the_derivative_of_the_forces),
        cmocka_unit_test(sticking_forces_have_a_potential),
        cmocka_unit_test(nan_input_gives_nan_output),
        cmocka_unit_test(history_may_be_updated_in_place),
        cmocka_unit_test(default_law_is_as_stiff_as_the_layer),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
