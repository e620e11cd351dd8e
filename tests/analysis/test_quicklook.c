/* One dataset at a glance: figures and summary are there, say where they come from, and are the
 * same every time. */
#include "analysis/plot/figure.h"
#include "analysis/quicklook.h"

#include <stdlib.h>
#include <unistd.h>

#include "base/file.h"
#include "base/log.h"
#include "tests/own_folder.h"

static void quiet(void *context, enum wb_log_level level, const char *domain, const char *message)
{
    (void)context;
    (void)level;
    (void)domain;
    (void)message;
}

static int start(void **state)
{
    wb_log_set_sink(quiet, NULL);
    return make_folder(state);
}

/* Two cycles up and down, with a slack end. */
static void fill(struct wb_dataset *dataset)
{
    wb_dataset_init(dataset);
    strcpy(dataset->info.wire, "type <2>");
    dataset->info.sample = 2;
    dataset->info.length = 0.085;
    dataset->info.strand_length = 0.76;
    dataset->info.outer_diameter = 1.25e-3;
    dataset->info.is_virtual = true;
    wb_json_set_text(dataset->document, "name", "a&b.wbr");
    struct wb_json *const list = wb_json_set_array(dataset->document, "corrections");
    struct wb_json *const entry = wb_json_append_object(list);
    wb_json_set_text(entry, "name", "tare");
    wb_json_set_number(entry, "value_mN", -1.25);
    wb_json_set_number(entry, "uncertainty_mN", 0.007);
    wb_json_append_text(wb_json_set_array(dataset->document, "warnings"), "the cat walked by");
    for (int i = 0; i < 400; i++) {
        const int in = i % 200;
        const double y = 1e-3 * (in < 100 ? 0.4 * in : fmax(80.0 - 0.4 * in, 10.0));
        const struct wb_row row = {
            .t = 0.05 * i,
            .cycle = 1 + i / 200,
            .phase = in < 100   ? WB_PHASE_LOAD
                     : in < 175 ? WB_PHASE_UNLOAD
                                : WB_PHASE_SLACK,
            .deflection = y,
            .tension = 0.03 + y,
            .force = 1.5 * y,
            .stage = y,
            .tip_x = 0.08,
            .tip_angle = 0.1,
        };
        wb_dataset_add_row(dataset, &row);
        for (int marker = 0; marker < 3 && i % 4 == 0; marker++) {
            const struct wb_shape_row shape = {.t = row.t,
                                               .deflection = y,
                                               .marker = marker,
                                               .s = 0.04 * marker,
                                               .x = 0.04 * marker,
                                               .y = 0.25 * y * marker * marker};
            wb_dataset_add_shape_row(dataset, &shape);
        }
    }
}

static char *read_whole(const char *path, const char *name, size_t *size)
{
    char file[WB_PATH], *bytes;
    assert_int_equal(wb_file_join(file, path, name), WB_OK);
    assert_int_equal(wb_file_read(file, &bytes, size), WB_OK);
    return bytes;
}

static void assert_says(const char *path, const char *name, const char *text)
{
    size_t size;
    char *const bytes = read_whole(path, name, &size);
    if (!strstr(bytes, text))
        fail_msg("%s does not say '%s'", name, text);
    free(bytes);
}

static void all_files_are_written_and_say_virtual_rig(void **state)
{
    (void)state;
    struct wb_dataset dataset, back;
    char path[WB_PATH];
    size_t size;
    snprintf(path, sizeof path, "%s/look", folder);
    fill(&dataset);
    assert_int_equal(wb_quicklook_write(&dataset, path, false), WB_OK);
    assert_int_equal(wb_quicklook_write(&dataset, path, false), WB_ERR_EXISTS);
    assert_int_equal(wb_quicklook_write(&dataset, path, true), WB_OK);
    assert_says(path, "summary.txt", "measured on a virtual rig");
    assert_says(path, "summary.txt", "type <2>, sample 2, 85 mm");
    assert_says(path, "summary.txt", "cycles              2");
    assert_says(path, "summary.txt", "largest deflection  40.00 mm");
    assert_says(
        path, "summary.txt",
        "largest force       60.00 mN above its value at zero deflection (tension 70.00 mN)");
    assert_says(path, "summary.txt", "-1.25 +- 0.007 mN");
    assert_says(path, "summary.txt", "- the cat walked by");
    static const char *const figures[] = {"force_deflection.png", "shapes.png"};
    for (int i = 0; i < 2; i++) {
        char *const bytes = read_whole(path, figures[i], &size);
        assert_true(size > 2000 && memcmp(bytes, "\x89PNG", 4) == 0);
        free(bytes);
    }
    char *const pdf = read_whole(path, "force_deflection.pdf", &size);
    assert_memory_equal(pdf, "%PDF", 4);
    free(pdf);
    assert_says(path, "force_deflection.csv", "# virtual rig\n");
    assert_says(path, "shape.csv", "# virtual rig\n");
    assert_says(path, "force_deflection.svg", "<svg");
    assert_says(path, "force_deflection.svg", "a&amp;b.wbr, measured on a virtual rig");
    assert_says(path, "shapes.svg", "measured on a virtual rig");
    /* It is a dataset as well. */
    assert_int_equal(wb_dataset_read(&back, path, NULL), WB_OK);
    assert_int_equal(back.n_rows, 400);
    wb_dataset_release(&back);
    wb_dataset_release(&dataset);
}

