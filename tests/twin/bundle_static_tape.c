#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vec3.h"
#include "tests/twin/bundle_static_private.h"

#define WB_LOG_DOMAIN "bundle_static"

enum {
    NODES = 4,   /* of an element: at a line's station and the next, then the next line's */
    OF_NODE = 7, /* unknowns: of the wire x, y, z, t, of the tape three openings */
    PLACES = 12, /* coordinates of an element */
    MOST = NODES * OF_NODE,
    POINTS = WB_BUNDLE_STATIC_POINTS,
    USUAL_ARC_NODES = 3
};

/* Arcs shorter than this carry no nodes, rad. */
static const double smallest_arc = 1e-6;

/* --- lines --- */

static void make_arc(struct wb_bundle_static *b, const struct wb_hull_arc *arc, double offset)
{
    const int n = b->settings.arc_nodes > 0 ? b->settings.arc_nodes : USUAL_ARC_NODES;
    const double radius = b->wire[arc->wire].radius + offset;
    const double step = (arc->to - arc->from) / (n - 1);

    for (int i = 0; i < n; i++) {
        const double angle = arc->from + i * step;
        const bool end = i == 0 || i == n - 1;
        b->line[b->n_lines++] = (struct wb_bundle_static_line){
            .wire = arc->wire,
            .y = radius * sin(angle),
            .z = radius * cos(angle),
            .normal = {sin(angle), cos(angle)},
            .bonded = radius * step * (end ? 0.5 : 1.0),
            .width = end && i > 0 ? 0.0 : radius * step,
        };
    }
}

enum wb_status wb_bundle_static_make_tape(struct wb_bundle_static *b)
{
    const struct wb_bundle_tape *tape = &b->model->tape;
    const int per_arc = b->settings.arc_nodes > 0 ? b->settings.arc_nodes : USUAL_ARC_NODES;

    if (!b->model->has_tape || b->settings.no_tape)
        return WB_OK;
    if (tape->taping.kind != WB_TAPING_SLEEVE)
        return wb_fail(WB_ERR_UNSUPPORTED,
                       "%s: the static model has no helix; use taping layout: sleeve",
                       b->model->path);
    if (tape->round)
        return wb_fail(WB_ERR_UNSUPPORTED,
                       "%s: the static model has no tape on a circle; use taping outline: hull",
                       b->model->path);
    if (tape->reach > 0.0)
        return wb_fail(WB_ERR_UNSUPPORTED,
                       "%s: the static model's tape is bonded where it lies on wires; leave out "
                       "taping.bond_reach_mm",
                       b->model->path);
    if (b->model->interface.has_damage)
        return wb_fail(WB_ERR_UNSUPPORTED,
                       "%s: the static model has no damage; leave out interface.damage",
                       b->model->path);
    if (b->n_wires < 2)
        return wb_fail(WB_ERR_UNSUPPORTED,
                       "%s: the static model has no tape round one wire; leave the tape out",
                       b->model->path);
    b->has_tape = true;
    b->thickness = wb_taping_thickness(&tape->taping);
    b->tape_mass = wb_bundle_model_tape_mass(b->model);
    b->sheet.material = tape->material.material;
    b->line = calloc((size_t)(tape->hull.n_arcs * per_arc), sizeof *b->line);
    if (!b->line)
        return wb_fail(WB_ERR_MEMORY, "out of memory for the tape");
    for (int i = 0; i < tape->hull.n_arcs; i++)
        if (tape->hull.arc[i].to - tape->hull.arc[i].from > smallest_arc)
            make_arc(b, &tape->hull.arc[i], tape->gap + 0.5 * b->thickness);
    for (int k = 0; k < b->n_lines; k++) {
        const struct wb_bundle_static_line *next = &b->line[(k + 1) % b->n_lines];
        struct wb_bundle_static_line *line = &b->line[k];
        line->chord = hypot(b->wire[next->wire].y + next->y - b->wire[line->wire].y - line->y,
                            b->wire[next->wire].z + next->z - b->wire[line->wire].z - line->z);
        if (line->width == 0.0)
            line->width = line->chord;
    }
    const size_t points = (size_t)b->n_lines * (size_t)b->n_elements * POINTS;
    b->point = calloc(points, sizeof *b->point);
    b->trial_point = calloc(points, sizeof *b->trial_point);
    if (!b->point || !b->trial_point)
        return wb_fail(WB_ERR_MEMORY, "out of memory for the tape");
    return wb_bundle_static_mirror_tape(b);
}

