/* Parts of report.json that all kinds of report have. Builders take NULL objects and return
 * nothing; the whole document says whether memory ran out, as base/json.h has it.
 */
#ifndef WB_ANALYSIS_REPORT_NUMBERS_H
#define WB_ANALYSIS_REPORT_NUMBERS_H

#include "analysis/keys/keys.h"
#include "analysis/report/kind.h"
#include "base/json.h"
#include "fe/material/material.h"

/* Keys of all kinds of report, and of `campaign`. */
extern const struct wb_keys wb_numbers_head_keys, wb_numbers_campaign_keys;

/* Starts report.json; `data` is "simulation" or "measured". The caller destroys it. */
struct wb_json *wb_numbers_create(const struct wb_campaign *campaign, const char *data,
                                  const struct wb_kind_outcome *outcome);

/* Its parts: title and `data` ("simulation", "measured"), the program, the campaign, how it came
 * out. */
void wb_numbers_put_title(struct wb_json *root, const char *title, const char *data);
void wb_numbers_put_program(struct wb_json *root);
void wb_numbers_put_campaign(struct wb_json *root, const struct wb_campaign *campaign);
void wb_numbers_put_outcome(struct wb_json *root, const struct wb_kind_outcome *outcome);

/* A list of numbers in another unit. */
void wb_numbers_put_list(struct wb_json *object, const char *key, const double *values, int n,
                         double unit);

/* E, sigma_Y, K and n, into an object. */
void wb_numbers_put_properties(struct wb_json *object, const struct wb_material *material);

#endif
