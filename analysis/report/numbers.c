#include "analysis/report/numbers.h"

#include "analysis/keys/common.h"
#include "analysis/keys/row.h"
#include "analysis/report/pages.h"

#define CAMPAIGN(member) WB_AT(struct wb_campaign, member)

static const struct wb_key wb_numbers_campaign_rows[] = {
    {"file", CAMPAIGN(name), "name of the campaign file"},
    {"sha256", CAMPAIGN(sha256), "SHA-256 of the campaign file"},
};
WB_KEYS(wb_numbers_campaign, "campaign", "The campaign file.");

static const struct wb_key report_end_rows[] = {
    {"laboratory", OBJECT | OPTIONAL, "fields of a laboratory", &wb_laboratory_keys},
    {"files", TEXT | LIST, "files of the report, relative to its folder"},
};
static WB_KEYS(report_end, "report_end", "");

static const struct wb_key wb_numbers_head_rows[] = {
    {"title", TEXT, "title of the campaign"},
    {"data", TEXT, "origin of the data", .choices = "measured|measured (virtual rig)|simulation"},
    {"schema", INTEGER, "layout of the file, 1"},
    {"tool", OBJECT, "program that wrote the report", &wb_common_tool_keys},
    {"campaign", OBJECT, "campaign file", &wb_numbers_campaign_keys},
    {"complete", WB_AT(struct wb_kind_outcome, is_complete),
     "false: data are missing (exit code 3)"},
    {"limit_exceeded", WB_AT(struct wb_kind_outcome, exceeds_limit),
     "true: a limit of the campaign is exceeded (exit code 4)"},
    {.of = &report_end_keys},
};
WB_KEYS(wb_numbers_head, "report_head", "");

void wb_numbers_put_title(struct wb_json *root, const char *title, const char *data)
{
    wb_json_set_text(root, "title", title);
    wb_json_set_text(root, "data", data);
}

void wb_numbers_put_program(struct wb_json *root)
{
    wb_json_set_integer(root, "schema", 1);
    wb_keys_put_tool(root, "wirebench report");
}

void wb_numbers_put_campaign(struct wb_json *root, const struct wb_campaign *campaign)
{
    struct wb_json *const file = wb_json_set_object(root, "campaign");
    WB_PUT(file, &wb_numbers_campaign_keys, struct wb_campaign, campaign);
}

void wb_numbers_put_outcome(struct wb_json *root, const struct wb_kind_outcome *outcome)
{
    WB_PUT(root, &wb_numbers_head_keys, struct wb_kind_outcome, outcome);
}

struct wb_json *wb_numbers_create(const struct wb_campaign *campaign, const char *data,
                                  const struct wb_kind_outcome *outcome)
{
    struct wb_json *const root = wb_json_create();
    wb_numbers_put_title(root, campaign->title, data);
    wb_numbers_put_program(root);
    wb_numbers_put_campaign(root, campaign);
    wb_numbers_put_outcome(root, outcome);
    return root;
}

void wb_numbers_put_list(struct wb_json *object, const char *key, const double *values, int n,
                         double unit)
{
    struct wb_json *const list = wb_json_set_array(object, key);
    for (int i = 0; i < n; i++)
        wb_json_append_number(list, values[i] / unit);
}

void wb_numbers_put_properties(struct wb_json *object, const struct wb_material *material)
{
    for (int i = 0; i < 4; i++)
        wb_json_set_number(object, wb_pages_properties[i].key,
                           wb_pages_value(material, i) / wb_pages_properties[i].factor);
}
