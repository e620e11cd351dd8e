/* Keys of `simulation` in dataset.json, by solver. */
#include "analysis/dataset/simulated.h"
#include "analysis/dataset/simulated_bundle.h"
#include "analysis/dataset/simulated_section.h"
#include "analysis/predict/bands_output.h"
#include "analysis/schema/tables.h"
#include "fe/model/bundle_model.h"
#include "fe/model/bundle_override.h"

/* --- inputs --- */

static const struct wb_key material_rows[] = {
    {"youngs_modulus_MPa", NUMBER, "Young's modulus"},
    {"poissons_ratio", NUMBER, "Poisson's ratio"},
    {"hardening", TEXT, "hardening law of the material; `none`: elastic"},
    {"yield_stress_MPa", NUMBER | OPTIONAL, "yield stress"},
    {"strength_coefficient_MPa", NUMBER | OPTIONAL, "strength coefficient"},
    {"hardening_exponent", NUMBER | OPTIONAL, "hardening exponent"},
};
static WB_KEYS(material, "input_material", "");

/* Of a law that is none of Ludwik's the numbers replace those of the material. */
static const struct wb_key law_rows[] = {
    {"youngs_modulus_MPa", NUMBER, "Young's modulus"},
    {"poissons_ratio", NUMBER, "Poisson's ratio"},
    {"hardening", TEXT, "hardening law of the material; `none`: elastic"},
    {"form", TEXT, "form of the law", .choices = "ludwik|parallel|chaboche"},
    {"isotropic_share", NUMBER, "share of the hardening that is isotropic"},
    {"rule", TEXT | OPTIONAL, "hardening rule, where it is `combined`"},
    {.of = &wb_law_numbers_keys},
};
static WB_KEYS(law, "input_law", "The law of a wire.");

#define SOLVER(name)                                                                               \
    {"solver", TEXT, "the solver", .choices = name},                                               \
    {                                                                                              \
        "version", INTEGER, "version of the solver, which grows when its numbers change"           \
    }

static const struct wb_key cantilever_inputs_rows[] = {
    SOLVER("cantilever"),
    {"law", OBJECT, "law of the wire", &law_keys},
    {"outer_diameter_mm", NUMBER, "outer diameter"},
    {"length_mm", NUMBER, "free length"},
    {"deflection_mm", NUMBER, "largest deflection"},
    {"strand_mm", NUMBER, "length of the strand; 0: a vertical force"},
    {"weight_kg_m", NUMBER, "mass per length that acts as weight; 0: none"},
    {"points", INTEGER, "rows of a loading"},
    {"cycles", INTEGER, "times up and back; 0: up only"},
};
static WB_KEYS(cantilever_inputs, "inputs_of_cantilever",
               "All that decides the numbers of `solve cantilever`.");

static const struct wb_key input_part_rows[] = {
    {"outer_diameter_mm", NUMBER, "outer diameter of the part"},
    {"density_g_cm3", NUMBER, "density"},
    {.of = &material_keys},
};
static WB_KEYS(input_part, "input_part", "A part of the wire.");

static const struct wb_key input_contact_rows[] = {
    {"friction", NUMBER, "friction coefficient"},
    {"normal_stiffness_N_mm3", NUMBER, "normal stiffness of the contact"},
    {"tangential_stiffness_N_mm3", NUMBER, "tangential stiffness of the contact"},
};
static WB_KEYS(input_contact, "input_contact", "Contact between two parts of a wire.");

static const struct wb_key history_rows[] = {
    {"name", TEXT, "name of the step"},
    {"kind", TEXT, "what the step applies", .choices = "loads|deflection|release"},
    {"force_N", NUMBER | LIST, "dead force at the tip: x, y, z"},
    {"moment_Nm", NUMBER | LIST, "dead moment at the tip: x, y, z"},
    {"follower_N", NUMBER | LIST,
     "force that turns with the tip's section: along the wire, and along the section's y and z"},
    {"deflection_mm", NUMBER, "deflection of the tip"},
    {"rows", INTEGER, "increments whose results are kept"},
    {"fields", FLAG, "stress fields are kept at the end of the step"},
};
static WB_KEYS(history, "input_step", "A step of the loading.");

