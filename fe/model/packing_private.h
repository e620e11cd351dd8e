/* What the files of fe/packing share: the relaxation that all packings but lattices are found by.
 */
#ifndef WB_FE_MODEL_PACKING_PRIVATE_H
#define WB_FE_MODEL_PACKING_PRIVATE_H

#include "fe/model/packing.h"

enum {
    WB_PACKING_UNKNOWNS = 2 * WB_PACKING_MOST + 1, /* y and z of each wire, then the radius */
    WB_PACKING_STEPS = 12                          /* that the minimisation remembers */
};

/* Wires in a ring that tightens, in units of their mean radius. */
struct wb_packing_ring {
    int n;
    double tension;   /* of the ring */
    double pull;      /* of the centre, for the tension and a distance */
    double reference; /* of the radius in the energy, so that its last digits count */
    double radius[WB_PACKING_MOST];
    double x[WB_PACKING_UNKNOWNS];
};

/* What the minimisation knows of the energy's curvature. */
struct wb_packing_memory {
    int n, first; /* steps, the oldest at `first` */
    double step[WB_PACKING_STEPS][WB_PACKING_UNKNOWNS];
    double change[WB_PACKING_STEPS][WB_PACKING_UNKNOWNS]; /* of the gradient in that step */
    double weight[WB_PACKING_STEPS];
};

/* Moves all until the forces are balanced to the part `balance` of the tension. */
void wb_packing_ring_balance(struct wb_packing_ring *ring, struct wb_packing_memory *memory,
                             double balance);

/* The energy at x, and its gradient. */
double wb_packing_ring_energy(const struct wb_packing_ring *ring, const double *x,
                              double *gradient);

/* Takes wires in, round their enclosing circle. */
void wb_packing_ring_enter(struct wb_packing_ring *ring, const struct wb_packing *packing);

/* Lowers the tension from `from`, until it does not matter, and writes the places to the wires. */
WB_MUST_CHECK enum wb_status wb_packing_ring_settle(struct wb_packing_ring *ring,
                                                    struct wb_packing_memory *memory, double from,
                                                    struct wb_packing *packing);

/* n wires of the given diameters, all at the origin. */
WB_MUST_CHECK enum wb_status wb_packing_take(struct wb_packing *packing, int n,
                                             const double *diameter);

/* Between the centres. */
double wb_packing_distance(const struct wb_packing_circle *a, const struct wb_packing_circle *b);

#endif
