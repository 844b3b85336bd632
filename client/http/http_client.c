/* The only file that uses libcurl. */
#include "http/http_client.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <pwd.h>
#include <unistd.h>

#include <oriel/base/array.h>
#include <oriel/base/limits.h>
#include <oriel/base/version.h>

#include "distributed/atomic_files.h"
#include "options/command.h"
#include "options/settings.h"
#include "output/reports.h"
#include "json/encode.h"

/* A reply body: stored in memory up to a limit, written to a file, or passed on as lines. */
struct sink {
    char *data;
    size_t size, room;
    FILE *file;                                /* NULL: memory */
    bool (*line)(void *ctx, const char *text); /* callback for whole lines; or NULL */
    void *ctx;
    bool ended;    /* true if line has returned false */
    CURL *curl;    /* for the status, so that a problem document is not written to the file */
    bool overflow; /* true if the reply was too large */
};

int orl_http_open(struct orl_http *ret_http, const char *server, struct orl_error *err)
{
    struct orl_server_choice choice;
    *ret_http = (struct orl_http){0};
    const int rc = orl_server_choose(server, &choice, err);
    if (rc)
        return rc;
    const char *const chosen = choice.url;
    size_t length = strlen(chosen);
    while (length && chosen[length - 1] == '/')
        length--;
    if (length >= sizeof ret_http->base_url)
        return orl_error_set(err, ORL_ERR_LIMIT, "the daemon's URL is too long");
    memcpy(ret_http->base_url, chosen, length);
    ret_http->base_url[length] = '\0';
    memcpy(ret_http->token, choice.token, sizeof ret_http->token);
    if (strncmp(chosen, "http://", 7) != 0 && strncmp(chosen, "https://", 8) != 0) {
        orl_error_set(err, ORL_ERR_INVALID, "\"%s\" is not an http:// or https:// URL", chosen);
        orl_error_hint(err, "write --server http://HOST:PORT");
        return ORL_ERR_INVALID;
    }
    ret_http->curl = curl_easy_init();
    if (!ret_http->curl)
        return orl_error_no_memory(err);
    return 0;
}

void orl_http_close(struct orl_http *http)
{
    if (http)
        curl_easy_cleanup(http->curl);
}

int orl_http_escape(const char *segment, char *ret_text, size_t size, struct orl_error *err)
{
    char *escaped = curl_easy_escape(NULL, segment, 0);
    int rc = 0;
    if (!escaped)
        rc = orl_error_no_memory(err);
    else if (!*escaped || strlen(escaped) >= size || strcmp(escaped, ".") == 0 ||
             strcmp(escaped, "..") == 0)
        rc = orl_error_set(err, ORL_ERR_INVALID, "\"%.100s\" is not a valid id", segment);
    else
        memcpy(ret_text, escaped, strlen(escaped) + 1);
    curl_free(escaped);
    return rc;
}

static bool sink_grow(struct sink *sink, size_t more)
{
    if (more >= ORL_LIMIT_JOB_BYTES - sink->size) {
        sink->overflow = true;
        return false;
    }
    return orl_array_reserve_more(&sink->data, &sink->room, sink->size, more + 1, 1);
}

/* Passes whole lines to the callback and keeps the rest. */
static bool deliver_lines(struct sink *sink)
{
    char *from = sink->data, *end;
    while ((end = memchr(from, '\n', sink->size - (size_t)(from - sink->data)))) {
        *end = '\0';
        if (!sink->line(sink->ctx, from)) {
            sink->ended = true;
            return false;
        }
        from = end + 1;
    }
    sink->size -= (size_t)(from - sink->data);
    memmove(sink->data, from, sink->size + 1);
    return true;
}

