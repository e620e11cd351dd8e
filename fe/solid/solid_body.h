/* The discrete body of fe/solid/solid.h: elements with their histories, equations, assembly.
 *
 * Displacements are full vectors (3 n_nodes); prescribed components keep the value given by the
 * caller. Free components have equation numbers in the order of the nodes, so that the layers of
 * the mesh are the blocks of the stiffness.
 */
#ifndef WB_FE_SOLID_SOLID_BODY_H
#define WB_FE_SOLID_SOLID_BODY_H

#include <stdbool.h>

#include "base/memory.h"
#include "base/status.h"
#include "fe/linear/layered.h"
#include "fe/solid/hex20.h"
#include "fe/solid/jacket_contact.h"
#include "fe/solid/solid_model.h"

struct wb_solid_body {
    const struct wb_solid_mesh *mesh; /* borrowed */
    enum wb_integration integration;
    int n_points; /* of an element */
    struct wb_solid_part *parts;
    struct wb_hex20_geometry *geometry; /* (n_elements) */
    int *equation;                      /* (3 n_nodes); -1: held */
    int n_equations;
    struct wb_solid_point_state *committed, *trial; /* (n_elements x n_points) */
    bool has_contact;                               /* its tangent is unsymmetric */
    struct wb_jacket_contact_law jacket_contact;
    struct wb_jacket_contact_state *committed_pairs, *trial_pairs; /* (n_pairs x 9) */
    double *weight;             /* (3 n_nodes) N: gravity forces */
    struct wb_layered *tangent; /* of the last evaluation with stiffness */
    double *force;              /* (3 n_nodes) N: internal forces of the last evaluation */
    double *element_stiffness;  /* workspace */
    struct wb_memory memory;    /* of all arrays */
};

/* Result of an evaluation. */
struct wb_solid_body_result {
    bool possible;     /* false: an element is inverted or a value is not finite */
    int worst_element; /* index of the element that failed */
    double elastic, dissipated, friction; /* J; dissipated and friction: of the step */
    struct wb_jacket_contact_result jacket_contact;
};

WB_MUST_CHECK enum wb_status wb_solid_body_init(struct wb_solid_body *body,
                                                const struct wb_solid_model *model);
void wb_solid_body_release(struct wb_solid_body *body); /* accepts a zeroed one */

/* Computes internal forces for displacements u, from the committed histories to the trial ones;
 * with `stiffness` also the tangent, and the tangent times `held_change` (3 n_nodes; NULL: none), a
 * change of prescribed displacements, which is added to `held_force` (3 n_nodes). */
void wb_solid_body_evaluate(struct wb_solid_body *body, const double *u, bool stiffness,
                            const double *held_change, double *held_force,
                            struct wb_solid_body_result *result);

/* Commits the trial histories. */
void wb_solid_body_commit(struct wb_solid_body *body);

#endif
