#include "fe/trial/three_point_bending_private.h"

#include <stdlib.h>

#include "tests/fe/rod/wires.h"
#include "tests/fe/trial/three_point_shooting.h"

/* An elastic wire on a bench similar to those of the shared tests, in round numbers. */
static const double modulus = 5e9, diameter = 1e-3, span = 40e-3;

static struct wb_section elastic_section(double shear_factor)
{
    const struct wb_material material = {
        .hardening = WB_HARDENING_NONE_ELASTIC, .youngs_modulus = modulus, .poissons_ratio = 0.39};
    struct wb_section section;
    assert_int_equal(wb_section_init_circle(&section, diameter, &material, 0), WB_OK);
    section.shear_stiffness *= shear_factor;
    return section;
}

static struct wb_three_point_bending_model bench(const struct wb_section *section)
{
    return (struct wb_three_point_bending_model){
        .section = section,
        .diameter = diameter,
        .span = span,
        .support_radius = 2e-3,
        .nose_radius = 4e-3,
    };
}

static struct shooting same(const struct wb_three_point_bending_model *model)
{
    const double d = model->diameter;
    return (struct shooting){
        .span = model->span,
        .diameter = d,
        .support_radius = model->support_radius,
        .nose_radius = model->nose_radius,
        .friction = model->friction,
        .EI = modulus * M_PI * pow(d, 4) / 64.0,
        .EA = modulus * M_PI * d * d / 4.0,
        .GA = model->section->shear_stiffness,
    };
}

static struct wb_three_point_bending *create(const struct wb_three_point_bending_model *model)
{
    struct wb_three_point_bending *bending = NULL;
    assert_int_equal(wb_three_point_bending_create(&bending, model), WB_OK);
    return bending;
}

/* Moves; fails if it does not converge. */
static struct wb_three_point_bending_point move(struct wb_three_point_bending *bending,
                                                double deflection)
{
    struct wb_three_point_bending_point point;
    assert_int_equal(wb_three_point_bending_move(bending, deflection, &point), WB_OK);
    if (point.end != WB_THREE_POINT_BENDING_CONVERGED)
        fail_msg("at %g m: %s", deflection, wb_three_point_bending_end_name(point.end));
    return point;
}

static void small_deflection_is_F_L3_over_48_EI(void **unused)
{
    (void)unused;
    struct wb_section section = elastic_section(1.0);
    struct wb_three_point_bending_model model = bench(&section);
    model.support_radius = model.nose_radius = 0.0;
    const struct shooting p = same(&model);
    const double flexibility = pow(span, 3) / (48.0 * p.EI) + span / (4.0 * p.GA);
    for (int whole = 0; whole < 2; whole++) {
        model.whole = whole;
        struct wb_three_point_bending *bending = create(&model);
        const double w = 1e-4 * span;
        assert_close_relative(move(bending, w).force * flexibility, w, 1e-4);
        wb_three_point_bending_destroy(bending);
    }
    wb_section_release(&section);
}

static double constant(void *context, double from_middle)
{
    (void)from_middle;
    return *(const double *)context;
}

/* Compares points up to a deflection of a third of the span in force and draw-in with shooting,
 * starting where friction has the direction of a wire being drawn in; counts the compared contacts
 * of each kind. */
struct compared {
    int points, wrapped, two_lines;
    double deepest; /* over the span */
    double worst;   /* deviation of the force */
};

