/* Tapes under load compared with closed forms: statics by dynamic relaxation, plastic flow, long
 * runs. */
#include "fe/material/hardening.h"
#include "fe/swept/swept_private.h"
#include "fe/swept/swept_step.h"
#include "tests/fe/swept/tapes.h"
#include "tests/twin/material_stress.h"

static const double E = 119e6, nu = 0.3, h = 0.2e-3;

/* --- statics --- */

/* Loads in addition to the tape's own forces (N), and fixed components: (3 n_nodes x stride), as
 * fields. */
struct statics {
    double *load, *load_moment;
    unsigned char *held, *held_director;
};

static struct statics statics_create(const struct test_tape *t)
{
    const size_t size = wb_swept_size(&t->layout);
    struct statics s = {swept_field(&t->layout), swept_field(&t->layout), calloc(size, 1),
                        calloc(size, 1)};
    assert_true(s.held && s.held_director);
    return s;
}

static void statics_destroy(struct statics *s)
{
    free(s->load);
    free(s->load_moment);
    free(s->held);
    free(s->held_director);
}

/* A step of one field, with velocities advanced by `kick`; returns its kinetic energy. */
struct motion {
    const double *mass;
    const void *force;
    const double *load;
    const unsigned char *held;
    double *x, *v;
};

static double move(const struct test_tape *t, const struct motion *field, double kick, double dt)
{
    double *x = field->x, *v = field->v, kinetic = 0.0;
    for (int k = 0; k < t->layout.n_nodes; k++) {
        for (int j = 0; j < t->layout.n_stations; j++) {
            const bool is_end = j == 0 || j == t->layout.n_stations - 1;
            const double m = field->mass[k] * t->model.spacing * (is_end ? 0.5 : 1.0);
            for (int i = 0; i < 3; i++) {
                const size_t at = swept_at(&t->layout, k, i, j);
                if (field->held[at])
                    continue;
                v[at] += kick * (tape_load(t, field->force, k, i, j) + field->load[at]) / m;
                x[at] += dt * v[at];
                kinetic += 0.5 * m * v[at] * v[at];
            }
        }
    }
    return kinetic;
}

/* Kinetic damping: motion is stopped whenever its energy has passed a maximum. */
static void relax(struct test_tape *t, const struct statics *s, int steps)
{
    const size_t size = wb_swept_size(&t->layout);
    double mass[64], inertia[64], bound = 0.0, before = 0.0;
    double *v = calloc(2 * size, sizeof *v);
    assert_non_null(v);
    wb_swept_tape_masses(t->tape, mass, inertia);
    assert_int_equal(wb_swept_tape_stiffness_per_mass(t->tape, &bound), WB_OK);
    const struct motion own = {mass, t->force, s->load, s->held, t->position, v};
    const struct motion turns = {inertia,          t->moment,   s->load_moment,
                                 s->held_director, t->director, v + size};
    /* Near the stable step the highest modes would be stopped in every third step, without end. */
    const double dt = 0.5 * 2.0 / sqrt(bound);
    bool at_rest = true;
    for (int i = 0; i < steps; i++) {
        /* From rest the next velocity is half a step ahead: a whole step would excite the highest
         * modes. */
        const double kick = at_rest ? 0.5 * dt : dt;
        (void)tape_forces(t);
        const double kinetic = move(t, &own, kick, dt) + move(t, &turns, kick, dt);
        at_rest = kinetic < before;
        if (at_rest)
            memset(v, 0, 2 * size * sizeof *v);
        before = at_rest ? 0.0 : kinetic;
    }
    (void)tape_forces(t);
    free(v);
}

/* Forces of a station on its supports: along an axis, and moment about z or x. */
static double station_force(const struct test_tape *t, int j, int i)
{
    double sum = 0.0;
    for (int k = 0; k < t->layout.n_nodes; k++)
        sum -= tape_load(t, t->force, k, i, j);
    return sum;
}

static double station_moment(const struct test_tape *t, int j, int axis)
{
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    double sum = 0.0;
    for (int k = 0; k < t->layout.n_nodes; k++) {
        double x[3], d[3];
        tape_get(&t->layout, t->position, k, j, x);
        tape_get(&t->layout, t->director, k, j, d);
        sum -= x[a] * tape_load(t, t->force, k, b, j) - x[b] * tape_load(t, t->force, k, a, j) +
               d[a] * tape_load(t, t->moment, k, b, j) - d[b] * tape_load(t, t->moment, k, a, j);
    }
    return sum;
}

