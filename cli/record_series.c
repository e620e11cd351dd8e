#include "cli/record_series.h"

#include <errno.h>
#include <langinfo.h>
#include <locale.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "analysis/series_results.h"
#include "base/interrupt.h"
#include "base/timing.h"
#include "base/units.h"
#include "cli/command.h"
#include "cli/finding.h"
#include "cli/record_test.h"
#include "daq/recording/recording.h"
#include "daq/test/series.h"
#include "live/live_print.h"

#define WB_LOG_DOMAIN "series"

#define ANSWER 1024

struct run {
    const struct wb_record_series *request;
    struct wb_bend_test_request test;
    struct wb_record_views_options views;
    struct wb_series series;
    char folder[WB_PATH], index_path[WB_PATH], operator_name[80];
    struct wb_index index;
    struct wb_series_results results;
    bool is_scripted; /* stdin is not a terminal */
    bool is_over;     /* stopped by the operator, or stdin has ended */
};

/* --- questions --- */

/* Reads a line from stdin without its line end; false at the end of stdin or on Ctrl-C. Reads byte
 * by byte: the bytes behind the line answer the next question, or are keys of a test. */
static bool read_line(char *line, size_t size)
{
    size_t n = 0;
    while (!wb_interrupted()) {
        struct pollfd polled = {.fd = STDIN_FILENO, .events = POLLIN};
        char byte;
        if (poll(&polled, 1, 200) <= 0)
            continue;
        const ssize_t got = read(STDIN_FILENO, &byte, 1);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return false;
        if (byte == '\n') {
            line[n] = '\0';
            return true;
        }
        if (n + 1 < size)
            line[n++] = byte;
    }
    return false;
}

/* Asks a question; false at the end of stdin or on Ctrl-C, and the series is over. */
static bool ask(struct run *run, char answer[ANSWER], const char *question)
{
    fprintf(stderr, "%s", question);
    fflush(stderr);
    if (!read_line(answer, ANSWER)) {
        fprintf(stderr, "\n");
        run->is_over = true;
        return false;
    }
    if (run->is_scripted)
        fprintf(stderr, "%s\n", answer);
    const size_t n = strlen(answer);
    if (n > 0 && answer[n - 1] == '\r')
        answer[n - 1] = '\0';
    return true;
}

/* --- the index --- */

static enum wb_status read_index(struct run *run)
{
    wb_index_release(&run->index);
    if (!wb_file_exists(run->index_path))
        return WB_OK;
    return wb_index_read(&run->index, run->index_path, NULL);
}

static void copy_meta(struct wb_recording *recording, const char *key, char *text, size_t size)
{
    char *value = NULL;
    if (wb_recording_meta(recording, key, &value) == WB_OK)
        snprintf(text, size, "%s", value);
    free(value);
}

/* The cycles of a recording. */
struct progress {
    int begun, done; /* cycles */
    bool is_whole;   /* as many as were requested */
};

static enum wb_status count_cycles(void *context, const struct wb_event *event)
{
    struct progress *const progress = context;
    progress->begun += strcmp(event->kind, "cycle_start") == 0;
    progress->done += strcmp(event->kind, "cycle_end") == 0;
    return WB_OK;
}

/* Fills an entry of the index from the metadata of a recording. */
static enum wb_status describe(const struct run *run, const char *path, int number,
                               struct wb_index_entry *entry, struct progress *progress)
{
    struct wb_recording *recording;
    char is_virtual[16] = "", wanted[16] = "", *text = NULL;
    struct wb_specimen specimen;
    *entry = (struct wb_index_entry){.seed = -1, .number = number};
    *progress = (struct progress){0};
    WB_TRY(wb_recording_sha256(path, entry->sha256, NULL));
    WB_TRY(wb_recording_open(&recording, path));
    snprintf(entry->file, sizeof entry->file, "%s", wb_file_name(path));
    snprintf(entry->series, sizeof entry->series, "%s", run->series.name);
    copy_meta(recording, "start_utc", entry->date_utc, sizeof entry->date_utc);
    copy_meta(recording, "virtual", is_virtual, sizeof is_virtual);
    copy_meta(recording, "cycles", wanted, sizeof wanted);
    entry->is_virtual = strcmp(is_virtual, "true") == 0;
    enum wb_status status = wb_recording_meta(recording, "specimen", &text);
    if (status == WB_OK)
        status = wb_specimen_parse(text, entry->file, &specimen, NULL);
    else
        wb_error("'%s' has no specimen in its metadata", path);
    free(text);
    if (wb_recording_each_event(recording, count_cycles, progress) != WB_OK)
        wb_debug("'%s': only events before the damage are counted", path);
    const enum wb_status closed = wb_recording_close(recording);
    progress->is_whole = progress->done > 0 && progress->done >= atoi(wanted);
    entry->cycles = progress->done;
    if (status == WB_OK) {
        entry->sample = specimen.sample;
        entry->length = specimen.length;
    }
    return status == WB_OK ? closed : status;
}

