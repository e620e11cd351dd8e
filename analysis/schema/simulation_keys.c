/* Keys of `simulation` in dataset.json, by solver. */
#include "analysis/schema/row.h"
#include "fe/model/bundle_model.h"
#include "fe/model/bundle_override.h"

/* --- inputs --- */

static const struct wb_schema_row material_rows[] = {
    {"youngs_modulus_MPa", NUMBER, "MPa", "Young's modulus"},
    {"poissons_ratio", NUMBER, "", "Poisson's ratio"},
    {"hardening", TEXT, "", "hardening law of the material; `none`: elastic"},
    {"yield_stress_MPa", NUMBER | OPTIONAL, "MPa", "yield stress"},
    {"strength_coefficient_MPa", NUMBER | OPTIONAL, "MPa", "strength coefficient"},
    {"hardening_exponent", NUMBER | OPTIONAL, "", "hardening exponent"},
};
static const struct wb_schema_object material = {"input_material", "", ROWS(material_rows)};

/* Of a law that is none of Ludwik's the numbers replace those of the material. */
static const struct wb_schema_row law_rows[] = {
    {"youngs_modulus_MPa", NUMBER, "MPa", "Young's modulus"},
    {"poissons_ratio", NUMBER, "", "Poisson's ratio"},
    {"hardening", TEXT, "", "hardening law of the material; `none`: elastic"},
    {"form", TEXT, "", "form of the law", .choices = "ludwik|parallel|chaboche"},
    {"isotropic_share", NUMBER, "", "share of the hardening that is isotropic"},
    {"rule", TEXT | OPTIONAL, "", "hardening rule, where it is `combined`"},
    {.of = &wb_schema_law_numbers},
};
static const struct wb_schema_object law = {"input_law", "The law of a wire.", ROWS(law_rows)};

#define SOLVER(name)                                                                               \
    {"solver", TEXT, "", "the solver", .choices = name},                                           \
    {                                                                                              \
        "version", INTEGER, "", "version of the solver, which grows when its numbers change"       \
    }

static const struct wb_schema_row cantilever_input_rows[] = {
    SOLVER("cantilever"),
    {"law", OBJECT, "", "law of the wire", &law},
    {"outer_diameter_mm", NUMBER, "mm", "outer diameter"},
    {"length_mm", NUMBER, "mm", "free length"},
    {"deflection_mm", NUMBER, "mm", "largest deflection"},
    {"strand_mm", NUMBER, "mm", "length of the strand; 0: a vertical force"},
    {"weight_kg_m", NUMBER, "kg/m", "mass per length that acts as weight; 0: none"},
    {"points", INTEGER, "", "rows of a loading"},
    {"cycles", INTEGER, "", "times up and back; 0: up only"},
};
static const struct wb_schema_object cantilever_inputs = {
    "inputs_of_cantilever", "All that decides the numbers of `solve cantilever`.",
    ROWS(cantilever_input_rows)};

static const struct wb_schema_row input_part_rows[] = {
    {"outer_diameter_mm", NUMBER, "mm", "outer diameter of the part"},
    {"density_g_cm3", NUMBER, "g/cm3", "density"},
    {.of = &material},
};
static const struct wb_schema_object input_part = {"input_part", "A part of the wire.",
                                                   ROWS(input_part_rows)};

static const struct wb_schema_row input_contact_rows[] = {
    {"friction", NUMBER, "", "friction coefficient"},
    {"normal_stiffness_N_mm3", NUMBER, "N/mm3", "normal stiffness of the contact"},
    {"tangential_stiffness_N_mm3", NUMBER, "N/mm3", "tangential stiffness of the contact"},
};
static const struct wb_schema_object input_contact = {
    "input_contact", "Contact between two parts of a wire.", ROWS(input_contact_rows)};

static const struct wb_schema_row solid_mesh_rows[] = {
    {"elements_along", INTEGER, "", "elements along the wire"},
    {"section_density", INTEGER, "", "refinement of the section"},
    {"integration", TEXT, "", "integration of the elements", .choices = "selective|reduced"},
};
static const struct wb_schema_object solid_mesh = {"mesh_of_solid", "The mesh of a solid wire.",
                                                   ROWS(solid_mesh_rows)};

