#include "daq/acquire/remark_gate.h"

#include <stdio.h>
#include <string.h>

#include "base/units.h"

#define SHOW_PERIOD_NS (10 * WB_NS_PER_S) /* between two displayed remarks of one kind */

bool wb_remark_gate_store(struct wb_remark_gate *gate, int64_t t_ns, unsigned *held)
{
    const int64_t second = t_ns / WB_NS_PER_S;
    *held = 0;
    if (second != gate->second) {
        *held = gate->held;
        gate->second = second;
        gate->stored = gate->held = 0;
    }
    if (gate->stored == WB_REMARK_GATE_A_SECOND) {
        gate->held++;
        return false;
    }
    gate->stored++;
    return true;
}

bool wb_remark_gate_show(struct wb_remark_gate *gate, int64_t t_ns, const char *kind)
{
    int slot = 0;
    for (int i = 0; i < WB_REMARK_GATE_KINDS; i++) {
        if (strcmp(gate->shown[i].kind, kind) == 0) {
            if (t_ns - gate->shown[i].t_ns < SHOW_PERIOD_NS)
                return false;
            slot = i;
            break;
        }
        /* A new kind replaces the one shown longest ago. */
        if (gate->shown[i].t_ns < gate->shown[slot].t_ns)
            slot = i;
    }
    snprintf(gate->shown[slot].kind, sizeof gate->shown[slot].kind, "%s", kind);
    gate->shown[slot].t_ns = t_ns;
    return true;
}
