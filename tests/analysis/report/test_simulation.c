/* The datasets of a campaign as the report's engine sees them: their names and commands, their
 * checkpoints, and why what was made of them failed. */
#include "tests/check.h"
#include "tests/messages.h"
#include "tests/own_folder.h"

#include "analysis/report/missing.h"
#include "analysis/report/reasons.h"
#include "base/file.h"
#include "base/log.h"

#define WB_LOG_DOMAIN "test"

static const struct wb_campaign campaign = {.simulations = "sim"};

static void the_command_is_whole_and_a_shell_takes_it(void **state)
{
    (void)state;
    struct wb_simulation one = {.wanted = false};
    char many[1500];
    memset(many, 'x', sizeof many);
    many[sizeof many - 1] = '\0';
    assert_int_equal(wb_simulation_find(&one, &campaign, "it's here"), WB_OK);
    struct wb_solve_settings settings = {.kind = WB_SOLVE_WIRE1D};
    wb_setting_fill(&wb_solve_settings_table, &settings);
    settings.model = "/on/this/machine";
    memcpy(many, "a$b;c", 5);
    wb_simulation_set(&one, &settings, many, wb_json_create());
    const char *const command = wb_text_string(&one.command);
    assert_non_null(strstr(command, "wirebench solve wire1d 'a$b;cxxx"));
    assert_non_null(strstr(command, "xxx' -o 'sim/it'\\''s here'"));
    assert_null(strstr(command, "machine"));
    assert_int_equal(command[strlen(command) - 1], '\'');
    wb_simulation_release(&one);
}

/* --- two datasets whose names have the same last part, one of them there --- */

static struct wb_simulation wanted[2];
static struct wb_simulation_result there[2] = {{.state = WB_SIMULATION_USABLE},
                                               {.state = WB_SIMULATION_MISSING}};

static bool list(const void *results, int index, struct wb_simulation_entry *entry)
{
    (void)results;
    if (index < 2)
        *entry = (struct wb_simulation_entry){
            .wanted = &wanted[index], .result = &there[index], .is_resumable = true};
    return index < 2;
}

static void name_checkpoint(char path[WB_PATH], int index)
{
    char name[200];
    snprintf(name, sizeof name, "r.jobs/%s-0123456789ab.checkpoint", wanted[index].log);
    assert_int_equal(wb_file_join(path, folder, name), WB_OK);
}

static void a_checkpoint_belongs_to_one_dataset_whatever_its_last_part(void **state)
{
    (void)state;
    static const char *const pairs[][2] = {{"seven", "old/seven"}, {"old/seven", "new/seven"}};
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        char report[WB_PATH], paths[2][WB_PATH];
        assert_int_equal(wb_file_join(report, folder, "r.jobs"), WB_OK);
        assert_int_equal(wb_file_make_folder(report), WB_OK);
        for (int k = 0; k < 2; k++) {
            assert_int_equal(wb_simulation_find(&wanted[k], &campaign, pairs[i][k]), WB_OK);
            name_checkpoint(paths[k], k);
            assert_int_equal(wb_file_write(paths[k], "x", 1), WB_OK);
        }
        assert_int_equal(wb_file_join(report, folder, "r"), WB_OK);
        wb_missing_remove_checkpoints(list, NULL, report);
        assert_false(wb_file_exists(paths[0]));
        assert_true(wb_file_exists(paths[1]));
    }
}

static void a_reason_names_the_dataset_and_not_a_path_of_the_machine(void **state)
{
    (void)state;
    const struct wb_reason none = {.text = ""}, why = {.text = "/on/this/machine: no section"};
    struct wb_text problem = {0};
    const struct wb_reasons reasons = {&problem, "/on/this/machine", "seven"};
    keep_messages();
    wb_reasons_fail(&reasons, WB_ERR_DATA, &why);
    assert_string_equal(wb_text_string(&problem), "seven: no section");
    wb_text_release(&problem);
    wb_reasons_fail(&reasons, WB_ERR_DATA, &none);
    assert_string_equal(wb_text_string(&problem), wb_status_text(WB_ERR_DATA));
    wb_text_release(&problem);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_command_is_whole_and_a_shell_takes_it),
        cmocka_unit_test(a_checkpoint_belongs_to_one_dataset_whatever_its_last_part),
        cmocka_unit_test(a_reason_names_the_dataset_and_not_a_path_of_the_machine),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
