/* CPU time per shell element of the tape on one core: a closed sleeve of 32 x 80 elements, all
 * points elastic or all yielding, with and without time integration; and CPU time per node that is
 * bonded to a wire or in contact with one. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fe/swept/swept_cohesion.h"
#include "fe/swept/swept_step.h"
#include "fe/swept/swept_tape.h"
#include "fe/swept/swept_tape_contact.h"
#include "tests/bench/clock.h"
#include "tests/fe/swept/adhesive.h"

enum {
    NODES = 32,
    ALONG = 80,
    STEPS = 200,
    REPEATS = 15
};

static const double radius = 2.2e-3, spacing = 114e-3 / ALONG;

struct sleeve {
    struct wb_swept_layout layout;
    struct wb_swept_tape *tape;
    struct wb_swept_tape_state *state;
    struct wb_swept_step *step[2]; /* of positions, of directors */
    double *position, *director, *velocity, *turning;
    void *force, *moment;
};

static void destroy(struct sleeve *s)
{
    wb_swept_tape_state_destroy(s->state);
    wb_swept_tape_destroy(s->tape);
    for (int i = 0; i < 2; i++)
        wb_swept_step_destroy(s->step[i]);
    free(s->position);
    free(s->director);
    free(s->velocity);
    free(s->turning);
    free(s->force);
    free(s->moment);
}

static enum wb_status make_steps(struct sleeve *s, bool is_double)
{
    double mass[2][NODES];

    wb_swept_tape_masses(s->tape, mass[0], mass[1]);
    for (int i = 0; i < 2; i++) {
        const struct wb_swept_step_model model = {.layout = s->layout,
                                                  .node_mass = mass[i],
                                                  .spacing = spacing,
                                                  .double_precision = is_double};
        WB_TRY(wb_swept_step_create(&s->step[i], &model));
    }
    return WB_OK;
}

static enum wb_status create(struct sleeve *s, enum wb_swept_instructions instructions, int points,
                             bool is_double)
{
    struct wb_swept_tape_model model = {
        .material = {WB_HARDENING_ISOTROPIC_POWER, 119e6, 0.3, 2.4e6, 16.3e6, 0.73},
        .density = 1250.0,
        .thickness = 0.2e-3,
        .points = points,
        .layout = wb_swept_layout(NODES, ALONG + 1),
        .spacing = spacing,
        .closed = true,
        .double_precision = is_double,
        .instructions = instructions};
    void **fields[] = {(void **)&s->position,
                       (void **)&s->director,
                       (void **)&s->velocity,
                       (void **)&s->turning,
                       &s->force,
                       &s->moment};

    *s = (struct sleeve){.layout = model.layout};
    for (int i = 0; i < 6; i++)
        *fields[i] = wb_swept_allocate(wb_swept_size(&s->layout), sizeof(double));
    for (int k = 0; k < NODES; k++) {
        for (int j = 0; j <= ALONG; j++) {
            double *at = s->position + 3 * k * s->layout.stride + j;
            at[0] = j * spacing;
            at[s->layout.stride] = radius * sin(2.0 * M_PI * k / NODES);
            at[2 * s->layout.stride] = radius * cos(2.0 * M_PI * k / NODES);
        }
    }
    model.position = s->position;
    WB_TRY(wb_swept_tape_create(&s->tape, &model));
    s->state = wb_swept_tape_state_create(s->tape);
    memcpy(s->director, wb_swept_tape_directors(s->tape),
           wb_swept_size(&s->layout) * sizeof(double));
    return make_steps(s, is_double);
}

/* Stretches all positions along the axis. */
static void stretch(struct sleeve *s, double factor)
{
    for (int k = 0; k < NODES; k++) {
        for (int j = 0; j <= ALONG; j++)
            s->position[3 * k * s->layout.stride + j] *= factor;
    }
}

/* Least ns an element and step. The tape is stretched a little in each step when it yields. */
static double time_sleeve(struct sleeve *s, bool yielding, bool whole)
{
    const struct wb_swept_tape_fields fields = {s->position, s->director, s->force, s->moment};
    const struct wb_swept_step_fields own = {s->position, s->velocity, s->force};
    const struct wb_swept_step_fields turns = {s->director, s->turning, s->moment};
    const double times[2] = {1e-9, 1e-9};
    const int blocks = wb_swept_tape_blocks(s->tape);
    double best = 1e9, stretching = 0.0;

    for (int repeat = 0; repeat < REPEATS; repeat++) {
        const double start = cpu_seconds();
        stretching = 0.0;
        for (int i = 0; i < STEPS; i++) {
            if (yielding) {
                const double before = cpu_seconds();
                stretch(s, 1.0 + 1e-6);
                stretching += cpu_seconds() - before;
            }
            for (int b = 0; b < blocks; b++) {
                wb_swept_tape_forces(s->state, &fields, b, b + 1, NULL);
                if (whole) {
                    wb_swept_step_update(s->step[0], &own, times, b, b + 1, NULL);
                    wb_swept_step_update(s->step[1], &turns, times, b, b + 1, NULL);
                }
            }
        }
        const double spent = cpu_seconds() - start - stretching;
        best = fmin(best, spent * 1e9 / (STEPS * NODES * ALONG));
    }
    return best;
}