static void hold_station(const struct test_tape *t, const struct statics *s, int j, int component)
{
    for (int k = 0; k < t->layout.n_nodes; k++)
        s->held[swept_at(&t->layout, k, component, j)] = 1;
}

static struct test_tape sleeve(int nodes, int stations, double radius, double spacing,
                               double winding)
{
    struct wb_swept_tape_model model = tape_model(&elastic_tape, nodes, stations, true, spacing);
    make_tube(&model, radius, winding, 1.0);
    return test_tape_create(&model);
}

static void pressure_widens_a_sleeve(void **unused)
{
    (void)unused;
    const double radius = 2.3e-3, pressure = 10.0, spacing = 0.5e-3;
    struct test_tape t = sleeve(20, 9, radius, spacing, 0.0);
    struct statics s = statics_create(&t);
    for (int k = 0; k < 20; k++) {
        for (int j = 0; j < 9; j++) {
            const double force = pressure * wb_swept_tape_area(t.tape, k, j);
            for (int i = 1; i < 3; i++)
                s.load[swept_at(&t.layout, k, i, j)] =
                    force * t.model.position[swept_at(&t.layout, k, i, j)] / radius;
        }
    }
    relax(&t, &s, 6000);
    const double hoop = pressure * radius / (E * h);
    double x[3], y[3];
    tape_get(&t.layout, t.position, 3, 4, x);
    assert_close_relative(hypot(x[1], x[2]) / radius - 1.0, hoop, 2e-3); /* (h / r)^2 / 12 */
    tape_get(&t.layout, t.position, 3, 0, x);
    tape_get(&t.layout, t.position, 3, 8, y);
    assert_close_relative((y[0] - x[0]) / (8 * spacing) - 1.0, -nu * hoop, 5e-3);
    statics_destroy(&s);
    test_tape_destroy(&t);
}

/* Force for a stretch of a sleeve, over E h times its circumference times the stretch. */
static double stretched(int nodes, int along, double winding)
{
    const double radius = 2.3e-3, spacing = 8e-3 / along, strain = 1e-5;
    struct test_tape t = sleeve(nodes, along + 1, radius, spacing, winding);
    struct statics s = statics_create(&t);
    for (int k = 0; k < nodes; k++) {
        for (int j = 0; j <= along; j++) {
            double x[3];
            tape_get(&t.layout, t.position, k, j, x);
            tape_put(&t.layout, t.position, k, j, x[0] * (1.0 + strain), x[1] * (1.0 - nu * strain),
                     x[2] * (1.0 - nu * strain));
        }
    }
    hold_station(&t, &s, 0, 0);
    hold_station(&t, &s, along, 0);
    relax(&t, &s, 3000);
    const double force = station_force(&t, along, 0);
    assert_close_relative(force, -station_force(&t, 0, 0), 1e-6);
    statics_destroy(&s);
    test_tape_destroy(&t);
    return force / (E * h * 2.0 * M_PI * radius * strain);
}

static void sleeve_in_tension_has_its_stiffness(void **unused)
{
    (void)unused;
    for (int nodes = 12; nodes <= 48; nodes *= 2) {
        const double polygon = nodes / M_PI * sin(M_PI / nodes);
        assert_close_relative(stretched(nodes, 16, 0.0), polygon, 1e-4); /* nu^2 (h / r)^2 / 12 */
    }
    /* With winding nodes the elements are skew and not flat. */
    const double coarse = 1.0 - stretched(16, 16, 0.15), fine = 1.0 - stretched(32, 32, 0.075);
    print_message("winding sleeve in tension: %.2e and %.2e short of E A\n", coarse, fine);
    assert_true(fabs(fine) < 3e-3 && fabs(fine) < 0.35 * fabs(coarse));
}

