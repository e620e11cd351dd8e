/* What a kind of simulated test is made of. To add one, write its row and functions in a file
 * solve_KIND.c, give it a bit and a name in solve_settings.*, and add the row to solve.c. */
#ifndef WB_ANALYSIS_SOLVE_SOLVE_KIND_H
#define WB_ANALYSIS_SOLVE_SOLVE_KIND_H

#include "analysis/dataset/dataset.h"
#include "analysis/solve/solve.h"
#include "analysis/solve/solve_time.h"
#include "base/progress.h"
#include "fe/output/vtk_file.h"

/* A run, as solve.c sees it; the struct of each kind begins with it. */
struct wb_solve {
    const struct wb_solve_kind *kind;
    const struct wb_solve_settings *settings;
    bool made_output, made_vtk;       /* folders that this run created */
    struct wb_vtk_file_series series; /* of settings->vtk */
    struct wb_progress progress;
    struct wb_solve_time spent; /* on computing, without: */
    struct wb_solve_time aside; /* on fields and files meanwhile */
    /* Set by the kind's prepare(). */
    const char *name; /* of the model, for messages and names of files */
    /* Set by the kind's compute(). */
    int n_rows;
    bool converged, stopped; /* to the end of what was reached; by an interrupt */
    bool kept;               /* stopped, and the checkpoint holds it all */
};

/* All get a struct of the kind. */
struct wb_solve_kind {
    size_t size; /* of its struct */
    /* Reads the model and makes room for the results. */
    enum wb_status (*prepare)(void *run);
    /* Not to converge is a result, no error. */
    enum wb_status (*compute)(void *run);
    void (*fill)(const void *run, struct wb_dataset *dataset);
    /* Writes what lies in the dataset's folder beside its tables; NULL: nothing. */
    enum wb_status (*write)(const void *run, const struct wb_dataset *dataset, const char *folder);
    void (*row)(const void *run, int index, struct wb_solve_row *row);
    void (*describe)(const void *run, struct wb_json *object);
    /* What it comes to besides its rows; false: nothing. NULL: never anything. */
    bool (*summarise)(const void *run, struct wb_text *text);
    void (*tell_lost)(const void *run); /* says why it did not converge */
    void (*warn)(const void *run);      /* of what else a reader of the curve must know; or NULL */
    void (*release)(void *run);         /* accepts one that was prepared in part */
};

extern const struct wb_solve_kind wb_solve_cantilever, wb_solve_wire, wb_solve_bundle,
    wb_solve_section, wb_solve_three_point;

#endif
