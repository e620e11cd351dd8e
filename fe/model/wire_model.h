/* A wire model, from its YAML file in fixtures/models: geometry, parts with their materials, mesh,
 * loading steps in their order.
 *
 *     name: residual-1-8awg
 *     title: Residual 1 of section 2.4
 *     notes: what a reader should know                 # optional
 *     wire: 8awg                                       # name in fixtures/wires, or a path
 *     length_mm: 100
 *     law: elastoplastic                               # or elastic: no part yields
 *     parts:                                           # optional; absent: one full circle of the
 *       - name: core                                   # wire's outer diameter with its homogenised
 *         outer_diameter_mm: 3.26                      # properties and density
 *         material: annealed-copper                    # name in fixtures/materials, or a path
 *       - name: jacket
 *         outer_diameter_mm: 4.86
 *         material: pvc
 *     interface:                                       # optional, two parts only; absent: bonded
 *       friction: 0.1
 *       normal_stiffness_N_mm3: 400                    # optional, from the jacket by default
 *     clamp: plane                                     # section stays plane, free to contract
 *                                                      # (default), or fixed: no displacement
 *     gravity: [0, 0, 0]                               # m/s2; required, so that it is stated
 *     strand_mm: 760                                   # optional: a deflection is made by a strand
 *     mesh:                                            # optional, as all of its keys
 *       elements_along: 60
 *       section_density: 1
 *       integration: selective                         # or reduced
 *     fields_at_mm: [3.26, 50]                         # optional: cross sections to keep fields of
 *     history:                                         # steps, each from the end of the last
 *       - name: force
 *         force_N: [5, 5, 5]                           # dead force at the tip
 *         rows: 5                                      # optional, 10: rows kept, in equal steps
 *       - name: moment
 *         moment_Nm: [0.2, 0.2, 0.2]                   # dead moment; the force stays
 *         rows: 5
 *       - name: unloaded
 *         unload: true                                 # all forces and moments to zero
 *       - name: loaded
 *         follower_N: [0, 24, 0]                       # turns with the tip; (along, y, z) of its
 *         fields: true                                 # frame. Keep stress fields at its end
 *       - name: raised
 *         deflection_mm: 53                            # y of the tip, by vertical force or strand
 *       - name: released
 *         release: true                                # that force back to zero
 *
 * The first step also brings the weight. A step has exactly one of force_N, moment_Nm, follower_N,
 * unload, deflection_mm, release; forces that it does not name stay as they are.
 */
#ifndef WB_FE_MODEL_WIRE_MODEL_H
#define WB_FE_MODEL_WIRE_MODEL_H

#include <stdbool.h>

#include "base/file.h"
#include "base/status.h"
#include "fe/linear/trial.h"
#include "fe/material/material.h"
#include "fe/model/wire.h"

enum {
    WB_WIRE_MODEL_PARTS = 2,
    WB_WIRE_MODEL_STEPS = 16,
    WB_WIRE_MODEL_SECTIONS = 8
};

struct wb_wire_model_part {
    char name[32];
    double inner_diameter, outer_diameter; /* m */
    char material_name[64];
    char source[400];   /* of the material */
    bool is_substitute; /* its values replace lost values of the paper */
    struct wb_material material;
    double density; /* kg/m3 */
};

enum wb_wire_step_kind {
    WB_WIRE_STEP_LOADS,      /* tip loads go to `loads` along a straight line */
    WB_WIRE_STEP_DEFLECTION, /* tip's y goes to `deflection`, by a vertical force or the strand */
    WB_WIRE_STEP_RELEASE     /* that force, or the strand's tension, goes to zero */
};

struct wb_wire_step {
    char name[32];
    enum wb_wire_step_kind kind;
    struct wb_tip_loads loads; /* at the end of the step, in steps of every kind */
    double deflection;         /* m */
    int rows;                  /* at least 1 */
    bool fields;               /* keep stress fields at its end */
    bool unloads;              /* rows of this step are of the phase `unload`: releases, unloading,
                                  less deflection than before, smaller loads than before */
};

enum wb_wire_clamp {
    WB_WIRE_CLAMP_PLANE,
    WB_WIRE_CLAMP_FIXED
};

struct wb_wire_model {
    char name[64], title[200], notes[2000];
    char path[WB_PATH]; /* of the file */
    struct wb_wire wire;
    double length;       /* m */
    bool is_elastic;     /* law: elastic */
    bool is_homogenised; /* one part with the wire's own properties */
    int n_parts;
    struct wb_wire_model_part part[WB_WIRE_MODEL_PARTS];
    bool has_contact;
    struct wb_jacket_contact_law jacket_contact;
    enum wb_wire_clamp clamp;
    double gravity[3];    /* m/s2 */
    double strand_length; /* m; 0: vertical force */
    int elements_along, section_density;
    enum wb_integration integration;
    int n_sections;
    double section[WB_WIRE_MODEL_SECTIONS]; /* m */
    int n_steps;
    struct wb_wire_step step[WB_WIRE_MODEL_STEPS];
};

/* Reads a model with its wire and materials. Errors name file, line and key. */
WB_MUST_CHECK enum wb_status wb_wire_model_read(struct wb_wire_model *model, const char *path);

/* Whether the only load is a follower force across the wire, in its y; it is then the test's
 * `force`. */
bool wb_wire_model_is_follower(const struct wb_wire_model *model);

/* Whether the model is a bending test like one of the bench, whose force over deflection a planar
 * model can follow: deflections only, or a vertical force only and no weight, or a follower test;
 * gravity upright. */
bool wb_wire_model_is_bending_test(const struct wb_wire_model *model);

/* Mass per length of all parts, kg/m; homogenised Young's modulus (eq. 8 of the paper) and
 * Poisson's ratio (eq. 9) over the outer diameter. */
double wb_wire_model_mass_per_length(const struct wb_wire_model *model);
double wb_wire_model_youngs_modulus(const struct wb_wire_model *model);
double wb_wire_model_poissons_ratio(const struct wb_wire_model *model);

#endif
