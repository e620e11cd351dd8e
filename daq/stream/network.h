/* The network interfaces of this computer, and the one that routes to a server. */
#ifndef WB_DAQ_STREAM_NETWORK_H
#define WB_DAQ_STREAM_NETWORK_H

#include <stdbool.h>
#include <stddef.h>

struct wb_network_card {
    char name[32];      /* "eth0" */
    char address[16];   /* IPv4, "192.168.1.5" */
    char broadcast[16]; /* "192.168.1.255"; "" if the interface has none */
    bool is_loopback;
};

/* Lists the interfaces that are up and have an IPv4 address, at most `most`. Returns their number.
 */
size_t wb_network_cards(struct wb_network_card *cards, size_t most);

/* Finds the interface that routes to the server of an address `udp:HOST:PORT...`, without sending
 * anything. False: another kind of address, an unknown host, or no route. */
bool wb_network_towards(const char *address, struct wb_network_card *card);

#endif
