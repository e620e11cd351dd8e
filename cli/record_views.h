/* The live views of `wirebench record`: which there are, what they are told, what they answer, and
 * what happens to the terminal and the messages meanwhile.
 *
 *     WB_TRY(wb_record_views_open(&views, &options, &request));   before wb_bend_test_open()
 *     wb_record_views_begin(&views, test);
 *     ...wb_record_views_tell(&views), key = wb_record_views_key(&views)...
 *     wb_record_views_close(&views);                              after wb_bend_test_close()
 *
 * Without a view, and where the view on the terminal has died, the live line is shown.
 */
#ifndef WB_CLI_RECORD_VIEWS_H
#define WB_CLI_RECORD_VIEWS_H

#include <stdbool.h>
#include <stdint.h>
#include <termios.h>

#include "base/text.h"
#include "daq/test/bend_test.h"
#include "fe/model/wire.h"
#include "live/live_feed.h"
#include "live/live_page.h"
#include "live/live_plan.h"
#include "live/live_source.h"

struct wb_record_views_options {
    bool live;        /* the view on the terminal */
    bool serve;       /* the web page, */
    int port;         /* at this port of 127.0.0.1; 0: a free one, which then stands here */
    size_t n_earlier; /* points of earlier tests, for both: as of wb_live_plan */
    const struct wb_live_frame_point *earlier;
};

struct wb_record_views {
    struct wb_live_feed feed;
    struct wb_live_source source;
    struct wb_live_plan plan;
    struct wb_live_page page;
    char title[512];
    char address[96];      /* of the page, for people; "" without one */
    int terminal;          /* index of the view on the terminal; -1: none, or no more */
    struct termios modes;  /* of the terminal before that view */
    struct wb_text unsaid; /* messages of the log while that view has the terminal, */
    int n_lost;            /* and how many more there were */
    int64_t told_ns;
};

/* Starts the views, and has the request tell `views->source` of its samples. A wire without
 * properties has no prediction. Where there is no terminal `live` shows the live line, with a
 * message; where the port of the page is in use, nothing begins. `views` must outlive the test. */
WB_MUST_CHECK enum wb_status wb_record_views_open(struct wb_record_views *views,
                                                  struct wb_record_views_options *options,
                                                  struct wb_bend_test_request *request,
                                                  const struct wb_wire *wire);

/* From now on messages go to the views; without a view on the terminal the live line opens. */
void wb_record_views_begin(struct wb_record_views *views, const struct wb_bend_test *test);

/* Tells the views how the test stands, 20 times a second at most unless `now`. True where the live
 * line is to be drawn by the caller. Never waits. */
bool wb_record_views_tell(struct wb_record_views *views, bool now);

/* The next key, from a view or the terminal; 0 when there is none. */
int wb_record_views_key(struct wb_record_views *views);

/* Ends the views, within two seconds, restores terminal and log, and says what was not yet said. */
void wb_record_views_close(struct wb_record_views *views);

#endif
