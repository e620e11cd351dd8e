/* The engine reads our card: its chain under a force agrees with our elastic beam, with the order
 * of the midpoint rule, and is stable up to the time step stated in the card. */
#include "base/file.h"
#include "fe/trial/cantilever.h"
#include "tests/analysis/cards/mujoco_rest.h"
#include "tests/analysis/cards/wires.h"
#include "tests/own_folder.h"

#define LENGTH 0.085

enum {
    MOST = 64 /* most joints for Newton's method */
};

struct engine {
    mjModel *model;
    mjData *data;
    double largest_step; /* s, as stated in the card */
};

static struct engine start(const struct wb_card_settings *settings)
{
    const struct wb_card_source source = source_of(PROPERTIES);
    struct wb_text card = card_of("mujoco", &source, settings);
    struct engine engine;
    char path[WB_PATH], problem[500] = "";
    assert_int_equal(wb_file_join(path, folder, "wire.xml"), WB_OK);
    assert_int_equal(wb_file_write_text(path, &card), WB_OK);
    engine.model = mj_loadXML(path, NULL, problem, sizeof problem);
    if (!engine.model)
        fail_msg("%s", problem);
    const char *const stated = strstr(wb_text_string(&card), "without damping): ");
    assert_non_null(stated);
    assert_int_equal(sscanf(stated, "without damping): %lf", &engine.largest_step), 1);
    engine.data = mj_makeData(engine.model);
    assert_non_null(engine.data);
    wb_text_release(&card);
    return engine;
}

static void stop(struct engine *engine)
{
    mj_deleteData(engine->data);
    mj_deleteModel(engine->model);
}

static struct wb_card_settings settings_of(int segments)
{
    struct wb_card_settings settings = card_defaults();
    settings.segments = segments;
    settings.length = LENGTH;
    return settings;
}

/* --- at rest --- */

/* Residual of the springs and of a force at the tip, for the joints' angles. */
static void find_residual(const void *force, const mjModel *m, mjData *d, double *residual)
{
    static double jacobian[3 * 3 * MOST];
    mj_forward(m, d);
    mj_jacSite(m, d, jacobian, NULL, 0);
    for (int i = 0; i < m->nv; i++) {
        residual[i] = d->qfrc_passive[i];
        for (int k = 0; k < 3; k++)
            residual[i] += jacobian[k * m->nv + i] * ((const double *)force)[k];
    }
}

/* The tip, m, of the engine's chain under a transverse force along an axis. */
static void engine_tip(int segments, double force, int axis, double tip[3])
{
    const struct wb_card_settings settings = settings_of(segments);
    struct engine engine = start(&settings);
    double vector[3] = {0.0};
    assert_true(engine.model->nv == 3 * segments && segments <= MOST);
    for (int i = 0; i < 3; i++)
        engine.model->opt.gravity[i] = 0.0;
    vector[axis] = force;
    for (int step = 1; step <= 4; step++) {
        const double part[3] = {0.25 * step * vector[0], 0.25 * step * vector[1],
                                0.25 * step * vector[2]};
        mujoco_rest(engine.model, engine.data, 1e-12, find_residual, part);
    }
    for (int k = 0; k < 3; k++)
        tip[k] = engine.data->site_xpos[k];
    stop(&engine);
}

static void beam_tip(double force, double *x, double *y)
{
    const struct wb_card_source source = source_of(PROPERTIES);
    struct wb_material elastic = source.properties.material;
    struct wb_section section;
    struct wb_cantilever_model model;
    struct wb_cantilever_point point;
    struct wb_cantilever *cantilever;
    elastic.hardening = WB_HARDENING_NONE_ELASTIC;
    assert_int_equal(
        wb_section_init_circle(&section, source.properties.outer_diameter, &elastic, 100), WB_OK);
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = LENGTH;
    model.gravity_y = 0.0;
    assert_int_equal(wb_cantilever_create(&cantilever, &model, NULL), WB_OK);
    assert_int_equal(wb_cantilever_move(cantilever, WB_CONTROL_DEAD_FORCE, force, &point), WB_OK);
    assert_int_equal(point.end, WB_CANTILEVER_CONVERGED);
    *x = point.tip_x;
    *y = point.deflection;
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
}

/* Forces for a small deflection, and for half the wire's length. */
static const double forces[] = {0.02, 0.15};

static void ten_segments_agree_with_the_beam_within_half_a_percent(void **state)
{
    (void)state;
    for (size_t i = 0; i < WB_COUNT(forces); i++) {
        double x, y;
        beam_tip(forces[i], &x, &y);
        for (int axis = 1; axis <= 2; axis++) {
            double tip[3];
            engine_tip(10, forces[i], axis, tip);
            print_message(
                "    %.2f N along %c: tip %.4f mm, beam %.4f mm, %+.5f; x %.4f, %.4f mm\n",
                forces[i], 'x' + axis, tip[axis] / WB_MM, y / WB_MM, tip[axis] / y - 1.0,
                tip[0] / WB_MM, x / WB_MM);
            assert_close_relative(tip[axis], y, 5e-3);
            assert_close(tip[0], x, 5e-3 * y);
        }
    }
    double x, y;
    beam_tip(forces[1], &x, &y);
    assert_true(y > 0.4 * LENGTH);
}

