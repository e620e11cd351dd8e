/* The simulated load cell, tested with the real drivers. */
#include "fixtures/virtual/sim_cell.h"

#include <stdlib.h>

#include "daq/protocol/drivers.h"
#include "daq/protocol/loadcell_preset.h"
#include "tests/virtual/setup.h"

struct received {
    int n, overloads, unstable;
    double last, sum, squares;
    int remarks;
};

static void hear(void *context, const struct wb_load_sample *sample)
{
    struct received *const received = context;
    received->n++;
    received->overloads += sample->overload;
    received->unstable += sample->unstable;
    if (sample->valid) {
        received->last = sample->force;
        received->sum += sample->force;
        received->squares += sample->force * sample->force;
    }
}

static void hear_remark(void *context, enum wb_log_level level, int64_t t_ns, const char *kind,
                        const char *text)
{
    (void)t_ns;
    (void)kind;
    (void)text;
    if (level < WB_LOG_INFO)
        ((struct received *)context)->remarks++;
}

/* A cell, its driver, and the tension. */
struct scene {
    struct setup setup;
    struct wb_sim_cell cell;
    const struct wb_driver *driver;
    void *state;
    struct received received;
    struct wb_sink sink;
    uint64_t k;
    int64_t now_ns;
};

static void pass_on(struct scene *scene)
{
    uint8_t bytes[WB_REPLY_BYTES];
    struct wb_outbox outbox;
    wb_outbox_clear(&outbox);
    scene->driver->tick(scene->state, scene->now_ns, &outbox);
    wb_sim_cell_receive(&scene->cell, outbox.bytes, outbox.n_bytes);
    const size_t n = wb_reply_take(&scene->cell.out, bytes, sizeof bytes);
    if (n > 0)
        scene->driver->receive(scene->state, scene->now_ns, bytes, n, &scene->sink);
}

static void open_scene(struct scene *scene)
{
    struct wb_outbox outbox;
    assert_int_equal(wb_sim_cell_init(&scene->cell, &scene->setup.truth, &scene->setup.rig), WB_OK);
    scene->driver = wb_drivers_find(WB_ROLE_LOAD, scene->setup.rig.load_cell.protocol);
    assert_non_null(scene->driver);
    scene->state = calloc(1, scene->driver->state_size);
    assert_non_null(scene->state);
    assert_int_equal(scene->driver->init(scene->state, &scene->setup.rig), WB_OK);
    scene->sink =
        (struct wb_sink){.context = &scene->received, .load = hear, .remark = hear_remark};
    wb_outbox_clear(&outbox);
    scene->driver->start(scene->state, 0, &outbox);
    wb_sim_cell_receive(&scene->cell, outbox.bytes, outbox.n_bytes);
}

static void make_scene(struct scene *scene)
{
    memset(scene, 0, sizeof *scene);
    setup_bench(&scene->setup, "type1-L85-1", 6);
}

static void close_scene(struct scene *scene)
{
    free(scene->state);
}

/* The next reading, for `tension`. */
static void weigh(struct scene *scene, double tension)
{
    const double t = wb_sim_cell_time(&scene->cell, scene->k);
    scene->now_ns = wb_ns_from_seconds(t);
    wb_sim_cell_read(&scene->cell, scene->k++, t, tension);
    pass_on(scene);
}

static void constant_load_reads_offset_noise_and_drift(void **state)
{
    (void)state;
    struct scene scene;
    make_scene(&scene);
    scene.setup.truth.cell_drift = 0.0;
    open_scene(&scene);
    const int n = 8000;
    weigh(&scene, 0.1);
    memset(&scene.received, 0, sizeof scene.received);
    for (int i = 0; i < n; i++)
        weigh(&scene, 0.1);
    const double mg = WB_MG * WB_STANDARD_GRAVITY;
    assert_int_equal(scene.received.n, n);
    assert_int_equal(scene.received.remarks, 0);
    const double mean = scene.received.sum / n;
    const double variance = scene.received.squares / n - mean * mean;
    assert_close(mean, 0.1 + scene.setup.truth.cell_offset, 5.0 * 10.0 * mg / sqrt(n));
    assert_close(sqrt(variance), 10.0 * mg, 10.0 * mg * 5.0 / sqrt(2.0 * n));
    /* Integer milligrams. */
    const double in_mg = scene.received.last / mg;
    assert_close(in_mg, round(in_mg), 1e-6);
    close_scene(&scene);
}

