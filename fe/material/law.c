#include "fe/material/law.h"

#include <math.h>
#include <string.h>

#include "base/units.h"
#include "fe/material/hardening.h"
#include "fe/material/law_private.h"

#define WB_LOG_DOMAIN "law"

/* Strain range of Ludwik's overlay: the larger of the two. */
static const double reach_strain = 0.1;
static const double reach_of_yield_strain = 50.0;

/* Points of the curve between which the corners of Ludwik's overlay are sought. */
enum {
    CURVE_POINTS = 256
};

void wb_law_init_ludwik(struct wb_law *law, const struct wb_material *material)
{
    *law = (struct wb_law){
        .form = WB_LAW_LUDWIK, .isotropic_share = 1.0, .material = *material, .n_parts = 0};
}

void wb_law_init_parallel(struct wb_law *law, const struct wb_law_part *parts, int n,
                          double isotropic_share, double poissons_ratio)
{
    *law = (struct wb_law){
        .form = WB_LAW_PARALLEL,
        .isotropic_share = isotropic_share,
        .material = {.hardening = WB_HARDENING_NONE_ELASTIC, .poissons_ratio = poissons_ratio},
        .n_parts = n,
    };
    for (int i = 0; i < n && i < WB_LAW_MOST_PARTS; i++) {
        law->parts[i] = parts[i];
        law->material.youngs_modulus += parts[i].modulus;
    }
}

void wb_law_init_chaboche(struct wb_law *law, const struct wb_material *material, double saturation,
                          double rate, const struct wb_law_back *backs, int n_backs)
{
    *law = (struct wb_law){
        .form = WB_LAW_CHABOCHE,
        .is_combined = true,
        .material = {.hardening = WB_HARDENING_NONE_ELASTIC,
                     .youngs_modulus = material->youngs_modulus,
                     .poissons_ratio = material->poissons_ratio,
                     .yield_stress = material->yield_stress},
        .saturation = saturation,
        .rate = rate,
        .n_backs = n_backs,
    };
    double all = saturation;
    for (int i = 0; i < n_backs && i < WB_LAW_MOST_BACKS; i++) {
        law->backs[i] = backs[i];
        all += backs[i].recovery > 0.0 ? backs[i].modulus / backs[i].recovery : (double)INFINITY;
    }
    law->isotropic_share = saturation > 0.0 ? saturation / all : 0.0;
}

bool wb_law_is_plain(const struct wb_law *law)
{
    return law->form == WB_LAW_LUDWIK && law->isotropic_share == 1.0 && !law->is_combined;
}

bool wb_law_is_overlay(const struct wb_law *law)
{
    return law->form == WB_LAW_PARALLEL || (!law->is_combined && !wb_law_is_plain(law));
}

static enum wb_status check_parts(const struct wb_law *law, struct wb_reason *why)
{
    if (law->n_parts < 1 || law->n_parts > WB_LAW_MOST_PARTS)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "%d parallel parts: expected 1 to %d", law->n_parts,
                          WB_LAW_MOST_PARTS);
    double before = 0.0, sum = 0.0;
    for (int i = 0; i < law->n_parts; i++) {
        const struct wb_law_part *const part = &law->parts[i];
        if (!(isfinite(part->modulus) && part->modulus >= 0.0))
            return wb_fail_to(why, WB_ERR_ARGUMENT, "part %d: modulus %g Pa: expected 0 or more",
                              i + 1, part->modulus);
        if (!(part->yield_strain > before))
            return wb_fail_to(why, WB_ERR_ARGUMENT,
                              "part %d: yield strain %g: expected more than %g", i + 1,
                              part->yield_strain, before);
        if (isinf(part->yield_strain) && i + 1 < law->n_parts)
            return wb_fail_to(why, WB_ERR_ARGUMENT,
                              "part %d does not yield: expected that of the last part only", i + 1);
        before = part->yield_strain;
        sum += part->modulus;
    }
    if (!(sum > 0.0 && fabs(sum - law->material.youngs_modulus) <= 1e-9 * sum))
        return wb_fail_to(
            why, WB_ERR_ARGUMENT,
            "the parts' moduli add up to %g Pa and Young's modulus is %g Pa: expected "
            "the same number above 0",
            sum, law->material.youngs_modulus);
    return WB_OK;
}

