#include "fe/swept/swept_tape.h"

#include <lapacke.h>

#include "tests/fe/swept/tapes.h"

enum {
    FIELDS = 2 /* positions and directors */
};

/* A winding tube with a twisted, uneven mesh. */
static struct test_tape uneven_tube(const struct wb_material *material, bool is_double)
{
    struct wb_swept_tape_model model = tape_model(material, 7, 20, true, 1e-3);
    uint64_t seed = 3;
    make_tube(&model, 2e-3, 0.2, 1.0);
    for (int k = 0; k < 7; k++) {
        for (int j = 0; j < 20; j++) {
            for (int i = 0; i < 3; i++)
                ((double *)model.position)[swept_at(&model.layout, k, i, j)] +=
                    0.2e-3 * (test_random(&seed) - 0.5);
        }
    }
    model.double_precision = is_double;
    return test_tape_create(&model);
}

/* Displaces positions by up to `size` m, directors by up to `turn`. */
static void shake(struct test_tape *t, double size, double turn, uint64_t *seed)
{
    for (int k = 0; k < t->layout.n_nodes; k++) {
        for (int j = 0; j < t->layout.n_stations; j++) {
            for (int i = 0; i < 3; i++) {
                const size_t at = swept_at(&t->layout, k, i, j);
                t->position[at] += size * (2.0 * test_random(seed) - 1.0);
                t->director[at] += turn * (2.0 * test_random(seed) - 1.0);
            }
        }
    }
}

static void turn(struct test_tape *t, double angle, double moved)
{
    double R[3][3];
    swept_rotation(angle, R);
    for (int k = 0; k < t->layout.n_nodes; k++) {
        for (int j = 0; j < t->layout.n_stations; j++) {
            double x[3], d[3];
            tape_get(&t->layout, t->position, k, j, x);
            tape_get(&t->layout, t->director, k, j, d);
            for (int i = 0; i < 3; i++) {
                const size_t at = swept_at(&t->layout, k, i, j);
                t->position[at] = moved + R[i][0] * x[0] + R[i][1] * x[1] + R[i][2] * x[2];
                t->director[at] = R[i][0] * d[0] + R[i][1] * d[1] + R[i][2] * d[2];
            }
        }
    }
}

static double largest_load(const struct test_tape *t, const void *field)
{
    double largest = 0.0;
    for (int k = 0; k < t->layout.n_nodes; k++) {
        for (int j = 0; j < t->layout.n_stations; j++) {
            for (int i = 0; i < 3; i++) {
                const double size = fabs(tape_load(t, field, k, i, j));
                if (!(size <= largest))
                    largest = size;
            }
        }
    }
    return largest;
}

/* --- forces --- */

static void reference_state_has_no_force(void **unused)
{
    (void)unused;
    for (int is_double = 0; is_double < 2; is_double++) {
        struct test_tape t = uneven_tube(&tape_law, is_double);
        const struct wb_swept_tape_sums sums = tape_forces(&t);
        const double unit = (is_double ? 2.2e-16 : 1.2e-7) * 119e6 * 0.2e-3 * 1e-3;
        assert_close(largest_load(&t, t.force), 0.0, unit);
        assert_close(largest_load(&t, t.moment), 0.0, unit * 1e-3);
        assert_close(sums.stored + sums.artificial + sums.largest_strain, 0.0, unit);
        test_tape_destroy(&t);
    }
}

static void rigid_motion_causes_no_force(void **unused)
{
    (void)unused;
    /* Scale: forces at a strain of 1, E h times an element's side. */
    const double unit = 119e6 * 0.2e-3 * 1e-3;
    for (int is_double = 0; is_double < 2; is_double++) {
        /* Positions are 20 times as large as elements. */
        const double eps = is_double ? 20.0 * 2.2e-16 : 1.2e-7;
        struct test_tape t = uneven_tube(&tape_law, is_double);
        for (int i = 0; i < 5; i++) {
            turn(&t, 1.1, 1e-3);
            (void)tape_forces(&t);
            assert_close(largest_load(&t, t.force), 0.0, 10.0 * eps * unit);
            assert_close(largest_load(&t, t.moment), 0.0, 10.0 * eps * unit * 1e-3);
        }
        test_tape_destroy(&t);
    }
}

