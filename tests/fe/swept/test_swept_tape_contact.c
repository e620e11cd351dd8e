#include "fe/swept/swept_private.h"
#include "fe/swept/swept_tape_contact.h"

#include "tests/fe/swept/adhesive.h"
#include "tests/fe/swept/tapes.h"

enum {
    RING = 20,
    SURFACE = 16,
    STATIONS = 24
};

static const double radius = 0.7e-3, spacing = 0.5e-3, thickness = 0.2e-3;

/* A sleeve around one wire, both straight along x. */
struct grip {
    struct test_tape tape;
    struct wb_swept_layout layout; /* of the wire */
    struct wb_swept_cohesion *cohesion;
    struct wb_swept_tape_contact *contact;
    double node[SURFACE][2];
    int surface[SURFACE];
    double *start, *position; /* of the wire */
    void *force;
};

static struct wb_swept_tape_contact_settings usual(void)
{
    struct wb_swept_tape_contact_settings settings;
    default_tape_contact(&settings);
    settings.friction.mu_kinetic = 0.1;
    settings.refresh_interval = 7;
    return settings;
}

static void grip_create(struct grip *g, const struct wb_swept_tape_contact_settings *settings,
                        double depth, bool is_double,
                        const struct wb_swept_cohesion_settings *bonded)
{
    struct wb_swept_tape_model model = tape_model(&elastic_tape, RING, STATIONS, true, spacing);
    *g = (struct grip){.layout = wb_swept_layout(SURFACE, STATIONS)};
    make_tube(&model, radius + 0.5 * thickness - depth, 0.0, 1.0);
    model.double_precision = is_double;
    g->tape = test_tape_create(&model);
    g->start = swept_field(&g->layout);
    g->position = swept_field(&g->layout);
    g->force = swept_field(&g->layout);
    for (int k = 0; k < SURFACE; k++) {
        const double angle = 2.0 * M_PI * (k + 0.3) / SURFACE;
        g->surface[k] = k;
        g->node[k][0] = radius * cos(angle);
        g->node[k][1] = radius * sin(angle);
        for (int j = 0; j < STATIONS; j++)
            tape_put(&g->layout, g->start, k, j, spacing * j, g->node[k][0], g->node[k][1]);
    }
    memcpy(g->position, g->start, wb_swept_size(&g->layout) * sizeof(double));
    const struct wb_swept_wire wire = {.node = (const double(*)[2])g->node,
                                       .n_nodes = SURFACE,
                                       .n_surface = SURFACE,
                                       .surface = g->surface,
                                       .radius = radius};
    if (bonded) {
        struct wb_swept_cohesion_bond bond[RING * STATIONS];
        for (int i = 0; i < RING * STATIONS; i++)
            bond[i] = (struct wb_swept_cohesion_bond){0, 1.0};
        assert_int_equal(
            wb_swept_cohesion_create(&g->cohesion, g->tape.tape, bonded, 1, &wire, bond), WB_OK);
    }
    assert_int_equal(
        wb_swept_tape_contact_create(&g->contact, g->tape.tape, g->cohesion, settings, 1, &wire),
        WB_OK);
}

static void grip_destroy(struct grip *g)
{
    wb_swept_tape_contact_destroy(g->contact);
    wb_swept_cohesion_destroy(g->cohesion);
    test_tape_destroy(&g->tape);
    free(g->start);
    free(g->position);
    free(g->force);
}

static void clear(struct grip *g)
{
    memset(g->tape.force, 0, wb_swept_size(&g->tape.layout) * sizeof(double));
    memset(g->tape.moment, 0, wb_swept_size(&g->tape.layout) * sizeof(double));
    memset(g->force, 0, wb_swept_size(&g->layout) * sizeof(double));
}

static enum wb_status try_step(struct grip *g, double dt, struct wb_swept_tape_contact_sums *sums)
{
    const struct wb_swept_cohesion_fields fields = {
        {g->tape.position, g->tape.director, g->tape.force, g->tape.moment},
        (const double *const[]){g->position},
        (void *const[]){g->force}};
    *sums = (struct wb_swept_tape_contact_sums){0};
    clear(g);
    return wb_swept_tape_contact_add_forces(g->contact, &fields, dt, sums);
}