static enum wb_status check_chaboche(const struct wb_law *law, struct wb_reason *why)
{
    const struct wb_material *const m = &law->material;
    if (!(isfinite(m->youngs_modulus) && m->youngs_modulus > 0.0 && isfinite(m->yield_stress) &&
          m->yield_stress > 0.0))
        return wb_fail_to(why, WB_ERR_ARGUMENT,
                          "Young's modulus %g Pa, yield stress %g Pa: expected both above 0",
                          m->youngs_modulus, m->yield_stress);
    if (!(isfinite(law->saturation) && law->saturation >= 0.0 && isfinite(law->rate) &&
          law->rate >= 0.0))
        return wb_fail_to(why, WB_ERR_ARGUMENT,
                          "the yield stress grows by %g Pa with the rate %g: expected 0 or more",
                          law->saturation, law->rate);
    if (law->n_backs < 0 || law->n_backs > WB_LAW_MOST_BACKS)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "%d back stresses: expected 0 to %d", law->n_backs,
                          WB_LAW_MOST_BACKS);
    for (int i = 0; i < law->n_backs; i++) {
        const struct wb_law_back *const back = &law->backs[i];
        if (!(isfinite(back->modulus) && back->modulus > 0.0 && isfinite(back->recovery) &&
              back->recovery >= 0.0))
            return wb_fail_to(why, WB_ERR_ARGUMENT,
                              "back stress %d: modulus %g Pa, recovery %g: expected above 0, and 0 "
                              "or more",
                              i + 1, back->modulus, back->recovery);
    }
    return WB_OK;
}

static enum wb_status check_maxwell(const struct wb_law *law, struct wb_reason *why)
{
    if (law->n_maxwell < 0 || law->n_maxwell > WB_LAW_MOST_MAXWELL)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "%d Maxwell elements: expected 0 to %d",
                          law->n_maxwell, WB_LAW_MOST_MAXWELL);
    if (!(isfinite(law->strain_rate) && law->strain_rate >= 0.0))
        return wb_fail_to(why, WB_ERR_ARGUMENT, "strain rate %g 1/s: expected 0 or more",
                          law->strain_rate);
    for (int i = 0; i < law->n_maxwell; i++) {
        const struct wb_law_maxwell *const element = &law->maxwell[i];
        if (!(isfinite(element->modulus) && element->modulus >= 0.0 && isfinite(element->time) &&
              element->time > 0.0))
            return wb_fail_to(why, WB_ERR_ARGUMENT,
                              "Maxwell element %d: modulus %g Pa, time %g s: expected 0 or more, "
                              "and above 0",
                              i + 1, element->modulus, element->time);
    }
    return WB_OK;
}

enum wb_status wb_law_check(const struct wb_law *law, struct wb_reason *why)
{
    WB_TRY(check_maxwell(law, why));
    if (law->form == WB_LAW_CHABOCHE)
        return check_chaboche(law, why);
    if (!(law->isotropic_share >= 0.0 && law->isotropic_share <= 1.0))
        return wb_fail_to(why, WB_ERR_ARGUMENT, "isotropic share %g: expected 0 to 1",
                          law->isotropic_share);
    if (law->form == WB_LAW_PARALLEL)
        return law->is_combined && law->isotropic_share == 1.0
                   ? wb_fail_to(why, WB_ERR_ARGUMENT,
                                "isotropic share 1: expected less than 1 for parallel parts with "
                                "combined hardening, which would never yield")
                   : check_parts(law, why);
    if (!wb_hardening_law(&law->material)->growth)
        return wb_fail_to(why, WB_ERR_ARGUMENT,
                          "Ludwik's law needs a material whose yield stress grows");
    char text[120];
    if (!wb_hardening_is_possible(&law->material, text, sizeof text))
        return wb_fail_to(why, WB_ERR_ARGUMENT, "%s", text);
    if (wb_law_is_overlay(law) && law->material.hardening_exponent > 1.0)
        return wb_fail_to(why, WB_ERR_ARGUMENT,
                          "hardening exponent %g: expected at most 1 with kinematic or mixed "
                          "hardening, where a steepening curve would release plastic work",
                          law->material.hardening_exponent);
    return WB_OK;
}

