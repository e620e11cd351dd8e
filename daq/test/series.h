/* A series: tests of several specimens of one wire at one length, one after the other. Its file:
 *
 *     series: type1-85                       # its name
 *     specimen: type1-L85.yaml               # a specimen file that all specimens are like
 *     specimens: 6                           # how many; their samples are counted up
 *     first_sample: 1                        # optional
 *     ask: [markers_mm, notes]               # optional: what else differs from one to the next
 *     rig: bench.yaml                        # optional: the command line may name it
 *     output: "{series}-{number:03}-{specimen}.wbr"   # optional, this by default
 *     cycles: 1                              # optional, as for a single test
 *     travel_mm: 53
 *
 * How far a series has come is seen in the folder of its recordings and in the index there
 * (daq/recording/index.h), and nowhere else: it may be interrupted at any moment and gone on with.
 */
#ifndef WB_DAQ_TEST_SERIES_H
#define WB_DAQ_TEST_SERIES_H

#include <stdbool.h>

#include "base/file.h"
#include "base/reason.h"
#include "base/status.h"
#include "base/text.h"
#include "daq/protocol/specimen.h"
#include "daq/recording/index.h"
#include "daq/test/bend_test.h"

/* What the operator is asked before each test; the first two replace the key of the specimen file
 * that has the same name. */
enum wb_series_question {
    WB_SERIES_MARKERS,
    WB_SERIES_OFFSET,
    WB_SERIES_NOTES,
    WB_SERIES_QUESTIONS
};
extern const char
    *const wb_series_questions[]; /* "markers_mm", "marker_offset_mm", "notes", NULL */

#define WB_SERIES_FILE 256 /* of a recording's name, with the NUL */

struct wb_series {
    char folder[WB_PATH]; /* of its file */
    char name[64];
    char specimen_path[WB_PATH];
    struct wb_specimen like; /* of that file */
    int n_specimens, first_sample;
    bool asks[WB_SERIES_QUESTIONS];
    char rig[WB_PATH]; /* "": the command line names it */
    char output[160];  /* template of names */
};

/* Reads the file; cycles and travel go to `request`. Errors name file, line and key. */
WB_MUST_CHECK enum wb_status wb_series_read(struct wb_series *series, const char *path,
                                            struct wb_bend_test_request *request);

/* The name of a recording by the template: {series}, {number} or {number:03}, {sample}, and
 * {specimen}, the wire's name, length and sample ("type1-L85-3"). */
void wb_series_file(const struct wb_series *series, int number, int sample,
                    char file[WB_SERIES_FILE]);

/* The specimen of a sample as the text of a specimen file. `answers` replace keys; NULL or "": as
 * in the file that it is like. WB_ERR_FORMAT with the reason in `why` for an answer that is none.
 */
WB_MUST_CHECK enum wb_status wb_series_specimen(const struct wb_series *series, int sample,
                                                const char *const answers[WB_SERIES_QUESTIONS],
                                                struct wb_text *text, struct wb_reason *why);

/* The next number: above those of all files in `folder` that the template could have named, with
 * whatever follows (.zst, -wal), and above those that the index has for this series. */
WB_MUST_CHECK enum wb_status wb_series_next_number(const struct wb_series *series,
                                                   const char *folder, const struct wb_index *index,
                                                   int *number);

/* The next sample; 0: all are done. One is done when the index has a test of it that is not to be
 * repeated. *n_done receives how many are. */
int wb_series_next_sample(const struct wb_series *series, const struct wb_index *index,
                          int *n_done);

/* The recording of the lowest number from `number` on that lies in `folder` and that the index does
 * not list: a test was interrupted before the operator said what to make of it. *number receives
 * its number, 0 when there is none. */
WB_MUST_CHECK enum wb_status wb_series_find_unlisted(const struct wb_series *series,
                                                     const char *folder,
                                                     const struct wb_index *index, int *number,
                                                     char file[WB_SERIES_FILE]);

#endif
