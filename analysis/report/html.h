/* A document as one HTML file that needs no other file: it contains its style and its figures
 * (SVG). */
#ifndef WB_ANALYSIS_REPORT_HTML_H
#define WB_ANALYSIS_REPORT_HTML_H

#include "analysis/report/document.h"
#include "base/status.h"
#include "base/text.h"

/* Appends the whole file to `html`. */
WB_MUST_CHECK enum wb_status wb_html_render(const struct wb_document *document,
                                            struct wb_text *html);

#endif
