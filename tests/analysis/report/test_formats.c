/* What earlier versions wrote, or took, is read: fixtures/formats/VERSION holds a small file of
 * every format of each released version, made by fixtures/formats/make-formats. The files are never
 * changed. */
#include "tests/check.h"

#include <dirent.h>
#include <glob.h>
#include <stdlib.h>
#include <unistd.h>

#include "analysis/align/align.h"
#include "analysis/calibration/properties/properties.h"
#include "analysis/dataset/dataset.h"
#include "analysis/report/kinds/kinds.h"
#include "base/file.h"
#include "base/units.h"
#include "base/version.h"
#include "daq/protocol/rig.h"
#include "daq/protocol/specimen.h"
#include "daq/recording/index.h"
#include "daq/recording/survey.h"
#include "fe/material/material_file.h"
#include "fe/model/bundle_model.h"
#include "fe/model/wire.h"
#include "fe/model/wire_model.h"

/* Of every version; the first is 0.1.0. */
static glob_t versions;

static int find_versions(void **state)
{
    char pattern[WB_PATH];
    (void)state;
    assert_int_equal(
        wb_file_join(pattern, getenv("WIREBENCH_SOURCE_ROOT"), "fixtures/formats/*.*.*"), WB_OK);
    return glob(pattern, 0, NULL, &versions);
}

static int release_versions(void **state)
{
    (void)state;
    globfree(&versions);
    return 0;
}

/* Calls `look` with the path of a file in the folder of each version. */
static void each(const char *name, void (*look)(const char *path))
{
    for (size_t i = 0; i < versions.gl_pathc; i++) {
        char path[WB_PATH];
        assert_int_equal(wb_file_join(path, versions.gl_pathv[i], name), WB_OK);
        if (i == 0 || wb_file_exists(path)) /* a format that came later, or is gone */
            look(path);
    }
}

