/* Functions of fe/rod/beam.c that only tests use. */
#ifndef WB_FE_ROD_BEAM_PRIVATE_H
#define WB_FE_ROD_BEAM_PRIVATE_H

#include "fe/rod/beam.h"

/* The tip in the stress-free reference configuration. */
const struct wb_beam_node *wb_beam_reference_tip(const struct wb_beam *beam);

/* Gauss point `g` (0 .. 2 n_elements - 1), from the clamp, of the state last evaluated. */
const struct wb_beam_point *wb_beam_point(const struct wb_beam *beam, int g);

#endif
