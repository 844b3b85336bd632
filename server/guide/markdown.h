/*
 * A page of the guide: Markdown to HTML, and to plain text for the search.
 *
 * md4c makes the HTML. It is then changed in one pass: headings get anchors, links between pages
 * become addresses of the daemon, and comments are left out. Links to other files of the source
 * tree, which the daemon does not serve, lose their address.
 *
 * Pages come from the source tree, so they are trusted; the Content-Security-Policy of the reply
 * stops scripts all the same. Threads: any; nothing is shared.
 */
#ifndef ORL_SERVER_GUIDE_MARKDOWN_H
#define ORL_SERVER_GUIDE_MARKDOWN_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/error.h>

/* A heading, and the text from there to the next one. */
struct orl_guide_section {
    int level;     /* 1: the page's title, with the text before the first other heading */
    char *anchor;  /* "" for the title */
    char *heading; /* plain text */
    char *text;    /* plain text, without the heading */
};

struct orl_guide_text {
    char *html;
    struct orl_guide_section *sections; /* the first one is the title's */
    size_t count;
};

/* Renders the page of that name ("howto/tokens"; "index"). The caller owns the result. */
int orl_guide_render(const char *name, const char *markdown, size_t size,
                     struct orl_guide_text *ret_text, struct orl_error *err);
void orl_guide_text_done(struct orl_guide_text *text); /* a zeroed struct is fine */

enum { ORL_GUIDE_URL = 300 };

/*
 * Resolves a link of the page `name`. Returns the address as the daemon serves it:
 * "/guide/howto/x#y" for "../howto/x.md#y", the same text for addresses of other hosts, "#y" and
 * "/v1/limits". Returns "" for a file that the daemon does not serve, and for an address that is
 * too long.
 */
const char *orl_guide_resolve(const char *name, const char *link, char ret_url[ORL_GUIDE_URL]);

#endif
