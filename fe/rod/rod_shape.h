/* Shape functions of a quadratic line element of three nodes at its two Gauss points. */
#ifndef WB_FE_ROD_ROD_SHAPE_H
#define WB_FE_ROD_ROD_SHAPE_H

#include <math.h>

enum {
    WB_ROD_SHAPE_NODES = 3,
    WB_ROD_SHAPE_POINTS = 2
};

/* The shape functions of all elements of a beam or rod; derivatives with respect to arc length. */
struct wb_rod_shape {
    double length, weight;                              /* m */
    double N[WB_ROD_SHAPE_POINTS][WB_ROD_SHAPE_NODES];  /* 1 */
    double dN[WB_ROD_SHAPE_POINTS][WB_ROD_SHAPE_NODES]; /* 1/m */
};

/* Sets the shape functions for elements of length h, m. */
static inline void wb_rod_shape_init(struct wb_rod_shape *shape, double h)
{
    shape->length = h;
    shape->weight = 0.5 * h;
    for (int g = 0; g < WB_ROD_SHAPE_POINTS; g++) {
        const double z = (g == 0 ? -1.0 : 1.0) / sqrt(3.0);
        shape->N[g][0] = 0.5 * z * (z - 1.0);
        shape->N[g][1] = 1.0 - z * z;
        shape->N[g][2] = 0.5 * z * (z + 1.0);
        shape->dN[g][0] = (2.0 * z - 1.0) / h;
        shape->dN[g][1] = -4.0 * z / h;
        shape->dN[g][2] = (2.0 * z + 1.0) / h;
    }
}

#endif
