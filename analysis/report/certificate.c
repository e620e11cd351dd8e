#include "analysis/report/certificate.h"

#include <math.h>
#include <stdio.h>

#include "analysis/report/figures.h"
#include "analysis/report/pages.h"
#include "analysis/report/pdf.h"
#include "base/file.h"
#include "base/units.h"
#include "base/version.h"

#define WB_LOG_DOMAIN "certificate"

#define FIGURE_HEIGHT 190.0 /* points */
#define FAR_SHARE 0.2

static const char *or_not_given(const char *text)
{
    return text[0] ? text : "not given";
}

/* --- the figure --- */

static struct wb_cell_deviation deviation_of(const struct wb_certificate *certificate, int point)
{
    return wb_cell_calibration_deviation(&certificate->points[0], &certificate->points[point],
                                         certificate->rig->gravity);
}

/* Deviations from the first zero over the masses, of one direction. */
static void add_way(struct wb_panel *panel, const struct wb_certificate *certificate, bool down)
{
    struct wb_figures_points points = {0};
    for (int i = 0; i < certificate->n; i++) {
        if (certificate->calibration->is_down[i] == down)
            wb_figures_add_point(&points, certificate->points[i].mass / WB_G,
                                 deviation_of(certificate, i).deviation / WB_MG);
    }
    const struct wb_figure_style style = {.colour = wb_palette_wire(down ? 1 : 0),
                                          .marker = down ? WB_MARKER_RING : WB_MARKER_CIRCLE,
                                          .marker_size = 5.0};
    wb_figures_put_points(panel, down ? "on the way down" : "on the way up", &points, &style);
}

/* The line through all points, less the rig file's. */
static void add_fit(struct wb_panel *panel, const struct wb_certificate *certificate)
{
    const struct wb_cell_calibration *const c = certificate->calibration;
    const double zero = certificate->points[0].reading / certificate->rig->gravity;
    const double x[2] = {0.0, c->span / WB_G};
    const double y[2] = {(c->offset - zero) / WB_MG,
                         (c->offset - zero + (c->slope - 1.0) * c->span) / WB_MG};
    const struct wb_figure_style style = {.colour = wb_palette_grey(), .width = 1.0};
    wb_figure_add_line(panel, "least-squares line", 2, x, y, &style);
}

static double largest_deviation(const struct wb_certificate *certificate)
{
    double largest = 0.0;
    for (int i = 0; i < certificate->n; i++)
        largest = fmax(largest, fabs(deviation_of(certificate, i).deviation));
    return largest;
}

/* Where the tolerance of the span ends, unless it is so far away that the deviations would all lie
 * on one line. */
static void add_tolerance(struct wb_panel *panel, const struct wb_certificate *certificate)
{
    const double span = certificate->calibration->span;
    const double x[2] = {0.0, span / WB_G};
    if (largest_deviation(certificate) < FAR_SHARE * certificate->tolerance * span)
        return;
    const struct wb_figure_style style = {
        .colour = wb_palette_warning(), .width = 0.8, .dash = WB_DASH_DASHED};
    for (int sign = -1; sign <= 1; sign += 2) {
        const double edge = sign * certificate->tolerance * span / WB_MG;
        const double y[2] = {edge, edge};
        wb_figure_add_line(panel, sign < 0 ? "tolerance" : NULL, 2, x, y, &style);
    }
}

static enum wb_status draw(struct wb_figure **out, const struct wb_certificate *certificate)
{
    WB_TRY(wb_figure_create(out, "deviations", WB_PDF_WIDTH, FIGURE_HEIGHT));
    struct wb_panel *const panel = wb_figure_add_panel(*out);
    wb_figure_set_axes(panel, "Mass (g)", "Deviation (mg)");
    add_tolerance(panel, certificate);
    add_fit(panel, certificate);
    add_way(panel, certificate, false);
    add_way(panel, certificate, true);
    if (certificate->rig->is_virtual)
        wb_figure_set_footer(*out, "virtual rig");
    return WB_OK;
}

/* --- the text --- */

static void put_item(struct wb_document *document, const struct wb_certificate *certificate)
{
    static const struct wb_document_column columns[] = {{.heading = "Item"},
                                                        {.heading = "", .wraps = true}};
    const struct wb_rig *const rig = certificate->rig;
    struct wb_document_table *const table =
        wb_document_table(document, NULL, WB_COUNT(columns), columns);
    wb_pages_row_pair(table, WB_TONE_PLAIN, "Bench", "%s", rig->name);
    wb_pages_row_pair(table, WB_TONE_PLAIN, "Load cell, serial number", "%s",
                      or_not_given(rig->load_cell.serial_number));
    wb_pages_row_pair(table, WB_TONE_PLAIN, "Capacity", "%g g, reads up to %g g",
                      rig->load_cell.capacity / rig->gravity / WB_G,
                      rig->load_cell.overload / rig->gravity / WB_G);
    wb_pages_row_pair(table, WB_TONE_PLAIN, "Calibrated by its maker", "%s",
                      or_not_given(rig->load_cell.calibration_date));
    wb_pages_row_pair(table, WB_TONE_PLAIN, "Date of this measurement (UTC)", "%s",
                      certificate->utc);
    wb_pages_row_pair(table, WB_TONE_PLAIN, "Masses",
                      "%d, up to %g g, each read for %g s once the reading was still",
                      certificate->n, certificate->calibration->span / WB_G, certificate->seconds);
    wb_pages_row_pair(table, WB_TONE_PLAIN, "Gravity", "%.5f m/s2", rig->gravity);
}

