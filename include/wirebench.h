/* libwirebench: recordings, datasets, simulated tests and calibration of wirebench, for other
 * programs.
 *
 * Units are SI in every double: m, kg, s, N, Pa, rad. NaN is an unknown value.
 *
 * Failures. A function that can fail returns an enum wirebench_status: 0, a negative code, or
 * WIREBENCH_INCOMPLETE, with which results were delivered although something is missing or
 * doubtful. wirebench_message() describes what was wrong in the last call of the same thread; for
 * an error in a file it names file, line and key. Nothing is printed, and the library never ends
 * the process.
 *
 * Handles. A `struct wirebench_...` without members here is a handle: the function with `out`
 * creates it, one of the functions without a status frees it and accepts NULL. Texts, tables and
 * columns are borrowed from the handle that returned them and live as long as it does. Results are
 * written only on success (0 or WIREBENCH_INCOMPLETE), unless a function says otherwise.
 *
 * Threads. Two threads may use two handles at the same time; a handle is used by one thread at a
 * time. Handles that are const in a call may be used by several.
 *
 * Structs. Each begins with its size, so that a program built with this header works with later
 * releases: struct wirebench_law law = {.size = sizeof law}. In structs that the caller fills in, 0
 * means the default given in the member's comment.
 *
 * The process. No locale, signal handler, environment variable or standard stream is changed. GSL's
 * error handler, which is global to the process, is switched off during wirebench_dataset_align()
 * and wirebench_calibrate(), and restored when the last such call has ended.
 *
 * A recording contains the bytes of the instruments with their times; a dataset, made from a
 * recording, is a test as a table of force over deflection; properties describe a wire.
 * docs/library.md shows the use from C and Python.
 */
#ifndef WIREBENCH_H
#define WIREBENCH_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* --- status and messages --- */

enum wirebench_status {
    WIREBENCH_INCOMPLETE = 1, /* delivered; wirebench_message() says what is missing or doubtful */
    WIREBENCH_OK = 0,
    WIREBENCH_ERR_ARGUMENT = -1,   /* invalid use of the function, or a value out of range */
    WIREBENCH_ERR_MEMORY = -2,     /* out of memory */
    WIREBENCH_ERR_IO = -3,         /* a file could not be read */
    WIREBENCH_ERR_NOT_FOUND = -4,  /* a file, key or name does not exist */
    WIREBENCH_ERR_FORMAT = -5,     /* bytes or text do not follow their format */
    WIREBENCH_ERR_BUSY = -6,       /* the file is in use by another process */
    WIREBENCH_ERR_PERMISSION = -7, /* not allowed to open it */
    WIREBENCH_ERR_TIMEOUT = -8, /* stopped by the caller's `progress` before there was a result */
    WIREBENCH_ERR_UNSUPPORTED = -9, /* not supported by the function */
    WIREBENCH_ERR_EXISTS = -10,     /* would overwrite an existing file */
    WIREBENCH_ERR_DATA = -11,       /* the data do not suffice for the purpose */
    WIREBENCH_ERR_CONVERGENCE =
        -12 /* an iteration did not converge, and there is no partial result */
};

/* The release, "0.1.0", and the source revision of its build. */
const char *wirebench_version(void);
const char *wirebench_revision(void);

/* Short text of a status, "no such file or name"; never NULL. */
const char *wirebench_status_text(enum wirebench_status status);

/* The message of this thread's last call that returned a status; "" after a success. Valid until
 * this thread's next such call. */
const char *wirebench_message(void);

/* Warnings and remarks of this thread's last call that returned a status, one per line; "" if there
 * are none. Valid as long as the message. */
const char *wirebench_warnings(void);

/* --- tables --- */

enum wirebench_column_type {
    WIREBENCH_REAL,
    WIREBENCH_INTEGER,
    WIREBENCH_TEXT
};

