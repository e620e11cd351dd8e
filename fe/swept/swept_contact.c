#include "fe/swept/swept_contact.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fe/swept/swept_contact_kernel.h"
#include "fe/swept/swept_private.h"

#define WB_LOG_DOMAIN "contact"

enum {
    BLOCK = WB_SWEPT_LANES,
    MAX_ITERATIONS = 60,
    FEWEST_NEIGHBOURS = 6,
    MAX_WIRES = 1024,
    MAX_STATIONS = 1 << 20,
    MAX_SURFACE = 1 << 16
};

static const struct wb_swept_contact_kernel *const kernels[][2] =
    WB_SWEPT_KERNEL_VERSIONS(wb_swept_contact_kernel);

/* Penetration, as a fraction of the smallest radius, above which the run fails. */
static const double deepest_part = 0.5;

/* Tolerance of shifts, in stations; the contact energy is stationary there. New pairs use the
 * smaller one, so that their shift does not depend on the initial guess and parts of a bundle
 * compute the same as the complete bundle. */
static const double shift_tolerance = 1e-4, first_tolerance = 1e-12;

/* Neighbours are searched again when a centre has moved by this fraction of the reach. Two wires
 * have then approached by at most twice that, and half of the reach remains until the next
 * refresh. */
static const double moved_part = 0.25;

struct wb_swept_contact {
    struct wb_swept_contact_settings settings;
    const struct wb_swept_contact_kernel *kernel;
    struct wb_swept_contact_model model;
    int most_pairs;
    double spacing, smallest_radius;
    double *radius, *youngs_modulus; /* (n_wires) */
    double *searched;                /* (n_wires x 3 x n_stations): centres at the last search */
    long long step;                  /* steps done */
    struct wb_memory memory;         /* of all arrays, also of the model's */
};

/* k of two wires. */
static double pair_stiffness(const struct wb_swept_contact *contact, int a, int b)
{
    const double *E = contact->youngs_modulus;
    return contact->settings.stiffness * 2.0 * E[a] * E[b] / (E[a] + E[b]);
}

static size_t real_size(const struct wb_swept_contact *contact)
{
    return wb_swept_kernel_real_size(contact->settings.double_precision);
}

/* Sets element i of an array in the kernel's type. */
static void set(const struct wb_swept_contact *contact, void *array, ptrdiff_t i, double value)
{
    wb_swept_kernel_put(contact->settings.double_precision, array, i, value);
}

static double get(const struct wb_swept_contact *contact, const void *array, ptrdiff_t i)
{
    return wb_swept_kernel_get(contact->settings.double_precision, array, i);
}

static void *address(const struct wb_swept_contact *contact, void *array, ptrdiff_t i)
{
    return (unsigned char *)array + i * (ptrdiff_t)real_size(contact);
}

/* Row `i` of a pair; of a wire's centres; of its fixed rows. */
static double *pair_row(const struct wb_swept_contact *contact,
                        const struct wb_swept_contact_pair_rows *pair, int i)
{
    return pair->rows + (ptrdiff_t)i * contact->model.stride;
}

static double *centre_row(const struct wb_swept_contact *contact, int wire, int i)
{
    return contact->model.wire[wire].centre + (ptrdiff_t)i * contact->model.row;
}

static double *fixed_row(const struct wb_swept_contact *contact, int wire, int i)
{
    return contact->model.wire[wire].fixed + (ptrdiff_t)i * contact->model.stride;
}

/* A row's value at a position between stations. */
static double value_between(const struct wb_swept_contact *contact, const double *row, double place)
{
    const int last = contact->model.n_stations - 2;
    const int j = place >= last ? last : (int)place;
    const double f = place - j;
    return (1.0 - f) * row[j] + f * row[j + 1];
}

/* --- creation --- */

