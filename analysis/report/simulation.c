#include "analysis/report/simulation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/keys/row.h"
#include "analysis/report/reasons.h"
#include "base/memory.h"
#include "fe/model/model_inputs.h"

#define WB_LOG_DOMAIN "report"

static const char shipped[] = "simulations";

/* --- wanted datasets --- */

enum wb_status wb_simulation_find(struct wb_simulation *simulation,
                                  const struct wb_campaign *campaign, const char *given)
{
    char folder[WB_PATH];
    simulation->wanted = true;
    snprintf(simulation->log, sizeof simulation->log, "%.120s", wb_file_name(given));
    if (strchr(given, '/')) {
        /* Datasets in other folders may have the same last part. */
        char hash[WB_SHA256_TEXT];
        wb_hash_bytes(given, strlen(given), hash);
        snprintf(simulation->log, sizeof simulation->log, "%.100s-%.8s", wb_file_name(given), hash);
        snprintf(simulation->name, sizeof simulation->name, "%.250s", wb_campaign_as_shown(given));
        return wb_file_join(simulation->path, campaign->folder, given);
    }
    const char *const shown = wb_campaign_as_shown(campaign->simulations);
    const bool has_name = shown[0] && strcmp(shown, ".") != 0;
    snprintf(simulation->name, sizeof simulation->name, "%.120s/%.120s", has_name ? shown : shipped,
             given);
    if (campaign->simulations[0])
        WB_TRY(wb_file_join(folder, campaign->folder, campaign->simulations));
    else if (wb_file_find_data(folder, shipped) != WB_OK)
        snprintf(folder, sizeof folder, "%s", shipped);
    return wb_file_join(simulation->path, folder, given);
}

static void show(struct wb_simulation *simulation, const char *word)
{
    struct wb_text *const command = &simulation->command;
    if (command->length > 0)
        wb_text_append(command, " ");
    wb_text_append_quoted(command, word);
}

static void show_command(struct wb_simulation *simulation, const char *shown)
{
    struct wb_solve_settings settings = simulation->settings;
    if (settings.model)
        settings.model = shown;
    char **const words = wb_solve_settings_command(&settings);
    show(simulation, "wirebench");
    for (char **word = words; *word; word++)
        show(simulation, *word);
    show(simulation, "-o");
    show(simulation, simulation->name);
    free(words);
}

void wb_simulation_set(struct wb_simulation *simulation, const struct wb_solve_settings *settings,
                       const char *shown, struct wb_json *inputs)
{
    simulation->inputs = inputs;
    wb_model_inputs_sum(inputs, simulation->inputs_sha256);
    simulation->settings = *settings;
    if (settings->model)
        simulation->settings.model = wb_memory_text(settings->model);
    show_command(simulation, shown);
}

void wb_simulation_release(struct wb_simulation *simulation)
{
    free((char *)simulation->settings.model);
    wb_json_destroy(simulation->inputs);
    wb_text_release(&simulation->command);
}

/* --- datasets that exist --- */

double wb_simulation_number(const struct wb_json *object, const char *key)
{
    double value;
    return wb_json_get_number(object, key, &value) ? value : (double)NAN;
}

const struct wb_json *wb_simulation_of(const struct wb_simulation_result *result)
{
    return wb_json_get(result->dataset.document, "simulation");
}

static const struct wb_key wb_simulation_state_rows[] = {
    {"dataset", WB_AT(struct wb_simulation, name), "name of the dataset"},
    {"state", WB_CHOICE(struct wb_simulation_result, state), "whether the dataset is used",
     .choices = "not wanted|missing|outdated|refused|used"},
    {"command", TEXT, "command that computes it"},
    {"problem", TEXT | OPTIONAL, "why it is not used"},
};
WB_KEYS(wb_simulation_state, "simulation_state", "");

void wb_simulation_describe(struct wb_json *object, const struct wb_simulation *wanted,
                            const struct wb_simulation_result *result)
{
    WB_PUT(object, &wb_simulation_state_keys, struct wb_simulation, wanted);
    WB_PUT(object, &wb_simulation_state_keys, struct wb_simulation_result, result);
    wb_json_set_text(object, "command", wb_text_string(&wanted->command));
    if (result->state != WB_SIMULATION_USABLE)
        wb_json_set_text(object, "problem", wb_text_string(&result->problem));
}

bool wb_simulation_is_missing(const struct wb_simulation_result *result)
{
    return result->state == WB_SIMULATION_MISSING || result->state == WB_SIMULATION_STALE;
}

/* Those of the planar beam say only whether they converged. */
static bool is_whole(const struct wb_simulation_result *result)
{
    bool is = false;
    if (!wb_json_get_boolean(result->dataset.document, "complete", &is))
        (void)wb_json_get_boolean(wb_simulation_of(result), "converged", &is);
    return is;
}

