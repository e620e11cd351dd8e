#include "fe/rod/fibres.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fe/material/hardening.h"
#include "fe/material/law.h"
#include "fe/rod/fibres_private.h"
#include "fe/rod/lanes.h"

#define WB_LOG_DOMAIN "fibres"

enum {
    /* The first double is 1 if the point ever yielded; the second is the number of overlay parts
     * that have history rows. */
    HISTORY_HEAD = 12,
    /* Also in the head, for Maxwell elements: strains at the end of the last step, then N and M of
     * each element; in space the curvature about y and the moment about y follow. */
    HISTORY_EPS = 2,
    HISTORY_KAPPA,
    HISTORY_MAXWELL,
    HISTORY_KAPPA_Y = HISTORY_MAXWELL + 2 * WB_LAW_MOST_MAXWELL,
    HISTORY_MAXWELL_Y,
    HISTORY_ROWS = 3, /* plastic strain, accumulated plastic strain, yield or back stress */
    MAX_PASSES = 50
};

_Static_assert(HISTORY_MAXWELL_Y + WB_LAW_MOST_MAXWELL <= HISTORY_HEAD, "head of the history");

/* Relative distance to the yield surface below which a fibre counts as elastic; see
 * tests/twin/material_stress.h. */
static const double on_surface = 1e-12;
/* Relative tolerance of the stress beyond the yield surface in a step of Chaboche's law. */
static const double stress_tolerance = 1e-12;

/* Fibres of one material, contiguous and padded with fibres of zero area. */
struct batch {
    int material;
    int begin, end; /* padded indices */
    /* Copied from the material's hardening law for the inner loop. */
    bool grows, moves, has_constant_exponent;
};

enum wb_fibres_kind {
    BY_MATERIAL,
    BY_POINT_LAW,
    AS_OVERLAY,
    LUDWIK_COMBINED,
    CHABOCHE
};

/* Axial strain and curvatures of the section about z and y; `largest` is a bound of the strains of
 * all fibres. */
struct strains {
    double eps, kappa, kappa_y, largest;
};

