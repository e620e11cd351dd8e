/* Campaigns of bundles: reading, what their datasets may be, what is computed from them, and the
 * report. The datasets are made up: forces of the published beams times a factor, so that errors
 * and fits are known. */
#include "tests/analysis/made_up_bundle.h"
#include "tests/analysis/report/report_folder.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "analysis/dataset/simulated.h"
#include "analysis/report/bundles/bundles_kind.h"
#include "base/json.h"

static struct wb_bundles campaign;
static struct wb_bundles_results results;
static struct wb_bundles whole_campaign;
static struct wb_bundles_results whole_results;

static int set_up(void **state)
{
    keep_messages();
    return make_folder(state);
}

static int tear_down(void **state)
{
    wb_bundles_results_release(&whole_results);
    wb_bundles_release(&whole_campaign);
    return remove_folder(state);
}

static enum wb_status read_campaign(const char *text)
{
    return wb_kind_read(&wb_bundles_kind, &campaign, write_text("c.yaml", text));
}

/* --- campaigns --- */

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

static void a_campaign_names_runs_with_their_settings(void **state)
{
    (void)state;
    assert_int_equal(read_campaign(whole), WB_OK);
    assert_int_equal(campaign.n_runs, 5);
    assert_int_equal(campaign.n_bundles, 2);
    assert_int_equal(campaign.inset, 0);
    const struct wb_bundle_model *const seven = campaign.runs[0].model;
    assert_close(seven->interface.friction_kinetic, 0.1, 1e-12);
    assert_close(seven->loads.strand_length, 0.0, 0.0);
    assert_false(seven->loads.weight);
    const struct wb_bundle_model *const constant = campaign.runs[1].model;
    assert_close(constant->interface.friction_kinetic, 0.4, 1e-12);
    assert_close(constant->interface.friction_decay, 0.0, 0.0);
    const struct wb_bundle_model *const stiff = campaign.runs[2].model;
    assert_close(stiff->interface.normal_stiffness, 300e9, 1.0);
    assert_close(stiff->interface.shear_stiffness, 100e9, 1.0);
    assert_close(stiff->interface.friction_decay, 3e3, 1e-9);
    assert_close(stiff->run.duration, 2.5, 1e-12);
    assert_string_equal(campaign.runs[2].mesh->name, "paper");
    assert_string_equal(campaign.runs[2].label, "stiff & slow");
    assert_string_equal(campaign.runs[0].label, "friction 0.4 to 0.1");
    assert_string_equal(campaign.runs[3].label, "friction 0.4 to 0.1, strand, weight");
    assert_close(campaign.runs[3].model->loads.strand_length, 0.76, 1e-12);
    assert_true(campaign.runs[3].model->loads.weight);
    assert_int_equal(campaign.bundles[0].constant, 1);
    assert_int_equal(campaign.bundles[1].constant, -1);
    assert_string_equal(campaign.bundles[0].rod.name, "seven-1d");
    wb_bundles_release(&campaign);
}

static void commands_make_the_datasets(void **state)
{
    (void)state;
    assert_int_equal(read_campaign(whole), WB_OK);
    assert_string_equal(wb_text_string(&campaign.runs[2].dataset.command),
                        "wirebench solve bundle fixtures/bundles/7-type3.yaml --dead-force "
                        "--no-weight --friction 0.5,0.2,3 --cohesive-stiffness 300 --mesh paper "
                        "--mass-scaling 9 --selective 50 --duration-s 2.5 -o sim/stiff");
    assert_string_equal(wb_text_string(&campaign.runs[3].dataset.command),
                        "wirebench solve bundle fixtures/bundles/7-type3.yaml -o sim/hung");
    assert_string_equal(wb_text_string(&campaign.bundles[1].rod.command),
                        "wirebench solve cantilever --wire bundle-12 --length-mm 114 "
                        "--deflection-mm 53 -o sim/twelve-1d");
    /* What is run names files that are there, and no output. */
    const struct wb_solve_settings *const settings = &campaign.runs[1].dataset.settings;
    char **const arguments = wb_solve_settings_command(settings);
    assert_non_null(arguments);
    assert_string_equal(arguments[0], "solve");
    assert_string_equal(arguments[1], "bundle");
    assert_true(wb_file_exists(arguments[2]));
    assert_string_equal(arguments[3], "--dead-force");
    assert_string_equal(arguments[5], "--friction");
    assert_string_equal(arguments[6], "0.4");
    assert_null(arguments[7]);
    free(arguments);
    assert_int_equal(settings->kind, WB_SOLVE_BUNDLE);
    assert_string_equal(settings->model, campaign.runs[1].model->path);
    assert_null(settings->output);
    wb_bundles_release(&campaign);
}

