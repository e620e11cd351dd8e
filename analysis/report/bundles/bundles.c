#include "analysis/report/bundles/bundles.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/simulated.h"
#include "analysis/dataset/simulated_bundle.h"
#include "base/config.h"
#include "base/memory.h"
#include "fe/model/bundle_override.h"

const struct wb_wire *wb_bundles_published(const struct wb_bundles_run *run)
{
    const struct wb_bundle_model *const model = run->model;
    const bool has =
        model->has_published && model->published.has_beam && model->published.beam.has_properties;
    return has ? &model->published.beam : NULL;
}

const char *wb_bundles_loading(const struct wb_bundles_run *run)
{
    static const char *const texts[2][2] = {{"dead force", "dead force, weight"},
                                            {"strand", "strand, weight"}};
    const struct wb_bundle_loads *const loads = &run->model->loads;
    return texts[loads->strand_length > 0.0][loads->weight];
}

/* --- runs --- */

/* What a run has in place of its bundle's, as the command's options say it; has_... tells what else
 * was given. */
struct settings {
    struct wb_bundle_override override;
    bool has_load, has_weight, weight;
};

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
        WB_CONFIG_OPTIONAL_BOOLEAN("dead_force", &o->dead_force),
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

/* The command can only take strand and weight away. */
static enum wb_status read_model(const struct wb_bundles *all, const struct wb_config_node *node,
                                 const char *name, struct settings *s, struct wb_bundles_run *run,
                                 char path[WB_PATH])
{
    WB_TRY(wb_campaign_find(&all->head, node, "bundle", "bundles", name, path, run->model_name));
    run->model = wb_memory_new(1, sizeof *run->model);
    struct wb_bundle_model *const m = run->model;
    s->override.no_weight = s->has_weight && !s->weight;
    const enum wb_status status = wb_bundle_override_read(m, path, &s->override, NULL);
    if (status == WB_ERR_ARGUMENT)
        return wb_config_refuse(node, NULL, "the run cannot have these settings");
    WB_TRY(status);
    if (s->has_load && !s->override.dead_force && m->loads.strand_length == 0.0)
        return wb_config_refuse(node, "dead_force", "'%s' has no strand", m->name);
    if (s->has_weight && s->weight && !m->loads.weight)
        return wb_config_refuse(node, "weight", "'%s' has no weight", m->name);
    run->mesh = wb_bundle_model_mesh(m, m->run.mesh);
    return WB_OK;
}

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
    wb_simulation_set(&run->dataset, &solve, run->model_name, inputs);
    return WB_OK;
}

static enum wb_status read_runs(struct wb_bundles *all, const struct wb_config_node *list,
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

/* --- rods --- */

static void set_rod(const struct wb_bundles_run *run, struct wb_simulation *rod)
{
    const struct wb_bundle_model *const model = run->model;
    struct wb_solve_settings settings = {.kind = WB_SOLVE_CANTILEVER};
    wb_setting_fill(&wb_solve_settings_table, &settings);
    settings.wire = wb_bundles_published(run)->name;
    settings.length = model->length;
    settings.deflection = model->run.deflection;
    settings.strand = model->loads.strand_length;
    settings.weight = model->loads.weight;
    const struct wb_wire *const beam = wb_bundles_published(run);
    const struct wb_simulated_cantilever cantilever = {
        .law = &beam->law,
        .outer_diameter = beam->outer_diameter,
        .length = settings.length,
        .deflection = settings.deflection,
        .strand_length = settings.strand,
        .mass_per_length = settings.weight ? wb_wire_mass_per_length(beam) : 0.0,
        .points = settings.points,
        .cycles = settings.cycles,
    };
    struct wb_json *const inputs = wb_json_create();
    wb_simulated_cantilever_inputs(inputs, &cantilever);
    wb_simulation_set(rod, &settings, NULL, inputs);
}

/* --- groups --- */

static enum wb_status find_run(const struct wb_bundles *bundles, const struct wb_config_node *node,
                               const char *key, const char *name, int *run)
{
    for (int i = 0; i < bundles->n_runs; i++) {
        if (strcmp(bundles->runs[i].name, name) == 0) {
            *run = i;
            return WB_OK;
        }
    }
    return wb_config_refuse(node, key, "there is no run '%s'", name);
}

static enum wb_status read_bundle(struct wb_bundles *all, const struct wb_config_node *node,
                                  struct wb_bundles_bundle *bundle)
{
    char dynamic[128], constant[128] = "", rod[256] = "";
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("label", bundle->label),
        WB_CONFIG_TEXT("dynamic", dynamic),
        WB_CONFIG_OPTIONAL_TEXT("constant", constant),
        WB_CONFIG_OPTIONAL_TEXT("rod", rod),
    };
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    bundle->constant = -1;
    WB_TRY(find_run(all, node, "dynamic", dynamic, &bundle->dynamic));
    const struct wb_bundles_run *const run = &all->runs[bundle->dynamic];
    if (constant[0]) {
        WB_TRY(find_run(all, node, "constant", constant, &bundle->constant));
        if (strcmp(all->runs[bundle->constant].model->path, run->model->path) != 0)
            return wb_config_refuse(node, "constant", "'%s' is of another bundle than '%s'",
                                    constant, dynamic);
    }
    bundle->has_rod = rod[0] != '\0';
    if (!bundle->has_rod)
        return WB_OK;
    const struct wb_wire *const beam = wb_bundles_published(run);
    char path[WB_PATH];
    if (!beam)
        return wb_config_refuse(node, "rod", "'%s' has no published beam", run->model->name);
    if (wb_file_find_fixture(path, "wires", beam->name, NULL) != WB_OK)
        return wb_config_refuse(node, "rod", "the published beam '%s' is not in fixtures/wires",
                                beam->name);
    WB_TRY(wb_simulation_find(&bundle->rod, &all->head, rod));
    set_rod(run, &bundle->rod);
    return WB_OK;
}

