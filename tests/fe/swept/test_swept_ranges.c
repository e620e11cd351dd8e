/* Energies over ranges of stations: the sums of adjacent parts equal those of the complete body,
 * and stations that are not counted are still computed. */
#include "tests/fe/swept/contacts.h"
#include "tests/fe/swept/tapes.h"

enum {
    STATIONS = 38,
    PARTS = 4
};

/* Borders inside, at the end of and beyond a vector. */
static const int border[PARTS + 1] = {0, 5, 16, 29, STATIONS};

static struct wb_swept_range part(int i)
{
    return (struct wb_swept_range){border[i], border[i + 1]};
}

static void a_range_is_limited_to_the_stations(void **unused)
{
    (void)unused;
    const struct wb_swept_range all = {0, 0}, far = {50, 60}, over = {5, 90};
    assert_int_equal(wb_swept_range_within(all, 7).end, 7);
    assert_int_equal(wb_swept_range_within(far, 7).first, 7);
    assert_int_equal(wb_swept_range_within(far, 7).end, 7);
    assert_int_equal(wb_swept_range_within(over, 7).first, 5);
    assert_int_equal(wb_swept_range_within(over, 7).end, 7);
}

/* --- wires --- */

struct hex_result {
    struct wb_swept_hex_sums sums;
    double plastic, force;
};

static struct hex_result strain_wire(struct wb_swept_range range,
                                     enum wb_swept_hex_formulation formulation)
{
    struct wb_swept_section section = swept_circle(1.4e-3, 2, 1);
    const struct wb_swept_hex_model model = {.section = &section,
                                             .material = test_wire_type(3).material,
                                             .n_elements = STATIONS - 1,
                                             .element_length = 1e-3,
                                             .formulation = formulation,
                                             .counted = range};
    struct swept_body body = swept_body_create(&model);
    uint64_t seed = 3;
    for (int k = 0; k < body.layout.n_nodes; k++)
        for (int j = 0; j < STATIONS; j++)
            for (int i = 0; i < 3; i++)
                body.position[swept_at(&body.layout, k, i, j)] +=
                    1e-5 * (1.0 + 0.1 * j) * (test_random(&seed) - 0.5);
    struct hex_result out = {.sums = swept_forces(&body)};
    out.plastic = wb_swept_hex_plastic_work(body.state);
    for (int k = 0; k < body.layout.n_nodes; k++)
        for (int j = 0; j < STATIONS; j++)
            out.force += fabs(swept_force(&body, k, 0, j));
    swept_body_destroy(&body);
    wb_swept_section_release(&section);
    return out;
}

static void parts_of_a_wire_sum_to_the_whole(void **unused)
{
    (void)unused;
    for (int f = 0; f < 2; f++) {
        const enum wb_swept_hex_formulation formulation =
            f == 0 ? WB_SWEPT_HEX_FOUR_POINTS : WB_SWEPT_HEX_ONE_POINT;
        const struct hex_result whole = strain_wire((struct wb_swept_range){0, 0}, formulation);
        struct hex_result sum = {.force = 0.0};
        for (int i = 0; i < PARTS; i++) {
            const struct hex_result own = strain_wire(part(i), formulation);
            assert_true(own.sums.stored > 0.0 && own.sums.stored < whole.sums.stored);
            assert_true(own.force == whole.force);
            sum.sums.stored += own.sums.stored;
            sum.sums.artificial += own.sums.artificial;
            sum.sums.beyond_limit += own.sums.beyond_limit;
            sum.sums.largest_strain = fmax(sum.sums.largest_strain, own.sums.largest_strain);
            sum.plastic += own.plastic;
        }
        assert_close_relative(sum.sums.stored, whole.sums.stored, 1e-13);
        assert_close_relative(sum.sums.artificial, whole.sums.artificial, 1e-13);
        assert_close_relative(sum.plastic, whole.plastic, 1e-13);
        assert_true(whole.plastic > 0.0);
        assert_true(sum.sums.largest_strain == whole.sums.largest_strain);
        assert_int_equal(sum.sums.beyond_limit, whole.sums.beyond_limit);
    }
}

/* --- tape --- */

