#include "analysis/report/html.h"

#include <string.h>

#define WB_LOG_DOMAIN "report"

static const char style[] =
    ":root{--ink:#1d2733;--grey:#5d6875;--rule:#dde2e8;--blue:#0072b2;--red:#b3261e;"
    "--green:#1b6e4b}\n"
    "*{box-sizing:border-box}\n"
    "html{scroll-behavior:smooth}\n"
    "body{margin:0;color:var(--ink);background:#f5f7f9;font:16px/1.55 'DejaVu Sans',system-ui,"
    "'Segoe UI',Roboto,sans-serif}\n"
    "main{max-width:62rem;margin:0 auto;padding:2.5rem 3rem 4rem;background:#fff;"
    "box-shadow:0 0 24px rgba(29,39,51,.08)}\n"
    "header .kicker{margin:0;color:var(--blue);font-weight:700;font-size:.85rem;"
    "letter-spacing:.06em;text-transform:uppercase}\n"
    "h1{margin:.2rem 0 .3rem;font-size:2.1rem;line-height:1.2}\n"
    ".subtitle{margin:0 0 1.2rem;color:var(--grey);font-size:.9rem}\n"
    "nav{position:sticky;top:0;z-index:1;margin:0 -3rem;padding:.5rem 3rem;background:#fff;"
    "border-bottom:1px solid var(--rule);font-size:.88rem}\n"
    "nav a{display:inline-block;margin-right:1.2rem;color:var(--blue);text-decoration:none}\n"
    "nav a:hover{text-decoration:underline}\n"
    "h2{margin:2.6rem 0 .6rem;padding-top:.6rem;font-size:1.5rem;line-height:1.25;"
    "scroll-margin-top:3rem}\n"
    "h3{margin:1.6rem 0 .4rem;font-size:1.08rem;scroll-margin-top:3rem}\n"
    "p{margin:.4rem 0 .8rem;max-width:52rem;overflow-wrap:anywhere}\n"
    "ul{margin:.4rem 0 .8rem;padding-left:1.2rem}\n"
    "li{margin:.15rem 0}\n"
    ".notice{margin:.8rem 0;padding:.7rem 1rem;max-width:none;border-left:4px solid var(--grey);"
    "background:#f1f3f5}\n"
    ".notice.good{border-color:var(--green);background:#edf5f1}\n"
    ".notice.warning{border-color:var(--red);background:#fbeeed}\n"
    ".notice.origin{border-color:var(--blue);background:#eaf4fa}\n"
    "li.warning,td.warning{color:var(--red)}\n"
    "li.good,td.good{color:var(--green)}\n"
    "td.origin{color:var(--blue)}\n"
    "li.quiet,td.quiet{color:var(--grey)}\n"
    ".table{overflow-x:auto;margin:.8rem 0 1.2rem}\n"
    "table{border-collapse:collapse;width:100%;font-size:.88rem;"
    "font-variant-numeric:tabular-nums}\n"
    ".caption{margin:-.8rem 0 1.2rem;max-width:none;color:var(--grey);font-size:.84rem}\n"
    "th{padding:.3rem .6rem;border-bottom:2px solid var(--grey);color:var(--grey);"
    "text-align:left;vertical-align:bottom;font-weight:700}\n"
    "td{padding:.22rem .6rem;vertical-align:top}\n"
    "tr.group td{border-top:1px solid var(--rule)}\n"
    "tbody tr:last-child td{border-bottom:1px solid var(--grey)}\n"
    ".right{text-align:right}\n"
    "td.whole{white-space:nowrap}\n"
    "td.mono{font-family:'DejaVu Sans Mono',ui-monospace,monospace;font-size:.82rem;"
    "word-break:break-all}\n"
    "pre{margin:.8rem 0;padding:.7rem 1rem;overflow-x:auto;border-left:4px solid var(--grey);"
    "background:#f1f3f5;font:.85rem/1.5 'DejaVu Sans Mono',ui-monospace,monospace}\n"
    ".figures{display:grid;gap:1.2rem 1.6rem;margin:1.2rem 0}\n"
    ".figures.two{grid-template-columns:1fr 1fr}\n"
    "figure{margin:0}\n"
    "figure svg{display:block;width:100%;height:auto}\n"
    "figcaption{margin-top:.3rem;color:var(--grey);font-size:.84rem;line-height:1.45}\n"
    "footer{margin-top:3rem;padding-top:.8rem;border-top:1px solid var(--rule);"
    "color:var(--grey);font-size:.84rem}\n"
    "@media (max-width:46rem){main{padding:1.2rem}nav{margin:0 -1.2rem;padding:.5rem 1.2rem}"
    ".figures.two{grid-template-columns:1fr}}\n"
    "@media print{body{background:#fff;font-size:10pt}main{max-width:none;padding:0;"
    "box-shadow:none}nav{display:none}figure,tr,.notice{break-inside:avoid}"
    "h2,h3{break-after:avoid}h2{break-before:page}"
    "nav+h2{break-before:auto}}\n";