static enum wb_status read_figures(const struct wb_config_node *node,
                                   struct wb_bundles_group *group)
{
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_TEXT("section", group->figures[WB_BUNDLES_SECTION]),
        WB_CONFIG_OPTIONAL_TEXT("force", group->figures[WB_BUNDLES_FORCE]),
        WB_CONFIG_OPTIONAL_TEXT("error", group->figures[WB_BUNDLES_ERROR]),
        WB_CONFIG_OPTIONAL_TEXT("shape", group->figures[WB_BUNDLES_SHAPE]),
        WB_CONFIG_OPTIONAL_TEXT("energy", group->figures[WB_BUNDLES_ENERGY]),
    };
    return node ? wb_config_map(node, keys, WB_COUNT(keys)) : WB_OK;
}

static enum wb_status read_group(struct wb_bundles *all, const struct wb_config_node *node,
                                 int index)
{
    struct wb_bundles_group *const group = &all->groups[index];
    const struct wb_config_node *figures, *list;
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("label", group->label),
        WB_CONFIG_OPTIONAL_NODE("figures", &figures),
        WB_CONFIG_NODE("bundles", &list),
    };
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    WB_TRY(read_figures(figures, group));
    group->first = all->n_bundles;
    group->n = wb_config_length(list);
    if (group->n < 1 || group->n > WB_FIGURES_BUNDLE_MOST)
        return wb_config_refuse(node, "bundles", "expected a list of 1 to %d bundles",
                                WB_FIGURES_BUNDLE_MOST);
    for (int i = 0; i < group->n; i++) {
        struct wb_bundles_bundle *const bundle = &all->bundles[all->n_bundles++];
        bundle->group = index;
        WB_TRY(read_bundle(all, wb_config_item(list, i), bundle));
    }
    return WB_OK;
}

static enum wb_status read_groups(struct wb_bundles *all, const struct wb_config_node *root,
                                  const struct wb_config_node *list)
{
    all->n_groups = wb_config_length(list);
    if (all->n_groups < 1 || all->n_groups > WB_BUNDLES_GROUPS)
        return wb_config_refuse(root, "groups", "expected a list of 1 to %d groups",
                                WB_BUNDLES_GROUPS);
    for (int i = 0; i < all->n_groups; i++)
        WB_TRY(read_group(all, wb_config_item(list, i), i));
    return WB_OK;
}

/* --- studies --- */

static enum wb_status read_labels(const struct wb_bundles *all, const struct wb_config_node *node,
                                  const struct wb_config_node *labels,
                                  struct wb_bundles_study *study)
{
    if (labels && wb_config_length(labels) != study->n)
        return wb_config_refuse(node, "labels", "expected a list of %d labels, as many as runs",
                                study->n);
    for (int i = 0; i < study->n; i++) {
        const char *const own = labels ? wb_config_scalar(wb_config_item(labels, i)) : NULL;
        snprintf(study->labels[i], sizeof study->labels[i], "%.150s",
                 own ? own : all->runs[study->runs[i]].label);
    }
    return WB_OK;
}

static enum wb_status read_study(struct wb_bundles *all, const struct wb_config_node *node,
                                 struct wb_bundles_study *study)
{
    const struct wb_config_node *runs, *labels;
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("title", study->title),
        WB_CONFIG_NODE("runs", &runs),
        WB_CONFIG_OPTIONAL_NODE("labels", &labels),
    };
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    study->n = wb_config_length(runs);
    if (study->n < 1 || study->n > WB_BUNDLES_STUDY_RUNS)
        return wb_config_refuse(node, "runs", "expected a list of 1 to %d runs",
                                WB_BUNDLES_STUDY_RUNS);
    for (int i = 0; i < study->n; i++) {
        const char *const name = wb_config_scalar(wb_config_item(runs, i));
        WB_TRY(find_run(all, node, "runs", name ? name : "", &study->runs[i]));
    }
    return read_labels(all, node, labels, study);
}

