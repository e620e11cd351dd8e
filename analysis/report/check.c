#include "analysis/report/check.h"

#include <errno.h>
#include <ftw.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/report/manifest.h"
#include "analysis/report/openpgp.h"
#include "analysis/report/report.h"

#define WB_LOG_DOMAIN "check"

/* Numbers of another build agree within the first; a search, and the iterations of a harness, end
 * where the rounding of their build leads them, so that what is fitted or iterated, and follows
 * from it, is held to the second. */
static const double tolerance = 1e-9, fitted_tolerance = 1e-5;

/* The members of report.json with fitted or iterated numbers, and the one with the program that
 * made it. */
static const char *const program[] = {"tool", NULL};
static const char *const program_and_fitted[] = {"tool",    "wires",   "fit",   "bundles",
                                                 "harness", "elastic", "found", NULL};

/* One report in two folders: as it was signed, and as it comes out now. */
struct pair {
    const struct wb_check_order *order;
    struct wb_json *signed_manifest, *manifest; /* owned */
    char again[WB_PATH];                        /* "": not computed */
};

static const char *text_of(const struct wb_json *entry, const char *key)
{
    const char *text = "";
    wb_json_get_text(entry, key, &text);
    return text;
}

/* --- signature and files --- */

static enum wb_status check_signature(const struct wb_check_order *order)
{
    char path[WB_PATH], signature[WB_PATH];
    struct wb_openpgp_signer signer;
    WB_TRY(wb_file_join(path, order->folder, wb_manifest_name));
    WB_TRY(wb_file_join(signature, order->folder, wb_manifest_signature_name));
    if (!wb_file_exists(path) || !wb_file_exists(signature))
        return wb_fail(WB_ERR_NOT_FOUND, "'%s' holds no signed report: there is no %s",
                       order->folder,
                       wb_file_exists(path) ? wb_manifest_signature_name : wb_manifest_name);
    WB_TRY(wb_openpgp_verify(path, signature, &signer));
    fprintf(order->out, "signature: good, by %s, key %s%s\n", signer.name, signer.fingerprint,
            signer.is_trusted
                ? ""
                : " (not certified by you: compare it with what the laboratory says)");
    return WB_OK;
}

static enum wb_status check_files(const struct pair *pair)
{
    int n = 0;
    WB_TRY(wb_manifest_check_files(pair->signed_manifest, pair->order->folder, &n));
    fprintf(pair->order->out, "files: %d as signed, report %s\n", n,
            text_of(pair->signed_manifest, "report"));
    return WB_OK;
}

/* --- computing again --- */

/* The campaign that was signed: the one given, or that of the manifest's name. "": not found. */
static enum wb_status find_campaign(const struct pair *pair, char path[WB_PATH])
{
    const struct wb_json *const campaign = wb_json_get(pair->signed_manifest, "campaign");
    const char *const name = text_of(campaign, "file"), *const given = pair->order->campaign;
    const char *const wanted = text_of(campaign, "sha256");
    char sha256[WB_SHA256_TEXT];
    path[0] = '\0';
    if (given || wb_file_exists(name))
        WB_TRY(wb_file_join(path, "", given ? given : name));
    else if (wb_file_find_data(path, name) != WB_OK)
        path[0] = '\0';
    if (!path[0]) {
        wb_warn("the campaign '%s' is not here, so nothing is computed again; name it: wirebench "
                "report CAMPAIGN.yaml --check %s",
                name, pair->order->folder);
        return WB_OK;
    }
    WB_TRY(wb_hash_file(path, sha256));
    return strcmp(sha256, wanted) == 0
               ? WB_OK
               : wb_fail(WB_ERR_DATA,
                         "'%s' is not the campaign that was signed: SHA-256 %s, signed %s", path,
                         sha256, wanted);
}

static enum wb_status compute(struct pair *pair, const struct wb_kind *const *kinds, size_t n_kinds,
                              const char *campaign, bool *is_done)
{
    const char *const temporary = getenv("TMPDIR");
    char path[WB_PATH];
    const struct wb_jobs_options none = {.dry_run = false};
    enum wb_report_end end = WB_REPORT_NOTHING;
    WB_TRY(wb_file_join(pair->again, temporary && *temporary ? temporary : "/tmp",
                        "wirebench-check-XXXXXX"));
    if (!mkdtemp(pair->again)) {
        pair->again[0] = '\0';
        return wb_fail(WB_ERR_IO, "cannot make a temporary folder: %s", strerror(errno));
    }
    const struct wb_report_order order = {.campaign = campaign,
                                          .folder = pair->again,
                                          .quiet = true,
                                          .has_manifest = true,
                                          .n_threads = pair->order->n_threads,
                                          .jobs = &none};
    WB_TRY(wb_report_make(&end, kinds, n_kinds, &order));
    *is_done = end != WB_REPORT_INTERRUPTED && end != WB_REPORT_NOTHING;
    if (!*is_done)
        return WB_OK;
    WB_TRY(wb_file_join(path, pair->again, wb_manifest_name));
    return wb_json_read(&pair->manifest, path);
}

