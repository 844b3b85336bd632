/*
 * Documents that take much memory to read (JSON takes many times its size) are read one at a time,
 * and what they took goes back to the system at once. Pool threads.
 */
#ifndef ORL_SERVER_HEAVY_H
#define ORL_SERVER_HEAVY_H

#include <malloc.h>

#include "decode.h"
#include "limits.h"
#include "server.h"

/* Waits while another is read. Returns whether this one is heavy, for the end. */
static inline bool orl_heavy_begin(struct orl_server *server, const struct orl_file *document)
{
    const bool heavy = orl_json_weight(document->data, document->size) > ORL_SERVER_HEAVY_BYTES;
    if (heavy)
        pthread_mutex_lock(&server->heavy);
    return heavy;
}

static inline void orl_heavy_end(struct orl_server *server, bool heavy)
{
    if (!heavy)
        return;
    malloc_trim(0);
    pthread_mutex_unlock(&server->heavy);
}

#endif
