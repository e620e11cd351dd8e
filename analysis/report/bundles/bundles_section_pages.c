/* The section model beside the explicit one: a table of the bundles' runs. */
#include <math.h>

#include "analysis/report/bundles/bundles_kind.h"
#include "analysis/report/pages.h"
#include "base/units.h"

static void put_row(struct wb_document_table *table, const struct wb_bundles_results *results,
                    int run)
{
    const struct wb_bundles_section *const section = wb_bundles_results_section(results, run);
    const struct wb_bundles_result *const explicit = wb_bundles_results_usable(results, run);
    const double none = (double)NAN;
    if (run < 0)
        return;
    wb_document_row(table, false);
    wb_pages_cell_plain(table, WB_TONE_PLAIN, results->campaign->runs[run].name);
    if (section)
        wb_pages_cell(table, WB_TONE_PLAIN, "%.3g%s", section->friction,
                      section->is_mean ? " (mean)" : "");
    else
        wb_pages_cell_number(table, none, 2);
    wb_pages_cell_number(table, explicit ? explicit->curve.max_force : none, 3);
    wb_pages_cell_number(table, section ? section->curve.max_force : none, 3);
    wb_pages_cell_number(table, section ? section->rms : none, 4);
    for (int i = 0; i < WB_SECTION_RUN_LENGTHS; i++)
        wb_pages_cell_number(table, section ? section->rigidity[i].rigidity / WB_NMM2 : none, 0);
    if (section && isfinite(section->loosens))
        wb_pages_cell(table, WB_TONE_WARNING, "%.3g mm", section->loosens / WB_MM);
    else
        wb_pages_cell_plain(table, WB_TONE_PLAIN, section ? "stays on" : "");
}

static void put_refused(struct wb_document *document, const struct wb_bundles_results *results,
                        int run)
{
    if (run >= 0 && results->sections[run].state == WB_SIMULATION_REFUSED)
        wb_pages_item(document, WB_TONE_PLAIN, "<b>", results->campaign->runs[run].name,
                      "</b>: ", wb_text_string(&results->sections[run].problem));
}

void wb_bundles_section_put(struct wb_document *document, const struct wb_bundles_results *results,
                            const struct wb_figures *figures)
{
    static const struct wb_document_column columns[] = {
        {"Run"},
        {.heading = "Friction used", .right = true, .wraps = true},
        {.heading = "<i>F</i><sub>max</sub>, explicit (N)", .right = true, .wraps = true},
        {.heading = "<i>F</i><sub>max</sub>, section (N)", .right = true, .wraps = true},
        {.heading = "RMS", .right = true},
        {.heading = "<i>EI</i> at <i>L</i>/2 (N\xc2\xa0mm\xc2\xb2)", .right = true, .wraps = true},
        {.heading = "<i>EI</i> at <i>L</i> (N\xc2\xa0mm\xc2\xb2)", .right = true, .wraps = true},
        {.heading = "<i>EI</i> at 2 <i>L</i> (N\xc2\xa0mm\xc2\xb2)", .right = true, .wraps = true},
        {.heading = "Tape comes off at", .right = true, .wraps = true},
    };
    const struct wb_bundles *const campaign = results->campaign;
    wb_document_heading(document, 1, "section-model", "Section model beside the explicit one");
    wb_document_paragraph(
        document,
        "The section model takes a tenth of a second. Its wires have the rotation of the section "
        "in common and slip along their axes; the tape transfers shear between them. It is "
        "computed for this report. It is valid as long as the tape stays on the wires.");
    for (int i = 0; i < campaign->n_groups; i++)
        wb_figures_put(figures, document, "section-model", i);
    struct wb_document_table *const table = wb_document_table(
        document,
        "RMS: difference from the explicit curve, over its largest force. Friction: the static "
        "model has no rate and uses the geometric mean of a friction that decays. <i>EI</i>: of "
        "the elastic bundle as a beam of this length <i>L</i> and these ends, "
        "<i>F L</i><sup>3</sup>/3<i>\xce\xb4</i>; a short one also deforms in shear. Where a tape "
        "on "
        "a circle comes off the wires, the section model is too stiff.",
        9, columns);
    for (int i = 0; i < campaign->n_bundles; i++) {
        put_row(table, results, campaign->bundles[i].dynamic);
        put_row(table, results, campaign->bundles[i].constant);
    }
    for (int i = 0; i < campaign->n_bundles; i++) {
        put_refused(document, results, campaign->bundles[i].dynamic);
        put_refused(document, results, campaign->bundles[i].constant);
    }
}
