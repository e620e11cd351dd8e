#include "live/live_screen.h"

#include <curses.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "base/timing.h"
#include "base/units.h"
#include "live/live_chart.h"
#include "live/live_digits.h"

/* Age of the last frame after which the view warns. */
#define STALE_S 1.0

enum pair {
    PAIR_GOOD = 1,
    PAIR_WARN,
    PAIR_BAD,
    PAIR_PREDICTED,
    PAIR_FAINT,
    PAIR_NOW,
    PAIR_TITLE
};

/* A rectangle of character cells. */
struct box {
    int row, column, rows, columns;
};

void wb_live_screen_prepare(void)
{
    start_color();
    use_default_colors();
    init_pair(PAIR_GOOD, COLOR_GREEN, -1);
    init_pair(PAIR_WARN, COLOR_YELLOW, -1);
    init_pair(PAIR_BAD, COLOR_RED, -1);
    init_pair(PAIR_PREDICTED, COLOR_BLUE, -1);
    init_pair(PAIR_FAINT, COLORS > 8 ? 8 : COLOR_WHITE, -1);
    init_pair(PAIR_NOW, COLOR_CYAN, -1);
    init_pair(PAIR_TITLE, COLOR_BLACK, COLOR_WHITE);
}

/* Writes a text, truncated to the available columns. */
static void __attribute__((format(printf, 5, 6)))
put(int row, int column, int columns, int attributes, const char *format, ...)
{
    char text[512];
    if (columns <= 0 || row < 0 || row >= LINES || column >= COLS)
        return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    attron(attributes);
    mvaddnstr(row, column, text, columns);
    attroff(attributes);
}

static void number_or_dash(double value, double unit, int decimals, char text[32])
{
    if (isfinite(value))
        snprintf(text, 32, "%.*f", decimals, value / unit);
    else
        snprintf(text, 32, "--");
}

