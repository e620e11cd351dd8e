/* Diagnoses an instrument whose bytes cannot be decoded, from the first bytes it sent: a wrong baud
 * rate, missing line ends, other firmware, swapped ports of load cell and stage; and gives the key
 * of the rig file to change. Pure functions of bytes. */
#ifndef WB_DAQ_PROTOCOL_DIAGNOSIS_H
#define WB_DAQ_PROTOCOL_DIAGNOSIS_H

#include <stddef.h>
#include <stdint.h>

#include "daq/protocol/rig.h"

#define WB_DIAGNOSIS_TEXT 320

/* The beginning of a stream. All zero: empty. */
struct wb_diagnosis {
    size_t n;
    char bytes[512];
};

enum wb_diagnosis_kind {
    WB_DIAGNOSIS_NOTHING,  /* no byte received */
    WB_DIAGNOSIS_NOISE,    /* not text: another baud rate or frame */
    WB_DIAGNOSIS_ENDLESS,  /* text without line ends */
    WB_DIAGNOSIS_GRBL,     /* GRBL 1.1 */
    WB_DIAGNOSIS_OLD_GRBL, /* GRBL before 1.1, which cannot jog */
    WB_DIAGNOSIS_MARLIN,   /* a 3D printer's firmware */
    WB_DIAGNOSIS_READINGS, /* lines of a load cell */
    WB_DIAGNOSIS_OTHER     /* lines of something else */
};

void wb_diagnosis_add(struct wb_diagnosis *diagnosis, const void *bytes, size_t n);

/* Classifies the bytes. */
enum wb_diagnosis_kind wb_diagnosis_kind(const struct wb_diagnosis *diagnosis);

/* Write the likely cause and the key to change, such as "its bytes are not text: ...", for a load
 * cell without readings and a stage without status. */
void wb_diagnosis_load(const struct wb_diagnosis *load, const struct wb_diagnosis *stage,
                       const struct wb_rig *rig, char text[WB_DIAGNOSIS_TEXT]);
void wb_diagnosis_stage(const struct wb_diagnosis *stage, const struct wb_rig *rig,
                        char text[WB_DIAGNOSIS_TEXT]);

#endif
