/* Datasets: written and read back bit for bit, and refused with file, line and column. */
#include "analysis/dataset/dataset.h"

#include <stdlib.h>
#include <unistd.h>

#include "analysis/dataset/csv_table_private.h"
#include "analysis/dataset/dataset_private.h"
#include "base/file.h"
#include "base/log.h"
#include "tests/messages.h"
#include "tests/own_folder.h"

static int start(void **state)
{
    keep_messages();
    return make_folder(state);
}

static uint64_t random_bits(uint64_t *seed)
{
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    return *seed;
}

static double random_double(uint64_t *seed)
{
    for (;;) {
        const uint64_t bits = random_bits(seed);
        double value;
        memcpy(&value, &bits, sizeof value);
        /* Millimetres of what is near the largest or smallest double do not exist. */
        if (isfinite(value) && fabs(value) < 1e300 && fabs(value) > 1e-290)
            return value;
    }
}

static void numbers_come_back_bit_for_bit(void **state)
{
    (void)state;
    static const double special[] = {0.0,   -0.0,  1.0,         -1.0,       0.085,   1e-9, 0.1,
                                     1e21,  1e-30, 123456789.0, 2.5e-8,     0.00001, 1e15, 1e16,
                                     99e14, 1e-3,  5e-324,      0x1.8p-400, 3e-310};
    char text[WB_CSV_TABLE_NUMBER];
    uint64_t seed = 1;
    for (int i = 0; i < 20000; i++) {
        const int n = (int)(sizeof special / sizeof special[0]);
        const double value = i < n ? special[i] : random_double(&seed);
        for (int shift = 0; shift <= 3; shift += 3) {
            double back;
            wb_csv_table_format_number(value, shift, text);
            assert_true(strlen(text) < WB_CSV_TABLE_NUMBER);
            if (!wb_csv_table_parse_number(text, shift, &back) || back != value)
                fail_msg("%a became '%s'", value, text);
        }
    }
}

static void numbers_are_short_and_in_their_unit(void **state)
{
    (void)state;
    static const struct {
        double value;
        int shift;
        const char *text;
    } cases[] = {
        {0.085, 3, "85"},     {0.0142, 3, "14.2"},   {-0.0005, 3, "-0.5"},
        {0.1, 0, "0.1"},      {1e-6, 3, "0.001"},    {0.0, 3, "0"},
        {12.0, 0, "12"},      {1e-9, 3, "0.000001"}, {1234.5, 3, "1234500"},
        {1.0 / 3.0, 0, NULL}, {1e-30, 0, "1e-30"},   {2.5e20, 0, "2.5e20"},
        {-1e-12, 3, "-1e-9"}, {0.05, 3, "50"},       {1e12, 3, "1000000000000000"},
    };
    char text[WB_CSV_TABLE_NUMBER];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        wb_csv_table_format_number(cases[i].value, cases[i].shift, text);
        if (cases[i].text)
            assert_string_equal(text, cases[i].text);
    }
}

/* --- folders --- */

static void fill(struct wb_dataset *dataset)
{
    uint64_t seed = 5;
    wb_dataset_init(dataset);
    wb_json_set_text(dataset->document, "name", "made \"up\"");
    struct wb_test_info *const info = &dataset->info;
    strcpy(info->wire, "type1");
    info->sample = 3;
    info->length = 0.085;
    info->outer_diameter = 1.1e-3;
    info->mass_per_length = 3.86e-3;
    info->poissons_ratio = 0.39;
    info->strand_length = 0.76;
    info->counterweight = 2.7e-3;
    info->gravity = 9.80665;
    info->rest_level = -0.5e-3;
    info->n_natural_shape = 2;
    info->natural_shape[0] = 0.07;
    info->natural_shape[1] = -0.011;
    info->uncertainty = (struct wb_test_uncertainty){
        .gain = 3e-3, .length = 2e-4, .counterweight = 1e-5, .diameter = 1e-5, .density = 0.02};
    info->is_virtual = true;
    for (int i = 0; i < 1000; i++) {
        struct wb_row row = {
            .t = 0.05 * i,
            .cycle = 1 + i / 400,
            .phase = (enum wb_phase)(i % 3),
            .deflection = 1e-3 * (double)(random_bits(&seed) % 99999) / 977.0,
            .tension = i % 7 ? 1e-3 * (double)(random_bits(&seed) % 99999) / 91.0 : (double)NAN,
            .force = -1e-4 * i / 3.0,
            .stage = i % 2 ? i * 1e-5 / 7.0 : (double)NAN,
            .tip_x = (double)NAN,
            .tip_angle = i / 1234.5,
        };
        wb_dataset_add_row(dataset, &row);
        struct wb_shape_row shape = {
            .t = row.t, .deflection = row.deflection, .marker = i % 7, .s = 0.0142, .x = i / 3e4};
        wb_dataset_add_shape_row(dataset, &shape);
    }
}

