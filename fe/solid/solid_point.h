/* Material point of a solid at finite strain: additive J2 plasticity in logarithmic strain space.
 *
 * With F = I + H (H the displacement gradient), C = F^T F = sum c_i N_i N_i, E = 1/2 ln C:
 *
 *     energy = kappa / 2 (ln J)^2 + mu |dev E - Ep|^2  (+ K / 3 |Ep|^2, kinematic hardening)
 *     T = 2 mu (dev E - Ep),  sqrt(3/2) |T - X| <= sigma_Y + K p^n  (X = 2/3 K Ep, kinematic)
 *
 * The return mapping in T and E is that of small strains. The Kirchhoff stress tau and the spatial
 * tangent c follow from T in the eigenvectors n_i = F N_i / lambda_i (see solid_point.c). Strains
 * keep their relative precision down to 1e-15, because only H is used. Source: C. Miehe, N. Apel,
 * M. Lambrecht, CMAME 191 (2002) 5383.
 *
 * Symmetric tensors are xx, yy, zz, xy, yz, zx; the tangent acts on (d_xx, d_yy, d_zz, 2 d_xy, 2
 * d_yz, 2 d_zx). The second variation of the energy is d:c:d + tau:(grad v^T grad v).
 */
#ifndef WB_FE_SOLID_SOLID_POINT_H
#define WB_FE_SOLID_SOLID_POINT_H

#include <stdbool.h>

#include "fe/material/material.h"

/* History of a material point; all zero is virgin. Symmetric tensors here are xx, yy, zz, xy, yz,
 * zx, tensor (not engineering) components. */
struct wb_solid_point_state {
    double plastic_strain[6]; /* logarithmic, deviatoric, in the reference frame */
    double accumulated;       /* equivalent plastic strain, monotonic */
};

/* Data shared by the points of one material. */
struct wb_solid_point_law {
    double shear_modulus, bulk_modulus; /* mu, kappa, Pa */
    struct wb_material radial; /* the material with 3 mu in place of E: fe/material/hardening.h then
                                  solves for q and p */
};

/* Three unit vectors, in rows. */
struct wb_solid_point_basis {
    double row[3][3];
};

/* C = sum (1 + excess_i) N_i N_i. */
struct wb_solid_point_spectrum {
    double excess[3];
    double stretch[3];                   /* lambda_i */
    double log_stretch[3];               /* ln lambda_i */
    struct wb_solid_point_basis vectors; /* N_i */
};

struct wb_solid_point_motion {
    double gradient[3][3]; /* H_iJ = du_i / dX_J */
    double inverse[3][3];  /* of F: dX_J / dx_i at [J][i] */
    double jacobian;       /* J */
    double log_jacobian;   /* ln J */
    struct wb_solid_point_spectrum spectrum;
};

struct wb_solid_point_response {
    double stress[6];     /* Kirchhoff, Pa */
    double tangent[6][6]; /* Pa; symmetric */
    double energy;        /* stored energy, J/m3 of reference volume */
    double dissipated;    /* J/m3, in this step */
    bool yields;
};

/* The cofactors of a 3 x 3 matrix; returns its determinant. */
double wb_solid_point_cofactors(const double matrix[3][3], double cofactor[3][3]);

void wb_solid_point_law_init(struct wb_solid_point_law *law, const struct wb_material *material);

/* Computes the motion, except for the spectrum, from the displacement gradient (row by row). False
 * if J is not positive and finite. */
bool wb_solid_point_motion_init(struct wb_solid_point_motion *motion, const double gradient[9]);

/* Spectra of n points; vectorised for eight points at once. */
void wb_solid_point_diagonalise(struct wb_solid_point_motion *motion, int n);

/* Adds the volumetric part to a response; the tangent only if `tangent`. */
void wb_solid_point_add_volumetric(const struct wb_solid_point_law *law,
                                   const struct wb_solid_point_motion *motion, bool tangent,
                                   struct wb_solid_point_response *response);

/* Adds the deviatoric part from the history `before`, with the motion's spectrum; `after` (may
 * alias `before`) receives the history at the end of the step. */
void wb_solid_point_deviatoric(const struct wb_solid_point_law *law,
                               const struct wb_solid_point_motion *motion,
                               const struct wb_solid_point_state *before,
                               struct wb_solid_point_state *after, bool tangent,
                               struct wb_solid_point_response *response);

#endif
