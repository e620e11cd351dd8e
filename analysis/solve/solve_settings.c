#include "analysis/solve/solve_settings.h"

#include <stddef.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "solve"

const char *const wb_solve_settings_kinds[WB_SOLVE_KINDS + 1] = {
    "cantilever", "wire3d", "wire1d", "bundle", "bending3p", "harness", NULL};

static const char *const laws[] = {
    [WB_SOLVE_ELASTOPLASTIC] = "elastoplastic", [WB_SOLVE_ELASTIC] = "elastic", NULL};

static const char *const bundle_models[] = {
    [WB_SOLVE_EXPLICIT] = "explicit", [WB_SOLVE_SECTION] = "section", NULL};

static const struct wb_setting rows[] = {
    {WB_ROW_TEXT(wb_solve_settings, wire, "wire"),
     WB_ROW_OPTION(
         "wire", "NAME|FILE",
         "Wire with its properties: a wire file, a properties file of `wirebench calibrate`, or "
         "a name in fixtures/wires"),
     .applies = WB_SOLVE_CANTILEVER},
    {WB_ROW_QUANTITY(wb_solve_settings, length, "length_mm", "mm", WB_MM, 1e-3, 1e6, 0.0),
     WB_ROW_OPTION("length-mm", "L", "Free length from clamp to tip"), .required = true,
     .applies = WB_SOLVE_CANTILEVER},
    {WB_ROW_QUANTITY(wb_solve_settings, deflection, "deflection_mm", "mm", WB_MM, 1e-6, 1e6, 0.0),
     WB_ROW_OPTION("deflection-mm", "D", "Largest deflection of the tip, or of the nose"),
     .required = true, .applies = WB_SOLVE_CANTILEVER | WB_SOLVE_THREE_POINT},
    {WB_ROW_CHOICE(wb_solve_settings, law, "law", laws, 0),
     WB_ROW_OPTION("law", "LAW", "Law of the material"),
     .applies = WB_SOLVE_CANTILEVER | WB_SOLVE_THREE_POINT | WB_SOLVE_HARNESS},
    {WB_ROW_QUANTITY(wb_solve_settings, strand, "strand_mm", "mm", WB_MM, 1e-3, 1e9, 0.0),
     WB_ROW_OPTION(
         "strand-mm", "S",
         "Length of the strand that raises the tip, fixed straight above the straight wire's "
         "tip"),
     .otherwise = "the force is vertical and may push", .applies = WB_SOLVE_CANTILEVER},
    {WB_ROW_BOOLEAN(wb_solve_settings, weight, "weight", false),
     WB_ROW_OPTION("weight", NULL, "Include the wire's weight, which acts against the deflection"),
     .applies = WB_SOLVE_CANTILEVER},
    {WB_ROW_INTEGER(wb_solve_settings, cycles, "cycles", 1, 1000, 0),
     WB_ROW_OPTION("cycles", "N", "Load and unload N times"), .otherwise = "load once",
     .applies = WB_SOLVE_CANTILEVER | WB_SOLVE_THREE_POINT},
    {WB_ROW_INTEGER(wb_solve_settings, points, "points", 1, 100000, 53),
     WB_ROW_OPTION("points", "N", "Equal steps to the largest deflection"),
     .applies = WB_SOLVE_CANTILEVER | WB_SOLVE_THREE_POINT},
    {WB_ROW_QUANTITY(wb_solve_settings, span, "span_mm", "mm", WB_MM, 0.01, 1e5, 0.0),
     WB_ROW_OPTION("span-mm", "L", "Distance between the axes of the rollers"), .required = true,
     .applies = WB_SOLVE_THREE_POINT},
    {WB_ROW_QUANTITY(wb_solve_settings, overhang, "overhang_mm", "mm", WB_MM, 1e-3, 1e5, 0.0),
     WB_ROW_OPTION("overhang-mm", "A", "Length of the wire beyond either roller's axis"),
     .otherwise = "0.3 of the span", .applies = WB_SOLVE_THREE_POINT},
    {WB_ROW_QUANTITY(wb_solve_settings, roller_radius, "roller_radius_mm", "mm", WB_MM, 0.0, 1e4,
                     0.0),
     WB_ROW_OPTION("roller-radius-mm", "R", "Radius of the rollers"),
     .applies = WB_SOLVE_THREE_POINT},
    {WB_ROW_QUANTITY(wb_solve_settings, nose_radius, "nose_radius_mm", "mm", WB_MM, 0.0, 1e4, 0.0),
     WB_ROW_OPTION("nose-radius-mm", "R", "Radius of the nose"), .applies = WB_SOLVE_THREE_POINT},
    {WB_ROW_NUMBER(wb_solve_settings, friction, "roller_friction", 0.0, 10.0, 0.0),
     WB_ROW_OPTION("roller-friction", "MU", "Coefficient of friction between wire and rollers"),
     .applies = WB_SOLVE_THREE_POINT},
    {WB_ROW_QUANTITY(wb_solve_settings, compliance, "compliance_mm_N", "mm/N", WB_MM, 0.0, 1e4,
                     0.0),
     WB_ROW_OPTION("compliance-mm-n", "C",
                   "Machine compliance; the deflection of a row is then the machine's travel"),
     .applies = WB_SOLVE_THREE_POINT},
    {WB_ROW_QUANTITY(wb_solve_settings, bow, "bow_mm", "mm", WB_MM, -1e4, 1e4, 0.0),
     WB_ROW_OPTION("bow-mm", "B",
                   "Rise of the natural arc over the span, positive if concave upwards"),
     .applies = WB_SOLVE_THREE_POINT},
    {WB_ROW_BOOLEAN(wb_solve_settings, whole, "whole", false),
     WB_ROW_OPTION("whole", NULL, "Compute the whole wire, not half by symmetry"),
     .applies = WB_SOLVE_THREE_POINT},
    {WB_ROW_TEXT(wb_solve_settings, vtk, "vtk"),
     WB_ROW_OPTION("vtk", "DIR", "Write the state of every row, or step, for ParaView"),
     .applies = WB_SOLVE_WIRE3D | WB_SOLVE_BUNDLE | WB_SOLVE_HARNESS},
    {WB_ROW_TEXT(wb_solve_settings, gltf, "gltf"),
     WB_ROW_OPTION("gltf", "FILE.glb",
                   "Write the shapes as an animated 3D scene for browsers and CAD (binary glTF)"),
     .applies = WB_SOLVE_HARNESS},
    {WB_ROW_INTEGER(wb_solve_settings, frames, "frames", 1, 1000, 0),
     WB_ROW_OPTION("frames", "N", "Write N shapes of each step, the last of which is its end"),
     .otherwise = "the end alone", .applies = WB_SOLVE_HARNESS},
    {WB_ROW_CHOICE(wb_solve_settings, bundle_model, "model", bundle_models, 0),
     WB_ROW_OPTION("model", "MODEL",
                   "Compute hexahedra in explicit dynamics (minutes) or a beam whose wires slip on "
                   "each other (less than a second)"),
     .applies = WB_SOLVE_BUNDLE},
    {WB_ROW_INTEGER(wb_solve_settings, vtk_every, "vtk_every", 1, 100000, 0),
     WB_ROW_OPTION("vtk-every", "N",
                   "With --vtk, write every Nth row only, and the largest deflection"),
     .otherwise = "1", .applies = WB_SOLVE_BUNDLE},
    {WB_ROW_INTEGER(wb_solve_settings, threads, "threads", 1, 1024, 1),
     WB_ROW_OPTION("threads", "N",
                   "Compute N parts along the axis in parallel threads; with mpirun, in each rank"),
     .applies = WB_SOLVE_BUNDLE},
    {WB_ROW_TEXT(wb_solve_settings, checkpoint, "checkpoint"),
     WB_ROW_OPTION(
         "checkpoint", "FILE",
         "Write checkpoints of the run to this file; run the same command again to continue"),
     .applies = WB_SOLVE_BUNDLE},
    {WB_ROW_QUANTITY(wb_solve_settings, checkpoint_interval, "checkpoint_minutes", "minutes", 60.0,
                     1e-3, 1e5, 0.0),
     WB_ROW_OPTION("checkpoint-minutes", "M", "With --checkpoint, time between checkpoints"),
     .otherwise = "10", .applies = WB_SOLVE_BUNDLE},
    {WB_ROW_BOOLEAN(wb_solve_settings, uncertain, "uncertain", false),
     WB_ROW_OPTION(
         "uncertain", NULL,
         "Compute bands: of a bundle, 90 % from the file's `uncertainty` with the section "
         "model; of a harness, 95 % from the specimens of its wires"),
     .applies = WB_SOLVE_BUNDLE | WB_SOLVE_HARNESS},
    {WB_ROW_INTEGER(wb_solve_settings, runs, "runs", 20, 100000, 500),
     WB_ROW_OPTION("runs", "N", "With --uncertain, runs of each case, or of the harness"),
     .applies = WB_SOLVE_BUNDLE | WB_SOLVE_HARNESS},
    {WB_ROW_INTEGER(wb_solve_settings, seed, "seed", 0, 1000000000, 1),
     WB_ROW_OPTION("seed", "N",
                   "With --uncertain, seed of the runs; the same seed gives the same output"),
     .applies = WB_SOLVE_BUNDLE | WB_SOLVE_HARNESS},
    {WB_ROW_TEXT(wb_solve_settings, sweep, "sweep"),
     WB_ROW_OPTION("sweep", "KEY=A,B[:KEY=...]",
                   "With --uncertain, cases in place of the file's scenarios: all combinations of "
                   "layers, overlap (percent) and wires"),
     .applies = WB_SOLVE_BUNDLE},
    {WB_ROW_BOOLEAN(wb_solve_settings, follow, "follow", false),
     WB_ROW_OPTION("follow", NULL,
                   "Take steps as lines of JSON from standard input, and answer each with a line"),
     .applies = WB_SOLVE_HARNESS},
    {WB_ROW_TEXT(wb_solve_settings, part, "part"),
     WB_ROW_OPTION("part", "K/N",
                   "With --uncertain, compute the runs of part K of N only, as a task of --slurm"),
     .applies = WB_SOLVE_HARNESS},
};

