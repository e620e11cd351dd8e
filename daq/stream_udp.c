/* UDP: unicast to and from one host, or commands to a host and data from a multicast group (or
 * broadcast). Sockets are not connected: a server may send data from another of its ports. */
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/progress.h"
#include "daq/stream_kind.h"
#include "daq/stream_line.h"

#define WB_LOG_DOMAIN "stream"

/* A frame of 300 markers takes 15 kB; this holds seconds of them while the host stalls. */
#define RECEIVE_BUFFER_BYTES (8 << 20)

struct udp_state {
    int command;             /* socket to and from the server */
    int data;                /* socket of the group; -1 without one */
    struct sockaddr_in host; /* where commands go */
    bool any_source;         /* the host is a broadcast or multicast address */
    bool warned_source;
    uint32_t drops[2]; /* the kernel's counters of command and data */
    char name[160];
};

struct udp_address {
    char host[128];
    int port;
    bool has_group;
    struct in_addr group;
    int group_port;
    char interface[64];
};

/* "HOST:PORT" */
static bool split_host_port(const char *text, size_t n, char *host, size_t size, int *port)
{
    const char *colon = memrchr(text, ':', n);
    if (!colon || colon == text || (size_t)(colon - text) >= size)
        return false;
    size_t digits = n - (size_t)(colon + 1 - text);
    if (digits == 0 || digits > 5 || strspn(colon + 1, "0123456789") < digits)
        return false;
    *port = atoi(colon + 1);
    if (*port < 1 || *port > 65535)
        return false;
    memcpy(host, text, (size_t)(colon - text));
    host[colon - text] = '\0';
    return true;
}

static bool parse_group(const char *text, size_t n, struct udp_address *address)
{
    char group[64];
    if (!split_host_port(text, n, group, sizeof group, &address->group_port) ||
        inet_pton(AF_INET, group, &address->group) != 1)
        return false;
    uint32_t bits = ntohl(address->group.s_addr);
    address->has_group = true;
    return IN_MULTICAST(bits) || bits == INADDR_BROADCAST;
}

static enum wb_status parse_address(const char *rest, struct udp_address *address)
{
    memset(address, 0, sizeof *address);
    size_t n = strcspn(rest, ",");
    if (!split_host_port(rest, n, address->host, sizeof address->host, &address->port))
        return wb_fail(WB_ERR_ARGUMENT, "'udp:%s' names no host and port: expected udp:HOST:PORT",
                       rest);
    const char *at = rest + n;
    while (*at == ',') {
        n = strcspn(++at, ",");
        if (strncmp(at, "group=", 6) == 0) {
            if (!parse_group(at + 6, n - 6, address))
                return wb_fail(WB_ERR_ARGUMENT,
                               "'%.*s' is not a multicast group: expected group=ADDRESS:PORT such "
                               "as group=239.255.42.99:1511",
                               (int)n, at);
        } else if (strncmp(at, "interface=", 10) == 0 && n > 10 &&
                   n - 10 < sizeof address->interface) {
            memcpy(address->interface, at + 10, n - 10);
            address->interface[n - 10] = '\0';
        } else {
            return wb_fail(WB_ERR_ARGUMENT,
                           "'%.*s' in 'udp:%s' is not known: expected group=ADDRESS:PORT or "
                           "interface=ADDRESS",
                           (int)n, at, rest);
        }
        at += n;
    }
    return WB_OK;
}

static enum wb_status resolve_host(const struct udp_address *address, struct sockaddr_in *host)
{
    struct addrinfo want = {.ai_family = AF_INET, .ai_socktype = SOCK_DGRAM};
    struct addrinfo *found = NULL;
    int code = getaddrinfo(address->host, NULL, &want, &found);
    if (code != 0 || !found)
        return wb_fail(WB_ERR_NOT_FOUND,
                       "host '%s' is not known: %s: check mocap.address and the network",
                       address->host, gai_strerror(code));
    memcpy(host, found->ai_addr, sizeof *host);
    host->sin_port = htons((uint16_t)address->port);
    freeaddrinfo(found);
    return WB_OK;
}

