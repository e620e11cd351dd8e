#include "analysis/report/files.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "analysis/report/html.h"
#include "analysis/report/pdf.h"
#include "base/config.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "base/workers.h"

#define WB_LOG_DOMAIN "report"

/* Pixels of a PNG for a point: 216 dots an inch. */
static const double png_scale = 3.0;

/* Figures that are drawn, a few megabytes each, before their files are compressed side by side. */
enum {
    DRAWN = 8
};

/* The files of a report, of which its cards are some. */
struct outputs {
    int n;
    struct wb_cards_file *items;
};

/* --- drawing --- */

static struct wb_text *add_output(struct outputs *outputs, const char *folder, const char *name,
                                  const char *ending)
{
    struct wb_cards_file *const output = &outputs->items[outputs->n++];
    snprintf(output->name, sizeof output->name, "%s%s.%s", folder, name, ending);
    return &output->bytes;
}

static void draw_json(struct outputs *outputs, struct wb_json *numbers)
{
    struct wb_text *const bytes = add_output(outputs, "", "report", "json");
    struct wb_json *const files = wb_json_set_array(numbers, "files");
    for (int i = 0; i < outputs->n; i++)
        wb_json_append_text(files, outputs->items[i].name);
    char *const text = wb_json_format(numbers);
    wb_text_append(bytes, "%s", text);
    free(text);
}

/* Figures drawn one after the other, as Pango does not shape texts on several threads. */
struct drawn {
    int n;
    struct wb_figure_pixels pixels[DRAWN];
    struct wb_text *png[DRAWN];
    enum wb_status status[DRAWN];
};

static enum wb_status compress(void *context, int index)
{
    struct drawn *const drawn = context;
    drawn->status[index] = wb_figure_pixels_png(&drawn->pixels[index], drawn->png[index]);
    return drawn->status[index];
}

static enum wb_status draw_some(struct outputs *outputs, const struct wb_figures *figures,
                                int begin, int n_threads, struct drawn *drawn)
{
    for (int i = begin; i < figures->n && drawn->n < DRAWN; i++) {
        const struct wb_figure *const figure = figures->items[i].figure;
        const char *const name = wb_figure_name(figure);
        WB_TRY(wb_figure_svg(figure, add_output(outputs, "figures/", name, "svg")));
        WB_TRY(wb_figure_draw(figure, png_scale, &drawn->pixels[drawn->n]));
        drawn->png[drawn->n++] = add_output(outputs, "figures/", name, "png");
    }
    const struct wb_workers workers = {
        .n = drawn->n, .n_threads = n_threads, .job = compress, .context = drawn};
    if (wb_workers_run(&workers) < drawn->n)
        return WB_ERR_MEMORY;
    for (int i = 0; i < drawn->n; i++)
        WB_TRY(drawn->status[i]);
    return WB_OK;
}

static enum wb_status draw_figures(struct outputs *outputs, const struct wb_figures *figures,
                                   int n_threads)
{
    enum wb_status status = WB_OK;
    for (int begin = 0; begin < figures->n && status == WB_OK; begin += DRAWN) {
        struct drawn drawn = {.n = 0};
        status = draw_some(outputs, figures, begin, n_threads, &drawn);
        for (int i = 0; i < drawn.n; i++)
            wb_figure_pixels_release(&drawn.pixels[i]);
    }
    return status;
}

static enum wb_status draw(struct outputs *outputs, const struct wb_document *document,
                           const struct wb_figures *figures, const struct wb_cards *cards,
                           struct wb_json *numbers, int n_threads)
{
    outputs->items =
        wb_memory_new(2 * (size_t)figures->n + (size_t)cards->n + 3, sizeof *outputs->items);
    WB_TRY(wb_pdf_render(document, add_output(outputs, "", "report", "pdf")));
    WB_TRY(wb_html_render(document, add_output(outputs, "", "report", "html")));
    WB_TRY(draw_figures(outputs, figures, n_threads));
    for (int i = 0; i < cards->n; i++) {
        struct wb_cards_file *const output = &outputs->items[outputs->n++];
        snprintf(output->name, sizeof output->name, "%s", cards->files[i].name);
        wb_text_append_bytes(&output->bytes, cards->files[i].bytes.bytes,
                             cards->files[i].bytes.length);
    }
    draw_json(outputs, numbers);
    return WB_OK;
}

static void release(struct outputs *outputs)
{
    for (int i = 0; i < outputs->n; i++)
        wb_text_release(&outputs->items[i].bytes);
    free(outputs->items);
}

/* --- writing --- */

static enum wb_status fail_errno(const char *what, const char *path)
{
    const int error = errno;
    return wb_fail(WB_ERR_IO, "cannot %s '%s': %s", what, path, strerror(error));
}

/* Folders that a report may have. */
static const char *const subfolders[] = {"figures", "cards"};

