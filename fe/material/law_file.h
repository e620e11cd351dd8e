/* The `law` block of a wire's properties, in wire files and in PROPERTIES.yaml:
 *
 *     law:
 *       form: parallel         # or ludwik: of the four numbers beside the block; or chaboche
 *       hardening: mixed       # or isotropic, kinematic, combined; chaboche: combined only
 *       isotropic_share: 0.3   # of mixed and combined hardening, but for chaboche
 *       parts:                 # of parallel parts, by ascending yield strain
 *         - {modulus_MPa: 2600, yield_strain: 0.00012}
 *         - {modulus_MPa: 350}   # without it the last stays elastic
 *       chaboche:              # of form chaboche
 *         youngs_modulus_MPa: 4500
 *         yield_stress_MPa: 2.1
 *         saturation_MPa: 1.4  # Q, by which the yield stress grows; without it 0
 *         rate: 300            # b, of that
 *         back_stresses:       # up to three, C and gamma
 *           - {modulus_MPa: 2600, recovery: 900}
 *       relaxation:            # Maxwell elements beside a law of any form, one or two
 *         strain_rate_1_s: 0.0003  # of the tests; without it 0: moments are the relaxed law's
 *         elements:
 *           - {modulus_MPa: 120, time_s: 15}
 *
 * Without the block the law is Ludwik's with isotropic hardening. The four numbers beside a block
 * of another form are their equivalent for solvers that know Ludwik's law alone.
 */
#ifndef WB_FE_MATERIAL_LAW_FILE_H
#define WB_FE_MATERIAL_LAW_FILE_H

#include "base/config.h"
#include "base/status.h"
#include "base/text.h"
#include "fe/material/law.h"

/* Reads the block `node`; NULL: the file has none. `ludwik` has Ludwik's four parameters and
 * Poisson's ratio. Errors name file, line and key. */
WB_MUST_CHECK enum wb_status wb_law_file_read(const struct wb_config_node *node,
                                              const struct wb_material *ludwik, struct wb_law *law);

/* Appends the block; nothing for Ludwik's law with isotropic hardening. Reading it back gives the
 * same law. */
void wb_law_file_append(struct wb_text *text, const struct wb_law *law);

#endif