/* Bending moment of a sleeve over pi r^3 h E kappa. */
static double bent(int nodes, double hourglass)
{
    const double radius = 2.3e-3, spacing = 0.75e-3, kappa = 1e-3;
    struct wb_swept_tape_model model = tape_model(&elastic_tape, nodes, 33, true, spacing);
    make_tube(&model, radius, 0.0, 1.0);
    model.hourglass = hourglass;
    struct test_tape t = test_tape_create(&model);
    struct statics s = statics_create(&t);
    for (int k = 0; k < nodes; k++) {
        for (int j = 0; j < 33; j++) {
            /* Saint-Venant's displacements about the middle. */
            double X[3];
            tape_get(&t.layout, t.position, k, j, X);
            const double x = X[0] - 16 * spacing, y = X[1], z = X[2];
            tape_put(&t.layout, t.position, k, j, X[0] - kappa * x * y,
                     y + 0.5 * kappa * (x * x + nu * (y * y - z * z)), z + nu * kappa * y * z);
        }
    }
    hold_station(&t, &s, 0, 0);
    hold_station(&t, &s, 32, 0);
    relax(&t, &s, 3000);
    const double moment = station_moment(&t, 32, 2);
    statics_destroy(&s);
    test_tape_destroy(&t);
    return moment / (M_PI * radius * radius * radius * h * E * kappa);
}

static void sleeve_in_bending_has_its_stiffness(void **unused)
{
    (void)unused;
    const double coarse = 1.0 - bent(16, 0.1), fine = 1.0 - bent(32, 0.1);
    const double order = log2(coarse / fine);
    print_message("sleeve in bending: %.2e and %.2e short of E I, order %.2f\n", coarse, fine,
                  order);
    assert_true(fine > 0.0 && fine < 0.015);
    assert_true(order > 1.8 && order < 2.3);
    /* With a coefficient of 1 the hourglass stiffness fully replaces the bending that one point
     * neglects. */
    const double polygon = 16 / M_PI * sin(M_PI / 16) * pow(cos(M_PI / 16), 2);
    const double of_chords = 16 / M_PI * pow(sin(M_PI / 16), 3) / 3.0;
    assert_close(1.0 - coarse, polygon + 0.1 * of_chords, 2e-3);
    assert_close(bent(16, 1.0), polygon + of_chords, 2e-3);
}

static double twisted(int nodes)
{
    const double radius = 2.3e-3, spacing = 0.75e-3, rate = 1e-2;
    struct test_tape t = sleeve(nodes, 17, radius, spacing, 0.0);
    for (int k = 0; k < nodes; k++) {
        for (int j = 0; j < 17; j++) {
            const double angle = rate * spacing * j, c = cos(angle), s = sin(angle);
            double x[3];
            for (int f = 0; f < 2; f++) {
                double *field = f ? t.director : t.position;
                tape_get(&t.layout, field, k, j, x);
                tape_put(&t.layout, field, k, j, x[0], c * x[1] - s * x[2], s * x[1] + c * x[2]);
            }
        }
    }
    struct statics s = statics_create(&t);
    for (int i = 0; i < 3; i++) {
        hold_station(&t, &s, 0, i);
        hold_station(&t, &s, 16, i);
    }
    relax(&t, &s, 2000);
    const double torque = station_moment(&t, 16, 0);
    statics_destroy(&s);
    test_tape_destroy(&t);
    const double G = 0.5 * E / (1.0 + nu);
    const double wall = 1.0 + 0.25 * (h / radius) * (h / radius);
    return torque / (2.0 * M_PI * radius * radius * radius * h * wall * G * rate);
}

static void sleeve_in_torsion_has_its_stiffness(void **unused)
{
    (void)unused;
    const double coarse = 1.0 - twisted(16), fine = 1.0 - twisted(32);
    print_message("sleeve in torsion: %.2e and %.2e short of G J, order %.2f\n", coarse, fine,
                  log2(coarse / fine));
    assert_true(fine > 0.0 && fine < 0.015);
    assert_true(log2(coarse / fine) > 1.8 && log2(coarse / fine) < 2.2);
}

/* Deflection of a clamped strip's tip over P L^3 / (3 E I), with `along` elements along. */
static double strip(int along, double poisson, int sheets)
{
    const double length = 8e-3, width = 2e-3, force = 1e-8;
    struct wb_material law = elastic_tape;
    law.poissons_ratio = poisson;
    struct wb_swept_tape_model model = tape_model(&law, 3, along + 1, false, length / along);
    make_sheet(&model, length, width, 0.0);
    model.sheets = sheets;
    struct test_tape t = test_tape_create(&model);
    struct statics s = statics_create(&t);
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++) {
            s.held[swept_at(&t.layout, k, i, 0)] = i != 1 || k == 1;
            s.held_director[swept_at(&t.layout, k, i, 0)] = i != 1;
        }
        s.load[swept_at(&t.layout, k, 2, along)] = force * (k == 1 ? 0.5 : 0.25);
    }
    relax(&t, &s, 2000 * along * sheets);
    double x[3];
    tape_get(&t.layout, t.position, 1, along, x);
    statics_destroy(&s);
    test_tape_destroy(&t);
    const double thin = h / sheets, I = sheets * width * thin * thin * thin / 12.0;
    return x[2] / (force * length * length * length / (3.0 * E * I));
}

