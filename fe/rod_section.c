#include "fe/rod_section.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fe/rod_fibre.h"
#include "fe/section.h"

#define WB_LOG_DOMAIN "rod section"

enum {
    DEFAULT_RINGS = 8,
    DEFAULT_AROUND = 24,
    MOST_PARTS = 16,
    MOST_RINGS = 64,
    MOST_AROUND = 256,
    HISTORY_HEAD = 8, /* the first double says whether the point ever yielded; rest is padding */
    N_STRAINS = WB_ROD_SECTION_STRAINS
};

/* Elastic stiffnesses, N, N m2. */
struct stiffness {
    double EA, EI, GJ;
};

struct wb_rod_section {
    int n_parts, n;        /* parts, fibres; those of a part are contiguous */
    int n_rings, n_around; /* in each part, in each ring */
    struct wb_material *materials;
    struct wb_hardening_table *tables; /* (n_parts) */
    struct stiffness *stiffness;       /* (n_parts) */
    double *y, *z, *area;              /* (n) */
    double *radius;                    /* (n_parts n_rings) of the rings */
    double *edge;                      /* (n_parts (n_rings + 1)) radii between the rings' cells */
    double outermost;                  /* of the radii of fibres that can yield */
    double yield_strain; /* no fibre yields while |strain| and sqrt(3) G/E |angle| add to less */
    double shear_weight; /* the largest sqrt(3) G/E */
    struct stiffness total;
    double shear_stiffness;
    bool slow;
};

/* Gauss-Legendre points and weights of [0, 1], by Newton's method on the Legendre polynomials. */
static void gauss_rule(int n, double *point, double *weight)
{
    for (int i = 0; i < n; i++) {
        double x = cos(M_PI * (n - i - 0.25) / (n + 0.5)), slope = 1.0;
        for (int iteration = 0; iteration < 20; iteration++) {
            double p = 1.0, before = 0.0;
            for (int k = 1; k <= n; k++) {
                const double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
                before = p;
                p = next;
            }
            slope = n * (x * p - before) / (x * x - 1.0);
            const double step = p / slope;
            x -= step;
            if (fabs(step) < 1e-15)
                break;
        }
        point[i] = 0.5 * (1.0 + x);
        weight[i] = 1.0 / ((1.0 - x * x) * slope * slope);
    }
}

/* Direction of fibre i of a ring that is turned by half a space or not, mirrored from the first
 * octant so that the ring is symmetric to the last bit. */
static void direction(int i, int n_around, bool turned, double *c, double *s)
{
    const int halves = 2 * n_around; /* in half spaces */
    const int at = (2 * i + (turned ? 1 : 0)) % halves;
    const int quarter = halves / 4;
    const int quadrant = at / quarter, within = at % quarter;
    const bool beyond = 2 * within > quarter;
    const double angle = 2.0 * M_PI * (beyond ? quarter - within : within) / halves;
    const double a = beyond ? sin(angle) : cos(angle), b = beyond ? cos(angle) : sin(angle);

    *c = quadrant == 0 ? a : quadrant == 1 ? -b : quadrant == 2 ? -a : b;
    *s = quadrant == 0 ? b : quadrant == 1 ? a : quadrant == 2 ? -b : -a;
}

static void fill_part(struct wb_rod_section *section, int part, double Ri, double Ro)
{
    double point[MOST_RINGS], weight[MOST_RINGS];
    const int n_rings = section->n_rings, n_around = section->n_around;
    const double squares = Ro * Ro - Ri * Ri;
    double *radius = section->radius + part * n_rings;
    double *edge = section->edge + part * (n_rings + 1);
    double covered = 0.0;

    gauss_rule(n_rings, point, weight);
    edge[0] = Ri;
    for (int ring = 0; ring < n_rings; ring++) {
        covered += weight[ring];
        edge[ring + 1] = ring + 1 == n_rings ? Ro : sqrt(Ri * Ri + covered * squares);
        radius[ring] = sqrt(Ri * Ri + point[ring] * squares);
        for (int i = 0; i < n_around; i++) {
            const int at = (part * n_rings + ring) * n_around + i;
            double c, s;
            direction(i, n_around, ring % 2 == 1, &c, &s);
            section->y[at] = radius[ring] * c;
            section->z[at] = radius[ring] * s;
            section->area[at] = M_PI * squares * weight[ring] / n_around;
        }
    }
}