static void zero_drifts_by_two_milligrams_a_minute(void **state)
{
    (void)state;
    struct scene scene;
    make_scene(&scene);
    open_scene(&scene);
    const double mg = WB_MG * WB_STANDARD_GRAVITY;
    double means[2];
    for (int minute = 0; minute < 2; minute++) {
        const int n = 2000;
        memset(&scene.received, 0, sizeof scene.received);
        while (scene.k < (uint64_t)(minute * 60 * 60 * 80))
            wb_sim_cell_read(&scene.cell, scene.k, wb_sim_cell_time(&scene.cell, scene.k), 0.0),
                scene.k++;
        char dropped[WB_REPLY_BYTES];
        wb_reply_take(&scene.cell.out, dropped, sizeof dropped);
        for (int i = 0; i < n; i++)
            weigh(&scene, 0.0);
        means[minute] = scene.received.sum / scene.received.n;
    }
    const double hour = 60.0 * 80.0 / scene.setup.truth.cell_rate;
    assert_close(fabs(means[1] - means[0]), 2.0 * mg * hour, 1.5 * mg);
    close_scene(&scene);
}

static void the_filter_lags_fifty_milliseconds_behind_a_ramp(void **state)
{
    (void)state;
    struct scene scene;
    make_scene(&scene);
    scene.setup.truth.cell_noise = 1e-12;
    scene.setup.truth.cell_drift = scene.setup.truth.cell_offset = 0.0;
    scene.setup.truth.cell_resolution = 1e-9;
    scene.setup.truth.cell_filter = 0.05;
    open_scene(&scene);
    const double slope = 4e-3; /* N/s */
    for (int i = 0; i < 400; i++)
        weigh(&scene, slope * wb_sim_cell_time(&scene.cell, scene.k));
    const double t = wb_sim_cell_time(&scene.cell, scene.k - 1);
    assert_close(scene.cell.filtered, slope * (t - 0.05), 1e-9);
    close_scene(&scene);
}

static void the_filter_answers_a_step_exponentially(void **state)
{
    (void)state;
    struct scene scene;
    make_scene(&scene);
    open_scene(&scene);
    weigh(&scene, 0.0);
    weigh(&scene, 0.0);
    const double dt = 1.0 / scene.setup.truth.cell_rate, tau = 0.05;
    /* A step is a steep ramp over one reading, then constant. */
    weigh(&scene, 0.1);
    const double after = scene.cell.filtered;
    assert_close(after, 0.1 * (1.0 - tau / dt * (1.0 - exp(-dt / tau))), 1e-12);
    for (int i = 1; i <= 10; i++) {
        weigh(&scene, 0.1);
        assert_close(scene.cell.filtered, 0.1 + (after - 0.1) * exp(-i * dt / tau), 1e-12);
    }
    close_scene(&scene);
}

static void noise_belongs_to_the_reading_not_to_the_time(void **state)
{
    (void)state;
    struct scene one, two;
    make_scene(&one);
    make_scene(&two);
    two.setup.truth.cell_rate = 10.0;
    one.setup.truth.cell_drift = two.setup.truth.cell_drift = 0.0;
    open_scene(&one);
    open_scene(&two);
    for (int i = 0; i < 100; i++) {
        weigh(&one, 0.05);
        weigh(&two, 0.05);
        assert_close(one.cell.reading, two.cell.reading, 0.0);
    }
    close_scene(&one);
    close_scene(&two);
}