struct tape_result {
    struct wb_swept_tape_sums sums;
    double plastic, force;
};

static struct tape_result strain_tape(struct wb_swept_range range)
{
    struct wb_swept_tape_model model = tape_model(&tape_law, 10, STATIONS, true, 1e-3);
    make_tube(&model, 2e-3, 0.0, 1.0);
    model.counted = range;
    struct test_tape t = test_tape_create(&model);
    uint64_t seed = 5;
    for (size_t i = 0; i < wb_swept_size(&t.layout); i++) {
        t.position[i] += 1e-4 * (test_random(&seed) - 0.5);
        t.director[i] *= 1.0 + 1e-2 * (test_random(&seed) - 0.5);
    }
    struct tape_result out = {.sums = tape_forces(&t)};
    out.plastic = wb_swept_tape_plastic_work(t.state);
    for (int k = 0; k < t.layout.n_nodes; k++)
        for (int j = 0; j < STATIONS; j++)
            out.force += fabs(tape_load(&t, t.force, k, 1, j));
    test_tape_destroy(&t);
    return out;
}

static void parts_of_a_tape_sum_to_the_whole(void **unused)
{
    (void)unused;
    const struct tape_result whole = strain_tape((struct wb_swept_range){0, 0});
    struct tape_result sum = {.force = 0.0};
    for (int i = 0; i < PARTS; i++) {
        const struct tape_result own = strain_tape(part(i));
        assert_true(own.sums.stored > 0.0 && own.sums.stored < whole.sums.stored);
        assert_true(own.force == whole.force);
        sum.sums.stored += own.sums.stored;
        sum.sums.artificial += own.sums.artificial;
        sum.sums.beyond_limit += own.sums.beyond_limit;
        sum.plastic += own.plastic;
    }
    assert_close_relative(sum.sums.stored, whole.sums.stored, 1e-13);
    assert_close_relative(sum.sums.artificial, whole.sums.artificial, 1e-13);
    assert_close_relative(sum.plastic, whole.plastic, 1e-13);
    assert_true(whole.plastic > 0.0);
    assert_int_equal(sum.sums.beyond_limit, whole.sums.beyond_limit);
}

/* --- contact --- */

/* One wire pressed on another and slipping along it. */
static struct wb_swept_contact_energies rub(struct wb_swept_range range)
{
    const double radius[2] = {0.7e-3, 0.7e-3}, depth = 1e-6;
    struct wb_swept_contact_settings settings = contacts_settings();
    struct contacts c;
    settings.counted = range;
    contacts_init(&c, &settings, 2, radius, STATIONS, 1e-3);
    contacts_place_straight(&c, 0, (double[3]){0.0, 0.0, 0.0}, 0.3);
    for (int step = 0; step < 20; step++) {
        contacts_place_straight(&c, 1, (double[3]){2e-7 * step, 1.4e-3 - depth, 0.0}, -1.1);
        contacts_step(&c, 1e-6);
    }
    struct wb_swept_contact_energies energies = c.energies;
    energies.friction = c.friction;
    contacts_release(&c);
    return energies;
}

static void parts_of_a_contact_sum_to_the_whole(void **unused)
{
    (void)unused;
    const struct wb_swept_contact_energies whole = rub((struct wb_swept_range){0, 0});
    struct wb_swept_contact_energies sum = {0};
    for (int i = 0; i < PARTS; i++) {
        const struct wb_swept_contact_energies own = rub(part(i));
        assert_true(own.friction > 0.0 && own.friction < whole.friction);
        assert_true(own.deepest == whole.deepest);
        sum.normal += own.normal;
        sum.tangential += own.tangential;
        sum.friction += own.friction;
    }
    assert_close_relative(sum.normal, whole.normal, 1e-13);
    assert_close_relative(sum.tangential, whole.tangential, 1e-13);
    assert_close_relative(sum.friction, whole.friction, 1e-13);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_range_is_limited_to_the_stations),
        cmocka_unit_test(parts_of_a_wire_sum_to_the_whole),
        cmocka_unit_test(parts_of_a_tape_sum_to_the_whole),
        cmocka_unit_test(parts_of_a_contact_sum_to_the_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
