#include "analysis/report/found.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/report/pages.h"
#include "base/memory.h"
#include "base/units.h"

enum {
    SENTENCE = 1200 /* bytes that wb_found_say() takes */
};

void wb_found_add(struct wb_found *found, enum wb_found_part part, struct wb_text *sentence)
{
    if (sentence->length == 0)
        return;
    found->sentences =
        wb_memory_room(found->sentences, &found->capacity, found->n + 1, sizeof *found->sentences);
    found->sentences[found->n++] = (struct wb_found_sentence){part, *sentence};
    *sentence = (struct wb_text){0};
}

void wb_found_say(struct wb_found *found, enum wb_found_part part, const char *format, ...)
{
    struct wb_text text = {0};
    char sentence[SENTENCE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(sentence, sizeof sentence, format, arguments);
    va_end(arguments);
    wb_text_append(&text, "%s", sentence);
    wb_found_add(found, part, &text);
}

/* --- verdicts --- */

/* " 7 wires (13.2 %), 19 wires (13.2 %)": the values that keep a limit, or exceed it. */
static int append_values(struct wb_text *text, const struct wb_verdict *verdicts, int n,
                         const char *what, bool kept)
{
    int count = 0;
    for (int i = 0; i < n; i++) {
        const struct wb_verdict *const v = &verdicts[i];
        char value[40] = "not known";
        if (strcmp(v->what, what) != 0 || v->kept != kept)
            continue;
        if (isfinite(v->value))
            snprintf(value, sizeof value, "%.3g %%", v->value / WB_PERCENT);
        wb_text_append(text, count++ > 0 ? ", " : " ");
        if (v->label)
            wb_text_append_escaped(text, v->label);
        wb_text_append(text, v->label ? " (%s)" : "%s", value);
    }
    return count;
}

/* All verdicts on the same value of several things, in a sentence. */
static void add_verdicts_on(struct wb_found *found, const struct wb_verdict *verdicts, int n,
                            const struct wb_verdict *first, bool kept)
{
    struct wb_text text = {0}, values = {0};
    if (append_values(&values, verdicts, n, first->what, kept) > 0)
        wb_text_append(&text, "%s, limit %.3g %%:%s.", first->what, first->limit / WB_PERCENT,
                       wb_text_string(&values));
    wb_text_release(&values);
    wb_found_add(found, kept ? WB_FOUND_PASSED : WB_FOUND_FAILED, &text);
}

void wb_found_add_verdicts(struct wb_found *found, const struct wb_verdict *verdicts, int n)
{
    for (int i = 0; i < n; i++) {
        bool is_first = true;
        for (int k = 0; k < i && is_first; k++)
            is_first = strcmp(verdicts[k].what, verdicts[i].what) != 0;
        if (!is_first)
            continue;
        add_verdicts_on(found, verdicts, n, &verdicts[i], false);
        add_verdicts_on(found, verdicts, n, &verdicts[i], true);
    }
    if (n == 0)
        wb_found_say(found, WB_FOUND_UNCHECKED, "The campaign states no limits for these results.");
}

/* --- the page --- */

static bool has(const struct wb_found *found, enum wb_found_part part)
{
    for (size_t i = 0; i < found->n; i++) {
        if (found->sentences[i].part == part)
            return true;
    }
    return false;
}

/* How sentences of a part are written. */
struct form {
    enum wb_document_kind kind;
    enum wb_document_tone tone;
    const char *lead; /* markup before the sentence */
};

static const struct form forms[] = {
    [WB_FOUND_ORIGIN] = {WB_BLOCK_NOTICE, WB_TONE_ORIGIN, ""},
    [WB_FOUND_INCOMPLETE] = {WB_BLOCK_NOTICE, WB_TONE_WARNING, ""},
    [WB_FOUND_RESULT] = {WB_BLOCK_ITEM, WB_TONE_PLAIN, ""},
    [WB_FOUND_DOUBTFUL] = {WB_BLOCK_ITEM, WB_TONE_WARNING, ""},
    [WB_FOUND_NOTE] = {WB_BLOCK_PARAGRAPH, WB_TONE_PLAIN, ""},
    [WB_FOUND_FAILED] = {WB_BLOCK_ITEM, WB_TONE_WARNING, "<b>Failed.</b> "},
    [WB_FOUND_PASSED] = {WB_BLOCK_ITEM, WB_TONE_GOOD, "<b>Passed.</b> "},
    [WB_FOUND_UNCHECKED] = {WB_BLOCK_ITEM, WB_TONE_PLAIN, "<b>Not checked.</b> "},
    [WB_FOUND_NEXT] = {WB_BLOCK_ITEM, WB_TONE_PLAIN, ""},
};

/* The sentences of the parts from `first` to `last`, in the order in which they were added; nothing
 * is green where `is_good` is false. */
static void put_parts(const struct wb_found *found, struct wb_document *document,
                      enum wb_found_part first, enum wb_found_part last, bool is_good)
{
    for (size_t i = 0; i < found->n; i++) {
        const struct wb_found_sentence *const sentence = &found->sentences[i];
        const struct form *const form = &forms[sentence->part];
        const bool is_green = form->tone == WB_TONE_GOOD;
        struct wb_text text = {0};
        if (sentence->part < first || sentence->part > last)
            continue;
        wb_text_append(&text, "%s%s", form->lead, wb_text_string(&sentence->text));
        wb_pages_put_text(document, form->kind, is_green && !is_good ? WB_TONE_PLAIN : form->tone,
                          &text);
    }
}

void wb_found_put(struct wb_found *found, struct wb_document *document)
{
    const bool is_good = !has(found, WB_FOUND_FAILED) && !has(found, WB_FOUND_DOUBTFUL) &&
                         !has(found, WB_FOUND_INCOMPLETE);
    wb_document_heading(document, 1, "summary", "What was found");
    put_parts(found, document, WB_FOUND_ORIGIN, WB_FOUND_ORIGIN, is_good);
    put_parts(found, document, WB_FOUND_INCOMPLETE, WB_FOUND_INCOMPLETE, is_good);
    put_parts(found, document, WB_FOUND_RESULT, WB_FOUND_DOUBTFUL, is_good);
    put_parts(found, document, WB_FOUND_NOTE, WB_FOUND_NOTE, is_good);
    if (has(found, WB_FOUND_FAILED) || has(found, WB_FOUND_PASSED) ||
        has(found, WB_FOUND_UNCHECKED))
        wb_document_heading(document, 2, "trust", "Whether to trust it");
    for (enum wb_found_part part = WB_FOUND_FAILED; part <= WB_FOUND_UNCHECKED; part++)
        put_parts(found, document, part, part, is_good);
    if (has(found, WB_FOUND_NEXT))
        wb_document_heading(document, 2, "next", "What to do next");
    put_parts(found, document, WB_FOUND_NEXT, WB_FOUND_NEXT, is_good);
    for (size_t i = 0; i < found->n; i++)
        wb_text_release(&found->sentences[i].text);
    free(found->sentences);
    *found = (struct wb_found){0};
}