enum wb_status wb_bundle_static_mirror_tape(struct wb_bundle_static *b)
{
    for (int k = 0; k < b->n_lines; k++) {
        struct wb_bundle_static_line *line = &b->line[k];
        const double near = 1e-6 * b->wire[line->wire].radius;
        const int wire = b->wire[line->wire].mirror;
        line->mirror = -1;
        for (int i = 0; i < b->n_lines; i++)
            if (b->line[i].wire == wire && fabs(b->line[i].y - line->y) < near &&
                fabs(b->line[i].z + line->z) < near)
                line->mirror = i;
        if (line->mirror < 0)
            return wb_fail(WB_ERR_UNSUPPORTED,
                           "%s: the static model needs a tape that is its own mirror image",
                           b->model->path);
        line->leads = line->mirror >= k;
    }
    return WB_OK;
}

/* --- elements --- */

/* A node's place and its derivatives by its unknowns. */
struct node {
    double at[3], d[3][OF_NODE];
    double arm[2]; /* from the wire's centre, x and y */
    double c, s;
};

static struct node look(const struct wb_bundle_static *b, int k, int j)
{
    const struct wb_bundle_static_line *line = &b->line[k];
    double w[4], u[3];
    struct node out;

    for (int i = 0; i < 4; i++)
        w[i] = wb_bundle_static_wire_field(b, b->trial, line->wire, i)[j];
    for (int i = 0; i < 3; i++)
        u[i] = wb_bundle_static_ring_field(b, b->trial, k, i)[j];
    const double c = cos(w[3]), s = sin(w[3]), up = line->y + u[1];
    out.c = c;
    out.s = s;
    out.arm[0] = c * u[0] - s * up;
    out.arm[1] = s * u[0] + c * up;
    out.at[0] = w[0] + out.arm[0];
    out.at[1] = w[1] + out.arm[1];
    out.at[2] = w[2] + line->z + u[2];
    const double d[3][OF_NODE] = {
        {1.0, 0.0, 0.0, -out.arm[1], c, -s, 0.0},
        {0.0, 1.0, 0.0, out.arm[0], s, c, 0.0},
        {0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0},
    };
    memcpy(out.d, d, sizeof d);
    return out;
}

/* Logarithmic strain H = E - E^2 of Green's E (11, 22, twice 12), to second order, with its first
 * derivatives; the second ones are constants. */
static void logarithm(const double E[3], double H[3], double J[3][3])
{
    const double q = 0.25 * E[2] * E[2];

    H[0] = E[0] - E[0] * E[0] - q;
    H[1] = E[1] - E[1] * E[1] - q;
    H[2] = E[2] * (1.0 - E[0] - E[1]);
    const double d[3][3] = {
        {1.0 - 2.0 * E[0], 0.0, -0.5 * E[2]},
        {0.0, 1.0 - 2.0 * E[1], -0.5 * E[2]},
        {-E[2], -E[2], 1.0 - E[0] - E[1]},
    };
    memcpy(J, d, sizeof d);
}

struct element {
    double force[PLACES], tangent[PLACES][PLACES];
};

/* A point: slopes along and round, and what each node has in them. */
struct slopes {
    double along[3], round[3];
    double A[NODES], B[NODES];
};

static void find_slopes(const struct node *node, double eta, double h, double chord,
                        struct slopes *out)
{
    const double low = 0.5 * (1.0 - eta) / h, high = 0.5 * (1.0 + eta) / h, b = 0.5 / chord;
    const double A[NODES] = {-low, low, -high, high}, B[NODES] = {-b, -b, b, b};

    *out = (struct slopes){0};
    for (int i = 0; i < NODES; i++) {
        out->A[i] = A[i];
        out->B[i] = B[i];
        for (int c = 0; c < 3; c++) {
            out->along[c] += A[i] * node[i].at[c];
            out->round[c] += B[i] * node[i].at[c];
        }
    }
}

/* Stress and its derivative by Green's strain from those by the logarithmic one. */
static void pull_back(const struct wb_bundle_static_sheet_response *r, double J[3][3], double S[3],
                      double D[3][3])
{
    const double *T = r->stress;
    const double second[3][3] = {
        {-2.0 * T[0], 0.0, -T[2]},
        {0.0, -2.0 * T[1], -T[2]},
        {-T[2], -T[2], -0.5 * (T[0] + T[1])},
    };
    for (int i = 0; i < 3; i++) {
        S[i] = J[0][i] * T[0] + J[1][i] * T[1] + J[2][i] * T[2];
        for (int k = 0; k < 3; k++) {
            D[i][k] = second[i][k];
            for (int m = 0; m < 3; m++)
                for (int n = 0; n < 3; n++)
                    D[i][k] += J[m][i] * r->tangent[m][n] * J[n][k];
        }
    }
}

