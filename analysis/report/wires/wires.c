#include "analysis/report/wires/wires.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/simulated.h"
#include "base/memory.h"
#include "base/units.h"

const char *wb_wires_command(enum wb_wires_solver solver)
{
    return solver == WB_WIRES_SOLID ? "wire3d" : "wire1d";
}

double wb_wires_force(const struct wb_wire_model *model)
{
    return model->step[model->n_steps - 1].loads.follower[1];
}

/* --- cases --- */

/* A dataset with the command that makes it. */
static enum wb_status want(const struct wb_wires *comparison, const char *given,
                           enum wb_wires_solver solver, const char *path,
                           struct wb_wires_case *item)
{
    struct wb_simulation *const dataset = &item->datasets[solver];
    WB_TRY(wb_simulation_find(dataset, &comparison->head, given));
    struct wb_solve_settings settings = {.kind = solver == WB_WIRES_SOLID ? WB_SOLVE_WIRE3D
                                                                          : WB_SOLVE_WIRE1D};
    wb_setting_fill(&wb_solve_settings_table, &settings);
    settings.model = path;
    struct wb_json *const inputs = wb_json_create();
    wb_simulated_wire_inputs(inputs, item->model, solver == WB_WIRES_SOLID);
    wb_simulation_set(dataset, &settings, item->model_name, inputs);
    return WB_OK;
}

static enum wb_status read_case(const struct wb_wires *comparison,
                                const struct wb_config_node *node, bool has_rod,
                                struct wb_wires_case *item)
{
    static const char *const endings[WB_WIRES_SOLVERS] = {"3d", "1d"};
    char model[256], given[WB_WIRES_SOLVERS][256] = {"", ""}, path[WB_PATH];
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_TEXT("label", item->label),
        WB_CONFIG_TEXT("model", model),
        WB_CONFIG_OPTIONAL_TEXT("solid", given[WB_WIRES_SOLID]),
        WB_CONFIG_OPTIONAL_TEXT("rod", given[WB_WIRES_ROD]),
    };
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    WB_TRY(wb_campaign_find(&comparison->head, node, "model", "models", model, path,
                            item->model_name));
    item->model = wb_memory_new(1, sizeof *item->model);
    WB_TRY(wb_wire_model_read(item->model, path));
    if (!has_rod && given[WB_WIRES_ROD][0])
        return wb_config_refuse(node, "rod", "a rod has no contact");
    for (int k = 0; k < (has_rod ? WB_WIRES_SOLVERS : WB_WIRES_ROD); k++) {
        if (!given[k][0])
            snprintf(given[k], sizeof given[k], "%.240s-%s", item->model->name, endings[k]);
        WB_TRY(want(comparison, given[k], k, path, item));
    }
    return WB_OK;
}

static bool is_loaded_by_follower(const struct wb_wire_model *model)
{
    const double *const follower = model->step[model->n_steps - 1].loads.follower;
    return follower[0] == 0.0 && follower[1] != 0.0 && follower[2] == 0.0;
}

/* The text of the report fits these models only. */
static enum wb_status check_case(const struct wb_config_node *node, const struct wb_wires *all,
                                 const struct wb_wires_case *item, bool elastic)
{
    const struct wb_wire_model *const model = item->model;
    const struct wb_wire_model *const first = all->cases[WB_WIRES_ELASTIC].model;
    if (model->is_elastic != elastic)
        return wb_config_refuse(node, "model", "'%s' is %s", model->name,
                                model->is_elastic ? "elastic" : "elastoplastic");
    if (model->n_parts != 2)
        return wb_config_refuse(node, "model", "'%s' has no core and jacket", model->name);
    if (!is_loaded_by_follower(model))
        return wb_config_refuse(node, "model", "'%s' does not end under a follower force along y",
                                model->name);
    if (fabs(model->length - first->length) > 1e-9 * first->length ||
        wb_wires_force(model) != wb_wires_force(first))
        return wb_config_refuse(node, "model", "'%s' has another length or force than '%s'",
                                model->name, first->name);
    return WB_OK;
}

/* The exact rod is loaded by the follower force alone, and so is the wire that a rod is fitted to.
 */
static enum wb_status check_alone(const struct wb_config_node *node,
                                  const struct wb_wire_model *model)
{
    if (!wb_wire_model_is_follower(model))
        return wb_config_refuse(node, "model", "'%s' is not loaded by a follower force alone",
                                model->name);
    if (model->gravity[0] != 0.0 || model->gravity[1] != 0.0 || model->gravity[2] != 0.0)
        return wb_config_refuse(node, "model", "'%s' has weight: its gravity must be [0, 0, 0]",
                                model->name);
    return WB_OK;
}

static enum wb_status read_one(struct wb_wires *comparison, const struct wb_config_node *node,
                               int index)
{
    static const char *const labels[] = {"Elastic", "Elastic, friction", "Elastoplastic"};
    struct wb_wires_case *const item = &comparison->cases[index];
    const bool is_contact = index == WB_WIRES_CONTACT;
    snprintf(item->label, sizeof item->label, "%s", labels[index]);
    WB_TRY(read_case(comparison, node, !is_contact, item));
    WB_TRY(check_case(node, comparison, item, index != WB_WIRES_ELASTOPLASTIC));
    WB_TRY(check_alone(node, item->model));
    if (item->model->has_contact != is_contact)
        return wb_config_refuse(node, "model",
                                is_contact ? "'%s' has no interface" : "'%s' is not bonded",
                                item->model->name);
    return WB_OK;
}

