/*
 * Which files of a folder make its scene, when nobody says so, and in which order they are read:
 *
 * 1. where a job document (.json, of kind render or else the first by name) lies beside the
 * Radiance files at the top, those that its "scene" lists, if all of them are there;
 * 2. else the Radiance files (.rad) at the top that no command of another names
 *    (orl_scene_guess_main), in an order that defines modifiers before they are used, and by name
 *    where that leaves it open; and the files of materials (.mat) beside them that define what
 *    else nobody does (main_order.h).
 *
 * The top is the one folder that holds .rad files and lies in the fewest others; where several lie
 * equally deep none is chosen, and *ret_count is 0.
 */
#ifndef ORL_API_MAIN_FILES_H
#define ORL_API_MAIN_FILES_H

#include <stddef.h>

#include <oriel/files.h>

/* names: sorted. ret_chosen: room for count; indices of the main files in order. ORL_ERR_LIMIT, or
 * what files->open says; ORL_ERR_NOMEM. */
int orl_main_files_choose(const char *const *names, size_t count, const struct orl_files *files,
                          size_t *ret_chosen, size_t *ret_count, struct orl_error *err);
/* The same as places: of each file its own among the main ones, from 1; else 0. */
int orl_main_files_places(const char *const *names, size_t count, const struct orl_files *files,
                          unsigned *ret_places, struct orl_error *err);

#endif
