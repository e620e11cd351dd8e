/* Members of one computation, in a row: in every round each member exchanges a packet of numbers
 * with the member before it and the one after it. Members are threads of this process and, if
 * mpirun started the program, of the other ranks (fe/team/team_ranks.h); the interface is the same
 * for both.
 *
 * In a round a member fills its packets, posts them and awaits those of its neighbours. There is no
 * other synchronisation, so a member is never more than one round ahead of a neighbour. A waiting
 * member spins for a while and then yields the processor: with more members than cores a
 * computation is slow, but does not deadlock.
 *
 * All members must take part in all rounds, even after a failure.
 */
#ifndef WB_FE_TEAM_TEAM_H
#define WB_FE_TEAM_TEAM_H

#include <stddef.h>

#include "base/status.h"
#include "fe/team/team_ranks.h"

struct wb_team; /* opaque */

/* Creates a team with `n_threads` members in each rank, numbered in the order of ranks, with
 * packets of `size` numbers. Members of this rank begin with wb_team_rank() * n_threads. The
 * threads start here and sleep between calls of wb_team_run(). */
WB_MUST_CHECK enum wb_status wb_team_create(struct wb_team **out, int n_threads, size_t size);
void wb_team_destroy(struct wb_team *team); /* accepts NULL */

/* Calls work(context, member) for the members of this rank, each in its thread, the first in the
 * caller's; returns when all have returned. */
void wb_team_run(struct wb_team *team, void (*work)(void *context, int member), void *context);

/* For members, within wb_team_run(). The packet for a neighbour, to be filled before it is posted;
 * NULL without a neighbour. */
double *wb_team_packet(struct wb_team *team, int member, enum wb_team_side side);
/* Sends both. */
void wb_team_post(struct wb_team *team, int member);
/* Waits for the packet from a neighbour; it stays valid until the next packet is posted. NULL
 * without a neighbour. A round ends when both packets were awaited. */
const double *wb_team_await(struct wb_team *team, int member, enum wb_team_side side);

#endif
