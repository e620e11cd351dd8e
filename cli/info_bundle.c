/* wirebench info BUNDLE.yaml. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/simulated_bundle.h"
#include "analysis/report/draw/figures_bundle.h"
#include "base/memory.h"
#include "base/units.h"
#include "cli/info.h"
#include "fe/model/bundle_model.h"

#define WB_LOG_DOMAIN "info"

enum {
    OUTLINE = 20000 /* points along the outline of a tape on a circle */
};

static const double pixels_of_a_point = 3.0;

static const char *length_source(const struct wb_bundle_model *model)
{
    static const char *const names[] = {"own", "printed", "inferred"};
    return names[model->length_source];
}

static const char *formulation(const struct wb_bundle_mesh *mesh)
{
    return mesh->formulation == WB_BUNDLE_ONE_POINT ? "one-point" : "2x2x1";
}

/* The contact of the tape with a wire. */
struct contact {
    bool touches;
    double angle; /* rad, about the centre of the wire */
};

/* A tape on a circle does not follow the wires: it is bonded to those within its bond reach. */
static void find_round_contacts(const struct wb_bundle_model *model, struct contact *contacts)
{
    const struct wb_hull *const hull = &model->tape.hull;
    const double step = wb_hull_length(hull, 0.0) / OUTLINE;

    for (int i = 0; i < OUTLINE; i++) {
        const struct wb_hull_point at = wb_hull_at(hull, 0.0, (i + 0.5) * step);
        const int wire = wb_bundle_model_tape_wire(model, at.y, at.z, 0.0);
        if (wire < 0)
            continue;
        /* The component of the step that is perpendicular to the radius from the wire's centre. */
        const double y = at.y - model->packing.wire[wire].y;
        const double z = at.z - model->packing.wire[wire].z;
        const double facing = y * sin(at.normal) + z * cos(at.normal);
        contacts[wire].touches = true;
        contacts[wire].angle += step * facing / (y * y + z * z);
    }
}

static void find_contacts(const struct wb_bundle_model *model,
                          struct contact contacts[WB_PACKING_MOST])
{
    memset(contacts, 0, WB_PACKING_MOST * sizeof *contacts);
    if (model->has_tape && model->tape.round)
        find_round_contacts(model, contacts);
    for (int i = 0; i < model->packing.n && model->has_tape && !model->tape.round; i++)
        contacts[i].angle = wb_hull_contact(&model->tape.hull, i, &contacts[i].touches);
}

/* --- as text --- */

static void print_section(const struct wb_bundle_model *model)
{
    const char *before = "wires";
    for (int i = 0; i < model->n_types; i++, before = "")
        printf("  %-10s %d x %s, %g mm\n", before, wb_bundle_model_count(model, i),
               model->type[i].name, model->type[i].outer_diameter / WB_MM);
    printf("  %-10s %s%s%s\n", "packing", wb_bundle_model_arrangement(model),
           model->touching > 0.0 ? ", moved until they touch" : "",
           model->settled ? ", settled" : "");
    if (model->wire_gap > 0.0)
        printf("  %-10s %g mm between wires\n", "gap", model->wire_gap / WB_MM);
    if (model->has_tape)
        printf("  %-10s %s, %s\n", "tape", model->tape.material.name,
               model->tape.taping.kind == WB_TAPING_SLEEVE ? "sleeve" : "helix");
    printf("  %-10s %g mm", "length", model->length / WB_MM);
    if (model->length_source != WB_BUNDLE_LENGTH_OWN)
        printf(" (%s)", length_source(model));
    printf("\n");
}

static void print_facts(const struct wb_bundle_model *model)
{
    struct wb_bundle_fact facts[WB_BUNDLE_MODEL_FACTS];
    const int n = wb_bundle_model_facts(model, facts);
    for (int i = 0; i < n; i++)
        printf(facts[i].value < 1000.0 ? "  %-42s %8.4g%s%s\n" : "  %-42s %8.0f%s%s\n",
               facts[i].text, facts[i].value, facts[i].unit[0] ? " " : "", facts[i].unit);
}

static void print_meshes(const struct wb_bundle_model *model)
{
    printf("  meshes\n");
    for (int i = 0; i < model->n_meshes; i++) {
        const struct wb_bundle_mesh *const mesh = &model->mesh[i];
        printf("    %-14s %d quadrilaterals a wire, %d elements along, %ld hexahedra, %s",
               mesh->name, wb_bundle_model_section_quads(mesh), mesh->elements_along,
               wb_bundle_model_hexahedra(model, mesh), formulation(mesh));
        if (model->has_tape)
            printf(", %d shells round the tape", wb_bundle_model_tape_quads(model, mesh));
        printf("%s\n", strcmp(mesh->name, model->run.mesh) == 0 ? " (of the run)" : "");
    }
}

static void print_text(const struct wb_bundle_model *model, const char *figure)
{
    char sha256[WB_SHA256_TEXT];
    printf("%s: bundle %s\n", model->path, model->name);
    if (model->title[0])
        printf("  %-10s %s\n", "title", model->title);
    if (model->notes[0])
        printf("  %-10s %s\n", "notes", model->notes);
    print_section(model);
    wb_simulated_bundle_sum(model, wb_bundle_model_mesh(model, model->run.mesh), sha256);
    printf("  %-10s %s\n", "inputs", sha256);
    if (figure)
        printf("  %-10s %s\n", "figure", figure);
    print_facts(model);
    print_meshes(model);
    struct wb_text next = {0};
    wb_file_kind_append_next(&next, WB_FILE_BUNDLE, model->path);
    printf("  %-10s %s\n", "next", wb_text_string(&next));
    wb_text_release(&next);
}

