#include "fe/solid/solid_mesh.h"

#include <stdbool.h>
#include <stdlib.h>

#include "tests/check.h"
#include "tests/fe/solid/block_mesh.h"

static const struct wb_solid_mesh_wire cylinder = {
    .length = 10.0,
    .n_parts = 1,
    .outer_diameter = {2.0},
    .elements_along = 3,
    .section_density = 1,
};
static const struct wb_solid_mesh_wire jacketed = {
    .length = 20.0,
    .n_parts = 2,
    .outer_diameter = {3.26, 4.86},
    .elements_along = 4,
    .section_density = 2,
    .split = 1,
};

/* Local coordinates of the nodes, from the description in the header. */
static const double local[20][3] = {
    {-1, -1, -1}, {1, -1, -1}, {1, 1, -1},  {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1},
    {-1, 1, 1},   {0, -1, -1}, {1, 0, -1},  {0, 1, -1},  {-1, 0, -1}, {0, -1, 1}, {1, 0, 1},
    {0, 1, 1},    {-1, 0, 1},  {-1, -1, 0}, {1, -1, 0},  {1, 1, 0},   {-1, 1, 0},
};

/* Serendipity shape function of node a and its gradient. */
static double shape(int a, const double x[3])
{
    const double *at = local[a];
    double product = 1.0, sum = 0.0;
    for (int k = 0; k < 3; k++) {
        product *= at[k] == 0.0 ? 1.0 - x[k] * x[k] : 1.0 + at[k] * x[k];
        sum += at[k] * x[k];
    }
    return a < 8 ? product / 8.0 * (sum - 2.0) : product / 4.0;
}

static double shape_slope(int a, const double x[3], int k)
{
    const double h = 1e-4;
    double up[3] = {x[0], x[1], x[2]}, down[3] = {x[0], x[1], x[2]};
    up[k] += h;
    down[k] -= h;
    return (shape(a, up) - shape(a, down)) / (2.0 * h); /* exact to h^2, the functions are cubic */
}

static double jacobian(const struct wb_solid_mesh *mesh, int e, const double x[3])
{
    double J[3][3] = {{0.0}};
    for (int a = 0; a < 20; a++) {
        for (int k = 0; k < 3; k++) {
            const double slope = shape_slope(a, x, k);
            for (int i = 0; i < 3; i++)
                J[i][k] += mesh->node[mesh->element[e][a]][i] * slope;
        }
    }
    return J[0][0] * (J[1][1] * J[2][2] - J[1][2] * J[2][1]) -
           J[0][1] * (J[1][0] * J[2][2] - J[1][2] * J[2][0]) +
           J[0][2] * (J[1][0] * J[2][1] - J[1][1] * J[2][0]);
}

/* Volume of a part, -1 for all; *worst: the smallest Jacobian over the mean one at Gauss points and
 * corners. */
static double volume(const struct wb_solid_mesh *mesh, int part, double *worst)
{
    static const double point[3] = {-0.7745966692414834, 0.0, 0.7745966692414834};
    static const double weight[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
    double sum = 0.0;
    for (int e = 0; e < mesh->n_elements; e++) {
        double own = 0.0, least = (double)INFINITY;
        for (int g = 0; g < 27; g++) {
            const double x[3] = {point[g % 3], point[g / 3 % 3], point[g / 9]};
            const double J = jacobian(mesh, e, x);
            own += weight[g % 3] * weight[g / 3 % 3] * weight[g / 9] * J;
            least = fmin(least, J);
        }
        for (int c = 0; c < 8; c++)
            least = fmin(least, jacobian(mesh, e, local[c]));
        if (worst)
            *worst = fmin(*worst, least / (own / 8.0));
        if (part < 0 || mesh->part[e] == part)
            sum += own;
    }
    return sum;
}

/* Area of an 8-node face and the integral of its normal, 3 x 3 points. */
static double face_area(const struct wb_solid_mesh *mesh, const int node[8], double normal[3])
{
    static const double point[3] = {-0.7745966692414834, 0.0, 0.7745966692414834};
    static const double weight[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
    static const int in_hex[8] = {0, 1, 2, 3, 8, 9, 10, 11};
    double area = 0.0;
    normal[0] = normal[1] = normal[2] = 0.0;
    for (int g = 0; g < 9; g++) {
        const double x[3] = {point[g % 3], point[g / 3], -1.0};
        double t[2][3] = {{0.0}};
        for (int a = 0; a < 8; a++) {
            for (int k = 0; k < 2; k++) {
                for (int i = 0; i < 3; i++)
                    t[k][i] += mesh->node[node[a]][i] * shape_slope(in_hex[a], x, k);
            }
        }
        double n[3];
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            n[i] = t[0][j] * t[1][k] - t[0][k] * t[1][j];
            normal[i] += weight[g % 3] * weight[g / 3] * n[i];
        }
        area += weight[g % 3] * weight[g / 3] * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    }
    return area;
}

/* Area within parabolas through the corners and midside nodes of n equal parts of a circle of
 * radius 1, as represented by these elements. */
static double parabolic_area(int n)
{
    const double half = M_PI / n;
    return n * (0.5 * sin(2.0 * half) + 4.0 / 3.0 * sin(half) * (1.0 - cos(half)));
}

static double distance(const struct wb_solid_mesh *mesh, int a, int b)
{
    const double *p = mesh->node[a], *q = mesh->node[b];
    return sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) +
                (p[2] - q[2]) * (p[2] - q[2]));
}

