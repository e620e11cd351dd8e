/* Settings wherever they may be given: the command line, YAML files, --help and the documents agree
 * with the rows on range and default. WIREBENCH_SOURCE_ROOT names the sources. */
#include <ctype.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>
#include <wordexp.h>

#include "analysis/align/align.h"
#include "analysis/calibration/constituents/layers.h"
#include "analysis/calibration/constituents/tensile.h"
#include "analysis/calibration/constituents/tensile_material.h"
#include "analysis/calibration/cycle/cycle_calibrate.h"
#include "analysis/calibration/paper/calibrate.h"
#include "analysis/calibration/three_point/machine_compliance.h"
#include "analysis/calibration/three_point/three_point_calibrate.h"
#include "analysis/cards/card.h"
#include "analysis/import/mocap_import.h"
#include "analysis/report/campaign.h"
#include "analysis/solve/solve_settings.h"
#include "base/file.h"
#include "base/setting_private.h"
#include "cli/bench_options.h"
#include "cli/command.h"
#include "daq/test/bend_test.h"
#include "fe/model/bundle_override.h"
#include "tests/cli/tool.h"
#include "tests/messages.h"

/* Arguments that end in a missing file: exit code 1 after the options have been parsed. */
static const struct command {
    const char *name, *arguments, *section;
    const struct wb_setting_table *tables;
    size_t n_tables;
    unsigned place;
} commands[] = {
    {"record", "none.yaml --specimen none.yaml -o none.wbr", "record", &wb_bend_test_table, 1, 0},
    {"stage", "none.yaml home", "stage", &wb_bench_options_stage, 1, 0},
    {"record", "none.yaml --specimen none.yaml --virtual -o none.wbr", "rig",
     &wb_bench_options_virtual, 1, 0},
    {"rig", "none.yaml --specimen none.yaml --run none", "rig", &wb_bench_options_rig, 1, 0},
    {"rig", "none.yaml --specimen none.yaml --run none", "rig", &wb_bench_options_virtual, 1, 0},
    {"replay", "none.wbr", "replay", &wb_bench_options_replay, 1, 0},
    {"align", "none.wbr -o none", "align", &wb_align_table, 1, 0},
    {"import mocap", "none.csv --specimen none --rig none -o none.wbr", "import",
     &wb_mocap_import_table, 1, 0},
    {"calibrate", "none", "calibrate", &wb_calibrate_table, 1, WB_CALIBRATE_COMMAND},
    {"calibrate", "none", "calibrate", wb_cycle_calibrate_tables, WB_CYCLE_CALIBRATE_TABLES, 0},
    {"calibrate --tensile", "none", "calibrate --tensile", &wb_tensile_table, 1, 1},
    {"calibrate --tensile", "none", "calibrate --tensile", &wb_tensile_material_table, 1, 1},
    {"calibrate --compliance", "none --rigidity-n-mm2 1", "calibrate --compliance",
     &wb_machine_compliance_table, 1, 1},
    {"calibrate --constituents",
     "--conductor ./none --jacket none --conductor-diameter-mm 1 --outer-diameter-mm 1",
     "calibrate --constituents", &wb_layers_table, 1, 1},
    {"calibrate", "none", "calibrate", wb_three_point_calibrate_tables,
     WB_THREE_POINT_CALIBRATE_TABLES, 0},
    {"export --to mujoco", "none.yaml", "export --to", &wb_card_table, 1, 0},
    {"validate", "none.yaml none", "validate", &wb_calibrate_table, 1, WB_CALIBRATE_VALIDATE},
    {"validate", "none.yaml none", "validate", wb_three_point_calibrate_tables,
     WB_THREE_POINT_CALIBRATE_TABLES, WB_CALIBRATE_VALIDATE},
    {"solve cantilever", "--wire ./none --length-mm 1 --deflection-mm 1", "solve",
     &wb_solve_settings_table, 1, WB_SOLVE_CANTILEVER},
    {"solve bending3p", "./none.yaml --span-mm 1 --deflection-mm 1", "solve",
     &wb_solve_settings_table, 1, WB_SOLVE_THREE_POINT},
    {"solve wire3d", "./none.yaml", "solve", &wb_solve_settings_table, 1, WB_SOLVE_WIRE3D},
    {"solve wire1d", "./none.yaml", "solve", &wb_solve_settings_table, 1, WB_SOLVE_WIRE1D},
    {"solve bundle", "./none.yaml --vtk none --checkpoint none", "solve", &wb_solve_settings_table,
     1, WB_SOLVE_BUNDLE},
    {"solve bundle", "./none.yaml", "solve", wb_bundle_override_tables, WB_BUNDLE_OVERRIDE_TABLES,
     0},
};

