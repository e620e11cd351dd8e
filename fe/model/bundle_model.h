/* A taped bundle, from its YAML file in fixtures/bundles: wires, packing, taping, interfaces, ends,
 * meshes, run and loads. The keys, with units, ranges and defaults, are in docs/file-formats.md.
 *
 *     name: 7-type3
 *     wires:                              # in the order of the packing's places
 *       - {wire: type3, count: 7}
 *     packing: hexagon                    # triangle, densest, places
 *     tape: tape                          # a material; without it the bundle is bare
 *     taping: {layout: sleeve, layers: 2}
 *     length_mm: 114
 *     interface:
 *       cohesive_stiffness_N_mm3: 30
 *       friction: {static: 0.4, kinetic: 0.1, decay_s_mm: 2}
 *     loads: {strand_mm: 760, weight: true}
 *
 * Axes: x along the straight bundle from the clamp, y up, z across; the enclosing circle's centre
 * is the axis. Weight acts in -y, against the deflection.
 */
#ifndef WB_FE_MODEL_BUNDLE_MODEL_H
#define WB_FE_MODEL_BUNDLE_MODEL_H

#include <stdbool.h>

#include "base/file.h"
#include "base/setting.h"
#include "base/status.h"
#include "fe/material/friction.h"
#include "fe/material/material_file.h"
#include "fe/model/bundle_uncertainty.h"
#include "fe/model/hull.h"
#include "fe/model/packing.h"
#include "fe/model/taping.h"
#include "fe/model/wire.h"

enum {
    WB_BUNDLE_MODEL_TYPES = 16,
    WB_BUNDLE_MODEL_MESHES = 8
};

/* --- section --- */

enum wb_bundle_packing {
    WB_BUNDLE_HEXAGON,
    WB_BUNDLE_TRIANGLE,
    WB_BUNDLE_DENSEST,
    WB_BUNDLE_PLACES /* as listed */
};

struct wb_bundle_tape {
    struct wb_material_file material; /* its Poisson's ratio is a number */
    struct wb_taping taping;
    double gap;          /* m, from the wires it touches to its inner face */
    bool round;          /* on a circle around all wires; false: taut on their hull */
    double reach;        /* m: bonded where no farther from a wire than gap and this; 0: where it
                            lies on one */
    struct wb_hull hull; /* of the wires, or of the circle around them; the tape's middle is gap +
                            half its thickness outside */
};

/* --- between wires and tape --- */

/* Bilinear: linear to the strength, then falling so that the area below is the fracture energy. Of
 * both modes together sqrt((t_n / strength)^2 + (t_s / shear_strength)^2) reaches 1. */
struct wb_bundle_damage {
    double strength, shear_strength; /* Pa */
    double fracture_energy;          /* J/m2, of any mode */
};

struct wb_bundle_interface {
    double normal_stiffness; /* K_nn = K_cc, Pa/m, between tape and wires */
    double shear_stiffness;  /* K_ss = K_tt, Pa/m */
    bool has_damage;
    struct wb_bundle_damage damage;
    bool has_friction;           /* whether it was given */
    struct wb_friction friction; /* between wires, and between tape and wires that are not bonded
                                    (any more); the slip rate is in the model's own time */
};

/* --- ends, meshes, run, loads --- */

enum wb_bundle_tip {
    WB_BUNDLE_TIP_FREE,  /* the wires' ends move freely */
    WB_BUNDLE_TIP_CAPPED /* the end section of all wires and the tape moves as a rigid body */
};

enum wb_bundle_formulation {
    WB_BUNDLE_FOUR_POINTS, /* 2x2x1 */
    WB_BUNDLE_ONE_POINT
};

struct wb_bundle_mesh {
    char name[32];
    int core_quads, rings; /* of a wire's section, see fe/swept/swept_section.h:
                              core^2 + 4 core rings quadrilaterals */
    int elements_along;
    int tape_quads; /* around the tape; 0: as wide as those around the wires, a multiple of 6 */
    enum wb_bundle_formulation formulation;
};

