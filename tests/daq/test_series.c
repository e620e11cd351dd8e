/* The file of a series, the names of its recordings, and its progress. */
#include "daq/test/series.h"

#include <stdlib.h>

#include "base/units.h"
#include "tests/messages.h"
#include "tests/own_folder.h"

#define SPECIMEN                                                                                   \
    "wire: type1\nlength_mm: 85\nsample: 9\nmarkers_mm: [0, 40.5, 85]\nmarker_offset_mm: 1\n"      \
    "marker_offset_uncertainty_mm: 0.1\n"
#define HEAD "series: tall\nspecimen: like.yaml\nspecimens: 3\n"

static char path[WB_PATH];

static const char *write_file(const char *name, const char *text)
{
    assert_int_equal(wb_file_join(path, folder, name), WB_OK);
    assert_int_equal(wb_file_write(path, text, strlen(text)), WB_OK);
    return path;
}

static int set_up(void **state)
{
    if (make_folder(state) != 0)
        return -1;
    write_file("like.yaml", SPECIMEN);
    return 0;
}

static enum wb_status read_series(struct wb_series *series, const char *text)
{
    struct wb_bend_test_request request;
    wb_bend_test_default_request(&request);
    return wb_series_read(series, write_file("series.yaml", text), &request);
}

static struct wb_series series_of(const char *more)
{
    char text[1024];
    struct wb_series series;
    snprintf(text, sizeof text, "%s%s", HEAD, more);
    assert_int_equal(read_series(&series, text), WB_OK);
    return series;
}

static void file_gives_specimens_and_settings_of_the_tests(void **state)
{
    (void)state;
    struct wb_series series;
    struct wb_bend_test_request request;
    wb_bend_test_default_request(&request);
    write_file("series.yaml", HEAD "first_sample: 4\nask: [notes, marker_offset_mm]\n"
                                   "rig: my-rig.yaml\ncycles: 2\ntravel_mm: 30\n");
    assert_int_equal(wb_series_read(&series, path, &request), WB_OK);
    assert_string_equal(series.name, "tall");
    assert_int_equal(series.n_specimens, 3);
    assert_int_equal(series.first_sample, 4);
    assert_false(series.asks[WB_SERIES_MARKERS]);
    assert_true(series.asks[WB_SERIES_OFFSET]);
    assert_true(series.asks[WB_SERIES_NOTES]);
    assert_int_equal(request.cycles, 2);
    assert_close(request.travel, 30.0 * WB_MM, 1e-12);
    assert_close(series.like.length, 85.0 * WB_MM, 1e-12);
    char expected[WB_PATH];
    assert_int_equal(wb_file_join(expected, folder, "my-rig.yaml"), WB_OK);
    assert_string_equal(series.rig, expected);
}

static void wrong_entry_is_rejected_with_its_line(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {HEAD "colour: red\n", "series.yaml:4: colour"},
        {HEAD "output: '{series}.wbr'\n", "series.yaml:4: output: expected {number}"},
        {HEAD "output: '{number}-{wire}.wbr'\n", "series.yaml:4: output: expected {series}"},
        {HEAD "output: '{number:3}.wbr'\n", "not '{number:3}'"},
        {HEAD "output: '{number'\n", "not '{number}'"},
        {HEAD "output: 'data/{number}.wbr'\n", "without a folder"},
        {HEAD "output: '{number}*.wbr'\n", "series.yaml:4: output: expected a name of letters"},
        {HEAD "output: '{number}.dat'\n", "ends in .wbr"},
        {HEAD "ask: [length_mm]\n", "series.yaml:4: ask"},
        {HEAD "ask: notes\n", "expected a list of markers_mm"},
        {HEAD "travel_mm: 0\n", "series.yaml:4: travel_mm"},
        {"series: a b\nspecimen: like.yaml\nspecimens: 3\n", "series.yaml:1: series: expected"},
        {"series: a\nspecimen: none.yaml\nspecimens: 3\n", "series.yaml:2: specimen: 'none.yaml'"},
        {"series: a\nspecimen: like.yaml\nspecimens: 0\n", "series.yaml:3: specimens"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct wb_series series;
        keep_messages();
        assert_int_not_equal(read_series(&series, cases[i][0]), WB_OK);
        assert_message(cases[i][1]);
    }
    release_messages();
}

