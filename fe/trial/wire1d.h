/* A wire model computed as a 1D rod in space with fibres: the counterpart of fe/trial/wire3d.h.
 *
 * Each part is a ring of fibres that carry axial stress and the shear stress of torsion, J2 with
 * the part's own law; parts are always bonded (a rod cannot represent an interface, see
 * docs/theory.md). Transverse shear is elastic.
 */
#ifndef WB_FE_TRIAL_WIRE1D_H
#define WB_FE_TRIAL_WIRE1D_H

#include "base/status.h"
#include "fe/model/wire_model.h"
#include "fe/trial/wire_run.h"

/* Increase whenever results for the same model change: older datasets are then outdated. */
enum {
    WB_WIRE1D_VERSION = 1
};

struct wb_wire1d; /* opaque */

struct wb_wire1d_settings {
    int n_elements; /* 0: 50 */
    int n_rings;    /* rings of fibres in each part; 0: 8 */
    int n_around;   /* fibres in a ring, a multiple of 4; 0: 24 */
};

/* `model` is borrowed; `settings` may be NULL. On failure *out is NULL. */
WB_MUST_CHECK enum wb_status wb_wire1d_create(struct wb_wire1d **out,
                                              const struct wb_wire_model *model,
                                              const struct wb_wire1d_settings *settings);
void wb_wire1d_destroy(struct wb_wire1d *wire); /* accepts NULL */

/* As wb_wire3d_run(). */
WB_MUST_CHECK enum wb_status wb_wire1d_run(struct wb_wire1d *wire, struct wb_wire_run *run,
                                           const struct wb_wire_observer *observer);

/* A fibre in the section nearest to arc length s, in the current state. */
struct wb_wire1d_fibre {
    double y, z;                       /* m, in the section */
    double inner_radius, outer_radius; /* of its cell, a sector of a ring, m */
    double begin_angle, end_angle;     /* rad, from y towards z */
    double axial, shear;               /* Pa; shear: of torsion */
    double plastic;                    /* equivalent plastic strain */
    int part;
};
struct wb_wire1d_fibre *wb_wire1d_section(const struct wb_wire1d *wire, double s, int *n);

/* Current position of the axis (m) at arc length s, and the section's frame as rows: unit vectors
 * along the wire, the section's y, its z. */
void wb_wire1d_frame(const struct wb_wire1d *wire, double s, double position[3],
                     double frame[3][3]);

#endif
