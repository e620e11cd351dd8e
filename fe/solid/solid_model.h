/* Input of fe/solid/solid.h: mesh, materials, supports and dead loads of a body.
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

/* A prescribed displacement component; `displacement` (m) is its value at support factor 1. */
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
    /* For the mesh's pairs, copied; NULL: no contact. */
    const struct wb_jacket_contact_law *jacket_contact;
    double strand_length; /* m; 0: a vertical force prescribes the deflection */
    double strand_x;      /* m: x of the strand's upper end */
};

#endif
