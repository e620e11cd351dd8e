#include "fe/trial/three_point_bending.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fe/linear/band.h"
#include "fe/rod/beam.h"
#include "fe/trial/roller.h"
#include "fe/trial/three_point_bending_private.h"

#define WB_LOG_DOMAIN "three-point"

enum {
    DEFAULT_ELEMENTS = 80,
    MAX_ROLLERS = 2,
    NODES = WB_BEAM_ELEMENT_NODES,
    WIDTH = 3 * NODES - 1, /* bandwidth: all unknowns of an element are coupled */
    MAX_ITERATIONS = 40,
    MAX_MOVE_ITERATIONS = 2000, /* iterations of a move */
    MAX_ZERO_ITERATIONS = 40
};

static const double default_overhang = 0.3; /* of the span */

/* Stiffness of a contact relative to that of a simply supported elastic beam, 48 E I / L^3. The
 * nose's is lower because its nodes make and lose contact: with 1e5 Newton's method takes twice as
 * many iterations. */
static const double roller_stiffness = 1e5, nose_stiffness = 2e4;
/* Tangential stiffness of a sticking roller, on the same scale: friction reverses over a slip of
 * about 1e-4 of the deflection. */
static const double sticking_stiffness = 1e3;

static const double force_tolerance = 1e-9; /* residual over the largest internal force */
/* Limit of a node's rotation in an iteration, rad. */
static const double max_iteration_rotation = 0.3;
static const double smallest_step = 1e-7; /* of a sub-step, over the span */
static const double first_step = 2e-3;    /* of the virgin wire, over the span */
static const double turning_step = 5e-5;  /* after the nose reverses, over the span */
/* Longest sub-step over the span, and over the nose's radius including the wire's, so that the wire
 * cannot pass through the nose. */
static const double longest_step = 0.02, longest_over_nose = 0.25;

struct nose {
    double force; /* on the nose, upwards, N; of the computed half or whole wire */
    /* Angles of the first and last touching node, rad; no contact if first > last. */
    double first, last;
    int nearest; /* node */
};

/* State after a converged step, except for the beam. */
struct state {
    double level; /* of the nose, as deflection in m */
    double last_step;
    double step; /* of the last accepted sub-step, m */
    double force, largest_force;
    double work, internal_work, friction_work;
    bool slack;
    double contact_level;
    struct wb_roller_state roller[MAX_ROLLERS];
};

struct wb_three_point_bending {
    /* The section is cleared: it is borrowed during creation. */
    struct wb_three_point_bending_model model;
    struct wb_beam *beam;
    int n_nodes, middle; /* the node held at x = 0 */
    double middle_arc;   /* of it, m */
    int n_rollers;
    struct wb_roller roller[MAX_ROLLERS];
    struct wb_roller_state at_rest[MAX_ROLLERS];
    double parts;       /* wire over computed wire: 1, or 2 if half is computed */
    double nose_radius; /* including half the wire's diameter, m */
    double nose_level;  /* y of the nose's axis at first contact, m */
    double stiffness;   /* of contacts, N/m */
    struct state state;

    /* The trial step. */
    struct nose nose;
    struct wb_roller_contact contact[MAX_ROLLERS];
    double residual, tolerance;
    int iterations;
    bool off; /* the wire slipped off a roller */

    double (*unbalanced)[3]; /* (n_nodes) */
    double *increment;       /* (n_nodes x 3) */
    struct wb_band band;
    struct wb_memory memory;
};

/* The beam's first node is the middle (half wire) or the left end. */
static double curvature_of(void *context, double arc)
{
    const struct wb_three_point_bending *b = context;
    return b->model.natural_curvature(b->model.curvature_context, arc - b->middle_arc);
}

