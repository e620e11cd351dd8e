/* The first page of a report of bundles. */
#include <math.h>

#include "analysis/report/bundles/bundles_kind.h"
#include "analysis/report/found.h"
#include "analysis/report/pages.h"
#include "analysis/report/simulation_pages.h"
#include "base/units.h"

/* Smallest and largest of some values. */
struct span {
    double low, high;
    int n;
};

static void take(struct span *span, double value)
{
    if (!isfinite(value))
        return;
    span->low = span->n > 0 ? fmin(span->low, value) : value;
    span->high = span->n > 0 ? fmax(span->high, value) : value;
    span->n++;
}

/* "0.66 to 2.3", or "0.66" of one value. */
static void append_span(struct wb_text *text, const struct span *span)
{
    wb_text_append(text, "%.3g", span->low);
    if (span->high > span->low)
        wb_text_append(text, " to %.3g", span->high);
}

static void append_name(struct wb_text *names, const char *name)
{
    wb_text_append(names, names->length > 0 ? ", " : "");
    wb_text_append_escaped(names, name);
}

/* Names of bundles with their forces, as a result. */
static void add_names(struct wb_found *found, const char *lead, struct wb_text *names)
{
    struct wb_text text = {0};
    if (names->length > 0)
        wb_text_append(&text, "<b>%s</b>: %s.", lead, wb_text_string(names));
    wb_text_release(names);
    wb_found_add(found, WB_FOUND_RESULT, &text);
}

/* How the largest force of each bundle compares with that of its published curve. */
static void add_forces(struct wb_found *found, const struct wb_bundles_results *results)
{
    const struct wb_bundles *const campaign = results->campaign;
    struct wb_text above = {0}, below = {0}, alone = {0};
    for (int i = 0; i < campaign->n_bundles; i++) {
        const struct wb_bundles_result *const run = wb_bundles_results_dynamic(results, i);
        if (!run)
            continue;
        const bool has_published = run->published && run->published_max > 0.0;
        const double change = has_published ? run->curve.max_force / run->published_max - 1.0 : 0.0;
        struct wb_text *const names = !has_published ? &alone : change < 0.0 ? &below : &above;
        append_name(names, campaign->bundles[i].label);
        wb_text_append(names, " %.*f N", wb_pages_decimals(run->curve.max_force),
                       run->curve.max_force);
        if (has_published)
            wb_text_append(names, " (%.0f %%)", fabs(change) / WB_PERCENT);
    }
    add_names(found, "Largest force above that of the published curve", &above);
    add_names(found, "Largest force below that of the published curve", &below);
    add_names(found, "Largest force, without a published curve", &alone);
}

static void add_beams(struct wb_found *found, const struct wb_bundles_results *results)
{
    struct span rms = {.n = 0}, cost = {.n = 0};
    struct wb_text text = {0};
    for (int i = 0; i < results->campaign->n_bundles; i++) {
        const struct wb_bundles_fit *const fit = wb_bundles_results_fit(results, i);
        if (fit)
            take(&rms, fit->result.rms / WB_PERCENT);
        take(&cost, wb_bundles_results_cost(results, i) / WB_PERCENT);
    }
    if (rms.n == 0)
        return;
    wb_text_append(&text, "<b>1D beam</b>: a homogeneous beam fitted to each 3D curve follows it "
                          "with an RMS error of ");
    append_span(&text, &rms);
    wb_text_append(&text, " %% of the largest force");
    if (cost.n > 0) {
        wb_text_append(&text, ", for ");
        append_span(&text, &cost);
        wb_text_append(&text, " %% of the CPU time");
    }
    wb_text_append(&text, ".");
    wb_found_add(found, WB_FOUND_RESULT, &text);
}

/* The section model beside the explicit runs, separately where its tape comes off. */
static void add_sections(struct wb_found *found, const struct wb_bundles_results *results)
{
    struct span holds = {.n = 0}, loose = {.n = 0};
    struct wb_text text = {0};
    for (int i = 0; i < results->campaign->n_runs; i++) {
        const struct wb_bundles_section *const section = wb_bundles_results_section(results, i);
        if (section)
            take(isfinite(section->loosens) ? &loose : &holds, section->rms / WB_PERCENT);
    }
    if (holds.n + loose.n == 0)
        return;
    wb_text_append(&text, "<b>Section model</b>: RMS difference from the explicit curves ");
    if (holds.n > 0) {
        append_span(&text, &holds);
        wb_text_append(&text, " %% of the largest force in %d %s whose tape stays on the wires",
                       holds.n, wb_pages_plural(holds.n, "run", "runs"));
    }
    if (loose.n > 0) {
        wb_text_append(&text, "%s", holds.n > 0 ? "; " : "");
        append_span(&text, &loose);
        wb_text_append(&text,
                       " %% in %d %s whose tape comes off the wires, where the model is too "
                       "stiff",
                       loose.n, wb_pages_plural(loose.n, "run", "runs"));
    }
    wb_text_append(&text, ".");
    wb_found_add(found, WB_FOUND_RESULT, &text);
}