static void strip_bends_as_a_beam(void **unused)
{
    (void)unused;
    /* Shear deflects by 3 E h^2 / (4 L^2 kappa G) more, 1.1e-3 here with nu = 0. */
    const double shear = 0.25 * 2.0 / (5.0 / 6.0) * (h / 8e-3) * (h / 8e-3);
    const double coarse = 1.0 + shear - strip(4, 0.0, 1), fine = 1.0 + shear - strip(8, 0.0, 1);
    print_message("strip: tip %.2e and %.2e short, order %.2f\n", coarse, fine,
                  log2(coarse / fine));
    assert_true(fabs(fine) < 5e-3);
    assert_true(log2(coarse / fine) > 1.9 && log2(coarse / fine) < 2.1);
    /* Two sliding sheets: four times as soft. */
    assert_close(strip(8, 0.0, 2), 1.0 - fine, 2e-3);
    /* Free edges have anticlastic curvature: E I instead of E / (1 - nu^2), except at the clamp. */
    const double free_edges = strip(8, 0.3, 1);
    assert_true(free_edges > 0.965 && free_edges < 1.0);
}

static void strip_rolled_up_takes_its_moment(void **unused)
{
    (void)unused;
    /* A thin strip of plane strain rolled up to a radius of 2 mm, by three quarters of a turn. */
    const double thin = 0.01e-3;
    double error[2];
    for (int fine = 0; fine < 2; fine++) {
        const int along = fine ? 24 : 12;
        const double length = 9.42e-3, radius = 2e-3, width = 1e-3;
        struct wb_swept_tape_model model =
            tape_model(&elastic_tape, 2, along + 1, false, length / along);
        make_sheet(&model, length, width, 0.0);
        model.thickness = thin;
        struct test_tape t = test_tape_create(&model);
        const double step = length / along / radius, chord = length / along;
        const double outer = 0.5 * chord / sin(0.5 * step); /* so that sides keep their length */
        for (int k = 0; k < 2; k++) {
            for (int j = 0; j <= along; j++) {
                tape_put(&t.layout, t.position, k, j, outer * sin(step * j), k * width,
                         outer * (1.0 - cos(step * j)));
                tape_put(&t.layout, t.director, k, j, -sin(step * j), 0.0, cos(step * j));
            }
        }
        const struct wb_swept_tape_sums sums = tape_forces(&t);
        const double D = E * thin * thin * thin / (12.0 * (1.0 - nu * nu));
        error[fine] = sums.stored / (0.5 * D / (radius * radius) * length * width) - 1.0;
        test_tape_destroy(&t);
    }
    print_message("rolled strip: energy %.2e and %.2e off, order %.2f\n", error[0], error[1],
                  log2(error[0] / error[1]));
    assert_close_relative(error[0] / error[1], 4.0, 0.05);
    assert_true(fabs(error[1]) < 0.004);
}

/* --- plastic flow --- */

/* One square element of 1 mm at the logarithmic strains e1, e2 and the shear g = 2 e12 (small);
 * forces per width over h: nominal stresses. */
static void strain_element(struct test_tape *t, double e1, double e2, double shear)
{
    const double l1 = 1e-3 * exp(e1), l2 = 1e-3 * exp(e2), s = 0.5 * shear * 1e-3;
    for (int a = 0; a < 4; a++) {
        const double u = a % 2, v = a / 2;
        tape_put(&t->layout, t->position, a / 2, a % 2, l1 * u + s * v, l2 * v + s * u, 0.0);
    }
}

static struct test_tape element(const struct wb_material *material, bool is_double)
{
    struct wb_swept_tape_model model = tape_model(material, 2, 2, false, 1e-3);
    make_sheet(&model, 1e-3, 1e-3, 0.0);
    model.double_precision = is_double;
    return test_tape_create(&model);
}

/* Kirchhoff stresses along the axis and across. */
static void element_stress(const struct test_tape *t, double e1, double e2, double stress[2])
{
    stress[0] =
        -(tape_load(t, t->force, 0, 0, 1) + tape_load(t, t->force, 1, 0, 1)) / (1e-3 * h) * exp(e1);
    stress[1] =
        -(tape_load(t, t->force, 1, 1, 0) + tape_load(t, t->force, 1, 1, 1)) / (1e-3 * h) * exp(e2);
}

