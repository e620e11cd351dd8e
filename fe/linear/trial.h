/* What the solvers and the models of a bending test have in common: loads of the tip, phases of a
 * loading, how hexahedra are integrated, how a jacket rests on its core.
 */
#ifndef WB_FE_LINEAR_TRIAL_H
#define WB_FE_LINEAR_TRIAL_H

/* Loads at the tip. Global axes: x along the straight wire, y up. */
struct wb_tip_loads {
    double force[3];    /* N, dead */
    double moment[3];   /* N m, dead axes */
    double follower[3]; /* N, in the frame of the tip's section: along the wire, its y, its z */
};

/* What a row of a test belongs to. */
enum wb_phase {
    WB_PHASE_LOAD,
    WB_PHASE_UNLOAD,
    WB_PHASE_SLACK /* the strand carries nothing; such rows are left out of every fit */
};

/* "load", "unload" or "slack". */
const char *wb_trial_phase_name(enum wb_phase phase);

/* Integration points of a hexahedron of 20 nodes. */
enum wb_integration {
    WB_INTEGRATION_SELECTIVE, /* volumetric part 2 x 2 x 2, deviatoric part 3 x 3 x 3 */
    WB_INTEGRATION_REDUCED    /* both 2 x 2 x 2 */
};

/* Contact with Coulomb friction between a core and its jacket, both parts by penalty. */
struct wb_jacket_contact_law {
    double normal_stiffness;     /* Pa/m */
    double tangential_stiffness; /* Pa/m, of sticking */
    double friction;             /* mu, 1 */
};

/* Stiffnesses for a jacket of such a material and thickness (m). Normal: that of this layer when it
 * is pressed between plates, M / thickness with M = E (1 - nu) / ((1 + nu) (1 - 2 nu)); the
 * penetration is then what the layer itself is squeezed by, p / M of its thickness (1 % at 1 MPa
 * for a jacket of PVC, whose pressures are a tenth of that). With stiffer ones Newton's method
 * wanders among points that open and close. Tangential: a third of it; before it slips, a point
 * moves by 3 mu times its penetration. */
void wb_trial_default_jacket_contact(struct wb_jacket_contact_law *law, double youngs_modulus,
                                     double poissons_ratio, double thickness, double friction);

#endif