/* --- curves and table after each test --- */

static void add_points(struct wb_live_history *history, const struct wb_series_test *test,
                       struct wb_live_plan *plan)
{
    const struct wb_dataset *const dataset = &test->dataset;
    plan->length = dataset->info.length;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (wb_series_results_shows(row))
            history->points[history->n_points++] = (struct wb_live_frame_point){
                (float)row->deflection, (float)row->force, test->number};
    }
}

/* From the user's locale; the process itself keeps the C locale, so that it writes decimal points.
 */
static bool has_unicode(void)
{
    const locale_t locale = newlocale(LC_CTYPE_MASK, "", (locale_t)0);
    const bool is = locale != (locale_t)0 && strcmp(nl_langinfo_l(CODESET, locale), "UTF-8") == 0;
    if (locale != (locale_t)0)
        freelocale(locale);
    return is;
}

/* Draws the curves of all tests that are not excluded, and of the last one, on a terminal. */
static void show_curves(const struct wb_series_results *results)
{
    struct wb_live_history history = {0};
    struct wb_live_plan plan = {0};
    struct wb_text text = {0};
    struct winsize window = {.ws_row = 24, .ws_col = 80};
    size_t n = 0;
    for (int i = 0; i < results->n; i++)
        n += results->tests[i].is_usable ? results->tests[i].dataset.n_rows : 0;
    history.points = n > 0 && isatty(STDERR_FILENO) ? malloc(n * sizeof *history.points) : NULL;
    if (!history.points)
        return;
    (void)ioctl(STDERR_FILENO, TIOCGWINSZ, &window);
    const struct wb_live_print print = {
        .columns = window.ws_col > 100 || window.ws_col < 40 ? 100 : window.ws_col - 1,
        .rows = window.ws_row > 34 ? 22 : 16,
        .is_unicode = has_unicode(),
        .is_coloured = !getenv("NO_COLOR"),
    };
    for (int i = 0; i < results->n; i++) {
        const struct wb_series_test *const test = &results->tests[i];
        if (test->is_usable && (!test->excluded.is_excluded || i + 1 == results->n))
            add_points(&history, test, &plan);
    }
    wb_live_print_curve(&print, &plan, &history, &text);
    fprintf(stderr, "\n%s\n", wb_text_string(&text));
    wb_text_release(&text);
    wb_live_history_release(&history);
}

static void print_table(FILE *out, const struct wb_series_results *results)
{
    struct wb_text text = {0};
    wb_series_results_append(results, &text);
    fprintf(out, "%s", wb_text_string(&text));
    wb_text_release(&text);
}

/* Whether the figure was drawn. */
static bool draw_figure(const struct run *run)
{
    if (!run->request->figure)
        return false;
    if (wb_series_results_draw(&run->results, run->series.name, run->request->figure) == WB_OK)
        return true;
    wb_warn("'%s' was not drawn: see the message before", run->request->figure);
    return false;
}

/* --- the operator's decision --- */

