#include "fe/team/team.h"

#include <limits.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/memory.h"

#define WB_LOG_DOMAIN "team"

enum {
    SLOTS = 2,    /* packets per side: one being read, one being filled */
    SPINS = 4000, /* polls before the thread yields the processor */
    MAX_THREADS = 1024,
    LINE = 64 /* bytes of a cache line */
};

static const size_t max_numbers = INT_MAX / 2;

struct member {
    _Alignas(LINE) atomic_ulong posted; /* rounds */
    _Alignas(LINE) unsigned long round;
    double *out[2][SLOTS], *in[2]; /* in: from another rank */
    pthread_t thread;
    struct wb_team *team;
    int index; /* among all */
};

struct wb_team {
    int n_threads, first, size;
    int spins;
    size_t packet_size;
    double *memory;
    struct member *member; /* (n_threads) */
    int n_started;         /* threads in addition to the caller's */

    pthread_mutex_t lock;
    pthread_cond_t begin, end;
    unsigned long run; /* runs begun */
    int working;       /* threads that have not finished */
    bool closing;
    void (*work)(void *context, int member);
    void *context;
};

/* --- threads --- */

static void *serve(void *context)
{
    struct member *member = context;
    struct wb_team *team = member->team;
    unsigned long done = 0;

    pthread_mutex_lock(&team->lock);
    for (;;) {
        while (team->run == done && !team->closing)
            pthread_cond_wait(&team->begin, &team->lock);
        if (team->closing)
            break;
        done = team->run;
        pthread_mutex_unlock(&team->lock);
        team->work(team->context, member->index);
        pthread_mutex_lock(&team->lock);
        if (--team->working == 0)
            pthread_cond_signal(&team->end);
    }
    pthread_mutex_unlock(&team->lock);
    return NULL;
}

void wb_team_run(struct wb_team *team, void (*work)(void *context, int member), void *context)
{
    pthread_mutex_lock(&team->lock);
    team->work = work;
    team->context = context;
    team->working = team->n_started;
    team->run++;
    pthread_cond_broadcast(&team->begin);
    pthread_mutex_unlock(&team->lock);

    work(context, team->first);

    pthread_mutex_lock(&team->lock);
    while (team->working > 0)
        pthread_cond_wait(&team->end, &team->lock);
    pthread_mutex_unlock(&team->lock);
}

/* Cores available to this process; with fewer cores than members, spinning would delay the others'
 * work. */
static int cores(void)
{
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0)
        return CPU_COUNT(&set);
    const long n = sysconf(_SC_NPROCESSORS_ONLN);
    return n > 0 && n < INT_MAX ? (int)n : 1;
}

static enum wb_status start_threads(struct wb_team *team)
{
    for (int i = 1; i < team->n_threads; i++) {
        if (pthread_create(&team->member[i].thread, NULL, serve, &team->member[i]) != 0)
            return wb_fail(WB_ERR_MEMORY, "%d threads cannot be started", team->n_threads);
        team->n_started++;
    }
    return WB_OK;
}

static void allocate(struct wb_team *team)
{
    enum {
        OF_A_MEMBER = 2 * SLOTS + 2
    };
    /* Round up to whole cache lines, so that packets of two members never share one. */
    const size_t room = (team->packet_size * sizeof(double) + LINE - 1) / LINE * LINE;
    const size_t n = (size_t)team->n_threads;

    team->member = wb_memory_need(aligned_alloc(LINE, n * sizeof *team->member));
    team->memory = wb_memory_need(aligned_alloc(LINE, n * OF_A_MEMBER * (room > 0 ? room : LINE)));
    double *at = team->memory;
    for (int i = 0; i < team->n_threads; i++) {
        struct member *m = &team->member[i];
        *m = (struct member){.team = team, .index = team->first + i};
        atomic_init(&m->posted, 0);
        for (int b = 0; b < OF_A_MEMBER; b++, at += room / sizeof *at)
            *(b < 2 * SLOTS ? &m->out[b / SLOTS][b % SLOTS] : &m->in[b - 2 * SLOTS]) = at;
    }
}

