#include "analysis/report/glossary.h"

#include <string.h>

#include "base/config.h"

#define SIGMA "<i>\xcf\x83</i>"
#define NMM2 "N mm\xc2\xb2"

struct entry {
    struct {
        const char *term, *symbol, *unit;
    } head; /* markup, as the meaning */
    const char *meaning;
    /* One of them occurs where a report uses the term: words in capitals or not, or a symbol. */
    const char *words[4];
};

static const struct entry entries[] = {
    {{"Deflection", "<i>\xce\xb4</i>", "mm"},
     "Displacement of the loaded point across the wire: of the tip relative to the clamp, or of "
     "the nose of a testing machine from its first contact.",
     {"deflection"}},
    {{"Force", "<i>F</i>", "mN, N"},
     "Force on the loaded point across the wire; <i>F</i><sub>max</sub> is the largest one of the "
     "curve.",
     {"force", "<i>F</i>"}},
    {{"Strand tension", "<i>T</i>", "mN"},
     "Force along the strand that holds the tip.",
     {"strand tension", "tension of the strand", "shapes and tension"}},
    {{"Curvature", "<i>\xce\xba</i>", "1/m"},
     "Change of the wire's direction over its length, the reciprocal of the bending radius.",
     {"curvature"}},
    {{"Bending moment", "<i>M</i>", "N mm"},
     "Moment that the wire's section carries at a curvature.",
     {"bending moment", "moment over curvature", "<i>M</i>", "M (N mm)"}},
    {{"Flexural rigidity", "<i>EI</i>", NMM2},
     "Slope of the moment over the curvature of a straight, elastic wire: Young's modulus times "
     "second moment of area.",
     {"rigidity", "<i>EI</i>", "ln EI"}},
    {{"Secant stiffness", "<i>M</i>/<i>\xce\xba</i>", NMM2},
     "Moment over curvature on the first loading, from straight to the stated curvature.",
     {"secant"}},
    {{"Tangent stiffness", "d<i>M</i>/d<i>\xce\xba</i>", NMM2},
     "Slope of the moment over the curvature at a curvature.",
     {"tangent stiffness"}},
    {{"Unloading stiffness", "", NMM2},
     "Change of the moment over the change of the curvature, over the stated change (1 /m where "
     "none is stated) from the largest curvature back.",
     {"unloading stiffness"}},
    {{"Residual curvature ratio", "<i>\xce\xba</i><sub>res</sub>/<i>\xce\xba</i><sub>max</sub>",
      "1"},
     "Curvature that remains at zero moment, over the largest curvature that the wire was bent to.",
     {"residual curvature ratio"}},
    {{"Residual deflection", "<i>\xce\xb4</i><sub>res</sub>", "mm"},
     "Deflection during unloading where the force is that at zero deflection again.",
     {"residual deflection"}},
    {{"Springback of the deflection",
      "1 \xe2\x88\x92 <i>\xce\xb4</i><sub>res</sub>/<i>\xce\xb4</i><sub>max</sub>", "1"},
     "Part of the largest deflection that the specimen recovers at zero force.",
     {"springback of the deflection"}},
    {{"Young's modulus", "<i>E</i>", "MPa"},
     "Stress over strain before yielding, of the wire as a homogeneous cylinder unless a part is "
     "named.",
     {"Young's modulus", "<i>E</i>"}},
    {{"Yield stress", SIGMA "<sub>Y</sub>", "MPa"},
     "Stress at which plastic strain begins.",
     {"yield stress", SIGMA "<sub>Y</sub>"}},
    {{"Strength coefficient, hardening exponent", "<i>K</i>, <i>n</i>", "MPa, 1"},
     "Of Ludwik's law: stress = " SIGMA
     "<sub>Y</sub> + <i>K</i> (plastic strain)<sup><i>n</i></sup>.",
     {"strength coefficient", "hardening exponent", "<i>K</i>"}},
    {{"Hardening rule", "", ""},
     "What plastic strain does to the yield surface. Isotropic: it grows. Kinematic: it moves. "
     "Combined: both.",
     {"hardening rule", "isotropic", "kinematic"}},
    {{"Back stress", "<i>X</i>", "MPa"},
     "Stress at the centre of a yield surface that moves with the plastic strain.",
     {"back stress", "backstress"}},
    {{"RMS (eq. 19)", "", "1, %"},
     "Root mean square, over the deflections, of the difference of two force curves, over the "
     "largest force of the measured or published curve.",
     {"RMS"}},
    {{"Expanded uncertainty", "<i>U</i>, <i>k</i>", "as the value"},
     "Half-width of an interval of 95 %: the standard uncertainty times the coverage factor "
     "<i>k</i>.",
     {"<i>U</i>", "expanded uncertainty", "Factor for 95 %"}},
    {{"Interval, band", "", "as the value"},
     "Range that contains the true value, or of a band the value of a further specimen, with the "
     "stated probability, as far as the stated contributions to the uncertainty are complete.",
     {"interval", "band of 90 %", "95 %"}},
};

static bool text_has(const char *text, const struct entry *entry)
{
    for (size_t i = 0; text && i < WB_COUNT(entry->words) && entry->words[i]; i++) {
        const char *const word = entry->words[i];
        if (word[0] == '<' ? strstr(text, word) : strcasestr(text, word))
            return true;
    }
    return false;
}

static bool table_has(const struct wb_document_table *table, const struct entry *entry)
{
    bool has = table && text_has(table->caption, entry);
    for (int i = 0; table && i < table->n_columns && !has; i++)
        has = text_has(table->columns[i].heading, entry);
    for (int i = 0; table && i < table->n_rows * table->n_columns && !has; i++)
        has = text_has(table->cells[i].text, entry);
    return has;
}

static bool is_used(const struct wb_document *document, int n, const struct entry *entry)
{
    for (int i = 0; i < n; i++) {
        const struct wb_document_block *const block = &document->blocks[i];
        if (block->kind != WB_BLOCK_CODE &&
            (text_has(block->text, entry) || text_has(block->captions[0], entry) ||
             text_has(block->captions[1], entry) || table_has(block->table, entry)))
            return true;
    }
    return false;
}

void wb_glossary_put(struct wb_document *document)
{
    static const struct wb_document_column columns[] = {
        {.heading = "Term", .wraps = true},
        {.heading = "Symbol"},
        {.heading = "Unit"},
        {.heading = "Meaning", .wraps = true},
    };
    const int n = document->n;
    struct wb_document_table *table = NULL;
    for (size_t i = 0; i < WB_COUNT(entries); i++) {
        if (!is_used(document, n, &entries[i]))
            continue;
        if (!table) {
            wb_document_heading(document, 1, "glossary", "Terms");
            table = wb_document_table(document, NULL, WB_COUNT(columns), columns);
        }
        wb_document_row(table, false);
        wb_document_cell(table, WB_TONE_PLAIN, entries[i].head.term);
        wb_document_cell(table, WB_TONE_PLAIN, entries[i].head.symbol);
        wb_document_cell(table, WB_TONE_QUIET, entries[i].head.unit);
        wb_document_cell(table, WB_TONE_PLAIN, entries[i].meaning);
    }
}
