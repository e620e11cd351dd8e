/* What fe/team/team.c asks of the ranks: fe/team/team_mpi.c, or fe/team/team_alone.c in a build
 * without MPI. */
#ifndef WB_FE_TEAM_TEAM_PRIVATE_H
#define WB_FE_TEAM_TEAM_PRIVATE_H

#include <stdbool.h>
#include <stddef.h>

#include "fe/team/team.h"

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

/* The number of processes that mpirun says it started, 1 without it; known before any joins. */
int wb_team_started(void);

#endif
