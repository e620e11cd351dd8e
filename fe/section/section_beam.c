#include "fe/section/section_beam_private.h"

#include <math.h>
#include <string.h>

int wb_section_beam_index(const struct wb_section_beam *beam, int station, int unknown)
{
    if (station == 0)
        return -1;
    const bool is_cap = station == beam->n_elements && beam->model->tip == WB_BUNDLE_TIP_CAPPED;
    return (station - 1) * beam->per_station + (is_cap && unknown > 0 ? 1 : unknown);
}

/* Value of an unknown in a vector of unknowns; 0 if it is fixed. */
static double value_of(const struct wb_section_beam *beam, const double *u, int station,
                       int unknown)
{
    const int index = wb_section_beam_index(beam, station, unknown);
    return index < 0 ? 0.0 : u[index];
}

/* Tributary length of a station, m: half an element at the tip. */
static double share_of(const struct wb_section_beam *beam, int station)
{
    return station == beam->n_elements ? 0.5 * beam->h : beam->h;
}

/* Volume of a tape segment in an element, including its image, m3. */
static double volume_of(const struct wb_section_beam *beam,
                        const struct wb_section_segment *segment)
{
    return segment->weight * segment->thickness * segment->length * beam->h;
}

static void add(const struct wb_section_beam *beam, double *to, int station, int unknown,
                double amount)
{
    const int index = wb_section_beam_index(beam, station, unknown);
    if (index >= 0)
        to[index] += amount;
}

/* Derivative of an unknown along an element. */
static double slope_of(const struct wb_section_beam *beam, int element, int unknown)
{
    return (value_of(beam, beam->u, element + 1, unknown) -
            value_of(beam, beam->u, element, unknown)) /
           beam->h;
}

/* Rotation at the middle of an element. */
static double turned_at(const struct wb_section_beam *beam, int element)
{
    return 0.5 * (value_of(beam, beam->u, element, 0) + value_of(beam, beam->u, element + 1, 0));
}

/* Difference of two unknowns at a station. */
static double slip_of(const struct wb_section_beam *beam, const double *u, int station,
                      const int unknown[2])
{
    return value_of(beam, u, station, unknown[0]) - value_of(beam, u, station, unknown[1]);
}

/* --- evaluation --- */

static void evaluate_wire(struct wb_section_beam *beam, int element, int w)
{
    const struct wb_section_wire *const wire = &beam->layout.wires[w];
    const size_t at = (size_t)element * (size_t)beam->layout.n_wires + (size_t)w;
    const size_t history = at * (size_t)beam->history;
    struct wb_fibres_response *const r = &beam->response[at];
    const double kappa = slope_of(beam, element, 0);
    const double strain = slope_of(beam, element, wire->unknown);

    wb_fibres_respond(beam->fibres[wire->type], strain - wire->y * kappa, kappa,
                      beam->wires_before + history, beam->wires_after + history, r);
    const double moment = wire->weight * (r->M - wire->y * r->N);
    add(beam, beam->residual, element + 1, wire->unknown, wire->weight * r->N);
    add(beam, beam->residual, element, wire->unknown, -wire->weight * r->N);
    add(beam, beam->residual, element + 1, 0, moment);
    add(beam, beam->residual, element, 0, -moment);
    beam->axial = fmax(beam->axial, fabs(r->N));
    beam->fold =
        fmax(beam->fold,
             fabs(kappa) * (fabs(wire->y) + 0.5 * beam->model->type[wire->type].outer_diameter));
}

static struct wb_section_beam_wall find_wall(const struct wb_section_beam *beam, int element,
                                             const struct wb_section_segment *segment)
{
    const double *const u = beam->u;
    const double a0 = value_of(beam, u, element, segment->unknown[0]);
    const double b0 = value_of(beam, u, element, segment->unknown[1]);
    const double a1 = value_of(beam, u, element + 1, segment->unknown[0]);
    const double b1 = value_of(beam, u, element + 1, segment->unknown[1]);
    struct wb_section_beam_wall w = {
        .e = 0.5 * (a1 + b1 - a0 - b0) / beam->h - segment->y * slope_of(beam, element, 0),
        .g = 0.5 * (b0 + b1 - a0 - a1) / segment->length,
    };
    const double e = w.e, g = w.g, g2 = g * g;

    if (beam->sheet.is_tube) {
        w.strain[0] = e;
        w.strain[2] = g;
        w.by_e[0] = w.by_g[2] = 1.0;
        return w;
    }
    w.strain[0] = e - 0.5 * e * e - 0.25 * g2;
    w.strain[1] = 0.25 * g2 - 0.25 * g2 * g2;
    w.strain[2] = g * (1.0 - 0.5 * g2);
    w.by_e[0] = 1.0 - e;
    w.by_g[0] = -0.5 * g;
    w.by_g[1] = 0.5 * g - g * g2;
    w.by_g[2] = 1.0 - 1.5 * g2;
    return w;
}

