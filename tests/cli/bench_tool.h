/* The tool's commands in the test's process, on a virtual bench in virtual time that stays from one
 * command to the next, as a bench does. The test's folder is the working folder. */
#ifndef WB_TESTS_CLI_BENCH_TOOL_H
#define WB_TESTS_CLI_BENCH_TOOL_H

#include <fcntl.h>
#include <wordexp.h>

#include "base/config.h"
#include "base/file.h"
#include "base/interrupt_private.h"
#include "base/timing.h"
#include "base/units.h"
#include "cli/command.h"
#include "fixtures/virtual/bench_private.h"
#include "fixtures/virtual/virtual_time_private.h"
#include "tests/cli/tool.h"

/* 2026-11-25, the date of all tests of which nobody asks the real one. */
#define BENCH_DATE INT64_C(1795564800)
#define SPECIMEN "--specimen like.yaml "

/* --- files --- */

/* Copies a shipped file, or one of the folder (`from` and `to` may be the same), with pieces of
 * text replaced: pairs of old and new, to the first NULL. */
static inline void copy_edited(const char *from, const char *to, const char *const *edits)
{
    char path[WB_PATH];
    static char text[65536], edited[65536];
    FILE *file = fopen(wb_command_find(from, path), "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    for (; edits && edits[0]; edits += 2) {
        const char *const at = strstr(text, edits[0]);
        if (!at)
            fail_msg("%s does not hold '%s'", from, edits[0]);
        snprintf(edited, sizeof edited, "%.*s%s%s", (int)(at - text), text, edits[1],
                 at + strlen(edits[0]));
        strcpy(text, edited);
    }
    file = fopen(to, "w");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

static inline void write_file(const char *name, const char *text)
{
    FILE *const file = fopen(name, "w");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

/* What a file of the folder holds; valid until the next one is read. */
static inline const char *content_of(const char *name)
{
    static char text[1 << 20];
    read_all(name, text, sizeof text);
    return text;
}

static inline int make_work_folder(void **state)
{
    if (make_folder(state) != 0 || chdir(folder) != 0)
        return -1;
    copy_edited("fixtures/specimens/type1-L85-1.yaml", "like.yaml", NULL);
    return 0;
}

static inline int remove_work_folder(void **state)
{
    return chdir("/") == 0 ? remove_folder(state) : -1;
}

/* --- commands --- */

static const struct {
    const char *name;
    int (*run)(int argc, char **argv);
} bench_commands[] = {{"align", wb_cmd_align}, {"export", wb_cmd_export},
                      {"info", wb_cmd_info},   {"record", wb_cmd_record},
                      {"stage", wb_cmd_stage}, {"verify", wb_cmd_verify}};

static inline int take_over(int descriptor, const char *name, int flags)
{
    const int kept = dup(descriptor), file = open(name, flags, 0644);
    assert_true(kept >= 0 && file >= 0);
    assert_int_equal(dup2(file, descriptor), descriptor);
    close(file);
    return kept;
}

static inline void restore(int descriptor, int kept)
{
    assert_int_equal(dup2(kept, descriptor), descriptor);
    close(kept);
}

/* Runs a command with standard input from a file and keeps in `o` what it printed. Wrong usage
 * would end the process. */
static inline void run_with_input(const char *input, const char *arguments)
{
    wordexp_t words;
    char *argv[32] = {NULL}; /* a command changes the list */
    size_t c = 0;
    assert_int_equal(wordexp(arguments, &words, WRDE_NOCMD | WRDE_UNDEF), 0);
    while (c < WB_COUNT(bench_commands) && strcmp(bench_commands[c].name, words.we_wordv[0]) != 0)
        c++;
    if (c == WB_COUNT(bench_commands))
        fail_msg("'%s' names no command of this test", arguments);
    assert_true(words.we_wordc < WB_COUNT(argv));
    memcpy(argv, words.we_wordv, words.we_wordc * sizeof *argv);
    fflush(NULL);
    wb_interrupt_set(false);
    const int in = take_over(STDIN_FILENO, input, O_RDWR),
              out = take_over(STDOUT_FILENO, "out", O_WRONLY | O_CREAT | O_TRUNC),
              err = take_over(STDERR_FILENO, "err", O_WRONLY | O_CREAT | O_TRUNC | O_APPEND);
    o.code = bench_commands[c].run((int)words.we_wordc, argv);
    fflush(stdout);
    restore(STDIN_FILENO, in);
    restore(STDOUT_FILENO, out);
    restore(STDERR_FILENO, err);
    wb_interrupt_set(false);
    wordfree(&words);
    read_all("out", o.out, sizeof o.out);
    read_all("err", o.err, sizeof o.err);
}

static inline void run(const char *arguments)
{
    run_with_input("/dev/null", arguments);
}

#define assert_code(expected)                                                                      \
    do {                                                                                           \
        if (o.code != (expected))                                                                  \
            fail_msg("exit code %d, expected %d: %s%s", o.code, (expected), o.out, o.err);         \
    } while (0)

#define assert_said(part)                                                                          \
    do {                                                                                           \
        if (!strstr(o.out, (part)) && !strstr(o.err, (part)))                                      \
            fail_msg("'%s' was not said: %s%s", (part), o.out, o.err);                             \
    } while (0)

#define assert_not_said(part)                                                                      \
    do {                                                                                           \
        if (strstr(o.out, (part)) || strstr(o.err, (part)))                                        \
            fail_msg("'%s' was said: %s%s", (part), o.out, o.err);                                 \
    } while (0)

/* The command that a message advises, with `wirebench` left out. */
static inline void advised(char command[256])
{
    static const char before[] = "free it with: wirebench ";
    const char *const at = strstr(o.err, before);
    assert_non_null(at);
    const char *const words = at + strlen(before), *const end = strstr(words, " (");
    assert_non_null(end);
    snprintf(command, 256, "%.*s", (int)(end - words), words);
}

/* --- the bench --- */

static struct wb_bench *bench;

/* Begins virtual time with the paper's bench, edited, and writes its rig.yaml. */
static inline void open_bench(const char *const *edits, struct wb_bench_settings settings)
{
    copy_edited("fixtures/rigs/paper.yaml", "bench.yaml", edits);
    settings.rig = "bench.yaml";
    settings.specimen = "like.yaml";
    settings.seed = settings.seed ? settings.seed : 1;
    wb_virtual_time_begin(BENCH_DATE);
    assert_int_equal(wb_bench_open(&bench, &settings), WB_OK);
    assert_int_equal(wb_bench_write_rig(bench, "rig.yaml"), WB_OK);
}

static inline void close_virtual_time(void)
{
    wb_bench_close(bench);
    bench = NULL;
    if (wb_time_is_virtual())
        wb_virtual_time_end();
}

/* The teardown of each fact with a bench, also where the fact failed. */
static inline int close_bench(void **state)
{
    (void)state;
    close_virtual_time();
    return system("rm -f *.wbr *.wbr-* *.checks.csv");
}

/* --- what happens meanwhile --- */

/* Looks every 10 ms whether something is to happen, and does it, once or until it says so. */
static struct {
    struct wb_virtual_actor actor;
    int64_t due_ns;
    double travel;     /* m of the clamp from where it is time */
    void (*act)(void); /* what happens; NULL: it has happened */
    bool again;        /* it happens again and again */
} deed;

static inline int64_t deed_next(void *context)
{
    (void)context;
    return deed.act ? deed.due_ns : INT64_MAX;
}

static inline void deed_run(void *context, int64_t now_ns)
{
    struct wb_bench_counts counts;
    void (*const act)(void) = deed.act;
    (void)context;
    deed.due_ns = now_ns + 10 * WB_NS_PER_MS;
    wb_bench_count(bench, &counts);
    if (counts.travel < deed.travel)
        return;
    if (!deed.again)
        deed.act = NULL;
    act();
}

static inline void plan(double travel_mm, void (*act)(void), bool again)
{
    deed.actor = (struct wb_virtual_actor){NULL, deed_next, deed_run};
    deed.due_ns = wb_time_now_ns() + 500 * WB_NS_PER_MS;
    deed.travel = travel_mm * WB_MM;
    deed.act = act;
    deed.again = again;
    wb_virtual_time_remove(&deed.actor);
    wb_virtual_time_add(&deed.actor);
}

/* Ctrl-C, for plan(). */
static inline void interrupt(void)
{
    wb_interrupt_set(true);
}

/* --- recordings --- */

/* The recording can be read, nothing of SQLite's lies beside it, and an event says so. */
static inline void assert_recorded(const char *name, const char *event)
{
    char command[256];
    snprintf(command, sizeof command, "%s.wbr-wal", name);
    assert_false(wb_file_exists(command));
    snprintf(command, sizeof command, "%s.wbr-journal", name);
    assert_false(wb_file_exists(command));
    assert_int_equal(system("rm -rf exported"), 0);
    snprintf(command, sizeof command, "export %s.wbr -o exported", name);
    run(command);
    assert_code(0);
    if (!strstr(content_of("exported/events.csv"), event))
        fail_msg("no event '%s' in %s", event, content_of("exported/events.csv"));
}

#endif
