#include "fe/rod/section.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "base/memory.h"
#include "fe/material/hardening.h"
#include "fe/rod/ring.h"

#define WB_LOG_DOMAIN "section"

enum {
    DEFAULT_FIBRES = 20,
    MAX_FIBRES = 4096
};

enum wb_status wb_section_check_material(const struct wb_material *m)
{
    if (!(isfinite(m->youngs_modulus) && m->youngs_modulus > 0.0))
        return wb_fail(WB_ERR_ARGUMENT, "youngs_modulus %g Pa: expected a number above 0",
                       m->youngs_modulus);
    if (!(m->poissons_ratio > -1.0 && m->poissons_ratio <= 0.5))
        return wb_fail(WB_ERR_ARGUMENT, "poissons_ratio %g: expected -1 to 0.5", m->poissons_ratio);
    char why[120];
    if (!wb_hardening_is_possible(m, why, sizeof why))
        return wb_fail(WB_ERR_ARGUMENT, "%s", why);
    return WB_OK;
}

double wb_section_shear_modulus(const struct wb_material *material)
{
    /* Cowper's factor of the solid circle, 6 (1 + nu) / (7 + 6 nu), times G = E / 2 (1 + nu). */
    const double nu = material->poissons_ratio;
    return 3.0 * material->youngs_modulus / (7.0 + 6.0 * nu);
}

/* Adds n fibres and one material to the section; the caller fills in the fibres. */
static struct wb_fibre *grow(struct wb_section *section, const struct wb_material *material, int n)
{
    section->fibres =
        wb_memory_resize(section->fibres, (size_t)(section->n_fibres + n), sizeof *section->fibres);
    section->materials = wb_memory_resize(section->materials, (size_t)section->n_materials + 1,
                                          sizeof *section->materials);
    section->materials[section->n_materials++] = *material;
    section->n_fibres += n;
    return section->fibres + section->n_fibres - n;
}

/* Gauss-Chebyshev strips of the solid circle of radius R. */
static void fill_circle(struct wb_fibre *fibres, int n, double R)
{
    for (int i = 0; i < n; i++) {
        const double t = M_PI * (i + 1) / (n + 1);
        fibres[i].y = R * cos(t);
        fibres[i].area = 2.0 * R * R * sin(t) * sin(t) * M_PI / (n + 1);
    }
    /* The rule is symmetric; make the numbers symmetric too, or round-off bends a straight wire. */
    for (int i = 0; i < n / 2; i++) {
        fibres[n - 1 - i].y = -fibres[i].y;
        fibres[n - 1 - i].area = fibres[i].area;
    }
    if (n % 2 == 1)
        fibres[n / 2].y = 0.0;
}

/* Area and second moment of the part of a disc of radius R between y = 0 and y = h. */
static void disc_part(double R, double h, double *area, double *second_moment)
{
    if (R <= 0.0) {
        *area = 0.0;
        *second_moment = 0.0;
        return;
    }
    const double a = asin(fmin(h / R, 1.0));
    *area = R * R * (a + 0.5 * sin(2.0 * a));
    *second_moment = R * R * R * R * (0.25 * a - sin(4.0 * a) / 16.0);
}

/* Strips of a ring between equal angles over the outer diameter, n even. Each strip has its exact
 * area and lies at its radius of gyration, so the ring's area and second moment are exact. */
static void fill_ring(struct wb_fibre *fibres, int n, double Ri, double Ro)
{
    const int half = n / 2;
    double area = 0.0, second_moment = 0.0;

    for (int i = 0; i < half; i++) {
        const double top = i + 1 == half ? Ro : Ro * sin(0.5 * M_PI * (i + 1) / half);
        double outer_area, outer_moment, inner_area, inner_moment;
        disc_part(Ro, top, &outer_area, &outer_moment);
        disc_part(Ri, fmin(top, Ri), &inner_area, &inner_moment);

        const double strip = outer_area - inner_area - area;
        const double strip_moment = outer_moment - inner_moment - second_moment;
        area += strip;
        second_moment += strip_moment;
        fibres[half - 1 - i].y = sqrt(strip_moment / strip);
        fibres[half - 1 - i].area = strip;
        fibres[half + i].y = -fibres[half - 1 - i].y;
        fibres[half + i].area = strip;
    }
}