/* A segment's unknowns (theta, b_1 and b_2 at an element's first and second station), and the
 * derivatives of e and g with respect to them. */
enum {
    SEGMENT = 6
};

struct segment_shape {
    int station[SEGMENT], unknown[SEGMENT];
    double e[SEGMENT], g[SEGMENT];
};

static struct segment_shape shape_of(const struct wb_section_beam *beam, int element,
                                     const struct wb_section_segment *segment)
{
    const double along = 0.5 / beam->h, across = 0.5 / segment->length;
    const double turn = segment->y / beam->h;
    const int a = segment->unknown[0], b = segment->unknown[1], i = element, k = element + 1;
    return (struct segment_shape){
        .station = {i, i, i, k, k, k},
        .unknown = {0, a, b, 0, a, b},
        .e = {turn, -along, -along, -turn, along, along},
        .g = {0.0, -across, across, 0.0, -across, across},
    };
}

static void evaluate_segment(struct wb_section_beam *beam, int element, int s)
{
    const struct wb_section_segment *const segment = &beam->layout.segments[s];
    const size_t at = (size_t)element * (size_t)beam->layout.n_segments + (size_t)s;
    const struct wb_section_beam_wall wall = find_wall(beam, element, segment);
    const struct segment_shape shape = shape_of(beam, element, segment);
    const double volume = volume_of(beam, segment);
    const double *const stress = beam->wall[at].stress;
    double by_e = 0.0, by_g = 0.0;

    beam->walls[at] = wall;
    wb_section_sheet_respond(&beam->sheet, wall.strain, &beam->tape_before[at],
                             &beam->tape_after[at], &beam->wall[at]);
    for (int i = 0; i < 3; i++) {
        by_e += stress[i] * wall.by_e[i];
        by_g += stress[i] * wall.by_g[i];
    }
    for (int i = 0; i < SEGMENT; i++)
        add(beam, beam->residual, shape.station[i], shape.unknown[i],
            volume * (by_e * shape.e[i] + by_g * shape.g[i]));
    beam->tape_plastic = fmax(beam->tape_plastic, beam->tape_after[at].accumulated);
}

/* Friction force of a contact if it sticks. */
static double sticking_friction(const struct wb_section_beam *beam, int station, int contact)
{
    const struct wb_section_contact *const c = &beam->layout.contacts[contact];
    const size_t at = (size_t)(station - 1) * (size_t)beam->layout.n_contacts + (size_t)contact;
    const double slip = slip_of(beam, beam->u, station, c->unknown) -
                        slip_of(beam, beam->committed, station, c->unknown);
    return beam->friction_before[at] +
           beam->settings.slip_stiffness * share_of(beam, station) * slip;
}

static double limit_of(const struct wb_section_beam *beam, size_t contact)
{
    return beam->settings.is_glued ? (double)INFINITY : beam->limit[contact];
}

/* True if contacts transmit friction. */
static bool has_friction(const struct wb_section_beam *beam)
{
    return beam->friction > 0.0 || beam->settings.is_glued;
}

static void evaluate_station(struct wb_section_beam *beam, int station)
{
    const struct wb_section_layout *const layout = &beam->layout;

    for (int i = 0; i < layout->n_bonds; i++) {
        const struct wb_section_bond *const bond = &layout->bonds[i];
        const double force = bond->stiffness * share_of(beam, station) *
                             slip_of(beam, beam->u, station, bond->unknown);
        add(beam, beam->residual, station, bond->unknown[0], force);
        add(beam, beam->residual, station, bond->unknown[1], -force);
    }
    for (int i = 0; i < layout->n_contacts && has_friction(beam); i++) {
        const struct wb_section_contact *const c = &layout->contacts[i];
        const size_t at = (size_t)(station - 1) * (size_t)layout->n_contacts + (size_t)i;
        if (c->unknown[0] == c->unknown[1])
            continue;
        const double trial = sticking_friction(beam, station, i), limit = limit_of(beam, at);
        const double force = fmax(-limit, fmin(limit, trial));
        beam->friction_now[at] = force;
        beam->n_slipping += force != trial;
        add(beam, beam->residual, station, c->unknown[0], c->weight * force);
        add(beam, beam->residual, station, c->unknown[1], -c->weight * force);
    }
}