static void the_shipped_campaign_can_be_read(void **state)
{
    (void)state;
    char path[WB_PATH];
    assert_int_equal(wb_file_find_data(path, "fixtures/campaigns/bundles.yaml"), WB_OK);
    assert_int_equal(wb_kind_read(&wb_bundles_kind, &campaign, path), WB_OK);
    assert_string_equal(campaign.head.name, "fixtures/campaigns/bundles.yaml");
    /* Then those with the tape on a circle, and seven wires of the other type. */
    assert_int_equal(campaign.n_bundles, 11);
    for (int i = 0; i < campaign.n_bundles; i++) {
        const struct wb_bundles_bundle *const bundle = &campaign.bundles[i];
        const struct wb_bundle_model *const model = campaign.runs[bundle->dynamic].model;
        assert_close(model->interface.friction_static, 0.4, 1e-12);
        assert_close(model->interface.friction_kinetic, 0.1, 1e-12);
        assert_close(model->interface.normal_stiffness, 30e9, 1.0);
        assert_close(model->loads.strand_length, 0.0, 0.0);
        assert_false(model->loads.weight);
        assert_true(bundle->has_rod == (i < 5));
        assert_true((bundle->constant >= 0) == (i < 5 || i == 10));
        assert_true(model->tape.round == (i >= 5 && i < 10));
    }
    assert_close(campaign.limits.rms, 0.065, 1e-12);
    wb_bundles_release(&campaign);
}

#define RUN HEAD "runs: [{name: a, bundle: 7-type3}, {name: b, bundle: 12-type3}]\n"

static void a_campaign_that_makes_no_sense_is_refused_with_its_line(void **state)
{
    (void)state;
    static const struct refused_campaign wrong[] = {
        {HEAD "runs: [{name: a, bundle: none-such}]\ngroups: []\n",
         "c.yaml:6: bundle: no 'none-such'"},
        {HEAD "runs: [{name: a, bundle: 7-type3, mesh: none}]\ngroups: []\n", "c.yaml:6: "},
        {HEAD "runs: [{name: a, bundle: 7-type3}, {name: a, bundle: 7-type3}]\ngroups: []\n",
         "c.yaml:6: name: another run is called 'a'"},
        {HEAD "runs: [{name: a, bundle: 7-type3, friction: {static: 0.1, kinetic: 0.2, "
              "decay_s_mm: 2}}]\ngroups: []\n",
         "c.yaml:6: kinetic: 0.2 is more than the static one, 0.1"},
        {HEAD "runs: [{name: a, bundle: 7-type3, friction: -1}]\ngroups: []\n", "c.yaml:6: "},
        {RUN "groups: [{label: x, bundles: [{label: y, dynamic: none}]}]\n",
         "c.yaml:7: dynamic: there is no run 'none'"},
        {RUN "groups: [{label: x, bundles: [{label: y, dynamic: a, constant: b}]}]\n",
         "c.yaml:7: constant: 'b' is of another bundle than 'a'"},
        {RUN "groups: []\n", "c.yaml:7: groups: expected a list of 1 to 8"},
        {RUN "groups: [{label: x, bundles: [{label: y, dynamic: a}]}]\n"
             "studies: [{title: t, runs: [a, c]}]\n",
         "c.yaml:8: runs: there is no run 'c'"},
        {RUN "groups: [{label: x, bundles: [{label: y, dynamic: a}]}]\n"
             "studies: [{title: t, runs: [a, b], labels: [one]}]\n",
         "c.yaml:8: labels: expected a list of 2 labels"},
        {RUN "groups: [{label: x, bundles: [{label: y, dynamic: a}]}]\ninset: z\n",
         "c.yaml:8: inset: there is no bundle with the label 'z'"},
        {RUN "groups: [{label: x, bundles: [{label: y, dynamic: a}]}]\nspeed: 3\n", "c.yaml:8: "},
    };
    assert_refused(&wb_bundles_kind, &campaign, wrong, sizeof wrong / sizeof wrong[0]);
}

