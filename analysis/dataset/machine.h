/* A testing machine and how the specimen lies in it, as its YAML file describes them.
 *
 *     name: bench of two rollers and a nose
 *     kind: three-point            # cantilever, three-point, tensile
 *     span_mm: 12.8                # between the axes of the rollers
 *     roller_radius_mm: 2
 *     nose_radius_mm: [4, 5]       # a band: somewhere between; a number: known
 *     friction: [0, 0.6]           # between wire and rollers, and wire and nose; optional
 *     compliance_mm_N: 0.002       # of the machine, its cell and its rollers; optional
 *
 *     kind: tensile
 *     gauge_length_mm: 50          # length over which the elongation is measured
 *     elongation: crosshead        # or extensometer: the specimen's own
 *
 *     kind: cantilever             # pressed or pulled at its tip across its axis
 *     bends: up                    # or sideways, down: where the tip goes
 *     speed_mm_s: 1                # of the machine, where its file has no time; optional in all
 *
 * A key of another kind is refused. What is not known is left out.
 */
#ifndef WB_ANALYSIS_DATASET_MACHINE_H
#define WB_ANALYSIS_DATASET_MACHINE_H

#include <stdbool.h>

#include "base/config.h"
#include "base/json.h"
#include "base/reason.h"

/* What a test did to its specimen. Datasets that say nothing of it are of cantilevers. */
enum wb_test_kind {
    WB_TEST_CANTILEVER,
    WB_TEST_THREE_POINT,
    WB_TEST_TENSILE,
    WB_TEST_KINDS
};

/* "cantilever", "three-point", "tensile". */
const char *wb_machine_kind_name(enum wb_test_kind kind);

/* Finds the kind of that name; false when there is none. */
bool wb_machine_kind_find(const char *name, enum wb_test_kind *kind);

/* Finds a name in a list that ends in NULL; false when it is not there. */
bool wb_machine_find_name(const char *const *names, const char *name, int *index);

/* A number that is known, or only known to lie in a band, or not known at all. */
struct wb_band {
    bool known;         /* false: the three are NaN */
    double value;       /* the middle of a band */
    double least, most; /* both `value` where it is given as one number */
};

enum wb_machine_direction {
    WB_BENDS_UP,
    WB_BENDS_SIDEWAYS,
    WB_BENDS_DOWN
};

struct wb_machine {
    char name[96];
    enum wb_test_kind kind;
    struct wb_band compliance; /* m/N of travel over force: the machine gives way so much; not
                                  known: taken as nought, and to be said so */
    struct wb_band speed;      /* m/s of the travel */
    /* Three-point bending. */
    double span;                /* m, between the axes of the rollers */
    double roller_radius;       /* m */
    struct wb_band nose_radius; /* m */
    struct wb_band friction;    /* coefficient, 1 */
    /* Tensile. */
    double gauge_length; /* m */
    bool own_elongation; /* measured on the specimen; else the travel of the crosshead, which also
                            holds what grips and machine give: no Young's modulus follows from it */
    /* Cantilever. */
    enum wb_machine_direction bends;
};

/* Reads a machine file. Errors name file, line and key; they go to `why`, or to the log where that
 * is NULL. */
WB_MUST_CHECK enum wb_status wb_machine_read(const char *path, struct wb_machine *machine,
                                             struct wb_reason *why);

/* Reads a number, or a list of the least and the most that it may be, as the key says; its target
 * is not used. */
WB_MUST_CHECK enum wb_status wb_machine_read_band(const struct wb_config_node *node,
                                                  const struct wb_config_key *key,
                                                  struct wb_band *band);

/* Sets the members of a machine in an object, those of its kind, under the keys of the file; a band
 * as a list of two numbers. */
void wb_machine_set_json(const struct wb_machine *machine, struct wb_json *object);

/* Reads what wb_machine_set_json() wrote. WB_ERR_FORMAT when something is missing or out of range;
 * `path` stands for the document in the message. */
WB_MUST_CHECK enum wb_status wb_machine_get_json(struct wb_machine *machine,
                                                 const struct wb_json *object, const char *path,
                                                 struct wb_reason *why);

#endif
