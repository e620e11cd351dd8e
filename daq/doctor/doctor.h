/* Checks whether the bench is ready for a test: opens the instruments of the rig file, listens for
 * some seconds and reports, for each item that a test needs, that it is ready or the problem and
 * the command or key that solves it. Moves nothing and records nothing.
 *
 *     WB_TRY(wb_doctor_open(&doctor, &request));
 *     while (wb_doctor_step(doctor, timeout_ns)) ...
 *     wb_doctor_close(doctor, &report);
 *
 * The checks and limits are those of `wirebench record`. An instrument that cannot be opened or is
 * silent is a finding, not an error.
 */
#ifndef WB_DAQ_DOCTOR_DOCTOR_H
#define WB_DAQ_DOCTOR_DOCTOR_H

#include <stdbool.h>
#include <stdint.h>

#include "base/setting.h"
#include "daq/test/bend_test.h"

struct wb_doctor; /* opaque */

struct wb_doctor_request {
    /* The planned test: rig file, specimen (NULL: markers are not judged), travel, cycles, speeds
     * and connect_timeout. Other members are not used. */
    struct wb_bend_test_request test;
    const char *folder; /* for recordings; NULL: the current folder */
    double seconds;     /* s of host time for listening to the instruments */
};

/* Settings of the request, without those of the test. */
extern const struct wb_setting_table wb_doctor_table;

void wb_doctor_default_request(struct wb_doctor_request *request);

enum wb_doctor_verdict {
    WB_DOCTOR_READY,
    WB_DOCTOR_NOTE,     /* a test is possible; advice */
    WB_DOCTOR_UNKNOWN,  /* cannot be judged, because something else is missing */
    WB_DOCTOR_NOT_READY /* `record` would not start or would stop, or its data would be poor */
};

/* "ready", "note", "not known", "NOT READY". */
const char *wb_doctor_verdict_name(enum wb_doctor_verdict verdict);

#define WB_DOCTOR_ITEMS 40
#define WB_DOCTOR_TEXT 1024
struct wb_doctor_item {
    const char *name; /* static text, one to three words */
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

/* True if no item is NOT_READY. */
bool wb_doctor_is_ready(const struct wb_doctor_report *report);

/* Reads the files and opens the ports that can be opened. Fails only if a file cannot be read or
 * memory is insufficient; the message is logged. Remarks of the instruments are logged when they
 * arrive and listed in the report. */
WB_MUST_CHECK enum wb_status wb_doctor_open(struct wb_doctor **out,
                                            const struct wb_doctor_request *request);

/* Listens for at most timeout_ns; false once the check is complete or after Ctrl-C. */
bool wb_doctor_step(struct wb_doctor *doctor, int64_t timeout_ns);

/* Closes the ports, checks the disk, writes the report and frees. `report` may be NULL. */
void wb_doctor_close(struct wb_doctor *doctor, struct wb_doctor_report *report);

#endif