static const struct wb_schema_row history_rows[] = {
    {"name", TEXT, "", "name of the step"},
    {"kind", TEXT, "", "what the step applies", .choices = "loads|deflection|release"},
    {"force_N", NUMBER | LIST, "N", "dead force at the tip: x, y, z"},
    {"moment_Nm", NUMBER | LIST, "N m", "dead moment at the tip: x, y, z"},
    {"follower_N", NUMBER | LIST, "N",
     "force that turns with the tip's section: along the wire, and along the section's y and z"},
    {"deflection_mm", NUMBER, "mm", "deflection of the tip"},
    {"rows", INTEGER, "", "increments whose results are kept"},
    {"fields", FLAG, "", "stress fields are kept at the end of the step"},
};
static const struct wb_schema_object history = {"input_step", "A step of the loading.",
                                                ROWS(history_rows)};

static const struct wb_schema_row wire_input_rows[] = {
    SOLVER("wire3d|wire1d"),
    {"length_mm", NUMBER, "mm", "free length"},
    {"parts", OBJECT | LIST, "", "parts from the inside out", &input_part},
    {"interface", OBJECT | OPTIONAL, "", "contact between two parts, of a solid", &input_contact},
    {"clamp", TEXT, "", "boundary condition at the clamp", .choices = "plane|fixed"},
    {"gravity", NUMBER | LIST, "m/s2", "gravity: x, y, z"},
    {"strand_mm", NUMBER, "mm", "length of the strand; 0: a vertical force"},
    {"mesh", OBJECT | OPTIONAL, "", "mesh, of a solid", &solid_mesh},
    {"fields_at_mm", NUMBER | LIST, "mm", "places of the cross sections whose fields are kept"},
    {"history", OBJECT | LIST, "", "steps of the loading", &history},
};
static const struct wb_schema_object wire_inputs = {
    "inputs_of_wire", "All that decides the numbers of `solve wire3d` or `wire1d`.",
    ROWS(wire_input_rows)};

static const struct wb_schema_row input_wire_rows[] = {
    {"outer_diameter_mm", NUMBER, "mm", "outer diameter of the wire"},
    {"density_g_cm3", NUMBER, "g/cm3", "density"},
    {.of = &material},
};
static const struct wb_schema_object input_wire = {
    "input_wire", "A kind of wire of a bundle in explicit dynamics.", ROWS(input_wire_rows)};

static const struct wb_schema_row section_wire_rows[] = {
    {"outer_diameter_mm", NUMBER, "mm", "outer diameter of the wire"},
    {"density_g_cm3", NUMBER, "g/cm3", "density"},
    {.of = &law},
};
static const struct wb_schema_object section_wire = {
    "input_wire_of_section", "A kind of wire of a bundle in the section model.",
    ROWS(section_wire_rows)};

static const struct wb_schema_row tape_rows[] = {
    {.of = &material},
    {"density_g_cm3", NUMBER, "g/cm3", "density"},
    {"layer_thickness_mm", NUMBER, "mm", "thickness of one layer"},
    {"layout", TEXT, "", "layout of the tape", .choices = "sleeve|helix"},
    {"layers", NUMBER, "", "number of layers"},
    {"width_mm", NUMBER | OPTIONAL, "mm", "of a helix: width of the tape"},
    {"lap_percent", NUMBER | OPTIONAL, "%", "of a helix: share that the next winding covers"},
    {"hand", TEXT | OPTIONAL, "", "of a helix: direction of the winding", .choices = "right|left"},
    {"gap_mm", NUMBER, "mm", "gap between the tape and the wires that it would touch"},
    {"outline", TEXT, "", "how the tape lies round the wires", .choices = "hull|circle"},
    {"bond_reach_mm", NUMBER, "mm", "largest gap that the bond bridges"},
};
static const struct wb_schema_object tape = {"input_tape", "The tape of a bundle.",
                                             ROWS(tape_rows)};

