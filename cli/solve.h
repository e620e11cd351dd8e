/* What `wirebench solve` asks for, and how its models answer: cmd_solve.c parses, solve_*.c
 * compute, write and print.
 */
#ifndef WB_CLI_SOLVE_H
#define WB_CLI_SOLVE_H

#include <stdbool.h>

#include "base/json.h"
#include "cli/command.h"
#include "fe/linear/trial.h"
#include "fe/model/bundle_override.h"

enum wb_solve_kind {
    WB_SOLVE_NONE,
    WB_SOLVE_CANTILEVER,
    WB_SOLVE_WIRE3D,
    WB_SOLVE_WIRE1D,
    WB_SOLVE_BUNDLE
};

struct wb_solve_options {
    struct wb_command_common common;
    enum wb_solve_kind kind;
    const char *kind_name; /* "cantilever", "wire3d", "wire1d", "bundle" */
    /* Of the cantilever. */
    const char *wire;                  /* name or file */
    double length, deflection, strand; /* m */
    int cycles, points;
    bool elastic, weight;
    const char *cantilever_option; /* one of these that was given; NULL: none */
    /* Of the wires, and of bundles. */
    const char *model; /* name or file */
    const char *vtk;   /* folder; NULL: none; not of wire1d */
    /* Of bundles. */
    struct wb_bundle_override override;
    int vtk_every;              /* rows */
    int threads;                /* 0: 1 */
    const char *checkpoint;     /* file; NULL: none */
    double checkpoint_interval; /* s; 0: 600 */
    const char *bundle_option;  /* one of its options that was given; NULL: none */
};

/* Each returns an exit code. */
int wb_solve_cantilever(const struct wb_solve_options *options);
int wb_solve_wire(const struct wb_solve_options *options);
int wb_solve_bundle(const struct wb_solve_options *options);

/* A row of any model, as it is printed. */
struct wb_solve_point {
    int cycle;
    enum wb_phase phase;
    double deflection, tension, force, tip_x, tip_angle;
};

/* As CSV on stdout: the names of the columns, and one row. */
void wb_solve_print_header(void);
void wb_solve_print_point(const struct wb_solve_point *point);

/* As members of a JSON object. */
void wb_solve_set_point(struct wb_json *object, const struct wb_solve_point *point);

/* Wall and CPU time, s, from any begin. */
struct wb_solve_time {
    double wall, cpu;
};
struct wb_solve_time wb_solve_now(void);

#endif
