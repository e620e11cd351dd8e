/* Dataset: one test as force-deflection rows and shapes, wherever it came from.
 *
 * On disk a folder: dataset.json (provenance), force_deflection.csv, shape.csv. A bench test, an
 * imported file and a simulation all become one, and the calibration treats them alike.
 *
 * The tables are strict: comma-separated, no quotes, comment lines ('#') only at the beginning
 * ("# virtual rig" where the data come from one), a header line with the columns' names, every line
 * with as many fields as the header, numbers as plain decimals. Columns that are not known are
 * skipped.
 *
 * Frame: clamp at the origin, x along the straight wire, y upwards. Deflection is the tip's y.
 * `tension` is the strand's; `force` is its vertical part less its value at zero deflection on the
 * first loading. Slack rows are left out of every fit.
 *
 * Of other kinds than the cantilever, which come from testing machines, `deflection` is the travel
 * as the machine printed it (tensile: the elongation), not zeroed at the first contact, and `force`
 * the load, not zeroed either; both rise where the specimen is loaded. Shapes there are none.
 */
#ifndef WB_ANALYSIS_DATASET_DATASET_H
#define WB_ANALYSIS_DATASET_DATASET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "analysis/dataset/machine.h"
#include "analysis/dataset/test_piece.h"
#include "base/json.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/linear/trial.h"

/* One row of force_deflection.csv:
 * t_s,cycle,phase,deflection_mm,tension_N,force_N,stage_mm,tip_x_mm,tip_angle_rad
 * Columns a source does not have are NaN, written as empty fields. */
struct wb_row {
    double t;  /* s since the first row's clock zero, bench time; NaN in a test that is not of a
                  cantilever and whose file has no time */
    int cycle; /* from 1 */
    enum wb_phase phase;
    double deflection; /* m */
    double tension;    /* N */
    double force;      /* N */
    double stage;      /* m, commanded travel; NaN unknown */
    double tip_x;      /* m */
    double tip_angle;  /* rad; NaN unknown */
};

/* One row of shape.csv: t_s,deflection_mm,marker,s_mm,x_mm,y_mm and, in a test that leaves the
 * plane, z_mm. Missing markers have no row: gaps stay gaps. */
struct wb_shape_row {
    double t, deflection; /* s, m: of the frame */
    int marker;           /* from 0, the clamp's */
    double s;             /* m, arc length along the wire */
    double x, y;          /* m, on the wire's axis */
    double z;             /* m, out of the plane; NaN read from a file that does not have it; the
                             column is written when any row has one other than 0 */
};

/* Standard uncertainties of what the files of a test state; 0: not stated. */
struct wb_test_uncertainty {
    double gain;          /* 1, of the load cell's */
    double length;        /* m */
    double counterweight; /* kg */
    double diameter;      /* m, outer */
    double density;       /* 1, of the density */
    double marker_offset; /* m, of the markers' distance from the axis */
};

/* What every consumer needs of the test, kept typed; the same stands in dataset.json. */
struct wb_test_info {
    char wire[64];          /* name of the product */
    int sample;             /* 0 for an average or a simulation without samples */
    double length;          /* m: free length; span between rollers; gauge length */
    double outer_diameter;  /* m */
    double mass_per_length; /* kg/m; 0: not known, in a test from a machine */
    double poissons_ratio;  /* 1 */
    double strand_length;   /* m; 0: vertical dead force, no strand */
    bool is_follower;       /* the tip force stays normal to the wire; `force` is its size, and a
                               strand there is none */
    bool is_general;        /* loads other than a bending test's (simulated loads in space): no
                               curve can be made of it */
    double counterweight;   /* kg */
    double gravity;         /* m/s2 towards -y; 0 when weight is not in the data */
    double rest_level;      /* m; NaN when there was no rest below the tip */
    /* Natural shape as a polynomial of the stress-free angle: theta0(s) = sum_i b_i (s/L)^(i+1),
     * rad. n = 0: straight. */
    int n_natural_shape;
    double natural_shape[4];
    struct wb_test_uncertainty uncertainty;
    bool is_virtual;    /* from a virtual rig */
    bool is_simulation; /* from `solve` */
    enum wb_test_kind kind;
    bool has_machine;           /* a testing machine's: the two below are filled */
    struct wb_machine machine;  /* of the same kind */
    struct wb_test_piece piece; /* what else is known of the specimen */
};

struct wb_dataset {
    struct wb_test_info info;
    size_t n_rows, n_shape_rows;
    struct wb_row *rows;             /* (n_rows), owned */
    struct wb_shape_row *shape_rows; /* (n_shape_rows), owned */
    /* The whole of dataset.json: name, provenance (recordings with sha256, tool revision,
     * settings), corrections with their sizes, cpu_s of a simulation, ... ; owned. `info` wins over
     * it when the dataset is written. */
    struct wb_json *document;
};

/* Natural (stress-free) tip offset of the shape polynomial, m: integral of sin(theta0). */
double wb_dataset_bow(const struct wb_test_info *info);
/* Natural curvature theta0'(s), 1/m, in the form that wb_cantilever_model wants; `context` is a
 * const struct wb_test_info *. */
double wb_dataset_natural_curvature(void *context, double arc_length);

/* Makes an empty dataset with a fresh document; release with wb_dataset_release(). */
void wb_dataset_init(struct wb_dataset *dataset);
void wb_dataset_release(struct wb_dataset *dataset); /* accepts a zeroed one */

/* Whether nothing was missing or cut short, as the document has it (see analysis/align.h); false
 * where it has no such entry. */
bool wb_dataset_is_complete(const struct wb_dataset *dataset);

/* Appends a row; doubles the memory as needed. */
void wb_dataset_add_row(struct wb_dataset *dataset, const struct wb_row *row);
void wb_dataset_add_shape_row(struct wb_dataset *dataset, const struct wb_shape_row *row);

/* Reads or writes a folder. Writing makes it (refused when not empty unless `force`) and writes
 * each file atomically, dataset.json last: a folder that has it is whole. Reading errors name file,
 * line and column; `why` receives them, NULL: they are logged. */
WB_MUST_CHECK enum wb_status wb_dataset_write(const struct wb_dataset *dataset, const char *folder,
                                              bool force);
/* The same in two steps, for those who add tables of their own between them: the first makes the
 * folder and removes dataset.json and the tables of another dataset that is overwritten. */
WB_MUST_CHECK enum wb_status wb_dataset_begin(const char *folder, bool force);
WB_MUST_CHECK enum wb_status wb_dataset_finish(const struct wb_dataset *dataset,
                                               const char *folder);
/* Makes a dataset that was not written the one that would be read from its folder: the document has
 * the typed part, whose numbers have the digits of dataset.json. On failure it stays as it is. */
WB_MUST_CHECK enum wb_status wb_dataset_settle(struct wb_dataset *dataset);
WB_MUST_CHECK enum wb_status wb_dataset_read(struct wb_dataset *dataset, const char *folder,
                                             struct wb_reason *why);

/* The same for those who can serve other kinds than the cantilever, which wb_dataset_read() refuses
 * (WB_ERR_UNSUPPORTED, with what is expected): `kinds` is made of WB_TEST_BIT()s. */
#define WB_TEST_BIT(kind) (1u << (kind))
WB_MUST_CHECK enum wb_status wb_dataset_read_kinds(struct wb_dataset *dataset, const char *folder,
                                                   unsigned kinds, struct wb_reason *why);

/* Rows farther apart than this, s, have a gap between them, which a drawn line leaves open: several
 * times their mean interval; infinite with fewer than two rows. */
double wb_dataset_gap(const struct wb_dataset *dataset);

#endif
