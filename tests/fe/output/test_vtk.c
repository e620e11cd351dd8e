#include "fe/output/vtk.h"

#include <stdlib.h>

#include "fe/output/vtk_private.h"
#include "tests/own_folder.h"

static struct wb_solid_mesh mesh;
static struct wb_wire3d_fields fields;

/* Fields that are smooth in each part and discontinuous at the interface. */
static void fill_fields(void)
{
    for (int i = 0; i < mesh.n_nodes; i++) {
        for (int k = 0; k < 3; k++)
            fields.position[i][k] = mesh.node[i][k] + 1e-3 * sin(i + 0.3 * k);
    }
    for (int e = 0; e < mesh.n_elements; e++) {
        for (int a = 0; a < 20; a++) {
            const int node = mesh.element[e][a];
            for (int k = 0; k < 6; k++)
                fields.stress[e][a][k] = (mesh.part[e] ? 3e5 : 4e8) * cos(0.1 * node + k);
            fields.plastic[e][a] = mesh.part[e] ? 0.01 * node : 0.5 + 0.01 * node;
        }
    }
}

static void take_fields(const struct wb_solid_mesh_wire *wire)
{
    assert_int_equal(wb_solid_mesh_sweep(&mesh, wire), WB_OK);
    fields.position = calloc((size_t)mesh.n_nodes, sizeof *fields.position);
    fields.stress = calloc((size_t)mesh.n_elements, sizeof *fields.stress);
    fields.plastic = calloc((size_t)mesh.n_elements, sizeof *fields.plastic);
    assert_true(fields.position && fields.stress && fields.plastic);
    fill_fields();
}

static void let_go_of_fields(void)
{
    free(fields.position);
    free(fields.stress);
    free(fields.plastic);
    wb_solid_mesh_release(&mesh);
}

static const struct wb_solid_mesh_wire bonded = {
    .length = 0.02,
    .n_parts = 2,
    .outer_diameter = {3e-3, 5e-3},
    .elements_along = 2,
    .section_density = 1,
};

static int set_up(void **state)
{
    take_fields(&bonded);
    return make_folder(state);
}

static int tear_down(void **state)
{
    wb_log_set_sink(NULL, NULL);
    let_go_of_fields();
    return remove_folder(state);
}

static char *path_of(const char *name)
{
    static char path[WB_PATH];
    assert_int_equal(wb_file_join(path, folder, name), WB_OK);
    return path;
}

/* A .vtu file read back by means of its XML head. */
struct vtu {
    char *bytes;
    size_t size;
    const unsigned char *data; /* after the underscore */
    size_t used;               /* bytes of data, summed over the arrays that were read */
    int n_points, n_cells;
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
    static const char opening[] = "<AppendedData encoding=\"raw\">";
    memset(vtu, 0, sizeof *vtu);
    assert_int_equal(wb_file_read(path, &vtu->bytes, &vtu->size), WB_OK);
    assert_non_null(strstr(vtu->bytes, "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
                                       "byte_order=\"LittleEndian\" header_type=\"UInt64\">"));
    const char *piece = strstr(vtu->bytes, "<Piece ");
    assert_non_null(piece);
    assert_int_equal(sscanf(piece, "<Piece NumberOfPoints=\"%d\" NumberOfCells=\"%d\">",
                            &vtu->n_points, &vtu->n_cells),
                     2);
    const char *appended = strstr(vtu->bytes, opening);
    assert_non_null(appended);
    const char *start = strchr(appended + strlen(opening), '_');
    assert_non_null(start);
    vtu->data = (const unsigned char *)start + 1;
}

/* Values of an array that has `values` numbers of `bytes` bytes. */
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
    assert_true((const char *)block + 8 <= vtu->bytes + vtu->size);
    assert_int_equal(unsigned_at(block, 8), values * bytes);
    assert_true((const char *)block + 8 + values * bytes <= vtu->bytes + vtu->size);
    vtu->used += (size_t)(8 + values * bytes);
    return block + 8;
}

