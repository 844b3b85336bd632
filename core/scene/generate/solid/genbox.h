/*
 * A box of genbox, from the origin to its size. Internal to genbox*.c.
 */
#ifndef ORL_SCENE_GENERATE_SOLID_GENBOX_H
#define ORL_SCENE_GENERATE_SOLID_GENBOX_H

#include "scene/generate/solid/solids.h"

struct orl_genbox {
    const char *material, *name;
    double size[3];
    double bevel; /* depth of cut-off edges, or radius of round ones; 0: sharp edges */
    bool rounded, inverted;
    unsigned level; /* round edges have 2^level flat pieces each; below 2: cylinders and spheres */
};

/* Sides, edges and corners of a box with cut edges; each is a list of corners by letter. */
extern const char orl_box_inset[6][5], orl_box_edges[12][3], orl_box_ends[8][2];

/*
 * Returns a corner by its letter. The letters 0-9 . _ A-Z a-z count from 0. Bits 0 to 2: on the far
 * side in x, y and z; bits 3 to 5: inside that side by the bevel. For an inverted box near and far
 * are swapped, which flips every face and keeps its name.
 */
struct orl_vec3 orl_box_corner(const struct orl_genbox *box, char letter);
unsigned orl_box_code(char letter);

/* Writes the box with round edges made of flat pieces. Returns 0 or ORL_ERR_NOMEM. */
int orl_genbox_pieces(const struct orl_genbox *box, struct orl_text *text, struct orl_error *err);

#endif
