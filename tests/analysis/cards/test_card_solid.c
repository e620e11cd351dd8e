/* Cards of solid elements, parsed keyword by keyword: their parts together are the law. */
#include <stdlib.h>

#include "tests/analysis/cards/wires.h"

enum {
    MOST_MATERIALS = 40,
    MOST_POINTS = 200 /* limit of CalculiX */
};

struct material {
    char name[90];
    double density, modulus, poisson;
    int n;
    double stress[MOST_POINTS], strain[MOST_POINTS];
};

struct card {
    int n;
    struct material materials[MOST_MATERIALS];
};

/* Stores the values of a line, according to its keyword. */
static void take(struct material *m, const char *keyword, const char *line)
{
    double a, b;
    const int n = sscanf(line, "%lf, %lf", &a, &b);
    if (strncmp(keyword, "*DENSITY", 8) == 0 && n == 1) {
        m->density = a;
    } else if (strncmp(keyword, "*ELASTIC", 8) == 0 && n == 2) {
        m->modulus = a;
        m->poisson = b;
    } else if (strncmp(keyword, "*PLASTIC", 8) == 0 && n == 2) {
        assert_true(m->n < MOST_POINTS);
        m->stress[m->n] = a;
        m->strain[m->n++] = b;
    } else {
        fail_msg("unexpected line '%s' after '%s'", line, keyword);
    }
}