static struct wb_swept_tape_contact_sums step(struct grip *g, double dt)
{
    struct wb_swept_tape_contact_sums sums;
    assert_int_equal(try_step(g, dt, &sums), WB_OK);
    return sums;
}

static double wire_load(const struct grip *g, int node, int component, int station)
{
    const size_t at = swept_at(&g->layout, node, component, station);
    return g->tape.model.double_precision ? ((double *)g->force)[at]
                                          : (double)((float *)g->force)[at];
}

static double sum_on_tape(const struct grip *g, int i)
{
    double sum = 0.0;
    for (int k = 0; k < RING; k++) {
        for (int j = 0; j < STATIONS; j++)
            sum += tape_load(&g->tape, g->tape.force, k, i, j);
    }
    return sum;
}

static double sum_on_wire(const struct grip *g, int i)
{
    double sum = 0.0;
    for (int k = 0; k < SURFACE; k++) {
        for (int j = 0; j < STATIONS; j++)
            sum += wire_load(g, k, i, j);
    }
    return sum;
}

static double area_of(const struct grip *g)
{
    double area = 0.0;
    for (int k = 0; k < RING; k++) {
        for (int j = 0; j < STATIONS; j++)
            area += wb_swept_tape_area(g->tape.tape, k, j);
    }
    return area;
}

static void slide_wire(struct grip *g, double x)
{
    for (int k = 0; k < SURFACE; k++) {
        for (int j = 0; j < STATIONS; j++) {
            const size_t at = swept_at(&g->layout, k, 0, j);
            g->position[at] = g->start[at] + x;
        }
    }
}

/* --- pressure --- */

static void pressure_is_stiffness_times_depth(void **unused)
{
    (void)unused;
    const struct wb_swept_tape_contact_settings settings = usual();
    for (int is_double = 0; is_double < 2; is_double++) {
        struct grip g;
        const double depth = 2e-6, tolerance = is_double ? 1e-6 : 1e-3;
        grip_create(&g, &settings, depth, is_double, NULL);
        const struct wb_swept_tape_contact_sums sums = step(&g, 1e-6);
        assert_int_equal(wb_swept_tape_contact_near(g.contact), RING * STATIONS);
        assert_close_relative(sums.normal, 0.5 * 30e9 * depth * depth * area_of(&g), tolerance);
        assert_close_relative(sums.deepest, depth, tolerance);
        assert_close(sums.tangential + sums.friction, 0.0,
                     (is_double ? 1e-18 : 1e-9) * sums.normal);
        for (int k = 0; k < RING; k++) {
            const double *d = wb_swept_tape_directors(g.tape.tape);
            double out = 0.0, beside = 0.0;
            for (int i = 0; i < 3; i++) {
                const double f = tape_load(&g.tape, g.tape.force, k, i, 9);
                out += f * d[swept_at(&g.tape.layout, k, i, 9)];
                beside += f * f;
            }
            const double expected = 30e9 * depth * wb_swept_tape_area(g.tape.tape, k, 9);
            assert_close_relative(out, expected, tolerance);
            assert_close_relative(sqrt(beside), expected, tolerance);
        }
        grip_destroy(&g);
    }
}

static void no_force_acts_across_a_gap(void **unused)
{
    (void)unused;
    const struct wb_swept_tape_contact_settings settings = usual();
    struct grip g;
    grip_create(&g, &settings, -2e-6, true, NULL);
    const struct wb_swept_tape_contact_sums sums = step(&g, 1e-6);
    assert_int_equal(wb_swept_tape_contact_near(g.contact), RING * STATIONS);
    assert_true(sums.normal == 0.0 && sums.deepest == 0.0);
    assert_close(sum_on_tape(&g, 1), 0.0, 0.0);
    grip_destroy(&g);
    grip_create(&g, &settings, -40e-6, true, NULL); /* beyond the margin */
    (void)step(&g, 1e-6);
    assert_int_equal(wb_swept_tape_contact_near(g.contact), 0);
    grip_destroy(&g);
}

