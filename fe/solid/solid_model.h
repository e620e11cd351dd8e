/* A body to be computed: its mesh, materials, supports and dead loads.
 */
#ifndef WB_FE_SOLID_SOLID_MODEL_H
#define WB_FE_SOLID_SOLID_MODEL_H

#include "fe/linear/trial.h"
#include "fe/material/material.h"
#include "fe/solid/solid_mesh.h"

struct wb_solid_part {
    struct wb_material material;
    double density; /* kg/m3 */
};

/* A held displacement component; `displacement` (m) is that at support factor 1. */
struct wb_solid_support {
    int node, axis;
    double displacement;
};

struct wb_solid_model {
    const struct wb_solid_mesh *mesh;  /* borrowed; must outlive the solid */
    const struct wb_solid_part *parts; /* (mesh->n_parts), copied */
    enum wb_integration integration;
    double gravity[3]; /* m/s2 */
    int n_supports;
    const struct wb_solid_support *supports; /* copied */
    const double (*nodal_force)[3];          /* (n_nodes) N at nodal factor 1, copied; NULL: none */
    const struct wb_jacket_contact_law
        *jacket_contact;  /* of the mesh's pairs, copied; NULL: none */
    double strand_length; /* m; 0: a deflection is made by a vertical force */
    double strand_x;      /* m: x of the strand's upper end */
};

#endif
