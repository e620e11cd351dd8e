#include "fe/material/law_file.h"

#include <math.h>

#include "base/number.h"
#include "base/units.h"

enum rule {
    ISOTROPIC,
    KINEMATIC,
    MIXED,
    COMBINED
};

static const char *const forms[] = {"ludwik", "parallel", "chaboche", NULL};
static const char *const rules[] = {"isotropic", "kinematic", "mixed", "combined", NULL};

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

static enum wb_status read_backs(const struct wb_config_node *node, struct wb_law_back *backs,
                                 int *n)
{
    *n = wb_config_length(node);
    if (*n < 1 || *n > WB_LAW_MOST_BACKS)
        return wb_config_refuse(node, "back_stresses", "expected a list of 1 to %d back stresses",
                                WB_LAW_MOST_BACKS);
    for (int i = 0; i < *n; i++) {
        const struct wb_config_key keys[] = {
            WB_CONFIG_NUMBER("modulus_MPa", &backs[i].modulus, WB_MPA, 1e-9, 1e9),
            WB_CONFIG_NUMBER("recovery", &backs[i].recovery, 1.0, 0.0, 1e7),
        };
        WB_TRY(wb_config_map(wb_config_item(node, i), keys, WB_COUNT(keys)));
    }
    return WB_OK;
}

static enum wb_status read_maxwell(const struct wb_config_node *node, struct wb_law *law)
{
    const struct wb_config_node *list;
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_NUMBER("strain_rate_1_s", &law->strain_rate, 1.0, 0.0, 1e6),
        WB_CONFIG_NODE("elements", &list),
    };
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    const int n = wb_config_length(list);
    if (n < 1 || n > WB_LAW_MOST_MAXWELL)
        return wb_config_refuse(list, "elements", "expected a list of 1 to %d Maxwell elements",
                                WB_LAW_MOST_MAXWELL);
    for (int i = 0; i < n; i++) {
        const struct wb_config_key numbers[] = {
            WB_CONFIG_NUMBER("modulus_MPa", &law->maxwell[i].modulus, WB_MPA, 0.0, 1e7),
            WB_CONFIG_NUMBER("time_s", &law->maxwell[i].time, 1.0, 1e-6, 1e9),
        };
        WB_TRY(wb_config_map(wb_config_item(list, i), numbers, WB_COUNT(numbers)));
    }
    law->n_maxwell = n;
    return WB_OK;
}

/* Of Chaboche's law: its numbers stand in a block of their own, as those beside are Ludwik's. */
static enum wb_status read_chaboche(const struct wb_config_node *node, double poissons_ratio,
                                    struct wb_law *law)
{
    const struct wb_config_node *list = NULL;
    struct wb_material material = {.poissons_ratio = poissons_ratio};
    struct wb_law_back backs[WB_LAW_MOST_BACKS];
    double saturation = 0.0, rate = 0.0;
    int n = 0;
    const struct wb_config_key keys[] = {
        WB_CONFIG_NUMBER("youngs_modulus_MPa", &material.youngs_modulus, WB_MPA, 1e-3, 1e7),
        WB_CONFIG_NUMBER("yield_stress_MPa", &material.yield_stress, WB_MPA, 1e-6, 1e6),
        WB_CONFIG_OPTIONAL_NUMBER("saturation_MPa", &saturation, WB_MPA, 0.0, 1e6),
        WB_CONFIG_OPTIONAL_NUMBER("rate", &rate, 1.0, 0.0, 1e7),
        WB_CONFIG_OPTIONAL_NODE("back_stresses", &list),
    };
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    if (list)
        WB_TRY(read_backs(list, backs, &n));
    wb_law_init_chaboche(law, &material, saturation, rate, backs, n);
    return wb_law_check(law, NULL);
}

static enum wb_status check_share(const struct wb_config_node *node, int rule, bool has_share)
{
    const bool needs_share = rule == MIXED || rule == COMBINED;
    if (needs_share && !has_share)
        return wb_config_refuse(node, "isotropic_share",
                                "this key is missing: %s hardening needs it", rules[rule]);
    if (!needs_share && has_share)
        return wb_config_refuse(node, "isotropic_share", "%s hardening has no isotropic share",
                                rules[rule]);
    return WB_OK;
}

