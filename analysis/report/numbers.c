#include "analysis/report/numbers.h"

#include "analysis/report/pages.h"
#include "base/version.h"

void wb_numbers_put_title(struct wb_json *root, const char *title, const char *data)
{
    wb_json_set_text(root, "title", title);
    wb_json_set_text(root, "data", data);
}

void wb_numbers_put_program(struct wb_json *root)
{
    wb_json_set_integer(root, "schema", 1);
    struct wb_json *const tool = wb_json_set_object(root, "tool");
    wb_json_set_text(tool, "name", "wirebench report");
    wb_json_set_text(tool, "version", wb_version());
    wb_json_set_text(tool, "revision", wb_version_revision());
}

void wb_numbers_put_campaign(struct wb_json *root, const struct wb_campaign *campaign)
{
    struct wb_json *const file = wb_json_set_object(root, "campaign");
    wb_json_set_text(file, "file", campaign->name);
    wb_json_set_text(file, "sha256", campaign->sha256);
}

void wb_numbers_put_outcome(struct wb_json *root, const struct wb_kind_outcome *outcome)
{
    wb_json_set_boolean(root, "complete", outcome->is_complete);
    wb_json_set_boolean(root, "limit_exceeded", outcome->exceeds_limit);
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
