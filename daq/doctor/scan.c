#include "daq/doctor/scan.h"

#include <arpa/inet.h>
#include <errno.h>
#include <glob.h>
#include <limits.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/interrupt.h"
#include "base/timing.h"
#include "base/units.h"
#include "daq/protocol/natnet_encode.h"
#include "daq/stream/network.h"
#include "daq/stream/udp_address.h"

#define WB_LOG_DOMAIN "scan"

#define PATIENCE_NS (1200 * WB_NS_PER_MS) /* per baud rate: two lines of a slow instrument */
#define REPLY_NS WB_NS_PER_S              /* time for NatNet servers to reply */
#define MOST_CARDS 32

/* --- ports --- */

bool wb_scan_add_port(struct wb_scan *scan, const char *address)
{
    if (scan->n_ports == WB_SCAN_PORTS || strlen(address) >= WB_SCAN_ADDRESS)
        return false;
    snprintf(scan->ports[scan->n_ports++].address, WB_SCAN_ADDRESS, "%s", address);
    return true;
}

/* Whether a port of the scan leads to the same device. */
static bool has_device(const struct wb_scan *scan, const char *path)
{
    char wanted[PATH_MAX], other[PATH_MAX];
    if (!realpath(path, wanted))
        return true;
    for (int i = 0; i < scan->n_ports; i++)
        if (realpath(strchr(scan->ports[i].address, ':') + 1, other) && strcmp(wanted, other) == 0)
            return true;
    return false;
}

void wb_scan_find_ports(struct wb_scan *scan)
{
    static const char *const patterns[] = {"/dev/serial/by-id/*", "/dev/ttyUSB*", "/dev/ttyACM*"};
    for (size_t k = 0; k < sizeof patterns / sizeof patterns[0]; k++) {
        glob_t found;
        if (glob(patterns[k], 0, NULL, &found) != 0)
            continue;
        for (size_t i = 0; i < found.gl_pathc; i++) {
            char address[WB_SCAN_ADDRESS];
            const int n = snprintf(address, sizeof address, "serial:%s", found.gl_pathv[i]);
            if (n < (int)sizeof address && !has_device(scan, found.gl_pathv[i]))
                (void)wb_scan_add_port(scan, address);
        }
        globfree(&found);
    }
}

void wb_scan_listen(struct wb_scan_port *port)
{
    const struct wb_listening_settings settings = {.asks = true, .patience_ns = PATIENCE_NS};
    if (wb_listening_run(port->address, &settings, &port->heard, &port->refused) != WB_OK &&
        !port->refused.text[0])
        wb_reason_set(&port->refused, "it cannot be opened");
}

const struct wb_scan_port *wb_scan_port_of(const struct wb_scan *scan,
                                           enum wb_listening_found found)
{
    for (int i = 0; i < scan->n_ports; i++)
        if (scan->ports[i].heard.found == found)
            return &scan->ports[i];
    return NULL;
}

/* --- servers --- */

static void ask(int descriptor, const char *host, int port)
{
    uint8_t bytes[512];
    struct sockaddr_in to = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
    const size_t n = wb_natnet_encode_connect(bytes, sizeof bytes, "wirebench", false);
    if (inet_pton(AF_INET, host, &to.sin_addr) == 1 &&
        sendto(descriptor, bytes, n, 0, (struct sockaddr *)&to, sizeof to) < 0)
        wb_debug("sending to %s failed: %s", host, strerror(errno));
}

/* Writes the server's address for a rig file; for multicast with the group and the interface. */
static void write_address(char address[WB_SCAN_ADDRESS], const struct sockaddr_in *from,
                          const struct wb_natnet_server *info)
{
    struct wb_network_card card;
    char host[INET_ADDRSTRLEN] = "";
    inet_ntop(AF_INET, &from->sin_addr, host, sizeof host);
    snprintf(address, WB_SCAN_ADDRESS, "udp:%s:%d", host, ntohs(from->sin_port));
    if (!info->has_connection || !info->multicast)
        return;
    const bool has_card = wb_network_towards(address, &card);
    const size_t n = strlen(address);
    snprintf(address + n, WB_SCAN_ADDRESS - n, ",group=%u.%u.%u.%u:%u%s%s", info->group[0],
             info->group[1], info->group[2], info->group[3], info->data_port,
             has_card ? ",interface=" : "", has_card ? card.address : "");
}

