#include "fe/section/section_layout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "section"

enum {
    MAX_NODES = WB_SECTION_LAYOUT_MOST_NODES,
    MAX_CONTACTS = 3 * WB_PACKING_MOST
};

static const double max_gap = 0.01 * WB_MM; /* between neighbours */
static const double longest_segment = 1.2 * WB_MM;
static const double same_place = 1e-6 * WB_MM;
static const double same_diameter = 1e-3; /* of the larger */
/* Wires with a larger gap than this fraction of their radius are not neighbours. For comparison:
 * the hole between four wires on a square is 0.83 of the radius wide, that in a row of the
 * triangular lattice 1.46. */
static const double neighbour = 0.5;

/* A node of the complete outline. */
struct node {
    double y, z;
    int wire;      /* of the arc; -1: none */
    double bond;   /* width of its bond, 0: none */
    int bonded_to; /* wire; -1: none */
    int image;     /* the node that represents it */
    int unknown;   /* of that one */
};

/* A segment of the complete outline, from its node to the next. */
struct piece {
    double length;
    int wire; /* of the arc; -1: a straight piece between the wires `ends` */
    int ends[2];
    bool first, last; /* first, last segment of a straight piece */
    double y, z;      /* unit vector along it */
    int segment;      /* the segment that represents it */
};

struct outline {
    int n;
    struct node node[MAX_NODES];
    struct piece piece[MAX_NODES];
    double thickness, offset; /* m, offset: of the tape's middle from the outline */
};

struct layout_work {
    const struct wb_bundle_model *model;
    struct wb_section_layout *layout;
    int image[WB_PACKING_MOST]; /* of a wire: the wire that represents it */
    int place[WB_PACKING_MOST]; /* index of that wire in layout->wires */
    struct outline outline;
};

/* --- bundles that are not supported --- */

static const char advice[] = "compute it with --model explicit";

static enum wb_status check_wires(const struct wb_bundle_model *model, struct wb_reason *why)
{
    const struct wb_packing *const packing = &model->packing;
    struct wb_packing_pair pair[MAX_CONTACTS];

    for (int i = 1; i < packing->n; i++) {
        const double a = packing->wire[0].radius, b = packing->wire[i].radius;
        if (fabs(a - b) > same_diameter * fmax(a, b))
            return wb_fail_to(
                why, WB_ERR_UNSUPPORTED,
                "%s: wires of %g and %g mm: the section model supports only wires of one "
                "diameter, because thin wires in a mixture are loose; %s",
                model->path, 2.0 * a / WB_MM, 2.0 * b / WB_MM, advice);
    }
    if (model->wire_gap > max_gap)
        return wb_fail_to(
            why, WB_ERR_UNSUPPORTED,
            "%s: gaps: wires_mm: %g between wires: the section model supports only wires "
            "that touch (at most %g mm); %s",
            model->path, model->wire_gap / WB_MM, max_gap / WB_MM, advice);
    const double reach = neighbour * packing->wire[0].radius;
    const int n = wb_packing_pairs(packing, reach, MAX_CONTACTS, pair);
    for (int i = 0; i < n && i < MAX_CONTACTS; i++)
        if (pair[i].gap > max_gap)
            return wb_fail_to(
                why, WB_ERR_UNSUPPORTED,
                "%s: neighbours %d and %d of the packing are %.3g mm apart: the "
                "section model supports only wires that touch (at most %g mm); if they "
                "touch in the bundle, set 'touching_mm' next to places_mm to close "
                "gaps due to reading errors; %s",
                model->path, pair[i].a + 1, pair[i].b + 1, pair[i].gap / WB_MM, max_gap / WB_MM,
                advice);
    return WB_OK;
}

enum wb_status wb_section_layout_check(const struct wb_bundle_model *model, struct wb_reason *why)
{
    WB_TRY(check_wires(model, why));
    if (model->potted_length > 0.0)
        return wb_fail_to(why, WB_ERR_UNSUPPORTED,
                          "%s: ends: the section model does not support a potted length; %s",
                          model->path, advice);
    if (!model->has_tape)
        return WB_OK;
    if (model->tape.taping.kind != WB_TAPING_SLEEVE)
        return wb_fail_to(
            why, WB_ERR_UNSUPPORTED,
            "%s: taping: layout: helix: the section model supports only a sleeve, because "
            "the windings of a helix slide on each other; %s",
            model->path, advice);
    if (model->interface.has_damage)
        return wb_fail_to(
            why, WB_ERR_UNSUPPORTED,
            "%s: interface: damage: the section model does not support bonds that break; %s",
            model->path, advice);
    return WB_OK;
}

