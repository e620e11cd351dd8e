#include "fe/model/model_inputs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "fe/material/hardening.h"
#include "fe/material/law_json.h"

static const double place_step = 1e-9; /* m: packings differ by less between machines */

static void set_triple(struct wb_json *object, const char *key, const double triple[3])
{
    struct wb_json *const array = wb_json_set_array(object, key);
    for (int i = 0; i < 3; i++)
        wb_json_append_number(array, triple[i]);
}

static void set_material(struct wb_json *object, const struct wb_material *material)
{
    const struct wb_hardening_law *const law = wb_hardening_law(material);
    wb_json_set_number(object, "youngs_modulus_MPa", material->youngs_modulus / WB_MPA);
    wb_json_set_number(object, "poissons_ratio", material->poissons_ratio);
    wb_json_set_text(object, "hardening", law->yields ? law->name : "none");
    if (!law->yields)
        return;
    wb_json_set_number(object, "yield_stress_MPa", material->yield_stress / WB_MPA);
    if (law->has[WB_HARDENING_STRENGTH])
        wb_json_set_number(object, "strength_coefficient_MPa",
                           material->strength_coefficient / WB_MPA);
    if (law->has[WB_HARDENING_EXPONENT])
        wb_json_set_number(object, "hardening_exponent", material->hardening_exponent);
}

void wb_model_inputs_law(struct wb_json *object, const struct wb_law *law)
{
    set_material(object, &law->material);
    wb_json_set_text(object, "form", wb_law_form_name(law->form));
    wb_json_set_number(object, "isotropic_share", law->isotropic_share);
    if (law->is_combined)
        wb_json_set_text(object, "rule", wb_law_rule_name(law));
    if (law->form != WB_LAW_LUDWIK)
        wb_law_json_numbers(object, law, "MPa", WB_MPA);
}

/* --- bundles --- */

/* Explicit dynamics uses the material only, not the law. */
static void set_wires(struct wb_json *object, const struct wb_bundle_model *model, bool is_explicit)
{
    struct wb_json *const wires = wb_json_set_array(object, "wires");
    for (int i = 0; i < model->n_types; i++) {
        const struct wb_wire *const wire = &model->type[i];
        struct wb_json *const item = wb_json_append_object(wires);
        wb_json_set_number(item, "outer_diameter_mm", wire->outer_diameter / WB_MM);
        wb_json_set_number(item, "density_g_cm3", wire->density / WB_G_PER_CM3);
        if (is_explicit)
            set_material(item, &wire->material);
        else
            wb_model_inputs_law(item, &wire->law);
    }
}

/* In mm; 0 without a sign. */
static double round_place(double place)
{
    return round(place / place_step) * place_step / WB_MM + 0.0;
}

static void set_places(struct wb_json *object, const struct wb_bundle_model *model)
{
    struct wb_json *const places = wb_json_set_array(object, "places");
    for (int i = 0; i < model->packing.n; i++) {
        const struct wb_packing_circle *const circle = &model->packing.wire[i];
        char text[96];
        snprintf(text, sizeof text, "wire %d at %.6f, %.6f mm", model->type_of[i] + 1,
                 round_place(circle->y), round_place(circle->z));
        wb_json_append_text(places, text);
    }
}

static void set_tape(struct wb_json *object, const struct wb_bundle_tape *tape)
{
    struct wb_json *const out = wb_json_set_object(object, "tape");
    const struct wb_taping *const taping = &tape->taping;
    const bool is_helix = taping->kind == WB_TAPING_HELIX;
    set_material(out, &tape->material.material);
    wb_json_set_number(out, "density_g_cm3", tape->material.density / WB_G_PER_CM3);
    wb_json_set_number(out, "layer_thickness_mm", taping->layer_thickness / WB_MM);
    wb_json_set_text(out, "layout", is_helix ? "helix" : "sleeve");
    wb_json_set_number(out, "layers", taping->layers);
    if (is_helix) {
        wb_json_set_number(out, "width_mm", taping->helix.width / WB_MM);
        wb_json_set_number(out, "lap_percent", taping->helix.lap / WB_PERCENT);
        wb_json_set_text(out, "hand", taping->helix.hand > 0 ? "right" : "left");
    }
    wb_json_set_number(out, "gap_mm", tape->gap / WB_MM);
    wb_json_set_text(out, "outline", tape->round ? "circle" : "hull");
    wb_json_set_number(out, "bond_reach_mm", tape->reach / WB_MM);
}

static void set_interface(struct wb_json *object, const struct wb_bundle_model *model)
{
    const struct wb_bundle_interface *const interface = &model->interface;
    struct wb_json *const out = wb_json_set_object(object, "interface");
    wb_setting_set_json(wb_bundle_model_friction_setting, interface, out);
    if (!model->has_tape)
        return;
    wb_setting_set_json(wb_bundle_model_cohesion_setting, interface, out);
    wb_json_set_number(out, "shear_stiffness_N_mm3", interface->shear_stiffness / WB_N_PER_MM3);
    if (!interface->has_damage)
        return;
    wb_json_set_number(out, "strength_MPa", interface->damage.strength / WB_MPA);
    wb_json_set_number(out, "shear_strength_MPa", interface->damage.shear_strength / WB_MPA);
    wb_json_set_number(out, "fracture_energy_N_mm",
                       interface->damage.fracture_energy / WB_N_PER_MM);
}

