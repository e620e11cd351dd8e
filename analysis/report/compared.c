#include "analysis/report/compared.h"

#include <math.h>
#include <stdio.h>

#include "analysis/plot/figure.h"
#include "analysis/report/pages.h"
#include "analysis/report/pdf.h"
#include "base/units.h"
#include "base/version.h"

#define WB_LOG_DOMAIN "compare"

#define ROW_HEIGHT 12.5 /* points of a row of the figure */

static bool is_virtual(const struct wb_compared *compared)
{
    return compared->properties[0]->is_virtual || compared->properties[1]->is_virtual;
}

static bool is_simulated(const struct wb_compared *compared)
{
    return compared->properties[0]->is_simulation || compared->properties[1]->is_simulation;
}

static const char *origin(const struct wb_compared *compared)
{
    return is_virtual(compared)     ? "virtual rig"
           : is_simulated(compared) ? "simulation, no test"
                                    : NULL;
}

/* Of verdicts. */
static const enum wb_document_tone tones[] = {
    [WB_GROUPS_EQUIVALENT] = WB_TONE_GOOD,
    [WB_GROUPS_DIFFERENT] = WB_TONE_WARNING,
    [WB_GROUPS_UNDECIDED] = WB_TONE_PLAIN,
};

static double percent(double log_ratio)
{
    return expm1(log_ratio) / WB_PERCENT;
}

void wb_compared_append_verdict(struct wb_text *text, const struct wb_compare *compare)
{
    const int n = compare->n_compared;
    if (compare->verdict == WB_GROUPS_EQUIVALENT)
        wb_text_append(text, "equivalent: all %d quantities", n);
    else if (compare->verdict == WB_GROUPS_DIFFERENT)
        wb_text_append(text, "different: at least one of %d quantities", n);
    else if (compare->more > 0)
        wb_text_append(text, "cannot tell: test %d more specimens of each", compare->more);
    else
        wb_text_append(text,
                       "cannot tell: a ratio lies at the limit, where %d more specimens of each "
                       "would not do",
                       WB_WELCH_MOST);
}

/* --- the figure: each ratio with its interval --- */

static struct wb_colour colour_of(enum wb_verdict_of_groups verdict)
{
    return verdict == WB_GROUPS_EQUIVALENT  ? wb_palette_good()
           : verdict == WB_GROUPS_DIFFERENT ? wb_palette_warning()
                                            : wb_palette_grey();
}

static void add_quantity(struct wb_panel *panel, const struct wb_compare_quantity *q, double y)
{
    const double ys[2] = {y, y}, ends[2] = {percent(q->welch.low), percent(q->welch.high)};
    const double at = percent(q->welch.difference);
    const struct wb_figure_style line = {.colour = colour_of(q->verdict), .width = 1.6};
    const struct wb_figure_style dot = {
        .colour = colour_of(q->verdict), .marker = WB_MARKER_DIAMOND, .marker_size = 6.5};
    wb_figure_add_line(panel, NULL, 2, ends, ys, &line);
    wb_figure_add_line(panel, NULL, 1, &at, &y, &dot);
}

static void add_limits(struct wb_panel *panel, double within, double top)
{
    const struct wb_figure_style dashed = {
        .colour = wb_palette_ink(), .width = 0.8, .dash = WB_DASH_DASHED};
    const double ys[2] = {-0.6, top};
    for (int sign = -1; sign <= 1; sign += 2) {
        const double x = percent(sign * within), xs[2] = {x, x};
        wb_figure_add_line(panel, NULL, 2, xs, ys, &dashed);
    }
}

static enum wb_status draw(struct wb_figure **out, const struct wb_compared *compared)
{
    const struct wb_compare *const c = compared->compare;
    const char *names[WB_COMPARE_QUANTITIES];
    int n = 0;
    WB_TRY(wb_figure_create(out, "ratios", WB_PDF_WIDTH, 60.0 + ROW_HEIGHT * c->n_compared));
    struct wb_panel *const panel = wb_figure_add_panel(*out);
    wb_figure_set_axes(panel, "B over A, less 1 (%)", "");
    add_limits(panel, c->within, c->n_compared - 0.4);
    /* From the bottom up, as the table has them from the top down. */
    for (int k = WB_COMPARE_QUANTITIES - 1; k >= 0; k--) {
        if (c->quantities[k].reason)
            continue;
        names[n] = c->quantities[k].name;
        add_quantity(panel, &c->quantities[k], n++);
    }
    wb_figure_set_y_names(panel, n, names);
    wb_figure_set_y_range(panel, -0.6, n - 0.4);
    if (origin(compared))
        wb_figure_set_footer(*out, origin(compared));
    return WB_OK;
}