static const struct wb_key wire_inputs_rows[] = {
    SOLVER("wire3d|wire1d"),
    {"length_mm", NUMBER, "free length"},
    {"parts", OBJECT | LIST, "parts from the inside out", &input_part_keys},
    {"interface", OBJECT | OPTIONAL, "contact between two parts, of a solid", &input_contact_keys},
    {"clamp", TEXT, "boundary condition at the clamp", .choices = "plane|fixed"},
    {"gravity", NUMBER | LIST, "gravity: x, y, z", .unit = "m/s2"},
    {"strand_mm", NUMBER, "length of the strand; 0: a vertical force"},
    {"mesh", OBJECT | OPTIONAL, "mesh, of a solid", &wb_simulated_wire_mesh_keys},
    {"fields_at_mm", NUMBER | LIST, "places of the cross sections whose fields are kept"},
    {"history", OBJECT | LIST, "steps of the loading", &history_keys},
};
static WB_KEYS(wire_inputs, "inputs_of_wire",
               "All that decides the numbers of `solve wire3d` or `wire1d`.");

static const struct wb_key input_wire_rows[] = {
    {"outer_diameter_mm", NUMBER, "outer diameter of the wire"},
    {"density_g_cm3", NUMBER, "density"},
    {.of = &material_keys},
};
static WB_KEYS(input_wire, "input_wire", "A kind of wire of a bundle in explicit dynamics.");

static const struct wb_key section_wire_rows[] = {
    {"outer_diameter_mm", NUMBER, "outer diameter of the wire"},
    {"density_g_cm3", NUMBER, "density"},
    {.of = &law_keys},
};
static WB_KEYS(section_wire, "input_wire_of_section",
               "A kind of wire of a bundle in the section model.");

static const struct wb_key tape_rows[] = {
    {.of = &material_keys},
    {"density_g_cm3", NUMBER, "density"},
    {"layer_thickness_mm", NUMBER, "thickness of one layer"},
    {"layout", TEXT, "layout of the tape", .choices = "sleeve|helix"},
    {"layers", NUMBER, "number of layers"},
    {"width_mm", NUMBER | OPTIONAL, "of a helix: width of the tape"},
    {"lap_percent", NUMBER | OPTIONAL, "of a helix: share that the next winding covers"},
    {"hand", TEXT | OPTIONAL, "of a helix: direction of the winding", .choices = "right|left"},
    {"gap_mm", NUMBER, "gap between the tape and the wires that it would touch"},
    {"outline", TEXT, "how the tape lies round the wires", .choices = "hull|circle"},
    {"bond_reach_mm", NUMBER, "largest gap that the bond bridges"},
};
static WB_KEYS(tape, "input_tape", "The tape of a bundle.");

static const struct wb_setting_table friction_setting = {wb_bundle_model_friction_setting, 1};
static const struct wb_setting_table cohesion_setting = {wb_bundle_model_cohesion_setting, 1};

static const struct wb_key input_interface_rows[] = {
    {.settings = &friction_setting},
    {.type = OPTIONAL, .settings = &cohesion_setting},
    {"shear_stiffness_N_mm3", NUMBER | OPTIONAL, "shear stiffness of the bond of the tape"},
    {"strength_MPa", NUMBER | OPTIONAL, "strength of the bond"},
    {"shear_strength_MPa", NUMBER | OPTIONAL, "shear strength of the bond"},
    {"fracture_energy_N_mm", NUMBER | OPTIONAL, "fracture energy of the bond"},
};
static WB_KEYS(input_interface, "input_interface",
               "Contact between wires, and the bond of the tape.");

static const struct wb_key input_mesh_rows[] = {
    {"core_quads", INTEGER, "quadrilaterals along a side of a wire's square core"},
    {"rings", INTEGER, "rings of quadrilaterals round that core"},
    {"elements_along", INTEGER, "elements along the bundle"},
    {"tape_quads", INTEGER, "quadrilaterals round the tape"},
    {"formulation", TEXT, "integration of the hexahedra", .choices = "2x2x1|one-point"},
};
static WB_KEYS(input_mesh, "input_mesh", "The mesh of a bundle.");

static const struct wb_setting_table run_settings = {wb_bundle_model_run_settings,
                                                     WB_BUNDLE_MODEL_RUN_SETTINGS};

static const struct wb_key run_rows[] = {
    {.type = OPTIONAL, .settings = &run_settings},
};
static WB_KEYS(run, "input_run",
               "The run, as in a bundle file; of the section model the test alone.");

static const struct wb_key bundle_tail_rows[] = {
    {"places", TEXT | LIST, "place of each wire's axis, as `wire 1 at 0.808290, 0.000000 mm`"},
    {"tape", OBJECT | OPTIONAL, "tape", &tape_keys},
    {"length_mm", NUMBER, "free length"},
    {"interface", OBJECT, "contact between wires, and the bond of the tape", &input_interface_keys},
    {"potted_mm", NUMBER, "length from the clamp over which epoxy holds wires and tape"},
    {"tip", TEXT, "end of the bundle", .choices = "free|capped"},
    {"run", OBJECT, "the run", &run_keys},
    {"strand_mm", NUMBER, "length of the strand; 0: a vertical force"},
    {"weight", FLAG, "weight acts"},
};
static WB_KEYS(bundle_tail, "bundle_inputs", "");

