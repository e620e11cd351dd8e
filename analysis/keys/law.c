/* Keys of laws: in JSON documents, and in the block `law` of properties and wire files. */
#include "analysis/keys/common.h"
#include "analysis/keys/row.h"

static const struct wb_key part_rows[] = {
    {"modulus_MPa", NUMBER, "modulus of the part"},
    {"yield_strain", NUMBER | UNKNOWN, "strain at which the part yields; null: it stays elastic"},
};
static WB_KEYS(part, "law_part", "One of the elastic-plastic parts in parallel.");

static const struct wb_key back_rows[] = {
    {"modulus_MPa", NUMBER, "C, the initial modulus of the back stress"},
    {"recovery", NUMBER, "gamma, the rate of recovery; 0: the back stress does not saturate"},
};
static WB_KEYS(back, "law_back_stress", "One back stress of Chaboche's law.");

static const struct wb_key maxwell_rows[] = {
    {"modulus_MPa", NUMBER, "modulus of the element"},
    {"time_s", NUMBER, "relaxation time"},
};
static WB_KEYS(maxwell, "law_maxwell", "A Maxwell element beside the law.");

static const struct wb_key relaxation_rows[] = {
    {"strain_rate_1_s", NUMBER,
     "strain rate of the outer fibre at which moments are stated; 0: of the relaxed law"},
    {"elements", OBJECT | LIST, "one or two Maxwell elements", &maxwell_keys},
};
static WB_KEYS(relaxation, "law_relaxation", "The relaxation of a wire that relaxes.");

static const struct wb_key wb_law_numbers_rows[] = {
    {"relaxation", OBJECT | OPTIONAL, "Maxwell elements, of a wire that relaxes", &relaxation_keys},
    {"yield_stress_MPa", NUMBER | OPTIONAL,
     "sigma_Y of Ludwik's law; initial yield stress of Chaboche's law"},
    {"strength_coefficient_MPa", NUMBER | OPTIONAL,
     "K of Ludwik's law: the stress is sigma_Y + K ep^n beyond yield"},
    {"hardening_exponent", NUMBER | OPTIONAL, "n of Ludwik's law"},
    {"parts", OBJECT | LIST | OPTIONAL, "elastic-plastic parts in parallel", &part_keys},
    {"saturation_MPa", NUMBER | OPTIONAL,
     "Q of Chaboche's law, the growth of the yield stress at saturation"},
    {"rate", NUMBER | OPTIONAL, "b of Chaboche's law, the rate of that growth"},
    {"back_stresses", OBJECT | LIST | OPTIONAL, "back stresses of Chaboche's law", &back_keys},
};
WB_KEYS(wb_law_numbers, "law_numbers", "The numbers of a law, by its form.");

#define FORMS "ludwik|parallel|chaboche"
#define RULES "isotropic|kinematic|mixed|combined"
#define SHARE                                                                                      \
    "share of the hardening that is isotropic: of mixed hardening a share of the area, of "        \
    "combined "                                                                                    \
    "hardening a share of the hardening stress or of a part's modulus"

static const struct wb_key wb_law_json_rows[] = {
    {"form", TEXT, "form of the curve of the first loading", .choices = FORMS},
    {"hardening", TEXT, "hardening rule", .choices = RULES},
    {"isotropic_share", NUMBER, SHARE},
    {"youngs_modulus_MPa", NUMBER, "Young's modulus E; of parallel parts the sum of moduli"},
    {"poissons_ratio", NUMBER, "Poisson's ratio"},
    {.of = &wb_law_numbers_keys},
};
WB_KEYS(wb_law_json, "law", "A law of the homogenised wire.");

static const struct wb_key wb_law_ludwik_rows[] = {
    {"youngs_modulus_MPa", NUMBER, "Young's modulus E, homogenised over the outer diameter"},
    {"yield_stress_MPa", NUMBER, "yield stress sigma_Y"},
    {"strength_coefficient_MPa", NUMBER,
     "strength coefficient K; the stress is sigma_Y + K ep^n beyond yield"},
    {"hardening_exponent", NUMBER, "hardening exponent n"},
};
WB_KEYS(wb_law_ludwik, "ludwik", "The four numbers of Ludwik's law.");

/* --- in files --- */

static const struct wb_key file_part_rows[] = {
    {"modulus_MPa", NUMBER, "modulus of the part"},
    {"yield_strain", NUMBER | OPTIONAL,
     "strain at which the part yields; absent: the last part stays elastic"},
};
static WB_KEYS(file_part, "file_law_part", "One of the elastic-plastic parts in parallel.");

static const struct wb_key file_chaboche_rows[] = {
    {"youngs_modulus_MPa", NUMBER, "Young's modulus E"},
    {"yield_stress_MPa", NUMBER, "initial yield stress"},
    {"saturation_MPa", NUMBER | OPTIONAL, "Q, the growth of the yield stress at saturation"},
    {"rate", NUMBER | OPTIONAL, "b, the rate of that growth"},
    {"back_stresses", OBJECT | LIST | OPTIONAL, "one to three back stresses", &back_keys},
};
static WB_KEYS(file_chaboche, "file_law_chaboche", "The numbers of Chaboche's law.");

static const struct wb_key file_relaxation_rows[] = {
    {"strain_rate_1_s", NUMBER | OPTIONAL,
     "strain rate of the outer fibre at which moments are stated; 0 or absent: of the relaxed law"},
    {"elements", OBJECT | LIST, "one or two Maxwell elements", &maxwell_keys},
};
static WB_KEYS(file_relaxation, "file_law_relaxation", "The relaxation of a wire that relaxes.");

static const struct wb_key wb_law_file_rows[] = {
    {"form", TEXT, "form of the curve of the first loading", .choices = FORMS},
    {"hardening", TEXT, "hardening rule", .choices = RULES},
    {"isotropic_share", NUMBER | OPTIONAL, SHARE},
    {"parts", OBJECT | LIST | OPTIONAL, "of form `parallel`: parts with ascending yield strain",
     &file_part_keys},
    {"chaboche", OBJECT | OPTIONAL, "of form `chaboche`: its numbers", &file_chaboche_keys},
    {"relaxation", OBJECT | OPTIONAL, "Maxwell elements, of a wire that relaxes",
     &file_relaxation_keys},
};
WB_KEYS(wb_law_file, "file_law", "The law of a wire, as in a wire file.");
