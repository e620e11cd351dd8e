/* The first page of a report of any kind, "What was found": where the data come from, what was
 * found, whether to trust it, what to do next, and one figure. A kind adds sentences in any order;
 * headings, order and colours are set here.
 *
 *     struct wb_found found = {0};
 *     wb_found_say(&found, WB_FOUND_RESULT, "The bundle needs %.3g N.", force);
 *     wb_found_put(&found, document);
 *     wb_figures_put(figures, document, "found", 0);
 *
 * A sentence is markup (analysis/report/document.h), begins with a capital letter and ends with a
 * full stop. A failed check colours the page: then no sentence is green.
 */
#ifndef WB_ANALYSIS_REPORT_FOUND_H
#define WB_ANALYSIS_REPORT_FOUND_H

#include <stddef.h>

#include "analysis/report/document.h"
#include "analysis/report/verdict.h"
#include "base/text.h"

enum wb_found_part {
    WB_FOUND_ORIGIN,     /* where the data come from: "Virtual rig.", "Simulations." */
    WB_FOUND_INCOMPLETE, /* data or steps that are missing */
    WB_FOUND_RESULT,     /* one sentence for each thing that was tested or computed */
    WB_FOUND_DOUBTFUL,   /* a result that failed a check; in its place among the results */
    WB_FOUND_NOTE,       /* how to read the results */
    WB_FOUND_FAILED,     /* a limit that is exceeded, a check that failed */
    WB_FOUND_PASSED,     /* limits that are kept, checks that passed */
    WB_FOUND_UNCHECKED,  /* what no check of this report covers */
    WB_FOUND_NEXT        /* an instruction */
};

struct wb_found_sentence {
    enum wb_found_part part;
    struct wb_text text;
};

/* Sentences that were added; starts zeroed. */
struct wb_found {
    size_t n, capacity;
    struct wb_found_sentence *sentences; /* (n), owned */
};

/* Adds a sentence, which takes the text over and leaves it empty; nothing where it is empty. */
void wb_found_add(struct wb_found *found, enum wb_found_part part, struct wb_text *sentence);
void wb_found_say(struct wb_found *found, enum wb_found_part part, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Adds the verdicts on limits: of each limit the values that exceed it and those that keep it, in a
 * sentence each. */
void wb_found_add_verdicts(struct wb_found *found, const struct wb_verdict *verdicts, int n);

/* Writes the page into the document and releases the sentences. */
void wb_found_put(struct wb_found *found, struct wb_document *document);

#endif
