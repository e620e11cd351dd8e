/* Campaign files and the index of recordings. */
#include "tests/analysis/beam_data.h"

#include <sys/stat.h>
#include <unistd.h>

#include "analysis/report/bench/recordings_kind.h"
#include "daq/recording/index.h"
#include "tests/analysis/report/report_folder.h"

#define SHA_A "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"

static int set_up(void **state)
{
    keep_messages();
    return make_folder(state);
}

static const char index_text[] =
    "recordings:\n"
    "  - file: one.wbr.zst\n    wire: type1\n    length_mm: 85\n    sample: 2\n    seed: 4\n"
    "    sha256: " SHA_A "\n    virtual: true\n"
    "  - file: two.wbr.zst\n    wire: type1\n    length_mm: 85\n    sample: 1\n"
    "    sha256: " SHA_A "\n"
    "  - file: three.wbr.zst\n    wire: type1\n    length_mm: 100\n    sample: 1\n"
    "    sha256: " SHA_A "\n    date_utc: 2026-11-20T11:40:00Z\n    tool_revision: abc\n";

static const char head[] = "title: Some wires\n"
                           "index: index.yaml\n"
                           "calibration_length_mm: 85\n"
                           "validation_length_mm: 100\n"
                           "samples: 2\n";

static enum wb_status read_campaign(struct wb_recordings *campaign, const char *tail)
{
    char text[4096];
    snprintf(text, sizeof text, "%s%s", head, tail);
    return wb_kind_read(&wb_recordings_kind, campaign, write_text("campaign.yaml", text));
}

static void recordings_are_found_in_the_index_and_missing_ones_are_listed(void **state)
{
    (void)state;
    write_text("index.yaml", index_text);
    write_text("one.wbr.zst", "x");
    struct wb_recordings campaign;
    assert_int_equal(read_campaign(&campaign, "wires:\n  - wire: type1\n    label: Type 1\n"),
                     WB_OK);
    assert_int_equal(campaign.n_wires, 1);
    const struct wb_recordings_tests *const calibration =
        &campaign.wires[0].tests[WB_RECORDINGS_CALIBRATION];
    assert_int_equal(calibration->n, 2);
    /* Sorted by sample number; the index has another order. */
    assert_string_equal(calibration->items[0].name, "two.wbr.zst");
    assert_non_null(strstr(calibration->items[0].missing, "does not exist"));
    assert_string_equal(calibration->items[1].name, "one.wbr.zst");
    assert_string_equal(calibration->items[1].missing, "");
    assert_string_equal(calibration->items[1].sha256, SHA_A);
    assert_int_equal(calibration->items[1].seed, 4);
    const struct wb_recordings_tests *const validation =
        &campaign.wires[0].tests[WB_RECORDINGS_VALIDATION];
    assert_int_equal(validation->n, 2);
    assert_string_equal(validation->items[1].name, "Type 1, 100 mm, sample 2");
    assert_non_null(strstr(validation->items[1].missing, "not in the index"));
    int n_missing;
    assert_int_equal(wb_recordings_count(&campaign, &n_missing), 4);
    assert_int_equal(n_missing, 3);
    wb_recordings_release(&campaign);
}

static void reference_is_the_wire_files_properties_unless_the_campaign_gives_one(void **state)
{
    (void)state;
    struct wb_recordings campaign;
    assert_int_equal(read_campaign(&campaign, "wires:\n  - wire: type1\n"), WB_OK);
    assert_true(campaign.wires[0].has_reference);
    assert_close(campaign.wires[0].reference.youngs_modulus, 5021e6, 1.0);
    assert_close(campaign.wires[0].reference.hardening_exponent, 0.99, 1e-12);
    assert_string_equal(campaign.wires[0].label, "type1");
    wb_recordings_release(&campaign);
    assert_int_equal(
        read_campaign(&campaign, "wires:\n  - wire: type1\n    reference:\n"
                                 "      source: a catalogue\n      youngs_modulus_MPa: 4000\n"
                                 "      yield_stress_MPa: 3\n      strength_coefficient_MPa: 100\n"
                                 "      hardening_exponent: 0.5\n"),
        WB_OK);
    assert_string_equal(campaign.wires[0].reference_source, "a catalogue");
    assert_close(campaign.wires[0].reference.strength_coefficient, 1e8, 1e-3);
    wb_recordings_release(&campaign);
}

