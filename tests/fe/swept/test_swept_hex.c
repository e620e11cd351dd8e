#include "fe/swept/swept_hex.h"
#include "fe/swept/swept_private.h"

#include "tests/fe/swept/swept_bodies.h"
#include "tests/fe/swept/swept_hex_twin.h"

static const enum wb_swept_hex_formulation formulations[] = {WB_SWEPT_HEX_FOUR_POINTS,
                                                             WB_SWEPT_HEX_ONE_POINT};

static struct wb_swept_hex_model small_model(const struct wb_swept_section *section, int elements,
                                             enum wb_swept_hex_formulation formulation)
{
    return (struct wb_swept_hex_model){.section = section,
                                       .material = test_wire_type(3).material,
                                       .n_elements = elements,
                                       .element_length = 1e-3,
                                       .formulation = formulation,
                                       .double_precision = true};
}

/* Displaces positions randomly by up to `size` of an element, and rotates them by an angle. */
static void shake(struct swept_body *body, double size, double angle, uint64_t *seed)
{
    double R[3][3];
    swept_rotation(angle, R);
    for (int k = 0; k < body->layout.n_nodes; k++) {
        for (int j = 0; j < body->layout.n_stations; j++) {
            double x[3];
            for (int i = 0; i < 3; i++)
                x[i] = body->position[swept_at(&body->layout, k, i, j)] +
                       size * 0.5e-3 * (2.0 * test_random(seed) - 1.0);
            for (int i = 0; i < 3; i++)
                body->position[swept_at(&body->layout, k, i, j)] =
                    R[i][0] * x[0] + R[i][1] * x[1] + R[i][2] * x[2];
        }
    }
}

static double *plain_copy(const struct swept_body *body, const double *field)
{
    const struct wb_swept_layout *l = &body->layout;
    double *out = malloc(3 * (size_t)(l->n_nodes * l->n_stations) * sizeof *out);
    assert_non_null(out);
    for (int j = 0; j < l->n_stations; j++) {
        for (int k = 0; k < l->n_nodes; k++) {
            for (int i = 0; i < 3; i++)
                out[3 * (j * l->n_nodes + k) + i] = field[swept_at(l, k, i, j)];
        }
    }
    return out;
}

/* Largest difference of the forces, over the largest force of the twin. */
static double difference(const struct swept_body *body, const double *twin_force)
{
    const struct wb_swept_layout *l = &body->layout;
    double worst = 0.0, largest = 0.0;
    for (int j = 0; j < l->n_stations; j++) {
        for (int k = 0; k < l->n_nodes; k++) {
            for (int i = 0; i < 3; i++) {
                const double expected = twin_force[3 * (j * l->n_nodes + k) + i];
                const double off = fabs(swept_force(body, k, i, j) - expected);
                worst = off <= worst ? worst : off;
                largest = fmax(largest, fabs(expected));
            }
        }
    }
    return worst / largest;
}

static double compare_with_twin(struct swept_body *body, struct twin *twin)
{
    double *position = plain_copy(body, body->position);
    double *force = plain_copy(body, body->position);
    swept_forces(body);
    twin_forces(twin, position, force);
    const double off = difference(body, force);
    free(position);
    free(force);
    return off;
}

static void forces_equal_the_twin_at_small_strain(void **unused)
{
    (void)unused;
    uint64_t seed = 1;
    for (int f = 0; f < 2; f++) {
        struct wb_swept_section section = swept_distorted_section(1e-3);
        const struct wb_swept_hex_model model = small_model(&section, 5, formulations[f]);
        struct swept_body body = swept_body_create(&model);
        struct twin twin = twin_create(&model);
        shake(&body, 1e-4, 1.0, &seed);
        assert_true(compare_with_twin(&body, &twin) < 1e-6);
        for (int step = 0; step < 5; step++) {
            shake(&body, 1e-3, 0.5, &seed);
            assert_true(compare_with_twin(&body, &twin) < 2e-5);
        }
        for (int j = 0; j < 5; j++)
            assert_close_relative(
                wb_swept_hex_history(body.state, 2, j, 0, WB_SWEPT_HEX_ACCUMULATED),
                twin.points[4 * (4 * j + 2)].accumulated, 1e-3);
        assert_true(twin.points[8].accumulated > 3e-4);
        twin_destroy(&twin);
        swept_body_destroy(&body);
        wb_swept_section_release(&section);
    }
}

