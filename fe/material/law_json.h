/* A law's numbers in JSON, in the unit and under the keys of its reader. */
#ifndef WB_FE_MATERIAL_LAW_JSON_H
#define WB_FE_MATERIAL_LAW_JSON_H

#include "base/json.h"
#include "fe/material/law.h"

/* Adds what the form of the law has beside E: Ludwik's numbers, the `parts`, or Chaboche's with
 * `back_stresses`; and `relaxation`, its Maxwell elements. `unit` of stresses ("MPa" or "Pa") ends
 * their keys and is `per_unit` Pa. A part that stays elastic has the yield strain null. */
void wb_law_json_numbers(struct wb_json *object, const struct wb_law *law, const char *unit,
                         double per_unit);

#endif
