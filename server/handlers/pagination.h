/*
 * Paged lists: their arguments, and the link to the next page (RFC 8288). Threads: the loop thread
 * only.
 */
#ifndef ORL_SERVER_HANDLERS_PAGINATION_H
#define ORL_SERVER_HANDLERS_PAGINATION_H

#include <stdio.h>

#include "http/request/request.h"

/* Reads the argument limit, if given, from 1 to ORL_SERVER_LIST; an answer may have fewer items.
 * Returns false after a 400. */
bool orl_page_limit(struct orl_request *request, unsigned long *ret_limit);

/* Replies 400: an argument of the query is invalid. wanted: what it must be. Returns false. */
bool orl_page_refuse(struct orl_request *request, const char *wanted);

/*
 * Adds the header Link: <path?arguments&cursor=CURSOR>; rel="next" to the reply made. The arguments
 * are those of the request that names lists (ends with NULL). CURSOR may have letters, digits, '-'
 * and '.'.
 */
void orl_page_link(struct orl_request *request, const char *path, const char *const *names,
                   const char *cursor);

#endif
