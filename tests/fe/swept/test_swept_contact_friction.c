/* Friction and damping of contact, in prescribed motion. */
#include "fe/swept/swept_contact.h"
#include "fe/swept/swept_private.h"

#include <float.h>

#include "tests/fe/swept/contacts.h"

#define WB_LOG_DOMAIN "test"

static const double origin[3] = {0.0, 0.0, 0.0};
static const double dt = 1e-6;

/* Friction force per length after a small motion of the first wire (it sticks): k_t times the slip
 * of its surface at the contact, opposed. */
static void check_stuck(const double move[3], const double turn[3], double turn_of_other)
{
    const double radius[2] = {0.7e-3, 0.5e-3}, k_t = 0.5 * 0.25e9, depth = 2e-6;
    const double arm[3] = {0.0, radius[0] - depth * 0.7 / 1.2, 0.0};
    const double other = -(radius[1] - depth * 0.5 / 1.2);
    struct wb_swept_contact_settings settings = contacts_settings();
    struct wb_swept_contact_point point;
    struct contacts c;
    double T[3][3], centre[3];

    contacts_make_pair(&c, &settings, radius, depth, 0.0, 0.0);
    contacts_step(&c, dt);
    /* All stations rotate about their own centres, as in a wire that bends or shears. */
    contacts_rotation(turn, T);
    for (int j = 0; j < c.n_stations; j++) {
        double twisted[3][3], R[3][3];
        contacts_rotation((double[3]){0.3, 0.0, 0.0}, twisted);
        for (int i = 0; i < 9; i++)
            R[i / 3][i % 3] = T[i / 3][0] * twisted[0][i % 3] + T[i / 3][1] * twisted[1][i % 3] +
                              T[i / 3][2] * twisted[2][i % 3];
        for (int i = 0; i < 3; i++)
            centre[i] = move[i] + (i == 0 ? c.spacing * j : 0.0);
        contacts_place(&c, 0, j, centre, R);
    }
    contacts_place_straight(&c, 1, (double[3]){0.0, 1.2e-3 - depth, 0.0}, -1.1 + turn_of_other);
    contacts_step(&c, dt);
    wb_swept_contact_get_point(c.contact, 0, 10, &point);
    const double slip[3] = {move[0] - turn[2] * arm[1], 0.0,
                            move[2] + turn[0] * arm[1] - turn_of_other * other};
    for (int i = 0; i < 3; i += 2)
        assert_close(point.friction[i], -k_t * slip[i], 5e-3);
    /* The line between the centres has rotated by up to 1.7e-4. */
    assert_close(point.friction[1], 0.0, 5e-3);
    contacts_release(&c);
}

static void friction_of_a_sticking_wire_follows_the_slip_of_its_surface(void **state)
{
    const double rest[3] = {0.0, 0.0, 0.0};

    (void)state;
    check_stuck((double[3]){1e-7, 0.0, 0.0}, rest, 0.0);
    check_stuck((double[3]){0.0, 0.0, 1e-7}, rest, 0.0);
    check_stuck(rest, (double[3]){1e-4, 0.0, 0.0}, 0.0);
    check_stuck(rest, (double[3]){0.0, 0.0, 1e-4}, 0.0);
    check_stuck(rest, (double[3]){0.0, 1e-4, 0.0}, 0.0);
    check_stuck(rest, rest, 1e-4);
    check_stuck((double[3]){1e-7, 0.0, -2e-7}, (double[3]){1e-4, 2e-4, -1e-4}, 5e-5);
    /* Two gear wheels. */
    check_stuck(rest, (double[3]){0.5e-4, 0.0, 0.0}, -0.7e-4);
}

/* Slips the second wire along by `amplitude` back and forth, and returns the work done on it. */
static double slip_to_and_fro(struct contacts *c, double amplitude, int cycles, int steps)
{
    const double height = 1.4e-3 - 2e-6;
    double work = 0.0, before = 0.0, x = 0.0;

    for (int n = 1; n <= cycles * 4 * steps; n++) {
        const double next = amplitude * asin(sin(0.5 * M_PI * n / steps)) / (0.5 * M_PI);
        double f[3], m[3];
        contacts_place_straight(c, 1, (double[3]){next, height, 0.0}, -1.1);
        contacts_step(c, dt);
        contacts_total(c, 1, origin, f, m);
        work += 0.5 * (before - f[0]) * (next - x);
        before = -f[0];
        x = next;
    }
    return work;
}

/* Elastic up to mu N / k_t, then sliding; checks the area of the loop. Work is stored or
 * dissipated, to round-off. */
