#include "fe/swept/swept_private.h"
#include "fe/swept/swept_step.h"

#include "fe/swept/swept_frequency.h"
#include "tests/fe/swept/swept_runs.h"

/* A short elastic wire of few elements. */
static struct swept_setup stub(enum wb_swept_hex_formulation formulation, double selective)
{
    struct swept_setup s = swept_type3(2, 0, 6, 3e-3);
    s.formulation = formulation;
    s.selective = selective;
    s.material.hardening = WB_HARDENING_NONE_ELASTIC;
    s.double_precision = true;
    return s;
}

static double *layer_of(const struct wb_swept_hex *hex, int n_nodes)
{
    double *K = calloc((size_t)(36 * n_nodes * n_nodes), sizeof *K);
    assert_non_null(K);
    wb_swept_frequency_layer(hex, K);
    return K;
}

static void layer_is_the_derivative_of_the_forces(void **unused)
{
    (void)unused;
    for (int f = 0; f < 2; f++) {
        struct wb_swept_section section = swept_distorted_section(1e-3);
        const struct wb_swept_hex_model model = {.section = &section,
                                                 .material = test_wire_type(3).material,
                                                 .n_elements = 1,
                                                 .element_length = 0.7e-3,
                                                 .formulation = (enum wb_swept_hex_formulation)f,
                                                 .double_precision = true};
        struct swept_body body = swept_body_create(&model);
        double *K = layer_of(body.hex, 9), worst = 0.0, largest = 0.0;
        for (int p = 0; p < 54; p++) {
            double *x = &body.position[swept_at(&body.layout, p / 3 % 9, p % 3, p / 27)];
            double slope[54];
            const double here = *x, d = 1e-9;
            for (int side = 0; side < 2; side++) {
                *x = here + (side ? d : -d);
                swept_forces(&body);
                for (int q = 0; q < 54; q++)
                    slope[q] =
                        (side ? slope[q] : 0.0) -
                        (side ? 1 : -1) * swept_force(&body, q / 3 % 9, q % 3, q / 27) / (2 * d);
            }
            *x = here;
            for (int q = 0; q < 54; q++) {
                worst = fmax(worst, fabs(slope[q] - K[54 * p + q]));
                largest = fmax(largest, fabs(K[54 * p + q]));
            }
        }
        assert_true(worst < 1e-6 * largest);
        free(K);
        swept_body_destroy(&body);
        wb_swept_section_release(&section);
    }
}

/* y = M'^-1 K x for the complete wire, from the layers; degrees of freedom (station n + node) 3 +
 * component. */
static void multiply(const struct swept_run *run, const double *K, double selective,
                     const double *x, double *y)
{
    const int n = run->section.n_nodes, layer = 6 * n, stations = run->body.layout.n_stations;
    memset(y, 0, (size_t)(3 * n * stations) * sizeof *y);
    for (int j = 0; j + 1 < stations; j++) {
        for (int p = 0; p < layer; p++) {
            for (int q = 0; q < layer; q++)
                y[3 * n * j + p] += K[layer * p + q] * x[3 * n * j + q];
        }
    }
    for (int j = 0; j < stations; j++) {
        const double mass = wb_swept_step_station_mass(run->step, j);
        for (int c = 0; c < 3; c++) {
            double mean = 0.0;
            for (int k = 0; k < n; k++)
                mean += y[3 * (n * j + k) + c] / mass;
            for (int k = 0; k < n; k++) {
                double *a = &y[3 * (n * j + k) + c];
                *a = mean + (*a / (mass * run->section.share[k]) - mean) / selective;
            }
        }
    }
}

/* The wire's largest frequency by power iteration of M'^-1 K, and its mode. */
static double largest_frequency(const struct swept_run *run, double selective, double *mode)
{
    const int n = 3 * run->section.n_nodes * run->body.layout.n_stations;
    double *K = layer_of(run->body.hex, run->section.n_nodes);
    double *y = malloc((size_t)n * sizeof *y), value = 0.0;
    uint64_t seed = 7;
    assert_non_null(y);
    for (int i = 0; i < n; i++)
        mode[i] = test_random(&seed) - 0.5;
    for (int power = 0; power < 4000; power++) {
        multiply(run, K, selective, mode, y);
        double norm = 0.0, before = 0.0;
        for (int i = 0; i < n; i++) {
            norm += y[i] * y[i];
            before += mode[i] * mode[i];
        }
        value = sqrt(norm / before);
        for (int i = 0; i < n; i++)
            mode[i] = y[i] / sqrt(norm);
    }
    free(y);
    free(K);
    return sqrt(value);
}

