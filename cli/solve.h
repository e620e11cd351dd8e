/* What `wirebench solve` asks for, and what its kinds share: cmd_solve.c knows the kinds and
 * parses, solve_*.c compute, write and print by the means of solve.c.
 */
#ifndef WB_CLI_SOLVE_H
#define WB_CLI_SOLVE_H

#include <stdbool.h>

#include "base/json.h"
#include "base/setting.h"
#include "cli/command.h"
#include "fe/linear/trial.h"
#include "fe/model/bundle_override.h"

/* Kinds, as bits of the settings that apply to them. */
enum {
    WB_SOLVE_CANTILEVER = 1,
    WB_SOLVE_WIRE3D = 2,
    WB_SOLVE_WIRE1D = 4,
    WB_SOLVE_BUNDLE = 8
};

enum {
    WB_SOLVE_ELASTOPLASTIC,
    WB_SOLVE_ELASTIC
};

/* Rows: wb_solve_settings, and those of the override. */
struct wb_solve_options {
    struct wb_command_common common;
    unsigned kind;         /* its bit; 0: none was named */
    const char *kind_name; /* "cantilever", "wire3d", "wire1d", "bundle" */
    /* Of the cantilever. */
    const char *wire;                  /* name or file */
    double length, deflection, strand; /* m; strand 0: a vertical force */
    int law;                           /* WB_SOLVE_ELASTOPLASTIC or WB_SOLVE_ELASTIC */
    int cycles, points;
    bool weight;
    /* Of the wires, and of bundles. */
    const char *model; /* name or file */
    const char *vtk;   /* folder; NULL: none; not of wire1d */
    /* Of bundles. */
    struct wb_bundle_override override;
    int vtk_every; /* rows; 0: 1 */
    int threads;
    const char *checkpoint;     /* file; NULL: none */
    double checkpoint_interval; /* s */
};

extern const struct wb_setting_table wb_solve_settings;

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

/* Wall and CPU time, s: differences of two readings count. */
struct wb_solve_time {
    double wall, cpu;
};
struct wb_solve_time wb_solve_now(void);

#endif
