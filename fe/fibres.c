#include "fe/fibres.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fe/hardening.h"

#define WB_LOG_DOMAIN "fibres"

enum {
    LANES = 8,        /* fibres of a material are padded to a multiple of this */
    HISTORY_HEAD = 8, /* the first double says whether the point ever yielded; rest is padding */
    HISTORY_ROWS = 3  /* plastic strain, accumulated plastic strain, yield or back stress */
};

/* See fe/material.c. */
static const double on_surface = 1e-12;

/* Fibres of one material, contiguous and padded with fibres without area. */
struct batch {
    int material;
    int begin, end; /* padded indices */
};

struct wb_fibres {
    int n;           /* padded number of fibres */
    int n_materials; /* of the section, as batches */
    struct batch *batches;
    double *y, *area; /* (n) */
    struct wb_material *materials;
    struct wb_hardening_table *tables; /* (n_materials) */
    double *virgin;                    /* history rows of a virgin point */
    double outermost;                  /* largest |y|, m */
    double yield_strain;               /* no fibre yields below this strain, 1 */
    double EA, ES, EI;                 /* elastic N = EA eps + ES kappa, M = ES eps + EI kappa */
    double shear_ratio;                /* the section's shear stiffness over the fibres' sum */
    double shear_stiffness;
    bool reference;
};

static int padded(int n)
{
    return (n + LANES - 1) / LANES * LANES;
}

static void sort_fibres(struct wb_fibres *f, const struct wb_section *section)
{
    int next = 0;
    for (int m = 0; m < section->n_materials; m++) {
        f->batches[m].material = m;
        f->batches[m].begin = next;
        for (int i = 0; i < section->n_fibres; i++) {
            if (section->fibres[i].material != m)
                continue;
            f->y[next] = section->fibres[i].y;
            f->area[next] = section->fibres[i].area;
            f->outermost = fmax(f->outermost, fabs(f->y[next]));
            next++;
        }
        next = padded(next);
        f->batches[m].end = next;
    }
}

static double shear_sum(const struct wb_fibres *f)
{
    double sum = 0.0;
    for (int b = 0; b < f->n_materials; b++) {
        for (int i = f->batches[b].begin; i < f->batches[b].end; i++)
            sum += f->area[i] * wb_section_shear_modulus(&f->materials[b]);
    }
    return sum;
}

void wb_fibres_set_materials(struct wb_fibres *f, const struct wb_material *materials)
{
    memcpy(f->materials, materials, (size_t)f->n_materials * sizeof *materials);
    f->yield_strain = (double)INFINITY;
    f->EA = f->ES = f->EI = 0.0;
    for (int b = 0; b < f->n_materials; b++) {
        const struct wb_material *m = &f->materials[b];
        for (int i = f->batches[b].begin; i < f->batches[b].end; i++) {
            const double EA = m->youngs_modulus * f->area[i];
            f->EA += EA;
            f->ES -= EA * f->y[i];
            f->EI += EA * f->y[i] * f->y[i];
            f->virgin[2 * f->n + i] =
                m->hardening == WB_HARDENING_ISOTROPIC_POWER ? m->yield_stress : 0.0;
        }
        if (m->hardening != WB_HARDENING_NONE_ELASTIC)
            f->yield_strain = fmin(f->yield_strain, m->yield_stress / m->youngs_modulus);
        if (m->hardening == WB_HARDENING_ISOTROPIC_POWER)
            wb_hardening_tabulate(&f->tables[b], m);
    }
    f->shear_stiffness = f->shear_ratio * shear_sum(f);
}

enum wb_status wb_fibres_create(struct wb_fibres **out, const struct wb_section *section)
{
    *out = NULL;
    if (section->n_fibres < 1 || section->n_materials < 1)
        return wb_fail(WB_ERR_ARGUMENT, "a section without fibres cannot carry anything");

    struct wb_fibres *f = calloc(1, sizeof *f);
    if (!f)
        return wb_fail(WB_ERR_MEMORY, "no memory for a section");

    int n = 0;
    for (int m = 0; m < section->n_materials; m++) {
        for (int i = 0; i < section->n_fibres; i++)
            n += section->fibres[i].material == m;
        n = padded(n);
    }
    const size_t count = (size_t)n, materials = (size_t)section->n_materials;
    f->n = n;
    f->n_materials = section->n_materials;
    f->y = calloc(count, sizeof *f->y);
    f->area = calloc(count, sizeof *f->area);
    f->virgin = calloc(HISTORY_ROWS * count, sizeof *f->virgin);
    f->batches = calloc(materials, sizeof *f->batches);
    f->materials = calloc(materials, sizeof *f->materials);
    f->tables = calloc(materials, sizeof *f->tables);
    if (!f->y || !f->area || !f->virgin || !f->batches || !f->materials || !f->tables) {
        wb_fibres_destroy(f);
        return wb_fail(WB_ERR_MEMORY, "no memory for %d fibres", n);
    }

