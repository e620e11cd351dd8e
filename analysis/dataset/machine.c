#include "analysis/dataset/machine.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/machine_private.h"
#include "base/config.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "machine"

static const char *const kind_names[] = {"cantilever", "three-point", "tensile", NULL};
static const char *const elongation_names[] = {"crosshead", "extensometer", NULL};
static const char *const direction_names[] = {"up", "sideways", "down", NULL};

const char *wb_machine_kind_name(enum wb_test_kind kind)
{
    return kind_names[kind];
}

bool wb_machine_find_name(const char *const *names, const char *name, int *index)
{
    for (int i = 0; names[i]; i++) {
        if (strcmp(names[i], name) == 0) {
            *index = i;
            return true;
        }
    }
    return false;
}

bool wb_machine_kind_find(const char *name, enum wb_test_kind *kind)
{
    int index;
    if (!wb_machine_find_name(kind_names, name, &index))
        return false;
    *kind = (enum wb_test_kind)index;
    return true;
}

/* --- the keys --- */

#define OF(kind) (1u << (kind))
#define OF_ALL (OF(WB_TEST_CANTILEVER) | OF(WB_TEST_THREE_POINT) | OF(WB_TEST_TENSILE))

enum form {
    FORM_NUMBER, /* double, required */
    FORM_BAND,   /* struct wb_band, optional */
    FORM_CHOICE  /* int or bool, required */
};

struct key {
    const char *name;
    enum form form;
    unsigned kinds; /* test kinds that have the key */
    size_t offset;
    double unit, least, most; /* file's unit to SI; range in the file's unit */
    const char *const *choices;
};

static const struct key keys[] = {
    {"span_mm", FORM_NUMBER, OF(WB_TEST_THREE_POINT), offsetof(struct wb_machine, span), WB_MM,
     0.01, 1e5, NULL},
    {"roller_radius_mm", FORM_NUMBER, OF(WB_TEST_THREE_POINT),
     offsetof(struct wb_machine, roller_radius), WB_MM, 0.0, 1e4, NULL},
    {"nose_radius_mm", FORM_BAND, OF(WB_TEST_THREE_POINT), offsetof(struct wb_machine, nose_radius),
     WB_MM, 0.0, 1e4, NULL},
    {"friction", FORM_BAND, OF(WB_TEST_THREE_POINT), offsetof(struct wb_machine, friction), 1.0,
     0.0, 10.0, NULL},
    {"gauge_length_mm", FORM_NUMBER, OF(WB_TEST_TENSILE), offsetof(struct wb_machine, gauge_length),
     WB_MM, 0.01, 1e5, NULL},
    {"elongation", FORM_CHOICE, OF(WB_TEST_TENSILE), 0, 0.0, 0.0, 0.0, elongation_names},
    {"bends", FORM_CHOICE, OF(WB_TEST_CANTILEVER), 0, 0.0, 0.0, 0.0, direction_names},
    {"compliance_mm_N", FORM_BAND, OF_ALL, offsetof(struct wb_machine, compliance), WB_MM, 0.0, 1e4,
     NULL},
    {"speed_mm_s", FORM_BAND, OF_ALL, offsetof(struct wb_machine, speed), WB_MM, 1e-9, 1e5, NULL},
};
enum {
    KEYS = sizeof keys / sizeof keys[0]
};

static const struct wb_band unknown = {false, (double)NAN, (double)NAN, (double)NAN};

static struct wb_band band_of(double least, double most)
{
    return (struct wb_band){true, least == most ? least : 0.5 * (least + most), least, most};
}

static int get_choice(const struct wb_machine *machine, const struct key *key)
{
    return key->choices == elongation_names ? (int)machine->own_elongation : (int)machine->bends;
}

static void set_choice(struct wb_machine *machine, const struct key *key, int choice)
{
    if (key->choices == elongation_names)
        machine->own_elongation = choice != 0;
    else
        machine->bends = (enum wb_machine_direction)choice;
}