static void forces_are_the_derivatives_of_the_pressures_energy(void **unused)
{
    (void)unused;
    struct wb_swept_tape_contact_settings settings = usual();
    settings.refresh_interval = 1000000;
    settings.friction.mu_static = settings.friction.mu_kinetic = 0.0;
    struct grip g;
    uint64_t seed = 2;
    grip_create(&g, &settings, 3e-6, true, NULL);
    (void)step(&g, 1e-6);
    for (size_t i = 0; i < wb_swept_size(&g.layout); i++)
        g.position[i] += 3e-6 * (test_random(&seed) - 0.5);
    for (size_t i = 0; i < wb_swept_size(&g.tape.layout); i++)
        g.tape.director[i] += 0.02 * (test_random(&seed) - 0.5);
    (void)step(&g, 1e-6);
    double *field[3] = {g.tape.position, g.tape.director, g.position};
    for (int f = 0; f < 3; f++) {
        for (int sample = 0; sample < 60; sample++) {
            const int k = sample * 7 % (f == 2 ? SURFACE : RING), j = sample * 5 % STATIONS;
            const int c = sample % 3;
            const size_t at = swept_at(f == 2 ? &g.layout : &g.tape.layout, k, c, j);
            const double saved = field[f][at], by = f == 1 ? 1e-5 : 1e-9;
            (void)step(&g, 1e-6);
            const double found = f == 2   ? wire_load(&g, k, c, j)
                                 : f == 1 ? tape_load(&g.tape, g.tape.moment, k, c, j)
                                          : tape_load(&g.tape, g.tape.force, k, c, j);
            field[f][at] = saved + by;
            const double above = step(&g, 1e-6).normal;
            field[f][at] = saved - by;
            const double below = step(&g, 1e-6).normal;
            field[f][at] = saved;
            /* Forces are about 0.01 N. */
            assert_close(found, -(above - below) / (2.0 * by),
                         f == 0   ? 1e-9
                         : f == 1 ? 1e-12
                                  : 2e-6);
        }
    }
    grip_destroy(&g);
}

/* The sleeve, rotated around the wire by `angle` and moved across it, with inclined directors. */
static void move_sleeve(struct grip *g, const double *start, double angle, double y, double z)
{
    const double lean = 0.3;
    for (int k = 0; k < RING; k++) {
        for (int j = 0; j < STATIONS; j++) {
            double x[3];
            for (int i = 0; i < 3; i++)
                x[i] = start[swept_at(&g->tape.layout, k, i, j)];
            const double at[2] = {x[1] * cos(angle) - x[2] * sin(angle) + y,
                                  x[1] * sin(angle) + x[2] * cos(angle) + z};
            const double direction = atan2(x[2], x[1]) + angle + lean;
            tape_put(&g->tape.layout, g->tape.position, k, j, x[0], at[0], at[1]);
            tape_put(&g->tape.layout, g->tape.director, k, j, 0.0, cos(direction), sin(direction));
        }
    }
}

/* Without friction the work on a closed path is zero, regardless of updated contact points, and on
 * the way there it is the stored energy: a sleeve slides around a wire on which it is skew. */
