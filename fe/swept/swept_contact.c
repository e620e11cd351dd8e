#include "fe/swept/swept_contact.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fe/swept/swept_contact_private.h"

#define WB_LOG_DOMAIN "contact"

enum {
    MOST_WIRES = 1024,
    MOST_STATIONS = 1 << 20,
    MOST_SURFACE = 1 << 16
};

/* Beyond this part of the smallest radius the penalty is no contact any more. */
static const double deepest_part = 0.5;

void wb_swept_contact_default_settings(struct wb_swept_contact_settings *settings)
{
    *settings = (struct wb_swept_contact_settings){
        .stiffness = 0.25,
        .tangential_ratio = 0.5,
        .friction_static = 0.4,
        .friction_kinetic = 0.4,
        .reach = 0.5,
        .refresh_interval = 50,
    };
}

static bool in_range(double x, double low, double high)
{
    return x >= low && x <= high;
}

static enum wb_status check_settings(const struct wb_swept_contact_settings *s)
{
    const double most = 1e12;

    if (!(in_range(s->stiffness, 1e-12, 1e6) && in_range(s->tangential_ratio, 1e-6, 1e6)))
        return wb_fail(WB_ERR_ARGUMENT, "a contact stiffness of %g E, tangentially %g of it",
                       s->stiffness, s->tangential_ratio);
    if (!(in_range(s->friction_static, 0.0, 1e3) && in_range(s->friction_kinetic, 0.0, 1e3) &&
          in_range(s->friction_decay, 0.0, most) && in_range(s->damping_time, 0.0, most)))
        return wb_fail(WB_ERR_ARGUMENT, "friction %g and %g, decay %g s/m, damping time %g s",
                       s->friction_static, s->friction_kinetic, s->friction_decay, s->damping_time);
    if (!(in_range(s->reach, 1e-3, 10.0)) || s->refresh_interval < 1 || s->most_pairs < 0)
        return wb_fail(WB_ERR_ARGUMENT, "reach %g, refreshed every %d steps, at most %d pairs",
                       s->reach, s->refresh_interval, s->most_pairs);
    return WB_OK;
}

static enum wb_status check_wire(const struct wb_swept_contact_wire *wire, int w)
{
    if (!(in_range(wire->radius, 1e-12, 1e12) && in_range(wire->youngs_modulus, 1e-12, 1e30)))
        return wb_fail(WB_ERR_ARGUMENT, "wire %d: radius %g m, Young's modulus %g Pa", w,
                       wire->radius, wire->youngs_modulus);
    if (wire->n_surface < 3 || wire->n_surface > MOST_SURFACE)
        return wb_fail(WB_ERR_ARGUMENT, "wire %d has %d surface nodes", w, wire->n_surface);
    for (int k = 0; k < wire->n_surface; k++) {
        const int node = wire->surface[k];
        if (node < 0 || node >= wire->n_nodes ||
            !(in_range(fabs(wire->node[node][0]), 0.0, 1e12) &&
              in_range(fabs(wire->node[node][1]), 0.0, 1e12)))
            return wb_fail(WB_ERR_ARGUMENT, "wire %d has no surface node %d", w, node);
    }
    return WB_OK;
}

static enum wb_status choose_kernel(const struct wb_swept_contact_settings *settings,
                                    const struct wb_swept_contact_kernel **out)
{
    static const struct wb_swept_contact_kernel *const kernels[][2] = {
        [WB_SWEPT_CONTACT_BASELINE] = {&wb_swept_contact_kernel_float_baseline,
                                       &wb_swept_contact_kernel_double_baseline},
#ifdef __x86_64__
        [WB_SWEPT_CONTACT_AVX2] = {&wb_swept_contact_kernel_float_avx2,
                                   &wb_swept_contact_kernel_double_avx2},
        [WB_SWEPT_CONTACT_AVX512] = {&wb_swept_contact_kernel_float_avx512,
                                     &wb_swept_contact_kernel_double_avx512},
#endif
    };
    const int n = (int)(sizeof kernels / sizeof kernels[0]), type = settings->double_precision;
    int set = (int)settings->instructions;

    if (set == WB_SWEPT_CONTACT_BEST) {
        set = n - 1;
        while (!kernels[set][type]->runs_here())
            set--;
    }
    if (set < 0 || set >= n || !kernels[set][type]->runs_here())
        return wb_fail(WB_ERR_UNSUPPORTED, "this processor lacks the instructions asked for (%d)",
                       set);
    *out = kernels[set][type];
    return WB_OK;
}

/* Least squares of a linear function of y and z: its value at 0 and its two slopes as weights of
 * the nodes' values. */
