/* The report of small campaigns: its files, their bytes, and what it says when things are missing
 * or exceeded. The good one is made of the beam's own curves, the others of made-up recordings. */
#include "tests/analysis/beam_data.h"

#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

#include "analysis/align/align.h"
#include "analysis/calibration/cycle/cycle_model.h"
#include "analysis/cards/card.h"
#include "analysis/report/bench/recordings_figures.h"
#include "analysis/report/bench/recordings_kind.h"
#include "analysis/report/bench/recordings_results_private.h"
#include "analysis/report/pages.h"
#include "analysis/validation/validate_bounds.h"
#include "base/interrupt_private.h"
#include "base/json.h"
#include "tests/analysis/report/report_folder.h"
#include "tests/analysis/synthetic.h"

/* --- a good campaign, of the beam's own curves --- */

static const char good_campaign[] = "title: Wires <A> & B\n"
                                    "notes: a note & more\n"
                                    "index: none.yaml\n"
                                    "calibration_length_mm: 85\n"
                                    "validation_length_mm: 100\n"
                                    "samples: 2\n"
                                    "settings: {yield_point: 0.04, step_mm: 1, elements: 10}\n"
                                    "limits: {calibration_rms_max: 0.01, validation_rms_max: "
                                    "0.0365}\n"
                                    "wires:\n"
                                    "  - wire: type1\n"
                                    "    label: Type <1>\n";

struct good {
    struct wb_recordings campaign;
    struct wb_recordings_results results;
};

/* As the alignment tells of a gap. */
static void add_gap(struct wb_recordings_results_test *test, double longest_gap)
{
    struct wb_json *const checks = wb_json_set_object(test->dataset.document, "checks");
    struct wb_json *const rows = wb_json_set_object(checks, "rows");
    struct wb_json *const warnings = wb_json_set_array(test->dataset.document, "warnings");
    wb_json_set_integer(rows, "gaps", 1);
    wb_json_set_number(rows, "longest_gap_s", 10.0 * longest_gap);
    wb_json_append_text(warnings, "1 gap " WB_ALIGN_GAPS_TEXT " 0.85 s");
}

/* The strand's tension with the weights in it, of which the beam's curves have only the force. */
static void fill_tensions(struct wb_dataset *dataset, const struct wb_material *material)
{
    const int n = (int)dataset->n_rows;
    struct wb_cycle_data data = {.info = dataset->info, .n_points = n, .n_loading = n};
    const struct wb_cycle_specimen specimen = {dataset->info.natural_shape[0], 0.0};
    const struct wb_cycle_model_settings settings = {.n_elements = BEAM_ELEMENTS};
    struct wb_cycle_model *model;
    struct wb_cycle_run run;
    struct wb_law law;
    double *const tension = calloc((size_t)n, sizeof *tension);
    data.points = calloc((size_t)n, sizeof *data.points);
    assert_true(tension && data.points);
    for (int i = 0; i < n; i++)
        data.points[i].deflection = dataset->rows[i].deflection;
    wb_law_init_ludwik(&law, material);
    assert_int_equal(wb_cycle_model_create(&model, &data, &law, &settings), WB_OK);
    assert_int_equal(wb_cycle_model_run(model, &law, &specimen, tension, NULL, &run), WB_OK);
    assert_true(run.reached);
    for (int i = 0; i < n; i++)
        dataset->rows[i].tension = tension[i];
    wb_cycle_model_destroy(model);
    free(data.points);
    free(tension);
}

static void fill_tests(struct wb_recordings_results_tests *tests, double length, double factor)
{
    const struct wb_material truth = beam_material(0);
    for (int i = 0; i < tests->n; i++) {
        struct wb_recordings_results_test *const test = &tests->items[i];
        struct wb_test_info info = beam_info(0, length, i == 0 ? 3e-3 : -2e-3);
        info.sample = i + 1;
        info.is_simulation = false;
        info.is_virtual = true;
        beam_dataset(&test->dataset, &info, &truth, 2e-4, 50e-3, factor * (i == 0 ? 0.97 : 1.03));
        fill_tensions(&test->dataset, &truth);
        test->usable = true;
        test->is_virtual = true;
        snprintf(test->start_utc, sizeof test->start_utc, "2026-11-%02dT10:11:12Z", 10 + i);
        snprintf(test->tool_revision, sizeof test->tool_revision, "abc<%d>", i);
        snprintf(test->sha256, sizeof test->sha256, "%064d", i);
        snprintf(test->rig.name, sizeof test->rig.name, "a bench");
        /* 20 g on a bench whose gravity is not the standard one. */
        test->rig.gravity = 9.780;
        test->rig.load_cell.capacity = 20e-3 * 9.780;
        test->specimen.n_markers = 7;
        if (i == 0)
            add_gap(test, length);
    }
}

