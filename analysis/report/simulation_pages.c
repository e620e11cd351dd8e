#include "analysis/report/simulation_pages.h"

#include <stdio.h>

#include "analysis/report/pages.h"
#include "base/config.h"
#include "base/units.h"
#include "base/version.h"

void wb_simulation_pages_start(struct wb_document *document, const struct wb_kind_outcome *outcome)
{
    char subtitle[300];
    snprintf(subtitle, sizeof subtitle, "%d of %d simulations \xc2\xb7 wirebench %s, revision %s",
             outcome->n_usable, outcome->n_wanted, wb_version(), wb_version_revision());
    wb_pages_start(document, "Simulation report", outcome->campaign, subtitle,
                   "simulations, no tests", "");
}

static void put_missing_dataset(struct wb_document *document,
                                const struct wb_simulation_entry *entry)
{
    char name[600], problem[900];
    if (!entry->wanted->wanted || entry->result->state == WB_SIMULATION_USABLE)
        return;
    wb_pages_put(document, WB_BLOCK_ITEM, WB_TONE_WARNING, "<b>%s</b>: %s. To compute it:",
                 wb_pages_escape(name, sizeof name, entry->wanted->name),
                 wb_pages_escape(problem, sizeof problem, wb_text_string(&entry->result->problem)));
    wb_document_code(document, wb_text_string(&entry->wanted->command));
}

void wb_simulation_pages_add_missing(struct wb_found *found, const struct wb_kind_outcome *outcome)
{
    const int n = outcome->n_wanted - outcome->n_usable;
    if (outcome->is_complete)
        return;
    if (n == 0) {
        wb_found_say(found, WB_FOUND_INCOMPLETE,
                     "<b>Incomplete.</b> All datasets are there, but not every step could be "
                     "done.");
        return;
    }
    wb_found_say(found, WB_FOUND_INCOMPLETE,
                 "<b>Incomplete.</b> %d of %d datasets %s missing or cannot be used. The report "
                 "shows the results of the others.",
                 n, outcome->n_wanted, wb_pages_plural(n, "is", "are"));
    wb_found_say(found, WB_FOUND_NEXT,
                 "<b>Missing datasets</b>: <tt>wirebench report --solve</tt> makes them from this "
                 "campaign and then writes the report.");
}

void wb_simulation_pages_put_missing(struct wb_document *document,
                                     const struct wb_kind_outcome *outcome,
                                     wb_simulation_list *list, const void *results)
{
    struct wb_simulation_entry entry;
    if (outcome->n_wanted == outcome->n_usable)
        return;
    wb_document_heading(document, 2, "missing", "What is missing");
    for (int i = 0; list(results, i, &entry); i++)
        put_missing_dataset(document, &entry);
}

void wb_simulation_pages_put_decisions(struct wb_document *document,
                                       const struct wb_campaign *campaign,
                                       const struct wb_verdict *verdicts, int n)
{
    static const struct wb_document_column columns[] = {
        {.heading = "Value", .wraps = true},
        {.heading = "of"},
        {.heading = "Found (%)", .right = true},
        {.heading = "Limit (%)", .right = true},
        {.heading = "Decision"},
    };
    if (!campaign->laboratory.is_given || n == 0)
        return;
    wb_document_heading(document, 2, "decisions", "Decisions on the limits");
    struct wb_document_table *const table =
        wb_document_table(document,
                          "By simple acceptance. The uncertainty <i>U</i> of a computed number is "
                          "not evaluated.",
                          WB_COUNT(columns), columns);
    for (int i = 0; i < n; i++) {
        const struct wb_verdict *const v = &verdicts[i];
        wb_document_row(table, false);
        wb_document_cell(table, WB_TONE_PLAIN, v->what);
        wb_pages_cell_plain(table, WB_TONE_PLAIN, v->label ? v->label : "");
        wb_pages_cell_rounded(table, v->value / WB_PERCENT);
        wb_pages_cell_rounded(table, v->limit / WB_PERCENT);
        wb_pages_cell(table, v->kept ? WB_TONE_PLAIN : WB_TONE_WARNING,
                      v->kept ? "kept" : "exceeded");
    }
}

void wb_simulation_pages_put_datasets(struct wb_document *document, wb_simulation_list *list,
                                      const void *results)
{
    static const struct wb_document_column columns[] = {
        {.heading = "Dataset", .wraps = true},
        {"Revision"},
        {.heading = "SHA-256 of force_deflection.csv, first 16 digits", .monospace = true},
    };
    struct wb_simulation_entry entry;
    wb_document_heading(document, 2, "datasets", "Datasets");
    struct wb_document_table *const table =
        wb_document_table(document,
                          "Revision: of the program that computed the dataset. All 64 digits of a "
                          "checksum are in report.json.",
                          3, columns);
    for (int i = 0; list(results, i, &entry); i++) {
        if (!entry.wanted->wanted)
            continue;
        wb_pages_row(table, false, entry.wanted->name);
        if (entry.result->state == WB_SIMULATION_USABLE)
            wb_pages_cell_plain(table, WB_TONE_PLAIN, entry.result->revision);
        else
            wb_pages_cell(table, WB_TONE_WARNING, "not used");
        wb_pages_cell_checksum(table, entry.result->sha256);
    }
}
