#include "tests/twin/bundle_static.h"

#include <cblas.h>
#include <float.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/twin/bundle_static_private.h"

#define WB_LOG_DOMAIN "bundle_static"

enum {
    USUAL_ITERATIONS = 25,
    FEW_ITERATIONS = 7, /* after so few the next increment may be longer */
    FROZEN_TIMES = 3,   /* as many iterations */
    MOST_HALVINGS = 5,  /* of an iteration's step */
    MOST_SHIFT = 12     /* elements by which places that face each other may be apart */
};

static const double most_rotation = 0.1; /* rad, of an iteration */
static const double most_ahead = 4.0;    /* of a prediction: last increments */

/* --- the system --- */

static int station_unknown(const struct wb_bundle_static *b, int station, int local)
{
    return station > b->held && local >= 0 ? (station - b->held - 1) * b->block + local : -1;
}

void wb_bundle_static_name_wire(const struct wb_bundle_static *b, int wire, int field, int station,
                                struct wb_bundle_static_place *place)
{
    place->unknown[place->n] = station_unknown(b, station, b->wire[wire].unknown[field]);
    place->sign[place->n++] = field == 2 ? b->wire[wire].sign : 1.0;
}

void wb_bundle_static_name_line(const struct wb_bundle_static *b, int line, int field, int station,
                                struct wb_bundle_static_place *place)
{
    place->unknown[place->n] = station_unknown(b, station, b->line[line].unknown[field]);
    place->sign[place->n++] = field == 2 ? b->line[line].sign : 1.0;
}

void wb_bundle_static_add(struct wb_bundle_static *b, const struct wb_bundle_static_place *place,
                          const double *force, const double *tangent)
{
    const int n = place->n;

    for (int i = 0; i < n; i++) {
        const int row = place->unknown[i];
        if (row < 0)
            continue;
        b->residual[row] += place->sign[i] * force[i];
        for (int k = 0; k < n; k++) {
            const int column = place->unknown[k];
            if (column >= 0)
                b->matrix[(size_t)column * (size_t)b->rows +
                          (size_t)(2 * b->band + row - column)] +=
                    place->sign[i] * place->sign[k] * tangent[n * i + k];
        }
    }
}

/* In elements: between places that face each other. */
static double largest_shift(const struct wb_bundle_static *b)
{
    double shift = 0.0;

    for (int p = 0; p < b->n_pairs; p++)
        for (int j = b->held; j < b->n_stations; j++)
            if (b->pair[p].touch[j].active)
                shift = fmax(shift, fabs(b->pair[p].touch[j].shift));
    return shift;
}

/* Unknowns of stations up to two apart, and farther where wires have slipped past each other. */
static enum wb_status size_band(struct wb_bundle_static *b)
{
    const int apart = (int)fmax(2.0, 2.0 * ceil(0.5 * largest_shift(b)));

    b->band = (int)fmin((apart + 1) * b->block - 1, b->n_unknowns - 1);
    b->rows = 3 * b->band + 1;
    if (b->band > b->most_band || !b->matrix) {
        free(b->matrix);
        b->matrix = malloc((size_t)b->rows * (size_t)b->n_unknowns * sizeof *b->matrix);
        if (!b->matrix)
            return wb_fail(WB_ERR_MEMORY, "out of memory for %d equations", b->n_unknowns);
        b->most_band = b->band;
    }
    return WB_OK;
}

/* --- the tip --- */

static double tip_mean(const struct wb_bundle_static *b, double *state, int field)
{
    double sum = 0.0;

    for (int w = 0; w < b->n_wires; w++) {
        const double start = field == 1 ? b->wire[w].y : 0.0;
        sum += b->wire[w].share *
               (wb_bundle_static_wire_field(b, state, w, field)[b->n_elements] - start);
    }
    return sum;
}

/* The pull per unit of vertical force, x part. */
static double lean_of(const struct wb_bundle_static *b, double *state)
{
    const double length = b->model->loads.strand_length;
    if (!(length > 0.0))
        return 0.0;
    const double lean = (b->model->length - tip_mean(b, state, 0)) / length;
    return lean / sqrt(fmax(DBL_EPSILON, 1.0 - lean * lean));
}

