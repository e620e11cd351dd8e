/* Another program hangs the shipped harnesses: MuJoCo, with a tree of rigid bodies. Each element of
 * a branch is a joint of two bending hinges and a twist hinge in its middle, with EI and GJ over
 * its length; from there to the next joint the bodies are rigid, so that the shapes converge with
 * the square of the elements' length. The wires are elastic. */
#include "analysis/harness/harness_run.h"
#include "base/units.h"
#include "base/vec3.h"
#include "tests/analysis/cards/mujoco_rest.h"
#include "tests/own_folder.h"

enum {
    LEVELS = 3,     /* resolutions, each of half the element length */
    NODES = 100,    /* most nodes of the coarsest level */
    NAME_SIZE = 64, /* of a site */
};

/* A harness with the angles at which branches leave, as its file has them, in degrees. */
struct shipped {
    const char *name;
    double coarsest; /* element length, m */
    struct leaving {
        const char *branch;
        double angle, around;
    } leavings[4];
};

static const struct shipped small = {"small", 0.025, {{"B2", 30.0, 90.0}, {"B3", 30.0, -90.0}}};
static const struct shipped door = {
    "door", 0.1, {{"speaker", 60.0, 180.0}, {"lock", 30.0, 0.0}, {"lamp", 45.0, 90.0}}};

/* --- the model --- */

struct model {
    const struct shipped *harness;
    const struct wb_harness_plan *plan;
    double h;       /* element length, m */
    double damping; /* of joints over their stiffness, s */
    struct wb_text text;
};

static int elements_of(const struct model *model, int branch)
{
    const double n = model->plan->branches[branch].length / model->h;
    assert_close(n, round(n), 1e-9);
    return (int)round(n);
}

/* A piece of wire along x in the frame of the open body. */
static void append_wire(struct model *model, int branch, double from, double to)
{
    const struct wb_harness_wire *const wire =
        &model->plan->wires[model->plan->branches[branch].wire];
    wb_text_append(&model->text,
                   "<geom type=\"capsule\" fromto=\"%.17g 0 0 %.17g 0 0\" size=\"%.17g\" "
                   "mass=\"%.17g\"/>\n",
                   from, to, 0.5 * wire->diameter, wire->mass * (to - from));
}

static void append_joints(struct model *model, int branch)
{
    const struct wb_harness_wire *const wire =
        &model->plan->wires[model->plan->branches[branch].wire];
    const double EI = wire->law.material.youngs_modulus * M_PI * pow(wire->diameter, 4.0) / 64.0;
    const double GJ = EI / (1.0 + wire->law.material.poissons_ratio);
    static const char *const axes[] = {"0 1 0", "0 0 1", "1 0 0"};
    assert_true(wire->torsional_stiffness == 0.0);
    for (int i = 0; i < 3; i++) {
        const double stiffness = (i < 2 ? EI : GJ) / model->h;
        wb_text_append(&model->text,
                       "<joint type=\"hinge\" axis=\"%s\" stiffness=\"%.17g\" "
                       "damping=\"%.17g\"/>\n",
                       axes[i], stiffness, model->damping * stiffness);
    }
}

static void append_branch(struct model *model, int branch);

/* What is at the end of a branch, at x = `at` of the open body: a connector and the next branches.
 */
static void append_end(struct model *model, int branch, double at)
{
    const struct wb_harness_plan *const plan = model->plan;
    for (int i = 1; i < plan->n_items; i++) {
        const struct wb_harness_item *const item = &plan->items[i];
        if (item->kind == WB_HARNESS_CONNECTOR && item->branch == branch && item->mass > 0.0)
            wb_text_append(&model->text,
                           "<geom type=\"sphere\" pos=\"%.17g %.17g %.17g\" size=\"0.003\" "
                           "mass=\"%.17g\"/>\n",
                           at + item->centre[0], item->centre[1], item->centre[2], item->mass);
    }
    for (int b = 0; b < plan->n_branches; b++) {
        double angle = 0.0, around = 0.0;
        if (plan->branches[b].parent != branch)
            continue;
        for (int i = 0; i < 4 && model->harness->leavings[i].branch; i++) {
            if (strcmp(model->harness->leavings[i].branch, plan->branches[b].name) == 0) {
                angle = model->harness->leavings[i].angle * M_PI / 180.0;
                around = model->harness->leavings[i].around * M_PI / 180.0;
            }
        }
        /* From x towards z, which is turned about x. */
        wb_text_append(&model->text, "<body pos=\"%.17g 0 0\" axisangle=\"0 %.17g %.17g %.17g\">\n",
                       at, -cos(around), -sin(around), angle);
        append_branch(model, b);
        wb_text_append(&model->text, "</body>\n");
    }
}

