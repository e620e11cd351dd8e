#include "base/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/reads.h"

#define WB_LOG_DOMAIN "file"

static enum wb_status status_of_errno(int error)
{
    switch (error) {
    case ENOENT:
    case ENOTDIR:
        return WB_ERR_NOT_FOUND;
    case EACCES:
    case EPERM:
    case EROFS:
        return WB_ERR_PERMISSION;
    case EEXIST:
        return WB_ERR_EXISTS;
    case ENOMEM:
        return WB_ERR_MEMORY;
    default:
        return WB_ERR_IO;
    }
}

static enum wb_status fail_with(int error, const char *action, const char *path,
                                struct wb_reason *why)
{
    return wb_fail_to(why, status_of_errno(error), "cannot %s '%s': %s", action, path,
                      strerror(error));
}

static enum wb_status fail_errno(const char *action, const char *path)
{
    return fail_with(errno, action, path, NULL);
}

static enum wb_status read_stream(FILE *file, const char *path, char **bytes, size_t *size,
                                  struct wb_reason *why)
{
    size_t length = 0, capacity = 1 << 14;
    char *buffer = malloc(capacity);
    while (buffer) {
        length += fread(buffer + length, 1, capacity - length - 1, file);
        if (length < capacity - 1)
            break;
        char *larger = capacity > ((size_t)1 << 31) ? NULL : realloc(buffer, capacity *= 2);
        if (!larger)
            free(buffer);
        buffer = larger;
    }
    if (!buffer)
        return wb_fail_to(why, WB_ERR_MEMORY, "'%s' is too large to read into memory", path);
    if (ferror(file)) {
        const int error = errno;
        free(buffer);
        return fail_with(error, "read", path, why);
    }
    buffer[length] = '\0';
    *bytes = buffer;
    *size = length;
    return WB_OK;
}

enum wb_status wb_file_read_with_reason(const char *path, char **bytes, size_t *size,
                                        struct wb_reason *why)
{
    FILE *file = fopen(path, "rbe");
    if (!file)
        return fail_with(errno, "open", path, why);
    size_t length = 0;
    const enum wb_status status = read_stream(file, path, bytes, &length, why);
    fclose(file);
    if (status != WB_OK)
        return status;
    wb_reads_note(path, *bytes, length);
    if (size)
        *size = length;
    return WB_OK;
}

enum wb_status wb_file_read(const char *path, char **bytes, size_t *size)
{
    return wb_file_read_with_reason(path, bytes, size, NULL);
}

static enum wb_status write_all(int descriptor, const char *path, const void *bytes, size_t size)
{
    const char *position = bytes;
    while (size > 0) {
        const ssize_t n = write(descriptor, position, size);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0)
            return fail_errno("write", path);
        position += n;
        size -= (size_t)n;
    }
    if (fsync(descriptor) != 0 && errno != EINVAL && errno != EROFS)
        return fail_errno("write", path);
    return WB_OK;
}

enum wb_status wb_file_write(const char *path, const void *bytes, size_t size)
{
    char temporary[WB_PATH];
    if (snprintf(temporary, sizeof temporary, "%s.XXXXXX", path) >= (int)sizeof temporary)
        return wb_fail(WB_ERR_ARGUMENT, "path too long: '%s'", path);
    const int descriptor = mkostemp(temporary, O_CLOEXEC);
    if (descriptor < 0)
        return fail_errno("create a file beside", path);
    enum wb_status status = write_all(descriptor, path, bytes, size);
    /* mkostemp() creates private files; output files follow the umask instead, like those of other
     * programs. */
    const mode_t mask = umask(0);
    umask(mask);
    if (status == WB_OK && fchmod(descriptor, 0666 & ~mask) != 0)
        status = fail_errno("set the mode of", path);
    if (close(descriptor) != 0 && status == WB_OK)
        status = fail_errno("write", path);
    if (status == WB_OK && rename(temporary, path) != 0)
        status = fail_errno("replace", path);
    if (status != WB_OK)
        unlink(temporary);
    return status;
}

enum wb_status wb_file_write_text(const char *path, const struct wb_text *text)
{
    return wb_file_write(path, wb_text_string(text), text->length);
}

bool wb_file_exists(const char *path)
{
    return access(path, F_OK) == 0;
}

