#include "analysis/dataset/machine_import.h"
#include "analysis/dataset/machine_private.h"
#include "analysis/dataset/test_piece_private.h"

#include <stdlib.h>

#include "base/file.h"
#include "base/text.h"
#include "base/units.h"
#include "tests/check.h"
#include "tests/own_folder.h"
#include "tests/trials.h"

static struct wb_machine machine;
static struct wb_test_piece piece;
static struct wb_dataset dataset;
static struct wb_machine_import_report report;
static struct wb_reason why;

static void set_up(const char *machine_text, const char *piece_text)
{
    assert_int_equal(wb_machine_parse(machine_text, "m.yaml", &machine, NULL), WB_OK);
    assert_int_equal(wb_test_piece_parse(piece_text, "s.yaml", machine.kind, &piece, NULL), WB_OK);
}

static void set_up_rollers(void)
{
    set_up("name: rollers\nkind: three-point\nspan_mm: 12.8\nroller_radius_mm: 2\n",
           "wire: w\nouter_diameter_mm: 0.8\nsample: 3\nseries: b\n");
}

static enum wb_status import_bytes(const void *bytes, size_t n, const char *columns)
{
    const struct wb_machine_import from = {"t.txt", columns, NULL, &machine, &piece};
    wb_dataset_release(&dataset);
    memset(&why, 0, sizeof why);
    return wb_machine_import(&dataset, bytes, n, &from, &report, &why);
}

static enum wb_status import(const char *text, const char *columns)
{
    return import_bytes(text, strlen(text), columns);
}

static void assert_why(const char *part)
{
    if (!strstr(why.text, part))
        fail_msg("'%s' does not say '%s'", why.text, part);
}

static void values_arrive_in_si_and_the_rest_is_counted(void **state)
{
    (void)state;
    set_up_rollers();
    assert_int_equal(import("Time (s)\tLoad (mN)\tWay\n"
                            "0.0\t\t\n0.1\t1\t0.01\n0.2\t2\t0.02\n0.3\t3\t\n0.4\t\t0.04\n"
                            "\t5\t0.05\n0.6\t6\t0.06\n\n0.7\t7\t0.07\n0.8\t8\t0.08\n",
                            "time=1,force=2,travel=3:mm"),
                     WB_OK);
    assert_int_equal(report.lines, 11);
    assert_int_equal(report.rows, 5);
    assert_int_equal(report.empty, 2);
    assert_int_equal(report.partial, 3);
    assert_int_equal(report.without_travel, 1);
    assert_int_equal(report.without_force, 1);
    assert_int_equal(report.without_time, 1);
    assert_int_equal(dataset.n_rows, 5);
    assert_close_relative(dataset.rows[4].force, 8e-3, 1e-14);
    assert_close_relative(dataset.rows[4].tension, 8e-3, 1e-14);
    assert_close_relative(dataset.rows[4].deflection, 8e-5, 1e-14);
    assert_close_relative(dataset.rows[4].t, 0.8, 1e-14);
    assert_int_equal(dataset.info.kind, WB_TEST_THREE_POINT);
    assert_close_relative(dataset.info.length, 12.8e-3, 1e-14);
    assert_int_equal(dataset.info.sample, 3);
    assert_string_equal(dataset.info.piece.series, "b");
}

static void a_machine_that_counts_downwards_is_turned(void **state)
{
    (void)state;
    set_up_rollers();
    assert_int_equal(import("Load (N)\tTravel (mm)\n0\t0\n-1\t-1\n-2\t-2\n-3\t-3\n-4\t-4\n", NULL),
                     WB_OK);
    assert_close(dataset.rows[4].force, 4.0, 0.0);
    assert_close(dataset.rows[4].deflection, 4e-3, 1e-15);
    assert_true(isnan(dataset.rows[0].t));
    bool turned = false;
    const struct wb_json *const from = wb_json_get(dataset.document, "import");
    assert_true(wb_json_get_boolean(from, "travel_turned", &turned) && turned);
    assert_true(wb_json_get_boolean(from, "force_turned", &turned) && turned);
}

