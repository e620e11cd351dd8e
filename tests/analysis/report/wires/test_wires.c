/* Comparison campaigns: reading, what their datasets may be, what is computed from them, and the
 * report. The datasets are made up of beam theory, so its numbers must come out. */
#include "tests/analysis/bent_wire.h"
#include "tests/analysis/report/report_folder.h"

#include <sys/stat.h>
#include <unistd.h>

#include "analysis/report/wires/wires_kind.h"
#include "base/json.h"

static struct wb_wires whole_comparison;
static struct wb_wires_results whole_results;

static int set_up(void **state)
{
    keep_messages();
    return make_folder(state);
}

static int tear_down(void **state)
{
    wb_wires_results_release(&whole_results);
    wb_wires_release(&whole_comparison);
    return remove_folder(state);
}

/* --- campaigns --- */

static const char whole[] = "kind: comparison\n"
                            "title: Solid <and> rod\n"
                            "notes: a note & more\n"
                            "simulations: .\n"
                            "elastic: {model: follower-8awg-elastic}\n"
                            "contact: {model: follower-8awg-elastic-contact}\n"
                            "elastoplastic: {model: follower-8awg, solid: plastic, rod: ./rod}\n"
                            "residual:\n"
                            "  - {model: residual-1-8awg}\n"
                            "  - {label: Two, model: residual-2-8awg}\n"
                            "fit: {elements: 10, fibres: 12}\n"
                            "limits: {tip_max: 0.003, stress_max: 0.01, cost_max: 0.02}\n"
                            "printed: {source: print, wire: 8awg, stress_MPa: 697, cost: 0.02}\n";

static struct wb_wires comparison;
static struct wb_wires_results results;

static enum wb_status read_campaign(const char *text)
{
    return wb_kind_read(&wb_wires_kind, &comparison, write_text("c.yaml", text));
}

static void a_campaign_names_models_and_their_datasets(void **state)
{
    (void)state;
    assert_int_equal(read_campaign(whole), WB_OK);
    assert_int_equal(comparison.n_cases, 5);
    assert_int_equal(comparison.n_residual, 2);
    const struct wb_wires_case *const elastic = &comparison.cases[WB_WIRES_ELASTIC];
    assert_string_equal(elastic->model_name, "fixtures/models/follower-8awg-elastic.yaml");
    assert_string_equal(elastic->datasets[0].name, "simulations/follower-8awg-elastic-3d");
    assert_string_equal(elastic->datasets[1].name, "simulations/follower-8awg-elastic-1d");
    assert_false(comparison.cases[WB_WIRES_CONTACT].datasets[1].wanted);
    const struct wb_wires_case *const plastic = &comparison.cases[WB_WIRES_ELASTOPLASTIC];
    assert_string_equal(plastic->datasets[0].name, "simulations/plastic");
    assert_string_equal(plastic->datasets[1].name, "rod");
    assert_string_equal(comparison.cases[WB_WIRES_RESIDUAL].label, "Residual 1");
    assert_string_equal(comparison.cases[WB_WIRES_RESIDUAL + 1].label, "Two");
    assert_close(comparison.section, 3.26e-3, 1e-12);
    assert_true(comparison.mixture);
    int n_wanted = 0;
    for (int i = 0; i < comparison.n_cases; i++)
        for (int k = 0; k < WB_WIRES_SOLVERS; k++)
            n_wanted += comparison.cases[i].datasets[k].wanted;
    assert_int_equal(n_wanted, 9);
    wb_wires_release(&comparison);
}

static void the_shipped_campaign_can_be_read(void **state)
{
    (void)state;
    char path[WB_PATH];
    assert_int_equal(wb_file_find_data(path, "fixtures/campaigns/section2.yaml"), WB_OK);
    assert_int_equal(wb_kind_read(&wb_wires_kind, &comparison, path), WB_OK);
    assert_string_equal(comparison.head.name, "fixtures/campaigns/section2.yaml");
    assert_int_equal(comparison.n_cases, 5);
    wb_wires_release(&comparison);
}

