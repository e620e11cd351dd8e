/* Reading the file of a report of a harness, and computing it. */
#include "analysis/report/harnesses/harnesses.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/config.h"
#include "base/interrupt.h"
#include "base/memory.h"
#include "base/vec3.h"

#define WB_LOG_DOMAIN "report"

enum wb_status wb_harnesses_keys(void *context, const struct wb_config_node *root)
{
    struct wb_harnesses *const campaign = context;
    char name[256], path[WB_PATH];
    const struct wb_config_key keys[] = {
        WB_CAMPAIGN_KEYS(&campaign->head),
        WB_CONFIG_TEXT("harness", name),
        WB_CONFIG_OPTIONAL_INTEGER("runs", &campaign->runs, WB_HARNESS_BANDS_LEAST_RUNS, 100000),
        WB_CONFIG_OPTIONAL_INTEGER("seed", &campaign->seed, 0, 1000000000),
    };
    campaign->seed = 1;
    WB_TRY(wb_config_map(root, keys, WB_COUNT(keys)));
    WB_TRY(wb_campaign_find(&campaign->head, root, "harness", "harnesses", name, path,
                            campaign->file));
    campaign->plan = wb_memory_new(1, sizeof *campaign->plan);
    WB_TRY(wb_harness_file_read(campaign->plan, path));
    return campaign->runs > 0 ? wb_harness_bands_check(campaign->plan, campaign->runs) : WB_OK;
}

void wb_harnesses_release(void *context)
{
    struct wb_harnesses *const campaign = context;
    if (!campaign)
        return;
    free(campaign->plan);
    memset(campaign, 0, sizeof *campaign);
}

/* --- results --- */

enum wb_status wb_harnesses_load(void *context, const void *of)
{
    struct wb_harnesses_results *const results = context;
    const struct wb_harnesses *const campaign = of;
    results->campaign = campaign;
    results->outcome.campaign = &campaign->head;
    results->outcome.n_wanted = results->outcome.n_usable = 1;
    results->outcome.n_steps = campaign->runs > 0 ? 3 : 2;
    return WB_OK;
}

/* --- round-off --- */

/* Values below these parts of the largest ones are round-off of the solver; another build has
 * others. They become 0, so that reports of different builds agree. */
static const double round_off = 1e-9;
static const double least_curvature = 1e-7; /* 1/m */
static const double least_distance = 1e-8;  /* m */

static void chop(double *value, double least)
{
    if (fabs(*value) < least)
        *value = 0.0;
}

static void chop_force(struct wb_harness_force *f, double force, double moment)
{
    for (int k = 0; k < 3; k++) {
        chop(&f->force[k], force);
        chop(&f->moment[k], moment);
    }
    chop(&f->size, force);
    chop(&f->largest, force);
    chop(&f->soft_force, force);
    chop(&f->moment_size, moment);
    chop(&f->largest_moment, moment);
}

static void chop_branch(struct wb_harness_branch_result *branch)
{
    chop(&branch->largest_bending, least_curvature);
    chop(&branch->largest_bending_so_far, least_curvature);
    if (branch->least_radius * least_curvature > 1.0) {
        branch->least_radius = (double)INFINITY;
        branch->at = 0.0;
    }
}

static void drop_round_off(struct wb_harness_result_set *set)
{
    double force = 0.0, moment = 0.0, energy = 0.0;
    for (int i = 0; i < set->n_steps; i++) {
        energy = fmax(energy, fmax(set->results[i].elastic, set->results[i].plastic));
        for (int k = 0; k < wb_harness_file_n_holders(set->plan); k++) {
            force = fmax(force, set->results[i].forces[k].largest);
            moment = fmax(moment, set->results[i].forces[k].largest_moment);
        }
    }
    for (int i = 0; i < set->n_steps; i++) {
        chop(&set->results[i].elastic, round_off * energy);
        chop(&set->results[i].plastic, round_off * energy);
        for (int k = 0; k < wb_harness_file_n_holders(set->plan); k++)
            chop_force(&set->results[i].forces[k], round_off * force, round_off * moment);
        for (int k = 0; k < set->plan->n_branches; k++)
            chop_branch(&set->results[i].branches[k]);
        for (int k = 0; k < set->n_places; k++) {
            struct wb_harness_place *const place = &set->results[i].places[k];
            if (wb_vec3_distance(place->position, set->natural[k].position) < least_distance)
                memcpy(place->position, set->natural[k].position, sizeof place->position);
        }
    }
}

static void chop_band(struct wb_fit_band *band, double least)
{
    chop(&band->median, least);
    chop(&band->low, least);
    chop(&band->high, least);
}

