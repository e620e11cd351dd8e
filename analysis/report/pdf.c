#include "analysis/report/pdf.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <cairo-pdf.h>

#include "analysis/plot/canvas.h"
#include "analysis/plot/typeset.h"
#include "base/file.h"

#define WB_LOG_DOMAIN "report"

/* A4 and its margins, pt. */
static const double page_width = 595.276, page_height = 841.89;
static const double margin_left = 54.0, margin_top = 62.0, margin_bottom = 58.0;

/* Size of the smallest text: tables, captions, heads and feet of pages, pt. */
static const double smallest = 8.0;

/* The pen walks through the document twice: dry to count the pages, then drawing. */
struct pen {
    const struct wb_document *document;
    cairo_surface_t *surface;
    cairo_t *cairo;
    bool dry;
    int page, n_pages;
    double y;       /* where the next block goes */
    bool page_used; /* something stands on this page */
    enum wb_status status;
    int outline[3]; /* the last bookmark of each level */
};

/* --- text --- */

static double text_height(struct pen *pen, const char *markup, const struct wb_typeset_style *style)
{
    return wb_typeset_measure(pen->cairo, markup, style).height;
}

/* The same for plain text. */
static double plain_height(struct pen *pen, const char *plain, const struct wb_typeset_style *style)
{
    struct wb_text escaped = {0};
    wb_text_append_escaped(&escaped, plain);
    const double height = text_height(pen, wb_text_string(&escaped), style);
    wb_text_release(&escaped);
    return height;
}

static void put_plain(struct pen *pen, double x, double y, const char *plain,
                      const struct wb_typeset_style *style)
{
    if (pen->dry)
        return;
    struct wb_text escaped = {0};
    wb_text_append_escaped(&escaped, plain);
    wb_typeset_draw(pen->cairo, x, y, wb_text_string(&escaped), style);
    wb_text_release(&escaped);
}

/* --- pages --- */

static struct wb_colour tone_colour(enum wb_document_tone tone)
{
    const struct wb_colour colours[] = {
        [WB_TONE_PLAIN] = wb_palette_ink(),       [WB_TONE_GOOD] = wb_palette_good(),
        [WB_TONE_WARNING] = wb_palette_warning(), [WB_TONE_ORIGIN] = wb_palette_wire(0),
        [WB_TONE_QUIET] = wb_palette_grey(),
    };
    return colours[tone];
}

/* A line over the width of the text. */
static void rule(struct pen *pen, double y, double width, struct wb_colour colour)
{
    if (pen->dry)
        return;
    cairo_set_line_width(pen->cairo, width);
    cairo_set_dash(pen->cairo, NULL, 0, 0.0);
    wb_typeset_set_colour(pen->cairo, colour);
    cairo_move_to(pen->cairo, margin_left, y);
    cairo_line_to(pen->cairo, margin_left + WB_PDF_WIDTH, y);
    cairo_stroke(pen->cairo);
}

static void draw_frame(struct pen *pen)
{
    const struct wb_typeset_style small = {.size = smallest, .colour = wb_palette_grey()};
    struct wb_typeset_style right = small;
    right.align = WB_ALIGN_RIGHT;
    const double right_edge = margin_left + WB_PDF_WIDTH;
    if (pen->page > 1) {
        put_plain(pen, margin_left, 34.0, pen->document->title, &small);
        put_plain(pen, right_edge, 34.0, pen->document->kind, &right);
        rule(pen, 47.0, 0.5, wb_palette_rule());
    }
    const double y = page_height - 40.0;
    rule(pen, y - 5.0, 0.5, wb_palette_rule());
    put_plain(pen, margin_left, y, pen->document->footer, &small);
    char number[160];
    snprintf(number, sizeof number, "%s%.100s%sPage %d of %d",
             pen->document->number ? "Report " : "",
             pen->document->number ? pen->document->number : "",
             pen->document->number ? " \xc2\xb7 " : "", pen->page, pen->n_pages);
    put_plain(pen, right_edge, y, number, &right);
}