/* Largest displacement after steps of dt, starting in a mode with an amplitude of 1 pm. */
static double grown(struct swept_run *run, const double *mode, double dt, int steps)
{
    const int n = run->section.n_nodes;
    double worst = 0.0;
    swept_reference(&run->body);
    double *reference = swept_field(&run->body.layout);
    memcpy(reference, run->body.position, wb_swept_size(&run->body.layout) * sizeof *reference);
    for (int i = 0; i < 3 * n * run->body.layout.n_stations; i++) {
        const size_t at = swept_at(&run->body.layout, i / 3 % n, i % 3, i / 3 / n);
        run->body.position[at] += 1e-12 * mode[i];
        run->fields.velocity[at] = 0.0;
    }
    for (int step = 0; step < steps; step++)
        swept_advance(run, step == 0 ? 0.5 * dt : dt, dt, NULL);
    for (int i = 0; i < 3 * n * run->body.layout.n_stations; i++) {
        const size_t at = swept_at(&run->body.layout, i / 3 % n, i % 3, i / 3 / n);
        worst = fmax(worst, fabs(run->body.position[at] - reference[at]));
        worst = isfinite(run->body.position[at]) ? worst : (double)INFINITY;
    }
    free(reference);
    return worst;
}

static void step_is_stable_up_to_the_bound_and_not_far_above(void **unused)
{
    (void)unused;
    static const double selective[] = {1.0, 10.0, 100.0};
    for (int f = 0; f < 6; f++) {
        const struct swept_setup setup =
            stub((enum wb_swept_hex_formulation)(f % 2), selective[f / 2]);
        struct swept_run run;
        swept_run_init(&run, &setup);
        const int n = 3 * run.section.n_nodes * run.body.layout.n_stations;
        double *mode = malloc((size_t)n * sizeof *mode);
        assert_non_null(mode);
        const double omega = largest_frequency(&run, setup.selective, mode);
        print_message("selective %g, %s: omega %.4e, bound %.3f times\n", setup.selective,
                      f % 2 ? "one point" : "four points", omega, run.omega / omega);
        assert_true(omega <= run.omega * (1.0 + 1e-9));
        assert_true(run.omega < 1.2 * omega);
        assert_true(grown(&run, mode, 1.9999 / run.omega, 2000) < 1e-10);
        assert_true(grown(&run, mode, 1.998 / omega, 2000) < 1e-10);
        assert_true(grown(&run, mode, 2.004 / omega, 400) > 1e-9);
        free(mode);
        swept_run_release(&run);
    }
}

/* A single degree of freedom: only the axial motion of one end is free. Its stiffness is (lambda +
 * 2 mu) A / h, its mass half an element's. */
static void oscillator_has_the_frequency_of_central_differences(void **unused)
{
    (void)unused;
    struct swept_setup setup = stub(WB_SWEPT_HEX_FOUR_POINTS, 1.0);
    struct swept_run run;
    setup.elements = 1;
    setup.length = 1e-3;
    swept_run_init(&run, &setup);
    swept_hold(&run, 0, true);
    wb_swept_step_hold(run.step, 1, 1, true);
    wb_swept_step_hold(run.step, 1, 2, true);
    const double nu = setup.material.poissons_ratio, E = setup.material.youngs_modulus;
    const double modulus = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
    const double mass = setup.density * M_PI / 4 * 1.4e-3 * 1.4e-3 * 0.5e-3;
    const double omega = sqrt(modulus * run.section.area / 1e-3 / mass);
    const double dt = 1.2 / omega, turn = 2.0 * asin(0.5 * omega * dt);
    for (int k = 0; k < run.section.n_nodes; k++)
        run.body.position[swept_at(&run.body.layout, k, 0, 1)] += 1e-11;
    for (int step = 0; step < 2000; step++) {
        const double at = run.body.position[swept_at(&run.body.layout, 3, 0, 1)] - 1e-3;
        assert_close(at, 1e-11 * cos(turn * step), 2e-15);
        swept_advance(&run, step == 0 ? 0.5 * dt : dt, dt, NULL);
    }
    swept_run_release(&run);
}

