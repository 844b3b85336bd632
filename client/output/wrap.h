/* Prints text wrapped to lines of at most ORL_WRAP_COLUMNS columns. */
#ifndef ORL_CLIENT_OUTPUT_WRAP_H
#define ORL_CLIENT_OUTPUT_WRAP_H

#include <stdio.h>

enum { ORL_WRAP_COLUMNS = 100 };

/*
 * Prints text (UTF-8) and a newline, from the line's column on; further lines are indented.
 * Words longer than a line are cut; control characters, which could move the cursor, become
 * '?'.
 */
void orl_print_wrapped(FILE *to, int column, int indent, const char *text);

#endif
