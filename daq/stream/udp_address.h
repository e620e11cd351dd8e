/* Addresses `udp:HOST:PORT[,group=ADDR:PORT][,interface=ADDR]`: see daq/stream/stream.h. */
#ifndef WB_DAQ_STREAM_UDP_ADDRESS_H
#define WB_DAQ_STREAM_UDP_ADDRESS_H

#include <netinet/in.h>
#include <stdbool.h>

#include "base/reason.h"

struct wb_udp_address {
    char host[128];
    int port;
    bool has_group;
    struct in_addr group;
    int group_port;
    char interface[64]; /* address or name of the interface to join on; "": the system's choice */
};

/* Parses the address after "udp:". `why` holds the message of a failure; NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_udp_address_parse(const char *rest, struct wb_udp_address *address,
                                                  struct wb_reason *why);

/* Resolves the host name and sets address and port of `host`. */
WB_MUST_CHECK enum wb_status wb_udp_address_resolve(const struct wb_udp_address *address,
                                                    struct sockaddr_in *host,
                                                    struct wb_reason *why);

#endif
