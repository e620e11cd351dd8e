/* Reading the file of a campaign of predictions. */
#include "analysis/report/predictions/predictions.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/config.h"
#include "base/memory.h"
#include "fe/model/bundle_uncertainty.h"

enum {
    MOST_RUNS = 100000,
    LEAST_RUNS = 20
};

/* --- tests --- */

static bool has_case(const struct wb_bundle_model *model, const char *name)
{
    const struct wb_bundle_uncertainty *const u = &model->uncertainty;
    bool has = strcmp(name, "file") == 0;
    for (int i = 0; i < u->n_scenarios; i++)
        has |= strcmp(name, u->scenario[i].name) == 0;
    return has;
}

static enum wb_status read_test(const struct wb_predictions *all, const struct wb_config_node *node,
                                const struct wb_bundle_model *model,
                                struct wb_predictions_test *test)
{
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("dataset", test->given),
        WB_CONFIG_OPTIONAL_TEXT("label", test->label),
        WB_CONFIG_OPTIONAL_TEXT("case", test->case_name),
    };
    snprintf(test->case_name, sizeof test->case_name, "file");
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    if (!has_case(model, test->case_name))
        return wb_config_refuse(node, "case",
                                "'%s' is no scenario of %s: expected 'file', or a name of its "
                                "uncertainty: scenarios",
                                test->case_name, model->path);
    if (!test->label[0])
        snprintf(test->label, sizeof test->label, "%.60s", wb_file_name(test->given));
    return wb_file_join(test->path, all->head.folder, test->given);
}

static enum wb_status read_tests(const struct wb_predictions *all,
                                 const struct wb_config_node *list,
                                 struct wb_predictions_bundle *bundle)
{
    const int n = wb_config_length(list);
    if (n < 1 || n > WB_PREDICTIONS_TESTS)
        return wb_config_refuse(list, NULL, "tests: expected a list of 1 to %d tests",
                                WB_PREDICTIONS_TESTS);
    for (; bundle->n_tests < n; bundle->n_tests++)
        WB_TRY(read_test(all, wb_config_item(list, bundle->n_tests), bundle->model,
                         &bundle->tests[bundle->n_tests]));
    return WB_OK;
}

/* --- bundles --- */

static enum wb_status read_bundle(const struct wb_predictions *all,
                                  const struct wb_config_node *node,
                                  struct wb_predictions_bundle *bundle)
{
    const struct wb_config_node *tests;
    char name[256], path[WB_PATH];
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("bundle", name),
        WB_CONFIG_OPTIONAL_TEXT("label", bundle->label),
        WB_CONFIG_OPTIONAL_NODE("tests", &tests),
    };
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    WB_TRY(wb_campaign_find(&all->head, node, "bundle", "bundles", name, path, bundle->model_name));
    bundle->model = wb_memory_new(1, sizeof *bundle->model);
    WB_TRY(wb_bundle_model_read(bundle->model, path));
    if (!bundle->model->has_uncertainty)
        return wb_config_refuse(node, "bundle",
                                "%s has no section uncertainty: add it, as in "
                                "fixtures/bundles/template.yaml",
                                bundle->model_name);
    if (!bundle->label[0])
        snprintf(bundle->label, sizeof bundle->label, "%.150s", bundle->model->title);
    return tests ? read_tests(all, tests, bundle) : WB_OK;
}

enum wb_status wb_predictions_keys(void *context, const struct wb_config_node *root)
{
    struct wb_predictions *const all = context;
    const struct wb_config_node *list;
    const struct wb_config_key keys[] = {
        WB_CAMPAIGN_KEYS(&all->head),
        WB_CONFIG_OPTIONAL_INTEGER("runs", &all->runs, LEAST_RUNS, MOST_RUNS),
        WB_CONFIG_OPTIONAL_INTEGER("seed", &all->seed, 0, 1000000000),
        WB_CONFIG_NODE("bundles", &list),
    };
    all->seed = 1;
    WB_TRY(wb_config_map(root, keys, WB_COUNT(keys)));
    const int n = wb_config_length(list);
    if (n < 1 || n > WB_PREDICTIONS_BUNDLES)
        return wb_config_refuse(list, NULL, "bundles: expected a list of 1 to %d bundles",
                                WB_PREDICTIONS_BUNDLES);
    for (; all->n_bundles < n; all->n_bundles++)
        WB_TRY(
            read_bundle(all, wb_config_item(list, all->n_bundles), &all->bundles[all->n_bundles]));
    return WB_OK;
}

void wb_predictions_release(void *context)
{
    struct wb_predictions *const all = context;
    for (int i = 0; i < WB_PREDICTIONS_BUNDLES; i++)
        free(all->bundles[i].model);
    memset(all, 0, sizeof *all);
}
