/* A bundle's state to a checkpoint and back. */
#include <stdio.h>
#include <stdlib.h>

#include "fe/bundle/bundle_bond.h"
#include "fe/bundle/bundle_private.h"

#define WB_LOG_DOMAIN "bundle"

static void visit_body(struct wb_bundle_body *body, struct wb_checkpoint *checkpoint)
{
    const size_t n = wb_swept_size(&body->layout);

    wb_checkpoint_visit(checkpoint, "position", body->position, n * sizeof *body->position);
    wb_checkpoint_visit(checkpoint, "velocity", body->velocity, n * sizeof *body->velocity);
    wb_checkpoint_visit(checkpoint, "force", body->force, n * wb_bundle_force_size(body));
}

static void visit_contact(struct wb_swept_contact *contact, struct wb_checkpoint *checkpoint)
{
    const size_t size = wb_swept_contact_state_size(contact);
    void *state = malloc(size);

    if (!state) {
        checkpoint->status = wb_fail(WB_ERR_MEMORY, "out of memory for a checkpoint");
        return;
    }
    if (!checkpoint->restores)
        wb_swept_contact_save(contact, state);
    wb_checkpoint_visit(checkpoint, "contact", state, size);
    if (checkpoint->restores && checkpoint->status == WB_OK)
        wb_swept_contact_restore(contact, state);
    free(state);
}

void wb_bundle_visit_fields(struct wb_bundle *bundle, struct wb_checkpoint *checkpoint)
{
    size_t bytes;
    void *data;

    for (int w = 0; w < bundle->n_wires; w++) {
        wb_checkpoint_enter(checkpoint, "wire %d", w + 1);
        visit_body(&bundle->wire[w], checkpoint);
        data = wb_swept_hex_state_data(bundle->history[w], &bytes);
        wb_checkpoint_visit(checkpoint, "material", data, bytes);
        wb_checkpoint_leave(checkpoint);
    }
    if (bundle->has_tape) {
        wb_checkpoint_enter(checkpoint, "tape");
        visit_body(&bundle->ring, checkpoint);
        data = wb_swept_tape_state_data(bundle->tape_history, &bytes);
        wb_checkpoint_visit(checkpoint, "material", data, bytes);
        wb_checkpoint_leave(checkpoint);
        wb_checkpoint_enter(checkpoint, "directors");
        visit_body(&bundle->directors, checkpoint);
        wb_checkpoint_leave(checkpoint);
    }
    if (bundle->contact)
        visit_contact(bundle->contact, checkpoint);
    if (bundle->bond)
        wb_bundle_bond_visit(bundle->bond, checkpoint);
    if (bundle->cap)
        wb_bundle_cap_visit(bundle->cap, checkpoint);
}

void wb_bundle_visit(struct wb_bundle *bundle, struct wb_checkpoint *c)
{
    wb_checkpoint_visit_member(c, bundle, from);
    wb_checkpoint_visit_member(c, bundle, to);
    wb_checkpoint_visit_member(c, bundle, way_start);
    wb_checkpoint_visit_member(c, bundle, way_duration);
    wb_checkpoint_visit_member(c, bundle, let_go);
    wb_checkpoint_visit_member(c, bundle, time);
    wb_checkpoint_visit_member(c, bundle, steps);
    wb_checkpoint_visit_member(c, bundle, has_moved);
    wb_checkpoint_visit_member(c, bundle, tension);
    wb_checkpoint_visit_member(c, bundle, vertical);
    wb_checkpoint_visit_member(c, bundle, pull);
    wb_checkpoint_visit_member(c, bundle, slack);
    wb_checkpoint_visit_member(c, bundle, tip_work);
    wb_checkpoint_visit_member(c, bundle, friction_work);
    wb_checkpoint_visit_member(c, bundle, damage_work);
    wb_checkpoint_visit_member(c, bundle, kinetic);
    wb_checkpoint_visit_member(c, bundle, touching);
    wb_checkpoint_visit_member(c, bundle, wires);
    wb_checkpoint_visit_member(c, bundle, shells);
    wb_checkpoint_visit_member(c, bundle, bonded);
    wb_checkpoint_visit_member(c, bundle, weight_zero);
    if (bundle->parts)
        wb_bundle_parts_visit(bundle->parts, c);
    else
        wb_bundle_visit_fields(bundle, c);
}