static enum wb_status read_studies(struct wb_bundles *all, const struct wb_config_node *root,
                                   const struct wb_config_node *list)
{
    const int n = list ? wb_config_length(list) : 0;
    if (n < 0 || n > WB_BUNDLES_STUDIES)
        return wb_config_refuse(root, "studies", "expected a list of at most %d studies",
                                WB_BUNDLES_STUDIES);
    all->n_studies = n;
    for (int i = 0; i < n; i++)
        WB_TRY(read_study(all, wb_config_item(list, i), &all->studies[i]));
    return WB_OK;
}

/* --- the rest --- */

static enum wb_status read_limits(const struct wb_config_node *node,
                                  struct wb_bundles_limits *limits)
{
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_NUMBER("rms_max", &limits->rms, 1.0, 1e-6, 10.0),
        WB_CONFIG_OPTIONAL_NUMBER("kinetic_max", &limits->kinetic, 1.0, 1e-6, 10.0),
        WB_CONFIG_OPTIONAL_NUMBER("artificial_max", &limits->artificial, 1.0, 1e-6, 10.0),
        WB_CONFIG_OPTIONAL_NUMBER("imbalance_max", &limits->imbalance, 1.0, 1e-6, 10.0),
        WB_CONFIG_OPTIONAL_NUMBER("cost_max", &limits->cost, 1.0, 1e-6, 10.0),
    };
    return node ? wb_config_map(node, keys, WB_COUNT(keys)) : WB_OK;
}

static enum wb_status read_printed(const struct wb_config_node *node, struct wb_bundles *all)
{
    const struct wb_config_node *rms;
    int n;
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("source", all->printed_source),
        WB_CONFIG_OPTIONAL_NODE("rms", &rms),
        WB_CONFIG_OPTIONAL_NUMBER("cost", &all->printed_cost, 1.0, 1e-6, 10.0),
    };
    if (!node)
        return WB_OK;
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    const struct wb_config_key range =
        WB_CONFIG_OPTIONAL_NUMBER("rms", all->printed_rms, 1.0, 0.0, 10.0);
    return rms ? wb_config_numbers(rms, &range, 2, 2, all->printed_rms, &n) : WB_OK;
}

static enum wb_status find_inset(struct wb_bundles *all, const struct wb_config_node *root,
                                 const char *label)
{
    all->inset = -1;
    for (int i = 0; i < all->n_bundles; i++) {
        if (label[0] && strcmp(all->bundles[i].label, label) == 0)
            all->inset = i;
    }
    if (label[0] && all->inset < 0)
        return wb_config_refuse(root, "inset", "there is no bundle with the label '%s'", label);
    return WB_OK;
}

enum wb_status wb_bundles_keys(void *context, const struct wb_config_node *root)
{
    struct wb_bundles *const all = context;
    const struct wb_config_node *defaults, *runs, *groups, *studies, *fit, *limits, *printed;
    char inset[64] = "";
    const struct wb_config_key keys[] = {
        WB_CAMPAIGN_KEYS(&all->head),
        WB_CONFIG_OPTIONAL_TEXT("simulations", all->head.simulations),
        WB_CONFIG_OPTIONAL_NODE("defaults", &defaults),
        WB_CONFIG_NODE("runs", &runs),
        WB_CONFIG_NODE("groups", &groups),
        WB_CONFIG_OPTIONAL_NODE("studies", &studies),
        WB_CONFIG_OPTIONAL_TEXT("inset", inset),
        WB_CONFIG_OPTIONAL_NODE("fit", &fit),
        WB_CONFIG_OPTIONAL_NODE("limits", &limits),
        WB_CONFIG_OPTIONAL_NODE("printed", &printed),
    };
    WB_TRY(wb_config_map(root, keys, WB_COUNT(keys)));
    WB_TRY(read_runs(all, runs, defaults));
    WB_TRY(read_groups(all, root, groups));
    WB_TRY(read_studies(all, root, studies));
    WB_TRY(find_inset(all, root, inset));
    WB_TRY(wb_campaign_read_settings(fit, &all->head.fit));
    WB_TRY(read_limits(limits, &all->limits));
    return read_printed(printed, all);
}

void wb_bundles_release(void *context)
{
    struct wb_bundles *const bundles = context;
    for (int i = 0; i < WB_BUNDLES_RUNS; i++) {
        free(bundles->runs[i].model);
        wb_simulation_release(&bundles->runs[i].dataset);
    }
    for (int i = 0; i < WB_BUNDLES_BUNDLES; i++)
        wb_simulation_release(&bundles->bundles[i].rod);
    memset(bundles, 0, sizeof *bundles);
}
