/*
 * Groups of apertures, doors and shades that change together. They are collected while surfaces
 * are written; then each group is written in all of its states.
 */
#ifndef ORL_API_HONEYBEE_APERTURE_GROUPS_H
#define ORL_API_HONEYBEE_APERTURE_GROUPS_H

#include "honeybee/polygon.h"

struct orl_hb_member {
    const json_t *json;
    size_t modifier;       /* used if a state has none of its own */
    struct orl_vec3 front; /* direction of the front; zero: given by the corners' order */
};

struct orl_hb_group {
    const char *identifier;
    bool shades, inside; /* inside: true if all of its shades are indoors */
    struct orl_hb_member *members;
    size_t count, room;
};

struct orl_hb_groups {
    struct orl_hb_group *items;
    size_t count, room;
    json_t *group_index; /* index in items by "shade IDENTIFIER" or "window IDENTIFIER" */
};

void orl_hb_groups_done(struct orl_hb_groups *groups);
/* Adds an object to its group. *ret_is_dynamic is true if it has one. */
int orl_hb_groups_add(struct orl_hb *hb, struct orl_hb_groups *groups,
                      const struct orl_hb_member *member, bool shade, bool inside,
                      const struct orl_hb_at *at, bool *ret_is_dynamic);
/* Writes the files of all states, and states.json of each folder. */
int orl_hb_groups_write(struct orl_hb *hb, const struct orl_hb_groups *groups);

#endif
