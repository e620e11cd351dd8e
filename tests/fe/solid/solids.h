/* Bodies of 20-node hexahedra with supports and tractions, for the tests of fe/solid/solid.h. */
#ifndef WB_TESTS_FE_SOLID_SOLIDS_H
#define WB_TESTS_FE_SOLID_SOLIDS_H

#include <stdlib.h>

#include "fe/solid/solid.h"
#include "tests/check.h"
#include "tests/fe/solid/block_mesh.h"

static const enum wb_integration test_solid_rules[2] = {WB_INTEGRATION_SELECTIVE,
                                                        WB_INTEGRATION_REDUCED};
static const char *const test_solid_rule_names[2] = {"selective", "reduced"};

static inline struct wb_material test_solid_elastic(double E, double nu)
{
    return (struct wb_material){WB_HARDENING_NONE_ELASTIC, E, nu, 0.0, 0.0, 0.0};
}

struct test_solid {
    struct wb_solid_mesh mesh;
    struct wb_solid_part part;
    enum wb_integration integration;
    struct wb_solid_settings settings;
    int n_supports;
    struct wb_solid_support *supports;
    double (*force)[3];
    struct wb_solid *solid;
    struct wb_solid_point point; /* of the last move */
};

/* Takes over t->mesh. */
static inline void test_solid_init(struct test_solid *t, const struct wb_material *material,
                                   enum wb_integration integration)
{
    t->part = (struct wb_solid_part){*material, 0.0};
    t->integration = integration;
    t->settings = (struct wb_solid_settings){.force_tolerance = 1e-7};
    t->n_supports = 0;
    t->supports = calloc(3 * (size_t)t->mesh.n_nodes, sizeof *t->supports);
    t->force = calloc((size_t)t->mesh.n_nodes, sizeof *t->force);
    t->solid = NULL;
    assert_true(t->supports && t->force);
}

static inline void test_solid_block(struct test_solid *t, const int n[3],
                                    void (*map)(void *, const double *, double *), void *context)
{
    test_block_mesh(&t->mesh, n[0], n[1], n[2], map, context);
}

static inline void test_solid_release(struct test_solid *t)
{
    wb_solid_destroy(t->solid);
    wb_solid_mesh_release(&t->mesh);
    free(t->supports);
    free(t->force);
}

static inline void test_solid_hold(struct test_solid *t, int node, int axis, double displacement)
{
    t->supports[t->n_supports++] = (struct wb_solid_support){node, axis, displacement};
}

/* Nodes of the first or last section of a block; writes where they begin and end. */
static inline void test_solid_end(const struct test_solid *t, bool last, int *begin, int *end)
{
    const int l = last ? t->mesh.n_layers - 1 : 0;
    *begin = t->mesh.link[l];
    *end = t->mesh.layer[l + 1];
}

static inline void test_solid_clamp(struct test_solid *t)
{
    int begin, end;
    test_solid_end(t, false, &begin, &end);
    for (int i = begin; i < end; i++) {
        for (int axis = 0; axis < 3; axis++)
            test_solid_hold(t, i, axis, 0.0);
    }
}

static inline int test_solid_node_at(const struct wb_solid_mesh *mesh, double x, double y, double z)
{
    for (int i = 0; i < mesh->n_nodes; i++) {
        const double *at = mesh->node[i];
        if (fabs(at[0] - x) + fabs(at[1] - y) + fabs(at[2] - z) < 1e-9)
            return i;
    }
    fail_msg("no node at (%g, %g, %g)", x, y, z);
    return -1;
}

/* The eight functions of a face and their slopes. */
static inline void test_solid_face_shape(double s, double t, double N[8], double slope[2][8])
{
    static const double at[8][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1},
                                    {0, -1},  {1, 0},  {0, 1}, {-1, 0}};
    for (int a = 0; a < 8; a++) {
        const double p = at[a][0], q = at[a][1];
        if (a < 4) {
            N[a] = 0.25 * (1.0 + s * p) * (1.0 + t * q) * (s * p + t * q - 1.0);
            slope[0][a] = 0.25 * p * (1.0 + t * q) * (2.0 * s * p + t * q);
            slope[1][a] = 0.25 * q * (1.0 + s * p) * (2.0 * t * q + s * p);
        } else if (p == 0.0) {
            N[a] = 0.5 * (1.0 - s * s) * (1.0 + t * q);
            slope[0][a] = -s * (1.0 + t * q);
            slope[1][a] = 0.5 * (1.0 - s * s) * q;
        } else {
            N[a] = 0.5 * (1.0 - t * t) * (1.0 + s * p);
            slope[0][a] = 0.5 * (1.0 - t * t) * p;
            slope[1][a] = -t * (1.0 + s * p);
        }
    }
}

