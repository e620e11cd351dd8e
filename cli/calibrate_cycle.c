#include "cli/calibrate_cycle.h"

#include <math.h>
#include <stdio.h>

#include "analysis/calibration/cycle/cycle_budget.h"
#include "analysis/calibration/properties/cycle_json.h"
#include "analysis/report/draw/figures_cycle.h"
#include "base/text.h"
#include "base/units.h"
#include "cli/command.h"
#include "cli/finding.h"
#include "cli/print.h"

static void print_meaning(const struct wb_cycle_calibration *c,
                          const struct wb_cycle_calibrate_settings *settings)
{
    printf("intervals: 95 %%, with all contributions of the budget below");
    if (settings->pooled_degrees > 0)
        printf("; scatter pooled over several wires, %g with %d degrees of freedom",
               settings->pooled_deviation, settings->pooled_degrees);
    printf("\ncandidates: range over the laws with a misfit of at most twice the best\n");
    if (c->n_members == 1 && !isfinite(c->rigidity.deviation))
        printf("one specimen: the scatter between specimens is unknown and not in the intervals\n");
}

static void print_numbers(const struct wb_cycle_calibration *c,
                          const struct wb_cycle_calibrate_settings *settings)
{
    char curvature[WB_PRINT_NUMBER];
    struct wb_properties properties;
    wb_properties_from_cycle(c, &properties);
    wb_print_quantities(&properties, "candidates");
    if (!c->has_unloading)
        printf("no residual curvature ratio and no loop energy: the tests have no unloading\n");
    printf("the data of all specimens begin at a curvature of %.2g 1/m; ", c->secant.resolved);
    if (c->has_unloading)
        printf("below it, and in the first %.2g 1/m of unloading, values come from the law alone\n",
               c->unloading.resolved);
    else
        printf("below it, values come from the law alone\n");
    if (!c->is_rigidity_resolved)
        printf("the data do not resolve EI at zero curvature: use a stiffness at the curvature of "
               "your application\n");
    print_meaning(c, settings);
    printf("largest curvature that all specimens reached: %s 1/m; beyond it the law is "
           "extrapolated\n",
           wb_print_number(c->largest_curvature, curvature));
}

static void print_rule(const struct wb_cycle_calibration *c)
{
    printf("law: %s; %s\n", wb_candidate_name(c->chosen),
           !c->has_unloading ? "its hardening rule is not tested: the tests have no unloading"
           : c->is_stopped   ? "undecided: stopped before all laws were fitted to all specimens"
           : c->is_followed  ? "fits loading and unloading"
                             : "no law fits loading and unloading");
    if (c->has_unloading && !c->is_stopped && !c->is_followed)
        printf("its misfit over loading and unloading is %.2f %% of F_max, expected at most %g "
               "%%\n",
               c->ranked[0].misfit / WB_PERCENT, WB_CYCLE_LARGEST_FOLLOWED / WB_PERCENT);
    if (!c->has_unloading)
        printf("loading alone cannot separate EI from early yield: EI may be 25 %% low\n");
    printf("%-28s %8s %10s %8s %12s %14s\n", "candidate", "misfit %", "parameters", "weight",
           "EI N mm2", "residual ratio");
    for (int i = 0; i < c->n_ranked; i++) {
        const struct wb_cycle_rank *const rank = &c->ranked[i];
        char rigidity[WB_PRINT_NUMBER], residual_curvature_ratio[WB_PRINT_NUMBER];
        printf("%-28s %8.3f %10d %8.3f %12s %14s%s%s\n", wb_candidate_name(rank->candidate),
               rank->misfit / WB_PERCENT, rank->n_free, rank->weight,
               wb_print_number(rank->rigidity.value / WB_NMM2, rigidity),
               c->has_unloading
                   ? wb_print_number(rank->residual_curvature_ratio.value, residual_curvature_ratio)
                   : "-",
               rank->candidate == c->chosen ? "  chosen" : "",
               rank->counts ? "" : "  not in the ranges");
    }
    for (int i = 0; i < c->n_ranked; i++) {
        if (!c->ranked[i].counts)
            continue;
        struct wb_text numbers = {.bytes = NULL};
        wb_law_append_numbers(&numbers, &c->ranked[i].law);
        printf("%s: %s\n", wb_candidate_name(c->ranked[i].candidate), wb_text_string(&numbers));
        wb_text_release(&numbers);
    }
    printf("weight: from the misfit over %.0f effective residuals (neighbouring residuals are "
           "correlated) and the number of free parameters; repeatability of the readings %.3f %% "
           "of F_max\n",
           c->n_independent, c->repeat_noise / WB_PERCENT);
}

