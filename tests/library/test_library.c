/* libwirebench used by a program through its header. Results are compared with closed forms, with
 * each other, and with the file's bytes; tests/library/examples.sh compares with the tool. */
#include <fcntl.h>
#include <locale.h>
#include <pthread.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <gsl/gsl_errno.h>

#include "include/wirebench.h"
#include "tests/own_folder.h"

static const double DIAMETER = 1.1e-3, MODULUS = 5e9, LENGTH = 0.085;

static char prepared_folder[4000], dataset_folder[4096], recording_path[4096];

static double rigidity(void)
{
    return MODULUS * M_PI * pow(DIAMETER, 4) / 64.0;
}

/* Fails with the library's message. */
static void assert_success(enum wirebench_status status)
{
    if (status != WIREBENCH_OK)
        fail_msg("status %d: %s", (int)status, wirebench_message());
}

static void assert_says(const char *part)
{
    if (!strstr(wirebench_message(), part))
        fail_msg("'%s' does not say '%s'", wirebench_message(), part);
}

static struct wirebench_properties *elastic_wire(void)
{
    const struct wirebench_law law = {.size = sizeof law,
                                      .outer_diameter = DIAMETER,
                                      .poissons_ratio = 0.3,
                                      .youngs_modulus = MODULUS};
    struct wirebench_properties *properties = NULL;
    assert_success(wirebench_properties_create(&properties, &law));
    return properties;
}

static struct wirebench_properties *plastic_wire(double kinematic_share)
{
    const struct wirebench_law law = {.size = sizeof law,
                                      .outer_diameter = DIAMETER,
                                      .poissons_ratio = 0.3,
                                      .youngs_modulus = MODULUS,
                                      .yield_stress = 4e6,
                                      .strength_coefficient = 1.3e9,
                                      .hardening_exponent = 0.9,
                                      .kinematic_share = kinematic_share};
    struct wirebench_properties *properties = NULL;
    assert_success(wirebench_properties_create(&properties, &law));
    return properties;
}

/* --- laws and solutions --- */

static void an_elastic_wire_bends_by_its_rigidity_and_springs_back(void **state)
{
    (void)state;
    struct wirebench_properties *const wire = elastic_wire();
    const double curvature[] = {0.0, 3.0, 30.0};
    double moment[3];
    struct wirebench_bending bending = {.size = sizeof bending};
    assert_success(wirebench_moments(wire, 3, curvature, moment));
    for (int i = 0; i < 3; i++)
        assert_close(moment[i], rigidity() * curvature[i], 1e-6 * rigidity() * 30.0);
    assert_success(wirebench_bend(wire, 30.0, &bending));
    assert_close_relative(bending.rigidity, rigidity(), 1e-9);
    assert_close(bending.residual_curvature_ratio, 0.0, 1e-9);
    wirebench_properties_destroy(wire);
}

static void an_elastic_cantilever_follows_the_cubic_formula(void **state)
{
    (void)state;
    struct wirebench_properties *const wire = elastic_wire();
    const double deflection[] = {0.0, 1e-4, -1e-4}, positions[] = {0.0, 0.5 * LENGTH, LENGTH};
    double force[3], moment[3], x[9], y[9];
    const struct wirebench_cantilever test = {
        .size = sizeof test, .length = LENGTH, .n_positions = 3, .positions = positions};
    struct wirebench_cantilever_result result = {
        .size = sizeof result, .force = force, .root_moment = moment, .shape_x = x, .shape_y = y};
    assert_success(wirebench_solve_cantilever(wire, &test, 3, deflection, &result));
    assert_int_equal(result.n_done, 3);
    const double expected = 3.0 * rigidity() * 1e-4 / pow(LENGTH, 3);
    assert_close(force[0], 0.0, 1e-12);
    assert_close_relative(force[1], expected, 1e-3);
    assert_close_relative(force[2], -expected, 1e-3);
    assert_close_relative(moment[1], expected * LENGTH, 1e-3);
    /* Deflection in the middle: 5/16 of the tip's. */
    assert_close(y[3], 0.0, 1e-12);
    assert_close_relative(y[4], 0.3125e-4, 1e-3);
    assert_close_relative(y[5], 1e-4, 1e-6);
    assert_close_relative(x[5], LENGTH, 1e-5);
    wirebench_properties_destroy(wire);
}

static void elastic_three_point_bending_follows_the_cubic_formula(void **state)
{
    (void)state;
    struct wirebench_properties *const wire = elastic_wire();
    const double deflection[] = {5e-5}, span = 0.04, compliance = 1e-4;
    double force, travel, moment;
    const struct wirebench_three_point test = {
        .size = sizeof test, .span = span, .compliance = compliance};
    struct wirebench_three_point_result result = {
        .size = sizeof result, .force = &force, .travel = &travel, .middle_moment = &moment};
    assert_success(wirebench_solve_three_point(wire, &test, 1, deflection, &result));
    assert_int_equal(result.n_done, 1);
    assert_close_relative(force, 48.0 * rigidity() * 5e-5 / pow(span, 3), 5e-3);
    assert_close_relative(moment, force * span / 4.0, 2e-2);
    assert_close_relative(travel, 5e-5 + compliance * force, 1e-9);
    wirebench_properties_destroy(wire);
}

static void kinematic_hardening_has_the_same_loading_and_less_springback(void **state)
{
    (void)state;
    struct wirebench_properties *const isotropic = plastic_wire(0.0), *const kinematic =
                                                                          plastic_wire(1.0);
    struct wirebench_bending one = {.size = sizeof one}, other = {.size = sizeof other};
    const double curvature = 25.0;
    double moments[2];
    assert_success(wirebench_moments(isotropic, 1, &curvature, &moments[0]));
    assert_success(wirebench_moments(kinematic, 1, &curvature, &moments[1]));
    assert_close_relative(moments[0], moments[1], 5e-3);
    assert_success(wirebench_bend(isotropic, curvature, &one));
    assert_success(wirebench_bend(kinematic, curvature, &other));
    assert_true(one.residual_curvature_ratio > 1.2 * other.residual_curvature_ratio);
    wirebench_properties_destroy(isotropic);
    wirebench_properties_destroy(kinematic);
}