static void overload_is_reported(void **state)
{
    (void)state;
    static const char *const protocols[] = {"generic", "mt-sics"};
    for (int i = 0; i < 2; i++) {
        struct scene scene;
        make_scene(&scene);
        strcpy(scene.setup.rig.load_cell.protocol, protocols[i]);
        open_scene(&scene);
        const double capacity = scene.setup.rig.load_cell.capacity;
        for (int k = 0; k < 100; k++)
            weigh(&scene, 1.45 * capacity);
        assert_int_equal(scene.received.overloads, 0);
        assert_false(scene.cell.over);
        for (int k = 0; k < 100; k++)
            weigh(&scene, 1.6 * capacity);
        assert_true(scene.received.overloads > 90);
        assert_true(scene.cell.over);
        /* Taring a load does not increase the cell's overload limit. */
        for (int k = 0; k < 100; k++)
            weigh(&scene, capacity);
        wb_sim_cell_receive(&scene.cell, "T\r\n", 3);
        for (int k = 0; k < 100; k++)
            weigh(&scene, 1.6 * capacity);
        assert_true(scene.cell.over && !scene.cell.under);
        for (int k = 0; k < 100; k++)
            weigh(&scene, 0.0);
        const int so_far = scene.received.overloads;
        weigh(&scene, 0.0);
        assert_int_equal(scene.received.overloads, so_far);
        close_scene(&scene);
    }
}

static void taring_zeroes_the_reading(void **state)
{
    (void)state;
    static const char *const commands[] = {"T\r\n", "T\r\n"};
    static const char *const protocols[] = {"generic", "mt-sics"};
    for (int i = 0; i < 2; i++) {
        struct scene scene;
        make_scene(&scene);
        scene.setup.truth.cell_drift = 0.0;
        strcpy(scene.setup.rig.load_cell.protocol, protocols[i]);
        open_scene(&scene);
        for (int k = 0; k < 50; k++)
            weigh(&scene, 0.08);
        wb_sim_cell_receive(&scene.cell, commands[i], strlen(commands[i]));
        memset(&scene.received, 0, sizeof scene.received);
        for (int k = 0; k < 400; k++)
            weigh(&scene, 0.08);
        /* The tare has the noise of one reading. */
        assert_close(scene.received.sum / scene.received.n, 0.0,
                     5.0 * scene.setup.truth.cell_noise);
        close_scene(&scene);
    }
}

