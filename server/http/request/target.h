/*
 * A request's target: a path, or in absolute form (RFC 9112, 3.2.2) with scheme and authority.
 * Clients send the latter to proxies, and servers must accept it:
 *
 *     GET http://127.0.0.1:8423/v1/jobs HTTP/1.1
 *
 * The authority then replaces the Host header, and access.h applies the same checks to it.
 */
#ifndef ORL_SERVER_HTTP_REQUEST_TARGET_H
#define ORL_SERVER_HTTP_REQUEST_TARGET_H

#include <stdbool.h>

enum { ORL_AUTHORITY_MAX = 256 };

struct orl_target {
    char authority[ORL_AUTHORITY_MAX]; /* host and port; "": the target was a path */
    bool https;                        /* its scheme is https */
};

/* Splits url, which MHD has separated from its query. *ret_path points into it, or is "/". Returns
 * NULL, or the reason for refusing the target. */
const char *orl_target_split(const char *url, struct orl_target *ret_target, const char **ret_path);

#endif
