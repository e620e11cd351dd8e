#include "analysis/predict/bands_output.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "analysis/dataset/csv_table.h"
#include "analysis/keys/row.h"
#include "base/file.h"
#include "base/number.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "bands"

enum {
    DRAWN = 4 /* most cases in a panel */
};

static const double width = 560.0, height = 250.0; /* points */

static const struct wb_bands_place *last_force(const struct wb_bands_case *c)
{
    return c->n_force > 0 ? &c->force[c->n_force - 1] : NULL;
}

static const char *outline(const struct wb_bands_case *c)
{
    return c->layers == 0.0 ? "none" : c->is_round ? "circle" : "hull";
}

/* --- CSV --- */

static void put(struct wb_text *text, double value, double unit)
{
    char number[WB_NUMBER_TEXT];
    wb_text_append(text, ",%s", isfinite(value) ? wb_number_format(value / unit, number) : "");
}

static void put_band(struct wb_text *text, const struct wb_bands_interval *band, double unit)
{
    put(text, band->median, unit);
    put(text, band->wide_low, unit);
    put(text, band->wide_high, unit);
    put(text, band->low, unit);
    put(text, band->high, unit);
}

static void put_ratio(struct wb_text *text, const struct wb_bands_case *c, const char *key,
                      const struct wb_bands_interval *ratio)
{
    if (!isfinite(ratio->median) || !last_force(c))
        return;
    wb_text_append(text, "%s,%s", c->variant.name, key);
    put(text, last_force(c)->at, WB_MM);
    put_band(text, ratio, 1.0);
    wb_text_append(text, "\n");
}

static void put_bands(struct wb_text *text, const struct wb_bands_case *c)
{
    const char *const name = c->variant.name;
    for (int i = 0; i < c->n_force; i++) {
        wb_text_append(text, "%s,force_N", name);
        put(text, c->force[i].at, WB_MM);
        put_band(text, &c->force[i].band, 1.0);
        wb_text_append(text, "\n");
    }
    for (int i = 0; i < c->n_moment; i++) {
        wb_text_append(text, "%s,moment_N_mm", name);
        put(text, c->moment[i].at, 1.0);
        put_band(text, &c->moment[i].band, WB_MM);
        wb_text_append(text, "\n");
    }
    put_ratio(text, c, "deflection_springback", &c->springback);
    put_ratio(text, c, "residual_curvature_ratio", &c->residual_curvature_ratio);
}

static enum wb_status write_bands(const struct wb_bands *bands, const char *folder)
{
    struct wb_text text = {0};
    wb_text_append(&text, "case,quantity,at,median,low,high,runs_low,runs_high\n");
    for (int i = 0; i < bands->n_cases; i++)
        put_bands(&text, &bands->cases[i]);
    const enum wb_status status = wb_csv_table_write(folder, "bands.csv", &text);
    wb_text_release(&text);
    return status;
}

static enum wb_status write_cases(const struct wb_bands *bands, const char *folder)
{
    struct wb_text text = {0};
    wb_text_append(&text, "case,wires,packing,layers,outline,runs,lost,limited,deflection_mm,"
                          "force_N,force_low_N,force_high_N,force_runs_low_N,force_runs_high_N,"
                          "deflection_springback,deflection_springback_low,deflection_springback_"
                          "high,deflection_springback_runs_low,"
                          "deflection_springback_runs_high,residual_curvature_ratio,"
                          "residual_curvature_ratio_low,residual_curvature_ratio_high,"
                          "residual_curvature_ratio_runs_low,residual_curvature_ratio_runs_high\n");
    for (int i = 0; i < bands->n_cases; i++) {
        const struct wb_bands_case *const c = &bands->cases[i];
        const struct wb_bands_place *const last = last_force(c);
        const double none = (double)NAN;
        const struct wb_bands_interval nothing = {none, none, none, none, none};
        wb_text_append(&text, "%s,%d,%s", c->variant.name, c->n_wires, c->packing);
        put(&text, c->layers, 1.0);
        wb_text_append(&text, ",%s,%d,%d,%d", outline(c), c->n_runs, c->n_lost, c->n_limited);
        put(&text, last ? last->at : none, WB_MM);
        put_band(&text, last ? &last->band : &nothing, 1.0);
        put_band(&text, &c->springback, 1.0);
        put_band(&text, &c->residual_curvature_ratio, 1.0);
        wb_text_append(&text, "\n");
    }
    const enum wb_status status = wb_csv_table_write(folder, "cases.csv", &text);
    wb_text_release(&text);
    return status;
}

