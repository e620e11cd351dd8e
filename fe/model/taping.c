#include "fe/model/taping.h"

#include <math.h>

#define WB_LOG_DOMAIN "taping"

static const double largest_lap = 0.95;

static enum wb_status check(double circumference, double layer_thickness)
{
    if (!(circumference > 0.0 && isfinite(circumference)) ||
        !(layer_thickness > 0.0 && isfinite(layer_thickness)))
        return wb_fail(
            WB_ERR_ARGUMENT,
            "the tape is %g m thick and its circumference %g m: expected numbers above 0",
            layer_thickness, circumference);
    return WB_OK;
}

enum wb_status wb_taping_sleeve(struct wb_taping *taping, double circumference,
                                double layer_thickness, int layers)
{
    WB_TRY(check(circumference, layer_thickness));
    if (layers < 1)
        return wb_fail(WB_ERR_ARGUMENT, "the sleeve has %d layers: expected 1 or more", layers);
    *taping = (struct wb_taping){.kind = WB_TAPING_SLEEVE,
                                 .layer_thickness = layer_thickness,
                                 .circumference = circumference,
                                 .layers = layers};
    return WB_OK;
}

/* p = (1 - lap) w / cos a and tan a = p / C give sin a = (1 - lap) w / C. */
enum wb_status wb_taping_wind(struct wb_taping *taping, double circumference,
                              double layer_thickness, const struct wb_taping_helix *helix)
{
    WB_TRY(check(circumference, layer_thickness));
    if (!(helix->lap >= 0.0 && helix->lap <= largest_lap) ||
        !(helix->width > 0.0 && isfinite(helix->width)) || (helix->hand != 1 && helix->hand != -1))
        return wb_fail(WB_ERR_ARGUMENT,
                       "the tape's helix has a width of %g m, a lap of %g and a hand of %d: "
                       "expected a width above 0, a lap from 0 to %g and a hand of 1 or -1",
                       helix->width, helix->lap, helix->hand, largest_lap);
    const double sine = (1.0 - helix->lap) * helix->width / circumference;
    if (!(sine < 1.0))
        return wb_fail(WB_ERR_ARGUMENT,
                       "a tape %g mm wide with a lap of %g cannot be wound round a circumference "
                       "of %g mm: expected a larger lap or a narrower tape",
                       1e3 * helix->width, helix->lap, 1e3 * circumference);
    const double cosine = sqrt(1.0 - sine * sine);
    *taping = (struct wb_taping){.kind = WB_TAPING_HELIX,
                                 .layer_thickness = layer_thickness,
                                 .circumference = circumference,
                                 .layers = 1.0 / (1.0 - helix->lap),
                                 .helix = *helix,
                                 .advance = circumference * sine / cosine,
                                 .angle = asin(sine),
                                 .covered = helix->width / cosine};
    return WB_OK;
}

double wb_taping_thickness(const struct wb_taping *taping)
{
    return taping->layers * taping->layer_thickness;
}

double wb_taping_area(const struct wb_taping *taping)
{
    return taping->layers * taping->circumference;
}