static double radius(const struct wb_solid_mesh *mesh, int a)
{
    return hypot(mesh->node[a][1], mesh->node[a][2]);
}

/* Pairs of nodes at the same place. */
static int coinciding(const struct wb_solid_mesh *mesh)
{
    int found = 0;
    for (int a = 0; a < mesh->n_nodes; a++) {
        for (int b = a + 1; b < mesh->n_nodes; b++)
            found += distance(mesh, a, b) < 1e-9 * mesh->node[mesh->n_nodes - 1][0];
    }
    return found;
}

static int layer_of(const struct wb_solid_mesh *mesh, int node)
{
    int l = 0;
    while (node >= mesh->layer[l + 1])
        l++;
    return l;
}

/* Checks the header's statements about layers and links for a list of coupled nodes. */
static void check_coupling(const struct wb_solid_mesh *mesh, const int *node, int n)
{
    int least = mesh->n_layers, most = -1;
    for (int k = 0; k < n; k++) {
        assert_in_range(node[k], 0, mesh->n_nodes - 1);
        const int l = layer_of(mesh, node[k]);
        least = l < least ? l : least;
        most = l > most ? l : most;
    }
    assert_true(most - least <= 1);
    for (int k = 0; k < n && most > least; k++) {
        if (layer_of(mesh, node[k]) == least)
            assert_true(node[k] >= mesh->link[least]);
    }
}

static void check_layers(const struct wb_solid_mesh *mesh)
{
    assert_int_equal(mesh->layer[0], 0);
    assert_int_equal(mesh->layer[mesh->n_layers], mesh->n_nodes);
    for (int l = 0; l < mesh->n_layers; l++)
        assert_true(mesh->layer[l] <= mesh->link[l] && mesh->link[l] < mesh->layer[l + 1]);
    for (int e = 0; e < mesh->n_elements; e++)
        check_coupling(mesh, mesh->element[e], 20);
    for (int p = 0; p < mesh->n_pairs; p++) {
        int both[16];
        memcpy(both, mesh->pair[p].inner, sizeof mesh->pair[p].inner);
        memcpy(both + 8, mesh->pair[p].outer, sizeof mesh->pair[p].outer);
        check_coupling(mesh, both, 16);
    }
}

static void volume_converges_to_the_cylinder(void **unused)
{
    (void)unused;
    double error[3];
    for (int k = 0; k < 3; k++) {
        struct wb_solid_mesh_wire wire = cylinder;
        struct wb_solid_mesh mesh;
        double worst = (double)INFINITY;
        wire.section_density = 1 << k;
        assert_int_equal(wb_solid_mesh_sweep(&mesh, &wire), WB_OK);
        assert_int_equal(mesh.n_elements, 3 * 12 * (1 << 2 * k));
        const double inside = volume(&mesh, -1, &worst);
        assert_close_relative(inside, 10.0 * parabolic_area(8 << k), 1e-8);
        error[k] = 1.0 - inside / (M_PI * 10.0);
        print_message("density %d: volume %+.2e, least Jacobian %.3f of the mean\n", 1 << k,
                      -error[k], worst);
        assert_true(worst > 0.4);
        wb_solid_mesh_release(&mesh);
    }
    assert_close(log2(error[0] / error[1]), 4.0, 0.05);
    assert_close(log2(error[1] / error[2]), 4.0, 0.05);
}