/* --- wires --- */

/* The wire at the position mirrored in the plane of bending, with the same law; -1 if there is
 * none. */
static int find_image(const struct wb_bundle_model *model, int wire)
{
    const struct wb_packing *const p = &model->packing;
    for (int i = 0; i < p->n; i++)
        if (model->type_of[i] == model->type_of[wire] &&
            fabs(p->wire[i].y - p->wire[wire].y) < same_place &&
            fabs(p->wire[i].z + p->wire[wire].z) < same_place)
            return i;
    return -1;
}

static void find_images(struct layout_work *work, bool may_mirror)
{
    const struct wb_packing *const p = &work->model->packing;
    bool mirrored = may_mirror;

    for (int i = 0; i < p->n; i++) {
        const int image = find_image(work->model, i);
        mirrored = mirrored && image >= 0;
        /* Of two image wires, the one with positive z represents both. */
        work->image[i] = image >= 0 && p->wire[i].z < -same_place ? image : i;
    }
    for (int i = 0; i < p->n && !mirrored; i++)
        work->image[i] = i;
    work->layout->is_mirrored = mirrored;
}

static void place_wires(struct layout_work *work)
{
    struct wb_section_layout *const layout = work->layout;
    const struct wb_packing *const p = &work->model->packing;

    layout->n_packing = p->n;
    for (int i = 0; i < p->n; i++) {
        if (work->image[i] != i)
            continue;
        work->place[i] = layout->n_wires;
        layout->wires[layout->n_wires++] = (struct wb_section_wire){
            .type = work->model->type_of[i],
            .unknown = layout->n_unknowns++,
            .y = p->wire[i].y,
            .z = p->wire[i].z,
            .weight = layout->is_mirrored && p->wire[i].z > same_place ? 2.0 : 1.0,
        };
    }
    for (int i = 0; i < p->n; i++)
        work->place[i] = work->place[work->image[i]];
}

/* --- contacts --- */

/* Adds the forces of a contact on the wires that are represented. */
static void add_balance(struct layout_work *work, const struct wb_packing_pair *pair, int contact)
{
    struct wb_section_layout *const layout = work->layout;
    const int ends[2] = {pair->a, pair->b};

    for (int end = 0; end < 2; end++) {
        if (work->image[ends[end]] != ends[end])
            continue;
        const double sign = end == 0 ? -1.0 : 1.0; /* pressed apart */
        double *const row = layout->balance + (size_t)(2 * work->place[ends[end]]) * MAX_CONTACTS;
        row[contact] += sign * sin(pair->direction);
        row[MAX_CONTACTS + contact] += sign * cos(pair->direction);
    }
}

/* True if two pairs of wires are images of each other. */
static bool are_images(const struct layout_work *work, const struct wb_packing_pair *a,
                       const struct wb_packing_pair *b)
{
    const struct wb_packing_circle *const w = work->model->packing.wire;
    const double ya = w[a->a].y + w[a->b].y, yb = w[b->a].y + w[b->b].y;
    const double za = w[a->a].z + w[a->b].z, zb = w[b->a].z + w[b->b].z;
    return fabs(ya - yb) < same_place && fabs(za + zb) < same_place;
}