/* Parallel parts whose yield limits grow: after yielding each keeps a modulus of beta times its
 * own, and unloading begins with a wider elastic range than with kinematic hardening. */
static void combined_hardening_of_parallel_parts_widens_the_elastic_range(void **state)
{
    (void)state;
    const double beta = 0.2, curvature = 40.0;
    struct wirebench_law law = {.size = sizeof law,
                                .outer_diameter = DIAMETER,
                                .poissons_ratio = 0.3,
                                .n_parts = 1,
                                .parts = {{MODULUS, 1e-3}},
                                .kinematic_share = 1.0 - beta,
                                .is_combined = 1};
    struct wirebench_properties *combined = NULL, *kinematic = NULL;
    struct wirebench_bending one = {.size = sizeof one}, other = {.size = sizeof other};
    assert_success(wirebench_properties_create(&combined, &law));
    /* The same virgin curve from kinematic parts: one yields, one stays elastic. */
    law.n_parts = 2;
    law.parts[0].modulus = (1.0 - beta) * MODULUS;
    law.parts[1] = (struct wirebench_part){beta * MODULUS, (double)INFINITY};
    law.kinematic_share = 1.0;
    law.is_combined = 0;
    assert_success(wirebench_properties_create(&kinematic, &law));
    double moments[2];
    assert_success(wirebench_moments(combined, 1, &curvature, &moments[0]));
    assert_success(wirebench_moments(kinematic, 1, &curvature, &moments[1]));
    assert_close_relative(moments[0], moments[1], 1e-9);
    assert_success(wirebench_bend(combined, curvature, &one));
    assert_success(wirebench_bend(kinematic, curvature, &other));
    assert_true(one.residual_curvature_ratio > other.residual_curvature_ratio);
    wirebench_properties_destroy(combined);
    wirebench_properties_destroy(kinematic);
    /* With all hardening isotropic the parts would never yield. */
    law.kinematic_share = 0.0;
    law.is_combined = 1;
    assert_int_equal(wirebench_properties_create(&combined, &law), WIREBENCH_ERR_ARGUMENT);
}

static void a_natural_shape_and_weight_change_the_force_alone(void **state)
{
    (void)state;
    struct wirebench_law law = {.size = sizeof law,
                                .outer_diameter = DIAMETER,
                                .mass_per_length = 4e-3,
                                .youngs_modulus = MODULUS};
    struct wirebench_properties *wire = NULL;
    assert_success(wirebench_properties_create(&wire, &law));
    const double deflection[] = {0.0, 0.01};
    double tension[2], force[2];
    const struct wirebench_cantilever heavy = {
        .size = sizeof heavy, .length = LENGTH, .gravity = 9.80665};
    struct wirebench_cantilever bowed = {.size = sizeof bowed, .length = LENGTH};
    bowed.n_natural_shape = 1;
    bowed.natural_shape[0] = 0.1;
    struct wirebench_cantilever_result result = {
        .size = sizeof result, .force = force, .tension = tension};
    assert_success(wirebench_solve_cantilever(wire, &heavy, 2, deflection, &result));
    /* Held at zero deflection, one end of a clamped and propped beam carries 3/8 of the weight. */
    assert_close_relative(tension[0], 0.375 * 4e-3 * LENGTH * 9.80665, 2e-3);
    assert_close(force[0], 0.0, 1e-12);
    assert_success(wirebench_solve_cantilever(wire, &bowed, 2, deflection, &result));
    /* Held down to y = 0 from its natural offset, 0.1 L / 2. */
    assert_close_relative(tension[0], -3.0 * rigidity() * 0.05 * LENGTH / pow(LENGTH, 3), 2e-2);
    wirebench_properties_destroy(wire);
}

/* --- structs of other releases, and misuse --- */

static void a_shorter_struct_is_filled_up_to_its_size(void **state)
{
    (void)state;
    struct wirebench_properties *const wire = elastic_wire();
    struct wirebench_bending bending;
    memset(&bending, 0x5a, sizeof bending);
    bending.size = offsetof(struct wirebench_bending, loop_energy);
    double untouched;
    memset(&untouched, 0x5a, sizeof untouched);
    assert_success(wirebench_bend(wire, 30.0, &bending));
    assert_close(bending.residual_curvature_ratio, 0.0, 1e-9);
    assert_memory_equal(&bending.loop_energy, &untouched, sizeof untouched);
    assert_int_equal(bending.size, offsetof(struct wirebench_bending, loop_energy));
    wirebench_properties_destroy(wire);
}

static void a_longer_struct_is_accepted_if_its_new_members_are_zero(void **state)
{
    (void)state;
    struct {
        struct wirebench_law law;
        double future;
    } longer = {.law = {.size = sizeof longer, .outer_diameter = DIAMETER, .youngs_modulus = 1e9}};
    struct wirebench_properties *wire = NULL;
    assert_success(wirebench_properties_create(&wire, &longer.law));
    wirebench_properties_destroy(wire);
    wire = NULL;
    longer.future = 1.0;
    assert_int_equal(wirebench_properties_create(&wire, &longer.law), WIREBENCH_ERR_ARGUMENT);
    assert_says("this release");
    assert_null(wire);
}

