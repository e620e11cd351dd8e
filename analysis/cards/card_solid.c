#include "analysis/cards/card_solid.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>

#include "base/circle.h"

#define WB_LOG_DOMAIN "card"

enum {
    MOST_POINTS = 120, /* of a table; CalculiX permits 200 */
    NAME = 72          /* bytes of a material's name; both programs permit 80 characters */
};

/* Total strain at which tables end; Poisson's ratio of overlaid parts; largest Poisson's ratio for
 * displacement elements. */
static const double last_strain = 0.1, overlay_poisson = 0.49, largest_poisson = 0.499;

struct dialect {
    const char *kind, *elastic, *plastic;
    bool has_combined;  /* the program has combined hardening with saturating back stresses */
    const char *advice; /* on elements, after the common one */
};

/* Plastic table of a virgin curve; n = 0: elastic. */
struct table {
    int n;
    double stress[MOST_POINTS]; /* Pa */
    double strain[MOST_POINTS]; /* plastic, 1 */
    double error;               /* of its chords, relative to the stress */
};

struct material {
    char name[NAME + 16];
    double density, modulus, poisson;
    const struct table *table; /* its stresses are multiplied by `share` */
    double share;
};

/* --- tables --- */

/* Tabulates sigma_Y + K p^n at plastic strains such that the chords deviate from the curve by at
 * most `error` of the stress: in terms of x = ln p the chord of the power law has a relative error
 * of n |1 - n| dx^2 / 8. False if that needs too many points. */
static bool try_ludwik(const struct wb_material *m, double error, struct table *table)
{
    const double n = m->hardening_exponent, K = m->strength_coefficient;
    const double first = pow(error * m->yield_stress / K, 1.0 / n);
    const double step = fmin(log(2.0), sqrt(8.0 * error / (n * fabs(1.0 - n) + error)));
    *table = (struct table){.n = 1, .stress = {m->yield_stress}, .error = error};
    for (double p = first; table->n < MOST_POINTS; p *= exp(step)) {
        const bool is_last = p >= last_strain;
        if (is_last)
            p = last_strain;
        table->stress[table->n] = m->yield_stress + K * pow(p, n);
        table->strain[table->n++] = p;
        if (is_last)
            return true;
    }
    return false;
}

static void tabulate_ludwik(const struct wb_material *m, struct table *table)
{
    *table = (struct table){.n = 1, .stress = {m->yield_stress}};
    if (m->strength_coefficient <= 0.0)
        return;
    for (double error = 2e-4; !try_ludwik(m, error, table); error *= 1.25) {
    }
}

/* The curve of parallel parts is piecewise linear with corners where they yield, so the table is
 * exact. */
static void tabulate_parallel(const struct wb_law *law, struct table *table)
{
    const double E = law->material.youngs_modulus;
    *table = (struct table){.n = 0};
    for (int i = 0; i < law->n_parts && isfinite(law->parts[i].yield_strain); i++) {
        const double e = law->parts[i].yield_strain;
        const double stress = wb_law_virgin_stress(law, e, NULL);
        table->stress[table->n] = stress;
        table->strain[table->n++] = i == 0 ? 0.0 : e - stress / E;
    }
    const double end = wb_law_virgin_stress(law, last_strain, NULL);
    if (table->n > 0 && end > table->stress[table->n - 1]) {
        table->stress[table->n] = end;
        table->strain[table->n++] = last_strain - end / E;
    }
}

/* Chaboche's virgin curve, at plastic strains that increase by a factor, starting at a thousandth
 * of the yield strain. */
static void tabulate_chaboche(const struct wb_law *law, struct table *table)
{
    const double E = law->material.youngs_modulus;
    const double first = 1e-3 * law->material.yield_stress / E;
    *table = (struct table){.n = 1, .stress = {law->material.yield_stress}};
    for (int i = 0; i < MOST_POINTS - 1; i++) {
        const double wanted = first * pow(last_strain / first, (double)i / (MOST_POINTS - 2));
        /* The total strain at this plastic strain; the stress increases with both. */
        double strain = wanted;
        for (int pass = 0; pass < 100; pass++) {
            double tangent;
            const double stress = wb_law_virgin_stress(law, strain, &tangent);
            const double off = wanted - (strain - stress / E);
            const double slope = fmax(1.0 - tangent / E, 1e-3);
            strain += off / slope;
            if (fabs(off) < 1e-12 * wanted)
                break;
        }
        const double stress = wb_law_virgin_stress(law, strain, NULL);
        table->stress[table->n] = stress;
        table->strain[table->n++] = strain - stress / E;
    }
}