void wb_swept_contact_default_settings(struct wb_swept_contact_settings *settings)
{
    *settings = (struct wb_swept_contact_settings){
        .stiffness = 0.25,
        .tangential_ratio = 0.5,
        .friction = {.mu_static = 0.4, .mu_kinetic = 0.4},
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
        return wb_fail(WB_ERR_ARGUMENT,
                       "contact: stiffness %g E, tangential stiffness %g times that: "
                       "expected 1e-12 to 1e6 and 1e-6 to 1e6",
                       s->stiffness, s->tangential_ratio);
    if (!(in_range(s->friction.mu_static, 0.0, 1e3) && in_range(s->friction.mu_kinetic, 0.0, 1e3) &&
          in_range(s->friction.decay, 0.0, most) && in_range(s->damping_time, 0.0, most)))
        return wb_fail(
            WB_ERR_ARGUMENT,
            "friction: static coefficient %g, kinetic coefficient %g, decay %g s/m, damping "
            "time %g s: expected coefficients from 0 to 1000, decay and damping time from 0 "
            "to 1e12",
            s->friction.mu_static, s->friction.mu_kinetic, s->friction.decay, s->damping_time);
    if (!(in_range(s->reach, 1e-3, 10.0)) || s->refresh_interval < 1 || s->most_pairs < 0)
        return wb_fail(
            WB_ERR_ARGUMENT,
            "contact: reach %g radii, refresh interval %d steps, largest number of pairs %d: "
            "expected 0.001 to 10, at least 1, and 0 or more",
            s->reach, s->refresh_interval, s->most_pairs);
    return WB_OK;
}

static enum wb_status check_wire(const struct wb_swept_wire *wire, int w)
{
    if (!(in_range(wire->radius, 1e-12, 1e12) && in_range(wire->youngs_modulus, 1e-12, 1e30)))
        return wb_fail(WB_ERR_ARGUMENT,
                       "wire %d: radius %g m, Young's modulus %g Pa: expected "
                       "1e-12 to 1e12 m and 1e-12 to 1e30 Pa",
                       w, wire->radius, wire->youngs_modulus);
    if (wire->n_surface < 3 || wire->n_surface > MAX_SURFACE)
        return wb_fail(WB_ERR_ARGUMENT, "wire %d has %d surface nodes: expected 3 to %d", w,
                       wire->n_surface, MAX_SURFACE);
    for (int k = 0; k < wire->n_surface; k++) {
        const int node = wire->surface[k];
        if (node < 0 || node >= wire->n_nodes ||
            !(in_range(fabs(wire->node[node][0]), 0.0, 1e12) &&
              in_range(fabs(wire->node[node][1]), 0.0, 1e12)))
            return wb_fail(
                WB_ERR_ARGUMENT,
                "wire %d: surface node %d is not one of its %d nodes, or not within 1e12 "
                "m",
                w, node, wire->n_nodes);
    }
    return WB_OK;
}

/* Least-squares fit of a linear function of y and z: its value at 0 and its two slopes, as weights
 * of the nodes' values. */
static enum wb_status find_weights(const struct wb_swept_wire *wire, int w, double (*weight)[3])
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
        return wb_fail(WB_ERR_ARGUMENT,
                       "wire %d: the surface nodes lie on a line: expected nodes around a circle",
                       w);
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

/* Frames of a wire, with guards before and after rows that are read between stations. */
static enum wb_status take_wire(struct wb_swept_contact *c, const struct wb_swept_wire *wire, int w)
{
    struct wb_swept_contact_frames *out = &c->model.wire[w];
    struct wb_memory *const memory = &c->memory;
    const size_t n = (size_t)wire->n_surface, real = real_size(c);
    const size_t stride = (size_t)c->model.stride, row = (size_t)c->model.row;
    int *const node = wb_memory_take(memory, n, sizeof *node);
    double(*const weight)[3] = wb_memory_take(memory, n, sizeof *weight);

    memcpy(node, wire->surface, n * sizeof *node);
    WB_TRY(find_weights(wire, w, weight));
    *out = (struct wb_swept_contact_frames){
        .n_nodes = wire->n_nodes,
        .n_surface = wire->n_surface,
        .node = node,
        .weight = (const double(*)[3])weight,
        .narrow_weight =
            wb_swept_kernel_convert(memory, c->settings.double_precision, weight[0], 3 * n),
        .centre = (double *)wb_swept_take(memory, 3 * row, sizeof(double)) + stride,
        .fixed = wb_swept_take(memory, WB_SWEPT_CONTACT_FIXED * stride, sizeof(double)),
        .turn =
            address(c, wb_swept_take(memory, WB_SWEPT_CONTACT_TURNS * row, real), c->model.stride),
        .inverse = wb_swept_take(memory, WB_SWEPT_CONTACT_INVERSES * stride, real),
        .side = wb_memory_take(memory, (size_t)c->model.n_wires, sizeof(int)),
    };
    c->radius[w] = wire->radius;
    c->youngs_modulus[w] = wire->youngs_modulus;
    c->smallest_radius = fmin(c->smallest_radius, wire->radius);
    return WB_OK;
}

static void take_pair(struct wb_swept_contact *c, struct wb_swept_contact_pair_rows *pair)
{
    struct wb_memory *const memory = &c->memory;
    const size_t stride = (size_t)c->model.stride, row = (size_t)c->model.row;
    const size_t blocks = (size_t)c->model.n_blocks;

    pair->rows = wb_swept_take(memory, WB_SWEPT_CONTACT_PAIR * stride, sizeof(double));
    pair->load = address(c, wb_swept_take(memory, WB_SWEPT_CONTACT_LOAD * row, real_size(c)),
                         c->model.stride);
    pair->active = wb_memory_take(memory, blocks, 1);
    for (int side = 0; side < 2; side++) {
        pair->from[side] = wb_memory_take(memory, blocks, sizeof *pair->from[side]);
        pair->to[side] = wb_memory_take(memory, blocks, sizeof *pair->to[side]);
    }
}

static enum wb_status allocate(struct wb_swept_contact *c, const struct wb_swept_wire *wires)
{
    struct wb_swept_contact_model *m = &c->model;
    const size_t n = (size_t)m->n_wires;

    m->wire = wb_memory_take(&c->memory, n, sizeof *m->wire);
    m->pair = wb_memory_take(&c->memory, (size_t)c->most_pairs, sizeof *m->pair);
    m->sums = wb_memory_take(&c->memory, (size_t)m->n_blocks, sizeof *m->sums);
    c->radius = wb_memory_take(&c->memory, n, sizeof *c->radius);
    c->youngs_modulus = wb_memory_take(&c->memory, n, sizeof *c->youngs_modulus);
    c->searched = wb_memory_take(&c->memory, n * 3 * (size_t)m->n_stations, sizeof *c->searched);
    c->smallest_radius = (double)INFINITY;
    for (int w = 0; w < m->n_wires; w++)
        WB_TRY(take_wire(c, &wires[w], w));
    for (int p = 0; p < c->most_pairs; p++)
        take_pair(c, &m->pair[p]);
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
        .friction = s->friction,
        .damping_time = s->damping_time,
        .counted = wb_swept_range_within(s->counted, n_stations),
    };
    if (!(s->friction.decay > 0.0))
        c->model.friction.mu_kinetic = s->friction.mu_static;
}

