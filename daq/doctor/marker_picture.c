#include "daq/doctor/marker_picture.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "daq/acquire/acquisition.h"
#include "daq/acquire/marker_check.h"

#define COLUMNS 78     /* of the canvas; the left border takes two more */
#define ROWS 11        /* of the canvas */
#define CELL_RATIO 2.0 /* a character is twice as high as wide */
#define LEAST_MARGIN 2

struct point {
    double along, up; /* m */
    char sign;
};

struct view {
    int n;
    struct point points[WB_MAX_MARKERS];
    double left, bottom; /* m of the canvas's corner */
    double scale;        /* m a column */
    char canvas[ROWS][COLUMNS + 1];
};

static char sign_of(int marker)
{
    static const char signs[] = "123456789abcdefghijklmnopqrstuvwxyz";
    return signs[marker];
}

/* The horizontal direction in which the measured markers extend most. */
static void find_direction(const struct wb_mocap_frame *frame, int up, double direction[3])
{
    const int a = (up + 1) % 3, b = (up + 2) % 3;
    double n = 0.0, ma = 0.0, mb = 0.0, aa = 0.0, ab = 0.0, bb = 0.0;
    for (int i = 0; i < frame->n_markers; i++) {
        if (!wb_acquisition_marker_measured(&frame->markers[i]))
            continue;
        const double pa = (double)frame->markers[i].position[a];
        const double pb = (double)frame->markers[i].position[b];
        n++;
        ma += pa;
        mb += pb;
        aa += pa * pa;
        ab += pa * pb;
        bb += pb * pb;
    }
    const double angle =
        n > 0.0 ? 0.5 * atan2(2.0 * (ab - ma * mb / n), aa - ma * ma / n - bb + mb * mb / n) : 0.0;
    direction[up] = 0.0;
    direction[a] = cos(angle);
    direction[b] = sin(angle);
}

static double along(const struct wb_marker *marker, const double direction[3])
{
    double sum = 0.0;
    for (int k = 0; k < 3; k++)
        sum += (double)marker->position[k] * direction[k];
    return sum;
}

static void collect(struct view *view, const struct wb_mocap_frame *frame,
                    const struct wb_specimen *specimen, const struct wb_marker_places *places,
                    int up)
{
    double direction[3];
    int first = -1, last = -1;
    find_direction(frame, up, direction);
    for (int m = 0; specimen && m < specimen->n_markers; m++) {
        if (places->index[m] < 0)
            continue;
        first = first < 0 ? places->index[m] : first;
        last = places->index[m];
    }
    if (last >= 0 &&
        along(&frame->markers[last], direction) < along(&frame->markers[first], direction))
        for (int k = 0; k < 3; k++)
            direction[k] = -direction[k];
    for (int i = 0; i < frame->n_markers; i++) {
        const struct wb_marker *const marker = &frame->markers[i];
        if (!wb_acquisition_marker_measured(marker))
            continue;
        struct point *const point = &view->points[view->n++];
        *point = (struct point){along(marker, direction), (double)marker->position[up], '*'};
        for (int m = 0; specimen && m < specimen->n_markers; m++)
            if (places->index[m] == i)
                point->sign = sign_of(m);
    }
}

/* Chooses a scale at which the canvas shows all points and the length of the specimen. */
static void choose_scale(struct view *view, double length)
{
    double low[2] = {0.0, 0.0}, high[2] = {0.0, 0.0};
    for (int i = 0; i < view->n; i++) {
        const double at[2] = {view->points[i].along, view->points[i].up};
        for (int k = 0; k < 2; k++) {
            low[k] = i > 0 ? fmin(low[k], at[k]) : at[k];
            high[k] = i > 0 ? fmax(high[k], at[k]) : at[k];
        }
    }
    const double across = (COLUMNS - 2 * LEAST_MARGIN - 1), height = CELL_RATIO * (ROWS - 1);
    view->scale = fmax(fmax(high[0] - low[0], length) / across, (high[1] - low[1]) / height);
    if (!(view->scale > 0.0))
        view->scale = 1.0 * WB_MM;
    view->left = low[0] - LEAST_MARGIN * view->scale;
    view->bottom = 0.5 * (low[1] + high[1]) - 0.5 * (ROWS - 1) * CELL_RATIO * view->scale;
}