enum wb_status wb_team_create(struct wb_team **out, int n_threads, size_t size)
{
    *out = NULL;
    if (n_threads < 1 || n_threads > MAX_THREADS || size > max_numbers)
        return wb_fail(WB_ERR_ARGUMENT, "%d threads: expected 1 to %d", n_threads, MAX_THREADS);
    if (n_threads > 1 && wb_team_ranks() > 1 && !wb_team_can_thread())
        return wb_fail(
            WB_ERR_UNSUPPORTED,
            "this MPI does not support several sending threads per rank; use one thread and "
            "more ranks");
    struct wb_team *const team = wb_memory_new(1, sizeof *team);
    team->n_threads = n_threads;
    team->first = wb_team_rank() * n_threads;
    team->size = wb_team_ranks() * n_threads;
    team->packet_size = size;
    team->spins = n_threads <= cores() ? SPINS : 0;
    pthread_mutex_init(&team->lock, NULL);
    pthread_cond_init(&team->begin, NULL);
    pthread_cond_init(&team->end, NULL);
    allocate(team);
    const enum wb_status status = start_threads(team);
    if (status != WB_OK)
        wb_team_destroy(team);
    else
        *out = team;
    return status;
}

void wb_team_destroy(struct wb_team *team)
{
    if (!team)
        return;
    pthread_mutex_lock(&team->lock);
    team->closing = true;
    pthread_cond_broadcast(&team->begin);
    pthread_mutex_unlock(&team->lock);
    for (int i = 1; i <= team->n_started; i++)
        pthread_join(team->member[i].thread, NULL);
    wb_team_flush();
    pthread_cond_destroy(&team->begin);
    pthread_cond_destroy(&team->end);
    pthread_mutex_destroy(&team->lock);
    free(team->memory);
    free(team->member);
    free(team);
}

/* --- rounds --- */

static int neighbour_of(const struct wb_team *team, int member, enum wb_team_side side)
{
    const int other = side == WB_TEAM_BEFORE ? member - 1 : member + 1;
    return other < team->size ? other : -1;
}

static bool is_here(const struct wb_team *team, int member)
{
    return member >= team->first && member < team->first + team->n_threads;
}

double *wb_team_packet(struct wb_team *team, int member, enum wb_team_side side)
{
    const struct member *m = &team->member[member - team->first];
    return neighbour_of(team, member, side) < 0 ? NULL : m->out[side][m->round % SLOTS];
}

void wb_team_post(struct wb_team *team, int member)
{
    struct member *m = &team->member[member - team->first];

    for (int side = 0; side < 2; side++) {
        const int other = neighbour_of(team, member, (enum wb_team_side)side);
        if (other >= 0 && !is_here(team, other))
            wb_team_send(other / team->n_threads, (enum wb_team_side)side, m->round,
                         m->out[side][m->round % SLOTS], team->packet_size);
    }
    m->round++;
    atomic_store_explicit(&m->posted, m->round, memory_order_release);
}

static void rest(void)
{
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
}

static void wait_for(const struct wb_team *team, const struct member *other, unsigned long round)
{
    for (int i = 0; atomic_load_explicit(&other->posted, memory_order_acquire) < round; i++) {
        if (i < team->spins) {
            rest();
        } else {
            sched_yield();
            i = team->spins;
        }
    }
}

const double *wb_team_await(struct wb_team *team, int member, enum wb_team_side side)
{
    struct member *m = &team->member[member - team->first];
    const int other = neighbour_of(team, member, side);
    const enum wb_team_side opposite = side == WB_TEAM_BEFORE ? WB_TEAM_AFTER : WB_TEAM_BEFORE;

    if (other < 0)
        return NULL;
    if (!is_here(team, other)) {
        wb_team_receive(other / team->n_threads, opposite, m->in[side], team->packet_size);
        return m->in[side];
    }
    const struct member *from = &team->member[other - team->first];
    wait_for(team, from, m->round);
    return from->out[opposite][(m->round - 1) % SLOTS];
}
