#include <math.h>

#include "tests/twin/bundle_static_private.h"

/* An element: x', y' and the rotation in its middle, strains of the trial state, resultants. */
struct middle {
    double c, s; /* cos, sin of the rotation */
    double a, b; /* 1 + axial strain, shear strain */
    double N, Q, M;
    double D11, D12, D22, G;
};

/* Derivatives of axial strain, shear strain and curvature by x, y, t of both nodes. */
static void derivatives(const struct middle *at, double h, double d[3][6])
{
    const double row[3][3] = {
        {at->c / h, at->s / h, 0.5 * at->b},
        {-at->s / h, at->c / h, -0.5 * at->a},
        {0.0, 0.0, 0.0},
    };
    for (int r = 0; r < 3; r++) {
        for (int k = 0; k < 2; k++) {
            d[r][k] = -row[r][k];
            d[r][3 + k] = row[r][k];
        }
        d[r][2] = d[r][5] = row[r][2];
    }
    d[2][2] = -1.0 / h;
    d[2][5] = 1.0 / h;
}

static void find_tangent(const struct middle *at, double h, double d[3][6], double *tangent)
{
    const double D[3][3] = {{at->D11, 0.0, at->D12}, {0.0, at->G, 0.0}, {at->D12, 0.0, at->D22}};
    /* Forces on x' and y', and how they turn. */
    const double fx = at->N * at->c - at->Q * at->s, fy = at->N * at->s + at->Q * at->c;
    static const double end[2] = {-1.0, 1.0};

    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 6; j++) {
            double sum = 0.0;
            for (int r = 0; r < 3; r++)
                for (int q = 0; q < 3; q++)
                    sum += d[r][i] * D[r][q] * d[q][j];
            tangent[6 * i + j] = h * sum;
        }
    }
    for (int k = 0; k < 2; k++) {
        for (int l = 0; l < 2; l++) {
            const int t = 3 * l + 2;
            tangent[6 * (3 * k) + t] -= 0.5 * end[k] * fy;
            tangent[6 * t + 3 * k] -= 0.5 * end[k] * fy;
            tangent[6 * (3 * k + 1) + t] += 0.5 * end[k] * fx;
            tangent[6 * t + 3 * k + 1] += 0.5 * end[k] * fx;
            tangent[6 * (3 * k + 2) + t] -= 0.25 * h * (at->N * at->a + at->Q * at->b);
        }
    }
}

static void add_element(struct wb_bundle_static *b, int w, int e)
{
    const struct wb_bundle_static_beam *wire = &b->wire[w];
    const double *t = wb_bundle_static_wire_field(b, b->trial, w, 3);
    const double eps = wb_bundle_static_strain(b, b->trial, w, 0)[e];
    const double gamma = wb_bundle_static_strain(b, b->trial, w, 1)[e];
    const size_t history = b->history_at[w] + (size_t)e * b->row[wire->type];
    const double turn = 0.5 * (t[e] + t[e + 1]), times = wire->mirror == w ? 1.0 : 2.0;
    struct wb_fibres_response r;

    wb_fibres_respond(b->fibres[wire->type], eps, (t[e + 1] - t[e]) / b->h, b->history + history,
                      b->trial_history + history, &r);
    const double G = wb_fibres_shear_stiffness(b->fibres[wire->type]);
    const struct middle at = {
        cos(turn), sin(turn), 1.0 + eps, gamma, r.N, G * gamma, r.M, r.D11, r.D12, r.D22, G,
    };
    double d[3][6], force[6], tangent[36];
    derivatives(&at, b->h, d);
    find_tangent(&at, b->h, d, tangent);
    for (int i = 0; i < 6; i++) {
        force[i] = times * b->h * (at.N * d[0][i] + at.Q * d[1][i] + at.M * d[2][i]);
        const double size = fabs(force[i]) / times * (i % 3 == 2 ? 1.0 / b->model->length : 1.0);
        b->largest_force = size > b->largest_force || size != size ? size : b->largest_force;
    }
    for (int i = 0; i < 36; i++)
        tangent[i] *= times;

    struct wb_bundle_static_place place = {0};
    for (int k = 0; k < 2; k++) {
        wb_bundle_static_name_wire(b, w, 0, e + k, &place);
        wb_bundle_static_name_wire(b, w, 1, e + k, &place);
        wb_bundle_static_name_wire(b, w, 3, e + k, &place);
    }
    wb_bundle_static_add(b, &place, force, tangent);
    b->element[(size_t)w * (size_t)b->n_elements + (size_t)e] = (struct wb_bundle_static_element){
        .strain = {eps, gamma, (t[e + 1] - t[e]) / b->h},
        .force = {at.N, at.Q, at.M},
    };
}