static void cycles_and_phases_are_cut_at_the_turns(void **state)
{
    (void)state;
    struct wb_text text = {0};
    set_up_rollers();
    wb_text_append(&text, "Time (s)\tLoad (N)\tTravel (mm)\n");
    /* Up and down twice, with a tremble of the travel that is no turn. */
    for (int i = 0; i <= 400; i++) {
        const int k = i % 200;
        const double x = (k <= 100 ? k : 200 - k) + (i % 2 ? 0.5 : 0.0);
        wb_text_append(&text, "%g\t%g\t%g\n", 0.1 * i, 0.01 * x, 0.1 * x);
    }
    assert_int_equal(import(wb_text_string(&text), NULL), WB_OK);
    static const struct {
        size_t row;
        int cycle;
        enum wb_phase phase;
    } expected[] = {
        {0, 1, WB_PHASE_LOAD},     {99, 1, WB_PHASE_LOAD},    {105, 1, WB_PHASE_UNLOAD},
        {195, 1, WB_PHASE_UNLOAD}, {205, 2, WB_PHASE_LOAD},   {299, 2, WB_PHASE_LOAD},
        {305, 2, WB_PHASE_UNLOAD}, {400, 2, WB_PHASE_UNLOAD},
    };
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) {
        assert_int_equal(dataset.rows[expected[i].row].cycle, expected[i].cycle);
        assert_int_equal(dataset.rows[expected[i].row].phase, expected[i].phase);
    }
    wb_text_release(&text);
}

static void strain_of_an_extensometer_times_the_gauge_length_is_the_elongation(void **state)
{
    (void)state;
    static const char text[] =
        "Load (N)\tExtension (mm)\tStrain (%)\n0\t0\t0\n1\t1\t0.2\n2\t2\t0.4\n"
        "3\t3\t0.6\n4\t4\t0.8\n";
    char yaml[128];
    for (int own = 0; own < 2; own++) {
        snprintf(yaml, sizeof yaml, "name: t\nkind: tensile\ngauge_length_mm: 50\nelongation: %s\n",
                 own ? "extensometer" : "crosshead");
        set_up(yaml, "wire: w\nsample: 1\nconstituent: conductor\narea_mm2: 0.326\n");
        assert_int_equal(import(text, NULL), WB_OK);
        assert_close_relative(dataset.rows[4].deflection, own ? 0.008 * 0.05 : 4e-3, 1e-12);
    }
}

static void a_cantilever_needs_time_or_speed(void **state)
{
    (void)state;
    static const char text[] = "Load (N)\tTravel (mm)\n1\t1\n2\t2\n3\t3\n4\t5\n5\t6\n";
    static const char specimen[] = "wire: type1\nsample: 1\nlength_mm: 85\n";
    set_up("name: c\nkind: cantilever\nbends: down\n", specimen);
    assert_int_equal(import(text, NULL), WB_ERR_DATA);
    assert_why("t.txt: no column of the time");
    set_up("name: c\nkind: cantilever\nbends: down\nspeed_mm_s: 2\n", specimen);
    assert_int_equal(import(text, NULL), WB_OK);
    assert_close_relative(dataset.rows[4].t, 2.5, 1e-12);
    assert_close(dataset.rows[0].force, 0.0, 0.0);
    assert_close(dataset.rows[4].force, 4.0, 1e-15);
    assert_close(dataset.info.gravity, -WB_STANDARD_GRAVITY, 0.0);
    assert_int_equal(dataset.info.kind, WB_TEST_CANTILEVER);
}

