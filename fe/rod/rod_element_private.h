/* Functions of fe/rod/rod_element.c that only tests use. */
#ifndef WB_FE_ROD_ROD_ELEMENT_PRIVATE_H
#define WB_FE_ROD_ROD_ELEMENT_PRIVATE_H

#include "fe/rod/rod_element.h"

/* Product c = a b of unit quaternions, and the quaternion of a rotation vector. */
void wb_rod_element_compose(const double a[4], const double b[4], double c[4]);
void wb_rod_element_exponential(const double vector[3], double q[4]);

#endif
