#include <stdlib.h>
#include <string.h>

#include "analysis/calibration/properties/properties.h"
#include "analysis/calibration/properties/quantity.h"
#include "analysis/schema/schema.h"
#include "analysis/schema/tables.h"
#include "tests/messages.h"

/* --- rows --- */

enum {
    MOST_OBJECTS = 400,
    MOST_KEYS = 120
};

/* Each object below a root, once. */
struct objects {
    const struct wb_keys *all[MOST_OBJECTS];
    int n;
};

static void collect(struct objects *objects, const struct wb_keys *object)
{
    for (int i = 0; i < objects->n; i++) {
        if (objects->all[i] == object)
            return;
    }
    assert_true(objects->n < MOST_OBJECTS);
    objects->all[objects->n++] = object;
    for (size_t i = 0; object->alternatives && object->alternatives[i]; i++)
        collect(objects, object->alternatives[i]);
    for (size_t i = 0; i < object->n; i++) {
        if (object->rows[i].of)
            collect(objects, object->rows[i].of);
    }
}

static struct objects collect_all(void)
{
    struct objects objects = {.n = 0};
    for (size_t i = 0; i < WB_SCHEMA_DOCUMENTS; i++)
        collect(&objects, wb_schema_documents[i].root);
    return objects;
}

/* The keys of an object, with those of other tables that stand there. */
struct keys {
    const char *all[MOST_KEYS];
    int n;
};

static void add_key(struct keys *keys, const char *key)
{
    assert_true(keys->n < MOST_KEYS);
    keys->all[keys->n++] = key;
}

static void list_keys(struct keys *keys, const struct wb_keys *object)
{
    for (size_t i = 0; i < object->n; i++) {
        const struct wb_key *const row = &object->rows[i];
        if (row->key)
            add_key(keys, row->key);
        else if (row->settings)
            for (size_t k = 0; k < row->settings->n; k++)
                add_key(keys, row->settings->rows[k].name);
        else if (row->quantities)
            for (int id = 0; id < WB_QUANTITIES; id++)
                add_key(keys, wb_quantity_rows[id].key);
        else
            list_keys(keys, row->of);
    }
}

static bool has_key(const struct keys *keys, const char *key)
{
    for (int i = 0; i < keys->n; i++) {
        if (strcmp(keys->all[i], key) == 0)
            return true;
    }
    return false;
}

static void every_row_has_a_meaning(void **state)
{
    (void)state;
    const struct objects objects = collect_all();
    assert_true(objects.n > 150);
    for (int i = 0; i < objects.n; i++) {
        const struct wb_keys *const object = objects.all[i];
        for (size_t k = 0; k < object->n; k++) {
            const struct wb_key *const row = &object->rows[k];
            if (!row->key)
                continue;
            const size_t length = strlen(row->meaning);
            if (length < 3 || row->meaning[length - 1] == '.')
                fail_msg("%s.%s: meaning '%s'", object->name, row->key, row->meaning);
            if ((row->type & OBJECT) != (row->of ? (unsigned)OBJECT : 0U))
                fail_msg("%s.%s: an object has a table, and nothing else", object->name, row->key);
        }
    }
}

static void keys_of_an_object_differ(void **state)
{
    (void)state;
    const struct objects objects = collect_all();
    for (int i = 0; i < objects.n; i++) {
        struct keys keys = {.n = 0};
        list_keys(&keys, objects.all[i]);
        for (int a = 0; a < keys.n; a++) {
            for (int b = a + 1; b < keys.n; b++) {
                if (strcmp(keys.all[a], keys.all[b]) == 0)
                    fail_msg("%s.%s has two rows", objects.all[i]->name, keys.all[a]);
            }
        }
    }
}

static void the_unit_stands_at_the_end_of_the_key(void **state)
{
    (void)state;
    static const struct {
        const char *key, *unit;
    } keys[] = {
        {"length_mm", "mm"},
        {"flexural_rigidity_N_mm2", "N mm2"},
        {"normal_stiffness_N_mm3", "N/mm3"},
        {"fracture_energy_N_mm", "N/mm"},
        {"moment_N_mm", "N mm"},
        {"compliance_mm_N", "mm/N"},
        {"curvature_1_m", "1/m"},
        {"loop_area_per_delay_mJ_per_s", "mJ/s"},
        {"per_percent_of_counterweight_mm", "mm"},
        {"tip_angle_degrees", "degree"},
        {"u_gain_percent", "%"},
        {"misfit", ""},
        {"g", ""},
    };
    for (size_t i = 0; i < WB_COUNT(keys); i++) {
        const struct wb_key row = {keys[i].key, NUMBER, "meaning"};
        assert_string_equal(wb_keys_unit(&row), keys[i].unit);
    }
    const struct wb_key given = {"specimens_for_5_percent", INTEGER, "meaning", .unit = ""};
    assert_string_equal(wb_keys_unit(&given), "");
}

