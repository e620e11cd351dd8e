/* Moment over curvature of a homogenised beam, from deflection curves of real beams. */
#include "fe/section/section_homogenise.h"

#include "fe/rod/fibres.h"
#include "fe/trial/cantilever.h"
#include "tests/check.h"

enum {
    ROWS = 53
};

static const double length = 0.114;
static const struct wb_material type3 = {
    WB_HARDENING_ISOTROPIC_POWER, 4528e6, 0.39, 4.52e6, 1327e6, 0.90};

/* Force over deflection of a wire from the 1D beam. */
static void bend(const struct wb_section *section, struct wb_section_homogenise_point *points)
{
    struct wb_cantilever_model beam;
    struct wb_cantilever *cantilever;

    wb_cantilever_default_model(&beam);
    beam.section = section;
    beam.length = length;
    beam.gravity_y = 0.0;
    assert_int_equal(wb_cantilever_create(&cantilever, &beam, NULL), WB_OK);
    for (int i = 0; i < ROWS; i++) {
        struct wb_cantilever_point point;
        points[i].deflection = (i + 1) * 1e-3;
        assert_int_equal(
            wb_cantilever_move(cantilever, WB_CONTROL_DEFLECTION, points[i].deflection, &point),
            WB_OK);
        points[i].force = point.tension;
    }
    wb_cantilever_destroy(cantilever);
}

static void an_elastic_beam_has_its_rigidity_at_every_curvature(void **unused)
{
    (void)unused;
    struct wb_section_homogenise_point points[ROWS];
    struct wb_section section;
    struct wb_material elastic = type3;
    const double expected = 4528e6 * M_PI / 64.0 * pow(1.4e-3, 4.0);

    elastic.hardening = WB_HARDENING_NONE_ELASTIC;
    assert_int_equal(wb_section_init_circle(&section, 1.4e-3, &elastic, 0), WB_OK);
    bend(&section, points);
    assert_int_equal(wb_section_homogenise(ROWS, points, length), ROWS);
    for (int i = 0; i < ROWS; i++)
        assert_close_relative(points[i].moment / points[i].curvature, expected, 1e-3);
    wb_section_release(&section);
}

static void a_plastic_wire_has_the_moments_of_its_fibres(void **unused)
{
    (void)unused;
    struct wb_section_homogenise_point points[ROWS];
    struct wb_section section;
    struct wb_fibres *fibres;
    double before[512] = {0}, after[512];

    assert_int_equal(wb_section_init_circle(&section, 1.4e-3, &type3, 0), WB_OK);
    bend(&section, points);
    assert_int_equal(wb_section_homogenise(ROWS, points, length), ROWS);
    assert_int_equal(wb_fibres_create(&fibres, &section), WB_OK);
    assert_true(wb_fibres_history_size(fibres) <= 512);
    for (int i = 0; i < ROWS; i++) {
        struct wb_fibres_response r;
        wb_fibres_respond(fibres, 0.0, points[i].curvature, before, after, &r);
        assert_close_relative(points[i].moment, r.M, 0.01);
    }
    /* The wire has yielded far. */
    assert_true(points[ROWS - 1].moment / points[ROWS - 1].curvature <
                0.5 * points[0].moment / points[0].curvature);
    wb_fibres_destroy(fibres);
    wb_section_release(&section);
}

static void a_curve_ends_where_its_moment_stops_increasing(void **unused)
{
    (void)unused;
    struct wb_section_homogenise_point points[] = {
        {1e-3, 0.01, 0, 0}, {2e-3, 0.02, 0, 0}, {3e-3, 0.01, 0, 0}, {4e-3, 0.03, 0, 0}};
    assert_int_equal(wb_section_homogenise(4, points, length), 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_elastic_beam_has_its_rigidity_at_every_curvature),
        cmocka_unit_test(a_plastic_wire_has_the_moments_of_its_fibres),
        cmocka_unit_test(a_curve_ends_where_its_moment_stops_increasing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
