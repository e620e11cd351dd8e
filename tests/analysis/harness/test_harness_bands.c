/* Bands of harnesses whose forces and shapes depend on E in closed form: wires that do not yield.
 */
#include "analysis/harness/harness_bands.h"

#include <gsl/gsl_cdf.h>

#include "analysis/harness/harness_bands_output.h"
#include "base/file.h"
#include "base/random.h"
#include "base/units.h"
#include "base/vec3.h"
#include "tests/check.h"
#include "tests/messages.h"
#include "tests/own_folder.h"

enum {
    SPECIMENS = 5,
    RUNS = 1500, /* the ends of the band scatter by 7 % of its half */
    TRUTHS = 60
};

static const double spread = 0.1; /* standard deviation of ln E of the product */
static const double mean_modulus = 4528e6, length = 0.2, lift = 2e-3;
static const struct wb_harness_settings settings = {.torsion = 1.0, .element_length = 0.02};
static struct wb_harness_plan *plan;
static struct wb_harness_result_set nominal;

static void write_text(const char *name, const char *text, char path[WB_PATH])
{
    assert_int_equal(wb_file_join(path, folder, name), WB_OK);
    assert_int_equal(wb_file_write(path, text, strlen(text)), WB_OK);
}

/* E of the i-th wire of a product. */
static double draw_modulus(uint64_t product, uint64_t i)
{
    return mean_modulus * exp(spread * wb_random_normal(product, 1, i));
}

/* Writes the calibration of the first wires of a product, whose law is the geometric mean. Their
 * yield stress is out of reach. */
static void write_properties(const char *name, uint64_t product, int n)
{
    struct wb_text text = {0}, specimens = {0};
    char path[WB_PATH];
    double sum = 0.0;
    for (int i = 0; i < n; i++) {
        const double E = draw_modulus(product, (uint64_t)i);
        sum += log(E);
        wb_text_append(&specimens,
                       "  - {sample: %d, length_mm: 85, youngs_modulus_MPa: %.17g, "
                       "yield_stress_MPa: 1e4, strength_coefficient_MPa: 1e4, "
                       "hardening_exponent: 1}\n",
                       i, E / WB_MPA);
    }
    wb_text_append(&text,
                   "wire: type3\nouter_diameter_mm: 1.4\nmass_per_length_kg_m: 0.00765\n"
                   "youngs_modulus_MPa: %.17g\nyield_stress_MPa: 1e4\n"
                   "strength_coefficient_MPa: 1e4\nhardening_exponent: 1\npoissons_ratio: 0.39\n"
                   "specimens:\n%s",
                   exp(sum / n) / WB_MPA, wb_text_string(&specimens));
    write_text(name, wb_text_string(&text), path);
    wb_text_release(&text);
    wb_text_release(&specimens);
}

/* A branch of 200 mm along x with these wires and steps, computed with the nominal laws. */
static void compute_nominal(const char *wires, const char *steps)
{
    struct wb_text text = {0};
    char path[WB_PATH];
    wb_text_append(&text,
                   "kind: harness\nname: one\nwires:\n%s"
                   "root: {name: R}\n"
                   "branches:\n  - {name: B, from: R, to: K, wire: a, length_mm: 200}\n"
                   "connectors:\n  - {name: K, mass_g: 0.05}\nsteps:\n%s",
                   wires, steps);
    write_text("one.yaml", wb_text_string(&text), path);
    wb_text_release(&text);
    plan = wb_memory_new(1, sizeof *plan);
    assert_int_equal(wb_harness_file_read(plan, path), WB_OK);
    assert_int_equal(wb_harness_run_compute(&nominal, plan, &settings, NULL, NULL), WB_OK);
    assert_true(nominal.converged);
}

static void release_nominal(void)
{
    wb_harness_run_release(&nominal);
    free(plan);
}

static struct wb_harness_bands *compute_bands(int runs, int n_threads)
{
    const struct wb_harness_bands_settings s = {.runs = runs, .seed = 3, .n_threads = n_threads};
    struct wb_harness_bands *bands;
    assert_int_equal(wb_harness_bands_create(&bands, &nominal, &s), WB_OK);
    assert_int_equal(wb_harness_bands_compute(bands, 0, runs), WB_OK);
    assert_false(bands->stopped);
    wb_harness_bands_finish(bands);
    return bands;
}

static const char one_wire[] = "  - {name: a, wire: ./p.yaml}\n";
static const char lifted[] = "  - {mount: K, at_mm: [199.988, 0, 2]}\n";

