/* The network interfaces of this computer, and the interface through which a server is reached. */
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

/* Writes the interfaces that are up and have an IPv4 address into `cards`, which has space for
 * `most`. Returns the number written; 0 if the system cannot list them. */
size_t wb_network_cards(struct wb_network_card *cards, size_t most);

/* Finds the interface through which the server of an address `udp:HOST:PORT...` is reached. Sends
 * no packet to that server. False: not an address of this form, unknown host, or no route. */
bool wb_network_towards(const char *address, struct wb_network_card *card);

#endif
