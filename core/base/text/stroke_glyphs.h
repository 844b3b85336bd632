/*
 * Shapes of letters. Units: capitals are 20 high, small x is 14, descenders reach to -6; y is up,
 * and letters stand on y = 0.
 *
 * A shape is a text of strokes separated by ';', with points "x,y" separated by spaces. A point
 * with '~' is the middle point of a parabola; between two such points the stroke passes half way.
 * '@' before the first point marks a closed stroke.
 */
#ifndef ORL_BASE_TEXT_STROKE_GLYPHS_H
#define ORL_BASE_TEXT_STROKE_GLYPHS_H

#include <stdint.h>

struct orl_stroke_glyph {
    uint32_t code;     /* Unicode */
    int width;         /* width between the strokes' middles; ORL_STROKE_GLYPH_GAP is added */
    const char *shape; /* strokes of the letter */
    uint32_t base;     /* letter drawn beneath the shape; 0: none */
};

enum { ORL_STROKE_GLYPH_HEIGHT = 20, ORL_STROKE_GLYPH_GAP = 5 };

/* Returns the letter for a character, or a box for an unknown one. Never NULL. */
const struct orl_stroke_glyph *orl_stroke_glyph_find(uint32_t code);

#endif
