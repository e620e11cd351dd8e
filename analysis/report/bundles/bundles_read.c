/* The runs of a campaign of bundles: wb_bundles_run_read() of bundles.h. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/report/bundles/bundles.h"
#include "base/config.h"
#include "base/units.h"
#include "fe/model/bundle_override.h"

#define WB_LOG_DOMAIN "campaign"

/* What a run has in place of its bundle's, as the command's options say it; has_... tells what else
 * was given. */
struct settings {
    struct wb_bundle_override override;
    bool has_load, has_weight, dead_force, weight;
};

/* --- reading --- */

enum {
    MOST_KEYS = 16
};

/* What is not given stays. The first n_own of `keys` are the caller's. */
static enum wb_status read_settings(struct settings *s, const struct wb_config_node *node,
                                    struct wb_config_key keys[MOST_KEYS], size_t n_own)
{
    struct wb_bundle_override *const o = &s->override;
    const struct wb_config_node *friction;
    bool has_load = false, has_weight = false;
    const struct wb_config_key loads[] = {
        WB_CONFIG_OPTIONAL_BOOLEAN("dead_force", &s->dead_force),
        WB_CONFIG_OPTIONAL_BOOLEAN("weight", &s->weight),
        WB_CONFIG_OPTIONAL_NODE("friction", &friction),
    };
    size_t n = n_own;
    for (int i = 0; i < WB_BUNDLE_OVERRIDE_TABLES; i++) {
        const struct wb_setting_table *const table = &wb_bundle_override_tables[i];
        if (i != WB_BUNDLE_OVERRIDE_LOADS)
            n += wb_setting_keys(table, 0, (char *)o + table->offset, keys + n);
    }
    for (size_t i = n_own; i < n; i++)
        keys[i].optional = true;
    for (size_t i = 0; i < WB_COUNT(loads); i++)
        keys[n++] = loads[i];
    keys[n - 3].present = &has_load;
    keys[n - 2].present = &has_weight;
    WB_TRY(wb_config_map(node, keys, n));
    s->has_load |= has_load;
    s->has_weight |= has_weight;
    return friction
               ? wb_setting_read_list(wb_bundle_model_friction_setting, friction, &o->interface)
               : WB_OK;
}

/* --- the model as the run has it --- */

static enum wb_status read_model(const struct wb_bundles *all, const struct wb_config_node *node,
                                 const char *name, struct wb_bundles_run *run, char path[WB_PATH])
{
    char named_in[WB_PATH + 32];
    snprintf(named_in, sizeof named_in, "%s:%d: bundle", wb_config_origin(node),
             wb_config_line(wb_config_find(node, "bundle")));
    WB_TRY(wb_file_find_named(path, "bundles", name, all->head.folder, named_in, NULL));
    const bool is_shipped = !strchr(name, '/') && !strstr(name, ".yaml");
    snprintf(run->model_name, sizeof run->model_name,
             is_shipped ? "fixtures/bundles/%s.yaml" : "%s",
             is_shipped ? name : wb_simulation_as_shown(name));
    run->model = calloc(1, sizeof *run->model);
    if (!run->model)
        return wb_fail(WB_ERR_MEMORY, "out of memory reading a campaign");
    return wb_bundle_model_read(run->model, path);
}

/* The command can only take strand and weight away. */
static enum wb_status apply(struct settings *s, const struct wb_config_node *node,
                            struct wb_bundles_run *run)
{
    struct wb_bundle_model *const m = run->model;
    if (s->has_load && !s->dead_force && m->loads.strand_length == 0.0)
        return wb_config_refuse(node, "dead_force", "'%s' has no strand", m->name);
    if (s->has_weight && s->weight && !m->loads.weight)
        return wb_config_refuse(node, "weight", "'%s' has no weight", m->name);
    s->override.dead_force = s->dead_force;
    s->override.no_weight = s->has_weight && !s->weight;
    if (wb_bundle_override_apply(&s->override, m) != WB_OK)
        return wb_config_refuse(node, NULL, "the run cannot have these settings");
    run->mesh = wb_bundle_model_mesh(m, m->run.mesh);
    return WB_OK;
}

/* --- its command --- */

/* A setting as its option, if it was given. */
static enum wb_status argue_setting(struct wb_simulation *dataset, const struct wb_setting *row,
                                    const void *settings)
{
    char option[64], value[WB_SETTING_VALUE];
    if (!wb_setting_is_given(row, settings))
        return WB_OK;
    snprintf(option, sizeof option, "--%s", row->option);
    wb_setting_format(row, settings, value);
    WB_TRY(wb_simulation_argue(dataset, option, NULL));
    return wb_simulation_argue(dataset, value, NULL);
}

static enum wb_status argue(struct wb_bundles_run *run, const struct wb_bundle_override *o,
                            const char *path)
{
    const struct wb_setting *const run_rows = wb_bundle_model_run_settings;
    struct wb_simulation *const d = &run->dataset;
    WB_TRY(wb_simulation_argue(d, "solve", NULL));
    WB_TRY(wb_simulation_argue(d, "bundle", NULL));
    WB_TRY(wb_simulation_argue(d, path, run->model_name));
    if (o->dead_force)
        WB_TRY(wb_simulation_argue(d, "--dead-force", NULL));
    if (o->no_weight)
        WB_TRY(wb_simulation_argue(d, "--no-weight", NULL));
    WB_TRY(argue_setting(d, wb_bundle_model_friction_setting, &o->interface));
    WB_TRY(argue_setting(d, wb_bundle_model_cohesion_setting, &o->interface));
    WB_TRY(argue_setting(d, &run_rows[WB_BUNDLE_MODEL_MESH], &o->run));
    WB_TRY(argue_setting(d, &run_rows[WB_BUNDLE_MODEL_MASS_SCALING], &o->run));
    WB_TRY(argue_setting(d, &run_rows[WB_BUNDLE_MODEL_SELECTIVE], &o->run));
    WB_TRY(argue_setting(d, &run_rows[WB_BUNDLE_MODEL_DURATION], &o->run));
    wb_simulation_end(d);
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
    snprintf(friction, sizeof friction, "friction %g", i->friction_static);
    if (i->friction_kinetic != i->friction_static)
        snprintf(friction, sizeof friction, "friction %g to %g", i->friction_static,
                 i->friction_kinetic);
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
    WB_TRY(read_model(all, node, bundle, run, path));
    WB_TRY(apply(s, node, run));
    set_label(run);
    WB_TRY(wb_simulation_find(&run->dataset, &all->head, run->name));
    return argue(run, &s->override, path);
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