static void find_contacts(struct layout_work *work)
{
    struct wb_section_layout *const layout = work->layout;
    struct wb_packing_pair pair[MAX_CONTACTS];
    const int most = wb_packing_pairs(&work->model->packing, max_gap, MAX_CONTACTS, pair);
    const int n = most < MAX_CONTACTS ? most : MAX_CONTACTS;
    int contact_of[MAX_CONTACTS];

    for (int i = 0; i < n; i++) {
        contact_of[i] = -1;
        for (int k = 0; k < i && layout->is_mirrored && contact_of[i] < 0; k++)
            contact_of[i] = are_images(work, &pair[i], &pair[k]) ? contact_of[k] : -1;
        if (contact_of[i] < 0) {
            contact_of[i] = layout->n_contacts++;
            const int a = work->place[pair[i].a], b = work->place[pair[i].b];
            layout->contacts[contact_of[i]] = (struct wb_section_contact){
                .unknown = {layout->wires[a].unknown, layout->wires[b].unknown}};
        }
        layout->contacts[contact_of[i]].weight += 1.0;
        add_balance(work, &pair[i], contact_of[i]);
    }
    /* Shorten the rows to the number of contacts. */
    for (int row = 0; row < 2 * layout->n_wires; row++)
        memmove(layout->balance + (size_t)row * (size_t)layout->n_contacts,
                layout->balance + (size_t)row * MAX_CONTACTS,
                (size_t)layout->n_contacts * sizeof *layout->balance);
}

/* --- the tape's outline --- */

static struct node *add_node(struct outline *outline, double y, double z, int wire)
{
    struct node *const node = &outline->node[outline->n++];
    *node = (struct node){.y = y, .z = z, .wire = wire, .bonded_to = -1};
    return node;
}

static int pieces_of(double length)
{
    return (int)fmax(1.0, ceil(length / longest_segment - 1e-9));
}

/* Nodes of an arc, with the widths of their bonds, and of the straight piece after it; an arc of
 * length zero has one node. */
static void add_arc_nodes(struct layout_work *work, const struct wb_hull *hull, int index)
{
    struct outline *const outline = &work->outline;
    const struct wb_hull_arc *const arc = &hull->arc[index];
    const struct wb_hull_arc *const next = &hull->arc[(index + 1) % hull->n_arcs];
    const struct wb_packing_circle *const wire = &hull->packing.wire[arc->wire];
    const double radius = wire->radius + outline->offset, angle = arc->to - arc->from;
    const double further = sqrt(2.0 * wire->radius * work->model->tape.reach);
    const bool is_point = angle * wire->radius < same_place;
    const int n = is_point ? 0 : 2 * pieces_of(0.5 * angle * radius);

    for (int i = 0; i <= n; i++) {
        const double at = arc->from + (n > 0 ? angle * i / n : 0.0);
        const bool is_end = i == 0 || i == n;
        struct node *const node =
            add_node(outline, wire->y + radius * sin(at), wire->z + radius * cos(at), arc->wire);
        node->bonded_to = arc->wire;
        node->bond =
            n == 0 ? 2.0 * further
                   : angle * wire->radius / n * (is_end ? 0.5 : 1.0) + (is_end ? further : 0.0);
        outline->piece[outline->n - 1] =
            (struct piece){.length = angle * radius / fmax(n, 1.0), .wire = arc->wire};
    }
    const int straight = pieces_of(arc->straight);
    const double y = outline->node[outline->n - 1].y, z = outline->node[outline->n - 1].z;
    for (int i = 0; i < straight; i++) {
        if (i > 0)
            add_node(outline, y + arc->straight * i / straight * cos(arc->to),
                     z - arc->straight * i / straight * sin(arc->to), -1);
        outline->piece[outline->n - 1] = (struct piece){
            .length = arc->straight / straight,
            .wire = -1,
            .ends = {arc->wire, next->wire},
            .first = i == 0,
            .last = i == straight - 1,
            .y = cos(arc->to),
            .z = -sin(arc->to),
        };
    }
}

/* Nodes around the only wire. */
static void add_ring_nodes(struct layout_work *work, const struct wb_packing_circle *wire)
{
    struct outline *const outline = &work->outline;
    const double radius = wire->radius + outline->offset;
    const int n = 2 * pieces_of(M_PI * radius);

    for (int i = 0; i < n; i++) {
        const double at = 0.5 * M_PI + 2.0 * M_PI * i / n;
        struct node *const node =
            add_node(outline, wire->y + radius * sin(at), wire->z + radius * cos(at), 0);
        node->bonded_to = 0;
        node->bond = 2.0 * M_PI * wire->radius / n;
        outline->piece[i] = (struct piece){.length = 2.0 * M_PI * radius / n, .wire = 0};
    }
}

