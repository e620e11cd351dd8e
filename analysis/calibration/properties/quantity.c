#include "analysis/calibration/properties/quantity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/calibration/properties/properties.h"
#include "base/units.h"

#define AT(field) offsetof(struct wb_properties, field)
#define STIFFNESS(field)                                                                           \
    .estimate = AT(field.estimate), .most = WB_CYCLE_STIFFNESSES, .n = AT(field.n),                \
    .curvature = AT(field.curvature), .resolved = AT(field.resolved)

const struct wb_quantity wb_quantity_rows[WB_QUANTITIES] = {
    [WB_QUANTITY_MOMENT] = {"moment_curvature", "moment_N_mm", "M at", "N mm",
                            "moment of a first loading at several curvatures", WB_NMM, 1e9,
                            .estimate = AT(moment), .most = WB_PROPERTIES_MOST_MOMENTS,
                            .n = AT(n_moments), .curvature = AT(curvature)},
    [WB_QUANTITY_UNLOADING_STIFFNESS] = {"unloading_stiffness_N_mm2", "value",
                                         "unloading stiffness over", "N mm2",
                                         "change of the moment over the change of the curvature, "
                                         "unloading from the largest curvature",
                                         WB_NMM2, 1e15, STIFFNESS(unloading)},
    [WB_QUANTITY_RESIDUAL_CURVATURE_RATIO] = {"residual_curvature_ratio", "value",
                                              "residual curvature ratio", "",
                                              "residual curvature at zero moment over the largest "
                                              "curvature",
                                              1.0, 1.0, .estimate = AT(residual_curvature_ratio)},
    [WB_QUANTITY_SPRINGBACK] = {"deflection_springback", "value", "springback of the deflection",
                                "",
                                "1 less the residual over the largest deflection, of a cantilever "
                                "of the tests' free length bent to the largest curvature",
                                1.0, 1.0, .estimate = AT(springback)},
    [WB_QUANTITY_LOOP_ENERGY] = {"loop_energy_mJ_per_m", "value", "loop energy", "mJ/m",
                                 "energy loss per length of a cycle from straight to the largest "
                                 "curvature and back",
                                 WB_MJ, 1e15, .estimate = AT(loop_energy)},
    [WB_QUANTITY_SECANT_STIFFNESS] = {"secant_stiffness_N_mm2", "value", "secant EI to", "N mm2",
                                      "moment over curvature, loading from straight", WB_NMM2, 1e15,
                                      STIFFNESS(secant)},
    [WB_QUANTITY_RIGIDITY] = {"flexural_rigidity_N_mm2", "value", "EI at zero curvature", "N mm2",
                              "flexural rigidity EI, the slope of the moment at zero curvature",
                              WB_NMM2, 1e15, .estimate = AT(rigidity)},
};

struct wb_quantity_values wb_quantity_values(const struct wb_properties *properties,
                                             enum wb_quantity_id id)
{
    const struct wb_quantity *const row = &wb_quantity_rows[id];
    const char *const base = (const char *)properties;
    struct wb_quantity_values values = {
        .n = 1,
        .estimate = (const struct wb_estimate *)(const void *)(base + row->estimate),
        .resolved = (double)NAN,
    };
    if (row->most > 0) {
        values.n = *(const int *)(const void *)(base + row->n);
        values.curvature = (const double *)(const void *)(base + row->curvature);
    }
    if (row->resolved > 0 && values.n > 0)
        values.resolved = *(const double *)(const void *)(base + row->resolved);
    return values;
}

bool wb_quantity_is_known(const struct wb_estimate *estimate)
{
    return isfinite(estimate->value) || isfinite(estimate->candidates_low);
}

const char *wb_quantity_label(enum wb_quantity_id id, double curvature,
                              char label[WB_QUANTITY_LABEL])
{
    const struct wb_quantity *const row = &wb_quantity_rows[id];
    if (row->most > 0)
        snprintf(label, WB_QUANTITY_LABEL, "%s %.4g /m", row->name, curvature);
    else
        snprintf(label, WB_QUANTITY_LABEL, "%s", row->name);
    return label;
}

static void put_estimate(struct wb_json *object, const struct wb_quantity *row,
                         const struct wb_estimate *e)
{
    wb_json_set_number(object, row->value_key, e->value / row->scale);
    wb_json_set_number(object, "low", e->low / row->scale);
    wb_json_set_number(object, "high", e->high / row->scale);
    wb_json_set_number(object, "candidates_low", e->candidates_low / row->scale);
    wb_json_set_number(object, "candidates_high", e->candidates_high / row->scale);
}

void wb_quantity_put(struct wb_json *object, const struct wb_properties *properties)
{
    for (enum wb_quantity_id id = 0; id < WB_QUANTITIES; id++) {
        const struct wb_quantity *const row = &wb_quantity_rows[id];
        const struct wb_quantity_values values = wb_quantity_values(properties, id);
        /* Three-point bending has no unloading from a known curvature. */
        if (strcmp(properties->method, "three-point") == 0 &&
            (values.n == 0 || !wb_quantity_is_known(values.estimate)))
            continue;
        if (row->most == 0) {
            put_estimate(wb_json_set_object(object, row->key), row, values.estimate);
            continue;
        }
        struct wb_json *list = NULL;
        if (row->resolved > 0) {
            struct wb_json *const group = wb_json_set_object(object, row->key);
            wb_json_set_number(group, "resolved_from_1_m", values.resolved);
            list = wb_json_set_array(group, "at");
        } else {
            list = wb_json_set_array(object, row->key);
        }
        for (int k = 0; k < values.n; k++) {
            struct wb_json *const item = wb_json_append_object(list);
            wb_json_set_number(item, "curvature_1_m", values.curvature[k]);
            put_estimate(item, row, &values.estimate[k]);
        }
    }
}
