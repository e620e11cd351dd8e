/* Version of this program: stored in every recording, dataset and report. */
#ifndef WB_BASE_VERSION_H
#define WB_BASE_VERSION_H

/* The release, "0.1.0". */
const char *wb_version(void);

/* The source revision of the build, "4e3cfe61a0b2" or "4e3cfe61a0b2-dirty"; outside a checkout the
 * version in debian/changelog, "0.1.0-1". */
const char *wb_version_revision(void);

#endif