struct motion {
    double momentum[3], angular[3];
};

static struct motion motion_of(const struct swept_run *run)
{
    struct motion m = {{0.0}, {0.0}};
    for (int j = 0; j < run->body.layout.n_stations; j++) {
        for (int k = 0; k < run->section.n_nodes; k++) {
            const double mass = wb_swept_step_station_mass(run->step, j) * run->section.share[k];
            double x[3], v[3];
            for (int i = 0; i < 3; i++) {
                x[i] = run->body.position[swept_at(&run->body.layout, k, i, j)];
                v[i] = *swept_velocity(run, k, i, j);
            }
            for (int i = 0; i < 3; i++) {
                m.momentum[i] += mass * v[i];
                m.angular[i] +=
                    mass * (x[(i + 1) % 3] * v[(i + 2) % 3] - x[(i + 2) % 3] * v[(i + 1) % 3]);
            }
        }
    }
    return m;
}

/* Rotates, translates and vibrates, elastic or plastic, in float and in double; and with selective
 * mass scaling, which changes the rotary inertia. */
static void free_body_conserves_momentum_and_energy(void **unused)
{
    (void)unused;
    for (int variant = 0; variant < 5; variant++) {
        const bool plastic = variant / 2 == 1, selective = variant == 4;
        struct swept_setup setup = stub(WB_SWEPT_HEX_FOUR_POINTS, selective ? 10.0 : 1.0);
        setup.double_precision = variant % 2 || selective;
        if (plastic)
            setup.material.hardening = WB_HARDENING_ISOTROPIC_POWER;
        struct swept_run run;
        uint64_t seed = 5;
        swept_run_init(&run, &setup);
        for (int k = 0; k < run.section.n_nodes; k++) {
            for (int j = 0; j < 7; j++) {
                const double y = run.section.node[k][0], x = (j - 3) * 0.5e-3;
                *swept_velocity(&run, k, 0, j) = 1.0 - 500.0 * y + 4.0 * (test_random(&seed) - 0.5);
                *swept_velocity(&run, k, 1, j) = 2.0 + 500.0 * x;
                *swept_velocity(&run, k, 2, j) = 0.5;
            }
        }
        /* Yielding within a step causes an error of first order in the step. */
        const double dt = (plastic ? 0.9 : 1.8) / run.omega;
        const int steps = selective ? 10000 : 100000;
        double first = 0.0, lowest = 1e30, highest = -1e30, kinetic = 0.0;
        struct motion begin = {{0.0}, {0.0}};
        for (int step = 0; step <= steps; step++) {
            const bool look = step == 1 || step % 1000 == 0;
            struct wb_swept_step_sums sums = {0};
            struct wb_swept_hex_sums strain = {0};
            const double times[2] = {step == 0 ? 0.5 * dt : dt, dt};
            swept_find_forces(&run.body, 0, run.blocks, look ? &strain : NULL);
            wb_swept_step_update(run.step, &run.fields, times, 0, run.blocks, look ? &sums : NULL);
            const double all = sums.kinetic + strain.stored + strain.artificial +
                               (look ? wb_swept_hex_plastic_work(run.body.state) : 0.0);
            if (step == 1) {
                begin = motion_of(&run);
                first = all;
                kinetic = sums.kinetic;
            }
            if (look && step > 0) {
                lowest = fmin(lowest, all);
                highest = fmax(highest, all);
            }
        }
        const struct motion end = motion_of(&run);
        double drift = 0.0, turn = 0.0;
        for (int i = 0; i < 3; i++) {
            drift =
                fmax(drift, fabs(end.momentum[i] - begin.momentum[i]) / fabs(begin.momentum[1]));
            turn = fmax(turn, fabs(end.angular[i] - begin.angular[i]) / fabs(begin.angular[2]));
        }
        print_message("%s %s: momentum %.1e, angular momentum %.1e, energy %+.1e %+.1e, plastic "
                      "%.2f of the first energy\n",
                      selective ? "selective"
                      : plastic ? "plastic"
                                : "elastic",
                      setup.double_precision ? "double" : "float", drift, turn,
                      lowest / first - 1.0, highest / first - 1.0,
                      wb_swept_hex_plastic_work(run.body.state) / first);
        assert_true(kinetic > 0.5 * first);
        assert_true(drift < (setup.double_precision ? 1e-12 : 1e-5));
        if (!selective)
            assert_true(turn < (variant % 2 ? 1e-11 : 1e-4));
        assert_true(fmax(highest - first, first - lowest) < (plastic ? 5e-3 : 1e-3) * first);
        if (plastic)
            assert_true(wb_swept_hex_plastic_work(run.body.state) > 0.01 * first);
        swept_run_release(&run);
    }
}