/* How to make K and n identifiable. */
static void print_remedy(const struct wb_cycle_calibration *c)
{
    const double length = c->members[0].data.info.length / WB_MM;
    if (c->travel_share < WB_CYCLE_SMALLEST_TRAVEL)
        printf("; deflect to %.0f mm or more (%g of the length), not %.0f mm",
               ceil(WB_CYCLE_SMALLEST_TRAVEL * length), WB_CYCLE_SMALLEST_TRAVEL,
               c->travel_share * length);
    else if (!c->has_unloading)
        printf("; record the unloading");
    else
        printf("; use a larger deflection");
    printf("\n");
}

static void print_ludwik_number(const struct wb_cycle_calibration *c, const char *name,
                                bool is_identifiable, double value, const char *unit)
{
    char text[WB_PRINT_NUMBER];
    if (is_identifiable) {
        printf("  %-8s %10s %s\n", name, wb_print_number(value, text), unit);
        return;
    }
    printf("  %-8s not identifiable with these data", name);
    print_remedy(c);
}

/* Strongly correlated parameters mean little one by one. */
static void print_correlation(const struct wb_cycle_calibration *c)
{
    const struct wb_cycle_fit *const fit = &c->members[0].answers[c->chosen].fit;
    char a[24], b[24];
    int one, other;
    if (wb_cycle_fit_strongest(fit, &one, &other))
        printf("  strongest correlation of these parameters: %.2f, of %s and %s (specimen %d)\n",
               fit->correlation[one][other], wb_cycle_fit_number(fit, one, a),
               wb_cycle_fit_number(fit, other, b), c->members[0].sample);
}

static void print_law(const struct wb_cycle_calibration *c)
{
    const struct wb_law *const law = &c->law;
    const struct wb_material *const m = &law->material;
    char a[WB_PRINT_NUMBER], b[WB_PRINT_NUMBER];
    static const char *const forms[] = {"Ludwik's", "parallel parts'", "Chaboche's"};
    printf("%s law, %s hardening", forms[law->form], wb_law_rule_name(law));
    if (wb_law_has_share(law))
        printf(", isotropic share %.3g", law->isotropic_share);
    printf(", over the outer diameter\n  %-8s %10s MPa\n", "E",
           wb_print_number(law->material.youngs_modulus / WB_MPA, a));
    if (law->form != WB_LAW_PARALLEL)
        printf("  %-8s %10s MPa\n", "sigma_Y", wb_print_number(m->yield_stress / WB_MPA, a));
    if (law->form == WB_LAW_LUDWIK) {
        print_ludwik_number(c, "K", c->is_strength_identifiable, m->strength_coefficient / WB_MPA,
                            "MPa");
        print_ludwik_number(c, "n", c->is_exponent_identifiable, m->hardening_exponent, "");
    }
    if (law->form == WB_LAW_CHABOCHE)
        printf("  %-8s %10s MPa, b %s\n", "Q", wb_print_number(law->saturation / WB_MPA, a),
               wb_print_number(law->rate, b));
    for (int i = 0; i < law->n_backs; i++)
        printf("  C%-7d %10s MPa, gamma%d %s\n", i + 1,
               wb_print_number(law->backs[i].modulus / WB_MPA, a), i + 1,
               wb_print_number(law->backs[i].recovery, b));
    for (int i = 0; i < law->n_parts; i++) {
        const struct wb_law_part *const part = &law->parts[i];
        printf("  part %-3d %10s MPa", i + 1, wb_print_number(part->modulus / WB_MPA, a));
        if (isfinite(part->yield_strain))
            printf(", yields at a strain of %s %%\n",
                   wb_print_number(part->yield_strain / WB_PERCENT, b));
        else
            printf(", elastic\n");
    }
    struct wb_text relaxation = {0};
    wb_law_append_relaxation(&relaxation, law);
    if (law->n_maxwell > 0)
        printf("  relaxation: %s\n", wb_text_string(&relaxation));
    wb_text_release(&relaxation);
    print_correlation(c);
    if (wb_law_is_plain(law))
        return;
    printf(
        "Ludwik equivalent, isotropic, of the first loading only (misfit %.2f %% of M; not valid "
        "for unloading)\n",
        c->ludwik_misfit / WB_PERCENT);
    printf("  E %s MPa,", wb_print_number(c->ludwik.youngs_modulus / WB_MPA, a));
    printf(" sigma_Y %s MPa,", wb_print_number(c->ludwik.yield_stress / WB_MPA, a));
    printf(" K %s MPa,", wb_print_number(c->ludwik.strength_coefficient / WB_MPA, a));
    printf(" n %s\n", wb_print_number(c->ludwik.hardening_exponent, a));
}

