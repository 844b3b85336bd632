/*
 * Groups of apertures, doors and shades that change together: gathered while surfaces are written,
 * then each in all of its states.
 */
#ifndef ORL_API_HONEYBEE_GROUPS_H
#define ORL_API_HONEYBEE_GROUPS_H

#include "honeybee/polygon.h"

struct orl_hb_member {
    const json_t *json;
    size_t modifier;       /* where no state says another */
    struct orl_vec3 front; /* which way it looks; zero: as its corners turn */
};

struct orl_hb_group {
    const char *identifier;
    bool shades, inside; /* inside: all of its shades are */
    struct orl_hb_member *members;
    size_t count, room;
};

struct orl_hb_groups {
    struct orl_hb_group *items;
    size_t count, room;
    json_t *places; /* by "shade IDENTIFIER" or "window IDENTIFIER" */
};

void orl_hb_groups_done(struct orl_hb_groups *groups);
/* Adds an object to its group, if it has one: *ret_moves says so. */
int orl_hb_groups_add(struct orl_hb *hb, struct orl_hb_groups *groups,
                      const struct orl_hb_member *member, bool shade, bool inside,
                      const struct orl_hb_at *at, bool *ret_moves);
/* Files of all states, and states.json of each folder. */
int orl_hb_groups_write(struct orl_hb *hb, const struct orl_hb_groups *groups);

#endif
