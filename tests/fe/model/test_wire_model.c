/* Wire models: every key of the file, every refusal with file, line and key, what follows from a
 * model, and the shipped ones. */
#include "tests/messages.h"
#include "tests/own_folder.h"

#include <stdlib.h>
#include <unistd.h>

#include "base/file.h"
#include "fe/model/wire_model.h"

static char model_path[64];
static struct wb_wire_model model;

static void write_file(const char *path, const char *text, size_t size)
{
    FILE *const out = fopen(path, "w");
    assert_non_null(out);
    assert_int_equal(fwrite(text, 1, size, out), size);
    assert_int_equal(fclose(out), 0);
}

static void write_beside(const char *name, const char *text)
{
    char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    write_file(path, text, strlen(text));
}

static enum wb_status read_bytes(const char *text, size_t size)
{
    write_file(model_path, text, size);
    keep_messages();
    const enum wb_status status = wb_wire_model_read(&model, model_path);
    wb_log_set_sink(NULL, NULL);
    return status;
}

static void read_text(const char *text)
{
    if (read_bytes(text, strlen(text)) != WB_OK)
        fail_msg("refused: %s", kept.last);
}

static const char full[] = "name: residual-1\n"
                           "title: A title\n"
                           "notes: Some notes\n"
                           "wire: 8awg\n"
                           "length_mm: 100\n"
                           "law: elastoplastic\n"
                           "parts:\n"
                           "  - name: core\n"
                           "    outer_diameter_mm: 3.26\n"
                           "    material: annealed-copper\n"
                           "  - name: jacket\n"
                           "    outer_diameter_mm: 4.86\n"
                           "    material: ./soft.yaml\n"
                           "interface:\n"
                           "  friction: 0.1\n"
                           "  normal_stiffness_N_mm3: 400\n"
                           "clamp: fixed\n"
                           "gravity: [1, -9.81, 3]\n"
                           "strand_mm: 760\n"
                           "mesh:\n"
                           "  elements_along: 40\n"
                           "  section_density: 2\n"
                           "  integration: reduced\n"
                           "fields_at_mm: [3.26, 50]\n"
                           "history:\n"
                           "  - name: force\n"
                           "    force_N: [5, 6, 7]\n"
                           "    rows: 5\n"
                           "  - name: moment\n"
                           "    moment_Nm: [0.2, 0.3, 0.4]\n"
                           "  - name: follower\n"
                           "    follower_N: [0, 24, 0]\n"
                           "    fields: true\n"
                           "  - name: unloaded\n"
                           "    unload: true\n"
                           "  - name: raised\n"
                           "    deflection_mm: 53\n"
                           "  - name: lowered\n"
                           "    deflection_mm: 20\n"
                           "  - name: released\n"
                           "    release: true\n";

static const char soft[] = "name: soft\nsubstitute: true\nsource: a test\nyoungs_modulus_MPa: 41\n"
                           "poissons_ratio: 0.43\nyield_stress_MPa: 2\ndensity_g_cm3: 1.4\n";

