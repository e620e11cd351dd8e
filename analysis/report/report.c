#include "analysis/report/report.h"

#include <stdio.h>
#include <stdlib.h>

#include "analysis/report/manifest.h"
#include "analysis/report/missing.h"
#include "analysis/report/openpgp.h"
#include "base/config.h"
#include "base/memory.h"
#include "base/progress.h"
#include "base/reads.h"

#define WB_LOG_DOMAIN "report"

/* --- one report in the making --- */

struct making {
    const struct wb_kind *kind;
    const struct wb_report_order *order;
    void *campaign, *results; /* owned */
    int n_read;               /* files, before the data were looked at */
    enum wb_report_end end;
};

static enum wb_status refuse_interrupted(struct making *making)
{
    wb_error("interrupted: no report is written");
    making->end = WB_REPORT_INTERRUPTED;
    return WB_OK;
}

/* Has the missing datasets made and reads them; *ends: that is all that was asked for. */
static enum wb_status make_missing(struct making *making, bool *ends)
{
    const struct wb_kind *const kind = making->kind;
    const struct wb_report_order *const order = making->order;
    const struct wb_kind_outcome *const known = making->results;
    struct wb_missing_outcome outcome = {.n = 0};
    if (kind->datasets)
        WB_TRY(
            wb_missing_make(&outcome, kind->datasets, making->results, order->folder, order->jobs));
    else if (known->n_missing > 0)
        wb_warn("%s cannot be computed: missing ones are left out", kind->data);
    *ends = order->jobs->dry_run || outcome.interrupted;
    if (outcome.interrupted)
        return refuse_interrupted(making);
    making->end = WB_REPORT_NOTHING;
    if (*ends && outcome.n == 0)
        wb_warn("there are no runs to list, and a dry run writes no report");
    if (*ends || !kind->datasets)
        return WB_OK;
    if (outcome.n > 0) {
        kind->release(making->results);
        wb_reads_forget(making->n_read);
        WB_TRY(kind->load(making->results, making->campaign));
    }
    wb_missing_remove_checkpoints(kind->datasets, making->results, order->folder);
    return WB_OK;
}

static void show_progress(void *context, int done, const char *what)
{
    wb_progress_update(context, done, what);
}

static enum wb_status compute(struct making *making)
{
    const struct wb_kind *const kind = making->kind;
    const struct wb_kind_outcome *const outcome = making->results;
    struct wb_progress progress;
    wb_progress_start(&progress, "report", "steps", outcome->n_steps);
    const enum wb_status status =
        kind->compute(making->results, making->order->n_threads, show_progress, &progress);
    wb_progress_finish(&progress);
    return status;
}

/* Checks that the report can be signed, before the computations take their time. */
static enum wb_status check_signing(const struct making *making)
{
    const struct wb_report_order *const order = making->order;
    const struct wb_campaign *const campaign = making->campaign;
    if (wb_manifest_is_signed(order->folder))
        return wb_fail(WB_ERR_EXISTS,
                       "'%s' holds a signed report, which stays: write into another folder; an "
                       "amendment has a number of its own and names what it replaces "
                       "(laboratory, amends)",
                       order->folder);
    if (!order->key)
        return WB_OK;
    if (!campaign->laboratory.is_given)
        return wb_fail(WB_ERR_ARGUMENT,
                       "'%s' has no 'laboratory' with the number of the report: nothing to sign",
                       order->campaign);
    return wb_openpgp_find_key(order->key);
}

/* A manifest without the signature that was asked for does not stay. */
static enum wb_status sign(const struct making *making)
{
    const struct wb_report_order *const order = making->order;
    char path[WB_PATH], signature[WB_PATH];
    if (!order->has_manifest && !order->key)
        return WB_OK;
    WB_TRY(wb_manifest_write(making->kind, making->results, order->folder));
    if (!order->key)
        return WB_OK;
    WB_TRY(wb_file_join(path, order->folder, wb_manifest_name));
    WB_TRY(wb_file_join(signature, order->folder, wb_manifest_signature_name));
    const enum wb_status status = wb_openpgp_sign(path, signature, order->key);
    if (status != WB_OK)
        remove(path);
    return status;
}

