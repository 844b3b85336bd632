/* What goes out on event streams, shared by all that send it. Threads: the loop thread only. */
#ifndef ORL_SERVER_RESOURCES_EVENT_TEXT_H
#define ORL_SERVER_RESOURCES_EVENT_TEXT_H

#include <jansson.h>
#include <stddef.h>

struct orl_event_text {
    unsigned refs;
    size_t size;
    char data[];
};

/* With one reference. NULL when out of memory. */
struct orl_event_text *orl_event_text_new(const char *data, size_t size);
void orl_event_text_unref(struct orl_event_text *text); /* NULL is fine */

/* "id: ...\nevent: NAME\ndata: {...}\n\n"; takes data. NULL when that is, or memory runs out. */
struct orl_event_text *orl_event_text_of(const char *id, const char *name, json_t *data);

#endif