/* In a body whose origin and x axis are those of the branch's beginning. */
static void append_branch(struct model *model, int branch)
{
    const int n = elements_of(model, branch);
    const double h = model->h;
    append_wire(model, branch, 0.0, 0.5 * h);
    for (int i = 0; i < n; i++) {
        wb_text_append(&model->text, "<body pos=\"%.17g 0 0\">\n", i == 0 ? 0.5 * h : h);
        append_joints(model, branch);
        append_wire(model, branch, 0.0, i < n - 1 ? h : 0.5 * h);
        wb_text_append(&model->text, "<site name=\"%d %d\" pos=\"%.17g 0 0\"/>\n", branch, i + 1,
                       0.5 * h);
    }
    append_end(model, branch, 0.5 * h);
    for (int i = 0; i < n; i++)
        wb_text_append(&model->text, "</body>\n");
}

static mjModel *load(struct model *model)
{
    char path[WB_PATH], problem[500] = "";
    wb_text_append(&model->text,
                   "<mujoco>\n<compiler angle=\"radian\"/>\n"
                   "<option gravity=\"0 0 %.17g\" timestep=\"0.005\"/>\n"
                   "<default><geom contype=\"0\" conaffinity=\"0\"/></default>\n"
                   "<worldbody>\n<body>\n",
                   -WB_STANDARD_GRAVITY);
    append_branch(model, 0);
    wb_text_append(&model->text, "</body>\n</worldbody>\n</mujoco>\n");
    assert_int_equal(wb_file_join(path, folder, "harness.xml"), WB_OK);
    assert_int_equal(wb_file_write_text(path, &model->text), WB_OK);
    wb_text_release(&model->text);
    mjModel *const m = mj_loadXML(path, NULL, problem, sizeof problem);
    if (!m)
        fail_msg("%s", problem);
    return m;
}

/* --- at rest --- */

static void find_residual(const void *unused, const mjModel *m, mjData *d, double *residual)
{
    (void)unused;
    mj_kinematics(m, d);
    mj_comPos(m, d);
    mj_fwdVelocity(m, d);
    for (int i = 0; i < m->nv; i++)
        residual[i] = d->qfrc_passive[i] - d->qfrc_bias[i];
}

/* The weight grows in ten increments. */
static void hang(mjModel *m, mjData *d)
{
    const double gravity = m->opt.gravity[2];
    for (int step = 1; step <= 10; step++) {
        m->opt.gravity[2] = 0.1 * step * gravity;
        mujoco_rest(m, d, 1e-10, find_residual, NULL);
    }
}

/* From straight, with much damping, until nothing moves any more. */
static void fall(const mjModel *m, mjData *d)
{
    double fastest = 1.0;
    for (int step = 0; step < 20000 && fastest > 1e-9; step++) {
        mj_step(m, d);
        fastest = 0.0;
        for (int i = 0; i < m->nv; i++)
            fastest = fmax(fastest, fabs(d->qvel[i]));
    }
    assert_true(fastest <= 1e-9);
    mj_forward(m, d);
}

/* Positions of the coarsest level's nodes, branch by branch; returns their number. */
static int read_nodes(const struct model *model, const mjModel *m, const mjData *d,
                      double nodes[NODES][3])
{
    const int every = (int)round(model->harness->coarsest / model->h);
    int n = 0;
    for (int b = 0; b < model->plan->n_branches; b++) {
        for (int i = every; i <= elements_of(model, b); i += every, n++) {
            char name[NAME_SIZE];
            snprintf(name, sizeof name, "%d %d", b, i);
            const int site = mj_name2id(m, mjOBJ_SITE, name);
            assert_true(site >= 0 && n < NODES);
            memcpy(nodes[n], &d->site_xpos[3 * site], sizeof nodes[n]);
        }
    }
    return n;
}

static int mujoco_nodes(const struct shipped *harness, const struct wb_harness_plan *plan, double h,
                        bool falls, double nodes[NODES][3])
{
    struct model model = {.harness = harness, .plan = plan, .h = h, .damping = 0.3};
    mjModel *const m = load(&model);
    mjData *const d = mj_makeData(m);
    assert_non_null(d);
    if (falls)
        fall(m, d);
    else
        hang(m, d);
    const int n = read_nodes(&model, m, d, nodes);
    mj_deleteData(d);
    mj_deleteModel(m);
    return n;
}

/* --- the harness --- */

/* Between two places of a shape, by the cubic with their directions. */
static void position_at(const struct wb_harness_place *places, int branch, double s,
                        double position[3])
{
    const struct wb_harness_place *b = places;
    while (b->branch != branch || b->s < s - 1e-9)
        b++;
    const struct wb_harness_place *const a = b - 1;
    const double length = b->s - a->s, t = fmin((s - a->s) / length, 1.0);
    for (int k = 0; k < 3; k++) {
        position[k] = (1.0 + 2.0 * t) * (1.0 - t) * (1.0 - t) * a->position[k] +
                      t * (1.0 - t) * (1.0 - t) * length * a->direction[k] +
                      t * t * (3.0 - 2.0 * t) * b->position[k] +
                      t * t * (t - 1.0) * length * b->direction[k];
    }
}

