/* Functions of fe/bundle that only tests and benchmarks use. */
#ifndef WB_FE_BUNDLE_BUNDLE_PRIVATE_H
#define WB_FE_BUNDLE_BUNDLE_PRIVATE_H

#include <stddef.h>

struct wb_bundle;
struct wb_bundle_model;
struct wb_bundle_part;

/* External forces on the bundle in the last step, N, and its momentum after it, kg m/s, of the
 * scaled masses: the momentum changes in each step by the sum of the three forces times the
 * step. */
struct wb_bundle_outside {
    double clamp[3], tip[3], weight[3];
    double momentum[3];
};
void wb_bundle_get_outside(const struct wb_bundle *bundle, struct wb_bundle_outside *outside);

/* Stations, including halos, of the largest of `count` parts; 0 if the bundle is too short for
 * them. */
int wb_bundle_parts_largest(const struct wb_bundle_model *model, const char *mesh, int count);

/* Bytes that two neighbours in this bundle exchange in a step. */
size_t wb_bundle_parts_bytes(const struct wb_bundle_part *whole);

#endif
