/* The properties file of a test, in its own folder:
 *
 *     return cmocka_run_group_tests(tests, make_path, remove_folder);
 */
#ifndef WB_TESTS_ANALYSIS_CALIBRATION_PROPERTIES_PATH_H
#define WB_TESTS_ANALYSIS_CALIBRATION_PROPERTIES_PATH_H

#include "base/file.h"
#include "tests/messages.h"
#include "tests/schemas.h"

static char path[WB_PATH];

static inline int make_path(void **state)
{
    keep_messages();
    if (make_folder(state) != 0)
        return -1;
    return wb_file_join(path, folder, "properties.yaml") == WB_OK ? 0 : -1;
}

#endif
