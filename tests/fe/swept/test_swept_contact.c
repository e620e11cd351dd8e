#include "fe/swept/swept_contact.h"
#include "fe/swept/swept_private.h"

#include "tests/fe/swept/contacts.h"

#define WB_LOG_DOMAIN "test"

static const double origin[3] = {0.0, 0.0, 0.0};
static const double dt = 1e-6;

static uint64_t seed = 1;

static double random_number(void)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(seed >> 11) * 0x1p-52 - 1.0;
}

static void unit_vector(double v[3])
{
    double size = 0.0;
    for (int i = 0; i < 3; i++) {
        v[i] = random_number();
        size += v[i] * v[i];
    }
    for (int i = 0; i < 3; i++)
        v[i] /= sqrt(size);
}

static void parallel_wires_press_with_stiffness_times_depth(void **state)
{
    const double radius[2] = {0.7e-3, 0.5e-3}, depth = 2e-6, angle = 0.6;
    const double k = 0.25 * 1e9, length = 20e-3;
    struct wb_swept_contact_settings settings = contacts_settings();
    struct contacts c;
    double f[2][3], moment[3];

    (void)state;
    contacts_make_pair(&c, &settings, radius, depth, angle, 0.0);
    contacts_step(&c, dt);
    for (int w = 0; w < 2; w++)
        contacts_total(&c, w, origin, f[w], moment);
    assert_close(f[1][1], k * depth * length * cos(angle), 1e-9);
    assert_close(f[1][2], k * depth * length * sin(angle), 1e-9);
    assert_close(f[1][0], 0.0, 1e-12);
    for (int i = 0; i < 3; i++)
        assert_close(f[0][i] + f[1][i], 0.0, 1e-14);
    assert_close_relative(c.energies.normal, 0.5 * k * depth * depth * length, 1e-9);
    assert_close_relative(c.energies.deepest, depth, 1e-9);
    assert_close(c.energies.tangential, 0.0, 1e-20);
    struct contacts_pair pair;
    assert_int_equal(wb_swept_contact_pairs(c.contact), 1);
    pair = contacts_pair(&c, 0);
    assert_close_relative(pair.stiffness, k, 1e-14);
    assert_close_relative(pair.normal, k * depth * length, 1e-9);
    assert_close_relative(pair.smallest, -depth, 1e-9);
    contacts_release(&c);
}

/* Two like cylinders, pressed by P per length, in plane strain (K. L. Johnson, Contact Mechanics,
 * 1985, section 5.6): half width b, approach of their axes
 *
 *     b^2 = 4 P R (1 - nu^2) / (pi E),  delta = 2 P (1 - nu^2) / (pi E) (2 ln(4 R / b) - 1).
 */
static double hertz_approach(double load, double R, double E, double nu)
{
    const double soft = (1.0 - nu * nu) / (M_PI * E);
    const double b = sqrt(4.0 * load * R * soft);
    return 2.0 * load * soft * (2.0 * log(4.0 * R / b) - 1.0);
}

/* The constant stiffness approximates Hertz's, which increases slowly with the load: equal at 3e-3
 * E R (10 N/mm between wires of type 3), 1.6 times as stiff at a hundredth of that load. */
static void stiffness_is_about_that_of_hertz_line_contact(void **state)
{
    const double E = 1e9, nu = 0.39, radius[2] = {0.7e-3, 0.7e-3};
    struct wb_swept_contact_settings settings = contacts_settings();
    double ratio[5];

    (void)state;
    for (int i = 0; i < 5; i++) {
        const double load = 3e-3 * pow(10.0, -0.5 * i) * E * radius[0];
        const double depth = hertz_approach(load, radius[0], E, nu);
        struct contacts c;
        struct wb_swept_contact_point point;
        contacts_make_pair(&c, &settings, radius, depth, 0.6, 0.0);
        contacts_step(&c, dt);
        wb_swept_contact_get_point(c.contact, 0, 10, &point);
        ratio[i] = point.normal / load;
        print_message("load %.1e E R: approach %.1e R, force over Hertz's %.2f\n",
                      load / (E * radius[0]), depth / radius[0], ratio[i]);
        contacts_release(&c);
    }
    assert_close(ratio[0], 1.0, 0.03);
    for (int i = 1; i < 5; i++)
        assert_true(ratio[i] > ratio[i - 1] && ratio[i] < 1.7);
}

