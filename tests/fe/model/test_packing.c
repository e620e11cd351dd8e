/* Packings: lattices, the smallest enclosing circle, neighbours, and packings found by relaxation
 * against the densest ones known. */
#include "tests/messages.h"

#include <stdbool.h>
#include <stdlib.h>

#include "base/config.h"
#include "fe/model/packing.h"

static const double d = 1.4e-3;

/* --- helpers --- */

/* Packings of equal wires. */
static void fill(double diameter[WB_PACKING_MOST])
{
    for (int i = 0; i < WB_PACKING_MOST; i++)
        diameter[i] = d;
}

static struct wb_packing lattice_of(int n, enum wb_packing_lattice lattice)
{
    double diameter[WB_PACKING_MOST];
    struct wb_packing packing;
    fill(diameter);
    assert_int_equal(wb_packing_on_lattice(&packing, n, diameter, lattice), WB_OK);
    assert_int_equal(packing.n, n);
    return packing;
}

static struct wb_packing densest_of(int n, const double *diameter, unsigned int seed)
{
    struct wb_packing packing;
    const struct wb_packing_search search = {.seed = seed};
    assert_int_equal(wb_packing_densest(&packing, n, diameter, &search), WB_OK);
    assert_int_equal(packing.n, n);
    return packing;
}

static double enclosing_diameter(const struct wb_packing *packing)
{
    return 2.0 * wb_packing_enclosing(packing->n, packing->wire).radius;
}

static double distance(const struct wb_packing_circle *a, const struct wb_packing_circle *b)
{
    return hypot(a->y - b->y, a->z - b->z);
}

/* --- lattices --- */

static void hexagons_are_centred_and_touch(void **state)
{
    (void)state;
    static const int counts[] = {1, 7, 19, 37, 61, 91, 127};
    for (int rings = 0; rings < (int)WB_COUNT(counts); rings++) {
        const struct wb_packing packing = lattice_of(counts[rings], WB_PACKING_HEXAGON);
        assert_close(enclosing_diameter(&packing), (2 * rings + 1) * d, 1e-15);
        assert_true(packing.wire[0].y == 0.0 && packing.wire[0].z == 0.0);
        /* Wires within: 3 rings (3 rings + 1) edges of the triangular lattice. */
        const int touching = 3 * rings * (3 * rings + 1);
        assert_int_equal(wb_packing_pairs(&packing, 1e-12, 0, NULL), touching);
        if (rings > 0)
            assert_close(wb_packing_smallest_gap(&packing), 0.0, 1e-15);
    }
}

static void rings_go_counter_clockwise_from_the_right(void **state)
{
    (void)state;
    const struct wb_packing packing = lattice_of(19, WB_PACKING_HEXAGON);
    for (int i = 1; i < 19; i++) {
        const struct wb_packing_circle *const wire = &packing.wire[i];
        const int ring = i < 7 ? 1 : 2, step = i < 7 ? i - 1 : i - 7;
        double angle = atan2(wire->y, wire->z);
        if (angle < -1e-9)
            angle += 2.0 * M_PI;
        assert_close(angle, step * M_PI / 3.0 / ring, 1e-12);
    }
}

/* The squared distances of wires from a triangle's centre, times 3 over d squared, and how many
 * wires have them. */
static void triangles_fill_shell_by_shell(void **state)
{
    (void)state;
    static const int counts[] = {3, 6, 12, 18, 21, 27, 30, 36, 42};
    static const int squares[] = {1, 4, 7, 13, 16, 19, 25, 28, 31};
    int filled = 0;
    for (int k = 0; k < (int)WB_COUNT(counts); k++) {
        const struct wb_packing packing = lattice_of(counts[k], WB_PACKING_TRIANGLE);
        double y = 0.0, z = 0.0, last = -1e-9;
        for (int i = 0; i < packing.n; i++) {
            const struct wb_packing_circle *const wire = &packing.wire[i];
            const double turn = atan2(wire->y, wire->z);
            if (i >= filled) {
                assert_close(hypot(wire->y, wire->z), d * sqrt(squares[k] / 3.0), 1e-15);
                assert_true(fmod(turn + 2.0 * M_PI + 1e-9, 2.0 * M_PI) > last);
                last = fmod(turn + 2.0 * M_PI + 1e-9, 2.0 * M_PI);
            }
            y += wire->y;
            z += wire->z;
        }
        filled = counts[k];
        assert_close(y, 0.0, 1e-15);
        assert_close(z, 0.0, 1e-15);
        assert_close(wb_packing_smallest_gap(&packing), 0.0, 1e-15);
        assert_close(enclosing_diameter(&packing), d * (1.0 + 2.0 * sqrt(squares[k] / 3.0)), 1e-15);
    }
}