static void misuse_is_rejected_with_the_expected_value(void **state)
{
    (void)state;
    struct wirebench_properties *wire = NULL, *const elastic = elastic_wire();
    struct wirebench_law law = {.size = 0, .outer_diameter = DIAMETER, .youngs_modulus = 1e9};
    assert_int_equal(wirebench_properties_create(&wire, &law), WIREBENCH_ERR_ARGUMENT);
    assert_says("size");
    law.size = sizeof law;
    law.outer_diameter = -1.0;
    assert_int_equal(wirebench_properties_create(&wire, &law), WIREBENCH_ERR_ARGUMENT);
    assert_says("outer_diameter: -1: expected metres, above 0");
    assert_int_equal(wirebench_properties_create(&wire, NULL), WIREBENCH_ERR_ARGUMENT);
    assert_int_equal(wirebench_properties_read(&wire, "no-such-wire"), WIREBENCH_ERR_NOT_FOUND);
    assert_says("no-such-wire");
    assert_null(wire);
    const double bad = (double)NAN, at = 0.1;
    double moment;
    assert_int_equal(wirebench_moments(elastic, 1, &bad, &moment), WIREBENCH_ERR_ARGUMENT);
    const struct wirebench_cantilever test = {
        .size = sizeof test, .length = LENGTH, .n_positions = 1, .positions = &at};
    struct wirebench_cantilever_result result = {.size = sizeof result};
    assert_int_equal(wirebench_solve_cantilever(elastic, &test, 1, &at, &result),
                     WIREBENCH_ERR_ARGUMENT);
    assert_says("position 0: 0.1");
    assert_int_equal(wirebench_calibrate(&wire, NULL, 0, NULL), WIREBENCH_ERR_ARGUMENT);
    wirebench_properties_destroy(elastic);
}

static void rows_beyond_the_solvers_reach_are_nan_and_counted(void **state)
{
    (void)state;
    struct wirebench_properties *const wire = elastic_wire();
    /* The wire's end reaches the rollers. */
    const double deflection[] = {1e-3, 0.5};
    double force[2];
    const struct wirebench_three_point test = {.size = sizeof test, .span = 0.04, .overhang = 1e-3};
    struct wirebench_three_point_result result = {.size = sizeof result, .force = force};
    assert_int_equal(wirebench_solve_three_point(wire, &test, 2, deflection, &result),
                     WIREBENCH_INCOMPLETE);
    assert_int_equal(result.n_done, 1);
    assert_true(isfinite(force[0]) && isnan(force[1]));
    assert_says("row 1 of 2");
    wirebench_properties_destroy(wire);
}

/* --- recordings and datasets --- */

static void a_recordings_tables_have_as_many_rows_as_its_streams_samples(void **state)
{
    (void)state;
    struct wirebench_recording *recording = NULL;
    struct wirebench_recording_info info = {.size = sizeof info};
    const struct wirebench_table *load, *stage, *events;
    assert_success(wirebench_recording_open(&recording, recording_path));
    assert_success(wirebench_recording_describe(recording, &info));
    assert_true(info.is_whole && info.is_virtual && info.n_problems == 0);
    assert_int_equal(info.n_streams, 3);
    assert_success(wirebench_recording_table(recording, "load", &load));
    assert_success(wirebench_recording_table(recording, "stage", &stage));
    assert_success(wirebench_recording_table(recording, "events", &events));
    uint64_t samples[3] = {0};
    for (int i = 0; i < 3; i++) {
        struct wirebench_stream stream = {.size = sizeof stream};
        assert_success(wirebench_recording_stream(recording, i, &stream));
        samples[stream.role] += stream.samples;
    }
    assert_int_equal(wirebench_table_rows(load), samples[WIREBENCH_LOAD]);
    assert_int_equal(wirebench_table_rows(stage), samples[WIREBENCH_STAGE]);
    assert_int_equal(wirebench_table_rows(events), info.events);
    assert_true(samples[WIREBENCH_LOAD] > 1000);
    assert_non_null(strstr(wirebench_recording_meta(recording, "specimen"), "wire: type1"));
    assert_null(wirebench_recording_meta(recording, "no such key"));
    wirebench_recording_close(recording);
}

static void columns_have_one_array_and_times_that_agree(void **state)
{
    (void)state;
    struct wirebench_recording *recording = NULL;
    const struct wirebench_table *table;
    struct wirebench_recording_info info = {.size = sizeof info};
    struct wirebench_column t = {.size = sizeof t}, t_ns = {.size = sizeof t_ns},
                            text = {.size = sizeof text};
    assert_success(wirebench_recording_open(&recording, recording_path));
    assert_success(wirebench_recording_describe(recording, &info));
    assert_success(wirebench_recording_table(recording, "events", &table));
    assert_success(wirebench_table_find(table, "t_s", &t));
    assert_success(wirebench_table_find(table, "t_ns", &t_ns));
    assert_success(wirebench_table_column(table, 3, &text));
    assert_int_equal(wirebench_table_columns(table), 4);
    assert_true(t.reals && !t.integers && !t.texts && t_ns.integers && text.texts);
    assert_string_equal(t.unit, "s");
    for (size_t i = 0; i < t.n; i++) {
        assert_close(t.reals[i], (double)(t_ns.integers[i] - info.first_ns) * 1e-9, 1e-9);
        assert_true(strlen(text.texts[i]) > 0);
    }
    assert_int_equal(wirebench_table_find(table, "force_N", &t), WIREBENCH_ERR_NOT_FOUND);
    assert_says("table 'events' has no column 'force_N'");
    assert_int_equal(wirebench_recording_table(recording, "forces", &table),
                     WIREBENCH_ERR_NOT_FOUND);
    wirebench_recording_close(recording);
}

static void a_truncated_recording_is_reported_as_incomplete(void **state)
{
    (void)state;
    char command[10000], path[64];
    snprintf(path, sizeof path, "%s/short.wbr", folder);
    snprintf(command, sizeof command, "zstd -dqf '%s' -o '%s' && truncate -s 3000000 '%s'",
             recording_path, path, path);
    assert_int_equal(system(command), 0);
    struct wirebench_recording *recording = NULL;
    struct wirebench_recording_info info = {.size = sizeof info};
    const struct wirebench_table *load;
    enum wirebench_status status = wirebench_recording_open(&recording, path);
    assert_success(status);
    assert_non_null(strstr(wirebench_warnings(), "short.wbr"));
    assert_success(wirebench_recording_describe(recording, &info));
    assert_false(info.is_whole);
    assert_true(info.n_problems > 0 && wirebench_recording_problem(recording, 0));
    assert_null(wirebench_recording_problem(recording, info.n_problems));
    status = wirebench_recording_table(recording, "load", &load);
    assert_int_equal(status, WIREBENCH_INCOMPLETE);
    assert_says("short.wbr");
    assert_true(wirebench_table_rows(load) > 100);
    wirebench_recording_close(recording);
}

