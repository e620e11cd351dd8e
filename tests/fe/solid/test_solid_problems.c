/* The 3D solid against problems with known answers: patch tests, beams, torsion.
 * docs/verification.md has the numbers that this prints. */
#include "tests/fe/solid/solids.h"

#include "fe/solid/solid_mesh_private.h"
#include "fe/solid/solid_private.h"

/* ---- Patch tests: the cube of seven elements of MacNeal and Harder 1985 ---- */

enum {
    PATCH_CORNERS = 16,
    PATCH_EDGES = 32,
    PATCH_NODES = PATCH_CORNERS + PATCH_EDGES
};

static const double patch_corner[PATCH_CORNERS][3] = {
    {0, 0, 0},          {1, 0, 0},          {1, 1, 0},          {0, 1, 0},
    {0, 0, 1},          {1, 0, 1},          {1, 1, 1},          {0, 1, 1},
    {.249, .342, .192}, {.826, .288, .288}, {.850, .649, .263}, {.273, .750, .230},
    {.320, .186, .643}, {.677, .305, .683}, {.788, .693, .644}, {.165, .745, .702},
};

/* The inner element, then those on its sides, seen from inside. */
static const int patch_element[7][8] = {
    {8, 9, 10, 11, 12, 13, 14, 15}, {0, 1, 2, 3, 8, 9, 10, 11},   {12, 13, 14, 15, 4, 5, 6, 7},
    {0, 1, 9, 8, 4, 5, 13, 12},     {11, 10, 2, 3, 15, 14, 6, 7}, {0, 8, 11, 3, 4, 12, 15, 7},
    {9, 1, 2, 10, 13, 5, 6, 14},
};