/* What the paper's notes say of the patches. */
static void patches_have_the_circles_of_the_paper(void **state)
{
    (void)state;
    struct wb_packing packing = lattice_of(12, WB_PACKING_TRIANGLE);
    assert_close(enclosing_diameter(&packing) + 0.4e-3, 6.08e-3, 0.005e-3);
    packing = lattice_of(27, WB_PACKING_TRIANGLE);
    assert_close(enclosing_diameter(&packing) + 0.4e-3, 8.85e-3, 0.005e-3);
    packing = lattice_of(7, WB_PACKING_HEXAGON);
    assert_close(enclosing_diameter(&packing) + 0.4e-3, 4.6e-3, 1e-15);
    packing = lattice_of(19, WB_PACKING_HEXAGON);
    assert_close(enclosing_diameter(&packing) + 0.4e-3, 7.4e-3, 1e-15);
}

/* A patch looks the same after a third of a turn, and in a mirror across the plane of bending. */
static void triangles_are_symmetric(void **state)
{
    (void)state;
    const struct wb_packing packing = lattice_of(27, WB_PACKING_TRIANGLE);
    const double c = -0.5, s = sqrt(0.75);
    for (int i = 0; i < packing.n; i++) {
        const struct wb_packing_circle *const wire = &packing.wire[i];
        const struct wb_packing_circle turned = {s * wire->z + c * wire->y,
                                                 c * wire->z - s * wire->y, 0.0};
        const struct wb_packing_circle mirrored = {wire->y, -wire->z, 0.0};
        double nearest_turned = 1.0, nearest_mirrored = 1.0;
        for (int k = 0; k < packing.n; k++) {
            nearest_turned = fmin(nearest_turned, distance(&turned, &packing.wire[k]));
            nearest_mirrored = fmin(nearest_mirrored, distance(&mirrored, &packing.wire[k]));
        }
        assert_close(nearest_turned, 0.0, 1e-15);
        assert_close(nearest_mirrored, 0.0, 1e-15);
    }
}

static void the_thickest_wire_sets_the_pitch(void **state)
{
    (void)state;
    const double diameter[] = {d, 0.5 * d, 0.8 * d, d, 0.5 * d, 0.5 * d, 0.5 * d};
    struct wb_packing packing;
    assert_int_equal(wb_packing_on_lattice(&packing, 7, diameter, WB_PACKING_HEXAGON), WB_OK);
    for (int i = 0; i < 7; i++) {
        assert_close(packing.wire[i].radius, 0.5 * diameter[i], 0.0);
        assert_close(hypot(packing.wire[i].y, packing.wire[i].z), i == 0 ? 0.0 : d, 1e-15);
    }
}

static void refuse(int n, const double *diameter, enum wb_packing_lattice lattice, const char *part)
{
    struct wb_packing packing;
    keep_messages();
    kept.last[0] = '\0';
    const enum wb_status status = wb_packing_on_lattice(&packing, n, diameter, lattice);
    wb_log_set_sink(NULL, NULL);
    assert_int_equal(status, WB_ERR_ARGUMENT);
    assert_message(part);
}

