/* Recomputes the constants of fixtures/virtual/wires.yaml and prints them: run by hand after
 * changes of the beam or of the wires' paper properties. Usage: tune_wires [WIRE...]
 *
 * Two numbers per wire, the second law's yield stress and the hardening modulus, are fitted to the
 * force-deflection curve of the wire's homogenised properties; the others are chosen here.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <gsl/gsl_multimin.h>

#include "base/file.h"
#include "base/units.h"
#include "fe/trial/cantilever.h"
#include "fixtures/virtual/composite.h"

#define WB_LOG_DOMAIN "tune"

enum {
    POINTS = 104
};

/* Chosen values: see fixtures/virtual/wires.yaml. Yield stresses are relative to the core's stress
 * at the yield moment of the homogenised wire. */
static const double jacket_modulus = 25.0 * WB_MPA;
static const double stiffness = 1.12;
static const double shares[] = {0.40, 0.48, 0.12};
static const double first_yield = 0.35, last_yield = 4.0;
static const double length = 85.0 * WB_MM, reach = 52.0 * WB_MM;

struct fit {
    struct wb_wire wire;
    double target[POINTS + 1];
};

static int curve(const struct wb_wire *wire, const struct wb_section *section, double *force)
{
    struct wb_cantilever_model model;
    struct wb_cantilever *cantilever;
    struct wb_cantilever_point point;
    wb_cantilever_default_model(&model);
    model.section = section;
    model.length = length;
    model.n_elements = 24;
    model.strand_length = 760.0 * WB_MM;
    model.counterweight = 2.7 * WB_G;
    model.mass_per_length = wb_wire_mass_per_length(wire);
    if (wb_cantilever_create(&cantilever, &model, NULL) != WB_OK)
        return -1;
    double zero = 0.0;
    int failed = 0;
    for (int i = 0; i <= POINTS && !failed; i++) {
        failed = wb_cantilever_move(cantilever, WB_CONTROL_DEFLECTION, reach * i / POINTS,
                                    &point) != WB_OK ||
                 point.end != WB_CANTILEVER_CONVERGED;
        if (i == 0)
            zero = point.vertical_force;
        force[i] = point.vertical_force - zero;
    }
    wb_cantilever_destroy(cantilever);
    return failed;
}

static void compose(const struct wb_wire *wire, double second_yield, double hardening,
                    struct wb_composite *composite)
{
    const double core = pow(wire->conductor_diameter / wire->outer_diameter, 4.0);
    const double yield =
        wire->material.yield_stress / core * wire->conductor_diameter / wire->outer_diameter;
    const double yields[] = {first_yield, second_yield, last_yield};
    *composite = (struct wb_composite){
        .jacket_modulus = jacket_modulus,
        .jacket_poisson = 0.45,
        .core_modulus =
            stiffness * (wire->material.youngs_modulus - jacket_modulus * (1.0 - core)) / core,
        .core_poisson = 0.34,
        .n_laws = 3,
    };
    for (int i = 0; i < composite->n_laws; i++)
        composite->laws[i] = (struct wb_composite_law){
            .area_fraction = shares[i],
            .yield_stress = yields[i] * yield,
            .hardening = hardening * composite->core_modulus,
        };
}

/* RMS distance of the two curves over the largest force. */
static double distance(const gsl_vector *x, void *context)
{
    const struct fit *const fit = context;
    struct wb_composite composite;
    struct wb_section section;
    double force[POINTS + 1], sum = 0.0;
    compose(&fit->wire, exp(gsl_vector_get(x, 0)), exp(gsl_vector_get(x, 1)), &composite);
    if (wb_composite_build_variant(&composite, WB_COMPOSITE_KINEMATIC, &fit->wire, 1.0, 1.0, 12,
                                   NULL, &section) != WB_OK)
        return 1e3;
    const int failed = curve(&fit->wire, &section, force);
    wb_section_release(&section);
    if (failed)
        return 1e3;
    for (int i = 0; i <= POINTS; i++)
        sum += (force[i] - fit->target[i]) * (force[i] - fit->target[i]);
    return sqrt(sum / (POINTS + 1)) / fit->target[POINTS];
}

static void print(const struct wb_composite *composite, const char *name, double rms)
{
    printf("  %s:    # RMS %.2f %% of F_max\n"
           "    jacket_modulus_MPa: %.4g\n    jacket_poisson: %.4g\n"
           "    core_modulus_MPa: %.4g\n    core_poisson: %.4g\n    core_laws:\n",
           name, rms / WB_PERCENT, composite->jacket_modulus / WB_MPA, composite->jacket_poisson,
           composite->core_modulus / WB_MPA, composite->core_poisson);
    for (int i = 0; i < composite->n_laws; i++)
        printf("      - {area_percent: %.4g, yield_stress_MPa: %.4g, hardening_MPa: %.4g}\n",
               composite->laws[i].area_fraction / WB_PERCENT,
               composite->laws[i].yield_stress / WB_MPA, composite->laws[i].hardening / WB_MPA);
}

static int tune(const char *name)
{
    char path[WB_PATH];
    struct fit fit;
    struct wb_section section;
    if (wb_file_find_fixture(path, "wires", name, NULL) != WB_OK ||
        wb_wire_read(path, &fit.wire, NULL) != WB_OK ||
        wb_section_init_circle(&section, fit.wire.outer_diameter, &fit.wire.material, 40) != WB_OK)
        return 1;
    const int failed = curve(&fit.wire, &section, fit.target);
    wb_section_release(&section);
    if (failed)
        return 1;

    gsl_vector *const x = gsl_vector_alloc(2), *const step = gsl_vector_alloc(2);
    gsl_multimin_fminimizer *const search =
        gsl_multimin_fminimizer_alloc(gsl_multimin_fminimizer_nmsimplex2, 2);
    gsl_multimin_function function = {.f = distance, .n = 2, .params = &fit};
    gsl_vector_set(x, 0, 0.0);
    gsl_vector_set(x, 1, -2.0);
    gsl_vector_set_all(step, 0.3);
    gsl_multimin_fminimizer_set(search, &function, x, step);
    for (int i = 0; i < 200; i++)
        if (gsl_multimin_fminimizer_iterate(search) != 0 ||
            gsl_multimin_test_size(gsl_multimin_fminimizer_size(search), 1e-5) == 0)
            break;
    struct wb_composite composite;
    compose(&fit.wire, exp(gsl_vector_get(search->x, 0)), exp(gsl_vector_get(search->x, 1)),
            &composite);
    print(&composite, name, search->fval);
    gsl_multimin_fminimizer_free(search);
    gsl_vector_free(x);
    gsl_vector_free(step);
    return 0;
}

int main(int argc, char **argv)
{
    static const char *const all[] = {"type1", "type2", "type3"};
    int failed = 0;
    for (int i = 1; i < argc; i++)
        failed |= tune(argv[i]);
    for (int i = 0; argc < 2 && i < 3; i++)
        failed |= tune(all[i]);
    return failed;
}