/* --- datasets --- */

static void make_run(int index, double factor)
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

static void make_rod(int index, double cpu)
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
    assert_int_equal(wb_dataset_init(&dataset), WB_OK);
    assert_int_equal(wb_simulated_fill(&dataset, &info, &loading, NULL, &origin), WB_OK);
    assert_int_equal(wb_dataset_write(&dataset, bundle->rod.path, true), WB_OK);
    wb_dataset_release(&dataset);
}

static void compute(void)
{
    memset(&results, 0, sizeof results);
    assert_int_equal(wb_bundles_results_load(&results, &campaign), WB_OK);
    assert_int_equal(wb_bundles_results_compute(&results, 0, NULL, NULL), WB_OK);
}

static void release(void)
{
    wb_bundles_results_release(&results);
    wb_bundles_release(&campaign);
}

/* All datasets there; once for all tests that only look. */
static const struct wb_bundles_results *whole_report(void)
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

static void errors_are_over_the_published_curves_largest_force(void **state)
{
    (void)state;
    const struct wb_bundles_results *const all = whole_report();
    const struct wb_bundles_result *const same = wb_bundles_results_usable(all, 0);
    const struct wb_bundles_result *const more = wb_bundles_results_usable(all, 1);
    const struct wb_bundles_result *const less = wb_bundles_results_usable(all, 4);
    assert_non_null(same);
    assert_non_null(more);
    assert_non_null(less);
    /* The published curve of seven wires by another program: 1.8011 N at 53 mm. */
    assert_close(same->published_max, 1.8011, 2e-3);
    assert_close(same->rms, 0.0, 1e-4);
    assert_close(more->max_error, 0.05, 1e-4);
    assert_close(more->curve.max_force, 1.05 * more->published_max, 1e-3);
    assert_close(less->max_error, 0.1, 1e-4);
    double squares = 0.0;
    for (int i = 0; i < more->curve.n; i++) {
        const double weight = i == 0 || i == more->curve.n - 1 ? 0.5 : 1.0;
        squares += weight * pow(0.05 * more->published[i] / more->published_max, 2.0);
    }
    assert_close_relative(more->rms, sqrt(squares / (more->curve.n - 1)), 2e-3);
}

static void published_properties_come_back_from_their_own_curve(void **state)
{
    (void)state;
    const struct wb_bundles_results *const all = whole_report();
    const struct wb_bundles_fit *const fit = wb_bundles_results_fit(all, 0);
    assert_non_null(fit);
    assert_true(fit->result.rms < 2e-3);
    assert_close_relative(fit->result.material.youngs_modulus, 1114e6, 0.03);
    assert_close_relative(fit->result.material.yield_stress, 2.7e6, 0.05);
    assert_close_relative(fit->rigidity,
                          wb_bundles_results_rigidity(fit->result.material.youngs_modulus, 4.6e-3),
                          1e-12);
    /* Nine tenths of the force, nine tenths of E I. */
    const struct wb_bundles_fit *const twelve = wb_bundles_results_fit(all, 1);
    assert_non_null(twelve);
    assert_close_relative(twelve->result.material.youngs_modulus, 0.9 * 1022e6, 0.03);
}