/* Reads a card; `plastic` is the keyword of its tables. */
static void read_card(const char *kind, const char *plastic, const char *properties,
                      struct card *card)
{
    const struct wb_card_source source = source_of(properties);
    const struct wb_card_settings settings = card_defaults();
    struct wb_text text = card_of(kind, &source, &settings);
    char *rest = NULL;
    const char *keyword = "";
    memset(card, 0, sizeof *card);
    for (char *line = strtok_r(text.bytes, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
        assert_true(strlen(line) < 256);
        if (strncmp(line, "**", 2) == 0)
            continue;
        if (line[0] != '*') {
            assert_true(card->n > 0);
            take(&card->materials[card->n - 1], keyword, line);
            continue;
        }
        keyword = line;
        if (strncmp(line, "*MATERIAL, NAME=", 16) == 0)
            snprintf(card->materials[card->n++].name, 90, "%s", line + 16);
        else if (strncmp(line, "*PLASTIC", 8) == 0)
            assert_string_equal(line, plastic);
    }
    wb_text_release(&text);
}

/* Stress of one material under a uniaxial, monotonic total strain: the point of the table at which
 * stress over E and plastic strain add up to it. */
static double stress_of(const struct material *m, double strain)
{
    if (m->n == 0 || m->modulus * strain <= m->stress[0])
        return m->modulus * strain;
    for (int i = 1; i < m->n; i++) {
        const double end = m->stress[i] / m->modulus + m->strain[i];
        const double start = m->stress[i - 1] / m->modulus + m->strain[i - 1];
        if (strain <= end)
            return m->stress[i - 1] +
                   (m->stress[i] - m->stress[i - 1]) * (strain - start) / (end - start);
    }
    return m->stress[m->n - 1];
}

static void compare_with_law(const struct card *card, const char *properties, double tolerance)
{
    const struct wb_card_source source = source_of(properties);
    for (double strain = 1e-5; strain < 0.08; strain *= 1.07) {
        double sum = 0.0;
        for (int i = 0; i < card->n; i++)
            sum += stress_of(&card->materials[i], strain);
        assert_close_relative(sum, wb_law_virgin_stress(&source.properties.law, strain, NULL),
                              tolerance);
    }
}

static const struct {
    const char *kind, *plastic;
} kinds[] = {{"calculix", "*PLASTIC"}, {"abaqus", "*PLASTIC, HARDENING=ISOTROPIC"}};

static struct card card;

static void materials_together_are_the_law(void **state)
{
    (void)state;
    static const struct {
        const char *properties;
        int materials;
        double tolerance;
    } cases[] = {
        {PROPERTIES, 1, 3e-4},
        {PROPERTIES "law: {form: ludwik, hardening: kinematic}\n", WB_LAW_LUDWIK_PARTS, 2e-2},
        {PROPERTIES ISOTROPIC, 1, 1e-6},
        {PROPERTIES KINEMATIC, 4, 1e-6},
        {PROPERTIES MIXED, 5, 1e-6},
        {PROPERTIES GROWING, 4, 1e-6},
    };
    for (size_t k = 0; k < WB_COUNT(kinds); k++) {
        for (size_t i = 0; i < WB_COUNT(cases); i++) {
            read_card(kinds[k].kind, kinds[k].plastic, cases[i].properties, &card);
            assert_int_equal(card.n, cases[i].materials);
            compare_with_law(&card, cases[i].properties, cases[i].tolerance);
        }
    }
}

/* State of a material with isotropic hardening under a varying uniaxial strain. */
struct point {
    double plastic, accumulated; /* plastic strain, and the sum of its absolute changes */
};

static double flow_stress(const struct material *m, double accumulated)
{
    for (int i = 1; i < m->n; i++) {
        if (accumulated <= m->strain[i])
            return m->stress[i - 1] + (m->stress[i] - m->stress[i - 1]) *
                                          (accumulated - m->strain[i - 1]) /
                                          (m->strain[i] - m->strain[i - 1]);
    }
    return m->stress[m->n - 1];
}

/* Stress of a material after its total strain changed monotonically to `strain`. */
static double strain_to(const struct material *m, double strain, struct point *point)
{
    const double trial = m->modulus * (strain - point->plastic);
    double low = 0.0, high = fabs(trial) / m->modulus;
    if (m->n == 0 || fabs(trial) <= flow_stress(m, point->accumulated))
        return trial;
    for (int i = 0; i < 60; i++) {
        const double step = 0.5 * (low + high);
        if (fabs(trial) - m->modulus * step > flow_stress(m, point->accumulated + step))
            low = step;
        else
            high = step;
    }
    point->plastic += copysign(low, trial);
    point->accumulated += low;
    return trial - copysign(m->modulus * low, trial);
}

/* Stress of the law at a strain after loading up to `top`, in closed form. */
static double unloaded_stress(const struct wb_law *law, double top, double strain)
{
    const double E = law->material.youngs_modulus, beta = law->isotropic_share;
    if (law->is_combined) { /* each part hardens isotropically with the modulus beta E_i */
        double sum = 0.0;
        for (int i = 0; i < law->n_parts; i++) {
            const double modulus = law->parts[i].modulus, yield = law->parts[i].yield_strain;
            const double highest = modulus * (top <= yield ? top : yield + beta * (top - yield));
            const double reversal = top - 2.0 * highest / modulus;
            sum += top <= yield || strain >= reversal
                       ? highest - modulus * (top - strain)
                       : -highest - beta * modulus * (reversal - strain);
        }
        return sum;
    }
    const double highest = wb_law_virgin_stress(law, top, NULL);
    const double reversal = top - 2.0 * highest / E;
    const double kinematic = highest - 2.0 * wb_law_virgin_stress(law, 0.5 * (top - strain), NULL);
    const double isotropic = strain >= reversal
                                 ? highest - E * (top - strain)
                                 : -wb_law_virgin_stress(law, top + reversal - strain, NULL);
    return beta * isotropic + (1.0 - beta) * kinematic;
}

static void materials_together_unload_as_the_law(void **state)
{
    (void)state;
    static const char *const cases[] = {PROPERTIES ISOTROPIC, PROPERTIES KINEMATIC,
                                        PROPERTIES MIXED, PROPERTIES GROWING};
    const double top = 0.012;
    for (size_t k = 0; k < WB_COUNT(kinds); k++) {
        for (size_t c = 0; c < WB_COUNT(cases); c++) {
            const struct wb_card_source source = source_of(cases[c]);
            struct point points[MOST_MATERIALS] = {{0.0, 0.0}};
            read_card(kinds[k].kind, kinds[k].plastic, cases[c], &card);
            for (int i = 0; i < card.n; i++)
                strain_to(&card.materials[i], top, &points[i]);
            for (double strain = top; strain > -top; strain -= 0.1 * top) {
                double sum = 0.0;
                for (int i = 0; i < card.n; i++)
                    sum += strain_to(&card.materials[i], strain, &points[i]);
                assert_close(sum, unloaded_stress(&source.properties.law, top, strain), 50.0);
            }
        }
    }
}

/* Combined hardening is that of the program if it has it; otherwise the card has the virgin curve
 * and states that. */
static void combined_hardening_is_native_or_a_first_loading(void **state)
{
    (void)state;
    for (size_t k = 0; k < WB_COUNT(kinds); k++) {
        read_card(kinds[k].kind, kinds[k].plastic, PROPERTIES COMBINED, &card);
        assert_int_equal(card.n, 1);
        compare_with_law(&card, PROPERTIES COMBINED, 3e-4);
    }
    read_card("calculix", "*PLASTIC", PROPERTIES CHABOCHE, &card);
    assert_int_equal(card.n, 1);
    compare_with_law(&card, PROPERTIES CHABOCHE, 1e-3);

    const struct wb_card_settings settings = card_defaults();
    const struct wb_card_source source = source_of(PROPERTIES CHABOCHE);
    struct wb_text text = card_of("calculix", &source, &settings);
    assert_non_null(strstr(wb_text_string(&text), "not for unloading"));
    wb_text_release(&text);
    text = card_of("abaqus", &source, &settings);
    assert_null(strstr(wb_text_string(&text), "not for unloading"));
    const char *const plastic =
        strstr(wb_text_string(&text),
               "*PLASTIC, HARDENING=COMBINED, DATA TYPE=PARAMETERS, NUMBER BACKSTRESSES=2\n");
    const char *const cyclic = strstr(wb_text_string(&text), "*CYCLIC HARDENING, PARAMETERS\n");
    double n[5], g[3];
    assert_true(plastic && cyclic);
    assert_int_equal(
        sscanf(strchr(plastic, '\n'), "%lf, %lf, %lf, %lf, %lf", n, n + 1, n + 2, n + 3, n + 4), 5);
    assert_int_equal(sscanf(strchr(cyclic, '\n'), "%lf, %lf, %lf", g, g + 1, g + 2), 3);
    static const double expected[] = {2e6, 2.6e9, 900.0, 0.7e9, 60.0}, grows[] = {2e6, 1.5e6, 250};
    for (int i = 0; i < 5; i++)
        assert_close_relative(n[i], expected[i], 1e-9);
    for (int i = 0; i < 3; i++)
        assert_close_relative(g[i], grows[i], 1e-9);
    wb_text_release(&text);
}

static void tables_begin_at_zero_plastic_strain_and_rise(void **state)
{
    (void)state;
    static const char *const all[] = {PROPERTIES, PROPERTIES ISOTROPIC, PROPERTIES MIXED};
    for (size_t i = 0; i < WB_COUNT(all); i++) {
        read_card("calculix", "*PLASTIC", all[i], &card);
        for (int m = 0; m < card.n; m++) {
            const struct material *const material = &card.materials[m];
            assert_true(material->n == 0 || material->strain[0] == 0.0);
            for (int k = 1; k < material->n; k++)
                assert_true(material->strain[k] > material->strain[k - 1] &&
                            material->stress[k] >= material->stress[k - 1]);
        }
    }
}

/* With exponents that make the start of the curve steep, points far below practical strains are
 * needed. */
static void tables_follow_ludwiks_law_for_any_exponent(void **state)
{
    (void)state;
    static const char *const exponents[] = {"0.05", "0.2", "0.5", "1", "1.6"};
    for (size_t i = 0; i < WB_COUNT(exponents); i++) {
        char properties[400];
        snprintf(properties, sizeof properties,
                 "wire: test\nouter_diameter_mm: 1.2\nmass_per_length_kg_m: 0.004\n"
                 "youngs_modulus_MPa: 5000\nyield_stress_MPa: 5\nstrength_coefficient_MPa: 300\n"
                 "poissons_ratio: 0.39\nhardening_exponent: %s\n",
                 exponents[i]);
        read_card("calculix", "*PLASTIC", properties, &card);
        compare_with_law(&card, properties, 5e-3);
    }
}

static void parts_share_the_mass_and_poissons_ratio(void **state)
{
    (void)state;
    const double density = 0.004 / (0.25 * M_PI * 1.2e-3 * 1.2e-3);
    double sum = 0.0;
    read_card("calculix", "*PLASTIC", PROPERTIES MIXED, &card);
    for (int i = 0; i < card.n; i++) {
        sum += card.materials[i].density;
        assert_close(card.materials[i].poisson, 0.49, 1e-12);
        for (int k = 0; k < i; k++)
            assert_string_not_equal(card.materials[i].name, card.materials[k].name);
    }
    assert_close_relative(sum, density, 1e-8);
    read_card("calculix", "*PLASTIC", PROPERTIES, &card);
    assert_close(card.materials[0].poisson, 0.39, 1e-12);
    assert_close_relative(card.materials[0].density, density, 1e-8);
    assert_string_equal(card.materials[0].name, "WIRE_TEST");
}

static void a_wire_of_unknown_mass_has_no_density(void **state)
{
    (void)state;
    static const char properties[] =
        "wire: test\nouter_diameter_mm: 1.2\nmass_per_length_kg_m: 0\n" LUDWIK_NUMBERS;
    const struct wb_card_source source = source_of(properties);
    const struct wb_card_settings settings = card_defaults();
    struct wb_text text = card_of("calculix", &source, &settings);
    assert_null(strstr(wb_text_string(&text), "*DENSITY"));
    assert_non_null(strstr(wb_text_string(&text), "** The wire's mass"));
    wb_text_release(&text);
    keep_messages();
    assert_int_equal(wb_card_write(wb_card_find("mujoco"), &source, &settings, &text, NULL),
                     WB_ERR_UNSUPPORTED);
    assert_message("mass_per_length_kg_m is 0");
    release_messages();
    wb_text_release(&text);
    read_card("calculix", "*PLASTIC", properties, &card);
    compare_with_law(&card, properties, 3e-4);
}

static void the_abaqus_card_states_that_it_was_not_run(void **state)
{
    (void)state;
    const struct wb_card_source source = source_of(PROPERTIES);
    const struct wb_card_settings settings = card_defaults();
    struct wb_text text = card_of("abaqus", &source, &settings);
    assert_non_null(strstr(wb_text_string(&text), "NOT RUN"));
    wb_text_release(&text);
}

static void nearly_incompressible_materials_are_rejected(void **state)
{
    (void)state;
    const struct wb_card_settings settings = card_defaults();
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"wire: w\nouter_diameter_mm: 1\nmass_per_length_kg_m: 0.1\nyoungs_modulus_MPa: 1\n"
         "yield_stress_MPa: 1\nstrength_coefficient_MPa: 1\nhardening_exponent: 1\n"
         "poissons_ratio: 0.5\n",
         "poissons_ratio is 0.5"},
    };
    keep_messages();
    for (size_t i = 0; i < WB_COUNT(cases); i++) {
        struct wb_text text = {0};
        const struct wb_card_source source = source_of(cases[i].text);
        assert_int_equal(wb_card_write(wb_card_find("calculix"), &source, &settings, &text, NULL),
                         WB_ERR_UNSUPPORTED);
        assert_message(cases[i].message);
        wb_text_release(&text);
    }
    assert_null(wb_card_find("nastran"));
    assert_message("expected one of calculix, abaqus");
    release_messages();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(materials_together_are_the_law),
        cmocka_unit_test(materials_together_unload_as_the_law),
        cmocka_unit_test(combined_hardening_is_native_or_a_first_loading),
        cmocka_unit_test(tables_begin_at_zero_plastic_strain_and_rise),
        cmocka_unit_test(tables_follow_ludwiks_law_for_any_exponent),
        cmocka_unit_test(parts_share_the_mass_and_poissons_ratio),
        cmocka_unit_test(a_wire_of_unknown_mass_has_no_density),
        cmocka_unit_test(the_abaqus_card_states_that_it_was_not_run),
        cmocka_unit_test(nearly_incompressible_materials_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
