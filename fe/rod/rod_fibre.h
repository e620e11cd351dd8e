/* The material point of a rod's fibre: axial stress s and shear stress t of torsion, all other
 * components zero. J2 plasticity, q = sqrt(s^2 + 3 t^2), with the laws of fe/material/material.h:
 *
 *     isotropic   q = sigma_Y + K p^n,
 *     kinematic   q = sigma_Y for the stresses less their back stresses K e_p and K g_p / 3
 *                 (Prager's tensor back stress in this plane).
 *
 * Backward Euler from the trial stresses (s*, t*) with increment l of equivalent plastic strain:
 *
 *     s = s* q / A,  t = t* q / B,  A = q + E l,  B = q + 3 G l  (kinematic: E + K, 3 G + K),
 *     (s* / A)^2 + 3 (t* / B)^2 = 1,
 *
 * one equation for one unknown. With isotropic hardening that unknown is the overstress c of
 * fe/material/hardening.h: p and q then follow from the tabulated r(c) without computing a power, A
 * = c + sigma_Y - E p_0 is linear, and for t* = 0 no iteration is needed. Source: J. C. Simo, T. J.
 * R. Hughes, Computational Inelasticity, chapter 3 (the same for plane stress).
 */
#ifndef WB_FE_ROD_ROD_FIBRE_H
#define WB_FE_ROD_ROD_FIBRE_H

#include <stdbool.h>

#include "fe/material/hardening.h"
#include "fe/material/material.h"

/* History; `yield` starts at the yield stress, the others at zero. */
struct wb_rod_fibre_state {
    double plastic;       /* axial plastic strain */
    double plastic_shear; /* plastic shear angle */
    double accumulated;   /* equivalent plastic strain, monotonic */
    double yield;         /* q of the yield surface after isotropic growth, Pa */
};

struct wb_rod_fibre_response {
    double axial, shear;  /* Pa */
    double D11, D12, D22; /* d(axial, shear) / d(strain, angle), symmetric, Pa */
    bool yields;
};

/* A material made ready. */
struct wb_rod_fibre_law {
    struct wb_material material;
    const struct wb_hardening_law *hardening;
    const struct wb_hardening_table *table; /* of an isotropic material, borrowed */
    double shear_modulus;                   /* E / 2 (1 + nu), Pa */
    double back;                            /* K of kinematic hardening, Pa; otherwise 0 */
    double per_E, per_yield;                /* 1 / E, 1 / sigma_Y, 1/Pa */
};

void wb_rod_fibre_law_init(struct wb_rod_fibre_law *law, const struct wb_material *material,
                           const struct wb_hardening_table *table);

/* Response to axial strain and shear angle from the history `before` (may be `after`). No side
 * effects. */
void wb_rod_fibre_respond(const struct wb_rod_fibre_law *law, const double strain[2],
                          const struct wb_rod_fibre_state *before, struct wb_rod_fibre_state *after,
                          struct wb_rod_fibre_response *response);

#endif
