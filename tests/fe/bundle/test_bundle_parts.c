/* A bundle in parts equals the complete one; a run continued from a checkpoint equals an
 * uninterrupted run. With an argument it prints the results of such a bundle, to compare ranks
 * started by mpirun with threads.
 */
#include "tests/fe/bundle/bundles.h"

#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "fe/bundle/bundle_parts.h"
#include "fe/bundle/bundle_private.h"
#include "fe/team/team.h"
#include "tests/fe/bundle/outside.h"

enum {
    ROUNDS = 8,
    STEPS = 50,
    SHAPE = 57
};

/* Everything that exists at a border: contact, friction, bonds, tape, plastic strain; strand and
 * weight. Moved so fast that wires yield and slip within few steps. */
#define FINE                                                                                       \
    "  - {name: fine, core_quads: 2, rings: 0, elements_along: 57}\n" SEVEN                        \
    "run: {mesh: fine, selective_mass_scaling: 100, deflection_mm: 10}\n"                          \
    "loads: {strand_mm: 760, weight: true}\n"

static const double way = 10e-3, duration = 6e-3;

/* State of a bundle. */
struct result {
    struct wb_bundle_state state;
    struct wb_bundle_energies energies;
    struct outside outside;
    struct wb_bundle_limits limits;
    double shape[SHAPE][3];
};

static void take(const struct wb_bundle *bundle, struct result *out)
{
    double s[SHAPE];
    for (int i = 0; i < SHAPE; i++)
        s[i] = model.length * i / (SHAPE - 1);
    memset(out, 0, sizeof *out);
    wb_bundle_get_state(bundle, &out->state);
    wb_bundle_get_energies(bundle, &out->energies);
    get_outside(bundle, &out->outside);
    wb_bundle_get_limits(bundle, &out->limits);
    wb_bundle_shape(bundle, SHAPE, s, out->shape);
}

static struct wb_bundle *create(int threads)
{
    const struct wb_bundle_settings settings = {.duration = duration, .threads = threads};
    struct wb_bundle *bundle;
    assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
    return bundle;
}

static void advance(struct wb_bundle *bundle, int rounds)
{
    for (int i = 0; i < rounds; i++)
        assert_int_equal(wb_bundle_advance(bundle, STEPS, NULL), WB_OK);
}

static void bend(int threads, struct result *out)
{
    struct wb_bundle *bundle = create(threads);
    assert_int_equal(wb_bundle_parts(bundle), threads * wb_team_ranks());
    wb_bundle_move_tip(bundle, way, duration);
    advance(bundle, ROUNDS);
    take(bundle, out);
    wb_bundle_destroy(bundle);
}

/* Forces are float and the bundle is stiff: round-off in the first steps grows by a factor of a
 * thousand in a few hundred. Positions agree to 1e-11 m. */
static void check_same_within(const struct result *a, const struct result *b, double place)
{
    const double size = fabs(b->energies.external);
    assert_close_relative(a->state.deflection, b->state.deflection, 1e-9);
    assert_close_relative(a->state.vertical, b->state.vertical, 2e-5);
    assert_close(a->energies.kinetic, b->energies.kinetic, 1e-6 * size);
    assert_close(a->energies.stored, b->energies.stored, 1e-6 * size);
    assert_close(a->energies.plastic, b->energies.plastic, 1e-6 * size);
    assert_close(a->energies.artificial, b->energies.artificial, 1e-6 * size);
    assert_close(a->energies.contact, b->energies.contact, 1e-6 * size);
    assert_close(a->energies.friction, b->energies.friction, 1e-6 * size);
    assert_close(a->energies.cohesive, b->energies.cohesive, 1e-6 * size);
    assert_close(a->energies.external, b->energies.external, 1e-6 * size);
    assert_close_relative(a->limits.largest_strain, b->limits.largest_strain, 1e-4);
    assert_close_relative(a->limits.deepest, b->limits.deepest, 5e-3);
    for (int c = 0; c < 3; c++) {
        assert_close(a->outside.momentum[c], b->outside.momentum[c],
                     1e-6 * fabs(b->outside.momentum[1]));
        assert_close(a->outside.clamp[c], b->outside.clamp[c], 1e-4);
    }
    for (int i = 0; i < SHAPE; i++)
        for (int c = 0; c < 3; c++)
            assert_close(a->shape[i][c], b->shape[i][c], place);
}