static void forces_are_the_derivatives_of_the_energy(void **unused)
{
    (void)unused;
    /* An elastic tape at strains of 5 %; every component of some nodes, by fourth-order
     * differences. */
    struct test_tape t = uneven_tube(&elastic_tape, true);
    uint64_t seed = 5;
    shake(&t, 0.05e-3, 0.05, &seed);
    turn(&t, 0.7, 0.0);
    (void)tape_forces(&t);
    const size_t bytes = wb_swept_size(&t.layout) * sizeof(double);
    double *force = malloc(bytes), *moment = malloc(bytes);
    assert_true(force && moment);
    memcpy(force, t.force, bytes);
    memcpy(moment, t.moment, bytes);
    const double scale[FIELDS] = {largest_load(&t, t.force), largest_load(&t, t.moment)};
    for (int k = 0; k < 7; k += 3) {
        for (int j = 0; j < 20; j++) {
            for (int c = 0; c < 3 * FIELDS; c++) {
                const size_t at = swept_at(&t.layout, k, c % 3, j);
                double *x = (c < 3 ? t.position : t.director) + at;
                const double saved = *x, step = c < 3 ? 1e-7 : 1e-4;
                double energy[4];
                for (int s = 0; s < 4; s++) {
                    static const double shift[4] = {-2.0, -1.0, 1.0, 2.0};
                    *x = saved + shift[s] * step;
                    energy[s] = tape_energy(&t);
                }
                *x = saved;
                const double slope =
                    (energy[0] - 8.0 * energy[1] + 8.0 * energy[2] - energy[3]) / (12.0 * step);
                assert_close((c < 3 ? force : moment)[at], -slope, 1e-7 * scale[c / 3]);
            }
        }
    }
    free(force);
    free(moment);
    test_tape_destroy(&t);
}

static void forces_and_their_moments_balance(void **unused)
{
    (void)unused;
    for (int is_double = 0; is_double < 2; is_double++) {
        const double eps = is_double ? 2.2e-16 : 1.2e-7;
        struct test_tape t = uneven_tube(&tape_law, is_double);
        uint64_t seed = 11;
        shake(&t, 0.1e-3, 0.1, &seed);
        (void)tape_forces(&t);
        const double largest = largest_load(&t, t.force);
        double force[3] = {0.0}, moment[3] = {0.0};
        assert_true(largest > 1e-3);
        for (int k = 0; k < 7; k++) {
            for (int j = 0; j < 20; j++) {
                double x[3], d[3], f[3], m[3];
                tape_get(&t.layout, t.position, k, j, x);
                tape_get(&t.layout, t.director, k, j, d);
                for (int i = 0; i < 3; i++) {
                    f[i] = tape_load(&t, t.force, k, i, j);
                    m[i] = tape_load(&t, t.moment, k, i, j);
                    force[i] += f[i];
                }
                for (int i = 0; i < 3; i++) {
                    const int a = (i + 1) % 3, b = (i + 2) % 3;
                    moment[i] += x[a] * f[b] - x[b] * f[a] + d[a] * m[b] - d[b] * m[a];
                }
            }
        }
        for (int i = 0; i < 3; i++) {
            assert_close(force[i], 0.0, 100.0 * eps * largest);
            assert_close(moment[i], 0.0, 100.0 * eps * largest * 20e-3);
        }
        test_tape_destroy(&t);
    }
}

