/* Collects the bytes of a text protocol into lines. */
#ifndef WB_DAQ_PROTOCOL_LINE_BUFFER_H
#define WB_DAQ_PROTOCOL_LINE_BUFFER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* An incomplete line. All zero: empty. */
struct wb_line_buffer {
    char bytes[256];
    size_t n;
    bool overlong; /* bytes were dropped: the line is invalid */
};

/* Appends a byte; true if it completes the line, which stays in the buffer until cleared.
 * `terminator` is that of the rig file: "cr", "lf", "crlf" (LF ends the line, the CR before it is a
 * blank), "any" or "" (CR or LF), "idle" (a pause ends the line, no byte does). */
bool wb_line_buffer_push(struct wb_line_buffer *buffer, uint8_t byte, const char *terminator);
void wb_line_buffer_clear(struct wb_line_buffer *buffer);

#endif
