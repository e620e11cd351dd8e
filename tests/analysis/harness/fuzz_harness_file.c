/* Any bytes are read as a harness file and the wire that it names, or rejected with a message; an
 * accepted harness is computed for some increments. Input: the harness file, a line `====`, and the
 * wire's file, `w.yaml`. */
#include "tests/analysis/harness/fuzz_harness.h"

static const char border[] = "\n====\n";
static int n_accepted; /* inputs */

static void check_plan(const struct wb_harness_plan *plan)
{
    FUZZ_REQUIRE(plan->n_wires > 0 && plan->n_branches > 0 && plan->n_items > 0);
    FUZZ_REQUIRE(plan->n_steps > 0);
    FUZZ_REQUIRE(fuzz_is_finite(plan->gravity, 3) && fuzz_is_finite(plan->root.position, 3));
    FUZZ_REQUIRE(fuzz_is_finite(plan->root.rotation, 4));
    for (int i = 0; i < plan->n_wires; i++) {
        FUZZ_REQUIRE(plan->wires[i].diameter > 0.0 && isfinite(plan->wires[i].diameter));
        FUZZ_REQUIRE(plan->wires[i].mass > 0.0 && isfinite(plan->wires[i].mass));
    }
    for (int i = 0; i < plan->n_branches; i++) {
        const struct wb_harness_plan_branch *const branch = &plan->branches[i];
        FUZZ_REQUIRE(branch->wire >= 0 && branch->wire < plan->n_wires);
        FUZZ_REQUIRE(branch->parent >= -1 && branch->parent < i);
        FUZZ_REQUIRE(branch->length > 0.0 && fuzz_is_finite(branch->leaving, 4));
    }
    for (int i = 0; i < plan->n_items; i++) {
        const struct wb_harness_item *const item = &plan->items[i];
        FUZZ_REQUIRE(item->branch < plan->n_branches && (item->branch >= 0) == (i > 0));
        FUZZ_REQUIRE(i == 0 || (item->at > 0.0 && item->at <= plan->branches[item->branch].length));
    }
    for (int i = 0; i < plan->n_steps; i++) {
        FUZZ_REQUIRE(plan->steps[i].item >= 0 && plan->steps[i].item < plan->n_items);
        FUZZ_REQUIRE(fuzz_is_finite(plan->steps[i].position, 3));
    }
}

/* A harness that the solver does not accept is rejected with a message, too. */
static void compute(const struct wb_harness_plan *plan)
{
    struct wb_harness_settings settings = fuzz_coarse;
    struct fuzz_patience patience = {3};
    struct wb_harness_session *session;
    const int before = kept.n;
    for (int i = 0; i < plan->n_branches; i++)
        settings.element_length += plan->branches[i].length / 10.0;
    if (wb_harness_session_create(&session, plan, &settings) != WB_OK) {
        FUZZ_REQUIRE(kept.n > before);
        return;
    }
    for (int i = 0; i < plan->n_steps && patience.increments > 0; i++) {
        const char *key;
        struct wb_reason why = {""};
        FUZZ_REQUIRE(wb_harness_session_step(session, &plan->steps[i], fuzz_watch, &patience, &key,
                                             &why) == WB_OK);
        fuzz_check_state(session);
        if (wb_harness_session_state(session)->result.end != WB_HARNESS_CONVERGED)
            break;
    }
    wb_harness_session_destroy(session);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    static struct wb_harness_plan plan;
    const uint8_t *const end = n > 0 ? memmem(bytes, n, border, sizeof border - 1) : NULL;
    const size_t n_harness = end ? (size_t)(end - bytes) : n;
    const size_t wire = end ? n_harness + sizeof border - 1 : n;
    fuzz_begin();
    fuzz_write(fuzz_harness_path, bytes, n_harness);
    fuzz_write(fuzz_wire_path, bytes + wire, n - wire);
    keep_messages();
    if (wb_harness_file_read(&plan, fuzz_harness_path) == WB_OK) {
        n_accepted++;
        check_plan(&plan);
        compute(&plan);
    } else {
        FUZZ_REQUIRE(kept.error[0] != '\0');
    }
    return 0;
}