/* The made-up run 0 lies on the published curve: the model's distance from it, by hand. */
static void the_section_model_stands_beside_the_bundles_runs(void **state)
{
    (void)state;
    const struct wb_bundles_results *const all = whole_report();
    const struct wb_bundles_result *const run = wb_bundles_results_usable(all, 0);
    const struct wb_bundles_section *const section = wb_bundles_results_section(all, 0);
    struct wb_section_run computed;
    const struct wb_bundle_model *const model = whole_campaign.runs[0].model;
    assert_non_null(section);
    assert_int_equal(wb_section_run_init(&computed, model, 2), WB_OK);
    assert_int_equal(wb_section_run(&computed, model, NULL), WB_OK);
    const double end = computed.rows[computed.n_rows - 1].force;
    assert_close_relative(section->curve.force[section->curve.n - 1], end, 1e-3);
    assert_close_relative(section->rigidity[1].rigidity, computed.rigidity[1].rigidity, 1e-12);
    wb_section_run_release(&computed);
    assert_true(section->is_mean && isnan(section->loosens));
    double largest = 0.0;
    for (int i = 0; i < run->curve.n; i++)
        largest = fmax(largest, fabs(section->curve.force[i] - run->curve.force[i]));
    assert_close_relative(section->largest, largest / run->curve.max_force, 1e-9);
    assert_true(section->rms > 0.2 * section->largest && section->rms < section->largest);
    /* Only bundles' runs are computed; of one whose dataset is not there, too, but not compared. */
    assert_false(wb_bundles_results_section(all, 1)->is_mean);
    assert_null(wb_bundles_results_section(all, 2));
}

static void a_bundle_that_the_section_model_refuses_says_why(void **state)
{
    (void)state;
    struct wb_bundles_section section = {0};
    struct wb_bundles_run run = whole_campaign.runs[0];
    struct wb_bundle_model *const gaps = malloc(sizeof *gaps);
    assert_non_null(gaps);
    *gaps = *run.model;
    gaps->wire_gap = 0.05e-3;
    run.model = gaps;
    wb_bundles_section_compute(&section, &run, NULL, 0.5e-3);
    assert_int_equal(section.state, WB_SIMULATION_REFUSED);
    assert_memory_equal(wb_text_string(&section.problem), "gaps: wires_mm: 0.05 between", 28);
    wb_bundles_section_release(&section);
    free(gaps);
}

static void cost_is_that_which_the_datasets_store(void **state)
{
    (void)state;
    assert_close(wb_bundles_results_cost(whole_report(), 0), 0.1 / 50.0, 1e-12);
}

static void energies_are_read_row_by_row(void **state)
{
    (void)state;
    const struct wb_bundles_result *const run = wb_bundles_results_usable(whole_report(), 0);
    assert_non_null(run);
    assert_int_equal(run->n_energies, 54);
    const struct wb_bundles_energy *const last = &run->energies[53];
    assert_close(last->deflection, 53e-3, 1e-9);
    assert_close(last->time, 0.53, 1e-12);
    assert_close_relative(last->internal, 0.9 * last->external, 1e-9);
    assert_close_relative(last->friction, 0.1 * last->external, 1e-9);
    double work = 0.0;
    for (int i = 1; i < run->curve.n; i++)
        work += 0.5 * (run->curve.force[i] + run->curve.force[i - 1]) * run->curve.step;
    assert_close_relative(last->external, work, 2e-3);
}

static void a_missing_dataset_is_told_with_the_command_that_makes_it(void **state)
{
    (void)state;
    const struct wb_bundles_results *const all = whole_report();
    assert_int_equal(all->runs[3].simulation.state, WB_SIMULATION_MISSING);
    assert_true(wb_simulation_is_missing(&all->runs[3].simulation));
    assert_int_equal(all->outcome.n_wanted, 7);
    assert_int_equal(all->outcome.n_usable, 6);
    assert_false(all->outcome.is_complete);
}

static const char small[] =
    HEAD "runs: [{name: x, bundle: ./seven.yaml, friction: 0.4}]\n"
         "groups: [{label: g, bundles: [{label: l, dynamic: x, rod: x-1d}]}]\n%s";

static void read_small(const char *more, const char *bundle_more)
{
    char text[1000];
    copy_shipped("fixtures/bundles/7-type3.yaml", "seven.yaml", bundle_more);
    snprintf(text, sizeof text, small, more);
    assert_int_equal(read_campaign(text), WB_OK);
}

static void assert_problem(enum wb_simulation_state state, const char *problem)
{
    const struct wb_bundles_result *const run = &results.runs[0];
    assert_int_equal(run->simulation.state, state);
    if (!strstr(wb_text_string(&run->simulation.problem), problem))
        fail_msg("'%s' does not say '%s'", wb_text_string(&run->simulation.problem), problem);
    assert_null(strstr(wb_text_string(&run->simulation.problem), folder));
}