/* `whole_cycle`: calibrated on whole cycles too. */
static void make_good(struct good *good, double validation_factor, bool whole_cycle)
{
    write_text("good.yaml", good_campaign);
    assert_int_equal(wb_kind_read(&wb_recordings_kind, &good->campaign, in_folder("good.yaml")),
                     WB_OK);
    memset(&good->results, 0, sizeof good->results);
    assert_int_equal(wb_recordings_results_load(&good->results, &good->campaign), WB_OK);
    struct wb_recordings_results_wire *const wire = &good->results.wires[0];
    fill_tests(&wire->steps[WB_RECORDINGS_CALIBRATION].tests, 0.085, 1.0);
    fill_tests(&wire->steps[WB_RECORDINGS_VALIDATION].tests, 0.100, validation_factor);
    const struct wb_dataset *const calibration[] = {
        &wire->steps[WB_RECORDINGS_CALIBRATION].tests.items[0].dataset,
        &wire->steps[WB_RECORDINGS_CALIBRATION].tests.items[1].dataset};
    const struct wb_dataset *const validation[] = {
        &wire->steps[WB_RECORDINGS_VALIDATION].tests.items[0].dataset,
        &wire->steps[WB_RECORDINGS_VALIDATION].tests.items[1].dataset};
    assert_int_equal(
        wb_calibrate_run(&wire->calibration, calibration, 2, &good->campaign.head.fit, NULL),
        WB_OK);
    wb_properties_from_result(&wire->calibration, &wire->properties);
    assert_int_equal(wb_validate_run(&wire->steps[WB_RECORDINGS_CALIBRATION].result,
                                     &wire->properties, calibration, 2, &good->campaign.head.fit,
                                     NULL),
                     WB_OK);
    assert_int_equal(wb_validate_run(&wire->steps[WB_RECORDINGS_VALIDATION].result,
                                     &wire->properties, validation, 2, &good->campaign.head.fit,
                                     NULL),
                     WB_OK);
    wire->steps[0].state = wire->steps[1].state = WB_RECORDINGS_DONE;
    struct wb_reason why = {.text = ""};
    wire->cycle_states[0] = wire->cycle_states[1] =
        whole_cycle ? WB_RECORDINGS_DONE : WB_RECORDINGS_NOT_WANTED;
    if (whole_cycle) {
        struct wb_properties properties;
        if (wb_recordings_cycle_run(&wire->cycle, calibration, 2, &why) != WB_OK)
            fail_msg("%s", why.text);
        wb_properties_from_cycle(&wire->cycle.calibration, &properties);
        assert_int_equal(wb_validate_run(&wire->prediction, &properties, validation, 2,
                                         &good->campaign.head.fit, NULL),
                         WB_OK);
    }
    wb_recordings_results_judge(&good->results);
}

static void release_good(struct good *good)
{
    wb_recordings_results_release(&good->results);
    wb_recordings_release(&good->campaign);
}

static const char *const good_files[] = {
    "report.pdf",
    "report.html",
    "report.json",
    "figures/all-moments.svg",
    "figures/all-bench.svg",
    "figures/all-calibration.svg",
    "figures/all-validation.svg",
    "figures/all-errors.svg",
    "figures/type1-ways.svg",
    "figures/type1-residuals.svg",
    "figures/type1-prediction.svg",
    "figures/type1-forest.svg",
    "figures/type1-moments.svg",
    "figures/type1-valley.svg",
    "figures/type1-cycles.svg",
    "figures/type1-samples.svg",
    "figures/type1-shapes.svg",
    "figures/type1-calibration.svg",
    "figures/type1-validation.svg",
    "figures/type1-error.svg",
    "figures/type1-optimiser.svg",
    "figures/type1-cycles.png",
    "figures/type1-optimiser.png",
};

static int count_files(const char *name)
{
    int n = 0;
    DIR *const open = opendir(in_folder(name));
    assert_non_null(open);
    for (struct dirent *entry; (entry = readdir(open));)
        n += entry->d_name[0] != '.' || strncmp(entry->d_name, ".new", 4) == 0;
    closedir(open);
    return n;
}

static void the_same_results_give_the_same_bytes_in_all_files(void **state)
{
    const struct good *const good = *state;
    assert_true(good->results.outcome.is_complete);
    assert_false(good->results.outcome.exceeds_limit);
    assert_int_equal(
        wb_kind_write(&wb_recordings_kind, &good->results, in_folder("once"), false, 0), WB_OK);
    assert_int_equal(
        wb_kind_write(&wb_recordings_kind, &good->results, in_folder("twice/deep"), false, 0),
        WB_OK);
    for (size_t i = 0; i < sizeof good_files / sizeof good_files[0]; i++) {
        char a[128], b[128];
        size_t n, m;
        snprintf(a, sizeof a, "once/%s", good_files[i]);
        snprintf(b, sizeof b, "twice/deep/%s", good_files[i]);
        char *const once = read_text(a, &n), *const twice = read_text(b, &m);
        assert_int_equal(n, m);
        assert_memory_equal(once, twice, n);
        assert_true(n > 1000);
        assert_null(memmem(once, n, folder, strlen(folder)));
        free(once);
        free(twice);
    }
    /* All there is, and nothing left over from writing. */
    assert_int_equal(count_files("once"), 5);
    assert_int_equal(count_files("once/figures"), 36);
    assert_int_equal(count_files("once/cards"), 1 + WB_CARD_KINDS);
}

