#include "daq/protocol/loadcell.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum wb_status wb_loadcell_init(void *state, const struct wb_rig *rig)
{
    struct wb_loadcell *const loadcell = state;
    loadcell->rig = *rig;
    return WB_OK;
}

bool wb_loadcell_ready(const void *state)
{
    const struct wb_loadcell *const loadcell = state;
    return loadcell->n_samples > 0;
}

void wb_loadcell_poll(struct wb_loadcell *loadcell, int64_t now_ns, const char *question,
                      struct wb_outbox *outbox)
{
    const int64_t period = loadcell->rig.load_cell.poll_period_ns;
    if (now_ns < loadcell->next_ask_ns)
        return;
    wb_outbox_add_text(outbox, question);
    loadcell->next_ask_ns += period;
    if (loadcell->next_ask_ns <= now_ns)
        loadcell->next_ask_ns = now_ns + period;
}

void wb_loadcell_keep_streaming(struct wb_loadcell *loadcell, int64_t now_ns, const char *question,
                                struct wb_outbox *outbox)
{
    if (loadcell->n_lines != loadcell->lines_seen) {
        loadcell->lines_seen = loadcell->n_lines;
        loadcell->next_ask_ns = now_ns + WB_LOADCELL_SILENCE_NS;
    }
    if (now_ns < loadcell->next_ask_ns)
        return;
    wb_outbox_add_text(outbox, question);
    loadcell->next_ask_ns = now_ns + WB_LOADCELL_SILENCE_NS;
}

static void reject_line(struct wb_loadcell *loadcell, int64_t t_ns, const char *reason,
                        const struct wb_sink *sink)
{
    char text[64];
    loadcell->n_refused++;
    if (wb_driver_is_report_due(loadcell->n_refused))
        wb_driver_remark(
            sink, WB_LOG_WARNING, t_ns, "refused",
            "a line of the load cell cannot be decoded: '%s': %s; %" PRIu64 " so far",
            wb_driver_printable(text, sizeof text, loadcell->line.bytes, loadcell->line.n), reason,
            loadcell->n_refused);
}

/* Tracks the unit; true if the line's unit differs from the first one. A line without a unit is
 * ignored (some scales omit it while unstable). */
static bool watch_unit(struct wb_loadcell *loadcell, int64_t t_ns, const char *unit,
                       const struct wb_sink *sink)
{
    if (unit[0] == '\0')
        return strcmp(loadcell->last_unit, loadcell->first_unit) != 0;
    if (loadcell->first_unit[0] == '\0') {
        strcpy(loadcell->first_unit, unit);
        strcpy(loadcell->last_unit, unit);
    }
    if (strcmp(loadcell->last_unit, unit) != 0)
        wb_driver_remark(sink, WB_LOG_ERROR, t_ns, "unit",
                         "the load cell's unit changed from %s to %s", loadcell->last_unit, unit);
    strcpy(loadcell->last_unit, unit);
    return strcmp(loadcell->first_unit, unit) != 0;
}

/* Whether the line's unit contradicts the rig file; this is reported once. */
static bool contradicts(struct wb_loadcell *loadcell, int64_t t_ns,
                        const struct wb_line_reading *reading, const struct wb_sink *sink)
{
    const char *const of_rig = loadcell->rig.load_cell.unit;
    if (!wb_line_unit_contradicts(reading, &loadcell->rig.load_cell))
        return false;
    if (!loadcell->contradicted)
        wb_driver_remark(sink, WB_LOG_ERROR, t_ns, "unit",
                         "the load cell prints %s, but load_cell.unit of the rig file is %s; the "
                         "printed unit is used: correct one of them",
                         reading->unit, of_rig);
    loadcell->contradicted = true;
    return true;
}

static void pass_on(struct wb_loadcell *loadcell, const struct wb_load_sample *sample,
                    const struct wb_sink *sink)
{
    loadcell->n_samples++;
    if (sink->load)
        sink->load(sink->context, sample);
}

static void deliver_overload(struct wb_loadcell *loadcell, struct wb_load_sample *sample,
                             const struct wb_sink *sink)
{
    char text[64];
    sample->overload = true;
    if (!loadcell->overloaded)
        wb_driver_remark(
            sink, WB_LOG_ERROR, sample->t_ns, "overload", "the load cell is out of range: '%s'",
            wb_driver_printable(text, sizeof text, loadcell->line.bytes, loadcell->line.n));
    loadcell->overloaded = true;
    pass_on(loadcell, sample, sink);
}

void wb_loadcell_deliver(struct wb_loadcell *loadcell, int64_t t_ns,
                         const struct wb_line_reading *reading, const struct wb_sink *sink)
{
    const struct wb_rig_load_cell *const cell = &loadcell->rig.load_cell;
    struct wb_load_sample sample = {
        .t_ns = t_ns,
        .index = loadcell->n_samples,
        .force = (double)NAN,
        .unstable = reading->unstable,
    };
    if (reading->kind == WB_LINE_EMPTY)
        return;
    if (reading->kind == WB_LINE_REFUSED) {
        reject_line(loadcell, t_ns, reading->reason, sink);
        return;
    }
    if (reading->kind == WB_LINE_OVERLOAD) {
        deliver_overload(loadcell, &sample, sink);
        return;
    }
    /* A line without a unit is read in the last printed unit. */
    struct wb_line_reading complete = *reading;
    if (complete.unit[0] == '\0')
        strcpy(complete.unit, loadcell->last_unit);
    double force;
    if (!wb_line_force(&complete, cell, loadcell->rig.gravity, &force)) {
        reject_line(loadcell, t_ns,
                    complete.unit[0] ? "unknown unit: set load_cell.unit in the rig file"
                                     : "no unit: set load_cell.unit in the rig file",
                    sink);
        return;
    }
    sample.unit_changed = watch_unit(loadcell, t_ns, reading->unit, sink);
    sample.unit_contradicts = contradicts(loadcell, t_ns, &complete, sink);
    if (cell->overload > 0.0 && !(fabs(force) <= cell->overload)) {
        deliver_overload(loadcell, &sample, sink);
        return;
    }
    sample.valid = true;
    sample.force = force;
    loadcell->overloaded = false;
    pass_on(loadcell, &sample, sink);
}
