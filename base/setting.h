/* Settings: each is one row of a table in the module that owns it. The row serves the command line
 * and its --help, YAML files, JSON documents, checks of a filled struct, the inputs of a result,
 * and the test of the documentation.
 *
 *     static const struct wb_setting rows[] = {
 *         {WB_ROW_QUANTITY(wb_example_settings, step, "step_mm", "mm", WB_MM, 0.01, 100.0, 0.5),
 *          WB_ROW_OPTION("step-mm", "H", "Deflection step of the comparison")},
 *     };
 *     const struct wb_setting_table wb_example_table = {WB_SETTING_ROWS(rows)};
 *
 * To add a setting, add its field and its row. A field holds SI; a row's numbers are in the unit of
 * files and options.
 */
#ifndef WB_BASE_SETTING_H
#define WB_BASE_SETTING_H

#include <stdbool.h>
#include <stddef.h>

#include "base/config.h"
#include "base/json.h"
#include "base/reason.h"
#include "base/status.h"
#include "base/text.h"

enum wb_setting_type {
    WB_SETTING_NUMBER,  /* double */
    WB_SETTING_INTEGER, /* int */
    WB_SETTING_BOOLEAN, /* bool; its option takes no argument and sets what the default is not */
    WB_SETTING_TEXT,    /* char[size]; of size 0 a const char *, which is borrowed */
    WB_SETTING_CHOICE,  /* int: an index of `choices` */
    WB_SETTING_LIST /* numbers, each a member with a row of its own: "0.4,0.1,2"; the first alone
                       is enough where `argument` says so: "S[,K,D]" */
};

struct wb_setting_table;

struct wb_setting {
    const char *name; /* key in files, with its unit: "step_mm" */
    const char *unit; /* "mm"; NULL: none */
    enum wb_setting_type type;
    size_t offset;         /* of the field in its struct */
    size_t size;           /* of a text's array */
    double scale;          /* SI value of one unit; 0: 1 */
    double least, largest; /* of numbers; both 0: any */
    double fallback;       /* the default, also of a boolean (0, 1) and of a choice (its index) */
    const char *otherwise; /* the default in words, in place of its number: "as eq. 10" */
    const char *const *choices; /* NULL-terminated */
    bool required;              /* files must give it; it has no default */
    /* On the command line. */
    const char *option;   /* long name; NULL: none */
    const char *argument; /* "H"; NULL: of a boolean */
    const char *help;     /* without a full stop: range and default follow */
    unsigned applies;     /* bits of the owner: places where it may be given; 0: all of its table */
    const char *zero;     /* of a number: the word that stands for 0, "max"; NULL: none */
    /* Of a list. */
    char separator;                         /* between members; 0: ',' */
    const struct wb_setting_table *members; /* their fields lie in the struct at `offset` */
    size_t given;                           /* offset of a bool that is set if it was given */
    /* Completes and checks the struct of the members after the first `n` of them were given.
     * Returns -1, or the index of an invalid member with its `problem`. */
    int (*complete)(void *members, int n, char *problem, size_t size);
};

/* A row is written with one macro for the type of its field (tag of the struct, field, key, range,
 * default), WB_ROW_OPTION where the command line has it, and further members by their names:
 *
 *     {WB_ROW_INTEGER(wb_example_settings, n_points, "points", 1, 1000, 0),
 *      WB_ROW_OPTION("points", "N", "Points of the curve"), .otherwise = "one a row"},
 *
 * A field of another type than the macro's does not compile. */
#define WB_ROW_NUMBER(struct_, field_, key_, least_, largest_, fallback_)                          \
    WB_ROW_QUANTITY(struct_, field_, key_, NULL, 1.0, least_, largest_, fallback_)
#define WB_ROW_QUANTITY(struct_, field_, key_, unit_, scale_, least_, largest_, fallback_)         \
    .name = (key_), .unit = (unit_), .type = WB_SETTING_NUMBER,                                    \
    .offset = WB_ROW_OFFSET(struct_, field_, double : 1), .scale = (scale_), .least = (least_),    \
    .largest = (largest_), .fallback = (fallback_)
#define WB_ROW_INTEGER(struct_, field_, key_, least_, largest_, fallback_)                         \
    .name = (key_), .type = WB_SETTING_INTEGER, .offset = WB_ROW_OFFSET(struct_, field_, int : 1), \
    .least = (least_), .largest = (largest_), .fallback = (fallback_)
#define WB_ROW_BOOLEAN(struct_, field_, key_, fallback_)                                           \
    .name = (key_), .type = WB_SETTING_BOOLEAN,                                                    \
    .offset = WB_ROW_OFFSET(struct_, field_, bool : 1), .fallback = (fallback_)
