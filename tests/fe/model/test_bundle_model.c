/* Bundle models: every key of the file, every refusal with file, line and key, and what follows
 * from the section: the paper's diameters and densities, and bounds of the flexural rigidity. */
#include "tests/messages.h"
#include "tests/own_folder.h"

#include <stdlib.h>
#include <unistd.h>

#include "base/config.h"
#include "base/file.h"
#include "fe/model/bundle_model.h"

static char model_path[64];
static struct wb_bundle_model model;
static struct wb_bundle_fact facts[WB_BUNDLE_MODEL_FACTS];

static void write_beside(const char *name, const char *text)
{
    char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *const out = fopen(path, "w");
    assert_non_null(out);
    assert_int_equal(fwrite(text, 1, strlen(text), out), strlen(text));
    assert_int_equal(fclose(out), 0);
}

static enum wb_status try_text(const char *text)
{
    write_beside("model.yaml", text);
    keep_messages();
    const enum wb_status status = wb_bundle_model_read(&model, model_path);
    wb_log_set_sink(NULL, NULL);
    return status;
}

static void read_text(const char *text)
{
    if (try_text(text) != WB_OK)
        fail_msg("refused: %s", kept.last);
}

/* A copy with one part changed; `text` has room for 4096 bytes. */
static void replace(char *text, const char *source, const char *old, const char *new_text)
{
    const char *const at = strstr(source, old);
    if (!at)
        fail_msg("no '%s'", old);
    snprintf(text, 4096, "%.*s%s%s", (int)(at - source), source, new_text, at + strlen(old));
}

static void read_shipped(const char *name)
{
    char path[WB_PATH];
    assert_int_equal(wb_file_find_fixture(path, "bundles", name, NULL), WB_OK);
    assert_int_equal(wb_bundle_model_read(&model, path), WB_OK);
}

/* --- keys --- */

/* Line numbers matter to the refusals below. */
static const char full[] = "name: mine\n"
                           "title: A title\n"
                           "notes: Some notes\n"
                           "wires:\n"
                           "  - {wire: type3, count: 2}\n"
                           "  - {wire: ./thin.yaml}\n"
                           "  - {wire: type3, count: 4}\n"
                           "packing: hexagon\n"
                           "settled: false\n"
                           "gaps: {wires_mm: 0.02, tape_mm: 0.03}\n"
                           "tape: tape\n"
                           "taping: {layout: sleeve, layers: 4, poissons_ratio: 0.4}\n"
                           "length_mm: 114\n"
                           "length_source: printed\n"
                           "interface:\n"
                           "  cohesive_stiffness_N_mm3: 30\n"
                           "  shear_to_normal_stiffness: 0.5\n"
                           "  damage: {strength_MPa: 2, shear_strength_MPa: 1, "
                           "fracture_energy_N_mm: 0.3}\n"
                           "  friction: {static: 0.4, kinetic: 0.1, decay_s_mm: 2}\n"
                           "ends: {potted_mm: 3, tip: capped}\n"
                           "meshes:\n"
                           "  - {name: fine, core_quads: 4, rings: 1, elements_along: 160}\n"
                           "  - {name: rough, core_quads: 2, rings: 0, elements_along: 40, "
                           "tape_quads: 18, formulation: one-point}\n"
                           "run:\n"
                           "  mesh: fine\n"
                           "  deflection_mm: 40\n"
                           "  rows: 20\n"
                           "  cycles: 3\n"
                           "  duration_s: 2\n"
                           "  mass_scaling: 4\n"
                           "  selective_mass_scaling: 100\n"
                           "  kinetic_energy_limit: 0.02\n"
                           "  precision: double\n"
                           "loads: {strand_mm: 760, weight: true}\n"
                           "published: {outer_diameter_mm: 4.6, density_g_cm3: 3.43, beam: "
                           "bundle-7}\n";

static const char thin[] = "name: thin\nconductor_diameter_mm: 0.5\nouter_diameter_mm: 1\n"
                           "density_g_cm3: 2\nproperties:\n  youngs_modulus_MPa: 1000\n"
                           "  poissons_ratio: 0.4\n  yield_stress_MPa: 4\n"
                           "  strength_coefficient_MPa: 100\n  hardening_exponent: 0.5\n";

static const char bare[] = "name: bare\nwires: [{wire: type3}]\npacking: hexagon\nlength_mm: 85\n"
                           "interface: {cohesive_stiffness_N_mm3: 30, friction: 0.4}\n"
                           "loads: {weight: false}\n";

static void every_key_is_read(void **state)
{
    (void)state;
    read_text(full);
    assert_string_equal(model.name, "mine");
    assert_string_equal(model.title, "A title");
    assert_string_equal(model.notes, "Some notes");
    assert_string_equal(model.path, model_path);
    assert_close(model.length, 0.114, 1e-15);
    assert_int_equal(model.length_source, WB_BUNDLE_LENGTH_PRINTED);

    assert_int_equal(model.n_types, 2);
    assert_int_equal(model.packing.n, 7);
    assert_string_equal(model.type[0].name, "type3");
    assert_string_equal(model.type[1].name, "thin");
    assert_int_equal(wb_bundle_model_count(&model, 0), 6);
    assert_int_equal(wb_bundle_model_count(&model, 1), 1);
    assert_int_equal(model.type_of[2], 1);
    assert_int_equal(model.arrangement, WB_BUNDLE_HEXAGON);
    assert_string_equal(wb_bundle_model_arrangement(&model), "hexagon");
    assert_false(model.settled);
    assert_close(model.wire_gap, 0.02e-3, 1e-18);

    assert_true(model.has_tape);
    assert_close(model.tape.gap, 0.03e-3, 1e-18);
    assert_close(model.tape.material.material.youngs_modulus, 119e6, 1e-3);
    assert_close(model.tape.material.material.poissons_ratio, 0.4, 0.0);
    assert_int_equal(model.tape.taping.kind, WB_TAPING_SLEEVE);
    assert_close(wb_taping_thickness(&model.tape.taping), 0.4e-3, 1e-15);

    const struct wb_bundle_interface *const i = &model.interface;
    assert_close_relative(i->normal_stiffness, 30e9, 1e-12);
    assert_close_relative(i->shear_stiffness, 15e9, 1e-12);
    assert_true(i->has_damage);
    assert_close_relative(i->damage.strength, 2e6, 1e-12);
    assert_close_relative(i->damage.shear_strength, 1e6, 1e-12);
    assert_close_relative(i->damage.fracture_energy, 300.0, 1e-12);
    assert_close(i->friction.mu_static, 0.4, 0.0);
    assert_close(i->friction.mu_kinetic, 0.1, 0.0);
    assert_close_relative(i->friction.decay, 2000.0, 1e-12);
    assert_close(model.potted_length, 3e-3, 1e-15);
    assert_int_equal(model.tip, WB_BUNDLE_TIP_CAPPED);
}

