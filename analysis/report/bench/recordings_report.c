#include "analysis/report/bench/recordings_report.h"

#include "analysis/report/bench/recordings_figures.h"
#include "analysis/report/bench/recordings_json.h"
#include "analysis/report/bench/recordings_pages.h"
#include "analysis/report/files.h"

#define WB_LOG_DOMAIN "report"

static struct wb_json *build_json(const void *context, const char *const *files, int n_files)
{
    return wb_recordings_json_build(context, files, n_files);
}

enum wb_status wb_recordings_report_write(const struct wb_recordings_results *results,
                                          const char *folder, bool force)
{
    struct wb_figures figures;
    struct wb_document document;
    WB_TRY(wb_figures_create(&figures, wb_recordings_figures, WB_RECORDINGS_FIGURES, results));
    wb_recordings_pages_build(&document, results, &figures);
    const struct wb_files_content content = {
        .document = &document, .figures = &figures, .json = build_json, .context = results};
    const enum wb_status status = wb_files_write(&content, folder, force);
    wb_document_release(&document);
    wb_figures_release(&figures);
    return status;
}