enum wb_status wb_swept_contact_create(struct wb_swept_contact **out,
                                       const struct wb_swept_contact_settings *settings,
                                       int n_wires, const struct wb_swept_wire *wires,
                                       int n_stations, double spacing)
{
    enum wb_swept_instructions instructions;

    if (n_wires < 1 || n_wires > MAX_WIRES || n_stations < 2 || n_stations > MAX_STATIONS ||
        !(in_range(spacing, 1e-12, 1e12)))
        return wb_fail(WB_ERR_ARGUMENT,
                       "contact: %d wires, %d stations, spacing %g m: expected 1 to %d wires, 2 "
                       "to %d stations, and 1e-12 to 1e12 m",
                       n_wires, n_stations, spacing, MAX_WIRES, MAX_STATIONS);
    WB_TRY(check_settings(settings));
    WB_TRY(wb_swept_choose_instructions(&instructions, settings->instructions));
    for (int w = 0; w < n_wires; w++)
        WB_TRY(check_wire(&wires[w], w));
    struct wb_swept_contact *const c = wb_memory_new(1, sizeof *c);
    c->settings = *settings;
    c->settings.instructions = instructions;
    c->kernel = kernels[instructions][settings->double_precision];
    c->spacing = spacing;
    size_model(c, n_wires, n_stations);
    const enum wb_status status = allocate(c, wires);
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
    wb_memory_release(&contact->memory);
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
    return wb_swept_instructions_name(contact->settings.instructions);
}

