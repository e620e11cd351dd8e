/* Energies of a rod and of its section, from strains, stresses and histories. */
#ifndef WB_TESTS_FE_ROD_ROD_ENERGY_H
#define WB_TESTS_FE_ROD_ROD_ENERGY_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fe/material/hardening.h"
#include "fe/rod/rod_private.h"
#include "tests/check.h"

/* Per length of rod for a step from `before` to `after`, J/m: elastic energy stored at its end
 * (including back stresses) and plastic work dissipated in it, q times the increment of equivalent
 * plastic strain. `materials` are those of the section's parts. */
static inline void test_section_energy(const struct wb_rod_section *section,
                                       const struct wb_material *materials, const double *strain,
                                       const double *before, const double *after, double *stored,
                                       double *dissipated)
{
    *stored = *dissipated = 0.0;
    for (int i = 0; i < wb_rod_section_fibres(section); i++) {
        struct wb_rod_section_fibre f;
        double s, t, was, is;
        wb_rod_section_fibre(section, i, &f);
        wb_rod_section_stress(section, i, strain, before, &s, &t, &was);
        wb_rod_section_stress(section, i, strain, after, &s, &t, &is);
        const struct wb_material *const m = &materials[f.part];
        const double E = m->youngs_modulus, G = wb_material_shear_modulus(m);
        const double plastic = strain[0] + f.z * strain[2] - f.y * strain[3] - s / E;
        const double shear = hypot(f.y, f.z) * strain[1] - t / G;
        const double back =
            wb_hardening_back_modulus(m) * (plastic * plastic + shear * shear / 3.0);
        const double yield =
            wb_hardening_law(m)->growth ? wb_material_flow_stress(m, is) : m->yield_stress;
        *stored += 0.5 * f.area * (s * s / E + t * t / G + back);
        *dissipated += f.area * yield * (is - was);
    }
}

/* The energies of a rod, J: `stored` of its last equilibrium, `dissipated` since the virgin
 * state. */
struct test_rod_energy {
    const struct wb_rod *rod;
    const struct wb_rod_section *section;
    const struct wb_material *materials;
    double element_length;
    int n_points;
    double *history; /* (n_points x history size) of the last increment, owned */
    double stored, dissipated;
};

static inline struct test_rod_energy test_rod_energy_make(const struct wb_rod *rod,
                                                          const struct wb_rod_section *section,
                                                          const struct wb_material *materials,
                                                          double length, int n_elements)
{
    const size_t n = 2 * (size_t)n_elements * wb_rod_section_history_size(section);
    const struct test_rod_energy energy = {
        .rod = rod,
        .section = section,
        .materials = materials,
        .element_length = length / n_elements,
        .n_points = 2 * n_elements,
        .history = calloc(n, sizeof *energy.history),
    };
    assert_non_null(energy.history);
    return energy;
}

/* Adds an increment that was just accepted. */
static inline void test_rod_energy_add(struct test_rod_energy *energy)
{
    const size_t row = wb_rod_section_history_size(energy->section);
    const double weight = 0.5 * energy->element_length;
    energy->stored = 0.0;
    for (int g = 0; g < energy->n_points; g++) {
        const struct wb_rod_point *const p = wb_rod_point(energy->rod, g);
        double *const before = energy->history + (size_t)g * row;
        double s, strain[WB_ROD_SECTION_STRAINS], stored, dissipated, shear = 0.0;
        const double *history;
        wb_rod_point_state(energy->rod, g, &s, strain, &history);
        test_section_energy(energy->section, energy->materials, strain, before, history, &stored,
                            &dissipated);
        for (int k = 1; k < 3; k++) {
            const double force = p->R[k] * p->n[0] + p->R[3 + k] * p->n[1] + p->R[6 + k] * p->n[2];
            shear += force * force / p->shear_stiffness;
        }
        energy->stored += weight * (stored + 0.5 * shear);
        energy->dissipated += weight * dissipated;
        memcpy(before, history, row * sizeof *before);
    }
}

#endif