static const struct {
    const char *name;
    int (*run)(int argc, char **argv);
} functions[] = {
    {"align", wb_cmd_align},       {"calibrate", wb_cmd_calibrate},
    {"export", wb_cmd_export},     {"import", wb_cmd_import},
    {"record", wb_cmd_record},     {"replay", wb_cmd_replay},
    {"report", wb_cmd_report},     {"rig", wb_cmd_rig},
    {"solve", wb_cmd_solve},       {"stage", wb_cmd_stage},
    {"validate", wb_cmd_validate},
};

/* Ends a fork without the destructors of all libraries, which cost more than the command. */
static void leave(int status, void *unused)
{
    (void)unused;
    fflush(NULL);
    _exit(status);
}

/* Calls the command's function in a fork, because wrong usage ends the process: a thousand starts
 * of the tool would take 40 s. The layout of --help is `help_format`, or the tool's own for NULL.
 */
static int run_formatted(const char *help_format, const char *arguments)
{
    wordexp_t words;
    size_t c = 0;
    int status;
    assert_int_equal(wordexp(arguments, &words, WRDE_NOCMD | WRDE_UNDEF), 0);
    while (c < WB_COUNT(functions) && strcmp(functions[c].name, words.we_wordv[0]) != 0)
        c++;
    if (c == WB_COUNT(functions))
        fail_msg("'%s' names no command of this test", arguments);
    fflush(NULL);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        if (chdir(folder) != 0 || !freopen("out", "w", stdout) || !freopen("err", "w", stderr) ||
            (help_format && setenv("ARGP_HELP_FMT", help_format, 1) != 0) ||
            on_exit(leave, NULL) != 0)
            abort();
        exit(functions[c].run((int)words.we_wordc, words.we_wordv));
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    wordfree(&words);
    if (!WIFEXITED(status))
        fail_msg("'%s' ended with status %d", arguments, status);
    o.code = WEXITSTATUS(status);
    read_all("out", o.out, sizeof o.out);
    read_all("err", o.err, sizeof o.err);
    return o.code;
}

/* With long lines of --help. */
static int run(const char *arguments)
{
    return run_formatted("rmargin=900", arguments);
}

/* --- values in and out of a row's range --- */

enum {
    VALUES = 4
};

struct value {
    char text[64];
    bool is_good;
};

static double step_beyond(const struct wb_setting *row, double end)
{
    return row->type == WB_SETTING_INTEGER ? 1.0 : end == 0.0 ? 1e-9 : 1e-6 * fabs(end);
}

/* Both ends of the range, and just beyond them. */
static void choose_values(const struct wb_setting *row, struct value values[VALUES])
{
    const double number[VALUES] = {row->least, row->largest,
                                   row->least - step_beyond(row, row->least),
                                   row->largest + step_beyond(row, row->largest)};
    for (int i = 0; i < VALUES; i++) {
        snprintf(values[i].text, sizeof values[i].text, "%.12g", number[i]);
        values[i].is_good = i < 2;
    }
}

