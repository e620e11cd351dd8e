/* Members of one computation who work side by side in a row: each swaps a packet of numbers with
 * the one before and the one after in every round. Members are threads of this process, and of the
 * other ranks when the program was started by mpirun (fe/team/team_mpi.c); to members it is the
 * same.
 *
 * In a round a member fills its packets, posts them and awaits those of its neighbours: no more
 * than that makes them wait, and no one is ever more than a round ahead of its neighbour. Who waits
 * spins a little, then lets others have the processor: more members than cores are slow, not stuck.
 *
 * All members must go through the same rounds, also one that has failed.
 */
#ifndef WB_FE_TEAM_TEAM_H
#define WB_FE_TEAM_TEAM_H

#include <stddef.h>

#include "base/status.h"
#include "fe/team/team_ranks.h"

struct wb_team; /* opaque */

/* `n_threads` members in each rank, in the order of ranks, whose packets have `size` numbers. The
 * threads are made here and sleep between runs. */
WB_MUST_CHECK enum wb_status wb_team_create(struct wb_team **out, int n_threads, size_t size);
void wb_team_destroy(struct wb_team *team); /* accepts NULL */

/* The first member of this rank; then come n_threads - 1 more. */
int wb_team_first(const struct wb_team *team);

/* Calls work(context, member) for the members of this rank, each in its thread, the first in the
 * caller's; returns when all are done. */
void wb_team_run(struct wb_team *team, void (*work)(void *context, int member), void *context);

/* For members, within a run. The packet to a neighbour, to be filled before it is posted; NULL
 * where there is no neighbour. */
double *wb_team_packet(struct wb_team *team, int member, enum wb_team_side side);
/* Sends both. */
void wb_team_post(struct wb_team *team, int member);
/* The packet from a neighbour; it may be read until the next is posted. NULL where there is no
 * neighbour. A round ends when both were awaited. */
const double *wb_team_await(struct wb_team *team, int member, enum wb_team_side side);

#endif
