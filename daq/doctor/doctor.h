/* Is the bench ready for a test? Opens what the rig file names, listens for some seconds, and says
 * of each thing that a test needs whether it is well, or what is wrong and which command or key
 * mends it. Moves nothing and records nothing.
 *
 *     WB_TRY(wb_doctor_open(&doctor, &request));
 *     while (wb_doctor_step(doctor, timeout_ns)) ...
 *     wb_doctor_close(doctor, &report);
 *
 * The checks are those of `wirebench record`, and the rig file's limits are its own. An instrument
 * that cannot be opened or stays silent is a finding, not a failure.
 */
#ifndef WB_DAQ_DOCTOR_DOCTOR_H
#define WB_DAQ_DOCTOR_DOCTOR_H

#include <stdbool.h>
#include <stdint.h>

#include "base/setting.h"
#include "daq/test/bend_test.h"

struct wb_doctor; /* opaque */

struct wb_doctor_request {
    /* The test that is meant: rig file, specimen (NULL: none, and the markers are not judged),
     * travel, cycles, time to connect. The rest is not used. */
    struct wb_bend_test_request test;
    const char *folder; /* where recordings go; NULL: the current one */
    double seconds;     /* of the host: how long the instruments are listened to */
};

/* Rows of a request's own settings. */
extern const struct wb_setting_table wb_doctor_table;

void wb_doctor_default_request(struct wb_doctor_request *request);

enum wb_doctor_verdict {
    WB_DOCTOR_READY,
    WB_DOCTOR_NOTE,     /* a test can be made; worth knowing */
    WB_DOCTOR_UNKNOWN,  /* something else is missing to tell */
    WB_DOCTOR_NOT_READY /* `record` would refuse or stop, or its data would be poor */
};

/* "ready", "note", "not known", "NOT READY". */
const char *wb_doctor_verdict_name(enum wb_doctor_verdict verdict);

#define WB_DOCTOR_ITEMS 40
#define WB_DOCTOR_TEXT 1024
struct wb_doctor_item {
    const char *name; /* static, a word or three */
    enum wb_doctor_verdict verdict;
    char text[WB_DOCTOR_TEXT];
};

#define WB_DOCTOR_PICTURE 4096
struct wb_doctor_report {
    int n;
    struct wb_doctor_item items[WB_DOCTOR_ITEMS];
    char picture[WB_DOCTOR_PICTURE]; /* markers as text, 80 columns; "" without cameras */
    bool is_virtual;
};

/* Nothing is NOT_READY. */
bool wb_doctor_is_ready(const struct wb_doctor_report *report);

/* Reads the files and opens the ports that can be opened. Fails where the files cannot be read or
 * memory is short; the message is logged. What the instruments remark is logged as it comes and in
 * the report. */
WB_MUST_CHECK enum wb_status wb_doctor_open(struct wb_doctor **out,
                                            const struct wb_doctor_request *request);

/* Listens on, at most timeout_ns; false when all was heard (or Ctrl-C came). */
bool wb_doctor_step(struct wb_doctor *doctor, int64_t timeout_ns);

/* Closes the ports, looks at the disk, writes the report and frees. Accepts NULL for `report`. */
void wb_doctor_close(struct wb_doctor *doctor, struct wb_doctor_report *report);

#endif
