#include "daq/test/first_force.h"

#include <math.h>
#include <stdio.h>

#include "base/units.h"

#define BEYOND_NOISE 8.0      /* standard deviations that noise alone does not reach */
#define LEAST_BEYOND 3        /* consecutive readings beyond the noise that show a taut strand */
#define FILTER_DELAYS 8.0     /* time for the cell's filter to settle, in delays of the filter */
#define STRETCH (1.5 * WB_MM) /* deflection over which the slope is measured */
#define STALL 0.2             /* s that this computer may stall; matters for a fast virtual rig */
#define LEAST_READINGS 20     /* of the slope */
/* Bounds of the deflection at which a force must have appeared. */
#define FORCELESS_LEAST (4.0 * WB_MM)
#define FORCELESS_MOST (15.0 * WB_MM)
/* Lower bound of the noise as a fraction of the capacity: rounded readings may not scatter. */
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

/* Updates the regression of tension on deflection. */
static void add_reading(struct wb_first_force *force, double deflection, double tension)
{
    force->n++;
    const double off = deflection - force->mean_deflection;
    force->mean_deflection += off / (double)force->n;
    force->mean_tension += (tension - force->mean_tension) / (double)force->n;
    force->squares += off * (deflection - force->mean_deflection);
    force->products += off * (tension - force->mean_tension);
}

/* m of deflection at which a wire with the lowest stiffness pulls with twice the force that counts
 * as beyond the noise. */
static double forceless_deflection(const struct wb_first_force *force,
                                   const struct wb_first_force_bounds *bounds)
{
    const double deflection =
        bounds->lowest > 0.0 ? 2.0 * BEYOND_NOISE * force->noise / bounds->lowest : FORCELESS_MOST;
    return fmax(FORCELESS_LEAST, fmin(FORCELESS_MOST, deflection));
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
                 "the force falls by %.3g mN per mm of deflection: reverse load_cell.sign in the "
                 "rig file if the cell reads tension as negative, and check that the strand pulls "
                 "the tip up",
                 -slope / unit);
    else if (bounds->lowest > 0.0 && slope < bounds->lowest)
        snprintf(text, WB_START_CHECK_TEXT,
                 "the force rises by %.3g mN per mm of deflection; expected at least %.3g by %s: "
                 "check load_cell.unit and load_cell.scale in the rig file, wire and length_mm in "
                 "the specimen file, and that the wire does not slip in the clamp",
                 slope / unit, bounds->lowest / unit, bounds->of);
    else if (bounds->highest > 0.0 && slope > bounds->highest)
        snprintf(text, WB_START_CHECK_TEXT,
                 "the force rises by %.3g mN per mm of deflection; expected at most %.3g by %s: "
                 "check load_cell.unit and load_cell.scale in the rig file, wire and length_mm in "
                 "the specimen file, and that nothing blocks the tip",
                 slope / unit, bounds->highest / unit, bounds->of);
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
        if (deflection < forceless_deflection(force, bounds))
            return WB_FIRST_FORCE_OPEN;
        snprintf(text, WB_START_CHECK_TEXT,
                 "the cell shows no force (%.3g mN, noise %.2g mN) at %.1f mm of deflection: check "
                 "that the strand pulls at the cell, that the cell is on, and load_cell.unit and "
                 "load_cell.scale in the rig file",
                 tension / WB_MN, force->noise / WB_MN, deflection / WB_MM);
        return WB_FIRST_FORCE_WRONG;
    }
    const double way = deflection - force->taut - force->settled;
    if (way < 0.0)
        return WB_FIRST_FORCE_OPEN;
    add_reading(force, deflection, tension);
    if (way < force->stretch || force->n < LEAST_READINGS)
        return WB_FIRST_FORCE_OPEN;
    return judge(force, bounds, text);
}