static void every_output_says_virtual_rig_and_none_says_experiment(void **state)
{
    (void)state;
    assert_true(says("once/report.html", "<b>Virtual rig.</b>"));
    assert_true(says("once/report.html", "measured (virtual rig)"));
    assert_true(says("once/report.json", "\"virtual_rig\": true"));
    assert_true(says("once/report.json", "\"data\": \"measured (virtual rig)\""));
    /* Every figure as well, each in a file of its own. */
    int n_figures = 0;
    DIR *const figures = opendir(in_folder("once/figures"));
    assert_non_null(figures);
    for (const struct dirent *entry; (entry = readdir(figures));) {
        char name[300];
        if (!strstr(entry->d_name, ".svg"))
            continue;
        snprintf(name, sizeof name, "once/figures/%s", entry->d_name);
        if (!says(name, "virtual rig"))
            fail_msg("%s does not say 'virtual rig'", name);
        n_figures++;
    }
    closedir(figures);
    assert_true(n_figures >= 8);
    assert_false(says("once/report.html", "xperiment"));
    assert_false(says("once/report.json", "xperiment"));
}

/* What a wire's card is made of lies beside it, and both name the recordings by their checksums. */
static void cards_are_those_of_the_properties_beside_them(void **state)
{
    const struct good *const good = *state;
    const struct wb_recordings_results_wire *const wire = &good->results.wires[0];
    const struct wb_recordings_cycle *const cycle = wb_recordings_results_cycle(wire);
    const struct wb_recordings_results_tests *const tests =
        &wire->steps[WB_RECORDINGS_CALIBRATION].tests;
    struct wb_card_source source;
    struct wb_card_settings settings;
    char name[160];
    assert_non_null(cycle);
    snprintf(name, sizeof name, "once/cards/%s.yaml", wire->wanted->product.name);
    assert_int_equal(wb_card_source_read(&source, in_folder(name)), WB_OK);
    assert_close_relative(source.properties.law.material.youngs_modulus,
                          cycle->calibration.law.material.youngs_modulus, 1e-12);
    assert_int_equal(source.properties.n_datasets, tests->n_usable);
    assert_true(source.properties.datasets[0].is_recording && source.properties.is_virtual);
    assert_string_equal(source.properties.datasets[0].sha256, tests->items[0].sha256);
    wb_setting_fill(&wb_card_table, &settings);
    for (int k = 0; k < WB_CARD_KINDS; k++) {
        struct wb_text card = {0};
        snprintf(name, sizeof name, "once/cards/%s.%s", wire->wanted->product.name,
                 wb_card_kinds[k].ending);
        assert_int_equal(wb_card_write(&wb_card_kinds[k], &source, &settings, &card, NULL), WB_OK);
        char *const written = read_text(name, NULL);
        assert_string_equal(written, wb_text_string(&card));
        assert_true(strstr(written, "MADE OF VIRTUAL DATA") < strchr(written, '\n'));
        assert_non_null(strstr(written, tests->items[0].sha256));
        assert_non_null(strstr(written, source.sha256));
        free(written);
        wb_text_release(&card);
    }
    /* The pages name them. */
    assert_true(says("once/report.html", "Cards for other programs"));
    assert_true(says("once/report.html", ".yaml, .calculix.inp"));
    assert_false(says("once/report.html", "no card for"));
}

static void the_html_page_needs_no_other_file_and_escapes_what_comes_from_files(void **state)
{
    (void)state;
    size_t size;
    char *const html = read_text("once/report.html", &size);
    assert_null(strstr(html, "src="));
    assert_null(strstr(html, "url(http"));
    assert_null(strstr(html, "<link"));
    assert_null(strstr(html, "<script"));
    assert_non_null(strstr(html, "Wires &lt;A&gt; &amp; B"));
    assert_non_null(strstr(html, "Type &lt;1&gt;"));
    assert_null(strstr(html, "Type <1>"));
    assert_non_null(strstr(html, "abc&lt;0&gt;"));
    int n = 0;
    for (const char *c = html; (c = strstr(c, "<svg")); c++)
        n++;
    assert_int_equal(n, 18);
    /* Ids are unique over all figures. */
    assert_non_null(strstr(html, "id=\"type1-cycles-0\""));
    assert_non_null(strstr(html, "id=\"type1-samples-0\""));
    assert_null(strstr(html, "id=\"glyph"));
    free(html);
}

