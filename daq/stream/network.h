/* The network cards of this computer, and which of them leads to a server. */
#ifndef WB_DAQ_STREAM_NETWORK_H
#define WB_DAQ_STREAM_NETWORK_H

#include <stdbool.h>
#include <stddef.h>

struct wb_network_card {
    char name[32];      /* "eth0" */
    char address[16];   /* IPv4, "192.168.1.5" */
    char broadcast[16]; /* "192.168.1.255"; "" none */
    bool is_loopback;
};

/* The cards that are up and have an address, at most `most`; returns how many. */
size_t wb_network_cards(struct wb_network_card *cards, size_t most);

/* The card by which this computer reaches the server of an address `udp:HOST:PORT...`. False:
 * another kind of address, a host that is not known, or no way to it. Sends nothing. */
bool wb_network_towards(const char *address, struct wb_network_card *card);

#endif
