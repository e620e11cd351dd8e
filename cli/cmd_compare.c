/* wirebench compare: two batches, by the properties of each. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/report/compared.h"
#include "base/number.h"
#include "cli/command.h"
#include "cli/file_kind.h"
#include "cli/finding.h"

#define WB_LOG_DOMAIN "compare"

struct options {
    struct wb_command_common common;
    double within; /* 0: not given */
};

#define KEY_WITHIN WB_KEY_OWN

static const double least_within = 1e-4, most_within = 2.0;

static const struct argp_option option_table[] = {
    {"within", KEY_WITHIN, "X", 0,
     "Equivalence limit of the logarithm of the ratio, 0.0001 to 2: 0.1 is -9.5 to +10.5 % "
     "(required)"},
    {"output", 'o', "FILE.pdf", 0, "Write one page (PDF)"},
    {"force", WB_KEY_FORCE, NULL, 0, "Replace the file"},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object"},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *const o = state->input;
    if (key == KEY_WITHIN) {
        if (!wb_number_parse(argument, &o->within) ||
            !(o->within >= least_within && o->within <= most_within))
            argp_error(state, "--within: expected a number from %g to %g, not '%s'", least_within,
                       most_within, argument);
        return 0;
    }
    if (key == ARGP_KEY_END) {
        if (o->common.n > WB_COMPARE_SIDES)
            argp_error(state, "expected two properties files, not %d", o->common.n);
        if (o->common.n == WB_COMPARE_SIDES && !(o->within > 0.0))
            argp_error(state, "equivalence limit missing: --within X");
    }
    return wb_command_parse_common(key, argument, state);
}

static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .args_doc = "A.yaml B.yaml",
    .doc = "Compares two batches (lots, suppliers, temperatures) by their properties files of "
           "`calibrate`: EI, residual curvature ratio and moments at the same curvatures. A "
           "quantity is equivalent where the 90 % interval (Welch) of the logarithm of the ratio "
           "B/A lies within -X to X, different where all of it lies outside, and undecided "
           "otherwise; then the number of further specimens is printed.\v"
           "Exit codes: 0 all quantities are equivalent; 1 a file cannot be used; 2 wrong usage; 3 "
           "undecided; 4 a quantity is different.",
};

/* The ratio that is farthest from 1. */
static void append_farthest(struct wb_text *text, const struct wb_compare *c)
{
    const struct wb_compare_quantity *farthest = NULL;
    for (int k = 0; k < WB_COMPARE_QUANTITIES; k++) {
        const struct wb_compare_quantity *const q = &c->quantities[k];
        if (!q->reason &&
            (!farthest || fabs(q->welch.difference) > fabs(farthest->welch.difference)))
            farthest = q;
    }
    if (farthest)
        wb_text_append(text, "; farthest: %s, B/A %.3f (%.3f to %.3f)", farthest->name,
                       exp(farthest->welch.difference), exp(farthest->welch.low),
                       exp(farthest->welch.high));
}

static void append_next(struct wb_text *text, const struct wb_compare *c)
{
    if (c->verdict == WB_GROUPS_EQUIVALENT)
        wb_text_append(text, "use one set of properties for both batches");
    else if (c->verdict == WB_GROUPS_DIFFERENT)
        wb_text_append(text, "keep the properties of the batches apart");
    else if (c->more > 0)
        wb_text_append(text, "test %d more specimens of each batch and compare again", c->more);
    else
        wb_text_append(text,
                       "a ratio lies at the limit: more specimens do not help, choose another "
                       "--within");
}