    sort_fibres(f, section);
    f->shear_ratio = 1.0;
    wb_fibres_set_materials(f, section->materials);
    f->shear_ratio = section->shear_stiffness / f->shear_stiffness;
    f->shear_stiffness = section->shear_stiffness;
    *out = f;
    return WB_OK;
}

void wb_fibres_destroy(struct wb_fibres *f)
{
    if (!f)
        return;
    free(f->y);
    free(f->area);
    free(f->virgin);
    free(f->batches);
    free(f->materials);
    free(f->tables);
    free(f);
}

void wb_fibres_set_reference(struct wb_fibres *fibres, bool reference)
{
    fibres->reference = reference;
}

size_t wb_fibres_history_size(const struct wb_fibres *fibres)
{
    return HISTORY_HEAD + HISTORY_ROWS * (size_t)fibres->n;
}

double wb_fibres_axial_stiffness(const struct wb_fibres *fibres)
{
    return fibres->EA;
}

double wb_fibres_bending_stiffness(const struct wb_fibres *fibres)
{
    return fibres->EI;
}

double wb_fibres_shear_stiffness(const struct wb_fibres *fibres)
{
    return fibres->shear_stiffness;
}

/* One batch at a time: strains in, stress and tangent out, history of the batch's rows. */
struct rows {
    const double *plastic, *accumulated, *third;
    double *plastic_after, *accumulated_after, *third_after;
};

static void stress_elastic(const struct wb_material *m, int n, const double *restrict strain,
                           double *restrict stress, double *restrict tangent)
{
    for (int i = 0; i < n; i++) {
        stress[i] = m->youngs_modulus * strain[i];
        tangent[i] = m->youngs_modulus;
    }
}

/* sigma = sigma_Y + (1 - r) c with r(c) from the table; see fe/hardening.h. The third row is the
 * yield stress reached so far. */
static void stress_isotropic(const struct wb_material *m, const struct wb_hardening_table *table,
                             int n, const double *restrict strain, const struct rows *h,
                             double *restrict stress, double *restrict tangent)
{
    const double E = m->youngs_modulus;
    const double sigma_Y = m->yield_stress;
    const double exponent = m->hardening_exponent;
    const double scale = 1.0 / sigma_Y;
    const double compliance = 1.0 / E;

    for (int i = 0; i < n; i++) {
        const double plastic = h->plastic[i];
        const double p0 = h->accumulated[i];
        const double yield = h->third[i];
        const double trial = E * (strain[i] - plastic);
        const double size = fabs(trial);

        stress[i] = trial;
        tangent[i] = E;
        h->plastic_after[i] = plastic;
        h->accumulated_after[i] = p0;
        h->third_after[i] = yield;
        if (!(size - yield > on_surface * yield))
            continue;

        const double c = size - sigma_Y + E * p0;
        double r = wb_hardening_lookup(table, c * scale);
        if (!(r >= 0.0))
            r = wb_hardening_ratio(m, c);
        const double p = r * c * compliance;
        const double power_part = exponent * (1.0 - r);
        const double reached = sigma_Y + (1.0 - r) * c;

        stress[i] = copysign(reached, trial);
        tangent[i] = E * power_part / (r + power_part);
        h->plastic_after[i] = plastic + copysign(p - p0, trial);
        h->accumulated_after[i] = p;
        h->third_after[i] = reached;
    }
}

/* The third row is the back stress. */
static void stress_kinematic(const struct wb_material *m, int n, const double *restrict strain,
                             const struct rows *h, double *restrict stress,
                             double *restrict tangent)
{
    const double E = m->youngs_modulus;
    const double H = m->strength_coefficient;
    const double yield = m->yield_stress;

    for (int i = 0; i < n; i++) {
        const double trial = E * (strain[i] - h->plastic[i]);
        const double distance = trial - h->third[i];
        const double over = fabs(distance) - yield;
        const bool yields = over > on_surface * yield;
        const double size = yields ? over / (E + H) : 0.0;
        const double increment = copysign(size, distance);

        stress[i] = trial - E * increment;
        tangent[i] = yields ? E * H / (E + H) : E;
        h->plastic_after[i] = h->plastic[i] + increment;
        h->accumulated_after[i] = h->accumulated[i] + size;
        h->third_after[i] = h->third[i] + H * increment;
    }
}

