/* Runs `wirebench` in the test's folder and keeps what it printed. */
#ifndef WB_TESTS_CLI_TOOL_H
#define WB_TESTS_CLI_TOOL_H

#include <stdlib.h>
#include <sys/wait.h>

#include "base/json.h"
#include "tests/schemas.h"

/* Of the last run. */
static struct {
    int code; /* exit status */
    char out[262144], err[16384];
} o;

static inline const char *path_of(const char *name)
{
    static char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static inline void read_all(const char *name, char *text, size_t size)
{
    FILE *const file = fopen(path_of(name), "r");
    assert_non_null(file);
    text[fread(text, 1, size - 1, file)] = '\0';
    fclose(file);
}

/* Runs `BEFORE wirebench ARGUMENTS` in the folder. */
static inline void run_tool(const char *before, const char *arguments)
{
    const char *const binary = getenv("WIREBENCH_BINARY");
    char command[1024];
    if (!binary)
        fail_msg("WIREBENCH_BINARY is not set: run this test through meson");
    snprintf(command, sizeof command, "cd %s && { %s %s %s\n} > out 2> err", folder, before, binary,
             arguments);
    const int status = system(command);
    assert_true(WIFEXITED(status));
    o.code = WEXITSTATUS(status);
    read_all("out", o.out, sizeof o.out);
    read_all("err", o.err, sizeof o.err);
}

static inline void tool(const char *arguments)
{
    run_tool("", arguments);
}

static inline void expect(const char *arguments, int code, const char *part_of_err)
{
    tool(arguments);
    if (o.code != code || !strstr(o.err, part_of_err))
        fail_msg("%s: exit %d, %s", arguments, o.code, o.err);
}

/* Bad input: one message, nothing printed. */
struct refused {
    const char *arguments, *expected;
    int code;
};

static inline void expect_refused(const struct refused *cases, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        expect(cases[i].arguments, cases[i].code, cases[i].expected);
        assert_string_equal(o.out, "");
    }
}

/* A number that the object must have. */
static inline double number(const struct wb_json *object, const char *key)
{
    double value = (double)NAN;
    if (!wb_json_get_number(object, key, &value))
        fail_msg("no number '%s' in %s", key, o.out);
    return value;
}

/* What was printed, as JSON; the caller destroys it. */
static inline struct wb_json *parse_output(void)
{
    struct wb_json *root = NULL;
    assert_int_equal(wb_json_parse(&root, o.out, "output"), WB_OK);
    return root;
}

#endif
