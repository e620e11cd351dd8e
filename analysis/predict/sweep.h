/* A sweep over design choices of a bundle, from one word of the command line:
 * "layers=1,2:overlap=0,50:wires=7,19" is all eight combinations, the last varying fastest. */
#ifndef WB_ANALYSIS_PREDICT_SWEEP_H
#define WB_ANALYSIS_PREDICT_SWEEP_H

#include "base/status.h"
#include "fe/model/bundle_uncertainty.h"

/* Fills at most `most` variants, each named by its values, and sets *n. Layers are 1 to 20, overlap
 * is 0 to 95 in percent, wires are 1 to 128. WB_ERR_ARGUMENT for anything else; the message shows
 * where. */
WB_MUST_CHECK enum wb_status wb_sweep_parse(const char *text, int most,
                                            struct wb_bundle_variant *variants, int *n);

#endif
