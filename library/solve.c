/* Simulated tests of the library: the 1D beam through the caller's deflections. */
#include <math.h>
#include <stdbool.h>

#include "fe/trial/cantilever.h"
#include "fe/trial/three_point_bending.h"
#include "library/handles.h"

#define WB_LOG_DOMAIN "library"

static enum wb_status check_deflections(const double *deflection, size_t n)
{
    WB_TRY(wb_call_need(deflection, "deflection"));
    for (size_t i = 0; i < n; i++) {
        if (!isfinite(deflection[i]))
            return wb_fail(WB_ERR_ARGUMENT, "deflection %zu: %g: expected metres", i,
                           deflection[i]);
    }
    return WB_OK;
}

static enum wb_status check_length(double length, const char *name)
{
    if (!(length > 0.0 && isfinite(length)))
        return wb_fail(WB_ERR_ARGUMENT, "%s: %g: expected metres, above 0", name, length);
    return WB_OK;
}

static void put(double *array, size_t row, double value)
{
    if (array)
        array[row] = value;
}

/* --- cantilever --- */

static enum wb_status check_cantilever(const struct wirebench_cantilever *test)
{
    WB_TRY(check_length(test->length, "length"));
    if (test->n_natural_shape < 0 || test->n_natural_shape > WIREBENCH_MOST_SHAPE)
        return wb_fail(WB_ERR_ARGUMENT, "n_natural_shape: %d: expected 0 to %d",
                       test->n_natural_shape, WIREBENCH_MOST_SHAPE);
    if (test->n_positions > 0)
        WB_TRY(wb_call_need(test->positions, "positions"));
    if (test->n_positions > INT32_MAX)
        return wb_fail(WB_ERR_ARGUMENT, "%zu positions: expected at most %d", test->n_positions,
                       INT32_MAX);
    for (size_t i = 0; i < test->n_positions; i++) {
        if (!(test->positions[i] >= 0.0 && test->positions[i] <= test->length))
            return wb_fail(WB_ERR_ARGUMENT,
                           "position %zu: %g: expected an arc length from 0 to %g m", i,
                           test->positions[i], test->length);
    }
    return WB_OK;
}

static enum wb_status create_cantilever(struct wb_cantilever **out,
                                        const struct wb_section *section, double mass_per_length,
                                        const struct wirebench_cantilever *test)
{
    struct wb_cantilever_model model;
    struct wb_test_info shape = {.length = test->length, .n_natural_shape = test->n_natural_shape};
    for (int i = 0; i < test->n_natural_shape; i++)
        shape.natural_shape[i] = test->natural_shape[i];
    wb_cantilever_default_model(&model);
    model.section = section;
    model.length = test->length;
    model.n_elements = test->n_elements;
    model.strand_length = test->strand_length;
    model.counterweight = test->counterweight;
    model.gravity_y = -test->gravity;
    model.mass_per_length = mass_per_length;
    if (test->n_natural_shape > 0) {
        model.natural_curvature = wb_dataset_natural_curvature;
        model.curvature_context = &shape;
    }
    return wb_cantilever_create(out, &model, NULL);
}

/* Sets row `row`, or NaN if it was not reached (point NULL). */
static void put_cantilever_row(const struct wirebench_cantilever_result *result, size_t row,
                               const struct wb_cantilever_point *point, double zero)
{
    const double none = (double)NAN;
    put(result->force, row, point ? point->vertical_force - zero : none);
    put(result->tension, row, point ? point->tension : none);
    put(result->tip_x, row, point ? point->tip_x : none);
    put(result->tip_angle, row, point ? point->tip_angle : none);
    put(result->root_moment, row, point ? point->root_moment : none);
    if (result->slack)
        result->slack[row] = point && point->slack;
}

static enum wb_status put_shape(const struct wb_cantilever *cantilever,
                                const struct wirebench_cantilever *test,
                                const struct wirebench_cantilever_result *result, size_t row,
                                bool is_reached)
{
    const size_t n = test->n_positions;
    double *const x = result->shape_x ? result->shape_x + row * n : NULL;
    double *const y = result->shape_y ? result->shape_y + row * n : NULL;
    if (!x != !y)
        return wb_fail(WB_ERR_ARGUMENT, "shape_x and shape_y go together");
    if (!x)
        return WB_OK;
    for (size_t i = 0; !is_reached && i < n; i++)
        x[i] = y[i] = (double)NAN;
    if (is_reached && n > 0)
        wb_cantilever_shape(cantilever, (int)n, test->positions, x, y, NULL);
    return WB_OK;
}

static enum wb_status run_cantilever(struct wb_cantilever *cantilever,
                                     const struct wirebench_cantilever *test, size_t n,
                                     const double *deflection,
                                     struct wirebench_cantilever_result *result)
{
    struct wb_cantilever_point point;
    WB_TRY(wb_cantilever_move(cantilever, WB_CONTROL_DEFLECTION, 0.0, &point));
    const double zero = point.vertical_force;
    bool goes_on = point.end == WB_CANTILEVER_CONVERGED;
    result->n_done = 0;
    for (size_t row = 0; row < n; row++) {
        if (goes_on) {
            WB_TRY(wb_cantilever_move(cantilever, WB_CONTROL_DEFLECTION, deflection[row], &point));
            goes_on = point.end == WB_CANTILEVER_CONVERGED;
        }
        put_cantilever_row(result, row, goes_on ? &point : NULL, zero);
        WB_TRY(put_shape(cantilever, test, result, row, goes_on));
        result->n_done += goes_on;
    }
    return WB_OK;
}