static void check_same(const struct result *a, const struct result *b)
{
    check_same_within(a, b, 1e-10);
}

static void parts_equal_the_complete_bundle(void **unused)
{
    (void)unused;
    struct result whole, parted;
    read_model(FINE);
    bend(1, &whole);
    assert_true(whole.energies.plastic > 0.05 * whole.energies.external);
    assert_true(whole.energies.friction > 1e-3 * whole.energies.external);
    for (int threads = 2; threads <= 3; threads++) {
        bend(threads, &parted);
        check_same(&parted, &whole);
    }
}

/* With forces in double, round-off is smaller, and it is the only difference between parts and the
 * complete bundle. */
static void parts_in_double_agree_to_round_off(void **unused)
{
    (void)unused;
    struct result whole, parted, single;
    read_model(FINE);
    bend(1, &single);
    model.run.double_precision = true;
    bend(1, &whole);
    bend(2, &parted);
    assert_close_relative(single.state.vertical, whole.state.vertical, 1e-4);
    assert_true(single.state.vertical != whole.state.vertical);
    assert_close_relative(parted.state.vertical, whole.state.vertical, 1e-8);
    assert_close_relative(parted.energies.friction, whole.energies.friction, 1e-8);
    assert_close_relative(parted.energies.plastic, whole.energies.plastic, 1e-8);
    for (int i = 0; i < SHAPE; i++)
        for (int c = 0; c < 3; c++)
            assert_close(parted.shape[i][c], whole.shape[i][c], 1e-13);
}

#define BARE                                                                                       \
    "  - {name: fine, core_quads: 2, rings: 0, elements_along: 57}\n" ONE                          \
    "run: {mesh: fine, selective_mass_scaling: 100, deflection_mm: 10}\n"                          \
    "loads: {weight: false}\n"

static void one_wire_is_the_same_bit_for_bit_in_any_parts(void **unused)
{
    (void)unused;
    struct result whole, parted;
    read_model(BARE);
    bend(1, &whole);
    assert_true(whole.energies.plastic > 0.0);
    for (int threads = 2; threads <= 3; threads++) {
        bend(threads, &parted);
        assert_true(parted.state.vertical == whole.state.vertical);
        assert_memory_equal(parted.shape, whole.shape, sizeof whole.shape);
    }
}

/* The tape debonds where it bends most, and stays in contact with the wires. */
static void weaken(void)
{
    model.interface.has_damage = true;
    model.interface.damage =
        (struct wb_bundle_damage){.strength = 2e4, .shear_strength = 2e4, .fracture_energy = 0.1};
}

static void parts_break_the_same_bonds(void **unused)
{
    (void)unused;
    struct result whole, parted;
    read_model(FINE);
    weaken();
    bend(1, &whole);
    bend(2, &parted);
    /* A softening bond depends strongly on its opening, so round-off grows: on some processors to
     * 1.6e-10 m, 8e-8 of the deflection. */
    check_same_within(&parted, &whole, 1e-9);
    assert_true(whole.limits.debonded > 0.0 && whole.limits.tape_deepest > 0.0);
    assert_close_relative(parted.limits.debonded, whole.limits.debonded, 1e-9);
    assert_close_relative(parted.limits.tape_deepest, whole.limits.tape_deepest, 1e-2);
}

static void the_same_parts_are_the_same_bit_for_bit(void **unused)
{
    (void)unused;
    struct result once, again;
    read_model(FINE);
    bend(3, &once);
    bend(3, &again);
    assert_memory_equal(&once, &again, sizeof once);
}

