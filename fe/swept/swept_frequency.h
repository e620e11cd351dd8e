/* An upper bound of a swept wire's frequencies, for the stable step 2 / omega.
 *
 * A layer, all elements between two stations with half of these stations' mass, has the same
 * matrices everywhere along the wire, and no wire of such layers vibrates faster than one of them
 * alone (B. M. Irons, Applications of a theorem on eigenvalues to finite element problems, 1970):
 * its largest frequency is computed as it is. It is that of the straight, stress-free wire;
 * yielding lowers it, and compressing an element's side by 1 % raises it by about that.
 */
#ifndef WB_FE_SWEPT_SWEPT_FREQUENCY_H
#define WB_FE_SWEPT_SWEPT_FREQUENCY_H

#include "fe/swept/swept_hex.h"

enum {
    WB_SWEPT_FREQUENCY_MOST_NODES = 600 /* of a section */
};

/* rad/s, with masses per length `node_mass` (one a section node, kg/m) and the selective mass
 * scaling of fe/swept/swept_step.h (1 is none). Mass scaling by f_m divides it by sqrt(f_m). */
WB_MUST_CHECK enum wb_status wb_swept_frequency_bound(const struct wb_swept_hex *hex,
                                                      const double *node_mass, double selective,
                                                      double *omega);

#endif
