/*
 * Files embedded in the daemon: the migrations and the API contract, by their path in the source
 * tree. Constant data; any thread.
 */
#ifndef ORL_SERVER_PROCESS_EMBEDDED_FILES_H
#define ORL_SERVER_PROCESS_EMBEDDED_FILES_H

#include <stddef.h>

struct orl_embedded_file {
    const char *name, *text;
};

size_t orl_embedded_file_count(void);
struct orl_embedded_file orl_embedded_file_at(size_t index);
/* Returns the text of a file, or NULL. */
const char *orl_embedded_file_find(const char *name);

#endif
