/* Contact in motion: known solutions for colliding, sliding and rolling bodies and for ropes. */
#include "fe/swept/swept_contact.h"

#include "tests/fe/swept/contacts.h"

#define WB_LOG_DOMAIN "test"

static const double origin[3] = {0.0, 0.0, 0.0};

/* A straight rigid wire along x with a density of 5000: position of its start, angle about its
 * axis. */
struct body {
    double mass, inertia;
    double x[3], v[3], angle, spin;
    bool is_fixed;
};

static struct body make_body(double radius, double length)
{
    const double mass = 5000.0 * M_PI * radius * radius * length;
    return (struct body){.mass = mass, .inertia = 0.5 * mass * radius * radius};
}

/* Central differences: forces at these positions, then the next positions. */
static void move(struct contacts *c, struct body *bodies, const double weight[3], double dt)
{
    for (int w = 0; w < c->n_wires; w++)
        contacts_place_straight(c, w, bodies[w].x, bodies[w].angle);
    contacts_step(c, dt);
    for (int w = 0; w < c->n_wires; w++) {
        struct body *body = &bodies[w];
        double force[3], moment[3];
        if (body->is_fixed)
            continue;
        contacts_total(c, w, body->x, force, moment);
        for (int i = 0; i < 3; i++) {
            body->v[i] += dt * (force[i] / body->mass + weight[i]);
            body->x[i] += dt * body->v[i];
        }
        body->spin += dt * moment[0] / body->inertia;
        body->angle += dt * body->spin;
    }
}

static double kinetic(const struct body *bodies, int n)
{
    double energy = 0.0;
    for (int w = 0; w < n; w++) {
        const struct body *b = &bodies[w];
        energy += 0.5 * b->mass * (b->v[0] * b->v[0] + b->v[1] * b->v[1] + b->v[2] * b->v[2]) +
                  0.5 * b->inertia * b->spin * b->spin;
    }
    return energy;
}

static void momentum(const struct body *bodies, int n, double linear[3], double *angular)
{
    memset(linear, 0, 3 * sizeof *linear);
    *angular = 0.0;
    for (int w = 0; w < n; w++) {
        const struct body *b = &bodies[w];
        for (int i = 0; i < 3; i++)
            linear[i] += b->mass * b->v[i];
        *angular += b->mass * (b->x[1] * b->v[2] - b->x[2] * b->v[1]) + b->inertia * b->spin;
    }
}

/* Eccentric collision of two wires that spin and slip along each other; returns the energy lost in
 * addition to friction, over the initial energy. Linear and angular momentum are conserved
 * throughout. */
static double collide(double mu, double dt)
{
    const double radius[2] = {0.7e-3, 0.5e-3}, length = 20e-3;
    struct wb_swept_contact_settings settings = contacts_settings();
    struct body bodies[2] = {make_body(radius[0], length), make_body(radius[1], length)};
    double linear[2][3], angular[2];
    struct contacts c;

    settings.friction.mu_static = settings.friction.mu_kinetic = mu;
    settings.refresh_interval = 1;
    contacts_init(&c, &settings, 2, radius, 21, 1e-3);
    bodies[0].x[2] = 0.1e-3;
    bodies[0].v[1] = 0.2;
    bodies[1].x[1] = 1.21e-3;
    bodies[1].v[1] = -0.3;
    bodies[1].v[0] = 0.05;
    bodies[1].spin = 100.0;
    const double before = kinetic(bodies, 2);
    momentum(bodies, 2, linear[0], &angular[0]);
    double deepest = 0.0;
    const int steps = (int)(2.5e-4 / dt + 0.5);
    for (int n = 0; n < steps; n++) {
        move(&c, bodies, origin, dt);
        deepest = fmax(deepest, c.energies.deepest);
        momentum(bodies, 2, linear[1], &angular[1]);
        for (int i = 0; i < 3; i++)
            assert_close(linear[1][i], linear[0][i], 1e-15 * 0.5 * bodies[0].mass * steps);
        assert_close(angular[1], angular[0], 1e-15 * 1e-3 * bodies[0].mass * steps);
    }
    assert_true(deepest > 1e-6);
    assert_true(c.energies.deepest == 0.0);
    assert_true(bodies[1].v[1] > 0.0 && bodies[0].v[1] < 0.0);
    const double loss = (before - kinetic(bodies, 2) - c.friction) / before;
    if (mu > 0.0)
        assert_true(c.friction > 1e-3 * before);
    contacts_release(&c);
    return loss;
}

static void collisions_conserve_momentum_and_energy(void **state)
{
    static const double friction[] = {0.0, 0.4};

    (void)state;
    for (int n = 0; n < 2; n++) {
        for (double dt = 1e-6; dt > 0.05e-6; dt /= 4.0) {
            /* The time of contact within a step is random; its effect is of second order. */
            const double loss = collide(friction[n], dt), frequency = 2.9e5;
            printf("friction %g, step %.4f us: energy lost without a cause %.2e\n", friction[n],
                   1e6 * dt, loss);
            assert_true(fabs(loss) < 0.25 * frequency * dt * frequency * dt);
        }
    }
}

