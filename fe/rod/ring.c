#include "fe/rod/ring.h"

#include <math.h>

#define WB_LOG_DOMAIN "section"

enum wb_status wb_ring_check(int n_rings, int n_around)
{
    if (n_rings < 1 || n_rings > WB_RING_MOST)
        return wb_fail(WB_ERR_ARGUMENT, "%d rings of fibres: expected 1 to %d", n_rings,
                       WB_RING_MOST);
    if (n_around < 4 || n_around > WB_RING_MOST_AROUND || n_around % 4 != 0)
        return wb_fail(WB_ERR_ARGUMENT,
                       "%d fibres in a ring: expected a multiple of 4 from 4 to %d", n_around,
                       WB_RING_MOST_AROUND);
    return WB_OK;
}

void wb_ring_rule(int n, double *point, double *weight)
{
    for (int i = 0; i < n; i++) {
        double x = cos(M_PI * (n - i - 0.25) / (n + 0.5)), slope = 1.0;
        for (int iteration = 0; iteration < 20; iteration++) {
            double p = 1.0, before = 0.0;
            for (int k = 1; k <= n; k++) {
                const double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
                before = p;
                p = next;
            }
            slope = n * (x * p - before) / (x * x - 1.0);
            const double step = p / slope;
            x -= step;
            if (fabs(step) < 1e-15)
                break;
        }
        point[i] = 0.5 * (1.0 + x);
        weight[i] = 1.0 / ((1.0 - x * x) * slope * slope);
    }
}

void wb_ring_direction(int i, int n_around, bool turned, double *c, double *s)
{
    const int halves = 2 * n_around; /* in half spaces */
    const int at = (2 * i + (turned ? 1 : 0)) % halves;
    const int quarter = halves / 4;
    const int quadrant = at / quarter, within = at % quarter;
    const bool beyond = 2 * within > quarter;
    const double angle = 2.0 * M_PI * (beyond ? quarter - within : within) / halves;
    const double a = beyond ? sin(angle) : cos(angle), b = beyond ? cos(angle) : sin(angle);

    *c = quadrant == 0 ? a : quadrant == 1 ? -b : quadrant == 2 ? -a : b;
    *s = quadrant == 0 ? b : quadrant == 1 ? a : quadrant == 2 ? -b : -a;
}
