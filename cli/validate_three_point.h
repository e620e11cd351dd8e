/* Output of `wirebench validate` for three-point bending tests. */
#ifndef WB_CLI_VALIDATE_THREE_POINT_H
#define WB_CLI_VALIDATE_THREE_POINT_H

#include "analysis/validation/validate_three_point.h"

void wb_validate_three_point_print(const struct wb_validate_three_point *result);

#endif