/* For all line settings in the rig file the driver reads the force correctly. */
static void all_line_settings_read_back(void **state)
{
    (void)state;
    static const struct {
        const char *unit, *terminator;
        char delimiter;
        int column, sign;
        bool comma;
        double scale, offset;
        const char *start, *poll;
    } cases[] = {
        {"g", "crlf", 0, 0, 1, false, 1.0, 0.0, "", ""},
        {"", "crlf", 0, 0, 1, false, 1.0, 0.0, "", ""},
        {"mN", "cr", 0, 0, -1, false, 1.0, 0.0, "", ""},
        {"N", "lf", 0, 0, 1, false, 1.0, 0.0, "", ""},
        {"lb", "any", 0, 0, 1, false, 1e-3, 0.0, "O0W0\r", ""},
        {"g", "crlf", ';', 3, 1, true, 1.0, 0.0, "", ""},
        {"g", "lf", ',', 2, -1, false, 0.02, -7.0, "", ""},
        {"kg", "crlf", 0, 0, 1, false, 1.0, 0.0, "", "W\r"},
        {"g", "idle", 0, 0, 1, false, 1.0, 0.0, "", ""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct scene scene;
        make_scene(&scene);
        struct wb_rig_load_cell *const cell = &scene.setup.rig.load_cell;
        strcpy(cell->unit, cases[i].unit);
        strcpy(cell->terminator, cases[i].terminator);
        cell->delimiter = cases[i].delimiter;
        cell->column = cases[i].column;
        cell->sign = cases[i].sign;
        cell->decimal_comma = cases[i].comma;
        cell->scale = cases[i].scale;
        cell->offset = cases[i].offset;
        strcpy(cell->start_command, cases[i].start);
        strcpy(cell->poll_command, cases[i].poll);
        cell->poll_period_ns = cases[i].poll[0] ? 20 * WB_NS_PER_MS : 0;
        cell->idle_gap_ns = 5 * WB_NS_PER_MS;
        scene.setup.truth.cell_drift = 0.0;
        open_scene(&scene);
        for (int k = 0; k < 200; k++)
            weigh(&scene, 0.06);
        const double mean = scene.received.n > 0 ? scene.received.sum / scene.received.n : 0.0;
        if (scene.received.n < 100 || scene.received.remarks > 0)
            fail_msg("case %zu: %d readings, %d remarks", i, scene.received.n,
                     scene.received.remarks);
        assert_close(mean, 0.06 + scene.setup.truth.cell_offset, scene.setup.truth.cell_noise);
        close_scene(&scene);
    }
}

/* The presets' lines, answers and commands, written from the manuals and read by the driver. */
static void every_preset_reads_back(void **state)
{
    (void)state;
    for (size_t i = 0; wb_loadcell_preset_at(i); i++) {
        const struct wb_loadcell_preset *const preset = wb_loadcell_preset_at(i);
        struct scene scene;
        make_scene(&scene);
        struct wb_rig_load_cell *const cell = &scene.setup.rig.load_cell;
        wb_loadcell_preset_apply(preset, cell);
        if (preset->unit_rule == WB_UNIT_OF_RIG_FILE && !preset->unit)
            strcpy(cell->unit, "g");
        scene.setup.truth.cell_drift = 0.0;
        open_scene(&scene);
        for (int k = 0; k < 600; k++)
            weigh(&scene, 0.06);
        const double mean = scene.received.n > 0 ? scene.received.sum / scene.received.n : 0.0;
        /* Commands must work, and their answers must not cause warnings. Scales that are polled
         * slowly give ten readings. */
        if (scene.received.n < 10 || scene.received.remarks > 0)
            fail_msg("%s: %d readings, %d remarks", preset->name, scene.received.n,
                     scene.received.remarks);
        /* The iLoad prints integer thousandths of a pound. */
        const double step =
            strcmp(preset->name, "loadstar-iload") == 0 ? scene.cell.unit * 1e-3 : 0.0;
        assert_close(mean, 0.06 + scene.setup.truth.cell_offset,
                     scene.setup.truth.cell_noise + 0.5 * step);
        for (int k = 0; k < 200; k++)
            weigh(&scene, 1.6 * cell->capacity);
        if (scene.received.overloads < 3)
            fail_msg("%s: %d overloads", preset->name, scene.received.overloads);
        close_scene(&scene);
    }
}

static void the_end_of_a_session_ends_the_stream(void **state)
{
    (void)state;
    struct scene scene;
    struct wb_outbox outbox = {0};
    make_scene(&scene);
    wb_loadcell_preset_apply(wb_loadcell_preset_find("kern"), &scene.setup.rig.load_cell);
    open_scene(&scene);
    for (int k = 0; k < 50; k++)
        weigh(&scene, 0.06);
    const int so_far = scene.received.n;
    assert_true(so_far > 40);
    scene.driver->stop(scene.state, &outbox);
    wb_sim_cell_receive(&scene.cell, outbox.bytes, outbox.n_bytes);
    for (int k = 0; k < 50; k++)
        weigh(&scene, 0.06);
    assert_int_equal(scene.received.n, so_far);
    close_scene(&scene);
}

static void mtsics_reports_dynamic_while_the_load_changes(void **state)
{
    (void)state;
    struct scene scene;
    make_scene(&scene);
    strcpy(scene.setup.rig.load_cell.protocol, "mt-sics");
    open_scene(&scene);
    for (int k = 0; k < 50; k++)
        weigh(&scene, 0.02);
    assert_true(scene.received.unstable <= 2);
    for (int k = 0; k < 50; k++)
        weigh(&scene, 0.02 + 0.003 * k);
    assert_true(scene.received.unstable > 40);
    close_scene(&scene);
}

static void mtsics_answers_queries(void **state)
{
    (void)state;
    static const struct {
        const char *question, *answer;
    } cases[] = {
        {"I4\r\n", "I4 A \"LC20G-0001\"\r\n"},
        {"I3\r\n", "I3 A \"virtual rig\"\r\n"},
        {"XYZ\r\n", "ES\r\n"},
        {"Z\r\n", "Z A\r\n"},
        {"I2\r\n", "I2 A \"virtual rig load cell 20.0000 g\"\r\n"},
    };
    struct scene scene;
    make_scene(&scene);
    strcpy(scene.setup.rig.load_cell.protocol, "mt-sics");
    assert_int_equal(wb_sim_cell_init(&scene.cell, &scene.setup.truth, &scene.setup.rig), WB_OK);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[256];
        wb_sim_cell_receive(&scene.cell, cases[i].question, strlen(cases[i].question));
        text[wb_reply_take(&scene.cell.out, text, sizeof text - 1)] = '\0';
        assert_string_equal(text, cases[i].answer);
    }
    /* Without a stream request it sends nothing; one query gives one line. */
    char text[256];
    wb_sim_cell_read(&scene.cell, 0, 0.1, 0.05);
    assert_int_equal(wb_reply_take(&scene.cell.out, text, sizeof text), 0);
    wb_sim_cell_receive(&scene.cell, "SI\r\n", 4);
    assert_true(wb_reply_take(&scene.cell.out, text, sizeof text) > 0);
    wb_sim_cell_read(&scene.cell, 1, 0.2, 0.05);
    assert_int_equal(wb_reply_take(&scene.cell.out, text, sizeof text), 0);
}

