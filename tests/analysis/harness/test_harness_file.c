#include "analysis/harness/harness_file.h"

#include "base/units.h"
#include "tests/analysis/harness/harness_text.h"
#include "tests/messages.h"
#include "tests/own_folder.h"

static char file[64];

static int begin(void **state)
{
    if (make_folder(state) != 0)
        return -1;
    snprintf(file, sizeof file, "%s/h.yaml", folder);
    return 0;
}

static void file_is_read_into_si_units(void **unused)
{
    (void)unused;
    struct wb_harness_plan *const plan = make_plan();
    write_harness(file, 0, NULL);
    assert_int_equal(wb_harness_file_read(plan, file), WB_OK);
    assert_string_equal(plan->name, "sample");
    assert_true(plan->gravity[2] == -WB_STANDARD_GRAVITY);
    assert_int_equal(plan->n_wires, 2);
    assert_string_equal(plan->wires[1].file, "type3.yaml");
    assert_close_relative(plan->wires[1].diameter, 1.4e-3, 1e-14);
    assert_false(plan->wires[1].has_unloading);
    assert_int_equal(plan->n_branches, 3);
    assert_int_equal(plan->branches[0].parent, -1);
    assert_int_equal(plan->branches[2].parent, 0);
    assert_close_relative(plan->branches[1].length, 0.2, 1e-14);
    assert_int_equal(plan->n_items, 4);
    assert_int_equal(plan->items[1].kind, WB_HARNESS_CONNECTOR);
    assert_int_equal(plan->items[1].branch, 1);
    assert_close_relative(plan->items[1].mass, 8e-3, 1e-14);
    assert_close_relative(plan->items[1].centre[0], 12e-3, 1e-14);
    assert_int_equal(plan->items[3].hold, WB_HARNESS_AXIS);
    assert_int_equal(plan->n_steps, 5);
    assert_int_equal(plan->steps[1].kind, WB_HARNESS_MOUNT);
    assert_int_equal(plan->steps[1].item, 3);
    assert_string_equal(plan->steps[1].name, "mount C1");
    assert_close_relative(plan->steps[1].direction[0], 1.0 / sqrt(1.08), 1e-14);
    assert_false(plan->steps[2].has_direction);
    free(plan);
}

/* Reads the sample with this `wire` of its trunk. */
static enum wb_status read_trunk(struct wb_harness_plan *plan, const char *wire)
{
    char line[200];
    snprintf(line, sizeof line, "  - {name: trunk, wire: %s}", wire);
    write_harness(file, 4, line);
    memset(plan, 0, sizeof *plan);
    return wb_harness_file_read(plan, file);
}

static void a_bundle_file_stands_for_its_calibrated_beam(void **unused)
{
    (void)unused;
    static const char *const beams[][2] = {{"7-type3", "bundle-7"},
                                           {"12-type3", "bundle-12"},
                                           {"19-type3", "bundle-19"},
                                           {"19-mixed", "bundle-19-mixed"},
                                           {"27-type3", "bundle-27"}};
    struct wb_harness_plan *const plan = make_plan(), *const beam = make_plan();
    for (size_t i = 0; i < sizeof beams / sizeof beams[0]; i++) {
        assert_int_equal(read_trunk(beam, beams[i][1]), WB_OK);
        assert_int_equal(read_trunk(plan, beams[i][0]), WB_OK);
        assert_memory_equal(&plan->wires[0], &beam->wires[0], sizeof plan->wires[0]);
        assert_true(plan->wires[0].diameter > 4e-3);
    }
    /* A path relative to the harness file, to a bundle with a beam relative to the bundle. */
    char path[WB_PATH], from[WB_PATH];
    static const char bundle[] =
        "name: own\nwires: [{wire: type3}]\npublished: {beam: ./own.yaml}\n";
    snprintf(path, sizeof path, "%s/bundle.yaml", folder);
    assert_int_equal(wb_file_write(path, bundle, strlen(bundle)), WB_OK);
    assert_int_equal(wb_file_find_fixture(from, "wires", "type2", NULL), WB_OK);
    char *text;
    size_t size;
    assert_int_equal(wb_file_read(from, &text, &size), WB_OK);
    snprintf(path, sizeof path, "%s/own.yaml", folder);
    assert_int_equal(wb_file_write(path, text, size), WB_OK);
    free(text);
    assert_int_equal(read_trunk(plan, "./bundle.yaml"), WB_OK);
    assert_string_equal(plan->wires[0].file, "own.yaml");
    free(plan);
    free(beam);
}

