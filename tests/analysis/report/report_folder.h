/* What tests of reports share: files of the test's folder, and what a report of any kind must be.
 * Static, because each test is a program of its own. */
#ifndef WB_TESTS_ANALYSIS_REPORT_REPORT_FOLDER_H
#define WB_TESTS_ANALYSIS_REPORT_REPORT_FOLDER_H

#include <stdlib.h>

#include "analysis/report/kind.h"
#include "base/file.h"
#include "tests/check.h"
#include "tests/messages.h"
#include "tests/schemas.h"

/* The path of a file of the folder; the last four stay. */
static inline const char *in_folder(const char *name)
{
    static char paths[4][WB_PATH];
    static int next;
    char *const path = paths[next++ % 4];
    assert_int_equal(wb_file_join(path, folder, name), WB_OK);
    return path;
}

/* Returns the file's path. */
static inline const char *write_text(const char *name, const char *text)
{
    const char *const path = in_folder(name);
    assert_int_equal(wb_file_write(path, text, strlen(text)), WB_OK);
    return path;
}

/* To be freed; `size` may be NULL. */
static inline char *read_text(const char *name, size_t *size)
{
    char *bytes;
    assert_int_equal(wb_file_read(in_folder(name), &bytes, size), WB_OK);
    return bytes;
}

static inline bool says(const char *name, const char *part)
{
    size_t size;
    char *const bytes = read_text(name, &size);
    const bool found = memmem(bytes, size, part, strlen(part)) != NULL;
    free(bytes);
    return found;
}

/* A shipped file with more at its end, under another name. */
static inline void copy_shipped(const char *from, const char *to, const char *more)
{
    char path[WB_PATH], *bytes;
    struct wb_text text = {0};
    assert_int_equal(wb_file_find_data(path, from), WB_OK);
    assert_int_equal(wb_file_read(path, &bytes, NULL), WB_OK);
    wb_text_append(&text, "%s%s", bytes, more);
    write_text(to, wb_text_string(&text));
    wb_text_release(&text);
    free(bytes);
}

/* Campaigns of a kind that are refused, and what the message says. */
struct refused_campaign {
    const char *text, *message;
};

static inline void assert_refused(const struct wb_kind *kind, void *campaign,
                                  const struct refused_campaign *cases, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        assert_true(wb_kind_read(kind, campaign, write_text("c.yaml", cases[i].text)) != WB_OK);
        if (!strstr(kept.error, cases[i].message))
            fail_msg("'%s' does not say '%s'", kept.error, cases[i].message);
    }
}

/* Each of the figures is there in both forms, and says that it shows no test. */
static inline void assert_simulated_figures(const char *const *figures, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        char name[80];
        snprintf(name, sizeof name, "report/figures/%s.svg", figures[i]);
        assert_true(says(name, "simulation, no test"));
        snprintf(name, sizeof name, "report/figures/%s.png", figures[i]);
        assert_true(wb_file_exists(in_folder(name)));
    }
    assert_true(says("report/report.pdf", "%PDF"));
}

static inline void assert_says_all(const char *name, const char *const *parts, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (!says(name, parts[i]))
            fail_msg("%s does not say '%s'", name, parts[i]);
    }
}

/* No experiment, no path of this machine, no number that is none, and no key without a row. */
static inline void assert_clean_report(void)
{
    assert_true(files_follow_schemas(in_folder("report")));
    assert_false(says("report/report.html", "xperiment"));
    assert_false(says("report/report.html", folder));
    assert_false(says("report/report.json", folder));
    assert_false(says("report/report.html", ">nan") || says("report/report.html", " nan"));
}

/* Writes the results again: the bytes are those of `report`. */
static inline void assert_same_report(const struct wb_kind *kind, const void *results)
{
    char command[3 * WB_PATH];
    assert_int_equal(wb_kind_write(kind, results, in_folder("again"), true, 0), WB_OK);
    snprintf(command, sizeof command, "diff -r '%s' '%s' >/dev/null", in_folder("report"),
             in_folder("again"));
    assert_int_equal(system(command), 0);
}

#endif