/* --- the text --- */

static void put_batches(struct wb_document *document, const struct wb_compared *compared)
{
    static const struct wb_document_column columns[] = {
        {""},
        {.heading = "Properties", .wraps = true},
        {.heading = "Wire", .wraps = true},
        {.heading = "<i>d</i> (mm)", .right = true},
        {.heading = "<i>n</i>", .right = true},
    };
    struct wb_document_table *const table =
        wb_document_table(document, "<i>n</i>: specimens, or series where there are several.",
                          WB_COUNT(columns), columns);
    for (int i = 0; i < WB_COMPARE_SIDES; i++) {
        const struct wb_properties *const p = compared->properties[i];
        wb_document_row(table, false);
        wb_pages_cell(table, WB_TONE_PLAIN, "<b>%c</b>", 'A' + i);
        wb_pages_cell_plain(table, WB_TONE_PLAIN, compared->names[i]);
        wb_pages_cell_plain(table, WB_TONE_PLAIN, p->wire);
        wb_pages_cell_number(table, p->outer_diameter / WB_MM, 2);
        wb_pages_cell(table, WB_TONE_PLAIN, "%d", wb_properties_units(p));
    }
    for (int i = 0; i < WB_COMPARE_SIDES; i++)
        wb_pages_put(document, WB_BLOCK_ITEM, WB_TONE_PLAIN,
                     "<b>%c</b>: SHA-256 of the file <tt>%s</tt>", 'A' + i, compared->sha256[i]);
}

static void put_verdict_cell(struct wb_document_table *table, const struct wb_compare_quantity *q)
{
    char more[40] = "";
    if (q->verdict == WB_GROUPS_UNDECIDED && q->more > 0)
        snprintf(more, sizeof more, ", +%d", q->more);
    else if (q->verdict == WB_GROUPS_UNDECIDED)
        snprintf(more, sizeof more, ", at the limit");
    wb_pages_cell(table, tones[q->verdict], "%s%s", wb_compare_word(q->verdict), more);
}

static void put_quantity(struct wb_document_table *table, const struct wb_compare_quantity *q)
{
    wb_document_row(table, false);
    struct wb_text name = {0};
    wb_text_append_escaped(&name, q->name);
    if (q->row->unit[0]) {
        wb_text_append(&name, " (");
        wb_pages_append_symbols(&name, q->row->unit);
        wb_text_append(&name, ")");
    }
    wb_document_cell(table, WB_TONE_PLAIN, wb_text_string(&name));
    wb_text_release(&name);
    if (q->reason) {
        wb_pages_cell(table, WB_TONE_QUIET, "%s", q->reason);
        return;
    }
    for (int i = 0; i < WB_COMPARE_SIDES; i++)
        wb_pages_cell(table, WB_TONE_PLAIN, "%.4g", exp(q->groups[i].mean) / q->row->scale);
    for (int i = 0; i < WB_COMPARE_SIDES; i++)
        wb_pages_cell_number(table, q->groups[i].deviation / WB_PERCENT, 1);
    wb_pages_cell_number(table, exp(q->welch.difference), 3);
    wb_pages_cell(table, WB_TONE_PLAIN, "%.3f to %.3f", exp(q->welch.low), exp(q->welch.high));
    put_verdict_cell(table, q);
}

