/*
 * Texts in a polygonal font: tests whether a place lies in one of the letters.
 *
 * A place's coordinates are (x, y) of origin + x right + y down; lines are 1 apart from the top. A
 * letter is a polygon on a square of 255 by 255, from the lower left, by the even-odd rule; letters
 * may overlap. Units: the world's. Ownership: all in a description's arena. Immutable once made.
 */
#ifndef ORL_SCENE_MATERIAL_PATTERNS_LETTERING_H
#define ORL_SCENE_MATERIAL_PATTERNS_LETTERING_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/vec.h>

enum { ORL_GLYPH_SIDE = 255 };

struct orl_glyph {
    const unsigned char *corners; /* x, y, x, y, ... */
    int n;                        /* number of corners; 0: a space */
    int left, right, bottom, top;
};

struct orl_placed_letter {
    const struct orl_glyph *glyph;
    int at; /* left side of its square, in 255ths of a letter's height */
};

struct orl_lettering_line {
    const struct orl_placed_letter *letters;
    size_t n;
    int width; /* right end of the line's last letter, in 255ths */
};

struct orl_lettering {
    struct orl_vec3 origin;
    struct orl_vec3 right, down; /* a place's coordinates are its dot products with these */
    /* units of `at` and `width` per 1 to the right */
    double unit;
    const struct orl_lettering_line *lines;
    size_t n_lines;
};

bool orl_lettering_covers(const struct orl_lettering *text, struct orl_vec3 place);

#endif
