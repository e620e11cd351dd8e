/* A balance that speaks MT-SICS: asked once, it streams (SIR), or it is polled (SI). `S` is never
 * sent: it waits until the load is stable, which in bending is never. */
#include "daq/driver.h"

#include <math.h>
#include <string.h>

#include "base/number.h"
#include "base/units.h"
#include "daq/loadcell.h"

#define RETRY_NS (1000 * WB_NS_PER_MS) /* of silence, then the stream is asked for again */

struct mtsics_state {
    struct wb_loadcell loadcell;
    struct wb_line_buffer line;
    bool whole; /* a line's end has been seen */
    uint64_t n_lines;
    /* For sending. */
    uint64_t lines_seen;
    int64_t next_ask_ns;
};

static const struct wb_channel channels[] = {{"force", "force", "N"}};

static enum wb_status init(void *opaque, const struct wb_rig *rig)
{
    struct mtsics_state *const state = opaque;
    state->loadcell.rig = *rig;
    return WB_OK;
}

/* Splits a line at blanks into at most four words; returns how many there are. */
static int split(char *text, char *words[4])
{
    int n = 0;
    char *rest = text;
    for (char *word; (word = strtok_r(n == 0 ? text : NULL, " \t\r", &rest));) {
        if (n < 4)
            words[n] = word;
        n++;
    }
    return n;
}

/* `S S 100.00 g`, `S D 100.00 g`, `S +`, `S -`, `S I`. */
static void decode_weight(char *const words[4], int n, struct wb_line_reading *reading)
{
    const char status = n >= 2 && words[1][1] == '\0' ? words[1][0] : '\0';
    reading->kind = WB_LINE_REFUSED;
    reading->reason = "not a weight as MT-SICS writes it";
    if (n == 2 && (status == '+' || status == '-')) {
        reading->kind = WB_LINE_OVERLOAD;
    } else if (n == 2 && status == 'I') {
        reading->reason = "the balance cannot weigh now";
    } else if ((n == 4 || n == 3) && (status == 'S' || status == 'D') &&
               wb_number_parse(words[2], &reading->value)) {
        reading->unstable = status == 'D';
        if (n == 4 && strlen(words[3]) >= sizeof reading->unit)
            return;
        if (n == 4)
            strcpy(reading->unit, words[3]);
        reading->kind = WB_LINE_VALUE;
    }
}

/* `I4 A "B123456789"` */
static void check_serial(const struct mtsics_state *state, int64_t t_ns, const char *serial,
                         const struct wb_sink *sink)
{
    const char *const expected = state->loadcell.rig.load_cell.serial_number;
    char number[64];
    const size_t quoted = serial[0] == '"';
    const size_t length = strcspn(serial + quoted, "\"");
    if (length == 0 || length >= sizeof number)
        return;
    memcpy(number, serial + quoted, length);
    number[length] = '\0';
    wb_driver_remark(sink, WB_LOG_INFO, t_ns, "connected", "balance with serial number %s", number);
    if (expected[0] && strcmp(expected, number) != 0)
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "serial",
                         "the balance has serial number %s, the rig file names %s", number,
                         expected);
}

static void decode_line(struct mtsics_state *state, int64_t t_ns, const struct wb_sink *sink)
{
    char text[sizeof state->line.bytes + 1];
    char *words[4] = {NULL, NULL, NULL, NULL};
    struct wb_line_reading reading = {.kind = WB_LINE_REFUSED, .value = (double)NAN};
    reading.reason = "not understood";
    wb_loadcell_printable(&state->line, text, sizeof text);
    /* Printable copies show a CR as '?'; here it is a blank like any other. */
    for (size_t i = 0; i < state->line.n; i++)
        if (state->line.bytes[i] == '\r')
            text[i] = ' ';
    const int n = split(text, words);
    if (state->line.overlong)
        reading.reason = "it is far too long: check the line settings";
    else if (n == 0)
        return;
    else if (strcmp(words[0], "S") == 0)
        decode_weight(words, n, &reading);
    else if (strcmp(words[0], "ES") == 0)
        reading.reason = "the balance did not understand a command (syntax)";
    else if (strcmp(words[0], "ET") == 0)
        reading.reason = "the balance received a damaged command (transmission)";
    else if (strcmp(words[0], "EL") == 0)
        reading.reason = "the balance cannot do what a command asked (logic)";
    else if (strcmp(words[0], "I4") == 0) {
        if (n >= 3)
            check_serial(state, t_ns, words[2], sink);
        return;
    }
    /* Only a line that cannot be read may have been cut off by opening the port amid it: a weight
     * begins with its status. */
    if (!state->whole && reading.kind == WB_LINE_REFUSED) {
        wb_driver_remark(sink, WB_LOG_INFO, t_ns, "partial",
                         "the first line may be incomplete and is dropped");
        return;
    }
    wb_loadcell_deliver(&state->loadcell, t_ns, &reading, &state->line, sink);
}

static void receive(void *opaque, int64_t t_ns, const uint8_t *bytes, size_t n,
                    const struct wb_sink *sink)
{
    struct mtsics_state *const state = opaque;
    for (size_t i = 0; i < n; i++) {
        if (!wb_line_buffer_push(&state->line, bytes[i], "crlf"))
            continue;
        decode_line(state, t_ns, sink);
        state->whole = true;
        state->n_lines++;
        wb_line_buffer_clear(&state->line);
    }
}

static void start(void *opaque, int64_t now_ns, struct wb_outbox *outbox)
{
    struct mtsics_state *const state = opaque;
    const bool polled = state->loadcell.rig.load_cell.poll_period_ns > 0;
    wb_outbox_add_text(outbox, "I4\r\n");
    wb_outbox_add_text(outbox, polled ? "SI\r\n" : "SIR\r\n");
    state->next_ask_ns =
        now_ns + (polled ? state->loadcell.rig.load_cell.poll_period_ns : RETRY_NS);
}

static void tick(void *opaque, int64_t now_ns, struct wb_outbox *outbox)
{
    struct mtsics_state *const state = opaque;
    const int64_t period = state->loadcell.rig.load_cell.poll_period_ns;
    if (period > 0) {
        if (now_ns < state->next_ask_ns)
            return;
        wb_outbox_add_text(outbox, "SI\r\n");
        state->next_ask_ns += period;
        if (state->next_ask_ns <= now_ns)
            state->next_ask_ns = now_ns + period;
        return;
    }
    if (state->n_lines != state->lines_seen) {
        state->lines_seen = state->n_lines;
        state->next_ask_ns = now_ns + RETRY_NS;
    }
    if (now_ns >= state->next_ask_ns) {
        wb_outbox_add_text(outbox, "SIR\r\n");
        state->next_ask_ns = now_ns + RETRY_NS;
    }
}

static bool ready(const void *opaque)
{
    const struct mtsics_state *const state = opaque;
    return state->loadcell.n_samples > 0;
}

static void stop(void *opaque, struct wb_outbox *outbox)
{
    /* One immediate weight ends the stream; a reset (@) would also forget the balance's tare. */
    const struct mtsics_state *const state = opaque;
    if (state->loadcell.rig.load_cell.poll_period_ns == 0)
        wb_outbox_add_text(outbox, "SI\r\n");
}

const struct wb_driver wb_loadcell_mtsics = {
    .name = "mt-sics",
    .summary = "balance that speaks MT-SICS",
    .role = WB_ROLE_LOAD,
    .state_size = sizeof(struct mtsics_state),
    .channels = channels,
    .n_channels = 1,
    .init = init,
    .start = start,
    .receive = receive,
    .tick = tick,
    .ready = ready,
    .stop = stop,
};
