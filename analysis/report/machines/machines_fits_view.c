/* Calibrated wires and tests left out in a report: figures, a chapter, numbers. */
#include "analysis/report/machines/machines_kind.h"

#include <math.h>

#include "analysis/keys/row.h"
#include "analysis/report/numbers.h"
#include "analysis/report/pages.h"
#include "analysis/report/pdf.h"
#include "base/units.h"

static const char *wire_of(const struct wb_machines_results *results,
                           const struct wb_machines_fit *fit)
{
    return results->campaign->groups[fit->first].piece.wire;
}

/* --- figures --- */

int wb_machines_fits_count(const void *context)
{
    const struct wb_machines_results *const results = context;
    return results->fits.n;
}

enum wb_status wb_machines_fits_draw(struct wb_figures_item *item)
{
    const struct wb_machines_results *const results = item->results;
    const struct wb_machines_fit *const fit = &results->fits.fits[item->index];
    const struct wb_left_out *const r = &fit->left_out;
    const struct wb_figure_style mean = {wb_palette_ink(), 1.4, WB_DASH_SOLID, WB_MARKER_NONE, 0.0};
    const struct wb_figure_style model = {wb_palette_wire(1), 1.4, WB_DASH_DASHED, WB_MARKER_NONE,
                                          0.0};
    double x[WB_LEFT_OUT_GRID], y[4][WB_LEFT_OUT_GRID];
    char name[32], wire[400];
    if (!fit->is_validated)
        return WB_OK;
    for (int k = 0; k < WB_LEFT_OUT_GRID; k++) {
        x[k] = r->deflection[k] / WB_MM;
        y[0][k] = r->mean[k] / WB_MN;
        y[1][k] = (r->mean[k] - r->deviation[k]) / WB_MN;
        y[2][k] = (r->mean[k] + r->deviation[k]) / WB_MN;
        y[3][k] = (r->mean[k] + r->offset[k]) / WB_MN;
    }
    const double *const edges[2] = {y[1], y[2]};
    snprintf(name, sizeof name, "fit-%d", item->index + 1);
    WB_TRY(wb_figure_create(&item->figure, name, WB_PDF_WIDTH, 190.0));
    wb_figure_set_footer(item->figure, "measured, with a model");
    struct wb_panel *const panel = wb_figure_add_panel(item->figure);
    wb_figure_set_axes(panel, "Deflection from the first contact (mm)", "Force (mN)");
    wb_figure_set_y_range(panel, 0.0, (double)NAN);
    wb_figure_add_band(panel, "tests, mean \xc2\xb1 s", WB_LEFT_OUT_GRID, x, edges,
                       wb_palette_fade(wb_palette_grey(), 0.3));
    wb_figure_add_line(panel, "tests, mean", WB_LEFT_OUT_GRID, x, y[0], &mean);
    wb_figure_add_line(panel, "laws of the others", WB_LEFT_OUT_GRID, x, y[3], &model);
    wb_text_append(&item->caption,
                   "Wire %s: mean of %d tests, and the law of the other tests, mean over the tests "
                   "left out.",
                   wb_pages_escape(wire, sizeof wire, wire_of(results, fit)), r->n);
    return WB_OK;
}

/* --- pages --- */

static void put_estimate(struct wb_document_table *table, const struct wb_estimate *e, double unit,
                         bool is_quiet)
{
    const enum wb_document_tone tone = is_quiet ? WB_TONE_QUIET : WB_TONE_PLAIN;
    wb_pages_cell(table, tone, "%.*f", wb_pages_decimals(e->value / unit), e->value / unit);
    wb_pages_cell_range(table, tone, e->low / unit, e->high / unit,
                        wb_pages_decimals(e->high / unit));
    wb_pages_cell_range(table, tone, e->candidates_low / unit, e->candidates_high / unit,
                        wb_pages_decimals(e->candidates_high / unit));
}

/* Lists why a wire was not fitted or validated, and why single tests were not fitted. */
static void put_problems(struct wb_document *document, const struct wb_machines_results *results,
                         const struct wb_machines_fit *fit)
{
    if (!fit->is_validated)
        wb_pages_item(document, WB_TONE_WARNING, "<b>", wire_of(results, fit),
                      "</b>: ", fit->n > 0 ? fit->why.text : "no test");
    for (int i = 0; fit->is_fitted && i < fit->calibration.n_members; i++) {
        const struct wb_three_point_member *const m = &fit->calibration.members[i];
        if (!m->is_fitted)
            wb_pages_item(document, WB_TONE_WARNING, "<b>", wire_of(results, fit),
                          "</b>: ", m->why.text);
    }
}

