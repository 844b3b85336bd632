/*
 * The user's own library of function files, fonts and data that scenes count on without bringing
 * them: the folders of the environment variable RAYPATH, as Radiance's programs search them
 * (rpict(1), ENVIRONMENT). It is looked in for what the scene's folder lacks. Unset: there is none.
 */
#ifndef ORL_CLIENT_LIBRARY_H
#define ORL_CLIENT_LIBRARY_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/files.h>

/* orl_files_from_folder with the library behind it. */
struct orl_files orl_library_files(const char *folder);

/* Where the library has a file of that name; false: nowhere. */
bool orl_library_path(const char *name, char *ret_path, size_t size);

#endif
