/* Driver of a load cell that prints one reading per line, by itself or when polled.
 *
 * The result depends only on the received bytes and their times. If lines end by a pause, a line is
 * complete when the next byte arrives after the pause; its sample has the time of its own last
 * byte.
 */
#include "daq/protocol/driver.h"

#include <string.h>

#include "daq/protocol/loadcell.h"
#include "daq/protocol/loadcell_preset.h"

#define WB_LOG_DOMAIN "loadcell"

struct generic_state {
    struct wb_loadcell loadcell;             /* comes first */
    int64_t first_ns, last_ns;               /* arrival of the first and the last bytes */
    bool anything;                           /* a byte was received */
    bool settled;                            /* the settling time is over */
    const struct wb_loadcell_preset *preset; /* of the rig file; NULL: none */
    bool after_noise;                        /* the last line was noise */
};

static enum wb_status init(void *opaque, const struct wb_rig *rig)
{
    struct generic_state *const state = opaque;
    const char *const preset = rig->load_cell.preset;
    state->preset = wb_loadcell_preset_find(preset);
    if (preset[0] && !state->preset)
        return wb_fail(WB_ERR_ARGUMENT, "load_cell.preset: unknown preset '%s'", preset);
    return wb_loadcell_init(state, rig);
}

/* Whether the line has bytes that indicators do not print. */
static bool has_noise(const struct wb_line_buffer *line)
{
    for (size_t i = 0; i < line->n; i++) {
        const unsigned char byte = (unsigned char)line->bytes[i];
        if (byte >= 0x80 || (byte < 0x20 && byte != '\t' && byte != '\r' && byte != '\n'))
            return true;
    }
    return line->overlong;
}

static void end_line(struct generic_state *state, int64_t t_ns, const struct wb_sink *sink)
{
    struct wb_loadcell *const loadcell = &state->loadcell;
    struct wb_line_buffer *const line = &loadcell->line;
    struct wb_line_reading reading;
    char text[64];
    const bool noisy = has_noise(line);
    if (state->after_noise) {
        /* After noise that ended a line within a reading, the next line may be its rest: `.345 g`
         * of `12.345 g`. */
    } else if (!loadcell->whole) {
        /* The first line may be the rest of a longer one; `00.00 g` would look like a value. */
        if (line->n > 0)
            wb_driver_remark(sink, WB_LOG_INFO, t_ns, "partial",
                             "the first line may be incomplete and is dropped: '%s'",
                             wb_driver_printable(text, sizeof text, line->bytes, line->n));
        loadcell->whole = true;
    } else {
        const size_t n = line->overlong ? sizeof line->bytes : line->n;
        if (state->preset)
            wb_loadcell_preset_decode(state->preset, line->bytes, n, &loadcell->rig.load_cell,
                                      &reading);
        else
            wb_line_decode(line->bytes, n, &loadcell->rig.load_cell, &reading);
        wb_loadcell_deliver(loadcell, t_ns, &reading, sink);
    }
    if (line->n > 0) /* not between CR and LF */
        state->after_noise = noisy;
    loadcell->n_lines++;
    wb_line_buffer_clear(line);
}

/* False during the settling time of the instrument, which begins with its first byte. */
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
    struct wb_loadcell *const loadcell = &state->loadcell;
    const struct wb_rig_load_cell *const cell = &loadcell->rig.load_cell;
    if (n == 0) {
        wb_line_buffer_clear(&loadcell->line);
        loadcell->whole = state->anything = state->settled = false;
        return;
    }
    if (!has_settled(state, t_ns))
        return;
    const bool idle = strcmp(cell->terminator, "idle") == 0;
    if (idle && loadcell->line.n > 0 && t_ns - state->last_ns >= cell->idle_gap_ns)
        end_line(state, state->last_ns, sink);
    for (size_t i = 0; i < n; i++)
        if (wb_line_buffer_push(&loadcell->line, bytes[i], cell->terminator))
            end_line(state, t_ns, sink);
    state->last_ns = t_ns;
}

static void start(void *opaque, int64_t now_ns, struct wb_outbox *outbox)
{
    struct wb_loadcell *const loadcell = opaque;
    const struct wb_rig_load_cell *const cell = &loadcell->rig.load_cell;
    if (cell->start_command[0])
        wb_outbox_add_text(outbox, cell->start_command);
    loadcell->next_ask_ns = now_ns + cell->settle_ns;
    if (!cell->poll_command[0])
        loadcell->next_ask_ns += WB_LOADCELL_SILENCE_NS;
}

static void tick(void *opaque, int64_t now_ns, struct wb_outbox *outbox)
{
    struct generic_state *const state = opaque;
    const struct wb_rig_load_cell *const cell = &state->loadcell.rig.load_cell;
    if (cell->poll_command[0])
        wb_loadcell_poll(&state->loadcell, now_ns, cell->poll_command, outbox);
    else if (state->preset && cell->start_command[0])
        /* Repeating the request is known to be harmless only for instruments with a preset. */
        wb_loadcell_keep_streaming(&state->loadcell, now_ns, cell->start_command, outbox);
}

static void stop(void *opaque, struct wb_outbox *outbox)
{
    const struct wb_loadcell *const loadcell = opaque;
    if (loadcell->rig.load_cell.stop_command[0])
        wb_outbox_add_text(outbox, loadcell->rig.load_cell.stop_command);
}

const struct wb_driver wb_loadcell_generic = {
    .name = "generic",
    .role = WB_ROLE_LOAD,
    .state_size = sizeof(struct generic_state),
    .init = init,
    .start = start,
    .receive = receive,
    .tick = tick,
    .ready = wb_loadcell_ready,
    .stop = stop,
};
