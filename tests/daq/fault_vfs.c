#include "tests/daq/fault_vfs.h"

#include <pthread.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SECTOR 512

enum kind {
    WRITE,
    TRUNCATE,
    SYNC,
    DELETE
};

struct operation {
    enum kind kind;
    int name; /* of the file */
    sqlite3_int64 offset;
    size_t n;
    uint8_t *bytes;
};

static struct {
    pthread_mutex_t lock;
    struct operation *operations;
    size_t n, capacity;
    char names[16][128];
    int n_names;
    enum fault fault;
    void (*hook)(void *context);
    void *context;
    sqlite3_vfs vfs, *below;
} layer = {.lock = PTHREAD_MUTEX_INITIALIZER};

struct file {
    sqlite3_file base;
    int name;
    sqlite3_file *below; /* in the same memory, behind this */
};

static int find_name(const char *path)
{
    const char *const slash = strrchr(path, '/'), *const name = slash ? slash + 1 : path;
    for (int i = 0; i < layer.n_names; i++) {
        if (strcmp(layer.names[i], name) == 0)
            return i;
    }
    if (layer.n_names == 16)
        abort();
    snprintf(layer.names[layer.n_names], sizeof layer.names[0], "%s", name);
    return layer.n_names++;
}

static enum fault write_down(enum kind kind, int name, sqlite3_int64 offset, const void *bytes,
                             size_t n)
{
    pthread_mutex_lock(&layer.lock);
    const enum fault fault = layer.fault;
    const bool fails = kind == SYNC     ? fault == FAULT_SYNC || fault == FAULT_IO
                       : kind == DELETE ? false
                                        : fault != FAULT_NONE && fault != FAULT_SYNC;
    const size_t kept = !fails ? n : kind == WRITE && fault == FAULT_SHORT ? n / 2 : 0;
    if (!fails || kept > 0) {
        if (layer.n == layer.capacity) {
            layer.capacity = layer.capacity ? 2 * layer.capacity : 1024;
            layer.operations = realloc(layer.operations, layer.capacity * sizeof *layer.operations);
        }
        uint8_t *const copy = malloc(kept + 1);
        if (!layer.operations || !copy)
            abort();
        if (kept > 0)
            memcpy(copy, bytes, kept);
        layer.operations[layer.n++] = (struct operation){kind, name, offset, kept, copy};
    }
    pthread_mutex_unlock(&layer.lock);
    return fails ? fault : FAULT_NONE;
}

/* --- a file --- */

static struct file *mine(sqlite3_file *file)
{
    return (struct file *)file;
}

static sqlite3_file *below(sqlite3_file *file)
{
    return mine(file)->below;
}

static int do_close(sqlite3_file *file)
{
    return below(file)->pMethods->xClose(below(file));
}

static int do_read(sqlite3_file *file, void *to, int n, sqlite3_int64 offset)
{
    return below(file)->pMethods->xRead(below(file), to, n, offset);
}

static int do_write(sqlite3_file *file, const void *from, int n, sqlite3_int64 offset)
{
    const enum fault fault = write_down(WRITE, mine(file)->name, offset, from, (size_t)n);
    if (fault == FAULT_FULL)
        return SQLITE_FULL;
    if (fault == FAULT_IO)
        return SQLITE_IOERR_WRITE;
    const int code =
        below(file)->pMethods->xWrite(below(file), from, fault == FAULT_SHORT ? n / 2 : n, offset);
    return fault == FAULT_SHORT ? SQLITE_FULL : code;
}

static int do_truncate(sqlite3_file *file, sqlite3_int64 n)
{
    if (write_down(TRUNCATE, mine(file)->name, n, NULL, 0) != FAULT_NONE)
        return SQLITE_IOERR_TRUNCATE;
    return below(file)->pMethods->xTruncate(below(file), n);
}