static size_t sink_write(char *data, size_t unit, size_t count, void *arg)
{
    struct sink *sink = arg;
    const size_t size = unit * count; /* unit is always 1 */
    long status = 0;
    curl_easy_getinfo(sink->curl, CURLINFO_RESPONSE_CODE, &status);
    if (sink->file && status / 100 == 2)
        return fwrite(data, 1, size, sink->file);
    if (!sink_grow(sink, size))
        return 0;
    memcpy(sink->data + sink->size, data, size);
    sink->size += size;
    sink->data[sink->size] = '\0';
    return !sink->line || status / 100 != 2 || deliver_lines(sink) ? size : 0;
}

/* Returns true for a daemon on this machine, which is reached without proxies. */
static bool is_loopback(const char *url)
{
    const char *host = strstr(url, "://") + 3;
    static const char *const names[] = {"127.", "localhost", "[::1]"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (strncmp(host, names[i], strlen(names[i])) == 0)
            return true;
    return false;
}

/* Adds the access token unless others could read it on the way, and the trusted certificates,
 * $ORIEL_CA. */
static void add_credentials(struct orl_http *http)
{
    const char *ca = getenv("ORIEL_CA");
    if (http->token[0] &&
        (strncmp(http->base_url, "https://", 8) == 0 || is_loopback(http->base_url))) {
        curl_easy_setopt(http->curl, CURLOPT_HTTPAUTH, (long)CURLAUTH_BEARER);
        curl_easy_setopt(http->curl, CURLOPT_XOAUTH2_BEARER, http->token);
    }
    if (ca && *ca)
        curl_easy_setopt(http->curl, CURLOPT_CAINFO, ca);
}

/* Sets the options common to all requests. The caller may add a body afterwards. */
static int prepare_request(struct orl_http *http, const char *method, const char *path,
                           struct sink *sink, struct orl_error *err)
{
    CURL *const curl = http->curl;
    char url[4096];
    const int length = snprintf(url, sizeof url, "%s%s", http->base_url, path);
    if (length < 0 || (size_t)length >= sizeof url)
        return orl_error_set(err, ORL_ERR_LIMIT, "the request's URL is too long");
    http->status = 0;
    sink->curl = curl;
    curl_easy_reset(curl);
    curl_easy_setopt(curl, CURLOPT_URL, url);
    curl_easy_setopt(curl, CURLOPT_CUSTOMREQUEST, method);
    curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(curl, CURLOPT_USERAGENT, "oriel/" ORL_VERSION);
    curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT, 10L);
    /* Checking a large upload may take minutes: the time limit is on silence, not on duration. */
    curl_easy_setopt(curl, CURLOPT_LOW_SPEED_LIMIT, 1L);
    curl_easy_setopt(curl, CURLOPT_LOW_SPEED_TIME, 600L);
    curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, sink_write);
    curl_easy_setopt(curl, CURLOPT_WRITEDATA, sink);
    if (is_loopback(http->base_url))
        curl_easy_setopt(curl, CURLOPT_NOPROXY, "*");
    if (http->any_certificate && is_loopback(http->base_url)) {
        curl_easy_setopt(curl, CURLOPT_SSL_VERIFYPEER, 0L);
        curl_easy_setopt(curl, CURLOPT_SSL_VERIFYHOST, 0L);
    } else {
        add_credentials(http);
    }
    return 0;
}

/* Sends the prepared request. Returns 0 for a 2xx reply, else the error of its problem document. */
static int perform_request(struct orl_http *http, struct sink *sink, struct orl_error *err)
{
    const CURLcode code = curl_easy_perform(http->curl);
    if (sink->overflow)
        return orl_error_set(err, ORL_ERR_LIMIT, "the daemon's reply is implausibly large");
    if (code != CURLE_OK) {
        const bool unreached = code == CURLE_COULDNT_CONNECT || code == CURLE_COULDNT_RESOLVE_HOST;
        orl_error_set(err, ORL_ERR_IO, "no answer from %s: %s", http->base_url,
                      curl_easy_strerror(code));
        if (unreached)
            orl_error_hint(err, "start one with `orield`, or name another with --server URL");
        return ORL_ERR_IO;
    }
    curl_easy_getinfo(http->curl, CURLINFO_RESPONSE_CODE, &http->status);
    if (http->status / 100 == 2)
        return 0;
    return orl_report_reply_to_error(sink->data, sink->size, http->status, err);
}

