/* Energies of the section model (fe/section/section_beam.h): what its parts took up in an
 * increment. */
#ifndef WB_FE_SECTION_SECTION_ENERGY_H
#define WB_FE_SECTION_SECTION_ENERGY_H

#include "fe/section/section_beam.h"

/* Adds to beam->energies from the committed to the trial state, which was evaluated last. */
void wb_section_energy_take(struct wb_section_beam *beam);

#endif