static int compare(const void *a, const void *b)
{
    const double difference = *(const double *)a - *(const double *)b;
    return (difference > 0.0) - (difference < 0.0);
}

/* Directions of the wires that the circle is bonded to, ascending. */
static int bonded_directions(const struct wb_bundle_model *model, double directions[])
{
    const double radius = model->tape.hull.packing.wire[0].radius;
    int n = 0;

    for (int w = 0; w < model->packing.n; w++) {
        const struct wb_packing_circle *const wire = &model->packing.wire[w];
        const double gap = radius - hypot(wire->y, wire->z) - wire->radius;
        if (gap <= model->tape.reach + same_place)
            directions[n++] = atan2(wire->y, wire->z);
    }
    qsort(directions, (size_t)n, sizeof *directions, compare);
    return n;
}

/* Width of the bond at a line of contact between a wire and the circle: up to where the gap, w^2 /
 * 8 (1 / r - 1 / R) at half the width w, exceeds the bond's reach. */
static void bond_circle(struct layout_work *work, struct node *node, double direction)
{
    const struct wb_bundle_model *const model = work->model;
    const double radius = model->tape.hull.packing.wire[0].radius;
    const int wire =
        wb_bundle_model_tape_wire(model, radius * sin(direction), radius * cos(direction), 0.0);
    if (wire < 0)
        return;
    const struct wb_packing_circle *const w = &model->packing.wire[wire];
    const double gap = radius - hypot(w->y, w->z) - w->radius;
    node->wire = node->bonded_to = wire;
    node->bond =
        2.0 * sqrt(2.0 * fmax(model->tape.reach - gap, 0.0) / (1.0 / w->radius - 1.0 / radius));
}

static void lay_circle(struct layout_work *work)
{
    const struct wb_bundle_model *const model = work->model;
    struct outline *const outline = &work->outline;
    const struct wb_packing_circle *const circle = &model->tape.hull.packing.wire[0];
    const double radius = circle->radius + outline->offset;
    double direction[WB_PACKING_MOST + 1] = {0};
    int n = bonded_directions(model, direction);

    if (n == 0)
        direction[n++] = 0.5 * M_PI;
    direction[n] = direction[0] + 2.0 * M_PI;
    for (int i = 0; i < n; i++) {
        const double angle = direction[i + 1] - direction[i];
        const int pieces = pieces_of(angle * radius);
        for (int k = 0; k < pieces; k++) {
            const double at = direction[i] + angle * k / pieces;
            struct node *const node =
                add_node(outline, circle->y + radius * sin(at), circle->z + radius * cos(at), -1);
            if (k == 0)
                bond_circle(work, node, at);
            outline->piece[outline->n - 1] =
                (struct piece){.length = angle * radius / pieces, .wire = -1, .ends = {-1, -1}};
        }
    }
}

/* --- from the complete outline to unknowns, nodes and segments that represent images --- */

static void number_nodes(struct layout_work *work)
{
    struct outline *const outline = &work->outline;

    for (int i = 0; i < outline->n; i++) {
        struct node *const node = &outline->node[i];
        node->image = i;
        for (int k = 0; k < i && work->layout->is_mirrored; k++)
            if (fabs(node->y - outline->node[k].y) < same_place &&
                fabs(node->z + outline->node[k].z) < same_place)
                node->image = k;
        node->unknown =
            node->image == i ? work->layout->n_unknowns++ : outline->node[node->image].unknown;
    }
}

static void add_segments(struct layout_work *work)
{
    struct wb_section_layout *const layout = work->layout;
    struct outline *const outline = &work->outline;

    for (int i = 0; i < outline->n; i++) {
        const struct node *const from = &outline->node[i];
        const struct node *const to = &outline->node[(i + 1) % outline->n];
        int segment = -1;
        /* An image has the opposite direction and the opposite shear strain. */
        for (int k = 0; k < layout->n_segments && layout->is_mirrored && segment < 0; k++)
            if (layout->segments[k].unknown[0] == to->unknown &&
                layout->segments[k].unknown[1] == from->unknown)
                segment = k;
        if (segment < 0) {
            segment = layout->n_segments++;
            layout->segments[segment] = (struct wb_section_segment){
                .unknown = {from->unknown, to->unknown},
                .y = 0.5 * (from->y + to->y),
                .length = outline->piece[i].length,
                .thickness = outline->thickness,
            };
        }
        layout->segments[segment].weight += 1.0;
        outline->piece[i].segment = segment;
    }
}