static void every_key_is_read(void **state)
{
    (void)state;
    read_text(full);
    assert_string_equal(model.name, "residual-1");
    assert_string_equal(model.title, "A title");
    assert_string_equal(model.notes, "Some notes");
    assert_string_equal(model.path, model_path);
    assert_string_equal(model.wire.name, "8awg");
    assert_close(model.length, 0.1, 1e-15);
    assert_false(model.is_elastic || model.is_homogenised);

    assert_int_equal(model.n_parts, 2);
    const struct wb_wire_model_part *const core = &model.part[0], *const jacket = &model.part[1];
    assert_string_equal(core->name, "core");
    assert_string_equal(core->material_name, "annealed-copper");
    assert_close(core->inner_diameter, 0.0, 0.0);
    assert_close(core->outer_diameter, 3.26e-3, 1e-15);
    assert_close(core->material.strength_coefficient, 292e6, 1e-3);
    assert_int_equal(core->material.hardening, WB_HARDENING_ISOTROPIC_POWER);
    assert_true(core->is_substitute && strlen(core->source) > 0);
    assert_close(core->density, 8960.0, 1e-9);
    assert_string_equal(jacket->material_name, "soft");
    assert_string_equal(jacket->source, "a test");
    assert_close(jacket->inner_diameter, 3.26e-3, 1e-15);
    assert_close(jacket->outer_diameter, 4.86e-3, 1e-15);
    assert_close(jacket->material.strength_coefficient, 0.0, 0.0);

    assert_true(model.has_contact);
    assert_close(model.jacket_contact.friction, 0.1, 0.0);
    assert_close_relative(model.jacket_contact.normal_stiffness, 400e9, 1e-12);
    assert_close_relative(model.jacket_contact.tangential_stiffness, 400e9 / 3.0, 1e-12);
    assert_int_equal(model.clamp, WB_WIRE_CLAMP_FIXED);
    assert_close(model.gravity[0], 1.0, 0.0);
    assert_close(model.gravity[1], -9.81, 0.0);
    assert_close(model.gravity[2], 3.0, 0.0);
    assert_close(model.strand_length, 0.76, 1e-15);
    assert_int_equal(model.elements_along, 40);
    assert_int_equal(model.section_density, 2);
    assert_int_equal(model.integration, WB_INTEGRATION_REDUCED);
    assert_int_equal(model.n_sections, 2);
    assert_close(model.section[0], 3.26e-3, 1e-15);
    assert_close(model.section[1], 0.05, 1e-15);
}

/* Names of products are short, ways to their files need not be. */
static void ways_to_files_may_be_long(void **state)
{
    (void)state;
    char way[201], text[1024];
    for (int i = 0; i < 200; i++)
        way[i] = i % 2 == 0 ? '.' : '/';
    way[200] = '\0';
    write_beside("mine.yaml", "name: mine\nconductor_diameter_mm: 1\nouter_diameter_mm: 2\n"
                              "density_g_cm3: 3\n");
    snprintf(text, sizeof text,
             "name: far\ntitle: far\nwire: %smine.yaml\nlength_mm: 100\nlaw: elastic\n"
             "parts:\n  - name: all\n    outer_diameter_mm: 2\n    material: %ssoft.yaml\n"
             "gravity: [0, 0, 0]\nhistory:\n  - name: up\n    force_N: [0, 1, 0]\n    rows: 2\n",
             way, way);
    read_text(text);
    assert_string_equal(model.wire.name, "mine");
    assert_string_equal(model.part[0].material_name, "soft");
}

static void loads_go_on_from_step_to_step(void **state)
{
    (void)state;
    read_text(full);
    assert_int_equal(model.n_steps, 7);
    const struct wb_wire_step *const s = model.step;
    static const enum wb_wire_step_kind kinds[] = {
        WB_WIRE_STEP_LOADS,      WB_WIRE_STEP_LOADS,      WB_WIRE_STEP_LOADS,  WB_WIRE_STEP_LOADS,
        WB_WIRE_STEP_DEFLECTION, WB_WIRE_STEP_DEFLECTION, WB_WIRE_STEP_RELEASE};
    static const bool unloads[] = {false, false, false, true, false, true, true};
    for (int i = 0; i < 7; i++) {
        assert_int_equal(s[i].kind, kinds[i]);
        assert_int_equal(s[i].unloads, unloads[i]);
        assert_int_equal(s[i].rows, i == 0 ? 5 : 10);
        assert_int_equal(s[i].fields, i == 2);
    }
    assert_string_equal(s[3].name, "unloaded");
    /* Forces that a step does not name stay. */
    assert_close(s[2].loads.force[0], 5.0, 0.0);
    assert_close(s[2].loads.moment[2], 0.4, 0.0);
    assert_close(s[2].loads.follower[1], 24.0, 0.0);
    for (int i = 3; i < 7; i++)
        for (int k = 0; k < 3; k++)
            assert_true(s[i].loads.force[k] == 0.0 && s[i].loads.moment[k] == 0.0 &&
                        s[i].loads.follower[k] == 0.0);
    assert_close(s[4].deflection, 0.053, 1e-15);
    assert_close(s[5].deflection, 0.020, 1e-15);
}

#define SHORT                                                                                      \
    "name: n\ntitle: t\nwire: type3\nlength_mm: 85\nlaw: elastoplastic\ngravity: [0, 9.81, 0]\n"
