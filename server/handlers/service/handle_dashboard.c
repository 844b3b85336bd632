/* The dashboard's page, at / for browsers, and its files below /dashboard/. The JavaScript client
 * is one of them, and also at /oriel.js for other pages. */
#include "handlers/handlers.h"

#include <stdio.h>
#include <string.h>

#include "http/request/parse_request.h"
#include "http/response/reply.h"
#include "process/embedded_files.h"

/* Allows only the daemon's own files: no script in the page itself, no eval, and no embedding in
 * other sites' frames. Forms are those of the guide's search. */
static const char policy[] =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' "
    "blob:; worker-src 'self'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'";

void orl_reply_page_headers(struct orl_request *request)
{
    orl_reply_header(request, "Content-Security-Policy", policy);
    orl_reply_header(request, "Cross-Origin-Opener-Policy", "same-origin");
    orl_reply_header(request, "Cross-Origin-Resource-Policy", "same-origin");
    orl_reply_header(request, "Referrer-Policy", "no-referrer");
}

bool orl_dashboard_is_wanted(const struct orl_request *request)
{
    const char *accept = orl_request_header(request, MHD_HTTP_HEADER_ACCEPT);
    return orl_negotiate_weight(accept, "text/html") >
           orl_negotiate_weight(accept, "application/json");
}

/* Sends a file, compressed if the client accepts that. Each form has a strong tag of its own. */
static void send_file(struct orl_request *request, const struct orl_dashboard_file *file,
                      const char *vary, const char *cache)
{
    const char *codings = orl_request_header(request, MHD_HTTP_HEADER_ACCEPT_ENCODING);
    const bool packed = file->packed_size < file->size && orl_negotiate_weight(codings, "gzip") > 0;
    char tag[80];
    snprintf(tag, sizeof tag, "%s%s", file->sha, packed ? "-gzip" : "");
    if (!orl_reply_if_none_match(request, tag)) {
        orl_reply_bytes(request, file->type, packed ? file->packed : file->plain,
                        packed ? file->packed_size : file->size);
        orl_reply_etag(request, tag);
        if (packed)
            orl_reply_header(request, "Content-Encoding", "gzip");
        orl_reply_page_headers(request);
    }
    orl_reply_header(request, "Vary", vary);
    orl_reply_header(request, "Cache-Control", cache);
}

void orl_dashboard_reply(struct orl_request *request)
{
    send_file(request, orl_dashboard_file_find("index.html"), "Accept, Accept-Encoding",
              "no-cache");
}

/* The files' URLs contain the version, so browsers may cache them without limit. */
void orl_handle_dashboard_file(struct orl_request *request)
{
    const struct orl_dashboard_file *file = NULL;
    if (strcmp(request->params[0], orl_dashboard_version()) == 0)
        file = orl_dashboard_file_find(request->params[1]);
    if (file)
        send_file(request, file, "Accept-Encoding", "public, max-age=31536000, immutable");
    else
        orl_reply_not_found(request, "file of the dashboard");
}

void orl_handle_javascript(struct orl_request *request)
{
    send_file(request, orl_dashboard_file_find("oriel.js"), "Accept-Encoding", "no-cache");
}
