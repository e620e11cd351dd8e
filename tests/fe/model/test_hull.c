/* The outline of bundles: closed forms of lattices and of two wires, and any circles against the
 * integral of their support and the polygon of the outline's own points. */
#include "tests/check.h"

#include "fe/model/hull.h"

static const double d = 1.4e-3;
static struct wb_hull hull;

static void find_lattice(int n, enum wb_packing_lattice lattice)
{
    double diameter[WB_PACKING_MOST];
    struct wb_packing packing;
    for (int i = 0; i < n; i++)
        diameter[i] = d;
    assert_int_equal(wb_packing_on_lattice(&packing, n, diameter, lattice), WB_OK);
    assert_int_equal(wb_hull_find(&hull, &packing, 1e-9), WB_OK);
}

/* Each arc begins where the one before ended, once round. */
static void check_turn(void)
{
    assert_true(hull.arc[0].from >= -M_PI && hull.arc[0].from <= M_PI);
    for (int k = 0; k < hull.n_arcs; k++) {
        assert_true(hull.arc[k].to >= hull.arc[k].from);
        assert_true(hull.arc[k].straight >= 0.0);
        if (k > 0)
            assert_true(hull.arc[k].from == hull.arc[k - 1].to);
    }
    assert_close(hull.arc[hull.n_arcs - 1].to, hull.arc[0].from + 2.0 * M_PI, 1e-12);
}

/* What the outline encloses, m2. */
static double area_of(const struct wb_hull *of, double offset)
{
    double sum = 0.0;
    for (int k = 0; k < of->n_arcs; k++) {
        const struct wb_hull_arc *const arc = &of->arc[k];
        const struct wb_packing_circle *const wire = &of->packing.wire[arc->wire];
        const double R = wire->radius + offset;
        sum += R * (wire->z * (sin(arc->to) - sin(arc->from)) -
                    wire->y * (cos(arc->to) - cos(arc->from)) + R * (arc->to - arc->from));
        sum += (wire->z * cos(arc->to) + wire->y * sin(arc->to) + R) * arc->straight;
    }
    return 0.5 * sum;
}

static void seven_wires_touch_over_sixty_degrees(void **state)
{
    (void)state;
    bool touches;
    find_lattice(7, WB_PACKING_HEXAGON);
    check_turn();
    assert_int_equal(hull.n_arcs, 6);
    assert_close(wb_hull_length(&hull, 0.0), (6.0 + M_PI) * d, 1e-15);
    assert_close(area_of(&hull, 0.0), (1.5 * sqrt(3.0) + 3.0 + M_PI / 4.0) * d * d, 1e-18);
    assert_close(wb_hull_contact(&hull, 0, &touches), 0.0, 0.0);
    assert_false(touches);
    for (int i = 1; i < 7; i++) {
        assert_close(wb_hull_contact(&hull, i, &touches), M_PI / 3.0, 1e-12);
        assert_true(touches);
    }
}

/* Corners over 60 degrees, those on the sides in a line only. */
static void nineteen_wires_touch_with_twelve(void **state)
{
    (void)state;
    bool touches;
    find_lattice(19, WB_PACKING_HEXAGON);
    check_turn();
    assert_int_equal(hull.n_arcs, 12);
    assert_close(wb_hull_length(&hull, 0.0), (12.0 + M_PI) * d, 1e-15);
    for (int i = 0; i < 19; i++) {
        const bool is_outer = i >= 7, is_corner = is_outer && i % 2 == 1;
        assert_close(wb_hull_contact(&hull, i, &touches), is_corner ? M_PI / 3.0 : 0.0, 1e-12);
        assert_true(touches == is_outer);
    }
    for (int k = 0; k < 12; k++)
        assert_close(hull.arc[k].straight, d, 1e-15);
}

/* Hexagons with sides of two lengths in turn: of n and n + 1 wires. */
static void triangle_patches_are_hexagons_of_two_sides(void **state)
{
    (void)state;
    static const struct {
        int n, sides;
    } patches[] = {{3, 3}, {6, 6}, {12, 9}, {27, 15}};
    for (int i = 0; i < 4; i++) {
        find_lattice(patches[i].n, WB_PACKING_TRIANGLE);
        check_turn();
        assert_close(wb_hull_length(&hull, 0.0), (patches[i].sides + M_PI) * d, 1e-15);
        int on_straight = 0;
        for (int k = 0; k < hull.n_arcs; k++)
            on_straight += hull.arc[k].to - hull.arc[k].from < 1e-9;
        assert_int_equal(hull.n_arcs, patches[i].sides);
        assert_int_equal(on_straight, patches[i].sides - (patches[i].n <= 6 ? 3 : 6));
    }
}

