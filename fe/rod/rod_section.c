#include "fe/rod/rod_section.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fe/rod/ring.h"
#include "fe/rod/rod_fibre.h"
#include "fe/rod/section.h"

#define WB_LOG_DOMAIN "rod section"

enum {
    DEFAULT_RINGS = 8,
    DEFAULT_AROUND = 24,
    MAX_PARTS = 16,
    HISTORY_HEAD =
        MAX_PARTS,    /* one double for each part: 1 if the part ever yielded at this point */
    HISTORY_ROWS = 4, /* plastic, plastic_shear, accumulated, yield of each fibre of a part */
    LANES = 4,        /* the number of fibres in a ring is a multiple of this */
    N_STRAINS = WB_ROD_SECTION_STRAINS
};

/* Elastic stiffnesses, N, N m2. */
struct stiffness {
    double EA, EI, GJ;
};

struct wb_rod_section {
    int n_parts, n;        /* number of parts, of fibres; the fibres of a part are contiguous */
    int n_rings, n_around; /* rings in each part, fibres in each ring */
    struct wb_rod_fibre_law *laws;     /* (n_parts) */
    struct wb_hardening_table *tables; /* (n_parts) */
    struct stiffness *stiffness;       /* (n_parts) */
    double *y, *z, *area;              /* (n) */
    double *radius;                    /* (n_parts n_rings) radius of each ring */
    double *edge; /* (n_parts (n_rings + 1)) boundaries between the rings' cells */
    struct stiffness total;
    double shear_stiffness;
    struct wb_memory memory; /* of all arrays */
};

static void fill_part(struct wb_rod_section *section, int part, double Ri, double Ro)
{
    double point[WB_RING_MOST], weight[WB_RING_MOST];
    const int n_rings = section->n_rings, n_around = section->n_around;
    const double squares = Ro * Ro - Ri * Ri;
    double *radius = section->radius + part * n_rings;
    double *edge = section->edge + part * (n_rings + 1);
    double covered = 0.0;

    wb_ring_rule(n_rings, point, weight);
    edge[0] = Ri;
    for (int ring = 0; ring < n_rings; ring++) {
        covered += weight[ring];
        edge[ring + 1] = ring + 1 == n_rings ? Ro : sqrt(Ri * Ri + covered * squares);
        radius[ring] = sqrt(Ri * Ri + point[ring] * squares);
        for (int i = 0; i < n_around; i++) {
            const int at = (part * n_rings + ring) * n_around + i;
            double c, s;
            wb_ring_direction(i, n_around, ring % 2 == 1, &c, &s);
            section->y[at] = radius[ring] * c;
            section->z[at] = radius[ring] * s;
            section->area[at] = M_PI * squares * weight[ring] / n_around;
        }
    }
}

static void add_stiffness(struct wb_rod_section *section, int part)
{
    const struct wb_rod_fibre_law *law = &section->laws[part];
    const double E = law->material.youngs_modulus, G = law->shear_modulus;
    const int n_rings = section->n_rings, n_around = section->n_around;
    struct stiffness *own = &section->stiffness[part];
    double area = 0.0, second_moment = 0.0;

    for (int ring = part * n_rings; ring < (part + 1) * n_rings; ring++) {
        const double r = section->radius[ring], cells = n_around * section->area[ring * n_around];
        area += cells;
        second_moment += 0.5 * cells * r * r;
    }
    *own = (struct stiffness){E * area, E * second_moment, 2.0 * G * second_moment};
    section->total.EA += own->EA;
    section->total.EI += own->EI;
    section->total.GJ += own->GJ;
    section->shear_stiffness += wb_section_shear_modulus(&law->material) * area;
    if (law->hardening->growth)
        wb_hardening_tabulate(&section->tables[part], &law->material);
}

static enum wb_status check_parts(int n_parts, const struct wb_rod_section_part *parts,
                                  const struct wb_rod_section_layout *layout)
{
    if (n_parts < 1 || n_parts > MAX_PARTS)
        return wb_fail(WB_ERR_ARGUMENT, "%d parts of a section: expected 1 to %d", n_parts,
                       MAX_PARTS);
    WB_TRY(wb_ring_check(layout->n_rings, layout->n_around));
    for (int i = 0; i < n_parts; i++) {
        const struct wb_rod_section_part *p = &parts[i];
        if (!(isfinite(p->outer_diameter) && p->inner_diameter >= 0.0 &&
              p->outer_diameter > p->inner_diameter))
            return wb_fail(WB_ERR_ARGUMENT,
                           "part from %g to %g m: expected 0 <= inner < outer diameter",
                           p->inner_diameter, p->outer_diameter);
        WB_TRY(wb_section_check_material(&p->material));
    }
    return WB_OK;
}