static void assert_same(double a, double b)
{
    assert_true(a == b || (isnan(a) && isnan(b)));
}

static void a_dataset_comes_back_as_it_was(void **state)
{
    (void)state;
    struct wb_dataset written, read;
    char path[WB_PATH];
    const char *name;
    snprintf(path, sizeof path, "%s/whole", folder);
    fill(&written);
    assert_int_equal(wb_dataset_write(&written, path, false), WB_OK);
    assert_int_equal(wb_dataset_read(&read, path, NULL), WB_OK);
    assert_true(wb_json_get_text(read.document, "name", &name));
    assert_string_equal(name, "made \"up\"");
    assert_string_equal(read.info.wire, "type1");
    assert_int_equal(read.info.sample, 3);
    assert_same(read.info.length, 0.085);
    assert_same(read.info.outer_diameter, 1.1e-3);
    assert_same(read.info.mass_per_length, written.info.mass_per_length);
    assert_same(read.info.poissons_ratio, 0.39);
    assert_same(read.info.strand_length, 0.76);
    assert_same(read.info.counterweight, 2.7e-3);
    assert_same(read.info.gravity, 9.80665);
    assert_same(read.info.rest_level, -0.5e-3);
    assert_int_equal(read.info.n_natural_shape, 2);
    assert_same(read.info.natural_shape[1], -0.011);
    assert_memory_equal(&read.info.uncertainty, &written.info.uncertainty,
                        sizeof read.info.uncertainty);
    assert_null(wb_json_get(wb_json_get(read.document, "test"), "u_marker_offset_mm"));
    assert_true(read.info.is_virtual && !read.info.is_simulation);
    assert_int_equal(read.n_rows, written.n_rows);
    assert_int_equal(read.n_shape_rows, written.n_shape_rows);
    for (size_t i = 0; i < read.n_rows; i++) {
        const struct wb_row *const a = &read.rows[i], *const b = &written.rows[i];
        assert_true(a->cycle == b->cycle && a->phase == b->phase);
        assert_same(a->t, b->t);
        assert_same(a->deflection, b->deflection);
        assert_same(a->tension, b->tension);
        assert_same(a->force, b->force);
        assert_same(a->stage, b->stage);
        assert_same(a->tip_x, b->tip_x);
        assert_same(a->tip_angle, b->tip_angle);
        assert_int_equal(read.shape_rows[i].marker, written.shape_rows[i].marker);
        assert_same(read.shape_rows[i].x, written.shape_rows[i].x);
        assert_same(read.shape_rows[i].s, 0.0142);
    }
    /* Overwritten only with `force`. */
    assert_int_equal(wb_dataset_write(&read, path, false), WB_ERR_EXISTS);
    assert_int_equal(wb_dataset_write(&read, path, true), WB_OK);
    wb_dataset_release(&written);
    wb_dataset_release(&read);
}

static void no_rest_and_a_straight_wire_are_kept(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    char path[WB_PATH];
    snprintf(path, sizeof path, "%s/straight", folder);
    fill(&dataset);
    dataset.info.rest_level = (double)NAN;
    dataset.info.n_natural_shape = 0;
    assert_int_equal(wb_dataset_write(&dataset, path, false), WB_OK);
    wb_dataset_release(&dataset);
    assert_int_equal(wb_dataset_read(&dataset, path, NULL), WB_OK);
    assert_true(isnan(dataset.info.rest_level));
    assert_int_equal(dataset.info.n_natural_shape, 0);
    assert_close(wb_dataset_bow(&dataset.info), 0.0, 0.0);
    wb_dataset_release(&dataset);
}

