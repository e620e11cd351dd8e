/* Detached OpenPGP signatures of files, made and verified by gpg, whose keys, agent and trust they
 * are. */
#ifndef WB_ANALYSIS_REPORT_OPENPGP_H
#define WB_ANALYSIS_REPORT_OPENPGP_H

#include <stdbool.h>

#include "base/status.h"

/* Whether gpg is there and has a secret key of that name, number or address. WB_ERR_NOT_FOUND
 * otherwise, with a message that says how to mend it. */
WB_MUST_CHECK enum wb_status wb_openpgp_find_key(const char *key);

/* Writes the armoured signature of a file to `signature`, replacing it. gpg may ask for the key's
 * passphrase by its own means. */
WB_MUST_CHECK enum wb_status wb_openpgp_sign(const char *path, const char *signature,
                                             const char *key);

struct wb_openpgp_signer {
    char name[200], fingerprint[80];
    bool is_trusted; /* gpg holds the key for that person's */
};

/* Who signed a file. WB_ERR_DATA: the signature is not of this file, or no signature, or of a key
 * that expired or was revoked. WB_ERR_NOT_FOUND: gpg or the public key is not there. */
WB_MUST_CHECK enum wb_status wb_openpgp_verify(const char *path, const char *signature,
                                               struct wb_openpgp_signer *signer);

#endif