static void put_quantities(struct wb_document *document, const struct wb_compare *compare)
{
    static const struct wb_document_column columns[] = {
        {.heading = "Quantity", .wraps = true},
        {.heading = "A", .right = true},
        {.heading = "B", .right = true},
        {.heading = "<i>s</i><sub>A</sub> (%)", .right = true},
        {.heading = "<i>s</i><sub>B</sub> (%)", .right = true},
        {.heading = "B/A", .right = true},
        {.heading = "90 % interval", .right = true},
        {.heading = "Verdict"},
    };
    struct wb_document_table *const table = wb_document_table(
        document,
        "A and B: means (of logarithms) over the specimens; <i>s</i>: standard deviation of the "
        "logarithm between them. +: specimens of each batch to test on top.",
        (int)WB_COUNT(columns), columns);
    for (int k = 0; k < WB_COMPARE_QUANTITIES; k++)
        put_quantity(table, &compare->quantities[k]);
}

static void put_method(struct wb_document *document, const struct wb_compare *c)
{
    wb_pages_put(
        document, WB_BLOCK_PARAGRAPH, WB_TONE_PLAIN,
        "Welch's interval of the logarithm of the ratio, 90 %%. Within \xc2\xb1%.4g (%+.1f to "
        "%+.1f %%): equivalent. Outside of it as a whole: different. Else the specimens cannot "
        "tell. <i>\xce\xb1</i> = %g for each verdict, %d quantities. That all are equivalent is "
        "wrongly said with a probability of at most %g, that at least one is different of at most "
        "%.2g (Bonferroni; the quantities are correlated). The number of specimens more lets four "
        "of five such comparisons decide if mean and scatter are those found.",
        c->within, percent(-c->within), percent(c->within), WB_COMPARE_ALPHA, c->n_compared,
        WB_COMPARE_ALPHA, fmin(1.0, c->n_compared * WB_COMPARE_ALPHA));
    wb_document_paragraph(
        document, "Gain of the cell, lengths and diameter cancel where both batches were tested "
                  "on one bench; between two benches they are in the ratio and not in the "
                  "interval. The interval holds the scatter between specimens, not the choice of "
                  "a law.");
}

static void build(struct wb_document *document, const struct wb_compared *compared,
                  const struct wb_figure *figure)
{
    const struct wb_compare *const c = compared->compare;
    struct wb_text text = {0};
    char footer[160], subtitle[160];
    snprintf(footer, sizeof footer, "wirebench %s, revision %s%s%s", wb_version(),
             wb_version_revision(), origin(compared) ? " \xc2\xb7 " : "",
             origin(compared) ? origin(compared) : "");
    snprintf(subtitle, sizeof subtitle, "A: %.60s \xc2\xb7 B: %.60s", compared->names[0],
             compared->names[1]);
    wb_document_init(document, "Comparison of two batches", "Two batches in bending", subtitle,
                     footer, "");
    if (is_virtual(compared))
        wb_document_notice(document, WB_TONE_ORIGIN,
                           "<b>Virtual rig.</b> Specimens of a virtual rig are among these: no "
                           "physical wire was tested there.");
    else if (is_simulated(compared))
        wb_document_notice(document, WB_TONE_ORIGIN,
                           "<b>Simulation.</b> Computed tests are among these.");
    wb_text_append(&text, "<b>Verdict:</b> ");
    wb_compared_append_verdict(&text, c);
    wb_text_append(&text, ", within \xc2\xb1%.4g of the logarithm of B over A.", c->within);
    wb_pages_put_text(document, WB_BLOCK_NOTICE, tones[c->verdict], &text);
    put_batches(document, compared);
    wb_document_heading(document, 2, "quantities", "Quantities");
    put_quantities(document, c);
    wb_document_figures(document, figure,
                        "Ratio of each quantity with its interval of 90 %. Dashed: the limits.",
                        NULL, NULL);
    put_method(document, c);
}

enum wb_status wb_compared_write(const struct wb_compared *compared, const char *path, bool force)
{
    struct wb_figure *figure = NULL;
    struct wb_document document = {0};
    if (!force && wb_file_exists(path))
        return wb_fail(WB_ERR_EXISTS, "'%s' exists: choose another name, or --force", path);
    enum wb_status status = draw(&figure, compared);
    if (status == WB_OK) {
        build(&document, compared, figure);
        status = wb_pdf_write(&document, path);
    }
    wb_document_release(&document);
    wb_figure_destroy(figure);
    return status;
}