/* A column. Of the three arrays (n) only that of its type is set; the others are NULL. */
struct wirebench_column {
    size_t size;
    const char *name; /* with its unit: "force_N" */
    const char *unit; /* "N"; "1" for counts and flags; "" for texts */
    enum wirebench_column_type type;
    size_t n;
    const double *reals;      /* NaN: no value */
    const int64_t *integers;  /* flags are 0 and 1 */
    const char *const *texts; /* UTF-8 */
};

struct wirebench_table;

size_t wirebench_table_rows(const struct wirebench_table *table);
int wirebench_table_columns(const struct wirebench_table *table);

/* A column by its index from 0, or by its name; WIREBENCH_ERR_NOT_FOUND. */
enum wirebench_status wirebench_table_column(const struct wirebench_table *table, int index,
                                             struct wirebench_column *column);
enum wirebench_status wirebench_table_find(const struct wirebench_table *table, const char *name,
                                           struct wirebench_column *column);

/* --- recordings --- */

struct wirebench_recording;

enum wirebench_role {
    WIREBENCH_LOAD,
    WIREBENCH_MOCAP,
    WIREBENCH_STAGE
};

/* Contents of a recording, and whether it is complete. */
struct wirebench_recording_info {
    size_t size;
    char sha256[65]; /* of the uncompressed file, in hex; "" if unknown */
    int is_virtual;  /* from the virtual rig */
    int is_whole;    /* nothing is missing, damaged, dropped or cut short */
    int n_problems;  /* wirebench_recording_problem() describes each */
    int n_streams;
    int64_t first_ns; /* arrival of the first bytes, ns of the host's monotonic clock */
    double duration;  /* s, from the first to the last bytes */
    uint64_t chunks, damaged_chunks, events;
};

/* Data of one instrument. */
struct wirebench_stream {
    size_t size;
    int id;
    enum wirebench_role role;
    char address[160];
    char protocol[32];
    uint64_t chunks, bytes; /* reads or datagrams, and their bytes */
    uint64_t samples;       /* decoded: readings, frames or reports */
    double rate;            /* 1/s; 0 if unknown */
    double longest_silence; /* s */
};

/* Opens a recording, NAME.wbr or NAME.wbr.zst, for reading. The readable part of a damaged
 * recording can be used. */
enum wirebench_status wirebench_recording_open(struct wirebench_recording **out, const char *path);
void wirebench_recording_close(struct wirebench_recording *recording);

/* Verifies the recording like `wirebench verify`: reads and decodes all of it and compares the
 * checksums, which takes time in the first of these calls. Damage is a result: is_whole. */
enum wirebench_status wirebench_recording_describe(struct wirebench_recording *recording,
                                                   struct wirebench_recording_info *info);
enum wirebench_status wirebench_recording_stream(struct wirebench_recording *recording, int index,
                                                 struct wirebench_stream *stream);
/* Problem `index` from 0 as a sentence: "mocap stream 1: 12 chunks missing in 2 places". NULL: no
 * such problem, or the recording was not described. */
const char *wirebench_recording_problem(const struct wirebench_recording *recording, int index);

/* A text from the recording's meta data by its key: "specimen" and "rig" (YAML), "start_utc",
 * "operator", "notes", ... NULL: no such key. */
const char *wirebench_recording_meta(const struct wirebench_recording *recording, const char *key);

/* The decoded samples as sent by the instruments, neither tared nor aligned: table "load", "mocap"
 * (a row for each marker of a frame), "stage", "events" or "clock". docs/library.md lists the
 * columns. The first of these calls decodes the recording. WIREBENCH_INCOMPLETE: the table is
 * complete except for missing or damaged parts of the recording. */
enum wirebench_status wirebench_recording_table(struct wirebench_recording *recording,
                                                const char *name,
                                                const struct wirebench_table **table);

/* --- datasets --- */

struct wirebench_dataset;

enum wirebench_kind {
    WIREBENCH_CANTILEVER,
    WIREBENCH_THREE_POINT,
    WIREBENCH_TENSILE
};

enum {
    WIREBENCH_MOST_SHAPE = 4
};