static void a_campaign_that_cannot_be_compared_is_refused_with_its_line(void **state)
{
    (void)state;
    static const struct refused_campaign wrong[] = {
        {"kind: comparison\ntitle: x\nelastic: {model: follower-8awg}\n"
         "elastoplastic: {model: follower-8awg}\n",
         "c.yaml:3: model: 'follower-8awg' is elastoplastic"},
        {"kind: comparison\ntitle: x\nelastic: {model: follower-8awg-elastic}\n"
         "elastoplastic: {model: follower-8awg-elastic}\n",
         "c.yaml:4: model: 'follower-8awg-elastic' is elastic"},
        {"kind: comparison\ntitle: x\nelastic: {model: follower-8awg-elastic-contact}\n"
         "elastoplastic: {model: follower-8awg}\n",
         "is not bonded"},
        {"kind: comparison\ntitle: x\nelastic: {model: follower-8awg-elastic}\n"
         "contact: {model: follower-8awg-elastic}\nelastoplastic: {model: follower-8awg}\n",
         "has no interface"},
        {"kind: comparison\ntitle: x\nelastic: {model: follower-8awg-elastic}\n"
         "elastoplastic: {model: residual-1-8awg}\n",
         "c.yaml:4: model: 'residual-1-8awg' is not loaded by a follower force alone"},
        {"kind: comparison\ntitle: x\nelastic: {model: solid-cylinder-type3}\n"
         "elastoplastic: {model: follower-8awg}\n",
         "solid-cylinder-type3"},
        {"kind: comparison\ntitle: x\nelastic: {model: none-such}\n"
         "elastoplastic: {model: follower-8awg}\n",
         "c.yaml:3: model: no 'none-such'"},
        {"kind: comparison\ntitle: x\nelastic: {model: follower-8awg-elastic}\n"
         "elastoplastic: {model: follower-8awg}\nspeed: 3\n",
         "c.yaml:5: "},
    };
    assert_refused(&wb_wires_kind, &comparison, wrong, sizeof wrong / sizeof wrong[0]);
}

static void a_wire_with_weight_cannot_be_compared(void **state)
{
    (void)state;
    char path[WB_PATH], *bytes;
    size_t size;
    assert_int_equal(wb_file_find_data(path, "fixtures/models/follower-8awg-elastic.yaml"), WB_OK);
    assert_int_equal(wb_file_read(path, &bytes, &size), WB_OK);
    char *const gravity = memmem(bytes, size, "[0, 0, 0]", 9);
    assert_non_null(gravity);
    memcpy(gravity, "[0, 9, 0]", 9);
    write_text("heavy.yaml", bytes);
    free(bytes);
    assert_true(read_campaign("kind: comparison\ntitle: x\nelastic: {model: ./heavy.yaml}\n"
                              "elastoplastic: {model: follower-8awg}\n") != WB_OK);
    assert_non_null(strstr(kept.error, "c.yaml:3: model: 'follower-8awg-elastic' has weight"));
}

/* --- datasets --- */

static struct bent_wire bent_of(int index, const char *solver)
{
    const struct wb_wire_model *const model = comparison.cases[index].model;
    struct bent_wire bent = {
        .model = model,
        .solver = solver,
        .material = {.hardening = model->is_elastic ? WB_HARDENING_NONE_ELASTIC
                                                    : WB_HARDENING_ISOTROPIC_POWER,
                     .youngs_modulus = wb_wire_model_youngs_modulus(model),
                     .poissons_ratio = wb_wire_model_poissons_ratio(model),
                     .yield_stress = 45e6,
                     .strength_coefficient = 700e6,
                     .hardening_exponent = 0.6},
        .stress_factor = 1.004,
        .most_stress = model->is_elastic ? 0.0 : 320e6,
        .cpu = strcmp(solver, "wire3d") == 0 ? 200.0 : 3.0,
    };
    if (index >= WB_WIRES_RESIDUAL) {
        bent.aside = 4e-3 * (index - WB_WIRES_RESIDUAL + 1);
        bent.material.yield_stress -= 4e6 * (index - WB_WIRES_RESIDUAL + 1);
    }
    if (strcmp(solver, "wire1d") == 0)
        bent.material.youngs_modulus *= 1.002;
    return bent;
}

