#include "daq/protocol/line_buffer.h"

#include <string.h>

bool wb_line_buffer_push(struct wb_line_buffer *buffer, uint8_t byte, const char *terminator)
{
    const bool cr = byte == '\r' && (terminator[0] == '\0' || strcmp(terminator, "any") == 0 ||
                                     strcmp(terminator, "cr") == 0);
    const bool lf = byte == '\n' && strcmp(terminator, "cr") != 0;
    if ((cr || lf) && strcmp(terminator, "idle") != 0)
        return true;
    if (buffer->n < sizeof buffer->bytes)
        buffer->bytes[buffer->n++] = (char)byte;
    else
        buffer->overlong = true;
    return false;
}

void wb_line_buffer_clear(struct wb_line_buffer *buffer)
{
    buffer->n = 0;
    buffer->overlong = false;
}
