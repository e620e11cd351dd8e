#include <lapacke.h>
#include <math.h>
#include <string.h>

#include "base/vec3.h"
#include "fe/harness/harness_contact.h"
#include "fe/harness/harness_slide.h"
#include "fe/harness/harness_state.h"
#include "fe/linear/rod_chain.h"
#include "fe/linear/signature.h"

/* Of a line search: the work that is small, over that at its beginning; evaluations. */
static const double search_part = 0.5;
static const int max_searches = 12;
/* A hold moves that has further to go, m or rad. */
static const double moving = 1e-6;

/* Columns of the equations of a node: of its own unknowns, then right-hand sides. */
typedef double rows_t[U][WB_ROD_CHAIN_WIDTH];

/* --- one node --- */

/* Columns from space to the bases or back. */
static void turn_columns(const struct wb_harness_held *held, bool back, rows_t rows, int first,
                         int end)
{
    for (int c = first; c < end; c++) {
        double column[U];
        for (int r = 0; r < U; r++)
            column[r] = rows[r][c];
        wb_harness_turn_basis(held, back, column);
        for (int r = 0; r < U; r++)
            rows[r][c] = column[r];
    }
}

/* Puts a joint's hold into its equations, whose residual is in column `right`; `end` columns. */
static void hold_rows(const struct wb_harness_held *held, rows_t rows, int right, int end)
{
    turn_columns(held, false, rows, 0, end);
    for (int r = 0; r < U; r++)
        wb_harness_turn_basis(held, false, rows[r]);
    for (int r = 0; r < U; r++) {
        if (!held->is[r])
            continue;
        memset(rows[r], 0, (size_t)end * sizeof rows[r][0]);
        rows[r][r] = 1.0;
        rows[r][right] = held->way[r];
    }
}

/* Solves a node's equations; the columns from U on become the solutions, in space. */
static void solve_node(struct wb_harness *h, int node, rows_t rows, int right, int end)
{
    const bool is_held = wb_harness_is_held(h, node);
    struct wb_harness_held held;
    rows_t own;
    if (is_held) {
        wb_harness_look_at_hold(h, node, &held);
        hold_rows(&held, rows, right, end);
    }
    if (is_held) {
        memcpy(own, rows, sizeof own);
        for (int r = 0; r < U; r++) {
            for (int c = 0; c < U; c++)
                own[r][c] = held.is[c] && r != c ? 0.0 : rows[r][c];
        }
    }
    const double *const judged = is_held ? own[0] : rows[0];
    h->negative += wb_signature_negative(U, WB_ROD_CHAIN_WIDTH, judged);
    if (h->rubs)
        h->is_odd ^= wb_signature_is_odd(U, WB_ROD_CHAIN_WIDTH, judged);
    wb_rod_chain_solve(rows, end - U);
    if (is_held)
        turn_columns(&held, true, rows, U, end);
}

static void take_block(rows_t rows, int first, double *block)
{
    for (int r = 0; r < U; r++)
        memcpy(block + U * r, rows[r] + first, U * sizeof(double));
}

/* The unit matrix in six columns, which become the node's compliance. */
static void add_unit(rows_t rows, int first)
{
    for (int r = 0; r < U; r++)
        rows[r][first + r] = 1.0;
}

/* --- elimination --- */

/* Eliminates an element's middle node. `upper` becomes the block of its far joint's row and near
 * joint's column, `lower` that of the opposite; the diagonal blocks and right-hand sides are added.
 */