static void *member(struct wb_machine *machine, const struct key *key)
{
    return (char *)machine + key->offset;
}

static void clear(struct wb_machine *machine)
{
    memset(machine, 0, sizeof *machine);
    machine->span = machine->roller_radius = machine->gauge_length = (double)NAN;
    machine->compliance = machine->speed = unknown;
    machine->nose_radius = machine->friction = unknown;
}

/* --- the file --- */

enum wb_status wb_machine_read_band(const struct wb_config_node *node,
                                    const struct wb_config_key *key, struct wb_band *band)
{
    double numbers[2];
    int n = 2;
    struct wb_config_key number = *key;
    number.target = numbers;
    if (wb_config_length(node) < 0) {
        WB_TRY(wb_config_value(node, &number));
        numbers[1] = numbers[0];
    } else {
        WB_TRY(wb_config_numbers(node, &number, 2, 2, numbers, &n));
    }
    if (!(numbers[1] >= numbers[0]))
        return wb_config_refuse(node, key->name, "expected the least first: [%g, %g]",
                                numbers[1] / key->factor, numbers[0] / key->factor);
    *band = band_of(numbers[0], numbers[1]);
    return WB_OK;
}

static enum wb_status read_key(const struct wb_config_node *root, const struct wb_config_node *node,
                               const struct key *key, struct wb_machine *machine)
{
    if (!(key->kinds & OF(machine->kind)))
        return node ? wb_config_refuse(root, key->name, "a %s test has none: leave it out",
                                       wb_machine_kind_name(machine->kind))
                    : WB_OK;
    if (!node)
        return key->form == FORM_BAND
                   ? WB_OK
                   : wb_config_refuse(root, key->name, "this key is missing for a %s test",
                                      wb_machine_kind_name(machine->kind));
    const struct wb_config_key number = WB_CONFIG_NUMBER(key->name, (double *)member(machine, key),
                                                         key->unit, key->least, key->most);
    if (key->form == FORM_BAND)
        return wb_machine_read_band(node, &number, member(machine, key));
    if (key->form == FORM_NUMBER)
        return wb_config_value(node, &number);
    int choice = 0;
    const struct wb_config_key list = WB_CONFIG_CHOICE(key->name, &choice, key->choices);
    WB_TRY(wb_config_value(node, &list));
    set_choice(machine, key, choice);
    return WB_OK;
}

static enum wb_status read_root(const struct wb_config_node *root, void *into)
{
    struct wb_machine read, *const machine = &read;
    const struct wb_config_node *nodes[KEYS];
    struct wb_config_key table[KEYS + 2] = {
        WB_CONFIG_TEXT("name", machine->name),
        WB_CONFIG_CHOICE("kind", &machine->kind, kind_names),
    };
    clear(machine);
    for (int i = 0; i < KEYS; i++) {
        const struct wb_config_key node = WB_CONFIG_OPTIONAL_NODE(keys[i].name, &nodes[i]);
        table[i + 2] = node;
    }
    WB_TRY(wb_config_map(root, table, WB_COUNT(table)));
    for (int i = 0; i < KEYS; i++)
        WB_TRY(read_key(root, nodes[i], &keys[i], machine));
    *(struct wb_machine *)into = read;
    return WB_OK;
}

enum wb_status wb_machine_read(const char *path, struct wb_machine *machine, struct wb_reason *why)
{
    return wb_config_load(NULL, path, why, read_root, machine);
}

enum wb_status wb_machine_parse(const char *text, const char *origin, struct wb_machine *machine,
                                struct wb_reason *why)
{
    return wb_config_load(text, origin, why, read_root, machine);
}

/* --- the document of a dataset --- */

/* Rounds to 15 digits: 12.8 mm is written as 12.8, not 12.800000000000001. */
static double in_unit(double value, double unit)
{
    char text[40];
    snprintf(text, sizeof text, "%.15g", value / unit);
    return strtod(text, NULL);
}