static void weight_is_not_scaled_with_the_mass(void **unused)
{
    (void)unused;
    struct swept_setup setup = stub(WB_SWEPT_HEX_FOUR_POINTS, 7.0);
    struct swept_run run;
    setup.mass_scaling = 25.0;
    setup.gravity[1] = -9.81;
    swept_run_init(&run, &setup);
    wb_swept_step_add_mass(run.step, 6, 1e-6);
    const double dt = 1e-7, wire = setup.density * M_PI / 4 * 1.4e-3 * 1.4e-3 * 3e-3;
    double scaled = 0.0, work = 0.0;
    struct wb_swept_step_sums sums = {0};
    for (int j = 0; j < 7; j++)
        scaled += wb_swept_step_station_mass(run.step, j);
    assert_close_relative(scaled, 25.0 * wire + 1e-6, 1e-12);
    for (int step = 0; step < 100; step++) {
        sums = (struct wb_swept_step_sums){0};
        swept_advance(&run, step == 0 ? 0.5 * dt : dt, dt, &sums);
        work += sums.gravity_work;
    }
    assert_close_relative(sums.momentum[1], -(wire + 1e-6) * 9.81 * 99.5 * dt, 1e-9);
    assert_close_relative(swept_mean(&run, run.fields.velocity, 1, 2), -9.81 / 25.0 * 99.5 * dt,
                          1e-3);
    /* Only rigid motion: strains are of the order of 1e-15. */
    double fallen = 0.0;
    for (int step = 0; step < 100; step++)
        fallen += (step + 0.5) * dt;
    assert_close_relative(work, (wire + 1e-6) * (wire + 1e-6) / scaled * 9.81 * 9.81 * fallen * dt,
                          0.2);
    swept_run_release(&run);
}

/* Random forces on one station: its mean acceleration is unchanged, the rest is beta times smaller;
 * fixed components keep their velocity. */
static void selective_scaling_keeps_the_mean_acceleration(void **unused)
{
    (void)unused;
    struct swept_setup setup = stub(WB_SWEPT_HEX_FOUR_POINTS, 1.0);
    double mean[2], beside[2], momentum[2];
    for (int scaled = 0; scaled < 2; scaled++) {
        struct swept_run run;
        struct wb_swept_step_sums sums = {0};
        uint64_t seed = 9;
        setup.selective = scaled ? 50.0 : 1.0;
        swept_run_init(&run, &setup);
        wb_swept_step_hold(run.step, 3, 2, true);
        double *force = run.body.force;
        for (int k = 0; k < run.section.n_nodes; k++) {
            for (int c = 0; c < 3; c++)
                force[swept_at(&run.body.layout, k, c, 3)] = test_random(&seed);
            *swept_velocity(&run, k, 2, 3) = 0.25;
        }
        const double times[2] = {1e-6, 1e-6};
        wb_swept_step_update(run.step, &run.fields, times, 0, run.blocks, &sums);
        mean[scaled] = swept_mean(&run, run.fields.velocity, 1, 3);
        beside[scaled] = *swept_velocity(&run, 5, 1, 3) - mean[scaled];
        momentum[scaled] = sums.momentum[1];
        double total = 0.0;
        for (int k = 0; k < run.section.n_nodes; k++) {
            total += force[swept_at(&run.body.layout, k, 1, 3)];
            assert_true(*swept_velocity(&run, k, 2, 3) == 0.25);
        }
        assert_close_relative(mean[scaled], total / wb_swept_step_station_mass(run.step, 3) * 1e-6,
                              1e-12);
        assert_close_relative(sums.momentum[1], total * 1e-6, 1e-12);
        assert_true(sums.momentum[2] == 0.0);
        swept_run_release(&run);
    }
    assert_close_relative(mean[1], mean[0], 1e-12);
    assert_close_relative(momentum[1], momentum[0], 1e-12);
    assert_close_relative(beside[1], beside[0] / 50.0, 1e-9);
}

