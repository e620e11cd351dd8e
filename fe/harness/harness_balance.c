#include <math.h>
#include <string.h>

#include "base/vec3.h"
#include "fe/harness/harness_contact.h"
#include "fe/harness/harness_slide.h"
#include "fe/harness/harness_state.h"

static void evaluate_point(struct wb_harness *h, const struct wb_harness_element *element, int g)
{
    const struct wb_rod_strain *const at = &h->trial[g];
    struct wb_rod_point *const p = &h->points[g];
    const size_t row = element->history + (size_t)(g % POINTS) * element->row;
    double strain[WB_ROD_SECTION_STRAINS];

    strain[0] = at->stretch[0];
    memcpy(strain + 1, at->curvature, sizeof at->curvature);
    wb_law_section_respond(element->section, strain, h->history + row, h->trial_history + row,
                           &p->section);
    wb_rod_element_turn_forces(p, at->stretch + 1);
}

static void add_element(struct wb_harness *h, int e, double weight,
                        struct wb_harness_balance *balance)
{
    /* A weight consistent with quadratic motions: 1/6, 4/6, 1/6 of an element's. */
    static const double parts[NODES] = {1.0, 4.0, 1.0};
    const struct wb_harness_element *const element = &h->elements[e];
    double f[U * NODES] = {0};
    for (int g = 0; g < POINTS; g++) {
        evaluate_point(h, element, e * POINTS + g);
        wb_rod_element_add_forces(&element->shape, g, &h->points[e * POINTS + g], f);
    }
    for (int i = 0; i < NODES; i++) {
        double *const to = h->residual[wb_harness_node_of(h, e, i)];
        balance->largest_force =
            wb_larger(balance->largest_force, wb_rod_element_force_size(f + U * i, h->lever));
        const double share = weight * parts[i] * element->shape.length / 6.0;
        for (int k = 0; k < U; k++)
            to[k] += f[U * i + k] - (k < 3 ? share * element->weight[k] : 0.0);
    }
}

static void add_bodies(struct wb_harness *h, double weight)
{
    for (int i = 0; i < h->n_bodies; i++) {
        double arm[3], force[3], moment[3];
        double *const r = h->residual[wb_harness_body_arm(h, &h->bodies[i], arm, force)];
        wb_vec3_cross(arm, force, moment);
        for (int k = 0; k < 3; k++) {
            r[k] -= weight * force[k];
            r[3 + k] -= weight * moment[k];
        }
    }
}

static void add_drag(struct wb_harness *h)
{
    for (int i = 0; i < h->n_nodes; i++) {
        double motion[U];
        wb_harness_motion(&h->committed_nodes[i], wb_harness_any_node(h, i), motion);
        for (int k = 0; k < U; k++)
            h->residual[i][k] += wb_harness_drag_of(h->width[i], k) *
                                 (h->drag * motion[k] - h->carried * h->motion[i][k]);
    }
}

static void check_node(const struct wb_harness *h, int node, struct wb_harness_balance *balance)
{
    double left[U];
    memcpy(left, h->residual[node], sizeof left);
    if (wb_harness_is_held(h, node)) {
        struct wb_harness_held held;
        wb_harness_look_at_hold(h, node, &held);
        wb_harness_turn_basis(&held, false, left);
        for (int k = 0; k < U; k++)
            left[k] = held.is[k] ? 0.0 : left[k];
        balance->farthest_hold = wb_larger(balance->farthest_hold, wb_vec3_length(held.way));
        balance->farthest_turn = wb_larger(balance->farthest_turn, wb_vec3_length(held.way + 3));
    }
    wb_harness_balance_add(balance, wb_rod_element_force_size(left, h->lever),
                           node < h->n_joints ? node : node - h->n_joints + 1);
}

void wb_harness_evaluate(struct wb_harness *h, double weight, struct wb_harness_balance *balance)
{
    *balance = (struct wb_harness_balance){0};
    memset(h->residual, 0, (size_t)h->n_nodes * sizeof *h->residual);
    for (int j = 0; j < h->n_joints; j++) {
        for (int k = 0; k < U; k++)
            h->residual[j][k] = -h->joints[j].load[k];
    }
    for (int e = 0; e < h->n_elements; e++)
        add_element(h, e, weight, balance);
    add_bodies(h, weight);
    if (h->drag > 0.0)
        add_drag(h);
    wb_harness_slide_add_forces(h, balance);
    wb_harness_contact_add_forces(h, balance);
    for (int i = 0; i < h->n_nodes; i++)
        check_node(h, i, balance);
    h->weight = weight;
    h->largest_force = balance->largest_force;
}
