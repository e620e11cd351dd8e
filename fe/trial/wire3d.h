/* A wire model computed as a 3D solid: meshes it and moves the solver through the model's loading
 * steps.
 */
#ifndef WB_FE_TRIAL_WIRE3D_H
#define WB_FE_TRIAL_WIRE3D_H

#include "base/status.h"
#include "fe/model/wire_model.h"
#include "fe/solid/solid_mesh.h"
#include "fe/trial/wire_run.h"

/* Increase whenever results for the same model change: older datasets are then outdated. */
enum {
    WB_WIRE3D_VERSION = 1
};

struct wb_wire3d; /* opaque */

/* Nodal stresses of the current state, stored by element, because at an interface each part has its
 * own values. */
struct wb_wire3d_fields {
    double (*position)[3];   /* (n_nodes), m, deformed */
    double (*stress)[20][6]; /* (n_elements), Pa, Cauchy, global frame: xx, yy, zz, xy, yz, zx;
                                averaged at each node over the elements of a part */
    double (*plastic)[20];   /* (n_elements), equivalent plastic strain, averaged in the same way */
};

/* `model` is borrowed and must outlive the wire. On failure *out is NULL. */
WB_MUST_CHECK enum wb_status wb_wire3d_create(struct wb_wire3d **out,
                                              const struct wb_wire_model *model);
void wb_wire3d_destroy(struct wb_wire3d *wire); /* accepts NULL */

/* Runs the loading steps from the virgin state; `run` was allocated by wb_wire_run_init(). Not
 * converging is a result, not an error: completed rows stay in the run. */
WB_MUST_CHECK enum wb_status wb_wire3d_run(struct wb_wire3d *wire, struct wb_wire_run *run,
                                           const struct wb_wire_observer *observer);

const struct wb_solid_mesh *wb_wire3d_mesh(const struct wb_wire3d *wire);

/* Fields of the current state, allocated; wb_wire3d_fields_release() accepts a zeroed struct. */
void wb_wire3d_fields(const struct wb_wire3d *wire, struct wb_wire3d_fields *fields);
void wb_wire3d_fields_release(struct wb_wire3d_fields *fields);

/* Of the last converged state: largest penetration, opening and accumulated slip of the interface
 * (m), zero when bonded; work of the loads, stored elastic and dissipated energy (J). Of the whole
 * run: largest sliding distance between opposite points of the interface. For reports and tests. */
struct wb_wire3d_balance {
    double penetration, opening, slip;          /* m */
    double sliding, slip_limit;                 /* m; small sliding is invalid above the limit */
    double work, elastic, dissipated, friction; /* J */
};
void wb_wire3d_balance(const struct wb_wire3d *wire, struct wb_wire3d_balance *balance);

#endif
