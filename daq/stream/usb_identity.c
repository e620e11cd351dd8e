#include "daq/stream/usb_identity.h"

#include <string.h>

static bool is_same(const struct wb_usb_identity *a, const struct wb_usb_identity *b)
{
    return b->is_usb && a->vendor == b->vendor && a->product == b->product &&
           strcmp(a->serial, b->serial) == 0;
}

int wb_usb_identity_find(const struct wb_usb_identity *wanted, const struct wb_usb_identity *list,
                         int n)
{
    int found = -1, n_found = 0;
    for (int i = 0; i < n; i++) {
        const bool same_port = strcmp(wanted->port, list[i].port) == 0;
        if (wanted->is_usb ? !is_same(wanted, &list[i]) : !same_port)
            continue;
        if (same_port)
            return i;
        found = i;
        n_found++;
    }
    return n_found == 1 ? found : -1;
}