struct wirebench_dataset_info {
    size_t size;
    const char *wire; /* name of the product */
    enum wirebench_kind kind;
    int sample;             /* 0: an average, or a simulation */
    double length;          /* m: free length; span between rollers; gauge length */
    double outer_diameter;  /* m */
    double mass_per_length; /* kg/m; 0: unknown */
    double strand_length;   /* m; 0: a vertical force, no strand */
    double counterweight;   /* kg at the tip */
    double gravity;         /* m/s2; 0: no weight in the data */
    /* Stress-free angle over arc length, rad: theta0(s) = sum_i b_i (s/L)^(i+1). 0 terms:
     * straight */
    int n_natural_shape;
    double natural_shape[WIREBENCH_MOST_SHAPE];
    int is_follower; /* the tip force stays normal to the wire */
    int is_virtual, is_simulation;
    int is_complete; /* no data are missing, and the test was not cut short */
};

/* Reads the folder of a dataset. */
enum wirebench_status wirebench_dataset_read(struct wirebench_dataset **out, const char *folder);

struct wirebench_alignment {
    size_t size;
    /* Paths of a rig and a specimen file (YAML) to be used in place of the recorded ones, where
     * those were wrong; NULL: the recorded ones. */
    const char *rig, *specimen;
    /* Other options of `wirebench align` by name, "row-rate=50"; NULL or NULL-terminated. */
    const char *const *options;
};

/* Makes the dataset of a recording, NAME.wbr or NAME.wbr.zst, in memory, equal to the one that
 * `wirebench align` writes into a folder. `alignment` may be NULL: the defaults.
 * wirebench_warnings() contains the tool's warnings. WIREBENCH_INCOMPLETE: the dataset can be used,
 * but something of the test is missing (gaps, damaged or lost data, a test that was cut short).
 * WIREBENCH_ERR_DATA: no dataset can be made from the recording. */
enum wirebench_status wirebench_dataset_align(struct wirebench_dataset **out,
                                              const char *recording_path,
                                              const struct wirebench_alignment *alignment);
void wirebench_dataset_close(struct wirebench_dataset *dataset);

enum wirebench_status wirebench_dataset_describe(const struct wirebench_dataset *dataset,
                                                 struct wirebench_dataset_info *info);
/* Table "force_deflection" or "shape". docs/library.md lists the columns. */
enum wirebench_status wirebench_dataset_table(const struct wirebench_dataset *dataset,
                                              const char *name,
                                              const struct wirebench_table **table);
/* The whole dataset.json: origin of the data, and corrections with their sizes. */
const char *wirebench_dataset_json(const struct wirebench_dataset *dataset);

/* --- properties of a wire --- */

struct wirebench_properties;

/* One of several elastic-plastic parts in parallel, which have the same strain. */
struct wirebench_part {
    double modulus;      /* Pa */
    double yield_strain; /* 1, ascending; INFINITY: elastic, only the last part */
};

/* A back stress: dX = modulus dep - recovery X dp. */
struct wirebench_back {
    double modulus;  /* C, Pa, above 0 */
    double recovery; /* gamma, 1, at least 0 */
};

enum {
    WIREBENCH_MOST_PARTS = 12,
    WIREBENCH_MOST_BACKS = 3
};

/* The stress-strain law of the homogenised wire, over its outer diameter. */
struct wirebench_law {
    size_t size;
    double outer_diameter;  /* m */
    double mass_per_length; /* kg/m; 0: no weight */
    double poissons_ratio;  /* 1, of the shear stiffness */
    /* Ludwik's law, stress = E e up to sigma_Y, then sigma_Y + K ep^n; if n_parts is 0. */
    double youngs_modulus;       /* E, Pa */
    double yield_stress;         /* sigma_Y, Pa; 0: never yields */
    double strength_coefficient; /* K, Pa; 0: perfectly plastic */
    double hardening_exponent;   /* n, 1 */
    /* Or parallel parts. */
    int n_parts;
    struct wirebench_part parts[WIREBENCH_MOST_PARTS];
    /* Share of kinematic hardening, 0 (isotropic) to 1, which determines yielding on unloading. By
     * default it is the share of the area; with `is_combined`, that of Ludwik's hardening stress in
     * one law, and for parallel parts 1 less beta: after yielding a part hardens isotropically with
     * the tangent modulus beta E_i. */
    double kinematic_share;
    /* Or Chaboche's law, if n_backs or saturation is above 0: E and sigma_Y from above, a yield
     * stress that grows by saturation (1 - exp(-rate p)), and back stresses. */
    double saturation, rate; /* Q, Pa; b, 1 */
    int n_backs;
    int is_combined;
    struct wirebench_back backs[WIREBENCH_MOST_BACKS];
};

