/* The findings of daq/doctor/doctor.h, from what was seen and heard. No port is touched. */
#ifndef WB_DAQ_DOCTOR_DOCTOR_ITEMS_H
#define WB_DAQ_DOCTOR_DOCTOR_ITEMS_H

#include "daq/doctor/doctor.h"
#include "daq/doctor/doctor_seen.h"

/* Appends the finding of each thing to look at, in the order of the instruments. */
void wb_doctor_judge(const struct wb_doctor_seen *seen, const struct wb_bend_test_request *test,
                     struct wb_doctor_report *report);

/* Appends one finding; in a full report it replaces the last. */
void wb_doctor_add(struct wb_doctor_report *report, const char *name,
                   enum wb_doctor_verdict verdict, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* s of the host: how long the test lasts. */
double wb_doctor_test_duration(const struct wb_bend_test_request *test, const struct wb_rig *rig);

#endif
