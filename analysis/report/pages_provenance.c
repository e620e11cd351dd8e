/* Where everything comes from: recordings with checksums, revision, settings, the command. */
#include <stdio.h>
#include <string.h>

#include "analysis/report/pages_private.h"
#include "base/units.h"
#include "base/version.h"

static void put_test_rows(struct wb_document *document, struct wb_document_table *table,
                          const struct wb_results_tests *tests, bool begins_group)
{
    for (int i = 0; i < tests->n; i++) {
        const struct wb_results_test *const test = &tests->items[i];
        struct wb_pages_row row = {.n = 0};
        wb_pages_cell_plain(&row, WB_TONE_PLAIN, test->wanted->name);
        if (!test->usable) {
            wb_pages_cell(&row, WB_TONE_WARNING, "not used");
        } else {
            char start[40];
            snprintf(start, sizeof start, "%.19s", test->start_utc);
            char *const t = strchr(start, 'T');
            if (t)
                *t = ' ';
            wb_pages_cell_plain(&row, WB_TONE_PLAIN, start);
        }
        if (test->wanted->seed >= 0)
            wb_pages_cell(&row, WB_TONE_PLAIN, "%d", test->wanted->seed);
        else
            wb_pages_cell(&row, WB_TONE_QUIET, "\xe2\x80\x93");
        wb_pages_cell_plain(&row, WB_TONE_PLAIN,
                            test->sha256[0] ? test->sha256 : test->wanted->sha256);
        wb_pages_put_row(document, table, begins_group && i == 0, &row);
    }
}

/* The revisions that recorded, each once, in the order of the list. */
static void append_revisions(struct wb_text *caption, const struct wb_results *results)
{
    struct wb_text list = {0};
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_results_tests *const both[] = {&results->wires[i].calibration_tests,
                                                       &results->wires[i].validation_tests};
        for (int k = 0; k < 2; k++) {
            for (int j = 0; j < both[k]->n; j++) {
                char revision[400];
                wb_pages_escape(revision, sizeof revision, both[k]->items[j].tool_revision);
                if (!revision[0] || strstr(wb_text_string(&list), revision))
                    continue;
                wb_text_append(&list, "%s%s", list.length > 0 ? ", " : "", revision);
            }
        }
    }
    if (list.length > 0)
        wb_text_append(caption, " Recorded with revision %s.", wb_text_string(&list));
    caption->failed |= list.failed;
    wb_text_release(&list);
}

static void put_recordings(struct wb_document *document, const struct wb_results *results)
{
    static const struct wb_document_column columns[] = {
        {.heading = "Recording", .wraps = true},
        {.heading = "Start (UTC)"},
        {.heading = "Seed", .right = true},
        {.heading = "SHA-256", .monospace = true},
    };
    wb_document_heading(document, 2, "recordings", "Recordings");
    struct wb_text caption = {0};
    wb_text_append(&caption, "All checksums are those of the uncompressed recordings.%s",
                   results->any_virtual ? " Seed: of the virtual rig." : "");
    append_revisions(&caption, results);
    struct wb_document_table *const table =
        wb_document_table(document, wb_text_string(&caption), 4, columns);
    document->failed |= caption.failed;
    wb_text_release(&caption);
    for (int i = 0; i < results->n_wires; i++) {
        put_test_rows(document, table, &results->wires[i].calibration_tests, true);
        put_test_rows(document, table, &results->wires[i].validation_tests, true);
    }
}

static void put_setting(struct wb_document *document, struct wb_document_table *table,
                        const char *name, const char *value, const char *meaning)
{
    struct wb_pages_row row = {.n = 0};
    wb_pages_cell(&row, WB_TONE_PLAIN, "%s", name);
    wb_pages_cell_plain(&row, WB_TONE_PLAIN, value);
    wb_pages_cell(&row, WB_TONE_QUIET, "%s", meaning);
    wb_pages_put_row(document, table, false, &row);
}

static void put_settings(struct wb_document *document, const struct wb_results *results)
{
    static const struct wb_document_column columns[] = {
        {"Setting"}, {"Value"}, {.heading = "Meaning", .wraps = true}};
    const struct wb_campaign *const campaign = results->campaign;
    const struct wb_calibrate_settings *const s = &campaign->calibrate;
    char value[80];
    wb_document_heading(document, 2, "settings", "Settings");
    struct wb_document_table *const table = wb_document_table(document, NULL, 3, columns);
    snprintf(value, sizeof value, "%g", s->elastic_zone);
    put_setting(document, table, "Elastic zone", value,
                "deflection over length at which eq. 10 gives <i>E</i>");
    snprintf(value, sizeof value, "%g", s->yield_point > 0.0 ? s->yield_point : s->elastic_zone);
    put_setting(document, table, "Yield point", value,
                "deflection over length at which eq. 11 gives <i>\xcf\x83</i><sub>Y</sub>");
    snprintf(value, sizeof value, "%g mm", s->step / WB_MM);
    put_setting(document, table, "Step", value, "between the deflections that are compared");
    put_setting(document, table, "Initial shape", s->straight ? "straight" : "mean of the samples",
                "natural shape of the computed wire");
    put_setting(document, table, "Restart", s->restart ? "once" : "no",
                "of the search, from its optimum");
    snprintf(value, sizeof value, "%d", s->n_elements);
    put_setting(document, table, "Elements", value, "quadratic beam elements along the wire");
    snprintf(value, sizeof value, "%d", s->n_fibres);
    put_setting(document, table, "Fibres", value, "integration points over the diameter");
    snprintf(value, sizeof value, "%g of the size, %g of the error", s->size_tolerance,
             s->error_tolerance);
    put_setting(document, table, "Stops at", value,
                "size in units of <i>K</i><sub>0</sub> and <i>n</i><sub>0</sub>; error over "
                "<i>F</i><sub>max</sub>");
}

void wb_pages_put_origin(struct wb_document *document, const char *campaign, const char *sha256,
                         const char *notes, const char *same)
{
    char text[2600], name[600], escaped[2200], command[400];
    wb_document_new_page(document);
    wb_document_heading(document, 1, "provenance", "Provenance");
    snprintf(text, sizeof text,
             "Campaign <tt>%s</tt>, SHA-256 <tt>%s</tt>. Written by wirebench %s, revision "
             "<tt>%s</tt>. The same %s and the same revision give the same bytes:",
             wb_pages_escape(name, sizeof name, campaign), sha256, wb_version(),
             wb_version_revision(), same);
    wb_document_paragraph(document, text);
    snprintf(command, sizeof command, "wirebench report %s -o DIR", campaign);
    wb_document_code(document, command);
    if (notes[0])
        wb_document_paragraph(document, wb_pages_escape(escaped, sizeof escaped, notes));
}

void wb_pages_provenance(struct wb_document *document, const struct wb_results *results)
{
    const struct wb_campaign *const campaign = results->campaign;
    wb_pages_put_origin(document, campaign->name, campaign->sha256, campaign->notes, "recordings");
    put_settings(document, results);
    put_recordings(document, results);
}
