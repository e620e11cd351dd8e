#include "analysis/report/laboratory.h"

#include <stddef.h>
#include <string.h>

#include "analysis/keys/row.h"
#include "analysis/report/pages.h"
#include "base/text.h"

static const char standard[] = "ISO/IEC 17025:2017";

struct field {
    const char *key, *name;
    size_t offset, size; /* of its text in struct wb_laboratory */
    const char *clause;  /* of the standard */
    bool is_date, is_optional;
};

#define ROW(member, title, ...)                                                                    \
    {                                                                                              \
        .key = #member, .name = title, .offset = offsetof(struct wb_laboratory, member),           \
        .size = sizeof(((struct wb_laboratory *)NULL)->member), __VA_ARGS__                        \
    }

/* In the order of the page. */
static const struct field fields[] = {
    ROW(report, "Report number", .clause = "7.8.2.1 d"),
    ROW(name, "Laboratory", .clause = "7.8.2.1 b"),
    ROW(address, "Address", .clause = "7.8.2.1 b"),
    ROW(place, "Place of the tests", .clause = "7.8.2.1 c"),
    ROW(customer, "Customer", .clause = "7.8.2.1 e"),
    ROW(item, "Items tested", .clause = "7.8.2.1 g"),
    ROW(item_state, "Their state", .clause = "7.8.2.1 g"),
    ROW(received, "Received", .clause = "7.8.2.1 h", .is_date = true),
    ROW(tested_from, "First day of the tests", .clause = "7.8.2.1 i", .is_date = true),
    ROW(tested_until, "Last day of the tests", .clause = "7.8.2.1 i", .is_date = true),
    ROW(issued, "Issued", .clause = "7.8.2.1 j", .is_date = true),
    ROW(method, "Method", .clause = "7.8.2.1 f"),
    ROW(deviations, "Deviations from the method", .clause = "7.8.2.1 n"),
    ROW(sampling, "Sampling", .clause = "7.8.2.1 k", .is_optional = true),
    ROW(external, "From external providers", .clause = "7.8.2.1 p", .is_optional = true),
    ROW(environment, "Environment", .clause = "7.8.3.1 a"),
    ROW(authorised_by, "Authorised by", .clause = "7.8.2.1 o"),
};

static const char *text_of(const struct wb_laboratory *laboratory, const struct field *field)
{
    return (const char *)laboratory + field->offset;
}

static bool is_missing(const struct wb_laboratory *laboratory, const struct field *field)
{
    return !field->is_optional && text_of(laboratory, field)[0] == '\0';
}

int wb_laboratory_missing(const struct wb_laboratory *laboratory)
{
    int n = 0;
    for (size_t i = 0; laboratory->is_given && i < WB_COUNT(fields); i++)
        n += is_missing(laboratory, &fields[i]);
    return n;
}

/* --- reading --- */

/* Dates as YYYY-MM-DD sort as texts; each that is given comes no earlier than those before it. */
static enum wb_status check_dates(const struct wb_config_node *node,
                                  const struct wb_laboratory *laboratory)
{
    const struct field *before = NULL;
    for (size_t i = 0; i < WB_COUNT(fields); i++) {
        const char *const date = text_of(laboratory, &fields[i]);
        if (!fields[i].is_date || !date[0])
            continue;
        WB_TRY(wb_config_check_date(node, fields[i].key, date));
        if (before && strcmp(date, text_of(laboratory, before)) < 0)
            return wb_config_refuse(node, fields[i].key, "%s lies before %s, %s", date, before->key,
                                    text_of(laboratory, before));
        before = &fields[i];
    }
    return WB_OK;
}

static enum wb_status read_amends(const struct wb_config_node *node,
                                  struct wb_laboratory *laboratory)
{
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("report", laboratory->amends.report),
        WB_CONFIG_TEXT("issued", laboratory->amends.issued),
        WB_CONFIG_TEXT("why", laboratory->amends.why),
    };
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    WB_TRY(wb_config_check_date(node, "issued", laboratory->amends.issued));
    if (!laboratory->amends.report[0] || !laboratory->amends.why[0])
        return wb_config_refuse(node, laboratory->amends.report[0] ? "why" : "report",
                                "expected which report is replaced, and why");
    if (strcmp(laboratory->amends.report, laboratory->report) == 0)
        return wb_config_refuse(node, "report",
                                "'%s' is this report's own number: an amendment gets a new one",
                                laboratory->report);
    return WB_OK;
}

