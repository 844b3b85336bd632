/*
 * A temporary folder in which files lie side by side that in truth lie apart, by links; and the
 * names of all files below a folder.
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
/* Adds them with the prefix in front. Hidden ones, and what lies deeper than 16 folders, are passed
 * over; depth is 0 for a caller. */
int orl_names_list(const char *folder, const char *prefix, unsigned depth, struct orl_names *names,
                   struct orl_error *err);

/* A new one, below $TMPDIR or /tmp, for orl_remove_folder to end. */
int orl_place_make(char ret_folder[4096], struct orl_error *err);
/* A link in the place by that name, instead of one that is there. */
int orl_place_link(const char *place, const char *name, const char *to, struct orl_error *err);
/* Links to all that the folder holds, but for names that are there. What is to be written into the
 * place is written before: through a link it would go into somebody's own folder. */
int orl_place_link_entries(const char *place, const char *folder, struct orl_error *err);

#endif
