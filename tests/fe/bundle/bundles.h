/* Bundles of type 3 for the tests of explicit bundles: model files in a folder of the test. */
#ifndef WB_TESTS_FE_BUNDLE_BUNDLES_H
#define WB_TESTS_FE_BUNDLE_BUNDLES_H

#include <stdlib.h>

#include "fe/bundle/bundle_run.h"
#include "fe/trial/loading_steps.h"
#include "tests/fe/rod/wires.h"
#include "tests/own_folder.h"

static struct wb_bundle_model model;
static struct wb_bundle_result result;

static inline int release(void **state)
{
    (void)state;
    wb_bundle_result_release(&result);
    return 0;
}

/* A bundle of type 3, 114 mm long, plus further lines of its file. */
static inline void read_model(const char *lines)
{
    char path[64];
    snprintf(path, sizeof path, "%s/bundle.yaml", folder);
    FILE *out = fopen(path, "w");
    assert_non_null(out);
    fprintf(out,
            "name: test\nlength_mm: 114\n"
            "interface: {cohesive_stiffness_N_mm3: 30, friction: 0.4}\n"
            "meshes:\n"
            "  - {name: twelve, core_quads: 2, rings: 1, elements_along: 15}\n"
            "  - {name: four, core_quads: 2, rings: 0, elements_along: 15}\n"
            "%s",
            lines);
    assert_int_equal(fclose(out), 0);
    assert_int_equal(wb_bundle_model_read(&model, path), WB_OK);
}

static inline void run_model(const struct wb_bundle_observer *observer)
{
    const struct wb_bundle_run_options options = {.observer = observer};
    wb_bundle_result_release(&result);
    assert_int_equal(wb_bundle_result_init(&result, &model, 21), WB_OK);
    assert_int_equal(wb_bundle_run(&result, &model, &options), WB_OK);
}

#define ONE "wires: [{wire: type3}]\npacking: hexagon\n"
#define SEVEN "wires: [{wire: type3, count: 7}]\npacking: hexagon\ntape: tape\n"
#define RUN(more) "run: {mesh: twelve, selective_mass_scaling: 100, " more "}\n"

/* The 1D beam of one wire, without weight. */
static inline struct wb_cantilever_model bundle_beam(const struct test_wire *wire,
                                                     const struct wb_section *section)
{
    struct wb_cantilever_model beam;
    wb_cantilever_default_model(&beam);
    beam.section = section;
    beam.length = 0.114;
    beam.mass_per_length = test_wire_mass(wire);
    beam.gravity_y = 0.0;
    return beam;
}

/* Checks that the external work is the area under the rows' forces. */
static inline void check_work(const struct wb_bundle_result *h)
{
    double work = 0.0;
    for (int i = 1; i < h->n_rows; i++)
        work += 0.5 * (h->rows[i].vertical_force + h->rows[i - 1].vertical_force) *
                (h->rows[i].deflection - h->rows[i - 1].deflection);
    assert_close_relative(work, h->rows[h->n_rows - 1].energies.external, 0.01);
}

#endif