static void friction_loops_have_coulombs_area(void **state)
{
    const double radius[2] = {0.7e-3, 0.7e-3}, depth = 2e-6, length = 20e-3, mu = 0.4;
    const double limit = mu * 0.25e9 * depth, reach = limit / (0.5 * 0.25e9);
    const double amplitude = 4.0 * reach;
    struct wb_swept_contact_settings settings = contacts_settings();
    struct contacts c;
    double f[3], m[3];

    (void)state;
    settings.friction.mu_static = settings.friction.mu_kinetic = mu;
    settings.refresh_interval = 1;
    contacts_make_pair(&c, &settings, radius, depth, 0.0, 0.0);
    contacts_step(&c, dt);
    /* One quarter: elastic over `reach`, then sliding. */
    for (int n = 1; n <= 100; n++) {
        contacts_place_straight(&c, 1, (double[3]){0.02 * reach * n, 1.4e-3 - depth, 0.0}, -1.1);
        contacts_step(&c, dt);
        contacts_total(&c, 1, origin, f, m);
        assert_close_relative(f[0], -limit * length * fmin(1.0, 0.02 * n), 3e-4);
    }
    wb_swept_contact_reset(c.contact);
    c.friction = 0.0;
    contacts_place_straight(&c, 1, (double[3]){0.0, 1.4e-3 - depth, 0.0}, -1.1);
    contacts_step(&c, dt);
    const double work = slip_to_and_fro(&c, amplitude, 3, 400);
    /* Slides from the middle to the first end, five times from end to end, and back to the
     * middle. */
    const double slid =
        (amplitude - reach) + 5.0 * 2.0 * (amplitude - reach) + (amplitude - 2.0 * reach);
    assert_close_relative(c.friction, limit * length * slid, 5e-4);
    assert_close(work, c.friction + c.energies.tangential, 1e-4 * work);
    assert_close(c.damping, 0.0, 1e-20);
    contacts_release(&c);
}

/* mu N at steady slip, along and across the wires. */
static void friction_decays_with_the_rate_of_slip(void **state)
{
    const double radius[2] = {0.7e-3, 0.7e-3}, depth = 2e-6, N = 0.25e9 * depth;
    static const double rates[] = {1e-9, 1e-4, 0.4e-3, 2e-3, 1.0};
    struct wb_swept_contact_settings settings = contacts_settings();

    (void)state;
    settings.friction.mu_static = 0.4;
    settings.friction.mu_kinetic = 0.1;
    settings.friction.decay = 2000.0;
    settings.refresh_interval = 1;
    for (size_t n = 0; n < 2 * sizeof rates / sizeof rates[0]; n++) {
        const double rate = rates[n / 2], slip = 5e-8;
        const bool across = n % 2 == 1;
        struct wb_swept_contact_point point;
        struct contacts c;
        contacts_make_pair(&c, &settings, radius, depth, 0.0, 0.0);
        for (int i = 0; i < 100; i++) {
            if (across)
                contacts_place_straight(&c, 1, (double[3]){0.0, 1.4e-3 - depth, 0.0},
                                        -1.1 + slip * i / (0.7e-3 - 0.5 * depth));
            else
                contacts_place_straight(&c, 1, (double[3]){slip * i, 1.4e-3 - depth, 0.0}, -1.1);
            contacts_step(&c, slip / rate);
        }
        wb_swept_contact_get_point(c.contact, 0, 10, &point);
        assert_close_relative(fabs(point.friction[across ? 2 : 0]) / N,
                              0.1 + 0.3 * exp(-2000.0 * rate), 1e-5);
        assert_close(point.friction[across ? 0 : 2], 0.0, 1e-6 * N);
        contacts_release(&c);
    }
}

/* The slip of a step, far below the last digit of a force in float, must accumulate. */
static void slow_slip_is_not_lost_in_float(void **state)
{
    const double radius[2] = {0.7e-3, 0.7e-3}, depth = 2e-6, height = 1.4e-3 - depth;
    struct wb_swept_contact_settings settings = contacts_settings();
    struct wb_swept_contact_point before, after;
    struct contacts c;

    (void)state;
    settings.double_precision = false;
    contacts_make_pair(&c, &settings, radius, depth, 0.0, 0.0);
    contacts_step(&c, dt);
    contacts_place_straight(&c, 1, (double[3]){1.2e-6, height, 0.0}, -1.1);
    contacts_step(&c, dt);
    wb_swept_contact_get_point(c.contact, 0, 10, &before);
    const int steps = 10000;
    for (int n = 1; n <= steps; n++) {
        contacts_place_straight(&c, 1, (double[3]){1.2e-6 - 1e-14 * n, height, 0.0}, -1.1);
        contacts_step(&c, dt);
    }
    wb_swept_contact_get_point(c.contact, 0, 10, &after);
    assert_true(1e-14 * 0.125e9 < 0.5 * (double)FLT_EPSILON * before.friction[0]);
    assert_close_relative(before.friction[0] - after.friction[0], 1e-14 * steps * 0.125e9, 0.01);
    contacts_release(&c);
}

