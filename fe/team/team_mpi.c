/* Ranks over MPI. Without mpirun no MPI function is called, because MPI_Init takes long. */
#include <mpi.h>
#include <stdlib.h>

#include "base/memory.h"
#include "fe/team/team_ranks.h"

#define WB_LOG_DOMAIN "team"

enum {
    SLOTS = 2 /* packets in transit to one neighbour */
};

/* Static variables, because the state of MPI is also per process. */
static bool joined, threaded;
static int own_rank, n_ranks = 1;
static MPI_Request pending[2][SLOTS];

/* Runs at exit. If the program ends before wb_team_end(), for example after a failed allocation, it
 * aborts all ranks, because the others would wait for this one forever. */
static void abort_unless_ended(void)
{
    if (joined)
        MPI_Abort(MPI_COMM_WORLD, EXIT_FAILURE);
}

enum wb_status wb_team_start(void)
{
    int provided = MPI_THREAD_SINGLE;

    if (wb_team_started() < 2 || joined)
        return WB_OK;
    if (MPI_Init_thread(NULL, NULL, MPI_THREAD_MULTIPLE, &provided) != MPI_SUCCESS)
        return wb_fail(WB_ERR_IO, "MPI could not be started");
    MPI_Comm_rank(MPI_COMM_WORLD, &own_rank);
    MPI_Comm_size(MPI_COMM_WORLD, &n_ranks);
    for (int i = 0; i < 2 * SLOTS; i++)
        pending[i / SLOTS][i % SLOTS] = MPI_REQUEST_NULL;
    threaded = provided >= MPI_THREAD_MULTIPLE;
    joined = true;
    atexit(abort_unless_ended);
    return WB_OK;
}

void wb_team_end(void)
{
    if (!joined)
        return;
    MPI_Finalize();
    joined = false;
    own_rank = 0;
    n_ranks = 1;
}

int wb_team_rank(void)
{
    return own_rank;
}

int wb_team_ranks(void)
{
    return n_ranks;
}

/* Sums in the order of the ranks, so that the result does not depend on the MPI library. */
void wb_team_sum(double *values, int n)
{
    if (n_ranks == 1)
        return;
    double *const all = wb_memory_new((size_t)n * (size_t)n_ranks, sizeof *all);
    MPI_Allgather(values, n, MPI_DOUBLE, all, n, MPI_DOUBLE, MPI_COMM_WORLD);
    for (int i = 0; i < n; i++) {
        values[i] = all[i];
        for (int r = 1; r < n_ranks; r++)
            values[i] += all[r * n + i];
    }
    free(all);
}

void wb_team_greatest(double *values, int n)
{
    if (n_ranks > 1)
        MPI_Allreduce(MPI_IN_PLACE, values, n, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
}

void wb_team_share(void *bytes, size_t size, int from)
{
    enum {
        PIECE = 1 << 30
    };
    unsigned char *at = bytes;

    while (n_ranks > 1 && size > 0) {
        const int piece = size < PIECE ? (int)size : PIECE;
        MPI_Bcast(at, piece, MPI_BYTE, from, MPI_COMM_WORLD);
        at += piece;
        size -= (size_t)piece;
    }
}

enum wb_status wb_team_agree(enum wb_status status)
{
    enum {
        NO_FAILURE = 1 << 30
    };
    int first = status == WB_OK ? NO_FAILURE : own_rank, code = status;

    if (n_ranks == 1)
        return status;
    MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    if (first == NO_FAILURE)
        return WB_OK;
    MPI_Bcast(&code, 1, MPI_INT, first, MPI_COMM_WORLD);
    return (enum wb_status)code;
}

bool wb_team_can_thread(void)
{
    return !joined || threaded;
}

void wb_team_send(int rank, enum wb_team_side side, unsigned long round, const double *packet,
                  size_t size)
{
    MPI_Request *request = &pending[side][round % SLOTS];

    /* The neighbour received the previous packet of this slot before it sent the packet that this
     * rank awaited last. So this wait does not block; it completes the request. */
    MPI_Wait(request, MPI_STATUS_IGNORE);
    MPI_Isend(packet, (int)size, MPI_DOUBLE, rank, (int)side, MPI_COMM_WORLD, request);
}

void wb_team_receive(int rank, enum wb_team_side side, double *packet, size_t size)
{
    MPI_Recv(packet, (int)size, MPI_DOUBLE, rank, (int)side, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
}

void wb_team_flush(void)
{
    if (joined)
        MPI_Waitall(2 * SLOTS, &pending[0][0], MPI_STATUSES_IGNORE);
}
