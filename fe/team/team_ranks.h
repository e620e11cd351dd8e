/* Ranks: this process among those that mpirun started, one if it started none.
 *
 * By MPI in fe/team/team_mpi.c; in a build without it fe/team/team_alone.c knows one rank only.
 */
#ifndef WB_FE_TEAM_TEAM_RANKS_H
#define WB_FE_TEAM_TEAM_RANKS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

/* The number of processes that mpirun says it started, 1 without it; known before any joins. */
int wb_team_started(void);

/* Joins the other ranks; alone, nothing happens. At the beginning of the program, before any
 * function below. WB_ERR_UNSUPPORTED when mpirun started several and the program was built without
 * MPI. */
WB_MUST_CHECK enum wb_status wb_team_start(void);
/* Leaves them; waits until all do. */
void wb_team_end(void);

int wb_team_rank(void);  /* from 0 */
int wb_team_ranks(void); /* 1 without mpirun */

/* --- called by all ranks, each by one thread and outside of wb_team_run() --- */

/* Sums are made in the order of the ranks and are the same on all. */
void wb_team_sum(double *values, int n);
void wb_team_greatest(double *values, int n);
/* `size` bytes of rank `from` to all. */
void wb_team_share(void *bytes, size_t size, int from);
/* The status of the first rank that did not succeed, else WB_OK. */
WB_MUST_CHECK enum wb_status wb_team_agree(enum wb_status status);

/* --- packets between neighbours, for the members of fe/team/team.h --- */

enum wb_team_side {
    WB_TEAM_BEFORE,
    WB_TEAM_AFTER
};

/* Whether several threads of a rank may send and receive. */
bool wb_team_can_thread(void);

/* Sends a packet to a rank. It must stay as it is until the next but one is sent to that side.
 * `round` counts them. */
void wb_team_send(int rank, enum wb_team_side side, unsigned long round, const double *packet,
                  size_t size);
/* Waits for the packet of a rank, which sent it to its own `side`. */
void wb_team_receive(int rank, enum wb_team_side side, double *packet, size_t size);
/* Waits until all that was sent has left. */
void wb_team_flush(void);

#endif
