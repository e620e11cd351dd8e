/* Wire models computed as solids, for the tests of fe/trial/wire3d.h. */
#ifndef WB_TESTS_FE_TRIAL_COMPUTED_WIRES_H
#define WB_TESTS_FE_TRIAL_COMPUTED_WIRES_H

#include <stdlib.h>

#include "base/file.h"
#include "fe/trial/wire3d.h"
#include "tests/check.h"

/* A wire model, computed. */
struct computed {
    struct wb_wire_model model;
    struct wb_wire3d *wire;
    struct wb_wire_run run;
};

static const struct wb_material type3 = {
    .hardening = WB_HARDENING_ISOTROPIC_POWER,
    .youngs_modulus = 4528e6,
    .poissons_ratio = 0.39,
    .yield_stress = 4.52e6,
    .strength_coefficient = 1327e6,
    .hardening_exponent = 0.90,
};

static const struct wb_material soft = {
    .hardening = WB_HARDENING_NONE_ELASTIC,
    .youngs_modulus = 1e9,
    .poissons_ratio = 0.3,
};

static inline double flexural_rigidity(double youngs_modulus, double diameter)
{
    return youngs_modulus * M_PI * pow(diameter, 4.0) / 64.0;
}

static inline struct computed *begin(void)
{
    struct computed *c = calloc(1, sizeof *c);
    assert_non_null(c);
    return c;
}

static inline struct computed *begin_from_file(const char *name)
{
    struct computed *c = begin();
    char path[WB_PATH];

    assert_int_equal(wb_file_find_fixture(path, "models", name, NULL), WB_OK);
    assert_int_equal(wb_wire_model_read(&c->model, path), WB_OK);
    return c;
}

/* One part of one material; the caller adds the steps. */
static inline struct computed *begin_rod(double length, double diameter,
                                         struct wb_material material, int elements_along)
{
    struct computed *c = begin();
    c->model.length = length;
    c->model.n_parts = 1;
    c->model.part[0].outer_diameter = diameter;
    c->model.part[0].material = material;
    c->model.elements_along = elements_along;
    c->model.section_density = 1;
    c->model.wire.outer_diameter = diameter;
    return c;
}

static inline void compute(struct computed *c, const struct wb_wire_observer *observer)
{
    assert_int_equal(wb_wire3d_create(&c->wire, &c->model), WB_OK);
    assert_int_equal(wb_wire_run_init(&c->run, &c->model, 7), WB_OK);
    assert_int_equal(wb_wire3d_run(c->wire, &c->run, observer), WB_OK);
}

static inline const struct wb_wire_row *last_row(const struct computed *c)
{
    return &c->run.rows[c->run.n_rows - 1];
}

static inline void end(struct computed *c)
{
    wb_wire_run_release(&c->run);
    wb_wire3d_destroy(c->wire);
    free(c);
}

#endif
