/* One folder for all facts of a test file, made before them and removed after them:
 *
 *     return cmocka_run_group_tests(tests, make_folder, remove_folder);
 */
#ifndef WB_TESTS_OWN_FOLDER_H
#define WB_TESTS_OWN_FOLDER_H

#include "tests/folder.h"

static char folder[32];

static inline int make_folder(void **state)
{
    (void)state;
    return temporary_folder_make(folder) ? 0 : -1;
}

static inline int remove_folder(void **state)
{
    (void)state;
    return temporary_folder_remove(folder);
}

#endif
