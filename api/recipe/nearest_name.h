/* The name that is most like a misspelt one. */
#ifndef ORL_API_RECIPE_NEAREST_NAME_H
#define ORL_API_RECIPE_NEAREST_NAME_H

#include <stddef.h>

/* Running search: offer all names, then read `best`. Start with {.wanted = NAME}. */
struct orl_nearest_name {
    const char *wanted, *best; /* best: NULL while no name is near enough */
    size_t distance;           /* edits between wanted and best */
};

/* Offers a name. It is near enough if at most a third of its letters, and one, are different:
 * inserted, left out, or replaced (Levenshtein 1966). */
void orl_nearest_name_offer(struct orl_nearest_name *nearest, const char *name);

#endif