struct wb_fibres {
    int n;           /* padded number of fibres */
    int n_materials; /* materials of the section, one batch each */
    struct batch *batches;
    double *y, *z, *area; /* (n) */
    struct wb_material *materials;
    struct wb_hardening_table *tables; /* (n_materials) */
    double *virgin;                    /* history of a virgin point, with its head */
    double outermost;                  /* largest distance from the axis, m */
    double yield_strain;               /* strain below which no fibre yields, 1 */
    double EA, ES, EI;                 /* elastic N = EA eps + ES kappa, M = ES eps + EI kappa */
    double ES_y, EI_yz, EI_y;          /* the same for the curvature about y */
    double shear_ratio; /* shear stiffness of the section over the sum over its fibres */
    double shear_stiffness;
    enum wb_fibres_kind kind;
    /* For a section with a law; its fibres are one batch. */
    int capacity;               /* allocated history rows of parts or back stresses */
    struct wb_law law;          /* combined hardening */
    struct wb_overlay *overlay; /* kinematic and mixed hardening; owned */
    /* Pa: sum of the moduli of part i and all later parts. */
    double tail[WB_OVERLAY_MOST_PARTS + 1];
    /* Pa: stress of all parts before part i once they yield. */
    double full[WB_OVERLAY_MOST_PARTS + 1];
    double compliance; /* 1/Pa: of all parts together while elastic */
    double duration;   /* s, of a step */
    struct wb_law_maxwell_step maxwell[WB_LAW_MOST_MAXWELL];
    const struct wb_point_law *point_laws; /* (n_materials) or NULL; borrowed */
    int point_history;                     /* history rows of the point law that needs most */
    void (*respond)(const struct wb_fibres *fibres, struct strains strains, const double *before,
                    double *after, struct wb_fibres_response *response);
    void (*respond_in_space)(const struct wb_fibres *fibres, struct strains strains,
                             const double *before, double *after,
                             struct wb_fibres_space_response *response);
    struct wb_memory memory; /* of all arrays */
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
            f->z[next] = section->fibres[i].z;
            f->area[next] = section->fibres[i].area;
            f->outermost = fmax(f->outermost, hypot(f->y[next], f->z[next]));
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

/* History rows. Overlay: the plastic strain of each part, followed by its accumulated plastic
 * strain if the limits grow, and three rows for the share with isotropic hardening. Combined
 * hardening: one row for each back stress. */
static int history_rows(const struct wb_fibres *f)
{
    return f->kind == BY_POINT_LAW ? f->point_history : HISTORY_ROWS + f->capacity;
}

static enum wb_fibres_kind kind_of(const struct wb_law *law)
{
    if (wb_law_is_overlay(law))
        return AS_OVERLAY;
    return wb_law_is_plain(law)           ? BY_MATERIAL
           : law->form == WB_LAW_CHABOCHE ? CHABOCHE
                                          : LUDWIK_COMBINED;
}

/* History rows that the law needs in addition to HISTORY_ROWS. */
static int rows_of(const struct wb_law *law)
{
    if (law->form == WB_LAW_PARALLEL)
        return law->is_combined ? 2 * law->n_parts : law->n_parts;
    if (wb_law_is_overlay(law))
        return WB_LAW_LUDWIK_PARTS;
    return law->form == WB_LAW_CHABOCHE ? law->n_backs : law->is_combined;
}

static void set_overlay(struct wb_fibres *f, const struct wb_law *law)
{
    struct wb_overlay *const overlay = f->overlay;
    wb_law_overlay(law, overlay);
    f->tail[overlay->n] = 0.0;
    for (int i = overlay->n - 1; i >= 0; i--)
        f->tail[i] = f->tail[i + 1] + overlay->modulus[i];
    f->compliance = 1.0 / f->tail[0];
    f->full[0] = 0.0;
    for (int i = 0; i < overlay->n; i++)
        f->full[i + 1] = f->full[i] + overlay->modulus[i] * overlay->yield_strain[i];
    const struct wb_material elastic = {
        .hardening = WB_HARDENING_NONE_ELASTIC,
        .youngs_modulus = f->tail[0],
        .poissons_ratio = f->materials[0].poissons_ratio,
    };
    wb_fibres_set_materials(f, &elastic);
    f->yield_strain = overlay->yield_strain[0];
    for (int i = 0; i < f->n; i++)
        f->virgin[HISTORY_HEAD + (f->capacity + 2) * f->n + i] =
            elastic.youngs_modulus * overlay->yield_strain[0];
}

enum wb_status wb_fibres_set_law(struct wb_fibres *f, const struct wb_law *law)
{
    if (kind_of(law) != f->kind || rows_of(law) > f->capacity || f->n_materials != 1)
        return wb_fail(
            WB_ERR_ARGUMENT,
            "the law is of another kind, or needs more history rows than the section has");
    f->law = *law;
    wb_fibres_set_duration(f, f->duration);
    if (f->kind == AS_OVERLAY) {
        set_overlay(f, law);
        return WB_OK;
    }
    wb_fibres_set_materials(f, &law->material);
    f->yield_strain = law->material.yield_stress / law->material.youngs_modulus;
    for (int i = 0; i < f->n && f->kind != BY_MATERIAL; i++)
        f->virgin[HISTORY_HEAD + 2 * f->n + i] = 0.0;
    return WB_OK;
}

void wb_fibres_set_duration(struct wb_fibres *f, double duration)
{
    f->duration = duration;
    for (int i = 0; i < f->law.n_maxwell; i++)
        f->maxwell[i] = wb_law_maxwell_step(&f->law.maxwell[i], duration);
}

void wb_fibres_set_materials(struct wb_fibres *f, const struct wb_material *materials)
{
    memcpy(f->materials, materials, (size_t)f->n_materials * sizeof *materials);
    f->yield_strain = (double)INFINITY;
    f->EA = f->ES = f->EI = f->ES_y = f->EI_yz = f->EI_y = 0.0;
    for (int b = 0; b < f->n_materials; b++) {
        const struct wb_material *m = &f->materials[b];
        const struct wb_hardening_law *law = wb_hardening_law(m);
        f->batches[b].grows = law->growth;
        f->batches[b].moves = law->moves;
        f->batches[b].has_constant_exponent = !law->exponent;
        for (int i = f->batches[b].begin; i < f->batches[b].end; i++) {
            const double EA = m->youngs_modulus * f->area[i];
            f->EA += EA;
            f->ES -= EA * f->y[i];
            f->EI += EA * f->y[i] * f->y[i];
            f->ES_y += EA * f->z[i];
            f->EI_yz -= EA * f->y[i] * f->z[i];
            f->EI_y += EA * f->z[i] * f->z[i];
            if (!f->point_laws)
                f->virgin[HISTORY_HEAD + 2 * f->n + i] = law->growth ? m->yield_stress : 0.0;
        }
        if (law->yields)
            f->yield_strain = fmin(f->yield_strain, m->yield_stress / m->youngs_modulus);
        if (law->growth)
            wb_hardening_tabulate(&f->tables[b], m);
    }
    f->shear_stiffness = f->shear_ratio * shear_sum(f);
}

void wb_fibres_destroy(struct wb_fibres *f)
{
    if (!f)
        return;
    wb_memory_release(&f->memory);
    free(f);
}

size_t wb_fibres_history_size(const struct wb_fibres *fibres)
{
    return HISTORY_HEAD + (size_t)history_rows(fibres) * (size_t)fibres->n;
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

/* Pointers to the history of four fibres, before and after the step. */
struct rows {
    const double *plastic, *accumulated, *third;
    double *plastic_after, *accumulated_after, *third_after;
};

static WB_ALWAYS_INLINE struct rows rows_at(const struct wb_fibres *f, const double *rows,
                                            double *rows_after, int i)
{
    return (struct rows){
        .plastic = rows + i,
        .accumulated = rows + f->n + i,
        .third = rows + 2 * f->n + i,
        .plastic_after = rows_after + i,
        .accumulated_after = rows_after + f->n + i,
        .third_after = rows_after + 2 * f->n + i,
    };
}

struct answer {
    lanes stress, tangent;
};

static WB_ALWAYS_INLINE struct answer respond_elastically(const struct wb_material *m, lanes strain)
{
    const struct answer answer = {m->youngs_modulus * strain, m->youngs_modulus + 0.0 * strain};
    return answer;
}

/* r(c), computed lane by lane: a table row is one cache line, and gathering rows costs more than
 * evaluating their polynomials. */
static WB_ALWAYS_INLINE lanes plastic_ratio(const struct wb_material *m,
                                            const struct wb_hardening_table *table, masks yields,
                                            lanes c)
{
    const lanes scaled = c * (1.0 / m->yield_stress);
    lanes r;
    for (int i = 0; i < LANES; i++)
        r[i] = wb_hardening_lookup(table, scaled[i]);
    for (int i = 0; i < LANES; i++) {
        if (yields[i] && !wb_hardening_covers(scaled[i]))
            r[i] = wb_hardening_ratio(m, c[i]);
    }
    return r;
}

/* Exponents at LANES plastic strains, for a law whose exponent varies. Not inlined, so that the
 * loop of power laws stays fast. */
static __attribute__((noinline, cold)) void find_exponents(const struct wb_material *m,
                                                           const double *p, double *n)
{
    for (int i = 0; i < LANES; i++)
        n[i] = wb_hardening_exponent(m, p[i]);
}

static WB_ALWAYS_INLINE lanes exponents(const struct wb_material *m, bool is_constant, lanes p)
{
    double at[LANES], n[LANES];

    if (is_constant)
        return m->hardening_exponent - (lanes){0};
    store(at, p);
    find_exponents(m, at, n);
    return load(n);
}

/* Isotropic hardening: sigma = sigma_Y + (1 - r) c with r(c) from the table; see
 * fe/material/hardening.h. The third row is the yield stress reached so far. */
static WB_ALWAYS_INLINE struct answer respond_growing(const struct wb_material *m,
                                                      bool has_constant_exponent,
                                                      const struct wb_hardening_table *table,
                                                      lanes strain, const struct rows *h)
{
    const double E = m->youngs_modulus;
    const double sigma_Y = m->yield_stress;
    const lanes plastic = load(h->plastic);
    const lanes p0 = load(h->accumulated);
    const lanes yield = load(h->third);
    const lanes trial = E * (strain - plastic);
    const lanes size = absolute(trial);
    const masks yields = size - yield > on_surface * yield;
    struct answer answer = respond_elastically(m, strain);

    answer.stress = trial;
    if (!any(yields)) {
        store(h->plastic_after, plastic);
        store(h->accumulated_after, p0);
        store(h->third_after, yield);
        return answer;
    }

    const lanes c = size - sigma_Y + E * p0;
    const lanes r = plastic_ratio(m, table, yields, c);
    const lanes p = r * c * (1.0 / E);
    const lanes power_part = exponents(m, has_constant_exponent, p) * (1.0 - r);
    const lanes reached = sigma_Y + (1.0 - r) * c;

    answer.stress = select_lanes(yields, with_sign(reached, trial), trial);
    answer.tangent = select_lanes(yields, E * power_part / (r + power_part), answer.tangent);
    store(h->plastic_after, select_lanes(yields, plastic + with_sign(p - p0, trial), plastic));
    store(h->accumulated_after, select_lanes(yields, p, p0));
    store(h->third_after, select_lanes(yields, reached, yield));
    return answer;
}

/* Kinematic hardening; the third row is the back stress. */
static WB_ALWAYS_INLINE struct answer respond_moving(const struct wb_material *m, lanes strain,
                                                     const struct rows *h)
{
    const double E = m->youngs_modulus;
    const double H = wb_hardening_back_modulus(m);
    const lanes plastic = load(h->plastic);
    const lanes back = load(h->third);
    const lanes trial = E * (strain - plastic);
    const lanes distance = trial - back;
    const lanes over = absolute(distance) - m->yield_stress;
    const masks yields = over > on_surface * m->yield_stress;
    const lanes zero = 0.0 * strain;
    const lanes size = select_lanes(yields, over * (1.0 / (E + H)), zero);
    const lanes increment = with_sign(size, distance);
    const struct answer answer = {
        trial - E * increment,
        select_lanes(yields, zero + E * H / (E + H), zero + E),
    };

    store(h->plastic_after, plastic + increment);
    store(h->accumulated_after, load(h->accumulated) + size);
    store(h->third_after, back + H * increment);
    return answer;
}

static WB_ALWAYS_INLINE struct answer
respond_of(const struct wb_fibres *f, const struct batch *batch, lanes strain, const struct rows *h)
{
    const struct wb_material *m = &f->materials[batch->material];

    if (batch->grows)
        return respond_growing(m, batch->has_constant_exponent, &f->tables[batch->material], strain,
                               h);
    if (batch->moves)
        return respond_moving(m, strain, h);
    return respond_elastically(m, strain);
}

/* Adds the lanes in a fixed order, so that results do not depend on the vector width. */
static WB_ALWAYS_INLINE double add_lanes(lanes v)
{
    return (v[0] + v[2]) + (v[1] + v[3]);
}

/* Sums over the fibres of a section, lane by lane. Those with a y, about y, are of a section in
 * space. */
struct sums {
    bool in_space;
    lanes N, M, D11, D12, D22;
    lanes M_y, D1y, D2y, Dyy;
};

static WB_ALWAYS_INLINE lanes strain_at(const struct wb_fibres *f, int i, bool in_space,
                                        struct strains at)
{
    lanes strain = at.eps - load(f->y + i) * at.kappa;
    if (in_space)
        strain += load(f->z + i) * at.kappa_y;
    return strain;
}

static WB_ALWAYS_INLINE void add_fibres(struct sums *sums, const struct wb_fibres *f, int i,
                                        lanes force, lanes stiffness)
{
    const lanes y = load(f->y + i);
    sums->N += force;
    sums->M -= force * y;
    sums->D11 += stiffness;
    sums->D12 -= stiffness * y;
    sums->D22 += stiffness * y * y;
    if (!sums->in_space)
        return;
    const lanes z = load(f->z + i);
    sums->M_y += force * z;
    sums->D1y += stiffness * z;
    sums->D2y -= stiffness * y * z;
    sums->Dyy += stiffness * z * z;
}

static WB_ALWAYS_INLINE void take_sums(const struct sums *sums, struct wb_fibres_response *response)
{
    response->N = add_lanes(sums->N);
    response->M = add_lanes(sums->M);
    response->D11 = add_lanes(sums->D11);
    response->D12 = add_lanes(sums->D12);
    response->D22 = add_lanes(sums->D22);
}

static WB_ALWAYS_INLINE void respond_rows(const struct wb_fibres *f, struct strains strains,
                                          const double *rows, double *rows_after, struct sums *sums)
{
    for (int b = 0; b < f->n_materials; b++) {
        for (int i = f->batches[b].begin; i < f->batches[b].end; i += LANES) {
            const struct rows h = rows_at(f, rows, rows_after, i);
            const struct answer answer =
                respond_of(f, &f->batches[b], strain_at(f, i, sums->in_space, strains), &h);
            const lanes area = load(f->area + i);
            add_fibres(sums, f, i, answer.stress * area, answer.tangent * area);
        }
    }
}

/* The share of an overlay with isotropic hardening: the stress is that of the virgin curve at the
 * strain e = |trial| / E + p, where monotonic loading would have reached the same state. The third
 * row is the stress reached so far. */
static WB_ALWAYS_INLINE struct answer respond_overlay_growing(const struct wb_fibres *f,
                                                              lanes strain, const struct rows *h)
{
    const struct wb_overlay *const o = f->overlay;
    const double E = f->tail[0];
    const lanes plastic = load(h->plastic), p0 = load(h->accumulated), yield = load(h->third);
    const lanes trial = E * (strain - plastic);
    const lanes size = absolute(trial);
    const masks yields = size - yield > on_surface * yield;
    if (!any(yields)) {
        store(h->plastic_after, plastic);
        store(h->accumulated_after, p0);
        store(h->third_after, yield);
        return (struct answer){trial, E - (lanes){0}};
    }

    /* Parts with a yield strain below the smallest strain all yield; parts above the largest strain
     * are elastic and act as one stiffness. */
    const lanes virgin = size * f->compliance + p0;
    const double least = smallest_of(virgin), most = largest_of(virgin);
    int i = 0;
    while (i < o->n && o->yield_strain[i] <= least)
        i++;
    lanes reached = f->full[i] - (lanes){0}, tangent = {0};
    for (; i < o->n && o->yield_strain[i] <= most; i++) {
        const lanes corner = o->yield_strain[i] - (lanes){0};
        const masks below = virgin < corner;
        const lanes modulus = o->modulus[i] - (lanes){0};
        reached += modulus * select_lanes(below, virgin, corner);
        tangent += (lanes)(below & (masks)modulus);
    }
    reached += f->tail[i] * virgin;
    tangent += f->tail[i];
    const lanes p = virgin - reached * f->compliance;
    store(h->plastic_after, select_lanes(yields, plastic + with_sign(p - p0, trial), plastic));
    store(h->accumulated_after, select_lanes(yields, p, p0));
    store(h->third_after, select_lanes(yields, reached, yield));
    return (struct answer){select_lanes(yields, with_sign(reached, trial), trial),
                           select_lanes(yields, tangent, E - (lanes){0})};
}

/* Parts of an overlay that a step computes one by one: `before` parts have yielded earlier and have
 * history rows; up to `now` parts may yield in this step and get rows. The other parts are elastic
 * and act as one stiffness. */
struct active_parts {
    int before, now;
};

/* Adds a part with kinematic hardening, elastic up to its yield strain and perfectly plastic
 * beyond; returns its plastic strain. */
static WB_ALWAYS_INLINE lanes add_moving_part(struct answer *answer, const struct wb_overlay *o,
                                              int part, lanes strain, lanes plastic)
{
    const lanes modulus = o->modulus[part] - (lanes){0}, most = o->yield_strain[part] - (lanes){0};
    const lanes elastic = strain - plastic;
    const masks stays = absolute(elastic) < most;
    const lanes limit = (lanes)((masks)most | ((masks)elastic & sign_bit));
    const lanes kept = select_lanes(stays, elastic, limit);
    answer->stress += modulus * kept;
    answer->tangent += (lanes)(stays & (masks)modulus);
    return select_lanes(stays, plastic, strain - kept);
}

/* The share of an overlay with kinematic hardening: one history row for the plastic strain of each
 * part. */
static WB_ALWAYS_INLINE struct answer respond_overlay_moving(const struct wb_fibres *f,
                                                             struct active_parts active,
                                                             lanes strain, const double *rows,
                                                             double *rows_after)
{
    const struct wb_overlay *const o = f->overlay;
    const lanes tail = f->tail[active.now] - (lanes){0};
    const ptrdiff_t n = f->n;
    struct answer answer = {tail * strain, tail};
    int part = 0;
    for (; part < active.before; part++, rows += n, rows_after += n)
        store(rows_after, add_moving_part(&answer, o, part, strain, load(rows)));
    for (; part < active.now; part++, rows_after += n)
        store(rows_after, add_moving_part(&answer, o, part, strain, (lanes){0}));
    return answer;
}

/* Combined hardening of an overlay: the yield limit of a part grows with its accumulated plastic
 * strain, whose row follows the row of its plastic strain. */
static WB_ALWAYS_INLINE struct answer respond_overlay_combined(const struct wb_fibres *f,
                                                               struct active_parts active,
                                                               lanes strain, const double *rows,
                                                               double *rows_after)
{
    const struct wb_overlay *const o = f->overlay;
    const double kept = o->kept, growth = kept / (1.0 - kept);
    const lanes tail = f->tail[active.now] - (lanes){0}, zero = {0};
    const ptrdiff_t n = f->n;
    struct answer answer = {tail * strain, tail};
    for (int part = 0; part < active.now; part++, rows += 2 * n, rows_after += 2 * n) {
        const lanes plastic = part < active.before ? load(rows) : zero;
        const lanes accumulated = part < active.before ? load(rows + n) : zero;
        const lanes trial = strain - plastic;
        const lanes over = absolute(trial) - o->yield_strain[part] - growth * accumulated;
        const masks yields = over >= 0.0;
        const lanes step = select_lanes(yields, (1.0 - kept) * over, zero);
        const lanes signed_step = with_sign(step, trial);
        const double E = o->modulus[part];
        answer.stress += E * (trial - signed_step);
        answer.tangent += select_lanes(yields, all_lanes(kept * E), all_lanes(E));
        store(rows_after, plastic + signed_step);
        store(rows_after + n, accumulated + step);
    }
    return answer;
}

static WB_ALWAYS_INLINE void respond_overlay(const struct wb_fibres *f, struct strains strains,
                                             const double *before, double *after, struct sums *sums)
{
    const double beta = f->overlay->isotropic_share;
    struct active_parts active = {(int)before[1], (int)before[1]};
    while (active.now < f->overlay->n && f->overlay->yield_strain[active.now] <= strains.largest)
        active.now++;
    after[1] = active.now;
    const double *const rows = before + HISTORY_HEAD;
    double *const rows_after = after + HISTORY_HEAD;
    const double *const grown = rows + f->capacity * f->n;
    double *const grown_after = rows_after + f->capacity * f->n;

    for (int i = 0; i < f->n; i += LANES) {
        const struct rows h = rows_at(f, grown, grown_after, i);
        const lanes strain = strain_at(f, i, sums->in_space, strains);
        const lanes area = load(f->area + i);
        lanes force = {0}, stiffness = {0};
        if (beta < 1.0) {
            const struct answer moving =
                f->law.is_combined
                    ? respond_overlay_combined(f, active, strain, rows + i, rows_after + i)
                    : respond_overlay_moving(f, active, strain, rows + i, rows_after + i);
            force += (1.0 - beta) * moving.stress * area;
            stiffness += (1.0 - beta) * moving.tangent * area;
        }
        if (beta > 0.0) {
            const struct answer growing = respond_overlay_growing(f, strain, &h);
            force += beta * growing.stress * area;
            stiffness += beta * growing.tangent * area;
        }
        add_fibres(sums, f, i, force, stiffness);
    }
}

/* Ludwik's law with combined hardening: the surface grows by beta H and moves by the rest, and a
 * step has the plastic strain that isotropic hardening would give for
 *
 *     c = |trial - X_0| - sigma_Y + (1 - beta) H(p_0) + E p_0 = E p + H(p).
 *
 * The third row is H, the fourth the back stress X. */
static WB_ALWAYS_INLINE struct answer respond_combined(const struct wb_fibres *f, lanes strain,
                                                       const struct rows *h, const double *backs,
                                                       double *backs_after)
{
    const struct wb_material *const m = &f->materials[0];
    const double E = m->youngs_modulus, sigma_Y = m->yield_stress;
    const double beta = f->law.isotropic_share;
    const lanes plastic = load(h->plastic), p0 = load(h->accumulated), H0 = load(h->third);
    const lanes back = load(backs);
    const lanes trial = E * (strain - plastic), distance = trial - back;
    const lanes size = absolute(distance), yield = sigma_Y + beta * H0;
    const masks yields = size - yield > on_surface * yield;
    struct answer answer = {trial, all_lanes(E)};
    lanes p = p0, H = H0;
    if (any(yields)) {
        const lanes c = size - sigma_Y + (1.0 - beta) * H0 + E * p0;
        const lanes r = plastic_ratio(m, &f->tables[0], yields, c);
        const lanes power_part =
            exponents(m, f->batches[0].has_constant_exponent, r * c * (1.0 / E)) * (1.0 - r);
        p = select_lanes(yields, r * c * (1.0 / E), p0);
        H = select_lanes(yields, (1.0 - r) * c, H0);
        answer.stress = trial - with_sign(E * (p - p0), distance);
        answer.tangent = select_lanes(yields, E * power_part / (r + power_part), answer.tangent);
    }
    store(h->plastic_after, plastic + with_sign(p - p0, distance));
    store(h->accumulated_after, p);
    store(h->third_after, H);
    store(backs_after, back + with_sign((1.0 - beta) * (H - H0), distance));
    return answer;
}

/* One hardening stress of Chaboche's law in a step: room (1 - exp(-rate d)) for an increment d of
 * plastic strain; slope d if the rate is 0. */
struct term {
    lanes room;
    double rate, slope;
};

static WB_ALWAYS_INLINE lanes value_of(const struct term *term, lanes d, lanes *slope)
{
    if (term->rate == 0.0) {
        *slope += term->slope;
        return term->slope * d;
    }
    const lanes value = term->room * one_less_exponential(term->rate * d);
    *slope += term->rate * (term->room - value);
    return value;
}

/* Solves E d + sum of all terms = over by Newton's method. The sum is concave in d, so each Newton
 * step from any point ends below the solution. Lower bounds of d are the tangent at 0 and the value
 * with all terms saturated. The initial guess is the solution of the parabola of the first two
 * derivatives if that is close, else the lower bound. */
static WB_ALWAYS_INLINE lanes solve_terms(double E, const struct term *terms, int n, lanes over,
                                          lanes *values, lanes *slope)
{
    lanes first = all_lanes(E), second = {0}, all = {0};
    double last = E;
    for (int i = 0; i < n; i++) {
        const lanes begins = terms[i].rate * terms[i].room + terms[i].slope;
        first += begins;
        second += terms[i].rate * begins;
        all += terms[i].room;
        last += terms[i].slope;
    }
    const lanes enough = stress_tolerance * over;
    const lanes tangent = over / first, saturated = (over - all) * (1.0 / last);
    const lanes least = select_lanes(saturated > tangent, saturated, tangent);
    const lanes bend = 0.5 * second * tangent / first;
    lanes d = select_lanes((bend < 1.0) & (saturated < tangent), tangent * (1.0 + bend), least);
    for (int pass = 0; pass < MAX_PASSES; pass++) {
        lanes left = over - E * d;
        *slope = (lanes){0};
        for (int i = 0; i < n; i++) {
            values[i] = value_of(&terms[i], d, slope);
            left -= values[i];
        }
        if (!any(absolute(left) > enough))
            return d;
        const lanes next = d + left / (E + *slope);
        d = select_lanes(next > least, next, least);
    }
    return all_lanes((double)NAN); /* stress not found: the beam's iteration stops at NaN */
}

/* Chaboche's law. The strain is monotonic in a step, so the rates are integrated exactly: with the
 * increment d of plastic strain and the sign s of the distance from the back stress,
 *
 *     R = R_0 + (Q - R_0) (1 - exp(-b d)),
 *     s X_i = s X_i0 + (C_i / gamma_i - s X_i0) (1 - exp(-gamma_i d)),
 *     |trial - X_0| = sigma_Y + R + sum s (X_i - X_i0) + E d.
 *
 * The third row is R; the rows of the X_i follow. */
static WB_ALWAYS_INLINE struct answer respond_chaboche(const struct wb_fibres *f, lanes strain,
                                                       const struct rows *h, const double *backs,
                                                       double *backs_after)
{
    const struct wb_law *const law = &f->law;
    const double E = law->material.youngs_modulus, sigma_Y = law->material.yield_stress;
    const int n_backs = law->n_backs;
    const lanes plastic = load(h->plastic), grown = load(h->third), zero = {0};
    const lanes trial = E * (strain - plastic);
    lanes distance = trial;
    for (int i = 0; i < n_backs; i++)
        distance -= load(backs + i * (ptrdiff_t)f->n);
    const lanes over = absolute(distance) - sigma_Y - grown;
    const masks yields = over > on_surface * (sigma_Y + grown);
    struct answer answer = {trial, all_lanes(E)};
    lanes d = zero, values[1 + WB_LAW_MOST_BACKS] = {{0}, {0}, {0}, {0}};
    if (any(yields)) {
        struct term terms[1 + WB_LAW_MOST_BACKS] = {{law->saturation - grown, law->rate, 0.0}};
        lanes slope;
        for (int i = 0; i < n_backs; i++) {
            const struct wb_law_back *const back = &law->backs[i];
            const lanes X = with_sign(zero + 1.0, distance) * load(backs + i * (ptrdiff_t)f->n);
            terms[1 + i] = back->recovery > 0.0 ? (struct term){back->modulus / back->recovery - X,
                                                                back->recovery, 0.0}
                                                : (struct term){zero, 0.0, back->modulus};
        }
        d = solve_terms(E, terms, 1 + n_backs, select_lanes(yields, over, zero), values, &slope);
        answer.stress = trial - with_sign(E * d, distance);
        answer.tangent = select_lanes(yields, E * slope / (E + slope), answer.tangent);
    }
    store(h->plastic_after, plastic + with_sign(d, distance));
    store(h->accumulated_after, load(h->accumulated) + d);
    store(h->third_after, grown + values[0]);
    for (int i = 0; i < n_backs; i++)
        store(backs_after + i * (ptrdiff_t)f->n,
              load(backs + i * (ptrdiff_t)f->n) + with_sign(values[1 + i], distance));
    return answer;
}

/* All fibres of a section with a law of combined hardening. */
static WB_ALWAYS_INLINE void respond_law(const struct wb_fibres *f, struct strains strains,
                                         const double *before, double *after, struct sums *sums)
{
    const double *const rows = before + HISTORY_HEAD;
    double *const rows_after = after + HISTORY_HEAD;
    for (int i = 0; i < f->n; i += LANES) {
        const struct rows h = rows_at(f, rows, rows_after, i);
        const double *const backs = rows + HISTORY_ROWS * f->n + i;
        double *const backs_after = rows_after + HISTORY_ROWS * f->n + i;
        const lanes strain = strain_at(f, i, sums->in_space, strains);
        const struct answer answer = f->kind == CHABOCHE
                                         ? respond_chaboche(f, strain, &h, backs, backs_after)
                                         : respond_combined(f, strain, &h, backs, backs_after);
        const lanes area = load(f->area + i);
        add_fibres(sums, f, i, answer.stress * area, answer.tangent * area);
    }
}

/* Point laws, one fibre after another: the history of a fibre is contiguous. */
static void respond_points(const struct wb_fibres *f, struct strains strains, const double *before,
                           double *after, struct wb_fibres_response *response)
{
    const double *const rows = before + HISTORY_HEAD;
    double *const rows_after = after + HISTORY_HEAD;
    *response = (struct wb_fibres_response){0};
    for (int b = 0; b < f->n_materials; b++) {
        const struct wb_point_law *const law = &f->point_laws[f->batches[b].material];
        for (int i = f->batches[b].begin; i < f->batches[b].end; i++) {
            const double y = f->y[i], area = f->area[i];
            double stress = 0.0, tangent = 0.0;
            if (area > 0.0)
                law->respond(law->context, strains.eps - y * strains.kappa,
                             rows + f->point_history * i, rows_after + f->point_history * i,
                             &stress, &tangent);
            response->N += stress * area;
            response->M -= stress * area * y;
            response->D11 += tangent * area;
            response->D12 -= tangent * area * y;
            response->D22 += tangent * area * y * y;
        }
    }
}

/* Adds the fibres of a section of any kind of material, chosen at run time. */
static WB_ALWAYS_INLINE void add_any(const struct wb_fibres *f, struct strains strains,
                                     const double *before, double *after, struct sums *sums)
{
    if (f->kind == AS_OVERLAY)
        respond_overlay(f, strains, before, after, sums);
    else if (f->kind == LUDWIK_COMBINED || f->kind == CHABOCHE)
        respond_law(f, strains, before, after, sums);
    else
        respond_rows(f, strains, before + HISTORY_HEAD, after + HISTORY_HEAD, sums);
}

static WB_ALWAYS_INLINE void respond_any(const struct wb_fibres *f, struct strains strains,
                                         const double *before, double *after,
                                         struct wb_fibres_response *response)
{
    struct sums sums = {.in_space = false};
    add_any(f, strains, before, after, &sums);
    take_sums(&sums, response);
}

static WB_ALWAYS_INLINE void respond_in_space(const struct wb_fibres *f, struct strains strains,
                                              const double *before, double *after,
                                              struct wb_fibres_space_response *response)
{
    struct sums sums = {.in_space = true};
    add_any(f, strains, before, after, &sums);
    take_sums(&sums, &response->plane);
    response->M_y = add_lanes(sums.M_y);
    response->D1y = add_lanes(sums.D1y);
    response->D2y = add_lanes(sums.D2y);
    response->Dyy = add_lanes(sums.Dyy);
}

/* The two functions compiled for an instruction set. No variant contracts a * b + c, so all
 * variants return identical bits. */
#define DEFINE_VARIANT(name, attribute)                                                            \
    attribute static void respond_##name(const struct wb_fibres *f, struct strains strains,        \
                                         const double *before, double *after,                      \
                                         struct wb_fibres_response *response)                      \
    {                                                                                              \
        respond_any(f, strains, before, after, response);                                          \
    }                                                                                              \
    attribute static void respond_##name##_in_space(                                               \
        const struct wb_fibres *f, struct strains strains, const double *before, double *after,    \
        struct wb_fibres_space_response *response)                                                 \
    {                                                                                              \
        respond_in_space(f, strains, before, after, response);                                     \
    }