static enum wb_status check_model(const struct wb_three_point_bending_model *m)
{
    const double lengths[] = {m->overhang, m->support_radius, m->nose_radius, m->friction,
                              m->compliance};
    if (!m->section)
        return wb_fail(WB_ERR_ARGUMENT, "the model has no section");
    if (!(isfinite(m->span) && m->span > 0.0 && isfinite(m->diameter) && m->diameter > 0.0))
        return wb_fail(WB_ERR_ARGUMENT, "span %g m, diameter %g m: expected numbers above 0",
                       m->span, m->diameter);
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        if (!(isfinite(lengths[i]) && lengths[i] >= 0.0))
            return wb_fail(WB_ERR_ARGUMENT,
                           "overhang %g m, radii %g and %g m, friction %g, compliance %g m/N: "
                           "expected 0 or more",
                           m->overhang, m->support_radius, m->nose_radius, m->friction,
                           m->compliance);
    }
    return WB_OK;
}

static void take_memory(struct wb_three_point_bending *b)
{
    const size_t nodes = (size_t)b->n_nodes;
    b->unbalanced = wb_memory_take(&b->memory, nodes, sizeof *b->unbalanced);
    b->increment = wb_memory_take(&b->memory, 3 * nodes, sizeof *b->increment);
    b->band.n = 3 * b->n_nodes;
    b->band.width = WIDTH;
    b->band.values =
        wb_memory_take(&b->memory, 3 * nodes * (size_t)wb_band_row(WIDTH), sizeof *b->band.values);
}

/* Gaps at the rollers when the wire's middle is at (0, y) and rotated by `turn`; false if the wire
 * does not reach a roller. */
static bool gap_at(struct wb_three_point_bending *b, double y, double turn, double gap[MAX_ROLLERS])
{
    struct wb_beam_node first = {0.0, 0.0, 0.0};

    wb_beam_place(b->beam, &first);
    const struct wb_beam_node middle = wb_beam_nodes(b->beam)[b->middle];
    /* Rotate the wire about its middle until its slope there is `turn`. */
    const double a = turn - middle.t, c = cos(a), s = sin(a);
    first =
        (struct wb_beam_node){-(c * middle.x - s * middle.y), y - (s * middle.x + c * middle.y), a};
    wb_beam_place(b->beam, &first);
    for (int i = 0; i < b->n_rollers; i++) {
        struct wb_roller_place place;
        if (!wb_roller_find(&b->roller[i], b->beam, b->at_rest[i].arc, &place))
            return false;
        gap[i] = place.distance - b->roller[i].radius;
        b->at_rest[i].arc = place.arc;
        b->at_rest[i].angle = place.angle;
    }
    return true;
}

/* Places the virgin wire on the rollers and the nose on the wire. */
static enum wb_status place_wire(struct wb_three_point_bending *b)
{
    const double small = 1e-6 * b->model.span;
    double y = 0.0, turn = 0.0, gap[MAX_ROLLERS] = {0}, more[MAX_ROLLERS] = {0};
    bool found = false;

    for (int i = 0; i < b->n_rollers; i++)
        b->at_rest[i] =
            (struct wb_roller_state){.arc = b->middle_arc + (i == 0 ? 0.5 : -0.5) * b->model.span};
    for (int iteration = 0; iteration < 50 && !found; iteration++) {
        if (!gap_at(b, y, turn, gap))
            break;
        const double miss = fmax(fabs(gap[0]), fabs(gap[1]));
        found = miss <= 1e-13 * b->model.span;
        if (found)
            break;
        if (b->n_rollers == 1) {
            if (!gap_at(b, y + small, turn, more))
                break;
            y -= gap[0] * small / (more[0] - gap[0]);
        } else {
            const double angle = small / b->model.span;
            double by_turn[MAX_ROLLERS];
            if (!gap_at(b, y + small, turn, more) || !gap_at(b, y, turn + angle, by_turn))
                break;
            const double yy[2] = {(more[0] - gap[0]) / small, (more[1] - gap[1]) / small};
            const double tt[2] = {(by_turn[0] - gap[0]) / angle, (by_turn[1] - gap[1]) / angle};
            const double determinant = yy[0] * tt[1] - yy[1] * tt[0];
            y -= (gap[0] * tt[1] - gap[1] * tt[0]) / determinant;
            turn -= (yy[0] * gap[1] - yy[1] * gap[0]) / determinant;
        }
        found = miss <= 1e-11 * b->model.span;
    }
    if (!found || !gap_at(b, y, turn, gap))
        return wb_fail(
            WB_ERR_ARGUMENT,
            "the wire does not rest on rollers %g mm apart: its natural curvature is too "
            "large, or it is too short",
            1e3 * b->model.span);