/* Trapezoidal rule: inner stations have half a station more on either side. */
static void stations_at_the_ends_weigh_half(void **state)
{
    const double radius[2] = {0.7e-3, 0.7e-3}, depth = 1e-6;
    struct wb_swept_contact_settings settings = contacts_settings();
    struct contacts c;
    double end[3], inner[3], moment[3];

    (void)state;
    contacts_make_pair(&c, &settings, radius, depth, 0.0, 0.0);
    contacts_step(&c, dt);
    for (int last = 0; last < 2; last++) {
        contacts_wrench(&c, 0, last ? 20 : 0, origin, end, moment);
        contacts_wrench(&c, 0, last ? 19 : 1, origin, inner, moment);
        assert_close_relative(inner[1], -0.25e9 * depth * 1e-3, 1e-9);
        assert_close_relative(end[1], 0.5 * inner[1], 1e-12);
    }
    contacts_release(&c);
}

/* Wires shifted along each other press only over their common length, and at its position: the
 * moment is also checked. */
static void slipped_wires_press_over_their_common_length(void **state)
{
    const double radius[2] = {0.7e-3, 0.7e-3}, depth = 1e-6, p = 0.25e9 * depth;
    static const double shifts[] = {0.0, 0.2e-3, 0.5e-3, 1.0e-3, 2.3e-3, -3.9e-3};
    struct wb_swept_contact_settings settings = contacts_settings();

    (void)state;
    for (size_t i = 0; i < sizeof shifts / sizeof shifts[0]; i++) {
        struct contacts c;
        double f[3], m[3];
        contacts_make_pair(&c, &settings, radius, depth, 0.0, shifts[i]);
        contacts_step(&c, dt);
        contacts_total(&c, 0, origin, f, m);
        const double common = 20e-3 - fabs(shifts[i]);
        const double middle = 10e-3 + 0.5 * shifts[i];
        assert_close_relative(f[1], -p * common, 1e-8);
        /* Cells at the ends press at their ends instead of their middles: an error below a quarter
         * of a cell. */
        assert_close(m[2] / f[1], middle, 0.25e-3 * 1e-3 / common + 1e-9);
        contacts_total(&c, 1, origin, f, m);
        assert_close(m[2] / f[1], middle, 0.25e-3 * 1e-3 / common + 1e-9);
        contacts_release(&c);
    }
}

/* A bundle bent into an arc: chords cut corners on both wires equally. A wire's station relative to
 * the other's chord would have an error of the chord's height h^2/8R = 2 um; here the gap only has
 * the difference for the two bend radii. */
static void chords_of_bent_wires_do_not_affect_the_gap(void **state)
{
    const double radius[2] = {0.7e-3, 0.7e-3}, R = 60e-3, depth = 1e-6, h = 1e-3;
    const double arm[2] = {0.0, 1.4e-3 - depth};
    struct wb_swept_contact_settings settings = contacts_settings();
    struct contacts c;

    (void)state;
    contacts_init(&c, &settings, 2, radius, 21, h);
    for (int w = 0; w < 2; w++) {
        for (int j = 0; j < 21; j++) {
            const double turn = h * j / R + w * 0.37e-3 / R, r = R - arm[w];
            double T[3][3];
            contacts_rotation((double[3]){0.0, 0.0, turn}, T);
            contacts_place(&c, w, j, (double[3]){r * sin(turn), R - r * cos(turn), 0.0}, T);
        }
    }
    contacts_step(&c, dt);
    for (int j = 1; j < 20; j++) {
        struct wb_swept_contact_point point;
        wb_swept_contact_get_point(c.contact, 0, j, &point);
        assert_close(point.gap, -depth, 0.04 * h * h / (8.0 * R));
        assert_true(fabs(point.shift) > 0.1);
    }
    contacts_release(&c);
}

/* Three wires, bent, twisted, not parallel, slipped by some stations, with deformed sections: a
 * general case. */
