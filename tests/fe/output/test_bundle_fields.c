/* Meshes and stresses of bundles: geometry, stresses of bent wires compared with the beam, flow
 * stress. */
#include "fe/output/bundle_fields.h"

#include "tests/fe/bundle/bundles.h"

#define THREE                                                                                      \
    "wires: [{wire: type3, count: 3}]\npacking: triangle\ntape: tape\n"                            \
    "taping: {layout: sleeve, layers: 2}\n"

/* A bundle moved to a deflection within a duration. */
static struct wb_bundle *bend(const char *lines, double deflection, double duration)
{
    const struct wb_bundle_settings settings = {.duration = duration};
    struct wb_bundle *bundle;
    read_model(lines);
    assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
    assert_int_equal(wb_bundle_settle(bundle, NULL, NULL), WB_OK);
    wb_bundle_move_tip(bundle, deflection, duration);
    const double steps = duration / wb_bundle_time_step(bundle);
    assert_int_equal(wb_bundle_advance(bundle, (int)steps, NULL), WB_OK);
    return bundle;
}

static double triple(const double a[3], const double b[3], const double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Volume of the prism spanned by the cell's mean edges, whose map is bilinear in the section and
 * linear along the axis. */
static double volume_of(const struct wb_bundle_fields *f, const int node[8])
{
    double along[3], first[3], second[3];
    for (int i = 0; i < 3; i++) {
        double x[8];
        for (int a = 0; a < 8; a++)
            x[a] = f->reference[node[a]][i];
        along[i] = 0.25 * (x[4] + x[5] + x[6] + x[7] - x[0] - x[1] - x[2] - x[3]);
        first[i] = 0.5 * (x[2] + x[6] - x[0] - x[4]);
        second[i] = 0.5 * (x[3] + x[7] - x[1] - x[5]);
    }
    return 0.5 * triple(along, first, second);
}

static void mesh_contains_all_bodies_of_the_bundle(void **unused)
{
    (void)unused;
    const struct wb_bundle_settings settings = {.duration = 1.0};
    struct wb_bundle_fields f;
    struct wb_bundle *bundle;
    read_model(THREE RUN("deflection_mm: 20") "loads: {weight: false}\n");
    assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
    wb_bundle_fields_init(&f, bundle);
    const int around = wb_bundle_model_tape_quads(&model, wb_bundle_model_mesh(&model, "twelve"));
    assert_int_equal(f.n_bodies, 4);
    assert_int_equal(f.n_hexahedra, 3 * 12 * 15);
    assert_int_equal(f.n_quads, around * 15);
    assert_int_equal(f.n_quads, wb_bundle_shells(bundle));
    assert_int_equal(f.n_points, 3 * 17 * 16 + around * 16);
    double volume[3] = {0.0};
    for (int e = 0; e < f.n_hexahedra; e++) {
        const double v = volume_of(&f, f.hexahedron[e]);
        assert_int_equal(f.body[e], e / (12 * 15));
        assert_true(v > 0.0);
        volume[f.body[e]] += v;
    }
    for (int w = 0; w < 3; w++)
        assert_close_relative(volume[w], 0.114 * M_PI / 4.0 * 1.4e-3 * 1.4e-3, 0.006);
    for (int b = 0; b < 4; b++) {
        const struct wb_bundle_fields_body *body = &f.bodies[b];
        assert_int_equal(body->is_tape, b == 3);
        assert_true(body->closed);
        assert_int_equal(body->n_stations, 16);
        for (int k = 0; k < body->n_outline; k++) {
            const double *at = f.reference[body->first + body->outline[k]];
            const struct wb_packing_circle *circle = &model.packing.wire[b];
            assert_close_relative(hypot(at[1] - circle->y, at[2] - circle->z), 0.7e-3, 0.06);
        }
    }
    double area = 0.0;
    for (int e = 0; e < f.n_quads; e++) {
        const int *q = f.quad[e];
        assert_int_equal(f.body[f.n_hexahedra + e], 3);
        const double a[3] = {f.reference[q[1]][0] - f.reference[q[0]][0], 0.0, 0.0};
        const double b = hypot(f.reference[q[3]][1] - f.reference[q[0]][1],
                               f.reference[q[3]][2] - f.reference[q[0]][2]);
        assert_close_relative(a[0], 0.114 / 15, 1e-9);
        area += a[0] * b;
    }
    /* Chords of the outline. */
    assert_close_relative(area, 0.114 * model.tape.taping.circumference, 0.02);
    for (int i = 0; i < f.n_points; i++) {
        for (int c = 0; c < 3; c++)
            assert_close(f.position[i][c], f.reference[i][c], 1e-15);
        assert_close(f.von_mises[i], 0.0, 2e3); /* round-off of float */
        assert_close(f.plastic[i], 0.0, 0.0);
    }
    wb_bundle_fields_release(&f);
    wb_bundle_fields_release(&f);
    wb_bundle_destroy(bundle);
}

/* At 3 mm, in the elastic range: M y / I at top and bottom, with M = 3 E I v / L^3 (L - x); zero on
 * the neutral axis. The coarse section is 5 % wider than the wire, so that its second moment is the
 * wire's. Within an element the strain's variation has the modulus 3 mu instead of E, 8 % more. */
static void outer_fibres_of_a_bent_wire_have_the_beams_stress(void **unused)
{
    (void)unused;
    static const char *const meshes[2] = {"twelve", "fine"};
    static const double tolerance[2] = {0.04, 0.02};
    for (int m = 0; m < 2; m++) {
        char lines[400];
        snprintf(lines, sizeof lines,
                 "  - {name: fine, core_quads: 6, rings: 2, elements_along: 15}\n" ONE
                 "run: {mesh: %s, selective_mass_scaling: 100, deflection_mm: 20}\n"
                 "loads: {weight: false}\n",
                 meshes[m]);
        struct wb_bundle *bundle = bend(lines, 3e-3, 1.5);
        struct wb_bundle_fields f;
        wb_bundle_fields_init(&f, bundle);
        const struct wb_bundle_fields_body *body = &f.bodies[0];
        for (int j = 1; j < 14; j++) {
            const double x = 0.114 * j / 15, E = 4528e6, L = 0.114;
            const int top = body->first + j * body->n_nodes + body->outline[0];
            const int bottom = body->first + j * body->n_nodes + body->outline[body->n_outline / 2];
            const int side = body->first + j * body->n_nodes + body->outline[body->n_outline / 4];
            const double y = f.reference[top][1], scale = 3.0 * E * 3e-3 / (L * L) * y;
            const double expected = scale * (L - x) / L;
            assert_close_relative(y, 0.7e-3, 0.06);
            assert_close(f.reference[bottom][1], -y, 1e-12);
            assert_close(f.von_mises[top], expected, tolerance[m] * scale);
            assert_close(f.von_mises[bottom], expected, tolerance[m] * scale);
            assert_close(f.von_mises[side], 0.0, 0.05 * scale);
        }
        wb_bundle_fields_release(&f);
        wb_bundle_destroy(bundle);
    }
}

/* At 40 mm: largest next to the clamp; where it yields, at most the flow stress, and close to it on
 * the outer fibres. */
static void yielding_points_have_the_flow_stress(void **unused)
{
    (void)unused;
    struct wb_bundle *bundle =
        bend(ONE RUN("deflection_mm: 40") "loads: {weight: false}\n", 40e-3, 1.5);
    struct wb_bundle_fields f;
    wb_bundle_fields_init(&f, bundle);
    const struct wb_bundle_fields_body *body = &f.bodies[0];
    double largest = 0.0;
    int where = -1;
    for (int i = 0; i < f.n_points; i++) {
        const double flow = 4.52e6 + 1327e6 * pow(f.plastic[i], 0.9);
        assert_true(f.von_mises[i] <= flow * (1.0 + 1e-12));
        if (f.von_mises[i] > largest) {
            largest = f.von_mises[i];
            where = i;
        }
    }
    assert_in_range(where, 0, 3 * body->n_nodes);
    const int top = body->first + body->n_nodes + body->outline[0];
    assert_true(f.plastic[top] > 3e-3);
    assert_close_relative(f.von_mises[top], 4.52e6 + 1327e6 * pow(f.plastic[top], 0.9), 0.03);
    /* The tip is nearly stress-free and has not yielded. */
    const int tip = body->first + 15 * body->n_nodes + body->outline[0];
    assert_close(f.plastic[tip], 0.0, 0.0);
    assert_true(f.von_mises[tip] < 0.1 * largest);
    wb_bundle_fields_release(&f);
    wb_bundle_destroy(bundle);
}

/* Updating a mesh with a later state gives the same as creating it from that state. */
static void update_equals_a_new_mesh(void **unused)
{
    (void)unused;
    const struct wb_bundle_settings settings = {.duration = 0.2};
    struct wb_bundle_fields once, again;
    struct wb_bundle *bundle;
    read_model(THREE RUN("deflection_mm: 20") "loads: {weight: false}\n");
    assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
    wb_bundle_fields_init(&again, bundle);
    assert_int_equal(wb_bundle_settle(bundle, NULL, NULL), WB_OK);
    wb_bundle_move_tip(bundle, 20e-3, 0.2);
    assert_int_equal(wb_bundle_advance(bundle, (int)(0.1 / wb_bundle_time_step(bundle)), NULL),
                     WB_OK);
    wb_bundle_fields_take(&again, bundle);
    wb_bundle_fields_init(&once, bundle);
    const size_t n = (size_t)once.n_points;
    assert_memory_equal(once.position, again.position, n * sizeof *once.position);
    assert_memory_equal(once.von_mises, again.von_mises, n * sizeof *once.von_mises);
    assert_memory_equal(once.plastic, again.plastic, n * sizeof *once.plastic);
    /* The tape also has stress. */
    double tape = 0.0;
    for (int i = once.bodies[3].first; i < once.n_points; i++)
        tape = fmax(tape, once.von_mises[i]);
    assert_true(tape > 1e5 && tape < 20e6);
    wb_bundle_fields_release(&once);
    wb_bundle_fields_release(&again);
    wb_bundle_destroy(bundle);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mesh_contains_all_bodies_of_the_bundle),
        cmocka_unit_test(outer_fibres_of_a_bent_wire_have_the_beams_stress),
        cmocka_unit_test(yielding_points_have_the_flow_stress),
        cmocka_unit_test(update_equals_a_new_mesh),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