static const struct wb_setting_table friction_setting = {wb_bundle_model_friction_setting, 1};
static const struct wb_setting_table cohesion_setting = {wb_bundle_model_cohesion_setting, 1};

static const struct wb_schema_row input_interface_rows[] = {
    {.settings = &friction_setting},
    {.type = OPTIONAL, .settings = &cohesion_setting},
    {"shear_stiffness_N_mm3", NUMBER | OPTIONAL, "N/mm3",
     "shear stiffness of the bond of the tape"},
    {"strength_MPa", NUMBER | OPTIONAL, "MPa", "strength of the bond"},
    {"shear_strength_MPa", NUMBER | OPTIONAL, "MPa", "shear strength of the bond"},
    {"fracture_energy_N_mm", NUMBER | OPTIONAL, "N/mm", "fracture energy of the bond"},
};
static const struct wb_schema_object input_interface = {
    "input_interface", "Contact between wires, and the bond of the tape.",
    ROWS(input_interface_rows)};

static const struct wb_schema_row input_mesh_rows[] = {
    {"core_quads", INTEGER, "", "quadrilaterals along a side of a wire's square core"},
    {"rings", INTEGER, "", "rings of quadrilaterals round that core"},
    {"elements_along", INTEGER, "", "elements along the bundle"},
    {"tape_quads", INTEGER, "", "quadrilaterals round the tape"},
    {"formulation", TEXT, "", "integration of the hexahedra", .choices = "2x2x1|one-point"},
};
static const struct wb_schema_object input_mesh = {"input_mesh", "The mesh of a bundle.",
                                                   ROWS(input_mesh_rows)};

static const struct wb_setting_table run_settings = {wb_bundle_model_run_settings,
                                                     WB_BUNDLE_MODEL_RUN_SETTINGS};

static const struct wb_schema_row run_rows[] = {
    {.type = OPTIONAL, .settings = &run_settings},
};
static const struct wb_schema_object run = {
    "input_run", "The run, as in a bundle file; of the section model the test alone.",
    ROWS(run_rows)};

static const struct wb_schema_row bundle_tail_rows[] = {
    {"places", TEXT | LIST, "", "place of each wire's axis, as `wire 1 at 0.808290, 0.000000 mm`"},
    {"tape", OBJECT | OPTIONAL, "", "tape", &tape},
    {"length_mm", NUMBER, "mm", "free length"},
    {"interface", OBJECT, "", "contact between wires, and the bond of the tape", &input_interface},
    {"potted_mm", NUMBER, "mm", "length from the clamp over which epoxy holds wires and tape"},
    {"tip", TEXT, "", "end of the bundle", .choices = "free|capped"},
    {"run", OBJECT, "", "the run", &run},
    {"strand_mm", NUMBER, "mm", "length of the strand; 0: a vertical force"},
    {"weight", FLAG, "", "weight acts"},
};
static const struct wb_schema_object bundle_tail = {"bundle_inputs", "", ROWS(bundle_tail_rows)};

static const struct wb_schema_row bundle_input_rows[] = {
    SOLVER("bundle"),
    {"wires", OBJECT | LIST, "", "kinds of wire", &input_wire},
    {"mesh", OBJECT, "", "mesh", &input_mesh},
    {.of = &bundle_tail},
};
static const struct wb_schema_object bundle_inputs = {
    "inputs_of_bundle", "All that decides the numbers of `solve bundle`.", ROWS(bundle_input_rows)};

static const struct wb_schema_row section_input_rows[] = {
    SOLVER("section"),
    {"wires", OBJECT | LIST, "", "kinds of wire", &section_wire},
    {.of = &bundle_tail},
};
static const struct wb_schema_object section_inputs = {
    "inputs_of_section", "All that decides the numbers of `solve bundle --model section`.",
    ROWS(section_input_rows)};

/* --- cantilever and bending3p --- */

