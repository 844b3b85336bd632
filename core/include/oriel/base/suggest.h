/*
 * Suggests the known word that a user most likely meant.
 *
 * Words are compared by the optimal string alignment distance: the number of letters inserted,
 * deleted, replaced, or swapped with their neighbour (Boytsov 2011, section 2.1). Letter case is
 * ignored, and '-', '_' and ' ' are equal. Longer words may differ by more letters. The first
 * letters of a word also suggest it.
 */
#ifndef ORIEL_BASE_SUGGEST_H
#define ORIEL_BASE_SUGGEST_H

#include <stddef.h>

#include <oriel/base/error.h>

enum { ORL_SUGGEST_LETTERS = 64 }; /* longer words get no suggestion */

/* Finds the nearest of several words, which are given one by one. */
struct orl_suggestion {
    const char *word; /* word to replace; borrowed */
    const char *best; /* nearest known word so far; borrowed; NULL: none is near */
    unsigned distance;
};
/* Considers one more known word. */
void orl_suggestion_add(struct orl_suggestion *suggestion, const char *known);

/* Returns the nearest of the words, or NULL if none is near. Of equally near words the first is
 * returned. */
const char *orl_suggest(const char *word, const char *const *words, size_t n_words);

/* Puts 'did you mean "KNOWN"?' in front of the hint. Leaves the error unchanged if the best word is
 * NULL. */
void orl_suggestion_hint(const struct orl_suggestion *suggestion, struct orl_error *err);

#endif