static void settings_and_limits_are_read_and_have_defaults(void **state)
{
    (void)state;
    struct wb_recordings campaign;
    struct wb_calibrate_settings defaults;
    wb_calibrate_default_settings(&defaults);
    assert_int_equal(read_campaign(&campaign, "wires:\n  - wire: type1\n"), WB_OK);
    assert_close(campaign.head.fit.elastic_zone, defaults.elastic_zone, 0.0);
    assert_close(campaign.limit[WB_RECORDINGS_CALIBRATION], 0.0, 0.0);
    wb_recordings_release(&campaign);
    assert_int_equal(
        read_campaign(&campaign,
                      "settings:\n  yield_point: 0.04\n  step_mm: 0.25\n  straight: true\n  "
                      "bow_corrected: true\n"
                      "  elements: 20\n"
                      "limits:\n  calibration_rms_max: 1e-2\n  validation_rms_max: 3.65e-2\n"
                      "reference:\n  source: Fig. 15\n  validation_rms: [0.01, 0.03]\n"
                      "wires:\n  - wire: type2\n"),
        WB_OK);
    assert_close(campaign.head.fit.yield_point, 0.04, 1e-15);
    assert_close(campaign.head.fit.step, 0.25e-3, 1e-15);
    assert_true(campaign.head.fit.straight);
    assert_true(campaign.head.fit.bow_corrected);
    assert_int_equal(campaign.head.fit.n_elements, 20);
    assert_close(campaign.limit[WB_RECORDINGS_CALIBRATION], 0.01, 1e-15);
    assert_close(campaign.limit[WB_RECORDINGS_VALIDATION], 0.0365, 1e-15);
    assert_close(campaign.reference_rms[1], 0.03, 1e-15);
    wb_recordings_release(&campaign);
}

static void recordings_can_be_given_by_name_path_or_glob(void **state)
{
    (void)state;
    write_text("own-b.wbr", "x");
    write_text("own-a.wbr", "x");
    struct wb_recordings campaign;
    assert_int_equal(read_campaign(&campaign,
                                   "wires:\n  - wire: type1\n"
                                   "    calibration: [\"own-*.wbr\", one.wbr.zst, none.wbr]\n"
                                   "    validation: []\n"),
                     WB_OK);
    const struct wb_recordings_tests *const tests =
        &campaign.wires[0].tests[WB_RECORDINGS_CALIBRATION];
    assert_int_equal(tests->n, 4);
    assert_string_equal(tests->items[0].name, "own-a.wbr");
    assert_string_equal(tests->items[1].name, "own-b.wbr");
    assert_string_equal(tests->items[2].sha256, SHA_A);
    assert_string_equal(tests->items[3].missing, "no such file");
    assert_int_equal(campaign.wires[0].tests[WB_RECORDINGS_VALIDATION].n, 0);
    wb_recordings_release(&campaign);
}

static void without_an_index_all_recordings_are_missing(void **state)
{
    (void)state;
    struct wb_recordings campaign;
    const char *const path = write_text("no-index.yaml", "title: t\nindex: none.yaml\n"
                                                         "calibration_length_mm: 85\nsamples: 3\n"
                                                         "wires:\n  - wire: type1\n");
    assert_int_equal(wb_kind_read(&wb_recordings_kind, &campaign, path), WB_OK);
    int n_missing;
    assert_int_equal(wb_recordings_count(&campaign, &n_missing), 3);
    assert_int_equal(n_missing, 3);
    assert_non_null(
        strstr(campaign.wires[0].tests[WB_RECORDINGS_CALIBRATION].items[0].missing, "no index"));
    wb_recordings_release(&campaign);
}