static void blocks_give_the_same_in_several_calls(void **unused)
{
    (void)unused;
    struct test_tape t = uneven_tube(&tape_law, false), u = uneven_tube(&tape_law, false);
    uint64_t seed = 2, again = 2;
    shake(&t, 0.1e-3, 0.1, &seed);
    shake(&u, 0.1e-3, 0.1, &again);
    (void)tape_forces(&t);
    const struct wb_swept_tape_fields fields = {u.position, u.director, u.force, u.moment};
    assert_int_equal(wb_swept_tape_blocks(u.tape), 2);
    wb_swept_tape_forces(u.state, &fields, 0, 1, NULL);
    for (int row = 0; row < 3 * 7; row++) {
        for (int j = 0; j < 16; j++)
            u.position[row * u.layout.stride + j] = (double)NAN; /* not read again */
    }
    wb_swept_tape_forces(u.state, &fields, 1, 2, NULL);
    const size_t bytes = wb_swept_size(&t.layout) * sizeof(float);
    assert_memory_equal(t.force, u.force, bytes);
    assert_memory_equal(t.moment, u.moment, bytes);
    test_tape_destroy(&t);
    test_tape_destroy(&u);
}

static void instruction_sets_agree(void **unused)
{
    (void)unused;
    for (int is_double = 0; is_double < 2; is_double++) {
        struct test_tape base = uneven_tube(&tape_law, true);
        uint64_t seed = 9;
        shake(&base, 0.1e-3, 0.1, &seed);
        (void)tape_forces(&base);
        const double largest = largest_load(&base, base.force);
        int tried = 0;
        for (int way = WB_SWEPT_BASELINE; way <= WB_SWEPT_AVX512; way++) {
            struct test_tape probe = uneven_tube(&tape_law, is_double);
            struct wb_swept_tape_model model = probe.model;
            struct wb_swept_tape *tape = NULL;
            model.instructions = way;
            wb_log_set_sink(discard_message, NULL);
            const enum wb_status status = wb_swept_tape_create(&tape, &model);
            wb_log_set_sink(NULL, NULL);
            if (status == WB_OK) {
                wb_swept_tape_state_destroy(probe.state);
                wb_swept_tape_destroy(probe.tape);
                probe.tape = tape;
                probe.state = wb_swept_tape_state_create(tape);
                uint64_t same = 9;
                shake(&probe, 0.1e-3, 0.1, &same);
                (void)tape_forces(&probe);
                for (int k = 0; k < 7; k++) {
                    for (int j = 0; j < 20; j++) {
                        for (int i = 0; i < 3; i++)
                            assert_close(tape_load(&probe, probe.force, k, i, j),
                                         tape_load(&base, base.force, k, i, j),
                                         (is_double ? 1e-10 : 3e-5) * largest);
                    }
                }
                tried++;
            } else {
                assert_int_equal(status, WB_ERR_UNSUPPORTED);
            }
            test_tape_destroy(&probe);
        }
        assert_true(tried >= 1);
        test_tape_destroy(&base);
    }
}

/* --- one element --- */

/* The stiffness of all unknowns in the reference state, by differences of the forces; masses of 1
 * for positions, `length`^2 for directors. Eigenvalues in ascending order. */
static int element_eigenvalues(double warp, double values[24])
{
    struct wb_swept_tape_model model = tape_model(&elastic_tape, 2, 2, false, 1e-3);
    const double at[4][3] = {
        {0.0, 0.0, 0.0}, {1e-3, 0.1e-3, 0.0}, {0.1e-3, 0.8e-3, warp}, {1.2e-3, 1.1e-3, 0.0}};
    for (int a = 0; a < 4; a++)
        tape_put(&model.layout, model.position, a / 2, a % 2, at[a][0], at[a][1], at[a][2]);
    struct test_tape t = test_tape_create(&model);
    double K[24][24];
    for (int b = 0; b < 24; b++) {
        const size_t place = swept_at(&t.layout, b % 12 / 6, b % 3, b % 6 / 3);
        double *x = (b < 12 ? t.position : t.director) + place;
        const double saved = *x, step = b < 12 ? 1e-8 : 1e-5;
        for (int side = 0; side < 2; side++) {
            *x = saved + (side ? step : -step);
            (void)tape_forces(&t);
            for (int a = 0; a < 24; a++) {
                const double f =
                    tape_load(&t, a < 12 ? t.force : t.moment, a % 12 / 6, a % 3, a % 6 / 3) *
                    (a < 12 ? 1.0 : 1e3);
                K[a][b] = side ? K[a][b] - f / (2.0 * step) : f / (2.0 * step);
            }
        }
        *x = saved;
        for (int a = 0; a < 24; a++)
            K[a][b] *= b < 12 ? 1.0 : 1e3;
    }
    assert_int_equal(LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'N', 'U', 24, &K[0][0], 24, values), 0);
    test_tape_destroy(&t);
    int zero = 0;
    for (int i = 0; i < 24; i++)
        zero += fabs(values[i]) < 1e-6 * values[23];
    return zero;
}

