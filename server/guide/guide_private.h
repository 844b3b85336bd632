/* The insides of a guide, for guide.c and guide_search.c. */
#ifndef ORL_SERVER_GUIDE_GUIDE_PRIVATE_H
#define ORL_SERVER_GUIDE_GUIDE_PRIVATE_H

#include <sqlite3.h>

#include "guide/guide.h"

struct orl_guide {
    struct orl_guide_page *pages;
    size_t count;
    sqlite3 *index;
};

/* Makes the full-text index of all pages. */
int orl_guide_index(struct orl_guide *guide, struct orl_error *err);

#endif