/* A wire lies along another on a slope. */
struct slide {
    double way;          /* at the end */
    double acceleration; /* mean of the second half */
    double stretch;      /* of an equivalent spring that holds the wire */
};

static struct slide slide(double mu, double angle, double g, double time)
{
    const double radius[2] = {0.7e-3, 0.7e-3}, dt = 1e-6;
    const double weight[3] = {-g * sin(angle), -g * cos(angle), 0.0};
    struct wb_swept_contact_settings settings = contacts_settings();
    struct body bodies[2] = {make_body(radius[0], 20e-3), make_body(radius[1], 20e-3)};
    const int steps = (int)(time / dt + 0.5);
    struct contacts c;
    double speed = 0.0;

    settings.friction.mu_static = settings.friction.mu_kinetic = mu;
    settings.refresh_interval = 1; /* at 3 m/s */
    contacts_init(&c, &settings, 2, radius, 21, 1e-3);
    bodies[0].is_fixed = true;
    bodies[1].x[1] = 1.4e-3 - bodies[1].mass * g * cos(angle) / (0.25e9 * 20e-3);
    for (int n = 0; n < steps; n++) {
        if (n == steps / 2)
            speed = bodies[1].v[0];
        move(&c, bodies, weight, dt);
    }
    assert_close(bodies[1].x[2], 0.0, 1e-12);
    contacts_release(&c);
    return (struct slide){.way = -bodies[1].x[0],
                          .acceleration = (speed - bodies[1].v[0]) / (0.5 * time),
                          .stretch = bodies[1].mass * g * sin(angle) / (0.125e9 * 20e-3)};
}

static void a_wire_on_a_slope_slides_or_sticks(void **state)
{
    static const double friction[] = {0.0, 0.1, 0.4, 0.6};
    const double angle = 0.55, g = 1e4, time = 0.6e-3; /* tan 0.55 = 0.613 */

    (void)state;
    for (int n = 0; n < 4; n++) {
        const struct slide result = slide(friction[n], angle, g, time);
        assert_close(result.acceleration, g * (sin(angle) - friction[n] * cos(angle)), 1e-3 * g);
    }
    /* An undamped spring that is loaded suddenly stretches to twice its static value, so up to
     * twice the friction is needed; if less is available, it slides until it sticks. */
    struct slide result = slide(1.24, angle, g, time);
    assert_true(result.way < 2.05 * result.stretch);
    result = slide(0.7, angle, g, time);
    const struct slide longer = slide(0.7, angle, g, 2.0 * time);
    assert_true(longer.way < 20.0 * longer.stretch);
    assert_close(longer.way, result.way, 2.0 * longer.stretch);
}

/* A cylinder rolls down a fixed one from rest: (R + r) theta'' = g sin theta / (1 + I / m r^2). */
static void a_wire_rolls_down_another(void **state)
{
    const double radius[2] = {3e-3, 0.7e-3}, g = 1e3, dt = 1e-6, away = 3.7e-3;
    const double weight[3] = {0.0, -g, 0.0};
    struct wb_swept_contact_settings settings = contacts_settings();
    struct body bodies[2] = {make_body(radius[0], 20e-3), make_body(radius[1], 20e-3)};
    struct contacts c;
    double theta = 0.3, rate = 0.0;

    (void)state;
    settings.damping_time = 2e-6;
    contacts_init(&c, &settings, 2, radius, 21, 1e-3);
    bodies[0].is_fixed = true;
    const double depth = bodies[1].mass * g * cos(theta) / (0.25e9 * 20e-3);
    bodies[1].x[1] = (away - depth) * cos(theta);
    bodies[1].x[2] = (away - depth) * sin(theta);
    for (int n = 0; n < 3000; n++) {
        move(&c, bodies, weight, dt);
        rate += dt * g * sin(theta) / away / 1.5;
        theta += dt * rate;
    }
    assert_true(theta > 0.5);
    assert_close(atan2(bodies[1].x[2], bodies[1].x[1]), theta, 0.003 * (theta - 0.3));
    /* From y towards z the wire moves around by theta and rotates by theta (R + r) / r. */
    assert_close(bodies[1].angle, (theta - 0.3) * away / radius[1], 0.004 * away / radius[1]);
    assert_close(c.friction, 0.0, 1e-6 * kinetic(bodies, 2));
    contacts_release(&c);
}

/* ---- A rope of masses and springs around a fixed bent wire. ---- */

enum {
    LINKS = 41
};

struct rope {
    double x[LINKS][2], v[LINKS][2];
    double T2, direction;
};

static const double rope_mass = 1e-5, rope_stiffness = 1e6, rope_damping = 1.0;
static const double rope_T1 = 10.0, rope_pull = 0.05, anchor_away = 50e-3;