static const struct wb_key bundle_inputs_rows[] = {
    SOLVER("bundle"),
    {"wires", OBJECT | LIST, "kinds of wire", &input_wire_keys},
    {"mesh", OBJECT, "mesh", &input_mesh_keys},
    {.of = &bundle_tail_keys},
};
static WB_KEYS(bundle_inputs, "inputs_of_bundle",
               "All that decides the numbers of `solve bundle`.");

static const struct wb_key section_inputs_rows[] = {
    SOLVER("section"),
    {"wires", OBJECT | LIST, "kinds of wire", &section_wire_keys},
    {.of = &bundle_tail_keys},
};
static WB_KEYS(section_inputs, "inputs_of_section",
               "All that decides the numbers of `solve bundle --model section`.");

/* --- cantilever and bending3p --- */

static const struct wb_key ended_rows[] = {
    {"converged", FLAG, "the whole loading was computed"},
    {"wall_s", NUMBER, "time of the computation"},
    {"cpu_s", NUMBER, "CPU time of the computation"},
};
static WB_KEYS(ended, "ended_keys", "");

static const struct wb_key computed_law_rows[] = {
    {"law", TEXT, "whether the wire may yield", .choices = "elastic|elastoplastic"},
    {"youngs_modulus_MPa", NUMBER, "Young's modulus; of parallel parts the sum of moduli"},
    {"poissons_ratio", NUMBER, "Poisson's ratio"},
    {"form", TEXT | OPTIONAL, "form of the law", .choices = "ludwik|parallel|chaboche"},
    {"hardening", TEXT | OPTIONAL, "hardening rule",
     .choices = "isotropic|kinematic|mixed|combined"},
    {"isotropic_share", NUMBER | OPTIONAL, "share of the hardening that is isotropic"},
    {.of = &wb_law_numbers_keys},
    {"properties_source", TEXT, "source of the law's numbers"},
    {.of = &ended_keys},
};
static WB_KEYS(computed_law, "computed_law", "");

static const struct wb_key cantilever_rows[] = {
    {"model", TEXT, "the solver", .choices = "cantilever"},
    {"inputs", OBJECT | OPTIONAL, "all that decides the numbers; absent in older datasets",
     &cantilever_inputs_keys},
    {.of = &computed_law_keys},
    {"zero_force_N", NUMBER | OPTIONAL, "vertical force that `force_N` is counted from"},
};
static WB_KEYS(cantilever, "simulation_cantilever",
               "`solve cantilever`, with the numbers of the law.");

static const struct wb_key bending_rows[] = {
    {"model", TEXT, "the solver", .choices = "bending3p"},
    {.of = &computed_law_keys},
};
static WB_KEYS(bending, "simulation_bending3p", "`solve bending3p`, with the numbers of the law.");

/* --- kinds --- */

static const struct wb_key wire_rows[] = {
    {"model", TEXT, "the solver", .choices = "wire3d|wire1d"},
    {"inputs", OBJECT | OPTIONAL, "all that decides the numbers; absent in older datasets",
     &wire_inputs_keys},
    {.of = &wb_simulated_wire_keys},
};
static WB_KEYS(wire, "simulation_wire", "`solve wire3d` and `solve wire1d`.");

static const struct wb_key bundle_rows[] = {
    {"model", TEXT, "the solver", .choices = "bundle"},
    {"inputs", OBJECT, "all that decides the numbers", &bundle_inputs_keys},
    {.of = &wb_simulated_bundle_head_keys},
    {"surface_deflection_mm", NUMBER | OPTIONAL,
     "deflection at which surface.csv was taken; absent: there is none"},
    {.of = &wb_simulated_bundle_keys},
};
static WB_KEYS(bundle, "simulation_bundle", "`solve bundle` in explicit dynamics.");

static const struct wb_key section_rows[] = {
    {"model", TEXT, "the solver", .choices = "section"},
    {"inputs", OBJECT, "all that decides the numbers", &section_inputs_keys},
    {.of = &wb_simulated_bundle_head_keys},
    {.of = &wb_simulated_section_keys},
    {"uncertainty", OBJECT | OPTIONAL, "of `--uncertain`: bands", &wb_bands_output_keys},
};
static WB_KEYS(section, "simulation_section", "`solve bundle --model section`.");

static const struct wb_keys *const solvers[] = {&cantilever_keys, &bending_keys, &wire_keys,
                                                &bundle_keys,     &section_keys, NULL};
const struct wb_keys wb_schema_simulation = {
    "simulation", "The computation of a dataset; its keys depend on the solver.",
    .alternatives = solvers};