static void print_specimens(const struct wb_cycle_calibration *c)
{
    printf("%-9s %6s %14s %9s %9s %11s %9s %9s %14s %9s\n", "specimen", "L mm", "bow mm",
           "uneven mm", "level mm", "residual mm", "misfit %", "EI N mm2", "residual ratio",
           "outliers");
    for (int i = 0; i < c->n_members; i++) {
        const struct wb_cycle_member *const member = &c->members[i];
        const struct wb_cycle_answer *const answer = &member->answers[c->chosen];
        const struct wb_cycle_fit *const fit = &answer->fit;
        const double length = member->data.info.length;
        const struct wb_cycle_bow bow = wb_cycle_fit_bow(fit, length);
        char rigidity[WB_PRINT_NUMBER], residual_curvature_ratio[WB_PRINT_NUMBER],
            left[WB_PRINT_NUMBER];
        printf("%-9d %6g %6.2f +- %4.2f %9.2f %9.2f %11s %9.3f %9s %14s %9d%s%s\n", member->sample,
               length / WB_MM, bow.tip / WB_MM, bow.deviation / WB_MM, bow.uneven / WB_MM,
               /* Adding zero avoids "-0.00". */
               round(100.0 * fit->level / WB_MM) / 100.0 + 0.0,
               wb_print_number(member->data.residual_deflection / WB_MM, left),
               fit->misfit / WB_PERCENT,
               wb_print_number(answer->value[WB_CYCLE_RIGIDITY] / WB_NMM2, rigidity),
               c->has_unloading ? wb_print_number(answer->value[WB_CYCLE_RESIDUAL_CURVATURE],
                                                  residual_curvature_ratio)
                                : "-",
               fit->n_outliers + member->data.n_outliers,
               fit->is_converged ? "" : "  did not converge",
               fit->is_at_bound ? "  at a bound" : "");
    }
    printf("uneven: natural offset of the middle from that of an even curvature\n");
    if (c->has_unloading)
        printf("residual mm: measured deflection at which the force has returned to its value at "
               "zero deflection\nresidual ratio: residual curvature over the largest curvature\n");
    if (c->specimens_for_5_percent > 0)
        printf("specimens needed for EI within +-5 %%: %d\n", c->specimens_for_5_percent);
}

/* Standard uncertainties; those in brackets are not part of the intervals. */
static void print_budget(const struct wb_cycle_calibration *c)
{
    struct wb_budget_column columns[WB_BUDGET_COLUMNS];
    char name[WB_BUDGET_TEXT], value[WB_PRINT_NUMBER];
    const int n = wb_cycle_budget_columns(c, columns);
    bool is_stated = true;
    printf("standard uncertainty, %%, and its contributions:\n");
    for (int k = 0; k < n; k++)
        printf("  %c: %s\n", 'a' + k, columns[k].name);
    printf("%-42s", "");
    for (int k = 0; k < n; k++)
        printf(" %9c", 'a' + k);
    printf("\n");
    for (int i = 0; i < WB_CONTRIBUTIONS; i++) {
        if (!wb_cycle_budget_has(c, i))
            continue;
        wb_cycle_budget_row(c, i, name);
        printf("  %-40s", name);
        for (int k = 0; k < n; k++) {
            const double u = wb_cycle_budget_cell(&c->budget[columns[k].number], i, &is_stated);
            snprintf(value, sizeof value, is_stated ? "%.2f" : "(%.2f)", u / WB_PERCENT);
            printf(" %9s", isfinite(u) ? value : "unknown");
        }
        printf("\n");
    }
    printf("  %-40s", "combined");
    for (int k = 0; k < n; k++)
        printf(" %9.2f", c->budget[columns[k].number].combined / WB_PERCENT);
    printf("\n  %-40s", "degrees of freedom");
    for (int k = 0; k < n; k++)
        printf(" %9.1f", c->budget[columns[k].number].effective_degrees);
    printf("\n  %-40s", "factor for 95 %");
    for (int k = 0; k < n; k++)
        printf(" %9.2f", c->budget[columns[k].number].factor);
    printf("\n");
}

