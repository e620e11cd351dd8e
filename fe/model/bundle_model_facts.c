/* Properties derived from a bundle's section: diameter, mass, bonds, rigidities, and a list of
 * them. */
#include <math.h>
#include <stddef.h>

#include "base/circle.h"
#include "base/units.h"
#include "fe/model/bundle_model.h"

static const double g_per_m = 1e-3;  /* kg/m of one g/m */
static const double touching = 1e-9; /* m: wires within this distance touch the tape */

enum {
    OUTLINE = 20000 /* positions sampled around a tape */
};

static const struct wb_wire *wire_of(const struct wb_bundle_model *model, int wire)
{
    return &model->type[model->type_of[wire]];
}

/* --- homogenised --- */

static double wires_circle(const struct wb_bundle_model *model)
{
    return 2.0 * wb_packing_enclosing(model->packing.n, model->packing.wire).radius;
}

double wb_bundle_model_diameter(const struct wb_bundle_model *model)
{
    const double wires = wires_circle(model);
    if (!model->has_tape)
        return wires;
    return wires + 2.0 * (model->tape.gap + wb_taping_thickness(&model->tape.taping));
}

double wb_bundle_model_wire_mass(const struct wb_bundle_model *model)
{
    double sum = 0.0;
    for (int i = 0; i < model->packing.n; i++)
        sum += wb_wire_mass_per_length(wire_of(model, i));
    return sum;
}

double wb_bundle_model_tape_mass(const struct wb_bundle_model *model)
{
    if (!model->has_tape)
        return 0.0;
    const struct wb_taping *const taping = &model->tape.taping;
    return model->tape.material.density * taping->layer_thickness * wb_taping_area(taping);
}

int wb_bundle_model_tape_wire(const struct wb_bundle_model *model, double y, double z,
                              double offset)
{
    double least = model->tape.reach + touching;
    int nearest = -1;

    for (int w = 0; w < model->packing.n; w++) {
        const struct wb_packing_circle *const wire = &model->packing.wire[w];
        const double gap = hypot(y - wire->y, z - wire->z) - wire->radius - offset;
        if (gap > least)
            continue;
        least = gap;
        nearest = w;
    }
    return nearest;
}

double wb_bundle_model_density(const struct wb_bundle_model *model, double diameter)
{
    return (wb_bundle_model_wire_mass(model) + wb_bundle_model_tape_mass(model)) /
           wb_circle_area(diameter);
}

/* Sums of E A, and of E times the first and second moments about the axis, upwards and across. */
struct stiffness {
    double axial, first[2], second[2];
};

static struct stiffness tape_stiffness(const struct wb_bundle_tape *tape)
{
    const double thickness = wb_taping_thickness(&tape->taping);
    const struct wb_hull_moments m = wb_hull_moments(&tape->hull, tape->gap + 0.5 * thickness);
    const double E_t = tape->material.material.youngs_modulus * thickness;
    return (struct stiffness){E_t * m.length, {E_t * m.y, E_t * m.z}, {E_t * m.yy, E_t * m.zz}};
}

static void add(struct stiffness *sum, const struct stiffness *part)
{
    sum->axial += part->axial;
    for (int k = 0; k < 2; k++) {
        sum->first[k] += part->first[k];
        sum->second[k] += part->second[k];
    }
}

/* About the neutral axis. */
static double about_neutral(const struct stiffness *sum, int direction)
{
    return sum->second[direction] - sum->first[direction] * sum->first[direction] / sum->axial;
}

struct wb_bundle_rigidity wb_bundle_model_rigidity(const struct wb_bundle_model *model)
{
    struct wb_bundle_rigidity rigidity = {0};
    struct stiffness all = {0};
    for (int i = 0; i < model->packing.n; i++) {
        const struct wb_wire *const wire = wire_of(model, i);
        const double E = wire->material.youngs_modulus, A = wb_circle_area(wire->outer_diameter);
        const double own = E * wb_circle_second_moment(wire->outer_diameter);
        const double y = model->packing.wire[i].y, z = model->packing.wire[i].z;
        const struct stiffness part = {
            E * A, {E * A * y, E * A * z}, {own + E * A * y * y, own + E * A * z * z}};
        rigidity.wires += own;
        add(&all, &part);
    }
    if (model->has_tape) {
        const struct stiffness tape = tape_stiffness(&model->tape);
        const bool is_tube = model->tape.taping.kind == WB_TAPING_SLEEVE;
        for (int k = 0; k < 2 && is_tube; k++)
            rigidity.tape[k] = about_neutral(&tape, k);
        add(&all, &tape);
    }
    for (int k = 0; k < 2; k++) {
        rigidity.sliding[k] = rigidity.wires + rigidity.tape[k];
        rigidity.bonded[k] = about_neutral(&all, k);
    }
    return rigidity;
}

/* --- as a list --- */

struct list {
    struct wb_bundle_fact *facts;
    int n;
};

static void tell(struct list *list, const char *key, const char *text, const char *unit,
                 double value)
{
    if (list->n < WB_BUNDLE_MODEL_FACTS)
        list->facts[list->n++] = (struct wb_bundle_fact){key, text, unit, value};
}