static void the_first_page_says_what_was_found(void **state)
{
    const struct good *const good = *state;
    char *const html = read_text("once/report.html", NULL);
    const char *const found = strstr(html, "What was found");
    assert_non_null(found);
    assert_true(found < strstr(html, "Bending properties, from loading and unloading"));
    for (int i = 0; i < good->results.n_wires; i++) {
        const struct wb_recordings_results_wire *const wire = &good->results.wires[i];
        const struct wb_recordings_cycle *const cycle = wb_recordings_results_cycle(wire);
        const struct wb_validate_result *const p = wb_recordings_results_prediction(wire);
        char label[80], text[200];
        assert_true(cycle && p);
        snprintf(text, sizeof text, "%s</b>: %s stiffness = ",
                 wb_pages_escape(label, sizeof label, wire->wanted->label),
                 cycle->calibration.has_unloading ? "unloading" : "secant");
        const char *const sentence = strstr(found, text);
        assert_non_null(sentence);
        assert_close_relative(strtod(sentence + strlen(text), NULL),
                              wb_recordings_cycle_stiffness(&cycle->calibration)->value / WB_NMM2,
                              5e-3);
        const char *const verdict = strstr(sentence, "are predicted: ");
        assert_non_null(verdict);
        assert_true(strncmp(strstr(verdict, "<b>"),
                            wb_validate_bounds_exceeded(p) ? "<b>no</b>" : "<b>yes</b>", 9) == 0);
    }
    free(html);
}

static int count_of(const char *text, const char *part)
{
    int n = 0;
    for (; (text = strstr(text, part)); text += strlen(part))
        n++;
    return n;
}

static void recordings_with_gaps_are_counted_in_one_line(void **state)
{
    (void)state;
    char *html;
    assert_int_equal(wb_file_read(in_folder("once/report.html"), &html, NULL), WB_OK);
    assert_int_equal(
        count_of(html, "2 of 4 recordings have gaps in the rows, the longest of 1.00 s"), 1);
    /* Each stands on its wire's page, and not on the first one as well. */
    assert_int_equal(count_of(html, "1 gap " WB_ALIGN_GAPS_TEXT), 2);
    free(html);
}

static void the_capacity_is_what_weighs_so_much_on_that_bench(void **state)
{
    (void)state;
    assert_true(says("once/report.html", "20 g, reads on to"));
    const struct wb_rig unknown = {.gravity = 0.0};
    assert_true(isnan(wb_recordings_results_capacity(&unknown)));
}

/* How often the lines of the figure of all cycles are begun. */
static int begun_lines(const struct wb_recordings_results *results)
{
    struct wb_figures figures;
    struct wb_text svg = {0};
    assert_int_equal(
        wb_figures_create(&figures, wb_recordings_figures, WB_RECORDINGS_FIGURES, results), WB_OK);
    const struct wb_figure *cycles = NULL;
    for (int i = 0; i < figures.n; i++) {
        if (strstr(wb_figure_name(figures.items[i].figure), "-cycles"))
            cycles = figures.items[i].figure;
    }
    assert_non_null(cycles);
    assert_int_equal(wb_figure_svg(cycles, &svg), WB_OK);
    const int n = count_of(wb_text_string(&svg), "M ");
    wb_text_release(&svg);
    wb_figures_release(&figures);
    return n;
}

static void a_slack_strand_or_a_gap_breaks_the_line(void **state)
{
    (void)state;
    struct good good;
    make_good(&good, 1.0, false);
    struct wb_dataset *const dataset = &good.results.wires[0].steps[0].tests.items[0].dataset;
    const int whole = begun_lines(&good.results);
    assert_true(dataset->n_rows > 40);
    for (size_t i = 20; i < 25; i++)
        dataset->rows[i].phase = WB_PHASE_SLACK;
    assert_int_equal(begun_lines(&good.results), whole + 1);
    /* And so does a gap in time. */
    for (size_t i = 30; i < dataset->n_rows; i++)
        dataset->rows[i].t += 20.0;
    assert_int_equal(begun_lines(&good.results), whole + 2);
    release_good(&good);
}

static void the_json_file_holds_the_computed_numbers(void **state)
{
    const struct good *const good = *state;
    const struct wb_recordings_results_wire *const wire = &good->results.wires[0];
    struct wb_json *root;
    assert_int_equal(wb_json_read(&root, in_folder("once/report.json")), WB_OK);
    const struct wb_json *const entry = wb_json_item(wb_json_get(root, "wires"), 0);
    const struct wb_json *const calibration = wb_json_get(entry, "calibration");
    double value = 0.0;
    assert_true(wb_json_get_number(wb_json_get(calibration, "properties"),
                                   "strength_coefficient_MPa", &value));
    assert_close_relative(value * WB_MPA, wire->calibration.material.strength_coefficient, 1e-12);
    assert_true(wb_json_get_number(calibration, "rms_over_F_max", &value));
    assert_close(value, wire->calibration.rms, 1e-15);
    const struct wb_json *const validation = wb_json_get(entry, "validation");
    assert_true(
        wb_json_get_number(wb_json_get(validation, "elastoplastic"), "rms_over_F_max", &value));
    assert_close(value, wire->steps[WB_RECORDINGS_VALIDATION].result.elastoplastic.rms, 1e-15);
    assert_true(wb_json_get_number(validation, "F_max_mN", &value));
    assert_close_relative(value * WB_MN,
                          wire->steps[WB_RECORDINGS_VALIDATION].result.curve.max_force, 1e-12);
    assert_int_equal(wb_json_length(wb_json_get(root, "recordings")), 4);
    assert_int_equal(wb_json_length(wb_json_get(root, "files")), 45);
    wb_json_destroy(root);
}