/* --- figure --- */

static void draw_case(struct wb_panel *panel, const struct wb_bands_case *c, int index,
                      const struct wb_bands_place *places, int n, double x_unit, double y_unit)
{
    double x[WB_BANDS_ROWS + 1], y[WB_BANDS_ROWS + 1], low[WB_BANDS_ROWS + 1],
        high[WB_BANDS_ROWS + 1];
    const double *const edges[2] = {low, high};
    const struct wb_colour colour = wb_palette_sample(index);
    const struct wb_figure_style style = {.colour = colour, .width = 1.4};

    for (int i = 0; i < n; i++) {
        const struct wb_bands_interval *const band = &places[i].band;
        x[i] = places[i].at / x_unit;
        y[i] = band->median / y_unit;
        low[i] = band->wide_low / y_unit;
        high[i] = band->wide_high / y_unit;
    }
    if (n < 2)
        return;
    wb_figure_add_band(panel, NULL, (size_t)n, x, edges, wb_palette_fade(colour, 0.25));
    wb_figure_add_line(panel, c->variant.name, (size_t)n, x, y, &style);
}

void wb_bands_output_draw(const struct wb_bands *bands, struct wb_figure *figure,
                          struct wb_panel *panels[WB_BANDS_OUTPUT_PANELS])
{
    const int n = bands->n_cases < DRAWN ? bands->n_cases : DRAWN;
    for (int i = 0; i < WB_BANDS_OUTPUT_PANELS; i++)
        panels[i] = wb_figure_add_panel(figure);
    wb_figure_set_axes(panels[0], "Deflection (mm)", "Force (N)");
    wb_figure_set_axes(panels[1], "Curvature (1/m)", "Moment (N mm)");
    for (int i = 0; i < n; i++) {
        const struct wb_bands_case *const c = &bands->cases[i];
        draw_case(panels[0], c, i, c->force, c->n_force, WB_MM, 1.0);
        draw_case(panels[1], c, i, c->moment, c->n_moment, 1.0, WB_MM);
    }
}

static enum wb_status write_figure(const struct wb_bands *bands, const char *folder)
{
    struct wb_panel *panels[WB_BANDS_OUTPUT_PANELS];
    struct wb_figure *figure;
    char path[WB_PATH];

    WB_TRY(wb_file_join(path, folder, "bands.svg"));
    WB_TRY(wb_figure_create(&figure, "bands", width, height));
    wb_bands_output_draw(bands, figure, panels);
    wb_figure_set_footer(figure, "predicted by the section model; lines: medians, bands: 90 % with "
                                 "the model's error");
    const enum wb_status status = wb_figure_write_svg(figure, path);
    wb_figure_destroy(figure);
    return status;
}

static enum wb_status remove_file(const char *folder, const char *name)
{
    char path[WB_PATH];
    WB_TRY(wb_file_join(path, folder, name));
    if (unlink(path) == 0 || errno == ENOENT)
        return WB_OK;
    return wb_fail(WB_ERR_IO, "'%s' cannot be removed: %s", path, strerror(errno));
}

enum wb_status wb_bands_output_write(const struct wb_bands *bands, const char *folder)
{
    if (!bands) {
        WB_TRY(wb_csv_table_write(folder, "bands.csv", NULL));
        WB_TRY(wb_csv_table_write(folder, "cases.csv", NULL));
        return remove_file(folder, "bands.svg");
    }
    WB_TRY(write_bands(bands, folder));
    WB_TRY(write_cases(bands, folder));
    return write_figure(bands, folder);
}

/* --- JSON --- */

#define BAND_OF(member) WB_AT(struct wb_bands_interval, member)
#define SHARE(member) WB_AT(struct wb_ranking_share, member)
#define RANKING(member) WB_AT(struct wb_bands_ranking, member)
#define CASE(member) WB_AT(struct wb_bands_case, member)

static const struct wb_key interval_rows[] = {
    {"median", BAND_OF(median) | UNKNOWN, "median of the runs"},
    {"low", BAND_OF(wide_low) | UNKNOWN, "lower end of the band of 90 %, with the model's error"},
    {"high", BAND_OF(wide_high) | UNKNOWN, "upper end of that band"},
    {"runs_low", BAND_OF(low) | UNKNOWN, "5 % quantile of the runs alone"},
    {"runs_high", BAND_OF(high) | UNKNOWN, "95 % quantile of the runs alone"},
};
static WB_KEYS(interval, "band", "A band of a predicted number, in the unit of its key.");