/* Compares energies of the twin and of the kernel at the strains documented in the header. */
static void logarithm_has_the_documented_accuracy(void **unused)
{
    (void)unused;
    struct wb_swept_section section = swept_distorted_section(1e-3);
    for (int f = 0; f < 2; f++) {
        struct wb_swept_hex_model model = small_model(&section, 1, formulations[f]);
        model.material.hardening = WB_HARDENING_NONE_ELASTIC;
        struct swept_body body = swept_body_create(&model);
        struct twin twin = twin_create(&model);
        double axial[3][3] = {{1.05, 0, 0}, {0, 0.98, 0}, {0, 0, 0.98}};
        double sheared[3][3] = {{1, 0.1, 0}, {0, 1, 0}, {0, 0, 1}};
        const double origin[3] = {0.0, 0.0, 0.0};
        swept_set_linear(&body, axial, origin);
        const double off_axial = compare_with_twin(&body, &twin);
        swept_set_linear(&body, sheared, origin);
        const double off_sheared = compare_with_twin(&body, &twin);
        print_message("forces at a strain of 5 %%: axial %.2e, shear %.2e off\n", off_axial,
                      off_sheared);
        assert_true(off_axial < 2e-3);
        assert_true(off_sheared < 1.5e-2);
        twin_destroy(&twin);
        swept_body_destroy(&body);
    }
    wb_swept_section_release(&section);
}

static double energy(struct swept_body *body)
{
    const struct wb_swept_hex_sums sums = swept_forces(body);
    return sums.stored + sums.artificial;
}

/* By fourth-order differences, in an elastic state at large strain: the strain's approximation must
 * not matter. */
static void forces_are_the_derivative_of_the_energy(void **unused)
{
    (void)unused;
    uint64_t seed = 2;
    struct wb_swept_section section = swept_distorted_section(1e-3);
    for (int f = 0; f < 2; f++) {
        struct wb_swept_hex_model model = small_model(&section, 2, formulations[f]);
        model.material.hardening = WB_HARDENING_NONE_ELASTIC;
        struct swept_body body = swept_body_create(&model);
        shake(&body, 0.2, 0.7, &seed);
        double largest = 0.0, worst = 0.0;
        for (int k = 0; k < 9; k++) {
            for (int i = 0; i < 9; i++) {
                double *at = &body.position[swept_at(&body.layout, k, i % 3, i / 3)];
                const double x = *at, d = 1e-6;
                double e[4];
                static const double places[4] = {-2, -1, 1, 2};
                for (int p = 0; p < 4; p++) {
                    *at = x + places[p] * d;
                    e[p] = energy(&body);
                }
                *at = x;
                energy(&body);
                const double slope = (e[0] - 8 * e[1] + 8 * e[2] - e[3]) / (12 * d);
                const double force = swept_force(&body, k, i % 3, i / 3);
                worst = fmax(worst, fabs(force + slope));
                largest = fmax(largest, fabs(force));
            }
        }
        assert_true(worst < 1e-10 * largest);
        swept_body_destroy(&body);
    }
    wb_swept_section_release(&section);
}

static void rigid_motion_causes_no_force(void **unused)
{
    (void)unused;
    struct wb_swept_section section = swept_circle(1.4e-3, 2, 1);
    for (int f = 0; f < 4; f++) {
        struct wb_swept_hex_model model = small_model(&section, 20, formulations[f / 2]);
        model.double_precision = f % 2;
        struct swept_body body = swept_body_create(&model);
        /* Scale: the force of a strain of 1 on the section. Float precision must be sufficient. */
        const double scale = model.material.youngs_modulus * section.area;
        const double c[3] = {0.3, -0.2, 0.05};
        for (int turn = 0; turn < 50; turn++) {
            double R[3][3];
            swept_rotation(0.37 * turn, R);
            swept_set_linear(&body, R, c);
            const struct wb_swept_hex_sums sums = swept_forces(&body);
            double worst = 0.0;
            for (int k = 0; k < section.n_nodes; k++) {
                for (int i = 0; i < 3 * 21; i++)
                    worst = fmax(worst, fabs(swept_force(&body, k, i % 3, i / 3)));
            }
            assert_true(worst < 5e-13 * scale);
            assert_true(sums.stored < 1e-24 * scale * 0.02);
        }
        for (int q = 0; q < 12; q++)
            assert_true(wb_swept_hex_history(body.state, q, 3, 0, WB_SWEPT_HEX_ACCUMULATED) == 0.0);
        swept_body_destroy(&body);
    }
    wb_swept_section_release(&section);
}

