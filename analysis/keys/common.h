/* Tables of keys that several rooms use. */
#ifndef WB_ANALYSIS_KEYS_COMMON_H
#define WB_ANALYSIS_KEYS_COMMON_H

#include "analysis/keys/keys.h"

/* Laws (law.c), which fe/material/ writes and reads. */
extern const struct wb_keys wb_keys_law_numbers; /* of a form, with _MPa */
extern const struct wb_keys wb_keys_law_of_file;
extern const struct wb_keys wb_keys_law_of_json;
extern const struct wb_keys wb_keys_ludwik; /* E, sigma_Y, K, n */

extern const struct wb_keys wb_keys_tool;
extern const struct wb_keys wb_keys_excluded; /* of an index of recordings */
extern const struct wb_keys wb_keys_sum;
extern const struct wb_keys wb_keys_machine;

/* Sets the member `tool`: this program, with a name such as "wirebench align". */
void wb_keys_put_tool(struct wb_json *object, const char *name);

#endif