static void find_push(struct wb_bundle_static *b)
{
    const double lean = lean_of(b, b->trial);

    memset(b->push, 0, (size_t)b->n_unknowns * sizeof *b->push);
    for (int w = 0; w < b->n_wires; w++) {
        const int x = station_unknown(b, b->n_elements, b->wire[w].unknown[0]);
        const int y = station_unknown(b, b->n_elements, b->wire[w].unknown[1]);
        b->push[x] += b->wire[w].share * lean;
        b->push[y] += b->wire[w].share;
    }
}

/* How the mean height of the tip changes with the unknowns' increments. */
static double height_of(const struct wb_bundle_static *b, const double *increment)
{
    double sum = 0.0;

    for (int w = 0; w < b->n_wires; w++)
        sum +=
            b->wire[w].share * increment[station_unknown(b, b->n_elements, b->wire[w].unknown[1])];
    return sum;
}

/* --- an iteration --- */

/* The residual, its largest relative size, and the tangent. */
static double evaluate(struct wb_bundle_static *b)
{
    double largest = 0.0;

    memset(b->residual, 0, (size_t)b->n_unknowns * sizeof *b->residual);
    memset(b->matrix, 0, (size_t)b->rows * (size_t)b->n_unknowns * sizeof *b->matrix);
    b->largest_force = 0.0;
    wb_bundle_static_add_wires(b);
    wb_bundle_static_add_contact(b);
    wb_bundle_static_add_tape(b);
    find_push(b);
    for (int i = 0; i < b->n_unknowns; i++) {
        b->residual[i] -= b->trial[b->force_at] * b->push[i];
        const double size = fabs(b->residual[i]) * b->per_unit[i % b->block];
        largest = size > largest || size != size ? size : largest;
    }
    return largest / fmax(b->largest_force, b->smallest_force);
}

static bool solve(struct wb_bundle_static *b)
{
    const int n = b->n_unknowns;

    for (int i = 0; i < n; i++) {
        b->solution[i] = -b->residual[i];
        b->solution[n + i] = b->push[i];
    }
    openblas_set_num_threads(1);
    return LAPACKE_dgbsv_work(LAPACK_COL_MAJOR, n, b->band, b->band, 2, b->matrix, b->rows,
                              b->pivot, b->solution, n) == 0;
}

/* Applies an increment: to strains and rotations of the wires, from which positions follow (added
 * to positions it would stretch what turns), and to openings. */
static void advance(struct wb_bundle_static *b, const double *d, double scale)
{
    for (int w = 0; w < b->n_wires; w++) {
        if (!b->wire[w].leads)
            continue;
        double *t = wb_bundle_static_wire_field(b, b->trial, w, 3);
        double *z = wb_bundle_static_wire_field(b, b->trial, w, 2);
        double *eps = wb_bundle_static_strain(b, b->trial, w, 0);
        double *gamma = wb_bundle_static_strain(b, b->trial, w, 1);
        double before[WB_BUNDLE_STATIC_WIRE] = {0};
        double old = t[b->held];
        for (int e = b->held; e < b->n_elements; e++) {
            double after[WB_BUNDLE_STATIC_WIRE] = {0};
            for (int i = 0; i < WB_BUNDLE_STATIC_WIRE; i++) {
                const int unknown = station_unknown(b, e + 1, b->wire[w].unknown[i]);
                after[i] = unknown < 0 ? 0.0 : scale * d[unknown];
            }
            const double c = cos(0.5 * (old + t[e + 1])), s = sin(0.5 * (old + t[e + 1]));
            const double x_ = (after[0] - before[0]) / b->h, y_ = (after[1] - before[1]) / b->h;
            const double turn = 0.5 * (after[3] + before[3]), was = eps[e];
            eps[e] += c * x_ + s * y_ + gamma[e] * turn;
            gamma[e] += c * y_ - s * x_ - (1.0 + was) * turn;
            old = t[e + 1];
            t[e + 1] += after[3];
            z[e + 1] += after[2];
            memcpy(before, after, sizeof before);
        }
    }
    for (int k = 0; k < b->n_lines; k++)
        for (int i = 0; i < WB_BUNDLE_STATIC_RING && b->line[k].leads; i++)
            for (int j = b->held + 1; j < b->n_stations; j++) {
                const int unknown = station_unknown(b, j, b->line[k].unknown[i]);
                if (unknown >= 0)
                    wb_bundle_static_ring_field(b, b->trial, k, i)[j] += scale * d[unknown];
            }
    wb_bundle_static_place_wires(b, b->trial);
}