static void tabulate(const struct wb_law *law, struct table *table)
{
    if (law->form == WB_LAW_LUDWIK)
        tabulate_ludwik(&law->material, table);
    else if (law->form == WB_LAW_PARALLEL)
        tabulate_parallel(law, table);
    else
        tabulate_chaboche(law, table);
}

/* --- keywords --- */

static void put_material(struct wb_text *text, const struct dialect *dialect,
                         const struct material *m)
{
    /* CalculiX reads at most 20 characters of a number. */
    wb_text_append(text, "*MATERIAL, NAME=%s\n", m->name);
    if (m->density > 0.0)
        wb_text_append(text, "*DENSITY\n%.8e\n", m->density);
    wb_text_append(text, "%s\n%.10e, %.6f\n", dialect->elastic, m->modulus, m->poisson);
    if (m->table->n > 0)
        wb_text_append(text, "%s\n", dialect->plastic);
    for (int i = 0; i < m->table->n; i++)
        wb_text_append(text, "%.10e, %.10e\n", m->share * m->table->stress[i], m->table->strain[i]);
}

/* The name of the material from that of the wire: letters, digits and underscores, after a
 * letter. */
static void make_name(char name[NAME], const char *wire)
{
    snprintf(name, NAME, "WIRE_%.60s", wire);
    for (char *c = name; *c; c++)
        *c = (char)(isalnum((unsigned char)*c) ? toupper((unsigned char)*c) : '_');
}

static int count_sets(const struct wb_overlay *overlay)
{
    return (overlay->isotropic_share < 1.0 ? overlay->n : 0) +
           (overlay->isotropic_share > 0.0 ? 1 : 0);
}

static void put_overlay(struct wb_text *text, const struct dialect *dialect,
                        const struct wb_law *law, const char *name, double density)
{
    struct wb_overlay overlay;
    wb_law_overlay(law, &overlay);
    const double kinematic = 1.0 - overlay.isotropic_share;
    const int n = count_sets(&overlay);
    struct table table;
    struct material m = {
        .density = density / n, .poisson = overlay_poisson, .table = &table, .share = 1.0};
    wb_text_append(text,
                   "** %d coincident sets of elements: copy the wire's elements %d times, on the "
                   "same nodes,\n"
                   "** and give each copy one of the %d materials below; their "
                   "stresses add up. Poisson's ratio is %g,\n"
                   "** not that of the law, so that the "
                   "parts do not constrain each other transversely.\n",
                   n, n, n, overlay_poisson);
    for (int i = 0; i < overlay.n && kinematic > 0.0; i++) {
        const double E = kinematic * overlay.modulus[i], e = overlay.yield_strain[i];
        table = (struct table){.n = isfinite(e), .stress = {E * e}};
        if (isfinite(e) && overlay.kept > 0.0) {
            table.n = 2;
            table.strain[1] = last_strain;
            table.stress[1] = E * (e + overlay.kept / (1.0 - overlay.kept) * last_strain);
        }
        m.modulus = E;
        snprintf(m.name, sizeof m.name, "%s_PART%d", name, i + 1);
        put_material(text, dialect, &m);
    }
    if (overlay.isotropic_share > 0.0) {
        tabulate(law, &table);
        m.share = overlay.isotropic_share;
        m.modulus = m.share * law->material.youngs_modulus;
        snprintf(m.name, sizeof m.name, "%s_ISOTROPIC", name);
        put_material(text, dialect, &m);
    }
}

static void put_plain(struct wb_text *text, const struct dialect *dialect, const struct wb_law *law,
                      const char *name, double density)
{
    struct table table;
    struct material m = {.density = density,
                         .modulus = law->material.youngs_modulus,
                         .poisson = law->material.poissons_ratio,
                         .table = &table,
                         .share = 1.0};
    tabulate(law, &table);
    snprintf(m.name, sizeof m.name, "%s", name);
    if (law->form == WB_LAW_CHABOCHE ? law->n_backs > 0
                                     : law->is_combined && law->isotropic_share < 1.0)
        wb_text_append(
            text,
            "** The law's hardening is partly kinematic, in a form that this program does not "
            "support. The table is\n"
            "** isotropic: valid for a first loading, not for unloading.\n");
    if (table.error > 0.0)
        wb_text_append(
            text,
            "** The chords of the table deviate by at most %.2g of the stress from the curve.\n",
            table.error);
    put_material(text, dialect, &m);
}

