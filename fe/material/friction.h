/* Coulomb friction whose coefficient falls with the slip rate v, eq. 20 of the paper:
 *
 *     mu = mu_k + (mu_s - mu_k) exp(-decay v)
 */
#ifndef WB_FE_MATERIAL_FRICTION_H
#define WB_FE_MATERIAL_FRICTION_H

struct wb_friction {
    double mu_static;  /* mu_s */
    double mu_kinetic; /* mu_k */
    double decay;      /* s/m; 0: mu_s at any rate. 1 s/mm is 1000 s/m */
};

#endif
