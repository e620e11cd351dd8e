#include "library/call.h"

#include <gsl/gsl_errno.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/version.h"

#define WB_LOG_DOMAIN "library"

enum {
    MESSAGE_SIZE = 4096,
    WARNINGS_SIZE = 16384
};

static pthread_once_t once = PTHREAD_ONCE_INIT;
static _Thread_local char message[MESSAGE_SIZE];
static _Thread_local char warnings[WARNINGS_SIZE];
static _Thread_local int
    mine_without_handler; /* part of n_without_handler that belongs to this thread */

static void append(char *text, size_t size, const char *separator, const char *more)
{
    const size_t length = strlen(text);
    snprintf(text + length, size - length, "%s%s", length > 0 ? separator : "", more);
}

/* Messages of other threads go to those threads; their failures are returned as values. */
static void keep(void *context, enum wb_log_level level, const char *domain, const char *text)
{
    (void)context, (void)domain;
    if (level == WB_LOG_ERROR)
        append(message, sizeof message, "; ", text);
    else if (level == WB_LOG_WARNING)
        append(warnings, sizeof warnings, "\n", text);
}

static void set_sink(void)
{
    wb_log_set_sink(keep, NULL);
}

void wb_call_start(struct wb_call *call)
{
    pthread_once(&once, set_sink);
    message[0] = warnings[0] = '\0';
    call->n_without_handler = mine_without_handler;
    wb_memory_guard_begin(&call->guard);
}

enum wirebench_status wb_call_abandon(const struct wb_call *call)
{
    while (mine_without_handler > call->n_without_handler)
        wb_call_end_gsl();
    return WIREBENCH_ERR_MEMORY;
}

void wb_call_warn(const char *text)
{
    append(warnings, sizeof warnings, "\n", text);
}

enum wirebench_status wb_call_end(enum wb_status status)
{
    wb_memory_guard_end();
    if (status != WB_OK && !message[0])
        append(message, sizeof message, "", wb_status_text(status));
    /* A failure that was handled becomes a remark. */
    if (status == WB_OK && message[0]) {
        wb_call_warn(message);
        message[0] = '\0';
    }
    return (enum wirebench_status)status;
}

enum wirebench_status wb_call_end_incomplete(const char *format, ...)
{
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    append(message, sizeof message, "; ", text);
    wb_memory_guard_end();
    return WIREBENCH_INCOMPLETE;
}

static size_t size_of(const void *given)
{
    size_t size;
    memcpy(&size, given, sizeof size);
    return size;
}

static enum wb_status check(const void *given, const char *name)
{
    WB_TRY(wb_call_need(given, name));
    if (size_of(given) <= sizeof(size_t))
        return wb_fail(WB_ERR_ARGUMENT,
                       "%s: its size is not set: begin with struct %s x = {.size = sizeof x}", name,
                       name);
    return WB_OK;
}

enum wb_status wb_call_take(void *mine, size_t n, const void *given, const char *name)
{
    WB_TRY(check(given, name));
    const size_t size = size_of(given), common = size < n ? size : n;
    const unsigned char *const bytes = given;
    for (size_t i = n; i < size; i++) {
        if (bytes[i])
            return wb_fail(WB_ERR_ARGUMENT,
                           "%s: contains members that are unknown to this release of the library, "
                           "%s: they must be 0",
                           name, wb_version());
    }
    memset(mine, 0, n);
    memcpy(mine, given, common);
    return WB_OK;
}

enum wb_status wb_call_give(void *given, const void *mine, size_t n, const char *name)
{
    WB_TRY(check(given, name));
    const size_t size = size_of(given), common = size < n ? size : n;
    memcpy((char *)given + sizeof size, (const char *)mine + sizeof size, common - sizeof size);
    if (size > n)
        memset((char *)given + n, 0, size - n);
    return WB_OK;
}

enum wb_status wb_call_need(const void *pointer, const char *name)
{
    if (!pointer)
        return wb_fail(WB_ERR_ARGUMENT, "%s: expected a pointer, not NULL", name);
    return WB_OK;
}

/* --- GSL's error handler --- */

static pthread_mutex_t handler_lock = PTHREAD_MUTEX_INITIALIZER;
static gsl_error_handler_t *handler; /* the caller's, while it is switched off */
static int n_without_handler;

void wb_call_begin_gsl(void)
{
    pthread_mutex_lock(&handler_lock);
    if (n_without_handler++ == 0)
        handler = gsl_set_error_handler_off();
    mine_without_handler++;
    pthread_mutex_unlock(&handler_lock);
}

void wb_call_end_gsl(void)
{
    pthread_mutex_lock(&handler_lock);
    if (--n_without_handler == 0)
        gsl_set_error_handler(handler);
    mine_without_handler--;
    pthread_mutex_unlock(&handler_lock);
}

/* --- versions and messages --- */

const char *wirebench_version(void)
{
    return wb_version();
}

const char *wirebench_revision(void)
{
    return wb_version_revision();
}

const char *wirebench_status_text(enum wirebench_status status)
{
    return status == WIREBENCH_INCOMPLETE ? "incomplete" : wb_status_text((enum wb_status)status);
}

const char *wirebench_message(void)
{
    return message;
}

const char *wirebench_warnings(void)
{
    return warnings;
}

/* --- tables --- */

static enum wb_status give_column(struct wirebench_column *given, const struct wb_columns *table,
                                  const struct wb_column *column)
{
    const enum wb_column_type type = column->kind->type;
    const struct wirebench_column mine = {
        .name = column->kind->name,
        .unit = column->kind->unit,
        .type = (enum wirebench_column_type)type,
        .n = table->n_rows,
        .reals = type == WB_COLUMN_REAL ? column->reals : NULL,
        .integers = type == WB_COLUMN_INTEGER ? column->integers : NULL,
        .texts = type == WB_COLUMN_TEXT ? (const char *const *)column->texts : NULL,
    };
    return wb_call_give(given, &mine, sizeof mine, "wirebench_column");
}

size_t wirebench_table_rows(const struct wirebench_table *table)
{
    return table->columns.n_rows;
}

int wirebench_table_columns(const struct wirebench_table *table)
{
    return table->columns.n;
}

enum wirebench_status wirebench_table_column(const struct wirebench_table *table, int index,
                                             struct wirebench_column *column)
{
    wb_call_begin();
    if (wb_call_need(table, "table") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    if (index < 0 || index >= table->columns.n)
        return wb_call_end(wb_fail(WB_ERR_NOT_FOUND, "table '%s': column %d: expected 0 to %d",
                                   table->columns.name, index, table->columns.n - 1));
    return wb_call_end(give_column(column, &table->columns, &table->columns.items[index]));
}

enum wirebench_status wirebench_table_find(const struct wirebench_table *table, const char *name,
                                           struct wirebench_column *column)
{
    wb_call_begin();
    if (wb_call_need(table, "table") != WB_OK || wb_call_need(name, "name") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    const struct wb_column *const found = wb_columns_find(&table->columns, name);
    if (!found)
        return wb_call_end(
            wb_fail(WB_ERR_NOT_FOUND, "table '%s' has no column '%s'", table->columns.name, name));
    return wb_call_end(give_column(column, &table->columns, found));
}