#define WB_ROW_TEXT(struct_, field_, key_)                                                         \
    .name = (key_), .type = WB_SETTING_TEXT, .offset = offsetof(struct struct_, field_),           \
    .size = _Generic(WB_ROW_FIELD(struct_, field_), const char * : 0,                              \
                     char * : sizeof(WB_ROW_FIELD(struct_, field_)))
#define WB_ROW_CHOICE(struct_, field_, key_, choices_, fallback_)                                  \
    .name = (key_), .type = WB_SETTING_CHOICE,                                                     \
    .offset = WB_ROW_OFFSET(struct_, field_, int : 1, unsigned : 1 /* an enum */),                 \
    .choices = (choices_), .fallback = (fallback_)
#define WB_ROW_LIST(struct_, field_, key_, members_, given_)                                       \
    .name = (key_), .type = WB_SETTING_LIST, .offset = offsetof(struct struct_, field_),           \
    .members = &(members_), .given = WB_ROW_OFFSET(struct_, given_, bool : 1)
#define WB_ROW_OPTION(option_, argument_, help_)                                                   \
    .option = (option_), .argument = (argument_), .help = (help_)

/* Used by the macros above: a field of a struct, and its offset if it has one of these types. */
#define WB_ROW_FIELD(struct_, field_) ((struct struct_ *)NULL)->field_
#define WB_ROW_OFFSET(struct_, field_, ...)                                                        \
    (offsetof(struct struct_, field_) +                                                            \
     0 * sizeof(_Generic(WB_ROW_FIELD(struct_, field_), __VA_ARGS__)))

struct wb_setting_table {
    const struct wb_setting *rows;
    size_t n;
    size_t offset; /* of the rows' struct in a larger one */
    /* The default of all rows in words, in place of their own; may be NULL. */
    const char *otherwise;
};

/* Designators of a table of an array of rows. */
#define WB_SETTING_ROWS(array) .rows = (array), .n = WB_COUNT(array)

enum {
    WB_SETTING_PROBLEM = 320, /* bytes of a message */
    WB_SETTING_VALUE = 128,   /* bytes of a value as text */
    WB_SETTING_MEMBERS = 8    /* most members of a list */
};

/* Whether the row may be given at a place, one bit; all rows may where `place` is 0. */
bool wb_setting_applies(const struct wb_setting *row, unsigned place);

/* Fills in the defaults of all rows; of a text, none. A list counts as not given. */
void wb_setting_fill(const struct wb_setting_table *table, void *settings);

/* Reads an option's argument (NULL: of a boolean) into the field. False with a `problem` that gives
 * the expected and the given value: "expected a number from 0.01 to 100, not '0'". */
bool wb_setting_parse(const struct wb_setting *row, const char *argument, void *settings,
                      char problem[WB_SETTING_PROBLEM]);

/* Keys for wb_config_map() of a place's rows, except lists; returns their number, at most the
 * table's. Fields that a file does not give are unchanged. */
size_t wb_setting_keys(const struct wb_setting_table *table, unsigned place, void *settings,
                       struct wb_config_key *keys);

/* Reads a list's value from a file: the first member alone, or a map of all. */
WB_MUST_CHECK enum wb_status wb_setting_read_list(const struct wb_setting *row,
                                                  const struct wb_config_node *node,
                                                  void *settings);

/* Checks a field, or a filled struct: numbers in their range, or as the default where there is one.
 * WB_ERR_ARGUMENT, with the reason in `why`, or logged where that is NULL. */
WB_MUST_CHECK enum wb_status wb_setting_check_row(const struct wb_setting *row,
                                                  const void *settings, struct wb_reason *why);
WB_MUST_CHECK enum wb_status wb_setting_check(const struct wb_setting_table *table,
                                              const void *settings, struct wb_reason *why);

/* Whether the field of a struct that was all zero before has been set. */
bool wb_setting_is_given(const struct wb_setting *row, const void *settings);

/* Whether the field of a filled struct differs from the row's default. */
bool wb_setting_differs(const struct wb_setting *row, const void *settings);

/* The value in the format of its option, numbers to 10 digits; of a list, the first member alone
 * if another member is out of range. */
void wb_setting_format(const struct wb_setting *row, const void *settings,
                       char text[WB_SETTING_VALUE]);

/* Sets the field as a member of an object, under the row's name. */
void wb_setting_set_json(const struct wb_setting *row, const void *settings,
                         struct wb_json *object);

/* An option's help with range and default: "Step of the comparison: 0.01 to 100 mm (0.5)". */
void wb_setting_describe(const struct wb_setting *row, const char *otherwise, struct wb_text *text);

#endif
