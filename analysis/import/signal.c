#include "analysis/import/signal.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "analysis/dataset/fit.h"
#include "base/memory.h"

/* s before and after a sample that are compared with it. */
#define SHAKE_HALF 0.2

size_t wb_signal_index(const struct wb_signal *s, double t)
{
    return wb_fit_first_at(s->t, sizeof *s->t, s->n, t);
}

/* Linear between samples, constant beyond the ends. */
static double value_at(const struct wb_signal *s, double t)
{
    const size_t next = wb_signal_index(s, t);
    if (next == 0)
        return s->x[0];
    if (next == s->n)
        return s->x[s->n - 1];
    return wb_fit_between(t, s->t[next - 1], s->x[next - 1], s->t[next], s->x[next]);
}

double wb_signal_noise(const struct wb_signal *s)
{
    if (s->n < 8)
        return 0.0;
    double *const second = wb_memory_new(s->n, sizeof *second);
    for (size_t i = 1; i + 1 < s->n; i++)
        second[i - 1] = fabs(s->x[i - 1] - 2.0 * s->x[i] + s->x[i + 1]);
    const double size = wb_fit_usual_size(second, s->n - 2);
    free(second);
    return size / sqrt(6.0);
}

void wb_signal_shake(const struct wb_signal *s, double *out)
{
    for (size_t i = 0; i < s->n; i++) {
        const double t = s->t[i];
        const bool inside = t - SHAKE_HALF >= s->t[0] && t + SHAKE_HALF <= s->t[s->n - 1];
        out[i] = inside
                     ? s->x[i] - 0.5 * (value_at(s, t - SHAKE_HALF) + value_at(s, t + SHAKE_HALF))
                     : 0.0;
    }
}