/* The share of an increment that turns no node too far. */
static double allowed(const struct wb_bundle_static *b, const double *d)
{
    double turn = 0.0;

    for (int w = 0; w < b->n_wires; w++)
        for (int j = b->held + 1; j < b->n_stations; j++)
            turn = fmax(turn, fabs(d[station_unknown(b, j, b->wire[w].unknown[3])]));
    return turn > most_rotation ? most_rotation / turn : 1.0;
}

/* The saved state and a share of an increment; returns its residual. */
static double try_share(struct wb_bundle_static *b, double scale, double force)
{
    memcpy(b->trial, b->saved, b->state_size * sizeof *b->saved);
    advance(b, b->solution, scale);
    b->trial[b->force_at] += scale * force;
    return evaluate(b);
}

/* Moves the trial state by the increment in `solution`. Contact that opens and closes may make
 * Newton's step a bad one: it is halved as long as that lowers the residual; the first one, which
 * moves the tip, is taken as it is. */
static bool take_step(struct wb_bundle_static *b, double gap, bool first,
                      struct wb_bundle_static_point *point)
{
    double *d = b->solution;
    const double *p = d + b->n_unknowns, was = point->residual;
    const double force =
        b->slack ? -b->trial[b->force_at] : (gap - height_of(b, d)) / height_of(b, p);
    double scale, best = HUGE_VAL;

    for (int k = 0; k < b->n_unknowns; k++)
        d[k] += force * p[k];
    scale = allowed(b, d);
    if (!isfinite(scale) || !isfinite(force))
        return false;
    memcpy(b->saved, b->trial, b->state_size * sizeof *b->saved);
    for (int i = 0; i < MOST_HALVINGS; i++) {
        point->residual = try_share(b, scale, force);
        if (first || point->residual < was)
            break;
        if (point->residual > best) {
            point->residual = try_share(b, 2.0 * scale, force);
            break;
        }
        best = point->residual;
        scale *= 0.5;
    }
    return isfinite(point->residual);
}

/* Newton's method for the trial state with the tip at `target`, or, of a slack strand, without
 * force. Friction is coupled to the normal forces of the same iteration, or, frozen, to those of an
 * outer one: that is slower, and robust where contacts open and close. */
static bool iterate(struct wb_bundle_static *b, double target, struct wb_bundle_static_point *point)
{
    const int usual =
        b->settings.max_iterations > 0 ? b->settings.max_iterations : USUAL_ITERATIONS;
    const int most = b->frozen ? FROZEN_TIMES * usual : usual;

    point->residual = evaluate(b);
    wb_bundle_static_freeze(b);
    for (int i = 0; i < most; i++) {
        double gap = b->slack ? 0.0 : target - tip_mean(b, b->trial, 1);
        point->iterations++;
        if (!isfinite(point->residual) || !solve(b) || !take_step(b, gap, i == 0, point))
            return false;
        gap = b->slack ? 0.0 : target - tip_mean(b, b->trial, 1);
        if (!(point->residual <= b->settings.force_tolerance &&
              fabs(gap) <= 1e-9 * b->model->length))
            continue;
        if (b->frozen) {
            wb_bundle_static_freeze(b);
            point->residual = evaluate(b);
        }
        if (point->residual <= b->settings.force_tolerance)
            return true;
    }
    return false;
}

/* --- increments --- */

/* The line through the last two equilibria, for the leading unknowns; positions follow. */
static void predict(struct wb_bundle_static *b, double ratio, double weight)
{
    for (size_t i = 0; i < b->state_size; i++)
        b->trial[i] = b->committed[i] + ratio * (b->committed[i] - b->earlier[i]);
    b->trial[b->weight_at] = weight;
    wb_bundle_static_place_wires(b, b->trial);
}

static double potential(const struct wb_bundle_static *b, double *state)
{
    double sum = 0.0;

    for (int w = 0; w < b->n_wires; w++) {
        const double *y = wb_bundle_static_wire_field(b, state, w, 1);
        for (int j = 0; j < b->n_stations; j++)
            sum += b->gravity * b->wire[w].mass * wb_bundle_static_length(b, j) * y[j];
    }
    return sum;
}

