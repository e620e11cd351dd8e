/* Drawings of a harness, from the side, from above, from the front and in perspective: shapes with
 * their items, for `solve harness`, `quicklook` and the report.
 *
 *     struct wb_harness_drawing drawing;
 *     wb_harness_drawing_of_step(&drawing, set, step);
 *     wb_harness_drawing_add_views(&drawing, figure, wb_figure_width(figure));
 */
#ifndef WB_ANALYSIS_HARNESS_HARNESS_DRAWING_H
#define WB_ANALYSIS_HARNESS_HARNESS_DRAWING_H

#include "analysis/harness/harness_run.h"
#include "analysis/plot/figure.h"
#include "base/status.h"

enum {
    WB_HARNESS_DRAWING_SHAPES = 3
};

/* One shape in a drawing. */
struct wb_harness_drawing_shape {
    const struct wb_harness_place *places; /* (n_places of the set), borrowed */
    const char *label;                     /* plain text, borrowed; NULL: not in the legend */
    struct wb_figure_style style;          /* its width is that of the thickest wire */
};

/* What is drawn. The last shape has the marks and the names of the items. */
struct wb_harness_drawing {
    const struct wb_harness_result_set *set; /* borrowed */
    int n_shapes;
    struct wb_harness_drawing_shape shapes[WB_HARNESS_DRAWING_SHAPES]; /* the first lies below */
    int step;            /* its mounted items have filled marks; -1: all have */
    bool names_branches; /* at their middles */
    bool has_targets;    /* rings at the places where the steps mount items */
    int farthest;        /* place whose distance between the first and the last shape is drawn; -1:
                            none */
};

/* The stress-free shape, with the names of branches. */
void wb_harness_drawing_of_natural(struct wb_harness_drawing *drawing,
                                   const struct wb_harness_result_set *set);
/* The shape after a step and the one before it. */
void wb_harness_drawing_of_step(struct wb_harness_drawing *drawing,
                                const struct wb_harness_result_set *set, int step);
/* The stress-free shape, the one after the last step that mounts anything, and the one after the
 * harness was taken off. */
void wb_harness_drawing_of_steps(struct wb_harness_drawing *drawing,
                                 const struct wb_harness_result_set *set);
/* The shape after a step over the stress-free shape, with the largest distance between them. */
void wb_harness_drawing_of_residual(struct wb_harness_drawing *drawing,
                                    const struct wb_harness_result_set *set, int step);

/* A height for a figure with the three views over a width, points. */
double wb_harness_drawing_height(const struct wb_harness_drawing *drawing, double width);
/* Adds three panels over a width, points: from the side, from above and from the front. */
void wb_harness_drawing_add_views(const struct wb_harness_drawing *drawing,
                                  struct wb_figure *figure, double width);
/* Adds a panel in perspective, with the legend, a grid on the floor and the shadow of the last
 * shape. */
void wb_harness_drawing_add_perspective(const struct wb_harness_drawing *drawing,
                                        struct wb_figure *figure, double width);

/* A figure of its own with all four panels. `footer`: what is shown, markup. The caller destroys
 * it. */
WB_MUST_CHECK enum wb_status wb_harness_drawing_create(const struct wb_harness_drawing *drawing,
                                                       const char *footer,
                                                       struct wb_figure **figure);

/* Writes the drawing of the steps as an SVG, PNG or PDF by the ending of its name; an existing file
 * is replaced. */
WB_MUST_CHECK enum wb_status wb_harness_drawing_write(const struct wb_harness_result_set *set,
                                                      const char *path);

#endif