/* A linear field in a distorted mesh: inner nodes have no force, nodes of the end have the first
 * Piola stress times their area, and strains agree with the field. */
static void linear_fields_pass_the_patch_test(void **unused)
{
    (void)unused;
    struct wb_swept_section section = swept_distorted_section(1e-3);
    for (int f = 0; f < 2; f++) {
        struct wb_swept_hex_model model = small_model(&section, 3, formulations[f]);
        model.material.hardening = WB_HARDENING_NONE_ELASTIC;
        struct swept_body body = swept_body_create(&model);
        double R[3][3],
            U[3][3] = {{1.001, 0.002, -0.001}, {0.002, 0.999, 0.0015}, {-0.001, 0.0015, 1.002}};
        double F[3][3], total[3] = {0.0, 0.0, 0.0};
        const double c[3] = {0.01, 0.02, 0.03};
        swept_rotation(2.0, R);
        for (int i = 0; i < 9; i++) {
            F[i / 3][i % 3] = 0.0;
            for (int k = 0; k < 3; k++)
                F[i / 3][i % 3] += R[i / 3][k] * U[k][i % 3];
        }
        swept_set_linear(&body, F, c);
        const struct wb_swept_hex_sums sums = swept_forces(&body);
        const double scale = model.material.youngs_modulus * section.area;
        for (int i = 0; i < 3; i++) {
            assert_close(swept_force(&body, 4, i, 1), 0.0, 1e-13 * scale);
            assert_close(swept_force(&body, 4, i, 2), 0.0, 1e-13 * scale);
            for (int k = 0; k < 9; k++)
                total[i] += swept_force(&body, k, i, 3);
        }
        assert_true(sums.artificial < 1e-24 * scale);
        for (int k = 0; k < 9; k++) {
            for (int i = 0; i < 3 && k == 4; i++)
                assert_close(swept_force(&body, k, i, 3), total[i] * section.share[k],
                             1e-13 * scale);
        }
        /* The stress is that of one element, which the twin computes with the exact logarithm. */
        struct twin twin = twin_create(&model);
        assert_true(compare_with_twin(&body, &twin) < 4e-5);
        twin_destroy(&twin);
        swept_body_destroy(&body);
    }
    wb_swept_section_release(&section);
}

/* Uniaxial stress: solves for the lateral stretch, and compares stress with the law. */
static double bar_stress(struct swept_body *body, double stretch, double *lateral)
{
    const struct wb_swept_section *section = wb_swept_hex_get_model(body->hex)->section;
    const double origin[3] = {0.0, 0.0, 0.0};
    size_t bytes;
    void *data = wb_swept_hex_state_data(body->state, &bytes);
    char *saved = malloc(bytes);
    assert_non_null(saved);
    memcpy(saved, data, bytes);
    double low = *lateral - 0.02, high = *lateral + 0.02, force = 0.0;
    for (int k = 0; k < 60; k++) {
        *lateral = 0.5 * (low + high);
        double F[3][3] = {{stretch, 0, 0}, {0, *lateral, 0}, {0, 0, *lateral}};
        memcpy(data, saved, bytes);
        swept_set_linear(body, F, origin);
        swept_forces(body);
        double outward = 0.0;
        force = 0.0;
        for (int n = 0; n < section->n_nodes; n++) {
            outward -= swept_force(body, n, 1, 0) * section->node[n][0];
            force += swept_force(body, n, 0, 0);
        }
        if (outward > 0.0)
            high = *lateral;
        else
            low = *lateral;
    }
    free(saved);
    return force / section->area;
}