static void tension_follows_the_uniaxial_law(void **unused)
{
    (void)unused;
    /* Loading, unloading, compression; in one step or in many. */
    static const double way[3] = {0.05, 0.02, -0.03};
    for (int is_double = 0; is_double < 2; is_double++) {
        for (int steps = 1; steps <= 100; steps *= 100) {
            struct test_tape t = element(&tape_law, is_double);
            struct wb_material_state state = {0};
            double last = 0.0;
            for (int leg = 0; leg < 3; leg++) {
                double stress = 0.0, tangent, found[2];
                for (int i = 1; i <= steps; i++) {
                    const double e = last + (way[leg] - last) * i / steps;
                    wb_material_stress(&tape_law, e, &state, &state, &stress, &tangent);
                    /* The lateral plastic strain is minus half of the axial one. */
                    const double across = -nu * stress / E - 0.5 * state.plastic_strain;
                    strain_element(&t, e, across, 0.0);
                    (void)tape_forces(&t);
                    element_stress(&t, e, across, found);
                }
                last = way[leg];
                assert_close(found[0], stress, 2e-4 * 4e6);
                assert_close(found[1], 0.0, 2e-4 * 4e6);
                assert_close(wb_swept_tape_plastic_strain(t.state, 0, 0, 1),
                             state.accumulated_plastic_strain, 2e-6);
            }
            const double p = state.accumulated_plastic_strain;
            assert_close_relative(wb_swept_tape_plastic_work(t.state),
                                  (2.4e6 * p + 16.3e6 * pow(p, 1.73) / 1.73) * 1e-6 * h, 1e-4);
            test_tape_destroy(&t);
        }
    }
}

/* Bisection for p of slope p + law(p) = trial. */
static double plastic_strain_of(double slope, double trial)
{
    double low = 0.0, high = 1.0;
    for (int i = 0; i < 60; i++) {
        const double p = 0.5 * (low + high);
        if (slope * p + 2.4e6 + 16.3e6 * pow(p, 0.73) < trial)
            low = p;
        else
            high = p;
    }
    return low;
}

static void equal_biaxial_tension_follows_its_closed_form(void **unused)
{
    (void)unused;
    /* Each plastic strain is half the accumulated one: s = E / (1 - nu) (e - p / 2) = law(p). */
    const double e = 0.04, stiffness = E / (1.0 - nu);
    const double p = plastic_strain_of(0.5 * stiffness, stiffness * e);
    struct test_tape t = element(&tape_law, true);
    double found[2];
    strain_element(&t, e, e, 0.0);
    (void)tape_forces(&t);
    element_stress(&t, e, e, found);
    for (int i = 0; i < 2; i++)
        assert_close_relative(found[i], 2.4e6 + 16.3e6 * pow(p, 0.73), 2e-4);
    assert_close_relative(wb_swept_tape_plastic_strain(t.state, 0, 0, 0), p, 1e-4);
    test_tape_destroy(&t);
}

static void shear_follows_its_closed_form(void **unused)
{
    (void)unused;
    /* sqrt(3) G (g - sqrt(3) p) = law(p), with the angle g. */
    const double g = 0.06, G = 0.5 * E / (1.0 + nu);
    const double p = plastic_strain_of(3.0 * G, sqrt(3.0) * G * g);
    struct test_tape t = element(&tape_law, true);
    /* Equal and opposite stretches along the diagonals: no area change in the plane. */
    strain_element(&t, 0.5 * g, -0.5 * g, 0.0);
    double found[2];
    (void)tape_forces(&t);
    element_stress(&t, 0.5 * g, -0.5 * g, found);
    const double yield = 2.4e6 + 16.3e6 * pow(p, 0.73);
    assert_close_relative(found[0], yield / sqrt(3.0), 2e-4);
    assert_close_relative(found[1], -yield / sqrt(3.0), 2e-4);
    assert_close_relative(wb_swept_tape_plastic_strain(t.state, 0, 0, 0), p, 1e-4);
    test_tape_destroy(&t);
    /* The same along the sides: the measure 12. */
    struct test_tape u = element(&tape_law, true);
    strain_element(&u, 0.0, 0.0, g);
    (void)tape_forces(&u);
    assert_close_relative(wb_swept_tape_plastic_strain(u.state, 0, 0, 0), p, 2e-3);
    test_tape_destroy(&u);
}