static void patch_mesh(struct wb_solid_mesh *mesh)
{
    static const int ends[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                    {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
    int edge[PATCH_EDGES][2], edges = 0;
    assert_int_equal(wb_solid_mesh_init(mesh, PATCH_NODES, 7), WB_OK);
    memcpy(mesh->node, patch_corner, sizeof patch_corner);
    for (int e = 0; e < 7; e++) {
        memcpy(mesh->element[e], patch_element[e], sizeof patch_element[e]);
        for (int k = 0; k < 12; k++) {
            const int a = patch_element[e][ends[k][0]], b = patch_element[e][ends[k][1]];
            int known = 0;
            while (known < edges &&
                   !(edge[known][0] == (a < b ? a : b) && edge[known][1] == (a < b ? b : a)))
                known++;
            assert_true(known < PATCH_EDGES);
            if (known == edges) {
                edge[edges][0] = a < b ? a : b;
                edge[edges++][1] = a < b ? b : a;
                for (int i = 0; i < 3; i++)
                    mesh->node[PATCH_CORNERS + known][i] =
                        0.5 * (patch_corner[a][i] + patch_corner[b][i]);
            }
            mesh->element[e][8 + k] = PATCH_CORNERS + known;
        }
    }
    assert_int_equal(edges, PATCH_EDGES);
}

/* Displacements u = H x on the surface of the cube. Returns the number of free nodes. */
static int patch_hold(struct test_solid *t, const double H[3][3])
{
    int free_nodes = 0;
    for (int n = 0; n < t->mesh.n_nodes; n++) {
        const double *x = t->mesh.node[n];
        bool outside = false;
        for (int k = 0; k < 3; k++)
            outside = outside || x[k] == 0.0 || x[k] == 1.0;
        for (int k = 0; k < 3 && outside; k++)
            test_solid_hold(t, n, k, H[k][0] * x[0] + H[k][1] * x[1] + H[k][2] * x[2]);
        free_nodes += !outside;
    }
    return free_nodes;
}

/* Solves a patch of MacNeal and Harder's field times `scale`; checks that all displacements agree
 * with the field and that the stress is uniform; returns the stress and the plastic strain. */
static double patch_stress(const struct wb_material *material, enum wb_integration integration,
                           double scale, double stress[6])
{
    struct test_solid t;
    double H[3][3], first[20][6], plastic[20], p;
    for (int i = 0; i < 9; i++)
        H[i / 3][i % 3] = scale * 1e-3 * (i / 3 == i % 3 ? 1.0 : 0.5);
    patch_mesh(&t.mesh);
    test_solid_init(&t, material, integration);
    assert_int_equal(patch_hold(&t, (const double(*)[3])H), PATCH_NODES - 20);
    test_solid_create(&t);
    test_solid_go(&t, 0.5, 0.0);
    test_solid_go(&t, 1.0, 0.0);

    const double *u = wb_solid_displacement(t.solid);
    for (int n = 0; n < t.mesh.n_nodes; n++) {
        const double *x = t.mesh.node[n];
        for (int k = 0; k < 3; k++)
            assert_close(u[3 * n + k], H[k][0] * x[0] + H[k][1] * x[1] + H[k][2] * x[2],
                         1e-9 * 1e-3 * scale);
    }
    wb_solid_nodal_stress(t.solid, 0, first, plastic);
    memcpy(stress, first[0], sizeof first[0]);
    p = plastic[0];
    for (int e = 0; e < t.mesh.n_elements; e++) {
        wb_solid_nodal_stress(t.solid, e, first, plastic);
        for (int i = 0; i < 6 * 20; i++)
            assert_close(first[i / 6][i % 6], stress[i % 6], 1e-8 * stress[0]);
        for (int a = 0; a < 20; a++)
            assert_close(plastic[a], p, 1e-8 * p);
    }
    test_solid_release(&t);
    return p;
}

static void patch_of_small_strain_is_exact(void **unused)
{
    (void)unused;
    const struct wb_material material = test_solid_elastic(1e6, 0.25);
    for (int integration = 0; integration < 2; integration++) {
        double s[6];
        (void)patch_stress(&material, test_solid_rules[integration], 1e-4, s);
        print_message("patch, %s: sigma %.6f, tau %.6f\n", test_solid_rule_names[integration],
                      1e4 * s[0], 1e4 * s[3]);
        for (int k = 0; k < 6; k++)
            assert_close_relative(1e4 * s[k], k < 3 ? 2000.0 : 400.0, 1e-6);
    }
}

/* H has the eigenvalues 2 and 1/2 (twice), times the scale, the former along (1, 1, 1). */
static void patch_of_large_strain_is_exact(void **unused)
{
    (void)unused;
    const struct wb_material material = test_solid_elastic(1e6, 0.25);
    const double G = 1e6 / 2.5, K = 1e6 / 1.5, scale = 200.0;
    const double along = log(1.0 + 2e-3 * scale), across = log(1.0 + 0.5e-3 * scale);
    const double volume = along + 2.0 * across;
    const double pressure = K * volume, deviator = 2.0 * G * (along - volume / 3.0);
    for (int integration = 0; integration < 2; integration++) {
        double s[6];
        (void)patch_stress(&material, test_solid_rules[integration], scale, s);
        for (int k = 0; k < 6; k++) {
            /* Deviator along n n^T, and minus half of it perpendicular to it. */
            const double expected = k < 3 ? pressure : deviator * 1.5 / 3.0;
            assert_close_relative(s[k], expected / exp(volume), 1e-9);
        }
    }
}

static void patch_that_yields_is_exact(void **unused)
{
    (void)unused;
    static const struct wb_material materials[2] = {
        {WB_HARDENING_ISOTROPIC_POWER, 68.2e9, 0.34, 182e6, 300e6, 0.5},
        {WB_HARDENING_KINEMATIC_LINEAR, 68.2e9, 0.34, 182e6, 900e6, 1.0},
    };
    const double scale = 50.0;
    const double along = log(1.0 + 2e-3 * scale), across = log(1.0 + 0.5e-3 * scale);
    const double J = exp(along + 2.0 * across), equivalent = 2.0 / 3.0 * (along - across);
    for (int k = 0; k < 4; k++) {
        const struct wb_material *m = &materials[k / 2];
        double s[6];
        const double p = patch_stress(m, test_solid_rules[k % 2], scale, s);
        const double G = m->youngs_modulus / (2.0 + 2.0 * m->poissons_ratio);
        const double yield =
            m->yield_stress + m->strength_coefficient * pow(p, m->hardening_exponent);
        /* The elastic part of the equivalent strain gives the stress; its deviator is proportional
         * to n n^T - I / 3, n = (1, 1, 1) / sqrt 3. */
        assert_close_relative(3.0 * G * (equivalent - p), yield, 1e-9);
        assert_close_relative(3.0 * J * s[3], yield, 1e-9);
    }
}

/* ---- Beams of MacNeal and Harder 1985 ---- */

struct beam {
    const char *name;
    double E, nu;
    void (*map)(void *, const double *, double *);
    double tilt[2]; /* m: shift of even and odd mesh lines of the straight beam at its bottom */
    double area;
    double load[3]; /* N, small enough to keep the problem linear */
    double reference;
    int n[3];
    double allowed[2]; /* selective, reduced: allowed relative deviation from the reference */
};

/* Displacement of the loads' points along the load, over the load. */
static double beam_answer(const struct beam *beam, enum wb_integration integration)
{
    const struct wb_material material = test_solid_elastic(beam->E, beam->nu);
    struct test_solid_pull pull = {{beam->load[0], beam->load[1], beam->load[2]}, beam->area};
    struct test_solid t;
    test_solid_block(&t, beam->n, beam->map, (void *)beam);
    test_solid_init(&t, &material, integration);
    test_solid_clamp(&t);
    test_solid_load_end(&t, true, test_solid_pull, &pull, t.force);
    test_solid_create(&t);
    test_solid_go(&t, 0.0, 1.0);
    const double size = test_solid_length(beam->load);
    const double answer = test_solid_compliance(&t) / (size * size);
    test_solid_release(&t);
    return answer;
}

/* 6 x 0.2 x 0.1; inner mesh lines may be tilted. */
static void straight_map(void *context, const double unit[3], double at[3])
{
    const struct beam *beam = context;
    const double line = unit[0] * beam->n[0], w = line - floor(line);
    const int before = (int)floor(line);
    double shift[2];
    for (int k = 0; k < 2; k++)
        shift[k] = before + k > 0 && before + k < beam->n[0] ? beam->tilt[(before + k) % 2] : 0.0;
    at[0] = 6.0 * unit[0] + (1.0 - 2.0 * unit[1]) * ((1.0 - w) * shift[0] + w * shift[1]);
    at[1] = 0.2 * unit[1];
    at[2] = 0.1 * unit[2];
}

/* A quarter of a ring with radii 4.12 and 4.32, thickness 0.1. */
static void curved_map(void *context, const double unit[3], double at[3])
{
    const double r = 4.12 + 0.2 * unit[1], angle = 0.5 * M_PI * unit[0];
    (void)context;
    at[0] = r * sin(angle);
    at[1] = r * cos(angle);
    at[2] = 0.1 * unit[2];
}

/* 12 x 1.1 x 0.32, twisted by 90 degrees. */
static void twisted_map(void *context, const double unit[3], double at[3])
{
    const double angle = 0.5 * M_PI * unit[0];
    const double b = 1.1 * (unit[1] - 0.5), h = 0.32 * (unit[2] - 0.5);
    (void)context;
    at[0] = 12.0 * unit[0];
    at[1] = b * cos(angle) - h * sin(angle);
    at[2] = b * sin(angle) + h * cos(angle);
}

static void check_beam(const struct beam *beam)
{
    for (int integration = 0; integration < 2; integration++) {
        /* With reduced integration a column one element wide has modes without energy. */
        struct beam own = *beam;
        own.n[1] += integration == 1 && own.n[1] == 1;
        const double answer = beam_answer(&own, test_solid_rules[integration]);
        print_message("%s, %d x %d x %d, %s: %.6g, %.4f of %.6g\n", own.name, own.n[0], own.n[1],
                      own.n[2], test_solid_rule_names[integration], answer, answer / own.reference,
                      own.reference);
        assert_close_relative(answer, own.reference, own.allowed[integration]);
    }
}

#define STRAIGHT 1e7, 0.3, straight_map
#define REGULAR {0.0, 0.0}, 0.02
#define TRAPEZOIDS {0.1, -0.1}, 0.02
#define PARALLELOGRAMS {0.1, 0.1}, 0.02
#define CURVED 1e7, 0.25, curved_map, {0.0, 0.0}, 0.02
#define TWISTED 29e6, 0.22, twisted_map, {0.0, 0.0}, 0.352
#define ALONG                                                                                      \
    {                                                                                              \
        1e-2, 0.0, 0.0                                                                             \
    }
#define UP                                                                                         \
    {                                                                                              \
        0.0, 1e-2, 0.0                                                                             \
    }
#define ASIDE                                                                                      \
    {                                                                                              \
        0.0, 0.0, 1e-2                                                                             \
    }

/* The accuracy of these meshes: the same elements fully integrated reach 0.97, 0.89 and 0.97 in
 * plane and 0.96, 0.92 and 0.94 out of plane. */
static void straight_beams_of_six_elements_agree_with_the_reference(void **unused)
{
    (void)unused;
    static const struct beam beams[] = {
        {"regular, extension", STRAIGHT, REGULAR, ALONG, 3e-5, {6, 1, 1}, {.003, .001}},
        {"regular, in plane", STRAIGHT, REGULAR, UP, .1081, {6, 1, 1}, {.027, .007}},
        {"regular, out of plane", STRAIGHT, REGULAR, ASIDE, .4321, {6, 1, 1}, {.04, .022}},
        {"trapezoids, extension", STRAIGHT, TRAPEZOIDS, ALONG, 3e-5, {6, 1, 1}, {.003, .001}},
        {"trapezoids, in plane", STRAIGHT, TRAPEZOIDS, UP, .1081, {6, 1, 1}, {.075, .015}},
        {"trapezoids, out of plane", STRAIGHT, TRAPEZOIDS, ASIDE, .4321, {6, 1, 1}, {.08, .026}},
        {"parallelograms, extension",
         STRAIGHT,
         PARALLELOGRAMS,
         ALONG,
         3e-5,
         {6, 1, 1},
         {.003, .001}},
        {"parallelograms, in plane", STRAIGHT, PARALLELOGRAMS, UP, .1081, {6, 1, 1}, {.023, .005}},
        {"parallelograms, out of plane",
         STRAIGHT,
         PARALLELOGRAMS,
         ASIDE,
         .4321,
         {6, 1, 1},
         {.06, .03}},
    };
    for (size_t k = 0; k < sizeof beams / sizeof beams[0]; k++)
        check_beam(&beams[k]);
}

static void finer_straight_beams_approach_the_reference(void **unused)
{
    (void)unused;
    static const struct beam beams[] = {
        {"regular, in plane", STRAIGHT, REGULAR, UP, .1081, {24, 2, 2}, {.004, .004}},
        {"regular, out of plane", STRAIGHT, REGULAR, ASIDE, .4321, {24, 2, 2}, {.006, .006}},
    };
    for (size_t k = 0; k < sizeof beams / sizeof beams[0]; k++)
        check_beam(&beams[k]);
}

/* The in-plane reference, 0.08734, is 1.4 % below the exact solution in plane stress, pi P (a^2 +
 * b^2) / (E t ((a^2 - b^2) + (a^2 + b^2) ln(b/a))) = 0.088566 (Timoshenko and Goodier). Out of
 * plane the limit is 1 % below the reference: the clamp prevents warping of the section, which
 * shortens the beam by an effective 0.04 where the torque is largest; beam theory neglects this. */
static void curved_beams_agree_with_the_reference(void **unused)
{
    (void)unused;
    static const struct beam beams[] = {
        {"curved, in plane", CURVED, ALONG, .08734, {6, 1, 1}, {.035, .015}},
        {"curved, out of plane", CURVED, ASIDE, .5022, {6, 1, 1}, {.08, .04}},
        {"curved, in plane", CURVED, ALONG, .088566, {24, 2, 2}, {.003, .003}},
        {"curved, out of plane", CURVED, ASIDE, .5022, {24, 4, 4}, {.012, .012}},
    };
    for (size_t k = 0; k < sizeof beams / sizeof beams[0]; k++)
        check_beam(&beams[k]);
}

static void twisted_beams_agree_with_the_reference(void **unused)
{
    (void)unused;
    static const struct beam beams[] = {
        {"twisted, in plane", TWISTED, ASIDE, .005424, {12, 2, 1}, {.01, .007}},
        {"twisted, out of plane", TWISTED, UP, .001754, {12, 2, 1}, {.004, .002}},
        {"twisted, in plane", TWISTED, ASIDE, .005424, {24, 4, 2}, {.002, .002}},
        {"twisted, out of plane", TWISTED, UP, .001754, {24, 4, 2}, {.001, .001}},
    };
    for (size_t k = 0; k < sizeof beams / sizeof beams[0]; k++)
        check_beam(&beams[k]);
}

/* Saint-Venant's torsion of the straight beam: ends turned, free to warp. Torsion constant. */
static double torsion_constant(const int n[3], enum wb_integration integration)
{
    const struct wb_material material = test_solid_elastic(1e7, 0.3);
    const struct beam beam = {"", STRAIGHT, REGULAR, ALONG, 0.0, {n[0], n[1], n[2]}, {0.0, 0.0}};
    const double angle = 1e-4, G = 1e7 / 2.6;
    struct test_solid t;
    int begin, end;
    test_solid_block(&t, n, straight_map, (void *)&beam);
    test_solid_init(&t, &material, integration);
    for (int last = 0; last < 2; last++) {
        test_solid_end(&t, last, &begin, &end);
        for (int i = begin; i < end; i++) {
            const double y = t.mesh.node[i][1] - 0.1, z = t.mesh.node[i][2] - 0.05;
            test_solid_hold(&t, i, 1, last ? -angle * z : 0.0);
            test_solid_hold(&t, i, 2, last ? angle * y : 0.0);
            if (!last && fabs(y) < 1e-9 && fabs(z) > 0.049)
                test_solid_hold(&t, i, 0, 0.0); /* on an axis of symmetry, where nothing warps */
        }
    }
    test_solid_create(&t);
    test_solid_go(&t, 1.0, 0.0);
    const double *force = wb_solid_internal_force(t.solid);
    double torque = 0.0;
    for (int i = begin; i < end; i++)
        torque += (t.mesh.node[i][1] - 0.1) * force[3 * i + 2] -
                  (t.mesh.node[i][2] - 0.05) * force[3 * i + 1];
    test_solid_release(&t);
    return torque * 6.0 / (G * angle);
}

static double saint_venant(void)
{
    double constant = 1.0 / 3.0;
    for (int k = 1; k < 200; k += 2)
        constant -= 64.0 / pow(M_PI, 5) * 0.5 * tanh(k * M_PI) / pow(k, 5);
    return constant * 0.2 * 1e-3;
}

static void torsion_converges_to_saint_venant(void **unused)
{
    (void)unused;
    const double exact = saint_venant();
    for (int integration = 0; integration < 2; integration++) {
        double error[3];
        for (int k = 0; k < 3; k++) {
            const int n[3] = {2, 2 << k, 1 << k};
            const double found = torsion_constant(n, test_solid_rules[integration]);
            print_message("torsion constant, %d x %d, %s: %.6g, %.4f of %.6g\n", n[1], n[2],
                          test_solid_rule_names[integration], found, found / exact, exact);
            error[k] = found / exact - 1.0;
        }
        assert_true(error[2] > 0.0 && error[2] < 5e-4);
        assert_true(log2(error[0] / error[1]) > 3.4 && log2(error[1] / error[2]) > 3.4);
    }
}

/* Shear traction that twists the end of the straight beam about its axis. */
static void twist(void *context, const double at[3], const double normal[3], double force[3])
{
    const double per_moment = *(const double *)context;
    force[0] = 0.0;
    force[1] = -per_moment * (at[2] - 0.05) * normal[0];
    force[2] = per_moment * (at[1] - 0.1) * normal[0];
}

/* The reference, 0.03208, is 6 % below Saint-Venant's 6 / (G J) = 0.03411, which a clamp that
 * prevents warping reduces by an effective 0.04 of the length. */
static void straight_beams_twist_nearly_as_in_saint_venants_theory(void **unused)
{
    (void)unused;
    const double exact = 6.0 / (1e7 / 2.6 * saint_venant());
    const double moment = 1e-2, polar = 0.2 * 0.1 * (0.04 + 0.01) / 12.0;
    for (int k = 0; k < 2; k++) {
        static const int meshes[2][3] = {{6, 1, 1}, {24, 4, 2}};
        static const double allowed[2] = {0.15, 0.015};
        const int *n = meshes[k];
        const struct beam beam = {"",  STRAIGHT,           REGULAR,   ALONG,
                                  0.0, {n[0], n[1], n[2]}, {0.0, 0.0}};
        const struct wb_material material = test_solid_elastic(1e7, 0.3);
        double per_moment = moment / polar;
        struct test_solid t;
        test_solid_block(&t, n, straight_map, (void *)&beam);
        test_solid_init(&t, &material, WB_INTEGRATION_SELECTIVE);
        test_solid_clamp(&t);
        test_solid_load_end(&t, true, twist, &per_moment, t.force);
        test_solid_create(&t);
        test_solid_go(&t, 0.0, 1.0);
        const double answer = test_solid_compliance(&t) / (moment * moment);
        print_message("twist, %d x %d x %d, selective: %.6g, %.4f of 0.03208, %.4f of %.6g\n", n[0],
                      n[1], n[2], answer, answer / 0.03208, answer / exact, exact);
        assert_close_relative(answer, exact, allowed[k]);
        test_solid_release(&t);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(patch_of_small_strain_is_exact),
        cmocka_unit_test(patch_of_large_strain_is_exact),
        cmocka_unit_test(patch_that_yields_is_exact),
        cmocka_unit_test(straight_beams_of_six_elements_agree_with_the_reference),
        cmocka_unit_test(finer_straight_beams_approach_the_reference),
        cmocka_unit_test(curved_beams_agree_with_the_reference),
        cmocka_unit_test(twisted_beams_agree_with_the_reference),
        cmocka_unit_test(torsion_converges_to_saint_venant),
        cmocka_unit_test(straight_beams_twist_nearly_as_in_saint_venants_theory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
