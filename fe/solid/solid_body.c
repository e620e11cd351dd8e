#include "fe/solid/solid_body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fe/material/hardening.h"

#define WB_LOG_DOMAIN "solid"

static enum wb_status number_equations(struct wb_solid_body *body,
                                       const struct wb_solid_model *model)
{
    const struct wb_solid_mesh *mesh = body->mesh;
    int n = 0;

    for (int i = 0; i < 3 * mesh->n_nodes; i++)
        body->equation[i] = 0;
    for (int i = 0; i < model->n_supports; i++) {
        const struct wb_solid_support *s = &model->supports[i];
        if (s->node < 0 || s->node >= mesh->n_nodes || s->axis < 0 || s->axis > 2)
            return wb_fail(WB_ERR_ARGUMENT, "support %d: axis %d of node %d does not exist", i,
                           s->axis, s->node);
        body->equation[3 * s->node + s->axis] = -1;
    }
    for (int i = 0; i < 3 * mesh->n_nodes; i++)
        if (body->equation[i] == 0)
            body->equation[i] = n++;
    body->n_equations = n;
    return n > 0 ? WB_OK
                 : wb_fail(WB_ERR_ARGUMENT,
                           "all displacements are prescribed: the body has no unknowns");
}

/* Number of equations of nodes before `node`. */
static int equations_before(const struct wb_solid_body *body, int node)
{
    for (int i = 3 * node; i < 3 * body->mesh->n_nodes; i++)
        if (body->equation[i] >= 0)
            return body->equation[i];
    return body->n_equations;
}

static enum wb_status create_tangent(struct wb_solid_body *body)
{
    const struct wb_solid_mesh *mesh = body->mesh;
    const size_t n = (size_t)mesh->n_layers;
    int *const first = wb_memory_new(n + 1, sizeof *first);
    int *const link = wb_memory_new(n, sizeof *link);

    for (int l = 0; l <= mesh->n_layers; l++)
        first[l] = equations_before(body, mesh->layer[l]);
    for (int l = 0; l < mesh->n_layers; l++)
        link[l] = equations_before(body, mesh->link[l]);
    const enum wb_status status =
        wb_layered_create(&body->tangent, mesh->n_layers, first, link, !body->has_contact);
    free(first);
    free(link);
    return status;
}

static void gather_positions(const struct wb_solid_mesh *mesh, int e,
                             double position[WB_HEX20_NODES][3])
{
    for (int a = 0; a < WB_HEX20_NODES; a++)
        memcpy(position[a], mesh->node[mesh->element[e][a]], sizeof position[a]);
}

static enum wb_status prepare_elements(struct wb_solid_body *body,
                                       const struct wb_solid_model *model)
{
    const struct wb_solid_mesh *mesh = body->mesh;

    for (int e = 0; e < mesh->n_elements; e++) {
        double position[WB_HEX20_NODES][3], share[WB_HEX20_NODES];
        gather_positions(mesh, e, position);
        if (!wb_hex20_geometry_init(&body->geometry[e], body->integration,
                                    (const double(*)[3])position))
            return wb_fail(WB_ERR_ARGUMENT, "element %d near (%g, %g, %g) m is inverted", e,
                           position[0][0], position[0][1], position[0][2]);
        wb_hex20_volume_weights((const double(*)[3])position, share);
        const double density = body->parts[mesh->part[e]].density;
        for (int a = 0; a < WB_HEX20_NODES; a++)
            for (int i = 0; i < 3; i++)
                body->weight[3 * mesh->element[e][a] + i] += density * share[a] * model->gravity[i];
    }
    return WB_OK;
}

static bool are_finite(const double *x, size_t n)
{
    bool finite = true;
    for (size_t i = 0; i < n; i++)
        finite = finite && isfinite(x[i]);
    return finite;
}

static enum wb_status check_loads(const struct wb_solid_model *model)
{
    bool finite = are_finite(model->gravity, 3);
    for (int i = 0; i < model->n_supports; i++)
        finite = finite && isfinite(model->supports[i].displacement);
    if (model->nodal_force)
        finite = finite && are_finite(model->nodal_force[0], 3 * (size_t)model->mesh->n_nodes);
    return finite ? WB_OK
                  : wb_fail(WB_ERR_ARGUMENT, "gravity, a support or a nodal force is not a finite "
                                             "number");
}

static enum wb_status check_model(const struct wb_solid_model *model)
{
    const struct wb_solid_mesh *mesh = model->mesh;
    char why[120];

