/* Bytes of a text protocol, gathered until they are a line. */
#ifndef WB_DAQ_PROTOCOL_LINE_BUFFER_H
#define WB_DAQ_PROTOCOL_LINE_BUFFER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Bytes on their way to be a line. All zero is empty. */
struct wb_line_buffer {
    char bytes[256];
    size_t n;
    bool overlong; /* bytes were dropped: the line is no line */
};

/* Appends a byte; true when it ends the line, which then stands in the buffer until it is cleared.
 * `terminator` is the rig file's: "cr", "lf", "crlf" (LF ends, the CR before it is a blank), "any"
 * or "" (CR or LF), "idle" (no byte ends a line, silence does). */
bool wb_line_buffer_push(struct wb_line_buffer *buffer, uint8_t byte, const char *terminator);
void wb_line_buffer_clear(struct wb_line_buffer *buffer);

#endif