static struct compared compare(struct wb_three_point_bending_model *model, struct shooting *p,
                               double natural, double tolerance)
{
    const double rn = p->nose_radius + 0.5 * p->diameter, r = p->support_radius + 0.5 * p->diameter;
    struct compared compared = {0};
    enum shooting_contact contact = SHOOTING_POINT;
    double u[4] = {0.5, 0.1, 0.0, 0.0};

    p->natural = natural;
    model->natural_curvature = natural != 0.0 ? constant : NULL;
    model->curvature_context = &natural;
    struct wb_three_point_bending *bending = create(model);
    const double rest = natural != 0.0 ? asin(0.5 * p->span / (1.0 / natural + r)) : 0.0;
    for (int i = 1; i < 200; i++) {
        struct shot shot;
        const double before[2] = {u[0], u[1]};
        bool found = shoot(p, rest + 0.02 * i, contact, u, &shot);
        const double curvature =
            natural + (p->curvature ? p->curvature(p->context, shot.moment) : shot.moment / p->EI);
        if (found && contact == SHOOTING_POINT && curvature > 1.0 / rn) {
            contact = SHOOTING_WRAPPED;
            u[0] = before[0];
            u[1] = before[1];
            u[2] = 0.02;
            found = shoot(p, rest + 0.02 * i, contact, u, &shot);
        }
        /* Only for a wire with high shear stiffness there are two lines of contact: see
         * shooting_miss(). */
        if (found && contact == SHOOTING_WRAPPED && shot.axial < 0.0 && p->GA > p->EA) {
            contact = SHOOTING_TWO_LINES;
            u[3] = shot.alpha * rn / p->span;
            found = shoot(p, rest + 0.02 * i, contact, u, &shot);
        }
        assert_true(found);
        if (shot.deflection > p->span / 3.0)
            break;
        const struct wb_three_point_bending_point point = move(bending, shot.deflection);
        const double phi = point.contact_angle;
        const double sliding =
            p->friction * 0.5 * point.force / (cos(phi) + p->friction * sin(phi));
        if (!(point.tension >= 0.9999 * sliding))
            continue; /* still at rest, or sliding outwards */
        if (!(fabs(point.force / shot.force - 1.0) <= tolerance))
            fail_msg("contact %d at %g of the span: %.8g N, by shooting %.8g N", (int)contact,
                     shot.deflection / p->span, point.force, shot.force);
        assert_close(point.draw_in, shot.draw_in, 2e-4 * p->span);
        assert_close(point.contact_angle, rest + 0.02 * i, 3e-4);
        compared.worst = fmax(compared.worst, fabs(point.force / shot.force - 1.0));
        compared.points++;
        compared.wrapped += contact == SHOOTING_WRAPPED;
        compared.two_lines += contact == SHOOTING_TWO_LINES;
        compared.deepest = shot.deflection / p->span;
    }
    wb_three_point_bending_destroy(bending);
    print_message("friction %g, natural curvature %g /m, rollers %g mm, nose %g mm: %d points up "
                  "to %.3f of the span, force within %.4f %%\n",
                  p->friction, natural, 1e3 * p->support_radius, 1e3 * p->nose_radius,
                  compared.points, compared.deepest, 100.0 * compared.worst);
    return compared;
}

static void large_deflection_and_moving_contacts_match_shooting(void **unused)
{
    (void)unused;
    struct wb_section section = elastic_section(1.0);
    static const struct {
        double friction, natural, support_radius;
    } cases[] = {{0.0, 0.0, 2e-3},   {0.3, 0.0, 2e-3},   {0.6, 0.0, 2e-3}, {0.3, 10.0, 2e-3},
                 {0.2, -10.0, 2e-3}, {0.3, 0.0, 0.1e-3}, {0.0, 0.0, 8e-3}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct wb_three_point_bending_model model = bench(&section);
        model.friction = cases[i].friction;
        model.support_radius = cases[i].support_radius;
        struct shooting p = same(&model);
        const struct compared c = compare(&model, &p, cases[i].natural, 3e-4);
        assert_true(c.points >= 30);
        assert_true(c.deepest > 0.32);
    }
    wb_section_release(&section);
}

/* A nose so large that the wire lies on it over two thirds of a radian and more. */
static void wrapping_matches_shooting(void **unused)
{
    (void)unused;
    static const double friction[] = {0.0, 0.2, 0.6};
    struct wb_section stiff = elastic_section(400.0), plain = elastic_section(1.0);

    for (int i = 0; i < 3; i++) {
        struct wb_three_point_bending_model model = bench(&stiff);
        model.nose_radius = 18e-3;
        model.friction = friction[i];
        struct shooting p = same(&model);
        const struct compared c = compare(&model, &p, 0.0, 1e-3);
        assert_true(c.wrapped + c.two_lines >= 20);
        /* Friction pulls the wire onto the nose; without it, the wire lifts off. */
        assert_true(i == 2 ? c.wrapped >= 20 : c.two_lines >= 20);
    }
    /* With the shear stiffness of a wire the contact extends over about (EI / GA)^1/2. */
    struct wb_three_point_bending_model model = bench(&plain);
    model.nose_radius = 18e-3;
    model.friction = 0.6;
    struct shooting p = same(&model);
    const struct compared c = compare(&model, &p, 0.0, 1e-3);
    assert_true(c.wrapped >= 20);
    wb_section_release(&stiff);
    wb_section_release(&plain);
}