static void coarsest_section_is_the_one_of_the_reference(void **unused)
{
    (void)unused;
    struct wb_solid_mesh mesh;
    assert_int_equal(wb_solid_mesh_sweep(&mesh, &cylinder), WB_OK);
    assert_int_equal(mesh.n_clamp, 45);
    /* Some of its nodes, over the radius. */
    static const double some[][2] = {
        {0.495, 0.495},          {0.0, 0.5544},           {-0.5395500, -0.2475}, {0.2772, 0.0},
        {0.3826834, -0.9238795}, {-0.6010534, 0.6010534}, {-1.0, 0.0},           {0.0, -0.7772}};
    for (size_t k = 0; k < sizeof some / sizeof some[0]; k++) {
        double nearest = (double)INFINITY;
        for (int i = 0; i < mesh.n_clamp; i++)
            nearest = fmin(nearest, hypot(mesh.node[mesh.clamp[i]][1] - some[k][0],
                                          mesh.node[mesh.clamp[i]][2] - some[k][1]));
        assert_close(nearest, 0.0, 1e-6);
    }
    wb_solid_mesh_release(&mesh);
}

static void layers_contain_the_halfway_nodes_and_then_the_section(void **unused)
{
    (void)unused;
    struct wb_solid_mesh mesh;
    assert_int_equal(wb_solid_mesh_sweep(&mesh, &jacketed), WB_OK);
    check_layers(&mesh);
    assert_int_equal(mesh.n_layers, 5);
    assert_int_equal(mesh.link[0], 0);
    for (int l = 0; l < mesh.n_layers; l++) {
        for (int i = mesh.layer[l]; i < mesh.layer[l + 1]; i++)
            assert_close(mesh.node[i][0], i < mesh.link[l] ? 5.0 * l - 2.5 : 5.0 * l, 1e-12);
    }
    wb_solid_mesh_release(&mesh);
}

static void bonded_parts_share_their_nodes(void **unused)
{
    (void)unused;
    struct wb_solid_mesh_wire wire = jacketed;
    struct wb_solid_mesh mesh;
    wire.split = 0;
    assert_int_equal(wb_solid_mesh_sweep(&mesh, &wire), WB_OK);
    check_layers(&mesh);
    assert_int_equal(coinciding(&mesh), 0);
    assert_int_equal(mesh.n_pairs, 0);
    wb_solid_mesh_release(&mesh);
}

static void parts_have_their_volumes_and_own_circles(void **unused)
{
    (void)unused;
    struct wb_solid_mesh mesh;
    double worst = (double)INFINITY;
    assert_int_equal(wb_solid_mesh_sweep(&mesh, &jacketed), WB_OK);
    assert_int_equal(mesh.n_parts, 2);
    assert_close_relative(volume(&mesh, 0, &worst), 1.63 * 1.63 * parabolic_area(16) * 20.0, 1e-8);
    assert_close_relative(volume(&mesh, 1, NULL),
                          (2.43 * 2.43 - 1.63 * 1.63) * parabolic_area(16) * 20.0, 1e-8);
    assert_true(worst > 0.4);
    /* 16 segments and so 32 nodes around in a section, midside nodes too; 16 halfway. */
    int on[2] = {0, 0};
    for (int i = 0; i < mesh.n_nodes; i++) {
        on[0] += fabs(radius(&mesh, i) - 1.63) < 1e-14;
        on[1] += fabs(radius(&mesh, i) - 2.43) < 1e-14;
    }
    assert_int_equal(on[0], 2 * (5 * 32 + 4 * 16)); /* the core's and the jacket's */
    assert_int_equal(on[1], 5 * 32 + 4 * 16);
    wb_solid_mesh_release(&mesh);
}

