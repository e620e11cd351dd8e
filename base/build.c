#include "base/build.h"

#include <dlfcn.h>
#include <link.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/version.h"

#define WB_LOG_DOMAIN "build"

enum {
    MAX_LIBRARIES = 400
};

struct libraries {
    int n;
    char *path[MAX_LIBRARIES]; /* owned */
};

/* Skips the program itself, which has no name here, and the kernel's vDSO, which has no file. */
static int take_library(struct dl_phdr_info *info, size_t size, void *context)
{
    struct libraries *const all = context;
    (void)size;
    /* Resolves a link (libX.so.1) to its file (libX.so.1.2.3), whose name contains the version. */
    char *const path = info->dlpi_name[0] ? realpath(info->dlpi_name, NULL) : NULL;
    if (path && all->n < MAX_LIBRARIES)
        all->path[all->n++] = path;
    else
        free(path);
    return 0;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(wb_file_name(*(char *const *)a), wb_file_name(*(char *const *)b));
}

static enum wb_status put_libraries(struct wb_json *object)
{
    struct libraries all = {.n = 0};
    struct wb_json *const list = wb_json_set_array(object, "libraries");
    enum wb_status status = WB_OK;
    dl_iterate_phdr(take_library, &all);
    qsort(all.path, (size_t)all.n, sizeof *all.path, by_name);
    for (int i = 0; i < all.n; i++) {
        char sha256[WB_SHA256_TEXT];
        if (status == WB_OK)
            status = wb_hash_file(all.path[i], sha256);
        if (status == WB_OK) {
            struct wb_json *const entry = wb_json_append_object(list);
            wb_json_set_text(entry, "file", wb_file_name(all.path[i]));
            wb_json_set_text(entry, "sha256", sha256);
        }
        free(all.path[i]);
    }
    return status;
}

/* The processor class by which kernels, libm and BLAS choose their code. */
static void describe_processor(char text[96])
{
    const char *vectors = "baseline";
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl"))
        vectors = "avx512";
    else if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        vectors = "avx2 fma";
    else if (__builtin_cpu_supports("avx2"))
        vectors = "avx2";
#endif
    /* Looked up with dlsym(), so that this file does not link BLAS. */
    char *(*core)(void);
    void *const found = dlsym(RTLD_DEFAULT, "openblas_get_corename");
    memcpy(&core, &found, sizeof core);
    snprintf(text, 96, "%s, OpenBLAS %s", vectors, found ? core() : "none");
}

enum wb_status wb_build_put(struct wb_json *object)
{
    char processor[96];
    describe_processor(processor);
    wb_json_set_text(object, "version", wb_version());
    wb_json_set_text(object, "revision", wb_version_revision());
    wb_json_set_text(object, "compiler", __VERSION__);
    wb_json_set_text(object, "options", WB_CODE_OPTIONS);
    wb_json_set_text(object, "processor", processor);
    return put_libraries(object);
}
