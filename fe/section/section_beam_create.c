/* Creation of the section model's beam: memory, materials and matrix. */
#include <stdlib.h>

#include "base/memory.h"
#include "base/units.h"
#include "fe/section/section_beam.h"

enum {
    DEFAULT_ELEMENTS = 24,
    DEFAULT_FIBRES = 8
};

static const double default_slip_stiffness = 30.0 * WB_MPA; /* N/mm2 */

void wb_section_beam_destroy(struct wb_section_beam *beam)
{
    if (!beam)
        return;
    for (int i = 0; i < WB_BUNDLE_MODEL_TYPES; i++)
        wb_fibres_destroy(beam->fibres[i]);
    wb_section_pressure_destroy(beam->pressure);
    wb_layered_destroy(beam->matrix);
    wb_section_layout_release(&beam->layout);
    wb_memory_release(&beam->memory);
    free(beam);
}

static enum wb_status make_materials(struct wb_section_beam *beam)
{
    const struct wb_bundle_model *const model = beam->model;

    for (int i = 0; i < model->n_types; i++) {
        const struct wb_wire *const type = &model->type[i];
        struct wb_section section;
        struct wb_material elastic = type->material;
        elastic.hardening = WB_HARDENING_NONE_ELASTIC;
        if (beam->settings.is_elastic)
            WB_TRY(wb_section_init_circle(&section, type->outer_diameter, &elastic,
                                          beam->settings.n_fibres));
        else
            WB_TRY(wb_section_init_law(&section, type->outer_diameter, &type->law,
                                       beam->settings.n_fibres));
        const enum wb_status status = wb_fibres_create(&beam->fibres[i], &section);
        wb_section_release(&section);
        WB_TRY(status);
        const int size = (int)wb_fibres_history_size(beam->fibres[i]);
        beam->history = size > beam->history ? size : beam->history;
    }
    if (!model->has_tape)
        return WB_OK;
    beam->tape_material = model->tape.material.material;
    if (beam->settings.is_elastic)
        beam->tape_material.hardening = WB_HARDENING_NONE_ELASTIC;
    return wb_section_sheet_init(&beam->sheet, &beam->tape_material, model->tape.round);
}

static enum wb_status make_matrix(struct wb_section_beam *beam)
{
    const int n = beam->n_elements;
    int *const first = wb_memory_new((size_t)n + 1, sizeof *first);
    for (int i = 0; i < n; i++)
        first[i] = i * beam->per_station;
    first[n] = beam->n_unknowns;
    const enum wb_status status = wb_layered_create(&beam->matrix, n, first, first, true);
    free(first);
    return status;
}

static void take_memory(struct wb_section_beam *beam)
{
    struct wb_memory *const memory = &beam->memory;
    const size_t n = (size_t)beam->n_unknowns, m = (size_t)beam->n_elements;
    const size_t wires = m * (size_t)beam->layout.n_wires;
    const size_t segments = m * (size_t)beam->layout.n_segments;
    const size_t contacts = m * (size_t)beam->layout.n_contacts;
    const size_t history = wires * (size_t)beam->history;
    double **const vectors[] = {&beam->u,        &beam->committed, &beam->before,
                                &beam->residual, &beam->lever,     &beam->draw};
    double **const lists[] = {&beam->force, &beam->limit, &beam->friction_before,
                              &beam->friction_now};

    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        *vectors[i] = wb_memory_take(memory, n, sizeof(double));
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
        *lists[i] = wb_memory_take(memory, contacts, sizeof(double));
    beam->load = wb_memory_take(memory, 2 * (size_t)beam->layout.n_wires, sizeof(double));
    beam->wires_before = wb_memory_take(memory, history, sizeof(double));
    beam->wires_after = wb_memory_take(memory, history, sizeof(double));
    beam->response = wb_memory_take(memory, wires, sizeof *beam->response);
    beam->tape_before = wb_memory_take(memory, segments, sizeof *beam->tape_before);
    beam->tape_after = wb_memory_take(memory, segments, sizeof *beam->tape_after);
    beam->wall = wb_memory_take(memory, segments, sizeof *beam->wall);
    beam->walls = wb_memory_take(memory, segments, sizeof *beam->walls);
    beam->response_before = wb_memory_take(memory, wires, sizeof *beam->response_before);
    beam->stress_before = wb_memory_take(memory, segments, sizeof *beam->stress_before);
    beam->strain_before = wb_memory_take(memory, segments, sizeof *beam->strain_before);
}

static enum wb_status prepare(struct wb_section_beam *beam)
{
    WB_TRY(wb_section_layout_create(&beam->layout, beam->model, !beam->settings.is_whole));
    beam->per_station = beam->layout.n_unknowns;
    const bool is_capped = beam->model->tip == WB_BUNDLE_TIP_CAPPED;
    beam->n_unknowns =
        (beam->n_elements - 1) * beam->per_station + (is_capped ? 2 : beam->per_station);
    WB_TRY(make_materials(beam));
    WB_TRY(make_matrix(beam));
    beam->pressure = wb_section_pressure_create(&beam->layout, beam->n_elements);
    take_memory(beam);
    return WB_OK;
}

enum wb_status wb_section_beam_create(struct wb_section_beam **out,
                                      const struct wb_bundle_model *model, double mu,
                                      const struct wb_section_beam_settings *settings)
{
    *out = NULL;
    struct wb_section_beam *const beam = wb_memory_new(1, sizeof *beam);
    beam->model = model;
    beam->friction = mu;
    if (settings)
        beam->settings = *settings;
    if (beam->settings.n_elements == 0)
        beam->settings.n_elements = DEFAULT_ELEMENTS;
    if (beam->settings.n_fibres == 0)
        beam->settings.n_fibres = DEFAULT_FIBRES;
    if (!(beam->settings.slip_stiffness > 0.0))
        beam->settings.slip_stiffness = default_slip_stiffness;
    beam->n_elements = beam->settings.n_elements;
    beam->h = model->length / beam->n_elements;
    const enum wb_status status = prepare(beam);
    if (status != WB_OK)
        wb_section_beam_destroy(beam);
    else
        *out = beam;
    return status;
}
