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
            if (length < 3 || row->meaning[length - 1] == '.' || !row->unit)
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

/* What a key ends in, and its unit; of several that fit the first counts. */
static const struct {
    const char *end, *unit;
} units[] = {
    {"_N_mm2", "N mm2"},   {"_N_mm3", "N/mm3"}, {"_N_mm", "N mm"},
    {"_Nmm2", "N mm2"},    {"_Nmm", "N mm"},    {"_Nm", "N m"},
    {"_mm_N", "mm/N"},     {"_mm_s", "mm/s"},   {"_mJ_per_m", "mJ/m"},
    {"_mJ_per_s", "mJ/s"}, {"_per_mm", "1/mm"}, {"_1_mm", "1/mm"},
    {"_1_m", "1/m"},       {"_1_s", "1/s"},     {"_per_s", "1/s"},
    {"_g_cm3", "g/cm3"},   {"_kg_m", "kg/m"},   {"_g_m", "g/m"},
    {"_m_s2", "m/s2"},     {"_mm2", "mm2"},     {"_mm", "mm"},
    {"_ms", "ms"},         {"_mN", "mN"},       {"_mJ", "mJ"},
    {"_MPa", "MPa"},       {"_MB", "MB"},       {"_mrad", "mrad"},
    {"_rad", "rad"},       {"_deg", "degree"},  {"_degrees", "degree"},
    {"_ppm", "ppm"},       {"_percent", "%"},   {"_N", "N"},
    {"_J", "J"},           {"_g", "g"},         {"_s", "s"},
};

/* Of keys whose end is a unit of something else. */
static const char *const exceptions[] = {"fracture_energy_N_mm", /* N/mm */
                                         "per_percent_of_counterweight_mm",
                                         "specimens_for_5_percent",
                                         "jacket_modulus_per_percent_of_core_MPa"};

static bool is_exception(const char *key)
{
    for (size_t i = 0; i < WB_COUNT(exceptions); i++) {
        if (strcmp(key, exceptions[i]) == 0)
            return true;
    }
    return false;
}

static const char *unit_of(const char *key)
{
    for (size_t i = 0; i < WB_COUNT(units); i++) {
        const size_t n = strlen(units[i].end), length = strlen(key);
        if (length > n && strcmp(key + length - n, units[i].end) == 0)
            return units[i].unit;
    }
    return "";
}

static void the_unit_in_a_key_is_that_of_its_row(void **state)
{
    (void)state;
    const struct objects objects = collect_all();
    for (int i = 0; i < objects.n; i++) {
        for (size_t k = 0; k < objects.all[i]->n; k++) {
            const struct wb_key *const row = &objects.all[i]->rows[k];
            if (!row->key || is_exception(row->key) || unit_of(row->key)[0] == '\0')
                continue;
            if (strcmp(unit_of(row->key), row->unit) != 0)
                fail_msg("%s.%s: unit '%s', the key says '%s'", objects.all[i]->name, row->key,
                         row->unit, unit_of(row->key));
        }
    }
}

static void documents_are_found_by_name(void **state)
{
    (void)state;
    assert_ptr_equal(wb_schema_find("properties")->root, &wb_schema_properties);
    assert_null(wb_schema_find("Properties"));
    for (size_t i = 0; i < WB_SCHEMA_DOCUMENTS; i++) {
        char *text;
        struct wb_json *const schema = wb_schema_build(&wb_schema_documents[i]);
        assert_int_equal(wb_json_format(schema, &text), WB_OK);
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
    const struct wb_keys *object = &wb_schema_properties;
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
        cmocka_unit_test(the_unit_in_a_key_is_that_of_its_row),
        cmocka_unit_test(documents_are_found_by_name),
        cmocka_unit_test(the_reader_accepts_the_keys_of_the_schema),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
