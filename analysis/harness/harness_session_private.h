/* Functions of analysis/harness/harness_session.c that only tests use. */
#ifndef WB_ANALYSIS_HARNESS_HARNESS_SESSION_PRIVATE_H
#define WB_ANALYSIS_HARNESS_HARNESS_SESSION_PRIVATE_H

#include "analysis/harness/harness_session.h"

/* Number of states of this size (bytes) that are kept for undo. */
int wb_harness_session_most_undo(size_t state_size);

#endif