static void begin_page(struct pen *pen)
{
    pen->page++;
    pen->y = margin_top;
    pen->page_used = false;
    if (!pen->dry)
        draw_frame(pen);
}

static void end_page(struct pen *pen)
{
    if (!pen->dry)
        cairo_show_page(pen->cairo);
}

static double room(const struct pen *pen)
{
    return page_height - margin_bottom - pen->y;
}

static void new_page(struct pen *pen)
{
    if (!pen->page_used)
        return;
    end_page(pen);
    begin_page(pen);
}

/* A chapter begins on a new page, unless that would leave more than half of this one empty. */
static void new_chapter(struct pen *pen)
{
    if (room(pen) < 0.5 * (page_height - margin_top - margin_bottom))
        new_page(pen);
}

/* Starts a new page unless the height fits on this one. */
static void need(struct pen *pen, double height)
{
    if (height > room(pen))
        new_page(pen);
}

static void put_text(struct pen *pen, double x, const char *markup,
                     const struct wb_typeset_style *style)
{
    if (!pen->dry)
        wb_typeset_draw(pen->cairo, x, pen->y, markup, style);
}

static void advance(struct pen *pen, double height)
{
    pen->y += height;
    pen->page_used = true;
}

static void put_title(struct pen *pen)
{
    const struct wb_typeset_style kicker = {
        .size = 9.0, .bold = true, .colour = wb_palette_wire(0)};
    const struct wb_typeset_style title = {
        .size = 21.0, .bold = true, .colour = wb_palette_ink(), .width = WB_PDF_WIDTH};
    const struct wb_typeset_style subtitle = {
        .size = 9.0, .colour = wb_palette_grey(), .width = WB_PDF_WIDTH};
    pen->y = margin_top - 16.0;
    char kind[80];
    size_t n = 0;
    for (; pen->document->kind[n] && n + 1 < sizeof kind; n++)
        kind[n] = (char)toupper((unsigned char)pen->document->kind[n]);
    kind[n] = '\0';
    put_plain(pen, margin_left, pen->y, kind, &kicker);
    pen->y += 15.0;
    put_plain(pen, margin_left, pen->y, pen->document->title, &title);
    pen->y += plain_height(pen, pen->document->title, &title) + 2.0;
    put_plain(pen, margin_left, pen->y, pen->document->subtitle, &subtitle);
    advance(pen, plain_height(pen, pen->document->subtitle, &subtitle) + 10.0);
}

static void bookmark(struct pen *pen, const struct wb_document_block *block)
{
    if (pen->dry)
        return;
    char place[64];
    snprintf(place, sizeof place, "page=%d pos=[0 %.1f]", pen->page, pen->y);
    const int parent = block->level == 1 ? CAIRO_PDF_OUTLINE_ROOT : pen->outline[1];
    pen->outline[block->level] = cairo_pdf_surface_add_outline(
        pen->surface, parent, block->text, place,
        block->level == 1 ? CAIRO_PDF_OUTLINE_FLAG_OPEN : (cairo_pdf_outline_flags_t)0);
}

/* A heading stays with the next block, of which `next` pt must fit as well. */
static void put_heading(struct pen *pen, const struct wb_document_block *block, double next)
{
    const bool is_section = block->level == 1;
    const struct wb_typeset_style style = {.size = is_section ? 15.0 : 10.5,
                                           .bold = true,
                                           .colour = wb_palette_ink(),
                                           .width = WB_PDF_WIDTH};
    const double height = plain_height(pen, block->text, &style);
    const double before = pen->page_used ? (is_section ? 14.0 : 9.0) : 0.0;
    need(pen, before + height + 6.0 + next);
    if (pen->page_used)
        pen->y += before;
    bookmark(pen, block);
    put_plain(pen, margin_left, pen->y, block->text, &style);
    advance(pen, height + (is_section ? 7.0 : 4.0));
}

static void put_paragraph(struct pen *pen, const struct wb_document_block *block)
{
    const struct wb_typeset_style style = {
        .size = 9.0, .colour = tone_colour(block->tone), .width = WB_PDF_WIDTH};
    const double height = text_height(pen, block->text, &style);
    need(pen, height);
    put_text(pen, margin_left, block->text, &style);
    advance(pen, height + 6.0);
}

