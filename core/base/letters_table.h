/*
 * The shapes of letters. Units: capitals are 20 high, small x is 14, descenders reach to -6; y is
 * up, and strokes stand on y = 0.
 *
 * A shape is text: strokes apart by ';', points "x,y" apart by spaces. A point with '~' is one that
 * the stroke bends towards (the middle point of a parabola; between two of them the stroke passes
 * half way); '@' before the first point says that the stroke is closed.
 */
#ifndef ORL_BASE_LETTERS_TABLE_H
#define ORL_BASE_LETTERS_TABLE_H

#include <stdint.h>

struct orl_letter {
    uint32_t code;     /* Unicode */
    int width;         /* of the strokes' middles; beside it is ORL_LETTER_GAP */
    const char *shape; /* of the letter */
    uint32_t base;     /* the letter that it has beneath that; 0: none */
};

enum { ORL_LETTER_HEIGHT = 20, ORL_LETTER_GAP = 5 };

/* Never NULL: a box where there is no letter. */
const struct orl_letter *orl_letter_find(uint32_t code);

#endif
