/* Which of the serial ports that are there is an adapter that was unplugged: the kernel may give it
 * another number when it comes back, and its old number to another one.
 */
#ifndef WB_DAQ_STREAM_USB_IDENTITY_H
#define WB_DAQ_STREAM_USB_IDENTITY_H

#include <stdbool.h>

struct wb_usb_identity {
    char port[64]; /* as the kernel names it: "/dev/ttyUSB0" */
    bool is_usb;   /* what follows is known */
    int vendor, product;
    char serial[64]; /* "": it has none, as many cheap adapters */
};

/* Index of the wanted one in a list of n; -1: it is not there, or several may be it. Of those with
 * the same vendor, product and serial number the one under the old number is taken, or the only
 * one. A port that is none of USB is known by its name. */
int wb_usb_identity_find(const struct wb_usb_identity *wanted, const struct wb_usb_identity *list,
                         int n);

#endif
