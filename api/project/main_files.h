/*
 * Guesses a folder's main scene files and the order in which to read them:
 *
 * 1. if a job document (.json, of kind render or else the first by name) lies beside the Radiance
 *    files at the top, the files that its "scene" lists, provided that all exist;
 * 2. else the Radiance files (.rad) at the top that no other file's commands name
 *    (orl_scene_guess_main), in an order that defines modifiers before they are used, and otherwise
 *    sorted by name; also material files (.mat) beside them that define names used but not defined
 *    in them.
 *
 * The top is the least deep folder with .rad files. If several are equally deep, none is chosen
 * and *ret_count is 0.
 */
#ifndef ORL_API_PROJECT_MAIN_FILES_H
#define ORL_API_PROJECT_MAIN_FILES_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/files.h>

/* Chooses the main files. names: sorted. ret_chosen: room for count; gets indices of the main
 * files in reading order. Errors: ORL_ERR_LIMIT, ORL_ERR_NOMEM, and those of files->open. */
int orl_main_files_choose(const char *const *names, size_t count, const struct orl_files *files,
                          size_t *ret_chosen, size_t *ret_count, struct orl_error *err);
/* Chooses main files likewise. ret_ranks[i]: rank of file i among the main files, from 1; 0 for
 * other files. */
int orl_main_files_ranks(const char *const *names, size_t count, const struct orl_files *files,
                         unsigned *ret_ranks, struct orl_error *err);

#endif