/* Adds consistent nodal forces of a traction on an end of a block: traction(context, position,
 * area-weighted outward normal, force per area times area). */
static inline void test_solid_load_end(struct test_solid *t, bool last,
                                       void (*traction)(void *context, const double at[3],
                                                        const double normal[3], double force[3]),
                                       void *context, double (*into)[3])
{
    static const int sides[2][8] = {{0, 3, 2, 1, 11, 10, 9, 8}, {4, 5, 6, 7, 12, 13, 14, 15}};
    static const double place[3] = {-0.7745966692414834, 0.0, 0.7745966692414834};
    static const double weight[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
    const struct wb_solid_mesh *mesh = &t->mesh;
    const int in_slice = mesh->n_elements / (mesh->n_layers - 1);
    const int first = last ? mesh->n_elements - in_slice : 0;

    for (int i = 0; i < 9 * in_slice; i++) {
        const int *element = mesh->element[first + i / 9];
        double N[8], slope[2][8], at[3] = {0.0}, T[2][3] = {{0.0}}, normal[3], force[3];
        test_solid_face_shape(place[i % 3], place[i / 3 % 3], N, slope);
        for (int a = 0; a < 8; a++) {
            for (int k = 0; k < 3; k++) {
                const double x = mesh->node[element[sides[last][a]]][k];
                at[k] += N[a] * x;
                T[0][k] += slope[0][a] * x;
                T[1][k] += slope[1][a] * x;
            }
        }
        for (int k = 0; k < 3; k++)
            normal[k] =
                weight[i % 3] * weight[i / 3 % 3] *
                (T[0][(k + 1) % 3] * T[1][(k + 2) % 3] - T[0][(k + 2) % 3] * T[1][(k + 1) % 3]);
        traction(context, at, normal, force);
        for (int a = 0; a < 8; a++) {
            for (int k = 0; k < 3; k++)
                into[element[sides[last][a]]][k] += N[a] * force[k];
        }
    }
}

static inline double test_solid_length(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Uniform traction whose resultant over `area` is `force`. */
struct test_solid_pull {
    double force[3], area;
};

static inline void test_solid_pull(void *context, const double at[3], const double normal[3],
                                   double force[3])
{
    const struct test_solid_pull *pull = context;
    (void)at;
    for (int k = 0; k < 3; k++)
        force[k] = pull->force[k] / pull->area * test_solid_length(normal);
}

static inline void test_solid_create(struct test_solid *t)
{
    const struct wb_solid_model model = {
        .mesh = &t->mesh,
        .parts = &t->part,
        .integration = t->integration,
        .n_supports = t->n_supports,
        .supports = t->supports,
        .nodal_force = (const double(*)[3])t->force,
    };
    assert_int_equal(wb_solid_create(&t->solid, &model, &t->settings), WB_OK);
}

/* Moves to the factors; false if it did not converge. */
static inline bool test_solid_try(struct test_solid *t, double supports, double nodal)
{
    const struct wb_solid_move move = {.control = WB_SOLID_LOADS,
                                       .target = {.supports = supports, .nodal = nodal}};
    assert_int_equal(wb_solid_move(t->solid, &move, &t->point), WB_OK);
    return t->point.end == WB_SOLID_CONVERGED;
}

static inline void test_solid_go(struct test_solid *t, double supports, double nodal)
{
    if (!test_solid_try(t, supports, nodal))
        fail_msg("%s", t->point.problem);
}

/* Work of the nodal forces at factor 1 on the current displacements. */
static inline double test_solid_compliance(const struct test_solid *t)
{
    const double *u = wb_solid_displacement(t->solid);
    double sum = 0.0;
    for (int i = 0; i < 3 * t->mesh.n_nodes; i++)
        sum += t->force[i / 3][i % 3] * u[i];
    return sum;
}

#endif