/* A point of Ludwik's curve. */
struct point {
    double strain, stress;
};

static struct point ludwik_point(const struct wb_material *m, double p)
{
    const double stress = m->yield_stress + wb_hardening_law(m)->growth(m, p);
    return (struct point){p + stress / m->youngs_modulus, stress};
}

/* Plastic strain at which Ludwik's curve reaches a strain beyond yield. */
static double plastic_strain(const struct wb_material *m, double strain)
{
    const double overstress = m->youngs_modulus * strain - m->yield_stress;
    return wb_hardening_ratio(m, overstress) * overstress / m->youngs_modulus;
}

/* The corners: yield, the reach, and between them as many as there are parts left, closer where
 * the curve bends more. With a distance h between corners a chord lies below the curve by h^2 F''
 * / 12 in the mean; that is the same part of the stress in all intervals when sqrt(F'' / F) de is.
 * Returns this part. */
static double place_corners(const struct wb_material *m, struct point *corners, int n)
{
    const double yield_strain = m->yield_stress / m->youngs_modulus;
    const double reach = fmax(reach_strain, reach_of_yield_strain * yield_strain);
    const double last = plastic_strain(m, reach), first = 1e-6 * yield_strain;
    struct point points[CURVE_POINTS];
    double sum[CURVE_POINTS] = {0.0};

    points[0] = (struct point){yield_strain, m->yield_stress};
    double slope = m->youngs_modulus;
    for (int i = 1; i < CURVE_POINTS; i++) {
        const double share = (double)(i - 1) / (CURVE_POINTS - 2);
        points[i] = ludwik_point(m, first * pow(last / first, share));
        const double step = points[i].strain - points[i - 1].strain;
        const double next = (points[i].stress - points[i - 1].stress) / step;
        sum[i] = sum[i - 1] + sqrt(fmax(slope - next, 0.0) * step / points[i].stress);
        slope = next;
    }
    int at = 1;
    for (int k = 0; k < n; k++) {
        const double wanted = sum[CURVE_POINTS - 1] * k / (n - 1);
        while (at < CURVE_POINTS - 1 && sum[at] < wanted)
            at++;
        const double width = sum[at] - sum[at - 1];
        const double share = width > 0.0 ? fmin(fmax((wanted - sum[at - 1]) / width, 0.0), 1.0) : 0;
        const double strain =
            points[at - 1].strain + share * (points[at].strain - points[at - 1].strain);
        corners[k] = k == 0       ? points[0]
                     : k == n - 1 ? points[CURVE_POINTS - 1]
                                  : ludwik_point(m, plastic_strain(m, strain));
    }
    const double interval = sum[CURVE_POINTS - 1] / (n - 1);
    return interval * interval / 12.0;
}