static void one_wire_is_its_own_outline(void **state)
{
    (void)state;
    const struct wb_packing packing = {.n = 1, .wire = {{3.0 * d, 2.0 * d, 0.5 * d}}};
    assert_int_equal(wb_hull_find(&hull, &packing, 1e-9), WB_OK);
    check_turn();
    assert_int_equal(hull.n_arcs, 1);
    assert_close(wb_hull_length(&hull, 0.0), M_PI * d, 1e-15);
    assert_close(area_of(&hull, 0.0), M_PI * d * d / 4.0, 1e-18);
}

/* An open belt round two pulleys. */
static void two_wires_are_a_belt(void **state)
{
    (void)state;
    bool touches;
    const double r = 1.0, s = 0.4, apart = 1.9;
    for (int turn = 0; turn < 12; turn++) {
        const double angle = turn * M_PI / 6.0;
        const struct wb_packing packing = {
            .n = 2,
            .wire = {{1.0, 2.0, r}, {1.0 + apart * sin(angle), 2.0 + apart * cos(angle), s}}};
        assert_int_equal(wb_hull_find(&hull, &packing, 1e-9), WB_OK);
        check_turn();
        const double lean = asin((r - s) / apart);
        assert_close(wb_hull_length(&hull, 0.0),
                     2.0 * apart * cos(lean) + r * (M_PI + 2.0 * lean) + s * (M_PI - 2.0 * lean),
                     1e-12);
        assert_close(wb_hull_contact(&hull, 0, &touches), M_PI + 2.0 * lean, 1e-12);
    }
}

static void a_circle_within_another_does_not_matter(void **state)
{
    (void)state;
    bool touches;
    const struct wb_packing packing = {.n = 3,
                                       .wire = {{0.0, 0.0, 1.0}, {0.2, 0.1, 0.3}, {0.0, 3.0, 1.0}}};
    assert_int_equal(wb_hull_find(&hull, &packing, 1e-9), WB_OK);
    assert_close(wb_hull_length(&hull, 0.0), 6.0 + 2.0 * M_PI, 1e-12);
    wb_hull_contact(&hull, 1, &touches);
    assert_false(touches);
}

/* Thin wires round a thick one: it shows between them. */
static void a_thick_wire_has_several_arcs(void **state)
{
    (void)state;
    bool touches;
    struct wb_packing packing = {.n = 4, .wire = {{0.0, 0.0, 1.0}}};
    for (int i = 0; i < 3; i++) {
        const double angle = 0.3 + 2.0 * M_PI * i / 3.0;
        packing.wire[i + 1] = (struct wb_packing_circle){1.1 * sin(angle), 1.1 * cos(angle), 0.1};
    }
    assert_int_equal(wb_hull_find(&hull, &packing, 1e-9), WB_OK);
    check_turn();
    assert_int_equal(hull.n_arcs, 6);
    const double lean = acos(0.9 / 1.1);
    assert_close(wb_hull_contact(&hull, 0, &touches), 2.0 * M_PI - 6.0 * lean, 1e-12);
    assert_close(wb_hull_contact(&hull, 2, &touches), 2.0 * lean, 1e-12);
}

/* --- any circles --- */

static double uniform(unsigned int *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (*state >> 8) * 0x1p-24;
}

static double support(const struct wb_packing *packing, double normal)
{
    double most = -(double)INFINITY;
    for (int i = 0; i < packing->n; i++)
        most = fmax(most, packing->wire[i].z * cos(normal) + packing->wire[i].y * sin(normal) +
                              packing->wire[i].radius);
    return most;
}

/* Cauchy: the length is the integral of the support over all directions. */
static double cauchy_length(const struct wb_packing *packing)
{
    const int n = 20000;
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += support(packing, 2.0 * M_PI * i / n);
    return sum * 2.0 * M_PI / n;
}