static void first_line_of_shapes(const char *dataset, char line[256])
{
    char path[WB_PATH];
    snprintf(path, sizeof path, "%s/shape.csv", dataset);
    FILE *const file = fopen(path, "r");
    assert_non_null(file);
    assert_non_null(fgets(line, 256, file)); /* "# virtual rig" */
    assert_non_null(fgets(line, 256, file));
    fclose(file);
}

static void z_is_kept_where_a_test_leaves_the_plane(void **state)
{
    (void)state;
    struct wb_dataset written, read;
    char path[WB_PATH], line[256];
    snprintf(path, sizeof path, "%s/space", folder);
    fill(&written);
    assert_int_equal(wb_dataset_write(&written, path, false), WB_OK);
    first_line_of_shapes(path, line);
    assert_string_equal(line, "t_s,deflection_mm,marker,s_mm,x_mm,y_mm\n");
    assert_int_equal(wb_dataset_read(&read, path, NULL), WB_OK);
    assert_true(isnan(read.shape_rows[17].z));
    wb_dataset_release(&read);

    written.shape_rows[17].z = -0.00123456789;
    written.shape_rows[18].z = (double)NAN;
    assert_int_equal(wb_dataset_write(&written, path, true), WB_OK);
    first_line_of_shapes(path, line);
    assert_string_equal(line, "t_s,deflection_mm,marker,s_mm,x_mm,y_mm,z_mm\n");
    assert_int_equal(wb_dataset_read(&read, path, NULL), WB_OK);
    assert_same(read.shape_rows[17].z, -0.00123456789);
    assert_true(isnan(read.shape_rows[18].z));
    assert_same(read.shape_rows[19].z, 0.0);
    assert_same(read.shape_rows[19].x, written.shape_rows[19].x);
    wb_dataset_release(&written);
    wb_dataset_release(&read);
}

static void overwriting_leaves_no_fields_of_another(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    char path[WB_PATH], fields[WB_PATH];
    snprintf(path, sizeof path, "%s/overwritten", folder);
    assert_int_equal(wb_file_join(fields, path, "fields.csv"), WB_OK);
    fill(&dataset);
    assert_int_equal(wb_dataset_write(&dataset, path, false), WB_OK);
    assert_int_equal(wb_file_write(fields, "old\n", 4), WB_OK);
    assert_int_equal(wb_dataset_write(&dataset, path, true), WB_OK);
    assert_false(wb_file_exists(fields));
    wb_dataset_release(&dataset);
}

/* dataset.json with one text exchanged, read again. */
static enum wb_status read_altered(const char *path, const char *old, const char *new,
                                   struct wb_dataset *dataset)
{
    char file[WB_PATH], *text, altered[8192];
    assert_int_equal(wb_file_join(file, path, "dataset.json"), WB_OK);
    assert_int_equal(wb_file_read(file, &text, NULL), WB_OK);
    const char *const at = strstr(text, old);
    assert_non_null(at);
    snprintf(altered, sizeof altered, "%.*s%s%s", (int)(at - text), text, new, at + strlen(old));
    assert_int_equal(wb_file_write(file, altered, strlen(altered)), WB_OK);
    const enum wb_status status = wb_dataset_read(dataset, path, NULL);
    assert_int_equal(wb_file_write(file, text, strlen(text)), WB_OK);
    free(text);
    return status;
}

