/* The user guide, at /guide: its pages and pictures, and the search over them. */
#include "handlers/handlers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "guide/guide.h"
#include "handlers/service/guide_page.h"
#include "http/response/reply.h"
#include "process/embedded_files.h"
#include "server.h"

/* Returns the guide, made at the first request, or NULL after an error reply. */
static struct orl_guide *open_guide(struct orl_request *request)
{
    struct orl_error err = {0};
    size_t count = 0;
    const struct orl_guide_file *files = orl_guide_files(&count);
    if (!request->server->guide &&
        orl_guide_open(files, count, &request->server->guide, &err) != 0) {
        orl_reply_error(request, &err);
        return NULL;
    }
    return request->server->guide;
}

/* Sends a document of HTML, unless the client has it; takes ownership of it. NULL becomes a 503. */
static void send_document(struct orl_request *request, unsigned status, char *html)
{
    struct orl_sha256 hash;
    char tag[ORL_SHA256_HEX] = "";
    if (html && status == 200) {
        orl_sha256_init(&hash);
        orl_sha256_add(&hash, html, strlen(html));
        orl_sha256_finish_hex(&hash, tag);
    }
    if (*tag && orl_reply_if_none_match(request, tag)) {
        free(html);
    } else {
        orl_reply_owned_text(request, status, "text/html; charset=utf-8", html);
        orl_reply_page_headers(request);
        if (*tag)
            orl_reply_etag(request, tag);
    }
    orl_reply_header(request, "Cache-Control", "no-cache");
}

void orl_handle_guide(struct orl_request *request)
{
    struct orl_guide *guide = open_guide(request);
    if (guide) /* without a start page, the first one */
        send_document(request, 200, orl_guide_page_html(guide, 0));
}

/* Sends a picture, if the guide has a file of that name. Returns false if it has none. */
static bool send_picture(struct orl_request *request, const char *name)
{
    size_t count = 0;
    const struct orl_guide_file *files = orl_guide_files(&count);
    for (size_t i = 0; i < count; i++) {
        if (strcmp(files[i].name, name) != 0 || strncmp(files[i].type, "image/", 6) != 0)
            continue;
        if (!orl_reply_if_none_match(request, files[i].sha)) {
            orl_reply_bytes(request, files[i].type, files[i].bytes, files[i].size);
            orl_reply_page_headers(request);
            orl_reply_etag(request, files[i].sha);
        }
        orl_reply_header(request, "Cache-Control", "no-cache");
        return true;
    }
    return false;
}

void orl_handle_guide_page(struct orl_request *request)
{
    char name[2 * ORL_PARAM_MAX];
    const bool in_folder = strcmp(request->route->path, "/guide/{}/{}") == 0;
    snprintf(name, sizeof name, "%s%s%s", request->params[0], in_folder ? "/" : "",
             in_folder ? request->params[1] : "");
    struct orl_guide *guide = open_guide(request);
    if (!guide || send_picture(request, name))
        return;
    const size_t page = orl_guide_find(guide, name);
    if (page < orl_guide_count(guide))
        send_document(request, 200, orl_guide_page_html(guide, page));
    else if (orl_dashboard_is_wanted(request))
        send_document(request, 404, orl_guide_missing_html(guide, name));
    else
        orl_reply_not_found(request, "page of the guide");
}

void orl_handle_guide_search(struct orl_request *request)
{
    struct orl_guide *guide = open_guide(request);
    if (guide)
        send_document(request, 200, orl_guide_search_html(guide, orl_request_query(request, "q")));
}
