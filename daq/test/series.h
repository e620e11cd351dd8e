/* A series: consecutive tests of several specimens of one wire at one length. Its file:
 *
 *     series: type1-85                       # its name
 *     specimen: type1-L85.yaml               # specimen file that applies to all specimens
 *     specimens: 6                           # number of specimens; their sample numbers increase
 *     first_sample: 1                        # optional
 *     ask: [markers_mm, notes]               # optional: values asked for before each test
 *     rig: bench.yaml                        # optional: may be given on the command line
 *     output: "{series}-{number:03}-{specimen}.wbr"   # optional; this is the default
 *     cycles: 1                              # optional, as for a single test
 *     travel_mm: 53
 *
 * The progress of a series is stored only in the folder of its recordings and in its index
 * (daq/recording/index.h): a series may be interrupted at any time and continued later.
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

/* Values that the operator enters before each test; the first two replace the key of the same name
 * in the specimen file. */
enum wb_series_question {
    WB_SERIES_MARKERS,
    WB_SERIES_OFFSET,
    WB_SERIES_NOTES,
    WB_SERIES_QUESTIONS
};

#define WB_SERIES_FILE 256 /* bytes of the name of a recording, with the NUL */

struct wb_series {
    char folder[WB_PATH]; /* of the series file */
    char name[64];
    char specimen_path[WB_PATH];
    struct wb_specimen like; /* contents of specimen_path */
    int n_specimens, first_sample;
    bool asks[WB_SERIES_QUESTIONS];
    char rig[WB_PATH]; /* "": given on the command line */
    char output[160];  /* template of the recordings' names */
};

/* Reads the file; `request` receives cycles and travel. Errors give file, line and key. */
WB_MUST_CHECK enum wb_status wb_series_read(struct wb_series *series, const char *path,
                                            struct wb_bend_test_request *request);

/* The name of a recording by the template: {series}, {number} or {number:03}, {sample}, and
 * {specimen}, the wire's name, length and sample ("type1-L85-3"). */
void wb_series_file(const struct wb_series *series, int number, int sample,
                    char file[WB_SERIES_FILE]);

/* Writes the specimen file of a sample to `text`. `answers` replace keys; NULL or "": the value of
 * the series' specimen file. WB_ERR_FORMAT, with the reason in `why`: an answer is invalid. */
WB_MUST_CHECK enum wb_status wb_series_specimen(const struct wb_series *series, int sample,
                                                const char *const answers[WB_SERIES_QUESTIONS],
                                                struct wb_text *text, struct wb_reason *why);

/* The next free number: larger than that of every file in `folder` whose name begins as the
 * template (thus also .zst and -wal files), and of every entry of this series in the index. */
WB_MUST_CHECK enum wb_status wb_series_next_number(const struct wb_series *series,
                                                   const char *folder, const struct wb_index *index,
                                                   int *number);

/* The next sample; 0: all samples are done. A sample is done if the index has a test of it that is
 * not marked for repetition. *n_done receives the number of samples done. */
int wb_series_next_sample(const struct wb_series *series, const struct wb_index *index,
                          int *n_done);

/* Finds the recording in `folder` with the lowest number not below *number that the index does not
 * list: the test was interrupted before the operator accepted or excluded it. *number receives its
 * number, or 0 if there is none. */
WB_MUST_CHECK enum wb_status wb_series_find_unlisted(const struct wb_series *series,
                                                     const char *folder,
                                                     const struct wb_index *index, int *number,
                                                     char file[WB_SERIES_FILE]);

#endif