/* nu = 0: plane waves. The bar hits a wall and stays until the wave returns. */
static void bar_impact_has_its_stress_and_contact_time(void **unused)
{
    (void)unused;
    struct swept_setup setup = swept_type3(2, 0, 200, 0.05);
    struct swept_run run;
    setup.material.hardening = WB_HARDENING_NONE_ELASTIC;
    setup.material.poissons_ratio = 0.0;
    swept_run_init(&run, &setup);
    /* The mesh has the circle's second moment but not its area: it has its own wave speed. */
    const double mass = setup.density * M_PI / 4 * 1.4e-3 * 1.4e-3;
    const double c = sqrt(setup.material.youngs_modulus * run.section.area / mass), v = 1.0;
    const double dt = 1.8 / run.omega;
    for (int k = 0; k < run.section.n_nodes; k++) {
        for (int j = 0; j <= 200; j++)
            *swept_velocity(&run, k, 0, j) = j == 0 ? 0.0 : -v;
    }
    swept_hold(&run, 0, true);
    double time = 0.0, pushed = 0.0, sum = 0.0, parted = 0.0;
    int n = 0;
    for (int step = 0; parted == 0.0 && time < 0.2 / c; step++) {
        swept_find_forces(&run.body, 0, run.blocks, NULL);
        pushed = 0.0;
        for (int k = 0; k < run.section.n_nodes; k++)
            pushed -= swept_force(&run.body, k, 0, 0);
        if (time > 0.3 * 0.1 / c && time < 0.9 * 0.1 / c) {
            sum += pushed;
            n++;
        }
        if (time > 0.05 / c && pushed < 0.0)
            parted = time;
        const double times[2] = {dt, dt};
        wb_swept_step_update(run.step, &run.fields, times, 0, run.blocks, NULL);
        time += dt;
    }
    swept_hold(&run, 0, false);
    for (int step = 0; step < 100; step++)
        swept_advance(&run, dt, dt, NULL);
    struct wb_swept_step_sums sums = {0};
    swept_advance(&run, dt, dt, &sums);
    print_message("stress %.4f of rho c v, contact %.4f of 2 L / c, rebound %.4f of v\n",
                  sum / n / (mass * c * v), parted / (0.1 / c), sums.momentum[0] / (mass * 0.05));
    assert_close_relative(sum / n, mass * c * v, 2e-3);
    assert_close_relative(parted, 0.1 / c, 1e-2);
    assert_close_relative(sums.momentum[0], mass * 0.05 * v, 1e-2);
    swept_run_release(&run);
}

/* Euler's first mode of a cantilever, 1 at the tip. */
static double first_mode(double s)
{
    const double b = 1.8751040687, r = (cosh(b) + cos(b)) / (sinh(b) + sin(b));
    return 0.5 * (cosh(b * s) - cos(b * s) - r * (sinh(b * s) - sin(b * s)));
}

/* A quarter of a period from the straight wire, with initial velocities of its first mode. */
static double cantilever_frequency(const struct swept_setup *setup)
{
    struct swept_run run;
    swept_run_init(&run, setup);
    const int last = setup->elements;
    swept_hold(&run, 0, true);
    for (int k = 0; k < run.section.n_nodes; k++) {
        for (int j = 1; j <= last; j++)
            *swept_velocity(&run, k, 1, j) = 0.1 * first_mode((double)j / last);
    }
    const double dt = 1.8 / run.omega;
    double before = 1.0, time = 0.0;
    for (int step = 0; step < 10000000; step++) {
        swept_advance(&run, dt, dt, NULL);
        time += dt;
        double now = 0.0;
        for (int j = 1; j <= last; j++)
            now += first_mode((double)j / last) * *swept_velocity(&run, 0, 1, j);
        /* The velocity is half a step behind. */
        if (now < 0.0) {
            time -= dt * (0.5 + now / (now - before));
            break;
        }
        before = now;
    }
    swept_run_release(&run);
    return 0.25 / time;
}

