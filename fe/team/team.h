/* Members of one computation, in a row: in every round each exchanges a packet of numbers with the
 * member before it and the one after it. Members are threads of this process and, where mpirun
 * started the program, of the other ranks (fe/team/team_ranks.h); a member sees no difference.
 *
 * In a round a member fills its packets, posts them and awaits those of its neighbours. Nothing
 * else makes it wait, so that no member is ever more than one round ahead of a neighbour. A waiting
 * member spins for a while and then yields the processor: with more members than cores a
 * computation is slow, but it does not hang.
 *
 * All members must go through the same rounds, also one that has failed.
 */
#ifndef WB_FE_TEAM_TEAM_H
#define WB_FE_TEAM_TEAM_H

#include <stddef.h>

#include "base/status.h"
#include "fe/team/team_ranks.h"

struct wb_team; /* opaque */

/* `n_threads` members in each rank, in the order of ranks, whose packets have `size` numbers: those
 * of this rank begin with wb_team_rank() * n_threads. The threads are started here and sleep
 * between calls of wb_team_run(). */
WB_MUST_CHECK enum wb_status wb_team_create(struct wb_team **out, int n_threads, size_t size);
void wb_team_destroy(struct wb_team *team); /* accepts NULL */

/* Calls work(context, member) for the members of this rank, each in its thread, the first in the
 * caller's; returns when all are done. */
void wb_team_run(struct wb_team *team, void (*work)(void *context, int member), void *context);

/* For members, within wb_team_run(). The packet to a neighbour, to be filled before it is posted;
 * NULL where there is no neighbour. */
double *wb_team_packet(struct wb_team *team, int member, enum wb_team_side side);
/* Sends both. */
void wb_team_post(struct wb_team *team, int member);
/* The packet from a neighbour; it may be read until the next is posted. NULL where there is no
 * neighbour. A round ends when both were awaited. */
const double *wb_team_await(struct wb_team *team, int member, enum wb_team_side side);

#endif