static void element_has_only_rigid_motions_without_energy(void **unused)
{
    (void)unused;
    double values[24];
    assert_int_equal(element_eigenvalues(0.0, values), 6);
    assert_true(values[0] > -1e-6 * values[23]);
    /* The smallest are the hourglass motions of directors: h^2 / 12 / A of the membrane's, and the
     * coefficient. */
    assert_true(values[6] > 1e-5 * values[23]);
    assert_int_equal(element_eigenvalues(0.2e-3, values), 6);
}

/* --- patches --- */

static void constant_strain_is_exact_on_a_distorted_sheet(void **unused)
{
    (void)unused;
    struct wb_swept_tape_model model = tape_model(&elastic_tape, 6, 8, false, 1e-3);
    const double a = 7e-3, b = 4e-3;
    make_sheet(&model, a, b, 0.25);
    struct test_tape t = test_tape_create(&model);
    /* U and then a rotation; lengths change by 3 %. */
    const double U[2][2] = {{1.03, 0.015}, {0.015, 0.99}};
    for (int k = 0; k < 6; k++) {
        for (int j = 0; j < 8; j++) {
            double x[3];
            tape_get(&t.layout, t.position, k, j, x);
            tape_put(&t.layout, t.position, k, j, U[0][0] * x[0] + U[0][1] * x[1],
                     U[1][0] * x[0] + U[1][1] * x[1], 0.0);
        }
    }
    turn(&t, 0.8, 0.0);
    const struct wb_swept_tape_sums sums = tape_forces(&t);
    for (int k = 1; k < 5; k++) {
        for (int j = 1; j < 7; j++) {
            for (int i = 0; i < 3; i++)
                assert_close(tape_load(&t, t.force, k, i, j), 0.0, 1e-12);
        }
    }
    assert_close(largest_load(&t, t.moment), 0.0, 1e-15);
    /* The logarithm by eigenvalues. */
    const double mean = 0.5 * (U[0][0] + U[1][1]), half = 0.5 * (U[0][0] - U[1][1]);
    const double radius = sqrt(half * half + U[0][1] * U[0][1]);
    const double e1 = log(mean + radius), e2 = log(mean - radius);
    const double E = 119e6, nu = 0.3;
    const double density = 0.5 * E / (1.0 - nu * nu) * (e1 * e1 + e2 * e2 + 2.0 * nu * e1 * e2);
    assert_close_relative(sums.stored, density * a * b * 0.2e-3, 1e-5);
    assert_close(sums.artificial, 0.0, 1e-12 * sums.stored);
    /* Force of the last station: from the energy's derivative by its stretch, T / lambda. */
    double pull = 0.0;
    for (int k = 0; k < 6; k++) {
        double f[3], R[3][3];
        for (int i = 0; i < 3; i++)
            f[i] = tape_load(&t, t.force, k, i, 7);
        swept_rotation(0.8, R);
        pull -= R[0][0] * f[0] + R[1][0] * f[1] + R[2][0] * f[2];
    }
    const double angle = 0.5 * atan2(U[0][1], half), c = cos(angle), s = sin(angle);
    const double T1 = E / (1.0 - nu * nu) * (e1 + nu * e2),
                 T2 = E / (1.0 - nu * nu) * (e2 + nu * e1);
    const double P11 = c * c * T1 * exp(-e1) + s * s * T2 * exp(-e2);
    assert_close_relative(pull, P11 * b * 0.2e-3, 1e-4);
    test_tape_destroy(&t);
}

