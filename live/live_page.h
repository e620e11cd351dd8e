/* The live view of a test as a web page of this computer: an HTTP server on the loopback interface,
 * a program of its own at the view's end of a socket.
 *
 * Read-only. GET / is the page (live_page.html, part of the program; it fetches nothing from
 * elsewhere), GET /events the test as server-sent events (docs/file-formats.md). Requests that name
 * another host than this one are refused, so that no page of the web reads it under a name of its
 * own. libmicrohttpd stays behind live_page.c.
 */
#ifndef WB_LIVE_LIVE_PAGE_H
#define WB_LIVE_LIVE_PAGE_H

#include "base/status.h"
#include "live/live_plan.h"

/* What the view's process needs. */
struct wb_live_page {
    const struct wb_live_plan *plan; /* borrowed */
    int listener;                    /* of wb_live_page_listen() */
};

/* Takes a port of 127.0.0.1, in the recorder, so that a port in use is told before the test begins.
 * `port` 0 takes a free one; *taken receives the number. The caller closes the listener once the
 * view was started. */
WB_MUST_CHECK enum wb_status wb_live_page_listen(int port, int *listener, int *taken);

/* Serves until the recorder has gone, and the last state a moment longer. `page` is a struct
 * wb_live_page. Returns an exit code. */
int wb_live_page_run(int socket, void *page);

#endif