/* The sum of the parts' momenta changes only by external forces: nothing is lost at borders. */
static void only_external_forces_change_the_momentum(void **unused)
{
    (void)unused;
    struct outside outside;
    double impulse = 0.0, size = 0.0;
    read_model(FINE);
    struct wb_bundle *bundle = create(3);
    wb_bundle_move_tip(bundle, way, duration);
    for (int i = 0; i < 400; i++) {
        assert_int_equal(wb_bundle_advance(bundle, 1, NULL), WB_OK);
        get_outside(bundle, &outside);
        const double force = outside.clamp[1] + outside.tip[1] + outside.weight[1];
        impulse += force * wb_bundle_time_step(bundle) * (i == 0 ? 0.5 : 1.0);
        size += fabs(force) * wb_bundle_time_step(bundle);
        assert_close(outside.momentum[1], impulse, 1e-5 * size);
    }
    wb_bundle_destroy(bundle);
}

#define CAPPED                                                                                     \
    "  - {name: fine, core_quads: 2, rings: 0, elements_along: 57}\n" SEVEN                        \
    "ends: {tip: capped}\nrun: {mesh: fine, selective_mass_scaling: 100, deflection_mm: 10}\n"     \
    "loads: {weight: true}\n"

static void a_capped_end_belongs_to_the_last_part(void **unused)
{
    (void)unused;
    struct result whole, parted;
    read_model(CAPPED);
    bend(1, &whole);
    bend(2, &parted);
    check_same(&parted, &whole);
}

/* The last part is as long as the halo of the one before, which therefore also contains the end. */
static void a_capped_end_in_a_halo_is_ignored(void **unused)
{
    (void)unused;
    struct result whole, parted;
    read_model("  - {name: fine, core_quads: 2, rings: 0, elements_along: 31}\n" SEVEN
               "ends: {tip: capped}\n"
               "run: {mesh: fine, selective_mass_scaling: 100, deflection_mm: 10}\n"
               "loads: {weight: false}\n");
    bend(1, &whole);
    bend(2, &parted);
    check_same(&parted, &whole);
}

/* The times of stopping depend on round-off; the state of rest does not. */
static void parts_settle_under_the_weight(void **unused)
{
    (void)unused;
    struct result settled[2];
    read_model(CAPPED);
    for (int i = 0; i < 2; i++) {
        struct wb_bundle *bundle = create(i + 1);
        assert_int_equal(wb_bundle_settle(bundle, NULL, NULL), WB_OK);
        take(bundle, &settled[i]);
        wb_bundle_destroy(bundle);
    }
    assert_close_relative(settled[1].state.vertical, settled[0].state.vertical, 5e-3);
    assert_close_relative(settled[1].outside.weight[1], settled[0].outside.weight[1], 1e-12);
    for (int i = 0; i < SHAPE; i++)
        assert_close(settled[1].shape[i][1], settled[0].shape[i][1], 1e-7);
}

static void number_of_parts_is_limited_by_the_length(void **unused)
{
    (void)unused;
    read_model(FINE);
    assert_int_equal(wb_bundle_parts_of(&model, NULL, 0), 1);
    assert_int_equal(wb_bundle_parts_of(&model, NULL, 3), 3);
    assert_int_equal(wb_bundle_parts_of(&model, NULL, 100), 4);
    assert_int_equal(wb_bundle_parts_of(&model, "four", 3), 2);
    assert_int_equal(wb_bundle_parts_of(&model, "paper", 2), 2);
    struct wb_bundle *bundle = create(100);
    assert_int_equal(wb_bundle_parts(bundle), 4);
    wb_bundle_move_tip(bundle, way, duration);
    advance(bundle, 1);
    wb_bundle_destroy(bundle);
}

static void keep_message(void *context, enum wb_log_level level, const char *domain,
                         const char *message)
{
    (void)level, (void)domain;
    const size_t used = strlen(context);
    snprintf((char *)context + used, 1024 - used, "%s\n", message);
}

