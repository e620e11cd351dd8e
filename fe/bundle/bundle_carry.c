/* A bundle's state to a checkpoint and back. */
#include <stddef.h>
#include <stdlib.h>

#include "fe/bundle/bundle_bond.h"
#include "fe/bundle/bundle_private.h"

#define WB_LOG_DOMAIN "bundle"

static void carry_body(struct wb_bundle_body *body, struct wb_checkpoint *checkpoint)
{
    const size_t n = wb_swept_size(&body->layout);

    wb_checkpoint_carry(checkpoint, body->position, n * sizeof *body->position);
    wb_checkpoint_carry(checkpoint, body->velocity, n * sizeof *body->velocity);
    wb_checkpoint_carry(checkpoint, body->force, n * wb_bundle_force_size(body));
}

static void carry_contact(struct wb_swept_contact *contact, struct wb_checkpoint *checkpoint)
{
    const size_t size = wb_swept_contact_state_size(contact);
    void *state = malloc(size);

    if (!state) {
        checkpoint->status = wb_fail(WB_ERR_MEMORY, "out of memory for a checkpoint");
        return;
    }
    if (!checkpoint->restores)
        wb_swept_contact_save(contact, state);
    wb_checkpoint_carry(checkpoint, state, size);
    if (checkpoint->restores && checkpoint->status == WB_OK)
        wb_swept_contact_restore(contact, state);
    free(state);
}

void wb_bundle_carry_fields(struct wb_bundle *bundle, struct wb_checkpoint *checkpoint)
{
    size_t bytes;
    void *data;

    for (int w = 0; w < bundle->n_wires; w++) {
        carry_body(&bundle->wire[w], checkpoint);
        data = wb_swept_hex_state_data(bundle->history[w], &bytes);
        wb_checkpoint_carry(checkpoint, data, bytes);
    }
    if (bundle->has_tape) {
        carry_body(&bundle->ring, checkpoint);
        carry_body(&bundle->directors, checkpoint);
        data = wb_swept_tape_state_data(bundle->tape_history, &bytes);
        wb_checkpoint_carry(checkpoint, data, bytes);
    }
    if (bundle->contact)
        carry_contact(bundle->contact, checkpoint);
    if (bundle->bond)
        wb_bundle_bond_carry(bundle->bond, checkpoint);
    if (bundle->cap) {
        data = wb_bundle_cap_data(bundle->cap, &bytes);
        wb_checkpoint_carry(checkpoint, data, bytes);
    }
}

void wb_bundle_carry(struct wb_bundle *bundle, struct wb_checkpoint *checkpoint)
{
    wb_checkpoint_carry(checkpoint, &bundle->from,
                        sizeof *bundle - offsetof(struct wb_bundle, from));
    if (bundle->parts)
        wb_bundle_parts_carry(bundle->parts, checkpoint);
    else
        wb_bundle_carry_fields(bundle, checkpoint);
}
