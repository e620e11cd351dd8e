/* What only benchmarks ask of parts, for estimates of many of them. */
#ifndef WB_FE_BUNDLE_BUNDLE_PARTS_PRIVATE_H
#define WB_FE_BUNDLE_BUNDLE_PARTS_PRIVATE_H

#include <stddef.h>

#include "fe/bundle/bundle_part.h"

/* Stations of the largest of so many parts, with its halos; 0 where there is no room for them. */
int wb_bundle_parts_largest(const struct wb_bundle_model *model, const char *mesh, int count);

/* Bytes that two neighbours in this bundle would send each other in a step. */
size_t wb_bundle_parts_bytes(const struct wb_bundle_part *whole);

#endif