static void ludwik_overlay(const struct wb_law *law, struct wb_overlay *overlay)
{
    enum {
        CORNERS = WB_LAW_LUDWIK_PARTS - 1
    };
    struct point corners[CORNERS];
    double slope = law->material.youngs_modulus;

    /* Raised by the mean distance of the chords below the curve, so that they follow it in the
     * mean. */
    const double raised = 1.0 + place_corners(&law->material, corners, CORNERS);
    for (int k = 1; k < CORNERS; k++)
        corners[k].stress *= raised;
    for (int k = 0; k < CORNERS; k++) {
        double next;
        if (k + 1 < CORNERS)
            next = (corners[k + 1].stress - corners[k].stress) /
                   (corners[k + 1].strain - corners[k].strain);
        else
            (void)wb_law_virgin_stress(law, corners[k].strain, &next);
        next = fmin(k + 1 < CORNERS ? next : raised * next, slope);
        overlay->modulus[k] = slope - next;
        overlay->yield_strain[k] = corners[k].strain;
        slope = next;
    }
    overlay->modulus[CORNERS] = slope;
    overlay->yield_strain[CORNERS] = (double)INFINITY;
    overlay->n = WB_LAW_LUDWIK_PARTS;
}

void wb_law_overlay(const struct wb_law *law, struct wb_overlay *overlay)
{
    memset(overlay, 0, sizeof *overlay);
    overlay->isotropic_share = law->isotropic_share;
    if (law->form == WB_LAW_LUDWIK) {
        ludwik_overlay(law, overlay);
        return;
    }
    if (law->is_combined) {
        overlay->isotropic_share = 0.0;
        overlay->kept = law->isotropic_share;
    }
    overlay->n = law->n_parts;
    for (int i = 0; i < law->n_parts; i++) {
        overlay->modulus[i] = law->parts[i].modulus;
        overlay->yield_strain[i] = law->parts[i].yield_strain;
    }
}

double wb_law_overlay_stress(const struct wb_overlay *overlay, double strain, double *tangent)
{
    double stress = 0.0, slope = 0.0;
    for (int i = 0; i < overlay->n; i++) {
        const double E = overlay->modulus[i], beyond = strain - overlay->yield_strain[i];
        const bool yields = beyond >= 0.0;
        stress += yields ? E * (overlay->yield_strain[i] + overlay->kept * beyond) : E * strain;
        slope += yields ? overlay->kept * E : E;
    }
    if (tangent)
        *tangent = slope;
    return stress;
}

/* Growth of the yield stress and back stresses together at plastic strain p of a first loading. */
static double chaboche_growth(const struct wb_law *law, double p, double *slope)
{
    double sum = -law->saturation * expm1(-law->rate * p);
    *slope = law->saturation * law->rate * exp(-law->rate * p);
    for (int i = 0; i < law->n_backs; i++) {
        const double C = law->backs[i].modulus, gamma = law->backs[i].recovery;
        sum += gamma > 0.0 ? -C / gamma * expm1(-gamma * p) : C * p;
        *slope += C * exp(-gamma * p);
    }
    return sum;
}

/* Newton's method on E (e - p) = sigma_Y + growth(p). growth() is concave in p, so the iteration
 * converges from below without overshoot. */
static double chaboche_stress(const struct wb_law *law, double strain, double *tangent)
{
    const double E = law->material.youngs_modulus, over = E * strain - law->material.yield_stress;
    double p = 0.0, slope = 0.0;
    if (over > 0.0) {
        for (int i = 0; i < 100; i++) {
            const double left = over - E * p - chaboche_growth(law, p, &slope);
            const double step = left / (E + slope);
            p += step;
            if (!(step > 1e-15 * p))
                break;
        }
        (void)chaboche_growth(law, p, &slope);
    }
    if (tangent)
        *tangent = over > 0.0 ? E * slope / (E + slope) : E;
    return E * (strain - p);
}

double wb_law_virgin_stress(const struct wb_law *law, double strain, double *tangent)
{
    if (law->form == WB_LAW_CHABOCHE)
        return chaboche_stress(law, strain, tangent);
    if (law->form == WB_LAW_PARALLEL) {
        struct wb_overlay overlay;
        wb_law_overlay(law, &overlay);
        return wb_law_overlay_stress(&overlay, strain, tangent);
    }
    const struct wb_material *const m = &law->material;
    const double E = m->youngs_modulus, overstress = E * strain - m->yield_stress;
    if (!(overstress > 0.0)) {
        if (tangent)
            *tangent = E;
        return E * strain;
    }
    const double r = wb_hardening_ratio(m, overstress);
    if (tangent) {
        const double power_part = wb_hardening_exponent(m, r * overstress / E) * (1.0 - r);
        *tangent = E * power_part / (r + power_part);
    }
    return m->yield_stress + (1.0 - r) * overstress;
}