/* A value with its interval of 95 % over specimens, and its range over the laws that the data do
 * not exclude. */
struct wirebench_estimate {
    double value, low, high, candidates_low, candidates_high;
};

struct wirebench_properties_info {
    size_t size;
    const char *wire;   /* name of the product; "" if unknown */
    const char *method; /* "cycle", "paper", "three-point"; "" if not calibrated */
    double outer_diameter, mass_per_length; /* m, kg/m */
    double poissons_ratio;
    /* E, sigma_Y, K and n of Ludwik's law; if n_parts is not 0, of the isotropic Ludwik law with
     * the same first loading. Standard uncertainties of E, sigma_Y, ln K and n. */
    double youngs_modulus, yield_stress, strength_coefficient, hardening_exponent;
    double deviation[4];
    int n_parts;
    struct wirebench_part parts[WIREBENCH_MOST_PARTS];
    double kinematic_share;
    double rms;               /* misfit of the calibration, over F_max */
    double largest_curvature; /* 1/m, reached in the tests */
    struct wirebench_estimate rigidity, residual_curvature_ratio; /* EI, N m2; 1 */
    int n_samples;
    int is_rule_supported; /* the data support the hardening rule */
    int is_virtual, is_simulation;
    /* As in wirebench_law. For Chaboche's law from a file, E, sigma_Y, K and n above are those of
     * the isotropic Ludwik law with the same first loading; for a law created by the caller they
     * are its own, with K and n 0. kinematic_share is the share of kinematic hardening, and these
     * are the law's own E and sigma_Y. */
    double saturation, rate;
    int n_backs;
    int is_combined;
    struct wirebench_back backs[WIREBENCH_MOST_BACKS];
    double law_youngs_modulus, law_yield_stress;
    struct wirebench_estimate deflection_springback; /* of a cantilever of the tests' length, 1 */
};

/* Creates properties from a law. */
enum wirebench_status wirebench_properties_create(struct wirebench_properties **out,
                                                  const struct wirebench_law *law);
/* Reads a properties file of `wirebench calibrate`, a wire file, or a shipped wire by its name:
 * "type1". */
enum wirebench_status wirebench_properties_read(struct wirebench_properties **out,
                                                const char *path_or_name);
void wirebench_properties_destroy(struct wirebench_properties *properties);

enum wirebench_status wirebench_properties_describe(const struct wirebench_properties *properties,
                                                    struct wirebench_properties_info *info);
/* The text of calibrated properties as `wirebench calibrate -o` writes it to a file; NULL for
 * others. */
const char *wirebench_properties_text(const struct wirebench_properties *properties);

/* Bending moments (N m) of a first loading at n curvatures (1/m, 0 or more). */
enum wirebench_status wirebench_moments(const struct wirebench_properties *properties, size_t n,
                                        const double *curvature, double *moment);

struct wirebench_bending {
    size_t size;
    double rigidity;                 /* EI of the virgin wire, N m2 */
    double residual_curvature_ratio; /* residual over largest curvature, after bending to the
                                        largest curvature and unloading, 1 */
    double loop_energy; /* J/m lost per cycle: from the largest curvature to straight and back */
};

/* Bending properties of the law up to `largest` (1/m, above 0). */
enum wirebench_status wirebench_bend(const struct wirebench_properties *properties, double largest,
                                     struct wirebench_bending *bending);

