#include "cli/record_views.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/timing.h"
#include "base/units.h"
#include "cli/live_line.h"
#include "live/live_terminal.h"

#define WB_LOG_DOMAIN "live"

#define UPDATE_NS (50 * WB_NS_PER_MS)
/* Time for views to end by themselves. */
#define PATIENCE_MS 1000

/* --- messages --- */

/* Sinks are called by any thread, under the log's lock. */
static void feed_and_defer(void *context, enum wb_log_level level, const char *domain,
                           const char *message)
{
    struct wb_record_views *const views = context;
    wb_live_feed_add_message(&views->feed, level, message);
    char *const end = views->deferred + views->n_deferred;
    const size_t room = sizeof views->deferred - views->n_deferred;
    const int n = snprintf(end, room, "wirebench: %s%s\n", wb_live_line_level(level), message);
    if (views->n_lost == 0 && (size_t)n < room)
        views->n_deferred += (size_t)n;
    else
        views->n_lost++;
    (void)domain;
}

static void feed_and_print(void *context, enum wb_log_level level, const char *domain,
                           const char *message)
{
    struct wb_record_views *const views = context;
    wb_live_feed_add_message(&views->feed, level, message);
    wb_live_line_log(NULL, level, domain, message);
}

static void open_line(struct wb_record_views *views)
{
    wb_live_line_open();
    if (views->feed.n_views > 0)
        wb_log_set_sink(feed_and_print, views);
}

/* --- opening --- */

static enum wb_status make_plan(struct wb_record_views *views,
                                const struct wb_record_views_options *options,
                                const struct wb_bend_test_request *request,
                                const struct wb_wire *wire)
{
    struct wb_rig rig;
    struct wb_specimen specimen;
    WB_TRY(wb_bend_test_rig(request, &rig));
    WB_TRY(wb_bend_test_specimen(request, &specimen));
    if (wb_live_plan_make(&views->plan, &rig, &specimen, wire, request->travel) != WB_OK)
        wb_warn("the views show no predicted curve: see the message before");
    snprintf(views->title, sizeof views->title, "%s, %g mm, sample %d on %s", wire->name,
             specimen.length / WB_MM, specimen.sample, rig.name);
    views->plan.title = views->title;
    views->plan.recording = request->output_path;
    views->plan.n_earlier = options->n_earlier;
    views->plan.earlier = options->earlier;
    wb_live_source_init(&views->source, &views->feed, &rig, &specimen);
    return WB_OK;
}

static enum wb_status open_terminal(struct wb_record_views *views)
{
    if (!wb_live_terminal_is_there() || tcgetattr(STDIN_FILENO, &views->modes) != 0) {
        wb_info("--live needs a terminal in the foreground: one line is shown instead");
        return WB_OK;
    }
    WB_TRY(wb_live_feed_start(&views->feed, wb_live_terminal_run, &views->plan, &views->terminal));
    /* From here on, messages on the terminal would disappear with the screen of the view. */
    wb_log_set_sink(feed_and_defer, views);
    return WB_OK;
}

/* Before the view on the terminal, so that the message with the address can be read. */
static enum wb_status open_page(struct wb_record_views *views, int *port)
{
    int taken, index;
    WB_TRY(wb_live_page_listen(*port, &views->page.listener, &taken));
    views->page.plan = &views->plan;
    const enum wb_status status =
        wb_live_feed_start(&views->feed, wb_live_page_run, &views->page, &index);
    close(views->page.listener);
    *port = taken; /* the next test of a series uses the same address */
    if (status == WB_OK)
        snprintf(views->address, sizeof views->address,
                 "the test can be watched at http://127.0.0.1:%d/", taken);
    return status;
}

enum wb_status wb_record_views_open(struct wb_record_views *views,
                                    struct wb_record_views_options *options,
                                    struct wb_bend_test_request *request,
                                    const struct wb_wire *wire)
{
    memset(views, 0, sizeof *views);
    views->terminal = -1;
    if (!options->live && !options->serve)
        return WB_OK;
    WB_TRY(make_plan(views, options, request, wire));
    request->sink = wb_live_source_sink(&views->source);
    if (options->serve)
        WB_TRY(open_page(views, &options->port));
    const enum wb_status status = options->live ? open_terminal(views) : WB_OK;
    if (status != WB_OK)
        wb_live_feed_stop(&views->feed, PATIENCE_MS);
    return status;
}

/* --- the test --- */

void wb_record_views_begin(struct wb_record_views *views, const struct wb_bend_test *test)
{
    views->source.test = test;
    if (views->terminal < 0)
        open_line(views);
    if (views->address[0])
        wb_info("%s", views->address);
}

/* Restores the terminal for the live line: the view's process may have left it in any state. */
static void take_terminal_back(struct wb_record_views *views)
{
    const bool is_sane = views->feed.view[views->terminal].ended_well;
    views->terminal = -1;
    open_line(views); /* first, because from here on nothing waits for the terminal */
    if (!is_sane)
        wb_live_line_restore(&views->modes, WB_LIVE_TERMINAL_RESTORE);
    views->deferred[views->n_deferred] = '\0';
    wb_live_line_say(views->deferred);
    if (views->n_lost > 0)
        wb_warn("%d more messages were dropped while the view was shown", views->n_lost);
}

bool wb_record_views_update(struct wb_record_views *views, bool now)
{
    struct wb_live_frame frame;
    const int64_t now_ns = wb_time_now_ns();
    if (views->terminal >= 0 && atomic_load(&views->feed.view[views->terminal].is_gone) &&
        wb_live_feed_has_ended(&views->feed, views->terminal)) {
        take_terminal_back(views);
        wb_warn("the live view has ended; the recording continues");
    }
    if (views->feed.n_views > 0 && (now || now_ns - views->sent_ns >= UPDATE_NS)) {
        views->sent_ns = now_ns;
        wb_live_source_fill(&views->source, &frame);
        wb_live_feed_push(&views->feed, &frame);
    }
    return views->terminal < 0;
}

int wb_record_views_key(struct wb_record_views *views)
{
    const int key = wb_live_feed_key(&views->feed);
    return key == 0 && views->terminal < 0 ? wb_live_line_key() : key;
}

void wb_record_views_close(struct wb_record_views *views)
{
    wb_log_set_sink(NULL, NULL); /* no thread may use a feed that is being closed */
    wb_live_feed_stop(&views->feed, PATIENCE_MS);
    if (views->terminal >= 0)
        take_terminal_back(views);
    wb_live_line_close();
}