static void write_dataset(int index, enum wb_wires_solver solver)
{
    struct bent_wire bent = bent_of(index, wb_wires_command(solver));
    bent_write(&bent, comparison.cases[index].datasets[solver].path);
}

static void compute(const char *text)
{
    assert_int_equal(read_campaign(text), WB_OK);
    memset(&results, 0, sizeof results);
    assert_int_equal(wb_wires_results_load(&results, &comparison), WB_OK);
    assert_int_equal(wb_wires_results_compute(&results, 0, NULL, NULL), WB_OK);
}

static void release(void)
{
    wb_wires_results_release(&results);
    wb_wires_release(&comparison);
}

/* Of the whole campaign with all of its datasets: for tests that only look, computed once. */
static const struct wb_wires_results *whole_campaign(void)
{
    if (whole_results.comparison)
        return &whole_results;
    assert_int_equal(read_campaign(whole), WB_OK);
    for (int i = 0; i < comparison.n_cases; i++) {
        for (int k = 0; k < WB_WIRES_SOLVERS; k++) {
            if (comparison.cases[i].datasets[k].wanted)
                write_dataset(i, (enum wb_wires_solver)k);
        }
    }
    whole_comparison = comparison;
    assert_int_equal(wb_wires_results_load(&whole_results, &whole_comparison), WB_OK);
    assert_int_equal(wb_wires_results_compute(&whole_results, 0, NULL, NULL), WB_OK);
    return &whole_results;
}

static void stresses_of_beam_theory_are_found_with_their_ratio(void **state)
{
    (void)state;
    const struct wb_wires_results *const whole_ = whole_campaign();
    assert_int_equal(whole_->outcome.n_usable, 9);
    assert_int_equal(whole_->outcome.n_wanted, 9);
    assert_true(whole_->outcome.is_complete);
    assert_false(whole_->outcome.exceeds_limit);
    assert_int_equal(whole_->n_stresses, 2);
    for (int i = 0; i < 2; i++) {
        const struct wb_wires_stress *const stress = &whole_->stresses[i];
        assert_close(stress->x, i == 0 ? 3.26e-3 : 50e-3, 1e-9);
        assert_close_relative(stress->core.stress / stress->beam, 1.004, 1.5e-3);
        assert_close(fabs(stress->core.reference[1]), 1.63e-3, 1e-9);
        assert_close_relative(stress->jacket.stress / stress->core.stress,
                              41.0 / 68200.0 * 4.86 / 3.26, 1e-3);
    }
    /* 697 MPa at the clamp is what the copper's modulus was chosen by. */
    assert_close(68.2e9 * whole_->exact.curvature[0] * 1.63e-3, 697e6, 0.1e6);
}

static void tips_and_axes_are_compared_at_the_full_force(void **state)
{
    (void)state;
    const struct wb_wires_results *const whole_ = whole_campaign();
    const struct wb_wires_run *const solid =
        wb_wires_usable(whole_, WB_WIRES_ELASTIC, WB_WIRES_SOLID);
    const struct wb_wires_run *const rod = wb_wires_usable(whole_, WB_WIRES_ELASTIC, WB_WIRES_ROD);
    assert_non_null(solid);
    assert_close(solid->force, 24.0, 1e-12);
    /* The rod that made it shears, the exact one does not. */
    struct wb_verdict verdicts[WB_WIRES_VERDICTS];
    assert_int_equal(wb_wires_results_judge(whole_, verdicts), WB_WIRES_VERDICTS);
    assert_non_null(strstr(verdicts[0].what, "elastic solid"));
    assert_true(verdicts[0].value < 2e-3);
    assert_true(verdicts[0].value > 5e-4);
    const double apart = hypot(solid->tip[0] - rod->tip[0], solid->tip[1] - rod->tip[1]);
    assert_true(apart > 1e-5);
    assert_close(wb_wires_distance(solid, rod), apart, 1e-9);
    assert_close(wb_wires_distance(solid, solid), 0.0, 1e-12);
    assert_close_relative(wb_wires_cost(whole_, WB_WIRES_ELASTIC), 0.015, 1e-12);
    /* Out of the plane: the tip's z is part of it. */
    const struct wb_wires_run *const residual =
        wb_wires_usable(whole_, WB_WIRES_RESIDUAL + 1, WB_WIRES_SOLID);
    assert_close(residual->tip[2], 8e-3, 1e-9);
    assert_true(wb_wires_distance(residual, solid) > 8e-3);
}

