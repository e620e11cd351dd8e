/* What only tests ask of daq/diagnosis.h. */
#ifndef WB_DAQ_DIAGNOSIS_PRIVATE_H
#define WB_DAQ_DIAGNOSIS_PRIVATE_H

#include "daq/diagnosis.h"

enum wb_diagnosis_kind {
    WB_DIAGNOSIS_NOTHING,  /* not a byte came */
    WB_DIAGNOSIS_NOISE,    /* no text: another baud rate or frame */
    WB_DIAGNOSIS_ENDLESS,  /* text without line ends */
    WB_DIAGNOSIS_GRBL,     /* GRBL 1.1 */
    WB_DIAGNOSIS_OLD_GRBL, /* GRBL before 1.1, which cannot jog */
    WB_DIAGNOSIS_MARLIN,   /* a 3D printer's firmware */
    WB_DIAGNOSIS_READINGS, /* lines of a load cell */
    WB_DIAGNOSIS_OTHER     /* lines of something else */
};

enum wb_diagnosis_kind wb_diagnosis_kind(const struct wb_diagnosis *diagnosis);

#endif
