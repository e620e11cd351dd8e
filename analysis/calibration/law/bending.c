#include "analysis/calibration/law/bending.h"

#include <math.h>
#include <stdlib.h>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <gsl/gsl_vector.h>

#include "base/memory.h"
#include "fe/rod/fibres.h"
#include "fe/rod/section.h"

enum {
    STRIPS = 100,
    LOOP_STEPS = 200, /* from straight to bent */
    CANTILEVER_SECTIONS = 24,
    EQUIVALENT_POINTS = 40,
    EQUIVALENT_FREE = 4
};

/* Smallest curvature for the Ludwik equivalent, as part of the largest. */
static const double first_of_equivalent = 0.01;
/* Residual of parameters that are not a valid law: far above any other. */
static const double lost_residual = 1e3;
/* Limits of the equivalent's exponent. */
static const double least_exponent = 1e-3, largest_exponent = 1.5;
/* Smallest yield strain of the equivalent, as part of the outer fibre's strain at the first
 * curvature: for a wire that yields from the start the best one would be zero. */
static const double least_yield_strain = 0.1;

/* A section point and its history. */
struct point {
    struct wb_section section;
    struct wb_fibres *fibres;
    double *before, *after;
    size_t size;
    double rate;      /* 1/(m s), of the curvature */
    double curvature; /* 1/m, of the last stored state */
};

static enum wb_status make_point(struct point *p, const struct wb_law *law, double diameter)
{
    *p = (struct point){.before = NULL};
    WB_TRY(wb_section_init_law(&p->section, diameter, law, STRIPS));
    const enum wb_status status = wb_fibres_create(&p->fibres, &p->section);
    if (status == WB_OK) {
        p->size = wb_fibres_history_size(p->fibres);
        p->before = wb_memory_new(p->size, sizeof *p->before);
        p->after = wb_memory_new(p->size, sizeof *p->after);
        p->rate = law->strain_rate / (0.5 * diameter);
    }
    return status;
}

static void release_point(struct point *p)
{
    wb_fibres_destroy(p->fibres);
    wb_section_release(&p->section);
    free(p->before);
    free(p->after);
}

/* Moment at a curvature, starting from the last stored state. */
static double moment_at(struct point *p, double curvature)
{
    struct wb_fibres_response r;
    const double change = fabs(curvature - p->curvature);
    wb_fibres_set_duration(p->fibres, change > 0.0 ? change / p->rate : 0.0);
    wb_fibres_respond(p->fibres, 0.0, curvature, p->before, p->after, &r);
    return r.M;
}

static double keep_moment(struct point *p, double curvature)
{
    const double M = moment_at(p, curvature);
    double *const old = p->before;
    p->before = p->after;
    p->after = old;
    p->curvature = curvature;
    return M;
}

/* Curvature at which the moment is zero on unloading from the largest curvature. */
static double residual_curvature(struct point *p, double largest)
{
    double low = 0.0, high = largest;
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if (moment_at(p, middle) > 0.0)
            high = middle;
        else
            low = middle;
    }
    return 0.5 * (low + high);
}

/* Work over a range of curvature in equal steps, by the trapezoidal rule. */
static double work_of(struct point *p, double from, double to, double *M)
{
    double work = 0.0;
    for (int i = 1; i <= LOOP_STEPS; i++) {
        const double next = keep_moment(p, from + (to - from) * i / LOOP_STEPS);
        work += 0.5 * (*M + next) * (to - from) / LOOP_STEPS;
        *M = next;
    }
    return work;
}

enum wb_status wb_bending_describe(const struct wb_law *law, double diameter, double largest,
                                   struct wb_bending *bending)
{
    struct point p;
    const enum wb_status status = make_point(&p, law, diameter);
    if (status == WB_OK) {
        double modulus = law->material.youngs_modulus;
        for (int i = 0; i < law->n_maxwell && law->strain_rate > 0.0; i++)
            modulus += law->maxwell[i].modulus;
        bending->flexural_rigidity =
            wb_fibres_bending_stiffness(p.fibres) * modulus / law->material.youngs_modulus;
        double M = keep_moment(&p, largest);
        bending->residual_curvature_ratio = residual_curvature(&p, largest) / largest;
        bending->loop_energy = work_of(&p, largest, 0.0, &M);
        bending->loop_energy += work_of(&p, 0.0, largest, &M);
    }
    release_point(&p);
    return status;
}

enum wb_status wb_bending_moments(const struct wb_law *law, double diameter, int n,
                                  const double *curvature, double *moment)
{
    struct point p;
    const enum wb_status status = make_point(&p, law, diameter);
    for (int i = 0; i < n && status == WB_OK; i++)
        moment[i] = moment_at(&p, curvature[i]);
    release_point(&p);
    return status;
}