static void logarithm_has_the_documented_accuracy(void **unused)
{
    (void)unused;
    const double E = 119e6, nu = 0.3;
    double worst = 0.0;
    for (int sign = -1; sign <= 1; sign += 2) {
        struct wb_swept_tape_model model = tape_model(&elastic_tape, 2, 2, false, 1e-3);
        make_sheet(&model, 1e-3, 1e-3, 0.0);
        struct test_tape t = test_tape_create(&model);
        const double l = 1.0 + 0.1 * sign; /* both ways */
        for (int a = 0; a < 4; a++)
            tape_put(&t.layout, t.position, a / 2, a % 2, (a % 2) * l * 1e-3, (a / 2) * l * 1e-3,
                     0.0);
        (void)tape_forces(&t);
        const double pull = -2.0 * tape_load(&t, t.force, 1, 0, 1);
        const double off = fabs(pull / (E / (1.0 - nu) * log(l) / l * 0.2e-3 * 1e-3) - 1.0);
        worst = fmax(worst, off);
        test_tape_destroy(&t);
    }
    print_message("force at 10 %% strain: %.1e off\n", worst);
    assert_true(worst < 3e-3);
}

static void pure_bending_is_exact_on_a_distorted_sheet(void **unused)
{
    (void)unused;
    /* Small displacements: w = (kx x^2 + ky y^2) / 2 + kxy x y, d = (-w_x, -w_y, 1). */
    struct wb_swept_tape_model model = tape_model(&elastic_tape, 6, 8, false, 1e-3);
    const double a = 7e-3, b = 4e-3, E = 119e6, nu = 0.3, h = 0.2e-3;
    make_sheet(&model, a, b, 0.25);
    const double kx = 6e-6, ky = -2e-6, kxy = 4e-6; /* 1/m */
    struct test_tape t = test_tape_create(&model);
    for (int k = 0; k < 6; k++) {
        for (int j = 0; j < 8; j++) {
            double x[3];
            tape_get(&t.layout, t.position, k, j, x);
            tape_put(&t.layout, t.position, k, j, x[0], x[1],
                     0.5 * kx * x[0] * x[0] + 0.5 * ky * x[1] * x[1] + kxy * x[0] * x[1]);
            tape_put(&t.layout, t.director, k, j, -kx * x[0] - kxy * x[1], -ky * x[1] - kxy * x[0],
                     1.0);
        }
    }
    const struct wb_swept_tape_sums sums = tape_forces(&t);
    const double D = E * h * h * h / (12.0 * (1.0 - nu * nu));
    const double density =
        0.5 * D * (kx * kx + ky * ky + 2.0 * nu * kx * ky + 2.0 * (1.0 - nu) * kxy * kxy);
    assert_close_relative(sums.stored, density * a * b, 1e-6);
    assert_close(sums.artificial, 0.0, 1e-9 * sums.stored);
    const double moment = D * (kx + nu * ky) * b / 5.0; /* of an edge's node */
    for (int k = 1; k < 5; k++) {
        for (int j = 1; j < 7; j++) {
            for (int i = 0; i < 3; i++) {
                assert_close(tape_load(&t, t.moment, k, i, j), 0.0, 1e-4 * moment);
                assert_close(tape_load(&t, t.force, k, i, j), 0.0, 1e-4 * moment / 1e-3);
            }
        }
    }
    double at_edge = 0.0;
    for (int k = 0; k < 6; k++)
        at_edge += tape_load(&t, t.moment, k, 0, 7);
    /* d_x = -w_x: the moment on it is minus D (w_xx + nu w_yy). */
    assert_close_relative(at_edge, D * (kx + nu * ky) * b, 1e-5);
    test_tape_destroy(&t);
}

/* --- masses and steps --- */

