/* Dataset: one test as force-deflection rows and shapes, from any source.
 *
 * On disk a folder: dataset.json (provenance; its keys are rows of tables, see analysis/keys),
 * force_deflection.csv, shape.csv. Bench tests, imported files and simulations have the same form,
 * and the calibration treats them alike.
 *
 * The tables are strict: comma-separated, no quotes, comment lines ('#') only at the beginning ("#
 * virtual rig" where the data come from one), a header line with the names of the columns, every
 * line with as many fields as the header, numbers as plain decimals. Unknown columns are skipped.
 *
 * Frame: clamp at the origin, x along the straight wire, y upwards. Deflection is the tip's y.
 * `tension` is the strand's; `force` is its vertical part less its value at zero deflection on the
 * first loading. Slack rows are left out of every fit.
 *
 * In three-point and tensile tests, which come from testing machines, `deflection` is the travel as
 * the machine printed it (tensile: the elongation), not zeroed at the first contact, and `force` is
 * the load, not zeroed either; both rise with the load on the specimen. There are no shapes. */
#ifndef WB_ANALYSIS_DATASET_DATASET_H
#define WB_ANALYSIS_DATASET_DATASET_H

#include <stdbool.h>
#include <stddef.h>

#include "analysis/dataset/machine.h"
#include "analysis/dataset/test_piece.h"
#include "base/json.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/linear/trial.h"

/* One row of force_deflection.csv:
 * t_s,cycle,phase,deflection_mm,tension_N,force_N,stage_mm,tip_x_mm,tip_angle_rad
 *
 * A column that a source does not have is NaN, written as an empty field. */
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
 * plane, z_mm. A marker that was not seen has no row. */
struct wb_shape_row {
    double t, deflection; /* s, m: of the frame */
    int marker;           /* from 0, the clamp's */
    double s;             /* m, arc length along the wire */
    double x, y;          /* m, on the wire's axis */
    double z;             /* m, out of the plane; NaN read from a file that does not have it; the
                             column is written when any row has one other than 0 */
};

/* Standard uncertainties that the files of a test state; 0: not stated. */
struct wb_test_uncertainty {
    double gain;          /* 1, of the load cell's */
    double length;        /* m */
    double counterweight; /* kg */
    double diameter;      /* m, outer */
    double density;       /* 1, of the density */
    double marker_offset; /* m, of the markers' distance from the axis */
};

/* Typed data of the test for all other modules; `test` of dataset.json has the same. */
struct wb_test_info {
    char wire[64];          /* name of the product */
    int sample;             /* 0 for an average or a simulation without samples */
    double length;          /* m: free length; span between rollers; gauge length */
    double outer_diameter;  /* m */
    double mass_per_length; /* kg/m; 0: not known, in a test from a machine */
    double poissons_ratio;  /* 1 */
    double strand_length;   /* m; 0: vertical dead force, no strand */
    bool is_follower;       /* the tip force stays normal to the wire; `force` is its magnitude;
                               without a strand */
    bool is_general;      /* other simulated loads than those of a bending test; the dataset has no
                             force-deflection curve */
    double counterweight; /* kg */
    double gravity;       /* m/s2 towards -y; 0 when weight is not in the data */
    double rest_level;    /* m; NaN when there was no rest below the tip */
    /* Natural shape as a polynomial of the stress-free angle: theta0(s) = sum_i b_i (s/L)^(i+1),
     * rad. n = 0: straight. */
    int n_natural_shape;
    double natural_shape[4];
    struct wb_test_uncertainty uncertainty;
    bool is_virtual;    /* from a virtual rig */
    bool is_simulation; /* from `solve` */
    enum wb_test_kind kind;
    bool has_machine;           /* from a testing machine: `machine` and `piece` are set */
    struct wb_machine machine;  /* of the same kind */
    struct wb_test_piece piece; /* other data of the specimen */
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

/* The member `complete` of the document: nothing is missing or cut short; false where it has no
 * such member. */
bool wb_dataset_is_complete(const struct wb_dataset *dataset);

/* Appends a row; doubles the memory as needed. */
void wb_dataset_add_row(struct wb_dataset *dataset, const struct wb_row *row);
void wb_dataset_add_shape_row(struct wb_dataset *dataset, const struct wb_shape_row *row);

/* Reads or writes a folder. Writing creates it (an existing one that is not empty is rejected
 * unless `force`) and replaces each file atomically, dataset.json last: a folder with dataset.json
 * is complete. Reading errors name file, line and column; `why` receives them; NULL: they are
 * logged. */
WB_MUST_CHECK enum wb_status wb_dataset_write(const struct wb_dataset *dataset, const char *folder,
                                              bool force);
/* Writing in two steps, for callers that add tables of their own in between: the first creates the
 * folder and removes dataset.json and the tables of a dataset that is overwritten. */
WB_MUST_CHECK enum wb_status wb_dataset_begin(const char *folder, bool force);
WB_MUST_CHECK enum wb_status wb_dataset_finish(const struct wb_dataset *dataset,
                                               const char *folder);
/* Changes a dataset in memory as if it had been written and read: the document contains the typed
 * data, and numbers have the digits of dataset.json. On failure it does not change. */
WB_MUST_CHECK enum wb_status wb_dataset_settle(struct wb_dataset *dataset);
WB_MUST_CHECK enum wb_status wb_dataset_read(struct wb_dataset *dataset, const char *folder,
                                             struct wb_reason *why);

/* The same for callers that support other kinds than the cantilever, which wb_dataset_read()
 * rejects with WB_ERR_UNSUPPORTED: `kinds` is made of WB_TEST_BIT()s. */
#define WB_TEST_BIT(kind) (1u << (kind))
WB_MUST_CHECK enum wb_status wb_dataset_read_kinds(struct wb_dataset *dataset, const char *folder,
                                                   unsigned kinds, struct wb_reason *why);

/* Largest distance, s, of rows without a gap between them (a drawn line is interrupted at gaps):
 * several times their mean interval; infinite with fewer than two rows. */
double wb_dataset_gap(const struct wb_dataset *dataset);

#endif
