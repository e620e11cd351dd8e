/* Kinds of files that the commands read or write: recognised by their content, in this one place,
 * for `wirebench info` and for messages about a file of the wrong kind.
 *
 * Recognising a file does not check it: that is done by the reader of its kind.
 */
#ifndef WB_CLI_FILE_KIND_H
#define WB_CLI_FILE_KIND_H

#include <stdint.h>

#include "base/file.h"
#include "base/status.h"
#include "base/text.h"

enum wb_file_kind {
    WB_FILE_UNKNOWN, /* also of a file that does not exist */
    WB_FILE_RECORDING,
    WB_FILE_DATASET,
    WB_FILE_PROPERTIES,
    WB_FILE_RIG,
    WB_FILE_SPECIMEN,
    WB_FILE_TEST_PIECE, /* specimen file of a testing machine */
    WB_FILE_WIRE,
    WB_FILE_MATERIAL,
    WB_FILE_MODEL,
    WB_FILE_BUNDLE,
    WB_FILE_HARNESS,
    WB_FILE_MACHINE,
    WB_FILE_CAMPAIGN,
    WB_FILE_SERIES,
    WB_FILE_INDEX, /* of recordings or simulations */
    WB_FILE_TAKE,
    WB_FILE_TABLE,           /* numbers as text */
    WB_FILE_PART_OF_DATASET, /* a file in the folder of a dataset */
    WB_FILE_DATASETS,        /* a folder of datasets */
    WB_FILE_RECORDINGS,      /* a folder of recordings */
    WB_FILE_REPORT,          /* the folder of a report */
    WB_FILE_REPORT_NUMBERS,  /* report.json */
    WB_FILE_MANIFEST,        /* of a report */
    WB_FILE_VALIDATION,      /* the folder of `validate -o`, or a file in it */
    WB_FILE_HARNESS_RESULT,  /* the folder of `solve harness -o`, or a file in it */
    WB_FILE_CHECK_LOG,       /* of load-cell checks */
    WB_FILE_CARD,
    WB_FILE_CHECKPOINT,
    WB_FILE_HDF5,
    WB_FILE_VTK,
    WB_FILE_GLTF,   /* a 3D scene */
    WB_FILE_FIGURE, /* a drawing or a page */
    WB_FILE_KINDS
};
#define WB_FILE_BIT(kind) (UINT64_C(1) << (kind))
#define WB_FILE_SPECIMENS (WB_FILE_BIT(WB_FILE_SPECIMEN) | WB_FILE_BIT(WB_FILE_TEST_PIECE))

/* The kind of a file or folder. Reads what it needs of it; logs nothing. */
enum wb_file_kind wb_file_kind_find(const char *path);

/* "properties", as in `wirebench info --json`; "a properties file". */
const char *wb_file_kind_key(enum wb_file_kind kind);
const char *wb_file_kind_name(enum wb_file_kind kind);

/* Appends what to do with a file of this kind: a command line, quoted for the shell, or a hint. */
void wb_file_kind_append_next(struct wb_text *text, enum wb_file_kind kind, const char *path);

/* Fails with WB_ERR_FORMAT where the file is of a known kind that is not among `expected`, bits.
 * The message names the kind, the kinds that are expected, and the next command for this file.
 * Files of unknown kind pass: their reader says what is wrong. */
WB_MUST_CHECK enum wb_status wb_file_kind_check(const char *path, uint64_t expected);

/* Finds a file of the command line with wb_command_find(), which may store its path in `path`, and
 * checks its kind; *name is changed to what was found. */
WB_MUST_CHECK enum wb_status wb_file_kind_find_input(const char **name, char path[WB_PATH],
                                                     uint64_t expected);

#endif