static void meshes_run_and_loads_are_read(void **state)
{
    (void)state;
    read_text(full);
    assert_int_equal(model.n_meshes, 4);
    const struct wb_bundle_mesh *const fine = wb_bundle_model_mesh(&model, "fine");
    const struct wb_bundle_mesh *const rough = wb_bundle_model_mesh(&model, "rough");
    assert_true(fine->core_quads == 4 && fine->rings == 1 && fine->elements_along == 160);
    assert_int_equal(fine->formulation, WB_BUNDLE_FOUR_POINTS);
    assert_int_equal(rough->formulation, WB_BUNDLE_ONE_POINT);
    assert_int_equal(wb_bundle_model_tape_quads(&model, rough), 18);
    assert_null(wb_bundle_model_mesh(&model, "other"));

    const struct wb_bundle_run *const run = &model.run;
    assert_string_equal(run->mesh, "fine");
    assert_close(run->deflection, 0.04, 1e-15);
    assert_true(run->rows == 20 && run->cycles == 3);
    assert_true(run->double_precision);
    assert_close(run->duration, 2.0, 0.0);
    assert_close(run->mass_scaling, 4.0, 0.0);
    assert_close(run->selective, 100.0, 0.0);
    assert_close(run->kinetic_limit, 0.02, 0.0);
    assert_close(model.loads.strand_length, 0.76, 1e-15);
    assert_true(model.loads.weight);
    assert_true(model.has_published && model.published.has_beam);
    assert_close(model.published.outer_diameter, 4.6e-3, 1e-15);
    assert_close(model.published.density, 3430.0, 1e-9);
    assert_close(model.published.beam.material.youngs_modulus, 1114e6, 1e-3);
}

static void what_is_left_out_has_a_default(void **state)
{
    (void)state;
    read_text(bare);
    assert_string_equal(model.title, "");
    assert_false(model.has_tape || model.has_published || model.interface.has_damage);
    assert_int_equal(model.length_source, WB_BUNDLE_LENGTH_OWN);
    assert_close_relative(model.interface.shear_stiffness, 10e9, 1e-12);
    assert_close(model.interface.friction.mu_static, 0.4, 0.0);
    assert_close(model.interface.friction.mu_kinetic, 0.4, 0.0);
    assert_close(model.interface.friction.decay, 0.0, 0.0);
    assert_true(model.potted_length == 0.0 && model.tip == WB_BUNDLE_TIP_FREE);
    assert_string_equal(model.run.mesh, "engineering");
    assert_close(model.run.deflection, 0.053, 1e-15);
    assert_true(model.run.rows == 53 && model.run.cycles == 0 && model.run.duration == 0.0);
    assert_close(model.run.mass_scaling, 25.0, 0.0);
    assert_close(model.run.selective, 100.0, 0.0);
    assert_close(model.run.kinetic_limit, 0.05, 0.0);
    assert_true(model.loads.strand_length == 0.0 && !model.loads.weight);
    assert_int_equal(wb_bundle_model_tape_quads(&model, &model.mesh[0]), 0);

    read_shipped("7-type3");
    assert_close(model.tape.material.material.poissons_ratio, 0.35, 0.0);
}

static void shipped_meshes_have_the_hexahedra_they_are_named_for(void **state)
{
    (void)state;
    read_shipped("7-type3");
    const struct wb_bundle_mesh *mesh = wb_bundle_model_mesh(&model, "engineering");
    assert_int_equal(wb_bundle_model_section_quads(mesh), 12);
    assert_int_equal(wb_bundle_model_hexahedra(&model, mesh), 7 * 12 * 80);
    assert_int_equal(mesh->formulation, WB_BUNDLE_FOUR_POINTS);
    mesh = wb_bundle_model_mesh(&model, "paper");
    assert_int_equal(wb_bundle_model_section_quads(mesh), 84);
    assert_int_equal(wb_bundle_model_hexahedra(&model, mesh), 225792);
    assert_int_equal(mesh->formulation, WB_BUNDLE_ONE_POINT);
    /* As wide as those round a wire, or a little less. */
    for (int i = 0; i < 2; i++) {
        const int n = wb_bundle_model_tape_quads(&model, &model.mesh[i]);
        const double width = model.tape.taping.circumference / n;
        const double wire = M_PI * 1.4e-3 / (4 * model.mesh[i].core_quads);
        assert_int_equal(n % 6, 0);
        assert_true(width <= wire * (1.0 + 1e-6) && width > 0.75 * wire);
    }
}

/* --- packing --- */