static void set_mesh(struct wb_json *object, const struct wb_bundle_model *model,
                     const struct wb_bundle_mesh *mesh)
{
    struct wb_json *const out = wb_json_set_object(object, "mesh");
    const bool is_one_point = mesh->formulation == WB_BUNDLE_ONE_POINT;
    wb_json_set_integer(out, "core_quads", mesh->core_quads);
    wb_json_set_integer(out, "rings", mesh->rings);
    wb_json_set_integer(out, "elements_along", mesh->elements_along);
    wb_json_set_integer(out, "tape_quads", wb_bundle_model_tape_quads(model, mesh));
    wb_json_set_text(out, "formulation", is_one_point ? "one-point" : "2x2x1");
}

/* Without the mesh, whose name does not matter; the section model depends on the test only. */
static void set_run(struct wb_json *object, const struct wb_bundle_run *run, bool is_explicit)
{
    struct wb_json *const out = wb_json_set_object(object, "run");
    for (int i = 0; i < WB_BUNDLE_MODEL_RUN_SETTINGS; i++) {
        const bool is_of_test = i == WB_BUNDLE_MODEL_DEFLECTION || i == WB_BUNDLE_MODEL_ROWS ||
                                i == WB_BUNDLE_MODEL_CYCLES;
        if (is_of_test || (is_explicit && i != WB_BUNDLE_MODEL_MESH))
            wb_setting_set_json(&wb_bundle_model_run_settings[i], run, out);
    }
}

void wb_model_inputs_bundle(struct wb_json *object, const struct wb_bundle_model *model,
                            const struct wb_bundle_mesh *mesh)
{
    const bool is_capped = model->tip == WB_BUNDLE_TIP_CAPPED;
    set_wires(object, model, mesh != NULL);
    set_places(object, model);
    if (model->has_tape)
        set_tape(object, &model->tape);
    wb_json_set_number(object, "length_mm", model->length / WB_MM);
    set_interface(object, model);
    wb_json_set_number(object, "potted_mm", model->potted_length / WB_MM);
    wb_json_set_text(object, "tip", is_capped ? "capped" : "free");
    if (mesh)
        set_mesh(object, model, mesh);
    set_run(object, &model->run, mesh != NULL);
    wb_json_set_number(object, "strand_mm", model->loads.strand_length / WB_MM);
    wb_json_set_boolean(object, "weight", model->loads.weight);
}

/* --- wires --- */

static void set_parts(struct wb_json *object, const struct wb_wire_model *model)
{
    struct wb_json *const parts = wb_json_set_array(object, "parts");
    for (int i = 0; i < model->n_parts; i++) {
        const struct wb_wire_model_part *const part = &model->part[i];
        struct wb_json *const out = wb_json_append_object(parts);
        wb_json_set_number(out, "outer_diameter_mm", part->outer_diameter / WB_MM);
        wb_json_set_number(out, "density_g_cm3", part->density / WB_G_PER_CM3);
        set_material(out, &part->material);
    }
}

static void set_steps(struct wb_json *object, const struct wb_wire_model *model)
{
    static const char *const kinds[] = {[WB_WIRE_STEP_LOADS] = "loads",
                                        [WB_WIRE_STEP_DEFLECTION] = "deflection",
                                        [WB_WIRE_STEP_RELEASE] = "release"};
    struct wb_json *const steps = wb_json_set_array(object, "history");
    for (int i = 0; i < model->n_steps; i++) {
        const struct wb_wire_step *const step = &model->step[i];
        struct wb_json *const out = wb_json_append_object(steps);
        wb_json_set_text(out, "name", step->name); /* names the step's fields */
        wb_json_set_text(out, "kind", kinds[step->kind]);
        set_triple(out, "force_N", step->loads.force);
        set_triple(out, "moment_Nm", step->loads.moment);
        set_triple(out, "follower_N", step->loads.follower);
        wb_json_set_number(out, "deflection_mm", step->deflection / WB_MM);
        wb_json_set_integer(out, "rows", step->rows);
        wb_json_set_boolean(out, "fields", step->fields);
    }
}

void wb_model_inputs_wire(struct wb_json *object, const struct wb_wire_model *model, bool is_solid)
{
    const bool is_reduced = model->integration == WB_INTEGRATION_REDUCED;
    wb_json_set_number(object, "length_mm", model->length / WB_MM);
    set_parts(object, model);
    /* Core and jacket of a rod are bonded. */
    if (is_solid && model->has_contact) {
        struct wb_json *const contact = wb_json_set_object(object, "interface");
        wb_json_set_number(contact, "friction", model->jacket_contact.friction);
        wb_json_set_number(contact, "normal_stiffness_N_mm3",
                           model->jacket_contact.normal_stiffness / WB_N_PER_MM3);
        wb_json_set_number(contact, "tangential_stiffness_N_mm3",
                           model->jacket_contact.tangential_stiffness / WB_N_PER_MM3);
    }
    wb_json_set_text(object, "clamp", model->clamp == WB_WIRE_CLAMP_FIXED ? "fixed" : "plane");
    set_triple(object, "gravity", model->gravity);
    wb_json_set_number(object, "strand_mm", model->strand_length / WB_MM);
    if (is_solid) {
        struct wb_json *const mesh = wb_json_set_object(object, "mesh");
        wb_json_set_integer(mesh, "elements_along", model->elements_along);
        wb_json_set_integer(mesh, "section_density", model->section_density);
        wb_json_set_text(mesh, "integration", is_reduced ? "reduced" : "selective");
    }
    struct wb_json *const sections = wb_json_set_array(object, "fields_at_mm");
    for (int i = 0; i < model->n_sections; i++)
        wb_json_append_number(sections, model->section[i] / WB_MM);
    set_steps(object, model);
}

/* --- as a sum --- */

void wb_model_inputs_sum(const struct wb_json *object, char sha256[WB_SHA256_TEXT])
{
    char *const text = wb_json_format(object);
    wb_hash_bytes(text, strlen(text), sha256);
    free(text);
}
