/* The figures of a report, drawn from a table: a figure is a function that draws it and writes its
 * caption, and a row. Files, and places in the document, follow from the table.
 *
 *     static const struct wb_figures_row rows[] = {
 *         {.place = "overview", .draw = draw_errors},
 *         {.place = "wire", .count = count_wires, .draw = draw_cycles},
 *     };
 *     WB_TRY(wb_figures_create(&figures, rows, WB_COUNT(rows), results));
 *     ... wb_figures_put(&figures, document, "overview", 0);
 *
 * The tables of the reports are wb_recordings_figures (bench/recordings_figures.h),
 * wb_wires_figures (wires/wires_kind.h) and wb_bundles_figures (bundles/bundles_kind.h).
 */
#ifndef WB_ANALYSIS_REPORT_FIGURES_H
#define WB_ANALYSIS_REPORT_FIGURES_H

#include <stdbool.h>

#include "analysis/dataset/curve.h"
#include "analysis/plot/figure.h"
#include "analysis/report/document.h"
#include "base/status.h"
#include "base/text.h"

/* A figure that was drawn. */
struct wb_figures_item {
    const struct wb_figures_row *row; /* borrowed, as the results */
    const void *results;
    int index; /* below the row's count */
    struct wb_figure *figure;
    struct wb_text caption; /* markup */
};

struct wb_figures_row {
    const char *place; /* in the document: a name that wb_figures_put() is called with */
    /* How many figures the row stands for (of every wire, of every group); NULL: one. Rows that
     * follow each other and count with the same function take turns: all of the first wire, then
     * all of the second. */
    int (*count)(const void *results);
    /* Makes the item's figure and appends its caption. Leaves the figure NULL where data are
     * missing: then there is no such figure. */
    enum wb_status (*draw)(struct wb_figures_item *item);
    bool half; /* of half the width: two such rows that follow each other stand side by side */
};

/* The figures that were drawn, in the order of the table. */
struct wb_figures {
    int n;
    struct wb_figures_item *items; /* (n), owned */
};

/* Draws all figures that the results give; on a failure nothing needs a release. */
WB_MUST_CHECK enum wb_status wb_figures_create(struct wb_figures *figures,
                                               const struct wb_figures_row *rows, size_t n_rows,
                                               const void *results);
void wb_figures_release(struct wb_figures *figures); /* accepts a zeroed one */

/* Whether there is any figure of a place and index. */
bool wb_figures_has(const struct wb_figures *figures, const char *place, int index);

/* Adds the figures of a place and index to the document, with their captions. The document borrows
 * them. */
void wb_figures_put(const struct wb_figures *figures, struct wb_document *document,
                    const char *place, int index);

/* --- common parts of functions that draw --- */

/* The reference that others are compared with in a figure: a broad pale line below them. */
extern const struct wb_figure_style wb_figures_reference_style;

/* Starts a figure of the text's width that says that it shows simulations. */
WB_MUST_CHECK enum wb_status wb_figures_start_simulation(struct wb_figure **figure,
                                                         const char *name, double height);

/* A title of plain text. */
void wb_figures_set_title(struct wb_panel *panel, const char *plain);

/* Points of a series, added one by one; starts zeroed. */
struct wb_figures_points {
    size_t n, x_room, y_room;
    double *x, *y; /* (n), owned */
};
void wb_figures_add_point(struct wb_figures_points *points, double x, double y);
/* Adds them to a panel, unless there are none, and empties the series. */
void wb_figures_put_points(struct wb_panel *panel, const char *label,
                           struct wb_figures_points *points, const struct wb_figure_style *style);
void wb_figures_release_points(struct wb_figures_points *points);

/* Copies in another unit; for free(). */
double *wb_figures_scaled(const double *values, int n, double unit);

/* A line of `values` on the curve's deflections, and the range of its samples. */
void wb_figures_add_curve(struct wb_panel *panel, const char *label, const struct wb_curve *curve,
                          const double *values, double unit, const struct wb_figure_style *style);
void wb_figures_add_range(struct wb_panel *panel, const char *label, const struct wb_curve *curve,
                          struct wb_colour colour);

#endif
