#include "daq/test/first_force.h"

#include <math.h>
#include <stdio.h>

#include "base/units.h"

#define BEYOND_NOISE 8.0 /* standard deviations; no zero of a good cell gets there by chance */
#define LEAST_BEYOND 3   /* readings in a row */
#define FILTER_DELAYS 8.0
#define STRETCH (1.5 * WB_MM)
#define STALL 0.2 /* s that this computer may be late; a fast rig goes far meanwhile */
#define LEAST_READINGS 20
/* Where a bent wire must have pulled: at the least, and at the most. */
#define FORCELESS_LEAST (4.0 * WB_MM)
#define FORCELESS_MOST (15.0 * WB_MM)
/* Of the capacity: a cell whose display rounds has no noise at all. */
#define LEAST_NOISE 1e-4

void wb_first_force_begin(struct wb_first_force *force, double noise, const struct wb_rig *rig)
{
    *force = (struct wb_first_force){
        .noise = fmax(fmax(noise, rig->load_cell.noise), LEAST_NOISE * rig->load_cell.capacity),
        .settled = FILTER_DELAYS * rig->load_cell.filter_delay * rig->stage.speed,
        .stretch = STRETCH + STALL * rig->stage.speed * fmax(0.0, rig->time_scale - 1.0),
    };
}

double wb_first_force_slope(const struct wb_first_force *force)
{
    return force->products / force->squares;
}

static void take(struct wb_first_force *force, double deflection, double tension)
{
    force->n++;
    const double off = deflection - force->mean_deflection;
    force->mean_deflection += off / (double)force->n;
    force->mean_tension += (tension - force->mean_tension) / (double)force->n;
    force->squares += off * (deflection - force->mean_deflection);
    force->products += off * (tension - force->mean_tension);
}

/* The way by which a wire at the lower bound pulls by twice what counts as no noise. */
static double forceless_way(const struct wb_first_force *force,
                            const struct wb_first_force_bounds *bounds)
{
    const double way =
        bounds->lowest > 0.0 ? 2.0 * BEYOND_NOISE * force->noise / bounds->lowest : FORCELESS_MOST;
    return fmax(FORCELESS_LEAST, fmin(FORCELESS_MOST, way));
}

static bool becomes_taut(struct wb_first_force *force, double deflection, double tension)
{
    force->n_beyond = fabs(tension) > BEYOND_NOISE * force->noise ? force->n_beyond + 1 : 0;
    force->is_taut = force->n_beyond >= LEAST_BEYOND;
    force->taut = deflection;
    return force->is_taut;
}

static enum wb_first_force_verdict judge(const struct wb_first_force *force,
                                         const struct wb_first_force_bounds *bounds,
                                         char text[WB_START_CHECK_TEXT])
{
    const double unit = WB_MN / WB_MM, slope = wb_first_force_slope(force);
    if (slope <= 0.0)
        snprintf(text, WB_START_CHECK_TEXT,
                 "the force falls by %.3g mN per mm while the wire is bent: turn load_cell.sign of "
                 "the rig file round if the cell reads tension as negative, and look whether the "
                 "strand pulls the tip up",
                 -slope / unit);
    else if (bounds->lowest > 0.0 && slope < bounds->lowest)
        snprintf(text, WB_START_CHECK_TEXT,
                 "the force rises by %.3g mN per mm of deflection, and %s gives %.3g at the "
                 "least: are load_cell.unit and scale of the rig file right, and wire and "
                 "length_mm of the specimen file? Does the clamp hold the wire?",
                 slope / unit, bounds->of, bounds->lowest / unit);
    else if (bounds->highest > 0.0 && slope > bounds->highest)
        snprintf(text, WB_START_CHECK_TEXT,
                 "the force rises by %.3g mN per mm of deflection, and %s gives %.3g at the "
                 "most: are load_cell.unit and scale of the rig file right, and wire and "
                 "length_mm of the specimen file? Does anything hold the tip?",
                 slope / unit, bounds->of, bounds->highest / unit);
    else
        return WB_FIRST_FORCE_AGREES;
    return WB_FIRST_FORCE_WRONG;
}

enum wb_first_force_verdict wb_first_force_add(struct wb_first_force *force, double deflection,
                                               double tension,
                                               const struct wb_first_force_bounds *bounds,
                                               char text[WB_START_CHECK_TEXT])
{
    if (!force->is_taut && !becomes_taut(force, deflection, tension)) {
        if (deflection < forceless_way(force, bounds))
            return WB_FIRST_FORCE_OPEN;
        snprintf(text, WB_START_CHECK_TEXT,
                 "the wire is bent by %.1f mm and the cell reads no force (%.3g mN, noise %.2g "
                 "mN): does the strand pull at the cell, is the cell switched on, and are its "
                 "unit and scale in the rig file right?",
                 deflection / WB_MM, tension / WB_MN, force->noise / WB_MN);
        return WB_FIRST_FORCE_WRONG;
    }
    const double way = deflection - force->taut - force->settled;
    if (way < 0.0)
        return WB_FIRST_FORCE_OPEN;
    take(force, deflection, tension);
    if (way < force->stretch || force->n < LEAST_READINGS)
        return WB_FIRST_FORCE_OPEN;
    return judge(force, bounds, text);
}
