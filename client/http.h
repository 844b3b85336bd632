/*
 * HTTP as the commands need it: a thin layer over libcurl. One connection to one daemon; requests
 * one after the other; JSON in and out; problems (RFC 9457) come back as struct orl_error, so that
 * a daemon's complaint reads like one of our own.
 *
 * Ownership: orl_http_close frees what orl_http_open made; JSON values returned are new references.
 * Threads: one at a time. Errors: negative enum orl_err; ORL_ERR_IO when the daemon cannot be
 * reached.
 */
#ifndef ORL_CLIENT_HTTP_H
#define ORL_CLIENT_HTTP_H

#include <stdbool.h>
#include <stddef.h>

#include <curl/curl.h>
#include <jansson.h>

#include <oriel/error.h>

struct orl_http {
    CURL *curl;
    char base_url[1024]; /* without a slash at the end */
    long status;         /* of the last reply; 0 when there was none */
};

/* One part of an upload: the file at path travels as name; resources are not scene text. */
struct orl_upload_part {
    char *path;
    char *name;
    bool resource;
};

/* Opens a session with url, else $ORIEL_URL, else the loopback default. */
int orl_http_open(struct orl_http *ret_http, const char *url, struct orl_error *err);
void orl_http_close(struct orl_http *http); /* NULL and half-open are fine */

/* GET, DELETE ... without a body. ret_json may be NULL; else it is the reply, or json null. */
int orl_http_call(struct orl_http *http, const char *method, const char *path, json_t **ret_json,
                  struct orl_error *err);

/* Of the list that came last, the path of its next page (RFC 8288); "" when it was the last. */
void orl_http_next_page(const struct orl_http *http, char *ret_path, size_t size);

/* Is there something at path? By a HEAD. Any answer but "here it is" means no. */
int orl_http_has(struct orl_http *http, const char *path, bool *ret_found, struct orl_error *err);

/* POSTs a JSON document, with the client's name: $ORIEL_CLIENT, else the user's. */
int orl_http_post_json(struct orl_http *http, const char *path, const json_t *body,
                       json_t **ret_json, struct orl_error *err);

/* POSTs files as multipart/form-data, streamed from disk. */
int orl_http_post_parts(struct orl_http *http, const char *path,
                        const struct orl_upload_part *parts, size_t n_parts, json_t **ret_json,
                        struct orl_error *err);

/* POSTs one file as the body, of that media type. */
int orl_http_post_file(struct orl_http *http, const char *path, const char *file, const char *type,
                       json_t **ret_json, struct orl_error *err);

/*
 * GETs a stream of lines until it ends (then 0) or line, which is given each without its end,
 * returns false. last_id: of the event seen last, "" for none.
 */
int orl_http_stream(struct orl_http *http, const char *path, const char *last_id,
                    bool (*line)(void *ctx, const char *text), void *ctx, struct orl_error *err);

/* GETs path into the file, whole or not at all (a temporary name beside it, then a rename). */
int orl_http_download(struct orl_http *http, const char *path, const char *file,
                      struct orl_error *err);

/* Escapes one path segment (an id, a file name) into ret_text. */
int orl_http_escape(const char *segment, char *ret_text, size_t size, struct orl_error *err);

#endif
