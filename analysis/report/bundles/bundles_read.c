/* The runs of a campaign of bundles: wb_bundles_run_read() of bundles.h. */
#include <stdio.h>
#include <string.h>

#include "analysis/dataset/simulated_bundle.h"
#include "analysis/report/bundles/bundles.h"
#include "base/config.h"
#include "base/memory.h"
#include "fe/model/bundle_override.h"

/* What a run has in place of its bundle's, as the command's options say it; has_... tells what else
 * was given. */
struct settings {
    struct wb_bundle_override override;
    bool has_load, has_weight, dead_force, weight;
};

/* --- reading --- */

enum {
    MOST_KEYS = 24,
    MOST_LISTS = 4
};

/* A row of the override that is a list in the file, or a number alone. */
struct list {
    const struct wb_setting *row;
    void *settings;
    const struct wb_config_node *node;
};

/* Keys of the override's rows, but of those that say it the other way round. */
static size_t add_rows(struct wb_bundle_override *o, struct wb_config_key *keys,
                       struct list lists[MOST_LISTS], int *n_lists)
{
    size_t n = 0;
    for (int t = 0; t < WB_BUNDLE_OVERRIDE_TABLES; t++) {
        const struct wb_setting_table *const table = &wb_bundle_override_tables[t];
        void *const settings = (char *)o + table->offset;
        if (t != WB_BUNDLE_OVERRIDE_LOADS)
            n += wb_setting_keys(table, 0, settings, keys + n);
        for (size_t i = 0; i < table->n; i++)
            if (table->rows[i].type == WB_SETTING_LIST)
                lists[(*n_lists)++] = (struct list){&table->rows[i], settings, NULL};
    }
    for (size_t i = 0; i < n; i++)
        keys[i].optional = true;
    return n;
}

/* A missing key leaves its value unchanged. The first n_own of `keys` are the caller's. */
static enum wb_status read_settings(struct settings *s, const struct wb_config_node *node,
                                    struct wb_config_key keys[MOST_KEYS], size_t n_own)
{
    struct wb_bundle_override *const o = &s->override;
    struct list lists[MOST_LISTS];
    int n_lists = 0;
    const struct wb_config_key loads[] = {
        WB_CONFIG_OPTIONAL_BOOLEAN("dead_force", &s->dead_force),
        WB_CONFIG_OPTIONAL_BOOLEAN("weight", &s->weight),
    };
    size_t n = n_own + add_rows(o, keys + n_own, lists, &n_lists);
    for (size_t i = 0; i < WB_COUNT(loads); i++)
        keys[n++] = loads[i];
    for (int i = 0; i < n_lists; i++)
        keys[n++] =
            (struct wb_config_key)WB_CONFIG_OPTIONAL_NODE(lists[i].row->name, &lists[i].node);
    WB_TRY(wb_config_map(node, keys, n));
    s->has_load |= wb_config_find(node, "dead_force") != NULL;
    s->has_weight |= wb_config_find(node, "weight") != NULL;
    for (int i = 0; i < n_lists; i++)
        if (lists[i].node)
            WB_TRY(wb_setting_read_list(lists[i].row, lists[i].node, lists[i].settings));
    return WB_OK;
}

/* --- the model as the run has it --- */

/* The command can only take strand and weight away. */
static enum wb_status read_model(const struct wb_bundles *all, const struct wb_config_node *node,
                                 const char *name, struct settings *s, struct wb_bundles_run *run,
                                 char path[WB_PATH])
{
    WB_TRY(wb_campaign_find(&all->head, node, "bundle", "bundles", name, path, run->model_name));
    run->model = wb_memory_new(1, sizeof *run->model);
    struct wb_bundle_model *const m = run->model;
    s->override.dead_force = s->dead_force;
    s->override.no_weight = s->has_weight && !s->weight;
    const enum wb_status status = wb_bundle_override_read(m, path, &s->override, NULL);
    if (status == WB_ERR_ARGUMENT)
        return wb_config_refuse(node, NULL, "the run cannot have these settings");
    WB_TRY(status);
    if (s->has_load && !s->dead_force && m->loads.strand_length == 0.0)
        return wb_config_refuse(node, "dead_force", "'%s' has no strand", m->name);
    if (s->has_weight && s->weight && !m->loads.weight)
        return wb_config_refuse(node, "weight", "'%s' has no weight", m->name);
    run->mesh = wb_bundle_model_mesh(m, m->run.mesh);
    return WB_OK;
}

