/* wirebench info: the kind of a file, what it contains where that is short, and the next command.
 */
#include <stdio.h>

#include "analysis/calibration/properties/properties.h"
#include "analysis/quicklook.h"
#include "base/config.h"
#include "cli/info.h"
#include "cli/print.h"

#define WB_LOG_DOMAIN "info"

static enum wb_status print_properties(const char *path, struct wb_json *root)
{
    static struct wb_properties properties;
    WB_TRY(wb_properties_read(path, &properties));
    const char *const source = properties.is_virtual      ? "virtual rig"
                               : properties.is_simulation ? "simulation"
                                                          : "measured";
    if (root) {
        wb_json_set_text(root, "wire", properties.wire);
        wb_json_set_boolean(root, "virtual_rig", properties.is_virtual);
        wb_json_set_boolean(root, "simulation", properties.is_simulation);
        return WB_OK;
    }
    printf("wire %s (%s), %d specimen%s\n", properties.wire, source, properties.n_samples,
           properties.n_samples == 1 ? "" : "s");
    wb_print_quantities(&properties, "candidates");
    return WB_OK;
}

static enum wb_status print_dataset(const char *path, struct wb_json *root)
{
    const unsigned tests = WB_TEST_BIT(WB_TEST_CANTILEVER) | WB_TEST_BIT(WB_TEST_THREE_POINT) |
                           WB_TEST_BIT(WB_TEST_TENSILE);
    struct wb_dataset dataset;
    struct wb_text text = {0};
    WB_TRY(wb_dataset_read_kinds(&dataset, path, tests, NULL));
    enum wb_status status = WB_OK;
    if (root)
        wb_quicklook_describe(&dataset, root);
    else
        status = wb_quicklook_summary(&dataset, &text);
    if (status == WB_OK && !root)
        printf("%s\n", wb_text_string(&text));
    wb_text_release(&text);
    wb_dataset_release(&dataset);
    return status;
}

static enum wb_status print_contents(enum wb_file_kind kind, const char *path, struct wb_json *root)
{
    switch (kind) {
    case WB_FILE_PROPERTIES:
        return print_properties(path, root);
    case WB_FILE_DATASET:
        return print_dataset(path, root);
    default:
        return WB_OK;
    }
}

static int print_json(enum wb_file_kind kind, const char *path, const char *next)
{
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "file", path);
    wb_json_set_text(root, "kind", wb_file_kind_key(kind));
    wb_json_set_text(root, "next", next);
    if (print_contents(kind, path, root) != WB_OK) {
        wb_json_destroy(root);
        return WB_EXIT_FAILED;
    }
    return wb_command_print_json(root);
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
    int code = WB_EXIT_OK;
    if (!wb_file_exists(path)) {
        wb_error("'%s' does not exist", path);
        return WB_EXIT_FAILED;
    }
    if (kind == WB_FILE_UNKNOWN && has_syntax_error(path))
        return WB_EXIT_FAILED;
    if (kind == WB_FILE_UNKNOWN) {
        wb_error("'%s' is of unknown kind: expected a file or folder that a command reads or "
                 "writes, see file-formats.md",
                 path);
        return WB_EXIT_FAILED;
    }
    wb_file_kind_append_next(&next, kind, path);
    if (options->common.json) {
        code = print_json(kind, path, wb_text_string(&next));
    } else {
        printf("%s: %s\n", path, wb_file_kind_name(kind));
        code = wb_command_exit(print_contents(kind, path, NULL));
        if (code == WB_EXIT_OK)
            printf("next    %s\n", wb_text_string(&next));
    }
    wb_text_release(&next);
    return code;
}
