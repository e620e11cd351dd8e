#include "fe/material/law_file.h"

#include <math.h>

#include "base/number.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "law"

enum rule {
    ISOTROPIC,
    KINEMATIC,
    MIXED
};

static const char *const forms[] = {"ludwik", "parallel", NULL};
static const char *const rules[] = {"isotropic", "kinematic", "mixed", NULL};

static enum wb_status read_parts(const struct wb_config_node *node, struct wb_law_part *parts,
                                 int *n)
{
    *n = wb_config_length(node);
    if (*n < 1 || *n > WB_LAW_MOST_PARTS)
        return wb_config_refuse(node, "parts", "expected a list of 1 to %d parts",
                                WB_LAW_MOST_PARTS);
    double before = 0.0;
    for (int i = 0; i < *n; i++) {
        const struct wb_config_node *const item = wb_config_item(node, i);
        struct wb_law_part *const part = &parts[i];
        const struct wb_config_key keys[] = {
            WB_CONFIG_NUMBER("modulus_MPa", &part->modulus, WB_MPA, 0.0, 1e7),
            WB_CONFIG_OPTIONAL_NUMBER("yield_strain", &part->yield_strain, 1.0, 1e-9, 1.0),
        };
        part->yield_strain = (double)INFINITY;
        WB_TRY(wb_config_map(item, keys, WB_COUNT(keys)));
        if (isinf(part->yield_strain) && i + 1 < *n)
            return wb_config_refuse(item, "yield_strain",
                                    "this key is missing: only the last part may stay elastic");
        if (!(part->yield_strain > before))
            return wb_config_refuse(item, "yield_strain",
                                    "%g: expected more than the part before, "
                                    "%g",
                                    part->yield_strain, before);
        before = part->yield_strain;
    }
    return WB_OK;
}

static enum wb_status check_share(const struct wb_config_node *node, int rule, bool has_share)
{
    if (rule == MIXED && !has_share)
        return wb_config_refuse(node, "isotropic_share",
                                "this key is missing: mixed hardening needs it");
    if (rule != MIXED && has_share)
        return wb_config_refuse(node, "isotropic_share", "%s hardening has none", rules[rule]);
    return WB_OK;
}

enum wb_status wb_law_file_read(const struct wb_config_node *node, const struct wb_material *ludwik,
                                struct wb_law *law)
{
    const struct wb_config_node *list = NULL;
    struct wb_law_part parts[WB_LAW_MOST_PARTS];
    int form = WB_LAW_LUDWIK, rule = ISOTROPIC, n = 0;
    double share = -1.0;
    wb_law_init_ludwik(law, ludwik);
    if (!node)
        return WB_OK;
    const struct wb_config_key keys[] = {
        WB_CONFIG_CHOICE("form", &form, forms),
        WB_CONFIG_CHOICE("hardening", &rule, rules),
        WB_CONFIG_OPTIONAL_NUMBER("isotropic_share", &share, 1.0, 0.0, 1.0),
        WB_CONFIG_OPTIONAL_NODE("parts", &list),
    };
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    WB_TRY(check_share(node, rule, share >= 0.0));
    const double beta = rule == MIXED ? share : rule == ISOTROPIC ? 1.0 : 0.0;
    if (form == WB_LAW_LUDWIK) {
        if (list)
            return wb_config_refuse(node, "parts", "Ludwik's law has none");
        law->isotropic_share = beta;
        if (beta < 1.0 && ludwik->hardening_exponent > 1.0)
            return wb_config_refuse(node, "hardening",
                                    "%s hardening needs a hardening_exponent of at most 1, not %g",
                                    rules[rule], ludwik->hardening_exponent);
        return WB_OK;
    }
    if (!list)
        return wb_config_refuse(node, "parts",
                                "this key is missing: a law of parallel parts needs "
                                "them");
    WB_TRY(read_parts(list, parts, &n));
    wb_law_init_parallel(law, parts, n, beta, ludwik->poissons_ratio);
    return wb_law_check(law, NULL);
}

void wb_law_file_append(struct wb_text *text, const struct wb_law *law)
{
    char number[WB_NUMBER_TEXT];
    if (wb_law_is_plain(law))
        return;
    wb_text_append(text, "law:\n  form: %s\n  hardening: %s\n", wb_law_form_name(law->form),
                   wb_law_rule_name(law));
    if (law->isotropic_share > 0.0 && law->isotropic_share < 1.0)
        wb_text_append(text, "  isotropic_share: %s\n",
                       wb_number_format(law->isotropic_share, number));
    if (law->form == WB_LAW_PARALLEL)
        wb_text_append(text, "  parts:\n");
    for (int i = 0; i < law->n_parts; i++) {
        const struct wb_law_part *const part = &law->parts[i];
        wb_text_append(text, "    - {modulus_MPa: %s",
                       wb_number_format(part->modulus / WB_MPA, number));
        if (isfinite(part->yield_strain))
            wb_text_append(text, ", yield_strain: %s",
                           wb_number_format(part->yield_strain, number));
        wb_text_append(text, "}\n");
    }
}
