/* Stress fields on sections of a simulated wire, kept in its dataset as fields.csv:
 *
 *     state,section,at_mm,face,part,node,X_mm,Y_mm,Z_mm,x_mm,y_mm,z_mm,
 *     von_mises_MPa,axial_MPa,plastic_strain
 *
 * (one line; one row for each of the 8 nodes of a face: corners 0-3 around, then midside nodes 0-1,
 * 1-2, 2-3, 3-0). `state` is the name of the model's step at whose end it was kept; `section` is
 * `longitudinal` (the plane z = 0 of the straight wire, at_mm empty) or `cross` at at_mm along it.
 * Capital coordinates are those of the straight wire. The axial stress is the normal stress along
 * the wire. Sections of a 1D model are the fibres' cells, each with constant values. Numbers are
 * kept to 6 digits.
 */
#ifndef WB_ANALYSIS_DATASET_FIELDS_H
#define WB_ANALYSIS_DATASET_FIELDS_H

#include "base/reason.h"
#include "base/status.h"

struct wb_field_node {
    double reference[3], position[3]; /* m */
    double von_mises, axial;          /* Pa */
    double plastic;                   /* equivalent plastic strain */
};

struct wb_field_face {
    int part; /* 0 core, 1 jacket */
    struct wb_field_node node[8];
};

struct wb_field {
    char state[32];
    double x; /* m, of a cross section; NaN: the longitudinal section */
    int n_faces;
    struct wb_field_face *faces; /* (n_faces), owned */
};

struct wb_fields {
    int n;
    struct wb_field *items; /* (n), owned */
};

/* Appends a field with n_faces (at least 1) zeroed faces; *field stays valid until the next call.
 * `why` receives the reason of a failure; NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_fields_add(struct wb_fields *fields, const char *state, double x,
                                           int n_faces, struct wb_field **field,
                                           struct wb_reason *why);
void wb_fields_release(struct wb_fields *fields); /* accepts a zeroed one */

/* The field of a state, longitudinal (x NaN) or of the cross section nearest to x; NULL: none. */
const struct wb_field *wb_fields_find(const struct wb_fields *fields, const char *state, double x);

/* Writes or reads fields.csv of a dataset's folder. The file is replaced atomically, or removed
 * where there is no field; values that are not finite are rejected. Reading errors name file, line
 * and column; a missing file gives no fields. `why` receives the reason of a failure; NULL: it is
 * logged. */
WB_MUST_CHECK enum wb_status wb_fields_write(const struct wb_fields *fields, const char *folder);
WB_MUST_CHECK enum wb_status wb_fields_read(struct wb_fields *fields, const char *folder,
                                            struct wb_reason *why);

#endif
