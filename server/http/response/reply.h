/*
 * Replies. Each function makes the response of a request, once; request.c sends it. When memory
 * runs out a plain 503 is sent instead.
 */
#ifndef ORL_SERVER_HTTP_RESPONSE_REPLY_H
#define ORL_SERVER_HTTP_RESPONSE_REPLY_H

#include <jansson.h>

#include "http/request/request.h"

/* Replies with json, and takes ownership of it. NULL (out of memory) becomes a 503. */
void orl_reply_json(struct orl_request *request, unsigned status, json_t *json);
/* Returns the text of such a reply, owned by the caller; takes ownership of json. NULL if json is
 * NULL or memory runs out. */
char *orl_reply_text_of(json_t *json);
/* Replies with JSON text made before; it is copied. NULL becomes a 503. */
void orl_reply_json_text(struct orl_request *request, unsigned status, const char *text,
                         size_t size);
/* Replies with application/problem+json for an error of the core; errors of the daemon itself (5xx)
 * are logged. */
void orl_reply_error(struct orl_request *request, const struct orl_error *err);
/* Replies with a problem of HTTP itself; see orl_problem_new. */
void orl_reply_problem(struct orl_request *request, unsigned status, const char *type,
                       const char *title, const char *detail, ...)
    __attribute__((format(printf, 5, 6)));
/* Replies to a DELETE: 204, 404 if the object does not exist, or 409 if it is in use. */
void orl_reply_removed(struct orl_request *request, bool removed, const char *what);
void orl_reply_in_use(struct orl_request *request, const char *why);
/* 404: the object does not exist. */
void orl_reply_not_found(struct orl_request *request, const char *what);
/* 503: the daemon is stopping. */
void orl_reply_stopping(struct orl_request *request);
/* Replies with constant text, which is not copied. */
void orl_reply_text(struct orl_request *request, const char *type, const char *text);
/* Replies with constant bytes, which are not copied. */
void orl_reply_bytes(struct orl_request *request, const char *type, const char *data, size_t size);
/* Replies with text, and takes ownership of it. NULL (out of memory) becomes a 503. */
void orl_reply_owned_text(struct orl_request *request, unsigned status, const char *type,
                          char *text);
/* Replies with a file by descriptor, and takes ownership of the descriptor. */
void orl_reply_file(struct orl_request *request, int fd, uint64_t size, const char *type);
/*
 * Replies with a file that never changes and whose strong tag is known. Sends the part that Range
 * asks for (one range of bytes, if If-Range allows it; RFC 9110, 14), or the whole file; 416 if the
 * part is empty. Takes ownership of the descriptor.
 */
void orl_reply_file_range(struct orl_request *request, int fd, uint64_t size, const char *type,
                          const char *tag);
/* 204, without a body. */
void orl_reply_no_content(struct orl_request *request);
/* Replies with a response that generates its body; NULL (out of memory) becomes a 503. */
void orl_reply_stream(struct orl_request *request, struct MHD_Response *response, const char *type);

/* Adds a header to the response made. */
void orl_reply_header(struct orl_request *request, const char *name, const char *value);
/* Adds the strong ETag "tag". If the client has that version already, replies 304 instead and
 * returns true. */
bool orl_reply_if_none_match(struct orl_request *request, const char *tag);
void orl_reply_etag(struct orl_request *request, const char *tag);

/*
 * Delays the answer until everything committed is on disk (wal.h). If that fails, a request
 * that changes something gets the error instead; a GET or HEAD is answered unchanged.
 */
void orl_reply_when_durable(struct orl_request *request);
/* Like orl_reply_when_durable, but waits only if the commit of that number is not on disk yet. */
void orl_reply_when_commit_durable(struct orl_request *request, uint64_t commit);

/* Makes room in the storage budget for so many more bytes. If that is impossible, replies with a
 * 507 and returns true. */
bool orl_reply_if_full(struct orl_request *request, uint64_t bytes);
/* Refuses a request whose reservation of so many bytes failed (request->reservation): 507, or 429
 * for the client's own limit. */
void orl_reply_quota_exceeded(struct orl_request *request, uint64_t bytes);

/* Makes a zeroed state of that size, which free_state frees with the request. NULL after a 503: out
 * of memory. */
void *orl_request_new_state(struct orl_request *request, size_t size,
                            void (*free_state)(void *state));

#endif