static bool is_within(const char *name, const char *subfolder)
{
    const size_t n = strlen(subfolder);
    return strncmp(name, subfolder, n) == 0 && name[n] == '/' && !strchr(name + n + 1, '/');
}

/* Those that the outputs lie in. */
static enum wb_status make_folders(const struct outputs *outputs, const char *folder)
{
    char path[WB_PATH];
    for (size_t k = 0; k < WB_COUNT(subfolders); k++) {
        bool is_used = false;
        for (int i = 0; i < outputs->n; i++)
            is_used = is_used || is_within(outputs->items[i].name, subfolders[k]);
        if (!is_used)
            continue;
        WB_TRY(wb_file_join(path, folder, subfolders[k]));
        WB_TRY(wb_file_make_folder(path));
    }
    return WB_OK;
}

/* Only those that are empty. */
static void remove_folders(const char *folder)
{
    char path[WB_PATH];
    for (size_t k = 0; k < WB_COUNT(subfolders); k++) {
        if (wb_file_join(path, folder, subfolders[k]) == WB_OK)
            rmdir(path);
    }
}

/* Writes all into a new folder within the report's, from where it is moved when all is there. */
static enum wb_status write_all(const struct outputs *outputs, const char *folder)
{
    char path[WB_PATH];
    WB_TRY(make_folders(outputs, folder));
    for (int i = 0; i < outputs->n; i++) {
        WB_TRY(wb_file_join(path, folder, outputs->items[i].name));
        WB_TRY(wb_file_write_text(path, &outputs->items[i].bytes));
    }
    return WB_OK;
}

static void remove_all(const struct outputs *outputs, const char *folder)
{
    char path[WB_PATH];
    for (int i = 0; i < outputs->n; i++) {
        if (wb_file_join(path, folder, outputs->items[i].name) == WB_OK)
            unlink(path);
    }
    remove_folders(folder);
    rmdir(folder);
}

static bool is_made(const struct outputs *outputs, const char *name)
{
    for (int i = 0; i < outputs->n; i++) {
        if (strcmp(outputs->items[i].name, name) == 0)
            return true;
    }
    return false;
}

bool wb_files_is_ours(const char *name)
{
    bool is_in_place = !strchr(name, '/');
    for (size_t k = 0; k < WB_COUNT(subfolders); k++)
        is_in_place = is_in_place || is_within(name, subfolders[k]);
    return is_in_place && !strstr(name, "..");
}

/* Files that the report before made and this one does not, as its report.json lists them. */
static void remove_stale(const struct outputs *outputs, const char *folder)
{
    char path[WB_PATH];
    struct wb_json *before = NULL;
    if (wb_file_join(path, folder, "report.json") != WB_OK || !wb_file_exists(path) ||
        wb_json_read(&before, path) != WB_OK)
        return;
    const struct wb_json *const files = wb_json_get(before, "files");
    for (size_t i = 0; i < wb_json_length(files); i++) {
        const char *name;
        if (wb_json_text(wb_json_item(files, i), &name) && wb_files_is_ours(name) &&
            !is_made(outputs, name) && wb_file_join(path, folder, name) == WB_OK)
            unlink(path);
    }
    remove_folders(folder);
    wb_json_destroy(before);
}

/* Moves the new files over the old ones, each at once. */
static enum wb_status move_all(const struct outputs *outputs, const char *from, const char *to)
{
    char source[WB_PATH], target[WB_PATH];
    remove_stale(outputs, to);
    WB_TRY(make_folders(outputs, to));
    for (int i = 0; i < outputs->n; i++) {
        WB_TRY(wb_file_join(source, from, outputs->items[i].name));
        WB_TRY(wb_file_join(target, to, outputs->items[i].name));
        if (rename(source, target) != 0)
            return fail_errno("write", target);
    }
    return WB_OK;
}

static enum wb_status write_folder(const struct outputs *outputs, const char *folder, bool force)
{
    char beside[WB_PATH];
    WB_TRY(wb_file_join(beside, folder, ".new-XXXXXX"));
    WB_TRY(wb_file_prepare_output(folder, force));
    if (!mkdtemp(beside))
        return fail_errno("write into", folder);
    enum wb_status status = write_all(outputs, beside);
    if (status == WB_OK)
        status = move_all(outputs, beside, folder);
    remove_all(outputs, beside);
    if (status != WB_OK)
        rmdir(folder); /* succeeds only when it is empty, that is, when it was just made */
    return status;
}

enum wb_status wb_files_write(const struct wb_document *document, const struct wb_figures *figures,
                              const struct wb_cards *cards, struct wb_json *numbers,
                              const char *folder, bool force, int n_threads)
{
    struct outputs outputs = {0};
    enum wb_status status = draw(&outputs, document, figures, cards, numbers, n_threads);
    if (status == WB_OK)
        status = write_folder(&outputs, folder, force);
    release(&outputs);
    return status;
}
