#include "analysis/cards/card_mujoco.h"

#include <math.h>

#include "analysis/cards/card_chain.h"
#include "analysis/cards/card_curve.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "card"

/* m: length of a wire whose file gives none. */
static const double assumed_length = 0.1;
/* Time step of the card as part of the largest stable one. */
static const double safe_share = 0.5;
/* kg m2: mjMINVAL of the engine, which rejects a smaller mass or inertia. */
static const double least_inertia = 1e-15;

struct model {
    struct wb_card_chain chain;
    struct wb_card_chain_modes modes;
    double secant, low, high; /* N m2; NaN unknown */
    double curvature;         /* 1/m, of the secant */
    double relaxation;        /* s: damping over stiffness */
    double largest_step;      /* s */
};

static enum wb_status make_model(struct model *model, const struct wb_card_source *source,
                                 const struct wb_card_settings *settings, struct wb_reason *why)
{
    const struct wb_properties *const p = &source->properties;
    const double length = settings->length > 0.0 ? settings->length : p->calibration_length;
    if (!(p->mass_per_length > 0.0))
        return wb_fail_to(
            why, WB_ERR_UNSUPPORTED,
            "%s: mass_per_length_kg_m is %g, expected more than 0: bodies need a mass",
            source->file, p->mass_per_length);
    model->curvature = settings->curvature;
    WB_TRY(wb_card_curve_secant(source, settings->curvature, &model->secant, &model->low,
                                &model->high));
    model->chain = (struct wb_card_chain){
        .n = settings->segments,
        .length = isfinite(length) ? length : assumed_length,
        .diameter = p->outer_diameter,
        .mass_per_length = p->mass_per_length,
        .bending = model->secant,
        .torsion = model->secant / (1.0 + p->law.material.poissons_ratio),
    };
    const struct wb_card_chain_segment last =
        wb_card_chain_segment(&model->chain, model->chain.n - 1);
    if (!(last.along > least_inertia))
        return wb_fail_to(why, WB_ERR_UNSUPPORTED,
                          "%s: the last segment's moment of inertia is %.2g kg m2, but the engine "
                          "needs at least %g: use fewer --segments or a longer wire",
                          source->file, last.along, least_inertia);
    WB_TRY(wb_card_chain_modes(&model->chain, &model->modes));
    model->relaxation = 2.0 * settings->damping_ratio / model->modes.lowest_bending;
    model->largest_step = 2.0 / fmax(model->modes.highest_bending, model->modes.highest_torsion);
    return WB_OK;
}

static void put_stiffness_words(struct wb_text *text, const struct model *model)
{
    wb_text_append(
        text,
        "  LOADING ONLY: the joints are linear springs, without yielding or residual curvature.\n");
    if (model->curvature > 0.0)
        wb_text_append(text, "  Stiffness: secant M / kappa at a curvature of %.6g 1/m, %.6g N m2",
                       model->curvature, model->secant);
    else
        wb_text_append(text, "  Stiffness: that of the virgin wire, %.6g N m2", model->secant);
    if (isfinite(model->low) && isfinite(model->high))
        wb_text_append(text, ", interval of 95 %% %.6g to %.6g.\n", model->low, model->high);
    else
        wb_text_append(text, ", its interval is unknown.\n");
}

static void put_words(struct wb_text *text, const struct model *model,
                      const struct wb_card_source *source, const struct wb_card_settings *settings)
{
    const struct wb_card_chain *const chain = &model->chain;
    put_stiffness_words(text, model);
    wb_text_append(text,
                   "  Chain: %d joints at the middles of parts of %.6g m, each with the stiffness "
                   "of its part, EI / h;\n"
                   "  the first half part is clamped. The tip deflection "
                   "under a transverse force is too small by 1 / (4 n^2): %.2g.\n",
                   chain->n, chain->length / chain->n, 0.25 / (chain->n * chain->n));
    wb_text_append(
        text,
        "  ASSUMED, not measured: torsion GJ = EI / (1 + nu) = %.6g N m2, of a solid circle of one "
        "material with nu %g.\n"
        "  ASSUMED, not measured: damping proportional to stiffness, with a "
        "damping ratio of %g in the first bending mode (%.4g rad/s).\n",
        chain->torsion, source->properties.law.material.poissons_ratio, settings->damping_ratio,
        model->modes.lowest_bending);
    wb_text_append(text,
                   "  Largest stable time step (Euler, without damping): %.4g s, due to %s; for "
                   "bending alone %.4g s. The option below is half of it.\n",
                   model->largest_step,
                   model->modes.highest_torsion > model->modes.highest_bending ? "torsion"
                                                                               : "bending",
                   2.0 / model->modes.highest_bending);
    wb_text_append(text, "  Segments collide with other bodies, but not with each other. Written "
                         "for MuJoCo 2.2.2; angles in rad, the wire along x.\n");
}