static void make_tangle(struct contacts *c, struct wb_swept_contact_settings *settings)
{
    static const double radius[3] = {0.7e-3, 0.55e-3, 0.8e-3};
    static const double at[3][3] = {
        {0.0, 0.0, 0.0}, {0.31e-3, 1.2475e-3, 0.0}, {-2.3e-3, 0.794e-3, 1.269e-3}};

    seed = 7;
    settings->most_pairs = 3;
    contacts_init(c, settings, 3, radius, 37, 1e-3);
    for (int w = 0; w < 3; w++) {
        for (int j = 0; j < c->n_stations; j++) {
            const double x = at[w][0] + c->spacing * j;
            double T[3][3];
            contacts_rotation((double[3]){0.02 * j * (w - 1), 0.01 * w, 9.0 * x + 0.01 * w}, T);
            contacts_place(c, w, j,
                           (double[3]){x - 9.0 * x * at[w][1], at[w][1] + 4.5 * x * x,
                                       at[w][2] + 1e-6 * sin(300.0 * x + w)},
                           T);
        }
        for (size_t i = 0; i < wb_swept_size(&c->layout); i++)
            c->position[w][i] += 1e-6 * random_number();
    }
}

static void jitter(struct contacts *c, double size)
{
    for (int w = 0; w < c->n_wires; w++) {
        for (size_t i = 0; i < wb_swept_size(&c->layout); i++)
            c->position[w][i] += size * random_number();
    }
}

/* Between refreshes, also where shifts are no longer optimal. */
static void forces_without_friction_are_the_derivative_of_the_energy(void **state)
{
    struct wb_swept_contact_settings settings = contacts_settings();
    struct contacts c;
    int touched = 0;

    (void)state;
    settings.friction.mu_static = settings.friction.mu_kinetic = 0.0;
    settings.refresh_interval = 1 << 30;
    make_tangle(&c, &settings);
    contacts_step(&c, dt);
    assert_int_equal(wb_swept_contact_pairs(c.contact), 3);
    jitter(&c, 2e-6);
    for (int n = 0; n < 300; n++) {
        const int w = n % 3, node = n % CONTACTS_SURFACE, i = n / 3 % 3;
        const int j = n % c.n_stations;
        double *x = &c.position[w][contacts_index(&c, node, i, j)];
        const double old = *x, h = 1e-9;
        double energy[2];
        contacts_step(&c, dt);
        const double force = contacts_force(&c, w, node, i, j);
        for (int side = 0; side < 2; side++) {
            *x = old + (side ? h : -h);
            contacts_step(&c, dt);
            energy[side] = c.energies.normal;
        }
        *x = old;
        assert_close(force, -(energy[1] - energy[0]) / (2.0 * h), 1e-7);
        touched += fabs(force) > 1e-3;
    }
    assert_in_range(touched, 100, 300);
    contacts_release(&c);
}

/* A refresh changes the energy by second order in the error of the shift. */
static void refreshing_shifts_hardly_changes_the_energy(void **state)
{
    double change[2];

    (void)state;
    for (int half = 0; half < 2; half++) {
        const double radius[2] = {0.7e-3, 0.7e-3}, slip = half ? 5e-6 : 10e-6;
        struct wb_swept_contact_settings settings = contacts_settings();
        struct contacts c;
        settings.friction.mu_static = settings.friction.mu_kinetic = 0.0;
        settings.refresh_interval = 2;
        contacts_make_pair(&c, &settings, radius, 2e-6, 0.0, 0.3e-3);
        contacts_step(&c, dt);
        contacts_place_straight(&c, 1, (double[3]){0.3e-3 + slip, 1.398e-3, 0.0}, 0.0);
        contacts_step(&c, dt);
        struct wb_swept_contact_point before, after;
        wb_swept_contact_get_point(c.contact, 0, 10, &before);
        contacts_step(&c, dt);
        wb_swept_contact_get_point(c.contact, 0, 10, &after);
        assert_close(before.shift, -0.3, 1e-9);
        assert_close(after.shift, -0.3 - 1e3 * slip, 1e-6);
        change[half] = before.gap - after.gap;
        assert_close_relative(change[half], slip * slip / 2.0 / 1.398e-3, 0.01);
        contacts_release(&c);
    }
    assert_close_relative(change[0], 4.0 * change[1], 0.01);
}

