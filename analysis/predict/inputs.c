#include "analysis/predict/inputs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/calibration/properties/properties.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "bands"

enum {
    TOLERANCES = 3 /* inputs of a law without specimens */
};

/* Relative difference up to which diameters are equal. */
static const double same_diameter = 1e-6;

/* --- wires --- */

/* Typical largest strain of wires in bending tests. */
static const double tested_strain = 0.02;

/* Keeps the hardening rule of a law. Wires are drawn with the law's Ludwik equivalent and this
 * rule. Combined hardening of parallel parts becomes mixed hardening: its isotropic share is the
 * part of the stress at the tested strain that comes from the growth of the yield limits. */
static void keep_rule(struct wb_inputs_wires *wires, const struct wb_law *law)
{
    wires->isotropic_share = law->isotropic_share;
    wires->is_combined = law->is_combined;
    if (law->form != WB_LAW_PARALLEL || !law->is_combined)
        return;
    struct wb_law perfect = *law;
    perfect.isotropic_share = 0.0;
    wires->is_combined = false;
    wires->isotropic_share = 1.0 - wb_law_virgin_stress(&perfect, tested_strain, NULL) /
                                       wb_law_virgin_stress(law, tested_strain, NULL);
}

static void keep_law(struct wb_inputs_wires *wires, const struct wb_bundle_spread *spread,
                     const struct wb_material *law)
{
    wb_specimens_quantities(law, wires->mean);
    wires->tolerance[0] = spread->youngs_modulus;
    wires->tolerance[1] = spread->yield_stress;
    wires->tolerance[2] = spread->stress;
}

static enum wb_status check_properties(const struct wb_properties *p,
                                       const struct wb_bundle_spread *spread,
                                       const struct wb_wire *wire, const char *path)
{
    if (fabs(p->outer_diameter - wire->outer_diameter) > same_diameter * wire->outer_diameter)
        return wb_fail(WB_ERR_ARGUMENT,
                       "%s:%d: properties: %s is of a wire of %g mm, but %s has %g mm: set "
                       "outer_diameter_mm in its file to that of the calibrated wire",
                       path, spread->line, spread->properties, p->outer_diameter / WB_MM,
                       wire->name, wire->outer_diameter / WB_MM);
    if (p->n_specimens >= WB_SPECIMENS_LEAST && spread->has_tolerances)
        return wb_fail(WB_ERR_ARGUMENT,
                       "%s:%d: wire %s: %s has %d specimens, whose scatter is used: remove the "
                       "tolerances youngs_modulus_percent, yield_stress_percent and stress_percent",
                       path, spread->line, wire->name, spread->properties, p->n_specimens);
    if (p->n_specimens < WB_SPECIMENS_LEAST && !spread->has_tolerances)
        return wb_fail(WB_ERR_ARGUMENT,
                       "%s:%d: wire %s: %s has %d specimens, but their scatter needs at least %d: "
                       "add youngs_modulus_percent, yield_stress_percent and stress_percent, or "
                       "calibrate on more specimens by whole cycles",
                       path, spread->line, wire->name, spread->properties, p->n_specimens,
                       WB_SPECIMENS_LEAST);
    return WB_OK;
}

static enum wb_status take_properties(struct wb_inputs_wires *wires,
                                      const struct wb_bundle_spread *spread,
                                      const struct wb_wire *wire, const char *path)
{
    struct wb_properties *const p = wb_memory_new(1, sizeof *p);
    enum wb_status status = wb_properties_read(spread->properties, p);
    if (status == WB_OK)
        status = check_properties(p, spread, wire, path);
    if (status == WB_OK) {
        keep_rule(wires, &p->law);
        wires->from_specimens = wb_specimens_take(&wires->specimens, p);
        if (!wires->from_specimens)
            keep_law(wires, spread, &p->material);
        if (wires->from_specimens)
            snprintf(wires->source, sizeof wires->source, "%d specimens of %.60s", p->n_specimens,
                     wb_file_name(spread->properties));
        else
            snprintf(wires->source, sizeof wires->source, "tolerances about %.60s",
                     wb_file_name(spread->properties));
    }
    free(p);
    return status;
}

