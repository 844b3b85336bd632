/*
 * Folders from which inputs come: the library of RAYPATH, and temporary folders of links.
 */
#ifndef ORL_CLIENT_INPUT_INPUT_FOLDERS_H
#define ORL_CLIENT_INPUT_INPUT_FOLDERS_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/error.h>
#include <oriel/base/files.h>

/*
 * The user's library of function files, fonts and data that scenes use but do not include: the
 * folders of the environment variable RAYPATH, as in Radiance (rpict(1), ENVIRONMENT). It is
 * searched after the scene's folder. If RAYPATH is unset, there is no library.
 */

/* Returns files of a folder (orl_files_from_folder), with the library searched after it. */
struct orl_files orl_raypath_files(const char *folder);

/* Finds a file of that name in the library. Returns false if there is none. */
bool orl_raypath_find(const char *name, char *ret_path, size_t size);

/*
 * Temporary folders in which links bring files of different folders together, and lists of all
 * files below a folder.
 */

bool orl_is_folder(const char *path);

struct orl_names {
    char **items; /* owned */
    size_t count, room;
};
void orl_names_done(struct orl_names *names);
int orl_names_add(struct orl_names *names, const char *name, struct orl_error *err);
/* Adds the names of all files below the folder, with prefix in front. Hidden files and folders
 * deeper than 16 are skipped. depth is 0 for a caller. */
int orl_names_list(const char *folder, const char *prefix, unsigned depth, struct orl_names *names,
                   struct orl_error *err);

/* Creates a temporary folder for that purpose below $TMPDIR or /tmp; remove it by
 * orl_remove_folder. */
int orl_temp_folder_make(const char *purpose, char ret_folder[4096], struct orl_error *err);
/* Creates or replaces a link of that name in temp_folder. */
int orl_temp_folder_link(const char *temp_folder, const char *name, const char *to,
                         struct orl_error *err);
/* Links all entries of the folder into temp_folder, except existing names. Write files into
 * temp_folder before this call: through a link, a write would go into the user's folder. */
int orl_temp_folder_link_entries(const char *temp_folder, const char *folder,
                                 struct orl_error *err);

#endif
