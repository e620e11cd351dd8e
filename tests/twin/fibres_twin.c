#include "tests/twin/fibres_twin.h"
#include "tests/twin/material_stress.h"

void wb_fibres_twin_respond(const struct wb_section *section, double eps, double kappa,
                            const struct wb_material_state *before, struct wb_material_state *after,
                            struct wb_fibres_response *response)
{
    *response = (struct wb_fibres_response){0};
    for (int i = 0; i < section->n_fibres; i++) {
        const struct wb_fibre *const fibre = &section->fibres[i];
        const double y = fibre->y;
        double stress, tangent;
        wb_material_stress(&section->materials[fibre->material], eps - y * kappa, &before[i],
                           &after[i], &stress, &tangent);
        response->N += stress * fibre->area;
        response->M -= stress * fibre->area * y;
        response->D11 += tangent * fibre->area;
        response->D12 -= tangent * fibre->area * y;
        response->D22 += tangent * fibre->area * y * y;
    }
}
