#include "analysis/solve/solve_settings.h"

#include <stddef.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "base/units.h"

const char *const wb_solve_settings_kinds[WB_SOLVE_KINDS + 1] = {
    "cantilever", "wire3d", "wire1d", "bundle", "bending3p", NULL};

static const char *const laws[] = {
    [WB_SOLVE_ELASTOPLASTIC] = "elastoplastic", [WB_SOLVE_ELASTIC] = "elastic", NULL};

static const char *const bundle_models[] = {
    [WB_SOLVE_EXPLICIT] = "explicit", [WB_SOLVE_SECTION] = "section", NULL};

static const struct wb_setting rows[] = {
    {.name = "wire",
     .type = WB_SETTING_TEXT,
     .offset = offsetof(struct wb_solve_settings, wire),
     .option = "wire",
     .argument = "NAME|FILE",
     .help = "Wire with its properties, a file or one of fixtures/wires",
     .applies = WB_SOLVE_CANTILEVER},
    {.name = "length_mm",
     .unit = "mm",
     .type = WB_SETTING_NUMBER,
     .offset = offsetof(struct wb_solve_settings, length),
     .scale = WB_MM,
     .least = 1e-3,
     .largest = 1e6,
     .required = true,
     .option = "length-mm",
     .argument = "L",
     .help = "Free length from clamp to tip",
     .applies = WB_SOLVE_CANTILEVER},
    {.name = "deflection_mm",
     .unit = "mm",
     .type = WB_SETTING_NUMBER,
     .offset = offsetof(struct wb_solve_settings, deflection),
     .scale = WB_MM,
     .least = 1e-6,
     .largest = 1e6,
     .required = true,
     .option = "deflection-mm",
     .argument = "D",
     .help = "Largest deflection of the tip, or of the nose",
     .applies = WB_SOLVE_CANTILEVER | WB_SOLVE_THREE_POINT},
    {.name = "law",
     .type = WB_SETTING_CHOICE,
     .offset = offsetof(struct wb_solve_settings, law),
     .choices = laws,
     .option = "law",
     .argument = "LAW",
     .help = "Law of the material",
     .applies = WB_SOLVE_CANTILEVER | WB_SOLVE_THREE_POINT},
    {.name = "strand_mm",
     .unit = "mm",
     .type = WB_SETTING_NUMBER,
     .offset = offsetof(struct wb_solve_settings, strand),
     .scale = WB_MM,
     .least = 1e-3,
     .largest = 1e9,
     .otherwise = "the force is vertical and may push",
     .option = "strand-mm",
     .argument = "S",
     .help = "Length of the strand that raises the tip, fixed straight above the straight wire's "
             "tip",
     .applies = WB_SOLVE_CANTILEVER},
    {.name = "weight",
     .type = WB_SETTING_BOOLEAN,
     .offset = offsetof(struct wb_solve_settings, weight),
     .option = "weight",
     .help = "Let the wire's weight act, against the deflection",
     .applies = WB_SOLVE_CANTILEVER},
    {.name = "cycles",
     .type = WB_SETTING_INTEGER,
     .offset = offsetof(struct wb_solve_settings, cycles),
     .least = 1,
     .largest = 1000,
     .otherwise = "load once",
     .option = "cycles",
     .argument = "N",
     .help = "Load and unload N times",
     .applies = WB_SOLVE_CANTILEVER | WB_SOLVE_THREE_POINT},
    {.name = "points",
     .type = WB_SETTING_INTEGER,
     .offset = offsetof(struct wb_solve_settings, points),
     .least = 1,
     .largest = 100000,
     .fallback = 53,
     .option = "points",
     .argument = "N",
     .help = "Equal steps to the largest deflection",
     .applies = WB_SOLVE_CANTILEVER | WB_SOLVE_THREE_POINT},
    {.name = "span_mm",
     .unit = "mm",
     .type = WB_SETTING_NUMBER,
     .offset = offsetof(struct wb_solve_settings, span),
     .scale = WB_MM,
     .least = 0.01,
     .largest = 1e5,
     .required = true,
     .option = "span-mm",
     .argument = "L",
     .help = "Distance between the axes of the rollers",
     .applies = WB_SOLVE_THREE_POINT},
    {.name = "overhang_mm",
     .unit = "mm",
     .type = WB_SETTING_NUMBER,
     .offset = offsetof(struct wb_solve_settings, overhang),
     .scale = WB_MM,
     .least = 1e-3,
     .largest = 1e5,
     .otherwise = "0.3 of the span",
     .option = "overhang-mm",
     .argument = "A",
     .help = "Length of the wire beyond either roller's axis",
     .applies = WB_SOLVE_THREE_POINT},
    {.name = "roller_radius_mm",
     .unit = "mm",
     .type = WB_SETTING_NUMBER,
     .offset = offsetof(struct wb_solve_settings, roller_radius),
     .scale = WB_MM,
     .largest = 1e4,
     .option = "roller-radius-mm",
     .argument = "R",
     .help = "Radius of the rollers",
     .applies = WB_SOLVE_THREE_POINT},
    {.name = "nose_radius_mm",
     .unit = "mm",
     .type = WB_SETTING_NUMBER,
     .offset = offsetof(struct wb_solve_settings, nose_radius),
     .scale = WB_MM,
     .largest = 1e4,
     .option = "nose-radius-mm",
     .argument = "R",
     .help = "Radius of the nose",
     .applies = WB_SOLVE_THREE_POINT},
    {.name = "roller_friction",
     .type = WB_SETTING_NUMBER,
     .offset = offsetof(struct wb_solve_settings, friction),
     .largest = 10.0,
     .option = "roller-friction",
     .argument = "MU",
     .help = "Coefficient of friction between wire and rollers",
     .applies = WB_SOLVE_THREE_POINT},
    {.name = "compliance_mm_N",
     .unit = "mm/N",
     .type = WB_SETTING_NUMBER,
     .offset = offsetof(struct wb_solve_settings, compliance),
     .scale = WB_MM,
     .largest = 1e4,
     .option = "compliance-mm-n",
     .argument = "C",
     .help = "What the machine gives way; the deflection of a row is then its travel",
     .applies = WB_SOLVE_THREE_POINT},
    {.name = "bow_mm",
     .unit = "mm",
     .type = WB_SETTING_NUMBER,
     .offset = offsetof(struct wb_solve_settings, bow),
     .scale = WB_MM,
     .least = -1e4,
     .largest = 1e4,
     .option = "bow-mm",
     .argument = "B",
     .help = "Rise of the natural shape's arc over the span, positive where it is hollow upwards",
     .applies = WB_SOLVE_THREE_POINT},
    {.name = "whole",
     .type = WB_SETTING_BOOLEAN,
     .offset = offsetof(struct wb_solve_settings, whole),
     .option = "whole",
     .help = "Compute the whole wire, not half by symmetry",
     .applies = WB_SOLVE_THREE_POINT},
    {.name = "vtk",
     .type = WB_SETTING_TEXT,
     .offset = offsetof(struct wb_solve_settings, vtk),
     .option = "vtk",
     .argument = "DIR",
     .help = "Write every row's stress field for ParaView",
     .applies = WB_SOLVE_WIRE3D | WB_SOLVE_BUNDLE},
    {.name = "model",
     .type = WB_SETTING_CHOICE,
     .offset = offsetof(struct wb_solve_settings, bundle_model),
     .choices = bundle_models,
     .option = "model",
     .argument = "MODEL",
     .help = "Compute hexahedra in explicit dynamics, in minutes, or a beam whose wires slip on "
             "each other, in a fraction of a second",
     .applies = WB_SOLVE_BUNDLE},
    {.name = "vtk_every",
     .type = WB_SETTING_INTEGER,
     .offset = offsetof(struct wb_solve_settings, vtk_every),
     .least = 1,
     .largest = 100000,
     .otherwise = "1",
     .option = "vtk-every",
     .argument = "N",
     .help = "With --vtk, write every Nth row only, and the largest deflection",
     .applies = WB_SOLVE_BUNDLE},
    {.name = "threads",
     .type = WB_SETTING_INTEGER,
     .offset = offsetof(struct wb_solve_settings, threads),
     .least = 1,
     .largest = 1024,
     .fallback = 1,
     .option = "threads",
     .argument = "N",
     .help = "Compute in N parts along the axis, on as many cores; with mpirun, of each rank",
     .applies = WB_SOLVE_BUNDLE},
    {.name = "checkpoint",
     .type = WB_SETTING_TEXT,
     .offset = offsetof(struct wb_solve_settings, checkpoint),
     .option = "checkpoint",
     .argument = "FILE",
     .help = "Keep the run in this file every so often; a run that was ended goes on from it when "
             "the same command is given again",
     .applies = WB_SOLVE_BUNDLE},
    {.name = "checkpoint_minutes",
     .unit = "minutes",
     .type = WB_SETTING_NUMBER,
     .offset = offsetof(struct wb_solve_settings, checkpoint_interval),
     .scale = 60.0,
     .least = 1e-3,
     .largest = 1e5,
     .otherwise = "10",
     .option = "checkpoint-minutes",
     .argument = "M",
     .help = "With --checkpoint, time between checkpoints",
     .applies = WB_SOLVE_BUNDLE},
    {.name = "uncertain",
     .type = WB_SETTING_BOOLEAN,
     .offset = offsetof(struct wb_solve_settings, uncertain),
     .option = "uncertain",
     .help = "Bands of 90 % from what the file's `uncertainty` states, by the section model",
     .applies = WB_SOLVE_BUNDLE},
    {.name = "runs",
     .type = WB_SETTING_INTEGER,
     .offset = offsetof(struct wb_solve_settings, runs),
     .least = 20,
     .largest = 100000,
     .fallback = 500,
     .option = "runs",
     .argument = "N",
     .help = "With --uncertain, runs of each case",
     .applies = WB_SOLVE_BUNDLE},
    {.name = "seed",
     .type = WB_SETTING_INTEGER,
     .offset = offsetof(struct wb_solve_settings, seed),
     .least = 0,
     .largest = 1000000000,
     .fallback = 1,
     .option = "seed",
     .argument = "N",
     .help = "With --uncertain, seed of the runs: the same one gives the same bytes",
     .applies = WB_SOLVE_BUNDLE},
    {.name = "sweep",
     .type = WB_SETTING_TEXT,
     .offset = offsetof(struct wb_solve_settings, sweep),
     .option = "sweep",
     .argument = "KEY=A,B[:KEY=...]",
     .help = "With --uncertain, cases in place of the file's scenarios: all combinations of "
             "layers, overlap (percent) and wires",
     .applies = WB_SOLVE_BUNDLE},
};