static void a_dataset_with_other_settings_is_outdated(void **state)
{
    (void)state;
    static const struct {
        const char *key, *value, *problem;
    } changes[] = {
        {"friction", "0.4", "friction.static is 0.3 in it, and 0.4 is wanted"},
        {"cohesion", "", "cohesive_stiffness_N_mm3 is 40 in it, and 30 is wanted"},
        {"strand", "", "strand_mm is 500 in it, and 0 is wanted"},
        {"scaling", "", "run.mass_scaling is 16 in it, and 25 is wanted"},
        {"mesh", "", "mesh.core_quads is 6 in it, and 2 is wanted"},
        {"duration", "", "run.duration_s is 0.7 in it, and 0 is wanted"},
    };
    for (int i = 0; i < (int)(sizeof changes / sizeof changes[0]); i++) {
        read_small("", "");
        struct wb_bundle_model *const m = campaign.runs[0].model;
        if (i == 0)
            m->interface.friction_static = m->interface.friction_kinetic = 0.3;
        else if (i == 1)
            m->interface.normal_stiffness = 40e9;
        else if (i == 2)
            m->loads.strand_length = 0.5;
        else if (i == 3)
            m->run.mass_scaling = 16.0;
        else if (i == 4)
            snprintf(m->run.mesh, sizeof m->run.mesh, "paper");
        else
            m->run.duration = 0.7;
        make_run(0, 1.0);
        wb_bundles_release(&campaign);
        read_small("", "");
        compute();
        assert_problem(WB_SIMULATION_STALE, changes[i].problem);
        assert_true(wb_simulation_is_missing(&results.runs[0].simulation));
        release();
    }
}

static void a_dataset_of_a_changed_bundle_is_outdated(void **state)
{
    (void)state;
    read_small("", "");
    make_run(0, 1.0);
    wb_bundles_release(&campaign);
    read_small("", "# another line\n");
    compute();
    assert_int_equal(results.runs[0].simulation.state, WB_SIMULATION_USABLE);
    release();
    read_small("", "ends: {tip: capped}\n");
    compute();
    assert_problem(WB_SIMULATION_STALE, "tip is 'free' in it, and 'capped' is wanted");
    assert_int_equal(results.fits[0].state, WB_SIMULATION_MISSING);
    release();
}

static void a_dataset_that_was_cut_short_is_outdated(void **state)
{
    (void)state;
    read_small("", "");
    const struct made_up_bundle half = {
        .model = campaign.runs[0].model, .factor = 1.0, .cpu = 1.0, .rows = 30};
    made_up_write(&half, campaign.runs[0].dataset.path);
    compute();
    assert_problem(WB_SIMULATION_STALE, "it did not come to its end: made up");
    release();
}

static void something_else_in_a_datasets_place_is_left_alone(void **state)
{
    (void)state;
    char text[300];
    read_small("", "");
    make_rod(0, 0.1);
    /* The beam's dataset stands where the bundle's should be. */
    snprintf(text, sizeof text, "rm -rf '%s' && cp -r '%s' '%s'", in_folder("sim/x"),
             in_folder("sim/x-1d"), in_folder("sim/x"));
    assert_int_equal(system(text), 0);
    compute();
    assert_problem(WB_SIMULATION_REFUSED, "not made by 'solve bundle'");
    assert_false(wb_simulation_is_missing(&results.runs[0].simulation));
    release();
    read_small("", "");
    make_run(0, 1.0);
    write_text("sim/x/surface.csv", "nonsense\n");
    compute();
    assert_problem(WB_SIMULATION_REFUSED, "sim/x/surface.csv:1: ");
    release();
    read_small("", "");
    make_run(0, 1.0);
    write_text("sim/x/energies.csv", "nonsense\n");
    compute();
    assert_problem(WB_SIMULATION_REFUSED, "sim/x/energies.csv:1: expected the columns");
    release();
    read_small("", "");
    make_run(0, 1.0);
    snprintf(text, sizeof text, "sed -i '3,$d' '%s'", in_folder("sim/x/energies.csv"));
    assert_int_equal(system(text), 0);
    compute();
    assert_problem(WB_SIMULATION_REFUSED, "sim/x/energies.csv:3: expected a row");
    release();
}

