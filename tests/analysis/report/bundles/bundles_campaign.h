/* A campaign of bundles for tests, and its datasets. They are made up: forces of the published
 * beams times a factor, so that errors and fits are known. */
#ifndef WB_TESTS_ANALYSIS_REPORT_BUNDLES_BUNDLES_CAMPAIGN_H
#define WB_TESTS_ANALYSIS_REPORT_BUNDLES_BUNDLES_CAMPAIGN_H

#include "analysis/dataset/simulated.h"
#include "analysis/report/bundles/bundles_kind.h"
#include "tests/analysis/made_up_bundle.h"
#include "tests/analysis/report/report_folder.h"

static struct wb_bundles campaign;
static struct wb_bundles_results results;
static struct wb_bundles whole_campaign;
static struct wb_bundles_results whole_results;

static inline int set_up(void **state)
{
    keep_messages();
    return make_folder(state);
}

static inline int tear_down(void **state)
{
    wb_bundles_results_release(&whole_results);
    wb_bundles_release(&whole_campaign);
    return remove_folder(state);
}

static inline enum wb_status read_campaign(const char *text)
{
    return wb_kind_read(&wb_bundles_kind, &campaign, write_text("c.yaml", text));
}

#define HEAD                                                                                       \
    "kind: bundles\ntitle: Bundles <and> beams\nnotes: a note & more\nsimulations: sim\n"          \
    "defaults: {dead_force: true, weight: false}\n"

static const char whole[] =
    HEAD "runs:\n"
         "  - {name: seven, bundle: 7-type3}\n"
         "  - {name: seven-constant, bundle: 7-type3, friction: 0.4}\n"
         "  - name: stiff\n"
         "    bundle: 7-type3\n"
         "    label: stiff & slow\n"
         "    friction: {static: 0.5, kinetic: 0.2, decay_s_mm: 3}\n"
         "    cohesive_stiffness_N_mm3: 300\n"
         "    mesh: paper\n"
         "    mass_scaling: 9\n"
         "    selective_mass_scaling: 50\n"
         "    duration_s: 2.5\n"
         "  - {name: hung, bundle: 7-type3, dead_force: false, weight: true}\n"
         "  - {name: twelve, bundle: 12-type3}\n"
         "groups:\n"
         "  - label: Both\n"
         "    figures: {section: '17', force: '19', error: '20', shape: '21', energy: '22'}\n"
         "    bundles:\n"
         "      - {label: 7 wires, dynamic: seven, constant: seven-constant, rod: ./seven-1d}\n"
         "      - {label: 12 wires, dynamic: twelve, rod: twelve-1d}\n"
         "studies:\n"
         "  - {title: Friction <mu>, runs: [seven, seven-constant]}\n"
         "inset: 7 wires\n"
         "fit: {yield_point: 0.04}\n"
         "limits: {rms_max: 0.065, kinetic_max: 0.05, artificial_max: 0.05, imbalance_max: 0.01,\n"
         "         cost_max: 0.005}\n"
         "printed: {source: print, rms: [2.45e-2, 6.53e-2], cost: 0.005}\n";

/* --- datasets --- */

static inline void make_run(int index, double factor)
{
    const struct made_up_bundle bundle = {
        .model = campaign.runs[index].model,
        .factor = factor,
        .kinetic = 0.03,
        .imbalance = 0.002,
        .cpu = 50.0,
    };
    made_up_write(&bundle, campaign.runs[index].dataset.path);
}

static inline void make_rod(int index, double cpu)
{
    const struct wb_bundles_bundle *const bundle = &campaign.bundles[index];
    const struct wb_bundles_run *const run = &campaign.runs[bundle->dynamic];
    const struct wb_wire *const beam = wb_bundles_published(run);
    const struct wb_test_info info = {.length = run->model->length,
                                      .outer_diameter = beam->outer_diameter,
                                      .rest_level = (double)NAN};
    const struct wb_simulated_cantilever cantilever = {.law = &beam->law,
                                                       .outer_diameter = beam->outer_diameter,
                                                       .length = run->model->length,
                                                       .deflection = run->model->run.deflection,
                                                       .points = 53};
    const struct wb_simulated_origin origin = {.model = "cantilever",
                                               .source = beam->source,
                                               .law = &beam->law,
                                               .cpu = cpu,
                                               .cantilever = &cantilever};
    struct wb_loading_steps_row rows[2] = {{.cycle = 1}, {.cycle = 1}};
    rows[1].point.deflection = run->model->run.deflection;
    const struct wb_loading_steps loading = {.n_rows = 2, .rows = rows, .converged = true};
    struct wb_dataset dataset;
    wb_dataset_init(&dataset);
    wb_simulated_fill(&dataset, &info, &loading, NULL, &origin);
    assert_int_equal(wb_dataset_write(&dataset, bundle->rod.path, true), WB_OK);
    wb_dataset_release(&dataset);
}

static inline void compute(void)
{
    memset(&results, 0, sizeof results);
    assert_int_equal(wb_bundles_results_load(&results, &campaign), WB_OK);
    assert_int_equal(wb_bundles_results_compute(&results, 0, NULL, NULL), WB_OK);
}

static inline void release(void)
{
    wb_bundles_results_release(&results);
    wb_bundles_release(&campaign);
}

/* All datasets there; once for all tests that only look. */
static inline const struct wb_bundles_results *whole_report(void)
{
    if (whole_results.campaign)
        return &whole_results;
    assert_int_equal(read_campaign(whole), WB_OK);
    make_run(0, 1.0);
    make_run(1, 1.05);
    make_run(2, 1.2);
    make_run(4, 0.9);
    make_rod(0, 0.1);
    make_rod(1, 0.1);
    wb_bundles_release(&campaign);
    assert_int_equal(wb_kind_read(&wb_bundles_kind, &whole_campaign, in_folder("c.yaml")), WB_OK);
    assert_int_equal(wb_bundles_results_load(&whole_results, &whole_campaign), WB_OK);
    assert_int_equal(wb_bundles_results_compute(&whole_results, 0, NULL, NULL), WB_OK);
    return &whole_results;
}

#endif