/* Whether it is of the inputs that are wanted, and whole. *stale: making it again mends that. */
static enum wb_status check(const struct wb_simulation_result *result,
                            const struct wb_simulation *wanted, bool *stale, struct wb_reason *why)
{
    const struct wb_json *const simulation = wb_simulation_of(result);
    const struct wb_json *const inputs = wb_json_get(simulation, "inputs");
    const char *const solver = wb_solve_settings_kind(&wanted->settings);
    const char *made_by = "", *problem = "";
    struct wb_json_difference found;
    if (!result->dataset.info.is_simulation || !wb_json_get_text(simulation, "model", &made_by) ||
        strcmp(made_by, solver) != 0)
        return wb_fail_to(why, WB_ERR_DATA, "it was not made by 'solve %s'%s%s%s", solver,
                          made_by[0] ? " but by 'solve " : "", made_by, made_by[0] ? "'" : "");
    *stale = true;
    if (!inputs)
        return wb_fail_to(why, WB_ERR_DATA,
                          "it does not name its inputs, as datasets of older versions");
    if (wb_json_differs(inputs, wanted->inputs, 1e-9, NULL, &found))
        return wb_fail_to(why, WB_ERR_DATA, "%s is %s in it, and %s is wanted", found.first.place,
                          found.first.a, found.first.b);
    (void)wb_json_get_text(simulation, "problem", &problem);
    if (!is_whole(result))
        return wb_fail_to(why, WB_ERR_DATA, "it did not come to its end%s%s",
                          problem[0] ? ": " : "", problem);
    *stale = false;
    return WB_OK;
}

static enum wb_status read(struct wb_simulation_result *result, const struct wb_simulation *wanted,
                           const struct wb_simulation_reader *reader, bool *stale,
                           struct wb_reason *why)
{
    const char *revision = "";
    char rows[WB_PATH];
    WB_TRY(wb_dataset_read(&result->dataset, wanted->path, why));
    (void)wb_json_get_text(wb_json_get(result->dataset.document, "tool"), "revision", &revision);
    snprintf(result->revision, sizeof result->revision, "%s", revision);
    result->cpu_s = wb_simulation_number(wb_simulation_of(result), "cpu_s");
    WB_TRY(check(result, wanted, stale, why));
    WB_TRY(wb_file_join(rows, wanted->path, "force_deflection.csv"));
    WB_TRY(wb_hash_file(rows, result->sha256));
    return reader->take ? reader->take(reader->context, why) : WB_OK;
}

void wb_simulation_load(struct wb_simulation_result *result, const struct wb_simulation *wanted,
                        const struct wb_simulation_reader *reader)
{
    char file[WB_PATH];
    bool stale = false;
    result->cpu_s = (double)NAN;
    if (!wanted->wanted)
        return;
    result->state = WB_SIMULATION_MISSING;
    if (wb_file_join(file, wanted->path, "dataset.json") != WB_OK || !wb_file_exists(file)) {
        wb_text_append(&result->problem, "there is no such dataset");
        return;
    }
    const struct wb_reasons reasons = {&result->problem, wanted->path, wanted->name};
    struct wb_reason why = {.text = ""};
    const enum wb_status status = read(result, wanted, reader, &stale, &why);
    result->state = status == WB_OK ? WB_SIMULATION_USABLE
                    : stale         ? WB_SIMULATION_STALE
                                    : WB_SIMULATION_REFUSED;
    if (status != WB_OK)
        wb_reasons_warn(&reasons, status, &why);
}

void wb_simulation_result_release(struct wb_simulation_result *result)
{
    wb_text_release(&result->problem);
    wb_dataset_release(&result->dataset);
}

/* --- all of a report --- */

void wb_simulation_count(wb_simulation_list *list, const void *results, int *n_wanted,
                         int *n_usable)
{
    struct wb_simulation_entry entry;
    *n_wanted = *n_usable = 0;
    for (int i = 0; list(results, i, &entry); i++) {
        *n_wanted += entry.wanted->wanted;
        *n_usable += entry.result->state == WB_SIMULATION_USABLE;
    }
}

void wb_simulation_print_missing(FILE *out, wb_simulation_list *list, const void *results)
{
    struct wb_simulation_entry entry;
    for (int i = 0; list(results, i, &entry); i++) {
        if (entry.wanted->wanted && entry.result->state != WB_SIMULATION_USABLE)
            fprintf(out, "  %s: %s; to make it:\n    %s\n", entry.wanted->name,
                    wb_text_string(&entry.result->problem), wb_text_string(&entry.wanted->command));
    }
}

void wb_simulation_print_json(FILE *out, wb_simulation_list *list, const void *results)
{
    struct wb_simulation_entry entry;
    struct wb_json *const root = wb_json_create();
    struct wb_json *const datasets = wb_json_set_array(root, "datasets");
    for (int i = 0; list(results, i, &entry); i++) {
        if (!entry.wanted->wanted)
            continue;
        struct wb_json *const object = wb_json_append_object(datasets);
        wb_simulation_describe(object, entry.wanted, entry.result);
        if (entry.wanted->inputs)
            wb_json_set_copy(object, "inputs", entry.wanted->inputs);
    }
    char *const text = wb_json_format(root);
    wb_json_destroy(root);
    fputs(text, out);
    free(text);
}