static const struct wb_schema_row ended_rows[] = {
    {"converged", FLAG, "", "the whole loading was computed"},
    {"wall_s", NUMBER, "s", "time of the computation"},
    {"cpu_s", NUMBER, "s", "CPU time of the computation"},
};
static const struct wb_schema_object ended = {"ended_keys", "", ROWS(ended_rows)};

static const struct wb_schema_row zero_force_rows[] = {
    {"zero_force_N", NUMBER | UNKNOWN, "N", "vertical force that `force_N` is counted from"},
};
static const struct wb_schema_object zero_force = {"zero_force_keys", "", ROWS(zero_force_rows)};

static const struct wb_schema_row computed_law_rows[] = {
    {"law", TEXT, "", "whether the wire may yield", .choices = "elastic|elastoplastic"},
    {"youngs_modulus_MPa", NUMBER, "MPa", "Young's modulus; of parallel parts the sum of moduli"},
    {"poissons_ratio", NUMBER, "", "Poisson's ratio"},
    {"form", TEXT | OPTIONAL, "", "form of the law", .choices = "ludwik|parallel|chaboche"},
    {"hardening", TEXT | OPTIONAL, "", "hardening rule",
     .choices = "isotropic|kinematic|mixed|combined"},
    {"isotropic_share", NUMBER | OPTIONAL, "", "share of the hardening that is isotropic"},
    {.of = &wb_schema_law_numbers},
    {"properties_source", TEXT, "", "source of the law's numbers"},
    {.of = &ended},
};
static const struct wb_schema_object computed_law = {"computed_law", "", ROWS(computed_law_rows)};

static const struct wb_schema_row cantilever_rows[] = {
    {"model", TEXT, "", "the solver", .choices = "cantilever"},
    {"inputs", OBJECT | OPTIONAL, "", "all that decides the numbers; absent in older datasets",
     &cantilever_inputs},
    {.of = &computed_law},
    {"zero_force_N", NUMBER | OPTIONAL, "N", "vertical force that `force_N` is counted from"},
};
static const struct wb_schema_object cantilever = {
    "simulation_cantilever", "`solve cantilever`, with the numbers of the law.",
    ROWS(cantilever_rows)};

static const struct wb_schema_row bending_rows[] = {
    {"model", TEXT, "", "the solver", .choices = "bending3p"},
    {.of = &computed_law},
};
static const struct wb_schema_object bending = {
    "simulation_bending3p", "`solve bending3p`, with the numbers of the law.", ROWS(bending_rows)};

/* --- wires --- */

static const struct wb_schema_row wire_part_rows[] = {
    {"name", TEXT, "", "name of the part"},
    {"outer_diameter_mm", NUMBER, "mm", "outer diameter"},
    {"material", TEXT, "", "name of the material"},
    {"source", TEXT, "", "source of the values"},
    {"substitute", FLAG, "", "the values replace lost ones"},
    {"youngs_modulus_MPa", NUMBER, "MPa", "Young's modulus"},
    {"poissons_ratio", NUMBER, "", "Poisson's ratio"},
    {"hardening", TEXT | OPTIONAL, "", "hardening; absent: elastic",
     .choices = "isotropic|kinematic"},
    {"yield_stress_MPa", NUMBER | OPTIONAL, "MPa", "yield stress"},
    {"strength_coefficient_MPa", NUMBER | OPTIONAL, "MPa", "strength coefficient"},
    {"hardening_exponent", NUMBER | OPTIONAL, "", "hardening exponent, of isotropic hardening"},
    {"density_g_cm3", NUMBER, "g/cm3", "density"},
};
static const struct wb_schema_object wire_part = {"wire_part", "A part of a wire model.",
                                                  ROWS(wire_part_rows)};

static const struct wb_schema_row homogenised_rows[] = {
    {"youngs_modulus_MPa", NUMBER, "MPa", "Young's modulus by the flexural rule of mixtures"},
    {"poissons_ratio", NUMBER, "", "Poisson's ratio by areas"},
};
static const struct wb_schema_object homogenised = {"homogenised", "The homogenised section.",
                                                    ROWS(homogenised_rows)};