/* --- neighbours and shifts --- */

/* fmax() and fmin() are slow calls here. */
static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

static inline double smaller(double a, double b)
{
    return a < b ? a : b;
}

static void find_tangents(const struct wb_swept_contact *contact)
{
    const int last = contact->model.n_stations - 1;

    for (int w = 0; w < contact->model.n_wires; w++) {
        for (int i = 0; i < 3; i++) {
            const double *c = centre_row(contact, w, i);
            double *row = fixed_row(contact, w, WB_SWEPT_CONTACT_TANGENT + i);
            row[0] = c[1] - c[0];
            row[last] = c[last] - c[last - 1];
            for (int j = 1; j < last; j++)
                row[j] = 0.5 * (c[j + 1] - c[j - 1]);
        }
    }
}

/* The contact positions on both wires for a shift: half of it to either side of the station, or of
 * the nearest station where both wires have a position. */
static void place_of(const struct wb_swept_contact *contact, int j, double shift, double place[2])
{
    const double end = contact->model.n_stations - 1, half = 0.5 * fabs(shift);
    const double middle = larger(half, smaller(end - half, j));

    place[0] = larger(0.0, smaller(end, middle - 0.5 * shift));
    place[1] = larger(0.0, smaller(end, middle + 0.5 * shift));
}

/* Newton's method for (c_b - c_a) (t_a + t_b) = 0. */
static double solve_shift(const struct wb_swept_contact *contact, const int wire[2], int j,
                          double shift, double tolerance)
{
    const double end = contact->model.n_stations - 1;

    for (int i = 0; i < MAX_ITERATIONS; i++) {
        double place[2], apart = 0.0, square = 0.0;
        place_of(contact, j, shift, place);
        for (int c = 0; c < 3; c++) {
            double t = 0.0, x[2];
            for (int side = 0; side < 2; side++) {
                const int w = wire[side];
                x[side] = value_between(contact, centre_row(contact, w, c), place[side]);
                t += value_between(contact, fixed_row(contact, w, WB_SWEPT_CONTACT_TANGENT + c),
                                   place[side]);
            }
            apart += (x[1] - x[0]) * t;
            square += 0.5 * t * t;
        }
        if (!(square > 1e-6 * contact->spacing * contact->spacing))
            return shift;
        const double change = larger(-1.0, smaller(1.0, -apart / square));
        shift = larger(-end, smaller(end, shift + change));
        if (fabs(change) < tolerance)
            break;
    }
    return shift;
}

/* The length within the station's cell where both wires are side by side. */
static double length_of(const struct wb_swept_contact *contact, int j, double shift)
{
    const double half = 0.5 * fabs(shift);
    const double begin = larger(j - 0.5, half);
    const double end = smaller(j + 0.5, contact->model.n_stations - 1 - half);
    return contact->spacing * larger(0.0, end - begin);
}

/* Sets the vector between the contact positions of the previous step. Returns the gap minus the
 * distance by which it may close until the next refresh (with a safety factor of two). A wire that
 * leaves contact was at least one step without contact before its block becomes inactive, so its
 * forces and springs are 0. */