static enum wb_status find_weights(const struct wb_swept_contact_wire *wire, int w,
                                   double (*weight)[3])
{
    double A[3][3] = {{0.0}}, inverse[3][3];

    for (int k = 0; k < wire->n_surface; k++) {
        const double *at = wire->node[wire->surface[k]];
        const double row[3] = {1.0, at[0] / wire->radius, at[1] / wire->radius};
        for (int i = 0; i < 9; i++)
            A[i / 3][i % 3] += row[i / 3] * row[i % 3];
    }
    double det = 0.0;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            inverse[j][i] = A[(i + 1) % 3][(j + 1) % 3] * A[(i + 2) % 3][(j + 2) % 3] -
                            A[(i + 1) % 3][(j + 2) % 3] * A[(i + 2) % 3][(j + 1) % 3];
    }
    for (int j = 0; j < 3; j++)
        det += A[0][j] * inverse[j][0];
    if (!(det > 1e-9 * A[0][0] * A[1][1] * A[2][2]))
        return wb_fail(WB_ERR_ARGUMENT, "wire %d: surface nodes on a line", w);
    for (int k = 0; k < wire->n_surface; k++) {
        const double *at = wire->node[wire->surface[k]];
        for (int i = 0; i < 3; i++) {
            const double scale = i == 0 ? 1.0 : 1.0 / wire->radius;
            weight[k][i] = scale *
                           (inverse[i][0] + inverse[i][1] * at[0] / wire->radius +
                            inverse[i][2] * at[1] / wire->radius) /
                           det;
        }
    }
    return WB_OK;
}

static enum wb_status allocate_rows(struct wb_swept_contact *c)
{
    const size_t wires = (size_t)c->model.n_wires, pairs = (size_t)c->most_pairs;
    const size_t stride = (size_t)c->model.stride, row = (size_t)c->model.row;
    const size_t real = wb_swept_contact_real_size(c);
    void *rows[3] = {NULL, NULL, NULL};

    enum wb_status status = wb_swept_allocate(&rows[0], wires * 3 * row, sizeof(double));
    if (status == WB_OK)
        status =
            wb_swept_allocate(&rows[1], wires * WB_SWEPT_CONTACT_FIXED * stride, sizeof(double));
    if (status == WB_OK)
        status =
            wb_swept_allocate(&rows[2], pairs * WB_SWEPT_CONTACT_PAIR * stride, sizeof(double));
    c->centre_memory = rows[0];
    c->fixed_memory = rows[1];
    c->rows_memory = rows[2];
    WB_TRY(status);
    WB_TRY(wb_swept_allocate(&c->turn_memory, wires * WB_SWEPT_CONTACT_TURNS * row, real));
    WB_TRY(wb_swept_allocate(&c->inverse_memory, wires * WB_SWEPT_CONTACT_INVERSES * stride, real));
    return wb_swept_allocate(&c->load_memory, pairs * WB_SWEPT_CONTACT_LOAD * row, real);
}

static enum wb_status allocate(struct wb_swept_contact *c, int n_surface)
{
    struct wb_swept_contact_model *m = &c->model;
    const size_t wires = (size_t)m->n_wires, pairs = (size_t)c->most_pairs;
    const size_t blocks = (size_t)m->n_blocks, surface = (size_t)n_surface;

    WB_TRY(allocate_rows(c));
    WB_TRY(wb_swept_allocate(&c->narrow_weight_memory, 3 * surface, wb_swept_contact_real_size(c)));
    m->wire = calloc(wires, sizeof *m->wire);
    m->pair = calloc(pairs, sizeof *m->pair);
    m->sums = calloc(blocks, sizeof *m->sums);
    c->radius = calloc(2 * wires, sizeof *c->radius);
    c->searched = calloc(wires * 3 * (size_t)m->n_stations, sizeof *c->searched);
    c->active_memory = calloc(pairs * blocks, 1);
    c->window_memory = calloc(4 * pairs * blocks, sizeof *c->window_memory);
    c->node_memory = calloc(surface, sizeof *c->node_memory);
    c->side_memory = calloc(2 * pairs, sizeof *c->side_memory);
    c->weight_memory = calloc(surface, sizeof *c->weight_memory);
    if (!(m->wire && m->pair && m->sums && c->radius && c->searched && c->active_memory &&
          c->window_memory && c->node_memory && c->side_memory && c->weight_memory))
        return wb_fail(WB_ERR_MEMORY, "no memory for the contact of %d wires", m->n_wires);
    c->youngs_modulus = c->radius + m->n_wires;
    return WB_OK;
}