#define ONE_STEP "history:\n  - name: s\n    force_N: [0, 1, 0]\n"

static void without_parts_it_is_the_homogenised_wire(void **state)
{
    (void)state;
    read_text(SHORT ONE_STEP);
    assert_true(model.is_homogenised);
    assert_int_equal(model.n_parts, 1);
    assert_close(model.part[0].outer_diameter, 1.4e-3, 1e-15);
    assert_close(model.part[0].density, 4970.0, 1e-9);
    assert_close(model.part[0].material.youngs_modulus, 4528e6, 1e-3);
    assert_string_equal(model.part[0].source, "Table 3 of the paper");
    assert_false(model.part[0].is_substitute);
    /* Defaults. */
    assert_false(model.has_contact);
    assert_int_equal(model.clamp, WB_WIRE_CLAMP_PLANE);
    assert_close(model.strand_length, 0.0, 0.0);
    assert_int_equal(model.elements_along, 60);
    assert_int_equal(model.section_density, 1);
    assert_int_equal(model.integration, WB_INTEGRATION_SELECTIVE);
    assert_int_equal(model.n_sections, 0);

    assert_close_relative(wb_wire_model_mass_per_length(&model),
                          wb_wire_mass_per_length(&model.wire), 1e-12);
    assert_close_relative(wb_wire_model_youngs_modulus(&model), 4528e6, 1e-12);
    assert_close_relative(wb_wire_model_youngs_modulus(&model) * M_PI * pow(1.4e-3, 4.0) / 64.0,
                          4528e6 * wb_wire_second_moment(&model.wire), 1e-12);
    assert_close_relative(wb_wire_model_poissons_ratio(&model), 0.39, 1e-12);
}

/* Section 2 of the paper: E_eff = 13.84 GPa by eq. 8, nu_eff = 0.39 by eq. 9. */
static void rules_of_mixtures_give_the_papers_wire(void **state)
{
    (void)state;
    read_text(full);
    const double r2 = (3.26 / 4.86) * (3.26 / 4.86);
    assert_close_relative(wb_wire_model_youngs_modulus(&model), 13.84e9, 1e-3);
    assert_close_relative(wb_wire_model_youngs_modulus(&model),
                          68.2e9 * r2 * r2 + 41e6 * (1.0 - r2 * r2), 1e-12);
    const double core = M_PI / 64.0 * pow(3.26e-3, 4.0), all = M_PI / 64.0 * pow(4.86e-3, 4.0);
    assert_close_relative(68.2e9 * core + 41e6 * (all - core),
                          wb_wire_model_youngs_modulus(&model) * all, 1e-12);
    assert_close(wb_wire_model_poissons_ratio(&model), 0.39, 0.005);
    assert_close_relative(wb_wire_model_mass_per_length(&model),
                          M_PI / 4.0 * 4.86e-3 * 4.86e-3 * (8960.0 * r2 + 1400.0 * (1.0 - r2)),
                          1e-12);
}

static void elastic_law_takes_yield_from_all_parts(void **state)
{
    (void)state;
    char text[sizeof full + 64];
    snprintf(text, sizeof text, "%s", full);
    char *const law = strstr(text, "elastoplastic");
    memmove(law + 7, law + 13, strlen(law + 13) + 1);
    memcpy(law, "elastic", 7);
    read_text(text);
    assert_true(model.is_elastic);
    assert_int_equal(model.part[0].material.hardening, WB_HARDENING_NONE_ELASTIC);
    assert_int_equal(model.part[1].material.hardening, WB_HARDENING_NONE_ELASTIC);
}

static void contact_is_as_stiff_as_the_jacket_by_default(void **state)
{
    (void)state;
    char text[sizeof full];
    snprintf(text, sizeof text, "%s", full);
    char *const line = strstr(text, "  normal_stiffness_N_mm3: 400\n");
    memmove(line, line + 30, strlen(line + 30) + 1);
    read_text(text);
    assert_close_relative(model.jacket_contact.normal_stiffness,
                          41e6 * 0.57 / (1.43 * 0.14) / 0.8e-3, 1e-12);
}