/* Sum and moment over both wires of each pair, with friction, positions between stations, and
 * deformed sections. */
static void forces_cancel_in_sum_and_moment(void **state)
{
    struct wb_swept_contact_settings settings = contacts_settings();
    struct contacts c;

    (void)state;
    make_tangle(&c, &settings);
    for (int step = 0; step < 60; step++) {
        double sum[3] = {0.0}, moment[3] = {0.0}, size = 0.0;
        contacts_step(&c, dt);
        for (int w = 0; w < c.n_wires; w++) {
            double f[3], m[3];
            contacts_total(&c, w, origin, f, m);
            for (int i = 0; i < 3; i++) {
                sum[i] += f[i];
                moment[i] += m[i];
                size += fabs(f[i]);
            }
        }
        assert_true(size > 1.0);
        for (int i = 0; i < 3; i++) {
            assert_close(sum[i], 0.0, 1e-13 * size);
            assert_close(moment[i], 0.0, 1e-13 * size * 0.04);
        }
        jitter(&c, 1e-7);
    }
    assert_true(c.friction > 0.0 && c.energies.tangential > 0.0);
    contacts_release(&c);
}

/* The same with forces in float, to their precision. */
static void forces_in_float_cancel_to_their_digits(void **state)
{
    struct wb_swept_contact_settings settings = contacts_settings();
    struct contacts c;

    (void)state;
    settings.double_precision = false;
    make_tangle(&c, &settings);
    for (int step = 0; step < 60; step++) {
        double sum[3] = {0.0}, moment[3] = {0.0}, size = 0.0;
        contacts_step(&c, dt);
        for (int w = 0; w < c.n_wires; w++) {
            double f[3], m[3];
            contacts_total(&c, w, origin, f, m);
            for (int i = 0; i < 3; i++) {
                sum[i] += f[i];
                moment[i] += m[i];
                size += fabs(f[i]);
            }
        }
        for (int i = 0; i < 3; i++) {
            assert_close(sum[i], 0.0, 1e-6 * size);
            assert_close(moment[i], 0.0, 1e-6 * size * 0.04);
        }
        jitter(&c, 1e-7);
    }
    contacts_release(&c);
}

/* One radian about any axis: normal forces and existing friction rotate with the wires, and no
 * friction is added. */
static void rigid_rotation_causes_no_friction(void **state)
{
    const double radius[2] = {0.7e-3, 0.5e-3};
    struct wb_swept_contact_settings settings = contacts_settings();

    (void)state;
    seed = 3;
    settings.refresh_interval = 1;
    for (int n = 0; n < 8; n++) {
        const int steps = 2000;
        struct contacts c;
        double axis[3], part[3], one[3][3], all[3][3];
        struct wb_swept_contact_point before, after;
        unit_vector(axis);
        for (int i = 0; i < 3; i++)
            part[i] = axis[i] / steps;
        contacts_rotation(part, one);
        contacts_rotation(axis, all);
        contacts_make_pair(&c, &settings, radius, 1e-6, 0.6, 0.35e-3);
        contacts_step(&c, dt);
        /* Half of the friction limit; no friction in every second case. */
        if (n % 2 == 0) {
            contacts_place_straight(&c, 0, (double[3]){0.3e-6, 0.0, 0.0}, 0.3 - 0.3e-3);
            contacts_step(&c, dt);
        }
        wb_swept_contact_get_point(c.contact, 0, 10, &before);
        const double stored = c.energies.tangential, normal = c.energies.normal;
        for (int step = 0; step < steps; step++) {
            contacts_turn(&c, one);
            contacts_step(&c, dt);
        }
        wb_swept_contact_get_point(c.contact, 0, 10, &after);
        assert_close_relative(c.energies.normal, normal, 1e-7);
        if (n % 2 == 0)
            assert_close_relative(c.energies.tangential, stored, 1e-5);
        else
            assert_close(c.energies.tangential, 0.0, 1e-12 * normal);
        assert_close(c.friction, 0.0, 1e-12 * normal);
        for (int i = 0; i < 3; i++) {
            double turned = 0.0;
            for (int k = 0; k < 3; k++)
                turned += all[i][k] * before.friction[k];
            assert_close(after.friction[i], turned, 1e-6 * 0.25e9 * 1e-6);
        }
        contacts_release(&c);
    }
}