static const char *tone_class(enum wb_document_tone tone)
{
    static const char *const names[] = {"", "good", "warning", "origin", "quiet"};
    return names[tone];
}

static void put_table(struct wb_text *html, const struct wb_document_table *table)
{
    wb_text_append(html, "<div class=\"table\"><table>\n");
    wb_text_append(html, "<thead><tr>");
    bool any = false;
    for (int i = 0; i < table->n_columns; i++)
        any |= table->columns[i].heading[0] != '\0';
    for (int i = 0; any && i < table->n_columns; i++)
        wb_text_append(html, "<th%s>%s</th>", table->columns[i].right ? " class=\"right\"" : "",
                       table->columns[i].heading);
    wb_text_append(html, "</tr></thead>\n<tbody>\n");
    for (int row = 0; row < table->n_rows; row++) {
        wb_text_append(html, "<tr%s>",
                       row > 0 && table->begins_group[row] ? " class=\"group\"" : "");
        for (int i = 0; i < table->n_columns; i++) {
            const struct wb_document_cell *const cell = &table->cells[row * table->n_columns + i];
            wb_text_append(
                html, "<td class=\"%s%s%s%s\">%s</td>", table->columns[i].right ? "right " : "",
                table->columns[i].wraps ? "" : "whole ", table->columns[i].monospace ? "mono " : "",
                tone_class(cell->tone), cell->text);
        }
        wb_text_append(html, "</tr>\n");
    }
    wb_text_append(html, "</tbody></table></div>\n");
    /* Not a <caption>: that would be as wide as a table that scrolls. */
    if (table->caption)
        wb_text_append(html, "<p class=\"caption\">%s</p>\n", table->caption);
}

/* The SVG element alone, without the XML declaration that only a file may have. */
static enum wb_status put_svg(struct wb_text *html, const struct wb_figure *figure)
{
    struct wb_text svg = {0};
    const enum wb_status status = wb_figure_svg(figure, &svg);
    if (status == WB_OK) {
        const char *const start = strstr(wb_text_string(&svg), "<svg");
        if (start)
            wb_text_append(html, "<svg role=\"img\" aria-label=\"%s\"%s", wb_figure_name(figure),
                           start + strlen("<svg"));
    }
    wb_text_release(&svg);
    return status;
}

static enum wb_status put_figures(struct wb_text *html, const struct wb_document_block *block)
{
    wb_text_append(html, "<div class=\"figures%s\">\n", block->figures[1] ? " two" : "");
    for (int i = 0; i < 2 && block->figures[i]; i++) {
        wb_text_append(html, "<figure id=\"figure-%s\">\n", wb_figure_name(block->figures[i]));
        WB_TRY(put_svg(html, block->figures[i]));
        wb_text_append(html, "<figcaption>%s</figcaption>\n</figure>\n", block->captions[i]);
    }
    wb_text_append(html, "</div>\n");
    return WB_OK;
}