static void read_history(const char *gravity, const char *history)
{
    char text[512];
    snprintf(text, sizeof text,
             "name: n\ntitle: t\nwire: type3\nlength_mm: 85\nlaw: elastoplastic\n"
             "gravity: %s\nhistory:\n%s",
             gravity, history);
    read_text(text);
}

static void models_know_whether_they_are_a_bending_test(void **state)
{
    (void)state;
    static const struct {
        const char *gravity, *history;
        bool follower, bends;
    } cases[] = {
        {"[0, -9.81, 0]", "  - name: a\n    follower_N: [0, 24, 0]\n", true, true},
        {"[0, 0, 0]", "  - name: a\n    follower_N: [0, 24, 0]\n  - name: b\n    unload: true\n",
         true, true},
        {"[0, 0, 1]", "  - name: a\n    follower_N: [0, 24, 0]\n", true, false},
        {"[0, 0, 0]", "  - name: a\n    follower_N: [0, 24, 1]\n", false, false},
        {"[0, 0, 0]", "  - name: a\n    follower_N: [1, 24, 0]\n", false, false},
        {"[0, 0, 0]",
         "  - name: a\n    force_N: [0, 1, 0]\n  - name: b\n    follower_N: [0, 24, 0]\n", false,
         false},
        {"[0, 0, 0]", "  - name: a\n    force_N: [0, 1, 0]\n", false, true},
        {"[0, -9.81, 0]", "  - name: a\n    force_N: [0, 1, 0]\n", false, false},
        {"[0, 0, 0]", "  - name: a\n    force_N: [0, 1, 1]\n", false, false},
        {"[0, 0, 0]", "  - name: a\n    force_N: [1, 1, 0]\n", false, false},
        {"[0, 0, 0]", "  - name: a\n    moment_Nm: [0, 0, 1]\n", false, false},
        {"[0, 9.81, 0]", "  - name: a\n    deflection_mm: 5\n  - name: b\n    release: true\n",
         false, true},
        {"[1, 9.81, 0]", "  - name: a\n    deflection_mm: 5\n", false, false},
        {"[0, 0, 0]", "  - name: a\n    force_N: [0, 1, 0]\n  - name: b\n    deflection_mm: 5\n",
         false, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        read_history(cases[i].gravity, cases[i].history);
        if (wb_wire_model_is_follower(&model) != cases[i].follower ||
            wb_wire_model_is_bending_test(&model) != cases[i].bends)
            fail_msg("case %zu", i);
    }
}

static void smaller_and_reversed_loads_unload(void **state)
{
    (void)state;
    static const struct {
        const char *first, *second;
        bool expected;
    } cases[] = {
        {"force_N: [0, 5, 0]", "force_N: [0, 6, 0]", false},
        {"force_N: [0, 5, 0]", "force_N: [0, 4, 0]", true},
        {"force_N: [0, 5, 0]", "force_N: [0, -6, 0]", true},
        {"force_N: [0, 5, 0]", "force_N: [0, 5, 0]", false},
        {"force_N: [0, 5, 0]", "force_N: [0, 0, 6]", false},
        {"force_N: [0, 5, 0]", "moment_Nm: [0, 0, 1]", false},
        {"follower_N: [0, 5, 0]", "follower_N: [-0, 0, 0]", true},
        {"moment_Nm: [0, 5, 0]", "unload: true", true},
        {"deflection_mm: 5", "deflection_mm: 6", false},
        {"deflection_mm: -5", "deflection_mm: -6", false},
        {"deflection_mm: -5", "deflection_mm: -4", true},
        {"deflection_mm: 5", "deflection_mm: -5", true},
        {"deflection_mm: 5", "release: true", true},
        {"deflection_mm: 5", "release: true\n  - name: c\n    deflection_mm: 4", true},
        {"deflection_mm: 5", "release: true\n  - name: c\n    force_N: [0, 1, 0]", true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[512];
        snprintf(text, sizeof text, "%shistory:\n  - name: a\n    %s\n  - name: b\n    %s\n", SHORT,
                 cases[i].first, cases[i].second);
        read_text(text);
        assert_false(model.step[0].unloads);
        /* What follows a release is loading again. */
        if (model.step[1].unloads != cases[i].expected ||
            (model.n_steps > 2 && model.step[2].unloads))
            fail_msg("case %zu: %s, then %s", i, cases[i].first, cases[i].second);
    }
}

/* Replaces a line of the full model and expects the refusal. */
static void refusals_name_line_and_key(void **state)
{
    (void)state;
    static const struct {
        const char *line, *by, *expected;
    } cases[] = {
        {"name: residual-1", "name: a, b", ":1: name: expected letters"},
        {"name: residual-1", "name: ''", ":1: name: expected letters"},
        {"title: A title", "titel: A title", ":2: titel: unknown key"},
        {"notes: Some notes", "title: twice", ":3: title: given twice"},
        {"wire: 8awg", "wire: 9awg", ":4: wire: no '9awg' among the shipped wires"},
        {"wire: 8awg", "wire: ./none.yaml", ":4: wire: no file './none.yaml'"},
        {"wire: 8awg", "wire: type3", ":12: outer_diameter_mm: 4.86 mm is the outermost"},
        {"length_mm: 100", "length_mm: 100 mm", ":5: length_mm: expected a plain number"},
        {"length_mm: 100", "length_mm: 0", ":5: length_mm: 0 is out of range"},
        {"length_mm: 100", "length_mm: nan", ":5: length_mm: expected a plain number"},
        {"length_mm: 100", "length_mm: 50", ":37: deflection_mm: 53 mm cannot be reached"},
        {"law: elastoplastic", "law: plastic", ":6: law: expected one of elastic, elastoplastic"},
        {"  - name: core", "  - name: core!", ":8: name: expected letters"},
        {"  - name: jacket", "  - name: core", ":11: name: another part has the name core"},
        {"    outer_diameter_mm: 3.26", "    outer_diameter_mm: 5",
         ":12: outer_diameter_mm: expected more than the 5 mm"},
        {"    outer_diameter_mm: 3.26", "    outer_diameter_mm: -1",
         ":9: outer_diameter_mm: -1 is out of range"},
        {"    material: annealed-copper", "    material: tin",
         ":10: material: no 'tin' among the shipped materials"},
        {"    material: annealed-copper", "    material: tape",
         ":10: material: material tape has no poissons_ratio"},
        {"    material: ./soft.yaml", "    material: ./elastic.yaml",
         ":13: material: material elastic has no yield_stress_MPa"},
        {"    material: ./soft.yaml", "    material: ./broken.yaml",
         "/broken.yaml:2: colour: unknown key"},
        {"  friction: 0.1", "  friction: -0.1", ":15: friction: -0.1 is out of range"},
        {"  friction: 0.1", "  fraction: 0.1", ":15: fraction: unknown key"},
        {"  normal_stiffness_N_mm3: 400", "  normal_stiffness_N_mm3: 0",
         ":16: normal_stiffness_N_mm3: 0 is out of range"},
        {"clamp: fixed", "clamp: loose", ":17: clamp: expected one of plane, fixed"},
        {"gravity: [1, -9.81, 3]", "gravity: 9.81", ":18: gravity: expected a list"},
        {"gravity: [1, -9.81, 3]", "gravity: [0, 0]", ":18: gravity: 2 numbers given"},
        {"gravity: [1, -9.81, 3]", "gravity: [0, 0, 0, 0]", ":18: gravity: 4 numbers given"},
        {"gravity: [1, -9.81, 3]", "gravity: [0, inf, 0]", ":18: gravity: expected a plain"},
        {"gravity: [1, -9.81, 3]", "# none", ":1: gravity: this key is missing"},
        {"strand_mm: 760", "strand_mm: -760", ":19: strand_mm: -760 is out of range"},
        {"  elements_along: 40", "  elements_along: 0", ":21: elements_along: 0 is out of"},
        {"  elements_along: 40", "  elements_along: 2.5", ":21: elements_along: expected a whole"},
        {"  section_density: 2", "  section_density: 17", ":22: section_density: 17 is out of"},
        {"  integration: reduced", "  integration: full",
         ":23: integration: expected one of selective, reduced"},
        {"fields_at_mm: [3.26, 50]", "fields_at_mm: [50, 3.26]",
         ":24: fields_at_mm: expected ascending"},
        {"fields_at_mm: [3.26, 50]", "fields_at_mm: [3.26, 101]",
         ":24: fields_at_mm: 101 is out of range"},
        {"fields_at_mm: [3.26, 50]", "fields_at_mm: []", ":24: fields_at_mm: 0 numbers given"},
        {"fields_at_mm: [3.26, 50]", "fields_at_mm: [1,2,3,4,5,6,7,8,9]",
         ":24: fields_at_mm: 9 numbers given"},
        {"  - name: moment", "  - name: force", ":29: name: another step has the name force"},
        {"  - name: force", "  - name: 'a b'", ":26: name: expected letters"},
        {"    force_N: [5, 6, 7]", "    force_N: [5, 6, x]", ":27: force_N: expected a plain"},
        {"    force_N: [5, 6, 7]", "    force_N: [5, 6, 7]\n    release: true",
         ":26: a step has exactly one of"},
        {"    force_N: [5, 6, 7]", "    fields: false", ":26: a step has exactly one of"},
        {"    force_N: [5, 6, 7]", "    release: true", ":27: release: no deflection is held"},
        {"    force_N: [5, 6, 7]", "    unload: true", ":27: unload: nothing acts at the tip"},
        {"    moment_Nm: [0.2, 0.3, 0.4]", "    moment_Nm: [0.2]", ":30: moment_Nm: 1 numbers"},
        {"    follower_N: [0, 24, 0]", "    follower_N: {}", ":32: follower_N: expected a list"},
        {"    unload: true", "    unload: false", ":35: unload: expected true"},
        {"    unload: true", "    unload: yes", ":35: unload: expected true or false"},
        {"    release: true", "    release: false", ":41: release: expected true"},
        {"    release: true", "    force_N: [0, 0, 1]", ":40: a deflection is held"},
        {"    deflection_mm: 20", "    unload: true", ":38: a deflection is held"},
        {"    deflection_mm: 53", "    deflection_mm: -100",
         ":37: deflection_mm: -100 mm cannot be reached"},
        {"    rows: 5", "    rows: 0", ":28: rows: 0 is out of range"},
        {"    rows: 5", "    rows: 10001", ":28: rows: 10001 is out of range"},
        {"    fields: true", "    fields: 1", ":33: fields: expected true or false"},
    };
    write_beside("elastic.yaml", "name: elastic\nsource: a test\nyoungs_modulus_MPa: 41\n"
                                 "poissons_ratio: 0.43\ndensity_g_cm3: 1.4\n");
    write_beside("broken.yaml", "name: broken\ncolour: red\n");
    read_text(full);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[2 * sizeof full], expected[256];
        char line[128];
        snprintf(line, sizeof line, "%s\n", cases[i].line);
        const char *const at = strstr(full, line);
        assert_non_null(at);
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - full), full, cases[i].by,
                 at + strlen(cases[i].line));
        model.name[0] = '?';
        const enum wb_status status = read_bytes(text, strlen(text));
        snprintf(expected, sizeof expected, "%s%s", cases[i].expected[0] == ':' ? model_path : "",
                 cases[i].expected);
        if (status == WB_OK || kept.n != 1 || !strstr(kept.last, expected))
            fail_msg("'%s': status %d, %d messages, '%s' does not hold '%s'", cases[i].by, status,
                     kept.n, kept.last, expected);
        assert_int_equal(model.name[0], '?');
    }
}

