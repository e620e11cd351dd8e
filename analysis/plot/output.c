/* Figures as SVG, PNG and PDF: the surfaces behind the functions of figure.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <cairo-pdf.h>
#include <cairo-svg.h>

#include "analysis/plot/canvas.h"
#include "analysis/plot/figure_private.h"
#include "base/file.h"
#include "base/memory.h"

#define WB_LOG_DOMAIN "figure"

/* Draws on a surface that writes somewhere else, and ends both. */
static enum wb_status draw_on(cairo_surface_t *surface, const struct wb_figure *figure)
{
    cairo_t *const cairo = cairo_create(surface);
    enum wb_status status = wb_canvas_draw_figure(cairo, figure, 0.0, 0.0);
    if (status == WB_OK) {
        cairo_show_page(cairo);
        status = wb_canvas_status(cairo_status(cairo), wb_figure_name(figure));
    }
    cairo_destroy(cairo);
    cairo_surface_finish(surface);
    if (status == WB_OK)
        status = wb_canvas_status(cairo_surface_status(surface), wb_figure_name(figure));
    cairo_surface_destroy(surface);
    return status;
}

/* The ids that Cairo gave, in the order of their first appearance. */
struct id_list {
    size_t n, capacity;
    struct {
        const char *start; /* into the text */
        size_t length;
    } * ids;
};

static size_t number_of_id(struct id_list *list, const char *start, size_t length)
{
    for (size_t i = 0; i < list->n; i++) {
        if (list->ids[i].length == length && memcmp(list->ids[i].start, start, length) == 0)
            return i;
    }
    list->ids = wb_memory_room(list->ids, &list->capacity, list->n + 1, sizeof *list->ids);
    list->ids[list->n].start = start;
    list->ids[list->n].length = length;
    return list->n++;
}

/* Cairo's ids (glyph0-1, surface12) repeat from figure to figure and count over the whole process.
 * Numbered anew behind the figure's name they are unique in a page and the same in every run. */
static void rename_ids(const struct wb_text *raw, const char *name, struct wb_text *svg)
{
    static const char *const openings[] = {" id=\"", "href=\"#", "url(#"};
    static const char closings[] = {'"', '"', ')'};
    struct id_list list = {0};
    const char *position = wb_text_string(raw);
    while (*position) {
        const char *next = NULL;
        char closing = 0;
        for (size_t i = 0; i < 3; i++) {
            const char *const found = strstr(position, openings[i]);
            if (found && (!next || found + strlen(openings[i]) < next)) {
                next = found + strlen(openings[i]);
                closing = closings[i];
            }
        }
        const char *const end = next ? strchr(next, closing) : NULL;
        if (!end) {
            wb_text_append_bytes(svg, position, strlen(position));
            break;
        }
        wb_text_append_bytes(svg, position, (size_t)(next - position));
        wb_text_append(svg, "%s-%zu", name, number_of_id(&list, next, (size_t)(end - next)));
        position = end;
    }
    free(list.ids);
}

/* The footer as an element of the file: Cairo draws texts as outlines, in which nobody finds where
 * the data come from. Tags of the markup go, its entities are XML's. */
static void append_description(struct wb_text *svg, const char *markup)
{
    wb_text_append(svg, "\n<desc>");
    for (bool within = false; *markup; markup++) {
        if (*markup == '<')
            within = true;
        else if (*markup == '>')
            within = false;
        else if (!within)
            wb_text_append_bytes(svg, markup, 1);
    }
    wb_text_append(svg, "</desc>");
}

/* Copies Cairo's file, with the description behind the opening tag. */
static void describe(const struct wb_figure *figure, const struct wb_text *raw, struct wb_text *svg)
{
    const char *const all = wb_text_string(raw), *const tag = strstr(all, "<svg");
    const char *const end = tag ? strchr(tag, '>') : NULL;
    const char *const rest = figure->footer && end ? end + 1 : all;
    wb_text_append_bytes(svg, all, (size_t)(rest - all));
    if (rest != all)
        append_description(svg, figure->footer);
    wb_text_append_bytes(svg, rest, strlen(rest));
}