DEFINE_VARIANT(portably, )
#ifdef WB_HAS_X86_VARIANTS
DEFINE_VARIANT(avx2, WB_AVX2)
DEFINE_VARIANT(avx512, WB_AVX512)
#endif

static void choose_fastest(struct wb_fibres *fibres)
{
    wb_fibres_set_portable(fibres);
    if (fibres->point_laws) {
        fibres->respond = respond_points;
        return;
    }
#ifdef WB_HAS_X86_VARIANTS
    if (wb_processor_has_avx512()) {
        fibres->respond = respond_avx512;
        fibres->respond_in_space = respond_avx512_in_space;
    } else if (wb_processor_has_avx2()) {
        fibres->respond = respond_avx2;
        fibres->respond_in_space = respond_avx2_in_space;
    }
#endif
}

enum wb_status wb_fibres_create(struct wb_fibres **out, const struct wb_section *section)
{
    *out = NULL;
    if (section->n_fibres < 1 || section->n_materials < 1)
        return wb_fail(WB_ERR_ARGUMENT, "the section has no fibres");

    struct wb_fibres *const f = wb_memory_new(1, sizeof *f);

    int n = 0;
    for (int m = 0; m < section->n_materials; m++) {
        for (int i = 0; i < section->n_fibres; i++)
            n += section->fibres[i].material == m;
        n = padded(n);
    }
    const size_t count = (size_t)n, materials = (size_t)section->n_materials;
    f->n = n;
    f->n_materials = section->n_materials;
    f->point_laws = section->point_laws;
    f->kind = section->law ? kind_of(section->law) : f->point_laws ? BY_POINT_LAW : BY_MATERIAL;
    f->capacity = section->law ? rows_of(section->law) : 0;
    if (f->kind == AS_OVERLAY)
        f->overlay = wb_memory_take(&f->memory, 1, sizeof *f->overlay);
    for (int m = 0; f->point_laws && m < section->n_materials; m++)
        f->point_history = f->point_laws[m].n_history > f->point_history
                               ? f->point_laws[m].n_history
                               : f->point_history;
    f->y = wb_memory_take(&f->memory, count, sizeof *f->y);
    f->z = wb_memory_take(&f->memory, count, sizeof *f->z);
    f->area = wb_memory_take(&f->memory, count, sizeof *f->area);
    f->virgin = wb_memory_take(&f->memory, HISTORY_HEAD + (size_t)history_rows(f) * count,
                               sizeof *f->virgin);
    f->batches = wb_memory_take(&f->memory, materials, sizeof *f->batches);
    f->materials = wb_memory_take(&f->memory, materials, sizeof *f->materials);
    f->tables = wb_memory_take(&f->memory, materials, sizeof *f->tables);

