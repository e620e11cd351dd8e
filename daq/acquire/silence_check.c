#include "daq/acquire/silence_check.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "daq/stream/network.h"
#include "daq/stream/udp_address.h"

static bool check_load(const struct wb_acquisition_latest *latest, const struct wb_rig *rig,
                       double waited, char text[WB_SILENCE_TEXT])
{
    const struct wb_acquisition_stream_state *const load = &latest->stream[WB_ROLE_LOAD];
    char sent[96], cause[WB_DIAGNOSIS_TEXT];
    if (latest->has_load)
        return true;
    snprintf(sent, sizeof sent, "no data within %g s", waited);
    if (load->bytes > 0)
        snprintf(sent, sizeof sent, "%" PRIu64 " bytes, but no reading that can be decoded",
                 load->bytes);
    wb_diagnosis_load(&load->heard, &latest->stream[WB_ROLE_STAGE].heard, rig, cause);
    snprintf(text, WB_SILENCE_TEXT, "the load cell at %s sent %s: %s", rig->load_cell.address, sent,
             cause);
    return false;
}

static bool check_stage(const struct wb_acquisition_latest *latest, const struct wb_rig *rig,
                        double waited, char text[WB_SILENCE_TEXT])
{
    const struct wb_acquisition_stream_state *const stage = &latest->stream[WB_ROLE_STAGE];
    char cause[WB_DIAGNOSIS_TEXT];
    if (stage->ready)
        return true;
    wb_diagnosis_stage(&stage->heard, rig, cause);
    snprintf(text, WB_SILENCE_TEXT,
             "the stage at %s sent no status within %g s (%" PRIu64 " bytes received): %s",
             rig->stage.address, waited, stage->bytes, cause);
    return false;
}

/* Appends the checks of this computer's network: interface of the multicast group and firewall. */
static void suggest_network_checks(const struct wb_rig *rig, char *text, size_t size)
{
    struct wb_network_card card;
    struct wb_udp_address address;
    struct wb_reason why = {0};
    if (wb_udp_address_parse(rig->mocap.address + strlen("udp:"), &address, &why) != WB_OK ||
        !wb_network_towards(rig->mocap.address, &card))
        return;
    if (!address.has_group)
        snprintf(text, size, ", and the firewall of this computer");
    else if (strcmp(address.interface, card.address) == 0 ||
             strcmp(address.interface, card.name) == 0)
        snprintf(text, size,
                 ", its multicast group, and that the firewall of this computer admits UDP port %d",
                 address.group_port);
    else
        snprintf(text, size,
                 ", and its multicast group: it is joined on %s, but the server is reached through "
                 "%s; write interface=%s in mocap.address, and admit UDP port %d in the firewall "
                 "of this computer",
                 address.interface[0] ? address.interface : "an interface chosen by the system",
                 card.name, card.address, address.group_port);
}

static bool check_mocap(const struct wb_acquisition_latest *latest, const struct wb_rig *rig,
                        double waited, char text[WB_SILENCE_TEXT])
{
    char card[320] = "";
    if (latest->has_mocap && latest->stream[WB_ROLE_MOCAP].ready)
        return true;
    if (latest->stream[WB_ROLE_MOCAP].bytes == 0) {
        snprintf(text, WB_SILENCE_TEXT,
                 "no NatNet reply from %s within %g s: check that the server streams, its address "
                 "and the firewall of its computer",
                 rig->mocap.address, waited);
        return false;
    }
    suggest_network_checks(rig, card, sizeof card);
    snprintf(text, WB_SILENCE_TEXT,
             "the NatNet server at %s replies but sent no frame within %g s: check that it streams "
             "live frames with labelled markers%s",
             rig->mocap.address, waited, card);
    return false;
}

bool wb_silence_check(enum wb_role role, const struct wb_acquisition_latest *latest,
                      const struct wb_rig *rig, double waited, char text[WB_SILENCE_TEXT])
{
    switch (role) {
    case WB_ROLE_LOAD:
        return check_load(latest, rig, waited, text);
    case WB_ROLE_STAGE:
        return check_stage(latest, rig, waited, text);
    case WB_ROLE_MOCAP:
        break;
    }
    return check_mocap(latest, rig, waited, text);
}