/* The hardening law and its table over four decades of plastic strain, to 1e-5. Kirchhoff's stress
 * is P F; the polynomial for the logarithm has this accuracy at strains below 0.5 %. */
static void bar_in_tension_follows_the_power_law(void **unused)
{
    (void)unused;
    static const double laws[][2] = {{1327e6, 0.9}, {3222e6, 0.99}, {850e6, 0.78}, {200e6, 0.5},
                                     {60e6, 0.25},  {0.0, 0.5},     {4e9, 1.4},    {1e9, 1.0}};
    struct wb_swept_section section = swept_circle(1.4e-3, 2, 0);
    double worst[2] = {0.0, 0.0}; /* of float, of double */
    for (int law = 0; law < 8; law++) {
        for (int f = 0; f < 4; f++) {
            struct wb_swept_hex_model model = small_model(&section, 1, formulations[f / 2]);
            model.double_precision = f % 2;
            model.material.strength_coefficient = laws[law][0];
            model.material.hardening_exponent = laws[law][1];
            struct swept_body body = swept_body_create(&model);
            for (int step = 0; step < 8; step++) {
                const double p = 1e-7 * pow(4.0, step);
                const struct wb_material *m = &model.material;
                const double stress = m->yield_stress + laws[law][0] * pow(p, laws[law][1]);
                const double stretch = exp(stress / m->youngs_modulus + p);
                double lateral = exp(-m->poissons_ratio * stress / m->youngs_modulus - 0.5 * p);
                const double found = bar_stress(&body, stretch, &lateral) * stretch;
                worst[f % 2] = fmax(worst[f % 2], fabs(found / stress - 1.0));
                assert_close_relative(
                    wb_swept_hex_history(body.state, 0, 0, 0, WB_SWEPT_HEX_ACCUMULATED), p,
                    2e-5 + 1e-9 / p);
            }
            swept_body_destroy(&body);
        }
    }
    print_message("largest error of the stress: float %.1e, double %.1e\n", worst[0], worst[1]);
    assert_true(worst[0] < 1e-5);
    assert_true(worst[1] < 2e-6);
    wb_swept_section_release(&section);
}

static void all_instructions_agree(void **unused)
{
    (void)unused;
    static const int sizes[] = {1, 7, 15, 16, 17, 31, 40};
    struct wb_swept_section section = swept_circle(1.4e-3, 2, 1);
    wb_log_set_sink(discard_message, NULL);
    for (int f = 0; f < 2; f++) {
        for (int s = 0; s < 7; s++) {
            struct wb_swept_hex_model model = small_model(&section, sizes[s], formulations[f]);
            struct twin twin = twin_create(&model);
            double *plain = NULL, *force = NULL;
            for (int way = 0; way < 6; way++) {
                uint64_t seed = 3;
                struct wb_swept_hex *hex;
                model.double_precision = way % 2 == 0;
                model.instructions = (enum wb_swept_instructions)(1 + way / 2);
                if (wb_swept_hex_create(&hex, &model) != WB_OK) {
                    assert_true(way > 1);
                    continue;
                }
                wb_swept_hex_destroy(hex);
                struct swept_body body = swept_body_create(&model);
                shake(&body, 5e-4, 1.0, &seed);
                if (!plain) {
                    plain = plain_copy(&body, body.position);
                    force = plain_copy(&body, body.position);
                    twin_forces(&twin, plain, force);
                }
                /* In two calls; entries after the last station must have no effect. */
                const struct wb_swept_layout *l = &body.layout;
                for (int row = 0; row < 3 * l->n_nodes; row++) {
                    for (int j = l->n_stations; j < l->stride; j++)
                        body.position[row * l->stride + j] = 1e3 * test_random(&seed);
                }
                swept_find_forces(&body, 0, 1, NULL);
                swept_find_forces(&body, 1, wb_swept_hex_blocks(body.hex), NULL);
                assert_true(difference(&body, force) < 1e-5);
                for (int row = 0; row < 3 * l->n_nodes; row++) {
                    for (int j = l->n_stations; j < l->stride; j++)
                        assert_true(swept_force(&body, row / 3, row % 3, j) == 0.0);
                }
                for (int j = sizes[s]; j < l->stride; j++)
                    assert_true(
                        wb_swept_hex_history(body.state, 5, j, 0, WB_SWEPT_HEX_ACCUMULATED) == 0.0);
                swept_body_destroy(&body);
            }
            free(plain);
            free(force);
            twin_destroy(&twin);
        }
    }
    wb_log_set_sink(NULL, NULL);
    wb_swept_section_release(&section);
}