/* Back stresses and growth of the yield stress in the program's form. */
static void put_chaboche(struct wb_text *text, const struct dialect *dialect,
                         const struct wb_law *law, const char *name, double density)
{
    const struct table none = {.n = 0};
    struct material m = {.density = density,
                         .modulus = law->material.youngs_modulus,
                         .poisson = law->material.poissons_ratio,
                         .table = &none,
                         .share = 1.0};
    snprintf(m.name, sizeof m.name, "%s", name);
    put_material(text, dialect, &m);
    wb_text_append(text,
                   "*PLASTIC, HARDENING=COMBINED, DATA TYPE=PARAMETERS, NUMBER BACKSTRESSES=%d\n"
                   "%.10e",
                   law->n_backs, law->material.yield_stress);
    for (int i = 0; i < law->n_backs; i++)
        wb_text_append(text, ", %.10e, %.10e", law->backs[i].modulus, law->backs[i].recovery);
    wb_text_append(text, "\n*CYCLIC HARDENING, PARAMETERS\n%.10e, %.10e, %.10e\n",
                   law->material.yield_stress, law->saturation, law->rate);
}

static enum wb_status write(const struct dialect *dialect, const struct wb_card_source *source,
                            struct wb_text *text, struct wb_reason *why)
{
    const struct wb_properties *const p = &source->properties;
    const double area = wb_circle_area(p->outer_diameter);
    char name[NAME];
    if (p->law.material.poissons_ratio > largest_poisson)
        return wb_fail_to(why, WB_ERR_UNSUPPORTED,
                          "%s: poissons_ratio is %g, expected at most %g: solid elements lock with "
                          "nearly incompressible materials",
                          source->file, p->law.material.poissons_ratio, largest_poisson);
    make_name(name, p->wire);
    wb_card_source_append(source, dialect->kind, "** ", text);
    const bool is_native =
        p->law.form == WB_LAW_CHABOCHE && dialect->has_combined && p->law.n_backs > 0;
    if (!is_native)
        wb_text_append(
            text,
            "** Plastic tables: true stress, logarithmic plastic strain; the first at zero plastic "
            "strain. They end\n"
            "** at a strain of %g, beyond which the stress is constant.",
            last_strain);
    wb_text_append(text, "%s Use steps with NLGEOM.\n** %s\n", is_native ? "**" : "",
                   dialect->advice);
    if (!(p->mass_per_length > 0.0))
        wb_text_append(text,
                       "** The wire's mass is unknown: without density, for static steps only.\n");
    if (is_native)
        put_chaboche(text, dialect, &p->law, name, p->mass_per_length / area);
    else if (!wb_law_is_overlay(&p->law) || p->law.isotropic_share >= 1.0)
        put_plain(text, dialect, &p->law, name, p->mass_per_length / area);
    else
        put_overlay(text, dialect, &p->law, name, p->mass_per_length / area);
    return WB_OK;
}

enum wb_status wb_card_solid_calculix(const struct wb_card_source *source,
                                      const struct wb_card_settings *settings, struct wb_text *text,
                                      struct wb_reason *why)
{
    static const struct dialect dialect = {
        .kind = "CalculiX card",
        .elastic = "*ELASTIC",
        .plastic = "*PLASTIC",
        .advice = "Elements: C3D20R. Include with *INCLUDE, INPUT=FILE; the density is in kg/m3.",
    };
    (void)settings;
    return write(&dialect, source, text, why);
}

enum wb_status wb_card_solid_abaqus(const struct wb_card_source *source,
                                    const struct wb_card_settings *settings, struct wb_text *text,
                                    struct wb_reason *why)
{
    static const struct dialect dialect = {
        .kind = "Abaqus card (NOT RUN: written from the manual's keywords and never run in Abaqus)",
        .elastic = "*ELASTIC, TYPE=ISOTROPIC",
        .plastic = "*PLASTIC, HARDENING=ISOTROPIC",
        .has_combined = true,
        .advice = "Elements: C3D20R, or C3D20RH if Poisson's ratio is close to 0.5. Include with "
                  "*INCLUDE, INPUT=FILE.",
    };
    (void)settings;
    return write(&dialect, source, text, why);
}
