#include "analysis/calibration/properties/method.h"

#define WB_LOG_DOMAIN "calibrate"

const char *const wb_method_names[WB_METHODS + 1] = {"cycle", "paper", "three-point", NULL};

const char *wb_method_name(enum wb_method method)
{
    return wb_method_names[method];
}

enum wb_status wb_method_choose(enum wb_method *method, const struct wb_dataset *const *datasets,
                                const char *const *names, int n, struct wb_reason *why)
{
    const enum wb_test_kind kind = datasets[0]->info.kind;
    *method = kind == WB_TEST_THREE_POINT ? WB_METHOD_THREE_POINT : WB_METHOD_CYCLE;
    for (int i = 0; i < n; i++) {
        const struct wb_test_info *const info = &datasets[i]->info;
        if (info->kind != kind)
            return wb_fail_to(
                why, WB_ERR_DATA, "'%s' is a %s test and '%s' a %s test: calibrate them separately",
                names[0], wb_machine_kind_name(kind), names[i], wb_machine_kind_name(info->kind));
        if (kind == WB_TEST_CANTILEVER && info->is_follower)
            *method = WB_METHOD_PAPER;
    }
    return WB_OK;
}