static void a_bundle_file_without_a_beam_is_rejected_with_what_to_do(void **unused)
{
    (void)unused;
    struct wb_harness_plan *const plan = make_plan();
    keep_messages();
    assert_int_equal(read_trunk(plan, "template"), WB_ERR_FORMAT);
    assert_message("h.yaml:4: wire: ");
    assert_message("template.yaml is a bundle file without a calibrated beam (published: beam)");
    assert_message("wirebench calibrate");
    assert_int_equal(read_trunk(plan, "no-such"), WB_ERR_NOT_FOUND);
    assert_message("h.yaml:4: wire");
    release_messages();
    free(plan);
}

/* Branch B2 leaves at 30 degrees towards 90 degrees around x from up: towards -y. */
static void branch_leaves_at_its_angle(void **unused)
{
    (void)unused;
    struct wb_harness_plan *const plan = make_plan();
    double R[9];
    write_harness(file, 0, NULL);
    assert_int_equal(wb_harness_file_read(plan, file), WB_OK);
    wb_rod_element_matrix(plan->branches[1].leaving, R);
    assert_close(R[0], cos(M_PI / 6.0), 1e-14);
    assert_close(R[3], -sin(M_PI / 6.0), 1e-14);
    assert_close(R[6], 0.0, 1e-14);
    free(plan);
}

static void branches_may_stand_in_any_order(void **unused)
{
    (void)unused;
    struct wb_harness_plan *const plan = make_plan();
    FILE *const out = fopen(file, "w");
    static const int order[] = {0, 1, 2, 3, 4, 5, 6, 9, 8, 7, 10, 11, 12, 13, 14, 15, 16};
    assert_non_null(out);
    for (size_t i = 0; i < sizeof order / sizeof order[0]; i++)
        fprintf(out, "%s\n", harness_lines[order[i]]);
    assert_int_equal(fclose(out), 0);
    assert_int_equal(wb_harness_file_read(plan, file), WB_OK);
    assert_string_equal(plan->branches[0].name, "B1");
    assert_string_equal(plan->branches[1].name, "B3");
    assert_int_equal(plan->branches[1].parent, 0);
    assert_int_equal(plan->items[1].branch, 2);
    free(plan);
}

static void rotation_has_the_direction_and_up(void **unused)
{
    (void)unused;
    const double direction[3] = {0.0, -1.0, 0.0}, up[3] = {0.6, 0.5, 0.8};
    double q[4], R[9];
    wb_harness_file_rotation(direction, up, NULL, q);
    wb_rod_element_matrix(q, R);
    assert_close(R[3], -1.0, 1e-14);
    assert_close(R[2], 0.6, 1e-14);
    assert_close(R[8], 0.8, 1e-14);
    /* Without up it turns as little as possible, also to the opposite direction. */
    const double back[3] = {-1.0, 0.0, 0.0}, same[4] = {1.0, 0.0, 0.0, 0.0};
    wb_harness_file_rotation(back, NULL, same, q);
    wb_rod_element_matrix(q, R);
    assert_close(R[0], -1.0, 1e-14);
    assert_close(R[4], 1.0, 1e-14);
}

static void natural_shape_is_read(void **unused)
{
    (void)unused;
    struct wb_harness_plan *const plan = make_plan();
    write_harness(file, 10,
                  "  - {name: B3, from: J, to: K2, wire: lead, length_mm: 250, natural_shape: "
                  "{curve: [{at_mm: 0, curvature_1_m: [1, 2]}, {at_mm: 250, curvature_1_m: [0, "
                  "-3]}]}}");
    assert_int_equal(wb_harness_file_read(plan, file), WB_OK);
    assert_int_equal(plan->branches[2].n_curve, 2);
    assert_close_relative(plan->branches[2].place[1], 0.25, 1e-14);
    assert_true(plan->branches[2].curvature[1][1] == -3.0);
    free(plan);
}

