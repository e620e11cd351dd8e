#include "analysis/predict/hypercube.h"

#include <stddef.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/random.h"

/* A run and its score in a dimension, which determines its stratum. */
struct place {
    double score;
    int run;
};

static int compare_places(const void *a, const void *b)
{
    const struct place *const p = a, *const q = b;
    return p->score < q->score   ? -1
           : p->score > q->score ? 1
                                 : (p->run > q->run) - (p->run < q->run);
}

/* Strata in random order (Fisher and Yates), relative to their mean. */
static void shuffle(uint64_t seed, int dimension, int n, double *strata)
{
    for (int i = 0; i < n; i++)
        strata[i] = i - 0.5 * (n - 1);
    for (int i = n - 1; i > 0; i--) {
        const uint64_t bits = wb_random_bits(seed, 2 * (uint64_t)dimension, (uint64_t)i);
        const int k = (int)(bits % (uint64_t)(i + 1));
        const double stratum = strata[i];
        strata[i] = strata[k];
        strata[k] = stratum;
    }
}

/* Removes the correlation of a dimension's strata with those of another dimension. */
static void separate(int n, const double *other, double *strata)
{
    double product = 0.0, square = 0.0;
    for (int i = 0; i < n; i++) {
        product += strata[i] * other[i];
        square += other[i] * other[i];
    }
    for (int i = 0; i < n; i++)
        strata[i] -= product / square * other[i];
}

/* Replaces scores by whole strata in the same order. */
static void rank(int n, struct place *places, double *strata)
{
    for (int i = 0; i < n; i++)
        places[i] = (struct place){strata[i], i};
    qsort(places, (size_t)n, sizeof *places, compare_places);
    for (int i = 0; i < n; i++)
        strata[places[i].run] = i - 0.5 * (n - 1);
}

void wb_hypercube_fill(uint64_t seed, int n, int dimensions, double *points)
{
    const double inside = 1e-9; /* of a stratum: 0 and 1 have no normal quantile */
    const size_t size = (size_t)n;
    double *const strata = wb_memory_new(size * (size_t)dimensions, sizeof *strata);
    struct place *const places = wb_memory_new(size, sizeof *places);

    for (int d = 0; d < dimensions; d++) {
        double *const own = strata + (size_t)d * size;
        shuffle(seed, d, n, own);
        for (int k = 0; k < d; k++)
            separate(n, strata + (size_t)k * size, own);
        rank(n, places, own);
        for (int i = 0; i < n; i++) {
            const double within =
                wb_random_between(seed, 2 * (uint64_t)d + 1, (uint64_t)i, inside, 1.0 - inside);
            points[(size_t)i * (size_t)dimensions + (size_t)d] =
                (own[i] + 0.5 * (n - 1) + within) / n;
        }
    }
    free(strata);
    free(places);
}