/* --- on a wire --- */

enum {
    SURFACE = 24
};

struct wire {
    struct wb_swept_layout layout;
    double node[SURFACE][2];
    int surface[SURFACE];
    double *position;
    void *force;
};

static void create_wire(struct wire *w, double its_radius)
{
    *w = (struct wire){.layout = wb_swept_layout(SURFACE, ALONG + 1)};
    w->position = wb_swept_allocate(wb_swept_size(&w->layout), sizeof(double));
    w->force = wb_swept_allocate(wb_swept_size(&w->layout), sizeof(double));
    for (int k = 0; k < SURFACE; k++) {
        w->surface[k] = k;
        w->node[k][0] = its_radius * sin(2.0 * M_PI * k / SURFACE);
        w->node[k][1] = its_radius * cos(2.0 * M_PI * k / SURFACE);
        for (int j = 0; j <= ALONG; j++) {
            double *at = w->position + 3 * k * w->layout.stride + j;
            at[0] = j * spacing;
            at[w->layout.stride] = w->node[k][0];
            at[2 * w->layout.stride] = w->node[k][1];
        }
    }
}

/* Least ns a node and step, of a sleeve on a wire as large, pressed together. */
static enum wb_status time_wire(struct sleeve *s, double ns[2])
{
    struct wb_swept_cohesion_bond *bond = calloc(NODES * (ALONG + 1), sizeof *bond);
    struct wb_swept_cohesion_settings bonded;
    struct wb_swept_tape_contact_settings touching;
    struct wb_swept_cohesion *cohesion = NULL;
    struct wb_swept_tape_contact *contact = NULL;
    struct wire w;

    if (!bond)
        return WB_ERR_MEMORY;
    for (int i = 0; i < NODES * (ALONG + 1); i++)
        bond[i] = (struct wb_swept_cohesion_bond){0, 1.0};
    default_cohesion(&bonded);
    default_tape_contact(&touching);
    create_wire(&w, radius - 0.099e-3);
    const struct wb_swept_wire wire = {.node = (const double(*)[2])w.node,
                                       .n_nodes = SURFACE,
                                       .n_surface = SURFACE,
                                       .surface = w.surface,
                                       .radius = radius - 0.099e-3};
    WB_TRY(wb_swept_cohesion_create(&cohesion, s->tape, &bonded, 1, &wire, bond));
    WB_TRY(wb_swept_tape_contact_create(&contact, s->tape, NULL, &touching, 1, &wire));
    const struct wb_swept_cohesion_fields fields = {{s->position, s->director, s->force, s->moment},
                                                    (const double *const[]){w.position},
                                                    (void *const[]){w.force}};
    ns[0] = ns[1] = 1e9;
    for (int repeat = 0; repeat < REPEATS; repeat++) {
        struct wb_swept_cohesion_sums of_bond = {0};
        struct wb_swept_tape_contact_sums of_contact = {0};
        const double start = cpu_seconds();
        for (int i = 0; i < STEPS; i++)
            wb_swept_cohesion_add_forces(cohesion, &fields, 0, wb_swept_tape_blocks(s->tape),
                                         &of_bond);
        const double middle = cpu_seconds();
        for (int i = 0; i < STEPS; i++)
            WB_TRY(wb_swept_tape_contact_add_forces(contact, &fields, 1e-6, &of_contact));
        const double per = 1e9 / (STEPS * NODES * (ALONG + 1));
        ns[0] = fmin(ns[0], (middle - start) * per);
        ns[1] = fmin(ns[1], (cpu_seconds() - middle) * per);
    }
    wb_swept_cohesion_destroy(cohesion);
    wb_swept_tape_contact_destroy(contact);
    free(bond);
    free(w.position);
    free(w.force);
    return WB_OK;
}

int main(void)
{
    static const char *const names[] = {"best", "baseline", "avx2", "avx512"};

    printf("a shell of the tape, ns an element and step on one core\n\n"
           "                 points   elastic   yielding   elastic, with update   "
           "a bonded node   a touching node\n");
    for (int is_double = 0; is_double < 2; is_double++) {
        for (int way = WB_SWEPT_BASELINE; way <= WB_SWEPT_AVX512; way++) {
            for (int points = 3; points <= 5; points += 2) {
                struct sleeve s;
                if (create(&s, way, points, is_double) != WB_OK) {
                    destroy(&s);
                    continue;
                }
                double of_wire[2];
                if (time_wire(&s, of_wire) != WB_OK)
                    return EXIT_FAILURE;
                const double elastic = time_sleeve(&s, false, false);
                const double whole = time_sleeve(&s, false, true);
                stretch(&s, 1.03);
                const double yielding = time_sleeve(&s, true, false);
                printf("%-8s %-6s %6d %9.2f %10.2f %22.2f %15.2f %17.2f\n", names[way],
                       is_double ? "double" : "float", points, elastic, yielding, whole, of_wire[0],
                       of_wire[1]);
                if (!(wb_swept_tape_plastic_work(s.state) > 0.0)) {
                    fprintf(stderr, "the tape did not yield\n");
                    return EXIT_FAILURE;
                }
                destroy(&s);
            }
        }
    }
    printf("\ngoal, float and avx512, 3 points: about 10\n");
    return EXIT_SUCCESS;
}