static void what_is_no_whole_patch_is_refused(void **state)
{
    (void)state;
    double diameter[WB_PACKING_MOST + 1];
    fill(diameter);
    refuse(8, diameter, WB_PACKING_HEXAGON, "7 or 19");
    refuse(128, diameter, WB_PACKING_HEXAGON, "127 or 169");
    refuse(13, diameter, WB_PACKING_TRIANGLE, "12 or 18");
    refuse(1, diameter, WB_PACKING_TRIANGLE, "3");
    refuse(0, diameter, WB_PACKING_HEXAGON, "0 wires");
    refuse(WB_PACKING_MOST + 1, diameter, WB_PACKING_HEXAGON, "129 wires");
    diameter[3] = -d;
    refuse(7, diameter, WB_PACKING_HEXAGON, "diameter");
    diameter[3] = (double)NAN;
    refuse(7, diameter, WB_PACKING_HEXAGON, "diameter");
}

/* --- enclosing circle --- */

static double uniform(unsigned int *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (*state >> 8) * 0x1p-24;
}

/* A circle is the smallest when all others lie in it and those that touch it hold it: no half turn
 * is free of them. */
static void check_smallest(int n, const struct wb_packing_circle *circles)
{
    const struct wb_packing_circle e = wb_packing_enclosing(n, circles);
    double touching[64];
    int held = 0;
    for (int i = 0; i < n; i++) {
        const double room = e.radius - circles[i].radius - distance(&e, &circles[i]);
        assert_true(room >= -1e-12 * e.radius);
        if (room < 1e-9 * e.radius && held < 64)
            touching[held++] = atan2(circles[i].y - e.y, circles[i].z - e.z);
    }
    if (held == 1) { /* one circle holds all the others */
        double largest = 0.0;
        for (int i = 0; i < n; i++)
            largest = fmax(largest, circles[i].radius);
        assert_close(e.radius, largest, 1e-12 * largest);
        return;
    }
    assert_true(held >= 2);
    double widest = 0.0;
    for (int i = 0; i < held; i++) {
        double next = 2.0 * M_PI;
        for (int k = 0; k < held; k++) {
            const double turn = fmod(touching[k] - touching[i] + 4.0 * M_PI, 2.0 * M_PI);
            if (turn > 1e-9)
                next = fmin(next, turn);
        }
        widest = fmax(widest, next);
    }
    assert_true(widest <= M_PI + 1e-6);
}

static void enclosing_circle_is_the_smallest(void **state)
{
    (void)state;
    unsigned int random = 1;
    for (int round = 0; round < 2000; round++) {
        struct wb_packing_circle circles[40];
        const int n = 1 + (int)(40.0 * uniform(&random));
        const double spread = round % 2 ? 1.0 : 0.05;
        for (int i = 0; i < n; i++)
            circles[i] = (struct wb_packing_circle){10.0 + uniform(&random), uniform(&random),
                                                    spread * (0.01 + uniform(&random))};
        check_smallest(n, circles);
    }
}

static void enclosing_circles_known_in_closed_form(void **state)
{
    (void)state;
    const struct wb_packing_circle one = {3.0, 4.0, 2.0};
    struct wb_packing_circle e = wb_packing_enclosing(1, &one);
    assert_true(e.y == 3.0 && e.z == 4.0 && e.radius == 2.0);

    const struct wb_packing_circle two[] = {{0.0, 0.0, 1.0}, {0.0, 5.0, 2.0}};
    e = wb_packing_enclosing(2, two);
    assert_close(e.radius, 4.0, 1e-15);
    assert_close(e.z, 3.0, 1e-15);

    /* Soddy's outer circle of three that touch: its curvature by Descartes' theorem. */
    const double r[] = {3.0, 3.0, 2.2}, k = 1.0 / 3.0, m = 1.0 / 2.2;
    const double height = sqrt(5.2 * 5.2 - 9.0);
    const struct wb_packing_circle three[] = {
        {0.0, -3.0, r[0]}, {0.0, 3.0, r[1]}, {height, 0.0, r[2]}};
    e = wb_packing_enclosing(3, three);
    assert_close(e.radius, -1.0 / (2.0 * k + m - 2.0 * sqrt(k * k + 2.0 * k * m)), 1e-14);
    assert_close(e.z, 0.0, 1e-14);

    /* Many that all touch it, and doubles. */
    struct wb_packing_circle crown[60];
    for (int i = 0; i < 60; i++) {
        const double radius = 0.1 + 0.01 * (i % 7), angle = 2.0 * M_PI * (i % 30) / 30.0;
        crown[i] = (struct wb_packing_circle){1.0 + (1.0 - radius) * sin(angle),
                                              (1.0 - radius) * cos(angle), radius};
    }
    e = wb_packing_enclosing(60, crown);
    assert_close(e.radius, 1.0, 1e-12);
    assert_close(e.y, 1.0, 1e-12);
    assert_close(e.z, 0.0, 1e-12);
}

