/* Properties of the library, and bending by their law. */
#include <math.h>
#include <stdlib.h>

#include "analysis/calibration/law/bending.h"
#include "base/file.h"
#include "base/memory.h"
#include "library/handles.h"

#define WB_LOG_DOMAIN "library"

_Static_assert((int)WB_LAW_MOST_PARTS == (int)WIREBENCH_MOST_PARTS, "parts");
_Static_assert((int)WB_LAW_MOST_BACKS == (int)WIREBENCH_MOST_BACKS, "back stresses");

static enum wb_status make_chaboche(const struct wirebench_law *given,
                                    const struct wb_material *material, struct wb_law *law)
{
    struct wb_law_back backs[WB_LAW_MOST_BACKS];
    if (given->n_backs < 0 || given->n_backs > WB_LAW_MOST_BACKS)
        return wb_fail(WB_ERR_ARGUMENT, "n_backs: %d: expected 0 to %d", given->n_backs,
                       WB_LAW_MOST_BACKS);
    if (given->n_parts > 0)
        return wb_fail(WB_ERR_ARGUMENT,
                       "n_parts: %d: expected 0 with n_backs or saturation: a wire has one law",
                       given->n_parts);
    for (int i = 0; i < given->n_backs; i++)
        backs[i] = (struct wb_law_back){given->backs[i].modulus, given->backs[i].recovery};
    wb_law_init_chaboche(law, material, given->saturation, given->rate, backs, given->n_backs);
    return wb_law_check(law, NULL);
}

static enum wb_status make_law(const struct wirebench_law *given, struct wb_law *law)
{
    const struct wb_material material = {
        .hardening = WB_HARDENING_ISOTROPIC_POWER,
        .youngs_modulus = given->youngs_modulus,
        .poissons_ratio = given->poissons_ratio,
        .yield_stress = given->yield_stress,
        .strength_coefficient = given->strength_coefficient,
        /* A perfectly plastic wire needs no exponent. */
        .hardening_exponent = given->strength_coefficient == 0.0 ? 1.0 : given->hardening_exponent,
    };
    struct wb_law_part parts[WB_LAW_MOST_PARTS] = {
        {.modulus = given->youngs_modulus, .yield_strain = (double)INFINITY}};
    if (given->n_parts < 0 || given->n_parts > WB_LAW_MOST_PARTS)
        return wb_fail(WB_ERR_ARGUMENT, "n_parts: %d: expected 0 to %d", given->n_parts,
                       WB_LAW_MOST_PARTS);
    if (!(given->kinematic_share >= 0.0 && given->kinematic_share <= 1.0))
        return wb_fail(WB_ERR_ARGUMENT,
                       "kinematic_share: %g: expected 0 (isotropic hardening) to 1",
                       given->kinematic_share);
    for (int i = 0; i < given->n_parts; i++)
        parts[i] = (struct wb_law_part){given->parts[i].modulus, given->parts[i].yield_strain};
    const double isotropic_share = 1.0 - given->kinematic_share;
    if (given->n_backs != 0 || given->saturation != 0.0)
        return make_chaboche(given, &material, law);
    if (given->is_combined && given->n_parts == 0 && given->yield_stress == 0.0)
        return wb_fail(WB_ERR_ARGUMENT, "is_combined: expected 0 for a wire that never yields");
    if (given->n_parts > 0 || given->yield_stress == 0.0) {
        wb_law_init_parallel(law, parts, given->n_parts > 0 ? given->n_parts : 1, isotropic_share,
                             given->poissons_ratio);
        law->is_combined = given->is_combined;
        if (law->is_combined && isotropic_share == 1.0)
            return wb_fail(WB_ERR_ARGUMENT, "kinematic_share: 0: expected more for parallel parts "
                                            "with is_combined, which would never yield");
    } else {
        wb_law_init_ludwik(law, &material);
        law->isotropic_share = isotropic_share;
        law->is_combined = given->is_combined;
    }
    return wb_law_check(law, NULL);
}

static enum wb_status make(struct wirebench_properties *properties,
                           const struct wirebench_law *given)
{
    struct wb_wire wire = {.outer_diameter = given->outer_diameter};
    if (!(given->outer_diameter > 0.0 && isfinite(given->outer_diameter)))
        return wb_fail(WB_ERR_ARGUMENT, "outer_diameter: %g: expected metres, above 0",
                       given->outer_diameter);
    if (!(given->mass_per_length >= 0.0 && isfinite(given->mass_per_length)))
        return wb_fail(WB_ERR_ARGUMENT, "mass_per_length: %g: expected kg/m, 0 or more",
                       given->mass_per_length);
    WB_TRY(make_law(given, &wire.law));
    wire.material = wire.law.material;
    wb_properties_from_wire(&wire, &properties->source.properties);
    properties->source.properties.mass_per_length = given->mass_per_length;
    return WB_OK;
}

