/* What tests of daq/test/bend_test.h ask beside it. */
#ifndef WB_DAQ_TEST_BEND_TEST_PRIVATE_H
#define WB_DAQ_TEST_BEND_TEST_PRIVATE_H

#include "daq/test/bend_test.h"

/* Speed of a cycle, from 1, of a request that passed wb_bend_test_check_request(), m/s. */
double wb_bend_test_speed(const struct wb_bend_test_request *request, const struct wb_rig *rig,
                          int cycle);

#endif