/* --- simulated tests --- */

/* Cantilever: clamp at the origin, x along the straight wire, y up; the tip is raised. */
struct wirebench_cantilever {
    size_t size;
    double length;        /* m */
    double strand_length; /* m, of the strand that pulls the tip; 0: a vertical force */
    double counterweight; /* kg at the tip; its weight acts if gravity is not 0 */
    double gravity;       /* m/s2 towards -y; 0: no weight */
    int n_natural_shape;  /* of the stress-free angle, as in wirebench_dataset_info */
    double natural_shape[WIREBENCH_MOST_SHAPE];
    int n_elements; /* 0: 50 */
    /* Shapes: positions at these arc lengths (m, n_positions of them, from 0 to length). */
    size_t n_positions;
    const double *positions;
};

/* Arrays of the caller, each (n) for n deflections, or NULL if not needed. */
struct wirebench_cantilever_result {
    size_t size;
    double *force;       /* N: vertical, less its value at deflection 0 before the first row */
    double *tension;     /* N, of the strand, or vertical; not zeroed */
    double *tip_x;       /* m */
    double *tip_angle;   /* rad */
    double *root_moment; /* N m, at the clamp */
    int *slack;          /* the strand carries no load */
    double *shape_x, *shape_y; /* (n, n_positions), m */
    size_t n_done;             /* set: number of computed rows; later rows are NaN */
};

/* Moves the tip of a virgin wire through n deflections (m), in order. WIREBENCH_INCOMPLETE if the
 * solver does not converge after row n_done. */
enum wirebench_status wirebench_solve_cantilever(const struct wirebench_properties *properties,
                                                 const struct wirebench_cantilever *test, size_t n,
                                                 const double *deflection,
                                                 struct wirebench_cantilever_result *result);

/* Three-point bending: two rollers, and a nose between them that bends the wire downwards. */
struct wirebench_three_point {
    size_t size;
    double span;                       /* m, between the rollers' axes */
    double overhang;                   /* m, beyond each roller; 0: 0.3 span */
    double roller_radius, nose_radius; /* m; 0: a knife edge */
    double friction;                   /* on the rollers, 1 */
    double compliance;                 /* of the machine, m/N */
    int n_elements;                    /* of half the wire; 0: 80 */
};

struct wirebench_three_point_result {
    size_t size;
    double *force;            /* N, of the nose */
    double *travel;           /* m, deflection plus the machine's deformation */
    double *middle_moment;    /* N m */
    double *middle_curvature; /* 1/m */
    int *slack;               /* the nose does not touch the wire */
    size_t n_done;
};

/* The same for deflections of the nose after its first contact with the straight wire. */
enum wirebench_status wirebench_solve_three_point(const struct wirebench_properties *properties,
                                                  const struct wirebench_three_point *test,
                                                  size_t n, const double *deflection,
                                                  struct wirebench_three_point_result *result);

/* --- harnesses --- */

/* A branched harness that is assembled step by step. */
struct wirebench_harness;

struct wirebench_harness_settings {
    size_t size;
    int is_elastic;        /* the same wires without yielding */
    double element_length; /* m, at most; 0: 1/100 of the length of all branches */
};

/* Reads a harness file, or a shipped one by its name, "door"; the harness has its stress-free shape
 * and is held at its root. `settings` may be NULL: the defaults. */
enum wirebench_status wirebench_harness_read(struct wirebench_harness **out,
                                             const char *path_or_name,
                                             const struct wirebench_harness_settings *settings);
void wirebench_harness_destroy(struct wirebench_harness *harness);

enum wirebench_harness_step_kind {
    WIREBENCH_HANG,    /* its weight acts from now on */
    WIREBENCH_MOUNT,   /* an item is held and moved to its place */
    WIREBENCH_MOVE,    /* a mounted item is moved */
    WIREBENCH_RELEASE, /* an item is let go */
    WIREBENCH_TAKE_OFF /* all items and the weight are let go: the last step */
};