    sort_fibres(f, section);
    choose_fastest(f);
    f->duration = (double)INFINITY;
    f->shear_ratio = 1.0;
    if (section->law) {
        f->materials[0] = section->materials[0];
        if (wb_fibres_set_law(f, section->law) != WB_OK) {
            wb_fibres_destroy(f);
            return WB_ERR_ARGUMENT;
        }
    } else {
        wb_fibres_set_materials(f, section->materials);
    }
    if (f->point_laws)
        f->yield_strain = 0.0;
    f->shear_ratio = section->shear_stiffness / f->shear_stiffness;
    f->shear_stiffness = section->shear_stiffness;
    *out = f;
    return WB_OK;
}

void wb_fibres_set_portable(struct wb_fibres *fibres)
{
    fibres->respond = respond_portably;
    fibres->respond_in_space = respond_portably_in_space;
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

static void add_maxwell(const struct wb_fibres *f, double eps, double kappa, const double *before,
                        double *after, struct wb_fibres_response *response)
{
    const double d_eps = eps - before[HISTORY_EPS], d_kappa = kappa - before[HISTORY_KAPPA];
    after[HISTORY_EPS] = eps;
    after[HISTORY_KAPPA] = kappa;
    for (int i = 0; i < f->law.n_maxwell; i++) {
        const struct wb_law_maxwell_step *const step = &f->maxwell[i];
        const double ratio = step->tangent / f->materials[0].youngs_modulus;
        const int at = HISTORY_MAXWELL + 2 * i;
        after[at] = step->decay * before[at] + ratio * (f->EA * d_eps + f->ES * d_kappa);
        after[at + 1] = step->decay * before[at + 1] + ratio * (f->ES * d_eps + f->EI * d_kappa);
        response->N += after[at];
        response->M += after[at + 1];
        response->D11 += ratio * f->EA;
        response->D12 += ratio * f->ES;
        response->D22 += ratio * f->EI;
    }
}

void wb_fibres_respond(const struct wb_fibres *f, double eps, double kappa,
                       const double *restrict before, double *restrict after,
                       struct wb_fibres_response *restrict response)
{
    const bool yielded = before[0] != 0.0;
    const struct strains strains = {eps, kappa, 0.0, fabs(eps) + f->outermost * fabs(kappa)};

    if (!yielded && strains.largest <= f->yield_strain) {
        after[0] = 0.0;
        respond_virgin(f, eps, kappa, response);
    } else {
        after[0] = 1.0;
        f->respond(f, strains, yielded ? before : f->virgin, after, response);
    }
    if (f->law.n_maxwell > 0)
        add_maxwell(f, eps, kappa, before, after, response);
}

/* Elastic forces and stiffness of all fibres, `ratio` times. */
static void add_elastic_in_space(const struct wb_fibres *f, double ratio, struct strains at,
                                 double force[3], struct wb_fibres_space_response *response)
{
    force[0] += ratio * (f->EA * at.eps + f->ES * at.kappa + f->ES_y * at.kappa_y);
    force[1] += ratio * (f->ES * at.eps + f->EI * at.kappa + f->EI_yz * at.kappa_y);
    force[2] += ratio * (f->ES_y * at.eps + f->EI_yz * at.kappa + f->EI_y * at.kappa_y);
    response->plane.N += force[0];
    response->plane.M += force[1];
    response->M_y += force[2];
    response->plane.D11 += ratio * f->EA;
    response->plane.D12 += ratio * f->ES;
    response->plane.D22 += ratio * f->EI;
    response->D1y += ratio * f->ES_y;
    response->D2y += ratio * f->EI_yz;
    response->Dyy += ratio * f->EI_y;
}

static void add_maxwell_in_space(const struct wb_fibres *f, struct strains at, const double *before,
                                 double *after, struct wb_fibres_space_response *response)
{
    const struct strains change = {at.eps - before[HISTORY_EPS], at.kappa - before[HISTORY_KAPPA],
                                   at.kappa_y - before[HISTORY_KAPPA_Y], 0.0};
    after[HISTORY_EPS] = at.eps;
    after[HISTORY_KAPPA] = at.kappa;
    after[HISTORY_KAPPA_Y] = at.kappa_y;
    for (int i = 0; i < f->law.n_maxwell; i++) {
        const int row = HISTORY_MAXWELL + 2 * i, row_y = HISTORY_MAXWELL_Y + i;
        const double decay = f->maxwell[i].decay;
        double force[3] = {decay * before[row], decay * before[row + 1], decay * before[row_y]};
        add_elastic_in_space(f, f->maxwell[i].tangent / f->materials[0].youngs_modulus, change,
                             force, response);
        after[row] = force[0];
        after[row + 1] = force[1];
        after[row_y] = force[2];
    }
}

void wb_fibres_respond_in_space(const struct wb_fibres *f, double eps, double kappa_y,
                                double kappa_z, const double *restrict before,
                                double *restrict after,
                                struct wb_fibres_space_response *restrict response)
{
    const bool yielded = before[0] != 0.0;
    const struct strains strains = {eps, kappa_z, kappa_y,
                                    fabs(eps) + f->outermost * hypot(kappa_y, kappa_z)};

    if (!yielded && strains.largest <= f->yield_strain) {
        double force[3] = {0};
        after[0] = 0.0;
        *response = (struct wb_fibres_space_response){{0}, 0.0, 0.0, 0.0, 0.0};
        add_elastic_in_space(f, 1.0, strains, force, response);
    } else {
        after[0] = 1.0;
        f->respond_in_space(f, strains, yielded ? before : f->virgin, after, response);
    }
    if (f->law.n_maxwell > 0)
        add_maxwell_in_space(f, strains, before, after, response);
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
