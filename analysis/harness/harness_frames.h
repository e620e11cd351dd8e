/* Selects shapes within the steps of a harness, for animations.
 *
 * Of a move towards a target, a shape is taken at the first increment at or beyond each k/N of the
 * step, so that increments are those without frames. A snap is passed over: the shape at its
 * fraction is the one at rest. A release is a motion without increments of a target; there every
 * first, second, fourth... step of the motion is taken, so that at most N - 1 remain.
 */
#ifndef WB_ANALYSIS_HARNESS_HARNESS_FRAMES_H
#define WB_ANALYSIS_HARNESS_HARNESS_FRAMES_H

#include <stdbool.h>

#include "base/memory.h"

struct wb_harness_place;
struct wb_harness_force;

/* Of one step. */
struct wb_harness_frames {
    int n_wanted; /* N: shapes of a step, with its end; below 2: the end alone */
    int n_places, n_forces;
    struct wb_memory *memory; /* borrowed; owns places and forces */
    bool is_motion;           /* the step is a release */
    int calls, stride;        /* of a motion: steps so far, and between two frames */
    int n;
    struct wb_harness_frame {
        double fraction;                 /* of the step, of a motion's steps; above 0 and below 1 */
        struct wb_harness_place *places; /* (n_places) */
        struct wb_harness_force *forces; /* (n_forces) */
    } * list;                            /* (n_wanted) */
};

/* With room for the frames. `frames` has `n_wanted`, `n_places`, `n_forces` and `memory`. */
void wb_harness_frames_create(struct wb_harness_frames *frames);
void wb_harness_frames_begin(struct wb_harness_frames *frames, bool is_motion);

/* After an increment: the frame to be filled with the current shape and forces, or NULL. */
struct wb_harness_frame *wb_harness_frames_take(struct wb_harness_frames *frames, double fraction);

/* Ends a step of which a fraction was completed: drops frames beyond it and sets the fractions of a
 * motion. */
void wb_harness_frames_end(struct wb_harness_frames *frames, double completed);

#endif
