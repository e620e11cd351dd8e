/* What tests see of the swept bodies beside their interfaces: parts of a step, numbers inside. */
#ifndef WB_FE_SWEPT_SWEPT_PRIVATE_H
#define WB_FE_SWEPT_SWEPT_PRIVATE_H

#include "base/status.h"
#include "fe/swept/swept_contact.h"
#include "fe/swept/swept_hex.h"
#include "fe/swept/swept_section.h"
#include "fe/swept/swept_step.h"
#include "fe/swept/swept_tape_contact.h"

/* --- sections --- */

/* Any mesh; `node` and `quad` are copied. WB_ERR_ARGUMENT when a quadrilateral is not convex and
 * counter-clockwise or a node does not exist. */
WB_MUST_CHECK enum wb_status wb_swept_section_init(struct wb_swept_section *section, int n_nodes,
                                                   const double (*node)[2], int n_quads,
                                                   const int (*quad)[4]);

/* --- hexahedra --- */

const char *wb_swept_hex_instructions(const struct wb_swept_hex *hex);

/* Virgin, as after creation. */
void wb_swept_hex_state_reset(struct wb_swept_hex_state *state);

/* Accumulated plastic strain at a point (0 to 3, or 0) of a section's element. */
double wb_swept_hex_plastic_strain(const struct wb_swept_hex_state *state, int quad, int element,
                                   int point);

/* Points of an element whose stresses can be asked: 4, those of Gauss in the section, or 1. */
int wb_swept_hex_stress_points(const struct wb_swept_hex *hex);

/* The stiffness of a layer (fe/swept/swept_frequency.h), N/m, in the reference state: (6 n x 6 n)
 * of n section nodes, freedoms (station n + node) 3 + component. Added to `stiffness`. */
void wb_swept_frequency_layer(const struct wb_swept_hex *hex, double *stiffness);

/* Spreads a mass (kg, not scaled by f_m) over the nodes of a station. */
void wb_swept_step_add_mass(struct wb_swept_step *step, int station, double mass);

double wb_swept_step_station_mass(const struct wb_swept_step *step, int station); /* kg, scaled */

/* --- contact of wires --- */

/* No frames, pairs or friction, as after creation. */
void wb_swept_contact_reset(struct wb_swept_contact *contact);

const char *wb_swept_contact_instructions(const struct wb_swept_contact *contact);

/* wb_swept_contact_add_forces() in parts, for threads: gather all blocks, then refresh once, press
 * all blocks, scatter all blocks (each time all threads before the next), and finish once. Calls
 * for different blocks may run at the same time. A block's forces may be written by others before
 * it is scattered. */
int wb_swept_contact_blocks(const struct wb_swept_contact *contact);
void wb_swept_contact_gather(struct wb_swept_contact *contact, const double *const *position,
                             int first, int end);
WB_MUST_CHECK enum wb_status wb_swept_contact_refresh(struct wb_swept_contact *contact);
void wb_swept_contact_press(struct wb_swept_contact *contact, double time_step, int first, int end);
void wb_swept_contact_scatter(const struct wb_swept_contact *contact, void *const *force, int first,
                              int end);
WB_MUST_CHECK enum wb_status wb_swept_contact_finish(struct wb_swept_contact *contact,
                                                     struct wb_swept_contact_energies *energies);

struct wb_swept_contact_pair {
    int wire[2];
    double stiffness; /* k, N/m2 */
    double normal;    /* N, sum over the stations */
    double smallest;  /* gap, m; negative: penetration */
};
void wb_swept_contact_get_pair(const struct wb_swept_contact *contact, int pair,
                               struct wb_swept_contact_pair *out);

/* --- tapes --- */

const char *wb_swept_tape_instructions(const struct wb_swept_tape *tape);

/* Accumulated plastic strain of an element (between nodes `element` and the next, stations `along`
 * and the next) at a point through the thickness, from the inside. */
double wb_swept_tape_plastic_strain(const struct wb_swept_tape_state *state, int element, int along,
                                    int point);

/* No damage, as after creation. */
void wb_swept_cohesion_reset(struct wb_swept_cohesion *cohesion);

/* Area that is bonded, m2. */
double wb_swept_cohesion_area(const struct wb_swept_cohesion *cohesion);

/* No friction, as after creation. */
void wb_swept_tape_contact_reset(struct wb_swept_tape_contact *contact);

/* Nodes that are looked after now: within the margin of a wire, and not bonded to it. */
int wb_swept_tape_contact_near(const struct wb_swept_tape_contact *contact);

#endif