/* Runs whose strains are beyond the range of the elements' logarithm. */
static void add_strains(struct wb_found *found, const struct wb_bundles_results *results)
{
    struct span strains = {.n = 0};
    int n = 0;
    for (int i = 0; i < results->campaign->n_runs; i++) {
        const struct wb_bundles_result *const run = wb_bundles_results_usable(results, i);
        n += run != NULL;
        if (run && run->beyond)
            take(&strains, run->numbers.strain / WB_PERCENT);
    }
    if (strains.n == 0)
        return;
    struct wb_text text = {0};
    wb_text_append(&text,
                   "Largest strain of the elements: in %d of %d runs beyond the range in which the "
                   "elements' logarithm is accurate (",
                   strains.n, n);
    append_span(&text, &strains);
    wb_text_append(&text, " %%).");
    wb_found_add(found, WB_FOUND_FAILED, &text);
}

/* Runs that the campaign excludes from the limits of energies. */
static void add_unjudged(struct wb_found *found, const struct wb_bundles_results *results)
{
    const struct wb_bundles *const campaign = results->campaign;
    const bool has_limit = campaign->limits.kinetic > 0.0 || campaign->limits.artificial > 0.0 ||
                           campaign->limits.imbalance > 0.0;
    struct wb_text text = {0};
    for (int i = 0; i < campaign->n_runs && has_limit; i++) {
        const struct wb_bundles_run *const wanted = &campaign->runs[i];
        const struct wb_bundles_result *const run = wb_bundles_results_usable(results, i);
        if (!run || wanted->judged)
            continue;
        wb_text_append(&text, "%s",
                       text.length > 0 ? ", "
                                       : "Energies of runs that the campaign excludes "
                                         "from the limits (<tt>judged: false</tt>): ");
        wb_text_append_escaped(&text, wanted->name);
        wb_text_append(&text, " (kinetic energy %.3g %%)", run->numbers.kinetic / WB_PERCENT);
    }
    if (text.length > 0)
        wb_text_append(&text, ".");
    wb_found_add(found, WB_FOUND_UNCHECKED, &text);
}

/* Next steps: bundles whose force exceeds the limit, and a test. */
static void add_next(struct wb_found *found, const struct wb_verdict *verdicts, int n)
{
    struct wb_text text = {0};
    for (int i = 0; i < n; i++) {
        if (verdicts[i].kept || !verdicts[i].label || verdicts[i].key[0] != 'r')
            continue;
        append_name(&text, verdicts[i].label);
    }
    if (text.length > 0)
        wb_found_say(found, WB_FOUND_NEXT,
                     "<b>Force</b>: test %.600s before you use its force: simulation and published "
                     "curve differ by more than the limit.",
                     wb_text_string(&text));
    wb_text_release(&text);
    wb_found_say(found, WB_FOUND_NEXT,
                 "<b>Test</b>: bend one bundle of each kind that you need, and compare it with its "
                 "prediction in a campaign of <tt>kind: prediction</tt>; no number of this report "
                 "is from a test.");
}

void wb_bundles_found_put(struct wb_document *document, const struct wb_bundles_results *results)
{
    struct wb_found found = {0};
    struct wb_verdict verdicts[WB_BUNDLES_VERDICTS];
    const int n = wb_bundles_results_judge(results, verdicts);
    wb_found_say(&found, WB_FOUND_ORIGIN,
                 "<b>Simulations.</b> Everything in this report is computed: bundles of wires with "
                 "contact, friction and tape in explicit 3D, 1D beams fitted to them, and the "
                 "published curves, which are 1D beams with the published properties. No bundle "
                 "was tested, and no value has an interval.");
    wb_simulation_pages_add_missing(&found, &results->outcome);
    add_forces(&found, results);
    add_beams(&found, results);
    add_sections(&found, results);
    wb_found_add_verdicts(&found, verdicts, n);
    add_strains(&found, results);
    add_unjudged(&found, results);
    wb_found_say(&found, WB_FOUND_UNCHECKED, "Agreement with a tested bundle.");
    add_next(&found, verdicts, n);
    wb_found_put(&found, document);
}