static void the_exact_rod_is_the_reference_solution(void **state)
{
    (void)state;
    const struct wb_wires_results *const whole_ = whole_campaign();
    const int last = WB_WIRES_POINTS - 1;
    assert_close(whole_->exact.x[last], 97.3646e-3, 2e-7);
    assert_close(whole_->exact.y[last], 20.7793e-3, 2e-7);
    assert_close(whole_->exact.tip_angle * 180.0 / 3.14159265358979, 18.080, 1e-3);
    assert_close(whole_->exact.curvature[0], 6.26933, 2e-4);
    assert_close(wb_wires_rod_curvature(&whole_->exact, 0.1), 0.0, 1e-9);
    assert_true(isnan(wb_wires_rod_curvature(&whole_->exact, 0.11)));
}

static void the_printed_properties_curl_the_wire_up(void **state)
{
    (void)state;
    const struct wb_wires_results *const whole_ = whole_campaign();
    assert_true(whole_->printed.reached);
    assert_close(whole_->printed.tip_angle * 180.0 / 3.14159265358979, 229.0, 2.0);
    assert_close(whole_->collapse_force, 11.38, 0.01);
    assert_close(wb_wires_split(whole_comparison.cases[WB_WIRES_ELASTOPLASTIC].model, 0.01),
                 173.1e6, 0.1e6);
}

static void the_fitted_rod_follows_the_solid(void **state)
{
    (void)state;
    const struct wb_wires_results *const whole_ = whole_campaign();
    assert_int_equal(whole_->fit_state, WB_SIMULATION_USABLE);
    assert_true(whole_->fit.rms < 0.01);
    assert_close_relative(whole_->fit.material.youngs_modulus, 13.84e9, 1e-3);
    const struct wb_wires_run *const solid =
        wb_wires_usable(whole_, WB_WIRES_ELASTOPLASTIC, WB_WIRES_SOLID);
    assert_true(wb_wires_rod_distance(solid, &whole_->fitted) < 2e-3);
    assert_true(wb_wires_rod_distance(solid, &whole_->exact) > 10e-3);
}

static void the_effect_of_residual_stress_is_followed_along_the_loading(void **state)
{
    (void)state;
    const struct wb_wires_results *const all = whole_campaign();
    const struct wb_wires_run *const none =
        wb_wires_usable(all, WB_WIRES_ELASTOPLASTIC, WB_WIRES_SOLID);
    const struct wb_wires_run *const run = wb_wires_usable(all, WB_WIRES_RESIDUAL, WB_WIRES_SOLID);
    assert_int_equal(none->n_loading, 49);
    assert_int_equal(run->n_loading, 49);
    assert_close(run->loading[0], 0.0, 1e-12);
    assert_close(run->loading[48], 24.0, 1e-12);
    /* Straight but for the set out of the plane, then apart by what yields earlier as well. */
    assert_close(wb_wires_tip_distance(run, 0, none), 4e-3, 1e-9);
    assert_true(wb_wires_tip_distance(run, 48, none) > 4.5e-3);
    assert_close(wb_wires_tip_distance(run, 48, none),
                 hypot(hypot(run->tip[0] - none->tip[0], run->tip[1] - none->tip[1]), 4e-3), 1e-9);
    assert_close(wb_wires_tip_distance(run, 20, run), 0.0, 1e-12);
}

