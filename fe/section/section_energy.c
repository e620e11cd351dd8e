#include "fe/section/section_energy.h"

/* Adds the energies that an element took up since the last commit. */
static void add_element_energies(struct wb_section_beam *beam, int element)
{
    struct wb_section_beam_energies *const e = &beam->energies;
    const struct wb_section_layout *const layout = &beam->layout;
    const double *const u = beam->u, *const from = beam->committed;
    const double bent = wb_section_beam_value(beam, u, element + 1, 0) -
                        wb_section_beam_value(beam, u, element, 0) -
                        wb_section_beam_value(beam, from, element + 1, 0) +
                        wb_section_beam_value(beam, from, element, 0);

    for (int w = 0; w < layout->n_wires; w++) {
        const struct wb_section_wire *const wire = &layout->wires[w];
        const size_t at = (size_t)element * (size_t)layout->n_wires + (size_t)w;
        const struct wb_fibres_response *const now = &beam->response[at],
                                               *const before = &beam->response_before[at];
        const int a = wire->unknown;
        const double stretched = wb_section_beam_value(beam, u, element + 1, a) -
                                 wb_section_beam_value(beam, u, element, a) -
                                 wb_section_beam_value(beam, from, element + 1, a) +
                                 wb_section_beam_value(beam, from, element, a);
        e->wires +=
            0.5 * wire->weight *
            ((now->N + before->N) * (stretched - wire->y * bent) + (now->M + before->M) * bent);
    }
    for (int s = 0; s < layout->n_segments; s++) {
        const size_t at = (size_t)element * (size_t)layout->n_segments + (size_t)s;
        const double volume = wb_section_beam_volume(beam, &layout->segments[s]);
        for (int i = 0; i < 3; i++)
            e->tape += 0.5 * volume * (beam->wall[at].stress[i] + beam->stress_before[at][i]) *
                       (beam->walls[at].strain[i] - beam->strain_before[at][i]);
    }
}

static void add_station_energies(struct wb_section_beam *beam, int station)
{
    const struct wb_section_layout *const layout = &beam->layout;

    for (int i = 0; i < layout->n_bonds; i++) {
        const struct wb_section_bond *const bond = &layout->bonds[i];
        const double slip = wb_section_beam_value(beam, beam->u, station, bond->unknown[0]) -
                            wb_section_beam_value(beam, beam->u, station, bond->unknown[1]);
        beam->energies.bonds +=
            0.5 * bond->stiffness * wb_section_beam_share(beam, station) * slip * slip;
    }
    for (int i = 0; i < layout->n_contacts; i++) {
        const struct wb_section_contact *const c = &layout->contacts[i];
        const size_t at = (size_t)(station - 1) * (size_t)layout->n_contacts + (size_t)i;
        double slip = 0.0;
        for (int end = 0; end < 2; end++)
            slip += (end == 0 ? 1.0 : -1.0) *
                    (wb_section_beam_value(beam, beam->u, station, c->unknown[end]) -
                     wb_section_beam_value(beam, beam->committed, station, c->unknown[end]));
        beam->energies.friction +=
            0.5 * c->weight * (beam->friction_now[at] + beam->friction_before[at]) * slip;
    }
}

void wb_section_energy_take(struct wb_section_beam *beam)
{
    const struct wb_section_beam_tip *const now = &beam->tip, *const before = &beam->tip_before;

    beam->energies.external +=
        0.5 * (now->vertical + before->vertical) * (now->y - before->y) +
        0.5 * (now->vertical * now->slope + before->vertical * before->slope) *
            (now->x - before->x) -
        0.5 * (now->weight + before->weight) * (now->height - before->height);
    beam->energies.bonds = 0.0;
    for (int m = 0; m < beam->n_elements; m++) {
        add_element_energies(beam, m);
        add_station_energies(beam, m + 1);
    }
}