/* --- runs --- */

static void set_label(struct wb_bundles_run *run)
{
    const struct wb_bundle_interface *const i = &run->model->interface;
    const struct wb_bundle_loads *const loads = &run->model->loads;
    char friction[80];
    if (run->label[0])
        return;
    snprintf(friction, sizeof friction, "friction %g", i->friction.mu_static);
    if (i->friction.mu_kinetic != i->friction.mu_static)
        snprintf(friction, sizeof friction, "friction %g to %g", i->friction.mu_static,
                 i->friction.mu_kinetic);
    snprintf(run->label, sizeof run->label, "%s%s%s", friction,
             loads->strand_length > 0.0 ? ", strand" : "", loads->weight ? ", weight" : "");
}

static enum wb_status read_run(const struct wb_bundles *all, const struct wb_config_node *node,
                               const struct settings *defaults, struct wb_bundles_run *run)
{
    struct settings settings = *defaults, *const s = &settings;
    struct wb_config_key keys[MOST_KEYS] = {{0}};
    char bundle[256], path[WB_PATH];
    keys[0] = (struct wb_config_key)WB_CONFIG_TEXT("name", run->name);
    keys[1] = (struct wb_config_key)WB_CONFIG_TEXT("bundle", bundle);
    keys[2] = (struct wb_config_key)WB_CONFIG_OPTIONAL_TEXT("label", run->label);
    run->judged = true;
    keys[3] = (struct wb_config_key)WB_CONFIG_OPTIONAL_BOOLEAN("judged", &run->judged);
    WB_TRY(read_settings(s, node, keys, 4));
    WB_TRY(read_model(all, node, bundle, s, run, path));
    set_label(run);
    WB_TRY(wb_simulation_find(&run->dataset, &all->head, run->name));
    struct wb_solve_settings solve = {.kind = WB_SOLVE_BUNDLE};
    wb_setting_fill(&wb_solve_settings_table, &solve);
    solve.model = path;
    solve.override = s->override;
    struct wb_json *const inputs = wb_json_create();
    wb_simulated_bundle_inputs(inputs, run->model, run->mesh);
    return wb_simulation_set(&run->dataset, &solve, run->model_name, inputs);
}

enum wb_status wb_bundles_run_read(struct wb_bundles *all, const struct wb_config_node *list,
                                   const struct wb_config_node *defaults)
{
    struct wb_config_key keys[MOST_KEYS] = {{0}};
    struct settings settings = {0};
    if (defaults)
        WB_TRY(read_settings(&settings, defaults, keys, 0));
    const int n = wb_config_length(list);
    if (n < 1 || n > WB_BUNDLES_RUNS)
        return wb_config_refuse(list, NULL, "runs: expected a list of 1 to %d runs",
                                WB_BUNDLES_RUNS);
    for (int i = 0; i < n; i++) {
        const struct wb_config_node *const node = wb_config_item(list, i);
        struct wb_bundles_run *const run = &all->runs[i];
        WB_TRY(read_run(all, node, &settings, run));
        for (int k = 0; k < i; k++) {
            if (strcmp(all->runs[k].dataset.path, run->dataset.path) == 0)
                return wb_config_refuse(node, "name", "another run is called '%s', too", run->name);
        }
        all->n_runs++;
    }
    return WB_OK;
}
