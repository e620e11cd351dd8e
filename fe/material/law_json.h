/* A law's parameters in JSON, in the unit and under the keys of its reader. */
#ifndef WB_FE_MATERIAL_LAW_JSON_H
#define WB_FE_MATERIAL_LAW_JSON_H

#include "base/json.h"
#include "fe/material/law.h"

/* Adds the parameters besides E: Ludwik's, the `parts`, or Chaboche's with `back_stresses`; and the
 * Maxwell elements as `relaxation`. Keys of stresses end with `unit` ("MPa" or "Pa"), which is
 * `per_unit` Pa. The yield strain of a part that stays elastic is null. */
void wb_law_json_numbers(struct wb_json *object, const struct wb_law *law, const char *unit,
                         double per_unit);

#endif
