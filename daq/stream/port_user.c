#include "daq/stream/port_user.h"

#include <ctype.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

static bool describe(long process, char text[WB_PORT_USER_TEXT])
{
    char path[64], name[32] = "";
    snprintf(path, sizeof path, "/proc/%ld/comm", process);
    FILE *const file = fopen(path, "r");
    if (!file)
        return false;
    if (fgets(name, sizeof name, file))
        name[strcspn(name, "\n")] = '\0';
    fclose(file);
    snprintf(text, WB_PORT_USER_TEXT, "%s, process %ld", name[0] ? name : "?", process);
    return true;
}

/* The process that holds a lock on the file; 0: none, or /proc/locks cannot be read. A line of
 * /proc/locks is "1: FLOCK  ADVISORY  WRITE 1234 00:19:5 0 EOF"; device numbers are hexadecimal. */
static long find_locker(const struct stat *device)
{
    FILE *const file = fopen("/proc/locks", "r");
    char line[256];
    long found = 0;
    while (file && found == 0 && fgets(line, sizeof line, file)) {
        long process;
        unsigned upper, lower;
        unsigned long inode;
        if (sscanf(line, "%*s FLOCK %*s %*s %ld %x:%x:%lu", &process, &upper, &lower, &inode) ==
                4 &&
            inode == device->st_ino && upper == major(device->st_dev) &&
            lower == minor(device->st_dev) && process != (long)getpid())
            found = process;
    }
    if (file)
        fclose(file);
    return found;
}

static bool has_open(long process, const struct stat *device)
{
    char folder[64], path[sizeof folder + 256];
    snprintf(folder, sizeof folder, "/proc/%ld/fd", process);
    DIR *const open_files = opendir(folder);
    bool found = false;
    struct dirent *entry;
    while (open_files && !found && (entry = readdir(open_files))) {
        struct stat other;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        found =
            stat(path, &other) == 0 && S_ISCHR(other.st_mode) && other.st_rdev == device->st_rdev;
    }
    if (open_files)
        closedir(open_files);
    return found;
}

static long find_opener(const struct stat *device)
{
    DIR *const processes = opendir("/proc");
    struct dirent *entry;
    long found = 0;
    while (processes && found == 0 && (entry = readdir(processes))) {
        const long process = isdigit((unsigned char)entry->d_name[0]) ? atol(entry->d_name) : 0;
        if (process > 0 && process != (long)getpid() && has_open(process, device))
            found = process;
    }
    if (processes)
        closedir(processes);
    return found;
}

bool wb_port_user(const char *path, char text[WB_PORT_USER_TEXT])
{
    struct stat device;
    if (stat(path, &device) != 0 || !S_ISCHR(device.st_mode))
        return false;
    const long locker = find_locker(&device);
    if (locker > 0 && describe(locker, text))
        return true;
    const long opener = find_opener(&device);
    return opener > 0 && describe(opener, text);
}