static void unusable_tables_are_rejected(void **state)
{
    (void)state;
    static const struct {
        const char *text, *expected;
    } cases[] = {
        {"Load (N)\tTravel (mm)\n1\t1\n2\t2\n3\t3\n4\t4\n", "4 whole rows in 5 lines"},
        {"Load (N)\tTravel (mm)\n1\t1\n1\t2\n1\t3\n1\t4\n1\t5\n", "the force is constant"},
        {"Load (N)\tTravel (mm)\n1\t1\n2\t1\n3\t1\n4\t1\n5\t1\n", "the travel is constant"},
        {"Load (N)\tTravel (mm)\tt (s)\n1\t1\t1\n2\t2\t2\n3\t3\t1.5\n4\t4\t3\n5\t5\t4\n",
         "t.txt:4: column 3: time goes back from 2 s to 1.5 s"},
        {"Load (N)\tTime (s)\n1\t1\n2\t2\n3\t3\n4\t4\n5\t5\n", "no column of the travel"},
        {"Load (N)\tTravel (mm)\n1\t1\n2\t2\n3\tx\n4\t4\n5\t5\n6\t6\n",
         "t.txt:4: column 2 'Travel (mm)': expected a number, not 'x'"},
    };
    set_up_rollers();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        if (import(cases[i].text, NULL) == WB_OK)
            fail_msg("case %zu is not rejected", i);
        assert_why(cases[i].expected);
    }
}

static void pauses_and_cut_ends_make_it_incomplete(void **state)
{
    (void)state;
    static const struct {
        const char *end;
        bool complete;
    } cases[] = {
        {"0.6\t6\t6\n", true}, {"0.6\t6\t6", true}, {"0.6\t6", false}, {"9\t6\t6\n", false}};
    set_up_rollers();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[256];
        snprintf(text, sizeof text,
                 "t (s)\tLoad (N)\tTravel (mm)\n0.1\t1\t1\n0.2\t2\t2\n0.3\t3\t3\n0.4\t4\t4\n"
                 "0.5\t5\t5\n%s",
                 cases[i].end);
        assert_int_equal(import(text, NULL), WB_OK);
        assert_int_equal(wb_dataset_is_complete(&dataset), cases[i].complete);
    }
}

static void a_written_dataset_reads_back_with_its_original(void **state)
{
    (void)state;
    static const char text[] = "Load (N)\tTravel (mm)\n0\t0\n1\t1\n2\t2\n3\t3\n4\t4\n";
    char path[WB_PATH];
    struct wb_dataset back;
    set_up_rollers();
    assert_int_equal(import(text, NULL), WB_OK);
    assert_int_equal(wb_file_join(path, folder, "d"), WB_OK);
    assert_int_equal(wb_machine_import_write(&dataset, text, strlen(text), path, false), WB_OK);
    /* A reader that asks for nothing else gets cantilevers only. */
    memset(&why, 0, sizeof why);
    assert_int_equal(wb_dataset_read(&back, path, &why), WB_ERR_UNSUPPORTED);
    assert_why("is a three-point test: a cantilever test is expected here");
    assert_int_equal(wb_dataset_read_kinds(&back, path, WB_TEST_BIT(WB_TEST_THREE_POINT), &why),
                     WB_OK);
    assert_int_equal(back.n_rows, 5);
    assert_close_relative(back.info.machine.span, 12.8e-3, 1e-14);
    assert_close_relative(back.info.machine.roller_radius, 2e-3, 1e-14);
    assert_false(back.info.machine.nose_radius.known);
    assert_string_equal(back.info.piece.series, "b");
    assert_true(isnan(back.rows[0].t));
    assert_true(back.rows[3].deflection == dataset.rows[3].deflection);
    wb_dataset_release(&back);
    assert_int_equal(wb_file_join(path, folder, "d/original.zst"), WB_OK);
    assert_true(wb_file_exists(path));
}

/* --- mutations --- */

static uint64_t seed = 88172645463325252u;

static unsigned below(unsigned n)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return (unsigned)(seed >> 33) % n;
}

enum {
    ROWS = 40,
    FIELDS = 3,
    MOST = 4096
};

