/* States of bundles as VTK files, read back by means of their XML heads. */
#include "fe/output/bundle_vtk.h"

#include "fe/output/bundle_vtk_private.h"
#include "tests/fe/bundle/bundles.h"

#define TWO                                                                                        \
    "wires: [{wire: type3, count: 3}]\npacking: triangle\ntape: tape\n"                            \
    "taping: {layout: sleeve, layers: 2}\n"                                                        \
    "run: {mesh: four, deflection_mm: 20}\nloads: {weight: false}\n"

static struct wb_bundle_fields fields;

/* Fields of a real mesh, with values that identify their positions. */
static int set_up(void **state)
{
    const struct wb_bundle_settings settings = {.duration = 1.0};
    struct wb_bundle *bundle;
    (void)state;
    read_model(TWO);
    assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
    wb_bundle_fields_init(&fields, bundle);
    wb_bundle_destroy(bundle);
    for (int i = 0; i < fields.n_points; i++) {
        for (int k = 0; k < 3; k++)
            fields.position[i][k] = fields.reference[i][k] + 1e-3 * (1 + k) * sin(0.1 * i);
        fields.von_mises[i] = 1e6 * (2.0 + cos(0.2 * i));
        fields.plastic[i] = 1e-5 * i;
    }
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    wb_log_set_sink(NULL, NULL);
    wb_bundle_fields_release(&fields);
    return 0;
}

static char *path_of(const char *name)
{
    static char path[WB_PATH];
    assert_int_equal(wb_file_join(path, folder, name), WB_OK);
    return path;
}

struct vtu {
    char *bytes;
    size_t size;
    const unsigned char *data; /* after the underscore */
    size_t used;               /* bytes of data, summed over the arrays that were read */
};

static uint64_t unsigned_at(const unsigned char *p, int n)
{
    uint64_t value = 0;
    for (int k = n - 1; k >= 0; k--)
        value = value << 8 | p[k];
    return value;
}

static void read_vtu(struct vtu *vtu, const char *path)
{
    static const char opening[] = "<AppendedData encoding=\"raw\">\n_";
    char piece[100];
    memset(vtu, 0, sizeof *vtu);
    assert_int_equal(wb_file_read(path, &vtu->bytes, &vtu->size), WB_OK);
    snprintf(piece, sizeof piece, "<Piece NumberOfPoints=\"%d\" NumberOfCells=\"%d\">",
             fields.n_points, fields.n_hexahedra + fields.n_quads);
    assert_non_null(strstr(vtu->bytes, piece));
    const char *appended = strstr(vtu->bytes, opening);
    assert_non_null(appended);
    vtu->data = (const unsigned char *)appended + strlen(opening);
}

/* Values of an array that has `values` numbers of `bytes` bytes, at the position given in the
 * head. */
static const unsigned char *array_of(struct vtu *vtu, const char *type, const char *name,
                                     int values, int bytes)
{
    char label[120];
    snprintf(label, sizeof label, "<DataArray type=\"%s\" Name=\"%s\"", type, name);
    const char *at = strstr(vtu->bytes, label);
    assert_non_null(at);
    const char *offset = strstr(at, " offset=\"");
    assert_non_null(offset);
    assert_true(offset < strchr(at, '>'));
    const unsigned char *block = vtu->data + strtoull(offset + 9, NULL, 10);
    assert_true((const char *)block + 8 + values * bytes <= vtu->bytes + vtu->size);
    assert_int_equal(unsigned_at(block, 8), values * bytes);
    vtu->used += (size_t)(8 + values * bytes);
    return block + 8;
}