static enum wb_status advance_to_the_end(struct wb_reason *reason)
{
    const struct wb_bundle_settings settings = {
        .duration = duration, .threads = 3, .step_safety = 3.0};
    struct wb_bundle *bundle;
    enum wb_status status = WB_OK;
    assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
    wb_bundle_move_tip(bundle, way, duration);
    for (int i = 0; i < 100 && status == WB_OK; i++)
        status = wb_bundle_advance(bundle, STEPS, reason);
    wb_bundle_destroy(bundle);
    return status;
}

/* A part that fails does not block others; its reason is reported once, to the log or to the
 * caller. */
static void a_failed_part_ends_the_run(void **unused)
{
    (void)unused;
    struct wb_reason reason = {0};
    char messages[1024] = "", no_messages[1024] = "";
    read_model(FINE);
    wb_log_set_sink(keep_message, messages);
    assert_int_equal(advance_to_the_end(NULL), WB_ERR_DATA);
    wb_log_set_sink(keep_message, no_messages);
    assert_int_equal(advance_to_the_end(&reason), WB_ERR_DATA);
    wb_log_set_sink(NULL, NULL);
    assert_non_null(strchr(messages, '\n'));
    assert_string_equal(strchr(messages, '\n'), "\n");
    assert_true(strlen(messages) > 10);
    assert_string_equal(no_messages, "");
    assert_memory_equal(reason.text, messages, strlen(messages) - 1);
}

/* --- checkpoints --- */

/* With bonds that break, so that the tape's contact also has a state to save. */
static void a_checkpoint_continues_bit_for_bit(void **unused)
{
    (void)unused;
    read_model(FINE);
    weaken();
    for (int threads = 1; threads <= 2; threads++) {
        struct result straight, resumed;
        struct wb_checkpoint checkpoint;
        struct wb_bundle *bundle = create(threads);
        wb_bundle_move_tip(bundle, way, duration);
        assert_int_equal(wb_bundle_advance(bundle, 137, NULL), WB_OK);
        wb_checkpoint_init(&checkpoint);
        wb_bundle_visit(bundle, &checkpoint);
        assert_int_equal(wb_checkpoint_finish(&checkpoint), WB_OK);
        advance(bundle, 4);
        take(bundle, &straight);
        wb_bundle_destroy(bundle);

        bundle = create(threads);
        wb_checkpoint_rewind(&checkpoint);
        wb_bundle_visit(bundle, &checkpoint);
        assert_int_equal(wb_checkpoint_finish(&checkpoint), WB_OK);
        advance(bundle, 4);
        take(bundle, &resumed);
        assert_memory_equal(&straight, &resumed, sizeof straight);
        assert_true(straight.limits.debonded > 0.0 && straight.limits.tape_deepest > 0.0);
        wb_bundle_destroy(bundle);
        wb_checkpoint_release(&checkpoint);
    }
}

static void truncated_checkpoint_is_rejected(void **unused)
{
    (void)unused;
    struct wb_checkpoint checkpoint;
    read_model(FINE);
    struct wb_bundle *bundle = create(2);
    wb_bundle_move_tip(bundle, way, duration);
    wb_checkpoint_init(&checkpoint);
    wb_bundle_visit(bundle, &checkpoint);
    assert_int_equal(wb_checkpoint_finish(&checkpoint), WB_OK);
    char messages[1024] = "";
    checkpoint.size /= 4; /* in the first part */
    wb_checkpoint_rewind(&checkpoint);
    wb_log_set_sink(keep_message, messages);
    wb_bundle_visit(bundle, &checkpoint);
    wb_log_set_sink(NULL, NULL);
    assert_int_equal(wb_checkpoint_finish(&checkpoint), WB_ERR_DATA);
    assert_true(checkpoint.at <= checkpoint.size);
    assert_non_null(strstr(messages, "'part 1/"));
    wb_bundle_destroy(bundle);
    wb_checkpoint_release(&checkpoint);
}

/* Stops a run like a signal, after this many calls of the observer. */
static bool stop_after(void *context, const struct wb_bundle_progress *progress)
{
    (void)progress;
    return --*(int *)context > 0;
}

