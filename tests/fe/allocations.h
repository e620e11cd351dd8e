/* Counts the library's allocations and makes one fail: the linker redirects them here (--wrap). */
#ifndef WB_TESTS_FE_ALLOCATIONS_H
#define WB_TESTS_FE_ALLOCATIONS_H

#include <stdlib.h>

static int allocations;
static int fail_at; /* number of the allocation that fails, from 1; 0: none */

void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *memory, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *memory, size_t size);

void *__wrap_malloc(size_t size)
{
    return ++allocations == fail_at ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t n, size_t size)
{
    return ++allocations == fail_at ? NULL : __real_calloc(n, size);
}

void *__wrap_realloc(void *memory, size_t size)
{
    return ++allocations == fail_at ? NULL : __real_realloc(memory, size);
}

#endif
