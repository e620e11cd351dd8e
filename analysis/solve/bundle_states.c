#include "analysis/solve/bundle_states.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fe/team/team.h"

#define WB_LOG_DOMAIN "solve"

/* A new attempt of the run discards the states of the previous attempt. */
static enum wb_status start_attempt(struct wb_bundle_states *states, int attempt)
{
    states->attempt = attempt;
    states->deflection = 0.0;
    wb_surface_release(&states->surface);
    return states->wants_vtk ? wb_vtk_file_series_restart(states->series) : WB_OK;
}

static void take_fields(struct wb_bundle_states *states, const struct wb_bundle *bundle)
{
    if (states->has_fields)
        wb_bundle_fields_take(&states->fields, bundle);
    else
        wb_bundle_fields_init(&states->fields, bundle);
    states->has_fields = true;
}

static enum wb_status take(struct wb_bundle_states *states, int number,
                           const struct wb_bundle_row *row, const struct wb_bundle *bundle)
{
    /* Later cycles reach the same deflection again: the surface of the first is kept. */
    const bool surface = states->wants_surface && row->phase == WB_PHASE_LOAD &&
                         row->deflection > (1.0 + 1e-3) * states->deflection;
    const bool vtk =
        states->wants_vtk && (number % states->every == 0 || number % states->turn == 0);

    if (!surface && !vtk)
        return WB_OK;
    take_fields(states, bundle);
    if (surface) {
        wb_surface_release(&states->surface);
        wb_surface_take(&states->surface, &states->fields);
        states->deflection = row->deflection;
    }
    return vtk ? wb_bundle_vtk_add(states->series, row->time, row->deflection, &states->fields)
               : WB_OK;
}

enum wb_status wb_bundle_states_take(struct wb_bundle_states *states,
                                     const struct wb_bundle_result *result,
                                     const struct wb_bundle_row *row,
                                     const struct wb_bundle *bundle)
{
    const struct wb_solve_time start = wb_solve_time_now();
    enum wb_status status = WB_OK;

    if (result->attempts != states->attempt)
        status = start_attempt(states, result->attempts);
    if (status == WB_OK)
        status = take(states, result->n_rows, row, bundle);
    wb_solve_time_add(&states->spent, &start);
    return status;
}

static void visit_body(struct wb_surface_body *body, struct wb_checkpoint *c)
{
    wb_checkpoint_visit_member(c, body, is_tape);
    wb_checkpoint_visit_member(c, body, closed);
    wb_checkpoint_visit_member(c, body, n_around);
    wb_checkpoint_visit_member(c, body, n_along);
    if (c->status != WB_OK)
        return;
    const size_t size = (size_t)body->n_around * (size_t)body->n_along * sizeof *body->nodes;
    if (c->restores)
        body->nodes = wb_memory_new(size, 1);
    wb_checkpoint_visit(c, "nodes", body->nodes, size);
}

static void visit_surface(struct wb_surface *surface, struct wb_checkpoint *c)
{
    int n = surface->n;

    wb_checkpoint_visit(c, "bodies", &n, sizeof n);
    if (c->restores && n > 0 && c->status == WB_OK) {
        wb_surface_release(surface);
        surface->bodies = wb_memory_new((size_t)n, sizeof *surface->bodies);
        surface->n = n;
    }
    for (int i = 0; i < n && c->status == WB_OK; i++) {
        wb_checkpoint_enter(c, "body %d", i + 1);
        visit_body(&surface->bodies[i], c);
        wb_checkpoint_leave(c);
    }
}

static void visit_series(struct wb_vtk_file_series *series, struct wb_checkpoint *c)
{
    size_t length = series->states.length;
    char *bytes = series->states.bytes;

    wb_checkpoint_visit_member(c, series, n);
    wb_checkpoint_visit(c, "length", &length, sizeof length);
    if (c->restores)
        bytes = wb_memory_new(length + 1, 1);
    wb_checkpoint_visit(c, "states", bytes, length);
    if (!c->restores)
        return;
    if (c->status == WB_OK)
        wb_text_append_bytes(&series->states, bytes, length);
    free(bytes);
}

/* The states that are written, and where. A resumed run must write the same: a series split over
 * two folders would be useless. */
struct purpose {
    int wants_surface, wants_vtk, every;
    char folder[PATH_MAX]; /* path without symbolic links; "": no files */
};

static void find_purpose(struct purpose *purpose, const struct wb_bundle_states *states)
{
    memset(purpose, 0, sizeof *purpose);
    purpose->wants_surface = states->wants_surface;
    purpose->wants_vtk = states->wants_vtk;
    purpose->every = states->wants_vtk ? states->every : 0;
    if (states->wants_vtk && !realpath(states->series->folder, purpose->folder))
        snprintf(purpose->folder, sizeof purpose->folder, "%s", states->series->folder);
}

static void visit_purpose(const struct wb_bundle_states *states, struct wb_checkpoint *checkpoint)
{
    struct purpose own, saved;

    find_purpose(&own, states);
    saved = own;
    wb_checkpoint_visit_member(checkpoint, &saved, wants_surface);
    wb_checkpoint_visit_member(checkpoint, &saved, wants_vtk);
    wb_checkpoint_visit_member(checkpoint, &saved, every);
    wb_checkpoint_visit_member(checkpoint, &saved, folder);
    /* Only the first rank keeps states. */
    if (checkpoint->status != WB_OK || !checkpoint->restores || wb_team_rank() > 0)
        return;
    saved.folder[sizeof saved.folder - 1] = '\0';
    if (own.wants_surface != saved.wants_surface)
        checkpoint->status =
            wb_fail(WB_ERR_DATA, "the checkpoint is of a run %s -o: remove it to start over",
                    saved.wants_surface ? "with" : "without");
    else if (own.wants_vtk != saved.wants_vtk || own.every != saved.every ||
             strcmp(own.folder, saved.folder) != 0)
        checkpoint->status =
            saved.wants_vtk
                ? wb_fail(WB_ERR_DATA,
                          "the checkpoint is of a run with --vtk=%s --vtk-every=%d: remove it to "
                          "start over",
                          saved.folder, saved.every)
                : wb_fail(WB_ERR_DATA, "the checkpoint is of a run without --vtk: remove it to "
                                       "start over");
}

void wb_bundle_states_visit(struct wb_bundle_states *states, struct wb_checkpoint *checkpoint)
{
    visit_purpose(states, checkpoint);
    wb_checkpoint_visit_member(checkpoint, states, attempt);
    wb_checkpoint_visit_member(checkpoint, states, deflection);
    wb_checkpoint_visit_member(checkpoint, states, spent);
    wb_checkpoint_enter(checkpoint, "surface");
    visit_surface(&states->surface, checkpoint);
    wb_checkpoint_leave(checkpoint);
    wb_checkpoint_enter(checkpoint, "series");
    visit_series(states->series, checkpoint);
    wb_checkpoint_leave(checkpoint);
}

void wb_bundle_states_release(struct wb_bundle_states *states)
{
    if (states->has_fields)
        wb_bundle_fields_release(&states->fields);
    wb_surface_release(&states->surface);
    states->has_fields = false;
}
