#include "analysis/report/bundles/bundles_section.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/errors.h"
#include "analysis/dataset/simulated_section.h"
#include "base/memory.h"
#include "base/units.h"
#include "fe/section/section_layout.h"

#define WB_LOG_DOMAIN "report"

enum {
    MARKERS = 2 /* the shape is not asked for */
};

static enum wb_status average(struct wb_bundles_section *section,
                              const struct wb_section_run *computed,
                              const struct wb_bundle_model *model, double step,
                              struct wb_reason *why)
{
    const struct wb_simulated_section simulated = {.model = model, .run = computed};
    const struct wb_curve_grid grid = {.step = step};
    struct wb_dataset dataset;
    const struct wb_dataset *const datasets[] = {&dataset};
    wb_dataset_init(&dataset);
    wb_simulated_section_fill(&dataset, &simulated);
    const enum wb_status status = wb_curve_average_on(&section->curve, datasets, 1, &grid, why);
    wb_dataset_release(&dataset);
    return status;
}

static enum wb_status compute(struct wb_bundles_section *section,
                              const struct wb_bundle_model *model, double step,
                              struct wb_reason *why)
{
    struct wb_section_run computed;
    WB_TRY(wb_section_layout_check(model, why));
    WB_TRY(wb_section_run_init(&computed, model, MARKERS));
    enum wb_status status = wb_section_run(&computed, model, NULL);
    if (status == WB_OK && !computed.converged)
        status = wb_fail_to(why, WB_ERR_CONVERGENCE, "no equilibrium was found beyond %.4g mm",
                            computed.lost.deflection / WB_MM);
    if (status == WB_OK) {
        section->friction = computed.friction;
        section->is_mean = computed.is_mean;
        section->loosens = wb_section_run_loosens(&computed, model);
        memcpy(section->rigidity, computed.rigidity, sizeof section->rigidity);
        status = average(section, &computed, model, step, why);
    }
    wb_section_run_release(&computed);
    return status;
}

static void compare(struct wb_bundles_section *section, const struct wb_curve *explicit)
{
    const int n = section->curve.n < explicit->n ? section->curve.n : explicit->n;
    double *const error = wb_memory_new((size_t)n, sizeof *error);
    wb_errors_curve(n, explicit->force, section->curve.force, explicit->max_force, error);
    section->rms = wb_errors_rms(n, error);
    section->largest = wb_errors_largest(n, error);
    free(error);
}

/* A bundle that the model is not made for is no fault: its reason is said once, without the path.
 */
static void keep_reason(struct wb_bundles_section *section, const struct wb_bundle_model *model,
                        enum wb_status status, const struct wb_reason *why)
{
    const size_t n = strlen(model->path);
    const char *text = why->text[0] ? why->text : wb_status_text(status);
    if (strncmp(text, model->path, n) == 0 && strncmp(text + n, ": ", 2) == 0)
        text += n + 2;
    wb_text_append(&section->problem, "%s", text);
}

void wb_bundles_section_compute(struct wb_bundles_section *section,
                                const struct wb_bundles_run *run, const struct wb_curve *explicit,
                                double step)
{
    struct wb_reason why = {.text = ""};
    section->rms = section->largest = (double)NAN;
    const enum wb_status status = compute(section, run->model, step, &why);
    if (status == WB_OK && explicit && explicit->n > 0)
        compare(section, explicit);
    section->state = status == WB_OK ? WB_SIMULATION_USABLE : WB_SIMULATION_REFUSED;
    if (status != WB_OK)
        keep_reason(section, run->model, status, &why);
}

void wb_bundles_section_release(struct wb_bundles_section *section)
{
    wb_curve_release(&section->curve);
    wb_text_release(&section->problem);
    memset(section, 0, sizeof *section);
}
