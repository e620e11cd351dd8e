/* The rig file of a scan. */
#include "daq/doctor/scan.h"

#include <string.h>

#include "daq/protocol/loadcell_preset.h"

static const char *const found_names[] = {
    [WB_LISTENING_NOTHING] =
        "sends no data by itself; neither a GRBL at 115200 baud nor a Tic at 9600",
    [WB_LISTENING_LOAD_CELL] = "sends readings",
    [WB_LISTENING_GRBL] = "a GRBL 1.1",
    [WB_LISTENING_OLD_GRBL] = "a GRBL before 1.1, which cannot jog: install GRBL 1.1",
    [WB_LISTENING_TIC] = "a Pololu Tic",
    [WB_LISTENING_UNKNOWN] = "sends bytes, but no lines of a load cell at any usual baud rate",
};

/* Comments: the findings at each port, and the servers that replied. */
static void write_findings(const struct wb_scan *scan, struct wb_text *text)
{
    for (int i = 0; i < scan->n_ports; i++) {
        const struct wb_scan_port *const port = &scan->ports[i];
        wb_text_append(text, "#   %s: %s", port->address,
                       port->refused.text[0] ? port->refused.text : found_names[port->heard.found]);
        if (port->heard.line[0])
            wb_text_append(text, ", %s", port->heard.line);
        if (port->heard.sample[0])
            wb_text_append(text, ", '%s'", port->heard.sample);
        wb_text_append(text, "\n");
    }
    for (int i = 0; i < scan->n_servers; i++) {
        const struct wb_natnet_server *const info = &scan->servers[i].info;
        wb_text_append(text, "#   %s: NatNet %u.%u, %s\n", scan->servers[i].address,
                       info->natnet_version[0], info->natnet_version[1],
                       info->has_connection && info->multicast ? "multicast" : "unicast");
    }
    if (scan->n_ports + scan->n_servers == 0)
        wb_text_append(text, "#   nothing: check the cables and the permission to open ports\n");
}

/* Instruments whose makers set this baud rate and frame. */
static void write_presets(const char *line, struct wb_text *text)
{
    const struct wb_loadcell_preset *preset;
    bool first = true;
    for (size_t i = 0; (preset = wb_loadcell_preset_at(i)); i++) {
        if (!preset->line || strcmp(preset->line, line) != 0)
            continue;
        wb_text_append(text, "%s%s", first ? "  # preset: if it is one of " : ", ", preset->name);
        first = false;
    }
    if (!first)
        wb_text_append(text, "\n");
}

static void write_load_cell(const struct wb_scan *scan, struct wb_text *text)
{
    const struct wb_scan_port *const port = wb_scan_port_of(scan, WB_LISTENING_LOAD_CELL);
    wb_text_append(text, "load_cell:\n");
    if (port)
        wb_text_append(text, "  address: \"%s,%s\"\n", port->address, port->heard.line);
    else
        wb_text_append(text,
                       "  address: FILL IN  # serial:PORT,BAUD,8n1; a scan does not find a cell "
                       "that must be polled\n");
    wb_text_append(text, "  protocol: generic\n");
    if (port)
        write_presets(port->heard.line, text);
    wb_text_append(text,
                   "  # unit: g  # if its lines have none\n"
                   "  capacity_g: FILL IN  # on its label\n"
                   "  overload_percent: 100  # of the capacity: largest reading\n"
                   "  serial_number: FILL IN\n"
                   "  calibration_date: FILL IN  # 2026-01-15\n"
                   "  filter_delay_ms: FILL IN  # of the instrument's filter: its manual\n"
                   "  filter_delay_uncertainty_ms: FILL IN\n"
                   "  # noise_mg: 10  # noise at rest; doctor shows it in mN (1 mN is 102 mg)\n"
                   "  # check_mass_g: 10  # a known mass for 'wirebench stage RIG.yaml check'\n"
                   "  # sign: +1  # -1 if tension reads negative\n");
}

static void write_mocap(const struct wb_scan *scan, struct wb_text *text)
{
    wb_text_append(text, "mocap:\n");
    if (scan->n_servers > 0)
        wb_text_append(text, "  address: \"%s\"\n", scan->servers[0].address);
    else
        wb_text_append(text, "  address: FILL IN  # udp:HOST:1510,group=239.255.42.99:1511; no "
                             "server replied: check that Motive streams, and its firewall\n");
    wb_text_append(text, "  protocol: natnet\n"
                         "  up: FILL IN  # y or z: Up axis in Motive's streaming settings; not "
                         "part of the stream\n"
                         "  # marker_noise_mm: 0.1\n"
                         "  # frame_rate_hz: 120\n");
}

static void write_stage(const struct wb_scan *scan, struct wb_text *text)
{
    const struct wb_scan_port *const tic = wb_scan_port_of(scan, WB_LISTENING_TIC);
    const struct wb_scan_port *const grbl = wb_scan_port_of(scan, WB_LISTENING_GRBL);
    const struct wb_scan_port *const port = grbl ? grbl : tic;
    wb_text_append(text, "stage:\n");
    if (port)
        wb_text_append(text, "  address: \"%s,%s\"\n", port->address, port->heard.line);
    else
        wb_text_append(text, "  address: FILL IN  # serial:PORT,115200,8n1\n");
    wb_text_append(text, "  protocol: %s\n", port && !grbl ? "tic" : "grbl");
    if (port && !grbl)
        wb_text_append(text, "  steps_per_mm: FILL IN  # microsteps: jog 50 mm and measure\n");
    else
        wb_text_append(text, "  axis: FILL IN  # X, Y or Z\n");
    wb_text_append(text, "  down: FILL IN  # +1 or -1: sign of the axis when the clamp moves down\n"
                         "  travel_mm: FILL IN  # free travel down from the start position\n"
                         "  speed_mm_s: 1\n");
}

void wb_scan_write_rig(const struct wb_scan *scan, struct wb_text *text)
{
    wb_text_append(
        text, "# Draft of a rig file. Replace every FILL IN; until then the file is rejected.\n"
              "# Keys: docs/file-formats.md. Then run 'wirebench doctor' with it.\n"
              "# Found:\n");
    write_findings(scan, text);
    wb_text_append(text, "name: my bench\n");
    write_load_cell(scan, text);
    write_mocap(scan, text);
    write_stage(scan, text);
    wb_text_append(text, "# strand:  # between the tip and the load cell\n"
                         "#   length_mm: 760\n"
                         "#   counterweight_g: 2.7\n"
                         "limits:\n"
                         "  force_mN: FILL IN  # a force that harms neither wire nor load cell\n"
                         "  travel_mm: FILL IN  # largest travel of a test\n"
                         "  stream_lost_s: 1\n");
}