static void an_axis_goes_through_its_points_and_is_smooth_between_them(void **state)
{
    (void)state;
    double s[] = {0.0, 1.0, 2.5, 3.0, 5.0}, shape[5][3], point[3];
    for (int i = 0; i < 5; i++) {
        shape[i][0] = s[i] * s[i] * s[i] - s[i];
        shape[i][1] = 2.0 - s[i] * s[i];
        shape[i][2] = 7.0;
    }
    const struct wb_wires_run run = {.n_shape = 5, .s = s, .shape = shape};
    for (double at = 0.0; at <= 5.0; at += 0.25) {
        wb_wires_axis_point(&run, at, point);
        assert_close(point[0], at * at * at - at, 1e-12);
        assert_close(point[1], 2.0 - at * at, 1e-12);
        assert_close(point[2], 7.0, 1e-12);
    }
    const struct wb_wires_run two = {.n_shape = 2, .s = s, .shape = shape};
    wb_wires_axis_point(&two, 0.5, point);
    assert_close(point[1], 1.5, 1e-12);
}

static void limits_that_are_exceeded_are_told(void **state)
{
    (void)state;
    /* Without the elastoplastic datasets there is nothing to fit. */
    static const char form[] = "kind: comparison\ntitle: limits\nsimulations: .\n"
                               "elastic: {model: follower-8awg-elastic}\n"
                               "elastoplastic: {model: follower-8awg, solid: none, rod: none}\n"
                               "limits: {%s}\n";
    static const struct {
        const char *limit;
        bool exceeded;
    } cases[] = {{"tip_max: 1e-5", true},  {"stress_max: 0.001", true}, {"cost_max: 0.01", true},
                 {"tip_max: 0.01", false}, {"stress_max: 0.01", false}, {"cost_max: 0.02", false}};
    (void)whole_campaign();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[1000];
        snprintf(text, sizeof text, form, cases[i].limit);
        compute(text);
        assert_int_equal(results.outcome.exceeds_limit, cases[i].exceeded);
        assert_false(results.outcome.is_complete);
        release();
    }
}

/* --- datasets that cannot be used --- */

static const char own[] = "kind: comparison\n"
                          "title: own models\n"
                          "simulations: own\n"
                          "elastic: {model: ./elastic.yaml}\n"
                          "elastoplastic: {model: ./plastic.yaml}\n"
                          "fit: {elements: 10, fibres: 12}\n";

static void copy_models(void)
{
    copy_shipped("fixtures/models/follower-8awg-elastic.yaml", "elastic.yaml", "");
    copy_shipped("fixtures/models/follower-8awg.yaml", "plastic.yaml", "");
}

static void a_missing_dataset_is_told_with_the_command_that_makes_it(void **state)
{
    (void)state;
    copy_models();
    compute(own);
    assert_int_equal(results.outcome.n_wanted, 4);
    assert_int_equal(results.outcome.n_usable, 0);
    assert_false(results.outcome.is_complete);
    const struct wb_wires_run *const run = &results.runs[WB_WIRES_ELASTOPLASTIC][WB_WIRES_SOLID];
    assert_int_equal(run->simulation.state, WB_SIMULATION_MISSING);
    assert_string_equal(
        wb_text_string(&results.comparison->cases[WB_WIRES_ELASTOPLASTIC].datasets[0].command),
        "wirebench solve wire3d plastic.yaml -o own/follower-8awg-3d");
    assert_int_equal(results.fit_state, WB_SIMULATION_MISSING);
    release();
}

static void a_dataset_of_a_changed_model_is_outdated(void **state)
{
    (void)state;
    copy_models();
    assert_int_equal(read_campaign(own), WB_OK);
    write_dataset(WB_WIRES_ELASTIC, WB_WIRES_SOLID);
    write_dataset(WB_WIRES_ELASTIC, WB_WIRES_ROD);
    wb_wires_release(&comparison);
    compute(own);
    assert_int_equal(results.outcome.n_usable, 2);
    release();

    /* A comment changes nothing, another weight does. */
    copy_shipped("fixtures/models/follower-8awg-elastic.yaml", "elastic.yaml", "# one more line\n");
    compute(own);
    assert_int_equal(results.outcome.n_usable, 2);
    release();
    char command[300];
    snprintf(command, sizeof command, "sed -i 's/3.26, 50/3.26, 51/' '%s'",
             in_folder("elastic.yaml"));
    assert_int_equal(system(command), 0);
    compute(own);
    assert_int_equal(results.outcome.n_usable, 0);
    const struct wb_wires_run *const run = &results.runs[WB_WIRES_ELASTIC][WB_WIRES_SOLID];
    assert_int_equal(run->simulation.state, WB_SIMULATION_STALE);
    assert_non_null(strstr(wb_text_string(&run->simulation.problem),
                           "fields_at_mm[1] is 50 in it, and 51 is wanted"));
    /* The cost is still given. */
    assert_close(run->simulation.cpu_s, 200.0, 1e-12);
    release();
}