static bool part_has_node(const struct wb_solid_mesh *mesh, int part, int node)
{
    for (int e = 0; e < mesh->n_elements; e++) {
        for (int k = 0; k < 20; k++) {
            if (mesh->element[e][k] == node && mesh->part[e] == part)
                return true;
        }
    }
    return false;
}

static void pairs_coincide_and_point_outward(void **unused)
{
    (void)unused;
    struct wb_solid_mesh mesh;
    double area = 0.0;
    assert_int_equal(wb_solid_mesh_sweep(&mesh, &jacketed), WB_OK);
    assert_int_equal(mesh.n_pairs, 4 * 16);
    assert_int_equal(coinciding(&mesh), 5 * 32 + 4 * 16);
    for (int p = 0; p < mesh.n_pairs; p++) {
        const struct wb_solid_pair *pair = &mesh.pair[p];
        double normal[3], normal_outer[3], outward = 0.0;
        for (int k = 0; k < 8; k++) {
            assert_true(pair->inner[k] != pair->outer[k]);
            assert_close(distance(&mesh, pair->inner[k], pair->outer[k]), 0.0, 0.0);
            assert_true(part_has_node(&mesh, 0, pair->inner[k]));
            assert_true(part_has_node(&mesh, 1, pair->outer[k]));
            assert_false(part_has_node(&mesh, 1, pair->inner[k]));
        }
        area += face_area(&mesh, pair->inner, normal);
        (void)face_area(&mesh, pair->outer, normal_outer);
        for (int i = 0; i < 3; i++) {
            outward += normal[i] * (i > 0 ? mesh.node[pair->inner[4]][i] : 0.0);
            assert_close(normal[i], normal_outer[i], 1e-12);
        }
        assert_true(outward > 0.0);
    }
    assert_close_relative(area, M_PI * 3.26 * 20.0, 1e-4);
    wb_solid_mesh_release(&mesh);
}

static void tip_faces_cover_the_free_end(void **unused)
{
    (void)unused;
    struct wb_solid_mesh mesh;
    double area = 0.0;
    assert_int_equal(wb_solid_mesh_sweep(&mesh, &jacketed), WB_OK);
    assert_int_equal(mesh.n_tip_faces, 12 * 4 + 8 * 4);
    for (int f = 0; f < mesh.n_tip_faces; f++) {
        double normal[3];
        const struct wb_solid_face *face = &mesh.tip_face[f];
        for (int k = 0; k < 8; k++) {
            int found = 0;
            for (int a = 0; a < 20; a++)
                found += mesh.element[face->element][a] == face->node[k];
            assert_int_equal(found, 1);
            assert_close(mesh.node[face->node[k]][0], 20.0, 0.0);
        }
        area += face_area(&mesh, face->node, normal);
        assert_true(normal[0] > 0.0);
    }
    assert_close_relative(area, 2.43 * 2.43 * parabolic_area(16), 1e-8);
    wb_solid_mesh_release(&mesh);
}

static void clamp_and_axis_nodes_have_their_positions(void **unused)
{
    (void)unused;
    struct wb_solid_mesh mesh;
    int at_start = 0;
    assert_int_equal(wb_solid_mesh_sweep(&mesh, &jacketed), WB_OK);
    for (int i = 0; i < mesh.n_nodes; i++)
        at_start += mesh.node[i][0] == 0.0;
    assert_int_equal(mesh.n_clamp, at_start);
    for (int i = 0; i < mesh.n_clamp; i++)
        assert_close(mesh.node[mesh.clamp[i]][0], 0.0, 0.0);
    assert_int_equal(mesh.n_axis, 9);
    for (int i = 0; i < mesh.n_axis; i++) {
        assert_close(radius(&mesh, mesh.axis[i]), 0.0, 0.0);
        assert_close(mesh.node[mesh.axis[i]][0], 2.5 * i, 1e-12);
    }
    wb_solid_mesh_release(&mesh);
}