static enum wb_status take_wires(struct wb_inputs *inputs, const struct wb_bundle_model *model,
                                 int type)
{
    const struct wb_wire *const wire = &model->type[type];
    struct wb_inputs_wires *const wires = &inputs->wires[type];
    const struct wb_bundle_spread *spread = NULL;

    for (int i = 0; i < model->uncertainty.n_wires && !spread; i++)
        if (strcmp(model->uncertainty.wire[i].wire, wire->name) == 0)
            spread = &model->uncertainty.wire[i];
    if (!spread)
        return wb_fail(WB_ERR_ARGUMENT,
                       "%s: uncertainty: wires: %s is missing: add {wire: %s, properties: FILE} "
                       "with the file of its calibration, or {wire: %s, youngs_modulus_percent: "
                       "..., yield_stress_percent: ..., stress_percent: ...}",
                       model->path, wire->name, wire->name, wire->name);
    if (spread->properties[0])
        return take_properties(wires, spread, wire, model->path);
    keep_rule(wires, &wire->law);
    keep_law(wires, spread, &wire->material);
    snprintf(wires->source, sizeof wires->source, "tolerances about the wire's file");
    return WB_OK;
}

static enum wb_status check_names(const struct wb_bundle_model *model)
{
    for (int i = 0; i < model->uncertainty.n_wires; i++) {
        const struct wb_bundle_spread *const spread = &model->uncertainty.wire[i];
        int type = 0;
        while (type < model->n_types && strcmp(model->type[type].name, spread->wire) != 0)
            type++;
        if (type == model->n_types)
            return wb_fail(WB_ERR_ARGUMENT,
                           "%s:%d: wire: the bundle has no wire %s: expected the `name` of one of "
                           "its wires' files",
                           model->path, spread->line, spread->wire);
    }
    return WB_OK;
}

/* --- the list_groups of inputs --- */

static void add_group(struct wb_inputs *inputs, const char *name, int n_columns, int n_dimensions)
{
    snprintf(inputs->group_name[inputs->n_groups], sizeof inputs->group_name[0], "%s", name);
    for (int i = 0; i < n_columns; i++)
        inputs->group[inputs->n_columns++] = inputs->n_groups;
    inputs->n_dimensions += n_dimensions;
    inputs->n_groups++;
}

static void list_groups(struct wb_inputs *inputs, const struct wb_bundle_model *model)
{
    for (int i = 0; i < inputs->n_types; i++) {
        const struct wb_inputs_wires *const wires = &inputs->wires[i];
        char name[WB_INPUTS_NAME];
        snprintf(name, sizeof name, "law of %s", model->type[i].name);
        if (wires->from_specimens)
            add_group(inputs, name, WB_SPECIMENS_QUANTITIES,
                      wb_specimens_dimensions(&wires->specimens));
        else
            add_group(inputs, name, TOLERANCES, TOLERANCES);
    }
    add_group(inputs, "diameter with pitch", 1, 1);
    add_group(inputs, "pitch alone", 1, 1);
    add_group(inputs, "length", 1, 1);
    add_group(inputs, "tape", 3, 3);
    add_group(inputs, "bond of the tape", 1, 1);
    add_group(inputs, "friction", 1, 1);
}

static const char example[] =
    "uncertainty:\n"
    "  wires: [{wire: %s, properties: FILE}]   # or tolerances, see docs/file-formats.md\n"
    "  diameter_percent: 1\n"
    "  pitch_percent: 1\n"
    "  length_percent: 0.5\n"
    "  tape: {thickness_percent: 10, youngs_modulus_percent: 10, yield_stress_percent: 10}\n"
    "  cohesive_stiffness_N_mm3: [20, 45]\n"
    "  friction: [0.1, 0.4]";

static enum wb_status check_stated(const struct wb_bundle_model *model)
{
    const struct wb_bundle_uncertainty *const u = &model->uncertainty;
    const char *missing = NULL;

    if (!model->has_uncertainty) {
        char text[sizeof example + sizeof model->type[0].name];
        snprintf(text, sizeof text, example, model->type[0].name);
        return wb_fail(
            WB_ERR_ARGUMENT,
            "%s: uncertainty: this section is missing. Add it, with the values of your bundle:\n%s",
            model->path, text);
    }
    if (model->has_tape && !u->has_tape)
        missing = "tape: {thickness_percent: ..., youngs_modulus_percent: ..., "
                  "yield_stress_percent: ...}";
    else if (model->has_tape && !u->has_cohesion)
        missing = "cohesive_stiffness_N_mm3: [least, largest]";
    else if (model->packing.n > 1 && !u->has_friction)
        missing = "friction: [least, largest]";
    return missing ? wb_fail(WB_ERR_ARGUMENT, "%s: uncertainty: this key is missing: %s",
                             model->path, missing)
                   : WB_OK;
}

