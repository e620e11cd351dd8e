/* Tables of keys that several rooms use. */
#ifndef WB_ANALYSIS_KEYS_COMMON_H
#define WB_ANALYSIS_KEYS_COMMON_H

#include "analysis/keys/keys.h"

/* Laws (law.c), which fe/material/ writes and reads. */
extern const struct wb_keys wb_law_numbers_keys; /* of a form, with _MPa */
extern const struct wb_keys wb_law_file_keys;
extern const struct wb_keys wb_law_json_keys;
extern const struct wb_keys wb_law_ludwik_keys; /* E, sigma_Y, K, n */

extern const struct wb_keys wb_common_tool_keys;
extern const struct wb_keys wb_common_excluded_keys; /* of an index of recordings */
extern const struct wb_keys wb_common_sum_keys;
extern const struct wb_keys wb_common_machine_keys;

/* Sets the member `tool`: this program, with a name such as "wirebench align". */
void wb_keys_put_tool(struct wb_json *object, const char *name);

#endif
