/* wirebench: one tool, one table of commands. */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "base/version.h"
#include "cli/command.h"
#include "cli/complete.h"

#define WB_LOG_DOMAIN "main"

struct command {
    const char *name;
    int (*run)(int argc, char **argv);
    const char *summary;
};

static const struct command commands[] = {
    {"align", wb_cmd_align, "recordings to datasets"},
    {"calibrate", wb_cmd_calibrate, "datasets to properties: E, sigma_Y, K, n"},
    {"clock", wb_cmd_clock, "clocks of a recording, lag between force and markers"},
    {"compare", wb_cmd_compare, "two batches: equivalent, different, or how many more to test"},
    {"doctor", wb_cmd_doctor, "is the bench ready for a test?"},
    {"export", wb_cmd_export,
     "tables of recordings and datasets; with --to, a wire's law as a card"},
    {"import", wb_cmd_import, "tests that others made: from files to recordings and datasets"},
    {"info", wb_cmd_info, "what a recording holds"},
    {"quicklook", wb_cmd_quicklook, "one recording's curve as figure and CSV"},
    {"record", wb_cmd_record, "run a bending test on the bench and record it"},
    {"recover", wb_cmd_recover, "what is left of a damaged recording"},
    {"stage", wb_cmd_stage, "home, jog, unlock, free a specimen, check the load cell"},
    {"replay", wb_cmd_replay, "the bench from a recording"},
    {"report", wb_cmd_report, "the calibration report of a campaign"},
    {"rig", wb_cmd_rig, "the virtual rig: a bench on pseudo-terminals and loopback"},
    {"solve", wb_cmd_solve, "compute a bending test with a finite element model"},
    {"validate", wb_cmd_validate, "error curves of properties on other datasets"},
    {"verify", wb_cmd_verify, "check recordings for damage, gaps and drops"},
    {0},
};

static void print_usage(FILE *file)
{
    fprintf(file, "Usage: wirebench COMMAND [options]\n"
                  "Records cantilever bending tests of wires, replays and aligns them, calibrates\n"
                  "a beam model against them and prints the calibration report.\n\n");
    for (const struct command *command = commands; command->name; command++)
        fprintf(file, "  %-10s %s\n", command->name, command->summary);
    fprintf(file, "\n  -h, --help     this help; `wirebench COMMAND --help` for one command\n"
                  "  -V, --version  version and revision\n");
}

static int run(const struct command *command, int argc, char **argv)
{
    int code = command->run(argc, argv);
    /* A full disk behind a pipe or redirection shows only when stdout is flushed. */
    if ((fflush(stdout) != 0 || ferror(stdout)) && code == WB_EXIT_OK) {
        wb_error("cannot write to standard output: %s", strerror(errno));
        code = WB_EXIT_FAILED;
    }
    return code;
}

/* Letters to change, insert, leave out or swap to make one word of the other (both short). */
static int distance(const char *a, const char *b)
{
    enum {
        MOST = 16
    };
    int d[MOST + 1][MOST + 1];
    const int n = (int)strlen(a), m = (int)strlen(b);
    if (n > MOST || m > MOST)
        return MOST;
    for (int i = 0; i <= n; i++) {
        for (int j = 0; j <= m; j++) {
            if (i == 0 || j == 0) {
                d[i][j] = i + j;
                continue;
            }
            int least = d[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
            least = d[i - 1][j] + 1 < least ? d[i - 1][j] + 1 : least;
            least = d[i][j - 1] + 1 < least ? d[i][j - 1] + 1 : least;
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] &&
                d[i - 2][j - 2] + 1 < least)
                least = d[i - 2][j - 2] + 1;
            d[i][j] = least;
        }
    }
    return d[n][m];
}

/* The command that was probably meant; NULL when none is near. */
static const char *nearest(const char *name)
{
    const char *found = NULL;
    int best = 3; /* more than two slips are another word */
    for (const struct command *command = commands; command->name; command++) {
        const int d = distance(name, command->name);
        if (d < best && d < (int)strlen(name)) {
            best = d;
            found = command->name;
        }
    }
    return found;
}

static const struct command *find(const char *name)
{
    for (const struct command *command = commands; command->name; command++)
        if (strcmp(name, command->name) == 0)
            return command;
    return NULL;
}

/* What may stand in place of the last word. */
static int complete(int n, char **words)
{
    const struct command *const command = n > 1 ? find(words[0]) : NULL;
    if (n == 0 || (n > 1 && !command))
        return WB_EXIT_OK;
    wb_complete_begin(words[n - 1], n > 1 ? words[n - 2] : "");
    words[n - 1] = NULL;
    if (command) {
        /* It ends the process where it would parse; one of several kinds may only have offered
         * their names, and says on stderr that it misses one. */
        (void)command->run(n - 1, words);
        wb_complete_finish(NULL);
        return WB_EXIT_OK;
    }
    for (const struct command *c = commands; c->name; c++)
        wb_complete_print(c->name, c->summary);
    wb_complete_print("--help", "this help");
    wb_complete_print("--version", "version and revision");
    return WB_EXIT_OK;
}

int main(int argc, char **argv)
{
    /* A file that may grow no further is an error code of write(), not the end of the process. */
    signal(SIGXFSZ, SIG_IGN);
    const char *const name = argc > 1 ? argv[1] : "";
    if (strcmp(name, "-h") == 0 || strcmp(name, "--help") == 0 || strcmp(name, "help") == 0) {
        print_usage(stdout);
        return WB_EXIT_OK;
    }
    if (strcmp(name, "-V") == 0 || strcmp(name, "--version") == 0) {
        printf("wirebench %s (%s)\n", wb_version(), wb_version_revision());
        return WB_EXIT_OK;
    }
    if (strcmp(name, "--complete") == 0)
        return complete(argc - 2, argv + 2);
    const struct command *const command = find(name);
    if (command)
        return run(command, argc - 1, argv + 1);
    const char *const meant = nearest(name);
    if (meant) {
        wb_error("no command '%s': did you mean `wirebench %s`?", name, meant);
        return WB_EXIT_USAGE;
    }
    if (argc > 1)
        wb_error("no command '%s'", name);
    print_usage(stderr);
    return WB_EXIT_USAGE;
}
