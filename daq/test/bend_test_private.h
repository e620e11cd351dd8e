/* Functions of daq/test/bend_test.h that only tests call. */
#ifndef WB_DAQ_TEST_BEND_TEST_PRIVATE_H
#define WB_DAQ_TEST_BEND_TEST_PRIVATE_H

#include "daq/test/bend_test.h"

/* Speed of a cycle (counted from 1), m/s, for a request that passed wb_bend_test_check_request().
 */
double wb_bend_test_speed(const struct wb_bend_test_request *request, const struct wb_rig *rig,
                          int cycle);

#endif