static void add_point(const struct slopes *at, const double S[3], double D[3][3], double volume,
                      struct element *out)
{
    double g[3][PLACES];

    for (int i = 0; i < PLACES; i++) {
        const int n = i / 3, c = i % 3;
        g[0][i] = at->along[c] * at->A[n];
        g[1][i] = at->round[c] * at->B[n];
        g[2][i] = at->round[c] * at->A[n] + at->along[c] * at->B[n];
        out->force[i] += volume * (S[0] * g[0][i] + S[1] * g[1][i] + S[2] * g[2][i]);
    }
    for (int i = 0; i < PLACES; i++) {
        double Dg[3];
        for (int m = 0; m < 3; m++)
            Dg[m] = D[m][0] * g[0][i] + D[m][1] * g[1][i] + D[m][2] * g[2][i];
        for (int k = 0; k < PLACES; k++)
            out->tangent[i][k] += volume * (Dg[0] * g[0][k] + Dg[1] * g[1][k] + Dg[2] * g[2][k]);
        for (int m = 0; m < NODES; m++) {
            const int n = i / 3;
            out->tangent[i][3 * m + i % 3] +=
                volume * (S[0] * at->A[n] * at->A[m] + S[1] * at->B[n] * at->B[m] +
                          S[2] * (at->A[n] * at->B[m] + at->B[n] * at->A[m]));
        }
    }
}

/* From places to unknowns, with how the openings turn. */
static void spread(const struct node *node, const struct element *e, double force[MOST],
                   double tangent[MOST * MOST])
{
    double half[PLACES][MOST];

    for (int i = 0; i < PLACES; i++)
        for (int n = 0; n < NODES; n++)
            for (int u = 0; u < OF_NODE; u++) {
                half[i][OF_NODE * n + u] = 0.0;
                for (int c = 0; c < 3; c++)
                    half[i][OF_NODE * n + u] += e->tangent[i][3 * n + c] * node[n].d[c][u];
            }
    for (int n = 0; n < NODES; n++) {
        const double *f = &e->force[3 * n];
        for (int u = 0; u < OF_NODE; u++) {
            const int row = OF_NODE * n + u;
            force[row] = 0.0;
            for (int c = 0; c < 3; c++)
                force[row] += f[c] * node[n].d[c][u];
            for (int k = 0; k < MOST; k++) {
                double sum = 0.0;
                for (int c = 0; c < 3; c++)
                    sum += node[n].d[c][u] * half[3 * n + c][k];
                tangent[MOST * row + k] = sum;
            }
        }
        const int t = OF_NODE * n + 3;
        const double along = f[1] * node[n].c - f[0] * node[n].s;
        const double up = -f[0] * node[n].c - f[1] * node[n].s;
        tangent[MOST * t + t] -= f[0] * node[n].arm[0] + f[1] * node[n].arm[1];
        tangent[MOST * t + t + 1] += along;
        tangent[MOST * (t + 1) + t] += along;
        tangent[MOST * t + t + 2] += up;
        tangent[MOST * (t + 2) + t] += up;
    }
}