static void gaps_widen_the_lattice_and_the_tape(void **state)
{
    (void)state;
    read_text(full);
    /* Pitch 1.42 mm; wires of 1.4 mm at the ends of the diameter; tape of 0.4 mm, 0.03 mm away. */
    assert_close(wb_packing_smallest_gap(&model.packing), 0.02e-3, 1e-15);
    assert_close(wb_bundle_model_diameter(&model), (2 * 1.42 + 1.4 + 2 * 0.43) * 1e-3, 1e-12);
}

static void read_changed(const char *source, const char *old, const char *new_text)
{
    char text[4096];
    replace(text, source, old, new_text);
    read_text(text);
}

static void listed_places_are_kept_round_their_circle(void **state)
{
    (void)state;
    read_changed(bare, "wires: [{wire: type3}]\npacking: hexagon",
                 "wires: [{wire: type3, count: 2}]\npacking: places\n"
                 "places_mm: [[1, 5], [1, 7]]");
    assert_close(model.packing.wire[0].y, 0.0, 1e-15);
    assert_close(model.packing.wire[0].z, -1e-3, 1e-15);
    assert_close(model.packing.wire[1].z, 1e-3, 1e-15);
    assert_close(wb_bundle_model_diameter(&model), 3.4e-3, 1e-15);

    read_changed(bare, "wires: [{wire: type3}]\npacking: hexagon",
                 "wires: [{wire: type3, count: 2}]\npacking: places\nsettled: true\n"
                 "places_mm: [[1, 5], [1, 5.5]]");
    assert_close(wb_bundle_model_diameter(&model), 2.8e-3, 1e-12);

    read_changed(bare, "wires: [{wire: type3}]\npacking: hexagon",
                 "wires: [{wire: type3, count: 2}]\npacking: places\ntouching_mm: 0.1\n"
                 "places_mm: [[1, 5], [1, 6.45]]");
    assert_close(wb_bundle_model_diameter(&model), 2.8e-3, 1e-12);
}

static void the_densest_packing_is_by_seed(void **state)
{
    (void)state;
    const char *const wires = "wires: [{wire: type3, count: 8}]\npacking: densest\n"
                              "search: {seed: 5, trials: 200}";
    read_changed(bare, "wires: [{wire: type3}]\npacking: hexagon", wires);
    assert_true(model.search.seed == 5 && model.search.trials == 200);
    assert_close_relative(wb_bundle_model_diameter(&model), 1.4e-3 * (1.0 + 1.0 / sin(M_PI / 7.0)),
                          1e-9);
    const struct wb_packing first = model.packing;
    read_changed(bare, "wires: [{wire: type3}]\npacking: hexagon", wires);
    assert_memory_equal(&first, &model.packing, sizeof first);
}

static void a_lopsided_hexagon_is_put_on_its_axis(void **state)
{
    (void)state;
    read_changed(bare, "wires: [{wire: type3}]", "wires: [{wire: type3, count: 6}, {wire: type1}]");
    const struct wb_packing_circle e = wb_packing_enclosing(7, model.packing.wire);
    assert_close(e.y, 0.0, 1e-15);
    assert_close(e.z, 0.0, 1e-15);
}

static const char stretchy[] = "name: stretchy\nsource: a test\nyoungs_modulus_MPa: 100\n"
                               "poissons_ratio: 0.45\nyield_stress_MPa: 2\nhardening: kinematic\n"
                               "strength_coefficient_MPa: 10\ndensity_g_cm3: 1.2\n"
                               "thickness_of_two_layers_mm: 0.3\n";

static void a_tape_of_ones_own_has_its_poissons_ratio(void **state)
{
    (void)state;
    char isotropic[4096];
    replace(isotropic, stretchy, "hardening: kinematic\nstrength_coefficient_MPa: 10\n", "");
    write_beside("plain.yaml", isotropic);
    read_changed(bare, "packing: hexagon", "packing: hexagon\ntape: ./plain.yaml");
    assert_close(model.tape.material.material.poissons_ratio, 0.45, 0.0);
    assert_close(wb_taping_thickness(&model.tape.taping), 0.3e-3, 1e-15);
    assert_close(model.tape.taping.circumference, M_PI * 1.7e-3, 1e-12);
}

static void shear_is_as_strong_unless_said_otherwise(void **state)
{
    (void)state;
    read_changed(full, "shear_strength_MPa: 1, ", "");
    assert_close_relative(model.interface.damage.shear_strength, 2e6, 1e-12);
}

static void a_helix_is_half_lapped(void **state)
{
    (void)state;
    read_changed(full, "{layout: sleeve, layers: 4, poissons_ratio: 0.4}",
                 "{layout: helix, width_mm: 9, hand: left}");
    const struct wb_taping *const taping = &model.tape.taping;
    assert_int_equal(taping->kind, WB_TAPING_HELIX);
    assert_close(taping->layers, 2.0, 0.0);
    assert_close(wb_taping_thickness(taping), 0.2e-3, 1e-18);
    assert_close(taping->helix.width, 9e-3, 1e-15);
    assert_int_equal(taping->helix.hand, -1);
    assert_close(taping->circumference, wb_hull_length(&model.tape.hull, model.tape.gap + 0.1e-3),
                 1e-15);
    assert_close(wb_bundle_model_rigidity(&model).tape[0], 0.0, 0.0);
}

static double fact(int n, const char *key)
{
    for (int i = 0; i < n; i++)
        if (strcmp(facts[i].key, key) == 0)
            return facts[i].value;
    fail_msg("no fact %s", key);
    return 0.0;
}