    const struct wb_beam_node *node = wb_beam_nodes(b->beam);
    b->nose_level = -HUGE_VAL;
    for (int i = 0; i < b->n_nodes; i++) {
        const double x = node[i].x, r = b->nose_radius;
        if (fabs(x) < r)
            b->nose_level = fmax(b->nose_level, node[i].y + sqrt(r * r - x * x));
    }
    return WB_OK;
}

static enum wb_status start_at_rest(struct wb_three_point_bending *b)
{
    WB_TRY(place_wire(b));
    b->state = (struct state){
        .slack = true,
        .step = fmin(first_step * b->model.span, longest_over_nose * b->nose_radius)};
    memcpy(b->state.roller, b->at_rest, sizeof b->at_rest);
    return WB_OK;
}

enum wb_status wb_three_point_bending_create(struct wb_three_point_bending **out,
                                             const struct wb_three_point_bending_model *model)
{
    *out = NULL;
    WB_TRY(check_model(model));

    struct wb_three_point_bending *const b = wb_memory_new(1, sizeof *b);
    b->model = *model;
    if (b->model.overhang == 0.0)
        b->model.overhang = default_overhang * model->span;
    if (b->model.n_elements == 0)
        b->model.n_elements = DEFAULT_ELEMENTS;
    const double half = 0.5 * model->span + b->model.overhang;
    b->n_rollers = model->whole ? 2 : 1;
    b->parts = model->whole ? 1.0 : 2.0;
    b->middle = model->whole ? 2 * b->model.n_elements : 0;
    b->middle_arc = model->whole ? half : 0.0;
    b->nose_radius = model->nose_radius + 0.5 * model->diameter;

    const struct wb_beam_model beam = {
        .section = model->section,
        .length = model->whole ? 2.0 * half : half,
        .n_elements = model->whole ? 2 * b->model.n_elements : b->model.n_elements,
    };
    enum wb_status status = wb_beam_create(&b->beam, &beam);
    if (status == WB_OK) {
        b->n_nodes = wb_beam_count_nodes(b->beam);
        take_memory(b);
        /* wb_beam_scale_force() is E I / length^2. */
        const double EI = wb_beam_scale_force(b->beam) * beam.length * beam.length;
        const double stiffness = 48.0 * EI / pow(model->span, 3);
        b->stiffness = nose_stiffness * stiffness;
        for (int i = 0; i < b->n_rollers; i++)
            b->roller[i] = (struct wb_roller){
                .x = (i == 0 ? 0.5 : -0.5) * model->span,
                .y = -(model->support_radius + 0.5 * model->diameter),
                .radius = model->support_radius + 0.5 * model->diameter,
                .wire_radius = 0.5 * model->diameter,
                .friction = model->friction,
                .stiffness = roller_stiffness * stiffness,
                .sticking = sticking_stiffness * stiffness,
            };
        if (model->natural_curvature)
            status = wb_beam_set_curvature(b->beam, curvature_of, b);
        if (status == WB_OK)
            status = start_at_rest(b);
    }
    if (status != WB_OK) {
        wb_three_point_bending_destroy(b);
        return status;
    }
    b->model.section = NULL;
    *out = b;
    return WB_OK;
}

void wb_three_point_bending_destroy(struct wb_three_point_bending *bending)
{
    if (!bending)
        return;
    wb_beam_destroy(bending->beam);
    wb_memory_release(&bending->memory);
    free(bending);
}