/* Performs the request and parses the reply as JSON. Frees the sink. */
static int perform_json(struct orl_http *http, struct sink *sink, json_t **ret_json,
                        struct orl_error *err)
{
    json_error_t where;
    json_t *json = NULL;
    int rc = perform_request(http, sink, err);
    if (rc == 0 && ret_json) {
        json = sink->size ? json_loadb(sink->data, sink->size, 0, &where) : json_null();
        if (json)
            *ret_json = json;
        else
            rc = orl_error_set(err, ORL_ERR_SYNTAX,
                               "the daemon's reply is not JSON: %s (is %s an "
                               "orield?)",
                               where.text, http->base_url);
    }
    free(sink->data);
    return rc;
}

int orl_http_call(struct orl_http *http, const char *method, const char *path, json_t **ret_json,
                  struct orl_error *err)
{
    struct sink sink = {0};
    const int rc = prepare_request(http, method, path, &sink, err);
    return rc ? rc : perform_json(http, &sink, ret_json, err);
}

void orl_http_next_page(const struct orl_http *http, char *ret_path, size_t size)
{
    static const char end[] = ">; rel=\"next\"";
    struct curl_header *header;
    const char *found = NULL;
    *ret_path = '\0';
    if (curl_easy_header(http->curl, "Link", 0, CURLH_HEADER, -1, &header) == CURLHE_OK &&
        strncmp(header->value, "</v1/", 5) == 0)
        found = strstr(header->value, end);
    if (found)
        snprintf(ret_path, size, "%.*s", (int)(found - header->value - 1), header->value + 1);
}

int orl_http_stream(struct orl_http *http, const char *path, const char *last_id,
                    bool (*line)(void *ctx, const char *text), void *ctx, struct orl_error *err)
{
    struct sink sink = {.line = line, .ctx = ctx};
    struct curl_slist *headers = curl_slist_append(NULL, "Accept: text/event-stream");
    char header[128];
    int rc = headers ? prepare_request(http, "GET", path, &sink, err) : orl_error_no_memory(err);
    snprintf(header, sizeof header, "Last-Event-ID: %s", last_id);
    if (rc == 0 && *last_id && !curl_slist_append(headers, header))
        rc = orl_error_no_memory(err);
    if (rc == 0) {
        curl_easy_setopt(http->curl, CURLOPT_HTTPHEADER, headers);
        rc = perform_request(http, &sink, err);
    }
    free(sink.data);
    curl_slist_free_all(headers);
    return sink.ended ? 0 : rc;
}

int orl_http_has(struct orl_http *http, const char *path, bool *ret_found, struct orl_error *err)
{
    struct sink sink = {0};
    int rc = prepare_request(http, "HEAD", path, &sink, err);
    if (rc)
        return rc;
    curl_easy_setopt(http->curl, CURLOPT_NOBODY, 1L);
    rc = perform_request(http, &sink, err);
    free(sink.data);
    if (rc && http->status == 0)
        return rc;
    *ret_found = rc == 0;
    return 0;
}

/* Adds the client's name, by which the daemon queues jobs fairly. Names that no header may have
 * are left out. */
static struct curl_slist *add_name(struct curl_slist *headers)
{
    enum { NAME_MAX_BYTES = 64 };
    const char *name = getenv("ORIEL_CLIENT");
    const struct passwd *user = name && *name ? NULL : getpwuid(getuid());
    char line[96];
    if (user)
        name = user->pw_name;
    if (!name || !*name || strlen(name) > NAME_MAX_BYTES)
        return headers;
    for (const char *c = name; *c; c++)
        if (*c < ' ' || *c > '~')
            return headers;
    snprintf(line, sizeof line, "X-Oriel-Client: %s", name);
    struct curl_slist *more = curl_slist_append(headers, line);
    return more ? more : headers;
}

