/* Folders of a test's own. They lie in memory where there is such a place, because recordings are
 * synchronised to the disk. */
#ifndef WB_TESTS_FOLDER_H
#define WB_TESTS_FOLDER_H

#include <stdbool.h>
#include <stdlib.h>
#include <unistd.h>

#include "tests/check.h"

/* Makes a folder of a name that is not taken. */
static inline bool temporary_folder_make(char path[32])
{
    snprintf(path, 32, "%s/wirebench-test-XXXXXX",
             access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp");
    return mkdtemp(path);
}

/* Removes it with all that it holds, also what nobody may write. 0, or what went wrong. */
static inline int temporary_folder_remove(const char *path)
{
    char command[256];
    snprintf(command, sizeof command, "chmod -R u+w '%s' && rm -r '%s'", path, path);
    return system(command);
}

#endif
