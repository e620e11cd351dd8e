/* Options of a command as a caller of the library gives them: "NAME=VALUE", or "NAME" alone of one
 * that takes no value. */
#ifndef WB_LIBRARY_OPTIONS_H
#define WB_LIBRARY_OPTIONS_H

#include "base/setting.h"
#include "base/status.h"

/* Sets the options (NULL, or texts up to a NULL) into the struct of the tables (n of them).
 * `command` is the tool's, whose --help names them. WB_ERR_NOT_FOUND, or WB_ERR_ARGUMENT where the
 * value is not what is expected. */
WB_MUST_CHECK enum wb_status wb_options_set(const struct wb_setting_table *tables, int n,
                                            void *settings, const char *const *options,
                                            const char *command);

#endif
