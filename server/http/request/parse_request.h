/*
 * Parsers of a request's target, framing, query arguments, content negotiation and Range. They have
 * no state.
 */
#ifndef ORL_SERVER_HTTP_REQUEST_PARSE_REQUEST_H
#define ORL_SERVER_HTTP_REQUEST_PARSE_REQUEST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct MHD_Connection;

/*
 * A request's target: a path, or in absolute form (RFC 9112, 3.2.2) with scheme and authority.
 * Clients send the latter to proxies, and servers must accept it:
 *
 *     GET http://127.0.0.1:8423/v1/jobs HTTP/1.1
 *
 * The authority then replaces the Host header, and access.h applies the same checks to it.
 */

enum { ORL_AUTHORITY_MAX = 256 };

struct orl_target {
    char authority[ORL_AUTHORITY_MAX]; /* host and port; "": the target was a path */
    bool https;                        /* its scheme is https */
};

/* Splits url, which MHD has separated from its query. *ret_path points into it, or is "/". Returns
 * NULL, or the reason for refusing the target. */
const char *orl_target_split(const char *url, struct orl_target *ret_target, const char **ret_path);

/*
 * The target host and the end of a request, by its headers (RFC 9112, 3.2 and 6.3). A request that
 * the daemon and a proxy in front could read differently is refused, since one request could hide
 * inside another (11.2). Threads: loop.
 */

/* Returns NULL, or the sentence of the refusal. method and version are MHD's. */
const char *orl_framing_check(struct MHD_Connection *connection, const char *method,
                              const char *version);

/*
 * Called from MHD's callback for a request's target, before the arguments are parsed. If the target
 * and the space for its arguments exceed ORL_SERVER_URI_BYTES, cuts the query off and returns true.
 * libmicrohttpd 0.9 does not answer a request whose arguments do not fit.
 */
bool orl_framing_cut_query(const char *uri);

/* Unescapes a part of a target, for MHD's callback. It works like MHD's own function, but keeps
 * %00, which would end the text early. Returns the length. */
size_t orl_framing_unescape(char *text);

/* The arguments of a request's target. Threads: any. */

/* Reads a number from 1 to most: decimal digits only. */
bool orl_query_count(const char *text, unsigned long most, unsigned long *ret_count);

/* Reads a number from low to high in JSON's syntax. */
bool orl_query_number(const char *text, double low, double high, double *ret_number);

/* Content negotiation: Accept and Accept-Encoding (RFC 9110, 12.5.1 and 12.5.3). */

/*
 * Returns the weight, 0 to 1, that the header gives to a media type or a coding (name, in lower
 * case). The most specific range that contains the name decides; of equally specific ones the
 * first. 0 if no range contains it, and without a header (NULL). Parameters other than the weight
 * are ignored.
 */
double orl_negotiate_weight(const char *header, const char *name);

/*
 * The Range header (RFC 9110, 14): one range of bytes. Invalid headers and those with several
 * ranges are ignored, as the standard allows.
 */

enum orl_range_kind {
    ORL_RANGE_ALL,  /* no valid range: the whole file */
    ORL_RANGE_PART, /* the range */
    ORL_RANGE_NONE, /* a range that holds no byte of the file */
};

struct orl_range {
    uint64_t first, count;
};

/* Parses the header for a file of that size. *ret_range is set only for ORL_RANGE_PART. */
enum orl_range_kind orl_range_parse(const char *header, uint64_t size, struct orl_range *ret_range);

#endif