/* The beam has a little shear and the chain has none, so the tips of chains are compared. */
static void the_error_falls_with_the_square_of_the_segments(void **state)
{
    (void)state;
    double tips[4];
    for (int i = 0; i < 4; i++) {
        double tip[3];
        engine_tip(5 << i, forces[1], 2, tip);
        tips[i] = tip[2];
        print_message("    %2d segments: tip %.5f mm\n", 5 << i, tip[2] / WB_MM);
    }
    assert_close(log2((tips[1] - tips[0]) / (tips[2] - tips[1])), 2.0, 0.1);
    assert_close(log2((tips[2] - tips[1]) / (tips[3] - tips[2])), 2.0, 0.03);
}

static void a_twist_hinge_turns_by_the_stated_torsion(void **state)
{
    (void)state;
    const struct wb_card_settings settings = settings_of(10);
    struct engine engine = start(&settings);
    const struct wb_card_source source = source_of(PROPERTIES);
    const double GJ = wb_card_source_rigidity(&source).value / 1.39;
    double angle = 0.0;
    const double moment = 1e-4;
    for (int j = 0; j < engine.model->njnt; j++) {
        const double *const axis = &engine.model->jnt_axis[3 * j];
        if (axis[0] == 1.0)
            angle += moment / engine.model->jnt_stiffness[j];
    }
    assert_close_relative(angle, moment * LENGTH / GJ, 1e-6);
    stop(&engine);
}

/* --- in motion --- */

/* rad: far above the initial angle, and below the angle at which the engine resets itself. */
#define UNSTABLE 1e-2

/* Largest angle during the steps of the undamped chain with a small initial bend and twist. */
static double run(struct engine *engine, double step, int steps)
{
    mjModel *const m = engine->model;
    mjData *const d = engine->data;
    double largest = 0.0;
    mj_resetData(m, d);
    m->opt.timestep = step;
    for (int i = 0; i < 3; i++)
        m->opt.gravity[i] = 0.0;
    for (int i = 0; i < m->nv; i++) {
        m->dof_damping[i] = 0.0;
        d->qpos[i] = (i % 2 ? 1e-6 : -1e-6) * (1 + i % 5);
    }
    for (int k = 0; k < steps && largest < UNSTABLE; k++) {
        mj_step(m, d);
        for (int i = 0; i < m->nv; i++)
            largest = fmax(largest, fabs(d->qpos[i]));
    }
    return largest;
}

static void the_stated_time_step_is_the_largest_stable_one(void **state)
{
    (void)state;
    const struct wb_card_settings settings = settings_of(10);
    struct engine engine = start(&settings);
    const double chosen = engine.model->opt.timestep;
    const double below = run(&engine, 0.98 * engine.largest_step, 2000);
    const double beyond = run(&engine, 1.02 * engine.largest_step, 2000);
    print_message("    stated %.4g s; largest angle %.2g rad below it, %.2g beyond\n",
                  engine.largest_step, below, beyond);
    assert_close_relative(chosen, 0.5 * engine.largest_step, 1e-3);
    assert_true(below < 1e-4);
    assert_true(beyond >= UNSTABLE);
    stop(&engine);
}

static void the_lowest_mode_decays_with_the_damping_ratio(void **state)
{
    (void)state;
    struct wb_card_settings settings = settings_of(4);
    settings.damping_ratio = 0.1;
    struct engine engine = start(&settings);
    mjModel *const m = engine.model;
    mjData *const d = engine.data;
    int n = 0;
    for (int i = 0; i < 3; i++)
        m->opt.gravity[i] = 0.0;
    for (int i = 0; i < m->nv; i++) {
        /* Close to the first mode: the largest bend is at the clamp. */
        if (m->jnt_axis[3 * i + 2] == 1.0)
            d->qpos[i] = 1e-3 * (1.0 - (double)i / m->nv);
    }
    /* The tip's height at the second and third turn. */
    double turns[4] = {0.0}, last = 0.0, older = 0.0;
    for (long k = 0; k < 4000000 && n < 4; k++) {
        mj_step(m, d);
        const double y = d->site_xpos[1];
        if (k > 1 && (last - older) * (y - last) < 0.0)
            turns[n++] = last;
        older = last;
        last = y;
    }
    assert_int_equal(n, 4);
    const double decrement = log(fabs(turns[1] / turns[3]));
    const double zeta = decrement / sqrt(4.0 * M_PI * M_PI + decrement * decrement);
    print_message("    damping ratio %.4f, asked for 0.1\n", zeta);
    assert_close(zeta, 0.1, 2e-3);
    stop(&engine);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ten_segments_agree_with_the_beam_within_half_a_percent),
        cmocka_unit_test(the_error_falls_with_the_square_of_the_segments),
        cmocka_unit_test(a_twist_hinge_turns_by_the_stated_torsion),
        cmocka_unit_test(the_stated_time_step_is_the_largest_stable_one),
        cmocka_unit_test(the_lowest_mode_decays_with_the_damping_ratio),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
