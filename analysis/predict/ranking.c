#include "analysis/predict/ranking.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/fit.h"
#include "base/memory.h"
#include "base/random.h"

#define WB_LOG_DOMAIN "bands"

enum {
    RESAMPLES = 1000,
    ROWS = WB_RANKING_COLUMNS + 1, /* rows of products: the inputs, then the result */
    RESULT = WB_RANKING_COLUMNS
};

static const double least_r2 = 0.9;
static const double dependent =
    1e-6; /* of a column's squares: below, the column depends linearly on others */
static const double tail = 0.05;

/* Products of all columns less their means; the result is the last column. */
struct products {
    double of[ROWS][ROWS];
};

struct work {
    const struct wb_ranking_data *data;
    struct wb_memory memory;
    double *ranks;   /* (n x (n_columns + 1)), the result last */
    int *order;      /* (n) */
    double *sampled; /* ((1 + n_groups) x RESAMPLES): R2, then shares */
    struct products products, left;
};

/* --- ranks --- */

struct pair {
    double value;
    int index;
};

static int compare_pairs(const void *a, const void *b)
{
    const struct pair *const p = a, *const q = b;
    return p->value < q->value   ? -1
           : p->value > q->value ? 1
                                 : (p->index > q->index) - (p->index < q->index);
}

/* Ranks of n values `stride` apart; equal values share their mean rank. */
static void take_ranks(int n, const double *values, int stride, struct pair *pairs, double *ranks,
                       int rank_stride)
{
    for (int i = 0; i < n; i++)
        pairs[i] = (struct pair){values[(size_t)i * (size_t)stride], i};
    qsort(pairs, (size_t)n, sizeof *pairs, compare_pairs);
    for (int i = 0, end; i < n; i = end) {
        for (end = i + 1; end < n && pairs[end].value == pairs[i].value; end++)
            ;
        for (int k = i; k < end; k++)
            ranks[(size_t)pairs[k].index * (size_t)rank_stride] = 0.5 * (i + end - 1);
    }
}

static void rank_all(struct work *work)
{
    const struct wb_ranking_data *const d = work->data;
    struct pair *const pairs = wb_memory_take(&work->memory, (size_t)d->n, sizeof *pairs);
    for (int c = 0; c < d->n_columns; c++)
        take_ranks(d->n, d->columns + c, d->n_columns, pairs, work->ranks + c, d->n_columns + 1);
    take_ranks(d->n, d->result, 1, pairs, work->ranks + d->n_columns, d->n_columns + 1);
}

/* --- regression --- */

/* Index of a column among the products. */
static int place(const struct work *work, int column)
{
    return column == work->data->n_columns ? RESULT : column;
}

static void multiply(struct work *work)
{
    const int n = work->data->n, m = work->data->n_columns + 1;
    double mean[ROWS] = {0.0};

    for (int i = 0; i < n; i++)
        for (int c = 0; c < m; c++)
            mean[c] += work->ranks[work->order[i] * m + c] / n;
    memset(&work->products, 0, sizeof work->products);
    for (int i = 0; i < n; i++) {
        const double *const row = work->ranks + (size_t)work->order[i] * (size_t)m;
        for (int a = 0; a < m; a++)
            for (int b = 0; b <= a; b++)
                work->products.of[place(work, a)][place(work, b)] +=
                    (row[a] - mean[a]) * (row[b] - mean[b]);
    }
}

/* Whether a column's ranks differ; those of a constant differ from their mean by round-off
 * alone. */
static bool varies(const struct work *work, int column)
{
    return work->products.of[column][column] > dependent * work->data->n;
}

/* Removes a column's contribution from the remaining columns (Gauss; lower triangle in order of
 * places). A column with almost no remainder depends linearly on those before it, and explains
 * nothing. */
static void eliminate(struct products *left, int column, const struct products *all)
{
    const double pivot = left->of[column][column];
    if (!(pivot > dependent * all->of[column][column]))
        return;
    double factor[ROWS];
    for (int a = 0; a < ROWS; a++)
        factor[a] = (a >= column ? left->of[a][column] : left->of[column][a]) / pivot;
    for (int a = 0; a < ROWS; a++)
        for (int b = 0; b <= a && factor[a] != 0.0; b++)
            left->of[a][b] -= factor[a] * factor[b] * pivot;
}