static struct wirebench_dataset *read_dataset(void)
{
    struct wirebench_dataset *dataset = NULL;
    assert_success(wirebench_dataset_read(&dataset, dataset_folder));
    return dataset;
}

/* The first data line of the dataset's CSV, parsed by the C library. */
static void a_dataset_is_its_csv_in_si(void **state)
{
    (void)state;
    struct wirebench_dataset *const dataset = read_dataset();
    const struct wirebench_table *rows;
    struct wirebench_column deflection = {.size = sizeof deflection},
                            force = {.size = sizeof force}, phase = {.size = sizeof phase};
    struct wirebench_dataset_info info = {.size = sizeof info};
    assert_success(wirebench_dataset_describe(dataset, &info));
    assert_string_equal(info.wire, "type1");
    assert_close(info.length, 0.085, 1e-12);
    assert_true(info.kind == WIREBENCH_CANTILEVER && info.is_virtual && info.strand_length > 0.1);
    assert_success(wirebench_dataset_table(dataset, "force_deflection", &rows));
    assert_success(wirebench_table_find(rows, "deflection_m", &deflection));
    assert_success(wirebench_table_find(rows, "force_N", &force));
    assert_success(wirebench_table_find(rows, "phase", &phase));
    char path[5000], line[1000], name[16];
    snprintf(path, sizeof path, "%s/force_deflection.csv", dataset_folder);
    FILE *const file = fopen(path, "r");
    assert_non_null(file);
    size_t n = 0;
    while (fgets(line, sizeof line, file)) {
        double mm, newtons;
        if (sscanf(line, "%*[^,],%*d,%15[a-z],%lf,%*[^,],%lf", name, &mm, &newtons) != 3)
            continue;
        assert_true(n < deflection.n);
        assert_close(deflection.reals[n], mm * 1e-3, 1e-15);
        assert_close(force.reals[n], newtons, 0.0);
        assert_string_equal(phase.texts[n], name);
        n++;
    }
    fclose(file);
    assert_int_equal(n, deflection.n);
    assert_true(n > 100);
    assert_non_null(strstr(wirebench_dataset_json(dataset), "\"sha256\""));
    wirebench_dataset_close(dataset);
}

/* Two NaN are equal. */
static void assert_columns_equal(const struct wirebench_table *a, const struct wirebench_table *b)
{
    assert_int_equal(wirebench_table_columns(a), wirebench_table_columns(b));
    for (int i = 0; i < wirebench_table_columns(a); i++) {
        struct wirebench_column one = {.size = sizeof one}, other = {.size = sizeof other};
        assert_success(wirebench_table_column(a, i, &one));
        assert_success(wirebench_table_column(b, i, &other));
        assert_string_equal(one.name, other.name);
        assert_int_equal(one.n, other.n);
        for (size_t k = 0; k < one.n; k++) {
            if (one.type == WIREBENCH_REAL && one.reals[k] != other.reals[k] &&
                !(isnan(one.reals[k]) && isnan(other.reals[k])))
                fail_msg("%s, row %zu: %.17g is not %.17g", one.name, k, one.reals[k],
                         other.reals[k]);
            if (one.type == WIREBENCH_INTEGER)
                assert_int_equal(one.integers[k], other.integers[k]);
            if (one.type == WIREBENCH_TEXT)
                assert_string_equal(one.texts[k], other.texts[k]);
        }
    }
}

/* The stored recording has a gap of a second in which the tip's marker is hidden. */
static void a_recording_is_aligned_to_the_dataset_that_the_tool_writes(void **state)
{
    (void)state;
    struct wirebench_dataset *aligned = NULL, *const written = read_dataset();
    struct wirebench_dataset_info a = {.size = sizeof a}, b = {.size = sizeof b};
    assert_int_equal(wirebench_dataset_align(&aligned, recording_path, NULL), WIREBENCH_INCOMPLETE);
    assert_says("type1-L85-1.wbr.zst: the test is incomplete: 1 gap in the rows");
    assert_non_null(strstr(wirebench_warnings(), "1 gap in the rows"));
    static const char *const names[] = {"force_deflection", "shape"};
    for (int i = 0; i < 2; i++) {
        const struct wirebench_table *one, *other;
        assert_success(wirebench_dataset_table(aligned, names[i], &one));
        assert_success(wirebench_dataset_table(written, names[i], &other));
        assert_true(wirebench_table_rows(one) > 1000);
        assert_columns_equal(one, other);
    }
    assert_success(wirebench_dataset_describe(aligned, &a));
    assert_success(wirebench_dataset_describe(written, &b));
    assert_string_equal(a.wire, b.wire);
    a.wire = b.wire = NULL;
    assert_memory_equal(&a, &b, sizeof a);
    assert_string_equal(wirebench_dataset_json(aligned), wirebench_dataset_json(written));
    wirebench_dataset_close(aligned);
    wirebench_dataset_close(written);
}

