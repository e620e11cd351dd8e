#include "analysis/calibration/constituents/tensile.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/config.h"
#include "base/memory.h"

#define WB_LOG_DOMAIN "tensile"

enum {
    MOST_POINTS = 1500, /* longer curves are thinned */
    LEAST_POINTS = 8,
    LEAST_WINDOW = 4, /* points of the straight stretch */
    EXPONENTS = 400
};

/* Range of the exponents. */
#define LEAST_EXPONENT 0.02
#define MOST_EXPONENT 2.0
/* Smallest plastic strain for eq. 7, in proof offsets: ln(sigma - sigma_Y) is infinite at the proof
 * stress. */
#define BEYOND_PROOF 5.0
/* n is identifiable if all laws that fit alike are within this factor. */
#define KNOWN_WITHIN 1.25

const double wb_tensile_plastic_strains[WB_TENSILE_STRESSES] = {0.002, 0.01, 0.05};

static const struct wb_setting rows[] = {
    {WB_ROW_NUMBER(wb_tensile_settings, proof_offset, "proof_offset", 1e-6, 0.1, 0.002),
     WB_ROW_OPTION("proof-offset", "E", "Strain offset of the elastic line for the proof stress")},
    {WB_ROW_NUMBER(wb_tensile_settings, stretch, "stretch", 0.01, 0.95, 0.4),
     WB_ROW_OPTION("stretch", "R",
                   "Smallest force range of the straight initial part, over the largest force")},
    {WB_ROW_NUMBER(wb_tensile_settings, fit_from, "fit_from", 0.0, 1.0, 0.002),
     WB_ROW_OPTION("fit-from", "E", "Plastic strain where the least-squares fit begins")},
    {WB_ROW_NUMBER(wb_tensile_settings, fit_to, "fit_to", 0.0, 10.0, 0.0),
     WB_ROW_OPTION("fit-to", "E", "Plastic strain where the least-squares fit ends"),
     .otherwise = "at the largest force"},
    {WB_ROW_NUMBER(wb_tensile_settings, alike, "alike", 1e-6, 0.5, 0.01),
     WB_ROW_OPTION("alike", "R", "Laws fit alike whose misfit is below this part of the strength")},
};
const struct wb_setting_table wb_tensile_table = {WB_SETTING_ROWS(rows)};

void wb_tensile_default_settings(struct wb_tensile_settings *settings)
{
    wb_setting_fill(&wb_tensile_table, settings);
}

/* --- one curve --- */

/* Engineering stress over strain of the first loading up to the largest force, then converted to
 * true stress over plastic strain. */
struct curve {
    size_t n;
    double *strain, *stress; /* (n) */
};

static const struct wb_tensile_law no_law = {(double)NAN, (double)NAN, (double)NAN, (double)NAN};

/* Reads the rows up to the largest force, averaged in equal bins so that there are at most
 * MOST_POINTS. Force and travel are zeroed at the first row. */
static enum wb_status take_curve(struct curve *curve, struct wb_memory *memory,
                                 const struct wb_dataset *dataset, struct wb_reason *why)
{
    const struct wb_test_info *const info = &dataset->info;
    /* The crosshead's travel includes the machine's deformation; an extensometer does not measure
     * it. */
    const double compliance = info->machine.compliance.known && !info->machine.own_elongation
                                  ? info->machine.compliance.value
                                  : 0.0;
    size_t n = 0, top = 0;
    while (n < dataset->n_rows && dataset->rows[n].cycle == 1 &&
           dataset->rows[n].phase == WB_PHASE_LOAD)
        n++;
    for (size_t i = 0; i < n; i++) {
        if (dataset->rows[i].force > dataset->rows[top].force)
            top = i;
    }
    n = top + 1;
    if (n < LEAST_POINTS)
        return wb_fail_to(
            why, WB_ERR_DATA,
            "sample %d: %zu rows up to the largest force: too few for a tensile curve",
            info->sample, n);
    const size_t bin = 1 + (n - 1) / MOST_POINTS;
    curve->strain = wb_memory_take(memory, n / bin + 1, sizeof(double));
    curve->stress = wb_memory_take(memory, n / bin + 1, sizeof(double));
    for (size_t i = 0; i < n; i += bin) {
        const size_t end = i + bin < n ? i + bin : n;
        double elongation = 0.0, force = 0.0;
        for (size_t k = i; k < end; k++) {
            elongation += dataset->rows[k].deflection - compliance * dataset->rows[k].force;
            force += dataset->rows[k].force;
        }
        curve->strain[curve->n] = elongation / (double)(end - i) / info->length;
        curve->stress[curve->n++] = force / (double)(end - i) / info->piece.area;
    }
    return WB_OK;
}

