/*
 * The user guide: the pages of client/guide, their order, and a search over them.
 *
 * A page's name is its path below client/guide without ".md" ("howto/tokens"); the start page,
 * index.md, is "index". Pages of a folder form a part of the guide. The order within a part is that
 * of the links on the start page; pages without a link follow, by name.
 *
 * The search is a full-text index of SQLite (FTS5) in memory, with a row for each section of a
 * page. A question is reduced to quoted words, so no text is a syntax error.
 *
 * Ownership: the guide borrows its files, which must outlive it, and owns everything else.
 * Threads: one at a time.
 */
#ifndef ORL_SERVER_GUIDE_GUIDE_H
#define ORL_SERVER_GUIDE_GUIDE_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/error.h>
#include <oriel/base/sha256.h>

#include "guide/markdown.h"
#include "process/embedded_files.h"

struct orl_guide_page {
    const char *name;  /* "howto/tokens" */
    const char *part;  /* "How-to"; "" for the start page */
    const char *title; /* plain text of its first heading, or its name */
    struct orl_guide_text text;
};

struct orl_guide;

/* Renders all Markdown files of the list and builds the index. */
int orl_guide_open(const struct orl_guide_file *files, size_t count, struct orl_guide **ret_guide,
                   struct orl_error *err);
void orl_guide_close(struct orl_guide *guide); /* NULL is fine */

/* The pages, in the guide's order. */
size_t orl_guide_count(const struct orl_guide *guide);
const struct orl_guide_page *orl_guide_page_at(const struct orl_guide *guide, size_t index);
/* Returns the index of the page of that name, or the number of pages if there is none. */
size_t orl_guide_find(const struct orl_guide *guide, const char *name);

/*
 * Search.
 */

enum {
    ORL_GUIDE_QUESTION = 200, /* bytes of a question that are read */
    ORL_GUIDE_WORDS = 16,     /* words of it that are searched */
    ORL_GUIDE_HITS = 30,      /* sections in an answer */
};

/* A found section. Texts are plain; found words in snippet stand between the bytes 1 and 2. Valid
 * during the call only. */
struct orl_guide_hit {
    const struct orl_guide_page *page;
    const struct orl_guide_section *section;
    const char *snippet;
};

struct orl_guide_found {
    size_t words;   /* searched words; 0: the question has none */
    size_t hits;    /* sections handed to take */
    bool only_some; /* no section has all words: these have some of them */
    bool shortened; /* the question was longer than the bounds above */
};

/* Searches for the words of the question, and calls take for each found section, the best first. */
int orl_guide_search(struct orl_guide *guide, const char *question,
                     void (*take)(void *context, const struct orl_guide_hit *hit), void *context,
                     struct orl_guide_found *ret_found, struct orl_error *err);

#endif
