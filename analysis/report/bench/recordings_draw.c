#include "analysis/report/bench/recordings_draw.h"

#include <ctype.h>
#include <stdio.h>

const char *wb_recordings_draw_measured(const struct wb_recordings_results *results)
{
    return results->any_virtual ? "measured (virtual rig)" : "measured";
}

void wb_recordings_draw_slug(char slug[64], const char *name)
{
    size_t n = 0;
    for (; name[n] && n < 48; n++)
        slug[n] = (char)(isalnum((unsigned char)name[n]) ? tolower((unsigned char)name[n]) : '-');
    slug[n] = '\0';
}

const struct wb_recordings_results_wire *wb_recordings_draw_wire(const struct wb_figures_item *item)
{
    const struct wb_recordings_results *const results = item->results;
    return &results->wires[item->index];
}

int wb_recordings_draw_count(const void *context)
{
    const struct wb_recordings_results *const results = context;
    return results->n_wires;
}

enum wb_status wb_recordings_draw_start(struct wb_figures_item *item, const char *kind,
                                        double width, double height)
{
    char slug[64] = "all", name[128];
    if (item->row->count)
        wb_recordings_draw_slug(slug, wb_recordings_draw_wire(item)->wanted->product.name);
    snprintf(name, sizeof name, "%s-%s", slug, kind);
    WB_TRY(wb_figure_create(&item->figure, name, width, height));
    wb_figure_set_footer(item->figure, wb_recordings_draw_measured(item->results));
    return WB_OK;
}