static const struct wb_key group_rows[] = {
    {"group", TEXT, "group of inputs"},
    {"share", SHARE(share), "share of the ranks' variance that this group explains"},
    {"share_low", SHARE(low), "lower end of its interval of 90 %"},
    {"share_high", SHARE(high), "upper end of its interval of 90 %"},
};
static WB_KEYS(group, "ranking_group", "The influence of a group of inputs.");

static const struct wb_key ranking_rows[] = {
    {"of", RANKING(of), "result that the ranking is of", .choices = "force|deflection_springback"},
    {"deflection_mm", RANKING(at) | UNKNOWN, "deflection at which the result is taken"},
    {"R2", RANKING(ranking.r2) | UNKNOWN, "share of the variance that ranks explain"},
    {"R2_low", RANKING(ranking.low) | UNKNOWN, "lower end of its interval"},
    {"R2_high", RANKING(ranking.high) | UNKNOWN, "upper end of its interval"},
    {"groups", OBJECT | LIST | OPTIONAL, "the groups of inputs; only from R2 = 0.9 on",
     &group_keys},
};
static WB_KEYS(ranking, "ranking", "Which inputs the width of a band depends on.");

static const struct wb_key of_case_rows[] = {
    {"case", CASE(variant.name),
     "`file`, or the name of a scenario or of a combination of the sweep"},
    {"wires", CASE(n_wires), "number of wires"},
    {"packing", CASE(packing), "packing of the wires"},
    {"tape_layers", CASE(layers), "layers of tape, with overlap; 0: no tape"},
    {"tape_outline", TEXT, "how the tape lies round the wires", .choices = "none|circle|hull"},
    {"runs_not_converged", CASE(n_lost), "runs that were not computed to the end"},
    {"draws_limited", CASE(n_limited), "runs with a drawn law that had to be limited"},
    {"deflection_mm", WB_AT(struct wb_bands_place, at) | OPTIONAL,
     "largest deflection that the band covers"},
    {"force_N", WB_AT(struct wb_bands_place, band) | OPTIONAL, "force at that deflection",
     &interval_keys},
    {"deflection_springback", CASE(springback),
     "springback of the deflection: 1 less the residual over the largest deflection",
     &interval_keys},
    {"residual_curvature_ratio", CASE(residual_curvature_ratio),
     "largest curvature along the bundle at zero force over that at the largest deflection",
     &interval_keys},
    {"ranking", OBJECT | LIST, "which inputs the bands depend on", &ranking_keys},
};
static WB_KEYS(of_case, "prediction_case", "A case that was predicted.");

static const struct wb_key wb_bands_output_rows[] = {
    {"confidence", NUMBER, "probability of the bands"},
    {"model_error", NUMBER, "standard deviation of the model's error, of the largest value"},
    {"runs", WB_AT(struct wb_bands, runs), "runs of each case"},
    {"seed", WB_AT(struct wb_bands, seed), "seed of the draws"},
    {"stopped", WB_AT(struct wb_bands, stopped), "interrupted: the last case is missing"},
    {"laws_of_wires", TEXT | LIST, "source of the law of each kind of wire"},
    {"cases", OBJECT | LIST, "the cases", &of_case_keys},
};
WB_KEYS(wb_bands_output, "uncertainty", "Bands of a bundle's prediction.");

/* Below R2 = 0.9 no shares are written; R2 itself shows why. */
static void append_ranking(struct wb_json *array, const struct wb_bands *bands,
                           const struct wb_bands_ranking *of)
{
    struct wb_json *const object = wb_json_append_object(array);
    WB_PUT(object, &ranking_keys, struct wb_bands_ranking, of);
    if (!of->ranking.is_valid)
        return;
    struct wb_json *const groups = wb_json_set_array(object, "groups");
    for (int g = 0; g < of->ranking.n_groups; g++) {
        const struct wb_ranking_share *const share = &of->ranking.group[g];
        struct wb_json *const item = wb_json_append_object(groups);
        wb_json_set_text(item, "group", bands->inputs.group_name[share->group]);
        WB_PUT(item, &group_keys, struct wb_ranking_share, share);
    }
}