enum wb_status wb_laboratory_read(const struct wb_config_node *node, bool has_uncertainties,
                                  struct wb_laboratory *laboratory)
{
    struct wb_config_key keys[WB_COUNT(fields) + 2];
    const struct wb_config_node *amends = NULL;
    int rule = WB_RULE_SIMPLE;
    size_t n = 0;
    if (!node)
        return WB_OK;
    for (; n < WB_COUNT(fields); n++)
        keys[n] = (struct wb_config_key){.name = fields[n].key,
                                         .type = WB_CONFIG_TYPE_TEXT,
                                         .optional = fields[n].offset !=
                                                     offsetof(struct wb_laboratory, report),
                                         .target = (char *)laboratory + fields[n].offset,
                                         .size = fields[n].size};
    keys[n++] =
        (struct wb_config_key)WB_CONFIG_OPTIONAL_CHOICE("decision_rule", &rule, wb_verdict_rules);
    keys[n++] = (struct wb_config_key)WB_CONFIG_OPTIONAL_NODE("amends", &amends);
    WB_TRY(wb_config_map(node, keys, n));
    if (!laboratory->report[0])
        return wb_config_refuse(node, "report", "expected the number of the report");
    laboratory->rule = (enum wb_verdict_rule)rule;
    laboratory->is_given = true;
    if (laboratory->rule == WB_RULE_GUARDED && !has_uncertainties)
        return wb_config_refuse(node, "decision_rule",
                                "'guarded' needs uncertainties, which reports of this kind do not "
                                "evaluate; 'simple' does not");
    WB_TRY(check_dates(node, laboratory));
    return amends ? read_amends(amends, laboratory) : WB_OK;
}

/* --- pages --- */

static void put_amendment(struct wb_document *document, const struct wb_laboratory *laboratory)
{
    struct wb_text text = {0};
    if (!laboratory->amends.report[0])
        return;
    wb_text_append(&text, "<b>Amendment.</b> This report replaces report ");
    wb_text_append_escaped(&text, laboratory->amends.report);
    wb_text_append(&text, " of %s, which is no longer valid. What changed and why: ",
                   laboratory->amends.issued);
    wb_text_append_escaped(&text, laboratory->amends.why);
    wb_pages_put_text(document, WB_BLOCK_NOTICE, WB_TONE_WARNING, &text);
}

static void put_missing(struct wb_document *document, const struct wb_laboratory *laboratory)
{
    struct wb_text text = {0};
    const int n = wb_laboratory_missing(laboratory);
    if (n == 0)
        return;
    wb_text_append(&text,
                   "<b>Not a whole report of %s, clause 7.8.2.</b> %d of its fields %s missing in "
                   "the campaign file:",
                   standard, n, wb_pages_plural(n, "is", "are"));
    wb_pages_put_text(document, WB_BLOCK_NOTICE, WB_TONE_WARNING, &text);
    for (size_t i = 0; i < WB_COUNT(fields); i++) {
        if (!is_missing(laboratory, &fields[i]))
            continue;
        wb_text_append(&text, "<b>%s</b> (<tt>%s</tt>, clause %s)", fields[i].name, fields[i].key,
                       fields[i].clause);
        wb_pages_put_text(document, WB_BLOCK_ITEM, WB_TONE_WARNING, &text);
    }
}

static void put_row(struct wb_document_table *table, const char *name, enum wb_document_tone tone,
                    const char *plain)
{
    struct wb_text text = {0};
    wb_text_append_escaped(&text, plain);
    wb_document_row(table, true);
    wb_pages_cell(table, WB_TONE_QUIET, "%s", name);
    wb_document_cell(table, tone, wb_text_string(&text));
    wb_text_release(&text);
}

static void put_fields(struct wb_document *document, const struct wb_laboratory *laboratory)
{
    static const struct wb_document_column columns[] = {{.heading = ""},
                                                        {.heading = "", .wraps = true}};
    struct wb_document_table *const table = wb_document_table(
        document,
        "The results relate only to the items tested. The report is reproduced in full, or with "
        "the laboratory's written approval.",
        2, columns);
    for (size_t i = 0; i < WB_COUNT(fields); i++) {
        if (text_of(laboratory, &fields[i])[0])
            put_row(table, fields[i].name, WB_TONE_PLAIN, text_of(laboratory, &fields[i]));
        else if (!fields[i].is_optional)
            put_row(table, fields[i].name, WB_TONE_WARNING, "missing");
    }
    put_row(table, "Decision rule", WB_TONE_PLAIN, wb_verdict_rule_text(laboratory->rule));
}