/* --- neighbours --- */

static void neighbours_have_gap_and_direction(void **state)
{
    (void)state;
    double diameter[] = {d, d, 0.9 * d, d, d, d, d};
    struct wb_packing packing;
    struct wb_packing_pair pairs[64];
    assert_int_equal(wb_packing_on_lattice(&packing, 7, diameter, WB_PACKING_HEXAGON), WB_OK);
    assert_int_equal(wb_packing_pairs(&packing, 0.01 * d, 64, pairs), 9);
    assert_int_equal(wb_packing_pairs(&packing, 0.1 * d, 64, pairs), 12);
    for (int i = 0; i < 12; i++) {
        const struct wb_packing_pair *const pair = &pairs[i];
        assert_true(pair->a < pair->b);
        assert_close(pair->gap, pair->a == 2 || pair->b == 2 ? 0.05 * d : 0.0, 1e-15);
        if (pair->a == 0)
            assert_close(fmod(pair->direction + 2.0 * M_PI, 2.0 * M_PI), (pair->b - 1) * M_PI / 3.0,
                         1e-12);
    }
    /* Only the first fit, but all are counted. */
    assert_int_equal(wb_packing_pairs(&packing, 0.1 * d, 3, pairs), 12);
}

static void no_pair_reaches_across_a_wire(void **state)
{
    (void)state;
    const struct wb_packing packing = lattice_of(7, WB_PACKING_HEXAGON);
    assert_int_equal(wb_packing_pairs(&packing, 10.0 * d, 0, NULL), 12);
    const struct wb_packing three = {
        .n = 3, .wire = {{0.0, -d, 0.5 * d}, {0.0, d, 0.5 * d}, {0.2 * d, 0.0, 0.1 * d}}};
    assert_int_equal(wb_packing_pairs(&three, 10.0 * d, 0, NULL), 3);
}

/* --- relaxation --- */

/* The densest packings of equal circles in a circle (proven to 13 and 19; Graham et al. 1998 for
 * the others), R over r. */
static void equal_wires_reach_the_densest_known(void **state)
{
    (void)state;
    static const double known[] = {
        [2] = 2.0,
        [3] = 2.154700538379,
        [4] = 2.414213562373,
        [5] = 2.701301616704,
        [6] = 3.0,
        [7] = 3.0,
        [8] = 3.304764870962,
        [9] = 3.613125929752,
        [10] = 3.813025631,
        [11] = 3.923804400163,
        [12] = 4.029601930,
        [13] = 4.236067977500,
        [14] = 4.328428555,
        [15] = 4.521356631,
        [16] = 4.615425595,
        [17] = 4.792033748,
        [18] = 4.863703305156,
        [19] = 4.863703305156,
    };
    double diameter[WB_PACKING_MOST];
    fill(diameter);
    for (int n = 2; n <= 19; n++) {
        const struct wb_packing packing = densest_of(n, diameter, 1);
        assert_close_relative(enclosing_diameter(&packing) / d, known[n], 1e-7);
        assert_true(wb_packing_smallest_gap(&packing) >= -1e-15);
    }
}