static void put_heading(struct wb_text *html, const struct wb_document_block *block)
{
    wb_text_append(html, "<h%d", block->level + 1);
    if (block->anchor[0])
        wb_text_append(html, " id=\"%s\"", block->anchor);
    wb_text_append(html, ">");
    wb_text_append_escaped(html, block->text);
    wb_text_append(html, "</h%d>\n", block->level + 1);
}

static void put_navigation(struct wb_text *html, const struct wb_document *document)
{
    wb_text_append(html, "<nav>");
    for (int i = 0; i < document->n; i++) {
        const struct wb_document_block *const block = &document->blocks[i];
        if (block->kind != WB_BLOCK_HEADING || block->level != 1)
            continue;
        wb_text_append(html, "<a href=\"#%s\">", block->anchor);
        wb_text_append_escaped(html, block->text);
        wb_text_append(html, "</a>");
    }
    wb_text_append(html, "</nav>\n");
}

static enum wb_status put_block(struct wb_text *html, const struct wb_document_block *block)
{
    switch (block->kind) {
    case WB_BLOCK_HEADING:
        put_heading(html, block);
        break;
    case WB_BLOCK_PARAGRAPH:
        wb_text_append(html, "<p>%s</p>\n", block->text);
        break;
    case WB_BLOCK_NOTICE:
        wb_text_append(html, "<p class=\"notice %s\">%s</p>\n", tone_class(block->tone),
                       block->text);
        break;
    case WB_BLOCK_ITEM:
        wb_text_append(html, "<li class=\"%s\">%s</li>\n", tone_class(block->tone), block->text);
        break;
    case WB_BLOCK_CODE:
        wb_text_append(html, "<pre>");
        wb_text_append_escaped(html, block->text);
        wb_text_append(html, "</pre>\n");
        break;
    case WB_BLOCK_TABLE:
        put_table(html, block->table);
        break;
    case WB_BLOCK_FIGURES:
        return put_figures(html, block);
    case WB_BLOCK_NEW_PAGE:
    case WB_BLOCK_ROOM:
        break;
    }
    return WB_OK;
}

static void put_number(struct wb_text *html, const struct wb_document *document)
{
    if (!document->number)
        return;
    wb_text_append(html, "Report ");
    wb_text_append_escaped(html, document->number);
    wb_text_append(html, " \xc2\xb7 ");
}

static void put_head(struct wb_text *html, const struct wb_document *document)
{
    wb_text_append(html, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                         "<meta name=\"viewport\" content=\"width=device-width, "
                         "initial-scale=1\">\n<title>");
    wb_text_append_escaped(html, document->title);
    wb_text_append(html, "</title>\n<meta name=\"generator\" content=\"");
    wb_text_append_escaped(html, document->footer);
    wb_text_append(html, "\">\n<style>\n%s</style>\n</head>\n<body>\n<main>\n<header>\n", style);
    wb_text_append(html, "<p class=\"kicker\">");
    wb_text_append_escaped(html, document->kind);
    wb_text_append(html, "</p>\n<h1>");
    wb_text_append_escaped(html, document->title);
    wb_text_append(html, "</h1>\n<p class=\"subtitle\">");
    put_number(html, document);
    wb_text_append_escaped(html, document->subtitle);
    wb_text_append(html, "</p>\n</header>\n");
}

enum wb_status wb_html_render(const struct wb_document *document, struct wb_text *html)
{
    put_head(html, document);
    put_navigation(html, document);
    bool in_list = false;
    for (int i = 0; i < document->n; i++) {
        const struct wb_document_block *const block = &document->blocks[i];
        if ((block->kind == WB_BLOCK_ITEM) != in_list)
            wb_text_append(html, in_list ? "</ul>\n" : "<ul>\n");
        in_list = block->kind == WB_BLOCK_ITEM;
        WB_TRY(put_block(html, block));
    }
    if (in_list)
        wb_text_append(html, "</ul>\n");
    wb_text_append(html, "<footer>");
    put_number(html, document);
    wb_text_append_escaped(html, document->footer);
    wb_text_append(html, "</footer>\n</main>\n</body>\n</html>\n");
    return WB_OK;
}