static double number(const unsigned char *array, int i)
{
    const uint64_t bits = unsigned_at(array + (size_t)8 * (size_t)i, 8);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static int integer(const unsigned char *array, int i)
{
    return (int)unsigned_at(array + (size_t)4 * (size_t)i, 4);
}

static double mises_of(const double s[6])
{
    const double p = (s[0] + s[1] + s[2]) / 3.0;
    double sum = 0.0;
    for (int k = 0; k < 6; k++)
        sum += k < 3 ? (s[k] - p) * (s[k] - p) : 2.0 * s[k] * s[k];
    return sqrt(1.5 * sum);
}

/* Each cell must have its nodes' positions and its own part's values, through the connectivity. */
static void check_file(const char *path, int expected_points)
{
    struct vtu v;
    read_vtu(&v, path);
    assert_int_equal(v.n_points, expected_points);
    assert_int_equal(v.n_cells, mesh.n_elements);
    const int n = v.n_points, cells = v.n_cells;
    const unsigned char *u = array_of(&v, "Float64", "displacement_mm", 3 * n, 8);
    const unsigned char *s = array_of(&v, "Float64", "stress_MPa", 6 * n, 8);
    const unsigned char *mises = array_of(&v, "Float64", "von_mises_MPa", n, 8);
    const unsigned char *plastic = array_of(&v, "Float64", "plastic_strain", n, 8);
    const unsigned char *part = array_of(&v, "Int32", "part", cells, 4);
    const unsigned char *x = array_of(&v, "Float64", "position_mm", 3 * n, 8);
    const unsigned char *nodes = array_of(&v, "Int32", "connectivity", 20 * cells, 4);
    const unsigned char *ends = array_of(&v, "Int32", "offsets", cells, 4);
    const unsigned char *types = array_of(&v, "UInt8", "types", cells, 1);
    static const char closing[] = "\n  </AppendedData>\n</VTKFile>\n";
    assert_string_equal((const char *)v.data + v.used, closing);
    assert_int_equal((const char *)v.data + v.used + strlen(closing) - v.bytes, v.size);

    int *user = calloc((size_t)n, sizeof *user); /* 1 + part that uses a point */
    assert_non_null(user);
    for (int e = 0; e < cells; e++) {
        assert_int_equal(types[e], 25);
        assert_int_equal(integer(ends, e), 20 * (e + 1));
        assert_int_equal(integer(part, e), mesh.part[e]);
        for (int a = 0; a < 20; a++) {
            const int p = integer(nodes, 20 * e + a), node = mesh.element[e][a];
            assert_in_range(p, 0, n - 1);
            assert_true(user[p] == 0 || user[p] == 1 + mesh.part[e]);
            user[p] = 1 + mesh.part[e];
            for (int k = 0; k < 3; k++) {
                const double now = number(x, 3 * p + k) + number(u, 3 * p + k);
                assert_close(number(x, 3 * p + k), 1e3 * mesh.node[node][k], 1e-12);
                assert_close(now, 1e3 * fields.position[node][k], 1e-12);
            }
            for (int k = 0; k < 6; k++)
                assert_close(number(s, 6 * p + k), 1e-6 * fields.stress[e][a][k], 1e-12);
            assert_close(number(mises, p), 1e-6 * mises_of(fields.stress[e][a]), 1e-12);
            assert_close(number(plastic, p), fields.plastic[e][a], 0.0);
        }
    }
    for (int p = 0; p < n; p++)
        assert_true(user[p] > 0);
    free(user);
    free(v.bytes);
}

static void file_reads_back_with_a_jump_between_bonded_parts(void **unused)
{
    (void)unused;
    const char *path = path_of("bonded.vtu");
    assert_int_equal(wb_vtk_write(path, &mesh, &fields), WB_OK);
    /* The interface has 16 nodes in each of 3 sections and 8 between two. */
    check_file(path, mesh.n_nodes + 3 * 16 + 2 * 8);
}

static void split_parts_need_no_more_points(void **unused)
{
    (void)unused;
    struct wb_solid_mesh_wire wire = bonded;
    const char *path = path_of("split.vtu");
    wire.split = 1;
    let_go_of_fields();
    take_fields(&wire);
    assert_int_equal(wb_vtk_write(path, &mesh, &fields), WB_OK);
    check_file(path, mesh.n_nodes);
}

static void equal_states_give_equal_files(void **unused)
{
    (void)unused;
    char *a, *b;
    size_t size_a, size_b;
    assert_int_equal(wb_vtk_write(path_of("a.vtu"), &mesh, &fields), WB_OK);
    assert_int_equal(wb_vtk_write(path_of("b.vtu"), &mesh, &fields), WB_OK);
    assert_int_equal(wb_file_read(path_of("a.vtu"), &a, &size_a), WB_OK);
    assert_int_equal(wb_file_read(path_of("b.vtu"), &b, &size_b), WB_OK);
    assert_int_equal(size_a, size_b);
    assert_memory_equal(a, b, size_a);
    free(a);
    free(b);
}

/* The .pvd file lists exactly `n` existing states. */
static void check_series(int n, const double *times)
{
    char *text, *at;
    assert_int_equal(wb_file_read(path_of("a&b.pvd"), &text, NULL), WB_OK);
    assert_non_null(strstr(text, "<VTKFile type=\"Collection\""));
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
        check_file(path_of(expected), mesh.n_nodes + 3 * 16 + 2 * 8);
        at++;
    }
    assert_null(strstr(at, "<DataSet "));
    free(text);
}

