/* Functions of cli/talk.h for tests. */
#ifndef WB_CLI_TALK_PRIVATE_H
#define WB_CLI_TALK_PRIVATE_H

#include <stdint.h>

#include "cli/talk.h"

/* Texts dropped since wb_talk_open(). */
uint64_t wb_talk_lost(void);

#endif
