/* CPU time per swept hexahedron on one core: forces and time step of 12-element sections, all
 * points yielding, for each instruction set, in float and in double. The baseline is the slow twin,
 * a textbook element in double. Several wires are computed in turn, as in a bundle; the measurement
 * is repeated in two processes at the same time. */
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "fe/swept/swept_private.h"
#include "fe/swept/swept_step.h"
#include "tests/fe/swept/swept_hex_twin.h"

enum {
    WIRES = 7,
    ELEMENTS = 80,
    QUADS = 12,
    REPEATS = 12
};

static const double diameter = 1.4e-3, length = 0.085;
static const struct wb_material material = {
    WB_HARDENING_ISOTROPIC_POWER, 4528e6, 0.39, 4.52e6, 1327e6, 0.90};

static clockid_t bench_clock = CLOCK_PROCESS_CPUTIME_ID;

static double seconds(void)
{
    struct timespec now;
    clock_gettime(bench_clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

struct wire {
    struct wb_swept_hex_state *state;
    double *bent[2]; /* two curvatures, between which all points yield */
    double *velocity;
    void *force;
};

struct bench {
    struct wb_swept_section section;
    struct wb_swept_hex_model model;
    struct wb_swept_hex *hex;
    struct wb_swept_layout layout;
    struct wb_swept_step *step;
    struct wire wire[WIRES];
};

/* Arcs in the plane of x and y. */
static void bend(const struct bench *b, double curvature, double *position)
{
    const int stride = b->layout.stride;
    for (int k = 0; k < b->section.n_nodes; k++) {
        const double radius = 1.0 / curvature - b->section.node[k][0];
        for (int j = 0; j < stride; j++) {
            const double angle = curvature * j * b->model.element_length;
            position[3 * k * stride + j] = radius * sin(angle);
            position[(3 * k + 1) * stride + j] = 1.0 / curvature - radius * cos(angle);
            position[(3 * k + 2) * stride + j] = b->section.node[k][1];
        }
    }
}

static bool bench_create(struct bench *b, const struct wb_swept_hex_model *model, double selective)
{
    double mass[64];
    *b = (struct bench){.model = *model};
    if (wb_swept_section_init_circle(&b->section, diameter, 2, 1) != WB_OK)
        return false;
    b->model.section = &b->section;
    if (wb_swept_hex_create(&b->hex, &b->model) != WB_OK)
        return false;
    b->layout = wb_swept_hex_layout(b->hex);
    for (int k = 0; k < b->section.n_nodes; k++)
        mass[k] = 7.65e-3 * b->section.share[k];
    const struct wb_swept_step_model step = {.layout = b->layout,
                                             .node_mass = mass,
                                             .spacing = b->model.element_length,
                                             .selective = selective,
                                             .double_precision = model->double_precision};
    if (wb_swept_step_create(&b->step, &step) != WB_OK)
        return false;
    for (int w = 0; w < WIRES; w++) {
        struct wire *wire = &b->wire[w];
        const size_t size = wb_swept_size(&b->layout);
        wire->bent[0] = wb_swept_allocate(size, sizeof(double));
        wire->bent[1] = wb_swept_allocate(size, sizeof(double));
        wire->velocity = wb_swept_allocate(size, sizeof(double));
        wire->force = wb_swept_allocate(size, sizeof(double));
        wire->state = wb_swept_hex_state_create(b->hex);
        bend(b, 30.0, wire->bent[0]);
        bend(b, -30.0, wire->bent[1]);
    }
    return true;
}

static void bench_destroy(struct bench *b)
{
    for (int w = 0; w < WIRES; w++) {
        wb_swept_hex_state_destroy(b->wire[w].state);
        free(b->wire[w].bent[0]);
        free(b->wire[w].bent[1]);
        free(b->wire[w].velocity);
        free(b->wire[w].force);
    }
    wb_swept_step_destroy(b->step);
    wb_swept_hex_destroy(b->hex);
    wb_swept_section_release(&b->section);
}

/* Least nanoseconds an element of all repeats. With `move` the step is made too, of length 0 so
 * that the wires stay where they are. */
static double time_kernel(struct bench *b, bool move)
{
    const double still[2] = {0.0, 0.0};
    const int blocks = wb_swept_hex_blocks(b->hex), turns = 40;
    double best = 1e30;

    for (int repeat = 0; repeat < REPEATS; repeat++) {
        const double start = seconds();
        for (int turn = 0; turn < turns; turn++) {
            for (int w = 0; w < WIRES; w++) {
                struct wire *wire = &b->wire[w];
                double *position = wire->bent[turn % 2];
                const struct wb_swept_step_fields fields = {position, wire->velocity, wire->force};
                const struct wb_swept_hex_fields forces = {position, wire->force, NULL};
                wb_swept_hex_add_forces(wire->state, &forces, 0, blocks, NULL);
                if (move)
                    wb_swept_step_update(b->step, &fields, still, 0, blocks, NULL);
            }
        }
        const double spent = (seconds() - start) / (turns * WIRES * ELEMENTS * QUADS) * 1e9;
        best = spent < best ? spent : best;
    }
    return best;
}

/* The same bent wire. */
static double time_twin(const struct wb_swept_hex_model *model, double *bytes)
{
    struct wb_swept_section section;
    struct wb_swept_hex_model m = *model;
    double best = 1e30;

    if (wb_swept_section_init_circle(&section, diameter, 2, 1) != WB_OK)
        return (double)NAN;
    m.section = &section;
    struct twin twin = twin_create(&m);
    const int n = section.n_nodes * (ELEMENTS + 1);
    double *x = calloc((size_t)(6 * n), sizeof *x);
    for (int repeat = 0; x && repeat < REPEATS; repeat++) {
        const double curvature = repeat % 2 ? -30.0 : 30.0;
        for (int i = 0; i < n; i++) {
            const double *node = section.node[i % section.n_nodes];
            const double angle = curvature * (i / section.n_nodes) * m.element_length;
            x[3 * i] = (1.0 / curvature - node[0]) * sin(angle);
            x[3 * i + 1] = 1.0 / curvature - (1.0 / curvature - node[0]) * cos(angle);
            x[3 * i + 2] = node[1];
        }
        const double start = seconds();
        twin_forces(&twin, x, x + 3 * n);
        const double spent = (seconds() - start) / (ELEMENTS * QUADS) * 1e9;
        best = spent < best ? spent : best;
    }
    *bytes = (double)(4 * sizeof *twin.points);
    free(x);
    twin_destroy(&twin);
    wb_swept_section_release(&section);
    return best;
}

/* Histories read and written, positions read and forces written, a station's share of an element.
 */
static double bytes_of(const struct bench *b)
{
    size_t history;
    wb_swept_hex_state_data(b->wire[0].state, &history);
    const double elements = ELEMENTS * QUADS;
    const double real = b->model.double_precision ? sizeof(double) : sizeof(float);
    const double nodes = (double)wb_swept_size(&b->layout);
    return (2.0 * (double)history + nodes * (sizeof(double) + real)) / elements;
}

/* And of the step: forces read, positions and velocities read and written. */
static double bytes_with_step(const struct bench *b)
{
    const double real = b->model.double_precision ? sizeof(double) : sizeof(float);
    const double nodes = (double)wb_swept_size(&b->layout);
    return bytes_of(b) + nodes * (real + 4.0 * sizeof(double)) / (ELEMENTS * QUADS);
}

static bool print_row(const struct wb_swept_hex_model *model, double twin)
{
    struct bench b;
    const bool good = bench_create(&b, model, 1.0);
    if (good) {
        const double kernel = time_kernel(&b, false), step = time_kernel(&b, true);
        printf("%-12s %-7s %-9s %8.2f %11.2f %9.0f %12.0f %16.4f\n",
               model->formulation == WB_SWEPT_HEX_ONE_POINT ? "one point" : "2x2x1",
               model->double_precision ? "double" : "float",
               wb_swept_instructions_name(wb_swept_hex_get_model(b.hex)->instructions), kernel,
               step, bytes_of(&b), bytes_with_step(&b), kernel / twin);
    }
    bench_destroy(&b);
    return good;
}

/* Wall time of the whole step, best instructions, in one process and in two at the same time. */
static bool print_copies(struct wb_swept_hex_model model)
{
    struct bench b;
    model.instructions = WB_SWEPT_BEST;
    bench_clock = CLOCK_MONOTONIC;
    bool good = bench_create(&b, &model, 1.0);
    if (good) {
        const double one = time_kernel(&b, true);
        fflush(stdout);
        const pid_t copy = fork();
        const double two = time_kernel(&b, true);
        if (copy == 0)
            _exit(0);
        good = copy > 0 && waitpid(copy, NULL, 0) == copy;
        if (good)
            printf("%s, wall time of forces and step: %.2f ns in one process, %.2f in each of "
                   "two: %.2f times the work\n",
                   model.double_precision ? "double" : "float", one, two, 2.0 * one / two);
    }
    bench_destroy(&b);
    bench_clock = CLOCK_PROCESS_CPUTIME_ID;
    return good;
}

static void discard(void *context, enum wb_log_level level, const char *domain, const char *message)
{
    (void)context, (void)level, (void)domain, (void)message;
}

int main(void)
{
    wb_log_set_sink(discard, NULL); /* of instructions that this processor does not have */
    printf("%d wires of %d x %d hexahedra, all yielding; CPU nanoseconds an element and step on "
           "one core\n\n"
           "formulation  numbers instr.      forces    and step     bytes    with step  ratio to "
           "the twin\n",
           WIRES, QUADS, ELEMENTS);
    for (int f = 0; f < 2; f++) {
        struct wb_swept_hex_model model = {.material = material,
                                           .n_elements = ELEMENTS,
                                           .element_length = length / ELEMENTS,
                                           .formulation = f == 0 ? WB_SWEPT_HEX_FOUR_POINTS
                                                                 : WB_SWEPT_HEX_ONE_POINT};
        double bytes;
        const double twin = time_twin(&model, &bytes);
        int rows = 0;
        for (int i = 0; i < 6; i++) {
            model.double_precision = i % 2;
            model.instructions = (enum wb_swept_instructions)(WB_SWEPT_AVX512 - i / 2);
            rows += print_row(&model, twin);
        }
        if (rows == 0 || !(twin > 0.0)) {
            fprintf(stderr, "the benchmark's wires did not do what they should\n");
            return EXIT_FAILURE;
        }
        printf("%-12s %-7s %-9s %8.2f\n", f == 0 ? "2x2x1" : "one point", "double", "slow twin",
               twin);
    }
    putchar('\n');
    for (int d = 0; d < 2; d++) {
        const struct wb_swept_hex_model model = {.material = material,
                                                 .n_elements = ELEMENTS,
                                                 .element_length = length / ELEMENTS,
                                                 .double_precision = d};
        if (!print_copies(model))
            return EXIT_FAILURE;
    }
    printf("\ngoal, float with AVX-512, forces: at most 10 with 2x2x1, 8 with one point\n");
    return EXIT_SUCCESS;
}