static void take_memory(struct wb_rod_section *s)
{
    const size_t parts = (size_t)s->n_parts, n = (size_t)s->n, rings = (size_t)s->n_rings;

    s->laws = wb_memory_take(&s->memory, parts, sizeof *s->laws);
    s->tables = wb_memory_take(&s->memory, parts, sizeof *s->tables);
    s->stiffness = wb_memory_take(&s->memory, parts, sizeof *s->stiffness);
    s->y = wb_memory_take(&s->memory, n, sizeof *s->y);
    s->z = wb_memory_take(&s->memory, n, sizeof *s->z);
    s->area = wb_memory_take(&s->memory, n, sizeof *s->area);
    s->radius = wb_memory_take(&s->memory, parts * rings, sizeof *s->radius);
    s->edge = wb_memory_take(&s->memory, parts * (rings + 1), sizeof *s->edge);
}

enum wb_status wb_rod_section_create(struct wb_rod_section **out, int n_parts,
                                     const struct wb_rod_section_part *parts,
                                     const struct wb_rod_section_layout *layout)
{
    *out = NULL;
    struct wb_rod_section_layout complete = {0, 0};
    if (layout)
        complete = *layout;
    if (complete.n_rings == 0)
        complete.n_rings = DEFAULT_RINGS;
    if (complete.n_around == 0)
        complete.n_around = DEFAULT_AROUND;
    WB_TRY(check_parts(n_parts, parts, &complete));

    struct wb_rod_section *const s = wb_memory_new(1, sizeof *s);
    s->n_parts = n_parts;
    s->n_rings = complete.n_rings;
    s->n_around = complete.n_around;
    s->n = n_parts * s->n_rings * s->n_around;
    take_memory(s);
    for (int i = 0; i < n_parts; i++) {
        wb_rod_fibre_law_init(&s->laws[i], &parts[i].material, &s->tables[i]);
        fill_part(s, i, 0.5 * parts[i].inner_diameter, 0.5 * parts[i].outer_diameter);
        add_stiffness(s, i);
    }
    *out = s;
    return WB_OK;
}

void wb_rod_section_destroy(struct wb_rod_section *section)
{
    if (!section)
        return;
    wb_memory_release(&section->memory);
    free(section);
}

int wb_rod_section_fibres(const struct wb_rod_section *section)
{
    return section->n;
}

void wb_rod_section_fibre(const struct wb_rod_section *section, int i,
                          struct wb_rod_section_fibre *fibre)
{
    const int ring = i / section->n_around, part = ring / section->n_rings;
    const int in_part = ring % section->n_rings;
    const double space = 2.0 * M_PI / section->n_around;
    const double middle = space * (i % section->n_around + (in_part % 2 == 1 ? 0.5 : 0.0));
    const double *edge = section->edge + part * (section->n_rings + 1) + in_part;

    *fibre = (struct wb_rod_section_fibre){
        .y = section->y[i],
        .z = section->z[i],
        .inner_radius = edge[0],
        .outer_radius = edge[1],
        .begin_angle = middle - 0.5 * space,
        .end_angle = middle + 0.5 * space,
        .area = section->area[i],
        .part = part,
    };
}

size_t wb_rod_section_history_size(const struct wb_rod_section *section)
{
    return HISTORY_HEAD + HISTORY_ROWS * (size_t)section->n;
}

double wb_rod_section_axial_stiffness(const struct wb_rod_section *section)
{
    return section->total.EA;
}

double wb_rod_section_bending_stiffness(const struct wb_rod_section *section)
{
    return section->total.EI;
}

double wb_rod_section_shear_stiffness(const struct wb_rod_section *section)
{
    return section->shear_stiffness;
}

static void add_elastic(const struct stiffness *own, const double *strain,
                        struct wb_rod_section_response *response)
{
    const double stiffness[N_STRAINS] = {own->EA, own->GJ, own->EI, own->EI};
    for (int i = 0; i < N_STRAINS; i++) {
        response->force[i] += stiffness[i] * strain[i];
        response->tangent[i][i] += stiffness[i];
    }
}

/* The history of one ring in the rows of its part, each as long as the part has fibres. */
struct rows {
    double *plastic, *plastic_shear, *accumulated, *yield;
};

static int fibres_of_part(const struct wb_rod_section *section)
{
    return section->n_rings * section->n_around;
}