bool wb_file_is_folder(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

enum wb_status wb_file_make_folder(const char *path)
{
    char part[WB_PATH];
    if (snprintf(part, sizeof part, "%s", path) >= (int)sizeof part)
        return wb_fail(WB_ERR_ARGUMENT, "path too long: '%s'", path);
    for (char *slash = strchr(part + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        if (mkdir(part, 0777) != 0 && errno != EEXIST)
            return fail_errno("make the folder", part);
        *slash = '/';
    }
    if (mkdir(part, 0777) != 0 && errno != EEXIST)
        return fail_errno("make the folder", part);
    if (!wb_file_is_folder(path))
        return wb_fail(WB_ERR_EXISTS, "'%s' is not a folder", path);
    return WB_OK;
}

int wb_file_count_entries(const char *path)
{
    DIR *folder = opendir(path);
    if (!folder)
        return -1;
    int entries = -2; /* "." and ".." */
    while (readdir(folder))
        entries++;
    closedir(folder);
    return entries;
}

enum wb_status wb_file_prepare_output(const char *path, bool force)
{
    if (!force && wb_file_exists(path) && !wb_file_is_folder(path))
        return wb_fail(WB_ERR_EXISTS, "'%s' exists and is not a folder", path);
    if (!force && wb_file_count_entries(path) > 0)
        return wb_fail(WB_ERR_EXISTS,
                       "folder '%s' is not empty; use another folder, or --force to overwrite",
                       path);
    return wb_file_make_folder(path);
}

static enum wb_status join(char path[WB_PATH], const char *folder, const char *name,
                           struct wb_reason *why)
{
    const bool alone = name[0] == '/' || folder[0] == '\0';
    const int length = alone ? snprintf(path, WB_PATH, "%s", name)
                             : snprintf(path, WB_PATH, "%s/%s", folder, name);
    if (length >= WB_PATH)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "path too long: '%s/%s'", folder, name);
    return WB_OK;
}

enum wb_status wb_file_join(char path[WB_PATH], const char *folder, const char *name)
{
    return join(path, folder, name, NULL);
}

void wb_file_folder(char folder[WB_PATH], const char *path)
{
    const char *slash = strrchr(path, '/');
    if (!slash)
        snprintf(folder, WB_PATH, ".");
    else if (slash == path)
        snprintf(folder, WB_PATH, "/");
    else
        snprintf(folder, WB_PATH, "%.*s", (int)(slash - path), path);
}

const char *wb_file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

enum wb_status wb_file_find_data(char path[WB_PATH], const char *name)
{
    const char *const given = getenv("WIREBENCH_DATA");
    const char *const places[] = {
        given ? given : "",
#ifdef WB_SOURCE_ROOT
        WB_SOURCE_ROOT,
#endif
        WB_DATA_FOLDER,
    };
    for (size_t i = given ? 0 : 1; i < sizeof places / sizeof places[0]; i++) {
        char candidate[WB_PATH];
        WB_TRY(wb_file_join(candidate, places[i], name));
        if (wb_file_exists(candidate)) {
            memcpy(path, candidate, sizeof candidate);
            return WB_OK;
        }
    }
    return WB_ERR_NOT_FOUND;
}

static bool is_path(const char *name)
{
    const size_t length = strlen(name);
    return strchr(name, '/') || (length > 5 && strcmp(name + length - 5, ".yaml") == 0);
}

enum wb_status wb_file_find_fixture(char path[WB_PATH], const char *kind, const char *name,
                                    const char *beside)
{
    return wb_file_find_named(path, kind, name, beside, NULL, NULL);
}

/* True if the path exists; a bare name (no slash, no extension) must not be a folder, which may be
 * e.g. the output of a command. */
static bool is_candidate(const char *path, bool is_name)
{
    return wb_file_exists(path) && !(is_name && wb_file_is_folder(path));
}

enum wb_status wb_file_find_named(char path[WB_PATH], const char *kind, const char *name,
                                  const char *beside, const char *named_in, struct wb_reason *why)
{
    const char *const place = named_in ? named_in : "", *const colon = named_in ? ": " : "";
    const bool is_name = !is_path(name), elsewhere = beside && strcmp(beside, ".") != 0;
    char shipped[WB_PATH];

    if (is_name) {
        if (snprintf(shipped, sizeof shipped, "fixtures/%s/%s.yaml", kind, name) >=
            (int)sizeof shipped)
            return wb_fail_to(why, WB_ERR_ARGUMENT, "name too long: '%s'", name);
        if (wb_file_find_data(path, shipped) == WB_OK)
            return WB_OK;
    }
    if (beside) {
        WB_TRY(join(path, beside, name, why));
        if (is_candidate(path, is_name))
            return WB_OK;
    }
    WB_TRY(join(path, "", name, why));
    if (is_candidate(path, is_name) || (!is_name && wb_file_find_data(path, name) == WB_OK))
        return WB_OK;
    if (is_name)
        return wb_fail_to(why, WB_ERR_NOT_FOUND,
                          "%s%sno '%s' among the shipped %s (no %s); give a path to your own file",
                          place, colon, name, kind, shipped);
    return wb_fail_to(why, WB_ERR_NOT_FOUND, "%s%sno file '%s'%s%s%s", place, colon, name,
                      elsewhere ? ", here or in '" : "", elsewhere ? beside : "",
                      elsewhere ? "'" : "");
}

static long read_holder(int descriptor)
{
    char text[32];
    const ssize_t n = pread(descriptor, text, sizeof text - 1, 0);
    text[n > 0 ? n : 0] = '\0';
    return strtol(text, NULL, 10);
}

/* False if the previous holder of the lock removed its file after we opened it. */
static bool is_same_file(int descriptor, const char *path)
{
    struct stat held, named;
    return fstat(descriptor, &held) == 0 && stat(path, &named) == 0 &&
           held.st_dev == named.st_dev && held.st_ino == named.st_ino;
}

enum wb_status wb_file_lock(struct wb_file_lock *lock, const char *path, long *holder)
{
    *holder = 0;
    if (snprintf(lock->path, sizeof lock->path, "%s", path) >= (int)sizeof lock->path)
        return wb_fail(WB_ERR_ARGUMENT, "path too long: '%s'", path);
    for (;;) {
        const int descriptor = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (descriptor < 0)
            return fail_errno("open the lock", path);
        if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
            const bool busy = errno == EWOULDBLOCK;
            const enum wb_status status = busy ? WB_ERR_BUSY : fail_errno("lock", path);
            *holder = read_holder(descriptor);
            close(descriptor);
            return status;
        }
        if (is_same_file(descriptor, path)) {
            char text[32];
            const int n = snprintf(text, sizeof text, "%ld\n", (long)getpid());
            lock->descriptor = descriptor;
            /* The process number is only for messages: the lock is valid without it. */
            if (ftruncate(descriptor, 0) == 0 && pwrite(descriptor, text, (size_t)n, 0) < n)
                wb_warn("'%s': %s", path, strerror(errno));
            return WB_OK;
        }
        close(descriptor);
    }
}

void wb_file_unlock(struct wb_file_lock *lock)
{
    unlink(lock->path);
    close(lock->descriptor);
    lock->descriptor = -1;
}
