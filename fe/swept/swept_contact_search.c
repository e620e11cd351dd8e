#include "fe/swept/swept_contact_private.h"

#include <math.h>
#include <string.h>

#define WB_LOG_DOMAIN "contact"

enum {
    BLOCK = WB_SWEPT_LANES,
    MOST_ITERATIONS = 60
};

/* Shifts are found to this part of a station; the energy is stationary there. Of pairs that are
 * new as exactly as can be: then it is of no account where one began, so that parts of a bundle
 * find what the whole does. */
static const double shift_tolerance = 1e-4, first_tolerance = 1e-12;

/* Neighbours are searched anew when a centre moved by this part of the reach. Two of them then are
 * nearer by at most twice that, and half of the reach is left for what follows till the next
 * refresh. */
static const double moved_part = 0.25;

/* Library functions are calls here. */
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
            const double *c = wb_swept_contact_centre_row(contact, w, i);
            double *row = wb_swept_contact_fixed_row(contact, w, WB_SWEPT_CONTACT_TANGENT + i);
            row[0] = c[1] - c[0];
            row[last] = c[last] - c[last - 1];
            for (int j = 1; j < last; j++)
                row[j] = 0.5 * (c[j + 1] - c[j - 1]);
        }
    }
}

/* The places on both wires for a shift: half of it either way from the station, or from as near to
 * it as both have a place. */
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

    for (int i = 0; i < MOST_ITERATIONS; i++) {
        double place[2], apart = 0.0, square = 0.0;
        place_of(contact, j, shift, place);
        for (int c = 0; c < 3; c++) {
            double t = 0.0, x[2];
            for (int side = 0; side < 2; side++) {
                const int w = wire[side];
                x[side] = wb_swept_contact_between(
                    contact, wb_swept_contact_centre_row(contact, w, c), place[side]);
                t += wb_swept_contact_between(
                    contact, wb_swept_contact_fixed_row(contact, w, WB_SWEPT_CONTACT_TANGENT + c),
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

/* Of the station's cell, what both wires have beside each other. */
static double length_of(const struct wb_swept_contact *contact, int j, double shift)
{
    const double half = 0.5 * fabs(shift);
    const double begin = larger(j - 0.5, half);
    const double end = smaller(j + 0.5, contact->model.n_stations - 1 - half);
    return contact->spacing * larger(0.0, end - begin);
}

/* Sets the vector between the places of the step before. Returns the gap, less what it may close
 * until the next refresh (with a factor of safety of two). What leaves is as fast as far: before
 * its block becomes inactive it has been pressed once apart, which left its forces and springs at
 * 0. */
static double begin_between(const struct wb_swept_contact *contact,
                            const struct wb_swept_contact_pair_rows *pair, int j,
                            const double place[2])
{
    double distance = 0.0, closing = 0.0;

    for (int i = 0; i < 3; i++) {
        double now[2], before[2];
        for (int side = 0; side < 2; side++) {
            const int w = pair->wire[side];
            now[side] = wb_swept_contact_between(
                contact, wb_swept_contact_centre_row(contact, w, i), place[side]);
            before[side] = wb_swept_contact_between(
                contact, wb_swept_contact_fixed_row(contact, w, WB_SWEPT_CONTACT_BEFORE + i),
                place[side]);
        }
        const double between = now[1] - now[0];
        const double old = contact->model.started ? before[1] - before[0] : between;
        wb_swept_contact_pair_row(contact, pair, WB_SWEPT_CONTACT_BETWEEN + i)[j] = old;
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

void wb_swept_contact_search_windows(const struct wb_swept_contact *contact,
                                     struct wb_swept_contact_pair_rows *pair)
{
    const ptrdiff_t row = contact->model.row;

    for (int side = 0; side < 2; side++) {
        const double *offset =
            wb_swept_contact_pair_row(contact, pair, WB_SWEPT_CONTACT_OFFSET + side);
        for (int b = 0; b < contact->model.n_blocks; b++)
            pair->from[side][b] = pair->to[side][b] = (struct wb_swept_contact_window){0, -1};
        for (int j = 0; j < contact->model.n_stations; j++) {
            const int toward_zero = (int)offset[j];
            const int low = toward_zero - (offset[j] < toward_zero);
            const int high = low + (offset[j] > low);
            widen(&pair->from[side][j / BLOCK], low, high);
            wb_swept_contact_set(
                contact, pair->load,
                (ptrdiff_t)(WB_SWEPT_CONTACT_SHIFT + side) * contact->model.row + j, offset[j]);
            if (!pair->active[j / BLOCK] ||
                wb_swept_contact_get(contact, pair->load, WB_SWEPT_CONTACT_LENGTH * row + j) == 0.0)
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
        offset[side] = wb_swept_contact_pair_row(contact, pair, WB_SWEPT_CONTACT_OFFSET + side);
    memset(pair->active, 0, (size_t)contact->model.n_blocks);
    for (int j = 0; j < contact->model.n_stations; j++) {
        double place[2];
        shift = solve_shift(contact, pair->wire, j, is_new ? shift : offset[1][j] - offset[0][j],
                            is_new ? first_tolerance : shift_tolerance);
        place_of(contact, j, shift, place);
        wb_swept_contact_set(contact, pair->load,
                             WB_SWEPT_CONTACT_LENGTH * (ptrdiff_t)contact->model.row + j,
                             length_of(contact, j, shift));
        for (int side = 0; side < 2; side++)
            offset[side][j] = place[side] - j;
        if (begin_between(contact, pair, j, place) < reach_of(contact))
            pair->active[j / BLOCK] = 1;
    }
    wb_swept_contact_search_windows(contact, pair);
}

static bool moved_far(const struct wb_swept_contact *contact)
{
    const double far = moved_part * reach_of(contact);
    const int n = contact->model.n_stations;

    for (int w = 0; w < contact->model.n_wires; w++) {
        const double *old = contact->searched + (ptrdiff_t)w * 3 * n;
        const double *x = wb_swept_contact_centre_row(contact, w, WB_SWEPT_CONTACT_CENTRE);
        const double *y = x + contact->model.row, *z = y + contact->model.row;
        for (int j = 0; j < n; j++) {
            const double dx = x[j] - old[j], dy = y[j] - old[n + j], dz = z[j] - old[2 * n + j];
            if (dx * dx + dy * dy + dz * dz > far * far)
                return true;
        }
    }
    return false;
}

/* Whether the centre lines come so near to each other, across them, at any station. */
static bool are_neighbours(const struct wb_swept_contact *contact, int a, int b)
{
    const double near = contact->radius[a] + contact->radius[b] + reach_of(contact);

    for (int j = 0; j < contact->model.n_stations; j++) {
        double square = 0.0, along = 0.0, tangent = 0.0;
        for (int i = 0; i < 3; i++) {
            const double t =
                wb_swept_contact_fixed_row(contact, a, WB_SWEPT_CONTACT_TANGENT + i)[j];
            const double d = wb_swept_contact_centre_row(contact, b, i)[j] -
                             wb_swept_contact_centre_row(contact, a, i)[j];
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

void wb_swept_contact_search_pair(const struct wb_swept_contact *contact,
                                  struct wb_swept_contact_pair_rows *pair, int a, int b)
{
    const double *radius = contact->radius;

    pair->wire[0] = a;
    pair->wire[1] = b;
    pair->reach = radius[a] + radius[b];
    pair->share[0] = radius[a] / pair->reach;
    pair->share[1] = radius[b] / pair->reach;
    pair->normal = wb_swept_contact_stiffness(contact, a, b);
    pair->tangential = contact->settings.tangential_ratio * pair->normal;
    pair->compliance = 1.0 / pair->tangential;
}

static void add_pair(struct wb_swept_contact *contact, int a, int b)
{
    struct wb_swept_contact_pair_rows *pair = &contact->model.pair[contact->model.n_pairs++];

    wb_swept_contact_search_pair(contact, pair, a, b);
    memset(pair->rows, 0, sizeof(double) * WB_SWEPT_CONTACT_PAIR * (size_t)contact->model.stride);
    memset(wb_swept_contact_at(contact, pair->load, -contact->model.stride), 0,
           wb_swept_contact_real_size(contact) * WB_SWEPT_CONTACT_LOAD *
               (size_t)contact->model.row);
    refresh_pair(contact, pair, true);
}

void wb_swept_contact_search_sides(struct wb_swept_contact *contact)
{
    const struct wb_swept_contact_model *m = &contact->model;
    int n = 0;

    for (int w = 0; w < m->n_wires; w++) {
        m->wire[w].side = contact->side_memory + n;
        m->wire[w].n_sides = 0;
        for (int p = 0; p < m->n_pairs; p++) {
            for (int side = 0; side < 2; side++) {
                if (m->pair[p].wire[side] == w)
                    m->wire[w].side[m->wire[w].n_sides++] = 2 * p + side;
            }
        }
        n += m->wire[w].n_sides;
    }
}

static enum wb_status find_neighbours(struct wb_swept_contact *contact)
{
    const int n = contact->model.n_stations;

    drop_pairs(contact);
    for (int a = 0; a < contact->model.n_wires; a++) {
        for (int i = 0; i < 3; i++)
            memcpy(contact->searched + ((ptrdiff_t)a * 3 + i) * n,
                   wb_swept_contact_centre_row(contact, a, i), sizeof(double) * (size_t)n);
        for (int b = a + 1; b < contact->model.n_wires; b++) {
            if (is_known(contact, a, b) || !are_neighbours(contact, a, b))
                continue;
            if (contact->model.n_pairs == contact->most_pairs)
                return wb_fail(WB_ERR_MEMORY, "more than %d pairs of wires beside each other",
                               contact->most_pairs);
            add_pair(contact, a, b);
        }
    }
    wb_swept_contact_search_sides(contact);
    return WB_OK;
}

enum wb_status wb_swept_contact_search(struct wb_swept_contact *contact)
{
    find_tangents(contact);
    for (int p = 0; p < contact->model.n_pairs; p++)
        refresh_pair(contact, &contact->model.pair[p], false);
    if (!contact->model.started || moved_far(contact))
        WB_TRY(find_neighbours(contact));
    return WB_OK;
}