static enum wb_status deliver(struct making *making)
{
    const struct wb_report_order *const order = making->order;
    const struct wb_kind_outcome *const outcome = making->results;
    if (outcome->interrupted)
        return refuse_interrupted(making);
    WB_TRY(wb_kind_write(making->kind, making->results, order->folder, order->force,
                         order->n_threads));
    WB_TRY(sign(making));
    if (!order->quiet)
        making->kind->print(stdout, making->results);
    const int n_missing = wb_laboratory_missing(&outcome->campaign->laboratory);
    if (n_missing > 0)
        wb_warn(
            "%d fields of ISO/IEC 17025 are missing in 'laboratory' of the campaign; the report "
            "lists them",
            n_missing);
    making->end = !outcome->is_complete || n_missing > 0 ? WB_REPORT_INCOMPLETE
                  : outcome->exceeds_limit               ? WB_REPORT_LIMIT
                                                         : WB_REPORT_COMPLETE;
    return WB_OK;
}

/* Which datasets cannot be used, why, and how to make them. */
static enum wb_status list_datasets(struct making *making)
{
    const struct wb_kind *const kind = making->kind;
    int n_wanted, n_usable;
    if (!kind->datasets)
        return wb_fail(WB_ERR_UNSUPPORTED, "a report of %s has no datasets that become outdated",
                       kind->data);
    wb_simulation_count(kind->datasets, making->results, &n_wanted, &n_usable);
    making->end = n_usable < n_wanted ? WB_REPORT_INCOMPLETE : WB_REPORT_NOTHING;
    if (making->order->quiet) {
        wb_simulation_print_json(stdout, kind->datasets, making->results);
        return WB_OK;
    }
    printf("%d of %d datasets are missing, outdated or refused\n", n_wanted - n_usable, n_wanted);
    wb_simulation_print_missing(stdout, kind->datasets, making->results);
    return WB_OK;
}

static enum wb_status make(struct making *making)
{
    const struct wb_kind *const kind = making->kind;
    const struct wb_report_order *const order = making->order;
    bool ends = false;
    making->campaign = wb_memory_new(1, kind->campaign_size);
    making->results = wb_memory_new(1, kind->results_size);
    if (order->has_manifest || order->key)
        wb_reads_start();
    WB_TRY(wb_kind_read(kind, making->campaign, order->campaign));
    wb_reads_leave_out(order->campaign); /* it has a place of its own in the manifest */
    making->n_read = wb_reads_count();
    if (order->folder) {
        WB_TRY(check_signing(making));
        /* A folder that may not be written should not cost the time of the computations. */
        WB_TRY(wb_file_prepare_output(order->folder, order->force));
    } else {
        wb_log_set_threshold(WB_LOG_ERROR); /* the list says all that is warned of */
    }
    WB_TRY(kind->load(making->results, making->campaign));
    if (!order->folder)
        return list_datasets(making);
    if (wb_jobs_wanted(order->jobs))
        WB_TRY(make_missing(making, &ends));
    if (ends)
        return WB_OK;
    WB_TRY(compute(making));
    return deliver(making);
}

enum wb_status wb_report_make(enum wb_report_end *end, const struct wb_kind *const *kinds,
                              size_t n_kinds, const struct wb_report_order *order)
{
    const char *names[16] = {NULL};
    struct making making = {.order = order};
    int kind = 0;
    for (size_t i = 0; i < n_kinds && i < WB_COUNT(names); i++)
        names[i] = kinds[i]->name;
    WB_TRY(wb_campaign_read_kind(&kind, order->campaign, names, n_kinds));
    making.kind = kinds[kind];
    const enum wb_status status = make(&making);
    wb_reads_stop();
    making.kind->release(making.results);
    making.kind->release_campaign(making.campaign);
    free(making.results);
    free(making.campaign);
    if (status == WB_OK)
        *end = making.end;
    return status;
}