/* What is wrong, the line that the message names, and two words of it: a key and a value. */
static const struct {
    int line;
    const char *text;
    int named;
    const char *words[2];
} wrong[] = {
    {1, "kind: tree", 1, {"kind", "harness"}},
    {4, "  - {name: trunk, wire: no-such-wire}", 4, {"wire", "no-such-wire"}},
    {5, "  - {name: trunk, wire: type3}", 5, {"name", "trunk"}},
    {5, "  - {name: lead, wire: h.yaml}", 0, {"expected a wire file", "h.yaml"}},
    {6, "root: {name: R, direction: [0, 0, 2]}", 6, {"direction", "parallel"}},
    {6, "root: {name: R, direction: [0, 0, 0]}", 6, {"direction", "length"}},
    {9, "  - {name: B2, from: X, to: K1, wire: lead, length_mm: 200}", 9, {"from", "'X'"}},
    {9, "  - {name: B2, from: J, to: J, wire: lead, length_mm: 200}", 9, {"to", "B1"}},
    {9, "  - {name: B2, from: J, to: R, wire: lead, length_mm: 200}", 9, {"to", "root"}},
    {8, "  - {name: B1, from: K1, to: J, wire: trunk, length_mm: 300}", 8, {"from", "loop"}},
    {9, "  - {name: B1, from: J, to: K1, wire: lead, length_mm: 200}", 9, {"name", "B1"}},
    {9, "  - {name: B2, from: J, to: K1, wire: cable, length_mm: 200}", 9, {"wire", "cable"}},
    {9, "  - {name: B2, from: J, to: K1, wire: lead, length_mm: -1}", 9, {"length_mm", "-1"}},
    {9, "  - {name: B2, from: J, to: K1, wire: lead, length_mm: 200, twist: 1}", 9, {"twist", ""}},
    {12, "  - {name: K9, mass_g: 8}", 12, {"name", "K9"}},
    {15, "  - {name: C1, branch: B1, at_mm: 301, holds: axis}", 15, {"at_mm", "300 mm"}},
    {15, "  - {name: C1, branch: B7, at_mm: 200, holds: axis}", 15, {"branch", "B7"}},
    {15, "  - {name: C1, branch: B1, at_mm: 200, holds: tight}", 15, {"holds", "tight"}},
    {15,
     "  - {name: C1, branch: B1, at_mm: 200, holds: axis, friction: 0.2}",
     15,
     {"friction", "slide"}},
    {15,
     "  - {name: C1, branch: B1, at_mm: 200, holds: slide, friction: -1}",
     15,
     {"friction", "-1"}},
    {15, "  - {name: C1, branch: B1, at_mm: 200, holds: slide}", 18, {"direction", "C1"}},
    {15, "  - {name: K1, branch: B1, at_mm: 200, holds: axis}", 15, {"name", "K1"}},
    {15, "  - {name: C1, branch: B2, at_mm: 200, holds: axis}", 15, {"at_mm", "K1"}},
    {14,
     "obstacles:\n  - {name: O, shape: ball, at_mm: [0, 0, -9]}\nclips:",
     15,
     {"shape", "ball"}},
    {14,
     "obstacles:\n  - {name: O, shape: plane, at_mm: [0, 0, -9]}\nclips:",
     15,
     {"direction", "plane"}},
    {14,
     "obstacles:\n  - {name: O, shape: box, at_mm: [0, 0, -9]}\nclips:",
     15,
     {"size_mm", "box"}},
    {14,
     "obstacles:\n  - {name: O, shape: box, at_mm: [0, 0, -9], size_mm: [9, 9]}\nclips:",
     15,
     {"size_mm", "3"}},
    {14,
     "obstacles:\n  - {name: O, shape: box, at_mm: [0, 0, -9], size_mm: [9, 9, 9], edge_radius_mm: "
     "5}\nclips:",
     15,
     {"edge_radius_mm", "4.5"}},
    {14,
     "obstacles:\n  - {name: O, shape: box, at_mm: [0, 0, -9], size_mm: [9, 9, 9], up: [1, 0, "
     "0]}\nclips:",
     15,
     {"up", "parallel"}},
    {14,
     "obstacles:\n  - {name: O, shape: plane, at_mm: [0, 0, -9], direction: [0, 0, 1], radius_mm: "
     "5}\nclips:",
     15,
     {"radius_mm", "plane"}},
    {14,
     "obstacles:\n  - {name: O, shape: cylinder, at_mm: [0, 0, -9], direction: [0, 1, 0]}\nclips:",
     15,
     {"radius_mm", "cylinder"}},
    {14,
     "obstacles:\n  - {name: O, shape: plane, at_mm: [0, 0, -9], direction: [0, 0, 1], friction: "
     "-1}\nclips:",
     15,
     {"friction", "-1"}},
    {14,
     "obstacles:\n  - {name: K1, shape: plane, at_mm: [0, 0, -9], direction: [0, 0, 1]}\nclips:",
     15,
     {"name", "K1"}},
    {14,
     "obstacles:\n  - {name: O, shape: plane, at_mm: [0, 0, 40], direction: [0, 0, 1]}\nclips:",
     20,
     {"at_mm", "10 mm inside of obstacle O"}},
    {17, "  - stand", 17, {"stand", "hang"}},
    {18, "  - {mount: C2, at_mm: [190, 0, 30]}", 18, {"mount", "C2"}},
    {18, "  - {mount: C1, at_mm: [190, 0, 80]}", 18, {"R", "206.2 mm apart, 200 mm"}},
    {18, "  - {mount: C1, at_mm: [190, 0]}", 18, {"at_mm", "3"}},
    {18, "  - {mount: C1}", 18, {"at_mm", "missing"}},
    {18, "  - {mount: C1, at_mm: [190, 0, 30], up: [0, 0, 1]}", 18, {"up", "axis"}},
    {18,
     "  - {mount: K1, at_mm: [190, 0, 30], direction: [0, 0, 1], up: [0, 0, -1]}",
     18,
     {"direction", "parallel"}},
    {19, "  - {mount: C1, at_mm: [190, 20, 30]}", 19, {"mount", "already"}},
    {19, "  - {move: K1, at_mm: [190, 20, 30]}", 19, {"move", "not mounted"}},
    {19, "  - hang", 19, {"hangs", "already"}},
    {20, "  - {release: K1}", 20, {"release", "not mounted"}},
    {20, "  - take_off", 21, {"take_off", "last"}},
    {20, "  - {lift: C1}", 20, {"mount", "release"}},
};

