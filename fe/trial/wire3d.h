/* A wire model computed as a 3D solid: makes the mesh and leads the solver through the model's
 * loading steps.
 */
#ifndef WB_FE_TRIAL_WIRE3D_H
#define WB_FE_TRIAL_WIRE3D_H

#include <stddef.h>

#include "base/status.h"
#include "fe/model/wire_model.h"
#include "fe/solid/solid_mesh.h"
#include "fe/trial/wire_run.h"

/* Counted up whenever the same model comes to other numbers: datasets of before are outdated. */
enum {
    WB_WIRE3D_VERSION = 1
};

struct wb_wire3d; /* opaque */

/* Stresses at the nodes of the present state. At an interface each part has its own values: they
 * are kept by element. */
struct wb_wire3d_fields {
    double (*position)[3];   /* (n_nodes), m, deformed */
    double (*stress)[20][6]; /* (n_elements), Pa, Cauchy, global frame: xx, yy, zz, xy, yz, zx;
                                averaged at each node over the elements of a part */
    double (*plastic)[20];   /* (n_elements), equivalent plastic strain, averaged alike */
};

/* `model` is borrowed and must outlive it. On failure *out is NULL. */
WB_MUST_CHECK enum wb_status wb_wire3d_create(struct wb_wire3d **out,
                                              const struct wb_wire_model *model);
void wb_wire3d_destroy(struct wb_wire3d *wire); /* accepts NULL */

/* Follows the loading steps from the virgin state; `run` was made by wb_wire_run_init(). Not
 * converging is a result, not an error: what was completed stays in the run. */
WB_MUST_CHECK enum wb_status wb_wire3d_run(struct wb_wire3d *wire, struct wb_wire_run *run,
                                           const struct wb_wire_observer *observer);

const struct wb_solid_mesh *wb_wire3d_mesh(const struct wb_wire3d *wire);

/* Fields of the present state, allocated; wb_wire3d_fields_release() accepts a zeroed one. */
void wb_wire3d_fields(const struct wb_wire3d *wire, struct wb_wire3d_fields *fields);
void wb_wire3d_fields_release(struct wb_wire3d_fields *fields);

/* Of the last converged state: largest penetration, opening and accumulated slip of the interface
 * (m), zero when bonded; work done by the loads, stored elastic and dissipated energy (J). Of the
 * whole run: how far points of both parts that lay upon each other slid apart. For reports and
 * tests. */
struct wb_wire3d_balance {
    double penetration, opening, slip;          /* m */
    double sliding, slip_limit;                 /* m; beyond the limit small sliding is void */
    double work, elastic, dissipated, friction; /* J */
};
void wb_wire3d_balance(const struct wb_wire3d *wire, struct wb_wire3d_balance *balance);

#endif