/* Computes the position of the tip and the direction of a strand. */
static void find_tip(struct wb_section_beam *beam, const struct wb_section_beam_loads *loads)
{
    struct wb_section_beam_tip tip = {.vertical = loads->vertical, .weight = loads->weight};

    for (int m = 0; m < beam->n_elements; m++) {
        const double turned = turned_at(beam, m);
        const double rise = beam->h * sin(turned);
        tip.height += beam->h * (tip.y + 0.5 * rise);
        tip.x += beam->h * cos(turned);
        tip.y += rise;
    }
    const double sine = loads->strand > 0.0 ? (beam->model->length - tip.x) / loads->strand : 0.0;
    tip.slope = sine / sqrt(1.0 - sine * sine);
    beam->tip = tip;
}

/* Vertical force transmitted by an element: the tip's minus the weight beyond its middle. */
static double vertical_through(const struct wb_section_beam *beam,
                               const struct wb_section_beam_loads *loads, int element)
{
    return loads->vertical - loads->weight * beam->h * (beam->n_elements - element - 0.5);
}

static void evaluate_loads(struct wb_section_beam *beam, const struct wb_section_beam_loads *loads)
{
    for (int m = 0; m < beam->n_elements; m++) {
        const double turned = turned_at(beam, m);
        const double up = 0.5 * beam->h * cos(turned), in = -0.5 * beam->h * sin(turned);
        const double lever = up + beam->tip.slope * in;
        const double weight = vertical_through(beam, loads, m) - loads->vertical;
        const double work = loads->vertical * lever + weight * up;
        for (int end = 0; end < 2; end++) {
            add(beam, beam->residual, m + end, 0, -work);
            add(beam, beam->lever, m + end, 0, lever);
            add(beam, beam->draw, m + end, 0, in);
        }
    }
}

/* --- pressure --- */

/* Computes the transverse loads on the wires of an element; returns the root of the sum of their
 * squares, N/m. */
static double find_load(struct wb_section_beam *beam, int element)
{
    const struct wb_section_layout *const layout = &beam->layout;
    const double kappa = slope_of(beam, element, 0);
    double mean[2] = {0.0, 0.0};

    memset(beam->load, 0, 2 * (size_t)layout->n_wires * sizeof *beam->load);
    for (int w = 0; w < layout->n_wires; w++)
        beam->load[2 * w] =
            kappa * beam->response[(size_t)element * (size_t)layout->n_wires + (size_t)w].N;
    for (int i = 0; i < layout->n_pulls; i++) {
        const struct wb_section_pull *const pull = &layout->pulls[i];
        const struct wb_section_segment *const segment = &layout->segments[pull->segment];
        const double *const stress =
            beam->wall[(size_t)element * (size_t)layout->n_segments + (size_t)pull->segment].stress;
        const double axial = stress[0] * segment->thickness * segment->length;
        const double hoop = stress[1] * segment->thickness;
        beam->load[2 * pull->wire] += pull->share * axial * kappa + hoop * pull->y;
        beam->load[2 * pull->wire + 1] += hoop * pull->z;
    }
    for (int w = 0; w < layout->n_wires; w++)
        for (int k = 0; k < 2; k++)
            mean[k] += layout->wires[w].weight * beam->load[2 * w + k] / layout->n_packing;
    if (layout->is_mirrored)
        mean[1] = 0.0;
    for (int w = 0; w < layout->n_wires; w++)
        for (int k = 0; k < 2; k++)
            beam->load[2 * w + k] -= mean[k];
    double sum = 0.0;
    for (int w = 0; w < layout->n_wires; w++)
        for (int k = 0; k < 2; k++)
            sum += layout->wires[w].weight * beam->load[2 * w + k] * beam->load[2 * w + k];
    return sqrt(sum);
}