/* "x REASON", "r REASON". */
static bool take_exclusion(const struct run *run, const char *answer,
                           struct wb_index_exclusion *exclusion, const char *now_utc)
{
    const char *const reason = answer + 1 + strspn(answer + 1, " \t");
    if ((answer[0] != 'x' && answer[0] != 'r') || (answer[1] && answer[1] != ' ')) {
        wb_warn("unknown answer '%s'", answer);
        return false;
    }
    if (!*reason || strlen(reason) >= sizeof exclusion->reason) {
        wb_warn(
            "give a reason of less than %zu bytes, for example: %c the wire slipped in its clamp",
            sizeof exclusion->reason, answer[0]);
        return false;
    }
    *exclusion = (struct wb_index_exclusion){.is_excluded = true, .is_repeated = answer[0] == 'r'};
    snprintf(exclusion->reason, sizeof exclusion->reason, "%s", reason);
    snprintf(exclusion->by, sizeof exclusion->by, "%s", run->operator_name);
    snprintf(exclusion->date_utc, sizeof exclusion->date_utc, "%s", now_utc);
    return true;
}

/* Asks the operator whether the test counts; false where the series is over before. */
static bool decide(struct run *run, struct wb_index_entry *entry, bool is_whole)
{
    char answer[ANSWER], now_utc[32];
    /* Keys that were meant for the test are not an answer. */
    if (!run->is_scripted)
        tcflush(STDIN_FILENO, TCIFLUSH);
    for (;;) {
        if (!ask(run, answer,
                 is_whole ? "Enter: keep it; x REASON: exclude it; r REASON: exclude it and test "
                            "this sample again; q: stop here> "
                          : "The test is incomplete. k: keep it anyway; x REASON: exclude it; "
                            "r REASON: exclude it and test this sample again; q: stop here> "))
            return false;
        if ((is_whole && !answer[0]) || strcmp(answer, "k") == 0)
            return true;
        if (strcmp(answer, "q") == 0) {
            run->is_over = true;
            return false;
        }
        wb_time_format(wb_time_utc(), now_utc);
        if (take_exclusion(run, answer, &entry->excluded, now_utc))
            return true;
    }
}

/* Shows a recorded test, asks whether to keep it, and adds it to the index. */
static enum wb_status settle(struct run *run, int number, const char *path)
{
    struct wb_index_entry entry;
    struct progress progress;
    WB_TRY(describe(run, path, number, &entry, &progress));
    if (progress.begun == 0) {
        wb_info("'%s' contains no cycle: the file is kept but not added to the index",
                wb_file_name(path));
        return WB_OK;
    }
    struct wb_series_test *const test = wb_series_results_add(&run->results, path, number);
    if (test->is_usable)
        snprintf(entry.wire, sizeof entry.wire, "%s", test->dataset.info.wire);
    else
        snprintf(entry.wire, sizeof entry.wire, "%.63s", wb_file_name(run->series.like.wire));
    if (!test->is_usable)
        wb_warn("no curve can be made of '%s': %s", test->name, test->problem);
    show_curves(&run->results);
    print_table(stderr, &run->results);
    if (!decide(run, &entry, progress.is_whole && test->is_usable)) {
        wb_info("'%s' is not in the index yet: you will be asked again when the series continues",
                test->name);
        return WB_OK;
    }
    test->excluded = entry.excluded;
    (void)draw_figure(run);
    WB_TRY(wb_index_append(run->index_path, &entry));
    return read_index(run);
}

/* --- one test --- */

/* Asks the questions of the series' file; false where the series is over before. */
static bool ask_questions(struct run *run, int sample, struct wb_text *specimen, char notes[ANSWER])
{
    static const char *const what[] = {
        "markers_mm, from the clamp to the knot (Enter: as in the file)> ",
        "marker_offset_mm (Enter: as in the file)> ", "notes> "};
    char answers[WB_SERIES_QUESTIONS][ANSWER] = {{0}};
    const char *given[WB_SERIES_QUESTIONS];
    for (;;) {
        struct wb_reason why = {.text = ""};
        for (int i = 0; i < WB_SERIES_QUESTIONS; i++) {
            given[i] = answers[i];
            if (run->series.asks[i] && !ask(run, answers[i], what[i]))
                return false;
        }
        snprintf(notes, ANSWER, "%s", answers[WB_SERIES_NOTES]);
        if (wb_series_specimen(&run->series, sample, given, specimen, &why) == WB_OK)
            return true;
        wb_warn("%s", why.text);
        if (!(run->series.asks[0] || run->series.asks[1]))
            return false;
        wb_text_release(specimen);
    }
}