static void a_dataset_that_did_not_converge_is_outdated(void **state)
{
    (void)state;
    copy_models();
    assert_int_equal(read_campaign(own), WB_OK);
    struct bent_wire bent = bent_of(WB_WIRES_ELASTOPLASTIC, "wire3d");
    bent.cut_short = true;
    bent_write(&bent, comparison.cases[WB_WIRES_ELASTOPLASTIC].datasets[0].path);
    /* And one that another solver made. */
    bent = bent_of(WB_WIRES_ELASTOPLASTIC, "wire3d");
    bent_write(&bent, comparison.cases[WB_WIRES_ELASTOPLASTIC].datasets[1].path);
    wb_wires_release(&comparison);
    compute(own);
    const struct wb_wires_run *const runs = results.runs[WB_WIRES_ELASTOPLASTIC];
    assert_int_equal(runs[0].simulation.state, WB_SIMULATION_STALE);
    assert_non_null(strstr(wb_text_string(&runs[0].simulation.problem), "at 12 N: made up"));
    assert_int_equal(runs[1].simulation.state, WB_SIMULATION_REFUSED);
    assert_non_null(strstr(wb_text_string(&runs[1].simulation.problem), "by 'solve wire3d'"));
    assert_int_equal(results.fit_state, WB_SIMULATION_MISSING);
    release();
}

static void a_damaged_dataset_is_refused_without_this_machines_paths(void **state)
{
    (void)state;
    copy_models();
    assert_int_equal(read_campaign(own), WB_OK);
    write_dataset(WB_WIRES_ELASTIC, WB_WIRES_SOLID);
    wb_wires_release(&comparison);
    write_text("own/follower-8awg-elastic-3d/fields.csv", "nonsense\n");
    compute(own);
    const struct wb_wires_run *const run = &results.runs[WB_WIRES_ELASTIC][WB_WIRES_SOLID];
    assert_int_equal(run->simulation.state, WB_SIMULATION_REFUSED);
    assert_non_null(strstr(wb_text_string(&run->simulation.problem),
                           "own/follower-8awg-elastic-3d/fields.csv:1"));
    assert_null(strstr(wb_text_string(&run->simulation.problem), folder));
    release();
}

/* --- the report --- */

/* Once for all that look into it. */
static void write_report(void)
{
    if (!wb_file_exists(in_folder("report")))
        assert_int_equal(
            wb_kind_write(&wb_wires_kind, whole_campaign(), in_folder("report"), false, 0), WB_OK);
}

static void the_report_is_whole_and_says_that_it_shows_simulations(void **state)
{
    (void)state;
    static const char *const figures[] = {
        "stress-elastic",  "stress-elastoplastic", "shapes-elastoplastic",
        "loading",         "residual-1",           "residual-2",
        "residual-stress", "residual-shapes",      "shapes-elastic"};
    write_report();
    static const char *const texts[] = {
        "<b>Simulations.</b>",
        "simulations, no tests",
        "Solid &lt;and&gt; rod",
        "a note &amp; more",
        "<b>173 MPa</b>",
        "<b>228 degrees</b>",
        "11.4 N",
    };
    assert_simulated_figures(figures, sizeof figures / sizeof figures[0]);
    for (size_t i = 0; i < sizeof figures / sizeof figures[0]; i++) {
        struct stat info;
        char name[80];
        snprintf(name, sizeof name, "report/figures/%s.svg", figures[i]);
        assert_int_equal(stat(in_folder(name), &info), 0);
        assert_true(info.st_size < 600000);
    }
    assert_says_all("report/report.html", texts, sizeof texts / sizeof texts[0]);
    assert_clean_report();
}

