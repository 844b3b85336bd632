/*
 * Temporary folders in which links bring files of different folders together, and lists of all
 * files below a folder.
 */
#ifndef ORL_CLIENT_PLACE_H
#define ORL_CLIENT_PLACE_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/error.h>

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

/* Creates a temporary folder below $TMPDIR or /tmp; remove it by orl_remove_folder. */
int orl_place_make(char ret_folder[4096], struct orl_error *err);
/* Creates or replaces a link of that name in place. */
int orl_place_link(const char *place, const char *name, const char *to, struct orl_error *err);
/* Links all entries of the folder into place, except existing names. Write files into place
 * before this call: through a link, a write would go into the user's folder. */
int orl_place_link_entries(const char *place, const char *folder, struct orl_error *err);

#endif