static void the_curve_alone_is_written_as_its_name_ends(void **state)
{
    (void)state;
    static const struct {
        const char *name, *begins;
    } files[] = {{"curve.svg", "<?xml"}, {"curve.png", "\x89PNG"}, {"curve.pdf", "%PDF"}};
    struct wb_dataset dataset;
    char path[WB_PATH];
    size_t size;
    fill(&dataset);
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        assert_true(wb_figure_is_file(files[i].name));
        assert_int_equal(wb_file_join(path, folder, files[i].name), WB_OK);
        assert_int_equal(wb_quicklook_draw(&dataset, path), WB_OK);
        char *const bytes = read_whole(folder, files[i].name, &size);
        assert_memory_equal(bytes, files[i].begins, strlen(files[i].begins));
        free(bytes);
    }
    assert_says(folder, "curve.svg", "measured on a virtual rig");
    assert_false(wb_figure_is_file("curve.jpg") || wb_figure_is_file(".png"));
    wb_dataset_release(&dataset);
}

static void the_same_dataset_gives_the_same_bytes(void **state)
{
    (void)state;
    static const char *const files[] = {"force_deflection.svg", "force_deflection.png",
                                        "force_deflection.pdf", "shapes.svg", "summary.txt"};
    struct wb_dataset dataset;
    char paths[2][WB_PATH];
    fill(&dataset);
    for (int i = 0; i < 2; i++) {
        snprintf(paths[i], WB_PATH, "%s/same-%d", folder, i);
        assert_int_equal(wb_quicklook_write(&dataset, paths[i], false), WB_OK);
    }
    for (size_t k = 0; k < sizeof files / sizeof files[0]; k++) {
        size_t size[2];
        char *const a = read_whole(paths[0], files[k], &size[0]);
        char *const b = read_whole(paths[1], files[k], &size[1]);
        assert_int_equal(size[0], size[1]);
        assert_memory_equal(a, b, size[0]);
        free(a);
        free(b);
    }
    wb_dataset_release(&dataset);
}

static void a_dataset_without_shapes_or_rows_has_a_summary(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    struct wb_text text = {0};
    wb_dataset_init(&dataset);
    wb_quicklook_summary(&dataset, &text);
    assert_non_null(strstr(wb_text_string(&text), "no warnings"));
    wb_text_release(&text);
    wb_dataset_release(&dataset);
}

/* The force of the unloading falls faster than that of the way up has grown: it is gone at 13.07
 * mm, where the tension is that of zero deflection. */
static void the_summary_has_the_residual_deflection(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    struct wb_text text = {0};
    struct wb_json *const object = wb_json_create();
    double left = (double)NAN;
    fill(&dataset);
    dataset.info.is_simulation = true; /* every row counts as a point */
    for (size_t i = 0; i < dataset.n_rows; i++) {
        struct wb_row *const row = &dataset.rows[i];
        if (row->phase == WB_PHASE_UNLOAD)
            row->tension -= 0.5 * (0.04 - row->deflection);
    }
    wb_quicklook_summary(&dataset, &text);
    assert_non_null(strstr(wb_text_string(&text),
                           "residual deflection 13.07 mm at zero force of the unloading (33 %)"));
    wb_quicklook_describe(&dataset, object);
    assert_true(wb_json_get_number(object, "residual_deflection_mm", &left));
    assert_true(fabs(left - 13.07) < 0.02);
    wb_json_destroy(object);
    wb_text_release(&text);
    wb_dataset_release(&dataset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_files_are_written_and_say_virtual_rig),
        cmocka_unit_test(the_curve_alone_is_written_as_its_name_ends),
        cmocka_unit_test(the_same_dataset_gives_the_same_bytes),
        cmocka_unit_test(a_dataset_without_shapes_or_rows_has_a_summary),
        cmocka_unit_test(the_summary_has_the_residual_deflection),
    };
    return cmocka_run_group_tests(tests, start, remove_folder);
}
