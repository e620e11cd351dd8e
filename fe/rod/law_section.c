#include "fe/rod/law_section.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "fe/rod/fibres.h"
#include "fe/rod/section.h"

#define WB_LOG_DOMAIN "section"

enum {
    DEFAULT_RINGS = 8,
    DEFAULT_AROUND = 24
};

struct wb_law_section {
    struct wb_fibres *fibres;
    double torsional_stiffness;
};

enum wb_status wb_law_section_create(struct wb_law_section **out,
                                     const struct wb_law_section_model *model)
{
    *out = NULL;
    const double GJ = model->torsional_stiffness;
    if (!(isfinite(GJ) && GJ >= 0.0))
        return wb_fail(WB_ERR_ARGUMENT, "torsional stiffness %g N m2: expected a number above 0",
                       GJ);
    const int n_rings = model->fibres.n_rings ? model->fibres.n_rings : DEFAULT_RINGS;
    const int n_around = model->fibres.n_around ? model->fibres.n_around : DEFAULT_AROUND;

    struct wb_law_section *const section = wb_memory_new(1, sizeof *section);
    struct wb_section fibres;
    enum wb_status status =
        wb_section_init_law_in_space(&fibres, model->diameter, model->law, n_rings, n_around);
    if (status == WB_OK)
        status = wb_fibres_create(&section->fibres, &fibres);
    wb_section_release(&fibres);
    if (status != WB_OK) {
        wb_law_section_destroy(section);
        return status;
    }
    section->torsional_stiffness = GJ > 0.0 ? GJ
                                            : wb_fibres_bending_stiffness(section->fibres) /
                                                  (1.0 + model->law->material.poissons_ratio);
    *out = section;
    return WB_OK;
}

void wb_law_section_destroy(struct wb_law_section *section)
{
    if (!section)
        return;
    wb_fibres_destroy(section->fibres);
    free(section);
}

size_t wb_law_section_history_size(const struct wb_law_section *section)
{
    return wb_fibres_history_size(section->fibres);
}

struct wb_law_section_stiffness wb_law_section_stiffness(const struct wb_law_section *section)
{
    return (struct wb_law_section_stiffness){
        .axial = wb_fibres_axial_stiffness(section->fibres),
        .bending = wb_fibres_bending_stiffness(section->fibres),
        .torsion = section->torsional_stiffness,
        .shear = wb_fibres_shear_stiffness(section->fibres),
    };
}

void wb_law_section_respond(const struct wb_law_section *section, const double *strain,
                            const double *restrict before, double *restrict after,
                            struct wb_rod_section_response *restrict response)
{
    struct wb_fibres_space_response r;
    const double GJ = section->torsional_stiffness;

    wb_fibres_respond_in_space(section->fibres, strain[0], strain[2], strain[3], before, after, &r);
    const struct wb_fibres_response *const p = &r.plane;
    *response = (struct wb_rod_section_response){
        .force = {p->N, GJ * strain[1], r.M_y, p->M},
        .tangent = {{p->D11, 0.0, r.D1y, p->D12},
                    {0.0, GJ, 0.0, 0.0},
                    {r.D1y, 0.0, r.Dyy, r.D2y},
                    {p->D12, 0.0, r.D2y, p->D22}},
        .yielding = after[0] != 0.0,
    };
}
