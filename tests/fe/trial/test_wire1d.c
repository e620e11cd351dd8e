/* Wire models as 1D rods. */
#include "fe/trial/wire1d.h"

#include <stdlib.h>
#include <time.h>

#include "fe/trial/cantilever.h"
#include "tests/fe/rod/wires.h"

static struct wb_wire_model model;

static void read_model(const char *name)
{
    char path[4096];
    const char *source = getenv("WIREBENCH_SOURCE_ROOT");
    snprintf(path, sizeof path, "%s/fixtures/models/%s.yaml", source ? source : ".", name);
    assert_int_equal(wb_wire_model_read(&model, path), WB_OK);
}

/* Type 3 as one circle, with room for steps. */
static void make_type3(int n_steps)
{
    const struct test_wire wire = test_wire_type(3);
    model = (struct wb_wire_model){
        .length = 0.085,
        .is_homogenised = true,
        .n_parts = 1,
        .n_steps = n_steps,
        .part[0] = {.outer_diameter = wire.diameter,
                    .material = wire.material,
                    .density = wire.density},
    };
    for (int i = 0; i < n_steps; i++) {
        snprintf(model.step[i].name, sizeof model.step[i].name, "step%d", i + 1);
        model.step[i].rows = 5;
    }
}

/* A computed wire and its run. */
struct computed {
    struct wb_wire1d *wire;
    struct wb_wire_run run;
    double cpu; /* s */
};

static double cpu_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static struct computed compute(const struct wb_wire1d_settings *settings,
                               const struct wb_wire_observer *observer)
{
    struct computed c;
    assert_int_equal(wb_wire1d_create(&c.wire, &model, settings), WB_OK);
    assert_int_equal(wb_wire_run_init(&c.run, &model, 21), WB_OK);
    c.cpu = cpu_seconds();
    assert_int_equal(wb_wire1d_run(c.wire, &c.run, observer), WB_OK);
    c.cpu = cpu_seconds() - c.cpu;
    return c;
}

static void release(struct computed *c)
{
    wb_wire1d_destroy(c->wire);
    wb_wire_run_release(&c->run);
}

static const struct wb_wire_row *last_row(const struct computed *c)
{
    return &c->run.rows[c->run.n_rows - 1];
}

static void assert_complete(const struct computed *c)
{
    assert_string_equal(c->run.problem, "");
    assert_true(c->run.converged && !c->run.stopped);
    assert_int_equal(c->run.n_rows, wb_wire_run_planned_rows(&model));
    int increments = 0, iterations = 0;
    for (int i = 0; i < c->run.n_rows; i++) {
        increments += c->run.rows[i].increments;
        iterations += c->run.rows[i].iterations;
    }
    assert_int_equal(c->run.increments, increments);
    assert_true(c->run.iterations >= iterations);
}

static void solid_cylinder_gives_force_and_residual_deflection(void **unused)
{
    (void)unused;
    read_model("solid-cylinder-type3");
    struct computed c = compute(NULL, NULL);
    assert_complete(&c);
    const struct wb_wire_row *top = &c.run.rows[53], *end = last_row(&c);
    print_message("53 mm: %.6f N; released: %.4f mm; %d increments, %d iterations, %.0f ms\n",
                  top->tension, end->tip[1] / WB_MM, c.run.increments, c.run.iterations,
                  1e3 * c.cpu);
    /* With extrapolation an increment needs two or three iterations. */
    assert_true(c.run.iterations < 3 * c.run.increments);
    assert_close(top->tip[1], 0.053, 1e-9);
    assert_close_relative(top->tension, 0.155210, 1e-3);
    assert_close_relative(top->vertical_force, top->tension, 1e-15);
    assert_close(top->force, top->tension - c.run.rows[0].tension, 1e-15);
    assert_close(end->tip[1], 33.474 * WB_MM, 0.03 * WB_MM);
    assert_close(end->tension, 0.0, 1e-12);
    assert_true(c.run.rows[0].tension < 0.0);
    assert_int_equal(top->phase, WB_PHASE_LOAD);
    assert_int_equal(end->phase, WB_PHASE_UNLOAD);
    assert_int_equal(c.run.n_elements, 50);
    assert_int_equal(c.run.n_unknowns, 600);
    /* Its shape begins at the clamp and ends at the tip. */
    const double(*shape)[3] = (const double(*)[3])c.run.shape + 53 * 21;
    assert_close(shape[0][0], 0.0, 0.0);
    for (int k = 0; k < 3; k++)
        assert_close(shape[20][k], top->tip[k], 1e-15);
    release(&c);
}

