#include "fe/swept_cohesion.h"

#include "tests/fe/tapes.h"

enum {
    NODES = 5,
    STATIONS = 20,
    CORNERS = 8
};

static const double gap = 0.1e-3, width = 2e-3, spacing = 0.5e-3;

/* A flat tape on a wire of rectangular section, whose upper side is y = 0 and has five nodes. */
static const double block_node[CORNERS][2] = {{0.0, 1.5e-3},  {0.0, 0.7e-3},  {0.0, 0.1e-3},
                                              {0.0, -0.6e-3}, {0.0, -1.4e-3}, {-1e-3, -1.4e-3},
                                              {-1e-3, 0.0},   {-1e-3, 1.5e-3}};
static const int block_surface[CORNERS] = {0, 1, 2, 3, 4, 5, 6, 7};
static const struct wb_swept_cohesion_wire block = {0.0,     0.0,     block_node,
                                                    CORNERS, CORNERS, block_surface};

struct pair {
    struct test_tape tape;
    struct wb_swept_cohesion *cohesion;
    struct wb_swept_layout layout; /* of the wire */
    double *position;
    void *force;
};

static struct wb_swept_cohesion_settings brittle(void)
{
    struct wb_swept_cohesion_settings settings;
    wb_swept_cohesion_default_settings(&settings);
    settings.strength = 0.5e6;
    settings.shear_strength = 0.2e6;
    settings.fracture_energy = 25.0;
    return settings;
}

static void place_block(const struct wb_swept_layout *layout, double *position)
{
    for (int k = 0; k < CORNERS; k++) {
        for (int j = 0; j < STATIONS; j++)
            tape_put(layout, position, k, j, spacing * j, block_node[k][0], block_node[k][1]);
    }
}

static struct pair pair_create(const struct wb_swept_cohesion_settings *settings, bool is_double,
                               enum wb_swept_tape_instructions instructions)
{
    struct wb_swept_tape_model model = tape_model(&elastic_tape, NODES, STATIONS, false, spacing);
    struct wb_swept_cohesion_bond bond[NODES * STATIONS];
    struct pair p = {.layout = wb_swept_layout(CORNERS, STATIONS)};
    for (int k = 0; k < NODES; k++) {
        for (int j = 0; j < STATIONS; j++) {
            tape_put(&model.layout, model.position, k, j, spacing * j, gap,
                     width * (0.5 - (double)k / (NODES - 1)));
            bond[k * STATIONS + j] = (struct wb_swept_cohesion_bond){0, 1.0};
        }
    }
    model.double_precision = is_double;
    model.instructions = instructions;
    p.tape = test_tape_create(&model);
    assert_int_equal(wb_swept_cohesion_create(&p.cohesion, p.tape.tape, settings, 1, &block, bond),
                     WB_OK);
    p.position = swept_field(&p.layout);
    p.force = swept_field(&p.layout);
    place_block(&p.layout, p.position);
    return p;
}

static void pair_destroy(struct pair *p)
{
    wb_swept_cohesion_destroy(p->cohesion);
    test_tape_destroy(&p->tape);
    free(p->position);
    free(p->force);
}

/* Cohesion alone. */
static struct wb_swept_cohesion_sums pair_forces(struct pair *p)
{
    const struct wb_swept_cohesion_fields fields = {
        {p->tape.position, p->tape.director, p->tape.force, p->tape.moment},
        (const double *const[]){p->position},
        (void *const[]){p->force}};
    const size_t size = p->tape.model.double_precision ? sizeof(double) : sizeof(float);
    struct wb_swept_cohesion_sums sums = {0};
    memset(p->tape.force, 0, wb_swept_size(&p->tape.layout) * size);
    memset(p->tape.moment, 0, wb_swept_size(&p->tape.layout) * size);
    memset(p->force, 0, wb_swept_size(&p->layout) * size);
    wb_swept_cohesion_add_forces(p->cohesion, &fields, 0, wb_swept_tape_blocks(p->tape.tape),
                                 &sums);
    return sums;
}

static double block_load(const struct pair *p, int node, int component, int station)
{
    const size_t at = swept_at(&p->layout, node, component, station);
    return p->tape.model.double_precision ? ((double *)p->force)[at]
                                          : (double)((float *)p->force)[at];
}

