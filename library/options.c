#include "library/options.h"

#include <string.h>

#define WB_LOG_DOMAIN "library"

/* The row of the option, and the struct of its field; NULL: unknown option. */
static const struct wb_setting *find(const struct wb_setting_table *tables, int n, void *settings,
                                     const char *name, size_t length, void **of)
{
    for (int t = 0; t < n; t++) {
        for (size_t i = 0; i < tables[t].n; i++) {
            const struct wb_setting *const row = &tables[t].rows[i];
            if (!row->option || strlen(row->option) != length ||
                strncmp(row->option, name, length) != 0)
                continue;
            *of = (char *)settings + tables[t].offset;
            return row;
        }
    }
    return NULL;
}

enum wb_status wb_options_set(const struct wb_setting_table *tables, int n, void *settings,
                              const char *const *options, const char *command)
{
    for (; options && *options; options++) {
        const char *const option = *options, *const equals = strchr(option, '=');
        const size_t length = equals ? (size_t)(equals - option) : strlen(option);
        char problem[WB_SETTING_PROBLEM];
        void *of;
        const struct wb_setting *const row = find(tables, n, settings, option, length, &of);
        if (!row)
            return wb_fail(WB_ERR_NOT_FOUND, "unknown option '%s': see `wirebench %s --help`",
                           option, command);
        if (row->type != WB_SETTING_BOOLEAN && !equals)
            return wb_fail(WB_ERR_ARGUMENT, "option '%s': expected %s=%s", option, option,
                           row->argument);
        if (row->type == WB_SETTING_BOOLEAN && equals)
            return wb_fail(WB_ERR_ARGUMENT, "option '%s': expected no value", option);
        if (!wb_setting_parse(row, equals ? equals + 1 : NULL, of, problem))
            return wb_fail(WB_ERR_ARGUMENT, "option '%s': %s", option, problem);
    }
    return WB_OK;
}