static void whole_models_are_refused_for_what_they_are(void **state)
{
    (void)state;
    static const struct {
        const char *text, *expected;
    } cases[] = {
        {SHORT "interface:\n  friction: 0.1\n" ONE_STEP, ":8: interface: "},
        {SHORT "strand_mm: 760\n" ONE_STEP, ":7: strand_mm: no step of the history"},
        {SHORT "history:\n  - name: a\n    deflection_mm: 5\n  - name: b\n    release: true\n"
               "  - name: c\n    release: true\n",
         ":13: release: no deflection is held"},
        {SHORT "history: []\n", ":7: history: expected a list of 1 to 16 steps"},
        {SHORT "history: 5\n", ":7: history: expected a list of 1 to 16 steps"},
        {SHORT "history:\n  - 5\n", ":8: expected keys with values"},
        {SHORT "parts: []\n" ONE_STEP, ":7: parts: expected a list of 1 to 2 parts"},
        {SHORT "mesh: 5\n" ONE_STEP, ":7: expected keys with values"},
        {SHORT, ":1: history: this key is missing"},
        {"- 1\n", ":1: expected keys with values"},
        {"", ": the file is empty"},
        {"name: n\ntitle: t\nwire: ./bare.yaml\nlength_mm: 85\nlaw: elastic\n"
         "gravity: [0, 0, 0]\n" ONE_STEP,
         ":3: wire: wire bare has no properties"},
        {"name: n\ntitle: t\nwire: ./rubber.yaml\nlength_mm: 85\nlaw: elastic\n"
         "gravity: [0, 0, 0]\n" ONE_STEP,
         ":3: wire: wire rubber has poissons_ratio 0.5"},
    };
    write_beside("bare.yaml", "name: bare\nconductor_diameter_mm: 1\nouter_diameter_mm: 2\n"
                              "density_g_cm3: 3\n");
    write_beside("rubber.yaml",
                 "name: rubber\nconductor_diameter_mm: 1\nouter_diameter_mm: 2\ndensity_g_cm3: 3\n"
                 "properties:\n  youngs_modulus_MPa: 1\n  poissons_ratio: 0.5\n"
                 "  yield_stress_MPa: 1\n  strength_coefficient_MPa: 1\n"
                 "  hardening_exponent: 1\n");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const enum wb_status status = read_bytes(cases[i].text, strlen(cases[i].text));
        if (status == WB_OK || kept.n != 1 || !strstr(kept.last, cases[i].expected))
            fail_msg("case %zu: status %d, %d messages, '%s' does not hold '%s'", i, status, kept.n,
                     kept.last, cases[i].expected);
    }
    keep_messages();
    assert_int_equal(wb_wire_model_read(&model, "/nowhere/model.yaml"), WB_ERR_NOT_FOUND);
    wb_log_set_sink(NULL, NULL);

    char text[2048];
    int n = snprintf(text, sizeof text, "%shistory:\n", SHORT);
    for (int i = 0; i < 17; i++)
        n += snprintf(text + n, sizeof text - (size_t)n, "  - name: s%d\n    force_N: [0, 1, 0]\n",
                      i);
    assert_int_equal(read_bytes(text, (size_t)n), WB_ERR_FORMAT);
    assert_message(":8: history: expected a list of 1 to 16 steps");
}

