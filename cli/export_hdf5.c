/* wirebench export REC|DATASET -o FILE.h5: all tables of a recording or dataset in one file. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "analysis/dataset/dataset_columns.h"
#include "analysis/dataset/hdf5_file.h"
#include "base/hash.h"
#include "base/version.h"
#include "cli/export.h"
#include "daq/recording/sample_columns.h"

#define WB_LOG_DOMAIN "export"

enum {
    MOST_TABLES = WB_SAMPLE_COLUMNS_TABLES + 1
};

/* The tables of one file. */
struct job {
    const struct wb_command_common *options;
    int n;
    struct wb_columns tables[MOST_TABLES];
    char sha256[WB_SHA256_TEXT];
    bool is_virtual, is_complete;
    uint64_t damaged_chunks;
};

/* --- recordings --- */

static enum wb_status put_meta(void *context, const char *key, const char *value)
{
    wb_columns_add_row(context, (const union wb_cell[]){{.text = key}, {.text = value}});
    return WB_OK;
}

static enum wb_status read_recording(struct job *job, struct wb_recording *recording)
{
    static const struct wb_column_kind kinds[] = {{"key", "", WB_COLUMN_TEXT},
                                                  {"value", "", WB_COLUMN_TEXT}};
    struct wb_rig rig;
    struct wb_replay_counts counts;
    struct wb_columns *const meta = &job->tables[WB_SAMPLE_COLUMNS_TABLES];
    WB_TRY(wb_replay_rig(recording, &rig));
    const enum wb_status status = wb_sample_columns_read(job->tables, recording, &rig, &counts);
    if (status != WB_OK && status != WB_ERR_DATA)
        return status;
    job->n = MOST_TABLES;
    wb_columns_init(meta, "meta", kinds, 2);
    const enum wb_status met = wb_recording_each_meta(recording, put_meta, meta);
    if (met != WB_OK && met != WB_ERR_DATA)
        return met;
    job->is_virtual = rig.is_virtual;
    job->damaged_chunks = counts.damaged_chunks;
    /* Damage was logged while reading; the readable part is written. */
    job->is_complete = status == WB_OK && met == WB_OK && counts.damaged_chunks == 0 &&
                       wb_recording_is_complete(recording);
    if (status == WB_ERR_DATA && counts.load_samples + counts.mocap_frames == 0)
        return status;
    return WB_OK;
}

static enum wb_status take_recording(struct job *job)
{
    struct wb_recording *recording = NULL;
    WB_TRY(wb_recording_open(&recording, job->options->input));
    const enum wb_status status = read_recording(job, recording);
    if (wb_recording_hash(recording, job->sha256) != WB_OK)
        snprintf(job->sha256, sizeof job->sha256, "unknown");
    const enum wb_status closed = wb_recording_close(recording);
    return status == WB_OK ? closed : status;
}

/* --- datasets --- */

static void keep_dataset(struct job *job, const struct wb_dataset *dataset)
{
    static const struct wb_column_kind kinds[] = {{"json", "", WB_COLUMN_TEXT}};
    struct wb_columns *const document = &job->tables[WB_DATASET_COLUMNS_TABLES];
    char *const text = wb_json_format(dataset->document);
    wb_dataset_columns_make(job->tables, dataset);
    job->n = WB_DATASET_COLUMNS_TABLES + 1;
    wb_columns_init(document, "dataset", kinds, 1);
    wb_columns_add_row(document, (const union wb_cell[]){{.text = text}});
    free(text);
    job->is_virtual = dataset->info.is_virtual;
    job->is_complete = true;
}

static enum wb_status take_dataset(struct job *job)
{
    const unsigned kinds = WB_TEST_BIT(WB_TEST_CANTILEVER) | WB_TEST_BIT(WB_TEST_THREE_POINT) |
                           WB_TEST_BIT(WB_TEST_TENSILE);
    struct wb_dataset dataset = {0};
    char path[WB_PATH];
    const enum wb_status status = wb_dataset_read_kinds(&dataset, job->options->input, kinds, NULL);
    if (status == WB_OK)
        keep_dataset(job, &dataset);
    wb_dataset_release(&dataset);
    WB_TRY(status);
    WB_TRY(wb_file_join(path, job->options->input, "force_deflection.csv"));
    return wb_hash_file(path, job->sha256);
}

/* --- the command --- */

static enum wb_status export_tables(struct job *job)
{
    const struct wb_command_common *const o = job->options;
    char source[WB_PATH + 160];
    WB_TRY(wb_command_check_output(o->output, o->force));
    WB_TRY(wb_file_is_folder(o->input) ? take_dataset(job) : take_recording(job));
    snprintf(source, sizeof source, "%s (sha256 %s), wirebench %s (%s)", wb_file_name(o->input),
             job->sha256, wb_version(), wb_version_revision());
    return wb_hdf5_file_write(o->output, job->tables, job->n, source, job->is_virtual);
}

static void print(const struct job *job)
{
    if (!job->options->json) {
        printf("%s:", job->options->output);
        for (int i = 0; i < job->n; i++)
            printf("%s %zu row%s of %s", i > 0 ? "," : "", job->tables[i].n_rows,
                   job->tables[i].n_rows == 1 ? "" : "s", job->tables[i].name);
        printf("\n");
        return;
    }
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "file", job->options->output);
    for (int i = 0; i < job->n; i++) {
        char key[64];
        snprintf(key, sizeof key, "%s_rows", job->tables[i].name);
        wb_json_set_integer(root, key, (int64_t)job->tables[i].n_rows);
    }
    wb_json_set_integer(root, "damaged_chunks", (int64_t)job->damaged_chunks);
    wb_command_print_json(root);
}

int wb_export_hdf5(const struct wb_command_common *options)
{
    struct job job = {.options = options};
    const enum wb_status status = export_tables(&job);
    if (status == WB_OK)
        print(&job);
    for (int i = 0; i < MOST_TABLES; i++)
        wb_columns_release(&job.tables[i]);
    if (job.damaged_chunks > 0)
        wb_warn("%" PRIu64 " damaged chunk%s left out", job.damaged_chunks,
                job.damaged_chunks == 1 ? " was" : "s were");
    if (status != WB_OK)
        return WB_EXIT_FAILED;
    return job.is_complete ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}