static void commit(struct wb_bundle_static *b)
{
    const double force = 0.5 * (b->trial[b->force_at] + b->committed[b->force_at]);
    const double lean = 0.5 * (lean_of(b, b->trial) + lean_of(b, b->committed));
    const double weight = 0.5 * (b->trial[b->weight_at] + b->committed[b->weight_at]);
    const size_t elements = (size_t)b->n_wires * (size_t)b->n_elements;
    const size_t points = (size_t)b->n_lines * (size_t)b->n_elements * WB_BUNDLE_STATIC_POINTS;

    b->external += force * (tip_mean(b, b->trial, 1) - tip_mean(b, b->committed, 1) +
                            lean * (tip_mean(b, b->trial, 0) - tip_mean(b, b->committed, 0)));
    b->external -= weight * (potential(b, b->trial) - potential(b, b->committed));
    b->wire_work += wb_bundle_static_wire_work(b);
    b->tape_work += wb_bundle_static_tape_work(b);
    wb_bundle_static_commit_contact(b);
    memcpy(b->earlier, b->committed, b->state_size * sizeof *b->earlier);
    memcpy(b->committed, b->trial, b->state_size * sizeof *b->committed);
    memcpy(b->history, b->trial_history, b->history_size * sizeof *b->history);
    memcpy(b->committed_element, b->element, elements * sizeof *b->element);
    if (points > 0)
        memcpy(b->point, b->trial_point, points * sizeof *b->point);
}

/* Friction coupled first, then frozen. */
static enum wb_status find_equilibrium(struct wb_bundle_static *b, double target, double weight,
                                       double ratio, bool *found,
                                       struct wb_bundle_static_point *point)
{
    *found = false;
    for (int frozen = 0; frozen < 2 && !*found; frozen++) {
        predict(b, ratio, weight);
        wb_bundle_static_face(b);
        if (!(largest_shift(b) <= MOST_SHIFT))
            break;
        WB_TRY(size_band(b));
        b->frozen = frozen == 1;
        *found = iterate(b, target, point);
    }
    return WB_OK;
}

/* One increment to `target`. The strand goes slack where it would push, and is taut again where it
 * would let the tip rise above it. */
static enum wb_status attempt(struct wb_bundle_static *b, double target, double weight,
                              double ratio, bool *done, struct wb_bundle_static_point *point)
{
    const bool was_slack = b->slack, strand = b->model->loads.strand_length > 0.0;

    *done = false;
    for (int change = 0; change < 2 && !*done; change++) {
        bool found;
        WB_TRY(find_equilibrium(b, target, weight, change == 0 && !b->slack ? ratio : 0.0, &found,
                                point));
        if (!found)
            break;
        if (strand && !b->slack && b->trial[b->force_at] < 0.0)
            b->slack = true;
        else if (b->slack && tip_mean(b, b->trial, 1) < target)
            b->slack = false;
        else
            *done = true;
    }
    if (!*done)
        b->slack = was_slack;
    return WB_OK;
}

/* The last equilibrium again, after an attempt that failed. */
static enum wb_status restore(struct wb_bundle_static *b)
{
    predict(b, 0.0, b->committed[b->weight_at]);
    wb_bundle_static_face(b);
    WB_TRY(size_band(b));
    evaluate(b);
    return WB_OK;
}

static void describe(struct wb_bundle_static *b, struct wb_bundle_static_point *point)
{
    double length = 0.0, pressed = 0.0, limit = 0.0;

    point->deflection = tip_mean(b, b->committed, 1);
    point->tip_x = tip_mean(b, b->committed, 0);
    point->vertical = b->committed[b->force_at];
    point->tension = point->vertical * hypot(1.0, lean_of(b, b->committed));
    point->slack = b->slack;
    for (int p = 0; p < b->n_pairs; p++)
        for (int j = b->held; j < b->n_stations; j++) {
            const struct wb_bundle_static_touch *touch = &b->pair[p].touch[j];
            const double share = wb_bundle_static_length(b, j);
            length += share;
            if (!touch->active)
                continue;
            point->largest_slip = fmax(point->largest_slip, fabs(touch->shift) * b->h);
            if (!(touch->normal + b->settings.squeeze > 0.0))
                continue;
            pressed += share;
            limit += touch->limit ? share : 0.0;
            point->normal += share * touch->normal;
            point->deepest = fmax(point->deepest, touch->depth);
        }
    point->pressed = length > 0.0 ? pressed / length : 0.0;
    point->slipping = pressed > 0.0 ? limit / pressed : 0.0;
    point->tape_strain = wb_bundle_static_tape_strain(b);
}

enum wb_status wb_bundle_static_move(struct wb_bundle_static *b, double deflection,
                                     struct wb_bundle_static_point *point)
{
    const double largest = b->settings.largest_increment > 0.0 ? b->settings.largest_increment
                                                               : b->model->length / 200.0;
    const double smallest =
        b->settings.smallest_increment > 0.0 ? b->settings.smallest_increment : 1e-3 * largest;
    const double start = b->target, start_weight = b->committed[b->weight_at];
    const double weight = b->gravity > 0.0 ? 1.0 : 0.0;
    double way = 0.0, step = largest;