static struct rows rows_of(const struct wb_rod_section *section, int ring, double *history)
{
    const int n = fibres_of_part(section), part = ring / section->n_rings;
    double *first = history + HISTORY_HEAD + part * HISTORY_ROWS * n +
                    ring % section->n_rings * section->n_around;
    return (struct rows){first, first + n, first + 2 * n, first + 3 * n};
}

/* The history of fibre i; the virgin history if its part never yielded. */
static struct wb_rod_fibre_state fibre_state(const struct wb_rod_section *section, int i,
                                             const double *history)
{
    const int n = fibres_of_part(section), part = i / n;
    const double *at = history + HISTORY_HEAD + part * HISTORY_ROWS * n + i % n;
    if (history[part] == 0.0)
        return (struct wb_rod_fibre_state){.yield = section->laws[part].material.yield_stress};
    return (struct wb_rod_fibre_state){at[0], at[n], at[2 * n], at[3 * n]};
}

/* Histories of a part at the end of a step without yielding. */
static void carry_over(const struct wb_rod_section *section, int part, const double *before,
                       double *after)
{
    const size_t n = (size_t)fibres_of_part(section);
    const size_t first = HISTORY_HEAD + (size_t)part * HISTORY_ROWS * n;

    after[part] = 1.0;
    if (before[part] != 0.0) {
        memcpy(after + first, before + first, HISTORY_ROWS * n * sizeof *after);
        return;
    }
    memset(after + first, 0, (HISTORY_ROWS - 1) * n * sizeof *after);
    for (size_t i = 0; i < n; i++)
        after[first + (HISTORY_ROWS - 1) * n + i] = section->laws[part].material.yield_stress;
}

static double axial_strain(const struct wb_rod_section *section, int i, const double *strain)
{
    return strain[0] + section->z[i] * strain[2] - section->y[i] * strain[3];
}

/* True if no fibre of a virgin part yields: sqrt(s^2 + 3 t^2) is at most |s| + sqrt(3) |t|. */
static bool stays_elastic(const struct wb_rod_section *section, int part, const double *strain)
{
    const struct wb_rod_fibre_law *law = &section->laws[part];
    const double outermost = section->radius[(part + 1) * section->n_rings - 1];
    const double axial = fabs(strain[0]) + outermost * hypot(strain[2], strain[3]);
    const double shear = outermost * fabs(strain[1]);
    return law->material.youngs_modulus * axial + sqrt(3.0) * law->shear_modulus * shear <=
           law->material.yield_stress;
}

/* A ring during evaluation: stresses, and the distance of each fibre beyond its yield surface. */
struct ring {
    int first; /* fibre, of all */
    double radius, area;
    double axial[WB_RING_MOST_AROUND], shear[WB_RING_MOST_AROUND], beyond[WB_RING_MOST_AROUND];
};

/* Trial stresses of one ring. Elastic fibres spend most of their time
 * here, so the loop has no branches. */
static void compute_trial_stresses(const struct wb_rod_section *section,
                                   const struct wb_rod_fibre_law *law, const double *strain,
                                   const struct rows *rows, struct ring *ring)
{
    const double E = law->material.youngs_modulus, G = law->shear_modulus, K = law->back;
    const double *restrict y = section->y + ring->first, *restrict z = section->z + ring->first;
    const double *restrict plastic = rows->plastic, *restrict yield = rows->yield;
    const double *restrict plastic_shear = rows->plastic_shear;
    const double angle = ring->radius * strain[1];

    for (int i = 0; i < section->n_around; i++) {
        const double s = E * (strain[0] + z[i] * strain[2] - y[i] * strain[3] - plastic[i]);
        const double t = G * (angle - plastic_shear[i]);
        const double x = s - K * plastic[i], w = t - K / 3.0 * plastic_shear[i];
        ring->axial[i] = s;
        ring->shear[i] = t;
        ring->beyond[i] = x * x + 3.0 * w * w - yield[i] * yield[i];
    }
}

/* Subtracts the difference between the elastic and the yielding fibre from the tangent (lower
 * triangle). */
static void reduce_tangent(const struct wb_rod_fibre_response *f, const double moduli[2],
                           const double place[3], double area,
                           struct wb_rod_section_response *response)
{
    const double y = place[0], z = place[1], r = place[2];
    const double D = area * (moduli[0] - f->D11), C = -area * r * f->D12;
    double(*K)[N_STRAINS] = response->tangent;

    K[0][0] -= D;
    K[1][0] -= C;
    K[1][1] -= area * r * r * (moduli[1] - f->D22);
    K[2][0] -= z * D;
    K[2][1] -= z * C;
    K[2][2] -= z * z * D;
    K[3][0] += y * D;
    K[3][1] += y * C;
    K[3][2] += y * z * D;
    K[3][3] -= y * y * D;
    response->yielding += f->yields;
}