static void compute(const char *name, const char *text, int threads, struct wb_recordings *campaign,
                    struct wb_recordings_results *results)
{
    write_text(name, text);
    assert_int_equal(wb_kind_read(&wb_recordings_kind, campaign, in_folder(name)), WB_OK);
    memset(results, 0, sizeof *results);
    assert_int_equal(wb_recordings_results_load(results, campaign), WB_OK);
    assert_int_equal(wb_recordings_results_compute(results, threads, NULL, NULL), WB_OK);
}

/* The beam's curves have no unloading. */
static void a_loading_alone_leaves_the_rule_untested(void **state)
{
    const struct good *const good = *state;
    const struct wb_cycle_calibration *const c = &good->results.wires[0].cycle.calibration;
    struct wb_json *root;
    assert_int_equal(wb_json_read(&root, in_folder("once/report.json")), WB_OK);
    const struct wb_json *const entry = wb_json_item(wb_json_get(root, "wires"), 0);
    const struct wb_json *const cycle = wb_json_get(entry, "cycle");
    const struct wb_json *const rule = wb_json_get(cycle, "hardening_rule");
    double value = 0.0;
    bool is_measured = true;
    assert_true(wb_json_get_number(wb_json_get(cycle, "flexural_rigidity_N_mm2"), "value", &value));
    assert_close_relative(1e-6 * value, c->rigidity.value, 1e-12);
    assert_true(wb_json_get_boolean(rule, "unloading_measured", &is_measured));
    assert_false(is_measured);
    assert_null(wb_json_get(cycle, "later_cycles"));
    assert_non_null(wb_json_get(cycle, "ludwik_on_loading_alone"));
    wb_json_destroy(root);
    assert_true(says("once/report.html", "rule untested: no unloading"));
    assert_true(says("once/report.html", "Bending properties, from loading and unloading"));
    assert_true(says("once/report.html", "by the paper&#39;s route") ||
                says("once/report.html", "by the paper's route"));
}

/* s of ln EI about each wire's own mean, and the interval that it gives. */
static void the_scatter_is_pooled_over_wires_where_it_is_asked_for(void **state)
{
    (void)state;
    struct wb_recordings_cycle a = {.calibration = {.n_members = 3}};
    struct wb_recordings_cycle b = {.calibration = {.n_members = 2}};
    struct wb_recordings_cycle_pool pool = {0};
    double low, high;
    a.calibration.rigidity = (struct wb_estimate){.value = 2.0, .deviation = 0.03};
    b.calibration.rigidity = (struct wb_estimate){.value = 5.0, .deviation = 0.06};
    wb_recordings_cycle_pool(&pool, &a);
    wb_recordings_cycle_pool(&pool, &b);
    wb_recordings_cycle_close(&pool);
    assert_int_equal(pool.degrees, 3);
    assert_close_relative(pool.deviation, sqrt((2.0 * 9e-4 + 36e-4) / 3.0), 1e-12);
    /* Student's t of 3 degrees of freedom is 3.182446. */
    wb_recordings_cycle_interval(&pool, &a, &low, &high);
    assert_close_relative(log(high / 2.0), 3.182446 * pool.deviation / sqrt(3.0), 1e-6);
    assert_close_relative(low * high, 4.0, 1e-12);
    const struct wb_recordings_cycle_pool none = {0};
    wb_recordings_cycle_interval(&none, &a, &low, &high);
    assert_true(isnan(low) && isnan(high));
}

