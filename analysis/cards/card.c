#include "analysis/cards/card.h"

#include <stddef.h>
#include <string.h>

#include "analysis/cards/card_mujoco.h"
#include "analysis/cards/card_solid.h"
#include "analysis/cards/card_table.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "card"

/* Bits of wb_card_kind.place. */
enum {
    PLACE_SOLID = 1,
    PLACE_CHAIN = 2,
    PLACE_TABLE = 4
};

const struct wb_card_kind wb_card_kinds[WB_CARD_KINDS] = {
    {"calculix", "material of solid elements for CalculiX", "calculix.inp", PLACE_SOLID,
     wb_card_solid_calculix},
    {"abaqus", "material of solid elements for Abaqus", "abaqus.inp", PLACE_SOLID,
     wb_card_solid_abaqus},
    {"mujoco", "chain of hinges for MuJoCo, of one secant stiffness", "mujoco.xml", PLACE_CHAIN,
     wb_card_mujoco},
    {"table", "EI, moment over curvature, residual curvature ratio as JSON", "json", PLACE_TABLE,
     wb_card_table_json},
    {"table-csv", "moment over curvature as CSV", "csv", PLACE_TABLE, wb_card_table_csv},
};

const char *const wb_card_places[] = {"--to calculix and abaqus", "--to mujoco",
                                      "--to table and table-csv", NULL};

static const struct wb_setting rows[] = {
    {WB_ROW_QUANTITY(wb_card_settings, curvature, "curvature_1_m", "1/m", 1.0, 0.0, 1e4, 0.0),
     WB_ROW_OPTION("curvature", "K", "Curvature at which the secant stiffness is taken"),
     .otherwise = "0: the virgin wire", .applies = PLACE_CHAIN},
    {WB_ROW_QUANTITY(wb_card_settings, length, "length_mm", "mm", WB_MM, 1.0, 1e5, 0.0),
     WB_ROW_OPTION("length-mm", "L", "Length of the wire"), .otherwise = "the specimens', else 100",
     .applies = PLACE_CHAIN},
    {WB_ROW_INTEGER(wb_card_settings, segments, "segments", 2, 200, 10),
     WB_ROW_OPTION("segments", "N", "Joints of the chain"), .applies = PLACE_CHAIN},
    {WB_ROW_NUMBER(wb_card_settings, damping_ratio, "damping_ratio", 0.0, 10.0, 0.05),
     WB_ROW_OPTION("damping-ratio", "Z", "Assumed damping ratio of the first bending mode"),
     .applies = PLACE_CHAIN},
};

const struct wb_setting_table wb_card_table = {WB_SETTING_ROWS(rows)};

const struct wb_card_kind *wb_card_find(const char *name)
{
    struct wb_text names = {0};
    for (int i = 0; i < WB_CARD_KINDS; i++) {
        if (strcmp(wb_card_kinds[i].name, name) == 0)
            return &wb_card_kinds[i];
    }
    for (int i = 0; i < WB_CARD_KINDS; i++)
        wb_text_append(&names, "%s%s", i == 0 ? "" : ", ", wb_card_kinds[i].name);
    wb_error("no card '%s': expected one of %s; recordings and datasets are exported without a "
             "kind, with -o FILE.h5 (HDF5), a recording also with -o FOLDER (CSV)",
             name, wb_text_string(&names));
    wb_text_release(&names);
    return NULL;
}

enum wb_status wb_card_write(const struct wb_card_kind *kind, const struct wb_card_source *source,
                             const struct wb_card_settings *settings, struct wb_text *text,
                             struct wb_reason *why)
{
    WB_TRY(wb_setting_check(&wb_card_table, settings, why));
    return kind->write(source, settings, text, why);
}
