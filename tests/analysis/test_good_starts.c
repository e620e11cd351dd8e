/* The start check against wires of the virtual rig on which nothing is wrong: all types, lengths of
 * 60 to 150 mm, bows as they are drawn. What stops such a start stops people at work. */
#include "daq/test/first_force.h"
#include "daq/test/start_check.h"

#include <string.h>

#include "base/units.h"
#include "fixtures/virtual/live_wire.h"
#include "fixtures/virtual/sim_cell.h"
#include "fixtures/virtual/sim_mocap.h"
#include "tests/analysis/fast_rig.h"
#include "tests/check.h"
#include "tests/trials.h"

enum {
    STARTS = 500,
    FRAMES = 240
};

/* The frames of the check, of a wire that rests, judged by a specimen file. */
static void watch(const struct fast_rig *fast, const struct wb_specimen *file,
                  struct wb_start_check *check)
{
    static struct wb_sim_mocap mocap;
    static struct wb_natnet_frame frame;
    struct wb_live_wire *wire;
    struct wb_live_wire_view view;
    const struct wb_live_wire_parts parts = {&fast->truth, &fast->composite, &fast->wire,
                                             &fast->rig, &fast->specimen};
    assert_int_equal(wb_live_wire_create(&wire, &parts, NULL), WB_OK);
    wb_live_wire_move(wire, 0.0, &view);
    wb_sim_mocap_init(&mocap, &fast->truth, fast->rig.mocap.up, fast->specimen.n_markers,
                      (struct wb_natnet_version){3, 0});
    memset(check, 0, sizeof *check);
    for (int k = 0; k < FRAMES; k++) {
        wb_sim_mocap_frame(&mocap, (uint64_t)k, &view, &frame);
        wb_start_check_frame(check, &frame.mocap, file);
    }
    wb_live_wire_destroy(wire);
}

static void no_good_start_is_stopped(void **state)
{
    (void)state;
    int stopped = 0, looked_at = 0;
    double largest_bow = 0.0;
    for (int i = 0; looked_at < STARTS; i++) {
        struct fast_rig fast;
        struct wb_start_check check;
        char text[WB_START_CHECK_TEXT] = "";
        const double length = (60.0 + 90.0 * looked_at / (STARTS - 1)) * WB_MM;
        fast_rig_init(&fast, 1 + i % 3, length, 5000 + (uint64_t)i);
        watch(&fast, &fast.specimen, &check);
        /* A marker that these cameras hide for the whole time is no good start. */
        if (check.n_measured < (long)(FRAMES * (fast.specimen.n_markers - 0.5)))
            continue;
        looked_at++;
        largest_bow = fmax(largest_bow, fabs(fast.truth.bow_constant) * length * length / 2.0);
        if (wb_start_check_markers(&check, &fast.specimen, text) &&
            wb_start_check_chain(&check, &fast.specimen, &fast.rig, text))
            continue;
        print_message("    type %d, %.0f mm: %s\n", 1 + i % 3, length / WB_MM, text);
        stopped++;
    }
    print_message("    %d of %d good starts stopped, bows up to %.1f mm\n", stopped, STARTS,
                  largest_bow / WB_MM);
    assert_int_equal(stopped, 0);
    count_trials("The start check stops no good start", STARTS,
                 "starts of all types, 60 to 150 mm, bows up to %.0f mm: none stopped",
                 largest_bow / WB_MM);
}

/* The same wires, with a file or cameras that are wrong by little. */
static void no_wrong_start_gets_through(void **state)
{
    (void)state;
    static const char *const names[] = {"length 2 mm off", "scale 2 % off", "a marker 2 mm off",
                                        "15 times the noise"};
    for (int fault = 0; fault < (int)(sizeof names / sizeof names[0]); fault++) {
        int stopped = 0;
        const int n = 60;
        for (int i = 0; i < n; i++) {
            struct fast_rig fast;
            struct wb_start_check check;
            char text[WB_START_CHECK_TEXT] = "";
            const double length = (60.0 + 90.0 * i / (n - 1)) * WB_MM;
            fast_rig_init(&fast, 1 + i % 3, length, 6000 + (uint64_t)i);
            struct wb_specimen wrong = fast.specimen;
            const double sign = i % 2 ? 1.0 : -1.0;
            const double factor = fault == 0   ? 1.0 + sign * 2.0 * WB_MM / length
                                  : fault == 1 ? 1.0 + sign * 0.02
                                               : 1.0;
            for (int m = 0; m < wrong.n_markers; m++)
                wrong.markers[m] *= factor;
            wrong.length *= factor;
            if (fault == 2)
                wrong.markers[1 + i % (wrong.n_markers - 2)] += sign * 2.0 * WB_MM;
            if (fault == 3)
                fast.truth.marker_noise *= 15.0;
            watch(&fast, &wrong, &check);
            stopped += !wb_start_check_markers(&check, &wrong, text) ||
                       !wb_start_check_chain(&check, &wrong, &fast.rig, text);
            if (i == 0)
                print_message("    %s: %s\n", names[fault], text);
        }
        print_message("    %s: %d of %d stopped\n", names[fault], stopped, n);
        assert_int_equal(stopped, n);
        count_trials("A start that is wrong by little is refused", (uint64_t)n,
                     "starts with %s: all refused", names[fault]);
    }
}