enum wb_status wb_bending_stiffness(const struct wb_law *law, double diameter, double largest,
                                    int n, const double *curvature, double *secant, int m,
                                    const double *change, double *unloading)
{
    struct point p;
    const enum wb_status status = make_point(&p, law, diameter);
    for (int i = 0; i < n && status == WB_OK; i++)
        secant[i] = moment_at(&p, curvature[i]) / curvature[i];
    const double top = status == WB_OK ? keep_moment(&p, largest) : 0.0;
    for (int i = 0; i < m && status == WB_OK; i++)
        unloading[i] = (top - moment_at(&p, largest - change[i])) / change[i];
    release_point(&p);
    return status;
}

/* --- the cantilever --- */

/* Sections of a cantilever from its free end to the clamp, in equal steps of the loaded curvature:
 * the curvature that remains, the moment, and its complementary energy, the integral of the
 * curvature over the moment (N). */
struct cantilever {
    double loaded[CANTILEVER_SECTIONS + 1], residual[CANTILEVER_SECTIONS + 1]; /* 1/m */
    double moment[CANTILEVER_SECTIONS + 1], energy[CANTILEVER_SECTIONS + 1];
};

static void load_sections(struct point *p, double largest, struct cantilever *c)
{
    *c = (struct cantilever){.loaded[0] = 0.0};
    for (int i = 1; i <= CANTILEVER_SECTIONS; i++) {
        c->loaded[i] = largest * i / CANTILEVER_SECTIONS;
        c->moment[i] = keep_moment(p, c->loaded[i]);
        c->residual[i] = residual_curvature(p, c->loaded[i]);
        c->energy[i] = c->energy[i - 1] +
                       0.5 * (c->loaded[i] + c->loaded[i - 1]) * (c->moment[i] - c->moment[i - 1]);
    }
}

/* Length of the cantilever with a force at its end, and the deflections of its end, loaded and
 * unloaded. The angle theta of a section has F sin(theta) = C(M_clamp) - C(M), with the
 * complementary energy C. */
static double integrate(const struct cantilever *c, double force, double *loaded, double *unloaded)
{
    double length = 0.0, remaining = 0.0; /* angle that remains */
    *loaded = *unloaded = 0.0;
    for (int i = CANTILEVER_SECTIONS; i > 0; i--) {
        const double middle = 0.5 * (c->loaded[i] + c->loaded[i - 1]);
        const double step = c->moment[i] - c->moment[i - 1];
        const double energy = c->energy[i - 1] + 0.25 * (c->loaded[i - 1] + middle) * step;
        const double sine = (c->energy[CANTILEVER_SECTIONS] - energy) / force;
        const double ds = step / (force * sqrt(1.0 - sine * sine));
        const double turn = 0.5 * (c->residual[i] + c->residual[i - 1]) * ds;
        length += ds;
        *loaded += sine * ds;
        *unloaded += sin(remaining + 0.5 * turn) * ds;
        remaining += turn;
    }
    return length;
}

enum wb_status wb_bending_springback(const struct wb_law *law, double diameter, double length,
                                     double largest, double *springback)
{
    struct point p;
    struct cantilever c;
    const enum wb_status status = make_point(&p, law, diameter);
    if (status == WB_OK) {
        load_sections(&p, largest, &c);
        /* The length decreases with the force, which is above C(M_clamp): the end is not vertical.
         */
        double low = c.energy[CANTILEVER_SECTIONS], high = 2.0 * low, loaded, unloaded;
        while (integrate(&c, high, &loaded, &unloaded) > length)
            high *= 2.0;
        for (int i = 0; i < 60; i++) {
            const double middle = 0.5 * (low + high);
            if (integrate(&c, middle, &loaded, &unloaded) > length)
                low = middle;
            else
                high = middle;
        }
        *springback = 1.0 - unloaded / loaded;
    }
    release_point(&p);
    return status;
}

/* --- the equivalent of Ludwik's form --- */

struct wb_material wb_bending_material(double youngs_modulus, double poissons_ratio,
                                       double yield_stress, double hardening_stress,
                                       double exponent)
{
    return (struct wb_material){
        .hardening = WB_HARDENING_ISOTROPIC_POWER,
        .youngs_modulus = youngs_modulus,
        .poissons_ratio = poissons_ratio,
        .yield_stress = yield_stress,
        .strength_coefficient = hardening_stress / pow(WB_BENDING_PLASTIC_STRAIN, exponent),
        .hardening_exponent = exponent,
    };
}

struct equivalent {
    double diameter, poissons_ratio;
    double least_strain; /* of yield */
    double curvature[EQUIVALENT_POINTS], moment[EQUIVALENT_POINTS];
    struct wb_material material;
    enum wb_status status;
};

