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

/* Shape functions at z from -1 to 1 in an element of length h, m. */
static inline void wb_rod_shape_at(double z, double h, double N[WB_ROD_SHAPE_NODES],
                                   double dN[WB_ROD_SHAPE_NODES])
{
    N[0] = 0.5 * z * (z - 1.0);
    N[1] = 1.0 - z * z;
    N[2] = 0.5 * z * (z + 1.0);
    dN[0] = (2.0 * z - 1.0) / h;
    dN[1] = -4.0 * z / h;
    dN[2] = (2.0 * z + 1.0) / h;
}

/* Sets the shape functions for elements of length h, m. */
static inline void wb_rod_shape_init(struct wb_rod_shape *shape, double h)
{
    shape->length = h;
    shape->weight = 0.5 * h;
    for (int g = 0; g < WB_ROD_SHAPE_POINTS; g++)
        wb_rod_shape_at((g == 0 ? -1.0 : 1.0) / sqrt(3.0), h, shape->N[g], shape->dN[g]);
}

#endif