/* The slow twin: the material law of fe/material.c, fibre by fibre. */
static void stress_reference(const struct wb_material *m, int n, const double *strain,
                             const struct rows *h, double *stress, double *tangent)
{
    const bool kinematic = m->hardening == WB_HARDENING_KINEMATIC_LINEAR;

    for (int i = 0; i < n; i++) {
        const struct wb_material_state before = {
            .plastic_strain = h->plastic[i],
            .accumulated_plastic_strain = h->accumulated[i],
            .back_stress = kinematic ? h->third[i] : 0.0,
        };
        struct wb_material_state after;
        wb_material_stress(m, strain[i], &before, &after, &stress[i], &tangent[i]);
        h->plastic_after[i] = after.plastic_strain;
        h->accumulated_after[i] = after.accumulated_plastic_strain;
        h->third_after[i] = after.back_stress;
        if (m->hardening == WB_HARDENING_ISOTROPIC_POWER) {
            const bool moved = after.accumulated_plastic_strain > h->accumulated[i];
            h->third_after[i] = moved ? fabs(stress[i]) : h->third[i];
        }
    }
}

static void respond_virgin(const struct wb_fibres *f, double eps, double kappa,
                           struct wb_fibres_response *response)
{
    response->N = f->EA * eps + f->ES * kappa;
    response->M = f->ES * eps + f->EI * kappa;
    response->D11 = f->EA;
    response->D12 = f->ES;
    response->D22 = f->EI;
}

static void stress_block(const struct wb_fibres *f, const struct batch *batch, const double *strain,
                         const struct rows *h, double *stress, double *tangent)
{
    const struct wb_material *m = &f->materials[batch->material];

    if (f->reference) {
        stress_reference(m, LANES, strain, h, stress, tangent);
        return;
    }
    switch (m->hardening) {
    case WB_HARDENING_NONE_ELASTIC:
        stress_elastic(m, LANES, strain, stress, tangent);
        break;
    case WB_HARDENING_ISOTROPIC_POWER:
        stress_isotropic(m, &f->tables[batch->material], LANES, strain, h, stress, tangent);
        break;
    case WB_HARDENING_KINEMATIC_LINEAR:
        stress_kinematic(m, LANES, strain, h, stress, tangent);
        break;
    }
}

/* Adds eight lanes in a fixed order. */
static double add_lanes(const double *lane)
{
    return ((lane[0] + lane[4]) + (lane[2] + lane[6])) +
           ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

void wb_fibres_respond(const struct wb_fibres *f, double eps, double kappa,
                       const double *restrict before, double *restrict after,
                       struct wb_fibres_response *restrict response)
{
    const bool yielded = before[0] != 0.0;
    after[0] = 1.0;
    if (!yielded && fabs(eps) + f->outermost * fabs(kappa) <= f->yield_strain) {
        after[0] = 0.0;
        respond_virgin(f, eps, kappa, response);
        return;
    }

    const double *rows = yielded ? before + HISTORY_HEAD : f->virgin;
    double *rows_after = after + HISTORY_HEAD;
    double N[LANES] = {0}, M[LANES] = {0}, D11[LANES] = {0}, D12[LANES] = {0}, D22[LANES] = {0};

    for (int b = 0; b < f->n_materials; b++) {
        for (int begin = f->batches[b].begin; begin < f->batches[b].end; begin += LANES) {
            const double *y = f->y + begin;
            const double *area = f->area + begin;
            const struct rows h = {
                .plastic = rows + begin,
                .accumulated = rows + f->n + begin,
                .third = rows + 2 * f->n + begin,
                .plastic_after = rows_after + begin,
                .accumulated_after = rows_after + f->n + begin,
                .third_after = rows_after + 2 * f->n + begin,
            };
            double strain[LANES], stress[LANES] = {0}, tangent[LANES] = {0};

            for (int i = 0; i < LANES; i++)
                strain[i] = eps - y[i] * kappa;
            stress_block(f, &f->batches[b], strain, &h, stress, tangent);
            for (int i = 0; i < LANES; i++) {
                const double force = stress[i] * area[i];
                const double stiffness = tangent[i] * area[i];
                N[i] += force;
                M[i] -= force * y[i];
                D11[i] += stiffness;
                D12[i] -= stiffness * y[i];
                D22[i] += stiffness * y[i] * y[i];
            }
        }
    }
    response->N = add_lanes(N);
    response->M = add_lanes(M);
    response->D11 = add_lanes(D11);
    response->D12 = add_lanes(D12);
    response->D22 = add_lanes(D22);
}

double wb_fibres_largest_plastic_strain(const struct wb_fibres *f, const double *history)
{
    double largest = 0.0;
    if (history[0] == 0.0)
        return largest;
    for (int i = 0; i < f->n; i++) {
        if (f->area[i] > 0.0)
            largest = fmax(largest, history[HISTORY_HEAD + f->n + i]);
    }
    return largest;
}
