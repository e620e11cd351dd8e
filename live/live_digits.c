#include "live/live_digits.h"

#include <string.h>

/* Pixels of a glyph, five lines from the top; '#' is a set pixel. */
struct glyph {
    char character;
    int width;
    const char *lines[5];
};

static const struct glyph glyphs[] = {
    {'0', 3, {"###", "# #", "# #", "# #", "###"}}, {'1', 3, {" # ", "## ", " # ", " # ", "###"}},
    {'2', 3, {"###", "  #", "###", "#  ", "###"}}, {'3', 3, {"###", "  #", " ##", "  #", "###"}},
    {'4', 3, {"# #", "# #", "###", "  #", "  #"}}, {'5', 3, {"###", "#  ", "###", "  #", "###"}},
    {'6', 3, {"###", "#  ", "###", "# #", "###"}}, {'7', 3, {"###", "  #", "  #", "  #", "  #"}},
    {'8', 3, {"###", "# #", "###", "# #", "###"}}, {'9', 3, {"###", "# #", "###", "  #", "###"}},
    {'-', 3, {"   ", "   ", "###", "   ", "   "}}, {'.', 1, {" ", " ", " ", " ", "#"}},
    {':', 1, {" ", "#", " ", "#", " "}},
};

static const struct glyph *find(char character)
{
    for (size_t i = 0; i < sizeof glyphs / sizeof glyphs[0]; i++)
        if (glyphs[i].character == character)
            return &glyphs[i];
    return NULL;
}

void wb_live_digits_row(const char *number, int row, char text[WB_LIVE_DIGITS_TEXT])
{
    static const char *const blocks[] = {" ", "▀", "▄", "█"}; /* bit 0: upper half, bit 1: lower */
    size_t n = 0;
    text[0] = '\0';
    for (; *number; number++) {
        const struct glyph *const glyph = find(*number);
        if (!glyph || n + 4 * 3 + 1 >= WB_LIVE_DIGITS_TEXT)
            continue;
        for (int i = 0; i <= glyph->width; i++) {
            const int upper = i < glyph->width && glyph->lines[2 * row][i] == '#';
            const int lower = i < glyph->width && row < 2 && glyph->lines[2 * row + 1][i] == '#';
            const char *const block = blocks[upper + 2 * lower];
            memcpy(text + n, block, strlen(block) + 1);
            n += strlen(block);
        }
    }
}