static void print_all(const struct wb_calibrate_cycle *cycle)
{
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    const struct wb_test_info *const info = &c->members[0].data.info;
    struct wb_text settings = {0};
    const double length = wb_cycle_calibrate_length(c);
    printf("wire %s, ", info->wire);
    if (isfinite(length))
        printf("L = %g mm, ", length / WB_MM);
    printf("%d specimen%s, first cycle%s\n", c->n_members, c->n_members == 1 ? "" : "s",
           info->is_virtual      ? ", virtual rig"
           : info->is_simulation ? ", simulation"
                                 : "");
    print_numbers(c, &cycle->settings);
    print_rule(c);
    print_law(c);
    print_specimens(c);
    print_budget(c);
    for (int i = 0; i < cycle->remarks.n; i++)
        printf("%s: %s\n", wb_cycle_check_severity_name(cycle->remarks.items[i].severity),
               cycle->remarks.items[i].text);
    wb_cycle_calibrate_settings_text(&cycle->settings, &settings);
    printf("settings: %s\n", wb_text_string(&settings));
    wb_text_release(&settings);
}

static void append_found(struct wb_text *text, const struct wb_cycle_calibration *c)
{
    const struct wb_test_info *const info = &c->members[0].data.info;
    struct wb_properties properties;
    wb_properties_from_cycle(c, &properties);
    wb_text_append(text, "%s (%s, %d specimen%s): ", info->wire, wb_finding_source(info),
                   c->n_members, c->n_members == 1 ? "" : "s");
    wb_finding_append_quantity(text, &properties, WB_QUANTITY_MOMENT, WB_CYCLE_MOMENTS - 1);
    wb_text_append(text, "; ");
    const enum wb_quantity_id stiffness =
        c->has_unloading ? WB_QUANTITY_UNLOADING_STIFFNESS : WB_QUANTITY_SECANT_STIFFNESS;
    const struct wb_cycle_stiffness *const of = c->has_unloading ? &c->unloading : &c->secant;
    int at = wb_cycle_stiffness_near_one(of);
    if (of->curvature[at] < of->resolved) /* determined by the law alone */
        at = wb_cycle_stiffness_resolved(of);
    wb_finding_append_quantity(text, &properties, stiffness, at);
    if (c->has_unloading) {
        wb_text_append(text, "; ");
        wb_finding_append_quantity(text, &properties, WB_QUANTITY_RESIDUAL_CURVATURE_RATIO, 0);
    }
    wb_text_append(text, "; intervals of 95 %%");
}

static void append_trust(struct wb_text *text, const struct wb_calibrate_cycle *cycle)
{
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    const struct wb_cycle_verdict *const v = &cycle->verdict;
    struct wb_properties properties;
    wb_properties_from_cycle(c, &properties);
    switch (v->first) {
    case WB_CYCLE_STOPPED:
        wb_text_append(text, "no: stopped before all laws were fitted to all specimens");
        break;
    case WB_CYCLE_NOT_CONVERGED:
        wb_text_append(text, "no: the fit of a specimen did not converge");
        break;
    case WB_CYCLE_NO_LAW_FITS:
        wb_text_append(text, "no: no law fits loading and unloading within %g %% of F_max",
                       WB_CYCLE_LARGEST_FOLLOWED / WB_PERCENT);
        break;
    case WB_CYCLE_DOUBTFUL:
        wb_text_append(text, "not yet: %d doubt%s above", v->n_doubts, v->n_doubts == 1 ? "" : "s");
        break;
    case WB_CYCLE_UNCERTAIN:
        wb_text_append(text, "no: the uncertainty of %s exceeds %g %% (--at-most)", v->worst,
                       v->at_most / WB_PERCENT);
        break;
    case WB_CYCLE_LOADING_ONLY:
        wb_text_append(text, "for loading only: unloading was not recorded, and the hardening rule "
                             "is not tested");
        break;
    default:
        /* Without the scatter the intervals are those of these specimens, not of the product. */
        wb_text_append(text, "%s: %s, fits loading and unloading within %.2g %% of F_max",
                       v->has[WB_CYCLE_SCATTER_UNKNOWN] ? "for this specimen" : "yes",
                       wb_candidate_name(c->chosen), properties.rms / WB_PERCENT);
        if (v->has[WB_CYCLE_SCATTER_UNKNOWN])
            wb_text_append(text, "; one specimen cannot show how specimens differ");
    }
}

