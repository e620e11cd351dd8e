/* Import of the curve of a testing machine into a dataset.
 *
 * Rows without force, travel or (where the file has a column of it) time are left out and counted;
 * nothing is interpolated. Force and travel keep the machine's zero; where the machine counts them
 * downwards, both change sign so that they rise with the load on the specimen. Cycles and phases
 * are separated at the turns of the travel. `import` of the dataset's document lists the findings
 * and the rows left out. */
#ifndef WB_ANALYSIS_DATASET_MACHINE_IMPORT_H
#define WB_ANALYSIS_DATASET_MACHINE_IMPORT_H

#include "analysis/dataset/dataset.h"
#include "analysis/dataset/machine.h"
#include "analysis/dataset/test_piece.h"
#include "analysis/keys/keys.h"
#include "base/reason.h"
#include "base/text_table.h"

struct wb_machine_import {
    const char *path;    /* of the curve */
    const char *columns; /* list as of wb_table_columns_find(); NULL: by the header */
    const struct wb_text_table_form *form; /* NULL: found */
    const struct wb_machine *machine;
    const struct wb_test_piece *piece; /* read for the machine's kind */
};

/* Keys of `import` in dataset.json. */
extern const struct wb_keys wb_machine_import_keys;

/* Findings in the file, and the rows left out. */
struct wb_machine_import_report {
    size_t lines;   /* of the file */
    size_t rows;    /* in the dataset */
    size_t empty;   /* lines without any field */
    size_t partial; /* rows with a missing value, of which ... */
    size_t without_force, without_travel, without_time;
    double largest_force, largest_travel; /* of all rows, also of those that are left out, as the
                                             file has them; NaN: none */
    int gaps;                             /* steps of time longer than five usual ones */
    double longest_gap;                   /* s */
    bool cut;                             /* the file ends in the middle of a row or a character */
};

/* Makes a new dataset (release it with wb_dataset_release()) from a file's bytes. WB_ERR_FORMAT
 * with file, line and column where the file cannot be parsed; WB_ERR_DATA where its data are not
 * sufficient: fewer than five rows, no travel, no force, decreasing time, a cantilever test without
 * time. `why` receives the message; NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_machine_import(struct wb_dataset *dataset, const void *bytes,
                                               size_t size, const struct wb_machine_import *from,
                                               struct wb_machine_import_report *report,
                                               struct wb_reason *why);

/* Writes the dataset and the compressed bytes of the original: FOLDER/original.zst. */
WB_MUST_CHECK enum wb_status wb_machine_import_write(const struct wb_dataset *dataset,
                                                     const void *bytes, size_t size,
                                                     const char *folder, bool force);

#endif