void wb_laboratory_put_pages(struct wb_document *document, const struct wb_laboratory *laboratory)
{
    struct wb_text end = {0};
    const int n = document->n;
    if (!laboratory->is_given) {
        wb_document_paragraph(document,
                              "This is not a test report in the sense of ISO/IEC 17025: the "
                              "campaign file has no <tt>laboratory</tt>.");
        return;
    }
    wb_document_set_number(document, laboratory->report);
    put_amendment(document, laboratory);
    put_missing(document, laboratory);
    wb_document_heading(document, 1, "report", "Report and laboratory");
    put_fields(document, laboratory);
    wb_document_new_page(document);
    wb_document_move_to_front(document, n);
    wb_text_append(&end, "<b>End of report ");
    wb_text_append_escaped(&end, laboratory->report);
    wb_text_append(&end, ".</b>");
    wb_pages_put_text(document, WB_BLOCK_PARAGRAPH, WB_TONE_PLAIN, &end);
}

/* --- numbers --- */

#define LABORATORY(member) WB_AT(struct wb_laboratory, member)

static const struct wb_key amends_rows[] = {
    {"report", LABORATORY(amends.report), "number of the report that this one replaces"},
    {"issued", LABORATORY(amends.issued), "date of that report"},
    {"why", LABORATORY(amends.why), "what changed"},
};
static WB_KEYS(amends, "amends", "The report that this one replaces.");

static const struct wb_key wb_laboratory_rows[] = {
    {"report", LABORATORY(report) | IF_KNOWN, "number of the report"},
    {"name", LABORATORY(name) | IF_KNOWN, "name of the laboratory"},
    {"address", LABORATORY(address) | IF_KNOWN, "address of the laboratory"},
    {"place", LABORATORY(place) | IF_KNOWN, "place of the tests"},
    {"customer", LABORATORY(customer) | IF_KNOWN, "customer, with contact"},
    {"item", LABORATORY(item) | IF_KNOWN, "items that were tested"},
    {"item_state", LABORATORY(item_state) | IF_KNOWN, "condition of the items"},
    {"received", LABORATORY(received) | IF_KNOWN, "date on which the items were received"},
    {"tested_from", LABORATORY(tested_from) | IF_KNOWN, "first day of the tests"},
    {"tested_until", LABORATORY(tested_until) | IF_KNOWN, "last day of the tests"},
    {"issued", LABORATORY(issued) | IF_KNOWN, "date of the report"},
    {"method", LABORATORY(method) | IF_KNOWN, "method"},
    {"deviations", LABORATORY(deviations) | IF_KNOWN, "deviations from the method"},
    {"sampling", LABORATORY(sampling) | IF_KNOWN, "how the items were sampled"},
    {"external", LABORATORY(external) | IF_KNOWN, "results from external providers"},
    {"environment", LABORATORY(environment) | IF_KNOWN, "environmental conditions"},
    {"authorised_by", LABORATORY(authorised_by) | IF_KNOWN, "who authorises the report"},
    {"decision_rule", WB_CHOICE(struct wb_laboratory, rule), "rule by which limits are judged",
     .choices = "simple|guarded"},
    {"amends", OBJECT | OPTIONAL, "report that this one replaces", &amends_keys},
    {"missing", TEXT | LIST, "required fields that the campaign file lacks"},
};
WB_KEYS(wb_laboratory, "laboratory", "The fields of a laboratory, as the campaign file has them.");

void wb_laboratory_put_numbers(struct wb_json *root, const struct wb_laboratory *laboratory)
{
    if (!laboratory->is_given)
        return;
    struct wb_json *const of = wb_json_set_object(root, "laboratory");
    WB_PUT(of, &wb_laboratory_keys, struct wb_laboratory, laboratory);
    if (laboratory->amends.report[0])
        WB_PUT(wb_json_set_object(of, "amends"), &amends_keys, struct wb_laboratory, laboratory);
    struct wb_json *const missing = wb_json_set_array(of, "missing");
    for (size_t i = 0; i < WB_COUNT(fields); i++) {
        if (is_missing(laboratory, &fields[i]))
            wb_json_append_text(missing, fields[i].key);
    }
}
