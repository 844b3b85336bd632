/*
 * Lists that come a page at a time: what their arguments say, and the link to the next (RFC 8288).
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_RESOURCES_PAGE_H
#define ORL_SERVER_RESOURCES_PAGE_H

#include <stdio.h>

#include "http/request.h"

/* The argument limit, if there is one, of 1 to ORL_SERVER_LIST; what comes at once is fewer. False
 * after a 400. */
bool orl_page_limit(struct orl_request *request, unsigned long *ret_limit);

/* 400: an argument of the query is not understood, and what it would have to be. False. */
bool orl_page_refuse(struct orl_request *request, const char *wanted);

/*
 * Adds to the reply made: Link: <path?arguments&cursor=CURSOR>; rel="next", with those arguments of
 * the request that names (which end with NULL) lists. CURSOR is of letters, digits, '-' and '.'.
 */
void orl_page_link(struct orl_request *request, const char *path, const char *const *names,
                   const char *cursor);

#endif