/* Of the model, N m2. */
static double flexural_rigidity(void)
{
    const double diameter = model.part[model.n_parts - 1].outer_diameter;
    return wb_wire_model_youngs_modulus(&model) * M_PI / 64.0 * pow(diameter, 4.0);
}

static void elastic_follower_has_its_tip_and_outer_stress(void **unused)
{
    (void)unused;
    read_model("follower-8awg-elastic");
    struct computed c = compute(NULL, NULL);
    assert_complete(&c);
    const struct wb_wire_row *row = last_row(&c);
    print_message("24 N: %.4f, %.4f mm, %.4f degrees\n", row->tip[0] / WB_MM, row->tip[1] / WB_MM,
                  row->tip_angle * 180.0 / M_PI);
    assert_close_relative(row->tip[0], 97.3646 * WB_MM, 3e-4);
    assert_close_relative(row->tip[1], 20.7793 * WB_MM, 2e-3);
    assert_close_relative(row->tip_angle, 18.080 * M_PI / 180.0, 1e-3);
    assert_close(row->force, 24.0, 0.0);
    assert_close(row->tension, 24.0 * cos(row->tip_angle), 1e-9);
    assert_close(row->tangent[1], sin(row->tip_angle), 1e-12);

    /* At arc length s the follower's moment is F times the lever to the tip's line of action. */
    double position[3], frame[3][3];
    int n = 0;
    const double s = 3.26 * WB_MM;
    wb_wire1d_frame(c.wire, s, position, frame);
    const double lever = (row->tip[0] - position[0]) * cos(row->tip_angle) +
                         (row->tip[1] - position[1]) * sin(row->tip_angle);
    const double kappa = 24.0 * lever / flexural_rigidity();
    struct wb_wire1d_fibre *const fibres = wb_wire1d_section(c.wire, s, &n);
    assert_int_equal(n, 2 * 8 * 24);
    double moment = 0.0, outer = 0.0;
    for (int i = 0; i < n; i++) {
        const struct wb_wire1d_fibre *f = &fibres[i];
        const double area = 0.5 * (f->end_angle - f->begin_angle) *
                            (f->outer_radius * f->outer_radius - f->inner_radius * f->inner_radius);
        moment -= f->axial * f->y * area;
        if (f->part == 0)
            outer = fmax(outer, f->axial * 1.63e-3 / hypot(f->y, f->z));
        assert_close(f->plastic, 0.0, 0.0);
        assert_close(f->shear, 0.0, 1e3);
    }
    print_message("outer stress one diameter from the clamp: %.1f MPa\n", outer / 1e6);
    /* The section is that of the nearest point, up to 0.6 mm away. */
    assert_close_relative(moment, 24.0 * lever, 7e-3);
    assert_close_relative(outer, 68.2e9 * kappa * 1.63e-3, 1e-2);
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++) {
            double dot = 0.0;
            for (int k = 0; k < 3; k++)
                dot += frame[a][k] * frame[b][k];
            assert_close(dot, a == b ? 1.0 : 0.0, 1e-14);
        }
    }
    free(fibres);
    release(&c);
}