    if (!mesh || mesh->n_elements < 1 || !model->parts)
        return wb_fail(WB_ERR_ARGUMENT, "a body needs a mesh with elements, and parts");
    for (int p = 0; p < mesh->n_parts; p++) {
        const struct wb_material *m = &model->parts[p].material;
        if (!(m->youngs_modulus > 0.0 && m->poissons_ratio > -1.0 && m->poissons_ratio < 0.5 &&
              isfinite(m->youngs_modulus) && model->parts[p].density >= 0.0 &&
              isfinite(model->parts[p].density)))
            return wb_fail(WB_ERR_ARGUMENT,
                           "part %d: Young's modulus %g Pa, Poisson's ratio %g, density %g kg/m3: "
                           "expected above 0, between -1 and 0.5, 0 or more",
                           p, m->youngs_modulus, m->poissons_ratio, model->parts[p].density);
        if (!wb_hardening_is_possible(m, why, sizeof why))
            return wb_fail(WB_ERR_ARGUMENT, "part %d: %s", p, why);
    }
    for (int e = 0; e < mesh->n_elements; e++)
        if (mesh->part[e] < 0 || mesh->part[e] >= mesh->n_parts)
            return wb_fail(WB_ERR_ARGUMENT, "element %d belongs to no part", e);
    return check_loads(model);
}

enum wb_status wb_solid_body_init(struct wb_solid_body *body, const struct wb_solid_model *model)
{
    *body = (struct wb_solid_body){.mesh = model->mesh, .integration = model->integration};
    WB_TRY(check_model(model));

    const struct wb_solid_mesh *mesh = model->mesh;
    const size_t n = 3 * (size_t)mesh->n_nodes, elements = (size_t)mesh->n_elements;
    body->n_points = wb_hex20_points(model->integration);
    body->has_contact = model->jacket_contact && mesh->n_pairs > 0;
    if (body->has_contact)
        body->jacket_contact = *model->jacket_contact;
    const size_t points = elements * (size_t)body->n_points;
    const size_t contacts =
        body->has_contact ? (size_t)mesh->n_pairs * WB_JACKET_CONTACT_POINTS : 1;

    body->parts = wb_memory_take(&body->memory, (size_t)mesh->n_parts, sizeof *body->parts);
    body->geometry = wb_memory_take(&body->memory, elements, sizeof *body->geometry);
    body->equation = wb_memory_take(&body->memory, n, sizeof *body->equation);
    body->committed = wb_memory_take(&body->memory, points, sizeof *body->committed);
    body->trial = wb_memory_take(&body->memory, points, sizeof *body->trial);
    body->committed_pairs = wb_memory_take(&body->memory, contacts, sizeof *body->committed_pairs);
    body->trial_pairs = wb_memory_take(&body->memory, contacts, sizeof *body->trial_pairs);
    body->weight = wb_memory_take(&body->memory, n, sizeof *body->weight);
    body->force = wb_memory_take(&body->memory, n, sizeof *body->force);
    body->element_stiffness =
        wb_memory_take(&body->memory, WB_HEX20_UNKNOWNS * WB_HEX20_UNKNOWNS, sizeof(double));

    memcpy(body->parts, model->parts, (size_t)mesh->n_parts * sizeof *body->parts);
    enum wb_status status = number_equations(body, model);
    if (status == WB_OK)
        status = prepare_elements(body, model);
    if (status == WB_OK)
        status = create_tangent(body);
    if (status != WB_OK)
        wb_solid_body_release(body);
    return status;
}

void wb_solid_body_release(struct wb_solid_body *body)
{
    wb_memory_release(&body->memory);
    wb_layered_destroy(body->tangent);
    *body = (struct wb_solid_body){0};
}

/* Data of one assembly. */
struct assembly {
    struct wb_solid_body *body;
    const double *u;
    bool stiffness;
    const double *held_change; /* NULL: none */
    double *held_force;
    struct wb_solid_body_result *result;
};

/* Adds the tangent times the change of prescribed displacements, for the nodes of one element or
 * pair. */
static void add_held(const struct assembly *a, int n_nodes, const int *node, const double *matrix)
{
    const int n = 3 * n_nodes;

    for (int c = 0; c < n; c++) {
        const int held = 3 * node[c / 3] + c % 3;
        const double change = a->held_change[held];
        if (a->body->equation[held] >= 0 || change == 0.0)
            continue;
        for (int r = 0; r < n; r++)
            a->held_force[3 * node[r / 3] + r % 3] += matrix[n * r + c] * change;
    }
}

static void scatter(const struct assembly *a, int n_nodes, const int *node, const double *force,
                    const double *matrix)
{
    int index[WB_HEX20_UNKNOWNS];

    for (int k = 0; k < n_nodes; k++)
        for (int i = 0; i < 3; i++) {
            a->body->force[3 * node[k] + i] += force[3 * k + i];
            index[3 * k + i] = a->body->equation[3 * node[k] + i];
        }
    if (!a->stiffness)
        return;
    wb_layered_add(a->body->tangent, 3 * n_nodes, index, matrix);
    if (a->held_change)
        add_held(a, n_nodes, node, matrix);
}