static void masses_agree_with_the_sheet(void **unused)
{
    (void)unused;
    struct wb_swept_tape_model model = tape_model(&elastic_tape, 24, 33, true, 0.5e-3);
    double mass[24], inertia[24], sum = 0.0;
    make_tube(&model, 2.3e-3, 0.0, 1.0);
    struct test_tape t = test_tape_create(&model);
    wb_swept_tape_masses(t.tape, mass, inertia);
    const double side = 2.0 * 2.3e-3 * sin(M_PI / 24);
    for (int k = 0; k < 24; k++) {
        sum += mass[k];
        assert_close_relative(inertia[k] / mass[k], side * 0.5e-3 / 8.0 + 0.2e-3 * 0.2e-3 / 6.0,
                              1e-9);
        assert_close_relative(wb_swept_tape_area(t.tape, k, 5), side * 0.5e-3, 1e-12);
        assert_close_relative(wb_swept_tape_area(t.tape, k, 32), side * 0.25e-3, 1e-12);
    }
    assert_close_relative(sum, 1250.0 * 0.2e-3 * 24 * side, 1e-12);
    test_tape_destroy(&t);
}

/* Largest eigenvalue of M^-1 K by power iteration on the forces. */
static double fastest(struct test_tape *t, double scale)
{
    const struct wb_swept_layout *l = &t->layout;
    double mass[64], inertia[64], value = 0.0;
    double *u = swept_field(l), *turns = swept_field(l);
    uint64_t seed = 1;
    wb_swept_tape_masses(t->tape, mass, inertia);
    for (size_t i = 0; i < wb_swept_size(l); i++) {
        u[i] = test_random(&seed) - 0.5;
        turns[i] = 1e3 * (test_random(&seed) - 0.5);
    }
    for (int iteration = 0; iteration < 400; iteration++) {
        double norm = 0.0;
        for (int k = 0; k < l->n_nodes; k++) {
            for (int j = 0; j < l->n_stations; j++) {
                for (int i = 0; i < 3; i++) {
                    const size_t at = swept_at(l, k, i, j);
                    norm += mass[k] * u[at] * u[at] + inertia[k] * turns[at] * turns[at];
                }
            }
        }
        norm = sqrt(norm / (mass[0] * l->n_nodes * l->n_stations));
        value = iteration > 0 ? norm : value;
        for (int k = 0; k < l->n_nodes; k++) {
            for (int j = 0; j < l->n_stations; j++) {
                for (int i = 0; i < 3; i++) {
                    const size_t at = swept_at(l, k, i, j);
                    u[at] *= scale / norm;
                    turns[at] *= scale / norm;
                    t->position[at] = t->model.position[at] + u[at];
                    t->director[at] = wb_swept_tape_directors(t->tape)[at] + turns[at];
                }
            }
        }
        (void)tape_forces(t);
        for (int k = 0; k < l->n_nodes; k++) {
            for (int j = 0; j < l->n_stations; j++) {
                const bool is_end = j == 0 || j == l->n_stations - 1;
                const double length = t->model.spacing * (is_end ? 0.5 : 1.0);
                for (int i = 0; i < 3; i++) {
                    const size_t at = swept_at(l, k, i, j);
                    u[at] = -tape_load(t, t->force, k, i, j) / (mass[k] * length) / scale;
                    turns[at] = -tape_load(t, t->moment, k, i, j) / (inertia[k] * length) / scale;
                }
            }
        }
    }
    free(u);
    free(turns);
    return value;
}

static void bound_of_frequencies_holds_and_is_close(void **unused)
{
    (void)unused;
    const double winding[3] = {0.0, 0.3, 0.0};
    for (int form = 0; form < 3; form++) {
        struct wb_swept_tape_model model = tape_model(&elastic_tape, 16, 24, form != 2, 1e-3);
        make_tube(&model, form == 1 ? 4e-3 : 2e-3, winding[form], 1.5);
        struct test_tape t = test_tape_create(&model);
        double bound = 0.0;
        assert_int_equal(wb_swept_tape_stiffness_per_mass(t.tape, &bound), WB_OK);
        const double found = fastest(&t, 1e-10);
        print_message("form %d: step %.3e s by the bound, %.3e s by iteration\n", form,
                      2.0 / sqrt(bound), 2.0 / sqrt(found));
        assert_true(found <= bound * (1.0 + 1e-6));
        assert_true(bound < 2.0 * found);
        test_tape_destroy(&t);
    }
}

/* --- invalid input --- */

