/*
 * The frame around a page of the guide, in HTML: the header with the search, the contents, the
 * headings of the page, and links to the previous and the next page. It works without scripts.
 *
 * Each function returns a whole document, owned by the caller, or NULL: out of memory.
 */
#ifndef ORL_SERVER_HANDLERS_SERVICE_GUIDE_PAGE_H
#define ORL_SERVER_HANDLERS_SERVICE_GUIDE_PAGE_H

#include "guide/guide.h"

char *orl_guide_page_html(const struct orl_guide *guide, size_t page);
/* The page for an address without a page. name: the missing page's. */
char *orl_guide_missing_html(const struct orl_guide *guide, const char *name);
/* The answers to a question; question may be NULL. */
char *orl_guide_search_html(struct orl_guide *guide, const char *question);

#endif
