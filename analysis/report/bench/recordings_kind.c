#include "analysis/report/bench/recordings_kind.h"

#include <stdio.h>

#include "analysis/report/bench/recordings_figures.h"
#include "analysis/report/bench/recordings_json.h"
#include "analysis/report/bench/recordings_pages.h"

#define WB_LOG_DOMAIN "report"

static void print_rms(FILE *out, const char *what, enum wb_recordings_results_state state,
                      double rms, double limit)
{
    if (state == WB_RECORDINGS_NOT_WANTED)
        return;
    if (state != WB_RECORDINGS_DONE)
        fprintf(out, "  %s missing", what);
    else if (limit > 0.0 && !(rms <= limit))
        fprintf(out, "  %s RMS %.4f (limit %.4g exceeded)", what, rms, limit);
    else
        fprintf(out, "  %s RMS %.4f", what, rms);
}

static void print(FILE *out, const void *context)
{
    const struct wb_recordings_results *const results = context;
    const struct wb_recordings *const campaign = results->campaign;
    fprintf(out, "%s%s: %d of %d recordings used\n", campaign->head.title,
            results->any_virtual ? " (virtual rig)" : "", results->outcome.n_usable,
            results->outcome.n_wanted);
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_wire *const wire = &results->wires[i];
        fprintf(out, "%-10s", wire->wanted->label);
        print_rms(out, "calibration", wire->calibration_state, wire->calibration.rms,
                  campaign->calibration_limit);
        print_rms(out, "validation", wire->validation_state, wire->validation.elastoplastic.rms,
                  campaign->validation_limit);
        fprintf(out, "\n");
    }
}

/* --- the row --- */

static enum wb_status read(void *campaign, const char *path)
{
    return wb_recordings_read(campaign, path);
}

static enum wb_status load(void *results, const void *campaign)
{
    struct wb_recordings_results *const own = results;
    own->campaign = campaign;
    return WB_OK;
}

/* Recordings, and two steps of every wire. */
static int count_steps(const void *campaign)
{
    const struct wb_recordings *const own = campaign;
    int n_missing;
    return wb_recordings_count(own, &n_missing) + 2 * own->n_wires;
}

static enum wb_status compute(void *results, int n_threads, wb_kind_progress *progress,
                              void *context)
{
    const struct wb_recordings_results *const own = results;
    return wb_recordings_results_compute(results, own->campaign, n_threads, progress, context);
}

static void pages(struct wb_document *document, const void *results,
                  const struct wb_figures *figures)
{
    wb_recordings_pages_build(document, results, figures);
}

static struct wb_json *json(const void *results, const char *const *files, int n_files)
{
    return wb_recordings_json_build(results, files, n_files);
}

static void release(void *results)
{
    wb_recordings_results_release(results);
}

static void release_campaign(void *campaign)
{
    wb_recordings_release(campaign);
}

const struct wb_kind wb_recordings_kind = {
    .name = "recordings",
    .data = "recordings",
    .campaign_size = sizeof(struct wb_recordings),
    .results_size = sizeof(struct wb_recordings_results),
    .read = read,
    .load = load,
    .count_steps = count_steps,
    .compute = compute,
    .figures = wb_recordings_figures,
    .n_figures = WB_RECORDINGS_FIGURES,
    .pages = pages,
    .json = json,
    .print = print,
    .release = release,
    .release_campaign = release_campaign,
};