void wb_three_point_bending_reset(struct wb_three_point_bending *bending)
{
    wb_beam_reset(bending->beam);
    /* Cannot fail: it succeeded during creation. */
    (void)start_at_rest(bending);
}

enum wb_status wb_three_point_bending_set_law(struct wb_three_point_bending *bending,
                                              const struct wb_law *law)
{
    WB_TRY(wb_beam_set_law(bending->beam, law));
    wb_three_point_bending_reset(bending);
    return WB_OK;
}

enum wb_status wb_three_point_bending_set_curvature(struct wb_three_point_bending *bending,
                                                    double (*natural_curvature)(void *context,
                                                                                double from_middle),
                                                    void *context)
{
    bending->model.natural_curvature = natural_curvature;
    bending->model.curvature_context = context;
    WB_TRY(wb_beam_set_curvature(bending->beam, natural_curvature ? curvature_of : NULL, bending));
    return start_at_rest(bending);
}

double wb_three_point_bending_contact_level(const struct wb_three_point_bending *bending)
{
    return bending->state.contact_level;
}

/* --- the nose --- */

static double node_stiffness(const struct wb_three_point_bending *b, int node)
{
    /* Half of the middle node's contact belongs to the half that is not computed. */
    return b->parts == 2.0 && node == b->middle ? 0.5 * b->stiffness : b->stiffness;
}

/* Adds the nose's force at one node; with `held` also a pulling force. */
static void press_node(struct wb_three_point_bending *b, int i, double nose_y, bool held,
                       bool with_tangent)
{
    const struct wb_beam_node *node = &wb_beam_nodes(b->beam)[i];
    const double rx = node->x, ry = node->y - nose_y;
    const double distance = hypot(rx, ry);
    const double depth = b->nose_radius - distance;
    if (!(depth > 0.0) && !held)
        return;

    const double k = node_stiffness(b, i);
    const double nx = rx / distance, ny = ry / distance;
    b->unbalanced[i][0] -= k * depth * nx;
    b->unbalanced[i][1] -= k * depth * ny;
    b->nose.force -= k * depth * ny;
    const double angle = atan2(rx, -ry);
    b->nose.first = fmin(b->nose.first, angle);
    b->nose.last = fmax(b->nose.last, angle);
    if (!with_tangent)
        return;
    const double side = k * depth / distance;
    wb_band_add(&b->band, 3 * i, 3 * i, k * nx * nx - side * (1.0 - nx * nx));
    wb_band_add(&b->band, 3 * i + 1, 3 * i + 1, k * ny * ny - side * (1.0 - ny * ny));
    wb_band_add(&b->band, 3 * i, 3 * i + 1, (k + side) * nx * ny);
    wb_band_add(&b->band, 3 * i + 1, 3 * i, (k + side) * nx * ny);
}

/* Adds the nose's forces. If no node touches, the nearest one is attached to the nose, so that the
 * wire stays in equilibrium while the solver searches for zero force; its force is then
 * negative. */
static void press(struct wb_three_point_bending *b, double level, bool with_tangent)
{
    const struct wb_beam_node *node = wb_beam_nodes(b->beam);
    const double y = b->nose_level - level;
    double least = HUGE_VAL;

    b->nose = (struct nose){.first = HUGE_VAL, .last = -HUGE_VAL};
    for (int i = 0; i < b->n_nodes; i++) {
        const double distance = hypot(node[i].x, node[i].y - y);
        if (distance < least) {
            least = distance;
            b->nose.nearest = i;
        }
    }
    const bool held = !(least < b->nose_radius);
    for (int i = 0; i < b->n_nodes; i++)
        press_node(b, i, y, held && i == b->nose.nearest, with_tangent);
}

/* --- equilibrium --- */

/* The largest component of a node's forces. Plain comparisons, because fmax() is a slow call and
 * all values are finite. */