void wb_section_init_empty(struct wb_section *section)
{
    *section = (struct wb_section){0};
}

enum wb_status wb_section_add_ring(struct wb_section *section, double inner_diameter,
                                   double outer_diameter, const struct wb_material *material,
                                   double area_fraction, int n)
{
    if (!(isfinite(outer_diameter) && inner_diameter >= 0.0 && outer_diameter > inner_diameter))
        return wb_fail(WB_ERR_ARGUMENT,
                       "ring from %g to %g m: expected 0 <= inner < outer diameter", inner_diameter,
                       outer_diameter);
    if (!(area_fraction > 0.0 && area_fraction <= 1.0))
        return wb_fail(WB_ERR_ARGUMENT, "area fraction %g: expected above 0, at most 1",
                       area_fraction);
    if (n < 0 || n > MAX_FIBRES)
        return wb_fail(WB_ERR_ARGUMENT, "%d fibres: expected 0 to %d", n, MAX_FIBRES);
    WB_TRY(wb_section_check_material(material));

    int count = n == 0 ? DEFAULT_FIBRES : n;
    const bool ring = inner_diameter > 0.0;
    if (ring && count % 2 == 1)
        count++;

    const int index = section->n_materials;
    struct wb_fibre *const fibres = grow(section, material, count);
    if (ring)
        fill_ring(fibres, count, 0.5 * inner_diameter, 0.5 * outer_diameter);
    else
        fill_circle(fibres, count, 0.5 * outer_diameter);

    double area = 0.0;
    for (int i = 0; i < count; i++) {
        fibres[i].z = 0.0;
        fibres[i].material = index;
        fibres[i].area *= area_fraction;
        area += fibres[i].area;
    }
    section->shear_stiffness += wb_section_shear_modulus(material) * area;
    return WB_OK;
}

enum wb_status wb_section_init_circle(struct wb_section *section, double diameter,
                                      const struct wb_material *material, int n)
{
    wb_section_init_empty(section);
    return wb_section_add_ring(section, 0.0, diameter, material, 1.0, n);
}

static void add_law(struct wb_section *section, const struct wb_law *law)
{
    section->law = wb_memory_new(1, sizeof *section->law);
    *section->law = *law;
}

enum wb_status wb_section_init_law(struct wb_section *section, double diameter,
                                   const struct wb_law *law, int n)
{
    wb_section_init_empty(section);
    WB_TRY(wb_law_check(law, NULL));
    WB_TRY(wb_section_init_circle(section, diameter, &law->material, n));
    add_law(section, law);
    return WB_OK;
}

enum wb_status wb_section_init_law_in_space(struct wb_section *section, double diameter,
                                            const struct wb_law *law, int n_rings, int n_around)
{
    double point[WB_RING_MOST], weight[WB_RING_MOST];
    const double R = 0.5 * diameter;

    wb_section_init_empty(section);
    WB_TRY(wb_law_check(law, NULL));
    WB_TRY(wb_section_check_material(&law->material));
    if (!(isfinite(diameter) && diameter > 0.0))
        return wb_fail(WB_ERR_ARGUMENT, "diameter %g m: expected a number above 0", diameter);
    WB_TRY(wb_ring_check(n_rings, n_around));

    struct wb_fibre *fibre = grow(section, &law->material, n_rings * n_around);
    wb_ring_rule(n_rings, point, weight);
    for (int ring = 0; ring < n_rings; ring++) {
        for (int i = 0; i < n_around; i++, fibre++) {
            double c, s;
            wb_ring_direction(i, n_around, ring % 2 == 1, &c, &s);
            fibre->y = R * sqrt(point[ring]) * c;
            fibre->z = R * sqrt(point[ring]) * s;
            fibre->area = M_PI * R * R * weight[ring] / n_around;
            fibre->material = 0;
        }
    }
    section->shear_stiffness = wb_section_shear_modulus(&law->material) * M_PI * R * R;
    add_law(section, law);
    return WB_OK;
}

void wb_section_release(struct wb_section *section)
{
    if (!section)
        return;
    free(section->fibres);
    free(section->materials);
    free(section->law);
    *section = (struct wb_section){0};
}
