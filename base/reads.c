#include "base/reads.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

static struct {
    pthread_mutex_t lock;
    bool is_on;
    int n;
    size_t capacity;
    struct wb_read *items; /* (capacity) */
} reads = {.lock = PTHREAD_MUTEX_INITIALIZER};

/* --- called with the lock held --- */

static void keep(int n)
{
    while (reads.n > n)
        free((char *)reads.items[--reads.n].path);
}

static bool is_noted(const struct wb_read *read)
{
    for (int i = 0; i < reads.n; i++) {
        if (strcmp(reads.items[i].path, read->path) == 0 &&
            strcmp(reads.items[i].sha256, read->sha256) == 0)
            return true;
    }
    return false;
}

static void add(struct wb_read *read)
{
    reads.items =
        wb_memory_room(reads.items, &reads.capacity, (size_t)reads.n + 1, sizeof *reads.items);
    reads.items[reads.n++] = *read;
    read->path = NULL;
}

/* --- for all threads --- */

static void start(bool is_on)
{
    pthread_mutex_lock(&reads.lock);
    keep(0);
    free(reads.items);
    reads.items = NULL;
    reads.capacity = 0;
    reads.is_on = is_on;
    pthread_mutex_unlock(&reads.lock);
}

void wb_reads_start(void)
{
    start(true);
}

void wb_reads_stop(void)
{
    start(false);
}

int wb_reads_count(void)
{
    pthread_mutex_lock(&reads.lock);
    const int n = reads.n;
    pthread_mutex_unlock(&reads.lock);
    return n;
}

void wb_reads_forget(int n)
{
    pthread_mutex_lock(&reads.lock);
    keep(n);
    pthread_mutex_unlock(&reads.lock);
}

bool wb_reads_at(int index, struct wb_read *read)
{
    pthread_mutex_lock(&reads.lock);
    const bool is_there = index < reads.n;
    if (is_there)
        *read = reads.items[index];
    pthread_mutex_unlock(&reads.lock);
    return is_there;
}

static bool is_on(void)
{
    pthread_mutex_lock(&reads.lock);
    const bool on = reads.is_on;
    pthread_mutex_unlock(&reads.lock);
    return on;
}

void wb_reads_note(const char *path, const void *bytes, size_t size)
{
    if (!is_on())
        return;
    char *const found = realpath(path, NULL);
    struct wb_read read = {.path = found ? found : wb_memory_text(path)};
    wb_hash_bytes(bytes, size, read.sha256);
    pthread_mutex_lock(&reads.lock);
    if (!is_noted(&read))
        add(&read);
    pthread_mutex_unlock(&reads.lock);
    free((char *)read.path);
}

void wb_reads_leave_out(const char *path)
{
    if (!is_on())
        return;
    char *const found = realpath(path, NULL);
    const char *const wanted = found ? found : path;
    int n = 0;
    pthread_mutex_lock(&reads.lock);
    for (int i = 0; i < reads.n; i++) {
        if (strcmp(reads.items[i].path, wanted) == 0)
            free((char *)reads.items[i].path);
        else
            reads.items[n++] = reads.items[i];
    }
    reads.n = n;
    pthread_mutex_unlock(&reads.lock);
    free(found);
}