static void laws_of_any_kind_are_reproduced(void **unused)
{
    (void)unused;
    /* Perfect plasticity, linear and steep hardening, Poisson's ratio zero and maximal. */
    static const double laws[][3] = {
        {0.0, 1.0, 0.3}, {50e6, 1.0, 0.0}, {300e6, 1.8, 0.5}, {6e6, 0.5, 0.45}};
    for (int l = 0; l < 4; l++) {
        const struct wb_material law = {
            WB_HARDENING_ISOTROPIC_POWER, E, laws[l][2], 2.4e6, laws[l][0], laws[l][1]};
        struct test_tape t = element(&law, true);
        struct wb_material_state state = {0};
        double stress = 0.0, tangent, found[2];
        for (int i = 1; i <= 3; i++) {
            wb_material_stress(&law, 0.02 * i, &state, &state, &stress, &tangent);
            const double across = -law.poissons_ratio * stress / E - 0.5 * state.plastic_strain;
            strain_element(&t, 0.02 * i, across, 0.0);
            (void)tape_forces(&t);
            element_stress(&t, 0.02 * i, across, found);
            assert_close(found[0], stress, 1e-3 * stress);
            assert_close(found[1], 0.0, 1e-3 * stress);
        }
        test_tape_destroy(&t);
    }
}

static void a_million_steps_end_in_the_same_state_as_one(void **unused)
{
    (void)unused;
    /* In single precision, to a strain of 6 %: increments are 1e-7 of the plastic strain. */
    const int steps = 1000000;
    struct test_tape slow = element(&tape_law, false), fast = element(&tape_law, false);
    double found[2], expected[2];
    for (int i = 1; i <= steps; i++) {
        const double e = 0.06 * i / steps;
        strain_element(&slow, e, -0.4 * e, 0.0);
        const struct wb_swept_tape_fields fields = {slow.position, slow.director, slow.force,
                                                    slow.moment};
        wb_swept_tape_forces(slow.state, &fields, 0, 1, NULL);
    }
    element_stress(&slow, 0.06, -0.024, found);
    for (int i = 1; i <= 300; i++) {
        strain_element(&fast, 0.06 * i / 300, -0.024 * i / 300, 0.0);
        (void)tape_forces(&fast);
    }
    element_stress(&fast, 0.06, -0.024, expected);
    const double p = wb_swept_tape_plastic_strain(slow.state, 0, 0, 1);
    print_message("a million steps: stress %.1e off, plastic strain %.1e\n",
                  found[0] / expected[0] - 1.0,
                  p / wb_swept_tape_plastic_strain(fast.state, 0, 0, 1) - 1.0);
    assert_close_relative(found[0], expected[0], 2e-3);
    assert_close_relative(p, wb_swept_tape_plastic_strain(fast.state, 0, 0, 1), 5e-3);
    test_tape_destroy(&slow);
    test_tape_destroy(&fast);
}

/* --- dynamics --- */

static struct wb_swept_step *step_of(const struct test_tape *t, const double *mass)
{
    const struct wb_swept_step_model model = {.layout = t->layout,
                                              .node_mass = mass,
                                              .spacing = t->model.spacing,
                                              .double_precision = t->model.double_precision};
    struct wb_swept_step *step = NULL;
    assert_int_equal(wb_swept_step_create(&step, &model), WB_OK);
    return step;
}