static void add_bonds(struct layout_work *work)
{
    struct wb_section_layout *const layout = work->layout;

    for (int i = 0; i < work->outline.n; i++) {
        const struct node *const node = &work->outline.node[i];
        if (node->bonded_to < 0 || !(node->bond > 0.0))
            continue;
        const int wire = work->place[node->bonded_to];
        layout->bonded_width += node->bond;
        layout->bonds[layout->n_bonds++] = (struct wb_section_bond){
            .unknown = {node->unknown, layout->wires[wire].unknown},
            .stiffness = work->model->interface.shear_stiffness * node->bond,
        };
    }
}

static void add_pull(struct layout_work *work, int wire, const struct wb_section_pull *pull)
{
    struct wb_section_layout *const layout = work->layout;
    if (wire < 0 || work->image[wire] != wire)
        return;
    layout->pulls[layout->n_pulls] = *pull;
    layout->pulls[layout->n_pulls++].wire = work->place[wire];
}

static void add_pulls(struct layout_work *work)
{
    for (int i = 0; i < work->outline.n; i++) {
        const struct piece *const piece = &work->outline.piece[i];
        struct wb_section_pull pull = {.segment = piece->segment, .share = 1.0};
        if (piece->wire >= 0) {
            add_pull(work, piece->wire, &pull);
            continue;
        }
        pull.share = 0.5;
        if (piece->first) {
            pull.y = piece->y;
            pull.z = piece->z;
        }
        add_pull(work, piece->ends[0], &pull);
        pull.y = piece->last ? -piece->y : 0.0;
        pull.z = piece->last ? -piece->z : 0.0;
        add_pull(work, piece->ends[1], &pull);
    }
}

static void lay_tape(struct layout_work *work)
{
    const struct wb_bundle_tape *const tape = &work->model->tape;
    struct outline *const outline = &work->outline;

    outline->thickness = wb_taping_thickness(&tape->taping);
    outline->offset = tape->gap + 0.5 * outline->thickness;
    if (tape->round)
        lay_circle(work);
    else if (tape->hull.n_arcs == 1)
        add_ring_nodes(work, &tape->hull.packing.wire[0]);
    else
        for (int i = 0; i < tape->hull.n_arcs; i++)
            add_arc_nodes(work, &tape->hull, i);
}

/* --- layout --- */

static void take_memory(struct wb_section_layout *layout)
{
    struct wb_memory *const m = &layout->memory;

    layout->wires = wb_memory_take(m, WB_PACKING_MOST, sizeof *layout->wires);
    layout->contacts = wb_memory_take(m, MAX_CONTACTS, sizeof *layout->contacts);
    layout->balance =
        wb_memory_take(m, 2 * WB_PACKING_MOST * MAX_CONTACTS, sizeof *layout->balance);
    layout->segments = wb_memory_take(m, MAX_NODES, sizeof *layout->segments);
    layout->bonds = wb_memory_take(m, MAX_NODES, sizeof *layout->bonds);
    layout->pulls = wb_memory_take(m, 2 * MAX_NODES, sizeof *layout->pulls);
}

enum wb_status wb_section_layout_create(struct wb_section_layout *layout,
                                        const struct wb_bundle_model *model, bool may_mirror)
{
    *layout = (struct wb_section_layout){.n_unknowns = 1};
    WB_TRY(wb_section_layout_check(model, NULL));
    struct layout_work *const work = wb_memory_new(1, sizeof *work);
    take_memory(layout);
    work->model = model;
    work->layout = layout;
    find_images(work, may_mirror);
    place_wires(work);
    find_contacts(work);
    if (model->has_tape)
        lay_tape(work);
    number_nodes(work);
    add_segments(work);
    add_bonds(work);
    add_pulls(work);
    free(work);
    return WB_OK;
}

void wb_section_layout_release(struct wb_section_layout *layout)
{
    wb_memory_release(&layout->memory);
    *layout = (struct wb_section_layout){0};
}
