#include "scene/material/patterns/lettering.h"

/* Even-odd rule: counts the edges that a ray to the right crosses. */
static bool is_inside(const struct orl_glyph *glyph, double x, double y)
{
    bool inside = false;
    if (x < glyph->left || x > glyph->right || y < glyph->bottom || y > glyph->top)
        return false;
    for (int i = 0, last = glyph->n - 1; i < glyph->n; last = i++) {
        const unsigned char *const from = glyph->corners + 2 * (size_t)last;
        const unsigned char *const to = glyph->corners + 2 * (size_t)i;
        const double ax = from[0], ay = from[1], bx = to[0], by = to[1];
        if ((ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax))
            inside = !inside;
    }
    return inside;
}

bool orl_lettering_covers(const struct orl_lettering *text, struct orl_vec3 place)
{
    const struct orl_vec3 from = orl_sub(place, text->origin);
    const double x = orl_dot(from, text->right) * text->unit, y = orl_dot(from, text->down);
    if (!(x >= 0) || !(y >= 0) || !(y < (double)text->n_lines))
        return false;
    const struct orl_lettering_line *const line = &text->lines[(size_t)y];
    const double up = ((double)(size_t)y + 1 - y) * ORL_GLYPH_SIDE;
    for (size_t i = 0; i < line->n && x < line->width; i++)
        if (is_inside(line->letters[i].glyph, x - line->letters[i].at, up))
            return true;
    return false;
}
