/* Functions of analysis/predict/specimens.c that only tests use. */
#ifndef WB_ANALYSIS_PREDICT_SPECIMENS_PRIVATE_H
#define WB_ANALYSIS_PREDICT_SPECIMENS_PRIVATE_H

#include "analysis/predict/specimens.h"

/* Initialises from n laws, WB_SPECIMENS_LEAST to WB_SPECIMENS_MOST. */
void wb_specimens_init(struct wb_specimens *specimens, int n, const struct wb_material *const *law);

#endif