/* Finds the steepest least-squares line through a stretch of neighbouring points that spans enough
 * stress, and its intersection with S = 0. */
static bool find_start(const struct curve *curve, double stretch,
                       struct wb_tensile_specimen *specimen)
{
    const double span = stretch * specimen->strength;
    /* Relative to the first point's strain, to keep the digits of the sums. */
    const double shift = curve->strain[0];
    double best = 0.0;
    for (size_t i = 0; i + LEAST_WINDOW <= curve->n; i++) {
        double sum_x = 0.0, sum_y = 0.0, sum_xx = 0.0, sum_xy = 0.0; /* over the points i..j */
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (size_t j = i; j < curve->n; j++) {
            const double x = curve->strain[j] - shift, y = curve->stress[j];
            const double n = (double)(j - i + 1);
            sum_x += x;
            sum_y += y;
            sum_xx += x * x;
            sum_xy += x * y;
            low = fmin(low, y);
            high = fmax(high, y);
            if (j - i + 1 < LEAST_WINDOW || high - low < span)
                continue;
            const double width = n * sum_xx - sum_x * sum_x;
            const double slope = width > 0.0 ? (n * sum_xy - sum_x * sum_y) / width : 0.0;
            if (slope > best) {
                best = slope;
                specimen->slope = slope;
                specimen->slack = shift + (sum_x - sum_y / slope) / n;
                specimen->slope_from = low;
            }
            /* A longer stretch of a curve that bends over is not steeper. */
            if (high - low > 2.0 * span)
                break;
        }
    }
    return best > 0.0;
}

/* The first stress at which `over` reaches `value`, interpolated from the last point below; NaN:
 * not reached. */
static double stress_at(const double *over, const double *stress, size_t n, double value)
{
    for (size_t i = 1; i < n; i++) {
        if (over[i - 1] <= value && over[i] > value)
            return stress[i - 1] +
                   (value - over[i - 1]) / (over[i] - over[i - 1]) * (stress[i] - stress[i - 1]);
    }
    return (double)NAN;
}

/* Distance of a point to the right of the initial line, in strain. */
static double distance_to_line(const struct curve *curve,
                               const struct wb_tensile_specimen *specimen, size_t i)
{
    return curve->strain[i] - specimen->slack - curve->stress[i] / specimen->slope;
}

/* The stress at which the curve crosses the line E (e - slack - offset). */
static double proof_stress(const struct curve *curve, const struct wb_tensile_specimen *specimen,
                           double offset)
{
    double before = -HUGE_VAL;
    for (size_t i = 0; i < curve->n; i++) {
        const double beyond = distance_to_line(curve, specimen, i);
        if (beyond > offset && before <= offset && isfinite(before))
            return curve->stress[i - 1] + (offset - before) / (beyond - before) *
                                              (curve->stress[i] - curve->stress[i - 1]);
        before = curve->stress[i] >= specimen->slope_from ? beyond : -HUGE_VAL;
    }
    return (double)NAN;
}

/* Converts to true stress and plastic strain. With a crosshead most of the strain that is not
 * plastic is the machine's, which does not reduce the specimen's section: all of it is subtracted
 * first. This neglects the specimen's own elastic strain against one, about 0.1 %. */
static void make_true(struct curve *curve, bool own_elongation,
                      const struct wb_tensile_specimen *specimen)
{
    for (size_t i = 0; i < curve->n; i++) {
        const double e = curve->strain[i] - specimen->slack;
        const double plastic = e - curve->stress[i] / specimen->slope;
        curve->stress[i] *= 1.0 + (own_elongation ? e : plastic);
        curve->strain[i] =
            own_elongation ? log1p(e) - curve->stress[i] / specimen->slope : log1p(plastic);
    }
}

/* --- laws --- */

/* sigma_Y and K by least squares for an exponent, with sigma_Y >= 0. Returns the root mean square
 * of the residuals. */
static double fit_linear(const double *strain, const double *stress, size_t n, double exponent,
                         struct wb_tensile_law *law)
{
    double p = 0.0, y = 0.0, pp = 0.0, py = 0.0, rest = 0.0;
    for (size_t i = 0; i < n; i++) {
        const double power = pow(strain[i], exponent);
        p += power;
        y += stress[i];
        pp += power * power;
        py += power * stress[i];
    }
    const double width = (double)n * pp - p * p;
    law->hardening_exponent = exponent;
    law->strength_coefficient = width > 0.0 ? ((double)n * py - p * y) / width : 0.0;
    law->yield_stress = (y - law->strength_coefficient * p) / (double)n;
    if (law->yield_stress < 0.0 && pp > 0.0) {
        law->yield_stress = 0.0;
        law->strength_coefficient = py / pp;
    }
    for (size_t i = 0; i < n; i++) {
        const double misfit =
            stress[i] - law->yield_stress - law->strength_coefficient * pow(strain[i], exponent);
        rest += misfit * misfit;
    }
    law->rms = sqrt(rest / (double)n);
    return law->rms;
}