static void condense_element(struct wb_harness *h, int e, double *upper, double *lower)
{
    const struct wb_harness_element *const element = &h->elements[e];
    struct wb_harness_eliminated *const m = &h->eliminated[e];
    const int near = element->near, far = e + 1, middle = h->n_joints + e;
    struct wb_rod_element_stiffness s;
    rows_t rows = {{0}};
    int end = 3 * U + 1;

    wb_rod_element_stiffness(&element->shape, &h->points[e * POINTS], &s);
    wb_harness_contact_add_stiffness(h, e, &s);
    for (int k = 0; k < U && h->drag > 0.0; k++)
        s.K[1][1][(U + 1) * k] += wb_harness_drag_of(h->width[middle], k) * h->drag;
    for (int r = 0; r < U; r++) {
        memcpy(rows[r], s.K[1][1] + U * r, U * sizeof(double));
        memcpy(rows[r] + U, s.K[1][2] + U * r, U * sizeof(double));
        rows[r][2 * U] = h->increment[middle][r];
        memcpy(rows[r] + 2 * U + 1, s.K[1][0] + U * r, U * sizeof(double));
    }
    if (h->n_clips > 0) {
        add_unit(rows, end);
        end += U;
    }
    solve_node(h, middle, rows, 2 * U, end);
    take_block(rows, U, m->W3);
    take_block(rows, 2 * U + 1, m->W1);
    for (int r = 0; r < U; r++)
        h->increment[middle][r] = rows[r][2 * U];
    if (h->n_clips > 0) {
        struct wb_harness_compliance *const c = &h->compliance[e];
        take_block(rows, 3 * U + 1, c->middle);
        memcpy(c->near_middle, s.K[0][1], sizeof c->near_middle);
        memcpy(c->far_middle, s.K[2][1], sizeof c->far_middle);
    }
    for (int k = 0; k < U * U; k++) {
        upper[k] = s.K[2][0][k];
        lower[k] = s.K[0][2][k];
        h->diagonal[near][k] += s.K[0][0][k];
        h->diagonal[far][k] += s.K[2][2][k];
    }
    wb_rod_chain_multiply(upper, -1.0, s.K[2][1], m->W1);
    wb_rod_chain_multiply(lower, -1.0, s.K[0][1], m->W3);
    wb_rod_chain_multiply(h->diagonal[near], -1.0, s.K[0][1], m->W1);
    wb_rod_chain_multiply(h->diagonal[far], -1.0, s.K[2][1], m->W3);
    wb_rod_chain_apply(h->increment[near], -1.0, s.K[0][1], h->increment[middle]);
    wb_rod_chain_apply(h->increment[far], -1.0, s.K[2][1], h->increment[middle]);
}

/* Solves for a joint's increment in terms of that of the near joint: `upper` (NULL: none) becomes
 * X, the right-hand side y. */
static void eliminate_joint(struct wb_harness *h, int joint, double *upper)
{
    rows_t rows = {{0}};
    int end = 2 * U + 1;
    for (int r = 0; r < U; r++) {
        memcpy(rows[r], h->diagonal[joint] + U * r, U * sizeof(double));
        if (upper)
            memcpy(rows[r] + U, upper + U * r, U * sizeof(double));
        rows[r][2 * U] = h->increment[joint][r];
    }
    if (h->n_clips > 0) {
        add_unit(rows, end);
        end += U;
    }
    solve_node(h, joint, rows, 2 * U, end);
    if (upper)
        take_block(rows, U, upper);
    for (int r = 0; r < U; r++)
        h->increment[joint][r] = rows[r][2 * U];
    if (h->n_clips > 0)
        take_block(rows, 2 * U + 1, h->compliance[joint > 0 ? joint - 1 : h->n_elements].far);
}

/* The stiffness of a body's weight, which turns with its joint: d(arm x f) = (arm f^T - arm . f)
 * spin. */
static void add_body_stiffness(struct wb_harness *h)
{
    for (int i = 0; i < h->n_bodies; i++) {
        double arm[3], f[3];
        double *const S = h->diagonal[wb_harness_body_arm(h, &h->bodies[i], arm, f)];
        for (int r = 0; r < 3; r++) {
            for (int c = 0; c < 3; c++)
                S[U * (3 + r) + 3 + c] -=
                    h->weight * (arm[r] * f[c] - (r == c ? wb_vec3_dot(arm, f) : 0.0));
        }
    }
}

static void add_drag_stiffness(struct wb_harness *h)
{
    for (int j = 0; j < h->n_joints; j++) {
        for (int k = 0; k < U; k++)
            h->diagonal[j][(U + 1) * k] += wb_harness_drag_of(h->width[j], k) * h->drag;
    }
}

/* From the root to the ends: `vector` (nodes) holds each node's own part, and becomes the
 * solution. */
static void substitute(const struct wb_harness *h, double (*vector)[U])
{
    for (int e = 0; e < h->n_elements; e++) {
        const struct wb_harness_eliminated *const m = &h->eliminated[e];
        const double *const near = vector[h->elements[e].near];
        double *const middle = vector[h->n_joints + e];
        wb_rod_chain_apply(vector[e + 1], -1.0, m->X, near);
        wb_rod_chain_apply(middle, -1.0, m->W1, near);
        wb_rod_chain_apply(middle, -1.0, m->W3, vector[e + 1]);
    }
}

/* --- the border --- */

static void replace(double *vector, const double *matrix)
{
    double product[U] = {0};
    wb_rod_chain_apply(product, 1.0, matrix, vector);
    memcpy(vector, product, sizeof product);
}