static void add_element(struct wb_bundle_static *b, int k, int e)
{
    const struct wb_bundle_static_line *line = &b->line[k];
    const int next = (k + 1) % b->n_lines;
    const int lines[NODES] = {k, k, next, next}, stations[NODES] = {e, e + 1, e, e + 1};
    struct node node[NODES];
    struct element out = {0};
    struct wb_bundle_static_place place = {0};
    double force[MOST], tangent[MOST * MOST];

    for (int n = 0; n < NODES; n++)
        node[n] = look(b, lines[n], stations[n]);
    for (int g = 0; g < POINTS; g++) {
        const size_t i = ((size_t)k * (size_t)b->n_elements + (size_t)e) * POINTS + (size_t)g;
        struct wb_bundle_static_tape_point *point = &b->trial_point[i];
        struct wb_bundle_static_sheet_response r;
        struct slopes at;
        double J[3][3], S[3], D[3][3];

        find_slopes(node, (g == 0 ? -1.0 : 1.0) / sqrt(3.0), b->h, line->chord, &at);
        const double E[3] = {0.5 * (wb_vec3_dot(at.along, at.along) - 1.0),
                             0.5 * (wb_vec3_dot(at.round, at.round) - 1.0),
                             wb_vec3_dot(at.along, at.round)};
        logarithm(E, point->strain, J);
        wb_bundle_static_sheet_respond(&b->sheet, point->strain, &b->point[i].history,
                                       &point->history, &r);
        memcpy(point->stress, r.stress, sizeof r.stress);
        pull_back(&r, J, S, D);
        add_point(&at, S, D, 0.5 * b->h * line->width * b->thickness, &out);
    }
    spread(node, &out, force, tangent);
    for (int n = 0; n < NODES; n++) {
        for (int i = 0; i < 4; i++)
            wb_bundle_static_name_wire(b, b->line[lines[n]].wire, i, stations[n], &place);
        for (int i = 0; i < 3; i++)
            wb_bundle_static_name_line(b, lines[n], i, stations[n], &place);
    }
    wb_bundle_static_add(b, &place, force, tangent);
}

/* --- bonds --- */

static void find_bond(const struct wb_bundle_static *b, int k, int j, double stiffness[3][3])
{
    const struct wb_bundle_static_line *line = &b->line[k];
    const double area = line->bonded * wb_bundle_static_length(b, j);
    const double across = area * b->model->interface.normal_stiffness;
    const double along = area * b->model->interface.shear_stiffness;
    const double y = line->normal[0], z = line->normal[1];
    const double K[3][3] = {
        {along, 0.0, 0.0},
        {0.0, across * y * y + along * z * z, (across - along) * y * z},
        {0.0, (across - along) * y * z, across * z * z + along * y * y},
    };
    memcpy(stiffness, K, sizeof K);
}

static void add_bond(struct wb_bundle_static *b, int k, int j)
{
    struct wb_bundle_static_place place = {0};
    double K[3][3], force[3];

    find_bond(b, k, j, K);
    for (int i = 0; i < 3; i++) {
        force[i] = 0.0;
        for (int c = 0; c < 3; c++)
            force[i] += K[i][c] * wb_bundle_static_ring_field(b, b->trial, k, c)[j];
        wb_bundle_static_name_line(b, k, i, j, &place);
    }
    wb_bundle_static_add(b, &place, force, &K[0][0]);
}

void wb_bundle_static_add_tape(struct wb_bundle_static *b)
{
    for (int k = 0; k < b->n_lines; k++) {
        for (int e = b->held; e < b->n_elements; e++)
            add_element(b, k, e);
        for (int j = b->held + 1; j < b->n_stations; j++)
            add_bond(b, k, j);
    }
}

/* --- what it tells --- */

double wb_bundle_static_bond_energy(const struct wb_bundle_static *b)
{
    double sum = 0.0;

    for (int k = 0; k < b->n_lines; k++)
        for (int j = b->held + 1; j < b->n_stations; j++) {
            double K[3][3], u[3];
            find_bond(b, k, j, K);
            for (int i = 0; i < 3; i++)
                u[i] = wb_bundle_static_ring_field(b, b->committed, k, i)[j];
            for (int i = 0; i < 3; i++)
                sum += 0.5 * u[i] * wb_vec3_dot(K[i], u);
        }
    return sum;
}

double wb_bundle_static_tape_work(const struct wb_bundle_static *b)
{
    double work = 0.0;

    for (int k = 0; k < b->n_lines; k++) {
        const double volume = 0.5 * b->h * b->line[k].width * b->thickness;
        const size_t first = (size_t)k * (size_t)b->n_elements * POINTS;
        for (size_t i = first; i < first + (size_t)b->n_elements * POINTS; i++)
            for (int c = 0; c < 3; c++)
                work += 0.5 * volume * (b->trial_point[i].stress[c] + b->point[i].stress[c]) *
                        (b->trial_point[i].strain[c] - b->point[i].strain[c]);
    }
    return work;
}

double wb_bundle_static_tape_strain(const struct wb_bundle_static *b)
{
    double largest = 0.0;

    for (size_t i = 0; i < (size_t)b->n_lines * (size_t)b->n_elements * POINTS; i++) {
        const double *H = b->point[i].strain;
        largest = fmax(largest, 0.5 * fabs(H[0] + H[1]) + 0.5 * hypot(H[0] - H[1], H[2]));
    }
    return largest;
}