/* Standard deviation of ln E over the specimens. */
static double specimens_spread(uint64_t product)
{
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < SPECIMENS; i++)
        sum += log(draw_modulus(product, (uint64_t)i)) / SPECIMENS;
    for (int i = 0; i < SPECIMENS; i++)
        squares += pow(log(draw_modulus(product, (uint64_t)i)) - sum, 2.0);
    return sqrt(squares / (SPECIMENS - 1));
}

/* Scale of the t distribution of ln E of a further wire. */
static double predictive_scale(uint64_t product)
{
    return specimens_spread(product) * sqrt(1.0 + 1.0 / SPECIMENS);
}

/* Without weight, the force that lifts the end, whose direction is held, is proportional to E: 12
 * EI d / L^3. */
static void forces_of_a_lifted_cantilever_have_the_quantiles_of_the_modulus(void **unused)
{
    (void)unused;
    write_properties("p.yaml", 1, SPECIMENS);
    compute_nominal(one_wire, lifted);
    struct wb_harness_bands *const bands = compute_bands(RUNS, 0);
    const struct wb_harness_force_bands *const f = &bands->steps[0].forces[1];
    const double I = M_PI * pow(1.4e-3, 4.0) / 64.0;
    const double exact =
        12.0 * plan->wires[0].law.material.youngs_modulus * I * lift / pow(length, 3.0);
    const double half = predictive_scale(1) * gsl_cdf_tdist_Pinv(0.975, SPECIMENS - 1);
    assert_close_relative(f->force.median, exact, 0.02);
    assert_close_relative(f->force.median, nominal.results[0].forces[1].size, 0.01);
    assert_close_relative(log(f->force.high / f->force.median), half, 0.15);
    assert_close_relative(log(f->force.low / f->force.median), -half, 0.15);
    assert_close_relative(f->largest_force.high / nominal.results[0].forces[1].largest,
                          f->force.high / nominal.results[0].forces[1].size, 1e-6);
    /* The moment at the root is the force times half of the length. */
    assert_close_relative(bands->steps[0].forces[0].moment.high, 0.5 * f->force.high * length,
                          0.01);
    assert_int_equal(bands->steps[0].n, RUNS);
    assert_int_equal(bands->n_deviants, 0);
    wb_harness_bands_destroy(bands);
    release_nominal();
}

/* Largest |E0/E - 1| of 95 % of the wires, by bisection in the t distribution. */
static double predictive_compliance(double scale)
{
    double low = 0.0, high = 0.9;
    while (high - low > 1e-9) {
        const double d = 0.5 * (low + high);
        const double within = gsl_cdf_tdist_P(-log1p(-d) / scale, SPECIMENS - 1) -
                              gsl_cdf_tdist_P(-log1p(d) / scale, SPECIMENS - 1);
        if (within < 0.95)
            low = d;
        else
            high = d;
    }
    return low;
}

/* Under its weight the end sinks by (P L^3 / 3 + w L^4 / 8) / EI, and the weight stays. */
static void a_hanging_cantilever_sinks_as_its_compliance(void **unused)
{
    (void)unused;
    write_properties("p.yaml", 1, SPECIMENS);
    compute_nominal(one_wire, "  - hang\n  - take_off\n");
    struct wb_harness_bands *const bands = compute_bands(RUNS, 0);
    const struct wb_harness_shape_band *const shape = &bands->steps[0].branches[0];
    const double EI = plan->wires[0].law.material.youngs_modulus * M_PI * pow(1.4e-3, 4.0) / 64.0;
    const double sinks = WB_STANDARD_GRAVITY *
                         (0.05e-3 * pow(length, 3.0) / 3.0 + 0.00765 * pow(length, 4.0) / 8.0) / EI;
    const double exact = sinks * predictive_compliance(predictive_scale(1));
    print_message("%.4f mm, closed form %.4f mm\n", shape->distance / WB_MM, exact / WB_MM);
    assert_close_relative(shape->distance, exact, 0.1);
    assert_true(shape->median < 0.5 * shape->distance);
    assert_close(shape->at, length, 1e-9);
    const struct wb_fit_band *const root = &bands->steps[0].forces[0].force;
    assert_close_relative(root->low, nominal.weight, 1e-9);
    assert_close_relative(root->high, nominal.weight, 1e-9);
    assert_true(bands->is_taken_off && bands->residual.high < 1e-7);
    wb_harness_bands_destroy(bands);
    release_nominal();
}

/* Of wires of which five are calibrated, the sixth has a force within the band in 95 % of the
 * products; 60 products tell 95 % from 80 %. */
