#include "analysis/report/bench/recordings_report.h"

#include <stdlib.h>

#include "analysis/report/bench/recordings_json.h"
#include "analysis/report/figures.h"
#include "analysis/report/files.h"
#include "analysis/report/pages.h"

#define WB_LOG_DOMAIN "report"

static struct wb_json *build_json(const void *context, const char *const *files, int n_files)
{
    return wb_recordings_json_build(context, files, n_files);
}

static enum wb_status write_all(const struct wb_recordings_results *results,
                                const struct wb_figures *figures, const char *folder, bool force)
{
    const int n = wb_figures_list(figures, NULL);
    const struct wb_figure **const list = calloc((size_t)n + 1, sizeof(struct wb_figure *));
    if (!list)
        return wb_fail(WB_ERR_MEMORY, "out of memory writing the report");
    wb_figures_list(figures, list);
    struct wb_document document;
    wb_pages_build(&document, results, figures);
    const struct wb_files_content content = {
        .document = &document,
        .n_figures = n,
        .figures = list,
        .json = build_json,
        .context = results,
    };
    const enum wb_status status = wb_files_write(&content, folder, force);
    wb_document_release(&document);
    free(list);
    return status;
}

enum wb_status wb_recordings_report_write(const struct wb_recordings_results *results,
                                          const char *folder, bool force)
{
    struct wb_figures figures;
    WB_TRY(wb_figures_create(&figures, results));
    const enum wb_status status = write_all(results, &figures, folder, force);
    wb_figures_release(&figures);
    return status;
}
