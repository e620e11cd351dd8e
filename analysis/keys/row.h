/* What a file with tables of keys needs: the bits of a row's type and the place of its value. Only
 * .c files include it, because the bits have no prefix. */
#ifndef WB_ANALYSIS_KEYS_ROW_H
#define WB_ANALYSIS_KEYS_ROW_H

#include "analysis/keys/keys.h"
#include "base/config.h"

enum {
    TEXT = 1,
    NUMBER = 2,
    INTEGER = 4,
    FLAG = 8,
    OBJECT = 16,
    LIST = 32,       /* of the type beside it */
    UNKNOWN = 64,    /* null where the value is not known; of a list: an item may be null */
    OPTIONAL = 128,  /* the key may be absent */
    BAND = 256,      /* a number, or a list of the least and the largest one */
    ESTIMATES = 512, /* of quantities: unknown numbers are null and not absent */
    ROUNDED = 1024,  /* a number is written to six digits */
    IF_KNOWN = 2048 | OPTIONAL /* absent where the number is not known or the text is empty */
};

/* Defines the object NAME_keys of the rows NAME_rows. */
#define WB_KEYS(of, name, meaning)                                                                 \
    const struct wb_keys of##_keys = {name, meaning, of##_rows, WB_COUNT(of##_rows)}

/* The macros below give the type of a row and the place of its value, from the type of the member:
 *
 *     {"length_mm", WB_AT(struct rod, length) | UNKNOWN, "length"},
 */
/* clang-format off */
#define WB_KEY_FORM(value) _Generic(&(value), \
    double *: WB_KEY_DOUBLE, \
    int *: WB_KEY_INT, unsigned *: WB_KEY_INT, \
    long *: WB_KEY_LONG, unsigned long *: WB_KEY_LONG, long long *: WB_KEY_LONG, \
    bool *: WB_KEY_BOOL, \
    char **: WB_KEY_POINTER, const char **: WB_KEY_POINTER, \
    default: WB_KEY_INSIDE)
#define WB_KEY_TYPE(value) _Generic((value), \
    double: NUMBER, bool: FLAG, char *: TEXT, const char *: TEXT, \
    int: INTEGER, unsigned: INTEGER, long: INTEGER, unsigned long: INTEGER, long long: INTEGER, \
    default: OBJECT)
/* clang-format on */
#define WB_KEY_MEMBER(in_, member) ((in_ *)0)->member

/* A member: a number, text, flag or struct; WB_CHOICE: the index of one of the row's choices. */
#define WB_AT(in, member)                                                                          \
    .place = {#in, WB_KEY_FORM(WB_KEY_MEMBER(in, member)), offsetof(in, member)},                  \
    .type = WB_KEY_TYPE(WB_KEY_MEMBER(in, member))
#define WB_CHOICE(in, member)                                                                      \
    .place = {#in, WB_KEY_FORM(WB_KEY_MEMBER(in, member)), offsetof(in, member)}, .type = TEXT

/* The struct itself, for an object within another that is made of the same struct. */
#define WB_HERE(in_) .place = {.in = #in_, .form = WB_KEY_INSIDE}, .type = OBJECT

/* A list: an array in the struct, or one that it points to, whose length `n` is an int in the
 * struct; or an array that is always full. */
#define WB_ARRAY(in, member, n)                                                                    \
    .place = {WB_KEY_ITEMS(in, member), .length = offsetof(in, n)},                                \
    .type = LIST | WB_KEY_TYPE(WB_KEY_MEMBER(in, member)[0])
#define WB_POINTER(in, member, n)                                                                  \
    .place = {WB_KEY_ITEMS(in, member), .length = offsetof(in, n), .is_pointer = true},            \
    .type = LIST | WB_KEY_TYPE(WB_KEY_MEMBER(in, member)[0])
#define WB_FULL(in, member)                                                                        \
    .place = {WB_KEY_ITEMS(in, member), .count = WB_COUNT(WB_KEY_MEMBER(in, member))},             \
    .type = LIST | WB_KEY_TYPE(WB_KEY_MEMBER(in, member)[0])
#define WB_KEY_ITEMS(in_, member)                                                                  \
    .in = #in_, .form = WB_KEY_FORM(WB_KEY_MEMBER(in_, member)[0]),                                \
    .offset = offsetof(in_, member), .step = sizeof(WB_KEY_MEMBER(in_, member)[0])

#endif
