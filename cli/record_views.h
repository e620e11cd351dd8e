/* The live views of `wirebench record`: starts and ends them, sends them frames and messages, reads
 * their keys, and manages the terminal and the log meanwhile.
 *
 *     WB_TRY(wb_record_views_open(&views, &options, &request));   before wb_bend_test_open()
 *     wb_record_views_begin(&views, test);
 *     ...wb_record_views_update(&views), key = wb_record_views_key(&views)...
 *     wb_record_views_close(&views);                              after wb_bend_test_close()
 *
 * Without a view, and after the view on the terminal has ended, the live line is shown.
 */
#ifndef WB_CLI_RECORD_VIEWS_H
#define WB_CLI_RECORD_VIEWS_H

#include <stdbool.h>
#include <stdint.h>
#include <termios.h>

#include "daq/test/bend_test.h"
#include "fe/model/wire.h"
#include "live/live_feed.h"
#include "live/live_page.h"
#include "live/live_plan.h"
#include "live/live_source.h"

enum {
    WB_RECORD_VIEWS_DEFERRED = 65536
};

struct wb_record_views_options {
    bool live;        /* the view on the terminal */
    bool serve;       /* the web page */
    int port;         /* of the web page on 127.0.0.1; 0: a free one, which is stored here */
    size_t n_earlier; /* points of earlier tests, for both; see wb_live_plan */
    const struct wb_live_frame_point *earlier;
};

struct wb_record_views {
    struct wb_live_feed feed;
    struct wb_live_source source;
    struct wb_live_plan plan;
    struct wb_live_page page;
    char title[512];
    char address[96];     /* message with the address of the page; "" without one */
    int terminal;         /* index of the view on the terminal; -1: none, or it has ended */
    struct termios modes; /* of the terminal before that view */
    /* Messages of the log while that view has the terminal. Their size is fixed: the recorder does
     * not end where memory is insufficient. */
    char deferred[WB_RECORD_VIEWS_DEFERRED];
    size_t n_deferred; /* bytes without the NUL */
    int n_lost;        /* messages from the first that did not fit */
    int64_t sent_ns;
};

/* Starts the views, and connects the request's samples to `views->source`. A wire without
 * properties has no prediction. Without a terminal, `live` shows the live line, with a message.
 * Fails if the port of the page is in use. `views` must outlive the test. */
WB_MUST_CHECK enum wb_status wb_record_views_open(struct wb_record_views *views,
                                                  struct wb_record_views_options *options,
                                                  struct wb_bend_test_request *request,
                                                  const struct wb_wire *wire);

/* Sends messages to the views from now on; without a view on the terminal the live line opens. */
void wb_record_views_begin(struct wb_record_views *views, const struct wb_bend_test *test);

/* Sends the state of the test to the views, at most 20 times a second unless `now`. Returns whether
 * the caller has to draw the live line. Never waits. */
bool wb_record_views_update(struct wb_record_views *views, bool now);

/* The next key, from a view or the terminal; 0 when there is none. */
int wb_record_views_key(struct wb_record_views *views);

/* Ends the views within two seconds, restores terminal and log, and prints the deferred messages.
 */
void wb_record_views_close(struct wb_record_views *views);

#endif