static void put_points(struct wb_document *document, const struct wb_certificate *certificate)
{
    static const struct wb_document_column columns[] = {
        {.heading = "Mass (g)"},
        {.heading = "Read (g)", .right = true},
        {.heading = "Deviation (mg)", .right = true},
        {.heading = "Uncertainty (mg)", .right = true},
        {.heading = "From the line (mg)", .right = true},
        {.heading = "Scatter (mg)", .right = true},
    };
    struct wb_document_table *const table =
        wb_document_table(document,
                          "Readings less the first one at 0 g, in the order in which they were "
                          "taken. Scatter: standard deviation of one reading.",
                          (int)WB_COUNT(columns), columns);
    for (int i = 0; i < certificate->n; i++) {
        const struct wb_cell_point *const point = &certificate->points[i];
        const struct wb_cell_deviation deviation = deviation_of(certificate, i);
        wb_document_row(table, false);
        wb_pages_cell(table, WB_TONE_PLAIN, "%g %s", point->mass / WB_G,
                      certificate->calibration->is_down[i] ? "down"
                      : i > 0                              ? "up"
                                                           : "");
        wb_pages_cell_number(table, deviation.mass / WB_G, 4);
        wb_pages_cell_number(table, deviation.deviation / WB_MG, 2);
        wb_pages_cell_number(table, deviation.uncertainty / WB_MG, 2);
        wb_pages_cell_number(table, certificate->calibration->residuals[i] / WB_MG, 2);
        wb_pages_cell_number(table, point->sd / certificate->rig->gravity / WB_MG, 2);
    }
}

static void put_results(struct wb_document *document, const struct wb_certificate *certificate)
{
    static const struct wb_document_column columns[] = {
        {.heading = "Quantity"},
        {.heading = "Value (%)", .right = true},
        {.heading = "Uncertainty (%)", .right = true},
        {.heading = "At (g)", .right = true},
        {.heading = "Tolerance (%)", .right = true},
        {.heading = "Verdict"},
    };
    struct wb_document_table *const table = wb_document_table(
        document, "In percent of the span of the masses.", (int)WB_COUNT(columns), columns);
    for (int i = 0; i < WB_CELL_QUANTITIES; i++) {
        const struct wb_cell_result *const result = &certificate->calibration->results[i];
        const double none = (double)NAN;
        wb_pages_row(table, false, wb_cell_calibration_name((enum wb_cell_quantity)i));
        wb_pages_cell_number(table, result->known ? result->value / WB_PERCENT : none, 3);
        wb_pages_cell_number(table, result->known ? result->uncertainty / WB_PERCENT : none, 3);
        wb_pages_cell_number(table, result->known ? result->at / WB_G : none, 3);
        wb_pages_cell_number(table, certificate->tolerance / WB_PERCENT, 3);
        if (!result->known)
            wb_pages_cell(table, WB_TONE_QUIET, "cannot be determined");
        else if (result->passed)
            wb_pages_cell(table, WB_TONE_GOOD, "within");
        else
            wb_pages_cell(table, WB_TONE_WARNING, "exceeded");
    }
}

static void build(struct wb_document *document, const struct wb_certificate *certificate,
                  const struct wb_figure *figure)
{
    char footer[128], subtitle[128];
    snprintf(footer, sizeof footer, "%swirebench %s (%s)",
             certificate->rig->is_virtual ? "virtual rig, " : "", wb_version(),
             wb_version_revision());
    snprintf(subtitle, sizeof subtitle, "Load cell %s, %s",
             or_not_given(certificate->rig->load_cell.serial_number), certificate->utc);
    wb_document_init(document, "Certificate", "Calibration of a load cell with masses", subtitle,
                     footer, certificate->utc);
    const bool passed = certificate->calibration->passed;
    if (certificate->rig->is_virtual)
        wb_document_notice(document, WB_TONE_ORIGIN,
                           "Measured on a <b>virtual rig</b>: not valid for a physical load cell.");
    put_item(document, certificate);
    wb_document_heading(document, 1, "result", "Result");
    wb_document_notice(
        document, passed ? WB_TONE_GOOD : WB_TONE_WARNING,
        passed ? "<b>Passed</b>: all quantities that can be determined with these masses are "
                 "within the tolerance."
               : "<b>Not passed</b>: a quantity exceeds the tolerance.");
    put_results(document, certificate);
    wb_document_heading(document, 1, "readings", "Readings");
    put_points(document, certificate);
    wb_document_figures(document, figure,
                        "Deviation of the reading from the applied mass, both less zero.", NULL,
                        NULL);
    wb_document_heading(document, 1, "terms", "Terms");
    wb_document_paragraph(
        document,
        "Span: slope of the least-squares line of reading over mass against the rig file's unit "
        "and scale, less 1. Linearity: the point farthest from that line. Hysteresis: the largest "
        "difference of a mass on the way down and on the way up. Repeatability: standard deviation "
        "of readings of one mass from the same side. Zero return: the last reading at 0 g less the "
        "first. Uncertainties are standard ones (k = 1) of the readings; those of the masses and "
        "of gravity come on top.");
    wb_document_paragraph(document,
                          "This certificate relates only to the item tested, as it was mounted "
                          "on the date above.");
}

enum wb_status wb_certificate_write(const struct wb_certificate *certificate, const char *path,
                                    bool force)
{
    struct wb_figure *figure = NULL;
    struct wb_document document = {0};
    if (!force && wb_file_exists(path))
        return wb_fail(WB_ERR_EXISTS, "'%s' exists: choose another name, or --force", path);
    enum wb_status status = draw(&figure, certificate);
    if (status == WB_OK) {
        build(&document, certificate, figure);
        status = wb_pdf_write(&document, path);
    }
    wb_document_release(&document);
    wb_figure_destroy(figure);
    return status;
}
