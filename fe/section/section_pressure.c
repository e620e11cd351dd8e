#include "fe/section/section_pressure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

enum {
    BLOCK_TRIES = 3, /* exchanges of all wrong contacts without progress before single exchanges */
    MAX_EXCHANGES = 2000
};

/* Added to the diagonal, relative to a unit entry: selects the forces with the smallest sum of
 * squares when several balance the loads. */
static const double ridge = 1e-9;
static const double negligible = 1e-10; /* of the largest force */

struct wb_section_pressure {
    int n, n_equations;
    double *balance;      /* (n_equations x n), scaled by the weights of rows and columns */
    double *row_weight;   /* (n_equations) */
    double *column_scale; /* (n): force = scale times unknown */
    double *matrix;       /* (n x n) balance^T balance + ridge */
    double *right, *trial, *slope; /* (n) */
    /* For each place: which contacts are pressed, and the Cholesky factor of their part of the
     * matrix. */
    bool *pressed; /* (n_places x n) */
    int *n_pressed, *list;
    double *factor; /* (n_places x n x n) */
    struct wb_memory memory;
};

void wb_section_pressure_destroy(struct wb_section_pressure *p)
{
    if (!p)
        return;
    wb_memory_release(&p->memory);
    free(p);
}

/* --- factor of a place --- */

struct place {
    bool *pressed;
    int *n, *list;
    double *factor; /* rows of n entries */
};

static struct place place_of(struct wb_section_pressure *p, int index)
{
    const size_t n = (size_t)p->n, at = (size_t)index;
    return (struct place){p->pressed + at * n, &p->n_pressed[at], p->list + at * n,
                          p->factor + at * n * n};
}

static void factor(const struct wb_section_pressure *p, const struct place *place)
{
    *place->n = 0;
    for (int i = 0; i < p->n; i++)
        if (place->pressed[i])
            place->list[(*place->n)++] = i;
    for (int i = 0; i < *place->n; i++) {
        double *const row = place->factor + (size_t)i * (size_t)p->n;
        for (int k = 0; k <= i; k++) {
            const double *const other = place->factor + (size_t)k * (size_t)p->n;
            double sum = p->matrix[(size_t)place->list[i] * (size_t)p->n + (size_t)place->list[k]];
            for (int j = 0; j < k; j++)
                sum -= row[j] * other[j];
            row[k] = i == k ? 1.0 / sqrt(sum) : sum * other[k];
        }
    }
}

/* Forces of the pressed contacts, in `trial` at their indices; the other forces are zero. */
static void solve_pressed(struct wb_section_pressure *p, const struct place *place, double *x)
{
    for (int i = 0; i < *place->n; i++) {
        const double *const row = place->factor + (size_t)i * (size_t)p->n;
        double sum = p->right[place->list[i]];
        for (int k = 0; k < i; k++)
            sum -= row[k] * x[k];
        x[i] = sum * row[i];
    }
    for (int i = *place->n - 1; i >= 0; i--) {
        const double *const row = place->factor + (size_t)i * (size_t)p->n;
        x[i] *= row[i];
        for (int k = 0; k < i; k++)
            x[k] -= row[k] * x[i];
    }
    memset(p->trial, 0, (size_t)p->n * sizeof *p->trial);
    for (int i = 0; i < *place->n; i++)
        p->trial[place->list[i]] = x[i];
}

/* --- exchanges --- */

/* Finds contacts with tensile forces, and open ones that would be pressed. Returns their number;
 * *last receives the last one. */
static int find_wrong(struct wb_section_pressure *p, const struct place *place, double tolerance,
                      bool *wrong, int *last)
{
    int n = 0;

    for (int i = 0; i < p->n; i++) {
        if (place->pressed[i]) {
            wrong[i] = p->trial[i] < -tolerance;
        } else {
            const double *const row = p->matrix + (size_t)i * (size_t)p->n;
            double slope = -p->right[i];
            for (int k = 0; k < *place->n; k++)
                slope += row[place->list[k]] * p->trial[place->list[k]];
            wrong[i] = slope < -tolerance;
        }
        n += wrong[i];
        if (wrong[i])
            *last = i;
    }
    return n;
}