/* Moment over curvature of a circle by strips, as a table. */
enum {
    TABLE = 4000
};

struct table {
    double most; /* curvature, 1/m */
    double moment[TABLE + 1];
};

static double table_curvature(const void *context, double moment)
{
    const struct table *table = context;
    const double wanted = fabs(moment);
    int low = 0, high = TABLE;
    assert_true(wanted <= table->moment[TABLE]);
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (table->moment[middle] <= wanted)
            low = middle;
        else
            high = middle;
    }
    const double share = (wanted - table->moment[low]) / (table->moment[high] - table->moment[low]);
    return copysign((low + share) * table->most / TABLE, moment);
}

static void elastoplastic_wire_matches_shooting(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(2);
    struct wb_law law;
    wb_law_init_ludwik(&law, &wire.material);
    struct wb_section section;
    /* Enough strips for a practically exact section. */
    assert_int_equal(wb_section_init_circle(&section, wire.diameter, &wire.material, 80), WB_OK);
    static struct table table = {.most = 500.0};
    for (int i = 0; i <= TABLE; i++) {
        enum {
            STRIPS = 400
        };
        const double curvature = table.most * i / TABLE, R = 0.5 * wire.diameter;
        for (int k = 0; k < STRIPS; k++) {
            const double a = 0.5 * M_PI * (k + 0.5) / STRIPS, y = R * sin(a);
            /* width times height of the strip, dy = R cos a da, both halves */
            const double area = 2.0 * R * cos(a) * R * cos(a) * 0.5 * M_PI / STRIPS;
            table.moment[i] += 2.0 * y * area * wb_law_virgin_stress(&law, y * curvature, NULL);
        }
    }
    struct wb_three_point_bending_model model = {.section = &section,
                                                 .diameter = wire.diameter,
                                                 .span = span,
                                                 .support_radius = 2e-3,
                                                 .nose_radius = 3e-3,
                                                 .friction = 0.2};
    struct shooting p = same(&model);
    p.EI = wire.material.youngs_modulus * M_PI * pow(wire.diameter, 4) / 64.0;
    p.EA = wire.material.youngs_modulus * M_PI * wire.diameter * wire.diameter / 4.0;
    p.curvature = table_curvature;
    p.context = &table;
    const struct compared c = compare(&model, &p, 0.0, 1e-3);
    assert_true(c.points >= 30);
    assert_true(c.deepest > 0.32);
    wb_section_release(&section);
}

static const double path[] = {0.01, 0.05, 0.1, 0.2, 0.3, 0.25, 0.15, 0.05, 0.1, 0.3};

enum {
    PATH = sizeof path / sizeof *path
};

static void half_model_agrees_with_the_whole(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(2);
    struct wb_section section = test_section(&wire);
    double natural = 5.0;
    struct wb_three_point_bending_model model = bench(&section);
    model.diameter = wire.diameter;
    model.nose_radius = 8e-3;
    model.friction = 0.3;
    model.n_elements = 40;
    model.natural_curvature = constant;
    model.curvature_context = &natural;
    struct wb_three_point_bending *half = create(&model);
    model.whole = true;
    struct wb_three_point_bending *whole = create(&model);
    for (int i = 0; i < PATH; i++) {
        const struct wb_three_point_bending_point a = move(half, path[i] * span);
        const struct wb_three_point_bending_point b = move(whole, path[i] * span);
        assert_close_relative(b.force, a.force, 2e-3);
        assert_close(b.draw_in, a.draw_in, 1e-4 * span);
        const double places[3] = {-0.4 * span, 0.0, 0.4 * span};
        double x[3], y[3], t[3];
        wb_three_point_bending_shape(whole, 3, places, x, y, t);
        assert_close(x[0], -x[2], 1e-7);
        assert_close(y[0], y[2], 1e-7);
        assert_close(t[0], -t[2], 1e-5);
    }
    wb_three_point_bending_destroy(half);
    wb_three_point_bending_destroy(whole);
    wb_section_release(&section);
}

/* More bent on the right than on the left; mirrored with a negative context. */
static double lopsided(void *context, double from_middle)
{
    return 6.0 + *(const double *)context * from_middle;
}