static void add_reply(struct wb_scan *scan, const uint8_t *bytes, size_t n,
                      const struct sockaddr_in *from)
{
    struct wb_natnet_packet packet;
    struct wb_natnet_fault fault = {0};
    struct wb_scan_server server = {.address = ""};
    if (wb_natnet_decode_packet(bytes, n, &packet, &fault) != WB_OK ||
        packet.message != WB_NATNET_SERVERINFO ||
        wb_natnet_decode_server(&packet, &server.info, &fault) != WB_OK)
        return;
    write_address(server.address, from, &server.info);
    for (int i = 0; i < scan->n_servers; i++)
        if (strcmp(scan->servers[i].address, server.address) == 0)
            return;
    if (scan->n_servers < WB_SCAN_SERVERS)
        scan->servers[scan->n_servers++] = server;
}

static enum wb_status ask_all(int descriptor, const char *address)
{
    struct wb_network_card cards[MOST_CARDS];
    struct wb_udp_address parsed;
    struct sockaddr_in host;
    char text[INET_ADDRSTRLEN];
    if (address) {
        WB_TRY(wb_udp_address_parse(address + strlen("udp:"), &parsed, NULL));
        WB_TRY(wb_udp_address_resolve(&parsed, &host, NULL));
        inet_ntop(AF_INET, &host.sin_addr, text, sizeof text);
        ask(descriptor, text, parsed.port);
        return WB_OK;
    }
    const size_t n = wb_network_cards(cards, MOST_CARDS);
    for (size_t i = 0; i < n; i++) {
        const struct wb_network_card *const card = &cards[i];
        if (card->is_loopback || card->broadcast[0])
            ask(descriptor, card->is_loopback ? card->address : card->broadcast,
                WB_NATNET_COMMAND_PORT);
    }
    return WB_OK;
}

enum wb_status wb_scan_find_servers(struct wb_scan *scan, const char *address)
{
    static uint8_t bytes[65536];
    const int on = 1, descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    const int64_t begun_ns = wb_time_now_ns();
    if (descriptor < 0)
        return wb_fail(WB_ERR_IO, "a socket to search for NatNet servers cannot be created: %s",
                       strerror(errno));
    (void)setsockopt(descriptor, SOL_SOCKET, SO_BROADCAST, &on, sizeof on);
    const enum wb_status status = ask_all(descriptor, address);
    while (status == WB_OK && wb_time_now_ns() - begun_ns < REPLY_NS && !wb_interrupted()) {
        struct pollfd polled = {.fd = descriptor, .events = POLLIN};
        struct sockaddr_in from;
        socklen_t size = sizeof from;
        (void)wb_time_wait(&polled, 1, wb_time_now_ns() + 50 * WB_NS_PER_MS);
        const ssize_t n =
            recvfrom(descriptor, bytes, sizeof bytes, 0, (struct sockaddr *)&from, &size);
        if (n <= 0)
            continue;
        add_reply(scan, bytes, (size_t)n, &from);
        /* Disconnect, or a unicast server would start to stream to this computer. */
        const size_t n_bye = wb_natnet_encode_empty(bytes, sizeof bytes, WB_NATNET_DISCONNECT);
        (void)sendto(descriptor, bytes, n_bye, 0, (struct sockaddr *)&from, size);
    }
    close(descriptor);
    return status;
}

bool wb_scan_is_complete(const struct wb_scan *scan)
{
    return wb_scan_port_of(scan, WB_LISTENING_LOAD_CELL) && scan->n_servers > 0 &&
           (wb_scan_port_of(scan, WB_LISTENING_GRBL) || wb_scan_port_of(scan, WB_LISTENING_TIC));
}
