/* wirebench import: tests that others made, from their files. */
#include <stdio.h>
#include <string.h>

#include "cli/command.h"
#include "cli/complete.h"
#include "cli/import.h"

#define WB_LOG_DOMAIN "import"

static const struct {
    const char *name;
    int (*run)(int argc, char **argv);
    const char *summary;
} kinds[] = {
    {"force", wb_import_force, "the curve of a testing machine to a dataset"},
    {"mocap", wb_import_mocap, "a take of motion capture (CSV, C3D, TRC) to a recording"},
};

static void print_usage(FILE *file)
{
    fprintf(file, "Usage: wirebench import KIND FILE [options]\n"
                  "Makes a recording or a dataset of files that other programs wrote.\n\n");
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        fprintf(file, "  %-10s %s\n", kinds[i].name, kinds[i].summary);
    fprintf(file, "\n  -h, --help   this help; `wirebench import KIND --help` for one kind\n");
}

int wb_cmd_import(int argc, char **argv)
{
    const char *const name = argc > 1 ? argv[1] : "";
    if (strcmp(name, "-h") == 0 || strcmp(name, "--help") == 0 || strcmp(name, "--usage") == 0) {
        print_usage(stdout);
        return WB_EXIT_OK;
    }
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        if (strcmp(kinds[i].name, name) != 0)
            continue;
        /* The command's name in its help and messages. */
        char both[32];
        snprintf(both, sizeof both, "import %s", name);
        argv[1] = both;
        return kinds[i].run(argc - 1, argv + 1);
    }
    if (wb_complete_is_on()) {
        if (argc == 1)
            for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
                wb_complete_print(kinds[i].name, kinds[i].summary);
        return WB_EXIT_OK;
    }
    if (argc > 1)
        wb_error("import: '%s' is not known; expected one of the kinds below", name);
    print_usage(stderr);
    return WB_EXIT_USAGE;
}
