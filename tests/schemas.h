/* Files that the product wrote, checked against their JSON Schemas (tests/check-files.py). */
#ifndef WB_TESTS_SCHEMAS_H
#define WB_TESTS_SCHEMAS_H

#include <stdlib.h>

#include "tests/own_folder.h"

/* Whether each file of a folder follows its schema, and there is one at least. Without
 * python3-jsonschema, or by hand outside `meson test`, nothing is checked. */
static inline bool files_follow_schemas(const char *path)
{
    const char *const check = getenv("WIREBENCH_CHECK_FILES");
    char command[8192];
    if (!check)
        return true;
    snprintf(command, sizeof command, "%s '%s' >&2", check, path);
    return system(command) == 0;
}

/* In place of remove_folder(): the files that the facts left are checked first. */
static inline int check_and_remove_folder(void **state)
{
    const bool is_good = files_follow_schemas(folder);
    return remove_folder(state) == 0 && is_good ? 0 : -1;
}

#endif