static double exponent_of(int i)
{
    return LEAST_EXPONENT * pow(MOST_EXPONENT / LEAST_EXPONENT, (double)i / (EXPONENTS - 1));
}

/* The best exponent by trials and golden sections, and the range in which laws fit alike. */
static void fit_direct(const double *strain, const double *stress, size_t n, double alike,
                       struct wb_tensile_specimen *specimen)
{
    const double golden = 0.5 * (sqrt(5.0) - 1.0);
    struct wb_tensile_law law;
    int best = 0, first = EXPONENTS, last = -1;
    double least = HUGE_VAL;
    for (int i = 0; i < EXPONENTS; i++) {
        const double rms = fit_linear(strain, stress, n, exponent_of(i), &law);
        if (rms < least) {
            least = rms;
            best = i;
        }
        if (rms <= alike) {
            first = i < first ? i : first;
            last = i;
        }
    }
    double low = exponent_of(best > 0 ? best - 1 : 0);
    double high = exponent_of(best + 1 < EXPONENTS ? best + 1 : best);
    for (int i = 0; i < 40; i++) {
        const double a = high - golden * (high - low), b = low + golden * (high - low);
        if (fit_linear(strain, stress, n, a, &law) < fit_linear(strain, stress, n, b, &law))
            high = b;
        else
            low = a;
    }
    fit_linear(strain, stress, n, 0.5 * (low + high), &specimen->direct);
    if (last < 0)
        return;
    specimen->n_low = fmin(exponent_of(first), specimen->direct.hardening_exponent);
    specimen->n_high = fmax(exponent_of(last), specimen->direct.hardening_exponent);
    specimen->n_is_cut = first == 0 || last == EXPONENTS - 1;
}

/* Eq. 7 as a regression of ln(sigma - sigma_Y) on ln(ep). */
static void fit_eq7(const double *strain, const double *stress, size_t n, double from,
                    struct wb_tensile_specimen *specimen)
{
    const double yield = specimen->proof_stress;
    double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, rest = 0.0;
    size_t taken = 0;
    if (!isfinite(yield))
        return;
    for (size_t i = 0; i < n; i++) {
        if (!(strain[i] >= from) || !(stress[i] > yield))
            continue;
        const double a = log(strain[i]), b = log(stress[i] - yield);
        x += a;
        y += b;
        xx += a * a;
        xy += a * b;
        taken++;
    }
    const double width = (double)taken * xx - x * x;
    if (taken < 3 || !(width > 0.0))
        return;
    const double exponent = ((double)taken * xy - x * y) / width;
    const double strength = exp((y - exponent * x) / (double)taken);
    if (!(exponent > 0.0))
        return;
    for (size_t i = 0; i < n; i++) {
        const double misfit = stress[i] - yield - strength * pow(strain[i], exponent);
        rest += misfit * misfit;
    }
    specimen->eq7 = (struct wb_tensile_law){yield, strength, exponent, sqrt(rest / (double)n)};
}

/* --- one specimen --- */

