/* An upper bound of a swept wire's frequencies, for the stable step 2 / omega.
 *
 * A layer is all elements between two stations, with half of these stations' mass. Its matrices are
 * the same everywhere along the wire, and the largest frequency of a wire of such layers is at most
 * that of one layer alone (B. M. Irons, Applications of a theorem on eigenvalues to finite element
 * problems, 1970), which is computed here. It is valid for the straight, stress-free wire; yielding
 * reduces it, and compressing an element's side by 1 % increases it by about 1 %.
 */
#ifndef WB_FE_SWEPT_SWEPT_FREQUENCY_H
#define WB_FE_SWEPT_SWEPT_FREQUENCY_H

#include "fe/swept/swept_hex.h"

enum {
    WB_SWEPT_FREQUENCY_MOST_NODES = 600 /* of a section */
};

/* rad/s, for masses per length `node_mass` (one per section node, kg/m) and the selective mass
 * scaling of fe/swept/swept_step.h (1: none). Mass scaling by f_m divides it by sqrt(f_m). */
WB_MUST_CHECK enum wb_status wb_swept_frequency_bound(const struct wb_swept_hex *hex,
                                                      const double *node_mass, double selective,
                                                      double *omega);

/* The largest eigenvalue of a symmetric matrix K (n x n, overwritten), which must be above 0;
 * otherwise the message names the body that it is `of`. */
WB_MUST_CHECK enum wb_status wb_swept_frequency_largest(double *K, int n, const char *of,
                                                        double *value);

#endif