#ifndef WB_LIBFUZZER

int main(int argc, char **argv)
{
    static const char *const harnesses[] = {
        "kind: harness\nname: a\nwires:\n  - {name: w, wire: w.yaml}\n"
        "root: {name: R, at_mm: [1, 2, 3], direction: [1, 0, 0], up: [0, 0, 1]}\n"
        "branches:\n  - {name: B1, from: R, to: J, wire: w, length_mm: 300}\n"
        "  - {name: B2, from: J, to: K1, wire: w, length_mm: 200, angle_deg: 30, around_deg: 90}\n"
        "  - {name: B3, from: J, to: K2, wire: w, length_mm: 250, least_radius_mm: 20}\n"
        "connectors:\n  - {name: K1, mass_g: 8, centre_mm: [12, 0, 0], most_force_N: 2}\n"
        "clips:\n  - {name: C1, branch: B1, at_mm: 200, holds: axis, most_moment_N_mm: 10}\n"
        "steps:\n  - hang\n"
        "  - {mount: C1, at_mm: [190, 0, 30], direction: [1, 0.2, 0.2]}\n"
        "  - {move: C1, at_mm: [190, 20, 30]}\n  - {release: C1}\n  - take_off\n",
        "kind: harness\nname: b\ntitle: two\ngravity_m_s2: [0, 1, -9]\n"
        "wires:\n  - {name: w, wire: w.yaml, torsional_stiffness_N_mm2: 600}\n"
        "  - {name: v, wire: bundle-7}\nroot: {name: R}\n"
        "branches:\n  - name: B1\n    from: R\n    to: E\n    wire: v\n    length_mm: 100\n"
        "    natural_shape: {curve: [{at_mm: 0, curvature_1_m: [1, 2]}, "
        "{at_mm: 50, curvature_1_m: [0, 3]}]}\n"
        "  - {name: B2, from: E, to: F, wire: w, length_mm: 80, "
        "natural_shape: {curvature_1_m: [5, 0]}}\n"
        "clips:\n  - {name: S, branch: B1, at_mm: 70, holds: slide, friction: 0.3}\n"
        "  - {name: P, branch: B2, at_mm: 80, holds: point}\n"
        "steps:\n  - {mount: S, at_mm: [65, 5, 0]}\n  - {mount: P, at_mm: [150, 10, 5]}\n"
        "  - hang\n",
    };
    static const char *const wires[] = {
        "name: mine\nconductor_diameter_mm: 1\nouter_diameter_mm: 1.4\ndensity_g_cm3: 5\n"
        "properties:\n  source: none\n  youngs_modulus_MPa: 4500\n  poissons_ratio: 0.39\n"
        "  yield_stress_MPa: 4.5\n  strength_coefficient_MPa: 1327\n  hardening_exponent: 0.9\n",
        "wire: mine\nouter_diameter_mm: 1.4\nmass_per_length_kg_m: 0.004\n"
        "youngs_modulus_MPa: 5000\npoissons_ratio: 0.3\nyield_stress_MPa: 40\n"
        "strength_coefficient_MPa: 300\nhardening_exponent: 1\n",
    };
    struct wb_text texts[WB_COUNT(harnesses)] = {{0}};
    const uint8_t *seeds[WB_COUNT(harnesses)];
    size_t sizes[WB_COUNT(harnesses)];
    for (size_t i = 0; i < WB_COUNT(harnesses); i++) {
        wb_text_append(&texts[i], "%s%s%s", harnesses[i], border, wires[i]);
        seeds[i] = (const uint8_t *)texts[i].bytes;
        sizes[i] = texts[i].length;
    }
    const int code = fuzz_main(argc, argv, seeds, sizes, WB_COUNT(harnesses), 20000);
    FUZZ_REQUIRE(argc > 2 || n_accepted >= (int)WB_COUNT(harnesses));
    for (size_t i = 0; i < WB_COUNT(harnesses); i++)
        wb_text_release(&texts[i]);
    return code;
}

#endif