static enum wb_status read_relaxed(const struct wb_config_node *node,
                                   const struct wb_material *ludwik,
                                   const struct wb_config_node **relaxation, struct wb_law *law)
{
    const struct wb_config_node *list = NULL, *chaboche = NULL;
    struct wb_law_part parts[WB_LAW_MOST_PARTS];
    int form = WB_LAW_LUDWIK, rule = ISOTROPIC, n = 0;
    double share = -1.0;
    const struct wb_config_key keys[] = {
        WB_CONFIG_CHOICE("form", &form, forms),
        WB_CONFIG_CHOICE("hardening", &rule, rules),
        WB_CONFIG_OPTIONAL_NUMBER("isotropic_share", &share, 1.0, 0.0, 1.0),
        WB_CONFIG_OPTIONAL_NODE("parts", &list),
        WB_CONFIG_OPTIONAL_NODE("chaboche", &chaboche),
        WB_CONFIG_OPTIONAL_NODE("relaxation", relaxation),
    };
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    if (list && form != WB_LAW_PARALLEL)
        return wb_config_refuse(node, "parts", "%s has no parts", wb_law_form_words(form));
    if (chaboche && form != WB_LAW_CHABOCHE)
        return wb_config_refuse(node, "chaboche", "only with `form: chaboche`, not '%s'",
                                forms[form]);
    if (form == WB_LAW_CHABOCHE) {
        if (!chaboche)
            return wb_config_refuse(node, "chaboche",
                                    "this key is missing: Chaboche's law needs its parameters");
        if (rule != COMBINED || share >= 0.0)
            return wb_config_refuse(node, share >= 0.0 ? "isotropic_share" : "hardening",
                                    "expected `hardening: combined` without a share");
        return read_chaboche(chaboche, ludwik->poissons_ratio, law);
    }
    WB_TRY(check_share(node, rule, share >= 0.0));
    const double beta = share >= 0.0 ? share : rule == ISOTROPIC ? 1.0 : 0.0;
    if (form == WB_LAW_LUDWIK) {
        law->isotropic_share = beta;
        law->is_combined = rule == COMBINED;
        if (wb_law_is_overlay(law) && ludwik->hardening_exponent > 1.0)
            return wb_config_refuse(node, "hardening",
                                    "%s hardening needs a hardening_exponent of at most 1, not %g",
                                    rules[rule], ludwik->hardening_exponent);
        return WB_OK;
    }
    if (rule == COMBINED && beta == 1.0)
        return wb_config_refuse(node, "isotropic_share",
                                "1: expected less than 1 for parallel parts with combined "
                                "hardening, which would never yield");
    if (!list)
        return wb_config_refuse(node, "parts",
                                "this key is missing: a law of parallel parts needs "
                                "them");
    WB_TRY(read_parts(list, parts, &n));
    wb_law_init_parallel(law, parts, n, beta, ludwik->poissons_ratio);
    law->is_combined = rule == COMBINED;
    return wb_law_check(law, NULL);
}

enum wb_status wb_law_file_read(const struct wb_config_node *node, const struct wb_material *ludwik,
                                struct wb_law *law)
{
    const struct wb_config_node *relaxation = NULL;
    wb_law_init_ludwik(law, ludwik);
    if (!node)
        return WB_OK;
    WB_TRY(read_relaxed(node, ludwik, &relaxation, law));
    return relaxation ? read_maxwell(relaxation, law) : WB_OK;
}

static void append_stress(struct wb_text *text, const char *key, double stress)
{
    char number[WB_NUMBER_TEXT];
    wb_text_append(text, "    %s: %s\n", key, wb_number_format(stress / WB_MPA, number));
}

static void append_chaboche(struct wb_text *text, const struct wb_law *law)
{
    char one[WB_NUMBER_TEXT], other[WB_NUMBER_TEXT];
    wb_text_append(text, "  chaboche:\n");
    append_stress(text, "youngs_modulus_MPa", law->material.youngs_modulus);
    append_stress(text, "yield_stress_MPa", law->material.yield_stress);
    append_stress(text, "saturation_MPa", law->saturation);
    wb_text_append(text, "    rate: %s\n", wb_number_format(law->rate, one));
    if (law->n_backs > 0)
        wb_text_append(text, "    back_stresses:\n");
    for (int i = 0; i < law->n_backs; i++)
        wb_text_append(text, "      - {modulus_MPa: %s, recovery: %s}\n",
                       wb_number_format(law->backs[i].modulus / WB_MPA, one),
                       wb_number_format(law->backs[i].recovery, other));
}

void wb_law_file_append(struct wb_text *text, const struct wb_law *law)
{
    char number[WB_NUMBER_TEXT], other[WB_NUMBER_TEXT];
    if (wb_law_is_plain(law) && law->n_maxwell == 0)
        return;
    wb_text_append(text, "law:\n  form: %s\n  hardening: %s\n", wb_law_form_name(law->form),
                   wb_law_rule_name(law));
    if (wb_law_has_share(law))
        wb_text_append(text, "  isotropic_share: %s\n",
                       wb_number_format(law->isotropic_share, number));
    if (law->form == WB_LAW_CHABOCHE)
        append_chaboche(text, law);
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
    if (law->n_maxwell > 0)
        wb_text_append(text, "  relaxation:\n    strain_rate_1_s: %s\n    elements:\n",
                       wb_number_format(law->strain_rate, number));
    for (int i = 0; i < law->n_maxwell; i++)
        wb_text_append(text, "      - {modulus_MPa: %s, time_s: %s}\n",
                       wb_number_format(law->maxwell[i].modulus / WB_MPA, number),
                       wb_number_format(law->maxwell[i].time, other));
}
