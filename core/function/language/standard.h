/*
 * Oriel's own versions of function files that scenes use without including them. The names are
 * those of Radiance's library. The definitions follow its manual, the headers of its files, and the
 * underlying mathematics. They are found by file name, after the caller's own files.
 */
#ifndef ORL_FUNCTION_LANGUAGE_STANDARD_H
#define ORL_FUNCTION_LANGUAGE_STANDARD_H

#define ORL_STANDARD_START "rayinit.cal" /* implicit start of every set of definitions */

/* Returns the text of a file, or NULL if there is none of that name. */
const char *orl_standard_text(const char *name);

#endif
