/* wirebench export --to KIND: the law of a wire as a card. */
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "analysis/cards/card.h"
#include "cli/export.h"
#include "cli/file_kind.h"
#include "cli/settings.h"

#define WB_LOG_DOMAIN "export"

struct options {
    struct wb_command_common common;
    const struct wb_card_kind *kind;
    struct wb_card_settings settings;
};

static const struct argp_option other_options[] = {
    /* find_kind() reads it, because the other options depend on it. */
    {"to", WB_KEY_IGNORED, "KIND", 0, "Kind of card: calculix, abaqus, mujoco, table, table-csv"},
    {"output", 'o', "FILE", 0, "Write the card here; by default it is printed"},
    {"force", WB_KEY_FORCE, NULL, 0, "Overwrite the file"},
    {0},
};

static const struct argp argp = {
    .options = other_options,
    .parser = wb_command_parse_common,
    .args_doc = "WIRE|FILE --to KIND",
    .doc = "Writes the law of a wire as a card, an input of another program, from a wire file with "
           "properties (a shipped one by its name) or from a properties file of `wirebench "
           "calibrate`. The card states units, law, interval, range of curvature, test conditions "
           "and checksums; its first line says whether the data are virtual or simulated.",
};

static const struct wb_settings_source sources[] = {
    {.tables = &wb_card_table, .n_tables = 1, .offset = offsetof(struct options, settings)},
};

/* The argument of the last --to, or NULL. */
static const char *find_kind(int argc, char **argv)
{
    const char *name = NULL;
    for (int i = 1; i < argc; i++) {
        if (strncmp(argv[i], "--to=", 5) == 0)
            name = argv[i] + 5;
        else if (strcmp(argv[i], "--to") == 0 && i + 1 < argc)
            name = argv[i + 1];
    }
    return name;
}

static enum wb_status write_card(const struct options *o, const struct wb_text *card)
{
    if (o->common.output) {
        WB_TRY(wb_command_check_output(o->common.output, o->common.force));
        return wb_file_write_text(o->common.output, card);
    }
    if (fwrite(card->bytes, 1, card->length, stdout) != card->length || fflush(stdout) != 0)
        return wb_fail(WB_ERR_IO, "the card cannot be written to standard output");
    return WB_OK;
}

int wb_export_card(int argc, char **argv)
{
    struct options o = {.common = {.noun = "wire or properties file"}};
    struct wb_card_source source;
    struct wb_text card = {0};
    const char *const name = find_kind(argc, argv);
    if (name && !(o.kind = wb_card_find(name)))
        return WB_EXIT_USAGE;
    const struct wb_settings_command command = {
        .argp = &argp,
        .sources = sources,
        .n_sources = 1,
        .place = o.kind ? o.kind->place : 0,
        .places = wb_card_places,
    };
    wb_setting_fill(&wb_card_table, &o.settings);
    wb_settings_parse(&command, argc, argv, &o);
    char path[WB_PATH];
    enum wb_status status = wb_file_find_fixture(path, "wires", o.common.input, NULL);
    if (status == WB_OK)
        status =
            wb_file_kind_check(path, WB_FILE_BIT(WB_FILE_WIRE) | WB_FILE_BIT(WB_FILE_PROPERTIES));
    if (status == WB_OK)
        status = wb_card_source_read(&source, path);
    if (status == WB_OK)
        status = wb_card_write(o.kind, &source, &o.settings, &card, NULL);
    if (status == WB_OK)
        status = write_card(&o, &card);
    wb_text_release(&card);
    return wb_command_exit(status);
}
