#include "analysis/dataset/least_squares.h"

#include <math.h>
#include <pthread.h>

#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>

#include "base/memory.h"

static void silence_gsl(void)
{
    gsl_set_error_handler_off();
}

gsl_multifit_nlinear_workspace *wb_least_squares_create(int n_residuals, int n_free)
{
    /* GSL's default handler aborts the program. */
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, silence_gsl);
    gsl_multifit_nlinear_parameters parameters = gsl_multifit_nlinear_default_parameters();
    parameters.trs = gsl_multifit_nlinear_trs_dogleg;
    parameters.scale = gsl_multifit_nlinear_scale_levenberg;
    return wb_memory_need(gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &parameters,
                                                     (size_t)n_residuals, (size_t)n_free));
}

bool wb_least_squares_iterate(gsl_multifit_nlinear_workspace *w,
                              const struct wb_least_squares_search *search, int *iterations)
{
    double before;
    int settled = 0;
    gsl_blas_ddot(w->f, w->f, &before);
    for (int i = 0; i < search->max_iterations; i++) {
        if (iterations)
            (*iterations)++;
        const int status = gsl_multifit_nlinear_iterate(w);
        if (*search->status != WB_OK)
            return false;
        const bool moved = status == GSL_SUCCESS; /* or no step makes it better */
        double now = before, largest = 0.0;
        if (moved) {
            gsl_blas_ddot(w->f, w->f, &now);
            for (size_t k = 0; k < w->dx->size; k++)
                largest = fmax(largest, fabs(gsl_vector_get(w->dx, k)));
        }
        const double gain = now > 0.0 ? (before - now) / now : (double)INFINITY;
        settled = gain < search->smallest_gain ? settled + 1 : 0;
        if (!moved || largest < search->smallest_step || settled > search->patience || now == 0.0)
            return true;
        before = now;
    }
    return false;
}

double wb_least_squares_positive(double x)
{
    const double rise = x * M_E / (M_E - 1.0);
    return rise > 50.0 ? rise + log(M_E - 1.0) : log1p((M_E - 1.0) * exp(rise));
}

int wb_least_squares_smooth_parts(const struct wb_law_part *part, int n, double deviation,
                                  double *residuals)
{
    int at = 0;
    for (int i = 1; i + 2 < n; i++)
        residuals[at++] =
            log(part[i - 1].modulus * part[i + 1].modulus / (part[i].modulus * part[i].modulus)) /
            deviation;
    return at;
}