static void clock_of(double seconds, char text[32])
{
    const long whole = isfinite(seconds) ? lround(ceil(seconds)) : 0;
    if (!isfinite(seconds))
        snprintf(text, 32, "--");
    else if (whole >= 3600)
        snprintf(text, 32, "%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60, whole % 60);
    else
        snprintf(text, 32, "%ld:%02ld", whole / 60, whole % 60);
}

/* --- title --- */

static int word_colour(enum wb_live_frame_word word)
{
    switch (word) {
    case WB_LIVE_FRAME_CONNECTING:
    case WB_LIVE_FRAME_HELD:
        return PAIR_WARN;
    case WB_LIVE_FRAME_STOPPED:
    case WB_LIVE_FRAME_FAULTED:
        return PAIR_BAD;
    default:
        return PAIR_GOOD;
    }
}

/* Draws the background of the title or the keys. */
static void draw_bar(int row)
{
    attron(COLOR_PAIR(PAIR_TITLE));
    mvhline(row, 0, ' ', COLS);
    attroff(COLOR_PAIR(PAIR_TITLE));
}

static void draw_title(const struct wb_live_screen *screen)
{
    const struct wb_live_frame *const frame = &screen->history->frame;
    char text[256] = "", word[64] = "connecting", clock[32];
    int colour = PAIR_WARN;
    const double age = wb_seconds_from_ns(wb_time_now_ns() - screen->history->frame_ns);
    draw_bar(0);
    put(0, 0, COLS, COLOR_PAIR(PAIR_TITLE), " %s%s",
        screen->plan->is_virtual ? "VIRTUAL RIG  " : "", screen->plan->title);
    if (screen->history->has_frame) {
        snprintf(word, sizeof word, "%s", wb_live_frame_word(frame->word));
        colour = word_colour(frame->word);
        clock_of(frame->elapsed, clock);
        if (frame->cycle > 0)
            snprintf(text, sizeof text, "%s, cycle %d of %d, %s", frame->phase, frame->cycle,
                     frame->cycles, clock);
        else
            snprintf(text, sizeof text, "%s, %s", frame->phase, clock);
        if (age > STALE_S) {
            snprintf(word, sizeof word, "NO DATA FOR %.0f s", age);
            colour = PAIR_BAD;
        }
    }
    put(1, 1, COLS - 2, COLOR_PAIR(colour) | A_BOLD, "%s", word);
    put(1, 3 + (int)strlen(word), COLS - 4 - (int)strlen(word), A_NORMAL, "%s", text);
}

/* --- charts --- */

static int layer_attributes(int layer)
{
    switch (layer) {
    case WB_LIVE_RASTER_LIMIT:
        return COLOR_PAIR(PAIR_BAD);
    case WB_LIVE_RASTER_PREDICTED:
        return COLOR_PAIR(PAIR_PREDICTED);
    case WB_LIVE_RASTER_EARLIER:
        return COLOR_PAIR(PAIR_FAINT);
    default:
        return COLOR_PAIR(PAIR_NOW) | A_BOLD;
    }
}

static void draw_raster(const struct wb_live_raster *raster, int top, int left)
{
    char text[4];
    for (int row = 0; row < raster->rows; row++) {
        for (int column = 0; column < raster->columns; column++) {
            if (raster->bits[row][column] == 0)
                continue;
            attrset(layer_attributes(raster->layer[row][column]));
            mvaddstr(top + row, left + column, wb_live_raster_text(raster, column, row, text));
        }
    }
    attrset(A_NORMAL);
}

#define MARGIN 8 /* columns for the numbers of the force axis */

/* The longest heading that leaves room for the legend. */
static const char *heading_of(const struct box *box)
{
    if (box->columns < 72)
        return "mN over mm";
    return box->columns < 88 ? "tension, mN over mm" : "tension (mN) over deflection (mm)";
}

static void draw_axes(const struct box *box, const struct wb_live_chart *chart)
{
    const int height = box->rows - 3, width = box->columns - MARGIN;
    char text[32];
    mvvline(box->row + 1, box->column + MARGIN - 1, ACS_VLINE, height);
    mvhline(box->row + 1 + height, box->column + MARGIN, ACS_HLINE, width);
    mvaddch(box->row + 1 + height, box->column + MARGIN - 1, ACS_LLCORNER);
    put(box->row, box->column, box->columns, A_NORMAL, "%s", heading_of(box));
    for (int i = 0; i < chart->force.n_ticks; i++) {
        const double at = wb_scale_position(&chart->force, chart->force.ticks[i]);
        put(box->row + height - (int)(at * (height - 1) + 0.5), box->column, MARGIN - 1, A_NORMAL,
            "%*g", MARGIN - 2, chart->force.ticks[i]);
    }
    int free_from = 0;
    for (int i = 0; i < chart->deflection.n_ticks; i++) {
        const double at = wb_scale_position(&chart->deflection, chart->deflection.ticks[i]);
        snprintf(text, sizeof text, "%g", chart->deflection.ticks[i]);
        const int column = MARGIN + (int)(at * (width - 1)) - (int)strlen(text) / 2;
        if (column < free_from || column + (int)strlen(text) > box->columns)
            continue;
        put(box->row + 2 + height, box->column + column, 12, A_NORMAL, "%s", text);
        free_from = column + (int)strlen(text) + 1;
    }
}

/* Legend of the colours, and limits beyond the axes. */
static void draw_legend(const struct wb_live_screen *screen, const struct box *box,
                        const struct wb_live_chart *chart)
{
    int column = box->column + (int)strlen(heading_of(box)) + 2;
    const int end = box->column + box->columns;
    put(box->row, column, end - column, COLOR_PAIR(PAIR_NOW) | A_BOLD, "this cycle");
    column += 12;
    if (screen->history->frame.cycle > 1 || screen->plan->n_earlier > 0) {
        put(box->row, column, end - column, COLOR_PAIR(PAIR_FAINT), "earlier");
        column += 9;
    }
    if (screen->plan->n_predicted > 0) {
        put(box->row, column, end - column, COLOR_PAIR(PAIR_PREDICTED), "predicted");
        column += 11;
    }
    if (screen->plan->force_limit > 0.0)
        put(box->row, column, end - column, COLOR_PAIR(PAIR_BAD), "limit %.0f mN%s",
            screen->plan->force_limit / WB_MN, chart->shows_force_limit ? "" : " (above)");
}

static void draw_curve(const struct wb_live_screen *screen, const struct box *box)
{
    struct wb_live_raster raster;
    struct wb_live_chart chart;
    wb_live_raster_init(&raster, box->columns - MARGIN, box->rows - 3, screen->is_unicode);
    wb_live_chart_range(&chart, screen->plan, screen->history);
    wb_live_chart_draw(&chart, screen->plan, screen->history, &raster);
    /* In a very large window the axes have the size of the raster, which is limited. */
    draw_axes(&(struct box){box->row, box->column, raster.rows + 3, raster.columns + MARGIN},
              &chart);
    draw_legend(screen, box, &chart);
    draw_raster(&raster, box->row + 1, box->column + MARGIN);
}

/* Draws the wire and its markers. */
static void draw_shape(const struct wb_live_screen *screen, const struct box *box)
{
    const struct wb_live_frame *const frame = &screen->history->frame;
    struct wb_live_raster raster;
    put(box->row, box->column, box->columns, A_NORMAL, "the wire, from the clamp");
    if (!screen->history->has_frame || !frame->are_markers_found) {
        put(box->row + 1, box->column + MARGIN, box->columns - MARGIN, COLOR_PAIR(PAIR_FAINT),
            "not all markers have been seen in one frame yet");
        return;
    }
    double place[WB_SPECIMEN_MAX_MARKERS][2];
    wb_live_raster_init(&raster, box->columns - MARGIN, box->rows - 1, screen->is_unicode);
    wb_live_chart_wire(screen->plan, frame, &raster, place);
    draw_raster(&raster, box->row + 1, box->column + MARGIN);
    for (int i = 0; i < frame->n_markers; i++) {
        const bool seen = frame->seen >> i & 1u;
        const int column = (int)(place[i][0] * raster.columns / raster.width);
        const int row = raster.rows - 1 - (int)(place[i][1] * raster.rows / raster.height);
        if (row < 0 || row >= raster.rows || column < 0 || column >= raster.columns)
            continue;
        put(box->row + 1 + row, box->column + MARGIN + column, 3,
            COLOR_PAIR(seen ? PAIR_GOOD : PAIR_BAD) | A_BOLD, "%s",
            seen ? (screen->is_unicode ? "●" : "o") : (screen->is_unicode ? "○" : "x"));
    }
}

/* --- panel of numbers --- */

struct figure {
    const char *name, *unit;
    char value[32];
};

static void get_figures(const struct wb_live_screen *screen, struct figure figures[4])
{
    const struct wb_live_frame *const frame = &screen->history->frame;
    const double unknown = screen->history->has_frame ? 1.0 : (double)NAN;
    figures[0] = (struct figure){.name = "tension", .unit = "mN"};
    figures[1] = (struct figure){.name = "peak tension", .unit = "mN"};
    figures[2] = (struct figure){.name = "deflection", .unit = "mm"};
    figures[3] = (struct figure){.name = "time left", .unit = ""};
    number_or_dash(frame->force * unknown, WB_MN, 2, figures[0].value);
    number_or_dash(frame->peak * unknown, WB_MN, 2, figures[1].value);
    number_or_dash(frame->deflection * unknown, WB_MM, 1, figures[2].value);
    clock_of(frame->time_left * unknown, figures[3].value);
}

/* Returns the row after the figures. */
static int draw_figures(const struct wb_live_screen *screen, const struct box *box, bool large)
{
    struct figure figures[4];
    char line[WB_LIVE_DIGITS_TEXT];
    int row = box->row;
    get_figures(screen, figures);
    for (int i = 0; i < 4; i++) {
        if (!large) {
            put(row++, box->column, box->columns, A_BOLD, "%-12s %9s %s", figures[i].name,
                figures[i].value, figures[i].unit);
            continue;
        }
        put(row++, box->column, box->columns, A_NORMAL, "%s%s%s", figures[i].name,
            figures[i].unit[0] ? ", " : "", figures[i].unit);
        for (int k = 0; k < WB_LIVE_DIGITS_ROWS; k++) {
            wb_live_digits_row(figures[i].value, k, line);
            put(row++, box->column, WB_LIVE_DIGITS_TEXT, A_BOLD | COLOR_PAIR(i == 1 ? 0 : PAIR_NOW),
                "%s", line);
        }
    }
    return row + 1;
}

static int draw_lamps(const struct wb_live_screen *screen, const struct box *box, int row)
{
    const struct wb_live_frame *const frame = &screen->history->frame;
    const int n = screen->history->has_frame ? frame->n_markers : 0;
    const char *const on = screen->is_unicode ? "●" : "*", *const off =
                                                               screen->is_unicode ? "○" : "-";
    int column = box->column + 9;
    put(row, box->column, box->columns, A_NORMAL, "markers");
    if (n == 0 || !frame->are_markers_found) {
        put(row, column, box->columns - 9, COLOR_PAIR(PAIR_WARN), "not found yet");
        return row + 1;
    }
    for (int i = 0; i < n; i++, column++) {
        const bool seen = frame->seen >> i & 1u;
        if (column >= box->column + box->columns) {
            column = box->column + 9;
            row++;
        }
        put(row, column, 3, COLOR_PAIR(seen ? PAIR_GOOD : PAIR_BAD) | A_BOLD, "%s",
            seen ? on : off);
    }
    return row + 1;
}

static int draw_streams(const struct wb_live_screen *screen, const struct box *box, int row)
{
    static const char *const names[WB_INTERLOCK_ROLES] = {
        [WB_ROLE_LOAD] = "cell", [WB_ROLE_MOCAP] = "cameras", [WB_ROLE_STAGE] = "stage"};
    const struct wb_live_frame *const frame = &screen->history->frame;
    for (int role = 0; role < WB_INTERLOCK_ROLES; role++, row++) {
        const struct wb_live_frame_stream *const stream = &frame->stream[role];
        char text[128];
        int colour = PAIR_GOOD;
        if (!screen->history->has_frame || !stream->is_ready) {
            snprintf(text, sizeof text, "connecting");
            colour = PAIR_WARN;
        } else if (stream->is_gone || stream->is_lost) {
            snprintf(text, sizeof text, "%s", stream->is_gone ? "DISCONNECTED" : "SILENT");
            colour = PAIR_BAD;
        } else if (stream->gaps + stream->drops > 0) {
            snprintf(text, sizeof text, "%.0f Hz, %" PRIu64 " gaps, %" PRIu64 " lost", stream->rate,
                     stream->gaps, stream->missing + stream->drops);
            colour = stream->is_losing || stream->drops > 0 ? PAIR_BAD : PAIR_WARN;
        } else {
            snprintf(text, sizeof text, "%.0f Hz, no gaps", stream->rate);
        }
        put(row, box->column, box->columns, COLOR_PAIR(colour), "%-8s %s", names[role], text);
    }
    return row;
}

static int draw_disk(const struct wb_live_screen *screen, const struct box *box, int row)
{
    const struct wb_live_frame *const frame = &screen->history->frame;
    const double room_left = screen->history->disk_free;
    const double hours = screen->history->disk_left / 3600.0;
    const int room_colour = COLOR_PAIR(isfinite(hours) && hours < 1.0 ? PAIR_BAD : PAIR_GOOD);
    const int colour =
        COLOR_PAIR(frame->is_disk_failing || frame->is_disk_late ? PAIR_BAD : PAIR_GOOD);
    if (!isfinite(room_left))
        put(row++, box->column, box->columns, room_colour, "disk     free space unknown");
    else if (isfinite(hours) && hours < 1000.0)
        put(row++, box->column, box->columns, room_colour, "disk     %.3g GB free, for %.3g h",
            room_left / 1e9, hours);
    else
        put(row++, box->column, box->columns, room_colour, "disk     %.3g GB free",
            room_left / 1e9);
    if (frame->is_disk_failing)
        put(row++, box->column, box->columns, colour, "         FAILS, memory %.0f %% full",
            frame->disk_fill / WB_PERCENT);
    else
        put(row++, box->column, box->columns, colour, "         %.1f s behind", frame->disk_lag);
    if (frame->frames_dropped > 0)
        put(row++, box->column, box->columns, COLOR_PAIR(PAIR_FAINT),
            "view     %" PRIu64 " frames not drawn", frame->frames_dropped);
    return row;
}

/* --- messages and keys --- */

static void draw_messages(const struct wb_live_screen *screen, const struct box *box)
{
    const struct wb_live_history *const history = screen->history;
    const struct wb_live_frame *const frame = &history->frame;
    const bool has_end = history->has_frame && frame->text[0] != '\0';
    const int most = box->rows - has_end;
    int first = history->n_messages - most, row = box->row;
    if (has_end)
        put(row++, 1, COLS - 2, COLOR_PAIR(word_colour(frame->word)) | A_BOLD, "%s", frame->text);
    if (first < 0)
        first = 0;
    for (int i = first; i < history->n_messages; i++, row++) {
        const struct wb_live_frame_message *const message =
            &history->message[i % WB_LIVE_HISTORY_MESSAGES];
        const int colour = message->level == WB_LOG_ERROR     ? PAIR_BAD
                           : message->level == WB_LOG_WARNING ? PAIR_WARN
                                                              : 0;
        put(row, 1, COLS - 2, COLOR_PAIR(colour), "%s", message->text);
    }
}

static void draw_keys(const struct wb_live_screen *screen)
{
    const bool is_held = screen->history->frame.word == WB_LIVE_FRAME_HELD;
    draw_bar(LINES - 1);
    put(LINES - 1, 1, COLS - 2, COLOR_PAIR(PAIR_TITLE), "%s",
        COLS < 54 ? is_held ? "q stop  r resume  m mark" : "q stop  h hold  m mark"
        : is_held ? "m  mark this moment    r  resume    q  stop the test"
                  : "m  mark this moment    h  hold    q  stop the test");
}

/* --- screen --- */

/* Least size of the window for the curve, for the wire, and for large digits. */
#define LEAST_ROWS 16
#define LEAST_COLUMNS 60
#define ROWS_FOR_SHAPE 32
#define ROWS_FOR_LARGE 33

static void draw_panel(const struct wb_live_screen *screen, const struct box *box)
{
    int row = draw_figures(screen, box, screen->is_unicode && LINES >= ROWS_FOR_LARGE);
    row = draw_lamps(screen, box, row);
    row = draw_streams(screen, box, row);
    (void)draw_disk(screen, box, row);
}

void wb_live_screen_draw(const struct wb_live_screen *screen)
{
    erase();
    draw_title(screen);
    if (LINES < LEAST_ROWS || COLS < LEAST_COLUMNS) {
        const struct box box = {2, 1, LINES - 3, COLS - 2};
        const int row = draw_figures(screen, &box, false);
        put(row, 1, COLS - 2, COLOR_PAIR(PAIR_FAINT), "enlarge the window to see the curve");
    } else {
        const int panel = COLS >= 96 ? 36 : 32;
        const int n_messages = LINES >= 36 ? 4 : 2;
        const int rows = LINES - 4 - n_messages;
        const int shape = LINES >= ROWS_FOR_SHAPE ? rows * 2 / 5 : 0;
        draw_curve(screen, &(struct box){3, 0, rows - shape, COLS - panel - 2});
        if (shape > 0)
            draw_shape(screen, &(struct box){3 + rows - shape, 0, shape, COLS - panel - 2});
        draw_panel(screen, &(struct box){3, COLS - panel, rows, panel});
        draw_messages(screen, &(struct box){LINES - 1 - n_messages, 0, n_messages, COLS});
    }
    draw_keys(screen);
    refresh();
}
