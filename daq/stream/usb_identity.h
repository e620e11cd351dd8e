/* Finds a USB adapter again after it was unplugged: the kernel may give it another port number, and
 * its old number to another adapter. */
#ifndef WB_DAQ_STREAM_USB_IDENTITY_H
#define WB_DAQ_STREAM_USB_IDENTITY_H

#include <stdbool.h>

struct wb_usb_identity {
    char port[64]; /* the kernel's name: "/dev/ttyUSB0" */
    bool is_usb;   /* the members below are set */
    int vendor, product;
    char serial[64]; /* "": no serial number, as in many cheap adapters */
};

/* Index of the wanted adapter in a list of n ports; -1: absent or ambiguous. Among ports with the
 * same vendor, product and serial number, the port with the old name is chosen, or the only one. A
 * port that is not USB is found by its name. */
int wb_usb_identity_find(const struct wb_usb_identity *wanted, const struct wb_usb_identity *list,
                         int n);

#endif
