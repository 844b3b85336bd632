/*
 * The order in which a scene's main files are to be read: a modifier is defined before it is used.
 *
 * Each file is looked through for the names that it defines and those it uses, by itself and by the
 * files that its commands name, however deep; it is not parsed: what is wrong with it is found when
 * the scene is. A name that several files define may come from any of them, so all come before who
 * uses it, up to 16. Where files need each other, and otherwise, names decide.
 *
 * Errors: those of files->open; ORL_ERR_NOMEM.
 */
#ifndef ORL_API_MAIN_ORDER_H
#define ORL_API_MAIN_ORDER_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/files.h>

/* names: sorted. is_main: in and out. ret_order: room for count; their indices. */
int orl_main_order(const char *const *names, size_t count, bool *is_main,
                   const struct orl_files *files, size_t *ret_order, size_t *ret_count,
                   struct orl_error *err);

#endif