static void put_item(struct pen *pen, const struct wb_document_block *block)
{
    const struct wb_typeset_style style = {
        .size = 8.6, .colour = tone_colour(block->tone), .width = WB_PDF_WIDTH - 12.0};
    struct wb_typeset_style bullet = style;
    bullet.width = 0.0;
    const double height = text_height(pen, block->text, &style);
    need(pen, height);
    put_text(pen, margin_left + 2.0, "\xe2\x80\xa2", &bullet);
    put_text(pen, margin_left + 12.0, block->text, &style);
    advance(pen, height + 2.5);
}

static void put_box(struct pen *pen, double height, struct wb_colour edge, double alpha)
{
    if (pen->dry)
        return;
    cairo_rectangle(pen->cairo, margin_left, pen->y, WB_PDF_WIDTH, height);
    wb_typeset_set_colour(pen->cairo, wb_palette_fade(edge, alpha));
    cairo_fill(pen->cairo);
    cairo_rectangle(pen->cairo, margin_left, pen->y, 2.6, height);
    wb_typeset_set_colour(pen->cairo, edge);
    cairo_fill(pen->cairo);
}

static void put_notice(struct pen *pen, const struct wb_document_block *block)
{
    const struct wb_typeset_style style = {
        .size = 9.0, .colour = wb_palette_ink(), .width = WB_PDF_WIDTH - 24.0};
    const double height = text_height(pen, block->text, &style) + 13.0;
    need(pen, height);
    put_box(pen, height, tone_colour(block->tone), 0.09);
    pen->y += 6.5;
    put_text(pen, margin_left + 13.0, block->text, &style);
    advance(pen, height - 6.5 + 8.0);
}

static void put_code(struct pen *pen, const struct wb_document_block *block)
{
    const struct wb_typeset_style style = {.size = smallest,
                                           .monospace = true,
                                           .colour = wb_palette_ink(),
                                           .width = WB_PDF_WIDTH - 24.0};
    const double height = plain_height(pen, block->text, &style) + 11.0;
    need(pen, height);
    put_box(pen, height, wb_palette_grey(), 0.08);
    put_plain(pen, margin_left + 13.0, pen->y + 5.5, block->text, &style);
    advance(pen, height + 7.0);
}

/* --- tables --- */

/* Whether a table or a group of rows is not split: up to this part of a page. */
static bool stays_whole(double height)
{
    return height <= 0.4 * (page_height - margin_top - margin_bottom);
}

static const double cell_gap = 10.0, cell_above = 2.6;

static struct wb_typeset_style cell_style(const struct wb_document_column *column, bool heading)
{
    return (struct wb_typeset_style){.size = smallest,
                                     .bold = heading,
                                     .monospace = column->monospace && !heading,
                                     .colour = heading ? wb_palette_grey() : wb_palette_ink(),
                                     .align = column->right ? WB_ALIGN_RIGHT : WB_ALIGN_LEFT};
}

/* The next word of markup without its tags, of which some could end in other words; returns where
 * the one after it begins. Lines break at spaces and after hyphens. */
static const char *next_word(const char *markup, char word[80])
{
    size_t n = 0;
    bool in_tag = false, ends = false;
    for (; *markup && !ends; markup++) {
        const bool is_tag = in_tag || *markup == '<';
        in_tag = is_tag && *markup != '>';
        ends = !is_tag && (*markup == ' ' || *markup == '-');
        if (!is_tag && *markup != ' ' && n + 1 < 80)
            word[n++] = *markup;
    }
    word[n] = '\0';
    return markup;
}

/* Width of the widest word: below it a text would break within a word. */
static double widest_word(struct pen *pen, const char *markup, const struct wb_typeset_style *style)
{
    double widest = 0.0;
    while (*markup) {
        char word[80];
        markup = next_word(markup, word);
        widest = fmax(widest, wb_typeset_measure(pen->cairo, word, style).width);
    }
    return widest;
}

