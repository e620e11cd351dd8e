/* A harness of harness_text.h that is read and computed. */
#ifndef WB_TESTS_ANALYSIS_HARNESS_HARNESS_SET_H
#define WB_TESTS_ANALYSIS_HARNESS_HARNESS_SET_H

#include "analysis/harness/harness_run.h"
#include "tests/analysis/harness/harness_text.h"
#include "tests/own_folder.h"

static const struct wb_harness_settings yielding = {.torsion = 1.0};

/* Computes the file with a line replaced; the caller releases the results and frees the plan. */
static inline struct wb_harness_plan *compute_set(struct wb_harness_result_set *set, int line,
                                                  const char *text,
                                                  const struct wb_harness_settings *settings)
{
    struct wb_harness_plan *const plan = make_plan();
    char path[64];
    snprintf(path, sizeof path, "%s/h.yaml", folder);
    write_harness(path, line, text);
    assert_int_equal(wb_harness_file_read(plan, path), WB_OK);
    assert_int_equal(wb_harness_run_compute(set, plan, settings, NULL, NULL), WB_OK);
    return plan;
}

static inline void release_set(struct wb_harness_result_set *set, struct wb_harness_plan *plan)
{
    wb_harness_run_release(set);
    free(plan);
}

#endif
