/* Definitions shared by the solvers and models of a bending test: loads of the tip, phases of a
 * loading, integration of hexahedra, contact between jacket and core.
 */
#ifndef WB_FE_LINEAR_TRIAL_H
#define WB_FE_LINEAR_TRIAL_H

/* Loads at the tip. Global axes: x along the straight wire, y up. */
struct wb_tip_loads {
    double force[3];    /* N, dead */
    double moment[3];   /* N m, dead axes */
    double follower[3]; /* N, in the frame of the tip's section: along the wire, its y, its z */
};

/* Loads between two: exactly `from` at fraction 0 and `to` at 1. */
struct wb_tip_loads wb_trial_loads_between(const struct wb_tip_loads *from,
                                           const struct wb_tip_loads *to, double fraction);

/* Phase of a row of a test. */
enum wb_phase {
    WB_PHASE_LOAD,
    WB_PHASE_UNLOAD,
    WB_PHASE_SLACK /* the strand carries no force; such rows are excluded from fits */
};

/* "load", "unload" or "slack". */
const char *wb_trial_phase_name(enum wb_phase phase);

/* Integration points of a 20-node hexahedron. */
enum wb_integration {
    WB_INTEGRATION_SELECTIVE, /* volumetric part 2 x 2 x 2, deviatoric part 3 x 3 x 3 */
    WB_INTEGRATION_REDUCED    /* both 2 x 2 x 2 */
};

/* Contact with Coulomb friction between a core and its jacket; penalty method, normal and
 * tangential. */
struct wb_jacket_contact_law {
    double normal_stiffness;     /* Pa/m */
    double tangential_stiffness; /* Pa/m, of sticking */
    double friction;             /* mu, 1 */
};

/* Default stiffnesses for a jacket of a given material and thickness (m). Normal: that of the
 * jacket layer pressed between plates, M / thickness with M = E (1 - nu) / ((1 + nu) (1 - 2 nu)).
 * The penetration is then the layer's own compression, p / M of its thickness (1 % at 1 MPa for a
 * PVC jacket, whose pressures are about 0.1 MPa). With higher stiffness Newton's method alternates
 * between points that open and close. Tangential: a third of it; a point then moves by 3 mu times
 * its penetration before it slips. */
void wb_trial_default_jacket_contact(struct wb_jacket_contact_law *law, double youngs_modulus,
                                     double poissons_ratio, double thickness, double friction);

#endif