static void point_at_memory(struct wb_swept_contact *c)
{
    const struct wb_swept_contact_model *m = &c->model;
    const ptrdiff_t stride = m->stride, row = m->row;

    for (int w = 0; w < m->n_wires; w++) {
        m->wire[w].centre = c->centre_memory + w * 3 * row + stride;
        m->wire[w].fixed = c->fixed_memory + w * WB_SWEPT_CONTACT_FIXED * stride;
        m->wire[w].turn =
            wb_swept_contact_at(c, c->turn_memory, w * WB_SWEPT_CONTACT_TURNS * row + stride);
        m->wire[w].inverse =
            wb_swept_contact_at(c, c->inverse_memory, w * WB_SWEPT_CONTACT_INVERSES * stride);
    }
    for (int p = 0; p < c->most_pairs; p++) {
        struct wb_swept_contact_pair_rows *pair = &m->pair[p];
        struct wb_swept_contact_window *window = c->window_memory + (ptrdiff_t)p * 4 * m->n_blocks;
        pair->rows = c->rows_memory + p * WB_SWEPT_CONTACT_PAIR * stride;
        pair->load =
            wb_swept_contact_at(c, c->load_memory, p * WB_SWEPT_CONTACT_LOAD * row + stride);
        pair->active = c->active_memory + (ptrdiff_t)p * m->n_blocks;
        for (int side = 0; side < 2; side++, window += 2 * m->n_blocks) {
            pair->from[side] = window;
            pair->to[side] = window + m->n_blocks;
        }
    }
}

static enum wb_status take_wires(struct wb_swept_contact *c,
                                 const struct wb_swept_contact_wire *wires)
{
    int n = 0;

    c->smallest_radius = (double)INFINITY;
    for (int w = 0; w < c->model.n_wires; w++) {
        struct wb_swept_contact_frames *out = &c->model.wire[w];
        out->n_nodes = wires[w].n_nodes;
        out->n_surface = wires[w].n_surface;
        out->node = c->node_memory + n;
        out->weight = (const double(*)[3])c->weight_memory + n;
        memcpy(c->node_memory + n, wires[w].surface, sizeof(int) * (size_t)wires[w].n_surface);
        WB_TRY(find_weights(&wires[w], w, c->weight_memory + n));
        out->narrow_weight = wb_swept_contact_at(c, c->narrow_weight_memory, (ptrdiff_t)3 * n);
        for (int i = 0; i < 3 * wires[w].n_surface; i++)
            wb_swept_contact_set(c, c->narrow_weight_memory, (ptrdiff_t)3 * n + i,
                                 c->weight_memory[n + i / 3][i % 3]);
        n += wires[w].n_surface;
        c->radius[w] = wires[w].radius;
        c->youngs_modulus[w] = wires[w].youngs_modulus;
        c->smallest_radius = fmin(c->smallest_radius, wires[w].radius);
    }
    return WB_OK;
}

static void size_model(struct wb_swept_contact *c, int n_wires, int n_stations)
{
    const struct wb_swept_contact_settings *s = &c->settings;
    const struct wb_swept_layout layout = wb_swept_layout(1, n_stations);

    c->most_pairs = s->most_pairs > 0 ? s->most_pairs : 4 * n_wires;
    c->model = (struct wb_swept_contact_model){
        .n_wires = n_wires,
        .n_stations = n_stations,
        .n_blocks = (n_stations + WB_SWEPT_LANES - 1) / WB_SWEPT_LANES,
        .stride = layout.stride,
        .row = 3 * layout.stride,
        .friction_static = s->friction_static,
        .friction_kinetic = s->friction_decay > 0.0 ? s->friction_kinetic : s->friction_static,
        .friction_decay = s->friction_decay,
        .damping_time = s->damping_time,
        .counted = wb_swept_range_within(s->counted, n_stations),
    };
}

enum wb_status wb_swept_contact_create(struct wb_swept_contact **out,
                                       const struct wb_swept_contact_settings *settings,
                                       int n_wires, const struct wb_swept_contact_wire *wires,
                                       int n_stations, double spacing)
{
    const struct wb_swept_contact_kernel *kernel;
    int n_surface = 0;

    if (n_wires < 1 || n_wires > MOST_WIRES || n_stations < 2 || n_stations > MOST_STATIONS ||
        !(in_range(spacing, 1e-12, 1e12)))
        return wb_fail(WB_ERR_ARGUMENT, "contact of %d wires with %d stations %g m apart", n_wires,
                       n_stations, spacing);
    WB_TRY(check_settings(settings));
    WB_TRY(choose_kernel(settings, &kernel));
    for (int w = 0; w < n_wires; w++) {
        WB_TRY(check_wire(&wires[w], w));
        n_surface += wires[w].n_surface;
    }
    struct wb_swept_contact *c = calloc(1, sizeof *c);
    if (!c)
        return wb_fail(WB_ERR_MEMORY, "no memory for the contact of %d wires", n_wires);
    c->settings = *settings;
    c->kernel = kernel;
    c->spacing = spacing;
    size_model(c, n_wires, n_stations);
    enum wb_status status = allocate(c, n_surface);
    if (status == WB_OK) {
        point_at_memory(c);
        status = take_wires(c, wires);
    }
    if (status != WB_OK) {
        wb_swept_contact_destroy(c);
        return status;
    }
    *out = c;
    return WB_OK;
}

