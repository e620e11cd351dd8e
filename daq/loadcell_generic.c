/* A load cell that prints one reading a line, by itself or when polled.
 *
 * What is decoded depends on the received bytes and their times only. Where lines end by silence,
 * a line is complete when the next byte comes after the gap; its sample then bears the time of its
 * own last byte.
 */
#include "daq/driver.h"

#include <string.h>

#include "daq/loadcell.h"

struct generic_state {
    struct wb_loadcell loadcell;
    struct wb_line_buffer line;
    int64_t first_ns, last_ns; /* arrival of the first and the last bytes */
    bool anything;             /* a byte has come */
    bool settled;              /* and the settling time is over */
    bool whole;                /* a line's end has been seen: what follows are whole lines */
    int64_t next_poll_ns;
};

static const struct wb_channel channels[] = {{"force", "force", "N"}};

static enum wb_status init(void *opaque, const struct wb_rig *rig)
{
    struct generic_state *const state = opaque;
    state->loadcell.rig = *rig;
    return WB_OK;
}

static void end_line(struct generic_state *state, int64_t t_ns, const struct wb_sink *sink)
{
    const struct wb_rig_load_cell *const cell = &state->loadcell.rig.load_cell;
    struct wb_line_reading reading;
    char text[64];
    if (!state->whole) {
        /* Reading may have begun amid a line: `00.00 g` would look like a value. */
        if (state->line.n > 0)
            wb_driver_remark(sink, WB_LOG_INFO, t_ns, "partial",
                             "the first line may be incomplete and is dropped: '%s'",
                             wb_loadcell_printable(&state->line, text, sizeof text));
        state->whole = true;
    } else {
        const size_t n = state->line.overlong ? sizeof state->line.bytes : state->line.n;
        wb_line_decode(state->line.bytes, n, cell, &reading);
        wb_loadcell_deliver(&state->loadcell, t_ns, &reading, &state->line, sink);
    }
    wb_line_buffer_clear(&state->line);
}

/* False as long as the instrument settles; times count from its first byte. */
static bool has_settled(struct generic_state *state, int64_t t_ns)
{
    if (!state->anything)
        state->first_ns = t_ns;
    state->anything = true;
    if (!state->settled)
        state->settled = t_ns - state->first_ns >= state->loadcell.rig.load_cell.settle_ns;
    return state->settled;
}

static void receive(void *opaque, int64_t t_ns, const uint8_t *bytes, size_t n,
                    const struct wb_sink *sink)
{
    struct generic_state *const state = opaque;
    const struct wb_rig_load_cell *const cell = &state->loadcell.rig.load_cell;
    if (n == 0 || !has_settled(state, t_ns))
        return;
    const bool idle = strcmp(cell->terminator, "idle") == 0;
    if (idle && state->line.n > 0 && t_ns - state->last_ns >= cell->idle_gap_ns)
        end_line(state, state->last_ns, sink);
    for (size_t i = 0; i < n; i++)
        if (wb_line_buffer_push(&state->line, bytes[i], cell->terminator))
            end_line(state, t_ns, sink);
    state->last_ns = t_ns;
}

static void start(void *opaque, int64_t now_ns, struct wb_outbox *outbox)
{
    struct generic_state *const state = opaque;
    const struct wb_rig_load_cell *const cell = &state->loadcell.rig.load_cell;
    if (cell->start_command[0])
        wb_outbox_add_text(outbox, cell->start_command);
    state->next_poll_ns = now_ns + cell->settle_ns;
}

static void tick(void *opaque, int64_t now_ns, struct wb_outbox *outbox)
{
    struct generic_state *const state = opaque;
    const struct wb_rig_load_cell *const cell = &state->loadcell.rig.load_cell;
    if (!cell->poll_command[0] || now_ns < state->next_poll_ns)
        return;
    wb_outbox_add_text(outbox, cell->poll_command);
    /* Kept to the grid, but not in a rush after a pause. */
    state->next_poll_ns += cell->poll_period_ns;
    if (state->next_poll_ns <= now_ns)
        state->next_poll_ns = now_ns + cell->poll_period_ns;
}

static bool ready(const void *opaque)
{
    const struct generic_state *const state = opaque;
    return state->loadcell.n_samples > 0;
}

static void stop(void *opaque, struct wb_outbox *outbox)
{
    /* The protocol is the instrument's own: there is no common way to end its stream. */
    (void)opaque;
    (void)outbox;
}

const struct wb_driver wb_loadcell_generic = {
    .name = "generic",
    .summary = "load cell or scale that prints one reading a line",
    .role = WB_ROLE_LOAD,
    .state_size = sizeof(struct generic_state),
    .channels = channels,
    .n_channels = 1,
    .init = init,
    .start = start,
    .receive = receive,
    .tick = tick,
    .ready = ready,
    .stop = stop,
};