static void ninety_five_percent_of_further_wires_are_within_the_band(void **unused)
{
    (void)unused;
    int within = 0;
    for (uint64_t product = 100; product < 100 + TRUTHS; product++) {
        write_properties("p.yaml", product, SPECIMENS);
        compute_nominal(one_wire, lifted);
        struct wb_harness_bands *const bands = compute_bands(WB_HARNESS_BANDS_LEAST_RUNS, 0);
        const struct wb_fit_band *const force = &bands->steps[0].forces[1].force;
        const double true_force = nominal.results[0].forces[1].size *
                                  draw_modulus(product, SPECIMENS) /
                                  plan->wires[0].law.material.youngs_modulus;
        within += force->low < true_force && true_force < force->high;
        wb_harness_bands_destroy(bands);
        release_nominal();
    }
    print_message("%d of %d within\n", within, TRUTHS);
    assert_in_range(within, 53, 60); /* fewer: 3 % if 95 % are within */
}

static void number_of_threads_does_not_change_a_bit(void **unused)
{
    (void)unused;
    write_properties("p.yaml", 1, SPECIMENS);
    compute_nominal(one_wire, "  - hang\n  - {mount: K, at_mm: [180, 10, 20]}\n  - take_off\n");
    struct wb_harness_bands *const one = compute_bands(60, 1), *const four = compute_bands(60, 4);
    assert_memory_equal(one->values, four->values, 60 * one->stride * sizeof(double));
    /* Parts are the same runs. */
    const struct wb_harness_bands_settings s = {.runs = 60, .seed = 3};
    struct wb_harness_bands *parts;
    assert_int_equal(wb_harness_bands_create(&parts, &nominal, &s), WB_OK);
    assert_int_equal(wb_harness_bands_compute(parts, 41, 19), WB_OK);
    assert_int_equal(wb_harness_bands_compute(parts, 0, 41), WB_OK);
    assert_memory_equal(one->values, parts->values, 60 * one->stride * sizeof(double));
    wb_harness_bands_destroy(one);
    wb_harness_bands_destroy(four);
    wb_harness_bands_destroy(parts);
    release_nominal();
}

/* Two names of one file are one product, and wires without specimens are exact. */
static void parts_of_other_inputs_are_rejected(void **unused)
{
    (void)unused;
    const struct wb_harness_bands_settings s = {.runs = 40, .seed = 3}, other = {.runs = 40};
    struct wb_harness_bands *bands, *others;
    write_properties("p.yaml", 1, SPECIMENS);
    compute_nominal(one_wire, "  - hang\n");
    assert_int_equal(wb_harness_bands_create(&bands, &nominal, &s), WB_OK);
    assert_int_equal(wb_harness_bands_create(&others, &nominal, &other), WB_OK);
    assert_int_equal(wb_harness_bands_compute(bands, 10, 5), WB_OK);
    assert_int_equal(wb_harness_bands_write_part(bands, 10, 5, folder), WB_OK);
    keep_messages();
    assert_int_equal(wb_harness_bands_read_part(others, 10, 5, folder, NULL), WB_ERR_FORMAT);
    assert_message("part.json: not 5 runs from run 11 of this harness");
    assert_int_equal(wb_harness_bands_read_part(bands, 11, 5, folder, NULL), WB_ERR_FORMAT);
    assert_int_equal(wb_harness_bands_read_part(bands, 10, 6, folder, NULL), WB_ERR_FORMAT);
    release_messages();
    double *const values = bands->values + 10 * bands->stride;
    const double first = values[0];
    assert_true(first == 1.0);
    values[0] = 0.0;
    assert_int_equal(wb_harness_bands_read_part(bands, 10, 5, folder, NULL), WB_OK);
    assert_true(values[0] == first);
    wb_harness_bands_destroy(bands);
    wb_harness_bands_destroy(others);
    release_nominal();
}

static void wires_of_one_file_share_their_draw(void **unused)
{
    (void)unused;
    write_properties("p.yaml", 1, SPECIMENS);
    compute_nominal("  - {name: a, wire: ./p.yaml}\n  - {name: b, wire: type3}\n"
                    "  - {name: c, wire: ./p.yaml, torsional_stiffness_N_mm2: 5}\n",
                    "  - hang\n");
    assert_true(wb_harness_bands_is_drawn(&plan->wires[0]));
    assert_false(wb_harness_bands_is_drawn(&plan->wires[1]));
    struct wb_harness_bands *const bands = compute_bands(40, 0);
    assert_int_equal(bands->n_dimensions, SPECIMENS + 1);
    wb_harness_bands_destroy(bands);
    release_nominal();
}

