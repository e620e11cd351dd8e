/* Unknowns, bonds and contacts of a section, and bundles that are rejected. */
#include "fe/section/section_layout.h"

#include "base/file.h"
#include "tests/messages.h"

static struct wb_bundle_model model;
static struct wb_section_layout layout;

static void read_bundle(const char *name)
{
    char path[WB_PATH];
    assert_int_equal(wb_file_find_fixture(path, "bundles", name, NULL), WB_OK);
    assert_int_equal(wb_bundle_model_read(&model, path), WB_OK);
}

static int release(void **unused)
{
    (void)unused;
    wb_section_layout_release(&layout);
    release_messages();
    return 0;
}

static void create(const char *name, bool may_mirror)
{
    read_bundle(name);
    wb_section_layout_release(&layout);
    assert_int_equal(wb_section_layout_create(&layout, &model, may_mirror), WB_OK);
}

static void segments_make_up_the_tape_and_bonds_the_arcs(void **unused)
{
    (void)unused;
    static const char *const bundles[] = {"7-type3", "7-type3-turned", "12-type3", "27-type3",
                                          "19-type3-circle"};

    for (int i = 0; i < 5; i++)
        for (int mirror = 0; mirror < 2; mirror++) {
            double round = 0.0, arcs = 0.0, wires = 0.0;
            create(bundles[i], mirror);
            assert_int_equal(layout.is_mirrored, mirror);
            for (int k = 0; k < layout.n_segments; k++)
                round += layout.segments[k].weight * layout.segments[k].length;
            for (int k = 0; k < layout.n_wires; k++)
                wires += layout.wires[k].weight;
            assert_close_relative(round, model.tape.taping.circumference, 1e-9);
            assert_close(wires, model.packing.n, 1e-12);
            for (int k = 0; k < model.tape.hull.n_arcs; k++)
                arcs += (model.tape.hull.arc[k].to - model.tape.hull.arc[k].from) *
                        model.packing.wire[0].radius;
            if (!model.tape.round)
                assert_close_relative(layout.bonded_width, arcs, 1e-9);
        }
}

static void reach_widens_bonds_and_bonds_wires_touched_along_a_line(void **unused)
{
    (void)unused;
    create("12-type3", true);
    const double narrow = layout.bonded_width;
    create("12-type3-wider-bond", true);
    /* Nine wires touch the tape; on either side of each, the bond reaches sqrt(2 r reach)
     * farther. */
    assert_close(layout.bonded_width - narrow, 18.0 * sqrt(2.0 * 0.7e-3 * 0.005e-3), 1e-9);
    create("7-type3-circle", true);
    const double R = 2.1e-3, r = 0.7e-3;
    assert_close(layout.bonded_width, 6.0 * 2.0 * sqrt(2.0 * 0.005e-3 / (1.0 / r - 1.0 / R)), 1e-9);
}

/* Action and reaction: a contact's forces sum to zero over all wires, with wires that represent two
 * counted twice. */
static void contacts_push_wires_apart_and_balance_each_other(void **unused)
{
    (void)unused;
    static const int contacts[] = {12, 42};
    static const char *const bundles[] = {"7-type3", "19-type3"};

    for (int i = 0; i < 2; i++)
        for (int mirror = 0; mirror < 2; mirror++) {
            double n = 0.0;
            create(bundles[i], mirror);
            for (int c = 0; c < layout.n_contacts; c++) {
                double up = 0.0, across = 0.0;
                n += layout.contacts[c].weight;
                for (int w = 0; w < layout.n_wires; w++) {
                    up += layout.wires[w].weight * layout.balance[2 * w * layout.n_contacts + c];
                    across += layout.balance[(2 * w + 1) * layout.n_contacts + c];
                }
                assert_close(up, 0.0, 1e-12);
                assert_true(mirror || fabs(across) < 1e-12);
            }
            assert_close(n, contacts[i], 1e-12);
        }
}

static void assert_rejected(const char *name, const char *reason)
{
    read_bundle(name);
    keep_messages();
    assert_int_equal(wb_section_layout_create(&layout, &model, true), WB_ERR_UNSUPPORTED);
    assert_message(reason);
    assert_message(model.path);
    assert_message("--model explicit");
    assert_int_equal(kept.n, 1);
}

static void unsupported_bundles_are_rejected_with_reason_and_advice(void **unused)
{
    (void)unused;
    assert_rejected("7-type3-helix", "helix");
    assert_rejected("19-mixed", "one diameter");
    assert_rejected("7-type3-gaps", "gaps: wires_mm: 0.05");
}

static void assert_model_rejected(const char *reason)
{
    keep_messages();
    assert_int_equal(wb_section_layout_create(&layout, &model, true), WB_ERR_UNSUPPORTED);
    assert_message(reason);
}

static void gaps_above_a_hundredth_of_a_millimetre_are_rejected(void **unused)
{
    (void)unused;
    read_bundle("7-type3");
    model.packing.wire[1].z += 0.009e-3;
    assert_int_equal(wb_section_layout_create(&layout, &model, true), WB_OK);
    wb_section_layout_release(&layout);
    model.packing.wire[1].z += 0.003e-3;
    assert_model_rejected("0.012 mm");
    assert_model_rejected("'touching_mm'");
}

static void breaking_bonds_and_potting_are_rejected(void **unused)
{
    (void)unused;
    read_bundle("7-type3");
    model.interface.has_damage = true;
    assert_model_rejected("interface: damage");
    model.interface.has_damage = false;
    model.potted_length = 0.01;
    assert_model_rejected("ends: ");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(segments_make_up_the_tape_and_bonds_the_arcs, release),
        cmocka_unit_test_teardown(reach_widens_bonds_and_bonds_wires_touched_along_a_line, release),
        cmocka_unit_test_teardown(contacts_push_wires_apart_and_balance_each_other, release),
        cmocka_unit_test_teardown(unsupported_bundles_are_rejected_with_reason_and_advice, release),
        cmocka_unit_test_teardown(gaps_above_a_hundredth_of_a_millimetre_are_rejected, release),
        cmocka_unit_test_teardown(breaking_bonds_and_potting_are_rejected, release),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
