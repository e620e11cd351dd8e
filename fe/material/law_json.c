#include "fe/material/law_json.h"

#include <math.h>
#include <stdio.h>

/* A stress, with its unit behind the key. */
struct writer {
    const char *unit;
    double per_unit;
};

static void put_stress(const struct writer *w, struct wb_json *object, const char *key,
                       double stress)
{
    char name[64];
    snprintf(name, sizeof name, "%s_%s", key, w->unit);
    wb_json_set_number(object, name, stress / w->per_unit);
}

static void put_parts(const struct writer *w, struct wb_json *object, const struct wb_law *law)
{
    struct wb_json *const parts = wb_json_set_array(object, "parts");
    for (int i = 0; i < law->n_parts; i++) {
        struct wb_json *const part = wb_json_append_object(parts);
        const double strain = law->parts[i].yield_strain;
        put_stress(w, part, "modulus", law->parts[i].modulus);
        wb_json_set_number(part, "yield_strain", isfinite(strain) ? strain : (double)NAN);
    }
}

static void put_chaboche(const struct writer *w, struct wb_json *object, const struct wb_law *law)
{
    put_stress(w, object, "yield_stress", law->material.yield_stress);
    put_stress(w, object, "saturation", law->saturation);
    wb_json_set_number(object, "rate", law->rate);
    struct wb_json *const backs = wb_json_set_array(object, "back_stresses");
    for (int i = 0; i < law->n_backs; i++) {
        struct wb_json *const back = wb_json_append_object(backs);
        put_stress(w, back, "modulus", law->backs[i].modulus);
        wb_json_set_number(back, "recovery", law->backs[i].recovery);
    }
}

static void put_maxwell(const struct writer *w, struct wb_json *object, const struct wb_law *law)
{
    wb_json_set_number(object, "strain_rate_1_s", law->strain_rate);
    struct wb_json *const elements = wb_json_set_array(object, "elements");
    for (int i = 0; i < law->n_maxwell; i++) {
        struct wb_json *const element = wb_json_append_object(elements);
        put_stress(w, element, "modulus", law->maxwell[i].modulus);
        wb_json_set_number(element, "time_s", law->maxwell[i].time);
    }
}

void wb_law_json_numbers(struct wb_json *object, const struct wb_law *law, const char *unit,
                         double per_unit)
{
    const struct writer w = {unit, per_unit};
    if (law->n_maxwell > 0)
        put_maxwell(&w, wb_json_set_object(object, "relaxation"), law);
    switch (law->form) {
    case WB_LAW_LUDWIK:
        put_stress(&w, object, "yield_stress", law->material.yield_stress);
        put_stress(&w, object, "strength_coefficient", law->material.strength_coefficient);
        wb_json_set_number(object, "hardening_exponent", law->material.hardening_exponent);
        return;
    case WB_LAW_PARALLEL:
        put_parts(&w, object, law);
        return;
    case WB_LAW_CHABOCHE:
        put_chaboche(&w, object, law);
        return;
    }
}