static enum wb_status read_residuals(struct wb_wires *comparison, const struct wb_config_node *list)
{
    const int n = list ? wb_config_length(list) : 0;
    if (n < 0 || n > WB_WIRES_RESIDUALS)
        return wb_config_refuse(list, "residual", "expected a list of at most %d cases",
                                WB_WIRES_RESIDUALS);
    comparison->n_residual = n;
    comparison->n_cases = WB_WIRES_RESIDUAL + n;
    for (int i = 0; i < n; i++) {
        const struct wb_config_node *const node = wb_config_item(list, i);
        struct wb_wires_case *const item = &comparison->cases[WB_WIRES_RESIDUAL + i];
        snprintf(item->label, sizeof item->label, "Residual %d", i + 1);
        WB_TRY(read_case(comparison, node, true, item));
        WB_TRY(check_case(node, comparison, item, false));
    }
    return WB_OK;
}

/* --- the rest --- */

static enum wb_status read_states(const struct wb_config_node *node, struct wb_wires *comparison)
{
    snprintf(comparison->loaded_state, sizeof comparison->loaded_state, "loaded");
    snprintf(comparison->residual_state, sizeof comparison->residual_state, "unloaded");
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_TEXT("loaded", comparison->loaded_state),
        WB_CONFIG_OPTIONAL_TEXT("residual", comparison->residual_state),
    };
    return node ? wb_config_map(node, keys, WB_COUNT(keys)) : WB_OK;
}

static enum wb_status read_limits(const struct wb_config_node *node, struct wb_wires *comparison)
{
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_NUMBER("tip_max", &comparison->tip_limit, 1.0, 1e-6, 10.0),
        WB_CONFIG_OPTIONAL_NUMBER("stress_max", &comparison->stress_limit, 1.0, 1e-6, 10.0),
        WB_CONFIG_OPTIONAL_NUMBER("cost_max", &comparison->cost_limit, 1.0, 1e-6, 10.0),
    };
    return node ? wb_config_map(node, keys, WB_COUNT(keys)) : WB_OK;
}

static enum wb_status read_printed(struct wb_wires *comparison, const struct wb_config_node *node)
{
    char wire[256] = "", path[WB_PATH];
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_TEXT("wire", wire),
        WB_CONFIG_TEXT("source", comparison->printed_source),
        WB_CONFIG_OPTIONAL_NUMBER("stress_MPa", &comparison->printed_stress, WB_MPA, 1e-3, 1e6),
        WB_CONFIG_OPTIONAL_NUMBER("cost", &comparison->printed_cost, 1.0, 1e-6, 10.0),
    };
    if (!node)
        return WB_OK;
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    if (!wire[0])
        return WB_OK;
    WB_TRY(wb_campaign_find(&comparison->head, node, "wire", "wires", wire, path, NULL));
    WB_TRY(wb_wire_read(path, &comparison->printed_wire, NULL));
    if (!comparison->printed_wire.has_properties)
        return wb_config_refuse(node, "wire", "'%s' has no properties", wire);
    comparison->has_printed_wire = true;
    return WB_OK;
}

enum wb_status wb_wires_keys(void *context, const struct wb_config_node *root)
{
    struct wb_wires *const comparison = context;
    static const char *const moduli[] = {"mixture", "curve", NULL};
    const struct wb_config_node *cases[WB_WIRES_RESIDUAL], *residual, *states, *fit, *limits,
        *printed;
    int modulus = 0;
    const struct wb_config_key keys[] = {
        WB_CAMPAIGN_KEYS(&comparison->head),
        WB_CONFIG_OPTIONAL_TEXT("simulations", comparison->head.simulations),
        WB_CONFIG_NODE("elastic", &cases[WB_WIRES_ELASTIC]),
        WB_CONFIG_OPTIONAL_NODE("contact", &cases[WB_WIRES_CONTACT]),
        WB_CONFIG_NODE("elastoplastic", &cases[WB_WIRES_ELASTOPLASTIC]),
        WB_CONFIG_OPTIONAL_NODE("residual", &residual),
        WB_CONFIG_OPTIONAL_NUMBER("section_mm", &comparison->section, WB_MM, 0.0, 1e6),
        WB_CONFIG_OPTIONAL_NODE("states", &states),
        WB_CONFIG_OPTIONAL_CHOICE("fit_modulus", &modulus, moduli),
        WB_CONFIG_OPTIONAL_NODE("fit", &fit),
        WB_CONFIG_OPTIONAL_NODE("limits", &limits),
        WB_CONFIG_OPTIONAL_NODE("printed", &printed),
    };
    comparison->section = (double)NAN;
    WB_TRY(wb_config_map(root, keys, WB_COUNT(keys)));
    comparison->mixture = modulus == 0;
    for (int i = 0; i < WB_WIRES_RESIDUAL; i++) {
        if (cases[i])
            WB_TRY(read_one(comparison, cases[i], i));
    }
    WB_TRY(read_residuals(comparison, residual));
    if (isnan(comparison->section))
        comparison->section = comparison->cases[0].model->part[0].outer_diameter;
    WB_TRY(read_states(states, comparison));
    WB_TRY(wb_campaign_read_settings(fit, &comparison->head.fit));
    WB_TRY(read_limits(limits, comparison));
    return read_printed(comparison, printed);
}

void wb_wires_release(void *context)
{
    struct wb_wires *const comparison = context;
    for (int i = 0; i < WB_WIRES_CASES; i++) {
        free(comparison->cases[i].model);
        for (int k = 0; k < WB_WIRES_SOLVERS; k++)
            wb_simulation_release(&comparison->cases[i].datasets[k]);
    }
    memset(comparison, 0, sizeof *comparison);
}

bool wb_wires_has_substitutes(const struct wb_wires *comparison)
{
    const struct wb_wire_model *const model = comparison->cases[WB_WIRES_ELASTOPLASTIC].model;
    bool any = false;
    for (int i = 0; i < model->n_parts; i++)
        any |= model->part[i].is_substitute;
    return any;
}