/* k (depth + tau d(depth)/dt), never tensile; and its dissipation. */
static void damping_acts_on_approach_and_is_never_tensile(void **state)
{
    const double radius[2] = {0.7e-3, 0.7e-3}, tau = 1e-5, k = 0.25e9;
    static const double rates[] = {0.05, -0.05, -0.5};
    struct wb_swept_contact_settings settings = contacts_settings();

    (void)state;
    settings.damping_time = tau;
    for (int n = 0; n < 3; n++) {
        const double depth = 2e-6, closing = rates[n];
        struct contacts c;
        double f[3], m[3];
        contacts_make_pair(&c, &settings, radius, depth - closing * dt, 0.0, 0.0);
        contacts_step(&c, dt);
        contacts_place_straight(&c, 1, (double[3]){0.0, 1.4e-3 - depth, 0.0}, -1.1);
        contacts_step(&c, dt);
        contacts_total(&c, 1, origin, f, m);
        const double force = fmax(0.0, k * (depth + tau * closing));
        assert_close(f[1], force * 20e-3, 1e-6);
        assert_close_relative(c.energies.damping, (force - k * depth) * closing * dt * 20e-3, 1e-6);
        assert_true(c.energies.damping > 0.0);
        contacts_release(&c);
    }
}

static void separation_resets_friction(void **state)
{
    const double radius[2] = {0.7e-3, 0.7e-3}, near = 1.398e-3;
    struct wb_swept_contact_settings settings = contacts_settings();
    struct contacts c;
    double f[3], m[3];

    (void)state;
    settings.refresh_interval = 1;
    contacts_make_pair(&c, &settings, radius, 2e-6, 0.0, 0.0);
    contacts_step(&c, dt);
    contacts_place_straight(&c, 1, (double[3]){0.5e-6, near, 0.0}, -1.1);
    contacts_step(&c, dt);
    const double stored = c.energies.tangential;
    assert_true(stored > 0.0);
    contacts_place_straight(&c, 1, (double[3]){0.5e-6, 1.41e-3, 0.0}, -1.1);
    contacts_step(&c, dt);
    assert_close_relative(c.energies.friction, stored, 1e-9);
    contacts_place_straight(&c, 1, (double[3]){0.5e-6, near, 0.0}, -1.1);
    contacts_step(&c, dt);
    contacts_total(&c, 1, origin, f, m);
    assert_close(f[0], 0.0, 1e-9);
    assert_true(f[1] > 1.0);
    contacts_release(&c);
}

/* A spinning wire slides along almost without axial friction: its friction acts across. */
static void friction_opposes_the_slip_vector(void **state)
{
    const double radius[2] = {0.7e-3, 0.7e-3}, depth = 2e-6;
    const double slip[2] = {0.3, 0.4}; /* m/s along and across */
    struct wb_swept_contact_settings settings = contacts_settings();
    struct wb_swept_contact_point point;
    struct contacts c;

    (void)state;
    settings.refresh_interval = 1;
    contacts_init(&c, &settings, 2, radius, 21, 1e-3);
    contacts_place_straight(&c, 0, origin, 0.0);
    for (int n = 0; n < 100; n++) {
        contacts_place_straight(&c, 1, (double[3]){slip[0] * dt * n, 1.4e-3 - depth, 0.0},
                                slip[1] * dt * n / (0.7e-3 - 0.5 * depth));
        contacts_step(&c, dt);
    }
    wb_swept_contact_get_point(c.contact, 0, 10, &point);
    assert_close_relative(point.friction[0], 0.6 * 0.4 * 0.25e9 * depth, 1e-3);
    assert_close_relative(point.friction[2], -0.8 * 0.4 * 0.25e9 * depth, 1e-3);
    contacts_release(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(friction_of_a_sticking_wire_follows_the_slip_of_its_surface),
        cmocka_unit_test(friction_loops_have_coulombs_area),
        cmocka_unit_test(friction_decays_with_the_rate_of_slip),
        cmocka_unit_test(slow_slip_is_not_lost_in_float),
        cmocka_unit_test(damping_acts_on_approach_and_is_never_tensile),
        cmocka_unit_test(separation_resets_friction),
        cmocka_unit_test(friction_opposes_the_slip_vector),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
