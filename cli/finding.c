#include "cli/finding.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "cli/print.h"

#define WB_LOG_DOMAIN "figure"

enum {
    INDENT = 8 /* columns of the labels */
};

/* Columns of the terminal; 0: stdout is not a terminal, and lines are not wrapped. */
static int width_of_terminal(void)
{
    struct winsize window = {0};
    if (!isatty(STDOUT_FILENO) || ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) != 0)
        return 0;
    return window.ws_col > 2 * INDENT ? window.ws_col : 0;
}

static void write_line(FILE *out, const char *label, const char *text, int width)
{
    int column = INDENT;
    if (!text[0])
        return;
    fprintf(out, "%-*s", INDENT, label);
    while (*text) {
        const int word = (int)strcspn(text, " ");
        if (width > 0 && column + word >= width && column > INDENT) {
            fprintf(out, "\n%*s", INDENT, "");
            column = INDENT;
        }
        fprintf(out, "%.*s", word, text);
        column += word;
        text += word;
        if (*text == ' ') {
            fprintf(out, " ");
            column++;
            text++;
        }
    }
    fprintf(out, "\n");
}

void wb_finding_write(FILE *out, struct wb_finding *finding)
{
    const int width = width_of_terminal();
    fprintf(out, "\n");
    write_line(out, "found", wb_text_string(&finding->found), width);
    write_line(out, "trust", wb_text_string(&finding->trust), width);
    if (finding->figure)
        write_line(out, "figure", finding->figure, width);
    write_line(out, "next", wb_text_string(&finding->next), width);
    wb_text_release(&finding->found);
    wb_text_release(&finding->trust);
    wb_text_release(&finding->next);
}

void wb_finding_print(struct wb_finding *finding)
{
    wb_finding_write(stdout, finding);
}

void wb_finding_append_quantity(struct wb_text *text, const struct wb_properties *properties,
                                enum wb_quantity_id id, int k)
{
    const struct wb_quantity *const row = &wb_quantity_rows[id];
    const struct wb_quantity_values values = wb_quantity_values(properties, id);
    const struct wb_estimate *const e = &values.estimate[k];
    char label[WB_QUANTITY_LABEL], a[WB_PRINT_NUMBER], b[WB_PRINT_NUMBER], c[WB_PRINT_NUMBER];
    const char *const space = row->unit[0] ? " " : "";
    wb_quantity_label(id, values.curvature ? values.curvature[k] : 0.0, label);
    if (isfinite(e->value)) {
        wb_text_append(text, "%s %s%s%s", label, wb_print_number(e->value / row->scale, a), space,
                       row->unit);
        if (isfinite(e->low))
            wb_text_append(text, " (%s to %s)", wb_print_number(e->low / row->scale, b),
                           wb_print_number(e->high / row->scale, c));
    } else {
        wb_text_append(text, "%s between %s and %s%s%s over laws", label,
                       wb_print_number(e->candidates_low / row->scale, b),
                       wb_print_number(e->candidates_high / row->scale, c), space, row->unit);
    }
}

const char *wb_finding_source(const struct wb_test_info *info)
{
    return info->is_virtual ? "virtual rig" : info->is_simulation ? "simulation" : "measured";
}

const char *wb_finding_properties_source(const struct wb_properties *properties)
{
    return properties->is_virtual      ? "virtual rig"
           : properties->is_simulation ? "simulation"
                                       : "measured";
}

void wb_finding_append_command(struct wb_text *text, const char *format, ...)
{
    va_list words;
    va_start(words, format);
    for (const char *place; (place = strstr(format, "%s")) != NULL; format = place + 2) {
        wb_text_append_bytes(text, format, (size_t)(place - format));
        wb_text_append_quoted(text, va_arg(words, const char *));
    }
    va_end(words);
    wb_text_append(text, "%s", format);
}

void wb_finding_append_validate(struct wb_text *text, const char *output, const char *wire,
                                const char *another)
{
    char file[WB_PATH];
    if (output) {
        wb_finding_append_command(text, "wirebench validate %s DATASET..., ", output);
        wb_text_append(text, "with tests of another %s", another);
        return;
    }
    snprintf(file, sizeof file, "%s.yaml", wire);
    wb_finding_append_command(text, "run the same command with -o %s to keep the properties", file);
}

const char *wb_finding_figure_path(char path[WB_PATH], const char *output)
{
    const char *const dot = strrchr(wb_file_name(output), '.');
    const int stem =
        (int)(dot && dot > wb_file_name(output) ? (size_t)(dot - output) : strlen(output));
    snprintf(path, WB_PATH, "%.*s.svg", stem < WB_PATH - 8 ? stem : WB_PATH - 8, output);
    return path;
}

const char *wb_finding_folder_figure_path(char path[WB_PATH], const char *folder)
{
    size_t n = strlen(folder);
    while (n > 1 && folder[n - 1] == '/')
        n--;
    snprintf(path, WB_PATH, "%.*s.svg", n < WB_PATH - 8 ? (int)n : WB_PATH - 8, folder);
    return path;
}

enum wb_status wb_finding_check_figure(const char *path, bool force)
{
    if (!force && wb_file_exists(path))
        return wb_fail(WB_ERR_EXISTS,
                       "'%s' exists; --force overwrites it, --no-figure draws no figure", path);
    return WB_OK;
}
