#include "fe/harness/harness_slide.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"

/* Forces below this part of the largest internal force do not move a wire on. */
static const double small_force = 1e-9;

/* What of a branch is in a clip. */
struct inside {
    int element;
    double N[NODES], dN[NODES];
    double position[3], slope[3], bend[3]; /* and its derivatives */
    double axis[3];                        /* unit vector along the wire */
    double along, across[3], size;         /* the clip's force, the length of `across` */
};

static void look_inside(const struct wb_harness *h, const struct wb_harness_clip *clip,
                        struct inside *in)
{
    const int e = wb_harness_element_at(h, clip->branch, clip->now.s);
    const struct wb_rod_node at = wb_harness_position(h, clip->branch, clip->now.s);
    double R[9];
    const struct wb_rod_node *const node = &h->placed[NODES * e];
    const double length = h->elements[e].shape.length;
    in->element = e;
    wb_rod_shape_at(2.0 * (clip->now.s - h->elements[e].begin) / length - 1.0, length, in->N,
                    in->dN);
    wb_rod_element_matrix(at.rotation, R);
    for (int k = 0; k < 3; k++) {
        in->position[k] = at.position[k];
        in->slope[k] = 0.0;
        for (int i = 0; i < NODES; i++)
            in->slope[k] += in->dN[i] * node[i].position[k];
        in->bend[k] = 4.0 / (length * length) *
                      (node[0].position[k] - 2.0 * node[1].position[k] + node[2].position[k]);
        in->axis[k] = R[3 * k];
    }
    in->along = wb_vec3_dot(clip->now.force, in->axis);
    for (int k = 0; k < 3; k++)
        in->across[k] = clip->now.force[k] - in->along * in->axis[k];
    in->size = wb_vec3_length(in->across);
}

/* The friction over the force across the wire; positive where s has become larger. */
static double friction_of(const struct wb_harness *h, const struct wb_harness_clip *clip)
{
    return clip->friction * wb_harness_clip_slip(h, clip);
}

void wb_harness_slide_add_forces(struct wb_harness *h, struct wb_harness_balance *balance)
{
    for (int i = 0; i < h->n_clips; i++) {
        const struct wb_harness_clip *const clip = &h->clips[i];
        struct inside in;
        look_inside(h, clip, &in);
        for (int n = 0; n < NODES; n++) {
            double *const to = h->residual[wb_harness_node_of(h, in.element, n)];
            for (int k = 0; k < 3; k++)
                to[k] -= in.N[n] * clip->now.force[k];
        }
        if (!clip->now.is_at_end)
            wb_harness_balance_add(balance, fabs(in.along - friction_of(h, clip) * in.size),
                                   clip->joint);
        balance->farthest_hold =
            wb_larger(balance->farthest_hold,
                      wb_vec3_distance(in.position, h->joints[clip->joint].target.position));
    }
}

/* Derivatives of r(s) = place and, where the wire slides, of f . t = m |f - (f . t) t| for m the
 * friction and t the direction of the wire, of which the derivatives are taken from r'. */
void wb_harness_slide_equations(const struct wb_harness *h, const struct wb_harness_clip *clip,
                                struct wb_harness_equation equations[WB_HARNESS_CLIP])
{
    const double *const target = h->joints[clip->joint].target.position;
    const double *const f = clip->now.force;
    struct inside in;
    double q[3], across[3];
    look_inside(h, clip, &in);
    for (int i = 0; i < WB_HARNESS_CLIP; i++)
        equations[i] = (struct wb_harness_equation){.element = in.element};
    const double m = friction_of(h, clip);
    const bool sticks = fabs(wb_harness_clip_slip(h, clip)) < 1.0;
    for (int k = 0; k < 3; k++) {
        across[k] = in.size > 0.0 ? in.across[k] / in.size : 0.0;
        q[k] = f[k] - m * (in.axis[k] * in.size - in.along * across[k]);
    }
    for (int n = 0; n < NODES; n++) {
        for (int k = 0; k < 3; k++) {
            equations[0].force[n][k] = -in.dN[n] * f[k];
            equations[1 + k].force[n][k] = -in.N[n];
            equations[0].row[n][k] = -in.dN[n] * q[k];
            equations[1 + k].row[n][k] = -in.N[n];
        }
    }
    equations[0].own[0] = -wb_vec3_dot(q, in.bend) +
                          (sticks ? clip->friction * in.size / wb_harness_presliding(h) : 0.0);
    equations[0].right = in.along - m * in.size;
    for (int k = 0; k < 3; k++) {
        equations[0].own[1 + k] = -in.axis[k] + m * across[k];
        equations[1 + k].own[0] = -in.slope[k];
        equations[1 + k].right = in.position[k] - target[k];
    }
    if (clip->now.is_at_end) {
        memset(equations[0].row, 0, sizeof equations[0].row);
        memset(equations[0].own, 0, sizeof equations[0].own);
        equations[0].own[0] = 1.0;
        equations[0].right =
            (clip->now.s > 0.0 ? h->branches[clip->branch].length : 0.0) - clip->now.s;
    }
}

/* True if a clip's wire stops or moves on. */
static bool adapt(const struct wb_harness *h, struct wb_harness_clip *clip)
{
    struct wb_harness_sliding *const now = &clip->now;
    const double length = h->branches[clip->branch].length;
    const double small = fmax(small_force * h->largest_force, h->noise);
    struct inside in;
    if (!now->is_at_end) {
        now->is_at_end = !(now->s > 0.0 && now->s < length);
        return now->is_at_end;
    }
    /* A clip that pushes the wire forwards keeps it from going back, which makes s larger. */
    look_inside(h, clip, &in);
    if ((now->s > 0.0) == (in.along > 0.0) || fabs(in.along) <= clip->friction * in.size + small)
        return false;
    now->is_at_end = false;
    now->s = fmin(fmax(now->s, 1e-9 * length), (1.0 - 1e-9) * length);
    return true;
}

int wb_harness_adapt(struct wb_harness *h)
{
    int changed = 0;
    for (int i = 0; i < h->n_clips; i++)
        changed += adapt(h, &h->clips[i]);
    return changed;
}