/* Closed forms of some of those numbers, so that no table is trusted alone. */
static void densest_packings_in_closed_form(void **state)
{
    (void)state;
    const struct {
        int n;
        double ratio;
    } known[] = {
        {3, 1.0 + 2.0 / sqrt(3.0)},        {5, 1.0 + sqrt(2.0 * (1.0 + 1.0 / sqrt(5.0)))},
        {8, 1.0 + 1.0 / sin(M_PI / 7.0)},  {9, 1.0 + sqrt(2.0 * (2.0 + sqrt(2.0)))},
        {11, 1.0 + 1.0 / sin(M_PI / 9.0)}, {13, 2.0 + sqrt(5.0)},
        {19, 1.0 + sqrt(2.0) + sqrt(6.0)},
    };
    double diameter[WB_PACKING_MOST];
    fill(diameter);
    for (size_t i = 0; i < WB_COUNT(known); i++) {
        const struct wb_packing packing = densest_of(known[i].n, diameter, 7);
        assert_close_relative(enclosing_diameter(&packing) / d, known[i].ratio, 1e-10);
    }
}

/* How many wires, and the enclosing circle, wire i touches. */
static int contacts_of(const struct wb_packing *packing, int i)
{
    const struct wb_packing_circle *const wire = &packing->wire[i];
    const double room = 0.5 * enclosing_diameter(packing) - wire->radius - hypot(wire->y, wire->z);
    int n = room < 1e-9 * d;
    for (int k = 0; k < packing->n; k++)
        n += k != i &&
             distance(wire, &packing->wire[k]) < wire->radius + packing->wire[k].radius + 1e-9 * d;
    return n;
}

static void mixed_wires_touch_and_do_not_overlap(void **state)
{
    (void)state;
    double diameter[19];
    for (int i = 0; i < 19; i++)
        diameter[i] = i < 10 ? 1.4e-3 : 1.25e-3;
    const struct wb_packing packing = densest_of(19, diameter, 1);
    const double circle = enclosing_diameter(&packing);
    assert_true(wb_packing_smallest_gap(&packing) >= -1e-15);
    for (int i = 0; i < 19; i++)
        assert_close(packing.wire[i].radius, 0.5 * diameter[i], 0.0);
    /* At least as dense as the same wires at a pitch of the thicker ones, and not denser than
     * wires can be. */
    double area = 0.0;
    for (int i = 0; i < 19; i++)
        area += diameter[i] * diameter[i];
    assert_true(circle < 6.6e-3 && area / (circle * circle) < M_PI / sqrt(12.0));
    for (int i = 0; i < 19; i++)
        assert_true(contacts_of(&packing, i) >= 2);
}

static void the_same_seed_gives_the_same_packing(void **state)
{
    (void)state;
    double diameter[8] = {1.4e-3, 1.4e-3, 1.1e-3, 1.25e-3, 1.25e-3, 1.1e-3, 1.4e-3, 1.1e-3};
    const struct wb_packing a = densest_of(8, diameter, 3), b = densest_of(8, diameter, 3);
    const struct wb_packing c = densest_of(8, diameter, 4);
    assert_memory_equal(a.wire, b.wire, 8 * sizeof a.wire[0]);
    assert_true(memcmp(a.wire, c.wire, 8 * sizeof a.wire[0]) != 0);
    assert_close(enclosing_diameter(&a), enclosing_diameter(&c), 1e-9);
}

static void a_thin_wire_lies_loose_between_two_thick_ones(void **state)
{
    (void)state;
    const double diameter[] = {2.0 * d, 2.0 * d, 0.5 * d};
    const struct wb_packing packing = densest_of(3, diameter, 1);
    assert_close_relative(enclosing_diameter(&packing), 4.0 * d, 1e-10);
}

/* On the lattice of the thick ones the thin wires have gaps all round. Three chains of thick ones
 * from the centre outwards hold the circle, but only as long as they are straight. */