static bool is_zero(const double *vector)
{
    for (int k = 0; k < U; k++) {
        if (vector[k] != 0.0)
            return false;
    }
    return true;
}

/* Where loads on the nodes move them, with the elimination that was done; in place. */
static void solve_again(const struct wb_harness *h, double (*vector)[U])
{
    for (int e = h->n_elements - 1; e >= 0; e--) {
        const struct wb_harness_compliance *const c = &h->compliance[e];
        double *const near = vector[h->elements[e].near], *const far = vector[e + 1];
        double *const middle = vector[h->n_joints + e];
        if (!is_zero(middle)) {
            replace(middle, c->middle);
            wb_rod_chain_apply(near, -1.0, c->near_middle, middle);
            wb_rod_chain_apply(far, -1.0, c->far_middle, middle);
        }
        if (!is_zero(far)) {
            replace(far, c->far);
            wb_rod_chain_apply(near, -1.0, c->near_far, far);
        }
    }
    replace(vector[0], h->compliance[h->n_elements].far);
    substitute(h, vector);
}

static void collect(struct wb_harness *h)
{
    for (int i = 0; i < h->n_clips; i++) {
        wb_harness_slide_equations(h, &h->clips[i], &h->equations[WB_HARNESS_CLIP * i]);
        h->rubs |= h->clips[i].friction > 0.0;
    }
}

/* Adds the forces of an equation's unknown. */
static void add_forces(const struct wb_harness *h, const struct wb_harness_equation *equation,
                       double unknown, double (*vector)[U])
{
    for (int n = 0; n < NODES; n++) {
        double *const to = vector[wb_harness_node_of(h, equation->element, n)];
        for (int k = 0; k < 3; k++)
            to[k] += unknown * equation->force[n][k];
    }
}

static double times(const struct wb_harness *h, const struct wb_harness_equation *equation,
                    double (*vector)[U])
{
    double sum = 0.0;
    for (int n = 0; n < NODES; n++)
        sum += wb_vec3_dot(equation->row[n], vector[wb_harness_node_of(h, equation->element, n)]);
    return sum;
}

/* The equations once the nodes are eliminated: n x n, and n right-hand sides. */
static void reduce(struct wb_harness *h, double *matrix, double *right)
{
    const int n = WB_HARNESS_CLIP * h->n_clips;
    for (int c = 0; c < n; c++) {
        memset(h->vector, 0, (size_t)h->n_nodes * sizeof *h->vector);
        add_forces(h, &h->equations[c], 1.0, h->vector);
        solve_again(h, h->vector);
        for (int r = 0; r < n; r++) {
            const bool same = r / WB_HARNESS_CLIP == c / WB_HARNESS_CLIP;
            matrix[n * r + c] = (same ? h->equations[r].own[c % WB_HARNESS_CLIP] : 0.0) -
                                times(h, &h->equations[r], h->vector);
        }
        right[c] = h->equations[c].right - times(h, &h->equations[c], h->increment);
    }
}

/* Number of negative eigenvalues of the symmetric part of a matrix of n x n, destroyed: of its
 * factor by Bunch and Kaufman, whose blocks of two have one each. */
static int count_negative(int n, double *matrix, lapack_int *pivots)
{
    int negative = 0;
    for (int r = 0; r < n; r++) {
        for (int c = 0; c < r; c++)
            matrix[n * r + c] = 0.5 * (matrix[n * r + c] + matrix[n * c + r]);
    }
    if (LAPACKE_dsytrf(LAPACK_ROW_MAJOR, 'L', n, matrix, n, pivots) < 0)
        return n;
    for (int i = 0; i < n; i++) {
        if (pivots[i] < 0)
            i++;
        negative += pivots[i] < 0 || matrix[(n + 1) * i] < 0.0;
    }
    return negative;
}

/* Whether a matrix has an odd number of negative eigenvalues, from its factor. */
static bool is_odd(int n, const double *factor, const lapack_int *pivots)
{
    bool odd = false;
    for (int i = 0; i < n; i++)
        odd ^= (factor[(n + 1) * i] < 0.0) != (pivots[i] != i + 1);
    return odd;
}

/* Each equation of a place brings one negative eigenvalue, which has nothing to do with the
 * stability. A prescribed place of a clip has no part in it. */