/* As drop_round_off(), of the bands. */
static void drop_round_off_of_bands(struct wb_harness_bands *bands)
{
    const struct wb_harness_plan *const plan = bands->nominal->plan;
    double force = 0.0, moment = 0.0;
    for (int i = 0; i < bands->nominal->n_steps; i++) {
        for (int k = 0; k < plan->n_items; k++) {
            force = fmax(force, bands->steps[i].forces[k].largest_force.high);
            moment = fmax(moment, bands->steps[i].forces[k].largest_moment.high);
        }
    }
    for (int i = 0; i < bands->nominal->n_steps; i++) {
        for (int k = 0; k < plan->n_items; k++) {
            struct wb_harness_force_bands *const f = &bands->steps[i].forces[k];
            chop_band(&f->force, round_off * force);
            chop_band(&f->largest_force, round_off * force);
            chop_band(&f->moment, round_off * moment);
            chop_band(&f->largest_moment, round_off * moment);
        }
        for (int k = 0; k < plan->n_branches; k++) {
            struct wb_harness_shape_band *const shape = &bands->steps[i].branches[k];
            chop(&shape->median, least_distance);
            chop(&shape->distance, least_distance);
            if (shape->distance == 0.0)
                shape->at = 0.0;
        }
    }
    chop_band(&bands->residual, least_distance);
}

static bool go_on(void *context, int step, double fraction)
{
    (void)context, (void)step, (void)fraction;
    return !wb_interrupted();
}

/* None where the steps are not complete, or interrupted. */
static enum wb_status compute_bands(struct wb_harnesses_results *results, int n_threads)
{
    const struct wb_harness_bands_settings settings = {
        .runs = results->campaign->runs,
        .seed = (uint64_t)results->campaign->seed,
        .n_threads = n_threads,
        .stop = wb_interrupt_stops,
    };
    struct wb_harness_bands *bands;
    if (settings.runs == 0 || !results->set.converged)
        return WB_OK;
    WB_TRY(wb_harness_bands_create(&bands, &results->set, &settings));
    const enum wb_status status = wb_harness_bands_compute(bands, 0, settings.runs);
    if (status != WB_OK || bands->stopped) {
        wb_harness_bands_destroy(bands);
        return status;
    }
    wb_harness_bands_finish(bands);
    drop_round_off_of_bands(bands);
    results->bands = bands;
    return WB_OK;
}

enum wb_status wb_harnesses_compute(void *of, int n_threads, wb_kind_progress *progress,
                                    void *context)
{
    struct wb_harnesses_results *const results = of;
    const struct wb_harness_plan *const plan = results->campaign->plan;
    const struct wb_harness_settings yielding = {.torsion = 1.0};
    const struct wb_harness_settings elastic = {.is_elastic = true, .torsion = 1.0};
    WB_TRY(wb_harness_run_compute(&results->set, plan, &yielding, go_on, NULL));
    if (progress)
        progress(context, 1, "elastoplastic");
    WB_TRY(wb_harness_run_compute(&results->elastic, plan, &elastic, go_on, NULL));
    if (progress)
        progress(context, 2, "elastic");
    WB_TRY(compute_bands(results, n_threads));
    if (progress && results->campaign->runs > 0)
        progress(context, 3, "bands");
    drop_round_off(&results->set);
    drop_round_off(&results->elastic);
    wb_harness_found_collect(&results->found, &results->set);
    results->outcome.interrupted = wb_interrupted();
    results->outcome.is_complete = results->set.converged && results->elastic.converged;
    results->outcome.exceeds_limit = results->found.n_exceeded > 0;
    return WB_OK;
}

void wb_harnesses_release_results(void *context)
{
    struct wb_harnesses_results *const results = context;
    if (!results)
        return;
    wb_harness_bands_destroy(results->bands);
    wb_harness_run_release(&results->set);
    wb_harness_run_release(&results->elastic);
    memset(results, 0, sizeof *results);
}

double wb_harnesses_elastic_force(const struct wb_harnesses_results *results, int step, int item)
{
    const struct wb_harness_result_set *const set = &results->elastic;
    const bool is_computed = step < set->n_steps && set->results[step].end == WB_HARNESS_CONVERGED;
    return is_computed && set->results[step].forces[item].is_mounted
               ? set->results[step].forces[item].size
               : (double)NAN;
}

double wb_harnesses_elastic_largest(const struct wb_harnesses_results *results, int item)
{
    struct wb_harness_extreme force, moment;
    wb_harness_found_largest(&results->elastic, item, &force, &moment);
    return results->elastic.converged ? force.value : (double)NAN;
}