static int column(const struct view *view, double at)
{
    const int k = (int)lround((at - view->left) / view->scale);
    return k < 0 ? 0 : k >= COLUMNS ? COLUMNS - 1 : k;
}

static void plot(struct view *view)
{
    for (int row = 0; row < ROWS; row++) {
        memset(view->canvas[row], ' ', COLUMNS);
        view->canvas[row][COLUMNS] = '\0';
    }
    /* Strays are drawn first, so that the specimen's markers cover them. */
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < view->n; i++) {
            const struct point *const point = &view->points[i];
            const int up = (int)lround((point->up - view->bottom) / (CELL_RATIO * view->scale));
            const int row = up < 0 ? ROWS - 1 : up >= ROWS ? 0 : ROWS - 1 - up;
            if ((point->sign != '*') == (pass == 1))
                view->canvas[row][column(view, point->along)] = point->sign;
        }
    }
}

static bool is_blank(const char *line)
{
    return line[strspn(line, " ")] == '\0';
}

static void put(char *text, size_t size, const char *border, char *line)
{
    const size_t used = strlen(text);
    for (size_t n = strlen(line); n > 0 && line[n - 1] == ' '; n--)
        line[n - 1] = '\0';
    snprintf(text + used, size - used, "%s%s\n", border, line);
}

/* Draws the markers of the specimen file below the picture, aligned at one marker that is seen. */
static void put_specimen(const struct view *view, const struct wb_specimen *specimen,
                         const struct wb_marker_places *places, char *text, size_t size)
{
    char line[COLUMNS + 1], missing[COLUMNS + 1];
    double begin = view->left + LEAST_MARGIN * view->scale;
    bool placed = false;
    memset(line, ' ', COLUMNS);
    memset(missing, ' ', COLUMNS);
    line[COLUMNS] = missing[COLUMNS] = '\0';
    for (int i = 0; i < view->n; i++) {
        for (int m = 0; m < specimen->n_markers && !placed; m++) {
            if (view->points[i].sign != sign_of(m))
                continue;
            begin = view->points[i].along - specimen->markers[m];
            placed = true;
        }
    }
    for (int m = 0; m < specimen->n_markers; m++) {
        const int k = column(view, begin + specimen->markers[m]);
        line[k] = sign_of(m);
        if (places->index[m] < 0)
            missing[k] = '?';
    }
    put(text, size, "| ", line);
    if (places->n_seen < specimen->n_markers)
        put(text, size, "| ", missing);
}

void wb_marker_picture(const struct wb_mocap_frame *frame, const struct wb_specimen *specimen,
                       char up, char *text, size_t size)
{
    struct view view = {.n = 0};
    struct wb_marker_places places = {0};
    text[0] = '\0';
    if (specimen)
        wb_marker_check_frame(frame, specimen, &places);
    collect(&view, frame, specimen, &places, up == 'z' ? 2 : 1);
    if (view.n == 0 && !specimen)
        return;
    choose_scale(&view, specimen ? specimen->length : 0.0);
    plot(&view);
    snprintf(text, size, "the cameras see, from the side (%c up, %.3g mm a column%s):\n", up,
             view.scale / WB_MM, specimen ? "; * other marker" : "");
    int first = 0, last = ROWS - 1;
    while (first < ROWS / 2 && is_blank(view.canvas[first]) && is_blank(view.canvas[first + 1]))
        first++;
    while (last > ROWS / 2 && is_blank(view.canvas[last]) && is_blank(view.canvas[last - 1]))
        last--;
    for (int row = first; row <= last; row++)
        put(text, size, "| ", view.canvas[row]);
    if (!specimen)
        return;
    char title[96];
    snprintf(title, sizeof title, "according to the specimen file%s:",
             places.n_seen < specimen->n_markers ? " (? not seen)" : "");
    put(text, size, "", title);
    put_specimen(&view, specimen, &places, text, size);
}