static enum wb_status run_specimen(struct wb_tensile_specimen *specimen, struct curve *curve,
                                   struct wb_memory *memory, const struct wb_dataset *dataset,
                                   const struct wb_tensile_settings *settings,
                                   struct wb_reason *why)
{
    *specimen = (struct wb_tensile_specimen){
        .sample = dataset->info.sample,
        .proof_stress = (double)NAN,
        .direct = no_law,
        .eq7 = no_law,
        .n_low = (double)NAN,
        .n_high = (double)NAN,
    };
    for (int k = 0; k < WB_TENSILE_STRESSES; k++)
        specimen->stress[k] = (double)NAN;
    WB_TRY(take_curve(curve, memory, dataset, why));
    specimen->strength = curve->stress[curve->n - 1];
    if (!(specimen->strength > 0.0) || !find_start(curve, settings->stretch, specimen))
        return wb_fail_to(why, WB_ERR_DATA,
                          "sample %d: no stretch of at least %d points rises by %.3g of the "
                          "largest force: not a tensile curve",
                          specimen->sample, LEAST_WINDOW, settings->stretch);
    specimen->uniform_strain = curve->strain[curve->n - 1] - specimen->slack;
    specimen->start_is_straight = distance_to_line(curve, specimen, 0) <= settings->proof_offset;
    if (!specimen->start_is_straight)
        return WB_OK; /* plastic strain over such a line is not defined */
    specimen->proof_stress = proof_stress(curve, specimen, settings->proof_offset);
    make_true(curve, dataset->info.machine.own_elongation, specimen);
    for (int k = 0; k < WB_TENSILE_STRESSES; k++)
        specimen->stress[k] =
            stress_at(curve->strain, curve->stress, curve->n, wb_tensile_plastic_strains[k]);
    /* The points for the laws: plastic strain increases along the curve except for noise. */
    size_t first = curve->n, end = curve->n;
    const double to = settings->fit_to > 0.0 ? settings->fit_to : HUGE_VAL;
    for (size_t i = curve->n;
         i-- > 0 && curve->strain[i] >= settings->fit_from && curve->strain[i] > 0.0;)
        first = i;
    while (end > first && curve->strain[end - 1] > to)
        end--;
    specimen->n_points = end - first;
    if (specimen->n_points < LEAST_POINTS)
        return WB_OK; /* the laws stay NaN */
    fit_direct(curve->strain + first, curve->stress + first, specimen->n_points,
               settings->alike * specimen->strength, specimen);
    fit_eq7(curve->strain + first, curve->stress + first, specimen->n_points,
            fmax(BEYOND_PROOF * settings->proof_offset, settings->fit_from), specimen);
    return WB_OK;
}

/* --- over the specimens --- */

static struct wb_tensile_number over_specimens(const struct wb_tensile_result *result,
                                               size_t offset)
{
    struct wb_tensile_number number = {0, (double)NAN, (double)NAN, (double)NAN};
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < result->n_specimens; i++) {
        double value;
        memcpy(&value, (const char *)&result->specimens[i] + offset, sizeof value);
        if (!isfinite(value) || !(value > 0.0))
            continue;
        sum += log(value);
        squares += log(value) * log(value);
        number.n++;
    }
    if (number.n == 0)
        return number;
    const double mean = sum / number.n;
    number.mean = exp(mean);
    if (number.n < 2)
        return number;
    const double deviation =
        sqrt(fmax(squares / number.n - mean * mean, 0.0) * number.n / (number.n - 1));
    const double half =
        gsl_cdf_tdist_Qinv(0.025, number.n - 1) * deviation / sqrt((double)number.n);
    number.low = exp(mean - half);
    number.high = exp(mean + half);
    return number;
}

static void summarise(struct wb_tensile_result *result)
{
#define OVER(member) over_specimens(result, offsetof(struct wb_tensile_specimen, member))
    result->slope = OVER(slope);
    const struct wb_tensile_number unknown = {0, (double)NAN, (double)NAN, (double)NAN};
    result->youngs_modulus = result->own_elongation ? result->slope : unknown;
    result->proof_stress = OVER(proof_stress);
    result->strength = OVER(strength);
    result->uniform_strain = OVER(uniform_strain);
    for (int k = 0; k < WB_TENSILE_STRESSES; k++)
        result->stress[k] = over_specimens(result, offsetof(struct wb_tensile_specimen, stress) +
                                                       (size_t)k * sizeof(double));
    result->direct_yield = OVER(direct.yield_stress);
    result->direct_strength = OVER(direct.strength_coefficient);
    result->direct_exponent = OVER(direct.hardening_exponent);
    result->eq7_strength = OVER(eq7.strength_coefficient);
    result->eq7_exponent = OVER(eq7.hardening_exponent);
#undef OVER
    bool cut = false;
    result->n_low = HUGE_VAL;
    result->n_high = 0.0;
    for (int i = 0; i < result->n_specimens; i++) {
        const struct wb_tensile_specimen *const specimen = &result->specimens[i];
        if (!isfinite(specimen->n_low))
            continue;
        result->n_followed++;
        result->n_low = fmin(result->n_low, specimen->n_low);
        result->n_high = fmax(result->n_high, specimen->n_high);
        cut = cut || specimen->n_is_cut;
    }
    if (!(result->n_high > 0.0))
        result->n_low = result->n_high = (double)NAN;
    result->follows = result->n_followed == result->n_specimens;
    result->identifiable =
        result->follows && !cut && result->n_high <= KNOWN_WITHIN * result->n_low;
}