static const struct wb_schema_row interface_rows[] = {
    {"kind", TEXT, "", "interface between core and jacket", .choices = "bonded|contact"},
    {"friction", NUMBER | OPTIONAL, "", "friction coefficient"},
    {"normal_stiffness_N_mm3", NUMBER | OPTIONAL, "N/mm3", "normal stiffness of the contact"},
    {"penetration_mm", NUMBER | OPTIONAL, "mm", "largest penetration at the end"},
    {"opening_mm", NUMBER | OPTIONAL, "mm", "largest opening at the end"},
    {"slip_mm", NUMBER | OPTIONAL, "mm", "largest accumulated slip at the end"},
    {"sliding_mm", NUMBER | OPTIONAL, "mm",
     "largest sliding of points that lay on each other, in the whole computation"},
    {"slip_limit_mm", NUMBER | OPTIONAL, "mm",
     "sliding beyond which the assumption of small sliding does not hold"},
};
static const struct wb_schema_object interface = {
    "interface", "The interface of core and jacket; numbers of contact only.",
    ROWS(interface_rows)};

static const struct wb_schema_row solid_energy_rows[] = {
    {"work_J", NUMBER, "J", "work of the loads"},
    {"elastic_J", NUMBER, "J", "stored elastic energy"},
    {"dissipated_J", NUMBER, "J", "energy dissipated by plasticity"},
    {"friction_J", NUMBER, "J", "energy dissipated by friction"},
};
static const struct wb_schema_object solid_energy = {
    "energy_of_solid", "Energies at the end of the computation.", ROWS(solid_energy_rows)};

static const struct wb_schema_row step_rows[] = {
    {"name", TEXT, "", "name of the step"},
    {"kind", TEXT, "", "what the step applies", .choices = "loads|deflection|release"},
    {"last_row", INTEGER, "", "last row of the step, from 1"},
    {"t_s", NUMBER, "s", "time of that row"},
    {"complete", FLAG, "", "the step was computed to its end"},
};
static const struct wb_schema_object step = {"step", "A step of the model that was begun.",
                                             ROWS(step_rows)};

static const struct wb_schema_row model_rows[] = {
    {"name", TEXT, "", "name of the model"},
    {"title", TEXT, "", "title of the model"},
    {"notes", TEXT | OPTIONAL, "", "notes of the model"},
    {"file", TEXT, "", "file of the model"},
};
static const struct wb_schema_object model = {"model_keys", "", ROWS(model_rows)};

static const struct wb_schema_row wire_rows[] = {
    {"model", TEXT, "", "the solver", .choices = "wire3d|wire1d"},
    {.of = &model},
    {"inputs", OBJECT | OPTIONAL, "", "all that decides the numbers; absent in older datasets",
     &wire_inputs},
    {"sha256", TEXT | OPTIONAL, "", "of older datasets: SHA-256 of the model's files"},
    {"law", TEXT, "", "whether the wire may yield", .choices = "elastic|elastoplastic"},
    {"parts", OBJECT | LIST, "", "parts of the wire, from the inside out", &wire_part},
    {"substitutes", FLAG, "", "values of a part replace lost ones"},
    {"homogenised", OBJECT, "", "homogenised section", &homogenised},
    {"clamp", TEXT, "", "boundary condition at the clamp", .choices = "plane|fixed"},
    {"gravity_m_s2", NUMBER | LIST, "m/s2", "gravity: x, y, z"},
    {"interface", OBJECT | OPTIONAL, "", "of wire3d: interface of core and jacket", &interface},
    {"mesh", OBJECT | OPTIONAL, "", "of wire3d: mesh", &solid_mesh},
    {"energy", OBJECT | OPTIONAL, "", "of wire3d: energies at the end", &solid_energy},
    {"elements", INTEGER, "", "number of elements"},
    {"degrees_of_freedom", INTEGER, "", "number of unknowns"},
    {"increments", INTEGER, "", "increments of the loading"},
    {"iterations", INTEGER, "", "iterations of the equilibrium"},
    {"cutbacks", INTEGER, "", "increments that were repeated with a smaller step"},
    {"stopped", FLAG, "", "stopped by Ctrl-C"},
    {"problem", TEXT | OPTIONAL, "", "where and why the computation did not converge"},
    {.of = &zero_force},
    {.of = &ended},
    {"peak_memory_MB", NUMBER | OPTIONAL, "MB", "largest memory of the process"},
    {"steps", OBJECT | LIST, "", "steps of the model that were begun", &step},
};
static const struct wb_schema_object wire = {"simulation_wire",
                                             "`solve wire3d` and `solve wire1d`.", ROWS(wire_rows)};

