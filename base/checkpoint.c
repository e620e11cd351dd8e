#include "base/checkpoint.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"

#define WB_LOG_DOMAIN "checkpoint"

/* Text up to a line "end", then bytes:
 *
 *     wirebench checkpoint 1
 *     IDENTITY
 *     SHA-256
 *     SIZE
 *     end
 */
static const char first_line[] = "wirebench checkpoint 1\n";

enum {
    MOST_HEAD = 4096
};

void wb_checkpoint_init(struct wb_checkpoint *checkpoint)
{
    *checkpoint = (struct wb_checkpoint){.status = WB_OK};
}

void wb_checkpoint_release(struct wb_checkpoint *checkpoint)
{
    free(checkpoint->bytes);
    wb_checkpoint_init(checkpoint);
}

static bool make_room(struct wb_checkpoint *c, size_t size)
{
    if (size <= c->room - c->at)
        return true;
    const size_t room = 2 * (c->at + size) + 1024;
    unsigned char *bytes = realloc(c->bytes, room);
    if (!bytes) {
        c->status = wb_fail(WB_ERR_MEMORY, "out of memory for a checkpoint of %zu bytes", room);
        return false;
    }
    c->bytes = bytes;
    c->room = room;
    return true;
}

void wb_checkpoint_carry(struct wb_checkpoint *c, void *data, size_t size)
{
    if (c->status != WB_OK || size == 0)
        return;
    if (c->restores && size > c->size - c->at) {
        c->status = wb_fail(WB_ERR_DATA, "the checkpoint ends early, after %zu bytes", c->size);
        return;
    }
    if (!c->restores && !make_room(c, size))
        return;
    if (c->restores)
        memcpy(data, c->bytes + c->at, size);
    else
        memcpy(c->bytes + c->at, data, size);
    c->at += size;
    if (!c->restores)
        c->size = c->at;
}

void wb_checkpoint_rewind(struct wb_checkpoint *checkpoint)
{
    checkpoint->restores = true;
    checkpoint->at = 0;
}

enum wb_status wb_checkpoint_finish(struct wb_checkpoint *c)
{
    if (c->status == WB_OK && c->restores && c->at != c->size)
        c->status = wb_fail(WB_ERR_DATA, "the checkpoint has %zu bytes too many", c->size - c->at);
    return c->status;
}

enum wb_status wb_checkpoint_write(const struct wb_checkpoint *c, const char *path,
                                   const char *identity)
{
    char head[MOST_HEAD], hash[WB_SHA256_TEXT];

    wb_hash_bytes(c->bytes, c->size, hash);
    const int n =
        snprintf(head, sizeof head, "%s%s\n%s\n%zu\nend\n", first_line, identity, hash, c->size);
    if (n < 0 || n >= MOST_HEAD)
        return wb_fail(WB_ERR_ARGUMENT, "%s: an identity of %zu bytes", path, strlen(identity));
    unsigned char *all = malloc((size_t)n + c->size);
    if (!all)
        return wb_fail(WB_ERR_MEMORY, "out of memory for a checkpoint of %zu bytes", c->size);
    memcpy(all, head, (size_t)n);
    if (c->size > 0)
        memcpy(all + n, c->bytes, c->size);
    const enum wb_status status = wb_file_write(path, all, (size_t)n + c->size);
    free(all);
    return status;
}

/* A line of the head, and on to the next. NULL behind the head. */
static const char *take_line(char **at, const char *end)
{
    char *begin = *at;
    char *stop = begin < end ? memchr(begin, '\n', (size_t)(end - begin)) : NULL;

    if (!stop)
        return NULL;
    *stop = '\0';
    *at = stop + 1;
    return begin;
}

static enum wb_status check_head(const char *path, char **at, const char *end, const char *identity)
{
    const char *const first = take_line(at, end), *const whose = take_line(at, end);
    const char *const hash = take_line(at, end), *const size = take_line(at, end);
    const char *const last = take_line(at, end);
    char actual[WB_SHA256_TEXT];

    if (!last || strncmp(first, first_line, strlen(first_line) - 1) != 0 ||
        strcmp(last, "end") != 0)
        return wb_fail(WB_ERR_FORMAT,
                       "%s: not a checkpoint of this program; remove it to begin anew", path);
    if (strcmp(whose, identity) != 0)
        return wb_fail(WB_ERR_DATA,
                       "%s: the checkpoint is of another run; remove it to begin anew. It is of: "
                       "%s. This run is: %s",
                       path, whose, identity);
    wb_hash_bytes(*at, (size_t)(end - *at), actual);
    if (strtoull(size, NULL, 10) != (unsigned long long)(end - *at) || strcmp(hash, actual) != 0)
        return wb_fail(WB_ERR_FORMAT, "%s: the checkpoint is damaged; remove it to begin anew",
                       path);
    return WB_OK;
}

enum wb_status wb_checkpoint_read(struct wb_checkpoint *c, const char *path, const char *identity)
{
    char *text;
    size_t size;

    wb_checkpoint_init(c);
    WB_TRY(wb_file_read(path, &text, &size));
    char *at = text;
    const enum wb_status status = check_head(path, &at, text + size, identity);
    if (status != WB_OK) {
        free(text);
        return status;
    }
    c->size = size - (size_t)(at - text);
    memmove(text, at, c->size);
    c->bytes = (unsigned char *)text;
    c->room = size;
    wb_checkpoint_rewind(c);
    return WB_OK;
}