/* The uncertainty of an RMS stands beside each verdict, and the rule decides by it. */
static void a_laboratorys_verdicts_have_uncertainty_and_rule(void **state)
{
    struct good *const good = *state;
    struct wb_laboratory *const laboratory = &good->campaign.head.laboratory;
    const struct wb_recordings_results_wire *const wire = &good->results.wires[0];
    const struct wb_calibrate_result *const c = &wire->calibration;
    /* Student's t of 1 degree of freedom is 12.7062 at 95 %. */
    const double U = wb_recordings_results_uncertainty(wire, WB_RECORDINGS_CALIBRATION);
    assert_close_relative(
        U, 12.70620474 * fmin(c->scatter_rms, c->residual_scatter_rms) / sqrt(2.0), 1e-8);
    assert_true(U > 0.0);
    assert_close(wb_recordings_results_uncertainty(wire, WB_RECORDINGS_VALIDATION),
                 wire->steps[WB_RECORDINGS_VALIDATION].result.expected_rms_95, 0.0);
    const double limit = good->campaign.limit[0];
    good->campaign.limit[0] = c->rms + 0.5 * U;
    assert_true(wb_recordings_results_keeps(&good->campaign, wire, WB_RECORDINGS_CALIBRATION));
    laboratory->rule = WB_RULE_GUARDED;
    assert_false(wb_recordings_results_keeps(&good->campaign, wire, WB_RECORDINGS_CALIBRATION));
    laboratory->is_given = true;
    snprintf(laboratory->report, sizeof laboratory->report, "WB-7");
    assert_int_equal(
        wb_kind_write(&wb_recordings_kind, &good->results, in_folder("laboratory"), false, 0),
        WB_OK);
    char verdict[120];
    snprintf(verdict, sizeof verdict, "<i>U</i> = %.4f (95 %%, scatter between specimens)", U);
    assert_true(says("laboratory/report.html", verdict));
    assert_true(says("laboratory/report.html", "<b>exceeded</b> by guarded acceptance"));
    assert_true(says("laboratory/report.html", "End of report WB-7."));
    assert_true(says("laboratory/report.json", "\"limit_kept\": false"));
    *laboratory = (struct wb_laboratory){.is_given = false};
    good->campaign.limit[0] = limit;
}

static void number_and_pages_stand_on_every_page(void **state)
{
    (void)state;
    if (system("command -v pdftotext >/dev/null 2>&1") != 0)
        skip();
    char command[3 * WB_PATH], foot[80];
    snprintf(command, sizeof command, "pdftotext -layout '%s' '%s'",
             in_folder("laboratory/report.pdf"), in_folder("laboratory.txt"));
    assert_int_equal(system(command), 0);
    char *const text = read_text("laboratory.txt", NULL);
    int n = 0;
    for (const char *c = text; *c; c++)
        n += *c == '\f';
    assert_true(n > 3);
    const char *page = text;
    for (int i = 1; i <= n; i++) {
        const char *const end = strchr(page, '\f');
        snprintf(foot, sizeof foot, "Report WB-7 \xc2\xb7 Page %d of %d", i, n);
        assert_non_null(memmem(page, (size_t)(end - page), foot, strlen(foot)));
        page = end + 1;
    }
    free(text);
}

/* Without it the report is the paper's route alone, complete as before. */
static void a_campaign_may_ask_for_the_papers_route_alone(void **state)
{
    (void)state;
    struct wb_recordings campaign;
    struct wb_recordings_results results;
    char text[1000];
    snprintf(text, sizeof text, "%swhole_cycle: false\n", good_campaign);
    compute("paper.yaml", text, 1, &campaign, &results);
    assert_int_equal(results.wires[0].cycle_states[0], WB_RECORDINGS_NOT_WANTED);
    assert_int_equal(results.outcome.n_steps, 6);
    assert_int_equal(wb_kind_write(&wb_recordings_kind, &results, in_folder("paper"), false, 0),
                     WB_OK);
    assert_false(says("paper/report.html", "Bending properties"));
    assert_false(says("paper/report.json", "\"cycle\""));
    wb_recordings_results_release(&results);
    wb_recordings_release(&campaign);
}

static void the_pdf_text_can_be_searched(void **state)
{
    (void)state;
    size_t size;
    char *const pdf = read_text("once/report.pdf", &size);
    assert_memory_equal(pdf, "%PDF-1.", 7);
    free(pdf);
    if (system("command -v pdftotext >/dev/null 2>&1") != 0)
        skip();
    char command[3 * WB_PATH];
    /* The date of the latest recording, not of the run; newer Cairos compress it. */
    snprintf(command, sizeof command, "pdfinfo -rawdates '%s' >'%s'", in_folder("once/report.pdf"),
             in_folder("report.info"));
    assert_int_equal(system(command), 0);
    assert_true(says("report.info", "20261111101112Z"));
    snprintf(command, sizeof command, "pdftotext -layout '%s' '%s'", in_folder("once/report.pdf"),
             in_folder("report.txt"));
    assert_int_equal(system(command), 0);
    assert_true(says("report.txt", "Wires <A> & B"));
    assert_true(says("report.txt", "Virtual rig."));
    assert_true(says("report.txt", "Strength coefficient"));
    assert_true(says("report.txt", "measured (virtual rig)"));
    assert_true(says("report.txt", "wirebench report good.yaml -o DIR"));
    /* Checksums by their first digits, which report.json has as a whole. */
    assert_true(says("report.txt", "0000000000000000"));
    assert_true(says("once/report.json",
                     "0000000000000000000000000000000000000000000000000000000000000"
                     "001"));
}