static void a_tape_on_a_circle_is_bonded_along_lines(void **state)
{
    (void)state;
    read_changed(bare, "wires: [{wire: type3}]\npacking: hexagon\nlength_mm: 85\n",
                 "wires: [{wire: type3, count: 7}]\npacking: hexagon\nlength_mm: 85\ntape: tape\n"
                 "taping: {layout: sleeve, outline: circle, bond_reach_mm: 0.02}\n");
    assert_true(model.tape.round);
    assert_close_relative(model.tape.reach, 0.02e-3, 1e-12);
    const int n = wb_bundle_model_facts(&model, facts);
    assert_close(fact(n, "wires_at_tape"), 6.0, 0.0);
    /* Cosine rule: the circle's radius, the way between centres, a wire's radius with reach. */
    const double half = acos((2.1 * 2.1 + 1.4 * 1.4 - 0.72 * 0.72) / (2.0 * 2.1 * 1.4));
    assert_close(fact(n, "bonded_length_mm"), 12.0 * 2.1 * half, 0.01);
}

/* Three of twelve are in the middle of straight sides: the tape touches them along lines. What is
 * nearer than 1 nm touches. */
static void wires_that_the_tape_touches_in_passing_are_bonded_by_a_reach(void **state)
{
    (void)state;
    read_shipped("12-type3");
    int n = wb_bundle_model_facts(&model, facts);
    assert_close(fact(n, "bonded_length_mm"),
                 1.4 * M_PI + 18.0 * sqrt(0.700001 * 0.700001 - 0.7 * 0.7), 0.005);
    read_shipped("12-type3-wider-bond");
    n = wb_bundle_model_facts(&model, facts);
    assert_close(fact(n, "wires_at_tape"), 9.0, 0.0);
    assert_close(fact(n, "bonded_length_mm"), 1.4 * M_PI + 18.0 * sqrt(0.705 * 0.705 - 0.7 * 0.7),
                 0.02);
}

/* --- homogenised --- */

/* Table 4, with its diameters; the tape's mass was inferred from the same table. */
static void densities_are_those_of_table_4(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double diameter, density;
    } rows[] = {{"7-type3", 4.6e-3, 3430.0},
                {"12-type3", 5.8e-3, 3650.0},
                {"19-type3", 7.4e-3, 3500.0},
                {"19-mixed", 7.4e-3, 3000.0},
                {"27-type3", 9.2e-3, 3200.0}};
    for (size_t i = 0; i < WB_COUNT(rows); i++) {
        read_shipped(rows[i].name);
        assert_close(model.published.outer_diameter, rows[i].diameter, 1e-15);
        assert_close(model.published.density, rows[i].density, 1e-9);
        const double density = wb_bundle_model_density(&model, rows[i].diameter);
        print_message("%s: %.3f g/cm3 over %.1f mm, printed %.2f; own diameter %.3f mm\n",
                      rows[i].name, density / 1e3, rows[i].diameter * 1e3, rows[i].density / 1e3,
                      wb_bundle_model_diameter(&model) * 1e3);
        assert_close_relative(density, rows[i].density, 0.005);
    }
}

static void diameters_are_those_of_the_notes(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double diameter;
    } rows[] = {{"7-type3", 4.6e-3},
                {"12-type3", (1.4 * (1.0 + 2.0 * 1.5275252316519468) + 0.4) * 1e-3},
                {"19-type3", 7.4e-3},
                {"19-mixed", 7.4e-3},
                {"27-type3", (1.4 * (1.0 + 2.0 * 2.516611478423583) + 0.4) * 1e-3}};
    for (size_t i = 0; i < WB_COUNT(rows); i++) {
        read_shipped(rows[i].name);
        assert_close(wb_bundle_model_diameter(&model), rows[i].diameter, 1e-12);
    }
}

/* Seven wires by hand: A = pi d^2 / 4, I = pi d^4 / 64, six of them at the distance d. */
static void rigidity_of_seven_wires_by_hand(void **state)
{
    (void)state;
    const double d = 1.4e-3, E = 4528e6, A = M_PI * d * d / 4.0, I = M_PI * pow(d, 4.0) / 64.0;
    read_changed(bare, "wires: [{wire: type3}]", "wires: [{wire: type3, count: 7}]");
    struct wb_bundle_rigidity r = wb_bundle_model_rigidity(&model);
    assert_close_relative(r.wires, 7.0 * E * I, 1e-12);
    for (int k = 0; k < 2; k++) {
        assert_close(r.tape[k], 0.0, 0.0);
        assert_close_relative(r.sliding[k], 7.0 * E * I, 1e-12);
        assert_close_relative(r.bonded[k], E * (7.0 * I + 3.0 * A * d * d), 1e-12);
    }

    /* The tape: a thin tube between two offsets of the hexagon, by points on its middle. */
    read_shipped("7-type3");
    r = wb_bundle_model_rigidity(&model);
    double second = 0.0;
    const double round = model.tape.taping.circumference;
    for (int i = 0; i < 10000; i++) {
        const struct wb_hull_point p =
            wb_hull_at(&model.tape.hull, 0.1e-3, round * (i + 0.5) / 10000.0);
        second += p.y * p.y * round / 10000.0;
    }
    for (int k = 0; k < 2; k++) {
        assert_close_relative(r.tape[k], 119e6 * 0.2e-3 * second, 1e-5);
        assert_close_relative(r.sliding[k], r.wires + r.tape[k], 1e-12);
        assert_close_relative(r.bonded[k], E * (7.0 * I + 3.0 * A * d * d) + r.tape[k], 1e-12);
    }
}

/* Of two different wires one above the other the neutral axis is not in the middle. */
static void bonded_wires_bend_about_their_neutral_axis(void **state)
{
    (void)state;
    read_changed(bare, "wires: [{wire: type3}]\npacking: hexagon",
                 "wires: [{wire: type3}, {wire: ./thin.yaml}]\npacking: places\n"
                 "places_mm: [[0, 0], [2, 0]]");
    const double EA = 4528e6 * M_PI * 1.4e-3 * 1.4e-3 / 4.0, ea = 1000e6 * M_PI * 1e-6 / 4.0;
    const double EI = 4528e6 * M_PI * pow(1.4e-3, 4.0) / 64.0, ei = 1000e6 * M_PI * 1e-12 / 64.0;
    const struct wb_bundle_rigidity r = wb_bundle_model_rigidity(&model);
    /* Parallel axes: the reduced stiffness times the distance squared. */
    assert_close_relative(r.bonded[0], EI + ei + EA * ea / (EA + ea) * 4e-6, 1e-12);
    assert_close_relative(r.bonded[1], EI + ei, 1e-12);
}