static void judge_stability(struct wb_harness *h, const double *matrix, double *copy,
                            lapack_int *pivots)
{
    const int n = WB_HARNESS_CLIP * h->n_clips;
    memcpy(copy, matrix, (size_t)n * (size_t)n * sizeof *copy);
    for (int i = 0; i < h->n_clips; i++) {
        const int place = WB_HARNESS_CLIP * i;
        for (int k = 0; k < n && h->clips[i].now.is_at_end; k++)
            copy[n * k + place] = k == place ? 1.0 : 0.0;
    }
    h->negative += count_negative(n, copy, pivots) - (n - h->n_clips);
}

/* Solves the equations and takes their part into the increment of the nodes. */
static void add_border(struct wb_harness *h)
{
    const int n = WB_HARNESS_CLIP * h->n_clips;
    double *const matrix = h->system, *const right = matrix + (size_t)n * (size_t)n;
    lapack_int pivots[WB_HARNESS_CLIP * WB_HARNESS_MOST_SLIDING];
    reduce(h, matrix, right);
    judge_stability(h, matrix, right + n, pivots);
    if (LAPACKE_dgesv(LAPACK_ROW_MAJOR, n, 1, matrix, n, pivots, right, 1) != 0)
        right[0] = (double)NAN;
    h->is_odd ^= is_odd(n, matrix, pivots) != ((n - h->n_clips) % 2 != 0);
    memset(h->vector, 0, (size_t)h->n_nodes * sizeof *h->vector);
    for (int i = 0; i < n; i++)
        add_forces(h, &h->equations[i], right[i], h->vector);
    solve_again(h, h->vector);
    for (int node = 0; node < h->n_nodes; node++) {
        for (int k = 0; k < U; k++)
            h->increment[node][k] -= h->vector[node][k];
    }
    for (int i = 0; i < n; i++)
        h->equations[i].right = right[i];
}

void wb_harness_solve(struct wb_harness *h)
{
    double lower[U * U];
    h->negative = 0;
    h->is_odd = h->rubs = false;
    collect(h);
    memset(h->diagonal, 0, (size_t)h->n_joints * sizeof *h->diagonal);
    for (int i = 0; i < h->n_nodes; i++) {
        for (int k = 0; k < U; k++)
            h->increment[i][k] = -h->residual[i][k];
    }
    add_body_stiffness(h);
    if (h->drag > 0.0)
        add_drag_stiffness(h);
    for (int e = h->n_elements - 1; e >= 0; e--) {
        struct wb_harness_eliminated *const m = &h->eliminated[e];
        const int near = h->elements[e].near;
        condense_element(h, e, m->X, lower);
        eliminate_joint(h, e + 1, m->X);
        wb_rod_chain_multiply(h->diagonal[near], -1.0, lower, m->X);
        wb_rod_chain_apply(h->increment[near], -1.0, lower, h->increment[e + 1]);
        if (h->n_clips > 0)
            memcpy(h->compliance[e].near_far, lower, sizeof lower);
    }
    eliminate_joint(h, 0, NULL);
    substitute(h, h->increment);
    if (h->n_clips > 0)
        add_border(h);
    /* Friction makes the stiffness unsymmetric. */
    if (h->rubs)
        h->negative = h->is_odd;
}

int wb_harness_negative(const struct wb_harness *harness)
{
    return harness->negative;
}

/* --- the increment --- */

static void advance_element(struct wb_harness *h, int e, double scale)
{
    const struct wb_harness_element *const element = &h->elements[e];
    double own[NODES * U];
    for (int n = 0; n < NODES; n++)
        memcpy(own + U * n, h->increment[wb_harness_node_of(h, e, n)], U * sizeof(double));
    for (int g = 0; g < POINTS; g++) {
        struct wb_rod_strain change;
        struct wb_rod_strain *const at = &h->trial[e * POINTS + g];
        wb_rod_element_strain_increment(&element->shape, g, &h->points[e * POINTS + g], own,
                                        &change);
        for (int k = 0; k < 3; k++) {
            at->stretch[k] += scale * change.stretch[k];
            at->curvature[k] += scale * change.curvature[k];
        }
    }
}

/* A clip moves by at most an element in an iteration. */
static double scale_for_clips(const struct wb_harness *h)
{
    double scale = 1.0;
    for (int i = 0; i < h->n_clips; i++) {
        const double most = h->elements[h->branches[h->clips[i].branch].first].shape.length;
        const double step = fabs(h->equations[WB_HARNESS_CLIP * i].right);
        scale = step > most ? fmin(scale, most / step) : scale;
    }
    return scale;
}

