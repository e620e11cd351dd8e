/* The law of a homogenised wire under bending: a virgin stress-strain curve and a hardening rule.
 *
 * Three forms of the curve, stress F(e) over total strain e >= 0:
 *   - Ludwik's, the paper's eqs. 1 to 6: F = E e up to sigma_Y, then sigma_Y + K ep^n;
 *   - parallel parts (Prandtl-Ishlinskii; Besseling's overlay): elastic-plastic parts that share
 *     the strain, F = sum_i E_i min(e, e_i), of which the last may stay elastic (e_i infinite);
 * with combined hardening F = sum_i E_i (min(e, e_i) + beta max(e - e_i, 0));
 *   - Chaboche's, with saturating back stresses and Voce's growth of the yield stress: F = E e up
 *     to sigma_Y, then sigma_Y + Q (1 - exp(-b ep)) + sum_i C_i / gamma_i (1 - exp(-gamma_i ep)).
 *
 * The rule says what happens when the strain turns back. With isotropic hardening the wire yields
 * again at the stress that it reached, in either direction. With kinematic hardening it yields
 * earlier: every branch is the virgin curve at twice the size (Masing's rule), it returns to the
 * point of its turn, and a closed loop is forgotten from there on. Two rules lie between, with a
 * share beta, `isotropic_share`, that does not affect the virgin curve, except in combined
 * hardening of parallel parts:
 *   - mixed: a share beta of the area hardens isotropically, the rest kinematically;
 *   - combined (Hodge 1957; Simo and Hughes, Computational Inelasticity, box 3.2): one yield
 *     surface grows by beta H(p) and moves by (1 - beta) dH, with H = K p^n of the accumulated
 *     plastic strain p. Of Ludwik's form; 1 is isotropic hardening, and 0 not Masing's rule. Of
 *     parallel parts each has a surface of its own that grows: after yielding the part hardens
 *     isotropically with the tangent modulus beta E_i; 0 is kinematic hardening.
 * Chaboche's form (Lemaitre and Chaboche, Mechanics of Solid Materials, 5.4) has its own:
 *
 *     |stress - sum X_i| = sigma_Y + R,  dR = b (Q - R) dp,  dX_i = C_i dep - gamma_i X_i dp.
 *
 * A law of any form may have Maxwell elements in parallel: a part of the wire that relaxes, whose
 * stress depends on time. The moduli above, and the curve F, are of the relaxed law, which an
 * infinitely slow test measures.
 *
 * An overlay is what a section computes with in kinematic and mixed hardening. Ludwik's curve
 * becomes an overlay of WB_LAW_LUDWIK_PARTS parts, a chain of chords that follows the curve in the
 * mean. Parallel parts are an overlay as they are, with any rule. The other rules need none: a step
 * of them is computed exactly.
 */
#ifndef WB_FE_MATERIAL_LAW_H
#define WB_FE_MATERIAL_LAW_H

#include <stdbool.h>

#include "base/reason.h"
#include "base/status.h"
#include "base/text.h"
#include "fe/material/material.h"

enum wb_law_form {
    WB_LAW_LUDWIK,
    WB_LAW_PARALLEL,
    WB_LAW_CHABOCHE
};

enum {
    WB_LAW_MOST_PARTS = 12,   /* of a wire's file */
    WB_LAW_MOST_BACKS = 3,    /* back stresses */
    WB_LAW_MOST_MAXWELL = 2,  /* Maxwell elements */
    WB_LAW_LUDWIK_PARTS = 27, /* of Ludwik's curve; the last is elastic */
    WB_OVERLAY_MOST_PARTS = 28
};

struct wb_law_part {
    double modulus;      /* E_i, Pa, at least 0 */
    double yield_strain; /* e_i, 1, ascending; INFINITY: elastic, only the last */
};

struct wb_law_back {
    double modulus;  /* C_i, Pa, above 0 */
    double recovery; /* gamma_i, 1, at least 0; 0: Prager's, which does not saturate */
};

/* A Maxwell element: stress' = modulus strain' - stress / time. */
struct wb_law_maxwell {
    double modulus; /* Pa, at least 0 */
    double time;    /* s, above 0 */
};