static bool add_element(const struct assembly *a, int e)
{
    struct wb_solid_body *body = a->body;
    const struct wb_solid_mesh *mesh = body->mesh;
    const size_t first = (size_t)e * (size_t)body->n_points;
    double u[WB_HEX20_UNKNOWNS], force[WB_HEX20_UNKNOWNS];
    struct wb_hex20_result result;

    for (int k = 0; k < WB_HEX20_NODES; k++)
        memcpy(u + 3 * k, a->u + 3 * mesh->element[e][k], 3 * sizeof *u);
    if (!wb_hex20_evaluate(&body->geometry[e], body->integration,
                           &body->parts[mesh->part[e]].material, u, body->committed + first,
                           body->trial + first, force,
                           a->stiffness ? body->element_stiffness : NULL, &result)) {
        a->result->possible = false;
        a->result->worst_element = e;
        return false;
    }
    scatter(a, WB_HEX20_NODES, mesh->element[e], force, body->element_stiffness);
    a->result->elastic += result.elastic_energy;
    a->result->dissipated += result.dissipated;
    return true;
}

static void collect_contact(struct wb_jacket_contact_result *all,
                            const struct wb_jacket_contact_result *one)
{
    all->penetration = fmax(all->penetration, one->penetration);
    all->opening = fmax(all->opening, one->opening);
    all->slip = fmax(all->slip, one->slip);
    all->sliding = fmax(all->sliding, one->sliding);
    all->pressure = fmax(all->pressure, one->pressure);
    all->dissipated += one->dissipated;
    all->stored += one->stored;
    all->touching += one->touching;
    all->slipping += one->slipping;
}

static void add_pair(const struct assembly *a, int p)
{
    enum {
        HALF = WB_SOLID_MESH_FACE
    };
    struct wb_solid_body *body = a->body;
    const struct wb_solid_mesh *mesh = body->mesh;
    const size_t first = (size_t)p * WB_JACKET_CONTACT_POINTS;
    double position[2 * HALF][3], u[WB_JACKET_CONTACT_UNKNOWNS], force[WB_JACKET_CONTACT_UNKNOWNS];
    int node[2 * HALF];
    struct wb_jacket_contact_result result;

    for (int k = 0; k < HALF; k++) {
        node[k] = mesh->pair[p].inner[k];
        node[HALF + k] = mesh->pair[p].outer[k];
    }
    for (int k = 0; k < 2 * HALF; k++) {
        memcpy(position[k], mesh->node[node[k]], sizeof position[k]);
        memcpy(u + 3 * k, a->u + 3 * node[k], 3 * sizeof *u);
    }
    wb_jacket_contact_evaluate(&body->jacket_contact, (const double(*)[3])position, u,
                               body->committed_pairs + first, body->trial_pairs + first, force,
                               a->stiffness ? body->element_stiffness : NULL, &result);
    scatter(a, 2 * HALF, node, force, body->element_stiffness);
    collect_contact(&a->result->jacket_contact, &result);
    a->result->elastic += result.stored;
}

static void assemble(const struct assembly *a)
{
    struct wb_solid_body *body = a->body;
    const struct wb_solid_mesh *mesh = body->mesh;

    *a->result = (struct wb_solid_body_result){.possible = true, .worst_element = -1};
    memset(body->force, 0, 3 * (size_t)mesh->n_nodes * sizeof *body->force);
    if (a->stiffness)
        wb_layered_clear(body->tangent);
    for (int e = 0; e < mesh->n_elements; e++)
        if (!add_element(a, e))
            return;
    for (int p = 0; body->has_contact && p < mesh->n_pairs; p++)
        add_pair(a, p);
    a->result->friction = a->result->jacket_contact.dissipated;
    for (int i = 0; i < 3 * mesh->n_nodes; i++)
        if (!isfinite(body->force[i])) {
            a->result->possible = false;
            return;
        }
}

void wb_solid_body_evaluate(struct wb_solid_body *body, const double *u, bool stiffness,
                            const double *held_change, double *held_force,
                            struct wb_solid_body_result *result)
{
    const struct assembly a = {body, u, stiffness, held_change, held_force, result};
    assemble(&a);
}

void wb_solid_body_commit(struct wb_solid_body *body)
{
    const struct wb_solid_mesh *mesh = body->mesh;
    struct wb_solid_point_state *states = body->committed;

    body->committed = body->trial;
    body->trial = states;
    if (body->has_contact)
        memcpy(body->committed_pairs, body->trial_pairs,
               (size_t)mesh->n_pairs * WB_JACKET_CONTACT_POINTS * sizeof *body->committed_pairs);
}
