/* Bond partners of a tape, and bonds that are rejected. */
#include "fe/swept/swept_private.h"

#include "tests/fe/swept/taped_block.h"

/* --- bond partners --- */

/* A sleeve around a wire with twelve surface nodes. */
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
    const struct wb_swept_wire wire = {.node = (const double(*)[2])node,
                                       .n_nodes = 13,
                                       .n_surface = 12,
                                       .surface = surface,
                                       .y = wire_y,
                                       .z = wire_z};
    struct wb_swept_cohesion_settings settings;
    struct wb_swept_cohesion *cohesion = NULL;
    default_cohesion(&settings);
    struct test_tape t = test_tape_create(&model);
    assert_int_equal(wb_swept_cohesion_create(&cohesion, t.tape, &settings, 1, &wire, bond), WB_OK);
    assert_close_relative(wb_swept_cohesion_area(cohesion),
                          0.5 * 20 * 2.0 * around * sin(M_PI / 30) * 8 * spacing, 1e-9);
    assert_close(wb_swept_cohesion_damage(cohesion, 0, 3), 1.0, 0.0);
    assert_close(wb_swept_cohesion_damage(cohesion, 1, 3), 0.0, 0.0);
    /* No force in the reference state; then the wire grows by 1 % radially. */
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
        /* All bonds are compressed by 1 % of the chord's distance, on average about cos(pi / 12)...
         * of r. */
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
    default_cohesion(&settings);
    struct test_tape t = test_tape_create(&model);
    assert_int_equal(wb_swept_cohesion_create(&cohesion, t.tape, &settings, 0, NULL, bond), WB_OK);
    const struct wb_swept_cohesion_fields fields = {
        {t.position, t.director, t.force, t.moment}, NULL, NULL};
    struct wb_swept_cohesion_sums sums = {0};
    wb_swept_cohesion_add_forces(cohesion, &fields, 0, 2, &sums);
    assert_close(sums.stored, 0.0, 1e-22);
    /* The outer turn is lifted by 1 um: nodes next to the seam share the force. */
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

/* --- invalid input --- */

static void invalid_bonds_are_rejected(void **unused)
{
    (void)unused;
    struct wb_swept_cohesion_settings good, bad;
    struct wb_swept_cohesion *cohesion = NULL;
    default_cohesion(&good);
    struct pair p = pair_create(&good, false, WB_SWEPT_BEST);
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
    struct wb_swept_wire aside = block;
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
        cmocka_unit_test(sleeve_faces_the_wire_it_lies_on),
        cmocka_unit_test(windings_are_bonded_to_the_one_inside),
        cmocka_unit_test(invalid_bonds_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