/* Table 5's rigidities lie between wires that slide and wires that do not. */
static void published_rigidities_lie_between_the_bounds(void **state)
{
    (void)state;
    static const char *const names[] = {"7-type3", "12-type3", "19-type3", "19-mixed", "27-type3"};
    for (size_t i = 0; i < WB_COUNT(names); i++) {
        read_shipped(names[i]);
        const struct wb_bundle_rigidity r = wb_bundle_model_rigidity(&model);
        const struct wb_wire *const beam = &model.published.beam;
        const double EI = beam->material.youngs_modulus * wb_wire_second_moment(beam);
        assert_true(r.wires < r.sliding[0] && r.sliding[0] < EI && EI < r.bonded[0]);
        /* All are alike in every direction: at least three-fold symmetric. */
        assert_close_relative(r.sliding[1], r.sliding[0], 1e-9);
        assert_close_relative(r.bonded[1], r.bonded[0], 1e-9);
    }
}

static void facts_are_in_the_units_of_their_keys(void **state)
{
    (void)state;
    read_shipped("7-type3");
    int n = wb_bundle_model_facts(&model, facts);
    assert_close(fact(n, "outer_diameter_mm"), 4.6, 1e-9);
    assert_close(fact(n, "wires_circle_mm"), 4.2, 1e-9);
    assert_close(fact(n, "filled_percent"), 700.0 / 9.0, 1e-9);
    assert_close(fact(n, "touching_pairs"), 12.0, 0.0);
    assert_close(fact(n, "wires_at_tape"), 6.0, 0.0);
    /* Arcs of 60 degrees, and what is nearer than 1 nm beside them. */
    const double arc = 1.4 / 2.0 * (M_PI / 3.0) + 2.0 * sqrt(0.700001 * 0.700001 - 0.7 * 0.7);
    assert_close(fact(n, "bonded_length_mm"), 6.0 * arc, 0.005);
    assert_close(fact(n, "tape_length_round_mm"), 1.4 * (6.0 + M_PI) + 0.2 * M_PI, 1e-9);
    assert_close(fact(n, "tape_thickness_mm"), 0.2, 1e-12);
    assert_close(fact(n, "tape_mass_g_m"), 0.25 * (1.4 * (6.0 + M_PI) + 0.2 * M_PI), 1e-9);
    assert_close(fact(n, "mass_g_m") - fact(n, "tape_mass_g_m"), 7.0 * 4.97 * M_PI * 0.49, 1e-9);
    assert_close_relative(fact(n, "density_g_cm3"), 3.43, 0.005);
    assert_close(fact(n, "published_density_g_cm3"), 3.43, 1e-12);
    assert_close_relative(fact(n, "wires_EI_N_mm2"), 7.0 * 4528.0 * M_PI * pow(1.4, 4.0) / 64.0,
                          1e-12);
    assert_close_relative(fact(n, "published_EI_N_mm2"), 1114.0 * M_PI * pow(4.6, 4.0) / 64.0,
                          1e-12);
    assert_close(fact(n, "published_youngs_modulus_MPa"), 1114.0, 1e-9);
    for (int i = 0; i < n; i++)
        assert_true(isfinite(facts[i].value) && strlen(facts[i].text) > 0);

    /* No tape, nothing published: no such facts. */
    read_text(bare);
    n = wb_bundle_model_facts(&model, facts);
    for (int i = 0; i < n; i++)
        assert_true(!strstr(facts[i].key, "tape_") && !strstr(facts[i].key, "published"));
}

/* --- refusals --- */

static void refuse(const char *source, const char *old, const char *new_text, const char *expected)
{
    char text[4096];
    replace(text, source, old, new_text);
    if (try_text(text) == WB_OK)
        fail_msg("'%s' is not refused", new_text);
    assert_message(expected);
    assert_int_equal(kept.n, 1);
    assert_message("model.yaml");
}

static void wrong_wires_are_refused(void **state)
{
    (void)state;
    refuse(full, "name: mine", "name: my bundle", ":1: name: ");
    refuse(full, "wire: type3, count: 2", "wire: nothing, count: 2", ":5: wire: ");
    refuse(full, "count: 2}", "count: 0}", ":5: count: ");
    refuse(full, "count: 4}", "count: 128}", ":7: count: more than 128");
    refuse(full, "count: 4}", "counts: 4}", ":7: counts: ");
    refuse(bare, "[{wire: type3}]", "[]", ":2: wires: ");
    write_beside("plain.yaml", "name: plain\nconductor_diameter_mm: 0.5\nouter_diameter_mm: 1\n"
                               "density_g_cm3: 2\n");
    refuse(full, "./thin.yaml", "./plain.yaml", ":6: wire: wire plain has no properties");
    char other[4096];
    replace(other, thin, "name: thin", "name: type3");
    write_beside("plain.yaml", other);
    refuse(full, "./thin.yaml", "./plain.yaml",
           ":6: wire: another, different wire has the name type3");
}

