/* An elastoplastic material, and the stress of one of its points under an axial strain.
 *
 * The paper's law (eqs. 1-6, corrected: eq. 6 is Ludwik's form, of the plastic strain only) is
 *     |sigma| = sigma_Y + K ep^n   while yielding, with J2 flow and isotropic hardening.
 * Linear kinematic hardening (Prager) with modulus K is there for wires richer than that model.
 * What the laws are made of is in fe/material/hardening.h.
 */
#ifndef WB_FE_MATERIAL_MATERIAL_H
#define WB_FE_MATERIAL_MATERIAL_H

enum wb_hardening {
    WB_HARDENING_NONE_ELASTIC,    /* linear elastic, never yields */
    WB_HARDENING_ISOTROPIC_POWER, /* sigma_Y + K ep^n; K = 0 is perfectly plastic */
    WB_HARDENING_KINEMATIC_LINEAR /* back stress moves by K d(ep); n is not used */
};

struct wb_material {
    enum wb_hardening hardening;
    double youngs_modulus;       /* E, Pa, > 0 */
    double poissons_ratio;       /* 1; beams use it for their shear stiffness only */
    double yield_stress;         /* sigma_Y, Pa, > 0 unless elastic */
    double strength_coefficient; /* K, Pa, >= 0 */
    double hardening_exponent;   /* n, > 0, at most 2 */
};

/* History of one material point. All zero is the virgin state. */
struct wb_material_state {
    double plastic_strain;             /* signed */
    double accumulated_plastic_strain; /* ep, never decreases */
    double back_stress;                /* Pa */
};

/* G = E / (2 (1 + nu)), Pa. */
double wb_material_shear_modulus(const struct wb_material *material);

/* Von Mises stress of three normal and then three shear stresses. */
double wb_material_von_mises(const double stress[6]);

/* The largest von Mises stress (Pa) at an accumulated plastic strain: sigma_Y + K p^n. Infinite
 * without a bound: elastic, and kinematic hardening, whose surface moves. */
double wb_material_flow_stress(const struct wb_material *material, double plastic_strain);

#endif