static void longitudinal_section_is_a_rectangle(void **unused)
{
    (void)unused;
    struct wb_solid_mesh mesh;
    struct wb_solid_face *faces;
    int n;
    double area = 0.0;
    assert_int_equal(wb_solid_mesh_sweep(&mesh, &jacketed), WB_OK);
    assert_int_equal(wb_solid_mesh_longitudinal(&mesh, &faces, &n), WB_OK);
    assert_int_equal(n, 4 * (4 + 2 * 2 + 2 * 2));
    for (int f = 0; f < n; f++) {
        double normal[3];
        area += face_area(&mesh, faces[f].node, normal);
        assert_true(normal[2] < 0.0); /* out of the half z > 0 */
        double above = 0.0;
        for (int a = 0; a < 20; a++)
            above += mesh.node[mesh.element[faces[f].element][a]][2];
        assert_true(above > 0.0);
    }
    assert_close_relative(area, 4.86 * 20.0, 1e-8);
    free(faces);
    wb_solid_mesh_release(&mesh);
}

/* The unit cube with side `k` of six on z = 0, above it. */
static void turned_cube(void *context, const double unit[3], double position[3])
{
    const int k = *(const int *)context, up = k / 2;
    const bool far = k % 2 == 1;
    position[2] = far ? 1.0 - unit[up] : unit[up];
    position[0] = unit[(up + (far ? 2 : 1)) % 3];
    position[1] = unit[(up + (far ? 1 : 2)) % 3];
}

static void every_side_of_an_element_can_lie_in_the_longitudinal_section(void **unused)
{
    (void)unused;
    for (int k = 0; k < 6; k++) {
        struct wb_solid_mesh mesh;
        struct wb_solid_face *faces;
        double normal[3];
        int n;
        test_block_mesh(&mesh, 1, 1, 1, turned_cube, &k);
        assert_close(volume(&mesh, 0, NULL), 1.0, 1e-8);
        assert_int_equal(wb_solid_mesh_longitudinal(&mesh, &faces, &n), WB_OK);
        assert_int_equal(n, 1);
        assert_close(face_area(&mesh, faces[0].node, normal), 1.0, 1e-8);
        assert_close(normal[2], -1.0, 1e-8);
        free(faces);
        wb_solid_mesh_release(&mesh);
    }
}

static void cross_section_is_taken_nearest_to_x(void **unused)
{
    (void)unused;
    /* x asked for, x of the section, first element */
    static const double cases[][3] = {{-1.0, 0.0, 0.0}, {0.0, 0.0, 0.0},     {2.4, 0.0, 0.0},
                                      {2.6, 5.0, 0.0},  {9.0, 10.0, 80.0},   {11.0, 10.0, 80.0},
                                      {20., 20., 240.}, {100.0, 20.0, 240.0}};
    struct wb_solid_mesh mesh;
    assert_int_equal(wb_solid_mesh_sweep(&mesh, &jacketed), WB_OK);
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        struct wb_solid_face *faces;
        int n;
        double area = 0.0;
        assert_int_equal(wb_solid_mesh_section(&mesh, cases[c][0], &faces, &n), WB_OK);
        assert_int_equal(n, 80);
        assert_int_equal(faces[0].element, (int)cases[c][2]);
        for (int f = 0; f < n; f++) {
            double normal[3];
            area += face_area(&mesh, faces[f].node, normal);
            assert_true(normal[0] > 0.0);
            assert_int_equal(faces[f].element, faces[0].element + f);
            for (int k = 0; k < 8; k++)
                assert_close(mesh.node[faces[f].node[k]][0], cases[c][1], 1e-12);
        }
        assert_close_relative(area, 2.43 * 2.43 * parabolic_area(16), 1e-8);
        free(faces);
    }
    wb_solid_mesh_release(&mesh);
}

/* A quarter of a thick ring, radii 1 to 2, height 3. */
static void quarter_ring(void *context, const double unit[3], double position[3])
{
    const double r = 1.0 + unit[0], angle = 0.5 * M_PI * unit[1];
    (void)context;
    position[0] = r * cos(angle);
    position[1] = r * sin(angle);
    position[2] = 3.0 * unit[2];
}