/* Row i of the sound table: time, load, travel. No two numbers of the table are the same text. */
static void fill_cells(char cells[ROWS + 1][FIELDS][24])
{
    static const char *const names[FIELDS] = {"Time (s)", "Load (N)", "Travel (mm)"};
    for (int k = 0; k < FIELDS; k++)
        strcpy(cells[0][k], names[k]);
    for (int i = 1; i <= ROWS; i++) {
        snprintf(cells[i][0], 24, "%.3f", 0.1 * i);
        snprintf(cells[i][1], 24, "%.4f", 0.002 * i + 0.0001 * i * i);
        snprintf(cells[i][2], 24, "%.4f", 0.0503 * i);
    }
}

/* Whether a row of the dataset is a row of the sound table, or differs in the decimal sign only. */
static bool is_sound(char cells[ROWS + 1][FIELDS][24], const struct wb_row *row)
{
    for (int i = 1; i <= ROWS; i++) {
        if (fabs(row->t - atof(cells[i][0])) < 1e-9 &&
            fabs(row->force - atof(cells[i][1])) < 1e-9 &&
            fabs(row->deflection - WB_MM * atof(cells[i][2])) < 1e-12)
            return true;
    }
    return false;
}

/* One mutated file; returns its size. `*exact` is cleared where numbers themselves are changed. */
static size_t mutate(char bytes[MOST * 2], bool *exact)
{
    static char cells[ROWS + 1][FIELDS][24];
    static const char *const words[] = {"",    "stop", "0.1.2", "1e999", "\"",
                                        "1 2", "\t",   ";",     "NaN",   "0x10",
                                        "-",   "1,5",  "\xff",  "\x01",  "Load (N)"};
    static const char *const separators[] = {"\t", ";", ",", " ", "|", "\t\t", ", "};
    static const char *const ends[] = {"\n", "\r\n", "\r", "\r\r\n", "\n\n"};
    struct wb_text text = {0};
    const char *separator = separators[below(3)], *end = ends[below(2)];
    int order[2 * ROWS + 2], n = 0;
    int odd_row = -1, odd_column = 0, cut = -1, encoding = 0, more = -1;
    const char *word = NULL, *odd_separator = NULL;
    fill_cells(cells);
    *exact = true;
    for (int i = 0; i <= ROWS; i++)
        order[n++] = i;
    for (unsigned times = 1 + below(2); times > 0; times--) {
        switch (below(12)) {
        case 0: { /* a row is gone */
            const int at = (int)below((unsigned)n);
            memmove(order + at, order + at + 1, (size_t)(--n - at) * sizeof order[0]);
            break;
        }
        case 1: { /* two rows change places */
            const int a = (int)below((unsigned)n), b = (int)below((unsigned)n), kept = order[a];
            order[a] = order[b];
            order[b] = kept;
            break;
        }
        case 2: /* a row stands twice */
            order[n] = order[(int)below((unsigned)n)];
            n++;
            break;
        case 3:
            separator = separators[below(7)];
            break;
        case 4:
            end = ends[below(5)];
            break;
        case 5: /* another word in a field */
            odd_row = (int)below((unsigned)n);
            odd_column = (int)below(FIELDS);
            word = words[below(15)];
            *exact = false;
            break;
        case 6: /* one other separator */
            odd_row = (int)below((unsigned)n);
            odd_column = (int)below(FIELDS);
            odd_separator = separators[below(7)];
            *exact = false;
            break;
        case 7: /* decimal commas in all rows, or in one */
            for (int i = 1 + (int)below(ROWS), all = (int)below(2); i <= ROWS && i > 0;
                 i = all ? i - 1 : 0) {
                for (int k = 0; k < FIELDS; k++) {
                    char *const point = strchr(cells[i][k], '.');
                    if (point)
                        *point = ',';
                }
            }
            *exact = false;
            break;
        case 8:
            cut = (int)below(MOST / 4);
            break;
        case 9:
            encoding = 1 + (int)below(4);
            break;
        case 10: /* a column is gone, or there is one more */
            more = (int)below(4);
            *exact = false;
            break;
        default: /* fields of a row are gone */
            odd_row = (int)below((unsigned)n);
            odd_column = (int)below(FIELDS);
            word = "";
            break;
        }
    }
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < FIELDS; k++) {
            const bool odd = i == odd_row && k == odd_column;
            if (more == k)
                continue;
            wb_text_append(&text, "%s%s", odd && word ? word : cells[order[i]][k],
                           k + 1 == FIELDS        ? ""
                           : odd && odd_separator ? odd_separator
                                                  : separator);
        }
        wb_text_append(&text, "%s%s", more == FIELDS ? separator : "", end);
    }
    size_t size = text.length < MOST - 8 ? text.length : MOST - 8, m = 0;
    if (encoding == 1) {
        memcpy(bytes, "\xef\xbb\xbf", 3);
        m = 3;
    } else if (encoding >= 3) {
        memcpy(bytes, encoding == 3 ? "\xff\xfe" : "\xfe\xff", 2);
        m = below(2) ? 2 : 0;
    }
    for (size_t i = 0; i < size; i++) {
        if (encoding == 4)
            bytes[m++] = 0;
        bytes[m++] = text.bytes[i];
        if (encoding == 3)
            bytes[m++] = 0;
    }
    if (cut >= 0 && (size_t)cut < m)
        m = (size_t)cut;
    wb_text_release(&text);
    return m;
}