static void tell_packing(struct list *list, const struct wb_bundle_model *model)
{
    double area = 0.0;
    for (int i = 0; i < model->packing.n; i++)
        area += wb_circle_area(wire_of(model, i)->outer_diameter);
    tell(list, "outer_diameter_mm", "outer diameter", "mm",
         wb_bundle_model_diameter(model) / WB_MM);
    tell(list, "wires_circle_mm", "circle round the wires", "mm", wires_circle(model) / WB_MM);
    tell(list, "filled_percent", "of that circle filled", "%",
         area / wb_circle_area(wires_circle(model)) / WB_PERCENT);
    tell(list, "touching_pairs", "pairs of wires that touch", "",
         wb_packing_pairs(&model->packing, touching, 0, NULL));
}

/* Number of bonded wires, and length of all bonds along the outline, m. */
static int find_bonds(const struct wb_bundle_model *model, double *length)
{
    const struct wb_hull *const hull = &model->tape.hull;
    const double around = wb_hull_length(hull, 0.0);
    bool bonded[WB_PACKING_MOST] = {false};
    int n = 0, places = 0;

    for (int i = 0; i < OUTLINE; i++) {
        const struct wb_hull_point at = wb_hull_at(hull, 0.0, around * (i + 0.5) / OUTLINE);
        const int wire = wb_bundle_model_tape_wire(model, at.y, at.z, 0.0);
        if (wire < 0)
            continue;
        places++;
        n += !bonded[wire];
        bonded[wire] = true;
    }
    *length = around * places / OUTLINE;
    return n;
}

static void tell_tape(struct list *list, const struct wb_bundle_model *model)
{
    const struct wb_bundle_tape *const tape = &model->tape;
    const struct wb_taping *const taping = &tape->taping;
    double bonded;
    const int n = find_bonds(model, &bonded);
    tell(list, "wires_at_tape", "wires that touch the tape", "", n);
    tell(list, "bonded_length_mm", "of its outline bonded to them", "mm", bonded / WB_MM);
    tell(list, "tape_length_round_mm", "round the middle of the tape", "mm",
         taping->circumference / WB_MM);
    tell(list, "tape_thickness_mm", "tape, all layers", "mm", wb_taping_thickness(taping) / WB_MM);
    tell(list, "tape_layers", "layers on average", "", taping->layers);
    if (taping->kind == WB_TAPING_SLEEVE)
        return;
    tell(list, "tape_width_mm", "width of the tape", "mm", taping->helix.width / WB_MM);
    tell(list, "tape_advance_mm", "advance in a turn", "mm", taping->advance / WB_MM);
    tell(list, "tape_angle_degrees", "angle to the circumference", "degrees",
         taping->angle / WB_DEGREE);
}

static void tell_mass(struct list *list, const struct wb_bundle_model *model)
{
    const double wires = wb_bundle_model_wire_mass(model), tape = wb_bundle_model_tape_mass(model);
    tell(list, "mass_g_m", "mass per length", "g/m", (wires + tape) / g_per_m);
    if (model->has_tape)
        tell(list, "tape_mass_g_m", "of which tape", "g/m", tape / g_per_m);
    tell(list, "density_g_cm3", "density, eq. 30", "g/cm3",
         wb_bundle_model_density(model, wb_bundle_model_diameter(model)) / WB_G_PER_CM3);
}

static void tell_rigidity(struct list *list, const struct wb_bundle_model *model)
{
    const struct wb_bundle_rigidity r = wb_bundle_model_rigidity(model);
    const double I = wb_circle_second_moment(wb_bundle_model_diameter(model));
    tell(list, "wires_EI_N_mm2", "E I of the wires alone", "N mm2", r.wires / WB_NMM2);
    tell(list, "sliding_EI_N_mm2", "E I, wires sliding", "N mm2", r.sliding[0] / WB_NMM2);
    tell(list, "sliding_EI_across_N_mm2", "the same across", "N mm2", r.sliding[1] / WB_NMM2);
    tell(list, "bonded_EI_N_mm2", "E I, wires bonded", "N mm2", r.bonded[0] / WB_NMM2);
    tell(list, "bonded_EI_across_N_mm2", "the same across", "N mm2", r.bonded[1] / WB_NMM2);
    tell(list, "sliding_youngs_modulus_MPa", "E over the outer diameter, wires sliding", "MPa",
         r.sliding[0] / I / WB_MPA);
    tell(list, "bonded_youngs_modulus_MPa", "E over the outer diameter, wires bonded", "MPa",
         r.bonded[0] / I / WB_MPA);
}

static void tell_published(struct list *list, const struct wb_bundle_model *model)
{
    const struct wb_bundle_published *const p = &model->published;
    tell(list, "published_outer_diameter_mm", "outer diameter, published", "mm",
         p->outer_diameter / WB_MM);
    tell(list, "published_density_g_cm3", "density, published", "g/cm3", p->density / WB_G_PER_CM3);
    tell(list, "density_at_published_diameter_g_cm3", "density over the published diameter",
         "g/cm3", wb_bundle_model_density(model, p->outer_diameter) / WB_G_PER_CM3);
    if (!p->has_beam)
        return;
    const double E = p->beam.material.youngs_modulus;
    tell(list, "published_youngs_modulus_MPa", "E, published", "MPa", E / WB_MPA);
    tell(list, "published_EI_N_mm2", "E I, published", "N mm2",
         E * wb_wire_second_moment(&p->beam) / WB_NMM2);
}

int wb_bundle_model_facts(const struct wb_bundle_model *model,
                          struct wb_bundle_fact facts[WB_BUNDLE_MODEL_FACTS])
{
    struct list list = {facts, 0};
    tell_packing(&list, model);
    if (model->has_tape)
        tell_tape(&list, model);
    tell_mass(&list, model);
    tell_rigidity(&list, model);
    if (model->has_published)
        tell_published(&list, model);
    return list.n;
}
