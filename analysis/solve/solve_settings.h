/* Settings of a simulated test: the options of `wirebench solve`, and the requests of a
 * campaign. */
#ifndef WB_ANALYSIS_SOLVE_SOLVE_SETTINGS_H
#define WB_ANALYSIS_SOLVE_SOLVE_SETTINGS_H

#include <stdbool.h>

#include "base/setting.h"
#include "base/status.h"
#include "fe/model/bundle_override.h"

/* Kinds, as bits of the settings that apply to them. */
enum {
    WB_SOLVE_CANTILEVER = 1,
    WB_SOLVE_WIRE3D = 2,
    WB_SOLVE_WIRE1D = 4,
    WB_SOLVE_BUNDLE = 8,
    WB_SOLVE_THREE_POINT = 16,
    WB_SOLVE_HARNESS = 32, /* not of wb_solve_run() but of analysis/harness */
    WB_SOLVE_KINDS = 6     /* number of kinds */
};

/* Their names by bit, NULL-terminated: "cantilever", "wire3d", "wire1d", "bundle", "bending3p",
 * "harness". */
extern const char *const wb_solve_settings_kinds[WB_SOLVE_KINDS + 1];

/* Models of a bundle. */
enum {
    WB_SOLVE_EXPLICIT, /* in explicit dynamics */
    WB_SOLVE_SECTION   /* by fe/section/section_run.h */
};

enum {
    WB_SOLVE_ELASTOPLASTIC,
    WB_SOLVE_ELASTIC
};

/* Rows: wb_solve_settings_table, and those of the override. Texts are borrowed. */
struct wb_solve_settings {
    unsigned kind;      /* one bit of the kinds */
    const char *output; /* folder of the dataset; NULL: not written */
    bool force;         /* overwrite it, and VTK files */
    /* Settings of the cantilever. */
    const char *wire;                  /* name or file */
    double length, deflection, strand; /* m; strand 0: a vertical force */
    int law;                           /* WB_SOLVE_ELASTOPLASTIC or WB_SOLVE_ELASTIC */
    int cycles, points;
    bool weight;
    /* Settings of three-point bending, in addition to some of the cantilever's. */
    double span, overhang;             /* m; overhang 0: 0.3 span */
    double roller_radius, nose_radius; /* m */
    double friction, compliance;       /* 1; m/N */
    double bow;                        /* m: rise of the natural shape's arc over the span */
    bool whole;                        /* compute both halves */
    /* Settings of wires, of bundles, and of the wire in three-point bending. */
    const char *model; /* name or file */
    const char *vtk;   /* folder; NULL: none; not of wire1d */
    /* Settings of a harness. */
    int frames;       /* shapes of a step; 0: its end alone */
    const char *gltf; /* file; NULL: none */
    /* Settings of bundles. */
    int bundle_model; /* WB_SOLVE_EXPLICIT or WB_SOLVE_SECTION */
    struct wb_bundle_override override;
    int vtk_every; /* rows; 0: 1 */
    int threads;
    const char *checkpoint;     /* file; NULL: none */
    double checkpoint_interval; /* s; 0: 10 minutes */
    /* Settings of the section model, and of harnesses. */
    bool uncertain;    /* bands, by analysis/predict/bands.h or analysis/harness/harness_bands.h */
    int runs, seed;    /* of the bands */
    const char *sweep; /* cases in place of the file's scenarios; NULL: none */
    /* Settings of harnesses. */
    bool follow;      /* steps from standard input */
    const char *part; /* of the runs of the bands, "2/20"; NULL: all */
};

extern const struct wb_setting_table wb_solve_settings_table;

/* Rejects options without effect, so that a single run is not mistaken for bands of many. */
WB_MUST_CHECK enum wb_status wb_solve_settings_check(const struct wb_solve_settings *settings);

const char *wb_solve_settings_kind(const struct wb_solve_settings *settings); /* name of the kind */

/* The words of the command with these settings, without program and output: "solve", "bundle",
 * the model, then the options that differ from the defaults. NULL-terminated, in one block for
 * free(). */
char **wb_solve_settings_command(const struct wb_solve_settings *settings);

#endif