static void names_follow_the_template(void **state)
{
    (void)state;
    char file[WB_SERIES_FILE];
    struct wb_series series = series_of("");
    wb_series_file(&series, 7, 3, file);
    assert_string_equal(file, "tall-007-type1-L85-3.wbr");
    wb_series_file(&series, 1234, 3, file);
    assert_string_equal(file, "tall-1234-type1-L85-3.wbr");
    series = series_of("output: 'x{number}y{sample}.wbr'\n");
    wb_series_file(&series, 7, 3, file);
    assert_string_equal(file, "x7y3.wbr");
    write_file("like.yaml", "wire: 'my wires/odd wire*.yaml'\nlength_mm: 100\nsample: 1\n"
                            "markers_mm: [0, 100]\nmarker_offset_mm: 0\n");
    series = series_of("");
    wb_series_file(&series, 1, 2, file);
    assert_string_equal(file, "tall-001-odd_wire_-L100-2.wbr");
}

static void specimen_is_like_the_file_but_for_its_sample_and_the_answers(void **state)
{
    (void)state;
    const struct wb_series series = series_of("");
    struct wb_specimen specimen;
    struct wb_text text = {0};
    assert_int_equal(wb_series_specimen(&series, 4, NULL, &text, NULL), WB_OK);
    assert_int_equal(wb_specimen_parse(wb_text_string(&text), "text", &specimen, NULL), WB_OK);
    wb_text_release(&text);
    assert_string_equal(specimen.wire, "type1");
    assert_int_equal(specimen.sample, 4);
    assert_int_equal(specimen.n_markers, 3);
    assert_close(specimen.markers[1], 40.5 * WB_MM, 1e-12);
    assert_close(specimen.marker_offset, 1.0 * WB_MM, 1e-12);
    assert_close(specimen.marker_offset_uncertainty, 0.1 * WB_MM, 1e-12);
    const char *const answers[] = {"0, 20, 41, 85", "-0.5", "a note"};
    assert_int_equal(wb_series_specimen(&series, 5, answers, &text, NULL), WB_OK);
    assert_int_equal(wb_specimen_parse(wb_text_string(&text), "text", &specimen, NULL), WB_OK);
    wb_text_release(&text);
    assert_int_equal(specimen.n_markers, 4);
    assert_close(specimen.markers[2], 41.0 * WB_MM, 1e-12);
    assert_close(specimen.marker_offset, -0.5 * WB_MM, 1e-12);
    const char *const bad[] = {"0, 20, 84", NULL, NULL};
    struct wb_reason why = {.text = ""};
    assert_int_equal(wb_series_specimen(&series, 5, bad, &text, &why), WB_ERR_FORMAT);
    assert_non_null(strstr(why.text, "markers_mm: expected the last marker"));
    wb_text_release(&text);
}

static int next_number(const struct wb_series *series, const struct wb_index *index)
{
    int number = 0;
    assert_int_equal(wb_series_next_number(series, folder, index, &number), WB_OK);
    return number;
}

static void number_is_above_all_that_were_ever_used(void **state)
{
    (void)state;
    const struct wb_series series = series_of("");
    struct wb_index_entry entries[] = {{.file = "elsewhere.wbr", .series = "tall", .number = 41},
                                       {.file = "x.wbr", .series = "other", .number = 900},
                                       {.file = "tall-050-type1-L85-2.wbr"}};
    struct wb_index index = {0};
    assert_int_equal(next_number(&series, &index), 1);
    write_file("tall-002-type1-L85-1.wbr", "x");
    write_file("tall-2000-type1-L85-1.csv", "another kind of file");
    write_file("small-300-type1-L85-1.wbr", "another series");
    assert_int_equal(next_number(&series, &index), 3);
    write_file("tall-009-other-L1-1.wbr.zst", "compressed, of a wire named otherwise");
    assert_int_equal(next_number(&series, &index), 10);
    write_file("tall-012-type1-L85-7.wbr-wal", "what a crash left");
    assert_int_equal(next_number(&series, &index), 13);
    index = (struct wb_index){.n = 2, .entries = entries};
    assert_int_equal(next_number(&series, &index), 42);
    index.n = 3;
    assert_int_equal(next_number(&series, &index), 51);
}