#define FACT(name, file)                                                                           \
    static void look_at_##name(const char *path);                                                  \
    static void name##_is_read(void **state)                                                       \
    {                                                                                              \
        (void)state;                                                                               \
        each(file, look_at_##name);                                                                \
    }                                                                                              \
    static void look_at_##name(const char *path)

FACT(rig, "rig.yaml")
{
    struct wb_rig rig;
    assert_int_equal(wb_rig_read(path, &rig), WB_OK);
    assert_string_equal(rig.name, "paper bench, single wires");
    assert_close(rig.strand.length, 0.760, 1e-12);
}

FACT(specimen, "specimen.yaml")
{
    struct wb_specimen specimen;
    assert_int_equal(wb_specimen_read(path, &specimen), WB_OK);
    assert_string_equal(specimen.wire, "type1");
    assert_int_equal(specimen.n_markers, 7);
    assert_close(specimen.length, 0.085, 1e-12);
}

FACT(wire, "wire.yaml")
{
    struct wb_wire wire;
    assert_int_equal(wb_wire_read(path, &wire, NULL), WB_OK);
    assert_true(wire.has_properties);
    assert_close(wire.outer_diameter, 0.0011, 1e-12);
    assert_close_relative(wire.material.youngs_modulus, 5021e6, 1e-12);
}

FACT(material, "material.yaml")
{
    struct wb_material_file file;
    assert_int_equal(wb_material_file_read(&file, path), WB_OK);
    assert_close_relative(file.material.youngs_modulus, 68.2e9, 1e-12);
    assert_true(file.is_substitute);
}

FACT(material_of_tensile_tests, "material-tensile.yaml")
{
    struct wb_material_file file;
    assert_int_equal(wb_material_file_read(&file, path), WB_OK);
    assert_string_equal(file.origin, "tensile tests");
    assert_close_relative(file.material.youngs_modulus, 70e9, 1e-12);
}

FACT(model, "model.yaml")
{
    struct wb_wire_model *const model = test_malloc(sizeof *model);
    assert_int_equal(wb_wire_model_read(model, path), WB_OK);
    assert_string_equal(model->name, "residual-1-8awg");
    assert_close(model->length, 0.1, 1e-12);
    test_free(model);
}

FACT(bundle, "bundle.yaml")
{
    struct wb_bundle_model *const bundle = test_malloc(sizeof *bundle);
    assert_int_equal(wb_bundle_model_read(bundle, path), WB_OK);
    assert_close(bundle->length, 0.114, 1e-12);
    assert_true(bundle->has_tape && bundle->has_published);
    test_free(bundle);
}

FACT(machine, "machine.yaml")
{
    struct wb_machine machine;
    assert_int_equal(wb_machine_read(path, &machine, NULL), WB_OK);
    assert_int_equal(machine.kind, WB_TEST_THREE_POINT);
}

FACT(index, "index.yaml")
{
    struct wb_index index;
    assert_int_equal(wb_index_read(&index, path, NULL), WB_OK);
    assert_int_equal(index.n, 1);
    assert_string_equal(index.entries[0].wire, "type1");
    assert_close(index.entries[0].length, 0.085, 1e-12);
    assert_true(index.entries[0].is_virtual);
    /* The recording beside it is the one that is listed. */
    char file[WB_PATH], sha256[WB_SHA256_TEXT];
    assert_int_equal(wb_file_join(file, index.folder, index.entries[0].file), WB_OK);
    assert_int_equal(wb_recording_sha256(file, sha256, NULL), WB_OK);
    assert_string_equal(sha256, index.entries[0].sha256);
    wb_index_release(&index);
}

/* A campaign's file, by the kind that takes it. */
static void read_campaign(const char *path, const char *name, const char *title)
{
    for (size_t k = 0; k < WB_KINDS; k++) {
        const struct wb_kind *const kind = wb_kinds[k];
        if (strcmp(kind->name, name) != 0)
            continue;
        void *const campaign = test_calloc(1, kind->campaign_size);
        assert_int_equal(wb_kind_read(kind, campaign, path), WB_OK);
        assert_string_equal(((struct wb_campaign *)campaign)->title, title);
        kind->release_campaign(campaign);
        test_free(campaign);
        return;
    }
    fail_msg("no kind of campaign '%s'", name);
}

FACT(campaign_of_recordings, "campaign-recordings.yaml")
{
    read_campaign(path, "recordings", "Single wires, types 1 to 3");
}

FACT(campaign_of_comparison, "campaign-comparison.yaml")
{
    read_campaign(path, "comparison", "The single wire in 3D and in 1D");
}

FACT(campaign_of_bundles, "campaign-bundles.yaml")
{
    read_campaign(path, "bundles", "Taped bundles in 3D and in 1D");
}

FACT(campaign_of_a_prediction, "campaign-prediction.yaml")
{
    read_campaign(path, "prediction", "Seven taped wires before they are bent");
}

FACT(campaign_of_a_machine, "campaign-machine.yaml")
{
    read_campaign(path, "machine", "A cable and its layers in three-point bending");
}

FACT(campaign_of_a_harness, "campaign-harness.yaml")
{
    read_campaign(path, "harness", "A trunk with two leads, mounted and taken off");
}

FACT(recording, "recording.wbr.zst")
{
    struct wb_recording *recording;
    struct wb_survey *const survey = test_malloc(sizeof *survey);
    assert_int_equal(wb_recording_open(&recording, path), WB_OK);
    assert_int_equal(wb_survey_run(recording, true, survey), WB_OK);
    assert_true(wb_survey_is_whole(survey) && survey->is_virtual);
    assert_true(survey->has_rig && survey->has_specimen);
    assert_int_equal(survey->n_streams, 3);
    for (int i = 0; i < 3; i++)
        assert_true(survey->streams[i].samples > 0);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    test_free(survey);
}

static void read_dataset(struct wb_dataset *dataset, const char *path, enum wb_test_kind kind)
{
    assert_int_equal(wb_dataset_read_kinds(dataset, path, WB_TEST_BIT(kind), NULL), WB_OK);
    assert_int_equal(dataset->info.kind, kind);
}

FACT(dataset_of_a_cantilever, "cantilever")
{
    struct wb_dataset dataset;
    read_dataset(&dataset, path, WB_TEST_CANTILEVER);
    assert_int_equal(dataset.n_rows, 9);
    assert_close(dataset.rows[4].deflection, 0.050, 1e-12);
    assert_true(dataset.info.is_simulation && dataset.n_shape_rows > 9);
    assert_close(dataset.info.length, 0.085, 1e-12);
    wb_dataset_release(&dataset);
}

FACT(dataset_of_three_point_bending, "three-point")
{
    struct wb_dataset dataset;
    read_dataset(&dataset, path, WB_TEST_THREE_POINT);
    assert_int_equal(dataset.n_rows, 9);
    assert_close(dataset.rows[8].deflection, 0.004, 1e-12);
    assert_close(dataset.info.length, 0.040, 1e-12);
    wb_dataset_release(&dataset);
}

FACT(dataset_of_a_tensile_test, "tensile")
{
    struct wb_dataset dataset;
    read_dataset(&dataset, path, WB_TEST_TENSILE);
    assert_int_equal(dataset.n_rows, 81);
    assert_close(dataset.info.piece.area, 1e-6, 1e-18);
    assert_close(dataset.rows[80].force, 175.83, 1.0);
    wb_dataset_release(&dataset);
}

FACT(properties_of_the_paper, "properties-paper.yaml")
{
    struct wb_properties *const properties = test_malloc(sizeof *properties);
    assert_int_equal(wb_properties_read(path, properties), WB_OK);
    assert_string_equal(properties->wire, "type1");
    assert_close_relative(properties->material.youngs_modulus, 5021e6, 0.03);
    assert_true(properties->is_simulation);
    test_free(properties);
}

FACT(properties_of_whole_cycles, "properties-cycle.yaml")
{
    struct wb_properties *const properties = test_malloc(sizeof *properties);
    assert_int_equal(wb_properties_read(path, properties), WB_OK);
    assert_string_equal(properties->method, "cycle");
    assert_int_equal(properties->n_specimens, 1);
    assert_true(properties->n_moments > 2);
    assert_true(properties->rigidity.value > 0.0);
    test_free(properties);
}

static const char *const files[] = {
    "rig.yaml",
    "specimen.yaml",
    "wire.yaml",
    "material.yaml",
    "material-tensile.yaml",
    "model.yaml",
    "bundle.yaml",
    "machine.yaml",
    "index.yaml",
    "campaign-recordings.yaml",
    "campaign-comparison.yaml",
    "campaign-bundles.yaml",
    "campaign-prediction.yaml",
    "campaign-machine.yaml",
    "campaign-harness.yaml",
    "recording.wbr.zst",
    "cantilever",
    "three-point",
    "tensile",
    "properties-paper.yaml",
    "properties-cycle.yaml",
};

/* A file that is added, or a version whose files were never made, is noticed. */
static void every_stored_file_has_a_fact(void **state)
{
    (void)state;
    bool has_own = false;
    for (size_t v = 0; v < versions.gl_pathc; v++) {
        DIR *const folder = opendir(versions.gl_pathv[v]);
        assert_non_null(folder);
        for (const struct dirent *entry; (entry = readdir(folder));) {
            bool is_known = entry->d_name[0] == '.';
            for (size_t i = 0; i < WB_COUNT(files); i++)
                is_known = is_known || strcmp(entry->d_name, files[i]) == 0;
            if (!is_known)
                fail_msg("no fact looks at %s/%s", versions.gl_pathv[v], entry->d_name);
        }
        closedir(folder);
        has_own = has_own || strcmp(wb_file_name(versions.gl_pathv[v]), wb_version()) == 0;
    }
    if (!has_own)
        fail_msg("run fixtures/formats/make-formats: there are no files of version %s",
                 wb_version());
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rig_is_read),
        cmocka_unit_test(specimen_is_read),
        cmocka_unit_test(wire_is_read),
        cmocka_unit_test(material_is_read),
        cmocka_unit_test(material_of_tensile_tests_is_read),
        cmocka_unit_test(model_is_read),
        cmocka_unit_test(bundle_is_read),
        cmocka_unit_test(machine_is_read),
        cmocka_unit_test(index_is_read),
        cmocka_unit_test(campaign_of_recordings_is_read),
        cmocka_unit_test(campaign_of_comparison_is_read),
        cmocka_unit_test(campaign_of_bundles_is_read),
        cmocka_unit_test(campaign_of_a_prediction_is_read),
        cmocka_unit_test(campaign_of_a_machine_is_read),
        cmocka_unit_test(campaign_of_a_harness_is_read),
        cmocka_unit_test(recording_is_read),
        cmocka_unit_test(dataset_of_a_cantilever_is_read),
        cmocka_unit_test(dataset_of_three_point_bending_is_read),
        cmocka_unit_test(dataset_of_a_tensile_test_is_read),
        cmocka_unit_test(properties_of_the_paper_is_read),
        cmocka_unit_test(properties_of_whole_cycles_is_read),
        cmocka_unit_test(every_stored_file_has_a_fact),
    };
    return cmocka_run_group_tests(tests, find_versions, release_versions);
}