/* The first member identifies a list. */
static const struct wb_setting *number_row(const struct wb_setting *row)
{
    if (row->type == WB_SETTING_LIST)
        return &row->members->rows[0];
    return row->type == WB_SETTING_NUMBER || row->type == WB_SETTING_INTEGER ? row : NULL;
}

/* --- the command line --- */

static void try_option(const struct command *command, const struct wb_setting *row,
                       const char *value, bool is_good)
{
    char arguments[512], expected[128];
    snprintf(arguments, sizeof arguments, "%s %s --%s='%s'", command->name, command->arguments,
             row->option, value);
    const int code = run(arguments);
    snprintf(expected, sizeof expected, "--%s: expected ", row->option);
    if (code != (is_good ? 1 : 2) || (strstr(o.err, expected) != NULL) == is_good)
        fail_msg("'%s': exit code %d, message '%s'", arguments, code, o.err);
}

/* The other members of a list that takes none alone. */
static void add_members(const struct wb_setting *row, char text[64])
{
    if (row->type != WB_SETTING_LIST || strchr(row->argument, '['))
        return;
    for (size_t i = 1; i < row->members->n; i++) {
        const size_t used = strlen(text);
        snprintf(text + used, 64 - used, "%c%g", row->separator, row->members->rows[i].least);
    }
}

static void try_options(const struct command *command, const struct wb_setting *row)
{
    struct value values[VALUES];
    const struct wb_setting *const number = number_row(row);
    if (number) {
        choose_values(number, values);
        for (int i = 0; i < VALUES; i++) {
            add_members(row, values[i].text);
            try_option(command, row, values[i].text, values[i].is_good);
        }
        if (row->zero)
            try_option(command, row, row->zero, true);
        try_option(command, row, "1,5", false);
        try_option(command, row, "1 mm", false);
    }
    if (row->type != WB_SETTING_CHOICE)
        return;
    for (int i = 0; row->choices[i]; i++)
        try_option(command, row, row->choices[i], true);
    try_option(command, row, "none of them", false);
}

/* Calls `look` for every row that has an option of every command. */
static void for_each_option(void (*look)(const struct command *, const struct wb_setting_table *,
                                         const struct wb_setting *))
{
    int n = 0;
    for (size_t c = 0; c < WB_COUNT(commands); c++)
        for (size_t t = 0; t < commands[c].n_tables; t++)
            for (size_t i = 0; i < commands[c].tables[t].n; i++) {
                const struct wb_setting *const row = &commands[c].tables[t].rows[i];
                if (!row->option || !wb_setting_applies(row, commands[c].place))
                    continue;
                look(&commands[c], &commands[c].tables[t], row);
                n++;
            }
    assert_true(n > 40);
}

static void look_at_range(const struct command *command, const struct wb_setting_table *table,
                          const struct wb_setting *row)
{
    (void)table;
    try_options(command, row);
}

static void command_lines_have_the_rows_ranges(void **unused)
{
    (void)unused;
    for_each_option(look_at_range);
}

/* Whether bundles have a row of their own for an option. */
static bool is_of_bundles(const char *option)
{
    for (size_t t = 0; t < WB_BUNDLE_OVERRIDE_TABLES; t++)
        for (size_t i = 0; i < wb_bundle_override_tables[t].n; i++)
            if (strcmp(wb_bundle_override_tables[t].rows[i].option, option) == 0)
                return true;
    return false;
}