static void a_rod_with_other_properties_is_outdated(void **state)
{
    (void)state;
    read_small("", "");
    make_run(0, 1.0);
    struct wb_wire *const beam = &campaign.runs[0].model->published.beam;
    beam->material.yield_stress = 3e6;
    wb_law_init_ludwik(&beam->law, &beam->material);
    make_rod(0, 0.1);
    wb_bundles_release(&campaign);
    read_small("", "");
    compute();
    assert_int_equal(results.rods[0].simulation.state, WB_SIMULATION_STALE);
    assert_non_null(strstr(wb_text_string(&results.rods[0].simulation.problem),
                           "law.yield_stress_MPa is 3 in it, and 2.7 is wanted"));
    assert_true(isnan(wb_bundles_results_cost(&results, 0)));
    release();
}

static void limits_that_are_exceeded_are_told(void **state)
{
    (void)state;
    static const struct {
        struct wb_bundles_limits limits;
        const char *key;
        bool kept;
    } cases[] = {
        {{.rms = 0.02}, "rms_max", false},
        {{.rms = 0.06}, "rms_max", true},
        {{.kinetic = 0.02}, "kinetic_max", false},
        {{.kinetic = 0.04}, "kinetic_max", true},
        {{.imbalance = 1e-3}, "imbalance_max", false},
        {{.imbalance = 3e-3}, "imbalance_max", true},
        {{.artificial = 3e-3}, "artificial_max", false},
        {{.artificial = 5e-3}, "artificial_max", true},
        {{.cost = 1e-3}, "cost_max", false},
        {{.cost = 3e-3}, "cost_max", true},
    };
    read_small("fit: {elements: 10, fibres: 12}\nlimits: {rms_max: 0.02}\n", "");
    make_run(0, 1.06);
    make_rod(0, 0.1);
    compute();
    assert_true(results.outcome.is_complete);
    assert_true(results.outcome.exceeds_limit);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct wb_verdict verdicts[WB_BUNDLES_VERDICTS];
        campaign.limits = cases[i].limits;
        assert_int_equal(wb_bundles_results_judge(&results, verdicts), 1);
        assert_string_equal(verdicts[0].key, cases[i].key);
        assert_int_equal(verdicts[0].kept, cases[i].kept);
    }
    struct wb_verdict none[WB_BUNDLES_VERDICTS];
    campaign.limits = (struct wb_bundles_limits){.kinetic = 0.02};
    campaign.runs[0].judged = false;
    assert_int_equal(wb_bundles_results_judge(&results, none), 0);
    release();
}

/* --- the report --- */

static void write_report(void)
{
    if (!wb_file_exists(in_folder("report")))
        assert_int_equal(
            wb_kind_write(&wb_bundles_kind, whole_report(), in_folder("report"), false), WB_OK);
}

static void the_report_is_whole_and_says_that_it_shows_simulations(void **state)
{
    (void)state;
    static const char *const figures[] = {"forces-1", "errors-1",        "energies-1",
                                          "study-1",  "section-model-1", "fit"};
    write_report();
    assert_simulated_figures(figures, sizeof figures / sizeof figures[0]);
    assert_true(wb_file_exists(in_folder("report/figures/sections-1.svg")));
    assert_true(wb_file_exists(in_folder("report/figures/shape-1.svg")));
    assert_true(wb_file_exists(in_folder("report/figures/shape-2.svg")));
    static const char *const texts[] = {
        "<b>Simulations.</b>",
        "simulations, no tests",
        "Bundles &lt;and&gt; beams",
        "a note &amp; more",
        "Friction &lt;mu&gt;",
        "<b>Incomplete.</b> 1 of 7 datasets is missing",
        "wirebench solve bundle fixtures/bundles/7-type3.yaml -o sim/hung",
        "(the paper's Fig. 17)",
        "7 wires bent by 53 mm (the paper's Fig. 21)",
        "RMS from the published curve, over its largest force, 12 wires",
        "1114",
        "0.200",
        "Section model beside the explicit one",
        "0.2 (mean)",
    };
    assert_says_all("report/report.html", texts, sizeof texts / sizeof texts[0]);
    assert_clean_report();
}

