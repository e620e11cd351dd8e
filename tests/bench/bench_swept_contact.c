/* CPU time of contact between the wires of a bundle on one core: ns per contact point (a station of
 * a pair of neighbours) and step, for each pass and instruction set, of straight bundles and of
 * bent bundles whose wires have slipped. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "fe/model/packing.h"
#include "fe/swept/swept_contact.h"
#include "fe/swept/swept_private.h"
#include "tests/bench/clock.h"

enum {
    MOST_WIRES = 32,
    MOST_SURFACE = 32,
    ROUNDS = 100
};

struct problem {
    const char *title;
    int n_wires, n_surface, n_elements;
    enum wb_packing_lattice lattice;
    double angle; /* rad, to which the bundle is bent */
    int steps;
};

struct bundle {
    struct wb_swept_layout layout;
    struct wb_packing packing;
    int surface[MOST_SURFACE];
    double node[MOST_SURFACE][2];
    double *position[2][MOST_WIRES]; /* of even and odd steps */
    void *force[MOST_WIRES];
};

struct timing {
    double all, gather, press, scatter; /* s, least of the rounds */
    double points;
    int pairs;
};

static const double wire_radius = 0.7e-3, length = 0.114;

/* Wires keep their lengths in a circular bend, so they slip. In odd steps all is bent a little
 * more. */
static void place_wire(const struct problem *problem, struct bundle *bundle, int w)
{
    const struct wb_packing_circle *at = &bundle->packing.wire[w];

    for (int odd = 0; odd < 2; odd++) {
        const double angle = problem->angle + 1e-6 * odd;
        for (int k = 0; k < problem->n_surface; k++) {
            for (int j = 0; j < bundle->layout.n_stations; j++) {
                double *x = bundle->position[odd][w] + (ptrdiff_t)3 * k * bundle->layout.stride + j;
                const double s = length * j / problem->n_elements;
                const double R = length / angle - 0.998 * at->y, turn = s / R;
                const double y = 0.998 * at->y + bundle->node[k][0];
                x[0] = (length / angle - y) * sin(turn);
                x[bundle->layout.stride] = length / angle - (length / angle - y) * cos(turn);
                x[2 * bundle->layout.stride] = 0.998 * at->z + bundle->node[k][1];
            }
        }
    }
}

static bool make_bundle(const struct problem *problem, struct bundle *bundle)
{
    double diameter[MOST_WIRES];

    bundle->layout = wb_swept_layout(problem->n_surface, problem->n_elements + 1);
    for (int w = 0; w < problem->n_wires; w++)
        diameter[w] = 2.0 * wire_radius;
    if (wb_packing_on_lattice(&bundle->packing, problem->n_wires, diameter, problem->lattice) !=
        WB_OK)
        return false;
    for (int k = 0; k < problem->n_surface; k++) {
        bundle->surface[k] = k;
        bundle->node[k][0] = wire_radius * cos(2.0 * M_PI * k / problem->n_surface);
        bundle->node[k][1] = wire_radius * sin(2.0 * M_PI * k / problem->n_surface);
    }
    for (int w = 0; w < problem->n_wires; w++) {
        const size_t size = wb_swept_size(&bundle->layout);
        for (int odd = 0; odd < 2; odd++)
            bundle->position[odd][w] = wb_swept_allocate(size, sizeof(double));
        bundle->force[w] = wb_swept_allocate(size, sizeof(float));
        place_wire(problem, bundle, w);
    }
    return true;
}

static void release_bundle(struct bundle *bundle)
{
    for (int w = 0; w < MOST_WIRES; w++) {
        free(bundle->position[0][w]);
        free(bundle->position[1][w]);
        free(bundle->force[w]);
    }
}

static void keep_least(double *least, double start)
{
    const double spent = cpu_seconds() - start;
    if (*least == 0.0 || spent < *least)
        *least = spent;
}

/* One round: whole steps, then each pass by itself. */
static bool run_round(const struct problem *problem, struct bundle *bundle,
                      struct wb_swept_contact *contact, struct timing *t)
{
    const int blocks = wb_swept_contact_blocks(contact);
    const double time_step = 1e-6;
    struct wb_swept_contact_energies energies = {0};

