/* Limits the rate of remarks: undecodable bytes from a port would otherwise flood the recording and
 * the operator's terminal with warnings. One gate per stream. */
#ifndef WB_DAQ_ACQUIRE_REMARK_GATE_H
#define WB_DAQ_ACQUIRE_REMARK_GATE_H

#include <stdbool.h>
#include <stdint.h>

#define WB_REMARK_GATE_KINDS 16
/* Remarks stored per second at most. */
#define WB_REMARK_GATE_A_SECOND 20

/* All zero: initial state. */
struct wb_remark_gate {
    int64_t second;
    unsigned stored, held; /* remarks stored and suppressed in this second */
    struct {
        char kind[32];
        int64_t t_ns;
    } shown[WB_REMARK_GATE_KINDS];
};

/* True if a remark at t_ns may be stored. At the first remark of a new second *held receives the
 * number of remarks suppressed in the last second with remarks, otherwise 0. */
bool wb_remark_gate_store(struct wb_remark_gate *gate, int64_t t_ns, unsigned *held);

/* True if a remark of this kind may be displayed: once in 10 s. */
bool wb_remark_gate_show(struct wb_remark_gate *gate, int64_t t_ns, const char *kind);

#endif