static void unread_lines_are_lost_without_growing_memory(void **state)
{
    (void)state;
    struct scene scene;
    char text[WB_REPLY_BYTES + 1];
    make_scene(&scene);
    assert_int_equal(wb_sim_cell_init(&scene.cell, &scene.setup.truth, &scene.setup.rig), WB_OK);
    for (uint64_t k = 0; k < 5000; k++)
        wb_sim_cell_read(&scene.cell, k, wb_sim_cell_time(&scene.cell, k), 0.0);
    const size_t n = wb_reply_take(&scene.cell.out, text, sizeof text);
    assert_true(n > WB_REPLY_BYTES - 64 && n <= WB_REPLY_BYTES);
    char flood[1000];
    memset(flood, 'x', sizeof flood);
    wb_sim_cell_receive(&scene.cell, flood, sizeof flood);
    wb_sim_cell_receive(&scene.cell, "T\r\n", 3);
    assert_close(scene.cell.reading, 0.0, 0.0);
}

static void the_unit_key_changes_the_number_and_the_unit(void **state)
{
    (void)state;
    struct scene scene;
    char line[64], unit[8];
    double value;
    make_scene(&scene);
    open_scene(&scene);
    const double tension = 100.0 * WB_MN;
    for (int i = 0; i < 3; i++) {
        /* Long enough for the filter; the last line is at the end. */
        for (int k = 0; k < 200; k++, scene.k++) {
            wb_reply_take(&scene.cell.out, line, sizeof line);
            wb_sim_cell_read(&scene.cell, scene.k, wb_sim_cell_time(&scene.cell, scene.k), tension);
        }
        line[wb_reply_take(&scene.cell.out, line, sizeof line - 1)] = '\0';
        assert_int_equal(sscanf(line, "%lf %7s", &value, unit), 2);
        assert_string_equal(unit, i == 1 ? "oz" : "g");
        const double ounce = 28.349523125 * WB_G * WB_STANDARD_GRAVITY;
        const double force = value * (i == 1 ? ounce : WB_G * WB_STANDARD_GRAVITY);
        assert_close(force, tension, 0.05 * tension);
        wb_sim_cell_change_unit(&scene.cell);
    }
    close_scene(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(constant_load_reads_offset_noise_and_drift),
        cmocka_unit_test(zero_drifts_by_two_milligrams_a_minute),
        cmocka_unit_test(the_filter_lags_fifty_milliseconds_behind_a_ramp),
        cmocka_unit_test(the_filter_answers_a_step_exponentially),
        cmocka_unit_test(noise_belongs_to_the_reading_not_to_the_time),
        cmocka_unit_test(overload_is_reported),
        cmocka_unit_test(taring_zeroes_the_reading),
        cmocka_unit_test(all_line_settings_read_back),
        cmocka_unit_test(every_preset_reads_back),
        cmocka_unit_test(the_end_of_a_session_ends_the_stream),
        cmocka_unit_test(mtsics_reports_dynamic_while_the_load_changes),
        cmocka_unit_test(mtsics_answers_queries),
        cmocka_unit_test(unread_lines_are_lost_without_growing_memory),
        cmocka_unit_test(the_unit_key_changes_the_number_and_the_unit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
