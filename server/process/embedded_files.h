/*
 * Files embedded in the daemon: the migrations and the API contract, the files of the dashboard,
 * and the pages of the guide. Constant data; any thread.
 */
#ifndef ORL_SERVER_PROCESS_EMBEDDED_FILES_H
#define ORL_SERVER_PROCESS_EMBEDDED_FILES_H

#include <stddef.h>

/* The migrations and the API contract, by their path in the source tree. */

struct orl_embedded_file {
    const char *name, *text;
};

size_t orl_embedded_file_count(void);
struct orl_embedded_file orl_embedded_file_at(size_t index);
/* Returns the text of a file, or NULL. */
const char *orl_embedded_file_find(const char *name);

/*
 * Files of the dashboard (client/dashboard), plain and gzip-compressed.
 */

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

/*
 * Files of the guide (client/guide): Markdown and pictures.
 */

struct orl_guide_file {
    const char *name, *type; /* "howto/tokens.md"; the type of a picture, "image/png" */
    const char *sha;         /* digest of the bytes */
    size_t size;
    const char *bytes;
};

/* Returns all files of the guide. */
const struct orl_guide_file *orl_guide_files(size_t *ret_count);

#endif