/* Widths of a column: of its widest text, and the least at which no word is broken. */
static void measure_column(struct pen *pen, const struct wb_document_table *table, int column,
                           double *natural, double *least)
{
    const struct wb_document_column *const of = &table->columns[column];
    const struct wb_typeset_style heading = cell_style(of, true), style = cell_style(of, false);
    const double whole = wb_typeset_measure(pen->cairo, of->heading, &heading).width;
    /* A heading that wraps takes two lines where there is room. */
    *least = of->wraps ? widest_word(pen, of->heading, &heading) : whole;
    *natural = of->wraps ? fmax(*least, 0.6 * whole) : whole;
    for (int row = 0; row < table->n_rows; row++) {
        const char *const text = table->cells[row * table->n_columns + column].text;
        const double width = wb_typeset_measure(pen->cairo, text, &style).width;
        *natural = fmax(*natural, width);
        /* Numbers stay in one line, with their brackets. */
        const bool breaks = of->wraps && !of->right;
        *least = fmax(*least, breaks ? widest_word(pen, text, &style) : width);
    }
    /* Room for rounding, or Pango breaks a text that just fits. */
    *natural += 1.0;
    *least += 1.0;
}

/* Columns get the width of their texts. Where the sum is too wide, columns that wrap shrink down to
 * their longest word, and below it only where that is not enough. */
static void find_widths(struct pen *pen, const struct wb_document_table *table, double *widths)
{
    double least[WB_DOCUMENT_COLUMNS], sum = 0.0, sum_of_least = 0.0, wrapped = 0.0;
    const double width = WB_PDF_WIDTH - (table->n_columns - 1) * cell_gap;
    for (int i = 0; i < table->n_columns; i++) {
        measure_column(pen, table, i, &widths[i], &least[i]);
        sum += widths[i];
        sum_of_least += least[i];
        wrapped += table->columns[i].wraps ? least[i] : 0.0;
    }
    for (int i = 0; i < table->n_columns; i++) {
        if (sum <= width)
            widths[i] += (width - sum) / table->n_columns;
        else if (sum_of_least <= width)
            widths[i] =
                least[i] + (widths[i] - least[i]) * (width - sum_of_least) / (sum - sum_of_least);
        else if (!(wrapped > 0.0))
            widths[i] = least[i] * width / sum_of_least;
        else if (table->columns[i].wraps)
            widths[i] = fmax(24.0, least[i] * (1.0 - (sum_of_least - width) / wrapped));
    }
}

/* A cell of a row, or of the headings (row < 0). */
struct placed {
    const char *text;
    struct wb_typeset_style style;
};

static struct placed place(const struct wb_document_table *table, int row, int column, double width)
{
    struct placed cell = {table->columns[column].heading,
                          cell_style(&table->columns[column], row < 0)};
    cell.style.width = width;
    cell.style.line_spacing = 1.08;
    if (row >= 0) {
        const struct wb_document_cell *const of = &table->cells[row * table->n_columns + column];
        cell.text = of->text;
        cell.style.colour = tone_colour(of->tone);
    }
    return cell;
}

static double row_height(struct pen *pen, const struct wb_document_table *table, int row,
                         const double *widths)
{
    double height = 0.0;
    for (int i = 0; i < table->n_columns; i++) {
        const struct placed cell = place(table, row, i, widths[i]);
        height = fmax(height, text_height(pen, cell.text, &cell.style));
    }
    return height + 2.0 * cell_above;
}

static void put_row(struct pen *pen, const struct wb_document_table *table, int row,
                    const double *widths)
{
    const double height = row_height(pen, table, row, widths);
    double x = margin_left;
    for (int i = 0; !pen->dry && i < table->n_columns; i++) {
        const struct placed cell = place(table, row, i, widths[i]);
        double y = pen->y + cell_above;
        /* Headings stand on the rule below them. */
        if (row < 0)
            y = pen->y + height - cell_above - text_height(pen, cell.text, &cell.style);
        wb_typeset_draw(pen->cairo, x, y, cell.text, &cell.style);
        x += widths[i] + cell_gap;
    }
    pen->y += height;
}

