/* Places read off a photograph, moved until wires that lie side by side touch. */
#include "tests/messages.h"

#include "base/config.h"
#include "fe/model/packing_touch.h"

static const double d = 1.4e-3;

static double distance(const struct wb_packing *packing, int a, int b)
{
    const struct wb_packing_circle *const p = &packing->wire[a], *const q = &packing->wire[b];
    return hypot(p->y - q->y, p->z - q->z);
}

/* Rows of three, four and three wires, with errors of up to `error` (m), the same each time. */
static struct wb_packing rows(double error)
{
    static const struct {
        double y, z;
    } place[] = {{1, -1}, {1, 0},   {1, 1},   {0, -1.5}, {0, -0.5},
                 {0, .5}, {0, 1.5}, {-1, -1}, {-1, 0},   {-1, 1}};
    struct wb_packing packing = {.n = (int)WB_COUNT(place)};
    for (int i = 0; i < packing.n; i++)
        packing.wire[i] =
            (struct wb_packing_circle){place[i].y * d * sqrt(0.75) + error * sin(1.0 + 7.0 * i),
                                       place[i].z * d + error * cos(2.0 + 5.0 * i), 0.5 * d};
    return packing;
}

static void misread_rows_become_rows_again(void **state)
{
    (void)state;
    const struct wb_packing wanted = rows(0.0), read = rows(0.03e-3);
    struct wb_packing packing = read;
    assert_int_equal(wb_packing_touch(&packing, 0.1e-3, NULL), WB_OK);
    for (int a = 0; a < packing.n; a++) {
        for (int b = a + 1; b < packing.n; b++)
            assert_close(distance(&packing, a, b), distance(&wanted, a, b), 1e-12 * d);
        assert_true(hypot(packing.wire[a].y - read.wire[a].y, packing.wire[a].z - read.wire[a].z) <
                    0.05e-3);
    }
    struct wb_packing_pair pair[30];
    assert_int_equal(wb_packing_pairs(&packing, 1e-9, 30, pair), 19);
}

/* As little as needed: two wires share the way, a third that is farther off stays. */
static void wires_move_as_little_as_needed(void **state)
{
    (void)state;
    struct wb_packing packing = {
        .n = 3, .wire = {{0.0, 0.0, 0.5 * d}, {0.0, 1.44e-3, 0.5 * d}, {0.0, 3.2e-3, 0.5 * d}}};
    assert_int_equal(wb_packing_touch(&packing, 0.1e-3, NULL), WB_OK);
    assert_close(packing.wire[0].z, 0.02e-3, 1e-15);
    assert_close(packing.wire[1].z, 1.42e-3, 1e-15);
    assert_close(packing.wire[2].z, 3.2e-3, 1e-15);
}

static void assert_refused(struct wb_packing *packing, double reach, const char *said)
{
    const struct wb_packing before = *packing;
    struct wb_reason why = {""};
    assert_int_equal(wb_packing_touch(packing, reach, &why), WB_ERR_ARGUMENT);
    assert_non_null(strstr(why.text, said));
    assert_memory_equal(packing, &before, sizeof before);
}

static void what_cannot_touch_is_refused_with_the_wires(void **state)
{
    (void)state;
    /* Six wires round a thicker one: they touch that, or each other. */
    struct wb_packing ring = {.n = 7, .wire = {{0.0, 0.0, 0.55 * d}}};
    for (int i = 1; i < ring.n; i++)
        ring.wire[i] = (struct wb_packing_circle){1.05 * d * sin(i * M_PI / 3.0),
                                                  1.05 * d * cos(i * M_PI / 3.0), 0.5 * d};
    assert_refused(&ring, 0.1 * d, "not all wires within 0.14 mm");
    struct wb_packing near = {.n = 2, .wire = {{0.0, 0.0, 0.5 * d}, {0.0, 1.1e-3, 0.5 * d}}};
    assert_refused(&near, 0.1e-3, "wires 1 and 2 overlap by 0.3 mm");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(misread_rows_become_rows_again),
        cmocka_unit_test(wires_move_as_little_as_needed),
        cmocka_unit_test(what_cannot_touch_is_refused_with_the_wires),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
