/* What the files of fe/swept/swept_tape.h share. */
#ifndef WB_FE_SWEPT_SWEPT_TAPE_PRIVATE_H
#define WB_FE_SWEPT_SWEPT_TAPE_PRIVATE_H

#include "fe/swept/swept_tape.h"
#include "fe/swept/swept_tape_kernel.h"

/* An element of the reference state. */
struct wb_swept_tape_element {
    double node[4][3], director[4][3]; /* (k, j), (k, j + 1), (k + 1, j), (k + 1, j + 1) */
    double area;                       /* m2; of the plane through the middle */
    double B[3];                       /* 11, 21, 22 */
    double hourglass[2];               /* in the frame, m */
    double normal[3];
};

struct wb_swept_tape {
    struct wb_swept_tape_model model;
    const struct wb_swept_tape_kernel *kernel;
    struct wb_swept_tape_kernel_model numbers;
    void *reference, *table, *length_stiffness;
    double *position, *director; /* fields */
    double *area;                /* (n_nodes x stride) */
    double *mass, *inertia;      /* (n_nodes), per length */
};

/* Positions of an element's nodes, and what follows from them; directors are zero before they are
 * made. False when it is not convex. */
bool wb_swept_tape_element_of(const struct wb_swept_tape *tape, int k, int j,
                              struct wb_swept_tape_element *element);

/* Squared radius of gyration that its directors get, m2. */
double wb_swept_tape_gyration(const struct wb_swept_tape *tape,
                              const struct wb_swept_tape_element *element);

#endif
