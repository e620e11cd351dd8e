#include "analysis/report/machines/machines_fits.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/interrupt.h"
#include "base/memory.h"

/* Whether a group is of the wire with which the fit begins. */
static bool is_of(const struct wb_machines *campaign, const struct wb_machines_fit *fit, int group)
{
    return strcmp(campaign->groups[fit->first].piece.wire, campaign->groups[group].piece.wire) == 0;
}

static bool goes_on(void *context, int done, int all)
{
    (void)context, (void)done, (void)all;
    return !wb_interrupted();
}

static void fit_wire(struct wb_machines_fit *fit, const struct wb_dataset *const *datasets,
                     int n_threads)
{
    struct wb_three_point_calibrate_settings settings = {.threads = n_threads, .progress = goes_on};
    wb_setting_fill(&wb_three_point_calibrate_tables[0], &settings.data);
    wb_setting_fill(&wb_three_point_calibrate_tables[1], &settings.fit);
    fit->is_fitted = wb_three_point_calibrate_run(&fit->calibration, datasets, fit->n, &settings,
                                                  &fit->why) == WB_OK;
    fit->is_validated =
        fit->is_fitted && wb_left_out_run(&fit->left_out, &fit->calibration,
                                          settings.fit.n_elements, &fit->why) == WB_OK;
}

static void compute_wire(struct wb_machines_fit *fit, const struct wb_machines *campaign,
                         const struct wb_machines_group_results *groups, int n_threads)
{
    int most = 0;
    for (int g = fit->first; g < campaign->n_groups; g++)
        most += campaign->groups[g].n_tests;
    const struct wb_dataset **const datasets = wb_memory_new((size_t)most, sizeof *datasets);
    for (int g = fit->first; g < campaign->n_groups; g++) {
        for (int i = 0; i < campaign->groups[g].n_tests && is_of(campaign, fit, g); i++) {
            if (groups[g].tests[i].is_usable)
                datasets[fit->n++] = &groups[g].tests[i].dataset;
        }
    }
    if (fit->n > 0)
        fit_wire(fit, datasets, n_threads);
    free(datasets);
}

static bool is_first_of_its_wire(const struct wb_machines *campaign, int group)
{
    for (int g = 0; g < group; g++) {
        if (strcmp(campaign->groups[g].piece.wire, campaign->groups[group].piece.wire) == 0)
            return false;
    }
    return true;
}

int wb_machines_fits_count_wires(const struct wb_machines *campaign)
{
    int n = 0;
    for (int g = 0; g < campaign->n_groups; g++)
        n += campaign->calibrates && is_first_of_its_wire(campaign, g);
    return n;
}

void wb_machines_fits_compute(struct wb_machines_fits *fits, const struct wb_machines *campaign,
                              const struct wb_machines_group_results *groups, int n_threads,
                              wb_kind_progress *progress, void *context)
{
    if (!campaign->calibrates)
        return;
    fits->fits = wb_memory_new((size_t)campaign->n_groups, sizeof *fits->fits);
    for (int g = 0; g < campaign->n_groups && !wb_interrupted(); g++) {
        if (!is_first_of_its_wire(campaign, g))
            continue;
        struct wb_machines_fit *const fit = &fits->fits[fits->n++];
        char what[100];
        fit->first = g;
        compute_wire(fit, campaign, groups, n_threads);
        snprintf(what, sizeof what, "calibrated %.64s", campaign->groups[g].piece.wire);
        if (progress)
            progress(context, campaign->n_groups + fits->n, what);
    }
}

bool wb_machines_fits_is_biased(const struct wb_machines_fit *fit)
{
    /* A smaller bias is hidden by the scatter of the tests. */
    return fit->is_validated && !(fit->left_out.bias <= 0.7 * fit->left_out.scatter);
}

int wb_machines_fits_count_unconverged(const struct wb_machines_fit *fit)
{
    int n = 0;
    for (int i = 0; fit->is_fitted && i < fit->calibration.n_members; i++) {
        const struct wb_three_point_member *const member = &fit->calibration.members[i];
        n += member->is_fitted && !member->fit.is_converged;
    }
    return n;
}

int wb_machines_fits_list(const struct wb_machines_fit *fit, const struct wb_machines *campaign,
                          const struct wb_machines_group_results *groups,
                          struct wb_properties_dataset *list)
{
    int n = 0;
    for (int g = fit->first; g < campaign->n_groups; g++) {
        for (int i = 0; i < campaign->groups[g].n_tests && is_of(campaign, fit, g); i++) {
            if (!groups[g].tests[i].is_usable || n == WB_PROPERTIES_MOST_DATASETS)
                continue;
            struct wb_properties_dataset *const entry = &list[n++];
            *entry = (struct wb_properties_dataset){.is_recording = true};
            snprintf(entry->name, sizeof entry->name, "%.95s",
                     wb_file_name(campaign->groups[g].tests[i]));
            snprintf(entry->sha256, sizeof entry->sha256, "%s", groups[g].tests[i].sha256);
        }
    }
    return n;
}

void wb_machines_fits_release(struct wb_machines_fits *fits)
{
    for (int i = 0; i < fits->n; i++)
        wb_three_point_calibrate_release(&fits->fits[i].calibration);
    free(fits->fits);
    memset(fits, 0, sizeof *fits);
}