static enum wb_status open_socket(int *out)
{
    int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (descriptor < 0)
        return wb_fail(WB_ERR_IO, "no socket: %s", strerror(errno));
    int on = 1, size = RECEIVE_BUFFER_BYTES;
    /* Beyond the system's limit only root may go; the plain option takes what is allowed. */
    if (setsockopt(descriptor, SOL_SOCKET, SO_RCVBUFFORCE, &size, sizeof size) != 0 &&
        setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &size, sizeof size) != 0)
        wb_debug("receive buffer stays as it is: %s", strerror(errno));
    if (setsockopt(descriptor, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on) != 0)
        wb_debug("dropped datagrams will not be counted: %s", strerror(errno));
    if (setsockopt(descriptor, SOL_SOCKET, SO_BROADCAST, &on, sizeof on) != 0)
        wb_debug("broadcasts cannot be sent: %s", strerror(errno));
    *out = descriptor;
    return WB_OK;
}

/* Finds the interface by address or by name. */
static enum wb_status find_interface(const struct udp_address *address, struct ip_mreqn *request)
{
    memset(request, 0, sizeof *request);
    request->imr_multiaddr = address->group;
    if (!address->interface[0] ||
        inet_pton(AF_INET, address->interface, &request->imr_address) == 1)
        return WB_OK;
    request->imr_ifindex = (int)if_nametoindex(address->interface);
    if (request->imr_ifindex == 0)
        return wb_fail(WB_ERR_NOT_FOUND,
                       "network interface '%s' does not exist: expected its address or a name as "
                       "in 'ip address'",
                       address->interface);
    return WB_OK;
}

static enum wb_status join_group(int descriptor, const struct udp_address *address)
{
    int on = 1, off = 0;
    bool multicast = IN_MULTICAST(ntohl(address->group.s_addr));
    struct sockaddr_in bound = {.sin_family = AF_INET,
                                .sin_port = htons((uint16_t)address->group_port)};
    /* Bound to the group itself, the socket hears no other group on the same port. */
    if (multicast)
        bound.sin_addr = address->group;
    if (setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) != 0 ||
        bind(descriptor, (struct sockaddr *)&bound, sizeof bound) != 0)
        return wb_fail(
            errno == EADDRINUSE ? WB_ERR_BUSY : WB_ERR_IO,
            "port %d of the data group cannot be used: %s: does another program listen there?",
            address->group_port, strerror(errno));
    if (!multicast)
        return WB_OK;
    struct ip_mreqn request;
    WB_TRY(find_interface(address, &request));
    if (setsockopt(descriptor, IPPROTO_IP, IP_MULTICAST_ALL, &off, sizeof off) != 0)
        wb_debug("other groups may be heard: %s", strerror(errno));
    if (setsockopt(descriptor, IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request) != 0)
        return wb_fail(WB_ERR_IO,
                       "the multicast group cannot be joined%s%s: %s; name the network card "
                       "towards the server with interface=ADDRESS",
                       address->interface[0] ? " on " : "", address->interface, strerror(errno));
    return WB_OK;
}

static void udp_close(void *state)
{
    struct udp_state *udp = state;
    if (udp->data >= 0)
        close(udp->data);
    if (udp->command >= 0)
        close(udp->command);
}

static enum wb_status udp_open(void *state, const char *rest)
{
    struct udp_state *udp = state;
    struct udp_address address;
    udp->command = udp->data = -1;
    WB_TRY(parse_address(rest, &address));
    WB_TRY(resolve_host(&address, &udp->host));
    snprintf(udp->name, sizeof udp->name, "%s:%d", address.host, address.port);
    uint32_t bits = ntohl(udp->host.sin_addr.s_addr);
    udp->any_source = IN_MULTICAST(bits) || (bits & 0xff) == 0xff;
    enum wb_status status = open_socket(&udp->command);
    if (status == WB_OK) {
        struct sockaddr_in any = {.sin_family = AF_INET};
        if (bind(udp->command, (struct sockaddr *)&any, sizeof any) != 0)
            status = wb_fail(WB_ERR_IO, "no port for '%s': %s", udp->name, strerror(errno));
    }
    if (status == WB_OK && address.has_group)
        status = open_socket(&udp->data);
    if (status == WB_OK && address.has_group)
        status = join_group(udp->data, &address);
    if (status != WB_OK)
        udp_close(udp);
    return status;
}

static int udp_descriptors(const void *state, int descriptors[2])
{
    const struct udp_state *udp = state;
    descriptors[0] = udp->command;
    if (udp->data < 0)
        return 1;
    descriptors[1] = udp->data;
    return 2;
}

