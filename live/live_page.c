#include "live/live_page.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <microhttpd.h>

#include "base/timing.h"
#include "base/units.h"
#include "live/live_events.h"
#include "live/live_feed.h"
#include "live/live_history.h"
#include "live/live_page_html.h"

#define WB_LOG_DOMAIN "live"

#define MOST_CLIENTS 16
/* Time for sending the last state to the clients. */
#define LINGER_NS (300 * WB_NS_PER_MS)
#define BLOCK 16384 /* bytes of a response per call of libmicrohttpd */

struct server;

/* A connection that receives events. */
struct client {
    struct server *server;
    struct client *next;
    struct MHD_Connection *connection;
    struct wb_live_events_cursor cursor;
    struct wb_text text; /* events to send */
    size_t sent;         /* bytes of it already sent */
    bool is_waiting;     /* suspended until there are new events */
};

struct server {
    const struct wb_live_plan *plan;
    struct wb_live_history history;
    struct client *clients;
    bool is_over; /* the recorder has ended */
};

/* --- the port --- */

enum wb_status wb_live_page_listen(int port, int *listener, int *taken)
{
    struct sockaddr_in address = {.sin_family = AF_INET,
                                  .sin_port = htons((uint16_t)port),
                                  .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t length = sizeof address;
    const int on = 1;
    const int descriptor = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (descriptor < 0)
        return wb_fail(WB_ERR_IO, "a socket for --serve cannot be created: %s", strerror(errno));
    (void)setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (bind(descriptor, (struct sockaddr *)&address, sizeof address) != 0 ||
        listen(descriptor, MOST_CLIENTS) != 0 ||
        getsockname(descriptor, (struct sockaddr *)&address, &length) != 0) {
        const int reason = errno;
        close(descriptor);
        return wb_fail(reason == EADDRINUSE ? WB_ERR_BUSY : WB_ERR_IO,
                       "port %d of 127.0.0.1 cannot be used: %s; choose another port with --serve, "
                       "or 0 for a free one",
                       port, strerror(reason));
    }
    *listener = descriptor;
    *taken = ntohs(address.sin_port);
    return WB_OK;
}

/* --- events --- */

/* Gives the bytes of a client's events; without new events the connection is suspended. */
static ssize_t read_events(void *context, uint64_t position, char *buffer, size_t most)
{
    struct client *const client = context;
    struct server *const server = client->server;
    (void)position;
    if (client->sent == client->text.length) {
        client->sent = client->text.length = 0;
        if (client->cursor.has_end)
            return MHD_CONTENT_READER_END_OF_STREAM;
        wb_live_events_append(&client->cursor, server->plan, &server->history, server->is_over,
                              &client->text);
    }
    if (client->sent == client->text.length) {
        client->is_waiting = true;
        MHD_suspend_connection(client->connection);
        return 0;
    }
    const size_t left = client->text.length - client->sent, n = left < most ? left : most;
    memcpy(buffer, client->text.bytes + client->sent, n);
    client->sent += n;
    return (ssize_t)n;
}

/* Frees a client after the end of its connection. */
static void free_client(void *context)
{
    struct client *const client = context;
    struct client **at = &client->server->clients;
    while (*at && *at != client)
        at = &(*at)->next;
    if (*at)
        *at = client->next;
    wb_text_release(&client->text);
    free(client);
}

static void wake_clients(struct server *server)
{
    for (struct client *client = server->clients; client; client = client->next) {
        if (client->is_waiting)
            MHD_resume_connection(client->connection);
        client->is_waiting = false;
    }
}

static struct MHD_Response *follow_events(struct server *server, struct MHD_Connection *connection)
{
    struct client *const client = calloc(1, sizeof *client);
    if (!client)
        return NULL;
    client->server = server;
    client->connection = connection;
    client->next = server->clients;
    server->clients = client;
    struct MHD_Response *const response = MHD_create_response_from_callback(
        MHD_SIZE_UNKNOWN, BLOCK, read_events, client, free_client);
    if (!response)
        free_client(client);
    else
        (void)MHD_add_response_header(response, "Content-Type", "text/event-stream");
    return response;
}

/* --- requests --- */

/* Whether the request addresses this computer by name, with any port (it may use a tunnel). */
static bool is_local_request(struct MHD_Connection *connection)
{
    static const char *const names[] = {"127.0.0.1", "localhost"};
    const char *const host =
        MHD_lookup_connection_value(connection, MHD_HEADER_KIND, MHD_HTTP_HEADER_HOST);
    for (size_t i = 0; host && i < sizeof names / sizeof names[0]; i++) {
        const size_t n = strlen(names[i]);
        if (strncmp(host, names[i], n) == 0 && (host[n] == '\0' || host[n] == ':'))
            return true;
    }
    return false;
}

static enum MHD_Result reject(struct MHD_Connection *connection, unsigned code, const char *words)
{
    struct MHD_Response *const response = MHD_create_response_from_buffer(
        strlen(words), (void *)(uintptr_t)words, MHD_RESPMEM_PERSISTENT);
    if (!response)
        return MHD_NO;
    const enum MHD_Result result = MHD_queue_response(connection, code, response);
    MHD_destroy_response(response);
    return result;
}

static enum MHD_Result answer(void *context, struct MHD_Connection *connection, const char *path,
                              const char *method, const char *version, const char *data,
                              size_t *n_data, void **request)
{
    struct MHD_Response *response;
    (void)version, (void)data, (void)n_data, (void)request;
    if (!is_local_request(connection))
        return reject(connection, MHD_HTTP_FORBIDDEN,
                      "only requests to this computer are accepted\n");
    if (strcmp(method, "GET") != 0)
        return reject(connection, MHD_HTTP_METHOD_NOT_ALLOWED, "only GET is supported\n");
    if (strcmp(path, "/events") == 0) {
        response = follow_events(context, connection);
    } else if (strcmp(path, "/") == 0) {
        response = MHD_create_response_from_buffer(
            sizeof wb_live_page_html, (void *)(uintptr_t)wb_live_page_html, MHD_RESPMEM_PERSISTENT);
        if (response)
            (void)MHD_add_response_header(response, "Content-Type", "text/html; charset=utf-8");
    } else {
        return reject(connection, MHD_HTTP_NOT_FOUND, "only / and /events exist\n");
    }
    if (!response)
        return MHD_NO;
    (void)MHD_add_response_header(response, "Cache-Control", "no-store");
    (void)MHD_add_response_header(response, "Content-Security-Policy",
                                  "default-src 'none'; style-src 'unsafe-inline'; script-src "
                                  "'unsafe-inline'; connect-src 'self'; img-src data:");
    const enum MHD_Result result = MHD_queue_response(connection, MHD_HTTP_OK, response);
    MHD_destroy_response(response);
    return result;
}

/* --- the process --- */

/* Serves until the recorder has ended and the clients have received that event. */
static void serve(struct server *server, struct MHD_Daemon *daemon, int socket)
{
    const union MHD_DaemonInfo *const info = MHD_get_daemon_info(daemon, MHD_DAEMON_INFO_EPOLL_FD);
    int64_t end_ns = INT64_MAX;
    while (info && !wb_live_feed_is_told_to_end() && wb_time_now_ns() < end_ns) {
        struct pollfd polled[] = {{.fd = info->epoll_fd, .events = POLLIN},
                                  {.fd = server->is_over ? -1 : socket, .events = POLLIN}};
        const int64_t most_ns = (server->is_over ? 20 : 200) * WB_NS_PER_MS;
        if (wb_time_wait(polled, 2, wb_time_now_ns() + most_ns) < 0 && errno != EINTR)
            return;
        if (!server->is_over && polled[1].revents) {
            server->is_over = !wb_live_history_receive(&server->history, socket);
            wb_live_history_check_disk(&server->history, server->plan->recording);
            if (server->is_over)
                end_ns = wb_time_now_ns() + LINGER_NS;
            wake_clients(server);
        }
        (void)MHD_run(daemon);
        if (server->is_over && !server->clients)
            return;
    }
}

int wb_live_page_run(int socket, void *context)
{
    const struct wb_live_page *const page = context;
    static struct server server;
    server.plan = page->plan;
    struct MHD_Daemon *const daemon =
        MHD_start_daemon(MHD_USE_EPOLL | MHD_ALLOW_SUSPEND_RESUME, 0, NULL, NULL, answer, &server,
                         MHD_OPTION_LISTEN_SOCKET, page->listener, MHD_OPTION_CONNECTION_LIMIT,
                         (unsigned)MOST_CLIENTS, MHD_OPTION_END);
    if (!daemon)
        return 1;
    serve(&server, daemon, socket);
    wake_clients(&server); /* the daemon must not be stopped with suspended connections */
    MHD_stop_daemon(daemon);
    wb_live_history_release(&server.history);
    return 0;
}
