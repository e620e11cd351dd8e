#include "base/checkpoint.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"

#define WB_LOG_DOMAIN "checkpoint"

/* Text up to a line "end", then fields:
 *
 *     wirebench checkpoint 2
 *     IDENTITY
 *     SHA-256
 *     SIZE
 *     end
 *
 * A field is its zero-terminated name, its size (size_t) and its bytes. */
static const char first_words[] = "wirebench checkpoint ";

enum {
    VERSION = 2,
    MAX_HEAD = 4096,
    MAX_NAME = 256
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

/* --- groups --- */

void wb_checkpoint_enter(struct wb_checkpoint *c, const char *format, ...)
{
    const size_t used = strlen(c->group), room = sizeof c->group - used;
    va_list arguments;

    va_start(arguments, format);
    const int n = vsnprintf(c->group + used, room, format, arguments);
    va_end(arguments);
    if (n < 0 || (size_t)n + 1 >= room) {
        if (c->status == WB_OK)
            c->status = wb_fail(WB_ERR_ARGUMENT, "checkpoint: the name of group '%s' is too long",
                                c->group);
        c->group[used] = '\0';
        return;
    }
    strcat(c->group, "/");
}

void wb_checkpoint_leave(struct wb_checkpoint *c)
{
    size_t end = strlen(c->group);

    if (end > 0)
        end--; /* its own slash */
    while (end > 0 && c->group[end - 1] != '/')
        end--;
    c->group[end] = '\0';
}

/* --- fields --- */

void wb_checkpoint_append(struct wb_checkpoint *c, const void *fields, size_t size)
{
    if (c->status != WB_OK || size == 0)
        return;
    c->bytes = wb_memory_room(c->bytes, &c->room, c->at + size, 1);
    memcpy(c->bytes + c->at, fields, size);
    c->at += size;
    c->size = c->at;
}

struct field {
    const char *name;
    size_t size;
    const unsigned char *data;
};

/* The field at the current position; false if there is none, or only a part of one. */
static bool find_field(const struct wb_checkpoint *c, struct field *field)
{
    const unsigned char *at = c->at < c->size ? c->bytes + c->at : NULL;
    const unsigned char *const end = at ? at + (c->size - c->at) : NULL;
    const unsigned char *const stop = at ? memchr(at, '\0', (size_t)(end - at)) : NULL;

    if (!stop || (size_t)(end - stop) - 1 < sizeof field->size)
        return false;
    field->name = (const char *)at;
    memcpy(&field->size, stop + 1, sizeof field->size);
    field->data = stop + 1 + sizeof field->size;
    return field->size <= (size_t)(end - field->data);
}

static void pass(struct wb_checkpoint *c, const struct field *field)
{
    c->at = (size_t)(field->data - c->bytes) + field->size;
}

static enum wb_status restore(struct wb_checkpoint *c, const char *name, void *data, size_t size)
{
    struct field field;

    if (!find_field(c, &field))
        return wb_fail(WB_ERR_DATA,
                       "checkpoint: field '%s' is missing: the data end after %zu bytes", name,
                       c->size);
    if (strcmp(field.name, name) != 0)
        return wb_fail(WB_ERR_DATA, "checkpoint: expected field '%s', found '%s'", name,
                       field.name);
    if (field.size != size)
        return wb_fail(WB_ERR_DATA, "checkpoint: field '%s' has %zu bytes: expected %zu", name,
                       field.size, size);
    if (size > 0)
        memcpy(data, field.data, size);
    pass(c, &field);
    return WB_OK;
}

void wb_checkpoint_visit(struct wb_checkpoint *c, const char *name, void *data, size_t size)
{
    char whole[MAX_NAME];

    if (c->status != WB_OK)
        return;
    const int n = snprintf(whole, sizeof whole, "%s%s", c->group, name);
    if (n < 0 || n >= MAX_NAME) {
        c->status =
            wb_fail(WB_ERR_ARGUMENT,
                    "checkpoint: the name of field '%s%s' is too long: expected at most %d bytes",
                    c->group, name, MAX_NAME - 1);
        return;
    }
    if (c->restores) {
        c->status = restore(c, whole, data, size);
        return;
    }
    wb_checkpoint_append(c, whole, (size_t)n + 1);
    wb_checkpoint_append(c, &size, sizeof size);
    wb_checkpoint_append(c, data, size);
}

void wb_checkpoint_skip(struct wb_checkpoint *c)
{
    struct field field;

    while (c->restores && c->status == WB_OK && find_field(c, &field) &&
           strncmp(field.name, c->group, strlen(c->group)) == 0)
        pass(c, &field);
}

void wb_checkpoint_rewind(struct wb_checkpoint *checkpoint)
{
    checkpoint->restores = true;
    checkpoint->at = 0;
}

enum wb_status wb_checkpoint_finish(struct wb_checkpoint *c)
{
    struct field field;

    if (c->status != WB_OK || !c->restores || c->at == c->size)
        return c->status;
    c->status =
        find_field(c, &field)
            ? wb_fail(WB_ERR_DATA, "checkpoint: unexpected field '%s' at the end", field.name)
            : wb_fail(WB_ERR_DATA, "checkpoint: %zu unexpected bytes at the end", c->size - c->at);
    return c->status;
}

/* --- files --- */

enum wb_status wb_checkpoint_write(const struct wb_checkpoint *c, const char *path,
                                   const char *identity)
{
    char head[MAX_HEAD], hash[WB_SHA256_TEXT];

    wb_hash_bytes(c->bytes, c->size, hash);
    const int n = snprintf(head, sizeof head, "%s%d\n%s\n%s\n%zu\nend\n", first_words, VERSION,
                           identity, hash, c->size);
    if (n < 0 || n >= MAX_HEAD)
        return wb_fail(
            WB_ERR_ARGUMENT,
            "%s: the checkpoint's identity of %zu bytes does not fit into the head of %d "
            "bytes",
            path, strlen(identity), MAX_HEAD);
    unsigned char *const all = wb_memory_resize(NULL, (size_t)n + c->size, 1);
    memcpy(all, head, (size_t)n);
    if (c->size > 0)
        memcpy(all + n, c->bytes, c->size);
    const enum wb_status status = wb_file_write(path, all, (size_t)n + c->size);
    free(all);
    return status;
}

/* A line of the head; moves *at to the next line. NULL after the head. */
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

    if (!last || strncmp(first, first_words, strlen(first_words)) != 0 || strcmp(last, "end") != 0)
        return wb_fail(WB_ERR_FORMAT, "%s: not a checkpoint file; remove it to start over", path);
    const char *const version = first + strlen(first_words);
    if (strtol(version, NULL, 10) != VERSION)
        return wb_fail(WB_ERR_FORMAT,
                       "%s: a checkpoint of version %.8s, this program reads version %d; remove it "
                       "to start over",
                       path, version, VERSION);
    if (strcmp(whose, identity) != 0)
        return wb_fail(
            WB_ERR_DATA,
            "%s: the checkpoint belongs to another run; remove it to start over; checkpoint: "
            "%s; this run: %s",
            path, whose, identity);
    wb_hash_bytes(*at, (size_t)(end - *at), actual);
    if (strtoull(size, NULL, 10) != (unsigned long long)(end - *at) || strcmp(hash, actual) != 0)
        return wb_fail(WB_ERR_FORMAT, "%s: the checkpoint is damaged; remove it to start over",
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