/* The kernel's counter of datagrams it dropped comes with each datagram after the loss. */
static void note_drops(struct msghdr *message, uint32_t *drops)
{
    for (struct cmsghdr *c = CMSG_FIRSTHDR(message); c; c = CMSG_NXTHDR(message, c)) {
        if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SO_RXQ_OVFL)
            memcpy(drops, CMSG_DATA(c), sizeof *drops);
    }
}

/* One datagram of one socket; *from tells who sent it. *n is -1 when nothing waits. */
static enum wb_status receive_one(struct udp_state *udp, int which, struct iovec *space,
                                  struct sockaddr_in *from, ssize_t *n)
{
    int descriptor = which ? udp->data : udp->command;
    union {
        char bytes[CMSG_SPACE(sizeof(uint32_t))];
        struct cmsghdr align;
    } control;
    for (;;) {
        struct msghdr message = {.msg_name = from,
                                 .msg_namelen = sizeof *from,
                                 .msg_iov = space,
                                 .msg_iovlen = 1,
                                 .msg_control = &control,
                                 .msg_controllen = sizeof control};
        *n = recvmsg(descriptor, &message, 0);
        if (*n >= 0) {
            note_drops(&message, &udp->drops[which]);
            return WB_OK;
        }
        if (errno == EAGAIN)
            return WB_OK;
        /* An answer of the network to an earlier send ("no such port") is not the stream's end. */
        if (errno != EINTR && errno != ECONNREFUSED && errno != EHOSTUNREACH &&
            errno != ENETUNREACH)
            return wb_fail(WB_ERR_IO, "receiving from '%s' failed: %s", udp->name, strerror(errno));
    }
}

static bool from_server(struct udp_state *udp, const struct sockaddr_in *from)
{
    if (udp->any_source || from->sin_addr.s_addr == udp->host.sin_addr.s_addr)
        return true;
    if (!udp->warned_source) {
        char text[INET_ADDRSTRLEN] = "";
        inet_ntop(AF_INET, &from->sin_addr, text, sizeof text);
        wb_warn("datagrams from %s are ignored: expected them from '%s', as mocap.address has it",
                text, udp->name);
        udp->warned_source = true;
    }
    return false;
}

static enum wb_status udp_read(void *state, void *buffer, size_t size, size_t *n)
{
    struct udp_state *udp = state;
    struct iovec space = {.iov_base = buffer, .iov_len = size};
    *n = 0;
    for (int which = 0; which < (udp->data >= 0 ? 2 : 1); which++) {
        ssize_t got = 0;
        while (got >= 0) {
            struct sockaddr_in from = {0};
            WB_TRY(receive_one(udp, which, &space, &from, &got));
            /* Empty datagrams carry nothing and would read as "nothing waits". */
            if (got > 0 && (which == 1 || from_server(udp, &from))) {
                *n = (size_t)got;
                return WB_OK;
            }
        }
    }
    return WB_OK;
}

static enum wb_status udp_write(void *state, const void *bytes, size_t n)
{
    struct udp_state *udp = state;
    int64_t deadline_ns = wb_progress_now_ns() + WB_STREAM_WRITE_TIMEOUT_NS;
    for (;;) {
        ssize_t put =
            sendto(udp->command, bytes, n, 0, (struct sockaddr *)&udp->host, sizeof udp->host);
        if (put >= 0)
            return WB_OK;
        if (errno == EINTR)
            continue;
        if (errno != EAGAIN && errno != ENOBUFS)
            return wb_fail(WB_ERR_IO, "sending to '%s' failed: %s", udp->name, strerror(errno));
        if (!wb_stream_wait_writable(udp->command, deadline_ns))
            return wb_fail(WB_ERR_TIMEOUT, "'%s' took no datagram within 50 ms", udp->name);
    }
}

static uint64_t udp_kernel_drops(const void *state)
{
    const struct udp_state *udp = state;
    return (uint64_t)udp->drops[0] + udp->drops[1];
}

const struct wb_stream_kind wb_stream_udp = {
    .scheme = "udp",
    .state_size = sizeof(struct udp_state),
    .open = udp_open,
    .close = udp_close,
    .descriptors = udp_descriptors,
    .read = udp_read,
    .write = udp_write,
    .kernel_drops = udp_kernel_drops,
};