    double start = cpu_seconds();
    for (int step = 0; step < problem->steps; step++) {
        if (wb_swept_contact_add_forces(contact, (const double *const *)bundle->position[step % 2],
                                        bundle->force, time_step, &energies) != WB_OK)
            return false;
    }
    keep_least(&t->all, start);
    start = cpu_seconds();
    for (int step = 0; step < problem->steps; step++)
        wb_swept_contact_gather(contact, (const double *const *)bundle->position[step % 2], 0,
                                blocks);
    keep_least(&t->gather, start);
    start = cpu_seconds();
    for (int step = 0; step < problem->steps; step++)
        wb_swept_contact_press(contact, time_step, 0, blocks);
    keep_least(&t->press, start);
    start = cpu_seconds();
    for (int step = 0; step < problem->steps; step++)
        wb_swept_contact_scatter(contact, bundle->force, 0, blocks);
    keep_least(&t->scatter, start);
    t->pairs = wb_swept_contact_pairs(contact);
    t->points = (double)problem->steps * t->pairs * bundle->layout.n_stations;
    return energies.normal > 0.0;
}

static bool time_problem(const struct problem *problem, enum wb_swept_instructions set)
{
    struct bundle bundle = {0};
    struct wb_swept_contact_settings settings;
    struct wb_swept_wire wires[MOST_WIRES];
    struct wb_swept_contact *contact = NULL;
    struct timing t = {0};

    wb_swept_contact_default_settings(&settings);
    settings.instructions = set;
    settings.friction.mu_kinetic = 0.1;
    settings.friction.decay = 2000.0;
    bool good = make_bundle(problem, &bundle);
    for (int w = 0; w < problem->n_wires; w++)
        wires[w] = (struct wb_swept_wire){.n_nodes = problem->n_surface,
                                          .n_surface = problem->n_surface,
                                          .surface = bundle.surface,
                                          .node = (const double(*)[2])bundle.node,
                                          .radius = wire_radius,
                                          .youngs_modulus = 4.5e9};
    good = good &&
           wb_swept_contact_create(&contact, &settings, problem->n_wires, wires,
                                   bundle.layout.n_stations, length / problem->n_elements) == WB_OK;
    for (int round = 0; good && round < ROUNDS; round++)
        good = run_round(problem, &bundle, contact, &t);
    if (good) {
        const double ns = 1e9 / t.points;
        printf("  %-8s  %3d pairs: %5.2f ns a point and step (gather %.2f, press %.2f, scatter "
               "%.2f, the rest %.2f)\n",
               wb_swept_contact_instructions(contact), t.pairs, ns * t.all, ns * t.gather,
               ns * t.press, ns * t.scatter, ns * (t.all - t.gather - t.press - t.scatter));
    }
    wb_swept_contact_destroy(contact);
    release_bundle(&bundle);
    return good;
}

int main(void)
{
    const struct problem problems[] = {
        {"7 wires of 12 elements a section, 80 along, straight", 7, 8, 80, WB_PACKING_HEXAGON, 1e-3,
         100},
        {"the same bent by 60 degrees", 7, 8, 80, WB_PACKING_HEXAGON, 1.05, 100},
        {"7 wires of 84 elements a section, 384 along, bent by 60 degrees", 7, 24, 384,
         WB_PACKING_HEXAGON, 1.05, 20},
        {"27 wires of 12 elements a section, 80 along, bent by 60 degrees", 27, 8, 80,
         WB_PACKING_TRIANGLE, 1.05, 20},
    };
    printf("contact between wires, one core, CPU ns\n");
    for (size_t i = 0; i < sizeof problems / sizeof problems[0]; i++) {
        printf("%s\n", problems[i].title);
        for (int set = WB_SWEPT_BASELINE; set <= WB_SWEPT_AVX512; set++) {
            if (!time_problem(&problems[i], (enum wb_swept_instructions)set) && set == 1) {
                fprintf(stderr, "%s: failed\n", problems[i].title);
                return EXIT_FAILURE;
            }
        }
    }
    printf("goal: 9 ns with AVX-512\n");
    return EXIT_SUCCESS;
}
