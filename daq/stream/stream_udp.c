/* UDP: unicast to and from one host, or commands to a host and data from a multicast group (or
 * broadcast). Sockets are not connected: a server may send data from another of its ports. */
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <net/if.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/timing.h"
#include "daq/stream/stream_kind.h"
#include "daq/stream/stream_line.h"
#include "daq/stream/udp_address.h"

#define WB_LOG_DOMAIN "stream"

/* Receive buffer of a socket. A frame of 300 markers takes 15 kB: at 100 Hz the buffer holds more
 * than 5 s while the host stalls. */
#define RECEIVE_BUFFER_BYTES (8 << 20)

struct udp_state {
    int command;             /* socket to and from the server */
    int data;                /* socket of the group; -1: no group */
    struct sockaddr_in host; /* destination of commands */
    bool any_source;         /* the host is a broadcast or multicast address */
    bool warned_source;
    uint32_t drops[2]; /* dropped datagrams by the kernel's counters: command, data */
    char name[160];
};

static enum wb_status open_socket(int *out, struct wb_reason *why)
{
    int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (descriptor < 0)
        return wb_fail_to(why, WB_ERR_IO, "a UDP socket cannot be created: %s", strerror(errno));
    int on = 1, size = RECEIVE_BUFFER_BYTES;
    /* Only root may exceed the system's limit; SO_RCVBUF is clamped to the limit. */
    if (setsockopt(descriptor, SOL_SOCKET, SO_RCVBUFFORCE, &size, sizeof size) != 0 &&
        setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &size, sizeof size) != 0)
        wb_debug("the receive buffer cannot be enlarged: %s", strerror(errno));
    if (setsockopt(descriptor, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on) != 0)
        wb_debug("dropped datagrams will not be counted: %s", strerror(errno));
    if (setsockopt(descriptor, SOL_SOCKET, SO_BROADCAST, &on, sizeof on) != 0)
        wb_debug("broadcasts cannot be sent: %s", strerror(errno));
    *out = descriptor;
    return WB_OK;
}

/* Finds the interface by address or by name. */
static enum wb_status find_interface(const struct wb_udp_address *address, struct ip_mreqn *request,
                                     struct wb_reason *why)
{
    memset(request, 0, sizeof *request);
    request->imr_multiaddr = address->group;
    if (!address->interface[0] ||
        inet_pton(AF_INET, address->interface, &request->imr_address) == 1)
        return WB_OK;
    request->imr_ifindex = (int)if_nametoindex(address->interface);
    if (request->imr_ifindex == 0)
        return wb_fail_to(
            why, WB_ERR_NOT_FOUND,
            "network interface '%s' does not exist: expected its address or a name as "
            "in 'ip address'",
            address->interface);
    return WB_OK;
}

static enum wb_status join_group(int descriptor, const struct wb_udp_address *address,
                                 struct wb_reason *why)
{
    int on = 1, off = 0;
    bool multicast = IN_MULTICAST(ntohl(address->group.s_addr));
    struct sockaddr_in bound = {.sin_family = AF_INET,
                                .sin_port = htons((uint16_t)address->group_port)};
    /* A socket bound to the group's address receives no other group on the same port. */
    if (multicast)
        bound.sin_addr = address->group;
    if (setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) != 0 ||
        bind(descriptor, (struct sockaddr *)&bound, sizeof bound) != 0)
        return wb_fail_to(
            why, errno == EADDRINUSE ? WB_ERR_BUSY : WB_ERR_IO,
            "port %d of the data group cannot be used: %s; check whether another program uses it",
            address->group_port, strerror(errno));
    if (!multicast)
        return WB_OK;
    struct ip_mreqn request;
    WB_TRY(find_interface(address, &request, why));
    if (setsockopt(descriptor, IPPROTO_IP, IP_MULTICAST_ALL, &off, sizeof off) != 0)
        wb_debug("datagrams of other groups may be received: %s", strerror(errno));
    if (setsockopt(descriptor, IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request) != 0)
        return wb_fail_to(
            why, WB_ERR_IO,
            "the multicast group cannot be joined%s%s: %s; give the network interface "
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

static enum wb_status udp_open(void *state, const char *rest, struct wb_reason *why)
{
    struct udp_state *udp = state;
    struct wb_udp_address address;
    udp->command = udp->data = -1;
    WB_TRY(wb_udp_address_parse(rest, &address, why));
    WB_TRY(wb_udp_address_resolve(&address, &udp->host, why));
    snprintf(udp->name, sizeof udp->name, "%s:%d", address.host, address.port);
    uint32_t bits = ntohl(udp->host.sin_addr.s_addr);
    udp->any_source = IN_MULTICAST(bits) || (bits & 0xff) == 0xff;
    enum wb_status status = open_socket(&udp->command, why);
    if (status == WB_OK) {
        struct sockaddr_in any = {.sin_family = AF_INET};
        if (bind(udp->command, (struct sockaddr *)&any, sizeof any) != 0)
            status = wb_fail_to(why, WB_ERR_IO, "no local port can be bound for '%s': %s",
                                udp->name, strerror(errno));
    }
    if (status == WB_OK && address.has_group)
        status = open_socket(&udp->data, why);
    if (status == WB_OK && address.has_group)
        status = join_group(udp->data, &address, why);
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

/* After a loss, every datagram carries the kernel's counter of dropped datagrams. */
static void note_drops(struct msghdr *message, uint32_t *drops)
{
    for (struct cmsghdr *c = CMSG_FIRSTHDR(message); c; c = CMSG_NXTHDR(message, c)) {
        if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SO_RXQ_OVFL)
            memcpy(drops, CMSG_DATA(c), sizeof *drops);
    }
}

/* Receives one datagram from one socket; *from is its sender. *n is -1 if nothing is pending. */
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
        /* ICMP errors caused by an earlier send ("port unreachable") do not end the stream. */
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
        wb_warn("datagrams from %s are ignored: mocap.address expects them from '%s'", text,
                udp->name);
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
            /* An empty datagram would read as "nothing pending". */
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
    int64_t deadline_ns = wb_time_now_ns() + WB_STREAM_WRITE_TIMEOUT_NS;
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
            return wb_fail(WB_ERR_TIMEOUT, "no datagram could be sent to '%s' within 50 ms",
                           udp->name);
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
