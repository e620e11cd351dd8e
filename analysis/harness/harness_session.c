#include "analysis/harness/harness_session.h"
#include "analysis/harness/harness_session_private.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define WB_LOG_DOMAIN "harness"

static const size_t most_undo_memory = 512 << 20; /* bytes */

/* A state with its results, and what the run needs to return to it. */
struct kept {
    struct wb_harness_session_state state;
    void *run; /* NULL: never filled */
    char name[WB_HARNESS_NAME];
};

struct wb_harness_session {
    const struct wb_harness_plan *plan;
    struct wb_harness_run *run;
    struct wb_harness_session_state now;
    struct kept undo[WB_HARNESS_SESSION_UNDO]; /* a ring */
    int first, n_undo, most_undo;              /* the oldest, their number and its limit */
    struct kept snapshots[WB_HARNESS_SESSION_SNAPSHOTS];
    int n_snapshots;
    struct wb_memory memory; /* of all states */
};

int wb_harness_session_most_undo(size_t state_size)
{
    const size_t most = most_undo_memory / state_size;
    return most < 2 ? 2 : most < WB_HARNESS_SESSION_UNDO ? (int)most : WB_HARNESS_SESSION_UNDO;
}

enum wb_status wb_harness_session_create(struct wb_harness_session **out,
                                         const struct wb_harness_plan *plan,
                                         const struct wb_harness_settings *settings)
{
    struct wb_harness_run *run;
    WB_TRY(wb_harness_run_create(&run, plan, settings));
    struct wb_harness_session *const s = wb_memory_new(1, sizeof *s);
    s->plan = plan;
    s->run = run;
    s->most_undo = wb_harness_session_most_undo(wb_harness_run_state_size(run));
    wb_harness_run_take_memory(run, &s->memory, &s->now.result);
    wb_harness_run_begin(run, &s->now.result);
    wb_harness_file_begin(plan, &s->now.assembly);
    *out = s;
    return WB_OK;
}

void wb_harness_session_destroy(struct wb_harness_session *session)
{
    if (!session)
        return;
    wb_harness_run_destroy(session->run);
    wb_memory_release(&session->memory);
    free(session);
}

const struct wb_harness_session_state *
wb_harness_session_state(const struct wb_harness_session *session)
{
    return &session->now;
}

const struct wb_harness_plan *wb_harness_session_plan(const struct wb_harness_session *session)
{
    return session->plan;
}

int wb_harness_session_n_places(const struct wb_harness_session *session)
{
    return wb_harness_run_n_places(session->run);
}

struct wb_rod_node wb_harness_session_item(const struct wb_harness_session *session, int item)
{
    return wb_harness_run_item(session->run, item);
}

/* --- states --- */

/* Copies a state to one with arrays of its own. */
static void copy_state(const struct wb_harness_session *s, struct wb_harness_session_state *to,
                       const struct wb_harness_session_state *from)
{
    const struct wb_harness_step_result own = to->result;
    *to = *from;
    to->result.forces = own.forces;
    to->result.branches = own.branches;
    to->result.places = own.places;
    memcpy(own.forces, from->result.forces,
           (size_t)wb_harness_file_n_holders(s->plan) * sizeof *own.forces);
    memcpy(own.branches, from->result.branches, (size_t)s->plan->n_branches * sizeof *own.branches);
    memcpy(own.places, from->result.places,
           (size_t)wb_harness_run_n_places(s->run) * sizeof *own.places);
}

static void keep(struct wb_harness_session *s, struct kept *kept)
{
    if (!kept->run) {
        wb_harness_run_take_memory(s->run, &s->memory, &kept->state.result);
        kept->run = wb_memory_take(&s->memory, wb_harness_run_state_size(s->run), 1);
    }
    copy_state(s, &kept->state, &s->now);
    wb_harness_run_save(s->run, kept->run);
}

static void return_to(struct wb_harness_session *s, const struct kept *kept)
{
    copy_state(s, &s->now, &kept->state);
    wb_harness_run_restore(s->run, kept->run);
}

/* Before a change. Beyond their number the oldest state is given up. */
static void push(struct wb_harness_session *s)
{
    keep(s, &s->undo[(s->first + s->n_undo) % s->most_undo]);
    if (s->n_undo < s->most_undo)
        s->n_undo++;
    else
        s->first = (s->first + 1) % s->most_undo;
}

/* What is mounted after a step that did not end is what is held, where it is. */
static void take_assembly(struct wb_harness_session *s, const struct wb_harness_step *step)
{
    struct wb_harness_assembly *const assembly = &s->now.assembly;
    if (s->now.result.end == WB_HARNESS_CONVERGED) {
        wb_harness_file_apply_step(step, assembly);
    } else if (step->kind == WB_HARNESS_MOUNT || step->kind == WB_HARNESS_MOVE) {
        const struct wb_rod_node at = wb_harness_run_item(s->run, step->item);
        assembly->is_mounted[step->item] = true;
        memcpy(assembly->place[step->item], at.position, sizeof at.position);
    }
}

enum wb_status wb_harness_session_step(struct wb_harness_session *s,
                                       const struct wb_harness_step *step,
                                       bool (*watch)(void *context, double fraction), void *context,
                                       const char **key, struct wb_reason *why)
{
    WB_TRY(wb_harness_file_check_step(s->plan, &s->now.assembly, step, key, why));
    push(s);
    wb_harness_run_step(s->run, step, watch, context, &s->now.result);
    s->now.number++;
    snprintf(s->now.name, sizeof s->now.name, "%s", step->name);
    take_assembly(s, step);
    return WB_OK;
}

enum wb_status wb_harness_session_undo(struct wb_harness_session *s, int n, struct wb_reason *why)
{
    if (s->n_undo == 0)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "no change to undo");
    if (n < 1 || n > s->n_undo)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "%d: expected 1 to %d, the number of changes kept",
                          n, s->n_undo);
    s->n_undo -= n;
    return_to(s, &s->undo[(s->first + s->n_undo) % s->most_undo]);
    return WB_OK;
}

/* --- snapshots --- */

static struct kept *find_snapshot(struct wb_harness_session *s, const char *name)
{
    for (int i = 0; i < s->n_snapshots; i++) {
        if (strcmp(s->snapshots[i].name, name) == 0)
            return &s->snapshots[i];
    }
    return NULL;
}

enum wb_status wb_harness_session_snapshot(struct wb_harness_session *s, const char *name,
                                           struct wb_reason *why)
{
    struct kept *kept = find_snapshot(s, name);
    if (!name[0] || strlen(name) >= sizeof kept->name)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "expected a name of 1 to %zu bytes",
                          sizeof kept->name - 1);
    if (!kept && s->n_snapshots == WB_HARNESS_SESSION_SNAPSHOTS)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "expected at most %d snapshots",
                          WB_HARNESS_SESSION_SNAPSHOTS);
    if (!kept)
        kept = &s->snapshots[s->n_snapshots++];
    snprintf(kept->name, sizeof kept->name, "%s", name);
    keep(s, kept);
    return WB_OK;
}

enum wb_status wb_harness_session_restore(struct wb_harness_session *s, const char *name,
                                          struct wb_reason *why)
{
    const struct kept *const kept = find_snapshot(s, name);
    if (!kept)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "no snapshot is named '%s'", name);
    push(s);
    return_to(s, kept);
    return WB_OK;
}