static void report_json_has_what_the_pages_tell(void **state)
{
    (void)state;
    struct wb_json *root;
    double value;
    write_report();
    assert_int_equal(wb_json_read(&root, in_folder("report/report.json")), WB_OK);
    const struct wb_json *const bundle = wb_json_item(wb_json_get(root, "bundles"), 0);
    assert_true(wb_json_get_number(bundle, "cpu_of_rod_over_bundle", &value));
    assert_close(value, 0.002, 1e-12);
    assert_true(wb_json_get_number(wb_json_get(bundle, "published"), "EI_N_mm2", &value));
    assert_close(value, 24485.0, 1.0);
    const struct wb_json *const run = wb_json_item(wb_json_get(root, "runs"), 4);
    assert_true(wb_json_get_number(run, "rms", &value));
    assert_close(value, wb_bundles_results_usable(whole_report(), 4)->rms, 1e-15);
    assert_int_equal((int)wb_json_length(wb_json_get(run, "force_N")), 107);
    assert_true(wb_json_get_number(wb_json_get(run, "section_model"), "rms", &value));
    assert_close(value, wb_bundles_results_section(whole_report(), 4)->rms, 1e-15);
    assert_int_equal((int)wb_json_length(wb_json_get(root, "limits")), 7);
    assert_int_equal((int)wb_json_length(wb_json_get(root, "files")), 33);
    wb_json_destroy(root);
}

static void the_same_datasets_give_the_same_bytes(void **state)
{
    (void)state;
    write_report();
    assert_same_report(&wb_bundles_kind, whole_report());
}

static void a_report_without_datasets_says_how_to_make_them(void **state)
{
    (void)state;
    char text[sizeof whole];
    snprintf(text, sizeof text, "%s", whole);
    memcpy(strstr(text, "sim\n"), "xyz\n", 4);
    assert_int_equal(read_campaign(text), WB_OK);
    compute();
    assert_int_equal(results.outcome.n_usable, 1); /* the beam that is named by its path */
    assert_int_equal(wb_kind_write(&wb_bundles_kind, &results, in_folder("none"), true), WB_OK);
    release();
    assert_true(says("none/report.html", "6 of 7 datasets are missing"));
    assert_true(says("none/report.html", "-o xyz/twelve"));
    assert_true(wb_file_exists(in_folder("none/figures/sections-1.svg")));
    assert_false(wb_file_exists(in_folder("none/figures/fit.svg")));
    assert_false(says("none/report.html", ">nan") || says("none/report.html", " nan"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_campaign_names_runs_with_their_settings),
        cmocka_unit_test(commands_make_the_datasets),
        cmocka_unit_test(the_shipped_campaign_can_be_read),
        cmocka_unit_test(a_campaign_that_makes_no_sense_is_refused_with_its_line),
        cmocka_unit_test(errors_are_over_the_published_curves_largest_force),
        cmocka_unit_test(published_properties_come_back_from_their_own_curve),
        cmocka_unit_test(the_section_model_stands_beside_the_bundles_runs),
        cmocka_unit_test(a_bundle_that_the_section_model_refuses_says_why),
        cmocka_unit_test(cost_is_that_which_the_datasets_store),
        cmocka_unit_test(energies_are_read_row_by_row),
        cmocka_unit_test(a_missing_dataset_is_told_with_the_command_that_makes_it),
        cmocka_unit_test(a_dataset_with_other_settings_is_outdated),
        cmocka_unit_test(a_dataset_of_a_changed_bundle_is_outdated),
        cmocka_unit_test(a_dataset_that_was_cut_short_is_outdated),
        cmocka_unit_test(something_else_in_a_datasets_place_is_left_alone),
        cmocka_unit_test(a_rod_with_other_properties_is_outdated),
        cmocka_unit_test(limits_that_are_exceeded_are_told),
        cmocka_unit_test(the_report_is_whole_and_says_that_it_shows_simulations),
        cmocka_unit_test(report_json_has_what_the_pages_tell),
        cmocka_unit_test(the_same_datasets_give_the_same_bytes),
        cmocka_unit_test(a_report_without_datasets_says_how_to_make_them),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
