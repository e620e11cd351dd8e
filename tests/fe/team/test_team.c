/* Members in parallel: packets reach the right neighbour in the right round, with slow members,
 * with fewer cores than members, and over ranks (run it with mpirun). */
#include "tests/check.h"

#include <sched.h>
#include <stdbool.h>
#include <stdlib.h>
#include <time.h>

#include "fe/team/team.h"

enum {
    MOST = 32,
    SIZE = 37,
    ROUNDS = 3000
};

struct rounds {
    struct wb_team *team;
    int members, n;
    int slow; /* member that pauses in some rounds */
    int wrong[MOST];
};

static void fill(double *packet, int from, int to, int round)
{
    for (int i = 0; packet && i < SIZE; i++)
        packet[i] = 1e6 * from + 1e4 * to + round + i / 64.0;
}

static int is_wrong(const double *packet, int from, int to, int round, bool expected)
{
    if (!packet)
        return expected;
    for (int i = 0; i < SIZE; i++)
        if (packet[i] != 1e6 * from + 1e4 * to + round + i / 64.0)
            return 1;
    return !expected;
}

static void pause_in_some_rounds(int round)
{
    const struct timespec pause = {0, 20000};
    if (round % 7 == 0)
        nanosleep(&pause, NULL);
}

static void go_through_rounds(void *context, int member)
{
    struct rounds *r = context;
    int wrong = 0;
    for (int round = 0; round < r->n; round++) {
        if (member == r->slow)
            pause_in_some_rounds(round);
        fill(wb_team_packet(r->team, member, WB_TEAM_BEFORE), member, member - 1, round);
        fill(wb_team_packet(r->team, member, WB_TEAM_AFTER), member, member + 1, round);
        wb_team_post(r->team, member);
        wrong += is_wrong(wb_team_await(r->team, member, WB_TEAM_BEFORE), member - 1, member, round,
                          member > 0);
        wrong += is_wrong(wb_team_await(r->team, member, WB_TEAM_AFTER), member + 1, member, round,
                          member < r->members - 1);
    }
    r->wrong[member] += wrong;
}

static void swap_packets(int n_threads, int rounds, int slow)
{
    struct rounds r = {.members = n_threads * wb_team_ranks(), .n = rounds, .slow = slow};
    assert_int_equal(wb_team_create(&r.team, n_threads, SIZE), WB_OK);
    assert_true(r.members <= MOST);
    for (int run = 0; run < 3; run++)
        wb_team_run(r.team, go_through_rounds, &r);
    for (int i = 0; i < MOST; i++)
        assert_int_equal(r.wrong[i], 0);
    wb_team_destroy(r.team);
}

static void packets_reach_their_neighbours(void **unused)
{
    (void)unused;
    for (int n = 1; n <= 3; n++)
        for (int slow = -1; slow < n; slow++)
            swap_packets(n, slow < 0 ? ROUNDS : 300, slow);
}

/* All on one core, where pure spinning would take a time slice in every round. */
static void more_members_than_cores_do_not_block(void **unused)
{
    (void)unused;
    cpu_set_t before, one;
    struct timespec begin, end;
    assert_int_equal(sched_getaffinity(0, sizeof before, &before), 0);
    CPU_ZERO(&one);
    for (int i = 0; i < CPU_SETSIZE && CPU_COUNT(&one) == 0; i++)
        if (CPU_ISSET(i, &before))
            CPU_SET(i, &one);
    assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &begin);
    swap_packets(8, 500, -1);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
    assert_int_equal(sched_setaffinity(0, sizeof before, &before), 0);
    /* 1500 rounds of 8 members; with time slices of a millisecond these would take 12 s. */
    assert_true(end.tv_sec - begin.tv_sec < 5);
}

static void count_member(void *context, int member)
{
    ((int *)context)[member]++;
}

static void every_member_works_once_a_run(void **unused)
{
    (void)unused;
    struct wb_team *team;
    int count[MOST] = {0};
    assert_int_equal(wb_team_create(&team, 5, 0), WB_OK);
    for (int run = 0; run < 200; run++)
        wb_team_run(team, count_member, count);
    const int first = 5 * wb_team_rank();
    for (int i = 0; i < MOST; i++)
        assert_int_equal(count[i], i >= first && i < first + 5 ? 200 : 0);
    wb_team_destroy(team);
}

static void ranks_agree(void **unused)
{
    (void)unused;
    const int rank = wb_team_rank(), n = wb_team_ranks();
    double values[3] = {rank + 1.0, 0.1 * rank, 1.0};
    char text[8] = {0};
    wb_team_sum(values, 3);
    assert_close(values[0], 0.5 * n * (n + 1), 1e-15);
    assert_close(values[2], n, 0.0);
    values[0] = rank;
    wb_team_greatest(values, 1);
    assert_close(values[0], n - 1.0, 0.0);
    snprintf(text, sizeof text, "r%d", rank);
    wb_team_share(text, sizeof text, n - 1);
    assert_int_equal(atoi(text + 1), n - 1);
    assert_int_equal(wb_team_agree(WB_OK), WB_OK);
    assert_int_equal(wb_team_agree(rank == n - 1 ? WB_ERR_DATA : WB_OK), WB_ERR_DATA);
    assert_int_equal(wb_team_agree(rank == 0 ? WB_ERR_IO : WB_ERR_DATA), WB_ERR_IO);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(packets_reach_their_neighbours),
        cmocka_unit_test(more_members_than_cores_do_not_block),
        cmocka_unit_test(every_member_works_once_a_run),
        cmocka_unit_test(ranks_agree),
    };
    if (wb_team_start() != WB_OK)
        return 1;
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    wb_team_end();
    return failed;
}
