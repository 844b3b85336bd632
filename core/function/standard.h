/*
 * Texts of our own for function files that scenes count on without bringing them: the names that
 * Radiance's library has, by what its manual and the heads of its files say they mean, and by the
 * mathematics behind. They are found by their names, after the caller's own files.
 */
#ifndef ORL_FUNCTION_STANDARD_H
#define ORL_FUNCTION_STANDARD_H

#define ORL_STANDARD_START "rayinit.cal" /* what every set of definitions begins with */

/* NULL when there is none of that name. */
const char *orl_standard_text(const char *name);

#endif
