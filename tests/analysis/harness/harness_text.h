/* A harness file for tests, with lines that tests replace. */
#ifndef WB_TESTS_ANALYSIS_HARNESS_HARNESS_TEXT_H
#define WB_TESTS_ANALYSIS_HARNESS_HARNESS_TEXT_H

#include <stdio.h>
#include <stdlib.h>

#include "analysis/harness/harness_file.h"
#include "tests/check.h"

/* One line each, so that its number is its index plus 1. */
static const char *const harness_lines[] = {
    "kind: harness",
    "name: sample",
    "wires:",
    "  - {name: trunk, wire: bundle-7}",
    "  - {name: lead, wire: type3}",
    "root: {name: R}",
    "branches:",
    "  - {name: B1, from: R, to: J, wire: trunk, length_mm: 300}",
    "  - {name: B2, from: J, to: K1, wire: lead, length_mm: 200, angle_deg: 30, around_deg: 90}",
    "  - {name: B3, from: J, to: K2, wire: lead, length_mm: 250}",
    "connectors:",
    "  - {name: K1, mass_g: 8, centre_mm: [12, 0, 0]}",
    "  - {name: K2}",
    "clips:",
    "  - {name: C1, branch: B1, at_mm: 200, holds: axis}",
    "steps:",
    "  - hang",
    "  - {mount: C1, at_mm: [190, 0, 30], direction: [1, 0.2, 0.2]}",
    "  - {move: C1, at_mm: [190, 20, 30]}",
    "  - {release: C1}",
    "  - take_off",
};

enum {
    HARNESS_LINES = sizeof harness_lines / sizeof harness_lines[0]
};

/* Writes the file with line `line` (from 1; 0: none) replaced; NULL: left out. */
static inline void write_harness(const char *path, int line, const char *text)
{
    FILE *const file = fopen(path, "w");
    assert_non_null(file);
    for (int i = 0; i < HARNESS_LINES; i++) {
        const char *const own = i + 1 == line ? text : harness_lines[i];
        if (own)
            fprintf(file, "%s\n", own);
    }
    assert_int_equal(fclose(file), 0);
}

static inline struct wb_harness_plan *make_plan(void)
{
    struct wb_harness_plan *const plan = calloc(1, sizeof *plan);
    assert_non_null(plan);
    return plan;
}

#endif