static enum wb_status check_same(const struct wb_dataset *const *datasets, int n,
                                 struct wb_reason *why)
{
    const struct wb_test_info *const first = &datasets[0]->info;
    for (int i = 0; i < n; i++) {
        const struct wb_test_info *const info = &datasets[i]->info;
        if (info->kind != WB_TEST_TENSILE)
            return wb_fail_to(why, WB_ERR_UNSUPPORTED,
                              "%s, sample %d is a %s test: expected a tensile test", info->wire,
                              info->sample, wb_machine_kind_name(info->kind));
        if (!(info->piece.area > 0.0) || !(info->length > 0.0))
            return wb_fail_to(why, WB_ERR_DATA, "%s, sample %d: area or gauge length is missing",
                              info->wire, info->sample);
        if (strcmp(info->wire, first->wire) != 0 ||
            info->piece.constituent != first->piece.constituent)
            return wb_fail_to(why, WB_ERR_DATA,
                              "%s of %s and %s of %s are not specimens of one constituent: "
                              "calibrate them separately",
                              wb_test_piece_constituent_name(first->piece.constituent), first->wire,
                              wb_test_piece_constituent_name(info->piece.constituent), info->wire);
        if (info->machine.own_elongation != first->machine.own_elongation)
            return wb_fail_to(why, WB_ERR_DATA,
                              "sample %d: elongation by %s, but of the first specimen by %s: "
                              "calibrate them separately",
                              info->sample,
                              info->machine.own_elongation ? "extensometer" : "crosshead",
                              first->machine.own_elongation ? "extensometer" : "crosshead");
    }
    return WB_OK;
}

/* The mean of the true curves over their common range, and its least-squares law. */
static void fit_mean(struct wb_tensile_result *result, const struct curve *curves,
                     const struct wb_tensile_settings *settings)
{
    enum {
        POINTS = 300
    };
    struct wb_tensile_specimen mean = {
        .direct = no_law, .n_low = (double)NAN, .n_high = (double)NAN};
    double strain[POINTS], stress[POINTS];
    double to = settings->fit_to > 0.0 ? settings->fit_to : HUGE_VAL;
    size_t n = 0;
    result->of_mean = no_law;
    result->of_mean_n_low = result->of_mean_n_high = (double)NAN;
    for (int i = 0; i < result->n_specimens; i++) {
        if (!isfinite(result->specimens[i].direct.rms))
            return;
        to = fmin(to, curves[i].strain[curves[i].n - 1]);
    }
    for (int k = 0; k < POINTS; k++) {
        const double plastic = settings->fit_from + (to - settings->fit_from) * (k + 0.5) / POINTS;
        double sum = 0.0;
        for (int i = 0; i < result->n_specimens; i++)
            sum += stress_at(curves[i].strain, curves[i].stress, curves[i].n, plastic);
        if (!(plastic > 0.0) || !isfinite(sum))
            continue;
        strain[n] = plastic;
        stress[n++] = sum / result->n_specimens;
    }
    if (n < LEAST_POINTS)
        return;
    fit_direct(strain, stress, n, settings->alike * result->strength.mean, &mean);
    result->of_mean = mean.direct;
    result->of_mean_n_low = mean.n_low;
    result->of_mean_n_high = mean.n_high;
}

enum wb_status wb_tensile_run(struct wb_tensile_result *result,
                              const struct wb_dataset *const *datasets, int n,
                              const struct wb_tensile_settings *settings, struct wb_reason *why)
{
    struct wb_tensile_result made = {.n_specimens = 0};
    struct wb_memory memory = {0};
    if (n < 1)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "no tensile test given");
    WB_TRY(wb_setting_check(&wb_tensile_table, settings, why));
    WB_TRY(check_same(datasets, n, why));
    const struct wb_test_info *const info = &datasets[0]->info;
    memcpy(made.wire, info->wire, sizeof made.wire);
    made.constituent = info->piece.constituent;
    made.own_elongation = info->machine.own_elongation;
    made.area = info->piece.area;
    made.gauge_length = info->length;
    made.specimens = wb_memory_new((size_t)n, sizeof *made.specimens);
    struct curve *const curves = wb_memory_take(&memory, (size_t)n, sizeof *curves);
    enum wb_status status = WB_OK;
    for (int i = 0; status == WB_OK && i < n; i++)
        status = run_specimen(&made.specimens[i], &curves[i], &memory, datasets[i], settings, why);
    if (status == WB_OK) {
        made.n_specimens = n;
        summarise(&made);
        fit_mean(&made, curves, settings);
        *result = made;
    } else {
        wb_tensile_release(&made);
    }
    wb_memory_release(&memory);
    return status;
}

void wb_tensile_release(struct wb_tensile_result *result)
{
    free(result->specimens);
    memset(result, 0, sizeof *result);
}