static void advance_unknowns(struct wb_harness *h, double scale)
{
    const struct wb_harness_equation *next = h->equations;
    for (int i = 0; i < h->n_clips; i++, next += WB_HARNESS_CLIP) {
        struct wb_harness_clip *const clip = &h->clips[i];
        clip->now.s =
            fmin(fmax(clip->now.s + scale * next[0].right, 0.0), h->branches[clip->branch].length);
        for (int k = 0; k < 3; k++)
            clip->now.force[k] += scale * next[1 + k].right;
    }
}

/* The increment changes strains and moves the root; positions and rotations follow from them, for
 * the reasons given in beam.c. */
static void move(struct wb_harness *h, double scale)
{
    double spin[3];
    for (int e = 0; e < h->n_elements; e++)
        advance_element(h, e, scale);
    for (int k = 0; k < 3; k++) {
        h->root.position[k] += scale * h->increment[0][k];
        spin[k] = scale * h->increment[0][3 + k];
    }
    wb_harness_turn_root(h, spin);
    wb_harness_place_nodes(h);
    advance_unknowns(h, scale);
}

/* --- line search --- */

/* The work of the unbalanced forces along the increment; below 0 as long as it relaxes them, 0
 * while a hold moves. */
static double work(const struct wb_harness *h)
{
    double sum = 0.0;
    for (int node = 0; node < h->n_nodes; node++) {
        double way[U], force[U];
        memcpy(way, h->increment[node], sizeof way);
        memcpy(force, h->residual[node], sizeof force);
        if (wb_harness_is_held(h, node)) {
            struct wb_harness_held held;
            wb_harness_look_at_hold(h, node, &held);
            wb_harness_turn_basis(&held, false, way);
            wb_harness_turn_basis(&held, false, force);
            for (int k = 0; k < U; k++) {
                if (held.is[k] && fabs(way[k]) > moving)
                    return 0.0;
                force[k] = held.is[k] ? 0.0 : force[k];
            }
        }
        for (int k = 0; k < U; k++)
            sum += way[k] * force[k];
    }
    return sum;
}

static void keep_origin(struct wb_harness *h)
{
    memcpy(h->origin, h->trial, (size_t)h->n_points * sizeof *h->origin);
    h->origin_root = h->root;
    for (int i = 0; i < h->n_clips; i++)
        h->clips[i].origin = h->clips[i].now;
}

static void move_from_origin(struct wb_harness *h, double scale)
{
    memcpy(h->trial, h->origin, (size_t)h->n_points * sizeof *h->origin);
    h->root = h->origin_root;
    for (int i = 0; i < h->n_clips; i++)
        h->clips[i].now = h->clips[i].origin;
    wb_harness_place_nodes(h);
    move(h, scale);
}

/* Moves by the part of the increment at which the work of the unbalanced forces is small: beyond
 * it, places that touched or stuck on the way push back. */
static void search(struct wb_harness *h, double scale, struct wb_harness_balance *balance)
{
    double low = 0.0, high = scale, work_low = work(h);
    const double enough = search_part * fabs(work_low);
    keep_origin(h);
    move(h, scale);
    wb_harness_evaluate(h, h->weight, balance);
    if (!(work_low < 0.0))
        return;
    double work_high = work(h), here = fmax(work_high, 0.0);
    for (int i = 0; i < max_searches && fabs(here) > enough; i++) {
        const double part = fmin(fmax(work_low / (work_low - work_high), 0.05), 0.95);
        const double at = low + part * (high - low);
        move_from_origin(h, at);
        wb_harness_evaluate(h, h->weight, balance);
        here = work(h);
        /* The other end counts half, so that it moves, too. */
        if (here < 0.0) {
            low = at;
            work_low = here;
            work_high *= 0.5;
        } else {
            high = at;
            work_high = here;
            work_low *= 0.5;
        }
    }
}

double wb_harness_advance(struct wb_harness *h, double most_rotation,
                          struct wb_harness_balance *balance)
{
    double most = 0.0;
    for (int j = 0; j < h->n_joints; j++)
        most = wb_larger(most, wb_vec3_length(h->increment[j] + 3));
    const double scale =
        fmin(most > most_rotation ? most_rotation / most : 1.0, scale_for_clips(h));
    if (h->n_obstacles == 0) {
        move(h, scale);
        wb_harness_evaluate(h, h->weight, balance);
    } else {
        wb_harness_contact_advance(h);
        search(h, scale, balance);
    }
    return scale;
}
