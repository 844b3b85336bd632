/*
 * Files of the dashboard (client/dashboard) that are embedded in the daemon, plain and
 * gzip-compressed. Constant data; any thread.
 */
#ifndef ORL_SERVER_PROCESS_DASHBOARD_FILES_H
#define ORL_SERVER_PROCESS_DASHBOARD_FILES_H

#include <stddef.h>

struct orl_dashboard_file {
    const char *name, *type; /* "viewer/gl.js", "text/javascript; charset=utf-8" */
    const char *sha;         /* digest of the plain bytes */
    size_t size, packed_size;
    const char *plain, *packed; /* bytes */
};

/* Returns a digest of all files, which is part of their URLs. */
const char *orl_dashboard_version(void);
/* Returns the file of that name, or NULL. */
const struct orl_dashboard_file *orl_dashboard_file_find(const char *name);

#endif