static void report_json_has_what_the_pages_tell(void **state)
{
    (void)state;
    struct wb_json *root;
    double value;
    bool flag;
    write_report();
    assert_int_equal(wb_json_read(&root, in_folder("report/report.json")), WB_OK);
    assert_true(wb_json_get_boolean(root, "complete", &flag) && flag);
    assert_true(wb_json_get_number(root, "jacket_modulus_per_percent_of_core_MPa", &value));
    assert_close(value, 173.1, 0.1);
    assert_int_equal((int)wb_json_length(wb_json_get(root, "cases")), 5);
    const struct wb_json *const first = wb_json_item(wb_json_get(root, "cases"), 0);
    assert_true(wb_json_get_number(first, "cpu_of_rod_over_solid", &value));
    assert_close(value, 0.015, 1e-12);
    assert_int_equal((int)wb_json_length(wb_json_get(root, "files")), 27);
    assert_non_null(wb_json_get(wb_json_get(root, "fit"), "properties"));
    wb_json_destroy(root);
}

static void the_same_datasets_give_the_same_bytes(void **state)
{
    (void)state;
    write_report();
    assert_same_report(&wb_wires_kind, whole_campaign());
}

static void a_report_without_datasets_says_how_to_make_them(void **state)
{
    (void)state;
    char text[sizeof own + 64];
    copy_models();
    snprintf(text, sizeof text, "%s", own);
    memcpy(strstr(text, "own\nelastic"), "xyz", 3);
    assert_int_equal(read_campaign(text), WB_OK);
    memset(&results, 0, sizeof results);
    assert_int_equal(wb_wires_results_load(&results, &comparison), WB_OK);
    assert_int_equal(wb_wires_results_compute(&results, 0, NULL, NULL), WB_OK);
    assert_int_equal(wb_kind_write(&wb_wires_kind, &results, in_folder("none"), true, 0), WB_OK);
    release();
    assert_true(says("none/report.html", "<b>Incomplete.</b> 4 of 4 datasets are missing"));
    assert_true(says("none/report.html", "wirebench solve wire3d plastic.yaml -o "
                                         "xyz/follower-8awg-3d"));
    assert_true(says("none/report.html", "wirebench solve wire1d plastic.yaml -o "
                                         "xyz/follower-8awg-1d"));
    assert_false(says("none/report.html", ">nan") || says("none/report.html", " nan"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_campaign_names_models_and_their_datasets),
        cmocka_unit_test(the_shipped_campaign_can_be_read),
        cmocka_unit_test(a_campaign_that_cannot_be_compared_is_refused_with_its_line),
        cmocka_unit_test(a_wire_with_weight_cannot_be_compared),
        cmocka_unit_test(stresses_of_beam_theory_are_found_with_their_ratio),
        cmocka_unit_test(tips_and_axes_are_compared_at_the_full_force),
        cmocka_unit_test(the_exact_rod_is_the_reference_solution),
        cmocka_unit_test(the_printed_properties_curl_the_wire_up),
        cmocka_unit_test(the_fitted_rod_follows_the_solid),
        cmocka_unit_test(the_effect_of_residual_stress_is_followed_along_the_loading),
        cmocka_unit_test(an_axis_goes_through_its_points_and_is_smooth_between_them),
        cmocka_unit_test(limits_that_are_exceeded_are_told),
        cmocka_unit_test(a_missing_dataset_is_told_with_the_command_that_makes_it),
        cmocka_unit_test(a_dataset_of_a_changed_model_is_outdated),
        cmocka_unit_test(a_dataset_that_did_not_converge_is_outdated),
        cmocka_unit_test(a_damaged_dataset_is_refused_without_this_machines_paths),
        cmocka_unit_test(the_report_is_whole_and_says_that_it_shows_simulations),
        cmocka_unit_test(report_json_has_what_the_pages_tell),
        cmocka_unit_test(the_same_datasets_give_the_same_bytes),
        cmocka_unit_test(a_report_without_datasets_says_how_to_make_them),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
