/* A text for event streams, shared by all streams that send it. Threads: the loop thread only. */
#ifndef ORL_SERVER_HANDLERS_EVENTS_EVENT_TEXT_H
#define ORL_SERVER_HANDLERS_EVENTS_EVENT_TEXT_H

#include <jansson.h>
#include <stddef.h>

struct orl_event_text {
    unsigned refs;
    size_t size;
    char data[];
};

/* Returns a text with one reference. NULL when out of memory. */
struct orl_event_text *orl_event_text_new(const char *data, size_t size);
void orl_event_text_unref(struct orl_event_text *text); /* NULL is allowed */

/* Returns the text "id: ...\nevent: NAME\ndata: {...}\n\n". Takes ownership of data. NULL if data
 * is NULL or memory runs out. */
struct orl_event_text *orl_event_text_of(const char *id, const char *name, json_t *data);

#endif