static void sliding_around_a_wire_adds_no_energy(void **unused)
{
    (void)unused;
    struct wb_swept_tape_contact_settings settings = usual();
    settings.friction.mu_static = settings.friction.mu_kinetic = 0.0;
    settings.refresh_interval = 5;
    enum {
        STEPS = 4000
    };
    struct grip g;
    grip_create(&g, &settings, 2e-6, true, NULL);
    const size_t n = wb_swept_size(&g.tape.layout);
    double *start = swept_field(&g.tape.layout), *before = swept_field(&g.tape.layout);
    double *load = swept_field(&g.tape.layout);
    memcpy(start, g.tape.position, n * sizeof *start);
    move_sleeve(&g, start, 0.0, 0.0, 0.0);
    const double first = step(&g, 1e-6).normal;
    double work = 0.0, most = 0.0, worst = 0.0, stored = 0.0;
    memcpy(load, g.tape.force, n * sizeof *load);
    memcpy(before, g.tape.position, n * sizeof *before);
    for (int i = 1; i <= STEPS; i++) {
        const double t = 2.0 * M_PI * i / STEPS;
        move_sleeve(&g, start, 0.4 * sin(t), 3e-6 * (1.0 - cos(t)), 4e-6 * sin(2.0 * t));
        stored = step(&g, 1e-6).normal;
        for (size_t at = 0; at < n; at++)
            work += 0.5 * (((double *)g.tape.force)[at] + load[at]) *
                    (g.tape.position[at] - before[at]);
        memcpy(load, g.tape.force, n * sizeof *load);
        memcpy(before, g.tape.position, n * sizeof *before);
        most = fmax(most, stored);
        worst = fmax(worst, fabs(stored - first + work));
    }
    print_message("stored up to %.3g J; energy that comes from nowhere: %.2g of it\n", most,
                  worst / most);
    assert_true(most > 2.0 * first);
    assert_close(worst, 0.0, 1e-4 * most);
    free(start);
    free(before);
    free(load);
    grip_destroy(&g);
}

/* --- friction --- */

static void sliding_friction_is_mu_times_the_pressure(void **unused)
{
    (void)unused;
    /* The wire is drawn through the sleeve by more than a station. */
    for (int is_double = 0; is_double < 2; is_double++) {
        struct wb_swept_tape_contact_settings settings = usual();
        settings.friction.decay = 50.0;
        struct grip g;
        const double depth = 2e-6, dt = 1e-6, speed = 0.02, tolerance = is_double ? 2e-4 : 3e-3;
        grip_create(&g, &settings, depth, is_double, NULL);
        (void)step(&g, dt);
        double way = 0.0, dissipated = 0.0, work = 0.0, last = 0.0, force = 0.0;
        struct wb_swept_tape_contact_sums sums = {0};
        double within = 0.0;
        for (int i = 0; i < 32000; i++) {
            way += speed * dt;
            slide_wire(&g, way);
            sums = step(&g, dt);
            dissipated += sums.friction;
            force = sum_on_wire(&g, 0);
            work -= 0.5 * (force + last) * speed * dt;
            last = force;
            if (i == 15000)
                within = force;
        }
        const double mu = 0.1 + 0.3 * exp(-50.0 * speed);
        /* Common length of wire and sleeve: 0.64 mm of 11.5 mm are outside at the end. */
        const double whole = 30e9 * depth * area_of(&g);
        const double beside = 1.0 - 0.3e-3 / (spacing * (STATIONS - 1));
        assert_close_relative(within, -mu * whole * beside, 0.01);
        assert_close_relative(sum_on_tape(&g, 0), -force, 1e-5);
        assert_close_relative(dissipated + sums.tangential, work, tolerance);
        assert_close_relative(sums.tangential,
                              0.5 * pow(mu * 30e9 * depth, 2) / 10e9 * //
                                  sums.normal / (0.5 * 30e9 * depth * depth),
                              0.02);
        grip_destroy(&g);
    }
}

/* Slips in steps `begin` to `end`; returns the force in the last one. */
static double slide_on(struct grip *g, int begin, int end)
{
    for (int i = begin; i < end; i++) {
        slide_wire(g, 2e-8 * i);
        (void)step(g, 1e-6);
    }
    return sum_on_wire(g, 0);
}