static void append_case(struct wb_json *array, const struct wb_bands *bands,
                        const struct wb_bands_case *c)
{
    struct wb_json *const object = wb_json_append_object(array);
    WB_PUT(object, &of_case_keys, struct wb_bands_case, c);
    wb_json_set_text(object, "tape_outline", outline(c));
    WB_PUT(object, &of_case_keys, struct wb_bands_case, c);
    if (last_force(c))
        WB_PUT(object, &of_case_keys, struct wb_bands_place, last_force(c));
    WB_PUT(object, &of_case_keys, struct wb_bands_case, c);
    struct wb_json *const rankings = wb_json_set_array(object, "ranking");
    for (int i = 0; i < c->n_rankings; i++)
        append_ranking(rankings, bands, &c->ranking[i]);
}

void wb_bands_output_describe(const struct wb_bands *bands, struct wb_json *object)
{
    struct wb_json *const member = wb_json_set_object(object, "uncertainty");
    wb_json_set_number(member, "confidence", 0.9);
    wb_json_set_number(member, "model_error", WB_BANDS_MODEL_ERROR);
    WB_PUT(member, &wb_bands_output_keys, struct wb_bands, bands);
    struct wb_json *const wires = wb_json_set_array(member, "laws_of_wires");
    for (int i = 0; i < bands->inputs.n_types; i++)
        wb_json_append_text(wires, bands->inputs.wires[i].source);
    struct wb_json *const cases = wb_json_set_array(member, "cases");
    for (int i = 0; i < bands->n_cases; i++)
        append_case(cases, bands, &bands->cases[i]);
}

/* --- text --- */

static void append_case_row(struct wb_text *text, const struct wb_bands_case *c, int name_width)
{
    const struct wb_bands_place *const last = last_force(c);
    const struct wb_bands_interval *const s = &c->springback;
    const struct wb_bands_interval *const r = &c->residual_curvature_ratio;
    char range[40] = "";

    wb_text_append(text, "%-*s %5d %-9s %6.3g %-7s", name_width, c->variant.name, c->n_wires,
                   c->packing, c->layers, outline(c));
    if (last) {
        snprintf(range, sizeof range, "(%.4g to %.4g)", last->band.wide_low, last->band.wide_high);
        wb_text_append(text, " %6.4g  %-6.4g %-19s", last->at / WB_MM, last->band.median, range);
    }
    if (last && isfinite(s->median))
        wb_text_append(text, "  %.3f (%.3f to %.3f)  %.3f (%.3f to %.3f)", s->median, s->wide_low,
                       s->wide_high, r->median, r->wide_low, r->wide_high);
    wb_text_append(text, "\n");
}

static void append_ranking_text(struct wb_text *text, const struct wb_bands *bands,
                                const struct wb_bands_ranking *of)
{
    const struct wb_ranking *const found = &of->ranking;
    wb_text_append(
        text, "\n%s at %.3g mm depends on (R2 %.3f, %.3f to %.3f)%s\n", of->of, of->at / WB_MM,
        found->r2, found->low, found->high,
        found->is_valid
            ? ":"
            : ": no ranking, because ranks of the inputs do not explain it (R2 below 0.9)");
    for (int g = 0; found->is_valid && g < found->n_groups; g++) {
        const struct wb_ranking_share *const share = &found->group[g];
        wb_text_append(text, "    %5.1f %%  (%.1f to %.1f)  %s\n", share->share / WB_PERCENT,
                       share->low / WB_PERCENT, share->high / WB_PERCENT,
                       bands->inputs.group_name[share->group]);
    }
}

void wb_bands_output_summarise(const struct wb_bands *bands, struct wb_text *text)
{
    int name_width = (int)strlen("case");
    for (int i = 0; i < bands->n_cases; i++) {
        const int length = (int)strlen(bands->cases[i].variant.name);
        name_width = length > name_width ? length : name_width;
    }
    wb_text_append(text, "90 %% bands of %d runs a case, with the model's %g %%\n\n", bands->runs,
                   WB_BANDS_MODEL_ERROR / WB_PERCENT);
    wb_text_append(text,
                   "%-*s%68s%-24s%s\n%-*s wires packing   layers outline     mm  %-28s%-24s%s\n",
                   name_width, "", "", "springback of the", "residual curvature", name_width,
                   "case", "force N (low to high)", "deflection", "ratio (low to high)");
    for (int i = 0; i < bands->n_cases; i++)
        append_case_row(text, &bands->cases[i], name_width);
    for (int i = 0; bands->n_cases > 0 && i < bands->cases[0].n_rankings; i++)
        append_ranking_text(text, bands, &bands->cases[0].ranking[i]);
}
