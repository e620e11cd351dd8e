/* Wires for the tests of cards, as contents of files. */
#ifndef WB_TESTS_ANALYSIS_CARDS_WIRES_H
#define WB_TESTS_ANALYSIS_CARDS_WIRES_H

#include "analysis/cards/card.h"
#include "base/units.h"
#include "tests/messages.h"

#define LUDWIK_NUMBERS                                                                             \
    "youngs_modulus_MPa: 5000\nyield_stress_MPa: 5\nstrength_coefficient_MPa: 900\n"               \
    "hardening_exponent: 0.8\npoissons_ratio: 0.39\n"

/* The head of a properties file, to which a law and a calibration can be added. */
#define PROPERTIES                                                                                 \
    "wire: test\nouter_diameter_mm: 1.2\nmass_per_length_kg_m: 0.004\n" LUDWIK_NUMBERS

#define PARTS                                                                                      \
    "  parts:\n"                                                                                   \
    "    - {modulus_MPa: 2500, yield_strain: 0.0005}\n"                                            \
    "    - {modulus_MPa: 1500, yield_strain: 0.0015}\n"                                            \
    "    - {modulus_MPa: 700, yield_strain: 0.005}\n"                                              \
    "    - {modulus_MPa: 300}\n"
#define KINEMATIC "law:\n  form: parallel\n  hardening: kinematic\n" PARTS
#define ISOTROPIC "law:\n  form: parallel\n  hardening: isotropic\n" PARTS
#define MIXED "law:\n  form: parallel\n  hardening: mixed\n  isotropic_share: 0.3\n" PARTS
#define GROWING "law:\n  form: parallel\n  hardening: combined\n  isotropic_share: 0.2\n" PARTS
#define COMBINED "law: {form: ludwik, hardening: combined, isotropic_share: 0.3}\n"
#define CHABOCHE                                                                                   \
    "law:\n  form: chaboche\n  hardening: combined\n  chaboche: {youngs_modulus_MPa: 5500, "       \
    "yield_stress_MPa: 2, saturation_MPa: 1.5, rate: 250, back_stresses: "                         \
    "[{modulus_MPa: 2600, recovery: 900}, {modulus_MPa: 700, recovery: 60}]}\n"

static inline struct wb_card_source source_of(const char *text)
{
    struct wb_card_source source;
    assert_int_equal(wb_card_source_parse(&source, text, "folder/test.yaml", NULL), WB_OK);
    return source;
}

static inline struct wb_card_settings card_defaults(void)
{
    struct wb_card_settings settings;
    wb_setting_fill(&wb_card_table, &settings);
    return settings;
}

/* The card; the caller releases it. */
static inline struct wb_text card_of(const char *kind, const struct wb_card_source *source,
                                     const struct wb_card_settings *settings)
{
    struct wb_text card = {0};
    const struct wb_card_kind *const found = wb_card_find(kind);
    assert_non_null(found);
    assert_int_equal(wb_card_write(found, source, settings, &card, NULL), WB_OK);
    return card;
}

#endif