static void options_and_files_of_an_alignment_are_used(void **state)
{
    (void)state;
    char path[64];
    snprintf(path, sizeof path, "%s/specimen.yaml", folder);
    struct wirebench_recording *recording = NULL;
    assert_success(wirebench_recording_open(&recording, recording_path));
    const char *const recorded = wirebench_recording_meta(recording, "specimen");
    const char *const sample = strstr(recorded, "sample: 1");
    assert_non_null(sample);
    FILE *const file = fopen(path, "w");
    fprintf(file, "%.*ssample: 7%s", (int)(sample - recorded), recorded,
            sample + strlen("sample: 1"));
    fclose(file);
    wirebench_recording_close(recording);
    static const char *const given[] = {"longest-gap-s=5", "row-rate=2", NULL};
    const struct wirebench_alignment alignment = {
        .size = sizeof alignment, .specimen = path, .options = given};
    struct wirebench_dataset *aligned = NULL;
    struct wirebench_dataset_info info = {.size = sizeof info};
    const struct wirebench_table *rows;
    /* With a limit of 5 s it is not a gap, and nothing is missing. */
    assert_success(wirebench_dataset_align(&aligned, recording_path, &alignment));
    assert_non_null(strstr(wirebench_warnings(), "sample"));
    assert_success(wirebench_dataset_describe(aligned, &info));
    assert_int_equal(info.sample, 7);
    assert_true(info.is_complete);
    assert_success(wirebench_dataset_table(aligned, "force_deflection", &rows));
    assert_true(wirebench_table_rows(rows) > 500 && wirebench_table_rows(rows) < 700);
    wirebench_dataset_close(aligned);
}

static void failures_of_the_alignment_are_reported(void **state)
{
    (void)state;
    static const char *const bad[][2] = {{"row-rate=0", "expected a number"},
                                         {"no-such-option=1", "wirebench align --help"},
                                         {"row-rate", "row-rate=N"}};
    struct wirebench_dataset *dataset = NULL;
    assert_int_equal(wirebench_dataset_align(&dataset, "/no/such.wbr", NULL),
                     WIREBENCH_ERR_NOT_FOUND);
    assert_says("/no/such.wbr");
    assert_true(wirebench_dataset_align(&dataset, __FILE__, NULL) < 0);
    assert_int_equal(wirebench_dataset_align(&dataset, NULL, NULL), WIREBENCH_ERR_ARGUMENT);
    assert_says("recording_path");
    const struct wirebench_alignment unsized = {.rig = NULL};
    assert_int_equal(wirebench_dataset_align(&dataset, recording_path, &unsized),
                     WIREBENCH_ERR_ARGUMENT);
    assert_says("size is not set");
    const struct wirebench_alignment rig = {.size = sizeof rig, .rig = "/no/rig.yaml"};
    assert_int_equal(wirebench_dataset_align(&dataset, recording_path, &rig),
                     WIREBENCH_ERR_NOT_FOUND);
    assert_says("/no/rig.yaml");
    for (int i = 0; i < 3; i++) {
        const char *const options[] = {bad[i][0], NULL};
        const struct wirebench_alignment alignment = {.size = sizeof alignment, .options = options};
        assert_true(wirebench_dataset_align(&dataset, recording_path, &alignment) < 0);
        assert_says(bad[i][1]);
    }
    assert_null(dataset);
}

static void a_missing_file_is_reported_and_nothing_is_printed(void **state)
{
    (void)state;
    char path[64];
    snprintf(path, sizeof path, "%s/printed", folder);
    fflush(stdout);
    fflush(stderr);
    const int kept[2] = {dup(1), dup(2)}, file = open(path, O_CREAT | O_RDWR, 0600);
    assert_true(file >= 0 && dup2(file, 1) == 1 && dup2(file, 2) == 2);
    struct wirebench_recording *recording = NULL;
    struct wirebench_dataset *dataset = NULL;
    const enum wirebench_status one = wirebench_recording_open(&recording, "/no/such.wbr");
    const bool names_it = strstr(wirebench_message(), "/no/such.wbr") != NULL;
    const enum wirebench_status other = wirebench_dataset_read(&dataset, "/no/such");
    fflush(stdout);
    fflush(stderr);
    assert_true(dup2(kept[0], 1) == 1 && dup2(kept[1], 2) == 2);
    struct stat found;
    assert_int_equal(fstat(file, &found), 0);
    close(file);
    assert_int_equal(found.st_size, 0);
    assert_int_equal(one, WIREBENCH_ERR_NOT_FOUND);
    assert_true(names_it);
    assert_true(other < 0 && !recording && !dataset);
    assert_says("/no/such");
    assert_success(wirebench_dataset_read(&dataset, dataset_folder));
    assert_string_equal(wirebench_message(), "");
    wirebench_dataset_close(dataset);
}

/* --- calibration --- */

/* The files of the tool, from the same dataset. */
static void both_methods_give_the_text_that_the_tool_writes(void **state)
{
    (void)state;
    static const char *const names[] = {"cycle", "paper"};
    const enum wirebench_method methods[] = {WIREBENCH_METHOD_DEFAULT, WIREBENCH_METHOD_PAPER};
    const struct wirebench_dataset *const dataset = read_dataset();
    for (int i = 0; i < 2; i++) {
        struct wirebench_properties *calibrated = NULL, *again = NULL;
        struct wirebench_properties_info a = {.size = sizeof a}, b = {.size = sizeof b};
        const struct wirebench_calibration calibration = {.size = sizeof calibration,
                                                          .method = methods[i]};
        assert_success(wirebench_calibrate(&calibrated, &dataset, 1, &calibration));
        assert_success(wirebench_properties_describe(calibrated, &a));
        assert_string_equal(a.method, names[i]);
        char path[4096], text[20000];
        snprintf(path, sizeof path, "%s/%s.yaml", prepared_folder, names[i]);
        FILE *const file = fopen(path, "r");
        assert_non_null(file);
        text[fread(text, 1, sizeof text - 1, file)] = '\0';
        fclose(file);
        assert_string_equal(wirebench_properties_text(calibrated), text);
        assert_success(wirebench_properties_read(&again, path));
        assert_success(wirebench_properties_describe(again, &b));
        assert_close(a.youngs_modulus, b.youngs_modulus, 0.0);
        assert_close(a.rigidity.value, b.rigidity.value, 0.0);
        assert_int_equal(a.n_parts, b.n_parts);
        assert_int_equal(a.n_samples, 1);
        assert_true(a.rigidity.value > 1e-4 && a.rigidity.value < 1e-3);
        wirebench_properties_destroy(calibrated);
        wirebench_properties_destroy(again);
    }
    wirebench_dataset_close((struct wirebench_dataset *)dataset);
}