static void block_is_mapped_with_its_midside_nodes(void **unused)
{
    (void)unused;
    struct wb_solid_mesh mesh;
    double worst = (double)INFINITY;
    test_block_mesh(&mesh, 2, 3, 4, NULL, NULL);
    check_layers(&mesh);
    assert_int_equal(coinciding(&mesh), 0);
    assert_int_equal(mesh.n_elements, 24);
    assert_int_equal(mesh.n_nodes, 3 * (4 * 5 + 3 * 5 + 4 * 4) + 2 * 20);
    assert_int_equal(mesh.n_clamp + mesh.n_axis + mesh.n_tip_faces + mesh.n_pairs, 0);
    assert_close(volume(&mesh, 0, &worst), 1.0, 1e-9);
    assert_close(worst, 1.0, 1e-6);
    wb_solid_mesh_release(&mesh);

    test_block_mesh(&mesh, 2, 4, 1, quarter_ring, NULL);
    check_layers(&mesh);
    assert_close_relative(volume(&mesh, 0, NULL), 0.25 * M_PI * 3.0 * 3.0, 1e-4);
    for (int i = mesh.link[2]; i < mesh.n_nodes; i++)
        assert_close(hypot(mesh.node[i][0], mesh.node[i][1]), 2.0, 1e-14);
    wb_solid_mesh_release(&mesh);
}

static void empty_mesh_has_one_layer(void **unused)
{
    (void)unused;
    struct wb_solid_mesh mesh;
    assert_int_equal(wb_solid_mesh_init(&mesh, 20, 1), WB_OK);
    assert_int_equal(mesh.n_layers, 1);
    assert_int_equal(mesh.n_parts, 1);
    assert_int_equal(mesh.layer[1], 20);
    assert_int_equal(mesh.part[0], 0);
    wb_solid_mesh_release(&mesh);
    wb_solid_mesh_release(&mesh);
}

static void invalid_meshes_are_rejected(void **unused)
{
    (void)unused;
    struct wb_solid_mesh_wire bad[12];
    struct wb_solid_mesh mesh = {.n_nodes = -7};
    struct wb_solid_face *faces;
    int n;
    for (int k = 0; k < 12; k++)
        bad[k] = jacketed;
    bad[0].length = 0.0;
    bad[1].length = (double)NAN;
    bad[2].n_parts = 0;
    bad[3].n_parts = 3;
    bad[4].outer_diameter[0] = -1.0;
    bad[5].outer_diameter[1] = 3.26;
    bad[6].outer_diameter[1] = (double)INFINITY;
    bad[7].elements_along = 0;
    bad[8].section_density = 0;
    bad[9].section_density = 1000000;
    bad[10].elements_along = 100000; /* too many nodes */
    bad[10].section_density = 64;
    bad[11].length = (double)INFINITY;
    wb_log_set_sink(discard_message, NULL);
    for (int k = 0; k < 12; k++) {
        assert_int_equal(wb_solid_mesh_sweep(&mesh, &bad[k]), WB_ERR_ARGUMENT);
        assert_int_equal(mesh.n_nodes, -7);
    }
    assert_int_equal(wb_solid_mesh_init(&mesh, 0, 1), WB_ERR_ARGUMENT);
    test_block_mesh(&mesh, 1, 2, 1, NULL, NULL);
    assert_int_equal(wb_solid_mesh_section(&mesh, 0.0, &faces, &n), WB_ERR_ARGUMENT);
    wb_solid_mesh_release(&mesh);
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(volume_converges_to_the_cylinder),
        cmocka_unit_test(coarsest_section_is_the_one_of_the_reference),
        cmocka_unit_test(layers_contain_the_halfway_nodes_and_then_the_section),
        cmocka_unit_test(bonded_parts_share_their_nodes),
        cmocka_unit_test(parts_have_their_volumes_and_own_circles),
        cmocka_unit_test(pairs_coincide_and_point_outward),
        cmocka_unit_test(tip_faces_cover_the_free_end),
        cmocka_unit_test(clamp_and_axis_nodes_have_their_positions),
        cmocka_unit_test(longitudinal_section_is_a_rectangle),
        cmocka_unit_test(every_side_of_an_element_can_lie_in_the_longitudinal_section),
        cmocka_unit_test(cross_section_is_taken_nearest_to_x),
        cmocka_unit_test(block_is_mapped_with_its_midside_nodes),
        cmocka_unit_test(empty_mesh_has_one_layer),
        cmocka_unit_test(invalid_meshes_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
