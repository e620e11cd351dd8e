/* Keeps remarks from becoming a flood: a port full of rubbish would otherwise fill the recording
 * and the operator's terminal with complaints. One gate for each stream. */
#ifndef WB_DAQ_ACQUIRE_REMARK_GATE_H
#define WB_DAQ_ACQUIRE_REMARK_GATE_H

#include <stdbool.h>
#include <stdint.h>

#define WB_REMARK_GATE_KINDS 16
/* Remarks stored in one second. */
#define WB_REMARK_GATE_A_SECOND 20

/* All zero is a gate that held nothing back yet. */
struct wb_remark_gate {
    int64_t second;
    unsigned stored, held; /* in this second */
    struct {
        char kind[32];
        int64_t t_ns;
    } shown[WB_REMARK_GATE_KINDS];
};

/* True when a remark at t_ns may be stored; those beyond the allowance are counted. With the first
 * one of a new second *held is the number held back in the second before, 0 otherwise. */
bool wb_remark_gate_store(struct wb_remark_gate *gate, int64_t t_ns, unsigned *held);

/* True when a remark of this kind may be shown: once in 10 s. */
bool wb_remark_gate_show(struct wb_remark_gate *gate, int64_t t_ns, const char *kind);

#endif