static void invalid_tapes_are_rejected(void **unused)
{
    (void)unused;
    struct wb_swept_tape_model good = tape_model(&tape_law, 6, 5, true, 1e-3);
    struct wb_swept_tape *tape = NULL;
    make_tube(&good, 2e-3, 0.0, 1.0);
    wb_log_set_sink(discard_message, NULL);
    struct wb_swept_tape_model bad = good;
    bad.thickness = 0.0;
    assert_int_equal(wb_swept_tape_create(&tape, &bad), WB_ERR_ARGUMENT);
    bad = good;
    bad.points = 6;
    assert_int_equal(wb_swept_tape_create(&tape, &bad), WB_ERR_ARGUMENT);
    bad = good;
    bad.sheets = -1;
    assert_int_equal(wb_swept_tape_create(&tape, &bad), WB_ERR_ARGUMENT);
    bad = good;
    bad.density = (double)NAN;
    assert_int_equal(wb_swept_tape_create(&tape, &bad), WB_ERR_ARGUMENT);
    bad = good;
    bad.material.poissons_ratio = 0.6;
    assert_int_equal(wb_swept_tape_create(&tape, &bad), WB_ERR_ARGUMENT);
    bad = good;
    bad.material.hardening = WB_HARDENING_KINEMATIC_LINEAR;
    assert_int_equal(wb_swept_tape_create(&tape, &bad), WB_ERR_UNSUPPORTED);
    bad = good;
    bad.material.hardening_exponent = 0.02;
    assert_int_equal(wb_swept_tape_create(&tape, &bad), WB_ERR_UNSUPPORTED);
    bad = good;
    bad.layout.stride = 5;
    assert_int_equal(wb_swept_tape_create(&tape, &bad), WB_ERR_ARGUMENT);
    const size_t moved = swept_at(&good.layout, 2, 0, 2);
    const double saved = good.position[moved];
    ((double *)good.position)[moved] = 3.5e-3; /* beyond the next station */
    assert_int_equal(wb_swept_tape_create(&tape, &good), WB_ERR_ARGUMENT);
    ((double *)good.position)[moved] = (double)NAN;
    assert_int_equal(wb_swept_tape_create(&tape, &good), WB_ERR_ARGUMENT);
    ((double *)good.position)[moved] = saved;
    wb_log_set_sink(NULL, NULL);
    assert_null(tape);
    assert_int_equal(wb_swept_tape_create(&tape, &good), WB_OK);
    wb_swept_tape_destroy(tape);
    wb_swept_tape_destroy(NULL);
    wb_swept_tape_state_destroy(NULL);
    free((void *)good.position);
}

static void non_finite_input_gives_non_finite_output(void **unused)
{
    (void)unused;
    struct test_tape t = uneven_tube(&tape_law, false);
    t.position[swept_at(&t.layout, 3, 1, 4)] = (double)NAN;
    const struct wb_swept_tape_sums sums = tape_forces(&t);
    assert_true(isnan(tape_load(&t, t.force, 3, 1, 4)));
    assert_int_equal(sums.beyond_limit, 4);
    assert_true(isfinite(tape_load(&t, t.force, 3, 1, 7)));
    test_tape_destroy(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reference_state_has_no_force),
        cmocka_unit_test(rigid_motion_causes_no_force),
        cmocka_unit_test(forces_are_the_derivatives_of_the_energy),
        cmocka_unit_test(forces_and_their_moments_balance),
        cmocka_unit_test(blocks_give_the_same_in_several_calls),
        cmocka_unit_test(instruction_sets_agree),
        cmocka_unit_test(element_has_only_rigid_motions_without_energy),
        cmocka_unit_test(constant_strain_is_exact_on_a_distorted_sheet),
        cmocka_unit_test(logarithm_has_the_documented_accuracy),
        cmocka_unit_test(pure_bending_is_exact_on_a_distorted_sheet),
        cmocka_unit_test(masses_agree_with_the_sheet),
        cmocka_unit_test(bound_of_frequencies_holds_and_is_close),
        cmocka_unit_test(invalid_tapes_are_rejected),
        cmocka_unit_test(non_finite_input_gives_non_finite_output),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