static int equivalent_residuals(const gsl_vector *x, void *context, gsl_vector *f)
{
    struct equivalent *const e = context;
    double M[EQUIVALENT_POINTS];
    struct wb_reason why;
    struct wb_law law;
    const double n =
        least_exponent + (largest_exponent - least_exponent) / (1.0 + exp(-gsl_vector_get(x, 3)));
    const double E = exp(gsl_vector_get(x, 0));
    const double yield = E * (e->least_strain + exp(gsl_vector_get(x, 1)));
    e->material = wb_bending_material(E, e->poissons_ratio, yield, exp(gsl_vector_get(x, 2)), n);
    wb_law_init_ludwik(&law, &e->material);
    if (wb_law_check(&law, &why) != WB_OK) {
        gsl_vector_set_all(f, lost_residual);
        return GSL_SUCCESS;
    }
    e->status = wb_bending_moments(&law, e->diameter, EQUIVALENT_POINTS, e->curvature, M);
    if (e->status != WB_OK)
        return GSL_EFAILED;
    for (size_t i = 0; i < EQUIVALENT_POINTS; i++)
        gsl_vector_set(f, i, log(M[i] / e->moment[i]));
    return GSL_SUCCESS;
}

static enum wb_status find_equivalent(struct equivalent *e, const struct wb_law *law,
                                      double *misfit)
{
    gsl_multifit_nlinear_parameters parameters = gsl_multifit_nlinear_default_parameters();
    /* K and n are so strongly correlated that the error of one-sided differences would matter. */
    parameters.fdtype = GSL_MULTIFIT_NLINEAR_CTRDIFF;
    parameters.h_df = 1e-4;
    gsl_multifit_nlinear_workspace *const w = wb_memory_need(gsl_multifit_nlinear_alloc(
        gsl_multifit_nlinear_trust, &parameters, EQUIVALENT_POINTS, EQUIVALENT_FREE));
    gsl_multifit_nlinear_fdf fdf = {
        .f = equivalent_residuals, .n = EQUIVALENT_POINTS, .p = EQUIVALENT_FREE, .params = e};
    /* Initial guess: the stiffness of a small bend, and yield where a first loading has lost a
     * tenth of it. */
    const double R = 0.5 * e->diameter;
    const double E = law->material.youngs_modulus;
    int yields = 0;
    while (yields < EQUIVALENT_POINTS - 1 &&
           e->moment[yields] / e->curvature[yields] > 0.9 * e->moment[0] / e->curvature[0])
        yields++;
    const double last_strain = R * e->curvature[EQUIVALENT_POINTS - 1];
    double start[EQUIVALENT_FREE] = {
        log(E), log(R * e->curvature[yields] - e->least_strain),
        log(fmax(wb_law_virgin_stress(law, 0.3 * last_strain, NULL), 1e-3 * E * last_strain)), 0.3};
    const gsl_vector_view x = gsl_vector_view_array(start, EQUIVALENT_FREE);
    int info = 0;
    int code = gsl_multifit_nlinear_init(&x.vector, &fdf, w);
    if (code == GSL_SUCCESS)
        code = gsl_multifit_nlinear_driver(200, 1e-7, 1e-15, 0.0, NULL, NULL, &info, w);
    if (e->status == WB_OK) {
        /* The last evaluation is not necessarily that of the best point. */
        (void)equivalent_residuals(w->x, e, w->f);
        double sum = 0.0;
        for (size_t i = 0; i < EQUIVALENT_POINTS; i++)
            sum += gsl_vector_get(w->f, i) * gsl_vector_get(w->f, i);
        *misfit = sqrt(sum / EQUIVALENT_POINTS);
    }
    gsl_multifit_nlinear_free(w);
    return e->status;
}

static void choose_curvatures(double largest, double curvature[EQUIVALENT_POINTS])
{
    for (int i = 0; i < EQUIVALENT_POINTS; i++)
        curvature[i] =
            largest * pow(first_of_equivalent, 1.0 - (double)i / (EQUIVALENT_POINTS - 1));
}

enum wb_status wb_bending_ludwik(const struct wb_law *law, double diameter, double largest,
                                 struct wb_material *equivalent, double *misfit)
{
    struct equivalent e = {
        .diameter = diameter, .poissons_ratio = law->material.poissons_ratio, .status = WB_OK};
    choose_curvatures(largest, e.curvature);
    e.least_strain = least_yield_strain * 0.5 * diameter * e.curvature[0];
    WB_TRY(wb_bending_moments(law, diameter, EQUIVALENT_POINTS, e.curvature, e.moment));
    WB_TRY(find_equivalent(&e, law, misfit));
    *equivalent = e.material;
    return WB_OK;
}

enum wb_status wb_bending_compare(const struct wb_law *law, const struct wb_material *material,
                                  double diameter, double largest, double *difference)
{
    double curvature[EQUIVALENT_POINTS], moment[EQUIVALENT_POINTS], other[EQUIVALENT_POINTS];
    struct wb_law ludwik;
    wb_law_init_ludwik(&ludwik, material);
    choose_curvatures(largest, curvature);
    WB_TRY(wb_bending_moments(law, diameter, EQUIVALENT_POINTS, curvature, moment));
    WB_TRY(wb_bending_moments(&ludwik, diameter, EQUIVALENT_POINTS, curvature, other));
    *difference = 0.0;
    for (int i = 0; i < EQUIVALENT_POINTS; i++)
        *difference = fmax(*difference, fabs(other[i] / moment[i] - 1.0));
    return WB_OK;
}
