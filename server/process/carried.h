/*
 * Files embedded in the daemon: the migrations and the API contract, by their path in the source
 * tree. Constant data; any thread.
 */
#ifndef ORL_SERVER_PROCESS_CARRIED_H
#define ORL_SERVER_PROCESS_CARRIED_H

#include <stddef.h>

struct orl_carried_file {
    const char *name, *text;
};

size_t orl_carried_count(void);
struct orl_carried_file orl_carried_at(size_t index);
/* Returns the text of a file, or NULL. */
const char *orl_carried_find(const char *name);

#endif