static void run_with(const struct wb_bundle_run_options *options)
{
    wb_bundle_result_release(&result);
    assert_int_equal(wb_bundle_result_init(&result, &model, 5), WB_OK);
    assert_int_equal(wb_bundle_run(&result, &model, options), WB_OK);
    assert_true(result.converged);
}

static void a_failed_run_reports_its_reason(void **unused)
{
    (void)unused;
    for (int threads = 1; threads <= 2; threads++) {
        const struct wb_bundle_run_options options = {.threads = threads};
        read_model(FINE);
        model.run.duration = 1e-4;
        wb_bundle_result_release(&result);
        assert_int_equal(wb_bundle_result_init(&result, &model, 0), WB_OK);
        assert_int_equal(wb_bundle_run(&result, &model, &options), WB_OK);
        assert_int_equal(result.parts, threads);
        assert_false(result.converged);
        assert_true(strlen(result.reason.text) > 10);
    }
}

/* Compares rows and shapes; computing times differ. */
static void check_result(const struct wb_bundle_result *a, const struct wb_bundle_result *b)
{
    assert_int_equal(a->n_rows, b->n_rows);
    for (int i = 0; i < a->n_rows; i++) {
        assert_true(a->rows[i].force == b->rows[i].force);
        assert_true(a->rows[i].deflection == b->rows[i].deflection);
        assert_true(a->rows[i].standard_deviation == b->rows[i].standard_deviation);
        assert_true(a->rows[i].phase == b->rows[i].phase && a->rows[i].cycle == b->rows[i].cycle);
        assert_memory_equal(&a->rows[i].energies, &b->rows[i].energies, sizeof a->rows[i].energies);
        assert_memory_equal(a->shape[i * a->n_shape], b->shape[i * a->n_shape],
                            (size_t)a->n_shape * sizeof *a->shape);
    }
    assert_memory_equal(&a->largest.kinetic, &b->largest.kinetic, sizeof(double));
    assert_true(a->all_steps == b->all_steps && a->steps == b->steps);
    assert_true(a->attempts == b->attempts && a->duration == b->duration);
}

static void quiet(void *context, enum wb_log_level level, const char *domain, const char *message)
{
    (void)context, (void)level, (void)domain, (void)message;
}

/* Stopped repeatedly, during loading and unloading. */
static void a_stopped_run_ends_with_the_same_result(void **unused)
{
    (void)unused;
    char file[64];
    snprintf(file, sizeof file, "%s/state", folder);
    wb_log_set_sink(quiet, NULL);
    for (int threads = 1; threads <= 2; threads++) {
        read_model("  - {name: fine, core_quads: 2, rings: 0, elements_along: 24}\n"
                   "wires: [{wire: type3, count: 3}]\npacking: triangle\ntape: tape\n"
                   "run: {mesh: fine, selective_mass_scaling: 100, deflection_mm: 20, rows: 4, "
                   "cycles: 2, duration_s: 0.03}\n"
                   "loads: {weight: true, strand_mm: 760}\n");
        const struct wb_bundle_run_options plain = {.threads = threads};
        run_with(&plain);
        assert_int_equal(result.parts, threads);
        assert_int_equal(result.rows[8].phase, WB_PHASE_SLACK);
        const struct wb_bundle_result straight = result;
        result = (struct wb_bundle_result){0};

        int left, stops = 0;
        const struct wb_bundle_observer observer = {.progress = stop_after, .context = &left};
        const struct wb_bundle_run_options options = {
            .threads = threads, .checkpoint = file, .observer = &observer};
        do {
            left = 7 + 200 * (++stops % 3);
            run_with(&options);
            assert_true(result.stopped == result.kept && wb_file_exists(file));
            assert_true(result.resumed == (stops > 1));
        } while (result.stopped);
        assert_true(stops > 3);
        check_result(&result, &straight);
        assert_true(result.wall > 0.0 && result.cpu > 0.0);
        assert_int_equal(unlink(file), 0);
        wb_bundle_result_release(&result);
        result = straight;
    }
    wb_log_set_sink(NULL, NULL);
}