/* R2 of all columns except those of a group; -1: of all columns. */
static double explain(struct work *work, int without)
{
    const struct wb_ranking_data *const d = work->data;
    const double all = work->products.of[RESULT][RESULT];

    if (!(all > 0.0))
        return 0.0;
    work->left = work->products;
    for (int c = 0; c < d->n_columns; c++)
        if (d->group[c] != without && varies(work, c))
            eliminate(&work->left, c, &work->products);
    return 1.0 - work->left.of[RESULT][RESULT] / all;
}

/* --- ranking --- */

static bool group_varies(const struct work *work, int group)
{
    for (int c = 0; c < work->data->n_columns; c++)
        if (work->data->group[c] == group && varies(work, c))
            return true;
    return false;
}

static void find_interval(double *values, double *low, double *high)
{
    wb_fit_sort(values, RESAMPLES);
    *low = values[(int)(tail * RESAMPLES)];
    *high = values[(int)((1.0 - tail) * RESAMPLES) - 1];
}

static void resample(struct work *work, const struct wb_ranking *ranking)
{
    const struct wb_ranking_data *const d = work->data;
    for (int r = 0; r < RESAMPLES; r++) {
        for (int i = 0; i < d->n; i++)
            work->order[i] =
                (int)(wb_random_bits(d->seed, (uint64_t)r, (uint64_t)i) % (uint64_t)d->n);
        multiply(work);
        const double r2 = explain(work, -1);
        work->sampled[r] = r2;
        for (int g = 0; g < ranking->n_groups; g++)
            work->sampled[(g + 1) * RESAMPLES + r] = r2 - explain(work, ranking->group[g].group);
    }
}

static int compare_shares(const void *a, const void *b)
{
    const struct wb_ranking_share *const p = a, *const q = b;
    return p->share > q->share   ? -1
           : p->share < q->share ? 1
                                 : (p->group > q->group) - (p->group < q->group);
}

static void rank(struct work *work, struct wb_ranking *ranking)
{
    const struct wb_ranking_data *const d = work->data;
    *ranking = (struct wb_ranking){.n_groups = 0};
    for (int i = 0; i < d->n; i++)
        work->order[i] = i;
    multiply(work);
    ranking->r2 = explain(work, -1);
    ranking->is_valid = ranking->r2 >= least_r2;
    for (int g = 0; g < d->n_groups; g++)
        if (group_varies(work, g))
            ranking->group[ranking->n_groups++] =
                (struct wb_ranking_share){.group = g, .share = ranking->r2 - explain(work, g)};
    qsort(ranking->group, (size_t)ranking->n_groups, sizeof ranking->group[0], compare_shares);
    resample(work, ranking);
    find_interval(work->sampled, &ranking->low, &ranking->high);
    for (int g = 0; g < ranking->n_groups; g++)
        find_interval(work->sampled + (g + 1) * RESAMPLES, &ranking->group[g].low,
                      &ranking->group[g].high);
}

enum wb_status wb_ranking_compute(struct wb_ranking *ranking, const struct wb_ranking_data *data)
{
    if (data->n < data->n_columns + 4 || data->n_columns > WB_RANKING_COLUMNS ||
        data->n_groups > WB_RANKING_GROUPS)
        return wb_fail(WB_ERR_ARGUMENT,
                       "a ranking of %d inputs in %d groups from %d runs: expected at most %d, at "
                       "most %d, and at least four runs more than inputs",
                       data->n_columns, data->n_groups, data->n, WB_RANKING_COLUMNS,
                       WB_RANKING_GROUPS);
    struct work *const work = wb_memory_new(1, sizeof *work);
    struct wb_memory *const m = &work->memory;
    work->data = data;
    work->ranks =
        wb_memory_take(m, (size_t)data->n * (size_t)(data->n_columns + 1), sizeof(double));
    work->order = wb_memory_take(m, (size_t)data->n, sizeof(int));
    work->sampled = wb_memory_take(m, (size_t)(data->n_groups + 1) * RESAMPLES, sizeof(double));
    rank_all(work);
    rank(work, ranking);
    wb_memory_release(m);
    free(work);
    return WB_OK;
}