struct wb_bundle_run {
    char mesh[32];        /* its name */
    double deflection;    /* m, of the tip */
    int rows;             /* of the dataset, in equal steps of a loading */
    int cycles;           /* of loading and unloading; 0: one loading */
    double duration;      /* s, of a loading; 0: chosen from the limit below */
    double mass_scaling;  /* f_m of eq. 29, at least 1; weight is not scaled */
    double selective;     /* beta of the selective mass scaling, at least 1; 1: none */
    double kinetic_limit; /* largest kinetic over internal energy */
    int double_precision; /* 1: of forces and histories, too; positions are always double. 0: single
                             precision */
};

struct wb_bundle_loads {
    double strand_length; /* m; 0: a vertical force at the tip */
    bool weight;
};

/* Published values of the homogenised beam. */
struct wb_bundle_published {
    double outer_diameter; /* m */
    double density;        /* kg/m3 */
    bool has_beam;
    struct wb_wire beam; /* with its calibrated properties */
};

enum wb_bundle_length_source {
    WB_BUNDLE_LENGTH_OWN,
    WB_BUNDLE_LENGTH_PRINTED,
    WB_BUNDLE_LENGTH_INFERRED
};

struct wb_bundle_model {
    char name[64], title[200], notes[2000];
    char path[WB_PATH]; /* of the file */

    int n_types;
    struct wb_wire type[WB_BUNDLE_MODEL_TYPES]; /* distinct wires in the order of the file; all have
                                                   properties */
    enum wb_bundle_packing arrangement;
    bool settled;
    double touching; /* m: listed places within it are moved until they touch; 0: none */
    struct wb_packing_search search; /* of the densest */
    double wire_gap;                 /* m, between wires that would touch */
    struct wb_packing packing;       /* of the wires without their gap */
    int type_of[WB_PACKING_MOST];

    bool has_tape;
    struct wb_bundle_tape tape;
    double length; /* m, from the clamp to the strand */
    enum wb_bundle_length_source length_source;
    struct wb_bundle_interface interface;
    double potted_length; /* m from the clamp over which epoxy holds all wires and the tape */
    enum wb_bundle_tip tip;

    int n_meshes;
    struct wb_bundle_mesh mesh[WB_BUNDLE_MODEL_MESHES + 2]; /* `engineering` and `paper` first */
    struct wb_bundle_run run;
    struct wb_bundle_loads loads;
    bool has_published;
    struct wb_bundle_published published;
    bool has_uncertainty;
    struct wb_bundle_uncertainty uncertainty;
};

/* Rows of the settings of struct wb_bundle_run, in the order of this enumeration; of friction (a
 * list of struct wb_bundle_interface's members) and of the cohesive stiffness in that struct. */
enum {
    WB_BUNDLE_MODEL_MESH,
    WB_BUNDLE_MODEL_DURATION,
    WB_BUNDLE_MODEL_MASS_SCALING,
    WB_BUNDLE_MODEL_SELECTIVE,
    WB_BUNDLE_MODEL_DEFLECTION,
    WB_BUNDLE_MODEL_ROWS,
    WB_BUNDLE_MODEL_CYCLES,
    WB_BUNDLE_MODEL_KINETIC_LIMIT,
    WB_BUNDLE_MODEL_PRECISION,
    WB_BUNDLE_MODEL_RUN_SETTINGS /* how many */
};
extern const struct wb_setting wb_bundle_model_run_settings[WB_BUNDLE_MODEL_RUN_SETTINGS];
extern const struct wb_setting wb_bundle_model_friction_setting[1];
extern const struct wb_setting wb_bundle_model_cohesion_setting[1];

/* Reads a bundle with its wires and its tape. Errors name file, line and key. */
WB_MUST_CHECK enum wb_status wb_bundle_model_read(struct wb_bundle_model *model, const char *path);