static double size_of(const double force[3], double lever)
{
    const double x = fabs(force[0]), y = fabs(force[1]), t = fabs(force[2]) * lever;
    const double larger = x > y ? x : y;
    return larger > t ? larger : t;
}

/* The middle's x is fixed; for half a wire its rotation, too. */
static bool is_held(const struct wb_three_point_bending *b, int node, int k)
{
    return node == b->middle && (k == 0 || (k == 2 && b->parts == 2.0));
}

/* Computes the unbalanced forces of the trial state with the nose at `level`, and the tolerance for
 * equilibrium. False if the wire has slipped off a roller. */
static bool evaluate(struct wb_three_point_bending *b, double level, bool with_tangent)
{
    struct wb_beam_balance balance;
    const double lever = 1.0 / b->model.span;

    wb_beam_evaluate(b->beam, 1.0, &balance);
    memcpy(b->unbalanced, wb_beam_residuals(b->beam), (size_t)b->n_nodes * sizeof *b->unbalanced);
    if (with_tangent) {
        wb_band_clear(&b->band);
        for (int e = 0; 2 * e + 1 < b->n_nodes; e++) {
            struct wb_beam_element_stiffness K;
            wb_beam_element_tangent(b->beam, e, &K);
            const double *blocks[NODES][NODES] = {
                {K.K11, K.K12, K.K13}, {NULL, K.K22, K.K23}, {NULL, NULL, K.K33}};
            for (int i = 0; i < NODES; i++) {
                for (int j = 0; j < NODES; j++) {
                    for (int k = 0; k < 9; k++)
                        wb_band_add(&b->band, 3 * (2 * e + i) + k / 3, 3 * (2 * e + j) + k % 3,
                                    i <= j ? blocks[i][j][k] : blocks[j][i][3 * (k % 3) + k / 3]);
                }
            }
        }
    }
    press(b, level, with_tangent);
    b->off = false;
    for (int i = 0; i < b->n_rollers; i++) {
        if (!wb_roller_press(&b->roller[i], b->beam, &b->state.roller[i], &b->contact[i])) {
            b->off = true;
            return false;
        }
        const int node = 2 * b->contact[i].place.element;
        for (int r = 0; r < 3 * NODES; r++) {
            b->unbalanced[node + r / 3][r % 3] -= b->contact[i].force[r];
            for (int c = 0; c < 3 * NODES && with_tangent; c++)
                wb_band_add(&b->band, 3 * node + r, 3 * node + c, -b->contact[i].tangent[r][c]);
        }
    }
    double largest = 0.0;
    for (int i = 0; i < b->n_nodes; i++) {
        for (int k = 0; k < 3; k++) {
            if (is_held(b, i, k))
                b->unbalanced[i][k] = 0.0;
            if (!isfinite(b->unbalanced[i][k]))
                return false;
        }
        largest = fmax(largest, size_of(b->unbalanced[i], lever));
    }
    const double scale = balance.largest_force + 1e-6 * wb_beam_scale_force(b->beam);
    b->residual = largest / scale;
    /* The stiff contact springs amplify round-off of positions into forces. */
    const double noise = wb_beam_noise(b->beam) + 4e-16 * b->model.span * b->roller[0].stiffness;
    b->tolerance = force_tolerance * scale + noise;
    return true;
}