/* Adding the same forces twice doubles them exactly. */
static void forces_are_added_to_existing_ones(void **unused)
{
    (void)unused;
    struct wb_swept_section section = swept_distorted_section(1e-3);
    for (int f = 0; f < 2; f++) {
        const struct wb_swept_hex_model model = small_model(&section, 37, formulations[f]);
        struct swept_body once = swept_body_create(&model), twice = swept_body_create(&model);
        const int n = wb_swept_hex_blocks(once.hex);
        uint64_t seed = 3, same = 3;
        shake(&once, 5e-4, 1.0, &seed);
        shake(&twice, 5e-4, 1.0, &same);
        swept_find_forces(&once, 0, n, NULL);
        memcpy(twice.force, once.force, wb_swept_size(&once.layout) * sizeof(double));
        const struct wb_swept_hex_fields fields = {twice.position, twice.force, twice.position};
        for (int b = 0; b < n; b++)
            wb_swept_hex_add_forces(twice.state, &fields, b, b + 1, NULL);
        double size = 0.0;
        for (int k = 0; k < once.layout.n_nodes; k++) {
            for (int j = 0; j < once.layout.n_stations; j++) {
                const double force = swept_force(&once, k, 1, j);
                assert_true(swept_force(&twice, k, 1, j) == 2.0 * force);
                size += fabs(force);
            }
        }
        assert_true(size > 0.0);
        swept_body_destroy(&once);
        swept_body_destroy(&twice);
    }
    wb_swept_section_release(&section);
}

/* In a circle's section only the outline's forces are added to existing ones; inner ones are
 * overwritten. */
static void forces_inside_a_circle_are_overwritten(void **unused)
{
    (void)unused;
    struct wb_swept_section section;
    assert_int_equal(wb_swept_section_init_circle(&section, 1.4e-3, 2, 1), WB_OK);
    const struct wb_swept_hex_model model = small_model(&section, 37, formulations[0]);
    struct swept_body once = swept_body_create(&model), again = swept_body_create(&model);
    uint64_t seed = 3, same = 3;
    const int first = wb_swept_hex_first_added(once.hex), n = wb_swept_hex_blocks(once.hex);
    assert_int_equal(first, section.n_nodes - section.n_outline);
    shake(&once, 5e-4, 1.0, &seed);
    shake(&again, 5e-4, 1.0, &same);
    swept_find_forces(&once, 0, n, NULL);
    memcpy(again.force, once.force, wb_swept_size(&once.layout) * sizeof(double));
    const struct wb_swept_hex_fields fields = {.position = again.position, .force = again.force};
    wb_swept_hex_add_forces(again.state, &fields, 0, n, NULL);
    for (int k = 0; k < once.layout.n_nodes; k++)
        for (int j = 0; j < once.layout.n_stations; j++)
            assert_true(swept_force(&again, k, 1, j) ==
                        (k < first ? 1.0 : 2.0) * swept_force(&once, k, 1, j));
    swept_body_destroy(&once);
    swept_body_destroy(&again);
    wb_swept_section_release(&section);
}

/* Along a path with yielding and unloading: work of the nodes' forces (trapezoidal) is stored,
 * plastic and artificial energy. */