/* Return mapping for fibres that are beyond their surface or not finite. `rows` hold the history at
 * the end of the step, still with the values from its beginning. */
static void return_ring(const struct wb_rod_section *section, int part, const double *strain,
                        const struct rows *rows, struct ring *ring,
                        struct wb_rod_section_response *response)
{
    const struct wb_rod_fibre_law *law = &section->laws[part];
    const double moduli[2] = {law->material.youngs_modulus, law->shear_modulus};

    for (int i = 0; i < section->n_around; i++) {
        if (ring->beyond[i] <= 0.0)
            continue;
        const int fibre = ring->first + i;
        const double place[3] = {section->y[fibre], section->z[fibre], ring->radius};
        const double at[2] = {axial_strain(section, fibre, strain), ring->radius * strain[1]};
        struct wb_rod_fibre_state state = {rows->plastic[i], rows->plastic_shear[i],
                                           rows->accumulated[i], rows->yield[i]};
        struct wb_rod_fibre_response f;
        wb_rod_fibre_respond(law, at, &state, &state, &f);
        rows->plastic[i] = state.plastic;
        rows->plastic_shear[i] = state.plastic_shear;
        rows->accumulated[i] = state.accumulated;
        rows->yield[i] = state.yield;
        ring->axial[i] = f.axial;
        ring->shear[i] = f.shear;
        reduce_tangent(&f, moduli, place, ring->area, response);
    }
}

static void add_forces(const struct wb_rod_section *section, const struct ring *ring,
                       struct wb_rod_section_response *response)
{
    const double *y = section->y + ring->first, *z = section->z + ring->first;
    double sum[N_STRAINS][LANES] = {{0}};

    for (int i = 0; i < section->n_around; i += LANES) {
        for (int k = 0; k < LANES; k++) {
            const double s = ring->axial[i + k];
            sum[0][k] += s;
            sum[1][k] += ring->shear[i + k];
            sum[2][k] += z[i + k] * s;
            sum[3][k] -= y[i + k] * s;
        }
    }
    for (int j = 0; j < N_STRAINS; j++) {
        const double weight = ring->area * (j == 1 ? ring->radius : 1.0);
        response->force[j] += weight * (sum[j][0] + sum[j][2] + (sum[j][1] + sum[j][3]));
    }
}

static void respond_part(const struct wb_rod_section *section, int part, const double *strain,
                         const double *before, double *after,
                         struct wb_rod_section_response *response)
{
    const struct wb_rod_fibre_law *law = &section->laws[part];
    const struct stiffness *own = &section->stiffness[part];

    if (!law->hardening->yields || (before[part] == 0.0 && stays_elastic(section, part, strain))) {
        after[part] = 0.0;
        add_elastic(own, strain, response);
        return;
    }
    carry_over(section, part, before, after);
    const double elastic[N_STRAINS] = {own->EA, own->GJ, own->EI, own->EI};
    for (int i = 0; i < N_STRAINS; i++)
        response->tangent[i][i] += elastic[i];

    for (int r = part * section->n_rings; r < (part + 1) * section->n_rings; r++) {
        const struct rows rows = rows_of(section, r, after);
        struct ring ring;
        ring.first = r * section->n_around;
        ring.radius = section->radius[r];
        ring.area = section->area[ring.first];
        compute_trial_stresses(section, law, strain, &rows, &ring);
        return_ring(section, part, strain, &rows, &ring, response);
        add_forces(section, &ring, response);
    }
}

void wb_rod_section_respond(const struct wb_rod_section *section, const double *strain,
                            const double *restrict before, double *restrict after,
                            struct wb_rod_section_response *restrict response)
{
    *response = (struct wb_rod_section_response){0};
    for (int part = 0; part < section->n_parts; part++)
        respond_part(section, part, strain, before, after, response);
    for (int i = 0; i < N_STRAINS; i++) {
        for (int j = i + 1; j < N_STRAINS; j++)
            response->tangent[i][j] = response->tangent[j][i];
    }
}

void wb_rod_section_stress(const struct wb_rod_section *section, int i, const double *strain,
                           const double *history, double *axial, double *shear, double *plastic)
{
    const int ring = i / section->n_around, part = ring / section->n_rings;
    const struct wb_rod_fibre_law *law = &section->laws[part];
    const struct wb_rod_fibre_state state = fibre_state(section, i, history);

    *axial = law->material.youngs_modulus * (axial_strain(section, i, strain) - state.plastic);
    *shear = law->shear_modulus * (section->radius[ring] * strain[1] - state.plastic_shear);
    *plastic = state.accumulated;
}
