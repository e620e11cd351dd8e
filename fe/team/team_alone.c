/* Ranks in a build without MPI: only one. */
#include "fe/team/team_ranks.h"

#define WB_LOG_DOMAIN "team"

enum wb_status wb_team_start(void)
{
    if (wb_team_started() > 1)
        return wb_fail(WB_ERR_UNSUPPORTED,
                       "mpirun started %d processes, but this program was built without MPI; build "
                       "with -Dmpi=enabled",
                       wb_team_started());
    return WB_OK;
}

void wb_team_end(void)
{
}

int wb_team_rank(void)
{
    return 0;
}

int wb_team_ranks(void)
{
    return 1;
}

void wb_team_sum(double *values, int n)
{
    (void)values, (void)n;
}

void wb_team_greatest(double *values, int n)
{
    (void)values, (void)n;
}

void wb_team_share(void *bytes, size_t size, int from)
{
    (void)bytes, (void)size, (void)from;
}

enum wb_status wb_team_agree(enum wb_status status)
{
    return status;
}

bool wb_team_can_thread(void)
{
    return true;
}

void wb_team_send(int rank, enum wb_team_side side, unsigned long round, const double *packet,
                  size_t size)
{
    (void)rank, (void)side, (void)round, (void)packet, (void)size;
}

void wb_team_receive(int rank, enum wb_team_side side, double *packet, size_t size)
{
    (void)rank, (void)side, (void)packet, (void)size;
}

void wb_team_flush(void)
{
}