static void check_points(const struct wb_packing *packing, double offset)
{
    const int n = 4000;
    const double length = wb_hull_length(&hull, offset);
    struct wb_hull_point before = wb_hull_at(&hull, offset, 0.0);
    const struct wb_hull_moments moments = wb_hull_moments(&hull, offset);
    double area = 0.0, walked = 0.0, y = 0.0, z = 0.0, yy = 0.0, zz = 0.0;
    assert_close_relative(moments.length, length, 1e-12);
    for (int i = 1; i <= n; i++) {
        const struct wb_hull_point at = wb_hull_at(&hull, offset, length * i / n);
        area += 0.5 * (before.z * at.y - at.z * before.y);
        walked += hypot(at.y - before.y, at.z - before.z);
        if (i < n)
            assert_true(at.normal >= before.normal - 1e-12);
        /* On the support line of its normal, so that nothing stands out. */
        assert_close(at.z * cos(at.normal) + at.y * sin(at.normal),
                     support(packing, at.normal) + offset, 1e-9);
        if (at.wire >= 0)
            assert_close(hypot(at.y - packing->wire[at.wire].y, at.z - packing->wire[at.wire].z),
                         packing->wire[at.wire].radius + offset, 1e-12);
        const struct wb_hull_point middle = wb_hull_at(&hull, offset, length * (i - 0.5) / n);
        y += middle.y * length / n;
        z += middle.z * length / n;
        yy += middle.y * middle.y * length / n;
        zz += middle.z * middle.z * length / n;
        before = at;
    }
    assert_close_relative(moments.y, y, 1e-5);
    assert_close_relative(moments.z, z, 1e-5);
    assert_close_relative(moments.yy, yy, 1e-5);
    assert_close_relative(moments.zz, zz, 1e-5);
    assert_close_relative(walked, length, 1e-5);
    assert_close_relative(area, area_of(&hull, offset), 1e-5);
}

static void outlines_of_any_circles(void **state)
{
    (void)state;
    unsigned int random = 3;
    for (int round = 0; round < 40; round++) {
        struct wb_packing packing = {.n = 1 + (int)(30.0 * uniform(&random))};
        for (int i = 0; i < packing.n; i++)
            packing.wire[i] =
                (struct wb_packing_circle){uniform(&random), uniform(&random),
                                           0.02 + 0.3 * uniform(&random) * uniform(&random)};
        assert_int_equal(wb_hull_find(&hull, &packing, 1e-12), WB_OK);
        check_turn();
        assert_close_relative(wb_hull_length(&hull, 0.0), cauchy_length(&packing), 1e-5);
        check_points(&packing, 0.0);
        check_points(&packing, 0.1);
    }
}

static void an_outline_farther_out_is_longer_by_its_turn(void **state)
{
    (void)state;
    find_lattice(12, WB_PACKING_TRIANGLE);
    const double t = 0.2e-3, length = wb_hull_length(&hull, 0.0);
    assert_close(wb_hull_length(&hull, t), length + 2.0 * M_PI * t, 1e-15);
    assert_close(area_of(&hull, t), area_of(&hull, 0.0) + length * t + M_PI * t * t, 1e-18);
}

static void the_outline_goes_on_after_a_turn(void **state)
{
    (void)state;
    find_lattice(7, WB_PACKING_HEXAGON);
    const double length = wb_hull_length(&hull, 0.0);
    for (int i = 0; i < 50; i++) {
        const double s = length * i / 50.0;
        const struct wb_hull_point a = wb_hull_at(&hull, 0.0, s);
        const struct wb_hull_point b = wb_hull_at(&hull, 0.0, s + 3.0 * length);
        const struct wb_hull_point c = wb_hull_at(&hull, 0.0, s - 2.0 * length);
        assert_close(hypot(a.y - b.y, a.z - b.z), 0.0, 1e-14);
        assert_close(hypot(a.y - c.y, a.z - c.z), 0.0, 1e-14);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(seven_wires_touch_over_sixty_degrees),
        cmocka_unit_test(nineteen_wires_touch_with_twelve),
        cmocka_unit_test(triangle_patches_are_hexagons_of_two_sides),
        cmocka_unit_test(one_wire_is_its_own_outline),
        cmocka_unit_test(two_wires_are_a_belt),
        cmocka_unit_test(a_circle_within_another_does_not_matter),
        cmocka_unit_test(a_thick_wire_has_several_arcs),
        cmocka_unit_test(outlines_of_any_circles),
        cmocka_unit_test(an_outline_farther_out_is_longer_by_its_turn),
        cmocka_unit_test(the_outline_goes_on_after_a_turn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
