/*
 * Streams of server-sent events (WHATWG HTML, 9.2), whatever they tell of: what those of one job
 * (events.h) and those of all (hub.h) have in common.
 *
 * A stream is a suspended connection and a small struct: no thread, no timer of its own. Streams of
 * one source share its timer, which looks four times a second, and once more when it is woken,
 * whether there is something to say. A text that has been begun is sent to its end; a slow client
 * delays nobody. In silence a comment goes out now and then, which also finds clients that have
 * gone. A stream ends within seconds of the token or session that let it in.
 *
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_RESOURCES_EVENT_STREAM_H
#define ORL_SERVER_RESOURCES_EVENT_STREAM_H

#include <stdbool.h>
#include <uv.h>

#include "http/access.h"
#include "http/request.h"
#include "resources/event_text.h"

struct orl_event_source;
struct orl_server;

/* The first member of a source's own streams. */
struct orl_event_stream {
    struct orl_event_source *source;
    struct MHD_Connection *connection;
    struct orl_client *client; /* counted there; or NULL */
    struct orl_event_text *sending;
    size_t sent; /* of it */
    struct orl_admission admission;
    double asked_s;  /* when that was last looked at */
    double active_s; /* when something was last begun */
    bool suspended, beat, over;
    struct orl_event_stream *next, **link;
};

struct orl_event_calls {
    /* The timer's, before it asks for each stream whether it has news. */
    void (*look)(struct orl_event_source *source);
    /* Is there a text for the stream, or is it at its end? */
    bool (*has_news)(const struct orl_event_stream *stream);
    /* *ret_text: what the stream is to send now, with a reference of its own; or NULL, nothing.
     * False: the stream ends. */
    bool (*next)(struct orl_event_stream *stream, struct orl_event_text **ret_text);
    /* The stream is over, and in no list any more. */
    void (*free)(struct orl_event_stream *stream);
};

/* The first member of what has streams, which reads its members. */
struct orl_event_source {
    struct orl_server *server;
    const struct orl_event_calls *calls;
    uv_timer_t timer;
    struct orl_event_text *heartbeat;
    double heartbeat_s;
    struct orl_event_stream *streams;
    size_t count; /* of them */
    bool stopping;
};

/* Borrows server, whose http may come later, and calls. */
int orl_event_source_init(struct orl_event_source *source, struct orl_server *server,
                          const struct orl_event_calls *calls, struct orl_error *err);
/* Once the loop has run dry and no response lives. */
void orl_event_source_done(struct orl_event_source *source);

/* Lets all streams come to their end, and closes the timer with the loop's next turns. */
void orl_event_source_stop(struct orl_event_source *source);

/* There may be news. From anywhere on the loop thread, handlers included. */
void orl_event_source_wake(struct orl_event_source *source);

/* A response that streams. Takes stream, whose own part is set; NULL, and it is freed, when out of
 * memory. */
struct MHD_Response *orl_event_stream_open(struct orl_event_source *source,
                                           struct orl_event_stream *stream,
                                           struct orl_request *request);

#endif
