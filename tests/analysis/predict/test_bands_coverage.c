/* Coverage of the bands: bundles of seven wires drawn individually from a product, and bands from
 * five specimens of that product. */
#include <stdlib.h>

#include "analysis/predict/bands.h"
#include "base/file.h"
#include "base/random.h"
#include "base/text.h"
#include "base/units.h"
#include "fe/section/section_run.h"
#include "tests/check.h"
#include "tests/own_folder.h"

enum {
    TRUTHS = 60,
    SPECIMENS = 5,
    WIRES = 7,
    RUNS = 60
};

static const char bundle[] =
    "name: seven\nwires: [{wire: type3, count: 7}]\npacking: hexagon\ntape: tape\n"
    "length_mm: 114\ninterface: {cohesive_stiffness_N_mm3: 30, friction: 0.2}\n"
    "run: {deflection_mm: 20, rows: 5}\nloads: {weight: false}\nuncertainty:\n"
    "  wires: [{wire: type3, properties: properties.yaml}]\n"
    "  diameter_percent: 0\n  pitch_percent: 0\n  length_percent: 0\n"
    "  tape: {thickness_percent: 0, youngs_modulus_percent: 0, yield_stress_percent: 0}\n"
    "  cohesive_stiffness_N_mm3: [30, 30]\n  friction: [0.2, 0.2]\n";

/* The i-th wire of a product: E and stresses scatter by 8 %, half of it correlated. */
static void draw_wire(uint64_t truth, uint64_t i, struct wb_material *law)
{
    const double common = wb_random_normal(truth, 10, i);
    law->youngs_modulus =
        4528e6 * exp(0.08 * (0.7 * common + 0.7 * wb_random_normal(truth, 11, i)));
    law->yield_stress = 4.52e6 * exp(0.08 * (0.7 * common + 0.7 * wb_random_normal(truth, 12, i)));
    law->strength_coefficient =
        1327e6 * exp(0.08 * (0.7 * common + 0.7 * wb_random_normal(truth, 13, i)));
}

static void write_file(const char *name, const struct wb_text *text, char path[WB_PATH])
{
    assert_int_equal(wb_file_join(path, folder, name), WB_OK);
    assert_int_equal(wb_file_write_text(path, text), WB_OK);
}

static void write_specimens(uint64_t truth)
{
    char path[WB_PATH];
    struct wb_text text = {0};
    wb_text_append(&text, "wire: type3\nouter_diameter_mm: 1.4\nmass_per_length_kg_m: 0.00765\n"
                          "youngs_modulus_MPa: 4528\nyield_stress_MPa: 4.52\n"
                          "strength_coefficient_MPa: 1327\nhardening_exponent: 0.9\n"
                          "poissons_ratio: 0.39\nspecimens:\n");
    for (int i = 0; i < SPECIMENS; i++) {
        struct wb_material law;
        draw_wire(truth, (uint64_t)i, &law);
        wb_text_append(&text,
                       "  - {sample: %d, length_mm: 85, youngs_modulus_MPa: %.9g, "
                       "yield_stress_MPa: %.9g, strength_coefficient_MPa: %.9g, "
                       "hardening_exponent: 0.9}\n",
                       i, law.youngs_modulus / WB_MPA, law.yield_stress / WB_MPA,
                       law.strength_coefficient / WB_MPA);
    }
    write_file("properties.yaml", &text, path);
    wb_text_release(&text);
}

/* Force at the largest deflection of a bundle in which each wire has its own law. */
static double true_force(const char *path, uint64_t truth)
{
    static struct wb_bundle_model model;
    struct wb_section_run run;
    assert_int_equal(wb_bundle_model_read(&model, path), WB_OK);
    model.n_types = WIRES;
    for (int i = 0; i < WIRES; i++) {
        model.type[i] = model.type[0];
        model.type_of[i] = i;
        draw_wire(truth, 100 + (uint64_t)i, &model.type[i].material);
        wb_law_init_ludwik(&model.type[i].law, &model.type[i].material);
    }
    assert_int_equal(wb_section_run_init(&run, &model, 2), WB_OK);
    assert_int_equal(wb_section_run(&run, &model, NULL), WB_OK);
    assert_true(run.converged);
    const double force = run.rows[run.n_rows - 1].force;
    wb_section_run_release(&run);
    return force;
}

/* 60 truths: nine of ten are expected, with a standard deviation of 3.9 %; the limit is 2.6 of
 * them. */
static void nine_of_ten_bundles_lie_in_the_band_of_their_product(void **unused)
{
    (void)unused;
    struct wb_text text = {0};
    char path[WB_PATH];
    int within = 0;
    wb_text_append(&text, "%s", bundle);
    write_file("seven.yaml", &text, path);
    wb_text_release(&text);
    for (int t = 0; t < TRUTHS; t++) {
        const struct wb_bands_settings settings = {.runs = RUNS, .seed = (uint64_t)t};
        struct wb_bands *bands;
        write_specimens((uint64_t)t + 1);
        assert_int_equal(wb_bands_create(&bands, path, &settings), WB_OK);
        const struct wb_bands_interval *const band =
            &bands->cases[0].force[bands->cases[0].n_force - 1].band;
        const double force = true_force(path, (uint64_t)t + 1);
        within += force > band->low && force < band->high;
        wb_bands_destroy(bands);
    }
    print_message("%d of %d bundles within 90 %% of the runs\n", within, TRUTHS);
    assert_close((double)within / TRUTHS, 0.9, 0.1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nine_of_ten_bundles_lie_in_the_band_of_their_product),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
