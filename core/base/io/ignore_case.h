/* Case-insensitive search of file names, for scenes from systems that ignore case. */
#ifndef ORL_BASE_IO_IGNORE_CASE_H
#define ORL_BASE_IO_IGNORE_CASE_H

#include <stdbool.h>
#include <stddef.h>

/* Finds a file below the folder, or from the root for an absolute name, whose name differs from
 * this one only in upper and lower case; of several the first by name. */
bool orl_find_ignoring_case(const char *folder, const char *name, char *ret_name, size_t size);

#endif