/* How far an input stands in a list: not at all, with another sum, as it is. */
enum presence {
    ABSENT,
    CHANGED,
    SAME
};

static enum presence look_up(const struct wb_json *list, const struct wb_json *input)
{
    enum presence found = ABSENT;
    for (size_t i = 0; i < wb_json_length(list); i++) {
        const struct wb_json *const entry = wb_json_item(list, i);
        if (strcmp(text_of(entry, "name"), text_of(input, "name")) != 0)
            continue;
        if (strcmp(text_of(entry, "sha256"), text_of(input, "sha256")) == 0)
            return SAME;
        found = CHANGED;
    }
    return found;
}

/* Says of each input of `list` that stands so in the other one what is wrong with it; how many. */
static int complain(const struct wb_json *list, const struct wb_json *other, enum presence wrong,
                    const char *what)
{
    int n = 0;
    for (size_t i = 0; i < wb_json_length(list); i++) {
        const struct wb_json *const input = wb_json_item(list, i);
        if (look_up(other, input) != wrong)
            continue;
        wb_error("input '%s' %s", text_of(input, "name"), what);
        n++;
    }
    return n;
}

/* Both manifests list the same inputs, with the same sums. */
static enum wb_status check_inputs(const struct pair *pair)
{
    const struct wb_json *const was = wb_json_get(pair->signed_manifest, "inputs");
    const struct wb_json *const is = wb_json_get(pair->manifest, "inputs");
    const int n = complain(was, is, CHANGED, "is not what was signed") +
                  complain(was, is, ABSENT, "was signed, and is not here or not read") +
                  complain(is, was, ABSENT, "is read here, and was not signed");
    if (n > 0)
        return wb_fail(WB_ERR_DATA, "%d of the inputs of '%s' %s not as signed", n,
                       pair->order->folder, n == 1 ? "is" : "are");
    fprintf(pair->order->out, "inputs: %zu as signed\n", wb_json_length(was));
    return WB_OK;
}

/* The first difference of the builds, in words. */
static void describe_build(const struct wb_json_place *at, char text[600])
{
    static const char *const lists[] = {"libraries", "fonts"};
    snprintf(text, 600, "%s %.80s, here %.80s", at->place, at->a, at->b);
    for (size_t i = 0; i < WB_COUNT(lists); i++) {
        if (strncmp(at->place, lists[i], strlen(lists[i])) == 0)
            snprintf(text, 600, "other %s", lists[i]);
    }
}

static enum wb_status refuse(const struct wb_json_difference *found, double limit,
                             const char *build)
{
    char by[32] = "";
    if (isfinite(found->largest))
        snprintf(by, sizeof by, ", by %.2g of it", found->largest);
    return wb_fail(WB_ERR_DATA,
                   "made by another build (%s), and not the same within %g: %zu value%s of "
                   "report.json, most '%s', %s in it and %s here%s",
                   build, limit, found->n, found->n == 1 ? "" : "s", found->most.place,
                   found->most.a, found->most.b, by);
}

/* The numbers of both, and the result of their comparison. */
static enum wb_status compare_documents(const struct wb_json *was, const struct wb_json *is,
                                        const char *build, FILE *out)
{
    struct wb_json_difference found, too_large;
    const bool differs = wb_json_differs(was, is, tolerance, program, &found);
    if (wb_json_differs(was, is, tolerance, program_and_fitted, &too_large))
        return refuse(&too_large, tolerance, build);
    if (differs && !(found.largest <= fitted_tolerance)) {
        wb_json_differs(was, is, fitted_tolerance, program, &too_large);
        return refuse(&too_large, fitted_tolerance, build);
    }
    fprintf(out, "computed again: numbers within %g", tolerance);
    if (differs)
        fprintf(out, ", but %zu of fits within %g, most '%s', by %.2g of it", found.n,
                fitted_tolerance, found.most.place, found.largest);
    fprintf(out, "; made by another build: %s\n", build);
    return WB_OK;
}

/* Laws that the data exclude enter no result. Their search ends on a flat slope, where another
 * rounding leads it elsewhere: their numbers are not compared, only their names and order. */
