#include "analysis/calibration/cycle/cycle_covariance.h"

#include <stdlib.h>

#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>

#include "analysis/calibration/cycle/cycle_fit.h"
#include "base/memory.h"

#define WB_LOG_DOMAIN "cycle"

/* Weight of the prior that keeps a parameter finite when the residuals that determine it are left
 * out; the root of it is also the least standard error. In units of the free parameters. */
static const double know_nothing = 1e-6, surest = 1e-12;

enum {
    IS_PRIOR = -1 /* residual that belongs to no group */
};

/* Begins a new group of residuals at each change of sign. Returns the index after the last one. */
static int group_rows(const gsl_vector *f, int at, int n, int *group, int *n_groups)
{
    for (int i = at; i < at + n; i++) {
        *n_groups += i == at || (gsl_vector_get(f, (size_t)i) < 0.0) !=
                                    (gsl_vector_get(f, (size_t)i - 1) < 0.0);
        group[i] = *n_groups - 1;
    }
    return at + n;
}

/* Groups correlated residuals: consecutive ones of one sign, of one branch, one marker or the
 * dwell. Returns the number of groups. */
static int group_residuals(const struct wb_cycle_data *data, bool has_held, const gsl_vector *f,
                           int *group)
{
    int n_groups = 0;
    for (size_t i = 0; i < f->size; i++)
        group[i] = IS_PRIOR;
    int at = group_rows(f, 0, data->n_loading, group, &n_groups);
    at = group_rows(f, at, data->n_points - data->n_loading, group, &n_groups);
    for (int m = 0; m < data->n_markers; m++) {
        int n = 0;
        for (int i = 0; i < data->n_places; i++)
            n += data->places[i].marker == m;
        at = group_rows(f, at, n, group, &n_groups) + 1; /* after the prior of its offset */
    }
    if (has_held)
        group_rows(f, at, data->n_held, group, &n_groups);
    return n_groups;
}

/* Adds the contribution of one group of residuals to the covariance: the change of the free
 * parameters, to first order, when the group is left out. `squares` is J'J; `rest` is workspace. */
static bool add_group(const gsl_matrix *J, const gsl_vector *f, const int *group, int left_out,
                      const gsl_matrix *squares, gsl_matrix *rest, gsl_matrix *covariance)
{
    double numbers[WB_FIT_MOST_FREE] = {0.0};
    gsl_vector_view change = gsl_vector_view_array(numbers, J->size2);
    gsl_matrix_memcpy(rest, squares);
    for (size_t i = 0; i < J->size1; i++) {
        if (group[i] != left_out)
            continue;
        const gsl_vector_const_view slopes = gsl_matrix_const_row(J, i);
        gsl_blas_dsyr(CblasLower, -1.0, &slopes.vector, rest);
        gsl_blas_daxpy(gsl_vector_get(f, i), &slopes.vector, &change.vector);
    }
    return gsl_linalg_cholesky_decomp1(rest) == GSL_SUCCESS &&
           gsl_linalg_cholesky_svx(rest, &change.vector) == GSL_SUCCESS &&
           gsl_blas_dsyr(CblasLower, 1.0, &change.vector, covariance) == GSL_SUCCESS;
}

/* Adds the contribution of the priors, by their standard deviations. */
static bool add_priors(const gsl_matrix *J, const int *group, const gsl_matrix *squares,
                       gsl_matrix *rest, gsl_matrix *covariance)
{
    gsl_matrix_memcpy(rest, squares);
    bool good = gsl_linalg_cholesky_decomp1(rest) == GSL_SUCCESS;
    for (size_t i = 0; i < J->size1 && good; i++) {
        double numbers[WB_FIT_MOST_FREE];
        gsl_vector_view change = gsl_vector_view_array(numbers, J->size2);
        if (group[i] != IS_PRIOR)
            continue;
        gsl_matrix_get_row(&change.vector, J, i);
        good = gsl_linalg_cholesky_svx(rest, &change.vector) == GSL_SUCCESS &&
               gsl_blas_dsyr(CblasLower, 1.0, &change.vector, covariance) == GSL_SUCCESS;
    }
    return good;
}

bool wb_cycle_covariance_find(const struct wb_cycle_data *data, bool has_held, const gsl_vector *f,
                              const gsl_matrix *J, gsl_matrix *covariance)
{
    const size_t n = J->size2;
    gsl_matrix *const squares = wb_memory_need(gsl_matrix_alloc(n, n));
    gsl_matrix *const rest = wb_memory_need(gsl_matrix_alloc(n, n));
    int *const group = wb_memory_new(f->size, sizeof *group);
    const int n_groups = group_residuals(data, has_held, f, group);
    bool good = true;
    gsl_matrix_set_identity(squares);
    gsl_blas_dsyrk(CblasLower, CblasTrans, 1.0, J, know_nothing, squares);
    gsl_matrix_set_identity(covariance);
    gsl_matrix_scale(covariance, surest);
    for (int g = 0; g < n_groups && good; g++)
        good = add_group(J, f, group, g, squares, rest, covariance);
    good = good && add_priors(J, group, squares, rest, covariance);
    gsl_matrix_free(squares);
    gsl_matrix_free(rest);
    free(group);
    return good;
}