static void digits_beside_the_number_are_reported_separately(void **state)
{
    (void)state;
    const struct wb_series series = series_of("output: '5{number}6.wbr'\n");
    const struct wb_index index = {0};
    write_file("5126.wbr", "x");
    assert_int_equal(next_number(&series, &index), 13);
    const struct wb_series wide = series_of("output: '{sample}-{number:03}.wbr'\n");
    write_file("700-004.wbr", "x");
    assert_int_equal(next_number(&wide, &index), 5);
}

static void sample_is_done_unless_its_tests_are_to_be_repeated(void **state)
{
    (void)state;
    const struct wb_series series = series_of("first_sample: 2\n");
    struct wb_index_entry entries[] = {
        {.file = "a", .series = "tall", .sample = 2},
        {.file = "b", .series = "other", .sample = 3},
        {.file = "c", .series = "tall", .sample = 4, .excluded = {.is_excluded = true}},
        {.file = "d",
         .series = "tall",
         .sample = 3,
         .excluded = {.is_excluded = true, .is_repeated = true}},
        {.file = "e", .series = "tall", .sample = 3},
    };
    struct wb_index index = {0};
    int n_done;
    assert_int_equal(wb_series_next_sample(&series, &index, &n_done), 2);
    assert_int_equal(n_done, 0);
    index = (struct wb_index){.n = 4, .entries = entries};
    assert_int_equal(wb_series_next_sample(&series, &index, &n_done), 3);
    assert_int_equal(n_done, 2);
    index.n = 5;
    assert_int_equal(wb_series_next_sample(&series, &index, &n_done), 0);
    assert_int_equal(n_done, 3);
}

static void recordings_without_a_decision_are_found_in_order(void **state)
{
    (void)state;
    const struct wb_series series = series_of("");
    struct wb_index_entry entries[] = {{.file = "tall-002-type1-L85-2.wbr"}};
    const struct wb_index index = {.n = 1, .entries = entries};
    char file[WB_SERIES_FILE] = "";
    static const char *const files[] = {"tall-003-type1-L85-3.wbr", "tall-001-type1-L85-1.wbr",
                                        "tall-002-type1-L85-2.wbr", "tall-004-type1-L85-4.wbr-wal",
                                        "tall-005-type1-L85-5.png"};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++)
        write_file(files[i], "x");
    int number = 1;
    assert_int_equal(wb_series_find_unlisted(&series, folder, &index, &number, file), WB_OK);
    assert_int_equal(number, 1);
    assert_string_equal(file, files[1]);
    number = 2;
    assert_int_equal(wb_series_find_unlisted(&series, folder, &index, &number, file), WB_OK);
    assert_int_equal(number, 3);
    assert_string_equal(file, files[0]);
    number = 4;
    assert_int_equal(wb_series_find_unlisted(&series, folder, &index, &number, file), WB_OK);
    assert_int_equal(number, 0);
}

#define FACT(name) cmocka_unit_test_setup_teardown(name, set_up, remove_folder)

int main(void)
{
    const struct CMUnitTest tests[] = {
        FACT(file_gives_specimens_and_settings_of_the_tests),
        FACT(wrong_entry_is_rejected_with_its_line),
        FACT(names_follow_the_template),
        FACT(specimen_is_like_the_file_but_for_its_sample_and_the_answers),
        FACT(number_is_above_all_that_were_ever_used),
        FACT(digits_beside_the_number_are_reported_separately),
        FACT(sample_is_done_unless_its_tests_are_to_be_repeated),
        FACT(recordings_without_a_decision_are_found_in_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