enum wb_status wb_inputs_init(struct wb_inputs *inputs, const struct wb_bundle_model *model)
{
    *inputs = (struct wb_inputs){.n_types = model->n_types};
    WB_TRY(check_stated(model));
    inputs->uncertainty = model->uncertainty;
    WB_TRY(check_names(model));
    for (int i = 0; i < model->n_types; i++)
        WB_TRY(take_wires(inputs, model, i));
    list_groups(inputs, model);
    if (inputs->n_columns > WB_RANKING_COLUMNS || inputs->n_groups > WB_RANKING_GROUPS)
        return wb_fail(WB_ERR_UNSUPPORTED, "%s: %d inputs in %d groups: at most %d in %d",
                       model->path, inputs->n_columns, inputs->n_groups, WB_RANKING_COLUMNS,
                       WB_RANKING_GROUPS);
    return WB_OK;
}

/* --- a run --- */

/* The numbers of a run, read in order, and the inputs made from them. */
struct reader {
    const double *u;
    double *values; /* or NULL */
};

static void store(struct reader *reader, double value)
{
    if (reader->values)
        *reader->values++ = value;
}

/* Uniform between 1 - tolerance and 1 + tolerance. */
static double read_factor(struct reader *reader, double tolerance)
{
    const double factor = 1.0 + tolerance * (2.0 * *reader->u++ - 1.0);
    store(reader, factor);
    return factor;
}

static double read_from_range(struct reader *reader, const double range[2])
{
    const double u = *reader->u++;
    const double value = range[0] == range[1] ? range[0] : range[0] * pow(range[1] / range[0], u);
    store(reader, value);
    return value;
}

static bool read_law(const struct wb_inputs_wires *wires, int count, struct reader *reader,
                     struct wb_wire *wire)
{
    double q[WB_SPECIMENS_QUANTITIES];
    if (wires->from_specimens) {
        wb_specimens_draw(&wires->specimens, count, reader->u, q);
        reader->u += wb_specimens_dimensions(&wires->specimens);
        for (int k = 0; k < WB_SPECIMENS_QUANTITIES; k++)
            store(reader, q[k]);
    } else {
        memcpy(q, wires->mean, sizeof q);
        q[0] += log(read_factor(reader, wires->tolerance[0]));
        q[1] += log(read_factor(reader, wires->tolerance[1]));
        const double stress = log(read_factor(reader, wires->tolerance[2]));
        q[2] += stress;
        q[3] += stress;
    }
    const bool is_law = wb_specimens_law(
        q, wb_specimens_most_exponent(wires->isotropic_share, wires->is_combined), &wire->material);
    wb_law_init_ludwik(&wire->law, &wire->material);
    wire->law.isotropic_share = wires->isotropic_share;
    wire->law.is_combined = wires->is_combined;
    return is_law;
}

static void read_tape(const struct wb_bundle_uncertainty *u, struct reader *reader,
                      struct wb_bundle_tape *tape, double *thickness)
{
    struct wb_material *const m = &tape->material.material;
    *thickness = read_factor(reader, u->tape_thickness);
    m->youngs_modulus *= read_factor(reader, u->tape_modulus);
    m->yield_stress *= read_factor(reader, u->tape_yield_stress);
}

bool wb_inputs_apply(const struct wb_inputs *inputs, const double *numbers,
                     struct wb_bundle_model *model, double *values)
{
    const struct wb_bundle_uncertainty *const u = &inputs->uncertainty;
    struct wb_bundle_interface *const interface = &model->interface;
    struct reader reader = {numbers, values};
    struct wb_bundle_scales scales;
    bool are_laws = true;

    for (int i = 0; i < inputs->n_types; i++) {
        const int count = wb_bundle_model_count(model, i);
        are_laws &= read_law(&inputs->wires[i], count, &reader, &model->type[i]);
    }
    scales.diameter = read_factor(&reader, u->diameter);
    scales.pitch = read_factor(&reader, u->pitch);
    model->length *= read_factor(&reader, u->length);
    read_tape(u, &reader, &model->tape, &scales.thickness);
    wb_bundle_model_scale(model, &scales);
    const double stiffness = read_from_range(&reader, u->cohesion);
    if (u->has_cohesion) {
        interface->shear_stiffness *= stiffness / interface->normal_stiffness;
        interface->normal_stiffness = stiffness;
    }
    const double friction = read_from_range(&reader, u->friction);
    if (u->has_friction)
        interface->friction = (struct wb_friction){friction, friction, 0.0};
    return are_laws;
}