static void a_checkpoint_continues_bit_for_bit(void **unused)
{
    (void)unused;
    const struct wb_swept_tape_contact_settings settings = usual();
    for (int is_double = 0; is_double < 2; is_double++) {
        struct grip g, other;
        grip_create(&g, &settings, 2e-6, is_double, NULL);
        grip_create(&other, &settings, 2e-6, is_double, NULL);
        (void)slide_on(&g, 0, 24);
        struct wb_checkpoint state = {.status = WB_OK};
        wb_swept_tape_contact_visit(g.contact, &state);
        const double force = slide_on(&g, 24, 50);
        wb_checkpoint_rewind(&state);
        wb_swept_tape_contact_visit(other.contact, &state);
        assert_int_equal(wb_checkpoint_finish(&state), WB_OK);
        assert_true(slide_on(&other, 24, 50) == force && force != 0.0);
        wb_swept_tape_contact_reset(other.contact);
        assert_true(slide_on(&other, 24, 50) != force);
        wb_checkpoint_release(&state);
        grip_destroy(&g);
        grip_destroy(&other);
    }
}

static void sticking_is_elastic(void **unused)
{
    (void)unused;
    const struct wb_swept_tape_contact_settings settings = usual();
    struct grip g;
    const double depth = 2e-6, slip = 1e-6; /* mu K_nn depth / K_ss = 2.4e-6 */
    grip_create(&g, &settings, depth, true, NULL);
    (void)step(&g, 1e-6);
    double dissipated = 0.0;
    for (int i = 1; i <= 100; i++) {
        slide_wire(&g, slip * i / 100);
        dissipated += step(&g, 1e-6).friction;
    }
    const double force = 10e9 * slip * area_of(&g);
    assert_close_relative(sum_on_wire(&g, 0), -force, 0.002); /* the end nodes have slipped off */
    assert_true(dissipated == 0.0);
    /* The force acts at the tape's lower side: moments are o times the forces. */
    const double pull = tape_load(&g.tape, g.tape.force, 3, 0, 9);
    const double below = 1.0 - cos(M_PI / SURFACE);
    const double turning = -tape_load(&g.tape, g.tape.moment, 3, 0, 9) / pull;
    assert_true(turning > 0.5 * thickness && turning < 0.5 * thickness + radius * below);
    for (int i = 1; i <= 100; i++) {
        slide_wire(&g, slip * (1.0 - i / 100.0));
        (void)step(&g, 1e-6);
    }
    assert_close(sum_on_wire(&g, 0), 0.0, 2e-3 * force);
    grip_destroy(&g);
}

static void turn_field(const struct wb_swept_layout *layout, double *field, double angle)
{
    double R[3][3];
    swept_rotation(angle, R);
    for (int k = 0; k < layout->n_nodes; k++) {
        for (int j = 0; j < layout->n_stations; j++) {
            double x[3];
            tape_get(layout, field, k, j, x);
            tape_put(layout, field, k, j, R[0][0] * x[0] + R[0][1] * x[1] + R[0][2] * x[2],
                     R[1][0] * x[0] + R[1][1] * x[1] + R[1][2] * x[2],
                     R[2][0] * x[0] + R[2][1] * x[1] + R[2][2] * x[2]);
        }
    }
}

static void common_rotation_causes_no_friction(void **unused)
{
    (void)unused;
    const struct wb_swept_tape_contact_settings settings = usual();
    struct grip g;
    const double depth = 2e-6;
    grip_create(&g, &settings, depth, true, NULL);
    struct wb_swept_tape_contact_sums sums = step(&g, 1e-6);
    const double normal = sums.normal;
    double largest = 0.0;
    for (int i = 0; i < 1000; i++) {
        turn_field(&g.tape.layout, g.tape.position, 1e-3);
        turn_field(&g.tape.layout, g.tape.director, 1e-3);
        turn_field(&g.layout, g.position, 1e-3);
        sums = step(&g, 1e-6);
        largest = fmax(largest, sums.tangential + sums.friction);
    }
    assert_close_relative(sums.normal, normal, 1e-6);
    print_message("turning: %.2e of the pressure's energy\n", largest / normal);
    assert_true(largest < 1e-6 * normal);
    grip_destroy(&g);
}

