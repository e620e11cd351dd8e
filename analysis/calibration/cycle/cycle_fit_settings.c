
#include "analysis/calibration/cycle/cycle_fit.h"
#include "base/units.h"

const struct wb_setting wb_cycle_fit_rows[WB_CYCLE_FIT_ROWS] = {
    {WB_ROW_QUANTITY(wb_cycle_fit_settings, force_noise, "force_noise_mN", "mN", 1e-3, 1e-6, 1e6,
                     0.03),
     WB_ROW_OPTION("force-noise-mn", "F",
                   "Noise of a force: a point is weighted by the inverse of the larger of this and "
                   "--force-share")},
    {WB_ROW_NUMBER(wb_cycle_fit_settings, force_share, "force_share", 1e-6, 1.0, 2e-3),
     WB_ROW_OPTION("force-share", "R", "Noise of a force as a part of the largest force")},
    {WB_ROW_QUANTITY(wb_cycle_fit_settings, place_noise, "marker_noise_mm", "mm", WB_MM, 1e-4, 1e6,
                     0.1),
     WB_ROW_OPTION("marker-noise-mm", "D", "Noise of a marker's position")},
    {WB_ROW_QUANTITY(wb_cycle_fit_settings, offset_prior, "marker_offset_mm", "mm", WB_MM, 1e-4,
                     100.0, 0.07),
     WB_ROW_OPTION("marker-offset-mm", "D", "Prior of a marker's constant distance from the axis")},
    {WB_ROW_QUANTITY(wb_cycle_fit_settings, level_prior, "level_prior_mm", "mm", WB_MM, 1e-4, 100.0,
                     0.1),
     WB_ROW_OPTION("level-prior-mm", "D", "Prior of the level of zero deflection")},
    {WB_ROW_QUANTITY(wb_cycle_fit_settings, uneven_prior, "uneven_prior_rad", "rad", 1.0, 1e-6,
                     10.0, 0.05),
     WB_ROW_OPTION("uneven-prior-rad", "A",
                   "Prior of the angle of a specimen's uneven natural bend")},
    {WB_ROW_NUMBER(wb_cycle_fit_settings, modulus_prior, "modulus_prior", 1e-2, 1e3, 4.0),
     WB_ROW_OPTION("modulus-prior", "X",
                   "Prior of the second differences of the yielding parts' log moduli")},
    {WB_ROW_QUANTITY(wb_cycle_fit_settings, relaxation_prior, "relaxation_prior_percent", "%",
                     WB_PERCENT, 1e-3, 100.0, 2.0),
     WB_ROW_OPTION("relaxation-prior", "P",
                   "Of a test without a dwell: standard uncertainty of the part of the force that "
                   "would relax during one")},
    {WB_ROW_INTEGER(wb_cycle_fit_settings, n_elements, "search_elements", 4, 500, 12),
     WB_ROW_OPTION("search-elements", "N", "Beam elements during the search")},
    {WB_ROW_INTEGER(wb_cycle_fit_settings, n_final_elements, "final_elements", 4, 500, 50),
     WB_ROW_OPTION("final-elements", "N", "Beam elements of the final fit")},
    {WB_ROW_INTEGER(wb_cycle_fit_settings, n_fibres, "section_fibres", 4, 1000, 20),
     WB_ROW_OPTION("section-fibres", "N", "Fibres over the diameter")},
    {WB_ROW_INTEGER(wb_cycle_fit_settings, max_iterations, "fit_iterations", 1, 10000, 100),
     WB_ROW_OPTION("fit-iterations", "N", "Maximum number of iterations of a fit")},
};

void wb_cycle_fit_default_settings(struct wb_cycle_fit_settings *settings)
{
    const struct wb_setting_table table = {.rows = wb_cycle_fit_rows, .n = WB_CYCLE_FIT_ROWS};
    *settings = (struct wb_cycle_fit_settings){.zero_prior = 0.0};
    wb_setting_fill(&table, settings);
}