static void cantilever_has_its_first_frequency(void **unused)
{
    (void)unused;
    static const int meshes[][3] = {{2, 0, 40}, {2, 1, 40}};
    for (int i = 0; i < 4; i++) {
        struct swept_setup setup =
            swept_type3(meshes[i / 2][0], meshes[i / 2][1], meshes[i / 2][2], 0.085);
        setup.material.hardening = WB_HARDENING_NONE_ELASTIC;
        setup.formulation = (enum wb_swept_hex_formulation)(i % 2);
        setup.selective = 20.0;
        const double found = cantilever_frequency(&setup);
        print_message("%d x %d, %s: %.3f Hz\n",
                      meshes[i / 2][0] * (meshes[i / 2][0] + 4 * meshes[i / 2][1]),
                      meshes[i / 2][2], i % 2 ? "one point" : "four points", found);
        assert_close_relative(found, 25.87, 1e-2);
    }
}

/* Energy of a layer twisted like a circle, without warping; the section was scaled for bending. */
static void wire_twists_as_a_circle(void **unused)
{
    (void)unused;
    static const int meshes[][2] = {{2, 0}, {2, 1}, {6, 2}};
    static const double limits[] = {4e-2, 1e-2, 2e-3};
    for (int i = 0; i < 6; i++) {
        struct swept_setup setup = swept_type3(meshes[i / 2][0], meshes[i / 2][1], 80, 0.085);
        struct swept_run run;
        setup.formulation = (enum wb_swept_hex_formulation)(i % 2);
        swept_run_init(&run, &setup);
        const int n = run.section.n_nodes;
        double *K = layer_of(run.body.hex, n), *u = calloc((size_t)(6 * n), sizeof *u);
        double energy = 0.0;
        assert_non_null(u);
        for (int k = 0; k < n; k++) {
            u[3 * (n + k) + 1] = -run.section.node[k][1];
            u[3 * (n + k) + 2] = run.section.node[k][0];
        }
        for (int p = 0; p < 6 * n; p++) {
            for (int q = 0; q < 6 * n; q++)
                energy += 0.5 * u[p] * K[6 * n * p + q] * u[q];
        }
        const struct wb_material *m = &setup.material;
        const double G = m->youngs_modulus / (2 * (1 + m->poissons_ratio));
        const double J = M_PI * pow(setup.diameter, 4) / 32;
        assert_close_relative(2 * energy * run.model.element_length, G * J, limits[i / 2]);
        free(K);
        free(u);
        swept_run_release(&run);
    }
}

static void invalid_bodies_are_rejected(void **unused)
{
    (void)unused;
    const double mass[2] = {1.0, 2.0}, none[2] = {1.0, 0.0};
    const struct wb_swept_step_model good = {
        .layout = wb_swept_layout(2, 5), .node_mass = mass, .spacing = 1e-3};
    struct wb_swept_step *step;
    wb_log_set_sink(discard_message, NULL);
    for (int i = 0; i < 6; i++) {
        struct wb_swept_step_model m = good;
        if (i == 0)
            m.node_mass = none;
        if (i == 1)
            m.spacing = (double)NAN;
        if (i == 2)
            m.mass_scaling = -1.0;
        if (i == 3)
            m.selective = 0.5;
        if (i == 4)
            m.layout.n_stations = 1;
        if (i == 5)
            m.layout.stride = 5;
        assert_int_equal(wb_swept_step_create(&step, &m), WB_ERR_ARGUMENT);
        assert_null(step);
    }
    wb_log_set_sink(NULL, NULL);
    assert_int_equal(wb_swept_step_create(&step, &good), WB_OK);
    wb_swept_step_destroy(step);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layer_is_the_derivative_of_the_forces),
        cmocka_unit_test(step_is_stable_up_to_the_bound_and_not_far_above),
        cmocka_unit_test(oscillator_has_the_frequency_of_central_differences),
        cmocka_unit_test(free_body_conserves_momentum_and_energy),
        cmocka_unit_test(weight_is_not_scaled_with_the_mass),
        cmocka_unit_test(selective_scaling_keeps_the_mean_acceleration),
        cmocka_unit_test(bar_impact_has_its_stress_and_contact_time),
        cmocka_unit_test(cantilever_has_its_first_frequency),
        cmocka_unit_test(wire_twists_as_a_circle),
        cmocka_unit_test(invalid_bodies_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