/* Friction limits, from the contact forces of the two elements adjacent to a station. */
static void find_limits(struct wb_section_beam *beam)
{
    const int n = beam->layout.n_contacts;
    double largest = 0.0;

    beam->missing = 0.0;
    if (!(beam->friction > 0.0) || n == 0)
        return;
    for (int m = 0; m < beam->n_elements; m++) {
        largest = fmax(largest, find_load(beam, m));
        beam->missing =
            fmax(beam->missing, wb_section_pressure_solve(beam->pressure, m, beam->load,
                                                          beam->force + (size_t)m * (size_t)n));
    }
    beam->missing = largest > 0.0 ? beam->missing / largest : 0.0;
    for (int station = 1; station <= beam->n_elements; station++) {
        const double *const here = beam->force + (size_t)(station - 1) * (size_t)n;
        const double *const next = station < beam->n_elements ? here + n : here;
        double *const limit = beam->limit + (size_t)(station - 1) * (size_t)n;
        for (int i = 0; i < n; i++)
            limit[i] = beam->friction * share_of(beam, station) * 0.5 * (here[i] + next[i]);
    }
}

/* --- beam --- */

void wb_section_beam_evaluate(struct wb_section_beam *beam,
                              const struct wb_section_beam_loads *loads, bool press)
{
    const size_t size = (size_t)beam->n_unknowns * sizeof(double);

    memset(beam->residual, 0, size);
    memset(beam->lever, 0, size);
    memset(beam->draw, 0, size);
    beam->axial = beam->tape_plastic = beam->fold = 0.0;
    beam->n_slipping = 0;
    find_tip(beam, loads);
    for (int m = 0; m < beam->n_elements; m++) {
        for (int w = 0; w < beam->layout.n_wires; w++)
            evaluate_wire(beam, m, w);
        for (int s = 0; s < beam->layout.n_segments; s++)
            evaluate_segment(beam, m, s);
    }
    if (press)
        find_limits(beam);
    for (int station = 1; station <= beam->n_elements; station++)
        evaluate_station(beam, station);
    evaluate_loads(beam, loads);
}

/* --- tangent --- */

enum {
    MOST = SEGMENT
};

/* Adds a part's matrix (row-major, n x n) at unknowns of stations. Entries whose unknowns share an
 * index (of the cap, or of an image) are summed. */
static void add_matrix(struct wb_section_beam *beam, int n, const int *station, const int *unknown,
                       double matrix[MOST][MOST])
{
    int index[MOST];
    double packed[MOST * MOST];

    for (int i = 0; i < n; i++) {
        index[i] = wb_section_beam_index(beam, station[i], unknown[i]);
        for (int k = 0; k < i && index[i] >= 0; k++) {
            if (index[k] != index[i])
                continue;
            for (int j = 0; j < n; j++)
                matrix[k][j] += matrix[i][j];
            for (int j = 0; j < n; j++)
                matrix[j][k] += matrix[j][i];
            index[i] = -1;
        }
    }
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++)
            packed[i * n + k] = matrix[i][k];
    wb_layered_add(beam->matrix, n, index, packed);
}

static void add_wire(struct wb_section_beam *beam, int element, int w)
{
    const struct wb_section_wire *const wire = &beam->layout.wires[w];
    const struct wb_fibres_response *const r =
        &beam->response[(size_t)element * (size_t)beam->layout.n_wires + (size_t)w];
    const double scale = wire->weight / beam->h, y = wire->y;
    const double axial = scale * r->D11, both = scale * (r->D12 - y * r->D11);
    const double bending = scale * (r->D22 - 2.0 * y * r->D12 + y * y * r->D11);
    const double block[2][2] = {{bending, both}, {both, axial}};
    const int station[] = {element, element, element + 1, element + 1};
    const int unknown[] = {0, wire->unknown, 0, wire->unknown};
    double matrix[MOST][MOST];

    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++)
            matrix[i][k] = (i / 2 == k / 2 ? 1.0 : -1.0) * block[i % 2][k % 2];
    add_matrix(beam, 4, station, unknown, matrix);
}