static void a_follower_force_is_said(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    char path[WB_PATH];
    snprintf(path, sizeof path, "%s/follower", folder);
    fill(&dataset);
    dataset.info.is_follower = true;
    assert_int_equal(wb_dataset_write(&dataset, path, false), WB_ERR_ARGUMENT);
    dataset.info.strand_length = 0.0;
    assert_int_equal(wb_dataset_write(&dataset, path, false), WB_OK);
    wb_dataset_release(&dataset);
    assert_int_equal(wb_dataset_read(&dataset, path, NULL), WB_OK);
    assert_true(dataset.info.is_follower);
    wb_dataset_release(&dataset);

    /* Other words, other kinds, and what contradicts it. */
    static const struct {
        const char *old, *new, *message;
    } cases[] = {
        {"\"follower\"", "\"sideways\"", "test.loading: expected tip, follower or general"},
        {"\"follower\"", "true", "test.loading: expected a text"},
        {"\"strand_length_mm\": 0", "\"strand_length_mm\": 760", "not a strand's"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_int_equal(read_altered(path, cases[i].old, cases[i].new, &dataset), WB_ERR_FORMAT);
        assert_message(cases[i].message);
    }
    /* The other words, and files from before there was one. */
    assert_int_equal(read_altered(path, "\"follower\"", "\"general\"", &dataset), WB_OK);
    assert_true(dataset.info.is_general && !dataset.info.is_follower);
    assert_int_equal(wb_dataset_write(&dataset, path, true), WB_OK);
    wb_dataset_release(&dataset);
    assert_int_equal(read_altered(path, "\"general\"", "\"follower\"", &dataset), WB_OK);
    assert_true(dataset.info.is_follower && !dataset.info.is_general);
    assert_int_equal(wb_dataset_write(&dataset, path, true), WB_OK);
    wb_dataset_release(&dataset);
    assert_int_equal(read_altered(path, "\"follower\"", "\"tip\"", &dataset), WB_OK);
    assert_false(dataset.info.is_follower);
    wb_dataset_release(&dataset);
    assert_int_equal(read_altered(path, "\"loading\": \"follower\",", "", &dataset), WB_OK);
    assert_false(dataset.info.is_follower);
    wb_dataset_release(&dataset);
}

static void a_row_without_force_is_not_written(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    char path[WB_PATH];
    snprintf(path, sizeof path, "%s/no-force", folder);
    fill(&dataset);
    dataset.rows[17].force = (double)NAN;
    assert_int_equal(wb_dataset_write(&dataset, path, false), WB_ERR_ARGUMENT);
    assert_message("row 18");
    assert_message("force_N");
    assert_false(wb_file_exists(path));
    wb_dataset_release(&dataset);
}

/* --- refusals --- */

static enum wb_status parse_rows(const char *text, struct wb_dataset *dataset)
{
    char buffer[1024];
    const size_t n = strlen(text);
    assert_true(n < sizeof buffer);
    memcpy(buffer, text, n + 1);
    memset(dataset, 0, sizeof *dataset);
    return wb_dataset_parse_rows(dataset, "f.csv", buffer, n, NULL);
}

#define HEADER "t_s,cycle,phase,deflection_mm,tension_N,force_N\n"

static void bad_tables_are_refused_with_line_and_column(void **state)
{
    (void)state;
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"", "f.csv:1: empty file"},
        {"t_s,cycle,phase,deflection_mm\n", "f.csv:1: no column 'force_N'"},
        {"t_s,t_s,cycle,phase,deflection_mm,force_N\n", "f.csv:1: column 't_s' appears twice"},
        {HEADER "0,1,load,0,0\n", "f.csv:2: 5 fields, expected 6"},
        {HEADER "0,1,load,0,0,0,\n", "f.csv:2: more than 6 fields"},
        {HEADER "0,1,load,0,0,0\n0,1,load,1 mm,0,0\n", "f.csv:3: deflection_mm: expected a number"},
        {HEADER "0,1,load,nan,0,0\n", "f.csv:2: deflection_mm: expected a number, not 'nan'"},
        {HEADER "0,1,load,0x10,0,0\n", "f.csv:2: deflection_mm: expected a number"},
        {HEADER "0,1,load,1e999,0,0\n", "f.csv:2: deflection_mm: expected a number"},
        {HEADER "0,1,load,,0,0\n", "f.csv:2: deflection_mm: expected a number, not ''"},
        {HEADER "0,1.5,load,0,0,0\n", "f.csv:2: cycle: expected a whole number"},
        {HEADER "0,-1,load,0,0,0\n", "f.csv:2: cycle: expected a whole number"},
        {HEADER "0,1,down,0,0,0\n", "f.csv:2: phase: expected load, unload or slack, not 'down'"},
        {HEADER "0;1;load;0;0;0\n", "f.csv:2: t_s: expected a number"},
        {HEADER "\n", "f.csv:2: t_s: expected a number"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct wb_dataset dataset;
        assert_int_equal(parse_rows(cases[i].text, &dataset), WB_ERR_FORMAT);
        assert_message(cases[i].message);
        wb_dataset_release(&dataset);
    }
}

