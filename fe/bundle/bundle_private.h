/* Functions of fe/bundle that only tests and benchmarks use. */
#ifndef WB_FE_BUNDLE_BUNDLE_PRIVATE_H
#define WB_FE_BUNDLE_BUNDLE_PRIVATE_H

#include <stddef.h>

struct wb_bundle_model;
struct wb_bundle_part;

/* Stations, including halos, of the largest of `count` parts; 0 if the bundle is too short for
 * them. */
int wb_bundle_parts_largest(const struct wb_bundle_model *model, const char *mesh, int count);

/* Bytes that two neighbours in this bundle exchange in a step. */
size_t wb_bundle_parts_bytes(const struct wb_bundle_part *whole);

#endif
