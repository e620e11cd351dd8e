#include "daq/stream/network.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "daq/stream/udp_address.h"

#define MOST_CARDS 32

static void write_address(char text[16], const struct sockaddr *address)
{
    struct sockaddr_in inet;
    memcpy(&inet, address, sizeof inet);
    inet_ntop(AF_INET, &inet.sin_addr, text, 16);
}

size_t wb_network_cards(struct wb_network_card *cards, size_t most)
{
    struct ifaddrs *list = NULL;
    size_t n = 0;
    if (getifaddrs(&list) != 0)
        return 0;
    for (const struct ifaddrs *at = list; at && n < most; at = at->ifa_next) {
        if (!at->ifa_addr || at->ifa_addr->sa_family != AF_INET || !(at->ifa_flags & IFF_UP))
            continue;
        struct wb_network_card *const card = &cards[n++];
        memset(card, 0, sizeof *card);
        strncpy(card->name, at->ifa_name, sizeof card->name - 1);
        write_address(card->address, at->ifa_addr);
        card->is_loopback = at->ifa_flags & IFF_LOOPBACK;
        if ((at->ifa_flags & IFF_BROADCAST) && at->ifa_broadaddr)
            write_address(card->broadcast, at->ifa_broadaddr);
    }
    freeifaddrs(list);
    return n;
}

/* The source address that the kernel would choose. connect() on a UDP socket sends nothing. */
static bool find_source(const struct sockaddr_in *host, char address[16])
{
    struct sockaddr_storage own;
    socklen_t size = sizeof own;
    const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const bool found = descriptor >= 0 &&
                       connect(descriptor, (const struct sockaddr *)host, sizeof *host) == 0 &&
                       getsockname(descriptor, (struct sockaddr *)&own, &size) == 0;
    if (descriptor >= 0)
        close(descriptor);
    if (found)
        write_address(address, (const struct sockaddr *)&own);
    return found;
}

bool wb_network_towards(const char *address, struct wb_network_card *card)
{
    struct wb_network_card cards[MOST_CARDS];
    struct wb_udp_address parsed;
    struct sockaddr_in host;
    struct wb_reason why = {0};
    char source[16];
    if (strncmp(address, "udp:", 4) != 0 ||
        wb_udp_address_parse(address + 4, &parsed, &why) != WB_OK ||
        wb_udp_address_resolve(&parsed, &host, &why) != WB_OK || !find_source(&host, source))
        return false;
    const size_t n = wb_network_cards(cards, MOST_CARDS);
    for (size_t i = 0; i < n; i++) {
        if (strcmp(cards[i].address, source) == 0) {
            *card = cards[i];
            return true;
        }
    }
    return false;
}