/* What one kind of model has is refused by the others. */
static void options_of_other_kinds_are_rejected(void **unused)
{
    (void)unused;
    static const struct {
        const char *name;
        unsigned bit;
    } kinds[] = {{"cantilever", WB_SOLVE_CANTILEVER},
                 {"wire3d", WB_SOLVE_WIRE3D},
                 {"wire1d", WB_SOLVE_WIRE1D},
                 {"bundle", WB_SOLVE_BUNDLE},
                 {"bending3p", WB_SOLVE_THREE_POINT}};
    for (size_t k = 0; k < WB_COUNT(kinds); k++)
        for (size_t i = 0; i < wb_solve_settings_table.n; i++) {
            const struct wb_setting *const row = &wb_solve_settings_table.rows[i];
            char arguments[128], expected[128];
            if (wb_setting_applies(row, kinds[k].bit) ||
                (kinds[k].bit == WB_SOLVE_BUNDLE && is_of_bundles(row->option)))
                continue;
            snprintf(arguments, sizeof arguments, "solve %s none --%s%s", kinds[k].name,
                     row->option, row->type == WB_SETTING_BOOLEAN ? "" : "=1");
            snprintf(expected, sizeof expected, ", not to %s", kinds[k].name);
            if (run(arguments) != 2 || !strstr(o.err, expected) || !strstr(o.err, row->option))
                fail_msg("'%s': message '%s'", arguments, o.err);
        }
}

/* --- files --- */

static void campaigns_have_the_rows_ranges(void **unused)
{
    (void)unused;
    int n = 0;
    for (size_t i = 0; i < wb_calibrate_table.n; i++) {
        const struct wb_setting *const row = &wb_calibrate_table.rows[i];
        struct value values[VALUES];
        if (!wb_setting_applies(row, WB_CALIBRATE_CAMPAIGN) || !number_row(row))
            continue;
        choose_values(row, values);
        for (int k = 0; k < VALUES; k++, n++) {
            struct wb_calibrate_settings from_file, from_option;
            struct wb_config *config;
            char text[128], problem[WB_SETTING_PROBLEM];
            wb_calibrate_default_settings(&from_file);
            wb_calibrate_default_settings(&from_option);
            snprintf(text, sizeof text, "%.60s: %.60s\n", row->name, values[k].text);
            assert_int_equal(wb_config_parse(&config, text, "settings", NULL), WB_OK);
            keep_messages();
            const enum wb_status status =
                wb_campaign_read_settings(wb_config_root(config), &from_file);
            wb_log_set_sink(NULL, NULL);
            wb_config_destroy(config);
            if ((status == WB_OK) != values[k].is_good)
                fail_msg("'%s' has status %d", text, status);
            assert_true(wb_setting_parse(row, values[k].text, &from_option, problem) ==
                        values[k].is_good);
            assert_memory_equal(&from_file, &from_option, sizeof from_file);
        }
    }
    assert_true(n >= 20);
}

/* Whether a value of these lines of a bundle file is out of range. */
static bool is_out_of_range(const char *run, const char *interface)
{
    static struct wb_bundle_model model;
    char path[128];
    snprintf(path, sizeof path, "%s/bundle.yaml", folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file,
            "name: seven\nwires: [{wire: type3, count: 7}]\npacking: hexagon\nlength_mm: 114\n"
            "interface: {%s}\nloads: {strand_mm: 760, weight: true}\nrun: {%s}\n",
            interface, run);
    fclose(file);
    keep_messages();
    const enum wb_status status = wb_bundle_model_read(&model, path);
    wb_log_set_sink(NULL, NULL);
    if (status != WB_OK && !kept.last[0])
        fail_msg("no message about '%s'", run);
    return strstr(kept.last, "is out of range") != NULL;
}

/* The same in a campaign of bundles, for all its runs. */
static bool is_out_of_range_in_a_campaign(const char *setting)
{
    char path[128];
    snprintf(path, sizeof path, "%s/campaign.yaml", folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file,
            "kind: bundles\ntitle: T\ndefaults: {%s}\nruns: [{name: a, bundle: ./none.yaml}]\n"
            "groups: []\n",
            setting);
    fclose(file);
    assert_int_equal(run("report campaign.yaml -o report"), 1);
    return strstr(o.err, "is out of range") != NULL;
}