static void shape_nodes(const struct shipped *harness, const struct wb_harness_result_set *set,
                        const struct wb_harness_place *places, double nodes[NODES][3])
{
    int n = 0;
    for (int b = 0; b < set->plan->n_branches; b++) {
        const int elements = (int)round(set->plan->branches[b].length / harness->coarsest);
        for (int i = 1; i <= elements; i++, n++)
            position_at(places, b, i * harness->coarsest, nodes[n]);
    }
}

static double largest_distance(int n, double a[NODES][3], double b[NODES][3])
{
    double largest = 0.0;
    for (int i = 0; i < n; i++)
        largest = fmax(largest, wb_vec3_distance(a[i], b[i]));
    return largest;
}

static struct wb_harness_plan *read_plan(const struct shipped *harness)
{
    struct wb_harness_plan *const plan = calloc(1, sizeof *plan);
    char path[WB_PATH];
    assert_non_null(plan);
    assert_int_equal(wb_file_find_fixture(path, "harnesses", harness->name, NULL), WB_OK);
    assert_int_equal(wb_harness_file_read(plan, path), WB_OK);
    assert_int_equal(plan->steps[0].kind, WB_HARNESS_HANG);
    plan->n_steps = 1;
    return plan;
}

static void harness_nodes(const struct shipped *harness, const struct wb_harness_plan *plan,
                          double nodes[NODES][3], double natural[NODES][3])
{
    const struct wb_harness_settings settings = {.is_elastic = true, .torsion = 1.0};
    struct wb_harness_result_set set;
    assert_int_equal(wb_harness_run_compute(&set, plan, &settings, NULL, NULL), WB_OK);
    assert_true(set.converged);
    shape_nodes(harness, &set, set.results[0].places, nodes);
    shape_nodes(harness, &set, set.natural, natural);
    wb_harness_run_release(&set);
}

static void compare(const struct shipped *harness)
{
    static double levels[LEVELS][NODES][3], limit[NODES][3], ours[NODES][3], natural[NODES][3];
    struct wb_harness_plan *const plan = read_plan(harness);
    double length = 0.0;
    int n = 0;
    for (int b = 0; b < plan->n_branches; b++)
        length += plan->branches[b].length;
    for (int level = 0; level < LEVELS; level++)
        n = mujoco_nodes(harness, plan, harness->coarsest / (1 << level), false, levels[level]);
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < 3; k++)
            limit[i][k] = levels[LEVELS - 1][i][k] +
                          (levels[LEVELS - 1][i][k] - levels[LEVELS - 2][i][k]) / 3.0;
    }
    harness_nodes(harness, plan, ours, natural);
    const double order =
        log2(largest_distance(n, levels[0], levels[1]) / largest_distance(n, levels[1], levels[2]));
    print_message("    %s, %.2f m: moves by up to %.1f mm from its natural shape; MuJoCo with "
                  "elements of %g, %g, %g mm: order %.2f\n",
                  harness->name, length, largest_distance(n, ours, natural) / WB_MM,
                  harness->coarsest / WB_MM, harness->coarsest / 2.0 / WB_MM,
                  harness->coarsest / 4.0 / WB_MM, order);
    for (int level = 0; level < LEVELS; level++)
        print_message("    distance of ours from level %d: %.3f mm, %.4f %% of the length\n", level,
                      largest_distance(n, ours, levels[level]) / WB_MM,
                      100.0 * largest_distance(n, ours, levels[level]) / length);
    const double distance = largest_distance(n, ours, limit);
    print_message("    from its limit: %.4f mm, %.5f %% of the length\n", distance / WB_MM,
                  100.0 * distance / length);
    assert_true(largest_distance(n, ours, natural) > 0.3 * length);
    assert_close(order, 2.0, 0.2);
    /* Ours also stretches and shears, by about 0.03 mm in the small harness. */
    assert_true(distance <= 2e-4 * length);
    free(plan);
}

static void small_harness_hangs_as_in_mujoco(void **unused)
{
    (void)unused;
    compare(&small);
}

static void door_harness_hangs_as_in_mujoco(void **unused)
{
    (void)unused;
    compare(&door);
}

/* The engine's own time integration comes to rest where Newton's method ends. */
static void engine_falls_into_the_equilibrium(void **unused)
{
    (void)unused;
    static double fallen[NODES][3], solved[NODES][3];
    struct wb_harness_plan *const plan = read_plan(&small);
    const int n = mujoco_nodes(&small, plan, small.coarsest, true, fallen);
    (void)mujoco_nodes(&small, plan, small.coarsest, false, solved);
    print_message("    fallen and solved: %.2g m apart\n", largest_distance(n, fallen, solved));
    assert_true(largest_distance(n, fallen, solved) < 1e-6);
    free(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_harness_hangs_as_in_mujoco),
        cmocka_unit_test(door_harness_hangs_as_in_mujoco),
        cmocka_unit_test(engine_falls_into_the_equilibrium),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