static void work_is_stored_or_plastic(void **unused)
{
    (void)unused;
    struct wb_swept_section section = swept_distorted_section(1e-3);
    for (int f = 0; f < 2; f++) {
        const struct wb_swept_hex_model model = small_model(&section, 3, formulations[f]);
        struct swept_body body = swept_body_create(&model);
        const size_t n = wb_swept_size(&body.layout);
        double *start = swept_field(&body.layout), *change = swept_field(&body.layout);
        memcpy(start, body.position, n * sizeof *start);
        uint64_t seed = 4;
        for (size_t i = 0; i < n; i++)
            change[i] = 1e-5 * (2.0 * test_random(&seed) - 1.0);
        double work = 0.0, before = 0.0, balance[2];
        struct wb_swept_hex_sums sums;
        size_t bytes;
        for (int fineness = 0; fineness < 2; fineness++) {
            const int steps = 200 << fineness;
            void *const history = wb_swept_hex_state_data(body.state, &bytes);
            memset(history, 0, bytes);
            work = before = 0.0;
            for (int step = 0; step <= steps; step++) {
                const double s = sin(4.0 * step / steps);
                for (size_t i = 0; i < n; i++)
                    body.position[i] = start[i] + s * change[i];
                sums = swept_forces(&body);
                double power = 0.0;
                const double *force = body.force;
                for (size_t i = 0; i < n; i++)
                    power -= force[i] * change[i];
                work +=
                    step > 0 ? 0.5 * (power + before) * (s - sin(4.0 * (step - 1) / steps)) : 0.0;
                before = power;
            }
            balance[fineness] =
                (sums.stored + sums.artificial + wb_swept_hex_plastic_work(body.state)) / work -
                1.0;
        }
        assert_true(wb_swept_hex_plastic_work(body.state) > 0.5 * work);
        assert_true(fabs(balance[0]) < 2e-4);
        assert_true(fabs(balance[1]) < 0.6 * fabs(balance[0]));
        free(start);
        free(change);
        swept_body_destroy(&body);
    }
    wb_swept_section_release(&section);
}

/* Stiffness of one element by differences: exactly 6 motions without force. */
static void hourglass_modes_are_stiff(void **unused)
{
    (void)unused;
    static const double at[4][2] = {
        {0.0, 0.05e-3}, {0.5e-3, -0.03e-3}, {0.6e-3, 0.5e-3}, {-0.1e-3, 0.4e-3}};
    static const int quad[1][4] = {{0, 1, 2, 3}};
    struct wb_swept_section section;
    assert_int_equal(swept_section_init(&section, 4, at, 1, quad), WB_OK);
    for (int f = 0; f < 2; f++) {
        const struct wb_swept_hex_model model = small_model(&section, 1, formulations[f]);
        struct swept_body body = swept_body_create(&model);
        double K[24][24];
        for (int p = 0; p < 24; p++) {
            double *x = &body.position[swept_at(&body.layout, p % 12 / 3, p % 3, p / 12)];
            const double here = *x, d = 1e-9;
            for (int side = 0; side < 2; side++) {
                *x = here + (side ? d : -d);
                swept_forces(&body);
                for (int q = 0; q < 24; q++)
                    K[p][q] =
                        (side ? K[p][q] : 0.0) -
                        (side ? 1 : -1) * swept_force(&body, q % 12 / 3, q % 3, q / 12) / (2 * d);
            }
            *x = here;
        }
        /* Rank from the pivots of Gaussian elimination. */
        int rank = 0;
        double first = 0.0;
        for (int k = 0; k < 24; k++) {
            int best = k;
            for (int p = k; p < 24; p++)
                best = fabs(K[p][p]) > fabs(K[best][best]) ? p : best;
            for (int q = 0; q < 24; q++) {
                const double swap = K[k][q];
                K[k][q] = K[best][q];
                K[best][q] = swap;
            }
            for (int p = 0; p < 24; p++) {
                const double swap = K[p][k];
                K[p][k] = K[p][best];
                K[p][best] = swap;
            }
            first = fmax(first, K[k][k]);
            if (!(K[k][k] > 1e-5 * first))
                break;
            rank++;
            for (int p = k + 1; p < 24; p++) {
                const double factor = K[p][k] / K[k][k];
                for (int q = k; q < 24; q++)
                    K[p][q] -= factor * K[k][q];
            }
        }
        assert_int_equal(rank, 18);
        swept_body_destroy(&body);
    }
    wb_swept_section_release(&section);
}

