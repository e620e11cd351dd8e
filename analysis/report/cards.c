#include "analysis/report/cards.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/cards/card.h"
#include "analysis/report/pages.h"
#include "base/memory.h"

#define WB_LOG_DOMAIN "report"

enum {
    STEM = 72 /* bytes of a wire's name in file names */
};

static bool is_taken(const struct wb_cards *cards, const char *stem)
{
    for (int i = 0; i < cards->n_laws; i++) {
        if (strcmp(cards->laws[i].stem, stem) == 0)
            return true;
    }
    return false;
}

static void make_stem(const struct wb_cards *cards, const char *wire, char stem[STEM])
{
    char first[STEM - 8];
    snprintf(first, sizeof first, "%.60s", wire[0] ? wire : "wire");
    for (char *c = first; *c; c++) {
        if (!isalnum((unsigned char)*c) && !strchr("_-.", *c))
            *c = '-';
    }
    if (first[0] == '.')
        first[0] = '-';
    snprintf(stem, STEM, "%s", first);
    for (int i = 2; is_taken(cards, stem) && i < 1000; i++)
        snprintf(stem, STEM, "%s-%d", first, i);
}

/* The text becomes the list's. */
static void add_file(struct wb_cards *cards, const char *stem, const char *ending,
                     struct wb_text *text)
{
    cards->files =
        wb_memory_room(cards->files, &cards->capacity, (size_t)cards->n + 1, sizeof *cards->files);
    struct wb_cards_file *const file = &cards->files[cards->n++];
    snprintf(file->name, sizeof file->name, "cards/%s.%s", stem, ending);
    file->bytes = *text;
    *text = (struct wb_text){.length = 0};
}

static enum wb_status add_cards(struct wb_cards *cards, struct wb_cards_law *law,
                                const struct wb_card_source *source)
{
    struct wb_card_settings settings;
    wb_setting_fill(&wb_card_table, &settings);
    wb_text_append(&law->endings, ".yaml");
    for (int k = 0; k < WB_CARD_KINDS; k++) {
        const struct wb_card_kind *const kind = &wb_card_kinds[k];
        struct wb_text text = {0};
        struct wb_reason why = {.text = ""};
        const enum wb_status status = wb_card_write(kind, source, &settings, &text, &why);
        if (status == WB_OK)
            add_file(cards, law->stem, kind->ending, &text);
        wb_text_release(&text);
        if (status == WB_ERR_UNSUPPORTED) {
            wb_warn("no card %s: %s", kind->name, why.text);
            wb_text_append(&law->missing, "%s%s: %s", law->missing.length > 0 ? "; " : "",
                           kind->name, why.text);
        } else {
            WB_TRY(status);
            wb_text_append(&law->endings, ", .%s", kind->ending);
        }
    }
    return WB_OK;
}

static struct wb_cards_law *add_law(struct wb_cards *cards, const char *stem,
                                    const struct wb_card_source *source)
{
    cards->laws = wb_memory_resize(cards->laws, (size_t)cards->n_laws + 1, sizeof *cards->laws);
    struct wb_cards_law *const law = &cards->laws[cards->n_laws++];
    *law = (struct wb_cards_law){
        .curvature = wb_card_source_curvature(source),
        .has_way_back = wb_card_source_has_unloading(source),
    };
    snprintf(law->stem, sizeof law->stem, "%s", stem);
    return law;
}

enum wb_status wb_cards_add(struct wb_cards *cards, const char *wire, struct wb_text *properties)
{
    struct wb_card_source source;
    char stem[STEM], name[STEM + 8];
    struct wb_reason why = {.text = ""};
    make_stem(cards, wire, stem);
    snprintf(name, sizeof name, "%s.yaml", stem);
    if (wb_card_source_parse(&source, wb_text_string(properties), name, &why) != WB_OK) {
        wb_warn("no cards of %s: %s", wire, why.text);
        wb_text_release(properties);
        return WB_OK;
    }
    add_file(cards, stem, "yaml", properties);
    return add_cards(cards, add_law(cards, stem, &source), &source);
}

enum wb_status wb_cards_add_fit(struct wb_cards *cards, const struct wb_calibrate_result *result,
                                const struct wb_calibrate_settings *settings, const char *dataset,
                                const char *sha256)
{
    struct wb_properties_dataset of = {.is_recording = false};
    struct wb_text text = {0};
    snprintf(of.name, sizeof of.name, "%.95s", dataset);
    snprintf(of.sha256, sizeof of.sha256, "%s", sha256);
    wb_properties_format(&text, result, settings, &of, 1);
    return wb_cards_add(cards, result->info.wire, &text);
}

void wb_cards_release(struct wb_cards *cards)
{
    for (int i = 0; i < cards->n; i++)
        wb_text_release(&cards->files[i].bytes);
    for (int i = 0; i < cards->n_laws; i++) {
        wb_text_release(&cards->laws[i].endings);
        wb_text_release(&cards->laws[i].missing);
    }
    free(cards->files);
    free(cards->laws);
    *cards = (struct wb_cards){.n = 0};
}

void wb_cards_put_pages(struct wb_document *document, const struct wb_cards *cards)
{
    static const struct wb_document_column columns[] = {
        {.heading = "cards/"},
        {.heading = "Files", .wraps = true},
        {.heading = "Curvature up to (1/m)", .right = true},
        {.heading = "Valid for"},
    };
    if (cards->n_laws == 0)
        return;
    wb_document_heading(document, 1, "cards", "Cards for other programs");
    struct wb_document_table *const table =
        wb_document_table(document,
                          "Files in the folder <tt>cards</tt> of this report; <tt>wirebench "
                          "export</tt> makes them from the .yaml file. Beyond the curvature the "
                          "law is extrapolated. Valid for: as far as the data support.",
                          WB_COUNT(columns), columns);
    for (int i = 0; i < cards->n_laws; i++) {
        const struct wb_cards_law *const law = &cards->laws[i];
        wb_pages_row(table, false, law->stem);
        wb_pages_cell_plain(table, WB_TONE_PLAIN, wb_text_string(&law->endings));
        wb_pages_cell_rounded(table, law->curvature);
        wb_pages_cell_plain(table, WB_TONE_PLAIN,
                            law->has_way_back ? "loading, unloading" : "loading only");
    }
    for (int i = 0; i < cards->n_laws; i++) {
        if (cards->laws[i].missing.length > 0)
            wb_pages_item(document, WB_TONE_PLAIN, "<b>", cards->laws[i].stem, "</b>, no card for ",
                          wb_text_string(&cards->laws[i].missing));
    }
}