static void documents_are_found_by_name(void **state)
{
    (void)state;
    assert_ptr_equal(wb_schema_find("properties")->root, &wb_schema_properties_keys);
    assert_null(wb_schema_find("Properties"));
    for (size_t i = 0; i < WB_SCHEMA_DOCUMENTS; i++) {
        struct wb_json *const schema = wb_schema_build(&wb_schema_documents[i]);
        char *const text = wb_json_format(schema);
        assert_non_null(
            wb_json_get(wb_json_get(schema, "$defs"), wb_schema_documents[i].root->name));
        free(text);
        wb_json_destroy(schema);
    }
}

/* --- the reader of properties --- */

#define FOUR                                                                                       \
    "youngs_modulus_MPa: 5000\nyield_stress_MPa: 4\nstrength_coefficient_MPa: 1000\n"              \
    "hardening_exponent: 0.9\n"
#define REQUIRED                                                                                   \
    "wire: type1\nouter_diameter_mm: 1\nmass_per_length_kg_m: 0.004\n" FOUR "poissons_ratio: "     \
    "0.4\n"
#define FOUR_INLINE                                                                                \
    "youngs_modulus_MPa: 5000, yield_stress_MPa: 4, strength_coefficient_MPa: 1000, "              \
    "hardening_exponent: 0.9"

/* The definition of a key's object, by its path from the root: "law.parts". */
static const struct wb_keys *object_at(const char *path)
{
    const struct wb_keys *object = &wb_schema_properties_keys;
    while (*path) {
        const size_t n = strcspn(path, ".");
        const struct wb_keys *next = NULL;
        for (size_t i = 0; i < object->n && !next; i++) {
            const char *const key = object->rows[i].key;
            if (key && strlen(key) == n && strncmp(key, path, n) == 0)
                next = object->rows[i].of;
        }
        assert_non_null(next);
        object = next;
        path += n + (path[n] == '.');
    }
    return object;
}

/* The message names the keys that the reader accepts. */
static struct keys keys_read(char *message)
{
    static const char start[] = "known here: ";
    struct keys keys = {.n = 0};
    char *const list = strstr(message, start);
    if (!list)
        fail_msg("'%s' names no keys", message);
    for (char *rest = NULL, *word = strtok_r(list + strlen(start), ", ", &rest); word;
         word = strtok_r(NULL, ", ", &rest))
        add_key(&keys, word);
    return keys;
}

static void the_reader_accepts_the_keys_of_the_schema(void **state)
{
    (void)state;
    static const struct {
        const char *path, *text;
    } maps[] = {
        {"", "no_such_key: 1\n"},
        {"deviations", "deviations: {no_such_key: 1}\n"},
        {"calibration", "calibration: {no_such_key: 1}\n"},
        {"hardening_rule", "hardening_rule: {no_such_key: 1}\n"},
        {"three_point", "three_point: {no_such_key: 1}\n"},
        {"springback_ratio", "springback_ratio: {no_such_key: 1}\n"},
        {"specimens", "specimens: [{no_such_key: 1, sample: 1, length_mm: 85, " FOUR_INLINE "}]\n"},
        {"law", "law: {no_such_key: 1}\n"},
        {"law.parts", "law: {form: parallel, hardening: kinematic, parts: [{no_such_key: 1}]}\n"},
        {"law.chaboche",
         "law: {form: chaboche, hardening: combined, chaboche: {no_such_key: 1}}\n"},
        {"law.chaboche.back_stresses",
         "law: {form: chaboche, hardening: combined, chaboche: {youngs_modulus_MPa: 1, "
         "yield_stress_MPa: 1, back_stresses: [{no_such_key: 1}]}}\n"},
        {"law.relaxation",
         "law: {form: ludwik, hardening: isotropic, relaxation: {no_such_key: 1}}\n"},
        {"law.relaxation.elements", "law: {form: ludwik, hardening: isotropic, relaxation: "
                                    "{elements: [{no_such_key: 1}]}}\n"},
    };
    for (size_t i = 0; i < WB_COUNT(maps); i++) {
        struct wb_properties properties;
        struct wb_reason why = {.text = ""};
        char text[1024];
        struct keys of_schema = {.n = 0};
        snprintf(text, sizeof text, "%s%s", REQUIRED, maps[i].text);
        assert_int_not_equal(wb_properties_parse(text, "p.yaml", &properties, &why), WB_OK);
        const struct keys of_reader = keys_read(why.text);
        list_keys(&of_schema, object_at(maps[i].path));
        for (int k = 0; k < of_reader.n; k++) {
            if (!has_key(&of_schema, of_reader.all[k]))
                fail_msg("'%s': the schema lacks '%s'", maps[i].path, of_reader.all[k]);
        }
        for (int k = 0; k < of_schema.n; k++) {
            const bool is_of_root =
                maps[i].path[0] == '\0' && strcmp(of_schema.all[k], "schema") == 0;
            if (!is_of_root && !has_key(&of_reader, of_schema.all[k]))
                fail_msg("'%s': the reader lacks '%s'", maps[i].path, of_schema.all[k]);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_row_has_a_meaning),
        cmocka_unit_test(keys_of_an_object_differ),
        cmocka_unit_test(the_unit_stands_at_the_end_of_the_key),
        cmocka_unit_test(documents_are_found_by_name),
        cmocka_unit_test(the_reader_accepts_the_keys_of_the_schema),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
