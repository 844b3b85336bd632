/*
 * An HTTP client for the commands: a thin layer over libcurl. It has one connection to one daemon,
 * with sequential requests and JSON in both directions. Problem documents (RFC 9457) become struct
 * orl_error, so that a daemon's error reads like a local one.
 *
 * Ownership: orl_http_close frees what orl_http_open made; JSON values returned are new references.
 * Threads: one at a time.
 * Errors: negative enum orl_err; ORL_ERR_IO if the daemon cannot be reached.
 */
#ifndef ORL_CLIENT_HTTP_HTTP_CLIENT_H
#define ORL_CLIENT_HTTP_HTTP_CLIENT_H

#include <stdbool.h>
#include <stddef.h>

#include <curl/curl.h>
#include <jansson.h>

#include <oriel/base/error.h>

#include "options/settings.h"

struct orl_http {
    CURL *curl;
    char base_url[1024];       /* without a slash at the end */
    char token[ORL_TOKEN_MAX]; /* access token; empty: none */
    long status;               /* status of the last reply; 0 without one */
    /* Accepts any certificate of a daemon of this machine, and sends it no token. */
    bool any_certificate;
};

/* A file of an upload: the file at path is sent as name. Resources are not scene text. */
struct orl_upload_part {
    char *path;
    char *name;
    bool resource;
};

/* Opens a session with a server: a URL or a name in the settings, or NULL for the usual one
 * (options/settings.h). */
int orl_http_open(struct orl_http *ret_http, const char *server, struct orl_error *err);
void orl_http_close(struct orl_http *http); /* NULL and half-open are fine */

/* Sends GET, DELETE, ... without a body. ret_json may be NULL; else it gets the reply, or json
 * null. */
int orl_http_call(struct orl_http *http, const char *method, const char *path, json_t **ret_json,
                  struct orl_error *err);

/* Returns the path of the next page of the last list (RFC 8288); "" after the last page. */
void orl_http_next_page(const struct orl_http *http, char *ret_path, size_t size);

/* Tests by HEAD whether path exists. Any status but success means no. */
int orl_http_has(struct orl_http *http, const char *path, bool *ret_found, struct orl_error *err);

/* POSTs a JSON document, with the client's name: $ORIEL_CLIENT, or else the user's name. */
int orl_http_post_json(struct orl_http *http, const char *path, const json_t *body,
                       json_t **ret_json, struct orl_error *err);

/* POSTs files as multipart/form-data, streamed from disk. */
int orl_http_post_parts(struct orl_http *http, const char *path,
                        const struct orl_upload_part *parts, size_t n_parts, json_t **ret_json,
                        struct orl_error *err);

/* POSTs one file as the body, with that media type. */
int orl_http_post_file(struct orl_http *http, const char *path, const char *file, const char *type,
                       json_t **ret_json, struct orl_error *err);

/*
 * GETs a stream of lines until it ends (returns 0) or the callback line returns false. The
 * callback gets each line without its end. last_id: id of the last event, "" for none.
 */
int orl_http_stream(struct orl_http *http, const char *path, const char *last_id,
                    bool (*line)(void *ctx, const char *text), void *ctx, struct orl_error *err);

/* GETs path into the file, whole or absent: a temporary name beside it is renamed. */
int orl_http_download(struct orl_http *http, const char *path, const char *file,
                      struct orl_error *err);

/* Escapes one path segment (an id, a file name) into ret_text. */
int orl_http_escape(const char *segment, char *ret_text, size_t size, struct orl_error *err);

#endif
