/* A real winding, half-lapped, each layer bonded to the one below, compared with the sleeve of both
 * layers. */
#include "fe/swept/swept_cohesion.h"
#include "tests/fe/swept/adhesive.h"
#include "tests/fe/swept/tapes.h"

enum {
    TURN = 16, /* nodes */
    RING = 2 * TURN + 1,
    ALONG = 38
};

static const double E = 119e6, layer = 0.1e-3, radius = 2.3e-3, advance = 9.5e-3, spacing = 0.5e-3;

struct helix {
    struct test_tape tape;
    struct wb_swept_cohesion *cohesion; /* NULL: windings slide freely */
};

/* Two turns at any station, the second one thickness farther out; radius is the mean of both. */
static struct helix helix_create(const struct wb_swept_cohesion_settings *bonded)
{
    struct wb_swept_tape_model model = tape_model(&elastic_tape, RING, ALONG + 1, false, spacing);
    struct wb_swept_cohesion_bond bond[RING * (ALONG + 1)];
    struct helix h = {.cohesion = NULL};
    model.thickness = layer;
    for (int k = 0; k < RING; k++) {
        for (int j = 0; j <= ALONG; j++) {
            const double angle = 2.0 * M_PI * (k / (double)TURN + j * spacing / advance);
            const double r = radius + layer * (k - TURN) / TURN;
            tape_put(&model.layout, model.position, k, j, spacing * j, r * sin(angle),
                     r * cos(angle));
            bond[k * (ALONG + 1) + j] = (struct wb_swept_cohesion_bond){
                k > TURN ? WB_SWEPT_COHESION_TAPE : WB_SWEPT_COHESION_FREE, 1.0};
        }
    }
    h.tape = test_tape_create(&model);
    if (bonded)
        assert_int_equal(wb_swept_cohesion_create(&h.cohesion, h.tape.tape, bonded, 0, NULL, bond),
                         WB_OK);
    return h;
}

static void helix_destroy(struct helix *h)
{
    wb_swept_cohesion_destroy(h->cohesion);
    test_tape_destroy(&h->tape);
}

static void forces(struct helix *h)
{
    const struct wb_swept_cohesion_fields fields = {
        {h->tape.position, h->tape.director, h->tape.force, h->tape.moment}, NULL, NULL};
    struct wb_swept_cohesion_sums sums = {0};
    (void)tape_forces(&h->tape);
    if (h->cohesion)
        wb_swept_cohesion_add_forces(h->cohesion, &fields, 0, wb_swept_tape_blocks(h->tape.tape),
                                     &sums);
}

static double advance_field(const struct helix *h, const double *mass, const void *force, bool held,
                            double kick, double dt, double *x, double *v)
{
    const struct wb_swept_layout *l = &h->tape.layout;
    double kinetic = 0.0;
    for (int k = 0; k < RING; k++) {
        for (int j = 0; j <= ALONG; j++) {
            const bool is_end = j == 0 || j == ALONG;
            const double m = mass[k] * spacing * (is_end ? 0.5 : 1.0);
            for (int i = 0; i < 3; i++) {
                const size_t at = swept_at(l, k, i, j);
                if (held && is_end)
                    continue;
                v[at] += kick * tape_load(&h->tape, force, k, i, j) / m;
                x[at] += dt * v[at];
                kinetic += 0.5 * m * v[at] * v[at];
            }
        }
    }
    return kinetic;
}

/* As in test_swept_tape_problems.c; the ends are fixed. */
static void relax(struct helix *h, int steps)
{
    const size_t size = wb_swept_size(&h->tape.layout);
    double mass[RING], inertia[RING], bound = 0.0, before = 0.0;
    double *v = calloc(2 * size, sizeof *v);
    bool at_rest = true;
    assert_non_null(v);
    wb_swept_tape_masses(h->tape.tape, mass, inertia);
    assert_int_equal(wb_swept_tape_stiffness_per_mass(h->tape.tape, &bound), WB_OK);
    if (h->cohesion) {
        double here[RING], turning[RING];
        for (int k = 0; k < RING; k++) {
            here[k] = mass[k] * spacing;
            turning[k] = inertia[k] * spacing;
        }
        bound += wb_swept_cohesion_tape_stiffness_per_mass(h->cohesion, here, turning);
    }
    const double dt = 0.5 * 2.0 / sqrt(bound);
    for (int i = 0; i < steps; i++) {
        const double kick = at_rest ? 0.5 * dt : dt;
        forces(h);
        const double kinetic =
            advance_field(h, mass, h->tape.force, true, kick, dt, h->tape.position, v) +
            advance_field(h, inertia, h->tape.moment, false, kick, dt, h->tape.director, v + size);
        at_rest = kinetic < before;
        if (at_rest)
            memset(v, 0, 2 * size * sizeof *v);
        before = at_rest ? 0.0 : kinetic;
    }
    forces(h);
    free(v);
}

/* Force for a stretch over that of the sleeve of two layers, with the ends fixed as plane
 * sections. */
static double stiffness(const struct wb_swept_cohesion_settings *bonded)
{
    const double strain = 1e-4, nu = 0.3;
    struct helix h = helix_create(bonded);
    for (int k = 0; k < RING; k++) {
        for (int j = 0; j <= ALONG; j++) {
            double x[3];
            tape_get(&h.tape.layout, h.tape.position, k, j, x);
            tape_put(&h.tape.layout, h.tape.position, k, j, x[0] * (1.0 + strain),
                     x[1] * (1.0 - nu * strain), x[2] * (1.0 - nu * strain));
        }
    }
    relax(&h, 6000);
    double force = 0.0, other = 0.0;
    for (int k = 0; k < RING; k++) {
        force -= tape_load(&h.tape, h.tape.force, k, 0, ALONG);
        other += tape_load(&h.tape, h.tape.force, k, 0, 0);
    }
    assert_close_relative(other, force, 0.02); /* at rest */
    helix_destroy(&h);
    const double polygon = TURN / M_PI * sin(M_PI / TURN);
    return force / (E * 2.0 * layer * 2.0 * M_PI * radius * polygon * strain);
}

/* Shear lag. Along the axis, at every `advance` one winding ends where the next but one begins, and
 * the one between carries the total load; the load is transferred within l = sqrt(E t / (2
 * K_ss)). */
static double lapped(double shear_stiffness)
{
    const double l = sqrt(E * layer / (2.0 * shear_stiffness));
    return 1.0 / (1.0 + 2.0 * l / advance * tanh(0.5 * advance / l));
}

static void bonded_windings_follow_shear_lag(void **unused)
{
    (void)unused;
    struct wb_swept_cohesion_settings settings;
    default_cohesion(&settings);
    const double usual = stiffness(&settings), usual_lag = lapped(settings.shear_stiffness);
    settings.normal_stiffness *= 0.03;
    settings.shear_stiffness *= 0.03;
    const double soft = stiffness(&settings), soft_lag = lapped(settings.shear_stiffness);
    const double free = stiffness(NULL);
    print_message("a half-lapped helix in tension over the sleeve of two layers: %.3f (shear lag "
                  "%.3f);\nwith 3 %% of the adhesive's stiffness %.3f (%.3f), not bonded %.3f\n",
                  usual, usual_lag, soft, soft_lag, free);
    /* The edges are oblique, and l is of the size of an element. */
    assert_close_relative(usual, usual_lag, 0.04);
    assert_close_relative(soft, soft_lag, 0.04);
    assert_true(free < 0.25);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bonded_windings_follow_shear_lag),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