struct wb_law_maxwell_step wb_law_maxwell_step(const struct wb_law_maxwell *element,
                                               double duration)
{
    const double x = duration / element->time;
    return (struct wb_law_maxwell_step){
        .decay = exp(-x),
        .tangent = isinf(x) ? 0.0 : element->modulus * (x > 0.0 ? -expm1(-x) / x : 1.0),
    };
}

const char *wb_law_form_name(enum wb_law_form form)
{
    static const char *const names[] = {"ludwik", "parallel", "chaboche"};
    return names[form];
}

const char *wb_law_form_words(enum wb_law_form form)
{
    static const char *const words[] = {"Ludwik's law", "law of parallel parts", "Chaboche's law"};
    return words[form];
}

bool wb_law_has_share(const struct wb_law *law)
{
    return law->form != WB_LAW_CHABOCHE &&
           (law->is_combined || (law->isotropic_share > 0.0 && law->isotropic_share < 1.0));
}

const char *wb_law_rule_name(const struct wb_law *law)
{
    return law->is_combined              ? "combined"
           : law->isotropic_share == 1.0 ? "isotropic"
           : law->isotropic_share == 0.0 ? "kinematic"
                                         : "mixed";
}

void wb_law_append_numbers(struct wb_text *text, const struct wb_law *law)
{
    const struct wb_material *const m = &law->material;
    if (law->form == WB_LAW_LUDWIK)
        wb_text_append(text, "E %.4g MPa, sigma_Y %.4g MPa, K %.4g MPa, n %.3g",
                       m->youngs_modulus / WB_MPA, m->yield_stress / WB_MPA,
                       m->strength_coefficient / WB_MPA, m->hardening_exponent);
    for (int i = 0; i < law->n_parts; i++)
        wb_text_append(text, "%s%.4g", i == 0 ? "moduli " : ", ", law->parts[i].modulus / WB_MPA);
    const char *before = " MPa, yielding at strains ";
    for (int i = 0; i < law->n_parts && isfinite(law->parts[i].yield_strain); i++) {
        wb_text_append(text, "%s%.2e", before, law->parts[i].yield_strain);
        before = ", ";
    }
    if (law->form == WB_LAW_CHABOCHE) {
        wb_text_append(text, "E %.4g MPa, sigma_Y %.4g MPa, Q %.4g MPa, b %.4g",
                       m->youngs_modulus / WB_MPA, m->yield_stress / WB_MPA,
                       law->saturation / WB_MPA, law->rate);
        for (int i = 0; i < law->n_backs; i++)
            wb_text_append(text, ", C%d %.4g MPa, gamma%d %.4g", i + 1,
                           law->backs[i].modulus / WB_MPA, i + 1, law->backs[i].recovery);
    }
    if (wb_law_has_share(law))
        wb_text_append(text, "; isotropic share %.3g", law->isotropic_share);
    if (law->n_maxwell > 0) {
        wb_text_append(text, "; ");
        wb_law_append_relaxation(text, law);
    }
}

void wb_law_append_relaxation(struct wb_text *text, const struct wb_law *law)
{
    for (int i = 0; i < law->n_maxwell; i++)
        wb_text_append(text, "%s%.4g MPa that relax over %.3g s", i > 0 ? ", " : "",
                       law->maxwell[i].modulus / WB_MPA, law->maxwell[i].time);
    if (law->n_maxwell > 0)
        wb_text_append(text, " (Maxwell); moments at %.2e 1/s of the outer fibre",
                       law->strain_rate);
}
