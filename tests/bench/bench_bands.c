/* CPU cost of the bands of a bundle (analysis/predict/bands.h), the seven wires of
 * fixtures/bundles/template, relative to the same number of plain runs of the section model. The
 * difference is due to draws, laws, unloading, ranking and bootstrap. Goal: 500 runs in 20 s on two
 * cores, which is 40 s of CPU time. */
#include <stdio.h>

#include "analysis/predict/bands.h"
#include "base/file.h"
#include "fe/section/section_run.h"
#include "tests/bench/clock.h"

enum {
    RUNS = 100
};

static struct wb_bundle_model model;

/* A loading and its unloading to zero force, as a run of the bands is; negative when it fails. */
static double run_once(void)
{
    static const struct wb_section_run_settings settings = {.until_free = true,
                                                            .no_rigidities = true};
    struct wb_section_run run;
    const double start = cpu_seconds();
    if (wb_section_run_init(&run, &model, 2) != WB_OK)
        return -1.0;
    const enum wb_status status = wb_section_run(&run, &model, &settings);
    const bool is_whole = status == WB_OK && run.converged;
    wb_section_run_release(&run);
    return is_whole ? cpu_seconds() - start : -1.0;
}

int main(void)
{
    /* One variant in place of the file's scenarios: of both cases one is the file. */
    const struct wb_bundle_variant same = {.name = "again"};
    const struct wb_bands_settings settings = {
        .runs = RUNS, .seed = 1, .n_variants = 1, .variants = &same};
    struct wb_bands *bands;
    char path[WB_PATH];
    double baseline = 0.0;

    if (wb_file_find_fixture(path, "bundles", "template", NULL) != WB_OK ||
        wb_bundle_model_read(&model, path) != WB_OK)
        return 1;
    model.run.cycles = 1;
    model.run.rows = WB_BANDS_ROWS; /* as the bands have */
    for (int i = 0; i < RUNS / 10; i++) {
        const double once = run_once();
        if (once < 0.0)
            return 1;
        baseline += once * 10.0;
    }
    const double start = cpu_seconds();
    if (wb_bands_create(&bands, path, &settings) != WB_OK)
        return 1;
    const double spent = (cpu_seconds() - start) / bands->n_cases;
    wb_bands_destroy(bands);
    printf("%d runs of seven wires: %.2f times the CPU time of plain runs (%.1f ms each); 500 runs "
           "take %.1f s of CPU time (goal 40 s, which is 20 s on two cores)\n",
           RUNS, spent / baseline, 1e3 * baseline / RUNS, spent / RUNS * 500.0);
    return 0;
}