static void wrong_packings_are_refused(void **state)
{
    (void)state;
    refuse(full, "packing: hexagon", "packing: round", ":8: packing: ");
    refuse(full, "count: 4}", "count: 5}",
           ":8: packing: 8 wires do not fill a hexagon; 7 or 19 do");
    refuse(full, "packing: hexagon", "packing: triangle",
           ":8: packing: 7 wires do not fill a triangle; 6 or 12 do");
    refuse(bare, "packing: hexagon", "packing: triangle",
           ":3: packing: 1 wires do not fill a triangle; the smallest has 3");
    refuse(full, "packing: hexagon", "packing: places", "places_mm: this key is missing");
    refuse(full, "packing: hexagon", "packing: hexagon\nplaces_mm: [[0, 0]]", ":9: places_mm: ");
    refuse(full, "packing: hexagon", "packing: hexagon\nsearch: {seed: 1}", ":9: search: ");
    refuse(full, "packing: hexagon", "packing: densest", ":9: settled: ");
    refuse(full, "settled: false", "touching_mm: 0.1", ":9: touching_mm: ");
    refuse(full, "wires_mm: 0.02", "wires_mm: -0.02", ":10: wires_mm: ");
    refuse(bare, "packing: hexagon", "packing: places\nplaces_mm: [[0, 0], [1, 0]]",
           ":4: places_mm: expected a list of 1 places [up, right]");
    refuse(bare, "packing: hexagon", "packing: places\nplaces_mm: [[0, 0, 0]]", ":4: places_mm: ");
    refuse(bare, "packing: hexagon", "packing: places\nplaces_mm: [[0, 0]]\ngaps: {wires_mm: 0.1}",
           ":5: wires_mm: ");
    refuse(bare, "wires: [{wire: type3}]\npacking: hexagon",
           "wires: [{wire: type3, count: 2}]\npacking: places\nplaces_mm: [[0, 0], [1, 0]]",
           ":4: places_mm: two wires overlap by 0.4 mm");
}

static void wrong_tapes_are_refused(void **state)
{
    (void)state;
    refuse(full, "tape: tape\n", "tape: pvc\n", ":11: tape: material pvc has no thickness");
    write_beside("plain.yaml", stretchy);
    refuse(full, "tape: tape\n", "tape: ./plain.yaml\n", ":11: tape: material stretchy hardens");
    refuse(full, "tape: tape\n", "tape: nothing\n", ":11: tape: ");
    refuse(full, "tape: tape\n", "", ":11: taping: the bundle has no tape");
    refuse(bare, "packing: hexagon", "packing: hexagon\ngaps: {tape_mm: 0.1}", ":4: gaps: ");
    refuse(full, "layout: sleeve", "layout: spiral", ":12: layout: ");
    refuse(full, "layers: 4", "layers: 0", ":12: layers: ");
    refuse(full, "layers: 4", "width_mm: 9", ":12: width_mm: only with layout: helix");
    refuse(full, "layers: 4", "lap_percent: 50", ":12: lap_percent: only with layout: helix");
    refuse(full, "layers: 4", "hand: left", ":12: hand: only with layout: helix");
    refuse(full, "sleeve, layers: 4", "helix, layers: 4, width_mm: 9", ":12: layers: ");
    refuse(full, "sleeve, layers: 4", "helix", ":12: width_mm: this key is missing");
    refuse(full, "sleeve, layers: 4", "helix, width_mm: 30", ":12: width_mm: a tape 30 mm wide");
    refuse(full, "poissons_ratio: 0.4", "poissons_ratio: 0.5", ":12: poissons_ratio: ");
    refuse(full, "layers: 4", "outline: circle", ":12: bond_reach_mm: this key is missing");
}

static void wrong_interfaces_are_refused(void **state)
{
    (void)state;
    refuse(full, "cohesive_stiffness_N_mm3: 30", "cohesive_stiffness_N_mm3: 0",
           ":16: cohesive_stiffness_N_mm3: ");
    refuse(full, "ness: 0.5", "ness: 0", ":17: shear_to_normal_stiffness: ");
    /* 2 MPa are reached at 2/30 mm: 0.0667 N/mm; 1 MPa in shear at 1/15 mm: 0.0333 N/mm. */
    refuse(full, "fracture_energy_N_mm: 0.3", "fracture_energy_N_mm: 0.066",
           ":18: fracture_energy_N_mm: 0.066 N/mm is not more than the 0.0666667 N/mm");
    refuse(full, "shear_strength_MPa: 1, fracture_energy_N_mm: 0.3",
           "shear_strength_MPa: 5, fracture_energy_N_mm: 0.3", ":18: fracture_energy_N_mm: ");
    refuse(full, "kinetic: 0.1", "kinetic: 0.5",
           ":19: kinetic: 0.5 is more than the static one, 0.4");
    refuse(full, "decay_s_mm: 2", "decay: 2", ":19: decay: ");
    refuse(full, "static: 0.4, ", "", ":19: static: this key is missing");
    refuse(full, "{static: 0.4, kinetic: 0.1, decay_s_mm: 2}", "-0.1", ":19: friction: ");
    refuse(bare, ", friction: 0.4", "", ":5: friction: this key is missing");
}

static void wrong_runs_are_refused(void **state)
{
    (void)state;
    refuse(full, "potted_mm: 3", "potted_mm: 57", ":20: potted_mm: 57 mm is not less than half");
    refuse(full, "tip: capped", "tip: loose", ":20: tip: ");
    refuse(full, "name: fine", "name: paper", ":22: name: another mesh has the name paper");
    refuse(full, "core_quads: 4", "core_quads: 3", ":22: core_quads: 3 is not even");
    refuse(full, "elements_along: 40", "elements_along: 1", ":23: elements_along: ");
    refuse(full, "one-point", "two-points", ":23: formulation: ");
    refuse(full, "mesh: fine", "mesh: finer", ":25: mesh: there is no mesh finer");
    refuse(full, "deflection_mm: 40", "deflection_mm: 114", ":26: deflection_mm: ");
    refuse(bare, "length_mm: 85", "length_mm: 50", "deflection_mm: 53 mm cannot be reached");
    refuse(full, "mass_scaling: 4", "mass_scaling: 0.5", ":30: mass_scaling: ");
    refuse(full, "selective_mass_scaling: 100", "selective_mass_scaling: 0",
           ":31: selective_mass_scaling: ");
    refuse(full, "kinetic_energy_limit: 0.02", "kinetic_energy_limit: 2",
           ":32: kinetic_energy_limit: ");
    refuse(full, "precision: double", "precision: half", ":33: precision: ");
    refuse(full, ", weight: true", "", ":34: weight: this key is missing");
    refuse(full, "beam: bundle-7", "beam: nothing", ":35: beam: ");
    refuse(full, "length_mm: 114", "length_mm: 114 mm", ":13: length_mm: ");
    refuse(full, "length_source: printed", "length_source: guessed", ":14: length_source: ");
}

