/* Curved surfaces in space, lit and coloured by a field, as an image: for figures in which what
 * lies in front hides what lies behind.
 *
 * Parallel projection. Surfaces are sheets: nodes along and around, smooth through their nodes.
 * What is solid is drawn with the colour of its values; glass is drawn over it, the nearest sheet
 * of it only. The same scene gives the same pixels.
 */
#ifndef WB_ANALYSIS_PLOT_VIEW_H
#define WB_ANALYSIS_PLOT_VIEW_H

#include <stdbool.h>
#include <stdint.h>

#include "analysis/plot/figure.h"
#include "base/status.h"

struct wb_view_camera {
    double toward[3]; /* direction from the scene to the eye; any length */
    double up[3];     /* what is upright in the picture; not along `toward` */
};

struct wb_view_sheet {
    int n_along, n_around;       /* from 2; a closed one from 3 around */
    bool closed;                 /* around */
    bool capped;                 /* both ends of a closed one are filled, with the tint */
    const double (*position)[3]; /* (n_along x n_around), the next along after a whole round */
    const double *value;         /* the same; NULL: the tint */
    double opacity;              /* 1: solid; less: glass of the tint */
    struct wb_colour tint;       /* of what has no values */
};

struct wb_view_scene {
    struct wb_view_camera camera;
    int n_sheets;
    const struct wb_view_sheet *sheets;
    struct wb_figure_colours colours; /* of values */
    double low[2], high[2];           /* the window: right and up in the picture */
    int width, height;                /* pixels, 1 to 8000 each */
};

/* Where a place lies in the picture: right, up, towards the eye. */
void wb_view_project(const struct wb_view_camera *camera, const double place[3], double out[3]);

/* Draws into (height x width) pixels, the upper left one first: alpha, red, green, blue from the
 * highest byte down, colours times alpha (as Cairo's ARGB32). Places that are not finite leave
 * holes. */
WB_MUST_CHECK enum wb_status wb_view_draw(const struct wb_view_scene *scene, uint32_t *pixels);

#endif
