#include "daq/acquire/listening.h"

#include <poll.h>
#include <stdio.h>
#include <string.h>

#include "base/interrupt.h"
#include "base/timing.h"
#include "base/units.h"
#include "daq/protocol/tic.h"
#include "daq/stream/stream.h"

#define WB_LOG_DOMAIN "listening"

/* The most frequent settings first. GRBL uses the first, a Tic the second. If no byte arrives at
 * these two, no instrument sends by itself, and the others are not tried. */
static const char *const lines[] = {"115200,8n1", "9600,8n1", "38400,8n1", "57600,8n1",
                                    "19200,8n1",  "4800,8n1", "2400,8n1",  "2400,7e1",
                                    "9600,7e1",   "1200,8n1", "1200,7o1"};
#define SILENT_LINES 2
#define ASK_AGAIN_NS (500 * WB_NS_PER_MS)

/* Writes the status query of the controllers that use this rate; returns its length, 0: none. */
static size_t status_query(size_t line, uint8_t bytes[WB_TIC_ASK_BYTES])
{
    if (line == 0) {
        bytes[0] = '?';
        return 1;
    }
    return line == 1 ? wb_tic_ask_status(bytes) : 0;
}

static void wait_for_bytes(struct wb_stream *stream)
{
    int descriptors[2];
    const int n = wb_stream_descriptors(stream, descriptors);
    struct pollfd polled = {.fd = descriptors[0], .events = POLLIN};
    if (n > 0)
        (void)wb_time_wait(&polled, 1, wb_time_now_ns() + 20 * WB_NS_PER_MS);
}

static enum wb_listening_found judge(const struct wb_diagnosis *diagnosis, bool asked_tic)
{
    struct wb_tic_status status;
    switch (wb_diagnosis_kind(diagnosis)) {
    case WB_DIAGNOSIS_NOTHING:
        return WB_LISTENING_NOTHING;
    case WB_DIAGNOSIS_GRBL:
        return WB_LISTENING_GRBL;
    case WB_DIAGNOSIS_OLD_GRBL:
        return WB_LISTENING_OLD_GRBL;
    case WB_DIAGNOSIS_READINGS:
        return WB_LISTENING_LOAD_CELL;
    default:
        break;
    }
    /* Only complete replies to the queries, and no other bytes. */
    if (asked_tic && diagnosis->n % WB_TIC_STATUS_BYTES == 0 &&
        wb_tic_decode_status((const uint8_t *)diagnosis->bytes, &status))
        return WB_LISTENING_TIC;
    return WB_LISTENING_UNKNOWN;
}

/* Copies the second line: the first one may be incomplete. */
static void take_sample(const struct wb_diagnosis *diagnosis, char sample[48])
{
    const char *const end = diagnosis->bytes + diagnosis->n;
    const char *at = memchr(diagnosis->bytes, '\n', diagnosis->n);
    size_t n = 0;
    at = at ? at : memchr(diagnosis->bytes, '\r', diagnosis->n);
    while (at && at < end && (*at == '\n' || *at == '\r'))
        at++;
    for (; at && at < end && *at != '\n' && *at != '\r' && n + 1 < 48; at++)
        sample[n++] = *at >= 0x20 && *at < 0x7f ? *at : '?';
    sample[n] = '\0';
}

static bool is_known(enum wb_listening_found found)
{
    return found != WB_LISTENING_NOTHING && found != WB_LISTENING_UNKNOWN;
}

/* Reads an open port with line setting i until the instrument is identified or the time is over. */
static enum wb_status listen_to(struct wb_stream *stream, size_t i,
                                const struct wb_listening_settings *settings,
                                struct wb_diagnosis *diagnosis, enum wb_listening_found *found)
{
    const int64_t begun_ns = wb_time_now_ns();
    const int64_t patience_ns = settings->patience_ns * (i == 0 && settings->asks ? 3 : 1);
    int64_t ask_ns = begun_ns, now_ns = begun_ns;
    uint8_t bytes[1024], ask[WB_TIC_ASK_BYTES];
    const size_t n_ask = settings->asks ? status_query(i, ask) : 0;
    *found = WB_LISTENING_NOTHING;
    while (now_ns - begun_ns < patience_ns && !is_known(*found) && !wb_interrupted()) {
        size_t n = 0;
        if (n_ask > 0 && now_ns >= ask_ns) {
            WB_TRY(wb_stream_write(stream, ask, n_ask));
            ask_ns = now_ns + ASK_AGAIN_NS;
        }
        wait_for_bytes(stream);
        WB_TRY(wb_stream_read(stream, bytes, sizeof bytes, &n));
        if (n > 0)
            wb_diagnosis_add(diagnosis, bytes, n);
        *found = judge(diagnosis, n_ask > 1);
        now_ns = wb_time_now_ns();
    }
    return WB_OK;
}

enum wb_status wb_listening_run(const char *address, const struct wb_listening_settings *settings,
                                struct wb_listening *heard, struct wb_reason *why)
{
    bool silent = true;
    *heard = (struct wb_listening){.found = WB_LISTENING_NOTHING};
    for (size_t i = 0; i < sizeof lines / sizeof lines[0] && !wb_interrupted(); i++) {
        char full[512];
        struct wb_stream *stream;
        struct wb_diagnosis diagnosis = {0};
        enum wb_listening_found found;
        if (i >= SILENT_LINES && silent)
            break;
        snprintf(full, sizeof full, "%.*s,%s,dtr=keep", (int)strcspn(address, ","), address,
                 lines[i]);
        struct wb_reason ignored = {0};
        const enum wb_status opened =
            wb_stream_open_with_reason(&stream, full, i == 0 ? why : &ignored);
        if (opened != WB_OK && i == 0)
            return opened;
        /* Not every port supports every rate and frame. */
        if (opened != WB_OK)
            continue;
        const enum wb_status status = listen_to(stream, i, settings, &diagnosis, &found);
        wb_stream_close(stream);
        if (status != WB_OK)
            return wb_fail_to(why, status, "reading from or writing to '%s' failed", full);
        silent = silent && found == WB_LISTENING_NOTHING;
        if (is_known(found)) {
            heard->found = found;
            snprintf(heard->line, sizeof heard->line, "%s", lines[i]);
            if (found != WB_LISTENING_TIC)
                take_sample(&diagnosis, heard->sample);
            return WB_OK;
        }
    }
    heard->found = silent ? WB_LISTENING_NOTHING : WB_LISTENING_UNKNOWN;
    return WB_OK;
}