static void checkpoint_of_another_model_is_rejected(void **unused)
{
    (void)unused;
    char file[64], messages[1024] = "";
    int left = 2;
    const struct wb_bundle_observer observer = {.progress = stop_after, .context = &left};
    snprintf(file, sizeof file, "%s/state", folder);
    struct wb_bundle_run_options options = {.checkpoint = file, .observer = &observer};
    read_model(ONE RUN("rows: 2, duration_s: 0.5") "loads: {weight: false}\n");
    run_with(&options);
    assert_true(result.stopped && wb_file_exists(file));
    wb_log_set_sink(keep_message, messages);
    model.interface.friction.mu_static = 0.3;
    assert_int_equal(wb_bundle_run(&result, &model, &options), WB_ERR_DATA);
    wb_log_set_sink(NULL, NULL);
    assert_non_null(strstr(messages, "another run"));
    assert_true(wb_file_exists(file));
    assert_int_equal(unlink(file), 0);
}

static void failed_checkpoint_is_reported(void **unused)
{
    (void)unused;
    char file[64], messages[1024] = "";
    int left = 2;
    const struct wb_bundle_observer observer = {.progress = stop_after, .context = &left};
    snprintf(file, sizeof file, "%s/nowhere/state", folder);
    const struct wb_bundle_run_options options = {.checkpoint = file, .observer = &observer};
    read_model(ONE RUN("rows: 2, duration_s: 0.5") "loads: {weight: false}\n");
    wb_log_set_sink(keep_message, messages);
    run_with(&options);
    wb_log_set_sink(NULL, NULL);
    assert_true(result.stopped && !result.kept);
    assert_non_null(strstr(messages, file));
}

/* --- by mpirun --- */

static int print_result(int threads)
{
    struct result r;
    read_model(FINE);
    bend(threads, &r);
    if (wb_team_rank() > 0)
        return 0;
    const double *numbers = &r.energies.kinetic;
    for (size_t i = 0; i < sizeof r.energies / sizeof *numbers; i++)
        printf("%.17g\n", numbers[i]);
    printf("%.17g %.17g\n", r.state.vertical, r.state.deflection);
    for (int c = 0; c < 3; c++)
        printf("%.17g %.17g\n", r.outside.momentum[c], r.outside.clamp[c]);
    for (int i = 0; i < SHAPE; i++)
        printf("%.17g %.17g %.17g\n", r.shape[i][0], r.shape[i][1], r.shape[i][2]);
    return 0;
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_equal_the_complete_bundle),
        cmocka_unit_test(parts_break_the_same_bonds),
        cmocka_unit_test(the_same_parts_are_the_same_bit_for_bit),
        cmocka_unit_test(only_external_forces_change_the_momentum),
        cmocka_unit_test(a_capped_end_belongs_to_the_last_part),
        cmocka_unit_test(a_capped_end_in_a_halo_is_ignored),
        cmocka_unit_test(parts_settle_under_the_weight),
        cmocka_unit_test(parts_in_double_agree_to_round_off),
        cmocka_unit_test(one_wire_is_the_same_bit_for_bit_in_any_parts),
        cmocka_unit_test(number_of_parts_is_limited_by_the_length),
        cmocka_unit_test(a_failed_part_ends_the_run),
        cmocka_unit_test(a_failed_run_reports_its_reason),
        cmocka_unit_test(a_checkpoint_continues_bit_for_bit),
        cmocka_unit_test(truncated_checkpoint_is_rejected),
        cmocka_unit_test_teardown(a_stopped_run_ends_with_the_same_result, release),
        cmocka_unit_test_teardown(checkpoint_of_another_model_is_rejected, release),
        cmocka_unit_test_teardown(failed_checkpoint_is_reported, release),
    };
    int failed;
    if (wb_team_start() != WB_OK)
        return 1;
    if (argc > 1)
        failed = make_folder(NULL) || print_result(atoi(argv[1])) || remove_folder(NULL);
    else
        failed = cmocka_run_group_tests(tests, make_folder, remove_folder);
    wb_team_end();
    return failed;
}