static void other_tables_are_read(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    /* Columns by name, unknown ones skipped, absent ones unknown, lines of other systems. */
    assert_int_equal(parse_rows("note,force_N,phase,deflection_mm,cycle,t_s\r\n"
                                "x y,0.5,unload,-2.5e1,4,1\r\n"
                                ",1,slack,0.1,4,2",
                                &dataset),
                     WB_OK);
    assert_int_equal(dataset.n_rows, 2);
    assert_close(dataset.rows[0].deflection, -0.025, 0.0);
    assert_int_equal(dataset.rows[0].phase, WB_PHASE_UNLOAD);
    assert_int_equal(dataset.rows[0].cycle, 4);
    assert_true(isnan(dataset.rows[0].tension) && isnan(dataset.rows[0].tip_angle));
    assert_close(dataset.rows[1].force, 1.0, 0.0);
    wb_dataset_release(&dataset);
}

static void garbage_never_crashes_the_reader(void **state)
{
    (void)state;
    static const char alphabet[] = "0123456789.,-+eE\n\r \"'loadunslck\0\xff\x80;_mNt";
    static const char seed_text[] =
        HEADER "0,1,load,0,0,0\n0.05,1,load,1.5,0.02,0.001\n0.1,1,slack,-0.5,,-0.03\n";
    uint64_t seed = 99;
    int accepted = 0;
    for (int i = 0; i < 20000; i++) {
        char text[512];
        size_t n = sizeof seed_text - 1;
        memcpy(text, seed_text, n + 1);
        if (i % 3 == 0) {
            n = random_bits(&seed) % (sizeof text - 1);
            for (size_t k = 0; k < n; k++)
                text[k] = alphabet[random_bits(&seed) % (sizeof alphabet - 1)];
        } else {
            const int changes = 1 + (int)(random_bits(&seed) % 4);
            for (int k = 0; k < changes; k++)
                text[random_bits(&seed) % n] = alphabet[random_bits(&seed) % (sizeof alphabet - 1)];
            if (i % 3 == 1)
                n = random_bits(&seed) % n;
        }
        text[n] = '\0';
        struct wb_dataset dataset = {0};
        char copy[512];
        memcpy(copy, text, sizeof copy);
        const enum wb_status status = wb_dataset_parse_rows(&dataset, "fuzz.csv", text, n, NULL);
        assert_true(status == WB_OK || status == WB_ERR_FORMAT);
        accepted += status == WB_OK;
        for (size_t k = 0; k < dataset.n_rows && status == WB_OK; k++)
            assert_true(isfinite(dataset.rows[k].deflection) && isfinite(dataset.rows[k].force));
        wb_dataset_release(&dataset);
        memset(&dataset, 0, sizeof dataset);
        if (wb_dataset_parse_shapes(&dataset, "fuzz.csv", copy, n, NULL) == WB_OK)
            accepted++;
        wb_dataset_release(&dataset);
    }
    /* Else the mutations reach nothing beyond the first check. */
    assert_true(accepted > 200);
}

static void write_text(const char *path, const char *name, const char *text)
{
    char file[WB_PATH];
    assert_int_equal(wb_file_join(file, path, name), WB_OK);
    assert_int_equal(wb_file_write(file, text, strlen(text)), WB_OK);
}

static void damaged_folders_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *json, *message;
    } cases[] = {
        {"{", "dataset.json:1"},
        {"{}\n", "schema"},
        {"{\"schema\": 1}\n", "'test'"},
        {"{\"schema\": 2}\n", "newer wirebench"},
        {"{\"schema\": 1, \"test\": {\"wire\": 7}}\n", "test.wire"},
        {"{\"schema\": 1, \"test\": {\"wire\": \"a\", \"sample\": -1}}\n", "test.sample"},
        {"{\"schema\": 1, \"test\": {\"wire\": \"a\", \"sample\": 1}}\n", "test.length_mm"},
    };
    struct wb_dataset dataset;
    char path[WB_PATH];
    snprintf(path, sizeof path, "%s/damaged", folder);
    assert_int_equal(wb_dataset_read(&dataset, path, NULL), WB_ERR_NOT_FOUND);
    fill(&dataset);
    assert_int_equal(wb_dataset_write(&dataset, path, false), WB_OK);
    wb_dataset_release(&dataset);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_text(path, "dataset.json", cases[i].json);
        assert_int_not_equal(wb_dataset_read(&dataset, path, NULL), WB_OK);
        assert_message(cases[i].message);
        assert_null(dataset.document);
    }
}

