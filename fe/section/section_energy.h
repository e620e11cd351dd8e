/* Energies of the section model (fe/section/section_beam.h) in one increment. */
#ifndef WB_FE_SECTION_SECTION_ENERGY_H
#define WB_FE_SECTION_SECTION_ENERGY_H

#include "fe/section/section_beam.h"

/* Adds the increment from the committed to the trial state, which must be the state last evaluated,
 * to beam->energies. */
void wb_section_energy_take(struct wb_section_beam *beam);

#endif