/* --- as JSON --- */

static void set_wires(struct wb_json *root, const struct wb_bundle_model *model)
{
    struct contact contacts[WB_PACKING_MOST];
    struct wb_json *const types = wb_json_set_array(root, "types");
    for (int i = 0; i < model->n_types; i++) {
        struct wb_json *const type = wb_json_append_object(types);
        wb_json_set_text(type, "wire", model->type[i].name);
        wb_json_set_integer(type, "count", wb_bundle_model_count(model, i));
        wb_json_set_number(type, "outer_diameter_mm", model->type[i].outer_diameter / WB_MM);
    }
    find_contacts(model, contacts);
    struct wb_json *const wires = wb_json_set_array(root, "wires");
    for (int i = 0; i < model->packing.n; i++) {
        struct wb_json *const wire = wb_json_append_object(wires);
        wb_json_set_text(wire, "wire", model->type[model->type_of[i]].name);
        wb_json_set_number(wire, "y_mm", model->packing.wire[i].y / WB_MM);
        wb_json_set_number(wire, "z_mm", model->packing.wire[i].z / WB_MM);
        wb_json_set_boolean(wire, "touches_tape", contacts[i].touches);
        wb_json_set_number(wire, "tape_contact_degrees", contacts[i].angle / WB_DEGREE);
    }
}

static void set_meshes(struct wb_json *root, const struct wb_bundle_model *model)
{
    struct wb_json *const meshes = wb_json_set_array(root, "meshes");
    for (int i = 0; i < model->n_meshes; i++) {
        const struct wb_bundle_mesh *const mesh = &model->mesh[i];
        struct wb_json *const item = wb_json_append_object(meshes);
        wb_json_set_text(item, "name", mesh->name);
        wb_json_set_text(item, "formulation", formulation(mesh));
        wb_json_set_integer(item, "section_quadrilaterals", wb_bundle_model_section_quads(mesh));
        wb_json_set_integer(item, "elements_along", mesh->elements_along);
        wb_json_set_integer(item, "hexahedra", wb_bundle_model_hexahedra(model, mesh));
        wb_json_set_integer(item, "tape_quadrilaterals_round",
                            wb_bundle_model_tape_quads(model, mesh));
    }
}

static void print_json(const struct wb_bundle_model *model, const char *figure)
{
    struct wb_bundle_fact facts[WB_BUNDLE_MODEL_FACTS];
    const int n = wb_bundle_model_facts(model, facts);
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "bundle", model->path);
    wb_json_set_text(root, "kind", wb_file_kind_key(WB_FILE_BUNDLE));
    wb_json_set_text(root, "name", model->name);
    wb_json_set_text(root, "title", model->title);
    char sha256[WB_SHA256_TEXT];
    wb_simulated_bundle_sum(model, wb_bundle_model_mesh(model, model->run.mesh), sha256);
    wb_json_set_text(root, "inputs_sha256", sha256);
    wb_json_set_text(root, "packing", wb_bundle_model_arrangement(model));
    wb_json_set_number(root, "touching_mm", model->touching / WB_MM);
    wb_json_set_boolean(root, "settled", model->settled);
    wb_json_set_number(root, "length_mm", model->length / WB_MM);
    wb_json_set_text(root, "length_source", length_source(model));
    wb_json_set_text(root, "figure", figure);
    for (int i = 0; i < n; i++)
        wb_json_set_number(root, facts[i].key, facts[i].value);
    set_wires(root, model);
    set_meshes(root, model);
    wb_command_print_json(root);
}

/* --- as a drawing --- */

static enum wb_status draw(const struct wb_info_options *options,
                           const struct wb_bundle_model *model)
{
    const char *const mesh = options->mesh ? options->mesh : model->run.mesh;
    struct wb_figure *figure;
    WB_TRY(wb_command_check_output(options->figure, options->common.force));
    WB_TRY(wb_figures_bundle_draw(&figure, "section", 1, &model, mesh));
    const enum wb_status status = wb_figure_write_file(figure, pixels_of_a_point, options->figure);
    wb_figure_destroy(figure);
    return status;
}

static int print(const struct wb_info_options *options, const struct wb_bundle_model *model)
{
    if (options->mesh && !wb_bundle_model_mesh(model, options->mesh)) {
        wb_error("%s: unknown mesh '%s'", model->path, options->mesh);
        return WB_EXIT_USAGE;
    }
    if (options->figure && draw(options, model) != WB_OK)
        return WB_EXIT_FAILED;
    if (options->common.json)
        print_json(model, options->figure);
    else
        print_text(model, options->figure);
    return WB_EXIT_OK;
}

int wb_info_bundle(const struct wb_info_options *options)
{
    char path[WB_PATH];
    struct wb_bundle_model *const model = wb_memory_new(1, sizeof *model);
    enum wb_status status = wb_file_find_fixture(path, "bundles", options->common.input, NULL);
    if (status == WB_OK)
        status = wb_bundle_model_read(model, path);
    const int code = status == WB_OK ? print(options, model) : wb_command_exit(status);
    free(model);
    return code;
}
