#include "analysis/harness/harness_found.h"

#include <math.h>

#include "base/vec3.h"

/* Part of a force by which it must differ; forces below this part of the largest one on the way are
 * as good as zero. */
static const double twist_sensitive = 0.1, as_zero = 1e-3;

bool wb_harness_found_is_twist_sensitive(const struct wb_harness_force *force)
{
    return fabs(force->soft_force - force->size) >
           twist_sensitive * fmax(force->size, as_zero * force->largest);
}

int wb_harness_found_farthest(const struct wb_harness_result_set *set, int step)
{
    double largest = 0.0;
    int farthest = 0;
    for (int i = 0; i < set->n_places; i++) {
        const double way =
            wb_vec3_distance(set->natural[i].position, set->results[step].places[i].position);
        if (way > largest) {
            largest = way;
            farthest = i;
        }
    }
    return farthest;
}

bool wb_harness_found_is_beyond(const struct wb_harness_result_set *set, int branch)
{
    return set->n_steps > 0 && set->results[set->n_steps - 1].branches[branch].is_beyond;
}

void wb_harness_found_largest(const struct wb_harness_result_set *set, int item,
                              struct wb_harness_extreme *force, struct wb_harness_extreme *moment)
{
    *force = *moment = (struct wb_harness_extreme){.of = item};
    for (int i = 0; i < set->n_steps; i++) {
        const struct wb_harness_force *const f = &set->results[i].forces[item];
        if (f->largest > force->value) {
            force->value = f->largest;
            force->step = i;
        }
        if (f->largest_moment > moment->value) {
            moment->value = f->largest_moment;
            moment->step = i;
        }
    }
}

struct wb_harness_extreme wb_harness_found_radius(const struct wb_harness_result_set *set,
                                                  int branch)
{
    struct wb_harness_extreme least = {.value = (double)INFINITY, .of = branch};
    for (int i = 0; i < set->n_steps; i++) {
        const struct wb_harness_branch_result *const b = &set->results[i].branches[branch];
        if (b->least_radius < least.value)
            least = (struct wb_harness_extreme){b->least_radius, branch, i, b->at};
    }
    return least;
}

int wb_harness_found_exceeds_radius(const struct wb_harness_result_set *set, int branch)
{
    for (int i = 0; i < set->n_steps; i++) {
        if (set->results[i].branches[branch].exceeds_radius)
            return i;
    }
    return -1;
}

static void collect_item(struct wb_harness_found *found, const struct wb_harness_result_set *set,
                         int index)
{
    const struct wb_harness_item *const item = &set->plan->items[index];
    struct wb_harness_extreme force, moment;
    bool depends = false;
    wb_harness_found_largest(set, index, &force, &moment);
    if (force.value > found->force.value)
        found->force = force;
    found->n_limits += (item->largest_force > 0.0) + (item->largest_moment > 0.0);
    found->n_exceeded += (item->largest_force > 0.0 && force.value > item->largest_force) +
                         (item->largest_moment > 0.0 && moment.value > item->largest_moment);
    for (int i = 0; i < set->n_steps && !depends; i++)
        depends = wb_harness_found_is_twist_sensitive(&set->results[i].forces[index]);
    found->n_twist += depends;
}

static void collect_branch(struct wb_harness_found *found, const struct wb_harness_result_set *set,
                           int branch)
{
    const struct wb_harness_extreme radius = wb_harness_found_radius(set, branch);
    if (radius.value < found->radius.value)
        found->radius = radius;
    found->n_limits += set->plan->branches[branch].least_radius > 0.0;
    found->n_exceeded += wb_harness_found_exceeds_radius(set, branch) >= 0;
    found->n_beyond += wb_harness_found_is_beyond(set, branch);
}

void wb_harness_found_collect(struct wb_harness_found *found,
                              const struct wb_harness_result_set *set)
{
    const int last = set->n_steps - 1;
    *found = (struct wb_harness_found){.radius = {.value = (double)INFINITY}};
    for (int i = 0; i < set->plan->n_items; i++)
        collect_item(found, set, i);
    for (int i = 0; i < set->plan->n_branches; i++)
        collect_branch(found, set, i);
    for (int i = 0; i < set->n_steps; i++)
        found->n_snaps += set->results[i].n_snaps;
    found->is_taken_off =
        set->converged && last >= 0 && set->plan->steps[last].kind == WB_HARNESS_TAKE_OFF;
    if (!found->is_taken_off)
        return;
    const int far = wb_harness_found_farthest(set, last);
    const struct wb_harness_place *const from = &set->natural[far];
    found->residual = (struct wb_harness_extreme){
        wb_vec3_distance(from->position, set->results[last].places[far].position), from->branch,
        last, from->s};
}