static void add_stiffness(struct wb_rod_section *section, int part)
{
    const struct wb_material *m = &section->materials[part];
    const double E = m->youngs_modulus, G = wb_rod_fibre_shear_modulus(m);
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
    section->shear_stiffness += wb_section_shear_modulus(m) * area;
    if (m->hardening == WB_HARDENING_NONE_ELASTIC)
        return;
    section->outermost = fmax(section->outermost, section->radius[(part + 1) * n_rings - 1]);
    section->yield_strain = fmin(section->yield_strain, m->yield_stress / E);
    section->shear_weight = fmax(section->shear_weight, sqrt(3.0) * G / E);
    if (m->hardening == WB_HARDENING_ISOTROPIC_POWER)
        wb_hardening_tabulate(&section->tables[part], m);
}

static enum wb_status check_parts(int n_parts, const struct wb_rod_section_part *parts,
                                  const struct wb_rod_section_layout *layout)
{
    if (n_parts < 1 || n_parts > MOST_PARTS)
        return wb_fail(WB_ERR_ARGUMENT, "%d parts of a section: expected 1 to %d", n_parts,
                       MOST_PARTS);
    if (layout->n_rings < 1 || layout->n_rings > MOST_RINGS)
        return wb_fail(WB_ERR_ARGUMENT, "%d rings of fibres: expected 1 to %d", layout->n_rings,
                       MOST_RINGS);
    if (layout->n_around < 4 || layout->n_around > MOST_AROUND || layout->n_around % 4 != 0)
        return wb_fail(WB_ERR_ARGUMENT,
                       "%d fibres in a ring: expected a multiple of 4 from 4 to %d",
                       layout->n_around, MOST_AROUND);
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

static bool take_memory(struct wb_rod_section *s)
{
    const size_t parts = (size_t)s->n_parts, n = (size_t)s->n, rings = (size_t)s->n_rings;

    s->materials = calloc(parts, sizeof *s->materials);
    s->tables = calloc(parts, sizeof *s->tables);
    s->stiffness = calloc(parts, sizeof *s->stiffness);
    s->y = calloc(n, sizeof *s->y);
    s->z = calloc(n, sizeof *s->z);
    s->area = calloc(n, sizeof *s->area);
    s->radius = calloc(parts * rings, sizeof *s->radius);
    s->edge = calloc(parts * (rings + 1), sizeof *s->edge);
    return s->materials && s->tables && s->stiffness && s->y && s->z && s->area && s->radius &&
           s->edge;
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

    struct wb_rod_section *s = calloc(1, sizeof *s);
    if (!s)
        return wb_fail(WB_ERR_MEMORY, "no memory for a section");
    s->n_parts = n_parts;
    s->n_rings = complete.n_rings;
    s->n_around = complete.n_around;
    s->n = n_parts * s->n_rings * s->n_around;
    s->yield_strain = (double)INFINITY;
    if (!take_memory(s)) {
        const int n = s->n;
        wb_rod_section_destroy(s);
        return wb_fail(WB_ERR_MEMORY, "no memory for %d fibres", n);
    }
    for (int i = 0; i < n_parts; i++) {
        s->materials[i] = parts[i].material;
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
    free(section->materials);
    free(section->tables);
    free(section->stiffness);
    free(section->y);
    free(section->z);
    free(section->area);
    free(section->radius);
    free(section->edge);
    free(section);
}

void wb_rod_section_set_slow(struct wb_rod_section *section, bool slow)
{
    section->slow = slow;
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
    return HISTORY_HEAD + (size_t)section->n * (sizeof(struct wb_rod_fibre_state) / sizeof(double));
}

double wb_rod_section_axial_stiffness(const struct wb_rod_section *section)
{
    return section->total.EA;
}

double wb_rod_section_bending_stiffness(const struct wb_rod_section *section)
{
    return section->total.EI;
}

double wb_rod_section_torsion_stiffness(const struct wb_rod_section *section)
{
    return section->total.GJ;
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

/* Adds a fibre's forces and stiffness; tangent: the lower triangle only. */
static void add_fibre(const struct wb_rod_fibre_response *f, double area, const double place[3],
                      struct wb_rod_section_response *response)
{
    const double y = place[0], z = place[1], r = place[2];
    const double N = area * f->axial;
    const double D = area * f->D11, C = area * r * f->D12;
    double(*K)[N_STRAINS] = response->tangent;

    response->force[0] += N;
    response->force[1] += area * r * f->shear;
    response->force[2] += z * N;
    response->force[3] -= y * N;
    K[0][0] += D;
    K[1][0] += C;
    K[1][1] += area * r * r * f->D22;
    K[2][0] += z * D;
    K[2][1] += z * C;
    K[2][2] += z * z * D;
    K[3][0] -= y * D;
    K[3][1] -= y * C;
    K[3][2] -= y * z * D;
    K[3][3] += y * y * D;
    response->yielding += f->yields;
}

/* The history of fibre i at a point that yielded before, or a virgin one. */
static struct wb_rod_fibre_state state_of(const struct wb_rod_section *section, int part, int i,
                                          const double *history)
{
    if (history[0] != 0.0) {
        struct wb_rod_fibre_state state;
        memcpy(&state, history + HISTORY_HEAD + (size_t)i * (sizeof state / sizeof(double)),
               sizeof state);
        return state;
    }
    return (struct wb_rod_fibre_state){.yield = section->materials[part].yield_stress};
}

static double axial_strain(const struct wb_rod_section *section, int i, const double *strain)
{
    return strain[0] + section->z[i] * strain[2] - section->y[i] * strain[3];
}

static bool stays_elastic(const struct wb_rod_section *s, const double *strain)
{
    /* sqrt(s^2 + 3 t^2) is at most |s| + sqrt(3) |t|. */
    return fabs(strain[0]) +
               s->outermost * (hypot(strain[2], strain[3]) + s->shear_weight * fabs(strain[1])) <=
           s->yield_strain;
}

/* Elastic parts need no fibres. */
static void respond_part(const struct wb_rod_section *section, int part, const double *strain,
                         const double *before, double *after,
                         struct wb_rod_section_response *response)
{
    const struct wb_material *m = &section->materials[part];
    const struct wb_hardening_table *table = section->slow ? NULL : &section->tables[part];
    struct wb_rod_fibre_state *states = (struct wb_rod_fibre_state *)(after + HISTORY_HEAD);
    const int n_rings = section->n_rings, n_around = section->n_around;

    if (m->hardening == WB_HARDENING_NONE_ELASTIC) {
        add_elastic(&section->stiffness[part], strain, response);
        return;
    }
    for (int ring = part * n_rings; ring < (part + 1) * n_rings; ring++) {
        const double r = section->radius[ring];
        for (int i = ring * n_around; i < (ring + 1) * n_around; i++) {
            const double at[2] = {axial_strain(section, i, strain), r * strain[1]};
            const double place[3] = {section->y[i], section->z[i], r};
            const struct wb_rod_fibre_state was = state_of(section, part, i, before);
            struct wb_rod_fibre_response fibre;
            wb_rod_fibre_respond(m, table, at, &was, &states[i], &fibre);
            add_fibre(&fibre, section->area[i], place, response);
        }
    }
}

void wb_rod_section_respond(const struct wb_rod_section *section, const double *strain,
                            const double *restrict before, double *restrict after,
                            struct wb_rod_section_response *restrict response)
{
    *response = (struct wb_rod_section_response){0};
    if (before[0] == 0.0 && stays_elastic(section, strain)) {
        after[0] = 0.0;
        add_elastic(&section->total, strain, response);
        return;
    }
    after[0] = 1.0;
    for (int part = 0; part < section->n_parts; part++)
        respond_part(section, part, strain, before, after, response);
    for (int i = 0; i < N_STRAINS; i++) {
        for (int j = i + 1; j < N_STRAINS; j++)
            response->tangent[i][j] = response->tangent[j][i];
    }
}

void wb_rod_section_energy(const struct wb_rod_section *section, const double *strain,
                           const double *before, const double *after, double *stored,
                           double *dissipated)
{
    double energy = 0.0, loss = 0.0;
    for (int i = 0; i < section->n; i++) {
        const int ring = i / section->n_around, part = ring / section->n_rings;
        const struct wb_material *m = &section->materials[part];
        const double at[2] = {axial_strain(section, i, strain), section->radius[ring] * strain[1]};
        const struct wb_rod_fibre_state was = state_of(section, part, i, before);
        const struct wb_rod_fibre_state is = state_of(section, part, i, after);
        energy += section->area[i] * wb_rod_fibre_energy(m, at, &is);
        loss += section->area[i] * is.yield * (is.accumulated - was.accumulated);
    }
    *stored = energy;
    *dissipated = loss;
}

void wb_rod_section_stress(const struct wb_rod_section *section, int i, const double *strain,
                           const double *history, double *axial, double *shear, double *plastic)
{
    const int ring = i / section->n_around, part = ring / section->n_rings;
    const struct wb_material *m = &section->materials[part];
    const struct wb_rod_fibre_state state = state_of(section, part, i, history);

    *axial = m->youngs_modulus * (axial_strain(section, i, strain) - state.plastic);
    *shear =
        wb_rod_fibre_shear_modulus(m) * (section->radius[ring] * strain[1] - state.plastic_shear);
    *plastic = state.accumulated;
}

double wb_rod_section_largest_plastic_strain(const struct wb_rod_section *section,
                                             const double *history)
{
    double largest = 0.0;
    for (int i = 0; i < section->n; i++)
        largest = fmax(largest, state_of(section, 0, i, history).accumulated);
    return largest;
}
