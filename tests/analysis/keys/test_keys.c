#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/keys/row.h"
#include "base/units.h"
#include "tests/messages.h"

struct size {
    double length, width; /* m */
    int holes;
};

struct plate {
    char name[16];
    const char *notes;
    struct size size;
    bool is_painted;
    double force, moment[2]; /* N, N m */
    long weighings;
    int n;
    const double *depth; /* (n) m */
};

struct paint {
    double layer; /* m */
};

#define SIZE(member) WB_AT(struct size, member)
#define PLATE(member) WB_AT(struct plate, member)

static const struct wb_key size_rows[] = {
    {"length", SIZE(length), "length, in the unit of the object"},
    {"width_mm", SIZE(width) | ROUNDED, "width"},
    {"holes", SIZE(holes), "number of holes"},
};
static WB_KEYS(size, "size", "Size of a plate.");

static const struct wb_key plate_rows[] = {
    {"name", PLATE(name), "name of the plate"},
    {"notes", PLATE(notes) | IF_KNOWN, "notes"},
    {"sum", INTEGER, "set by code"},
    {"size_mm", PLATE(size), "size", &size_keys},
    {"colour", WB_CHOICE(struct plate, is_painted), "colour", .choices = "none|blue"},
    {"layer_mm", WB_AT(struct paint, layer), "thickness of the paint"},
    {"force_mN", PLATE(force) | IF_KNOWN, "force"},
    {"moment_N_mm", WB_FULL(struct plate, moment) | UNKNOWN, "moments"},
    {"weighings", PLATE(weighings), "number of weighings"},
    {"depth_mm", WB_POINTER(struct plate, depth, n), "depths"},
};
static WB_KEYS(plate, "plate", "A plate.");

static const double depths[] = {0.001, 0.002};
static const struct plate made = {.name = "p",
                                  .size = {0.5, 1.0 / 3.0, 4},
                                  .is_painted = true,
                                  .force = (double)NAN,
                                  .moment = {0.001, (double)NAN},
                                  .weighings = 7,
                                  .n = 2,
                                  .depth = depths};

static char *text_of(struct wb_json *object)
{
    char *const text = wb_json_format(object);
    wb_json_destroy(object);
    for (char *from = text, *to = text;; from++) {
        if (*from != ' ' && *from != '\n')
            *to++ = *from;
        if (*from == '\0')
            return text;
    }
}

static void members_are_written_in_the_order_of_the_rows(void **state)
{
    (void)state;
    const struct paint paint = {0.0001};
    struct wb_json *const object = wb_json_create();
    WB_PUT(object, &plate_keys, struct plate, &made);
    wb_json_set_integer(object, "sum", 1);
    WB_PUT(object, &plate_keys, struct plate, &made);
    WB_PUT(object, &plate_keys, struct paint, &paint);
    WB_PUT(object, &plate_keys, struct plate, &made);
    char *const text = text_of(object);
    assert_string_equal(text, "{\"name\":\"p\",\"sum\":1,\"size_mm\":{\"length\":500,"
                              "\"width_mm\":333.333,\"holes\":4},\"colour\":\"blue\","
                              "\"layer_mm\":0.1,\"moment_N_mm\":[1,null],\"weighings\":7,"
                              "\"depth_mm\":[1,2]}");
    free(text);
}

static void known_values_are_written(void **state)
{
    (void)state;
    struct plate other = made;
    other.notes = "flat";
    other.force = 0.002;
    struct wb_json *const object = wb_json_create();
    WB_PUT(object, &plate_keys, struct plate, &other);
    wb_json_set_integer(object, "sum", 1);
    wb_json_set_number(object, "layer_mm", 0.0);
    WB_PUT(object, &plate_keys, struct plate, &other);
    const char *notes;
    double force;
    assert_true(wb_json_get_text(object, "notes", &notes));
    assert_string_equal(notes, "flat");
    assert_true(wb_json_get_number(object, "force_mN", &force));
    assert_true(force == 0.002 / WB_MN);
    wb_json_destroy(object);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(members_are_written_in_the_order_of_the_rows),
        cmocka_unit_test(known_values_are_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