/* The joints may not turn in an increment: no run gets anywhere. */
static void runs_without_equilibrium_are_counted_and_named(void **unused)
{
    (void)unused;
    struct wb_text text = {0};
    write_properties("p.yaml", 1, SPECIMENS);
    compute_nominal(one_wire, "  - hang\n");
    nominal.settings.most_rotation = 1e-12;
    struct wb_harness_bands *const bands = compute_bands(40, 0);
    assert_int_equal(bands->steps[0].n, 0);
    assert_int_equal(bands->steps[0].n_lost, 40);
    assert_int_equal(bands->n_deviants, 40);
    assert_true(bands->deviants[39].is_lost && bands->deviants[39].run == 40);
    assert_true(isnan(bands->steps[0].forces[0].force.median));
    assert_true(isnan(bands->steps[0].branches[0].distance));
    wb_harness_bands_output_append_deviants(&text, bands);
    assert_non_null(strstr(wb_text_string(&text), "of 40 runs 40 found no equilibrium in a step"));
    assert_non_null(strstr(wb_text_string(&text), "run 1 in step 1, hang (no equilibrium"));
    wb_text_release(&text);
    wb_harness_bands_destroy(bands);
    release_nominal();
}

/* A snap of the nominal results in the first of two steps, which no run has; and one in the second
 * step instead, after which the same branches have snapped. */
static void runs_with_other_snaps_are_counted_and_named(void **unused)
{
    (void)unused;
    struct wb_text text = {0};
    write_properties("p.yaml", 1, SPECIMENS);
    compute_nominal(one_wire, "  - hang\n  - {mount: K, at_mm: [199, 0, -2]}\n");
    nominal.results[0].n_snaps = 1;
    nominal.results[0].snap_branch[0] = 0;
    struct wb_harness_bands *bands = compute_bands(40, 0);
    assert_int_equal(bands->steps[0].n, 40);
    assert_int_equal(bands->steps[0].n_other, 40);
    assert_int_equal(bands->steps[1].n_other, 40);
    assert_int_equal(bands->deviants[0].step, 0);
    assert_false(bands->deviants[0].is_lost);
    assert_true(isfinite(bands->steps[0].forces[0].force.median));
    wb_harness_bands_output_append_deviants(&text, bands);
    assert_non_null(strstr(wb_text_string(&text), "40 snapped otherwise"));
    assert_non_null(strstr(wb_text_string(&text), "and others, which harness.json lists"));
    wb_text_release(&text);
    wb_harness_bands_destroy(bands);
    nominal.results[0].n_snaps = 0;
    bands = compute_bands(40, 0);
    assert_int_equal(bands->n_deviants, 0);
    wb_harness_bands_destroy(bands);
    release_nominal();
}

static void bands_without_scatter_or_with_few_runs_are_rejected(void **unused)
{
    (void)unused;
    const struct wb_harness_bands_settings s = {.runs = 40};
    struct wb_harness_bands *bands;
    write_properties("p.yaml", 1, 2);
    compute_nominal(one_wire, "  - hang\n");
    keep_messages();
    assert_int_equal(wb_harness_bands_create(&bands, &nominal, &s), WB_ERR_ARGUMENT);
    assert_message("the file of no wire has it: a (p.yaml)");
    release_messages();
    release_nominal();
    write_properties("p.yaml", 1, SPECIMENS);
    compute_nominal(one_wire, "  - hang\n");
    keep_messages();
    assert_int_equal(wb_harness_bands_check(plan, 39), WB_ERR_ARGUMENT);
    assert_message("expected at least 40");
    release_messages();
    nominal.converged = false;
    keep_messages();
    assert_int_equal(wb_harness_bands_create(&bands, &nominal, &s), WB_ERR_ARGUMENT);
    assert_message("finds no equilibrium");
    release_messages();
    release_nominal();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_of_a_lifted_cantilever_have_the_quantiles_of_the_modulus),
        cmocka_unit_test(a_hanging_cantilever_sinks_as_its_compliance),
        cmocka_unit_test(ninety_five_percent_of_further_wires_are_within_the_band),
        cmocka_unit_test(number_of_threads_does_not_change_a_bit),
        cmocka_unit_test(parts_of_other_inputs_are_rejected),
        cmocka_unit_test(wires_of_one_file_share_their_draw),
        cmocka_unit_test(runs_without_equilibrium_are_counted_and_named),
        cmocka_unit_test(runs_with_other_snaps_are_counted_and_named),
        cmocka_unit_test(bands_without_scatter_or_with_few_runs_are_rejected),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