struct wirebench_harness_step {
    size_t size;
    enum wirebench_harness_step_kind kind;
    const char *item;    /* root, connector or clip; NULL for the whole harness */
    double position[3];  /* m, where it goes */
    double direction[3]; /* of the wire there; 0, 0, 0: not given */
    double up[3];        /* upwards in its section, of a connector; 0, 0, 0: not given */
};

/* Step `index` from 0 of the harness file; not taken. */
enum wirebench_status wirebench_harness_planned_step(const struct wirebench_harness *harness,
                                                     int index,
                                                     struct wirebench_harness_step *step);

/* Takes a step. WIREBENCH_INCOMPLETE if it finds no equilibrium: the state is then the last one on
 * its way, or before a release. WIREBENCH_ERR_ARGUMENT if the step is not possible, for example
 * because wires are too short; the state is then unchanged. */
enum wirebench_status wirebench_harness_take_step(struct wirebench_harness *harness,
                                                  const struct wirebench_harness_step *step);

/* Undoes the last n steps and restored snapshots, of which 100 are kept, fewer of large harnesses
 * (512 MB). The state is the same, bit for bit. */
enum wirebench_status wirebench_harness_undo(struct wirebench_harness *harness, int n);
/* Keeps the state under a name, and returns to it. */
enum wirebench_status wirebench_harness_snapshot(struct wirebench_harness *harness,
                                                 const char *name);
enum wirebench_status wirebench_harness_restore(struct wirebench_harness *harness,
                                                const char *name);

struct wirebench_harness_info {
    size_t size;
    const char *name, *title;         /* of the file */
    int n_branches, n_items, n_steps; /* of the file */
    int state;                        /* number of steps from the stress-free harness on */
    const char *step;                 /* that led to it, "mount C1"; "": none */
    int is_converged;                 /* it found an equilibrium */
    double fraction;                  /* of the step that was completed */
    int n_snaps;                      /* of the step */
    double elastic;                   /* J, given back when the wires are unloaded elastically */
    double plastic;                   /* J, plastic work from the first step on */
};

enum wirebench_status wirebench_harness_describe(const struct wirebench_harness *harness,
                                                 struct wirebench_harness_info *info);

/* Table "shapes" (places along the branches), "items", "forces" (on mounted items) or "branches"
 * (bend radii) of the current state, valid until it changes. docs/library.md lists the columns. */
enum wirebench_status wirebench_harness_table(struct wirebench_harness *harness, const char *name,
                                              const struct wirebench_table **table);

/* --- calibration --- */

enum wirebench_method {
    WIREBENCH_METHOD_DEFAULT, /* as `wirebench calibrate` without --method */
    WIREBENCH_METHOD_CYCLE,   /* a law and its hardening rule, from loading and unloading */
    WIREBENCH_METHOD_PAPER    /* E, sigma_Y, K and n, from the averaged first loading */
};

struct wirebench_calibration {
    size_t size;
    enum wirebench_method method;
    int threads; /* 0: number of processors */
    /* Options of `wirebench calibrate` by name, "data-step-mm=2"; NULL or NULL-terminated. */
    const char *const *options;
    /* Called repeatedly, not always by the calling thread, one call at a time; returning 0 stops.
     * `all` is 0 if unknown. NULL: none. */
    int (*progress)(void *context, int done, int all);
    void *context;
};

/* Calibrates on n datasets of one wire. `calibration` may be NULL: the defaults. Datasets of
 * three-point bending have their own method. A dataset whose test was excluded from its series is
 * rejected (WIREBENCH_ERR_DATA); the message says by whom and why. wirebench_warnings() contains
 * the remarks on data and result. WIREBENCH_INCOMPLETE: the data do not support the hardening rule,
 * a search did not converge, or progress stopped it; the properties are valid. */
enum wirebench_status wirebench_calibrate(struct wirebench_properties **out,
                                          const struct wirebench_dataset *const *datasets, size_t n,
                                          const struct wirebench_calibration *calibration);

#ifdef __cplusplus
}
#endif

#endif