static bool has_headings(const struct wb_document_table *table)
{
    for (int i = 0; i < table->n_columns; i++) {
        if (table->columns[i].heading[0])
            return true;
    }
    return false;
}

static void put_table_head(struct pen *pen, const struct wb_document_table *table,
                           const double *widths)
{
    if (has_headings(table))
        put_row(pen, table, -1, widths);
    rule(pen, pen->y, 0.8, wb_palette_grey());
    advance(pen, 1.0);
}

static struct wb_typeset_style caption_style(double width)
{
    return (struct wb_typeset_style){.size = smallest, .colour = wb_palette_grey(), .width = width};
}

static double caption_height(struct pen *pen, const struct wb_document_table *table)
{
    const struct wb_typeset_style style = caption_style(WB_PDF_WIDTH);
    return table->caption ? text_height(pen, table->caption, &style) + 2.0 : 0.0;
}

/* The height that must fit on the page for a table to begin on it: all of it, or the head and two
 * rows of one that would take more than half a page or so. */
static double needed_height(struct pen *pen, const struct wb_document_table *table,
                            const double *widths)
{
    const double head = row_height(pen, table, -1, widths);
    double rows = 0.0;
    for (int row = 0; row < table->n_rows; row++)
        rows += row_height(pen, table, row, widths);
    const double whole = head + rows + caption_height(pen, table) + 5.0;
    return stays_whole(whole) ? whole : head + 2.0 * row_height(pen, table, 0, widths);
}

/* The height of a row, and where it begins a group that should not be split, of the whole group. */
static double height_from(struct pen *pen, const struct wb_document_table *table, int row,
                          const double *widths)
{
    const double one = row_height(pen, table, row, widths);
    double group = one;
    for (int k = row + 1; k < table->n_rows && !table->begins_group[k]; k++)
        group += row_height(pen, table, k, widths);
    return table->begins_group[row] && stays_whole(group) ? group : one;
}

static void put_table(struct pen *pen, const struct wb_document_table *table)
{
    double widths[WB_DOCUMENT_COLUMNS];
    find_widths(pen, table, widths);
    const struct wb_typeset_style caption = caption_style(WB_PDF_WIDTH);
    const double above = caption_height(pen, table);
    need(pen, needed_height(pen, table, widths));
    put_table_head(pen, table, widths);
    for (int row = 0; row < table->n_rows; row++) {
        if (height_from(pen, table, row, widths) > room(pen)) {
            new_page(pen);
            put_table_head(pen, table, widths);
        } else if (row > 0 && table->begins_group[row]) {
            rule(pen, pen->y, 0.5, wb_palette_rule());
        }
        put_row(pen, table, row, widths);
    }
    rule(pen, pen->y + 0.5, 0.8, wb_palette_grey());
    pen->y += 4.0;
    if (table->caption) {
        need(pen, above);
        put_text(pen, margin_left, table->caption, &caption);
        pen->y += above;
    }
    pen->y += 7.0;
}

/* --- figures --- */

static double figures_height(struct pen *pen, const struct wb_document_block *block)
{
    double height = 0.0;
    for (int i = 0; i < 2 && block->figures[i]; i++) {
        const struct wb_typeset_style style = caption_style(wb_figure_width(block->figures[i]));
        height = fmax(height, wb_figure_height(block->figures[i]) + 3.0 +
                                  text_height(pen, block->captions[i], &style));
    }
    return height;
}

static void put_figures(struct pen *pen, const struct wb_document_block *block)
{
    const double height = figures_height(pen, block);
    need(pen, height);
    const double top = pen->y;
    for (int i = 0; i < 2 && block->figures[i] && !pen->dry && pen->status == WB_OK; i++) {
        const double width = wb_figure_width(block->figures[i]);
        const struct wb_typeset_style style = caption_style(width);
        const double x = margin_left + (i == 1 ? WB_PDF_WIDTH - width : 0.0);
        pen->status = wb_canvas_draw_figure(pen->cairo, block->figures[i], x, top);
        pen->y = top + wb_figure_height(block->figures[i]) + 3.0;
        put_text(pen, x, block->captions[i], &style);
    }
    pen->y = top + height;
    advance(pen, 9.0);
}