static void put_counts(struct wb_document_table *table, const struct wb_machines_fit *fit)
{
    const struct wb_three_point_calibration *const c = &fit->calibration;
    const int unconverged = wb_machines_fits_count_unconverged(fit);
    wb_pages_cell(table, c->n_fitted < fit->n ? WB_TONE_WARNING : WB_TONE_PLAIN, "%d of %d",
                  c->n_fitted, fit->n);
    if (unconverged > 0)
        wb_pages_cell(table, WB_TONE_WARNING, "%d not", unconverged);
    else
        wb_pages_cell(table, WB_TONE_PLAIN, "all");
    wb_pages_cell(table, WB_TONE_PLAIN, "%.1f", c->misfit / WB_PERCENT);
}

static void put_calibrations(struct wb_document *document,
                             const struct wb_machines_results *results)
{
    static const struct wb_document_column columns[] = {
        {"Wire", .right = false},
        {"Fitted", .right = true},
        {"Converged", .right = true},
        {"Misfit (%)", .right = true},
        {"<i>\xce\xba</i> (1/m)", .right = true},
        {"<i>M</i> (N mm)", .right = true},
        {"95 %", .right = true},
        {"friction and nose", .right = true},
    };
    static const int at[] = {2, 3, 4};
    struct wb_document_table *const table = wb_document_table(
        document,
        "Moment over curvature of each wire, by a law fitted to each test in its usable range. The "
        "interval is over tests, or over the means of series; the last column is the range over "
        "the friction and nose radii of the machine file. Misfit: root mean square relative to the "
        "largest force.",
        (int)WB_COUNT(columns), columns);
    for (int i = 0; i < results->fits.n; i++) {
        const struct wb_machines_fit *const fit = &results->fits.fits[i];
        const struct wb_three_point_calibration *const c = &fit->calibration;
        for (size_t k = 0; k < WB_COUNT(at); k++) {
            if (!fit->is_fitted && k > 0)
                continue;
            wb_document_row(table, k == 0);
            wb_pages_cell_plain(table, WB_TONE_PLAIN, k == 0 ? wire_of(results, fit) : "");
            if (!fit->is_fitted) {
                wb_pages_cell_plain(table, WB_TONE_WARNING, "none");
                continue;
            }
            if (k == 0) {
                put_counts(table, fit);
            } else {
                for (int blank = 0; blank < 3; blank++)
                    wb_pages_cell_plain(table, WB_TONE_PLAIN, "");
            }
            wb_pages_cell_number(table, c->curvature[at[k]], 1);
            put_estimate(table, &c->moment[at[k]], WB_NMM, false);
        }
    }
}

static void put_rigidities(struct wb_document *document, const struct wb_machines_results *results)
{
    static const struct wb_document_column columns[] = {
        {"Wire", .right = false},
        {"Series", .right = true},
        {"<i>s</i> of ln <i>EI</i> between series", .right = true},
        {"<i>EI</i> (N mm\xc2\xb2)", .right = true},
        {"95 %", .right = true},
        {"friction and nose", .right = true},
    };
    struct wb_document_table *const table = wb_document_table(
        document,
        "Flexural rigidity at zero curvature. In grey where it cannot be determined: without an "
        "unloading it depends on the form of the law below the first point.",
        (int)WB_COUNT(columns), columns);
    for (int i = 0; i < results->fits.n; i++) {
        const struct wb_machines_fit *const fit = &results->fits.fits[i];
        const struct wb_three_point_calibration *const c = &fit->calibration;
        if (!fit->is_fitted)
            continue;
        wb_document_row(table, false);
        wb_pages_cell_plain(table, WB_TONE_PLAIN, wire_of(results, fit));
        wb_pages_cell(table, WB_TONE_PLAIN, "%d", c->n_series);
        wb_pages_cell_number(table, c->series_deviation, 2);
        put_estimate(table, &c->rigidity, WB_NMM2, !c->is_rigidity_identifiable);
    }
}

