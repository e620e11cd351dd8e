#include "analysis/calibration/constituents/layers.h"

#include <stdlib.h>

#include "base/circle.h"
#include "base/config.h"
#include "base/memory.h"
#include "base/units.h"
#include "fe/rod/fibres.h"
#include "fe/rod/section.h"

#define WB_LOG_DOMAIN "layers"

/* Strips over a diameter; the moment of a plastic section is then accurate to 1e-3. */
#define STRIPS 200

static const struct wb_setting rows[] = {
    {WB_ROW_QUANTITY(wb_layers, conductor_diameter, "conductor_diameter_mm", "mm", WB_MM, 1e-3,
                     1000.0, 0.0),
     WB_ROW_OPTION("conductor-diameter-mm", "D",
                   "Diameter of the conductor; of strands, of the circle around them"),
     .otherwise = "none"},
    {WB_ROW_QUANTITY(wb_layers, outer_diameter, "outer_diameter_mm", "mm", WB_MM, 1e-3, 1000.0,
                     0.0),
     WB_ROW_OPTION("outer-diameter-mm", "D", "Outer diameter of the jacket"),
     .otherwise = "the conductor's"},
    {WB_ROW_INTEGER(wb_layers, strands, "strands", 1, 100000, 0),
     WB_ROW_OPTION("strands", "N", "Strands of the conductor"), .otherwise = "solid"},
    {WB_ROW_QUANTITY(wb_layers, strand_diameter, "strand_diameter_mm", "mm", WB_MM, 1e-4, 1000.0,
                     0.0),
     WB_ROW_OPTION("strand-diameter-mm", "D", "Diameter of a strand"), .otherwise = "none"},
};
const struct wb_setting_table wb_layers_table = {WB_SETTING_ROWS(rows)};

static bool has_jacket(const struct wb_layers *layers)
{
    return layers->outer_diameter > layers->conductor_diameter;
}

static enum wb_status check(const struct wb_layers *layers, struct wb_reason *why)
{
    if (!(layers->conductor_diameter > 0.0) ||
        !(layers->outer_diameter >= layers->conductor_diameter))
        return wb_fail_to(
            why, WB_ERR_ARGUMENT,
            "the outer diameter (%g mm) must not be less than the conductor's (%g mm)",
            layers->outer_diameter / WB_MM, layers->conductor_diameter / WB_MM);
    if (layers->strands < 0 || (layers->strands > 0) != (layers->strand_diameter > 0.0))
        return wb_fail_to(why, WB_ERR_ARGUMENT,
                          "strands and their diameter go together: expected both or neither");
    if (layers->strands > 0 && wb_layers_fill(layers) > 1.0)
        return wb_fail_to(why, WB_ERR_ARGUMENT,
                          "%d strands of %g mm do not fit into a circle of %g mm", layers->strands,
                          layers->strand_diameter / WB_MM, layers->conductor_diameter / WB_MM);
    return WB_OK;
}

double wb_layers_fill(const struct wb_layers *layers)
{
    if (layers->strands == 0)
        return 1.0;
    return layers->strands * wb_circle_area(layers->strand_diameter) /
           wb_circle_area(layers->conductor_diameter);
}

double wb_layers_rigidity(const struct wb_layers *layers, bool sliding)
{
    const bool strands_slide = sliding && layers->strands > 0;
    const double conductor =
        strands_slide
            ? layers->strands * wb_circle_second_moment(layers->strand_diameter)
            : wb_layers_fill(layers) * wb_circle_second_moment(layers->conductor_diameter);
    const double jacket = wb_circle_second_moment(layers->outer_diameter) -
                          wb_circle_second_moment(layers->conductor_diameter);
    const double of_conductor = layers->conductor.youngs_modulus * conductor;
    return has_jacket(layers) ? of_conductor + layers->jacket.youngs_modulus * jacket
                              : of_conductor;
}

double wb_layers_poissons_ratio(const struct wb_layers *layers)
{
    const double metal = wb_layers_fill(layers) * wb_circle_area(layers->conductor_diameter);
    const double jacket =
        wb_circle_area(layers->outer_diameter) - wb_circle_area(layers->conductor_diameter);
    if (!has_jacket(layers))
        return layers->conductor.poissons_ratio;
    return (layers->conductor.poissons_ratio * metal + layers->jacket.poissons_ratio * jacket) /
           (metal + jacket);
}

/* --- moments --- */

/* Adds `times` the moments of a section. The fibres are symmetric and the first loading is the same
 * in both directions, so that the neutral axis does not move and there is no axial strain to solve
 * for. */
static enum wb_status add_moments(const struct wb_section *section, double times,
                                  const double *curvature, int n, double *moment)
{
    struct wb_fibres *fibres;
    WB_TRY(wb_fibres_create(&fibres, section));
    const size_t size = wb_fibres_history_size(fibres);
    double *const before = wb_memory_new(2 * size, sizeof *before);
    for (int i = 0; i < n; i++) {
        struct wb_fibres_response response;
        wb_fibres_respond(fibres, 0.0, curvature[i], before, before + size, &response);
        moment[i] += times * response.M;
    }
    free(before);
    wb_fibres_destroy(fibres);
    return WB_OK;
}

static enum wb_status add_rings(struct wb_section *section, const struct wb_layers *layers,
                                bool with_conductor)
{
    wb_section_init_empty(section);
    if (with_conductor)
        WB_TRY(wb_section_add_ring(section, 0.0, layers->conductor_diameter, &layers->conductor,
                                   wb_layers_fill(layers), STRIPS));
    if (has_jacket(layers))
        WB_TRY(wb_section_add_ring(section, layers->conductor_diameter, layers->outer_diameter,
                                   &layers->jacket, 1.0, STRIPS));
    return WB_OK;
}

static enum wb_status add_strands(const struct wb_layers *layers, const double *curvature, int n,
                                  double *moment)
{
    struct wb_section section;
    WB_TRY(wb_section_init_circle(&section, layers->strand_diameter, &layers->conductor, STRIPS));
    const enum wb_status status = add_moments(&section, layers->strands, curvature, n, moment);
    wb_section_release(&section);
    return status;
}

enum wb_status wb_layers_moments(const struct wb_layers *layers, bool sliding,
                                 const double *curvature, int n, double *moment,
                                 struct wb_reason *why)
{
    const bool strands_slide = sliding && layers->strands > 0;
    struct wb_section section;
    WB_TRY(check(layers, why));
    for (int i = 0; i < n; i++)
        moment[i] = 0.0;
    if (strands_slide)
        WB_TRY(add_strands(layers, curvature, n, moment));
    if (strands_slide && !has_jacket(layers))
        return WB_OK;
    enum wb_status status = add_rings(&section, layers, !strands_slide);
    if (status == WB_OK)
        status = add_moments(&section, 1.0, curvature, n, moment);
    wb_section_release(&section);
    return status;
}
