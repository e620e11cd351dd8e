/* One law of each form and hardening rule, for tests of rods in space. */
#ifndef WB_TESTS_FE_ROD_LAWS_H
#define WB_TESTS_FE_ROD_LAWS_H

#include "base/units.h"
#include "fe/material/law.h"
#include "tests/check.h"

/* Ludwik's law of type 3, parallel parts of a similar wire, Chaboche's law. */
static inline struct wb_law test_laws_get(int i)
{
    static const struct wb_material type_3 = {
        WB_HARDENING_ISOTROPIC_POWER, 4528.0 * WB_MPA, 0.39, 4.52 * WB_MPA, 1327.0 * WB_MPA, 0.90};
    static const struct wb_law_part parts[] = {
        {1300.0 * WB_MPA, 7e-4}, {900.0 * WB_MPA, 1.5e-3}, {700.0 * WB_MPA, 4e-3},
        {500.0 * WB_MPA, 9e-3},  {400.0 * WB_MPA, 2e-2},   {600.0 * WB_MPA, (double)INFINITY}};
    static const struct wb_material elastic = {
        WB_HARDENING_NONE_ELASTIC, 4528.0 * WB_MPA, 0.39, 2.2 * WB_MPA, 0.0, 0.0};
    static const struct wb_law_back backs[] = {{2600.0 * WB_MPA, 300.0}, {1500.0 * WB_MPA, 0.0}};
    static const double shares[] = {1.0, 0.0, 0.4, 0.4};
    struct wb_law law;
    if (i < 4) {
        wb_law_init_ludwik(&law, &type_3);
        law.isotropic_share = shares[i];
        law.is_combined = i == 3;
    } else if (i < 8) {
        wb_law_init_parallel(&law, parts, sizeof parts / sizeof parts[0], shares[i - 4], 0.39);
        law.is_combined = i == 7;
    } else {
        wb_law_init_chaboche(&law, &elastic, 1.4 * WB_MPA, 250.0, backs, 2);
    }
    assert_int_equal(wb_law_check(&law, NULL), WB_OK);
    return law;
}

enum {
    TEST_LAWS = 9
};

#endif