static void series_can_be_read_after_each_state(void **unused)
{
    (void)unused;
    static const double times[3] = {0.0, 0.1, 2.5};
    struct wb_vtk_file_series series;
    assert_int_equal(wb_vtk_file_series_init(&series, folder, "a&b"), WB_OK);
    assert_false(wb_file_exists(path_of("a&b.pvd")));
    for (int i = 0; i < 3; i++) {
        assert_int_equal(wb_vtk_add(&series, times[i], &mesh, &fields), WB_OK);
        check_series(i + 1, times);
    }
    wb_vtk_file_series_release(&series);
    wb_vtk_file_series_release(&series);
}

static void non_finite_values_are_rejected(void **unused)
{
    (void)unused;
    const char *path = path_of("bad.vtu");
    struct wb_vtk_file_series series;
    double *places[] = {&fields.position[3][1], &fields.stress[5][19][5], &fields.plastic[2][7]};
    wb_log_set_sink(discard_message, NULL);
    for (int i = 0; i < 3; i++) {
        const double good = *places[i];
        *places[i] = i == 1 ? (double)INFINITY : (double)NAN;
        assert_int_equal(wb_vtk_write(path, &mesh, &fields), WB_ERR_DATA);
        assert_false(wb_file_exists(path));
        *places[i] = good;
    }
    assert_int_equal(wb_vtk_file_series_init(&series, folder, "s"), WB_OK);
    assert_int_equal(wb_vtk_add(&series, (double)NAN, &mesh, &fields), WB_ERR_ARGUMENT);
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
    assert_int_not_equal(wb_vtk_add(&series, 0.0, &mesh, &fields), WB_OK);
    assert_int_equal(series.n, 0);
    wb_vtk_file_series_release(&series);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(file_reads_back_with_a_jump_between_bonded_parts, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(split_parts_need_no_more_points, set_up, tear_down),
        cmocka_unit_test_setup_teardown(equal_states_give_equal_files, set_up, tear_down),
        cmocka_unit_test_setup_teardown(series_can_be_read_after_each_state, set_up, tear_down),
        cmocka_unit_test_setup_teardown(non_finite_values_are_rejected, set_up, tear_down),
        cmocka_unit_test_setup_teardown(invalid_names_are_rejected, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