static double single(const unsigned char *array, int i)
{
    const uint32_t bits = (uint32_t)unsigned_at(array + 4 * (size_t)i, 4);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

static int integer(const unsigned char *array, int i)
{
    return (int)unsigned_at(array + 4 * (size_t)i, 4);
}

static void check_cells(struct vtu *v)
{
    const int hexahedra = fields.n_hexahedra, cells = hexahedra + fields.n_quads;
    const unsigned char *wire = array_of(v, "Int32", "wire", cells, 4);
    const unsigned char *nodes =
        array_of(v, "Int32", "connectivity", 8 * hexahedra + 4 * fields.n_quads, 4);
    const unsigned char *ends = array_of(v, "Int32", "offsets", cells, 4);
    const unsigned char *types = array_of(v, "UInt8", "types", cells, 1);
    int begin = 0;
    for (int e = 0; e < cells; e++) {
        const bool is_quad = e >= hexahedra;
        const int *expected = is_quad ? fields.quad[e - hexahedra] : fields.hexahedron[e];
        const int n = is_quad ? 4 : 8;
        assert_int_equal(types[e], is_quad ? 9 : 12);
        assert_int_equal(integer(wire, e), is_quad ? 0 : 1 + e / (4 * 15));
        for (int a = 0; a < n; a++)
            assert_int_equal(integer(nodes, begin + a), expected[a]);
        begin += n;
        assert_int_equal(integer(ends, e), begin);
    }
}

static void check_file(const char *path, double deflection_mm)
{
    static const char closing[] = "\n  </AppendedData>\n</VTKFile>\n";
    const int n = fields.n_points;
    struct vtu v;
    read_vtu(&v, path);
    const uint64_t bits = unsigned_at(array_of(&v, "Float64", "deflection_mm", 1, 8), 8);
    double deflection;
    memcpy(&deflection, &bits, sizeof deflection);
    assert_close(deflection, deflection_mm, 1e-12);
    const unsigned char *x = array_of(&v, "Float32", "position_mm", 3 * n, 4);
    const unsigned char *u = array_of(&v, "Float32", "displacement_mm", 3 * n, 4);
    const unsigned char *mises = array_of(&v, "Float32", "von_mises_MPa", n, 4);
    const unsigned char *plastic = array_of(&v, "Float32", "plastic_strain", n, 4);
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < 3; k++) {
            assert_close(single(x, 3 * i + k), 1e3 * fields.reference[i][k], 1e-5);
            assert_close(single(u, 3 * i + k), (1 + k) * sin(0.1 * i), 1e-6);
        }
        assert_close(single(mises, i), 2.0 + cos(0.2 * i), 1e-6);
        assert_close(single(plastic, i), 1e-5 * i, 1e-8);
    }
    check_cells(&v);
    assert_string_equal((const char *)v.data + v.used, closing);
    assert_int_equal((const char *)v.data + v.used + strlen(closing) - v.bytes, v.size);
    free(v.bytes);
}

static void files_read_back(void **unused)
{
    (void)unused;
    const char *path = path_of("one.vtu");
    assert_int_equal(wb_bundle_vtk_write(path, &fields, 12.5e-3), WB_OK);
    check_file(path, 12.5);
}

/* The .pvd file lists exactly `n` existing states. */
static void check_series(int n, const double *times)
{
    char *text, *at;
    assert_int_equal(wb_file_read(path_of("a&b.pvd"), &text, NULL), WB_OK);
    assert_non_null(strstr(text, "  </Collection>\n</VTKFile>\n"));
    at = text;
    for (int i = 0; i < n; i++) {
        double time;
        char file[40], expected[40];
        at = strstr(at, "<DataSet ");
        assert_non_null(at);
        assert_int_equal(
            sscanf(at, "<DataSet timestep=\"%lf\" part=\"0\" file=\"%39[^\"]\"/>", &time, file), 2);
        snprintf(expected, sizeof expected, "a&amp;b-%04d.vtu", i);
        assert_close(time, times[i], 0.0);
        assert_string_equal(file, expected);
        snprintf(expected, sizeof expected, "a&b-%04d.vtu", i);
        check_file(path_of(expected), 10.0 * times[i]);
        at++;
    }
    assert_null(strstr(at, "<DataSet "));
    free(text);
}

