#include "cli/bundle_states.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fe/team/team.h"

#define WB_LOG_DOMAIN "solve"

/* A run that begins anew leaves nothing of the one before. */
static enum wb_status begin_anew(struct wb_bundle_states *states, int attempt)
{
    states->attempt = attempt;
    states->deflection = 0.0;
    wb_surface_release(&states->surface);
    return states->wants_vtk ? wb_vtk_file_series_restart(&states->series) : WB_OK;
}

static enum wb_status take_fields(struct wb_bundle_states *states, const struct wb_bundle *bundle)
{
    if (states->has_fields)
        return wb_bundle_fields_take(&states->fields, bundle);
    WB_TRY(wb_bundle_fields_init(&states->fields, bundle));
    states->has_fields = true;
    return WB_OK;
}

static enum wb_status take_surface(struct wb_bundle_states *states, double deflection)
{
    struct wb_surface surface;

    WB_TRY(wb_surface_take(&surface, &states->fields));
    wb_surface_release(&states->surface);
    states->surface = surface;
    states->deflection = deflection;
    return WB_OK;
}

static enum wb_status take(struct wb_bundle_states *states, int number,
                           const struct wb_bundle_row *row, const struct wb_bundle *bundle)
{
    /* Later cycles reach the same deflection: the first is kept. */
    const bool surface = states->wants_surface && row->phase == WB_PHASE_LOAD &&
                         row->deflection > (1.0 + 1e-3) * states->deflection;
    const bool vtk =
        states->wants_vtk && (number % states->every == 0 || number % states->turn == 0);

    if (!surface && !vtk)
        return WB_OK;
    WB_TRY(take_fields(states, bundle));
    if (surface)
        WB_TRY(take_surface(states, row->deflection));
    return vtk ? wb_bundle_vtk_add(&states->series, row->time, row->deflection, &states->fields)
               : WB_OK;
}

enum wb_status wb_bundle_states_take(struct wb_bundle_states *states,
                                     const struct wb_bundle_history *history,
                                     const struct wb_bundle_row *row,
                                     const struct wb_bundle *bundle)
{
    const struct wb_solve_time start = wb_solve_now();
    enum wb_status status = WB_OK;

    if (history->attempts != states->attempt)
        status = begin_anew(states, history->attempts);
    if (status == WB_OK)
        status = take(states, history->n_rows, row, bundle);
    const struct wb_solve_time end = wb_solve_now();
    states->spent.wall += end.wall - start.wall;
    states->spent.cpu += end.cpu - start.cpu;
    return status;
}

static void carry_body(struct wb_surface_body *body, struct wb_checkpoint *checkpoint)
{
    struct wb_surface_node *nodes = body->nodes;

    wb_checkpoint_carry(checkpoint, body, sizeof *body);
    const size_t size = (size_t)body->n_around * (size_t)body->n_along * sizeof *nodes;
    if (checkpoint->restores) {
        body->nodes = calloc(size > 0 ? size : 1, 1);
        if (!body->nodes)
            checkpoint->status = wb_fail(WB_ERR_MEMORY, "no memory for a surface");
    }
    wb_checkpoint_carry(checkpoint, body->nodes, size);
}

static void carry_surface(struct wb_surface *surface, struct wb_checkpoint *checkpoint)
{
    int n = surface->n;

    wb_checkpoint_carry(checkpoint, &n, sizeof n);
    if (checkpoint->restores && n > 0 && checkpoint->status == WB_OK) {
        wb_surface_release(surface);
        surface->bodies = calloc((size_t)n, sizeof *surface->bodies);
        if (!surface->bodies) {
            checkpoint->status = wb_fail(WB_ERR_MEMORY, "no memory for a surface");
            return;
        }
        surface->n = n;
    }
    for (int i = 0; i < n && checkpoint->status == WB_OK; i++)
        carry_body(&surface->bodies[i], checkpoint);
}

static void carry_series(struct wb_vtk_file_series *series, struct wb_checkpoint *checkpoint)
{
    size_t length = series->states.length;
    char *bytes = series->states.bytes;

    wb_checkpoint_carry(checkpoint, &series->n, sizeof series->n);
    wb_checkpoint_carry(checkpoint, &length, sizeof length);
    if (checkpoint->restores) {
        bytes = malloc(length + 1);
        if (!bytes) {
            checkpoint->status = wb_fail(WB_ERR_MEMORY, "no memory for a VTK series");
            return;
        }
    }
    wb_checkpoint_carry(checkpoint, bytes, length);
    if (!checkpoint->restores)
        return;
    if (checkpoint->status == WB_OK)
        wb_text_append_bytes(&series->states, bytes, length);
    free(bytes);
}

/* Where and which states are written: a series of two folders would be of no use. */
struct purpose {
    int wants_surface, wants_vtk, every;
    char folder[PATH_MAX]; /* without links; "": there are no files */
};

static void find_purpose(struct purpose *purpose, const struct wb_bundle_states *states)
{
    memset(purpose, 0, sizeof *purpose);
    purpose->wants_surface = states->wants_surface;
    purpose->wants_vtk = states->wants_vtk;
    purpose->every = states->wants_vtk ? states->every : 0;
    if (states->wants_vtk && !realpath(states->series.folder, purpose->folder))
        snprintf(purpose->folder, sizeof purpose->folder, "%s", states->series.folder);
}

static void carry_purpose(const struct wb_bundle_states *states, struct wb_checkpoint *checkpoint)
{
    struct purpose own, carried;

    find_purpose(&own, states);
    carried = own;
    wb_checkpoint_carry(checkpoint, &carried, sizeof carried);
    /* Other ranks keep no states. */
    if (checkpoint->status != WB_OK || !checkpoint->restores || wb_team_rank() > 0)
        return;
    carried.folder[sizeof carried.folder - 1] = '\0';
    if (own.wants_surface != carried.wants_surface)
        checkpoint->status =
            wb_fail(WB_ERR_DATA, "the checkpoint is of a run %s -o: remove it to begin anew",
                    carried.wants_surface ? "with" : "without");
    else if (own.wants_vtk != carried.wants_vtk || own.every != carried.every ||
             strcmp(own.folder, carried.folder) != 0)
        checkpoint->status =
            carried.wants_vtk
                ? wb_fail(WB_ERR_DATA,
                          "the checkpoint is of a run with --vtk=%s --vtk-every=%d: remove it to "
                          "begin anew",
                          carried.folder, carried.every)
                : wb_fail(WB_ERR_DATA, "the checkpoint is of a run without --vtk: remove it to "
                                       "begin anew");
}

void wb_bundle_states_carry(struct wb_bundle_states *states, struct wb_checkpoint *checkpoint)
{
    carry_purpose(states, checkpoint);
    wb_checkpoint_carry(checkpoint, &states->attempt, sizeof states->attempt);
    wb_checkpoint_carry(checkpoint, &states->deflection, sizeof states->deflection);
    wb_checkpoint_carry(checkpoint, &states->spent, sizeof states->spent);
    carry_surface(&states->surface, checkpoint);
    carry_series(&states->series, checkpoint);
}

void wb_bundle_states_release(struct wb_bundle_states *states)
{
    wb_vtk_file_series_release(&states->series);
    if (states->has_fields)
        wb_bundle_fields_release(&states->fields);
    wb_surface_release(&states->surface);
    states->has_fields = false;
}
