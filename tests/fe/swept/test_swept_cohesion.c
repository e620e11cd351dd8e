/* Forces of cohesion without damage: tractions, balance, energy, stable step. */
#include "fe/swept/swept_private.h"

#include "tests/fe/swept/taped_block.h"

static void opening_uses_only_the_normal_stiffness(void **unused)
{
    (void)unused;
    struct wb_swept_cohesion_settings settings;
    default_cohesion(&settings);
    struct pair p = pair_create(&settings, true, WB_SWEPT_BEST);
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
        /* An inner node has its full area; half at the ends. */
        assert_close_relative(tape_load(&p.tape, p.tape.force, 2, 1, 7),
                              -30e9 * open * width / 4.0 * spacing, 1e-9);
        assert_close_relative(tape_load(&p.tape, p.tape.force, 2, 1, 19),
                              -30e9 * open * width / 4.0 * spacing / 2.0, 1e-9);
    }
    pair_destroy(&p);
}

static void shear_uses_only_the_shear_stiffness(void **unused)
{
    (void)unused;
    struct wb_swept_cohesion_settings settings;
    default_cohesion(&settings);
    struct pair p = pair_create(&settings, true, WB_SWEPT_BEST);
    double sum[3];
    set_tape(&p, 3e-6, 0.0, -4e-6);
    const struct wb_swept_cohesion_sums sums = pair_forces(&p);
    sum_tape(&p, sum);
    assert_close_relative(sum[0], -10e9 * 3e-6 * whole_area, 1e-9);
    assert_close_relative(sum[2], 10e9 * 4e-6 * whole_area, 1e-9);
    assert_close(sum[1], 0.0, 1e-12 * sum[2]);
    assert_close_relative(sums.stored, 0.5 * 10e9 * 25e-12 * whole_area, 1e-9);
    /* The shear acts at the tape's lower side, with the lever o on the directors. */
    assert_close_relative(tape_load(&p.tape, p.tape.moment, 2, 0, 7),
                          gap * 10e9 * 3e-6 * width / 4.0 * spacing, 1e-9);
    pair_destroy(&p);
}

static void shear_rotates_with_the_pair(void **unused)
{
    (void)unused;
    struct wb_swept_cohesion_settings settings;
    default_cohesion(&settings);
    for (int is_double = 0; is_double < 2; is_double++) {
        struct pair p = pair_create(&settings, is_double, WB_SWEPT_BEST);
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
        /* Zero after rotation, to the round-off of an offset of 1e-4 m. */
        set_tape(&p, 0.0, 0.0, 0.0);
        turn_field(&p.tape.layout, p.tape.position, angle);
        assert_close(pair_forces(&p).stored, 0.0, is_double ? 1e-20 : 1e-14);
        pair_destroy(&p);
    }
}

static void forces_are_the_derivatives_of_the_energy(void **unused)
{
    (void)unused;
    struct wb_swept_cohesion_settings settings;
    default_cohesion(&settings);
    struct pair p = shaken(&settings, true, WB_SWEPT_BEST);
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
        struct pair p = shaken(&settings, is_double, WB_SWEPT_BEST);
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
    struct pair base = shaken(&settings, true, WB_SWEPT_BASELINE);
    const struct wb_swept_cohesion_sums expected = pair_forces(&base);
    int tried = 0;
    assert_true(expected.dissipated > 0.01 * expected.stored);
    for (int is_double = 0; is_double < 2; is_double++) {
        for (int way = WB_SWEPT_BASELINE; way <= WB_SWEPT_AVX512; way++) {
            static const char *const feature[] = {"", "", "avx2", "avx512"};
            enum wb_swept_instructions chosen;
            wb_log_set_sink(discard_message, NULL);
            const enum wb_status status = wb_swept_choose_instructions(&chosen, way);
            wb_log_set_sink(NULL, NULL);
            if (status != WB_OK)
                continue;
            struct pair p = shaken(&settings, is_double, way);
            if (way > WB_SWEPT_BASELINE)
                assert_string_equal(
                    wb_swept_instructions_name(wb_swept_tape_get_model(p.tape.tape)->instructions),
                    feature[way]);
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

static void frequency_bound_of_cohesion_holds(void **unused)
{
    (void)unused;
    struct wb_swept_cohesion_settings settings;
    default_cohesion(&settings);
    for (int heavy = 0; heavy < 2; heavy++) {
        struct pair p = pair_create(&settings, true, WB_SWEPT_BEST);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(opening_uses_only_the_normal_stiffness),
        cmocka_unit_test(shear_uses_only_the_shear_stiffness),
        cmocka_unit_test(shear_rotates_with_the_pair),
        cmocka_unit_test(forces_are_the_derivatives_of_the_energy),
        cmocka_unit_test(forces_and_their_moments_balance),
        cmocka_unit_test(instruction_sets_and_precisions_agree),
        cmocka_unit_test(frequency_bound_of_cohesion_holds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
