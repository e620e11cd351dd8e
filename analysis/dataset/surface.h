/* The surface of a computed bundle at its largest deflection, kept in its dataset as surface.csv:
 *
 *     body,kind,station,node,x_mm,y_mm,z_mm,von_mises_MPa
 *
 * (one row for each node: body by body, station by station). `kind` is `wire`, `tape` (its ring is
 * closed) or `strip` (a tape with two free edges). The nodes of a station run around the wire's
 * section or along the tape's ring. Positions are rounded to 1 um, stresses to 4 digits.
 *
 * x runs from the clamp along the straight bundle, y up, z across.
 */
#ifndef WB_ANALYSIS_DATASET_SURFACE_H
#define WB_ANALYSIS_DATASET_SURFACE_H

#include <stdbool.h>

#include "base/reason.h"
#include "base/status.h"
#include "fe/output/bundle_fields.h"

enum {
    WB_SURFACE_ALONG = 41, /* largest numbers of stations and nodes that wb_surface_take() keeps */
    WB_SURFACE_ALONG_STRIP = 241, /* more, because a strip winds around the bundle */
    WB_SURFACE_AROUND_WIRE = 24,
    WB_SURFACE_AROUND_TAPE = 48
};

struct wb_surface_node {
    double position[3]; /* m */
    double von_mises;   /* Pa */
};

struct wb_surface_body {
    bool is_tape;
    bool closed; /* the last node of a station is next to the first; false for a strip */
    int n_around, n_along;
    struct wb_surface_node *nodes; /* (n_along x n_around), station by station; owned */
};

struct wb_surface {
    int n;
    struct wb_surface_body *bodies; /* (n), owned */
};

/* Extracts the surface of a bundle's fields, thinned where there are more stations and nodes than
 * the limits above. */
void wb_surface_take(struct wb_surface *surface, const struct wb_bundle_fields *fields);
void wb_surface_release(struct wb_surface *surface); /* accepts a zeroed one */

/* Writes or reads surface.csv of a dataset's folder. The file is replaced atomically, or removed if
 * there is no body; values that are not finite are rejected. Reading rejects coordinates beyond
 * 100 m, stresses beyond 1e15 Pa, and bodies whose first or last station has no extent; errors
 * name file, line and column. A missing file gives no bodies. `why` receives the reason of a
 * failure; NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_surface_write(const struct wb_surface *surface, const char *folder);
WB_MUST_CHECK enum wb_status wb_surface_read(struct wb_surface *surface, const char *folder,
                                             struct wb_reason *why);

#endif