static int set_up(void **state)
{
    if (make_folder(state) != 0)
        return -1;
    snprintf(model_path, sizeof model_path, "%s/model.yaml", folder);
    write_beside("thin.yaml", thin);
    return 0;
}

static int tear_down(void **state)
{
    static const char *const names[] = {"model.yaml", "thin.yaml", "plain.yaml", "thick.yaml"};
    (void)state;
    for (size_t i = 0; i < WB_COUNT(names); i++) {
        char path[128];
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        unlink(path);
    }
    return rmdir(folder);
}

/* --- what is uncertain, variants, scales --- */

static const char known_badly[] = "name: b\n"
                                  "wires: [{wire: type3, count: 7}]\n"
                                  "packing: hexagon\n"
                                  "tape: tape\n"
                                  "length_mm: 114\n"
                                  "interface: {cohesive_stiffness_N_mm3: 30, friction: 0.2}\n"
                                  "loads: {weight: true}\n";
static const char how_badly[] =
    "uncertainty:\n"
    "  wires:\n"
    "    - {wire: type3, properties: p.yaml}\n"
    "  diameter_percent: 1\n"
    "  pitch_percent: 2\n"
    "  length_percent: 3\n"
    "  tape: {thickness_percent: 4, youngs_modulus_percent: 5, yield_stress_percent: 6}\n"
    "  cohesive_stiffness_N_mm3: [10, 40]\n"
    "  friction: [0.1, 0.4]\n"
    "  scenarios:\n"
    "    - {name: a, layers: 3, overlap_percent: 50}\n"
    "    - {name: b, packing: densest, wires: 5, outline: circle, bond_reach_mm: 0.01}\n";

static void every_key_of_uncertainty_is_read(void **unused)
{
    (void)unused;
    char text[4096], path[WB_PATH];
    read_text(known_badly);
    assert_false(model.has_uncertainty);
    snprintf(text, sizeof text, "%s%s", known_badly, how_badly);
    read_text(text);
    const struct wb_bundle_uncertainty *const u = &model.uncertainty;
    assert_true(model.has_uncertainty && u->has_tape && u->has_cohesion && u->has_friction);
    snprintf(path, sizeof path, "%s/p.yaml", folder);
    assert_int_equal(u->n_wires, 1);
    assert_string_equal(u->wire[0].properties, path);
    assert_false(u->wire[0].has_tolerances);
    assert_int_equal(u->wire[0].line, 10);
    const double values[] = {u->diameter,       u->pitch,        u->length,
                             u->tape_thickness, u->tape_modulus, u->tape_yield_stress};
    for (int i = 0; i < 6; i++)
        assert_close(values[i], 0.01 * (i + 1), 1e-15);
    assert_close_relative(u->cohesion[0], 10e9, 1e-12);
    assert_close_relative(u->cohesion[1], 40e9, 1e-12);
    assert_close(u->friction[0], 0.1, 0.0);
    assert_close(u->friction[1], 0.4, 0.0);
    assert_int_equal(u->n_scenarios, 2);
    assert_int_equal(u->scenario[0].layers, 3);
    assert_close(u->scenario[0].lap, 0.5, 1e-15);
    assert_int_equal(u->scenario[1].packing, WB_BUNDLE_DENSEST);
    assert_int_equal(u->scenario[1].wires, 5);
    assert_true(u->scenario[1].has_outline && u->scenario[1].outline == 1);
    assert_close(u->scenario[1].reach, 1e-5, 1e-18);
}

static void wrong_uncertainties_are_refused(void **unused)
{
    (void)unused;
    static const char *const wrong[][3] = {
        {"pitch_percent: 2", "pitch_percent: 51", "model.yaml:12: pitch_percent"},
        {"friction: [0.1, 0.4]", "friction: [0.4, 0.1]", "expected [least, largest]"},
        {"friction: [0.1, 0.4]", "friction: [0, 0.1]", "friction"},
        {"name: b, packing", "name: a, packing", "another scenario has the name a"},
        {", bond_reach_mm: 0.01", "", "must be given together"},
        {"packing: densest", "packing: places", "packing"},
        {"- {wire: type3, properties: p.yaml}", "- {wire: type3}", "expected properties: FILE"},
    };
    char whole[4096], text[4096];
    snprintf(whole, sizeof whole, "%s%s", known_badly, how_badly);
    for (size_t i = 0; i < WB_COUNT(wrong); i++) {
        replace(text, whole, wrong[i][0], wrong[i][1]);
        assert_int_not_equal(try_text(text), WB_OK);
        assert_message(wrong[i][2]);
    }
}

static enum wb_status try_variant(const struct wb_bundle_variant *variant)
{
    keep_messages();
    const enum wb_status status = wb_bundle_model_read_variant(&model, model_path, variant);
    release_messages();
    return status;
}