/* What is read is right or refused with a message, however the file is broken. */
static void broken_files_are_read_or_refused(void **state)
{
    (void)state;
    static const char strange[] = "\0\xff:-[{\"'#\n \t9";
    const size_t n = strlen(full);
    char text[sizeof full];
    int refused = 0;
    for (size_t i = 0; i < n; i += 3) {
        for (int way = 0; way < 2; way++) {
            memcpy(text, full, n);
            text[i] = strange[(i / 3) % (sizeof strange - 1)];
            const enum wb_status status = read_bytes(text, way == 0 ? i : n);
            if (status != WB_OK && kept.n == 0)
                fail_msg("refused without a message at byte %zu", i);
            refused += status != WB_OK;
        }
    }
    assert_true(refused > 400);
}

static int set_up(void **state)
{
    if (make_folder(state) != 0)
        return -1;
    snprintf(model_path, sizeof model_path, "%s/model.yaml", folder);
    write_beside("soft.yaml", soft);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_key_is_read),
        cmocka_unit_test(ways_to_files_may_be_long),
        cmocka_unit_test(loads_go_on_from_step_to_step),
        cmocka_unit_test(without_parts_it_is_the_homogenised_wire),
        cmocka_unit_test(rules_of_mixtures_give_the_papers_wire),
        cmocka_unit_test(elastic_law_takes_yield_from_all_parts),
        cmocka_unit_test(contact_is_as_stiff_as_the_jacket_by_default),
        cmocka_unit_test(models_know_whether_they_are_a_bending_test),
        cmocka_unit_test(smaller_and_reversed_loads_unload),
        cmocka_unit_test(refusals_name_line_and_key),
        cmocka_unit_test(whole_models_are_refused_for_what_they_are),
        cmocka_unit_test(broken_files_are_read_or_refused),
    };
    return cmocka_run_group_tests(tests, set_up, remove_folder);
}
