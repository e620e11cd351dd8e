/* Positions of a bundle's wires in its cross section: patches of the triangular lattice, and the
 * densest packing of any mixture.
 *
 * The section is the plane of y (up) and z (across); x runs along the bundle. Drawn with z to the
 * right and y up, one looks from the clamp towards the tip.
 */
#ifndef WB_FE_MODEL_PACKING_H
#define WB_FE_MODEL_PACKING_H

#include "base/status.h"

enum {
    WB_PACKING_MOST = 128 /* wires */
};

struct wb_packing_circle {
    double y, z;   /* m */
    double radius; /* m */
};

/* Wires in their order. */
struct wb_packing {
    int n;
    struct wb_packing_circle wire[WB_PACKING_MOST];
};

enum wb_packing_lattice {
    WB_PACKING_HEXAGON, /* round a wire: 1, 7, 19, 37, 61, 91, 127. The centre, then ring by ring,
                           each counter-clockwise from +z (seen with z to the right) */
    WB_PACKING_TRIANGLE /* round a triangle of wires: 3, 6, 12, 18, 21, 27, 30, 36 and on. By
                           distance from its centre, wires as far as each other counter-clockwise
                           from +z */
};

/* Puts n wires of the given diameters on a lattice whose pitch is the largest diameter; the centre
 * of the lattice is the origin. Fails if n does not fill a patch; the message names the nearest
 * numbers that do. */
WB_MUST_CHECK enum wb_status wb_packing_on_lattice(struct wb_packing *packing, int n,
                                                   const double *diameter,
                                                   enum wb_packing_lattice lattice);

/* Whole patches of a lattice, n at most WB_PACKING_MOST: the smallest of at least n wires, and the
 * largest of fewer (0: none). */
int wb_packing_whole(enum wb_packing_lattice lattice, int n, int *less);

struct wb_packing_search {
    unsigned int seed; /* of the random starts; the same seed gives the same packing */
    int trials;        /* packings tried, at least 1; 0: 40 for each wire */
};

/* Searches the smallest circle around n wires of the given diameters: random starts, and from each
 * the best packing so far with a wire moved or two wires exchanged, relaxed as by
 * wb_packing_settle(). For up to 24 equal wires it finds the densest known packing, up to 30 within
 * 1e-4, in a second; optimality is not proven. */
WB_MUST_CHECK enum wb_status wb_packing_densest(struct wb_packing *packing, int n,
                                                const double *diameter,
                                                const struct wb_packing_search *search);

/* Contracts the wires from their positions (they may overlap) to the nearest packing whose
 * enclosing circle is locally smallest; its centre becomes the origin. Unloaded wires roll towards
 * the centre until they touch others. Contacts are exact to round-off, without overlap. */
WB_MUST_CHECK enum wb_status wb_packing_settle(struct wb_packing *packing);

/* The smallest gap between any two wires, m; negative: they overlap. Infinite for one wire. */
double wb_packing_smallest_gap(const struct wb_packing *packing);

/* The smallest circle that holds n circles (n >= 1), exact to round-off. */
struct wb_packing_circle wb_packing_enclosing(int n, const struct wb_packing_circle *circles);

/* Two neighbouring wires. */
struct wb_packing_pair {
    int a, b;         /* a < b */
    double gap;       /* m; negative: they overlap */
    double direction; /* rad, of b from a, from +z towards +y */
};

/* Pairs at most `reach` (m) apart with no other wire between them, in ascending order of a and b;
 * the first `most` into `pairs`. Returns how many there are. Another wire is between two where it
 * touches the segment that joins their centres. */
int wb_packing_pairs(const struct wb_packing *packing, double reach, int most,
                     struct wb_packing_pair *pairs);

#endif