const struct wb_setting_table wb_solve_settings_table = {.rows = rows, .n = WB_COUNT(rows)};

const char *wb_solve_settings_kind(const struct wb_solve_settings *settings)
{
    int i = 0;
    while (i < WB_SOLVE_KINDS - 1 && settings->kind != 1U << i)
        i++;
    return wb_solve_settings_kinds[i];
}

/* --- as a command --- */

/* Words one after the other, a NUL after each. */
struct words {
    struct wb_text texts;
    size_t n;
};

static void add_word(struct words *words, const char *before, const char *word)
{
    wb_text_append(&words->texts, "%s%s", before, word);
    wb_text_append_bytes(&words->texts, "", 1);
    words->n++;
}

static void add_option(struct words *words, const struct wb_setting *row, const void *settings)
{
    char value[WB_SETTING_VALUE];
    add_word(words, "--", row->option);
    if (row->type == WB_SETTING_BOOLEAN)
        return;
    /* Texts may be longer than values are: paths. */
    if (row->type == WB_SETTING_TEXT && row->size == 0) {
        add_word(words, "", *(const char *const *)((const char *)settings + row->offset));
        return;
    }
    wb_setting_format(row, settings, value);
    add_word(words, "", value);
}

/* The tables of the override in the order of their options, and the row each begins with; those
 * before it come last. */