static void put_left_out(struct wb_document *document, const struct wb_machines_results *results)
{
    static const struct wb_document_column columns[] = {
        {"Wire", .right = false},
        {"Tests", .right = true},
        {"to (mm)", .right = true},
        {"<i>s</i> (mN)", .right = true},
        {"Scatter alone (mN)", .right = true, .wraps = true},
        {"Model (mN)", .right = true},
        {"Bias (mN)", .right = true},
        {"Bias / <i>s</i>", .right = true},
        {"Bias / <i>F</i><sub>max</sub> (%)", .right = true, .wraps = true},
    };
    struct wb_document_table *const table = wb_document_table(
        document,
        "Each test is left out in turn. Model: RMS difference of the law of the other tests from "
        "it, pooled. Scatter alone: (<i>n</i>/(<i>n</i> \xe2\x88\x92 1))<sup>1/2</sup> <i>s</i>, "
        "the difference of the others' mean curve from it. Bias: RMS difference of the law from "
        "the mean of the others; red above 0.7 <i>s</i>.",
        (int)WB_COUNT(columns), columns);
    for (int i = 0; i < results->fits.n; i++) {
        const struct wb_machines_fit *const fit = &results->fits.fits[i];
        const struct wb_left_out *const r = &fit->left_out;
        if (!fit->is_validated)
            continue;
        wb_document_row(table, false);
        wb_pages_cell_plain(table, WB_TONE_PLAIN, wire_of(results, fit));
        wb_pages_cell(table, WB_TONE_PLAIN, "%d", r->n);
        wb_pages_cell_number(table, r->deflection[WB_LEFT_OUT_GRID - 1] / WB_MM, 1);
        wb_pages_cell_number(table, r->scatter / WB_MN, 1);
        wb_pages_cell_number(table, r->expected / WB_MN, 1);
        wb_pages_cell_number(table, r->rms / WB_MN, 1);
        wb_pages_cell_number(table, r->bias / WB_MN, 1);
        wb_pages_cell_judged(table, r->bias / r->scatter, 2, true,
                             !wb_machines_fits_is_biased(fit));
        wb_pages_cell_number(table, r->bias / r->of_max_force / WB_PERCENT, 1);
    }
}

void wb_machines_fits_put(struct wb_document *document, const struct wb_machines_results *results,
                          const struct wb_figures *drawn)
{
    if (results->fits.n == 0)
        return;
    wb_document_heading(document, 1, "calibration", "Laws of the wires");
    for (int i = 0; i < results->fits.n; i++)
        put_problems(document, results, &results->fits.fits[i]);
    put_calibrations(document, results);
    put_rigidities(document, results);
    wb_document_heading(document, 1, "left-out", "Tests left out");
    put_left_out(document, results);
    for (int i = 0; i < results->fits.n; i++)
        wb_figures_put(drawn, document, "fit", i);
}

/* --- numbers --- */

#define ESTIMATE(member) WB_AT(struct wb_estimate, member)
#define MEMBER(member) WB_AT(struct wb_three_point_member, member)
#define LEFT_OUT(member) WB_AT(struct wb_left_out, member)
#define CALIBRATION(member) WB_AT(struct wb_three_point_calibration, member)

static const struct wb_key estimate_rows[] = {
    {"value", ESTIMATE(value) | UNKNOWN, "value, in the unit of the key above"},
    {"low_95", ESTIMATE(low) | UNKNOWN, "lower end of its 95 % confidence interval"},
    {"high_95", ESTIMATE(high) | UNKNOWN, "upper end of that interval"},
    {"low_of_bench", ESTIMATE(candidates_low) | UNKNOWN,
     "least value over friction and nose radius"},
    {"high_of_bench", ESTIMATE(candidates_high) | UNKNOWN,
     "largest value over friction and nose radius"},
};
static WB_KEYS(estimate, "bench_estimate", "A value and its intervals.");

static const struct wb_key moment_rows[] = {
    {"curvature_1_m", NUMBER | UNKNOWN, "curvature"},
    {"moment_Nmm", WB_HERE(struct wb_estimate), "moment of a first loading", &estimate_keys},
};
static WB_KEYS(moment, "fit_moment", "The moment at one curvature.");

static const struct wb_key fit_test_rows[] = {
    {"series", MEMBER(data.info.piece.series), "series that the test belongs to"},
    {"sample", MEMBER(data.info.sample), "number of the piece"},
    {"problem", TEXT | OPTIONAL, "why no law was fitted"},
    {"EI_N_mm2", MEMBER(rigidity) | UNKNOWN | OPTIONAL, "EI at zero curvature"},
    {"largest_moment_Nmm", MEMBER(moment[WB_THREE_POINT_MOMENTS - 1]) | UNKNOWN | OPTIONAL,
     "moment at the last curvature"},
    {"misfit", MEMBER(fit.misfit) | UNKNOWN | OPTIONAL, "RMS of the force residuals over F_max"},
    {"converged", MEMBER(fit.is_converged) | OPTIONAL, "the fit converged"},
    {"first_contact_mm", MEMBER(fit.first_contact) | UNKNOWN | OPTIONAL,
     "travel at the first contact"},
    {"usable_mm", MEMBER(data.usable) | UNKNOWN | OPTIONAL, "travel up to which the test is used"},
    {"limit", TEXT | OPTIONAL, "reason of that limit"},
};
static WB_KEYS(fit_test, "fit_test", "The fit of a test.");