static int do_sync(sqlite3_file *file, int flags)
{
    pthread_mutex_lock(&layer.lock);
    void (*const hook)(void *) = layer.hook;
    void *const context = layer.context;
    pthread_mutex_unlock(&layer.lock);
    (void)flags; /* a memory disk needs none */
    if (hook)
        hook(context);
    return write_down(SYNC, mine(file)->name, 0, NULL, 0) == FAULT_NONE ? SQLITE_OK
                                                                        : SQLITE_IOERR_FSYNC;
}

static int do_size(sqlite3_file *file, sqlite3_int64 *n)
{
    return below(file)->pMethods->xFileSize(below(file), n);
}

static int do_lock(sqlite3_file *file, int lock)
{
    return below(file)->pMethods->xLock(below(file), lock);
}

static int do_unlock(sqlite3_file *file, int lock)
{
    return below(file)->pMethods->xUnlock(below(file), lock);
}

static int do_check_lock(sqlite3_file *file, int *locked)
{
    return below(file)->pMethods->xCheckReservedLock(below(file), locked);
}

static int do_control(sqlite3_file *file, int operation, void *argument)
{
    return below(file)->pMethods->xFileControl(below(file), operation, argument);
}

static int do_sector(sqlite3_file *file)
{
    return below(file)->pMethods->xSectorSize(below(file));
}

static int do_traits(sqlite3_file *file)
{
    return below(file)->pMethods->xDeviceCharacteristics(below(file));
}

static int do_shm_map(sqlite3_file *file, int page, int n, int extend, void volatile **at)
{
    return below(file)->pMethods->xShmMap(below(file), page, n, extend, at);
}

static int do_shm_lock(sqlite3_file *file, int offset, int n, int flags)
{
    return below(file)->pMethods->xShmLock(below(file), offset, n, flags);
}

static void do_shm_barrier(sqlite3_file *file)
{
    below(file)->pMethods->xShmBarrier(below(file));
}

static int do_shm_unmap(sqlite3_file *file, int remove)
{
    return below(file)->pMethods->xShmUnmap(below(file), remove);
}

static const sqlite3_io_methods methods = {
    .iVersion = 2,
    .xClose = do_close,
    .xRead = do_read,
    .xWrite = do_write,
    .xTruncate = do_truncate,
    .xSync = do_sync,
    .xFileSize = do_size,
    .xLock = do_lock,
    .xUnlock = do_unlock,
    .xCheckReservedLock = do_check_lock,
    .xFileControl = do_control,
    .xSectorSize = do_sector,
    .xDeviceCharacteristics = do_traits,
    .xShmMap = do_shm_map,
    .xShmLock = do_shm_lock,
    .xShmBarrier = do_shm_barrier,
    .xShmUnmap = do_shm_unmap,
};

/* --- the layer --- */

static int do_open(sqlite3_vfs *vfs, const char *path, sqlite3_file *file, int flags, int *given)
{
    (void)vfs;
    struct file *const m = mine(file);
    m->below = (sqlite3_file *)(m + 1);
    const int code = layer.below->xOpen(layer.below, path, m->below, flags, given);
    m->base.pMethods = m->below->pMethods ? &methods : NULL;
    if (path) {
        pthread_mutex_lock(&layer.lock);
        m->name = find_name(path);
        pthread_mutex_unlock(&layer.lock);
    }
    return code;
}

static int do_delete(sqlite3_vfs *vfs, const char *path, int sync)
{
    (void)vfs;
    pthread_mutex_lock(&layer.lock);
    const int name = find_name(path);
    pthread_mutex_unlock(&layer.lock);
    write_down(DELETE, name, 0, NULL, 0);
    /* Synced with its folder, as SQLite asks for where it matters. */
    if (sync)
        write_down(SYNC, name, 0, NULL, 0);
    return layer.below->xDelete(layer.below, path, 0);
}

static void forget(void)
{
    for (size_t i = 0; i < layer.n; i++)
        free(layer.operations[i].bytes);
    free(layer.operations);
    layer.operations = NULL;
    layer.n = layer.capacity = 0;
    layer.n_names = 0;
    layer.fault = FAULT_NONE;
    layer.hook = NULL;
}

