/* Interface of a kind of simulated test. To add one, write its row and functions in a file
 * solve_KIND.c, give it a bit and a name in solve_settings.*, and add the row to solve.c. */
#ifndef WB_ANALYSIS_SOLVE_SOLVE_KIND_H
#define WB_ANALYSIS_SOLVE_SOLVE_KIND_H

#include "analysis/dataset/dataset.h"
#include "analysis/solve/solve.h"
#include "analysis/solve/solve_time.h"
#include "base/progress.h"
#include "fe/output/vtk_file.h"

/* The part of a run that solve.c uses; the struct of each kind begins with it. */
struct wb_solve {
    const struct wb_solve_kind *kind;
    const struct wb_solve_settings *settings;
    bool made_output, made_vtk;       /* folders that this run created */
    struct wb_vtk_file_series series; /* of settings->vtk */
    struct wb_progress progress;
    struct wb_solve_time spent; /* time of the computation, without: */
    struct wb_solve_time aside; /* time spent on fields and files */
    /* Set by the kind's prepare(). */
    const char *name; /* of the model, for messages and names of files */
    /* Set by the kind's compute(). */
    int n_rows;
    bool converged, stopped; /* to the end of the curve; by an interrupt */
    bool kept;               /* stopped, and the checkpoint contains the whole state */
};

/* Each function gets the struct of the kind. */
struct wb_solve_kind {
    size_t size; /* of its struct */
    /* Reads the model and allocates the results. */
    enum wb_status (*prepare)(void *run);
    /* Not to converge is a result, not an error. */
    enum wb_status (*compute)(void *run);
    void (*fill)(const void *run, struct wb_dataset *dataset);
    /* Writes the files of the dataset's folder besides its tables; NULL: none. */
    enum wb_status (*write)(const void *run, const struct wb_dataset *dataset, const char *folder);
    void (*row)(const void *run, int index, struct wb_solve_row *row);
    void (*describe)(const void *run, struct wb_json *object);
    /* Appends a summary besides the rows; false: none. NULL: never one. */
    bool (*summarise)(const void *run, struct wb_text *text);
    void (*warn_not_converged)(const void *run); /* logs why it did not converge */
    void (*warn)(const void *run);               /* of limits of validity; may be NULL */
    void (*release)(void *run);                  /* accepts a partly prepared one */
};

extern const struct wb_solve_kind wb_solve_cantilever, wb_solve_wire, wb_solve_bundle,
    wb_solve_section, wb_solve_three_point;

#endif
