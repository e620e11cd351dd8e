#include "cli/finding.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "cli/print.h"

enum {
    INDENT = 8 /* columns of the labels */
};

/* Columns of the terminal; 0: stdout is none, and lines are not wrapped. */
static int width_of_terminal(void)
{
    struct winsize window = {0};
    if (!isatty(STDOUT_FILENO) || ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) != 0)
        return 0;
    return window.ws_col > 2 * INDENT ? window.ws_col : 0;
}

static void print_line(const char *label, const char *text, int width)
{
    int column = INDENT;
    if (!text[0])
        return;
    printf("%-*s", INDENT, label);
    while (*text) {
        const int word = (int)strcspn(text, " ");
        if (width > 0 && column + word >= width && column > INDENT) {
            printf("\n%*s", INDENT, "");
            column = INDENT;
        }
        printf("%.*s", word, text);
        column += word;
        text += word;
        if (*text == ' ') {
            printf(" ");
            column++;
            text++;
        }
    }
    printf("\n");
}

void wb_finding_print(struct wb_finding *finding)
{
    const int width = width_of_terminal();
    printf("\n");
    print_line("found", wb_text_string(&finding->found), width);
    print_line("trust", wb_text_string(&finding->trust), width);
    if (finding->figure)
        print_line("figure", finding->figure, width);
    print_line("next", wb_text_string(&finding->next), width);
    wb_text_release(&finding->found);
    wb_text_release(&finding->trust);
    wb_text_release(&finding->next);
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

const char *wb_finding_figure_path(char path[WB_PATH], const char *output)
{
    const char *const dot = strrchr(wb_file_name(output), '.');
    const int stem =
        (int)(dot && dot > wb_file_name(output) ? (size_t)(dot - output) : strlen(output));
    snprintf(path, WB_PATH, "%.*s.svg", stem < WB_PATH - 8 ? stem : WB_PATH - 8, output);
    return path;
}