double wb_bundle_static_wire_work(const struct wb_bundle_static *b)
{
    double work = 0.0;

    for (int w = 0; w < b->n_wires; w++) {
        if (!b->wire[w].leads)
            continue;
        const double times = b->wire[w].mirror == w ? 1.0 : 2.0;
        for (int e = b->held; e < b->n_elements; e++) {
            const size_t i = (size_t)w * (size_t)b->n_elements + (size_t)e;
            const struct wb_bundle_static_element *is = &b->element[i];
            const struct wb_bundle_static_element *was = &b->committed_element[i];
            for (int k = 0; k < 3; k++)
                work += 0.5 * times * b->h * (is->force[k] + was->force[k]) *
                        (is->strain[k] - was->strain[k]);
        }
    }
    return work;
}

/* Lateral bending: differences of z, clamped at the start (its image there is symmetric), free at
 * the end. */
static void add_lateral(struct wb_bundle_static *b, int w, int j)
{
    const struct wb_bundle_static_beam *wire = &b->wire[w];
    const double *z = wb_bundle_static_wire_field(b, b->trial, w, 2);
    const double times = wire->mirror == w ? 1.0 : 2.0;
    const double stiffness = times * wire->lateral * wb_bundle_static_length(b, j) / pow(b->h, 4);
    const int first = j > 0 ? j - 1 : 1;
    const double row[3] = {1.0, -2.0, 1.0};
    const double bend = z[first] - 2.0 * z[j] + z[j + 1];
    struct wb_bundle_static_place place = {0};
    double force[3], tangent[9];

    wb_bundle_static_name_wire(b, w, 2, first, &place);
    wb_bundle_static_name_wire(b, w, 2, j, &place);
    wb_bundle_static_name_wire(b, w, 2, j + 1, &place);
    for (int i = 0; i < 3; i++) {
        force[i] = stiffness * bend * row[i];
        for (int k = 0; k < 3; k++)
            tangent[3 * i + k] = stiffness * row[i] * row[k];
    }
    wb_bundle_static_add(b, &place, force, tangent);
}

void wb_bundle_static_add_wires(struct wb_bundle_static *b)
{
    for (int w = 0; w < b->n_wires; w++) {
        if (!b->wire[w].leads)
            continue;
        for (int e = b->held; e < b->n_elements; e++)
            add_element(b, w, e);
        for (int j = b->held; j < b->n_elements; j++)
            add_lateral(b, w, j);
        for (int j = b->held + 1; j < b->n_stations; j++) {
            const double weight = b->trial[b->weight_at] * b->gravity * b->wire[w].mass *
                                  wb_bundle_static_length(b, j) *
                                  (b->wire[w].mirror == w ? 1.0 : 2.0);
            struct wb_bundle_static_place place = {0};
            const double none = 0.0;
            wb_bundle_static_name_wire(b, w, 1, j, &place);
            wb_bundle_static_add(b, &place, &weight, &none);
        }
    }
}

static void copy_mirrored(struct wb_bundle_static *b, double *state, int w)
{
    const int of = b->wire[w].mirror;

    for (int field = 0; field < WB_BUNDLE_STATIC_WIRE; field++) {
        const double *from = wb_bundle_static_wire_field(b, state, of, field);
        double *to = wb_bundle_static_wire_field(b, state, w, field);
        for (int j = 0; j < b->n_stations; j++)
            to[j] = field == 2 ? -from[j] : from[j];
    }
    for (int field = 0; field < 2; field++) {
        const double *from = wb_bundle_static_strain(b, state, of, field);
        double *to = wb_bundle_static_strain(b, state, w, field);
        for (int e = 0; e < b->n_elements; e++)
            to[e] = from[e];
    }
}

void wb_bundle_static_place_wires(struct wb_bundle_static *b, double *state)
{
    for (int w = 0; w < b->n_wires; w++) {
        if (!b->wire[w].leads)
            continue;
        double *x = wb_bundle_static_wire_field(b, state, w, 0);
        double *y = wb_bundle_static_wire_field(b, state, w, 1);
        const double *t = wb_bundle_static_wire_field(b, state, w, 3);
        const double *eps = wb_bundle_static_strain(b, state, w, 0);
        const double *gamma = wb_bundle_static_strain(b, state, w, 1);
        for (int e = 0; e < b->n_elements; e++) {
            const double c = cos(0.5 * (t[e] + t[e + 1])), s = sin(0.5 * (t[e] + t[e + 1]));
            x[e + 1] = x[e] + b->h * ((1.0 + eps[e]) * c - gamma[e] * s);
            y[e + 1] = y[e] + b->h * ((1.0 + eps[e]) * s + gamma[e] * c);
        }
    }
    for (int w = 0; w < b->n_wires; w++)
        if (!b->wire[w].leads)
            copy_mirrored(b, state, w);
    for (int k = 0; k < b->n_lines; k++) {
        if (b->line[k].leads)
            continue;
        for (int field = 0; field < WB_BUNDLE_STATIC_RING; field++) {
            const double *from = wb_bundle_static_ring_field(b, state, b->line[k].mirror, field);
            double *to = wb_bundle_static_ring_field(b, state, k, field);
            for (int j = 0; j < b->n_stations; j++)
                to[j] = field == 2 ? -from[j] : from[j];
        }
    }
}