static void paper_histories_converge(void **unused)
{
    (void)unused;
    static const char *names[] = {"follower-8awg", "residual-1-8awg", "residual-2-8awg"};
    for (int i = 0; i < 3; i++) {
        read_model(names[i]);
        struct computed c = compute(NULL, NULL);
        assert_complete(&c);
        const struct wb_wire_row *row = last_row(&c);
        print_message("%s: tip %.3f, %.3f, %.3f mm, %.2f degrees; %d increments, %d iterations, "
                      "%.0f ms\n",
                      names[i], row->tip[0] / WB_MM, row->tip[1] / WB_MM, row->tip[2] / WB_MM,
                      row->tip_angle * 180.0 / M_PI, c.run.increments, c.run.iterations,
                      1e3 * c.cpu);
        /* It curls far beyond a right angle: the continuous angle only increases. */
        assert_true(row->tip_angle > 2.4 && row->tip_angle < 3.2);
        assert_close(row->loads.follower[1], 24.0, 0.0);
        for (int k = 0; k < 3; k++) {
            assert_close(row->loads.force[k], 0.0, 0.0);
            assert_close(row->loads.moment[k], 0.0, 0.0);
        }
        if (i > 0) {
            /* After force and moment in space: deflected out of the plane, with a residual
             * deflection. */
            const struct wb_wire_row *moment = &c.run.rows[10], *free_end = &c.run.rows[15];
            assert_close(moment->loads.moment[2], i == 1 ? 0.2 : 0.5, 0.0);
            assert_close(moment->loads.force[2], i == 1 ? 5.0 : 3.0, 0.0);
            assert_true(fabs(moment->tip[2]) > 1e-3);
            assert_true(fabs(free_end->tip[2]) < 0.1 * fabs(moment->tip[2]));
            assert_true(hypot(free_end->tip[1], free_end->tip[2]) > 1e-6);
            assert_close(free_end->tension, 0.0, 0.0);
            assert_int_equal(free_end->phase, WB_PHASE_UNLOAD);
            assert_int_equal(row->cycle, 2);
        }
        release(&c);
    }
}

static void longer_increments_change_little(void **unused)
{
    (void)unused;
    double tip[2][3];
    for (int k = 0; k < 2; k++) {
        read_model("residual-2-8awg");
        model.n_steps = 3;
        for (int i = 0; i < 3; i++)
            model.step[i].rows = k == 0 ? 5 : 50;
        struct computed c = compute(NULL, NULL);
        assert_complete(&c);
        memcpy(tip[k], last_row(&c)->tip, sizeof tip[k]);
        release(&c);
    }
    print_message("residual shape with 5 and 50 rows a step: y %.4f, %.4f, z %.4f, %.4f mm\n",
                  tip[0][1] / WB_MM, tip[1][1] / WB_MM, tip[0][2] / WB_MM, tip[1][2] / WB_MM);
    for (int k = 0; k < 3; k++)
        assert_close(tip[0][k], tip[1][k], 2e-6);
    assert_true(hypot(tip[0][1], tip[0][2]) > 4e-4);
}

static void strand_becomes_slack_and_taut_again(void **unused)
{
    (void)unused;
    make_type3(3);
    model.gravity[1] = -9.81;
    model.strand_length = 0.76;
    const double targets[] = {0.053, 0.0, 0.053};
    for (int i = 0; i < 3; i++) {
        model.step[i].kind = WB_WIRE_STEP_DEFLECTION;
        model.step[i].deflection = targets[i];
        model.step[i].rows = 20;
        model.step[i].unloads = i == 1;
    }
    const struct wb_wire1d_settings fine = {.n_rings = 12, .n_around = 48};
    struct computed c = compute(&fine, NULL);
    assert_complete(&c);

    struct wb_section section;
    struct wb_cantilever_model planar;
    assert_int_equal(wb_section_init_circle(&section, model.part[0].outer_diameter,
                                            &model.part[0].material, 400),
                     WB_OK);
    wb_cantilever_default_model(&planar);
    planar.section = &section;
    planar.length = model.length;
    planar.strand_length = 0.76;
    planar.mass_per_length = wb_wire_model_mass_per_length(&model);
    planar.gravity_y = -9.81;
    struct wb_cantilever *cantilever = test_cantilever(&planar);
    int slack = 0;
    double worst = 0.0, zero = 0.0;
    for (int i = 0; i < c.run.n_rows; i++) {
        const struct wb_wire_row *row = &c.run.rows[i];
        const int at = i <= 20 ? i : i <= 40 ? 40 - i : i - 40;
        const struct wb_cantilever_point p =
            test_move(cantilever, WB_CONTROL_DEFLECTION, 0.053 * at / 20.0);
        if (i == 0)
            zero = p.vertical_force;
        assert_int_equal(row->phase == WB_PHASE_SLACK, p.slack);
        if (!p.slack)
            assert_int_equal(row->phase, i > 20 && i <= 40 ? WB_PHASE_UNLOAD : WB_PHASE_LOAD);
        worst = fmax(worst, fabs(row->force - (p.vertical_force - zero)));
        worst = fmax(worst, fabs(row->tension - p.tension));
        assert_close(row->tip[1], p.deflection, 1e-6);
        assert_int_equal(row->cycle, i <= 40 ? 1 : 2);
        slack += p.slack;
    }
    print_message("strand: %.2g N, %d rows slack\n", worst, slack);
    assert_true(slack > 5);
    assert_true(worst < 1e-4 * 0.15);
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
    release(&c);
}

