/* The live view of a test as a web page: an HTTP server on the loopback interface, in a child
 * process at the view's end of a socket.
 *
 * Read-only. GET / returns the page (live_page.html, which is part of the program and loads nothing
 * from elsewhere), GET /events the test as server-sent events (docs/file-formats.md). Requests with
 * another host name are rejected, so that web pages cannot read the data by DNS rebinding. Only
 * live_page.c uses libmicrohttpd.
 */
#ifndef WB_LIVE_LIVE_PAGE_H
#define WB_LIVE_LIVE_PAGE_H

#include "base/status.h"
#include "live/live_plan.h"

/* Argument of wb_live_page_run(). */
struct wb_live_page {
    const struct wb_live_plan *plan; /* borrowed */
    int listener;                    /* of wb_live_page_listen() */
};

/* Opens a port of 127.0.0.1 in the recorder, so that a port in use is reported before the test
 * begins. `port` 0: any free port; *taken receives its number. The caller closes the listener after
 * the view was started. */
WB_MUST_CHECK enum wb_status wb_live_page_listen(int port, int *listener, int *taken);

/* Serves until the recorder has ended and the last state was sent. `page` is a struct wb_live_page.
 * Returns an exit code. */
int wb_live_page_run(int socket, void *page);

#endif
