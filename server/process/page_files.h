/*
 * Files of the dashboard (client/dashboard) that the daemon carries inside, plain and by gzip.
 * Constant data; threads do not matter.
 */
#ifndef ORL_SERVER_PROCESS_PAGE_FILES_H
#define ORL_SERVER_PROCESS_PAGE_FILES_H

#include <stddef.h>

struct orl_page_file {
    const char *name, *type; /* "viewer/gl.js", "text/javascript; charset=utf-8" */
    const char *sha;         /* of the plain bytes */
    size_t size, packed_size;
    const char *plain, *packed; /* bytes */
};

/* A digest of them all, which stands in their addresses. */
const char *orl_page_version(void);
/* The file of that name, or NULL. */
const struct orl_page_file *orl_page_file_find(const char *name);

#endif