enum wirebench_status wirebench_solve_cantilever(const struct wirebench_properties *properties,
                                                 const struct wirebench_cantilever *test, size_t n,
                                                 const double *deflection,
                                                 struct wirebench_cantilever_result *result)
{
    struct wirebench_cantilever given;
    struct wirebench_cantilever_result mine;
    wb_call_begin();
    if (wb_call_need(properties, "properties") != WB_OK ||
        wb_call_take(&given, sizeof given, test, "wirebench_cantilever") != WB_OK ||
        wb_call_take(&mine, sizeof mine, result, "wirebench_cantilever_result") != WB_OK ||
        check_deflections(deflection, n) != WB_OK || check_cantilever(&given) != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    const struct wb_properties *const p = &properties->source.properties;
    struct wb_section section = {0};
    struct wb_cantilever *cantilever = NULL;
    enum wb_status status = wb_section_init_law(&section, p->outer_diameter, &p->law, 0);
    if (status == WB_OK)
        status = create_cantilever(&cantilever, &section, p->mass_per_length, &given);
    if (status == WB_OK)
        status = run_cantilever(cantilever, &given, n, deflection, &mine);
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
    if (status == WB_OK)
        status = wb_call_give(result, &mine, sizeof mine, "wirebench_cantilever_result");
    if (status != WB_OK || mine.n_done == n)
        return wb_call_end(status);
    return wb_call_end_incomplete("the solver did not converge at a deflection of %g m, row %zu of "
                                  "%zu: smaller steps may help",
                                  deflection[mine.n_done], mine.n_done, n);
}

/* --- three-point bending --- */

static void put_three_point_row(const struct wirebench_three_point_result *result, size_t row,
                                const struct wb_three_point_bending_point *point)
{
    const double none = (double)NAN;
    put(result->force, row, point ? point->force : none);
    put(result->travel, row, point ? point->travel : none);
    put(result->middle_moment, row, point ? point->middle_moment : none);
    put(result->middle_curvature, row, point ? point->middle_curvature : none);
    if (result->slack)
        result->slack[row] = point && point->slack;
}

static enum wb_status run_three_point(const struct wb_three_point_bending_model *model, size_t n,
                                      const double *deflection,
                                      struct wirebench_three_point_result *result,
                                      enum wb_three_point_bending_end *end)
{
    struct wb_three_point_bending *bending = NULL;
    struct wb_three_point_bending_point point;
    WB_TRY(wb_three_point_bending_create(&bending, model));
    enum wb_status status = WB_OK;
    *end = WB_THREE_POINT_BENDING_CONVERGED;
    result->n_done = 0;
    for (size_t row = 0; row < n && status == WB_OK; row++) {
        if (*end == WB_THREE_POINT_BENDING_CONVERGED) {
            status = wb_three_point_bending_move(bending, deflection[row], &point);
            *end = status == WB_OK ? point.end : WB_THREE_POINT_BENDING_NOT_CONVERGED;
        }
        const bool is_reached = *end == WB_THREE_POINT_BENDING_CONVERGED;
        put_three_point_row(result, row, is_reached ? &point : NULL);
        result->n_done += is_reached;
    }
    wb_three_point_bending_destroy(bending);
    return status;
}

enum wirebench_status wirebench_solve_three_point(const struct wirebench_properties *properties,
                                                  const struct wirebench_three_point *test,
                                                  size_t n, const double *deflection,
                                                  struct wirebench_three_point_result *result)
{
    struct wirebench_three_point given;
    struct wirebench_three_point_result mine;
    wb_call_begin();
    if (wb_call_need(properties, "properties") != WB_OK ||
        wb_call_take(&given, sizeof given, test, "wirebench_three_point") != WB_OK ||
        wb_call_take(&mine, sizeof mine, result, "wirebench_three_point_result") != WB_OK ||
        check_deflections(deflection, n) != WB_OK || check_length(given.span, "span") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    const struct wb_properties *const p = &properties->source.properties;
    struct wb_section section = {0};
    enum wb_three_point_bending_end end = WB_THREE_POINT_BENDING_CONVERGED;
    enum wb_status status = wb_section_init_law(&section, p->outer_diameter, &p->law, 0);
    const struct wb_three_point_bending_model model = {
        .section = &section,
        .diameter = p->outer_diameter,
        .span = given.span,
        .overhang = given.overhang,
        .support_radius = given.roller_radius,
        .nose_radius = given.nose_radius,
        .friction = given.friction,
        .compliance = given.compliance,
        .n_elements = given.n_elements,
    };
    if (status == WB_OK)
        status = run_three_point(&model, n, deflection, &mine, &end);
    wb_section_release(&section);
    if (status == WB_OK)
        status = wb_call_give(result, &mine, sizeof mine, "wirebench_three_point_result");
    if (status != WB_OK || mine.n_done == n)
        return wb_call_end(status);
    return wb_call_end_incomplete("ended before a deflection of %g m, row %zu of %zu: %s",
                                  deflection[mine.n_done], mine.n_done, n,
                                  wb_three_point_bending_end_name(end));
}