static void rows_before_a_limit_load_are_kept(void **unused)
{
    (void)unused;
    make_type3(2);
    struct wb_material *m = &model.part[0].material;
    *m = (struct wb_material){WB_HARDENING_ISOTROPIC_POWER, 68.2e9, 0.34, 182e6, 0.0, 1.0};
    const double R = 0.7e-3, limit = 2.0 / 3.0 * M_PI * 182e6 / sqrt(3.0) * R * R * R;
    model.step[0].loads.force[1] = 0.1;
    model.step[1].loads = model.step[0].loads;
    model.step[1].loads.moment[0] = 1.5 * limit;
    model.step[1].rows = 10;
    struct computed c = compute(&(struct wb_wire1d_settings){.n_elements = 12}, NULL);
    print_message("%s\n", c.run.problem);
    assert_false(c.run.converged);
    assert_false(c.run.stopped);
    /* All rows of the first step, and those of the second below the limit. */
    assert_int_equal(c.run.n_rows, 1 + 5 + 6);
    assert_close(last_row(&c)->loads.moment[0], 0.9 * limit, 1e-9);
    assert_non_null(strstr(c.run.problem, "step 'step2', row 7"));
    assert_true(c.run.cutbacks > 0);
    release(&c);
}

struct observed {
    int increments, rows, last_rows, stop_after;
    double done, fraction;
    bool grows;
};

static bool on_increment(void *context, const struct wb_wire_run *run, int step, double fraction,
                         int iterations, double done)
{
    struct observed *observed = context;
    (void)run, (void)iterations;
    observed->increments++;
    observed->grows = observed->grows && done >= observed->done && done <= 1.0;
    observed->grows = observed->grows && fraction >= 0.0 && fraction <= 1.0 && step < model.n_steps;
    observed->done = done;
    observed->fraction = fraction;
    return observed->increments != observed->stop_after;
}

static enum wb_status on_row(void *context, const struct wb_wire_run *run, bool last)
{
    struct observed *observed = context;
    observed->rows++;
    observed->last_rows += last;
    return run->n_rows == observed->rows ? WB_OK : WB_ERR_DATA;
}

static void a_strut_ends_before_it_buckles(void **unused)
{
    (void)unused;
    make_type3(1);
    model.is_elastic = true;
    model.part[0].material.hardening = WB_HARDENING_NONE_ELASTIC;
    const double EI = flexural_rigidity();
    const double P = M_PI * M_PI / 4.0 * EI / (model.length * model.length);
    model.step[0].loads.force[0] = -2.1 * P;
    model.step[0].rows = 10;
    struct computed c = compute(NULL, NULL);
    print_message("strut: %d rows; %s\n", c.run.n_rows, c.run.problem);
    assert_false(c.run.converged);
    /* Rows 4 and 5 are 0.84 and 1.05 of Euler's load. */
    assert_int_equal(c.run.n_rows, 5);
    assert_non_null(strstr(c.run.problem, "step 'step1', row 5 (0.76"));
    assert_non_null(strstr(c.run.problem, "a limit load or a buckling load"));
    release(&c);

    /* With a lateral load it bends instead. */
    model.step[0].loads.force[1] = 0.1 * P;
    c = compute(NULL, NULL);
    assert_complete(&c);
    assert_true(last_row(&c)->tip[0] < 0.1 * model.length);
    release(&c);
}