static void forget_excluded_laws(struct wb_json *report)
{
    static const char *const numbers[] = {"misfit", "flexural_rigidity_N_mm2",
                                          "residual_curvature_ratio"};
    const struct wb_json *const wires = wb_json_get(report, "wires");
    for (size_t i = 0; i < wb_json_length(wires); i++) {
        const struct wb_json *const cycle = wb_json_get(wb_json_item(wires, i), "cycle");
        const struct wb_json *const ranked =
            wb_json_get(wb_json_get(cycle, "hardening_rule"), "ranked");
        for (size_t k = 0; k < wb_json_length(ranked); k++) {
            struct wb_json *const law = wb_json_item(ranked, k);
            bool counts = true;
            if (!wb_json_get_boolean(law, "counts", &counts) || counts)
                continue;
            for (size_t n = 0; n < sizeof numbers / sizeof numbers[0]; n++)
                wb_json_set_number(law, numbers[n], (double)NAN);
        }
    }
}

/* How many iterations the steps of a harness take follows their rounding, and enters no result. */
static void forget_counts(struct wb_json *report)
{
    static const char *const computed[] = {"harness", "elastic"};
    for (size_t i = 0; i < sizeof computed / sizeof computed[0]; i++) {
        const struct wb_json *const steps = wb_json_get(wb_json_get(report, computed[i]), "steps");
        for (size_t k = 0; k < wb_json_length(steps); k++) {
            wb_json_set_number(wb_json_item(steps, k), "increments", (double)NAN);
            wb_json_set_number(wb_json_item(steps, k), "iterations", (double)NAN);
        }
    }
}

static enum wb_status compare_numbers(const struct pair *pair, const char *build)
{
    char path[WB_PATH];
    struct wb_json *was = NULL, *is = NULL;
    WB_TRY(wb_file_join(path, pair->order->folder, "report.json"));
    WB_TRY(wb_json_read(&was, path));
    enum wb_status status = wb_file_join(path, pair->again, "report.json");
    if (status == WB_OK)
        status = wb_json_read(&is, path);
    if (status == WB_OK) {
        forget_excluded_laws(was);
        forget_excluded_laws(is);
        forget_counts(was);
        forget_counts(is);
        status = compare_documents(was, is, build, pair->order->out);
    }
    wb_json_destroy(was);
    wb_json_destroy(is);
    return status;
}

static enum wb_status compare(const struct pair *pair, enum wb_check_end *end)
{
    char text[600];
    struct wb_json_difference of_files, of_build;
    FILE *const out = pair->order->out;
    const struct wb_json *const files = wb_json_get(pair->manifest, "files");
    WB_TRY(check_inputs(pair));
    if (!wb_json_differs(wb_json_get(pair->signed_manifest, "files"), files, 0.0, NULL,
                         &of_files)) {
        fprintf(out, "computed again: the same bytes\n");
        *end = WB_CHECK_SAME;
        return WB_OK;
    }
    if (!wb_json_differs(wb_json_get(pair->signed_manifest, "build"),
                         wb_json_get(pair->manifest, "build"), 0.0, NULL, &of_build)) {
        const char *name = "a file";
        const char *const place = of_files.first.place;
        wb_json_get_text(wb_json_item(files, strtoul(place + (place[0] == '['), NULL, 10)), "name",
                         &name);
        return wb_fail(WB_ERR_DATA,
                       "the same build makes another report: '%s' of it is not what was signed",
                       name);
    }
    describe_build(&of_build.first, text);
    WB_TRY(compare_numbers(pair, text));
    *end = WB_CHECK_OTHER_BUILD;
    return WB_OK;
}

/* --- all of it --- */

static int remove_one(const char *path, const struct stat *info, int type, struct FTW *place)
{
    (void)info, (void)type, (void)place;
    return remove(path);
}

static enum wb_status check(struct pair *pair, enum wb_check_end *end,
                            const struct wb_kind *const *kinds, size_t n_kinds)
{
    char path[WB_PATH];
    bool is_done = false;
    WB_TRY(check_signature(pair->order));
    WB_TRY(wb_file_join(path, pair->order->folder, wb_manifest_name));
    WB_TRY(wb_json_read(&pair->signed_manifest, path));
    WB_TRY(check_files(pair));
    WB_TRY(find_campaign(pair, path));
    *end = WB_CHECK_NOT_COMPUTED;
    if (path[0])
        WB_TRY(compute(pair, kinds, n_kinds, path, &is_done));
    return is_done ? compare(pair, end) : WB_OK;
}

enum wb_status wb_check_run(enum wb_check_end *end, const struct wb_kind *const *kinds,
                            size_t n_kinds, const struct wb_check_order *order)
{
    struct pair pair = {.order = order};
    const enum wb_status status = check(&pair, end, kinds, n_kinds);
    if (pair.again[0])
        nftw(pair.again, remove_one, 8, FTW_DEPTH | FTW_PHYS);
    wb_json_destroy(pair.signed_manifest);
    wb_json_destroy(pair.manifest);
    return status;
}