const struct wb_setting_table wb_solve_settings_table = {WB_SETTING_ROWS(rows)};

enum wb_status wb_solve_settings_check(const struct wb_solve_settings *settings)
{
    struct wb_solve_settings defaults = {0};
    wb_setting_fill(&wb_solve_settings_table, &defaults);
    const bool is_default = settings->runs == defaults.runs && settings->seed == defaults.seed;
    if (settings->uncertain || settings->runs == 0 /* never filled */ || is_default)
        return WB_OK;
    return wb_fail(WB_ERR_ARGUMENT, "--runs and --seed apply only with --uncertain");
}

const char *wb_solve_settings_kind(const struct wb_solve_settings *settings)
{
    int i = 0;
    while (i < WB_SOLVE_KINDS - 1 && settings->kind != 1U << i)
        i++;
    return wb_solve_settings_kinds[i];
}

/* --- settings as a command --- */

/* Words one after the other, each followed by a NUL. */
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
    /* Texts, such as paths, may be longer than the buffer for other values. */
    if (row->type == WB_SETTING_TEXT && row->size == 0) {
        add_word(words, "", *(const char *const *)((const char *)settings + row->offset));
        return;
    }
    wb_setting_format(row, settings, value);
    add_word(words, "", value);
}

/* The override's tables in the order of the options, and the first row of each; rows before it come
 * last. */
static const struct {
    int table, first;
} order[] = {{WB_BUNDLE_OVERRIDE_PIECE, 0},
             {WB_BUNDLE_OVERRIDE_TEST, 0},
             {WB_BUNDLE_OVERRIDE_LOADS, 0},
             {WB_BUNDLE_OVERRIDE_FRICTION, 0},
             {WB_BUNDLE_OVERRIDE_COHESION, 0},
             {WB_BUNDLE_OVERRIDE_MESH, 0},
             {WB_BUNDLE_OVERRIDE_RUN, 1 /* the duration is its last row */}};
_Static_assert(WB_COUNT(order) == WB_BUNDLE_OVERRIDE_TABLES, "each table has its place");

/* Adds the given options that override the bundle file. */
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

/* One block: pointers to the words, then the words. */
static char **pack(const struct words *words)
{
    const size_t pointers = (words->n + 1) * sizeof(char *);
    char **const block = wb_memory_new(pointers + words->texts.length, 1);
    char *text = (char *)block + pointers;
    memcpy(text, words->texts.bytes, words->texts.length);
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