/* What is wrong with the cell, or with what is known of the wire. */
struct force_fault {
    const char *name;
    double factor; /* on the reading */
    double length; /* on the specimen's length, as its file says it */
    bool is_known; /* the wire has properties */
};

/* The first force of a test whose deflection is the wire's own: the cell's readings from the tare
 * to 53 mm at 1 mm/s. */
static enum wb_first_force_verdict
pull(const struct fast_rig *fast, const struct force_fault *fault, char text[WB_START_CHECK_TEXT])
{
    const double tare_time = 2.0;
    double rest = 0.0;
    struct wb_wire wire = fast->wire;
    struct wb_first_force force;
    struct wb_first_force_bounds bounds = {.of = "the wire"};
    struct wb_live_wire *live;
    struct wb_live_wire_view view;
    static struct wb_sim_cell cell;
    struct wb_average zero = {0};
    const struct wb_live_wire_parts parts = {&fast->truth, &fast->composite, &fast->wire,
                                             &fast->rig, &fast->specimen};
    wire.has_properties = fault->is_known;
    wb_wire_stiffness_bounds(&wire, fault->length * fast->specimen.length, &bounds.lowest,
                             &bounds.highest);
    assert_int_equal(wb_live_wire_create(&live, &parts, NULL), WB_OK);
    assert_int_equal(wb_sim_cell_init(&cell, &fast->truth, &fast->rig), WB_OK);
    enum wb_first_force_verdict verdict = WB_FIRST_FORCE_OPEN;
    for (uint64_t k = 0; verdict == WB_FIRST_FORCE_OPEN; k++) {
        const double t = wb_sim_cell_time(&cell, k), travel = 1e-3 * fmax(0.0, t - tare_time);
        if (travel > 0.053)
            break;
        wb_live_wire_move(live, travel, &view);
        if (k == 0)
            rest = view.deflection;
        wb_sim_cell_read(&cell, k, t, view.tension);
        cell.out.n = 0;
        if (t < tare_time) {
            wb_average_add(&zero, fault->factor * cell.reading);
            wb_first_force_begin(&force, wb_average_deviation(&zero), &fast->rig);
            continue;
        }
        verdict = wb_first_force_add(&force, view.deflection - rest,
                                     fault->factor * cell.reading - zero.mean, &bounds, text);
    }
    wb_live_wire_destroy(live);
    return verdict;
}

static int count_stopped(const struct force_fault *fault, int n, uint64_t seed)
{
    int stopped = 0;
    for (int i = 0; i < n; i++) {
        struct fast_rig fast;
        char text[WB_START_CHECK_TEXT] = "";
        const double length = (60.0 + 90.0 * i / (n - 1)) * WB_MM;
        fast_rig_init(&fast, 1 + i % 3, length, seed + (uint64_t)i);
        const enum wb_first_force_verdict verdict = pull(&fast, fault, text);
        if (verdict == WB_FIRST_FORCE_WRONG && ++stopped == 1)
            print_message("    %s: type %d, %.0f mm: %s\n", fault->name, 1 + i % 3, length / WB_MM,
                          text);
        if (verdict == WB_FIRST_FORCE_OPEN)
            print_message("    %s: type %d, %.0f mm: never judged\n", fault->name, 1 + i % 3,
                          length / WB_MM);
    }
    return stopped;
}

static void no_good_first_force_is_stopped(void **state)
{
    (void)state;
    for (int known = 0; known < 2; known++) {
        const struct force_fault good = {"nothing wrong", 1.0, 1.0, known};
        assert_int_equal(count_stopped(&good, STARTS, 7000), 0);
    }
    count_trials("The first force stops no good test", 2 * STARTS,
                 "starts of all types, 60 to 150 mm, with and without known properties: none "
                 "stopped");
}

static void no_wrong_first_force_gets_through(void **state)
{
    (void)state;
    static const struct force_fault faults[] = {
        {"sign turned round", -1.0, 1.0, false},
        {"sign turned round", -1.0, 1.0, true},
        {"kg for g", 1000.0, 1.0, false},
        {"mg for g", 0.001, 1.0, true},
        {"N for kg", 1.0 / 9.80665, 1.0, true},
        {"a specimen half as long", 1.0, 0.5, true},
        {"a specimen twice as long", 1.0, 2.0, true},
        {"a dead cell", 0.0, 1.0, true},
    };
    int n = 0;
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++, n += 60)
        assert_int_equal(count_stopped(&faults[i], 60, 8000), 60);
    count_trials("A wrong first force stops the test", (uint64_t)n,
                 "starts with a sign, unit or specimen that is wrong: all stopped");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_good_start_is_stopped),
        cmocka_unit_test(no_wrong_start_gets_through),
        cmocka_unit_test(no_good_first_force_is_stopped),
        cmocka_unit_test(no_wrong_first_force_gets_through),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
