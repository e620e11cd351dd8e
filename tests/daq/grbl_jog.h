/* Reads a jog line back, as a controller would. */
#ifndef WB_TESTS_DAQ_GRBL_JOG_H
#define WB_TESTS_DAQ_GRBL_JOG_H

#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>
#include <strings.h>

#include "base/number.h"

struct grbl_jog {
    int axis; /* 0 to 2 */
    bool relative;
    double target_mm, feed_mm_min;
};

/* False when it is not a jog of exactly one axis in mm with a feed. */
static inline bool grbl_jog_parse(const char *text, struct grbl_jog *jog)
{
    struct grbl_jog read = {.axis = -1, .feed_mm_min = (double)NAN};
    if (strncasecmp(text, "$J=", 3) != 0)
        return false;
    const char *c = text + 3;
    while (*c) {
        if (isspace((unsigned char)*c)) {
            c++;
            continue;
        }
        const char letter = (char)toupper((unsigned char)*c++);
        char word[24];
        const size_t n = strspn(c, "+-.0123456789");
        double value;
        if (n == 0 || n >= sizeof word)
            return false;
        memcpy(word, c, n);
        word[n] = '\0';
        if (!wb_number_parse(word, &value))
            return false;
        c += n;
        if (letter == 'G' && (value == 90.0 || value == 91.0)) {
            read.relative = value == 91.0;
        } else if (letter == 'F') {
            read.feed_mm_min = value;
        } else if (letter >= 'X' && letter <= 'Z' && read.axis < 0) {
            read.axis = letter - 'X';
            read.target_mm = value;
        } else if (!(letter == 'G' && value == 21.0)) {
            return false;
        }
    }
    if (read.axis < 0 || !(read.feed_mm_min > 0.0))
        return false;
    *jog = read;
    return true;
}

#endif
