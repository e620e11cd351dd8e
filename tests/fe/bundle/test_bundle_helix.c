/* Sleeve and helix of the same tape around seven wires: prints the effect of the winding. */
#include "tests/fe/bundle/bundles.h"

enum {
    ALONG = 213, /* number of elements that a helix of this width needs */
    FORCES = 4
};

static const double deflection = 8e-3, duration = 0.16;

/* Mean forces, each over a twentieth of the path, centred at every quarter. */
static void bend(const char *taping, double force[FORCES], double *imbalance)
{
    const struct wb_bundle_settings settings = {.duration = duration, .mesh = "four"};
    struct wb_bundle_energies e;
    struct wb_bundle_state state;
    struct wb_bundle *bundle;
    char text[512];

    snprintf(text, sizeof text,
             SEVEN "taping: {layout: %s}\n" RUN("deflection_mm: 8") "loads: {weight: false}\n",
             taping);
    read_model(text);
    for (int m = 0; m < model.n_meshes; m++)
        model.mesh[m].elements_along = ALONG;
    assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
    wb_bundle_move_tip(bundle, deflection, duration);
    for (int i = 0; i < FORCES; i++) {
        double sum = 0.0, to = 0.0;
        int n = 0;
        force[i] = 0.0;
        do {
            assert_int_equal(wb_bundle_advance(bundle, 20, NULL), WB_OK);
            wb_bundle_get_state(bundle, &state);
            to = state.target / deflection;
            if (to > (i + 0.9) / FORCES) {
                sum += state.vertical;
                n++;
            }
        } while (to < (i + 1.0) / FORCES && state.time < duration);
        force[i] = sum / n;
    }
    wb_bundle_get_energies(bundle, &e);
    *imbalance = wb_bundle_imbalance(&e) / e.external;
    print_message("%s: %d shells, %lld steps; energy imbalance at most %.2g %%\n", taping,
                  wb_bundle_shells(bundle), state.steps, 100.0 * fabs(*imbalance));
    wb_bundle_destroy(bundle);
}

/* Both have two layers everywhere, and the windings are bonded to each other: in bending they
 * differ little. */
static void a_helix_is_about_as_stiff_as_the_sleeve(void **unused)
{
    (void)unused;
    double sleeve[FORCES], helix[FORCES], imbalance[2];
    bend("sleeve, layers: 2", sleeve, &imbalance[0]);
    bend("helix, width_mm: 19", helix, &imbalance[1]);
    for (int i = 0; i < FORCES; i++) {
        print_message("%g mm: sleeve %.4f N, helix %.4f N, %+.1f %%\n",
                      1e3 * deflection * (i + 1) / FORCES, sleeve[i], helix[i],
                      100.0 * (helix[i] / sleeve[i] - 1.0));
        assert_close_relative(helix[i], sleeve[i], 0.1);
    }
    assert_true(fabs(imbalance[0]) < 0.01 && fabs(imbalance[1]) < 0.01);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_helix_is_about_as_stiff_as_the_sleeve),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