static void a_full_folder_is_refused_and_force_replaces_only_the_reports_own_files(void **state)
{
    const struct good *const good = *state;
    keep_messages();
    assert_int_equal(
        wb_kind_write(&wb_recordings_kind, &good->results, in_folder("once"), false, 0),
        WB_ERR_EXISTS);
    assert_message("--force");
    write_text("once/mine.txt", "mine");
    write_text("once/figures/mine.svg", "mine");
    write_text("once/figures/stale.svg", "an old figure");
    write_text("once/report.json", "{\"files\": [\"figures/stale.svg\", \"../good.yaml\"]}");
    assert_int_equal(wb_kind_write(&wb_recordings_kind, &good->results, in_folder("once"), true, 0),
                     WB_OK);
    assert_true(says("once/mine.txt", "mine"));
    assert_true(says("once/figures/mine.svg", "mine"));
    assert_false(wb_file_exists(in_folder("once/figures/stale.svg")));
    assert_true(wb_file_exists(in_folder("good.yaml")));
    assert_true(says("once/report.json", "properties"));
}

static void a_folder_that_cannot_be_written_leaves_nothing(void **state)
{
    const struct good *const good = *state;
    write_text("file", "a file");
    assert_int_not_equal(
        wb_kind_write(&wb_recordings_kind, &good->results, in_folder("file"), false, 0), WB_OK);
    assert_int_not_equal(
        wb_kind_write(&wb_recordings_kind, &good->results, in_folder("file/below"), true, 0),
        WB_OK);
    assert_true(says("file", "a file"));
}

static void a_miss_of_a_limit_is_told_with_the_share_of_the_scatter(void **state)
{
    (void)state;
    struct good bad;
    make_good(&bad, 1.12, false);
    assert_true(bad.results.outcome.exceeds_limit);
    assert_true(bad.results.outcome.is_complete);
    const struct wb_recordings_results_wire *const wire = &bad.results.wires[0];
    const double share = wire->steps[WB_RECORDINGS_VALIDATION].result.scatter_share;
    const double r_v = fmin(wire->steps[WB_RECORDINGS_VALIDATION].result.scatter_rms,
                            wire->steps[WB_RECORDINGS_VALIDATION].result.residual_scatter_rms);
    const double r_c = fmin(wire->calibration.scatter_rms, wire->calibration.residual_scatter_rms);
    const struct wb_validate_result *const result = &wire->steps[WB_RECORDINGS_VALIDATION].result;
    const double rms = result->elastoplastic.rms;
    assert_close(share, fmin(1.0, (r_v * r_v + r_c * r_c) / 2.0 / (rms * rms)), 1e-12);
    assert_true(share > 0.01 && share < 0.9);
    assert_int_equal(wb_kind_write(&wb_recordings_kind, &bad.results, in_folder("bad"), false, 0),
                     WB_OK);
    char text[80];
    snprintf(text, sizeof text, "about %.4f, above %.4f in one of twenty validations",
             result->expected_rms, result->expected_rms_95);
    assert_true(says("bad/report.html", "limit 0.0365 exceeded"));
    assert_false(says("bad/report.html", "<li class=\"good\">"));
    assert_true(says("bad/report.html", text));
    assert_true(says("bad/report.json", "\"limit_exceeded\": true"));
    release_good(&bad);
}

/* --- campaigns that lack something --- */

static void a_campaign_without_any_recording_still_reports(void **state)
{
    (void)state;
    struct wb_recordings campaign;
    struct wb_recordings_results results;
    compute("empty.yaml", good_campaign, 2, &campaign, &results);
    assert_false(results.outcome.is_complete);
    assert_false(results.any_virtual);
    assert_int_equal(results.outcome.n_wanted, 4);
    assert_int_equal(results.outcome.n_usable, 0);
    assert_int_equal(wb_kind_write(&wb_recordings_kind, &results, in_folder("empty"), false, 0),
                     WB_OK);
    assert_true(says("empty/report.html", "4 of 4 recordings are missing"));
    assert_true(says("empty/report.html", "there is no index of recordings"));
    assert_true(says("empty/report.json", "\"complete\": false"));
    assert_false(says("empty/report.html", "irtual rig"));
    wb_recordings_results_release(&results);
    wb_recordings_release(&campaign);
}

static const char made_up_campaign[] = "title: Made up\n"
                                       "index: made-up.yaml\n"
                                       "calibration_length_mm: 85\n"
                                       "samples: 3\n"
                                       "wires:\n"
                                       "  - wire: ./synthetic.yaml\n";

/* Three recordings: good, not the one that the index lists, not a recording at all. Their wire is
 * elastic, so that its calibration is refused. */