/* The second wire moves to the third, at another axial position; it leaves the first, and the old
 * friction is gone when it touches the first again. */
static void wires_separate_and_touch_again_elsewhere(void **state)
{
    const double radius[3] = {0.7e-3, 0.7e-3, 0.7e-3}, depth = 1e-6, near = 1.4e-3 - depth;
    struct wb_swept_contact_settings settings = contacts_settings();
    struct contacts_pair pair;
    struct wb_swept_contact_point point;
    struct contacts c;
    double f[3][3], m[3];

    (void)state;
    settings.refresh_interval = 10;
    contacts_init(&c, &settings, 3, radius, 21, 1e-3);
    contacts_place_straight(&c, 0, origin, 0.0);
    contacts_place_straight(&c, 2, (double[3]){0.0, 6e-3, 0.0}, 0.0);
    /* Down on the first and slide; up to the third, shifted by 7 mm; back, shifted by 4 mm. */
    const double stages[4][2] = {{0.0, near}, {5e-6, near}, {7e-3, 6e-3 - near}, {4e-3, near}};
    for (int stage = 0; stage < 4; stage++) {
        const double *from = stages[stage > 0 ? stage - 1 : 0], *to = stages[stage];
        for (int n = 1; n <= 2010; n++) {
            const double s = fmin(n / 2000.0, 1.0), away = stage > 1 ? 0.5e-3 * sin(M_PI * s) : 0.0;
            contacts_place_straight(
                &c, 1,
                (double[3]){from[0] + s * (to[0] - from[0]), from[1] + s * (to[1] - from[1]), away},
                0.0);
            contacts_step(&c, dt);
        }
        for (int w = 0; w < 3; w++)
            contacts_total(&c, w, origin, f[w], m);
        const double length = 20e-3 - fabs(to[0]), N = 0.25e9 * depth * length;
        const int other = stage == 2 ? 2 : 0;
        assert_int_equal(wb_swept_contact_pairs(c.contact), 1);
        pair = contacts_pair(&c, 0);
        assert_int_equal(pair.wire[0] + pair.wire[1], 1 + other);
        assert_close_relative(pair.normal, N, 1e-5);
        assert_close_relative(f[1][1], other == 0 ? N : -N, 1e-5);
        assert_close_relative(f[other][1], -f[1][1], 1e-12);
        wb_swept_contact_get_point(c.contact, 0, 12, &point);
        assert_close(point.shift, other == 0 ? -1e3 * to[0] : 1e3 * to[0], 0.01);
    }
    contacts_release(&c);
}

