#include "analysis/cycle_shared.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/bending.h"

#define WB_LOG_DOMAIN "calibrate"

/* By how much a cause is made larger. */
static const double part = 0.01;

/* Places among wb_cycle_moment_parts. */
enum {
    MIDDLE = 2,
    LARGEST = WB_CYCLE_MOMENTS - 1
};

/* What a fit says. */
struct answer {
    double rigidity, springback, moment[2];
};

const char *wb_cycle_shared_name(enum wb_cycle_shared_cause cause)
{
    static const char *const names[WB_SHARED_CAUSES] = {
        [WB_SHARED_CELL_GAIN] = "gain of the load cell",
        [WB_SHARED_LENGTH] = "free length",
        [WB_SHARED_DIAMETER] = "diameter",
        [WB_SHARED_COUNTERWEIGHT] = "counterweight",
        [WB_SHARED_STRAND] = "length of the strand",
    };
    return names[cause];
}

/* Where the parts of a law yield: so that the fit starts from it. */
static struct wb_cycle_grid grid_of(const struct wb_law *law)
{
    struct wb_cycle_grid grid = {0.0, 0.0};
    if (law->form != WB_LAW_PARALLEL || law->n_parts < 2)
        return grid;
    const double first = law->parts[0].yield_strain;
    grid.first_strain = first;
    grid.last_strain = first * pow(law->parts[1].yield_strain / first, law->n_parts - 1);
    return grid;
}

static enum wb_status fit_again(struct answer *answer, const struct wb_cycle_data *data,
                                const struct wb_cycle_fit *from, struct wb_cycle_grid grid,
                                const double *curvatures, struct wb_reason *why)
{
    struct wb_cycle_fit_settings settings;
    struct wb_bending bending;
    struct wb_cycle_fit fit;
    wb_cycle_fit_default_settings(&settings);
    settings.n_final_elements = settings.n_elements;
    WB_TRY(wb_cycle_fit_run(&fit, data, from->candidate, &from->law, &grid, &settings, why));
    wb_cycle_fit_release(&fit);
    const double diameter = data->info.outer_diameter;
    WB_TRY(wb_bending_describe(&fit.law, diameter, curvatures[1], &bending));
    WB_TRY(wb_bending_moments(&fit.law, diameter, 2, curvatures, answer->moment));
    answer->rigidity = bending.flexural_rigidity;
    answer->springback = bending.springback;
    return WB_OK;
}

/* Makes a cause larger; false where the test has none. */
static bool enlarge(struct wb_cycle_data *data, struct wb_cycle_grid *grid,
                    enum wb_cycle_shared_cause cause)
{
    struct wb_test_info *const info = &data->info;
    switch (cause) {
    case WB_SHARED_CELL_GAIN:
        for (int i = 0; i < data->n_points; i++)
            data->points[i].tension *= 1.0 + part;
        data->max_force *= 1.0 + part;
        return true;
    case WB_SHARED_LENGTH:
        info->length *= 1.0 + part;
        return true;
    case WB_SHARED_DIAMETER:
        /* The same curvatures make larger strains. */
        info->outer_diameter *= 1.0 + part;
        grid->first_strain *= 1.0 + part;
        grid->last_strain *= 1.0 + part;
        return true;
    case WB_SHARED_COUNTERWEIGHT:
        info->counterweight *= 1.0 + part;
        return info->counterweight > 0.0;
    default:
        info->strand_length *= 1.0 + part;
        return info->strand_length > 0.0;
    }
}

static double slope(double now, double before)
{
    return log(now / before) / log1p(part);
}

static enum wb_status find_one(struct wb_cycle_shared_slopes *slopes,
                               const struct wb_cycle_data *data, const struct wb_cycle_fit *from,
                               enum wb_cycle_shared_cause cause, const double *curvatures,
                               const struct answer *before)
{
    struct wb_cycle_grid grid = grid_of(&from->law);
    struct wb_cycle_data larger = *data;
    struct wb_reason why = {.text = ""};
    struct answer now;

    larger.points = calloc((size_t)data->n_points, sizeof *larger.points);
    if (!larger.points)
        return wb_fail(WB_ERR_MEMORY, "no memory for %d points", data->n_points);
    memcpy(larger.points, data->points, (size_t)data->n_points * sizeof *larger.points);
    enum wb_status status = WB_ERR_DATA;
    if (enlarge(&larger, &grid, cause))
        status = fit_again(&now, &larger, from, grid, curvatures, &why);
    free(larger.points);
    if (status == WB_OK)
        *slopes = (struct wb_cycle_shared_slopes){
            .rigidity = slope(now.rigidity, before->rigidity),
            .middle_moment = slope(now.moment[0], before->moment[0]),
            .largest_moment = slope(now.moment[1], before->moment[1]),
            .springback = slope(now.springback, before->springback),
        };
    return status == WB_ERR_MEMORY ? status : WB_OK;
}

enum wb_status wb_cycle_shared_find(struct wb_cycle_shared *shared,
                                    const struct wb_cycle_calibration *calibration,
                                    struct wb_reason *why)
{
    const struct wb_cycle_member *const member = &calibration->members[0];
    const struct wb_cycle_fit *const from = &member->answers[calibration->chosen].fit;
    const double curvatures[2] = {calibration->curvature[MIDDLE], calibration->curvature[LARGEST]};
    const double none = (double)NAN;
    struct answer before;

    shared->sample = member->sample;
    for (int i = 0; i < WB_SHARED_CAUSES; i++)
        shared->slopes[i] = (struct wb_cycle_shared_slopes){none, none, none, none};
    /* Against a fit with the same elements, from the same law. */
    WB_TRY(fit_again(&before, &member->data, from, grid_of(&from->law), curvatures, why));
    for (int i = 0; i < WB_SHARED_CAUSES; i++)
        WB_TRY(find_one(&shared->slopes[i], &member->data, from, i, curvatures, &before));
    return WB_OK;
}
