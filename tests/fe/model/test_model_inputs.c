/* What a dataset keeps of the model it was computed of: every value that decides a number, and none
 * that does not. */
#include "tests/messages.h"
#include "tests/own_folder.h"

#include <stdlib.h>

#include "base/file.h"
#include "fe/model/model_inputs.h"

static const char *in_own_folder(const char *name)
{
    static char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static void write_beside(const char *name, const char *text)
{
    assert_int_equal(wb_file_write(in_own_folder(name), text, strlen(text)), WB_OK);
}

/* A copy with one part changed; `text` has room for 4096 bytes. */
static void replace(char *text, const char *source, const char *old, const char *new_text)
{
    const char *const at = strstr(source, old);
    if (!at)
        fail_msg("no '%s'", old);
    snprintf(text, 4096, "%.*s%s%s", (int)(at - source), source, new_text, at + strlen(old));
}

/* A way to change a file, and where that shows in the inputs; NULL: nowhere. */
struct change {
    const char *old, *new_text, *shows;
};

typedef struct wb_json *take_inputs(const char *text);

/* On a difference: where and what. */
static bool is_same(const struct wb_json *before, const struct wb_json *after, char problem[400])
{
    struct wb_json_difference found;
    if (!wb_json_differs(before, after, 1e-9, NULL, &found))
        return true;
    snprintf(problem, 400, "%s is %s in it, and %s is wanted", found.first.place, found.first.a,
             found.first.b);
    return false;
}

static void look_at_changes(take_inputs *take, const char *whole, const struct change *changes,
                            size_t n)
{
    char text[4096], problem[400];
    struct wb_json *const before = take(whole);
    for (size_t i = 0; i < n; i++) {
        replace(text, whole, changes[i].old, changes[i].new_text);
        struct wb_json *const after = take(text);
        snprintf(problem, sizeof problem, "nothing");
        const bool same = is_same(before, after, problem);
        const char *const shows = changes[i].shows;
        if (same != !shows || (shows && strncmp(problem, shows, strlen(shows)) != 0))
            fail_msg("'%s' for '%s': %s", changes[i].new_text, changes[i].old, problem);
        char one[WB_SHA256_TEXT], other[WB_SHA256_TEXT];
        wb_model_inputs_sum(before, one);
        wb_model_inputs_sum(after, other);
        assert_true((strcmp(one, other) == 0) == same);
        wb_json_destroy(after);
    }
    wb_json_destroy(before);
}

/* --- bundles --- */

static const char thin[] = "name: thin\nconductor_diameter_mm: 0.5\nouter_diameter_mm: 1\n"
                           "density_g_cm3: 2\nproperties:\n  source: here\n"
                           "  youngs_modulus_MPa: 1000\n"
                           "  poissons_ratio: 0.4\n  yield_stress_MPa: 4\n"
                           "  strength_coefficient_MPa: 100\n  hardening_exponent: 0.5\n";

static const char bundle[] =
    "name: mine\ntitle: A title\nwires: [{wire: type3, count: 6}, {wire: ./thin.yaml}]\n"
    "packing: hexagon\nsettled: false\ngaps: {wires_mm: 0.02, tape_mm: 0.03}\n"
    "tape: tape\ntaping: {layout: sleeve, layers: 4, poissons_ratio: 0.4, bond_reach_mm: 0.01}\n"
    "length_mm: 114\ninterface:\n  cohesive_stiffness_N_mm3: 30\n"
    "  shear_to_normal_stiffness: 0.5\n"
    "  damage: {strength_MPa: 2, shear_strength_MPa: 1, fracture_energy_N_mm: 0.3}\n"
    "  friction: {static: 0.4, kinetic: 0.1, decay_s_mm: 2}\n"
    "ends: {potted_mm: 3, tip: free}\n"
    "meshes:\n  - {name: fine, core_quads: 4, rings: 1, elements_along: 160, tape_quads: 36}\n"
    "run: {mesh: fine, deflection_mm: 40, rows: 20, cycles: 3, duration_s: 2, mass_scaling: 4, "
    "selective_mass_scaling: 100, kinetic_energy_limit: 0.02, precision: double}\n"
    "loads: {strand_mm: 760, weight: true}\n";

static struct wb_json *take_bundle(const char *text, bool is_explicit)
{
    static struct wb_bundle_model model;
    write_beside("bundle.yaml", text);
    assert_int_equal(wb_bundle_model_read(&model, in_own_folder("bundle.yaml")), WB_OK);
    struct wb_json *const inputs = wb_json_create();
    wb_model_inputs_bundle(inputs, &model,
                           is_explicit ? wb_bundle_model_mesh(&model, model.run.mesh) : NULL);
    return inputs;
}

static struct wb_json *take_explicit(const char *text)
{
    return take_bundle(text, true);
}

static struct wb_json *take_section(const char *text)
{
    return take_bundle(text, false);
}

static void every_value_of_a_bundle_shows(void **unused)
{
    (void)unused;
    static const struct change changes[] = {
        {"count: 6}, {wire: ./thin.yaml}", "count: 7}", "wires is a list of 2"},
        {"packing: hexagon\nsettled: false", "packing: densest", "places[0] is 'wire 1 at"},
        {"wires_mm: 0.02", "wires_mm: 0.021", "places"},
        {"tape_mm: 0.03", "tape_mm: 0.04", "tape.gap_mm is 0.03 in it, and 0.04 is wanted"},
        {"layers: 4", "layers: 3", "tape.layers is 4"},
        {"poissons_ratio: 0.4,", "poissons_ratio: 0.41,", "tape.poissons_ratio"},
        {"bond_reach_mm: 0.01", "bond_reach_mm: 0.01, outline: circle", "tape.outline is 'hull'"},
        {"bond_reach_mm: 0.01", "bond_reach_mm: 0.02", "tape.bond_reach_mm"},
        {"layout: sleeve, layers: 4", "layout: helix, width_mm: 6, lap_percent: 50", "tape."},
        {"length_mm: 114", "length_mm: 114.001", "length_mm is 114 in it, and 114.001 is wanted"},
        {"mm3: 30", "mm3: 31", "interface.cohesive_stiffness_N_mm3"},
        {"stiffness: 0.5", "stiffness: 0.6", "interface.shear_stiffness_N_mm3"},
        {"strength_MPa: 2", "strength_MPa: 2.1", "interface.strength_MPa"},
        {"shear_strength_MPa: 1", "shear_strength_MPa: 1.1", "interface.shear_strength_MPa"},
        {"energy_N_mm: 0.3", "energy_N_mm: 0.4", "interface.fracture_energy_N_mm"},
        {"static: 0.4", "static: 0.5", "interface.friction.static"},
        {"kinetic: 0.1", "kinetic: 0.2", "interface.friction.kinetic"},
        {"decay_s_mm: 2", "decay_s_mm: 3", "interface.friction.decay_s_mm"},
        {"potted_mm: 3", "potted_mm: 4", "potted_mm"},
        {"tip: free", "tip: capped", "tip is 'free' in it, and 'capped' is wanted"},
        {"core_quads: 4", "core_quads: 6", "mesh.core_quads"},
        {"rings: 1", "rings: 2", "mesh.rings"},
        {"elements_along: 160", "elements_along: 161", "mesh.elements_along"},
        {"tape_quads: 36", "tape_quads: 42", "mesh.tape_quads"},
        {"tape_quads: 36", "tape_quads: 36, formulation: one-point", "mesh.formulation"},
        {"mesh: fine,", "mesh: paper,", "mesh."},
        {"deflection_mm: 40", "deflection_mm: 41", "run.deflection_mm"},
        {"rows: 20", "rows: 21", "run.rows"},
        {"cycles: 3", "cycles: 2", "run.cycles"},
        {"duration_s: 2", "duration_s: 3", "run.duration_s"},
        {" mass_scaling: 4", " mass_scaling: 5", "run.mass_scaling"},
        {"selective_mass_scaling: 100", "selective_mass_scaling: 99", "run.selective_mass_scal"},
        {"limit: 0.02", "limit: 0.03", "run.kinetic_energy_limit"},
        {"precision: double", "precision: single", "run.precision"},
        {"strand_mm: 760", "strand_mm: 761", "strand_mm"},
        {"weight: true", "weight: false", "weight is true in it, and false is wanted"},
        /* Words, and values said in another way. */
        {"title: A title", "title: Another", NULL},
        {"name: mine", "name: mine\n# a comment\nnotes: A note", NULL},
        {"name: mine", "name: yours", NULL},
        {"114\n", "114.0\nlength_source: printed\n", NULL},
        {"{wire: type3, count: 6}", "{wire: type3, count: 2}, {wire: type3, count: 4}", NULL},
        {"shear_to_normal_stiffness: 0.5", "shear_to_normal_stiffness: 5.0e-1", NULL},
        {"settled: false\n", "", NULL},
        {"loads:", "published: {outer_diameter_mm: 4.6, density_g_cm3: 3.43}\nloads:", NULL},
    };
    look_at_changes(take_explicit, bundle, changes, WB_COUNT(changes));
}

static void the_section_model_knows_no_mesh_and_no_time(void **unused)
{
    (void)unused;
    static const struct change changes[] = {
        {"elements_along: 160", "elements_along: 161", NULL},
        {"duration_s: 2", "duration_s: 3", NULL},
        {"precision: double", "precision: single", NULL},
        {"rows: 20", "rows: 21", "run.rows"},
        {"strand_mm: 760", "strand_mm: 761", "strand_mm"},
    };
    look_at_changes(take_section, bundle, changes, WB_COUNT(changes));
}

/* Files that the bundle names. */
static void values_of_a_wires_file_show(void **unused)
{
    (void)unused;
    static const struct change changes[] = {
        {"outer_diameter_mm: 1", "outer_diameter_mm: 1.001", "wires[1].outer_diameter_mm"},
        {"density_g_cm3: 2", "density_g_cm3: 3", "wires[1].density_g_cm3 is 2 in it, and 3"},
        {"modulus_MPa: 1000", "modulus_MPa: 1001", "wires[1].youngs_modulus_MPa"},
        {"ratio: 0.4", "ratio: 0.41", "wires[1].poissons_ratio"},
        {"yield_stress_MPa: 4", "yield_stress_MPa: 5", "wires[1].yield_stress_MPa"},
        {"coefficient_MPa: 100", "coefficient_MPa: 101", "wires[1].strength_coefficient_MPa"},
        {"exponent: 0.5", "exponent: 0.6", "wires[1].hardening_exponent"},
        {"name: thin", "# x\nname: slim", NULL},
        {"source: here", "source: there", NULL},
    };
    char text[4096], problem[400];
    struct wb_json *const before = take_explicit(bundle);
    for (size_t i = 0; i < WB_COUNT(changes); i++) {
        replace(text, thin, changes[i].old, changes[i].new_text);
        write_beside("thin.yaml", text);
        struct wb_json *const after = take_explicit(bundle);
        const bool same = is_same(before, after, problem);
        if (same != !changes[i].shows || (!same && !strstr(problem, changes[i].shows)))
            fail_msg("'%s': %s", changes[i].new_text, same ? "nothing" : problem);
        wb_json_destroy(after);
    }
    wb_json_destroy(before);
    write_beside("thin.yaml", thin);
}

static void which_wire_lies_where_shows(void **unused)
{
    (void)unused;
    static struct wb_bundle_model model;
    char problem[400];
    struct wb_json *const before = take_explicit(bundle), *const after = wb_json_create();
    assert_int_equal(wb_bundle_model_read(&model, in_own_folder("bundle.yaml")), WB_OK);
    model.type_of[0] = 1;
    model.type_of[6] = 0;
    wb_model_inputs_bundle(after, &model, wb_bundle_model_mesh(&model, "fine"));
    assert_false(is_same(before, after, problem));
    assert_non_null(strstr(problem, "places[0] is 'wire 1 at"));
    wb_json_destroy(before);
    wb_json_destroy(after);
}

/* --- wires --- */

static const char wire[] =
    "name: residual\ntitle: A title\nwire: 8awg\nlength_mm: 100\nlaw: elastoplastic\nparts:\n"
    "  - {name: core, outer_diameter_mm: 3.26, material: annealed-copper}\n"
    "  - {name: jacket, outer_diameter_mm: 4.86, material: pvc}\n"
    "interface: {friction: 0.1, normal_stiffness_N_mm3: 400}\nclamp: fixed\n"
    "gravity: [1, -9.81, 3]\nstrand_mm: 760\n"
    "mesh: {elements_along: 40, section_density: 2, integration: reduced}\n"
    "fields_at_mm: [3.26, 50]\nhistory:\n"
    "  - {name: force, force_N: [5, 6, 7], rows: 5}\n"
    "  - {name: moment, moment_Nm: [0.2, 0.3, 0.4]}\n"
    "  - {name: follower, follower_N: [0, 24, 0], fields: true}\n"
    "  - {name: raised, deflection_mm: 53}\n"
    "  - {name: released, release: true}\n";

static struct wb_json *take_wire(const char *text, bool is_solid)
{
    static struct wb_wire_model model;
    write_beside("wire.yaml", text);
    assert_int_equal(wb_wire_model_read(&model, in_own_folder("wire.yaml")), WB_OK);
    struct wb_json *const inputs = wb_json_create();
    wb_model_inputs_wire(inputs, &model, is_solid);
    return inputs;
}

static struct wb_json *take_solid(const char *text)
{
    return take_wire(text, true);
}

static struct wb_json *take_rod(const char *text)
{
    return take_wire(text, false);
}

static void every_value_of_a_wire_shows(void **unused)
{
    (void)unused;
    static const struct change changes[] = {
        {"length_mm: 100", "length_mm: 101", "length_mm"},
        {"law: elastoplastic", "law: elastic", "parts[0].hardening"},
        {"outer_diameter_mm: 3.26", "outer_diameter_mm: 3.27", "parts[0].outer_diameter_mm"},
        {"material: pvc", "material: annealed-copper", "parts[1]."},
        {"interface: {friction: 0.1", "interface: {friction: 0.2", "interface.friction"},
        {"mm3: 400", "mm3: 401", "interface.normal_stiffness_N_mm3"},
        {"clamp: fixed", "clamp: plane", "clamp"},
        {"[1, -9.81, 3]", "[1, -9.81, 4]", "gravity[2] is 3 in it, and 4 is wanted"},
        {"strand_mm: 760", "strand_mm: 761", "strand_mm"},
        {"elements_along: 40", "elements_along: 62", "mesh.elements_along is 40"},
        {"section_density: 2", "section_density: 1", "mesh.section_density"},
        {"integration: reduced", "integration: selective", "mesh.integration"},
        {"[3.26, 50]", "[3.26, 51]", "fields_at_mm[1]"},
        {"[5, 6, 7]", "[5, 6, 8]", "history[0].force_N[2]"},
        {"rows: 5", "rows: 6", "history[0].rows"},
        {"[0.2, 0.3, 0.4]", "[0.2, 0.3, 0.5]", "history[1].moment_Nm[2]"},
        {"[0, 24, 0]", "[0, 25, 0]", "history[2].follower_N[1]"},
        {"fields: true", "fields: false", "history[2].fields"},
        {"deflection_mm: 53", "deflection_mm: 54", "history[3].deflection_mm"},
        {"  - {name: released, release: true}\n", "", "history is a list of 5"},
        {"title: A title", "title: B\nnotes: A note # and more", NULL},
        {"name: residual", "name: rest", NULL},
        {"friction: 0.1", "friction: 1e-1", NULL},
    };
    look_at_changes(take_solid, wire, changes, WB_COUNT(changes));
}

static void a_rod_knows_no_mesh_and_no_interface(void **unused)
{
    (void)unused;
    static const struct change changes[] = {
        {"elements_along: 40", "elements_along: 62", NULL},
        {"interface: {friction: 0.1, normal_stiffness_N_mm3: 400}\n", "", NULL},
        {"length_mm: 100", "length_mm: 101", "length_mm"},
    };
    look_at_changes(take_rod, wire, changes, WB_COUNT(changes));
}

/* --- laws --- */

static void every_number_of_a_law_shows(void **unused)
{
    (void)unused;
    const struct wb_law_part parts[2] = {{1e9, 0.01}, {2e8, (double)INFINITY}};
    struct wb_law law, other[4];
    char problem[400];
    wb_law_init_parallel(&law, parts, 2, 0.5, 0.3);
    for (size_t i = 0; i < WB_COUNT(other); i++)
        other[i] = law;
    other[0].isotropic_share = 0.6;
    other[1].parts[0].yield_strain = 0.02;
    other[2].parts[1].yield_strain = 0.1;
    other[3].n_parts = 1;
    struct wb_json *const before = wb_json_create();
    wb_model_inputs_law(before, &law);
    for (size_t i = 0; i < WB_COUNT(other); i++) {
        struct wb_json *const after = wb_json_create();
        wb_model_inputs_law(after, &other[i]);
        assert_false(is_same(before, after, problem));
        wb_json_destroy(after);
    }
    assert_true(is_same(before, before, problem));
    wb_json_destroy(before);
}

static int set_up(void **state)
{
    if (make_folder(state) != 0)
        return -1;
    write_beside("thin.yaml", thin);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_value_of_a_bundle_shows),
        cmocka_unit_test(the_section_model_knows_no_mesh_and_no_time),
        cmocka_unit_test(values_of_a_wires_file_show),
        cmocka_unit_test(which_wire_lies_where_shows),
        cmocka_unit_test(every_value_of_a_wire_shows),
        cmocka_unit_test(a_rod_knows_no_mesh_and_no_interface),
        cmocka_unit_test(every_number_of_a_law_shows),
    };
    return cmocka_run_group_tests(tests, set_up, remove_folder);
}
