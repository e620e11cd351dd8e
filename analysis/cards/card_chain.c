#include "analysis/cards/card_chain.h"

#include <math.h>
#include <stdbool.h>

#include <gsl/gsl_eigen.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_matrix.h>
#include <gsl/gsl_vector.h>

#include "base/memory.h"

#define WB_LOG_DOMAIN "card"

struct wb_card_chain_segment wb_card_chain_segment(const struct wb_card_chain *chain, int i)
{
    const double h = chain->length / chain->n, r = 0.5 * chain->diameter;
    struct wb_card_chain_segment segment = {.length = i == chain->n - 1 ? 0.5 * h : h};
    segment.mass = chain->mass_per_length * segment.length;
    segment.along = 0.5 * segment.mass * r * r;
    segment.across = segment.mass * (segment.length * segment.length / 12.0 + 0.25 * r * r);
    return segment;
}

/* Kinetic energy in the rates of the joints' angles: a segment moves with the angles of all joints
 * before it. In torsion it has only its own inertia about the wire. */
static void fill_mass(const struct wb_card_chain *chain, bool is_torsion, gsl_matrix *mass)
{
    const double h = chain->length / chain->n;
    gsl_matrix_set_zero(mass);
    for (int i = 0; i < chain->n; i++) {
        const struct wb_card_chain_segment segment = wb_card_chain_segment(chain, i);
        const double centre = (i + 0.5) * h + 0.5 * segment.length;
        for (int j = 0; j <= i; j++) {
            for (int k = 0; k <= i; k++) {
                const double arms = (centre - (j + 0.5) * h) * (centre - (k + 0.5) * h);
                *gsl_matrix_ptr(mass, (size_t)j, (size_t)k) +=
                    is_torsion ? segment.along : segment.mass * arms + segment.across;
            }
        }
    }
}

/* Lowest and highest frequency of K x = omega^2 M x with the same stiffness of all joints. */
static enum wb_status solve(const struct wb_card_chain *chain, bool is_torsion, double *lowest,
                            double *highest)
{
    const size_t n = (size_t)chain->n;
    const double h = chain->length / chain->n;
    gsl_matrix *const mass = wb_memory_need(gsl_matrix_alloc(n, n));
    gsl_matrix *const stiffness = wb_memory_need(gsl_matrix_alloc(n, n));
    gsl_vector *const values = wb_memory_need(gsl_vector_alloc(n));
    gsl_eigen_gensymm_workspace *const work = wb_memory_need(gsl_eigen_gensymm_alloc(n));
    fill_mass(chain, is_torsion, mass);
    gsl_matrix_set_identity(stiffness);
    gsl_matrix_scale(stiffness, (is_torsion ? chain->torsion : chain->bending) / h);
    bool failed = gsl_eigen_gensymm(stiffness, mass, values, work) != GSL_SUCCESS;
    if (!failed) {
        *lowest = sqrt(gsl_vector_min(values));
        *highest = sqrt(gsl_vector_max(values));
        failed = !(isfinite(*lowest) && *lowest > 0.0 && isfinite(*highest));
    }
    gsl_matrix_free(mass);
    gsl_matrix_free(stiffness);
    gsl_vector_free(values);
    gsl_eigen_gensymm_free(work);
    return failed ? wb_fail(WB_ERR_ARGUMENT, "cannot compute the modes of the chain of %d segments",
                            chain->n)
                  : WB_OK;
}

enum wb_status wb_card_chain_modes(const struct wb_card_chain *chain,
                                   struct wb_card_chain_modes *modes)
{
    double lowest_torsion;
    gsl_set_error_handler_off();
    enum wb_status status = solve(chain, false, &modes->lowest_bending, &modes->highest_bending);
    if (status == WB_OK)
        status = solve(chain, true, &lowest_torsion, &modes->highest_torsion);
    return status;
}