#define MOST_EARLIER 30    /* earlier tests whose curves the views show */
#define EARLIER_POINTS 200 /* approximate number of points of each */

static void add_earlier(const struct wb_series_test *test, struct wb_live_frame_point *points,
                        size_t *n)
{
    const size_t stride = test->dataset.n_rows / EARLIER_POINTS + 1;
    for (size_t i = 0; i < test->dataset.n_rows; i += stride) {
        const struct wb_row *const row = &test->dataset.rows[i];
        if (wb_series_results_shows(row) && isfinite(row->tension))
            points[(*n)++] = (struct wb_live_frame_point){(float)row->deflection,
                                                          (float)row->tension, test->number};
    }
}

/* The curves of the last tests that are not excluded, for the views of the next one. Caller frees;
 * may be NULL. */
static struct wb_live_frame_point *find_earlier(const struct wb_series_results *results, size_t *n)
{
    struct wb_live_frame_point *const points =
        malloc((size_t)MOST_EARLIER * (EARLIER_POINTS + 1) * sizeof *points);
    int left = MOST_EARLIER;
    *n = 0;
    for (int i = results->n - 1; points && i >= 0 && left > 0; i--) {
        const struct wb_series_test *const test = &results->tests[i];
        if (!test->is_usable || test->excluded.is_excluded)
            continue;
        add_earlier(test, points, n);
        left--;
    }
    return points;
}

static enum wb_status test_sample(struct run *run, int number, int sample, const char *specimen,
                                  const char *notes)
{
    char file[WB_SERIES_FILE], path[WB_PATH];
    struct wb_bend_test_result result;
    struct wb_bend_test_request test = run->test;
    int code;
    wb_series_file(&run->series, number, sample, file);
    WB_TRY(wb_file_join(path, run->folder, file));
    test.output_path = path;
    test.specimen_path = run->series.specimen_path;
    test.specimen_text = specimen;
    test.operator_name = run->operator_name;
    test.notes = notes[0] ? notes : run->test.notes;
    struct wb_live_frame_point *const earlier = find_earlier(&run->results, &run->views.n_earlier);
    run->views.earlier = earlier;
    struct wb_virtual_test *const virtual = run->request->virtual;
    /* The seed draws the specimen and its noise. */
    if (virtual && virtual->settings.seed != WB_BENCH_SEED_OF_SAMPLE)
        virtual->settings.seed++;
    const enum wb_status status = wb_record_test_run(&test, &run->views, virtual, &result, &code);
    free(earlier);
    /* An error is already reported; the same specimen is asked for again. */
    if (status != WB_OK || !result.recorded)
        return WB_OK;
    wb_record_test_print(stderr, &result, file);
    return settle(run, number, path);
}

static enum wb_status next_test(struct run *run, int sample, int n_done)
{
    char answer[ANSWER], file[WB_SERIES_FILE], notes[ANSWER];
    struct wb_text specimen = {0};
    int number;
    enum wb_status status = WB_OK;
    WB_TRY(wb_series_next_number(&run->series, run->folder, &run->index, &number));
    wb_series_file(&run->series, number, sample, file);
    fprintf(stderr, "\n%s, specimen %d of %d: sample %d of %s, %g mm, recording %s\n",
            run->series.name, n_done + 1, run->series.n_specimens, sample, run->series.like.wire,
            run->series.like.length / WB_MM, file);
    if (ask_questions(run, sample, &specimen, notes) &&
        ask(run, answer, "Mount it with the strand slack, then press Enter; q: stop here> ")) {
        if (strcmp(answer, "q") == 0)
            run->is_over = true;
        else
            status = test_sample(run, number, sample, wb_text_string(&specimen), notes);
    }
    wb_text_release(&specimen);
    return status;
}

/* --- the series --- */

