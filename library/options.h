/* Options of a command from a caller of the library: "NAME=VALUE", or "NAME" alone for an option
 * without a value. */
#ifndef WB_LIBRARY_OPTIONS_H
#define WB_LIBRARY_OPTIONS_H

#include "base/setting.h"
#include "base/status.h"

/* Sets the options (NULL, or NULL-terminated) in the struct of the tables (n of them). `command`
 * is the tool's, whose --help lists them. WB_ERR_NOT_FOUND, or WB_ERR_ARGUMENT for an invalid
 * value. */
WB_MUST_CHECK enum wb_status wb_options_set(const struct wb_setting_table *tables, int n,
                                            void *settings, const char *const *options,
                                            const char *command);

#endif