static void excluded_tests_are_rejected(void **state)
{
    (void)state;
    char command[6000], path[64];
    struct wirebench_dataset *dataset = NULL;
    struct wirebench_properties *calibrated = NULL;
    snprintf(path, sizeof path, "%s/excluded", folder);
    snprintf(command, sizeof command,
             "cp -r '%s' '%s' && sed -i -z 's/\"recordings\": *\\[[ \\n]*{/&\"excluded\": {"
             "\"by\": \"A. Tester\", \"reason\": \"it slipped\", \"date_utc\": "
             "\"2026-11-20\"},/' '%s/dataset.json'",
             dataset_folder, path, path);
    assert_int_equal(system(command), 0);
    assert_success(wirebench_dataset_read(&dataset, path));
    const struct wirebench_dataset *const given = dataset;
    assert_int_equal(wirebench_calibrate(&calibrated, &given, 1, NULL), WIREBENCH_ERR_DATA);
    assert_null(calibrated);
    assert_says("the test was excluded by A. Tester on 2026-11-20: it slipped. Leave");
    wirebench_dataset_close(dataset);
}

static int count_and_stop(void *context, int done, int all)
{
    (void)done, (void)all;
    ++*(int *)context;
    return 0;
}

static void progress_stops_a_calibration(void **state)
{
    (void)state;
    const struct wirebench_dataset *const dataset = read_dataset();
    struct wirebench_properties *properties = NULL;
    int calls = 0;
    const struct wirebench_calibration calibration = {.size = sizeof calibration,
                                                      .method = WIREBENCH_METHOD_PAPER,
                                                      .progress = count_and_stop,
                                                      .context = &calls};
    assert_int_equal(wirebench_calibrate(&properties, &dataset, 1, &calibration),
                     WIREBENCH_INCOMPLETE);
    assert_int_equal(calls, 1);
    assert_non_null(properties);
    wirebench_properties_destroy(properties);
    wirebench_dataset_close((struct wirebench_dataset *)dataset);
}

static void options_are_those_of_the_command(void **state)
{
    (void)state;
    static const char *const given[] = {"elastic-zone=0.1", NULL};
    static const char *const bad[][3] = {{"elastic-zone=much", "expected a number", NULL},
                                         {"no-such-option=1", "wirebench calibrate --help", NULL},
                                         {"elastic-zone", "elastic-zone=", NULL}};
    const struct wirebench_dataset *const dataset = read_dataset();
    struct wirebench_properties *properties = NULL;
    struct wirebench_calibration calibration = {
        .size = sizeof calibration, .method = WIREBENCH_METHOD_PAPER, .options = given};
    assert_success(wirebench_calibrate(&properties, &dataset, 1, &calibration));
    assert_non_null(strstr(wirebench_properties_text(properties), "elastic_zone: 0.1\n"));
    wirebench_properties_destroy(properties);
    for (int i = 0; i < 3; i++) {
        const char *const options[] = {bad[i][0], NULL};
        calibration.options = options;
        assert_true(wirebench_calibrate(&properties, &dataset, 1, &calibration) < 0);
        assert_says(bad[i][1]);
    }
    wirebench_dataset_close((struct wirebench_dataset *)dataset);
}

static void own_handler(const char *reason, const char *file, int line, int number)
{
    (void)reason, (void)file, (void)line, (void)number;
}

static void the_state_of_the_process_is_not_changed(void **state)
{
    (void)state;
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGCHLD, SIGFPE};
    struct sigaction before[6], after;
    char locale[64];
    snprintf(locale, sizeof locale, "%s", setlocale(LC_ALL, NULL));
    for (int i = 0; i < 6; i++)
        sigaction(signals[i], NULL, &before[i]);
    gsl_error_handler_t *const kept = gsl_set_error_handler(own_handler);
    const struct wirebench_dataset *const dataset = read_dataset();
    struct wirebench_properties *properties = NULL;
    struct wirebench_dataset *aligned = NULL;
    assert_true(wirebench_dataset_align(&aligned, recording_path, NULL) >= 0);
    wirebench_dataset_close(aligned);
    assert_ptr_equal(gsl_set_error_handler(own_handler), own_handler);
    assert_success(wirebench_calibrate(&properties, &dataset, 1, NULL));
    wirebench_properties_destroy(properties);
    assert_ptr_equal(gsl_set_error_handler(kept), own_handler);
    assert_string_equal(setlocale(LC_ALL, NULL), locale);
    for (int i = 0; i < 6; i++) {
        sigaction(signals[i], NULL, &after);
        assert_ptr_equal(after.sa_handler, before[i].sa_handler);
    }
    wirebench_dataset_close((struct wirebench_dataset *)dataset);
}

/* --- harnesses --- */

static struct wirebench_column column_of(struct wirebench_harness *harness, const char *name,
                                         const char *column)
{
    const struct wirebench_table *table = NULL;
    struct wirebench_column found = {.size = sizeof found};
    assert_success(wirebench_harness_table(harness, name, &table));
    assert_success(wirebench_table_find(table, column, &found));
    return found;
}

static struct wirebench_harness *small_harness(int n_steps)
{
    struct wirebench_harness *harness = NULL;
    assert_success(wirebench_harness_read(&harness, "small", NULL));
    for (int i = 0; i < n_steps; i++) {
        struct wirebench_harness_step step = {.size = sizeof step};
        assert_success(wirebench_harness_planned_step(harness, i, &step));
        assert_success(wirebench_harness_take_step(harness, &step));
    }
    return harness;
}

