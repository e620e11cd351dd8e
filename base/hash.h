/* SHA-256 of files and bytes (GLib's GChecksum). */
#ifndef WB_BASE_HASH_H
#define WB_BASE_HASH_H

#include <stddef.h>

#include "base/reason.h"

/* Lower-case hex and a NUL. */
#define WB_SHA256_TEXT 65

/* Of a file; WB_ERR_NOT_FOUND or WB_ERR_IO with a message. */
WB_MUST_CHECK enum wb_status wb_hash_file(const char *path, char hex[WB_SHA256_TEXT]);
/* From an open descriptor, from its start to its end; its offset does not change. On failure `why`
 * receives the reason; if it is NULL, the reason is logged. */
WB_MUST_CHECK enum wb_status wb_hash_descriptor(int descriptor, const char *name,
                                                char hex[WB_SHA256_TEXT], struct wb_reason *why);
/* Of bytes in memory. */
void wb_hash_bytes(const void *bytes, size_t n, char hex[WB_SHA256_TEXT]);

/* Incremental hash. */
struct wb_hash;
struct wb_hash *wb_hash_create(void); /* never NULL: GLib ends the process when out of memory */
void wb_hash_add(struct wb_hash *hash, const void *bytes, size_t n);
/* Hash of everything added so far; more may be added. */
void wb_hash_so_far(const struct wb_hash *hash, char hex[WB_SHA256_TEXT]);
void wb_hash_destroy(struct wb_hash *hash); /* accepts NULL */

#endif