static void series_grow_and_restart(void **unused)
{
    (void)unused;
    static const double times[3] = {0.0, 0.1, 2.5}, later[1] = {0.7};
    struct wb_vtk_file_series series;
    assert_int_equal(wb_vtk_file_series_init(&series, folder, "a&b"), WB_OK);
    assert_int_equal(wb_vtk_file_series_restart(&series), WB_OK);
    assert_false(wb_file_exists(path_of("a&b.pvd")));
    for (int i = 0; i < 3; i++) {
        assert_int_equal(wb_bundle_vtk_add(&series, times[i], 10e-3 * times[i], &fields), WB_OK);
        check_series(i + 1, times);
    }
    assert_int_equal(wb_vtk_file_series_restart(&series), WB_OK);
    assert_false(wb_file_exists(path_of("a&b.pvd")));
    assert_false(wb_file_exists(path_of("a&b-0000.vtu")));
    assert_false(wb_file_exists(path_of("a&b-0002.vtu")));
    assert_int_equal(wb_bundle_vtk_add(&series, later[0], 7e-3, &fields), WB_OK);
    check_series(1, later);
    wb_vtk_file_series_release(&series);
    wb_vtk_file_series_release(&series);
}

static void non_finite_values_are_rejected(void **unused)
{
    (void)unused;
    const char *path = path_of("bad.vtu");
    struct wb_vtk_file_series series;
    double *places[] = {&fields.position[3][1], &fields.von_mises[5], &fields.plastic[2]};
    wb_log_set_sink(discard_message, NULL);
    for (int i = 0; i < 3; i++) {
        const double good = *places[i];
        *places[i] = i == 1 ? (double)INFINITY : (double)NAN;
        assert_int_equal(wb_bundle_vtk_write(path, &fields, 0.0), WB_ERR_DATA);
        assert_false(wb_file_exists(path));
        *places[i] = good;
    }
    assert_int_equal(wb_vtk_file_series_init(&series, folder, "s"), WB_OK);
    assert_int_equal(wb_bundle_vtk_add(&series, (double)NAN, 0.0, &fields), WB_ERR_ARGUMENT);
    assert_int_equal(series.n, 0);
    wb_vtk_file_series_release(&series);
}

static void invalid_names_are_rejected(void **unused)
{
    (void)unused;
    char lengthy[WB_VTK_FILE_NAME + 1] = {0};
    struct wb_vtk_file_series series;
    memset(lengthy, 'x', WB_VTK_FILE_NAME);
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_vtk_file_series_init(&series, folder, ""), WB_ERR_ARGUMENT);
    assert_int_equal(wb_vtk_file_series_init(&series, folder, "a/b"), WB_ERR_ARGUMENT);
    assert_int_equal(wb_vtk_file_series_init(&series, folder, lengthy), WB_ERR_ARGUMENT);
    assert_int_equal(wb_vtk_file_series_init(&series, path_of("nowhere"), "s"), WB_OK);
    assert_int_not_equal(wb_bundle_vtk_add(&series, 0.0, 0.0, &fields), WB_OK);
    assert_int_equal(series.n, 0);
    wb_vtk_file_series_release(&series);
}

/* The documented size, by which the paper's mesh of 225,792 hexahedra and its tape take 19 MB per
 * state. */
static void a_hexahedron_takes_eighty_bytes(void **unused)
{
    (void)unused;
    const struct wb_bundle_settings settings = {.duration = 1.0};
    struct wb_bundle_fields paper;
    struct wb_bundle *bundle;
    char *bytes;
    size_t size;
    read_model("  - {name: fine, core_quads: 6, rings: 2, elements_along: 30, "
               "formulation: one-point}\n" ONE
               "run: {mesh: fine, deflection_mm: 20}\nloads: {weight: false}\n");
    assert_int_equal(wb_bundle_create(&bundle, &model, &settings), WB_OK);
    wb_bundle_fields_init(&paper, bundle);
    wb_bundle_destroy(bundle);
    assert_int_equal(wb_bundle_vtk_write(path_of("size.vtu"), &paper, 0.0), WB_OK);
    assert_int_equal(wb_file_read(path_of("size.vtu"), &bytes, &size), WB_OK);
    assert_true((double)size < 85.0 * paper.n_hexahedra);
    free(bytes);
    wb_bundle_fields_release(&paper);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(files_read_back, set_up, tear_down),
        cmocka_unit_test_setup_teardown(series_grow_and_restart, set_up, tear_down),
        cmocka_unit_test_setup_teardown(non_finite_values_are_rejected, set_up, tear_down),
        cmocka_unit_test_setup_teardown(invalid_names_are_rejected, set_up, tear_down),
        cmocka_unit_test(a_hexahedron_takes_eighty_bytes),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
