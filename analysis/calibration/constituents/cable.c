#include "analysis/calibration/constituents/cable.h"

#include <math.h>
#include <stdbool.h>

#include <gsl/gsl_cdf.h>

#include "fe/material/hardening.h"

#define WB_LOG_DOMAIN "cable"

enum {
    ORIENTATIONS = 128 /* over a quarter of a turn */
};

/* Curvatures of the section relative to the largest nominal one: first, ratio of successive ones,
 * last. */
static const double first = 1e-3, growth = 1.003, last = 1e4;

static const double coverage = 0.95;

double wb_cable_curvature(double deflection, double span)
{
    return 12.0 * deflection / (span * span);
}

double wb_cable_deflection(double curvature, double span)
{
    return curvature * span * span / 12.0;
}

double wb_cable_moment(double force, double span)
{
    return 0.25 * force * span;
}

/* --- bonded wires --- */

static double stress(const struct wb_material *material, double strain)
{
    const double elastic = material->youngs_modulus * strain;
    const double over = elastic - material->yield_stress;
    if (!wb_hardening_law(material)->yields || over <= 0.0)
        return elastic;
    return material->yield_stress + (1.0 - wb_hardening_ratio(material, over)) * over;
}

/* Axial moment of the ring at a curvature of the section, averaged over its orientation. */
static double axial_moment(const struct wb_cable_ring *ring, double curvature)
{
    double sum = 0.0;
    for (int i = 0; i < ORIENTATIONS; i++) {
        const double arm = ring->radius * cos(0.5 * M_PI * (i + 0.5) / ORIENTATIONS);
        sum += stress(&ring->conductor, curvature * arm) * arm;
    }
    return ring->n_wires * ring->area * sum / ORIENTATIONS;
}

enum wb_status wb_cable_axial_moments(const struct wb_cable_ring *ring, const double *curvature,
                                      int n, double *moment, struct wb_reason *why)
{
    double largest = 0.0;
    if (!(ring->n_wires > 0 && ring->radius > 0.0 && ring->area > 0.0))
        return wb_fail_to(why, WB_ERR_ARGUMENT, "a ring needs wires, a radius and an area");
    if (wb_hardening_law(&ring->conductor)->moves)
        return wb_fail_to(why, WB_ERR_ARGUMENT,
                          "the conductor's hardening is kinematic: expected isotropic");
    for (int i = 0; i < n; i++) {
        largest = fmax(largest, curvature[i]);
        moment[i] = 0.0;
    }
    /* With kappa(M) the curvature of the section, the nominal curvature is 3 / M^2 int kappa m dm
     * from 0 to M. It lags behind that of the section, without limit where a hinge forms. */
    double k0 = 0.0, m0 = 0.0, nominal0 = 0.0, integral = 0.0;
    for (double k = first * largest; largest > 0.0 && nominal0 < largest && k < last * largest;
         k *= growth) {
        const double m = axial_moment(ring, k), dm = m - m0, dk = k - k0;
        /* Exact for a straight segment. */
        integral += dm * (k0 * m0 + 0.5 * (k0 * dm + dk * m0) + dk * dm / 3.0);
        const double nominal = 3.0 * integral / (m * m);
        for (int i = 0; i < n; i++) {
            if (curvature[i] > nominal)
                moment[i] = m;
            else if (curvature[i] > nominal0)
                moment[i] = m0 + dm * (curvature[i] - nominal0) / (nominal - nominal0);
        }
        k0 = k;
        m0 = m;
        nominal0 = nominal;
    }
    return WB_OK;
}

/* --- means and position between the bounds --- */

static struct wb_cable_mean finish(double sum, double squares, int n, int n_series)
{
    struct wb_cable_mean mean = {n, n_series, sum / n, (double)NAN, 0.0};
    if (n > 1) {
        mean.variance = fmax(0.0, squares - n * mean.mean * mean.mean) / (n - 1.0) / n;
        mean.degrees = n - 1.0;
    }
    return mean;
}

struct wb_cable_mean wb_cable_mean(const double *values, const int *series, int n)
{
    double sum[2] = {0.0, 0.0}, squares[2] = {0.0, 0.0}; /* over tests; over series */
    int count[2] = {0, 0};
    for (int i = 0; i < n; i++) {
        bool is_first = true;
        double of_series = 0.0;
        int in_series = 0;
        if (!isfinite(values[i]))
            continue;
        sum[0] += values[i];
        squares[0] += values[i] * values[i];
        count[0]++;
        for (int k = 0; k < n; k++) {
            if (series[k] != series[i] || !isfinite(values[k]))
                continue;
            is_first = is_first && k >= i;
            of_series += values[k];
            in_series++;
        }
        if (!is_first)
            continue;
        sum[1] += of_series / in_series;
        squares[1] += pow(of_series / in_series, 2);
        count[1]++;
    }
    const int over = count[1] > 1;
    struct wb_cable_mean mean = finish(sum[over], squares[over], count[over], count[1]);
    mean.n = count[0];
    return mean;
}

struct part {
    double variance, degrees;
};

static double half_width(const struct part *parts, int n)
{
    double variance = 0.0, below = 0.0;
    for (int i = 0; i < n; i++) {
        variance += parts[i].variance;
        if (parts[i].variance > 0.0)
            below += parts[i].variance * parts[i].variance / parts[i].degrees;
    }
    if (!(variance > 0.0))
        return variance; /* 0, or NaN */
    return gsl_cdf_tdist_Qinv(0.5 * (1.0 - coverage), variance * variance / below) * sqrt(variance);
}

void wb_cable_place(struct wb_cable_place *place, const struct wb_cable_mean *cable,
                    const struct wb_cable_mean *wire, const struct wb_cable_mean *core, int n_wires,
                    double axial)
{
    const double m = cable->mean, free = n_wires * wire->mean + core->mean;
    struct part of_chi[3] = {
        {cable->variance / (axial * axial), cable->degrees},
        {wire->variance * pow(n_wires / axial, 2), wire->degrees},
        {core->variance / (axial * axial), core->degrees},
    };
    struct part of_ratio[3] = {
        {cable->variance / (m * m), cable->degrees},
        {wire->variance * pow(n_wires / free, 2), wire->degrees},
        {core->variance / (free * free), core->degrees},
    };
    const double chi = (m - free) / axial, half = half_width(of_chi, 3);
    const double factor = exp(half_width(of_ratio, 3));
    place->measured = m;
    place->free = free;
    place->bonded = free + axial;
    place->chi = (struct wb_cable_interval){chi, chi - half, chi + half};
    place->ratio = (struct wb_cable_interval){m / free, m / free / factor, m / free * factor};
}
