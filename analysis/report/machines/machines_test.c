#include "analysis/report/machines/machines_test.h"

#include <math.h>

double wb_machines_test_start(const struct wb_machines_test *test, double zero_force)
{
    const struct wb_dataset *const dataset = &test->dataset;
    size_t first = 0;
    while (first < dataset->n_rows && !(dataset->rows[first].force > zero_force))
        first++;
    return first + 1 < dataset->n_rows ? dataset->rows[first].deflection : (double)NAN;
}

double wb_machines_test_force(const struct wb_machines_test *test, double start, double deflection)
{
    const struct wb_dataset *const dataset = &test->dataset;
    for (size_t i = 1; i < dataset->n_rows; i++) {
        const double a = dataset->rows[i - 1].deflection - start;
        const double b = dataset->rows[i].deflection - start;
        if (a <= deflection && b > deflection)
            return dataset->rows[i - 1].force +
                   (deflection - a) / (b - a) *
                       (dataset->rows[i].force - dataset->rows[i - 1].force);
    }
    return (double)NAN;
}

double wb_machines_test_reach(const struct wb_machines_test *test)
{
    double most = -HUGE_VAL;
    for (size_t i = 0; i < test->dataset.n_rows; i++)
        most = fmax(most, test->dataset.rows[i].deflection - test->start);
    return most;
}