/* Loads the tests of the index, and asks about recordings that are not in it. */
static enum wb_status look_back(struct run *run)
{
    char path[WB_PATH], file[WB_SERIES_FILE];
    for (int i = 0; i < run->index.n && !wb_interrupted(); i++) {
        const struct wb_index_entry *const entry = &run->index.entries[i];
        if (strcmp(entry->series, run->series.name) != 0)
            continue;
        WB_TRY(wb_file_join(path, run->folder, entry->file));
        struct wb_series_test *const test =
            wb_series_results_add(&run->results, path, entry->number);
        test->excluded = entry->excluded;
        test->sample = entry->sample;
    }
    for (int number = 1; !run->is_over; number++) {
        WB_TRY(wb_series_find_unlisted(&run->series, run->folder, &run->index, &number, file));
        if (number == 0)
            return WB_OK;
        WB_TRY(wb_file_join(path, run->folder, file));
        fprintf(stderr, "\n%s was recorded, but not yet kept or excluded.\n", file);
        WB_TRY(settle(run, number, path));
    }
    return WB_OK;
}

static enum wb_status run_tests(struct run *run)
{
    int n_done, sample = wb_series_next_sample(&run->series, &run->index, &n_done);
    fprintf(stderr, "series %s: %d of %d specimens done; recordings go to '%s'\n", run->series.name,
            n_done, run->series.n_specimens, run->folder);
    if (run->is_scripted)
        wb_info("standard input is not a terminal: answers are read from it line by line");
    while (!run->operator_name[0] && !run->is_over) {
        char answer[ANSWER];
        if (ask(run, answer, "Your name, for the recordings> "))
            snprintf(run->operator_name, sizeof run->operator_name, "%.79s", answer);
    }
    WB_TRY(look_back(run));
    while (!run->is_over && !wb_interrupted() &&
           (sample = wb_series_next_sample(&run->series, &run->index, &n_done)) > 0)
        WB_TRY(next_test(run, sample, n_done));
    return WB_OK;
}

/* --- the last lines --- */

static void append_found(struct wb_text *text, const struct run *run, int n_done)
{
    const struct wb_series_results *const results = &run->results;
    const struct wb_test_info *info = NULL;
    int n_excluded = 0;
    for (int i = 0; i < results->n; i++) {
        const struct wb_series_test *const test = &results->tests[i];
        info = test->is_usable ? &test->dataset.info : info;
        n_excluded += test->excluded.is_excluded;
    }
    wb_text_append(text, "series %s: %d of %d specimens done, %d test%s", run->series.name, n_done,
                   run->series.n_specimens, results->n, results->n == 1 ? "" : "s");
    if (n_excluded > 0)
        wb_text_append(text, " (%d excluded)", n_excluded);
    if (info)
        wb_text_append(text, " of %s, L = %g mm (%s)", info->wire, info->length / WB_MM,
                       wb_finding_source(info));
}

static void append_trust(struct wb_text *text, const struct run *run, bool is_complete)
{
    const struct wb_series_results *const results = &run->results;
    int n_kept = 0, n_unusable = 0, n_warned = 0;
    for (int i = 0; i < results->n; i++) {
        const struct wb_series_test *const test = &results->tests[i];
        if (test->excluded.is_excluded)
            continue;
        n_kept++;
        n_unusable += !test->is_usable;
        n_warned += test->is_usable &&
                    (!wb_dataset_is_complete(&test->dataset) ||
                     wb_json_length(wb_json_get(test->dataset.document, "warnings")) > 0);
    }
    if (n_kept == 0)
        wb_text_append(text, "no: no test was kept");
    else if (n_unusable > 0)
        wb_text_append(text, "in part: no curve can be made of %d of %d tests", n_unusable, n_kept);
    else if (n_warned > 0)
        wb_text_append(text, "in part: %d of %d tests are incomplete or were aligned with warnings",
                       n_warned, n_kept);
    else
        wb_text_append(text, "%s: %d test%s aligned without warnings",
                       is_complete ? "yes" : "in part, the series is not complete", n_kept,
                       n_kept == 1 ? "" : "s");
}

