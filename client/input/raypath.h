/*
 * The user's library of function files, fonts and data that scenes use but do not include: the
 * folders of the environment variable RAYPATH, as in Radiance (rpict(1), ENVIRONMENT). It is
 * searched after the scene's folder. If RAYPATH is unset, there is no library.
 */
#ifndef ORL_CLIENT_INPUT_RAYPATH_H
#define ORL_CLIENT_INPUT_RAYPATH_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/files.h>

/* Returns files of a folder (orl_files_from_folder), with the library searched after it. */
struct orl_files orl_raypath_files(const char *folder);

/* Finds a file of that name in the library. Returns false if there is none. */
bool orl_raypath_find(const char *name, char *ret_path, size_t size);

#endif