static double begin_between(const struct wb_swept_contact *contact,
                            const struct wb_swept_contact_pair_rows *pair, int j,
                            const double place[2])
{
    double distance = 0.0, closing = 0.0;

    for (int i = 0; i < 3; i++) {
        double now[2], before[2];
        for (int side = 0; side < 2; side++) {
            const int w = pair->wire[side];
            now[side] = value_between(contact, centre_row(contact, w, i), place[side]);
            before[side] = value_between(
                contact, fixed_row(contact, w, WB_SWEPT_CONTACT_BEFORE + i), place[side]);
        }
        const double between = now[1] - now[0];
        const double old = contact->model.started ? before[1] - before[0] : between;
        pair_row(contact, pair, WB_SWEPT_CONTACT_BETWEEN + i)[j] = old;
        distance += between * between;
        closing += (between - old) * (between - old);
    }
    return sqrt(distance) - pair->reach - 2.0 * contact->settings.refresh_interval * sqrt(closing);
}

static double reach_of(const struct wb_swept_contact *contact)
{
    return contact->settings.reach * contact->smallest_radius;
}

static void widen(struct wb_swept_contact_window *window, int low, int high)
{
    if (window->first > window->last)
        *window = (struct wb_swept_contact_window){low, high};
    window->first = low < window->first ? low : window->first;
    window->last = high > window->last ? high : window->last;
}

/* Finds the integer offsets that occur in a pair's rows. */
static void find_windows(const struct wb_swept_contact *contact,
                         struct wb_swept_contact_pair_rows *pair)
{
    const ptrdiff_t row = contact->model.row;

    for (int side = 0; side < 2; side++) {
        const double *offset = pair_row(contact, pair, WB_SWEPT_CONTACT_OFFSET + side);
        for (int b = 0; b < contact->model.n_blocks; b++)
            pair->from[side][b] = pair->to[side][b] = (struct wb_swept_contact_window){0, -1};
        for (int j = 0; j < contact->model.n_stations; j++) {
            const int toward_zero = (int)offset[j];
            const int low = toward_zero - (offset[j] < toward_zero);
            const int high = low + (offset[j] > low);
            widen(&pair->from[side][j / BLOCK], low, high);
            set(contact, pair->load,
                (ptrdiff_t)(WB_SWEPT_CONTACT_SHIFT + side) * contact->model.row + j, offset[j]);
            if (!pair->active[j / BLOCK] ||
                get(contact, pair->load, WB_SWEPT_CONTACT_LENGTH * row + j) == 0.0)
                continue;
            widen(&pair->to[side][(j + low) / BLOCK], low, low);
            widen(&pair->to[side][(j + high) / BLOCK], high, high);
        }
    }
}

static void refresh_pair(const struct wb_swept_contact *contact,
                         struct wb_swept_contact_pair_rows *pair, bool is_new)
{
    double *offset[2], shift = 0.0;

    for (int side = 0; side < 2; side++)
        offset[side] = pair_row(contact, pair, WB_SWEPT_CONTACT_OFFSET + side);
    memset(pair->active, 0, (size_t)contact->model.n_blocks);
    for (int j = 0; j < contact->model.n_stations; j++) {
        double place[2];
        shift = solve_shift(contact, pair->wire, j, is_new ? shift : offset[1][j] - offset[0][j],
                            is_new ? first_tolerance : shift_tolerance);
        place_of(contact, j, shift, place);
        set(contact, pair->load, WB_SWEPT_CONTACT_LENGTH * (ptrdiff_t)contact->model.row + j,
            length_of(contact, j, shift));
        for (int side = 0; side < 2; side++)
            offset[side][j] = place[side] - j;
        if (begin_between(contact, pair, j, place) < reach_of(contact))
            pair->active[j / BLOCK] = 1;
    }
    find_windows(contact, pair);
}

static bool moved_far(const struct wb_swept_contact *contact)
{
    const double far = moved_part * reach_of(contact);
    const int n = contact->model.n_stations;

    for (int w = 0; w < contact->model.n_wires; w++) {
        const double *old = contact->searched + (ptrdiff_t)w * 3 * n;
        const double *x = centre_row(contact, w, WB_SWEPT_CONTACT_CENTRE);
        const double *y = x + contact->model.row, *z = y + contact->model.row;
        for (int j = 0; j < n; j++) {
            const double dx = x[j] - old[j], dy = y[j] - old[n + j], dz = z[j] - old[2 * n + j];
            if (dx * dx + dy * dy + dz * dz > far * far)
                return true;
        }
    }
    return false;
}