static void observer_is_called_and_can_stop(void **unused)
{
    (void)unused;
    struct observed observed = {.grows = true};
    const struct wb_wire_observer observer = {on_increment, on_row, &observed};
    make_type3(2);
    model.step[0].loads.force[2] = 0.1;
    model.step[1].loads.follower[0] = 0.05;
    model.step[1].loads.follower[1] = 0.1;
    struct computed c = compute(&(struct wb_wire1d_settings){10, 4, 8}, &observer);
    assert_complete(&c);
    assert_int_equal(observed.rows, 11);
    assert_int_equal(observed.last_rows, 2);
    assert_int_equal(observed.increments, c.run.increments);
    assert_true(observed.grows);
    assert_close(observed.done, 1.0, 1e-12);
    double position[3], frame[3][3];
    wb_wire1d_frame(c.wire, 0.085, position, frame);
    assert_close(last_row(&c)->tension, 0.05 * frame[0][1] + 0.1 * frame[1][1], 1e-12);
    assert_memory_equal(position, last_row(&c)->tip, sizeof position);
    assert_true(frame[0][1] > 0.3);
    release(&c);

    observed = (struct observed){.grows = true, .stop_after = 4};
    c = compute(&(struct wb_wire1d_settings){10, 4, 8}, &observer);
    assert_true(c.run.stopped && c.run.converged);
    assert_int_equal(c.run.increments, 4);
    assert_int_equal(observed.increments, 4);
    assert_true(c.run.n_rows < 11);
    assert_string_equal(c.run.problem, "");
    release(&c);
}

static void a_second_run_starts_from_the_virgin_state(void **unused)
{
    (void)unused;
    make_type3(1);
    model.step[0].loads.force[1] = 0.15;
    model.step[0].loads.moment[0] = 1e-3;
    struct computed c = compute(NULL, NULL);
    struct wb_wire_run again;
    assert_int_equal(wb_wire_run_init(&again, &model, 0), WB_OK);
    assert_int_equal(wb_wire1d_run(c.wire, &again, NULL), WB_OK);
    assert_int_equal(again.n_rows, c.run.n_rows);
    for (int i = 0; i < again.n_rows; i++)
        assert_memory_equal(again.rows[i].tip, c.run.rows[i].tip, sizeof again.rows[i].tip);
    wb_wire_run_release(&again);
    release(&c);
}

static void invalid_wires_are_rejected(void **unused)
{
    (void)unused;
    struct wb_wire1d *wire = NULL;
    make_type3(1);
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_wire1d_create(&wire, &model, &(struct wb_wire1d_settings){-1, 0, 0}),
                     WB_ERR_ARGUMENT);
    assert_int_equal(wb_wire1d_create(&wire, &model, &(struct wb_wire1d_settings){0, 0, 7}),
                     WB_ERR_ARGUMENT);
    model.gravity[1] = (double)NAN;
    assert_int_equal(wb_wire1d_create(&wire, &model, NULL), WB_ERR_ARGUMENT);
    model.gravity[1] = 0.0;
    model.length = -1.0;
    assert_int_equal(wb_wire1d_create(&wire, &model, NULL), WB_ERR_ARGUMENT);
    assert_null(wire);
    /* A load that is not finite is an error, not a row. */
    make_type3(1);
    model.step[0].loads.force[1] = (double)NAN;
    struct wb_wire_run run;
    assert_int_equal(wb_wire1d_create(&wire, &model, NULL), WB_OK);
    assert_int_equal(wb_wire_run_init(&run, &model, 0), WB_OK);
    assert_int_equal(wb_wire1d_run(wire, &run, NULL), WB_ERR_ARGUMENT);
    assert_int_equal(run.n_rows, 1);
    wb_wire_run_release(&run);
    wb_wire1d_destroy(wire);
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solid_cylinder_gives_force_and_residual_deflection),
        cmocka_unit_test(elastic_follower_has_its_tip_and_outer_stress),
        cmocka_unit_test(paper_histories_converge),
        cmocka_unit_test(longer_increments_change_little),
        cmocka_unit_test(strand_becomes_slack_and_taut_again),
        cmocka_unit_test(rows_before_a_limit_load_are_kept),
        cmocka_unit_test(a_strut_ends_before_it_buckles),
        cmocka_unit_test(observer_is_called_and_can_stop),
        cmocka_unit_test(a_second_run_starts_from_the_virgin_state),
        cmocka_unit_test(invalid_wires_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