static void add_segment(struct wb_section_beam *beam, int element, int s)
{
    const struct wb_section_segment *const segment = &beam->layout.segments[s];
    const size_t at = (size_t)element * (size_t)beam->layout.n_segments + (size_t)s;
    const struct wb_section_sheet_response *const r = &beam->wall[at];
    const struct wb_section_beam_wall wall = beam->walls[at];
    const struct segment_shape shape = shape_of(beam, element, segment);
    const double volume = volume_of(beam, segment);
    double ee = 0.0, eg = 0.0, gg = 0.0;
    double matrix[MOST][MOST];

    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            ee += wall.by_e[i] * r->tangent[i][k] * wall.by_e[k];
            eg += wall.by_e[i] * r->tangent[i][k] * wall.by_g[k];
            gg += wall.by_g[i] * r->tangent[i][k] * wall.by_g[k];
        }
    if (!beam->sheet.is_tube) {
        const double g = wall.g;
        ee -= r->stress[0];
        gg += -0.5 * r->stress[0] + (0.5 - 3.0 * g * g) * r->stress[1] - 3.0 * g * r->stress[2];
    }
    for (int i = 0; i < SEGMENT; i++)
        for (int k = 0; k < SEGMENT; k++)
            matrix[i][k] = volume * (ee * shape.e[i] * shape.e[k] + gg * shape.g[i] * shape.g[k] +
                                     eg * (shape.e[i] * shape.g[k] + shape.g[i] * shape.e[k]));
    add_matrix(beam, SEGMENT, shape.station, shape.unknown, matrix);
}

static void add_spring(struct wb_section_beam *beam, int station, const int unknown[2],
                       double stiffness)
{
    const int stations[] = {station, station};
    double matrix[MOST][MOST] = {{stiffness, -stiffness}, {-stiffness, stiffness}};
    add_matrix(beam, 2, stations, unknown, matrix);
}

static void add_station(struct wb_section_beam *beam, int station)
{
    const struct wb_section_layout *const layout = &beam->layout;

    for (int i = 0; i < layout->n_bonds; i++)
        add_spring(beam, station, layout->bonds[i].unknown,
                   layout->bonds[i].stiffness * share_of(beam, station));
    for (int i = 0; i < layout->n_contacts && has_friction(beam); i++) {
        const struct wb_section_contact *const c = &layout->contacts[i];
        const size_t at = (size_t)(station - 1) * (size_t)layout->n_contacts + (size_t)i;
        if (c->unknown[0] != c->unknown[1] &&
            fabs(sticking_friction(beam, station, i)) <= limit_of(beam, at))
            add_spring(beam, station, c->unknown,
                       c->weight * beam->settings.slip_stiffness * share_of(beam, station));
    }
}

bool wb_section_beam_factor(struct wb_section_beam *beam, const struct wb_section_beam_loads *loads)
{
    struct wb_layered_pivots pivots;

    wb_layered_clear(beam->matrix);
    for (int m = 0; m < beam->n_elements; m++) {
        const int station[] = {m, m + 1}, unknown[] = {0, 0};
        const double turned = turned_at(beam, m);
        const double bent = 0.25 * beam->h *
                            (vertical_through(beam, loads, m) * sin(turned) +
                             loads->vertical * beam->tip.slope * cos(turned));
        double matrix[MOST][MOST] = {{bent, bent}, {bent, bent}};
        for (int w = 0; w < beam->layout.n_wires; w++)
            add_wire(beam, m, w);
        for (int s = 0; s < beam->layout.n_segments; s++)
            add_segment(beam, m, s);
        add_matrix(beam, 2, station, unknown, matrix);
        add_station(beam, m + 1);
    }
    wb_layered_factor(beam->matrix, &pivots);
    return !pivots.singular;
}

/* --- energies --- */

/* Change of the difference of an unknown between an element's stations in the increment. */
static double change_along(const struct wb_section_beam *beam, int element, int unknown)
{
    const double *const u = beam->u, *const from = beam->committed;

    return value_of(beam, u, element + 1, unknown) - value_of(beam, u, element, unknown) -
           value_of(beam, from, element + 1, unknown) + value_of(beam, from, element, unknown);
}

/* Adds the energies that an element took up since the last commit. */
static void add_element_energies(struct wb_section_beam *beam, int element)
{
    struct wb_section_beam_energies *const e = &beam->energies;
    const struct wb_section_layout *const layout = &beam->layout;
    const double bent = change_along(beam, element, 0);

    for (int w = 0; w < layout->n_wires; w++) {
        const struct wb_section_wire *const wire = &layout->wires[w];
        const size_t at = (size_t)element * (size_t)layout->n_wires + (size_t)w;
        const struct wb_fibres_response *const now = &beam->response[at],
                                               *const before = &beam->response_before[at];
        const double stretched = change_along(beam, element, wire->unknown);
        e->wires +=
            0.5 * wire->weight *
            ((now->N + before->N) * (stretched - wire->y * bent) + (now->M + before->M) * bent);
    }
    for (int s = 0; s < layout->n_segments; s++) {
        const size_t at = (size_t)element * (size_t)layout->n_segments + (size_t)s;
        const double volume = volume_of(beam, &layout->segments[s]);
        for (int i = 0; i < 3; i++)
            e->tape += 0.5 * volume * (beam->wall[at].stress[i] + beam->stress_before[at][i]) *
                       (beam->walls[at].strain[i] - beam->strain_before[at][i]);
    }
}