struct wb_law {
    enum wb_law_form form;
    double isotropic_share;      /* beta, 0 (kinematic) to 1 (isotropic); of Chaboche's Q over all
                                    that it may harden by */
    bool is_combined;            /* beta is of the hardening stress, or of a yielded part's modulus;
                                    else of the area */
    struct wb_material material; /* Ludwik: isotropic power law; parallel parts: elastic, with E the
                                    sum of their moduli; Chaboche: elastic, with sigma_Y */
    int n_parts;                 /* of parallel parts */
    struct wb_law_part parts[WB_LAW_MOST_PARTS];
    double saturation, rate; /* Q, Pa, and b, 1, at least 0: of Chaboche's yield stress */
    int n_backs;
    struct wb_law_back backs[WB_LAW_MOST_BACKS];
    int n_maxwell;
    struct wb_law_maxwell maxwell[WB_LAW_MOST_MAXWELL];
    double strain_rate; /* 1/s, of the outer fibre in the tests that the Maxwell elements are from:
                           bending moments are stated at it; 0: of the relaxed law */
};

/* Parallel parts as a section computes with them. */
struct wb_overlay {
    int n;
    double isotropic_share;
    double kept;                                /* tangent modulus of a yielded part over its
                                                   modulus, below 1; the part's limit grows by it */
    double modulus[WB_OVERLAY_MOST_PARTS];      /* Pa */
    double yield_strain[WB_OVERLAY_MOST_PARTS]; /* 1, ascending */
};

/* Ludwik's law with isotropic hardening: the paper's. */
void wb_law_init_ludwik(struct wb_law *law, const struct wb_material *material);

/* Parallel parts; E becomes the sum of the moduli. */
void wb_law_init_parallel(struct wb_law *law, const struct wb_law_part *parts, int n,
                          double isotropic_share, double poissons_ratio);

/* Chaboche's law; of `material` E, Poisson's ratio and the yield stress count. */
void wb_law_init_chaboche(struct wb_law *law, const struct wb_material *material, double saturation,
                          double rate, const struct wb_law_back *backs, int n_backs);

/* Whether the law is Ludwik's with isotropic hardening and has no other parameters than its
 * material. */
bool wb_law_is_plain(const struct wb_law *law);

/* Whether the law is computed as an overlay: parallel parts, and Ludwik's law with kinematic or
 * mixed hardening. */
bool wb_law_is_overlay(const struct wb_law *law);

/* WB_ERR_ARGUMENT for invalid parameters; also for Ludwik's law with n above 1 and a kinematic
 * share: its curve steepens beyond the yield point, and its parts would release plastic work. `why`
 * receives the reason; NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_law_check(const struct wb_law *law, struct wb_reason *why);

/* The overlay of a law that passes wb_law_check() and wb_law_is_overlay(). Ludwik's overlay ends at
 * the larger of a strain of 0.1 and 50 times the yield strain; beyond it the stress continues with
 * the last slope. */
void wb_law_overlay(const struct wb_law *law, struct wb_overlay *overlay);

/* F(e) of the law, Pa, at a strain e >= 0; *tangent (Pa, may be NULL) is its slope. Exact. */
double wb_law_virgin_stress(const struct wb_law *law, double strain, double *tangent);

/* Tangent and decay of a Maxwell element over a step of `duration` s (0: sudden; infinite: slow) at
 * a constant strain rate: stress = decay * stress before + tangent * change of the strain. */
struct wb_law_maxwell_step {
    double decay;   /* 1 */
    double tangent; /* Pa */
};
struct wb_law_maxwell_step wb_law_maxwell_step(const struct wb_law_maxwell *element,
                                               double duration);

/* "ludwik", "parallel" or "chaboche", as in files; "Ludwik's law", "law of parallel parts" or
 * "Chaboche's law"; "isotropic", "kinematic", "mixed" or "combined". */
const char *wb_law_form_name(enum wb_law_form form);
const char *wb_law_form_words(enum wb_law_form form);
const char *wb_law_rule_name(const struct wb_law *law);

/* Whether its rule has an isotropic share: mixed, or combined except for Chaboche's law. */
bool wb_law_has_share(const struct wb_law *law);

/* Appends the law's parameters as one line of text: "E 4527 MPa, sigma_Y 4.52 MPa, K 1325 MPa, n
 * 0.9", or the parts' moduli and yield strains, or Chaboche's parameters; the isotropic share of a
 * mixed or combined rule; and the Maxwell elements. */
void wb_law_append_numbers(struct wb_text *text, const struct wb_law *law);
/* Appends the Maxwell elements alone, nothing if there are none: "120 MPa that relax over 15 s
 * (Maxwell); moments at 3.00e-04 1/s of the outer fibre". */
void wb_law_append_relaxation(struct wb_text *text, const struct wb_law *law);

#endif