static void strains_beyond_the_limit_are_counted(void **unused)
{
    (void)unused;
    struct wb_swept_section section = swept_circle(1.4e-3, 2, 0);
    for (int f = 0; f < 4; f++) {
        struct wb_swept_hex_model model = small_model(&section, 20, formulations[f / 2]);
        model.double_precision = f % 2;
        struct swept_body body = swept_body_create(&model);
        /* One element of each line is 4.9 %, another 5.5 % longer. */
        for (int k = 0; k < section.n_nodes; k++) {
            for (int j = 0; j <= 20; j++)
                body.position[swept_at(&body.layout, k, 0, j)] +=
                    (j > 3 ? 0.045e-3 : 0.0) + (j > 18 ? 0.055e-3 : 0.0);
        }
        struct wb_swept_hex_sums sums = swept_forces(&body);
        assert_int_equal(sums.beyond_limit, 4);
        assert_close(sums.largest_strain, 0.055 + 0.5 * 0.055 * 0.055, 1e-6);
        body.position[swept_at(&body.layout, 0, 1, 7)] = (double)NAN;
        sums = swept_forces(&body);
        assert_true(sums.beyond_limit > 4);
        assert_true(isnan(sums.stored));
        assert_true(isnan(swept_force(&body, 0, 0, 7)));
        swept_body_destroy(&body);
    }
    wb_swept_section_release(&section);
}

static void invalid_models_are_rejected(void **unused)
{
    (void)unused;
    struct wb_swept_section section = swept_circle(1.4e-3, 2, 1), broken;
    const struct wb_swept_hex_model good = small_model(&section, 10, WB_SWEPT_HEX_FOUR_POINTS);
    struct wb_swept_hex *hex;
    wb_log_set_sink(discard_message, NULL);
    for (int i = 0; i < 12; i++) {
        struct wb_swept_hex_model m = good;
        if (i == 0)
            m.n_elements = 0;
        if (i == 1)
            m.element_length = 0.0;
        if (i == 2)
            m.hourglass = -0.1;
        if (i == 3)
            m.hourglass = (double)NAN;
        if (i == 4)
            m.material.hardening = WB_HARDENING_KINEMATIC_LINEAR;
        if (i == 5)
            m.material.youngs_modulus = 0.0;
        if (i == 6)
            m.material.poissons_ratio = 0.5;
        if (i == 7)
            m.material.yield_stress = 0.0;
        if (i == 8)
            m.material.strength_coefficient = (double)INFINITY;
        if (i == 9)
            m.material.hardening_exponent = 0.0;
        if (i == 10)
            m.material.hardening_exponent = 0.02;
        if (i == 11)
            m.element_length = (double)INFINITY;
        assert_int_not_equal(wb_swept_hex_create(&hex, &m), WB_OK);
        assert_null(hex);
    }
    static const double at[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    static const int clockwise[1][4] = {{0, 3, 2, 1}}, missing[1][4] = {{0, 1, 2, 4}};
    static const double dart[4][2] = {{0, 0}, {1, 0}, {0.2, 0.2}, {0, 1}};
    static const int right[1][4] = {{0, 1, 2, 3}};
    assert_int_equal(swept_section_init(&broken, 4, at, 1, clockwise), WB_ERR_ARGUMENT);
    assert_int_equal(swept_section_init(&broken, 4, at, 1, missing), WB_ERR_ARGUMENT);
    assert_int_equal(swept_section_init(&broken, 4, dart, 1, right), WB_ERR_ARGUMENT);
    assert_int_equal(wb_swept_section_init_circle(&broken, 1e-3, 3, 1), WB_ERR_ARGUMENT);
    assert_int_equal(wb_swept_section_init_circle(&broken, 0.0, 2, 1), WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
    wb_swept_section_release(&section);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_equal_the_twin_at_small_strain),
        cmocka_unit_test(logarithm_has_the_documented_accuracy),
        cmocka_unit_test(forces_are_the_derivative_of_the_energy),
        cmocka_unit_test(rigid_motion_causes_no_force),
        cmocka_unit_test(linear_fields_pass_the_patch_test),
        cmocka_unit_test(bar_in_tension_follows_the_power_law),
        cmocka_unit_test(all_instructions_agree),
        cmocka_unit_test(forces_are_added_to_existing_ones),
        cmocka_unit_test(forces_inside_a_circle_are_overwritten),
        cmocka_unit_test(work_is_stored_or_plastic),
        cmocka_unit_test(hourglass_modes_are_stiff),
        cmocka_unit_test(strains_beyond_the_limit_are_counted),
        cmocka_unit_test(invalid_models_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