static void add_station_energies(struct wb_section_beam *beam, int station)
{
    const struct wb_section_layout *const layout = &beam->layout;

    for (int i = 0; i < layout->n_bonds; i++) {
        const struct wb_section_bond *const bond = &layout->bonds[i];
        const double slip = slip_of(beam, beam->u, station, bond->unknown);
        beam->energies.bonds += 0.5 * bond->stiffness * share_of(beam, station) * slip * slip;
    }
    for (int i = 0; i < layout->n_contacts; i++) {
        const struct wb_section_contact *const c = &layout->contacts[i];
        const size_t at = (size_t)(station - 1) * (size_t)layout->n_contacts + (size_t)i;
        double slip = 0.0;
        for (int end = 0; end < 2; end++)
            slip += (end == 0 ? 1.0 : -1.0) *
                    (value_of(beam, beam->u, station, c->unknown[end]) -
                     value_of(beam, beam->committed, station, c->unknown[end]));
        beam->energies.friction +=
            0.5 * c->weight * (beam->friction_now[at] + beam->friction_before[at]) * slip;
    }
}

/* Adds the increment from the committed to the trial state. */
static void add_energies(struct wb_section_beam *beam)
{
    const struct wb_section_beam_tip *const now = &beam->tip, *const before = &beam->tip_before;

    beam->energies.external +=
        0.5 * (now->vertical + before->vertical) * (now->y - before->y) +
        0.5 * (now->vertical * now->slope + before->vertical * before->slope) *
            (now->x - before->x) -
        0.5 * (now->weight + before->weight) * (now->height - before->height);
    beam->energies.bonds = 0.0;
    for (int m = 0; m < beam->n_elements; m++) {
        add_element_energies(beam, m);
        add_station_energies(beam, m + 1);
    }
}

/* --- states --- */

void wb_section_beam_revert(struct wb_section_beam *beam)
{
    memcpy(beam->u, beam->committed, (size_t)beam->n_unknowns * sizeof(double));
}

void wb_section_beam_commit(struct wb_section_beam *beam)
{
    const size_t size = (size_t)beam->n_unknowns * sizeof(double);
    const size_t m = (size_t)beam->n_elements, n = (size_t)beam->layout.n_contacts;
    const size_t wires = m * (size_t)beam->layout.n_wires;
    const size_t segments = m * (size_t)beam->layout.n_segments;

    add_energies(beam);
    memcpy(beam->before, beam->committed, size);
    memcpy(beam->committed, beam->u, size);
    memcpy(beam->wires_before, beam->wires_after, wires * (size_t)beam->history * sizeof(double));
    memcpy(beam->response_before, beam->response, wires * sizeof *beam->response);
    memcpy(beam->tape_before, beam->tape_after, segments * sizeof *beam->tape_before);
    memcpy(beam->friction_before, beam->friction_now, m * n * sizeof(double));
    for (size_t i = 0; i < segments; i++) {
        memcpy(beam->stress_before[i], beam->wall[i].stress, sizeof beam->stress_before[i]);
        memcpy(beam->strain_before[i], beam->walls[i].strain, sizeof beam->strain_before[i]);
    }
    beam->tip_before = beam->tip;
}

void wb_section_beam_place(const struct wb_section_beam *beam, double s, double *x, double *y,
                           double *angle)
{
    *x = *y = *angle = 0.0;
    for (int m = 0; m < beam->n_elements; m++) {
        const double from = value_of(beam, beam->u, m, 0), to = value_of(beam, beam->u, m + 1, 0);
        const double part = fmin(fmax(s / beam->h - m, 0.0), 1.0);
        *x += part * beam->h * cos(0.5 * (from + to));
        *y += part * beam->h * sin(0.5 * (from + to));
        *angle += part * (to - from);
    }
}