static void mirrored_bow_gives_the_mirrored_test(void **unused)
{
    (void)unused;
    struct wb_section section = elastic_section(1.0);
    double right = 300.0, left = -300.0, none = 0.0;
    struct wb_three_point_bending_model model = bench(&section);
    model.whole = true;
    model.n_elements = 40;
    model.friction = 0.2;
    model.natural_curvature = lopsided;
    model.curvature_context = &right;
    struct wb_three_point_bending *a = create(&model);
    model.curvature_context = &left;
    struct wb_three_point_bending *b = create(&model);
    model.curvature_context = &none;
    struct wb_three_point_bending *even = create(&model);
    for (int i = 0; i < 4; i++) {
        const double w = 0.05 * (i + 1) * span;
        const double places[2] = {-0.45 * span, 0.45 * span};
        double xa[2], ya[2], xb[2], yb[2];
        const double force = move(a, w).force;
        assert_close_relative(move(b, w).force, force, 1e-6);
        wb_three_point_bending_shape(a, 2, places, xa, ya, NULL);
        wb_three_point_bending_shape(b, 2, places, xb, yb, NULL);
        assert_close(xa[0], -xb[1], 1e-9);
        assert_close(ya[0], yb[1], 1e-9);
        assert_true(fabs(ya[0] - ya[1]) > 1e-6);
        assert_close_relative(move(even, w).force, force, 0.05);
    }
    wb_three_point_bending_destroy(a);
    wb_three_point_bending_destroy(b);
    wb_three_point_bending_destroy(even);
    wb_section_release(&section);
}

static void work_of_the_nose_is_stored_or_dissipated(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(2);
    struct wb_section section = test_section(&wire);
    struct wb_three_point_bending_model model = bench(&section);
    model.diameter = wire.diameter;
    model.friction = 0.3;
    model.nose_radius = 8e-3;
    struct wb_three_point_bending *bending = create(&model);
    struct wb_three_point_bending_point point = {0};
    double friction = 0.0, most = 0.0;
    for (int i = 1; i <= 200; i++) {
        point = move(bending, (i <= 120 ? i : 240 - i) * 0.0025 * span);
        assert_true(point.friction_work >= friction);
        friction = point.friction_work;
        most = fmax(most, point.work);
        assert_close(point.work, point.internal_work + point.friction_work, 2e-3 * most);
    }
    assert_true(friction > 0.05 * most);
    assert_true(point.internal_work > 0.1 * most); /* of which plastic */
    wb_three_point_bending_destroy(bending);
    wb_section_release(&section);
}

static void elastic_wire_without_friction_is_reversible(void **unused)
{
    (void)unused;
    struct wb_section section = elastic_section(1.0);
    struct wb_three_point_bending_model model = bench(&section);
    model.nose_radius = 18e-3;
    struct wb_three_point_bending *bending = create(&model);
    double force[31];
    for (int i = 1; i <= 30; i++)
        force[i] = move(bending, 0.01 * i * span).force;
    for (int i = 29; i >= 1; i--)
        assert_close_relative(move(bending, 0.01 * i * span).force, force[i], 1e-6);
    const struct wb_three_point_bending_point point = move(bending, -0.01 * span);
    assert_true(point.slack);
    assert_close(point.force, 0.0, 0.0);
    assert_close(wb_three_point_bending_contact_level(bending), 0.0, 1e-7 * span);
    wb_three_point_bending_destroy(bending);
    wb_section_release(&section);
}

static void bent_wire_stays_bent_and_is_touched_there_again(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(2);
    struct wb_section section = test_section(&wire);
    struct wb_three_point_bending_model model = bench(&section);
    model.diameter = wire.diameter;
    model.friction = 0.2;
    struct wb_three_point_bending *bending = create(&model);
    move(bending, 0.2 * span);
    struct wb_three_point_bending_point point = move(bending, 0.0);
    const double level = wb_three_point_bending_contact_level(bending);
    assert_true(point.slack);
    assert_true(level > 0.02 * span && level < 0.19 * span);
    assert_close(point.deflection, 0.0, 0.0);
    assert_true(move(bending, 0.9 * level).slack);
    point = move(bending, level + 0.01 * span);
    assert_false(point.slack);
    assert_true(point.force > 0.0);
    wb_three_point_bending_reset(bending);
    const double virgin = move(bending, 0.1 * span).force;
    struct wb_three_point_bending *other = create(&model);
    assert_close(move(other, 0.1 * span).force, virgin, 0.0);
    wb_three_point_bending_destroy(other);
    wb_three_point_bending_destroy(bending);
    wb_section_release(&section);
}

