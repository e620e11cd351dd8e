#include "analysis/solve/solve_law.h"

#include <math.h>

#include "analysis/calibration/law/bending.h"
#include "base/file.h"
#include "base/log.h"

#define WB_LOG_DOMAIN "solve"

/* Strain up to which parallel parts were measured: that at which the next part would yield. */
static double last_strain(const struct wb_law *law)
{
    double last = 0.0, before = 0.0;
    for (int i = 0; i < law->n_parts; i++) {
        if (!isfinite(law->parts[i].yield_strain))
            break;
        before = last;
        last = law->parts[i].yield_strain;
    }
    return before > 0.0 ? last * last / before : last;
}

static void report_relaxation(const struct wb_wire *wire)
{
    if (wire->law.n_maxwell > 0)
        wb_info("wire %s relaxes: computed without its Maxwell elements, as after infinitely slow "
                "loading",
                wire->name);
}

enum wb_status wb_solve_law_report(const struct wb_wire *wire)
{
    const struct wb_law *const law = &wire->law;
    const double strain = last_strain(law);
    double difference;
    if (wire->has_properties)
        report_relaxation(wire);
    if (!wire->has_properties || wb_law_is_plain(law))
        return WB_OK;
    if (law->form == WB_LAW_CHABOCHE) {
        wb_info("wire %s has Chaboche's law: computed with its Ludwik equivalent, the four "
                "numbers; loading is nearly the same, unloading is not",
                wire->name);
        return WB_OK;
    }
    if (law->form == WB_LAW_LUDWIK || !(strain > 0.0)) {
        wb_info("wire %s has a law with %s hardening: computed with its four numbers and isotropic "
                "hardening; loading is the same, unloading is not",
                wire->name, wb_law_rule_name(law));
        return WB_OK;
    }
    WB_TRY(wb_bending_compare(law, &wire->material, wire->outer_diameter,
                              strain / (0.5 * wire->outer_diameter), &difference));
    wb_info("wire %s: computed with the Ludwik equivalent of its law of parallel parts, the four "
            "numbers; loading is the same within %.2g %%, unloading is not",
            wire->name, 100.0 * difference);
    return WB_OK;
}

enum wb_status wb_solve_law_prepare(const char *name, bool is_elastic, struct wb_wire *wire,
                                    struct wb_law *law, struct wb_section *section)
{
    char path[WB_PATH];
    WB_TRY(wb_file_find_fixture(path, "wires", name, NULL));
    WB_TRY(wb_wire_read(path, wire, NULL));
    if (!wire->has_properties)
        return wb_fail(WB_ERR_DATA, "%s: the wire has no `properties` to compute with", path);
    *law = wire->law;
    report_relaxation(wire);
    if (!is_elastic)
        return wb_section_init_law(section, wire->outer_diameter, law, 0);
    struct wb_material elastic = law->material;
    elastic.hardening = WB_HARDENING_NONE_ELASTIC;
    wb_law_init_ludwik(law, &elastic);
    return wb_section_init_circle(section, wire->outer_diameter, &elastic, 0);
}