/* True if the centre lines come as near as the reach to each other, perpendicular to them, at any
 * station. */
static bool are_neighbours(const struct wb_swept_contact *contact, int a, int b)
{
    const double near = contact->radius[a] + contact->radius[b] + reach_of(contact);

    for (int j = 0; j < contact->model.n_stations; j++) {
        double square = 0.0, along = 0.0, tangent = 0.0;
        for (int i = 0; i < 3; i++) {
            const double t = fixed_row(contact, a, WB_SWEPT_CONTACT_TANGENT + i)[j];
            const double d = centre_row(contact, b, i)[j] - centre_row(contact, a, i)[j];
            square += d * d;
            along += d * t;
            tangent += t * t;
        }
        if (!(square - along * along / larger(tangent, 1e-300) > near * near))
            return true;
    }
    return false;
}

static bool is_known(const struct wb_swept_contact *contact, int a, int b)
{
    for (int p = 0; p < contact->model.n_pairs; p++) {
        if (contact->model.pair[p].wire[0] == a && contact->model.pair[p].wire[1] == b)
            return true;
    }
    return false;
}

static void drop_pairs(struct wb_swept_contact *contact)
{
    struct wb_swept_contact_model *model = &contact->model;

    for (int p = model->n_pairs - 1; p >= 0; p--) {
        if (memchr(model->pair[p].active, 1, (size_t)model->n_blocks))
            continue;
        const struct wb_swept_contact_pair_rows dropped = model->pair[p];
        model->n_pairs--;
        model->pair[p] = model->pair[model->n_pairs];
        model->pair[model->n_pairs] = dropped;
    }
}

/* Initialises a pair of two wires. */
static void begin_pair(const struct wb_swept_contact *contact,
                       struct wb_swept_contact_pair_rows *pair, int a, int b)
{
    const double *radius = contact->radius;

    pair->wire[0] = a;
    pair->wire[1] = b;
    pair->reach = radius[a] + radius[b];
    pair->share[0] = radius[a] / pair->reach;
    pair->share[1] = radius[b] / pair->reach;
    pair->normal = pair_stiffness(contact, a, b);
    pair->tangential = contact->settings.tangential_ratio * pair->normal;
    pair->compliance = 1.0 / pair->tangential;
}

static void add_pair(struct wb_swept_contact *contact, int a, int b)
{
    struct wb_swept_contact_pair_rows *pair = &contact->model.pair[contact->model.n_pairs++];

    begin_pair(contact, pair, a, b);
    memset(pair->rows, 0, sizeof(double) * WB_SWEPT_CONTACT_PAIR * (size_t)contact->model.stride);
    memset(address(contact, pair->load, -contact->model.stride), 0,
           real_size(contact) * WB_SWEPT_CONTACT_LOAD * (size_t)contact->model.row);
    refresh_pair(contact, pair, true);
}

/* Lists the pairs of each wire. */
static void list_sides(struct wb_swept_contact *contact)
{
    const struct wb_swept_contact_model *m = &contact->model;

    for (int w = 0; w < m->n_wires; w++)
        m->wire[w].n_sides = 0;
    for (int i = 0; i < 2 * m->n_pairs; i++) {
        struct wb_swept_contact_frames *wire = &m->wire[m->pair[i / 2].wire[i % 2]];
        wire->side[wire->n_sides++] = i;
    }
}

static enum wb_status find_neighbours(struct wb_swept_contact *contact)
{
    const int n = contact->model.n_stations;

    drop_pairs(contact);
    for (int a = 0; a < contact->model.n_wires; a++) {
        for (int i = 0; i < 3; i++)
            memcpy(contact->searched + ((ptrdiff_t)a * 3 + i) * n, centre_row(contact, a, i),
                   sizeof(double) * (size_t)n);
        for (int b = a + 1; b < contact->model.n_wires; b++) {
            if (is_known(contact, a, b) || !are_neighbours(contact, a, b))
                continue;
            if (contact->model.n_pairs == contact->most_pairs)
                return wb_fail(WB_ERR_MEMORY,
                               "contact: more than the allowed %d pairs of wires are neighbours",
                               contact->most_pairs);
            add_pair(contact, a, b);
        }
    }
    list_sides(contact);
    return WB_OK;
}

