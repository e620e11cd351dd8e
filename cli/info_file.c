/* wirebench info: the kind of a file, what it contains where that is short, and the next command.
 */
#include <stdio.h>

#include "analysis/calibration/properties/properties.h"
#include "analysis/quicklook.h"
#include "base/config.h"
#include "cli/finding.h"
#include "cli/info.h"
#include "cli/print.h"

#define WB_LOG_DOMAIN "info"

static enum wb_status print_properties(const char *path, struct wb_json *root)
{
    static struct wb_properties properties;
    WB_TRY(wb_properties_read(path, &properties));
    if (root) {
        wb_json_set_text(root, "wire", properties.wire);
        wb_json_set_boolean(root, "virtual_rig", properties.is_virtual);
        wb_json_set_boolean(root, "simulation", properties.is_simulation);
        return WB_OK;
    }
    printf("wire %s (%s), %d specimen%s\n", properties.wire,
           wb_finding_properties_source(&properties), properties.n_samples,
           properties.n_samples == 1 ? "" : "s");
    wb_print_quantities(&properties, "candidates");
    return WB_OK;
}

/* Of what a calibration of cantilevers and three-point tests cannot use. */
static void append_next_of(struct wb_text *next, const struct wb_test_info *info, const char *path)
{
    if (info->kind == WB_TEST_TENSILE)
        wb_finding_append_command(next, "wirebench calibrate --tensile %s", path);
    else if (info->is_follower)
        wb_finding_append_command(next, "wirebench validate PROPERTIES.yaml %s", path);
}

/* `next` receives what to do with the dataset where this depends on its contents. */
static enum wb_status print_dataset(const char *path, struct wb_json *root, struct wb_text *next)
{
    const unsigned tests = WB_TEST_BIT(WB_TEST_CANTILEVER) | WB_TEST_BIT(WB_TEST_THREE_POINT) |
                           WB_TEST_BIT(WB_TEST_TENSILE);
    struct wb_dataset dataset;
    struct wb_text text = {0};
    WB_TRY(wb_dataset_read_kinds(&dataset, path, tests, NULL));
    if (root) {
        wb_quicklook_describe(&dataset, root);
    } else {
        wb_quicklook_summary(&dataset, &text);
        printf("%s\n", wb_text_string(&text));
    }
    append_next_of(next, &dataset.info, path);
    wb_text_release(&text);
    wb_dataset_release(&dataset);
    return WB_OK;
}

/* Whether it is a YAML file that cannot be parsed, which is reported. */
static bool has_syntax_error(const char *path)
{
    struct wb_config *config;
    if (!wb_command_ends_in(path, ".yaml") && !wb_command_ends_in(path, ".yml"))
        return false;
    if (wb_config_read(&config, path, NULL) != WB_OK)
        return true;
    wb_config_destroy(config);
    return false;
}

int wb_info_file(const struct wb_info_options *options, enum wb_file_kind kind)
{
    const char *const path = options->common.input;
    struct wb_text next = {0};
    enum wb_status status = WB_OK;
    if (!wb_file_exists(path)) {
        wb_error("'%s' does not exist", path);
        return WB_EXIT_FAILED;
    }
    if (kind == WB_FILE_UNKNOWN) {
        if (!has_syntax_error(path))
            wb_error("'%s' is of unknown kind: expected a file or folder that a command reads or "
                     "writes, see file-formats.md",
                     path);
        return WB_EXIT_FAILED;
    }
    struct wb_json *const root = options->common.json ? wb_json_create() : NULL;
    if (root) {
        wb_json_set_text(root, "file", path);
        wb_json_set_text(root, "kind", wb_file_kind_key(kind));
    } else {
        printf("%s: %s\n", path, wb_file_kind_name(kind));
    }
    if (kind == WB_FILE_PROPERTIES)
        status = print_properties(path, root);
    else if (kind == WB_FILE_DATASET)
        status = print_dataset(path, root, &next);
    if (next.length == 0)
        wb_file_kind_append_next(&next, kind, path);
    if (status != WB_OK) {
        wb_json_destroy(root);
    } else if (root) {
        wb_json_set_text(root, "next", wb_text_string(&next));
        wb_command_print_json(root);
    } else {
        printf("next    %s\n", wb_text_string(&next));
    }
    wb_text_release(&next);
    return wb_command_exit(status);
}