static void free_motion_conserves_energy_and_momentum(void **unused)
{
    (void)unused;
    for (int plastic = 0; plastic < 2; plastic++) {
        struct wb_swept_tape_model model =
            tape_model(plastic ? &tape_law : &elastic_tape, 16, 20, true, 1e-3);
        make_tube(&model, 2.3e-3, 0.0, 1.0);
        model.double_precision = false;
        struct test_tape t = test_tape_create(&model);
        double mass[16], inertia[16], bound = 0.0, first = 0.0, worst = 0.0, spin[2][3];
        double *v = swept_field(&t.layout), *w = swept_field(&t.layout);
        wb_swept_tape_masses(t.tape, mass, inertia);
        assert_int_equal(wb_swept_tape_stiffness_per_mass(t.tape, &bound), WB_OK);
        struct wb_swept_step *own = step_of(&t, mass), *turns = step_of(&t, inertia);
        /* Bending and ovalisation, fast enough to yield, and a rotation. */
        for (int k = 0; k < 16; k++) {
            for (int j = 0; j < 20; j++) {
                double x[3];
                tape_get(&t.layout, t.position, k, j, x);
                const double s = (x[0] - 9.5e-3) / 9.5e-3, speed = plastic ? 8.0 : 1.0;
                tape_put(&t.layout, v, k, j, 0.0, speed * (2.0 * s * s + 300.0 * x[2] * s),
                         speed * 200.0 * x[1] * s);
            }
        }
        const double dt = 0.8 * 2.0 / sqrt(bound);
        const struct wb_swept_step_fields fields = {t.position, v, t.force};
        const struct wb_swept_step_fields directors = {t.director, w, t.moment};
        double momentum[2][3];
        for (int i = 0; i < 4000; i++) {
            const double times[2] = {i == 0 ? 0.5 * dt : dt, dt};
            const struct wb_swept_tape_sums sums = tape_forces(&t);
            struct wb_swept_step_sums a = {0}, b = {0};
            if (i == 0 || i == 3999) {
                /* Angular momentum half a step later, with the positions there. */
                memset(spin[i > 0], 0, sizeof spin[0]);
            }
            wb_swept_step_update(own, &fields, times, 0, 2, &a);
            wb_swept_step_update(turns, &directors, times, 0, 2, &b);
            if (i == 0 || i == 3999) {
                memcpy(momentum[i > 0], a.momentum, sizeof a.momentum);
                for (int k = 0; k < 16; k++) {
                    for (int j = 0; j < 20; j++) {
                        const double length = t.model.spacing * (j % 19 == 0 ? 0.5 : 1.0);
                        double x[3], d[3], vx[3], vd[3];
                        tape_get(&t.layout, t.position, k, j, x);
                        tape_get(&t.layout, t.director, k, j, d);
                        tape_get(&t.layout, v, k, j, vx);
                        tape_get(&t.layout, w, k, j, vd);
                        for (int c = 0; c < 3; c++) {
                            const int e = (c + 1) % 3, f = (c + 2) % 3;
                            spin[i > 0][c] += length * (mass[k] * (x[e] * vx[f] - x[f] * vx[e]) +
                                                        inertia[k] * (d[e] * vd[f] - d[f] * vd[e]));
                        }
                    }
                }
            }
            if (i == 0) {
                first = a.kinetic_half + b.kinetic_half;
                continue;
            }
            const double energy = a.kinetic + b.kinetic + sums.stored + sums.artificial +
                                  (plastic ? wb_swept_tape_plastic_work(t.state) : 0.0);
            worst = fmax(worst, fabs(energy / first - 1.0));
        }
        print_message("%s: energy within %.1e, plastic work %.2f of it\n",
                      plastic ? "yielding" : "elastic", worst,
                      plastic ? wb_swept_tape_plastic_work(t.state) / first : 0.0);
        assert_true(worst < 0.01);
        assert_true(!plastic || wb_swept_tape_plastic_work(t.state) > 0.1 * first);
        for (int c = 0; c < 3; c++) {
            assert_close(momentum[1][c], momentum[0][c], 1e-4 * fabs(momentum[0][1]));
            assert_close(spin[1][c], spin[0][c],
                         1e-3 * (fabs(spin[0][0]) + fabs(spin[0][1]) + fabs(spin[0][2])));
        }
        wb_swept_step_destroy(own);
        wb_swept_step_destroy(turns);
        free(v);
        free(w);
        test_tape_destroy(&t);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pressure_widens_a_sleeve),
        cmocka_unit_test(sleeve_in_tension_has_its_stiffness),
        cmocka_unit_test(sleeve_in_bending_has_its_stiffness),
        cmocka_unit_test(sleeve_in_torsion_has_its_stiffness),
        cmocka_unit_test(strip_bends_as_a_beam),
        cmocka_unit_test(strip_rolled_up_takes_its_moment),
        cmocka_unit_test(tension_follows_the_uniaxial_law),
        cmocka_unit_test(equal_biaxial_tension_follows_its_closed_form),
        cmocka_unit_test(shear_follows_its_closed_form),
        cmocka_unit_test(laws_of_any_kind_are_reproduced),
        cmocka_unit_test(a_million_steps_end_in_the_same_state_as_one),
        cmocka_unit_test(free_motion_conserves_energy_and_momentum),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