/* Finds neighbours, shifts, lengths and windows for the current frames. */
static enum wb_status search(struct wb_swept_contact *contact)
{
    find_tangents(contact);
    for (int p = 0; p < contact->model.n_pairs; p++)
        refresh_pair(contact, &contact->model.pair[p], false);
    if (!contact->model.started || moved_far(contact))
        WB_TRY(find_neighbours(contact));
    return WB_OK;
}

/* --- a step --- */

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
                          "positions of a wire's surface are not finite (step %lld)",
                          contact->step);
    if (contact->step % contact->settings.refresh_interval != 0)
        return WB_OK;
    return search(contact);
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

    if (!wb_swept_is_positive(time_step))
        return wb_fail(WB_ERR_ARGUMENT, "contact: time step %g s: expected a number above 0",
                       time_step);
    wb_swept_contact_gather(contact, position, 0, n);
    WB_TRY(wb_swept_contact_refresh(contact));
    wb_swept_contact_press(contact, time_step, 0, n);
    wb_swept_contact_scatter(contact, force, 0, n);
    return wb_swept_contact_finish(contact, energies);
}

/* --- stable step, and queries --- */

/* The energy of a pair's springs is at most that of springs of twice the stiffness to either wire:
 * k (u_a - u_b)^2 <= 2 k u_a^2 + 2 k u_b^2. On a wire, a displacement u = sum w x has u^2 <= |w|^2
 * sum m x^2 with |w|^2 = sum w^2 / m; selective mass scaling changes it as below. Towards a
 * neighbour w = a; along the axis w = a + r (b cos + e sin); around it w = a, plus for the rotation
 * about the axis at most half the square of the slopes. Of n neighbours around a wire, each
 * direction in the section has the stiffness of n / 2. Stiffnesses and masses are per length. */
double wb_swept_contact_stiffness_per_mass(const struct wb_swept_contact *contact, int wire,
                                           const double *node_mass, double selective)
{
    const struct wb_swept_contact_frames *frames = &contact->model.wire[wire];
    const double r = contact->radius[wire];
    double G[3][3] = {{0.0}}, total = 0.0, normal = 0.0;
    int neighbours = 0;

    for (int k = 0; k < frames->n_nodes; k++) {
        if (!(node_mass[k] > 0.0))
            return (double)INFINITY;
        total += node_mass[k];
    }
    for (int k = 0; k < frames->n_surface; k++) {
        const double *w = frames->weight[k];
        for (int i = 0; i < 9; i++)
            G[i / 3][i % 3] += w[i / 3] * w[i % 3] / (selective * node_mass[frames->node[k]]);
    }
    G[0][0] += (1.0 - 1.0 / selective) / total;
    for (int p = 0; p < contact->model.n_pairs; p++) {
        const struct wb_swept_contact_pair_rows *pair = &contact->model.pair[p];
        if (pair->wire[0] == wire || pair->wire[1] == wire) {
            neighbours++;
            normal = fmax(normal, pair->normal);
        }
    }
    if (neighbours < FEWEST_NEIGHBOURS) {
        neighbours = FEWEST_NEIGHBOURS;
        for (int w = 0; w < contact->model.n_wires; w++)
            normal = fmax(normal, pair_stiffness(contact, wire, w));
    }
    const double tangential = contact->settings.tangential_ratio * normal;
    const double slopes = 0.5 * (G[1][1] + G[2][2]) + hypot(0.5 * (G[1][1] - G[2][2]), G[1][2]);
    const double cross = hypot(G[0][1], G[0][2]);
    const double along = tangential * (G[0][0] + 0.5 * r * r * slopes + r * cross);
    const double across =
        0.5 * (normal + tangential) * G[0][0] + 0.5 * tangential * (r * r * slopes + r * cross);
    return 2.0 * neighbours * fmax(along, across);
}

