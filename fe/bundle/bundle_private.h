/* What only tests and benchmarks ask of bundles. */
#ifndef WB_FE_BUNDLE_BUNDLE_PRIVATE_H
#define WB_FE_BUNDLE_BUNDLE_PRIVATE_H

#include <stddef.h>

struct wb_bundle;
struct wb_bundle_model;
struct wb_bundle_part;

/* What acts on the bundle from outside in the last step, N, and its momentum after it, kg m/s, of
 * the scaled masses: each step changes it by all three forces times the step. */
struct wb_bundle_outside {
    double clamp[3], tip[3], weight[3];
    double momentum[3];
};
void wb_bundle_get_outside(const struct wb_bundle *bundle, struct wb_bundle_outside *outside);

/* Stations of the largest of so many parts, with its halos; 0 where there is no room for them. */
int wb_bundle_parts_largest(const struct wb_bundle_model *model, const char *mesh, int count);

/* Bytes that two neighbours in this bundle would send each other in a step. */
size_t wb_bundle_parts_bytes(const struct wb_bundle_part *whole);

#endif