static void append_next(struct wb_text *text, const struct run *run, bool is_complete)
{
    char folder[WB_PATH];
    if (!is_complete) {
        wb_text_append(text, "run the same command again to continue");
        return;
    }
    wb_text_append(text, "wirebench align");
    for (int i = 0; i < run->results.n; i++) {
        const struct wb_series_test *const test = &run->results.tests[i];
        char path[WB_PATH];
        if (test->excluded.is_excluded || wb_file_join(path, run->folder, test->name) != WB_OK)
            continue;
        wb_finding_append_command(text, " %s", path);
    }
    if (wb_file_join(folder, run->folder, "datasets") == WB_OK)
        wb_finding_append_command(text, " -o %s", folder);
}

static void print_finding(const struct run *run, int n_done, bool is_complete, bool has_figure)
{
    struct wb_finding finding = {.figure = has_figure ? run->request->figure : NULL};
    append_found(&finding.found, run, n_done);
    append_trust(&finding.trust, run, is_complete);
    append_next(&finding.next, run, is_complete);
    wb_finding_print(&finding);
}

static int finish(struct run *run)
{
    int n_done;
    const bool is_complete = wb_series_next_sample(&run->series, &run->index, &n_done) == 0;
    const bool has_figure = draw_figure(run);
    if (run->request->json) {
        struct wb_json *const root = wb_json_create();
        wb_json_set_text(root, "series", run->series.name);
        wb_json_set_text(root, "folder", run->folder);
        wb_json_set_integer(root, "specimens", run->series.n_specimens);
        wb_json_set_integer(root, "specimens_done", n_done);
        wb_series_results_describe(&run->results, root);
        wb_command_print_json(root);
    } else {
        print_table(stdout, &run->results);
        print_finding(run, n_done, is_complete, has_figure);
    }
    if (!is_complete)
        wb_info("%d of %d specimens done; run the same command again to continue", n_done,
                run->series.n_specimens);
    return is_complete ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}

static enum wb_status prepare(struct run *run, char rig[WB_PATH])
{
    const struct wb_record_series *const request = run->request;
    run->test = request->test;
    run->views = request->views;
    run->is_scripted = !isatty(STDIN_FILENO);
    WB_TRY(wb_series_read(&run->series, request->path, &run->test));
    if (!run->test.rig_path && !run->series.rig[0])
        return wb_fail(WB_ERR_ARGUMENT,
                       "no rig: name the rig file before --series, or with 'rig' in '%s'",
                       request->path);
    if (!run->test.rig_path)
        run->test.rig_path = wb_command_find(run->series.rig, rig);
    if (request->test.operator_name)
        snprintf(run->operator_name, sizeof run->operator_name, "%s", request->test.operator_name);
    snprintf(run->folder, sizeof run->folder, "%s",
             request->folder ? request->folder : run->series.folder);
    WB_TRY(wb_file_make_folder(run->folder));
    return wb_file_join(run->index_path, run->folder, WB_INDEX_FILE);
}

int wb_record_series_run(const struct wb_record_series *request)
{
    static struct run run;
    char rig[WB_PATH], lock_path[WB_PATH + 8];
    struct wb_file_lock lock;
    long holder = 0;
    run = (struct run){.request = request};
    wb_interrupt_install();
    if (prepare(&run, rig) != WB_OK)
        return WB_EXIT_FAILED;
    snprintf(lock_path, sizeof lock_path, "%s.lock", run.index_path);
    enum wb_status status = wb_file_lock(&lock, lock_path, &holder);
    if (status == WB_ERR_BUSY)
        wb_error("another series is recorded into '%s' (process %ld): wait for it, or choose "
                 "another folder with -o",
                 run.folder, holder);
    if (status != WB_OK)
        return WB_EXIT_FAILED;
    status = read_index(&run);
    if (status == WB_OK && request->figure && wb_file_exists(request->figure) && run.index.n == 0) {
        wb_error("'%s' exists: choose another name with --figure", request->figure);
        status = WB_ERR_EXISTS;
    }
    if (status == WB_OK)
        status = run_tests(&run);
    const int code = status == WB_OK ? finish(&run) : WB_EXIT_FAILED;
    wb_series_results_release(&run.results);
    wb_index_release(&run.index);
    wb_file_unlock(&lock);
    return code;
}