    if (!isfinite(deflection))
        return wb_fail(WB_ERR_ARGUMENT, "a deflection of %g m", deflection);
    *point = (struct wb_bundle_static_point){.end = WB_BUNDLE_STATIC_CONVERGED};
    /* Where only the weight comes on, the way is counted as if it were one of deflection. */
    const double whole = fmax(fabs(deflection - start), weight > start_weight ? largest : 0.0);
    while (way < whole) {
        if (step > 0.9 * (whole - way))
            step = whole - way; /* no increment of what rounding leaves */
        const double part = way + step >= whole ? 1.0 : (way + step) / whole;
        const double target = start + part * (deflection - start);
        const double now = start_weight + part * (weight - start_weight);
        const double change = target - b->target;
        const double ratio = b->last_step * change > 0.0 && now == b->committed[b->weight_at]
                                 ? fmin(change / b->last_step, most_ahead)
                                 : 0.0;
        const int before = point->iterations;
        bool done;
        WB_TRY(attempt(b, target, now, ratio, &done, point));
        if (done) {
            commit(b);
            b->last_step = change;
            b->target = target;
            way = part == 1.0 ? whole : way + step;
            point->increments++;
            if (point->iterations - before <= FEW_ITERATIONS)
                step = fmin(1.5 * step, largest);
            continue;
        }
        point->cutbacks++;
        step *= 0.5;
        if (step < smallest) {
            point->end = WB_BUNDLE_STATIC_NOT_CONVERGED;
            snprintf(point->problem, sizeof point->problem,
                     "no equilibrium was found beyond a deflection of %.4f mm with an increment of "
                     "%.1e mm (residual %.1e)",
                     b->target * 1e3, step * 2e3, point->residual);
            WB_TRY(restore(b));
            break;
        }
    }
    describe(b, point);
    b->last = *point;
    return WB_OK;
}

/* --- what it tells --- */

void wb_bundle_static_shape(const struct wb_bundle_static *b, int n, const double *s,
                            double (*shape)[2])
{
    for (int i = 0; i < n; i++) {
        const double along = fmin(fmax(s[i] / b->h, 0.0), b->n_elements);
        const int j = (int)fmin(floor(along), b->n_elements - 1.0);
        const double t = along - j;
        shape[i][0] = shape[i][1] = 0.0;
        for (int w = 0; w < b->n_wires; w++)
            for (int c = 0; c < 2; c++) {
                const double *x = wb_bundle_static_wire_field(b, b->committed, w, c);
                const double start = c == 1 ? b->wire[w].y : 0.0;
                shape[i][c] += b->wire[w].share * ((1.0 - t) * x[j] + t * x[j + 1] - start);
            }
    }
}

void wb_bundle_static_get_wire(const struct wb_bundle_static *b, int wire, int station,
                               struct wb_bundle_static_wire *out)
{
    const int e = station > 0 ? station - 1 : 0;
    const int leads = b->wire[wire].leads ? wire : b->wire[wire].mirror;
    const struct wb_bundle_static_element *element =
        &b->committed_element[(size_t)leads * (size_t)b->n_elements + (size_t)e];

    *out = (struct wb_bundle_static_wire){
        .x = wb_bundle_static_wire_field(b, b->committed, wire, 0)[station],
        .y = wb_bundle_static_wire_field(b, b->committed, wire, 1)[station],
        .z = wb_bundle_static_wire_field(b, b->committed, wire, 2)[station],
        .angle = wb_bundle_static_wire_field(b, b->committed, wire, 3)[station],
        .stretch = element->strain[0],
        .shear = element->strain[1],
        .curvature = element->strain[2],
        .normal = element->force[0],
        .transverse = element->force[1],
        .moment = element->force[2],
    };
}

void wb_bundle_static_get_energies(const struct wb_bundle_static *b,
                                   struct wb_bundle_static_energies *energies)
{
    *energies = (struct wb_bundle_static_energies){
        .external = b->external,
        .wires = b->wire_work,
        .tape = b->tape_work,
        .bonds = wb_bundle_static_bond_energy(b),
    };
    wb_bundle_static_contact_energy(b, &energies->contact, &energies->friction);
}
