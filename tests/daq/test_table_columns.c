#include "daq/take/table_columns.h"

#include <stdlib.h>

#include "base/units.h"
#include "tests/check.h"

static struct wb_text_table table;
static struct wb_table_columns columns;
static struct wb_reason why;

static enum wb_status find(const char *text, const char *list, unsigned needed)
{
    wb_text_table_release(&table);
    memset(&why, 0, sizeof why);
    assert_int_equal(wb_text_table_parse(&table, text, strlen(text), "t.txt", NULL, &why), WB_OK);
    return wb_table_columns_find(&columns, &table, list, needed, 9.81, "t.txt", &why);
}

enum {
    FORCE_AND_TRAVEL = WB_MEASURED_BIT(WB_MEASURED_FORCE) | WB_MEASURED_BIT(WB_MEASURED_TRAVEL)
};

static void assert_why(const char *part)
{
    if (!strstr(why.text, part))
        fail_msg("'%s' does not contain '%s'", why.text, part);
}

static void headers_of_many_programs_are_recognised(void **state)
{
    (void)state;
    static const struct {
        const char *header;
        int time, force, travel;
        double newtons, metres;
    } cases[] = {
        {"Time (s)\tLoad (N)\tMachine Extension (mm)", 0, 1, 2, 1.0, WB_MM},
        {"Load (N)\tMachine Extension (mm)\tExtension from Preload (mm)", -1, 0, 1, 1.0, WB_MM},
        {"Zeit [s]\tStandardkraft [mN]\tStandardweg [mm]", 0, 1, 2, 1e-3, WB_MM},
        {"t_s\tforce_mN\ttravel_um", 0, 1, 2, 1e-3, 1e-6},
        {"Kraft in kN\tWeg in cm\tPr\xc3\xbc"
         "fzeit in min",
         2, 0, 1, 1e3, 1e-2},
        {"Load / gf\tStroke / mm\tTime / ms", 2, 0, 1, WB_G * WB_STANDARD_GRAVITY, WB_MM},
        {"Force, g\tDisplacement, inch\tNo", -1, 0, 1, 9.81e-3, 0.0254},
        {"Load (\xc2\xb5N)\tPosition (\xce\xbc"
         "m)\tStress (MPa)",
         -1, 0, 1, 1e-6, 1e-6},
        {"Load\tTravel\tTime\n(N)\t(mm)\t(s)", 2, 0, 1, 1.0, WB_MM},
        {"Load\tTravel\tTime\nN\tmm\ts", 2, 0, 1, 1.0, WB_MM},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[256];
        snprintf(text, sizeof text, "%s\n1\t2\t3\n4\t5\t6\n", cases[i].header);
        if (find(text, NULL, FORCE_AND_TRAVEL) != WB_OK)
            fail_msg("case %zu: %s", i, why.text);
        assert_int_equal(columns.column[WB_MEASURED_TIME], cases[i].time);
        assert_int_equal(columns.column[WB_MEASURED_FORCE], cases[i].force);
        assert_int_equal(columns.column[WB_MEASURED_TRAVEL], cases[i].travel);
        assert_close_relative(columns.factor[WB_MEASURED_FORCE], cases[i].newtons, 1e-15);
        assert_close_relative(columns.factor[WB_MEASURED_TRAVEL], cases[i].metres, 1e-15);
    }
}

static void list_gives_columns_and_units(void **state)
{
    (void)state;
    double value;
    assert_int_equal(find("1\t2\t3\n4\t5\t\n6\t7\t8\n", "time=1:ms,force=2:mN,travel=3:mm", 0),
                     WB_OK);
    assert_int_equal(
        wb_table_columns_value(&columns, &table, 1, WB_MEASURED_TIME, &value, "t.txt", &why),
        WB_OK);
    assert_close_relative(value, 4e-3, 1e-15);
    assert_int_equal(
        wb_table_columns_value(&columns, &table, 1, WB_MEASURED_TRAVEL, &value, "t.txt", &why),
        WB_OK);
    assert_true(isnan(value));
    assert_int_equal(
        wb_table_columns_value(&columns, &table, 1, WB_MEASURED_STRAIN, &value, "t.txt", &why),
        WB_OK);
    assert_true(isnan(value));
    /* The header's unit is used if the list has none; the list's unit has priority. */
    assert_int_equal(find("A (N)\tB (mm)\n1\t2\n3\t4\n", "force=1:mN,travel=2", 0), WB_OK);
    assert_close_relative(columns.factor[WB_MEASURED_FORCE], 1e-3, 1e-15);
    assert_close_relative(columns.factor[WB_MEASURED_TRAVEL], 1e-3, 1e-15);
    assert_int_equal(columns.column[WB_MEASURED_TIME], -1);
}

static void ambiguous_lines_are_rejected(void **state)
{
    (void)state;
    static const struct {
        const char *text, *list, *expected;
    } cases[] = {
        {"Load (N)\tLoad (N)\n1\t2\n3\t4\n", NULL,
         "t.txt:1: columns 1 and 2 could both be the force"},
        {"Load\tTravel (mm)\n1\t2\n3\t4\n", NULL,
         "t.txt:1: column 1 has no unit: give it, as in --columns force=1:N"},
        {"1\t2\n3\t4\n", NULL, "--columns force=1:N; the columns are 2 without names"},
        {"Load (V)\tTravel (mm)\n1\t2\n3\t4\n", NULL, "no column of the force was found"},
        {"Load (N)\tTravel (mm)\n1\t2\n3\t4\n", "force=3",
         "force=3: this column does not exist; the columns are 1 'Load (N)', 2"},
        {"Load (N)\tTravel (mm)\n1\t2\n3\t4\n", "force=1:mm", "'mm' of column 1"},
        {"Load (N)\tTravel (mm)\n1\t2\n3\t4\n", "load=1", "not 'load'"},
        {"Load (N)\tTravel (mm)\n1\t2\n3\t4\n", "force=1,force=2", "force is given twice"},
        {"Load (N)\tTravel (mm)\n1\t2\n3\t4\n", "force=1", "no column of the travel was found"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        if (find(cases[i].text, cases[i].list, FORCE_AND_TRAVEL) == WB_OK)
            fail_msg("case %zu is not refused", i);
        assert_why(cases[i].expected);
    }
}

static void words_among_numbers_are_rejected_with_their_position(void **state)
{
    (void)state;
    double value;
    assert_int_equal(find("Load (N)\tTravel (mm)\n1\t2\n3\t4\n5\tstop\n", NULL, 0), WB_OK);
    assert_int_equal(
        wb_table_columns_value(&columns, &table, 2, WB_MEASURED_TRAVEL, &value, "t.txt", &why),
        WB_ERR_FORMAT);
    assert_why("t.txt:4: column 2 'Travel (mm)': expected a number, not 'stop'");
}

static int finish(void **state)
{
    (void)state;
    wb_text_table_release(&table);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(headers_of_many_programs_are_recognised),
        cmocka_unit_test(list_gives_columns_and_units),
        cmocka_unit_test(ambiguous_lines_are_rejected),
        cmocka_unit_test(words_among_numbers_are_rejected_with_their_position),
    };
    return cmocka_run_group_tests(tests, NULL, finish);
}
