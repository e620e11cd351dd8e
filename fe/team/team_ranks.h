/* Ranks: the processes that mpirun started, or this process alone.
 *
 * fe/team/team_mpi.c implements them with MPI; a build without MPI uses fe/team/team_alone.c, which
 * has one rank.
 */
#ifndef WB_FE_TEAM_TEAM_RANKS_H
#define WB_FE_TEAM_TEAM_RANKS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

/* Number of processes started by mpirun, 1 without it; valid before wb_team_start(). */
int wb_team_started(void);

/* Joins the other ranks; no effect with one rank. Call at program start, before the functions
 * below. WB_ERR_UNSUPPORTED if mpirun started several processes and the program was built without
 * MPI. */
WB_MUST_CHECK enum wb_status wb_team_start(void);
/* Ends the team of ranks. All ranks must call it; it may wait for the others. */
void wb_team_end(void);

int wb_team_rank(void);  /* from 0 */
int wb_team_ranks(void); /* 1 without mpirun */

/* --- called by all ranks, each from one thread and outside of wb_team_run() --- */

/* Sums are made in the order of the ranks and are identical on all. */
void wb_team_sum(double *values, int n);
void wb_team_greatest(double *values, int n);
/* Copies `size` bytes from rank `from` to all ranks. */
void wb_team_share(void *bytes, size_t size, int from);
/* Returns the status of the first rank that failed, otherwise WB_OK. */
WB_MUST_CHECK enum wb_status wb_team_agree(enum wb_status status);

/* --- packets between neighbours, for the members of fe/team/team.h --- */

enum wb_team_side {
    WB_TEAM_BEFORE,
    WB_TEAM_AFTER
};

/* True if several threads of a rank may send and receive. */
bool wb_team_can_thread(void);

/* Sends a packet to a rank. The packet must stay unchanged until the second packet after it is sent
 * to the same side. `round` counts the packets. */
void wb_team_send(int rank, enum wb_team_side side, unsigned long round, const double *packet,
                  size_t size);
/* Waits for the packet that a rank sent to this one; `side` is the sender's. */
void wb_team_receive(int rank, enum wb_team_side side, double *packet, size_t size);
/* Waits until all sends are complete. */
void wb_team_flush(void);

#endif