static void print(const struct options *o, const struct wb_compare *c,
                  const struct wb_compared *page)
{
    struct wb_finding finding = {.figure = o->common.output};
    for (int i = 0; i < WB_COMPARE_SIDES; i++) {
        const struct wb_properties *const p = page->properties[i];
        printf("%c  %s: wire %s, %d specimen%s (%s)\n", "AB"[i], page -> names[i], p -> wire,
               p -> n_samples, p -> n_samples == 1 ? "" : "s", wb_finding_properties_source(p));
    }
    for (int k = 0; k < WB_COMPARE_QUANTITIES; k++) {
        const struct wb_compare_quantity *const q = &c->quantities[k];
        if (q->reason) {
            printf("%-31s %s\n", q->name, q->reason);
            continue;
        }
        printf("%-31s A %.4g  B %.4g %s  B/A %.3f (%.3f to %.3f)  %s", q->name,
               exp(q->groups[0].mean) / q->row->scale, exp(q->groups[1].mean) / q->row->scale,
               q->row->unit, exp(q->welch.difference), exp(q->welch.low), exp(q->welch.high),
               wb_compare_word(q->verdict));
        if (q->verdict == WB_GROUPS_UNDECIDED && q->more > 0)
            printf(", test %d more of each", q->more);
        printf("\n");
    }
    wb_compared_append_verdict(&finding.found, c);
    append_farthest(&finding.found, c);
    wb_text_append(&finding.trust,
                   "Welch's intervals of 90 %% of ln(B/A) against +-%g (alpha %g each)", c->within,
                   WB_COMPARE_ALPHA);
    if (c->n_compared < WB_COMPARE_QUANTITIES)
        wb_text_append(&finding.trust, "; %d of %d quantities cannot be compared",
                       WB_COMPARE_QUANTITIES - c->n_compared, WB_COMPARE_QUANTITIES);
    append_next(&finding.next, c);
    wb_finding_print(&finding);
}

/* The name of a file on the page: its file name or, where both are equal, its path from the first
 * folder that differs. */
static const char *name_of(const char *path, const char *other)
{
    const char *at = path + strlen(path), *end = other + strlen(other);
    while (at > path && end > other && at[-1] == end[-1])
        at--, end--;
    if (at == path && end == other)
        return wb_file_name(path);
    while (at > path && at[-1] != '/')
        at--;
    return strchr(at, '/') ? at : wb_file_name(path);
}

static enum wb_status run(const struct options *o, struct wb_compare *compare,
                          struct wb_properties properties[WB_COMPARE_SIDES])
{
    struct wb_compared page = {.compare = compare};
    for (int i = 0; i < WB_COMPARE_SIDES; i++) {
        WB_TRY(wb_file_kind_check(o->common.inputs[i], WB_FILE_BIT(WB_FILE_PROPERTIES)));
        WB_TRY(wb_properties_read(o->common.inputs[i], &properties[i]));
        WB_TRY(wb_hash_file(o->common.inputs[i], page.sha256[i]));
        page.properties[i] = &properties[i];
        page.names[i] = name_of(o->common.inputs[i], o->common.inputs[1 - i]);
    }
    if (strcmp(page.sha256[0], page.sha256[1]) == 0)
        wb_warn("'%s' and '%s' have the same contents; expected two calibrations",
                o->common.inputs[0], o->common.inputs[1]);
    WB_TRY(wb_compare_run(compare, page.properties, page.names, o->within));
    if (o->common.output)
        WB_TRY(wb_compared_write(&page, o->common.output, o->common.force));
    if (o->common.json)
        wb_command_print_json(wb_compare_json(compare, page.properties, page.names));
    else
        print(o, compare, &page);
    return WB_OK;
}

int wb_cmd_compare(int argc, char **argv)
{
    static const int codes[] = {[WB_GROUPS_EQUIVALENT] = WB_EXIT_OK,
                                [WB_GROUPS_DIFFERENT] = WB_EXIT_LIMIT,
                                [WB_GROUPS_UNDECIDED] = WB_EXIT_INCOMPLETE};
    static struct wb_properties properties[WB_COMPARE_SIDES];
    struct options options = {.common = {.noun = "two properties files", .least = 2}};
    struct wb_compare compare = {.within = 0.0};
    wb_command_parse(&argp, argc, argv, &options);
    const enum wb_status status = run(&options, &compare, properties);
    return status == WB_OK ? codes[compare.verdict] : wb_command_exit(status);
}