static void mutations_end_in_a_refusal_or_in_rows_that_are_sound_and_counted(void **state)
{
    (void)state;
    static char bytes[2 * MOST];
    static char cells[ROWS + 1][FIELDS][24];
    int refused = 0, taken = 0;
    set_up_rollers();
    fill_cells(cells);
    for (int i = 0; i < 1000; i++) {
        bool exact;
        const size_t n = mutate(bytes, &exact);
        const enum wb_status status = import_bytes(bytes, n, NULL);
        if (status != WB_OK) {
            assert_true(status == WB_ERR_FORMAT || status == WB_ERR_DATA);
            assert_why("t.txt");
            refused++;
            continue;
        }
        taken++;
        assert_int_equal(report.rows, dataset.n_rows);
        /* Every line below the header is a row that was taken, or is counted. */
        int64_t header = 0;
        bool no_end = false;
        const struct wb_json *const from = wb_json_get(dataset.document, "import");
        assert_true(wb_json_get_integer(from, "header_line", &header));
        assert_true(wb_json_get_boolean(from, "last_line_has_no_end", &no_end));
        assert_int_equal(report.rows + report.empty + report.partial,
                         report.lines - (size_t)header);
        for (size_t k = 0; exact && k < dataset.n_rows; k++) {
            if (!is_sound(cells, &dataset.rows[k]) && !(no_end && k + 1 == dataset.n_rows))
                fail_msg("mutation %d: row %zu holds what the file does not", i, k);
        }
    }
    /* Both happen often. */
    assert_true(refused > 150 && taken > 150);
    count_trials("Curves of testing machines with rows, columns, separators and encodings changed",
                 1000, "files: %d refused, %d taken with every line accounted for", refused, taken);
}

static int finish(void **state)
{
    wb_dataset_release(&dataset);
    return remove_folder(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_arrive_in_si_and_the_rest_is_counted),
        cmocka_unit_test(a_machine_that_counts_downwards_is_turned),
        cmocka_unit_test(cycles_and_phases_are_cut_at_the_turns),
        cmocka_unit_test(strain_of_an_extensometer_times_the_gauge_length_is_the_elongation),
        cmocka_unit_test(a_cantilever_needs_time_or_speed),
        cmocka_unit_test(unusable_tables_are_rejected),
        cmocka_unit_test(pauses_and_cut_ends_make_it_incomplete),
        cmocka_unit_test(a_written_dataset_reads_back_with_its_original),
        cmocka_unit_test(mutations_end_in_a_refusal_or_in_rows_that_are_sound_and_counted),
    };
    return cmocka_run_group_tests(tests, make_folder, finish);
}