static void place_arc(struct contacts *c, int w, int j, const double at[2])
{
    double T[3][3];
    contacts_rotation((double[3]){0.0, 0.0, atan2(at[1], at[0]) + 0.5 * M_PI}, T);
    contacts_place(c, w, j, (double[3]){at[0], at[1], 0.0}, T);
}

/* Springs between masses; at the first end a constant tension along -`start`, at the last a spring
 * to a moving anchor. */
static void rope_forces(struct rope *rope, double angle, double radius, double time,
                        double force[LINKS][2])
{
    const double length = radius * 2.0 * sin(0.5 * angle / (LINKS - 1));
    const double out[2] = {-sin(angle), cos(angle)}, reach = anchor_away + rope_pull * time;

    force[0][1] -= rope_T1; /* the arc starts in the direction of y */
    for (int j = 0; j < LINKS; j++) {
        double far[2], speed[2] = {0.0, 0.0}, rest = length;
        for (int i = 0; i < 2; i++) {
            far[i] = j < LINKS - 1 ? rope->x[j + 1][i]
                                   : radius * (i ? sin(angle) : cos(angle)) + reach * out[i];
            speed[i] = (j < LINKS - 1 ? rope->v[j + 1][i] : rope_pull * out[i]) - rope->v[j][i];
        }
        if (j == LINKS - 1)
            rest = anchor_away;
        const double d[2] = {far[0] - rope->x[j][0], far[1] - rope->x[j][1]};
        const double size = hypot(d[0], d[1]);
        const double T = rope_stiffness * (size - rest) +
                         rope_damping * (d[0] * speed[0] + d[1] * speed[1]) / size;
        for (int i = 0; i < 2; i++) {
            force[j][i] += T * d[i] / size;
            if (j < LINKS - 1)
                force[j + 1][i] -= T * d[i] / size;
        }
        rope->T2 = T;
        rope->direction = atan2(d[1], d[0]);
    }
}

static void check_capstan(double mu, double angle)
{
    const double radius[2] = {0.7e-3, 0.7e-3}, drum = 20e-3, dt = 1e-6, over = 0.3;
    const double on = drum + radius[0] + radius[1];
    struct wb_swept_contact_settings settings = contacts_settings();
    static struct rope rope;
    struct contacts c;
    double T2 = 0.0, turn = 0.0;
    int n_mean = 0;

    settings.friction.mu_static = settings.friction.mu_kinetic = mu;
    settings.damping_time = 1e-6;
    contacts_init(&c, &settings, 2, radius, LINKS, 1e-3);
    memset(&rope, 0, sizeof rope);
    for (int j = 0; j < LINKS; j++) {
        const double at = angle * j / (LINKS - 1);
        const double below = (angle + 2.0 * over) * j / (LINKS - 1) - over;
        rope.x[j][0] = on * cos(at);
        rope.x[j][1] = on * sin(at);
        place_arc(&c, 0, j, (double[2]){drum * cos(below), drum * sin(below)});
    }
    for (int n = 0; n < 20000; n++) {
        double force[LINKS][2], moment[3], f[3];
        for (int j = 0; j < LINKS; j++)
            place_arc(&c, 1, j, rope.x[j]);
        contacts_step(&c, dt);
        for (int j = 0; j < LINKS; j++) {
            contacts_wrench(&c, 1, j, origin, f, moment);
            memcpy(force[j], f, sizeof force[j]);
        }
        rope_forces(&rope, angle, on, n * dt, force);
        for (int j = 0; j < 2 * LINKS; j++) {
            rope.v[j / 2][j % 2] += dt * force[j / 2][j % 2] / rope_mass;
            rope.x[j / 2][j % 2] += dt * rope.v[j / 2][j % 2];
        }
        if (n >= 15000) {
            T2 += rope.T2;
            turn += fmod(rope.direction + 1.5 * M_PI, 2.0 * M_PI);
            n_mean++;
        }
    }
    T2 /= n_mean;
    turn /= n_mean;
    printf("capstan, friction %g over %.3f rad: T2 / T1 = %.4f, exp(mu phi) = %.4f\n", mu, turn,
           T2 / rope_T1, exp(mu * turn));
    assert_close(turn, angle, 0.02);
    assert_close_relative(T2 / rope_T1, exp(mu * turn), 0.005);
    assert_true(c.friction > 0.0);
    contacts_release(&c);
}

static void a_rope_around_a_wire_follows_the_capstan_equation(void **state)
{
    (void)state;
    check_capstan(0.4, 2.0);
    check_capstan(0.2, 1.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(collisions_conserve_momentum_and_energy),
        cmocka_unit_test(a_wire_on_a_slope_slides_or_sticks),
        cmocka_unit_test(a_wire_rolls_down_another),
        cmocka_unit_test(a_rope_around_a_wire_follows_the_capstan_equation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