int wb_swept_contact_pairs(const struct wb_swept_contact *contact)
{
    return contact->model.n_pairs;
}

void wb_swept_contact_get_point(const struct wb_swept_contact *contact, int pair, int station,
                                struct wb_swept_contact_point *out)
{
    const struct wb_swept_contact_pair_rows *of = &contact->model.pair[pair];
    const ptrdiff_t row = contact->model.row;
    double place[2], between[3], square = 0.0;

    for (int side = 0; side < 2; side++)
        place[side] = station + pair_row(contact, of, WB_SWEPT_CONTACT_OFFSET + side)[station];
    for (int i = 0; i < 3; i++) {
        double at[2];
        for (int side = 0; side < 2; side++)
            at[side] = value_between(contact, centre_row(contact, of->wire[side], i), place[side]);
        between[i] = at[1] - at[0];
        square += between[i] * between[i];
    }
    const double distance = sqrt(square);
    *out = (struct wb_swept_contact_point){
        .wire = {of->wire[0], of->wire[1]},
        .stiffness = of->normal,
        .gap = distance - of->reach,
        .length = get(contact, of->load, WB_SWEPT_CONTACT_LENGTH * row + station),
        .shift = place[1] - place[0],
        .normal = of->normal * fmax(0.0, of->reach - distance),
    };
    for (int i = 0; i < 3; i++) {
        out->normal_direction[i] = distance > 0.0 ? between[i] / distance : 0.0;
        out->friction[i] = get(contact, of->load, (WB_SWEPT_CONTACT_DRAG + i) * row + station);
    }
}

/* --- checkpoints --- */

/* Includes unused pairs: their memory is used by later pairs, so sizes are fixed. */
void wb_swept_contact_visit(struct wb_swept_contact *contact, struct wb_checkpoint *checkpoint)
{
    struct wb_swept_contact_model *m = &contact->model;
    const size_t searched = 3 * (size_t)m->n_wires * (size_t)m->n_stations;
    const size_t stride = (size_t)m->stride, row = (size_t)m->row;
    const size_t loads = real_size(contact) * (WB_SWEPT_CONTACT_LOAD * row - 2 * stride);

    wb_checkpoint_enter(checkpoint, "contact");
    wb_checkpoint_visit_member(checkpoint, contact, step);
    wb_checkpoint_visit_member(checkpoint, m, started);
    wb_checkpoint_visit_member(checkpoint, m, n_pairs);
    wb_checkpoint_visit(checkpoint, "searched", contact->searched, searched * sizeof(double));
    for (int w = 0; w < m->n_wires; w++) {
        wb_checkpoint_enter(checkpoint, "wire %d", w + 1);
        wb_checkpoint_visit(checkpoint, "centre", m->wire[w].centre,
                            (3 * row - stride) * sizeof(double));
        wb_checkpoint_visit(checkpoint, "fixed", m->wire[w].fixed,
                            WB_SWEPT_CONTACT_FIXED * stride * sizeof(double));
        wb_checkpoint_leave(checkpoint);
    }
    for (int p = 0; p < contact->most_pairs; p++) {
        struct wb_swept_contact_pair_rows *pair = &m->pair[p];
        wb_checkpoint_enter(checkpoint, "pair %d", p + 1);
        wb_checkpoint_visit_member(checkpoint, pair, wire);
        wb_checkpoint_visit(checkpoint, "active", pair->active, (size_t)m->n_blocks);
        wb_checkpoint_visit(checkpoint, "rows", pair->rows,
                            WB_SWEPT_CONTACT_PAIR * stride * sizeof(double));
        wb_checkpoint_visit(checkpoint, "load", pair->load, loads);
        wb_checkpoint_leave(checkpoint);
    }
    wb_checkpoint_leave(checkpoint);
    if (!checkpoint->restores || checkpoint->status != WB_OK)
        return;
    for (int p = 0; p < m->n_pairs; p++) {
        begin_pair(contact, &m->pair[p], m->pair[p].wire[0], m->pair[p].wire[1]);
        find_windows(contact, &m->pair[p]);
    }
    list_sides(contact);
}