static const struct wb_key left_out_rows[] = {
    {"scatter_N", LEFT_OUT(scatter) | UNKNOWN,
     "standard deviation of the tests, RMS over deflections"},
    {"scatter_alone_N", LEFT_OUT(expected) | UNKNOWN,
     "RMS error expected from specimen scatter alone: sqrt(n / (n - 1)) times that"},
    {"model_N", LEFT_OUT(rms) | UNKNOWN, "RMS of the model less the test that was left out"},
    {"bias_N", LEFT_OUT(bias) | UNKNOWN, "RMS over deflections of `bias_at_N`"},
    {"bias_over_scatter", NUMBER | UNKNOWN, "`bias_N` over `scatter_N`"},
    {"deflection_mm", WB_FULL(struct wb_left_out, deflection) | UNKNOWN,
     "deflections that all tests reach"},
    {"bias_at_N", WB_FULL(struct wb_left_out, offset) | UNKNOWN,
     "model less the mean of the other tests"},
};
static WB_KEYS(left_out, "left_out", "A validation by leaving each test out.");

static const struct wb_key wb_machines_fits_rows[] = {
    {"wire", TEXT, "name of the wire"},
    {"test_count", WB_AT(struct wb_machines_fit, n), "number of tests"},
    {"tests_fitted", CALIBRATION(n_fitted) | OPTIONAL, "tests that a law was fitted to"},
    {"series", CALIBRATION(n_series) | OPTIONAL, "number of series"},
    {"misfit", CALIBRATION(misfit) | UNKNOWN | OPTIONAL, "RMS of the force residuals over F_max"},
    {"s_of_ln_EI_between_series", CALIBRATION(series_deviation) | UNKNOWN | OPTIONAL,
     "standard deviation of ln EI between series"},
    {"EI_identifiable", CALIBRATION(is_rigidity_identifiable) | OPTIONAL,
     "the data determine EI at zero curvature"},
    {"EI_N_mm2", CALIBRATION(rigidity) | OPTIONAL, "EI at zero curvature", &estimate_keys},
    {"moments", OBJECT | LIST | OPTIONAL, "moments of a first loading", &moment_keys},
    {"tests", OBJECT | LIST | OPTIONAL, "fits of the tests", &fit_test_keys},
    {"problem", TEXT | OPTIONAL, "why there is no fit or no validation"},
    {"left_out", OBJECT | OPTIONAL, "validation by leaving each test out", &left_out_keys},
};
WB_KEYS(wb_machines_fits, "fitted_wire", "The calibration of a wire on three-point bending tests.");

static void put_calibration(struct wb_json *entry, const struct wb_three_point_calibration *c)
{
    WB_PUT(entry, &wb_machines_fits_keys, struct wb_three_point_calibration, c);
    struct wb_json *const moments = wb_json_set_array(entry, "moments");
    for (int k = 0; k < WB_THREE_POINT_MOMENTS; k++) {
        struct wb_json *const moment = wb_json_append_object(moments);
        wb_json_set_number(moment, "curvature_1_m", c->curvature[k]);
        WB_PUT(moment, &moment_keys, struct wb_estimate, &c->moment[k]);
    }
    struct wb_json *const tests = wb_json_set_array(entry, "tests");
    for (int i = 0; i < c->n_members; i++) {
        const struct wb_three_point_member *const m = &c->members[i];
        struct wb_json *const test = wb_json_append_object(tests);
        WB_PUT(test, &fit_test_keys, struct wb_three_point_member, m);
        if (!m->is_fitted) {
            wb_json_set_text(test, "problem", m->why.text);
            continue;
        }
        WB_PUT(test, &fit_test_keys, struct wb_three_point_member, m);
        wb_json_set_text(test, "limit", wb_three_point_limit_name(m->data.limit));
    }
}

void wb_machines_fits_put_json(struct wb_json *root, const struct wb_machines_results *results)
{
    if (results->fits.n == 0)
        return;
    struct wb_json *const list = wb_json_set_array(root, "wires");
    for (int i = 0; i < results->fits.n; i++) {
        const struct wb_machines_fit *const fit = &results->fits.fits[i];
        const struct wb_left_out *const r = &fit->left_out;
        struct wb_json *const entry = wb_json_append_object(list);
        wb_json_set_text(entry, "wire", wire_of(results, fit));
        WB_PUT(entry, &wb_machines_fits_keys, struct wb_machines_fit, fit);
        if (fit->is_fitted)
            put_calibration(entry, &fit->calibration);
        if (!fit->is_validated) {
            wb_json_set_text(entry, "problem", fit->n > 0 ? fit->why.text : "no test");
            continue;
        }
        struct wb_json *const left_out = wb_json_set_object(entry, "left_out");
        WB_PUT(left_out, &left_out_keys, struct wb_left_out, r);
        wb_json_set_number(left_out, "bias_over_scatter", r->bias / r->scatter);
        WB_PUT(left_out, &left_out_keys, struct wb_left_out, r);
    }
}
