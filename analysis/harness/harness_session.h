/* A harness that a person or a program assembles step by step, with undo and named snapshots.
 * Called by `wirebench solve harness --follow` and by libwirebench.
 *
 * Each step, undo and restored snapshot gives a state, which has a number: that of the steps from
 * the stress-free harness on, state 0. A state is kept with its results, so it is the same, bit for
 * bit, after an undo, and so is what follows.
 */
#ifndef WB_ANALYSIS_HARNESS_HARNESS_SESSION_H
#define WB_ANALYSIS_HARNESS_HARNESS_SESSION_H

#include "analysis/harness/harness_run.h"
#include "base/reason.h"

enum {
    WB_HARNESS_SESSION_UNDO = 100,     /* states that can be undone, at most; together 512 MB */
    WB_HARNESS_SESSION_SNAPSHOTS = 100 /* names */
};

struct wb_harness_session; /* opaque */

struct wb_harness_session_state {
    int number;
    char name[100]; /* of the step that led to it; "": state 0 */
    struct wb_harness_assembly assembly;
    struct wb_harness_step_result result;
};

/* The plan is borrowed. On failure *out is unchanged. */
WB_MUST_CHECK enum wb_status wb_harness_session_create(struct wb_harness_session **out,
                                                       const struct wb_harness_plan *plan,
                                                       const struct wb_harness_settings *settings);
void wb_harness_session_destroy(struct wb_harness_session *session); /* accepts NULL */

/* The current state, until the next change. */
const struct wb_harness_session_state *
wb_harness_session_state(const struct wb_harness_session *session);
const struct wb_harness_plan *wb_harness_session_plan(const struct wb_harness_session *session);
int wb_harness_session_n_places(const struct wb_harness_session *session);

/* Where an item is, with the rotation of the section there. */
struct wb_rod_node wb_harness_session_item(const struct wb_harness_session *session, int item);

/* Computes a step. That it finds no equilibrium is a result, and a new state: the last equilibrium
 * on its way, or before a release. WB_ERR_ARGUMENT if the step is not possible, as
 * wb_harness_file_check_step() says; the state is then unchanged. `watch` may be NULL; it returns
 * false to stop. */
WB_MUST_CHECK enum wb_status wb_harness_session_step(struct wb_harness_session *session,
                                                     const struct wb_harness_step *step,
                                                     bool (*watch)(void *context, double fraction),
                                                     void *context, const char **key,
                                                     struct wb_reason *why);

/* Undoes the last n changes: steps and restored snapshots. */
WB_MUST_CHECK enum wb_status wb_harness_session_undo(struct wb_harness_session *session, int n,
                                                     struct wb_reason *why);

/* Keeps the state under a name, in place of a snapshot of this name; and returns to it. */
WB_MUST_CHECK enum wb_status wb_harness_session_snapshot(struct wb_harness_session *session,
                                                         const char *name, struct wb_reason *why);
WB_MUST_CHECK enum wb_status wb_harness_session_restore(struct wb_harness_session *session,
                                                        const char *name, struct wb_reason *why);

#endif
