/* A document as PDF: A4 pages, vector figures, searchable text, bookmarks. */
#ifndef WB_ANALYSIS_REPORT_PDF_H
#define WB_ANALYSIS_REPORT_PDF_H

#include "analysis/report/document.h"
#include "base/status.h"
#include "base/text.h"

/* Width of the text, pt: of a figure over the whole width, and of one of two side by side. */
#define WB_PDF_WIDTH 487.0
#define WB_PDF_HALF_WIDTH 237.0

/* Appends the whole file to `pdf`. */
WB_MUST_CHECK enum wb_status wb_pdf_render(const struct wb_document *document, struct wb_text *pdf);

/* Writes the file, whole or not at all. */
WB_MUST_CHECK enum wb_status wb_pdf_write(const struct wb_document *document, const char *path);

#endif
