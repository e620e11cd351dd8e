/* Campaigns of bundles: reading, and what their datasets may be. */
#include "tests/analysis/report/bundles/bundles_campaign.h"

#include <stdlib.h>

static void a_campaign_names_runs_with_their_settings(void **state)
{
    (void)state;
    assert_int_equal(read_campaign(whole), WB_OK);
    assert_int_equal(campaign.n_runs, 5);
    assert_int_equal(campaign.n_bundles, 2);
    assert_int_equal(campaign.inset, 0);
    const struct wb_bundle_model *const seven = campaign.runs[0].model;
    assert_close(seven->interface.friction.mu_kinetic, 0.1, 1e-12);
    assert_close(seven->loads.strand_length, 0.0, 0.0);
    assert_false(seven->loads.weight);
    const struct wb_bundle_model *const constant = campaign.runs[1].model;
    assert_close(constant->interface.friction.mu_kinetic, 0.4, 1e-12);
    assert_close(constant->interface.friction.decay, 0.0, 0.0);
    const struct wb_bundle_model *const stiff = campaign.runs[2].model;
    assert_close(stiff->interface.normal_stiffness, 300e9, 1.0);
    assert_close(stiff->interface.shear_stiffness, 100e9, 1.0);
    assert_close(stiff->interface.friction.decay, 3e3, 1e-9);
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
        assert_close(model->interface.friction.mu_static, 0.4, 1e-12);
        assert_close(model->interface.friction.mu_kinetic, 0.1, 1e-12);
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
            m->interface.friction.mu_static = m->interface.friction.mu_kinetic = 0.3;
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_campaign_names_runs_with_their_settings),
        cmocka_unit_test(commands_make_the_datasets),
        cmocka_unit_test(the_shipped_campaign_can_be_read),
        cmocka_unit_test(a_campaign_that_makes_no_sense_is_refused_with_its_line),
        cmocka_unit_test(a_dataset_with_other_settings_is_outdated),
        cmocka_unit_test(a_dataset_of_a_changed_bundle_is_outdated),
        cmocka_unit_test(a_dataset_that_was_cut_short_is_outdated),
        cmocka_unit_test(something_else_in_a_datasets_place_is_left_alone),
        cmocka_unit_test(a_rod_with_other_properties_is_outdated),
        cmocka_unit_test(limits_that_are_exceeded_are_told),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
