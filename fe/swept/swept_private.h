/* Functions of the swept bodies that only tests use: parts of a step, internal values. */
#ifndef WB_FE_SWEPT_SWEPT_PRIVATE_H
#define WB_FE_SWEPT_SWEPT_PRIVATE_H

#include "base/status.h"
#include "fe/swept/swept_contact.h"
#include "fe/swept/swept_hex.h"
#include "fe/swept/swept_section.h"
#include "fe/swept/swept_step.h"
#include "fe/swept/swept_tape_contact.h"

/* --- sections --- */

/* Sets area, shares and the central node, which is the one nearest to the centroid, of a section
 * whose mesh is filled in. */
void wb_swept_section_integrate(struct wb_swept_section *section);

/* --- hexahedra --- */

/* Number of points of an element with stresses: 4 Gauss points in the section, or 1. */
int wb_swept_hex_stress_points(const struct wb_swept_hex *hex);

/* Adds the stiffness of a layer (fe/swept/swept_frequency.h), N/m, in the reference state, to
 * `stiffness`: (6 n x 6 n) for n section nodes, degree of freedom (station n + node) 3 +
 * component. */
void wb_swept_frequency_layer(const struct wb_swept_hex *hex, double *stiffness);

/* Distributes a mass (kg, not scaled by f_m) over the nodes of a station. */
void wb_swept_step_add_mass(struct wb_swept_step *step, int station, double mass);

double wb_swept_step_station_mass(const struct wb_swept_step *step, int station); /* kg, scaled */

/* --- contact of wires --- */

/* Returns to the state after creation: no frames, pairs or friction. */
void wb_swept_contact_reset(struct wb_swept_contact *contact);

const char *wb_swept_contact_instructions(const struct wb_swept_contact *contact);

/* wb_swept_contact_add_forces() in parts, for threads: gather all blocks, then refresh once, press
 * all blocks, scatter all blocks (each time all threads before the next), and finish once. Calls
 * for different blocks may run at the same time. Other code may write a block's forces until it is
 * scattered. */
int wb_swept_contact_blocks(const struct wb_swept_contact *contact);
void wb_swept_contact_gather(struct wb_swept_contact *contact, const double *const *position,
                             int first, int end);
WB_MUST_CHECK enum wb_status wb_swept_contact_refresh(struct wb_swept_contact *contact);
void wb_swept_contact_press(struct wb_swept_contact *contact, double time_step, int first, int end);
void wb_swept_contact_scatter(const struct wb_swept_contact *contact, void *const *force, int first,
                              int end);
WB_MUST_CHECK enum wb_status wb_swept_contact_finish(struct wb_swept_contact *contact,
                                                     struct wb_swept_contact_energies *energies);

/* --- tapes --- */

/* Accumulated plastic strain of an element (between nodes `element` and the next, stations `along`
 * and the next) at a point through the thickness, from the inside. */
double wb_swept_tape_plastic_strain(const struct wb_swept_tape_state *state, int element, int along,
                                    int point);

/* Bonded area, m2. */
double wb_swept_cohesion_area(const struct wb_swept_cohesion *cohesion);

/* Returns to the state after creation: no friction. */
void wb_swept_tape_contact_reset(struct wb_swept_tape_contact *contact);

/* Number of nodes that are tracked: within the margin of a wire, and not bonded to it. */
int wb_swept_tape_contact_near(const struct wb_swept_tape_contact *contact);

#endif