static void append_next(struct wb_text *text, const struct wb_calibrate_cycle *cycle,
                        const char *output)
{
    static const char *const next[WB_CYCLE_RESTRICTIONS] = {
        [WB_CYCLE_STOPPED] = "run the same command again and let it finish",
        [WB_CYCLE_NO_LAW_FITS] = "look at the curves (wirebench quicklook): a strand that slips, a "
                                 "load cell that creeps; otherwise use the ranges",
        [WB_CYCLE_DOUBTFUL] = "resolve the doubts above, then calibrate again",
        [WB_CYCLE_UNCERTAIN] = "reduce the largest contributions of the budget above",
        [WB_CYCLE_LOADING_ONLY] = "record tests with unloading, then calibrate again",
        [WB_CYCLE_SCATTER_UNKNOWN] = "record at least two more specimens, then calibrate all "
                                     "together",
    };
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    const int first = cycle->verdict.first;
    if (first == WB_CYCLE_NOT_CONVERGED) {
        wb_text_append(text, "run the same command again with a larger --fit-iterations (now %d)",
                       cycle->settings.fit.max_iterations);
    } else if (first < WB_CYCLE_RESTRICTIONS) {
        wb_text_append(text, "%s", next[first]);
    } else {
        wb_finding_append_validate(text, output, c->members[0].data.info.wire, "length");
    }
}

void wb_calibrate_cycle_print(const struct wb_calibrate_cycle *cycle, const char *output,
                              const char *figure)
{
    struct wb_finding finding = {.figure = figure};
    print_all(cycle);
    append_found(&finding.found, &cycle->calibration);
    append_trust(&finding.trust, cycle);
    append_next(&finding.next, cycle, output);
    wb_finding_print(&finding);
}

enum wb_status wb_calibrate_cycle_draw(const struct wb_calibrate_cycle *cycle, const char *path)
{
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    const struct wb_test_info *const info = &c->members[0].data.info;
    const int panels = c->n_members < WB_FIGURES_CYCLE_MOST ? c->n_members : WB_FIGURES_CYCLE_MOST;
    struct wb_figure *figure;
    struct wb_text footer = {0};
    WB_TRY(wb_figure_create(&figure, "calibration", panels == 1 ? 280.0 : 180.0 * panels, 220.0));
    wb_figures_cycle_add_panels(figure, c, wb_palette_wire(0));
    wb_text_append_escaped(&footer, info->wire);
    wb_text_append(&footer, " (%s), law: %s", wb_finding_source(info),
                   wb_candidate_name(c->chosen));
    if (c->n_members > panels)
        wb_text_append(&footer, "; the first %d of %d specimens", panels, c->n_members);
    wb_figure_set_footer(figure, wb_text_string(&footer));
    const enum wb_status status = wb_figure_write_svg(figure, path);
    wb_text_release(&footer);
    wb_figure_destroy(figure);
    return status;
}

static void put_settings(struct wb_json *object, const struct wb_cycle_calibrate_settings *settings)
{
    for (int t = 0; t < WB_CYCLE_CALIBRATE_TABLES; t++) {
        const struct wb_setting_table *const table = &wb_cycle_calibrate_tables[t];
        for (size_t i = 0; i < table->n; i++)
            wb_setting_set_json(&table->rows[i], (const char *)settings + table->offset, object);
    }
}

void wb_calibrate_cycle_print_json(const struct wb_calibrate_cycle *cycle)
{
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    const struct wb_test_info *const info = &c->members[0].data.info;
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "wire", info->wire);
    wb_json_set_text(root, "method", "cycle");
    wb_json_set_number(root, "length_mm", wb_cycle_calibrate_length(c) / WB_MM);
    wb_json_set_integer(root, "samples", c->n_members);
    wb_json_set_boolean(root, "virtual_rig", info->is_virtual);
    wb_json_set_boolean(root, "simulation", info->is_simulation);
    wb_cycle_json_put(root, c);
    wb_cycle_check_put(wb_json_set_array(root, "remarks"), &cycle->remarks);
    put_settings(wb_json_set_object(root, "settings"), &cycle->settings);
    wb_json_set_number(root, "cpu_s", c->cpu_s);
    wb_command_print_json(root);
}
