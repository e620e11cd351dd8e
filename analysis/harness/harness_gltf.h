/* Shapes of a harness as one binary glTF file for browsers and CAD: a tube for each branch, marks
 * for root, connectors and clips, and an animation through all shapes of the results. */
#ifndef WB_ANALYSIS_HARNESS_HARNESS_GLTF_H
#define WB_ANALYSIS_HARNESS_HARNESS_GLTF_H

#include "analysis/harness/harness_run.h"
#include "base/status.h"

enum {
    WB_HARNESS_GLTF_AROUND = 8 /* points of a ring of a tube */
};

/* Writes the file. The scene as it rests is the last shape that is mounted. */
WB_MUST_CHECK enum wb_status wb_harness_gltf_write(const struct wb_harness_result_set *set,
                                                   const char *path);

#endif
