/* Functions for the tests of fe/section/section_beam.h. */
#ifndef WB_FE_SECTION_SECTION_BEAM_PRIVATE_H
#define WB_FE_SECTION_SECTION_BEAM_PRIVATE_H

#include "fe/section/section_beam.h"

/* Index of an unknown of a station (0 to n_elements); -1 if it is fixed. */
int wb_section_beam_index(const struct wb_section_beam *beam, int station, int unknown);

#endif