static void forces_and_their_moments_balance(void **unused)
{
    (void)unused;
    const struct wb_swept_tape_contact_settings settings = usual();
    struct grip g;
    uint64_t seed = 8;
    grip_create(&g, &settings, 3e-6, true, NULL);
    (void)step(&g, 1e-6);
    for (int i = 1; i <= 30; i++) {
        slide_wire(&g, 1e-6 * i);
        for (size_t n = 0; n < wb_swept_size(&g.layout); n++)
            g.position[n] += 1e-6 * (test_random(&seed) - 0.5);
        (void)step(&g, 1e-6);
    }
    double force[3] = {0.0}, moment[3] = {0.0}, size = 0.0;
    for (int body = 0; body < 2; body++) {
        for (int k = 0; k < (body ? SURFACE : RING); k++) {
            for (int j = 0; j < STATIONS; j++) {
                double x[3], f[3], d[3] = {0.0}, m[3] = {0.0};
                tape_get(body ? &g.layout : &g.tape.layout, body ? g.position : g.tape.position, k,
                         j, x);
                if (!body)
                    tape_get(&g.tape.layout, g.tape.director, k, j, d);
                for (int i = 0; i < 3; i++) {
                    f[i] =
                        body ? wire_load(&g, k, i, j) : tape_load(&g.tape, g.tape.force, k, i, j);
                    m[i] = body ? 0.0 : tape_load(&g.tape, g.tape.moment, k, i, j);
                    force[i] += f[i];
                    size += fabs(f[i]);
                }
                for (int i = 0; i < 3; i++) {
                    const int a = (i + 1) % 3, b = (i + 2) % 3;
                    moment[i] += x[a] * f[b] - x[b] * f[a] + d[a] * m[b] - d[b] * m[a];
                }
            }
        }
    }
    assert_true(fabs(sum_on_wire(&g, 0)) > 0.05 * size);
    for (int i = 0; i < 3; i++) {
        assert_close(force[i], 0.0, 1e-13 * size);
        /* Friction acts at a distance g from the contact point: micrometres. */
        assert_close(moment[i], 0.0, 5e-6 * size);
    }
    grip_destroy(&g);
}

/* --- with a bond --- */

static void contact_takes_over_from_a_broken_bond(void **unused)
{
    (void)unused;
    struct wb_swept_cohesion_settings bonded;
    struct wb_swept_tape_contact_settings settings = usual();
    default_cohesion(&bonded);
    bonded.strength = 0.5e6;
    bonded.shear_strength = 0.2e6;
    bonded.fracture_energy = 25.0;
    settings.refresh_interval = 1;
    struct grip g;
    grip_create(&g, &settings, 2e-6, true, &bonded);
    struct wb_swept_tape_contact_sums sums = step(&g, 1e-6);
    assert_int_equal(wb_swept_tape_contact_near(g.contact), 0);
    assert_true(sums.normal == 0.0);
    /* A slip that breaks all bonds: 2 G / shear_strength = 0.25 mm. */
    const struct wb_swept_cohesion_fields fields = {
        {g.tape.position, g.tape.director, g.tape.force, g.tape.moment},
        (const double *const[]){g.position},
        (void *const[]){g.force}};
    struct wb_swept_cohesion_sums of_bond = {0};
    slide_wire(&g, 0.3e-3);
    wb_swept_cohesion_add_forces(g.cohesion, &fields, 0, wb_swept_tape_blocks(g.tape.tape),
                                 &of_bond);
    assert_close_relative(of_bond.dissipated, 25.0 * wb_swept_cohesion_area(g.cohesion), 1e-9);
    (void)step(&g, 1e-6); /* detects broken bonds */
    sums = step(&g, 1e-6);
    /* The first station's nodes no longer have a wire below them. */
    assert_int_equal(wb_swept_tape_contact_near(g.contact), RING * (STATIONS - 1));
    assert_close_relative(sums.normal, 0.5 * 30e9 * 4e-12 * area_of(&g) * 22.5 / 23.0, 1e-4);
    grip_destroy(&g);
}

/* --- stable step, invalid input --- */