enum wb_status wb_figure_svg(const struct wb_figure *figure, struct wb_text *svg)
{
    struct wb_text raw = {0}, described = {0};
    cairo_surface_t *const surface = cairo_svg_surface_create_for_stream(
        wb_canvas_append, &raw, wb_figure_width(figure), wb_figure_height(figure));
    const enum wb_status status = draw_on(surface, figure);
    if (status == WB_OK) {
        describe(figure, &raw, &described);
        rename_ids(&described, wb_figure_name(figure), svg);
    }
    wb_text_release(&described);
    wb_text_release(&raw);
    return status;
}

enum wb_status wb_figure_draw(const struct wb_figure *figure, double scale,
                              struct wb_figure_pixels *pixels)
{
    const int width = (int)ceil(scale * wb_figure_width(figure));
    const int height = (int)ceil(scale * wb_figure_height(figure));
    *pixels = (struct wb_figure_pixels){
        .surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height),
        .name = wb_figure_name(figure)};
    cairo_t *const cairo = cairo_create(pixels->surface);
    cairo_set_source_rgb(cairo, 1.0, 1.0, 1.0);
    cairo_paint(cairo);
    cairo_scale(cairo, scale, scale);
    const enum wb_status status = wb_canvas_draw_figure(cairo, figure, 0.0, 0.0);
    cairo_destroy(cairo);
    if (status != WB_OK)
        wb_figure_pixels_release(pixels);
    return status;
}

enum wb_status wb_figure_pixels_png(const struct wb_figure_pixels *pixels, struct wb_text *png)
{
    return wb_canvas_status(
        cairo_surface_write_to_png_stream(pixels->surface, wb_canvas_append, png), pixels->name);
}

void wb_figure_pixels_release(struct wb_figure_pixels *pixels)
{
    cairo_surface_destroy(pixels->surface);
    pixels->surface = NULL;
}

enum wb_status wb_figure_png(const struct wb_figure *figure, double scale, struct wb_text *png)
{
    struct wb_figure_pixels pixels;
    WB_TRY(wb_figure_draw(figure, scale, &pixels));
    const enum wb_status status = wb_figure_pixels_png(&pixels, png);
    wb_figure_pixels_release(&pixels);
    return status;
}

enum wb_status wb_figure_pdf(const struct wb_figure *figure, const char *date_utc,
                             struct wb_text *pdf)
{
    const char *const date = date_utc ? date_utc : "2000-01-01T00:00:00Z";
    cairo_surface_t *const surface = cairo_pdf_surface_create_for_stream(
        wb_canvas_append, pdf, wb_figure_width(figure), wb_figure_height(figure));
    /* Cairo would take the time of the run. */
    cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATE_DATE, date);
    cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_MOD_DATE, date);
    cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_TITLE, wb_figure_name(figure));
    return draw_on(surface, figure);
}

static enum wb_status write_text(enum wb_status status, struct wb_text *text, const char *path)
{
    if (status == WB_OK)
        status = wb_file_write_text(path, text);
    wb_text_release(text);
    return status;
}

enum wb_status wb_figure_write_svg(const struct wb_figure *figure, const char *path)
{
    struct wb_text text = {0};
    return write_text(wb_figure_svg(figure, &text), &text, path);
}

static bool ends_in(const char *path, const char *ending)
{
    const size_t n = strlen(path), n_ending = strlen(ending);
    return n > n_ending && strcmp(path + n - n_ending, ending) == 0;
}

bool wb_figure_is_file(const char *path)
{
    return ends_in(path, ".svg") || ends_in(path, ".png") || ends_in(path, ".pdf");
}

enum wb_status wb_figure_write_file(const struct wb_figure *figure, double scale, const char *path)
{
    struct wb_text text = {0};
    const enum wb_status status = ends_in(path, ".svg")   ? wb_figure_svg(figure, &text)
                                  : ends_in(path, ".pdf") ? wb_figure_pdf(figure, NULL, &text)
                                                          : wb_figure_png(figure, scale, &text);
    return write_text(status, &text, path);
}