static void put_defaults(struct wb_text *text, const struct model *model)
{
    const struct wb_card_chain *const chain = &model->chain;
    const double h = chain->length / chain->n;
    const double bend = chain->bending / h, twist = chain->torsion / h;
    wb_text_append(text,
                   "  <compiler angle=\"radian\"/>\n"
                   "  <option timestep=\"%.6g\" integrator=\"Euler\" gravity=\"0 0 -%.5f\"/>\n",
                   safe_share * model->largest_step, WB_STANDARD_GRAVITY);
    wb_text_append(text,
                   "  <default>\n"
                   "    <geom type=\"capsule\" size=\"%.9g\" contype=\"1\" conaffinity=\"0\"/>\n"
                   "    <joint type=\"hinge\"/>\n"
                   "    <default class=\"bend\">\n"
                   "      <joint stiffness=\"%.9g\" damping=\"%.9g\"/>\n"
                   "    </default>\n"
                   "    <default class=\"twist\">\n"
                   "      <joint axis=\"1 0 0\" stiffness=\"%.9g\" damping=\"%.9g\"/>\n"
                   "    </default>\n"
                   "  </default>\n",
                   0.5 * chain->diameter, bend, bend * model->relaxation, twist,
                   twist * model->relaxation);
}

static void put_segment(struct wb_text *text, const struct wb_card_chain *chain, int i)
{
    const double h = chain->length / chain->n;
    const struct wb_card_chain_segment segment = wb_card_chain_segment(chain, i);
    wb_text_append(text,
                   "    <body name=\"segment%d\" pos=\"%.9g 0 0\">\n"
                   "      <joint name=\"bend_y%d\" class=\"bend\" axis=\"0 1 0\"/>\n"
                   "      <joint name=\"bend_z%d\" class=\"bend\" axis=\"0 0 1\"/>\n"
                   "      <joint name=\"twist%d\" class=\"twist\"/>\n",
                   i + 1, i == 0 ? 0.5 * h : h, i + 1, i + 1, i + 1);
    wb_text_append(text,
                   "      <inertial pos=\"%.9g 0 0\" mass=\"%.9g\" diaginertia=\"%.9g %.9g "
                   "%.9g\"/>\n"
                   "      <geom fromto=\"0 0 0 %.9g 0 0\"/>\n",
                   0.5 * segment.length, segment.mass, segment.along, segment.across,
                   segment.across, segment.length);
}

enum wb_status wb_card_mujoco(const struct wb_card_source *source,
                              const struct wb_card_settings *settings, struct wb_text *text,
                              struct wb_reason *why)
{
    struct model model;
    WB_TRY(make_model(&model, source, settings, why));
    const struct wb_card_chain *const chain = &model.chain;
    wb_text_append(text, "<!--");
    wb_card_source_append(source, "MuJoCo card", "  ", text);
    put_words(text, &model, source, settings);
    wb_text_append(text, "-->\n<mujoco model=\"wire\">\n");
    put_defaults(text, &model);
    wb_text_append(text,
                   "  <worldbody>\n"
                   "    <geom name=\"clamp\" fromto=\"0 0 0 %.9g 0 0\"/>\n",
                   0.5 * chain->length / chain->n);
    for (int i = 0; i < chain->n; i++)
        put_segment(text, chain, i);
    wb_text_append(text, "      <site name=\"tip\" pos=\"%.9g 0 0\"/>\n   ",
                   0.5 * chain->length / chain->n);
    for (int i = 0; i < chain->n; i++)
        wb_text_append(text, "%s</body>", i > 0 && i % 10 == 0 ? "\n    " : " ");
    wb_text_append(text, "\n  </worldbody>\n</mujoco>\n");
    return WB_OK;
}
