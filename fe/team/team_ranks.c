#include "fe/team/team_ranks.h"

#include <limits.h>
#include <stdlib.h>

int wb_team_started(void)
{
    /* Set by Open MPI, and by MPICH or Slurm, for the processes that they start. */
    static const char *const names[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"};

    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const char *text = getenv(names[i]);
        const long n = text ? strtol(text, NULL, 10) : 0;
        if (n > 0 && n < INT_MAX)
            return (int)n;
    }
    return 1;
}