/* Newton's method from the trial state; true if it converged. */
static bool solve(struct wb_three_point_bending *b, double level)
{
    int scaled_down = 0;
    for (int iteration = 0; iteration < MAX_ITERATIONS; iteration++) {
        if (!evaluate(b, level, true))
            return false;
        double largest = 0.0;
        for (int i = 0; i < b->n_nodes; i++)
            largest = fmax(largest, size_of(b->unbalanced[i], 1.0 / b->model.span));
        /* Accept only the solution with the wire below the nose: there is another on the far
         * side. */
        const struct wb_beam_node *node = wb_beam_nodes(b->beam);
        if (largest <= b->tolerance && fabs(node[b->middle].x) <= 1e-11 * b->model.span)
            return node[b->middle].y < b->nose_level - level;
        for (int i = 0; i < b->n_nodes; i++) {
            for (int k = 0; k < 3; k++)
                b->increment[3 * i + k] = -b->unbalanced[i][k];
        }
        /* Advancing by rotations and strains shifts the middle slightly: correct it. */
        for (int i = 0; i < b->n_nodes; i++) {
            for (int k = 0; k < 3; k++) {
                if (is_held(b, i, k))
                    wb_band_hold(&b->band, 3 * i + k, k == 0 ? -node[i].x : -node[i].t,
                                 b->increment);
            }
        }
        if (!wb_band_solve(&b->band, b->increment))
            return false;
        b->iterations++;
        const double scale = wb_beam_advance_nodes(
            b->beam, (const double(*)[3])(const void *)b->increment, max_iteration_rotation);
        scaled_down += scale < 1.0;
        if (scaled_down > 3)
            return false;
    }
    return false;
}

/* Solves from the extrapolated state, then from the last equilibrium. */
static bool solve_step(struct wb_three_point_bending *b, double level)
{
    const double ratio =
        b->state.last_step != 0.0 ? (level - b->state.level) / b->state.last_step : 0.0;
    if (ratio > 0.0 && ratio <= 2.0) {
        wb_beam_extrapolate(b->beam, ratio);
        if (solve(b, level))
            return true;
    }
    wb_beam_revert(b->beam);
    return solve(b, level);
}

static void accept(struct wb_three_point_bending *b, double level)
{
    struct state *s = &b->state;
    const double force = b->parts * b->nose.force;

    s->internal_work += b->parts * wb_beam_step_work(b->beam);
    for (int i = 0; i < b->n_rollers; i++)
        s->friction_work +=
            b->parts * wb_roller_commit(&b->roller[i], &b->contact[i], &s->roller[i]);
    s->work += 0.5 * (s->force + force) * (level - s->level);
    s->force = force;
    s->largest_force = fmax(s->largest_force, force);
    s->last_step = level - s->level;
    s->level = level;
    wb_beam_commit(b->beam);
}

/* The level of the nose at which the gap between nose and roller equals the wire's thickness. */
static double pinching_level(const struct wb_three_point_bending *b)
{
    const struct wb_roller *r = &b->roller[0];
    const double reach = b->nose_radius + r->radius, aside = r->x;
    if (reach <= aside)
        return HUGE_VAL;
    return b->nose_level - (r->y + sqrt(reach * reach - aside * aside));
}

static void describe(const struct wb_three_point_bending *b, double level,
                     struct wb_three_point_bending_point *point)
{
    const struct wb_beam_node *node = wb_beam_nodes(b->beam);
    const struct state *s = &b->state;
    const struct wb_beam_point *section = wb_beam_section(b->beam, b->middle_arc);

    point->deflection = level;
    point->force = s->slack ? 0.0 : s->force;
    point->travel = level + b->model.compliance * point->force;
    point->slack = s->slack;
    point->middle = b->nose_level - b->nose_radius - node[b->middle].y;
    point->contact_angle = s->roller[0].angle;
    point->draw_in = s->roller[0].arc - b->at_rest[0].arc;
    point->tension = s->roller[0].friction;
    point->wrapped = 0.0;
    if (!s->slack && b->nose.last > b->nose.first)
        point->wrapped = b->parts == 2.0 ? 2.0 * b->nose.last : b->nose.last - b->nose.first;
    point->middle_moment = section->M;
    point->middle_curvature = section->k - section->reference_k;
    point->work = s->work;
    point->internal_work = s->internal_work;
    point->friction_work = s->friction_work;
    point->iterations = b->iterations;
    point->residual = b->residual;
}

/* Finds the level between the last state and `level` at which the force becomes zero, and lifts the
 * nose off the wire there. */