static void exchange(struct wb_section_pressure *p, const struct place *place, double tolerance)
{
    bool wrong[3 * WB_PACKING_MOST];
    double *const x = p->slope;
    int fewest = p->n + 1, tries = BLOCK_TRIES;

    for (int i = 0; i < MAX_EXCHANGES; i++) {
        int last = 0;
        solve_pressed(p, place, x);
        const int n = find_wrong(p, place, tolerance, wrong, &last);
        if (n == 0)
            return;
        if (n < fewest) {
            fewest = n;
            tries = BLOCK_TRIES;
        } else {
            tries--;
        }
        for (int k = 0; k < p->n; k++)
            if (wrong[k] && (tries > 0 || k == last))
                place->pressed[k] = !place->pressed[k];
        factor(p, place);
    }
}

double wb_section_pressure_solve(struct wb_section_pressure *p, int index, const double *load,
                                 double *force)
{
    const struct place place = place_of(p, index);
    double largest = 0.0, missing = 0.0;

    memset(p->right, 0, (size_t)p->n * sizeof *p->right);
    for (int e = 0; e < p->n_equations; e++) {
        const double *const row = p->balance + (size_t)e * (size_t)p->n;
        const double value = load[e] * p->row_weight[e];
        for (int i = 0; i < p->n && value != 0.0; i++)
            p->right[i] -= row[i] * value;
    }
    for (int i = 0; i < p->n; i++)
        largest = fmax(largest, fabs(p->right[i]));
    exchange(p, &place, negligible * largest);
    for (int e = 0; e < p->n_equations; e++) {
        const double *const row = p->balance + (size_t)e * (size_t)p->n;
        double value = load[e] * p->row_weight[e];
        for (int i = 0; i < p->n; i++)
            value += row[i] * p->trial[i];
        missing += value * value;
    }
    for (int i = 0; i < p->n; i++)
        force[i] = fmax(p->trial[i], 0.0) * p->column_scale[i];
    return sqrt(missing);
}

/* --- creation --- */

static void fill(struct wb_section_pressure *p, const struct wb_section_layout *layout)
{
    const size_t n = (size_t)p->n;

    for (int i = 0; i < p->n; i++)
        p->column_scale[i] = 1.0 / sqrt(layout->contacts[i].weight);
    for (int e = 0; e < p->n_equations; e++) {
        p->row_weight[e] = sqrt(layout->wires[e / 2].weight);
        for (size_t i = 0; i < n; i++)
            p->balance[(size_t)e * n + i] =
                layout->balance[(size_t)e * n + i] * p->row_weight[e] * p->column_scale[i];
    }
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < n; k++) {
            double sum = i == k ? ridge : 0.0;
            for (int e = 0; e < p->n_equations; e++)
                sum += p->balance[(size_t)e * n + i] * p->balance[(size_t)e * n + k];
            p->matrix[i * n + k] = sum;
        }
}

struct wb_section_pressure *wb_section_pressure_create(const struct wb_section_layout *layout,
                                                       int n_places)
{
    struct wb_section_pressure *const p = wb_memory_new(1, sizeof *p);
    const size_t n = (size_t)layout->n_contacts, rows = 2 * (size_t)layout->n_wires;
    const size_t places = (size_t)n_places;

    p->n = layout->n_contacts;
    p->n_equations = (int)rows;
    p->balance = wb_memory_take(&p->memory, rows * n, sizeof(double));
    p->row_weight = wb_memory_take(&p->memory, rows, sizeof(double));
    p->column_scale = wb_memory_take(&p->memory, n, sizeof(double));
    p->matrix = wb_memory_take(&p->memory, n * n, sizeof(double));
    p->right = wb_memory_take(&p->memory, n, sizeof(double));
    p->trial = wb_memory_take(&p->memory, n, sizeof(double));
    p->slope = wb_memory_take(&p->memory, n, sizeof(double));
    p->pressed = wb_memory_take(&p->memory, places * n, sizeof(bool));
    p->n_pressed = wb_memory_take(&p->memory, places, sizeof(int));
    p->list = wb_memory_take(&p->memory, places * n, sizeof(int));
    p->factor = wb_memory_take(&p->memory, places * n * n, sizeof(double));
    fill(p, layout);
    return p;
}