static void thin_wires_on_a_lattice_settle(void **state)
{
    (void)state;
    double diameter[19];
    struct wb_packing packing;
    for (int i = 0; i < 19; i++)
        diameter[i] = i == 0 || i % 2 == 1 ? 1.4e-3 : 1.25e-3;
    assert_int_equal(wb_packing_on_lattice(&packing, 19, diameter, WB_PACKING_HEXAGON), WB_OK);
    assert_int_equal(contacts_of(&packing, 8), 0);
    assert_int_equal(wb_packing_settle(&packing), WB_OK);
    assert_true(enclosing_diameter(&packing) < 6.6e-3);
    assert_true(wb_packing_smallest_gap(&packing) >= -1e-15);
    for (int i = 0; i < 19; i++)
        assert_true(contacts_of(&packing, i) >= 2);
}

static void disturbed_wires_settle_back(void **state)
{
    (void)state;
    unsigned int random = 5;
    struct wb_packing packing = lattice_of(7, WB_PACKING_HEXAGON);
    for (int i = 0; i < 7; i++) {
        packing.wire[i].y += d * (2.0 + 0.3 * (uniform(&random) - 0.5));
        packing.wire[i].z += d * 0.3 * (uniform(&random) - 0.5);
    }
    assert_int_equal(wb_packing_settle(&packing), WB_OK);
    assert_close_relative(enclosing_diameter(&packing), 3.0 * d, 1e-10);
    assert_true(wb_packing_smallest_gap(&packing) >= -1e-15);
    const struct wb_packing_circle e = wb_packing_enclosing(7, packing.wire);
    assert_close(e.y, 0.0, 1e-15);
    assert_close(e.z, 0.0, 1e-15);
    assert_int_equal(wb_packing_pairs(&packing, 1e-9 * d, 0, NULL), 12);
}

/* The patch of 12 is not the densest packing of 12, but no small motion leads there. */
static void a_patch_of_twelve_stays(void **state)
{
    (void)state;
    const struct wb_packing before = lattice_of(12, WB_PACKING_TRIANGLE);
    struct wb_packing packing = before;
    assert_int_equal(wb_packing_settle(&packing), WB_OK);
    for (int i = 0; i < 12; i++)
        assert_close(hypot(packing.wire[i].y, packing.wire[i].z),
                     hypot(before.wire[i].y, before.wire[i].z), 1e-12 * d);
    assert_true(enclosing_diameter(&packing) / d > 4.02960193);
}

static void one_wire_settles_at_the_origin(void **state)
{
    (void)state;
    struct wb_packing packing = {.n = 1, .wire = {{3.0, 4.0, 0.5 * d}}};
    assert_int_equal(wb_packing_settle(&packing), WB_OK);
    assert_close(packing.wire[0].y, 0.0, 1e-15);
    assert_close(packing.wire[0].z, 0.0, 1e-15);
    assert_true(wb_packing_smallest_gap(&packing) == (double)INFINITY);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hexagons_are_centred_and_touch),
        cmocka_unit_test(rings_go_counter_clockwise_from_the_right),
        cmocka_unit_test(triangles_fill_shell_by_shell),
        cmocka_unit_test(patches_have_the_circles_of_the_paper),
        cmocka_unit_test(triangles_are_symmetric),
        cmocka_unit_test(the_thickest_wire_sets_the_pitch),
        cmocka_unit_test(what_is_no_whole_patch_is_refused),
        cmocka_unit_test(enclosing_circle_is_the_smallest),
        cmocka_unit_test(enclosing_circles_known_in_closed_form),
        cmocka_unit_test(neighbours_have_gap_and_direction),
        cmocka_unit_test(no_pair_reaches_across_a_wire),
        cmocka_unit_test(equal_wires_reach_the_densest_known),
        cmocka_unit_test(densest_packings_in_closed_form),
        cmocka_unit_test(mixed_wires_touch_and_do_not_overlap),
        cmocka_unit_test(the_same_seed_gives_the_same_packing),
        cmocka_unit_test(a_thin_wire_lies_loose_between_two_thick_ones),
        cmocka_unit_test(thin_wires_on_a_lattice_settle),
        cmocka_unit_test(disturbed_wires_settle_back),
        cmocka_unit_test(a_patch_of_twelve_stays),
        cmocka_unit_test(one_wire_settles_at_the_origin),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
