#include "analysis/schema/schema.h"

#include <stdio.h>
#include <string.h>

#include "analysis/calibration/properties/quantity.h"
#include "analysis/harness/harness_follow.h"
#include "analysis/harness/harness_output.h"
#include "analysis/schema/tables.h"

const struct wb_schema_document wb_schema_documents[WB_SCHEMA_DOCUMENTS] = {
    {"dataset", "dataset.json of wirebench", &wb_schema_dataset},
    {"report", "report.json of wirebench", &wb_schema_report},
    {"manifest", "manifest.json of wirebench", &wb_schema_manifest_keys},
    {"properties", "properties file of wirebench, its YAML read as JSON",
     &wb_schema_properties_keys},
    {"harness", "harness.json of wirebench", &wb_harness_output_keys},
    {"harness-answer", "answers of wirebench solve harness --follow", &wb_harness_follow_keys},
};

const struct wb_schema_document *wb_schema_find(const char *name)
{
    for (size_t i = 0; i < WB_SCHEMA_DOCUMENTS; i++) {
        if (strcmp(wb_schema_documents[i].name, name) == 0)
            return &wb_schema_documents[i];
    }
    return NULL;
}

/* The keywords of an object's schema that its rows fill. */
struct target {
    struct wb_json *definitions, *properties, *required;
};

static void add_rows(const struct target *target, const struct wb_keys *object);

/* --- definitions --- */

static struct wb_json *begin(struct target *target, struct wb_json *schema)
{
    wb_json_set_text(schema, "type", "object");
    wb_json_set_boolean(schema, "additionalProperties", false);
    target->properties = wb_json_set_object(schema, "properties");
    target->required = wb_json_set_array(schema, "required");
    return schema;
}

/* Each object is defined once, where it is first referred to. */
static void define(struct wb_json *definitions, const struct wb_keys *object)
{
    if (wb_json_get(definitions, object->name))
        return;
    struct wb_json *const schema = wb_json_set_object(definitions, object->name);
    wb_json_set_text(schema, "description", object->meaning);
    if (object->alternatives) {
        struct wb_json *const any = wb_json_set_array(schema, "anyOf");
        for (size_t i = 0; object->alternatives[i]; i++) {
            char reference[80];
            snprintf(reference, sizeof reference, "#/$defs/%s", object->alternatives[i]->name);
            wb_json_set_text(wb_json_append_object(any), "$ref", reference);
            define(definitions, object->alternatives[i]);
        }
        return;
    }
    struct target target = {.definitions = definitions};
    begin(&target, schema);
    add_rows(&target, object);
}

/* --- rows --- */

static void set_types(struct wb_json *schema, unsigned type)
{
    static const struct {
        unsigned bit;
        const char *name;
    } names[] = {{TEXT, "string"},  {NUMBER, "number"}, {INTEGER, "integer"},
                 {FLAG, "boolean"}, {OBJECT, "object"}, {UNKNOWN, "null"}};
    struct wb_json *const types = wb_json_set_array(schema, "type");
    for (size_t i = 0; i < WB_COUNT(names); i++) {
        if (type & names[i].bit)
            wb_json_append_text(types, names[i].name);
    }
}

static void set_choices(struct wb_json *schema, const char *choices)
{
    struct wb_json *const list = wb_json_set_array(schema, "enum");
    for (const char *from = choices; *from;) {
        const size_t n = strcspn(from, "|");
        char word[80];
        snprintf(word, sizeof word, "%.*s", (int)n, from);
        wb_json_append_text(list, word);
        from += n + (from[n] == '|');
    }
}

/* An object, or an object among other types. */
static void set_reference(struct wb_json *definitions, struct wb_json *schema, unsigned type,
                          const struct wb_keys *of)
{
    char reference[80];
    snprintf(reference, sizeof reference, "#/$defs/%s", of->name);
    if (type & ~(unsigned)(OBJECT | OPTIONAL | LIST)) {
        struct wb_json *const any = wb_json_set_array(schema, "anyOf");
        set_types(wb_json_append_object(any), type & ~(unsigned)OBJECT);
        wb_json_set_text(wb_json_append_object(any), "$ref", reference);
    } else {
        wb_json_set_text(schema, "$ref", reference);
    }
    define(definitions, of);
}

static void set_band(struct wb_json *schema)
{
    struct wb_json *const any = wb_json_set_array(schema, "anyOf");
    wb_json_set_text(wb_json_append_object(any), "type", "number");
    struct wb_json *const list = wb_json_append_object(any);
    wb_json_set_text(list, "type", "array");
    wb_json_set_text(wb_json_set_object(list, "items"), "type", "number");
    wb_json_set_integer(list, "minItems", 2);
    wb_json_set_integer(list, "maxItems", 2);
}

static void set_value(struct wb_json *definitions, struct wb_json *schema, const struct wb_key *row)
{
    if (row->of)
        set_reference(definitions, schema, row->type, row->of);
    else if (row->type & BAND)
        set_band(schema);
    else if (row->choices && !(row->type & UNKNOWN))
        set_choices(schema, row->choices);
    else
        set_types(schema, row->type);
}

static void add_row(const struct target *target, const struct wb_key *row)
{
    struct wb_json *const schema = wb_json_set_object(target->properties, row->key);
    if (row->type & LIST) {
        wb_json_set_text(schema, "type", "array");
        set_value(target->definitions, wb_json_set_object(schema, "items"), row);
    } else {
        set_value(target->definitions, schema, row);
    }
    if (wb_keys_unit(row)[0])
        wb_json_set_text(schema, "unit", wb_keys_unit(row));
    wb_json_set_text(schema, "description", row->meaning);
    if (!(row->type & OPTIONAL))
        wb_json_append_text(target->required, row->key);
}