void fault_vfs_begin(void)
{
    forget();
    layer.below = sqlite3_vfs_find("unix");
    layer.vfs = *layer.below;
    layer.vfs.zName = "faults";
    layer.vfs.szOsFile = (int)sizeof(struct file) + layer.below->szOsFile;
    layer.vfs.xOpen = do_open;
    layer.vfs.xDelete = do_delete;
    sqlite3_vfs_register(&layer.vfs, 1);
}

void fault_vfs_end(void)
{
    sqlite3_vfs_unregister(&layer.vfs);
    sqlite3_vfs_register(layer.below, 1);
}

void fault_vfs_set(enum fault fault)
{
    pthread_mutex_lock(&layer.lock);
    layer.fault = fault;
    pthread_mutex_unlock(&layer.lock);
}

void fault_vfs_on_sync(void (*hook)(void *context), void *context)
{
    pthread_mutex_lock(&layer.lock);
    layer.hook = hook;
    layer.context = context;
    pthread_mutex_unlock(&layer.lock);
}

size_t fault_vfs_operations(void)
{
    pthread_mutex_lock(&layer.lock);
    const size_t n = layer.n;
    pthread_mutex_unlock(&layer.lock);
    return n;
}

/* --- after a power cut --- */

struct image {
    uint8_t *bytes;
    size_t n;
    bool exists;
};

static uint64_t random_state;

static uint64_t random_below(uint64_t bound)
{
    random_state ^= random_state >> 12;
    random_state ^= random_state << 25;
    random_state ^= random_state >> 27;
    return (random_state * UINT64_C(2685821657736338717)) % bound;
}

static void put(struct image *image, size_t offset, const uint8_t *bytes, size_t n)
{
    if (offset + n > image->n) {
        image->bytes = realloc(image->bytes, offset + n);
        if (!image->bytes)
            abort();
        memset(image->bytes + image->n, 0, offset + n - image->n);
        image->n = offset + n;
    }
    memcpy(image->bytes + offset, bytes, n);
    image->exists = true;
}

/* `whole`: all of it; else each sector or not. */
static void apply(struct image *image, const struct operation *o, bool whole)
{
    switch (o->kind) {
    case WRITE:
        for (size_t at = 0; at < o->n; at += SECTOR) {
            const size_t n = o->n - at < SECTOR ? o->n - at : SECTOR;
            if (whole || random_below(2))
                put(image, (size_t)o->offset + at, o->bytes + at, n);
        }
        break;
    case TRUNCATE:
        if ((whole || random_below(2)) && (size_t)o->offset < image->n)
            image->n = (size_t)o->offset;
        break;
    case DELETE:
        if (whole || random_below(2)) {
            image->n = 0;
            image->exists = false;
        }
        break;
    case SYNC:
        break;
    }
}

void fault_vfs_rebuild(const char *folder, size_t n, uint64_t seed)
{
    random_state = seed * UINT64_C(0x9e3779b97f4a7c15) | 1;
    for (int name = 0; name < layer.n_names; name++) {
        struct image image = {NULL, 0, false};
        size_t synced = 0; /* behind the last sync of this file */
        for (size_t i = 0; i < n; i++) {
            if (layer.operations[i].name == name && layer.operations[i].kind == SYNC)
                synced = i;
        }
        /* Usually a mixture; sometimes all or none of the data that were not synced. */
        const uint64_t lot = random_below(8);
        for (size_t i = 0; i < n; i++) {
            if (layer.operations[i].name == name && (i < synced || lot != 0))
                apply(&image, &layer.operations[i], i < synced || lot == 1);
        }
        char path[256];
        snprintf(path, sizeof path, "%s/%s", folder, layer.names[name]);
        unlink(path);
        FILE *const file = image.exists ? fopen(path, "w") : NULL;
        if (file) {
            if (fwrite(image.bytes, 1, image.n, file) != image.n)
                abort();
            fclose(file);
        }
        free(image.bytes);
    }
}