static bool lift_off(struct wb_three_point_bending *b, double level)
{
    double high = level, low = b->state.level;
    double at_high = b->parts * b->nose.force, at_low = b->state.force;
    /* False position, Illinois variant. */
    for (int i = 0; i < MAX_ZERO_ITERATIONS; i++) {
        const double zero = 1e-7 * b->state.largest_force + b->tolerance;
        const double next = low + (high - low) * at_low / (at_low - at_high);
        if (!solve_step(b, next))
            return false;
        const double force = b->parts * b->nose.force;
        if (fabs(force) <= zero) {
            accept(b, next);
            b->state.force = 0.0;
            b->state.slack = true;
            b->state.contact_level = next;
            b->state.last_step = 0.0;
            return true;
        }
        if (force > 0.0) {
            low = next;
            at_low = force;
            at_high *= 0.5;
        } else {
            high = next;
            at_high = force;
            at_low *= 0.5;
        }
    }
    return false;
}

enum wb_status wb_three_point_bending_move(struct wb_three_point_bending *bending,
                                           double deflection,
                                           struct wb_three_point_bending_point *point)
{
    struct wb_three_point_bending *b = bending;
    struct state *s = &b->state;
    if (!isfinite(deflection))
        return wb_fail(WB_ERR_ARGUMENT, "deflection %g is not a finite number", deflection);

    const double pinched = pinching_level(b);
    const double longest = fmin(longest_step * b->model.span, longest_over_nose * b->nose_radius);
    bool failed = false;
    double step = s->step;

    b->iterations = 0;
    point->end = WB_THREE_POINT_BENDING_CONVERGED;
    /* After a reversal of the nose, friction reverses within a very short travel: start
     * with a small step. */
    if ((deflection - s->level) * s->last_step < 0.0)
        step = fmin(step, turning_step * b->model.span);
    if (s->slack && deflection > s->contact_level)
        s->slack = false;
    if (s->slack) {
        describe(b, deflection, point);
        return WB_OK;
    }
    while (s->level != deflection && !s->slack) {
        const double remaining = deflection - s->level;
        const double next =
            fabs(remaining) <= 1.0001 * step ? deflection : s->level + copysign(step, remaining);
        if (next >= pinched) {
            point->end = WB_THREE_POINT_BENDING_PINCHED;
            break;
        }
        if (solve_step(b, next)) {
            if (b->nose.force < 0.0) {
                if (lift_off(b, next))
                    break;
            } else {
                accept(b, next);
                s->step = step;
                step = failed ? step : fmin(2.0 * step, longest);
                failed = false;
                continue;
            }
        }
        failed = true;
        step = 0.5 * fmin(step, fabs(remaining));
        if (step < smallest_step * b->model.span || b->iterations > MAX_MOVE_ITERATIONS) {
            point->end =
                b->off ? WB_THREE_POINT_BENDING_RAN_OFF : WB_THREE_POINT_BENDING_NOT_CONVERGED;
            break;
        }
    }
    if (point->end != WB_THREE_POINT_BENDING_CONVERGED) {
        wb_beam_revert(b->beam);
        (void)evaluate(b, s->level, false);
    }
    describe(b, point->end == WB_THREE_POINT_BENDING_CONVERGED ? deflection : s->level, point);
    return WB_OK;
}

void wb_three_point_bending_shape(const struct wb_three_point_bending *bending, int n,
                                  const double *from_middle, double *x, double *y, double *angle)
{
    for (int i = 0; i < n; i++) {
        const double side = bending->parts == 2.0 && from_middle[i] < 0.0 ? -1.0 : 1.0;
        const struct wb_beam_node at =
            wb_beam_position(bending->beam, bending->middle_arc + side * from_middle[i]);
        x[i] = side * at.x;
        y[i] = at.y;
        if (angle)
            angle[i] = side * at.t;
    }
}

const char *wb_three_point_bending_end_name(enum wb_three_point_bending_end end)
{
    static const char *const names[] = {"converged", "not converged", "ran off", "pinched"};
    return names[end];
}