/* --- settings --- */

static unsigned type_of(const struct wb_setting *setting)
{
    switch (setting->type) {
    case WB_SETTING_NUMBER:
        return NUMBER;
    case WB_SETTING_INTEGER:
        return INTEGER;
    case WB_SETTING_BOOLEAN:
        return FLAG;
    case WB_SETTING_TEXT:
    case WB_SETTING_CHOICE:
        return TEXT;
    case WB_SETTING_LIST:
        break;
    }
    return OBJECT;
}

static void add_setting(const struct target *target, const struct wb_setting *setting,
                        unsigned optional)
{
    /* As in wb_setting_set_json(), the member of a list of one stands for the list. */
    const bool is_list = setting->type == WB_SETTING_LIST && setting->members->n > 1;
    if (!is_list) {
        const struct wb_setting *const value =
            setting->type == WB_SETTING_LIST ? &setting->members->rows[0] : setting;
        const struct wb_key row = {.key = value->name,
                                   .type = type_of(value) | optional,
                                   .unit = value->unit ? value->unit : "",
                                   .meaning = setting->help ? setting->help : ""};
        add_row(target, &row);
        return;
    }
    struct target inner = {.definitions = target->definitions};
    struct wb_json *const schema = wb_json_set_object(target->properties, setting->name);
    begin(&inner, schema);
    wb_json_set_text(schema, "description", setting->help ? setting->help : "");
    for (size_t i = 0; i < setting->members->n; i++)
        add_setting(&inner, &setting->members->rows[i], 0);
    if (!optional)
        wb_json_append_text(target->required, setting->name);
}

static void add_settings(const struct target *target, const struct wb_key *row)
{
    for (size_t i = 0; i < row->settings->n; i++) {
        const struct wb_setting *const setting = &row->settings->rows[i];
        if (row->applies == 0 || wb_setting_applies(setting, row->applies))
            add_setting(target, setting, row->type & OPTIONAL);
    }
}

/* --- quantities --- */

/* The keys of an estimate; of a quantity with curvatures one of its items. */
static void add_estimate(const struct target *target, const struct wb_quantity *quantity,
                         unsigned type)
{
    const unsigned number = type & ESTIMATES ? NUMBER | UNKNOWN : NUMBER | OPTIONAL;
    const struct wb_key rows[] = {
        {quantity->value_key, number, "mean over the specimens", .unit = quantity->unit},
        {"low", number, "lower end of the 95 % confidence interval of the mean",
         .unit = quantity->unit},
        {"high", number, "upper end of that interval", .unit = quantity->unit},
        {"candidates_low", number,
         "least value over the laws that the data do not exclude; of three-point bending over "
         "friction and nose radius",
         .unit = quantity->unit},
        {"candidates_high", number, "largest value over the same", .unit = quantity->unit},
        {"scatter", NUMBER | OPTIONAL, "standard deviation of the logarithm between specimens"},
    };
    if (quantity->most > 0) {
        const struct wb_key curvature = {"curvature_1_m", NUMBER,
                                         "curvature at which the quantity is stated"};
        add_row(target, &curvature);
    }
    for (size_t i = 0; i < WB_COUNT(rows) - (type & ESTIMATES ? 1 : 0); i++)
        add_row(target, &rows[i]);
}

static struct wb_json *begin_list(struct target *target, struct wb_json *schema)
{
    wb_json_set_text(schema, "type", "array");
    return begin(target, wb_json_set_object(schema, "items"));
}

static void add_quantity(const struct target *target, const struct wb_quantity *quantity,
                         unsigned type)
{
    struct target inner = {.definitions = target->definitions};
    struct wb_json *const schema = wb_json_set_object(target->properties, quantity->key);
    if (quantity->most == 0) {
        begin(&inner, schema);
    } else if (quantity->resolved == 0) {
        begin_list(&inner, schema);
    } else {
        const struct wb_key resolved = {
            "resolved_from_1_m", type & ESTIMATES ? NUMBER | UNKNOWN : NUMBER,
            "smallest curvature that the data of all specimens resolve; below it the value follows "
            "from the law alone"};
        begin(&inner, schema);
        add_row(&inner, &resolved);
        wb_json_append_text(inner.required, "at");
        struct wb_json *const at = wb_json_set_object(inner.properties, "at");
        wb_json_set_text(at, "description", "the quantity at several curvatures");
        begin_list(&inner, at);
    }
    wb_json_set_text(schema, "unit", quantity->unit);
    wb_json_set_text(schema, "description", quantity->meaning);
    add_estimate(&inner, quantity, type);
}

static void add_rows(const struct target *target, const struct wb_keys *object)
{
    for (size_t i = 0; i < object->n; i++) {
        const struct wb_key *const row = &object->rows[i];
        if (row->key)
            add_row(target, row);
        else if (row->settings)
            add_settings(target, row);
        else if (row->quantities)
            for (enum wb_quantity_id id = 0; id < WB_QUANTITIES; id++)
                add_quantity(target, &wb_quantity_rows[id], row->type);
        else
            add_rows(target, row->of);
    }
}

struct wb_json *wb_schema_build(const struct wb_schema_document *document)
{
    struct wb_json *const schema = wb_json_create();
    char reference[80];
    snprintf(reference, sizeof reference, "#/$defs/%s", document->root->name);
    wb_json_set_text(schema, "$schema", "https://json-schema.org/draft/2020-12/schema");
    wb_json_set_text(schema, "title", document->title);
    wb_json_set_text(schema, "$ref", reference);
    define(wb_json_set_object(schema, "$defs"), document->root);
    return schema;
}