/* The same, with a variant's values in place of the file's (NULL: none). A variant that does not
 * apply to the file (a number of wires of several kinds, layers without tape or of a helix) is
 * rejected. */
WB_MUST_CHECK enum wb_status wb_bundle_model_read_variant(struct wb_bundle_model *model,
                                                          const char *path,
                                                          const struct wb_bundle_variant *variant);

/* Factors on a section's lengths. */
struct wb_bundle_scales {
    double diameter;  /* of the wires, places, gaps and tape, except the tape's thickness */
    double pitch;     /* of places and tape alone; the same wires touch */
    double thickness; /* of the tape */
};

/* Scales a model whose tape, if any, is a sleeve. */
void wb_bundle_model_scale(struct wb_bundle_model *model, const struct wb_bundle_scales *scales);

/* The number of rows of a complete test: the first row, those of the loading, or with cycles those
 * of each loading and unloading. */
int wb_bundle_model_rows(const struct wb_bundle_model *model);

/* The mesh of that name; NULL, without a message, if the model has none. */
const struct wb_bundle_mesh *wb_bundle_model_mesh(const struct wb_bundle_model *model,
                                                  const char *name);
/* Quadrilaterals of a wire's section, hexahedra of all wires, and quadrilaterals around the tape (0
 * without a tape). */
int wb_bundle_model_section_quads(const struct wb_bundle_mesh *mesh);
long wb_bundle_model_hexahedra(const struct wb_bundle_model *model,
                               const struct wb_bundle_mesh *mesh);
int wb_bundle_model_tape_quads(const struct wb_bundle_model *model,
                               const struct wb_bundle_mesh *mesh);

/* "hexagon", as in the file. */
const char *wb_bundle_model_arrangement(const struct wb_bundle_model *model);

/* The wires of a type. */
int wb_bundle_model_count(const struct wb_bundle_model *model, int type);

/* The wire that the tape is bonded to at a position (m) that lies `offset` (m) outside its outline:
 * the nearest wire within reach; -1 if no wire is. */
int wb_bundle_model_tape_wire(const struct wb_bundle_model *model, double y, double z,
                              double offset);

/* --- homogenised --- */

/* Diameter d_o (m) of the cylinder around wires, gap and tape. */
double wb_bundle_model_diameter(const struct wb_bundle_model *model);

/* kg/m of the wires, and of the tape. */
double wb_bundle_model_wire_mass(const struct wb_bundle_model *model);
double wb_bundle_model_tape_mass(const struct wb_bundle_model *model);

/* Eq. 30 over the circle of that diameter, kg/m3. */
double wb_bundle_model_density(const struct wb_bundle_model *model, double diameter);

/* Elastic flexural rigidities E I, N m2, each in bending upwards and across. The bundle's rigidity
 * lies between that of freely sliding wires and that of bonded wires. */
struct wb_bundle_rigidity {
    double wires;      /* each about its own axis, in any direction */
    double tape[2];    /* as a tube; 0 for a helix */
    double sliding[2]; /* sum of both: the lower bound */
    double bonded[2];  /* plane sections, with the tape as a tube: the upper bound */
};
struct wb_bundle_rigidity wb_bundle_model_rigidity(const struct wb_bundle_model *model);

/* --- as a list --- */

struct wb_bundle_fact {
    const char *key;  /* with its unit, for machines: "outer_diameter_mm" */
    const char *text; /* for readers: "outer diameter" */
    const char *unit; /* "mm" */
    double value;     /* in that unit */
};

enum {
    WB_BUNDLE_MODEL_FACTS = 32
};

/* Properties derived from the section, always in the same order; those of a missing tape or of
 * missing published values are omitted. Returns their number. */
int wb_bundle_model_facts(const struct wb_bundle_model *model,
                          struct wb_bundle_fact facts[WB_BUNDLE_MODEL_FACTS]);

#endif