enum wirebench_status wirebench_properties_create(struct wirebench_properties **out,
                                                  const struct wirebench_law *law)
{
    struct wirebench_law given;
    wb_call_begin();
    if (wb_call_need(out, "out") != WB_OK ||
        wb_call_take(&given, sizeof given, law, "wirebench_law") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    struct wirebench_properties *const properties = wb_memory_new(1, sizeof *properties);
    const enum wb_status status = make(properties, &given);
    if (status == WB_OK)
        *out = properties;
    else
        wirebench_properties_destroy(properties);
    return wb_call_end(status);
}

enum wirebench_status wirebench_properties_read(struct wirebench_properties **out,
                                                const char *path_or_name)
{
    char path[WB_PATH];
    wb_call_begin();
    if (wb_call_need(out, "out") != WB_OK || wb_call_need(path_or_name, "path_or_name") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    struct wirebench_properties *const properties = wb_memory_new(1, sizeof *properties);
    enum wb_status status = wb_file_find_fixture(path, "wires", path_or_name, NULL);
    if (status == WB_OK)
        status = wb_card_source_read(&properties->source, path);
    if (status == WB_OK)
        *out = properties;
    else
        wirebench_properties_destroy(properties);
    return wb_call_end(status);
}

void wirebench_properties_destroy(struct wirebench_properties *properties)
{
    if (!properties)
        return;
    wb_text_release(&properties->text);
    free(properties);
}

static struct wirebench_estimate estimate(const struct wb_estimate *e)
{
    return (struct wirebench_estimate){e->value, e->low, e->high, e->candidates_low,
                                       e->candidates_high};
}

enum wirebench_status wirebench_properties_describe(const struct wirebench_properties *properties,
                                                    struct wirebench_properties_info *info)
{
    wb_call_begin();
    if (wb_call_need(properties, "properties") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    const struct wb_properties *const p = &properties->source.properties;
    const struct wb_law *const law = &p->law;
    const struct wb_estimate rigidity = wb_card_source_rigidity(&properties->source);
    struct wirebench_properties_info mine = {
        .wire = p->wire,
        .method = p->method,
        .outer_diameter = p->outer_diameter,
        .mass_per_length = p->mass_per_length,
        .poissons_ratio = p->material.poissons_ratio,
        .youngs_modulus = p->material.youngs_modulus,
        .yield_stress = p->material.yield_stress,
        .strength_coefficient = p->material.strength_coefficient,
        .hardening_exponent = p->material.hardening_exponent,
        .n_parts = law->n_parts,
        .kinematic_share = 1.0 - law->isotropic_share,
        .rms = p->rms,
        .largest_curvature = p->largest_curvature,
        .rigidity = estimate(&rigidity),
        .residual_curvature_ratio = estimate(&p->residual_curvature_ratio),
        .n_samples = p->n_samples,
        .is_rule_supported = p->is_rule_supported,
        .is_virtual = p->is_virtual,
        .is_simulation = p->is_simulation,
        .saturation = law->saturation,
        .rate = law->rate,
        .n_backs = law->n_backs,
        .is_combined = law->is_combined,
        .law_youngs_modulus = law->material.youngs_modulus,
        .law_yield_stress = law->material.yield_stress,
        .deflection_springback = estimate(&p->springback),
    };
    for (int i = 0; i < 4; i++)
        mine.deviation[i] = p->deviation[i];
    for (int i = 0; i < law->n_parts; i++)
        mine.parts[i] = (struct wirebench_part){law->parts[i].modulus, law->parts[i].yield_strain};
    for (int i = 0; i < law->n_backs; i++)
        mine.backs[i] = (struct wirebench_back){law->backs[i].modulus, law->backs[i].recovery};
    return wb_call_end(wb_call_give(info, &mine, sizeof mine, "wirebench_properties_info"));
}

const char *wirebench_properties_text(const struct wirebench_properties *properties)
{
    return properties->text.length > 0 ? wb_text_string(&properties->text) : NULL;
}

/* --- bending --- */

enum wirebench_status wirebench_moments(const struct wirebench_properties *properties, size_t n,
                                        const double *curvature, double *moment)
{
    wb_call_begin();
    if (wb_call_need(properties, "properties") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    if (n == 0)
        return wb_call_end(WB_OK);
    if (wb_call_need(curvature, "curvature") != WB_OK || wb_call_need(moment, "moment") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    if (n > INT32_MAX)
        return wb_call_end(
            wb_fail(WB_ERR_ARGUMENT, "%zu curvatures: expected at most %d", n, INT32_MAX));
    for (size_t i = 0; i < n; i++) {
        if (!(curvature[i] >= 0.0 && isfinite(curvature[i])))
            return wb_call_end(wb_fail(WB_ERR_ARGUMENT,
                                       "curvature %zu: %g: expected 1/m, 0 or more: a first "
                                       "loading",
                                       i, curvature[i]));
    }
    const struct wb_properties *const p = &properties->source.properties;
    return wb_call_end(wb_bending_moments(&p->law, p->outer_diameter, (int)n, curvature, moment));
}

enum wirebench_status wirebench_bend(const struct wirebench_properties *properties, double largest,
                                     struct wirebench_bending *bending)
{
    wb_call_begin();
    if (wb_call_need(properties, "properties") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    if (!(largest > 0.0 && isfinite(largest)))
        return wb_call_end(
            wb_fail(WB_ERR_ARGUMENT, "largest curvature %g: expected 1/m, above 0", largest));
    const struct wb_properties *const p = &properties->source.properties;
    struct wb_bending found;
    const enum wb_status status = wb_bending_describe(&p->law, p->outer_diameter, largest, &found);
    if (status != WB_OK)
        return wb_call_end(status);
    const struct wirebench_bending mine = {.rigidity = found.flexural_rigidity,
                                           .residual_curvature_ratio =
                                               found.residual_curvature_ratio,
                                           .loop_energy = found.loop_energy};
    return wb_call_end(wb_call_give(bending, &mine, sizeof mine, "wirebench_bending"));
}
