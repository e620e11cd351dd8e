/* What instruments are connected to this computer, and a first rig file that names them. */
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
    struct wb_reason refused; /* why it could not be listened to; "" it was */
};

struct wb_scan_server {
    char address[WB_SCAN_ADDRESS]; /* as mocap.address: with group and network card */
    struct wb_natnet_server info;
};

/* All zero is empty. */
struct wb_scan {
    int n_ports, n_servers;
    struct wb_scan_port ports[WB_SCAN_PORTS];
    struct wb_scan_server servers[WB_SCAN_SERVERS];
};

/* Adds the serial ports of this computer that have a USB adapter behind them: by their links in
 * /dev/serial/by-id, or where they have none as /dev/ttyUSB*, /dev/ttyACM*. */
void wb_scan_find_ports(struct wb_scan *scan);

/* Adds one port by its address, `serial:PATH` or `pty:PATH`. False: no room. */
bool wb_scan_add_port(struct wb_scan *scan, const char *address);

/* Listens to a port, and asks whether it is a stage (daq/acquire/listening.h). */
void wb_scan_listen(struct wb_scan_port *port);

/* Asks for NatNet servers for a second: on every network card by broadcast, or where `address`
 * (`udp:HOST:PORT`) is not NULL that one alone; adds those that answer. */
WB_MUST_CHECK enum wb_status wb_scan_find_servers(struct wb_scan *scan, const char *address);

/* The first port at which this was heard; NULL. */
const struct wb_scan_port *wb_scan_port_of(const struct wb_scan *scan,
                                           enum wb_listening_found found);

/* All three instruments of a bench were found. */
bool wb_scan_is_complete(const struct wb_scan *scan);

/* Appends the rig file. What cannot be known stands there as FILL IN, which no reader of a rig file
 * takes for a number, with what belongs there. */
void wb_scan_write_rig(const struct wb_scan *scan, struct wb_text *text);

#endif
