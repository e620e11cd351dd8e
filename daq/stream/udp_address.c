#include "daq/stream/udp_address.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <stdlib.h>
#include <string.h>

#define WB_LOG_DOMAIN "stream"

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

static bool parse_group(const char *text, size_t n, struct wb_udp_address *address)
{
    char group[64];
    if (!split_host_port(text, n, group, sizeof group, &address->group_port) ||
        inet_pton(AF_INET, group, &address->group) != 1)
        return false;
    uint32_t bits = ntohl(address->group.s_addr);
    address->has_group = true;
    return IN_MULTICAST(bits) || bits == INADDR_BROADCAST;
}

enum wb_status wb_udp_address_parse(const char *rest, struct wb_udp_address *address,
                                    struct wb_reason *why)
{
    memset(address, 0, sizeof *address);
    size_t n = strcspn(rest, ",");
    if (!split_host_port(rest, n, address->host, sizeof address->host, &address->port))
        return wb_fail_to(why, WB_ERR_ARGUMENT,
                          "'udp:%s' has no host and port: expected udp:HOST:PORT", rest);
    const char *at = rest + n;
    while (*at == ',') {
        n = strcspn(++at, ",");
        if (strncmp(at, "group=", 6) == 0) {
            if (!parse_group(at + 6, n - 6, address))
                return wb_fail_to(
                    why, WB_ERR_ARGUMENT,
                    "'%.*s' is not a multicast group: expected group=ADDRESS:PORT such "
                    "as group=239.255.42.99:1511",
                    (int)n, at);
        } else if (strncmp(at, "interface=", 10) == 0 && n > 10 &&
                   n - 10 < sizeof address->interface) {
            memcpy(address->interface, at + 10, n - 10);
            address->interface[n - 10] = '\0';
        } else {
            return wb_fail_to(why, WB_ERR_ARGUMENT,
                              "unknown option '%.*s' in 'udp:%s': expected group=ADDRESS:PORT or "
                              "interface=ADDRESS",
                              (int)n, at, rest);
        }
        at += n;
    }
    return WB_OK;
}

enum wb_status wb_udp_address_resolve(const struct wb_udp_address *address,
                                      struct sockaddr_in *host, struct wb_reason *why)
{
    struct addrinfo want = {.ai_family = AF_INET, .ai_socktype = SOCK_DGRAM};
    struct addrinfo *found = NULL;
    int code = getaddrinfo(address->host, NULL, &want, &found);
    if (code != 0 || !found)
        return wb_fail_to(why, WB_ERR_NOT_FOUND,
                          "host '%s' cannot be resolved: %s; check mocap.address and the network",
                          address->host, gai_strerror(code));
    memcpy(host, found->ai_addr, sizeof *host);
    host->sin_port = htons((uint16_t)address->port);
    freeaddrinfo(found);
    return WB_OK;
}