static void move_tape(struct pair *p, double x, double y, double z)
{
    const double by[3] = {x, y, z};
    for (int k = 0; k < NODES; k++) {
        for (int j = 0; j < STATIONS; j++) {
            for (int i = 0; i < 3; i++)
                p->tape.position[swept_at(&p->tape.layout, k, i, j)] += by[i];
        }
    }
}

static void set_tape(struct pair *p, double x, double y, double z)
{
    memcpy(p->tape.position, p->tape.model.position,
           wb_swept_size(&p->tape.layout) * sizeof(double));
    move_tape(p, x, y, z);
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

static void shake_field(const struct wb_swept_layout *layout, double *field, double size,
                        uint64_t *seed)
{
    for (int k = 0; k < layout->n_nodes; k++) {
        for (int j = 0; j < layout->n_stations; j++) {
            for (int i = 0; i < 3; i++)
                field[swept_at(layout, k, i, j)] += size * (2.0 * test_random(seed) - 1.0);
        }
    }
}

static void sum_tape(const struct pair *p, double sum[3])
{
    for (int i = 0; i < 3; i++) {
        sum[i] = 0.0;
        for (int k = 0; k < NODES; k++) {
            for (int j = 0; j < STATIONS; j++)
                sum[i] += tape_load(&p->tape, p->tape.force, k, i, j);
        }
    }
}

static const double whole_area = 2e-3 * 0.5e-3 * (STATIONS - 1);

/* --- elastic --- */

static void opening_is_borne_by_the_normal_stiffness_alone(void **unused)
{
    (void)unused;
    struct wb_swept_cohesion_settings settings;
    wb_swept_cohesion_default_settings(&settings);
    struct pair p = pair_create(&settings, true, WB_SWEPT_TAPE_BEST);
    double sum[3];
    assert_close_relative(wb_swept_cohesion_area(p.cohesion), whole_area, 1e-12);
    assert_close(pair_forces(&p).stored, 0.0, 1e-25);
    for (int sign = -1; sign <= 1; sign += 2) {
        const double open = sign * 2e-6;
        set_tape(&p, 0.0, open, 0.0);
        const struct wb_swept_cohesion_sums sums = pair_forces(&p);
        sum_tape(&p, sum);
        assert_close_relative(sum[1], -30e9 * open * whole_area, 1e-9);
        assert_close(sum[0], 0.0, 1e-12 * fabs(sum[1]));
        assert_close(sum[2], 0.0, 1e-12 * fabs(sum[1]));
        assert_close_relative(sums.stored, 0.5 * 30e9 * open * open * whole_area, 1e-9);
        assert_true(sums.dissipated == 0.0);
        /* A node inside: its own area; half at the ends. */
        assert_close_relative(tape_load(&p.tape, p.tape.force, 2, 1, 7),
                              -30e9 * open * width / 4.0 * spacing, 1e-9);
        assert_close_relative(tape_load(&p.tape, p.tape.force, 2, 1, 19),
                              -30e9 * open * width / 4.0 * spacing / 2.0, 1e-9);
    }
    pair_destroy(&p);
}

static void shear_is_borne_by_the_shear_stiffness_alone(void **unused)
{
    (void)unused;
    struct wb_swept_cohesion_settings settings;
    wb_swept_cohesion_default_settings(&settings);
    struct pair p = pair_create(&settings, true, WB_SWEPT_TAPE_BEST);
    double sum[3];
    set_tape(&p, 3e-6, 0.0, -4e-6);
    const struct wb_swept_cohesion_sums sums = pair_forces(&p);
    sum_tape(&p, sum);
    assert_close_relative(sum[0], -10e9 * 3e-6 * whole_area, 1e-9);
    assert_close_relative(sum[2], 10e9 * 4e-6 * whole_area, 1e-9);
    assert_close(sum[1], 0.0, 1e-12 * sum[2]);
    assert_close_relative(sums.stored, 0.5 * 10e9 * 25e-12 * whole_area, 1e-9);
    /* The shear acts at the tape's lower side: o times it turns the directors. */
    assert_close_relative(tape_load(&p.tape, p.tape.moment, 2, 0, 7),
                          gap * 10e9 * 3e-6 * width / 4.0 * spacing, 1e-9);
    pair_destroy(&p);
}

static void shear_of_a_turned_pair_follows_it(void **unused)
{
    (void)unused;
    struct wb_swept_cohesion_settings settings;
    wb_swept_cohesion_default_settings(&settings);
    for (int is_double = 0; is_double < 2; is_double++) {
        struct pair p = pair_create(&settings, is_double, WB_SWEPT_TAPE_BEST);
        double sum[3], R[3][3];
        const double angle = 1.2, open[3] = {3e-6, 5e-6, -4e-6};
        const double traction[3] = {-10e9 * open[0], -30e9 * open[1], -10e9 * open[2]};
        set_tape(&p, open[0], open[1], open[2]);
        turn_field(&p.tape.layout, p.tape.position, angle);
        turn_field(&p.tape.layout, p.tape.director, angle);
        turn_field(&p.layout, p.position, angle);
        (void)pair_forces(&p);
        sum_tape(&p, sum);
        swept_rotation(angle, R);
        for (int i = 0; i < 3; i++)
            assert_close(sum[i],
                         whole_area * (R[i][0] * traction[0] + R[i][1] * traction[1] +
                                       R[i][2] * traction[2]),
                         (is_double ? 1e-9 : 2e-5) * whole_area * 150e3);
        /* At rest when turned: to round-off of an offset, 1e-4 m. */
        set_tape(&p, 0.0, 0.0, 0.0);
        turn_field(&p.tape.layout, p.tape.position, angle);
        assert_close(pair_forces(&p).stored, 0.0, is_double ? 1e-20 : 1e-14);
        pair_destroy(&p);
    }
}

/* Positions, directors and wire off by much, turned. */
static struct pair shaken(const struct wb_swept_cohesion_settings *settings, bool is_double,
                          enum wb_swept_tape_instructions instructions)
{
    struct pair p = pair_create(settings, is_double, instructions);
    uint64_t seed = 4;
    move_tape(&p, 8e-6, 10e-6, 4e-6);
    shake_field(&p.tape.layout, p.tape.position, 8e-6, &seed);
    shake_field(&p.tape.layout, p.tape.director, 0.03, &seed);
    shake_field(&p.layout, p.position, 8e-6, &seed);
    turn_field(&p.tape.layout, p.tape.position, 0.6);
    turn_field(&p.tape.layout, p.tape.director, 0.6);
    turn_field(&p.layout, p.position, 0.6);
    return p;
}

static void forces_are_the_derivatives_of_the_energy(void **unused)
{
    (void)unused;
    struct wb_swept_cohesion_settings settings;
    wb_swept_cohesion_default_settings(&settings);
    struct pair p = shaken(&settings, true, WB_SWEPT_TAPE_BEST);
    const size_t tape = wb_swept_size(&p.tape.layout), wire = wb_swept_size(&p.layout);
    double *force = malloc((2 * tape + wire) * sizeof *force);
    assert_non_null(force);
    (void)pair_forces(&p);
    memcpy(force, p.tape.force, tape * sizeof *force);
    memcpy(force + tape, p.tape.moment, tape * sizeof *force);
    memcpy(force + 2 * tape, p.force, wire * sizeof *force);
    double *field[3] = {p.tape.position, p.tape.director, p.position};
    for (int f = 0; f < 3; f++) {
        for (int k = 0; k < (f == 2 ? CORNERS : NODES); k++) {
            for (int c = 0; c < 3; c++) {
                for (int j = 0; j < STATIONS; j += 6) {
                    const size_t at = swept_at(f == 2 ? &p.layout : &p.tape.layout, k, c, j);
                    const double step = f == 1 ? 1e-4 : 1e-8, saved = field[f][at];
                    field[f][at] = saved + step;
                    const double above = pair_forces(&p).stored;
                    field[f][at] = saved - step;
                    const double below = pair_forces(&p).stored;
                    field[f][at] = saved;
                    /* Forces are up to 0.2 N, moments to 1e-5 N m. */
                    assert_close(force[(size_t)f * tape + at], -(above - below) / (2.0 * step),
                                 f == 1 ? 1e-11 : 1e-8);
                }
            }
        }
    }
    free(force);
    pair_destroy(&p);
}

static void forces_and_their_moments_balance(void **unused)
{
    (void)unused;
    const struct wb_swept_cohesion_settings settings = brittle();
    for (int is_double = 0; is_double < 2; is_double++) {
        struct pair p = shaken(&settings, is_double, WB_SWEPT_TAPE_BEST);
        (void)pair_forces(&p);
        double force[3] = {0.0}, moment[3] = {0.0}, size = 0.0;
        for (int body = 0; body < 2; body++) {
            for (int k = 0; k < (body ? CORNERS : NODES); k++) {
                for (int j = 0; j < STATIONS; j++) {
                    double x[3], f[3], d[3] = {0.0}, m[3] = {0.0};
                    tape_get(body ? &p.layout : &p.tape.layout, body ? p.position : p.tape.position,
                             k, j, x);
                    for (int i = 0; i < 3; i++) {
                        f[i] = body ? block_load(&p, k, i, j)
                                    : tape_load(&p.tape, p.tape.force, k, i, j);
                        m[i] = body ? 0.0 : tape_load(&p.tape, p.tape.moment, k, i, j);
                        size += fabs(f[i]);
                    }
                    if (!body)
                        tape_get(&p.tape.layout, p.tape.director, k, j, d);
                    for (int i = 0; i < 3; i++) {
                        const int a = (i + 1) % 3, b = (i + 2) % 3;
                        force[i] += f[i];
                        moment[i] += x[a] * f[b] - x[b] * f[a] + d[a] * m[b] - d[b] * m[a];
                    }
                }
            }
        }
        const double eps = is_double ? 2.2e-16 : 1.2e-7;
        assert_true(size > 0.1);
        for (int i = 0; i < 3; i++) {
            assert_close(force[i], 0.0, 10.0 * eps * size);
            assert_close(moment[i], 0.0, 10.0 * eps * size * 10e-3);
        }
        pair_destroy(&p);
    }
}

static void instruction_sets_and_precisions_agree(void **unused)
{
    (void)unused;
    const struct wb_swept_cohesion_settings settings = brittle();
    struct pair base = shaken(&settings, true, WB_SWEPT_TAPE_BASELINE);
    const struct wb_swept_cohesion_sums expected = pair_forces(&base);
    int tried = 0;
    assert_true(expected.dissipated > 0.01 * expected.stored);
    for (int is_double = 0; is_double < 2; is_double++) {
        for (int way = WB_SWEPT_TAPE_BASELINE; way <= WB_SWEPT_TAPE_AVX512; way++) {
            static const char *const feature[] = {"", "", "avx2", "avx512"};
            if ((way == WB_SWEPT_TAPE_AVX2 && !__builtin_cpu_supports("avx2")) ||
                (way == WB_SWEPT_TAPE_AVX512 && !__builtin_cpu_supports("avx512dq")))
                continue;
            struct pair p = shaken(&settings, is_double, way);
            if (way > WB_SWEPT_TAPE_BASELINE)
                assert_string_equal(wb_swept_tape_instructions(p.tape.tape), feature[way]);
            const struct wb_swept_cohesion_sums sums = pair_forces(&p);
            assert_close_relative(sums.stored, expected.stored, is_double ? 1e-12 : 1e-5);
            assert_close_relative(sums.dissipated, expected.dissipated, is_double ? 1e-12 : 1e-4);
            for (int k = 0; k < CORNERS; k++) {
                for (int j = 0; j < STATIONS; j++) {
                    for (int i = 0; i < 3; i++)
                        assert_close(block_load(&p, k, i, j), block_load(&base, k, i, j),
                                     is_double ? 1e-14 : 1e-5);
                }
            }
            tried++;
            pair_destroy(&p);
        }
    }
    assert_true(tried >= 2);
    pair_destroy(&base);
}

/* --- damage --- */

/* Opens by `n` and slides by `s` m in so many steps, and takes the work. */
static double work_of(struct pair *p, double n, double s, int steps, double *dissipated)
{
    double work = 0.0, before[3] = {0.0}, sum[3];
    *dissipated = 0.0;
    for (int step = 1; step <= steps; step++) {
        const double part = (double)step / steps;
        set_tape(p, 0.6 * s * part, n * part, 0.8 * s * part);
        *dissipated += pair_forces(p).dissipated;
        sum_tape(p, sum);
        work -= (0.5 * (sum[0] + before[0]) * 0.6 * s + 0.5 * (sum[1] + before[1]) * n +
                 0.5 * (sum[2] + before[2]) * 0.8 * s) /
                steps;
        memcpy(before, sum, sizeof sum);
    }
    return work;
}

static void area_below_the_curve_is_the_fracture_energy(void **unused)
{
    (void)unused;
    const struct wb_swept_cohesion_settings settings = brittle();
    /* Of bilinear curves: final opening 2 G / strength = 100 um, final slip 250 um. */
    const double way[3][2] = {{110e-6, 0.0}, {0.0, 260e-6}, {80e-6, 200e-6}};
    for (int is_double = 0; is_double < 2; is_double++) {
        for (int mode = 0; mode < 3; mode++) {
            struct pair p = pair_create(&settings, is_double, WB_SWEPT_TAPE_BEST);
            double dissipated = 0.0;
            const double work = work_of(&p, way[mode][0], way[mode][1], 4000, &dissipated);
            const double expected = 25.0 * whole_area;
            assert_close_relative(work, expected, 1e-4);
            assert_close_relative(dissipated, expected, is_double ? 1e-9 : 1e-4);
            assert_close(wb_swept_cohesion_damage(p.cohesion, 2, 7), 1.0, 0.0);
            const struct wb_swept_cohesion_sums sums = pair_forces(&p);
            assert_true(sums.stored == 0.0 && sums.dissipated == 0.0);
            pair_destroy(&p);
        }
    }
}

static void traction_peaks_at_the_strength(void **unused)
{
    (void)unused;
    const struct wb_swept_cohesion_settings settings = brittle();
    for (int mode = 0; mode < 2; mode++) {
        struct pair p = pair_create(&settings, true, WB_SWEPT_TAPE_BEST);
        double largest = 0.0, at = 0.0, sum[3];
        for (int step = 1; step <= 1000; step++) {
            const double opened = 0.1e-6 * step;
            set_tape(&p, mode ? opened : 0.0, mode ? 0.0 : opened, 0.0);
            (void)pair_forces(&p);
            sum_tape(&p, sum);
            const double traction = -sum[mode ? 0 : 1] / whole_area;
            if (traction > largest) {
                largest = traction;
                at = opened;
            }
        }
        const double strength = mode ? 0.2e6 : 0.5e6, stiffness = mode ? 10e9 : 30e9;
        assert_close_relative(largest, strength, 0.01);
        assert_close(at, strength / stiffness, 0.1e-6);
        pair_destroy(&p);
    }
}

static void unloading_goes_back_to_the_origin(void **unused)
{
    (void)unused;
    const struct wb_swept_cohesion_settings settings = brittle();
    struct pair p = pair_create(&settings, true, WB_SWEPT_TAPE_BEST);
    double sum[3], again[3];
    set_tape(&p, 0.0, 50e-6, 0.0);
    const struct wb_swept_cohesion_sums first = pair_forces(&p);
    sum_tape(&p, sum);
    /* Half way down: G (l - 1) / (l_f - 1) of a bilinear curve, in one step. */
    const double onset = 0.5e6 / 30e9, end = 100e-6;
    assert_close_relative(-sum[1] / whole_area, 0.5e6 * (end - 50e-6) / (end - onset), 1e-9);
    assert_close_relative(first.dissipated, 25.0 * whole_area * (50e-6 - onset) / (end - onset),
                          1e-9);
    set_tape(&p, 0.0, 25e-6, 0.0);
    assert_true(pair_forces(&p).dissipated == 0.0);
    sum_tape(&p, again);
    assert_close_relative(again[1], 0.5 * sum[1], 1e-12);
    /* Pressed together it is as stiff as ever. */
    set_tape(&p, 0.0, -2e-6, 0.0);
    (void)pair_forces(&p);
    sum_tape(&p, again);
    assert_close_relative(again[1], 30e9 * 2e-6 * whole_area, 1e-9);
    /* Virgin again. */
    wb_swept_cohesion_reset(p.cohesion);
    set_tape(&p, 0.0, 10e-6, 0.0);
    (void)pair_forces(&p);
    sum_tape(&p, again);
    assert_close_relative(again[1], -30e9 * 10e-6 * whole_area, 1e-9);
    pair_destroy(&p);
}

/* --- where it is bonded --- */

/* A sleeve round a wire of twelve surface nodes. */
static void sleeve_faces_the_wire_it_lies_on(void **unused)
{
    (void)unused;
    const double radius = 0.7e-3, around = 0.85e-3;
    struct wb_swept_tape_model model = tape_model(&elastic_tape, 30, 9, true, spacing);
    struct wb_swept_cohesion_bond bond[30 * 9];
    double node[13][2] = {{0.0}}, wire_y = 2e-3, wire_z = -1e-3;
    int surface[12];
    make_tube(&model, around, 0.0, 1.0);
    for (int i = 0; i < 12; i++) {
        surface[i] = i + 1;
        node[i + 1][0] = radius * cos(2.0 * M_PI * i / 12);
        node[i + 1][1] = radius * sin(2.0 * M_PI * i / 12);
    }
    for (int k = 0; k < 30; k++) {
        for (int j = 0; j < 9; j++) {
            double *at = (double *)model.position;
            at[swept_at(&model.layout, k, 1, j)] += wire_y;
            at[swept_at(&model.layout, k, 2, j)] += wire_z;
            bond[9 * k + j] = (struct wb_swept_cohesion_bond){k % 3 ? 0 : -1, 0.5};
        }
    }
    const struct wb_swept_cohesion_wire wire = {wire_y, wire_z, (const double(*)[2])node,
                                                13,     12,     surface};
    struct wb_swept_cohesion_settings settings;
    struct wb_swept_cohesion *cohesion = NULL;
    wb_swept_cohesion_default_settings(&settings);
    struct test_tape t = test_tape_create(&model);
    assert_int_equal(wb_swept_cohesion_create(&cohesion, t.tape, &settings, 1, &wire, bond), WB_OK);
    assert_close_relative(wb_swept_cohesion_area(cohesion),
                          0.5 * 20 * 2.0 * around * sin(M_PI / 30) * 8 * spacing, 1e-9);
    assert_close(wb_swept_cohesion_damage(cohesion, 0, 3), 1.0, 0.0);
    assert_close(wb_swept_cohesion_damage(cohesion, 1, 3), 0.0, 0.0);
    /* At rest in the reference state; then the wire grows by 1 %, all round. */
    const struct wb_swept_layout layout = wb_swept_layout(13, 9);
    double *position = swept_field(&layout), *force = swept_field(&layout);
    for (int grown = 0; grown < 2; grown++) {
        const double factor = grown ? 1.01 : 1.0;
        for (int k = 0; k < 13; k++) {
            for (int j = 0; j < 9; j++)
                tape_put(&layout, position, k, j, spacing * j, wire_y + factor * node[k][0],
                         wire_z + factor * node[k][1]);
        }
        const struct wb_swept_cohesion_fields fields = {{t.position, t.director, t.force, t.moment},
                                                        (const double *const[]){position},
                                                        (void *const[]){force}};
        struct wb_swept_cohesion_sums sums = {0};
        wb_swept_cohesion_add_forces(cohesion, &fields, 0, 1, &sums);
        /* All squeezed by 1 % of the chord's distance, on average about cos(pi / 12)... of r. */
        const double area = wb_swept_cohesion_area(cohesion);
        const double squeezed = 0.5 * 30e9 * area * 7e-6 * 7e-6;
        if (grown) {
            assert_true(sums.stored < squeezed && sums.stored > 0.93 * squeezed);
        } else {
            assert_close(sums.stored, 0.0, 1e-22);
        }
    }
    wb_swept_cohesion_destroy(cohesion);
    free(position);
    free(force);
    test_tape_destroy(&t);
}

/* An open ring of two turns, the second one thickness farther out: half-lapped. */
static void windings_are_bonded_to_the_one_inside(void **unused)
{
    (void)unused;
    enum {
        RING = 41,
        LONG = 18
    };
    struct wb_swept_tape_model model = tape_model(&elastic_tape, RING, LONG, false, spacing);
    struct wb_swept_cohesion_bond bond[RING * LONG];
    for (int k = 0; k < RING; k++) {
        for (int j = 0; j < LONG; j++) {
            const double angle = 4.0 * M_PI * k / (RING - 1) + 0.3 * j;
            const double radius = 2e-3 + 0.1e-3 * k / (0.5 * (RING - 1));
            tape_put(&model.layout, model.position, k, j, spacing * j, radius * sin(angle),
                     radius * cos(angle));
            bond[k * LONG + j] = (struct wb_swept_cohesion_bond){
                k > RING / 2 ? WB_SWEPT_COHESION_TAPE : WB_SWEPT_COHESION_FREE, 1.0};
        }
    }
    struct wb_swept_cohesion_settings settings;
    struct wb_swept_cohesion *cohesion = NULL;
    wb_swept_cohesion_default_settings(&settings);
    struct test_tape t = test_tape_create(&model);
    assert_int_equal(wb_swept_cohesion_create(&cohesion, t.tape, &settings, 0, NULL, bond), WB_OK);
    const struct wb_swept_cohesion_fields fields = {
        {t.position, t.director, t.force, t.moment}, NULL, NULL};
    struct wb_swept_cohesion_sums sums = {0};
    wb_swept_cohesion_add_forces(cohesion, &fields, 0, 2, &sums);
    assert_close(sums.stored, 0.0, 1e-22);
    /* The outer turn lifted by 1 um: nodes one beside the seam pull between themselves. */
    for (int k = RING / 2 + 1; k < RING; k++) {
        for (int j = 0; j < LONG; j++) {
            for (int i = 0; i < 3; i++)
                t.position[swept_at(&t.layout, k, i, j)] +=
                    1e-6 * wb_swept_tape_directors(t.tape)[swept_at(&t.layout, k, i, j)];
        }
    }
    wb_swept_cohesion_add_forces(cohesion, &fields, 0, 2, &sums);
    const double expected = 0.5 * 30e9 * 1e-12 * wb_swept_cohesion_area(cohesion);
    assert_close_relative(sums.stored, expected, 0.06);
    wb_swept_cohesion_destroy(cohesion);
    test_tape_destroy(&t);
}

/* --- stable step --- */

/* Largest eigenvalue of M^-1 K of tape nodes, directors and wire, by power iteration. */
static double fastest(struct pair *p, const double *mass, const double *inertia,
                      const double *wire_mass)
{
    const size_t tape = wb_swept_size(&p->tape.layout), wire = wb_swept_size(&p->layout);
    double *u = calloc(2 * tape + wire, sizeof *u), value = 0.0;
    const double scale = 1e-9;
    uint64_t seed = 3;
    assert_non_null(u);
    for (size_t i = 0; i < 2 * tape + wire; i++)
        u[i] = (test_random(&seed) - 0.5) * (i >= tape && i < 2 * tape ? 1e4 : 1.0);
    for (int iteration = 0; iteration < 300; iteration++) {
        double norm = 0.0;
        for (int f = 0; f < 3; f++) {
            const struct wb_swept_layout *l = f == 2 ? &p->layout : &p->tape.layout;
            const double *m = f == 0 ? mass : f == 1 ? inertia : wire_mass;
            for (size_t i = 0; i < wb_swept_size(l); i++)
                norm += m[i / 3 / (size_t)l->stride] * u[(size_t)f * tape + i] *
                        u[(size_t)f * tape + i];
        }
        norm = sqrt(norm);
        value = iteration > 0 ? norm : value;
        for (size_t i = 0; i < 2 * tape + wire; i++)
            u[i] /= norm;
        /* The norm is of kg m2: of the order of a root of a mass, 1e-4. */
        const double by = scale * sqrt(mass[0]);
        place_block(&p->layout, p->position);
        for (size_t i = 0; i < tape; i++) {
            p->tape.position[i] = p->tape.model.position[i] + by * u[i];
            p->tape.director[i] = wb_swept_tape_directors(p->tape.tape)[i] + by * u[tape + i];
        }
        for (size_t i = 0; i < wire; i++)
            p->position[i] += by * u[2 * tape + i];
        (void)pair_forces(p);
        for (int f = 0; f < 3; f++) {
            const struct wb_swept_layout *l = f == 2 ? &p->layout : &p->tape.layout;
            const double *m = f == 0 ? mass : f == 1 ? inertia : wire_mass;
            const double *force = f == 0 ? p->tape.force : f == 1 ? p->tape.moment : p->force;
            for (size_t i = 0; i < wb_swept_size(l); i++) {
                const size_t j = i % (size_t)l->stride;
                const double part = j == 0 || j == STATIONS - 1 ? 0.5 : 1.0;
                u[(size_t)f * tape + i] = -force[i] / by / (m[i / 3 / (size_t)l->stride] * part);
            }
        }
    }
    free(u);
    return value;
}

static void bound_of_what_it_adds_to_frequencies_holds(void **unused)
{
    (void)unused;
    struct wb_swept_cohesion_settings settings;
    wb_swept_cohesion_default_settings(&settings);
    for (int heavy = 0; heavy < 2; heavy++) {
        struct pair p = pair_create(&settings, true, WB_SWEPT_TAPE_BEST);
        double mass[NODES], inertia[NODES], wire_mass[CORNERS];
        wb_swept_tape_masses(p.tape.tape, mass, inertia);
        for (int k = 0; k < NODES; k++) {
            mass[k] *= spacing;
            inertia[k] *= spacing;
        }
        for (int k = 0; k < CORNERS; k++)
            wire_mass[k] = mass[1] * (heavy ? 10.0 : 1.0);
        const double of_tape = wb_swept_cohesion_tape_stiffness_per_mass(p.cohesion, mass, inertia);
        const double of_wire = wb_swept_cohesion_wire_stiffness_per_mass(p.cohesion, 0, wire_mass);
        const double found = fastest(&p, mass, inertia, wire_mass), bound = fmax(of_tape, of_wire);
        print_message("step of cohesion alone: %.2e s by the bound, %.2e s by iteration\n",
                      2.0 / sqrt(bound), 2.0 / sqrt(found));
        assert_true(found <= bound * (1.0 + 1e-6));
        assert_true(bound < 2.5 * found);
        pair_destroy(&p);
    }
}

/* --- refusals --- */

static void impossible_bonds_are_refused(void **unused)
{
    (void)unused;
    struct wb_swept_cohesion_settings good, bad;
    struct wb_swept_cohesion *cohesion = NULL;
    wb_swept_cohesion_default_settings(&good);
    struct pair p = pair_create(&good, false, WB_SWEPT_TAPE_BEST);
    struct wb_swept_cohesion_bond bond[NODES * STATIONS];
    for (int i = 0; i < NODES * STATIONS; i++)
        bond[i] = (struct wb_swept_cohesion_bond){0, 1.0};
    wb_log_set_sink(discard_message, NULL);
    bad = good;
    bad.normal_stiffness = 0.0;
    assert_int_equal(wb_swept_cohesion_create(&cohesion, p.tape.tape, &bad, 1, &block, bond),
                     WB_ERR_ARGUMENT);
    bad = brittle();
    bad.fracture_energy = 3.0; /* 4.2 J/m2 are stored at the strength */
    assert_int_equal(wb_swept_cohesion_create(&cohesion, p.tape.tape, &bad, 1, &block, bond),
                     WB_ERR_ARGUMENT);
    bad.fracture_energy = (double)NAN;
    assert_int_equal(wb_swept_cohesion_create(&cohesion, p.tape.tape, &bad, 1, &block, bond),
                     WB_ERR_ARGUMENT);
    bond[7].to = 1;
    assert_int_equal(wb_swept_cohesion_create(&cohesion, p.tape.tape, &good, 1, &block, bond),
                     WB_ERR_ARGUMENT);
    bond[7] = (struct wb_swept_cohesion_bond){0, 1.5};
    assert_int_equal(wb_swept_cohesion_create(&cohesion, p.tape.tape, &good, 1, &block, bond),
                     WB_ERR_ARGUMENT);
    bond[7].share = 1.0;
    struct wb_swept_cohesion_wire aside = block;
    aside.z = 5e-3;
    assert_int_equal(wb_swept_cohesion_create(&cohesion, p.tape.tape, &good, 1, &aside, bond),
                     WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
    assert_null(cohesion);
    wb_swept_cohesion_destroy(NULL);
    pair_destroy(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(opening_is_borne_by_the_normal_stiffness_alone),
        cmocka_unit_test(shear_is_borne_by_the_shear_stiffness_alone),
        cmocka_unit_test(shear_of_a_turned_pair_follows_it),
        cmocka_unit_test(forces_are_the_derivatives_of_the_energy),
        cmocka_unit_test(forces_and_their_moments_balance),
        cmocka_unit_test(instruction_sets_and_precisions_agree),
        cmocka_unit_test(area_below_the_curve_is_the_fracture_energy),
        cmocka_unit_test(traction_peaks_at_the_strength),
        cmocka_unit_test(unloading_goes_back_to_the_origin),
        cmocka_unit_test(sleeve_faces_the_wire_it_lies_on),
        cmocka_unit_test(windings_are_bonded_to_the_one_inside),
        cmocka_unit_test(bound_of_what_it_adds_to_frequencies_holds),
        cmocka_unit_test(impossible_bonds_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
