/* Large digits of half blocks, 3 rows high. */
#ifndef WB_LIVE_LIVE_DIGITS_H
#define WB_LIVE_LIVE_DIGITS_H

#define WB_LIVE_DIGITS_ROWS 3
#define WB_LIVE_DIGITS_TEXT 192

/* One row (0 to 2, from the top) of a number as UTF-8 text. Digits and '-' are 4 columns wide with
 * their gap, '.' and ':' 2; other characters, and those that do not fit, are omitted. */
void wb_live_digits_row(const char *number, int row, char text[WB_LIVE_DIGITS_TEXT]);

#endif
