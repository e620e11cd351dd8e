#include "analysis/align/axis_fit.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Intervals of the quadrature along the wire, two Gauss points each. */
#define INTERVALS 24
#define MAX_ITERATIONS 30

double wb_axis_fit_angle(const struct wb_axis_fit *fit, double s)
{
    const double u = s / fit->length;
    double sum = 0.0;
    for (int i = fit->n_terms - 1; i >= 0; i--)
        sum = (sum + fit->terms[i]) * u;
    return sum;
}

void wb_axis_fit_move(const struct wb_axis_fit *fit, double offset, double s, double *x, double *y)
{
    const double angle = wb_axis_fit_angle(fit, s);
    *x += offset * sin(angle);
    *y -= offset * cos(angle);
}

/* A marker's computed place and its derivatives with respect to the terms. */
struct place {
    double x, y;
    double dx[WB_AXIS_FIT_TERMS], dy[WB_AXIS_FIT_TERMS];
};

/* Adds a piece of the axis integrals from s0 to s1. */
static void integrate(const struct wb_axis_fit *fit, double s0, double s1, struct place *place)
{
    static const double points[2] = {0.21132486540518713, 0.78867513459481287};
    for (int g = 0; g < 2; g++) {
        const double s = s0 + (s1 - s0) * points[g];
        const double weight = 0.5 * (s1 - s0), angle = wb_axis_fit_angle(fit, s);
        const double c = weight * cos(angle), d = weight * sin(angle);
        double power = s / fit->length;
        place->x += c;
        place->y += d;
        for (int i = 0; i < fit->n_terms; i++) {
            place->dx[i] -= d * power;
            place->dy[i] += c * power;
            power *= s / fit->length;
        }
    }
}

static void add_offset(const struct wb_axis_fit *fit, double offset, double s, struct place *place)
{
    const double angle = wb_axis_fit_angle(fit, s);
    double power = s / fit->length;
    place->x -= offset * sin(angle);
    place->y += offset * cos(angle);
    for (int i = 0; i < fit->n_terms; i++) {
        place->dx[i] -= offset * cos(angle) * power;
        place->dy[i] -= offset * sin(angle) * power;
        power *= s / fit->length;
    }
}

struct normal_equations {
    double matrix[WB_AXIS_FIT_TERMS][WB_AXIS_FIT_TERMS], right[WB_AXIS_FIT_TERMS];
    double squares;
};

static void add_residual(struct normal_equations *equations, int n_terms, double residual,
                         const double *derivatives)
{
    equations->squares += residual * residual;
    for (int i = 0; i < n_terms; i++) {
        equations->right[i] += residual * derivatives[i];
        for (int k = 0; k < n_terms; k++)
            equations->matrix[i][k] += derivatives[i] * derivatives[k];
    }
}

/* Solves by Cholesky's method, in place; false when the matrix is not positive definite. */
static bool solve(struct normal_equations *equations, int n, double *step)
{
    double(*const a)[WB_AXIS_FIT_TERMS] = equations->matrix;
    for (int i = 0; i < n; i++) {
        for (int k = 0; k <= i; k++) {
            double sum = a[i][k];
            for (int m = 0; m < k; m++)
                sum -= a[i][m] * a[k][m];
            if (i == k && !(sum > 1e-14 * a[i][i]))
                return false;
            a[i][k] = i == k ? sqrt(sum) : sum / a[k][k];
        }
    }
    for (int i = 0; i < n; i++) {
        step[i] = equations->right[i];
        for (int m = 0; m < i; m++)
            step[i] -= a[i][m] * step[m];
        step[i] /= a[i][i];
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int m = i + 1; m < n; m++)
            step[i] -= a[m][i] * step[m];
        step[i] /= a[i][i];
    }
    return true;
}

static void assemble(const struct wb_axis_fit *fit, const struct wb_axis_fit_markers *markers,
                     struct normal_equations *equations)
{
    memset(equations, 0, sizeof *equations);
    struct place axis = {0};
    double reached = 0.0;
    for (int j = 0; j < markers->n; j++) {
        const double h = fit->length / INTERVALS;
        const int pieces = 1 + (int)((markers->s[j] - reached) / h);
        for (int i = 0; i < pieces; i++)
            integrate(fit, reached + (markers->s[j] - reached) * i / pieces,
                      reached + (markers->s[j] - reached) * (i + 1) / pieces, &axis);
        reached = markers->s[j];
        struct place place = axis;
        add_offset(fit, markers->offset, reached, &place);
        add_residual(equations, fit->n_terms, markers->x[j] - place.x, place.dx);
        add_residual(equations, fit->n_terms, markers->y[j] - place.y, place.dy);
    }
}

enum wb_status wb_axis_fit(struct wb_axis_fit *fit, double length,
                           const struct wb_axis_fit_markers *markers)
{
    const int n = markers->n;
    if (n < 1)
        return WB_ERR_DATA;
    struct wb_axis_fit current = {.length = length};
    /* Both coordinates of a marker are used, but x hardly depends on the shape of a straight
     * wire. */
    current.n_terms = n < WB_AXIS_FIT_TERMS ? n : WB_AXIS_FIT_TERMS;
    /* Initial guess from the chord to the last marker: the end angle of a uniformly bent wire is
     * twice that of its chord. */
    current.terms[0] = 2.0 * atan2(markers->y[n - 1] - markers->offset, markers->x[n - 1]) *
                       length / markers->s[n - 1];
    for (int iteration = 0; iteration < MAX_ITERATIONS; iteration++) {
        struct normal_equations equations;
        double step[WB_AXIS_FIT_TERMS] = {0.0}, largest = 0.0;
        assemble(&current, markers, &equations);
        current.residual = sqrt(equations.squares / (2.0 * n));
        if (!isfinite(current.residual) || !solve(&equations, current.n_terms, step))
            return WB_ERR_DATA;
        for (int i = 0; i < current.n_terms; i++) {
            current.terms[i] += step[i];
            largest = fmax(largest, fabs(step[i]));
        }
        if (largest < 1e-10) {
            *fit = current;
            return WB_OK;
        }
    }
    return WB_ERR_DATA;
}