void wb_machine_set_json(const struct wb_machine *machine, struct wb_json *object)
{
    struct wb_machine copy = *machine;
    wb_json_set_text(object, "name", machine->name);
    wb_json_set_text(object, "kind", wb_machine_kind_name(machine->kind));
    for (int i = 0; i < KEYS; i++) {
        const struct key *const key = &keys[i];
        if (!(key->kinds & OF(machine->kind)))
            continue;
        if (key->form == FORM_CHOICE) {
            wb_json_set_text(object, key->name, key->choices[get_choice(machine, key)]);
        } else if (key->form == FORM_NUMBER) {
            wb_json_set_number(object, key->name,
                               in_unit(*(const double *)member(&copy, key), key->unit));
        } else {
            const struct wb_band *const band = member(&copy, key);
            if (!band->known)
                continue;
            if (band->least == band->most) {
                wb_json_set_number(object, key->name, in_unit(band->value, key->unit));
                continue;
            }
            struct wb_json *const list = wb_json_set_array(object, key->name);
            wb_json_append_number(list, in_unit(band->least, key->unit));
            wb_json_append_number(list, in_unit(band->most, key->unit));
        }
    }
}

/* Reads one number or a list of two; false for other values or out of range. */
static bool get_numbers(const struct wb_json *value, const struct key *key, double numbers[2])
{
    if (wb_json_number(value, &numbers[0])) {
        numbers[1] = numbers[0];
    } else if (key->form != FORM_BAND || wb_json_length(value) != 2 ||
               !wb_json_number(wb_json_item(value, 0), &numbers[0]) ||
               !wb_json_number(wb_json_item(value, 1), &numbers[1])) {
        return false;
    }
    return numbers[0] >= key->least && numbers[0] <= numbers[1] && numbers[1] <= key->most;
}

static enum wb_status get_key(struct wb_machine *machine, const struct wb_json *object,
                              const struct key *key, const char *path, struct wb_reason *why)
{
    const struct wb_json *const value = wb_json_get(object, key->name);
    double numbers[2];
    const char *name;
    int choice;
    if (!value && key->form == FORM_BAND)
        return WB_OK;
    if (key->form == FORM_CHOICE) {
        if (!value || !wb_json_text(value, &name) ||
            !wb_machine_find_name(key->choices, name, &choice))
            return wb_fail_to(why, WB_ERR_FORMAT, "%s: machine.%s: expected %s or %s", path,
                              key->name, key->choices[0], key->choices[1]);
        set_choice(machine, key, choice);
        return WB_OK;
    }
    if (!value || !get_numbers(value, key, numbers))
        return wb_fail_to(why, WB_ERR_FORMAT, "%s: machine.%s: expected a number from %g to %g%s",
                          path, key->name, key->least, key->most,
                          key->form == FORM_BAND ? ", or a list of two" : "");
    if (key->form == FORM_BAND)
        *(struct wb_band *)member(machine, key) =
            band_of(numbers[0] * key->unit, numbers[1] * key->unit);
    else
        *(double *)member(machine, key) = numbers[0] * key->unit;
    return WB_OK;
}

enum wb_status wb_machine_get_json(struct wb_machine *machine, const struct wb_json *object,
                                   const char *path, struct wb_reason *why)
{
    struct wb_machine read;
    const char *name, *kind;
    clear(&read);
    if (!object || !wb_json_get_text(object, "name", &name) || strlen(name) >= sizeof read.name)
        return wb_fail_to(why, WB_ERR_FORMAT, "%s: machine.name: expected a text", path);
    strcpy(read.name, name);
    if (!wb_json_get_text(object, "kind", &kind) || !wb_machine_kind_find(kind, &read.kind))
        return wb_fail_to(why, WB_ERR_FORMAT,
                          "%s: machine.kind: expected cantilever, three-point or tensile", path);
    for (int i = 0; i < KEYS; i++) {
        if (keys[i].kinds & OF(read.kind))
            WB_TRY(get_key(&read, object, &keys[i], path, why));
    }
    *machine = read;
    return WB_OK;
}
