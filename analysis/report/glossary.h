/* The glossary at the end of a report: the terms that the report uses, with symbol, unit and
 * meaning. */
#ifndef WB_ANALYSIS_REPORT_GLOSSARY_H
#define WB_ANALYSIS_REPORT_GLOSSARY_H

#include "analysis/report/document.h"

/* Adds the terms that occur in the document so far; nothing where none does. */
void wb_glossary_put(struct wb_document *document);

#endif