static void what_cannot_be_used_or_calibrated_is_told_with_the_reason(void **state)
{
    (void)state;
    struct syn syn;
    syn_default(&syn);
    syn_record(&syn, in_folder("a.wbr"));
    syn_default(&syn);
    syn.bow = 2e-3;
    syn_record(&syn, in_folder("b.wbr"));
    write_text("c.wbr", "this is no recording");
    write_text("synthetic.yaml", syn_wire);
    char sha256[65], index[1024];
    assert_int_equal(wb_recording_sha256(in_folder("a.wbr"), sha256, NULL), WB_OK);
    snprintf(index, sizeof index,
             "- {file: a.wbr, wire: synthetic, length_mm: 85, sample: 1, sha256: %s}\n"
             "- {file: b.wbr, wire: synthetic, length_mm: 85, sample: 2, sha256: %s}\n"
             "- {file: c.wbr, wire: synthetic, length_mm: 85, sample: 3, sha256: %s}\n",
             sha256, sha256, sha256);
    write_text("made-up.yaml", index);
    char *texts[2];
    for (int threads = 1; threads <= 2; threads++) {
        struct wb_recordings campaign;
        struct wb_recordings_results results;
        compute("campaign.yaml", made_up_campaign, threads, &campaign, &results);
        assert_int_equal(results.outcome.n_usable, 1);
        assert_true(results.all_virtual);
        assert_false(results.outcome.is_complete);
        const struct wb_recordings_results_wire *const wire = &results.wires[0];
        const struct wb_recordings_results_test *const tests =
            wire->steps[WB_RECORDINGS_CALIBRATION].tests.items;
        assert_true(tests[0].usable);
        assert_string_equal(tests[0].start_utc, "2026-01-01T00:00:00Z");
        assert_non_null(strstr(wb_text_string(&tests[1].problem), "not the recording"));
        assert_non_null(strstr(wb_text_string(&tests[2].problem), "not a recording"));
        assert_null(strstr(wb_text_string(&tests[2].problem), folder));
        assert_int_equal(wire->steps[WB_RECORDINGS_CALIBRATION].state, WB_RECORDINGS_FAILED);
        assert_true(wire->steps[WB_RECORDINGS_CALIBRATION].problem.length > 10);
        assert_int_equal(wire->steps[WB_RECORDINGS_VALIDATION].state, WB_RECORDINGS_NOT_WANTED);
        assert_int_not_equal(wire->cycle_states[0], WB_RECORDINGS_NOT_WANTED);
        assert_int_equal(
            wb_kind_write(&wb_recordings_kind, &results, in_folder("made-up"), threads > 1, 0),
            WB_OK);
        texts[threads - 1] = read_text("made-up/report.json", NULL);
        if (threads == 2) {
            assert_true(says("made-up/report.html", "2 of 3 recordings are missing"));
            assert_true(wb_file_exists(in_folder("made-up/figures/synthetic-cycles.svg")));
            assert_false(says("made-up/report.html", folder));
            assert_false(says("made-up/report.json", folder));
        }
        wb_recordings_results_release(&results);
        wb_recordings_release(&campaign);
    }
    /* The numbers do not depend on the number of threads. */
    assert_string_equal(texts[0], texts[1]);
    free(texts[0]);
    free(texts[1]);
}

static void an_interrupt_ends_the_computation(void **state)
{
    (void)state;
    struct wb_recordings campaign;
    struct wb_recordings_results results;
    wb_interrupt_set(true);
    compute("campaign.yaml", made_up_campaign, 2, &campaign, &results);
    wb_interrupt_set(false);
    assert_true(results.outcome.interrupted);
    wb_recordings_results_release(&results);
    wb_recordings_release(&campaign);
}

static int setup(void **state)
{
    static struct good good;
    keep_messages();
    if (make_folder(state) != 0)
        return -1;
    make_good(&good, 1.0, true);
    *state = &good;
    return 0;
}

static int teardown(void **state)
{
    release_good(*state);
    return remove_folder(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_same_results_give_the_same_bytes_in_all_files),
        cmocka_unit_test(every_output_says_virtual_rig_and_none_says_experiment),
        cmocka_unit_test(cards_are_those_of_the_properties_beside_them),
        cmocka_unit_test(the_html_page_needs_no_other_file_and_escapes_what_comes_from_files),
        cmocka_unit_test(the_first_page_says_what_was_found),
        cmocka_unit_test(recordings_with_gaps_are_counted_in_one_line),
        cmocka_unit_test(the_capacity_is_what_weighs_so_much_on_that_bench),
        cmocka_unit_test(a_slack_strand_or_a_gap_breaks_the_line),
        cmocka_unit_test(the_json_file_holds_the_computed_numbers),
        cmocka_unit_test(a_loading_alone_leaves_the_rule_untested),
        cmocka_unit_test(the_scatter_is_pooled_over_wires_where_it_is_asked_for),
        cmocka_unit_test(a_campaign_may_ask_for_the_papers_route_alone),
        cmocka_unit_test(a_laboratorys_verdicts_have_uncertainty_and_rule),
        cmocka_unit_test(number_and_pages_stand_on_every_page),
        cmocka_unit_test(the_pdf_text_can_be_searched),
        cmocka_unit_test(a_full_folder_is_refused_and_force_replaces_only_the_reports_own_files),
        cmocka_unit_test(a_folder_that_cannot_be_written_leaves_nothing),
        cmocka_unit_test(a_miss_of_a_limit_is_told_with_the_share_of_the_scatter),
        cmocka_unit_test(a_campaign_without_any_recording_still_reports),
        cmocka_unit_test(what_cannot_be_used_or_calibrated_is_told_with_the_reason),
        cmocka_unit_test(an_interrupt_ends_the_computation),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