static void a_harness_is_moved_and_the_move_undone_bit_for_bit(void **state)
{
    (void)state;
    struct wirebench_harness *const harness = small_harness(2);
    struct wirebench_harness_info info = {.size = sizeof info};
    double before[3][500];
    static const char *const columns[] = {"x_m", "z_m", "moment_Nm"};
    const size_t n = column_of(harness, "shapes", "x_m").n;
    assert_true(n > 100 && n <= 500);
    for (int i = 0; i < 3; i++)
        memcpy(before[i], column_of(harness, "shapes", columns[i]).reals, n * sizeof(double));
    const struct wirebench_harness_step step = {
        .size = sizeof step, .kind = WIREBENCH_MOVE, .item = "C1", .position = {0.18, 0.02, 0.03}};
    assert_success(wirebench_harness_take_step(harness, &step));
    assert_success(wirebench_harness_describe(harness, &info));
    assert_int_equal(info.state, 3);
    assert_string_equal(info.step, "move C1");
    assert_true(info.is_converged && info.fraction == 1.0 && info.plastic > 0.0);
    assert_memory_not_equal(before[0], column_of(harness, "shapes", "x_m").reals,
                            n * sizeof(double));
    const struct wirebench_column item = column_of(harness, "items", "item");
    assert_string_equal(item.texts[3], "C1");
    assert_close(column_of(harness, "items", "x_m").reals[3], 0.18, 1e-10);
    assert_close(column_of(harness, "items", "z_m").reals[3], 0.03, 1e-10);
    assert_int_equal(column_of(harness, "items", "mounted").integers[1], 0);
    assert_int_equal(column_of(harness, "forces", "force_N").n, 2);
    assert_true(isnan(column_of(harness, "forces", "slid_m").reals[1]));
    assert_int_equal(column_of(harness, "branches", "least_radius_m").n, 3);
    assert_success(wirebench_harness_undo(harness, 1));
    for (int i = 0; i < 3; i++)
        assert_memory_equal(before[i], column_of(harness, "shapes", columns[i]).reals,
                            n * sizeof(double));
    wirebench_harness_destroy(harness);
}

static void a_snapshot_of_a_harness_is_restored(void **state)
{
    (void)state;
    struct wirebench_harness *const harness = small_harness(2);
    struct wirebench_harness_info info = {.size = sizeof info};
    const struct wirebench_harness_step release = {
        .size = sizeof release, .kind = WIREBENCH_RELEASE, .item = "C1"};
    const double force = column_of(harness, "forces", "force_N").reals[1];
    assert_success(wirebench_harness_snapshot(harness, "mounted"));
    assert_success(wirebench_harness_take_step(harness, &release));
    assert_int_equal(column_of(harness, "forces", "force_N").n, 1);
    assert_success(wirebench_harness_restore(harness, "mounted"));
    assert_true(column_of(harness, "forces", "force_N").reals[1] == force);
    assert_success(wirebench_harness_describe(harness, &info));
    assert_int_equal(info.state, 2);
    wirebench_harness_destroy(harness);
}

static void an_elastic_harness_does_not_yield(void **state)
{
    (void)state;
    const struct wirebench_harness_settings settings = {
        .size = sizeof settings, .is_elastic = 1, .element_length = 0.02};
    const struct wirebench_harness_step hang = {.size = sizeof hang, .kind = WIREBENCH_HANG};
    struct wirebench_harness_info info = {.size = sizeof info};
    struct wirebench_harness *harness = NULL;
    assert_success(wirebench_harness_read(&harness, "small", &settings));
    assert_success(wirebench_harness_take_step(harness, &hang));
    assert_success(wirebench_harness_describe(harness, &info));
    assert_close(info.plastic, 0.0, 1e-9 * info.elastic);
    /* 15, 10 and 13 elements of two places, and both ends of three branches. */
    assert_int_equal(column_of(harness, "shapes", "s_m").n, 2 * (15 + 10 + 13) + 6);
    wirebench_harness_destroy(harness);
}

static void steps_that_are_not_possible_are_rejected(void **state)
{
    (void)state;
    static const struct {
        struct wirebench_harness_step step;
        enum wirebench_status status;
        const char *message;
    } wrong[] = {
        {{.size = sizeof wrong->step, .kind = WIREBENCH_HANG},
         WIREBENCH_ERR_ARGUMENT,
         "hang: the harness hangs already"},
        {{.size = sizeof wrong->step, .kind = (enum wirebench_harness_step_kind)9},
         WIREBENCH_ERR_ARGUMENT,
         "kind: 9: expected 0 to 4"},
        {{.size = sizeof wrong->step, .kind = WIREBENCH_MOVE, .item = "X"},
         WIREBENCH_ERR_NOT_FOUND,
         "no connector, clip or root is named 'X'"},
        {{.size = sizeof wrong->step, .kind = WIREBENCH_RELEASE},
         WIREBENCH_ERR_NOT_FOUND,
         "no connector, clip or root is named ''"},
        {{.size = sizeof wrong->step, .kind = WIREBENCH_MOVE, .item = "K1"},
         WIREBENCH_ERR_ARGUMENT,
         "move K1: K1 is not mounted"},
        {{.size = sizeof wrong->step,
          .kind = WIREBENCH_MOVE,
          .item = "C1",
          .position = {0.19, 0.0, 0.13}},
         WIREBENCH_ERR_ARGUMENT,
         "move C1: C1 to R: 230.2 mm apart, 200 mm of wire"},
        {{.size = sizeof wrong->step,
          .kind = WIREBENCH_MOVE,
          .item = "C1",
          .position = {(double)NAN, 0.0, 0.0}},
         WIREBENCH_ERR_ARGUMENT,
         "position: nan"},
        {{.size = sizeof wrong->step,
          .kind = WIREBENCH_MOVE,
          .item = "C1",
          .direction = {(double)INFINITY, 0.0, 0.0}},
         WIREBENCH_ERR_ARGUMENT,
         "direction: expected finite numbers"},
        {{.size = sizeof wrong->step,
          .kind = WIREBENCH_MOUNT,
          .item = "K1",
          .position = {0.4, 0.0, 0.0},
          .direction = {0.0, 0.0, 3.0},
          .up = {0.0, 0.0, 1.0}},
         WIREBENCH_ERR_ARGUMENT,
         "mount K1: it is parallel to `up`"},
        {{.size = 0}, WIREBENCH_ERR_ARGUMENT, "its size is not set"},
    };
    struct wirebench_harness *const harness = small_harness(2);
    struct wirebench_harness *none = NULL;
    struct wirebench_harness_step step = {.size = sizeof step};
    struct wirebench_harness_info info = {.size = sizeof info};
    const struct wirebench_table *table = NULL;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_int_equal(wirebench_harness_take_step(harness, &wrong[i].step), wrong[i].status);
        assert_says(wrong[i].message);
    }
    assert_int_equal(wirebench_harness_undo(harness, 3), WIREBENCH_ERR_ARGUMENT);
    assert_says("undo: 3: expected 1 to 2");
    assert_int_equal(wirebench_harness_restore(harness, "none"), WIREBENCH_ERR_ARGUMENT);
    assert_says("no snapshot is named 'none'");
    assert_int_equal(wirebench_harness_snapshot(harness, ""), WIREBENCH_ERR_ARGUMENT);
    assert_int_equal(wirebench_harness_planned_step(harness, 7, &step), WIREBENCH_ERR_NOT_FOUND);
    assert_says("step 7: expected 0 to 6");
    assert_int_equal(wirebench_harness_table(harness, "force", &table), WIREBENCH_ERR_NOT_FOUND);
    assert_int_equal(wirebench_harness_read(&none, "no-such", NULL), WIREBENCH_ERR_NOT_FOUND);
    assert_null(none);
    assert_success(wirebench_harness_describe(harness, &info));
    assert_int_equal(info.state, 2);
    wirebench_harness_destroy(harness);
}

