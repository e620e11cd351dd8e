/* Renders a document as one self-contained HTML file: the style sheet and the figures (SVG) are
 * inside. */
#ifndef WB_ANALYSIS_REPORT_HTML_H
#define WB_ANALYSIS_REPORT_HTML_H

#include "analysis/report/document.h"
#include "base/status.h"
#include "base/text.h"

/* Appends the complete file to `html`. */
WB_MUST_CHECK enum wb_status wb_html_render(const struct wb_document *document,
                                            struct wb_text *html);

#endif
