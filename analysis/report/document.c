#include "analysis/report/document.h"

#include <assert.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"

static char *copy_text(const char *text)
{
    return wb_memory_text(text ? text : "");
}

void wb_document_init(struct wb_document *document, const char *kind, const char *title,
                      const char *subtitle, const char *footer, const char *date_utc)
{
    memset(document, 0, sizeof *document);
    document->kind = copy_text(kind);
    document->title = copy_text(title);
    document->subtitle = copy_text(subtitle);
    document->footer = copy_text(footer);
    document->date_utc = copy_text(date_utc);
}

static void destroy_table(struct wb_document_table *table)
{
    if (!table)
        return;
    for (int i = 0; i < table->n_columns; i++)
        free((char *)(uintptr_t)table->columns[i].heading);
    for (int i = 0; i < table->n_rows * table->n_columns; i++)
        free(table->cells[i].text);
    free(table->cells);
    free(table->begins_group);
    free(table->caption);
    free(table);
}

void wb_document_release(struct wb_document *document)
{
    for (int i = 0; i < document->n; i++) {
        struct wb_document_block *const block = &document->blocks[i];
        free(block->text);
        free(block->anchor);
        free(block->captions[0]);
        free(block->captions[1]);
        destroy_table(block->table);
    }
    free(document->blocks);
    free(document->kind);
    free(document->title);
    free(document->subtitle);
    free(document->footer);
    free(document->date_utc);
    free(document->number);
    memset(document, 0, sizeof *document);
}

void wb_document_set_number(struct wb_document *document, const char *number)
{
    free(document->number);
    document->number = copy_text(number);
}

void wb_document_move_to_front(struct wb_document *document, int first)
{
    for (int to = 0; first + to < document->n; to++) {
        const struct wb_document_block block = document->blocks[first + to];
        memmove(&document->blocks[to + 1], &document->blocks[to],
                (size_t)first * sizeof *document->blocks);
        document->blocks[to] = block;
    }
}

static struct wb_document_block *add_block(struct wb_document *document, enum wb_document_kind kind,
                                           const char *text)
{
    document->blocks = wb_memory_room(document->blocks, &document->capacity,
                                      (size_t)document->n + 1, sizeof *document->blocks);
    struct wb_document_block *const block = &document->blocks[document->n++];
    *block = (struct wb_document_block){.kind = kind, .text = copy_text(text)};
    return block;
}

void wb_document_heading(struct wb_document *document, int level, const char *anchor,
                         const char *text)
{
    struct wb_document_block *const block = add_block(document, WB_BLOCK_HEADING, text);
    block->level = level;
    block->anchor = copy_text(anchor);
}

void wb_document_text(struct wb_document *document, enum wb_document_kind kind,
                      enum wb_document_tone tone, const char *markup)
{
    add_block(document, kind, markup)->tone = tone;
}

void wb_document_paragraph(struct wb_document *document, const char *markup)
{
    wb_document_text(document, WB_BLOCK_PARAGRAPH, WB_TONE_PLAIN, markup);
}

void wb_document_notice(struct wb_document *document, enum wb_document_tone tone,
                        const char *markup)
{
    wb_document_text(document, WB_BLOCK_NOTICE, tone, markup);
}

void wb_document_item(struct wb_document *document, enum wb_document_tone tone, const char *markup)
{
    wb_document_text(document, WB_BLOCK_ITEM, tone, markup);
}

void wb_document_code(struct wb_document *document, const char *text)
{
    add_block(document, WB_BLOCK_CODE, text);
}

void wb_document_new_page(struct wb_document *document)
{
    add_block(document, WB_BLOCK_NEW_PAGE, NULL);
}

void wb_document_need_room(struct wb_document *document, double points)
{
    add_block(document, WB_BLOCK_ROOM, NULL)->room = points;
}

static char *number_caption(struct wb_document *document, const char *caption)
{
    struct wb_text text = {0};
    wb_text_append(&text, "<b>Figure %d.</b> %s", ++document->n_figures, caption);
    return text.bytes;
}

void wb_document_figures(struct wb_document *document, const struct wb_figure *first,
                         const char *first_caption, const struct wb_figure *second,
                         const char *second_caption)
{
    struct wb_document_block *const block = add_block(document, WB_BLOCK_FIGURES, NULL);
    block->figures[0] = first;
    block->captions[0] = number_caption(document, first_caption);
    block->figures[1] = second;
    if (second)
        block->captions[1] = number_caption(document, second_caption);
}

struct wb_document_table *wb_document_table(struct wb_document *document, const char *caption,
                                            int n_columns, const struct wb_document_column *columns)
{
    struct wb_document_table *const table = wb_memory_new(1, sizeof *table);
    add_block(document, WB_BLOCK_TABLE, NULL)->table = table;
    assert(n_columns <= WB_DOCUMENT_COLUMNS);
    table->n_columns = n_columns;
    table->caption = caption ? copy_text(caption) : NULL;
    for (int i = 0; i < table->n_columns; i++) {
        table->columns[i] = columns[i];
        table->columns[i].heading = copy_text(columns[i].heading);
    }
    return table;
}

void wb_document_row(struct wb_document_table *table, bool begins_group)
{
    if (table->n_rows == table->capacity) {
        table->capacity = 2 * table->capacity + 16;
        table->cells = wb_memory_resize(table->cells, (size_t)(table->capacity * table->n_columns),
                                        sizeof *table->cells);
        table->begins_group = wb_memory_resize(table->begins_group, (size_t)table->capacity,
                                               sizeof *table->begins_group);
    }
    for (int i = 0; i < table->n_columns; i++)
        table->cells[table->n_rows * table->n_columns + i] =
            (struct wb_document_cell){.text = copy_text(NULL)};
    table->begins_group[table->n_rows++] = begins_group;
    table->n_cells = 0;
}

void wb_document_cell(struct wb_document_table *table, enum wb_document_tone tone,
                      const char *markup)
{
    if (table->n_rows == 0 || table->n_cells == table->n_columns)
        return;
    struct wb_document_cell *const cell =
        &table->cells[(table->n_rows - 1) * table->n_columns + table->n_cells++];
    free(cell->text);
    cell->text = copy_text(markup);
    cell->tone = tone;
}