static void try_bundle(const struct wb_setting *row, bool is_run, bool is_overridden)
{
    struct value values[VALUES];
    const struct wb_setting *const number = number_row(row);
    if (!number)
        return;
    choose_values(number, values);
    for (int k = 0; k < VALUES; k++) {
        char setting[256], interface[512];
        snprintf(setting, sizeof setting, "%.60s: %.60s", row->name, values[k].text);
        snprintf(interface, sizeof interface, "%s%s%s", is_run ? "" : setting,
                 row->type == WB_SETTING_LIST ? ""
                 : is_run                     ? "friction: 0.4"
                                              : ", friction: 0.4",
                 row == wb_bundle_model_cohesion_setting ? "" : ", cohesive_stiffness_N_mm3: 30");
        if (is_out_of_range(is_run ? setting : "rows: 5", interface) == values[k].is_good)
            fail_msg("bundle file with '%s': message '%s'", setting, kept.last);
        if (is_overridden && is_out_of_range_in_a_campaign(setting) == values[k].is_good)
            fail_msg("campaign with '%s': message '%s'", setting, o.err);
    }
}

static void bundles_have_the_rows_ranges(void **unused)
{
    (void)unused;
    for (int i = 0; i < WB_BUNDLE_MODEL_RUN_SETTINGS; i++)
        try_bundle(&wb_bundle_model_run_settings[i], true,
                   wb_bundle_model_run_settings[i].option != NULL);
    try_bundle(wb_bundle_model_friction_setting, false, true);
    try_bundle(wb_bundle_model_cohesion_setting, false, true);
}