static void errors_name_file_line_and_key(void **state)
{
    (void)state;
    static const struct {
        const char *tail, *expected;
    } cases[] = {
        {"wires:\n  - wire: type1\nspeed: 3\n", "speed"},
        {"wires:\n  - wire: type1\n    paper: 3\n", "paper"},
        {"wires: []\n", "wires"},
        {"wires: type1\n", "wires"},
        {"", "wires"},
        {"wires:\n  - wire: no-such-wire\n", "no-such-wire"},
        {"wires:\n  - wire: type1\n  - wire: type1\n", "twice"},
        {"wires:\n  - wire: type1\n    calibration: all\n", "list"},
        {"wires:\n  - wire: type1\n    calibration: [[1]]\n", "name or path"},
        {"limits:\n  calibration_rms_max: -1\nwires:\n  - wire: type1\n", "calibration_rms_max"},
        {"settings:\n  yield_point: 0.04 mm\nwires:\n  - wire: type1\n", "yield_point"},
        {"settings:\n  elastic_zone: 0.31\nwires:\n  - wire: type1\n", "elastic_zone"},
        {"settings:\n  yield_point: 0.31\nwires:\n  - wire: type1\n", ":7: yield_point: 0.31"},
        {"reference:\n  source: s\n  validation_rms: [1]\nwires:\n  - wire: type1\n",
         "validation_rms"},
        {"samples: 2\nwires:\n  - wire: type1\n", "samples"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct wb_recordings campaign;
        keep_messages();
        assert_int_not_equal(read_campaign(&campaign, cases[i].tail), WB_OK);
        assert_message(cases[i].expected);
        assert_int_equal(kept.n, 1);
        assert_null(campaign.wires);
    }
    struct wb_recordings campaign;
    assert_int_equal(wb_kind_read(&wb_recordings_kind, &campaign, "/nowhere/campaign.yaml"),
                     WB_ERR_NOT_FOUND);
}

static void recording_excluded_by_an_index_is_not_counted(void **state)
{
    (void)state;
    int n_missing;
    struct wb_recordings campaign;
    char text[2048];
    snprintf(text, sizeof text, "%s%s", index_text,
             "    excluded: {by: A. Tester, reason: it slipped}\n");
    write_text("index.yaml", text);
    write_text("one.wbr.zst", "x");
    assert_int_equal(read_campaign(&campaign, "wires:\n  - wire: type1\n"), WB_OK);
    const struct wb_recordings_tests *const validation =
        &campaign.wires[0].tests[WB_RECORDINGS_VALIDATION];
    assert_string_equal(validation->items[0].name, "three.wbr.zst");
    assert_string_equal(validation->items[0].excluded.by, "A. Tester");
    /* Missing: two.wbr.zst and sample 2 of the validation. three.wbr.zst does not exist either, but
     * is excluded. */
    assert_int_equal(wb_recordings_count(&campaign, &n_missing), 3);
    assert_int_equal(n_missing, 2);
    wb_recordings_release(&campaign);
    /* A recording given by its path and absent from the campaign's index: the exclusion is read
     * from the index.yaml in the folder of the recording. */
    write_text("own-index.yaml", "[]\n");
    write_text("index.yaml",
               "- {file: one.wbr, wire: type1, length_mm: 85, sample: 1, sha256: " SHA_A
               ", excluded: {by: B. Tester, reason: it broke}}\n");
    const char *const path =
        write_text("campaign.yaml", "title: t\nindex: own-index.yaml\ncalibration_length_mm: 85\n"
                                    "wires:\n  - wire: type1\n    calibration: [one.wbr.zst]\n");
    assert_int_equal(wb_kind_read(&wb_recordings_kind, &campaign, path), WB_OK);
    assert_string_equal(campaign.wires[0].tests[0].items[0].excluded.by, "B. Tester");
    assert_int_equal(wb_recordings_count(&campaign, &n_missing), 0);
    assert_int_equal(n_missing, 0);
    wb_recordings_release(&campaign);
}

static void invalid_index_is_rejected(void **state)
{
    (void)state;
    static const struct {
        const char *text, *expected;
    } cases[] = {
        {"- {file: a, wire: w, length_mm: 85, sample: 1}\n", "sha256"},
        {"- {file: a, wire: w, length_mm: 85, sample: 1, sha256: 12}\n", "64 hexadecimal"},
        {"- {file: a, wire: w, length_mm: 85 mm, sample: 1, sha256: " SHA_A "}\n", "length_mm"},
        {"- {file: a, wire: w, length_mm: 85, sample: 1, sha256: " SHA_A "}\n"
         "- {file: a, wire: w, length_mm: 85, sample: 2, sha256: " SHA_A "}\n",
         "twice"},
        {"entries: []\n", "entries"},
        {"just text\n", "keys with values"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct wb_index index;
        keep_messages();
        assert_int_equal(wb_index_read(&index, write_text("bad.yaml", cases[i].text), NULL),
                         WB_ERR_FORMAT);
        assert_message(cases[i].expected);
        assert_null(index.entries);
    }
}

static void shipped_campaign_is_valid_and_its_name_is_a_relative_path(void **state)
{
    (void)state;
    char path[WB_PATH];
    assert_int_equal(wb_file_find_data(path, "fixtures/campaigns/single-wires.yaml"), WB_OK);
    struct wb_recordings campaign;
    assert_int_equal(wb_kind_read(&wb_recordings_kind, &campaign, path), WB_OK);
    assert_string_equal(campaign.head.name, "fixtures/campaigns/single-wires.yaml");
    assert_int_equal(campaign.n_wires, 3);
    assert_close(campaign.head.fit.yield_point, 0.04, 1e-15);
    for (int i = 0; i < 3; i++) {
        assert_true(campaign.wires[i].has_reference);
        assert_int_equal(campaign.wires[i].tests[WB_RECORDINGS_CALIBRATION].n, 3);
        assert_int_equal(campaign.wires[i].tests[WB_RECORDINGS_VALIDATION].n, 3);
    }
    wb_recordings_release(&campaign);
}

static void recording_excluded_by_the_campaign_is_not_counted(void **state)
{
    (void)state;
    write_text("index.yaml", index_text);
    struct wb_recordings campaign;
    assert_int_equal(
        read_campaign(&campaign,
                      "wires:\n  - wire: type1\n"
                      "excluded:\n  - {recording: one.wbr.zst, by: N. N., reason: it slipped}\n"),
        WB_OK);
    const struct wb_recordings_tests *const calibration =
        &campaign.wires[0].tests[WB_RECORDINGS_CALIBRATION];
    int n_missing;
    assert_int_equal(calibration->n, 2);
    assert_false(calibration->items[0].excluded.is_excluded);
    assert_string_equal(calibration->items[1].name, "one.wbr.zst");
    assert_true(calibration->items[1].excluded.is_excluded);
    assert_string_equal(calibration->items[1].excluded.by, "N. N.");
    assert_string_equal(calibration->items[1].excluded.reason, "it slipped");
    assert_int_equal(wb_recordings_count(&campaign, &n_missing), 3); /* of 4 */
    wb_recordings_release(&campaign);
}

static void exclusions_need_a_recording_of_the_campaign_a_person_and_a_reason(void **state)
{
    (void)state;
    static const struct refused_campaign cases[] = {
        {"excluded: []\n", "excluded"},
        {"excluded: [{recording: four.wbr, by: N. N., reason: x}]\n",
         "'four.wbr' is not a recording"},
        {"excluded: [{recording: one.wbr.zst, by: N. N.}]\n", "reason"},
        {"excluded: [{recording: one.wbr.zst, by: \"\", reason: x}]\n", "by: expected a text"},
        {"excluded: [{recording: one.wbr.zst, by: N. N., reason: \"\"}]\n",
         "reason: expected a text"},
    };
    write_text("index.yaml", index_text);
    for (size_t i = 0; i < WB_COUNT(cases); i++) {
        struct wb_recordings campaign;
        char tail[400];
        snprintf(tail, sizeof tail, "wires:\n  - wire: type1\n%s", cases[i].text);
        assert_true(read_campaign(&campaign, tail) != WB_OK);
        if (!strstr(kept.error, cases[i].message))
            fail_msg("'%s' does not contain '%s'", kept.error, cases[i].message);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(recordings_are_found_in_the_index_and_missing_ones_are_listed),
        cmocka_unit_test(reference_is_the_wire_files_properties_unless_the_campaign_gives_one),
        cmocka_unit_test(settings_and_limits_are_read_and_have_defaults),
        cmocka_unit_test(recordings_can_be_given_by_name_path_or_glob),
        cmocka_unit_test(without_an_index_all_recordings_are_missing),
        cmocka_unit_test(errors_name_file_line_and_key),
        cmocka_unit_test(recording_excluded_by_an_index_is_not_counted),
        cmocka_unit_test(invalid_index_is_rejected),
        cmocka_unit_test(shipped_campaign_is_valid_and_its_name_is_a_relative_path),
        cmocka_unit_test(recording_excluded_by_the_campaign_is_not_counted),
        cmocka_unit_test(exclusions_need_a_recording_of_the_campaign_a_person_and_a_reason),
    };
    return cmocka_run_group_tests(tests, set_up, remove_folder);
}