/* --- all of it --- */

/* The least height of the block after a heading, which must stay with it. */
static double height_of_next(struct pen *pen, int index)
{
    if (index + 1 >= pen->document->n)
        return 0.0;
    const struct wb_document_block *const block = &pen->document->blocks[index + 1];
    if (block->kind == WB_BLOCK_FIGURES)
        return figures_height(pen, block);
    if (block->kind == WB_BLOCK_HEADING)
        return 30.0 + height_of_next(pen, index + 1);
    if (block->kind == WB_BLOCK_TABLE) {
        double widths[WB_DOCUMENT_COLUMNS];
        find_widths(pen, block->table, widths);
        return needed_height(pen, block->table, widths);
    }
    return 30.0;
}

static void walk(struct pen *pen)
{
    pen->page = 0;
    begin_page(pen);
    put_title(pen);
    for (int i = 0; i < pen->document->n && pen->status == WB_OK; i++) {
        const struct wb_document_block *const block = &pen->document->blocks[i];
        if (i > 0 && block[-1].kind == WB_BLOCK_ITEM && block->kind != WB_BLOCK_ITEM)
            pen->y += 4.0; /* below a list */
        switch (block->kind) {
        case WB_BLOCK_HEADING:
            put_heading(pen, block, height_of_next(pen, i));
            break;
        case WB_BLOCK_PARAGRAPH:
            put_paragraph(pen, block);
            break;
        case WB_BLOCK_NOTICE:
            put_notice(pen, block);
            break;
        case WB_BLOCK_ITEM:
            put_item(pen, block);
            break;
        case WB_BLOCK_CODE:
            put_code(pen, block);
            break;
        case WB_BLOCK_TABLE:
            put_table(pen, block->table);
            break;
        case WB_BLOCK_FIGURES:
            put_figures(pen, block);
            break;
        case WB_BLOCK_NEW_PAGE:
            new_chapter(pen);
            break;
        case WB_BLOCK_ROOM:
            need(pen, block->room);
            break;
        }
    }
    end_page(pen);
}

static void set_metadata(cairo_surface_t *surface, const struct wb_document *document)
{
    /* Cairo would take the time of the run: the same recordings must give the same bytes. */
    char date[32] = "2000-01-01T00:00:00Z";
    if (strlen(document->date_utc) >= 19)
        snprintf(date, sizeof date, "%.19sZ", document->date_utc);
    cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATE_DATE, date);
    cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_MOD_DATE, date);
    cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_TITLE, document->title);
    cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_SUBJECT, document->kind);
    cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATOR, document->footer);
}

enum wb_status wb_pdf_render(const struct wb_document *document, struct wb_text *pdf)
{
    cairo_surface_t *const surface =
        cairo_pdf_surface_create_for_stream(wb_canvas_append, pdf, page_width, page_height);
    set_metadata(surface, document);
    struct pen pen = {.document = document, .surface = surface, .cairo = cairo_create(surface)};
    pen.dry = true;
    walk(&pen);
    pen.n_pages = pen.page;
    pen.dry = false;
    walk(&pen);
    if (pen.status == WB_OK)
        pen.status = wb_canvas_status(cairo_status(pen.cairo), "the report");
    cairo_destroy(pen.cairo);
    cairo_surface_finish(surface);
    if (pen.status == WB_OK)
        pen.status = wb_canvas_status(cairo_surface_status(surface), "the report");
    cairo_surface_destroy(surface);
    return pen.status;
}

enum wb_status wb_pdf_write(const struct wb_document *document, const char *path)
{
    struct wb_text pdf = {0};
    enum wb_status status = wb_pdf_render(document, &pdf);
    if (status == WB_OK)
        status = wb_file_write_text(path, &pdf);
    wb_text_release(&pdf);
    return status;
}