int orl_http_post_json(struct orl_http *http, const char *path, const json_t *body,
                       json_t **ret_json, struct orl_error *err)
{
    struct sink sink = {0};
    struct curl_slist *headers = curl_slist_append(NULL, "Content-Type: application/json");
    char *text = orl_json_text(body, JSON_COMPACT);
    int rc;
    if (!headers || !text) {
        rc = orl_error_no_memory(err);
        goto done;
    }
    rc = prepare_request(http, "POST", path, &sink, err);
    if (rc)
        goto done;
    headers = add_name(headers);
    curl_easy_setopt(http->curl, CURLOPT_HTTPHEADER, headers);
    curl_easy_setopt(http->curl, CURLOPT_POSTFIELDSIZE_LARGE, (curl_off_t)strlen(text));
    curl_easy_setopt(http->curl, CURLOPT_POSTFIELDS, text);
    rc = perform_json(http, &sink, ret_json, err);
done:
    free(text);
    curl_slist_free_all(headers);
    return rc;
}

int orl_http_post_parts(struct orl_http *http, const char *path,
                        const struct orl_upload_part *parts, size_t n_parts, json_t **ret_json,
                        struct orl_error *err)
{
    struct sink sink = {0};
    curl_mime *form = curl_mime_init(http->curl);
    int rc = form ? 0 : orl_error_no_memory(err);
    for (size_t i = 0; i < n_parts && rc == 0; i++) {
        curl_mimepart *part = curl_mime_addpart(form);
        if (!part || curl_mime_name(part, parts[i].resource ? "resource" : "file") ||
            curl_mime_filedata(part, parts[i].path) || curl_mime_filename(part, parts[i].name) ||
            curl_mime_type(part, "application/octet-stream")) {
            rc = orl_error_set(err, ORL_ERR_IO, "cannot be read");
            orl_error_at(err, parts[i].path, 0, NULL);
        }
    }
    if (rc == 0)
        rc = prepare_request(http, "POST", path, &sink, err);
    if (rc == 0) {
        curl_easy_setopt(http->curl, CURLOPT_MIMEPOST, form);
        rc = perform_json(http, &sink, ret_json, err);
    }
    curl_mime_free(form);
    return rc;
}

int orl_http_post_file(struct orl_http *http, const char *path, const char *file, const char *type,
                       json_t **ret_json, struct orl_error *err)
{
    char line[128];
    struct sink sink = {0};
    struct curl_slist *headers;
    FILE *body = NULL;
    long long size = 0;
    int rc = orl_open_for_reading(file, &body, &size, err);
    snprintf(line, sizeof line, "Content-Type: %s", type);
    headers = curl_slist_append(NULL, line);
    if (rc)
        goto done;
    rc = prepare_request(http, "POST", path, &sink, err);
    if (rc)
        goto done;
    curl_easy_setopt(http->curl, CURLOPT_HTTPHEADER, headers);
    curl_easy_setopt(http->curl, CURLOPT_POST, 1L);
    curl_easy_setopt(http->curl, CURLOPT_READDATA, body);
    curl_easy_setopt(http->curl, CURLOPT_POSTFIELDSIZE_LARGE, (curl_off_t)size);
    rc = perform_json(http, &sink, ret_json, err);
done:
    if (body)
        fclose(body);
    curl_slist_free_all(headers);
    return rc;
}

int orl_http_download(struct orl_http *http, const char *path, const char *file,
                      struct orl_error *err)
{
    struct sink sink = {0};
    struct orl_atomic_file out;
    int rc = orl_atomic_file_open(&out, file, err);
    if (rc)
        return rc;
    sink.file = out.stream;
    rc = prepare_request(http, "GET", path, &sink, err);
    if (rc == 0)
        rc = perform_request(http, &sink, err);
    free(sink.data);
    if (rc == 0)
        return orl_atomic_file_commit(&out, err);
    orl_atomic_file_abandon(&out);
    return rc;
}