/* What is wrong, as the caller that gave a reason gets it; nothing may be logged. */
static void assert_reason(const char *path, const char *file, const char *text, const char *said)
{
    struct wb_dataset dataset;
    struct wb_reason why = {.text = ""};
    char whole[WB_PATH], *original;
    snprintf(whole, sizeof whole, "%s/%s", path, file);
    assert_int_equal(wb_file_read(whole, &original, NULL), WB_OK);
    if (text)
        write_text(path, file, text);
    else
        assert_int_equal(unlink(whole), 0);
    kept.last[0] = '\0';
    assert_int_not_equal(wb_dataset_read(&dataset, path, &why), WB_OK);
    assert_string_equal(kept.last, "");
    if (!strstr(why.text, said))
        fail_msg("'%s' does not say '%s'", why.text, said);
    write_text(path, file, original);
    free(original);
}

static void a_reason_travels_to_who_asked_for_it(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    char path[WB_PATH];
    snprintf(path, sizeof path, "%s/reason", folder);
    fill(&dataset);
    assert_int_equal(wb_dataset_write(&dataset, path, false), WB_OK);
    wb_dataset_release(&dataset);
    assert_reason(path, "dataset.json", "{\"schema\": 2}\n", "newer wirebench");
    assert_reason(path, "dataset.json", "{", "dataset.json:1: ");
    assert_reason(path, "dataset.json", NULL, "cannot open");
    assert_reason(path, "force_deflection.csv", "t_s\n", "no column 'cycle'");
    assert_reason(path, "shape.csv", "", "empty file");
    assert_reason(path, "shape.csv", NULL, "cannot open");
}

/* --- the natural shape --- */

static void bow_and_curvature_match_closed_forms(void **state)
{
    (void)state;
    struct wb_test_info info = {.length = 0.1, .n_natural_shape = 1, .natural_shape = {0.6}};
    /* A circular arc of 0.6 rad: its tip stands (1 - cos 0.6) radii high. */
    assert_close(wb_dataset_bow(&info), 0.1 / 0.6 * (1.0 - cos(0.6)), 1e-11);
    assert_close(wb_dataset_natural_curvature(&info, 0.03), 6.0, 1e-12);
    info.n_natural_shape = 3;
    info.natural_shape[1] = -0.2;
    info.natural_shape[2] = 0.05;
    for (double s = 0.0; s <= 0.1; s += 0.02) {
        const double u = s / 0.1;
        const double curvature = (0.6 - 0.4 * u + 0.15 * u * u) / 0.1;
        assert_close(wb_dataset_natural_curvature(&info, s), curvature, 1e-12);
    }
    info.n_natural_shape = 0;
    assert_close(wb_dataset_bow(&info), 0.0, 0.0);
    assert_close(wb_dataset_natural_curvature(&info, 0.05), 0.0, 0.0);
}

static void phases_have_their_names(void **state)
{
    (void)state;
    assert_string_equal(wb_trial_phase_name(WB_PHASE_LOAD), "load");
    assert_string_equal(wb_trial_phase_name(WB_PHASE_UNLOAD), "unload");
    assert_string_equal(wb_trial_phase_name(WB_PHASE_SLACK), "slack");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_come_back_bit_for_bit),
        cmocka_unit_test(numbers_are_short_and_in_their_unit),
        cmocka_unit_test(a_dataset_comes_back_as_it_was),
        cmocka_unit_test(no_rest_and_a_straight_wire_are_kept),
        cmocka_unit_test(z_is_kept_where_a_test_leaves_the_plane),
        cmocka_unit_test(overwriting_leaves_no_fields_of_another),
        cmocka_unit_test(a_follower_force_is_said),
        cmocka_unit_test(a_row_without_force_is_not_written),
        cmocka_unit_test(bad_tables_are_refused_with_line_and_column),
        cmocka_unit_test(other_tables_are_read),
        cmocka_unit_test(garbage_never_crashes_the_reader),
        cmocka_unit_test(damaged_folders_are_refused),
        cmocka_unit_test(a_reason_travels_to_who_asked_for_it),
        cmocka_unit_test(bow_and_curvature_match_closed_forms),
        cmocka_unit_test(phases_have_their_names),
    };
    return cmocka_run_group_tests(tests, start, remove_folder);
}
