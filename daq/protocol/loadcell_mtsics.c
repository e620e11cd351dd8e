/* Driver of a balance with MT-SICS: it streams on request (SIR) or is polled (SI). The command `S`
 * is not used, because it waits for a stable load, which never occurs during bending. */
#include "daq/protocol/driver.h"

#include <math.h>
#include <string.h>

#include "base/number.h"
#include "daq/protocol/loadcell.h"

/* Splits a line at blanks into at most four words; returns their number. */
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

/* Decodes `S S 100.00 g`, `S D 100.00 g`, `S +`, `S -` or `S I`. */
static void decode_weight(char *const words[4], int n, struct wb_line_reading *reading)
{
    const char status = n >= 2 && words[1][1] == '\0' ? words[1][0] : '\0';
    reading->kind = WB_LINE_REFUSED;
    reading->reason = "not a weight in the format of MT-SICS";
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

/* Checks the serial number in the reply `I4 A "B123456789"`. */
static void check_serial(const struct wb_loadcell *loadcell, int64_t t_ns, const char *serial,
                         const struct wb_sink *sink)
{
    const char *const expected = loadcell->rig.load_cell.serial_number;
    char number[64];
    const size_t quoted = serial[0] == '"';
    const size_t length = strcspn(serial + quoted, "\"");
    if (length == 0 || length >= sizeof number)
        return;
    memcpy(number, serial + quoted, length);
    number[length] = '\0';
    wb_driver_remark(sink, WB_LOG_INFO, t_ns, "connected",
                     "the balance with serial number %s is connected", number);
    if (expected[0] && strcmp(expected, number) != 0)
        wb_driver_remark(
            sink, WB_LOG_WARNING, t_ns, "serial",
            "the balance has serial number %s, but load_cell.serial_number is %s: check that it is "
            "the right balance",
            number, expected);
}

static void decode_line(struct wb_loadcell *loadcell, int64_t t_ns, const struct wb_sink *sink)
{
    const struct wb_line_buffer *const line = &loadcell->line;
    char text[sizeof line->bytes + 1];
    char *words[4] = {NULL, NULL, NULL, NULL};
    struct wb_line_reading reading = {.kind = WB_LINE_REFUSED, .value = (double)NAN};
    reading.reason = "not a reply of MT-SICS: check load_cell.protocol";
    wb_driver_printable(text, sizeof text, line->bytes, line->n);
    /* Replace CR by a blank, before a printable copy would show it as '?'. */
    for (size_t i = 0; i < line->n; i++)
        if (line->bytes[i] == '\r')
            text[i] = ' ';
    const int n = split(text, words);
    if (line->overlong)
        reading.reason = "the line is too long: check baud rate and parity in load_cell.address";
    else if (n == 0)
        return;
    else if (strcmp(words[0], "S") == 0)
        decode_weight(words, n, &reading);
    else if (strcmp(words[0], "ES") == 0)
        reading.reason = "the balance rejected a command (syntax)";
    else if (strcmp(words[0], "ET") == 0)
        reading.reason = "the balance received a damaged command (transmission)";
    else if (strcmp(words[0], "EL") == 0)
        reading.reason = "the balance cannot execute a command (logic)";
    else if (strcmp(words[0], "I4") == 0) {
        if (n >= 3)
            check_serial(loadcell, t_ns, words[2], sink);
        return;
    }
    /* A first line that can be decoded is complete, because a weight begins with its status. */
    if (!loadcell->whole && reading.kind == WB_LINE_REFUSED) {
        wb_driver_remark(sink, WB_LOG_INFO, t_ns, "partial",
                         "the first line may be incomplete and is dropped");
        return;
    }
    wb_loadcell_deliver(loadcell, t_ns, &reading, sink);
}

static void receive(void *opaque, int64_t t_ns, const uint8_t *bytes, size_t n,
                    const struct wb_sink *sink)
{
    struct wb_loadcell *const loadcell = opaque;
    if (n == 0) {
        wb_line_buffer_clear(&loadcell->line);
        loadcell->whole = false;
    }
    for (size_t i = 0; i < n; i++) {
        if (!wb_line_buffer_push(&loadcell->line, bytes[i], "crlf"))
            continue;
        decode_line(loadcell, t_ns, sink);
        loadcell->whole = true;
        loadcell->n_lines++;
        wb_line_buffer_clear(&loadcell->line);
    }
}

static void start(void *opaque, int64_t now_ns, struct wb_outbox *outbox)
{
    struct wb_loadcell *const loadcell = opaque;
    const int64_t period = loadcell->rig.load_cell.poll_period_ns;
    wb_outbox_add_text(outbox, "I4\r\n");
    wb_outbox_add_text(outbox, period > 0 ? "SI\r\n" : "SIR\r\n");
    loadcell->next_ask_ns = now_ns + (period > 0 ? period : WB_LOADCELL_SILENCE_NS);
}

static void tick(void *opaque, int64_t now_ns, struct wb_outbox *outbox)
{
    struct wb_loadcell *const loadcell = opaque;
    if (loadcell->rig.load_cell.poll_period_ns > 0)
        wb_loadcell_poll(loadcell, now_ns, "SI\r\n", outbox);
    else
        wb_loadcell_keep_streaming(loadcell, now_ns, "SIR\r\n", outbox);
}

static void stop(void *opaque, struct wb_outbox *outbox)
{
    /* A single immediate weight ends the stream; a reset (@) would also clear the balance's tare.
     */
    const struct wb_loadcell *const loadcell = opaque;
    if (loadcell->rig.load_cell.poll_period_ns == 0)
        wb_outbox_add_text(outbox, "SI\r\n");
}

const struct wb_driver wb_loadcell_mtsics = {
    .name = "mt-sics",
    .role = WB_ROLE_LOAD,
    .state_size = sizeof(struct wb_loadcell),
    .init = wb_loadcell_init,
    .start = start,
    .receive = receive,
    .tick = tick,
    .ready = wb_loadcell_ready,
    .stop = stop,
};