static const struct {
    int table, first;
} order[] = {{WB_BUNDLE_OVERRIDE_PIECE, 0},
             {WB_BUNDLE_OVERRIDE_TEST, 0},
             {WB_BUNDLE_OVERRIDE_LOADS, 0},
             {WB_BUNDLE_OVERRIDE_FRICTION, 0},
             {WB_BUNDLE_OVERRIDE_COHESION, 0},
             {WB_BUNDLE_OVERRIDE_MESH, 0},
             {WB_BUNDLE_OVERRIDE_RUN, 1 /* the duration is its last */}};
_Static_assert(WB_COUNT(order) == WB_BUNDLE_OVERRIDE_TABLES, "each table has its place");

/* What is given, as it replaces what the bundle file says. */
static void add_override(struct words *words, const struct wb_bundle_override *override)
{
    for (size_t k = 0; k < WB_COUNT(order); k++) {
        const struct wb_setting_table *const table = &wb_bundle_override_tables[order[k].table];
        const void *const settings = (const char *) override + table->offset;
        for (size_t i = 0; i < table->n; i++) {
            const struct wb_setting *const row =
                &table->rows[((size_t)order[k].first + i) % table->n];
            if (wb_setting_is_given(row, settings))
                add_option(words, row, settings);
        }
    }
}

/* Pointers to the words, then the words. */
static char **pack(const struct words *words)
{
    const size_t pointers = (words->n + 1) * sizeof(char *);
    const char *const bytes = wb_memory_need(words->texts.failed ? NULL : words->texts.bytes);
    char **const block = wb_memory_new(pointers + words->texts.length, 1);
    char *text = (char *)block + pointers;
    memcpy(text, bytes, words->texts.length);
    for (size_t i = 0; i < words->n; i++, text += strlen(text) + 1)
        block[i] = text;
    block[words->n] = NULL;
    return block;
}

char **wb_solve_settings_command(const struct wb_solve_settings *settings)
{
    struct words words = {.n = 0};
    add_word(&words, "", "solve");
    add_word(&words, "", wb_solve_settings_kind(settings));
    if (settings->model)
        add_word(&words, "", settings->model);
    if (settings->kind == WB_SOLVE_BUNDLE)
        add_override(&words, &settings->override);
    for (size_t i = 0; i < WB_COUNT(rows); i++)
        if (wb_setting_applies(&rows[i], settings->kind) && wb_setting_differs(&rows[i], settings))
            add_option(&words, &rows[i], settings);
    char **const block = pack(&words);
    wb_text_release(&words.texts);
    return block;
}
