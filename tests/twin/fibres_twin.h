/* The slow twin of fe/rod/fibres.h: the material law itself, fibre by fibre, without a table,
 * vectors or a short cut for sections that never yielded.
 */
#ifndef WB_TESTS_TWIN_FIBRES_TWIN_H
#define WB_TESTS_TWIN_FIBRES_TWIN_H

#include "fe/rod/fibres.h"

/* Histories are those of the section's fibres (n_fibres), all zero virgin; `after` may be `before`.
 */
void wb_fibres_twin_respond(const struct wb_section *section, double eps, double kappa,
                            const struct wb_material_state *before, struct wb_material_state *after,
                            struct wb_fibres_response *response);

#endif
