/*
 * Streams of server-sent events (WHATWG HTML, 9.2): the common part of streams of one job
 * (events.c) and of all jobs (event_broker.c).
 */
#ifndef ORL_SERVER_HANDLERS_EVENTS_EVENT_STREAM_H
#define ORL_SERVER_HANDLERS_EVENTS_EVENT_STREAM_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <uv.h>

#include "http/access/access.h"
#include "http/request/request.h"

/* A text for event streams, shared by all streams that send it. Threads: the loop thread only. */

struct orl_event_text {
    unsigned refs;
    size_t size;
    char data[];
};

void orl_event_text_unref(struct orl_event_text *text); /* NULL is allowed */

/* Returns the text "id: ...\nevent: NAME\ndata: {...}\n\n". Takes ownership of data. NULL if data
 * is NULL or memory runs out. */
struct orl_event_text *orl_event_text_of(const char *id, const char *name, json_t *data);

/*
 * A stream is a suspended connection and a small struct, without a thread or timer of its own.
 * Streams of one source share its timer. It looks for news four times a second, and once more when
 * it is woken. A text whose sending has begun is sent to its end; a slow client delays no other. In
 * silence a comment is sent now and then, which also finds clients that have gone. A stream ends
 * within seconds of the end of the token or session that admitted it.
 *
 * Threads: the loop thread only.
 */

struct orl_event_source;
struct orl_server;

/* A stream. It must be the first member of a source's own stream struct. */
struct orl_event_stream {
    struct orl_event_source *source;
    struct MHD_Connection *connection;
    struct orl_client *client; /* client that counts the stream; or NULL */
    struct orl_event_text *sending;
    size_t sent; /* bytes sent of it */
    struct orl_credentials credentials;
    double checked_s; /* time of the last check of credentials */
    double active_s;  /* time when the last text was begun */
    bool suspended, heartbeat_due, ended;
    struct orl_event_stream *next, **link;
};

struct orl_event_calls {
    /* Called by the timer before it calls has_news for each stream. */
    void (*poll)(struct orl_event_source *source);
    /* Returns true if there is a text for the stream, or the stream is at its end. */
    bool (*has_news)(const struct orl_event_stream *stream);
    /* Sets *ret_text to the next text of the stream, with a new reference, or to NULL if there is
     * none. Returns false if the stream ends. */
    bool (*next)(struct orl_event_stream *stream, struct orl_event_text **ret_text);
    /* Frees a stream that has ended and is in no list any more. */
    void (*free)(struct orl_event_stream *stream);
};

/* A source of streams. It must be the first member of the struct that has them, which may read its
 * members. */
struct orl_event_source {
    struct orl_server *server;
    const struct orl_event_calls *calls;
    uv_timer_t timer;
    struct orl_event_text *heartbeat;
    double heartbeat_s;
    struct orl_event_stream *streams;
    size_t count; /* number of streams */
    bool stopping;
};

/* Initialises a source. Borrows server, whose http may be set later, and calls. */
int orl_event_source_init(struct orl_event_source *source, struct orl_server *server,
                          const struct orl_event_calls *calls, struct orl_error *err);
/* Frees the source's data. Call it once the loop has ended and no response exists. */
void orl_event_source_done(struct orl_event_source *source);

/* Ends all streams, and closes the timer in the loop's next turns. */
void orl_event_source_stop(struct orl_event_source *source);

/* Makes the timer look for news at once. Call it anywhere on the loop thread, including in
 * handlers. */
void orl_event_source_wake(struct orl_event_source *source);

/* Returns a response that streams. Takes ownership of stream, whose own part must be set. Returns
 * NULL, and frees stream, when out of memory. */
struct MHD_Response *orl_event_stream_open(struct orl_event_source *source,
                                           struct orl_event_stream *stream,
                                           struct orl_request *request);

#endif