static void mistakes_are_named_by_line_and_key(void **unused)
{
    (void)unused;
    struct wb_harness_plan *const plan = make_plan();
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        char place[100];
        write_harness(file, wrong[i].line, wrong[i].text);
        keep_messages();
        const enum wb_status status = wb_harness_file_read(plan, file);
        release_messages();
        snprintf(place, sizeof place, "%s:%d: ", file, wrong[i].named);
        if (status == WB_OK || (wrong[i].named > 0 && !strstr(kept.error, place)) ||
            !strstr(kept.error, wrong[i].words[0]) || !strstr(kept.error, wrong[i].words[1]))
            fail_msg("line %d, '%s': %s", wrong[i].line, wrong[i].text, kept.error);
    }
    free(plan);
}

static void obstacles_are_read(void **unused)
{
    (void)unused;
    struct wb_harness_plan *const plan = make_plan();
    double R[9];
    write_harness(file, 14,
                  "obstacles:\n"
                  "  - {name: floor, shape: plane, at_mm: [0, 0, -300], direction: [0, 0, 2]}\n"
                  "  - {name: tube, shape: cylinder, at_mm: [9, 0, -50], direction: [0, 1, 0],\n"
                  "     radius_mm: 8, friction: 0.3}\n"
                  "  - {name: sill, shape: box, at_mm: [9, 0, -90], size_mm: [10, 20, 30],\n"
                  "     edge_radius_mm: 2}\n"
                  "clips:");
    assert_int_equal(wb_harness_file_read(plan, file), WB_OK);
    assert_int_equal(plan->n_obstacles, 3);
    const struct wb_obstacle *const floor = &plan->obstacles[0].body;
    const struct wb_obstacle *const tube = &plan->obstacles[1].body;
    const struct wb_obstacle *const sill = &plan->obstacles[2].body;
    assert_int_equal(floor->kind, WB_OBSTACLE_PLANE);
    assert_close_relative(floor->place[2], -0.3, 1e-14);
    wb_rod_element_matrix(floor->rotation, R);
    assert_close(R[6], 1.0, 1e-14);
    assert_int_equal(tube->kind, WB_OBSTACLE_CYLINDER);
    assert_close_relative(tube->size[0], 8e-3, 1e-14);
    assert_true(isinf(tube->size[1]));
    assert_true(tube->friction == 0.3);
    wb_rod_element_matrix(tube->rotation, R);
    assert_close(R[3], 1.0, 1e-14);
    assert_int_equal(sill->kind, WB_OBSTACLE_BOX);
    assert_close_relative(sill->size[2], 30e-3, 1e-14);
    assert_close_relative(sill->edge, 2e-3, 1e-14);
    assert_true(sill->friction == 0.0);
    assert_string_equal(wb_harness_file_holder(plan, plan->n_items + 2), "sill");
    free(plan);
}

static void missing_parts_are_named(void **unused)
{
    (void)unused;
    struct wb_harness_plan *const plan = make_plan();
    static const struct {
        int line;
        const char *key;
    } parts[] = {{1, "kind"}, {2, "name"}, {6, "root"}};
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        write_harness(file, parts[i].line, NULL);
        keep_messages();
        assert_int_not_equal(wb_harness_file_read(plan, file), WB_OK);
        release_messages();
        assert_non_null(strstr(kept.error, parts[i].key));
    }
    free(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(file_is_read_into_si_units),
        cmocka_unit_test(a_bundle_file_stands_for_its_calibrated_beam),
        cmocka_unit_test(a_bundle_file_without_a_beam_is_rejected_with_what_to_do),
        cmocka_unit_test(branch_leaves_at_its_angle),
        cmocka_unit_test(branches_may_stand_in_any_order),
        cmocka_unit_test(rotation_has_the_direction_and_up),
        cmocka_unit_test(natural_shape_is_read),
        cmocka_unit_test(mistakes_are_named_by_line_and_key),
        cmocka_unit_test(obstacles_are_read),
        cmocka_unit_test(missing_parts_are_named),
    };
    return cmocka_run_group_tests(tests, begin, remove_folder);
}