static void bundles_without_a_run_have_the_rows_defaults(void **unused)
{
    (void)unused;
    static struct wb_bundle_model model;
    char path[128];
    snprintf(path, sizeof path, "%s/plain.yaml", folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("name: seven\nwires: [{wire: type3, count: 7}]\npacking: hexagon\nlength_mm: 114\n"
          "interface: {cohesive_stiffness_N_mm3: 30, friction: 0.4}\n"
          "loads: {strand_mm: 760, weight: true}\n",
          file);
    fclose(file);
    assert_int_equal(wb_bundle_model_read(&model, path), WB_OK);
    for (int i = 0; i < WB_BUNDLE_MODEL_RUN_SETTINGS; i++) {
        const struct wb_setting *const row = &wb_bundle_model_run_settings[i];
        if (row->type == WB_SETTING_TEXT)
            assert_string_equal((const char *)&model.run + row->offset, row->otherwise);
        else
            assert_close_relative(wb_setting_value(row, &model.run), row->fallback, 1e-15);
    }
}

/* --- help and documents --- */

static void look_at_help(const struct command *command, const struct wb_setting_table *table,
                         const struct wb_setting *row)
{
    char arguments[128], option[128];
    struct wb_text text = {0};
    snprintf(arguments, sizeof arguments, "%s --help", command->name);
    assert_int_equal(run(arguments), 0);
    snprintf(option, sizeof option, "    --%s%s%s ", row->option, row->argument ? "=" : "",
             row->argument ? row->argument : "");
    wb_setting_describe(row, table->otherwise, &text);
    const char *const line = strstr(o.out, option);
    const char *const said = line ? strstr(line, wb_text_string(&text)) : NULL;
    if (!said || (size_t)(said - line) > strcspn(line, "\n"))
        fail_msg("'%s' does not say '%s...%s'", arguments, option, wb_text_string(&text));
    wb_text_release(&text);
}

static void help_has_range_and_default(void **unused)
{
    (void)unused;
    for_each_option(look_at_help);
}

/* --- rows --- */

/* The SI value of a row's unit; 1 without a unit. */
static double unit_value(const struct wb_setting *row)
{
    static const struct {
        const char *unit;
        double value;
    } units[] = {
        {"mm", 1e-3}, {"mm/s", 1e-3},  {"mm/N", 1e-3}, {"s", 1.0},    {"minutes", 60.0},
        {"N", 1.0},   {"mN", 1e-3},    {"MPa", 1e6},   {"%", 1e-2},   {"rad", 1.0},
        {"1/m", 1.0}, {"N mm2", 1e-6}, {"g/cm3", 1e3}, {"s/mm", 1e3}, {"N/mm3", 1e9},
    };
    if (!row->unit)
        return 1.0;
    for (size_t i = 0; i < WB_COUNT(units); i++)
        if (strcmp(units[i].unit, row->unit) == 0)
            return units[i].value;
    fail_msg("%s: the unit %s has no SI value in this test", row->name, row->unit);
    return 0.0;
}

static void look_at_row(const struct command *command, const struct wb_setting_table *table,
                        const struct wb_setting *row)
{
    (void)command;
    const double scale = row->scale == 0.0 ? 1.0 : row->scale;
    if (row->type == WB_SETTING_NUMBER && !(fabs(scale / unit_value(row) - 1.0) <= 1e-12))
        fail_msg("%s: one %s is %g, not %g", row->name, row->unit ? row->unit : "unit",
                 unit_value(row), scale);
    for (size_t i = 0; i < table->n; i++) {
        const struct wb_setting *const other = &table->rows[i];
        if (other != row && other->type != WB_SETTING_LIST && row->type != WB_SETTING_LIST &&
            other->offset == row->offset)
            fail_msg("%s and %s have the same field", row->name, other->name);
    }
}

static void rows_have_their_own_fields_and_the_scales_of_their_units(void **unused)
{
    (void)unused;
    for_each_option(look_at_row);
}

/* A line of blanks alone looks like the end of the options; argp leaves one after a help that just
 * fills its line. */
static void help_has_no_line_of_blanks(void **unused)
{
    (void)unused;
    for (size_t c = 0; c < WB_COUNT(commands); c++) {
        char arguments[128];
        snprintf(arguments, sizeof arguments, "%s --help", commands[c].name);
        run_formatted(NULL, arguments);
        for (const char *line = o.out; *line;) {
            const size_t length = strcspn(line, "\n");
            if (length > 0 && strspn(line, " ") == length)
                fail_msg("'%s' has a line of blanks before '%.60s'", arguments, line + length + 1);
            line += length + (line[length] == '\n');
        }
    }
}

/* A document, its line ends as blanks; those before paragraphs, items and headings stay. */
static char *read_document(const char *name)
{
    char path[WB_PATH], *text;
    const char *const root = getenv("WIREBENCH_SOURCE_ROOT");
    if (!root)
        fail_msg("WIREBENCH_SOURCE_ROOT is not set: run this test through meson");
    snprintf(path, sizeof path, "%s/docs/%s", root, name);
    assert_int_equal(wb_file_read(path, &text, NULL), WB_OK);
    char *to = text;
    for (const char *from = text; *from; from++) {
        const bool joins = *from == '\n' && isspace((unsigned char)from[1]) && from[1] != '\n';
        if (joins)
            from++;
        else
            *to++ = *from;
    }
    *to = '\0';
    return text;
}

/* Whether a line of a section begins so and holds what is expected, both up to its end. */
static bool has_line(const char *document, const char *heading, const char *begin,
                     const char *const *expected, int n)
{
    const char *const section = strstr(document, heading);
    const char *const next = section ? strstr(section + strlen(heading), "\n## ") : NULL;
    for (const char *line = section; line && *line && (!next || line < next);) {
        const size_t length = strcspn(line, "\n");
        char *const copy = strndup(line, length);
        bool holds = strncmp(copy, begin, strlen(begin)) == 0;
        for (int i = 0; i < n && holds; i++)
            holds = strstr(copy, expected[i]) != NULL;
        free(copy);
        if (holds)
            return true;
        line += length + (line[length] == '\n');
    }
    return false;
}

static char *manual;

static void look_at_manual(const struct command *command, const struct wb_setting_table *table,
                           const struct wb_setting *row)
{
    char heading[64], begin[128], range[WB_SETTING_VALUE], value[WB_SETTING_VALUE];
    char in_brackets[WB_SETTING_VALUE + 2] = "";
    const char *const expected[] = {range, in_brackets};
    snprintf(heading, sizeof heading, "\n## %s\n", command->section);
    snprintf(begin, sizeof begin, "* `--%s%s%s`", row->option, row->argument ? "=" : "",
             row->argument ? row->argument : "");
    wb_setting_range(row, range);
    wb_setting_default(row, table->otherwise, value);
    if (value[0])
        snprintf(in_brackets, sizeof in_brackets, "(%s)", value);
    if (!has_line(manual, heading, begin, expected, 2))
        fail_msg("docs/commands.md, %s: no item %s with '%s' and '%s'", command->section, begin,
                 range, in_brackets);
}

static void the_manual_has_range_and_default(void **unused)
{
    (void)unused;
    manual = read_document("commands.md");
    for_each_option(look_at_manual);
    free(manual);
}

static void find_in_formats(const char *formats, const char *heading, const struct wb_setting *row)
{
    char begin[128], range[WB_SETTING_VALUE], value[WB_SETTING_VALUE], cell[WB_SETTING_VALUE + 8];
    struct wb_setting plain = *row;
    const char *const expected[] = {range, cell};
    plain.unit = NULL; /* which has a column of its own */
    snprintf(begin, sizeof begin, "| `%s` | %s%s|", row->name, row->unit ? row->unit : "",
             row->unit ? " " : "");
    wb_setting_range(&plain, range);
    wb_setting_default(row, NULL, value);
    snprintf(cell, sizeof cell, value[0] ? "| %s |" : "|", value);
    if (row->type == WB_SETTING_CHOICE || row->type == WB_SETTING_TEXT)
        snprintf(cell, sizeof cell, "| `%s` |", value);
    if (row->type == WB_SETTING_BOOLEAN)
        snprintf(cell, sizeof cell, "| %s |", row->fallback != 0.0 ? "true" : "false");
    if (row->type == WB_SETTING_CHOICE)
        snprintf(range, sizeof range, "`%s`, `%s`", row->choices[0], row->choices[1]);
    if (!has_line(formats, heading, begin, expected, 2))
        fail_msg("docs/file-formats.md: no line '%s' with '%s' and '%s'", begin, range, cell);
}

static void the_formats_say_range_and_default(void **unused)
{
    (void)unused;
    char *const formats = read_document("file-formats.md");
    for (int i = 0; i < WB_BUNDLE_MODEL_RUN_SETTINGS; i++)
        find_in_formats(formats, "\n## Bundle files\n", &wb_bundle_model_run_settings[i]);
    find_in_formats(formats, "\n## Bundle files\n", wb_bundle_model_friction_setting);
    find_in_formats(formats, "\n## Bundle files\n", wb_bundle_model_cohesion_setting);
    for (size_t i = 0; i < wb_calibrate_table.n; i++) {
        if (wb_setting_applies(&wb_calibrate_table.rows[i], WB_CALIBRATE_CAMPAIGN))
            find_in_formats(formats, "\n## Campaign files\n", &wb_calibrate_table.rows[i]);
    }
    free(formats);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(command_lines_have_the_rows_ranges),
        cmocka_unit_test(options_of_other_kinds_are_rejected),
        cmocka_unit_test(campaigns_have_the_rows_ranges),
        cmocka_unit_test(bundles_have_the_rows_ranges),
        cmocka_unit_test(bundles_without_a_run_have_the_rows_defaults),
        cmocka_unit_test(rows_have_their_own_fields_and_the_scales_of_their_units),
        cmocka_unit_test(help_has_range_and_default),
        cmocka_unit_test(help_has_no_line_of_blanks),
        cmocka_unit_test(the_manual_has_range_and_default),
        cmocka_unit_test(the_formats_say_range_and_default),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