static void bounds_exceed_the_springs_stiffness(void **unused)
{
    (void)unused;
    const struct wb_swept_tape_contact_settings settings = usual();
    struct grip g;
    double mass[RING], inertia[RING], wire_mass[SURFACE];
    grip_create(&g, &settings, 2e-6, true, NULL);
    wb_swept_tape_masses(g.tape.tape, mass, inertia);
    for (int k = 0; k < RING; k++) {
        mass[k] *= spacing;
        inertia[k] *= spacing;
    }
    for (int k = 0; k < SURFACE; k++)
        wire_mass[k] = mass[0];
    const double area = wb_swept_tape_area(g.tape.tape, 0, 5);
    const double alone = 30e9 * area / mass[0];
    const double tape = wb_swept_tape_contact_stiffness_per_mass(g.contact, mass, inertia);
    const double wire = wb_swept_tape_contact_wire_stiffness_per_mass(g.contact, 0, wire_mass);
    /* A spring acts on both sides, on the tape's with a lever to its director. */
    assert_true(tape > 2.0 * alone && tape < 6.0 * alone);
    assert_true(wire > 2.0 * alone * RING / SURFACE && wire < 6.0 * alone);
    grip_destroy(&g);
}

static void failed_steps_and_invalid_input_are_reported(void **unused)
{
    (void)unused;
    struct wb_swept_tape_contact_settings settings = usual();
    struct wb_swept_tape_contact_sums sums;
    struct grip g;
    wb_log_set_sink(discard_message, NULL);
    settings.refresh_interval = 1;
    grip_create(&g, &settings, 2e-6, false, NULL);
    g.position[swept_at(&g.layout, 3, 1, 5)] = (double)NAN;
    assert_int_equal(try_step(&g, 1e-6, &sums), WB_ERR_DATA);
    grip_destroy(&g);
    grip_create(&g, &settings, 2e-6, false, NULL);
    g.tape.director[swept_at(&g.tape.layout, 3, 1, 5)] = (double)NAN;
    assert_int_equal(try_step(&g, 1e-6, &sums), WB_ERR_DATA);
    grip_destroy(&g);
    grip_create(&g, &settings, 0.55 * radius, false, NULL);
    assert_int_equal(try_step(&g, 1e-6, &sums), WB_ERR_DATA);
    struct wb_swept_tape_contact *contact = NULL;
    const struct wb_swept_wire wire = {.node = (const double(*)[2])g.node,
                                       .n_nodes = SURFACE,
                                       .n_surface = SURFACE,
                                       .surface = g.surface};
    assert_int_equal(wb_swept_tape_contact_create(&contact, g.tape.tape, NULL, &settings, 1, &wire),
                     WB_ERR_ARGUMENT);
    settings.friction.mu_kinetic = 0.5; /* above the static one */
    assert_int_equal(wb_swept_tape_contact_create(&contact, g.tape.tape, NULL, &settings, 0, NULL),
                     WB_ERR_ARGUMENT);
    settings.friction.mu_kinetic = (double)NAN;
    assert_int_equal(wb_swept_tape_contact_create(&contact, g.tape.tape, NULL, &settings, 0, NULL),
                     WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
    assert_null(contact);
    wb_swept_tape_contact_destroy(NULL);
    grip_destroy(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pressure_is_stiffness_times_depth),
        cmocka_unit_test(no_force_acts_across_a_gap),
        cmocka_unit_test(forces_are_the_derivatives_of_the_pressures_energy),
        cmocka_unit_test(sliding_around_a_wire_adds_no_energy),
        cmocka_unit_test(sliding_friction_is_mu_times_the_pressure),
        cmocka_unit_test(a_checkpoint_continues_bit_for_bit),
        cmocka_unit_test(sticking_is_elastic),
        cmocka_unit_test(common_rotation_causes_no_friction),
        cmocka_unit_test(forces_and_their_moments_balance),
        cmocka_unit_test(contact_takes_over_from_a_broken_bond),
        cmocka_unit_test(bounds_exceed_the_springs_stiffness),
        cmocka_unit_test(failed_steps_and_invalid_input_are_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
