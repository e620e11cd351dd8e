/* Searches for the instruments connected to this computer and writes a draft of a rig file. */
#ifndef WB_DAQ_DOCTOR_SCAN_H
#define WB_DAQ_DOCTOR_SCAN_H

#include <stdbool.h>
#include <stddef.h>

#include "base/reason.h"
#include "base/text.h"
#include "daq/acquire/listening.h"
#include "daq/protocol/natnet.h"

#define WB_SCAN_PORTS 32
#define WB_SCAN_SERVERS 8
#define WB_SCAN_ADDRESS 256

struct wb_scan_port {
    char address[WB_SCAN_ADDRESS]; /* "serial:/dev/serial/by-id/..." */
    struct wb_listening heard;
    struct wb_reason refused; /* why the port could not be used; "": it could */
};

struct wb_scan_server {
    char address[WB_SCAN_ADDRESS]; /* for mocap.address: with group and interface */
    struct wb_natnet_server info;
};

/* All zero: empty. */
struct wb_scan {
    int n_ports, n_servers;
    struct wb_scan_port ports[WB_SCAN_PORTS];
    struct wb_scan_server servers[WB_SCAN_SERVERS];
};

/* Adds the serial ports of USB adapters: by their link in /dev/serial/by-id, or without a link as
 * /dev/ttyUSB* or /dev/ttyACM*. */
void wb_scan_find_ports(struct wb_scan *scan);

/* Adds one port by its address, `serial:PATH` or `pty:PATH`. False: the list is full. */
bool wb_scan_add_port(struct wb_scan *scan, const char *address);

/* Identifies the instrument at a port; also sends status queries (daq/acquire/listening.h). */
void wb_scan_listen(struct wb_scan_port *port);

/* Searches for NatNet servers for a second: by broadcast on every network interface or, if
 * `address`
 * (`udp:HOST:PORT`) is not NULL, at this address only. Adds the servers that reply. */
WB_MUST_CHECK enum wb_status wb_scan_find_servers(struct wb_scan *scan, const char *address);

/* The first port at which this instrument was found; NULL: none. */
const struct wb_scan_port *wb_scan_port_of(const struct wb_scan *scan,
                                           enum wb_listening_found found);

/* Whether all three instruments of a bench were found. */
bool wb_scan_is_complete(const struct wb_scan *scan);

/* Appends the rig file. Unknown values are written as FILL IN, which rig files do not accept as a
 * value, with a comment that explains the value. */
void wb_scan_write_rig(const struct wb_scan *scan, struct wb_text *text);

#endif
