/* How joints are held, and where the holds let the wire go. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/vec3.h"
#include "fe/harness/harness_state.h"

static struct wb_harness_clip *find_clip(const struct wb_harness *h, int joint)
{
    for (int i = 0; i < h->n_clips; i++) {
        if (h->clips[i].joint == joint)
            return &h->clips[i];
    }
    return NULL;
}

void wb_harness_set_hold(struct wb_harness *h, int joint, enum wb_harness_hold hold,
                         const struct wb_rod_node *target)
{
    struct wb_harness_clip *const clip = find_clip(h, joint);
    if (clip && hold != WB_HARNESS_SLIDE)
        *clip = h->clips[--h->n_clips];
    h->joints[joint].hold = hold;
    if (hold != WB_HARNESS_FREE)
        h->joints[joint].target = *target;
}

void wb_harness_let_slide(struct wb_harness *h, int joint, double friction)
{
    assert(joint > 0 && h->n_clips < h->most_clips);
    wb_harness_set_hold(h, joint, WB_HARNESS_SLIDE, wb_harness_joint_node(h, joint));
    struct wb_harness_clip *const clip = &h->clips[h->n_clips++];
    *clip = (struct wb_harness_clip){.joint = joint, .friction = friction};
    clip->branch = wb_harness_place_of(h, joint, &clip->now.s);
    clip->begin = clip->now.s;
    clip->committed = clip->earlier = clip->now;
}

enum wb_harness_hold wb_harness_hold(const struct wb_harness *harness, int joint)
{
    return harness->joints[joint].hold;
}

double wb_harness_slid(const struct wb_harness *harness, int joint)
{
    const struct wb_harness_clip *const clip = find_clip(harness, joint);
    return clip ? clip->now.s - clip->begin : 0.0;
}

struct wb_rod_node wb_harness_held_node(const struct wb_harness *harness, int joint)
{
    const struct wb_harness_clip *const clip = find_clip(harness, joint);
    return clip ? wb_harness_position(harness, clip->branch, clip->now.s)
                : *wb_harness_joint_node(harness, joint);
}

void wb_harness_reaction(const struct wb_harness *harness, int joint, double reaction[6])
{
    const struct wb_harness_clip *const clip = find_clip(harness, joint);
    memset(reaction, 0, U * sizeof *reaction);
    if (clip)
        memcpy(reaction, clip->now.force, sizeof clip->now.force);
    else
        memcpy(reaction, harness->residual[joint], U * sizeof *reaction);
}

void wb_harness_turn_to(const struct wb_harness *harness, int joint, const struct wb_rod_node *from,
                        const struct wb_rod_node *to, double vector[3])
{
    double aim[9];
    memset(vector, 0, 3 * sizeof *vector);
    if (harness->joints[joint].hold == WB_HARNESS_FIXED) {
        wb_rod_element_turn_between(from->rotation, to->rotation, vector);
    } else if (harness->joints[joint].hold == WB_HARNESS_AXIS) {
        wb_rod_element_matrix(to->rotation, aim);
        const double wanted[3] = {aim[0], aim[3], aim[6]};
        wb_rod_element_turn_axis(from->rotation, wanted, vector);
    }
}

/* Rows of the basis: the columns of a rotation. */
static void set_axes(double *axes, const double *rotation)
{
    double R[9];
    wb_rod_element_matrix(rotation, R);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            axes[3 * i + k] = R[3 * k + i];
    }
}

void wb_harness_look_at_hold(const struct wb_harness *h, int joint, struct wb_harness_held *held)
{
    static const double space[4] = {1.0, 0.0, 0.0, 0.0};
    const struct wb_harness_joint *const j = &h->joints[joint];
    const struct wb_rod_node *const now = wb_harness_joint_node(h, joint);
    double way[3], spin[3];
    set_axes(held->axes[0], j->hold == WB_HARNESS_PLANE ? j->target.rotation : space);
    set_axes(held->axes[1], j->hold == WB_HARNESS_AXIS ? now->rotation : space);
    wb_harness_turn_to(h, joint, now, &j->target, spin);
    for (int k = 0; k < 3; k++)
        way[k] = j->target.position[k] - now->position[k];
    for (int k = 0; k < 3; k++) {
        held->is[k] = j->hold != WB_HARNESS_PLANE || k == 0;
        held->is[3 + k] = j->hold == WB_HARNESS_FIXED || (j->hold == WB_HARNESS_AXIS && k > 0);
        held->way[k] = held->is[k] ? wb_vec3_dot(held->axes[0] + 3 * k, way) : 0.0;
        held->way[3 + k] = held->is[3 + k] ? wb_vec3_dot(held->axes[1] + 3 * k, spin) : 0.0;
    }
}

void wb_harness_turn_basis(const struct wb_harness_held *held, bool back, double vector[U])
{
    for (int half = 0; half < 2; half++) {
        double *const v = vector + 3 * half, turned[3];
        if (back)
            wb_vec3_turn_back(held->axes[half], v, turned);
        else
            wb_vec3_turn(held->axes[half], v, turned);
        memcpy(v, turned, sizeof turned);
    }
}
