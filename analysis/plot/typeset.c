#include "analysis/plot/typeset.h"

#include <stdio.h>
#include <string.h>

#include <fontconfig/fontconfig.h>
#include <pango/pangocairo.h>

static PangoLayout *layout_of(cairo_t *cairo, const char *markup,
                              const struct wb_typeset_style *style)
{
    PangoLayout *const layout = pango_cairo_create_layout(cairo);
    PangoContext *const context = pango_layout_get_context(layout);
    /* Under a scaled or turned matrix Pango 1.50 makes subscripts larger by the scale; cairo
     * applies the matrix when it draws in any case. */
    pango_context_set_matrix(context, NULL);
    cairo_font_options_t *const options = cairo_font_options_create();
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    pango_cairo_context_set_font_options(context, options);
    cairo_font_options_destroy(options);
    pango_cairo_context_set_resolution(context, 72.0);
    pango_context_set_language(context, pango_language_from_string("en"));
    pango_context_set_round_glyph_positions(context, FALSE);

    PangoFontDescription *const font = pango_font_description_new();
    pango_font_description_set_family_static(font,
                                             style->monospace ? "DejaVu Sans Mono" : "DejaVu Sans");
    /* At 72 dots an inch a point is a unit. (An absolute size would not reach subscripts.) */
    pango_font_description_set_size(font, (int)(style->size * PANGO_SCALE + 0.5));
    if (style->bold)
        pango_font_description_set_weight(font, PANGO_WEIGHT_BOLD);
    pango_layout_set_font_description(layout, font);
    pango_font_description_free(font);

    if (pango_parse_markup(markup, -1, 0, NULL, NULL, NULL, NULL))
        pango_layout_set_markup(layout, markup, -1);
    else
        pango_layout_set_text(layout, markup, -1);
    /* A checksum or a path that is broken must not get hyphens. */
    PangoAttrList *const given = pango_layout_get_attributes(layout);
    PangoAttrList *const attributes = given ? pango_attr_list_ref(given) : pango_attr_list_new();
    pango_attr_list_insert(attributes, pango_attr_insert_hyphens_new(FALSE));
    pango_layout_set_attributes(layout, attributes);
    pango_attr_list_unref(attributes);
    if (style->width > 0.0) {
        pango_layout_set_width(layout, (int)(style->width * PANGO_SCALE));
        pango_layout_set_wrap(layout, PANGO_WRAP_WORD_CHAR);
        const PangoAlignment alignments[] = {PANGO_ALIGN_LEFT, PANGO_ALIGN_CENTER,
                                             PANGO_ALIGN_RIGHT};
        pango_layout_set_alignment(layout, alignments[style->align]);
    }
    const double spacing = style->line_spacing > 0.0 ? style->line_spacing
                           : style->width > 0.0      ? 1.25
                                                     : 1.0;
    pango_layout_set_line_spacing(layout, (float)spacing);
    return layout;
}

static struct wb_typeset_size size_of(PangoLayout *layout, const struct wb_typeset_style *style)
{
    int width, height;
    pango_layout_get_size(layout, &width, &height);
    return (struct wb_typeset_size){style->width > 0.0 ? style->width : (double)width / PANGO_SCALE,
                                    (double)height / PANGO_SCALE};
}

struct wb_typeset_size wb_typeset_measure(cairo_t *cairo, const char *markup,
                                          const struct wb_typeset_style *style)
{
    PangoLayout *const layout = layout_of(cairo, markup, style);
    const struct wb_typeset_size size = size_of(layout, style);
    g_object_unref(layout);
    return size;
}

void wb_typeset_set_colour(cairo_t *cairo, struct wb_colour colour)
{
    cairo_set_source_rgba(cairo, colour.red, colour.green, colour.blue, colour.alpha);
}

struct wb_typeset_size wb_typeset_draw(cairo_t *cairo, double x, double y, const char *markup,
                                       const struct wb_typeset_style *style)
{
    PangoLayout *const layout = layout_of(cairo, markup, style);
    const struct wb_typeset_size size = size_of(layout, style);
    if (!(style->width > 0.0) && style->align == WB_ALIGN_CENTRE)
        x -= 0.5 * size.width;
    if (!(style->width > 0.0) && style->align == WB_ALIGN_RIGHT)
        x -= size.width;
    cairo_save(cairo);
    wb_typeset_set_colour(cairo, style->colour);
    cairo_move_to(cairo, x, y);
    pango_cairo_show_layout(cairo, layout);
    cairo_restore(cairo);
    g_object_unref(layout);
    return size;
}

int wb_typeset_font_files(char path[WB_TYPESET_FONTS][4096])
{
    static const char *const names[WB_TYPESET_FONTS] = {"DejaVu Sans", "DejaVu Sans:bold",
                                                        "DejaVu Sans Mono"};
    int n = 0;
    for (int i = 0; i < WB_TYPESET_FONTS; i++) {
        FcPattern *const pattern = FcNameParse((const FcChar8 *)names[i]);
        FcResult result;
        FcChar8 *file = NULL;
        FcConfigSubstitute(NULL, pattern, FcMatchPattern);
        FcDefaultSubstitute(pattern);
        FcPattern *const match = FcFontMatch(NULL, pattern, &result);
        if (match && FcPatternGetString(match, FC_FILE, 0, &file) == FcResultMatch)
            snprintf(path[n++], 4096, "%s", (const char *)file);
        if (match)
            FcPatternDestroy(match);
        FcPatternDestroy(pattern);
    }
    return n;
}
