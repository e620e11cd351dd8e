/* Any lines are answered by `solve harness --follow`, each with one line of JSON: a state of finite
 * numbers, or an error that leaves the state as it is. Input: lines, in one session. */
#include "analysis/harness/harness_follow.h"
#include "base/json.h"
#include "tests/analysis/harness/fuzz_harness.h"

static const char harness[] =
    "kind: harness\nname: small\nwires:\n  - {name: w, wire: w.yaml}\nroot: {name: R}\n"
    "branches:\n  - {name: B1, from: R, to: J, wire: w, length_mm: 300}\n"
    "  - {name: B2, from: J, to: K1, wire: w, length_mm: 200, angle_deg: 30, around_deg: 90}\n"
    "connectors:\n  - {name: K1, mass_g: 8, centre_mm: [12, 0, 0]}\n"
    "clips:\n  - {name: C1, branch: B1, at_mm: 150, holds: axis}\n"
    "  - {name: S1, branch: B1, at_mm: 250, holds: slide, friction: 0.2}\n"
    "steps:\n  - hang\n  - {mount: C1, at_mm: [140, 0, 20]}\n"
    "  - {mount: K1, at_mm: [420, -100, 60], direction: [0.5, -1, 0]}\n  - take_off\n";
static const char wire[] = "wire: mine\nouter_diameter_mm: 1.4\nmass_per_length_kg_m: 0.004\n"
                           "youngs_modulus_MPa: 5000\npoissons_ratio: 0.3\nyield_stress_MPa: 40\n"
                           "strength_coefficient_MPa: 300\nhardening_exponent: 1\n";

static struct wb_harness_plan *read_plan(void)
{
    static struct wb_harness_plan plan;
    if (plan.n_wires > 0)
        return &plan;
    fuzz_begin();
    fuzz_write(fuzz_harness_path, harness, sizeof harness - 1);
    fuzz_write(fuzz_wire_path, wire, sizeof wire - 1);
    FUZZ_REQUIRE(wb_harness_file_read(&plan, fuzz_harness_path) == WB_OK);
    return &plan;
}

/* Returns false when the session has ended. */
static bool answer_line(struct wb_harness_session *session, const char *line)
{
    struct fuzz_patience patience = {3};
    struct wb_text answer = {0};
    struct wb_json *root;
    const char *error = NULL;
    int64_t state = -1;
    const int before = wb_harness_session_state(session)->number;
    const bool goes_on = wb_harness_follow_answer(session, line, fuzz_watch, &patience, &answer);
    FUZZ_REQUIRE(answer.length > 0 &&
                 strchr(answer.bytes, '\n') == answer.bytes + answer.length - 1);
    FUZZ_REQUIRE(wb_json_parse(&root, answer.bytes, "answer") == WB_OK);
    if (goes_on) {
        FUZZ_REQUIRE(wb_json_get_integer(root, "state", &state));
        FUZZ_REQUIRE(state == wb_harness_session_state(session)->number);
    }
    if (wb_json_get_text(root, "error", &error))
        FUZZ_REQUIRE(error[0] != '\0' && (state == before || strstr(line, "steps")));
    fuzz_check_state(session);
    wb_json_destroy(root);
    wb_text_release(&answer);
    return goes_on;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    const struct wb_harness_plan *const plan = read_plan();
    struct wb_harness_settings settings = fuzz_coarse;
    struct wb_harness_session *session;
    settings.element_length = 0.05;
    keep_messages();
    FUZZ_REQUIRE(wb_harness_session_create(&session, plan, &settings) == WB_OK);
    char *const lines = malloc(n + 1);
    FUZZ_REQUIRE(lines != NULL);
    memcpy(lines, bytes, n);
    lines[n] = '\0';
    int n_lines = 0;
    for (char *line = lines, *next = lines; next && n_lines < 20; line = next, n_lines++) {
        next = strchr(line, '\n');
        if (next)
            *next++ = '\0';
        if (!answer_line(session, line))
            break;
    }
    free(lines);
    wb_harness_session_destroy(session);
    return 0;
}

#ifndef WB_LIBFUZZER

int main(int argc, char **argv)
{
    static const char *const texts[] = {
        "{\"hang\": true}\n{\"mount\": \"C1\", \"at_mm\": [140, 0, 20], \"direction\": [1, 0, "
        "0.1]}\n"
        "{\"undo\": 1}\n{\"state\": true, \"shapes\": \"all\"}\n{\"quit\": true}\n",
        "{\"mount\": \"S1\", \"at_mm\": [240, 5, 5], \"shapes\": false}\n"
        "{\"move\": \"S1\", \"at_mm\": [230, 5, 5]}\n{\"release\": \"S1\"}\n\"take_off\"\n",
        "{\"snapshot\": \"a\"}\n\"hang\"\n{\"restore\": \"a\"}\n{\"describe\": true}\n",
        "{\"steps\": 2}\n{\"undo\": 2}\n{\"steps\": \"all\"}\n{\"undo\": 1}\n",
        "{\"mount\": \"K1\", \"at_mm\": [420, -100, 60], \"direction\": [0.5, -1, 0], "
        "\"up\": [0, 0, 1]}\n{\"move\": \"R\", \"at_mm\": [0, 1, 0]}\n{\"take_off\": true}\n",
    };
    const uint8_t *seeds[WB_COUNT(texts)];
    size_t sizes[WB_COUNT(texts)];
    for (size_t i = 0; i < WB_COUNT(texts); i++) {
        seeds[i] = (const uint8_t *)texts[i];
        sizes[i] = strlen(texts[i]);
    }
    return fuzz_main(argc, argv, seeds, sizes, WB_COUNT(texts), 3000);
}

#endif
