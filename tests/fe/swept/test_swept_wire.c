/* Slow: complete runs of one wire. */
#include "fe/swept/swept_private.h"
#include "fe/trial/cantilever.h"
#include "tests/fe/swept/swept_hex_twin.h"
#include "tests/fe/swept/swept_runs.h"

static double smooth_step(double t)
{
    return t * t * t * (10.0 - 15.0 * t + 6.0 * t * t);
}

/* Prescribes the mean height of the tip by a vertical force, which is returned: as a beam with
 * prescribed deflection. */
static double lead_tip(struct swept_run *run, double height, double dt)
{
    const int tip = run->model.n_elements;
    const double off = height - swept_mean(run, run->body.position, 1, tip);

    for (int k = 0; k < run->section.n_nodes; k++) {
        run->body.position[swept_at(&run->body.layout, k, 1, tip)] += off;
        *swept_velocity(run, k, 1, tip) += off / dt;
    }
    return wb_swept_step_station_mass(run->step, tip) * off / (dt * dt);
}

/* Type 3, L = 85 mm, to 53 mm: four points, few elements, compared with the fibre beam. Forces are
 * means over 15 ms, to remove waves along the wire, at the mean deflection. */
static void bent_wire_agrees_with_the_beam(void **unused)
{
    (void)unused;
    static const int meshes[][2] = {{2, 1}, {2, 0}};
    static const double limits[] = {0.5e-2, 3.5e-2};
    const struct test_wire wire = test_wire_type(3);
    struct wb_section section = test_section(&wire);
    struct wb_cantilever_model model;
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = 0.085;
    model.gravity_y = 0.0;

    for (int mesh = 0; mesh < 2; mesh++) {
        struct wb_cantilever *beam = test_cantilever(&model);
        struct swept_setup setup = swept_type3(meshes[mesh][0], meshes[mesh][1], 80, 0.085);
        struct swept_run run;
        setup.selective = 100.0;
        swept_run_init(&run, &setup);
        swept_hold(&run, 0, true);
        const double dt = 1.8 / run.omega, duration = 0.7, largest = 0.053;
        const int steps = (int)(duration / dt), window = (int)(0.015 / dt);
        double force = 0.0, height = 0.0, work = 0.0, before = 0.0;
        for (int step = 1; step <= steps; step++) {
            const double target = largest * smooth_step((double)step / steps);
            swept_advance(&run, dt, dt, NULL);
            const double now = lead_tip(&run, target, dt);
            force += now / window;
            height += target / window;
            work += now * (target - before);
            before = target;
            if (step % window != 0)
                continue;
            if (step > 0.3 * steps && step / window % 4 == 0) {
                const struct wb_cantilever_point point =
                    test_move(beam, WB_CONTROL_DEFLECTION, height);
                print_message("%2d elements: %5.2f mm %.5f N, beam %.5f N, ratio %.4f\n",
                              run.section.n_quads, height * 1e3, force, point.vertical_force,
                              force / point.vertical_force);
                if (height > 8e-3)
                    assert_close_relative(force, point.vertical_force, limits[mesh]);
            }
            force = height = 0.0;
        }
        const struct wb_swept_hex_sums sums = swept_forces(&run.body);
        const double plastic = wb_swept_hex_plastic_work(run.body.state);
        print_message(
            "stored %.3f, plastic %.3f, artificial %.4f of the work; largest strain %.3f\n",
            sums.stored / work, plastic / work, sums.artificial / work, sums.largest_strain);
        assert_close_relative(sums.stored + sums.artificial + plastic, work, 2e-3);
        assert_true(sums.artificial < 0.01 * work);
        assert_int_equal(sums.beyond_limit, 0);
        swept_run_release(&run);
        wb_cantilever_destroy(beam);
    }
}

/* The quarter of a circle's mesh where y and z are positive. */
static struct wb_swept_section quarter_of_circle(double diameter, int core, int rings)
{
    enum {
        MOST = 200
    };
    struct wb_swept_section full = swept_circle(diameter, core, rings), quarter;
    double at[MOST][2];
    int quad[MOST][4], number[MOST], nodes = 0, quads = 0;

    assert_true(full.n_nodes <= MOST);
    for (int k = 0; k < full.n_nodes; k++)
        number[k] = -1;
    for (int q = 0; q < full.n_quads; q++) {
        const int *corner = full.quad[q];
        double middle[2] = {0.0, 0.0};
        for (int i = 0; i < 8; i++)
            middle[i % 2] += full.node[corner[i / 2]][i % 2];
        if (middle[0] < 0.0 || middle[1] < 0.0)
            continue;
        for (int a = 0; a < 4; a++) {
            if (number[corner[a]] < 0) {
                number[corner[a]] = nodes;
                memcpy(at[nodes++], full.node[corner[a]], sizeof at[0]);
            }
            quad[quads][a] = number[corner[a]];
        }
        quads++;
    }
    assert_int_equal(
        swept_section_init(&quarter, nodes, (const double(*)[2])at, quads, (const int(*)[4])quad),
        WB_OK);
    wb_swept_section_release(&full);
    return quarter;
}

struct taylor {
    struct wb_swept_section section;
    struct wb_swept_hex_model model;
    struct twin twin;
    double *x, *v, *f, *node_mass;
    double omega;
};

static const double impact = 227.0, bar_density = 8930.0, bar_length = 32.4e-3;

