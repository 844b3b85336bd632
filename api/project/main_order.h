/*
 * Finds the reading order of a scene's main files: a modifier is defined before it is used.
 *
 * Each file is scanned for names that it defines and uses. The scan includes files that its
 * commands name, up to 8 deep. Files are not fully parsed. Files that cannot be opened are
 * skipped. Reading the scene reports all errors. If several files define a name, all of them (at
 * most 16) come before its users. File names decide cycles and ties.
 *
 * Errors: ORL_ERR_NOMEM.
 */
#ifndef ORL_API_PROJECT_MAIN_ORDER_H
#define ORL_API_PROJECT_MAIN_ORDER_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/files.h>

/* Finds the order. names: sorted. is_main: in and out; needed material files are added.
 * ret_order: room for count; gets the main files' indices in reading order. */
int orl_main_order(const char *const *names, size_t count, bool *is_main,
                   const struct orl_files *files, size_t *ret_order, size_t *ret_count,
                   struct orl_error *err);

#endif
