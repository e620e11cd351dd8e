#include "analysis/predict/sweep.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"

#define WB_LOG_DOMAIN "bands"

enum {
    AXES = 3,
    VALUES = 16
};

static const struct kind {
    const char *name;
    double least, largest;
    bool is_whole;
} kinds[AXES] = {
    {"layers", 1.0, 20.0, true}, {"overlap", 0.0, 95.0, false}, {"wires", 1.0, 128.0, true}};

/* A key and its values. */
struct axis {
    int kind, n;
    double value[VALUES];
};

static enum wb_status report_syntax(const char *text, const char *at)
{
    return wb_fail(
        WB_ERR_ARGUMENT,
        "--sweep: '%s', at '%s': expected layers=1,2:overlap=0,50:wires=7,19 with any of "
        "these keys, each once, and at most %d values of a key (layers 1 to 20, overlap "
        "0 to 95 percent, wires 1 to 128)",
        text, at, VALUES);
}

static int find_kind(const char *text, size_t length)
{
    for (int k = 0; k < AXES; k++)
        if (strlen(kinds[k].name) == length && strncmp(kinds[k].name, text, length) == 0)
            return k;
    return -1;
}

static enum wb_status parse_axis(const char *text, const char **at, struct axis *axis)
{
    const char *const begin = *at;
    const size_t length = strcspn(begin, "=");
    *axis = (struct axis){.kind = find_kind(begin, length)};
    if (axis->kind < 0 || begin[length] != '=')
        return report_syntax(text, begin);
    const struct kind *const kind = &kinds[axis->kind];
    const char *next = begin + length;
    do {
        char *end;
        const double value = strtod(next + 1, &end);
        const bool is_in_range = value >= kind->least && value <= kind->largest;
        if (end == next + 1 || !is_in_range || axis->n == VALUES || strchr(" \t+-", next[1]) ||
            (kind->is_whole && value != (int)value))
            return report_syntax(text, next + 1);
        axis->value[axis->n++] = value;
        next = end;
    } while (*next == ',');
    *at = next;
    return *next == ':' || *next == '\0' ? WB_OK : report_syntax(text, next);
}

static void vary(struct wb_bundle_variant *variant, const struct axis *axis, double value)
{
    const size_t used = strlen(variant->name);
    snprintf(variant->name + used, sizeof variant->name - used, "%s%s=%g", used > 0 ? ":" : "",
             kinds[axis->kind].name, value);
    if (axis->kind == 0)
        variant->layers = (int)value;
    else if (axis->kind == 1)
        variant->lap = value * WB_PERCENT;
    else
        variant->wires = (int)value;
}

static enum wb_status parse_axes(const char *text, struct axis axis[AXES], int *n)
{
    bool is_used[AXES] = {false};
    const char *at = text;
    *n = 0;
    for (;; at++) {
        if (*n == AXES)
            return report_syntax(text, at);
        WB_TRY(parse_axis(text, &at, &axis[*n]));
        if (is_used[axis[*n].kind])
            return report_syntax(text, kinds[axis[*n].kind].name);
        is_used[axis[(*n)++].kind] = true;
        if (*at == '\0')
            return WB_OK;
    }
}

enum wb_status wb_sweep_parse(const char *text, int most, struct wb_bundle_variant *variants,
                              int *n)
{
    struct axis axis[AXES];
    int n_axes, all = 1;

    WB_TRY(parse_axes(text, axis, &n_axes));
    for (int k = 0; k < n_axes; k++)
        all *= axis[k].n;
    if (all > most)
        return wb_fail(WB_ERR_ARGUMENT, "--sweep: '%s' has %d combinations: expected at most %d",
                       text, all, most);
    for (int i = 0; i < all; i++) {
        variants[i] = (struct wb_bundle_variant){.wires = 0};
        for (int k = 0, block = all; k < n_axes; k++) {
            block /= axis[k].n;
            vary(&variants[i], &axis[k], axis[k].value[i / block % axis[k].n]);
        }
    }
    *n = all;
    return WB_OK;
}