static void taylor_create(struct taylor *bar)
{
    bar->section = quarter_of_circle(6.4e-3, 6, 1);
    const struct wb_swept_section *s = &bar->section;
    /* Scales the polygon's area to the circle's. */
    wb_swept_section_scale(&bar->section, sqrt(M_PI / 4 * 3.2e-3 * 3.2e-3 / s->area));
    bar->model = (struct wb_swept_hex_model){
        .section = s,
        .material = {WB_HARDENING_ISOTROPIC_POWER, 117e9, 0.35, 0.4e9, 0.1e9, 1.0},
        .n_elements = 60,
        .element_length = bar_length / 60,
        .formulation = WB_SWEPT_HEX_ONE_POINT,
        .double_precision = true};
    bar->twin = twin_create(&bar->model);
    const int n = s->n_nodes * 61;
    bar->x = calloc((size_t)(9 * n), sizeof *bar->x);
    bar->node_mass = calloc((size_t)s->n_nodes, sizeof *bar->node_mass);
    assert_true(bar->x && bar->node_mass);
    bar->v = bar->x + 3 * n;
    bar->f = bar->v + 3 * n;
    for (int i = 0; i < n; i++) {
        bar->x[3 * i] = i / s->n_nodes * bar->model.element_length;
        bar->x[3 * i + 1] = s->node[i % s->n_nodes][0];
        bar->x[3 * i + 2] = s->node[i % s->n_nodes][1];
        bar->v[3 * i] = i < s->n_nodes ? 0.0 : -impact;
    }
    struct wb_swept_hex *hex;
    for (int k = 0; k < s->n_nodes; k++)
        bar->node_mass[k] = bar_density * s->area * s->share[k];
    assert_int_equal(wb_swept_hex_create(&hex, &bar->model), WB_OK);
    assert_int_equal(wb_swept_frequency_bound(hex, bar->node_mass, 1.0, &bar->omega), WB_OK);
    wb_swept_hex_destroy(hex);
}

/* The shortest distance between stations, over its initial value: the stable step is proportional
 * to it. */
static double shortest(const struct taylor *bar)
{
    const int n = bar->section.n_nodes;
    double least = 1.0;
    for (int i = 0; i < 60 * n; i++) {
        double square = 0.0;
        for (int c = 0; c < 3; c++) {
            const double d = bar->x[3 * (i + n) + c] - bar->x[3 * i + c];
            square += d * d;
        }
        least = fmin(least, sqrt(square) / bar->model.element_length);
    }
    return least;
}

/* Advances velocities by `times[0]`, positions by `times[1]`, with the wall and the planes of
 * symmetry. Returns the kinetic energy. */
static double taylor_step(struct taylor *bar, const double times[2])
{
    const int n = bar->section.n_nodes;
    double kinetic = 0.0;
    for (int i = 0; i < 61 * n; i++) {
        const double half = i < n || i >= 60 * n ? 0.5 : 1.0;
        const double mass = bar->node_mass[i % n] * bar->model.element_length * half;
        for (int c = 0; c < 3; c++) {
            const bool held = c == 0 ? i < n : bar->section.node[i % n][c - 1] < 1e-9;
            if (held)
                continue;
            double *v = &bar->v[3 * i + c];
            const double before = *v;
            *v += times[0] * bar->f[3 * i + c] / mass;
            bar->x[3 * i + c] += times[1] * *v;
            kinetic += 0.5 * mass * before * *v;
        }
    }
    return kinetic;
}

/* Copper at 227 m/s, 80 us; the slow twin with its exact logarithm. */
static void taylor_bar_has_the_length_and_radius_of_the_literature(void **unused)
{
    (void)unused;
    struct taylor bar;
    taylor_create(&bar);
    const int n = bar.section.n_nodes;
    double time = 0.0, dt = 0.0, first = 0.0, last = 0.0;
    while (time < 80e-6) {
        const double next = 1.0 * 2.0 / bar.omega * shortest(&bar);
        const double times[2] = {0.5 * (dt + next), next};
        const struct twin_sums sums = twin_forces(&bar.twin, bar.x, bar.f);
        last = taylor_step(&bar, times) + sums.stored + sums.plastic + sums.artificial;
        first = first == 0.0 ? last : first;
        dt = next;
        time += dt;
    }
    double radius = 0.0, plastic = 0.0;
    for (int k = 0; k < n; k++)
        radius = fmax(radius, hypot(bar.x[3 * k + 1], bar.x[3 * k + 2]));
    for (int i = 0; i < 4 * 60 * bar.section.n_quads; i++)
        plastic = fmax(plastic, bar.twin.points[i].accumulated);
    const double length = bar.x[3 * 60 * n];
    print_message("length %.3f mm, radius %.3f mm, plastic strain %.2f, energy %.4f of the first\n",
                  length * 1e3, radius * 1e3, plastic, last / first);
    assert_true(length > 21.4e-3 && length < 21.5e-3);
    assert_true(radius > 6.9e-3 && radius < 7.1e-3);
    assert_true(plastic > 2.5 && plastic < 3.2);
    assert_close_relative(last, first, 1e-2);
    twin_destroy(&bar.twin);
    wb_swept_section_release(&bar.section);
    free(bar.x);
    free(bar.node_mass);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bent_wire_agrees_with_the_beam),
        cmocka_unit_test(taylor_bar_has_the_length_and_radius_of_the_literature),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