/* --- bundles --- */

static const struct wb_schema_row cohesion_rows[] = {
    {"normal_stiffness_N_mm3", NUMBER, "N/mm3", "normal stiffness"},
    {"shear_stiffness_N_mm3", NUMBER, "N/mm3", "shear stiffness"},
    {"strength_MPa", NUMBER | OPTIONAL, "MPa", "strength; absent: the bond does not fail"},
    {"shear_strength_MPa", NUMBER | OPTIONAL, "MPa", "shear strength"},
    {"fracture_energy_N_mm", NUMBER | OPTIONAL, "N/mm", "fracture energy"},
};
static const struct wb_schema_object cohesion = {"cohesion", "The bond between tape and wires.",
                                                 ROWS(cohesion_rows)};

static const struct wb_schema_row override_rows[] = {
#define OVERRIDES(of)                                                                              \
    {                                                                                              \
        .type = OPTIONAL, .settings = &wb_bundle_override_tables[WB_BUNDLE_OVERRIDE_##of]          \
    }
    OVERRIDES(MESH), OVERRIDES(PIECE),    OVERRIDES(TEST),     OVERRIDES(LOADS),
    OVERRIDES(RUN),  OVERRIDES(FRICTION), OVERRIDES(COHESION),
#undef OVERRIDES
};
static const struct wb_schema_object override = {
    "overridden", "The settings of the bundle's file that options of the command replaced.",
    ROWS(override_rows)};

static const struct wb_schema_row bundle_mesh_rows[] = {
    {"name", TEXT, "", "name of the mesh"},
    {"section_quads", INTEGER, "", "quadrilaterals of a wire's section"},
    {"elements_along", INTEGER, "", "elements along the bundle"},
    {"tape_quads", INTEGER, "", "quadrilaterals round the tape"},
    {"formulation", TEXT, "", "integration of the hexahedra", .choices = "2x2x1|one-point"},
};
static const struct wb_schema_object bundle_mesh = {"mesh_of_bundle", "The mesh of a bundle.",
                                                    ROWS(bundle_mesh_rows)};

static const struct wb_schema_row bundle_energy_rows[] = {
    {"external_J", NUMBER, "J",
     "work of the tip's force and of the weight, less the kinetic energy removed when the strand "
     "became slack"},
    {"kinetic_J", NUMBER, "J", "kinetic energy of the scaled masses"},
    {"stored_J", NUMBER, "J", "elastic energy of wires and tape"},
    {"plastic_J", NUMBER, "J", "energy dissipated by plasticity of wires and tape"},
    {"contact_J", NUMBER, "J", "energy stored in contact between wires, and of tape and wires"},
    {"cohesive_J", NUMBER, "J", "energy stored in the tape's bond and dissipated by its damage"},
    {"friction_J", NUMBER, "J", "energy dissipated by friction"},
    {"artificial_J", NUMBER, "J", "energy of the hourglass stiffness"},
    {"imbalance_J", NUMBER, "J", "external work less all other energies"},
};
static const struct wb_schema_object bundle_energy = {
    "energy_of_bundle", "Energies at the last row.", ROWS(bundle_energy_rows)};

static const struct wb_schema_row bundle_largest_rows[] = {
    {"kinetic_over_internal", NUMBER | UNKNOWN, "",
     "kinetic over internal energy, from 2 mm of deflection on (or half the deflection)"},
    {"artificial_over_internal", NUMBER | UNKNOWN, "", "artificial over internal energy"},
    {"imbalance_over_external", NUMBER | UNKNOWN, "",
     "imbalance over the largest external work so far"},
    {"strain", NUMBER, "", "logarithmic strain"},
    {"penetration_mm", NUMBER, "mm", "penetration of wires"},
    {"beyond_strain_limit", FLAG, "",
     "a strain exceeds 5 % in wires or 10 % in the tape, beyond which the elements' logarithmic "
     "strain is not accurate"},
};
static const struct wb_schema_object bundle_largest = {
    "largest_of_bundle", "Largest values of the run.", ROWS(bundle_largest_rows)};

static const struct wb_schema_row bundle_head_rows[] = {
    {.of = &model},
    {"law", TEXT, "", "whether wires may yield", .choices = "elastoplastic"},
    {"wires", INTEGER, "", "number of wires"},
    {"tape", FLAG, "", "there is a tape"},
    {.settings = &friction_setting},
    {"cohesion", OBJECT | OPTIONAL, "", "bond between tape and wires", &cohesion},
    {"overridden", OBJECT | OPTIONAL, "", "settings that options replaced", &override},
    {"stopped", FLAG, "", "stopped by Ctrl-C"},
    {.of = &zero_force},
    {.of = &ended},
};
static const struct wb_schema_object bundle_head = {"bundle_keys", "", ROWS(bundle_head_rows)};

static const struct wb_schema_row bundle_rows[] = {
    {"model", TEXT, "", "the solver", .choices = "bundle"},
    {"inputs", OBJECT, "", "all that decides the numbers", &bundle_inputs},
    {.of = &bundle_head},
    {"surface_deflection_mm", NUMBER | OPTIONAL, "mm",
     "deflection at which surface.csv was taken; absent: there is none"},
    {"mesh", OBJECT, "", "mesh", &bundle_mesh},
    {"elements", INTEGER, "", "number of hexahedra"},
    {"shells", INTEGER, "", "number of shells"},
    {"time_step_s", NUMBER | UNKNOWN, "s", "time step"},
    {"steps", INTEGER, "", "time steps of the last attempt"},
    {"steps_of_all_attempts", INTEGER, "", "time steps of all attempts"},
    {"duration_s", NUMBER, "s", "duration of a loading in the model's time"},
    {"duration_chosen", FLAG, "", "the duration was chosen from the limit of the kinetic energy"},
    {"attempts", INTEGER, "", "attempts that the choice took"},
    {"kinetic_energy_limit", NUMBER, "", "limit of kinetic over internal energy"},
    {"limit_kept", FLAG, "", "the last attempt kept that limit"},
    {"mass_scaling", NUMBER, "", "mass scaling f_m of eq. 29"},
    {"selective_mass_scaling", NUMBER, "", "selective mass scaling beta; 1: none"},
    {"precision", TEXT | OPTIONAL, "",
     "precision of forces and of stored states of the material; absent: single",
     .choices = "single|double"},
    {"energy", OBJECT | OPTIONAL, "", "energies at the last row", &bundle_energy},
    {"largest", OBJECT, "", "largest values of the run", &bundle_largest},
    {"problem", TEXT | OPTIONAL, "", "where and why the computation failed"},
    {"threads", INTEGER, "", "threads of a process"},
    {"ranks", INTEGER, "", "processes of MPI"},
    {"ns_per_element_step", NUMBER | OPTIONAL, "ns", "CPU time over hexahedra and steps"},
};
static const struct wb_schema_object bundle = {
    "simulation_bundle", "`solve bundle` in explicit dynamics.", ROWS(bundle_rows)};

static const struct wb_schema_row section_energy_rows[] = {
    {"external_J", NUMBER, "J", "work of the tip's force and of the weight"},
    {"wires_J", NUMBER, "J", "stored and plastic work of the wires"},
    {"tape_J", NUMBER, "J", "stored and plastic work of the tape"},
    {"cohesive_J", NUMBER, "J", "energy stored in the bond"},
    {"friction_J", NUMBER, "J",
     "energy dissipated by friction, with what contacts store before they slip"},
    {"imbalance_J", NUMBER, "J", "external work less all other energies"},
};
static const struct wb_schema_object section_energy = {
    "energy_of_section", "Energies at the last row.", ROWS(section_energy_rows)};

static const struct wb_schema_row section_largest_rows[] = {
    {"residual", NUMBER | UNKNOWN, "", "residual over the largest force"},
    {"imbalance_over_external", NUMBER | UNKNOWN, "", "imbalance over the external work"},
    {"contact_balance_missing", NUMBER | UNKNOWN, "",
     "load in the plane that contact forces do not balance, over the largest load"},
    {"tape_plastic_strain", NUMBER, "", "plastic strain of the tape"},
};
static const struct wb_schema_object section_largest = {
    "largest_of_section", "Largest values of the run.", ROWS(section_largest_rows)};

static const struct wb_schema_row elastic_rows[] = {
    {"length_mm", NUMBER, "mm", "length: half, once or twice the bundle's"},
    {"flexural_rigidity_N_mm2", NUMBER, "N mm2", "flexural rigidity of the homogenised beam"},
    {"newmark_alpha_L", NUMBER | UNKNOWN, "",
     "alpha L of Newmark's theory; null: no slip gives the rigidity"},
};
static const struct wb_schema_object elastic = {
    "elastic_beam", "The elastic rigidity at one length.", ROWS(elastic_rows)};

static const struct wb_schema_row curve_rows[] = {
    {"curvature_1_m", NUMBER, "1/m", "curvature"},
    {"moment_N_mm", NUMBER, "N mm", "moment"},
    {"secant_rigidity_N_mm2", NUMBER | UNKNOWN, "N mm2", "moment over curvature"},
};
static const struct wb_schema_object curve = {"beam_moment", "A point of the moment curve.",
                                              ROWS(curve_rows)};

static const struct wb_schema_row beam_rows[] = {
    {"elastic", OBJECT | LIST, "", "rigidity at half, once and twice the length", &elastic},
    {"moment_curvature", OBJECT | LIST, "", "moment over curvature", &curve},
};
static const struct wb_schema_object beam = {
    "homogenised_beam",
    "The beam that bends like the bundle; it holds for this length and these ends only.",
    ROWS(beam_rows)};

static const struct wb_schema_row section_rows[] = {
    {"model", TEXT, "", "the solver", .choices = "section"},
    {"inputs", OBJECT, "", "all that decides the numbers", &section_inputs},
    {.of = &bundle_head},
    {"bending", TEXT, "", "kind of bending: planar, without twist"},
    {"friction_used", NUMBER, "", "friction coefficient of the computation"},
    {"friction_is_mean_of_decay", FLAG, "",
     "it is the geometric mean of a static and a kinetic coefficient"},
    {"mirrored", FLAG, "", "mirror images share unknowns"},
    {"elements_along", INTEGER, "", "elements along the bundle"},
    {"unknowns", INTEGER, "", "unknowns of all stations"},
    {"increments", INTEGER, "", "increments of the loading"},
    {"iterations", INTEGER, "", "iterations of the equilibrium"},
    {"energy", OBJECT | OPTIONAL, "", "energies at the last row", &section_energy},
    {"largest", OBJECT, "", "largest values of the run", &section_largest},
    {"homogenised_beam_of_this_length_and_these_ends", OBJECT, "", "beam that bends alike", &beam},
    {"uncertainty", OBJECT | OPTIONAL, "", "of `--uncertain`: bands", &wb_schema_uncertainty},
};
static const struct wb_schema_object section = {
    "simulation_section", "`solve bundle --model section`.", ROWS(section_rows)};

static const struct wb_schema_object *const solvers[] = {&cantilever, &bending, &wire,
                                                         &bundle,     &section, NULL};
const struct wb_schema_object wb_schema_simulation = {
    "simulation", "The computation of a dataset; its keys depend on the solver.",
    .alternatives = solvers};