static void variants_are_read_as_if_the_file_said_so(void **unused)
{
    (void)unused;
    const struct wb_bundle_variant more = {.name = "more", .wires = 12, .layers = 1};
    const struct wb_bundle_variant round = {
        .name = "round", .has_outline = true, .outline = 1, .has_reach = true, .reach = 1e-5};
    char text[4096];
    read_text(known_badly);
    assert_int_equal(try_variant(&more), WB_OK);
    const double diameter = wb_bundle_model_diameter(&model);
    assert_int_equal(model.packing.n, 12);
    assert_int_equal(model.arrangement, WB_BUNDLE_TRIANGLE);
    replace(text, known_badly, "count: 7", "count: 12");
    snprintf(text + strlen(text), sizeof text - strlen(text),
             "taping: {layout: sleeve, layers: 1}\n");
    char own[4096];
    replace(own, text, "packing: hexagon", "packing: triangle");
    read_text(own);
    assert_close(wb_bundle_model_diameter(&model), diameter, 0.0);
    read_text(known_badly);
    assert_int_equal(try_variant(&round), WB_OK);
    assert_true(model.tape.round);
    assert_close(model.tape.reach, 1e-5, 0.0);
    /* What a variant cannot change. */
    replace(text, known_badly, "tape: tape\n", "");
    read_text(text);
    assert_int_not_equal(try_variant(&round), WB_OK);
    assert_message("variant round");
    replace(text, known_badly, "[{wire: type3, count: 7}]",
            "[{wire: type3, count: 4}, {wire: type2, count: 3}]");
    read_text(text);
    assert_int_not_equal(try_variant(&more), WB_OK);
    assert_message("wires: variant more: 12 wires");
}

/* The same as a file with thicker wires; a pitch of its own leaves the wires as they are. */
static void a_scaled_model_is_that_of_a_file_with_other_lengths(void **unused)
{
    (void)unused;
    const struct wb_bundle_scales wider = {1.1, 1.0, 1.5}, apart = {1.0, 1.02, 1.0};
    static struct wb_bundle_model scaled;
    char text[4096];
    read_text(known_badly);
    scaled = model;
    wb_bundle_model_scale(&scaled, &wider);
    write_beside("thick.yaml", "name: thick\nconductor_diameter_mm: 1.1\nouter_diameter_mm: 1.54\n"
                               "density_g_cm3: 4.97\nproperties: {source: x, youngs_modulus_MPa: "
                               "4528, poissons_ratio: 0.39, yield_stress_MPa: 4.52, "
                               "strength_coefficient_MPa: 1327, hardening_exponent: 0.90}\n");
    replace(text, known_badly, "wire: type3", "wire: thick.yaml");
    char thicker[4096];
    replace(thicker, text, "tape: tape\n", "tape: tape\ntaping: {layout: sleeve, layers: 3}\n");
    read_text(thicker);
    const struct wb_bundle_rigidity one = wb_bundle_model_rigidity(&scaled),
                                    other = wb_bundle_model_rigidity(&model);
    assert_close_relative(one.wires, other.wires, 1e-12);
    assert_close_relative(one.bonded[0], other.bonded[0], 1e-12);
    assert_close_relative(wb_bundle_model_tape_mass(&scaled), wb_bundle_model_tape_mass(&model),
                          1e-12);
    assert_close_relative(wb_bundle_model_diameter(&scaled), wb_bundle_model_diameter(&model),
                          1e-12);
    read_text(known_badly);
    const double tape = wb_bundle_model_tape_mass(&model);
    const struct wb_bundle_rigidity before = wb_bundle_model_rigidity(&model);
    const double EA_y2 = before.bonded[0] - before.wires - before.tape[0];
    wb_bundle_model_scale(&model, &apart);
    const struct wb_bundle_rigidity after = wb_bundle_model_rigidity(&model);
    assert_close_relative(after.wires, before.wires, 1e-12);
    assert_close_relative(after.bonded[0] - after.wires - after.tape[0], 1.02 * 1.02 * EA_y2, 1e-9);
    assert_true(wb_bundle_model_tape_mass(&model) > 1.018 * tape);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_key_is_read),
        cmocka_unit_test(meshes_run_and_loads_are_read),
        cmocka_unit_test(what_is_left_out_has_a_default),
        cmocka_unit_test(shipped_meshes_have_the_hexahedra_they_are_named_for),
        cmocka_unit_test(gaps_widen_the_lattice_and_the_tape),
        cmocka_unit_test(listed_places_are_kept_round_their_circle),
        cmocka_unit_test(the_densest_packing_is_by_seed),
        cmocka_unit_test(a_lopsided_hexagon_is_put_on_its_axis),
        cmocka_unit_test(a_tape_of_ones_own_has_its_poissons_ratio),
        cmocka_unit_test(shear_is_as_strong_unless_said_otherwise),
        cmocka_unit_test(a_helix_is_half_lapped),
        cmocka_unit_test(a_tape_on_a_circle_is_bonded_along_lines),
        cmocka_unit_test(wires_that_the_tape_touches_in_passing_are_bonded_by_a_reach),
        cmocka_unit_test(densities_are_those_of_table_4),
        cmocka_unit_test(diameters_are_those_of_the_notes),
        cmocka_unit_test(rigidity_of_seven_wires_by_hand),
        cmocka_unit_test(bonded_wires_bend_about_their_neutral_axis),
        cmocka_unit_test(published_rigidities_lie_between_the_bounds),
        cmocka_unit_test(facts_are_in_the_units_of_their_keys),
        cmocka_unit_test(wrong_wires_are_refused),
        cmocka_unit_test(wrong_packings_are_refused),
        cmocka_unit_test(wrong_tapes_are_refused),
        cmocka_unit_test(wrong_interfaces_are_refused),
        cmocka_unit_test(wrong_runs_are_refused),
        cmocka_unit_test(every_key_of_uncertainty_is_read),
        cmocka_unit_test(wrong_uncertainties_are_refused),
        cmocka_unit_test(variants_are_read_as_if_the_file_said_so),
        cmocka_unit_test(a_scaled_model_is_that_of_a_file_with_other_lengths),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
