#include "live/live_print.h"

#include <stdio.h>
#include <string.h>

#include "live/live_chart.h"
#include "live/live_raster.h"

#define MARGIN 8 /* columns for the numbers of the force axis */

static const char *begin_layer(int layer)
{
    static const char *const sequences[] = {
        [WB_LIVE_RASTER_LIMIT] = "\033[31m",
        [WB_LIVE_RASTER_PREDICTED] = "\033[34m",
        [WB_LIVE_RASTER_EARLIER] = "\033[90m",
        [WB_LIVE_RASTER_NOW] = "\033[1;36m",
    };
    return sequences[layer];
}

/* Appends the tick label of a row of the raster, or blanks. */
static void append_tick(const struct wb_live_chart *chart, const struct wb_live_raster *raster,
                        int row, bool is_unicode, struct wb_text *text)
{
    char number[32] = "";
    for (int i = 0; i < chart->force.n_ticks; i++) {
        const double at = wb_scale_position(&chart->force, chart->force.ticks[i]);
        if (row == raster->rows - 1 - (int)(at * (raster->rows - 1) + 0.5))
            snprintf(number, sizeof number, "%g", chart->force.ticks[i]);
    }
    wb_text_append(text, "%*s%s", MARGIN - 1, number, is_unicode ? "\xe2\x94\x82" : "|");
}

static void append_row(const struct wb_live_print *print, const struct wb_live_raster *raster,
                       int row, struct wb_text *text)
{
    char cell[4];
    int layer = WB_LIVE_RASTER_NONE;
    for (int column = 0; column < raster->columns; column++) {
        const char *const dots = wb_live_raster_text(raster, column, row, cell);
        const int of = dots[0] ? raster->layer[row][column] : WB_LIVE_RASTER_NONE;
        if (print->is_coloured && of != layer)
            wb_text_append(text, "\033[m%s", of == WB_LIVE_RASTER_NONE ? "" : begin_layer(of));
        layer = of;
        wb_text_append(text, "%s", dots[0] ? dots : " ");
    }
    wb_text_append(text, "%s\n",
                   print->is_coloured && layer != WB_LIVE_RASTER_NONE ? "\033[m" : "");
}

/* Appends the axis of deflection and its tick labels, as many as fit. */
static void append_axis(const struct wb_live_print *print, const struct wb_live_chart *chart,
                        int columns, struct wb_text *text)
{
    char numbers[WB_LIVE_RASTER_COLUMNS + 64];
    int end = 0;
    memset(numbers, ' ', sizeof numbers);
    wb_text_append(text, "%*s%s", MARGIN - 1, "", print->is_unicode ? "\xe2\x94\x94" : "+");
    for (int i = 0; i < columns; i++)
        wb_text_append(text, "%s", print->is_unicode ? "\xe2\x94\x80" : "-");
    for (int i = 0; i < chart->deflection.n_ticks; i++) {
        char number[32];
        const double at = wb_scale_position(&chart->deflection, chart->deflection.ticks[i]);
        const int n = snprintf(number, sizeof number, "%g", chart->deflection.ticks[i]);
        const int from = MARGIN + (int)(at * (columns - 1)) - n / 2;
        if (from < end || from + n > MARGIN + columns)
            continue;
        memcpy(numbers + from, number, (size_t)n);
        end = from + n + 1;
    }
    wb_text_append(text, "\n%.*s\n", end, numbers);
}

void wb_live_print_curve(const struct wb_live_print *print, const struct wb_live_plan *plan,
                         const struct wb_live_history *history, struct wb_text *text)
{
    struct wb_live_raster raster;
    struct wb_live_chart chart;
    wb_live_raster_init(&raster, print->columns - MARGIN, print->rows - 3, print->is_unicode);
    wb_live_chart_range(&chart, plan, history);
    wb_live_chart_draw(&chart, plan, history, &raster);
    wb_text_append(text, "tension (mN) over deflection (mm)\n");
    for (int row = 0; row < raster.rows; row++) {
        append_tick(&chart, &raster, row, print->is_unicode, text);
        append_row(print, &raster, row, text);
    }
    append_axis(print, &chart, raster.columns, text);
}