void wb_swept_contact_destroy(struct wb_swept_contact *contact)
{
    if (!contact)
        return;
    free(contact->centre_memory);
    free(contact->fixed_memory);
    free(contact->rows_memory);
    free(contact->turn_memory);
    free(contact->inverse_memory);
    free(contact->load_memory);
    free(contact->narrow_weight_memory);
    free(contact->model.wire);
    free(contact->model.pair);
    free(contact->model.sums);
    free(contact->radius);
    free(contact->searched);
    free(contact->active_memory);
    free(contact->window_memory);
    free(contact->node_memory);
    free(contact->side_memory);
    free(contact->weight_memory);
    free(contact);
}

void wb_swept_contact_reset(struct wb_swept_contact *contact)
{
    contact->model.n_pairs = 0;
    contact->model.started = false;
    contact->step = 0;
}

const char *wb_swept_contact_instructions(const struct wb_swept_contact *contact)
{
    return contact->kernel->name;
}

int wb_swept_contact_blocks(const struct wb_swept_contact *contact)
{
    return contact->model.n_blocks;
}

void wb_swept_contact_gather(struct wb_swept_contact *contact, const double *const *position,
                             int first, int end)
{
    contact->kernel->gather(&(struct wb_swept_contact_call){
        .model = &contact->model, .position = position, .first_block = first, .end_block = end});
}

enum wb_status wb_swept_contact_refresh(struct wb_swept_contact *contact)
{
    double check = 0.0;

    for (int b = 0; b < contact->model.n_blocks; b++)
        check += contact->model.sums[b].check;
    if (!isfinite(check))
        return wb_fail_to(contact->settings.reason, WB_ERR_DATA,
                          "a wire's surface is nowhere (step %lld)", contact->step);
    if (contact->step % contact->settings.refresh_interval != 0)
        return WB_OK;
    return wb_swept_contact_search(contact);
}

void wb_swept_contact_press(struct wb_swept_contact *contact, double time_step, int first, int end)
{
    contact->kernel->press(&(struct wb_swept_contact_call){
        .model = &contact->model, .time_step = time_step, .first_block = first, .end_block = end});
}

void wb_swept_contact_scatter(const struct wb_swept_contact *contact, void *const *force, int first,
                              int end)
{
    contact->kernel->scatter(&(struct wb_swept_contact_call){
        .model = &contact->model, .force = force, .first_block = first, .end_block = end});
}

enum wb_status wb_swept_contact_finish(struct wb_swept_contact *contact,
                                       struct wb_swept_contact_energies *energies)
{
    struct wb_swept_contact_energies sum = {0};

    for (int b = 0; b < contact->model.n_blocks; b++) {
        const struct wb_swept_contact_sums *part = &contact->model.sums[b];
        sum.normal += part->normal;
        sum.tangential += part->tangential;
        sum.friction += part->friction;
        sum.damping += part->damping;
        sum.deepest = fmax(sum.deepest, part->deepest);
    }
    contact->step++;
    contact->model.started = true;
    if (!isfinite(sum.normal + sum.tangential + sum.friction + sum.damping))
        return wb_fail_to(contact->settings.reason, WB_ERR_DATA,
                          "contact energies are not finite (step %lld)", contact->step);
    if (!(sum.deepest <= deepest_part * contact->smallest_radius))
        return wb_fail_to(contact->settings.reason, WB_ERR_DATA,
                          "wires penetrate by %.3g mm (step %lld)", 1e3 * sum.deepest,
                          contact->step);
    *energies = sum;
    return WB_OK;
}

enum wb_status wb_swept_contact_add_forces(struct wb_swept_contact *contact,
                                           const double *const *position, void *const *force,
                                           double time_step,
                                           struct wb_swept_contact_energies *energies)
{
    const int n = contact->model.n_blocks;

    if (!(time_step > 0.0 && isfinite(time_step)))
        return wb_fail(WB_ERR_ARGUMENT, "contact in a time step of %g s", time_step);
    wb_swept_contact_gather(contact, position, 0, n);
    WB_TRY(wb_swept_contact_refresh(contact));
    wb_swept_contact_press(contact, time_step, 0, n);
    wb_swept_contact_scatter(contact, force, 0, n);
    return wb_swept_contact_finish(contact, energies);
}