static void compliance_only_adds_to_the_travel(void **unused)
{
    (void)unused;
    struct wb_section section = elastic_section(1.0);
    struct wb_three_point_bending_model model = bench(&section);
    model.compliance = 1e-3;
    struct wb_three_point_bending *bending = create(&model);
    const struct wb_three_point_bending_point point = move(bending, 0.1 * span);
    assert_close(point.deflection, 0.1 * span, 0.0);
    assert_close(point.travel, 0.1 * span + 1e-3 * point.force, 1e-15);
    wb_three_point_bending_destroy(bending);
    wb_section_release(&section);
}

static void end_of_the_test_is_reported(void **unused)
{
    (void)unused;
    struct wb_section section = elastic_section(1.0);
    struct wb_three_point_bending_model model = bench(&section);
    struct wb_three_point_bending_point point;

    model.overhang = 0.01 * span;
    struct wb_three_point_bending *bending = create(&model);
    assert_int_equal(wb_three_point_bending_move(bending, 0.4 * span, &point), WB_OK);
    assert_int_equal(point.end, WB_THREE_POINT_BENDING_RAN_OFF);
    assert_true(point.deflection > 0.1 * span && point.deflection < 0.4 * span);
    assert_true(point.draw_in <= 0.01 * span && point.draw_in > 0.009 * span);
    wb_three_point_bending_destroy(bending);

    model.overhang = 0.0;
    model.nose_radius = 0.45 * span;
    bending = create(&model);
    assert_int_equal(wb_three_point_bending_move(bending, 0.4 * span, &point), WB_OK);
    assert_int_equal(point.end, WB_THREE_POINT_BENDING_PINCHED);
    assert_true(point.deflection > 0.05 * span);
    wb_three_point_bending_destroy(bending);
    wb_section_release(&section);
}

static void invalid_model_is_rejected(void **unused)
{
    (void)unused;
    struct wb_section section = elastic_section(1.0);
    struct wb_three_point_bending *bending = NULL;
    wb_log_set_sink(discard_message, NULL);
    for (int i = 0; i < 6; i++) {
        struct wb_three_point_bending_model model = bench(&section);
        double natural = 200.0;
        switch (i) {
        case 0:
            model.section = NULL;
            break;
        case 1:
            model.span = 0.0;
            break;
        case 2:
            model.nose_radius = -1e-3;
            break;
        case 3:
            model.friction = (double)NAN;
            break;
        case 4: /* a circle of 5 mm: it falls through */
            model.natural_curvature = constant;
            model.curvature_context = &natural;
            break;
        default:
            model.n_elements = -1;
            break;
        }
        assert_int_equal(wb_three_point_bending_create(&bending, &model), WB_ERR_ARGUMENT);
        assert_null(bending);
    }
    struct wb_three_point_bending_model model = bench(&section);
    struct wb_three_point_bending_point point;
    bending = create(&model);
    assert_int_equal(wb_three_point_bending_move(bending, (double)NAN, &point), WB_ERR_ARGUMENT);
    wb_three_point_bending_destroy(bending);
    wb_log_set_sink(NULL, NULL);
    wb_section_release(&section);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_deflection_is_F_L3_over_48_EI),
        cmocka_unit_test(large_deflection_and_moving_contacts_match_shooting),
        cmocka_unit_test(wrapping_matches_shooting),
        cmocka_unit_test(elastoplastic_wire_matches_shooting),
        cmocka_unit_test(half_model_agrees_with_the_whole),
        cmocka_unit_test(mirrored_bow_gives_the_mirrored_test),
        cmocka_unit_test(work_of_the_nose_is_stored_or_dissipated),
        cmocka_unit_test(elastic_wire_without_friction_is_reversible),
        cmocka_unit_test(bent_wire_stays_bent_and_is_touched_there_again),
        cmocka_unit_test(compliance_only_adds_to_the_travel),
        cmocka_unit_test(end_of_the_test_is_reported),
        cmocka_unit_test(invalid_model_is_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