/* From one step to the next, beyond a block's end: the old friction must not act. */
static void stations_that_leave_contact_carry_nothing(void **state)
{
    const double radius[2] = {0.7e-3, 0.7e-3}, depth = 2e-6, h = 1e-3;
    const double straight[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    struct wb_swept_contact_settings settings = contacts_settings();
    struct contacts c;

    (void)state;
    settings.refresh_interval = 1;
    contacts_init(&c, &settings, 2, radius, 48, h);
    for (int step = 0; step < 4; step++) {
        double R[3][3];
        memcpy(R, straight, sizeof R);
        contacts_place_straight(&c, 0, origin, 0.0);
        for (int j = 0; j < 48; j++) {
            /* Sticking with half of the limit; then the rear two thirds lifted (the wire rises
             * between stations 15 and 16); then back. */
            const double slip = step == 0 ? 0.0 : 0.8e-6, away = step == 2 && j > 15 ? 2e-3 : 0.0;
            contacts_place(&c, 1, j, (double[3]){h * j + 0.4e-3 + slip, 1.4e-3 - depth + away, 0.0},
                           R);
        }
        contacts_step(&c, dt);
        for (int j = 0; j < 48; j++) {
            double f[3], m[3];
            struct wb_swept_contact_point point;
            contacts_wrench(&c, 1, j, origin, f, m);
            wb_swept_contact_get_point(c.contact, 0, j, &point);
            const bool far = step == 2 && j > 15;
            if (far)
                assert_true(f[0] == 0.0 && f[1] == 0.0 && f[2] == 0.0);
            else if (j > 0 && j < 14)
                assert_close_relative(f[1], 0.25e9 * depth * h, 1e-3);
            if (step == 3 && j != 15 && j != 16)
                assert_close(point.friction[0], j < 15 ? 100.0 : 0.0, 0.1);
        }
    }
    contacts_release(&c);
}

static void invalid_input_is_rejected(void **state)
{
    const double radius[3] = {0.7e-3, 0.7e-3, 0.7e-3};
    struct wb_swept_contact_settings settings = contacts_settings();
    struct contacts c;

    (void)state;
    wb_log_set_sink(discard_message, NULL);
    contacts_make_pair(&c, &settings, radius, 1e-6, 0.0, 0.0);
    assert_int_equal(contacts_try(&c, 0.0), WB_ERR_ARGUMENT);
    assert_int_equal(contacts_try(&c, (double)NAN), WB_ERR_ARGUMENT);
    assert_int_equal(contacts_try(&c, dt), WB_OK);
    /* A node without contact may have any position; surface nodes must be finite. */
    c.position[1][contacts_index(&c, CONTACTS_NODES - 1, 1, 20)] = (double)NAN;
    assert_int_equal(contacts_try(&c, dt), WB_OK);
    const double old = c.position[1][contacts_index(&c, 3, 1, 20)];
    c.position[1][contacts_index(&c, 3, 1, 20)] = (double)NAN;
    assert_int_equal(contacts_try(&c, dt), WB_ERR_DATA);
    c.position[1][contacts_index(&c, 3, 1, 20)] = (double)INFINITY;
    assert_int_equal(contacts_try(&c, dt), WB_ERR_DATA);
    c.position[1][contacts_index(&c, 3, 1, 20)] = old;
    wb_swept_contact_reset(c.contact);
    assert_int_equal(contacts_try(&c, dt), WB_OK);
    assert_true(c.energies.normal > 0.0);
    contacts_place_straight(&c, 1, (double[3]){0.0, 1.0e-3, 0.0}, 0.0);
    assert_int_equal(contacts_try(&c, dt), WB_ERR_DATA);
    contacts_place_straight(&c, 1, origin, 0.0);
    assert_int_equal(contacts_try(&c, dt), WB_ERR_DATA);
    contacts_release(&c);

    settings.most_pairs = 2;
    contacts_init(&c, &settings, 3, radius, 21, 1e-3);
    contacts_place_straight(&c, 0, origin, 0.0);
    contacts_place_straight(&c, 1, (double[3]){0.0, 1.4e-3, 0.0}, 0.0);
    contacts_place_straight(&c, 2, (double[3]){0.0, 0.7e-3, 1.2e-3}, 0.0);
    assert_int_equal(contacts_try(&c, dt), WB_ERR_MEMORY);
    contacts_release(&c);
    wb_log_set_sink(NULL, NULL);
}

static enum wb_status try_create(void (*change)(struct wb_swept_contact_settings *,
                                                struct wb_swept_wire *, int *, double *))
{
    static const int surface[3] = {0, 1, 2};
    static const double node[3][2] = {{1e-3, 0.0}, {0.0, 1e-3}, {-1e-3, 0.0}};
    struct wb_swept_contact_settings settings = contacts_settings();
    struct wb_swept_wire wire = {3, 3, surface, node, .radius = 1e-3, .youngs_modulus = 1e9};
    struct wb_swept_contact *contact = NULL;
    int n_stations = 5;
    double spacing = 1e-3;

    if (change)
        change(&settings, &wire, &n_stations, &spacing);
    const enum wb_status status =
        wb_swept_contact_create(&contact, &settings, 1, &wire, n_stations, spacing);
    assert_true((status == WB_OK) == (contact != NULL));
    wb_swept_contact_destroy(contact);
    return status;
}

#define CHANGE(name, statement)                                                                    \
    static void name(struct wb_swept_contact_settings *settings, struct wb_swept_wire *wire,       \
                     int *n_stations, double *spacing)                                             \
    {                                                                                              \
        (void)settings, (void)wire, (void)n_stations, (void)spacing;                               \
        statement;                                                                                 \
    }

static const double on_a_line[3][2] = {{1e-3, 0.0}, {0.0, 0.0}, {-1e-3, 0.0}};
static const int beyond[3] = {0, 1, 3};

CHANGE(one_station, *n_stations = 1)
CHANGE(no_spacing, *spacing = 0.0)
CHANGE(spacing_nan, *spacing = (double)NAN)
CHANGE(soft, settings->stiffness = 0.0)
CHANGE(friction_nan, settings->friction.mu_static = (double)NAN)
CHANGE(friction_negative, settings->friction.mu_kinetic = -0.1)
CHANGE(decay_negative, settings->friction.decay = -1.0)
CHANGE(damping_negative, settings->damping_time = -1.0)
CHANGE(no_reach, settings->reach = 0.0)
CHANGE(never_refreshed, settings->refresh_interval = 0)
CHANGE(no_pairs, settings->most_pairs = -1)
CHANGE(two_nodes, wire->n_surface = 2)
CHANGE(line, wire->node = on_a_line)
CHANGE(node_beyond, wire->surface = beyond)
CHANGE(no_radius, wire->radius = 0.0)
CHANGE(modulus_nan, wire->youngs_modulus = (double)NAN)
CHANGE(frictionless, settings->friction.mu_static = settings->friction.mu_kinetic = 0.0)

static void invalid_settings_are_rejected(void **state)
{
    (void)state;
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(try_create(NULL), WB_OK);
    assert_int_equal(try_create(frictionless), WB_OK);
    assert_int_equal(try_create(one_station), WB_ERR_ARGUMENT);
    assert_int_equal(try_create(no_spacing), WB_ERR_ARGUMENT);
    assert_int_equal(try_create(spacing_nan), WB_ERR_ARGUMENT);
    assert_int_equal(try_create(soft), WB_ERR_ARGUMENT);
    assert_int_equal(try_create(friction_nan), WB_ERR_ARGUMENT);
    assert_int_equal(try_create(friction_negative), WB_ERR_ARGUMENT);
    assert_int_equal(try_create(decay_negative), WB_ERR_ARGUMENT);
    assert_int_equal(try_create(damping_negative), WB_ERR_ARGUMENT);
    assert_int_equal(try_create(no_reach), WB_ERR_ARGUMENT);
    assert_int_equal(try_create(never_refreshed), WB_ERR_ARGUMENT);
    assert_int_equal(try_create(no_pairs), WB_ERR_ARGUMENT);
    assert_int_equal(try_create(two_nodes), WB_ERR_ARGUMENT);
    assert_int_equal(try_create(line), WB_ERR_ARGUMENT);
    assert_int_equal(try_create(node_beyond), WB_ERR_ARGUMENT);
    assert_int_equal(try_create(no_radius), WB_ERR_ARGUMENT);
    assert_int_equal(try_create(modulus_nan), WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parallel_wires_press_with_stiffness_times_depth),
        cmocka_unit_test(stiffness_is_about_that_of_hertz_line_contact),
        cmocka_unit_test(stations_at_the_ends_weigh_half),
        cmocka_unit_test(slipped_wires_press_over_their_common_length),
        cmocka_unit_test(chords_of_bent_wires_do_not_affect_the_gap),
        cmocka_unit_test(forces_without_friction_are_the_derivative_of_the_energy),
        cmocka_unit_test(refreshing_shifts_hardly_changes_the_energy),
        cmocka_unit_test(forces_cancel_in_sum_and_moment),
        cmocka_unit_test(forces_in_float_cancel_to_their_digits),
        cmocka_unit_test(rigid_rotation_causes_no_friction),
        cmocka_unit_test(wires_separate_and_touch_again_elsewhere),
        cmocka_unit_test(stations_that_leave_contact_carry_nothing),
        cmocka_unit_test(invalid_input_is_rejected),
        cmocka_unit_test(invalid_settings_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