/* --- threads --- */

struct thread {
    pthread_t id;
    pthread_barrier_t *barrier;
    int number;
    int wrong;
};

static void *solve_after_an_error(void *context)
{
    struct thread *const thread = context;
    char path[32];
    snprintf(path, sizeof path, "/no/such-%d.wbr", thread->number);
    struct wirebench_recording *recording = NULL;
    const enum wirebench_status status = wirebench_recording_open(&recording, path);
    /* All threads have failed before any reads its message. */
    pthread_barrier_wait(thread->barrier);
    if (status != WIREBENCH_ERR_NOT_FOUND || !strstr(wirebench_message(), path))
        thread->wrong++;
    const struct wirebench_law law = {.size = sizeof law,
                                      .outer_diameter = DIAMETER,
                                      .youngs_modulus = MODULUS * (1 + thread->number)};
    struct wirebench_properties *wire = NULL;
    const struct wirebench_cantilever test = {.size = sizeof test, .length = LENGTH};
    const double deflection = 1e-4;
    double force = 0.0;
    struct wirebench_cantilever_result result = {.size = sizeof result, .force = &force};
    const double expected = 3.0 * rigidity() * (1 + thread->number) * 1e-4 / pow(LENGTH, 3);
    if (wirebench_properties_create(&wire, &law) != 0 ||
        wirebench_solve_cantilever(wire, &test, 1, &deflection, &result) != 0 ||
        !(fabs(force - expected) < 2e-3 * expected))
        thread->wrong++;
    wirebench_properties_destroy(wire);
    return NULL;
}

static void each_thread_has_its_own_messages(void **state)
{
    (void)state;
    struct thread threads[4];
    pthread_barrier_t barrier;
    assert_int_equal(pthread_barrier_init(&barrier, NULL, 4), 0);
    for (int i = 0; i < 4; i++) {
        threads[i] = (struct thread){.barrier = &barrier, .number = i};
        assert_int_equal(pthread_create(&threads[i].id, NULL, solve_after_an_error, &threads[i]),
                         0);
    }
    for (int i = 0; i < 4; i++) {
        pthread_join(threads[i].id, NULL);
        assert_int_equal(threads[i].wrong, 0);
    }
    pthread_barrier_destroy(&barrier);
}

#define FACT(name) cmocka_unit_test(name)

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        FACT(an_elastic_wire_bends_by_its_rigidity_and_springs_back),
        FACT(an_elastic_cantilever_follows_the_cubic_formula),
        FACT(elastic_three_point_bending_follows_the_cubic_formula),
        FACT(kinematic_hardening_has_the_same_loading_and_less_springback),
        FACT(combined_hardening_of_parallel_parts_widens_the_elastic_range),
        FACT(a_natural_shape_and_weight_change_the_force_alone),
        FACT(a_shorter_struct_is_filled_up_to_its_size),
        FACT(a_longer_struct_is_accepted_if_its_new_members_are_zero),
        FACT(misuse_is_rejected_with_the_expected_value),
        FACT(rows_beyond_the_solvers_reach_are_nan_and_counted),
        FACT(a_recordings_tables_have_as_many_rows_as_its_streams_samples),
        FACT(columns_have_one_array_and_times_that_agree),
        FACT(a_truncated_recording_is_reported_as_incomplete),
        FACT(a_dataset_is_its_csv_in_si),
        FACT(a_recording_is_aligned_to_the_dataset_that_the_tool_writes),
        FACT(options_and_files_of_an_alignment_are_used),
        FACT(failures_of_the_alignment_are_reported),
        FACT(a_missing_file_is_reported_and_nothing_is_printed),
        FACT(both_methods_give_the_text_that_the_tool_writes),
        FACT(excluded_tests_are_rejected),
        FACT(progress_stops_a_calibration),
        FACT(options_are_those_of_the_command),
        FACT(the_state_of_the_process_is_not_changed),
        FACT(a_harness_is_moved_and_the_move_undone_bit_for_bit),
        FACT(a_snapshot_of_a_harness_is_restored),
        FACT(an_elastic_harness_does_not_yield),
        FACT(steps_that_are_not_possible_are_rejected),
        FACT(each_thread_has_its_own_messages),
    };
    if (argc != 3) {
        fprintf(stderr, "usage: test_library RECORDING DATASET\n");
        return 2;
    }
    snprintf(recording_path, sizeof recording_path, "%s", argv[1]);
    snprintf(prepared_folder, sizeof prepared_folder, "%s", argv[2]);
    snprintf(dataset_folder, sizeof dataset_folder, "%s/dataset", prepared_folder);
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
