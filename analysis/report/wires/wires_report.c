#include "analysis/report/wires/wires_report.h"

#include "analysis/report/files.h"
#include "analysis/report/wires/wires_figures.h"
#include "analysis/report/wires/wires_pages.h"

#define WB_LOG_DOMAIN "report"

static struct wb_json *build_json(const void *context, const char *const *files, int n_files)
{
    return wb_wires_json_build(context, files, n_files);
}

enum wb_status wb_wires_report_write(const struct wb_wires_results *results, const char *folder,
                                     bool force)
{
    struct wb_wires_figures figures;
    const struct wb_figure *list[WB_WIRES_FIGURES];
    struct wb_document document;
    WB_TRY(wb_wires_figures_create(&figures, results));
    wb_wires_pages_build(&document, results, &figures);
    const struct wb_files_content content = {
        .document = &document,
        .n_figures = wb_wires_figures_list(&figures, list),
        .figures = list,
        .json = build_json,
        .context = results,
    };
    const enum wb_status status = wb_files_write(&content, folder, force);
    wb_document_release(&document);
    wb_wires_figures_release(&figures);
    return status;
}
