/* The specimen of a testing machine, as its YAML file describes it.
 *
 *     wire: 30 AWG insulated       # name of the product
 *     outer_diameter_mm: 0.8       # of the wire; where it is left out, `wire` is a name in
 *                                  # fixtures/wires or a path, and the rest is taken from there
 *     sample: 1
 *     series: 1b                   # optional: specimens that were made or tested together
 *     length_mm: 30                # optional; of a cantilever it is required: the free length
 *     mass_per_length_g_m: 2.1     # optional
 *     usable_travel_mm: 4          # optional: what comes later serves no fit; or a band [4, 10]
 *     natural_bow_mm: 0.2          # optional, three-point: how far the middle lies below the
 * places on # the rollers before the test; or a band [-0.3, 0.3]
 *
 * Of a tensile test, what was pulled and the area that carries the load, as one of
 *
 *     constituent: conductor       # or jacket, tape
 *     area_mm2: 0.326
 *     strands: 60                  # of a stranded conductor: the area is the metal's
 *     strand_diameter_mm: 0.08
 *     inner_diameter_mm: 0.8       # of a jacket: with the outer one
 *     width_mm: 12                 # of a tape
 *     thickness_mm: 0.1
 *
 * The specimen file of a bench test serves as well: what it says of markers is left aside.
 */
#ifndef WB_ANALYSIS_DATASET_TEST_PIECE_H
#define WB_ANALYSIS_DATASET_TEST_PIECE_H

#include "analysis/dataset/machine.h"
#include "base/json.h"
#include "base/reason.h"

enum wb_constituent {
    WB_CONDUCTOR,
    WB_JACKET,
    WB_TAPE
};

/* "conductor", "jacket", "tape". */
const char *wb_test_piece_constituent_name(enum wb_constituent constituent);

struct wb_test_piece {
    char wire[64];
    int sample;
    char series[32];              /* "": none named */
    double outer_diameter;        /* m; NaN: not known, of a tensile test */
    double length;                /* m, of the whole piece, cantilever: free; NaN not known */
    double mass_per_length;       /* kg/m; 0 not known */
    double poissons_ratio;        /* of the wire's file; 0 not known */
    struct wb_band usable_travel; /* m */
    struct wb_band natural_bow;   /* m */
    enum wb_constituent constituent;
    double area; /* m2 that carries the load of a tensile test; NaN: not one */
};

/* Reads the file of a specimen for a test of that kind. Errors name file, line and key; they go to
 * `why`, or to the log where that is NULL. */
WB_MUST_CHECK enum wb_status wb_test_piece_read(const char *path, enum wb_test_kind kind,
                                                struct wb_test_piece *piece, struct wb_reason *why);

/* Sets what is known of it besides wire and sample as members of an object; reads them back into a
 * cleared piece, whose wire and sample stay empty. `path` stands for the document in messages. */
void wb_test_piece_set_json(const struct wb_test_piece *piece, struct wb_json *object);
WB_MUST_CHECK enum wb_status wb_test_piece_get_json(struct wb_test_piece *piece,
                                                    const struct wb_json *object, const char *path,
                                                    struct wb_reason *why);

#endif
