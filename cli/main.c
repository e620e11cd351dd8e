/* wirebench: the table of commands, and what stands before a command. */
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
    const char *stage; /* of the workflow: of the first command of it */
};

/* In the order of a bench's work. */
static const struct command commands[] = {
    {"doctor", wb_cmd_doctor, "check whether the bench is ready for a test", "set up the bench"},
    {"stage", wb_cmd_stage, "home, jog, unlock, free a specimen, check the load cell"},
    {"rig", wb_cmd_rig, "run a virtual rig on pseudo-terminals and loopback"},
    {"record", wb_cmd_record, "run a bending test, or a series of tests, and record it", "record"},
    {"quicklook", wb_cmd_quicklook, "curve and shapes of a recording as figures and CSV"},
    {"import", wb_cmd_import, "files of other programs to recordings and datasets",
     "bring in and align"},
    {"align", wb_cmd_align, "recordings to datasets"},
    {"clock", wb_cmd_clock, "clocks of a recording, lag between force and markers"},
    {"calibrate", wb_cmd_calibrate, "datasets to properties: law, EI, moments, residual curvature",
     "calibrate and validate"},
    {"validate", wb_cmd_validate, "compare predictions of properties with other datasets"},
    {"compare", wb_cmd_compare, "compare the properties of two batches"},
    {"solve", wb_cmd_solve, "compute a bending test with a finite element model", "simulate"},
    {"report", wb_cmd_report, "make, sign or check the report of a campaign",
     "report and hand over"},
    {"export", wb_cmd_export, "recordings and datasets as tables, the law of a wire as a card"},
    {"info", wb_cmd_info, "kind and contents of a file, and the next command for it",
     "housekeeping"},
    {"verify", wb_cmd_verify, "check recordings for damage, gaps and drops"},
    {"recover", wb_cmd_recover, "salvage the data of a damaged recording"},
    {"replay", wb_cmd_replay, "play a recording through the decoders"},
    {0},
};

static void print_usage(FILE *file)
{
    fprintf(file,
            "Usage: wirebench COMMAND [options]\n"
            "Records cantilever bending tests of electrical wires, aligns them, calibrates and\n"
            "validates elastoplastic bending laws, simulates tests and writes reports.\n");
    for (const struct command *command = commands; command->name; command++) {
        if (command->stage)
            fprintf(file, "\n%s:\n", command->stage);
        fprintf(file, "  %-10s %s\n", command->name, command->summary);
    }
    fprintf(file, "\n  -h, --help     this help; `wirebench COMMAND --help` for one command,\n"
                  "                 `man wirebench-COMMAND` with examples\n"
                  "  -V, --version  version and revision\n");
}

static int run(const struct command *command, int argc, char **argv)
{
    int code = command->run(argc, argv);
    /* A full disk behind a redirection is noticed only when stdout is flushed. */
    if ((fflush(stdout) != 0 || ferror(stdout)) && code == WB_EXIT_OK) {
        wb_error("cannot write to standard output: %s", strerror(errno));
        code = WB_EXIT_FAILED;
    }
    return code;
}

/* Damerau-Levenshtein distance of two short words. */
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

/* The most similar command, or NULL. */
static const char *nearest(const char *name)
{
    const char *found = NULL;
    int best = 3; /* more than two edits are another word */
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

/* Prints the candidates for the last word. */
static int complete(int n, char **words)
{
    const struct command *const command = n > 1 ? find(words[0]) : NULL;
    if (n == 0 || (n > 1 && !command))
        return WB_EXIT_OK;
    wb_complete_begin(words[n - 1], n > 1 ? words[n - 2] : "");
    words[n - 1] = NULL;
    if (command) {
        /* The command ends the process where it would parse its options; `import` and `solve`
         * without a kind return after printing the names of the kinds. */
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
    /* At the file size limit write() fails instead of ending the process. */
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
        wb_error("unknown command '%s': did you mean `wirebench %s`?", name, meant);
        return WB_EXIT_USAGE;
    }
    if (argc > 1)
        wb_error("unknown command '%s'", name);
    print_usage(stderr);
    return WB_EXIT_USAGE;
}
